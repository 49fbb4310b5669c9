/* What the complementarity solvers share: tolerances, scaling, factors, and how a candidate is certified.
   All solvers work on y = D z and S y + c with S = D^-1 A D^-1, c = D^-1 b. */
#ifndef MG_LCP_SCALED_H
#define MG_LCP_SCALED_H

#include "lcp.h"

/* MG_LCP_TIKHONOV  added to the unit diagonal of S while the active set is sought.
   MG_LCP_CAP       no answer with residual above it is called solved (see mg_lcp_tolerance). */
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

/* Pivots of S below this fraction of 1 count as zero: rounding of A leaves about n eps there. */
#define MG_LCP_RANK(n) ((mg_real)1e3 * (mg_real)(n) * MG_EPS)

/* Cholesky pivots all above it: the factor is used as it is, with one refinement. */
#define MG_LCP_REGULAR ((mg_real)1e4 * MG_LCP_TIKHONOV)

/* A symmetric positive semidefinite k by k matrix P L L' P', and Q R = L where the rank is below k. */
typedef struct {
  int k, rank;
  mg_real *L, *Q, *R;
  int *order;
} mg_factor;

/* lcp_residual.c */
MG_INTERNAL int mg_all_finite(int count, const mg_real *x);
MG_INTERNAL mg_real mg_diagonal_scale(mg_real a);
MG_INTERNAL mg_real mg_max_abs(int count, const mg_real *x);
MG_INTERNAL mg_real mg_lcp_tolerance(int n, mg_real growth);
MG_INTERNAL int mg_lcp_start(int n, const mg_real *A, const mg_real *b, mg_real *z, mg_lcp_report *report);
MG_INTERNAL int mg_lcp_certify(int n, const mg_real *A, const mg_real *b, const mg_real *candidate, mg_real *z,
                          mg_lcp_report *report);
MG_INTERNAL int mg_lcp_give_up(int n, const mg_real *A, const mg_real *b, const mg_real *z, int outcome,
                          mg_lcp_report *report);

/* lcp_cholesky.c */
MG_INTERNAL mg_real mg_cholesky(int k, mg_real *L);
MG_INTERNAL void mg_cholesky_solve(int k, const mg_real *L, mg_real *x);
MG_INTERNAL int mg_cholesky_pivoted(int k, mg_real *L, int *order, mg_real tolerance);

/* lcp_minimum_norm.c: scratch of 3 k^2 + 3 k reals, k ints */
MG_INTERNAL int mg_minimum_norm_two(mg_real s, const mg_real *c, mg_real *y);
MG_INTERNAL int mg_minimum_norm(int k, const mg_real *S, const mg_real *c, mg_real floor, mg_real *y, mg_real *work,
                           int *order);

/* active_solve.c: pivots below `floor` count as zero */
MG_INTERNAL int mg_active_above(int n, const mg_real *A, const mg_real *b, const int *active, mg_real floor, mg_real *z,
                           mg_real *work, int *iwork);

/* lcp_basis.c */
MG_INTERNAL mg_real mg_lu(int k, mg_real *U, int *swap);
MG_INTERNAL void mg_lu_solve(int k, const mg_real *U, const int *swap, mg_real *x);
MG_INTERNAL void mg_equilibrate(int n, mg_real *A, mg_real *b, mg_real *row, mg_real *column);
MG_INTERNAL mg_real mg_basis_solve(int n, const mg_real *A, const mg_real *b, const int *active, mg_real *z,
                              mg_real *work, int *iwork);

/* qp_small.c */
MG_INTERNAL int mg_qp_one(mg_real a, mg_real b, mg_real *z, int *active, mg_lcp_report *report);
MG_INTERNAL int mg_qp_two(const mg_real *A, const mg_real *b, mg_real *z, int *active, mg_lcp_report *report);

/* qp_pivot.c */
typedef struct {
  int n, k;
  mg_real scale;            /* max_i |b_i| / d_i; c is divided by it */
  mg_real *S, *c, *d;       /* the scaled problem */
  mg_real *L, *y, *w;       /* factor of S_BB + tikhonov, the regularised y and its w */
  mg_real *shifted;         /* c - tikhonov * previous */
  mg_real *previous, *trial, *gathered;
  mg_real *work;
  int *index, *flip, *order;
  mg_real pivot;            /* the smallest of the factor */
} mg_qp_state;
MG_INTERNAL int mg_block_pivot(mg_qp_state *s, int *active, int limit);

/* qp_refine.c */
MG_INTERNAL int mg_qp_refine(mg_qp_state *s);
MG_INTERNAL int mg_qp_unbounded(const mg_qp_state *s);

#endif
