/* Tangential rows of the contacts and the friction constraints that bound the forces along them: sliding friction
   (two rows), spinning resistance (one row), rolling resistance (two rows). Writes Jacobian rows, Gamma2 and slip
   velocities of the tangential rows.

   Friction forces within one mode: a sticking friction constraint holds its rows like a joint; a slipping one adds -N
   mu^2 s / |mu s| to the normal force N, s being its slip, componentwise in the principal axes of the friction ellipse.
   The force ratios make the matrix unsymmetric. Writes force ratios, forces and accelerations; does not change modes.
 */
#include "forces/forces.h"
#include "base/base.h"
#include "solve/lcp/lcp_solvers.h"
#include "model/model.h"

MG_INTERNAL int mg_contact_of_friction(const mg_context *c, int constraint) {
  int contact = 0;
  while (c->system->contact_friction[contact + 1] <= constraint) contact++;
  return contact;
}

MG_INTERNAL int mg_friction_row_count(const mg_context *c, int constraint) {
  return c->system->friction_kind[constraint] == MG_FRICTION_SPIN ? 1 : 2;
}

MG_INTERNAL int mg_append_sticking_rows_of_contact(const mg_context *c, int contact, int *list, int n) {
  if (!c->run->active[contact]) return n;
  for (int g = c->system->contact_friction[contact]; g < c->system->contact_friction[contact + 1]; g++) {
    if (c->run->friction_mode[g] != MG_STICKING) continue;
    const int first = mg_first_friction_row(c, contact, g), rows = mg_friction_row_count(c, g);
    for (int k = 0; k < rows; k++) list[n++] = first + k;
  }
  return n;
}

MG_INTERNAL int mg_append_sticking_rows(const mg_context *c, int *list, int n) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    n = mg_append_sticking_rows_of_contact(c, i, list, n);
  return mg_append_sticking_patch_rows(c, list, n);
}

MG_INTERNAL mg_real mg_slip_velocity_scale(const mg_context *c, int constraint) {
  return (c->system->friction_kind[constraint] == MG_FRICTION_SLIP ? c->system->length : 1) / c->system->time;
}

MG_INTERNAL mg_real mg_slip_velocity_tolerance(const mg_context *c, int constraint) {
  return c->settings->slip_speed * mg_slip_velocity_scale(c, constraint);
}

MG_INTERNAL mg_real mg_slip_along_direction(const mg_context *c, int contact, int constraint, mg_real *slip) {
  const int row = mg_first_friction_row(c, contact, constraint);
  const mg_real *direction = c->run->slip_direction + 3 * constraint, *t = c->rows.tangents + 6 * contact;
  slip[0] = c->rows.d_dot[row], slip[1] = 0;
  if (c->system->friction_kind[constraint] == MG_FRICTION_SPIN) return slip[0] * direction[0];
  slip[1] = c->rows.d_dot[row + 1];
  return slip[0] * mg_dot3(t, direction) + slip[1] * mg_dot3(t + 3, direction);
}

MG_INTERNAL void mg_set_slip_force_ratio(mg_context *c, int contact, int constraint) {
  const int row = mg_first_friction_row(c, contact, constraint), rows = mg_friction_row_count(c, constraint);
  const mg_real *mu = c->system->friction_kinetic + 2 * constraint,
                *direction = c->run->slip_direction + 3 * constraint;
  const mg_real *t = c->rows.tangents + 6 * contact;
  mg_real slip[2], sign = mg_slip_along_direction(c, contact, constraint, slip) < 0 ? -1 : 1;
  const mg_real direction_tolerance = 2 * mg_slip_velocity_tolerance(c, constraint);
  if (rows == 1) slip[0] = direction[0], sign = 1;
  else if (c->friction.follows_angle &&
           (c->run->friction_mode[constraint] == MG_SLIP_ONSET || c->friction.is_stiff[constraint]))
    mg_slip_direction_at_angle(c, contact, constraint, c->friction.slip_angle[constraint], slip), sign = 1;
  else if (slip[0] * slip[0] + slip[1] * slip[1] <= direction_tolerance * direction_tolerance)
    slip[0] = mg_dot3(t, direction), slip[1] = mg_dot3(t + 3, direction), sign = 1;
  const mg_real a = mu[0] * slip[0], b = mu[1] * slip[1], weighted_slip = sqrt(a * a + b * b);
  c->friction.force_ratio[row - c->layout.friction_row_begin] =
      weighted_slip > 0 ? sign * mu[0] * a / weighted_slip : 0;
  if (rows == 2)
    c->friction.force_ratio[row + 1 - c->layout.friction_row_begin] =
        weighted_slip > 0 ? sign * mu[1] * b / weighted_slip : 0;
}

/* True if the friction constraint of an active contact slips. */
static int mg_is_slipping(const mg_context *c, int contact, int constraint) {
  return c->run->active[contact] && c->run->friction_mode[constraint] >= MG_SLIP_ONSET;
}

/* True if any friction constraint slips; that of patches is not looked at. */
static int mg_may_slip(const mg_context *c) {
  if (c->system->n_patch_slot) return 1;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++)
      if (mg_is_slipping(c, i, g)) return 1;
  return 0;
}

MG_INTERNAL void mg_set_slip_force_ratios(mg_context *c) {
  const mg_system *s = c->system;
  for (int i = 0; i < s->n_friction_row; i++) c->friction.force_ratio[i] = 0;
  c->friction.slips = mg_may_slip(c);
  if (!c->friction.slips) return;
  mg_update_slip_velocities(c);
  for (int i = mg_next_row(c, -1); i < s->n_contact; i = mg_next_row(c, i))
    for (int g = s->contact_friction[i]; g < s->contact_friction[i + 1]; g++) {
      if (!mg_is_slipping(c, i, g)) continue;
      mg_set_slip_force_ratio(c, i, g);
      for (int k = 0; k < mg_friction_row_count(c, g); k++)
        mg_update_inverse_mass_row(c, mg_first_friction_row(c, i, g) + k);
    }
  mg_set_patch_force_ratios(c);
}

MG_INTERNAL void mg_solve_island_with_friction(mg_context *c, int n, const mg_real *rate, mg_real *amount) {
  mg_real pivot = 1;
  int rank = 0;
  const int unsymmetric = mg_has_slip_coupling(c, c->islands.rows, n);
  if (unsymmetric) {
    mg_keep_symmetric_rows(c, n);
    mg_couple_slip_to_normal_columns(c, c->islands.rows, n);
  }
  for (int j = 0; j < n && c->run->forces_redundant; j++)
    for (int r = 0; r < n; r++) c->lcp.b[r] += c->lcp.A[r + n * j] * c->run->reference_force[c->islands.rows[j]];
  if (unsymmetric) pivot = mg_solve_unsymmetric_rows(c, c->islands.rows, n, c->lcp.z), rank = pivot > 0 ? n : 0;
  else
    rank = mg_active_above(n, c->lcp.A, c->lcp.b, c->lcp.mask,
                           c->system->n_joint_row ? c->settings->joint_rank_tolerance : 0, c->lcp.z, c->lcp.work,
                           c->lcp.iwork, &pivot);
  for (int r = 0; r < n; r++)
    amount[c->islands.rows[r]] =
        c->lcp.z[r] + (c->run->forces_redundant ? c->run->reference_force[c->islands.rows[r]] : 0);
  if (rank == n) mg_refine_rows(c, n, unsymmetric, rank, rate, pivot, amount);
}

MG_INTERNAL void mg_apply_slip_forces(mg_context *c) {
  if (!c->friction.slips) return;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    for (int k = 0; k < mg_tangential_row_count(c, i); k++) {
      const int row = c->layout.friction_row_begin + c->system->contact_friction_row[i] + k;
      const mg_real tilt = c->friction.force_ratio[row - c->layout.friction_row_begin];
      if (tilt == 0) continue;
      c->solution.force[row] = -c->solution.force[i] * tilt;
      mg_add_row_response(c, row, c->solution.force[row], c->bodies.acceleration);
    }
  mg_apply_patch_slip_forces(c);
}

MG_INTERNAL mg_real mg_friction_power(const mg_context *c) {
  mg_real power = 0;
  if (!c->friction.slips && !c->layout.n_driven) return 0; /* what sticks to bodies that forces move does no work */
  for (int i = mg_next_row(c, c->layout.friction_row_begin - 1); i < c->layout.friction_row_end;
       i = mg_next_row(c, i)) {
    if (c->solution.force[i] == 0) continue;
    power += c->solution.force[i] *
             ((c->friction.force_ratio[i - c->layout.friction_row_begin] != 0 ? c->rows.d_dot[i] : 0) -
              mg_prescribed_gap_rate(c, i));
  }
  return power;
}

MG_INTERNAL void mg_slip_direction_at_angle(const mg_context *c, int contact, int constraint, mg_real angle,
                                            mg_real *along) {
  const mg_real *direction = c->run->slip_direction + 3 * constraint, *t = c->rows.tangents + 6 * contact;
  const mg_real x = mg_dot3(t, direction), y = mg_dot3(t + 3, direction), size = sqrt(x * x + y * y);
  along[0] = (mg_cos(angle) * x - mg_sin(angle) * y) / size, along[1] = (mg_sin(angle) * x + mg_cos(angle) * y) / size;
}
