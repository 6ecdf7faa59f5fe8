/* A controller of the planar arm with an input that can be used, for a test to spoil.
 *
 * At q = 0 the arm lies along x: upper arm from 0 to 0.5 m, forearm to 1.0 m. At rest the acceleration allows
 * 0.4 rad/s in the first cycle. The distances to both links are to the axis; only the elbow's are to its
 * surface. */
#ifndef PROXGEN_RIG_H
#define PROXGEN_RIG_H

#include "check.h"
#include "state.h"

#include <string.h>

#define MOST_ACCELERATION 0.4 /* [rad/s] change of velocity per cycle, by default */

typedef struct {
  pg_controller_t *controller;
  const pg_diagnostics_t *cycle;
  double q[PG_N], xdot[PG_M], qdot[PG_N];
  double ranges[PG_TOF], ages[PG_TOF], switch_ages[PG_CAPACITIVE];
  unsigned char switches[PG_CAPACITIVE];
  double points[3 * (PG_MAX_POINTS + 1)];
  pg_measurement_t seen;
} rig_t;

static inline void rig_open(rig_t *rig) {
  memset(rig, 0, sizeof *rig);
  CHECK(pg_create_checked(&rig->controller, PG_INTERFACE) == PG_SOLVED);
  CHECK(pg_diagnostics(rig->controller, &rig->cycle) == PG_SOLVED);
  for (int i = 0; i < PG_TOF; i++)
    rig->ranges[i] = pg_model_tof[i].range;
  rig->seen.tof_range = rig->ranges;
  rig->seen.capacitive = rig->switches;
  rig->seen.points = rig->points;
}

static inline void rig_close(rig_t *rig) {
  CHECK(pg_destroy(rig->controller) == PG_SOLVED);
}

static inline void rig_see(rig_t *rig, double x, double y) {
  double *point = &rig->points[3 * rig->seen.point_count++];
  point[0] = x, point[1] = y, point[2] = 0.0;
}

static inline pg_parameters_t rig_parameters(const rig_t *rig) {
  pg_parameters_t parameters;
  CHECK(pg_get_parameters(rig->controller, &parameters) == PG_SOLVED);
  return parameters;
}

/* 1 if every joint's velocity is finite and within the bounds of the cycle. */
static inline int rig_within_bounds(const rig_t *rig) {
  int within = 1;
  for (int j = 0; j < PG_N; j++)
    within &=
        rig->qdot[j] >= rig->cycle->lb[j] && rig->qdot[j] <= rig->cycle->ub[j] && isfinite(rig->qdot[j]);
  return within;
}

/* One cycle without a change of the time; checks what always holds. */
static inline pg_status_t rig_step_now(rig_t *rig) {
  double before[PG_N];
  memcpy(before, rig->qdot, sizeof before);
  const pg_parameters_t p = rig_parameters(rig);
  const pg_status_t status = pg_step(rig->controller, rig->q, rig->xdot, &rig->seen, rig->qdot);
  CHECK(rig_within_bounds(rig));
  for (int j = 0; j < PG_N; j++) {
    CHECK(fabs(rig->qdot[j]) <= p.qdot_limit[j]);
    if (status >= PG_STOPPED_INFEASIBLE) /* a stop never speeds up, and brakes as hard as it may */
      CHECK_NEAR(fabs(rig->qdot[j]), fmax(fabs(before[j]) - p.qddot_limit[j] * p.period, 0.0), 1e-12);
  }
  if (status < PG_STOPPED_INFEASIBLE && status >= PG_SOLVED) CHECK(rig->cycle->kkt_residual <= PG_TOLERANCE);
  return status;
}

static inline pg_status_t rig_step(rig_t *rig) {
  rig->seen.time += rig_parameters(rig).period;
  return rig_step_now(rig);
}

/* Lets the free arm speed up to `velocity` by a posture task that outweighs all else, then takes it away
 * again. */
static inline void rig_speed_up(rig_t *rig, const double velocity[PG_N]) {
  const pg_parameters_t before = rig_parameters(rig);
  pg_parameters_t p = before;
  for (int j = 0; j < PG_N; j++) {
    p.posture_weight[j] = 1e6;
    p.posture[j] = rig->q[j] + velocity[j];
  }
  CHECK(pg_set_parameters(rig->controller, &p) == PG_SOLVED);
  const int points = rig->seen.point_count;
  rig->seen.point_count = 0;
  for (int i = 0; i < 20; i++)
    CHECK(rig_step(rig) == PG_SOLVED);
  for (int j = 0; j < PG_N; j++)
    CHECK_NEAR(rig->qdot[j], velocity[j], 1e-5);
  rig->seen.point_count = points;
  CHECK(pg_set_parameters(rig->controller, &before) == PG_SOLVED);
}

#endif
