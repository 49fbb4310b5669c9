/* Enumeration of all complementary cones of a general matrix (Cottle, Pang and Stone, section 1.3): is -b a
   nonnegative combination of the columns A_j (j in B) and -e_j (j not in B)? A regular basis has one solution, whose
   signs decide. For a singular one the nearest point of its cone to -b is found by a convex QP: its remainder r is
   0, or separates -b from the cone, r'b > 0 and C'r >= 0.

   INFEASIBLE is returned only if each of the 2^n cones was excluded beyond rounding; RAY if one could be neither
   excluded nor used. This proof is one of floating-point arithmetic: a problem that becomes solvable by a change of
   the data within rounding may be called infeasible. */
#include "solve/lcp/lcp_solvers.h"
#include "base/base.h"

enum { MG_ENUMERATE_MAX = 20 }; /* largest size */

/* Result of the test of a cone. */
enum {
  MG_CONE_EXCLUDED = 0,  /* -b is not in it */
  MG_CONE_CANDIDATE = 1, /* x is a candidate for the solution */
  MG_CONE_UNDECIDED = 2  /* neither */
};

typedef struct {
  int n;
  mg_real *S, *c, *column;        /* the equilibrated problem */
  mg_real *G, *h, *x, *remainder; /* normal equations of a cone, and the nearest point */
  mg_real *work;
  int *active, *support, *iwork;
  mg_real distance; /* a cone is out when -c is farther from it than this */
} mg_cones;

/* Entry i of generator j of the cone. */
static mg_real mg_cone_entry(const mg_cones *e, int i, int j) {
  if (e->active[j]) return e->S[i + j * e->n];
  return i == j ? (mg_real)-1 : (mg_real)0;
}

/* G = C'C and h = C'c for the generators C of the cone. */
static void mg_cone_normal_equations(mg_cones *e) {
  int n = e->n;
  for (int j = 0; j < n; ++j) {
    e->h[j] = 0;
    for (int i = 0; i < n; ++i) e->h[j] += mg_cone_entry(e, i, j) * e->c[i];
    for (int i = 0; i <= j; ++i) {
      mg_real sum = 0;
      for (int m = 0; m < n; ++m) sum += mg_cone_entry(e, m, i) * mg_cone_entry(e, m, j);
      e->G[i + j * n] = e->G[j + i * n] = sum;
    }
  }
}

/* Nearest point of the cone to -c; leaves it in x. Returns MG_CONE_EXCLUDED, MG_CONE_CANDIDATE or
   MG_CONE_UNDECIDED. */
static int mg_test_singular_cone(mg_cones *e) {
  int n = e->n;
  mg_lcp_report nearest;
  mg_real distance;
  mg_cone_normal_equations(e);
  for (int i = 0; i < n; ++i) e->support[i] = 0;
  mg_qp(n, e->G, e->h, 10 * n + 50, e->x, e->support, &nearest, e->work, e->iwork);
  if (nearest.outcome != MG_LCP_SOLVED) return MG_CONE_UNDECIDED;
  for (int i = 0; i < n; ++i) {
    e->remainder[i] = e->c[i];
    for (int j = 0; j < n; ++j) e->remainder[i] += mg_cone_entry(e, i, j) * e->x[j];
  }
  distance = mg_max_abs(n, e->remainder);
  for (int i = 0; i < n; ++i)
    if (!e->active[i]) e->x[i] = 0;
  return distance > e->distance ? MG_CONE_EXCLUDED : MG_CONE_CANDIDATE;
}

/* Tests the cone of the active set; leaves the candidate in x, nonnegative and scaled. Returns MG_CONE_EXCLUDED,
   MG_CONE_CANDIDATE or MG_CONE_UNDECIDED. */
static int mg_test_cone(mg_cones *e) {
  int n = e->n;
  mg_real pivot = mg_basis_solve(n, e->S, e->c, e->active, e->x, e->work, e->iwork), y;
  if (pivot <= (mg_real)sqrt(MG_EPS)) return mg_test_singular_cone(e);
  y = mg_max_abs(n, e->x);
  for (int i = 0; i < n; ++i) {
    mg_real slack = e->active[i] ? e->x[i] : e->c[i];
    for (int j = 0; j < n && !e->active[i]; ++j) slack += e->S[i + j * n] * e->x[j];
    if (slack < -e->distance * (y > 1 ? y : 1) / pivot) return MG_CONE_EXCLUDED;
  }
  for (int i = 0; i < n; ++i) e->x[i] = e->x[i] > 0 ? e->x[i] : 0;
  return MG_CONE_CANDIDATE;
}

/* Divides the memory and scales the problem. */
static void mg_open_cones(mg_cones *e, int n, const mg_real *A, const mg_real *b, mg_real *work, int *iwork) {
  e->n = n;
  e->S = work;
  e->G = e->S + n * n;
  e->c = e->G + n * n;
  e->column = e->c + n;
  e->h = e->column + n;
  e->x = e->h + n;
  e->remainder = e->x + n;
  e->work = e->remainder + n;
  e->active = iwork;
  e->support = iwork + n;
  e->iwork = iwork + 2 * n;
  e->distance = (mg_real)10 * (mg_real)n * MG_EPS;
  for (int i = 0; i < n * n; ++i) e->S[i] = A[i];
  for (int i = 0; i < n; ++i) e->c[i] = b[i];
  mg_equilibrate(n, e->S, e->c, e->remainder, e->column);
}

MG_API int mg_enumerate(int n, const mg_real *A, const mg_real *b, mg_real *z, mg_lcp_report *report, mg_real *work,
                        int *iwork) {
  mg_cones e;
  int is_undecided = 0;
  if (mg_lcp_start(n, A, b, z, report)) return report->outcome;
  report->rank = n;
  if (n > MG_ENUMERATE_MAX) return mg_lcp_report_failure(n, A, b, z, MG_LCP_ITERATIONS, report);
  mg_open_cones(&e, n, A, b, work, iwork);
  for (int set = 0; set < 1 << n; ++set) {
    int verdict;
    for (int i = 0; i < n; ++i) e.active[i] = set >> i & 1;
    verdict = mg_test_cone(&e);
    ++report->iterations;
    for (int i = 0; i < n; ++i) e.h[i] = e.x[i] * e.column[i];
    if (verdict == MG_CONE_CANDIDATE && mg_lcp_certify(n, A, b, e.h, z, report)) return report->outcome;
    is_undecided |= verdict != MG_CONE_EXCLUDED;
  }
  return mg_lcp_report_failure(n, A, b, z, is_undecided ? MG_LCP_RAY : MG_LCP_INFEASIBLE, report);
}
