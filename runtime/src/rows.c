/* Step 4: one row per capsule (5), and the active row (7).
 *
 * Every row has its slot for good. A row that is off keeps its last direction and gets ubA = PG_OFF: a row
 * set to zero, or rows packed anew in each cycle, let a hot start report success for a wrong solution. */
#include "state.h"

#include <math.h>
#include <string.h>

/* A shorter row moves nothing that joints could move. */
#define LEAST_ROW 1e-6

/* Where distances weigh like 1/d, none counts as nearer than this. */
#define LEAST_WEIGHT_DISTANCE 1e-3 /* [m] */

static double norm(const double row[PG_N]) {
  double sum = 0.0;
  for (int j = 0; j < PG_N; j++)
    sum += row[j] * row[j];
  return sqrt(sum);
}

static void switch_on(pg_diagnostics_t *cycle, int slot, const double row[PG_N], double ubA) {
  memcpy(&cycle->A[slot * PG_N], row, PG_N * sizeof(double));
  cycle->ubA[slot] = ubA;
  cycle->row_on[slot] = 1;
}

static void switch_off(pg_diagnostics_t *cycle, int slot) {
  cycle->ubA[slot] = PG_OFF;
  cycle->row_on[slot] = 0;
}

/* A_l = d'J_p and b_l = max(speed(d), -row_speed ||A_l||) of one capsule. */
static void write_capsule_row(pg_controller_t *controller, int l, double row[PG_N]) {
  const pg_parameters_t *p = &controller->parameters;
  const pg_nearest_t *nearest = &controller->nearest[l];
  pg_diagnostics_t *cycle = &controller->cycle;
  double speed;
  pg_model_row(pg_model_capsules[l].body, &controller->kinematics, nearest->closest, nearest->direction, row);
  pg_model_approach_speed(p, nearest->distance, &speed);
  cycle->approach_speed[l] = speed;

  const double length = norm(row), slowest = -p->row_speed * length;
  if (nearest->distance <= PG_D_ON(p) && length >= LEAST_ROW)
    switch_on(cycle, l, row, speed > slowest ? speed : slowest);
}

#if PG_ACTIVE_ROW
/* J_c = sum of w_k A_k, w_k = (1/d_k) / sum(1/d): the weighted sum of distances must not fall (6)(7). */
static void write_active_row(pg_diagnostics_t *cycle, double weighted[PG_N], double total) {
  if (total <= 0.0) return;
  for (int j = 0; j < PG_N; j++)
    weighted[j] /= total;
  if (norm(weighted) >= LEAST_ROW) switch_on(cycle, PG_CAPSULES, weighted, 0.0);
}
#endif

void pg_write_rows(pg_controller_t *controller) {
  pg_diagnostics_t *cycle = &controller->cycle;
  double weighted[PG_N] = {0.0}, total = 0.0;
  for (int slot = 0; slot < PG_ROWS; slot++)
    switch_off(cycle, slot);
  for (int l = 0; l < PG_CAPSULES; l++) {
    const pg_nearest_t *nearest = &controller->nearest[l];
    cycle->approach_speed[l] = INFINITY;
    if (!nearest->found) continue;
    double row[PG_N];
    write_capsule_row(controller, l, row);
    if (nearest->distance <= PG_D_ACTIVE(&controller->parameters)) {
      const double weight =
          1.0 / (nearest->distance > LEAST_WEIGHT_DISTANCE ? nearest->distance : LEAST_WEIGHT_DISTANCE);
      for (int j = 0; j < PG_N; j++)
        weighted[j] += weight * row[j];
      total += weight;
    }
  }
#if PG_ACTIVE_ROW
  write_active_row(cycle, weighted, total);
#else
  (void)weighted, (void)total;
#endif
}
