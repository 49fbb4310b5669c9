/* What the impulses of an impact of any kind change: velocities and work of the run's state, the energy statistics,
   and the friction modes. */
#include "impact/impact.h"
#include "model/model.h"
#include "forces/forces.h"

/* Notes of the contacts that do not approach before impulses that any blow of theirs comes after these. */
static void mg_note_later_blows(const mg_context *c) {
  const mg_real rest = c->settings->rest_speed * c->system->length / c->system->time;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (c->rows.d_dot[i] >= -rest) c->run->after_t[i] = c->run->t;
}

MG_INTERNAL void mg_apply_impulses(mg_context *c, int n) {
  MG_NEEDS_AT_RUN(c, MG_VALID_RATES);
  const mg_system *s = c->system;
  for (int i = 0; i < 6 * s->n_body; i++) c->bodies.wrench[i] = 0;
  for (int r = 0; r < n; r++) mg_add_row_response(c, c->lcp.rows[r], c->lcp.z[r], c->bodies.wrench);
  for (int r = 0; r < n; r++) {
    const int i = c->lcp.rows[r];
    const mg_real before = c->rows.d_dot[i], after = before + mg_row_times(c, i, c->bodies.wrench),
                  mean = c->contacts.is_inertial[i] ? 0 : (before + after) / 2; /* armature keeps its work as energy */
    c->run->x[c->layout.work_state] += c->lcp.z[r] * (mean - mg_prescribed_gap_rate(c, i));
  }
  mg_note_later_blows(c);
  for (int b = 0; b < s->n_body; b++)
    for (int k = 0; k < c->kernels->body_kinds[mg_body_kind_of(c, b)].n_u; k++)
      c->run->x[s->n_q + s->body_u[b] + k] += c->bodies.wrench[6 * b + k];
  for (int i = 0; i < 6 * s->n_body; i++) c->bodies.wrench[i] = 0;
}

MG_INTERNAL void mg_note_impact_energy_gain(mg_context *c, int n) {
  MG_NEEDS_AT_RUN(c, MG_VALID_RATES), MG_NEEDS_DIGEST(c, MG_VALID_IMPULSES, mg_impulse_digest(c, n));
  for (int i = 0; i < 6 * c->system->n_body; i++) c->bodies.wrench[i] = 0;
  const int size = mg_append_bilateral_rows(c, c->lcp.rows, n);
  for (int r = 0; r < size; r++) mg_add_row_response(c, c->lcp.rows[r], c->lcp.z[r], c->bodies.wrench);
  mg_real total = 0, largest = 0;
  int contact = -1;
  for (int k = 0, r = 0; r < n; k++) {
    mg_real gain = 0;
    for (const int end = r + c->friction.cone_rows[k]; r < end; r++)
      gain += c->lcp.z[r] * (c->rows.d_dot[c->lcp.rows[r]] + mg_row_times(c, c->lcp.rows[r], c->bodies.wrench) / 2);
    total += gain;
    if (gain > largest) largest = gain, contact = c->friction.cone_contact[k];
  }
  if (contact >= 0) mg_report_impact_gain(c->run, mg_told_contact(c->system, c->run, contact), c->run->t, total);
}

MG_INTERNAL void mg_reset_friction_modes(mg_context *c) {
  for (int g = mg_next_constraint(c, -1); g < c->system->n_friction; g = mg_next_constraint(c, g))
    mg_set_friction_mode(c, g, MG_FRICTION_OFF), c->friction.triggered[g] = 0;
  mg_reset_patch_friction(c);
  mg_update_slip_velocities(c);
}
