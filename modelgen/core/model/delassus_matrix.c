/* The Delassus matrix J M^-1 J^T: how forces on one row accelerate another, and 1 on the diagonal of rows that yield;
   and M^-1 J^T of any row. Writes c->rows.MJ and c->lcp.A. */
#include "model/model.h"
#include "base/base.h"

MG_INTERNAL void mg_forget_incidence(mg_context *c) { c->islands.incident_begin[0] = -1; }

/* MJ = M^-1 J^T of one body, w its mass_inverse. */
static inline void mg_multiply_inverse_mass(const mg_real *w, const mg_real *J, mg_real *MJ) {
  const mg_real x = J[3], y = J[4], z = J[5];
  MJ[0] = w[0] * J[0], MJ[1] = w[0] * J[1], MJ[2] = w[0] * J[2];
  if (w[2] == 0 && w[3] == 0 && w[6] == 0) {
    MJ[3] = w[1] * x, MJ[4] = w[5] * y, MJ[5] = w[9] * z;
    return;
  }
  for (int k = 0; k < 3; k++) MJ[3 + k] = w[1 + k] * x + w[4 + k] * y + w[7 + k] * z;
}

MG_INTERNAL mg_real mg_update_inverse_mass_row(mg_context *c, int contact) {
  MG_REQUIRE(contact >= 0 && contact < c->layout.spring_row_end);
  const mg_system *s = c->system;
  const int o = c->contacts.o[contact], f = c->contacts.f[contact];
  mg_real *J = c->rows.J + 12 * contact, *MJ = c->rows.MJ + 12 * contact, sum = 0;
  if (mg_is_moved_by_forces(c, o)) mg_multiply_inverse_mass(s->mass_inverse + 10 * o, J, MJ), sum = mg_dot6(J, MJ);
  if (mg_is_moved_by_forces(c, f))
    mg_multiply_inverse_mass(s->mass_inverse + 10 * f, J + 6, MJ + 6), sum += mg_dot6(J + 6, MJ + 6);
  return sum;
}

MG_INTERNAL void mg_add_row_response(mg_context *c, int contact, mg_real amount, mg_real *per_body) {
  MG_REQUIRE(contact >= 0 && contact < c->layout.spring_row_end);
  const int o = c->contacts.o[contact], f = c->contacts.f[contact];
  const mg_real *MJ = c->rows.MJ + 12 * contact;
  if (mg_is_moved_by_forces(c, o)) mg_add_multiple6(amount, MJ, per_body + 6 * o);
  if (mg_is_moved_by_forces(c, f)) mg_add_multiple6(amount, MJ + 6, per_body + 6 * f);
}

/* The six columns of a row that belong to a body. */
static const mg_real *mg_body_half_row(const mg_context *c, const mg_real *rows, int contact, int body) {
  return rows + 12 * contact + (c->contacts.f[contact] == body ? 6 : 0);
}

MG_INTERNAL int mg_are_rows_of_one_pair(const mg_context *c, const int *list, int n) {
  const int o = c->contacts.o[list[0]], f = c->contacts.f[list[0]];
  for (int r = 1; r < n; r++)
    if (c->contacts.o[list[r]] != o || c->contacts.f[list[r]] != f) return 0;
  return 1;
}

/* Adds J MJ of one side of n listed rows, which act on the same body there. */
static void mg_add_products_of_side(mg_context *c, const int *list, int n, int side) {
  for (int column = 0; column < n; column++) {
    const mg_real *MJ = c->rows.MJ + 12 * list[column] + 6 * side;
    for (int r = 0; r < n; r++) c->lcp.A[r + n * column] += mg_dot6(c->rows.J + 12 * list[r] + 6 * side, MJ);
  }
}

/* Lists the rows that act on each body that forces move, sorted by body; a row with one body on both sides once. */
static void mg_set_incidence(mg_context *c) {
  const int n_body = c->system->n_body, n_row = c->layout.spring_row_end, probe = c->system->n_contact;
  int *begin = c->islands.incident_begin;
  for (int b = 0; b <= n_body; b++) begin[b] = 0;
  for (int row = 0; row < n_row; row++) {
    const int o = c->contacts.o[row], f = c->contacts.f[row];
    if (row == probe) continue;
    begin[o] += mg_is_moved_by_forces(c, o), begin[f] += f != o && mg_is_moved_by_forces(c, f);
  }
  for (int b = 0; b < n_body; b++) begin[b + 1] += begin[b];
  for (int row = n_row - 1; row >= 0; row--) {
    const int o = c->contacts.o[row], f = c->contacts.f[row];
    if (row == probe) continue;
    if (f != o && mg_is_moved_by_forces(c, f)) c->islands.incident[--begin[f]] = row;
    if (mg_is_moved_by_forces(c, o)) c->islands.incident[--begin[o]] = row;
  }
}

/* Adds J MJ of n listed rows, through the lists of rows of each body. */
static void mg_add_products_by_body(mg_context *c, const int *list, int n) {
  if (c->islands.incident_begin[0] < 0) mg_set_incidence(c);
  for (int r = 0; r < n; r++) c->lcp.column[list[r]] = r;
  for (int r = 0; r < n; r++)
    for (int side = 0; side < 2; side++) {
      const int body = side ? c->contacts.f[list[r]] : c->contacts.o[list[r]];
      const mg_real *J = mg_body_half_row(c, c->rows.J, list[r], body);
      for (int k = c->islands.incident_begin[body]; k < c->islands.incident_begin[body + 1]; k++) {
        const int column = c->lcp.column[c->islands.incident[k]];
        if (column < 0) continue;
        const mg_real *MJ = mg_body_half_row(c, c->rows.MJ, c->islands.incident[k], body);
        c->lcp.A[r + n * column] += mg_dot6(J, MJ);
      }
    }
  for (int r = 0; r < n; r++) c->lcp.column[list[r]] = -1;
}

/* Notes that c->lcp.A becomes the matrix of n listed rows. */
static void mg_note_assembly(mg_context *c, const int *list, int n) {
  int r = 0;
  if (n == c->system->n_joint_row)
    while (r < n && list[r] == c->layout.joint_row_begin + r) r++;
  c->lcp.is_of_joints = r == n;
  c->lcp.n_assembled++;
}

MG_INTERNAL void mg_assemble_delassus(mg_context *c, const int *list, int n) {
  mg_note_assembly(c, list, n);
  for (int r = 0; r < n; r++) mg_update_inverse_mass_row(c, list[r]);
  for (int k = 0; k < n * n; k++) c->lcp.A[k] = 0;
  if (n > 0 && mg_are_rows_of_one_pair(c, list, n)) {
    const int o = c->contacts.o[list[0]], f = c->contacts.f[list[0]];
    if (mg_is_moved_by_forces(c, o)) mg_add_products_of_side(c, list, n, 0);
    if (mg_is_moved_by_forces(c, f)) mg_add_products_of_side(c, list, n, 1);
  } else mg_add_products_by_body(c, list, n);
  for (int r = 0; r < n; r++) c->lcp.A[r + n * r] += mg_row_yield(c, list[r]);
}

/* Sets MJ of one body of n listed rows, and adds J MJ to c->lcp.A, or sets it if it is the first. */
static inline void mg_add_side_of_pair(mg_context *c, const int *list, int n, int side, int body, int is_first) {
  const mg_real *w = c->system->mass_inverse + 10 * body;
  mg_real *responses = c->rows.MJ + 6 * side;
  for (int r = 0; r < n; r++) {
    const mg_real *row = c->rows.J + 12 * list[r] + 6 * side, J[6] = {row[0], row[1], row[2], row[3], row[4], row[5]};
    mg_real *across = c->lcp.A + r, *down = c->lcp.A + n * r;
    mg_multiply_inverse_mass(w, J, responses + 12 * list[r]);
    for (int k = 0; k <= r; k++, across += n) {
      const mg_real part = mg_dot6(J, responses + 12 * list[k]);
      *across = down[k] = is_first ? part : *across + part;
    }
  }
}

MG_INTERNAL void mg_assemble_delassus_of_pair(mg_context *c, const int *list, int n) {
  const int o = c->contacts.o[list[0]], f = c->contacts.f[list[0]], o_moves = mg_is_moved_by_forces(c, o),
            f_moves = mg_is_moved_by_forces(c, f);
  mg_note_assembly(c, list, n);
  for (int k = 0; k < n * n && !o_moves && !f_moves; k++) c->lcp.A[k] = 0;
  if (o_moves) mg_add_side_of_pair(c, list, n, 0, o, 1);
  if (f_moves && o_moves) mg_add_side_of_pair(c, list, n, 1, f, 0);
  if (f_moves && !o_moves) mg_add_side_of_pair(c, list, n, 1, f, 1);
  for (int r = 0; r < n; r++) c->lcp.A[r + n * r] += mg_row_yield(c, list[r]);
}

MG_INTERNAL int mg_assemble_joint_rows(mg_context *c) {
  const int n = mg_append_joint_rows(c, c->lcp.rows, 0);
  if (n == 0 || c->lcp.is_of_joints) return n;
  if (mg_are_rows_of_one_pair(c, c->lcp.rows, n)) mg_assemble_delassus_of_pair(c, c->lcp.rows, n);
  else mg_assemble_delassus(c, c->lcp.rows, n);
  return n;
}

MG_INTERNAL mg_real mg_square_of_row_change(const mg_context *c, int row, const mg_real *before) {
  mg_real sum = 0;
  for (int side = 0; side < 2; side++) {
    const int body = side ? c->contacts.f[row] : c->contacts.o[row];
    const mg_real *J = c->rows.J + 12 * row + 6 * side, *from = before + 6 * side;
    mg_real change[6], response[6];
    if (!mg_is_moved_by_forces(c, body)) continue;
    for (int k = 0; k < 6; k++) change[k] = J[k] - from[k];
    mg_multiply_inverse_mass(c->system->mass_inverse + 10 * body, change, response);
    sum += mg_dot6(change, response);
  }
  return sum;
}

MG_INTERNAL mg_real mg_delassus_entry(const mg_context *c, int row, int column) {
  MG_REQUIRE(row >= 0 && row < c->layout.spring_row_end && column >= 0 && column < c->layout.spring_row_end);
  mg_real sum = row == column ? mg_row_yield(c, row) : 0;
  for (int side = 0; side < 2; side++)
    for (int other = 0; other < 2; other++) {
      const int body = side ? c->contacts.f[row] : c->contacts.o[row];
      if (body != (other ? c->contacts.f : c->contacts.o)[column] || !mg_is_moved_by_forces(c, body)) continue;
      sum += mg_dot6(c->rows.J + 12 * row + 6 * side, c->rows.MJ + 12 * column + 6 * other);
    }
  return sum;
}
