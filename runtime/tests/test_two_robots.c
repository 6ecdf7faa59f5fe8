/* Two robots, possibly with different solvers, linked into one program. `second` is a copy of the
 * planar arm. */
#include "check.h"

#include "planar/controller.h"
#include "second/controller.h"

#include <string.h>

int main(void) {
  planar_controller_t *first;
  second_controller_t *second;
  CHECK(planar_create(&first) == PG_SOLVED && second_create(&second) == PG_SOLVED);
  planar_parameters_t of_first;
  second_parameters_t of_second;
  CHECK(planar_get_parameters(first, &of_first) == PG_SOLVED);
  of_first.d_a = 0.9; /* the one's parameters are not the other's */
  CHECK(planar_set_parameters(first, &of_first) == PG_SOLVED);
  CHECK(second_get_parameters(second, &of_second) == PG_SOLVED);
  CHECK_EQUAL(of_second.d_a, second_default_parameters.d_a);
  of_first.d_a = planar_default_parameters.d_a;
  CHECK(planar_set_parameters(first, &of_first) == PG_SOLVED);

  random_t random = {51};
  double q[2], xdot[2], qdot[2][2], ranges[PLANAR_TOF];
  unsigned char switches[PLANAR_CAPACITIVE] = {0};
  planar_measurement_t seen = {.tof_range = ranges, .capacitive = switches};
  for (int i = 0; i < 2000; i++) {
    for (int k = 0; k < PLANAR_TOF; k++)
      ranges[k] = between(&random, 0.05, 1.0);
    for (int j = 0; j < 2; j++) {
      q[j] = between(&random, -2.4, 2.4);
      xdot[j] = between(&random, -0.3, 0.3);
    }
    seen.time += 0.02;
    const second_measurement_t same = {.time = seen.time, .tof_range = ranges, .capacitive = switches};
    CHECK_EQUAL(planar_step(first, q, xdot, &seen, qdot[0]), second_step(second, q, xdot, &same, qdot[1]));
    for (int j = 0; j < 2; j++)
      CHECK_NEAR(qdot[0][j], qdot[1][j], 1e-8);
  }
  planar_version_t version;
  second_version_t other;
  CHECK(planar_version(&version) == PG_SOLVED && second_version(&other) == PG_SOLVED);
  printf("%s and %s\n", version.solver, other.solver);
  CHECK(planar_destroy(first) == PG_SOLVED && second_destroy(second) == PG_SOLVED);
  return checks_failed > 0;
}
