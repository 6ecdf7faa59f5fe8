/* Newton steps on the residual of the certificate: make a solution that is nearly exact exact.
 *
 * A solver's answer carries its rounding errors, which a small damping lambda magnifies, and which the
 * acceleration bounds carry on into the next cycles. Its working set is what is worth having: with that, the
 * conditions of optimality are linear equations, and one solve of them for the corrections leaves rounding
 * errors only. With f the joints that are free, and w the rows that hold:
 *
 *     [ H_ff   A_wf'   ] [ dx_f ]       [ (Hx + g + A'y)_f          ]
 *     [ A_wf  -soft_w  ] [ dy_w ]  =  - [ (Ax - softness*y - ubA)_w ]
 */
#include "state.h"
#include "triangular.h"

#include <math.h>
#include <string.h>

/* A residual r leaves an error of up to r/lambda in q_dot, so certified is not yet exact. */
#define EXACT (1e-6 * PG_TOLERANCE)

/* Another working set may come out of a step, and the next ones go on from that, though it seem worse at
 * first: unless what is there is good enough already. */
#define STEPS 10
#define GOOD  ((PG_RELAXATION_SLACK ? 1e-3 : 1e-5) * PG_TOLERANCE)

/* A row depends on those before it if only this part of it is left, which is rounding. */
#define DEPENDENT 1e-14

enum { MOST = PG_N + PG_ROWS };

/* The unknowns: free joints first, then rows that hold. */
typedef struct {
  int joints, size;
  int index[MOST];
  double K[MOST][MOST]; /* lower triangle */
  double change[MOST];
  double scale[MOST]; /* of the diagonal, were nothing known of the others */
} equations_t;

/* A solution may be outside its bounds by a tolerance; a command may not. */
static void keep_within_bounds(const pg_qp_t *qp, double x[PG_N]) {
  for (int j = 0; j < PG_N; j++)
    x[j] = x[j] < qp->lb[j] ? qp->lb[j] : x[j] > qp->ub[j] ? qp->ub[j] : x[j];
}

/* Decides as the certificate does which joint is free and which row holds; puts the others on
 * their bounds. */
static void choose_unknowns(const pg_qp_t *qp, pg_solution_t *solution, equations_t *equations) {
  double *x = solution->x, *y = solution->y, gradient[PG_N];
  int holds[PG_ROWS];
  for (int i = 0; i < PG_ROWS; i++)
    holds[i] =
        qp->ubA[i] < PG_OFF && y[i] > qp->ubA[i] + qp->softness[i] * y[i] - pg_row_times(&qp->A[i * PG_N], x);
  for (int j = 0; j < PG_N; j++) {
    gradient[j] = qp->g[j] + pg_row_times(&qp->H[j * PG_N], x);
    for (int i = 0; i < PG_ROWS; i++)
      gradient[j] += qp->A[i * PG_N + j] * y[i];
  }

  equations->size = 0;
  for (int j = 0; j < PG_N; j++) {
    if (x[j] - gradient[j] <= qp->lb[j])
      x[j] = qp->lb[j];
    else if (x[j] - gradient[j] >= qp->ub[j])
      x[j] = qp->ub[j];
    else
      equations->index[equations->size++] = j;
  }
  equations->joints = equations->size;
  /* Rows with a multiplier come first: of rows that depend on each other, the last are left out. */
  for (int i = 0; i < PG_ROWS; i++)
    if (holds[i] && y[i] > 0.0) equations->index[equations->size++] = i;
  for (int i = 0; i < PG_ROWS; i++) {
    if (holds[i] && y[i] > 0.0) continue;
    y[i] = 0.0;
    if (holds[i]) equations->index[equations->size++] = i;
  }
}

static void write_equations(const pg_qp_t *qp, const pg_solution_t *solution, equations_t *equations) {
  const int joints = equations->joints;
  for (int a = 0; a < joints; a++) {
    const int j = equations->index[a];
    double gradient = qp->g[j] + pg_row_times(&qp->H[j * PG_N], solution->x);
    for (int b = joints; b < equations->size && b < MOST; b++) { /* MOST: for compilers, which warn */
      const int i = equations->index[b];
      gradient += qp->A[i * PG_N + j] * solution->y[i];
      equations->K[b][a] = qp->A[i * PG_N + j];
    }
    for (int b = 0; b <= a; b++)
      equations->K[a][b] = qp->H[j * PG_N + equations->index[b]];
    equations->change[a] = -gradient;
    equations->scale[a] = equations->K[a][a];
  }
  for (int a = joints; a < equations->size; a++) {
    const int i = equations->index[a];
    const double *row = &qp->A[i * PG_N];
    for (int b = joints; b < a; b++)
      equations->K[a][b] = 0.0;
    equations->K[a][a] = -qp->softness[i];
    equations->scale[a] = qp->softness[i] + pg_row_times(row, row);
    equations->change[a] = qp->ubA[i] + qp->softness[i] * solution->y[i] - pg_row_times(row, solution->x);
  }
}

/* Row a of K = LDL', in place. No pivoting is needed: the first block is positive definite, and what is left
 * of the second then negative definite; but a row that depends on those before it is met when they are, and
 * is left out. */
static void factorise_row(equations_t *equations, int a) {
  double *row = equations->K[a];
  for (int b = 0; b < a; b++)
    for (int c = 0; c < b; c++)
      row[b] -= row[c] * equations->K[b][c];
  double magnitude = equations->scale[a];
  for (int b = 0; b < a; b++) {
    const double scaled = row[b] / equations->K[b][b];
    magnitude += fabs(row[b] * scaled);
    row[a] -= row[b] * scaled;
    row[b] = scaled;
  }
  if (!(fabs(row[a]) > DEPENDENT * magnitude)) {
    memset(row, 0, (size_t)a * sizeof(double));
    row[a] = 1.0;
    equations->change[a] = 0.0;
  }
}

static void solve_equations(equations_t *equations) {
  const int size = equations->size;
  double *change = equations->change;
  for (int a = 0; a < size; a++) {
    factorise_row(equations, a);
    for (int b = 0; b < a; b++)
      change[a] -= equations->K[a][b] * change[b];
  }
  for (int a = 0; a < size; a++)
    change[a] /= equations->K[a][a];
  for (int a = size - 1; a > 0; a--)
    for (int b = 0; b < a; b++)
      change[b] -= equations->K[a][b] * change[a];
}

/* One Newton step. */
static void improve(const pg_qp_t *qp, pg_solution_t *solution) {
  equations_t equations;
  choose_unknowns(qp, solution, &equations);
  write_equations(qp, solution, &equations);
  solve_equations(&equations);
  for (int a = 0; a < equations.joints; a++)
    solution->x[equations.index[a]] += equations.change[a];
  for (int a = equations.joints; a < equations.size; a++)
    solution->y[equations.index[a]] += equations.change[a];
}

double pg_polish(const pg_qp_t *qp, pg_solution_t *solution) {
  keep_within_bounds(qp, solution->x);
  double residual = pg_kkt_residual(qp, solution);
  pg_solution_t improved = *solution;
  double left = residual;
  for (int step = 0; step < STEPS && residual > EXACT && left < PG_INFINITY; step++) {
    improve(qp, &improved);
    keep_within_bounds(qp, improved.x);
    left = pg_kkt_residual(qp, &improved);
    if (left < residual) {
      *solution = improved;
      residual = left;
    } else if (residual <= GOOD)
      break;
  }
  return residual;
}
