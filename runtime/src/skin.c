/* Steps 2 and 3: from readings to obstacle points, and to the nearest one of each capsule.
 *
 * Nothing is stored per point: each is offered to every capsule once, by squared distance to its axis, so the
 * cost is linear in the number of sensors. Points beyond influence never displace anything. */
#include "geometry.h"
#include "state.h"

#include <math.h>

/* The nearest point to a capsule so far. */
typedef struct {
  double displaced_below; /* [m^2] a point whose squared distance to the axis is less takes the place */
  double point[3];        /* [m] world; valid if `found` */
  int found;
} candidate_t;

/* The capsules' axes in the world, and what is near them. */
typedef struct {
  pg_segment_t axes[PG_CAPSULES];
  candidate_t candidates[PG_CAPSULES];
} field_t;

static double influence_distance(const pg_parameters_t *p) {
  return PG_D_ON(p) > PG_D_ACTIVE(p) ? PG_D_ON(p) : PG_D_ACTIVE(p);
}

/* Capsules move with their bodies; points that are too far for them are left out from the start. */
static void place_capsules(const pg_controller_t *controller, field_t *field) {
  for (int l = 0; l < PG_CAPSULES; l++) {
    const pg_capsule_t *capsule = &pg_model_capsules[l];
    pg_place(controller->kinematics.body_to_world[capsule->body], capsule->start, capsule->end,
             &field->axes[l]);

    /* A little more than needed: the distance itself decides at the end. */
    const double reach =
        (influence_distance(&controller->parameters) + capsule->reference_radius) * (1.0 + 1e-9);
    field->candidates[l].displaced_below = reach * reach;
    field->candidates[l].found = 0;
  }
}

/* Offers an obstacle point to all capsules; of points that are equally near the first is kept. */
static inline void offer(field_t *field, const double point[3]) {
  for (int l = 0; l < PG_CAPSULES; l++) {
    candidate_t *candidate = &field->candidates[l];
    double d[3], t;
    const double squared_distance = pg_from_segment(&field->axes[l], point, d, &t);
    if (squared_distance < candidate->displaced_below) {
      const double nearer = sqrt(squared_distance) - PG_SAME_DISTANCE;
      candidate->displaced_below = nearer > 0.0 ? nearer * nearer : 0.0;
      for (int i = 0; i < 3; i++)
        candidate->point[i] = point[i];
      candidate->found = 1;
    }
  }
}

/* Range sensors that see something: h = o + r n, unless it is the arm itself. */
static void offer_ranges(pg_controller_t *controller, const pg_measurement_t *seen, field_t *field) {
  for (int i = 0; i < PG_TOF; i++) {
    const pg_sensor_t *sensor = &pg_model_tof[i];
    const double reading = seen->tof_range[i];
    double point[3];
    if (!(reading < sensor->range)) continue;
#if PG_SELF_MEASUREMENT
    if (pg_range_shows_arm(controller, field->axes, i, reading)) {
      controller->cycle.self_readings++;
      continue;
    }
#endif
    pg_look(controller->kinematics.body_to_world[sensor->body], sensor->position, sensor->normal, reading,
            point);
    offer(field, point);
#if PG_MEMORY_CAPACITY > 0
    pg_memory_store(controller, field->axes, point, seen->time);
#endif
  }
}

/* Switches that are closed stand for a point at their virtual distance, unless the arm itself may close
 * them. */
static void offer_switches(pg_controller_t *controller, const pg_measurement_t *seen, field_t *field) {
  int any_closed = 0; /* in most cycles none is, which processors see sixteen at a time */
  for (int i = 0; i < PG_CAPACITIVE; i++)
    any_closed |= seen->capacitive[i];
  if (!any_closed) return;
  for (int i = 0; i < PG_CAPACITIVE; i++) {
    const pg_sensor_t *sensor = &pg_model_capacitive[i];
    double point[3];
    if (!seen->capacitive[i]) continue;
#if PG_SELF_MEASUREMENT
    if (pg_switch_shows_arm(controller, field->axes, i)) {
      controller->cycle.self_readings++;
      continue;
    }
#endif
    pg_look(controller->kinematics.body_to_world[sensor->body], sensor->position, sensor->normal,
            sensor->range, point);
    offer(field, point);
  }
}

/* Step 2: all obstacle points in their order. */
static void offer_all(pg_controller_t *controller, const pg_measurement_t *seen, field_t *field) {
#if PG_MEMORY_CAPACITY > 0
  pg_memory_forget(controller, field->axes, seen);
#endif
  offer_ranges(controller, seen, field);
  offer_switches(controller, seen, field);
  for (int i = 0; i < seen->point_count; i++)
    offer(field, &seen->points[3 * i]);
#if PG_MEMORY_CAPACITY > 0
  for (int k = 0; k < PG_MEMORY_CAPACITY; k++)
    if (controller->memory[k].used) {
      offer(field, controller->memory[k].point);
      controller->cycle.memory_points++;
    }
#endif
}

/* Fills in distance and direction of a capsule's nearest point; returns 0 if the point is on the axis. */
static int measure(const pg_segment_t *axis, const double point[3], double reference_radius, double influence,
                   pg_nearest_t *nearest) {
  double d[3], t;
  const double norm = sqrt(pg_from_segment(axis, point, d, &t));
  nearest->distance = norm - reference_radius;
  nearest->found = nearest->distance <= influence;
  if (norm < PG_INSIDE) return 0;
  for (int i = 0; i < 3; i++) {
    nearest->closest[i] = axis->start[i] + t * axis->axis[i];
    nearest->direction[i] = d[i] / norm;
  }
  return 1;
}

pg_status_t pg_find_nearest(pg_controller_t *controller, const pg_measurement_t *seen) {
  field_t field;
  place_capsules(controller, &field);
  offer_all(controller, seen, &field);

  const double influence = influence_distance(&controller->parameters);
  pg_diagnostics_t *cycle = &controller->cycle;
  int inside = 0;
  for (int l = 0; l < PG_CAPSULES; l++) {
    pg_nearest_t *nearest = &controller->nearest[l];
    nearest->found = 0;
    const candidate_t *candidate = &field.candidates[l];
    if (candidate->found &&
        !measure(&field.axes[l], candidate->point, pg_model_capsules[l].reference_radius, influence, nearest))
      inside = 1;
    cycle->distance[l] = nearest->found ? nearest->distance : PG_INFINITY;
    for (int i = 0; i < 3; i++)
      cycle->nearest_point[3 * l + i] = nearest->found ? candidate->point[i] : PG_NAN;
  }
  return inside ? PG_FAULT_OBSTACLE_INSIDE : PG_SOLVED;
}

#if PG_CIRCULATION || PG_BASELINE
int pg_nearest_capsule(const pg_controller_t *controller, double reach) {
  int kept = -1;
  for (int l = 0; l < PG_CAPSULES; l++) {
    const pg_nearest_t *nearest = &controller->nearest[l];
    if (!nearest->found || !(nearest->distance <= reach)) continue;
    if (kept < 0 || nearest->distance < controller->nearest[kept].distance - PG_SAME_DISTANCE) kept = l;
  }
  return kept;
}
#endif
