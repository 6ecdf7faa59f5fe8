/* Fuzz target: bytes are read as operations on one controller and its input, and after every step what the
 * interface promises is checked. With coverage guidance by libFuzzer:
 *
 *     make sanitize        compiles this with AddressSanitizer and UndefinedBehaviorSanitizer, and runs it on
 *                          runtime/fuzz/corpus and for half a minute on what it makes of that
 *
 * An operation is a byte that says which, and what it needs; where the bytes end, the run ends. */
#include "state.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum operation {
  STEP,      /* a cycle, a period later */
  RAW,       /* index, 8 bytes: any double as a value of the input */
  USUAL,     /* index, 1 byte: a value of the input somewhere in its usual range */
  SWITCH,    /* index: a switch opens or closes */
  POINT,     /* 3 x 2 bytes: a further obstacle point within 2 m */
  NO_POINTS, /* all of them gone */
  PARAMETER, /* index, 8 bytes: any double as a parameter */
  TUNE,      /* index, 1 byte: a parameter from a tenth to ten times its default */
  AGES,      /* 1 byte: which ages are told */
  RESET,
  WRONG_CALL, /* 1 byte: which argument is left out */
  OPERATIONS
};

/* Everything that goes into a cycle; the doubles can be reached by their index. */
typedef struct {
  struct {
    double q[PG_N], xdot[PG_M], ranges[PG_TOF + 1], tof_ages[PG_TOF + 1], switch_ages[PG_CAPACITIVE + 1];
    double points[3 * PG_MAX_POINTS + 3];
    double time;
  } values;
  unsigned char switches[PG_CAPACITIVE + 1];
  int point_count, tof_ages, switch_ages;
} input_t;

enum {
  VALUES = sizeof(((input_t *)0)->values) / sizeof(double),
  PARAMETERS = sizeof(pg_parameters_t) / sizeof(double)
};

typedef struct {
  const unsigned char *next;
  size_t left;
} bytes_t;

/* Copies the next bytes, zeros where there are no more. */
static void take(bytes_t *bytes, void *target, size_t count) {
  memset(target, 0, count);
  const size_t some = count < bytes->left ? count : bytes->left;
  if (some) memcpy(target, bytes->next, some);
  bytes->next += some;
  bytes->left -= some;
}

static int take_byte(bytes_t *bytes) {
  unsigned char byte;
  take(bytes, &byte, 1);
  return byte;
}

static int take_index(bytes_t *bytes, int count) {
  unsigned short index;
  take(bytes, &index, sizeof index);
  return index % count;
}

static double take_double(bytes_t *bytes) {
  double value;
  take(bytes, &value, sizeof value);
  return value;
}

static void require(int holds, const char *text) {
  if (holds) return;
  fprintf(stderr, "broken: %s\n", text);
  abort();
}
#define REQUIRE(condition) require((condition), #condition)

static void check_promises(const pg_controller_t *controller, pg_status_t status, const double qdot[PG_N]) {
  const pg_diagnostics_t *cycle = &controller->cycle;
  const pg_counters_t *counters = &controller->counters;
  REQUIRE(strcmp(pg_status_name(status), "UNKNOWN") != 0);
  for (int j = 0; j < PG_N; j++) {
    REQUIRE(isfinite(qdot[j]));
    REQUIRE(fabs(qdot[j]) <= controller->parameters.qdot_limit[j]);
    REQUIRE(qdot[j] >= cycle->lb[j] && qdot[j] <= cycle->ub[j]);
  }
  REQUIRE(status < PG_SOLVED || status >= PG_STOPPED_INFEASIBLE || cycle->kkt_residual <= PG_TOLERANCE);
  REQUIRE(cycle->solves <= 25 && cycle->iterations <= 5 * (1 + 4 * 4) * PG_MAX_ITERATIONS);
  unsigned long long sum = 0;
  for (int s = 0; s < 32; s++)
    sum += counters->status_count[s];
  REQUIRE(sum == counters->cycles);
}

static void step(pg_controller_t *controller, input_t *input, int wrong) {
  const pg_measurement_t seen = {.time = input->values.time,
                                 .tof_range = wrong == 1 ? NULL : input->values.ranges,
                                 .capacitive = wrong == 2 ? NULL : input->switches,
                                 .tof_age = input->tof_ages ? input->values.tof_ages : NULL,
                                 .capacitive_age = input->switch_ages ? input->values.switch_ages : NULL,
                                 .points = wrong == 3 ? NULL : input->values.points,
                                 .point_count = wrong == 4   ? -1
                                                : wrong == 5 ? PG_MAX_POINTS + 1
                                                             : input->point_count};
  double qdot[PG_N];
  const pg_status_t status = pg_step(controller, wrong == 6 ? NULL : input->values.q,
                                     wrong == 7 ? NULL : input->values.xdot, wrong == 8 ? NULL : &seen, qdot);
  check_promises(controller, status, qdot);
  for (int j = 0; j < PG_N; j++) /* the arm follows */
    input->values.q[j] += controller->parameters.period * qdot[j];
  input->values.time += controller->parameters.period;
}

static double *value_at(input_t *input, bytes_t *bytes) {
  return (double *)&input->values + take_index(bytes, VALUES);
}

static void change_parameter(pg_controller_t *controller, bytes_t *bytes, enum operation how) {
  pg_parameters_t parameters;
  pg_get_parameters(controller, &parameters);
  const int index = take_index(bytes, PARAMETERS);
  double usual = ((const double *)&pg_model_default_parameters)[index];
  if (how == TUNE) usual = (usual == 0.0 ? 0.01 : usual) * pow(10.0, take_byte(bytes) / 127.5 - 1.0);
  ((double *)&parameters)[index] = how == TUNE ? usual : take_double(bytes);
  pg_set_parameters(controller, &parameters);
}

static void add_point(input_t *input, bytes_t *bytes) {
  if (input->point_count == PG_MAX_POINTS) return;
  double *point = &input->values.points[3 * input->point_count++];
  for (int i = 0; i < 3; i++) {
    short place;
    take(bytes, &place, sizeof place);
    point[i] = place / 16384.0;
  }
}

static void operate(pg_controller_t *controller, input_t *input, bytes_t *bytes) {
  const enum operation which = (enum operation)(take_byte(bytes) % OPERATIONS);
  switch (which) {
  case STEP:
    step(controller, input, 0);
    break;
  case RAW:
    *value_at(input, bytes) = take_double(bytes);
    break;
  case USUAL:
    *value_at(input, bytes) = take_byte(bytes) / 128.0 - (bytes->left % 2 ? 1.0 : 0.0);
    break;
  case SWITCH:
    input->switches[take_index(bytes, PG_CAPACITIVE + 1)] ^= 1;
    break;
  case POINT:
    add_point(input, bytes);
    break;
  case NO_POINTS:
    input->point_count = 0;
    break;
  case PARAMETER:
  case TUNE:
    change_parameter(controller, bytes, which);
    break;
  case AGES:
    input->tof_ages = take_byte(bytes) & 1;
    input->switch_ages = take_byte(bytes) & 1;
    break;
  case RESET:
    REQUIRE(pg_reset(controller) == PG_SOLVED);
    break;
  case WRONG_CALL:
    step(controller, input, take_byte(bytes) % 9);
    break;
  case OPERATIONS:
    break;
  }
}

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size);

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t size) {
  pg_controller_t *controller;
  REQUIRE(pg_create_checked(&controller, PG_INTERFACE) == PG_SOLVED);
  static input_t input;
  memset(&input, 0, sizeof input);
  for (int i = 0; i < PG_TOF; i++)
    input.values.ranges[i] = pg_model_tof[i].range;
  bytes_t bytes = {data, size};
  while (bytes.left > 0)
    operate(controller, &input, &bytes);
  step(controller, &input, 0);
  REQUIRE(pg_destroy(controller) == PG_SOLVED);
  return 0;
}
