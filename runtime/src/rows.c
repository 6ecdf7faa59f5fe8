/* Step 4: one row per capsule (5), and the active row (7); those of self-collision, if there are any, are in
 * self_collision.c, and those of the methods that the paper compares with in baselines.c. */
#include "row.h"

#if !PG_BASELINE

/* Where distances weigh like 1/d, none counts as nearer than this. */
#define LEAST_WEIGHT_DISTANCE 1e-3 /* [m] */

/* A_l = d'J_p and b_l = max(speed(d), -row_speed ||A_l||) of one capsule. */
static void write_capsule_row(pg_controller_t *controller, int l, double row[PG_N]) {
  const pg_parameters_t *p = &controller->parameters;
  const pg_nearest_t *nearest = &controller->nearest[l];
  pg_diagnostics_t *cycle = &controller->cycle;
  double speed;
  pg_model_row(pg_model_capsules[l].body, &controller->kinematics, nearest->closest, nearest->direction, row);
  pg_model_approach_speed(p, nearest->distance, &speed);
  cycle->approach_speed[l] = speed;

  const double norm = pg_row_norm(row);
  if (nearest->distance <= PG_D_ON(p) && norm >= PG_LEAST_ROW)
    pg_switch_on(cycle, l, row, pg_row_bound(p, speed, norm));
}

#if PG_ACTIVE_ROW
/* J_c = sum of w_k A_k, w_k = (1/d_k) / sum(1/d): the weighted sum of distances must not fall (6)(7). */
static void write_active_row(pg_diagnostics_t *cycle, double weighted[PG_N], double total) {
  if (total <= 0.0) return;
  for (int j = 0; j < PG_N; j++)
    weighted[j] /= total;
  if (pg_row_norm(weighted) >= PG_LEAST_ROW) pg_switch_on(cycle, PG_CAPSULES, weighted, 0.0);
}
#endif

void pg_write_rows(pg_controller_t *controller, const double xdot[PG_M]) {
  pg_diagnostics_t *cycle = &controller->cycle;
  double weighted[PG_N] = {0.0}, total = 0.0;
  (void)xdot; /* the task decides within the rows, not about them */
  pg_switch_all_off(cycle);
  for (int l = 0; l < PG_CAPSULES; l++) {
    const pg_nearest_t *nearest = &controller->nearest[l];
    cycle->approach_speed[l] = PG_INFINITY;
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
#if PG_SELF_POINTS
  pg_write_self_rows(controller);
#endif
}

/* When rows at a distance are dropped. */
static pg_status_t dropped_by_distance(double distance, double distant, double critical) {
  return distance > distant ? PG_REDUCED_DISTANT : distance > critical ? PG_REDUCED_CRITICAL : PG_KEPT;
}

pg_status_t pg_dropped_at(const pg_controller_t *controller, int slot) {
  const pg_parameters_t *p = &controller->parameters;
  if (slot < PG_CAPSULES)
    return dropped_by_distance(controller->nearest[slot].distance, PG_D_DISTANT(p), PG_D_CRITICAL(p));
#if PG_SELF_POINTS
  if (slot >= PG_FIRST_SELF_ROW)
    return dropped_by_distance(controller->nearest_self[slot - PG_FIRST_SELF_ROW].distance,
                               p->self_d_0u + PG_SAME_DISTANCE, p->self_d_r + PG_SAME_DISTANCE);
#endif
  return PG_REDUCED_ACTIVE;
}

#endif
