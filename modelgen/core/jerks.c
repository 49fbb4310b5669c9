/* Driven bodies whose velocity jumps, as at the kink of max(0, t - 1): what they touch is struck, or let go. */
#include "core.h"

enum { MG_MOST_JERKS = 4096 }; /* parts of a step in which one is looked for */

/* By how much the velocity of a driven body changes from t to t + h beyond what its acceleration tells, m/s; 0 where that
   tells most of it. */
static mg_real mg_jump(const mg_context *c, int body, mg_real t, mg_real h) {
  const mg_system *s = c->sys;
  mg_real pose[12], twist[2][6] = {{0}}, accel[2][6] = {{0}}, untold = 0, whole = 0;
  for (int end = 0; end < 2; end++) {
    const mg_real at = t + end * h;
    mg_body_path(s->body_kind[body], &at, s->parameters + s->body_parameters[body], pose, twist[end], accel[end]);
  }
  for (int k = 0; k < 6; k++) {
    const mg_real arm = k < 3 ? 1 : s->length, change = twist[1][k] - twist[0][k];
    whole = fmax(whole, arm * fabs(change));
    untold = fmax(untold, arm * fabs(change - h / 2 * (accel[0][k] + accel[1][k])));
  }
  return untold > whole / 2 ? untold : 0;
}

/* Halves the time from *t to *t + *h in which the velocity seems to jump, until it does so at once, or goes over smoothly (0). */
static int mg_pin_down(const mg_context *c, int body, mg_real *t, mg_real *h) {
  const mg_real rest = c->set->rest_speed * c->sys->length / c->sys->time;
  mg_real jump = mg_jump(c, body, *t, *h);
  while (jump > rest && *h > c->set->event * c->sys->time && *t + *h / 2 > *t) {
    *h /= 2;
    const mg_real first = mg_jump(c, body, *t, *h), second = mg_jump(c, body, *t + *h, *h);
    if (second > first) *t += *h;
    jump = fmax(first, second);
  }
  return jump > rest;
}

/* The first jump of a velocity within a step h from now: the times before and after it. */
static int mg_find_jerk(const mg_context *c, mg_real h, mg_real *before, mg_real *after) {
  if (!c->driven) return 0;
  const mg_real parts = h / (c->set->look * c->sys->time);
  const int n = parts < MG_MOST_JERKS ? (int)parts + 1 : MG_MOST_JERKS;
  for (int k = 0; k < n; k++)
    for (int b = 0; b < c->sys->n_body; b++) {
      mg_real t = c->run->t + k * h / n, part = h / n;
      if (!mg_is_driven(c->sys, b) || !mg_pin_down(c, b, &t, &part)) continue;
      *before = t, *after = t + part;
      return 1;
    }
  return 0;
}

/* Over a jump that is at hand, to the time after it. */
static int mg_take_jerk(mg_context *c, mg_real after, mg_events *events) {
  mg_pass_time(c->run, after - c->run->t);
  mg_refresh(c);
  for (int i = 0; i < c->sys->n_contact; i++) c->fired[i] = 0;
  if (c->sys->n_grip) mg_forget_slip(c);
  mg_open_far(c, events);
  const int outcome = mg_change_mode(c, events);
  mg_ledger(c);
  return outcome;
}
