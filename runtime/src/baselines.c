/* Step 4 of the methods that the paper compares with (docs/method.md, The methods): the point of the arm that
 * is nearest to an obstacle moves straight away from it, or along a tangent. Compiled in place of rows.c. */
#include "row.h"
#include "tangents.h"

#if PG_BASELINE

/* A row of which less is left beside the rows before it could contradict them, and is off. */
#define LEAST_LEFT 0.01

/* Weight of the last tangent in the choice of the next one. */
#define KEEP 0.5

/* A tangent of which less is left once it is made normal to the obstacle's direction is forgotten. */
#define LEAST_TANGENT 1e-6

/* Directions of the rows that are kept, at right angles to each other. */
typedef struct {
  int count;
  double unit[3][PG_N];
} kept_t;

/* 1 if a row adds something to those that were kept before; then it is kept as well. */
static int adds_to(kept_t *kept, const double row[PG_N]) {
  double *left = kept->unit[kept->count];
  memcpy(left, row, PG_N * sizeof(double));
  for (int k = 0; k < kept->count; k++) {
    double common = 0.0;
    for (int j = 0; j < PG_N; j++)
      common += left[j] * kept->unit[k][j];
    for (int j = 0; j < PG_N; j++)
      left[j] -= common * kept->unit[k][j];
  }
  const double norm = pg_row_norm(left);
  if (norm < LEAST_LEFT) return 0;
  for (int j = 0; j < PG_N; j++)
    left[j] /= norm;
  kept->count++;
  return 1;
}

/* -row qdot <= ubA. */
static void switch_on_opposite(pg_diagnostics_t *cycle, int slot, const double row[PG_N], double ubA) {
  double opposite[PG_N];
  for (int j = 0; j < PG_N; j++)
    opposite[j] = -row[j];
  pg_switch_on(cycle, slot, opposite, ubA);
}

/* row qdot = b, up to PG_WIDTH, in two slots. */
static void switch_on_pair(pg_diagnostics_t *cycle, int slot, const double row[PG_N], double b) {
  pg_switch_on(cycle, slot, row, b + PG_WIDTH);
  switch_on_opposite(cycle, slot + 1, row, -b + PG_WIDTH);
}

/* The law at each capsule's distance, for whoever looks at the diagnostics. */
static void note_speeds(pg_controller_t *controller) {
  for (int l = 0; l < PG_CAPSULES; l++) {
    double *speed = &controller->cycle.approach_speed[l];
    *speed = PG_INFINITY;
    if (controller->nearest[l].found)
      pg_model_approach_speed(&controller->parameters, controller->nearest[l].distance, speed);
  }
}

#if PG_METHOD_REPULSIVE

#define REACH(parameters) PG_D_DISTANT(parameters)

/* a_2 and a_3: two tangents. */
static void choose_directions(pg_controller_t *controller, int l, const double xdot[PG_M],
                              double directions[3][3]) {
  (void)xdot;
  pg_basis(controller->nearest[l].direction, directions[1], directions[2]);
}

static void write_third_row(pg_controller_t *controller, const double row[PG_N]) {
  switch_on_pair(&controller->cycle, 4, row, 0.0);
}

static void forget_tangent(pg_controller_t *controller) {
  (void)controller;
}

pg_status_t pg_dropped_at(const pg_controller_t *controller, int slot) {
  (void)controller;
  return slot == 0 ? PG_KEPT : slot == 1 ? PG_REDUCED_DISTANT : PG_REDUCED_ACTIVE;
}

#else

#define REACH(parameters) PG_D_ON(parameters)

/* Makes a vector as long as 1, or zero if it is shorter than `least`. */
static void make_unit_or_zero(double vector[3], double least) {
  const double length = sqrt(pg_dot(vector, vector));
  for (int i = 0; i < 3; i++)
    vector[i] = length < least ? 0.0 : vector[i] / length;
}

/* How much a tangent leads towards other obstacles, the nearer the worse. */
static double hindrance(const pg_controller_t *controller, int l, const double tangent[3]) {
  const pg_parameters_t *p = &controller->parameters;
  double sum = 0.0;
  for (int other = 0; other < PG_CAPSULES; other++) {
    const pg_nearest_t *nearest = &controller->nearest[other];
    if (other == l || !nearest->found) continue;
    const double weight = (p->d_a - nearest->distance) / (p->d_a - p->d_r);
    const double towards = pg_dot(tangent, nearest->direction);
    if (weight > 0.0 && towards > 0.0) sum += weight * towards;
  }
  return sum;
}

/* The best of the 24 tangents: towards the target, away from other obstacles, like the last one. */
static void choose_tangent(pg_controller_t *controller, int l, const double xdot[PG_M]) {
  const double *normal = controller->nearest[l].direction;
  double candidates[PG_TANGENTS][3], wanted[3], last[3], best = 0.0;
  const double out_of_plane = pg_dot(controller->tangent, normal);
  for (int i = 0; i < 3; i++)
    last[i] = controller->tangent[i] - out_of_plane * normal[i];
  make_unit_or_zero(last, LEAST_TANGENT);
  pg_linear_part(xdot, wanted);
  make_unit_or_zero(wanted, PG_LEAST_VELOCITY);
  pg_tangents(normal, candidates);
  for (int c = 0; c < PG_TANGENTS; c++) {
    const double *tangent = candidates[c];
    const double score =
        pg_dot(tangent, wanted) + KEEP * pg_dot(tangent, last) - hindrance(controller, l, tangent);
    if (c > 0 && !(score > best + PG_BETTER)) continue;
    best = score;
    memcpy(controller->tangent, tangent, sizeof controller->tangent);
  }
}

/* a_2 = d x t, a_3 = t. */
static void choose_directions(pg_controller_t *controller, int l, const double xdot[PG_M],
                              double directions[3][3]) {
  choose_tangent(controller, l, xdot);
  const double *normal = controller->nearest[l].direction, *tangent = controller->tangent;
  for (int i = 0; i < 3; i++) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    directions[1][i] = normal[j] * tangent[k] - normal[k] * tangent[j];
    directions[2][i] = tangent[i];
  }
}

static void write_third_row(pg_controller_t *controller, const double row[PG_N]) {
  switch_on_opposite(&controller->cycle, 4, row, -controller->parameters.tangential_speed);
}

static void forget_tangent(pg_controller_t *controller) {
  memset(controller->tangent, 0, sizeof controller->tangent);
}

pg_status_t pg_dropped_at(const pg_controller_t *controller, int slot) {
  (void)controller;
  return slot == 0 ? PG_KEPT : slot < 4 ? PG_REDUCED_DISTANT : PG_REDUCED_ACTIVE;
}

#endif

void pg_write_rows(pg_controller_t *controller, const double xdot[PG_M]) {
  const pg_parameters_t *p = &controller->parameters;
  pg_switch_all_off(&controller->cycle);
  note_speeds(controller);
  const int l = pg_nearest_capsule(controller, REACH(p));
  if (l < 0) {
    forget_tangent(controller);
    return;
  }
  const pg_nearest_t *nearest = &controller->nearest[l];
  double directions[3][3];
  memcpy(directions[0], nearest->direction, sizeof directions[0]);
  choose_directions(controller, l, xdot, directions);

  kept_t kept = {0};
  for (int i = 0; i < 3; i++) {
    double row[PG_N];
    pg_model_row(pg_model_capsules[l].body, &controller->kinematics, nearest->closest, directions[i], row);
    if (!adds_to(&kept, row)) continue;
    const double speed = controller->cycle.approach_speed[l];
    if (i == 0)
      switch_on_pair(&controller->cycle, 0, row,
                     pg_row_bound(p, speed < 0.0 ? speed : 0.0, pg_row_norm(row)));
    else if (i == 1)
      switch_on_pair(&controller->cycle, 2, row, 0.0);
    else
      write_third_row(controller, row);
  }
}

#endif
