/* Step 6, relaxation `staged`: the reduction ladder (IV.C). The feasible sets grow from stage to stage, and
 * the first stage that is feasible decides. */
#include "state.h"

#if !PG_RELAXATION_SLACK

#include <string.h>

/* Makes stage `stage` out of the one before it; returns 0 if the QP stays as it was. */
static int relax(const pg_controller_t *controller, pg_status_t stage, double ubA[PG_ROWS]) {
  int changed = 0;
  for (int slot = 0; slot < PG_ROWS; slot++) {
    if (ubA[slot] >= PG_OFF) continue;
    const int drop = pg_dropped_at(controller, slot) == stage;
    const int raise = stage == PG_REDUCED_REPULSION && ubA[slot] < PG_RAISED;
    if (drop || raise) {
      ubA[slot] = drop ? PG_OFF : PG_RAISED;
      changed = 1;
    }
  }
  return changed;
}

pg_status_t pg_find_velocity(pg_controller_t *controller) {
  const pg_qp_t qp = pg_stage_of(controller);
  memcpy(controller->ubA, controller->cycle.ubA, sizeof controller->ubA);
  pg_solver_load(controller->solver, &qp);
  pg_outcome_t outcome = PG_UNSOLVED;
  for (int stage = PG_SOLVED; stage <= PG_REDUCED_CRITICAL; stage++) {
    if (stage != PG_SOLVED && !relax(controller, (pg_status_t)stage, controller->ubA)) continue;
    outcome = pg_solve(controller, &qp);
    if (outcome == PG_OPTIMAL) return (pg_status_t)stage;
  }
  /* The last stage asks least: if it is infeasible, all are. */
  return outcome == PG_INFEASIBLE ? PG_STOPPED_INFEASIBLE : PG_STOPPED_SOLVER;
}

#endif
