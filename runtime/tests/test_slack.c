/* Soft rows: always a solution, a price for what is exceeded, and the same numbers as the QP written out. */
#include "rig.h"

/* One joint, one row a qdot <= b with weight rho: H qdot + g + rho a (a qdot - b) = 0 where it is
 * exceeded. */
static void one_row_by_hand(void) {
  rig_t rig;
  rig_open(&rig);
  pg_parameters_t p = rig_parameters(&rig);
  p.slack_active_weight = 1e-3;
  p.qddot_limit[0] = p.qddot_limit[1] = 1e3;
  CHECK(pg_set_parameters(rig.controller, &p) == PG_SOLVED);
  rig_see(&rig, 0.25, 0.18); /* b = -0.2 * 0.04 / 0.05 = -0.16 */
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  const pg_diagnostics_t *cycle = rig.cycle;
  const double ramp = (0.30 - 0.18) / (0.30 - 0.17), rho = 100.0 * ramp * ramp;
  CHECK_NEAR(cycle->ubA[0], -0.16, 1e-12);
  CHECK_NEAR(cycle->slack[0], 0.25 * rig.qdot[0] + 0.16, 1e-12);
  CHECK(cycle->slack[0] > 0.0 && rig.qdot[0] < 0.0);
  double gradient[PG_N];
  for (int j = 0; j < PG_N; j++) {
    gradient[j] = cycle->g[j];
    for (int k = 0; k < PG_N; k++)
      gradient[j] += cycle->H[j * PG_N + k] * rig.qdot[k];
  }
  gradient[0] += rho * 0.25 * cycle->slack[0];
  for (int i = PG_CAPSULES; i < PG_ROWS; i++)
    gradient[0] += p.slack_active_weight * cycle->A[i * PG_N] * cycle->slack[i];
  CHECK_NEAR(gradient[0], 0.0, 1e-9);
  CHECK_NEAR(gradient[1], 0.0, 1e-9);
  rig_close(&rig);
}

static void contradictions_are_shared_out(void) {
  rig_t rig;
  rig_open(&rig);
  rig_see(&rig, 0.25, 0.1);
  rig_see(&rig, 0.75, -0.1);
  rig.xdot[0] = 0.2;
  for (int i = 0; i < 20; i++)
    CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK(rig.cycle->slack[0] > 0.0 || rig.cycle->slack[1] > 0.0);
  rig_close(&rig);
}

static void what_is_not_exceeded_has_no_slack(void) {
  rig_t rig;
  rig_open(&rig);
  rig_see(&rig, 0.25, 0.29);
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  for (int i = 0; i < PG_ROWS; i++)
    CHECK_EQUAL(rig.cycle->slack[i], 0.0);
  rig_close(&rig);
}

/* Weights from feather to rock. */
static void extreme_weights(void) {
  rig_t rig;
  rig_open(&rig);
  pg_parameters_t p = rig_parameters(&rig);
  rig_see(&rig, 0.25, 0.1);
  rig_see(&rig, 0.6, 0.2);
  rig_see(&rig, 0.75, -0.15);
  rig.xdot[1] = 0.25;
  for (double weight = 1e-6; weight < 1e7; weight *= 10.0) {
    p.slack_weight = weight;
    p.slack_active_weight = 1e1 / weight;
    CHECK(pg_set_parameters(rig.controller, &p) == PG_SOLVED);
    CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  }
  rig_close(&rig);
}

int main(void) {
  one_row_by_hand();
  contradictions_are_shared_out();
  what_is_not_exceeded_has_no_slack();
  extreme_weights();
  return checks_failed > 0;
}
