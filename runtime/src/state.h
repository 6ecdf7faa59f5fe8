/* What a controller holds, and the steps of its cycle in the order of docs/method.md. */
#ifndef PROXGEN_STATE_H
#define PROXGEN_STATE_H

#include "geometry.h"
#include "solver.h"

/* The obstacle point that is nearest to a capsule. */
typedef struct {
  int found;           /* 1 if there is a point within influence */
  double distance;     /* [m] ||d|| in the capsule's reference */
  double closest[3];   /* [m] p on the capsule's axis, world */
  double direction[3]; /* unit vector from p to the obstacle point, world */
} pg_nearest_t;

#if PG_SELF_POINTS
/* The point that the arm carries and that is nearest to a capsule. */
typedef struct {
  int found;         /* 1 if there is a point within self_d_a */
  int carrier;       /* body that carries it */
  double distance;   /* [m] between surfaces */
  double length;     /* [m] from the capsule's axis */
  double closest[3]; /* [m] p on the axis, world */
  double point[3];   /* [m] h, world */
  double apart[3];   /* [m] h - p */
} pg_nearest_self_t;
#endif

/* A slot of the memory of seen points. */
typedef struct {
  double point[3]; /* [m] world */
  double time;     /* [s] when it was last seen */
  int used;
} pg_slot_t;

/* What circulation remembers, by the names of docs/method.md. */
typedef struct {
  int circulating; /* the phase */
  double tangent[3];
  double stalled, clear, failing, running, since; /* [s] */
  double blend;
} pg_circulation_t;

struct PG_NAME(controller) {
  pg_parameters_t parameters;
  pg_kinematics_t kinematics;
  pg_nearest_t nearest[PG_CAPSULES];
#if PG_SELF_POINTS
  pg_nearest_self_t nearest_self[PG_CAPSULES];
#endif
  pg_diagnostics_t cycle; /* the QP of this cycle, and how it was decided */
  pg_counters_t counters;

  /* State between cycles. */
  double qdot_previous[PG_N];
  double time_previous;
  int has_time;
#if PG_MEMORY_CAPACITY > 0
  pg_slot_t memory[PG_MEMORY_CAPACITY];
#endif
#if PG_CIRCULATION
  pg_circulation_t circulation;
#endif
#if PG_METHOD_TANGENTIAL
  double tangent[3]; /* of the last cycle; 0: none */
#endif

  double ubA[PG_ROWS];      /* right-hand sides of the stage that is being solved */
  double softness[PG_ROWS]; /* 1/rho of soft rows, 0 in staged mode */
  pg_solution_t solution;
  pg_solver_t *solver;          /* NULL: there is no controller here (any more) */
  void (*release)(void *block); /* gives the block back when the controller ends; NULL if the caller does */
  void *block;
  _Alignas(16) unsigned char solver_memory[PG_SOLVER_MEMORY];
};

/* 1 if there is a controller at this place: not NULL, not destroyed, not a block that is all zero. Where one
 * that was destroyed lived on the heap, nobody can tell. */
static inline int pg_alive(const pg_controller_t *controller) {
  return controller && controller->solver;
}

/* Slots of self-collision, one per capsule, are the last ones. */
#define PG_FIRST_SELF_ROW (PG_CAPSULES + PG_ACTIVE_ROW)

/* Distances that differ by no more count as equal: switches around a link are equally far from its axis,
 * often as far as a threshold, and rounding must not decide. */
#define PG_SAME_DISTANCE 1e-9 /* [m] */

/* Distances beyond which something changes, by schedule. */
#if PG_SCHEDULE_DAMPER
#define PG_ONSET(parameters)      ((parameters)->damper_influence)
#define PG_D_DISTANT(parameters)  ((parameters)->damper_safety + PG_SAME_DISTANCE)
#define PG_D_CRITICAL(parameters) ((parameters)->damper_safety + PG_SAME_DISTANCE)
#else
#define PG_ONSET(parameters)      ((parameters)->d_a)
#define PG_D_DISTANT(parameters)  ((parameters)->d_0u + PG_SAME_DISTANCE)
#define PG_D_CRITICAL(parameters) ((parameters)->d_r + PG_SAME_DISTANCE)
#endif
#define PG_D_ON(parameters)     (PG_ONSET(parameters) + PG_SAME_DISTANCE)
#define PG_D_ACTIVE(parameters) ((parameters)->d_active + PG_SAME_DISTANCE)

/* 1 if q is finite and no further outside its limits than the tolerance: bounds by position mean
 * something. */
int pg_within_joint_limits(const pg_parameters_t *p, const double q[PG_N]);

/* Step 0: PG_SOLVED if the input can be used, else the fault. Takes note of the time. */
pg_status_t pg_check_input(pg_controller_t *controller, const double q[PG_N], const double xdot[PG_M],
                           const pg_measurement_t *seen);

/* Steps 2 and 3: PG_SOLVED, or PG_FAULT_OBSTACLE_INSIDE. Needs the kinematics of step 1. */
pg_status_t pg_find_nearest(pg_controller_t *controller, const pg_measurement_t *seen);

#if PG_CIRCULATION || PG_BASELINE
/* The capsule with the nearest point, the first of equals; -1: none is as near as `reach`. */
int pg_nearest_capsule(const pg_controller_t *controller, double reach);
#endif

/* Self-measurement removal: 1 if the arm itself explains what range sensor `sensor` reads, or that switch
 * `sensor` is closed. The axes are those of the capsules in the world. */
int pg_range_shows_arm(const pg_controller_t *controller, const pg_segment_t axes[PG_CAPSULES], int sensor,
                       double reading);
int pg_switch_shows_arm(const pg_controller_t *controller, const pg_segment_t axes[PG_CAPSULES], int sensor);

/* Memory of seen points: frees slots that are old, in the arm, or seen through; stores a point of a range
 * sensor. The controller then takes the points of all used slots for obstacles. */
void pg_memory_forget(pg_controller_t *controller, const pg_segment_t axes[PG_CAPSULES],
                      const pg_measurement_t *seen);
void pg_memory_store(pg_controller_t *controller, const pg_segment_t axes[PG_CAPSULES], const double point[3],
                     double time);

/* Circulation: the task velocity to be used in place of `wanted`. Needs step 3. */
void pg_circulate(pg_controller_t *controller, const double wanted[PG_M], double xdot[PG_M]);
void pg_circulation_reset(pg_circulation_t *circulation);

/* Step 4, for a task velocity. In rows.c or baselines.c, as the robot's method is. */
void pg_write_rows(pg_controller_t *controller, const double xdot[PG_M]);

#if PG_SELF_POINTS
/* Steps 3 and 4 for the points that the arm carries. */
pg_status_t pg_find_nearest_self(pg_controller_t *controller);
void pg_write_self_rows(pg_controller_t *controller);
#endif

/* The stage of the ladder from which a row that is on is dropped; PG_KEPT: none. */
pg_status_t pg_dropped_at(const pg_controller_t *controller, int slot);
#define PG_KEPT PG_STOPPED_INFEASIBLE

/* Right-hand sides below are raised to it where the ladder gives up repulsion. */
#define PG_RAISED (PG_BASELINE ? PG_WIDTH : 0.0)

/* The equalities of baselines.c hold up to this, so that their two rows are not exact opposites. */
#define PG_WIDTH 1e-5 /* [m/s] */

/* Steps 6 and 7: leaves a certified solution and returns its stage, or the reason why there is none. In
 * ladder.c or slack.c, as the robot's relaxation is. */
pg_status_t pg_find_velocity(pg_controller_t *controller);

/* Solves a QP that is loaded: PG_OPTIMAL, with a certificate, PG_INFEASIBLE, or PG_UNSOLVED. */
pg_outcome_t pg_solve(pg_controller_t *controller, const pg_qp_t *qp);

/* The QP of the cycle, with the right-hand sides of the stage that is being solved. */
static inline pg_qp_t pg_stage_of(const pg_controller_t *controller) {
  const pg_diagnostics_t *cycle = &controller->cycle;
  return (pg_qp_t){.H = cycle->H,
                   .g = cycle->g,
                   .A = cycle->A,
                   .lb = cycle->lb,
                   .ub = cycle->ub,
                   .ubA = controller->ubA,
                   .softness = controller->softness};
}

/* Greatest violation of the optimality conditions (KKT) by a solution; infinity if it is not finite. */
double pg_kkt_residual(const pg_qp_t *qp, const pg_solution_t *solution);

/* Puts a solution within its bounds and takes out its rounding errors, if there are any to speak of; returns
 * its residual. */
double pg_polish(const pg_qp_t *qp, pg_solution_t *solution);

/* 1 if the rows, weighed with y >= 0, contradict each other within the bounds by more than the tolerance. */
int pg_proves_infeasible(const pg_qp_t *qp, const double y[PG_ROWS]);

typedef enum {
  PG_FEASIBLE,      /* an x was found that meets all rows */
  PG_CONTRADICTORY, /* weights were found that prove the rows infeasible */
  PG_UNDECIDED      /* neither in this time */
} pg_verdict_t;

/* Looks for one or the other in up to `sweeps` rounds over the joints. */
pg_verdict_t pg_search(const pg_qp_t *qp, int sweeps);

/* 1 if every parameter is in its range and in order with the others. */
int pg_parameters_allowed(const pg_parameters_t *parameters);

#endif
