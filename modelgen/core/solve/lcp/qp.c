/* The convex quadratic program of Gauss's principle, min z'Az/2 + b'z with z >= 0, which is the complementarity
   problem of a symmetric positive semidefinite A.

   The problem is scaled to unit diagonal, S y + c. Block principal pivoting on S + tikhonov I (Portugal, Judice and
   Vicente, Math. Comp. 63 (1994), 625-643) finds the active set: all violated indices change side together; if their
   number stops falling, the least index alone does, which terminates (Murty) because the matrix is positive
   definite. On the active set the Tikhonov term is taken out again by refinement; what it leaves is removed by
   proximal steps, in which c is replaced by c - tikhonov * previous y. Where rows depend on each other and c fits
   them only up to rounding, a proximal step moves y by c's misfit over tikhonov, many times the same way; each is
   therefore prolonged to the minimum along it or to the first bound. The result is certified, or the problem is
   proved to have no solution. Problems of one and two unknowns are solved in closed form. */
#include "solve/lcp/lcp_solvers.h"
#include "base/base.h"

enum { MG_QP_ROUNDS = 20 }; /* most proximal steps */

/* Closed form for one unknown. */
static int mg_qp_one(mg_real a, mg_real b, mg_real *z, int *active, mg_lcp_report *report) {
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

/* Closed form for two unknowns with positive diagonal and nearly perpendicular rows, where the solution is unique.
   Returns nonzero if it is solved. */
static int mg_qp_two(const mg_real *A, const mg_real *b, mg_real *z, int *active, mg_lcp_report *report) {
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
  if (y[0] > 0 && s * y[0] + c[1] >= 0) y[1] = 0;
  else if (y[1] > 0 && s * y[1] + c[0] >= 0) y[0] = 0;
  else report->rank = mg_minimum_norm_two(s, c, y);
  for (int i = 0; i < 2; ++i) {
    active[i] = y[i] > 0;
    y[i] = active[i] ? y[i] / d[i] : 0;
  }
  return mg_lcp_certify(2, A, b, y, z, report);
}

/* y_B += (S_BB + tikhonov I)^-1 (-c - S y)_B; each pass divides the error by pivot / tikhonov. */
static void mg_refine_regular(mg_qp_state *s) {
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

/* Least-norm solution on the active set by the pivoted factor; returns the rank. */
static int mg_refine_deficient(mg_qp_state *s) {
  int n = s->n, k = s->k, rank;
  mg_real *S = s->work, *c = S + k * k, pivot;
  for (int j = 0; j < k; ++j) {
    const mg_real *column = s->S + s->index[j] * n;
    for (int i = 0; i < k; ++i) S[i + j * k] = column[s->index[i]];
    c[j] = s->c[s->index[j]];
  }
  rank = mg_minimum_norm(k, S, c, MG_LCP_RANK(k), s->gathered, c + k, s->order, &pivot);
  for (int i = 0; i < k; ++i) s->trial[s->index[i]] = s->gathered[i];
  return rank;
}

/* trial = least-norm solution of S_BB y_B = -c_B, 0 outside B; returns the rank of S_BB. */
static int mg_qp_refine(mg_qp_state *s) {
  for (int i = 0; i < s->n; ++i) s->trial[i] = s->y[i];
  if (s->k == 0) return 0;
  if (!(s->pivot > MG_LCP_REGULAR)) return mg_refine_deficient(s);
  mg_refine_regular(s);
  return s->k;
}

/* True if u = max(y - previous, 0) proves that there is no solution: w, y >= 0 and w = S y + c give (S u)'y >=
   -c'u, so that |y|_1 >= -c'u / max|S u|; here this bound exceeds 1 / sqrt(eps), while |c| <= 1. */
static int mg_qp_unbounded(const mg_qp_state *s) {
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

/* y_B = -(S_BB + tikhonov I)^-1 c_B, and w = S y + c outside B. */
static void mg_regularised_solve(mg_qp_state *s, const int *active) {
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

/* Marks y_i < 0 on B and w_i < 0 outside B; returns their number, and the least of them in *least. */
static int mg_violations(const mg_qp_state *s, const int *active, int *least) {
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

/* Changes the active set until nothing is violated; returns the number of sets tried, at most `limit`. y, w, L,
   index and k belong to the last set. */
static int mg_block_pivot(mg_qp_state *s, int *active, int limit) {
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
    if (single) active[least] = !active[least];
    else
      for (int i = 0; i < s->n; ++i) active[i] ^= s->flip[i];
  }
}

/* Divides the memory. */
static void mg_qp_partition(mg_qp_state *s, int n, mg_real *work, int *iwork) {
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

/* Scales the problem to unit diagonal. Returns 0 if the scaled data are not finite. */
static int mg_qp_scale(mg_qp_state *s, const mg_real *A, const mg_real *b) {
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

/* Certifies max(y, 0) in the units of z. */
static int mg_qp_certify(mg_qp_state *s, const mg_real *A, const mg_real *b, mg_real *y, mg_real *z,
                         mg_lcp_report *report) {
  mg_real *candidate = s->gathered;
  for (int i = 0; i < s->n; ++i) candidate[i] = y[i] > 0 ? y[i] / s->d[i] * s->scale : 0;
  return mg_lcp_certify(s->n, A, b, candidate, z, report);
}

/* previous = max(y, 0), moved on along the proximal step u = y - previous of the unknowns that are not at their bound,
   to the minimum of y'Sy/2 + c'y along u or to the first bound. The minimum of the proximal problem at y gives the
   slope there, -tikhonov u'u. */
static void mg_prolong_proximal_step(mg_qp_state *s) {
  const int n = s->n;
  mg_real *u = s->trial, *image = s->work, slope = 0, curvature = 0, longest = MG_MAX;
  for (int i = 0; i < n; ++i) {
    u[i] = s->y[i] > 0 ? s->y[i] - s->previous[i] : 0;
    s->previous[i] = s->y[i] > 0 ? s->y[i] : 0;
    image[i] = 0;
    slope += MG_LCP_TIKHONOV * u[i] * u[i];
    if (u[i] < 0 && -s->previous[i] / u[i] < longest) longest = -s->previous[i] / u[i];
  }
  if (longest == MG_MAX) return;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) image[i] += s->S[i + j * n] * u[j];
  for (int i = 0; i < n; ++i) curvature += u[i] * image[i];
  if (curvature * longest > slope) longest = slope / curvature;
  for (int i = 0; i < n; ++i) {
    const mg_real moved = s->previous[i] + longest * u[i];
    s->previous[i] = moved > 0 ? moved : 0;
  }
}

/* One proximal step; returns nonzero if the outcome is decided. */
static int mg_qp_round(mg_qp_state *s, const mg_real *A, const mg_real *b, int limit, mg_real *z, int *active,
                       mg_lcp_report *report) {
  for (int i = 0; i < s->n; ++i) s->shifted[i] = s->c[i] - MG_LCP_TIKHONOV * s->previous[i];
  report->iterations += mg_block_pivot(s, active, limit - report->iterations);
  report->rank = mg_qp_refine(s);
  if (mg_qp_certify(s, A, b, s->trial, z, report)) return 1;
  if (mg_qp_certify(s, A, b, s->y, z, report)) return 1;
  if (mg_qp_unbounded(s)) {
    report->outcome = MG_LCP_INFEASIBLE;
    return 1;
  }
  mg_prolong_proximal_step(s);
  return 0;
}

/* The general method. */
static int mg_qp_general(int n, const mg_real *A, const mg_real *b, int limit, mg_real *z, int *active,
                         mg_lcp_report *report, mg_real *work, int *iwork) {
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
                 mg_lcp_report *report, mg_real *work, int *iwork) {
  if (mg_lcp_start(n, A, b, z, report)) {
    for (int i = 0; i < n; ++i) active[i] = 0;
    return report->outcome;
  }
  if (n == 1) return mg_qp_one(A[0], b[0], z, active, report);
  if (n == 2 && mg_qp_two(A, b, z, active, report)) return report->outcome;
  return mg_qp_general(n, A, b, max_iterations, z, active, report, work, iwork);
}
