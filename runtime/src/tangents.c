/* The 24 tangents of a normal (docs/method.md, The methods). */
#include "tangents.h"

#if PG_CIRCULATION || PG_METHOD_REPULSIVE || PG_METHOD_TANGENTIAL

#include "geometry.h"

#include <math.h>

/* Where the direction is as close to the x axis, the basis begins with the y axis: at 0.9, which rounding
 * must not decide. */
#define CLOSE_TO_X (0.9 - 1e-9)

void pg_basis(const double direction[3], double first[3], double second[3]) {
  const int seed = fabs(direction[0]) < CLOSE_TO_X ? 0 : 1;
  for (int i = 0; i < 3; i++)
    first[i] = (i == seed) - direction[seed] * direction[i];
  const double length = sqrt(pg_dot(first, first));
  for (int i = 0; i < 3; i++)
    first[i] /= length;
  for (int i = 0; i < 3; i++) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    second[i] = direction[j] * first[k] - direction[k] * first[j];
  }
}

#endif

#if PG_CIRCULATION || PG_METHOD_TANGENTIAL

/* cos(2 pi i/24) for a quarter of a turn; the rest follows from it. */
static const double QUARTER[7] = {
    1.0, 0.9659258262890683, 0.8660254037844387, 0.7071067811865476, 0.5, 0.2588190451025207, 0.0};

/* cos(2 pi i/24), i from 0 to 23. */
static double cosine(int i) {
  const int half = i <= 12 ? i : 24 - i; /* cos(-x) = cos(x) */
  return half <= 6 ? QUARTER[half] : -QUARTER[12 - half];
}

void pg_tangents(const double direction[3], double candidates[PG_TANGENTS][3]) {
  double first[3], second[3];
  pg_basis(direction, first, second);
  for (int i = 0; i < PG_TANGENTS; i++) {
    const double c = cosine(i), s = cosine((i + 18) % PG_TANGENTS); /* sin(x) = cos(x - 90 degrees) */
    for (int k = 0; k < 3; k++)
      candidates[i][k] = c * first[k] + s * second[k];
  }
}

/* Where x, y, z are among the rows of the task; -1: it lacks the row. */
static const int ROWS[3] = PG_LINEAR_ROWS;

void pg_linear_part(const double velocity[PG_M], double linear[3]) {
  for (int i = 0; i < 3; i++)
    linear[i] = ROWS[i] >= 0 ? velocity[ROWS[i]] : 0.0;
}

void pg_set_linear_part(const double linear[3], double velocity[PG_M]) {
  for (int i = 0; i < 3; i++)
    if (ROWS[i] >= 0) velocity[ROWS[i]] = linear[i];
}

void pg_only_task_axes(double vector[3]) {
  for (int i = 0; i < 3; i++)
    if (ROWS[i] < 0) vector[i] = 0.0;
}

#endif
