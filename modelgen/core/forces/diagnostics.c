/* Diagnostics of a run: energy against work, gaps of closed contacts, complementarity, joint errors and margins.
   The run reports them. */
#include "forces/forces.h"
#include "model/model.h"
#include "closest/closest.h"

MG_INTERNAL mg_real mg_energy(mg_context *c, mg_real *kinetic) {
  const mg_system *s = c->system;
  mg_real total = 0;
  *kinetic = 0;
  for (int b = 0; b < s->n_body; b++) {
    mg_real moving, height, momentum[3], spin[3];
    if (!mg_is_moved_by_forces(c, b)) continue;
    c->kernels->body_energy(mg_body_kind_of(c, b), c->run->x + s->body_q[b], c->run->x + s->n_q + s->body_u[b],
                            s->gravity, s->parameters + s->body_parameters[b], &moving, &height, momentum, spin);
    total += moving + height;
    *kinetic += moving;
  }
  const mg_real of_armature = mg_armature_energy(c, c->run->t, c->run->x);
  *kinetic += of_armature;
  return total + of_armature;
}

MG_INTERNAL void mg_update_diagnostics(mg_context *c) {
  MG_NEEDS_AT_RUN(c, MG_VALID_ROWS);
  const mg_system *s = c->system;
  mg_run *run = c->run;
  const mg_real weight = s->mass * s->length / (s->time * s->time);
  mg_real kinetic;
  const mg_real energy = mg_energy(c, &kinetic);
  mg_report_energy(run, energy, kinetic, run->x[c->layout.work_state]);
  if (s->n_joint_row) mg_monitor_joint_rank(c);
  mg_monitor_redundant_friction(c, 0);
  if (!mg_is_time_stepping(c) && !mg_are_patch_pressures_found(c)) mg_report_exceeded(c->run, MG_CAPACITY_PRESSURE);
  for (int i = mg_next_row(c, -1); i < s->n_contact; i = mg_next_row(c, i)) {
    const mg_real gap = c->rows.d[i] / s->length, force = c->solution.force[i] / weight;
    if (!mg_is_support_contact(c, i)) mg_report_complementarity(run, gap, force);
    if (mg_is_on_feature_pair(c, i) && !mg_is_support_contact(c, i))
      mg_note_penetration(c, i, c->run->feature_pair[i], -c->rows.d[i], MG_PENETRATED);
    if (!run->closed[i]) continue;
    mg_report_gap(run, c->rows.d[i]);
    if (!run->rolling_start[i] && !(run->margin[i] >= run->report.margin_min) &&
        !mg_is_curved_edge_crossing(c, run->feature_pair[i]))
      mg_report_margin(run, run->margin[i]);
  }
}

MG_INTERNAL int mg_check_penetration(mg_context *c, mg_real unresolved) {
  const mg_real depth = c->search.penetration, limit = c->settings->penetration_limit * c->system->length;
  c->search.penetration = 0;
  if (!(depth > limit)) return MG_DONE;
  const int contact = c->search.penetration_contact;
  if (!(depth > limit + unresolved * mg_pair_speed_bound(c, c->system->contact_pair[contact]))) return MG_DONE;
  mg_report_failed_contact(c->run, contact);
  if (c->search.penetration_outcome == MG_MARGIN) mg_report_margin(c->run, 0);
  return c->search.penetration_outcome;
}

/* True if the gap of a contact is a number, and its rates; Gamma2 only where the gap is held. */
static int mg_has_finite_rows(const mg_context *c, int contact) {
  const int is_held = c->run->closed[contact] && !mg_is_time_stepping(c);
  return mg_all_finite(1, c->rows.d + contact) && mg_all_finite(12, c->rows.J + 12 * contact) &&
         (!is_held || mg_all_finite(1, c->rows.gamma + contact));
}

MG_INTERNAL int mg_check_contact_rows(mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) {
    if (!mg_is_on_feature_pair(c, i) || c->run->rolling_start[i] || mg_has_finite_rows(c, i)) continue;
    mg_report_failed_contact(c->run, i);
    return MG_NOT_FINITE;
  }
  return MG_DONE;
}

MG_INTERNAL int mg_check_margins(mg_context *c, mg_events *events) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (mg_is_contact_singular(c, i)) {
      mg_report_failed_contact(c->run, i);
      mg_apply_contact_transition(c, events, i, MG_NEARS_SINGULARITY, c->run->t, 0);
      return MG_MARGIN;
    }
  return MG_DONE;
}
