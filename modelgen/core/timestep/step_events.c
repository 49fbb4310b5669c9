/* Modes and events of a step of time-stepping: which contacts close, rebound and open, which friction constraints
   stick and slip. Events have the time of the end of the step; contacts open at its start, when their last impulse was
   over. Writes modes and events of the run. */
#include "timestep/timestep.h"
#include "model/model.h"
#include "forces/forces.h"

/* True if the impulse of the contact is compressive. */
static int mg_has_compressive_force(const mg_context *c, int contact) { return c->solution.force[contact] > 0; }

/* Gap rate of a contact at the end of the step. */
static mg_real mg_final_gap_rate(const mg_context *c, int contact, mg_real h) {
  return mg_free_end_rate(c, contact, h) + mg_row_times(c, contact, c->bodies.wrench);
}

/* Opens the closed contacts that carry no impulse in the step and separate: their gap rate, with the turning of the row
   up to the end of the step, is positive. */
static void mg_report_lift_offs(mg_context *c, mg_events *events, mg_real h) {
  const mg_real least = h * c->settings->rest_acceleration * c->system->length / (c->system->time * c->system->time);
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) {
    if (!c->run->closed[i] || !mg_is_on_feature_pair(c, i) || mg_has_compressive_force(c, i)) continue;
    const mg_real turning = mg_scheme_theta(c) * h * c->rows.gamma[i];
    if (mg_final_gap_rate(c, i, h) + turning > least)
      mg_apply_contact_transition(c, events, i, MG_LIFTS_OFF, c->run->t, 0);
  }
}

/* Applies the transition of a contact that is struck or closes in the step. */
static void mg_report_contact_mode(mg_context *c, mg_events *events, int contact, mg_real h) {
  const mg_real before = c->rows.d_dot[contact], after = mg_final_gap_rate(c, contact, h);
  const mg_real slow = mg_resting_gap_rate_bound(c, contact, h), t = c->run->t + h;
  const int closed = c->run->closed[contact];
  if (mg_has_compressive_force(c, contact) && before < -slow && after > slow)
    mg_apply_contact_transition(c, events, contact, MG_IMPACT_REBOUND, t, -before);
  else if (mg_has_compressive_force(c, contact) && !closed) {
    mg_apply_contact_transition(c, events, contact, MG_IMPACT_INELASTIC, t, 0);
    mg_apply_contact_transition(c, events, contact, MG_TOUCHES_DOWN, t, before < 0 ? -before : 0);
  }
}

/* Sets the modes of the friction constraints. Needs the marks of the friction problem solved last. */
static void mg_report_friction_modes(mg_context *c, mg_events *events) {
  MG_NEEDS_WITH(c, MG_VALID_YIELDING, MG_VALID_STEP_IMPULSES);
  for (int g = mg_next_constraint(c, -1); g < c->system->n_friction; g = mg_next_constraint(c, g))
    c->friction.mode_before[g] = c->run->friction_mode[g], c->friction.slip_time_left[g] = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++)
      mg_set_friction_mode(c, g,
                           !mg_has_compressive_force(c, i) ? MG_FRICTION_OFF
                           : c->friction.is_yielding[g]    ? MG_SLIPPING
                                                           : MG_STICKING);
  mg_report_friction_events(c, events);
}

MG_INTERNAL void mg_report_step_modes(mg_context *c, mg_events *events, mg_real h) {
  MG_NEEDS_DIGEST(c, MG_VALID_STEP_IMPULSES, mg_step_digest(c, c->run->t, c->run->x, h));
  mg_report_lift_offs(c, events, h);
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (mg_is_on_feature_pair(c, i)) mg_report_contact_mode(c, events, i, h);
  if (c->system->n_friction) mg_report_friction_modes(c, events);
}
