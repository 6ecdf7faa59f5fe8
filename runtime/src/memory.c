/* Memory of seen points: what a range sensor saw stays an obstacle for a while (docs/method.md, Additions).
 */
#include "state.h"

#if PG_MEMORY_CAPACITY > 0

#include <math.h>

/* More than rounding makes of any place near the arm. */
#define ROUNDING 1e-6 /* [m] */

/* 1 if the point is in the arm: at most a capsule's radius away from its axis. */
static int in_arm(const pg_segment_t axes[PG_CAPSULES], const double point[3]) {
  for (int l = 0; l < PG_CAPSULES; l++) {
    double d[3], t;
    const double reach = pg_model_capsules[l].radius + PG_SAME_DISTANCE;
    if (pg_from_segment(&axes[l], point, d, &t) <= reach * reach) return 1;
  }
  return 0;
}

/* 1 if the point is within the memory's reach of a capsule's axis. */
static int in_reach(const pg_segment_t axes[PG_CAPSULES], const double point[3], double reach) {
  const double squared = (reach + PG_SAME_DISTANCE) * (reach + PG_SAME_DISTANCE);
  for (int l = 0; l < PG_CAPSULES; l++) {
    double d[3], t;
    if (pg_from_segment(&axes[l], point, d, &t) <= squared) return 1;
  }
  return 0;
}

/* Frees the slots that a range sensor sees through: nearer than its reading by more than the margin, and
 * close enough to its axis. Nearly all are behind the sensor, or too far along its normal: that is told
 * first, with room for rounding. */
static void see_through(pg_controller_t *controller, int sensor, double reading) {
  const pg_sensor_t *place = &pg_model_tof[sensor];
  const double *pose = controller->kinematics.body_to_world[place->body];
  const double clear = reading - controller->parameters.memory_margin - PG_SAME_DISTANCE;
  if (!(clear > 0.0)) return;
  double origin[3], normal[3];
  pg_transform(pose, place->position, origin);
  pg_turn(pose, place->normal, normal);
  const double behind = pg_dot(origin, normal) - ROUNDING, beyond = behind + clear + 2.0 * ROUNDING;
  for (int k = 0; k < PG_MEMORY_CAPACITY; k++) {
    pg_slot_t *slot = &controller->memory[k];
    if (!slot->used) continue;
    const double ahead = pg_dot(slot->point, normal);
    if (ahead < behind || ahead > beyond) continue;
    const double v[3] = {slot->point[0] - origin[0], slot->point[1] - origin[1], slot->point[2] - origin[2]};
    const double squared = pg_dot(v, v);
    if (squared < clear * clear &&
        pg_dot(v, normal) >= pg_model_tof_see_through[sensor] * sqrt(squared) - PG_SAME_DISTANCE)
      slot->used = 0;
  }
}

void pg_memory_forget(pg_controller_t *controller, const pg_segment_t axes[PG_CAPSULES],
                      const pg_measurement_t *seen) {
  for (int k = 0; k < PG_MEMORY_CAPACITY; k++) {
    pg_slot_t *slot = &controller->memory[k];
    if (slot->used &&
        (seen->time - slot->time > controller->parameters.memory_age || in_arm(axes, slot->point)))
      slot->used = 0;
  }
  for (int i = 0; i < PG_TOF; i++)
    see_through(controller, i, seen->tof_range[i]);
}

/* The slot that a point gets: that of the nearest one which is near enough, a free one, or the oldest. */
static pg_slot_t *slot_for(pg_controller_t *controller, const double point[3]) {
  pg_slot_t *nearest = NULL, *free_one = NULL, *oldest = NULL;
  const double merge = controller->parameters.memory_merge + PG_SAME_DISTANCE;
  double least = 0.0;
  for (int k = 0; k < PG_MEMORY_CAPACITY; k++) {
    pg_slot_t *slot = &controller->memory[k];
    if (!slot->used) {
      free_one = free_one ? free_one : slot;
      continue;
    }
    const double v[3] = {slot->point[0] - point[0], slot->point[1] - point[1], slot->point[2] - point[2]};
    const double distance = sqrt(pg_dot(v, v));
    if (distance <= merge && (!nearest || distance < least - PG_SAME_DISTANCE)) {
      nearest = slot;
      least = distance;
    }
    if (!oldest || slot->time < oldest->time) oldest = slot;
  }
  return nearest ? nearest : free_one ? free_one : oldest;
}

void pg_memory_store(pg_controller_t *controller, const pg_segment_t axes[PG_CAPSULES], const double point[3],
                     double time) {
  if (!in_reach(axes, point, controller->parameters.memory_reach)) return;
  pg_slot_t *slot = slot_for(controller, point);
  for (int i = 0; i < 3; i++)
    slot->point[i] = point[i];
  slot->time = time;
  slot->used = 1;
}

#endif
