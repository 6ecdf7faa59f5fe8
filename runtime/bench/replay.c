/* Replays recorded inputs through a controller and times them, one by one.
 *
 *     replay INPUTS OUTPUT REPLAYS
 *
 * INPUTS holds doubles: how many cycles, how many points a cycle has room for, then cycle by cycle
 *     time, q, xdot, tof_range, tof_age, capacitive (0 or 1), capacitive_age, point_count, points.
 * OUTPUT gets doubles: heap allocations of all timed cycles, seconds that reading the clock takes,
 * certificate residual of the worst success, then REPLAYS times CYCLES times of whole cycles, then per stage
 * of the stages REPLAYS times CYCLES times [s], then CYCLES statuses. Every replay starts from a reset, so
 * that it repeats the recorded run to the last bit. */
#define _POSIX_C_SOURCE 200809L
#include "count_heap.h"
#include "state.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
  STAGE_INPUT,
  STAGE_BOUNDS,
  STAGE_KINEMATICS,
  STAGE_DISTANCES,
  STAGE_ROWS,
  STAGE_OBJECTIVE,
  STAGE_SOLVE,
  STAGE_CERTIFICATE,
  STAGES
};

static double seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* The cycle once more, as `timed_step`: the same source, with a look at the clock where a stage ends. */
static double stage_end[STAGES];
#define PG_STAGE_ENDS(stage) (stage_end[STAGE_##stage] = seconds())
#undef pg_step
#define pg_step timed_step
#include "cycle.c"
#undef pg_step
#define pg_step PG_NAME(step)

typedef struct {
  const double *q, *xdot;
  pg_measurement_t seen;
  unsigned char switches[PG_CAPACITIVE + 1];
} input_t;

/* Points an input at one recorded cycle; returns where the next one starts. */
static const double *open_cycle(const double *record, size_t room, input_t *input) {
  input->seen.time = *record++;
  input->q = record, record += PG_N;
  input->xdot = record, record += PG_M;
  input->seen.tof_range = record, record += PG_TOF;
  input->seen.tof_age = record, record += PG_TOF;
  for (int s = 0; s < PG_CAPACITIVE; s++)
    input->switches[s] = record[s] != 0.0;
  input->seen.capacitive = input->switches, record += PG_CAPACITIVE;
  input->seen.capacitive_age = record, record += PG_CAPACITIVE;
  input->seen.point_count = (int)*record++;
  input->seen.points = record;
  return record + 3 * room;
}

static double *read_all(const char *name, size_t *count) {
  FILE *file = fopen(name, "rb");
  if (!file) return NULL;
  fseek(file, 0, SEEK_END);
  const long size = ftell(file);
  rewind(file);
  double *values = size > 0 ? malloc((size_t)size) : NULL;
  *count = values ? fread(values, sizeof *values, (size_t)size / sizeof *values, file) : 0;
  fclose(file);
  return values;
}

/* One cycle through the public interface. */
static double time_cycle(pg_controller_t *controller, const input_t *input, double *status) {
  double qdot[PG_N];
  const double begin = seconds();
  const pg_status_t result = pg_step(controller, input->q, input->xdot, &input->seen, qdot);
  const double elapsed = seconds() - begin;
  *status = (double)result;
  return elapsed;
}

/* The same cycle in its stages; the solution is then certified once more, to time that alone. Stages that a
 * cycle does not reach take no time. */
static void time_stages(pg_controller_t *controller, const input_t *input, double *times) {
  double qdot[PG_N];
  memset(stage_end, 0, sizeof stage_end);
  const double begin = seconds();
  double before = begin;
  timed_step(controller, input->q, input->xdot, &input->seen, qdot);
  if (stage_end[STAGE_SOLVE] >= begin) {
    const pg_qp_t qp = pg_stage_of(controller);
    const double start = seconds();
    const volatile double residual = pg_kkt_residual(&qp, &controller->solution);
    times[STAGE_CERTIFICATE] = seconds() - start;
    (void)residual;
  }
  for (int stage = 0; stage < STAGE_CERTIFICATE && stage_end[stage] >= begin; stage++) {
    times[stage] = stage_end[stage] - before;
    before = stage_end[stage];
  }
}

/* Least time between two readings of the clock: what is in every figure. */
static double clock_overhead(void) {
  double least = 1.0;
  for (int i = 0; i < 10000; i++) {
    const double begin = seconds(), elapsed = seconds() - begin;
    least = elapsed < least ? elapsed : least;
  }
  return least;
}

static int replay(const double *record, size_t cycles, size_t room, size_t replays, FILE *output) {
  double *times = calloc(replays * cycles * (1 + STAGES), sizeof *times),
         *statuses = calloc(cycles, sizeof *statuses);
  pg_controller_t *controller;
  if (!times || !statuses || pg_create_checked(&controller, PG_INTERFACE) != PG_SOLVED) return 1;
  input_t input;
  double worst = 0.0;
  const unsigned long long before = heap_allocations;
  for (size_t r = 0; r < replays; r++) {
    const double *next = record;
    pg_reset(controller);
    for (size_t i = 0; i < cycles; i++) {
      next = open_cycle(next, room, &input);
      times[r * cycles + i] = time_cycle(controller, &input, &statuses[i]);
      if (statuses[i] < PG_STOPPED_INFEASIBLE && controller->cycle.kkt_residual > worst)
        worst = controller->cycle.kkt_residual;
    }
  }
  const double head[3] = {(double)(heap_allocations - before), clock_overhead(), worst};
  double *stages = &times[replays * cycles];
  for (size_t r = 0; r < replays; r++) {
    const double *next = record;
    pg_reset(controller);
    for (size_t i = 0; i < cycles; i++) {
      double parts[STAGES] = {0.0};
      next = open_cycle(next, room, &input);
      time_stages(controller, &input, parts);
      for (size_t stage = 0; stage < STAGES; stage++)
        stages[(stage * replays + r) * cycles + i] = parts[stage];
    }
  }
  pg_destroy(controller);
  const size_t all = replays * cycles * (1 + STAGES);
  const int written = fwrite(head, sizeof *head, 3, output) == 3 &&
                      fwrite(times, sizeof *times, all, output) == all &&
                      fwrite(statuses, sizeof *statuses, cycles, output) == cycles;
  free(times), free(statuses);
  return !written;
}

int main(int argc, char **argv) {
  if (argc != 4) return 2;
  size_t count = 0;
  double *values = read_all(argv[1], &count);
  if (!values || count < 2) return 3;
  const size_t cycles = (size_t)values[0], room = (size_t)values[1];
  const size_t per_cycle = 2 + PG_N + PG_M + 2 * PG_TOF + 2 * PG_CAPACITIVE + 3 * room;
  if (count != 2 + cycles * per_cycle) return 4;
  FILE *output = fopen(argv[2], "wb");
  if (!output) return 5;
  const int failed = replay(values + 2, cycles, room, (size_t)atoi(argv[3]), output);
  return fclose(output) != 0 || failed ? 6 : 0;
}
