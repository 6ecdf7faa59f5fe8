/* One QP, solved beyond doubt: as solved counts only what has a certificate, as infeasible only what has a
 * proof, or what the solver still claims with rows apart. */
#include "state.h"

#include <math.h>

/* Rounds of the search for a contradiction: before a solve, where nine in ten are found and feasible cycles
 * hardly notice, and after a solver has claimed one. */
#define SHORT_SEARCH 2
#define LONG_SEARCH  256

/* The attempts after a first one: another way, then with tolerances near rounding. Within a solver's usual
 * ones, a narrow cone or box has more than one working set; with the wrong one polishing comes to nothing.
 *
 * Then rows are moved apart by one to two times `apart` [m/s]. Where they leave a single point, rounding
 * errors make a solver see a contradiction; so they do not meet in one point any more. Polishing then puts
 * the solution on the rows as they are: from near by, where levers are short and 1e-9 m/s is far. */
static const struct {
  pg_start_t start;
  double apart;
} further_attempts[] = {{PG_AGAIN, 0.0}, {PG_SHARP, 0.0}, {PG_AGAIN, 1e-9}, {PG_AGAIN, 1e-13}};
enum { FURTHER_ATTEMPTS = sizeof further_attempts / sizeof further_attempts[0] };

#define GOLDEN_SECTION 0.6180339887498949

/* An answer with a greater residual is asked for again, even if it could be certified: a residual r of a row
 * with a large multiplier leaves an error of up to sqrt(2 r/lambda) in q_dot. Soft rows leave no narrow cone,
 * but great multipliers, and with them more rounding. */
#define GOOD ((PG_RELAXATION_SLACK ? 1e-3 : 1e-5) * PG_TOLERANCE)

/* What it means that a solver found nothing. Infeasible is what a proof shows, the solver's or one that a
 * search finds; and what a solver claims even with rows apart, if no feasible x turns up. */
static pg_outcome_t judge(const pg_qp_t *qp, const pg_solution_t *solution, pg_outcome_t claim, int is_last) {
  if (PG_RELAXATION_SLACK) return PG_UNSOLVED; /* soft rows are always feasible */
  if (claim == PG_INFEASIBLE && pg_proves_infeasible(qp, solution->y)) return PG_INFEASIBLE;
  const pg_verdict_t verdict = pg_search(qp, LONG_SEARCH);
  const int is_believed = verdict == PG_UNDECIDED && claim == PG_INFEASIBLE && is_last;
  return verdict == PG_CONTRADICTORY || is_believed ? PG_INFEASIBLE : PG_UNSOLVED;
}

/* One solve of `posed`, of which `qp` is what is meant; says PG_OPTIMAL only with a certificate for that. */
static pg_outcome_t attempt(pg_controller_t *controller, const pg_qp_t *posed, const pg_qp_t *qp,
                            pg_start_t start, int is_last) {
  pg_diagnostics_t *cycle = &controller->cycle;
  pg_solution_t *solution = &controller->solution;
  pg_outcome_t outcome = pg_solver_solve(controller->solver, posed, start, solution);
#ifdef PG_FAULT_INJECTION
  pg_test_hook(start, &outcome, solution);
#endif
  cycle->solves++;
  cycle->iterations += solution->iterations;
  if (outcome != PG_OPTIMAL) return judge(qp, solution, outcome, is_last);
  const double residual = pg_polish(qp, solution);
  if (!(residual <= PG_TOLERANCE)) {
    controller->counters.certificate_failures++;
    return PG_UNSOLVED;
  }
  cycle->kkt_residual = residual;
  return PG_OPTIMAL;
}

/* Right-hand sides with rows apart: by unequal amounts, and not in arithmetic progression, as that could be a
 * dependence again. */
static void move_apart(const pg_qp_t *qp, double distance, double ubA[PG_ROWS]) {
  double part = 0.0;
  for (int i = 0; i < PG_ROWS; i++) {
    part += part < 1.0 - GOLDEN_SECTION ? GOLDEN_SECTION : GOLDEN_SECTION - 1.0;
    ubA[i] = qp->ubA[i] >= PG_OFF ? PG_OFF : qp->ubA[i] + distance * (1.0 + part);
  }
}

/* The attempts after a first one that left `outcome`; the best answer counts. */
static pg_outcome_t solve_again(pg_controller_t *controller, const pg_qp_t *qp, pg_outcome_t outcome) {
  double ubA[PG_ROWS], *residual = &controller->cycle.kkt_residual;
  pg_solution_t best = controller->solution;
  double least = outcome == PG_OPTIMAL ? *residual : PG_INFINITY;
  pg_qp_t apart = *qp;
  apart.ubA = ubA;
  controller->cycle.second_chances++;
  for (int k = 0; k < FURTHER_ATTEMPTS && least > GOOD; k++) {
    move_apart(qp, further_attempts[k].apart, ubA);
    const pg_outcome_t again =
        attempt(controller, &apart, qp, further_attempts[k].start, k == FURTHER_ATTEMPTS - 1);
    pg_solver_load(controller->solver, qp); /* as it was, for what follows */
    if (again == PG_INFEASIBLE && outcome != PG_OPTIMAL) return PG_INFEASIBLE;
    if (again != PG_OPTIMAL || !(*residual < least)) continue;
    outcome = PG_OPTIMAL;
    least = *residual;
    best = controller->solution;
  }
  controller->solution = best;
  *residual = outcome == PG_OPTIMAL ? least : PG_NAN;
  return outcome;
}

/* Solves one stage; a first answer that proves nothing, or not well enough, gets a second chance. */
pg_outcome_t pg_solve(pg_controller_t *controller, const pg_qp_t *qp) {
  if (!PG_RELAXATION_SLACK && !pg_solver_is_at_hand(controller->solver, qp) &&
      pg_search(qp, SHORT_SEARCH) == PG_CONTRADICTORY)
    return PG_INFEASIBLE;
  const pg_outcome_t outcome = attempt(controller, qp, qp, PG_FIRST, 0);
  const int is_final =
      outcome == PG_INFEASIBLE || (outcome == PG_OPTIMAL && controller->cycle.kkt_residual <= GOOD);
  return is_final ? outcome : solve_again(controller, qp, outcome);
}
