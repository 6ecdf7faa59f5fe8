/* Step 0: is the input what a working robot can send? Checked in the order of docs/method.md. */
#include "state.h"

#include <stdint.h>
#include <string.h>

/* The bits of a double. Numbers that are not negative are in the order of their bits; negative ones have the
 * top bit set, and NaN and infinity have more than any number: so a range is checked by subtractions whose
 * top bit tells, which processors do several at a time. */
static uint64_t bits_of(double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}

/* Top bit set unless all values are within 0 and `high`; also for -0.0: then the caller looks closer. */
static uint64_t suspicion(const double *values, int count, double high) {
  const uint64_t limit = bits_of(high);
  uint64_t any = 0;
  for (int i = 0; i < count; i++)
    any |= (limit - bits_of(values[i])) | bits_of(values[i]);
  return any;
}

/* 1 if readings and ages are beyond doubt: what nearly every cycle needs, at a fraction of the cost. */
static int sensors_beyond_doubt(const pg_measurement_t *seen, double timeout) {
  uint64_t any = 0;
  for (int i = 0; i < PG_TOF; i++)
    any |= (bits_of(pg_model_tof[i].range) - bits_of(seen->tof_range[i])) | bits_of(seen->tof_range[i]);
  if (seen->tof_age) any |= suspicion(seen->tof_age, PG_TOF, timeout);
  if (seen->capacitive_age) any |= suspicion(seen->capacitive_age, PG_CAPACITIVE, timeout);
  return !(any >> 63);
}

/* 1 if no value is NaN or infinite: only then is x - x zero. */
static int all_finite(const double *values, int count) {
  int finite = 1;
  for (int i = 0; i < count; i++)
    finite &= values[i] - values[i] == 0.0;
  return finite;
}

static int ages_finite(const pg_measurement_t *seen) {
  return (!seen->tof_age || all_finite(seen->tof_age, PG_TOF)) &&
         (!seen->capacitive_age || all_finite(seen->capacitive_age, PG_CAPACITIVE));
}

int pg_within_joint_limits(const pg_parameters_t *p, const double q[PG_N]) {
  int within = 1;
  for (int j = 0; j < PG_N; j++)
    within &= (q[j] >= p->q_lower[j] - p->limit_tolerance) & (q[j] <= p->q_upper[j] + p->limit_tolerance);
  return within;
}

static int all_between(const double *values, int count, double low, double high) {
  int between = 1;
  for (int i = 0; i < count; i++)
    between &= (values[i] >= low) & (values[i] <= high);
  return between;
}

static int ages_between(const pg_measurement_t *seen, double low, double high) {
  return (!seen->tof_age || all_between(seen->tof_age, PG_TOF, low, high)) &&
         (!seen->capacitive_age || all_between(seen->capacitive_age, PG_CAPACITIVE, low, high));
}

static int readings_possible(const pg_measurement_t *seen) {
  int possible = 1;
  for (int i = 0; i < PG_TOF; i++)
    possible &= (seen->tof_range[i] >= 0.0) & (seen->tof_range[i] <= pg_model_tof[i].range);
  return possible;
}

pg_status_t pg_check_input(pg_controller_t *controller, const double q[PG_N], const double xdot[PG_M],
                           const pg_measurement_t *seen) {
  const pg_parameters_t *p = &controller->parameters;
  const int beyond_doubt = sensors_beyond_doubt(seen, p->sensor_timeout);
  if (!all_finite(q, PG_N) || !all_finite(xdot, PG_M) || !all_finite(&seen->time, 1) ||
      !all_finite(seen->points, 3 * seen->point_count) ||
      !(beyond_doubt || (all_finite(seen->tof_range, PG_TOF) && ages_finite(seen))))
    return PG_FAULT_NOT_FINITE;

  /* The time counts from here on, even if something else is wrong with this cycle. */
  const int advances = !controller->has_time || seen->time > controller->time_previous;
  const double elapsed = controller->has_time ? seen->time - controller->time_previous : 0.0;
  if (advances) {
    controller->time_previous = seen->time;
    controller->has_time = 1;
  }

  if (!pg_within_joint_limits(p, q)) return PG_FAULT_JOINT_LIMIT;
  if (!beyond_doubt && (!readings_possible(seen) || !ages_between(seen, 0.0, PG_OFF)))
    return PG_FAULT_READING;
  if (!advances) return PG_FAULT_TIME;
  if (p->max_period > 0.0 && elapsed > p->max_period) return PG_FAULT_DEADLINE;
  if (!beyond_doubt && !ages_between(seen, 0.0, p->sensor_timeout)) return PG_FAULT_STALE;
  return PG_SOLVED;
}
