/* Adjoint of the derivatives over the corrections of mg_begin (start_correction_tangent.c), its parts in reverse order.
 */
#include "sensitivity/sensitivity.h"
#include "model/model.h"
#include "forces/forces.h"

static void mg_start_blow_adjoint(mg_context *c, mg_sensitivity *s, const mg_real *given, int part, mg_real *x_bar) {
  mg_real *settled = s->slope_before;
  mg_copy_states(c, c->run->x, settled);
  if (mg_restore_start(c, s, given, part)) mg_blow_adjoint(c, s, x_bar);
  mg_copy_states(c, settled, c->run->x);
  mg_evaluate_run_state(c);
}

MG_INTERNAL void mg_start_adjoint(mg_context *c, mg_sensitivity *s, const mg_real *given, mg_real *x_bar) {
  mg_mark_held_contacts(c, s, 1);
  mg_project_adjoint(c, s, c->run->t, c->run->x, x_bar);
  mg_evaluate_run_state(c);
  mg_start_blow_adjoint(c, s, given, MG_CONTACTS_STRIKE, x_bar);
  mg_start_blow_adjoint(c, s, given, MG_JOINTS_HOLD, x_bar);
  mg_restore_start(c, s, given, MG_START_SETTLED);
  mg_project_gaps_adjoint(c, s, s->closed_before, x_bar);
  mg_settle_eta_adjoint(c, s, c->run->t, c->run->x, x_bar);
}
