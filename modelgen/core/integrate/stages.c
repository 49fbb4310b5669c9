/* What all methods of integration share: the watch on event functions at the stages, and states on the interpolant.
   Reads and writes c->step. */
#include "integrate/integrate.h"
#include "model/model.h"
#include "forces/forces.h"

MG_INTERNAL void mg_interpolate(const mg_context *c, const mg_real *x, mg_real theta, mg_real *out) {
  const int n = c->layout.n_states;
  for (int range = 0; range < c->listed.n_range; range++)
    for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++) {
      mg_real y = 0;
      for (int row = 6; row >= 0; row--) y = (y + c->step.interpolant[row * n + i]) * (row % 2 ? 1 - theta : theta);
      out[i] = x[i] + y;
    }
}

MG_INTERNAL void mg_watch_event_signs(mg_context *c) {
  if (!c->step.left_margin) c->step.left_margin = mg_has_left_margins(c);
  if (c->step.sign_changed) return;
  const mg_real deep = -c->settings->contact_gap * c->system->length;
  if (mg_has_patch_event(c)) c->step.sign_changed = 1;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (c->run->closed[i] ? c->run->active[i] && c->solution.force[i] < 0 : c->rows.d[i] < deep)
      c->step.sign_changed = 1;
  if (c->system->n_friction && mg_has_any_friction_event(c)) c->step.sign_changed = 1;
}
