/* Binds the names that runtime/ uses to the robot `planar`: a hand-written stand-in for what proxgen
 * generates. */
#ifndef PLANAR_BINDING_H
#define PLANAR_BINDING_H

#include "controller.h"
#include "model.h"

#define PG_MODEL_ABI  1
#define PG_NAME(name) planar_##name

#define PG_N          PLANAR_JOINTS
#define PG_M          PLANAR_TASK_ROWS
#define PG_BODIES     PLANAR_BODIES
#define PG_CAPSULES   PLANAR_CAPSULES
#define PG_TOF        PLANAR_TOF
#define PG_CAPACITIVE PLANAR_CAPACITIVE
#define PG_MAX_POINTS PLANAR_MAX_POINTS
#define PG_ROWS       PLANAR_ROWS

/* Variants that a test compiles; the first is what `planar` is without any. */
#ifndef PG_RELAXATION_SLACK
#define PG_RELAXATION_SLACK 0
#endif
#define PG_ACTIVE_ROW      PLANAR_ACTIVE_ROW
#define PG_SCHEDULE_DAMPER PLANAR_SCHEDULE_DAMPER
#ifndef PG_MAX_ITERATIONS
#define PG_MAX_ITERATIONS 100
#endif
#ifndef PG_TOLERANCE
#define PG_TOLERANCE 1e-8
#endif
#if PLANAR_SELF_COLLISION
#define PG_SELF_POINTS PLANAR_SELF_POINTS
#endif
#if PLANAR_SELF_MEASUREMENT
#define PG_SELF_MEASUREMENT 1
#endif
#if PLANAR_MEMORY
#define PG_MEMORY_CAPACITY PLANAR_MEMORY_CAPACITY
#endif
#if PLANAR_CIRCULATION
#define PG_CIRCULATION 1
#define PG_LINEAR_ROWS {0, 1, -1}
#endif
#if PLANAR_REPULSIVE
#define PG_METHOD_REPULSIVE 1
#endif
#if PLANAR_TANGENTIAL
#define PG_METHOD_TANGENTIAL 1
#define PG_LINEAR_ROWS       {0, 1, -1}
#endif

#define PG_INTERFACE         PLANAR_INTERFACE
#define PG_GENERATOR_VERSION PLANAR_GENERATOR_VERSION
#define PG_CONFIG_HASH       PLANAR_CONFIG_HASH
#define PG_MEMORY_SIZE       PLANAR_MEMORY_SIZE
#define PG_SOLVER_MEMORY     PLANAR_SOLVER_MEMORY

/* Types. */
#define pg_parameters_t  planar_parameters_t
#define pg_kinematics_t  planar_kinematics_t
#define pg_measurement_t planar_measurement_t
#define pg_diagnostics_t planar_diagnostics_t
#define pg_counters_t    planar_counters_t
#define pg_version_t     planar_version_t
#define pg_controller_t  planar_controller_t

/* Functions and tables of model.h. */
#define pg_model_kinematics         planar_kinematics
#define pg_model_row                planar_row
#define pg_model_objective          planar_objective
#define pg_model_bounds             planar_bounds
#define pg_model_approach_speed     planar_approach_speed
#define pg_model_slack_weight       planar_slack_weight
#define pg_model_closest_point      planar_closest_point
#define pg_model_sensor_point       planar_sensor_point
#define pg_model_capsules           planar_capsules
#define pg_model_tof                planar_tof
#define pg_model_capacitive         planar_capacitive
#define pg_model_default_parameters planar_default_parameters
#define pg_model_lower_parameters   planar_lower_parameters
#define pg_model_upper_parameters   planar_upper_parameters

/* Of additions. */
#define pg_model_tof_rays            planar_tof_rays
#define pg_model_capacitive_cones    planar_capacitive_cones
#define pg_model_tof_see_through     planar_tof_see_through
#define pg_model_self_points         planar_self_points
#define pg_model_self_pairs          planar_self_pairs
#define pg_model_self_row            planar_self_row
#define pg_model_self_approach_speed planar_self_approach_speed
#define pg_model_self_slack_weight   planar_self_slack_weight

/* Functions of controller.h, which runtime/ defines. */
#define pg_create_checked    planar_create_checked
#define pg_create_in_checked planar_create_in_checked
#define pg_destroy           planar_destroy
#define pg_reset             planar_reset
#define pg_step              planar_step
#define pg_get_parameters    planar_get_parameters
#define pg_set_parameters    planar_set_parameters
#define pg_diagnostics       planar_diagnostics
#define pg_counters          planar_counters
#define pg_version           planar_version
#define pg_status_name       planar_status_name

#endif
