/* Replays a recorded run through a controller, and writes what it commands: the same program everywhere.
 *
 * inputs.bin holds doubles: how many cycles, how many points a cycle has room for, then cycle by cycle
 *     time, q, xdot, tof_range, tof_age, capacitive (0 or 1), capacitive_age, point_count, points.
 * outputs.bin gets doubles: instructions of a thousand empty ones (0 where they are not counted), then cycle
 * by cycle status, instructions, qdot, and in the end the deepest stack [bytes].
 *
 * Everything is allocated statically; nothing comes from a heap. */
#include "binding.h" /* controller.h, with names that are the same for every robot */
#include "board.h"

enum { N = PG_N, M = PG_M, TOF = PG_TOF, SWITCHES = PG_CAPACITIVE };

/* One cycle of inputs.bin. */
typedef struct {
  double time;
  double q[N];
  double xdot[M];
  double tof_range[TOF];
  double tof_age[TOF];
  double capacitive[SWITCHES];
  double capacitive_age[SWITCHES];
  double point_count;
} record_t;

static _Alignas(16) unsigned char memory[PG_MEMORY_SIZE];
static record_t record;
static double points[3 * PG_MAX_POINTS + 1];
static unsigned char switches[SWITCHES];

static int replay_cycle(pg_controller_t *controller) {
  for (int i = 0; i < SWITCHES; i++)
    switches[i] = record.capacitive[i] != 0.0;
  const pg_measurement_t seen = {.time = record.time,
                                 .tof_range = record.tof_range,
                                 .capacitive = switches,
                                 .tof_age = record.tof_age,
                                 .capacitive_age = record.capacitive_age,
                                 .points = points,
                                 .point_count = (int)record.point_count};
  double output[2 + N];
  board_start_counting();
  output[0] = (double)pg_step(controller, record.q, record.xdot, &seen, &output[2]);
  output[1] = board_instructions();
  return board_write(output, 2 + N);
}

/* What the counter is checked against. */
__attribute__((noinline)) static void thousand_instructions(void) {
  __asm__ volatile(".rept 1000\n nop\n .endr");
}

int main(void) {
  pg_controller_t *controller;
  double head[2]; /* cycles, room */
  if (board_open() || board_read(head, 2) || head[1] > PG_MAX_POINTS) return 1;
  if (PG_NAME(create_in)(memory, sizeof memory, &controller) != PG_SOLVED) return 2;
  board_start_counting();
  thousand_instructions();
  const double thousand = board_instructions();
  if (board_write(&thousand, 1)) return 3;
  for (int i = 0; i < (int)head[0]; i++)
    if (board_read((double *)&record, (int)(sizeof record / sizeof(double))) ||
        board_read(points, 3 * (int)head[1]) || replay_cycle(controller))
      return 4;
  const double stack = board_stack();
  if (board_write(&stack, 1) || board_close()) return 5;
  return pg_destroy(controller) != PG_SOLVED;
}
