/* Minima with at most one constraint: what is said to be found is optimal, and all kinds are found. */
#include "check.h"
#include "minimum.h"
#include "state.h"

#include <string.h>

typedef struct {
  double H[PG_N * PG_N], g[PG_N], A[PG_ROWS * PG_N], lb[PG_N], ub[PG_N], ubA[PG_ROWS], softness[PG_ROWS];
  pg_qp_t qp;
} problem_t;

static void make_problem(random_t *random, problem_t *p, double lambda, int soft) {
  const double xdot = between(random, -1.0, 1.0);
  double J[PG_N];
  for (int j = 0; j < PG_N; j++)
    J[j] = between(random, -1.0, 1.0);
  for (int i = 0; i < PG_N; i++) {
    for (int j = 0; j < PG_N; j++)
      p->H[i * PG_N + j] = J[i] * J[j] + (i == j ? lambda : 0.0);
    p->g[i] = -J[i] * xdot; /* as a task makes it: in the range of H, however flat that is */
    p->lb[i] = between(random, -1.0, -0.1);
    p->ub[i] = between(random, 0.1, 1.0);
  }
  for (int i = 0; i < PG_ROWS; i++) {
    for (int j = 0; j < PG_N; j++)
      p->A[i * PG_N + j] = between(random, -1.0, 1.0);
    p->ubA[i] = between(random, 0.0, 1.0) < 0.5 ? PG_OFF : between(random, 0.01, 0.1);
    p->softness[i] = soft ? between(random, 1e-3, 1.0) : 0.0;
  }
  p->qp = (pg_qp_t){
      .H = p->H, .g = p->g, .A = p->A, .lb = p->lb, .ub = p->ub, .ubA = p->ubA, .softness = p->softness};
}

static int find(const problem_t *p, pg_minimum_t *minimum) {
  double U[PG_N][PG_N], w[PG_N];
  if (!pg_factorise(p->H, U)) return 0;
  pg_solve_transposed(U, p->g, w);
  return pg_find_minimum(U, w, &p->qp, minimum);
}

/* The residual of the certificate, of a minimum as it is. */
static double residual(const problem_t *p, const pg_minimum_t *minimum) {
  pg_solution_t solution = {{0.0}, {0.0}, 0};
  memcpy(solution.x, minimum->x, sizeof solution.x);
  if (minimum->held >= PG_N) solution.y[minimum->held - PG_N] = minimum->multiplier;
  return pg_kkt_residual(&p->qp, &solution);
}

static void what_is_found_is_optimal(int soft) {
  random_t random = {41};
  int free = 0, lower = 0, upper = 0, rows = 0, left = 0;
  for (int i = 0; i < 20000; i++) {
    problem_t p;
    pg_minimum_t minimum;
    make_problem(&random, &p, 1e-3, soft);
    if (!find(&p, &minimum)) {
      left++;
      continue;
    }
    CHECK(residual(&p, &minimum) <= 1e-12);
    const int held = minimum.held;
    if (held == PG_NOTHING_HELD) {
      free++;
    } else if (held >= PG_N) {
      CHECK(minimum.multiplier > 0.0 && p.ubA[held - PG_N] < PG_OFF);
      rows++;
    } else {
      CHECK(minimum.x[held] == p.lb[held] || minimum.x[held] == p.ub[held]);
      *(minimum.x[held] < 0.0 ? &lower : &upper) += 1;
    }
  }
  CHECK(free > 300 && lower > 300 && upper > 300 && rows > 300 && left > 300);
}

/* One row alone, and bounds that are far away: that is always enough. */
static void a_single_row(void) {
  random_t random = {42};
  for (int i = 0; i < 2000; i++) {
    problem_t p;
    pg_minimum_t minimum;
    make_problem(&random, &p, 1e-3, 0);
    for (int j = 0; j < PG_N; j++)
      p.lb[j] = -1e6, p.ub[j] = 1e6;
    for (int row = 1; row < PG_ROWS; row++)
      p.ubA[row] = PG_OFF;
    p.ubA[0] = between(&random, -0.1, 0.1);
    CHECK(find(&p, &minimum) && residual(&p, &minimum) <= 1e-10);
  }
}

/* A free minimum that is far away leaves its digits with neither the bounds nor the certificate. */
static void a_flat_objective(void) {
  random_t random = {43};
  int found = 0;
  for (int i = 0; i < 5000; i++) {
    problem_t p;
    pg_minimum_t minimum;
    make_problem(&random, &p, 1e-9, 0);
    if (!find(&p, &minimum)) continue;
    CHECK(residual(&p, &minimum) <= PG_TOLERANCE);
    found++;
  }
  CHECK(found > 100);
}

static void numbers_that_are_not_finite(void) {
  random_t random = {44};
  const double wrong[] = {NAN, INFINITY, -INFINITY};
  for (int i = 0; i < 3000; i++) {
    problem_t p;
    pg_minimum_t minimum;
    make_problem(&random, &p, 1e-3, 0);
    *(i % 2 ? &p.g[i % PG_N] : &p.H[i % (PG_N * PG_N)]) = wrong[i % 3];
    CHECK(!find(&p, &minimum) || !(residual(&p, &minimum) <= PG_TOLERANCE));
  }
}

int main(void) {
  what_is_found_is_optimal(0);
  what_is_found_is_optimal(1);
  a_single_row();
  a_flat_objective();
  numbers_that_are_not_finite();
  return checks_failed > 0;
}
