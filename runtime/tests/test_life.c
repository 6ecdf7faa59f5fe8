/* Creation, memory, interface check, parameters, counters, names. */
#include "packed.h"
#include "rig.h"

static void blocks_of_the_caller(void) {
  static unsigned char block[PG_MEMORY_SIZE + 64];
  pg_controller_t *controller = NULL;
  CHECK_EQUAL(pg_create_in_checked(block, PG_MEMORY_SIZE - 1, &controller, PG_INTERFACE), PG_ERROR_SIZE);
  CHECK(controller == NULL);
  CHECK_EQUAL(pg_create_in_checked(block, 0, &controller, PG_INTERFACE), PG_ERROR_SIZE);
  CHECK_EQUAL(pg_create_in_checked(NULL, PG_MEMORY_SIZE, &controller, PG_INTERFACE), PG_ERROR_NULL);
  CHECK_EQUAL(pg_create_in_checked(block, PG_MEMORY_SIZE, NULL, PG_INTERFACE), PG_ERROR_NULL);

  for (int offset = 0; offset < 32; offset++) { /* any alignment; nothing behind the end is touched */
    memset(block, 0xAB, sizeof block);
    CHECK_EQUAL(pg_create_in_checked(block + offset, PG_MEMORY_SIZE, &controller, PG_INTERFACE), PG_SOLVED);
    double q[PG_N] = {0.1, 0.2}, xdot[PG_M] = {0.1, -0.1}, qdot[PG_N], ranges[PG_TOF] = {0.2, 1.0, 0.1, 1.0};
    unsigned char switches[PG_CAPACITIVE] = {0};
    pg_measurement_t seen = {.tof_range = ranges, .capacitive = switches};
    for (int i = 0; i < 20; i++) {
      seen.time += 0.02;
      CHECK(pg_step(controller, q, xdot, &seen, qdot) <= PG_STOPPED_INFEASIBLE);
    }
    CHECK_EQUAL(pg_destroy(controller), PG_SOLVED);
    for (int i = 0; i < offset; i++)
      CHECK(block[i] == 0xAB);
    for (size_t i = (size_t)offset + PG_MEMORY_SIZE; i < sizeof block; i++)
      CHECK(block[i] == 0xAB);
  }
}

/* The size in controller.h is a bound that has to hold for both solvers, but not a wild guess. */
static void the_size_is_near_the_truth(void) {
  CHECK(sizeof(pg_controller_t) > PG_MEMORY_SIZE / 2);
}

static void headers_of_another_version(void) {
  pg_controller_t *controller = NULL;
  static unsigned char block[PG_MEMORY_SIZE];
  CHECK_EQUAL(pg_create_checked(&controller, PG_INTERFACE + 1), PG_ERROR_ABI);
  CHECK(controller == NULL);
  CHECK_EQUAL(pg_create_in_checked(block, sizeof block, &controller, PG_INTERFACE ^ (1ull << 60)),
              PG_ERROR_ABI);
  CHECK_EQUAL(pg_create_checked(NULL, PG_INTERFACE), PG_ERROR_NULL);
  CHECK_EQUAL(planar_create(&controller), PG_SOLVED); /* the inline function passes the right number */
  CHECK_EQUAL(pg_destroy(controller), PG_SOLVED);
  CHECK_EQUAL(planar_create_in(block, sizeof block, &controller), PG_SOLVED);
  CHECK_EQUAL(pg_destroy(controller), PG_SOLVED);
}

static void nothing_is_not_a_controller(void) {
  pg_parameters_t parameters;
  pg_counters_t counters;
  const pg_diagnostics_t *diagnostics;
  CHECK_EQUAL(pg_destroy(NULL), PG_SOLVED);
  CHECK_EQUAL(pg_reset(NULL), PG_ERROR_NULL);
  CHECK_EQUAL(pg_get_parameters(NULL, &parameters), PG_ERROR_NULL);
  CHECK_EQUAL(pg_set_parameters(NULL, &parameters), PG_ERROR_NULL);
  CHECK_EQUAL(pg_diagnostics(NULL, &diagnostics), PG_ERROR_NULL);
  CHECK_EQUAL(pg_counters(NULL, &counters), PG_ERROR_NULL);
  CHECK_EQUAL(pg_version(NULL), PG_ERROR_NULL);
  rig_t rig;
  rig_open(&rig);
  CHECK_EQUAL(pg_get_parameters(rig.controller, NULL), PG_ERROR_NULL);
  CHECK_EQUAL(pg_set_parameters(rig.controller, NULL), PG_ERROR_NULL);
  CHECK_EQUAL(pg_diagnostics(rig.controller, NULL), PG_ERROR_NULL);
  CHECK_EQUAL(pg_counters(rig.controller, NULL), PG_ERROR_NULL);
  rig_close(&rig);
}

/* In a caller's block a controller that is gone can be seen to be gone; so can one that never was. */
static void a_block_without_a_controller(void) {
  static unsigned char block[PG_MEMORY_SIZE];
  rig_t rig;
  rig_open(&rig);
  pg_controller_t *gone = NULL;
  CHECK_EQUAL(pg_create_in_checked(block, sizeof block, &gone, PG_INTERFACE), PG_SOLVED);
  for (int i = 0; i < 2; i++) { /* destroyed, then all zero */
    CHECK_EQUAL(pg_destroy(gone), PG_SOLVED);
    CHECK_EQUAL(pg_destroy(gone), PG_SOLVED); /* twice does no harm */
    pg_parameters_t parameters = pg_model_default_parameters;
    pg_counters_t counters;
    const pg_diagnostics_t *diagnostics;
    double qdot[PG_N] = {9.0, 9.0};
    CHECK_EQUAL(pg_step(gone, rig.q, rig.xdot, &rig.seen, qdot), PG_ERROR_NULL);
    CHECK(qdot[0] == 0.0 && qdot[1] == 0.0);
    CHECK_EQUAL(pg_reset(gone), PG_ERROR_NULL);
    CHECK_EQUAL(pg_get_parameters(gone, &parameters), PG_ERROR_NULL);
    CHECK_EQUAL(pg_set_parameters(gone, &parameters), PG_ERROR_NULL);
    CHECK_EQUAL(pg_diagnostics(gone, &diagnostics), PG_ERROR_NULL);
    CHECK_EQUAL(pg_counters(gone, &counters), PG_ERROR_NULL);
    memset(block, 0, sizeof block);
  }
  CHECK_EQUAL(pg_create_in_checked(block, sizeof block, &gone, PG_INTERFACE), PG_SOLVED); /* again */
  CHECK_EQUAL(pg_step(gone, rig.q, rig.xdot, &rig.seen, rig.qdot), PG_SOLVED);
  CHECK_EQUAL(pg_destroy(gone), PG_SOLVED);
  rig_close(&rig);
}

static void refuse(rig_t *rig, const pg_parameters_t *wrong) {
  const pg_parameters_t before = rig_parameters(rig);
  CHECK_EQUAL(pg_set_parameters(rig->controller, wrong), PG_ERROR_PARAMETER);
  const pg_parameters_t after = rig_parameters(rig);
  CHECK(memcmp(&before, &after, sizeof before) == 0);
}

/* Every parameter, one after the other, below its range, above it, and as what is no number. */
static void parameters_out_of_range(void) {
  rig_t rig;
  rig_open(&rig);
  const pg_parameters_t good = rig_parameters(&rig);
  CHECK(memcmp(&good, &pg_model_default_parameters, sizeof good) == 0);
  const double *lower = (const double *)&pg_model_lower_parameters,
               *upper = (const double *)&pg_model_upper_parameters;
  for (size_t i = 0; i < sizeof good / sizeof(double); i++) {
    const double wrong[] = {nextafter(lower[i], -INFINITY), nextafter(upper[i], INFINITY), NAN, INFINITY,
                            -INFINITY};
    for (int k = 0; k < 5; k++) {
      pg_parameters_t changed = good;
      ((double *)&changed)[i] = wrong[k];
      refuse(&rig, &changed);
    }
  }
  rig_close(&rig);
}

#define REFUSE(field, value)                                                                                 \
  do {                                                                                                       \
    pg_parameters_t changed = good;                                                                          \
    changed.field = (value);                                                                                 \
    refuse(&rig, &changed);                                                                                  \
  } while (0)

static void parameters_out_of_order(void) {
  rig_t rig;
  rig_open(&rig);
  const pg_parameters_t good = rig_parameters(&rig);
  REFUSE(q_lower[1], good.q_upper[1]);
  REFUSE(d_a, good.d_0u);
  REFUSE(d_0l, good.d_0u + 0.01);
  REFUSE(d_r, good.d_0l);
  REFUSE(damper_safety, good.damper_influence);
  REFUSE(viability, 0.5);
  pg_parameters_t edge = good; /* what is just allowed */
  edge.d_0u = edge.d_0l;
  edge.d_r = 0.0;
  edge.viability = 1.0;
  CHECK_EQUAL(pg_set_parameters(rig.controller, &edge), PG_SOLVED);
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  rig_close(&rig);
}

static void parameters_act_from_the_next_cycle(void) {
  rig_t rig;
  rig_open(&rig);
  rig_see(&rig, 0.25, 0.4);
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK(!rig.cycle->row_on[0]);
  pg_parameters_t p = rig_parameters(&rig);
  p.d_a = 0.5;
  CHECK_EQUAL(pg_set_parameters(rig.controller, &p), PG_SOLVED);
  CHECK_EQUAL(rig_step(&rig), PG_SOLVED);
  CHECK(rig.cycle->row_on[0]);
  rig_close(&rig);
}

static void reset_forgets_the_past(void) {
  rig_t rig, fresh;
  rig_open(&rig);
  rig_open(&fresh);
  const double velocity[PG_N] = {0.8, -0.6};
  rig_speed_up(&rig, velocity);
  CHECK_EQUAL(pg_reset(rig.controller), PG_SOLVED);
  for (int i = 0; i < 50; i++) {
    rig.q[0] = fresh.q[0] = 0.01 * i;
    rig.xdot[1] = fresh.xdot[1] = 0.1;
    rig.seen.point_count = fresh.seen.point_count = 0;
    rig_see(&rig, 0.3, 0.2), rig_see(&fresh, 0.3, 0.2);
    rig.seen.time = fresh.seen.time = 0.02 * (i + 1) - 1000.0; /* an earlier time is fine after a reset */
    const pg_status_t status = pg_step(rig.controller, rig.q, rig.xdot, &rig.seen, rig.qdot);
    CHECK_EQUAL(pg_step(fresh.controller, fresh.q, fresh.xdot, &fresh.seen, fresh.qdot), status);
    CHECK(memcmp(rig.qdot, fresh.qdot, sizeof rig.qdot) == 0);
  }
  rig_close(&rig);
  rig_close(&fresh);
}

static void counters_add_up(void) {
  rig_t rig;
  rig_open(&rig);
  random_t random = {31};
  for (int i = 0; i < 3000; i++) {
    rig.q[0] = between(&random, -2.7, 2.7); /* now and then outside */
    rig.seen.point_count = 0;
    rig_see(&rig, between(&random, -1.0, 1.0), between(&random, -1.0, 1.0));
    rig_see(&rig, between(&random, -1.0, 1.0), between(&random, -1.0, 1.0));
    if (i % 100 == 0) rig.seen.point_count = PG_MAX_POINTS + 1;
    rig_step(&rig);
  }
  pg_counters_t counters;
  CHECK_EQUAL(pg_counters(rig.controller, &counters), PG_SOLVED);
  unsigned long long sum = 0;
  for (int s = 0; s < 32; s++)
    sum += counters.status_count[s];
  CHECK_EQUAL(counters.cycles, sum);
  CHECK_EQUAL(counters.errors, 30);
  CHECK_EQUAL(counters.cycles + counters.errors, 3000);
  CHECK(counters.status_count[PG_SOLVED] > 0 && counters.status_count[PG_FAULT_JOINT_LIMIT] > 0);
  CHECK(counters.solves > 0 && counters.iterations > 0 && counters.max_iterations_in_cycle > 0);
  CHECK_EQUAL(pg_reset(rig.controller), PG_SOLVED);
  pg_counters_t after;
  CHECK_EQUAL(pg_counters(rig.controller, &after), PG_SOLVED);
  CHECK(memcmp(&counters, &after, sizeof after) == 0);
  rig_close(&rig);
}

static void names(void) {
  CHECK(strcmp(pg_status_name(PG_SOLVED), "SOLVED") == 0);
  CHECK(strcmp(pg_status_name(PG_FAULT_STALE), "FAULT_STALE") == 0);
  CHECK(strcmp(pg_status_name((pg_status_t)15), "UNKNOWN") == 0);
  int known = 0;
  for (int s = -8; s < 64; s++)
    known += strcmp(pg_status_name((pg_status_t)s), "UNKNOWN") != 0;
  CHECK_EQUAL(known, 19);
  pg_version_t version;
  CHECK_EQUAL(pg_version(&version), PG_SOLVED);
  CHECK_EQUAL(version.abi, PG_ABI_VERSION);
  CHECK(strcmp(version.config_hash, PG_CONFIG_HASH) == 0 && strlen(version.proxgen) > 0);
  CHECK(strcmp(version.solver, "daqp") == 0 || strcmp(version.solver, "qpoases") == 0);
}

/* The same cycle from one block at an odd address, and with too many points. */
static void a_cycle_in_one_block(void) {
  rig_t one, two;
  rig_open(&one);
  rig_open(&two);
  one.q[0] = 0.1, one.xdot[1] = 0.2, one.ranges[1] = 0.15, one.ages[2] = 0.01, one.switch_ages[0] = 0.02;
  one.switches[1] = 1;
  one.seen.tof_age = one.ages;
  one.seen.capacitive_age = one.switch_ages;
  rig_see(&one, 0.7, 0.3);
  rig_see(&one, 1.2, -0.1);
  const double *parts[] = {one.q, one.xdot, one.ranges, one.ages, one.switch_ages, one.points};
  const size_t counts[] = {PG_N, PG_M, PG_TOF, PG_TOF, PG_CAPACITIVE, 6};
  char block[1 + sizeof(rig_t)], *next = block + 1;
  for (int i = 0; i < 6; i++) {
    memcpy(next, parts[i], counts[i] * sizeof(double));
    next += counts[i] * sizeof(double);
  }
  memcpy(next, one.switches, sizeof one.switches);

  const pg_status_t status = rig_step(&one);
  CHECK_EQUAL(planar_step_packed(two.controller, one.seen.time, block + 1, 2, two.qdot), status);
  CHECK(memcmp(one.qdot, two.qdot, sizeof one.qdot) == 0);
  CHECK(memcmp(one.cycle->H, two.cycle->H, sizeof one.cycle->H) == 0);
  CHECK(memcmp(one.cycle->nearest_point, two.cycle->nearest_point, sizeof one.cycle->nearest_point) == 0);
  CHECK_EQUAL(planar_step_packed(two.controller, 1.0, block + 1, PG_MAX_POINTS + 1, two.qdot), PG_ERROR_SIZE);
  CHECK_EQUAL(planar_step_packed(two.controller, 1.0, block + 1, -1, two.qdot), PG_ERROR_SIZE);
  CHECK_EQUAL(planar_step_packed(two.controller, 1.0, NULL, 0, two.qdot), PG_ERROR_NULL);
  rig_close(&one);
  rig_close(&two);
}

int main(void) {
  a_cycle_in_one_block();
  blocks_of_the_caller();
  the_size_is_near_the_truth();
  headers_of_another_version();
  nothing_is_not_a_controller();
  a_block_without_a_controller();
  parameters_out_of_range();
  parameters_out_of_order();
  parameters_act_from_the_next_cycle();
  reset_forgets_the_past();
  counters_add_up();
  names();
  return checks_failed > 0;
}
