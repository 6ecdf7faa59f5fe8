/* Solvers that fail or lie, by the hook that only builds with PG_FAULT_INJECTION have: the certificate sees
 * it, the second chance or the next stage helps, and what is left is a stop. */
#include "rig.h"

#ifndef PG_FAULT_INJECTION
#error "this test needs the hook"
#endif

/* What the solver's answers are turned into, and of how many attempts from now on. */
static void (*falsify)(pg_outcome_t *outcome, pg_solution_t *solution);
static int attempts_to_falsify;

void pg_test_hook(pg_start_t start, pg_outcome_t *outcome, pg_solution_t *solution) {
  (void)start;
  if (falsify && attempts_to_falsify-- > 0) falsify(outcome, solution);
}

static void fails(pg_outcome_t *outcome, pg_solution_t *solution) {
  (void)solution;
  *outcome = PG_UNSOLVED;
}

static void claims_infeasible(pg_outcome_t *outcome, pg_solution_t *solution) {
  memset(solution->y, 0, sizeof solution->y);
  *outcome = PG_INFEASIBLE;
}

static void claims_infeasible_with_a_false_proof(pg_outcome_t *outcome, pg_solution_t *solution) {
  for (int i = 0; i < PG_ROWS; i++)
    solution->y[i] = 1.0;
  *outcome = PG_INFEASIBLE;
}

static void gives_nan(pg_outcome_t *outcome, pg_solution_t *solution) {
  *outcome = PG_OPTIMAL;
  solution->x[PG_N - 1] = NAN;
}

static void gives_infinity(pg_outcome_t *outcome, pg_solution_t *solution) {
  *outcome = PG_OPTIMAL;
  solution->y[0] = INFINITY;
}

/* A corner of the bounds, with multipliers beyond what polishing could make good. */
static void gives_another_x(pg_outcome_t *outcome, pg_solution_t *solution) {
  *outcome = PG_OPTIMAL;
  for (int j = 0; j < PG_N; j++)
    solution->x[j] = 1e3;
  for (int i = 0; i < PG_ROWS; i++)
    solution->y[i] = 1e30;
}

static void (*const lies[])(pg_outcome_t *, pg_solution_t *) = {
    fails,     claims_infeasible, claims_infeasible_with_a_false_proof,
    gives_nan, gives_infinity,    gives_another_x};
enum { LIES = sizeof lies / sizeof lies[0] };

static void open_with_obstacle(rig_t *rig, double distance) {
  rig_open(rig);
  rig_see(rig, 0.25, distance);
  rig->xdot[1] = 0.25;
  CHECK_EQUAL(rig_step(rig), PG_SOLVED);
}

static void a_lie_is_followed_by_the_truth(void) {
  for (int lie = 0; lie < LIES; lie++) {
    rig_t rig, honest;
    open_with_obstacle(&rig, 0.28);
    open_with_obstacle(&honest, 0.28);
    falsify = NULL;
    CHECK_EQUAL(rig_step(&honest), PG_SOLVED);
    falsify = lies[lie];
    attempts_to_falsify = 1;
    CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
    CHECK_EQUAL(rig.cycle->solves, 2);
    CHECK_EQUAL(rig.cycle->second_chances, 1);
    for (int j = 0; j < PG_N; j++)
      CHECK_NEAR(rig.qdot[j], honest.qdot[j], 1e-9);
    pg_counters_t counters;
    pg_counters(rig.controller, &counters);
    CHECK_EQUAL(counters.second_chances, 1);
    CHECK_EQUAL(counters.certificate_failures,
                lies[lie] == gives_nan || lies[lie] == gives_infinity || lies[lie] == gives_another_x);
    rig_close(&rig);
    rig_close(&honest);
  }
}

enum { ATTEMPTS = 5 };

/* However many attempts fail, the next one is made, and its answer counts. */
static void the_last_attempt_counts(void) {
  for (int lie = 0; lie < LIES; lie++)
    for (int attempts = 1; attempts < ATTEMPTS; attempts++) {
      rig_t rig;
      open_with_obstacle(&rig, 0.28);
      falsify = lies[lie];
      attempts_to_falsify = attempts;
      CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
      CHECK_EQUAL(rig.cycle->solves, attempts + 1);
      rig_close(&rig);
    }
}

/* All attempts of stage 0 fail: stage 1 is tried, and solved. */
static void a_lie_in_each_attempt_costs_a_stage(void) {
  for (int lie = 0; lie < LIES; lie++) {
    rig_t rig;
    open_with_obstacle(&rig, 0.28);
    falsify = lies[lie];
    attempts_to_falsify = ATTEMPTS;
    CHECK_EQUAL(rig_step(&rig), PG_ACTIVE_ROW ? PG_REDUCED_ACTIVE : PG_REDUCED_DISTANT);
    CHECK_EQUAL(rig.cycle->solves, ATTEMPTS + 1);
    CHECK_EQUAL(rig.cycle->second_chances, 1);
    rig_close(&rig);
  }
}

/* A solver that never answers, or never truly: a stop, within bounded work, and the truth is
 * welcome again. */
static void nothing_but_lies(void) {
  for (int lie = 0; lie < LIES; lie++) {
    rig_t rig;
    rig_open(&rig);
    const double velocity[PG_N] = {0.3, -0.7};
    falsify = NULL;
    rig_speed_up(&rig, velocity);
    rig_see(&rig, 0.25, 0.28);
    rig_see(&rig, 0.75, 0.15);
    falsify = lies[lie];
    attempts_to_falsify = 1000;
    for (int i = 0; i < 4; i++) {
      CHECK_EQUAL(rig_step(&rig), PG_STOPPED_SOLVER);
      CHECK(rig.cycle->solves <= 5 * ATTEMPTS);
      CHECK(isnan(rig.cycle->kkt_residual));
    }
    CHECK(rig.qdot[0] == 0.0 && rig.qdot[1] == 0.0);
    falsify = NULL;
    CHECK(rig_step(&rig) <= PG_REDUCED_REPULSION);
    rig_close(&rig);
  }
}

/* A solver whose numbers are a little off: they are polished, and the cycle needs no second solve. */
static void shake(pg_outcome_t *outcome, pg_solution_t *solution) {
  (void)outcome;
  for (int j = 0; j < PG_N; j++)
    solution->x[j] += 1e-7;
}

static void small_errors_are_polished_away(void) {
  rig_t rig;
  open_with_obstacle(&rig, 0.28);
  falsify = shake;
  attempts_to_falsify = 1;
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK_EQUAL(rig.cycle->solves, 1);
  CHECK(rig.cycle->kkt_residual <= 1e-14);
  rig_close(&rig);
}

int main(void) {
  a_lie_is_followed_by_the_truth();
  the_last_attempt_counts();
  a_lie_in_each_attempt_costs_a_stage();
  nothing_but_lies();
  falsify = NULL;
  small_errors_are_polished_away();
  return checks_failed > 0;
}
