/* Two controllers in two threads know nothing of each other: each gives what it gives alone. Nothing is
 * printed, also while others come and go, which changes what qpOASES prints. */
#include "rig.h"

#include <pthread.h>
#include <stdatomic.h>

enum { THREADS = 4, CYCLES = 3000 };

typedef struct {
  unsigned long long seed;
  double sum; /* of all velocities, in order: any difference shows */
  int failed;
} job_t;

static void *work(void *argument) {
  job_t *job = argument;
  random_t random = {job->seed};
  pg_controller_t *controller;
  double ranges[PG_TOF], q[PG_N], xdot[PG_M], qdot[PG_N];
  unsigned char switches[PG_CAPACITIVE] = {0};
  pg_measurement_t seen = {.tof_range = ranges, .capacitive = switches};
  job->sum = 0.0;
  job->failed = pg_create_checked(&controller, PG_INTERFACE) != PG_SOLVED;
  if (job->failed) return NULL;
  for (int i = 0; i < CYCLES; i++) {
    for (int k = 0; k < PG_TOF; k++)
      ranges[k] = between(&random, 0.0, 1.0);
    for (int j = 0; j < PG_N; j++)
      q[j] = between(&random, -2.4, 2.4);
    for (int j = 0; j < PG_M; j++)
      xdot[j] = between(&random, -0.3, 0.3);
    seen.time += 0.02;
    job->failed |= pg_step(controller, q, xdot, &seen, qdot) > PG_STOPPED_INFEASIBLE;
    for (int j = 0; j < PG_N; j++)
      job->sum = 0.999 * job->sum + qdot[j];
  }
  pg_destroy(controller);
  return NULL;
}

static void *come_and_go(void *argument) {
  atomic_int *end = argument;
  while (!atomic_load(end)) {
    pg_controller_t *controller;
    if (pg_create_checked(&controller, PG_INTERFACE) == PG_SOLVED) pg_destroy(controller);
  }
  return NULL;
}

int main(void) {
  pthread_t restless;
  atomic_int end = 0;
  job_t alone[THREADS], together[THREADS];
  pthread_t threads[THREADS];
  for (int i = 0; i < THREADS; i++) {
    alone[i].seed = together[i].seed = 100 + (unsigned long long)i;
    work(&alone[i]);
  }
  CHECK(pthread_create(&restless, NULL, come_and_go, &end) == 0);
  for (int i = 0; i < THREADS; i++)
    CHECK(pthread_create(&threads[i], NULL, work, &together[i]) == 0);
  for (int i = 0; i < THREADS; i++) {
    CHECK(pthread_join(threads[i], NULL) == 0);
    CHECK(!alone[i].failed && !together[i].failed);
    CHECK_EQUAL(together[i].sum, alone[i].sum);
  }
  atomic_store(&end, 1);
  CHECK(pthread_join(restless, NULL) == 0);
  return checks_failed > 0;
}
