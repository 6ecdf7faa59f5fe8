/* The certificate accepts the solution and nothing else; proofs of infeasibility hold; polish makes exact.
 *
 * QPs are made from their solutions: with x, the working set and the multipliers chosen, g and the bounds
 * follow. */
#include "check.h"
#include "state.h"

#include <string.h>

typedef struct {
  double H[PG_N * PG_N], g[PG_N], A[PG_ROWS * PG_N], lb[PG_N], ub[PG_N], ubA[PG_ROWS], softness[PG_ROWS];
  pg_qp_t qp;
  pg_solution_t solution;
} problem_t;

static void make_problem(random_t *random, problem_t *p, int soft) {
  memset(p, 0, sizeof *p);
  double J[PG_N * PG_N];
  for (int i = 0; i < PG_N * PG_N; i++)
    J[i] = between(random, -1.0, 1.0);
  for (int i = 0; i < PG_N; i++)
    for (int j = 0; j < PG_N; j++) {
      p->H[i * PG_N + j] = i == j ? 1e-3 : 0.0;
      for (int k = 0; k < PG_N; k++)
        p->H[i * PG_N + j] += J[k * PG_N + i] * J[k * PG_N + j];
    }
  for (int j = 0; j < PG_N; j++)
    p->solution.x[j] = between(random, -1.0, 1.0);
  double pull[PG_N] = {0.0}; /* Hx + A'y: what g and the bounds' multipliers have to balance */
  for (int i = 0; i < PG_ROWS; i++) {
    double reach = 0.0;
    for (int j = 0; j < PG_N; j++) {
      p->A[i * PG_N + j] = between(random, -1.0, 1.0);
      reach += p->A[i * PG_N + j] * p->solution.x[j];
    }
    const int holds = i == 0 || (soft && i == 1);
    p->softness[i] = soft ? between(random, 1e-3, 1.0) : 0.0;
    p->solution.y[i] = holds ? between(random, 0.01, 1.0) : 0.0;
    p->ubA[i] = reach - p->softness[i] * p->solution.y[i] + (holds ? 0.0 : between(random, 0.01, 1.0));
    for (int j = 0; j < PG_N; j++)
      pull[j] += p->A[i * PG_N + j] * p->solution.y[i];
  }
  p->ubA[PG_ROWS - 1] = PG_OFF;
  for (int j = 0; j < PG_N; j++) {
    for (int k = 0; k < PG_N; k++)
      pull[j] += p->H[j * PG_N + k] * p->solution.x[k];
    const int at_lower = j == PG_N - 1;
    p->lb[j] = p->solution.x[j] - (at_lower ? 0.0 : 0.5);
    p->ub[j] = p->solution.x[j] + 0.5;
    p->g[j] = -pull[j] + (at_lower ? between(random, 0.01, 1.0) : 0.0);
  }
  p->qp = (pg_qp_t){
      .H = p->H, .g = p->g, .A = p->A, .lb = p->lb, .ub = p->ub, .ubA = p->ubA, .softness = p->softness};
}

static void accepts_the_solution_and_nothing_else(void) {
  random_t random = {5};
  for (int i = 0; i < 2000; i++) {
    problem_t p;
    make_problem(&random, &p, i % 2);
    CHECK(pg_kkt_residual(&p.qp, &p.solution) <= 1e-14);
    const double shift = i % 3 ? 1e-6 : -1e-6;
    for (int j = 0; j < PG_N; j++) { /* H >= 1e-3: an error of 1e-6 leaves at least 1e-9 in some condition */
      pg_solution_t wrong = p.solution;
      wrong.x[j] += shift;
      CHECK(pg_kkt_residual(&p.qp, &wrong) >= 1e-9);
      wrong.x[j] = NAN;
      CHECK(pg_kkt_residual(&p.qp, &wrong) == INFINITY);
    }
    for (int r = 0; r < PG_ROWS; r++) {
      pg_solution_t wrong = p.solution;
      wrong.y[r] += 1e-3;
      CHECK(pg_kkt_residual(&p.qp, &wrong) > PG_TOLERANCE);
      wrong.y[r] = -1e-3; /* wrong sign */
      CHECK(pg_kkt_residual(&p.qp, &wrong) > PG_TOLERANCE);
      wrong.y[r] = INFINITY;
      CHECK(pg_kkt_residual(&p.qp, &wrong) == INFINITY);
    }
    pg_solution_t outside = p.solution;
    outside.x[PG_N - 1] = p.lb[PG_N - 1] - 1e-3;
    CHECK(pg_kkt_residual(&p.qp, &outside) >= 1e-3 - 1e-12);
    p.g[0] = NAN;
    CHECK(pg_kkt_residual(&p.qp, &p.solution) == INFINITY);
  }
}

/* Next to a great multiplier, or a great pull on a bound, what is left of the room is no longer nothing. */
static void what_is_small_may_weigh_much(void) {
  random_t random = {12};
  for (int i = 0; i < 100; i++) {
    problem_t p;
    make_problem(&random, &p, 0);
    for (int j = 0; j < PG_N; j++)
      p.A[j] *= 1e-9;
    p.ubA[0] *= 1e-9;
    p.solution.y[0] *= 1e9;
    CHECK(pg_kkt_residual(&p.qp, &p.solution) <= 1e-6);
    p.ubA[0] += 1e-12;
    CHECK(pg_kkt_residual(&p.qp, &p.solution) >= 1e-5);
    make_problem(&random, &p, 0);
    p.g[PG_N - 1] += 1e9;
    CHECK(pg_kkt_residual(&p.qp, &p.solution) <= 1e-6);
    p.solution.x[PG_N - 1] += 1e-12;
    CHECK(pg_kkt_residual(&p.qp, &p.solution) >= 1e-4);
  }
}

/* Rows that exclude each other by less than the tolerance prove nothing: q <= -0.1 - excess and -q <= 0.1. */
static void a_proof_goes_beyond_the_tolerance(void) {
  random_t random = {13};
  problem_t p;
  make_problem(&random, &p, 0);
  memset(p.A, 0, sizeof p.A);
  p.A[0] = 1.0;
  p.A[PG_N] = -1.0;
  for (int i = 2; i < PG_ROWS; i++)
    p.ubA[i] = PG_OFF;
  for (int j = 0; j < PG_N; j++)
    p.lb[j] = -1.0, p.ub[j] = 1.0;
  double y[PG_ROWS] = {0.5, 0.5};
  p.ubA[1] = 0.1;
  for (int k = 0; k < 3; k++) {
    const double excess[] = {0.0, 1.9 * PG_TOLERANCE, 2.1 * PG_TOLERANCE};
    p.ubA[0] = -0.1 - excess[k];
    CHECK_EQUAL(pg_proves_infeasible(&p.qp, y), k == 2);
    const double twice[PG_ROWS] = {1.0, 1.0}; /* the scale does not matter */
    CHECK_EQUAL(pg_proves_infeasible(&p.qp, twice), k == 2);
  }
}

static void polish_makes_exact(void) {
  random_t random = {6};
  for (int i = 0; i < 2000; i++) {
    problem_t p;
    make_problem(&random, &p, i % 2);
    pg_solution_t rough = p.solution;
    for (int j = 0; j < PG_N; j++)
      rough.x[j] = fmax(rough.x[j] + between(&random, -1e-7, 1e-7), p.lb[j]);
    for (int r = 0; r < PG_ROWS; r++)
      if (rough.y[r] > 0.0) rough.y[r] += between(&random, -1e-7, 1e-7);
    pg_polish(&p.qp, &rough);
    for (int j = 0; j < PG_N; j++)
      CHECK_NEAR(rough.x[j], p.solution.x[j], 1e-11);
    for (int r = 0; r < PG_ROWS; r++)
      CHECK_NEAR(rough.y[r], p.solution.y[r], 1e-9);
  }
}

/* Rows that say the same twice have no unique multipliers; x is exact all the same. */
static void polish_with_rows_that_depend_on_each_other(void) {
  random_t random = {8};
  for (int i = 0; i < 500; i++) {
    problem_t p;
    make_problem(&random, &p, 0);
    for (int j = 0; j < PG_N; j++)
      p.A[PG_N + j] = 2.0 * p.A[j];
    p.ubA[1] = 2.0 * p.ubA[0];
    pg_solution_t rough = p.solution;
    rough.x[0] += 1e-8;
    rough.y[1] = i % 2 ? 0.0 : 1e-3;
    rough.y[0] -= 2.0 * rough.y[1];
    pg_polish(&p.qp, &rough);
    CHECK(pg_kkt_residual(&p.qp, &rough) <= 1e-13);
    CHECK_NEAR(rough.x[0], p.solution.x[0], 1e-11);
  }
}

/* a x <= b and -a x <= -b - gap: infeasible exactly if gap > 0. */
static void contradictions_are_found_and_proven(void) {
  random_t random = {9};
  int found = 0, tried = 0;
  for (int i = 0; i < 2000; i++) {
    problem_t p;
    make_problem(&random, &p, 0);
    const double gap = (i % 2 ? 1.0 : -1.0) * pow(10.0, between(&random, -6.0, 0.0));
    for (int r = 0; r < PG_ROWS; r++)
      p.ubA[r] = PG_OFF;
    for (int j = 0; j < PG_N; j++)
      p.A[PG_N + j] = -p.A[j];
    p.ubA[0] = -0.5 * gap; /* with a gap below 0, x of the solution is in the middle between both rows */
    for (int j = 0; j < PG_N; j++)
      p.ubA[0] += p.A[j] * p.solution.x[j];
    p.ubA[1] = -p.ubA[0] - gap;
    double y[PG_ROWS] = {1.0, 1.0};
    CHECK_EQUAL(pg_proves_infeasible(&p.qp, y), gap > 0.0);
    if (gap < 0.0) CHECK(pg_search(&p.qp, 64) != PG_CONTRADICTORY);
    if (gap > 0.0) CHECK(pg_search(&p.qp, 64) != PG_FEASIBLE);
    CHECK_EQUAL(pg_search(&p.qp, 0) == PG_CONTRADICTORY, gap > 0.0); /* two rows: found without a sweep */
    tried += gap > 0.0;
    found += pg_search(&p.qp, 64) == PG_CONTRADICTORY;
    y[0] = -1.0;
    CHECK(!pg_proves_infeasible(&p.qp, y));
    y[0] = NAN;
    CHECK(!pg_proves_infeasible(&p.qp, y));
    y[0] = 1.0, y[PG_ROWS - 1] = 1.0; /* a row that is off proves nothing */
    CHECK(!pg_proves_infeasible(&p.qp, y));
  }
  CHECK_EQUAL(found, tried);
}

/* One row that the bounds alone contradict. */
static void contradictions_with_the_bounds(void) {
  problem_t p;
  random_t random = {10};
  make_problem(&random, &p, 0);
  for (int r = 0; r < PG_ROWS; r++)
    p.ubA[r] = PG_OFF;
  double least = 0.0;
  for (int j = 0; j < PG_N; j++)
    least += p.A[j] * (p.A[j] > 0.0 ? p.lb[j] : p.ub[j]);
  const double y[PG_ROWS] = {1.0};
  p.ubA[0] = least - 1e-6;
  CHECK(pg_proves_infeasible(&p.qp, y) && pg_search(&p.qp, 2) == PG_CONTRADICTORY);
  p.ubA[0] = least;
  CHECK(!pg_proves_infeasible(&p.qp, y) && pg_search(&p.qp, 64) != PG_CONTRADICTORY);
}

int main(void) {
  accepts_the_solution_and_nothing_else();
  what_is_small_may_weigh_much();
  a_proof_goes_beyond_the_tolerance();
  polish_makes_exact();
  polish_with_rows_that_depend_on_each_other();
  contradictions_are_found_and_proven();
  contradictions_with_the_bounds();
  return checks_failed > 0;
}
