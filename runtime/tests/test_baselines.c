/* The methods repulsive and tangential, worked out by hand for the planar arm. It moves in a plane, so that
 * of the three directions of a row one, at right angles to the plane, can never be served.
 *
 * At q = (0, pi/2) the upper arm lies along x, the forearm along y from (0.5, 0) to (0.5, 0.5). An obstacle
 * at x = 0.5 + d beside the forearm's middle (0.5, 0.25) has d = (1, 0, 0): the point below it moves at J_p
 * qdot = (-0.25, 0.5) qdot_0 + (-0.25, 0) qdot_1. */
#include "rig.h"

static void open_beside_forearm(rig_t *rig, double distance) {
  rig_open(rig);
  pg_parameters_t p = rig_parameters(rig);
  p.qddot_limit[0] = p.qddot_limit[1] = 1e3;
  CHECK(pg_set_parameters(rig->controller, &p) == PG_SOLVED);
  rig->q[1] = acos(0.0);
  rig_see(rig, 0.5 + distance, 0.25);
}

/* Velocity of the point of the forearm beside the obstacle. */
static void velocity_of_point(const rig_t *rig, double velocity[2]) {
  velocity[0] = -0.25 * (rig->qdot[0] + rig->qdot[1]);
  velocity[1] = 0.5 * rig->qdot[0];
}

static int rows_on(const rig_t *rig) {
  int count = 0;
  for (int slot = 0; slot < PG_ROWS; slot++)
    count += rig->cycle->row_on[slot];
  return count;
}

/* 1 if each pair of slots stands for an equality: opposite rows, twice PG_WIDTH apart. */
static int is_pair(const rig_t *rig, int slot) {
  const double *A = &rig->cycle->A[slot * PG_N], *ubA = &rig->cycle->ubA[slot];
  int opposite = rig->cycle->row_on[slot] && rig->cycle->row_on[slot + 1];
  for (int j = 0; j < PG_N; j++)
    opposite &= A[j] == -A[PG_N + j];
  return opposite && fabs(ubA[0] + ubA[1] - 2.0 * PG_WIDTH) < 1e-15;
}

#if PG_SCHEDULE_DAMPER
static const double retreat = 6.0 * 0.02; /* [m/s] at 0.20 m */
#else
static const double retreat = 0.2 * 0.02 / 0.05;
#endif

static void nothing_near(void) {
  rig_t rig;
  open_beside_forearm(&rig, 0.4);
  rig.xdot[1] = 0.1;
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK_EQUAL(rows_on(&rig), 0);
  for (int slot = 0; slot < PG_ROWS; slot++)
    CHECK_EQUAL(rig.cycle->ubA[slot], PG_OFF);
  rig_close(&rig);
}

/* The row of a joint's lever arm that no joint can serve never counts twice: all but the first row is off
 * beside the upper arm, whose points move in one direction only. */
static void rows_that_add_nothing(void) {
  rig_t rig;
  open_beside_forearm(&rig, 0.5);
  rig.points[0] = 0.25, rig.points[1] = -0.2;
  CHECK(rig_step(&rig) < PG_STOPPED_INFEASIBLE);
  CHECK_EQUAL(rows_on(&rig), 2);
  CHECK(is_pair(&rig, 0));
  CHECK_NEAR(rig.cycle->A[0], -0.25, 1e-12);
  const double kept = rig.cycle->A[0];
  rig.points[1] = -2.0;
  CHECK(rig_step(&rig) == PG_SOLVED);
  CHECK_EQUAL(rows_on(&rig), 0);
  CHECK_EQUAL(rig.cycle->A[0], kept); /* a row that is off keeps its direction */
  rig_close(&rig);
}

/* Of equally near obstacles that of the first capsule counts. */
static void the_nearest_capsule(void) {
  rig_t rig;
  open_beside_forearm(&rig, 0.20);
  rig_see(&rig, 0.25, -0.20);
  CHECK(rig_step(&rig) < PG_STOPPED_INFEASIBLE);
  CHECK_NEAR(rig.cycle->A[0], -0.25, 1e-12);
  CHECK_NEAR(rig.cycle->A[1], 0.0, 1e-12);
  rig.points[0] -= 1e-6;
  CHECK(rig_step(&rig) < PG_STOPPED_INFEASIBLE);
  CHECK_NEAR(rig.cycle->A[1], -0.25, 1e-12);
  rig_close(&rig);
}

#if PG_METHOD_REPULSIVE

static void straight_away(void) {
  rig_t rig;
  double velocity[2];
  open_beside_forearm(&rig, 0.20);
  rig.xdot[0] = 0.2, rig.xdot[1] = 0.1;
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK_EQUAL(rows_on(&rig), 4); /* in the plane */
  CHECK(is_pair(&rig, 0));
  velocity_of_point(&rig, velocity);
  CHECK_NEAR(velocity[0], -retreat, 1.1 * PG_WIDTH);
  CHECK_NEAR(velocity[1], 0.0, 1.1 * PG_WIDTH);
  CHECK_NEAR(rig.cycle->approach_speed[1], -retreat, 1e-12);
  rig_close(&rig);
}

/* At the end of the dead zone, to 1e-9 m, the point stands still. */
static void the_end_of_the_dead_zone(void) {
  const double end = PG_SCHEDULE_DAMPER ? 0.22 : 0.25;
  rig_t rig;
  open_beside_forearm(&rig, end + 0.5e-9);
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK_EQUAL(rows_on(&rig), 4);
  rig.points[0] = 0.5 + end + 1e-8;
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK_EQUAL(rows_on(&rig), 0);
  rig_close(&rig);
}

#else

/* The task wants to go past the obstacle; the point follows along y, at 0.1 m/s at least. */
static void along_a_tangent(void) {
  rig_t rig;
  double velocity[2];
  open_beside_forearm(&rig, 0.20);
  rig.xdot[1] = 0.05;
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK(is_pair(&rig, 0));
  velocity_of_point(&rig, velocity);
  CHECK_NEAR(velocity[0], -retreat, 1.1 * PG_WIDTH);
  CHECK(velocity[1] >= 0.1 - 1e-9);
  CHECK_EQUAL(rig.cycle->row_on[4], 1);
  CHECK_NEAR(rig.cycle->ubA[4], -0.1, 1e-15);
  rig_close(&rig);
}

/* The last tangent weighs half of the task: a task that turns back a little does not turn it, a reset does.
 */
static void the_last_tangent(void) {
  rig_t rig;
  open_beside_forearm(&rig, 0.20);
  rig.xdot[1] = 0.05;
  rig_step(&rig);
  CHECK_NEAR(rig.controller->tangent[1], 1.0, 1e-12);
  rig.xdot[0] = 0.05, rig.xdot[1] = -0.01; /* its share along y is -0.2 of 1 */
  rig_step(&rig);
  CHECK_NEAR(rig.controller->tangent[1], 1.0, 1e-12);
  pg_reset(rig.controller);
  memset(rig.qdot, 0, sizeof rig.qdot);
  for (int i = 0; i < 3; i++)
    CHECK_EQUAL(rig.controller->tangent[i], 0.0);
  rig_step(&rig);
  CHECK_NEAR(rig.controller->tangent[1], -1.0, 1e-12);
  rig.points[0] = 3.0; /* nothing is near: forgotten */
  rig_step(&rig);
  CHECK_EQUAL(rig.controller->tangent[1], 0.0);
  rig_close(&rig);
}

/* A fault leaves it as it is. */
static void a_fault_in_between(void) {
  rig_t rig;
  open_beside_forearm(&rig, 0.20);
  rig.xdot[1] = 0.05;
  rig_step(&rig);
  rig.xdot[0] = NAN;
  CHECK_EQUAL(rig_step(&rig), PG_FAULT_NOT_FINITE);
  CHECK_NEAR(rig.controller->tangent[1], 1.0, 1e-12);
  rig_close(&rig);
}

#endif

/* The forearm speeds towards the obstacle at 1 rad/s and can brake by 0.4 per cycle: not even standing still
 * is possible; a retreat that is out of reach ends in standing still. */
static void stages(void) {
  rig_t rig;
  const double towards[PG_N] = {0.0, -1.0};
  rig_open(&rig);
  rig.q[1] = acos(0.0) + 0.4; /* speeding up turns it nowhere: q is what the test says */
  rig_speed_up(&rig, towards);
  rig.q[1] = acos(0.0);
  rig_see(&rig, 0.5 + 0.15, 0.25);
  CHECK_EQUAL(rig_step(&rig), PG_STOPPED_INFEASIBLE);
  rig_close(&rig);

  rig_open(&rig);
  pg_parameters_t p = rig_parameters(&rig);
  p.qddot_limit[0] = p.qddot_limit[1] = 1.0;
  CHECK(pg_set_parameters(rig.controller, &p) == PG_SOLVED);
  rig.q[1] = acos(0.0);
  rig_see(&rig, 0.5 + 0.15, 0.25);
  rig.xdot[0] = 0.2;
  CHECK_EQUAL(rig_step(&rig), PG_REDUCED_REPULSION);
  double velocity[2];
  velocity_of_point(&rig, velocity);
  CHECK_NEAR(velocity[0], PG_WIDTH, 1e-9); /* as the task wants, as far as it may */
  rig_close(&rig);
}

/* A retreat that is slower than PG_WIDTH is given up as well: the arm, which cannot but approach at 7e-6 m/s,
 * is within PG_WIDTH of standing still. */
static void a_slow_retreat_is_raised_too(void) {
  rig_t rig;
  open_beside_forearm(&rig, 0.15);
  pg_parameters_t p = rig_parameters(&rig);
  p.repulse_speed = p.damper_repulse_speed = -5e-6;
  p.qddot_limit[0] = p.qddot_limit[1] = 1e-6;
  CHECK(pg_set_parameters(rig.controller, &p) == PG_SOLVED);
  rig.qdot[1] = rig.controller->qdot_previous[1] = -4.0 * 7e-6;
  CHECK_EQUAL(rig_step(&rig), PG_REDUCED_REPULSION);
  CHECK_NEAR(rig.cycle->ubA[0], PG_WIDTH - 5e-6, 1e-15);
  rig_close(&rig);
}

int main(void) {
  nothing_near();
  rows_that_add_nothing();
  the_nearest_capsule();
#if PG_METHOD_REPULSIVE
  straight_away();
  the_end_of_the_dead_zone();
#else
  along_a_tangent();
  the_last_tangent();
  a_fault_in_between();
#endif
  stages();
  a_slow_retreat_is_raised_too();
  return checks_failed > 0;
}
