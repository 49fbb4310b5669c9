/* Inputs that the caller has changed between two calls of mg_advance. Writes velocities (by impacts), modes and events
   of the run. */
#include "run/run.h"
#include "model/model.h"
#include "forces/forces.h"
#include "events/events.h"
#include "timestep/timestep.h"

/* True if the prescribed velocity of a driven body differs between two settings of the inputs. */
static int mg_has_path_jump(const mg_context *c, int body, const mg_real *from, const mg_real *to) {
  mg_real pose[12], accel[6], before[6] = {0}, after[6] = {0};
  if (!mg_is_driven_body(c->system, body)) return 0;
  const mg_real *parameters = c->system->parameters + c->system->body_parameters[body], *t = &c->run->t;
  c->kernels->body_path(mg_body_kind_of(c, body), t, parameters, from, pose, before, accel);
  c->kernels->body_path(mg_body_kind_of(c, body), t, parameters, to, pose, after, accel);
  for (int k = 0; k < 6; k++)
    if (before[k] != after[k]) return 1;
  return 0;
}

/* True if the prescribed rate of a joint differs between two settings of the inputs. Needs the poses. */
static int mg_has_joint_motion_jump(const mg_context *c, int joint, const mg_real *from, const mg_real *to) {
  MG_NEEDS_ANY(c, MG_VALID_POSES);
  const mg_system *s = c->system;
  const int kind = s->joint_kind[joint], a = s->joint_a[joint], b = s->joint_b[joint];
  const mg_real *parameters = s->parameters + s->joint_parameters[joint], *pose = c->bodies.pose,
                *twist = c->bodies.twist, *t = &c->run->t;
  mg_real value[MG_JOINT_ROWS_MAX], J[12 * MG_JOINT_ROWS_MAX], gamma[MG_JOINT_ROWS_MAX];
  mg_real before[MG_JOINT_ROWS_MAX] = {0}, after[MG_JOINT_ROWS_MAX] = {0};
  if (!c->kernels->joint_kinds[kind].prescribed) return 0;
  c->kernels->joint_rows(kind, t, pose + 12 * a, twist + 6 * a, pose + 12 * b, twist + 6 * b, parameters, from, value,
                         J, gamma, before);
  c->kernels->joint_rows(kind, t, pose + 12 * a, twist + 6 * a, pose + 12 * b, twist + 6 * b, parameters, to, value, J,
                         gamma, after);
  for (int k = 0; k < c->kernels->joint_kinds[kind].n_rows; k++)
    if (before[k] != after[k]) return 1;
  return 0;
}

/* True if a prescribed velocity jumps with the new settings. Needs the poses. */
static int mg_has_prescribed_jump(const mg_context *c) {
  MG_NEEDS_AT_RUN(c, MG_VALID_POSES);
  const mg_real *from = c->run->applied_input, *to = c->run->input;
  for (int b = 0; b < c->system->n_body; b++)
    if (mg_has_path_jump(c, b, from, to)) return 1;
  for (int j = 0; j < c->system->n_joint; j++)
    if (mg_has_joint_motion_jump(c, j, from, to)) return 1;
  return 0;
}

MG_INTERNAL int mg_has_new_inputs(const mg_context *c) {
  for (int i = 0; i < 3 * c->system->n_input; i++)
    if (c->run->input[i] != c->run->applied_input[i]) return 1;
  return 0;
}

MG_INTERNAL void mg_accept_inputs(const mg_context *c) {
  for (int i = 0; i < 3 * c->system->n_input; i++) c->run->applied_input[i] = c->run->input[i];
}

MG_INTERNAL int mg_apply_inputs(mg_context *c, mg_events *events) {
  MG_NEEDS_AT_RUN(c, MG_VALID_POSES);
  if (!mg_has_new_inputs(c)) return MG_DONE;
  const int jumps = mg_has_prescribed_jump(c);
  mg_accept_inputs(c);
  if (mg_is_time_stepping(c)) {
    mg_recall_time_step(c);
    return MG_DONE;
  }
  mg_evaluate_run_state(c);
  if (c->system->n_friction) mg_begin_step_friction(c), mg_begin_step_patch_friction(c);
  int outcome;
  if (jumps) outcome = mg_settle_velocity_jump(c, events);
  else {
    mg_clear_triggered_events(c);
    outcome = mg_solve_contact_modes(c, events);
    mg_update_diagnostics(c);
  }
  outcome = mg_explain_failed_outcome(c, outcome);
  return mg_start_fallback(c, outcome, events) ? MG_DONE : outcome;
}
