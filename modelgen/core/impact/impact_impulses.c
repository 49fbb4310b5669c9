/* What impacts of every kind share: which contacts approach, the restitution that applies to them, and what impulses
   change. Writes velocities and work of the run's state, the energy statistics, and the friction modes. */
#include "impact/impact.h"
#include "model/model.h"
#include "forces/forces.h"

MG_INTERNAL int mg_is_approaching(const mg_context *c, int contact) {
  return c->rows.d_dot[contact] < -c->settings->rest_speed * c->system->length / c->system->time;
}

MG_INTERNAL mg_real mg_effective_restitution(const mg_context *c, int contact) {
  const mg_real e = c->system->restitution[contact], approach = -c->rows.d_dot[contact];
  const mg_real least = c->settings->rest_speed * c->system->length / c->system->time;
  return e * approach > least && 4 * approach > 5 * least && !mg_has_patch_just_opened(c, contact) ? e : 0;
}

MG_INTERNAL mg_real mg_remaining_bounce_time(mg_context *c, int contact) {
  const mg_real e = c->system->restitution[contact], closing_acceleration = -mg_row_acceleration(c, contact),
                most = c->settings->time_resolution * c->system->time;
  const mg_real twice_speed_after = -2 * e * c->rows.d_dot[contact];
  return e < 1 && twice_speed_after > 0 && closing_acceleration > mg_acceleration_tolerance(c) &&
                 twice_speed_after < most * closing_acceleration * (1 - e)
             ? twice_speed_after / (closing_acceleration * (1 - e))
             : 0;
}

MG_INTERNAL void mg_set_support_impact_rates(mg_context *c) {
  for (int i = c->layout.support_begin; i < c->layout.joint_row_end; i++) c->rows.row_rate[i] = c->rows.d_dot[i];
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    const int support = mg_first_support(c, slot);
    mg_real e = 0;
    for (int k = 0; k < 3 && c->patches.trial[slot] == 1; k++)
      e = mg_effective_restitution(c, support + k) > e ? mg_effective_restitution(c, support + k) : e;
    for (int k = 0; k < 3; k++) c->rows.row_rate[support + k] *= 1 + e;
  }
}

MG_INTERNAL void mg_apply_impulses(mg_context *c, int n) {
  const mg_system *s = c->system;
  for (int i = 0; i < 6 * s->n_body; i++) c->bodies.wrench[i] = 0;
  for (int r = 0; r < n; r++) mg_add_row_response(c, c->lcp.rows[r], c->lcp.z[r], c->bodies.wrench);
  for (int r = 0; r < n; r++) {
    const int i = c->lcp.rows[r];
    const mg_real before = c->rows.d_dot[i], after = before + mg_row_times(c, i, c->bodies.wrench);
    c->run->x[c->layout.work_state] += c->lcp.z[r] * ((before + after) / 2 - mg_prescribed_gap_rate(c, i));
  }
  for (int b = 0; b < s->n_body; b++)
    for (int k = 0; k < c->kernels->body_kinds[mg_body_kind_of(c, b)].n_u; k++)
      c->run->x[s->n_q + s->body_u[b] + k] += c->bodies.wrench[6 * b + k];
  for (int i = 0; i < 6 * s->n_body; i++) c->bodies.wrench[i] = 0;
}

MG_INTERNAL void mg_note_impact_energy_gain(mg_context *c, int n) {
  for (int i = 0; i < 6 * c->system->n_body; i++) c->bodies.wrench[i] = 0;
  const int size = mg_append_bilateral_rows(c, c->lcp.rows, n);
  for (int r = 0; r < size; r++) mg_add_row_response(c, c->lcp.rows[r], c->lcp.z[r], c->bodies.wrench);
  for (int k = 0, r = 0; r < n; k++) {
    mg_real gain = 0;
    for (const int end = r + c->friction.cone_rows[k]; r < end; r++)
      gain += c->lcp.z[r] * (c->rows.d_dot[c->lcp.rows[r]] + mg_row_times(c, c->lcp.rows[r], c->bodies.wrench) / 2);
    if (!(gain > c->run->impact_gain_max)) continue;
    c->run->impact_gain_max = gain, c->run->impact_gain_t = c->run->t,
    c->run->impact_gain_contact = c->friction.cone_contact[k];
  }
}

MG_INTERNAL void mg_reset_friction_modes(mg_context *c) {
  for (int g = mg_next_constraint(c, -1); g < c->system->n_friction; g = mg_next_constraint(c, g))
    c->run->friction_mode[g] = MG_FRICTION_OFF, c->friction.triggered[g] = 0;
  mg_reset_patch_friction(c);
  mg_update_slip_velocities(c);
}
