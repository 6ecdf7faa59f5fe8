/* One QP, solved beyond doubt: as solved counts only what has a certificate, as infeasible only what has a
 * proof, or what two attempts of the solver, on different ways, agree on. */
#include "state.h"

/* Rounds of the search for a contradiction: before a solve, where nine in ten are found and feasible cycles
 * hardly notice, and after a solver has claimed one. */
#define SHORT_SEARCH 2
#define LONG_SEARCH  256

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
pg_outcome_t pg_solve(pg_controller_t *controller, const pg_qp_t *qp) {
  if (!PG_RELAXATION_SLACK && pg_search(qp, SHORT_SEARCH) == PG_CONTRADICTORY) return PG_INFEASIBLE;
  const pg_outcome_t outcome = attempt(controller, qp, PG_FIRST);
  if (outcome != PG_UNSOLVED) return outcome;
  controller->cycle.second_chances++;
  return attempt(controller, qp, PG_AGAIN);
}
