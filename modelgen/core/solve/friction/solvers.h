/* What the solvers of cone friction problems share. They work on y = z / (e scale) and v = S y + c, bilateral rows
   eliminated, with e_n = 1 / sqrt(A_nn), e_t = mu e_n, so that every cone is |y_t| <= y_n and S_nn = 1. A part of a
   contact is a disc of forces: slip (2 rows), spin (1), rolling (2); rows with mu = 0 carry no force and are left out.
   May use: base, solve/lcp. */
#ifndef MG_SOLVE_FRICTION_SOLVERS_H
#define MG_SOLVE_FRICTION_SOLVERS_H

#include "base/base.h"
#include "solve/friction/friction.h"

typedef struct {
  const mg_friction_problem *given;
  int n, m, n_part;      /* contacts, rows kept, parts */
  int n_bilateral, rank; /* of the bilateral rows */
  int *row;              /* per kept row: the row of the problem */
  int *normal, *part;    /* per contact: kept row of N; first part (n + 1) */
  int *part_row, *part_dim, *part_mark;
  int *bilateral, *order; /* rows of the problem; how they were pivoted */
  int *iwork;
  mg_real *e, *rho; /* per kept row; per part: mean of S_tt */
  mg_real *S, *c;
  mg_real *y, *v, *best; /* the candidate and its v; the best so far */
  mg_real *e_b, *L, *X;  /* bilateral rows: scale, Cholesky factor, A_bb^-1 (A_bc, b_b) */
  mg_real *spare, *work; /* rows of a start, 5 m; scratch of one step */
  mg_real scale, theta;  /* v_n counts as v_n - theta sum |v_t|: 0 Coulomb, 1 relaxed */
  mg_real residual;      /* of best */
  int sweeps, newton;
} mg_scaled_friction;

enum { MG_PATHS = 20 };

/* certificate.c */
MG_INTERNAL mg_real mg_friction_norm(int k, const mg_real *x);
MG_INTERNAL mg_real mg_friction_slack(const mg_scaled_friction *s, int contact);
MG_INTERNAL mg_real mg_friction_error(const mg_scaled_friction *s);
MG_INTERNAL void mg_friction_motion(mg_scaled_friction *s);
MG_INTERNAL mg_real mg_friction_tolerance(const mg_scaled_friction *s, const mg_real *y);
MG_INTERNAL int mg_friction_keep(mg_scaled_friction *s);
MG_INTERNAL mg_real mg_friction_certify(const mg_friction_problem *p, const mg_real *z, mg_real *growth);
MG_INTERNAL int mg_friction_impossible(mg_scaled_friction *s);
MG_INTERNAL void mg_friction_tell(mg_scaled_friction *s, int strict, mg_friction_report *report);

/* scaled_problem.c */
MG_INTERNAL int mg_friction_end_of(const mg_scaled_friction *s, int contact);
MG_INTERNAL int mg_friction_layout(mg_scaled_friction *s, const mg_friction_problem *problem, mg_real *work,
                                   int *iwork);
MG_INTERNAL int mg_friction_scale(mg_scaled_friction *s);
MG_INTERNAL void mg_friction_take(mg_scaled_friction *s, const mg_real *z);
MG_INTERNAL void mg_friction_give(const mg_scaled_friction *s, const mg_real *y, mg_real *z);

/* gauss_seidel.c */
MG_INTERNAL int mg_friction_sweep(mg_scaled_friction *s, int sweeps);

/* semismooth_newton.c */
MG_INTERNAL int mg_friction_newton(mg_scaled_friction *s, int limit, int augmented);

/* interior_point.c */
MG_INTERNAL void mg_friction_interior(mg_scaled_friction *s, const mg_real *shift, mg_real gap);

/* homotopy.c */
MG_INTERNAL int mg_friction_follow(mg_scaled_friction *s, int which);

/* least_norm.c */
MG_INTERNAL int mg_friction_even(mg_scaled_friction *s, const int *marks, mg_friction_report *report);

#endif
