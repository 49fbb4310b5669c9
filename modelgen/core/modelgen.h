/* Contact dynamics of smooth bodies: the part that runs.

   A program fills an mg_system (the bodies, contacts and loads of one scene, as tables over the kinds that this
   library was generated with), an mg_settings, an mg_run (the state), gives scratch memory, and calls mg_begin
   once and mg_advance until it answers MG_DONE. Nothing here allocates, prints or keeps static state.

   Units are SI. Vectors are in world axes except angular velocities and torques, which are in body axes.
   The state is x = [q of all bodies, u of all bodies, eta of all contacts, work].
   A limit of a joint is a contact without shapes, on a feature pair of its own.
   A patch is a planar region of one shape that may rest on one of another. While it does, a slot holds it: three
   support points, contacts of points of f on the plane of o, which hold both ways, on the feature pairs of the patch.
 */
#ifndef MODELGEN_H
#define MODELGEN_H

#include "solve/friction/friction.h"
#include "kernels.h"
#include "solve/lcp/lcp.h"
#include "base/real.h"

#define MG_ABI 10

/* A contact follows the closest points of one pair of shapes. Shapes have features (faces, edges, vertices); two of
   them that can touch in a point are a feature pair. A contact is on one feature pair at a time, or on none, and walks
   to another feature pair of its pair where a condition of its own ends. */
enum {
  MG_CONDITION_QUADRIC = 0,
  MG_CONDITION_PARAMETER = 1,
  MG_CONDITION_DISC = 2,
  MG_CONDITION_WING = 3,
  MG_CONDITION_DIRECTION = 4,
  MG_CONDITION_TILT = 5
}; /* conditions: holds at >= 0 */
enum { MG_BEYOND_ENDS = -1, MG_BEYOND_WATCHED = -2 }; /* beyond it: the contact ends; it stays, but others may begin */
enum {
  MG_SEARCH_NEVER = 0,
  MG_SEARCH_MOVED = 1,
  MG_SEARCH_ALWAYS = 2,
  MG_SEARCH_AHEAD = 3
}; /* in steps within sight */
enum {
  MG_FRICTION_SLIP = 0,
  MG_FRICTION_SPIN = 1,
  MG_FRICTION_ROLL = 2
}; /* what a friction constraint holds: slip along t1, t2; spin about N; rolling about t1, t2 */
enum {
  MG_FEATURE_PLACEMENT = 0,
  MG_FEATURE_DOMAIN = 12,
  MG_FEATURE_BALL_RADIUS = 16,
  MG_FEATURE_BALL_CENTRE = 17,
  MG_FEATURE_UV_SCALE = 20
}; /* of one side of a feature pair:
shape in body axes (p, R), bounds of u and v (+-MG_MAX: none), radius and centre of a ball around the shape in its
axes, what u and v are measured against */

typedef struct {
  const mg_kernels *kernels; /* of the scene's library */
  int n_body, n_contact, n_load, n_pair, n_feature_pair;
  int n_q, n_u, n_eta;
  int closed_capacity;       /* room for so many closed contacts at a time; memory grows with its square */
  int n_joint, n_joint_row;  /* joints, and the rows of all of them */
  int n_patch, n_patch_slot; /* patches, with three feature pairs each, the last; how many rest at a time, with three
                          contacts each, the last */
  int n_sample_table;        /* sides whose samples are kept */
  int n_friction, n_friction_row; /* friction constraints of friction and resistance, and the rows of contacts below
                                     their normal ones */
  const int *body_kind, *body_q, *body_u, *body_parameters; /* kind; offsets into q, u, parameters */
  const int *contact_pair, *contact_eta,
      *contact_feature_pair; /* pair; offset into eta; feature pair at the start or -1: searched */
  const int *pair_contact, *pair_feature_pair,
      *pair_search; /* first contact, first feature pair (n_pair + 1); MG_SEARCH_.. */
  const int *feature_pair_kind, *feature_pair_o, *feature_pair_f, *feature_pair_parameters;
  const int *feature_pair_owner, *feature_pair_group; /* feature pairs of one flat face of two convex solids, else -1 */
  const int *feature_pair_condition;                  /* first condition (n_link + 1) */
  const int *feature_shape, *feature_parameters,
      *feature_numbers; /* two a feature pair: kind of shape, its parameters, numbers */
  const int *feature_table,
      *sample_table_first; /* the table that keeps a side's samples, or -1; its first (n_table + 1) */
  const int *condition_kind, *condition_feature, *condition_feature_pair,
      *condition_numbers; /* next: a feature pair, MG_BEYOND_ENDS, MG_BEYOND_WATCHED */
  const int *load_kind, *load_a, *load_b, *load_parameters;                 /* load_b: -1 for a load on one body */
  const int *joint_kind, *joint_a, *joint_b, *joint_parameters, *joint_row; /* row: the first of the joint's */
  const int *patch_pair, *patch_slots; /* the pair whose faces they are; slots, first and end, two a patch */
  const int *patch_arc, *patch_arc_f;  /* o's region: [patch_arc[p], patch_arc_f[p]), none: a whole plane; f's:
                                          [patch_arc_f[p], patch_arc[p + 1]) */
  const int *patch_numbers;            /* placement of o's face in body o, of f's in body f: 12 each */
  const int *patch_covered,
      *covered_feature_pair; /* covered[patch_cover[p]] ..: the feature pairs of the pair that lie in the patch */
  const int *arc_shape, *arc_parameters, *arc_numbers, *arc_loop; /* a curve: its kind and parameters; placement in
      the axes of its face (12), where it begins and ends (2); arcs of one loop run end to start */
  const int *contact_friction_row,
      *contact_friction; /* first of its rows below the normal one; first friction constraint (n_contact + 1) */
  const int *impact_law; /* one a contact: MG_NEWTON .. */
  const int *friction_kind, *friction_row,
      *friction_body;          /* MG_FRICTION_SLIP ..; first row of its contact's; axes of its direction, or -1 */
  const mg_real *mass_inverse; /* 10 a body: 1/m and the inverse inertia, column-major, body axes */
  const mg_real *restitution;  /* one a contact, 0..1, in the law of its impact */
  const mg_real *parameters;
  const mg_real *numbers; /* of sides and conditions */
  const mg_real *friction_static,
      *friction_kinetic; /* two a friction constraint, force (torque, m) over N: along its direction and across */
  const mg_real *friction_direction; /* three a friction constraint, axes of grip_body */
  const mg_real *patch_friction;     /* two a patch: static and kinetic coefficient, 0 without friction */
  const mg_real *pair_normal;        /* three a pair of curves: roughly N at the start; zeros: the second is outside */
  const mg_real *pair_ball; /* eight a pair: centre (axes of its first feature pair's body o) and radius of a ball
                               around a shape, < 0: none is; the same of f */
  const mg_real *scale;     /* one a state: the size against which its error is measured */
  mg_real gravity[3];
  mg_real length, mass, time; /* characteristic scales; tolerances below are relative to them */
} mg_system;

enum { MG_NEWTON = 0, MG_POISSON = 1, MG_STRONGE = 2 }; /* restitution gives back speed, impulse, or energy */

enum { MG_RK4 = 0, MG_DOP853 = 1, MG_TIME_STEPPING = 2 };

/* Of time-stepping: gaps close within a step; what touches stops approaching; the same half a step ahead. */
enum { MG_STEWART_TRINKLE = 0, MG_ANITESCU_POTRA = 1, MG_MOREAU = 2 };

typedef struct {
  int method;                /* MG_RK4, MG_DOP853 or MG_TIME_STEPPING */
  int stepping_scheme;       /* of time-stepping: MG_STEWART_TRINKLE .. */
  int stepping_friction_law; /* of time-stepping: MG_COULOMB or MG_RELAXED */
  int fallback;              /* where events cannot be told, time-stepping goes on for a while */
  int use_gamma;             /* 0 drops Gamma2: what engines that omit it integrate */
  int newton;                /* corrections of eta: 0 none, 1 once an accepted step, 2 also at every stage */
  int project;               /* 0 lets d and d_dot drift; n > 0 removes the drift every n accepted steps */
  int sequential;            /* contacts are struck one after another; 0: all at once where all follow Newton's law */
  int planar_contacts;       /* faces that lie on each other rest as patches; 0: on single contacts */
  mg_real step;              /* s: the step of RK4 and of time-stepping; DOP853's first step (0: chosen) */
  mg_real stepping_theta;    /* Moreau's: the part of a step after the positions at which its rows are taken */
  mg_real stepping_residual; /* impulses of a step of time-stepping that are found to this residual only will do */
  mg_real fallback_step;     /* steps of fallback_step * time where time-stepping goes on */
  mg_real
      fallback_progress; /* steps that get on by less than crawl * time in many tries, a third refused, cannot go on */
  mg_real tolerance;     /* DOP853: local error / scale, root mean square */
  mg_real contact_gap;   /* |d| <= gap * length counts as touching */
  mg_real start_gap;     /* the same for the given start; deeper penetration is refused */
  mg_real
      start_joint_gap; /* joints that fit at the start to start_joint * length are brought together, others refused */
  mg_real drift_tolerance; /* d beyond drift * length (d_dot: / time) is projected away */
  mg_real rest_speed;      /* an approach that rebounds below rest_speed * length / time is caught */
  mg_real slip_speed;      /* slip below slip_speed * length / time sticks, if the forces let it */
  mg_real
      friction_bound_margin; /* a friction constraint whose force has reached its bound is tried with this part less */
  mg_real rest_acceleration; /* separation below rest_acceleration * length / time^2 does not open a contact */
  mg_real event_tolerance;   /* an event is located to event * time */
  mg_real extremality_residual;    /* extremality residual (length, 1) to which eta is brought at the start */
  mg_real slip_stop_speed_ratio;   /* slip is stopped only where that takes no more than a speed arrest * slip_speed *
                                      length / time has */
  mg_real separation_speed_factor; /* a step is shortened at whose end a contact moves off faster than leap * tolerance
                                      * its speed */
  mg_real
      rest_loss_factor; /* so many times rest_acceleration: a gap held without force leaves its rest within a step */
  mg_real event_correction_step; /* beyond this part of the step an event is corrected only while that converges fast */
  mg_real contact_rank_tolerance; /* a contact whose own part of J M^-1 J^T is less than this is held by the others */
  mg_real joint_rank_tolerance; /* a row of a joint of which the others leave less than this part is theirs: no force is
                       sought along it, so that a dead centre is not divided by */
  mg_real appear_depth;         /* a contact that appears in a run may be below zero by depth * length */
  mg_real step_min;             /* a step below step_min * time ends the run */
  mg_real margin_warn;   /* a contact that starts where its margin is zero is excused from bounds on it up to here */
  mg_real margin_refuse; /* a closed contact whose margin falls below it ends the run */
  mg_real appear_margin; /* a contact without a feature pair of its own appears in a run only with more margin */
  mg_real
      appear_tilt_sine; /* a vertex or edge over a face is taken up while no edge or face beside it leans further out */
  mg_real search_margin;         /* closest points with less margin are not kept by a search */
  mg_real search_merge_distance; /* closest points nearer than apart * length are one */
  mg_real search_gap;            /* gaps below reach * length are followed when a pair is searched in a run */
  mg_real search_movement;       /* a pair that has moved by search * length is searched again */
  mg_real flat_angle;     /* a rim nearer to flat on a plane than this angle, rad, stands on points of it instead */
  mg_real imaginary_edge; /* > 0: over a rim a face turns on a tangent fixed in the body until it leans so far, rad */
  mg_real boundary_coincidence; /* boundaries of two faces nearer than shared * length are one */
  mg_real feature_border;       /* a contact walks when a condition falls below -border (angles; lengths: * length) */
  mg_real time_resolution;      /* what functions of time do within look * time may pass unseen */
  mg_real step_fraction;        /* part of the longest step allowed; < 1: none leads from event to event */
  int lcp_iterations;           /* bound on the active-set changes of one complementarity problem */
  int event_scan_parts;         /* parts of a step in which the first event is sought */
  int events_at_once_max;       /* transitions within one event tolerance of time before the run gives up */
} mg_settings;

/* What a friction constraint of a contact that carries force does: it holds; it slips from now on, of the second order
   in time; it has begun to and is slower yet than slip_speed; it slips along what its rows tell. */
enum { MG_FRICTION_OFF = 0, MG_STICKING = 1, MG_SLIP_ONSET = 2, MG_SLIP_STARTING = 3, MG_SLIPPING = 4 };

enum {
  MG_START_NONE = 0,
  MG_START_FLAT = 1,
  MG_START_SETTLING = 2, /* a contact that starts from flat; that did, its margin still small */
  MG_ON_STRAIGHT_EDGE = 3
}; /* the first support point of a slot: the first two hold a straight side of the hull */

enum {
  MG_DONE = 0,
  MG_CONTINUE = 1,
  MG_LIST_FULL = 2, /* t_stop reached; step limit; record or event list full */
  MG_PENETRATION = 10,
  MG_NO_EXTREMUM = 11,
  MG_NO_OUTSIDE = 12,
  MG_JOINT_APART = 13, /* the start is refused */
  MG_MARGIN = 20,
  MG_STEP_TOO_SMALL = 21,
  MG_NOT_FINITE = 22,
  MG_COMPLEMENTARITY = 23,
  MG_TOO_MANY_EVENTS = 24,
  MG_TOO_MANY_CLOSED = 25,
  MG_NO_FRICTION = 26
};

enum {
  MG_EVENT_IMPACT = 0,
  MG_EVENT_TOUCH_DOWN = 1,
  MG_EVENT_LIFT_OFF = 2,
  MG_EVENT_MARGIN = 3,
  MG_EVENT_FEATURE_CHANGE = 4,
  MG_EVENT_APPEAR = 5,
  MG_EVENT_VANISH = 6,
  MG_EVENT_FACE_CONTACT = 7,
  MG_EVENT_TIPPING = 8, /* of the first support point of a slot: its patch rests; turns over its edge */
  MG_EVENT_SLIP_START = 9,
  MG_EVENT_SLIP_STOP = 10,
  MG_EVENT_SLIP_REVERSAL = 11,
  MG_EVENTS_PER_FRICTION = 3, /* of slip; those of spin and of rolling follow, in this order */
  MG_EVENT_FALLBACK_START = 18,
  MG_EVENT_FALLBACK_END = 19
}; /* events are told no more; again */

typedef struct {
  mg_real t, h;      /* time and the next step to try, s */
  mg_real *x;        /* n_q + n_u + n_eta + 1 */
  int *feature_pair; /* per contact: the feature pair it is on, or -1 */
  mg_real *point;    /* per contact 3: of a support point or a fresh rim, the point of f, in its body's axes */
  mg_real *moved_since_search;   /* per pair: relative movement since it was searched, m */
  int *closed;                   /* per contact: its gap is held at zero */
  int *active;                   /* per contact: closed and carrying force */
  int *friction_mode;            /* per friction constraint: MG_FRICTION_OFF .. */
  mg_real *slip_direction;       /* three a friction constraint: where it slips, world, unit length; of spin: +-1 */
  int *patch_mode;               /* per slot: the same of a patch with friction, slip and spin together */
  mg_real *patch_slip_direction; /* four a slot: where its first support point's point slips, world, and spin by the
                                    radius of the support points; unit length */
  mg_real *reference_force;      /* per contact, a spare, per row of joints, per row below: forces from which the least
                          change is sought while redundant */
  mg_real *force;                /* per contact, N, at t */
  mg_real *margin;               /* per contact, at t */
  int *rolling_start;            /* per contact: MG_START_NONE, MG_START_FLAT, MG_START_SETTLING, MG_ON_STRAIGHT_EDGE */
  mg_real
      *tilt_direction; /* per contact 3: of a fresh one, the way it falls: along the plane, out of the hull (world) */
  long steps, rejected, rhs_evals, lcp_solves, since_projection, events_at_t;
  long progress_tries, progress_rejected;  /* steps when it was last looked whether they get on */
  long fallbacks, fallback_steps_left;     /* back on time-stepping: how often; steps to go */
  long loose_solutions, relaxed_solutions; /* problems of time-stepping solved to settings->stepping_residual only; by
                          the relaxation for want of a solution of Coulomb's law */
  long singular_passages;                  /* places passed where a closed contact was singular */
  long redundant_max; /* most active contacts beyond the rank of their rows: forces then are of minimum norm */
  mg_real t_event;    /* time of the last transition */
  mg_real t_roundoff; /* s: what rounding has left out of t */
  mg_real energy_0, energy_error_max, kinetic_max; /* J; error = |E - E_0 - work| */
  mg_real gap_max, complementarity_max, margin_min, lcp_residual_max;
  mg_real joint_error_max,
      joint_speed;       /* m: off the joints, at the start and after steps; m/s: off them at the start */
  mg_real dead_centre_t; /* the end of the step in which the first was passed */
  mg_real joint_margin_min, joint_margin_t; /* least that others left of a joint's rows against the most, 0..1; when */
  mg_real progress_t;                       /* s, then */
  mg_real fallback_first, fallback_end,
      fallback_time; /* s: when the run first fell back, ceased to last, how long in all */
  mg_real impact_gain_max, impact_gain_t, chain_impact_t,
      painleve_t;                /* J: the most energy that one contact made in an impact; s: when; when
a blow first reached a contact at rest; when forces were first indeterminate */
  int failed_contact;            /* the contact an outcome speaks of, or -1 */
  int failed_joint;              /* the joint that fits worst at the start, or -1 */
  int joint_margin;              /* the joint with the least margin, or -1 */
  int rank_min, rank_max;        /* of the rows of all joints, at accepted steps */
  int dead_centres, dead_centre; /* passed; the joint that was nearest to losing a row at the first */
  int impact_gain_contact, chain_impact_contact,
      painleve_contact;                   /* the contacts of gain_max, chain_t and paradox_t, or -1 */
  int fallback_cause, fallback_doublings; /* the outcome that the first fall avoided; of the steps of the last one */
  int passage_contact;                    /* the contact of the first of the vaults, or -1 */
  int forces_redundant;                   /* forces are not unique: `share` says which are meant */
} mg_run;

typedef struct { /* caller's arrays for the samples; t is given, count advances */
  int capacity, count;
  const mg_real *t;
  mg_real *pose, *twist;                                   /* 12 and 6 a body */
  mg_real *eta, *force, *gap, *normal, *point_o, *point_f; /* n_eta; per contact 1, 1, 3, 3, 3; gap of none: NAN */
  int *feature_pair;                                       /* per contact */
  int *patch;                                              /* per slot: what it holds, or -1 */
  mg_real *pressure;       /* 4 a slot: resultant force of its patch, centre of pressure, world */
  mg_real *patch_friction; /* 8 a slot: friction on f, world; its torque about N through the centre of pressure; slip of
                   f past o there, world; spin past o about N */
  mg_real *friction, *torque, *slip; /* 3 a contact, world, on f or of f past o: N; N m; m/s */
  mg_real
      *joint_wrench;   /* 6 a joint, on its second body: force, world, and torque about its centre of mass, body axes */
  mg_real *coordinate; /* 3 a joint: angles within half a turn, displacements; NAN where there are fewer */
  mg_real *energy, *work;
} mg_record;

typedef struct {
  int capacity, count;
  mg_real *t;
  int *kind, *contact, *feature_pair; /* the feature pair after the event */
  mg_real *speed;                     /* approach speed of an impact or touch-down, m/s, else 0 */
} mg_events;

enum {
  MG_CLOSEST_NOT_FOUND = 0, /* no extremum was found */
  MG_CLOSEST_STATIONARY = 1,
  MG_CLOSEST_LOCAL = 2, /* a saddle or a maximum of the distance; a local minimum */
  MG_CLOSEST_GLOBAL = 3
}; /* the least of all, by certificate or closed form */

typedef struct { /* n pairs of poses of one contact kind; caller's arrays, one row a pair */
  const mg_kernels *kernels;
  int kind, n;
  int is_warm_start; /* convex shapes: eta is near, and below contact the extremum that continues it is meant;
               other kinds always start from eta */
  long stride;       /* from the parameters of one pair to those of the next; 0: the same for all */
  const mg_real *parameters, *pose_o, *pose_f; /* of the kind; 12; 12 */
  const mg_real *step_limit;                   /* n_eta: how far each entry of eta may go in one step; MG_MAX: signs */
  mg_real length, residual; /* the extremality residual (length, 1) that is asked for is residual * length, residual */
  mg_real *eta;             /* n_eta */
  mg_real *d, *normal, *point_o, *point_f, *margin; /* 1, 3, 3, 3, 2: as the place kernel gives them */
  int *outcome;                                     /* 1: MG_CLOSEST_NOT_FOUND .. MG_CLOSEST_GLOBAL */
} mg_closest_queries;

MG_API int mg_abi(void);
MG_API int mg_real_size(void);
MG_API long mg_work_size(const mg_system *system);  /* in mg_real */
MG_API long mg_iwork_size(const mg_system *system); /* in int */

/* Brings eta to the extremum, decides which contacts are closed, takes first impacts. */
MG_API int mg_begin(const mg_system *system, const mg_settings *settings, mg_run *run, mg_events *events, mg_real *work,
                    int *iwork);

/* Runs to t_stop or for max_steps accepted steps. MG_LIST_FULL: empty the lists and call again. */
MG_API int mg_advance(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real t_stop, long max_steps,
                      mg_record *record, mg_events *events, mg_real *work, int *iwork);

/* n independent runs from their own starts to t_stop; outcome (n) holds their codes. `events` is scratch. */
MG_API void mg_batch(const mg_system *system, const mg_settings *settings, int n, mg_run *runs, mg_real t_stop,
                     int *outcome, mg_events *events, mg_real *work, int *iwork);

/* n steps of RK4 without event search, projection or ledger: the smooth part alone. */
MG_API void mg_smooth(const mg_system *system, const mg_settings *settings, mg_run *run, long n, mg_real *work,
                      int *iwork);

/* The right-hand side at (t, x) with the run's active set; x_dot has the length of x. */
MG_API void mg_evaluate(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real t, const mg_real *x,
                        mg_real *x_dot, mg_real *work, int *iwork);

/* How many rows of each joint are independent of those of the joints before it, at the run's state. */
MG_API void mg_joint_ranks(const mg_system *system, const mg_settings *settings, mg_run *run, int *rank, mg_real *work,
                           int *iwork);

/* Of a run that ended as MG_NOT_FINITE: the first function of time that is not finite where it ended, or has a pole
   there, or -1. Loads are counted first, then bodies for their paths, then joints for their motions. */
MG_API int mg_unbounded(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real *work, int *iwork);

/* The poses of all bodies at the run's state, 12 a body. */
MG_API void mg_pose_all(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real *pose, mg_real *work,
                        int *iwork);

/* Newton from the given eta of one contact until its residual is below settings->extremality_residual or 50 steps are
   taken. Returns the number of steps, or -1. d, margin, normal, points as the place kernel gives them. */
MG_API int mg_settle(const mg_system *system, const mg_settings *settings, const mg_run *run, int contact, mg_real *eta,
                     mg_real *d, mg_real *residual, mg_real *margin, mg_real *normal, mg_real *point_o,
                     mg_real *point_f, mg_real *work, int *iwork);

/* The closest points of n pairs of poses, one contact kind. */
MG_API void mg_closest(const mg_closest_queries *queries);

#include "region/region_queries.h"

#endif
