/* Transition table of a contact: for each cause the state after it (closed, open or unchanged) and the event that
   is reported. Which closed contacts carry force is decided by the complementarity problem of accelerations
   (forces/frictionless_active_set.c). Writes the closed and active sets of the run, the event list, the
   times of blows and the time. */
#include "model/model.h"

enum {
  MG_MODE_UNCHANGED = -1, /* the contact stays closed or open */
  MG_NO_EVENT = -1        /* no event is reported */
};

static const struct {
  int closed; /* 1: closed afterwards, 0: open, or MG_MODE_UNCHANGED */
  int event;  /* event that is reported, or MG_NO_EVENT */
} mg_transitions[] = {
    [MG_IMPACT_INELASTIC] = {1, MG_NO_EVENT},
    [MG_TOUCHES_DOWN] = {1, MG_EVENT_TOUCH_DOWN},
    [MG_IMPACT_REBOUND] = {0, MG_EVENT_IMPACT},
    [MG_IMPACT_AVOIDED] = {0, MG_NO_EVENT},
    [MG_PUSHED_OPEN] = {0, MG_EVENT_LIFT_OFF},
    [MG_LIFTS_OFF] = {0, MG_EVENT_LIFT_OFF},
    [MG_CONTACT_APPEARS] = {0, MG_EVENT_APPEAR},
    [MG_FEATURE_CHANGES] = {MG_MODE_UNCHANGED, MG_EVENT_FEATURE_CHANGE},
    [MG_CONTACT_VANISHES] = {0, MG_EVENT_VANISH},
    [MG_PATCH_BEGINS] = {MG_MODE_UNCHANGED, MG_EVENT_FACE_CONTACT},
    [MG_PATCH_TURNS_OVER_EDGE] = {MG_MODE_UNCHANGED, MG_EVENT_TIPPING},
    [MG_NEARS_SINGULARITY] = {MG_MODE_UNCHANGED, MG_EVENT_MARGIN},
};

MG_INTERNAL int mg_is_bounce_tiny(const mg_context *c, int contact, mg_real approach) {
  const mg_system *s = c->system;
  const mg_real since = c->run->t - c->run->after_t[contact];
  if (c->run->after_t[contact] < 0 || !(since > 0) || approach > sqrt(sqrt(MG_EPS)) * s->length / s->time) return 0;
  mg_real size = s->length;
  for (int side = 0; side < 2; side++) {
    const mg_real *p = c->bodies.pose + 12 * (side ? c->contacts.f : c->contacts.o)[contact];
    size += sqrt(mg_dot3(p, p));
  }
  return approach * since < 64 * MG_EPS * size;
}

MG_INTERNAL void mg_append_event(const mg_context *c, mg_events *events, mg_real t, int kind, int contact,
                                 mg_real speed) {
  if (kind == MG_EVENT_SLIP_STOP || kind == MG_EVENT_SLIP_STOP + MG_EVENTS_PER_FRICTION ||
      kind == MG_EVENT_SLIP_STOP + 2 * MG_EVENTS_PER_FRICTION)
    mg_report_slip_stop(c->run);
  if (events->count >= events->capacity) {
    mg_report_exceeded(c->run, MG_CAPACITY_EVENTS);
    return;
  }
  const int k = events->count++;
  events->t[k] = t, events->kind[k] = kind, events->contact[k] = contact, events->speed[k] = speed;
  events->told_contact[k] = kind == MG_EVENT_LOAD_SWITCH ? contact : mg_told_contact(c->system, c->run, contact);
  events->after_t[k] = speed > 0 ? c->run->after_t[contact] : -1;
  if (speed > 0) {
    c->run->tiny_bounces = mg_is_bounce_tiny(c, contact, speed) ? c->run->tiny_bounces + 1 : 0;
    c->run->after_t[contact] = c->run->t;
    c->run->struck_by[c->contacts.o[contact]] = c->run->struck_by[c->contacts.f[contact]] = contact;
  }
  events->feature_pair[k] = kind == MG_EVENT_LOAD_SWITCH ? -1 : c->run->feature_pair[contact];
}

MG_INTERNAL void mg_apply_contact_transition(mg_context *c, mg_events *events, int contact, int cause, mg_real t,
                                             mg_real speed) {
  MG_REQUIRE(contact >= 0 && contact < c->system->n_contact);
  const int closed = mg_transitions[cause].closed, event = mg_transitions[cause].event;
  if (closed != MG_MODE_UNCHANGED && closed != c->run->closed[contact])
    mg_set_closed(c, contact, closed), mg_set_active(c, contact, 0), mg_set_rolling_start(c, contact, MG_START_NONE);
  if (event != MG_NO_EVENT) mg_append_event(c, events, t, event, contact, speed);
}

MG_INTERNAL void mg_clear_triggered_events(mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) c->events.triggered[i] = 0;
}

MG_INTERNAL void mg_advance_time(mg_run *run, mg_real h) {
  const mg_real t = run->t, step = h + run->t_roundoff;
  run->t = t + step;
  run->t_roundoff = step - (run->t - t);
}
