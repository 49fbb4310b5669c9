/* Derivatives of a run along directions: of the right-hand side, of one accepted step, of what happens at an event.
   May use: every room. Only a core for derivatives of runs is compiled with this one.

   A direction changes start state and numbers of the system (mg_directions). The derivative of the state along it is
   carried from step to step. Steps are those of the run; that they depend on the numbers as well changes the result
   only by the error of integration. At an event of the time t_e with an event function g,
     dt_e = -dg / (dg/dt),    dx+ = R'(dx- + f- dt_e) - f+ dt_e,
   with R the change of the state, f- and f+ the right-hand sides before and after (saltation; Hiskens and Pai, IEEE
   Trans. Circuits and Systems I 47 (2000), 204-220). */
#ifndef MG_SENSITIVITY_H
#define MG_SENSITIVITY_H

#include "model/context.h"
#include "forces/forces.h"
#include "integrate/integrate.h"

enum {
  MG_ROWS_OF_ONE = 6, /* rows of a contact or joint in the packed formulas */

  MG_Y_FIRST = 0,     /* in y of a contact or joint: J^T force of the first body */
  MG_Y_SECOND = 6,    /* of the second body */
  MG_Y_ACCEL = 12,    /* J a + gamma */
  MG_Y_RATE = 18,     /* J u, of a joint value_dot */
  MG_Y_VALUE = 24,    /* of a joint: value */
  MG_Y_GAP = 24,      /* of a contact: d */
  MG_Y_TANGENTS = 25, /* t1, t2 */
  MG_Y_ETA_DOT = 31   /* eta_dot */
};

/* The derivative along one direction at one state. */
typedef struct {
  mg_real *pose;         /* [12 per body]; the next two follow it */
  mg_real *twist;        /* [6 per body] */
  mg_real *acceleration; /* [6 per body] */
  mg_real *wrench;       /* [6 per body] */
  mg_real *value;        /* [per row] of d, of the value of a joint row; the next three follow it */
  mg_real *rate;         /* [per row] of J u */
  mg_real *residual;     /* [per row] of J a + gamma at fixed forces */
  mg_real *force;        /* [per row] of the force */
  mg_real *ratio;    /* [per friction row] of the force ratio of slip; of a patch: of the ratios, times the forces */
  mg_real *tangents; /* [6 per slot] of t1 and t2 of its patch */
} mg_direction_view;

/* What a blow does to a row: it strikes, is held at zero velocity, or slips. */
enum { MG_BLOW_STRUCK = 0, MG_BLOW_HELD = 1, MG_BLOW_SLIPS = 2 };

/* Derivatives below this part of the scales, times the size of their direction, are rounding. */
#define MG_ROUNDED_TANGENT mg_pow(MG_EPS, (mg_real)0.75)

#define MG_BLOW_ROWS 64 /* most rows of a blow that is differentiated */

/* A blow: its rows, in the order of contacts, each normal row before its friction rows, then joints. */
typedef struct {
  int n;
  int row[MG_BLOW_ROWS];
  int normal[MG_BLOW_ROWS];     /* of a contact: place of its normal row; of joints -1 */
  int constraint[MG_BLOW_ROWS]; /* friction constraint, or -1 */
  int role[MG_BLOW_ROWS];       /* what the blow does to it */
  int pivots[MG_BLOW_ROWS];
  mg_real impulse[MG_BLOW_ROWS];         /* N s or N m s */
  mg_real restitution[MG_BLOW_ROWS];     /* of a struck normal row; -1 of a row of armature */
  mg_real rate_before[MG_BLOW_ROWS];     /* J u- */
  mg_real rate_after[MG_BLOW_ROWS];      /* J u+ */
  mg_real rate_before_dot[MG_BLOW_ROWS]; /* derivatives of both */
  mg_real rate_after_dot[MG_BLOW_ROWS];
  mg_real scale[MG_BLOW_ROWS];  /* root of the diagonal of J M^-1 J^T */
  mg_real change[MG_BLOW_ROWS]; /* derivatives of the impulses, times scale */
  mg_real matrix[MG_BLOW_ROWS * MG_BLOW_ROWS];
} mg_blow;

/* What the events of a step are to the derivatives. */
typedef struct {
  int kind;       /* MG_CROSSES_NOTHING .. */
  int contact;    /* of the event function; a switching function of a load: its number */
  int constraint; /* friction constraint of it, or -1 */
  int blow;       /* 1: velocities jump */
  int reason;     /* why they are not certain, or 0 */
  int island;     /* the bodies that it moves, as in s->island; -1: all */
} mg_crossing;

#define MG_CROSSINGS 4           /* islands in which events may happen at one time */
#define MG_NUMBERS_OF_CROSSING 6 /* of an mg_crossing on the tape */
#if MG_TAPE_CROSSING != 1 + MG_NUMBERS_OF_CROSSING * MG_CROSSINGS
#error "MG_TAPE_CROSSING is not the room for the events of a step"
#endif

enum {
  MG_CROSSES_NOTHING = 0, /* no event, or one at which nothing jumps */
  MG_CROSSES_GAP = 1,     /* a gap closes */
  MG_CROSSES_SLIP = 2,    /* slip ends */
  MG_CROSSES_BOUND = 3,   /* a friction force reaches its bound */
  MG_CROSSES_FORCE = 4,   /* a force becomes tensile */
  MG_CROSSES_BORDER = 5,  /* a contact leaves its feature pair */
  MG_CROSSES_SWITCH = 6   /* a switching function of a load is zero */
};

/* The step that the run takes, and the lists as they were before it. */
typedef struct {
  unsigned char *before, *after; /* bytes of the run */
  int is_stored;                 /* 1: `before` holds the run as it is */
  int is_uncertain;              /* 1: slip begins in it, or its modes are not differentiated */
  int is_settled;                /* 1: the derivatives are those at its end, if no event ends it */
  int is_carried;                /* 1: the derivatives are those of the run */
  long begun;                    /* steps begun so far */
  const mg_events *events;
  const mg_record *record;
  int n_event, n_record, n_differentiated;
  mg_real t, roundoff; /* run->t and t_roundoff */
  mg_real refused_end; /* end of the last step that was refused for the error of its derivatives, s */
  long steps, passages, fallbacks;
} mg_followed_step;

#ifdef MG_DEBUG
/* Parts of the derivatives of which a debug core keeps where and along which direction they are valid. */
enum {
  MG_VALID_BODY_TANGENTS,    /* s->at.pose and s->at.twist */
  MG_VALID_ROW_TANGENTS,     /* s->at.rate, and s->at.tangents of a patch, of the contact differentiated last */
  MG_VALID_TANGENTS,         /* all of s->at */
  MG_VALID_SENSED,           /* s->pair and s->joint */
  MG_VALID_SENSOR_ARGUMENTS, /* s->x and s->x_dot of the sensors */
  MG_VALID_EVENT_RATES,      /* s->event_rate */
  MG_VALID_TANGENT_KINDS
};

enum { MG_ANY_DIRECTION = -1, MG_NO_ROW = -1 };
#endif

/* Memory of the derivatives of a run. */
typedef struct {
  const mg_directions *directions;
  mg_tangent *tangent;
  mg_adjoint *adjoint;   /* in the adjoint; else null */
  mg_direction_view at;  /* derivatives, or in the adjoint cotangents */
  mg_real *wrench;       /* [6 per body] of all forces, at the state evaluated last */
  mg_real *slopes;       /* [12 n n_states] derivatives of the stages */
  mg_real *end;          /* [n n_states] at the end of a step, before quaternions are normalised */
  mg_real *stage;        /* [n_states] */
  mg_real *x;            /* packed arguments */
  mg_real *x_dot;        /* their derivative */
  mg_real *y_dot;        /* derivative of the packed results */
  mg_real *weights;      /* [18] */
  mg_real *before;       /* [n_states] state before an event */
  mg_real *slope_before; /* [n_states] right-hand side before an event */
  mg_real *size;         /* [n] of the directions (mg_direction_size) */
  mg_real *event_rates;  /* [(n + 1) MG_CROSSINGS] event_rate of each of `crossings` */
  mg_real *event_rate;   /* [n + 1] derivative of the event function along each direction, and its rate */
  mg_real *pair;         /* [2 n_pair] of gap and force of each pair, as sensors show them */
  mg_real *joint;        /* [6 n_joint] of the wrenches of joints */
  mg_real *load;         /* [12 n_load] wrenches of the loads at the start of the step */
  mg_blow *blow;         /* the blow of the event */
  mg_real *start;        /* [n n_states] derivatives before the step */
  int *closed_before;    /* [n_contact] closed before the event */
  int *slip_begins;      /* [n_friction + n_patch_slot] 1: slip of the constraint or patch begins in the step */
  mg_real *slip;         /* [n_friction + n_patch_slot] at the start of the step: of a constraint in a plane, of its
                            tolerance; of a patch; 0: none */
  mg_real slip_end;      /* time at which slip that falls much in the step would end, s; 0: none falls much */
  int slip_falls;        /* its constraint */
  mg_real slip_left;     /* what slip that ended in the step treated last has left across its direction, of its size */
  int slip_left_constraint;            /* its constraint */
  mg_crossing crossings[MG_CROSSINGS]; /* of the event of the step treated last, one of each island */
  int n_crossing;
  mg_crossing crossing; /* the one of these that is looked at */
  int *island;          /* [n_body] island of each body at that event */
  int is_time;          /* 1: the direction looked at is time: no number changes */
  int is_at_event;      /* 1: derivatives are those at the event of a changed run, whose time changes (event_rate) */
  int *on_kink;         /* [n_contact + n_friction + n_patch_slot] not 0: on a kink, as kinks.c marks it */
  int sides;            /* MG_SIDE_LARGER ..: changes along the direction looked at last that keep the run's branch */
  int *held;            /* [n_contact] 1: holds the derivatives of its gap and of its gap velocity at zero */
  int *reasons;         /* [n_sensor] why what a sensor shows is not differentiable, or 0 */
  int *sensor_sides;    /* [n_sensor] for which changes along the direction looked at last its derivative holds */
  mg_real *moved;       /* packed arguments of the sensors, moved along a direction */
  mg_real *shown;       /* [10 n_sensor] what they show at five places, and their derivatives there */
  int is_lost;          /* 1: the step or start treated last is not differentiated */
  mg_real t_bar;        /* in the adjoint: cotangent of the time of paths and of motions of joints */
  int doubtful;         /* contact for which the step treated last is not certain, or -1 */
  int is_singular;      /* 1: equations of forces under slip were singular */
  mg_follower follower; /* of the steps of the run */
  mg_followed_step step;
#ifdef MG_DEBUG
  mg_digest valid[MG_VALID_TANGENT_KINDS]; /* digests, 0: not at all */
#endif
} mg_sensitivity;

/* In a debug core: notes, and requires, that a part of the derivatives is that with a part of the context
   (MG_VALID_POSES ..), along a direction, of a row; or of an event at the state x. */
#ifdef MG_DEBUG
MG_INTERNAL mg_digest mg_tangent_digest(const mg_context *c, const mg_sensitivity *s, int with, int direction, int row);
MG_INTERNAL mg_digest mg_event_digest(const mg_context *c, int kind, int contact, const mg_real *x);
#define MG_NOTE_TANGENT(c, s, what, with, direction, row) \
  ((s)->valid[what] = mg_tangent_digest(c, s, with, direction, row))
#define MG_NOTE_EVENT(c, s, kind, contact, x) ((s)->valid[MG_VALID_EVENT_RATES] = mg_event_digest(c, kind, contact, x))
#define MG_FORGET_TANGENT(s, what) ((s)->valid[what] = 0)
#define MG_FORGET_TANGENTS(s) memset((s)->valid, 0, sizeof((s)->valid))
#define MG_NEEDS_TANGENT(c, s, what, with, direction, row) \
  MG_REQUIRE((s)->valid[what] == mg_tangent_digest(c, s, with, direction, row))
#define MG_NEEDS_EVENT(c, s, kind, contact, x) \
  MG_REQUIRE((s)->valid[MG_VALID_EVENT_RATES] == mg_event_digest(c, kind, contact, x))
#else
#define MG_NOTE_TANGENT(c, s, what, with, direction, row) ((void)0)
#define MG_NOTE_EVENT(c, s, kind, contact, x) ((void)0)
#define MG_FORGET_TANGENT(s, what) ((void)0)
#define MG_FORGET_TANGENTS(s) ((void)0)
#define MG_NEEDS_TANGENT(c, s, what, with, direction, row) ((void)0)
#define MG_NEEDS_EVENT(c, s, kind, contact, x) ((void)0)
#endif

/* tangent_kernels.c: results in s->y_dot */

/* The branch of a switching function on which a load is differentiated: that of the run, or where the function stays
   zero the negative one. */
MG_INTERNAL mg_real mg_differentiated_branch(const mg_context *c, int which);

/* mg_switch_gradient on these branches. */
MG_INTERNAL const mg_real *mg_differentiated_switch(mg_context *c, const mg_sensitivity *s, mg_real t, int load,
                                                    int which, const mg_real **by_input);

/* Packs these branches of a load, and the quaternion of its body, into the weights. */
MG_INTERNAL void mg_pack_branches(const mg_context *c, mg_sensitivity *s, int load);

/* Derivative of a switching function of a load along a direction; terms: sum of the sizes of its terms, or null. Needs
   the tangents of the bodies. */
MG_INTERNAL mg_real mg_switch_tangent(mg_context *c, const mg_sensitivity *s, int direction, mg_real t, int which,
                                      mg_real *terms);

/* Number of the direction, or none while s->is_time. */
MG_INTERNAL void mg_contact_tangent(mg_context *c, mg_sensitivity *s, int direction, int contact, const mg_real *eta,
                                    const mg_real *eta_dot, const mg_real *force, const mg_real *acceleration);
MG_INTERNAL void mg_placement_tangent(mg_context *c, mg_sensitivity *s, int direction, int contact, const mg_real *eta);
MG_INTERNAL void mg_joint_tangent(const mg_context *c, mg_sensitivity *s, int direction, int joint, mg_real t,
                                  const mg_real *force, const mg_real *acceleration);
MG_INTERNAL void mg_motion_tangent(const mg_context *c, mg_sensitivity *s, int direction, int body, const mg_real *q,
                                   const mg_real *u, const mg_real *wrench, const mg_real *gravity, const mg_real *dq,
                                   const mg_real *du, const mg_real *dwrench);
MG_INTERNAL void mg_load_tangent(const mg_context *c, mg_sensitivity *s, int direction, int load, mg_real t);
MG_INTERNAL void mg_place_bodies_tangent(const mg_context *c, mg_sensitivity *s, int direction, mg_real t,
                                         const mg_real *x, const mg_real *dx);

/* Derivative of the right-hand side of the whole scene (scene_rhs) along a direction, in its mode. */
MG_INTERNAL void mg_scene_tangent(const mg_context *c, mg_sensitivity *s, int direction, const mg_real *x,
                                  const mg_real *dx, mg_real *slope);

/* Of what the sensors show. Needs s->pair and s->joint. */
MG_INTERNAL void mg_sensors_tangent(const mg_context *c, mg_sensitivity *s, int direction, mg_real t);

/* Copies n numbers, or zeros if there are none to copy; returns the place after them. */
MG_INTERNAL mg_real *mg_pack(mg_real *to, int n, const mg_real *from);

/* Derivative of a number along a direction; 0 while s->is_time or where the array is not given. */
MG_INTERNAL mg_real mg_number_dot(const mg_sensitivity *s, const mg_real *array, long n, int direction, int i);

/* Derivative of the time of the event along a direction. */
MG_INTERNAL mg_real mg_event_time_dot(const mg_sensitivity *s, int direction);

/* Largest change of a number along a direction: of states by their scales, of others relative to themselves. */
MG_INTERNAL mg_real mg_direction_size(const mg_context *c, const mg_sensitivity *s, int direction);

/* rhs_tangent.c */

/* Wrench of loads and of all rows on each body. Needs mg_right_hand_side at a state at the time t. */
MG_INTERNAL void mg_gather_wrenches(mg_context *c, mg_sensitivity *s, mg_real t);

/* True if the friction of a slipping constraint follows its slip: not while that begins or has almost ended. */
MG_INTERNAL int mg_is_turned_by_slip(const mg_context *c, int constraint, const mg_real *slip);

/* Derivative slope of the right-hand side along a direction, of which dx is that of the state. Needs
   mg_right_hand_side at (t, x), then mg_gather_wrenches. Leaves s->at. */
MG_INTERNAL void mg_rhs_tangent(mg_context *c, mg_sensitivity *s, int direction, mg_real t, const mg_real *x,
                                const mg_real *dx, mg_real *slope);

/* The same, with in s->at zeros for contacts that the right-hand side does not depend on. */
MG_INTERNAL void mg_slope_tangent(mg_context *c, mg_sensitivity *s, int direction, mg_real t, const mg_real *x,
                                  const mg_real *dx, mg_real *slope);

/* Of that only the derivatives of value, rate and residual of the rows of joints and of marked contacts, or of all for
   null, at forces and accelerations of the state; and the rates of eta. */
MG_INTERNAL void mg_rows_tangent(mg_context *c, mg_sensitivity *s, int direction, mg_real t, const mg_real *x,
                                 const mg_real *dx, const int *marked, mg_real *slope);

/* Finds forces on the held rows, of the size of 1, that accelerate nothing: in s->at.force; those that they were made
   from are in s->at.value. Returns 0 where there are none, so that the forces are unique. Needs the right-hand side. */
MG_INTERNAL int mg_find_redundant_forces(mg_context *c, mg_sensitivity *s);

/* patch_friction_tangent.c */

/* Slot of a support, or -1 for other contacts. */
MG_INTERNAL int mg_slot_of_support(const mg_context *c, int contact);

/* True if the derivatives of the friction of a slipping patch are known. Needs the velocities of the rows. */
MG_INTERNAL int mg_is_patch_slip_known(const mg_context *c, int slot);

/* Derivative of the friction matrix of a pressure. */
MG_INTERNAL void mg_friction_matrix_dot(const mg_winkler_pressure_field *p, const mg_real *twist,
                                        const mg_real *twist_dot, mg_real G_dot[3][3]);

/* Axes x and y of the hull in axes of f. */
MG_INTERNAL void mg_hull_axes_in_f(const mg_context *c, int slot, const mg_patch_frame *at, mg_real local[2][3]);

/* Derivatives of the force ratios of a slipping patch times the forces, into s->at.ratio. Needs s->at.tangents and the
   derivatives of its slip. */
MG_INTERNAL void mg_patch_slip_tangent(mg_context *c, mg_sensitivity *s, int direction, int slot);

/* Derivative of what is left of the bound of a patch while it sticks. */
MG_INTERNAL mg_real mg_patch_bound_tangent(mg_context *c, const mg_sensitivity *s, int direction, int slot);

/* Derivatives of that, where nothing is left, by the forces on the rows of the patch (3 supports, then 3 of
   friction), and by its coefficient. */
MG_INTERNAL void mg_patch_bound_gradient(mg_context *c, int slot, mg_real *by_force, mg_real *by_mu);

/* patch_friction_adjoint.c */

/* From the cotangents of the three s->at.ratio of a slipping patch. */
MG_INTERNAL void mg_patch_slip_adjoint(mg_context *c, mg_sensitivity *s, int slot, const mg_real *bar);

/* Of the slip of a patch along its stored direction, and of what is left of its bound, times a weight. */
MG_INTERNAL void mg_patch_slip_rate_adjoint(const mg_context *c, mg_sensitivity *s, int slot, mg_real weight);
MG_INTERNAL void mg_patch_bound_adjoint(mg_context *c, mg_sensitivity *s, int slot, mg_real weight);

/* step_tangent.c */

/* True if a direction moves borders of features. */
MG_INTERNAL int mg_has_moving_border(const mg_sensitivity *s);

/* True if faces rest on each other by points that a direction moves within them. */
MG_INTERNAL int mg_rests_on_moving_points(const mg_context *c, const mg_sensitivity *s);

/* Slip of a constraint in a plane, of its tolerance. Needs the velocities of the rows. */
MG_INTERNAL mg_real mg_slip_of(const mg_context *c, int contact, int constraint);

#define MG_SLOPES_KEPT 12 /* slopes of a step on a tape: stages of DOP853 */

/* A stage of a step that is tried, of an mg_follower of an mg_sensitivity: derivatives of its slope. At the end of the
   step keeps in s->before the state there. */
MG_INTERNAL void mg_follow_stage(mg_context *c, void *of, int is_composed, int stage, mg_real t, mg_real h);

/* Carries the derivatives over a step of length h to the state of the run, at which c is evaluated. Returns 0, and
   leaves them, where the stages have not been followed, slip begins or falls, or the step is not differentiated as
   it was taken: mg_step_tangent. */
MG_INTERNAL int mg_settle_followed_step(mg_context *c, mg_sensitivity *s, mg_real h);

/* Carries the derivatives over the step from the state of the run, of length h, whose stages have been followed or are
   taken again. Leaves in c->step.end the state at its
   end, and its right-hand side in s->slope_before. Returns a reason why the result is not certain, or 0. */
MG_INTERNAL int mg_step_tangent(mg_context *c, mg_sensitivity *s, mg_real h);

/* The same without directions, from the slopes of the stages. */
MG_INTERNAL void mg_restore_step(mg_context *c, mg_sensitivity *s, mg_real h, const mg_real *slopes);

MG_INTERNAL const mg_explicit_method *mg_explicit_method_of(const mg_settings *settings);

/* mg_combine_ranges of the first n states; `from` and `out` do not overlap. */
MG_INTERNAL void mg_combine_stages(const mg_explicit_method *m, int row, int n, long stride, mg_real h,
                                   const mg_real *from, const mg_real *slopes, mg_real *out);

/* Derivatives of normalised quaternions; x has the quaternions before. */
MG_INTERNAL void mg_normalise_tangent(const mg_context *c, const mg_real *x, mg_real *dx);

/* Derivatives of eta of all contacts from those of the poses. */
MG_INTERNAL void mg_settle_eta_tangents(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x);

/* Marks in s->held the contacts that hold their bodies: those that are closed, at the start, where of a change of the
   start what they permit is meant; later those that are active as well, as one that is let go is free to open. */
MG_INTERNAL void mg_mark_held_contacts(const mg_context *c, mg_sensitivity *s, int is_start);

/* Removes from the derivatives what the rows of joints and of the contacts in s->held forbid. Needs the right-hand side
   at (t, x). */
MG_INTERNAL void mg_project_tangents(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x);

/* Adds the corrections of positions and orientations, or of velocities, in c->bodies.wrench to a derivative. */
MG_INTERNAL void mg_add_correction(const mg_context *c, const mg_real *x, int of_velocities, mg_real *dx);

/* start_correction_tangent.c */

/* Carries the derivatives over the corrections of mg_begin. Returns a reason or 0. */
MG_INTERNAL int mg_start_tangent(mg_context *c, mg_sensitivity *s, const mg_real *given);

/* Restores for start_correction_adjoint.c the blow of a part of these corrections, MG_JOINTS_HOLD or
   MG_CONTACTS_STRIKE, between s->before and the state of the run, or the state after all, MG_START_SETTLED. Marks in
   s->closed_before the contacts that touch. Returns 0 where that part changes nothing, or cannot be differentiated. */
enum { MG_START_SETTLED = 0, MG_JOINTS_HOLD = 1, MG_CONTACTS_STRIKE = 2 };
MG_INTERNAL int mg_restore_start(mg_context *c, mg_sensitivity *s, const mg_real *given, int part);

/* start_correction_adjoint.c */
MG_INTERNAL void mg_start_adjoint(mg_context *c, mg_sensitivity *s, const mg_real *given, mg_real *x_bar);

/* event_islands.c */

/* The step that is looked at has no event. */
MG_INTERNAL void mg_forget_crossings(mg_sensitivity *s);

/* Finds the islands of bodies, s->island, at the end of a step. Needs the rows there. */
MG_INTERNAL void mg_find_event_islands(mg_context *c, mg_sensitivity *s);

/* What the events first .. of the list at the end of a step are to the derivatives, into s->crossings, by the
   islands of mg_find_event_islands. */
MG_INTERNAL void mg_find_crossings(mg_context *c, mg_sensitivity *s, const mg_events *events, int first);

/* Looks at the k-th of s->crossings, and at its event function. */
MG_INTERNAL void mg_choose_crossing(mg_sensitivity *s, int k);

/* True if the crossing that is looked at may change the motion of a body, or of the bodies of a row. */
MG_INTERNAL int mg_is_in_crossing(const mg_sensitivity *s, int body);
MG_INTERNAL int mg_is_row_in_crossing(const mg_context *c, const mg_sensitivity *s, int row);

/* event_tangent.c */

/* Derivatives of the event function along all directions and along time, in s->event_rate. Needs c->step.end of
   mg_step_tangent. */
MG_INTERNAL void mg_differentiate_event(mg_context *c, mg_sensitivity *s, mg_crossing *crossing, mg_real t);

/* True if the right-hand side of bodies of the crossing that is looked at jumps between s->slope_before and `after`. */
MG_INTERNAL int mg_has_slope_jump(const mg_context *c, const mg_sensitivity *s, const mg_real *after);

/* True if the event function crosses zero too slowly to tell the time of the event. */
MG_INTERNAL int mg_is_graze(const mg_context *c, const mg_crossing *crossing, mg_real rate);

/* Adds weight times the derivatives of the condition that a contact violates to s->at.pose and eta_bar. */
MG_INTERNAL void mg_border_adjoint(mg_context *c, mg_sensitivity *s, int contact, const mg_real *eta, mg_real weight,
                                   mg_real *eta_bar);

/* Carries the derivatives over the event. c is that of the run after it; s->before and s->slope_before are those before
   it. Returns a reason or 0. */
MG_INTERNAL int mg_cross_event(mg_context *c, mg_sensitivity *s, const mg_crossing *crossing);

/* Derivative of what is left of the bound of a sticking constraint. */
MG_INTERNAL mg_real mg_bound_tangent(const mg_context *c, const mg_sensitivity *s, int direction, int contact,
                                     int constraint);

/* Sums of the sizes of the parts of the derivative of a row's rate that velocities make, and of a gap that poses make.
 */
MG_INTERNAL mg_real mg_rate_tangent_size(const mg_context *c, const mg_sensitivity *s, int row);
MG_INTERNAL mg_real mg_gap_tangent_size(const mg_context *c, const mg_sensitivity *s, int contact);

/* kinks.c */

/* When a kink counts: at the start where something jumps, after a step that has stayed on it, at a sample always. */
enum { MG_AT_START = 0, MG_AFTER_STEP = 1, MG_AT_SAMPLE = 2 };

/* The sides for which both hold, MG_SIDE_LARGER ..; unknown if either is. */
MG_INTERNAL int mg_common_sides(int one, int other);

/* Marks in s->on_kink contacts, friction constraints and faces that are on a kink; returns 0 if there are none, and no
   load is on one or may jump. Needs the right-hand side at the state evaluated last, of the time t. */
MG_INTERNAL int mg_mark_kinks(mg_context *c, mg_sensitivity *s, mg_real t, int when);

/* Why changes along a direction leave marked kinks, or 0; s->sides: those that do not. Needs mg_gather_wrenches. */
MG_INTERNAL int mg_leave_kinks(mg_context *c, mg_sensitivity *s, int direction, mg_real t, const mg_real *x, int when);

/* 1 if a change by a positive multiple of a direction opens a gap, -1 if it closes it, 0 if it moves it by no more than
   rounding: by its gap at the time t - before, with the acceleration at t, else by its gap
   velocity. Needs mg_gather_wrenches. */
MG_INTERNAL int mg_opening_of(mg_context *c, mg_sensitivity *s, int direction, mg_real t, const mg_real *x, int contact,
                              mg_real before);

/* sensor_tangent.c */

/* Derivatives of what the sensors show along a direction, in s->y_dot. Needs the state evaluated, the sensors read and
   mg_gather_wrenches. Writes s->sensor_sides, and adds reasons to s->reasons where they are on a kink. */
MG_INTERNAL void mg_find_sensors_tangent(mg_context *c, mg_sensitivity *s, int direction);

/* Adds reasons for sensors that show forces which are not unique. */
MG_INTERNAL void mg_doubt_redundant_forces(mg_context *c, mg_sensitivity *s);

/* tangent_error.c */

/* Error of the derivatives at the end of a step of DOP853 that is tried, of an mg_follower of an mg_sensitivity,
   relative to what it may be. */
MG_INTERNAL mg_real mg_followed_error(mg_context *c, void *of, mg_real h);

/* state_dependent_load_jumps.c */

/* Notes the loads at the start of a step. */
MG_INTERNAL void mg_note_loads(const mg_context *c, mg_sensitivity *s, mg_real t);

/* True if a load has jumped in the step of length h to (t, x), at which c is evaluated, where the motion has taken it.
   `slope`: right-hand side there. */
MG_INTERNAL int mg_has_load_jump(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x, const mg_real *slope,
                                 mg_real h);

/* True if a load jumps where the direction that mg_rhs_tangent has treated takes it. */
MG_INTERNAL int mg_has_load_jump_along(mg_context *c, const mg_sensitivity *s, mg_real t);

/* impact_tangent.c */

/* True if a face rests on another, before or after an event. */
MG_INTERNAL int mg_has_closed_support(const mg_context *c, const mg_sensitivity *s);

/* Derivative of the velocities after a blow, into dx, of which q holds the derivative at the time of the blow and u
   that of the velocities before it. */
MG_INTERNAL void mg_blow_tangent(mg_context *c, mg_sensitivity *s, int direction, mg_real *dx);

/* Finds the impulses of the blow between s->before and the state of the run, of contacts and joints or of joints alone.
   Returns a reason or 0. */
MG_INTERNAL int mg_recover_impulses(mg_context *c, mg_sensitivity *s, int of_contacts);

/* Force ratio of row k of a slipping constraint at its velocity after the blow, and its derivatives: by the velocities
   of the rows of the constraint, and by their coefficients. */
MG_INTERNAL mg_real mg_blow_force_ratio(const mg_context *c, const mg_blow *b, int r, mg_real *by_rate, mg_real *by_mu);

/* Impulses of the rows of one contact or joint in the order of its kernel. */
MG_INTERNAL void mg_impulses_of(const mg_blow *b, int first_row, int below, int rows, mg_real *impulse);

/* J^T L of all bodies, in s->wrench. */
MG_INTERNAL void mg_gather_impulses(const mg_context *c, mg_sensitivity *s);

/* adjoint_kernels.c: cotangents of the results are in s->y_dot */

MG_INTERNAL void mg_contact_adjoint(mg_context *c, mg_sensitivity *s, int contact, const mg_real *eta,
                                    const mg_real *force, const mg_real *acceleration, mg_real *eta_bar);
MG_INTERNAL void mg_placement_adjoint(mg_context *c, mg_sensitivity *s, int contact, const mg_real *eta);
MG_INTERNAL void mg_joint_adjoint(const mg_context *c, mg_sensitivity *s, int joint, mg_real t, const mg_real *force,
                                  const mg_real *acceleration);
MG_INTERNAL void mg_load_adjoint(const mg_context *c, mg_sensitivity *s, int load, mg_real t);
MG_INTERNAL void mg_motion_adjoint(const mg_context *c, mg_sensitivity *s, int body, const mg_real *q, const mg_real *u,
                                   const mg_real *wrench, const mg_real *gravity, mg_real *q_bar, mg_real *u_bar,
                                   mg_real *wrench_bar);

/* From the cotangents of poses, twists and accelerations of driven bodies, s->at, to those of the state. */
MG_INTERNAL void mg_place_bodies_adjoint(const mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x,
                                         mg_real *x_bar);

/* From the cotangents of the right-hand side of the whole scene (scene_rhs). */
MG_INTERNAL void mg_scene_adjoint(const mg_context *c, mg_sensitivity *s, const mg_real *x, const mg_real *slope_bar,
                                  mg_real *x_bar);

/* From the cotangents of what the sensors show to s->at.pose, s->at.twist, s->pair and s->joint. */
MG_INTERNAL void mg_sensors_adjoint(const mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *sensors_bar);

/* rhs_adjoint.c */

/* Sets all cotangents in s->at to zero. */
MG_INTERNAL void mg_clear_cotangents(const mg_context *c, mg_sensitivity *s);

/* M^-1 J^T of a row, times a vector of all bodies that forces move. */
MG_INTERNAL mg_real mg_response_times(const mg_context *c, int row, const mg_real *per_body);

/* Adds to x_bar the cotangent of the state from slope_bar, that of the right-hand side, and from s->at. Needs
   mg_right_hand_side at (t, x), then mg_gather_wrenches. */
MG_INTERNAL void mg_rhs_adjoint(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x, const mg_real *slope_bar,
                                mg_real *x_bar);

/* Adds to x_bar that from the cotangents of value, rate and residual of the rows alone. */
MG_INTERNAL void mg_rows_adjoint(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x,
                                 const mg_real *slope_bar, mg_real *x_bar);

/* step_adjoint.c: from the cotangent x_bar of the state after to that before */

MG_INTERNAL void mg_settle_eta_adjoint(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x, mg_real *x_bar);

/* Needs the right-hand side at (t, x). */
MG_INTERNAL void mg_project_adjoint(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x, mg_real *x_bar);

/* Of gaps of marked contacts and of joints alone, without friction that sticks. */
MG_INTERNAL void mg_project_gaps_adjoint(mg_context *c, mg_sensitivity *s, const int *marked, mg_real *x_bar);

/* Needs mg_restore_step. */
MG_INTERNAL void mg_step_adjoint(mg_context *c, mg_sensitivity *s, mg_real h, mg_real *x_bar);

/* event_adjoint.c */

/* Adds weight times the derivatives of the event function at c->step.end. */
MG_INTERNAL void mg_event_function_adjoint(mg_context *c, mg_sensitivity *s, const mg_crossing *crossing, mg_real t,
                                           mg_real weight, mg_real *x_bar);

/* Over the projection after the events of a step. */
MG_INTERNAL void mg_after_event_adjoint(mg_context *c, mg_sensitivity *s, mg_real *x_bar);

/* Over an event, c being that of the run after it; `rate` is that of the event function. Returns the cotangent of the
   event function. */
MG_INTERNAL mg_real mg_event_adjoint(mg_context *c, mg_sensitivity *s, const mg_crossing *crossing, mg_real rate,
                                     mg_real *x_bar);

/* impact_adjoint.c */

/* Over a blow that mg_recover_impulses has found. */
MG_INTERNAL void mg_blow_adjoint(mg_context *c, mg_sensitivity *s, mg_real *x_bar);

/* advance_tangent.c */

/* Divides the memory of derivatives along n directions. */
MG_INTERNAL void mg_open_sensitivity(const mg_context *c, mg_sensitivity *s, int n, mg_real *work, int *iwork);

#endif
