/* A run behind the interface of FMI. Between initialisations the start is settled anew whenever an input has changed.
 */
#include "fmu.h"

#include <string.h>

void fmu_reset(fmu *instance, double t) {
  scene_init(&instance->scene);
  instance->scene.run.t = (mg_real)t;
  for (int k = 0; k < SCENE_N_INPUT; k++) instance->scene.run.input[3 * k + 2] = (mg_real)t;
  instance->is_settled = instance->is_stepping = 0;
  instance->outcome = MG_DONE;
}

void fmu_start_at(fmu *instance, double t) {
  mg_real input[3 * SCENE_N_INPUT + 1];
  memcpy(input, instance->scene.run.input, 3 * SCENE_N_INPUT * sizeof(mg_real));
  fmu_reset(instance, t);
  for (int k = 0; k < SCENE_N_INPUT; k++) memcpy(instance->scene.run.input + 3 * k, input + 3 * k, 2 * sizeof(mg_real));
}

int fmu_settle(fmu *instance) {
  if (instance->is_settled) return instance->outcome == MG_DONE;
  fmu_start_at(instance, (double)instance->scene.run.t);
  instance->outcome = scene_begin(&instance->scene);
  instance->is_settled = 1;
  return instance->outcome == MG_DONE;
}

/* The present value of an input, or its rate if it is linear. */
static double fmu_input(const fmu *instance, int k) {
  return (double)instance->scene.run.input[3 * k + (scene_input_is_linear[k] ? 1 : 0)];
}

int fmu_get(fmu *instance, const unsigned *numbers, size_t n, double *values) {
  mg_real sensors[SCENE_N_SENSOR + 1];
  int is_sensed = 0;
  for (size_t i = 0; i < n; i++) {
    const unsigned k = numbers[i];
    if (k == FMU_TIME) {
      values[i] = (double)instance->scene.run.t;
    } else if (k < FMU_FIRST_OUTPUT) {
      values[i] = fmu_input(instance, (int)(k - FMU_FIRST_INPUT));
    } else if (k < FMU_FIRST_STATE) {
      if (!fmu_settle(instance)) return 0;
      if (!is_sensed) scene_sense(&instance->scene, sensors), is_sensed = 1;
      values[i] = (double)sensors[k - FMU_FIRST_OUTPUT];
    } else if (k < FMU_FIRST_CONSTANT) {
      if (!fmu_settle(instance)) return 0;
      values[i] = (double)instance->scene.run.x[k - FMU_FIRST_STATE];
    } else if (k < FMU_DOUBTS) {
      values[i] = fmu_constants[k - FMU_FIRST_CONSTANT];
    } else if (k == FMU_DOUBTS) {
      if (!fmu_settle(instance)) return 0;
      values[i] = scene_doubts(&instance->scene, instance->outcome);
    } else {
      return 0;
    }
  }
  return 1;
}

int fmu_set(fmu *instance, const unsigned *numbers, size_t n, const double *values) {
  for (size_t i = 0; i < n; i++) {
    const unsigned k = numbers[i];
    if (k < FMU_FIRST_INPUT || k >= FMU_FIRST_OUTPUT) return 0;
    const int input = (int)(k - FMU_FIRST_INPUT);
    const mg_real value = (mg_real)values[i];
    if (!scene_takes_input(input, value)) return 0;
    if ((mg_real)fmu_input(instance, input) == value) continue;
    if (scene_input_is_linear[input]) scene_set_rate(&instance->scene, input, value);
    if (!scene_input_is_linear[input]) scene_set_input(&instance->scene, input, value);
    if (!instance->is_stepping) instance->is_settled = 0;
  }
  return 1;
}

int fmu_advance(fmu *instance, double t, double step, int *is_early) {
  scene_instance *scene = &instance->scene;
  const mg_real t_stop = (mg_real)(t + step);
  const long max_steps = instance->may_return_early ? 1 : 1000000;
  *is_early = 0;
  if (!fmu_settle(instance)) return 0;
  int code = MG_DONE;
  while (scene->run.t < t_stop) {
    code = scene_advance_part(scene, t_stop, max_steps, 0);
    if (code != MG_CONTINUE && code != MG_LIST_FULL) break;
    if (instance->may_return_early && scene->events.count && scene->run.t < t_stop) {
      *is_early = 1;
      return 1;
    }
  }
  instance->outcome = code == MG_CONTINUE || code == MG_LIST_FULL ? MG_DONE : code;
  return instance->outcome == MG_DONE;
}

void fmu_save(const fmu *instance, fmu_state *state) {
  memset(state, 0, sizeof *state);
  state->is_settled = instance->is_settled;
  state->is_stepping = instance->is_stepping;
  state->outcome = instance->outcome;
  scene_save(&instance->scene, state->bytes);
}

int fmu_load(fmu *instance, const fmu_state *state) {
  const int code = scene_load(&instance->scene, state->bytes, mg_save_size(instance->scene.system));
  if (code != MG_LOADED) return 0;
  instance->is_settled = state->is_settled;
  instance->is_stepping = state->is_stepping;
  instance->outcome = state->outcome;
  return 1;
}

const char *fmu_reason(int outcome) {
  switch (outcome) {
    case MG_PENETRATION:
      return "the start is refused: bodies penetrate";
    case MG_NO_EXTREMUM:
      return "the start is refused: no closest points are found for a contact";
    case MG_NO_OUTSIDE:
      return "the start is refused: it is not known on which side of each other two curves are";
    case MG_JOINT_APART:
      return "the start is refused: a joint is not assembled";
    case MG_BODY_WITHIN:
      return "the start is refused: a body is within another or passes through it";
    case MG_MARGIN:
      return "the run ended: a contact is too near to a singularity of its closest-point equations";
    case MG_STEP_TOO_SMALL:
      return "the run ended: its step is too small";
    case MG_NOT_FINITE:
      return "the run ended: a state or a function of time is not finite";
    case MG_COMPLEMENTARITY:
      return "the run ended: no contact forces were found";
    case MG_TOO_MANY_EVENTS:
      return "the run ended: too many events at one time";
    case MG_TOO_MANY_CLOSED:
      return "the run ended: too many contacts are closed";
    case MG_NO_FRICTION:
      return "the run ended: no forces satisfy Coulomb's law, or none were found";
    case MG_PENETRATED:
      return "the run ended: bodies penetrate";
    default:
      return "the run ended";
  }
}
