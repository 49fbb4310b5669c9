/* Cholesky factorisation of small dense symmetric positive semidefinite matrices, column-major, in place: plain, and
   with diagonal pivoting (Golub and Van Loan, Matrix Computations, section 4.2); and L D L^T of definite ones
   (section 4.1). */
#include "base/base.h"

MG_INTERNAL mg_real mg_cholesky(int k, mg_real *L) {
  mg_real smallest = MG_MAX;
  for (int j = 0; j < k; ++j) {
    mg_real *column = L + j * k, pivot = column[j], reciprocal;
    if (!(pivot > MG_LCP_TIKHONOV)) pivot = MG_LCP_TIKHONOV;
    if (pivot < smallest) smallest = pivot;
    reciprocal = 1 / (mg_real)sqrt(pivot);
    column[j] = reciprocal;
    for (int i = j + 1; i < k; ++i) column[i] *= reciprocal;
    for (int c = j + 1; c < k; ++c) {
      const mg_real factor = column[c];
      if (factor != 0) mg_add_scaled(k - c, -factor, column + c, L + c * k + c);
    }
  }
  return smallest;
}

MG_INTERNAL void mg_cholesky_solve(int k, const mg_real *L, mg_real *x) {
  for (int j = 0; j < k; ++j) {
    const mg_real *column = L + j * k;
    mg_real value = x[j] *= column[j];
    for (int i = j + 1; i < k; ++i) x[i] -= value * column[i];
  }
  for (int j = k - 1; j >= 0; --j) {
    const mg_real *column = L + j * k;
    mg_real value = x[j];
    for (int i = j + 1; i < k; ++i) value -= column[i] * x[i];
    x[j] = value * column[j];
  }
}

/* Solves A z = -b for three unknowns; see mg_solve_definite. */
static int mg_solve_definite_three(const mg_real *A, const mg_real *b, mg_real *z) {
  const mg_real r0 = 1 / A[0], l10 = A[1] * r0, l20 = A[2] * r0;
  const mg_real p1 = A[4] - l10 * A[1], c21 = A[5] - l20 * A[1], r1 = 1 / p1, l21 = c21 * r1;
  const mg_real p2 = A[8] - l20 * A[2] - l21 * c21;
  if (!(A[0] > 0 && p1 > MG_LCP_DEFINITE * A[4] && p2 > MG_LCP_DEFINITE * A[8])) return 0;
  const mg_real y1 = b[1] - l10 * b[0], y2 = b[2] - l20 * b[0] - l21 * y1;
  z[2] = -y2 / p2;
  z[1] = -y1 * r1 - l21 * z[2];
  z[0] = -b[0] * r0 - l10 * z[1] - l20 * z[2];
  return 1;
}

MG_INTERNAL int mg_solve_definite(int n, const mg_real *A, const mg_real *b, mg_real *z) {
  mg_real L[MG_DEFINITE_MAX * MG_DEFINITE_MAX], reciprocal[MG_DEFINITE_MAX], scaled[MG_DEFINITE_MAX];
  if (n == 3) return mg_solve_definite_three(A, b, z);
  for (int j = 0; j < n; ++j) { /* row j of L, with D times it in scaled */
    mg_real *row = L + j * n, pivot = A[j + j * n];
    for (int i = 0; i < j; ++i) {
      mg_real sum = A[j + i * n];
      for (int k = 0; k < i; ++k) sum -= L[i * n + k] * scaled[k];
      scaled[i] = sum;
      row[i] = sum * reciprocal[i];
      pivot -= row[i] * sum;
    }
    if (!(A[j + j * n] > 0 && pivot > MG_LCP_DEFINITE * A[j + j * n])) return 0;
    reciprocal[j] = 1 / pivot;
  }
  for (int j = 0; j < n; ++j) {
    mg_real sum = -b[j];
    for (int k = 0; k < j; ++k) sum -= L[j * n + k] * z[k];
    z[j] = sum;
  }
  for (int j = n - 1; j >= 0; --j) {
    mg_real sum = z[j] * reciprocal[j];
    for (int k = j + 1; k < n; ++k) sum -= L[k * n + j] * z[k];
    z[j] = sum;
  }
  return 1;
}

/* Exchanges rows and columns a and b of a symmetric matrix of which the columns before `from` are factored, and
   their labels in `order`. */
static void mg_swap_rows_and_columns(int k, mg_real *L, int *order, int from, int a, int b) {
  int label = order[a];
  if (a == b) return;
  order[a] = order[b];
  order[b] = label;
  for (int c = 0; c < k; ++c) {
    mg_real value = L[a + c * k];
    L[a + c * k] = L[b + c * k];
    L[b + c * k] = value;
  }
  for (int r = from; r < k; ++r) {
    mg_real value = L[r + a * k];
    L[r + a * k] = L[r + b * k];
    L[r + b * k] = value;
  }
}

/* Row from j on with the largest pivot of those whose pivot does not count as zero, or -1. */
static int mg_largest_pivot(int k, const mg_real *L, const int *order, int j, mg_real floor, const mg_real *floors) {
  int largest = -1;
  for (int i = j; i < k; ++i)
    if (L[i + i * k] > (floors ? floors[order[i]] : floor) && (largest < 0 || L[i + i * k] > L[largest + largest * k]))
      largest = i;
  return largest;
}

MG_INTERNAL int mg_cholesky_pivoted(int k, mg_real *L, int *order, mg_real floor, const mg_real *floors) {
  for (int j = 0; j < k; ++j) order[j] = j;
  for (int j = 0; j < k; ++j) {
    mg_real *column = L + j * k, reciprocal;
    const int largest = mg_largest_pivot(k, L, order, j, floor, floors);
    if (largest < 0) return j;
    mg_swap_rows_and_columns(k, L, order, j, j, largest);
    reciprocal = 1 / (mg_real)sqrt(column[j]);
    for (int i = j; i < k; ++i) column[i] *= reciprocal;
    for (int c = j + 1; c < k; ++c) mg_add_scaled(k - j - 1, -column[c], column + j + 1, L + c * k + j + 1);
  }
  return k;
}
