/* A control loop at 1 kHz in C, with absolute deadlines, slower sensors, and its own overruns measured.
 *
 *     loop [SECONDS]                     (real-time priority, where it is allowed: chrt -f 80 loop 10)
 *
 * Arm and skin are stood for by a few lines: the arm follows its command exactly, the skin sees nothing and
 * says so every 10 ms, and an obstacle that a camera might see comes and goes beside the elbow. */
#define _POSIX_C_SOURCE 200809L
#include <iiwa7/controller.h>

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <time.h>

#define PERIOD     1000000L /* [ns] */
#define SECOND     1000000000L
#define MAX_PERIOD 0.02 /* [s] a cycle that comes later than this brakes: PG_FAULT_DEADLINE */
#define SKIN_EVERY 10   /* cycles between two readings of a module */

typedef struct {
  long cycles, overruns, skipped;  /* deadlines met by a cycle; commands after the next deadline; left out */
  long latest_start, longest_step; /* [ns] */
} timing_t;

static long nanoseconds_since(const struct timespec *begin) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (now.tv_sec - begin->tv_sec) * SECOND + now.tv_nsec - begin->tv_nsec;
}

static void advance(struct timespec *deadline) {
  deadline->tv_nsec += PERIOD;
  if (deadline->tv_nsec >= SECOND) {
    deadline->tv_nsec -= SECOND;
    deadline->tv_sec++;
  }
}

static long greater(long a, long b) {
  return a > b ? a : b;
}

/* What the skin said last. Each module has a range sensor and a switch, which it reads together. */
typedef struct {
  long cycle;
  double range[IIWA7_TOF];
  unsigned char closed[IIWA7_TOF];
  double taken[IIWA7_TOF], age[IIWA7_TOF]; /* [s] when it was read, and how long ago */
} skin_t;
_Static_assert(IIWA7_TOF == IIWA7_CAPACITIVE, "modules have both sensors");

/* A tenth of the modules is read in each cycle, the others become older. The controller brakes where one is
 * older than sensor_timeout (PG_FAULT_STALE): without ages it could not know that a cable is off. */
static void read_skin(skin_t *skin, double time) {
  for (int i = 0; i < IIWA7_TOF; i++) {
    if (skin->cycle == 0 || skin->cycle % SKIN_EVERY == i % SKIN_EVERY) {
      skin->range[i] = iiwa7_tof[i].range; /* nothing seen */
      skin->closed[i] = 0;
      skin->taken[i] = time;
    }
    skin->age[i] = time - skin->taken[i];
  }
  skin->cycle++;
}

/* One cycle: sense, decide, command. */
static pg_status_t cycle(iiwa7_controller_t *controller, skin_t *skin, double time, double q[IIWA7_JOINTS]) {
  read_skin(skin, time);
  const double obstacle[3] = {0.35, 0.25 * cos(time), 0.75};
  const iiwa7_measurement_t seen = {.time = time,
                                    .tof_range = skin->range,
                                    .tof_age = skin->age,
                                    .capacitive = skin->closed,
                                    .capacitive_age = skin->age,
                                    .points = obstacle,
                                    .point_count = 1};

  const double xdot[IIWA7_TASK_ROWS] = {0.0, 0.1 * cos(2.0 * time), 0.1 * sin(2.0 * time)};
  double qdot[IIWA7_JOINTS];
  const pg_status_t status = iiwa7_step(controller, q, xdot, &seen, qdot);
  for (int j = 0; j < IIWA7_JOINTS; j++)
    q[j] += 1e-9 * PERIOD * qdot[j];
  return status;
}

/* Sleeps until the deadline, whatever signals come in between. 0: it is there. */
static int sleep_until(const struct timespec *deadline) {
  int error;
  do {
    error = clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, deadline, NULL);
  } while (error == EINTR);
  return error;
}

/* Runs until `count` deadlines are over. One that has passed already is left out, not caught up with. */
static int run(iiwa7_controller_t *controller, long count, timing_t *timing) {
  double q[IIWA7_JOINTS] = {0.0, 0.5, 0.0, -1.5, 0.0, 1.0, 0.0};
  skin_t skin = {0};
  struct timespec begin, deadline;
  clock_gettime(CLOCK_MONOTONIC, &begin);
  deadline = begin;
  for (long passed = 0; passed < count; passed++) {
    advance(&deadline);
    if (nanoseconds_since(&deadline) >= PERIOD) {
      timing->skipped++;
      continue;
    }
    if (sleep_until(&deadline)) return 1;
    const long start = nanoseconds_since(&deadline);
    const double time = 1e-9 * (double)nanoseconds_since(&begin);
    if (cycle(controller, &skin, time, q) < PG_SOLVED) return 1; /* a wrong call */
    const long end = nanoseconds_since(&deadline);
    timing->cycles++;
    timing->overruns += end >= PERIOD;
    timing->latest_start = greater(timing->latest_start, start);
    timing->longest_step = greater(timing->longest_step, end - start);
  }
  return 0;
}

int main(int argc, char **argv) {
  static unsigned char memory[IIWA7_MEMORY_SIZE];
  iiwa7_controller_t *controller;
  iiwa7_parameters_t parameters;
  iiwa7_counters_t counters;
  const double seconds = argc > 1 ? atof(argv[1]) : 2.0;
  /* No page faults later; where this is refused, the loop runs all the same. */
  mlockall(MCL_CURRENT | MCL_FUTURE);

  if (iiwa7_create_in(memory, sizeof memory, &controller) != PG_SOLVED ||
      iiwa7_get_parameters(controller, &parameters) != PG_SOLVED)
    return 1;
  parameters.period = 1e-9 * PERIOD;
  parameters.max_period = MAX_PERIOD;
  if (iiwa7_set_parameters(controller, &parameters) != PG_SOLVED) return 1;

  timing_t timing = {0};
  if (run(controller, (long)(seconds * SECOND / PERIOD), &timing) ||
      iiwa7_counters(controller, &counters) != PG_SOLVED)
    return 1;
  printf("cycles: %ld at 1 kHz, %ld deadlines left out\n", timing.cycles, timing.skipped);
  printf("overruns: %ld; started at most %ld us late, step took at most %ld us\n", timing.overruns,
         timing.latest_start / 1000, timing.longest_step / 1000);
  for (int status = 0; status < 32; status++)
    if (counters.status_count[status])
      printf("%s: %llu\n", iiwa7_status_name((pg_status_t)status), counters.status_count[status]);
  return iiwa7_destroy(controller) != PG_SOLVED;
}
