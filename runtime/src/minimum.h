/* The minimum of the objective where no constraint, or a single one, holds it back: four cycles in five need
 * no more, and with a factor of H at hand it costs next to nothing.
 *
 *     H = U'DU,   w = U^-T g,   x = -(DU)^-1 w
 *
 * If that breaks a constraint a'x <= b by e, then the minimum on it is -(DU)^-1 (w + y m) with m = U^-T a and
 * y = e / m'D^-1 m; and that is the minimum of all, if it breaks no other constraint. */
#ifndef PROXGEN_MINIMUM_H
#define PROXGEN_MINIMUM_H

#include "solver.h"
#include "triangular.h"

enum { PG_NOTHING_HELD = -1 };

typedef struct {
  double x[PG_N];
  int held;          /* j for a bound of joint j, N + i for row i, or PG_NOTHING_HELD */
  double multiplier; /* of the row that is held; 0 if none is */
} pg_minimum_t;

/* The constraint that x breaks most, as distances go where H is the unit matrix. */
typedef struct {
  int side;      /* as `held` */
  double excess; /* a'x - b; below 0 at a lower bound */
  double m[PG_N];
  double squared_length; /* m'D^-1 m */
} pg_broken_t;

/* A constraint that is broken takes the place of another that is broken less. */
static inline void pg_offer_broken(double U[PG_N][PG_N], int side, const double *normal, double excess,
                                   pg_broken_t *most) {
  pg_broken_t broken = {.side = side, .excess = excess};
  pg_solve_transposed(U, normal, broken.m);
  broken.squared_length = 0.0;
  for (int j = 0; j < PG_N; j++)
    broken.squared_length += broken.m[j] * broken.m[j] * U[j][j];
  if (most->side == PG_NOTHING_HELD ||
      excess * excess * most->squared_length > most->excess * most->excess * broken.squared_length)
    *most = broken;
}

/* Looks through all constraints; returns how many are broken, or not a number. */
static inline int pg_find_broken(double U[PG_N][PG_N], const pg_qp_t *qp, const double x[PG_N],
                                 pg_broken_t *most) {
  int count = 0;
  most->side = PG_NOTHING_HELD;
  for (int j = 0; j < PG_N; j++) {
    if (x[j] >= qp->lb[j] && x[j] <= qp->ub[j]) continue;
    double unit[PG_N] = {0.0};
    unit[j] = 1.0;
    pg_offer_broken(U, j, unit, x[j] - (x[j] < qp->lb[j] ? qp->lb[j] : qp->ub[j]), most);
    count++;
  }
  for (int i = 0; i < PG_ROWS; i++) {
    if (qp->ubA[i] >= PG_OFF) continue;
    const double excess = pg_row_times(&qp->A[i * PG_N], x) - qp->ubA[i];
    if (excess <= 0.0) continue;
    pg_offer_broken(U, PG_N + i, &qp->A[i * PG_N], excess, most);
    count++;
  }
  return count;
}

/* 1 if all constraints but `held` are met. */
static inline int pg_others_met(const pg_qp_t *qp, const double x[PG_N], int held) {
  for (int j = 0; j < PG_N; j++)
    if (!(x[j] >= qp->lb[j] && x[j] <= qp->ub[j])) return 0;
  for (int i = 0; i < PG_ROWS; i++)
    if (qp->ubA[i] < PG_OFF && PG_N + i != held && !(pg_row_times(&qp->A[i * PG_N], x) <= qp->ubA[i]))
      return 0;
  return 1;
}

/* The minimum on the constraint that the free one breaks most: x = -(DU)^-1 (w + y m), which keeps more
 * digits than a step from the free one, if that is far away. */
static inline void pg_hold(double U[PG_N][PG_N], const double w[PG_N], const pg_qp_t *qp,
                           const pg_broken_t *broken, pg_minimum_t *minimum) {
  const int side = broken->side, is_row = side >= PG_N;
  const double softness = is_row ? qp->softness[side - PG_N] : 0.0;
  const double y = broken->excess / (broken->squared_length + softness);
  double moved[PG_N];
  for (int j = 0; j < PG_N; j++)
    moved[j] = w[j] + y * broken->m[j];
  pg_solve_negated(U, moved, minimum->x);
  if (!is_row) minimum->x[side] = broken->excess < 0.0 ? qp->lb[side] : qp->ub[side];
  minimum->held = side;
  minimum->multiplier = is_row ? y : 0.0;
}

/* 1 if the minimum of the QP was found; 0 if it takes more than one constraint, or there is none. */
static inline int pg_find_minimum(double U[PG_N][PG_N], const double w[PG_N], const pg_qp_t *qp,
                                  pg_minimum_t *minimum) {
  pg_broken_t most;
  most.excess = most.squared_length = 0.0; /* for compilers, which warn */
  minimum->held = PG_NOTHING_HELD;
  minimum->multiplier = 0.0;
  pg_solve_negated(U, w, minimum->x);
  if (pg_find_broken(U, qp, minimum->x, &most) == 0) return 1;
  pg_hold(U, w, qp, &most, minimum);
  return pg_others_met(qp, minimum->x, minimum->held);
}

#endif
