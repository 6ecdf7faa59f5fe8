/* What can be asked of a controller and of the library. */
#include "state.h"

pg_status_t pg_diagnostics(const pg_controller_t *controller, const pg_diagnostics_t **diagnostics) {
  if (!pg_alive(controller) || !diagnostics) return PG_ERROR_NULL;
  *diagnostics = &controller->cycle;
  return PG_SOLVED;
}

pg_status_t pg_counters(const pg_controller_t *controller, pg_counters_t *counters) {
  if (!pg_alive(controller) || !counters) return PG_ERROR_NULL;
  *counters = controller->counters;
  return PG_SOLVED;
}

pg_status_t pg_version(pg_version_t *version) {
  if (!version) return PG_ERROR_NULL;
  version->abi = PG_ABI_VERSION;
  version->proxgen = PG_GENERATOR_VERSION;
  version->config_hash = PG_CONFIG_HASH;
  version->solver = pg_solver_name;
  return PG_SOLVED;
}

const char *pg_status_name(pg_status_t status) {
  switch (status) {
  case PG_SOLVED:
    return "SOLVED";
  case PG_REDUCED_ACTIVE:
    return "REDUCED_ACTIVE";
  case PG_REDUCED_DISTANT:
    return "REDUCED_DISTANT";
  case PG_REDUCED_REPULSION:
    return "REDUCED_REPULSION";
  case PG_REDUCED_CRITICAL:
    return "REDUCED_CRITICAL";
  case PG_STOPPED_INFEASIBLE:
    return "STOPPED_INFEASIBLE";
  case PG_STOPPED_SOLVER:
    return "STOPPED_SOLVER";
  case PG_FAULT_NOT_FINITE:
    return "FAULT_NOT_FINITE";
  case PG_FAULT_JOINT_LIMIT:
    return "FAULT_JOINT_LIMIT";
  case PG_FAULT_READING:
    return "FAULT_READING";
  case PG_FAULT_STALE:
    return "FAULT_STALE";
  case PG_FAULT_TIME:
    return "FAULT_TIME";
  case PG_FAULT_DEADLINE:
    return "FAULT_DEADLINE";
  case PG_FAULT_OBSTACLE_INSIDE:
    return "FAULT_OBSTACLE_INSIDE";
  case PG_ERROR_NULL:
    return "ERROR_NULL";
  case PG_ERROR_SIZE:
    return "ERROR_SIZE";
  case PG_ERROR_PARAMETER:
    return "ERROR_PARAMETER";
  case PG_ERROR_MEMORY:
    return "ERROR_MEMORY";
  case PG_ERROR_ABI:
    return "ERROR_ABI";
  }
  return "UNKNOWN";
}
