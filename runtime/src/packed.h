/* One cycle whose input comes as one block: what the Python extension calls. There a copy of the whole is
 * cheap, and every further argument is not. */
#ifndef PROXGEN_PACKED_H
#define PROXGEN_PACKED_H

#include "robot.h"

#include <string.h>

/* As pg_step. `input` holds, without gaps, the doubles q, xdot, tof_range, tof_age, capacitive_age and
 * 3 * point_count of points, and then a byte per switch. */
static inline pg_status_t PG_NAME(step_packed)(pg_controller_t *controller, double time, const char *input,
                                               int point_count, double *qdot) {
  enum { BEFORE_POINTS = PG_N + PG_M + 2 * PG_TOF + PG_CAPACITIVE };
  double numbers[BEFORE_POINTS + 3 * PG_MAX_POINTS]; /* a copy, because bytes may lie anywhere */
  if (!input) return PG_ERROR_NULL;
  if (point_count < 0 || point_count > PG_MAX_POINTS) return PG_ERROR_SIZE;
  const size_t size = (size_t)(BEFORE_POINTS + 3 * point_count) * sizeof(double);
  memcpy(numbers, input, size);
  const double *q = numbers, *xdot = q + PG_N, *tof_range = xdot + PG_M, *tof_age = tof_range + PG_TOF,
               *capacitive_age = tof_age + PG_TOF;
  const pg_measurement_t seen = {.time = time,
                                 .tof_range = tof_range,
                                 .capacitive = (const unsigned char *)input + size,
                                 .tof_age = tof_age,
                                 .capacitive_age = capacitive_age,
                                 .points = capacitive_age + PG_CAPACITIVE,
                                 .point_count = point_count};
  return pg_step(controller, q, xdot, &seen, qdot);
}

#endif
