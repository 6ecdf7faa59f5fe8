/* Step 6: the reduction ladder (IV.C). The first stage that is feasible decides; with soft rows there is only
 * one.
 *
 * The feasible sets grow from stage to stage. A stage counts as infeasible only with a proof, or if two
 * solves, the second from nothing, agree on it; as solved only with a certificate. */
#include "state.h"

#include <math.h>
#include <string.h>

/* Rounds of the search for a contradiction: before a solve, where nine in ten are found and feasible cycles
 * hardly notice, and after a solver has claimed one. */
#define SHORT_SEARCH 2
#define LONG_SEARCH  64

/* A residual r leaves an error of up to r/lambda in q_dot, so certified is not yet exact to 1e-8. */
#define EXACT (1e-4 * PG_TOLERANCE)

/* Makes stage `stage` out of the one before it; returns 0 if the QP stays as it was. */
static int relax(const pg_controller_t *controller, pg_status_t stage, double ubA[PG_ROWS]) {
  const pg_parameters_t *p = &controller->parameters;
  int changed = 0;
  for (int slot = 0; slot < PG_ROWS; slot++) {
    if (ubA[slot] >= PG_OFF) continue;
    const int is_capsule = slot < PG_CAPSULES;
    const double distance = is_capsule ? controller->nearest[slot].distance : INFINITY;
    const int drop = (stage == PG_REDUCED_ACTIVE && !is_capsule) ||
                     (stage == PG_REDUCED_DISTANT && distance > PG_D_DISTANT(p)) ||
                     (stage == PG_REDUCED_CRITICAL && distance > PG_D_CRITICAL(p));
    const int raise = stage == PG_REDUCED_REPULSION && ubA[slot] < 0.0;
    if (drop || raise) {
      ubA[slot] = drop ? PG_OFF : 0.0;
      changed = 1;
    }
  }
  return changed;
}

/* A certified solution may be outside its bounds by the tolerance; a command may not. */
static void keep_within_bounds(const pg_qp_t *qp, double x[PG_N]) {
  for (int j = 0; j < PG_N; j++)
    x[j] = x[j] < qp->lb[j] ? qp->lb[j] : x[j] > qp->ub[j] ? qp->ub[j] : x[j];
}

/* One solve; says PG_OPTIMAL only with a certificate, and leaves the residual. */
static pg_outcome_t attempt(pg_controller_t *controller, const pg_qp_t *qp, pg_start_t start,
                            double *residual) {
  pg_solution_t *solution = &controller->solution;
  pg_outcome_t outcome = pg_solver_solve(controller->solver, qp, start, solution);
#ifdef PG_FAULT_INJECTION
  pg_test_hook(start, &outcome, solution);
#endif
  controller->cycle.solves++;
  controller->cycle.iterations += solution->iterations;
  if (outcome != PG_OPTIMAL) return outcome;
  keep_within_bounds(qp, solution->x);
  *residual = pg_kkt_residual(qp, solution);
  if (*residual <= PG_TOLERANCE) return PG_OPTIMAL;
  controller->counters.certificate_failures++;
  return PG_UNSOLVED;
}

/* The second chance: a solve from nothing, against what the first one left. */
static pg_outcome_t attempt_again(pg_controller_t *controller, const pg_qp_t *qp, pg_outcome_t first,
                                  double *residual) {
  const pg_solution_t kept = controller->solution;
  double residual_again;
  controller->cycle.second_chances++;
  const pg_outcome_t outcome = attempt(controller, qp, PG_AGAIN, &residual_again);
  if (first == PG_OPTIMAL && (outcome != PG_OPTIMAL || residual_again > *residual)) {
    controller->solution = kept;
    return PG_OPTIMAL;
  }
  *residual = residual_again;
  return outcome;
}

/* Solves one stage. A first answer that is neither exact nor a proof gets a second chance. */
static pg_outcome_t solve(pg_controller_t *controller, const pg_qp_t *qp) {
  if (!PG_RELAXATION_SLACK && pg_find_contradiction(qp, SHORT_SEARCH)) return PG_INFEASIBLE;
  double residual = INFINITY;
  pg_outcome_t outcome = attempt(controller, qp, PG_FIRST, &residual);
  const int exact = outcome == PG_OPTIMAL && residual <= EXACT;
  const int proven = outcome == PG_INFEASIBLE && (pg_proves_infeasible(qp, controller->solution.y) ||
                                                  pg_find_contradiction(qp, LONG_SEARCH));
  if (!exact && !proven) outcome = attempt_again(controller, qp, outcome, &residual);
  if (outcome == PG_OPTIMAL) controller->cycle.kkt_residual = residual;
  return outcome;
}

#if PG_RELAXATION_SLACK
/* 1/rho of all rows: by distance for a capsule's row that is on. */
static void soften(pg_controller_t *controller) {
  const pg_parameters_t *p = &controller->parameters;
  for (int slot = 0; slot < PG_ROWS; slot++) {
    double weight = slot < PG_CAPSULES ? p->slack_weight : p->slack_active_weight;
    if (slot < PG_CAPSULES && controller->cycle.row_on[slot])
      pg_model_slack_weight(p, controller->nearest[slot].distance, &weight);
    controller->softness[slot] = 1.0 / weight;
  }
}

/* How far the solution exceeds each row: s = y / rho. */
static void note_slack(pg_controller_t *controller) {
  for (int slot = 0; slot < PG_ROWS; slot++)
    controller->cycle.slack[slot] = controller->softness[slot] * controller->solution.y[slot];
}
#endif

pg_status_t pg_solve_by_stages(pg_controller_t *controller) {
  const pg_diagnostics_t *cycle = &controller->cycle;
  const pg_qp_t qp = {.H = cycle->H,
                      .g = cycle->g,
                      .A = cycle->A,
                      .lb = cycle->lb,
                      .ub = cycle->ub,
                      .ubA = controller->ubA,
                      .softness = controller->softness};
  memcpy(controller->ubA, cycle->ubA, sizeof controller->ubA);
#if PG_RELAXATION_SLACK
  soften(controller);
  pg_solver_load(controller->solver, &qp);
  if (solve(controller, &qp) != PG_OPTIMAL) return PG_STOPPED_SOLVER;
  note_slack(controller);
  return PG_SOLVED;
#else
  pg_solver_load(controller->solver, &qp);
  pg_outcome_t outcome = PG_UNSOLVED;
  for (int stage = PG_SOLVED; stage <= PG_REDUCED_CRITICAL; stage++) {
    if (stage != PG_SOLVED && !relax(controller, (pg_status_t)stage, controller->ubA)) continue;
    outcome = solve(controller, &qp);
    if (outcome == PG_OPTIMAL) return (pg_status_t)stage;
  }
  /* The last stage asks least: if it is infeasible, all are. */
  return outcome == PG_INFEASIBLE ? PG_STOPPED_INFEASIBLE : PG_STOPPED_SOLVER;
#endif
}
