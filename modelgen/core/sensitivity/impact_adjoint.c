/* Adjoint of the derivative of a blow (impact_tangent.c), its parts in reverse order. */
#include "sensitivity/sensitivity.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

/* Replaces x by the solution of the transposed system of mg_lu_solve. */
static void mg_lu_solve_transposed(int k, const mg_real *U, const int *swap, mg_real *x) {
  for (int j = 0; j < k; ++j) {
    for (int i = 0; i < j; ++i) x[j] -= U[i + j * k] * x[i];
    x[j] /= U[j + j * k];
  }
  for (int j = k - 1; j >= 0; --j)
    for (int i = j + 1; i < k; ++i) x[j] -= U[i + j * k] * x[i];
  for (int j = k - 1; j >= 0; --j) {
    mg_real value = x[swap[j]];
    x[swap[j]] = x[j];
    x[j] = value;
  }
}

/* Cotangents of the rates of the rows of one contact or joint, with the twists of the context; of J^T L where
   `wrench_bar` is given. */
static void mg_blow_rates_adjoint(mg_context *c, mg_sensitivity *s, const mg_real *bar, const mg_real *wrench_bar,
                                  mg_real *x_bar) {
  const mg_system *system = c->system;
  const mg_blow *b = s->blow;
  mg_real *y = s->y_dot, impulse[MG_ROWS_OF_ONE];
  for (int r = 0; r < b->n; r++) {
    if (b->normal[r] != r) continue;
    const int contact = b->row[r], eta = system->n_q + system->n_u + system->contact_eta[contact],
              below = c->layout.friction_row_begin + (system->n_friction ? system->contact_friction_row[contact] : 0);
    mg_impulses_of(b, contact, below, c->kernels->contact_kinds[c->contacts.kind[contact]].rows, impulse);
    mg_zero_reals(y, MG_Y_ETA_DOT + MG_MAX_ETA);
    for (int k = 0; k < b->n; k++)
      if (b->normal[k] == r) y[MG_Y_RATE + (k == r ? 0 : 1 + b->row[k] - below)] = bar[k];
    for (int k = 0; k < 6 && wrench_bar; k++)
      y[MG_Y_FIRST + k] = wrench_bar[6 * c->contacts.o[contact] + k],
                     y[MG_Y_SECOND + k] = wrench_bar[6 * c->contacts.f[contact] + k];
    mg_contact_adjoint(c, s, contact, c->run->x + eta, impulse, 0, x_bar + eta);
  }
  for (int j = 0; j < system->n_joint; j++) {
    const int first = c->layout.joint_row_begin + system->joint_row[j],
              rows = c->kernels->joint_kinds[system->joint_kind[j]].n_rows;
    if (!rows) continue;
    mg_impulses_of(b, first, first + 1, rows, impulse);
    mg_zero_reals(y, MG_Y_VALUE + MG_ROWS_OF_ONE);
    for (int k = 0; k < b->n; k++)
      if (b->row[k] >= first && b->row[k] < first + rows) y[MG_Y_RATE + b->row[k] - first] = bar[k];
    for (int k = 0; k < 6 && wrench_bar; k++)
      y[MG_Y_FIRST + k] = wrench_bar[6 * system->joint_a[j] + k],
                     y[MG_Y_SECOND + k] = wrench_bar[6 * system->joint_b[j] + k];
    mg_joint_adjoint(c, s, j, c->run->t, impulse, 0);
  }
}

/* From the cotangents of the equations of the impulses to those of rates and coefficients. */
static void mg_blow_equations_adjoint(const mg_context *c, mg_sensitivity *s, const mg_real *bar, mg_real *before_bar,
                                      mg_real *after_bar) {
  const mg_blow *b = s->blow;
  mg_real by_rate[2], by_mu[2];
  for (int r = 0; r < b->n; r++) before_bar[r] = after_bar[r] = 0;
  for (int r = 0; r < b->n; r++) {
    const int g = b->constraint[r], first = r > 0 && g >= 0 && b->constraint[r - 1] == g ? r - 1 : r;
    if (b->role[r] == MG_BLOW_STRUCK) {
      before_bar[r] -= bar[r] * b->restitution[r] / b->scale[r];
      if (b->normal[r] == r) s->adjoint->restitution[b->row[r]] -= bar[r] * b->rate_before[r] / b->scale[r];
    }
    if (b->role[r] != MG_BLOW_SLIPS) {
      after_bar[r] -= bar[r] / b->scale[r];
      continue;
    }
    const mg_real weight = b->impulse[b->normal[r]] * b->scale[r] * bar[r];
    mg_blow_force_ratio(c, b, r, by_rate, by_mu);
    for (int l = 0; l < mg_friction_row_count(c, g); l++)
      after_bar[first + l] -= weight * by_rate[l], s->adjoint->friction_kinetic[2 * g + l] -= weight * by_mu[l];
  }
}

MG_INTERNAL void mg_blow_adjoint(mg_context *c, mg_sensitivity *s, mg_real *x_bar) {
  const mg_system *system = c->system;
  mg_blow *b = s->blow;
  mg_real *before_bar = b->rate_before_dot, *after_bar = b->rate_after_dot, *u_bar = s->at.acceleration;
  mg_clear_cotangents(c, s);
  for (int body = 0; body < system->n_body; body++)
    if (mg_is_moved_by_forces(c, body))
      mg_copy_velocity(c, body, x_bar + system->n_q + system->body_u[body], u_bar + 6 * body);
  for (int r = 0; r < b->n; r++) b->change[r] = mg_response_times(c, b->row[r], u_bar) / b->scale[r];
  mg_lu_solve_transposed(b->n, b->matrix, b->pivots, b->change);
  mg_blow_equations_adjoint(c, s, b->change, before_bar, after_bar);
  for (int r = 0; r < b->n; r++)
    for (int side = 0; side < 2; side++) {
      const int body = side ? c->contacts.f[b->row[r]] : c->contacts.o[b->row[r]];
      for (int k = 0; k < 6 && mg_is_moved_by_forces(c, body); k++)
        u_bar[6 * body + k] += after_bar[r] * c->rows.J[12 * b->row[r] + 6 * side + k];
    }
  mg_gather_impulses(c, s);
  for (int body = 0; body < system->n_body; body++) {
    if (!mg_is_moved_by_forces(c, body)) continue;
    mg_zero_reals(s->y_dot, 13);
    for (int k = 0; k < 6; k++) s->y_dot[7 + k] = u_bar[6 * body + k];
    mg_motion_adjoint(c, s, body, c->run->x + system->body_q[body], 0, s->wrench + 6 * body, 0,
                      x_bar + system->body_q[body], 0, s->at.wrench + 6 * body);
  }
  mg_blow_rates_adjoint(c, s, after_bar, s->at.wrench, x_bar);
  for (int body = 0; body < system->n_body; body++) {
    if (!mg_is_moved_by_forces(c, body)) continue;
    mg_zero_reals(s->at.twist + 6 * body, 6); /* u+ at fixed impulses is in u_bar already */
    mg_copy_velocity(c, body, u_bar + 6 * body, x_bar + system->n_q + system->body_u[body]);
  }
  mg_update_poses(c, c->run->t, s->before);
  mg_blow_rates_adjoint(c, s, before_bar, 0, x_bar);
  mg_zero_reals(s->at.acceleration, 6L * system->n_body);
  mg_place_bodies_adjoint(c, s, c->run->t, s->before, x_bar);
  mg_update_poses(c, c->run->t, c->run->x);
}
