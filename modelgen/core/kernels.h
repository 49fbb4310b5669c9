/* The interface between the core and the generated kernels of one scene.

   Bodies, contacts, joints, loads and shapes have kinds. A kind is what several of them have in common apart from
   numbers; it has generated functions, its kernels. The tables below give the sizes of each kind. For each task there
   is one function that dispatches on the number of the kind and calls the kernel of that kind. Generated code fills an
   mg_kernels; the core reaches it through mg_system. Kernels have no state: they read their arguments and write their
   results. A kernel that a kind does not need is absent; its results are then left as they were.

   Poses are 12 numbers (position, rotation matrix by columns), twists 6 (velocity, world axes; angular velocity, body
   axes), wrenches 6 (force, world axes; torque about the centre of mass, body axes). Vectors are in world axes, if
   nothing else is said; units are SI. */
#ifndef MG_KERNELS_H
#define MG_KERNELS_H

#include "base/taylor_models.h"
#include "base/real.h"

#define MG_JOINT_ROWS_MAX 6 /* most rows of a joint */

/* Motion of a body. The order matters: bodies from MG_POINT on are moved by forces. */
enum {
  MG_FIXED = 0,  /* does not move */
  MG_DRIVEN = 1, /* moves on a prescribed path, a function of time */
  MG_POINT = 2,  /* a point mass: q = position (3), u = velocity (3); its axes do not turn */
  MG_FREE = 3    /* a rigid body: q = position (3) and quaternion (4), u = twist (6) */
};

/* Shapes whose nearest point to a given point is known in closed form. */
enum {
  MG_NEAREST_PLANE = 1, /* a plane */
  MG_NEAREST_SPHERE = 2 /* a sphere about the origin of its axes */
};

/* Curves from which all points of a shape have the same distance, in its axes. */
enum {
  MG_SPINE_LINE = 1,   /* the third axis: a cylinder, or that line */
  MG_SPINE_CIRCLE = 2, /* a circle about the third axis through the origin: a torus, or that circle */
  MG_SPINE_POINT = 3   /* the origin: a sphere */
};

/* Parametrisation: what describes the contact point of one feature in eta, and how many entries that takes. */
enum {
  MG_NONE = 0,         /* 0: the point follows from the poses */
  MG_LOCAL = 1,        /* 3: coordinates in the axes of the shape, m */
  MG_CHART = 2,        /* 2: chart coordinates (u, v) of a surface */
  MG_CURVE = 3,        /* 1: parameter of a curve */
  MG_SIGNED_CURVE = 4, /* 3: parameter of the curve, and two signs that select N of two curves */
  MG_SIGN = 5,         /* 1: a sign that selects N of two straight edges */
  MG_TURN = 6          /* 1: of a limit of a joint, its angle, with whole turns counted, rad */
};

typedef struct {
  int motion;       /* MG_FIXED .. MG_FREE */
  int n_q;          /* position coordinates */
  int n_u;          /* velocity coordinates */
  int n_parameters; /* parameters; of a fixed body its pose (12) */
} mg_body_kind;

typedef struct {
  int n_o, n_f;                             /* columns of J for body o and for body f: 6, 3 (point mass) or 0 */
  int n_eta;                                /* entries of eta */
  int n_parameters;                         /* parameters */
  int parametrisation_o, parametrisation_f; /* MG_NONE .. MG_TURN, of features o and f; eta has o's entries first */
  int is_convex;                            /* 1: both shapes are convex, contact_aim and contact_seek know the kind */
  int rows;                                 /* 1: N; 3: N, t1, t2; 6: N, t1, t2, spin about N, rolling about t1, t2 */
} mg_contact_kind;

typedef struct {
  int n_parameters;     /* parameters */
  int depends_on_time;  /* 1: on time, in a way that samples of a step may not show */
  int depends_on_state; /* 1: on pose and velocity of its bodies, in a way that samples of a step may not show */
  int is_spring;        /* 1: a spring with a damper; its last parameters are stiffness, damping, rest */
  int n_switch;         /* switching functions; 0: the load is smooth */
} mg_load_kind;

typedef struct {
  int n_rows;        /* scalar equations */
  int n_coordinates; /* coordinates, 0..3 */
  int prescribed;    /* 1: its rows depend on time, so that it does work */
  int n_parameters;  /* parameters of its rows */
  int n_inertial;    /* rows of armature, the last of n_rows: J is that of a coordinate's rate times sqrt(I) */
} mg_joint_kind;

typedef struct {
  int dimension;     /* 2 surface, 1 curve, 0 point */
  int nearest_point; /* MG_NEAREST_PLANE, MG_NEAREST_SPHERE or 0 */
  int may_inflect;   /* 1: a curve that may have inflections */
  int spine;         /* MG_SPINE_LINE .. or 0 */
  int flat;          /* 1: a plane with its exterior along z, an edge along x, or a point; -1: a plane with its exterior
                        against z; 0: others */
} mg_shape_kind;

/* What a derivative of a formula is for. Each formula is packed as y(w, x) (modelgen/differentiation.py): w is not
   differentiated. Vectors in brackets, one after the other, each at its full size. */
enum {
  MG_TASK_POSE = 0,      /* x = [q 7], y = [pose 12] */
  MG_TASK_PATH = 1,      /* x = [t, parameters, inputs], y = [pose 12, twist 6, rate of the twist 6] */
  MG_TASK_MOTION = 2,    /* x = [q 7, u 6, wrench 6, gravity 3, parameters], y = [q_dot 7, u_dot 6] */
  MG_TASK_LOAD = 3,      /* w = [branch, quaternion], x = [t, pose a 12, twist a 6, pose b 12, twist b 6, parameters,
                            inputs], y = [wrenches of a, b 12] */
  MG_TASK_CONTACT = 4,   /* w = [forces of the rows 6, accelerations of o, f 12], x = [pose o 12, twist o 6, pose f 12,
                            twist f 6, eta, parameters], y = [J^T force 12, J a + gamma 6, J u 6, d, t1, t2, eta_dot] */
  MG_TASK_PLACEMENT = 5, /* x = [pose o 12, pose f 12, eta, parameters], y = [d, eta_next] */
  MG_TASK_JOINT = 6,     /* w as of a contact, x = [t, pose a 12, twist a 6, pose b 12, twist b 6, parameters, inputs],
                            y = [J^T force 12, value_ddot 6, value_dot 6, value 6] */
  MG_TASK_SENSORS = 7,   /* x = [t, pose, twist, accel, pairs, joints, gravity, parameters, inputs] of `sense`, y =
                            [sensors] */
  MG_TASK_SCENE = 8      /* x = [q, u, eta, gravity, parameters], y = [q_dot, u_dot, eta_dot] of `scene_rhs`, which
                            does not depend on time; adjoint alone */
};

/* Derivatives of the formulas of a scene. */
typedef struct {
  /* y_dot = dy/dx x_dot */
  void (*tangent)(int task, int kind, const mg_real *w, const mg_real *x, const mg_real *x_dot, mg_real *y_dot);

  /* Of `scene_rhs`, x = [q, u, eta]; 0: not generated. */
  void (*scene_tangent)(const mg_real *x, const mg_real *gravity, const mg_real *parameters, const mg_real *x_dot,
                        const mg_real *gravity_dot, const mg_real *parameters_dot, mg_real *slope_dot);

  /* x_bar = (dy/dx)^T y_bar */
  void (*adjoint)(int task, int kind, const mg_real *w, const mg_real *x, const mg_real *y_bar, mg_real *x_bar);
} mg_derivatives;

typedef struct {
  int abi;                              /* MG_ABI of the header with which the table was compiled */
  int real_size;                        /* sizeof(mg_real) with which the table was compiled */
  const char *hash;                     /* content hash of the library */
  int n_sensor;                         /* components of all sensors of the scene */
  int sensors_need_forces;              /* 1: sensors show accelerations, gaps, forces or torques of joints */
  const mg_body_kind *body_kinds;       /* by number of the kind */
  const mg_contact_kind *contact_kinds; /* by number of the kind */
  const mg_joint_kind *joint_kinds;     /* by number of the kind */
  const mg_load_kind *load_kinds;       /* by number of the kind */
  const mg_shape_kind *shape_kinds;     /* by number of the kind */

  /* By number of the kind of shape: functions of chart coordinates or of the curve parameter, in the axes of the shape,
     that a search bounds over cells. Of a surface 12 numbers: x, m; exterior unit normal n; the symmetric matrix W with
     dn = W dx (xx, yy, zz, xy, xz, yz), 1/m. Of a curve 9: x, m; unit tangent; curvature vector, 1/m. Empty where no
     search needs it. */
  const mg_bounds_program *shape_bounds;

  /* Pose of a free body from q. */
  void (*body_pose)(int kind, const mg_real *q, mg_real *pose);

  /* Equations of motion of a body without constraints: q_dot [n_q], u_dot [n_u] under a wrench and gravity (3). */
  void (*body_motion)(int kind, const mg_real *q, const mg_real *u, const mg_real *wrench, const mg_real *gravity,
                      const mg_real *parameters, mg_real *qdot, mg_real *udot);

  /* Kinetic and potential energy, J, momentum (3), kg m/s, and angular momentum about the centre of mass (3),
     kg m^2/s. */
  void (*body_energy)(int kind, const mg_real *q, const mg_real *u, const mg_real *gravity, const mg_real *parameters,
                      mg_real *kinetic, mg_real *potential, mg_real *momentum, mg_real *spin);

  /* Pose, twist and rate of the twist (6) of a driven body at time t. `inputs`, here and below: the settings of all
     inputs (3 each: value, its rate, 1/s, and the time at which the input had that value, s). */
  void (*body_path)(int kind, const mg_real *t, const mg_real *parameters, const mg_real *inputs, mg_real *pose,
                    mg_real *twist, mg_real *accel);

  /* Wrenches of a load on its bodies a and b; of a load on one body, only on a. */
  void (*load_wrench)(int kind, const mg_real *t, const mg_real *pose_a, const mg_real *twist_a, const mg_real *pose_b,
                      const mg_real *twist_b, const mg_real *parameters, const mg_real *inputs, mg_real *wrench_a,
                      mg_real *wrench_b);

  /* The same of a load with switching functions on its branches: branch [n_switch], 1 where a function is positive, -1
     where it is negative, 0 where it stays zero. A wrench is smooth as long as the branches stay, also beyond the
     zeros. `quaternion`, here and below: that of body a, of which only the sign counts. */
  void (*load_branch)(int kind, const mg_real *t, const mg_real *pose_a, const mg_real *twist_a, const mg_real *pose_b,
                      const mg_real *twist_b, const mg_real *parameters, const mg_real *inputs, const mg_real *branch,
                      const mg_real *quaternion, mg_real *wrench_a, mg_real *wrench_b);

  /* Switching functions of a load [n_switch], each on the branches of those before it; gradient by t, pose and
     twist of a and of b (12, 6, 12, 6) and the parameters, row after row, and by the inputs; second_rate [2 n_switch]:
     1 for a function of t and poses alone, whose second rate without accelerations follows; else 0. */
  void (*load_switches)(int kind, const mg_real *t, const mg_real *pose_a, const mg_real *twist_a,
                        const mg_real *pose_b, const mg_real *twist_b, const mg_real *parameters, const mg_real *inputs,
                        const mg_real *branch, const mg_real *quaternion, mg_real *switching, mg_real *gradient,
                        mg_real *input_gradient, mg_real *second_rate);

  /* Of a spring: how far its length, or the coordinate of its joint, is from rest, m or rad; J (12) of the rate of this
     deflection, the columns of a, then of b. Its force along J is -stiffness deflection - damping J u. */
  void (*load_deflection)(int kind, const mg_real *pose_a, const mg_real *pose_b, const mg_real *parameters,
                          mg_real *deflection, mg_real *J);

  /* Rows of a joint, equation (2.3): value [n_rows], m or rad; J [12 n_rows], per row the columns of a, then of b;
     gamma [n_rows], Gamma1; bias [n_rows], partial derivative by time. value_dot = J u + bias, value_ddot = J u_dot +
     gamma. */
  void (*joint_rows)(int kind, const mg_real *t, const mg_real *pose_a, const mg_real *twist_a, const mg_real *pose_b,
                     const mg_real *twist_b, const mg_real *parameters, const mg_real *inputs, mg_real *value,
                     mg_real *J, mg_real *gamma, mg_real *bias);

  /* Coordinates of a joint [n_coordinates], m or rad. */
  void (*joint_coordinates)(int kind, const mg_real *pose_a, const mg_real *pose_b, const mg_real *parameters,
                            mg_real *coordinate);

  /* Point (3) of a shape, in its axes, at chart coordinates or curve parameter uv (2); direction (3): exterior unit
     normal of a surface, tangent of any length of a curve, nothing of a point. */
  void (*shape_point)(int kind, const mg_real *uv, const mg_real *parameters, mg_real *point, mg_real *direction);

  /* Rates of a contact at its closest points (eta must solve the extremality equations): gap d; per row of the kind the
     columns of J for o [n_o] and f [n_f] and the velocity term gamma, d_ddot = J u_dot + gamma; eta_dot [n_eta]; N
     (3); t1, t2 (6), for kinds with 3 or 6 rows only. */
  void (*contact_rates)(int kind, const mg_real *pose_o, const mg_real *twist_o, const mg_real *pose_f,
                        const mg_real *twist_f, const mg_real *eta, const mg_real *parameters, mg_real *d, mg_real *J_o,
                        mg_real *J_f, mg_real *gamma, mg_real *eta_dot, mg_real *normal, mg_real *tangents);

  /* One Newton step of the extremality equations from eta to eta_next [n_eta], and at eta: d; residual (2), m along and
     off the surfaces, 1 for parallelism of the normals; margin (2), 1 and 1/m, distance from a singularity of these
     equations; N (3); the contact points (3, 3), m. */
  void (*contact_place)(int kind, const mg_real *pose_o, const mg_real *pose_f, const mg_real *eta,
                        const mg_real *parameters, mg_real *eta_next, mg_real *d, mg_real *residual, mg_real *margin,
                        mg_real *normal, mg_real *point_o, mg_real *point_f);

  /* Convex kinds: a normal (3) of any length from which to continue from eta; rounding, m: the separation has a single
     maximum as long as it exceeds -rounding. */
  void (*contact_aim)(int kind, const mg_real *pose_o, const mg_real *pose_f, const mg_real *eta,
                      const mg_real *parameters, mg_real *normal, mg_real *rounding);

  /* Convex kinds, the separation along a unit normal (3): its value d, m; its slope (2) and minus its second derivative
     (3: 11, 12, 22) on the sphere of normals, m, in the tangents (6) there; eta (6): the support points of both shapes
     in their axes. */
  void (*contact_seek)(int kind, const mg_real *pose_o, const mg_real *pose_f, const mg_real *normal,
                       const mg_real *parameters, mg_real *d, mg_real *slope, mg_real *hessian, mg_real *tangents,
                       mg_real *eta);

  /* What the sensors of the scene show [n_sensor], from time, poses, twists and their rates of all bodies, per pair its
     least gap and the sum of its normal forces, per joint its wrench on the second body, and gravity. kind is 0. */
  void (*sense)(int kind, const mg_real *t, const mg_real *pose, const mg_real *twist, const mg_real *accel,
                const mg_real *pairs, const mg_real *joints, const mg_real *gravity, const mg_real *parameters,
                const mg_real *inputs, mg_real *sensors);

  /* Right-hand side of the whole scene in one mode: of each pair the first contact carries force and sticks, no other
     contact is on a feature pair. q_dot, u_dot, eta_dot, and the normal force of each pair [n_pair], then those of the
     friction rows of these contacts and of the rows of joints, N, N m. kind is 0. 0: not generated; only for scenes
     without loads, driven bodies and resting faces, and with no joint or nothing but one. */
  void (*scene_rhs)(int kind, const mg_real *t, const mg_real *q, const mg_real *u, const mg_real *eta,
                    const mg_real *gravity, const mg_real *parameters, mg_real *qdot, mg_real *udot, mg_real *eta_dot,
                    mg_real *force);

  /* A step h of the classical Runge-Kutta method of order 4 with this right-hand side, from x = [q, u, eta] to `end`,
     which may be x; slope: that at x, or 0; force: those of scene_rhs at the four stages, not at the first if its
     slope is given. Present with scene_rhs. */
  void (*scene_step)(const mg_real *t, const mg_real *x, mg_real h, const mg_real *gravity, const mg_real *parameters,
                     const mg_real *slope, mg_real *force, mg_real *end);

  const mg_derivatives *derivatives; /* derivatives of these functions, or 0: they were not generated */
} mg_kernels;

/* Table of the generated library. */
MG_API const mg_kernels *mg_kernel_table(void);

/* Content hash of the generated library. */
MG_API const char *mg_hash(void);

#endif
