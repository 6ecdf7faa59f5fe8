/* Types and numbers that are the same for every robot: the vocabulary of the generated and the hand-written
 * C.
 *
 * Positions in metres, joint positions in radians (metres for a prismatic joint), velocities per second.
 * Matrices are row-major. Nothing here has state.
 */
#ifndef PROXGEN_TYPES_H
#define PROXGEN_TYPES_H

#ifdef __cplusplus
extern "C" {
#endif

/* Changes whenever the meaning or layout of anything between generated code and runtime changes. */
#define PG_ABI_VERSION 1

/* Stands for infinity in bounds: a row that is off has ubA = PG_OFF. */
#define PG_OFF 1e20

/* How a cycle ended. 0..7: q_dot solves a certified QP; 8..15: stopped; 16..31: input refused, braking to a
 * stop; negative: the call itself was wrong (a step then brakes, too, as far as it can). */
typedef enum {
  PG_SOLVED = 0,                 /* all rows hold */
  PG_REDUCED_ACTIVE = 1,         /* without the active row (7) */
  PG_REDUCED_DISTANT = 2,        /* and without rows beyond d_0u */
  PG_REDUCED_REPULSION = 3,      /* and repulsive right-hand sides raised to 0 */
  PG_REDUCED_CRITICAL = 4,       /* and only rows at or below d_r */
  PG_STOPPED_INFEASIBLE = 8,     /* no stage is feasible */
  PG_STOPPED_SOLVER = 9,         /* no stage gave a result that passes the certificate */
  PG_FAULT_NOT_FINITE = 16,      /* NaN or infinity in the input */
  PG_FAULT_JOINT_LIMIT = 17,     /* q outside its limits by more than limit_tolerance */
  PG_FAULT_READING = 18,         /* a reading below 0 or beyond the sensor's range, or a negative age */
  PG_FAULT_STALE = 19,           /* a reading older than sensor_timeout */
  PG_FAULT_TIME = 20,            /* time did not advance */
  PG_FAULT_DEADLINE = 21,        /* more than max_period since the last cycle */
  PG_FAULT_OBSTACLE_INSIDE = 22, /* an obstacle point on a link's axis: no direction to leave it */
  PG_ERROR_NULL = -1,            /* a pointer is NULL, or the controller was destroyed */
  PG_ERROR_SIZE = -2,            /* a memory block too small, or more points than the capacity */
  PG_ERROR_PARAMETER = -3,       /* a parameter outside its range; nothing was changed */
  PG_ERROR_MEMORY = -4,          /* memory could not be obtained */
  PG_ERROR_ABI = -5              /* header and library of different versions */
} pg_status_t;

/* A link's capsule: all points within `radius` of the segment from `start` to `end`, in the body's frame. */
typedef struct {
  int body;                /* row of body_to_world */
  double start[3];         /* [m] body frame */
  double end[3];           /* [m] body frame */
  double radius;           /* [m] */
  double reference_radius; /* [m] subtracted from the distance to the axis: 0 or radius */
} pg_capsule_t;

/* A sensor: where it sits, where it looks. */
typedef struct {
  int body;           /* row of body_to_world */
  double position[3]; /* [m] body frame */
  double normal[3];   /* unit vector, body frame */
  double range;       /* [m] greatest reading of a range sensor; virtual distance of a switch */
} pg_sensor_t;

/* A point, or a ball, that the arm carries and that its other links must not touch. */
typedef struct {
  int body;           /* row of body_to_world */
  double position[3]; /* [m] body frame */
  double radius;      /* [m] of the ball; 0 for a point */
} pg_self_point_t;

/* Where a switch notices something, of robots that remove what their sensors see of themselves. */
typedef struct {
  double reach;  /* [m] */
  double cosine; /* of half the opening angle around the normal */
} pg_cone_t;

#ifdef __cplusplus
}
#endif
#endif
