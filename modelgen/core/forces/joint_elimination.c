/* Contact problems with joints: the joint forces are eliminated by the Schur complement S = A_cc - A_cj A_jj^+
   A_jc, which stays symmetric positive semidefinite, and the complementarity problem of the contacts alone is
   solved. Reads the listed rows and their values; writes the complementarity workspace. */
#include "forces/forces.h"
#include "solve/lcp/lcp_solvers.h"
#include "model/model.h"

/* Solve y = -A_jj^+ right over the joint rows, of minimum norm; the first n entries of y are 0. */
static void mg_solve_joint_forces(mg_context *c, int size, const mg_real *right) {
  mg_real pivot;
  mg_active_above(size, c->lcp.A, right, c->lcp.joint_mask, c->settings->joint_rank_tolerance, c->lcp.reduced_z,
                  c->lcp.work, c->lcp.iwork, &pivot);
}

/* Contribution of the joint forces y to one contact row: sum over the joints of A_cj y_j. */
static mg_real mg_joint_elimination_term(const mg_context *c, int row, int n, int size) {
  mg_real sum = 0;
  for (int k = n; k < size; k++) sum += c->lcp.A[row + size * k] * c->lcp.reduced_z[k];
  return sum;
}

/* Form the Schur complement S = A_cc - A_cj A_jj^+ A_jc and the reduced right-hand side. */
static void mg_eliminate_joints(mg_context *c, int n, int size) {
  for (int j = 0; j < n; j++) {
    mg_solve_joint_forces(c, size, c->lcp.A + (long)size * j);
    for (int i = 0; i < n; i++)
      c->lcp.reduced_A[i + n * j] = c->lcp.A[i + size * j] + mg_joint_elimination_term(c, i, n, size);
  }
  mg_solve_joint_forces(c, size, c->lcp.b);
  for (int i = 0; i < n; i++) c->lcp.reduced_b[i] = c->lcp.b[i] + mg_joint_elimination_term(c, i, n, size);
}

MG_INTERNAL int mg_held_row_mask(const mg_context *c, int row) {
  return row >= c->layout.joint_row_begin && row < c->layout.joint_row_end ? 1 : MG_ACTIVE_ABOVE_ROUNDING;
}

MG_INTERNAL int mg_append_bilateral_rows(const mg_context *c, int *list, int n) {
  for (int i = c->layout.support_begin; i < c->system->n_contact; i++)
    if (c->run->closed[i] && !mg_is_support_on_edge(c, i)) list[n++] = i;
  return mg_append_spring_rows(c, list, mg_append_joint_rows(c, list, n));
}

/* Remove contacts from the reduced problem whose gaps the supports and joints already hold: what is left of their
   rows is rounding. */
static void mg_drop_redundant_contact_rows(mg_context *c, int n, int size) {
  mg_real most = 0;
  for (int r = 0; r < size; r++)
    if (fabs(c->lcp.b[r]) > most) most = fabs(c->lcp.b[r]);
  for (int j = 0; j < n; j++) {
    const int held = c->lcp.reduced_A[j + n * j] <= c->settings->contact_rank_tolerance * c->lcp.A[j + size * j];
    if (!held || fabs(c->lcp.reduced_b[j]) > c->settings->contact_rank_tolerance * most) continue;
    for (int k = 0; k < n; k++) c->lcp.reduced_A[j + n * k] = c->lcp.reduced_A[k + n * j] = 0;
    c->lcp.reduced_b[j] = 0, c->lcp.mask[j] = 0;
  }
}

MG_INTERNAL int mg_solve_contact_lcp(mg_context *c, int n, const mg_real *value, mg_lcp_report *report) {
  const int size = mg_append_bilateral_rows(c, c->lcp.rows, n), limit = c->settings->lcp_iterations;
  mg_report_qp_solve(c->run);
  mg_assemble_delassus(c, c->lcp.rows, size);
  for (int r = 0; r < size; r++) c->lcp.b[r] = value[c->lcp.rows[r]], c->lcp.joint_mask[r] = r >= n;
  if (size == n) {
    mg_qp(n, c->lcp.A, c->lcp.b, limit, c->lcp.z, c->lcp.mask, report, c->lcp.work, c->lcp.iwork);
    return report->outcome;
  }
  if (n > 0) mg_eliminate_joints(c, n, size);
  mg_drop_redundant_contact_rows(c, n, size);
  mg_qp(n, c->lcp.reduced_A, c->lcp.reduced_b, limit, c->lcp.z, c->lcp.mask, report, c->lcp.work, c->lcp.iwork);
  for (int j = 0; j < n; j++)
    for (int r = n; r < size; r++) c->lcp.b[r] += c->lcp.A[r + size * j] * c->lcp.z[j];
  mg_solve_joint_forces(c, size, c->lcp.b);
  for (int r = n; r < size; r++) c->lcp.z[r] = c->lcp.reduced_z[r];
  return report->outcome;
}
