/* Certificate of the solvers of linear complementarity problems: the residual is the scaled natural map min(z, A z
   + b), and the tolerance follows from rounding. */
#include "solve/lcp/lcp_solvers.h"
#include "base/base.h"

enum { MG_LCP_BLOCK = 16 }; /* rows of a block */

MG_INTERNAL mg_real mg_diagonal_scale(mg_real a) { return a > 0 ? (mg_real)sqrt(a) : (mg_real)1; }

MG_INTERNAL mg_real mg_lcp_tolerance(int n, mg_real growth) {
  mg_real rounding = (mg_real)1e3 * (mg_real)n * MG_EPS * (growth > 1 ? growth : 1);
  return rounding < MG_LCP_CAP ? rounding : MG_LCP_CAP;
}

/* Scaled natural map; writes *growth = max|D z| / max|D^-1 b|. Rows are treated in blocks, so that A is read by
   columns. */
static mg_real mg_natural_map(int n, const mg_real *A, const mg_real *b, const mg_real *z, mg_real *growth) {
  mg_real worst = 0, c = 0, y = 0, w[MG_LCP_BLOCK];
  for (int first = 0; first < n; first += MG_LCP_BLOCK) {
    int rows = n - first < MG_LCP_BLOCK ? n - first : MG_LCP_BLOCK;
    for (int i = 0; i < rows; ++i) w[i] = b[first + i];
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < rows; ++i) w[i] += A[first + i + j * n] * z[j];
    for (int i = 0; i < rows; ++i) {
      int row = first + i;
      mg_real d = mg_diagonal_scale(A[row + row * n]), yi = z[row] * d, wi = w[i] / d;
      mg_real r = (mg_real)fabs(yi < wi ? yi : wi), ci = (mg_real)fabs(b[row]) / d;
      if (!(yi == yi) || !(r <= MG_MAX)) return MG_MAX;
      if (r > worst) worst = r;
      if (yi > y) y = yi;
      if (ci > c) c = ci;
    }
  }
  *growth = c > 0 ? y / c : 0;
  return c > 0 ? worst / c : worst;
}

MG_API mg_real mg_lcp_residual(int n, const mg_real *A, const mg_real *b, const mg_real *z) {
  mg_real growth;
  return mg_natural_map(n, A, b, z, &growth);
}

MG_INTERNAL int mg_lcp_start(int n, const mg_real *A, const mg_real *b, mg_real *z, mg_lcp_report *report) {
  int nonnegative = 1;
  report->outcome = MG_LCP_SOLVED;
  report->iterations = 0;
  report->rank = 0;
  report->residual = 0;
  for (int i = 0; i < n; ++i) {
    z[i] = 0;
    nonnegative &= b[i] >= 0;
  }
  if (!mg_all_finite(n * n, A) || !mg_all_finite(n, b)) {
    report->outcome = MG_LCP_NOT_FINITE;
    report->residual = MG_MAX;
    return 1;
  }
  if (!nonnegative) report->residual = MG_MAX;
  return nonnegative;
}

MG_INTERNAL int mg_lcp_certify(int n, const mg_real *A, const mg_real *b, const mg_real *candidate, mg_real *z,
                               mg_lcp_report *report) {
  mg_real growth = 0, residual = mg_natural_map(n, A, b, candidate, &growth);
  if (!(residual < report->residual)) return 0;
  report->residual = residual;
  for (int i = 0; i < n; ++i) z[i] = candidate[i];
  if (!(residual <= mg_lcp_tolerance(n, growth))) return 0;
  report->outcome = MG_LCP_SOLVED;
  return 1;
}

MG_INTERNAL int mg_lcp_report_failure(int n, const mg_real *A, const mg_real *b, const mg_real *z, int outcome,
                                      mg_lcp_report *report) {
  report->residual = mg_lcp_residual(n, A, b, z);
  return report->outcome = outcome;
}
