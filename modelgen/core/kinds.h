/* The vocabulary: what the generated kinds.c supplies to the core. Sizes by kind, and one dispatcher per role.
   Shapes of the arguments are those of the kernels in the manifest. */
#ifndef MG_KINDS_H
#define MG_KINDS_H

#include "real.h"

enum { MG_FIXED = 0, MG_DRIVEN = 1, MG_POINT = 2, MG_FREE = 3 };

typedef struct {
  int motion; /* MG_FIXED .. MG_FREE */
  int n_q, n_u, n_parameters;
} mg_body_kind;

typedef struct {
  int n_o, n_f; /* columns of J for each side: 6, 3 or 0 */
  int n_eta, n_parameters;
} mg_contact_kind;

typedef struct {
  int n_parameters;
} mg_load_kind;





static void mg_body_pose(int kind, const mg_real *q, mg_real *pose);
static void mg_body_motion(int kind, const mg_real *q, const mg_real *u, const mg_real *wrench,
                           const mg_real *gravity, const mg_real *parameters, mg_real *qdot, mg_real *udot);
static void mg_body_energy(int kind, const mg_real *q, const mg_real *u, const mg_real *gravity,
                           const mg_real *parameters, mg_real *kinetic, mg_real *potential, mg_real *momentum,
                           mg_real *spin);
static void mg_body_path(int kind, const mg_real *t, const mg_real *parameters, mg_real *pose, mg_real *twist,
                         mg_real *accel);
static void mg_load_wrench(int kind, const mg_real *t, const mg_real *pose_a, const mg_real *twist_a,
                           const mg_real *pose_b, const mg_real *twist_b, const mg_real *parameters,
                           mg_real *wrench_a, mg_real *wrench_b);
static void mg_contact_rates(int kind, const mg_real *pose_o, const mg_real *twist_o, const mg_real *pose_f,
                             const mg_real *twist_f, const mg_real *eta, const mg_real *parameters, mg_real *d,
                             mg_real *J_o, mg_real *J_f, mg_real *gamma, mg_real *eta_dot, mg_real *normal);
static void mg_contact_place(int kind, const mg_real *pose_o, const mg_real *pose_f, const mg_real *eta,
                             const mg_real *parameters, mg_real *eta_next, mg_real *d, mg_real *residual,
                             mg_real *margin, mg_real *normal, mg_real *point_o, mg_real *point_f);

#endif
