/* Each stage of the ladder is reached, for the reason that it is there for, and gives what can be worked out
 * by hand.
 *
 * With q = 0 an obstacle beside the middle of the upper arm gives the row 0.25 qdot_0 <= b. The acceleration
 * bounds are what makes rows infeasible: an arm that moves towards the obstacle at 1 rad/s has qdot_0 >= 0.6.
 */
#include "rig.h"

static const double towards[PG_N] = {1.0, 0.0};
static const double slowest = 1.0 - MOST_ACCELERATION;

static void open_before_obstacle(rig_t *rig, double distance, const double *velocity) {
  rig_open(rig);
  if (velocity) rig_speed_up(rig, velocity);
  rig_see(rig, 0.25, distance);
}

static void all_rows(void) {
  rig_t rig;
  open_before_obstacle(&rig, 0.28, NULL);
  rig.xdot[1] = 0.25;
  for (int i = 0; i < 10; i++)
    CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK_NEAR(rig.cycle->ubA[0], 0.2 * 0.03 / 0.05, 1e-12);
  CHECK_NEAR(rig.cycle->A[0], 0.25, 1e-12);
  CHECK_EQUAL(rig.cycle->A[1], 0.0);
  CHECK(rig.cycle->row_on[0] && !rig.cycle->row_on[1]);
#if PG_ACTIVE_ROW
  CHECK(rig.cycle->row_on[PG_CAPSULES]);
  CHECK_NEAR(rig.cycle->A[PG_CAPSULES * PG_N], 0.25, 1e-12); /* of one link: its own row */
  CHECK_NEAR(rig.qdot[0], 0.0, 1e-9);                        /* (7) holds it */
#endif
  rig_close(&rig);
}

/* At 0.29 m the row allows 0.64 rad/s, but the active row none. */
static void without_the_active_row(void) {
  rig_t rig;
  open_before_obstacle(&rig, 0.29, towards);
  CHECK_EQUAL(rig_step(&rig), PG_REDUCED_ACTIVE);
  CHECK(rig.qdot[0] >= slowest - 1e-5 && rig.qdot[0] <= 0.64 + 1e-9);
  rig_close(&rig);
}

/* At 0.26 m the row allows 0.16 rad/s. */
static void without_distant_rows(void) {
  rig_t rig;
  open_before_obstacle(&rig, 0.26, towards);
  CHECK_EQUAL(rig_step(&rig), PG_REDUCED_DISTANT);
  rig_close(&rig);
}

/* At 0.1 m the row asks for -0.8 rad/s of an arm at rest, which can do -0.4; 0 is what is left to ask for. */
static void without_repulsion(void) {
  rig_t rig;
  open_before_obstacle(&rig, 0.1, NULL);
  rig.xdot[1] = 0.25;
  CHECK_EQUAL(rig_step(&rig), PG_REDUCED_REPULSION);
  CHECK_NEAR(rig.qdot[0], 0.0, 1e-9);
  CHECK_NEAR(rig.cycle->ubA[0], -0.2, 1e-12); /* diagnostics show stage 0 */
  rig_close(&rig);
}

/* At 0.2 m not even 0 can be had, but it is not critical yet. */
static void critical_rows_only(void) {
  rig_t rig;
  open_before_obstacle(&rig, 0.2, towards);
  CHECK_EQUAL(rig_step(&rig), PG_REDUCED_CRITICAL);
  rig_close(&rig);
}

/* At 0.1 m it is: brake. */
static void nothing_left(void) {
  rig_t rig;
  open_before_obstacle(&rig, 0.1, towards);
  CHECK_EQUAL(rig_step(&rig), PG_STOPPED_INFEASIBLE);
  CHECK_NEAR(rig.qdot[0], slowest, 1e-5);
  CHECK(isnan(rig.cycle->kkt_residual));
  CHECK_EQUAL(rig_step(&rig), PG_STOPPED_INFEASIBLE);
  CHECK_EQUAL(rig_step(&rig), PG_REDUCED_REPULSION); /* slow enough to stop within the cycle */
  rig_close(&rig);
}

/* With the damper schedule there is one threshold: rows beyond it are distant, and all others are
 * critical. */
static void damper_schedule(void) {
  rig_t rig;
  open_before_obstacle(&rig, 0.23, towards);
  CHECK_EQUAL(rig_step(&rig), PG_REDUCED_DISTANT);
  rig.points[1] = 0.21;
  rig_speed_up(&rig, towards);
  CHECK_EQUAL(rig_step(&rig), PG_STOPPED_INFEASIBLE);
  pg_reset(rig.controller);
  memset(rig.qdot, 0, sizeof rig.qdot);
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK_NEAR(rig.cycle->ubA[0], 6.0 * -0.01, 1e-12);
  CHECK_NEAR(rig.cycle->approach_speed[0], 6.0 * -0.01, 1e-12);
  rig_close(&rig);
}

/* A row never asks for more than row_speed rad/s, wherever the obstacle is. */
static void a_row_that_no_joint_can_serve(void) {
  rig_t rig;
  rig_open(&rig);
  const double away[PG_N] = {-1.0, 0.0};
  rig_speed_up(&rig, away);
  rig_see(&rig, 0.01, 0.1);
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK(rig.qdot[0] <= -1.0 + 1e-8);
  CHECK_NEAR(rig.cycle->A[0], 0.01, 1e-12);
  CHECK_NEAR(rig.cycle->ubA[0], -0.01, 1e-12);
  rig.points[0] = -0.1, rig.points[1] = 0.0; /* behind the base, whose point does not move: no row */
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK(!rig.cycle->row_on[0] && rig.cycle->distance[0] < 0.11);
  CHECK_EQUAL(rig.cycle->ubA[0], PG_OFF);
  CHECK_NEAR(rig.cycle->A[0], 0.01, 1e-12); /* it keeps its last direction */
  rig_close(&rig);
}

int main(void) {
  a_row_that_no_joint_can_serve();
#if PG_SCHEDULE_DAMPER
  (void)all_rows, (void)without_the_active_row, (void)without_distant_rows, (void)without_repulsion;
  (void)critical_rows_only, (void)nothing_left;
  damper_schedule();
#else
  (void)damper_schedule;
  all_rows();
#if PG_ACTIVE_ROW
  without_the_active_row();
#else
  (void)without_the_active_row;
#endif
  without_distant_rows();
  without_repulsion();
  critical_rows_only();
  nothing_left();
#endif
  return checks_failed > 0;
}
