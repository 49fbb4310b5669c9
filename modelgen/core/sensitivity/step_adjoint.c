/* Adjoint of the derivatives over one accepted step (step_tangent.c), its parts in reverse order. The states of the
   stages are found again from the slopes. */
#include "sensitivity/sensitivity.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

MG_INTERNAL void mg_settle_eta_adjoint(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x, mg_real *x_bar) {
  const mg_system *system = c->system;
  if (!c->settings->newton) return;
  mg_clear_cotangents(c, s);
  for (int i = mg_next_row(c, -1); i < system->n_contact; i = mg_next_row(c, i)) {
    const int eta = system->n_q + system->n_u + system->contact_eta[i], n = c->contacts.n_eta[i];
    if (!mg_is_on_feature_pair(c, i) || !n) continue;
    s->y_dot[0] = 0;
    for (int k = 0; k < n; k++) s->y_dot[1 + k] = x_bar[eta + k], x_bar[eta + k] = 0;
    mg_placement_adjoint(c, s, i, x + eta);
  }
  mg_place_bodies_adjoint(c, s, t, x, x_bar);
}

/* Cotangents of the corrections of positions and orientations, or of velocities, into s->at.acceleration. */
static void mg_take_correction_cotangents(const mg_context *c, mg_sensitivity *s, int of_velocities, const mg_real *x,
                                          const mg_real *x_bar) {
  const mg_system *system = c->system;
  for (int b = 0; b < system->n_body; b++) {
    if (!mg_is_moved_by_forces(c, b)) continue;
    const int q = system->body_q[b], u = system->n_q + system->body_u[b];
    mg_real *bar = s->at.acceleration + 6 * b;
    mg_zero_reals(bar, 6);
    if (of_velocities) {
      for (int k = 0; k < c->kernels->body_kinds[mg_body_kind_of(c, b)].n_u; k++) bar[k] = x_bar[u + k];
      continue;
    }
    for (int k = 0; k < 3; k++) bar[k] = x_bar[q + k];
    for (int axis = 0; axis < 3 && c->bodies.motion[b] == MG_FREE; axis++) {
      const mg_real angle[3] = {axis == 0, axis == 1, axis == 2}, *e = x + q + 3;
      mg_real turned[4] = {e[0], e[1], e[2], e[3]};
      mg_rotate_quaternion(turned, angle);
      for (int k = 0; k < 4; k++) bar[3 + axis] += (turned[k] - e[k]) * x_bar[q + 3 + k];
    }
  }
}

/* Cotangents of the values of the held rows, of which those of friction count where it `sticks`, from those of the
   corrections, into `bar`. */
static void mg_row_correction_adjoint(mg_context *c, mg_sensitivity *s, const int *marked, int sticks, mg_real *bar) {
  mg_real *rate = c->rows.row_rate;
  for (int i = 0; i < c->layout.friction_row_end; i++) rate[i] = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (marked[i]) mg_update_inverse_mass_row(c, i), rate[i] = mg_response_times(c, i, s->at.acceleration);
  for (int i = c->layout.joint_row_begin; i < c->layout.joint_row_end; i++)
    mg_update_inverse_mass_row(c, i), rate[i] = mg_response_times(c, i, s->at.acceleration);
  int n = sticks && c->system->n_friction ? mg_append_sticking_rows(c, c->lcp.rows, 0) : 0;
  for (int r = 0; r < n; r++)
    mg_update_inverse_mass_row(c, c->lcp.rows[r]),
        rate[c->lcp.rows[r]] = mg_response_times(c, c->lcp.rows[r], s->at.acceleration);
  n = mg_hold_rows(c, marked, sticks, rate, c->solution.impulse);
  for (int r = 0; r < n; r++) bar[c->lcp.rows[r]] = c->solution.impulse[c->lcp.rows[r]];
}

MG_INTERNAL void mg_project_adjoint(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x, mg_real *x_bar) {
  MG_NEEDS(c, MG_VALID_FORCES, t, x);
  if (!c->settings->project) return;
  mg_settle_eta_adjoint(c, s, t, x, x_bar);
  mg_zero_reals(s->stage, c->layout.n_states);
  mg_clear_cotangents(c, s);
  mg_take_correction_cotangents(c, s, 0, x, x_bar);
  mg_row_correction_adjoint(c, s, s->held, 1, s->at.value);
  mg_take_correction_cotangents(c, s, 1, x, x_bar);
  mg_row_correction_adjoint(c, s, s->held, 1, s->at.rate);
  mg_zero_reals(s->at.acceleration, 6L * c->system->n_body);
  for (int i = c->layout.friction_row_begin; i < c->layout.friction_row_end; i++) s->at.value[i] = 0;
  mg_rows_adjoint(c, s, t, x, s->stage, x_bar);
}

MG_INTERNAL void mg_project_gaps_adjoint(mg_context *c, mg_sensitivity *s, const int *marked, mg_real *x_bar) {
  const mg_real t = c->run->t, *x = c->run->x;
  if (!c->settings->project) return;
  mg_settle_eta_adjoint(c, s, t, x, x_bar);
  mg_zero_reals(s->stage, c->layout.n_states);
  mg_clear_cotangents(c, s);
  mg_take_correction_cotangents(c, s, 0, x, x_bar);
  mg_row_correction_adjoint(c, s, marked, 0, s->at.value);
  mg_zero_reals(s->at.acceleration, 6L * c->system->n_body);
  mg_rows_adjoint(c, s, t, x, s->stage, x_bar);
}

MG_INTERNAL void mg_step_adjoint(mg_context *c, mg_sensitivity *s, mg_real h, mg_real *x_bar) {
  const mg_explicit_method *method = mg_explicit_method_of(c->settings);
  const int states = c->layout.n_states;
  const mg_real t = c->run->t, *x = c->run->x;
  const int is_composed = mg_is_in_mode_of_scene_rhs(c);
  mg_real *k_bar = s->slopes, *at_stage = s->stage;
  MG_NEEDS(c, MG_VALID_POSES, t + h, c->step.end);
  mg_settle_eta_adjoint(c, s, t + h, c->step.end, x_bar);
  mg_combine_stages(method, method->stages, states, states, h, x, c->step.slopes, c->step.stage);
  mg_normalise_tangent(c, c->step.stage, x_bar); /* a symmetric projection */
  mg_zero_reals(k_bar, (long)method->stages * states);
  for (int k = method->row[method->stages]; k < method->row[method->stages + 1]; k++)
    mg_add_scaled(states, h * method->value[k], x_bar, k_bar + (long)method->column[k] * states);
  for (int stage = method->stages - 1; stage >= 0; stage--) {
    const mg_real time = t + method->time[stage] * h;
    mg_combine_stages(method, stage, states, states, h, x, c->step.slopes, c->step.stage);
    if (c->settings->newton > 1) mg_place_all_contacts(c, time, c->step.stage);
    mg_zero_reals(at_stage, states);
    if (is_composed) mg_scene_adjoint(c, s, c->step.stage, k_bar + (long)stage * states, at_stage);
    else {
      mg_right_hand_side(c, time, c->step.stage, c->step.interpolant);
      mg_gather_wrenches(c, s, time);
      mg_clear_cotangents(c, s);
      mg_rhs_adjoint(c, s, time, c->step.stage, k_bar + (long)stage * states, at_stage);
    }
    mg_add_scaled(states, 1, at_stage, x_bar);
    for (int k = method->row[stage]; k < method->row[stage + 1]; k++)
      mg_add_scaled(states, h * method->value[k], at_stage, k_bar + (long)method->column[k] * states);
  }
}
