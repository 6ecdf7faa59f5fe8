/* Step 7: what a solver says is believed only after a look at the QP itself. Costs about a tenth
 * of a solve. */
#include "state.h"
#include "triangular.h"

#include <math.h>

/* Keeps the greatest magnitude seen, and whether all were finite. */
typedef struct {
  double greatest;
  double sum; /* NaN or infinite as soon as one value was */
} residual_t;

static void add(residual_t *residual, double value) {
  const double magnitude = fabs(value);
  residual->greatest = magnitude > residual->greatest ? magnitude : residual->greatest;
  residual->sum += magnitude;
}

/* What has to be zero, and so has its product with what stands against it: next to a multiplier of 1e27 a
 * distance of 1e-15 is not small. */
static void add_pair(residual_t *residual, double zero, double other) {
  add(residual, zero);
  add(residual, zero * other);
}

static double between(double value, double low, double high) {
  return value < low ? low : value > high ? high : value;
}

/* The conditions as one residual each, which is zero only if all of them hold:
 *   bounds: x - clamp(x - r, lb, ub) with r = Hx + g + A'y, the gradient of the Lagrangian. Inside its bounds
 * r has to vanish (stationarity); at a bound it has to point outwards (sign of the bound's multiplier). rows:
 * min(y, ubA + softness*y - Ax). None is negative (sign, feasibility), one is zero (complementarity). */
double pg_kkt_residual(const pg_qp_t *qp, const pg_solution_t *solution) {
  const double *x = solution->x, *y = solution->y;
  residual_t residual = {0.0, 0.0};
  double gradient[PG_N];
  for (int j = 0; j < PG_N; j++)
    gradient[j] = qp->g[j] + pg_row_times(&qp->H[j * PG_N], x);

  for (int i = 0; i < PG_ROWS; i++) {
    if (qp->ubA[i] >= PG_OFF) {
      add(&residual, y[i]);
      continue;
    }
    const double *row = &qp->A[i * PG_N];
    const double room = qp->ubA[i] + qp->softness[i] * y[i] - pg_row_times(row, x);
    if (y[i] < room)
      add_pair(&residual, y[i], room);
    else
      add_pair(&residual, room, y[i]);
    for (int j = 0; j < PG_N; j++)
      gradient[j] += row[j] * y[i];
  }
  for (int j = 0; j < PG_N; j++)
    add_pair(&residual, x[j] - between(x[j] - gradient[j], qp->lb[j], qp->ub[j]), gradient[j]);
  return residual.sum - residual.sum == 0.0 ? residual.greatest : PG_INFINITY;
}
