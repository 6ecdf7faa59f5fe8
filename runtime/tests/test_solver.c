/* The back end alone, behind solver.h: right answers from cycle to cycle, and the traps of both solvers. */
#include "rig.h"

#include <string.h>

typedef struct {
  double H[PG_N * PG_N], g[PG_N], A[PG_ROWS * PG_N], lb[PG_N], ub[PG_N], ubA[PG_ROWS], softness[PG_ROWS];
  pg_qp_t qp;
} problem_t;

typedef struct {
  _Alignas(16) unsigned char memory[PG_SOLVER_MEMORY];
  pg_solver_t *solver;
} bench_t;

static void open(bench_t *bench) {
  CHECK(pg_solver_create(bench->memory, &bench->solver) == PG_SOLVED);
  pg_solver_reset(bench->solver);
}

static void fill(random_t *random, problem_t *p) {
  const double xdot = between(random, -1.0, 1.0);
  double J[PG_N];
  for (int j = 0; j < PG_N; j++)
    J[j] = between(random, -1.0, 1.0);
  for (int i = 0; i < PG_N; i++) {
    for (int j = 0; j < PG_N; j++)
      p->H[i * PG_N + j] = J[i] * J[j] + (i == j ? 1e-3 : 0.0);
    p->g[i] = -J[i] * xdot; /* as a task makes it: in the range of H, however flat that is */
    p->lb[i] = between(random, -1.0, -0.1);
    p->ub[i] = between(random, 0.1, 1.0);
  }
  for (int i = 0; i < PG_ROWS; i++) {
    for (int j = 0; j < PG_N; j++)
      p->A[i * PG_N + j] = between(random, -1.0, 1.0);
    p->ubA[i] = between(random, 0.01, 0.1);
  }
  p->qp = (pg_qp_t){
      .H = p->H, .g = p->g, .A = p->A, .lb = p->lb, .ub = p->ub, .ubA = p->ubA, .softness = p->softness};
}

static pg_outcome_t solve(bench_t *bench, const problem_t *p, pg_start_t start, pg_solution_t *solution) {
  pg_solver_load(bench->solver, &p->qp);
  return pg_solver_solve(bench->solver, &p->qp, start, solution);
}

/* Rows that come and go in their slots, from QP to QP: a hot start must notice. Regression test of the trap
 * that gave wrong answers in 27 of 100 cycles when rows were zeroed instead. */
static void rows_that_come_and_go(void) {
  bench_t bench;
  open(&bench);
  random_t random = {21};
  problem_t p = {0};
  int wrong = 0;
  for (int i = 0; i < 20000; i++) {
    const double shift = i % 50 ? 0.05 : 1.0; /* mostly a QP that is near the last one */
    problem_t next = {0};
    fill(&random, &next);
    if (i == 0) p = next;
    for (int k = 0; k < PG_N; k++)
      p.g[k] += shift * (next.g[k] - p.g[k]);
    for (int k = 0; k < PG_ROWS; k++) {
      const int on = between(&random, 0.0, 1.0) < 0.5;
      p.ubA[k] = on ? next.ubA[k] : PG_OFF;
      for (int j = 0; j < PG_N && on; j++) /* an off row keeps its direction */
        p.A[k * PG_N + j] += shift * (next.A[k * PG_N + j] - p.A[k * PG_N + j]);
    }
    p.qp =
        (pg_qp_t){.H = p.H, .g = p.g, .A = p.A, .lb = p.lb, .ub = p.ub, .ubA = p.ubA, .softness = p.softness};
    pg_solution_t solution, again;
    pg_outcome_t outcome = solve(&bench, &p, PG_FIRST, &solution);
    wrong += outcome != PG_OPTIMAL || !(pg_kkt_residual(&p.qp, &solution) <= PG_TOLERANCE);
    pg_polish(&p.qp, &solution);
    if (i % 10) continue; /* now and then the other way: must agree */
    outcome = solve(&bench, &p, PG_AGAIN, &again);
    CHECK(outcome == PG_OPTIMAL && pg_polish(&p.qp, &again) <= PG_TOLERANCE);
    for (int j = 0; j < PG_N; j++)
      CHECK_NEAR(again.x[j], solution.x[j], 1e-8);
  }
  CHECK_EQUAL(wrong, 0);
  pg_solver_destroy(bench.solver);
}

static void make_infeasible(problem_t *p) {
  for (int j = 0; j < PG_N; j++)
    p->A[PG_N + j] = -p->A[j];
  p->ubA[0] = p->ubA[1] = -0.05;
}

/* An infeasible QP is said to be so, and does not spoil what follows. */
static void infeasible_and_feasible_in_turn(void) {
  bench_t bench;
  open(&bench);
  random_t random = {22};
  for (int i = 0; i < 2000; i++) {
    problem_t p = {0};
    pg_solution_t solution;
    fill(&random, &p);
    make_infeasible(&p);
    CHECK_EQUAL(solve(&bench, &p, i % 3 ? PG_FIRST : PG_AGAIN, &solution), PG_INFEASIBLE);
    fill(&random, &p);
    CHECK_EQUAL(solve(&bench, &p, PG_FIRST, &solution), PG_OPTIMAL);
    CHECK(pg_kkt_residual(&p.qp, &solution) <= PG_TOLERANCE);
  }
  pg_solver_destroy(bench.solver);
}

/* Right-hand sides change between solves of one load, as from stage to stage. */
static void stages_share_a_load(void) {
  bench_t bench;
  open(&bench);
  random_t random = {23};
  for (int i = 0; i < 2000; i++) {
    problem_t p = {0};
    pg_solution_t solution;
    fill(&random, &p);
    make_infeasible(&p);
    CHECK_EQUAL(solve(&bench, &p, PG_FIRST, &solution), PG_INFEASIBLE);
    p.ubA[0] = PG_OFF;
    const pg_outcome_t second = pg_solver_solve(bench.solver, &p.qp, PG_FIRST, &solution);
    CHECK(second == PG_INFEASIBLE || pg_kkt_residual(&p.qp, &solution) <= PG_TOLERANCE);
    p.ubA[1] = 0.0;
    CHECK_EQUAL(pg_solver_solve(bench.solver, &p.qp, PG_FIRST, &solution), PG_OPTIMAL);
    CHECK(pg_kkt_residual(&p.qp, &solution) <= PG_TOLERANCE);
  }
  pg_solver_destroy(bench.solver);
}

/* Rows that hold the solution are switched off after the first solve, as by the ladder. */
static void rows_that_held_the_solution_go(void) {
  bench_t bench;
  open(&bench);
  random_t random = {31};
  int gone = 0;
  for (int i = 0; i < 5000; i++) {
    problem_t p = {0};
    pg_solution_t solution;
    fill(&random, &p);
    CHECK_EQUAL(solve(&bench, &p, PG_FIRST, &solution), PG_OPTIMAL);
    for (int k = 0; k < PG_ROWS; k++)
      if (solution.y[k] > 0.0) p.ubA[k] = PG_OFF, gone++;
    CHECK_EQUAL(pg_solver_solve(bench.solver, &p.qp, PG_FIRST, &solution), PG_OPTIMAL);
    CHECK(pg_kkt_residual(&p.qp, &solution) <= PG_TOLERANCE);
  }
  CHECK(gone > 1000);
  pg_solver_destroy(bench.solver);
}

/* DAQP alone returns success with x = NaN for a NaN in H or g. */
static void numbers_that_are_not_finite(void) {
  bench_t bench;
  open(&bench);
  random_t random = {24};
  const double wrong[] = {NAN, INFINITY, -INFINITY};
  for (int i = 0; i < 3 * (PG_N * PG_N + 2 * PG_N); i++) {
    problem_t p = {0};
    pg_solution_t solution;
    fill(&random, &p);
    const int place = i / 3;
    if (place < PG_N * PG_N)
      p.H[place] = wrong[i % 3];
    else if (place < PG_N * PG_N + PG_N)
      p.g[place - PG_N * PG_N] = wrong[i % 3];
    else
      p.A[place - PG_N * PG_N - PG_N] = wrong[i % 3];
    for (int start = PG_FIRST; start <= PG_AGAIN; start++) {
      const pg_outcome_t outcome = solve(&bench, &p, (pg_start_t)start, &solution);
      CHECK(outcome != PG_OPTIMAL || !(pg_kkt_residual(&p.qp, &solution) <= PG_TOLERANCE));
    }
    fill(&random, &p); /* and the next QP is solved as if nothing had been */
    pg_outcome_t outcome = solve(&bench, &p, PG_FIRST, &solution);
    if (outcome != PG_OPTIMAL) outcome = solve(&bench, &p, PG_AGAIN, &solution);
    CHECK(outcome == PG_OPTIMAL && pg_polish(&p.qp, &solution) <= PG_TOLERANCE);
  }
  pg_solver_destroy(bench.solver);
}

/* Flat objectives, down to the floor of lambda: solved, or at worst (1 in 1000 at 1e-9) known not to be. */
static void a_small_lambda(double lambda, int tolerated) {
  bench_t bench;
  open(&bench);
  random_t random = {25};
  int unsolved = 0;
  for (int i = 0; i < 2000; i++) {
    problem_t p = {0};
    pg_solution_t solution;
    fill(&random, &p);
    for (int j = 0; j < PG_N; j++)
      p.H[j * PG_N + j] += lambda - 1e-3;
    pg_outcome_t outcome = solve(&bench, &p, PG_FIRST, &solution);
    if (outcome != PG_OPTIMAL || !(pg_polish(&p.qp, &solution) <= PG_TOLERANCE))
      outcome = solve(&bench, &p, PG_AGAIN, &solution);
    if (outcome != PG_OPTIMAL || !(pg_polish(&p.qp, &solution) <= PG_TOLERANCE)) unsolved++;
  }
  CHECK(unsolved <= tolerated);
  pg_solver_destroy(bench.solver);
}

static void bounds_that_are_equal_or_absent(void) {
  bench_t bench;
  open(&bench);
  random_t random = {26};
  for (int i = 0; i < 2000; i++) {
    problem_t p = {0};
    pg_solution_t solution;
    fill(&random, &p);
    for (int j = 0; j < PG_N; j++) {
      if ((i >> j) & 1) p.lb[j] = p.ub[j] = 0.0;
      if ((i >> j) & 4) p.lb[j] = -1e20, p.ub[j] = 1e20;
    }
    CHECK_EQUAL(solve(&bench, &p, PG_FIRST, &solution), PG_OPTIMAL);
    CHECK(pg_kkt_residual(&p.qp, &solution) <= PG_TOLERANCE);
  }
  pg_solver_destroy(bench.solver);
}

/* The limit of working-set changes: kept in every solve, and reaching it is not a success. */
static void the_limit_of_changes(void) {
  bench_t bench;
  open(&bench);
  random_t random = {27};
  int unsolved = 0;
  for (int i = 0; i < 5000; i++) {
    problem_t p = {0};
    pg_solution_t solution;
    fill(&random, &p);
    for (int start = PG_FIRST; start <= PG_AGAIN; start++) {
      const pg_outcome_t outcome = solve(&bench, &p, (pg_start_t)start, &solution);
      CHECK(solution.iterations <= 4 * PG_MAX_ITERATIONS); /* DAQP's other way takes four solves */
      if (outcome == PG_UNSOLVED) unsolved++;
      if (outcome == PG_OPTIMAL) CHECK(pg_polish(&p.qp, &solution) <= PG_TOLERANCE);
    }
  }
  CHECK(PG_MAX_ITERATIONS < 5 ? unsolved > 0 : unsolved == 0);
  pg_solver_destroy(bench.solver);
}

/* What the solver is given belongs to the caller. */
static void the_qp_is_left_as_it_was(void) {
  bench_t bench;
  open(&bench);
  random_t random = {28};
  for (int i = 0; i < 1000; i++) {
    problem_t p = {0};
    pg_solution_t solution;
    fill(&random, &p);
    if (i % 3 == 0) make_infeasible(&p);
    const problem_t before = p;
    solve(&bench, &p, i % 2 ? PG_FIRST : PG_AGAIN, &solution);
    CHECK(memcmp(&before, &p, sizeof p) == 0);
  }
  pg_solver_destroy(bench.solver);
}

/* Rows that leave one point alone, q_dot = 0, as where joints stand at their limits: rounding errors make
 * them look contradictory. The last attempt moves them apart. Each of these was missed by DAQP before. */
static void rows_that_leave_a_single_point(void) {
  static const struct {
    double lambda, J[PG_N], xdot, A[2 * PG_N];
  } cases[] = {{1e-4, {-0.3, 0.0}, 0.3, {-4e-6, -0.007, -8e-6, -0.06}},
               {1e-4, {-0.8, 1.0}, -3.3, {-0.2, -4e-6, -0.3, -5e-6}},
               {1e-5, {0.0, 0.6}, -0.4, {-0.005, -7e-6, -0.03, -2e-6}},
               {1e-5, {-0.7, 1.0}, -2.2, {-0.9, -5e-5, -0.09, -6e-6}},
               {1e-6, {-0.9, 0.4}, 4.4, {-9e-5, -0.6, -2e-6, -0.2}}};
  rig_t rig;
  rig_open(&rig);
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
    random_t random = {29};
    problem_t p = {0};
    fill(&random, &p);
    for (int i = 0; i < PG_N; i++) {
      for (int j = 0; j < PG_N; j++)
        p.H[i * PG_N + j] = cases[k].J[i] * cases[k].J[j] + (i == j ? cases[k].lambda : 0.0);
      p.g[i] = -cases[k].J[i] * cases[k].xdot;
      p.lb[i] = -1.0;
      p.ub[i] = 0.0;
    }
    memcpy(p.A, cases[k].A, sizeof cases[k].A);
    for (int i = 0; i < PG_ROWS; i++)
      p.ubA[i] = i < 2 ? 0.0 : PG_OFF;
    pg_solver_load(rig.controller->solver, &p.qp);
    CHECK_EQUAL(pg_solve(rig.controller, &p.qp), PG_OPTIMAL);
    for (int j = 0; j < PG_N; j++)
      CHECK_NEAR(rig.controller->solution.x[j], 0.0, 1e-9);
  }
  rig_close(&rig);
}

/* Where rows leave a narrow cone, and bounds little room, there is more than one working set within a
 * solver's usual tolerances, and polishing comes to nothing with a wrong one. q_dot = 0 meets all of them
 * exactly, so that what is left of a residual is an error. Without a sharp attempt it is above 1e-11 in 1,800
 * of these with DAQP, and in 350 with qpOASES. */
static void cones_and_boxes_that_are_narrow(void) {
  enum { PROBLEMS = 5000 };
  rig_t rig;
  rig_open(&rig);
  random_t random = {31};
  int inexact = 0;
  for (int i = 0; i < PROBLEMS; i++) {
    problem_t p = {0};
    fill(&random, &p);
    for (int j = 0; j < PG_N; j++) {
      p.lb[j] = -pow(10.0, between(&random, -8.0, -3.0));
      p.ub[j] = pow(10.0, between(&random, -8.0, -3.0));
    }
    const double angle = between(&random, -3.0, 3.0), lever = pow(10.0, between(&random, -2.0, 0.0));
    for (int k = 0; k < PG_ROWS; k++) { /* by turns on either side of a line */
      const double turned = angle + pow(10.0, between(&random, -4.0, -1.0)), side = k % 2 ? -lever : lever;
      p.A[k * PG_N] = side * cos(turned);
      p.A[k * PG_N + 1] = side * sin(turned);
      p.ubA[k] = 0.0;
    }
    pg_solver_load(rig.controller->solver, &p.qp);
    CHECK_EQUAL(pg_solve(rig.controller, &p.qp), PG_OPTIMAL);
    inexact += !(rig.controller->cycle.kkt_residual <= 1e-11);
  }
  CHECK(inexact <= PROBLEMS / 100);
  rig_close(&rig);
}

/* A solver that ends switches qpOASES's messages on, for those that live on; what is printed fails the test.
 */
static void others_come_and_go(void) {
  bench_t bench, other;
  open(&bench);
  for (int i = 0; i < 10; i++) {
    random_t random = {30};
    problem_t p = {0};
    pg_solution_t solution;
    open(&other);
    if (i % 2) pg_solver_destroy(other.solver);
    fill(&random, &p);
    solve(&bench, &p, PG_FIRST, &solution);
    make_infeasible(&p);
    for (int start = PG_FIRST; start <= PG_AGAIN; start++)
      CHECK_EQUAL(solve(&bench, &p, (pg_start_t)start, &solution), PG_INFEASIBLE);
    if (i % 2 == 0) pg_solver_destroy(other.solver);
  }
  pg_solver_destroy(bench.solver);
}

int main(void) {
  the_limit_of_changes();
  the_qp_is_left_as_it_was();
  if (PG_MAX_ITERATIONS < 5) return checks_failed > 0;
  rows_that_come_and_go();
  infeasible_and_feasible_in_turn();
  stages_share_a_load();
  rows_that_held_the_solution_go();
  numbers_that_are_not_finite();
  a_small_lambda(1e-6, 0);
  a_small_lambda(1e-9, 0);
  bounds_that_are_equal_or_absent();
  rows_that_leave_a_single_point();
  cones_and_boxes_that_are_narrow();
  others_come_and_go();
  return checks_failed > 0;
}
