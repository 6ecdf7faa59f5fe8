/* Small dense linear algebra with sizes that the compiler knows: rows, the factor of H, and what follows from
 * it. */
#ifndef PROXGEN_TRIANGULAR_H
#define PROXGEN_TRIANGULAR_H

#include "robot.h"

#include <math.h>

/* H is not factorised beyond this; its eigenvalues are at least the floor of lambda, 1e-6. */
#define PG_LEAST_PIVOT 1e-15

static inline double pg_row_times(const double *row, const double x[PG_N]) {
  double sum = 0.0;
  for (int j = 0; j < PG_N; j++)
    sum += row[j] * x[j];
  return sum;
}

/* H = U'DU with U upper triangular and 1 on its diagonal, where 1/D is kept; 0 if H is not safely positive
 * definite. Roots, for which all that follows would have to wait, are left to pg_invert. */
static inline int pg_factorise(const double *H, double U[PG_N][PG_N]) {
  double DU[PG_N][PG_N];
  for (int i = 0; i < PG_N; i++) {
    double pivot = H[i * PG_N + i];
    for (int k = 0; k < i; k++)
      pivot -= U[k][i] * DU[k][i];
    if (!(pivot > PG_LEAST_PIVOT && pivot < PG_OFF)) return 0;
    U[i][i] = 1.0 / pivot;
    for (int j = i + 1; j < PG_N; j++) {
      double sum = H[i * PG_N + j];
      for (int k = 0; k < i; k++)
        sum -= U[k][i] * DU[k][j];
      DU[i][j] = sum;
      U[i][j] = sum * U[i][i];
    }
  }
  return 1;
}

/* w = U^-T a. */
static inline void pg_solve_transposed(double U[PG_N][PG_N], const double *a, double w[PG_N]) {
  for (int j = 0; j < PG_N; j++) {
    w[j] = a[j];
    for (int k = 0; k < j; k++)
      w[j] -= U[k][j] * w[k];
  }
}

/* x = -(DU)^-1 w. */
static inline void pg_solve_negated(double U[PG_N][PG_N], const double w[PG_N], double x[PG_N]) {
  for (int i = PG_N - 1; i >= 0; i--) {
    x[i] = -w[i] * U[i][i];
    for (int k = i + 1; k < PG_N; k++)
      x[i] -= U[i][k] * x[k];
  }
}

/* Replaces U by R^-1, where R = D^1/2 U and H = R'R; from the last column on, because each needs those before
 * it as they were. */
static inline void pg_invert(double U[PG_N][PG_N]) {
  for (int j = PG_N - 1; j >= 0; j--) {
    U[j][j] = sqrt(U[j][j]);
    for (int i = j - 1; i >= 0; i--) {
      double sum = 0.0;
      for (int k = i + 1; k <= j; k++)
        sum -= U[i][k] * U[k][j];
      U[i][j] = sum;
    }
  }
}

/* Scales `count` entries to unit length; returns the factor. */
static inline double pg_normalise(double *row, int count) {
  double squared = 0.0;
  for (int j = 0; j < count; j++)
    squared += row[j] * row[j];
  const double factor = 1.0 / sqrt(squared);
  for (int j = 0; j < count; j++)
    row[j] *= factor;
  return factor;
}

#endif
