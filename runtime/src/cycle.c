/* One control cycle: the steps of docs/method.md, in their order. */
#include "state.h"

#include <math.h>
#include <string.h>

/* Nothing in a controller; runtime/bench/replay.c includes this file to read the clock at these places. */
#ifndef PG_STAGE_ENDS
#define PG_STAGE_ENDS(stage)
#endif

/* Bounds of velocity and acceleration alone, where q is of no use for those of position. */
static void bounds_without_position(pg_controller_t *controller) {
  const pg_parameters_t *p = &controller->parameters;
  for (int j = 0; j < PG_N; j++) {
    const double limit = p->qdot_limit[j], step = p->qddot_limit[j] * p->period;
    const double low = controller->qdot_previous[j] - step, high = controller->qdot_previous[j] + step;
    controller->cycle.lb[j] = low > limit ? limit : low > -limit ? low : -limit;
    controller->cycle.ub[j] = high < -limit ? -limit : high < limit ? high : limit;
  }
}

/* The safe stop: the velocity nearest to zero that the bounds allow. */
static void brake(const pg_controller_t *controller, double qdot[PG_N]) {
  const double *lb = controller->cycle.lb, *ub = controller->cycle.ub;
  for (int j = 0; j < PG_N; j++)
    qdot[j] = lb[j] > 0.0 ? lb[j] : ub[j] < 0.0 ? ub[j] : 0.0;
}

/* What additions say of a cycle that they did not take part in: nothing. */
static void forget_additions(pg_diagnostics_t *cycle) {
#if PG_SELF_POINTS
  for (int l = 0; l < PG_CAPSULES; l++)
    cycle->self_distance[l] = PG_INFINITY;
#endif
#if PG_SELF_MEASUREMENT
  cycle->self_readings = 0;
#endif
#if PG_MEMORY_CAPACITY > 0
  cycle->memory_points = 0;
#endif
#if PG_CIRCULATION
  cycle->circulating = 0;
  for (int i = 0; i < 3; i++)
    cycle->tangent[i] = PG_NAN;
#endif
  (void)cycle;
}

/* Diagnostics of a cycle in which nothing has happened yet. */
static void begin(pg_diagnostics_t *cycle) {
  memset(cycle->row_on, 0, sizeof cycle->row_on);
  cycle->kkt_residual = PG_NAN;
  cycle->iterations = cycle->solves = cycle->second_chances = 0;
  forget_additions(cycle);
}

/* Steps 0 to 7 up to a decision. Bounds are always written; a solution only if the status is a success. */
static pg_status_t decide(pg_controller_t *controller, const double q[PG_N], const double xdot[PG_M],
                          const pg_measurement_t *seen) {
  const pg_parameters_t *p = &controller->parameters;
  pg_diagnostics_t *cycle = &controller->cycle;

  pg_status_t status = pg_check_input(controller, q, xdot, seen);
  PG_STAGE_ENDS(INPUT);
  if (pg_within_joint_limits(p, q))
    pg_model_bounds(p, q, controller->qdot_previous, cycle->lb, cycle->ub);
  else
    bounds_without_position(controller);
  PG_STAGE_ENDS(BOUNDS);
  if (status != PG_SOLVED) return status;

  pg_model_kinematics(q, &controller->kinematics);
  PG_STAGE_ENDS(KINEMATICS);
  status = pg_find_nearest(controller, seen);
#if PG_SELF_POINTS
  if (status == PG_SOLVED) status = pg_find_nearest_self(controller);
#endif
  if (status != PG_SOLVED) {
    forget_additions(cycle);
    return status;
  }
  PG_STAGE_ENDS(DISTANCES);
#if PG_CIRCULATION
  double circulating_xdot[PG_M];
  pg_circulate(controller, xdot, circulating_xdot);
  xdot = circulating_xdot;
#endif
  pg_write_rows(controller, xdot);
  PG_STAGE_ENDS(ROWS);
  pg_model_objective(p, &controller->kinematics, q, xdot, cycle->H, cycle->g, &cycle->manipulability,
                     &cycle->damping);
  PG_STAGE_ENDS(OBJECTIVE);
  status = pg_find_velocity(controller);
  PG_STAGE_ENDS(SOLVE);
  return status;
}

/* Adds the cycle to the counters. */
static void count(pg_controller_t *controller, pg_status_t status) {
  const pg_diagnostics_t *cycle = &controller->cycle;
  pg_counters_t *counters = &controller->counters;
  counters->cycles++;
  counters->status_count[status]++;
  counters->solves += (unsigned long long)cycle->solves;
  counters->iterations += (unsigned long long)cycle->iterations;
  counters->second_chances += (unsigned long long)cycle->second_chances;
  if (cycle->iterations > counters->max_iterations_in_cycle)
    counters->max_iterations_in_cycle = cycle->iterations;
}

/* PG_SOLVED if the call can be served at all. */
static pg_status_t check_call(const double *q, const double *xdot, const pg_measurement_t *seen) {
  if (!q || !xdot || !seen || (PG_TOF > 0 && !seen->tof_range) || (PG_CAPACITIVE > 0 && !seen->capacitive) ||
      (seen->point_count > 0 && !seen->points))
    return PG_ERROR_NULL;
  return seen->point_count < 0 || seen->point_count > PG_MAX_POINTS ? PG_ERROR_SIZE : PG_SOLVED;
}

pg_status_t pg_step(pg_controller_t *controller, const double q[PG_N], const double xdot[PG_M],
                    const pg_measurement_t *seen, double qdot[PG_N]) {
  if (!pg_alive(controller)) {
    if (qdot) memset(qdot, 0, PG_N * sizeof(double));
    return PG_ERROR_NULL;
  }
  if (!qdot) {
    controller->counters.errors++;
    return PG_ERROR_NULL;
  }
  begin(&controller->cycle);
  const pg_status_t wrong_call = check_call(q, xdot, seen);
  const pg_status_t status = wrong_call == PG_SOLVED ? decide(controller, q, xdot, seen) : wrong_call;
  if (wrong_call != PG_SOLVED) {
    bounds_without_position(controller);
    controller->counters.errors++;
  } else {
    count(controller, status);
  }

  if (status >= PG_SOLVED && status < PG_STOPPED_INFEASIBLE)
    memcpy(qdot, controller->solution.x, PG_N * sizeof(double));
  else
    brake(controller, qdot);
  memcpy(controller->qdot_previous, qdot, PG_N * sizeof(double));
  return status;
}
