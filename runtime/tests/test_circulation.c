/* Circulation of the planar arm, whose task has the rows x and y. What it looks at is put in its place by
 * hand, so that each decision can be told from its equation. */
#include "rig.h"

#include "tangents.h"

#define STEP 0.02 /* [s] a cycle */

/* A tool at rest and an obstacle ahead along x, 0.2 m from the forearm. */
static void open_blocked(rig_t *rig) {
  rig_open(rig);
  pg_controller_t *controller = rig->controller;
  controller->nearest[1] = (pg_nearest_t){.found = 1, .distance = 0.2, .direction = {1.0, 0.0, 0.0}};
  const double J[4] = {1.0, 0.0, 0.0, 1.0}; /* so that the previous command is the tool's velocity */
  memcpy(controller->kinematics.J, J, sizeof J);
  rig->xdot[0] = 0.1;
}

/* One cycle of circulation alone; the task velocity that comes out of it is left in qdot. */
static void turn(rig_t *rig) {
  pg_circulate(rig->controller, rig->xdot, rig->qdot);
}

static const pg_circulation_t *state_of(const rig_t *rig) {
  return &rig->controller->circulation;
}

/* Lets the tool be blocked until it is sent round; returns the number of cycles. */
static int get_stuck(rig_t *rig) {
  int cycles = 0;
  while (!state_of(rig)->circulating && cycles < 1000) {
    turn(rig);
    cycles++;
  }
  return cycles;
}

static void move(rig_t *rig, double x, double y) {
  rig->controller->qdot_previous[0] = x;
  rig->controller->qdot_previous[1] = y;
}

static void candidates_are_tangents(void) {
  random_t random = {17};
  for (int i = 0; i < 200; i++) {
    double normal[3], first[3], second[3], candidates[PG_TANGENTS][3], squared = 0.0;
    for (int k = 0; k < 3; k++)
      normal[k] =
          between(&random, -1.0, 1.0) * (i % 3 == 0 && k != 0 ? 0.1 : 1.0); /* now and then close to x */
    squared = pg_dot(normal, normal);
    for (int k = 0; k < 3; k++)
      normal[k] /= sqrt(squared);
    pg_basis(normal, first, second);
    pg_tangents(normal, candidates);
    const int seed = fabs(normal[0]) < 0.9 ? 0 : 1;
    CHECK(first[seed] > 0.0);
    CHECK_NEAR(first[seed == 0 ? 1 : 0], -normal[0] * normal[1] / first[seed], 1e-12);
    const double volume = first[0] * (second[1] * normal[2] - second[2] * normal[1]) +
                          first[1] * (second[2] * normal[0] - second[0] * normal[2]) +
                          first[2] * (second[0] * normal[1] - second[1] * normal[0]);
    CHECK_NEAR(volume, 1.0, 1e-12); /* right-handed, and of length 1 */
    for (int c = 0; c < PG_TANGENTS; c++) {
      const double angle = 2.0 * acos(-1.0) * c / PG_TANGENTS;
      CHECK_NEAR(pg_dot(candidates[c], normal), 0.0, 1e-12);
      CHECK_NEAR(pg_dot(candidates[c], first), cos(angle), 1e-12);
      CHECK_NEAR(pg_dot(candidates[c], second), sin(angle), 1e-12);
    }
  }
}

/* Blocked for half a second; then the task velocity changes over in a tenth. */
static void a_tool_that_is_stuck(void) {
  rig_t rig;
  open_blocked(&rig);
  CHECK_EQUAL(get_stuck(&rig), 25);
  CHECK_EQUAL(rig.cycle->circulating, 1);
  CHECK_NEAR(rig.cycle->tangent[1], 1.0, 1e-12); /* the first of two that are as good */
  CHECK_NEAR(rig.cycle->tangent[2], 0.0, 0.0);   /* the task has no z */
  for (int i = 1; i <= 8; i++) {
    const double blend = fmin(0.2 * i, 1.0);
    CHECK_NEAR(rig.qdot[0], (1.0 - blend) * 0.1, 1e-12);
    CHECK_NEAR(rig.qdot[1], blend * 0.2, 1e-12);
    turn(&rig);
  }
  rig_close(&rig);
}

/* Neither slow nor near nor wanted is blocked: exactly at the limit is not beyond it. */
static void a_tool_that_is_not_stuck(void) {
  rig_t rig;
  open_blocked(&rig);
  move(&rig, 0.02, 0.0); /* a fifth of what is wanted */
  CHECK_EQUAL(get_stuck(&rig), 1000);
  move(&rig, 0.02 - 2e-9, 0.0);
  CHECK_EQUAL(get_stuck(&rig), 25);

  CHECK(pg_reset(rig.controller) == PG_SOLVED);
  move(&rig, 0.0, 0.0);
  rig.xdot[0] = 0.012, rig.xdot[1] = 0.016; /* asks for 0.02 m/s */
  CHECK_EQUAL(get_stuck(&rig), 1000);
  rig.xdot[0] *= 1.0 + 1e-6;
  CHECK_EQUAL(get_stuck(&rig), 25);

  CHECK(pg_reset(rig.controller) == PG_SOLVED);
  rig.controller->nearest[1].distance = 0.3 + 2e-9;
  CHECK_EQUAL(get_stuck(&rig), 1000);
  rig.controller->nearest[1].distance = 0.3 + 5e-10;
  CHECK_EQUAL(get_stuck(&rig), 25);
  rig_close(&rig);
}

/* Time that was free counts against time that was blocked. */
static void stalling_is_forgotten(void) {
  rig_t rig;
  open_blocked(&rig);
  for (int i = 0; i < 20; i++)
    turn(&rig);
  move(&rig, 0.1, 0.0);
  for (int i = 0; i < 5; i++)
    turn(&rig);
  CHECK_NEAR(state_of(&rig)->stalled, 15 * STEP, 1e-12);
  move(&rig, 0.0, 0.0);
  CHECK_EQUAL(get_stuck(&rig), 10);
  rig_close(&rig);
}

/* The way is free again: it no longer points at the obstacle, or along the surface it goes with the tangent.
 */
static void the_way_is_free(void) {
  const double ways[4][2] = {{0.2 - 2e-9, -1.0}, {0.2 + 2e-9, -1.0}, {1.0, 0.0}, {0.8, 0.6}};
  const int free[4] = {1, 0, 0, 1};
  for (int i = 0; i < 4; i++) {
    rig_t rig;
    open_blocked(&rig);
    get_stuck(&rig);
    move(&rig, 0.0, 0.2); /* along the tangent, which is y */
    const double y = ways[i][1] < 0.0 ? -sqrt(1.0 - ways[i][0] * ways[i][0]) : ways[i][1];
    rig.xdot[0] = 0.1 * ways[i][0], rig.xdot[1] = 0.1 * y;
    for (int k = 0; k < 9; k++)
      turn(&rig);
    CHECK_EQUAL(rig.cycle->circulating, 1);
    turn(&rig); /* for 0.2 s */
    CHECK_EQUAL(rig.cycle->circulating, !free[i]);
    CHECK_EQUAL(state_of(&rig)->since == 0.0, free[i]);
    if (free[i]) CHECK_NEAR(state_of(&rig)->blend, 0.8, 1e-12); /* and back to the task */
    rig_close(&rig);
  }
}

/* The tangent is kept on the surface, unless too little would be left of it. */
static void the_tangent_follows_the_surface(void) {
  rig_t rig;
  open_blocked(&rig);
  get_stuck(&rig);
  rig.controller->nearest[1].direction[0] = 0.8;
  rig.controller->nearest[1].direction[1] = 0.6;
  turn(&rig);
  CHECK_NEAR(rig.cycle->tangent[0], -0.6, 1e-12);
  CHECK_NEAR(rig.cycle->tangent[1], 0.8, 1e-12);
  rig.controller->nearest[1].direction[0] = -0.6;
  rig.controller->nearest[1].direction[1] = 0.8;
  turn(&rig);
  CHECK_NEAR(rig.cycle->tangent[0], -0.6, 1e-12);
  CHECK_NEAR(rig.cycle->tangent[1], 0.8, 1e-12);
  rig_close(&rig);
}

/* No progress for a second: the other way round; the time limit: back to the task. */
static void another_way_round(void) {
  rig_t rig;
  open_blocked(&rig);
  get_stuck(&rig);
  for (int i = 0; i < 49; i++)
    turn(&rig);
  CHECK_NEAR(rig.cycle->tangent[1], 1.0, 1e-12);
  turn(&rig);
  CHECK_NEAR(rig.cycle->tangent[1], -1.0, 1e-12);
  CHECK_EQUAL(state_of(&rig)->failing, 0.0);
  move(&rig, 0.0, -0.2);
  int cycles = 50;
  for (; rig.cycle->circulating && cycles < 1000; cycles++)
    turn(&rig);
  CHECK(cycles == 600 || cycles == 601); /* more than 12 s, as rounding adds them up */

  /* Soon after, the last way is tried first; three seconds later, the first of equals. */
  move(&rig, 0.0, 0.0);
  CHECK_EQUAL(get_stuck(&rig), 25);
  CHECK_NEAR(rig.cycle->tangent[1], -1.0, 1e-12);
  rig.controller->circulation.circulating = 0;
  rig.controller->circulation.since = 3.0 - 25 * STEP;
  CHECK_EQUAL(get_stuck(&rig), 25);
  CHECK_NEAR(rig.cycle->tangent[1], 1.0, 1e-12);
  rig_close(&rig);
}

/* Times of whole cycles last so many cycles, though eight times 0.1 s add up to a little less than 0.8 s. */
static void times_of_whole_cycles(void) {
  rig_t rig;
  open_blocked(&rig);
  pg_parameters_t p = rig_parameters(&rig);
  p.period = 0.1;
  p.stall_time = p.circulation_release_time = p.circulation_patience = 0.8;
  CHECK(pg_set_parameters(rig.controller, &p) == PG_SOLVED);
  CHECK_EQUAL(get_stuck(&rig), 8);
  for (int i = 1; i <= 8; i++) {
    CHECK_NEAR(rig.cycle->tangent[1], 1.0, 1e-12);
    turn(&rig);
  }
  CHECK_NEAR(rig.cycle->tangent[1], -1.0, 1e-12);
  rig.xdot[0] = 0.0; /* nothing is asked for: the way is clear */
  for (int i = 1; i <= 8; i++) {
    CHECK_EQUAL(rig.cycle->circulating, 1);
    turn(&rig);
  }
  CHECK_EQUAL(rig.cycle->circulating, 0);
  rig_close(&rig);
}

/* At its time limit circulation goes on, beyond it no more; numbers without rounding. */
static void the_time_limit(void) {
  rig_t rig;
  open_blocked(&rig);
  pg_parameters_t p = rig_parameters(&rig);
  p.period = 0.125;
  p.circulation_patience = 100.0;
  p.circulation_time_limit = 1.0;
  CHECK(pg_set_parameters(rig.controller, &p) == PG_SOLVED);
  get_stuck(&rig);
  for (int i = 1; i <= 8; i++) {
    turn(&rig);
    CHECK_EQUAL(rig.cycle->circulating, 1);
  }
  turn(&rig);
  CHECK_EQUAL(rig.cycle->circulating, 0);
  rig_close(&rig);
}

/* Time with progress counts against time without. */
static void failing_is_forgotten(void) {
  rig_t rig;
  open_blocked(&rig);
  get_stuck(&rig);
  for (int i = 0; i < 30; i++)
    turn(&rig);
  move(&rig, 0.0, 0.1); /* along the tangent */
  for (int i = 0; i < 10; i++)
    turn(&rig);
  CHECK_NEAR(state_of(&rig)->failing, 20 * STEP, 1e-12);
  move(&rig, 0.0, 0.0);
  for (int i = 0; i < 29; i++)
    turn(&rig);
  CHECK_NEAR(rig.cycle->tangent[1], 1.0, 1e-12);
  turn(&rig);
  CHECK_NEAR(rig.cycle->tangent[1], -1.0, 1e-12);
  rig_close(&rig);
}

/* The other way round is along the surface: of the normal, wherever the task points. */
static void another_way_along_the_surface(void) {
  rig_t rig;
  open_blocked(&rig);
  get_stuck(&rig);
  rig.controller->nearest[1].direction[0] = 0.8;
  rig.controller->nearest[1].direction[1] = 0.6;
  for (int i = 0; i < 50; i++)
    turn(&rig);
  CHECK_NEAR(rig.cycle->tangent[0], 0.6, 1e-12);
  CHECK_NEAR(rig.cycle->tangent[1], -0.8, 1e-12);
  rig_close(&rig);
}

/* Weights: -2 against the way that failed, 1/2 for the way that was taken not long ago; the bias decides. */
static void weights_of_the_present_way(void) {
  for (int more = 0; more <= 1; more++) {
    rig_t rig;
    open_blocked(&rig);
    get_stuck(&rig);
    pg_parameters_t p = rig_parameters(&rig);
    p.circulation_bias_y = more ? 2.1 : 1.9;
    CHECK(pg_set_parameters(rig.controller, &p) == PG_SOLVED);
    for (int i = 0; i < 50; i++)
      turn(&rig);
    CHECK_NEAR(rig.cycle->tangent[1], more ? 1.0 : -1.0, 1e-12);
    rig.controller->circulation.circulating = 0;
    rig.controller->circulation.since = 0.0;
    rig.controller->circulation.tangent[1] = -1.0;
    p.circulation_bias_y = more ? 0.6 : 0.4;
    CHECK(pg_set_parameters(rig.controller, &p) == PG_SOLVED);
    get_stuck(&rig);
    CHECK_NEAR(rig.cycle->tangent[1], more ? 1.0 : -1.0, 1e-12);
    rig_close(&rig);
  }
}

/* Other obstacles and the bias say which way round. */
static void which_way(void) {
  rig_t rig;
  open_blocked(&rig);
  rig.controller->nearest[0] = (pg_nearest_t){.found = 1, .distance = 0.25, .direction = {0.0, 1.0, 0.0}};
  get_stuck(&rig);
  CHECK_NEAR(rig.cycle->tangent[1], -1.0, 1e-12);

  CHECK(pg_reset(rig.controller) == PG_SOLVED);
  pg_parameters_t p = rig_parameters(&rig);
  p.circulation_bias_y = 1.3; /* the obstacle weighs 0.3/0.25 = 1.2 in both scores' difference of 2.6 - 1.2 */
  CHECK(pg_set_parameters(rig.controller, &p) == PG_SOLVED);
  get_stuck(&rig);
  CHECK_NEAR(rig.cycle->tangent[1], 1.0, 1e-12);
  rig_close(&rig);
}

/* In the cycle: the state outlives faults, and a reset empties it. */
static void faults_and_resets(void) {
  rig_t rig;
  rig_open(&rig);
  rig.q[0] = 0.5, rig.q[1] = -1.0;
  CHECK(rig_step(&rig) >= PG_SOLVED);
  rig.controller->circulation =
      (pg_circulation_t){.circulating = 1, .tangent = {0.0, 1.0, 0.0}, .blend = 1.0};
  CHECK(rig_step(&rig) >= PG_SOLVED);
  CHECK_EQUAL(rig.cycle->circulating, 1);
  CHECK_NEAR(rig.cycle->g[0], -rig.controller->kinematics.J[2] * 0.2, 1e-12); /* y is asked for, at 0.2 m/s */
  const pg_circulation_t before = *state_of(&rig);

  rig.xdot[0] = NAN;
  CHECK_EQUAL(rig_step(&rig), PG_FAULT_NOT_FINITE);
  CHECK_EQUAL(rig.cycle->circulating, 0);
  CHECK(isnan(rig.cycle->tangent[0]) && isnan(rig.cycle->tangent[2]));
  rig.xdot[0] = 0.0;
  rig_see(&rig, 0.0, 0.0);
  CHECK_EQUAL(rig_step(&rig), PG_FAULT_OBSTACLE_INSIDE);
  CHECK_EQUAL(rig.cycle->circulating, 0);
  CHECK(pg_step(rig.controller, NULL, rig.xdot, &rig.seen, rig.qdot) == PG_ERROR_NULL);
  CHECK(memcmp(state_of(&rig), &before, sizeof before) == 0);

  CHECK(pg_reset(rig.controller) == PG_SOLVED);
  CHECK_EQUAL(state_of(&rig)->circulating, 0);
  CHECK_EQUAL(state_of(&rig)->blend, 0.0);
  CHECK_EQUAL(state_of(&rig)->since, 1e20);
  CHECK_EQUAL(pg_dot(state_of(&rig)->tangent, state_of(&rig)->tangent), 0.0);
  rig_close(&rig);
}

int main(void) {
  candidates_are_tangents();
  a_tool_that_is_stuck();
  a_tool_that_is_not_stuck();
  stalling_is_forgotten();
  the_way_is_free();
  the_tangent_follows_the_surface();
  another_way_round();
  times_of_whole_cycles();
  the_time_limit();
  failing_is_forgotten();
  another_way_along_the_surface();
  weights_of_the_present_way();
  which_way();
  faults_and_resets();
  return checks_failed > 0;
}
