/* The robot that this copy of the runtime is compiled for, and the names of everything inside it.
 *
 * "binding.h" comes from the robot's generated folder. All internal functions carry the robot's prefix too,
 * so that the controllers of two robots link into one program. */
#ifndef PROXGEN_ROBOT_H
#define PROXGEN_ROBOT_H

#include "binding.h"
#include "proxgen/types.h"

#if PG_MODEL_ABI != PG_ABI_VERSION
#error "generated code and runtime are of different versions: run `proxgen generate` again"
#endif

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error                                                                                                       \
    "-ffast-math and -ffinite-math-only remove the checks for NaN and infinity on which this runtime relies"
#endif

/* Doubles, where the macros of C are floats: compilers may be asked to warn of what becomes a double by
 * itself. */
#define PG_INFINITY ((double)INFINITY)
#define PG_NAN      ((double)NAN)

#define pg_check_input         PG_NAME(internal_check_input)
#define pg_within_joint_limits PG_NAME(internal_within_joint_limits)
#define pg_find_nearest        PG_NAME(internal_find_nearest)
#define pg_write_rows          PG_NAME(internal_write_rows)
#define pg_find_velocity       PG_NAME(internal_find_velocity)
#define pg_solve               PG_NAME(internal_solve)
#define pg_kkt_residual        PG_NAME(internal_kkt_residual)
#define pg_polish              PG_NAME(internal_polish)
#define pg_proves_infeasible   PG_NAME(internal_proves_infeasible)
#define pg_search              PG_NAME(internal_search)
#define pg_parameters_allowed  PG_NAME(internal_parameters_allowed)
#define pg_solver_name         PG_NAME(internal_solver_name)
#define pg_solver_create       PG_NAME(internal_solver_create)
#define pg_solver_destroy      PG_NAME(internal_solver_destroy)
#define pg_solver_reset        PG_NAME(internal_solver_reset)
#define pg_solver_load         PG_NAME(internal_solver_load)
#define pg_solver_is_at_hand   PG_NAME(internal_solver_is_at_hand)
#define pg_solver_solve        PG_NAME(internal_solver_solve)
#define pg_test_hook           PG_NAME(internal_test_hook)

/* Additions that binding.h does not name are off, and nothing of them is compiled. */
#ifndef PG_SELF_POINTS
#define PG_SELF_POINTS 0
#endif
#ifndef PG_METHOD_REPULSIVE
#define PG_METHOD_REPULSIVE 0
#endif
#ifndef PG_METHOD_TANGENTIAL
#define PG_METHOD_TANGENTIAL 0
#endif
#define PG_BASELINE (PG_METHOD_REPULSIVE || PG_METHOD_TANGENTIAL)
#ifndef PG_SELF_MEASUREMENT
#define PG_SELF_MEASUREMENT 0
#endif
#ifndef PG_MEMORY_CAPACITY
#define PG_MEMORY_CAPACITY 0
#endif
#ifndef PG_CIRCULATION
#define PG_CIRCULATION 0
#endif

#define pg_nearest_capsule   PG_NAME(internal_nearest_capsule)
#define pg_find_nearest_self PG_NAME(internal_find_nearest_self)
#define pg_write_self_rows   PG_NAME(internal_write_self_rows)
#define pg_dropped_at        PG_NAME(internal_dropped_at)
#define pg_range_shows_arm   PG_NAME(internal_range_shows_arm)
#define pg_switch_shows_arm  PG_NAME(internal_switch_shows_arm)
#define pg_memory_forget     PG_NAME(internal_memory_forget)
#define pg_memory_store      PG_NAME(internal_memory_store)
#define pg_circulate         PG_NAME(internal_circulate)
#define pg_circulation_reset PG_NAME(internal_circulation_reset)
#define pg_basis             PG_NAME(internal_basis)
#define pg_tangents          PG_NAME(internal_tangents)
#define pg_linear_part       PG_NAME(internal_linear_part)
#define pg_set_linear_part   PG_NAME(internal_set_linear_part)
#define pg_only_task_axes    PG_NAME(internal_only_task_axes)

#endif
