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

/* Sum of squares. */
static mg_real mg_sum_of_squares(int n, const mg_real *x) {
  mg_real sum = 0;
  for (int i = 0; i < n; i++) sum += x[i] * x[i];
  return sum;
}

enum { MG_COLUMNS = 4 }; /* that are reflected at a time, so that no sum waits for another one */

/* Applies a Householder reflection to MG_COLUMNS columns (head, tail); writes the sums of squares of their tails. */
static void mg_reflect_columns(mg_real beta, int n, const mg_real *v, mg_real *head, int stride, mg_real *squares) {
  mg_real *a = head + 1, *b = a + stride, *c = b + stride, *d = c + stride;
  mg_real of_a = a[-1], of_b = b[-1], of_c = c[-1], of_d = d[-1];
  for (int i = 0; i < n; i++) of_a += v[i] * a[i], of_b += v[i] * b[i], of_c += v[i] * c[i], of_d += v[i] * d[i];
  of_a *= beta, of_b *= beta, of_c *= beta, of_d *= beta;
  a[-1] -= of_a, b[-1] -= of_b, c[-1] -= of_c, d[-1] -= of_d;
  squares[0] = squares[1] = squares[2] = squares[3] = 0;
  for (int i = 0; i < n; i++) {
    a[i] -= of_a * v[i], b[i] -= of_b * v[i], c[i] -= of_c * v[i], d[i] -= of_d * v[i];
    squares[0] += a[i] * a[i], squares[1] += b[i] * b[i], squares[2] += c[i] * c[i], squares[3] += d[i] * d[i];
  }
}

/* Applies the reflection that takes column j to its head to the columns after it. Returns the column of these with the
   largest norm below row j, and that norm. */
static int mg_reflect_later_columns(mg_real beta, int n, mg_real *A, int j, mg_real *size) {
  const int below = n - j - 1;
  const mg_real *v = A + j + 1 + n * j;
  mg_real squares[MG_COLUMNS];
  int best = j + 1;
  *size = -1;
  for (int k = j + 1; k < n; k += MG_COLUMNS) {
    const int count = n - k < MG_COLUMNS ? n - k : MG_COLUMNS;
    if (count == MG_COLUMNS) mg_reflect_columns(beta, below, v, A + j + n * k, n, squares);
    for (int r = 0; r < count && count < MG_COLUMNS; r++) {
      mg_real *head = A + j + n * (k + r);
      mg_apply_householder_reflector(beta, below, v, 1, head, head + 1, 1);
      squares[r] = mg_sum_of_squares(below, head + 1);
    }
    for (int r = 0; r < count; r++)
      if (sqrt(squares[r]) > *size) *size = sqrt(squares[r]), best = k + r;
  }
  return best;
}

MG_INTERNAL int mg_factor_pivoted_qr(int n, mg_real *A, mg_real *y, int *order, mg_real floor) {
  mg_real size = -1;
  int best = 0;
  for (int j = 0; j < n; j++) {
    const mg_real norm = sqrt(mg_sum_of_squares(n, A + (long)n * j));
    order[j] = j;
    if (norm > size) size = norm, best = j;
  }
  for (int j = 0; j < n; j++) {
    if (!(size > floor)) return j;
    mg_swap_columns(n, A, order, j, best);
    mg_real *pivot = A + j + n * j;
    const mg_real beta = mg_make_householder_reflector(pivot, n - j - 1, pivot + 1, 1);
    mg_apply_householder_reflector(beta, n - j - 1, pivot + 1, 1, y + j, y + j + 1, 1);
    best = mg_reflect_later_columns(beta, n, A, j, &size);
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
