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
#define LONG_SEARCH  256

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

/* What it means that a solver found nothing. Infeasible is what a proof shows, the solver's or one that a
 * search finds; and what a solver claims for the second time, if no feasible x turns up. */
static pg_outcome_t judge(const pg_qp_t *qp, const pg_solution_t *solution, pg_outcome_t claim,
                          pg_start_t start) {
  if (PG_RELAXATION_SLACK) return PG_UNSOLVED; /* soft rows are always feasible */
  if (claim == PG_INFEASIBLE && pg_proves_infeasible(qp, solution->y)) return PG_INFEASIBLE;
  const pg_verdict_t verdict = pg_search(qp, LONG_SEARCH);
  const int claimed_again = claim == PG_INFEASIBLE && start == PG_AGAIN;
  return verdict == PG_CONTRADICTORY || (verdict == PG_UNDECIDED && claimed_again) ? PG_INFEASIBLE
                                                                                   : PG_UNSOLVED;
}

/* One solve; says PG_OPTIMAL only with a certificate. */
static pg_outcome_t attempt(pg_controller_t *controller, const pg_qp_t *qp, pg_start_t start) {
  pg_diagnostics_t *cycle = &controller->cycle;
  pg_solution_t *solution = &controller->solution;
  pg_outcome_t outcome = pg_solver_solve(controller->solver, qp, start, solution);
#ifdef PG_FAULT_INJECTION
  pg_test_hook(start, &outcome, solution);
#endif
  cycle->solves++;
  cycle->iterations += solution->iterations;
  if (outcome != PG_OPTIMAL) return judge(qp, solution, outcome, start);
  const double residual = pg_polish(qp, solution);
  if (!(residual <= PG_TOLERANCE)) {
    controller->counters.certificate_failures++;
    return PG_UNSOLVED;
  }
  cycle->kkt_residual = residual;
  return PG_OPTIMAL;
}

/* Solves one stage; a first answer that proves nothing gets a second chance. */
static pg_outcome_t solve(pg_controller_t *controller, const pg_qp_t *qp) {
  if (!PG_RELAXATION_SLACK && pg_search(qp, SHORT_SEARCH) == PG_CONTRADICTORY) return PG_INFEASIBLE;
  const pg_outcome_t outcome = attempt(controller, qp, PG_FIRST);
  if (outcome != PG_UNSOLVED) return outcome;
  controller->cycle.second_chances++;
  return attempt(controller, qp, PG_AGAIN);
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
