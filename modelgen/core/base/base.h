/* Small vectors, parts of the scratch memory, and factorisations of small dense matrices. Matrices are column-major.
   May use: nothing of the core. */
#ifndef MG_BASE_H
#define MG_BASE_H

#ifdef MG_DEBUG
#include <assert.h>
#endif
#include <stddef.h>

#include "base/taylor_models.h"
#include "base/real.h"

/* What must hold where a function is called: asserted in a debug core (MG_DEBUG), nothing in others. */
#ifdef MG_DEBUG
#define MG_REQUIRE(condition) assert(condition)
#else
#define MG_REQUIRE(condition) ((void)0)
#endif

/* MG_LCP_TIKHONOV  regularisation: added to the unit diagonal of S while the active set is sought.
   MG_LCP_CAP       largest residual of a solution (see mg_lcp_tolerance). */
#if defined(MG_REAL_LONG)
#define MG_LCP_TIKHONOV 1e-12L
#define MG_LCP_CAP 1e-12L
#elif defined(MG_REAL_FLOAT)
#define MG_LCP_TIKHONOV 1e-4f
#define MG_LCP_CAP 1e-3f
#else
#define MG_LCP_TIKHONOV 1e-10
#define MG_LCP_CAP 1e-9
#endif

/* Pivots of S, whose diagonal is 1, that are below this count as zero: rounding of A leaves about n eps there. */
#define MG_LCP_RANK(n) ((mg_real)1e3 * (mg_real)(n) * MG_EPS)

/* If all Cholesky pivots are above this, the factor is used as it is, with one step of iterative refinement. */
#define MG_LCP_REGULAR ((mg_real)1e4 * MG_LCP_TIKHONOV)

/* If all pivots of A are above this part of their diagonal entries, A is taken as definite: its rank is no question,
   and refinement in the same precision would not change the order of the error. */
#define MG_LCP_DEFINITE ((mg_real)1e-2)

/* Most unknowns of mg_solve_definite: four contacts with friction. */
enum { MG_DEFINITE_MAX = 12 };

#define MG_DIGEST_START 0x9e3779b97f4a7c15ULL /* digest of nothing */

/* digest.c */

/* The digest with n numbers more. */
MG_INTERNAL mg_digest mg_digest_ints(mg_digest digest, const int *values, long n);
MG_INTERNAL mg_digest mg_digest_reals(mg_digest digest, const mg_real *values, long n);

/* The same with the characters of a text. */
MG_INTERNAL mg_digest mg_digest_text(mg_digest digest, const char *text);

/* The same with n bytes. */
MG_INTERNAL mg_digest mg_digest_bytes(mg_digest digest, const unsigned char *bytes, long n);

/* vectors.c */

/* True if all numbers are finite. */
MG_INTERNAL int mg_all_finite(int count, const mg_real *x);

/* Largest absolute value. */
MG_INTERNAL mg_real mg_max_abs(int count, const mg_real *x);

/* Scalar product of two vectors in the plane. */
MG_INTERNAL mg_real mg_dot2(const mg_real *a, const mg_real *b);

/* Vector product of two vectors in the plane: its component normal to the plane. */
MG_INTERNAL mg_real mg_cross2(const mg_real *a, const mg_real *b);

/* Distance of two points in the plane. */
MG_INTERNAL mg_real mg_distance2(const mg_real *a, const mg_real *b);

/* out = R^T x, with R by columns; out may be x. */
MG_INTERNAL void mg_rotate_back(const mg_real *R, const mg_real *x, mg_real *out);

/* Scalar product of two vectors. */
MG_INTERNAL mg_real mg_dot3(const mg_real *a, const mg_real *b);

/* Scalar product of two vectors of six components. */
MG_INTERNAL mg_real mg_dot6(const mg_real *a, const mg_real *b);

/* y += s x, of six components. */
static inline void mg_add_multiple6(mg_real s, const mg_real *x, mg_real *y) {
  y[0] += x[0] * s, y[1] += x[1] * s, y[2] += x[2] * s;
  y[3] += x[3] * s, y[4] += x[4] * s, y[5] += x[5] * s;
}

/* y += s x, of n components; in blocks, which compilers turn into vector instructions. */
static inline void mg_add_scaled(int n, mg_real s, const mg_real *restrict x, mg_real *restrict y) {
  int i = 0;
  for (; i + 8 <= n; i += 8)
    for (int k = 0; k < 8; k++) y[i + k] += s * x[i + k];
  for (; i < n; i++) y[i] += s * x[i];
}

/* Scalar product of two vectors of n components, summed one after the other. */
static inline mg_real mg_dot(int n, const mg_real *a, const mg_real *b) {
  mg_real sum = 0;
  int i = 0;
  for (; i + 4 <= n; i += 4) sum = sum + a[i] * b[i] + a[i + 1] * b[i + 1] + a[i + 2] * b[i + 2] + a[i + 3] * b[i + 3];
  for (; i < n; i++) sum += a[i] * b[i];
  return sum;
}

/* Scales a vector to unit length. Returns 0 if its length is zero or not finite. */
MG_INTERNAL int mg_normalise3(mg_real *n);

/* Transforms a point (is_point = 1) or a direction (0) from the axes of a pose to world axes. */
MG_INTERNAL void mg_to_world(const mg_real *pose, const mg_real *x, int is_point, mg_real *out);

/* Transforms a point from world axes to the axes of a pose. */
MG_INTERNAL void mg_world_to_local_point(const mg_real *pose, const mg_real *world, mg_real *local);

/* out = a x b; out must not be a or b. */
MG_INTERNAL void mg_cross_product(const mg_real *a, const mg_real *b, mg_real *out);

/* Sorts integers in ascending order (Shell sort with Knuth's increments). */
MG_INTERNAL void mg_sort_ints(int count, int *list);

/* to = from, n numbers; they do not overlap. */
MG_INTERNAL void mg_copy_reals(mg_real *restrict to, const mg_real *restrict from, int n);

/* polynomial_roots.c */

enum {
  MG_BERNSTEIN_DEGREE = 8, /* most of a polynomial in Bernstein form */
  MG_BERNSTEIN_ROOTS = 16  /* most intervals that hold its roots */
};

/* Where a polynomial has a root: low = high; or is zero to rounding, as at roots that almost coincide: low < high. */
typedef struct {
  mg_real low, high;
} mg_root_interval;

/* sum += factor a b, with a, b of degree m, n and their product given by the coefficients of (1 - t)^(n - k) t^k. */
MG_INTERNAL void mg_add_homogeneous_product(int m, const mg_real *a, int n, const mg_real *b, mg_real factor,
                                            mg_real *sum);

/* Real roots on [-1, 1], ascending, of a polynomial given by the coefficients of (1 - t)^(n - k) t^k, t = (1 + x)/2;
   Bernstein coefficients up to `noise` count as zero. Returns their number; `root` has room for MG_BERNSTEIN_ROOTS. */
MG_INTERNAL int mg_homogeneous_roots(int n, const mg_real *coefficients, mg_real noise, mg_root_interval *root);

/* taylor_models.c */

/* Bounds of the first outputs of a program, as many as wanted, over a box u0..u1, v0..v1 of coordinates, at given
   parameters. memory: program->n_memory. kink[k]: place along the coordinate k, from -1 to 1, of the kink nearest to
   the middle that a min, max or absolute value has at one value of it; 1: none. */
MG_INTERNAL void mg_bound_over_box(const mg_bounds_program *program, const mg_real *box, const mg_real *parameters,
                                   int wanted, mg_taylor_model *memory, mg_taylor_model *out, mg_real *kink);

/* Bound of the change of an affine form over its box from its value at the middle. */
MG_INTERNAL mg_real mg_taylor_change(const mg_taylor_model *a);

/* memory.c */

/* Number of mg_real that n items of `size` bytes take at most, wherever the memory begins. */
MG_INTERNAL long mg_count_reals(long n, size_t size);

/* Takes n items of `size` bytes, aligned for all types of the core, from the memory, which then begins behind them. */
MG_INTERNAL void *mg_take_memory(mg_real **memory, long n, size_t size);

/* Takes n mg_real from the memory, which then begins behind them. */
MG_INTERNAL mg_real *mg_take_reals(mg_real **next, long long n);

/* Takes n int from the memory, which then begins behind them. */
MG_INTERNAL int *mg_take_ints(int **next, long long n);

/* Sets n numbers to zero. */
MG_INTERNAL void mg_zero_reals(mg_real *a, long n);

/* True if the flag, or null, has been set, maybe by another thread or a signal handler during the call. */
MG_INTERNAL int mg_is_raised(const int *flag);

/* cholesky.c */

/* Replaces the lower triangle of L, k by k, by its Cholesky factor, with the reciprocals of its diagonal. Returns
   the smallest pivot; pivots below MG_LCP_TIKHONOV are replaced by it. */
MG_INTERNAL mg_real mg_cholesky(int k, mg_real *L);

/* Replaces x by the solution of L L' z = x for a factor of mg_cholesky. */
MG_INTERNAL void mg_cholesky_solve(int k, const mg_real *L, mg_real *x);

/* Solves A z = -b by A = L D L^T for at most MG_DEFINITE_MAX unknowns; A symmetric, of which the lower triangle is
   read. Returns 0 where a pivot is not above MG_LCP_DEFINITE times its diagonal entry; z is then undefined. */
MG_INTERNAL int mg_solve_definite(int n, const mg_real *A, const mg_real *b, mg_real *z);

/* Replaces L, full and symmetric, by the lower trapezoid of P' S P, k by rank. Returns the rank, the number of
   pivots above `floor`, or above floors [k] of their rows unless that is 0. Row i of the factor belongs to row
   order[i] of S. */
MG_INTERNAL int mg_cholesky_pivoted(int k, mg_real *L, int *order, mg_real floor, const mg_real *floors);

/* minimum_norm.c */

/* Least-norm solution y (2) of S y = -c for S = [1 s; s 1]. Returns the rank of S. */
MG_INTERNAL int mg_minimum_norm_two(mg_real s, const mg_real *c, mg_real *y);

/* Least-norm solution y (k) of S y = -c, refined once. The diagonal of S is 1, or not positive. Returns the rank
   of S, the number of pivots above `floor`, and the least pivot of S. work: 3 k^2 + 3 k; order: k. */
MG_INTERNAL int mg_minimum_norm(int k, const mg_real *S, const mg_real *c, mg_real floor, mg_real *y, mg_real *work,
                                int *order, mg_real *pivot);

/* The same with a floor for each row, floors [k], in place of `floor` unless that is 0. */
MG_INTERNAL int mg_minimum_norm_above(int k, const mg_real *S, const mg_real *c, mg_real floor, const mg_real *floors,
                                      mg_real *y, mg_real *work, int *order, mg_real *pivot);

/* lu.c */

/* Replaces A by R A C with columns of largest entry 1 and b by R b / max|R b|. z of the scaled problem times
   `column` is z. R and C are diagonal and positive, so that complementary bases and signs stay what they are. */
MG_INTERNAL void mg_equilibrate(int n, mg_real *A, mg_real *b, mg_real *row, mg_real *column);

/* Replaces U, k by k, by its LU factors with row exchanges, which `swap` [k] records. Returns the smallest pivot,
   or 0 if U is singular. */
MG_INTERNAL mg_real mg_lu(int k, mg_real *U, int *swap);

/* Replaces x by the solution of U z = x for factors of mg_lu. */
MG_INTERNAL void mg_lu_solve(int k, const mg_real *U, const int *swap, mg_real *x);

/* Replaces B by A^-1 B. AB has k rows of `width`: k columns of A, which are lost, and behind them those of B. Returns 0
   if A is singular. */
MG_INTERNAL int mg_solve_columns(int k, int width, mg_real *AB);

/* Solves A_BB z_B = -b_B, refined once, with z = 0 outside B; active[i] != 0 marks B. Returns the smallest pivot
   (A has entries up to 1), or 0 if A_BB is singular, with z = 0. work: n^2 + n; iwork: 2 n. */
MG_INTERNAL mg_real mg_basis_solve(int n, const mg_real *A, const mg_real *b, const int *active, mg_real *z,
                                   mg_real *work, int *iwork);

/* pivoted_qr.c */

/* Factor A P = Q R with column pivoting: A becomes R, y becomes Q^T y, `order` holds P. Returns the rank: the
   number of pivots above `floor`. */
MG_INTERNAL int mg_factor_pivoted_qr(int n, mg_real *A, mg_real *y, int *order, mg_real floor);

/* Solution z of least norm of R z = y, R of `rank` rows; beta is scratch. */
MG_INTERNAL void mg_solve_least_norm_qr(int n, int rank, mg_real *R, const mg_real *y, mg_real *z, mg_real *beta);

#endif
