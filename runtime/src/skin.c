/* Steps 2 and 3: from readings to obstacle points, and to the nearest one of each capsule.
 *
 * Nothing is stored per point: each is offered to every capsule once, by squared distance to its axis, so the
 * cost is linear in the number of sensors. Points beyond influence never displace anything. */
#include "geometry.h"
#include "state.h"

#include <math.h>

/* A capsule's axis in the world, and the nearest point to it so far. */
typedef struct {
  pg_segment_t segment;
  double displaced_below; /* [m^2] a point whose squared distance to the axis is less takes the place */
  double point[3];        /* [m] world; valid if `found` */
  int found;
} candidate_t;

static double influence_distance(const pg_parameters_t *p) {
  return PG_D_ON(p) > PG_D_ACTIVE(p) ? PG_D_ON(p) : PG_D_ACTIVE(p);
}

/* Capsules move with their bodies; points that are too far for them are left out from the start. */
static void place_capsules(const pg_controller_t *controller, candidate_t candidates[PG_CAPSULES]) {
  for (int l = 0; l < PG_CAPSULES; l++) {
    const pg_capsule_t *capsule = &pg_model_capsules[l];
    pg_place(controller->kinematics.body_to_world[capsule->body], capsule->start, capsule->end,
             &candidates[l].segment);

    /* A little more than needed: the distance itself decides at the end. */
    const double reach =
        (influence_distance(&controller->parameters) + capsule->reference_radius) * (1.0 + 1e-9);
    candidates[l].displaced_below = reach * reach;
    candidates[l].found = 0;
  }
}

/* Offers an obstacle point to all capsules; of points that are equally near the first is kept. */
static inline void offer(candidate_t candidates[PG_CAPSULES], const double point[3]) {
  for (int l = 0; l < PG_CAPSULES; l++) {
    double d[3], t;
    const double squared_distance = pg_from_segment(&candidates[l].segment, point, d, &t);
    if (squared_distance < candidates[l].displaced_below) {
      const double nearer = sqrt(squared_distance) - PG_SAME_DISTANCE;
      candidates[l].displaced_below = nearer > 0.0 ? nearer * nearer : 0.0;
      for (int i = 0; i < 3; i++)
        candidates[l].point[i] = point[i];
      candidates[l].found = 1;
    }
  }
}

/* Offers the point that a sensor sees at `range` along its normal: h = o + r n. */
static inline void offer_reading(const pg_kinematics_t *kinematics, const pg_sensor_t *sensor, double range,
                                 candidate_t candidates[PG_CAPSULES]) {
  double seen[3], point[3];
  for (int i = 0; i < 3; i++)
    seen[i] = sensor->position[i] + range * sensor->normal[i];
  pg_transform(kinematics->body_to_world[sensor->body], seen, point);
  offer(candidates, point);
}

/* Fills in distance and direction of a capsule's nearest point; returns 0 if the point is on the axis. */
static int measure(const candidate_t *candidate, double reference_radius, double influence,
                   pg_nearest_t *nearest) {
  double d[3], t;
  const double norm = sqrt(pg_from_segment(&candidate->segment, candidate->point, d, &t));
  nearest->distance = norm - reference_radius;
  nearest->found = nearest->distance <= influence;
  if (norm < PG_INSIDE) return 0;
  for (int i = 0; i < 3; i++) {
    nearest->closest[i] = candidate->segment.start[i] + t * candidate->segment.axis[i];
    nearest->direction[i] = d[i] / norm;
  }
  return 1;
}

pg_status_t pg_find_nearest(pg_controller_t *controller, const pg_measurement_t *seen) {
  const pg_kinematics_t *kinematics = &controller->kinematics;
  candidate_t candidates[PG_CAPSULES];
  place_capsules(controller, candidates);

  for (int i = 0; i < PG_TOF; i++)
    if (seen->tof_range[i] < pg_model_tof[i].range)
      offer_reading(kinematics, &pg_model_tof[i], seen->tof_range[i], candidates);
  for (int i = 0; i < PG_CAPACITIVE; i++)
    if (seen->capacitive[i])
      offer_reading(kinematics, &pg_model_capacitive[i], pg_model_capacitive[i].range, candidates);
  for (int i = 0; i < seen->point_count; i++)
    offer(candidates, &seen->points[3 * i]);

  const double influence = influence_distance(&controller->parameters);
  pg_diagnostics_t *cycle = &controller->cycle;
  int inside = 0;
  for (int l = 0; l < PG_CAPSULES; l++) {
    pg_nearest_t *nearest = &controller->nearest[l];
    nearest->found = 0;
    if (candidates[l].found &&
        !measure(&candidates[l], pg_model_capsules[l].reference_radius, influence, nearest))
      inside = 1;
    cycle->distance[l] = nearest->found ? nearest->distance : INFINITY;
    for (int i = 0; i < 3; i++)
      cycle->nearest_point[3 * l + i] = nearest->found ? candidates[l].point[i] : NAN;
  }
  return inside ? PG_FAULT_OBSTACLE_INSIDE : PG_SOLVED;
}
