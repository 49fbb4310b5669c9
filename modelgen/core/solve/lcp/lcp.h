/* Complementarity problems: 0 <= z, 0 <= w = A z + b, z.w = 0. Matrices are column-major, n by n. */
#ifndef MG_LCP_H
#define MG_LCP_H

#include "base/real.h"

typedef enum {
  MG_LCP_SOLVED = 0,
  MG_LCP_INFEASIBLE =
      1,          /* no z >= 0 with A z + b >= 0 (for mg_qp: b has a part outside the range of A that no z mends) */
  MG_LCP_RAY = 2, /* Lemke ended on a ray: no conclusion for this class of matrix */
  MG_LCP_ITERATIONS = 3, /* the iteration limit was met */
  MG_LCP_NOT_FINITE = 4  /* the data hold NaN or infinity */
} mg_lcp_outcome;

typedef struct {
  int outcome;      /* mg_lcp_outcome */
  int iterations;   /* pivots or active-set changes */
  int rank;         /* of the active block of A (mg_qp), else n */
  mg_real residual; /* scaled natural map: max_i |min(z_i d_i, w_i / d_i)| / max_i(|b_i| / d_i), d_i = sqrt(A_ii) (1
                       where not positive) */
} mg_lcp_report;

/* Doubles and ints of scratch that any of the solvers below needs for size n. */
MG_API int mg_lcp_work_size(int n);
MG_API int mg_lcp_iwork_size(int n);

/* Minimum-norm solution of A_BB z_B = -b_B (norm of D z, D = diag(sqrt(A_ii))), z = 0 off B; A symmetric
   positive semidefinite; active[i] != 0 marks B. Returns the rank. */
MG_API int mg_active_solve(int n, const mg_real *A, const mg_real *b, const int *active, mg_real *z, mg_real *work,
                           int *iwork);

/* The convex QP min 1/2 z'Az + b'z, z >= 0, A symmetric positive semidefinite. Of all solutions the one of
   least |D z|. `active` is the warm start on entry, the active set (z_i > 0) on return. */
MG_API int mg_qp(int n, const mg_real *A, const mg_real *b, int max_iterations, mg_real *z, int *active,
                 mg_lcp_report *report, mg_real *work, int *iwork);

/* A general matrix: Lemke's method with lexicographic ties. */
MG_API int mg_lemke(int n, const mg_real *A, const mg_real *b, int max_iterations, mg_real *z, mg_lcp_report *report,
                    mg_real *work, int *iwork);

/* A general matrix, n <= 20: every complementary basis in turn; decides infeasibility on nonsingular bases. */
MG_API int mg_enumerate(int n, const mg_real *A, const mg_real *b, mg_real *z, mg_lcp_report *report, mg_real *work,
                        int *iwork);

/* mg_qp's certificate for any z: the scaled natural-map residual. */
MG_API mg_real mg_lcp_residual(int n, const mg_real *A, const mg_real *b, const mg_real *z);

#endif
