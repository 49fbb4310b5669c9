/* Linear systems over rows whose matrix slip makes unsymmetric: by a QR factorisation in the scale of the rows, of
   least norm where the matrix is singular; over many rows, where it differs from a regular symmetric matrix in few
   columns, by the Woodbury formula. Writes its arguments and the complementarity workspace. */
#include "forces/forces.h"
#include "base/base.h"
#include "model/model.h"
#include "solve/lcp/lcp_solvers.h"

/* Factors A over listed rows, scaled by the square roots d of the diagonal of J M^-1 J^T, and scales y = -b; returns
   the rank. */
static int mg_factor_scaled_rows(mg_context *c, const int *list, int n, const mg_real *A, int stride, const mg_real *b,
                                 mg_real *R, mg_real *y, mg_real *d) {
  for (int i = 0; i < n; i++) d[i] = 1 / mg_diagonal_scale(mg_delassus_entry(c, list[i], list[i])), y[i] = -b[i] * d[i];
  for (int j = 0; j < n; j++)
    for (int i = 0; i < n; i++) R[i + n * j] = A[i + stride * j] * d[i] * d[j];
  return mg_factor_pivoted_qr(n, R, y, c->lcp.iwork, MG_LCP_RANK(n));
}

MG_INTERNAL mg_real mg_solve_least_norm_rows(mg_context *c, const int *list, int n, const mg_real *A, int stride,
                                             const mg_real *b, mg_real *z) {
  mg_real *R = c->lcp.work, *y = R + n * n, *d = y + n, *x = d + n, *beta = x + n;
  const int rank = mg_factor_scaled_rows(c, list, n, A, stride, b, R, y, d);
  const mg_real pivot = rank == n && n > 0 ? fabs(R[(long)n * n - 1]) : 0;
  mg_solve_least_norm_qr(n, rank, R, y, x, beta);
  for (int i = 0; i < n; i++) z[c->lcp.iwork[i]] = x[i] * d[c->lcp.iwork[i]];
  return pivot;
}

MG_INTERNAL int mg_unsymmetric_rank(mg_context *c, const int *list, int n) {
  mg_real *R = c->lcp.work, *y = R + n * n, *d = y + n;
  mg_count_factorisation(c, n);
  return mg_factor_scaled_rows(c, list, n, c->lcp.A, n, c->lcp.b, R, y, d);
}

enum { MG_FEW_ROWS = 24 }; /* rows up to which the orthogonal factorisation, which is more accurate, costs little */

/* Memory of the solution by changed columns, in c->lcp.work: each n by n. */
enum { MG_SYMMETRIC_PART, MG_SYMMETRIC_FACTOR, MG_COLUMN_CHANGES, MG_COLUMN_SYSTEM };

static mg_real *mg_column_memory(const mg_context *c, int part, int n) { return c->lcp.work + (long)part * n * n; }

MG_INTERNAL void mg_keep_symmetric_rows(mg_context *c, int n) {
  mg_real *S = mg_column_memory(c, MG_SYMMETRIC_PART, n);
  for (int k = 0; n > MG_FEW_ROWS && k < n * n; k++) S[k] = c->lcp.A[k];
  MG_NOTE_DIGEST(c, MG_VALID_SYMMETRIC, mg_kept_rows_digest(c, n > MG_FEW_ROWS ? n : 0));
}

/* Factors the symmetric part scaled by d. Returns the least pivot, or 0 if it is too near to singular. */
static mg_real mg_factor_symmetric_part(mg_context *c, int n, mg_real *d) {
  const mg_real *S = mg_column_memory(c, MG_SYMMETRIC_PART, n);
  mg_real *L = mg_column_memory(c, MG_SYMMETRIC_FACTOR, n);
  for (int i = 0; i < n; i++) d[i] = 1 / mg_diagonal_scale(S[i + n * i]);
  for (int j = 0; j < n; j++)
    for (int i = 0; i < n; i++) L[i + n * j] = S[i + n * j] * d[i] * d[j];
  const mg_real pivot = mg_cholesky(n, L);
  return pivot > MG_LCP_REGULAR ? pivot : 0;
}

/* Lists the columns in which the matrix differs from its symmetric part S, and writes S^-1 times the differences, all
   scaled by d. Returns their number. */
static int mg_list_changed_columns(mg_context *c, int n, const mg_real *d, int *column) {
  const mg_real *S = mg_column_memory(c, MG_SYMMETRIC_PART, n), *L = mg_column_memory(c, MG_SYMMETRIC_FACTOR, n);
  int k = 0;
  for (int j = 0; j < n; j++) {
    mg_real *change = mg_column_memory(c, MG_COLUMN_CHANGES, n) + (long)n * k, most = 0;
    for (int i = 0; i < n; i++) {
      change[i] = (c->lcp.A[i + n * j] - S[i + n * j]) * d[i] * d[j];
      if (fabs(change[i]) > most) most = fabs(change[i]);
    }
    if (most == 0) continue;
    mg_cholesky_solve(n, L, change);
    column[k++] = j;
  }
  return k;
}

/* x = A^-1 x in the scale of d: with y = S^-1 x, entries x_k of the changed columns are (1 + E^T S^-1 D)^-1 y_k. */
static void mg_solve_changed_columns(mg_context *c, int n, int k, const int *column, const int *swap, mg_real *x,
                                     mg_real *changed) {
  const mg_real *change = mg_column_memory(c, MG_COLUMN_CHANGES, n);
  mg_cholesky_solve(n, mg_column_memory(c, MG_SYMMETRIC_FACTOR, n), x);
  for (int r = 0; r < k; r++) changed[r] = x[column[r]];
  mg_lu_solve(k, mg_column_memory(c, MG_COLUMN_SYSTEM, n), swap, changed);
  for (int r = 0; r < k; r++)
    for (int i = 0; i < n; i++) x[i] -= change[i + (long)n * r] * changed[r];
}

/* Solves A z = -b where the symmetric part S that mg_keep_symmetric_rows has kept is regular and A = S + D E^T differs
   from it in few columns, by the Woodbury formula (Golub and Van Loan, Matrix Computations, section 2.1.4) with one
   step of iterative refinement. Returns the least pivot, or 0 if S or A is too near to singular. */
static mg_real mg_solve_by_changed_columns(mg_context *c, int n, mg_real *z) {
  mg_real *d = mg_column_memory(c, MG_COLUMN_SYSTEM + 1, n), *x = d + n, *changed = x + n;
  int *column = c->lcp.iwork, *swap = column + n;
  const mg_real of_symmetric = mg_factor_symmetric_part(c, n, d);
  if (!(of_symmetric > 0)) return 0;
  const int k = mg_list_changed_columns(c, n, d, column);
  const mg_real *change = mg_column_memory(c, MG_COLUMN_CHANGES, n);
  mg_real *system = mg_column_memory(c, MG_COLUMN_SYSTEM, n);
  for (int q = 0; q < k; q++)
    for (int r = 0; r < k; r++) system[r + k * q] = change[column[r] + (long)n * q] + (r == q);
  const mg_real of_changes = mg_lu(k, system, swap);
  if (!(of_changes > MG_LCP_DEFINITE)) return 0;
  for (int i = 0; i < n; i++) z[i] = 0;
  for (int pass = 0; pass < 2; pass++) {
    for (int i = 0; i < n; i++) x[i] = -c->lcp.b[i];
    for (int j = 0; j < n && pass; j++)
      for (int i = 0; i < n; i++) x[i] -= c->lcp.A[i + n * j] * z[j];
    for (int i = 0; i < n; i++) x[i] *= d[i];
    mg_solve_changed_columns(c, n, k, column, swap, x, changed);
    for (int i = 0; i < n; i++) z[i] += x[i] * d[i];
  }
  return of_symmetric * mg_min(of_changes, 1);
}

MG_INTERNAL mg_real mg_solve_unsymmetric_rows(mg_context *c, const int *list, int n, mg_real *z) {
  MG_NEEDS_DIGEST(c, MG_VALID_SYMMETRIC, mg_kept_rows_digest(c, n > MG_FEW_ROWS ? n : 0));
  const mg_real pivot = n > MG_FEW_ROWS ? mg_solve_by_changed_columns(c, n, z) : 0;
  return pivot > 0 ? pivot : mg_solve_least_norm_rows(c, list, n, c->lcp.A, n, c->lcp.b, z);
}
