/* Self-measurement removal: does the arm itself explain what a sensor says? (docs/method.md, Additions) */
#include "state.h"

#if PG_SELF_MEASUREMENT

#include <math.h>

/* More than rounding makes of any place near the arm. */
#define ROUNDING 1e-6 /* [m] */

/* 1 if one of the four places around the middle of what a sensor sees is in a capsule. */
static int beside_the_middle(const pg_segment_t *axis, const double *pose, int sensor, double reading,
                             double reach) {
  for (int ray = 1; ray < 5; ray++) {
    double place[3], d[3], t;
    pg_look(pose, pg_model_tof[sensor].position, pg_model_tof_rays[sensor][ray], reading, place);
    if (pg_from_segment(axis, place, d, &t) <= reach * reach) return 1;
  }
  return 0;
}

/* The four places are equally far from the middle: a capsule that is further away holds none of them. */
int pg_range_shows_arm(const pg_controller_t *controller, const pg_segment_t axes[PG_CAPSULES], int sensor,
                       double reading) {
  const pg_sensor_t *place = &pg_model_tof[sensor];
  const double *pose = controller->kinematics.body_to_world[place->body];
  const double (*rays)[3] = pg_model_tof_rays[sensor];
  const double aside[3] = {rays[1][0] - rays[0][0], rays[1][1] - rays[0][1], rays[1][2] - rays[0][2]};
  const double around = reading * sqrt(pg_dot(aside, aside)) + ROUNDING;
  double middle[3];
  pg_look(pose, place->position, rays[0], reading, middle);
  for (int l = 0; l < PG_CAPSULES; l++) {
    double d[3], t;
    if (pg_model_capsules[l].body == place->body) continue;
    const double squared = pg_from_segment(&axes[l], middle, d, &t);
    const double reach =
        pg_model_capsules[l].radius + controller->parameters.self_measurement_margin + PG_SAME_DISTANCE;
    if (squared > (reach + around) * (reach + around)) continue;
    if (squared <= reach * reach || beside_the_middle(&axes[l], pose, sensor, reading, reach)) return 1;
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
