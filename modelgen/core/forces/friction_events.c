/* Friction events: a sticking friction constraint reaches its bound, slip of a slipping one ends or reverses. Their
   event functions, the margins before them, marks, and the reports of what they have changed. Reads forces and slip
   velocities; writes the event marks of friction and the event list. */
#include "forces/forces.h"
#include "model/model.h"

MG_INTERNAL void mg_report_friction_events(mg_context *c, mg_events *events) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++) {
      const int before = c->friction.mode_before[g], now = c->run->friction_mode[g];
      const int first = MG_EVENT_SLIP_START + MG_EVENTS_PER_FRICTION * c->system->friction_kind[g];
      if (before == MG_STICKING && now >= MG_SLIP_ONSET) mg_append_event(c, events, c->run->t, first, i, 0);
      if (before >= MG_SLIP_ONSET && now == MG_STICKING)
        mg_append_event(c, events, c->run->t + c->friction.slip_time_left[g], first + 1, i, 0);
      if (before >= MG_SLIP_ONSET && now >= MG_SLIP_ONSET && now != MG_SLIPPING && c->friction.triggered[g])
        mg_append_event(c, events, c->run->t + c->friction.slip_time_left[g], first + 2, i, 0);
      c->friction.slip_time_left[g] = 0;
    }
}

/* Margin N - |f / mu| of a sticking friction constraint. */
static mg_real mg_friction_force_margin(const mg_context *c, int contact, int constraint) {
  const int row = mg_first_friction_row(c, contact, constraint);
  const mg_real *mu = c->system->friction_static + 2 * constraint;
  const mg_real a = c->solution.force[row] / mu[0],
                b = mg_friction_row_count(c, constraint) == 2 ? c->solution.force[row + 1] / mu[1] : 0;
  return c->solution.force[contact] - sqrt(a * a + b * b);
}

MG_INTERNAL mg_real mg_friction_event_value(const mg_context *c, int contact, int constraint) {
  mg_real slip[2];
  return c->run->friction_mode[constraint] == MG_STICKING ? mg_friction_force_margin(c, contact, constraint)
                                                          : mg_slip_along_direction(c, contact, constraint, slip);
}

MG_INTERNAL mg_real mg_friction_event_margin(const mg_context *c, int contact, int constraint) {
  const int mode = c->run->friction_mode[constraint];
  if (!c->run->active[contact] || mode == MG_FRICTION_OFF) return MG_MAX;
  if (mode == MG_STICKING) return mg_friction_force_margin(c, contact, constraint) + mg_force_tolerance(c);
  const mg_real rest = mg_slip_velocity_tolerance(c, constraint);
  return mg_friction_event_value(c, contact, constraint) - (mode == MG_SLIPPING ? rest : -2 * rest);
}

/* True if the event of a friction constraint has triggered. */
static int mg_has_friction_event(const mg_context *c, int contact, int constraint) {
  return mg_friction_event_margin(c, contact, constraint) < 0;
}

MG_INTERNAL int mg_mark_friction_events(mg_context *c) {
  MG_NEEDS_ANY(c, MG_VALID_FORCES), MG_NEEDS_WITH(c, MG_VALID_SLIP, MG_VALID_TWISTS);
  int count = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++)
      count += c->friction.triggered[g] = mg_has_friction_event(c, i, g);
  return count;
}

MG_INTERNAL int mg_has_any_friction_event(const mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++)
      if (mg_has_friction_event(c, i, g)) return 1;
  return 0;
}

MG_INTERNAL int mg_first_friction_event(const mg_context *c) {
  for (int g = mg_next_constraint(c, -1); g < c->system->n_friction; g = mg_next_constraint(c, g))
    if (c->friction.triggered[g]) return g;
  return -1;
}
