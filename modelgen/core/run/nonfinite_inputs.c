/* Functions of time that are not finite, or grow beyond all bounds: loads, paths of driven bodies, given motions of
   joints. Looked for where a run cannot go on, with the bodies where they are. */
#include "run/run.h"
#include "base/base.h"
#include "model/model.h"
#include "timestep/timestep.h"

enum { MG_JOINT_ROWS = 6 }; /* of a joint, at most */

static mg_real mg_largest_of(const mg_real *values, int n, mg_real size) {
  for (int i = 0; i < n; i++) {
    const mg_real value = fabs(values[i]);
    if (!(value <= MG_MAX)) return MG_MAX;
    if (value > size) size = value;
  }
  return size;
}

/* Of the force and torque of a load on bodies that it moves, N or N m. */
static mg_real mg_load_size(const mg_context *c, int load, mg_real t) {
  const int body[2] = {c->system->load_a[load], c->system->load_b[load]};
  mg_real wrench[12] = {0}, size = 0;
  mg_load_wrench(c, t, load, wrench);
  for (int side = 0; side < 2; side++)
    if (body[side] >= 0 && mg_moves(c, body[side]))
      size = mg_largest_of(wrench + 6 * side, c->kernels->body_kinds[mg_kind_of(c, body[side])].n_u, size);
  return size;
}

/* Of the pose, velocity and acceleration of a driven body. */
static mg_real mg_path_size(const mg_context *c, int body, mg_real t) {
  mg_real place[24] = {0};
  if (!mg_is_driven(c->system, body)) return 0;
  c->kernels->body_path(mg_kind_of(c, body), &t, c->system->parameters + c->system->body_parameters[body], place,
                        place + 12, place + 18);
  return mg_largest_of(place, 24, 0);
}

/* Of what the rows of a joint whose motion is given ask of its bodies, where they are. */
static mg_real mg_motion_size(const mg_context *c, int joint, mg_real t) {
  const mg_system *s = c->system;
  const int kind = s->joint_kind[joint], a = s->joint_a[joint], b = s->joint_b[joint];
  mg_real row[3 * MG_JOINT_ROWS] = {0}, J[12 * MG_JOINT_ROWS];
  if (!c->kernels->joint_kinds[kind].prescribed) return 0;
  c->kernels->joint_rows(kind, &t, c->pose + 12 * a, c->twist + 6 * a, c->pose + 12 * b, c->twist + 6 * b,
                         s->parameters + s->joint_parameters[joint], row, J, row + MG_JOINT_ROWS,
                         row + 2 * MG_JOINT_ROWS);
  return mg_largest_of(row, 3 * MG_JOINT_ROWS, 0);
}

/* The largest value of a function at t, MG_MAX if one is not finite: loads, then bodies, then joints by number. */
static mg_real mg_size_of(const mg_context *c, int function, mg_real t) {
  const int body = function - c->system->n_load, joint = body - c->system->n_body;
  return body < 0 ? mg_load_size(c, function, t) : joint < 0 ? mg_path_size(c, body, t) : mg_motion_size(c, joint, t);
}

/* So far before t or after it, whichever is larger. */
static mg_real mg_size_around(const mg_context *c, int function, mg_real far) {
  const mg_real before = mg_size_of(c, function, c->run->t - far), after = mg_size_of(c, function, c->run->t + far);
  return before > after ? before : after;
}

/* Whether a function grows towards t, from step_min^(1/4) T away over step_min^(1/2) T, faster than the power -2/3 of
   the time that is left, and on: at a jump, a short pulse or a root it does not. */
static int mg_has_pole(const mg_context *c, int function) {
  const mg_real least = c->settings->step_min, half = sqrt(least), period = c->system->time;
  const mg_real mid = mg_size_around(c, function, half * period), here = mg_size_around(c, function, least * period);
  return here > 4 * mid && mid > mg_size_around(c, function, sqrt(half) * period) / pow(least, (mg_real)1 / 6);
}

static int mg_is_infinite(const mg_context *c, int function, mg_real ahead) {
  const mg_real t = c->run->t;
  if (mg_size_of(c, function, t) >= MG_MAX) return 1;
  for (mg_real far = ahead; far > c->settings->step_min * c->system->time; far /= 2)
    if (mg_size_of(c, function, t + far) >= MG_MAX) return 1;
  return 0;
}

/* The first that is not finite now, so far ahead, half as far and so on, or has a pole here; -1 for none. Leaves the
   poses at run->x. */
static int mg_first_unbounded(mg_context *c, mg_real ahead) {
  if (!mg_all_finite(c->n_states, c->run->x)) return -1;
  mg_update_poses(c, c->run->t, c->run->x);
  for (int i = 0; i < c->system->n_load + c->system->n_body + c->system->n_joint; i++)
    if (mg_is_infinite(c, i, ahead) || mg_has_pole(c, i)) return i;
  return -1;
}

/* The outcome that says why: forces are not to be had where functions of time are not finite, and steps shrink before a
 * pole. */
MG_INTERNAL int mg_explain_outcome(mg_context *c, int outcome) {
  const mg_real ahead = c->settings->look * c->system->time;
  return mg_needs_fallback(outcome) && mg_first_unbounded(c, ahead) >= 0 ? MG_NOT_FINITE : outcome;
}

/* The length of the step that ended a run as not finite: an adaptive one has been shortened since. */
static mg_real mg_step_tried(const mg_context *c) {
  const int shortened = c->settings->method == MG_DOP853 && !mg_is_time_stepping(c);
  return shortened ? mg_next_step(c) / MG_NONFINITE_STEP_CUT : mg_next_step(c);
}

MG_API int mg_unbounded(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real *work, int *iwork) {
  mg_context c;
  mg_open_context(&c, system, settings, run, work, iwork);
  return mg_first_unbounded(&c, fmax(mg_step_tried(&c), settings->look * system->time));
}
