/* The watch on event functions at the stages of a step: whether the step is to be searched for events. Writes
   c->step.sign_changed and beyond_margin. */
#include "integrate/integrate.h"
#include "model/model.h"
#include "forces/forces.h"

MG_INTERNAL void mg_watch_event_signs(mg_context *c) {
  if (!c->step.beyond_margin) c->step.beyond_margin = mg_has_moved_beyond_margins(c);
  if (c->step.sign_changed) return;
  const mg_real deep = -c->settings->contact_gap * c->system->length;
  if (mg_has_patch_event(c)) c->step.sign_changed = 1;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (c->run->closed[i] ? c->run->active[i] && c->solution.force[i] < 0 : c->rows.d[i] < deep)
      c->step.sign_changed = 1;
  if (mg_has_switch_event(c)) c->step.sign_changed = 1;
  if (c->system->n_friction && mg_has_any_friction_event(c)) c->step.sign_changed = 1;
}
