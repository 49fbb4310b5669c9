/* LU factorisation of small dense matrices with row exchanges, elimination of several right-hand sides, and the
   solution of one complementary basis of a general matrix, scaled by rows and columns (Golub and Van Loan, Matrix
   Computations, section 3.4). */
#include "base/base.h"

/* Scales rows by the square root of their largest entry, then columns by their largest entry. */
static void mg_equilibrate_pass(int n, mg_real *A, mg_real *row, mg_real *column) {
  for (int i = 0; i < n; ++i) {
    mg_real largest = 0, factor;
    for (int j = 0; j < n; ++j)
      if (fabs(A[i + j * n]) > largest) largest = (mg_real)fabs(A[i + j * n]);
    factor = largest > 0 ? 1 / (mg_real)sqrt(largest) : (mg_real)1;
    row[i] *= factor;
    for (int j = 0; j < n; ++j) A[i + j * n] *= factor;
  }
  for (int j = 0; j < n; ++j) {
    mg_real largest = mg_max_abs(n, A + j * n), factor;
    factor = largest > 0 ? 1 / largest : (mg_real)1;
    column[j] *= factor;
    for (int i = 0; i < n; ++i) A[i + j * n] *= factor;
  }
}

MG_INTERNAL void mg_equilibrate(int n, mg_real *A, mg_real *b, mg_real *row, mg_real *column) {
  mg_real scale;
  for (int i = 0; i < n; ++i) row[i] = column[i] = 1;
  for (int pass = 0; pass < 3; ++pass) mg_equilibrate_pass(n, A, row, column);
  for (int i = 0; i < n; ++i) b[i] *= row[i];
  scale = mg_max_abs(n, b);
  for (int i = 0; i < n; ++i) {
    b[i] /= scale;
    column[i] *= scale;
  }
}

MG_INTERNAL mg_real mg_lu(int k, mg_real *U, int *swap) {
  mg_real smallest = 1;
  for (int j = 0; j < k; ++j) {
    int p = j;
    for (int i = j + 1; i < k; ++i)
      if (fabs(U[i + j * k]) > fabs(U[p + j * k])) p = i;
    swap[j] = p;
    if (!(fabs(U[p + j * k]) > (mg_real)k * MG_EPS)) return 0;
    if (fabs(U[p + j * k]) < smallest) smallest = (mg_real)fabs(U[p + j * k]);
    for (int c = 0; c < k && p != j; ++c) {
      mg_real value = U[p + c * k];
      U[p + c * k] = U[j + c * k];
      U[j + c * k] = value;
    }
    for (int i = j + 1; i < k; ++i) U[i + j * k] /= U[j + j * k];
    for (int c = j + 1; c < k; ++c)
      for (int i = j + 1; i < k; ++i) U[i + c * k] -= U[i + j * k] * U[j + c * k];
  }
  return smallest;
}

MG_INTERNAL void mg_lu_solve(int k, const mg_real *U, const int *swap, mg_real *x) {
  for (int j = 0; j < k; ++j) {
    mg_real value = x[swap[j]];
    x[swap[j]] = x[j];
    x[j] = value;
  }
  for (int j = 0; j < k; ++j)
    for (int i = j + 1; i < k; ++i) x[i] -= U[i + j * k] * x[j];
  for (int j = k - 1; j >= 0; --j) {
    x[j] /= U[j + j * k];
    for (int i = 0; i < j; ++i) x[i] -= U[i + j * k] * x[j];
  }
}

MG_INTERNAL int mg_solve_columns(int k, int width, mg_real *AB) {
  for (int j = 0; j < k; ++j) {
    mg_real *pivot = AB + j * width;
    int p = j;
    for (int i = j + 1; i < k; ++i)
      if (fabs(AB[i * width + j]) > fabs(AB[p * width + j])) p = i;
    if (!(fabs(AB[p * width + j]) > (mg_real)k * MG_EPS)) return 0;
    for (int c = j; c < width && p != j; ++c) {
      const mg_real value = AB[p * width + c];
      AB[p * width + c] = pivot[c];
      pivot[c] = value;
    }
    const mg_real inverse = 1 / pivot[j];
    for (int c = j + 1; c < width; ++c) pivot[c] *= inverse;
    for (int i = 0; i < k; ++i) {
      mg_real *row = AB + i * width;
      const mg_real factor = row[j];
      for (int c = j + 1; c < width && i != j; ++c) row[c] -= factor * pivot[c];
    }
  }
  return 1;
}

MG_INTERNAL mg_real mg_basis_solve(int n, const mg_real *A, const mg_real *b, const int *active, mg_real *z,
                                   mg_real *work, int *iwork) {
  int *index = iwork, *swap = iwork + n, k = 0;
  mg_real *U = work, *residual = work + n * n, pivot;
  for (int i = 0; i < n; ++i) {
    z[i] = 0;
    if (active[i]) index[k++] = i;
  }
  for (int j = 0; j < k; ++j)
    for (int i = 0; i < k; ++i) U[i + j * k] = A[index[i] + index[j] * n];
  pivot = mg_lu(k, U, swap);
  for (int pass = 0; pass < 2 && pivot > 0; ++pass) {
    for (int i = 0; i < k; ++i) residual[i] = -b[index[i]];
    for (int j = 0; j < k; ++j)
      for (int i = 0; i < k; ++i) residual[i] -= A[index[i] + index[j] * n] * z[index[j]];
    mg_lu_solve(k, U, swap, residual);
    for (int i = 0; i < k; ++i) z[index[i]] += residual[i];
  }
  return pivot;
}
