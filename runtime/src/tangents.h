/* Directions along an obstacle, and the part of the task that moves the tool: what circulation and the
 * tangential method share. Compiled only where one of them is on. */
#ifndef PROXGEN_TANGENTS_H
#define PROXGEN_TANGENTS_H

#include "robot.h"

/* Candidates per normal, one every 15 degrees. */
#define PG_TANGENTS 24

/* A candidate is better only if its score is greater by more than this: rounding must not decide. */
#define PG_BETTER 1e-9

/* A slower task velocity has no direction. */
#define PG_LEAST_VELOCITY 1e-9 /* [m/s] */

/* First two columns of a right-handed basis of a unit vector: the x axis made normal to it and of length 1,
 * or the y axis where x is close to it; and direction x first. */
void pg_basis(const double direction[3], double first[3], double second[3]);

/* Candidates c_i = cos(2 pi i/24) e1 + sin(2 pi i/24) e2 of a unit vector. */
void pg_tangents(const double direction[3], double candidates[PG_TANGENTS][3]);

/* The rows x, y, z of a task velocity; 0 for those that the task lacks. */
void pg_linear_part(const double velocity[PG_M], double linear[3]);

/* Puts x, y, z into the rows that the task has. */
void pg_set_linear_part(const double linear[3], double velocity[PG_M]);

/* Sets to 0 what the task lacks of x, y, z. */
void pg_only_task_axes(double vector[3]);

#endif
