/* Parameters that stay settable at run time: read, checked and put in force as a whole. */
#include "state.h"

/* The block is an array of doubles, whatever their names. */
#define COUNT ((int)(sizeof(pg_parameters_t) / sizeof(double)))
_Static_assert(sizeof(pg_parameters_t) % sizeof(double) == 0, "pg_parameters_t holds doubles only");

static int all_in_range(const pg_parameters_t *parameters) {
  const double *value = (const double *)parameters;
  const double *lower = (const double *)&pg_model_lower_parameters;
  const double *upper = (const double *)&pg_model_upper_parameters;
  for (int i = 0; i < COUNT; i++)
    if (!(value[i] >= lower[i] && value[i] <= upper[i])) /* refuses NaN too */
      return 0;
  return 1;
}

int pg_parameters_allowed(const pg_parameters_t *p) {
  if (!all_in_range(p)) return 0;
  for (int j = 0; j < PG_N; j++)
    if (!(p->q_lower[j] < p->q_upper[j])) return 0;
  const int thresholds_in_order = p->d_a > p->d_0u && p->d_0u >= p->d_0l && p->d_0l > p->d_r && p->d_r >= 0.0;
  const int damper_in_order = p->damper_influence > p->damper_safety;
  const int viability_is_a_switch = p->viability == 0.0 || p->viability == 1.0;
#if PG_SELF_POINTS
  if (!(p->self_d_a > p->self_d_0u && p->self_d_0u >= p->self_d_0l && p->self_d_0l > p->self_d_r)) return 0;
#endif
  return thresholds_in_order && damper_in_order && viability_is_a_switch;
}

pg_status_t pg_get_parameters(const pg_controller_t *controller, pg_parameters_t *parameters) {
  if (!pg_alive(controller) || !parameters) return PG_ERROR_NULL;
  *parameters = controller->parameters;
  return PG_SOLVED;
}

pg_status_t pg_set_parameters(pg_controller_t *controller, const pg_parameters_t *parameters) {
  if (!pg_alive(controller) || !parameters) return PG_ERROR_NULL;
  if (!pg_parameters_allowed(parameters)) return PG_ERROR_PARAMETER;
  controller->parameters = *parameters;
  return PG_SOLVED;
}
