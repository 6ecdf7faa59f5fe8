/* From readings to nearest points and rows, against closed forms and the generated functions. */
#include "geometry.h"
#include "rig.h"

static void inline_geometry_is_that_of_the_model(void) {
  random_t random = {7};
  for (int i = 0; i < 1000; i++) {
    double point[3], start[3], end[3], pose[12], wanted[3], d[3], t;
    for (int k = 0; k < 3; k++) {
      point[k] = between(&random, -1.0, 1.0);
      start[k] = between(&random, -1.0, 1.0);
      end[k] = i % 10 == 0 ? start[k] : between(&random, -1.0, 1.0);
    }
    for (int k = 0; k < 12; k++)
      pose[k] = between(&random, -1.0, 1.0);
    pg_segment_t segment = {.start = {start[0], start[1], start[2]}};
    for (int k = 0; k < 3; k++)
      segment.axis[k] = end[k] - start[k];
    const double squared_length = pg_dot(segment.axis, segment.axis);
    segment.inverse_squared_length = squared_length > 0.0 ? 1.0 / squared_length : 0.0;

    const double squared = pg_from_segment(&segment, point, d, &t);
    CHECK(pg_model_closest_point(point, start, end, wanted) == 0);
    for (int k = 0; k < 3; k++) {
      CHECK_NEAR(segment.start[k] + t * segment.axis[k], wanted[k], 1e-14);
      CHECK_NEAR(d[k], point[k] - wanted[k], 1e-14);
    }
    CHECK_NEAR(squared, pg_dot(d, d), 1e-14);

    const double range = between(&random, 0.0, 1.0),
                 seen[3] = {start[0] + range * end[0], start[1] + range * end[1], start[2] + range * end[2]};
    double moved[3];
    pg_transform(pose, seen, moved);
    CHECK(pg_model_sensor_point(pose, start, end, range, wanted) == 0);
    for (int k = 0; k < 3; k++)
      CHECK_NEAR(moved[k], wanted[k], 1e-14);
  }
}

static void each_sensor_counts(void) {
  rig_t rig;
  rig_open(&rig);
  for (int i = 0; i < PG_TOF; i++) { /* 0.05 m off the axis, on either side of either link */
    rig.ranges[i] = 0.1;
    CHECK(rig_step(&rig) <= PG_REDUCED_REPULSION);
    const int link = i / 2;
    CHECK_NEAR(rig.cycle->distance[link], 0.15, 1e-12);
    CHECK_NEAR(rig.cycle->nearest_point[3 * link + 1], i % 2 ? -0.15 : 0.15, 1e-12);
    CHECK_NEAR(rig.cycle->nearest_point[3 * link], 0.25 + 0.5 * link, 1e-12);
    rig.ranges[i] = pg_model_tof[i].range; /* nothing seen */
  }
  for (int i = 0; i < PG_CAPACITIVE; i++) { /* 0.08 m in front of the switch */
    rig.switches[i] = 255;
    CHECK(rig_step(&rig) <= PG_REDUCED_REPULSION);
    CHECK_NEAR(rig.cycle->distance[1], 0.13, 1e-12);
    rig.switches[i] = 0;
  }
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  for (int l = 0; l < PG_CAPSULES; l++) {
    CHECK(isinf(rig.cycle->distance[l]) && isinf(rig.cycle->approach_speed[l]));
    CHECK(isnan(rig.cycle->nearest_point[3 * l]));
    CHECK(!rig.cycle->row_on[l]);
    CHECK_EQUAL(rig.cycle->ubA[l], PG_OFF);
  }
  rig_close(&rig);
}

/* The elbow's sphere moves with the first link and measures to its surface. */
static void the_nearest_point_of_each_capsule(void) {
  rig_t rig;
  rig_open(&rig);
  rig_see(&rig, 0.25, 0.9);   /* too far for anything */
  rig_see(&rig, 0.25, 0.28);  /* upper arm */
  rig_see(&rig, 0.25, -0.28); /* as near: the first is kept */
  rig_see(&rig, 0.50, 0.30);  /* elbow: 0.23 to its surface */
  rig_see(&rig, 0.75, -0.2);  /* forearm */
  CHECK(rig_step(&rig) <= PG_REDUCED_REPULSION);
  const pg_diagnostics_t *cycle = rig.cycle;
  CHECK_NEAR(cycle->distance[0], 0.28, 1e-12);
  CHECK_NEAR(cycle->nearest_point[1], 0.28, 1e-12);
  CHECK_NEAR(cycle->distance[1], 0.2, 1e-12);
  CHECK_NEAR(cycle->distance[2], 0.23, 1e-12);
  CHECK_NEAR(cycle->A[2], -0.75, 1e-12); /* forearm: both joints, away from the obstacle below */
  CHECK_NEAR(cycle->A[3], -0.25, 1e-12);
  CHECK_NEAR(cycle->A[4], 0.5, 1e-12);
  CHECK_EQUAL(cycle->A[5], 0.0);
#if PG_ACTIVE_ROW
  const double weights = 1.0 / 0.28 + 1.0 / 0.2 + 1.0 / 0.23;
  CHECK_NEAR(cycle->A[6], (0.25 / 0.28 - 0.75 / 0.2 + 0.5 / 0.23) / weights, 1e-12);
  CHECK_NEAR(cycle->A[7], (-0.25 / 0.2) / weights, 1e-12);
  CHECK_EQUAL(cycle->ubA[PG_CAPSULES], 0.0);
#endif
  rig_close(&rig);
}

/* What rounding leaves of equal distances does not decide: neither between points, nor against a
 * threshold. */
static void equal_distances(void) {
  rig_t rig;
  rig_open(&rig);
  rig_see(&rig, 0.25, 0.28);
  rig_see(&rig, 0.25, -(0.28 - 5e-10));
  CHECK(rig_step(&rig) <= PG_REDUCED_REPULSION);
  CHECK_NEAR(rig.cycle->nearest_point[1], 0.28, 1e-12);
  rig.points[4] = -(0.28 - 2e-9);
  CHECK(rig_step(&rig) <= PG_REDUCED_REPULSION);
  CHECK_NEAR(rig.cycle->nearest_point[1], -0.28, 1e-8);
  rig.seen.point_count = 1;
  rig.points[1] = 0.3 + 5e-10;
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK(rig.cycle->row_on[0]);
  rig.points[1] = 0.3 + 2e-9;
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK(!rig.cycle->row_on[0]);
  rig_close(&rig);
}

/* No row is ever zero, and one that is off keeps the direction that it had: with this, hot starts
 * are right. */
static void rows_keep_their_directions(void) {
  rig_t rig;
  rig_open(&rig);
  random_t random = {11};
  double last[PG_ROWS * PG_N] = {0.0};
  for (int i = 0; i < 20000; i++) {
    for (int j = 0; j < PG_N; j++)
      rig.q[j] = between(&random, -2.4, 2.4);
    rig.xdot[0] = between(&random, -0.25, 0.25);
    rig.seen.point_count = 0;
    const int points = (int)between(&random, 0.0, 4.0);
    for (int k = 0; k < points; k++)
      rig_see(&rig, between(&random, -1.0, 1.0), between(&random, -1.0, 1.0));
    CHECK(rig_step(&rig) <= PG_STOPPED_INFEASIBLE);
    for (int slot = 0; slot < PG_ROWS; slot++) {
      const double *row = &rig.cycle->A[slot * PG_N];
      CHECK(hypot(row[0], row[1]) >= 1e-6);
      if (!rig.cycle->row_on[slot] && i > 0)
        CHECK(row[0] == last[slot * PG_N] && row[1] == last[slot * PG_N + 1]);
      CHECK((rig.cycle->ubA[slot] < PG_OFF) == rig.cycle->row_on[slot]);
    }
    memcpy(last, rig.cycle->A, sizeof last);
  }
  pg_counters_t counters;
  pg_counters(rig.controller, &counters);
  CHECK_EQUAL(counters.status_count[PG_STOPPED_SOLVER], 0);
  rig_close(&rig);
}

int main(void) {
  inline_geometry_is_that_of_the_model();
  each_sensor_counts();
  the_nearest_point_of_each_capsule();
  equal_distances();
  rows_keep_their_directions();
  return checks_failed > 0;
}
