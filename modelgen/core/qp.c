/* The convex QP of Gauss's principle: scaled, pivoted with a Tikhonov term, refined without it, certified.
   What the term leaves is removed by proximal steps: c is replaced by c - tikhonov * previous y. */
#include "lcp_scaled.h"

enum { MG_QP_ROUNDS = 20 };

static void mg_qp_partition(mg_qp_state *s, int n, mg_real *work, int *iwork)
{
  s->n = n;
  s->k = 0;
  s->pivot = 1;
  s->S = work;
  s->L = s->S + n * n;
  s->c = s->L + n * n;
  s->d = s->c + n;
  s->y = s->d + n;
  s->w = s->y + n;
  s->shifted = s->w + n;
  s->previous = s->shifted + n;
  s->trial = s->previous + n;
  s->gathered = s->trial + n;
  s->work = s->gathered + n;
  s->index = iwork;
  s->flip = iwork + n;
  s->order = iwork + 2 * n;
}

/* Returns 0 when the scaled data leave the range of the reals. */
static int mg_qp_scale(mg_qp_state *s, const mg_real *A, const mg_real *b)
{
  int n = s->n;
  mg_real *reciprocal = s->y;
  for (int i = 0; i < n; ++i) {
    s->d[i] = mg_diagonal_scale(A[i + i * n]);
    reciprocal[i] = 1 / s->d[i];
    s->c[i] = b[i] / s->d[i];
    s->previous[i] = 0;
  }
  s->scale = mg_max_abs(n, s->c);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) s->S[i + j * n] = A[i + j * n] * reciprocal[i] * reciprocal[j];
    if (A[j + j * n] > 0) s->S[j + j * n] = 1;
  }
  if (!(s->scale > 0) || !mg_all_finite(n * n, s->S) || !mg_all_finite(n, s->c)) return 0;
  for (int i = 0; i < n; ++i) s->c[i] /= s->scale;
  return 1;
}

/* Certifies max(y, 0) in the units of z; overwrites y with it. */
static int mg_qp_certify(mg_qp_state *s, const mg_real *A, const mg_real *b, mg_real *y, mg_real *z,
                         mg_lcp_report *report)
{
  mg_real *candidate = s->gathered;
  for (int i = 0; i < s->n; ++i) candidate[i] = y[i] > 0 ? y[i] / s->d[i] * s->scale : 0;
  return mg_lcp_certify(s->n, A, b, candidate, z, report);
}

/* One proximal round; returns nonzero when the outcome is decided. */
static int mg_qp_round(mg_qp_state *s, const mg_real *A, const mg_real *b, int limit, mg_real *z, int *active,
                       mg_lcp_report *report)
{
  for (int i = 0; i < s->n; ++i) s->shifted[i] = s->c[i] - MG_LCP_TIKHONOV * s->previous[i];
  report->iterations += mg_block_pivot(s, active, limit - report->iterations);
  report->rank = mg_qp_refine(s);
  if (mg_qp_certify(s, A, b, s->trial, z, report)) return 1;
  if (mg_qp_certify(s, A, b, s->y, z, report)) return 1;
  if (mg_qp_unbounded(s)) {
    report->outcome = MG_LCP_INFEASIBLE;
    return 1;
  }
  for (int i = 0; i < s->n; ++i) s->previous[i] = s->y[i] > 0 ? s->y[i] : 0;
  return 0;
}

static int mg_qp_general(int n, const mg_real *A, const mg_real *b, int limit, mg_real *z, int *active,
                         mg_lcp_report *report, mg_real *work, int *iwork)
{
  mg_qp_state s;
  mg_qp_partition(&s, n, work, iwork);
  if (!mg_qp_scale(&s, A, b)) return report->outcome = MG_LCP_NOT_FINITE;
  for (int i = 0; i < n; ++i) active[i] = active[i] != 0;
  report->outcome = MG_LCP_ITERATIONS;
  for (int round = 0; round < MG_QP_ROUNDS && report->iterations < limit; ++round)
    if (mg_qp_round(&s, A, b, limit, z, active, report)) break;
  for (int i = 0; i < n; ++i) active[i] = z[i] > 0;
  return report->outcome;
}

MG_API int mg_qp(int n, const mg_real *A, const mg_real *b, int max_iterations, mg_real *z, int *active,
                 mg_lcp_report *report, mg_real *work, int *iwork)
{
  if (mg_lcp_start(n, A, b, z, report)) {
    for (int i = 0; i < n; ++i) active[i] = 0;
    return report->outcome;
  }
  if (n == 1) return mg_qp_one(A[0], b[0], z, active, report);
  if (n == 2 && mg_qp_two(A, b, z, active, report)) return report->outcome;
  return mg_qp_general(n, A, b, max_iterations, z, active, report, work, iwork);
}
