/* Small dense linear algebra with sizes that the compiler knows: rows, the factor of H, and what follows from
 * it. */
#ifndef PROXGEN_TRIANGULAR_H
#define PROXGEN_TRIANGULAR_H

#include "robot.h"

#include <math.h>

/* H is not factorised beyond this; its eigenvalues are at least the floor of lambda, 1e-9. */
#define PG_LEAST_PIVOT 1e-15

static inline double pg_row_times(const double *row, const double x[PG_N]) {
  double sum = 0.0;
  for (int j = 0; j < PG_N; j++)
    sum += row[j] * x[j];
  return sum;
}

/* H = R'R with R upper triangular, its diagonal as reciprocals; 0 if H is not safely positive definite. */
static inline int pg_factorise(const double *H, double R[PG_N][PG_N]) {
  for (int i = 0; i < PG_N; i++) {
    double pivot = H[i * PG_N + i];
    for (int k = 0; k < i; k++)
      pivot -= R[k][i] * R[k][i];
    if (!(pivot > PG_LEAST_PIVOT && pivot < PG_OFF)) return 0;
    R[i][i] = 1.0 / sqrt(pivot);
    for (int j = i + 1; j < PG_N; j++) {
      double sum = H[i * PG_N + j];
      for (int k = 0; k < i; k++)
        sum -= R[k][i] * R[k][j];
      R[i][j] = sum * R[i][i];
    }
  }
  return 1;
}

/* m = R^-T a. */
static inline void pg_solve_transposed(double R[PG_N][PG_N], const double *a, double m[PG_N]) {
  for (int j = 0; j < PG_N; j++) {
    double sum = a[j];
    for (int k = 0; k < j; k++)
      sum -= R[k][j] * m[k];
    m[j] = sum * R[j][j];
  }
}

/* x = -R^-1 v. */
static inline void pg_solve_negated(double R[PG_N][PG_N], const double v[PG_N], double x[PG_N]) {
  for (int i = PG_N - 1; i >= 0; i--) {
    double sum = -v[i];
    for (int k = i + 1; k < PG_N; k++)
      sum -= R[i][k] * x[k];
    x[i] = sum * R[i][i];
  }
}

/* Replaces R by its inverse; from the last column on, because each needs those before it as they were. */
static inline void pg_invert(double R[PG_N][PG_N]) {
  for (int j = PG_N - 1; j > 0; j--)
    for (int i = j - 1; i >= 0; i--) {
      double sum = 0.0;
      for (int k = i + 1; k <= j; k++)
        sum -= R[i][k] * R[k][j];
      R[i][j] = sum * R[i][i];
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
