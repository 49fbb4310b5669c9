/* Least-norm solution of a symmetric positive semidefinite system: y = -S^+ c. With P' S P = L L' by pivoted Cholesky
   factorisation and L = Q R, the pseudoinverse is S^+ = P Q R^-T R^-1 Q' P'. */
#include "base/base.h"

/* Factors of a symmetric positive semidefinite k by k matrix S: P' S P = L L', and L = Q R where the rank is below k.
 */
typedef struct {
  int k;      /* size */
  int rank;   /* rank */
  mg_real *L; /* [k rank] lower trapezoid */
  mg_real *Q; /* [k rank] orthonormal columns */
  mg_real *R; /* [rank rank] upper triangle */
  int *order; /* [k] row of S in each row of P' S P */
} mg_factor;

/* Factors the trapezoid L (k by rank) into Q with orthonormal columns and an upper triangle R, by modified
   Gram-Schmidt with reorthogonalisation. */
static void mg_orthonormalise(mg_factor *f) {
  int k = f->k, r = f->rank;
  for (int j = 0; j < r; ++j) {
    mg_real *q = f->Q + j * k, *R = f->R + j * r;
    for (int i = 0; i < k; ++i) q[i] = i < j ? 0 : f->L[i + j * k];
    for (int i = 0; i < r; ++i) R[i] = 0;
    for (int pass = 0; pass < 2; ++pass)
      for (int m = 0; m < j; ++m) {
        const mg_real *p = f->Q + m * k;
        const mg_real dot = mg_dot(k, p, q);
        mg_add_scaled(k, -dot, p, q);
        R[m] += dot;
      }
    R[j] = (mg_real)sqrt(mg_dot(k, q, q));
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
  for (int j = 0; j < r; ++j) s[j] = mg_dot(k, f->Q + j * k, t);
  for (int j = r - 1; j >= 0; --j) {
    s[j] /= f->R[j + j * r];
    mg_add_scaled(j, -s[j], f->R + j * r, s);
  }
  for (int j = 0; j < r; ++j) {
    for (int i = 0; i < j; ++i) s[j] -= f->R[i + j * r] * s[i];
    s[j] /= f->R[j + j * r];
  }
  for (int i = 0; i < k; ++i) t[i] = 0;
  for (int j = 0; j < r; ++j) mg_add_scaled(k, s[j], f->Q + j * k, t);
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
  for (int j = 0; j < k; ++j) mg_add_scaled(k, y[j], S + j * k, residual);
}

/* Solves S y = -c by the plain factor, of the given least pivot, with one step of iterative refinement. Returns 0 if S
   is too near to singular for that. */
static int mg_solve_regular(int k, const mg_real *S, const mg_real *c, mg_real *y, mg_real *L, mg_real *residual,
                            mg_real *pivot) {
  for (int i = 0; i < k * k; ++i) L[i] = S[i];
  *pivot = mg_cholesky(k, L);
  if (!(*pivot > MG_LCP_REGULAR)) return 0;
  for (int i = 0; i < k; ++i) y[i] = -c[i];
  mg_cholesky_solve(k, L, y);
  mg_linear_residual(k, S, c, y, residual);
  mg_cholesky_solve(k, L, residual);
  for (int i = 0; i < k; ++i) y[i] -= residual[i];
  return 1;
}

MG_INTERNAL int mg_minimum_norm(int k, const mg_real *S, const mg_real *c, mg_real floor, mg_real *y, mg_real *work,
                                int *order, mg_real *pivot) {
  return mg_minimum_norm_above(k, S, c, floor, 0, y, work, order, pivot);
}

MG_INTERNAL int mg_minimum_norm_above(int k, const mg_real *S, const mg_real *c, mg_real floor, const mg_real *floors,
                                      mg_real *y, mg_real *work, int *order, mg_real *pivot) {
  mg_factor f = {k, k, work, work + k * k, work + 2 * k * k, order};
  mg_real *residual = work + 3 * k * k, *t = residual + k, *s = t + k;
  *pivot = (1 - S[1]) * (1 + S[1]);
  if (k == 2 && S[0] > 0 && S[3] > 0) return mg_minimum_norm_two(S[1], c, y);
  if (mg_solve_regular(k, S, c, y, f.L, residual, pivot)) return k;
  for (int i = 0; i < k * k; ++i) f.L[i] = S[i];
  f.rank = mg_cholesky_pivoted(k, f.L, order, floor, floors);
  if (f.rank < k) mg_orthonormalise(&f);
  for (int i = 0; i < k; ++i) y[i] = 0;
  mg_subtract_pseudoinverse(&f, c, y, t, s);
  mg_linear_residual(k, S, c, y, residual);
  mg_subtract_pseudoinverse(&f, residual, y, t, s);
  return f.rank;
}
