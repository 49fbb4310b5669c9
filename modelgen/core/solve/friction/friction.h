/* Contacts with friction at one instant. Unknowns are forces z and accelerations w (or impulses and velocities) with
   w = A z + b. At each contact with force (N, f) and relative motion (w_n, w_t) Signorini's condition and Coulomb's law
   hold:
     0 <= N, 0 <= w_n, N w_n = 0;   |f / mu| <= N, f / mu = -N (mu w_t) / |mu w_t| where w_t is not 0.
   mu is applied axis by axis, so that cones may be elliptic. Torques of spinning and rolling resistance obey the same
   law, with lengths in place of mu. Rows that belong to no contact are bilateral: w = 0, any force. A is column-major,
   n by n, and need be neither symmetric nor regular. */
#ifndef MG_FRICTION_H
#define MG_FRICTION_H

#include "base/real.h"

/* Law of friction. */
enum {
  MG_COULOMB = 0, /* the law above */
  MG_RELAXED = 1  /* w_n is replaced by w_n - |mu w_t| - ..; for a symmetric A the solution is the optimum of the convex
                     program min z'Az/2 + b'z over the cones (Anitescu and Tasora, Comput. Optim. Appl. 47 (2010),
                     207-235). It agrees with Coulomb's law for contacts that stick, or open faster than mu |w_t|; all
                     others separate at mu |w_t| */
};

enum { MG_CONE = 4 }; /* coefficients of a contact: mu along t1, along t2; spinning resistance, rolling resistance, m */

/* A problem. */
typedef struct {
  int n;               /* rows */
  int n_contact;       /* contacts */
  int law;             /* MG_COULOMB or MG_RELAXED */
  int wants_rank;      /* 1: rank, active and unique are reported, and forces that are not unique have least norm */
  const int *first;    /* [n_contact] row of N; the other rows of the contact follow it */
  const int *rows;     /* [n_contact] 1: N; 3: N, t1, t2; 6: N, t1, t2, spin about N, rolling about t1, t2 */
  const mg_real *cone; /* [MG_CONE n_contact] coefficients, >= 0; 0: no force along that row; those of rows that the
                          contact lacks are not read */
  const mg_real *A;    /* [n n] matrix, column-major */
  const mg_real *b;    /* [n] right-hand side */
  int max_starts;      /* bound of the starting points, 0: all that are known; one may take a hundred times as long as
                          the first */
  mg_real accepted;    /* a residual within it, or within a quarter of MG_LCP_CAP, is a solution once Newton steps no
                          longer halve the merit, and Newton's method is tried again only after progress; 0: only a
                          thousand roundings are, and Newton steps go on while they reduce them */
  const int *stop;     /* [1] or null; 1, also set by another thread during the solve: it ends soon, NOT_FOUND */
  int from_last;       /* 1: sweeps over the contacts begin with the last one */
  mg_real near;   /* on a graph: from this residual on, a round of sweeps and Newton steps that does not halve it is
                     the last one */
  int newton_max; /* after so many Newton steps it ends, NOT_FOUND unless solved; 0: no bound */
} mg_friction_problem;

/* Outcome of mg_friction. */
enum {
  MG_FRICTION_SOLVED = 0,
  MG_FRICTION_INFEASIBLE = 1, /* proved: no forces make every normal row of w >= 0 and every bilateral row 0 */
  MG_FRICTION_NOT_FOUND = 2,  /* every starting point failed; there may be no solution */
  MG_FRICTION_NOT_FINITE = 3  /* the data are not finite, or a coefficient is negative */
};

/* Marks of a contact in a solution; 0: it opens. */
enum {
  MG_MARK_FORCE = 1, /* it carries a normal force */
  MG_MARK_SLIP = 2,  /* it slips */
  MG_MARK_SPIN = 4,  /* it spins about N */
  MG_MARK_ROLL = 8   /* it rolls */
};

/* Uniqueness of the forces. */
enum {
  MG_UNDECIDED = -1, /* not known */
  MG_NOT_UNIQUE = 0, /* other forces give the same w */
  MG_UNIQUE = 1      /* proved for every b */
};

typedef struct {
  int outcome;      /* MG_FRICTION_SOLVED .. MG_FRICTION_NOT_FINITE */
  int sweeps;       /* Gauss-Seidel sweeps */
  int newton;       /* Newton steps */
  int starts;       /* starting points tried */
  int rank;         /* rank of A on the directions in which forces may change */
  int active;       /* number of these directions */
  int unique;       /* MG_UNDECIDED, MG_NOT_UNIQUE or MG_UNIQUE */
  mg_real residual; /* mg_friction_residual of z */
} mg_friction_report;

/* A solver that stands in for those of the core. `solve` has the arguments and the result of mg_friction without its
   memory; `of` is passed through. What it reports as SOLVED is taken as the solution, with its residual. */
typedef struct {
  int (*solve)(void *of, const mg_friction_problem *problem, mg_real *z, int *marks, mg_friction_report *report);
  void *of;
  int number; /* tells this solver from others where a state that was saved is loaded */
} mg_outer_solver;

/* Length of `work` for n rows and n_contact contacts, in mg_real. */
MG_API long long mg_friction_work_size(int n, int n_contact);

/* Length of `iwork` for n rows and n_contact contacts, in int. */
MG_API long long mg_friction_iwork_size(int n, int n_contact);

/* Solves a problem. z [n]: a guess on entry (zeros if there is none), the forces on return, or the best found. marks
   [n_contact] receives the marks of the contacts. Returns the outcome; SOLVED is never returned with a residual above
   1e-9 (1e-3 in float, 1e-12 in long double) and above `accepted`. Block Gauss-Seidel (Jourdan, Alart and Jean, Comput.
   Methods Appl. Mech. Eng. 155 (1998), 31-47) and a semismooth Newton method on the natural map (Alart and Curnier,
   ibid. 92 (1991), 353-375), from other starting points where these fail. */
MG_API int mg_friction(const mg_friction_problem *problem, mg_real *z, int *marks, mg_friction_report *report,
                       mg_real *work, int *iwork);

/* The rows of a problem by the two bodies on which each of them acts: A = J M^-1 J' + the diagonal matrix of yields. */
typedef struct {
  int n_body;
  const int *place;      /* [n] place of a row in J and MJ */
  const int *body;       /* [2 n] its bodies, -1: none, or one that forces do not move */
  const mg_real *J, *MJ; /* [12 per place] J by body, and M^-1 J' */
  const mg_real *yield;  /* [n] what is added to its diagonal; that of rows of contacts is 0 */
} mg_friction_graph;

enum { MG_SMALL_PROBLEM = 24 }; /* rows up to which the matrix of a problem is cheaper than its graph */

/* Length of `work` and `iwork` of mg_friction_on_graph. */
MG_API long long mg_friction_graph_work_size(int n, int n_contact, int n_body);
MG_API long long mg_friction_graph_iwork_size(int n, int n_contact, int n_body);

/* Solves a problem by its graph, without A, which is not read: memory grows with the rows, and so does the cost of a
   sweep; that of a Newton step grows with the fill of the graph. As mg_friction, but that infeasibility is not proved,
   rank, active and unique are not reported, and the starting points after the first come from an interior-point method
   for Coulomb's law itself, then from fixed points of the convex program. z holds the best forces found, and their
   residual is in the report. Where the fill is more than eight pairs per contact and body, there are sweeps alone, from
   the first. */
MG_API int mg_friction_on_graph(const mg_friction_problem *problem, const mg_friction_graph *graph, mg_real *z,
                                int *marks, mg_friction_report *report, mg_real *work, int *iwork);

/* Residual of any z [n], the certificate of all solvers: the largest of
     normal     |min(N d, w_n / d)|,                                d = sqrt(A_nn),
     tangential |f/mu - P_N(f/mu - mu w_t / a)| sqrt(a),            a the mean of mu A_tt mu over the axes; P_N projects
                                                                    on the disc |.| <= N,
     bilateral  |w| / d,
   over the largest of |b_n| / d, |mu b_t| / sqrt(a), |b| / d. It does not depend on units, nor for mu1 = mu2 on the
   direction of t1, t2. */
MG_API mg_real mg_friction_residual(const mg_friction_problem *problem, const mg_real *z);

enum { MG_SCATTERED_STARTS = 8 }; /* sizes of the forces of scattered starts, which come in turn */

/* Replaces the forces z [n] of a solution by starting forces number `which` >= 0, from which mg_friction may find
   another one: none, or forces scattered within the cones, 0.3 to 100 times as large as those of the solution (what
   only a preload could be). The same for the same problem and number. */
MG_API void mg_scatter_friction_start(const mg_friction_problem *problem, int which, mg_real *z);

#endif
