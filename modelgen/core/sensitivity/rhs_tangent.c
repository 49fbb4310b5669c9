/* Derivative of the right-hand side along a direction, within one contact mode. With forces f and accelerations a of
   the state held, the derivatives of J^T f change the free accelerations and those of J a + gamma the rows; the
   derivatives of the forces then follow from the equations of the forces themselves, (J M^-1 J^T) df = -(J da_free +
   d(J a + gamma)), with the matrix of the state. Writes s->at. */
#include "sensitivity/sensitivity.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

static int mg_first_row_below(const mg_context *c, int contact) {
  return c->layout.friction_row_begin + c->system->contact_friction_row[contact];
}

/* Rows of a contact below its normal one that have a place of their own. */
static int mg_rows_below(const mg_context *c, int contact) {
  return c->system->n_friction ? c->kernels->contact_kinds[c->contacts.kind[contact]].rows - 1 : 0;
}

/* Adds factor * J^T of a row to the wrenches of those of its bodies that forces move. */
static void mg_add_row_wrench(const mg_context *c, int row, mg_real factor, mg_real *wrench) {
  const int o = c->contacts.o[row], f = c->contacts.f[row];
  if (mg_is_moved_by_forces(c, o)) mg_add_multiple6(factor, c->rows.J + 12 * row, wrench + 6 * o);
  if (mg_is_moved_by_forces(c, f)) mg_add_multiple6(factor, c->rows.J + 12 * row + 6, wrench + 6 * f);
}

MG_INTERNAL void mg_gather_wrenches(mg_context *c, mg_sensitivity *s, mg_real t) {
  MG_NEEDS_ANY(c, MG_VALID_FORCES), MG_NEEDS_TIME(c, t);
  const mg_system *system = c->system;
  mg_real of_load[12];
  mg_zero_reals(s->wrench, 6L * system->n_body);
  for (int i = 0; i < system->n_load; i++) {
    mg_zero_reals(of_load, 12);
    mg_load_wrench(c, t, i, of_load);
    for (int k = 0; k < 6; k++) {
      s->wrench[6 * system->load_a[i] + k] += of_load[k];
      if (system->load_b[i] >= 0) s->wrench[6 * system->load_b[i] + k] += of_load[6 + k];
    }
  }
  for (int i = mg_next_row(c, -1); i < system->n_contact; i = mg_next_row(c, i))
    if (c->run->active[i]) mg_add_row_wrench(c, i, c->solution.force[i], s->wrench);
  for (int i = c->layout.joint_row_begin; i < c->layout.joint_row_end; i++)
    mg_add_row_wrench(c, i, c->solution.force[i], s->wrench);
  for (int i = mg_next_row(c, c->layout.friction_row_begin - 1); i < c->layout.friction_row_end; i = mg_next_row(c, i))
    if (c->solution.force[i] != 0) mg_add_row_wrench(c, i, c->solution.force[i], s->wrench);
  MG_NOTE_WITH(c, MG_VALID_WRENCHES, MG_VALID_FORCES);
}

MG_INTERNAL int mg_is_turned_by_slip(const mg_context *c, int constraint, const mg_real *slip) {
  return sqrt(mg_dot2(slip, slip)) > 2 * mg_slip_velocity_tolerance(c, constraint);
}

/* Derivative of the force ratios of a slipping constraint, and the wrench of its part that does not depend on the
   derivative of the normal force. Needs the derivatives of its slip. */
static void mg_slip_ratio_tangent(mg_context *c, mg_sensitivity *s, int direction, int contact, int constraint) {
  MG_NEEDS_TANGENT(c, s, MG_VALID_ROW_TANGENTS, MG_VALID_TWISTS, direction, contact);
  const int row = mg_first_friction_row(c, contact, constraint), rows = mg_friction_row_count(c, constraint),
            first = row - c->layout.friction_row_begin;
  const mg_real *mu = c->system->friction_kinetic + 2 * constraint, *ratio = c->friction.force_ratio + first,
                *slip = c->rows.d_dot + row;
  mg_real mu_dot[2];
  for (int k = 0; k < 2; k++)
    mu_dot[k] =
        mg_number_dot(s, s->directions->friction_kinetic, 2L * c->system->n_friction, direction, 2 * constraint + k);
  if (rows == 1) {
    s->at.ratio[first] = ratio[0] < 0 ? -mu_dot[0] : mu_dot[0];
  } else {
    const int turns = mg_is_turned_by_slip(c, constraint, slip);
    mg_real along[2], along_dot[2] = {0, 0}, v[2], v_dot[2];
    for (int k = 0; k < 2; k++)
      along[k] = turns       ? slip[k]
                 : mu[k] > 0 ? ratio[k] / (mu[k] * mu[k])
                             : 0,
      along_dot[k] = turns ? s->at.rate[row + k] : 0;
    for (int k = 0; k < 2; k++) v[k] = mu[k] * along[k], v_dot[k] = mu_dot[k] * along[k] + mu[k] * along_dot[k];
    const mg_real n = sqrt(v[0] * v[0] + v[1] * v[1]), turned = v[0] * ratio[0] + v[1] * ratio[1] < 0 ? -1 : 1;
    for (int k = 0; k < 2; k++)
      s->at.ratio[first + k] =
          n > 0 ? turned * (mu_dot[k] * v[k] / n +
                            mu[k] * (v_dot[k] - v[k] * (v[0] * v_dot[0] + v[1] * v_dot[1]) / (n * n)) / n)
                : 0;
  }
  for (int k = 0; k < rows; k++)
    mg_add_row_wrench(c, row + k, -c->solution.force[contact] * s->at.ratio[first + k], s->at.wrench);
}

/* Rows of a contact: their residuals and rates, d, the rates of its eta, and what its forces add to the wrenches. */
static void mg_contact_rows_tangent(mg_context *c, mg_sensitivity *s, int direction, int contact, const mg_real *x,
                                    const mg_real *dx, mg_real *slope) {
  const mg_system *system = c->system;
  const int eta = system->n_q + system->n_u + system->contact_eta[contact], below = mg_rows_below(c, contact),
            first = below > 0 ? mg_first_row_below(c, contact) : 0, active = c->run->active[contact];
  mg_real force[MG_ROWS_OF_ONE] = {active ? c->solution.force[contact] : 0};
  for (int k = 0; k < below; k++) force[1 + k] = active ? c->solution.force[first + k] : 0;
  mg_contact_tangent(c, s, direction, contact, x + eta, dx + eta, force, c->bodies.acceleration);
  const mg_real *y = s->y_dot;
  s->at.value[contact] = y[MG_Y_GAP], s->at.rate[contact] = y[MG_Y_RATE], s->at.residual[contact] = y[MG_Y_ACCEL];
  for (int k = 0; k < below; k++)
    s->at.value[first + k] = 0, s->at.rate[first + k] = y[MG_Y_RATE + 1 + k],
                        s->at.residual[first + k] = y[MG_Y_ACCEL + 1 + k];
  for (int k = 0; k < c->contacts.n_eta[contact]; k++) slope[eta + k] = y[MG_Y_ETA_DOT + k];
  const int slot = mg_slot_of_support(c, contact), leads = slot >= 0 && contact == mg_first_support(c, slot);
  for (int k = 0; leads && k < 6; k++) s->at.tangents[6 * slot + k] = y[MG_Y_TANGENTS + k];
  MG_NOTE_TANGENT(c, s, MG_VALID_ROW_TANGENTS, MG_VALID_TWISTS, direction, contact);
  if (!active) return;
  for (int k = 0; k < 6; k++)
    s->at.wrench[6 * c->contacts.o[contact] + k] += y[MG_Y_FIRST + k],
        s->at.wrench[6 * c->contacts.f[contact] + k] += y[MG_Y_SECOND + k];
  for (int g = system->contact_friction[contact]; below && g < system->contact_friction[contact + 1]; g++)
    if (c->run->friction_mode[g] >= MG_SLIP_ONSET) mg_slip_ratio_tangent(c, s, direction, contact, g);
  if (!leads || !c->system->n_friction || !c->patches.friction[slot].slips) return;
  mg_patch_slip_tangent(c, s, direction, slot);
  const int row = mg_first_patch_friction_row(c, slot);
  for (int k = 0; k < MG_PATCH_ROWS; k++)
    mg_add_row_wrench(c, row + k, -s->at.ratio[row + k - c->layout.friction_row_begin], s->at.wrench);
}

static void mg_joint_rows_tangent(mg_context *c, mg_sensitivity *s, int direction, int joint, mg_real t) {
  const mg_joint_kind *kind = c->kernels->joint_kinds + c->system->joint_kind[joint];
  const int row = c->layout.joint_row_begin + c->system->joint_row[joint];
  if (!kind->n_rows) return;
  mg_joint_tangent(c, s, direction, joint, t, c->solution.force + row, c->bodies.acceleration);
  for (int k = 0; k < kind->n_rows; k++)
    s->at.residual[row + k] = s->y_dot[MG_Y_ACCEL + k], s->at.value[row + k] = s->y_dot[MG_Y_VALUE + k];
  for (int k = 0; k < mg_held_joint_rows(c, joint); k++) s->at.rate[row + k] = s->y_dot[MG_Y_RATE + k];
  for (int k = 0; k < 6; k++)
    s->at.wrench[6 * c->system->joint_a[joint] + k] += s->y_dot[MG_Y_FIRST + k],
        s->at.wrench[6 * c->system->joint_b[joint] + k] += s->y_dot[MG_Y_SECOND + k];
}

static void mg_loads_tangent(const mg_context *c, mg_sensitivity *s, int direction, mg_real t) {
  const mg_system *system = c->system;
  for (int i = 0; i < system->n_load; i++) {
    mg_zero_reals(s->y_dot, 12);
    mg_load_tangent(c, s, direction, i, t);
    for (int k = 0; k < 6; k++) {
      s->at.wrench[6 * system->load_a[i] + k] += s->y_dot[k];
      if (system->load_b[i] >= 0) s->at.wrench[6 * system->load_b[i] + k] += s->y_dot[6 + k];
    }
  }
}

/* Accelerations with the derivatives of the forces that the rows still need to be zero, and the rates of q. */
static void mg_bodies_tangent(mg_context *c, mg_sensitivity *s, int direction, const mg_real *x, const mg_real *dx,
                              mg_real *slope) {
  const mg_system *system = c->system;
  for (int b = 0; b < system->n_body; b++) {
    if (!mg_is_moved_by_forces(c, b)) continue;
    const mg_body_kind *kind = c->kernels->body_kinds + mg_body_kind_of(c, b);
    const int q = system->body_q[b], u = system->n_q + system->body_u[b];
    mg_motion_tangent(c, s, direction, b, x + q, x + u, s->wrench + 6 * b, system->gravity, dx + q, dx + u,
                      s->at.wrench + 6 * b);
    for (int k = 0; k < kind->n_q; k++) slope[q + k] = s->y_dot[k];
    for (int k = 0; k < kind->n_u; k++) s->at.acceleration[6 * b + k] = s->y_dot[7 + k];
  }
}

/* Solves for the derivatives of the forces that keep the residuals of the held rows at zero; of forces that are not
   unique, some. Returns the number of these rows, c->lcp.rows. */
static int mg_solve_forces_tangent(mg_context *c, mg_sensitivity *s) {
  const int redundant = c->run->forces_redundant;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    s->at.residual[i] += mg_row_times(c, i, s->at.acceleration);
  for (int i = mg_next_row(c, c->layout.friction_row_begin - 1); i < c->layout.friction_row_end; i = mg_next_row(c, i))
    s->at.residual[i] += mg_row_times(c, i, s->at.acceleration);
  for (int i = c->layout.joint_row_begin; i < c->layout.joint_row_end; i++)
    s->at.residual[i] += mg_row_times(c, i, s->at.acceleration);
  c->run->forces_redundant = 0, c->friction.couples_normal = c->system->n_friction > 0;
  const int n = mg_hold_rows(c, c->run->active, 1, s->at.residual, s->at.force);
  c->run->forces_redundant = redundant, c->friction.couples_normal = 0;
  return n;
}

/* Adds to the accelerations what the derivatives of the forces on the n rows of c->lcp.rows make, and finds those of
   the friction that follows them. */
static void mg_add_forces_tangent(mg_context *c, mg_sensitivity *s, int n) {
  for (int r = 0; r < n; r++) mg_add_row_response(c, c->lcp.rows[r], s->at.force[c->lcp.rows[r]], s->at.acceleration);
  for (int i = mg_next_row(c, -1); c->friction.slips && i < c->layout.support_begin; i = mg_next_row(c, i))
    for (int k = 0; c->run->active[i] && k < mg_rows_below(c, i); k++) {
      const int row = mg_first_row_below(c, i) + k;
      const mg_real ratio = c->friction.force_ratio[row - c->layout.friction_row_begin];
      if (ratio == 0) continue;
      const mg_real change = -ratio * s->at.force[i];
      mg_add_row_response(c, row, change, s->at.acceleration);
      s->at.force[row] = change - c->solution.force[i] * s->at.ratio[row - c->layout.friction_row_begin];
    }
}

/* Derivatives of the friction of slipping patches, and what those of the forces on their supports add to the
   accelerations. */
static void mg_patch_forces_tangent(mg_context *c, mg_sensitivity *s) {
  for (int slot = 0; c->friction.slips && slot < c->system->n_patch_slot; slot++) {
    const mg_patch_friction *r = c->patches.friction + slot;
    const mg_real *N_dot = s->at.force + mg_first_support(c, slot);
    for (int k = 0; r->slips && k < MG_PATCH_ROWS; k++) {
      const int row = mg_first_patch_friction_row(c, slot) + k;
      const mg_real change =
          -(r->force_ratio[k][0] * N_dot[0] + r->force_ratio[k][1] * N_dot[1] + r->force_ratio[k][2] * N_dot[2]);
      mg_add_row_response(c, row, change, s->at.acceleration);
      s->at.force[row] = change - s->at.ratio[row - c->layout.friction_row_begin];
    }
  }
}

MG_INTERNAL void mg_rows_tangent(mg_context *c, mg_sensitivity *s, int direction, mg_real t, const mg_real *x,
                                 const mg_real *dx, const int *marked, mg_real *slope) {
  const mg_system *system = c->system;
  mg_zero_reals(slope, c->layout.n_states);
  mg_zero_reals(s->at.wrench, 6L * system->n_body);
  mg_zero_reals(s->at.value, s->at.force + c->layout.friction_row_end - s->at.value);
  mg_zero_reals(s->at.ratio, system->n_friction_row);
  mg_place_bodies_tangent(c, s, direction, t, x, dx);
  for (int i = mg_next_row(c, -1); i < system->n_contact; i = mg_next_row(c, i)) {
    const int matters = !marked || marked[i] || c->contacts.n_eta[i] || i >= c->layout.support_begin;
    if (matters && mg_is_on_feature_pair(c, i)) mg_contact_rows_tangent(c, s, direction, i, x, dx, slope);
  }
  for (int j = 0; j < system->n_joint; j++) mg_joint_rows_tangent(c, s, direction, j, t);
}

/* mg_rhs_tangent, with the rows of marked contacts, or of all. */
static void mg_marked_rhs_tangent(mg_context *c, mg_sensitivity *s, int direction, mg_real t, const mg_real *x,
                                  const mg_real *dx, const int *marked, mg_real *slope) {
  mg_rows_tangent(c, s, direction, t, x, dx, marked, slope);
  mg_loads_tangent(c, s, direction, t);
  mg_bodies_tangent(c, s, direction, x, dx, slope);
  mg_add_forces_tangent(c, s, mg_solve_forces_tangent(c, s));
  mg_patch_forces_tangent(c, s);
  for (int b = 0; b < c->system->n_body; b++)
    mg_copy_velocity(c, b, s->at.acceleration + 6 * b, slope + c->system->n_q + c->system->body_u[b]);
}

MG_INTERNAL void mg_rhs_tangent(mg_context *c, mg_sensitivity *s, int direction, mg_real t, const mg_real *x,
                                const mg_real *dx, mg_real *slope) {
  MG_NEEDS(c, MG_VALID_FORCES, t, x), MG_NEEDS_WITH(c, MG_VALID_WRENCHES, MG_VALID_FORCES);
  mg_marked_rhs_tangent(c, s, direction, t, x, dx, 0, slope);
  MG_NOTE_TANGENT(c, s, MG_VALID_TANGENTS, MG_VALID_FORCES, MG_ANY_DIRECTION, MG_NO_ROW);
}

MG_INTERNAL int mg_find_redundant_forces(mg_context *c, mg_sensitivity *s) {
  MG_NEEDS_AT_RUN(c, MG_VALID_FORCES);
  mg_real *given = s->at.value, most = 0;
  const int n = mg_list_held_rows(c);
  mg_zero_reals(s->at.value, s->at.force + c->layout.friction_row_end - s->at.value);
  mg_zero_reals(s->at.ratio, c->system->n_friction_row);
  mg_zero_reals(s->at.acceleration, 6L * c->system->n_body);
  for (int r = 0; r < n; r++)
    s->at.force[c->lcp.rows[r]] = given[c->lcp.rows[r]] = 1 + (mg_real)(r * 7 % 11) / 11 - (mg_real)(r % 3) / 2;
  mg_add_forces_tangent(c, s, n);
  mg_patch_forces_tangent(c, s);
  c->lcp.n_assembled = 0;
  mg_solve_forces_tangent(c, s);
  for (int r = 0; r < n; r++) {
    const int row = c->lcp.rows[r];
    s->at.force[row] += given[row], most = mg_max(most, fabs(s->at.force[row]));
  }
  return most > sqrt(MG_EPS);
}

MG_INTERNAL void mg_slope_tangent(mg_context *c, mg_sensitivity *s, int direction, mg_real t, const mg_real *x,
                                  const mg_real *dx, mg_real *slope) {
  mg_marked_rhs_tangent(c, s, direction, t, x, dx, c->run->active, slope);
}
