/* The board where it is an ordinary process, of whichever processor. */
#include "board.h"

#include <stdio.h>

static FILE *inputs, *outputs;

int board_open(void) {
  inputs = fopen("inputs.bin", "rb");
  outputs = fopen("outputs.bin", "wb");
  return !inputs || !outputs;
}

int board_read(double *values, int count) {
  return fread(values, sizeof *values, (size_t)count, inputs) != (size_t)count;
}

int board_write(const double *values, int count) {
  return fwrite(values, sizeof *values, (size_t)count, outputs) != (size_t)count;
}

int board_close(void) {
  return fclose(inputs) + fclose(outputs);
}

void board_start_counting(void) {
}

double board_instructions(void) {
  return 0.0;
}

double board_stack(void) {
  return 0.0;
}
