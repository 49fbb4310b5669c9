/* What the solvers of linear complementarity problems share: the scaled form, tolerances and certificates. All work on
   y = D z and S y + c with S = D^-1 A D^-1, c = D^-1 b, D = diag(sqrt(A_ii)). May use: base. */
#ifndef MG_SOLVE_LCP_SOLVERS_H
#define MG_SOLVE_LCP_SOLVERS_H

#include "base/base.h"
#include "solve/lcp/lcp.h"

typedef struct {
  int n;              /* size */
  int k;              /* size of the active block B */
  mg_real scale;      /* max_i |b_i| / d_i, by which c is divided */
  mg_real *S, *c, *d; /* the scaled problem: [n n], [n], and the diagonal of D */
  mg_real *L;         /* [k k] Cholesky factor of S_BB + tikhonov I */
  mg_real *y, *w;     /* [n] solution of the regularised problem, and its w */
  mg_real *shifted;   /* [n] c - tikhonov * previous */
  mg_real *previous;  /* [n] y of the proximal step before */
  mg_real *trial;     /* [n] solution without the Tikhonov term on the same active set */
  mg_real *gathered;  /* [n] values on B */
  mg_real *work;      /* scratch */
  int *index;         /* [k] rows of B */
  int *flip;          /* [n] 1: violated, changes side */
  int *order;         /* [k] rows of a pivoted factor */
  mg_real pivot;      /* smallest pivot of the factor */
} mg_qp_state;

/* lcp_certificate.c */

/* sqrt(a), or 1 where a is not positive. */
MG_INTERNAL mg_real mg_diagonal_scale(mg_real a);

/* Largest residual of a solution: min(MG_LCP_CAP, 1e3 n eps max(1, growth)) with growth = max|D z| / max|D^-1 b|,
   because A z cannot be computed to better than eps * growth. */
MG_INTERNAL mg_real mg_lcp_tolerance(int n, mg_real growth);

/* Clears the report and z. Returns nonzero if the result is known: z = 0 is the solution, or the data are not
   finite. */
MG_INTERNAL int mg_lcp_start(int n, const mg_real *A, const mg_real *b, mg_real *z, mg_lcp_report *report);

/* Copies the candidate to z if its residual is the least so far. Returns whether it is a solution. */
MG_INTERNAL int mg_lcp_certify(int n, const mg_real *A, const mg_real *b, const mg_real *candidate, mg_real *z,
                               mg_lcp_report *report);

/* Reports an outcome other than SOLVED; z is the best candidate found, with its residual. Returns the outcome. */
MG_INTERNAL int mg_lcp_report_failure(int n, const mg_real *A, const mg_real *b, const mg_real *z, int outcome,
                                      mg_lcp_report *report);

/* known_active_set.c */

enum { MG_ACTIVE_ABOVE_ROUNDING = 2 }; /* entry of `active`: in B, and its pivot is zero only to rounding */

/* mg_active_solve with pivots of the scaled A_BB up to `floor` counted as zero; floor = 0: rounding, as for entries
   MG_ACTIVE_ABOVE_ROUNDING of `active`. `pivot` receives the least of them, or a lower bound that is not small. */
MG_INTERNAL int mg_active_above(int n, const mg_real *A, const mg_real *b, const int *active, mg_real floor, mg_real *z,
                                mg_real *work, int *iwork, mg_real *pivot);

#endif
