/* Rank of the joints: which of the rows that they hold are independent, by Cholesky's factor of J M^-1 J^T in the order
   of the rows, and the dead centres that a linkage passes. Writes the joint workspace and the joint statistics of the
   run. */
#include "forces/forces.h"
#include "base/base.h"
#include "model/model.h"

MG_INTERNAL int mg_rank_joints(mg_context *c, int *rank) {
  const int n = mg_assemble_joint_rows(c);
  int total = 0;
  MG_REQUIRE(mg_is_matrix_of_rows(c, c->lcp.rows, n));
  c->lcp.is_of_joints = 0;
  for (int r = 0; r < n; r++) { /* column r of the upper factor; the entries below the diagonal stay */
    mg_real *column = c->lcp.A + n * r;
    const mg_real own = c->contacts.is_inertial[c->lcp.rows[r]] ? 0 : column[r];
    mg_real left = own;
    for (int k = 0; k < r; k++) {
      const mg_real *other = c->lcp.A + n * k;
      mg_real entry = other[r];
      for (int j = 0; j < k; j++) entry -= column[j] * other[j];
      column[k] = c->lcp.joint_mask[k] ? entry / other[k] : 0;
      left -= column[k] * column[k];
    }
    c->joints.independence[r] = own > 0 && left > 0 ? left / own : 0;
    c->lcp.joint_mask[r] = c->joints.independence[r] > c->settings->joint_rank_tolerance;
    total += c->lcp.joint_mask[r];
    if (rank) rank[mg_row_joint(c, c->lcp.rows[r])] += c->lcp.joint_mask[r];
    if (c->lcp.joint_mask[r]) column[r] = sqrt(left);
  }
  return total;
}

MG_INTERNAL int mg_count_dependent_joint_rows(mg_context *c) {
  int count = 0;
  mg_rank_joints(c, 0);
  for (int r = 0; r < c->system->n_joint_row; r++)
    count += !c->lcp.joint_mask[r] && !c->contacts.is_inertial[c->layout.joint_row_begin + r];
  return count;
}

/* True if the independent joint rows have changed so little since the step before that none can have turned far or
   reversed its direction. Needs the factor of mg_rank_joints.

   For the rows J, those of the step before P and E = J - P, all scaled by the diagonal of J M^-1 J^T,

     y^T (J M^-1 P^T) y = |J^T y|^2 - (J^T y, E^T y) >= |J^T y| (|J^T y| - |E^T y|) > 0   in the metric M^-1

   if the sum of |E|^2 over the rows is less than the least eigenvalue of J M^-1 J^T. Its trace is n, so that this is at
   least its determinant, the product of the independences, times (1 - 1/n)^(n - 1) > 1/e. */
static int mg_have_rows_turned_little(const mg_context *c) {
  const int n = c->system->n_joint_row;
  mg_real change = 0, determinant = 1;
  for (int r = 0; r < n; r++) {
    if (!c->lcp.joint_mask[r]) continue;
    const mg_real pivot = c->lcp.A[r + n * r], *before = c->run->joint_row_before + 12 * r;
    MG_REQUIRE(!c->lcp.is_of_joints && pivot > 0);
    change +=
        mg_square_of_row_change(c, c->layout.joint_row_begin + r, before) * c->joints.independence[r] / (pivot * pivot);
    determinant *= c->joints.independence[r];
  }
  return 3 * change < determinant;
}

/* c->lcp.A = J M^-1 J^T over the n rows of c->lcp.rows, with J of this step on the left and J of the step before on the
   right. */
static void mg_set_products_with_previous(mg_context *c, int n) {
  const int *rows = c->lcp.rows, *o = c->contacts.o, *f = c->contacts.f;
  for (int j = 0; j < n; j++) {
    const mg_real *J = c->run->joint_row_before + 12 * (rows[j] - c->layout.joint_row_begin);
    mg_real *column = c->lcp.A + n * j;
    mg_zero_reals(column, n);
    for (int side = 0; side < 2; side++) {
      const int body = side ? f[rows[j]] : o[rows[j]];
      if (!mg_is_moved_by_forces(c, body)) continue;
      for (int i = 0; i < n; i++) {
        const mg_real *MJ = c->rows.MJ + 12 * rows[i];
        if (o[rows[i]] == body) column[i] += mg_dot6(MJ, J + 6 * side);
        else if (f[rows[i]] == body) column[i] += mg_dot6(MJ + 6, J + 6 * side);
      }
    }
  }
}

/* True if a step has turned one of n rows so far, by some 75 degrees, that their product A with those of the step
   before does not tell whether the part of one that is independent of the others has reversed. */
static int mg_has_far_turned_row(const mg_context *c, const mg_real *A, int n) {
  for (int k = 0; k < n; k++) {
    const mg_real *J = c->rows.J + 12 * c->lcp.rows[k], *MJ = c->rows.MJ + 12 * c->lcp.rows[k];
    if (4 * A[k + n * k] < mg_dot6(J, MJ) + mg_dot6(J + 6, MJ + 6)) return 1;
  }
  return 0;
}

/* True if one of n rows has reversed its direction: a pivot of the product A of the rows with those of the step before
   is negative. Rows are not exchanged: each pivot belongs to the part of a row that is independent of the rows before
   it, so that two reversals do not cancel. */
static int mg_has_reversed_row(mg_real *A, int n) {
  for (int k = 0; k < n; k++) {
    mg_real *factor = A + n * k;
    if (!(factor[k] > 0)) return factor[k] < 0;
    for (int i = k + 1; i < n; i++) factor[i] /= factor[k];
    for (int j = k + 1; j < n; j++)
      for (int i = k + 1; i < n; i++) A[i + n * j] -= factor[i] * A[k + n * j];
  }
  return 0;
}

/* True if an independent row has reversed its direction in this step. Uses c->lcp.A and c->lcp.rows. */
static int mg_has_reversed_independent_row(mg_context *c) {
  int n = 0;
  if (mg_have_rows_turned_little(c)) return 0;
  for (int r = 0; r < c->system->n_joint_row; r++)
    if (c->lcp.joint_mask[r]) c->lcp.rows[n++] = c->layout.joint_row_begin + r;
  mg_set_products_with_previous(c, n);
  return !mg_has_far_turned_row(c, c->lcp.A, n) && mg_has_reversed_row(c->lcp.A, n);
}

/* True if the linkage has passed a dead centre in this step: an independent row has reversed its direction, or the rank
   has fallen. Stores the rows for the next step. */
static int mg_has_passed_dead_centre(mg_context *c) {
  const int n = c->system->n_joint_row, first = c->run->report.rank_min < 0;
  int same = !first, lost = 0;
  for (int r = 0; r < n; r++)
    same &= c->lcp.joint_mask[r] == c->run->joint_row_independent[r],
        lost += c->run->joint_row_independent[r] - c->lcp.joint_mask[r];
  const int has_passed = same ? mg_has_reversed_independent_row(c) : !first && lost > 0;
  for (int r = 0; r < n; r++) c->run->joint_row_independent[r] = c->lcp.joint_mask[r];
  mg_copy_reals(c->run->joint_row_before, c->rows.J + 12 * c->layout.joint_row_begin, 12 * n);
  return has_passed;
}

/* Independence of the rows of a joint from those of the joints before it: the product over its rows, except those that
   have been dependent at every step. */
static mg_real mg_joint_independence(const mg_context *c, int joint) {
  const int first = c->system->joint_row[joint];
  mg_real product = 1;
  for (int r = first; r < first + c->kernels->joint_kinds[c->system->joint_kind[joint]].n_rows; r++)
    if (c->run->joint_row_ever_independent[r]) product *= c->joints.independence[r];
  return product;
}

/* Joint whose independence is least, relative to the largest that it has had since the start; *least receives it. */
static int mg_least_independent_joint(mg_context *c, mg_real *least) {
  int least_independent = -1;
  *least = 1;
  for (int r = 0; r < c->system->n_joint_row; r++)
    c->run->joint_row_ever_independent[r] =
        c->lcp.joint_mask[r] || (c->run->report.rank_min >= 0 && c->run->joint_row_ever_independent[r]);
  for (int j = 0; j < c->system->n_joint; j++) {
    const mg_real left = mg_joint_independence(c, j);
    if (c->run->report.rank_min < 0 || left > c->run->joint_independence_max[j])
      c->run->joint_independence_max[j] = left;
    if (left < *least * c->run->joint_independence_max[j])
      *least = left / c->run->joint_independence_max[j], least_independent = j;
  }
  return least_independent;
}

MG_INTERNAL void mg_monitor_joint_rank(mg_context *c) {
  MG_NEEDS_AT_RUN(c, MG_VALID_TWISTS), MG_NEEDS_WITH(c, MG_VALID_JOINT_ROWS, MG_VALID_TWISTS);
  mg_real off, least;
  const int rank = mg_rank_joints(c, 0), least_independent = mg_least_independent_joint(c, &least);
  if (mg_has_passed_dead_centre(c)) mg_report_dead_centre(c->run, least_independent);
  mg_worst_joint(c, c->rows.d, &off);
  mg_report_joints(c->run, off, rank);
  mg_report_joint_margin(c->run, least_independent, least);
}
