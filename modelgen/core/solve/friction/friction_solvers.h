/* What the solvers of friction problems share: the scaled form and its residual. Bilateral rows are eliminated; on a
   graph they follow the others as free rows. The solvers work on y = z / (e scale) and v = S y + c, with e_n = 1 /
   sqrt(A_nn) and e_t = mu e_n, so that every cone is |y_t| <= y_n and S_nn = 1. A part of a contact is a disc of
   forces: slip (2 rows), spin (1) or rolling (2). Rows with mu = 0 carry no force and are left out. May use: base,
   solve/lcp. */
#ifndef MG_SOLVE_FRICTION_SOLVERS_H
#define MG_SOLVE_FRICTION_SOLVERS_H

#include "base/base.h"
#include "solve/friction/friction.h"

enum {
  MG_ROWS = 6,       /* most rows of a contact */
  MG_BLOCK_SIZE = 36 /* entries of a block of 6 by 6, by columns */
};

/* A system whose matrix has blocks of 6 by 6: on the diagonal for each body, and two for each pair of bodies that act
   on each other, or come to do so as others are eliminated. */
typedef struct {
  int n, words;           /* bodies; words of a row of `adjacency` */
  int capacity;           /* of pairs */
  int *adjacency;         /* [n words] bits: which bodies act on each other, of those not eliminated yet */
  int *degree;            /* [n] number of these */
  int *order, *rank;      /* [n] the bodies as they are eliminated, and when each is */
  int *first, *node;      /* [n + 1], [capacity] the bodies on which each acts when it is eliminated, ascending */
  mg_real *diagonal;      /* [36 n] of the factors: inverse */
  mg_real *lower, *upper; /* [36 capacity] block of the later body and the earlier one, and of the earlier and later */
} mg_block_system;

/* Rows by the bodies on which they act: v = J u + yield y + c with the motion u = M^-1 J' y of the bodies. */
typedef struct {
  int n_body;             /* bodies that rows act on and forces move */
  int *body;              /* [2 (m + n_free)] bodies, -1: none that forces move */
  int *number;            /* [bodies of the given problem] number of each here, or -1 */
  mg_real *J, *MJ;        /* [12 (m + n_free)] scaled rows of J and of M^-1 J' */
  mg_real *yield;         /* [m + n_free] what a row yields to its own force */
  mg_real *block;         /* [36 n] S of the rows of each contact, by columns */
  mg_real *motion;        /* [6 n_body] u */
  mg_real *stiffness;     /* [36 n + n_free] of each contact, and of each free row: how its force changes with its v */
  mg_real *push;          /* [m + n_free] by how much its force changes anyway */
  mg_real *step;          /* [6 n_body] change of u in a Newton step */
  mg_block_system system; /* of Newton steps */
  int has_system;         /* 0: its blocks have no room */
} mg_scaled_graph;

typedef struct {
  const mg_friction_problem *given; /* the problem */
  int n;                            /* contacts */
  int m;                            /* rows kept: those of contacts that may carry force */
  int n_part;                       /* parts of all contacts */
  int n_bilateral;                  /* bilateral rows */
  int n_free;                       /* of them, those that follow the kept rows: all on a graph, else none */
  int rank;                         /* rank of the bilateral rows */
  int *row;                         /* [m + n_free] row of the problem */
  int *normal;                      /* [n] kept row of N */
  int *part;                        /* [n + 1] range of parts */
  int *part_row;                    /* [n_part] first kept row */
  int *part_dim;                    /* [n_part] rows */
  int *part_mark;                   /* [n_part] MG_MARK_SLIP, MG_MARK_SPIN or MG_MARK_ROLL */
  int *bilateral;                   /* [n_bilateral] row of the problem */
  int *order;                       /* [n_bilateral] order of pivots */
  int *iwork;                       /* scratch */
  mg_real *e;                       /* [m + n_free] scale of a row */
  mg_real *rho;                     /* [n_part] mean of S_tt */
  mg_real *S, *c;                   /* [m m], [m + n_free] the scaled problem; on a graph S is null */
  mg_real *y, *v;                   /* [m + n_free] candidate and its motion v = S y + c */
  mg_real *best;                    /* [m + n_free] candidate with the least residual so far */
  mg_real *e_b;                     /* [n_bilateral] scale of a bilateral row */
  mg_real *L;                       /* [n_bilateral n_bilateral] Cholesky factor of A_bb */
  mg_real *X;                       /* A_bb^-1 (A_bc, b_b) */
  mg_scaled_graph graph;            /* the rows by bodies, of a problem on a graph */
  mg_real *spare;                   /* [5 m], on a graph [m + n_free] rows that a start keeps */
  mg_real *work;                    /* scratch of one step */
  mg_real scale;                    /* size of c, by which it is divided */
  mg_real theta;                    /* v_n counts as v_n - theta sum |v_t|: 0 Coulomb's law, 1 relaxed */
  mg_real residual;                 /* residual of best */
  int sweeps, newton;               /* sweeps and Newton steps so far */
} mg_scaled_friction;

enum { MG_FRICTION_STARTS = 20 }; /* starting points that mg_friction_try_start knows */

/* scaled_residual.c */

/* Euclidean norm of k = 1 or 2 components. */
MG_INTERNAL mg_real mg_friction_norm(int k, const mg_real *x);

/* |f - P_radius(f - w / rho)| sqrt(rho) of a disc of k rows: natural map of Coulomb's law. */
MG_INTERNAL mg_real mg_friction_disc_error(int k, const mg_real *f, const mg_real *w, mg_real rho, mg_real radius);

/* Sum of |v_t| over the parts of a contact. */
MG_INTERNAL mg_real mg_friction_slip(const mg_scaled_friction *s, int contact);

/* v_n of a contact; of the relaxed law less theta sum |v_t|. */
MG_INTERNAL mg_real mg_friction_slack(const mg_scaled_friction *s, int contact);

/* Residual of y and v. */
MG_INTERNAL mg_real mg_friction_error(const mg_scaled_friction *s);

/* v = S y + c. */
MG_INTERNAL void mg_friction_update_motion(mg_scaled_friction *s);

/* Largest residual of a solution whose forces are `growth` times the right-hand side, in units of the residual:
   MG_LCP_CAP, or four roundings of the terms of S y, which forces of that size cannot undercut; at most
   MG_LCP_ROUNDED. */
MG_INTERNAL mg_real mg_friction_cap(mg_real growth);

/* The same of a solution y, or less, because a thousand roundings are the rule: that of S y grows with y. A quarter of
   the cap is kept in reserve for the return to the given problem. */
MG_INTERNAL mg_real mg_friction_tolerance(const mg_scaled_friction *s, const mg_real *y);

/* Copies y to best if its residual is the least so far. Returns whether best is a solution. */
MG_INTERNAL int mg_friction_update_best(mg_scaled_friction *s);

/* True if the caller asks that the solve end. */
MG_INTERNAL int mg_friction_is_stopped(const mg_scaled_friction *s);

/* True if `best` is a solution by the problem's `accepted`. */
MG_INTERNAL int mg_friction_is_accepted(const mg_scaled_friction *s);

/* friction_certificate.c */

/* Residual of z for the given problem; *growth = largest force over largest right-hand side. */
MG_INTERNAL mg_real mg_friction_certify(const mg_friction_problem *p, const mg_real *z, mg_real *growth);

/* True if no solution exists, proved on the normal rows alone: if u >= 0 on them has u'S u = 0 and u'c < 0, then S
   u = 0 on all rows, and forces along t1, t2 change nothing. An S that is not symmetric (contacts that slide in a
   given direction) is decided only if there are no other rows. */
MG_INTERNAL int mg_friction_is_infeasible(mg_scaled_friction *s);

/* Sets report->unique. `strict`: every force is strictly inside its cone, so that a rank deficiency means that
   there are other forces. */
MG_INTERNAL void mg_friction_report_uniqueness(mg_scaled_friction *s, int strict, mg_friction_report *report);

/* scaled_problem.c */

/* Kept row after the last of a contact. */
MG_INTERNAL int mg_friction_row_end(const mg_scaled_friction *s, int contact);

/* Begins with a problem. */
MG_INTERNAL void mg_friction_open(mg_scaled_friction *s, const mg_friction_problem *problem);

/* Chooses the rows that may carry force, with their coefficients in e, and lists the bilateral ones; owned [n] is
   scratch. Returns 0 if the data are not finite or a coefficient is negative. */
MG_INTERNAL int mg_friction_choose_rows(mg_scaled_friction *s, int *owned);

/* Divides the memory and chooses the rows. Returns 0 if the data are not finite or a coefficient is negative. */
MG_INTERNAL int mg_friction_layout(mg_scaled_friction *s, const mg_friction_problem *problem, mg_real *work,
                                   int *iwork);

/* Largest motion without contact forces, in the units of the residual. */
MG_INTERNAL mg_real mg_friction_size(const mg_scaled_friction *s);

/* Computes S and c. Returns 0 if the scaled data are not finite. */
MG_INTERNAL int mg_friction_scale(mg_scaled_friction *s);

/* y from the forces z of the given problem. */
MG_INTERNAL void mg_friction_scale_guess(mg_scaled_friction *s, const mg_real *z);

/* z of the given problem from y; the bilateral forces are of least norm. */
MG_INTERNAL void mg_friction_unscale(const mg_scaled_friction *s, const mg_real *y, mg_real *z);

/* gauss_seidel.c */

/* Sweeps over the contacts forwards and backwards from y, at most `sweeps`. Returns whether y is a solution. */
MG_INTERNAL int mg_friction_sweep(mg_scaled_friction *s, int sweeps);

/* graph_problem.c */

/* Sets up the scaled problem on its graph. Returns 0 if the data are not finite. */
MG_INTERNAL int mg_graph_set_up(mg_scaled_friction *s, const mg_friction_problem *problem,
                                const mg_friction_graph *graph, mg_real *work, int *iwork);

/* graph_motion.c */

/* Number of rows that have a force: those kept, and the free ones. */
MG_INTERNAL int mg_friction_rows(const mg_scaled_friction *s);

/* J M^-1 J' of rows i and j of one contact. */
MG_INTERNAL mg_real mg_graph_entry(const mg_scaled_graph *g, int i, int j);

/* start + J motion of a row, for a motion of the bodies. */
MG_INTERNAL mg_real mg_graph_row_times(const mg_scaled_graph *g, int row, const mg_real *motion, mg_real start);

/* Adds to a motion of the bodies what the force of a row makes. */
MG_INTERNAL void mg_graph_add_force(const mg_scaled_graph *g, int row, mg_real force, mg_real *motion);

/* The motion of the bodies by forces [m + n_free]. */
MG_INTERNAL void mg_graph_set_motion(const mg_scaled_friction *s, const mg_real *force, mg_real *motion);

/* v of the rows from .. to of a problem on a graph at the present motion of the bodies. */
MG_INTERNAL void mg_graph_update_rows(mg_scaled_friction *s, int from, int to);

/* Solves the free rows one after another. */
MG_INTERNAL void mg_graph_sweep_free_rows(mg_scaled_friction *s, int backwards);

/* graph_newton.c */

/* A Newton step of a problem on a graph: prepared for the present y, then the conditions of each contact, then solved.
   A condition is gy dy + gv dv = -phi for the changes of y and v of the contact, gy and gv by rows of MG_ROWS; a
   contact that does not press gets y = 0. `shift` is added to the diagonal of S. */
MG_INTERNAL void mg_graph_begin_step(mg_scaled_friction *s, mg_real shift);
MG_INTERNAL int mg_graph_add_contact(mg_scaled_friction *s, int contact, int presses, mg_real shift, const mg_real *gy,
                                     const mg_real *gv, const mg_real *phi);

/* The push of contacts of a given stiffness, and of free rows, whose forces change by it times `right` [m + n_free]
   less the change of v. */
MG_INTERNAL void mg_graph_set_push(mg_scaled_friction *s, const mg_real *right);

/* Factors the system of a step that has been prepared. Returns 0 if it is singular. */
MG_INTERNAL int mg_graph_factor_step(mg_scaled_friction *s);

/* Changes `step` of y and `image` of v, [m + n_free]. Returns 0 if they are not finite. */
MG_INTERNAL int mg_graph_solve_step(mg_scaled_friction *s, mg_real *step, mg_real *image);

/* Solves it once more for what is left, by the same factors. */
MG_INTERNAL int mg_graph_refine_step(mg_scaled_friction *s, mg_real *step, mg_real *image);

/* block_system.c */

/* Words of a row of the adjacency of n bodies. */
MG_INTERNAL long long mg_block_words(int n);

/* Begins with n bodies that do not act on each other. */
MG_INTERNAL void mg_block_open(mg_block_system *b, int n);

/* Two bodies act on each other. */
MG_INTERNAL void mg_block_connect(mg_block_system *b, int node, int other);

/* Finds the order of elimination and the blocks. Returns 0 if there are more than `capacity`. */
MG_INTERNAL int mg_block_analyse(mg_block_system *b);

/* Sets the matrix to the identity. */
MG_INTERNAL void mg_block_clear(mg_block_system *b);

/* The block of two bodies, by columns. Needs that they act on each other. */
MG_INTERNAL mg_real *mg_block_at(mg_block_system *b, int row, int column);

/* Factors the matrix. Returns 0 if it is singular. */
MG_INTERNAL int mg_block_factor(mg_block_system *b);

/* Replaces x [6 n] by the solution for x on the right-hand side. */
MG_INTERNAL void mg_block_solve(const mg_block_system *b, mg_real *x);

/* semismooth_newton.c */

/* At most `limit` Newton steps from y; `augmented`: the radius of a disc is y_n - slack instead of y_n. Returns
   whether a solution was found. */
MG_INTERNAL int mg_friction_newton(mg_scaled_friction *s, int limit, int augmented);

/* interior_point.c */

/* Sets y near the optimum of the program, with complementarity `gap` per cone, or to the last point that rounding
   permits. */
MG_INTERNAL void mg_friction_interior(mg_scaled_friction *s, const mg_real *shift, mg_real gap);

/* starting_points.c */

/* Tries starting point number `which`, 0 .. MG_FRICTION_STARTS - 1, the likeliest first. Returns whether a
   solution was found. */
MG_INTERNAL int mg_friction_try_start(mg_scaled_friction *s, int which);

/* least_norm.c */

/* Reports rank and active, and replaces best by the solution of least norm. Returns whether all forces were
   strictly inside their cones. */
MG_INTERNAL int mg_friction_least_norm(mg_scaled_friction *s, const int *marks, mg_friction_report *report);

#endif
