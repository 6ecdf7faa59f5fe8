/* The table of faults: each wrong input has its status, and every one ends in a stop within the bounds. */
#include "rig.h"

static const double moving[PG_N] = {1.0, -0.7};

/* A fault of an arm that moves: the status, and a stop (checked by the rig) that ends at zero. */
static void expect_stop(rig_t *rig, pg_status_t wanted) {
  CHECK_EQUAL(rig_step(rig), wanted);
  CHECK_EQUAL(rig->cycle->solves, 0);
  CHECK(isnan(rig->cycle->kkt_residual));
  for (int i = 0; i < 5; i++)
    CHECK_EQUAL(rig_step(rig), wanted);
  for (int j = 0; j < PG_N; j++)
    CHECK_EQUAL(rig->qdot[j], 0.0);
}

/* Runs `expect_stop` for an arm that moves, with one value of its input replaced. */
static void expect_stop_for(double *place, double value, rig_t *rig, pg_status_t wanted) {
  const double before = *place;
  rig_speed_up(rig, moving);
  *place = value;
  expect_stop(rig, wanted);
  *place = before;
  CHECK_EQUAL(rig_step(rig), PG_SOLVED);
}

static void values_that_are_not_finite(void) {
  rig_t rig;
  rig_open(&rig);
  rig_see(&rig, 2.0, 2.0);
  rig.seen.tof_age = rig.ages;
  rig.seen.capacitive_age = rig.switch_ages;
  const double wrong[] = {NAN, INFINITY, -INFINITY};
  for (int i = 0; i < 3; i++) {
    expect_stop_for(&rig.q[1], wrong[i], &rig, PG_FAULT_NOT_FINITE);
    expect_stop_for(&rig.xdot[0], wrong[i], &rig, PG_FAULT_NOT_FINITE);
    expect_stop_for(&rig.ranges[PG_TOF - 1], wrong[i], &rig, PG_FAULT_NOT_FINITE);
    expect_stop_for(&rig.ages[0], wrong[i], &rig, PG_FAULT_NOT_FINITE);
    expect_stop_for(&rig.switch_ages[1], wrong[i], &rig, PG_FAULT_NOT_FINITE);
    expect_stop_for(&rig.points[1], wrong[i], &rig, PG_FAULT_NOT_FINITE);
  }
  rig_close(&rig);
}

static void a_time_that_is_not_finite_is_forgotten(void) {
  rig_t rig;
  rig_open(&rig);
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  const double time = rig.seen.time;
  rig.seen.time = INFINITY;
  CHECK_EQUAL(rig_step_now(&rig), PG_FAULT_NOT_FINITE);
  rig.seen.time = NAN;
  CHECK_EQUAL(rig_step_now(&rig), PG_FAULT_NOT_FINITE);
  rig.seen.time = time;
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  rig_close(&rig);
}

static void joint_outside_its_limits(void) {
  rig_t rig;
  rig_open(&rig);
  const pg_parameters_t p = rig_parameters(&rig);
  expect_stop_for(&rig.q[0], p.q_upper[0] + p.limit_tolerance + 1e-6, &rig, PG_FAULT_JOINT_LIMIT);
  expect_stop_for(&rig.q[1], p.q_lower[1] - p.limit_tolerance - 1e-6, &rig, PG_FAULT_JOINT_LIMIT);
  rig.q[0] = p.q_upper[0] + p.limit_tolerance; /* just tolerated: no way but back */
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK(rig.qdot[0] <= 0.0);
  rig_close(&rig);
}

static void readings_that_no_sensor_gives(void) {
  rig_t rig;
  rig_open(&rig);
  rig.seen.tof_age = rig.ages;
  expect_stop_for(&rig.ranges[0], -1e-9, &rig, PG_FAULT_READING);
  expect_stop_for(&rig.ranges[3], pg_model_tof[3].range + 1e-9, &rig, PG_FAULT_READING);
  expect_stop_for(&rig.ages[2], -1e-9, &rig, PG_FAULT_READING);
  rig_close(&rig);
}

static void sensors_that_are_silent(void) {
  rig_t rig;
  rig_open(&rig);
  const double timeout = rig_parameters(&rig).sensor_timeout;
  rig.seen.tof_age = rig.ages;
  rig.seen.capacitive_age = rig.switch_ages;
  rig.ages[0] = timeout;
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  expect_stop_for(&rig.ages[0], timeout * (1.0 + 1e-9), &rig, PG_FAULT_STALE);
  expect_stop_for(&rig.switch_ages[PG_CAPACITIVE - 1], 10.0 * timeout, &rig, PG_FAULT_STALE);
  rig_close(&rig);
}

static void time_that_stands_or_runs_backwards(void) {
  rig_t rig;
  rig_open(&rig);
  rig_speed_up(&rig, moving);
  const double time = rig.seen.time;
  CHECK_EQUAL(rig_step_now(&rig), PG_FAULT_TIME);
  rig.seen.time = time - 1.0;
  CHECK_EQUAL(rig_step_now(&rig), PG_FAULT_TIME);
  rig.seen.time = time - 0.5;
  CHECK_EQUAL(rig_step_now(&rig), PG_FAULT_TIME); /* the old time still counts */
  rig.seen.time = time;
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK(pg_reset(rig.controller) == PG_SOLVED); /* a new start: any time is later */
  memset(rig.qdot, 0, sizeof rig.qdot);
  rig.seen.time = -1000.0;
  CHECK_EQUAL(rig_step_now(&rig), PG_SOLVED);
  rig_close(&rig);
}

static void a_deadline_that_is_missed(void) {
  rig_t rig;
  rig_open(&rig);
  pg_parameters_t p = rig_parameters(&rig);
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  rig.seen.time += 1000.0; /* max_period 0: not checked */
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  p.max_period = 0.125;
  CHECK(pg_set_parameters(rig.controller, &p) == PG_SOLVED);
  rig.seen.time = 8.0;
  CHECK_EQUAL(rig_step_now(&rig), PG_FAULT_TIME); /* before the last cycle */
  CHECK(pg_reset(rig.controller) == PG_SOLVED);
  memset(rig.qdot, 0, sizeof rig.qdot);
  CHECK_EQUAL(rig_step_now(&rig), PG_SOLVED);
  rig.seen.time = 8.125; /* just in time */
  CHECK_EQUAL(rig_step_now(&rig), PG_SOLVED);
  rig_speed_up(&rig, moving);
  rig.seen.time += 0.125;
  CHECK_EQUAL(rig_step(&rig), PG_FAULT_DEADLINE);
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED); /* the late time was taken note of */
  rig.q[0] = NAN;
  for (int i = 0; i < 10; i++) /* for 0.2 s no time is taken note of */
    CHECK_EQUAL(rig_step(&rig), PG_FAULT_NOT_FINITE);
  rig.q[0] = 0.0;
  CHECK_EQUAL(rig_step(&rig), PG_FAULT_DEADLINE);
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  rig_close(&rig);
}

static void an_obstacle_inside_the_arm(void) {
  rig_t rig;
  rig_open(&rig);
  rig_speed_up(&rig, moving);
  rig_see(&rig, 0.3, 1e-7);
  expect_stop(&rig, PG_FAULT_OBSTACLE_INSIDE);
  rig.points[1] = 2e-6; /* a direction to leave it */
  CHECK(rig_step(&rig) <= PG_REDUCED_CRITICAL);
  rig_close(&rig);
}

/* What is wrong with the time is remembered even if something else decides the status. */
static void the_first_fault_decides(void) {
  rig_t rig;
  rig_open(&rig);
  pg_parameters_t p = rig_parameters(&rig);
  p.max_period = 0.5;
  CHECK(pg_set_parameters(rig.controller, &p) == PG_SOLVED);
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  rig.seen.tof_age = rig.ages;
  rig.ages[0] = 1.0;
  rig.seen.time += 1.0;
  CHECK_EQUAL(rig_step(&rig), PG_FAULT_DEADLINE); /* before STALE */
  rig.seen.time -= 1.0;
  CHECK_EQUAL(rig_step_now(&rig), PG_FAULT_TIME);
  rig.ranges[0] = -1.0;
  CHECK_EQUAL(rig_step_now(&rig), PG_FAULT_READING);
  rig.q[0] = 3.0;
  CHECK_EQUAL(rig_step_now(&rig), PG_FAULT_JOINT_LIMIT);
  rig.xdot[1] = NAN;
  CHECK_EQUAL(rig_step_now(&rig), PG_FAULT_NOT_FINITE);
  rig_close(&rig);
}

/* All range sensors, all switches, or both: their points count, 0.05 m and 0.13 m from the axes. */
static void all_sensors_blocked(void) {
  for (int kinds = 1; kinds <= 3; kinds++) {
    rig_t rig;
    rig_open(&rig);
    rig.xdot[1] = 0.2;
    if (kinds & 1) memset(rig.ranges, 0, sizeof rig.ranges);
    if (kinds & 2) memset(rig.switches, 1, sizeof rig.switches);
    const int solved =
        PG_RELAXATION_SLACK || kinds == 2; /* switches are as far: the first one's side counts */
    for (int i = 0; i < 10; i++) {
      const pg_status_t status = rig_step(&rig);
      CHECK(solved ? status == PG_SOLVED : status > PG_SOLVED && status <= PG_STOPPED_INFEASIBLE);
      double nearest = INFINITY;
      for (int l = 0; l < PG_CAPSULES; l++)
        nearest = fmin(nearest, rig.cycle->distance[l]);
      CHECK(nearest <= (kinds & 1 ? 0.05 : 0.13) + 1e-9);
    }
    rig_close(&rig);
  }
}

static void obstacles_on_both_sides(void) {
  rig_t rig;
  rig_open(&rig);
  rig.q[0] = 0.3, rig.q[1] = 0.6;
  const double c = cos(0.3), s = sin(0.3), side[] = {0.1, -0.15};
  for (int i = 0; i < 2;
       i++) /* beside the upper arm and beside the elbow: their rows ask for opposite motions */
    rig_see(&rig, (0.25 + 0.25 * i) * c - side[i] * s, (0.25 + 0.25 * i) * s + side[i] * c);
  rig.xdot[0] = 0.2;
  for (int i = 0; i < 10; i++)
    CHECK_EQUAL(rig_step(&rig), PG_RELAXATION_SLACK ? PG_SOLVED : PG_REDUCED_REPULSION);
  if (!PG_RELAXATION_SLACK) CHECK_NEAR(rig.qdot[0], 0.0, 1e-8);
  rig_close(&rig);
}

static void a_singular_configuration(void) {
  rig_t rig;
  rig_open(&rig);
  rig.xdot[0] = 0.25; /* stretched along x: no joint moves the tool this way */
  for (int i = 0; i < 10; i++)
    CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK_NEAR(rig.cycle->manipulability, 0.0, 1e-12);
  CHECK_NEAR(rig.cycle->damping, 0.1, 1e-12);
  CHECK_NEAR(rig.qdot[0], 0.0, 1e-9);
  rig.q[1] = 1e-3; /* nearly stretched: undamped, the joints would turn as fast as they may */
  for (int i = 0; i < 10; i++)
    CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK(fabs(rig.qdot[0]) < 0.01 && fabs(rig.qdot[1]) < 0.01);
  rig_close(&rig);
}

static void values_at_the_end_of_the_number_range(void) {
  rig_t rig;
  rig_open(&rig);
  rig_see(&rig, 1e300, -1e300);
  rig_see(&rig, 1e-300, 1e200);
  rig.xdot[0] = -1e308, rig.xdot[1] = 1e308;
  CHECK(rig_step(&rig) <= PG_STOPPED_SOLVER);
  for (int exponent = 0; exponent <= 308; exponent++) { /* a success is certified: the rig looks */
    rig.xdot[0] = -pow(10.0, exponent), rig.xdot[1] = pow(10.0, 308 - exponent);
    CHECK(rig_step(&rig) <= PG_STOPPED_SOLVER);
  }
  rig.xdot[0] = rig.xdot[1] = 0.0;
  rig.seen.time = 1e300;
  CHECK_EQUAL(rig_step_now(&rig), PG_SOLVED);
  rig_close(&rig);
}

static void calls_that_are_wrong(void) {
  rig_t rig;
  rig_open(&rig);
  rig_speed_up(&rig, moving);
  double qdot[PG_N] = {9.0, 9.0};
  CHECK_EQUAL(pg_step(NULL, rig.q, rig.xdot, &rig.seen, qdot), PG_ERROR_NULL);
  CHECK(qdot[0] == 0.0 && qdot[1] == 0.0);
  CHECK_EQUAL(pg_step(rig.controller, rig.q, rig.xdot, &rig.seen, NULL), PG_ERROR_NULL);

  CHECK_EQUAL(pg_step(rig.controller, NULL, rig.xdot, &rig.seen, rig.qdot), PG_ERROR_NULL);
  CHECK_NEAR(rig.qdot[0], moving[0] - MOST_ACCELERATION, 1e-5);
  CHECK_EQUAL(pg_step(rig.controller, rig.q, NULL, &rig.seen, rig.qdot), PG_ERROR_NULL);
  CHECK_EQUAL(pg_step(rig.controller, rig.q, rig.xdot, NULL, rig.qdot), PG_ERROR_NULL);
  CHECK(rig.qdot[0] == 0.0 && rig.qdot[1] == 0.0);
  rig.seen.tof_range = NULL;
  CHECK_EQUAL(rig_step(&rig), PG_ERROR_NULL);
  rig.seen.tof_range = rig.ranges;
  rig.seen.capacitive = NULL;
  CHECK_EQUAL(rig_step(&rig), PG_ERROR_NULL);
  rig.seen.capacitive = rig.switches;
  rig.seen.points = NULL;
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  rig.seen.point_count = 1;
  CHECK_EQUAL(rig_step(&rig), PG_ERROR_NULL);
  rig.seen.points = rig.points;
  rig.seen.point_count = PG_MAX_POINTS + 1;
  CHECK_EQUAL(rig_step(&rig), PG_ERROR_SIZE);
  rig.seen.point_count = -1;
  CHECK_EQUAL(rig_step(&rig), PG_ERROR_SIZE);

  pg_counters_t counters;
  CHECK(pg_counters(rig.controller, &counters) == PG_SOLVED);
  CHECK_EQUAL(counters.errors, 9); /* all but the one that had no controller to count it */
  CHECK_EQUAL(counters.cycles, 21);
  rig_close(&rig);
}

int main(void) {
  values_that_are_not_finite();
  a_time_that_is_not_finite_is_forgotten();
  joint_outside_its_limits();
  readings_that_no_sensor_gives();
  sensors_that_are_silent();
  time_that_stands_or_runs_backwards();
  a_deadline_that_is_missed();
  an_obstacle_inside_the_arm();
  the_first_fault_decides();
  all_sensors_blocked();
  obstacles_on_both_sides();
  a_singular_configuration();
  values_at_the_end_of_the_number_range();
  calls_that_are_wrong();
  return checks_failed > 0;
}
