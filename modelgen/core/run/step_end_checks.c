/* What a step must satisfy at its end beside its error: no contact point has leapt, contacts are regular, no event was
   missed. A step that does not is rejected. Writes c->step.settled. */
#include "run/run.h"
#include "base/base.h"
#include "model/model.h"
#include "closest/closest.h"
#include "forces/forces.h"
#include "integrate/integrate.h"

MG_INTERNAL int mg_place_step_end(mg_context *c, mg_real h) {
  const mg_run *run = c->run;
  mg_copy_states(c, c->step.end, c->step.settled);
  mg_normalise_quaternions(c, c->step.settled);
  int is_valid = mg_place_all_contacts(c, run->t + h, c->step.settled);
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (mg_is_contact_singular(c, i)) is_valid = 0;
  return is_valid || c->settings->method == MG_RK4 || h <= c->settings->event_tolerance * c->system->time;
}

MG_INTERNAL int mg_has_contact_point_leapt(const mg_context *c, mg_real h) {
  MG_NEEDS_WITH(c, MG_VALID_RATES, MG_VALID_TWISTS);
  const mg_real least = c->system->length / c->system->time,
                part = c->settings->separation_speed_factor * c->settings->tolerance;
  if (c->settings->method == MG_RK4 || !c->settings->project || !c->settings->use_gamma) return 0;
  if (mg_has_rolling_start(c) || h <= c->settings->event_tolerance * c->system->time) return 0;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    if (!c->run->closed[i] || !c->run->active[i] || !(fabs(c->rows.d_dot[i]) > part * least)) continue;
    if (fabs(c->rows.d_dot[i]) > part * mg_pair_speed_bound(c, c->system->contact_pair[i])) return 1;
  }
  return 0;
}

MG_INTERNAL int mg_has_missed_event(const mg_context *c, mg_real h) {
  return c->layout.n_timed && c->step.sign_changed && h > c->settings->time_resolution * c->system->time;
}

MG_INTERNAL int mg_reject_step(mg_context *c, mg_real h) {
  c->run->rejected++, c->run->h = h / 2;
  mg_evaluate_run_state(c);
  return MG_DONE;
}
