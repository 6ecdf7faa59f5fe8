/* A hand-written stand-in for a generated model: a planar arm of two links, joints about z at (0,0,0) and
 * (LENGTH,0,0), tool at the end of the second link. Three capsules: both links, and a sphere at the elbow
 * that moves with the first, so that two rows are always parallel. Four range sensors and two switches.
 *
 * As variants: with PLANAR_SELF_COLLISION the tool, a ball, must not touch the upper arm, nor the forearm a
 * ball beside the upper arm; with PLANAR_SELF_MEASUREMENT, PLANAR_MEMORY and PLANAR_CIRCULATION there are
 * those additions; with PLANAR_REPULSIVE or PLANAR_TANGENTIAL it has the rows of that method. Its range
 * sensors open at 60 degrees, its switches at 120. */
#ifndef PLANAR_MODEL_H
#define PLANAR_MODEL_H

#include "proxgen/types.h"

#ifdef __cplusplus
extern "C" {
#endif

#define PLANAR_JOINTS     2
#define PLANAR_TASK_ROWS  2
#define PLANAR_BODIES     2
#define PLANAR_CAPSULES   3
#define PLANAR_TOF        4
#define PLANAR_CAPACITIVE 2
#define PLANAR_MAX_POINTS 8
#define PLANAR_LENGTH     0.5 /* [m] of each link */
#if PLANAR_MEMORY
#define PLANAR_MEMORY_CAPACITY 3
#endif

#if PLANAR_REPULSIVE || PLANAR_TANGENTIAL
#define PLANAR_ACTIVE_ROW 0
#endif
#ifndef PLANAR_ACTIVE_ROW
#define PLANAR_ACTIVE_ROW 1
#endif
#ifndef PLANAR_SCHEDULE_DAMPER
#define PLANAR_SCHEDULE_DAMPER 0
#endif
#if PLANAR_SELF_COLLISION
#define PLANAR_SELF_POINTS 2
#define PLANAR_ROWS        (2 * PLANAR_CAPSULES + PLANAR_ACTIVE_ROW)
#elif PLANAR_REPULSIVE
#define PLANAR_ROWS 6
#elif PLANAR_TANGENTIAL
#define PLANAR_ROWS 5
#else
#define PLANAR_ROWS (PLANAR_CAPSULES + PLANAR_ACTIVE_ROW)
#endif

/* In the order and with the meaning of the table of parameters in docs/method.md. */
typedef struct {
  double q_lower[2], q_upper[2], qdot_limit[2], qddot_limit[2];
  double joint_damper, viability, limit_tolerance;
  double period, max_period, sensor_timeout;
  double d_a, d_0u, d_0l, d_r, approach_speed, repulse_speed;
  double damper_influence, damper_safety, damper_gain, damper_repulse_speed;
  double row_speed, d_active;
  double damping_gain, damping_threshold, damping_floor;
  double slack_weight, slack_minimum, slack_maximum, slack_active_weight;
  double posture_weight[2], posture_gain, posture[2];
#if PLANAR_SELF_COLLISION
  double self_d_a, self_d_0u, self_d_0l, self_d_r;
#endif
#if PLANAR_SELF_MEASUREMENT
  double self_measurement_margin;
#endif
#if PLANAR_MEMORY
  double memory_age, memory_merge, memory_margin, memory_reach;
#endif
#if PLANAR_CIRCULATION
  double circulation_speed, stall_time, stall_fraction, circulation_release_time, circulation_patience;
  double circulation_time_limit, circulation_blend_time;
  double circulation_bias_x, circulation_bias_y, circulation_bias_z;
#endif
#if PLANAR_TANGENTIAL
  double tangential_speed;
#endif
} planar_parameters_t;

extern const planar_parameters_t planar_default_parameters, planar_lower_parameters, planar_upper_parameters;

typedef struct {
  double tool_to_world[12];
  double body_to_world[PLANAR_BODIES][12];
  double joint_axis[PLANAR_JOINTS][3];
  double joint_origin[PLANAR_JOINTS][3];
  double J[PLANAR_TASK_ROWS * PLANAR_JOINTS];
} planar_kinematics_t;

extern const pg_capsule_t planar_capsules[PLANAR_CAPSULES];
extern const pg_sensor_t planar_tof[PLANAR_TOF];
extern const pg_sensor_t planar_capacitive[PLANAR_CAPACITIVE];
#if PLANAR_SELF_MEASUREMENT
extern const double planar_tof_rays[PLANAR_TOF][5][3];
extern const pg_cone_t planar_capacitive_cones[PLANAR_CAPACITIVE];
#endif
#if PLANAR_MEMORY
extern const double planar_tof_see_through[PLANAR_TOF];
#endif

#if PLANAR_SELF_COLLISION
extern const pg_self_point_t planar_self_points[PLANAR_SELF_POINTS];
extern const unsigned char planar_self_pairs[PLANAR_SELF_POINTS][PLANAR_CAPSULES];

int planar_self_row(int body, int carrier, const planar_kinematics_t *kinematics, const double point[3],
                    const double carried[3], const double direction[3], double row[2]);
int planar_self_approach_speed(const planar_parameters_t *p, double distance, double *speed);
int planar_self_slack_weight(const planar_parameters_t *p, double distance, double *weight);
#endif

int planar_kinematics(const double q[2], planar_kinematics_t *kinematics);
int planar_row(int body, const planar_kinematics_t *kinematics, const double point[3],
               const double direction[3], double row[2]);
int planar_objective(const planar_parameters_t *p, const planar_kinematics_t *kinematics, const double q[2],
                     const double xdot[2], double H[4], double g[2], double *manipulability, double *damping);
int planar_bounds(const planar_parameters_t *p, const double q[2], const double qdot_previous[2],
                  double lb[2], double ub[2]);
int planar_approach_speed(const planar_parameters_t *p, double distance, double *speed);
int planar_slack_weight(const planar_parameters_t *p, double distance, double *weight);
int planar_closest_point(const double point[3], const double start[3], const double end[3],
                         double closest[3]);
int planar_sensor_point(const double body_to_world[12], const double position[3], const double normal[3],
                        double range, double point[3]);

#ifdef __cplusplus
}
#endif
#endif
