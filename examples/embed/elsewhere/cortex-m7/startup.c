/* From reset to main on a Cortex-M7: vectors, floating-point unit, memory. */
#include <stdint.h>
#include <string.h>

/* Where mps2-an500.ld puts things. */
extern uint32_t data_image[], data_start[], data_end[], bss_start[], bss_end[], stack_bottom[], stack_top[];

int main(void);
void reset(void);
void board_exit(int status);

static volatile uint32_t *const CPACR = (uint32_t *)0xE000ED88; /* coprocessor access control */
enum { FULL_ACCESS_TO_FPU = 0xF << 20 };

#define UNUSED 0xA5A5A5A5u /* what stack has never been used holds */

/* Any exception means that something went wrong. */
static void fault(void) {
  board_exit(100);
}

__attribute__((section(".vectors"), used)) static const struct {
  uint32_t *stack;
  void (*handlers[15])(void);
} vectors = {stack_top, {reset, fault, fault, fault, fault, fault}};

/* Not part of reset, which must not touch a floating-point register before the unit is on. */
__attribute__((noinline)) static void start(void) {
  memcpy(data_start, data_image, (size_t)((char *)data_end - (char *)data_start));
  memset(bss_start, 0, (size_t)((char *)bss_end - (char *)bss_start));
  board_exit(main());
}

void reset(void) {
  const uint32_t *in_use = (uint32_t *)__builtin_frame_address(0) - 16;
  for (volatile uint32_t *word = stack_bottom; word < in_use; word++)
    *word = UNUSED;
  *CPACR |= FULL_ACCESS_TO_FPU;
  __asm__ volatile("dsb\n isb");
  start();
}

/* Deepest stack so far [bytes]. */
double board_stack(void) {
  const uint32_t *word = stack_bottom;
  while (word < stack_top && *word == UNUSED)
    word++;
  return (double)((const char *)stack_top - (const char *)word);
}
