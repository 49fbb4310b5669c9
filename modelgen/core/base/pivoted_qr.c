/* Linear systems that may be unsymmetric and singular: A P = Q R by Householder reflections with column pivoting
   (Golub and Van Loan, Matrix Computations, 2013, algorithms 5.4.1 and 5.4.2); least norm where the rank is not
   full. */
#include "base/base.h"

/* Compute the reflection 1 - beta (1, v)(1, v)^T that takes (head, tail) to its head; leaves v in the tail and
   returns beta. */
static mg_real mg_make_householder_reflector(mg_real *head, int n, mg_real *tail, int step) {
  mg_real sum = 0;
  for (int i = 0; i < n; i++) sum += tail[i * step] * tail[i * step];
  if (sum == 0) return 0;
  const mg_real size = sqrt(*head * *head + sum), first = *head > 0 ? -size : size, v = *head - first;
  for (int i = 0; i < n; i++) tail[i * step] /= v;
  *head = first;
  return -v / first;
}

/* Apply a Householder reflection to one vector (head, tail). */
static void mg_apply_householder_reflector(mg_real beta, int n, const mg_real *v, int step, mg_real *head,
                                           mg_real *tail, int stride) {
  mg_real sum = *head;
  for (int i = 0; i < n; i++) sum += v[i * step] * tail[i * stride];
  sum *= beta;
  *head -= sum;
  for (int i = 0; i < n; i++) tail[i * stride] -= sum * v[i * step];
}

/* Swap columns a and b of A and their entries in the order. */
static void mg_swap_columns(int n, mg_real *A, int *order, int a, int b) {
  const int kept = order[a];
  order[a] = order[b], order[b] = kept;
  for (int i = 0; i < n; i++) {
    const mg_real value = A[i + n * a];
    A[i + n * a] = A[i + n * b], A[i + n * b] = value;
  }
}

/* Column from j on with the largest norm below row j, and that norm. */
static int mg_find_pivot_column(int n, const mg_real *A, int j, mg_real *size) {
  int best = j;
  *size = -1;
  for (int k = j; k < n; k++) {
    mg_real sum = 0;
    for (int i = j; i < n; i++) sum += A[i + n * k] * A[i + n * k];
    if (sqrt(sum) > *size) *size = sqrt(sum), best = k;
  }
  return best;
}

MG_INTERNAL int mg_factor_pivoted_qr(int n, mg_real *A, mg_real *y, int *order, mg_real floor) {
  for (int j = 0; j < n; j++) order[j] = j;
  for (int j = 0; j < n; j++) {
    mg_real size, *pivot = A + j + n * j;
    const int best = mg_find_pivot_column(n, A, j, &size);
    if (!(size > floor)) return j;
    mg_swap_columns(n, A, order, j, best);
    const int below = n - j - 1;
    const mg_real beta = mg_make_householder_reflector(pivot, below, pivot + 1, 1);
    for (int k = j + 1; k < n; k++)
      mg_apply_householder_reflector(beta, below, pivot + 1, 1, A + j + n * k, A + j + 1 + n * k, 1);
    mg_apply_householder_reflector(beta, below, pivot + 1, 1, y + j, y + j + 1, 1);
  }
  return n;
}

MG_INTERNAL void mg_solve_least_norm_qr(int n, int rank, mg_real *R, const mg_real *y, mg_real *z, mg_real *beta) {
  const int spacing = n - rank;
  mg_real *beyond = R + n * rank;
  for (int i = rank - 1; i >= 0; i--) {
    beta[i] = mg_make_householder_reflector(R + i + n * i, spacing, beyond + i, n);
    for (int k = 0; k < i; k++)
      mg_apply_householder_reflector(beta[i], spacing, beyond + i, n, R + k + n * i, beyond + k, n);
  }
  for (int i = 0; i < n; i++) z[i] = i < rank ? y[i] : 0;
  for (int i = rank - 1; i >= 0; i--) {
    for (int k = i + 1; k < rank; k++) z[i] -= R[i + n * k] * z[k];
    z[i] /= R[i + n * i];
  }
  for (int i = 0; i < rank; i++) mg_apply_householder_reflector(beta[i], spacing, beyond + i, n, z + i, z + rank, 1);
}
