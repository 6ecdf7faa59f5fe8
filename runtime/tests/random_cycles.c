/* Random cycles of any robot: what must always hold is checked in each.
 *
 *     random_cycles CYCLES SEED [--plain | --extreme] [--record FILE] [--follow FILE] [--problems FILE --at
 * FILE]
 *
 * States within and beyond the limits, obstacles from touching to far, 1 % corrupted inputs; parameters
 * within a factor of ten of the default ones (--plain: those themselves; --extreme: also any that is
 * accepted).
 * --record writes status and q_dot of every cycle; --follow starts each cycle from the velocity that another
 * run recorded, so that two solvers can be compared cycle by cycle. --problems writes parameters, distances
 * and QPs of the cycles that are listed in a text file, in increasing order, for somebody else to judge. */
#include "../bench/count_heap.h"
#include "check.h"
#include "geometry.h"
#include "state.h"

#include <stdlib.h>
#include <string.h>

enum {
  CYCLES_PER_STATE = 50,
  CYCLES_PER_PARAMETERS = 200,
  PARAMETERS = sizeof(pg_parameters_t) / sizeof(double)
};

typedef struct {
  double q[PG_N], xdot[PG_M], ranges[PG_TOF + 1], ages[PG_TOF + 1], switch_ages[PG_CAPACITIVE + 1];
  unsigned char switches[PG_CAPACITIVE + 1];
  double points[3 * PG_MAX_POINTS + 1];
  pg_measurement_t seen;
} input_t;

static int chance(random_t *random, double probability) {
  return between(random, 0.0, 1.0) < probability;
}

static int below(random_t *random, int count) {
  return (int)between(random, 0.0, (double)count);
}

static double magnitude(random_t *random, double low, double high) {
  return pow(10.0, between(random, low, high));
}

/* The default, or near it, or, if extreme, anything that is accepted. */
static double draw_parameter(random_t *random, double usual, double lower, double upper, int extreme) {
  double value = usual;
  if (chance(random, 0.3)) value = (usual == 0.0 ? 1e-2 : usual) * magnitude(random, -1.0, 1.0);
  if (extreme && chance(random, 0.05))
    value = magnitude(random, -12.0, 20.0) * (chance(random, 0.5) ? 1.0 : -1.0);
  return value < lower ? lower : value > upper ? upper : value;
}

static void swap_if(int wrong, double *a, double *b) {
  const double kept = *a;
  if (!wrong) return;
  *a = *b;
  *b = kept;
}

static void put_in_order(double *values[4]) {
  for (int i = 0; i < 4; i++)
    for (int k = 0; k < 3; k++)
      swap_if(*values[k] > *values[k + 1], values[k], values[k + 1]);
}

static void draw_parameters(random_t *random, pg_controller_t *controller, int extreme) {
  pg_parameters_t p = pg_model_default_parameters;
  double *value = (double *)&p;
  for (int i = 0; i < PARAMETERS; i++)
    value[i] = draw_parameter(random, value[i], ((const double *)&pg_model_lower_parameters)[i],
                              ((const double *)&pg_model_upper_parameters)[i], extreme);
  p.viability = p.viability > 0.5 ? 1.0 : 0.0;
  for (int j = 0; j < PG_N; j++)
    swap_if(p.q_lower[j] > p.q_upper[j], &p.q_lower[j], &p.q_upper[j]);
  double *thresholds[] = {&p.d_r, &p.d_0l, &p.d_0u, &p.d_a};
  put_in_order(thresholds);
#if PG_SELF_POINTS
  double *own[] = {&p.self_d_r, &p.self_d_0l, &p.self_d_0u, &p.self_d_a};
  put_in_order(own);
#endif
  swap_if(p.damper_safety > p.damper_influence, &p.damper_safety, &p.damper_influence);
  pg_set_parameters(controller, &p); /* refused if two are equal: then the last ones stay */
}

static void draw_state(random_t *random, const pg_parameters_t *p, input_t *input) {
  for (int j = 0; j < PG_N; j++) {
    const double low = fmax(p->q_lower[j], -10.0), high = fmin(p->q_upper[j], 10.0),
                 margin = 0.01 * (high - low);
    input->q[j] = between(random, low - margin, high + margin);
  }
}

/* A point at some distance from a place on the arm. */
static void draw_point(random_t *random, const pg_kinematics_t *kinematics, double point[3]) {
  const pg_capsule_t *capsule = &pg_model_capsules[below(random, PG_CAPSULES)];
  const double t = between(random, -0.1, 1.1),
               distance = magnitude(random, chance(random, 0.001) ? -8.0 : -2.0, 0.5);
  double place[3], away[3];
  for (int i = 0; i < 3; i++) {
    place[i] = capsule->start[i] + t * (capsule->end[i] - capsule->start[i]);
    away[i] = between(random, -1.0, 1.0);
  }
  pg_transform(kinematics->body_to_world[capsule->body], place, point);
  for (int i = 0; i < 3; i++)
    point[i] += distance * away[i] / (sqrt(pg_dot(away, away)) + 1e-12);
}

static void draw_input(random_t *random, const pg_parameters_t *p, input_t *input) {
  pg_kinematics_t kinematics;
  const double few = magnitude(random, -2.0, 0.0); /* how many sensors see something: from few to all */
  for (int j = 0; j < PG_N; j++)
    input->q[j] += between(random, -0.02, 0.02);
  pg_model_kinematics(input->q, &kinematics);
  for (int i = 0; i < PG_M; i++)
    input->xdot[i] = between(random, -0.5, 0.5);
  for (int i = 0; i < PG_TOF; i++) {
    input->ranges[i] = pg_model_tof[i].range * (chance(random, few) ? between(random, 0.0, 1.0) : 1.0);
    input->ages[i] = fmin(p->sensor_timeout, 1.0) * between(random, 0.0, 1.0);
  }
  for (int i = 0; i < PG_CAPACITIVE; i++) {
    input->switches[i] = chance(random, 0.3 * few) ? 1 : 0;
    input->switch_ages[i] = fmin(p->sensor_timeout, 1.0) * between(random, 0.0, 1.0);
  }
  input->seen.tof_age = chance(random, 0.5) ? input->ages : NULL;
  input->seen.capacitive_age = chance(random, 0.5) ? input->switch_ages : NULL;
  input->seen.point_count =
      chance(random, 0.5) ? below(random, (PG_MAX_POINTS < 64 ? PG_MAX_POINTS : 64) + 1) : 0;
  for (int i = 0; i < input->seen.point_count; i++)
    draw_point(random, &kinematics, &input->points[3 * i]);
  input->seen.time += fmin(p->period, 1.0);
}

/* Spoils one value; all of them are drawn anew in the next cycle, but for q and the time. */
static void corrupt(random_t *random, input_t *input) {
  const double wrong[] = {NAN, INFINITY, -INFINITY, -1.0, -1e-9, 1e300};
  double *places[] = {&input->q[below(random, PG_N)],
                      &input->xdot[below(random, PG_M)],
                      &input->ranges[below(random, PG_TOF)],
                      &input->ages[below(random, PG_TOF)],
                      &input->switch_ages[0],
                      &input->points[0],
                      &input->seen.time};
  const int place = below(random, 7), largest = place == 1; /* a task velocity of 1e300 has no exact answer */
  *places[place] = wrong[below(random, largest ? 5 : 6)];
}

/* What must hold after every cycle. */
static void check_cycle(const pg_controller_t *controller, pg_status_t status, const double qdot[PG_N]) {
  const pg_diagnostics_t *cycle = &controller->cycle;
  CHECK(status >= PG_SOLVED && status <= PG_FAULT_OBSTACLE_INSIDE);
  for (int j = 0; j < PG_N; j++) {
    CHECK(isfinite(qdot[j]) && qdot[j] >= cycle->lb[j] && qdot[j] <= cycle->ub[j]);
    CHECK(fabs(qdot[j]) <= controller->parameters.qdot_limit[j]);
  }
  if (status < PG_STOPPED_INFEASIBLE) { /* what leaves is what was certified, of several answers too */
    const pg_qp_t stage = pg_stage_of(controller);
    CHECK(cycle->kkt_residual <= PG_TOLERANCE && cycle->solves > 0);
    CHECK(pg_kkt_residual(&stage, &controller->solution) == cycle->kkt_residual);
    CHECK(memcmp(qdot, controller->solution.x, PG_N * sizeof(double)) == 0);
  }
  CHECK(cycle->solves <= 25 && cycle->iterations <= 5 * (1 + 4 * 4) * PG_MAX_ITERATIONS);
  for (int slot = 0; slot < PG_ROWS; slot++) {
    double squared = 0.0;
    for (int j = 0; j < PG_N; j++)
      squared += cycle->A[slot * PG_N + j] * cycle->A[slot * PG_N + j];
    CHECK(squared >= 1e-12 * (1.0 - 1e-9));
  }
}

/* What decides a cycle, as doubles: parameters, row_on, distance, self_distance, ubA, lb, ub, A, H, g. */
static void write_problem(const pg_controller_t *controller, FILE *file) {
  const pg_diagnostics_t *cycle = &controller->cycle;
  double on[PG_ROWS];
  for (int slot = 0; slot < PG_ROWS; slot++)
    on[slot] = (double)cycle->row_on[slot];
  fwrite(&controller->parameters, sizeof controller->parameters, 1, file);
  fwrite(on, sizeof on, 1, file);
  fwrite(cycle->distance, sizeof cycle->distance, 1, file);
#if PG_SELF_POINTS
  fwrite(cycle->self_distance, sizeof cycle->self_distance, 1, file);
#endif
  fwrite(cycle->ubA, sizeof cycle->ubA, 1, file);
  fwrite(cycle->lb, sizeof cycle->lb, 1, file);
  fwrite(cycle->ub, sizeof cycle->ub, 1, file);
  fwrite(cycle->A, sizeof cycle->A, 1, file);
  fwrite(cycle->H, sizeof cycle->H, 1, file);
  fwrite(cycle->g, sizeof cycle->g, 1, file);
}

/* The next number of a list; -1 at its end, or without a list. */
static long next_listed(FILE *list) {
  long number;
  return list && fscanf(list, "%ld", &number) == 1 ? number : -1;
}

static void print_summary(const pg_controller_t *controller, double worst, unsigned long long heap) {
  const pg_counters_t *counters = &controller->counters;
  unsigned long long sum = 0;
  printf("%s: %llu cycles, greatest residual %.1e, %llu solves, %llu second chances, %llu not certified, "
         "at most %d changes in a cycle\n",
         pg_solver_name, counters->cycles, worst, counters->solves, counters->second_chances,
         counters->certificate_failures, counters->max_iterations_in_cycle);
  for (int s = 0; s < 32; s++) {
    sum += counters->status_count[s];
    if (counters->status_count[s])
      printf("  %s %llu\n", pg_status_name((pg_status_t)s), counters->status_count[s]);
  }
  CHECK(sum == counters->cycles);
  if (HEAP_IS_COUNTED) printf("  heap: %llu calls\n", heap);
}

int main(int argc, char **argv) {
  const long cycles = argc > 1 ? atol(argv[1]) : 100000;
  random_t random = {argc > 2 ? (unsigned long long)atol(argv[2]) + 88172645463325252ull : 1};
  FILE *record = NULL, *follow = NULL, *problems = NULL, *list = NULL;
  int plain = 0, extreme = 0, at_rest = 1;
  for (int i = 3; i < argc; i++) {
    plain |= strcmp(argv[i], "--plain") == 0;
    extreme |= strcmp(argv[i], "--extreme") == 0;
    if (i + 1 < argc && strcmp(argv[i], "--record") == 0) record = fopen(argv[i + 1], "wb");
    if (i + 1 < argc && strcmp(argv[i], "--follow") == 0) follow = fopen(argv[i + 1], "rb");
    if (i + 1 < argc && strcmp(argv[i], "--problems") == 0) problems = fopen(argv[i + 1], "wb");
    if (i + 1 < argc && strcmp(argv[i], "--at") == 0) list = fopen(argv[i + 1], "r");
  }
  pg_controller_t *controller;
  if (pg_create_checked(&controller, PG_INTERFACE) != PG_SOLVED) return 2;

  static input_t input;
  double worst = 0.0, entry[2 + PG_N] = {0.0};
  unsigned long long heap = 0;
  long listed = next_listed(list);
  for (long i = 0; i < cycles && checks_failed < 20; i++) {
    if (i % CYCLES_PER_PARAMETERS == 0 && !plain) draw_parameters(&random, controller, extreme);
    if (i % CYCLES_PER_STATE == 0) draw_state(&random, &controller->parameters, &input);
    draw_input(&random, &controller->parameters, &input);
    input.seen.tof_range = input.ranges;
    input.seen.capacitive = input.switches;
    input.seen.points = input.points;
    input_t sent = input;
    if (sent.seen.tof_age) sent.seen.tof_age = sent.ages;
    sent.seen.tof_range = sent.ranges;
    if (sent.seen.capacitive_age) sent.seen.capacitive_age = sent.switch_ages;
    sent.seen.points = sent.points;
    if (chance(&random, 0.01)) corrupt(&random, &sent);
    if (follow && !at_rest) memcpy(controller->qdot_previous, &entry[2], PG_N * sizeof(double));

    double qdot[PG_N];
    const unsigned long long before = heap_calls();
    const pg_status_t status = pg_step(controller, sent.q, sent.xdot, &sent.seen, qdot);
    heap += heap_calls() - before;
    check_cycle(controller, status, qdot);
    if (isfinite(controller->cycle.kkt_residual)) worst = fmax(worst, controller->cycle.kkt_residual);
    at_rest = controller->time_previous > 1e200; /* a corrupted time was later than any other */
    if (at_rest) pg_reset(controller);
    const double own[2] = {(double)status, controller->cycle.kkt_residual};
    if (record) {
      fwrite(own, sizeof own, 1, record);
      fwrite(qdot, sizeof qdot, 1, record);
    }
    if (i == listed && problems) write_problem(controller, problems);
    if (i == listed) listed = next_listed(list);
    if (follow) CHECK(fread(entry, sizeof entry, 1, follow) == 1);
  }
  print_summary(controller, worst, heap);
  pg_destroy(controller);
  if (record) fclose(record);
  if (follow) fclose(follow);
  if (problems) fclose(problems);
  if (list) fclose(list);
  return checks_failed > 0;
}
