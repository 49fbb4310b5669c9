/* mg_qp in closed form for one and two contacts. */
#include "lcp_scaled.h"

MG_INTERNAL int mg_qp_one(mg_real a, mg_real b, mg_real *z, int *active, mg_lcp_report *report)
{
  report->iterations = 1;
  if (a > 0) {
    *z = -b / a;
    *active = 1;
    report->rank = 1;
    report->residual = (mg_real)fabs((a * *z + b) / b);
    if (report->residual <= mg_lcp_tolerance(1, 1)) return report->outcome;
    report->residual = MG_MAX;
    return report->outcome = MG_LCP_NOT_FINITE;
  }
  *active = 0;
  *z = 0;
  report->rank = 0;
  report->residual = 1;
  return report->outcome = MG_LCP_INFEASIBLE;
}

/* Returns nonzero if it decided: both diagonals positive and the pair well apart from parallel, where the
   solution is unique. */
MG_INTERNAL int mg_qp_two(const mg_real *A, const mg_real *b, mg_real *z, int *active, mg_lcp_report *report)
{
  mg_real d[2], c[2], y[2], s;
  d[0] = mg_diagonal_scale(A[0]);
  d[1] = mg_diagonal_scale(A[3]);
  s = A[1] / d[0] / d[1];
  if (!(A[0] > 0 && A[3] > 0 && (1 - s) * (1 + s) > (mg_real)1e-4)) return 0;
  for (int i = 0; i < 2; ++i) c[i] = b[i] / d[i];
  report->iterations = 1;
  report->rank = 1;
  y[0] = c[0] < 0 ? -c[0] : 0;
  y[1] = c[1] < 0 ? -c[1] : 0;
  if (y[0] > 0 && s * y[0] + c[1] >= 0)
    y[1] = 0;
  else if (y[1] > 0 && s * y[1] + c[0] >= 0)
    y[0] = 0;
  else
    report->rank = mg_minimum_norm_two(s, c, y);
  for (int i = 0; i < 2; ++i) {
    active[i] = y[i] > 0;
    y[i] = active[i] ? y[i] / d[i] : 0;
  }
  return mg_lcp_certify(2, A, b, y, z, report);
}
