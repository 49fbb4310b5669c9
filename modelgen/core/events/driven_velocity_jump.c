/* Velocity jumps of driven bodies, as at the kink of max(0, t - 1): contacts with the body are struck or
   released. A jump is a change of velocity that the acceleration does not explain, found by bisection. Writes
   time, velocities (by impacts), modes and events of the run. */
#include "events/events.h"
#include "model/model.h"
#include "forces/forces.h"
#include "impact/impact.h"

enum { MG_JUMP_PARTS_MAX = 4096 }; /* most parts of a step in which a jump is sought */

typedef struct {
  mg_real t, twist[6], accel[6];
} mg_driven_state; /* a driven body at a time */

/* Velocity and acceleration of a driven body at a time. */
static mg_driven_state mg_driven_state_at(const mg_context *c, int body, mg_real t) {
  const mg_system *s = c->system;
  mg_driven_state swing = {t, {0}, {0}};
  mg_real pose[12];
  c->kernels->body_path(s->body_kind[body], &t, s->parameters + s->body_parameters[body], c->run->input, pose,
                        swing.twist, swing.accel);
  return swing;
}

/* Change of velocity in m/s between two times that the accelerations do not explain; 0 where they explain most of
   it. */
static mg_real mg_velocity_jump(const mg_context *c, const mg_driven_state *from, const mg_driven_state *to) {
  mg_real unexplained = 0, total = 0;
  for (int k = 0; k < 6; k++) {
    const mg_real arm = k < 3 ? 1 : c->system->length, change = to->twist[k] - from->twist[k];
    total = mg_max(total, arm * fabs(change));
    unexplained = mg_max(unexplained, arm * fabs(change - (to->t - from->t) / 2 * (from->accel[k] + to->accel[k])));
  }
  return unexplained > total / 2 ? unexplained : 0;
}

MG_INTERNAL mg_real mg_velocity_jump_duration(const mg_context *c) {
  const mg_real close = c->settings->event_tolerance * c->system->time, seen = 8 * MG_EPS * fabs(c->run->t);
  return close > seen ? close : seen;
}

/* Bisect the interval of a velocity jump until it is one instant; returns 0 where the velocity is smooth. */
static int mg_bisect_velocity_jump(const mg_context *c, int body, mg_driven_state *from, mg_driven_state *to) {
  const mg_real rest = c->settings->rest_speed * c->system->length / c->system->time;
  mg_real jump = mg_velocity_jump(c, from, to);
  while (jump > rest && to->t - from->t > c->settings->event_tolerance * c->system->time) {
    const mg_driven_state middle = mg_driven_state_at(c, body, from->t + (to->t - from->t) / 2);
    if (!(middle.t > from->t)) break;
    const mg_real first = mg_velocity_jump(c, from, &middle), second = mg_velocity_jump(c, &middle, to);
    *(second > first ? from : to) = middle;
    jump = mg_max(first, second);
  }
  *to = mg_driven_state_at(c, body, to->t + mg_velocity_jump_duration(c));
  return jump > rest;
}

/* Find the first velocity jump of one driven body within a step h, and the times before and after it. */
static int mg_find_body_velocity_jump(const mg_context *c, int body, mg_real h, mg_real *before, mg_real *after) {
  const mg_real part_count = h / (c->settings->time_resolution * c->system->time);
  const int n = part_count < MG_JUMP_PARTS_MAX ? (int)part_count + 1 : MG_JUMP_PARTS_MAX;
  mg_driven_state at = mg_driven_state_at(c, body, c->run->t - mg_velocity_jump_duration(c) / 4);
  for (int k = 1; k <= n; k++) {
    const mg_driven_state next = mg_driven_state_at(c, body, c->run->t + k * h / n);
    mg_driven_state from = at, to = next;
    if (mg_bisect_velocity_jump(c, body, &from, &to)) {
      *before = from.t, *after = to.t;
      return 1;
    }
    at = next;
  }
  return 0;
}

MG_INTERNAL int mg_find_velocity_jump(const mg_context *c, mg_real h, mg_real *before, mg_real *after) {
  int found = 0;
  for (int b = 0; b < c->system->n_body && c->layout.n_driven; b++)
    if (mg_is_driven_body(c->system, b) &&
        mg_find_body_velocity_jump(c, b, found ? *before - c->run->t : h, before, after))
      found = 1;
  return found;
}

MG_INTERNAL int mg_cross_velocity_jump(mg_context *c, mg_real after, mg_events *events) {
  mg_advance_time(c->run, after - c->run->t);
  return mg_settle_velocity_jump(c, events);
}

MG_INTERNAL int mg_settle_velocity_jump(mg_context *c, mg_events *events) {
  mg_evaluate_run_state(c);
  mg_clear_triggered_events(c);
  if (c->system->n_friction) mg_reset_friction_modes(c);
  mg_open_separated_contacts(c, events);
  const int outcome = mg_change_mode(c, events);
  mg_update_diagnostics(c);
  return outcome;
}
