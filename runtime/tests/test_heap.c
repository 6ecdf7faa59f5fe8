/* Heap use, counted by wrapping the allocator (linked with --wrap): none in a block of the caller, one block
 * and its return otherwise, and nothing in between. For the DAQP back end only: qpOASES allocates in every
 * cycle. */
#include "rig.h"

#include <stdlib.h>

static long calls;

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
void __real_free(void *block);

void *__wrap_malloc(size_t size) {
  calls++;
  return __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size) {
  calls++;
  return __real_calloc(count, size);
}

void *__wrap_realloc(void *block, size_t size) {
  calls++;
  return __real_realloc(block, size);
}

void __wrap_free(void *block) {
  calls++;
  __real_free(block);
}

/* Cycles of every kind: solved, reduced, stopped, faulty. */
static void run(pg_controller_t *controller) {
  random_t random = {41};
  pg_counters_t counters;
  double ranges[PG_TOF], points[3 * PG_MAX_POINTS] = {0.0}, q[PG_N], xdot[PG_M], qdot[PG_N];
  unsigned char switches[PG_CAPACITIVE] = {0};
  pg_measurement_t seen = {.tof_range = ranges, .capacitive = switches, .points = points};
  for (int i = 0; i < 20000; i++) {
    for (int k = 0; k < PG_TOF; k++)
      ranges[k] = between(&random, 0.0, 1.0);
    seen.point_count = i % 4;
    for (int k = 0; k < 3 * seen.point_count; k++)
      points[k] = k % 3 == 2 ? 0.0 : between(&random, -1.0, 1.0);
    q[0] = between(&random, -2.6, 2.7), q[1] = between(&random, -2.5, 2.5);
    xdot[0] = between(&random, -0.3, 0.3), xdot[1] = i % 97 ? 0.1 : NAN;
    seen.time += 0.02;
    pg_step(controller, q, xdot, &seen, qdot);
    if (i % 1000 == 0) pg_reset(controller);
  }
  pg_counters(controller, &counters);
  CHECK(counters.status_count[PG_SOLVED] > 0 && counters.status_count[PG_REDUCED_REPULSION] > 0 &&
        counters.status_count[PG_STOPPED_INFEASIBLE] > 0 && counters.status_count[PG_FAULT_NOT_FINITE] > 0);
}

int main(void) {
  static unsigned char block[PG_MEMORY_SIZE];
  pg_controller_t *controller;
  CHECK_EQUAL(pg_create_in_checked(block, sizeof block, &controller, PG_INTERFACE), PG_SOLVED);
  run(controller);
  CHECK_EQUAL(pg_destroy(controller), PG_SOLVED);
  CHECK_EQUAL(calls, 0);

  CHECK_EQUAL(pg_create_checked(&controller, PG_INTERFACE), PG_SOLVED);
  CHECK_EQUAL(calls, 1);
  run(controller);
  CHECK_EQUAL(calls, 1);
  CHECK_EQUAL(pg_destroy(controller), PG_SOLVED);
  CHECK_EQUAL(calls, 2);
  void *volatile block_of_heap = malloc(1); /* the wrapping itself works */
  free(block_of_heap);
  CHECK_EQUAL(calls, 4);
  return checks_failed > 0;
}
