/* The only file that uses the heap: leave it out, or let the linker do so, and create_in is the way to a
 * controller. */
#include "state.h"

#include <stdlib.h>

pg_status_t pg_create_checked(pg_controller_t **controller, unsigned long long interface_number) {
  if (!controller) return PG_ERROR_NULL;
  *controller = NULL;
  void *block = malloc(PG_MEMORY_SIZE);
  if (!block) return PG_ERROR_MEMORY;
  const pg_status_t status = pg_create_in_checked(block, PG_MEMORY_SIZE, controller, interface_number);
  if (status != PG_SOLVED) {
    free(block);
    return status;
  }
  (*controller)->block = block;
  (*controller)->release = free;
  return PG_SOLVED;
}
