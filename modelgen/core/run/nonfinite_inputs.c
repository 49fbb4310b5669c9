/* Functions of time that are not finite or have a pole: loads, paths of driven bodies, prescribed joint motions.
   They are examined where a run cannot go on, at the present poses. Writes poses only. */
#include "run/run.h"
#include "base/base.h"
#include "model/model.h"
#include "timestep/timestep.h"

enum { MG_JOINT_ROWS = 6 }; /* most rows of a joint */

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
  mg_load_wrench(c, t, load, wrench);
  for (int side = 0; side < 2; side++)
    if (body[side] >= 0 && mg_is_moved_by_forces(c, body[side]))
      size = mg_largest_magnitude(wrench + 6 * side, c->kernels->body_kinds[mg_body_kind_of(c, body[side])].n_u, size);
  return size;
}

/* Largest component of pose, velocity and acceleration of a driven body. */
static mg_real mg_driven_path_magnitude(const mg_context *c, int body, mg_real t) {
  mg_real place[24] = {0};
  if (!mg_is_driven_body(c->system, body)) return 0;
  c->kernels->body_path(mg_body_kind_of(c, body), &t, c->system->parameters + c->system->body_parameters[body], place,
                        place + 12, place + 18);
  return mg_largest_magnitude(place, 24, 0);
}

/* Largest component that the rows of a prescribed joint motion require of its bodies. */
static mg_real mg_joint_motion_magnitude(const mg_context *c, int joint, mg_real t) {
  const mg_system *s = c->system;
  const int kind = s->joint_kind[joint], a = s->joint_a[joint], b = s->joint_b[joint];
  mg_real row[3 * MG_JOINT_ROWS] = {0}, J[12 * MG_JOINT_ROWS];
  if (!c->kernels->joint_kinds[kind].prescribed) return 0;
  c->kernels->joint_rows(kind, &t, c->bodies.pose + 12 * a, c->bodies.twist + 6 * a, c->bodies.pose + 12 * b,
                         c->bodies.twist + 6 * b, s->parameters + s->joint_parameters[joint], row, J,
                         row + MG_JOINT_ROWS, row + 2 * MG_JOINT_ROWS);
  return mg_largest_magnitude(row, 3 * MG_JOINT_ROWS, 0);
}

/* Largest value of a function of time at t, MG_MAX if one is not finite; loads, bodies and joints are numbered in
   this order. */
static mg_real mg_time_function_magnitude(const mg_context *c, int function, mg_real t) {
  const int body = function - c->system->n_load, joint = body - c->system->n_body;
  return body < 0    ? mg_load_magnitude(c, function, t)
         : joint < 0 ? mg_driven_path_magnitude(c, body, t)
                     : mg_joint_motion_magnitude(c, joint, t);
}

/* Larger of the magnitudes of a function of time `far` before and after the present time. */
static mg_real mg_magnitude_near_time(const mg_context *c, int function, mg_real distance) {
  const mg_real before = mg_time_function_magnitude(c, function, c->run->t - distance),
                after = mg_time_function_magnitude(c, function, c->run->t + distance);
  return before > after ? before : after;
}

/* True if a function of time grows towards the present time, between step_min^(1/4) T and step_min T away, faster
   than the power -2/3 of the time left. At a jump, a short pulse or a root it does not. */
static int mg_has_pole(const mg_context *c, int function) {
  const mg_real least = c->settings->step_min, near_part = sqrt(least), period = c->system->time;
  const mg_real mid = mg_magnitude_near_time(c, function, near_part * period),
                here = mg_magnitude_near_time(c, function, least * period);
  return here > 4 * mid &&
         mid > mg_magnitude_near_time(c, function, sqrt(near_part) * period) / pow(least, (mg_real)1 / 6);
}

/* True if a function of time is not finite now or at one of the halved distances ahead. */
static int mg_is_nonfinite_ahead(const mg_context *c, int function, mg_real ahead) {
  const mg_real t = c->run->t;
  if (mg_time_function_magnitude(c, function, t) >= MG_MAX) return 1;
  for (mg_real distance = ahead; distance > c->settings->step_min * c->system->time; distance /= 2)
    if (mg_time_function_magnitude(c, function, t + distance) >= MG_MAX) return 1;
  return 0;
}

/* First function of time that is not finite now or ahead, or has a pole here, or -1. Leaves the poses at the
   run's state. */
static int mg_first_unbounded_function(mg_context *c, mg_real ahead) {
  if (!mg_are_states_finite(c, c->run->x)) return -1;
  mg_update_poses(c, c->run->t, c->run->x);
  for (int i = 0; i < c->system->n_load + c->system->n_body + c->system->n_joint; i++)
    if (mg_is_nonfinite_ahead(c, i, ahead) || mg_has_pole(c, i)) return i;
  return -1;
}

MG_INTERNAL int mg_explain_failed_outcome(mg_context *c, int outcome) {
  const mg_real ahead = c->settings->time_resolution * c->system->time;
  return mg_is_fallback_outcome(outcome) && mg_first_unbounded_function(c, ahead) >= 0 ? MG_NOT_FINITE : outcome;
}

/* Length of the step that ended a run as not finite; an adaptive step has been shortened since. */
static mg_real mg_last_tried_step(const mg_context *c) {
  const int shortened = c->settings->method == MG_DOP853 && !mg_is_time_stepping(c);
  return shortened ? mg_next_step(c) / MG_NONFINITE_STEP_CUT : mg_next_step(c);
}

MG_API int mg_unbounded(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real *work, int *iwork) {
  mg_context c;
  mg_open_context(&c, system, settings, run, work, iwork);
  return mg_first_unbounded_function(&c, fmax(mg_last_tried_step(&c), settings->time_resolution * system->time));
}
