/* Contacts with friction at one instant: forces z and accelerations (or impulses and velocities) w = A z + b.
   Coulomb's law at each contact, with force (N, f) and relative motion (w_n, w_t):
     0 <= N, 0 <= w_n, N w_n = 0;   |f / mu| <= N, f / mu = -N (mu w_t) / |mu w_t| where w_t is not 0;
   mu is applied axis by axis, so that cones may be elliptic. Spinning torque and rolling torque obey the same law
   with their own lengths for mu. A matrix is column-major, n by n, and need not be symmetric or regular. */
#ifndef MG_FRICTION_H
#define MG_FRICTION_H

#include "base/real.h"

/* MG_COULOMB is the law above. MG_RELAXED replaces w_n by w_n - |mu w_t| - ..: for symmetric A the optimum of the
   convex program min z'Az/2 + b'z over the cones (Anitescu and Tasora, Comput. Optim. Appl. 47 (2010), 207-235). It is
   exact for contacts that stick, or open faster than mu |w_t|; all others move off at mu |w_t|. */
enum { MG_COULOMB = 0, MG_RELAXED = 1 };

enum { MG_CONE = 4 }; /* mu along t1, along t2; spinning resistance, rolling resistance, m */

typedef struct {
  int n, n_contact;
  int law;               /* MG_COULOMB or MG_RELAXED */
  int wants_rank;        /* rank, active and unique are wanted, and of forces that are not unique those of least norm */
  const int *first;      /* per contact: row of N; other rows of the contact follow it */
  const int *rows;       /* per contact: 1 N; 3 and t1, t2; 6 and spin about N, rolling about t1, t2 */
  const mg_real *cone;   /* MG_CONE a contact, >= 0; entries without rows are not read; 0: no force along that row */
  const mg_real *A, *b;  /* rows that belong to no contact are bilateral: w = 0, any force */
  int max_starts;        /* starting points at most, 0: all that are known; each may take a hundred times the first */
  int accepts_tolerance; /* a solution within the tolerance will do, which is a thousand roundings: its last digits cost
                            a step */
} mg_friction_problem;

enum {
  MG_FRICTION_SOLVED = 0,
  MG_FRICTION_INFEASIBLE = 1, /* proved: no forces whatever let every normal row be >= 0, every bilateral one 0 */
  MG_FRICTION_NOT_FOUND = 2,  /* every start failed: there may be no solution */
  MG_FRICTION_NOT_FINITE = 3
};

enum { MG_MARK_FORCE = 1, MG_MARK_SLIP = 2, MG_MARK_SPIN = 4, MG_MARK_ROLL = 8 }; /* marks of a contact; none: open */

enum { MG_UNDECIDED = -1, MG_NOT_UNIQUE = 0, MG_UNIQUE = 1 };

typedef struct {
  int outcome;                /* MG_FRICTION_.. */
  int sweeps, newton, starts; /* Gauss-Seidel sweeps, Newton steps, starting points tried */
  int rank, active;           /* rank of A on the directions in which forces may grow, and their number */
  int unique;       /* of the forces: MG_UNIQUE is proved for every b, MG_NOT_UNIQUE where others give the same w */
  mg_real residual; /* mg_friction_residual of z */
} mg_friction_report;

/* Reals and ints of scratch for n rows and n_contact contacts. */
MG_API int mg_friction_work_size(int n, int n_contact);
MG_API int mg_friction_iwork_size(int n, int n_contact);

/* z: a guess on entry (zeros if none), the forces on return, or the best found. marks (n_contact): what each contact
   does, e.g. MG_MARK_FORCE | MG_MARK_SLIP. SOLVED is never said of a residual above 1e-9 (1e-3 in float, 1e-12 in long
   double). Block Gauss-Seidel (Jourdan, Alart, Jean, Comput. Methods Appl. Mech. Eng. 155 (1998), 31-47) and a
   semismooth Newton method on the natural map (Alart and Curnier, ibid. 92 (1991), 353-375), from other starts where
   these fail. */
MG_API int mg_friction(const mg_friction_problem *problem, mg_real *z, int *marks, mg_friction_report *report,
                       mg_real *work, int *iwork);

/* The certificate, the same for every solver: the largest of
     normal     |min(N d, w_n / d)|,                        d = sqrt(A_nn)
     tangential |f/mu - P_N(f/mu - mu w_t / a)| sqrt(a),    a the mean of mu A_tt mu over the axes; P_N projects on |.|
   <= N bilateral  |w| / d over the largest of |b_n| / d, |mu b_t| / sqrt(a), |b| / d. No unit and no turn of t1, t2
   (mu1 = mu2) changes it. */
MG_API mg_real mg_friction_residual(const mg_friction_problem *problem, const mg_real *z);

#endif
