/* Memory of seen points: what a range sensor saw stays an obstacle for a while (docs/method.md, Additions).
 */
#include "state.h"

#if PG_MEMORY_CAPACITY > 0

#include <math.h>
#include <string.h>

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

/* The used slots, and their points in the frame of a body. */
typedef struct {
  int count;
  pg_slot_t *slot[PG_MEMORY_CAPACITY];
  double point[PG_MEMORY_CAPACITY][3];
} used_t;

static void move_into(const double pose[12], used_t *used) {
  for (int k = 0; k < used->count; k++)
    pg_transform_back(pose, used->slot[k]->point, used->point[k]);
}

static void drop(used_t *used, int k) {
  used->slot[k]->used = 0;
  used->count--;
  used->slot[k] = used->slot[used->count];
  memcpy(used->point[k], used->point[used->count], sizeof used->point[k]);
}

/* Frees the slots that a range sensor sees through: nearer than its reading by more than the margin, and
 * close enough to its axis. Nearly all are behind the sensor, or far from its axis: that is told first,
 * without a root and with room for rounding. */
static void see_through(const pg_sensor_t *sensor, double cosine, double clear, used_t *used) {
  const pg_sensor_t at = *sensor;
  const double behind = pg_dot(at.position, at.normal) - ROUNDING, squared_cosine = cosine * cosine;
  for (int k = used->count - 1; k >= 0; k--) {
    const double *point = used->point[k];
    const double along = pg_dot(point, at.normal) - behind;
    if (along < 0.0) continue;
    const double v[3] = {point[0] - at.position[0], point[1] - at.position[1], point[2] - at.position[2]};
    const double squared = pg_dot(v, v);
    if (along * along < squared_cosine * squared) continue;
    if (squared < clear * clear && pg_dot(v, at.normal) >= cosine * sqrt(squared) - PG_SAME_DISTANCE)
      drop(used, k);
  }
}

void pg_memory_forget(pg_controller_t *controller, const pg_segment_t axes[PG_CAPSULES],
                      const pg_measurement_t *seen) {
  used_t used;
  used.count = 0;
  for (int k = 0; k < PG_MEMORY_CAPACITY; k++) {
    pg_slot_t *slot = &controller->memory[k];
    if (!slot->used) continue;
    if (seen->time - slot->time > controller->parameters.memory_age || in_arm(axes, slot->point))
      slot->used = 0;
    else
      used.slot[used.count++] = slot;
  }
  const double margin = controller->parameters.memory_margin + PG_SAME_DISTANCE;
  for (int i = 0, body = -1; i < PG_TOF && used.count > 0; i++) {
    const pg_sensor_t *sensor = &pg_model_tof[i];
    if (!(seen->tof_range[i] > margin)) continue;
    if (sensor->body != body) move_into(controller->kinematics.body_to_world[sensor->body], &used);
    body = sensor->body;
    see_through(sensor, pg_model_tof_see_through[i], seen->tof_range[i] - margin, &used);
  }
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
