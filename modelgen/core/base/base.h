/* Small vectors, parts of the scratch memory, and factorisations of small dense matrices. Matrices are column-major.
   May use: nothing of the core. */
#ifndef MG_BASE_H
#define MG_BASE_H

#include <stddef.h>

#include "base/real.h"

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

/* vectors.c */
MG_INTERNAL int mg_all_finite(int count, const mg_real *x);
MG_INTERNAL mg_real mg_max_abs(int count, const mg_real *x);
MG_INTERNAL mg_real mg_dot2(const mg_real *a, const mg_real *b);
MG_INTERNAL mg_real mg_cross2(const mg_real *a, const mg_real *b);
MG_INTERNAL mg_real mg_distance2(const mg_real *a, const mg_real *b);
MG_INTERNAL void mg_rotate_back(const mg_real *R, const mg_real *x, mg_real *out);
MG_INTERNAL mg_real mg_dot3(const mg_real *a, const mg_real *b);
MG_INTERNAL mg_real mg_dot6(const mg_real *a, const mg_real *b);
MG_INTERNAL int mg_normalise3(mg_real *n);
MG_INTERNAL void mg_to_world(const mg_real *pose, const mg_real *x, int is_point, mg_real *out);
MG_INTERNAL void mg_world_to_local_point(const mg_real *pose, const mg_real *world, mg_real *local);
MG_INTERNAL void mg_cross_product(const mg_real *a, const mg_real *b, mg_real *out);

/* memory.c */
MG_INTERNAL long mg_count_reals(long n, size_t size);
MG_INTERNAL void *mg_take_memory(mg_real **memory, long n, size_t size);
MG_INTERNAL mg_real *mg_take_reals(mg_real **next, long n);
MG_INTERNAL int *mg_take_ints(int **next, long n);
MG_INTERNAL void mg_zero_reals(mg_real *a, long n);

/* cholesky.c */
MG_INTERNAL mg_real mg_cholesky(int k, mg_real *L);
MG_INTERNAL void mg_cholesky_solve(int k, const mg_real *L, mg_real *x);
MG_INTERNAL int mg_cholesky_pivoted(int k, mg_real *L, int *order, mg_real tolerance);
MG_INTERNAL int mg_minimum_norm_two(mg_real s, const mg_real *c, mg_real *y);
MG_INTERNAL int mg_minimum_norm(int k, const mg_real *S, const mg_real *c, mg_real floor, mg_real *y, mg_real *work,
                                int *order);

/* lu.c */
MG_INTERNAL void mg_equilibrate(int n, mg_real *A, mg_real *b, mg_real *row, mg_real *column);
MG_INTERNAL mg_real mg_lu(int k, mg_real *U, int *swap);
MG_INTERNAL void mg_lu_solve(int k, const mg_real *U, const int *swap, mg_real *x);
MG_INTERNAL mg_real mg_basis_solve(int n, const mg_real *A, const mg_real *b, const int *active, mg_real *z,
                                   mg_real *work, int *iwork);

#endif
