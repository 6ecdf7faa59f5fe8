/* What the controller asks of a QP solver. One of solver_<backend>.{c,cpp} is compiled behind it.
 *
 *     min 1/2 x'Hx + g'x   subject to   lb <= x <= ub,   A x - softness*y <= ubA
 *
 * H is symmetric and positive definite. y >= 0 are the multipliers of the rows; softness is 0 for a hard row
 * and 1/rho for one that may be exceeded by s at the cost of 1/2 rho s^2 (then s = y/rho). A row with ubA =
 * PG_OFF is off.
 *
 * Every answer is checked by certificate.c; a solver may be wrong, but has to come to an end, and be finite
 * in its work: at most PG_MAX_ITERATIONS working-set changes. */
#ifndef PROXGEN_SOLVER_H
#define PROXGEN_SOLVER_H

#include "robot.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
  const double *H;        /* [N][N] */
  const double *g;        /* [N] */
  const double *A;        /* [ROWS][N]; no row is ever zero */
  const double *lb;       /* [N] */
  const double *ub;       /* [N] */
  const double *ubA;      /* [ROWS] */
  const double *softness; /* [ROWS] */
} pg_qp_t;

typedef enum {
  PG_OPTIMAL,    /* x and y are the solution */
  PG_INFEASIBLE, /* no x meets all rows; y >= 0 weighs rows that contradict each other, or is zero */
  PG_UNSOLVED    /* anything else */
} pg_outcome_t;

typedef enum {
  PG_FIRST, /* the way that is fastest from cycle to cycle */
  PG_AGAIN, /* another way, after a first answer that did not pass */
  PG_SHARP  /* likewise, with tolerances near rounding: may fail more often, but not halt at a near miss */
} pg_start_t;

typedef struct {
  double x[PG_N];
  double y[PG_ROWS];
  int iterations; /* working-set changes */
} pg_solution_t;

typedef struct pg_solver pg_solver_t;

extern const char pg_solver_name[];

/* Sets up a solver in `memory`, PG_SOLVER_MEMORY bytes, aligned to 16. */
pg_status_t pg_solver_create(void *memory, pg_solver_t **solver);
void pg_solver_destroy(pg_solver_t *solver);

/* Forgets everything about earlier QPs. */
void pg_solver_reset(pg_solver_t *solver);

/* Takes over the QP of a new cycle: everything but ubA, which may have rows switched off or raised from solve
 * to solve. A row that is off here stays off until the next load. The QP has to outlive the solves. */
void pg_solver_load(pg_solver_t *solver, const pg_qp_t *qp);

/* 1 if loading has brought the solution to light, so that the first solve is certain to find it. */
int pg_solver_is_at_hand(const pg_solver_t *solver, const pg_qp_t *qp);

/* Solves the loaded QP with the ubA that it has now. After PG_AGAIN and PG_SHARP it has to be loaded anew. */
pg_outcome_t pg_solver_solve(pg_solver_t *solver, const pg_qp_t *qp, pg_start_t start,
                             pg_solution_t *solution);

#ifdef PG_FAULT_INJECTION
/* In tests only: called after each solve, and may falsify the answer. */
void pg_test_hook(pg_start_t start, pg_outcome_t *outcome, pg_solution_t *solution);
#endif

#ifdef __cplusplus
}
#endif
#endif
