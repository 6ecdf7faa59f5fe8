/* What sensors read of the planar arm itself, against distances worked out in the plane.
 *
 * The elbow is bent by pi - fold, so that the forearm points back along the upper arm and above it: to the
 * upper arm's sensor that looks up, and the forearm's switch that looks down, the other link is in front. */
#include "rig.h"

static void open_folded(rig_t *rig, double fold) {
  rig_open(rig);
  pg_parameters_t p = rig_parameters(rig);
  p.q_upper[1] = 4.0;
  CHECK(pg_set_parameters(rig->controller, &p) == PG_SOLVED);
  rig->q[1] = acos(-1.0) - fold;
}

static void set_margin(rig_t *rig, double margin) {
  pg_parameters_t p = rig_parameters(rig);
  p.self_measurement_margin = margin;
  CHECK(pg_set_parameters(rig->controller, &p) == PG_SOLVED);
}

static int own_readings(rig_t *rig) {
  CHECK(rig_step(rig) >= PG_SOLVED);
  return rig->cycle->self_readings;
}

/* Distance of a place (x, y, z) from the forearm's axis, which begins at the elbow. */
static double from_forearm(double fold, double x, double y, double z) {
  const double along[2] = {-cos(fold), sin(fold)}, from_elbow[2] = {x - PLANAR_LENGTH, y};
  const double t = fmin(fmax(from_elbow[0] * along[0] + from_elbow[1] * along[1], 0.0), PLANAR_LENGTH);
  return sqrt(pow(from_elbow[0] - t * along[0], 2.0) + pow(from_elbow[1] - t * along[1], 2.0) + z * z);
}

/* Least distance of the five places that a reading of the sensor at (0.25, 0.05) may come from. */
static double least_of_rays(double fold, double reading) {
  const double s = reading * 0.5, c = 0.05 + reading * sqrt(0.75);
  const double places[5][3] = {
      {0.25, 0.05 + reading, 0.0}, {0.25 + s, c, 0.0}, {0.25 - s, c, 0.0}, {0.25, c, s}, {0.25, c, -s}};
  double least = INFINITY;
  for (int ray = 0; ray < 5; ray++)
    least = fmin(least, from_forearm(fold, places[ray][0], places[ray][1], places[ray][2]));
  return least;
}

static void readings_that_the_other_link_explains(void) {
  random_t random = {3};
  int explained = 0;
  for (int i = 0; i < 500; i++) {
    rig_t rig;
    const double fold = between(&random, 0.3, 1.4);
    open_folded(&rig, fold);
    rig.ranges[0] = between(&random, 0.0, 0.6);
    const double gap = least_of_rays(fold, rig.ranges[0]) - 0.05;
    if (gap > 0.0) {
      set_margin(&rig, gap - 5e-10 > 0.0 ? gap - 5e-10 : 0.0); /* at most the margin away: to 1e-9 m */
      CHECK_EQUAL(own_readings(&rig), 1);
      CHECK(isinf(rig.cycle->distance[0]));
      set_margin(&rig, gap - 2e-9 > 0.0 ? gap - 2e-9 : 0.0);
    }
    const int own = gap <= 1e-9;
    CHECK_EQUAL(own_readings(&rig), own);
    explained += own;
    rig_close(&rig);
  }
  CHECK(explained > 50 && explained < 450);
}

/* A sensor cannot see what it sits on, and nothing seen is nothing explained. */
static void the_own_link_explains_nothing(void) {
  rig_t rig;
  rig_open(&rig);
  rig.ranges[0] = 0.02; /* 0.07 m from the upper arm's axis: within its thickness and the margin */
  CHECK_EQUAL(own_readings(&rig), 0);
  CHECK_NEAR(rig.cycle->distance[0], 0.07, 1e-12);
  rig.ranges[0] = pg_model_tof[0].range;
  set_margin(&rig, 10.0);
  CHECK_EQUAL(own_readings(&rig), 0);
  rig.ranges[0] = 0.5; /* with such a margin, the forearm explains everything */
  CHECK_EQUAL(own_readings(&rig), 1);
  rig_close(&rig);
}

/* Both switches of the forearm at (0.4, +-0.05), closed, against the upper arm and the ball at its end. */
static void switches_that_the_other_link_may_close(void) {
  random_t random = {5};
  int explained = 0;
  for (int i = 0; i < 1000; i++) {
    rig_t rig;
    const double fold = between(&random, 0.0, 1.0), margin = between(&random, 0.0, 0.1);
    open_folded(&rig, fold);
    set_margin(&rig, margin);
    int expected = 0;
    for (int side = 0; side < 2; side++) {
      const double up = side ? 1.0 : -1.0; /* of the normal: the first one looks down */
      const double normal[2] = {up * sin(fold), up * cos(fold)};
      const double origin[2] = {PLANAR_LENGTH - 0.4 * cos(fold) + 0.05 * normal[0],
                                0.4 * sin(fold) + 0.05 * normal[1]};
      int own = 0;
      for (int l = 0; l < 3; l += 2) { /* the upper arm and the ball, both on the first body */
        const double x = l ? PLANAR_LENGTH : fmin(fmax(origin[0], 0.0), PLANAR_LENGTH);
        const double v[2] = {x - origin[0], -origin[1]}, length = hypot(v[0], v[1]);
        const double s = length - (l ? 0.07 : 0.05) - margin;
        own |= s <= 1e-9 || (s <= 0.12 + 1e-9 && v[0] * normal[0] + v[1] * normal[1] >= 0.5 * length - 1e-9);
      }
      rig.switches[side] = 1;
      expected += own;
    }
    CHECK_EQUAL(own_readings(&rig), expected);
    explained += expected;
    rig_close(&rig);
  }
  CHECK(explained > 200 && explained < 1800);
}

/* Both at once are counted, and a fault counts nothing. */
static void the_count(void) {
  rig_t rig;
  open_folded(&rig, 0.5);
  rig.ranges[0] = 0.1;
  rig.switches[0] = 1;
  CHECK_EQUAL(own_readings(&rig), 2);
  rig.ranges[1] = 0.1; /* looks down: an obstacle */
  CHECK_EQUAL(own_readings(&rig), 2);
  CHECK_NEAR(rig.cycle->distance[0], 0.15, 1e-12);
  rig.xdot[0] = NAN;
  CHECK_EQUAL(rig_step(&rig), PG_FAULT_NOT_FINITE);
  CHECK_EQUAL(rig.cycle->self_readings, 0);
  rig_close(&rig);
}

int main(void) {
  readings_that_the_other_link_explains();
  the_own_link_explains_nothing();
  switches_that_the_other_link_may_close();
  the_count();
  return checks_failed > 0;
}
