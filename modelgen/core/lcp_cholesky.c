/* Cholesky factors of small dense matrices, column-major, in place: plain, and with diagonal pivoting. */
#include "lcp_scaled.h"

/* The lower triangle of L becomes the factor, with the reciprocals of its diagonal. Returns the smallest
   pivot; a pivot below the Tikhonov term is replaced by it. */
MG_INTERNAL mg_real mg_cholesky(int k, mg_real *L)
{
  mg_real smallest = MG_MAX;
  for (int j = 0; j < k; ++j) {
    mg_real *column = L + j * k, pivot = column[j], reciprocal;
    if (!(pivot > MG_LCP_TIKHONOV)) pivot = MG_LCP_TIKHONOV;
    if (pivot < smallest) smallest = pivot;
    reciprocal = 1 / (mg_real)sqrt(pivot);
    column[j] = reciprocal;
    for (int i = j + 1; i < k; ++i) column[i] *= reciprocal;
    for (int c = j + 1; c < k; ++c) {
      mg_real factor = column[c], *target = L + c * k;
      for (int i = c; i < k; ++i) target[i] -= factor * column[i];
    }
  }
  return smallest;
}

MG_INTERNAL void mg_cholesky_solve(int k, const mg_real *L, mg_real *x)
{
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

static void mg_symmetric_swap(int k, mg_real *L, int *order, int from, int a, int b)
{
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

/* L, full and symmetric on entry, becomes the lower trapezoid of P' S P, k by rank; returns the rank: the
   number of pivots above `tolerance`. Row i of the factor belongs to row order[i] of S. */
MG_INTERNAL int mg_cholesky_pivoted(int k, mg_real *L, int *order, mg_real tolerance)
{
  for (int j = 0; j < k; ++j) order[j] = j;
  for (int j = 0; j < k; ++j) {
    mg_real *column = L + j * k, reciprocal;
    int largest = j;
    for (int i = j + 1; i < k; ++i)
      if (L[i + i * k] > L[largest + largest * k]) largest = i;
    if (!(L[largest + largest * k] > tolerance)) return j;
    mg_symmetric_swap(k, L, order, j, j, largest);
    reciprocal = 1 / (mg_real)sqrt(column[j]);
    for (int i = j; i < k; ++i) column[i] *= reciprocal;
    for (int c = j + 1; c < k; ++c)
      for (int i = j + 1; i < k; ++i) L[i + c * k] -= column[c] * column[i];
  }
  return k;
}
