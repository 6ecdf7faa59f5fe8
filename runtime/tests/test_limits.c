/* Joint limits, velocity and acceleration bounds, in closed loop with a plant that does what it is told. */
#include "rig.h"

#define HARD 1e20

static void drive_into_the_limit(double joint_damper, double viability, double acceleration,
                                 double overshoot) {
  rig_t rig;
  rig_open(&rig);
  pg_parameters_t p = rig_parameters(&rig);
  p.joint_damper = joint_damper;
  p.viability = viability;
  p.qddot_limit[0] = p.qddot_limit[1] = acceleration;
  p.posture_weight[0] = p.posture_weight[1] = 1e3;
  p.posture[0] = 10.0, p.posture[1] = -10.0; /* far beyond both limits */
  CHECK(pg_set_parameters(rig.controller, &p) == PG_SOLVED);
  double greatest = -INFINITY, least = INFINITY, last[PG_N] = {0.0};
  for (int i = 0; i < 500; i++) {
    const pg_status_t status = rig_step(&rig);
    CHECK_EQUAL(status, PG_SOLVED);
    for (int j = 0; j < PG_N && viability > 0.5; j++)
      CHECK(fabs(rig.qdot[j] - last[j]) <= acceleration * p.period + 1e-9);
    memcpy(last, rig.qdot, sizeof last);
    for (int j = 0; j < PG_N; j++)
      rig.q[j] += p.period * rig.qdot[j];
    greatest = fmax(greatest, rig.q[0]);
    least = fmin(least, rig.q[1]);
  }
  CHECK(greatest <= p.q_upper[0] + overshoot && greatest >= p.q_upper[0] - 0.02);
  CHECK(least >= p.q_lower[1] - overshoot && least <= p.q_lower[1] + 0.02);
  rig_close(&rig);
}

static void the_velocity_changes_no_faster_than_allowed(void) {
  rig_t rig;
  rig_open(&rig);
  random_t random = {3};
  double last[PG_N] = {0.0};
  for (int i = 0; i < 5000; i++) {
    if (i % 7 == 0)
      for (int j = 0; j < PG_M; j++)
        rig.xdot[j] = between(&random, -1.0, 1.0);
    rig.q[0] = 0.5, rig.q[1] = 1.0;
    rig.seen.point_count = 0;
    rig_see(&rig, between(&random, -1.0, 1.0), between(&random, -1.0, 1.0));
    if (i % 13 == 0) rig.ranges[0] = -1.0; /* a fault now and then */
    rig_step(&rig);
    rig.ranges[0] = pg_model_tof[0].range;
    for (int j = 0; j < PG_N; j++)
      CHECK(fabs(rig.qdot[j] - last[j]) <= MOST_ACCELERATION + 1e-12);
    memcpy(last, rig.qdot, sizeof last);
  }
  rig_close(&rig);
}

/* A limit that is set below the present velocity wins over the acceleration bound. */
static void limits_win(void) {
  const double moving[PG_N] = {1.2, -1.2};
  for (int position_is_known = 0; position_is_known <= 1; position_is_known++) {
    rig_t rig;
    rig_open(&rig);
    rig_speed_up(&rig, moving);
    pg_parameters_t p = rig_parameters(&rig);
    p.qdot_limit[0] = p.qdot_limit[1] = 0.3;
    CHECK(pg_set_parameters(rig.controller, &p) == PG_SOLVED);
    if (!position_is_known) rig.q[0] = NAN;
    CHECK_EQUAL(pg_step(rig.controller, rig.q, rig.xdot, &rig.seen, rig.qdot),
                position_is_known ? PG_FAULT_TIME : PG_FAULT_NOT_FINITE);
    CHECK(rig.qdot[0] == 0.3 && rig.qdot[1] == -0.3);
    CHECK(rig_within_bounds(&rig));
    rig_close(&rig);
  }
}

/* Both bounds of a joint may be one value: a joint at its limit that may not even leave it. */
static void bounds_that_are_equal(void) {
  rig_t rig;
  rig_open(&rig);
  pg_parameters_t p = rig_parameters(&rig);
  p.qddot_limit[0] = 1e-9; /* nothing may change */
  CHECK(pg_set_parameters(rig.controller, &p) == PG_SOLVED);
  rig.q[1] = 1.0;
  rig.xdot[0] = -0.2, rig.xdot[1] = 0.2;
  rig_see(&rig, 0.5, 0.8);
  for (int i = 0; i < 10; i++)
    CHECK(rig_step(&rig) <= PG_REDUCED_REPULSION);
  CHECK_NEAR(rig.qdot[0], 0.0, 1e-9);
  CHECK(fabs(rig.qdot[1]) > 0.01);
  rig_close(&rig);
}

int main(void) {
  drive_into_the_limit(HARD, 0.0, 1e3, 1.5 * 0.02 + 2.0 * 0.02);
  drive_into_the_limit(5.0, 0.0, 20.0, 1e-9);
  drive_into_the_limit(HARD, 1.0, 20.0, 1e-9);
  drive_into_the_limit(5.0, 1.0, 2.0, 1e-9);
  the_velocity_changes_no_faster_than_allowed();
  limits_win();
  bounds_that_are_equal();
  return checks_failed > 0;
}
