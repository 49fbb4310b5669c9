/* Functions of time that are not finite or have a pole: loads, paths of driven bodies, prescribed joint motions.
   They are examined where a run cannot go on, at the present poses. Writes poses only. */
#include "run/run.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"
#include "timestep/timestep.h"

/* Largest magnitude of n values and `size`; MG_MAX if one is not finite. */
static mg_real mg_largest_magnitude(const mg_real *values, int n, mg_real size) {
  for (int i = 0; i < n; i++) {
    const mg_real value = fabs(values[i]);
    if (!(value <= MG_MAX)) return MG_MAX;
    if (value > size) size = value;
  }
  return size;
}

/* Largest force or torque component of a load on bodies that it moves, N or N m. */
static mg_real mg_load_magnitude(const mg_context *c, int load, mg_real t) {
  const int body[2] = {c->system->load_a[load], c->system->load_b[load]};
  mg_real wrench[12] = {0}, size = 0;
  mg_written_load_wrench(c, t, load, wrench);
  for (int side = 0; side < 2; side++)
    if (body[side] >= 0 && mg_is_moved_by_forces(c, body[side]))
      size = mg_largest_magnitude(wrench + 6 * side, c->kernels->body_kinds[mg_body_kind_of(c, body[side])].n_u, size);
  return size;
}

/* Largest component of pose, velocity and acceleration of a driven body. */
static mg_real mg_driven_path_magnitude(const mg_context *c, int body, mg_real t) {
  mg_real place[24] = {0};
  if (!mg_is_driven_body(c->system, body)) return 0;
  c->kernels->body_path(mg_body_kind_of(c, body), &t, c->system->parameters + c->system->body_parameters[body],
                        c->run->input, place, place + 12, place + 18);
  return mg_largest_magnitude(place, 24, 0);
}

/* Largest component that the rows of a prescribed joint motion require of its bodies. */
static mg_real mg_joint_motion_magnitude(const mg_context *c, int joint, mg_real t) {
  const mg_system *s = c->system;
  const int kind = s->joint_kind[joint], a = s->joint_a[joint], b = s->joint_b[joint];
  mg_real row[3 * MG_JOINT_ROWS_MAX] = {0}, J[12 * MG_JOINT_ROWS_MAX];
  if (!c->kernels->joint_kinds[kind].prescribed) return 0;
  c->kernels->joint_rows(kind, &t, c->bodies.pose + 12 * a, c->bodies.twist + 6 * a, c->bodies.pose + 12 * b,
                         c->bodies.twist + 6 * b, s->parameters + s->joint_parameters[joint], c->run->input, row, J,
                         row + MG_JOINT_ROWS_MAX, row + 2 * MG_JOINT_ROWS_MAX);
  return mg_largest_magnitude(row, 3 * MG_JOINT_ROWS_MAX, 0);
}

MG_INTERNAL mg_real mg_time_function_magnitude(const mg_context *c, int function, mg_real t) {
  const int body = function - c->system->n_load, joint = body - c->system->n_body;
  return body < 0    ? mg_load_magnitude(c, function, t)
         : joint < 0 ? mg_driven_path_magnitude(c, body, t)
                     : mg_joint_motion_magnitude(c, joint, t);
}

/* Larger of the magnitudes of a function of time `distance` before and after the time t. */
static mg_real mg_magnitude_near_time(const mg_context *c, int function, mg_real t, mg_real distance) {
  const mg_real before = mg_time_function_magnitude(c, function, t - distance),
                after = mg_time_function_magnitude(c, function, t + distance);
  return before > after ? before : after;
}

MG_INTERNAL int mg_has_peak_at(const mg_context *c, int function, mg_real t) {
  const mg_real least = c->settings->step_min, period = c->system->time;
  return mg_magnitude_near_time(c, function, t, least * period) >
         4 * mg_magnitude_near_time(c, function, t, sqrt(least) * period);
}

MG_INTERNAL int mg_has_pole_at(const mg_context *c, int function, mg_real t) {
  const mg_real least = c->settings->step_min, near_part = sqrt(least), period = c->system->time;
  const mg_real mid = mg_magnitude_near_time(c, function, t, near_part * period);
  return mg_has_peak_at(c, function, t) &&
         mid > mg_magnitude_near_time(c, function, t, sqrt(near_part) * period) / mg_pow(least, (mg_real)1 / 6);
}

/* True if a function of time is not finite at t. */
static int mg_is_nonfinite_at(const mg_context *c, int function, mg_real t) {
  return mg_time_function_magnitude(c, function, t) >= MG_MAX;
}

/* True if a function of time is not finite now or at one of the halved distances ahead; `lasting`: where it is
   infinite at a single instant ahead, that does not count. */
static int mg_is_nonfinite_ahead(const mg_context *c, int function, mg_real ahead, int lasting) {
  const mg_real t = c->run->t, beside = c->settings->step_min * c->system->time;
  if (mg_is_nonfinite_at(c, function, t)) return 1;
  for (mg_real distance = ahead; distance > beside; distance /= 2)
    if (mg_is_nonfinite_at(c, function, t + distance) &&
        (!lasting || mg_is_nonfinite_at(c, function, t + distance + beside)))
      return 1;
  return 0;
}

/* First function of time that is not finite now or ahead, or has a pole here, or -1. Leaves the poses at the
   run's state. `lasting` as above. */
static int mg_first_unbounded_function(mg_context *c, mg_real ahead, int lasting) {
  if (!mg_are_states_finite(c, c->run->x)) return -1;
  mg_update_poses(c, c->run->t, c->run->x);
  for (int i = 0; i < c->system->n_load + c->system->n_body + c->system->n_joint; i++)
    if (mg_is_nonfinite_ahead(c, i, ahead, lasting) || mg_has_pole_at(c, i, c->run->t)) return i;
  return -1;
}

MG_INTERNAL int mg_explain_failed_outcome(mg_context *c, int outcome) {
  const mg_real ahead = c->settings->time_resolution * c->system->time;
  if (!mg_is_fallback_outcome(outcome)) return outcome;
  return mg_first_unbounded_function(c, ahead, 1) >= 0 || mg_check_contact_rows(c) ? MG_NOT_FINITE : outcome;
}

/* Length of the step that ended a run as not finite; an adaptive step has been shortened since. */
static mg_real mg_last_tried_step(const mg_context *c) {
  const int shortened = c->settings->method == MG_DOP853 && !mg_is_time_stepping(c);
  return shortened ? mg_next_step(c) / MG_NONFINITE_STEP_CUT : mg_next_step(c);
}

MG_API int mg_unbounded(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real *work, int *iwork) {
  mg_context c;
  mg_open_context(&c, system, settings, run, work, iwork);
  return mg_first_unbounded_function(&c, mg_max(mg_last_tried_step(&c), settings->time_resolution * system->time), 0);
}
