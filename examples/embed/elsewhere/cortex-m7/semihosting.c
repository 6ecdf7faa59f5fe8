/* The board where it is a Cortex-M7 behind a debugger or an emulator: files by semihosting, time by SysTick.
 */
#include "../board.h"

#include <stdint.h>
#include <string.h>

void board_exit(int status);

/* "Semihosting for AArch32 and AArch64", Arm: operations and how they are called. */
enum { SYS_OPEN = 0x01, SYS_CLOSE = 0x02, SYS_WRITE = 0x05, SYS_READ = 0x06, SYS_EXIT_EXTENDED = 0x20 };
enum { READ_BINARY = 1, WRITE_BINARY = 5, APPLICATION_EXIT = 0x20026 };

static int32_t semihost(int32_t operation, const void *block) {
  register int32_t r0 __asm__("r0") = operation;
  register const void *r1 __asm__("r1") = block;
  __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

static int32_t inputs, outputs;

static int32_t open(const char *name, uint32_t mode) {
  const uint32_t block[] = {(uint32_t)name, mode, strlen(name)};
  return semihost(SYS_OPEN, block);
}

/* SYS_READ and SYS_WRITE answer how many bytes they left over. */
static int move(int32_t operation, int32_t file, const double *values, int count) {
  const uint32_t block[] = {(uint32_t)file, (uint32_t)values, (uint32_t)count * sizeof *values};
  return count > 0 && semihost(operation, block) != 0;
}

int board_read(double *values, int count) {
  return move(SYS_READ, inputs, values, count);
}

int board_write(const double *values, int count) {
  return move(SYS_WRITE, outputs, values, count);
}

int board_close(void) {
  const uint32_t block[] = {(uint32_t)outputs};
  return semihost(SYS_CLOSE, block) != 0;
}

void board_exit(int status) {
  const uint32_t block[] = {APPLICATION_EXIT, (uint32_t)status};
  semihost(SYS_EXIT_EXTENDED, block);
  for (;;) {
  }
}

static struct {
  volatile uint32_t control, reload, current;
} *const systick = (void *)0xE000E010;

enum { ENABLE_FROM_PROCESSOR_CLOCK = 1 | 4, GREATEST = 0xFFFFFF };

/* The emulator is run with 64 ns of its time per instruction (-icount shift=6); SysTick counts down the 25
 * MHz of this board's clock, 40 ns: 8 ticks for 5 instructions. It wraps after ten million instructions. */
void board_start_counting(void) {
  systick->current = 0; /* whatever is written: starts anew from the greatest value */
}

double board_instructions(void) {
  return (double)((GREATEST - systick->current) * 5 / 8);
}

int board_open(void) {
  systick->reload = GREATEST;
  systick->control = ENABLE_FROM_PROCESSOR_CLOCK;
  inputs = open("inputs.bin", READ_BINARY);
  outputs = open("outputs.bin", WRITE_BINARY);
  return inputs < 0 || outputs < 0;
}
