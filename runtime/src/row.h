/* What is done with one row of A, whoever writes it.
 *
 * Every row has its slot for good. A row that is off keeps its last direction and gets ubA = PG_OFF: a row
 * set to zero, or rows packed anew in each cycle, let a hot start report success for a wrong solution. */
#ifndef PROXGEN_ROW_H
#define PROXGEN_ROW_H

#include "state.h"

#include <math.h>
#include <string.h>

/* A shorter row moves nothing that joints could move. */
#define PG_LEAST_ROW 1e-6

static inline double pg_row_norm(const double row[PG_N]) {
  double sum = 0.0;
  for (int j = 0; j < PG_N; j++)
    sum += row[j] * row[j];
  return sqrt(sum);
}

static inline void pg_switch_on(pg_diagnostics_t *cycle, int slot, const double row[PG_N], double ubA) {
  memcpy(&cycle->A[slot * PG_N], row, PG_N * sizeof(double));
  cycle->ubA[slot] = ubA;
  cycle->row_on[slot] = 1;
}

static inline void pg_switch_all_off(pg_diagnostics_t *cycle) {
  for (int slot = 0; slot < PG_ROWS; slot++) {
    cycle->ubA[slot] = PG_OFF;
    cycle->row_on[slot] = 0;
  }
}

/* What a row asks for at `speed`, but never for more joint speed than the parameter row_speed. */
static inline double pg_row_bound(const pg_parameters_t *p, double speed, double norm) {
  const double slowest = -p->row_speed * norm;
  return speed > slowest ? speed : slowest;
}

#endif
