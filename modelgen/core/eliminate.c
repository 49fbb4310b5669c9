/* Problems of friction with patches that slip, whose columns lean: pads and what else holds both ways are eliminated first,
   which the solver does for symmetric rows only. */
#include "core.h"

static int mg_any_rub_leans(const mg_context *c) {
  for (int slot = 0; slot < c->sys->n_slot; slot++)
    if (c->rub[slot].leans) return 1;
  return 0;
}

/* What forces on the rows from m on hold them at rates y, of least norm: x with A_bb x = -y, both from c->lcp on. */
static void mg_hold_both_ways(mg_context *c, const mg_friction_problem *p, int m, const mg_real *y, mg_real *x) {
  const int k = p->n - m;
  mg_real *R = c->lcp, *b = R + k * k, *d = b + k, *scaled = d + k, *beta = scaled + k;
  for (int i = 0; i < k; i++) {
    const int row = c->list[m + i];
    d[i] = 1 / mg_diagonal_scale(mg_product(c, row, row)), b[i] = -y[i] * d[i];
  }
  for (int j = 0; j < k; j++)
    for (int i = 0; i < k; i++) R[i + k * j] = p->A[m + i + p->n * (m + j)] * d[i] * d[j];
  const int rank = mg_triangle(k, R, b, c->lcp_i, MG_LCP_RANK(k));
  mg_solve_triangle(k, rank, R, b, scaled, beta);
  for (int i = 0; i < k; i++) x[c->lcp_i[i]] = scaled[i] * d[c->lcp_i[i]];
}

/* As mg_friction; needs the rows in c->list, those of contacts first. */
MG_INTERNAL int mg_friction_held(mg_context *c, const mg_friction_problem *p, mg_real *z, mg_friction_report *report) {
  int m = 0;
  for (int k = 0; k < p->n_contact; k++) m += p->rows[k];
  if (!mg_any_rub_leans(c) || m == p->n) return mg_friction(p, z, c->marks, report, c->coulomb, c->coulomb_i);
  const int k = p->n - m;
  mg_real *A = c->reduced, *b = A + m * m, *x = b + m;
  for (int j = 0; j <= m; j++) {
    const mg_real *column = j < m ? p->A + p->n * j : p->b;
    mg_real *out = j < m ? A + m * j : b;
    mg_hold_both_ways(c, p, m, column + m, x);
    for (int i = 0; i < m; i++) {
      out[i] = column[i];
      for (int r = 0; r < k; r++) out[i] += p->A[i + p->n * (m + r)] * x[r];
    }
  }
  mg_friction_problem own = *p;
  own.n = m, own.A = A, own.b = b;
  const int outcome = mg_friction(&own, z, c->marks, report, c->coulomb, c->coulomb_i);
  for (int r = 0; r < k; r++) {
    b[r] = p->b[m + r];
    for (int j = 0; j < m; j++) b[r] += p->A[m + r + p->n * j] * z[j];
  }
  mg_hold_both_ways(c, p, m, b, z + m);
  return outcome;
}
