/* Linear complementarity problems: 0 <= z, 0 <= w = A z + b, z.w = 0. Matrices are column-major, n by n. Solvers differ
   in the class of A; all certify their result by the same residual (Cottle, Pang and Stone, The Linear Complementarity
   Problem, 1992). */
#ifndef MG_LCP_H
#define MG_LCP_H

#include "base/real.h"

typedef enum {
  MG_LCP_SOLVED = 0,
  MG_LCP_INFEASIBLE = 1, /* no z >= 0 has A z + b >= 0; for mg_qp: the convex program is unbounded below */
  MG_LCP_RAY = 2,        /* Lemke's method ended on a ray: for a general matrix this proves nothing */
  MG_LCP_ITERATIONS = 3, /* the limit of iterations was reached */
  MG_LCP_NOT_FINITE = 4  /* the data hold NaN or infinity */
} mg_lcp_outcome;

typedef struct {
  int outcome;      /* mg_lcp_outcome */
  int iterations;   /* pivots or active-set changes */
  int rank;         /* rank of the active block of A (mg_qp), else n */
  mg_real residual; /* mg_lcp_residual of z */
} mg_lcp_report;

enum { MG_ROW_MAX = 26000 }; /* most rows of a problem: counts up to three times its square are kept in int */

/* Length of `work` of all functions below for size n, in mg_real. */
MG_API long long mg_lcp_work_size(int n);

/* Length of `iwork` of all functions below for size n, in int. */
MG_API long long mg_lcp_iwork_size(int n);

/* Solution of A_BB z_B = -b_B of least norm of D z, D = diag(sqrt(A_ii)), with z = 0 outside B; A symmetric positive
   semidefinite; active[i] != 0 marks B. Returns the rank of A_BB. */
MG_API int mg_active_solve(int n, const mg_real *A, const mg_real *b, const int *active, mg_real *z, mg_real *work,
                           int *iwork);

/* Optimum of the convex program min z'Az/2 + b'z, z >= 0, A symmetric positive semidefinite; where it is not unique,
   one of least norm of D z. active [n]: a guess of the active set on entry, z_i > 0 on return.
   Returns the outcome. */
MG_API int mg_qp(int n, const mg_real *A, const mg_real *b, int max_iterations, mg_real *z, int *active,
                 mg_lcp_report *report, mg_real *work, int *iwork);

/* A symmetric positive semidefinite matrix J M^-1 J^T of rows that each act on two bodies. */
typedef struct {
  int n;             /* rows */
  int n_body;        /* bodies */
  const int *o, *f;  /* [n] bodies of a row; -1: one that forces do not move */
  const mg_real *J;  /* [12 n] columns of body o, then of body f */
  const mg_real *MJ; /* [12 n] M^-1 J^T of these bodies */
} mg_row_matrix;

/* Length of `work` of mg_large_qp_solve, in mg_real. */
MG_API long mg_large_qp_work_size(int n, int n_body);

/* The convex program of mg_qp for many rows, by conjugate gradients; z: a guess on entry. Returns the outcome:
   MG_LCP_SOLVED with a residual within the tolerance, or as that of mg_qp if that is larger, or MG_LCP_ITERATIONS. */
MG_API int mg_large_qp_solve(const mg_row_matrix *A, const mg_real *b, mg_real tolerance, int max_iterations,
                             mg_real *z, mg_lcp_report *report, mg_real *work);

/* Solution for a general matrix by Lemke's method with lexicographic ties. Returns the outcome. */
MG_API int mg_lemke(int n, const mg_real *A, const mg_real *b, int max_iterations, mg_real *z, mg_lcp_report *report,
                    mg_real *work, int *iwork);

/* Solution for a general matrix, n <= 20, by trying every complementary cone; also decides that there is no solution.
   Returns the outcome. */
MG_API int mg_enumerate(int n, const mg_real *A, const mg_real *b, mg_real *z, mg_lcp_report *report, mg_real *work,
                        int *iwork);

/* Residual of any z: the scaled natural map max_i |min(z_i d_i, w_i / d_i)| / max_i(|b_i| / d_i), with d_i =
   sqrt(A_ii), or 1 where A_ii is not positive. */
MG_API mg_real mg_lcp_residual(int n, const mg_real *A, const mg_real *b, const mg_real *z);

#endif
