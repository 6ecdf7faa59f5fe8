/* A stage is infeasible if its rows contradict each other; weights on them prove it, whoever found the
 * weights. */
#include "state.h"

#include <string.h>

/* Rounds over all joints before the search gives up; nine in ten searches that end in a proof need one or
 * two. */
#define SWEEPS 16

/* For all x within the bounds, y'(Ax - ubA) >= gap. If gap > 0, no x can make all of Ax - ubA negative, and
 * some row is exceeded by at least gap / sum(y): the lemma of Farkas, with the box's part worked out. */
int pg_proves_infeasible(const pg_qp_t *qp, const double y[PG_ROWS]) {
  double combined[PG_N] = {0.0}, gap = 0.0, total = 0.0;
  for (int i = 0; i < PG_ROWS; i++) {
    if (y[i] == 0.0) continue;
    if (!(y[i] > 0.0) || qp->ubA[i] >= PG_OFF) return 0;
    for (int j = 0; j < PG_N; j++)
      combined[j] += y[i] * qp->A[i * PG_N + j];
    gap -= y[i] * qp->ubA[i];
    total += y[i];
  }
  for (int j = 0; j < PG_N; j++)
    gap += combined[j] * (combined[j] > 0.0 ? qp->lb[j] : qp->ub[j]);
  return gap > PG_TOLERANCE * total;
}

/* The rows that are on, and a point that tries to meet them. */
typedef struct {
  int count;
  int slot[PG_ROWS];
  double excess[PG_ROWS]; /* Ax - ubA of row slot[k] */
  double x[PG_N];
} search_t;

static void begin(const pg_qp_t *qp, search_t *search) {
  search->count = 0;
  for (int j = 0; j < PG_N; j++)
    search->x[j] = qp->lb[j] > 0.0 ? qp->lb[j] : qp->ub[j] < 0.0 ? qp->ub[j] : 0.0;
  for (int i = 0; i < PG_ROWS; i++) {
    if (qp->ubA[i] >= PG_OFF) continue;
    double excess = -qp->ubA[i];
    for (int j = 0; j < PG_N; j++)
      excess += qp->A[i * PG_N + j] * search->x[j];
    search->slot[search->count] = i;
    search->excess[search->count++] = excess;
  }
}

/* Moves x_j to where a parabola above 1/2 ||max(0, Ax - ubA)||^2 is least. */
static void descend(const pg_qp_t *qp, search_t *search, int j) {
  double slope = 0.0, curvature = 0.0;
  for (int k = 0; k < search->count; k++) {
    const double a = qp->A[search->slot[k] * PG_N + j];
    slope += search->excess[k] > 0.0 ? a * search->excess[k] : 0.0;
    curvature += a * a;
  }
  if (slope == 0.0) return;
  const double wanted = search->x[j] - slope / curvature;
  const double moved = wanted < qp->lb[j] ? qp->lb[j] : wanted > qp->ub[j] ? qp->ub[j] : wanted;
  for (int k = 0; k < search->count; k++)
    search->excess[k] += qp->A[search->slot[k] * PG_N + j] * (moved - search->x[j]);
  search->x[j] = moved;
}

/* The least of (1-t)(Ax - ubA)_i + t (Ax - ubA)_k for x within the bounds, and how it changes with t. */
typedef struct {
  double t, value, slope;
} mixture_t;

static mixture_t mix(const pg_qp_t *qp, int i, int k, double t) {
  const double *first = &qp->A[i * PG_N], *second = &qp->A[k * PG_N];
  mixture_t mixture = {t, -(1.0 - t) * qp->ubA[i] - t * qp->ubA[k], qp->ubA[i] - qp->ubA[k]};
  for (int j = 0; j < PG_N; j++) {
    const double a = (1.0 - t) * first[j] + t * second[j];
    const double x = a > 0.0 ? qp->lb[j] : qp->ub[j];
    mixture.value += a * x;
    mixture.slope += (second[j] - first[j]) * x;
  }
  return mixture;
}

/* 1 if two rows contradict each other: a mixture of them proves it. The least is concave and piecewise linear
 * in t, with a bend for each joint at most, so that tangents from both sides meet at its greatest value after
 * a few steps. */
static int rows_contradict(const pg_qp_t *qp, int i, int k) {
  mixture_t low = mix(qp, i, k, 0.0), high = mix(qp, i, k, 1.0);
  for (int step = 0; step <= PG_N; step++) {
    if (!(low.slope > 0.0 && high.slope < 0.0)) return 0;
    const double t =
        (high.value - low.value + low.slope * low.t - high.slope * high.t) / (low.slope - high.slope);
    if (!(low.value + low.slope * (t - low.t) > PG_TOLERANCE)) return 0; /* no mixture proves anything */
    const mixture_t between = mix(qp, i, k, t);
    if (between.value > PG_TOLERANCE) {
      double y[PG_ROWS] = {0.0};
      y[i] = 1.0 - t;
      y[k] = t;
      return pg_proves_infeasible(qp, y);
    }
    *(between.slope > 0.0 ? &low : &high) = between;
  }
  return 0;
}

/* Most contradictions are between two rows: obstacles on both sides of a link. At least one is exceeded. */
static int any_rows_contradict(const pg_qp_t *qp, const search_t *search) {
  for (int k = 1; k < search->count; k++)
    for (int i = 0; i < k; i++)
      if ((search->excess[i] > 0.0 || search->excess[k] > 0.0) &&
          rows_contradict(qp, search->slot[i], search->slot[k]))
        return 1;
  return 0;
}

/* Where 1/2 ||max(0, Ax - ubA)||^2 is least within the bounds, max(0, Ax - ubA) itself is a proof; near
 * enough to there it is one already. Coordinate descent comes near in most infeasible cycles at a fraction of
 * a solve, and ends at once where x = 0 meets all rows. Where it does not come near enough, pairs of rows are
 * tried. */
pg_verdict_t pg_search(const pg_qp_t *qp, int sweeps) {
  search_t search;
  begin(qp, &search);
  for (int sweep = 0; sweep <= sweeps; sweep++) {
    double y[PG_ROWS] = {0.0};
    int exceeded = 0;
    for (int k = 0; k < search.count; k++)
      if (search.excess[k] > 0.0) {
        y[search.slot[k]] = search.excess[k];
        exceeded = 1;
      }
    if (!exceeded) return PG_FEASIBLE;
    if (pg_proves_infeasible(qp, y)) return PG_CONTRADICTORY;
    for (int j = 0; j < PG_N; j++)
      descend(qp, &search, j);
  }
  return any_rows_contradict(qp, &search) ? PG_CONTRADICTORY : PG_UNDECIDED;
}
