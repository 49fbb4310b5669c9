/* Rank of the joints: which of the rows that they hold are independent, by Cholesky's factor of J M^-1 J^T in the order
   of the rows, and the dead centres that a linkage passes. Writes the joint workspace and the joint statistics of the
   run. */
#include "forces/forces.h"
#include "base/base.h"
#include "model/model.h"

MG_INTERNAL int mg_rank_joints(mg_context *c, int *rank) {
  const int n = mg_append_joint_rows(c, c->lcp.rows, 0);
  int total = 0;
  if (n > 0 && mg_are_rows_of_one_pair(c, c->lcp.rows, n)) mg_assemble_delassus_of_pair(c, c->lcp.rows, n);
  else mg_assemble_delassus(c, c->lcp.rows, n);
  for (int r = 0; r < n; r++) {
    const mg_real own = c->contacts.is_inertial[c->lcp.rows[r]] ? 0 : c->lcp.A[r + n * r];
    mg_real left = own;
    for (int k = 0; k < r; k++) {
      if (!c->lcp.joint_mask[k]) continue;
      mg_real entry = c->lcp.A[r + n * k];
      for (int j = 0; j < k; j++)
        if (c->lcp.joint_mask[j]) entry -= c->lcp.A[r + n * j] * c->lcp.A[k + n * j];
      c->lcp.A[r + n * k] = entry / c->lcp.A[k + n * k];
      left -= c->lcp.A[r + n * k] * c->lcp.A[r + n * k];
    }
    c->joints.independence[r] = own > 0 && left > 0 ? left / own : 0;
    c->lcp.joint_mask[r] = c->joints.independence[r] > c->settings->joint_rank_tolerance;
    total += c->lcp.joint_mask[r];
    if (rank) rank[mg_row_joint(c, c->lcp.rows[r])] += c->lcp.joint_mask[r];
    if (c->lcp.joint_mask[r]) c->lcp.A[r + n * r] = sqrt(left);
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

/* c->lcp.A = J M^-1 J^T over the n rows of c->lcp.rows, with J of this step on the left and J of the step before on the
   right. */
static void mg_set_products_with_previous(mg_context *c, int n) {
  for (int j = 0; j < n; j++) {
    const int column = c->lcp.rows[j], o = c->contacts.o[column], f = c->contacts.f[column];
    const mg_real *MJ = c->run->joint_response + 12 * (column - c->layout.joint_row_begin);
    for (int i = 0; i < n; i++) {
      const int row = c->lcp.rows[i], bodies[2] = {c->contacts.o[row], c->contacts.f[row]};
      mg_real sum = 0;
      for (int side = 0; side < 2; side++) {
        const mg_real *J = c->rows.J + 12 * row + 6 * side;
        if (!mg_is_moved_by_forces(c, bodies[side])) continue;
        if (o == bodies[side]) sum += mg_dot6(J, MJ);
        if (f == bodies[side]) sum += mg_dot6(J, MJ + 6);
      }
      c->lcp.A[i + n * j] = sum;
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
    if (!(A[k + n * k] > 0)) return A[k + n * k] < 0;
    for (int i = k + 1; i < n; i++) {
      const mg_real factor = A[i + n * k] / A[k + n * k];
      for (int j = k + 1; j < n; j++) A[i + n * j] -= factor * A[k + n * j];
    }
  }
  return 0;
}

/* True if the linkage has passed a dead centre in this step: an independent row has reversed its direction, or the rank
   has fallen. Stores the rows for the next step. */
static int mg_has_passed_dead_centre(mg_context *c) {
  const int n = c->system->n_joint_row, first = c->run->report.rank_min < 0;
  int same = !first, independent = 0, lost = 0;
  for (int r = 0; r < n; r++)
    same &= c->lcp.joint_mask[r] == c->run->joint_row_independent[r],
        lost += c->run->joint_row_independent[r] - c->lcp.joint_mask[r];
  for (int r = 0; r < n && same; r++)
    if (c->lcp.joint_mask[r]) c->lcp.rows[independent++] = c->layout.joint_row_begin + r;
  mg_set_products_with_previous(c, independent);
  for (int r = 0; r < n; r++) c->run->joint_row_independent[r] = c->lcp.joint_mask[r];
  mg_copy_reals(c->run->joint_response, c->rows.MJ + 12 * c->layout.joint_row_begin, 12 * n);
  if (!same) return !first && lost > 0;
  return !mg_has_far_turned_row(c, c->lcp.A, independent) && mg_has_reversed_row(c->lcp.A, independent);
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
