/* Cholesky factorisation of small dense symmetric positive semidefinite matrices, column-major, in place: plain, and
   with diagonal pivoting (Golub and Van Loan, Matrix Computations, section 4.2); and L D L^T of definite ones
   (section 4.1).

   Least-norm solution y = -S^+ c: with P' S P = L L' and L = Q R the pseudoinverse is S^+ = P Q R^-T R^-1 Q' P'. */
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
      mg_real factor = column[c], *target = L + c * k;
      if (factor == 0) continue;
      for (int i = c; i < k; ++i) target[i] -= factor * column[i];
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

MG_INTERNAL int mg_cholesky_pivoted(int k, mg_real *L, int *order, mg_real tolerance) {
  for (int j = 0; j < k; ++j) order[j] = j;
  for (int j = 0; j < k; ++j) {
    mg_real *column = L + j * k, reciprocal;
    int largest = j;
    for (int i = j + 1; i < k; ++i)
      if (L[i + i * k] > L[largest + largest * k]) largest = i;
    if (!(L[largest + largest * k] > tolerance)) return j;
    mg_swap_rows_and_columns(k, L, order, j, j, largest);
    reciprocal = 1 / (mg_real)sqrt(column[j]);
    for (int i = j; i < k; ++i) column[i] *= reciprocal;
    for (int c = j + 1; c < k; ++c)
      for (int i = j + 1; i < k; ++i) L[i + c * k] -= column[c] * column[i];
  }
  return k;
}

/* Factors the trapezoid L (k by rank) into Q with orthonormal columns and an upper triangle R, by modified
   Gram-Schmidt with reorthogonalisation. */
static void mg_orthonormalise(mg_factor *f) {
  int k = f->k, r = f->rank;
  for (int j = 0; j < r; ++j) {
    mg_real *q = f->Q + j * k, *R = f->R + j * r, norm = 0;
    for (int i = 0; i < k; ++i) q[i] = i < j ? 0 : f->L[i + j * k];
    for (int i = 0; i < r; ++i) R[i] = 0;
    for (int pass = 0; pass < 2; ++pass)
      for (int m = 0; m < j; ++m) {
        const mg_real *p = f->Q + m * k;
        mg_real dot = 0;
        for (int i = 0; i < k; ++i) dot += p[i] * q[i];
        for (int i = 0; i < k; ++i) q[i] -= dot * p[i];
        R[m] += dot;
      }
    for (int i = 0; i < k; ++i) norm += q[i] * q[i];
    R[j] = (mg_real)sqrt(norm);
    for (int i = 0; i < k; ++i) q[i] /= R[j];
  }
}

/* Replaces t by L^-T L^-1 t, for L of full rank. */
static void mg_solve_full_rank(const mg_factor *f, mg_real *t) {
  int k = f->k;
  for (int j = 0; j < k; ++j) {
    t[j] /= f->L[j + j * k];
    for (int i = j + 1; i < k; ++i) t[i] -= f->L[i + j * k] * t[j];
  }
  for (int j = k - 1; j >= 0; --j) {
    for (int i = j + 1; i < k; ++i) t[j] -= f->L[i + j * k] * t[i];
    t[j] /= f->L[j + j * k];
  }
}

/* Replaces t by Q R^-T R^-1 Q' t; s is scratch of k. */
static void mg_solve_rank_deficient(const mg_factor *f, mg_real *t, mg_real *s) {
  int k = f->k, r = f->rank;
  for (int j = 0; j < r; ++j) {
    s[j] = 0;
    for (int i = 0; i < k; ++i) s[j] += f->Q[i + j * k] * t[i];
  }
  for (int j = r - 1; j >= 0; --j) {
    s[j] /= f->R[j + j * r];
    for (int i = 0; i < j; ++i) s[i] -= f->R[i + j * r] * s[j];
  }
  for (int j = 0; j < r; ++j) {
    for (int i = 0; i < j; ++i) s[j] -= f->R[i + j * r] * s[i];
    s[j] /= f->R[j + j * r];
  }
  for (int i = 0; i < k; ++i) t[i] = 0;
  for (int j = 0; j < r; ++j)
    for (int i = 0; i < k; ++i) t[i] += f->Q[i + j * k] * s[j];
}

/* y -= S^+ residual; t and s are scratch of k. */
static void mg_subtract_pseudoinverse(const mg_factor *f, const mg_real *residual, mg_real *y, mg_real *t, mg_real *s) {
  for (int i = 0; i < f->k; ++i) t[i] = residual[f->order[i]];
  if (f->rank == f->k) mg_solve_full_rank(f, t);
  else mg_solve_rank_deficient(f, t, s);
  for (int i = 0; i < f->k; ++i) y[f->order[i]] -= t[i];
}

MG_INTERNAL int mg_minimum_norm_two(mg_real s, const mg_real *c, mg_real *y) {
  mg_real determinant = (1 - s) * (1 + s);
  if (determinant > MG_LCP_RANK(2)) {
    mg_real r0, r1;
    y[0] = (s * c[1] - c[0]) / determinant;
    y[1] = (s * c[0] - c[1]) / determinant;
    r0 = y[0] + s * y[1] + c[0];
    r1 = s * y[0] + y[1] + c[1];
    y[0] -= (r0 - s * r1) / determinant;
    y[1] -= (r1 - s * r0) / determinant;
    return 2;
  }
  s = s > 0 ? (mg_real)1 : (mg_real)-1;
  y[0] = -(c[0] + s * c[1]) / 4;
  y[1] = s * y[0];
  return 1;
}

/* residual = S y + c. */
static void mg_linear_residual(int k, const mg_real *S, const mg_real *c, const mg_real *y, mg_real *residual) {
  for (int i = 0; i < k; ++i) residual[i] = c[i];
  for (int j = 0; j < k; ++j)
    for (int i = 0; i < k; ++i) residual[i] += S[i + j * k] * y[j];
}

/* Solves S y = -c by the plain factor with one step of iterative refinement. Returns 0 if S is too near to
   singular for that. */
static int mg_solve_regular(int k, const mg_real *S, const mg_real *c, mg_real *y, mg_real *L, mg_real *residual) {
  for (int i = 0; i < k * k; ++i) L[i] = S[i];
  if (!(mg_cholesky(k, L) > MG_LCP_REGULAR)) return 0;
  for (int i = 0; i < k; ++i) y[i] = -c[i];
  mg_cholesky_solve(k, L, y);
  mg_linear_residual(k, S, c, y, residual);
  mg_cholesky_solve(k, L, residual);
  for (int i = 0; i < k; ++i) y[i] -= residual[i];
  return 1;
}

MG_INTERNAL int mg_minimum_norm(int k, const mg_real *S, const mg_real *c, mg_real floor, mg_real *y, mg_real *work,
                                int *order) {
  mg_factor f = {k, k, work, work + k * k, work + 2 * k * k, order};
  mg_real *residual = work + 3 * k * k, *t = residual + k, *s = t + k;
  if (k == 2 && S[0] > 0 && S[3] > 0) return mg_minimum_norm_two(S[1], c, y);
  if (mg_solve_regular(k, S, c, y, f.L, residual)) return k;
  for (int i = 0; i < k * k; ++i) f.L[i] = S[i];
  f.rank = mg_cholesky_pivoted(k, f.L, order, floor);
  if (f.rank < k) mg_orthonormalise(&f);
  for (int i = 0; i < k; ++i) y[i] = 0;
  mg_subtract_pseudoinverse(&f, c, y, t, s);
  mg_linear_residual(k, S, c, y, residual);
  mg_subtract_pseudoinverse(&f, residual, y, t, s);
  return f.rank;
}
