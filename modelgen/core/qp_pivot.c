/* Block principal pivoting on S + tikhonov I (Portugal, Judice, Vicente, Math. Comp. 63 (1994), 625-643):
   all violated indices change side together; when their number stops falling, the least index alone does,
   which ends (Murty) because the matrix is positive definite. */
#include "lcp_scaled.h"

/* y_B = -(S_BB + tikhonov I)^-1 c_B and w = S y + c off B. */
static void mg_regularised_solve(mg_qp_state *s, const int *active)
{
  int n = s->n, k = 0;
  for (int i = 0; i < n; ++i) {
    s->y[i] = 0;
    s->w[i] = s->shifted[i];
    if (active[i]) s->index[k++] = i;
  }
  s->k = k;
  for (int j = 0; j < k; ++j) {
    const mg_real *column = s->S + s->index[j] * n;
    for (int i = j; i < k; ++i) s->L[i + j * k] = column[s->index[i]];
    s->L[j + j * k] += MG_LCP_TIKHONOV;
    s->gathered[j] = -s->shifted[s->index[j]];
  }
  s->pivot = mg_cholesky(k, s->L);
  mg_cholesky_solve(k, s->L, s->gathered);
  for (int j = 0; j < k; ++j) {
    const mg_real *column = s->S + s->index[j] * n;
    mg_real value = s->gathered[j];
    for (int i = 0; i < n; ++i) s->w[i] += column[i] * value;
    s->y[s->index[j]] = value;
  }
}

/* Marks y_i < 0 on B and w_i < 0 off B; returns how many, and the least of them. */
static int mg_violations(const mg_qp_state *s, const int *active, int *least)
{
  mg_real largest = mg_max_abs(s->n, s->y);
  mg_real tolerance = (mg_real)s->n * MG_EPS * (largest > 1 ? largest : 1);
  int count = 0;
  for (int i = s->n - 1; i >= 0; --i) {
    s->flip[i] = (active[i] ? s->y[i] : s->w[i]) < -tolerance;
    if (s->flip[i]) *least = i;
    count += s->flip[i];
  }
  return count;
}

/* Returns the number of sets tried, at most `limit`; y, w, L, index, k belong to the last one. */
MG_INTERNAL int mg_block_pivot(mg_qp_state *s, int *active, int limit)
{
  int fewest = s->n + 1, patience = 3, least = 0;
  for (int iteration = 1;; ++iteration) {
    int count, single = 0;
    mg_regularised_solve(s, active);
    count = mg_violations(s, active, &least);
    if (count == 0 || iteration >= limit) return iteration;
    if (count < fewest) {
      fewest = count;
      patience = 3;
    } else {
      single = patience == 0;
      patience -= !single;
    }
    if (single)
      active[least] = !active[least];
    else
      for (int i = 0; i < s->n; ++i) active[i] ^= s->flip[i];
  }
}
