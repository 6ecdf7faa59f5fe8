/* Circulation: where an obstacle blocks the way for good, the tool is sent along it (docs/method.md,
 * Additions, whose names these are). */
#include "state.h"

#if PG_CIRCULATION

#include "tangents.h"

#include <math.h>
#include <string.h>

/* Speeds and parts of unit vectors that differ by no more count as equal to what they are held against. */
#define SAME            1e-9
#define MOVING          0.02 /* [m/s] a task velocity that is not greater asks for no motion */
#define FRESH           3.0  /* [s] a tangent that was released no longer ago is preferred */
#define KEEP            0.5  /* weight of the present tangent: of a choice soon after the last */
#define TURN            -2.0 /* and of another way round */
#define LEAST_ON_PLANE  0.1  /* a tangent that would be shorter on the surface is not moved onto it */
#define LEAST_CANDIDATE 0.5  /* shorter ones, without the rows that the task lacks, are left out */
#define FREE_NORMAL     0.2  /* the way is clear if it hardly points at the obstacle, */
#define FREE_TANGENT    0.5  /* or along the surface goes with the tangent */
#define LEAST_DISTANCE  1e-3 /* [m] no other obstacle weighs as if it were nearer */
#define LONG_AGO        1e20 /* [s] */

/* What circulation looks at in a cycle. */
typedef struct {
  double speed;         /* [m/s] sigma of the task velocity */
  double direction[3];  /* u of the task velocity, 0 if it has none */
  double velocity[3];   /* [m/s] v of the tool, by the previous command */
  int nearest;          /* capsule that gives the normal; -1: nothing is near */
  const double *normal; /* of that capsule; valid if something is near */
} situation_t;

static double larger(double a, double b) {
  return a > b ? a : b;
}

static double length_of(const double vector[3]) {
  return sqrt(pg_dot(vector, vector));
}

static situation_t look(const pg_controller_t *controller, const double wanted[PG_M]) {
  situation_t now;
  double linear[3], moving[PG_M];
  pg_linear_part(wanted, linear);
  now.speed = length_of(linear);
  for (int i = 0; i < 3; i++)
    now.direction[i] = now.speed < PG_LEAST_VELOCITY ? 0.0 : linear[i] / now.speed;
  for (int i = 0; i < PG_M; i++) {
    moving[i] = 0.0;
    for (int j = 0; j < PG_N; j++)
      moving[i] += controller->kinematics.J[i * PG_N + j] * controller->qdot_previous[j];
  }
  pg_linear_part(moving, now.velocity);
  now.nearest = pg_nearest_capsule(controller, PG_D_ON(&controller->parameters));
  now.normal = now.nearest < 0 ? NULL : controller->nearest[now.nearest].direction;
  return now;
}

/* c_i.u - sum over other capsules of max(0, c_i.d_l) d_on/||d_l|| + kappa c_i.tangent + c_i.bias. */
static double score(const pg_controller_t *controller, const situation_t *now, const double candidate[3],
                    double kappa) {
  const pg_parameters_t *p = &controller->parameters;
  double sum = pg_dot(candidate, now->direction);
  for (int l = 0; l < PG_CAPSULES; l++) {
    const pg_nearest_t *other = &controller->nearest[l];
    const double towards = other->found && l != now->nearest ? pg_dot(candidate, other->direction) : 0.0;
    if (towards > 0.0) sum -= towards * PG_ONSET(p) / larger(other->distance, LEAST_DISTANCE);
  }
  sum += kappa * pg_dot(candidate, controller->circulation.tangent);
  return sum + candidate[0] * p->circulation_bias_x + candidate[1] * p->circulation_bias_y +
         candidate[2] * p->circulation_bias_z;
}

/* Takes the best tangent of a normal; the present one stays if the normal is 0, or if no candidate lies in
 * the task's rows. */
static void choose(pg_controller_t *controller, const situation_t *now, const double normal[3],
                   double kappa) {
  double candidates[PG_TANGENTS][3], best = 0.0;
  int chosen = -1;
  if (pg_dot(normal, normal) == 0.0) return;
  pg_tangents(normal, candidates);
  for (int i = 0; i < PG_TANGENTS; i++) {
    pg_only_task_axes(candidates[i]);
    const double length = length_of(candidates[i]);
    if (length < LEAST_CANDIDATE - SAME) continue;
    for (int k = 0; k < 3; k++)
      candidates[i][k] /= length;
    const double found = score(controller, now, candidates[i], kappa);
    if (chosen >= 0 && !(found > best + PG_BETTER)) continue;
    chosen = i;
    best = found;
  }
  if (chosen >= 0) memcpy(controller->circulation.tangent, candidates[chosen], 3 * sizeof(double));
}

/* Phase 0: has the tool been blocked for long? */
static void watch(pg_controller_t *controller, const situation_t *now) {
  const pg_parameters_t *p = &controller->parameters;
  pg_circulation_t *state = &controller->circulation;
  const int blocked = now->nearest >= 0 && now->speed > MOVING + SAME &&
                      pg_dot(now->direction, now->velocity) < p->stall_fraction * now->speed - SAME;
  state->since += p->period;
  state->stalled = blocked ? state->stalled + p->period : larger(0.0, state->stalled - p->period);
  if (!blocked || state->stalled < p->stall_time - 0.5 * p->period) return;
  const int fresh =
      state->since < FRESH - 0.5 * p->period; /* without a tangent yet, its weight is of no effect */
  choose(controller, now, now->normal, fresh ? KEEP : 0.0);
  state->circulating = 1;
  state->stalled = state->clear = state->failing = state->running = 0.0;
}

/* The tangent follows the surface, unless too little would be left of it. */
static void follow_surface(pg_circulation_t *state, const double normal[3]) {
  const double along = pg_dot(state->tangent, normal);
  double tangent[3];
  for (int i = 0; i < 3; i++)
    tangent[i] = state->tangent[i] - along * normal[i];
  pg_only_task_axes(tangent);
  const double length = length_of(tangent);
  for (int i = 0; i < 3 && length > LEAST_ON_PLANE + SAME; i++)
    state->tangent[i] = tangent[i] / length;
}

/* 1 if the task velocity could be followed again. */
static int is_clear(const pg_circulation_t *state, const situation_t *now) {
  if (now->nearest < 0 || now->speed <= MOVING + SAME) return 1;
  const double towards = pg_dot(now->direction, now->normal), into = larger(0.0, towards);
  double along[3];
  for (int i = 0; i < 3; i++)
    along[i] = now->direction[i] - into * now->normal[i];
  return towards < FREE_NORMAL - SAME || pg_dot(along, state->tangent) > FREE_TANGENT + SAME;
}

/* Phase 1: along the surface until the way is clear, or another way round has to be tried. */
static void go_round(pg_controller_t *controller, const situation_t *now) {
  const pg_parameters_t *p = &controller->parameters;
  pg_circulation_t *state = &controller->circulation;
  const double step = p->period;
  state->running += step;
  if (now->nearest >= 0) follow_surface(state, now->normal);
  state->clear = is_clear(state, now) ? state->clear + step : 0.0;
  if (pg_dot(state->tangent, now->velocity) < p->stall_fraction * p->circulation_speed - SAME)
    state->failing += step;
  else
    state->failing = larger(0.0, state->failing - step);
  if (state->clear >= p->circulation_release_time - 0.5 * step ||
      state->running > p->circulation_time_limit) {
    state->circulating = 0;
    state->stalled = state->since = 0.0;
  } else if (state->failing >= p->circulation_patience - 0.5 * step) {
    choose(controller, now, now->nearest >= 0 ? now->normal : now->direction, TURN);
    state->failing = 0.0;
  }
}

void pg_circulation_reset(pg_circulation_t *circulation) {
  memset(circulation, 0, sizeof *circulation);
  circulation->since = LONG_AGO;
}

void pg_circulate(pg_controller_t *controller, const double wanted[PG_M], double xdot[PG_M]) {
  const pg_parameters_t *p = &controller->parameters;
  pg_circulation_t *state = &controller->circulation;
  const situation_t now = look(controller, wanted);
  if (state->circulating)
    go_round(controller, &now);
  else
    watch(controller, &now);

  const double step = p->period / p->circulation_blend_time;
  state->blend = state->circulating ? (state->blend + step < 1.0 ? state->blend + step : 1.0)
                                    : larger(state->blend - step, 0.0);
  double linear[3];
  pg_linear_part(wanted, linear);
  for (int i = 0; i < 3; i++)
    linear[i] = (1.0 - state->blend) * linear[i] + state->blend * p->circulation_speed * state->tangent[i];
  memcpy(xdot, wanted, PG_M * sizeof(double));
  pg_set_linear_part(linear, xdot);
  controller->cycle.circulating = state->circulating;
  memcpy(controller->cycle.tangent, state->tangent, sizeof state->tangent);
}

#endif
