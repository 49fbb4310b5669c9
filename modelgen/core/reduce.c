/* Complementarity problems of the contacts where joints hold as well: the forces of the joints are eliminated,
   S = A_cc - A_cj A_jj^+ A_jc, which stays symmetric and positive semidefinite. */
#include "core.h"

/* y = -A_jj^+ (right side) over the joints, of minimum norm; the first n entries are 0. */
static void mg_hold_joints(mg_context *c, int size, const mg_real *right) {
  mg_active_above(size, c->A, right, c->bound, c->set->singular, c->y, c->lcp, c->lcp_i);
}

static mg_real mg_through_joints(const mg_context *c, int row, int n, int size) {
  mg_real sum = 0;
  for (int k = n; k < size; k++) sum += c->A[row + size * k] * c->y[k];
  return sum;
}

static void mg_reduce(mg_context *c, int n, int size) {
  for (int j = 0; j < n; j++) {
    mg_hold_joints(c, size, c->A + (long)size * j);
    for (int i = 0; i < n; i++) c->S[i + n * j] = c->A[i + size * j] + mg_through_joints(c, i, n, size);
  }
  mg_hold_joints(c, size, c->b);
  for (int i = 0; i < n; i++) c->s[i] = c->b[i] + mg_through_joints(c, i, n, size);
}

/* Appends the pads of all patches that are held flat and the rows of all joints; returns the length of the list. */
MG_INTERNAL int mg_list_bilateral(const mg_context *c, int *list, int n) {
  for (int i = c->first_pad; i < c->sys->n_contact; i++)
    if (c->run->closed[i] && !mg_is_edged(c, i)) list[n++] = i;
  return mg_list_joints(c, list, n);
}

/* Contacts whose gaps the pads' and the joints' rows hold already take no part: what is left of their rows is rounding. */
static void mg_pass_held(mg_context *c, int n, int size) {
  mg_real most = 0;
  for (int r = 0; r < size; r++)
    if (fabs(c->b[r]) > most) most = fabs(c->b[r]);
  for (int j = 0; j < n; j++) {
    const int held = c->S[j + n * j] <= c->set->dependent * c->A[j + size * j];
    if (!held || fabs(c->s[j]) > c->set->dependent * most) continue;
    for (int k = 0; k < n; k++) c->S[j + n * k] = c->S[k + n * j] = 0;
    c->s[j] = 0, c->mask[j] = 0;
  }
}

/* 0 <= z, 0 <= A z + value, complementary, over the n contacts of c->list with the pads' and the joints' rows held at
   zero. Starts from the active set in c->mask and leaves that of the answer there. Appends pads and joints to c->list;
   z of all is in c->z. Returns the solver's outcome. */
MG_INTERNAL int mg_complement(mg_context *c, int n, const mg_real *value, mg_lcp_report *report) {
  const int size = mg_list_bilateral(c, c->list, n), limit = c->set->lcp_iterations;
  c->run->lcp_solves++;
  mg_assemble(c, c->list, size);
  for (int r = 0; r < size; r++) c->b[r] = value[c->list[r]], c->bound[r] = r >= n;
  if (size == n) {
    mg_qp(n, c->A, c->b, limit, c->z, c->mask, report, c->lcp, c->lcp_i);
    return report->outcome;
  }
  mg_reduce(c, n, size);
  mg_pass_held(c, n, size);
  mg_qp(n, c->S, c->s, limit, c->z, c->mask, report, c->lcp, c->lcp_i);
  for (int j = 0; j < n; j++)
    for (int r = n; r < size; r++) c->b[r] += c->A[r + size * j] * c->z[j];
  mg_hold_joints(c, size, c->b);
  for (int r = n; r < size; r++) c->z[r] = c->y[r];
  return report->outcome;
}
