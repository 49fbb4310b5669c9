/* The public interface of the core: multibody dynamics with contact of smooth bodies.

   Equations of motion with contacts as in Anitescu, Cremer and Potra (1995): accelerations and contact forces of one
   state are the solution of (2.6), (2.7); the contact points are described by parameters eta that are part of the
   state. Coulomb friction, impacts, joints and planar contact are treated beside it.

   Use. A program fills
     - an mg_system: bodies, contacts, joints and loads of one scene, as tables over the kinds of the generated library,
     - an mg_settings: method, tolerances and choices,
     - an mg_run: the state and the active set, with arrays for what the run reports,
     - an mg_events and an mg_record: lists for events and samples,
   and allocates mg_work_size mg_real and mg_iwork_size int of scratch memory, of which it sets the first int to 0. It
   calls mg_begin once, then mg_advance as long as that returns MG_CONTINUE (after which it calls again) or MG_LIST_FULL
   (after which it empties the lists and calls again). MG_DONE says that t_stop has been reached. Any other code ends
   the run; failed_contact and failed_joint of run->report then say where. mg_batch does this for many runs of one
   system, mg_begin_many and mg_advance_many for many runs of systems that may differ.

   Memory. The caller owns every structure and every array and keeps them until the call returns; the library allocates
   nothing. Arrays of an mg_system and an mg_settings are read only. The state of a run is its mg_run alone. The scratch
   memory belongs to no run: runs, also of other systems, may take turns on it where it is long enough. It keeps bounds
   of shapes from one search to the next, which are made anew where the shapes are others; no result depends on what it
   holds. Before its first use, and after anything but the library has written to it, its first int is 0, which says
   that it holds no bounds; the rest of it need not be set.

   Threads. There is no global or static state, and nothing is printed or read. Calls in different threads are
   independent if they share nothing but an mg_system and an mg_settings.

   Units and axes. SI units and rad. Vectors are in world axes, except angular velocities and torques, which are in body
   axes. A pose is 12 numbers: position of the centre of mass and the rotation matrix from body to world axes by
   columns. A twist is 6 numbers: velocity and angular velocity. The state is x = [q of all bodies, u of all bodies, eta
   of all contacts, work of all loads and prescribed motions].

   Terms. A contact follows the closest points of one pair of shapes, o and f. Shapes have features (faces, edges,
   vertices); two features that can touch in a point are a feature pair. A contact is on one feature pair at a time, or
   on none; it changes to another feature pair of its pair of shapes where a condition of its feature pair fails. N is
   the unit normal from o to f, d the gap along N, t1 and t2 the tangents.
   A limit of a joint is a contact without shapes, on a feature pair without features and in a pair of its own.
   A friction constraint is one or two rows of a contact whose force is bounded by the normal force.
   A patch is two flat faces that may rest on each other. While they do, a slot holds the patch: three support points,
   which are contacts of points of f with the plane of o, act in both directions, and are on the patch's own three
   feature pairs. In the tables, limits come after all contacts of shapes; feature pairs of patches and contacts of
   slots come last. */
#ifndef MODELGEN_H
#define MODELGEN_H

#include "solve/friction/friction.h"
#include "kernels.h"
#include "solve/lcp/lcp.h"
#include "base/real.h"

#define MG_ABI 28 /* version of these structures; a library and its caller must agree on it (mg_abi) */

/* Kind of a condition of a feature pair. A condition is a function of the contact point x of one feature in its shape's
   axes, of the chart coordinates (u, v) of x, and of the normal N out of that feature's shape. It holds where the
   function is >= 0. a[0], a[1], .. are the condition's numbers. */
enum {
  MG_CONDITION_QUADRIC = 0,   /* a0 + (a1, a2, a3).x + a4 x^2 + a5 y^2 + a6 z^2 + a7 xy + a8 xz + a9 yz, m */
  MG_CONDITION_PARAMETER = 1, /* a1 (w - a2) over the scale of w, with w = u if a0 = 0, w = v if a0 = 1 */
  MG_CONDITION_DISC = 2,      /* (a0^2 - u^2 - v^2) / a0, with a0 the radius */
  MG_CONDITION_WING = 3,      /* -N.(a0 T x z + a1 z) on an edge with unit tangent T; the bracket points into a face */
  MG_CONDITION_DIRECTION = 4, /* -N.(a0, a1, a2) at a vertex; the vector points along an edge */
  MG_CONDITION_TILT = 5, /* a3 (tilt - flat_angle), with tilt the sine of the angle between N and (a0, a1, a2); 2 less
                            that sine where N points against a vector that points out of a flat side (a4 = 1) */
  MG_CONDITION_COAXIAL = 6, /* a6 (1 - r / limit), with r the distance over length of the origin of the other feature's
                            shape from the axis through (a0, a1, a2) along (a3, a4, a5), both in the axes of the
                            body, from its centre of mass; the limit is search_margin if that shape is a sphere,
                            else flat_angle, and r at least the sine of the angle between the axes */
  MG_CONDITION_TIP = 7      /* N.(a0, a1, a2) - a3 at a vertex, the tip of a cone; the vector is along its axis */
};

/* Where a contact goes when a condition fails, if not to another feature pair. */
enum {
  MG_BEYOND_ENDS = -1,   /* the contact ends */
  MG_BEYOND_WATCHED = -2 /* the contact stays, and its pair is searched for contacts that begin there */
};

/* When a pair of shapes is searched for closest points during a run. */
enum {
  MG_SEARCH_NEVER = 0,  /* not as long as it has a contact, which does not end */
  MG_SEARCH_MOVED = 1,  /* after it has moved by search_movement * length */
  MG_SEARCH_ALWAYS = 2, /* after it has moved by half of its least gap, where it touches after every accepted step */
  MG_SEARCH_AHEAD = 3,  /* the same; its contacts do not show all minima, so steps are kept short enough
                           that the next search finds what comes near */
  MG_SEARCH_APART = 4 /* as MG_SEARCH_MOVED, but not while one of its contacts is closed: the shapes touch in one point
                         at a time */
};

/* Kind of a term of a solid, whose material is where all of its terms are negative; r is the distance from the axis z
   of the shape. a[0], a[1], .. are the term's numbers. */
enum {
  MG_TERM_PLANE = 0,          /* (a0, a1, a2).x - a3 */
  MG_TERM_TURNED = 1,         /* a0 r + a1 z - a2, with a0^2 + a1^2 = 1 */
  MG_TERM_RING = 2,           /* distance from the circle of radius a0 at z = a2, less a1 */
  MG_TERM_CAPSULE = 3,        /* distance from the part |z| <= a1 of the axis, less a0 */
  MG_TERM_ELLIPSOID = 4,      /* semi-axes a0, a1, a2 */
  MG_TERM_SUPERELLIPSOID = 5, /* (|x / a0|^a3 + |y / a1|^a3)^(a4 / a3) + |z / a2|^a4 = 1 */
  MG_TERM_PARABOLOID = 6,     /* below z = (x^2 / a0 + y^2 / a1) / 2 */
  MG_TERM_POLYGON = 7,        /* within the polygon (a0, a1), (a2, a3), .. in x and y, counterclockwise */
  MG_TERM_SAMPLES = 8         /* behind samples of a surface, by the nearest: six numbers each from a1 on, a point and a
                                 normal out of the material, of a cavity too, or 0 at an end of the surface, where all
                                 points are outside; points within a0 of the surface count as outside */
};

/* In place of the solid of a shape. */
enum {
  MG_NO_MATERIAL = -1,     /* a curve, a point or a disc */
  MG_UNKNOWN_MATERIAL = -2 /* a shape whose material no terms describe */
};

/* A height over a solid: the distance to first order, or with a slope of 1 at most. */
enum { MG_FIRST_ORDER = 0, MG_LIPSCHITZ = 1 };

/* What a friction constraint resists. */
enum {
  MG_FRICTION_SLIP = 0, /* slip along t1 and t2: two rows, force in N */
  MG_FRICTION_SPIN = 1, /* spin about N: one row, torque in N m */
  MG_FRICTION_ROLL = 2  /* rolling about t1 and t2: two rows, torque in N m */
};

/* Offsets into the numbers of a feature. */
enum {
  MG_FEATURE_PLACEMENT = 0,    /* 12: origin and rotation matrix by columns of the shape in body axes */
  MG_FEATURE_DOMAIN = 12,      /* 4: least and greatest u, least and greatest v; +-MG_MAX where there is no bound */
  MG_FEATURE_BALL_RADIUS = 16, /* 1: radius of a ball that contains the feature, m; MG_MAX where there is none */
  MG_FEATURE_BALL_CENTRE = 17, /* 3: centre of that ball in the shape's axes, m */
  MG_FEATURE_UV_SCALE = 20,    /* 2: scales of u and v, by which their differences are divided */
  MG_FEATURE_SIZE = 22
};

/* One scene, read only. Shapes of the arrays are in brackets. "Offset" is an index of the first of several numbers. A
   range array of n + 1 entries gives entry k the range [a[k], a[k + 1]). */
typedef struct {
  const mg_kernels *kernels; /* kernels of the generated library */
  int n_body;                /* bodies, those included that do not move */
  int n_contact;             /* contacts, limits of joints and support points included */
  int n_load;                /* loads */
  int n_pair;                /* pairs of shapes, then one of each limit */
  int n_feature_pair;        /* feature pairs */
  int n_q;                   /* position coordinates of all bodies */
  int n_u;                   /* velocity coordinates of all bodies */
  int n_eta;                 /* contact parameters of all contacts */
  int closed_capacity;       /* most contacts closed at a time; scratch memory grows with its square */
  int n_joint;               /* joints */
  int n_joint_row;           /* rows (scalar equations) of all joints */
  int n_stand_in;            /* shapes that may touch and stand for another surface (mg_doubts) */
  int n_patch;               /* patches; each has three feature pairs, the last 3 n_patch of all */
  int n_patch_slot;          /* slots; each has three contacts, the last 3 n_patch_slot of all */
  int n_cell_tree;           /* trees of cells of features, by which closest points are searched */
  int n_cell;                /* room for the cells of all trees */
  int n_face_group;          /* most flat faces that feature_pair_group numbers in a pair */
  int may_patches_open;      /* 1: patches may cover feature pairs that exist only while their faces are tilted, such as
                                rims: there is a condition MG_CONDITION_TILT with a3 >= 0 */
  int n_friction;            /* friction constraints of all contacts */
  int n_friction_row;        /* rows of all contacts other than their normal rows */
  int n_ball;                /* balls around shapes */
  int n_ball_class;          /* classes of equal shapes of equal bodies, of which pairs share slots */
  int n_pool;                /* pools of slots */
  int slot_contact_max;      /* most contacts of a slot, see mg_told_contact */
  int n_solid;               /* shapes whose material is described by terms */
  int n_input;               /* inputs: numbers of loads and prescribed motions that the caller sets during a run */
  int n_switch;              /* switching functions of all loads */
  int sensor_parameters;     /* offset into parameters of those of the sensors */
  int n_parameters;          /* length of parameters */
  int n_numbers;             /* length of numbers */

  const int *body_kind;       /* [n_body] body kind of the library */
  const int *body_q;          /* [n_body] offset into q */
  const int *body_u;          /* [n_body] offset into u */
  const int *body_parameters; /* [n_body] offset into parameters */

  const int *contact_pair;         /* [n_contact] pair of shapes */
  const int *contact_eta;          /* [n_contact] offset into eta; ascending, the room reaches to the next contact's */
  const int *contact_feature_pair; /* [n_contact] the contact's own feature pair, or -1: any of its pair of shapes */

  const int *pair_contact;      /* [n_pair + 1] range of contacts */
  const int *pair_feature_pair; /* [n_pair + 1] range of feature pairs */
  const int *pair_search;       /* [n_pair] MG_SEARCH_NEVER .. MG_SEARCH_APART */
  const int *pair_is_candidate; /* [n_pair] 1: its contacts are left out while its shapes are far apart */
  const int *pair_balls;        /* [2 n_pair] balls around the shapes of o, f; -1: none */

  const int *ball_body;          /* [n_ball] body of each ball */
  const int *ball_partner_begin; /* [n_ball + 1] range of ball_partner */
  const int *ball_partner;       /* [all partners] balls with a larger number with which a ball has pairs, ascending */
  const int *ball_pair;          /* [all partners] these pairs; -1: none, whatever their classes */

  /* Where many bodies are equal, pairs of their shapes have no entries of their own: each pair that is near takes a
     slot of its pool. Slots are pairs, the last ones before those of limits. The entries of all slots of a pool are
     those of one pair, the pattern of the pool, which has its own; run->slot_balls tells which pair a slot stands for.
   */
  const int *pool_slot;      /* [n_pool + 1] range of pairs that are the slots of a pool, for pairs of two classes */
  const int *pool_pattern;   /* [n_pool] its pattern */
  const int *pool_width;     /* [n_pool] balls in the class of f */
  const int *pool_told_pair; /* [n_pool] number told of the first of all its pairs (mg_told_pair) */
  const int *ball_class;     /* [n_ball] class of each ball, or -1: none of its pairs are in a pool */
  const int *ball_rank;      /* [n_ball] its number within its class */
  const int *class_pool;     /* [n_ball_class * n_ball_class] pool of the pairs of two classes, or -1 */

  const int *ball_solid;      /* [n_ball] solid of the shape in each ball; MG_NO_MATERIAL, MG_UNKNOWN_MATERIAL */
  const int *solid_body;      /* [n_solid] body of each solid, ascending */
  const int *solid_is_cavity; /* [n_solid] 1: the material is where no terms are negative, and others of its body have
                                 none within it */
  const int *solid_numbers;   /* [n_solid] offset into numbers: placement of the shape in body axes (12) */
  const int *solid_term;      /* [n_solid + 1] range of terms */

  const int *term_kind;    /* [all terms] MG_TERM_PLANE .. */
  const int *term_numbers; /* [all terms] offset into numbers */
  const int *term_size;    /* [all terms] how many numbers a term has */

  const int *feature_pair_kind;       /* [n_feature_pair] contact kind of the library */
  const int *feature_pair_o;          /* [n_feature_pair] body o */
  const int *feature_pair_f;          /* [n_feature_pair] body f */
  const int *feature_pair_parameters; /* [n_feature_pair] offset into parameters */
  const int *feature_pair_owner;      /* [n_feature_pair] pair of shapes that it belongs to */
  const int *feature_pair_group;      /* [n_feature_pair] of two convex solids: number of the flat face of one of them
                                         that is paired with a feature of the other; else -1 */
  const int *feature_pair_condition;  /* [n_feature_pair + 1] range of conditions */

  const int *feature_shape;      /* [2 n_feature_pair] features o, f: shape kind of the library; -1: no features */
  const int *feature_parameters; /* [2 n_feature_pair] features o, f: offset into parameters */
  const int *feature_numbers; /* [2 n_feature_pair] features o, f: offset into numbers, see MG_FEATURE_PLACEMENT .. */
  const int
      *feature_tree; /* [2 n_feature_pair] features o, f: tree of its cells, or -1: none; equal features share one */
  const int *tree_shape;        /* [n_cell_tree] shape kind of the features of each tree */
  const int *feature_is_listed; /* [2 n_feature_pair] features o, f: 1 at one of the places of a feature in its pair, at
                                   one with a tree if there is one */

  const int *condition_kind;         /* [all conditions] MG_CONDITION_QUADRIC .. */
  const int *condition_feature;      /* [all conditions] feature whose point, coordinates, N it is about: 0 o, 1 f */
  const int *condition_feature_pair; /* [all conditions] next feature pair, of another pair where shapes that are fixed
                                        to each other join smoothly, MG_BEYOND_ENDS or MG_BEYOND_WATCHED */
  const int *condition_numbers;      /* [all conditions] offset into numbers */
  const int *condition_is_line_end;  /* [all conditions] 1: beyond are two straight features, and this one ends one of
                                        them: parallel they touch along a line, which ends here */

  const int *load_kind;       /* [n_load] load kind of the library */
  const int *load_a;          /* [n_load] first body */
  const int *load_b;          /* [n_load] second body, or -1 */
  const int *load_parameters; /* [n_load] offset into parameters */
  const int *load_switch;     /* [n_load + 1] range of switching functions */

  const int *joint_kind;       /* [n_joint] joint kind of the library */
  const int *joint_a;          /* [n_joint] first body */
  const int *joint_b;          /* [n_joint] second body */
  const int *joint_parameters; /* [n_joint] offset into parameters */
  const int *joint_row;        /* [n_joint] its first row, counted over the rows of all joints */

  const int *patch_pair;    /* [n_patch] pair of shapes whose faces they are */
  const int *patch_slots;   /* [2 n_patch] first slot that may hold it, and the slot after the last */
  const int *patch_arc;     /* [n_patch + 1] range of arcs of both regions; o's come first */
  const int *patch_arc_f;   /* [n_patch] first arc of f's region; patch_arc[p] if o's is the whole plane */
  const int *patch_numbers; /* [n_patch] offset into numbers: placement of o's face in body o (12), of f's face in
                               body f (12) */
  const int *patch_covered; /* [n_patch + 1] range of covered_feature_pair */
  const int *covered_feature_pair; /* [all covered] feature pairs that lie in the patch, to be replaced by it */
  const int *patch_share;          /* [n_patch + 1] range of shares; none of a patch of one pair */
  const int *share_pair;           /* [all shares] pair of shapes to which the force on a part of the patch belongs */
  const int *share_arc; /* [4 all shares] its two faces, whose overlap the part is: first arc of o's and the one after
                           its last, the same of f's */

  const int *arc_shape;      /* [all arcs] shape kind of the curve */
  const int *arc_parameters; /* [all arcs] offset into parameters of the curve */
  const int *arc_numbers; /* [all arcs] offset into numbers: placement of the curve in the axes of its face (12), first
                             and last curve parameter */
  const int *arc_loop;    /* [all arcs] number of its loop; the arcs of a loop are consecutive, each begins where the
                             one before it ends */

  const int *contact_friction_row; /* [n_contact + 1] range of friction rows, counted over those of all contacts */
  const int *contact_friction;     /* [n_contact + 1] range of friction constraints */
  const int *impact_law;           /* [n_contact] MG_NEWTON, MG_POISSON or MG_STRONGE */

  const int *friction_kind; /* [n_friction] MG_FRICTION_SLIP, MG_FRICTION_SPIN or MG_FRICTION_ROLL */
  const int *friction_row;  /* [n_friction] its first row, counted from the contact's first friction row */
  const int *friction_body; /* [n_friction] body in whose axes friction_direction is, or -1: isotropic */

  const int *input_is_linear; /* [n_input] 1: the input follows a line, whose rate is set; 0: its value is set */

  const mg_real *input_range;  /* [2 n_input] least and largest value that a controller may set */
  const mg_real *mass_inverse; /* [10 n_body] 1/m, 1/kg, and inverse inertia by columns, body axes, 1/(kg m^2);
                                  zeros for bodies that forces do not move */
  const mg_real *restitution;  /* [n_contact] coefficient of restitution of impact_law, 0..1 */
  const mg_real
      *parameters; /* [n_parameters] parameters of bodies, contacts, loads, joints and shapes, as kernels take them */
  const mg_real *numbers;            /* [n_numbers] numbers of features, conditions, patches and arcs */
  const mg_real *friction_static;    /* [2 n_friction] static coefficients along the direction and across it; 1 for
                                        slip, m for spin and rolling */
  const mg_real *friction_kinetic;   /* [2 n_friction] the same, kinetic */
  const mg_real *friction_direction; /* [3 n_friction] principal direction of anisotropic friction, axes of
                                        friction_body */
  const mg_real *patch_friction;     /* [2 n_patch] static and kinetic coefficient; 0 without friction */
  const mg_real *pair_normal;        /* [3 n_pair] of a pair of curves: approximate N at the start; zeros: not given */
  const mg_real *ball;               /* [4 n_ball] balls around shapes: centre, m, in the axes of the body, and radius,
                                        m, < 0 where unbounded */
  const mg_real *scale;              /* [length of x] size of each state, against which its error is measured */

  mg_real gravity[3]; /* m/s^2, world axes */
  mg_real length; /* characteristic length, m; settings refer to it as "length". "pair length": the smaller radius of
                     the two balls of a pair, at least this */
  mg_real mass;   /* characteristic mass, kg */
  mg_real time;   /* characteristic time, s; settings refer to it as "time" */

  mg_digest shapes_digest; /* mg_shapes_digest of this system; 0: every call makes it, as numbers may have changed */
} mg_system;

/* Law of restitution; the coefficient e is the ratio of what is restored to what was there before. */
enum {
  MG_NEWTON = 0,  /* ratio of normal velocities */
  MG_POISSON = 1, /* ratio of normal impulses of restitution and compression */
  MG_STRONGE = 2  /* e^2 is the ratio of the works of the normal impulse in restitution and compression */
};

/* Method of integration. */
enum {
  MG_RK4 = 0,          /* classical Runge-Kutta method with a fixed step, order 4; events are located */
  MG_DOP853 = 1,       /* Dormand and Prince's method with step control, order 8; events are located */
  MG_TIME_STEPPING = 2 /* impulses over fixed steps; events are not located */
};

/* Scheme of time-stepping: which gap rate d_dot is demanded at the end of a step h. */
enum {
  MG_STEWART_TRINKLE = 0, /* d + h d_dot >= 0: the gap may close within the step */
  MG_ANITESCU_POTRA = 1,  /* d_dot >= 0 where d <= 0 */
  MG_MOREAU = 2           /* the same, at positions (1 - stepping_theta) h ahead of the start of the step */
};

/* Choices and tolerances of a run, read only. Tolerances are dimensionless unless a unit is given; "length" and "time"
   are the characteristic ones of mg_system. */
typedef struct {
  int method;                /* MG_RK4, MG_DOP853 or MG_TIME_STEPPING */
  int stepping_scheme;       /* time-stepping: MG_STEWART_TRINKLE, MG_ANITESCU_POTRA or MG_MOREAU */
  int stepping_friction_law; /* time-stepping: MG_COULOMB or MG_RELAXED */
  int fallback;              /* 1: where events cannot be located, the run goes on by time-stepping for a while */
  int use_gamma;             /* 0: the velocity term Gamma2 of the gap acceleration is dropped, for comparison */
  int newton;                /* Newton corrections of eta: 0 none, 1 one per accepted step, 2 one per stage as well */
  int project;               /* n > 0: drift of d and d_dot is projected away every n accepted steps; 0: never */
  int sequential;            /* 1: impacts at several contacts are treated one after another, the fastest first; 0: all
                                at once, where all follow Newton's law */
  int planar_contacts;       /* 1: flat faces that lie on each other rest as patches; 0: on single contacts */

  mg_real step;               /* s: step of RK4 and of time-stepping; first step of DOP853, 0: chosen by the program */
  mg_real stepping_theta;     /* Moreau's scheme: part of a step that follows the positions of its rows, 0..1 */
  mg_real stepping_tolerance; /* time-stepping: a friction solve ends at this residual once its iterations slow down */
  mg_real stepping_residual;  /* time-stepping: impulses with no more than this residual are accepted, and counted */
  mg_real fallback_step;      /* fallback: steps of fallback_step * time */
  mg_real fallback_progress;  /* an event-driven run falls back where many tries advance t by less than
                                 fallback_progress * time and a third of them is rejected */
  mg_real chatter_step;       /* time-stepping in place of events that cost too much: steps of chatter_step * time */
  mg_real chatter_work;       /* an event-driven run goes on by time-stepping when the work of its events and
                                 rejected steps, in evaluations of one contact, exceeds this and several times what
                                 time-stepping would have cost */
  mg_real tolerance;          /* DOP853: bound of the local error over scale, root mean square */
  mg_real contact_gap;        /* gaps |d| <= contact_gap * length count as touching */
  mg_real start_gap;          /* at the start, gaps |d| <= start_gap * length count as touching; deeper penetration
                                 is refused */
  mg_real start_joint_gap;    /* at the start, joint errors <= start_joint_gap * length are corrected, others refused */
  mg_real drift_tolerance;    /* drift is projected away if d exceeds drift_tolerance * length, or d_dot that over
                                 time */
  mg_real rest_speed; /* contacts that approach slower than rest_speed * length / time do not rebound; loads hold a
                         switching function of place at a zero that it passes as slowly */
  mg_real slip_speed; /* slip below slip_speed * length / time (spin, rolling: slip_speed / time) sticks if
                         the forces permit it */
  mg_real friction_bound_margin; /* a friction constraint whose force has reached its bound is tried with a bound that
                                    is smaller by this part */
  mg_real other_motion;          /* forces that change accelerations by more than this part of those without forces
                                    cause another motion */
  mg_real rest_acceleration;     /* gap accelerations below rest_acceleration * length / time^2 do not open a contact */
  mg_real event_tolerance;       /* events are located to event_tolerance * time */
  mg_real extremality_residual;  /* eta is converged at the start until the residual of the extremality equations is <=
                                    extremality_residual * length (lengths), extremality_residual (angles) */
  mg_real slip_stop_speed_ratio; /* slip is stopped only if this takes no more energy than a speed of
                                    slip_stop_speed_ratio * slip_speed * length / time has */
  mg_real separation_speed_factor; /* a step is shortened if at its end the gap rate of a loaded contact exceeds
                                      separation_speed_factor * tolerance times length / time and times the
                                      approach bound of the pair */
  mg_real derivative_error_factor; /* a step with derivatives is refused where their error in it, relative to their
                                      size, exceeds derivative_error_factor * tolerance */
  mg_real derivative_kink_part; /* up to the end of a step that was refused so, that bound is smaller by this factor */
  mg_real derivative_step_min;  /* steps up to derivative_step_min * time are never refused so */
  mg_real load_jump_rate;       /* a load that changes in a step h by more than load_jump_rate * h / time of its size
                                   may have jumped */
  mg_real load_jump_span;       /* it has if half of the change lies at one place of the way of its bodies within
                                   load_jump_span * time */
  mg_real derivative_reach; /* derivatives at a start are undecided if a load jumps at a state that differs from it by
                               no more than derivative_reach, relative to the scales of poses and twists */
  mg_real derivative_jump_part; /* a load that changes there by less than derivative_jump_part of it does not jump */
  mg_real derivative_impact_residual; /* an impact is differentiated if its law explains the change of velocities but
                                         for this part of it */
  mg_real derivative_start_change; /* changes of velocities at the start up to this, over scale, may be left out of the
                                      derivatives */
  mg_real sensor_kink_reach; /* kinks of sensors are sought up to sensor_kink_reach from the state, relative to what
                                they depend on */
  mg_real sensor_kink_part;  /* a sensor is on a kink if slopes on both sides differ by more than this part of them */
  mg_real sensor_slope_part; /* the derivative of a sensor on a kink holds on a side if it differs from the slope there
                                by no more than this part */
  mg_real face_force_part;   /* whether the centre of the forces on a face stays in it is tried with forces that are
                                changed by this part of its load */
  mg_real face_centre_part;  /* the centre stays if such a change moves it beyond the border by no more than
                                face_centre_part * face_force_part * length */
  mg_real rest_loss_factor;  /* a gap held without force opens within a step where its acceleration exceeds
                                rest_loss_factor * rest_acceleration * length / time^2 */
  mg_real event_correction_step;  /* an event later in the step than this part of it is corrected by further steps only
                                     while the correction converges fast */
  mg_real contact_rank_tolerance; /* a contact row depends on the rows of other constraints if no more than this part of
                                     its diagonal entry of J M^-1 J^T is independent of them */
  mg_real joint_rank_tolerance;   /* a joint row depends on other joint rows if no more than this part of its diagonal
                                     entry of J M^-1 J^T is independent of them; it then gets no force */
  mg_real penetration_limit;      /* a run ends where bodies penetrate deeper than this times length */
  mg_real correction_ratio;       /* a correction of positions moves no body farther than this times the penetration,
                                     gap or joint error that it removes */
  mg_real appear_depth;           /* a contact may appear in a run with d >= -appear_depth * pair length */
  mg_real step_min;               /* a step below step_min * time ends the run */
  mg_real margin_warn;   /* a contact that starts at a zero of its margin has no bound on it up to here, nor has one of
                            features of revolution closer to coaxial than this and this times the length */
  mg_real margin_refuse; /* a closed contact whose margin falls below this ends the run */
  mg_real passage_time_max;   /* a singular contact is passed in parts that take at most passage_time_max * time */
  mg_real overlap_clear_gaps; /* at the start, a point farther from a body than overlap_clear_gaps * start_gap * length
                                 is clear of it */
  mg_real overlap_clear_part; /* that distance is less by overlap_clear_part * depth of an overlap, and two sheets
                                 overlap only if they cross deeper than that */
  mg_real appear_margin;      /* a contact without a feature pair of its own appears in a run only with a margin above
                                 this */
  mg_real appear_tilt_sine;   /* a closest point on a vertex or edge is accepted if no watched condition of it, the
                                 sine of a tilt, is below -appear_tilt_sine */
  mg_real search_margin;      /* a search drops closest points with a margin below this */
  mg_real search_merge_distance; /* closest points nearer than search_merge_distance * pair length are one */
  mg_real search_gap;      /* contacts that appear in a run are followed from gaps below search_gap * pair length */
  mg_real search_movement; /* MG_SEARCH_MOVED: a pair is searched after it has moved by search_movement * pair length */
  mg_real flat_angle;      /* rad: faces within this angle of parallel lie flat on each other */
  mg_real parallel_angle;  /* rad: straight features that touch along a line are held at both ends of it, in
                              time-stepping within this angle of parallel, in event-driven runs beyond an end up to this
                              angle where they are too nearly parallel to be followed between the ends */
  mg_real imaginary_edge;  /* rad: a face turns about a tangent of its curved rim, fixed in the body, up to this
                              tilt (section 5.3 of the paper); 0: it rolls on the rim at once */
  mg_real boundary_coincidence; /* boundaries of two faces nearer than boundary_coincidence * length coincide */
  mg_real feature_border;       /* a condition fails where it is below -feature_border (lengths: times length) */
  mg_real time_resolution;      /* functions of time are sampled every time_resolution * time */
  mg_real step_fraction;        /* step over the longest step permitted, 0..1; below 1 a step never leads from one event
                                   to the next */
  mg_real flush_height;         /* a blow from the side is doubted where faces of both bodies lie in one plane within
                                   flush_height * length and the point of the blow is in it */
  mg_real gap_error_max;        /* mg_doubts: bound of gap_max and penetration_max, times length */
  mg_real energy_error_max;     /* mg_doubts: bound of energy_error_max and impact_gain_max, times the largest kinetic
                                   energy */
  mg_real complementarity_error_max; /* mg_doubts: bound of complementarity_max */

  int lcp_iterations;     /* bound of the active-set changes of one complementarity problem */
  int event_scan_parts;   /* parts into which a step is divided to find its first event */
  int events_at_once_max; /* bound of the transitions within one event_tolerance * time; more end the run */
  int sweep_from_last;    /* 1: solves for friction sweep over the contacts from the last one on */
  int chatter_closed;     /* a run that left its events for time-stepping does not return with more closed contacts */

  const mg_outer_solver *outer_solver; /* solves problems for forces and impulses in place of the core: those without
                                          friction, and those of time-stepping; null: none */
} mg_settings;

/* Mode of a friction constraint. */
enum {
  MG_FRICTION_OFF = 0,  /* the contact carries no force */
  MG_STICKING = 1,      /* the relative velocity is held at zero */
  MG_SLIP_ONSET = 2,    /* slip begins now; its speed is of second order in time */
  MG_SLIP_STARTING = 3, /* slip has begun and is still slower than slip_speed */
  MG_SLIPPING = 4       /* slip along the direction of the relative velocity */
};

/* Start of rolling of a contact whose body lay flat and tilts onto its rim; for the first support point of a slot, the
   kind of edge that its first two support points hold. */
enum {
  MG_START_NONE = 0,      /* an ordinary contact */
  MG_START_FLAT = 1,      /* still flat: the next step is a first step from flat */
  MG_START_SETTLING = 2,  /* tilted, with a margin that is still small */
  MG_ON_STRAIGHT_EDGE = 3 /* first support point of a slot: a straight side of the hull is held */
};

/* Where a switching function of a load is. */
enum {
  MG_BRANCH_NEGATIVE = -1, /* below zero */
  MG_BRANCH_ZERO = 0,      /* at zero, without loads that keep it there */
  MG_BRANCH_POSITIVE = 1,  /* above zero */
  MG_BRANCH_SLIDES = 2     /* kept at zero by loads between those of both branches (Filippov's sliding mode) */
};

/* Outcome of mg_begin and mg_advance. */
enum {
  MG_DONE = 0,             /* t_stop has been reached; of mg_begin: the run can be advanced */
  MG_CONTINUE = 1,         /* max_steps have been taken: call mg_advance again */
  MG_LIST_FULL = 2,        /* the list of events has no room for another step: empty it and call mg_advance again */
  MG_PENETRATION = 10,     /* start refused: failed_contact penetrates */
  MG_NO_EXTREMUM = 11,     /* start refused: no closest points are found for failed_contact */
  MG_NO_OUTSIDE = 12,      /* start refused: it is not known on which side of each other two curves are that touch */
  MG_JOINT_APART = 13,     /* start refused: failed_joint is not assembled */
  MG_BODY_WITHIN = 14,     /* start refused: a body of failed_contact's pair is within the other or passes through it */
  MG_MARGIN = 20,          /* failed_contact is too near to a singularity of its closest-point equations */
  MG_STEP_TOO_SMALL = 21,  /* the step is below step_min, or the run does not advance */
  MG_NOT_FINITE = 22,      /* a state or a function of time is not finite; see mg_unbounded */
  MG_COMPLEMENTARITY = 23, /* a complementarity problem has no solution, or none was found */
  MG_TOO_MANY_EVENTS = 24, /* more than events_at_once_max transitions at one time */
  MG_TOO_MANY_CLOSED = 25, /* more than closed_capacity contacts are closed */
  MG_NO_FRICTION = 26,     /* no forces satisfy Coulomb's law, or none were found */
  MG_PENETRATED = 27,      /* bodies penetrate deeper than penetration_limit, at failed_contact */
  MG_TOO_COSTLY = 29,      /* more than steps_max steps */
  MG_TOO_MANY_NEAR = 30,   /* a pool has too few slots for the pairs that are near: exceeded_pool of the report */
  MG_CHATTER = 28          /* ends no run: events cost too much, and the run goes on by time-stepping */
};

/* Kind of an event of a contact; slip events are of friction constraints, with the contact that they belong to. */
enum {
  MG_EVENT_IMPACT = 0,          /* an impact from which the contact separates */
  MG_EVENT_TOUCH_DOWN = 1,      /* the contact closes and stays closed */
  MG_EVENT_LIFT_OFF = 2,        /* the contact opens */
  MG_EVENT_MARGIN = 3,          /* the contact came too near to a singularity to be followed */
  MG_EVENT_FEATURE_CHANGE = 4,  /* the contact changes to another feature pair */
  MG_EVENT_APPEAR = 5,          /* a search has found new closest points, which the contact follows */
  MG_EVENT_VANISH = 6,          /* the closest points of the contact have ceased to exist */
  MG_EVENT_FACE_CONTACT = 7,    /* first support point of a slot: its patch rests */
  MG_EVENT_TIPPING = 8,         /* first support point of a slot: its patch tips over an edge */
  MG_EVENT_SLIP_START = 9,      /* slip begins; for spin add MG_EVENTS_PER_FRICTION, for rolling twice that */
  MG_EVENT_SLIP_STOP = 10,      /* slip ends; spin, rolling: as above */
  MG_EVENT_SLIP_REVERSAL = 11,  /* slip changes to another direction at once; spin, rolling: as above */
  MG_EVENTS_PER_FRICTION = 3,   /* not an event: number of slip events, the step from slip to spin to rolling */
  MG_EVENT_FALLBACK_START = 18, /* the run goes on by time-stepping */
  MG_EVENT_FALLBACK_END = 19,   /* events are located again */
  MG_EVENT_LOAD_SWITCH = 20     /* a load jumps or has a kink: `contact` is the switching function */
};

/* Capacities of the core that a run may exceed. */
enum {
  MG_CAPACITY_CLOSED = 0,     /* closed contacts: closed_capacity */
  MG_CAPACITY_STATIONARY = 1, /* stationary places of two circles */
  MG_CAPACITY_LEFT = 2,       /* closest points that contacts leave in one step */
  MG_CAPACITY_SEGMENT = 3,    /* cells along the segment between two points of bodies */
  MG_CAPACITY_SLOT = 4,       /* planar contacts of two bodies at a time */
  MG_CAPACITY_REGION = 5,     /* intersections of the outlines of two faces, and parts of their boundary */
  MG_CAPACITY_EVENTS = 6,     /* events between two calls of the caller */
  MG_CAPACITY_PRESSURE = 7,   /* steps of Newton's method for the pressure between faces that slip */
  MG_CAPACITY_NEAR = 8,       /* near pairs of a pool */
  MG_CAPACITIES = 9
};

/* What a run tells of itself: counts, largest values and first places, by which no body moves. mg_begin resets it. */
typedef struct {
  long qp_solves;           /* complementarity problems without friction solved by the core, as convex programs */
  long friction_solves;     /* problems with friction solved by the core, by Coulomb's law */
  long relaxed_solves;      /* the same by the relaxation */
  long outer_solves;        /* problems solved by settings->outer_solver */
  long fallbacks;           /* how often the run has fallen back on time-stepping */
  long jams;                /* of these, because no accelerations were admissible */
  long chatters;            /* how often the run went on by time-stepping because its events cost too much */
  long loose_solutions;     /* time-stepping: steps with impulses found to stepping_residual only */
  long relaxed_solutions;   /* time-stepping: steps with impulses by the relaxation, none by Coulomb's law was found */
  long singular_passages;   /* places passed at which a closed contact is singular */
  long slip_stops;          /* how often slip, spin or rolling ended */
  long redundant_max;       /* most active contacts beyond the rank of their rows; forces then are of minimum norm */
  long unfollowed_minima;   /* how often a search found closest points within search_gap that no contact could follow */
  long incomplete_searches; /* searches of feature pairs that were given up before all closest points were found */
  long exceeded[9];         /* how often each capacity was exceeded, MG_CAPACITY_CLOSED .. */

  mg_real energy_0;          /* energy at the start, J */
  mg_real energy_error_max;  /* largest |energy - energy_0 - work - correction_work|, J */
  mg_real correction_work;   /* time-stepping: change of the energy by all corrections of positions, J; no part of the
                                work */
  mg_real correction_energy; /* sum of the amounts of these changes, J */
  mg_real kinetic_max;       /* largest kinetic energy, J */
  mg_real gap_max;           /* largest |d| of a closed contact, m */
  mg_real
      penetration_max;   /* deepest penetration of a pair, m: of a contact, or of closest points that a search found */
  mg_real penetration_t; /* time of penetration_max, s */
  mg_real complementarity_max; /* largest |min(d / length, force / (mass length / time^2))| */
  mg_real margin_min;          /* least margin of a closed contact */
  mg_real lcp_residual_max;    /* largest residual of a complementarity or friction problem */
  mg_real joint_error_max;     /* largest error of a joint row, at the start and after accepted steps, m or rad */
  mg_real joint_speed;         /* largest velocity error of a joint row at the start, m/s or rad/s */
  mg_real dead_centre_t;       /* end of the step in which the first dead centre was passed, s */
  mg_real joint_margin_min;    /* least independence of the rows of a joint over the largest of that joint, 0..1 */
  mg_real joint_margin_t;      /* time of joint_margin_min, s */
  mg_real fallback_first;      /* start of the first fallback, those by MG_CHATTER not included, s */
  mg_real fallback_time;       /* duration of all fallbacks, s */
  mg_real chatter_first;       /* start of the first fallback by MG_CHATTER, s */
  mg_real chatter_time;        /* duration of all fallbacks by MG_CHATTER, s */
  mg_real impact_gain_max;     /* most energy that an impact has added, J */
  mg_real impact_gain_t;       /* time of impact_gain_max, s */
  mg_real chain_impact_t;      /* time at which an impact first reached a contact at rest, s */
  mg_real painleve_t;          /* time at which forces were first indeterminate (Painleve's paradox), s */
  mg_real unfollowed_t;        /* time of the first of unfollowed_minima, s */
  mg_real spin_max;            /* time-stepping: largest angular speed of a body at the starts of steps, rad/s */
  mg_real force_rounding;      /* largest relative error that rounding may have made in the forces of an evaluation */
  mg_real spring_rate_max;     /* time-stepping: fastest rate of a spring or damper alone on its bodies, 1/s */
  mg_real incomplete_t;        /* time of the first of incomplete_searches, s */
  mg_real indeterminate_t;     /* time of indeterminate, s */
  mg_real indeterminate_part;  /* change of the acceleration at indeterminate_contact by other forces, as a part of the
                                  largest without forces */
  mg_real flush_t;             /* time of flush_contact, s */
  mg_real exceeded_t[9];       /* when each capacity was exceeded first, s */

  int failed_contact;       /* contact of the outcome, or -1 */
  int failed_joint;         /* joint with the largest error at the start, or -1 */
  int joint_margin;         /* joint of joint_margin_min, or -1 */
  int rank_min;             /* least rank of the rows of all joints at accepted steps; -1 before the first */
  int rank_max;             /* largest rank of the rows of all joints at accepted steps */
  int dead_centres;         /* dead centres passed */
  int dead_centre;          /* joint nearest to the loss of a row at the first dead centre, or -1 */
  int impact_gain_contact;  /* that added most of impact_gain_max, or -1 */
  int chain_impact_contact; /* contact of chain_impact_t, or -1 */
  int painleve_contact;     /* contact of painleve_t, or -1 */
  int fallback_cause;       /* outcome that the first fallback avoided, those by MG_CHATTER not included */
  int passage_contact;      /* contact of the first singular passage, or -1 */
  int unfollowed_pair;      /* pair of shapes of the first of unfollowed_minima, or -1 */
  int incomplete_pair;      /* pair of shapes of the first of incomplete_searches, or -1 */
  int penetration_contact;  /* contact, or first contact of the pair, of penetration_max; -1: none */
  int spin_body;            /* body of spin_max, or -1 */
  int overlapping_patch;    /* patch of several pairs whose faces overlap, so that their shares are not unique; -1: none
                               was sampled */
  int spring_rate_load;     /* load of spring_rate_max, or -1 */
  int indeterminate;        /* 1: friction forces or a load left the motion open, or were not tested whether they do */
  int indeterminate_contact; /* contact at which the other motion that was found differs most, or -1: none was found */
  int indeterminate_switch;  /* switching function of that load, or -1: friction forces */
  int flush_contact; /* contact of the first blow from the side within the plane of faces of both bodies, or -1 */
  int shared_switch; /* switching function of the first load at a jump that contacts or joints hold too, or -1 */
  int exceeded_pool; /* pool that had too few slots first, or -1 */
} mg_run_report;

/* One run: its state, its active set, counts by which it goes on, and its report. Before mg_begin the caller sets t, h
   (0: chosen by the program), x (eta: 0 or a guess), feature_pair (-1), input and the pointers; it fills the other
   arrays with zeros. */
typedef struct {
  mg_real t;         /* time, s */
  mg_real h;         /* next step to try, s */
  mg_real *x;        /* [n_q + n_u + n_eta + 1] state */
  int *feature_pair; /* [n_contact] feature pair that the contact is on, or -1 */
  mg_real *point;    /* [3 n_contact] of a support point or a contact that starts from flat: the point of f, m,
                        in the axes of its body */
  mg_real *moved_since_search; /* [n_pair] relative movement since the pair was searched, m */
  int *is_search_due;          /* [n_pair] 1: the pair is searched at the end of the next step */
  mg_real *watched_movement;   /* [n_pair] movement during which the pair is searched after each step, m: what has been
                                  rejected because bodies would penetrate at its end */
  mg_real *unfollowed_gap;     /* [n_pair] least gap found by that search that no contact was free to follow, m */
  mg_real *withheld_effort;    /* [n_pair] pairs of cells by which its searches look at fewer than usual */
  int *is_far;                 /* [n_pair] 1: left out, because its shapes are far apart */
  int *slot_balls;         /* [2 per slot of the pools] of the pair in the slot: numbers of its balls o, f, from 1 on;
                              0: those of the pattern of its pool */
  int *stop;               /* [1] or null; 1: another thread or a signal handler asks that a call end soon */
  mg_real *ball_at;        /* [4 n_ball] centre when near pairs were last looked for, m, world axes, and how far it
                              may move before that is due again, m */
  int *closed;             /* [n_contact] 1: the gap is held at zero */
  int *active;             /* [n_contact] 1: closed and carrying force */
  int *friction_mode;      /* [n_friction] MG_FRICTION_OFF .. MG_SLIPPING */
  mg_real *slip_direction; /* [3 n_friction] direction of slip or rolling, unit vector; of spin, +-1 in the first */
  int *patch_mode;         /* [n_patch_slot] mode of the friction of its patch, MG_FRICTION_OFF .. MG_SLIPPING */
  mg_real *patch_slip_direction; /* [4 n_patch_slot] direction of the slip of a patch: velocity in the middle of the
                                    support points (3) and spin times their radius; unit length */
  mg_real *patch_support_share;  /* [3 n_patch_slot] shares of its support points in its force at the state before this
                                    one: there the search for its pressure starts; 0: in the middle */
  mg_real *reference_force;      /* [n_contact + 1 + n_joint_row + n_friction_row] per row: force, N or N m, from which
                                    forces that are not unique deviate least; in time-stepping that of the last
                                    step */
  mg_real *force;                /* [n_contact] normal force at t, N */
  mg_real *margin;               /* [n_contact] distance from a singularity of the closest-point equations at t, 1 */
  int *rolling_start;            /* [n_contact] MG_START_NONE .. MG_ON_STRAIGHT_EDGE */
  mg_real *after_t;        /* [n_contact] time of the last blow before which it did not approach or that struck it,
                              s; -1: of none */
  int *struck_by;          /* [n_body] contact that struck the body last, or -1 */
  mg_real *tilt_direction; /* [3 n_contact] of a contact that starts from flat: direction in which its body tilts,
                              along the plane and out of the hull, unit vector */
  mg_real *input; /* [3 n_input] setting of each input: value; its rate, 1/s, used where the scene lets the input
                     change along a line; time at which it has that value, s. The caller writes settings before
                     mg_begin and between two calls of mg_advance, at whose start they take effect */
  mg_real *applied_input; /* [3 n_input] settings that have taken effect */
  mg_real *branch;        /* [n_switch] branch of the loads by each switching function, -1..1 */
  int *switch_mode;       /* [n_switch] MG_BRANCH_NEGATIVE .. MG_BRANCH_SLIDES */
  int *switch_leader;     /* [n_switch] of one that slides on the zeros of another: the number of that one from 1 on,
                             negative where their signs are opposite; else 0 */
  mg_real *search_bound;  /* [n_cell_tree] bound up to which the unbounded coordinates of the features of a tree
                             have been searched for closest points */
  mg_real *joint_independence_max; /* [n_joint] largest product of the independence of its rows so far, 0..1 */
  mg_real *joint_row_before;       /* [12 n_joint_row] J of the joint rows at the last accepted step */
  int *joint_row_independent;      /* [n_joint_row] 1: independent of the rows before it at the last accepted step */
  int *joint_row_ever_independent; /* [n_joint_row] 1: the same at any accepted step so far */

  long steps;             /* accepted steps */
  long rejected;          /* rejected steps */
  long rhs_evals;         /* evaluations of the right-hand side */
  long steps_max;         /* the run ends where steps + rejected exceed this; 0: it does not. mg_begin sets it to 0, and
                             the caller may write it after that */
  long since_projection;  /* accepted steps since drift was projected away */
  long events_at_t;       /* transitions within one event tolerance of t_event */
  long tiny_bounces;      /* blows in a row before which their contacts moved no farther than rounding of positions */
  long progress_tries;    /* steps and rejected when progress was last checked */
  long progress_rejected; /* rejected when progress was last checked */
  long fallback_transitions; /* contacts closed and opened in the present fallback, since its last prolongation */
  long search_effort;        /* pairs of cells looked at in searches for closest points */

  mg_real t_event;       /* time of the last transition, s */
  mg_real t_roundoff;    /* rounding error of t so far, s: the exact time is t + t_roundoff */
  mg_real progress_t;    /* t when progress was last checked, s */
  mg_real fallback_end;  /* end of the last fallback, s */
  mg_real fallback_step; /* step of the present fallback, s */
  mg_real fallback_left; /* time left of the present fallback, s; 0: none */
  mg_real event_work;    /* work of events beyond what time-stepping would have cost, evaluations of a contact */
  mg_real event_work_t;  /* t when event_work was last updated or the present fallback began, s */

  int present_cause;      /* outcome that the present fallback avoids */
  int fallback_doublings; /* how often the length of the last fallback was doubled */
  int forces_redundant;   /* 1: forces are not unique; those nearest to reference_force are taken */
  int friction_redundant; /* 1: friction forces of the present modes are not unique */
  int is_passage_due; /* 1: the next call of mg_advance begins with the passage of singular contacts: the run has just
                         begun, or the call before it ended in one */

  mg_run_report report; /* what it tells */
} mg_run;

/* Samples at times that the caller gives. Row k of an array belongs to t[k]; shapes are those of one row. The caller's
   arrays hold capacity rows. */
typedef struct mg_record mg_record;
struct mg_record {
  int capacity;      /* rows of every array */
  int count;         /* rows filled; the library counts it up */
  const mg_real *t;  /* times of the samples, s, ascending; given by the caller */
  mg_real *pose;     /* [12 n_body] pose */
  mg_real *twist;    /* [6 n_body] twist */
  mg_real *eta;      /* [n_eta] contact parameters */
  mg_real *force;    /* [n_contact] normal force, N */
  mg_real *gap;      /* [n_contact] gap d, m; this and the next three: NAN on no feature pair */
  mg_real *normal;   /* [3 n_contact] N */
  mg_real *point_o;  /* [3 n_contact] contact point of o, m */
  mg_real *point_f;  /* [3 n_contact] contact point of f, m */
  int *feature_pair; /* [n_contact] feature pair, or -1 */
  int *patch;        /* [n_patch_slot] patch that the slot holds, or -1 */
  int *slot_balls;   /* [2 per slot of the pools] as that of the run */
  mg_real *pressure; /* [4 n_patch_slot] resultant normal force, N, and centre of pressure, m */
  mg_real
      *patch_friction;  /* [8 n_patch_slot] friction force on f, N; its torque about N through the centre of pressure,
                           N m; velocity of f relative to o there, m/s; spin of f relative to o about N, rad/s */
  mg_real *patch_share; /* [all shares] force of each share by the pressure between the faces, N; 0 where its patch does
                           not rest. Shares that overlap count their common part twice. */
  mg_real *friction;    /* [3 n_contact] friction force on f, N */
  mg_real *torque;      /* [3 n_contact] torque of spinning and rolling resistance on f, N m, world axes */
  mg_real *slip;        /* [3 n_contact] slip velocity of f relative to o, m/s */
  mg_real *joint_wrench; /* [6 n_joint] on the second body: force, N, and torque about its centre of mass, N m */
  mg_real *coordinate;   /* [3 n_joint] joint coordinates: angles within half a turn, rad, displacements, m; NAN
                            where a joint has fewer than three */
  mg_real *energy;       /* [1] kinetic and potential energy, J */
  mg_real *work;         /* [1] work of loads and prescribed motions since the start, J */
  mg_real *sensors;      /* [kernels->n_sensor] what the sensors show */
  void (*empty)(mg_record *record); /* null, or called when all rows are filled: takes the samples, sets count back to
                                       0, and t and capacity to the times of the next ones */
};

/* List of events; the caller's arrays have capacity entries. */
typedef struct {
  int capacity;      /* entries of every array */
  int count;         /* entries filled; the library counts it up, the caller sets it back to 0 */
  mg_real *t;        /* time, s */
  int *kind;         /* MG_EVENT_IMPACT .. MG_EVENT_FALLBACK_END */
  int *contact;      /* contact */
  int *told_contact; /* the contact by the number that tells the pair in its slot (mg_told_contact) */
  int *feature_pair; /* feature pair of the contact after the event, or -1 */
  mg_real *speed;    /* approach speed of an impact or touch-down, m/s; else 0 */
  mg_real *after_t;  /* of an impact or touch-down: time of the last blow before which its contact did not approach or
                        which struck it too, so that it comes after that one, s; -1: there is none */
} mg_events;

/* What mg_closest knows of the points that it found. */
enum {
  MG_CLOSEST_NOT_FOUND = 0,  /* no extremum of the distance was found */
  MG_CLOSEST_STATIONARY = 1, /* a saddle or a maximum of the distance */
  MG_CLOSEST_LOCAL = 2,      /* a local minimum of the distance */
  MG_CLOSEST_GLOBAL = 3      /* the global minimum, by a certificate or in closed form */
};

/* Closest points of n pairs of poses of one contact kind; the caller's arrays, one row for each pair of poses. */
typedef struct {
  const mg_kernels *kernels; /* kernels of the generated library */
  int kind;                  /* contact kind */
  int n;                     /* pairs of poses */
  int is_warm_start;         /* convex shapes: 1 if eta is near the solution; where shapes overlap, the extremum that
                                continues eta is sought. Other kinds always start from eta */
  long stride;               /* distance in parameters from one row to the next; 0: the same parameters for all */
  const mg_real *parameters; /* [stride] parameters of the contact kind */
  const mg_real *pose_o;     /* [12] pose of o */
  const mg_real *pose_f;     /* [12] pose of f */
  const mg_real *step_limit; /* [n_eta], one row for all: bound of the change of each entry of eta in one Newton step;
                                MG_MAX marks an entry that is a sign */
  mg_real length;            /* length to which residual refers, m */
  mg_real residual; /* the extremality residual is brought below residual * length (lengths), residual (angles) */
  mg_real *eta;     /* [n_eta] guess on entry, result on return */
  mg_real *d;       /* [1] distance, m */
  mg_real *normal;  /* [3] N */
  mg_real *point_o; /* [3] point of o, m */
  mg_real *point_f; /* [3] point of f, m */
  mg_real *margin;  /* [2] the two margins of the place kernel: 1 and 1/m */
  int *outcome;     /* [1] MG_CLOSEST_NOT_FOUND .. MG_CLOSEST_GLOBAL */
} mg_closest_queries;

#define MG_MINIMA 24 /* most minima of the distance of one pair of bodies that are kept, the nearest ones */

/* Minima of the distance of two bodies at n pairs of poses; the caller's arrays, one row for each pair of poses. */
typedef struct {
  int first;      /* first feature pair that is searched */
  int end;        /* feature pairs first .. end - 1, all of one pair of bodies */
  int body_o;     /* body with pose_o */
  int body_f;     /* body with pose_f */
  int n;          /* pairs of poses */
  int is_nearest; /* 1: the minimum with the least |d|, whatever it is, and others with gaps below
                     settings->search_gap; 0: all minima with -depth <= d <= gap */
  long effort;    /* most pairs of cells of features looked at for one feature pair; then the search is given up */
  mg_real gap;    /* m */
  mg_real depth;  /* m */
  const mg_real *pose_o; /* [12] pose of o */
  const mg_real *pose_f; /* [12] pose of f */
  int *count;            /* [1] minima found */
  int *is_complete;      /* [1] 1: there are no others; is_nearest: none is nearer, and no two vertices, or a vertex
                            and an edge, are */
  int *feature_pair;     /* [MG_MINIMA] feature pair of each, in order of |d| */
  mg_real *d;            /* [MG_MINIMA] distance, m */
  mg_real *normal;       /* [3 MG_MINIMA] unit normal from o to f */
  mg_real *point_o;      /* [3 MG_MINIMA] point of o, m */
  mg_real *point_f;      /* [3 MG_MINIMA] point of f, m */
  mg_real *eta;          /* [6 MG_MINIMA] eta, 0 where the contact kind has fewer entries */
  mg_real *margin;       /* [2 MG_MINIMA] the two margins of the place kernel: 1 and 1/m */
} mg_minima_queries;

/* Directions along which a run is differentiated: changes of the start and of the numbers of the system. Row k of an
   array is direction k; a null pointer stands for zeros. */
typedef struct {
  int n;                           /* directions */
  const mg_real *start;            /* [n_q + n_u + n_eta + 1] q, u; the rest is not used */
  const mg_real *parameters;       /* [n_parameters] */
  const mg_real *gravity;          /* [3] */
  const mg_real *restitution;      /* [n_contact] */
  const mg_real *friction_static;  /* [2 n_friction] */
  const mg_real *friction_kinetic; /* [2 n_friction] */
  const mg_real *patch_friction;   /* [2 n_patch] */
  const mg_real *input;            /* [3 n_input] settings of inputs */
  const int *moves_borders;        /* [1] 1: numbers of features and conditions change as well */
  const int *is_permitted;         /* [1] 1: of a change of the start only what closed contacts permit is meant; a null
                                      pointer stands for ones */
  const mg_real *given;            /* [n_q + n_u + n_eta + 1], once: the state that mg_begin was given; null: a state
                                      that it did not change */
} mg_directions;

/* How far a derivative can be trusted. */
enum {
  MG_VERDICT_DIFFERENTIABLE = 0, /* the run is differentiable */
  MG_VERDICT_ONE_SIDED = 1,      /* along some directions it holds for changes to one side alone (mg_tangent.sides) */
  MG_VERDICT_UNDECIDED = 2       /* the reason says what stands against it */
};

/* For which changes along a direction a derivative holds, as bits: on a kink the run is on a branch that changes to one
   side, or to none, keep. */
enum {
  MG_SIDE_LARGER = 1,  /* changes by positive multiples of the direction */
  MG_SIDE_SMALLER = 2, /* by negative ones */
  MG_SIDES = 3,        /* both */
  MG_SIDE_UNKNOWN = 4  /* something else stands against it; the other bits say nothing then */
};

/* Why a derivative is not certain. */
enum {
  MG_NO_REASON = 0,
  MG_BY_TIME_STEPPING = 1,    /* a part of the run is time-stepping */
  MG_BY_ROLLING_START = 2,    /* a face tilts onto its rim */
  MG_BY_SLIP_ONSET = 3,       /* slip begins and its direction depends on the change */
  MG_BY_STIFF_SLIP = 4,       /* slow slip is turned fast by friction */
  MG_BY_SEVERAL_EVENTS = 5,   /* several events at one time */
  MG_BY_REDUNDANT_ROWS = 6,   /* impulses are not unique */
  MG_BY_FACES = 7,            /* faces come to rest on each other, or rub */
  MG_BY_SINGULAR_CONTACT = 8, /* a singular contact is passed by an impulse */
  MG_BY_GRAZE = 9,            /* the event function does not cross zero transversally */
  MG_BY_REST_SPEED = 10,      /* bounces that are ever shorter are cut off */
  MG_BY_SLIP_STOP = 11,       /* slip dies in three dimensions */
  MG_BY_IMPACT_LAW = 12,      /* an impact whose law is not differentiated */
  MG_BY_JUMP = 13,            /* state or acceleration jump for another cause */
  MG_BY_START = 14,           /* the start is corrected by an impact */
  MG_BY_ANISOTROPY = 15,      /* friction differs from direction to direction */
  MG_BY_BORDER = 16,          /* the border of a feature moves */
  MG_BY_LOAD = 17,            /* a load jumps where the motion takes it */
  MG_BY_UNLOADED = 18,        /* a closed contact carries no load, and a change makes it press or open */
  MG_BY_BOUND = 19,           /* contact forces stay at their bound, and a change leads to either side of it */
  MG_BY_LOAD_KINK = 20,       /* a load stays on a kink, or starts at a jump */
  MG_BY_ONE_WAY = 21,         /* a number moves the start of a contact that touches: it opens on one side alone */
  MG_BY_SENSOR_KINK = 22,     /* a sensor is on a kink or at a jump */
  MG_BY_FORCES = 23           /* a sensor shows forces that are not unique */
};

#define MG_TAPE_CROSSING 25 /* numbers of the events of a step: of four islands at most */

/* What a run leaves behind so that it can be gone through backwards; the caller's arrays. */
typedef struct {
  long capacity;        /* steps for which there is room */
  long count;           /* steps so far */
  unsigned char *bytes; /* [(capacity + 1) mg_save_size] the run before each step, and after the last */
  mg_real *slopes;      /* [12 (n_q + n_u + n_eta + 1) capacity] right-hand sides of the stages of each step */
  int *crossing; /* [MG_TAPE_CROSSING capacity] events of each step: in how many islands they are, and of each the
                    kind of event function, contact or switching function, constraint, whether it is a blow, reason,
                    island */
  long lost; /* number, from 1 on, of the first step that is not differentiated, so that all cotangents are NaN; or 0 */
} mg_tape;

/* Cotangents: derivatives of one number by the state of a run and by the numbers of the system; the caller's arrays. */
typedef struct {
  mg_real *x;                /* [n_q + n_u + n_eta + 1] */
  mg_real *parameters;       /* [n_parameters] */
  mg_real *gravity;          /* [3] */
  mg_real *restitution;      /* [n_contact] */
  mg_real *friction_static;  /* [2 n_friction] */
  mg_real *friction_kinetic; /* [2 n_friction] */
  mg_real *patch_friction;   /* [2 n_patch] */
  mg_real *input;            /* [3 n_input] */
  mg_real *work;             /* [mg_sensitivity_size for one direction] scratch memory */
  int *iwork;                /* [mg_sensitivity_int_size] */
  const mg_real *given;      /* as in mg_directions */
} mg_adjoint;

/* Derivatives of a run; the caller's arrays. */
typedef struct {
  mg_real *x;           /* [n (n_q + n_u + n_eta + 1)] derivative of the state, direction after direction */
  int capacity;         /* events for which there is room */
  int count;            /* events that have been differentiated; beyond capacity they are counted only */
  mg_real *event_t;     /* [capacity] time of each event, s */
  int *event_contact;   /* [capacity] contact of its event function */
  mg_real *event_t_dot; /* [n capacity] derivative of its time */
  int verdict;          /* MG_VERDICT_DIFFERENTIABLE .. MG_VERDICT_UNDECIDED */
  int reason;           /* MG_NO_REASON .., of the first cause of the verdict */
  mg_real reason_t;     /* time of that cause, s */
  int reason_contact;   /* contact of that cause, or -1 */
  mg_real *work;        /* [mg_sensitivity_size] scratch memory, which lasts as long as the run */
  int *iwork;           /* [mg_sensitivity_int_size] */
  mg_tape *tape;        /* receives the steps, or null */
  int is_lost;          /* 1: something of the run is not differentiated, and all derivatives from there on are NaN */
  int *sides; /* [n] MG_SIDE_LARGER .. as bits: for which changes along each direction the derivatives hold. Null: the
                 caller does not ask, and a kink makes the verdict MG_VERDICT_UNDECIDED */
} mg_tangent;

/* Derivatives of runs, from here to mg_go_back_to_start: in libraries that are generated with derivatives alone. */

/* Lengths of the scratch memory of derivatives along n directions. */
MG_API long mg_sensitivity_size(const mg_system *system, int n);
MG_API long mg_sensitivity_int_size(const mg_system *system);

/* Derivatives of the state of a run that has just begun. Returns MG_DONE, or MG_NOT_FINITE if the library was generated
   without derivatives. */
MG_API int mg_begin_tangent(const mg_system *system, const mg_settings *settings, mg_run *run,
                            const mg_directions *directions, mg_tangent *tangent, mg_real *work, int *iwork);

/* As mg_advance, with the derivatives of the state. The run is the same to the last bit, but for more and shorter steps
   to an instant at which slip dies whose direction changes, and over one at which derivatives of the right-hand side
   jump. Returns MG_LIST_FULL as well where the tape has no room for another step. */
MG_API int mg_advance_tangent(const mg_system *system, const mg_settings *settings, mg_run *run,
                              const mg_directions *directions, mg_tangent *tangent, mg_real t_stop, long max_steps,
                              mg_record *record, mg_events *events, mg_real *work, int *iwork);

/* Derivatives [n kernels->n_sensor] of what the sensors show at the state of the run, direction after direction.
   reasons: [kernels->n_sensor] why those of a sensor do not hold for this state, or not for both sides, or
   MG_NO_REASON. sides: [n kernels->n_sensor] for which changes they hold, beside mg_tangent.sides, or null. */
MG_API void mg_sense_tangent(const mg_system *system, const mg_settings *settings, mg_run *run,
                             const mg_directions *directions, mg_tangent *tangent, mg_real *sensors, int *reasons,
                             int *sides, mg_real *work, int *iwork);

/* Adds to the cotangents of state and numbers those that follow from the cotangents of what the sensors show at the
   state of the run. */
MG_API void mg_sense_adjoint(const mg_system *system, const mg_settings *settings, mg_run *run,
                             const mg_real *sensors_bar, mg_adjoint *adjoint, mg_real *work, int *iwork);

/* Takes the cotangents from after step `from` - 1 of a tape back to before step `to`; the run is overwritten with that
   before step `to`. If run->stop ends the call, the cotangents are NaN. */
MG_API void mg_go_back(const mg_system *system, const mg_settings *settings, mg_run *run, const mg_tape *tape,
                       long from, long to, mg_adjoint *adjoint, mg_real *work, int *iwork);

/* Takes the cotangents at the start of a run back through the corrections of mg_begin. */
MG_API void mg_go_back_to_start(const mg_system *system, const mg_settings *settings, mg_run *run, mg_adjoint *adjoint,
                                mg_real *work, int *iwork);

/* Reasons not to trust a run, as bits: what the figures of the run show without a second run. */
enum {
  MG_DOUBT_ENDED = 1,            /* the run ended early */
  MG_DOUBT_GAP = 2,              /* a closed contact was open by more than gap_error_max */
  MG_DOUBT_PENETRATION = 4,      /* bodies penetrated deeper than gap_error_max */
  MG_DOUBT_JOINT = 8,            /* a joint was apart by more than start_joint_gap */
  MG_DOUBT_ENERGY = 16,          /* energy that work does not explain, and of corrections, above energy_error_max */
  MG_DOUBT_COMPLEMENTARITY = 32, /* forces pull, or act across gaps, by more than complementarity_error_max */
  MG_DOUBT_IMPACT_GAIN = 64,     /* an impact added more energy than energy_error_max */
  MG_DOUBT_NO_GAMMA = 128,       /* Gamma2 is left out */
  MG_DOUBT_TIME_STEPPING = 256,  /* the run, or a part of it, was time-stepping, which locates no events */
  MG_DOUBT_SLIP_STOP = 512,      /* slip died within fixed steps, which then lose their order */
  MG_DOUBT_INDETERMINATE = 1024, /* the motion is one of several, or is not proved to be the only one */
  MG_DOUBT_FLUSH = 2048,         /* a blow on an edge in the plane of a face: rounding decides whether it is struck */
  MG_DOUBT_UNFOLLOWED = 4096,    /* closest points were found that no contact was free to follow */
  MG_DOUBT_INCOMPLETE = 8192,    /* a search for closest points was given up */
  MG_DOUBT_STAND_IN = 16384,     /* contacts are with a shape that stands for another surface, as a hull for a mesh */
  MG_DOUBT_CAPACITY = 32768      /* a capacity was exceeded, and something left out (exceeded of its report) */
};

/* Energy to which energy errors are relative, J: the largest kinetic energy, or of what has not moved m (L/T)^2. */
MG_API mg_real mg_moved_energy(const mg_system *system, const mg_run *run);

/* Energy error that rounding of energy and work in each step may add up to, J. */
MG_API mg_real mg_energy_rounding(const mg_system *system, const mg_run *run);

/* The reasons not to trust a run that has come to `outcome` (mg_begin, mg_advance), MG_DOUBT_ENDED .. as bits; 0: none.
   An outcome below MG_PENETRATION ends no run. What a finer run would show, its error, is not among them. */
MG_API int mg_doubts(const mg_system *system, const mg_settings *settings, const mg_run *run, int outcome);

/* A doubt in words, for one bit. */
MG_API const char *mg_doubt_text(int doubt);

/* Value of MG_ABI with which the library was compiled. */
MG_API int mg_abi(void);

/* Size of mg_real in bytes. */
MG_API int mg_real_size(void);

/* Digest of the shapes of which bounds are kept in the scratch memory: their kinds, parameters, domains and scales. */
MG_API mg_digest mg_shapes_digest(const mg_system *system);

/* Length of the scratch array `work` of all functions below, in mg_real; -1 where closed_capacity is larger than the
   solvers can number (26000 rows with friction and joints). It grows with the square of closed_capacity; results do
   not depend on closed_capacity as long as a run does not end with MG_TOO_MANY_CLOSED. */
MG_API long long mg_work_size(const mg_system *system);

/* Length of the scratch array `iwork` of all functions below, in int; -1 as mg_work_size. */
MG_API long long mg_iwork_size(const mg_system *system);

/* Begins a run at run->t from run->x: finds the closest points of all pairs, decides which contacts are closed,
   assembles the joints, resolves impacts at the start and determines the contact modes. Resets what the run reports.
   Returns MG_DONE, or the outcome that refuses the start; MG_CONTINUE if run->stop has ended the call: the run has not
   begun, and run->x is to be set again. */
MG_API int mg_begin(const mg_system *system, const mg_settings *settings, mg_run *run, mg_events *events, mg_real *work,
                    int *iwork);

/* Advances a run until t_stop, for at most max_steps attempted steps, and appends samples and events. Inputs that have
   changed take effect first: contacts with bodies whose prescribed velocity jumps are struck or released, and the
   contact modes under the new loads are chosen.
   Returns an outcome, MG_DONE at t_stop. The list of events needs room for 4 n_contact + 2 n_switch + 2 entries at
   every step. */
MG_API int mg_advance(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real t_stop, long max_steps,
                      mg_record *record, mg_events *events, mg_real *work, int *iwork);

/* Begins n independent runs and advances each to t_stop. outcome [n] receives their codes. `events` is emptied as
   often as needed; no samples are taken. A run that its `stop` has ended has MG_CONTINUE. */
MG_API void mg_batch(const mg_system *system, const mg_settings *settings, int n, mg_run *runs, mg_real t_stop,
                     int *outcome, mg_events *events, mg_real *work, int *iwork);

/* A controller: shown the sensors [n_sensor] at time t, it writes commands [n_input]: the value of an input, or its
   rate if it follows a line. `command` holds the present ones when it is called. */
typedef void (*mg_control)(void *data, mg_real t, const mg_real *sensors, mg_real *command);

/* When a controller is called. The caller fills all but `calls`, which is 0 at first. */
typedef struct {
  mg_control call;
  void *data;       /* passed on to it */
  mg_real period;   /* s, between two calls */
  mg_real start;    /* time of its first call, s */
  long calls;       /* calls so far */
  mg_real *sensors; /* [n_sensor] memory for what it is shown */
  mg_real *command; /* [n_input] memory for its commands */
} mg_controller;

/* As mg_advance, with a controller called at its instants from run->t on, t_stop excluded. A value beyond the range of
   its input is set to the nearest end; a command that is not finite ends the run with MG_NOT_FINITE. */
MG_API int mg_advance_controlled(const mg_system *system, const mg_settings *settings, mg_run *run,
                                 mg_controller *controller, mg_real t_stop, long max_steps, mg_record *record,
                                 mg_events *events, mg_real *work, int *iwork);
/* Begins n lanes: runs that have nothing in common but the scratch memory. Arrays have one entry for each lane: its
   system and its settings, which lanes may share; its run; its outcome, as mg_begin returns it; its list of events.
   Here and in the next two: *taken, 0 before the call, is the number of lanes that have been taken. Threads that make
   the same call at once, with the same `taken` and scratch memory of their own, as long as that of the largest system,
   share the lanes; a call that finds *taken = n does nothing. No result depends on how lanes are shared. */
MG_API void mg_begin_many(int n, int *taken, const mg_system *const *systems, const mg_settings *const *settings,
                          mg_run *runs, int *outcome, mg_events *events, mg_real *work, int *iwork);

/* Advances n lanes that have begun, each to its own t_stop [n]. Lanes whose outcome is a failure, MG_PENETRATION or
   higher, are left as they are. Of the others the outcome becomes MG_DONE, MG_LIST_FULL (empty the list and call
   again), MG_CONTINUE if the lane's run->stop has ended its advance, or that which ended the run; it does not depend on
   other lanes. */
MG_API void mg_advance_many(int n, int *taken, const mg_system *const *systems, const mg_settings *const *settings,
                            mg_run *runs, const mg_real *t_stop, int *outcome, mg_events *events, mg_real *work,
                            int *iwork);

/* Writes what the sensors of n lanes show at their states into sensors [n * kernels->n_sensor], lane after lane. */
MG_API void mg_sense_many(int n, int *taken, const mg_system *const *systems, const mg_settings *const *settings,
                          mg_run *runs, mg_real *sensors, mg_real *work, int *iwork);

/* What mg_load found. */
enum {
  MG_LOADED = 0,              /* the run has been loaded; with any other code it is as it was */
  MG_LOAD_NO_CHECKPOINT = 1,  /* the bytes are no checkpoint, or one of a machine with another order of bytes */
  MG_LOAD_OTHER_ABI = 2,      /* saved with another MG_ABI */
  MG_LOAD_OTHER_REAL = 3,     /* saved with another mg_real */
  MG_LOAD_OTHER_LIBRARY = 4,  /* saved with a library of another content hash */
  MG_LOAD_OTHER_SIZES = 5,    /* saved of a system of other sizes: numbers of bodies, contacts, .. */
  MG_LOAD_OTHER_TABLES = 6,   /* saved of a system with other tables: indices, parameters, masses, friction, .. */
  MG_LOAD_OTHER_SETTINGS = 7, /* saved with other settings */
  MG_LOAD_DAMAGED = 8         /* bytes are missing, or are not those that were saved */
};

/* The number by which results tell a contact of a run, whatever slot its pair is in. A contact of a slot is told as
   n_contact + (p - n_pair) (slot_contact_max + 1) + k, with p = pool_told_pair + rank of o * pool_width + rank of f of
   its pair, and k its number among the contacts of its slot, slot_contact_max for support points; any other one by its
   own number. The report of a run tells contacts so. */
MG_API int mg_told_contact(const mg_system *system, const mg_run *run, int contact);

/* Length in bytes of a checkpoint of a run of this system. */
MG_API long mg_save_size(const mg_system *system);

/* Saves the state of a run between two calls, mg_save_size bytes. A run into which it is loaded goes on bit for bit as
   this one. System and settings are not saved; their digests are, so that mg_load can compare them. */
MG_API void mg_save(const mg_system *system, const mg_settings *settings, const mg_run *run, unsigned char *bytes);

/* Loads `length` bytes that mg_save wrote into a run, whose pointers are set and which need not have begun. Returns
   MG_LOADED or what differs. */
MG_API int mg_load(const mg_system *system, const mg_settings *settings, mg_run *run, const unsigned char *bytes,
                   long length);

/* Takes n steps of RK4 of settings->step with a fixed active set: no events, no projection, no diagnostics. */
MG_API void mg_smooth(const mg_system *system, const mg_settings *settings, mg_run *run, long n, mg_real *work,
                      int *iwork);

/* Evaluates the right-hand side x_dot [length of x] at time t and state x [length of x] with the active set of the run;
   loads are taken as they are written, unless they slide on a zero of a switching function. Writes run->force. */
MG_API void mg_evaluate(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real t, const mg_real *x,
                        mg_real *x_dot, mg_real *work, int *iwork);

/* Writes into rank [n_joint] how many rows of each joint are independent of the rows of the joints before it, at the
   run's state. */
MG_API void mg_joint_ranks(const mg_system *system, const mg_settings *settings, mg_run *run, int *rank, mg_real *work,
                           int *iwork);

/* After MG_NOT_FINITE: returns the first function of time that is not finite or has a pole where the run ended, or -1.
   Loads are numbered first, then bodies (their prescribed paths), then joints (their prescribed motions). */
MG_API int mg_unbounded(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real *work, int *iwork);

/* Writes what the sensors of the scene show at the run's state into sensors [kernels->n_sensor]. */
MG_API void mg_sense(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real *sensors, mg_real *work,
                     int *iwork);

/* Writes the poses of all bodies at the run's state into pose [12 n_body]. */
MG_API void mg_pose_all(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real *pose, mg_real *work,
                        int *iwork);

/* Solves the extremality equations of one contact at the run's poses by Newton's method, from the given eta, until the
   residual is below settings->extremality_residual. Writes eta, d [1], residual [2], margin [2], normal [3], point_o
   [3] and point_f [3] as the place kernel gives them. Returns the number of steps, or -1 after 50. The run is not
   changed. */
MG_API int mg_settle(const mg_system *system, const mg_settings *settings, const mg_run *run, int contact, mg_real *eta,
                     mg_real *d, mg_real *residual, mg_real *margin, mg_real *normal, mg_real *point_o,
                     mg_real *point_f, mg_real *work, int *iwork);

/* Finds the closest points of n pairs of poses of one contact kind. */
MG_API void mg_closest(const mg_closest_queries *queries);

/* Heights (n) of points (3 n), world axes, over a solid, negative in its material, m: `pose` (12) is that of its body;
   `how`: MG_FIRST_ORDER or MG_LIPSCHITZ. */
MG_API void mg_solid_heights(const mg_system *system, int solid, const mg_real *pose, int how, int n,
                             const mg_real *points, mg_real *heights);

/* Searches a ball (centre, world axes, and radius, m) for a point deeper than `deep` > 0, m, in both of two solids:
   `pose` (24) are those of their bodies. Returns 1 if there is one; else writes into slack [1] a distance, m, by which
   the bodies can move in all, as a bound from below, before there is one. */
MG_API int mg_solids_overlap(const mg_system *system, const int *solid, const mg_real *pose, const mg_real *ball,
                             mg_real deep, mg_real *slack);

/* Finds the minima of the distance of a pair of bodies at n pairs of poses. `run` is one that has not begun. */
MG_API void mg_find_minima(const mg_system *system, const mg_settings *settings, mg_run *run,
                           const mg_minima_queries *queries, mg_real *work, int *iwork);

#include "region/region_queries.h"

#endif
