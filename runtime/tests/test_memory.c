/* The memory of seen points, of three slots, on the planar arm: what is stored, what is forgotten, and when.
 * The first sensor sits at (0.25, 0.05) of the upper arm and looks along y. */
#include "rig.h"

/* A cycle at an angle of the first joint with this reading of the first sensor; 1.0: nothing seen. */
static pg_status_t look(rig_t *rig, double angle, double reading) {
  rig->q[0] = angle;
  rig->ranges[0] = reading;
  return rig_step(rig);
}

static void set(rig_t *rig, double merge, double reach) {
  pg_parameters_t p = rig_parameters(rig);
  p.memory_merge = merge;
  p.memory_reach = reach;
  CHECK(pg_set_parameters(rig->controller, &p) == PG_SOLVED);
}

/* What was seen from 0 is an obstacle for the arm at another angle, to which the sensor no longer looks. */
static void what_was_seen_stays(void) {
  rig_t rig;
  rig_open(&rig);
  CHECK(look(&rig, 0.0, 0.3) >= PG_SOLVED);
  CHECK_EQUAL(rig.cycle->memory_points, 1);
  CHECK(look(&rig, 0.4, 1.0) >= PG_SOLVED);
  CHECK_EQUAL(rig.cycle->memory_points, 1);
  CHECK_NEAR(rig.cycle->nearest_point[0], 0.25, 1e-12);
  CHECK_NEAR(rig.cycle->nearest_point[1], 0.35, 1e-12);
  CHECK_NEAR(rig.cycle->distance[0], 0.35 * cos(0.4) - 0.25 * sin(0.4), 1e-12);
  CHECK(pg_reset(rig.controller) == PG_SOLVED);
  CHECK(look(&rig, 0.4, 1.0) >= PG_SOLVED);
  CHECK_EQUAL(rig.cycle->memory_points, 0);
  rig_close(&rig);
}

/* A sensor that reads further by more than the margin sees through, within 15 degrees of its normal. */
static void what_is_seen_through(void) {
  rig_t rig;
  rig_open(&rig);
  const double further = 0.3 + 0.1;
  CHECK(look(&rig, 0.0, 0.3) >= PG_SOLVED);
  CHECK(look(&rig, 0.0, further + 5e-10) >= PG_SOLVED); /* the same to 1e-9 m: that point is added */
  CHECK_EQUAL(rig.cycle->memory_points, 2);
  CHECK(look(&rig, 0.0, further + 2e-9) >= PG_SOLVED); /* takes the place of the second one */
  CHECK_EQUAL(rig.cycle->memory_points, 1);
  CHECK(look(&rig, 0.0, 1.0) >= PG_SOLVED);
  CHECK_EQUAL(rig.cycle->memory_points, 0);

  /* From another angle the point is at (x, y) before the sensor; 15 degrees are where x = y tan(15). */
  for (int beyond = 0; beyond < 2; beyond++) {
    CHECK(pg_reset(rig.controller) == PG_SOLVED);
    CHECK(look(&rig, 0.0, 0.3) >= PG_SOLVED);
    double low = 0.0, high = 0.5;
    for (int i = 0; i < 60; i++) {
      const double angle = 0.5 * (low + high);
      const double x = 0.25 * cos(angle) + 0.35 * sin(angle) - 0.25,
                   y = 0.35 * cos(angle) - 0.25 * sin(angle) - 0.05;
      *(x < y * tan(acos(-1.0) / 12.0) ? &low : &high) = angle;
    }
    CHECK(look(&rig, low + (beyond ? 1e-6 : -1e-6), 1.0) >= PG_SOLVED);
    CHECK_EQUAL(rig.cycle->memory_points, beyond);
  }
  rig_close(&rig);
}

static void what_is_old(void) {
  rig_t rig;
  rig_open(&rig);
  CHECK(look(&rig, 0.0, 0.3) >= PG_SOLVED);
  const double seen = rig.seen.time;
  rig.q[0] = 0.4;
  rig.ranges[0] = 1.0;
  rig.seen.time = seen + 10.0;
  CHECK(rig_step_now(&rig) >= PG_SOLVED);
  CHECK_EQUAL(rig.cycle->memory_points, 1);
  rig.seen.time = seen + 10.001;
  CHECK(rig_step_now(&rig) >= PG_SOLVED);
  CHECK_EQUAL(rig.cycle->memory_points, 0);
  rig_close(&rig);
}

/* The upper arm moves to where the point was: then there is no obstacle. */
static void where_the_arm_is(void) {
  rig_t rig;
  rig_open(&rig);
  CHECK(look(&rig, 0.0, 0.15) >= PG_SOLVED); /* at (0.25, 0.2) */
  const double angle = atan2(0.2, 0.25), distance = hypot(0.2, 0.25);
  CHECK(look(&rig, angle - asin((0.05 + 2e-9) / distance), 1.0) >= PG_SOLVED);
  CHECK_EQUAL(rig.cycle->memory_points, 1);
  CHECK(look(&rig, angle - asin((0.05 + 5e-10) / distance), 1.0) >= PG_SOLVED);
  CHECK_EQUAL(rig.cycle->memory_points, 0);
  rig_close(&rig);
}

static void near_points_are_one(void) {
  rig_t rig;
  rig_open(&rig);
  CHECK(look(&rig, 0.0, 0.10) >= PG_SOLVED);
  CHECK(look(&rig, 0.0, 0.14 + 5e-10) >= PG_SOLVED); /* 0.04 m to 1e-9 m: moves the slot */
  CHECK_EQUAL(rig.cycle->memory_points, 1);
  CHECK_NEAR(rig.controller->memory[0].point[1], 0.19, 1e-9);
  CHECK_EQUAL(rig.controller->memory[0].time, rig.seen.time);
  CHECK(look(&rig, 0.0, 0.18 + 3e-9) >= PG_SOLVED);
  CHECK_EQUAL(rig.cycle->memory_points, 2);
  CHECK(look(&rig, 0.0, 0.16 + 2e-9) >= PG_SOLVED); /* as near to either to 1e-9 m, so the first */
  CHECK_EQUAL(rig.cycle->memory_points, 2);
  CHECK_NEAR(rig.controller->memory[0].point[1], 0.21, 1e-8);
  CHECK_NEAR(rig.controller->memory[1].point[1], 0.23, 1e-8);
  CHECK(look(&rig, 0.0, 0.18) >= PG_SOLVED); /* nearer to the second */
  CHECK_EQUAL(rig.controller->memory[1].time, rig.seen.time);
  rig_close(&rig);
}

/* The fourth point takes the place of the oldest; then a free slot comes before the oldest again. */
static void more_points_than_slots(void) {
  rig_t rig;
  rig_open(&rig);
  set(&rig, 0.0, 0.5);
  for (int i = 0; i < 5; i++) {
    CHECK(look(&rig, 0.0, 0.30 - 0.01 * i) >= PG_SOLVED); /* nearer and nearer: nothing is seen through */
    CHECK_EQUAL(rig.cycle->memory_points, i < 3 ? i + 1 : 3);
  }
  const double kept[3] = {0.27, 0.26, 0.28};
  for (int k = 0; k < 3; k++)
    CHECK_NEAR(rig.controller->memory[k].point[1], 0.05 + kept[k], 1e-12);
  rig.controller->memory[1].used = 0;
  CHECK(look(&rig, 0.0, 0.20) >= PG_SOLVED);
  CHECK_NEAR(rig.controller->memory[1].point[1], 0.25, 1e-12);
  CHECK_EQUAL(rig.cycle->memory_points, 3);
  rig_close(&rig);
}

/* Within reach of an axis to 1e-9 m; only what range sensors see. */
static void what_is_not_stored(void) {
  rig_t rig;
  rig_open(&rig);
  set(&rig, 0.04, 0.5);
  CHECK(look(&rig, 0.0, 0.45 + 2e-9) >= PG_SOLVED);
  CHECK_EQUAL(rig.cycle->memory_points, 0);
  CHECK(look(&rig, 0.0, 0.45 + 5e-10) >= PG_SOLVED);
  CHECK_EQUAL(rig.cycle->memory_points, 1);
  CHECK(pg_reset(rig.controller) == PG_SOLVED);
  rig.switches[0] = 1;
  rig_see(&rig, 0.25, 0.3);
  CHECK(look(&rig, 0.0, 1.0) >= PG_SOLVED);
  CHECK_EQUAL(rig.cycle->memory_points, 0);
  CHECK_NEAR(rig.cycle->distance[0], 0.3, 1e-12);
  rig_close(&rig);
}

/* A fault of the input leaves the memory, and does not report it; an obstacle in the arm is found later. */
static void faults(void) {
  rig_t rig;
  rig_open(&rig);
  CHECK(look(&rig, 0.0, 0.3) >= PG_SOLVED);
  CHECK_EQUAL(look(&rig, 0.0, NAN), PG_FAULT_NOT_FINITE);
  CHECK_EQUAL(rig.cycle->memory_points, 0);
  rig.seen.time -= 1.0;
  CHECK_EQUAL(look(&rig, 0.0, 1.0), PG_FAULT_TIME);
  rig.seen.time += 1.0;
  CHECK(pg_step(rig.controller, rig.q, rig.xdot, NULL, rig.qdot) == PG_ERROR_NULL);
  CHECK(look(&rig, 0.4, 1.0) >= PG_SOLVED);
  CHECK_EQUAL(rig.cycle->memory_points, 1);
  rig_see(&rig, 0.0, 0.0);
  CHECK_EQUAL(look(&rig, 0.0, 0.2), PG_FAULT_OBSTACLE_INSIDE);
  CHECK_EQUAL(rig.cycle->memory_points, 0);
  rig.seen.point_count = 0;
  CHECK(look(&rig, 0.4, 1.0) >= PG_SOLVED);
  CHECK_EQUAL(rig.cycle->memory_points, 2);
  rig_close(&rig);
}

int main(void) {
  what_was_seen_stays();
  what_is_seen_through();
  what_is_old();
  where_the_arm_is();
  near_points_are_one();
  more_points_than_slots();
  what_is_not_stored();
  faults();
  return checks_failed > 0;
}
