/* Forces on a known active set of a linear complementarity problem: A_BB z_B = -b_B, of least norm where the rows
   of the active set are dependent. */
#include "solve/lcp/lcp_solvers.h"
#include "base/base.h"

MG_API long long mg_lcp_work_size(int n) { return 8LL * n * n + 24LL * n + 16; }

MG_API long long mg_lcp_iwork_size(int n) { return 8LL * n + 8; }

/* Solution of a z = -b; 0 if a is not positive. Returns the rank. */
static int mg_active_one(mg_real a, mg_real b, mg_real *z) {
  *z = a > 0 ? -b / a : (mg_real)0;
  return a > 0;
}

/* True if all n entries are set. */
static int mg_are_all_active(int n, const int *active) {
  for (int i = 0; i < n; ++i)
    if (!active[i]) return 0;
  return 1;
}

/* The same for two unknowns with positive diagonal. */
static int mg_active_two(const mg_real *A, const mg_real *b, mg_real *z, mg_real *pivot) {
  mg_real d0 = (mg_real)sqrt(A[0]), d1 = (mg_real)sqrt(A[3]), c[2];
  int rank;
  c[0] = b[0] / d0;
  c[1] = b[1] / d1;
  rank = mg_minimum_norm_two(A[1] / d0 / d1, c, z);
  *pivot = (A[0] * A[3] - A[1] * A[1]) / A[0] / A[3];
  z[0] /= d0;
  z[1] /= d1;
  return rank;
}

/* The same for the k unknowns of `index`, scaled to unit diagonal. */
static int mg_active_gather(int n, const mg_real *A, const mg_real *b, const int *active, const int *index, int k,
                            mg_real floor, mg_real *z, mg_real *work, int *order, mg_real *pivot) {
  mg_real *S = work, *c = S + k * k, *reciprocal = c + k, *y = reciprocal + k, *floors = y + k;
  int rank;
  for (int i = 0; i < k; ++i) {
    floors[i] = floor > 0 && active[index[i]] != MG_ACTIVE_ABOVE_ROUNDING ? floor : MG_LCP_RANK(k);
    reciprocal[i] = 1 / mg_diagonal_scale(A[index[i] + index[i] * n]);
    c[i] = b[index[i]] * reciprocal[i];
  }
  for (int j = 0; j < k; ++j) {
    const mg_real *column = A + index[j] * n;
    for (int i = 0; i < k; ++i) S[i + j * k] = column[index[i]] * reciprocal[i] * reciprocal[j];
    if (A[index[j] + index[j] * n] > 0) S[j + j * k] = 1;
  }
  rank = mg_minimum_norm_above(k, S, c, 0, floors, y, floors + k, order, pivot);
  for (int i = 0; i < k; ++i) z[index[i]] = y[i] * reciprocal[i];
  return rank;
}

MG_INTERNAL int mg_active_above(int n, const mg_real *A, const mg_real *b, const int *active, mg_real floor, mg_real *z,
                                mg_real *work, int *iwork, mg_real *pivot) {
  int k = 0;
  *pivot = 1;
  if (n == 1 && active[0]) return mg_active_one(A[0], b[0], z);
  if (n <= MG_DEFINITE_MAX && mg_are_all_active(n, active) && mg_solve_definite(n, A, b, z)) {
    *pivot = MG_LCP_DEFINITE;
    return n;
  }
  if (n == 2 && active[0] && active[1] && A[0] > 0 && A[3] > 0) return mg_active_two(A, b, z, pivot);
  for (int i = 0; i < n; ++i) {
    z[i] = 0;
    if (active[i]) iwork[k++] = i;
  }
  if (k == 0) return 0;
  if (k == 1) return mg_active_one(A[iwork[0] + iwork[0] * n], b[iwork[0]], z + iwork[0]);
  return mg_active_gather(n, A, b, active, iwork, k, floor, z, work, iwork + n, pivot);
}

MG_API int mg_active_solve(int n, const mg_real *A, const mg_real *b, const int *active, mg_real *z, mg_real *work,
                           int *iwork) {
  mg_real pivot;
  return mg_active_above(n, A, b, active, 0, z, work, iwork, &pivot);
}
