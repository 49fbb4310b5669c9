/* Loads that are not finite, or grow beyond all bounds, as functions of time: looked for where a run cannot go on, with the
   bodies where they are. */
#include "core.h"

/* The largest force or torque of a load on bodies that it moves, N or N m; MG_MAX if one is not finite. */
static mg_real mg_load_size(const mg_context *c, int load, mg_real t) {
  const int body[2] = {c->sys->load_a[load], c->sys->load_b[load]};
  mg_real wrench[12] = {0}, size = 0;
  mg_wrench(c, t, load, wrench);
  for (int side = 0; side < 2; side++) {
    if (body[side] < 0 || !mg_moves(c, body[side])) continue;
    for (int i = 0; i < mg_body_kinds[mg_kind_of(c, body[side])].n_u; i++) {
      const mg_real part = fabs(wrench[6 * side + i]);
      if (!(part <= MG_MAX)) return MG_MAX;
      if (part > size) size = part;
    }
  }
  return size;
}

/* The size of a load so far before t or after it, whichever is larger. */
static mg_real mg_load_around(const mg_context *c, int load, mg_real far) {
  const mg_real before = mg_load_size(c, load, c->run->t - far), after = mg_load_size(c, load, c->run->t + far);
  return before > after ? before : after;
}

/* Whether a load grows towards t, from step_min^(1/4) T away over step_min^(1/2) T, faster than the power -2/3 of the time
   that is left, and on: at a jump, a short pulse or a root it does not. */
static int mg_has_pole(const mg_context *c, int load) {
  const mg_real least = c->set->step_min, half = sqrt(least), period = c->sys->time;
  const mg_real mid = mg_load_around(c, load, half * period), here = mg_load_around(c, load, least * period);
  return here > 4 * mid && mid > mg_load_around(c, load, sqrt(half) * period) / pow(least, (mg_real)1 / 6);
}

static int mg_is_infinite(const mg_context *c, int load, mg_real ahead) {
  const mg_real t = c->run->t;
  for (int k = 0; k < 3; k++)
    if (mg_load_size(c, load, t + k * ahead / 2) >= MG_MAX) return 1;
  return 0;
}

/* The first load that is not finite now, half a step ahead or a step, or has a pole here; -1 for none. Leaves the poses at
   run->x. */
static int mg_first_odd_load(mg_context *c, mg_real ahead) {
  if (!mg_finite(c->run->x, c->n_x)) return -1;
  mg_poses(c, c->run->t, c->run->x);
  for (int i = 0; i < c->sys->n_load; i++)
    if (mg_is_infinite(c, i, ahead) || mg_has_pole(c, i)) return i;
  return -1;
}

/* The outcome that says why: forces are not to be had where loads are not finite, and steps shrink before a pole. */
static int mg_verdict(mg_context *c, int outcome) {
  return mg_is_closed_to_events(outcome) && mg_first_odd_load(c, 0) >= 0 ? MG_NOT_FINITE : outcome;
}

/* The length of the step that ended a run as not finite: an adaptive one has been shortened since. */
static mg_real mg_step_tried(const mg_context *c) {
  const int shortened = c->set->method == MG_DOP853 && !mg_steps_in_time(c);
  return shortened ? mg_next_step(c) / MG_SHORTER : mg_next_step(c);
}

MG_API int mg_odd_load(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real *work, int *iwork) {
  mg_context c;
  mg_open(&c, system, settings, run, work, iwork);
  return mg_first_odd_load(&c, mg_step_tried(&c));
}
