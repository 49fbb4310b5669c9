/* After the active set: the Tikhonov term is taken out again, or the problem is shown to have no solution. */
#include "lcp_scaled.h"

/* y_B += (S_BB + tikhonov I)^-1 (-c - S y)_B: each pass divides the error by pivot / tikhonov. */
static void mg_refine_regular(mg_qp_state *s)
{
  int n = s->n, k = s->k;
  mg_real *residual = s->gathered;
  for (int pass = 0; pass < 3; ++pass) {
    for (int i = 0; i < k; ++i) residual[i] = -s->c[s->index[i]];
    for (int j = 0; j < k; ++j) {
      const mg_real *column = s->S + s->index[j] * n;
      mg_real value = s->trial[s->index[j]];
      for (int i = 0; i < k; ++i) residual[i] -= column[s->index[i]] * value;
    }
    if (mg_max_abs(k, residual) <= 2 * MG_EPS) return;
    mg_cholesky_solve(k, s->L, residual);
    for (int i = 0; i < k; ++i) s->trial[s->index[i]] += residual[i];
  }
}

static int mg_refine_deficient(mg_qp_state *s)
{
  int n = s->n, k = s->k, rank;
  mg_real *S = s->work, *c = S + k * k;
  for (int j = 0; j < k; ++j) {
    const mg_real *column = s->S + s->index[j] * n;
    for (int i = 0; i < k; ++i) S[i + j * k] = column[s->index[i]];
    c[j] = s->c[s->index[j]];
  }
  rank = mg_minimum_norm(k, S, c, MG_LCP_RANK(k), s->gathered, c + k, s->order);
  for (int i = 0; i < k; ++i) s->trial[s->index[i]] = s->gathered[i];
  return rank;
}

/* trial = the minimum-norm solution of S_BB y_B = -c_B, 0 off B; returns the rank of S_BB. */
MG_INTERNAL int mg_qp_refine(mg_qp_state *s)
{
  for (int i = 0; i < s->n; ++i) s->trial[i] = s->y[i];
  if (s->k == 0) return 0;
  if (!(s->pivot > MG_LCP_REGULAR)) return mg_refine_deficient(s);
  mg_refine_regular(s);
  return s->k;
}

/* u = (y - previous)+ is a proof that there is no solution: w, y >= 0 and w = S y + c give
   (S u)'y >= -c'u, so |y|_1 >= -c'u / max|S u|, here beyond 1 / sqrt(eps), c being 1 at most. */
MG_INTERNAL int mg_qp_unbounded(const mg_qp_state *s)
{
  int n = s->n;
  mg_real *u = s->trial, *image = s->work, cu = 0, size = 0, bound;
  for (int i = 0; i < n; ++i) {
    u[i] = s->y[i] > s->previous[i] ? s->y[i] - s->previous[i] : 0;
    image[i] = 0;
    cu += s->c[i] * u[i];
    size += u[i];
  }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) image[i] += s->S[i + j * n] * u[j];
  bound = mg_max_abs(n, image) / (mg_real)sqrt(MG_EPS);
  return -cu > bound && -cu > mg_lcp_tolerance(n, 1) * size;
}
