/* What the solvers of linear complementarity problems share: scaling, tolerances, certificates. All work on y = D z and
   S y + c with S = D^-1 A D^-1, c = D^-1 b. May use: base. */
#ifndef MG_SOLVE_LCP_SOLVERS_H
#define MG_SOLVE_LCP_SOLVERS_H

#include "base/base.h"
#include "solve/lcp/lcp.h"

typedef struct {
  int n, k;
  mg_real scale;      /* max_i |b_i| / d_i; c is divided by it */
  mg_real *S, *c, *d; /* the scaled problem */
  mg_real *L, *y, *w; /* factor of S_BB + tikhonov, the regularised y and its w */
  mg_real *shifted;   /* c - tikhonov * previous */
  mg_real *previous, *trial, *gathered;
  mg_real *work;
  int *index, *flip, *order;
  mg_real pivot; /* the smallest of the factor */
} mg_qp_state;

/* certificate.c */
MG_INTERNAL mg_real mg_diagonal_scale(mg_real a);
MG_INTERNAL mg_real mg_lcp_tolerance(int n, mg_real growth);
MG_INTERNAL int mg_lcp_start(int n, const mg_real *A, const mg_real *b, mg_real *z, mg_lcp_report *report);
MG_INTERNAL int mg_lcp_certify(int n, const mg_real *A, const mg_real *b, const mg_real *candidate, mg_real *z,
                               mg_lcp_report *report);
MG_INTERNAL int mg_lcp_give_up(int n, const mg_real *A, const mg_real *b, const mg_real *z, int outcome,
                               mg_lcp_report *report);

/* active_set.c */
MG_INTERNAL int mg_active_above(int n, const mg_real *A, const mg_real *b, const int *active, mg_real floor, mg_real *z,
                                mg_real *work, int *iwork);

#endif
