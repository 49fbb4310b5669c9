/* Memory of event margins: one of each contact, friction constraint and switching function of a load at each sample of
   a step, and at the last right-hand side. */
#include "forces/forces.h"
#include "model/model.h"

MG_INTERNAL int mg_event_margin_count(const mg_system *s) { return s->n_contact + s->n_friction + s->n_switch; }

MG_INTERNAL int mg_next_event_margin(const mg_context *c, int which) {
  const int n = c->system->n_contact, contact = which < n ? mg_next_row(c, which) : n;
  if (which >= n + c->system->n_friction) return which + 1;
  return contact < n ? contact : n + mg_next_constraint(c, which < n ? -1 : which - n);
}

MG_INTERNAL mg_event_margin *mg_event_margins_of_sample(const mg_context *c, int sample) {
  return c->events.margins + (long)sample * mg_event_margin_count(c->system);
}

MG_INTERNAL mg_event_margin *mg_slot_event_margins(const mg_context *c, int slot) {
  return mg_event_margins_of_sample(c, MG_MARGIN_SAMPLES) + mg_first_support(c, slot);
}
