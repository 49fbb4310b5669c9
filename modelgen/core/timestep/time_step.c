/* Time-stepping on velocities and impulses with a fixed step: no event is located; every contact that
   closes within the step takes part in one complementarity problem (Stewart and Trinkle, Int. J. Numer. Methods
   Eng. 39 (1996), 2673-2691; Anitescu and Potra, Nonlinear Dynamics 14 (1997), 231-247; Moreau, in Nonsmooth
   Mechanics and Applications, 1988, 1-82). Writes the state, contacts and events of the run, and samples. */
#include "timestep/timestep.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/integrate.h"
#include "features/features.h"
#include "events/events.h"

/* Keeps the forces of the step, near which those of the next one are sought, in the run. */
static void mg_keep_step_forces(mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->layout.friction_row_end; i = mg_next_row(c, i))
    c->run->reference_force[i] = c->solution.force[i];
}

/* Divides the impulses of the step by its length. */
static void mg_impulses_to_forces(mg_context *c, mg_real h) {
  for (int i = mg_next_row(c, -1); i < c->layout.friction_row_end; i = mg_next_row(c, i)) c->solution.force[i] /= h;
  MG_FORGET(c, MG_VALID_STEP_IMPULSES);
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    c->run->force[i] = c->solution.force[i];
}

/* Appends the samples within the step, on the straight line from c->step.end to run->x. */
static void mg_record_step_samples(mg_context *c, mg_record *record, mg_real h) {
  const mg_real t = c->run->t - h;
  while (mg_is_sample_due(record, c->run->t)) {
    const mg_real theta = (record->t[record->count] - t) / h;
    for (int range = 0; range < c->listed.n_range; range++)
      for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++)
        c->step.stage[i] = c->step.end[i] + theta * (c->run->x[i] - c->step.end[i]);
    mg_normalise_quaternions(c, c->step.stage);
    mg_update_rows_at(c, t + theta * h, c->step.stage);
    mg_record_sample(c, record, c->step.stage);
  }
}

enum { MG_UPDATES = 32 }; /* most corrections of penetration in a step */

/* Feature pairs, contact points and penetration at the end of the step: penetration is corrected until the correction
   leads no contact off its feature pair and to no new one. Leaves the rows at run->x. */
static void mg_update_contacts_after_step(mg_context *c, mg_events *events, mg_real h) {
  int changed, update = 0;
  mg_converge_all_contacts(c, events);
  mg_change_marked_features(c, events);
  do {
    changed = mg_post_stabilise(c, events) ? mg_change_marked_features(c, events) : 0;
    changed += mg_search_all_pairs(c, events, h, update > 0);
  } while (changed && ++update < MG_UPDATES);
  mg_update_rows_at(c, c->run->t, c->run->x);
}

/* Notes the fastest spin of a body. Needs the twists. */
static void mg_note_spins(mg_context *c) {
  MG_NEEDS_ANY(c, MG_VALID_TWISTS);
  for (int b = 0; b < c->system->n_body; b++) {
    const mg_real *w = c->bodies.twist + 6 * b + 3, square = mg_dot3(w, w);
    if (mg_is_free_body(c, b)) mg_report_spin(c->run, b, square);
  }
}

MG_INTERNAL int mg_time_step(mg_context *c, mg_real h, mg_record *record, mg_events *events) {
  mg_run *run = c->run;
  mg_free_accelerations(c, run->t, run->x, c->step.slopes); /* by which pairs come near */
  if (mg_choose_near_pairs(c, h, 0, 1)) mg_update_rows_at(c, run->t, run->x);
  if (mg_are_too_many_near(run)) return MG_TOO_MANY_NEAR;
  const mg_real search_limit = mg_search_step_limit(c);
  if (h > search_limit) h = search_limit;
  c->search.n_abandoned = 0;
  mg_set_step_geometry(c, h);
  mg_note_spins(c);
  const int is_power_finite =
      mg_all_finite(1, c->step.slopes + c->layout.n_states + c->layout.work_state); /* by the loads */
  if (!is_power_finite || mg_has_nonfinite_driven_path(c)) return MG_NOT_FINITE;
  const int outcome = mg_step_impulses(c, h);
  if (outcome) return outcome;
  if (c->friction.is_loose) mg_report_loose_solution(run);
  if (c->friction.is_relaxed) mg_report_relaxed_solution(run);
  mg_report_step_modes(c, events, h);
  mg_copy_states(c, run->x, c->step.end);
  mg_apply_step_impulses(c, h);
  mg_integrate_positions(c, h);
  if (!mg_are_states_finite(c, run->x)) return MG_NOT_FINITE;
  mg_impulses_to_forces(c, h);
  mg_note_pressing_contacts(c);
  mg_advance_time(run, h);
  run->steps++;
  if (run->fallback_left > 0) mg_report_fallback_time(run, h);
  mg_update_contacts_after_step(c, events, h);
  if (mg_is_sample_due(record, run->t)) {
    mg_record_step_samples(c, record, h);
    mg_update_rows_at(c, run->t, run->x);
  }
  mg_update_diagnostics(c);
  mg_hand_on_forces(c);
  mg_keep_step_forces(c);
  const int too_deep = mg_check_penetration(c, 2 * h);
  return too_deep ? too_deep : mg_check_contact_rows(c);
}

MG_INTERNAL void mg_record_next_forces(mg_context *c, const mg_record *record) {
  if (!mg_is_time_stepping(c) || !mg_is_sample_due(record, c->run->t)) return;
  const mg_real h = mg_next_step(c);
  mg_set_step_geometry(c, h);
  if (!mg_step_impulses(c, h)) mg_impulses_to_forces(c, h);
  else
    for (int i = mg_next_row(c, -1); i < c->layout.friction_row_end; i = mg_next_row(c, i))
      c->solution.force[i] = i < c->system->n_contact ? c->run->force[i] : 0;
  for (int i = 0; i < 6 * c->system->n_body; i++) c->bodies.wrench[i] = 0;
  mg_update_rows_at(c, c->run->t, c->run->x);
}
