/* Step 6, relaxation `slack`: one QP, whose rows may be exceeded at a price. It is always feasible. */
#include "state.h"

#if PG_RELAXATION_SLACK

#include <string.h>

/* Rho of one row: by distance for a capsule's row that is on. */
static double weight_of(const pg_controller_t *controller, int slot) {
  const pg_parameters_t *p = &controller->parameters;
  double weight = p->slack_weight;
  if (slot == PG_CAPSULES && PG_ACTIVE_ROW) return p->slack_active_weight;
  if (!controller->cycle.row_on[slot]) return weight;
#if PG_SELF_POINTS
  if (slot >= PG_FIRST_SELF_ROW) {
    pg_model_self_slack_weight(p, controller->nearest_self[slot - PG_FIRST_SELF_ROW].distance, &weight);
    return weight;
  }
#endif
  pg_model_slack_weight(p, controller->nearest[slot].distance, &weight);
  return weight;
}

static void soften(pg_controller_t *controller) {
  for (int slot = 0; slot < PG_ROWS; slot++)
    controller->softness[slot] = 1.0 / weight_of(controller, slot);
}

/* How far the solution exceeds each row: s = y / rho. */
static void note_slack(pg_controller_t *controller) {
  for (int slot = 0; slot < PG_ROWS; slot++)
    controller->cycle.slack[slot] = controller->softness[slot] * controller->solution.y[slot];
}

pg_status_t pg_find_velocity(pg_controller_t *controller) {
  const pg_qp_t qp = pg_stage_of(controller);
  memcpy(controller->ubA, controller->cycle.ubA, sizeof controller->ubA);
  soften(controller);
  pg_solver_load(controller->solver, &qp);
  if (pg_solve(controller, &qp) != PG_OPTIMAL) return PG_STOPPED_SOLVER;
  note_slack(controller);
  return PG_SOLVED;
}

#endif
