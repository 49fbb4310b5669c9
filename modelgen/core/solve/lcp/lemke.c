/* Lemke's complementary pivoting on w - A z - h z0 = b with lexicographic ties (Cottle, Pang and Stone, algorithm
   4.4.5 and section 4.9). If the path of one covering vector h ends on a ray or becomes long, another h is tried.
   The last basis is solved anew from the data, and certified. */
#include "solve/lcp/lcp_solvers.h"
#include "base/base.h"

enum {
  MG_LEMKE_COVERS = 3,     /* covering vectors */
  MG_LEMKE_SHORT_PATH = 20 /* pivots per row after which another covering vector is tried first */
};

typedef struct {
  int n, width; /* columns: w (n), z (n), z0, right-hand side */
  mg_real *T;   /* n rows of `width` */
  int *basis;   /* the column that is basic in each row */
} mg_tableau;

/* Entry i of covering vector number `cover`. */
static mg_real mg_covering_vector(int covering, int n, int i) {
  mg_real place = (mg_real)(i + 1) / (mg_real)n;
  if (covering == 0) return 1;
  return covering == 1 ? 1 + place : 2 - place * place;
}

/* Fills the tableau of the problem with a covering vector; w is basic. */
static void mg_tableau_fill(mg_tableau *t, const mg_real *A, const mg_real *b, int covering) {
  int n = t->n;
  for (int i = 0; i < n; ++i) {
    mg_real *row = t->T + i * t->width;
    for (int j = 0; j < n; ++j) {
      row[j] = i == j;
      row[n + j] = -A[i + j * n];
    }
    row[2 * n] = -mg_covering_vector(covering, n, i);
    row[2 * n + 1] = b[i];
    t->basis[i] = i;
  }
}

/* Exchanges the basic variable of row `leaving` for column `entering`. */
static void mg_tableau_pivot(mg_tableau *t, int leaving, int entering) {
  mg_real *pivot_row = t->T + leaving * t->width, reciprocal = 1 / pivot_row[entering];
  for (int j = 0; j < t->width; ++j) pivot_row[j] *= reciprocal;
  for (int i = 0; i < t->n; ++i) {
    mg_real *row = t->T + i * t->width, factor = row[entering];
    if (i == leaving || !(fabs(factor) > 0)) continue;
    for (int j = 0; j < t->width; ++j) row[j] -= factor * pivot_row[j];
    row[entering] = 0;
  }
  t->basis[leaving] = entering;
}

/* Row of least b_i / h_i, the last of equals: every other row is then lexicographically positive. */
static int mg_first_pivot_row(const mg_tableau *t) {
  int n = t->n, best = 0;
  for (int i = 1; i < n; ++i) {
    const mg_real *row = t->T + i * t->width, *least = t->T + best * t->width;
    if (row[2 * n + 1] / -row[2 * n] <= least[2 * n + 1] / -least[2 * n]) best = i;
  }
  return best;
}

/* Negative, 0 or positive as the ratio of row a is below, equal to or above that of row b in `column`. */
static int mg_compare_ratios(const mg_tableau *t, int a, int b, int entering, int column) {
  const mg_real *p = t->T + a * t->width, *q = t->T + b * t->width;
  mg_real x = p[column] / p[entering], y = q[column] / q[entering];
  mg_real size = (mg_real)fabs(x) + (mg_real)fabs(y);
  if (fabs(x - y) <= 16 * (mg_real)t->n * MG_EPS * (size > 1 ? size : 1)) return 0;
  return x < y ? -1 : 1;
}

/* Compares rows a and b in the lexicographic ratio test; z0 leaves before others. */
static int mg_compare_lexicographic(const mg_tableau *t, int a, int b, int entering) {
  int order = mg_compare_ratios(t, a, b, entering, 2 * t->n + 1);
  if (order == 0 && t->basis[a] == 2 * t->n) return -1;
  if (order == 0 && t->basis[b] == 2 * t->n) return 1;
  for (int j = 0; j < t->n && order == 0; ++j) order = mg_compare_ratios(t, a, b, entering, j);
  return order;
}

/* Row that leaves the basis, or -1 on a ray. */
static int mg_ratio_test(const mg_tableau *t, int entering) {
  int best = -1;
  for (int i = 0; i < t->n; ++i) {
    if (!(t->T[i * t->width + entering] > MG_LCP_RANK(1))) continue;
    if (best < 0 || mg_compare_lexicographic(t, i, best, entering) < 0) best = i;
  }
  return best;
}

/* Follows one path for at most `limit` pivots. Returns MG_LCP_SOLVED, MG_LCP_RAY or MG_LCP_ITERATIONS. */
static int mg_lemke_path(mg_tableau *t, int limit, int *pivots) {
  int n = t->n, row = mg_first_pivot_row(t), entering, leaving = t->basis[row];
  mg_tableau_pivot(t, row, 2 * n);
  for (*pivots = 1; leaving != 2 * n; ++*pivots) {
    if (*pivots >= limit) return MG_LCP_ITERATIONS;
    entering = leaving < n ? leaving + n : leaving - n;
    row = mg_ratio_test(t, entering);
    if (row < 0) return MG_LCP_RAY;
    leaving = t->basis[row];
    mg_tableau_pivot(t, row, entering);
  }
  return MG_LCP_SOLVED;
}

/* Candidate of the last basis: from the data if the basis is regular, else from the tableau. */
static void mg_lemke_candidate(const mg_tableau *t, const mg_real *A, const mg_real *b, const mg_real *column,
                               mg_real *candidate, mg_real *work, int *iwork) {
  int n = t->n, *active = iwork;
  for (int i = 0; i < n; ++i) active[i] = 0;
  for (int i = 0; i < n; ++i)
    if (t->basis[i] >= n) active[t->basis[i] - n] = 1;
  if (!(mg_basis_solve(n, A, b, active, candidate, work, iwork + n) > 0))
    for (int i = 0; i < n; ++i)
      if (t->basis[i] >= n) candidate[t->basis[i] - n] = t->T[i * t->width + 2 * n + 1];
  for (int i = 0; i < n; ++i) candidate[i] = candidate[i] > 0 ? candidate[i] * column[i] : 0;
}

MG_API int mg_lemke(int n, const mg_real *A, const mg_real *b, int max_iterations, mg_real *z, mg_lcp_report *report,
                    mg_real *work, int *iwork) {
  mg_real *S = work, *c = S + n * n, *row = c + n, *column = row + n, *candidate = column + n;
  mg_tableau t = {n, 2 * n + 2, candidate + n, iwork};
  int short_limit = MG_LEMKE_SHORT_PATH * n < max_iterations ? MG_LEMKE_SHORT_PATH * n : max_iterations;
  int outcome = MG_LCP_RAY;
  int ended[MG_LEMKE_COVERS] = {MG_LCP_ITERATIONS, MG_LCP_ITERATIONS, MG_LCP_ITERATIONS};
  if (mg_lcp_start(n, A, b, z, report)) return report->outcome;
  for (int i = 0; i < n * n; ++i) S[i] = A[i];
  for (int i = 0; i < n; ++i) c[i] = b[i];
  mg_equilibrate(n, S, c, row, column);
  report->rank = n;
  for (int path = 0; path < 2 * MG_LEMKE_COVERS; ++path) {
    int pivots = 0, covering = path % MG_LEMKE_COVERS;
    if (ended[covering] != MG_LCP_ITERATIONS) continue;
    mg_tableau_fill(&t, S, c, covering);
    ended[covering] = mg_lemke_path(&t, path < MG_LEMKE_COVERS ? short_limit : max_iterations, &pivots);
    report->iterations += pivots;
    if (ended[covering] == MG_LCP_SOLVED) {
      mg_lemke_candidate(&t, S, c, column, candidate, t.T + n * t.width, iwork + n);
      if (mg_lcp_certify(n, A, b, candidate, z, report)) return report->outcome;
    }
  }
  for (int covering = 0; covering < MG_LEMKE_COVERS; ++covering)
    if (ended[covering] != MG_LCP_RAY) outcome = MG_LCP_ITERATIONS;
  return mg_lcp_report_failure(n, A, b, z, outcome, report);
}
