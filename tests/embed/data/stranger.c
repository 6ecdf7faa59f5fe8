/* Turns the first joint until something is 0.2 m in front of the third range sensor. */
#include <iiwa7/controller.h>
#include <stdio.h>

#define PERIOD 0.02

static unsigned char block[IIWA7_MEMORY_SIZE];

int main(void) {
  iiwa7_controller_t *arm;
  pg_status_t status = iiwa7_create_in(block, sizeof block, &arm);
  if (status != PG_SOLVED) {
    fprintf(stderr, "cannot create: %s\n", iiwa7_status_name(status));
    return 1;
  }

  double position[IIWA7_JOINTS] = {0.0, 0.5, 0.0, -1.5, 0.0, 1.0, 0.0}, velocity[IIWA7_JOINTS];
  double range[IIWA7_TOF];
  unsigned char closed[IIWA7_CAPACITIVE] = {0};
  double wanted[IIWA7_TASK_ROWS] = {0.0, 0.15, 0.0};
  int stops = 0, cycle;

  for (cycle = 1; cycle <= 150; cycle++) {
    for (int i = 0; i < IIWA7_TOF; i++)
      range[i] = iiwa7_tof[i].range;
    if (cycle > 75) range[2] = 0.2;
    iiwa7_measurement_t seen = {.time = PERIOD * cycle, .tof_range = range, .capacitive = closed};
    status = iiwa7_step(arm, position, wanted, &seen, velocity);
    if (status < 0) return 2; /* called wrongly */
    stops += status >= PG_STOPPED_INFEASIBLE;
    for (int j = 0; j < IIWA7_JOINTS; j++)
      position[j] += PERIOD * velocity[j];
    if (cycle == 75 && !(position[0] > 0.2)) return 3; /* has not moved */
  }
  printf("%d cycles, %d stops, joint 1 at %.4f rad\n", cycle - 1, stops, position[0]);
  return iiwa7_destroy(arm) != PG_SOLVED;
}
