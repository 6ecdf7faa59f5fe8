/* Self-collision: points that the arm carries are obstacle points for its other links (docs/method.md,
 * Self-collision). Steps 3 and 4 for them, with distances between surfaces and a schedule of their own.
 * Compiled only for robots that have such points. */
#include "geometry.h"
#include "row.h"
#include "state.h"

#if PG_SELF_POINTS

/* Offers a point to a capsule; of points that are equally near the first is kept. */
static void offer(const pg_self_point_t *candidate, const double point[3], const pg_segment_t *axis,
                  double radius, double reach, pg_nearest_self_t *nearest) {
  double d[3], t;
  const double length = sqrt(pg_from_segment(axis, point, d, &t));
  const double distance = length - radius - candidate->radius;
  if (!(distance <= reach) || (nearest->found && !(distance < nearest->distance - PG_SAME_DISTANCE))) return;
  nearest->found = 1;
  nearest->carrier = candidate->body;
  nearest->distance = distance;
  nearest->length = length;
  for (int i = 0; i < 3; i++) {
    nearest->point[i] = point[i];
    nearest->closest[i] = axis->start[i] + t * axis->axis[i];
    nearest->apart[i] = d[i];
  }
}

pg_status_t pg_find_nearest_self(pg_controller_t *controller) {
  const pg_kinematics_t *kinematics = &controller->kinematics;
  const double reach = controller->parameters.self_d_a + PG_SAME_DISTANCE;
  double points[PG_SELF_POINTS][3];
  for (int c = 0; c < PG_SELF_POINTS; c++)
    pg_transform(kinematics->body_to_world[pg_model_self_points[c].body], pg_model_self_points[c].position,
                 points[c]);

  int inside = 0;
  for (int l = 0; l < PG_CAPSULES; l++) {
    const pg_capsule_t *capsule = &pg_model_capsules[l];
    pg_nearest_self_t *nearest = &controller->nearest_self[l];
    pg_segment_t axis;
    pg_place(kinematics->body_to_world[capsule->body], capsule->start, capsule->end, &axis);
    nearest->found = 0;
    for (int c = 0; c < PG_SELF_POINTS; c++)
      if (pg_model_self_pairs[c][l])
        offer(&pg_model_self_points[c], points[c], &axis, capsule->radius, reach, nearest);
    inside |= nearest->found && nearest->length < PG_INSIDE;
    controller->cycle.self_distance[l] = nearest->found ? nearest->distance : PG_INFINITY;
  }
  return inside ? PG_FAULT_OBSTACLE_INSIDE : PG_SOLVED;
}

/* A = d'(J_p - J_h), b = max(speed(d), -row_speed ||A||) of one capsule. */
static void write_row(pg_controller_t *controller, int l) {
  const pg_parameters_t *p = &controller->parameters;
  const pg_nearest_self_t *nearest = &controller->nearest_self[l];
  double row[PG_N], direction[3], speed;
  for (int i = 0; i < 3; i++)
    direction[i] = nearest->apart[i] / nearest->length;
  pg_model_self_row(pg_model_capsules[l].body, nearest->carrier, &controller->kinematics, nearest->closest,
                    nearest->point, direction, row);
  pg_model_self_approach_speed(p, nearest->distance, &speed);
  const double norm = pg_row_norm(row);
  if (norm >= PG_LEAST_ROW)
    pg_switch_on(&controller->cycle, PG_FIRST_SELF_ROW + l, row, pg_row_bound(p, speed, norm));
}

void pg_write_self_rows(pg_controller_t *controller) {
  for (int l = 0; l < PG_CAPSULES; l++)
    if (controller->nearest_self[l].found) write_row(controller, l);
}

#endif
