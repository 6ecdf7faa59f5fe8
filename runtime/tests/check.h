/* The smallest harness that does: a failed check says where, and the program goes on; main returns the
 * verdict. */
#ifndef PROXGEN_CHECK_H
#define PROXGEN_CHECK_H

#include <math.h>
#include <stdio.h>

static int checks_failed;

static inline void check(int holds, const char *text, const char *file, int line) {
  if (holds) return;
  checks_failed++;
  printf("%s:%d: failed: %s\n", file, line, text);
}

static inline void check_near(double value, double wanted, double tolerance, const char *text,
                              const char *file, int line) {
  if (fabs(value - wanted) <= tolerance) return;
  checks_failed++;
  printf("%s:%d: failed: %s is %.17g, not %.17g\n", file, line, text, value, wanted);
}

#define CHECK(condition) check((condition), #condition, __FILE__, __LINE__)
#define CHECK_EQUAL(value, wanted)                                                                           \
  check_near((double)(value), (double)(wanted), 0.0, #value, __FILE__, __LINE__)
#define CHECK_NEAR(value, wanted, tol) check_near((value), (wanted), (tol), #value, __FILE__, __LINE__)

/* A fixed pseudo-random sequence (xorshift64), the same on every machine. */
typedef struct {
  unsigned long long state;
} random_t;

static inline double between(random_t *random, double low, double high) {
  random->state ^= random->state << 13;
  random->state ^= random->state >> 7;
  random->state ^= random->state << 17;
  return low + (high - low) * (double)(random->state >> 11) / 9007199254740992.0;
}

#endif
