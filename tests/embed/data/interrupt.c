/* Loaded before a program (LD_PRELOAD): a signal interrupts its sleep five thousand times a second. */
#define _XOPEN_SOURCE 700
#include <signal.h>
#include <stddef.h>
#include <sys/time.h>

static void ignore(int signal) {
  (void)signal;
}

__attribute__((constructor)) static void begin(void) {
  const struct sigaction action = {.sa_handler = ignore}; /* without SA_RESTART */
  const struct itimerval often = {.it_interval = {.tv_usec = 200}, .it_value = {.tv_usec = 200}};
  sigaction(SIGALRM, &action, NULL);
  setitimer(ITIMER_REAL, &often, NULL);
}
