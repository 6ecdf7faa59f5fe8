/* The life of a controller: created, reset, asked, destroyed. */
#include "state.h"

#include <stdint.h>
#include <string.h>

#define ALIGNMENT 16
_Static_assert(sizeof(pg_controller_t) + ALIGNMENT <= PG_MEMORY_SIZE,
               "the size in controller.h is too small");
_Static_assert(_Alignof(pg_controller_t) <= ALIGNMENT, "the controller needs a stricter alignment");

/* Forgets everything that a cycle leaves to the next one. */
static void forget(pg_controller_t *controller) {
  memset(controller->qdot_previous, 0, sizeof controller->qdot_previous);
  controller->has_time = 0;
  controller->time_previous = 0.0;
#if PG_MEMORY_CAPACITY > 0
  memset(controller->memory, 0, sizeof controller->memory);
#endif
#if PG_CIRCULATION
  pg_circulation_reset(&controller->circulation);
#endif
#if PG_METHOD_TANGENTIAL
  memset(controller->tangent, 0, sizeof controller->tangent);
#endif
  pg_solver_reset(controller->solver);
}

/* A row that was never on has a direction all the same: no row is ever zero. */
static void give_rows_a_direction(pg_diagnostics_t *cycle) {
  for (int slot = 0; slot < PG_ROWS; slot++) {
    cycle->A[slot * PG_N + slot % PG_N] = 1.0;
    cycle->ubA[slot] = PG_OFF;
  }
}

pg_status_t pg_create_in_checked(void *memory, size_t size, pg_controller_t **controller,
                                 unsigned long long interface_number) {
  if (!controller) return PG_ERROR_NULL;
  *controller = NULL;
  if (interface_number != PG_INTERFACE) return PG_ERROR_ABI;
  if (!memory) return PG_ERROR_NULL;
  if (size < PG_MEMORY_SIZE) return PG_ERROR_SIZE;

  const uintptr_t misaligned = (uintptr_t)memory % ALIGNMENT;
  void *aligned = (unsigned char *)memory + (misaligned ? ALIGNMENT - misaligned : 0);
  pg_controller_t *made = aligned;
  memset(made, 0, sizeof *made);
  made->parameters = pg_model_default_parameters;
  give_rows_a_direction(&made->cycle);
  const pg_status_t status = pg_solver_create(made->solver_memory, &made->solver);
  if (status != PG_SOLVED) return status;
  forget(made);
  *controller = made;
  return PG_SOLVED;
}

pg_status_t pg_destroy(pg_controller_t *controller) {
  if (!pg_alive(controller)) return PG_SOLVED;
  pg_solver_destroy(controller->solver);
  controller->solver = NULL; /* a caller's block can be seen to hold no controller */
  if (controller->release) controller->release(controller->block);
  return PG_SOLVED;
}

pg_status_t pg_reset(pg_controller_t *controller) {
  if (!pg_alive(controller)) return PG_ERROR_NULL;
  forget(controller);
  return PG_SOLVED;
}
