/* Points that the arm carries, worked out by hand for the planar arm: the tool, a ball of 20 mm, against the
 * upper arm, whose radius is 50 mm; a ball of 30 mm beside the upper arm at (0.1, -0.1) against the forearm.
 *
 * With the elbow bent by q_1, the tool is 0.5 sin q_1 beside the upper arm's axis, and moves away from it at
 * 0.5 cos q_1 qdot_1, whatever the first joint does. */
#include "rig.h"

enum { UPPER_ARM = PG_FIRST_SELF_ROW, FOREARM, ELBOW };

static const double radii = 0.05 + 0.02;

/* Lets the elbow bend as far as it likes. */
static void open_folded(rig_t *rig, double distance, double turned) {
  rig_open(rig);
  pg_parameters_t p = rig_parameters(rig);
  p.q_upper[1] = 4.0;
  CHECK(pg_set_parameters(rig->controller, &p) == PG_SOLVED);
  rig->q[0] = turned;
  rig->q[1] = acos(-1.0) - asin((distance + radii) / 0.5);
}

static void the_row_of_a_folded_arm(void) {
  rig_t rig;
  open_folded(&rig, 0.04, 0.3);
  CHECK(rig_step(&rig) >= PG_SOLVED);
  const pg_diagnostics_t *cycle = rig.cycle;
  CHECK_NEAR(cycle->self_distance[0], 0.04, 1e-12);
  CHECK(isinf(cycle->self_distance[2])); /* half a metre away */
  CHECK_EQUAL(cycle->row_on[UPPER_ARM], 1);
  CHECK_EQUAL(cycle->row_on[ELBOW], 0);
  CHECK_EQUAL(cycle->A[UPPER_ARM * PG_N], 0.0); /* the first joint moves both */
  CHECK_NEAR(cycle->A[UPPER_ARM * PG_N + 1], -0.5 * cos(rig.q[1]), 1e-12);
  CHECK_NEAR(cycle->ubA[UPPER_ARM], -0.2 * 0.01 / 0.02, 1e-12);
  CHECK(isinf(cycle->distance[0]) && !cycle->row_on[0]); /* nothing is near but the arm itself */
  rig_close(&rig);
}

/* A = -d(distance)/dq, for both points and wherever they are. */
static void rows_are_rates_of_distances(void) {
  random_t random = {12345};
  int checked = 0;
  for (int i = 0; i < 200; i++) {
    rig_t rig;
    open_folded(&rig, 0.0, between(&random, -1.0, 1.0));
    rig.q[1] = between(&random, -2.4, 4.0);
    const double middle = rig.q[1], step = 1e-6;
    if (rig_step(&rig) == PG_FAULT_OBSTACLE_INSIDE) continue;
    double rows[PG_CAPSULES], ahead[PG_CAPSULES];
    int on[PG_CAPSULES];
    for (int l = 0; l < PG_CAPSULES; l++) {
      on[l] = rig.cycle->row_on[UPPER_ARM + l];
      rows[l] = rig.cycle->A[(UPPER_ARM + l) * PG_N + 1];
    }
    rig.q[1] = middle + step;
    rig_step(&rig);
    memcpy(ahead, rig.cycle->self_distance, sizeof ahead);
    rig.q[1] = middle - step;
    rig_step(&rig);
    for (int l = 0; l < PG_CAPSULES; l++) {
      if (!on[l] || isinf(ahead[l]) || isinf(rig.cycle->self_distance[l])) continue;
      CHECK_NEAR(rows[l], (rig.cycle->self_distance[l] - ahead[l]) / (2.0 * step), 1e-5);
      checked++;
    }
    rig_close(&rig);
  }
  CHECK(checked > 30);
}

/* Once the arm has unfolded, the row is off, and keeps its direction. */
static void a_row_that_is_off(void) {
  rig_t rig;
  open_folded(&rig, 0.06, 0.0);
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK_EQUAL(rig.cycle->ubA[UPPER_ARM], 0.0);
  const double kept = rig.cycle->A[UPPER_ARM * PG_N + 1];
  rig.q[1] = 0.5;
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK_EQUAL(rig.cycle->row_on[UPPER_ARM], 0);
  CHECK_EQUAL(rig.cycle->ubA[UPPER_ARM], PG_OFF);
  CHECK_EQUAL(rig.cycle->A[UPPER_ARM * PG_N + 1], kept);
  CHECK(isinf(rig.cycle->self_distance[0]));
  rig_close(&rig);
}

/* Equal to a threshold, to 1e-9 m, is within it. */
static void at_a_threshold(void) {
  for (int sign = -1; sign <= 1; sign += 2) {
    rig_t rig;
    open_folded(&rig, 0.10 + sign * 1e-8, 0.0);
    rig_step(&rig);
    CHECK_EQUAL(rig.cycle->row_on[UPPER_ARM], sign < 0);
    rig.q[1] = acos(-1.0) - asin((0.10 + sign * 0.5e-9 + radii) / 0.5);
    rig_step(&rig);
    CHECK_EQUAL(rig.cycle->row_on[UPPER_ARM], 1);
    rig_close(&rig);
  }
}

static void a_point_on_an_axis(void) {
  rig_t rig;
  open_folded(&rig, -radii, 0.2);
  CHECK_EQUAL(rig_step(&rig), PG_FAULT_OBSTACLE_INSIDE);
  CHECK_EQUAL(rig.cycle->row_on[UPPER_ARM], 0);
  CHECK(isinf(rig.cycle->self_distance[0]));
  rig_close(&rig);
}

#if !PG_RELAXATION_SLACK
/* The elbow bends at 1 rad/s and can brake by 0.4 per cycle; the tool comes nearer at 0.6 * 0.5 cos q_1 =
 * 0.29 m/s at least. */
static void stages(void) {
  static const struct {
    double distance;
    pg_status_t status;
  } cases[] = {{0.099, PG_REDUCED_DISTANT}, {0.06, PG_REDUCED_CRITICAL}, {0.02, PG_STOPPED_INFEASIBLE}};
  for (int i = 0; i < 3; i++) {
    rig_t rig;
    const double bending[PG_N] = {0.0, 1.0};
    open_folded(&rig, cases[i].distance, 0.0);
    const double folded = rig.q[1];
    rig.q[1] = 0.0;
    rig_speed_up(&rig, bending);
    rig.q[1] = folded;
    CHECK_EQUAL(rig_step(&rig), cases[i].status);
    rig_close(&rig);
  }
}

/* Repulsion that is out of reach is given up, standing still is not. */
static void without_repulsion(void) {
  rig_t rig;
  open_folded(&rig, 0.01, 0.0);
  pg_parameters_t p = rig_parameters(&rig);
  p.qddot_limit[1] = 1.0;
  CHECK(pg_set_parameters(rig.controller, &p) == PG_SOLVED);
  CHECK_EQUAL(rig_step(&rig), PG_REDUCED_REPULSION);
  CHECK_NEAR(rig.cycle->ubA[UPPER_ARM], -0.2, 1e-12);
  CHECK(rig.qdot[1] <= 1e-9);
  rig_close(&rig);
}
#else
/* H qdot + g + rho a (a qdot - b) = 0, rho by the distance. */
static void weights(void) {
  rig_t rig;
  open_folded(&rig, 0.04, 0.0);
  pg_parameters_t p = rig_parameters(&rig);
  p.qddot_limit[0] = p.qddot_limit[1] = 1e3;
  CHECK(pg_set_parameters(rig.controller, &p) == PG_SOLVED);
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  const double rho = 100.0 * pow((0.10 - 0.04) / (0.10 - 0.03), 2.0);
  const double a = rig.cycle->A[UPPER_ARM * PG_N + 1];
  CHECK_NEAR(rig.cycle->slack[UPPER_ARM], a * rig.qdot[1] + 0.1, 1e-12);
  CHECK(rig.cycle->slack[UPPER_ARM] > 0.0);
  double gradient = rig.cycle->g[1] + rho * a * rig.cycle->slack[UPPER_ARM];
  for (int j = 0; j < PG_N; j++)
    gradient += rig.cycle->H[PG_N + j] * rig.qdot[j];
  CHECK_NEAR(gradient, 0.0, 1e-9);
  rig_close(&rig);
}
#endif

/* Pulled towards the shoulder for two seconds, the tool stops where the law lets it; and it can leave. */
static void folding_in_a_closed_loop(void) {
  rig_t rig;
  open_folded(&rig, 0.3, 0.0);
  double least = 1.0;
  for (int i = 0; i < 200; i++) {
    const int inwards = i < 120;
    const double tool[2] = {0.5 * cos(rig.q[0]) + 0.5 * cos(rig.q[0] + rig.q[1]),
                            0.5 * sin(rig.q[0]) + 0.5 * sin(rig.q[0] + rig.q[1])};
    for (int k = 0; k < 2; k++)
      rig.xdot[k] = (inwards ? -1.0 : 1.0) * tool[k] / hypot(tool[0], tool[1]) * 0.3;
    CHECK(rig_step(&rig) < PG_STOPPED_INFEASIBLE);
    for (int j = 0; j < PG_N; j++)
      rig.q[j] += 0.02 * rig.qdot[j];
    if (rig.cycle->self_distance[0] < least) least = rig.cycle->self_distance[0];
  }
  CHECK(least > 0.03 && least < 0.10);
  CHECK(isinf(rig.cycle->self_distance[0]));
  rig_close(&rig);
}

static void thresholds_out_of_order(void) {
  rig_t rig;
  rig_open(&rig);
  const pg_parameters_t good = rig_parameters(&rig);
  for (int i = 0; i < 3; i++) {
    pg_parameters_t p = good;
    if (i == 0) p.self_d_0u = p.self_d_a;
    if (i == 1) p.self_d_0l = 0.08;
    if (i == 2) p.self_d_r = p.self_d_0l;
    CHECK_EQUAL(pg_set_parameters(rig.controller, &p), PG_ERROR_PARAMETER);
  }
  pg_parameters_t equal = good;
  equal.self_d_0l = equal.self_d_0u; /* no dead zone */
  CHECK_EQUAL(pg_set_parameters(rig.controller, &equal), PG_SOLVED);
  rig_close(&rig);
}

int main(void) {
  the_row_of_a_folded_arm();
  rows_are_rates_of_distances();
  a_row_that_is_off();
  at_a_threshold();
  a_point_on_an_axis();
#if PG_RELAXATION_SLACK
  weights();
#else
  stages();
  without_repulsion();
#endif
  folding_in_a_closed_loop();
  thresholds_out_of_order();
  return checks_failed > 0;
}
