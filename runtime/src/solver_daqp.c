/* Back end DAQP (Arnstrom, Bemporad, Axehill 2022): a dual active-set method in plain C, no heap use.
 *
 * DAQP's core solves a least-distance problem; its own interface forms that problem afresh for every solve,
 * on the heap. Here it is formed only where minimum.h does not find the solution, once per cycle, with sizes
 * known to the compiler, and all stages of the ladder share it:
 *
 *     H = R'R,   u = Rx + v,   v = R^-T g,   R = D^1/2 U
 *     min ||u||^2   subject to   M u <= ubA + M v,   M = A R^-1
 *
 * Rows and bounds are scaled to unit length in u, which is what DAQP's tolerances are made for. */
#include "minimum.h"

#include "daqp.h"

#include <math.h>
#include <string.h>

enum {
  N = PG_N,
  ROWS = PG_ROWS,
  SIDES = N + ROWS,                       /* constraints: first the bounds, then the rows */
  ACTIVE = N + PG_RELAXATION_SLACK * ROWS /* greatest working set; a soft row adds a dimension of its own */
};

/* Bounds and rows may be exceeded by this much; q_dot is to be exact to 1e-8. */
#define PRIMAL_TOLERANCE 1e-9

/* Rounding errors of u, relative to v. Below them DAQP would add and remove the same constraints for ever. */
#define NOISE 1e-15

/* Rows are dependent if one is left with this part of its squared length; they are nearly so when obstacles
 * touch. */
#define SINGULAR 1e-14

/* mu of the second attempt, and its steps; what they leave of an error, polishing takes away. */
#define ROUNDING      1e-3
#define ROUNDED_STEPS 4

/* What the last of these steps has in a sharp attempt, in parts of the tolerance: a row that is exceeded by
 * no more than that is not in the working set, and polishing cannot add it where rows leave a narrow cone. */
#define SHARPER 1e-2

/* Bounds that are closer to each other are one value. */
#define EQUAL_BOUNDS 1e-11

struct pg_solver {
  DAQPWorkspace work;
  DAQPSettings settings;
  int usable;           /* H could be factorised */
  int is_at_hand;       /* `minimum` is the solution, and the problem below not formed */
  pg_minimum_t minimum; /* of what is loaded */
  double held_ubA;      /* of the row that is held there */
  double w[N];          /* U^-T g, where H = U'DU */

  double Rinv[N * (N + 1) / 2]; /* R^-1, packed by rows, each scaled to unit length */
  double v[N];
  double M[ROWS * N];
  double scaling[SIDES];
  double shift[ROWS]; /* scaled row times v: what u has more than Rx */
  double dupper[SIDES], dlower[SIDES];
  double softness[SIDES]; /* of the rows, if they are soft */
  int sense[SIDES];

  /* DAQP's own working space, one more than the greatest working set. */
  double u[N], xold[N];
  double products[ROWS];
  double lam[ACTIVE + 1], lam_star[ACTIVE + 1], D[ACTIVE + 1], xldl[ACTIVE + 1], zldl[ACTIVE + 1];
  double L[(ACTIVE + 1) * (ACTIVE + 2) / 2];
  int working_set[ACTIVE + 1];
};

const char pg_solver_name[] = "daqp";

/* First element of row i of the packed R^-1 would be at column 0; columns before i are not stored. */
static double *packed_row(double *packed, int i) {
  return packed + (2 * N - i - 1) * i / 2;
}

/* The greater one; fmax would be a call into the C library. */
static double greater(double a, double b) {
  return a > b ? a : b;
}

/* lb <= x <= ub in terms of u: row i of R^-1, scaled. Sets the tolerance to what can be told from noise. */
static void place_bounds(pg_solver_t *solver, const pg_qp_t *qp, double Rinv[N][N]) {
  double greatest = 0.0;
  for (int j = 0; j < N; j++)
    greatest = greater(greatest, fabs(solver->v[j]));
  solver->settings.primal_tol = PRIMAL_TOLERANCE;
  for (int i = 0; i < N; i++) {
    double *row = packed_row(solver->Rinv, i), shift = 0.0;
    memcpy(row + i, &Rinv[i][i], (size_t)(N - i) * sizeof(double));
    const double scaling = pg_normalise(row + i, N - i);
    for (int j = i; j < N; j++)
      shift += row[j] * solver->v[j];
    solver->scaling[i] = scaling;
    solver->settings.primal_tol = greater(solver->settings.primal_tol, NOISE * greatest / scaling);
    solver->dlower[i] = qp->lb[i] * scaling + shift;
    solver->dupper[i] = qp->ub[i] * scaling + shift;
  }
}

/* A row in terms of u: A R^-1, scaled. Its right-hand side follows with each solve. */
static void place_row(pg_solver_t *solver, const double *A, int i, double Rinv[N][N]) {
  double *row = &solver->M[i * N], shift = 0.0;
  for (int j = 0; j < N; j++) {
    double sum = 0.0;
    for (int k = 0; k <= j; k++)
      sum += A[i * N + k] * Rinv[k][j];
    row[j] = sum;
  }
  solver->scaling[N + i] = pg_normalise(row, N);
  for (int j = 0; j < N; j++)
    shift += row[j] * solver->v[j];
  solver->shift[i] = shift;
  solver->dlower[N + i] = -DAQP_INF;
}

/* Right-hand sides and flags for a solve: a constraint that is off is immutable and not active, so DAQP
 * ignores it. */
static void place_sides(pg_solver_t *solver, const pg_qp_t *qp) {
  for (int i = 0; i < N; i++)
    solver->sense[i] = qp->ub[i] - qp->lb[i] < EQUAL_BOUNDS ? DAQP_ACTIVE | DAQP_IMMUTABLE : 0;
  for (int i = 0; i < ROWS; i++) {
    const int side = N + i;
    solver->dupper[side] = qp->ubA[i] * solver->scaling[side] + solver->shift[i];
    solver->sense[side] = qp->ubA[i] >= PG_OFF ? DAQP_IMMUTABLE : PG_RELAXATION_SLACK ? DAQP_SOFT : 0;
  }
}

/* Takes the multipliers of the rows from DAQP's working set. */
static void read_multipliers(const pg_solver_t *solver, double y[ROWS]) {
  const DAQPWorkspace *work = &solver->work;
  memset(y, 0, ROWS * sizeof(double));
  for (int i = 0; i < work->n_active; i++)
    if (work->WS[i] >= N && work->lam_star[i] > 0.0) y[work->WS[i] - N] = work->lam_star[i];
}

/* Points DAQP's workspace at our memory. */
static void connect(pg_solver_t *solver) {
  solver->work = (DAQPWorkspace){.n = N,
                                 .m = SIDES,
                                 .ms = N,
                                 .M = solver->M,
                                 .dupper = solver->dupper,
                                 .dlower = solver->dlower,
                                 .Rinv = solver->Rinv,
                                 .v = solver->v,
                                 .sense = solver->sense,
                                 .scaling = solver->scaling,
                                 .x = solver->u,
                                 .xold = solver->xold,
                                 .lam = solver->lam,
                                 .lam_star = solver->lam_star,
                                 .u = solver->u,
                                 .L = solver->L,
                                 .D = solver->D,
                                 .xldl = solver->xldl,
                                 .zldl = solver->zldl,
                                 .WS = solver->working_set,
                                 .sing_ind = DAQP_EMPTY_IND,
                                 .settings = &solver->settings,
                                 .Mu = solver->products,
                                 .rho_ls = PG_RELAXATION_SLACK ? solver->softness : NULL,
                                 .rho_us = PG_RELAXATION_SLACK ? solver->softness : NULL,
                                 .state = DAQP_STATE_RINV_NORMALIZED};
}

pg_status_t pg_solver_create(void *memory, pg_solver_t **solver) {
  _Static_assert(sizeof(pg_solver_t) <= PG_SOLVER_MEMORY, "the size in controller.h is too small");
  pg_solver_t *made = memory;
  memset(made, 0, sizeof *made);
  made->settings = (DAQPSettings){.primal_tol = PRIMAL_TOLERANCE,
                                  .dual_tol = DAQP_DEFAULT_DUAL_TOL,
                                  .zero_tol = DAQP_DEFAULT_ZERO_TOL,
                                  .pivot_tol = DAQP_DEFAULT_PIVOT_TOL,
                                  .progress_tol = DAQP_DEFAULT_PROG_TOL,
                                  .cycle_tol = DAQP_DEFAULT_CYCLE_TOL,
                                  .iter_limit = PG_MAX_ITERATIONS,
                                  .fval_bound = DAQP_INF,
                                  .rho_soft = DAQP_DEFAULT_RHO_SOFT,
                                  .sing_tol = SINGULAR,
                                  .refactor_tol = DAQP_DEFAULT_REFACTOR_TOL};
  connect(made);
  *solver = made;
  return PG_SOLVED;
}

void pg_solver_destroy(pg_solver_t *solver) {
  (void)solver; /* nothing was taken */
}

void pg_solver_reset(pg_solver_t *solver) {
  (void)solver; /* nothing is carried from QP to QP */
}

/* Forms the least-distance problem; U becomes R^-1. */
static void form(pg_solver_t *solver, const pg_qp_t *qp, double U[N][N]) {
  solver->is_at_hand = 0;
  pg_invert(U);
  for (int j = 0; j < N; j++)
    solver->v[j] = solver->w[j] * U[j][j];
  place_bounds(solver, qp, U);
  for (int i = 0; i < ROWS; i++)
    if (qp->ubA[i] < PG_OFF) place_row(solver, qp->A, i, U);
#if PG_RELAXATION_SLACK
  memcpy(&solver->softness[N], qp->softness, ROWS * sizeof(double));
#endif
}

void pg_solver_load(pg_solver_t *solver, const pg_qp_t *qp) {
  double U[N][N];
  solver->usable = pg_factorise(qp->H, U);
  if (!solver->usable) return;
  pg_solve_transposed(U, qp->g, solver->w);
  solver->is_at_hand = pg_find_minimum(U, solver->w, qp, &solver->minimum);
  if (!solver->is_at_hand)
    form(solver, qp, U);
  else if (solver->minimum.held >= N)
    solver->held_ubA = qp->ubA[solver->minimum.held - N];
}

/* Rows that are switched off or raised leave a minimum where it is, unless they hold it. */
int pg_solver_is_at_hand(const pg_solver_t *solver, const pg_qp_t *qp) {
  const int held = solver->minimum.held;
  return solver->usable && solver->is_at_hand && (held < N || qp->ubA[held - N] == solver->held_ubA);
}

/* The minimum as a solution. */
static void take_minimum(const pg_minimum_t *minimum, pg_solution_t *solution) {
  memcpy(solution->x, minimum->x, sizeof solution->x);
  if (minimum->held >= N) solution->y[minimum->held - N] = minimum->multiplier;
  solution->iterations += minimum->held != PG_NOTHING_HELD;
}

/* The least-distance problem after all, where the row that held the minimum has gone; 0 if H has no factor,
 * which it had when it was loaded. */
static int form_late(pg_solver_t *solver, const pg_qp_t *qp) {
  double U[N][N];
  if (!pg_factorise(qp->H, U)) return 0;
  form(solver, qp, U);
  return 1;
}

/* Solves what is loaded, from the empty working set. */
static pg_outcome_t solve_loaded(pg_solver_t *solver, const pg_qp_t *qp, pg_solution_t *solution) {
  DAQPWorkspace *work = &solver->work;
  memset(solution->y, 0, sizeof solution->y);
  if (!solver->usable) return PG_UNSOLVED;
  if (pg_solver_is_at_hand(solver, qp)) {
    take_minimum(&solver->minimum, solution);
    return PG_OPTIMAL;
  }
  if (solver->is_at_hand && !form_late(solver, qp)) return PG_UNSOLVED;

  place_sides(solver, qp);
  reset_daqp_workspace(work);
  if (daqp_activate_constraints(work) < 0) return PG_UNSOLVED;
  const int exit = daqp_ldp(work);
  solution->iterations += work->iterations - 1;
  if (exit == DAQP_EXIT_OPTIMAL || exit == DAQP_EXIT_SOFT_OPTIMAL) {
    ldp2qp_solution(work);
    memcpy(solution->x, work->x, sizeof solution->x);
    read_multipliers(solver, solution->y);
    return PG_OPTIMAL;
  }
  if (exit == DAQP_EXIT_INFEASIBLE) {
    for (int i = 0; i < work->n_active; i++)
      work->lam_star[i] *= solver->scaling[work->WS[i]];
    read_multipliers(solver, solution->y);
    return PG_INFEASIBLE;
  }
  return PG_UNSOLVED;
}

/* The other way: a rounder objective, 1/2 x'Hx + g'x + 1/2 mu ||x - c||^2, where c is the solution of the
 * step before (proximal point method). Constraints that a flat H makes hard to tell apart are told apart in
 * this. */
static pg_outcome_t solve_rounded(pg_solver_t *solver, const pg_qp_t *qp, int is_sharp,
                                  pg_solution_t *solution) {
  double H[N * N], g[N];
  pg_qp_t rounded = *qp;
  pg_outcome_t outcome = PG_OPTIMAL;
  rounded.H = H;
  rounded.g = g;
  memcpy(H, qp->H, sizeof H);
  for (int j = 0; j < N; j++)
    H[j * N + j] += ROUNDING;
  for (int step = 0; step < ROUNDED_STEPS && outcome == PG_OPTIMAL; step++) {
    for (int j = 0; j < N; j++)
      g[j] = qp->g[j] - ROUNDING * solution->x[j];
    pg_solver_load(solver, &rounded);
    if (is_sharp && step == ROUNDED_STEPS - 1) solver->settings.primal_tol *= SHARPER;
    outcome = solve_loaded(solver, &rounded, solution);
  }
  return outcome;
}

pg_outcome_t pg_solver_solve(pg_solver_t *solver, const pg_qp_t *qp, pg_start_t start,
                             pg_solution_t *solution) {
  memset(solution, 0, sizeof *solution);
  return start == PG_FIRST ? solve_loaded(solver, qp, solution)
                           : solve_rounded(solver, qp, start == PG_SHARP, solution);
}
