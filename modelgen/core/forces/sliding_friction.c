/* The rows of contacts below their normal ones, and the grips that bound the forces along them: friction against slip,
   resistance against spinning and rolling. */
/* Forces with friction within one mode: a stuck grip holds its rows like a joint; a slipping one adds to the normal
   force N the force -N lean along its rows, lean = mu^2 s / |mu s| of the slip s, axis by axis. */
#include "forces/forces.h"
#include "base/base.h"
#include "solve/lcp/solvers.h"
#include "model/model.h"

MG_INTERNAL int mg_grip_contact(const mg_context *c, int grip) {
  int contact = 0;
  while (c->system->contact_grip[contact + 1] <= grip) contact++;
  return contact;
}

MG_INTERNAL int mg_grip_rows(const mg_context *c, int grip) { return c->system->grip_aspect[grip] == MG_SPIN ? 1 : 2; }

/* Appends the rows of stuck grips to a list of n; returns its length. */
MG_INTERNAL int mg_append_sticking_rows(const mg_context *c, int *list, int n) {
  for (int i = 0; i < c->system->n_contact; i++)
    for (int g = c->system->contact_grip[i]; g < c->system->contact_grip[i + 1]; g++)
      for (int k = 0; k < mg_grip_rows(c, g) && c->run->active[i] && c->run->grip[g] == MG_STICKING; k++)
        list[n++] = mg_grip_row(c, i, g) + k;
  return mg_append_sticking_patches(c, list, n);
}

/* The size of the slip of a grip: m/s, of spin and rolling rad/s. */
MG_INTERNAL mg_real mg_slip_scale(const mg_context *c, int grip) {
  return (c->system->grip_aspect[grip] == MG_SLIP ? c->system->length : 1) / c->system->time;
}

MG_INTERNAL mg_real mg_stick_speed(const mg_context *c, int grip) {
  return c->settings->slip_speed * mg_slip_scale(c, grip);
}

/* The slip of a grip past its course: its components s, and returned s.course. */
MG_INTERNAL mg_real mg_speed_along_slip(const mg_context *c, int contact, int grip, mg_real *slip) {
  const int row = mg_grip_row(c, contact, grip);
  const mg_real *course = c->run->slip_direction + 3 * grip, *t = c->tangents + 6 * contact;
  slip[0] = c->d_dot[row], slip[1] = 0;
  if (c->system->grip_aspect[grip] == MG_SPIN) return slip[0] * course[0];
  slip[1] = c->d_dot[row + 1];
  return slip[0] * mg_dot3(t, course) + slip[1] * mg_dot3(t + 3, course);
}

/* Along the slip, which is taken round where it points against its course, so that the force is smooth while one that
   stays on a line passes zero; along the course where there is so little of it that rounding would turn it. */
MG_INTERNAL void mg_update_force_ratio(mg_context *c, int contact, int grip) {
  const int row = mg_grip_row(c, contact, grip), rows = mg_grip_rows(c, grip);
  const mg_real *mu = c->system->grip_kinetic + 2 * grip, *course = c->run->slip_direction + 3 * grip;
  const mg_real *t = c->tangents + 6 * contact;
  mg_real slip[2], sign = mg_speed_along_slip(c, contact, grip, slip) < 0 ? -1 : 1;
  const mg_real least = 2 * mg_stick_speed(c, grip);
  if (rows == 1) slip[0] = course[0], sign = 1;
  else if (c->friction.follows_angle && c->run->grip[grip] == MG_SLIP_ONSET)
    mg_rotated_slip_direction(c, contact, grip, c->friction.slip_angle[grip], slip), sign = 1;
  else if (slip[0] * slip[0] + slip[1] * slip[1] <= least * least)
    slip[0] = mg_dot3(t, course), slip[1] = mg_dot3(t + 3, course), sign = 1;
  const mg_real a = mu[0] * slip[0], b = mu[1] * slip[1], size = sqrt(a * a + b * b);
  c->friction.force_ratio[row - c->friction_row_begin] = size > 0 ? sign * mu[0] * a / size : 0;
  if (rows == 2) c->friction.force_ratio[row + 1 - c->friction_row_begin] = size > 0 ? sign * mu[1] * b / size : 0;
}

static int mg_is_slipping(const mg_context *c, int contact, int grip) {
  return c->run->active[contact] && c->run->grip[grip] >= MG_SLIP_ONSET;
}

/* The leans of all rows below, 0 of those that do not slip, with M^-1 J^T of those that do. */
MG_INTERNAL void mg_update_force_ratios(mg_context *c) {
  const mg_system *s = c->system;
  mg_slip_rates(c);
  for (int i = 0; i < s->n_below; i++) c->friction.force_ratio[i] = 0;
  for (int i = 0; i < s->n_contact; i++)
    for (int g = s->contact_grip[i]; g < s->contact_grip[i + 1]; g++) {
      if (!mg_is_slipping(c, i, g)) continue;
      mg_update_force_ratio(c, i, g);
      for (int k = 0; k < mg_grip_rows(c, g); k++) mg_inverse_mass_row(c, mg_grip_row(c, i, g) + k);
    }
  mg_begin_patch_friction(c);
}

/* J_row M^-1 J_column^T. */
MG_INTERNAL mg_real mg_delassus_entry(const mg_context *c, int row, int column) {
  mg_real sum = 0;
  for (int side = 0; side < 2; side++)
    for (int other = 0; other < 2; other++) {
      const int body = side ? c->f[row] : c->o[row];
      if (body != (other ? c->f : c->o)[column] || !mg_moves(c, body)) continue;
      sum += mg_dot6(c->J + 12 * row + 6 * side, c->MJ + 12 * column + 6 * other);
    }
  return sum;
}

/* Of a contact; those of patches go with three normal rows. */
MG_INTERNAL int mg_friction_row_count(const mg_context *c, int row) {
  return row < c->support_begin ? c->kernels->contact_kinds[c->kind[row]].rows - 1 : 0;
}

/* Takes the leans into the columns of the normal rows among the n assembled in c->lcp.A. */
MG_INTERNAL void mg_couple_columns(mg_context *c, const int *list, int n) {
  for (int j = 0; j < n; j++) {
    const int first =
        c->friction_row_begin + (mg_friction_row_count(c, list[j]) ? c->system->contact_below[list[j]] : 0);
    for (int k = first; k < first + mg_friction_row_count(c, list[j]); k++) {
      const mg_real lean = c->friction.force_ratio[k - c->friction_row_begin];
      for (int r = 0; r < n && lean != 0; r++) c->lcp.A[r + n * j] -= lean * mg_delassus_entry(c, list[r], k);
    }
  }
  mg_couple_supports(c, list, n);
}

static int mg_leans(const mg_context *c, const int *list, int n) {
  for (int j = 0; j < n; j++)
    if (mg_slipping_slot_of_row(c, list[j]) >= 0) return 1;
  for (int j = 0; j < n; j++)
    for (int k = 0; k < mg_friction_row_count(c, list[j]); k++)
      if (c->friction.force_ratio[c->system->contact_below[list[j]] + k] != 0) return 1;
  return 0;
}

/* The forces of an island whose n rows are assembled in c->lcp.A, c->lcp.b: those nearest to their shares where they
   are not unique. */
MG_INTERNAL void mg_hold_coupled_rows(mg_context *c, int n, mg_real *amount) {
  const int oblique = mg_leans(c, c->islands.rows, n);
  if (oblique) mg_couple_columns(c, c->islands.rows, n);
  for (int j = 0; j < n && c->run->forces_redundant; j++)
    for (int r = 0; r < n; r++) c->lcp.b[r] += c->lcp.A[r + n * j] * c->run->reference_force[c->islands.rows[j]];
  if (oblique) mg_asymmetric_solve(c, c->islands.rows, n, c->lcp.z);
  else
    mg_active_above(n, c->lcp.A, c->lcp.b, c->lcp.mask, c->system->n_row ? c->settings->singular : 0, c->lcp.z,
                    c->lcp.work, c->lcp.iwork);
  for (int r = 0; r < n; r++)
    amount[c->islands.rows[r]] =
        c->lcp.z[r] + (c->run->forces_redundant ? c->run->reference_force[c->islands.rows[r]] : 0);
}

/* The forces of slipping grips, from the normal forces, into c->force and c->accel. */
MG_INTERNAL void mg_add_slip_forces(mg_context *c) {
  for (int i = 0; i < c->system->n_contact; i++)
    for (int k = 0; k < mg_friction_row_count(c, i); k++) {
      const int row = c->friction_row_begin + c->system->contact_below[i] + k;
      const mg_real lean = c->friction.force_ratio[row - c->friction_row_begin];
      if (lean == 0) continue;
      c->force[row] = -c->force[i] * lean;
      mg_add_row_response(c, row, c->force[row], c->accel);
    }
  mg_add_patch_friction(c);
}

/* Power of the rows below into the moving bodies; the slip of a stuck grip is an error, which is no work. */
MG_INTERNAL mg_real mg_slipping_power(const mg_context *c) {
  mg_real power = 0;
  for (int i = c->friction_row_begin; i < c->friction_row_end; i++) {
    if (c->force[i] == 0) continue;
    power += c->force[i] * ((c->friction.force_ratio[i - c->friction_row_begin] != 0 ? c->d_dot[i] : 0) -
                            mg_prescribed_gap_rate(c, i));
  }
  return power;
}

/* Along a direction at an angle from the course, in the coordinates of the grip's rows. */
MG_INTERNAL void mg_rotated_slip_direction(const mg_context *c, int contact, int grip, mg_real angle, mg_real *along) {
  const mg_real *course = c->run->slip_direction + 3 * grip, *t = c->tangents + 6 * contact;
  const mg_real x = mg_dot3(t, course), y = mg_dot3(t + 3, course), size = sqrt(x * x + y * y);
  along[0] = (cos(angle) * x - sin(angle) * y) / size, along[1] = (sin(angle) * x + cos(angle) * y) / size;
}
