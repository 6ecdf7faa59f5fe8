/* Points, segments and poses in space: small enough to be inline. */
#ifndef PROXGEN_GEOMETRY_H
#define PROXGEN_GEOMETRY_H

/* A segment from `start` to start + axis. */
typedef struct {
  double start[3];
  double axis[3];
  double inverse_squared_length; /* 0 for a point */
} pg_segment_t;

/* Closer than this to an axis, a point has no direction to leave it. */
#define PG_INSIDE 1e-6 /* [m] */

static inline double pg_dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double pg_clamp(double value, double low, double high) {
  return value < low ? low : value > high ? high : value;
}

/* Moves a point into the world by a row-major 3x4 pose [R|t]. */
static inline void pg_transform(const double pose[12], const double point[3], double moved[3]) {
  for (int i = 0; i < 3; i++)
    moved[i] =
        pose[4 * i] * point[0] + pose[4 * i + 1] * point[1] + pose[4 * i + 2] * point[2] + pose[4 * i + 3];
}

/* Moves a point of the world into the frame of such a pose. */
static inline void pg_transform_back(const double pose[12], const double point[3], double moved[3]) {
  const double v[3] = {point[0] - pose[3], point[1] - pose[7], point[2] - pose[11]};
  for (int i = 0; i < 3; i++)
    moved[i] = pose[i] * v[0] + pose[4 + i] * v[1] + pose[8 + i] * v[2];
}

/* The segment between two points of a body in the world. */
static inline void pg_place(const double pose[12], const double start[3], const double end[3],
                            pg_segment_t *segment) {
  double moved_end[3];
  pg_transform(pose, start, segment->start);
  pg_transform(pose, end, moved_end);
  for (int i = 0; i < 3; i++)
    segment->axis[i] = moved_end[i] - segment->start[i];
  const double squared_length = pg_dot(segment->axis, segment->axis);
  segment->inverse_squared_length = squared_length > 0.0 ? 1.0 / squared_length : 0.0;
}

/* Turns a vector of a body's frame into the world's directions. */
static inline void pg_turn(const double pose[12], const double vector[3], double turned[3]) {
  for (int i = 0; i < 3; i++)
    turned[i] = pose[4 * i] * vector[0] + pose[4 * i + 1] * vector[1] + pose[4 * i + 2] * vector[2];
}

/* The point that a sensor at `position` sees along `ray` at the distance r, in the world. */
static inline void pg_look(const double pose[12], const double position[3], const double ray[3], double r,
                           double seen[3]) {
  double local[3];
  for (int i = 0; i < 3; i++)
    local[i] = position[i] + r * ray[i];
  pg_transform(pose, local, seen);
}

/* Vector d from the closest point p = start + t*axis of a segment to `point`; returns ||d||^2. */
static inline double pg_from_segment(const pg_segment_t *segment, const double point[3], double d[3],
                                     double *t) {
  const double from_start[3] = {point[0] - segment->start[0], point[1] - segment->start[1],
                                point[2] - segment->start[2]};
  *t = pg_clamp(pg_dot(from_start, segment->axis) * segment->inverse_squared_length, 0.0, 1.0);
  for (int i = 0; i < 3; i++)
    d[i] = from_start[i] - *t * segment->axis[i];
  return pg_dot(d, d);
}

#endif
