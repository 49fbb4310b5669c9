/* Residual of a friction problem as given (mg_friction_residual), and what can be proved of a problem: that
   there is no solution, that the solution is unique, that it is not. */
#include "solve/friction/friction_solvers.h"
#include "base/base.h"
#include "solve/lcp/lcp_solvers.h"

typedef struct {
  mg_real error, size, force; /* maxima of the residual, of b and of z, in the units of the residual */
} mg_friction_measure;

/* w of one row of the given problem. */
static mg_real mg_friction_row_motion(const mg_friction_problem *p, const mg_real *z, int row) {
  mg_real w = p->b[row];
  for (int j = 0; j < p->n; ++j) w += p->A[row + j * p->n] * z[j];
  return w;
}

/* Raises the maxima of error, right-hand side and force. */
static void mg_friction_update_measure(mg_friction_measure *at, mg_real error, mg_real size, mg_real force) {
  if (!(error <= at->error)) at->error = error;
  if (size > at->size) at->size = size;
  if (force > at->force) at->force = force;
}

/* Measures one part of a contact; returns |mu w|, by which the relaxed law lowers w_n. */
static mg_real mg_measure_friction_part(const mg_friction_problem *p, const mg_real *z, int row, int count,
                                        const mg_real *mu, mg_real normal, mg_friction_measure *at) {
  mg_real f[2] = {0, 0}, w[2] = {0, 0}, b[2] = {0, 0}, rho = 0, root;
  int k = 0;
  for (int i = 0; i < count; ++i) {
    if (!(mu[i] > 0)) {
      if (fabs(z[row + i]) > 0) at->error = MG_MAX;
      continue;
    }
    f[k] = z[row + i] / mu[i];
    w[k] = mu[i] * mg_friction_row_motion(p, z, row + i);
    b[k] = mu[i] * p->b[row + i];
    rho += mu[i] * mu[i] * (mg_real)fabs(p->A[(row + i) * (p->n + 1)]);
    ++k;
  }
  if (k == 0) return 0;
  rho = rho > 0 ? rho / (mg_real)k : (mg_real)1;
  root = (mg_real)sqrt(rho);
  mg_friction_update_measure(at, mg_friction_disc_error(k, f, w, rho, normal), mg_friction_norm(k, b) / root,
                             normal * root);
  return mg_friction_norm(k, w);
}

/* Measures all rows of a contact. */
static void mg_measure_friction_contact(const mg_friction_problem *p, const mg_real *z, int contact,
                                        mg_friction_measure *at) {
  const int row = p->first[contact], rows = p->rows[contact];
  const mg_real *cone = p->cone + MG_CONE * contact, rolling[2] = {cone[3], cone[3]};
  const mg_real d = mg_diagonal_scale((mg_real)fabs(p->A[row * (p->n + 1)]));
  mg_real w = mg_friction_row_motion(p, z, row), moves = 0, force = z[row] * d;
  if (rows >= 3) moves += mg_measure_friction_part(p, z, row + 1, 2, cone, z[row], at);
  if (rows >= 6) moves += mg_measure_friction_part(p, z, row + 3, 1, cone + 2, z[row], at);
  if (rows >= 6) moves += mg_measure_friction_part(p, z, row + 4, 2, rolling, z[row], at);
  w = (p->law == MG_RELAXED ? w - moves : w) / d;
  mg_friction_update_measure(at, (mg_real)fabs(force < w ? force : w), (mg_real)fabs(p->b[row]) / d, force);
}

/* True if the row belongs to no contact. */
static int mg_friction_is_bilateral(const mg_friction_problem *p, int row) {
  for (int c = 0; c < p->n_contact; ++c)
    if (row >= p->first[c] && row < p->first[c] + p->rows[c]) return 0;
  return 1;
}

MG_INTERNAL mg_real mg_friction_certify(const mg_friction_problem *p, const mg_real *z, mg_real *growth) {
  mg_friction_measure at = {0, 0, 0};
  for (int c = 0; c < p->n_contact; ++c) mg_measure_friction_contact(p, z, c, &at);
  for (int i = 0; i < p->n; ++i)
    if (mg_friction_is_bilateral(p, i)) {
      const mg_real d = mg_diagonal_scale((mg_real)fabs(p->A[i * (p->n + 1)]));
      mg_friction_update_measure(&at, (mg_real)fabs(mg_friction_row_motion(p, z, i)) / d, (mg_real)fabs(p->b[i]) / d,
                                 (mg_real)fabs(z[i]) * d);
    }
  *growth = at.size > 0 ? at.force / at.size : 0;
  if (!(at.error <= MG_MAX)) return MG_MAX;
  return at.size > 0 ? at.error / at.size : at.error;
}

MG_API mg_real mg_friction_residual(const mg_friction_problem *problem, const mg_real *z) {
  mg_real growth;
  return mg_friction_certify(problem, z, &growth);
}

/* True if S is symmetric up to rounding. */
static int mg_friction_is_symmetric(const mg_scaled_friction *s) {
  const int m = s->m;
  mg_real largest = mg_max_abs(m * m, s->S), odd = 0;
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < j; ++i) {
      const mg_real difference = (mg_real)fabs(s->S[i + j * m] - s->S[j + i * m]);
      odd = difference > odd ? difference : odd;
    }
  return odd <= MG_LCP_RANK(m) * largest;
}

/* True if the convex program of the relaxed law is proved to be unbounded: a direction u of forces within the
   cones with S u = 0, u'c < 0, found by the interior-point method. Any solution has 0 <= u'v = (S u)'y + u'c, so
   that |y|_1 >= -u'c / max|S u|; here this bound exceeds 1 / sqrt(eps). */
static int mg_friction_is_unbounded(mg_scaled_friction *s) {
  const int m = s->m;
  mg_real *shift = s->spare, size, work = 0, bound = 0;
  for (int c = 0; c < s->n; ++c) shift[c] = 0;
  mg_friction_interior(s, shift, 0);
  size = mg_max_abs(m, s->y);
  mg_friction_update_motion(s);
  for (int i = 0; i < m; ++i) {
    const mg_real image = (mg_real)fabs(s->v[i] - s->c[i]) / size;
    work += s->c[i] * s->y[i] / size;
    bound = image > bound ? image : bound;
  }
  return -work > bound / (mg_real)sqrt(MG_EPS) && -work > mg_lcp_tolerance(m, 1) * (mg_real)m;
}

MG_INTERNAL int mg_friction_is_infeasible(mg_scaled_friction *s) {
  const int n = s->n;
  mg_real *N = s->work, *b = N + n * n, *z = b + n;
  int *active = s->iwork, symmetric = mg_friction_is_symmetric(s);
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
  return symmetric && s->theta >= 1 && mg_friction_is_unbounded(s);
}

/* Largest row sum of a symmetric k by k matrix, a bound of its eigenvalues. */
static mg_real mg_row_sum_bound(int k, const mg_real *M) {
  mg_real largest = 0;
  for (int j = 0; j < k; ++j) {
    mg_real sum = 0;
    for (int i = 0; i < k; ++i) sum += (mg_real)fabs(M[i + j * k]);
    largest = sum > largest ? sum : largest;
  }
  return largest;
}

/* Bound of the norm of (S^-1)_nn, or MG_MAX if S is not clearly definite. */
static mg_real mg_friction_inverse_bound(const mg_scaled_friction *s, mg_real *L, mg_real *x, mg_real *inverse) {
  const int m = s->m;
  for (int i = 0; i < m * m; ++i) L[i] = s->S[i];
  if (!(mg_cholesky(m, L) > MG_LCP_REGULAR)) return MG_MAX;
  for (int j = 0; j < s->n; ++j) {
    for (int i = 0; i < m; ++i) x[i] = i == s->normal[j];
    mg_cholesky_solve(m, L, x);
    for (int i = 0; i < s->n; ++i) inverse[i + j * s->n] = x[s->normal[i]];
  }
  return mg_row_sum_bound(s->n, inverse);
}

/* Bound of the norm of S_tt. */
static mg_real mg_friction_tangential_bound(const mg_scaled_friction *s) {
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

/* True if the solution is unique for every b: v_t as a function of the shift sum |v_t| of the convex problem
   (Acary, Cadoux, Lemarechal and Malick, ZAMM 91 (2011), 155-175) has the Lipschitz constant sqrt(parts |S_tt|
   |(S^-1)_nn|), and this is below 1. */
static int mg_friction_is_unique(const mg_scaled_friction *s) {
  mg_real *L = s->work, *x = L + s->m * s->m, inverse = mg_friction_inverse_bound(s, L, x, x + s->m);
  int parts = 0;
  if (!(inverse < MG_MAX)) return 0;
  for (int c = 0; c < s->n; ++c)
    if (s->part[c + 1] - s->part[c] > parts) parts = s->part[c + 1] - s->part[c];
  return s->theta >= 1 || (mg_real)parts * mg_friction_tangential_bound(s) * inverse < 1;
}

MG_INTERNAL void mg_friction_report_uniqueness(mg_scaled_friction *s, int strict, mg_friction_report *report) {
  if (!mg_friction_is_symmetric(s)) return;
  if (report->rank < report->active && strict) report->unique = MG_NOT_UNIQUE;
  else if (s->rank == s->n_bilateral && mg_friction_is_unique(s)) report->unique = MG_UNIQUE;
}
