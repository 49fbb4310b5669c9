/* Adjoint of the derivatives over an event (event_tangent.c), in reverse order. */
#include "sensitivity/sensitivity.h"
#include "model/model.h"
#include "forces/forces.h"

/* Adds `weight` times the gradient of a switching function to the cotangents. Needs the poses there. */
static void mg_switch_adjoint(mg_context *c, mg_sensitivity *s, mg_real t, int which, mg_real weight) {
  MG_NEEDS_TIME(c, t);
  const mg_system *system = c->system;
  const int load = mg_load_of_switch(system, which), n = c->kernels->load_kinds[system->load_kind[load]].n_parameters,
            bodies[2] = {system->load_a[load], system->load_b[load]};
  const mg_real *by_input, *g = mg_differentiated_switch(c, s, t, load, which, &by_input);
  for (int side = 0; side < 2; side++) {
    const int body = bodies[side];
    if (body < 0) continue;
    for (int k = 0; k < 12; k++) s->at.pose[12 * body + k] += weight * g[1 + 18 * side + k];
    for (int k = 0; k < 6; k++) s->at.twist[6 * body + k] += weight * g[13 + 18 * side + k];
  }
  for (int k = 0; k < n; k++)
    s->adjoint->parameters[system->load_parameters[load] + k] += weight * g[MG_SWITCH_COLUMNS + k];
  for (int k = 0; k < 3 * system->n_input; k++) s->adjoint->input[k] += weight * by_input[k];
}

/* The same of the event function of a contact or of its friction. */
static void mg_contact_event_adjoint(mg_context *c, mg_sensitivity *s, const mg_crossing *crossing, mg_real weight,
                                     mg_real *x_bar) {
  const int contact = crossing->contact, g = crossing->constraint,
            eta = c->system->n_q + c->system->n_u + c->system->contact_eta[contact],
            slot = mg_slot_of_support(c, contact);
  const int row = g < 0 ? 0 : mg_first_friction_row(c, contact, g), rows = g < 0 ? 0 : mg_friction_row_count(c, g);
  if (crossing->kind == MG_CROSSES_GAP) s->at.value[contact] = weight;
  if (crossing->kind == MG_CROSSES_SLIP && slot >= 0) mg_patch_slip_rate_adjoint(c, s, slot, weight);
  if (crossing->kind == MG_CROSSES_BOUND && slot >= 0) mg_patch_bound_adjoint(c, s, slot, weight);
  if (crossing->kind == MG_CROSSES_SLIP && slot < 0) {
    const mg_real *direction = c->run->slip_direction + 3 * g, *tangents = c->rows.tangents + 6 * contact;
    for (int k = 0; k < rows; k++)
      s->at.rate[row + k] = weight * (rows == 1 ? direction[0] : mg_dot3(tangents + 3 * k, direction));
  }
  if (crossing->kind == MG_CROSSES_FORCE || (crossing->kind == MG_CROSSES_BOUND && slot < 0))
    s->at.force[contact] = weight;
  if (crossing->kind == MG_CROSSES_BOUND && slot < 0) {
    const mg_real *mu = c->system->friction_static + 2 * g;
    mg_real size = 0;
    for (int k = 0; k < rows; k++) size += c->solution.force[row + k] / mu[k] * (c->solution.force[row + k] / mu[k]);
    size = sqrt(size);
    for (int k = 0; k < rows && size > 0; k++) {
      const mg_real part = c->solution.force[row + k] / mu[k];
      s->at.force[row + k] = -weight * part / (mu[k] * size);
      s->adjoint->friction_static[2 * g + k] += weight * part * part / (mu[k] * size);
    }
  }
  if (crossing->kind == MG_CROSSES_BORDER) mg_border_adjoint(c, s, contact, c->step.end + eta, weight, x_bar + eta);
}

MG_INTERNAL void mg_event_function_adjoint(mg_context *c, mg_sensitivity *s, const mg_crossing *crossing, mg_real t,
                                           mg_real weight, mg_real *x_bar) {
  mg_clear_cotangents(c, s);
  mg_zero_reals(s->stage, c->layout.n_states);
  if (crossing->kind == MG_CROSSES_SWITCH) mg_switch_adjoint(c, s, t, crossing->contact, weight);
  else mg_contact_event_adjoint(c, s, crossing, weight, x_bar);
  mg_rhs_adjoint(c, s, t, c->step.end, s->stage, x_bar);
}

/* Scalar product of two vectors of the states, over q and u of the bodies of the crossing that is looked at. */
static mg_real mg_dot_in_crossing(const mg_context *c, const mg_sensitivity *s, const mg_real *a, const mg_real *b) {
  const mg_system *system = c->system;
  mg_real sum = 0;
  for (int body = 0; body < system->n_body; body++) {
    if (!mg_is_moved_by_forces(c, body) || !mg_is_in_crossing(s, body)) continue;
    const mg_body_kind *kind = c->kernels->body_kinds + mg_body_kind_of(c, body);
    const int q = system->body_q[body], u = system->n_q + system->body_u[body];
    for (int i = q; i < q + kind->n_q; i++) sum += a[i] * b[i];
    for (int i = u; i < u + kind->n_u; i++) sum += a[i] * b[i];
  }
  return sum;
}

MG_INTERNAL void mg_after_event_adjoint(mg_context *c, mg_sensitivity *s, mg_real *x_bar) {
  mg_evaluate_run_state(c);
  mg_mark_held_contacts(c, s, 0);
  mg_project_adjoint(c, s, c->run->t, c->run->x, x_bar);
}

MG_INTERNAL mg_real mg_event_adjoint(mg_context *c, mg_sensitivity *s, const mg_crossing *crossing, mg_real rate,
                                     mg_real *x_bar) {
  mg_real *after = c->step.slopes;
  mg_evaluate_run_state(c);
  mg_settle_eta_adjoint(c, s, c->run->t, c->run->x, x_bar);
  if (!(crossing->blow || mg_has_slope_jump(c, s, after)) || crossing->kind == MG_CROSSES_NOTHING || rate == 0 ||
      mg_is_graze(c, crossing, rate))
    return 0;
  const mg_real of_time = mg_dot_in_crossing(c, s, after, x_bar);
  s->t_bar = 0;
  if (crossing->blow && !mg_recover_impulses(c, s, 1)) mg_blow_adjoint(c, s, x_bar);
  mg_settle_eta_adjoint(c, s, c->run->t, c->run->x, x_bar);
  return (of_time - mg_dot_in_crossing(c, s, s->slope_before, x_bar) - s->t_bar) / rate;
}
