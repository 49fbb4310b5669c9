/* What the files of the core share: the scratch of one call. */
#ifndef MG_CONTEXT_H
#define MG_CONTEXT_H

#include "solve/friction/friction.h"
#include "kernels.h"
#include "solve/lcp/solvers.h"
#include "modelgen.h"
#include "region/region.h"

#define MG_GRID 17          /* samples along each side of a chart at the start */
#define MG_COARSE 9         /* and during a run */
#define MG_SAMPLES 289      /* MG_GRID squared */
#define MG_SAMPLE_SIZE 9    /* of a sample: in its shape's axes, in its body's, its direction there */
#define MG_STARTS 8         /* of Newton's method on one feature pair */
#define MG_MINIMA 24        /* closest points of one pair */
#define MG_LEAVES_FEATURE 3 /* mark in c->events.triggered: the contact leaves its feature pair */
#define MG_PASSES_BORDER \
  4 /* mark in c->events.triggered: it stays, but passes a border beyond which others may begin */

#define MG_NONFINITE_STEP_CUT ((mg_real)0.2) /* part of a step that is tried after one without a finite end */
#define MG_PRESSURE_AT_EDGE \
  5 /* mark in c->events.triggered of a slot's first support point: the centre of pressure leaves the hull */
#define MG_FACES_SEPARATE 6 /* the same: no force is left between the faces */
#define MG_ROLLS_ONTO_RIM 7 /* the same: an imaginary edge gives way to the rim */
#define MG_FLAT_AGAIN 8     /* the same: or to the face, which is flat again */
#define MG_EDGE_UNLOADED 9  /* the same: a side of the hull that is held no longer presses at one of its ends */

#define MG_FRICTION_EXCEEDED 10 /* the same: friction does not hold the faces any longer */
#define MG_SLIP_ENDS 11         /* the same: slip between the faces dies */

#define MG_POINT_PARAMETERS 32 /* more than the parameters of a point on a plane */
#define MG_RADAU_STAGES 7      /* stages of collocation */
#define MG_MAX_ETA 8           /* more than the entries of any contact's eta */
#define MG_STAGES 17           /* rows of K: 16 of DOP853, one spare for the right-hand side at events */

typedef struct mg_patch_friction mg_patch_friction; /* of a slot (rubs.h) */

typedef struct { /* a point of a shape: its chart coordinates, in the shape's axes, in the world */
  mg_real uv[2], local[3], point[3], direction[3];
} mg_sample;

typedef struct { /* where Newton's method starts on one feature pair, the likeliest first */
  int count;
  mg_real merit[MG_STARTS], eta[MG_STARTS][6];
} mg_newton_starts;

typedef struct {
  mg_real lower, upper;
} mg_event_margin; /* bounds of what is left before an event; MG_MAX: nothing is watched */

typedef struct { /* an extremum; undecided: which side of two curves is outside cannot be told */
  int feature_pair, undecided;
  mg_real d, margin, point[3], normal[3], eta[6];
} mg_minimum;

typedef struct {
  int count;
  mg_minimum list[MG_MINIMA];
} mg_minima;

typedef struct { /* of points of one body that another sees: how fast they move at most, and how fast that may grow */
  mg_real speed, acceleration;
} mg_motion_bound;

typedef struct { /* how the bodies of a fresh contact lean on each other during its first step */
  mg_real normal[3], outward[3], axis[3]; /* N and the way out in o's axes; N in f's axes */
  mg_real azimuth[MG_RADAU_STAGES], tilt[MG_RADAU_STAGES],
      stiffness[MG_RADAU_STAGES]; /* at the stages: rad from the way out; rad; 1/s^2 */
  mg_real tilt_start[3],
      tilt_rate[MG_RADAU_STAGES][3];      /* lean, in o's axes, and what it changes by at the stages, rad/s */
  mg_real whole_step[MG_RADAU_STAGES][2]; /* azimuth, stiffness of the whole step, while half is tried */
  mg_real azimuth_noise[MG_RADAU_STAGES]; /* what rounding of the poses makes of the azimuth, rad */
} mg_rolling_start;

typedef struct { /* a contact's lean: the part across N of what was N when f lay flat, and the frame of an azimuth */
  mg_real normal[3], along[3], across[3], tilt[3];
} mg_contact_tilt;

typedef struct { /* over a singular place: as it was before, per row 12, 1, 1, per contact 3, 3, per body 6, 6; least
                    margin after */
  mg_real *column, *rate, *impulse, *point, *landing_point, *free_twist, *impulse_work, power, margin;
} mg_singular_passage;

/* Scratch memory of one call, by subject. All arrays are carved from the caller's memory (run/workspace.c). */

typedef struct { /* complementarity problem over listed rows, and the solvers' memory */
  mg_real *A, *b, *z, *work;
  mg_real *reduced_A, *reduced_b, *reduced_z; /* joints eliminated */
  int *rows, *mask, *iwork;                   /* rows of the problem; of which the active set is */
  int *joint_mask;                            /* joint rows among those assembled */
  int *column;                                /* per row: its column in A, else -1 */
} mg_lcp_workspace;

typedef struct {                    /* rows that share moving bodies */
  int *parent, *head, *next, *rows; /* union-find over bodies; chain of rows of each island; rows of one */
  int *incident_begin, *incident;   /* rows at body b: incident[incident_begin[b]] .. */
} mg_island_workspace;

typedef struct { /* rank of the joint rows */
  mg_real *independence,
      *best_independence; /* per row: its part independent of the others, 0..1; per joint: largest product */
  mg_real *previous_MJ;   /* per row 12: M^-1 J^T after the step before */
  int *was_independent, *is_independent; /* per row: after the step before; at any step */
} mg_joint_workspace;

typedef struct {                     /* friction of single contacts */
  mg_real *force_ratio;              /* per friction row: force of slip over -N */
  mg_real *slip_angle;               /* per friction constraint: rad, direction of slip from run->slip_direction */
  int couples_normal, follows_angle; /* while forces are sought: slipping rows follow N; and slip_angle */
  int *triggered,
      *mode_before;         /* per friction constraint: its event has triggered; its mode at the start of the step */
  int *bound, *is_yielding; /* per friction constraint: MG_BOUND_..; its force exceeds the bound */
  mg_real *slip_time_left;  /* per friction constraint: s, that slip which was stopped would have lasted */
  mg_real *cone, *work;     /* MG_CONE a contact; memory of the solver */
  int *cone_contact, *cone_first, *cone_rows, *marks, *iwork; /* per contact of the problem */
} mg_friction_workspace;

typedef struct { /* planar contacts: the patch looked at last, and one record a slot */
  mg_arc *arcs;  /* boundaries of a patch */
  mg_region_pair regions;
  mg_real *hull_memory;
  mg_hull hull;
  int hull_patch;                    /* the patch whose hull is laid, or -1 */
  mg_real deepest, deepest_point[2]; /* m: largest margin found inside that hull, and its point */
  mg_patch_friction *friction;       /* per slot */
  mg_winkler_pressure_field pressure;
  mg_boundary_strip *strips;
  long strip_capacity;
  mg_real *reduced_problem; /* friction problem without bilateral rows */
  int pressure_rounds;      /* pressures tried for the forces that are sought */
  int *is_covered;          /* per contact: covered by a patch that is held */
  int *trial, *barred;      /* per slot: MG_TRIAL_..; a patch not to be held again now, or -1 */
} mg_patch_workspace;

typedef struct {      /* search for closest points */
  mg_sample *samples; /* of both sides of a feature pair: 2 MG_SAMPLES */
  mg_real *merit;     /* of the samples of o with their best mate */
  int *mate;
  mg_real *table;    /* samples kept between searches, MG_SAMPLE_SIZE each */
  int *table_filled; /* per table */
  mg_newton_starts starts;
  mg_minima abandoned; /* closest points that contacts left in this step */
  mg_real *placement;  /* outputs of the place kernel */
} mg_search_workspace;

typedef struct { /* one step of the integrator */
  mg_real *slopes, *stage, *end,
      *settled;          /* slopes of the stages; states: at a stage, at the end, at the end with eta corrected */
  mg_real *scale;        /* per state: size against which its error is measured */
  mg_real *interpolant;  /* 8 rows */
  mg_real *time_samples; /* what functions of time do in the step */
  mg_rolling_start *rolling_starts; /* per contact */
  mg_real rolling_step; /* s: a step from flat tried at this state, which the interpolant follows; 0: none */
  mg_real slip_limit;   /* s: longest explicit step after slip has begun */
  mg_real stop_time;    /* s: where mg_advance stops */
  int sign_changed;     /* an event function changed sign at a stage */
} mg_step_workspace;

typedef struct {      /* events of one step */
  int *triggered;     /* per contact: 0, 1, or MG_LEAVES_FEATURE .. */
  int *within_border; /* per contact: within its watched borders at the start of the step; MG_PASSES_BORDER: on one */
  int *broken_condition;    /* per contact: the condition that leads it off its feature pair */
  mg_real *gap_before;      /* per contact 2: d and d_dot where the step, or the part looked at, begins */
  int *gap_dips;            /* per contact: MG_GAP_MAY_CLOSE .. within that part */
  mg_event_margin *margins; /* what is left before events at samples of a step, then now: per contact, per slot
                               (force, margin of the centre of pressure, friction), per friction constraint */
  int *is_near;             /* per contact: takes part in a step of time-stepping */
  mg_singular_passage passage;
} mg_event_workspace;

typedef struct {
  int joint_row_begin, joint_row_end;       /* rows of joints */
  int friction_row_begin, friction_row_end; /* rows of friction */
  int support_begin;                        /* contacts from here on are support points of patches */
  int support_feature_pair_begin;           /* feature pairs from here on are those of support points */
  int n_states;                             /* length of x */
  int work_state;                           /* index of the work in x */
  int n_live_states;                        /* states without the eta of contacts on no feature pair */
  int n_driven, n_moving;                   /* bodies of given motion; bodies that forces move */
  int has_prescribed_joint;                 /* the motion of a joint is a function of time */
  int n_timed;                              /* functions of time */
  int n_state_loads, n_steady_loads;        /* loads that depend on the state; those of them that do not on time */
} mg_layout;                                /* order of rows: contacts, a spare contact, joints, friction */

typedef struct {
  mg_real *pose;         /* per body 12: position of the centre of mass, m, and rotation matrix by columns */
  mg_real *twist;        /* per body 6: velocity, world axes, m/s, and angular velocity, body axes, rad/s */
  mg_real *acceleration; /* per body 6: rate of the twist, without contact forces until those are found */
  mg_real *wrench;       /* per body 6: force, world axes, N, and torque, body axes, N m */
} mg_body_workspace;

typedef struct {        /* rows of constraints: one per contact, joint row and friction row */
  mg_real *J, *MJ;      /* per row 12, body o then f: J and M^-1 J^T */
  mg_real *d;           /* per row: gap or joint error, m or rad */
  mg_real *gamma;       /* per row: velocity term Gamma2 of d's second derivative */
  mg_real *d_dot;       /* per row: first derivative of d */
  mg_real *time_rate;   /* per row: the part of d_dot by functions of time */
  mg_real *row_rate;    /* per row: second derivative of d, or the velocity asked for in an impact or correction */
  mg_real *normal;      /* per contact 3: N, world axes */
  mg_real *tangents;    /* per contact 6: t1, t2, world axes */
  mg_real *eta_dot;     /* n_eta: rate of the closest-point coordinates */
  mg_real *kernel_rows; /* rows of one contact as its kernel writes them: 6, 6 and 1 a row */
} mg_row_workspace;

typedef struct {
  mg_real *force;   /* per row: N or N m */
  mg_real *impulse; /* per row: N s or N m s */
} mg_row_solution;

typedef struct {                                 /* per contact: kind and bodies of its feature pair */
  int *kind, *o, *f;                             /* index of the contact kind; bodies o and f */
  int *n_eta, *parameters;                       /* length of eta, 0 on no feature pair; offset into parameters */
  mg_real point_parameters[MG_POINT_PARAMETERS]; /* parameters of a support point's contact */
} mg_contact_view;

typedef struct {
  const mg_system *system;
  const mg_kernels *kernels;
  const mg_settings *settings;
  mg_run *run;
  mg_layout layout;
  mg_body_workspace bodies;
  mg_row_workspace rows;
  mg_row_solution solution;
  mg_contact_view contacts;
  mg_lcp_workspace lcp;
  mg_island_workspace islands;
  mg_joint_workspace joints;
  mg_friction_workspace friction;
  mg_patch_workspace patches;
  mg_search_workspace search;
  mg_step_workspace step;
  mg_event_workspace events;
} mg_context;

typedef struct { /* two shapes of a contact kind, where they are */
  const mg_kernels *kernels;
  int kind;
  const mg_real *pose_o, *pose_f, *parameters;
} mg_shape_pair;

typedef struct {             /* what Newton's method is asked for */
  mg_real length, tolerance; /* a residual below (small * length, small) */
  const mg_real *step_limit; /* how far each entry of eta may go in one step */
} mg_newton_goal;

typedef struct { /* their separation function along a normal */
  mg_real normal[3], d, slope[2], hessian[3], tangents[6], eta[6];
} mg_separation_view;

#endif
