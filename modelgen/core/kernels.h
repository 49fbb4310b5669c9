/* The interface between the core and the generated kernels of one scene: sizes by kind, and one function per role
   that dispatches on the kind. Generated code fills the table; the core calls it through mg_system. The manifest
   lists the shapes of the arguments. */
#ifndef MG_KERNELS_H
#define MG_KERNELS_H

#include "base/real.h"

enum { MG_FIXED = 0, MG_DRIVEN = 1, MG_POINT = 2, MG_FREE = 3 };

enum { MG_NEAREST_PLANE = 1, MG_NEAREST_SPHERE = 2 };

enum {
  MG_NONE = 0,
  MG_LOCAL = 1,
  MG_CHART = 2,
  MG_CURVE = 3,
  MG_SIGNED_CURVE = 4,
  MG_SIGN = 5,
  MG_TURN = 6
}; /* MG_TURN: the angle of a joint, whole turns counted */

typedef struct {
  int motion; /* MG_FIXED .. MG_FREE */
  int n_q, n_u, n_parameters;
} mg_body_kind;

typedef struct {
  int n_o, n_f; /* columns of J for each side: 6, 3 or 0 */
  int n_eta, n_parameters;
  int parametrisation_o, parametrisation_f; /* what carries the points in eta: MG_NONE .. */
  int is_convex;                            /* both shapes are convex: mg_contact_aim and mg_contact_seek know it */
  int rows;                                 /* 1: N; 3: and t1, t2; 6: and spin about N, rolling about t1, t2 */
} mg_contact_kind;

typedef struct {
  int n_parameters;
  int depends_on_time,
      depends_on_state; /* it depends on time, on where its body is and how it moves, and samples may not show how */
} mg_load_kind;

typedef struct {
  int n_rows, n_coordinates;
  int prescribed; /* its rows depend on time: it does work */
} mg_joint_kind;

typedef struct {
  int dimension;     /* 2 surface, 1 curve, 0 point */
  int nearest_point; /* MG_NEAREST_PLANE, MG_NEAREST_SPHERE: the nearest point of a plane, of a sphere about its origin;
                        else 0 */
  int may_inflect;   /* a curve that may have inflections */
} mg_shape_kind;

typedef struct {
  int abi;          /* MG_ABI of the header that the table was compiled with */
  int real_size;    /* sizeof(mg_real), likewise */
  const char *hash; /* content hash of the library */
  const mg_body_kind *body_kinds;
  const mg_contact_kind *contact_kinds;
  const mg_joint_kind *joint_kinds;
  const mg_load_kind *load_kinds;
  const mg_shape_kind *shape_kinds;
  void (*body_pose)(int kind, const mg_real *q, mg_real *pose);
  void (*body_motion)(int kind, const mg_real *q, const mg_real *u, const mg_real *wrench, const mg_real *gravity,
                      const mg_real *parameters, mg_real *qdot, mg_real *udot);
  void (*body_energy)(int kind, const mg_real *q, const mg_real *u, const mg_real *gravity, const mg_real *parameters,
                      mg_real *kinetic, mg_real *potential, mg_real *momentum, mg_real *spin);
  void (*body_path)(int kind, const mg_real *t, const mg_real *parameters, mg_real *pose, mg_real *twist,
                    mg_real *accel);
  void (*load_wrench)(int kind, const mg_real *t, const mg_real *pose_a, const mg_real *twist_a, const mg_real *pose_b,
                      const mg_real *twist_b, const mg_real *parameters, mg_real *wrench_a, mg_real *wrench_b);
  void (*joint_rows)(int kind, const mg_real *t, const mg_real *pose_a, const mg_real *twist_a, const mg_real *pose_b,
                     const mg_real *twist_b, const mg_real *parameters, mg_real *value, mg_real *J, mg_real *gamma,
                     mg_real *bias); /* J: 12 a row, a then b */
  void (*joint_coordinates)(int kind, const mg_real *pose_a, const mg_real *pose_b, const mg_real *parameters,
                            mg_real *coordinate);
  void (*shape_point)(int kind, const mg_real *uv, const mg_real *parameters, mg_real *point,
                      mg_real *direction); /* exterior normal, tangent of any length, or nothing */
  void (*contact_rates)(int kind, const mg_real *pose_o, const mg_real *twist_o, const mg_real *pose_f,
                        const mg_real *twist_f, const mg_real *eta, const mg_real *parameters, mg_real *d, mg_real *J_o,
                        mg_real *J_f, mg_real *gamma, mg_real *eta_dot, mg_real *normal,
                        mg_real *tangents); /* J: n_o, n_f a row; tangents: with 3 or 6 rows only */
  void (*contact_place)(int kind, const mg_real *pose_o, const mg_real *pose_f, const mg_real *eta,
                        const mg_real *parameters, mg_real *eta_next, mg_real *d, mg_real *residual, mg_real *margin,
                        mg_real *normal, mg_real *point_o, mg_real *point_f);
  void (*contact_aim)(int kind, const mg_real *pose_o, const mg_real *pose_f, const mg_real *eta,
                      const mg_real *parameters, mg_real *normal, mg_real *rounding);
  void (*contact_seek)(int kind, const mg_real *pose_o, const mg_real *pose_f, const mg_real *normal,
                       const mg_real *parameters, mg_real *d, mg_real *slope, mg_real *bend, mg_real *tangents,
                       mg_real *eta);
} mg_kernels;

/* The generated library defines these: its table, and its content hash. */
MG_API const mg_kernels *mg_kernel_table(void);
MG_API const char *mg_hash(void);

#endif
