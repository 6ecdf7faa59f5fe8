#include "model.h"

#include <math.h>

const planar_parameters_t planar_default_parameters = {
    .q_lower = {-2.5, -2.5},
    .q_upper = {2.5, 2.5},
    .qdot_limit = {1.5, 2.0},
    .qddot_limit = {20.0, 20.0},
    .joint_damper = 5.0,
    .viability = 0.0,
    .limit_tolerance = 0.1,
    .period = 0.02,
    .max_period = 0.0,
    .sensor_timeout = 0.1,
    .d_a = 0.30,
    .d_0u = 0.25,
    .d_0l = 0.22,
    .d_r = 0.17,
    .approach_speed = 0.2,
    .repulse_speed = -0.2,
    .damper_influence = 0.32,
    .damper_safety = 0.22,
    .damper_gain = 6.0,
    .damper_repulse_speed = -0.4,
    .row_speed = 1.0,
    .d_active = 0.30,
    .damping_gain = 0.1,
    .damping_threshold = 0.001,
    .damping_floor = 1e-3,
    .slack_weight = 100.0,
    .slack_minimum = 0.1,
    .slack_maximum = 2.0,
    .slack_active_weight = 10.0,
    .posture_weight = {0.0, 0.0},
    .posture_gain = 1.0,
    .posture = {0.0, 0.0},
#if PLANAR_SELF_COLLISION
    .self_d_a = 0.10,
    .self_d_0u = 0.07,
    .self_d_0l = 0.05,
    .self_d_r = 0.03,
#endif
#if PLANAR_SELF_MEASUREMENT
    .self_measurement_margin = 0.03,
#endif
#if PLANAR_MEMORY
    .memory_age = 10.0,
    .memory_merge = 0.04,
    .memory_margin = 0.10,
    .memory_reach = 0.5,
#endif
#if PLANAR_CIRCULATION
    .circulation_speed = 0.2,
    .stall_time = 0.5,
    .stall_fraction = 0.2,
    .circulation_release_time = 0.2,
    .circulation_patience = 1.0,
    .circulation_time_limit = 12.0,
    .circulation_blend_time = 0.1,
    .circulation_bias_z = 0.5,
#endif
#if PLANAR_TANGENTIAL
    .tangential_speed = 0.1,
#endif
};

#define LEAST 1e-9 /* the least of what has to be positive */

const planar_parameters_t planar_lower_parameters = {
    .q_lower = {-1e20, -1e20},
    .q_upper = {-1e20, -1e20},
    .qdot_limit = {LEAST, LEAST},
    .qddot_limit = {LEAST, LEAST},
    .joint_damper = LEAST,
    .period = LEAST,
    .sensor_timeout = LEAST,
    .approach_speed = LEAST,
    .repulse_speed = -1e20,
    .damper_gain = LEAST,
    .damper_repulse_speed = -1e20,
    .row_speed = LEAST,
    .d_active = LEAST,
    .damping_floor = 1e-6,
    .slack_weight = LEAST,
    .slack_minimum = LEAST,
    .slack_maximum = LEAST,
    .slack_active_weight = LEAST,
    .posture = {-1e20, -1e20},
#if PLANAR_MEMORY
    .memory_age = LEAST,
    .memory_reach = LEAST,
#endif
#if PLANAR_CIRCULATION
    .circulation_speed = LEAST,
    .circulation_time_limit = LEAST,
    .circulation_blend_time = LEAST,
    .circulation_bias_x = -1e20,
    .circulation_bias_y = -1e20,
    .circulation_bias_z = -1e20,
#endif
};

const planar_parameters_t planar_upper_parameters = {
    .q_lower = {1e20, 1e20},
    .q_upper = {1e20, 1e20},
    .qdot_limit = {1e20, 1e20},
    .qddot_limit = {1e20, 1e20},
    .joint_damper = 1e20,
    .viability = 1.0,
    .limit_tolerance = 1e20,
    .period = 1e20,
    .max_period = 1e20,
    .sensor_timeout = 1e20,
    .d_a = 1e20,
    .d_0u = 1e20,
    .d_0l = 1e20,
    .d_r = 1e20,
    .approach_speed = 1e20,
    .repulse_speed = 0.0,
    .damper_influence = 1e20,
    .damper_safety = 1e20,
    .damper_gain = 1e20,
    .damper_repulse_speed = 0.0,
    .row_speed = 1e20,
    .d_active = 1e20,
    .damping_gain = 1e20,
    .damping_threshold = 1e20,
    .damping_floor = 1e20,
    .slack_weight = 1e20,
    .slack_minimum = 1e20,
    .slack_maximum = 1e20,
    .slack_active_weight = 1e20,
    .posture_weight = {1e20, 1e20},
    .posture_gain = 1e20,
    .posture = {1e20, 1e20},
#if PLANAR_SELF_COLLISION
    .self_d_a = 1e20,
    .self_d_0u = 1e20,
    .self_d_0l = 1e20,
    .self_d_r = 1e20,
#endif
#if PLANAR_SELF_MEASUREMENT
    .self_measurement_margin = 1e20,
#endif
#if PLANAR_MEMORY
    .memory_age = 1e20,
    .memory_merge = 1e20,
    .memory_margin = 1e20,
    .memory_reach = 1e20,
#endif
#if PLANAR_CIRCULATION
    .circulation_speed = 1e20,
    .stall_time = 1e20,
    .stall_fraction = 1e20,
    .circulation_release_time = 1e20,
    .circulation_patience = 1e20,
    .circulation_time_limit = 1e20,
    .circulation_blend_time = 1e20,
    .circulation_bias_x = 1e20,
    .circulation_bias_y = 1e20,
    .circulation_bias_z = 1e20,
#endif
#if PLANAR_TANGENTIAL
    .tangential_speed = 1e20,
#endif
};

const pg_capsule_t planar_capsules[PLANAR_CAPSULES] = {
    {.body = 0, .start = {0, 0, 0}, .end = {PLANAR_LENGTH, 0, 0}, .radius = 0.05},
    {.body = 1, .start = {0, 0, 0}, .end = {PLANAR_LENGTH, 0, 0}, .radius = 0.05},
    {.body = 0,
     .start = {PLANAR_LENGTH, 0, 0},
     .end = {PLANAR_LENGTH, 0, 0},
     .radius = 0.07,
     .reference_radius = 0.07},
};

const pg_sensor_t planar_tof[PLANAR_TOF] = {
    {.body = 0, .position = {0.25, 0.05, 0}, .normal = {0, 1, 0}, .range = 1.0},
    {.body = 0, .position = {0.25, -0.05, 0}, .normal = {0, -1, 0}, .range = 1.0},
    {.body = 1, .position = {0.25, 0.05, 0}, .normal = {0, 1, 0}, .range = 1.0},
    {.body = 1, .position = {0.25, -0.05, 0}, .normal = {0, -1, 0}, .range = 1.0},
};

const pg_sensor_t planar_capacitive[PLANAR_CAPACITIVE] = {
    {.body = 1, .position = {0.4, 0.05, 0}, .normal = {0, 1, 0}, .range = 0.08},
    {.body = 1, .position = {0.4, -0.05, 0}, .normal = {0, -1, 0}, .range = 0.08},
};

#if PLANAR_SELF_MEASUREMENT
#define SIN_30 0.5
#define COS_30 0.86602540378443865
/* The normal is along y, so that the basis begins with x. */
#define RAYS(y)                                                                                              \
  {                                                                                                          \
    {0, y, 0}, {SIN_30, y * COS_30, 0}, {0, y * COS_30, SIN_30}, {-SIN_30, y * COS_30, 0}, {                 \
      0, y *COS_30, -SIN_30                                                                                  \
    }                                                                                                        \
  }
const double planar_tof_rays[PLANAR_TOF][5][3] = {RAYS(1), RAYS(-1), RAYS(1), RAYS(-1)};
const pg_cone_t planar_capacitive_cones[PLANAR_CAPACITIVE] = {{.reach = 0.12, .cosine = 0.5},
                                                              {.reach = 0.12, .cosine = 0.5}};
#endif

#if PLANAR_MEMORY
/* cos(15 degrees): sensors see through in half of their opening angle. */
#define COS_15 0.96592582628906829
const double planar_tof_see_through[PLANAR_TOF] = {COS_15, COS_15, COS_15, COS_15};
#endif

static double least(double a, double b) {
  return a < b ? a : b;
}

static double greatest(double a, double b) {
  return a > b ? a : b;
}

/* Writes the pose of a frame that is turned by `angle` about z at (x, y, 0). */
static void set_pose(double angle, double x, double y, double pose[12]) {
  const double c = cos(angle), s = sin(angle);
  const double values[12] = {c, -s, 0, x, s, c, 0, y, 0, 0, 1, 0};
  for (int i = 0; i < 12; i++)
    pose[i] = values[i];
}

int planar_kinematics(const double q[2], planar_kinematics_t *k) {
  const double elbow[2] = {PLANAR_LENGTH * cos(q[0]), PLANAR_LENGTH * sin(q[0])};
  const double tool[2] = {elbow[0] + PLANAR_LENGTH * cos(q[0] + q[1]),
                          elbow[1] + PLANAR_LENGTH * sin(q[0] + q[1])};
  set_pose(q[0], 0.0, 0.0, k->body_to_world[0]);
  set_pose(q[0] + q[1], elbow[0], elbow[1], k->body_to_world[1]);
  set_pose(q[0] + q[1], tool[0], tool[1], k->tool_to_world);
  for (int j = 0; j < 2; j++) {
    const double origin[3] = {j ? elbow[0] : 0.0, j ? elbow[1] : 0.0, 0.0};
    for (int i = 0; i < 3; i++) {
      k->joint_origin[j][i] = origin[i];
      k->joint_axis[j][i] = i == 2;
    }
    k->J[j] = -(tool[1] - origin[1]);
    k->J[2 + j] = tool[0] - origin[0];
  }
  return 0;
}

int planar_row(int body, const planar_kinematics_t *k, const double point[3], const double direction[3],
               double row[2]) {
  for (int j = 0; j < 2; j++) {
    const double x = point[0] - k->joint_origin[j][0], y = point[1] - k->joint_origin[j][1];
    row[j] = j <= body ? -direction[0] * y + direction[1] * x : 0.0;
  }
  return 0;
}

int planar_objective(const planar_parameters_t *p, const planar_kinematics_t *k, const double q[2],
                     const double xdot[2], double H[4], double g[2], double *manipulability,
                     double *damping) {
  const double *J = k->J;
  const double w = fabs(J[0] * J[3] - J[1] * J[2]), ratio = 1.0 - w / p->damping_threshold;
  *manipulability = w;
  *damping = greatest(p->damping_floor, w < p->damping_threshold ? p->damping_gain * ratio * ratio : 0.0);
  for (int i = 0; i < 2; i++) {
    for (int j = 0; j < 2; j++)
      H[2 * i + j] = J[i] * J[j] + J[2 + i] * J[2 + j] + (i == j ? *damping + p->posture_weight[i] : 0.0);
    g[i] = -J[i] * xdot[0] - J[2 + i] * xdot[1] -
           p->posture_weight[i] * p->posture_gain * (p->posture[i] - q[i]);
  }
  return 0;
}

/* Greatest velocity towards a limit that is `distance` away. */
static double limit_speed(const planar_parameters_t *p, int joint, double distance) {
  double speed = least(p->qdot_limit[joint], p->joint_damper * distance);
  if (p->viability > 0.5) {
    const double a = p->qddot_limit[joint], T = greatest(1.0 / p->joint_damper, p->period);
    const double beyond = greatest(distance - a * T * T, 0.0), fastest = a * (T + p->period);
    speed = least(speed, least(distance / T, sqrt(fastest * fastest + 2.0 * a * beyond) - a * p->period));
  }
  return distance <= 0.0 ? 0.0 : speed;
}

int planar_bounds(const planar_parameters_t *p, const double q[2], const double qdot_previous[2],
                  double lb[2], double ub[2]) {
  for (int j = 0; j < 2; j++) {
    const double low = -limit_speed(p, j, q[j] - p->q_lower[j]),
                 high = limit_speed(p, j, p->q_upper[j] - q[j]);
    const double step = p->qddot_limit[j] * p->period;
    lb[j] = least(greatest(low, qdot_previous[j] - step), high);
    ub[j] = greatest(least(high, qdot_previous[j] + step), low);
  }
  return 0;
}

#if PLANAR_SELF_COLLISION || !PLANAR_SCHEDULE_DAMPER
/* The law (13). */
static double law(const planar_parameters_t *p, double d, double d_a, double d_0u, double d_0l, double d_r) {
  if (d > d_0u) return p->approach_speed * (d - d_0u) / (d_a - d_0u);
  if (d > d_0l) return 0.0;
  return d > d_r ? p->repulse_speed * (d_0l - d) / (d_0l - d_r) : p->repulse_speed;
}
#endif

int planar_approach_speed(const planar_parameters_t *p, double d, double *speed) {
#if PLANAR_SCHEDULE_DAMPER
  *speed = d > p->damper_safety
               ? p->approach_speed * (d - p->damper_safety) / (p->damper_influence - p->damper_safety)
               : greatest(p->damper_repulse_speed, p->damper_gain * (d - p->damper_safety));
#else
  *speed = law(p, d, p->d_a, p->d_0u, p->d_0l, p->d_r);
#endif
  return 0;
}

static double soft_weight(const planar_parameters_t *p, double d, double d_a, double d_r) {
  const double ramp = least(greatest((d_a - d) / (d_a - d_r), p->slack_minimum), p->slack_maximum);
  return p->slack_weight * ramp * ramp;
}

int planar_slack_weight(const planar_parameters_t *p, double d, double *weight) {
  *weight = soft_weight(p, d, p->d_a, p->d_r);
  return 0;
}

#if PLANAR_SELF_COLLISION
const pg_self_point_t planar_self_points[PLANAR_SELF_POINTS] = {
    {.body = 1, .position = {PLANAR_LENGTH, 0, 0}, .radius = 0.02},
    {.body = 0, .position = {0.1, -0.1, 0}, .radius = 0.03},
};

const unsigned char planar_self_pairs[PLANAR_SELF_POINTS][PLANAR_CAPSULES] = {{1, 0, 1}, {0, 1, 0}};

/* The first joint moves all; the second one the forearm, or the point that it carries. */
int planar_self_row(int body, int carrier, const planar_kinematics_t *k, const double point[3],
                    const double carried[3], const double direction[3], double row[2]) {
  const double *moved = body > carrier ? point : carried;
  row[0] = 0.0;
  row[1] =
      -direction[0] * (moved[1] - k->joint_origin[1][1]) + direction[1] * (moved[0] - k->joint_origin[1][0]);
  if (body < carrier) row[1] = -row[1];
  return body == carrier;
}

int planar_self_approach_speed(const planar_parameters_t *p, double d, double *speed) {
  *speed = law(p, d, p->self_d_a, p->self_d_0u, p->self_d_0l, p->self_d_r);
  return 0;
}

int planar_self_slack_weight(const planar_parameters_t *p, double d, double *weight) {
  *weight = soft_weight(p, d, p->self_d_a, p->self_d_r);
  return 0;
}
#endif

int planar_closest_point(const double point[3], const double start[3], const double end[3],
                         double closest[3]) {
  double along = 0.0, length = 0.0;
  for (int i = 0; i < 3; i++) {
    along += (point[i] - start[i]) * (end[i] - start[i]);
    length += (end[i] - start[i]) * (end[i] - start[i]);
  }
  const double t = length > 0.0 ? least(greatest(along / length, 0.0), 1.0) : 0.0;
  for (int i = 0; i < 3; i++)
    closest[i] = start[i] + t * (end[i] - start[i]);
  return 0;
}

int planar_sensor_point(const double pose[12], const double position[3], const double normal[3], double range,
                        double point[3]) {
  for (int i = 0; i < 3; i++) {
    point[i] = pose[4 * i + 3];
    for (int j = 0; j < 3; j++)
      point[i] += pose[4 * i + j] * (position[j] + range * normal[j]);
  }
  return 0;
}
