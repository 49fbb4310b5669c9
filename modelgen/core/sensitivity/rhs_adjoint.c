/* Adjoint of the derivative of the right-hand side (rhs_tangent.c), its steps in reverse order. The equations of the
   forces are solved with the transposed matrix, which is the same but for the friction of slip. */
#include "sensitivity/sensitivity.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

static int mg_rows_below_normal(const mg_context *c, int contact) {
  return c->system->n_friction ? c->kernels->contact_kinds[c->contacts.kind[contact]].rows - 1 : 0;
}

static int mg_first_below_normal(const mg_context *c, int contact) {
  return c->layout.friction_row_begin + c->system->contact_friction_row[contact];
}

MG_INTERNAL void mg_clear_cotangents(const mg_context *c, mg_sensitivity *s) {
  const long b = c->system->n_body, rows = c->layout.friction_row_end;
  mg_zero_reals(s->at.pose, 12 * b), mg_zero_reals(s->at.twist, 6 * b), mg_zero_reals(s->at.acceleration, 6 * b);
  mg_zero_reals(s->at.wrench, 6 * b), mg_zero_reals(s->at.value, rows), mg_zero_reals(s->at.rate, rows);
  mg_zero_reals(s->at.residual, rows), mg_zero_reals(s->at.force, rows);
  mg_zero_reals(s->at.ratio, c->system->n_friction_row), mg_zero_reals(s->at.tangents, 6L * c->system->n_patch_slot);
}

MG_INTERNAL mg_real mg_response_times(const mg_context *c, int row, const mg_real *per_body) {
  const int o = c->contacts.o[row], f = c->contacts.f[row];
  mg_real sum = 0;
  if (mg_is_moved_by_forces(c, o)) sum += mg_dot6(c->rows.MJ + 12 * row, per_body + 6 * o);
  if (mg_is_moved_by_forces(c, f)) sum += mg_dot6(c->rows.MJ + 12 * row + 6, per_body + 6 * f);
  return sum;
}

static mg_real mg_wrench_along_row(const mg_context *c, int row, const mg_real *wrench) {
  return mg_dot6(c->rows.J + 12 * row, wrench + 6 * c->contacts.o[row]) +
         mg_dot6(c->rows.J + 12 * row + 6, wrench + 6 * c->contacts.f[row]);
}

/* Row of the slip friction of a contact, or -1 where its force ratio is zero. */
static int mg_slip_row(const mg_context *c, int contact, int k) {
  const int row = mg_first_below_normal(c, contact) + k;
  return c->friction.force_ratio[row - c->layout.friction_row_begin] == 0 ? -1 : row;
}

/* True if an active contact or a patch carries friction of slip. */
static int mg_has_slip_force(const mg_context *c) {
  for (int slot = 0; c->friction.slips && slot < c->system->n_patch_slot; slot++)
    if (c->patches.friction[slot].slips) return 1;
  for (int i = mg_next_row(c, -1); c->friction.slips && i < c->layout.support_begin; i = mg_next_row(c, i))
    for (int k = 0; c->run->active[i] && k < mg_rows_below_normal(c, i); k++)
      if (mg_slip_row(c, i, k) >= 0) return 1;
  return 0;
}

/* amount = -A^-T rate over the n rows of c->lcp.rows, with A the matrix of the forces under slip. Returns 0 where it is
   singular. */
static int mg_solve_transposed_rows(mg_context *c, int n, const mg_real *rate, mg_real *amount) {
  mg_assemble_delassus(c, c->lcp.rows, n);
  mg_couple_slip_to_normal_columns(c, c->lcp.rows, n);
  for (int r = 0; r < n; r++)
    for (int k = 0; k < r; k++) {
      const mg_real entry = c->lcp.A[r + (long)n * k];
      c->lcp.A[r + (long)n * k] = c->lcp.A[k + (long)n * r], c->lcp.A[k + (long)n * r] = entry;
    }
  for (int r = 0; r < n; r++) c->lcp.b[r] = rate[c->lcp.rows[r]], c->lcp.mask[r] = 1;
  const int is_regular = mg_basis_solve(n, c->lcp.A, c->lcp.b, c->lcp.mask, c->lcp.z, c->lcp.work, c->lcp.iwork) > 0;
  for (int r = 0; r < n; r++) amount[c->lcp.rows[r]] = c->lcp.z[r];
  return is_regular;
}

/* From the cotangents of the friction of slipping patches to those of the forces on their supports and of their
   ratios. */
static void mg_patch_forces_adjoint(const mg_context *c, mg_sensitivity *s) {
  for (int slot = 0; c->friction.slips && slot < c->system->n_patch_slot; slot++) {
    const mg_patch_friction *r = c->patches.friction + slot;
    mg_real *N_bar = s->at.force + mg_first_support(c, slot);
    for (int k = 0; r->slips && k < MG_PATCH_ROWS; k++) {
      const int row = mg_first_patch_friction_row(c, slot) + k;
      const mg_real bar = s->at.force[row] + mg_response_times(c, row, s->at.acceleration);
      for (int i = 0; i < 3; i++) N_bar[i] -= r->force_ratio[k][i] * bar;
      s->at.ratio[row - c->layout.friction_row_begin] -= s->at.force[row], s->at.force[row] = 0;
    }
  }
}

/* From the cotangents of forces and accelerations to those of the residuals of the rows; leaves in s->at.acceleration
   the cotangent of the accelerations at fixed forces. */
static void mg_forces_adjoint(mg_context *c, mg_sensitivity *s) {
  const int redundant = c->run->forces_redundant, slips = mg_has_slip_force(c);
  mg_real *force_bar = s->at.force, *rate = c->rows.row_rate;
  mg_patch_forces_adjoint(c, s);
  for (int i = mg_next_row(c, -1); slips && i < c->layout.support_begin; i = mg_next_row(c, i))
    for (int k = 0; c->run->active[i] && k < mg_rows_below_normal(c, i); k++) {
      const int row = mg_slip_row(c, i, k);
      if (row < 0) continue;
      const mg_real ratio = c->friction.force_ratio[row - c->layout.friction_row_begin];
      s->at.ratio[row - c->layout.friction_row_begin] -= c->solution.force[i] * force_bar[row];
      force_bar[i] -= ratio * (force_bar[row] + mg_response_times(c, row, s->at.acceleration));
      force_bar[row] = 0;
    }
  c->run->forces_redundant = 0;
  const int n = mg_list_held_rows(c);
  for (int r = 0; r < n; r++) {
    const int row = c->lcp.rows[r];
    rate[row] = force_bar[row] + mg_response_times(c, row, s->at.acceleration);
  }
  if (slips) s->is_singular |= !mg_solve_transposed_rows(c, n, rate, c->solution.impulse);
  else mg_hold_rows(c, c->run->active, 1, rate, c->solution.impulse);
  c->run->forces_redundant = redundant;
  for (int r = 0; r < n; r++) {
    const int row = c->lcp.rows[r];
    s->at.residual[row] += c->solution.impulse[row];
    for (int k = 0; k < 6; k++)
      s->at.acceleration[6 * c->contacts.o[row] + k] += c->solution.impulse[row] * c->rows.J[12 * row + k],
          s->at.acceleration[6 * c->contacts.f[row] + k] += c->solution.impulse[row] * c->rows.J[12 * row + 6 + k];
  }
}

/* From the cotangents of the force ratios of a slipping constraint to those of its slip and coefficients. */
static void mg_slip_ratio_adjoint(mg_context *c, mg_sensitivity *s, int contact, int constraint) {
  const int row = mg_first_friction_row(c, contact, constraint), rows = mg_friction_row_count(c, constraint),
            first = row - c->layout.friction_row_begin;
  const mg_real *mu = c->system->friction_kinetic + 2 * constraint, *ratio = c->friction.force_ratio + first,
                *slip = c->rows.d_dot + row;
  mg_real *mu_bar = s->adjoint->friction_kinetic + 2 * constraint, *bar = s->at.ratio + first;
  for (int k = 0; k < rows; k++) bar[k] -= c->solution.force[contact] * mg_wrench_along_row(c, row + k, s->at.wrench);
  if (rows == 1) {
    mu_bar[0] += ratio[0] < 0 ? -bar[0] : bar[0];
    return;
  }
  const int turns = mg_is_turned_by_slip(c, constraint, slip);
  mg_real along[2], v[2], v_bar[2];
  for (int k = 0; k < 2; k++)
    along[k] = turns ? slip[k] : mu[k] > 0 ? ratio[k] / (mu[k] * mu[k]) : 0, v[k] = mu[k] * along[k];
  const mg_real n = sqrt(v[0] * v[0] + v[1] * v[1]), turned = v[0] * ratio[0] + v[1] * ratio[1] < 0 ? -1 : 1;
  if (!(n > 0)) return;
  const mg_real mixed = (mu[0] * v[0] * bar[0] + mu[1] * v[1] * bar[1]) / (n * n);
  for (int k = 0; k < 2; k++) {
    v_bar[k] = turned * (mu[k] * bar[k] - v[k] * mixed) / n;
    mu_bar[k] += turned * bar[k] * v[k] / n + v_bar[k] * along[k];
    if (turns) s->at.rate[row + k] += v_bar[k] * mu[k];
  }
}

/* From the cotangents of the ratios of a slipping patch, and of the wrenches that they bring. */
static void mg_patch_ratio_adjoint(mg_context *c, mg_sensitivity *s, int slot) {
  const int row = mg_first_patch_friction_row(c, slot);
  mg_real *bar = s->at.ratio + row - c->layout.friction_row_begin;
  for (int k = 0; k < MG_PATCH_ROWS; k++) bar[k] -= mg_wrench_along_row(c, row + k, s->at.wrench);
  mg_patch_slip_adjoint(c, s, slot, bar);
}

static void mg_contact_rows_adjoint(mg_context *c, mg_sensitivity *s, int contact, const mg_real *x,
                                    const mg_real *slope_bar, mg_real *x_bar) {
  const mg_system *system = c->system;
  const int eta = system->n_q + system->n_u + system->contact_eta[contact], below = mg_rows_below_normal(c, contact),
            first = below > 0 ? mg_first_below_normal(c, contact) : 0, active = c->run->active[contact];
  mg_real force[MG_ROWS_OF_ONE] = {active ? c->solution.force[contact] : 0}, *y = s->y_dot;
  for (int g = system->contact_friction[contact]; active && below && g < system->contact_friction[contact + 1]; g++)
    if (c->run->friction_mode[g] >= MG_SLIP_ONSET) mg_slip_ratio_adjoint(c, s, contact, g);
  const int slot = mg_slot_of_support(c, contact), leads = slot >= 0 && contact == mg_first_support(c, slot);
  if (leads && active && c->system->n_friction && c->patches.friction[slot].slips) mg_patch_ratio_adjoint(c, s, slot);
  mg_zero_reals(y, MG_Y_ETA_DOT + MG_MAX_ETA);
  for (int k = 0; active && k < 6; k++)
    y[MG_Y_FIRST + k] = s->at.wrench[6 * c->contacts.o[contact] + k],
                   y[MG_Y_SECOND + k] = s->at.wrench[6 * c->contacts.f[contact] + k];
  y[MG_Y_GAP] = s->at.value[contact], y[MG_Y_RATE] = s->at.rate[contact], y[MG_Y_ACCEL] = s->at.residual[contact];
  for (int k = 0; k < below; k++)
    force[1 + k] = active ? c->solution.force[first + k] : 0, y[MG_Y_RATE + 1 + k] = s->at.rate[first + k],
              y[MG_Y_ACCEL + 1 + k] = s->at.residual[first + k];
  for (int k = 0; k < c->contacts.n_eta[contact]; k++) y[MG_Y_ETA_DOT + k] = slope_bar[eta + k];
  for (int k = 0; leads && k < 6; k++) y[MG_Y_TANGENTS + k] = s->at.tangents[6 * slot + k];
  mg_contact_adjoint(c, s, contact, x + eta, force, c->bodies.acceleration, x_bar + eta);
}

static void mg_joint_rows_adjoint(mg_context *c, mg_sensitivity *s, int joint, mg_real t) {
  const mg_joint_kind *kind = c->kernels->joint_kinds + c->system->joint_kind[joint];
  const int row = c->layout.joint_row_begin + c->system->joint_row[joint];
  mg_real *y = s->y_dot;
  if (!kind->n_rows) return;
  mg_zero_reals(y, MG_Y_VALUE + MG_ROWS_OF_ONE);
  for (int k = 0; k < 6; k++)
    y[MG_Y_FIRST + k] = s->at.wrench[6 * c->system->joint_a[joint] + k],
                   y[MG_Y_SECOND + k] = s->at.wrench[6 * c->system->joint_b[joint] + k];
  for (int k = 0; k < kind->n_rows; k++)
    y[MG_Y_ACCEL + k] = s->at.residual[row + k], y[MG_Y_VALUE + k] = s->at.value[row + k];
  for (int k = 0; k < mg_held_joint_rows(c, joint); k++) y[MG_Y_RATE + k] = s->at.rate[row + k];
  mg_joint_adjoint(c, s, joint, t, c->solution.force + row, c->bodies.acceleration);
}

MG_INTERNAL void mg_rows_adjoint(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x,
                                 const mg_real *slope_bar, mg_real *x_bar) {
  for (int j = 0; j < c->system->n_joint; j++) mg_joint_rows_adjoint(c, s, j, t);
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (mg_is_on_feature_pair(c, i)) mg_contact_rows_adjoint(c, s, i, x, slope_bar, x_bar);
  mg_place_bodies_adjoint(c, s, t, x, x_bar);
}

/* From the cotangents of rates and accelerations of the bodies to those of state and wrenches. */
static void mg_bodies_adjoint(mg_context *c, mg_sensitivity *s, const mg_real *x, const mg_real *slope_bar,
                              mg_real *x_bar) {
  const mg_system *system = c->system;
  for (int b = 0; b < system->n_body; b++) {
    if (!mg_is_moved_by_forces(c, b)) continue;
    const mg_body_kind *kind = c->kernels->body_kinds + mg_body_kind_of(c, b);
    const int q = system->body_q[b], u = system->n_q + system->body_u[b];
    mg_zero_reals(s->y_dot, 13);
    for (int k = 0; k < kind->n_q; k++) s->y_dot[k] = slope_bar[q + k];
    for (int k = 0; k < kind->n_u; k++) s->y_dot[7 + k] = s->at.acceleration[6 * b + k];
    mg_motion_adjoint(c, s, b, x + q, x + u, s->wrench + 6 * b, system->gravity, x_bar + q, x_bar + u,
                      s->at.wrench + 6 * b);
  }
}

static void mg_loads_adjoint(const mg_context *c, mg_sensitivity *s, mg_real t) {
  const mg_system *system = c->system;
  for (int i = 0; i < system->n_load; i++) {
    mg_zero_reals(s->y_dot, 12);
    for (int k = 0; k < 6; k++) {
      s->y_dot[k] = s->at.wrench[6 * system->load_a[i] + k];
      if (system->load_b[i] >= 0) s->y_dot[6 + k] = s->at.wrench[6 * system->load_b[i] + k];
    }
    mg_load_adjoint(c, s, i, t);
  }
}

MG_INTERNAL void mg_rhs_adjoint(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x, const mg_real *slope_bar,
                                mg_real *x_bar) {
  MG_NEEDS(c, MG_VALID_FORCES, t, x), MG_NEEDS_WITH(c, MG_VALID_WRENCHES, MG_VALID_FORCES);
  const mg_system *system = c->system;
  for (int b = 0; b < system->n_body; b++)
    if (mg_is_moved_by_forces(c, b))
      for (int k = 0; k < c->kernels->body_kinds[mg_body_kind_of(c, b)].n_u; k++)
        s->at.acceleration[6 * b + k] += slope_bar[system->n_q + system->body_u[b] + k];
  mg_forces_adjoint(c, s);
  mg_bodies_adjoint(c, s, x, slope_bar, x_bar);
  mg_loads_adjoint(c, s, t);
  mg_rows_adjoint(c, s, t, x, slope_bar, x_bar);
}
