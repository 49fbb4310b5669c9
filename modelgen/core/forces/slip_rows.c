/* The friction rows whose forces slip makes a multiple of normal forces, and the matrix of the rows with these forces,
   which is not symmetric: A = J M^-1 (J - ratio T)^T. Reads the force ratios; writes the assembled matrix. */
#include "forces/forces.h"
#include "model/model.h"

MG_INTERNAL int mg_tangential_row_count(const mg_context *c, int row) {
  return row < c->layout.support_begin ? c->kernels->contact_kinds[c->contacts.kind[row]].rows - 1 : 0;
}

MG_INTERNAL int mg_list_slip_rows(const mg_context *c, int row, int *list, mg_real *ratio) {
  int n = 0;
  for (int k = 0; k < mg_tangential_row_count(c, row); k++) {
    const int at = c->system->contact_friction_row[row] + k;
    if (c->friction.force_ratio[at] == 0) continue;
    ratio[n] = c->friction.force_ratio[at], list[n++] = c->layout.friction_row_begin + at;
  }
  return n ? n : mg_list_patch_slip_rows(c, row, list, ratio);
}

MG_INTERNAL void mg_couple_slip_to_normal_columns(mg_context *c, const int *list, int n) {
  int slip[MG_FRICTION_ROWS_MAX];
  mg_real ratio[MG_FRICTION_ROWS_MAX];
  c->lcp.is_of_joints = 0;
  for (int j = 0; j < n; j++) {
    const int n_slip = mg_list_slip_rows(c, list[j], slip, ratio);
    for (int k = 0; k < n_slip; k++)
      for (int r = 0; r < n; r++) c->lcp.A[r + n * j] -= ratio[k] * mg_delassus_entry(c, list[r], slip[k]);
  }
}

MG_INTERNAL int mg_has_slip_coupling(const mg_context *c, const int *list, int n) {
  int slip[MG_FRICTION_ROWS_MAX];
  mg_real ratio[MG_FRICTION_ROWS_MAX];
  for (int j = 0; j < n && c->friction.slips; j++)
    if (mg_list_slip_rows(c, list[j], slip, ratio)) return 1;
  return 0;
}
