/* What can be proved: that there is no solution, that there is one only, that there are more. */
#include "friction_scaled.h"

static int mg_friction_symmetric(const mg_frictional *s)
{
  const int m = s->m;
  mg_real largest = mg_max_abs(m * m, s->S), odd = 0;
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < j; ++i) {
      const mg_real difference = (mg_real)fabs(s->S[i + j * m] - s->S[j + i * m]);
      odd = difference > odd ? difference : odd;
    }
  return odd <= MG_LCP_RANK(m) * largest;
}

/* Of the relaxed law: a direction u of forces in the cones with S u = 0, u'c < 0, to which the forces of the convex
   program grow. Any solution has 0 <= u'v = (S u)'y + u'c, so |y|_1 >= -u'c / max|S u|, here beyond 1 / sqrt(eps). */
static int mg_friction_unbounded(mg_frictional *s)
{
  const int m = s->m;
  mg_real *shift = s->spare, size, work = 0, bound = 0;
  for (int c = 0; c < s->n; ++c) shift[c] = 0;
  mg_friction_interior(s, shift, 0);
  size = mg_max_abs(m, s->y);
  mg_friction_motion(s);
  for (int i = 0; i < m; ++i) {
    const mg_real image = (mg_real)fabs(s->v[i] - s->c[i]) / size;
    work += s->c[i] * s->y[i] / size;
    bound = image > bound ? image : bound;
  }
  return -work > bound / (mg_real)sqrt(MG_EPS) && -work > mg_lcp_tolerance(m, 1) * (mg_real)m;
}

/* The normal rows alone: forces along t1, t2 could not mend what u >= 0 with u'S u = 0, u'c < 0 on them shows, because
   then S u = 0 on all rows. A matrix that is not symmetric (contacts that slide in a given direction) is decided
   only where it has no other rows. */
MG_INTERNAL int mg_friction_impossible(mg_frictional *s)
{
  const int n = s->n;
  mg_real *N = s->work, *b = N + n * n, *z = b + n;
  int *active = s->iwork, symmetric = mg_friction_symmetric(s);
  mg_lcp_report report;
  if (!symmetric && n < s->m) return 0;
  for (int j = 0; j < n; ++j) {
    active[j] = 0;
    b[j] = s->c[s->normal[j]];
    for (int i = 0; i < n; ++i) N[i + j * n] = s->S[s->normal[i] + s->normal[j] * s->m];
  }
  if (symmetric) mg_qp(n, N, b, 50 * n + 100, z, active, &report, z + n, active + n);
  else mg_enumerate(n, N, b, z, &report, z + n, active);
  if (report.outcome == MG_LCP_INFEASIBLE) return 1;
  return symmetric && s->theta >= 1 && mg_friction_unbounded(s);
}

/* The largest row sum of a symmetric k by k matrix bounds its eigenvalues. */
static mg_real mg_friction_bound(int k, const mg_real *M)
{
  mg_real largest = 0;
  for (int j = 0; j < k; ++j) {
    mg_real sum = 0;
    for (int i = 0; i < k; ++i) sum += (mg_real)fabs(M[i + j * k]);
    largest = sum > largest ? sum : largest;
  }
  return largest;
}

/* Bound of (S^-1)_nn, or of nothing (MG_MAX) where S is not clearly definite. */
static mg_real mg_friction_inverse_bound(const mg_frictional *s, mg_real *L, mg_real *x, mg_real *inverse)
{
  const int m = s->m;
  for (int i = 0; i < m * m; ++i) L[i] = s->S[i];
  if (!(mg_cholesky(m, L) > MG_LCP_REGULAR)) return MG_MAX;
  for (int j = 0; j < s->n; ++j) {
    for (int i = 0; i < m; ++i) x[i] = i == s->normal[j];
    mg_cholesky_solve(m, L, x);
    for (int i = 0; i < s->n; ++i) inverse[i + j * s->n] = x[s->normal[i]];
  }
  return mg_friction_bound(s->n, inverse);
}

static mg_real mg_friction_tangential_bound(const mg_frictional *s)
{
  mg_real largest = 0;
  for (int p = 0; p < s->n_part; ++p)
    for (int j = s->part_row[p]; j < s->part_row[p] + s->part_dim[p]; ++j) {
      mg_real sum = 0;
      for (int q = 0; q < s->n_part; ++q)
        for (int i = s->part_row[q]; i < s->part_row[q] + s->part_dim[q]; ++i) sum += (mg_real)fabs(s->S[i + j * s->m]);
      largest = sum > largest ? sum : largest;
    }
  return largest;
}

/* v_t as a function of the shift s = sum |v_t| of the convex problem (Acary, Cadoux, Lemarechal, Malick, ZAMM 91 (2011),
   155-175) has the Lipschitz constant sqrt(parts |S_tt| |(S^-1)_nn|): below 1 there is one solution for every b. */
static int mg_friction_one_only(const mg_frictional *s)
{
  mg_real *L = s->work, *x = L + s->m * s->m, inverse = mg_friction_inverse_bound(s, L, x, x + s->m);
  int parts = 0;
  if (!(inverse < MG_MAX)) return 0;
  for (int c = 0; c < s->n; ++c)
    if (s->part[c + 1] - s->part[c] > parts) parts = s->part[c + 1] - s->part[c];
  return s->theta >= 1 || (mg_real)parts * mg_friction_tangential_bound(s) * inverse < 1;
}

/* `strict`: no force is at the end of what its contact allows, so that a deficiency leaves room for others. */
MG_INTERNAL void mg_friction_tell(mg_frictional *s, int strict, mg_friction_report *report)
{
  if (!mg_friction_symmetric(s)) return;
  if (report->rank < report->active && strict) report->unique = MG_NOT_UNIQUE;
  else if (s->rank == s->n_bilateral && mg_friction_one_only(s)) report->unique = MG_UNIQUE;
}
