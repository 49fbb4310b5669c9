/* Driven bodies whose velocity jumps, as at the kink of max(0, t - 1): what they touch is struck, or let go. */
#include "events/events.h"
#include "model/model.h"
#include "forces/forces.h"
#include "impact/impact.h"

enum { MG_MOST_JERKS = 4096 }; /* parts of a step in which one is looked for */

typedef struct {
  mg_real t, twist[6], accel[6];
} mg_swing; /* a driven body at a time */

static mg_swing mg_swing_at(const mg_context *c, int body, mg_real t) {
  const mg_system *s = c->system;
  mg_swing swing = {t, {0}, {0}};
  mg_real pose[12];
  c->kernels->body_path(s->body_kind[body], &t, s->parameters + s->body_parameters[body], pose, swing.twist,
                        swing.accel);
  return swing;
}

/* By how much the velocity changes from one time to the other beyond what the acceleration tells, m/s; 0 where that
   tells most of it. */
static mg_real mg_jump(const mg_context *c, const mg_swing *from, const mg_swing *to) {
  mg_real untold = 0, whole = 0;
  for (int k = 0; k < 6; k++) {
    const mg_real arm = k < 3 ? 1 : c->system->length, change = to->twist[k] - from->twist[k];
    whole = fmax(whole, arm * fabs(change));
    untold = fmax(untold, arm * fabs(change - (to->t - from->t) / 2 * (from->accel[k] + to->accel[k])));
  }
  return untold > whole / 2 ? untold : 0;
}

/* A time so short that nothing else happens in it: at a kink itself its functions have the mean of both slopes. */
MG_INTERNAL mg_real mg_negligible_time(const mg_context *c) {
  const mg_real close = c->settings->event * c->system->time, seen = 8 * MG_EPS * fabs(c->run->t);
  return close > seen ? close : seen;
}

/* Halves the time in which the velocity of a body seems to jump, until it does so at once, or goes over smoothly (0).
 */
static int mg_pin_down(const mg_context *c, int body, mg_swing *from, mg_swing *to) {
  const mg_real rest = c->settings->rest_speed * c->system->length / c->system->time;
  mg_real jump = mg_jump(c, from, to);
  while (jump > rest && to->t - from->t > c->settings->event * c->system->time) {
    const mg_swing middle = mg_swing_at(c, body, from->t + (to->t - from->t) / 2);
    if (!(middle.t > from->t)) break;
    const mg_real first = mg_jump(c, from, &middle), second = mg_jump(c, &middle, to);
    *(second > first ? from : to) = middle;
    jump = fmax(first, second);
  }
  *to = mg_swing_at(c, body, to->t + mg_negligible_time(c));
  return jump > rest;
}

/* The first jump of a body's velocity within a step h from now: the times before and after it. */
static int mg_find_jerk_of(const mg_context *c, int body, mg_real h, mg_real *before, mg_real *after) {
  const mg_real parts = h / (c->settings->look * c->system->time);
  const int n = parts < MG_MOST_JERKS ? (int)parts + 1 : MG_MOST_JERKS;
  mg_swing at = mg_swing_at(c, body, c->run->t - mg_negligible_time(c) / 4);
  for (int k = 1; k <= n; k++) {
    const mg_swing next = mg_swing_at(c, body, c->run->t + k * h / n);
    mg_swing from = at, to = next;
    if (mg_pin_down(c, body, &from, &to)) {
      *before = from.t, *after = to.t;
      return 1;
    }
    at = next;
  }
  return 0;
}

/* The first within a step h from now, of all driven bodies. */
MG_INTERNAL int mg_find_velocity_jump(const mg_context *c, mg_real h, mg_real *before, mg_real *after) {
  int found = 0;
  for (int b = 0; b < c->system->n_body && c->n_driven; b++)
    if (mg_is_driven(c->system, b) && mg_find_jerk_of(c, b, found ? *before - c->run->t : h, before, after)) found = 1;
  return found;
}

/* Over a jump that is at hand, to the time after it. */
MG_INTERNAL int mg_pass_velocity_jump(mg_context *c, mg_real after, mg_events *events) {
  mg_advance_time(c->run, after - c->run->t);
  mg_update_rows_and_forces(c);
  mg_clear_triggered(c);
  if (c->system->n_grip) mg_clear_slip(c);
  mg_open_distant(c, events);
  const int outcome = mg_change_mode(c, events);
  mg_update_diagnostics(c);
  return outcome;
}
