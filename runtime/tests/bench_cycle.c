/* Times whole cycles and their parts, for the iiwa 7 (or any arm with its names) between two boxes.
 *
 *     bench_cycle [SECONDS of closed loop] [REPLAYS]
 *
 * First the controller drives a kinematic arm through the gap of docs/method.md, and its inputs are recorded.
 * Then they are replayed and timed one by one: raw times of all replays, and the best of each cycle over
 * them. */
#include "state.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct {
  double q[PG_N], xdot[PG_M], tof[PG_TOF + 1];
  unsigned char switches[PG_CAPACITIVE + 1];
} input_t;

typedef struct {
  double centre[3], half[3];
} box_t;

static const box_t boxes[] = {{{0.5, 0.0, 0.1}, {0.25, 0.05, 0.1}}, {{0.5, 0.0, 0.8}, {0.25, 0.05, 0.1}}};
enum { BOXES = sizeof boxes / sizeof boxes[0] };

#define TRIGGER 0.1 /* [m] of a switch */

static double seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double least(double a, double b) {
  return a < b ? a : b;
}

static double greatest(double a, double b) {
  return a > b ? a : b;
}

/* Distance along a ray to a box, or `range`. */
static double ray(const double origin[3], const double direction[3], const box_t *box, double range) {
  double enter = 0.0, leave = range;
  for (int i = 0; i < 3; i++) {
    const double step = fabs(direction[i]) > 1e-12 ? direction[i] : 1e-12;
    const double a = (box->centre[i] - box->half[i] - origin[i]) / step;
    const double b = (box->centre[i] + box->half[i] - origin[i]) / step;
    enter = greatest(enter, least(a, b));
    leave = least(leave, greatest(a, b));
  }
  return enter <= leave ? enter : range;
}

static double distance_to_box(const double point[3], const box_t *box) {
  double squared = 0.0;
  for (int i = 0; i < 3; i++) {
    const double d = greatest(fabs(point[i] - box->centre[i]) - box->half[i], 0.0);
    squared += d * d;
  }
  return sqrt(squared);
}

static void place_sensor(const pg_kinematics_t *k, const pg_sensor_t *sensor, double position[3],
                         double normal[3]) {
  const double *pose = k->body_to_world[sensor->body];
  for (int i = 0; i < 3; i++) {
    position[i] = pose[4 * i + 3];
    normal[i] = 0.0;
    for (int j = 0; j < 3; j++) {
      position[i] += pose[4 * i + j] * sensor->position[j];
      normal[i] += pose[4 * i + j] * sensor->normal[j];
    }
  }
}

static void sense(const pg_kinematics_t *k, input_t *input) {
  double position[3], normal[3];
  for (int s = 0; s < PG_TOF; s++) {
    place_sensor(k, &pg_model_tof[s], position, normal);
    input->tof[s] = pg_model_tof[s].range;
    for (int b = 0; b < BOXES; b++)
      input->tof[s] = least(input->tof[s], ray(position, normal, &boxes[b], pg_model_tof[s].range));
  }
  for (int s = 0; s < PG_CAPACITIVE; s++) {
    place_sensor(k, &pg_model_capacitive[s], position, normal);
    input->switches[s] = 0;
    for (int b = 0; b < BOXES; b++)
      input->switches[s] |= distance_to_box(position, &boxes[b]) < TRIGGER;
  }
}

static pg_status_t step(pg_controller_t *controller, const input_t *input, double time, double qdot[PG_N]) {
  const pg_measurement_t seen = {.time = time, .tof_range = input->tof, .capacitive = input->switches};
  return pg_step(controller, input->q, input->xdot, &seen, qdot);
}

/* Velocity to the target; returns the distance that is left. */
static double approach(const double tool[12], const double target[3], double xdot[PG_M]) {
  const double error[3] = {target[0] - tool[3], target[1] - tool[7], target[2] - tool[11]};
  const double norm = sqrt(error[0] * error[0] + error[1] * error[1] + error[2] * error[2]);
  memset(xdot, 0, PG_M * sizeof(double));
  for (int i = 0; i < 3 && i < PG_M; i++)
    xdot[i] = least(2.0 * norm, 0.25) * error[i] / greatest(norm, 1e-9);
  return norm;
}

static int record(pg_controller_t *controller, input_t *inputs, int cycles) {
  static const double targets[2][3] = {{0.5, -0.45, 0.45}, {0.5, 0.45, 0.45}};
  double q[PG_N] = {0.0}, qdot[PG_N];
  int reached = 0;
  pg_kinematics_t kinematics;
  pg_parameters_t parameters;
  pg_get_parameters(controller, &parameters);
  for (int i = 0; i < cycles; i++) {
    pg_model_kinematics(q, &kinematics);
    memcpy(inputs[i].q, q, sizeof q);
    sense(&kinematics, &inputs[i]);
    if (approach(kinematics.tool_to_world, targets[reached % 2], inputs[i].xdot) < 0.02) reached++;
    step(controller, &inputs[i], parameters.period * (i + 1), qdot);
    for (int j = 0; j < PG_N; j++)
      q[j] += parameters.period * qdot[j];
  }
  return reached;
}

static int by_size(const void *a, const void *b) {
  const double difference = *(const double *)a - *(const double *)b;
  return (difference > 0.0) - (difference < 0.0);
}

static void print_times(const char *name, double *times, int count) {
  qsort(times, (size_t)count, sizeof(double), by_size);
  const int last = count - 1;
  printf("%-22s p50 %7.2f  p90 %7.2f  p99 %7.2f  p99.9 %8.2f  max %8.2f us\n", name, 1e6 * times[last / 2],
         1e6 * times[(int)(0.9 * last)], 1e6 * times[(int)(0.99 * last)], 1e6 * times[(int)(0.999 * last)],
         1e6 * times[last]);
}

/* Everything before the solver, as in cycle.c. */
static void build_only(pg_controller_t *controller, const input_t *input, double time) {
  const pg_measurement_t seen = {.time = time, .tof_range = input->tof, .capacitive = input->switches};
  pg_diagnostics_t *cycle = &controller->cycle;
  pg_check_input(controller, input->q, input->xdot, &seen);
  pg_model_bounds(&controller->parameters, input->q, controller->qdot_previous, cycle->lb, cycle->ub);
  pg_model_kinematics(input->q, &controller->kinematics);
  pg_find_nearest(controller, &seen);
  pg_write_rows(controller);
  pg_model_objective(&controller->parameters, &controller->kinematics, input->q, input->xdot, cycle->H,
                     cycle->g, &cycle->manipulability, &cycle->damping);
}

int main(int argc, char **argv) {
  const int cycles = (int)(50.0 * (argc > 1 ? atof(argv[1]) : 60.0)), replays = argc > 2 ? atoi(argv[2]) : 20;
  input_t *inputs = calloc((size_t)cycles, sizeof *inputs);
  double *raw = calloc((size_t)cycles * (size_t)replays, sizeof *raw),
         *best = calloc((size_t)cycles, sizeof *best);
  pg_controller_t *controller;
  pg_counters_t counters;
  double qdot[PG_N];
  if (!inputs || !raw || !best || pg_create_checked(&controller, PG_INTERFACE) != PG_SOLVED) return 1;
  const int reached = record(controller, inputs, cycles);
  pg_counters(controller, &counters);
  printf("%s: %d cycles, %d targets, %llu solves, %llu changes, %llu second chances;", pg_solver_name, cycles,
         reached, counters.solves, counters.iterations, counters.second_chances);
  for (int s = 0; s < 32; s++)
    if (counters.status_count[s])
      printf(" %s %llu", pg_status_name((pg_status_t)s), counters.status_count[s]);
  printf("\n");

  for (int r = 0; r < replays; r++) {
    pg_reset(controller);
    for (int i = 0; i < cycles; i++) {
      const double begin = seconds();
      step(controller, &inputs[i], 0.02 * (i + 1), qdot);
      const double elapsed = seconds() - begin;
      raw[r * cycles + i] = elapsed;
      best[i] = r == 0 ? elapsed : least(best[i], elapsed);
    }
  }
  print_times("cycle, raw", raw, cycles * replays);
  print_times("cycle, best of replays", best, cycles);

  for (int r = 0; r < replays; r++) {
    pg_reset(controller);
    for (int i = 0; i < cycles; i++) {
      const double begin = seconds();
      build_only(controller, &inputs[i], 0.02 * (i + 1));
      raw[r * cycles + i] = seconds() - begin;
    }
  }
  print_times("QP build, raw", raw, cycles * replays);
  for (int i = 0; i < cycles; i++) {
    const double begin = seconds();
    raw[i] = seconds() - begin;
  }
  print_times("clock alone", raw, cycles);
  pg_destroy(controller);
  free(inputs), free(raw), free(best);
  return 0;
}
