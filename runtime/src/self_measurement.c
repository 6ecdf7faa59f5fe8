/* Self-measurement removal: does the arm itself explain what a sensor says? (docs/method.md, Additions) */
#include "state.h"

#if PG_SELF_MEASUREMENT

#include <math.h>

/* 1 if the point is in a capsule of another body than the sensor's, thickened by the margin. */
static int in_another_body(const pg_segment_t axes[PG_CAPSULES], int body, const double point[3],
                           double margin) {
  for (int l = 0; l < PG_CAPSULES; l++) {
    double d[3], t;
    if (pg_model_capsules[l].body == body) continue;
    const double reach = pg_model_capsules[l].radius + margin + PG_SAME_DISTANCE;
    if (pg_from_segment(&axes[l], point, d, &t) <= reach * reach) return 1;
  }
  return 0;
}

int pg_range_shows_arm(const pg_controller_t *controller, const pg_segment_t axes[PG_CAPSULES], int sensor,
                       double reading) {
  const pg_sensor_t *place = &pg_model_tof[sensor];
  const double *pose = controller->kinematics.body_to_world[place->body];
  for (int ray = 0; ray < 5; ray++) {
    double point[3];
    pg_look(pose, place->position, pg_model_tof_rays[sensor][ray], reading, point);
    if (in_another_body(axes, place->body, point, controller->parameters.self_measurement_margin)) return 1;
  }
  return 0;
}

int pg_switch_shows_arm(const pg_controller_t *controller, const pg_segment_t axes[PG_CAPSULES], int sensor) {
  const pg_sensor_t *place = &pg_model_capacitive[sensor];
  const pg_cone_t *cone = &pg_model_capacitive_cones[sensor];
  const double *pose = controller->kinematics.body_to_world[place->body];
  double origin[3], normal[3];
  pg_transform(pose, place->position, origin);
  pg_turn(pose, place->normal, normal);
  for (int l = 0; l < PG_CAPSULES; l++) {
    double from_axis[3], t;
    if (pg_model_capsules[l].body == place->body) continue;
    const double length = sqrt(pg_from_segment(&axes[l], origin, from_axis, &t));
    const double gap = length - pg_model_capsules[l].radius - controller->parameters.self_measurement_margin;
    if (gap <= PG_SAME_DISTANCE) return 1;
    const int in_cone = -pg_dot(from_axis, normal) >= cone->cosine * length - PG_SAME_DISTANCE;
    if (gap <= cone->reach + PG_SAME_DISTANCE && in_cone) return 1;
  }
  return 0;
}

#endif
