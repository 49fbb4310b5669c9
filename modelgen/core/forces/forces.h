/* Forces and accelerations at one state: the active set of normal forces, friction and its modes, planar contacts with
   pressure, elimination of joints, projection of drift, diagnostics. May use: base, solve, region, model, closest. */
#ifndef MG_FORCES_H
#define MG_FORCES_H

#include "model/context.h"
#include "region/region.h"
#include "solve/friction/friction_solvers.h"
#include "solve/lcp/lcp_solvers.h"

enum { MG_MARGIN_SAMPLES = 7 }; /* samples of event margins in a step */

/* What determines the force of a friction constraint. */
enum {
  MG_BOUND_SLIP = 0,   /* its slip: kinetic friction opposite to it */
  MG_BOUND_STATIC = 1, /* an unknown bounded by the static cone */
  MG_BOUND_KINETIC = 2 /* an unknown bounded by the kinetic cone */
};

#define MG_SLIP_ROUNDING (mg_real)1e4 /* rounding of slip velocities, in units of eps and of their scale */

#define MG_FRICTION_ROWS_MAX 5 /* most friction rows of a contact */

enum { MG_PATCH_ROWS = 3 }; /* friction rows of a patch: slip of its first support point along t1, t2, spin about N */

/* Where the search for the pressure of a patch starts. */
enum {
  MG_CENTRE_UNKNOWN = 0, /* in the middle of its supports */
  MG_CENTRE_KNOWN = 1,   /* at the centre found last */
  MG_CENTRE_NOTED = 2    /* at the centre noted by the run (patch_support_share) */
};

/* Friction of the patch in a slot. */
struct mg_patch_friction {
  int slips;                             /* 1: it slips */
  int centre_known;                      /* MG_CENTRE_UNKNOWN .. */
  int partly_unloaded;                   /* 1: the pressure vanishes in a part of the overlap, or was not found */
  int place;                             /* of the centre of pressure: MG_INSIDE_HULL .. (region/region.h) */
  mg_real centre[2];                     /* centre of pressure, also outside the hull, in the axes of this, m */
  mg_real extent;                        /* extent of the loaded region about it, m */
  mg_real step[2], part;                 /* step of Newton's method that led to the centre, m; the part taken of it */
  mg_real mean_distance, mean_point[2];  /* mean distance of the pressure from its centre, m, and that centre; 0: not
                                            known */
  mg_real force_ratio[MG_PATCH_ROWS][3]; /* friction along a row over minus the force of each support point */
  int triggered;                         /* 1: its event has triggered */
  int mode_before;                       /* its mode at the start of the step */
  int slip_stopped;                      /* 1: its slip has ended in this step */
  mg_real slip_time_left;                /* time that slip which was stopped would have lasted, s */
  mg_real reversal_time_left;            /* the same along the stored direction, where slip goes on across it, s */
  mg_real slip_direction[2];             /* while slip begins: components of its direction across the stored one */
};

/* Rows of a patch in the axes of its hull. */
typedef struct {
  mg_real pose[12];      /* pose of the hull's axes */
  mg_real t[2][2];       /* t1 and t2 */
  mg_real support[3][2]; /* support points, m */
  mg_real sign;          /* 1: N is the z axis of the hull, -1: opposite */
} mg_patch_frame;

/* Friction of a slipping patch at one state, in the axes of its hull. */
typedef struct {
  mg_patch_frame at;
  mg_real offset[2];   /* centre of the pressure, from the first support, m */
  mg_real slip[3];     /* of the first support along t1, t2, and spin about N, from which the friction is computed */
  int turned;          /* -1, 1: it is the slip of the rows times this; 0: a stored direction */
  mg_real twist[3];    /* velocity at the centre of the pressure, and spin about the z axis of the hull */
  mg_real level[3][3]; /* per support: coefficients of the pressure of a unit force on it */
  mg_real force[3][3]; /* per support: friction of that pressure, times -1, and its torque about the centre */
} mg_patch_slip;

/* An event margin at a time of a step. */
typedef struct {
  mg_real theta;        /* time in the step, 0..1; < 0 or > 1: no sample */
  mg_event_margin left; /* bounds of the margin */
} mg_margin_sample;

/* row_accelerations.c */

/* Acceleration J a + Gamma2 of one row (of a contact: the gap's second derivative) under the accelerations last
   computed. */
MG_INTERNAL mg_real mg_row_acceleration(const mg_context *c, int contact);

/* What the accelerations and forces last computed lack of the condition of a row: its acceleration, or zero for a row
   of armature, which these accelerations obey with the force on it. */
MG_INTERNAL mg_real mg_row_imbalance(const mg_context *c, int row);

/* Acceleration in m/s^2 below which a gap counts as at rest: rest_acceleration * length / time^2. */
MG_INTERNAL mg_real mg_acceleration_tolerance(const mg_context *c);

/* Force in N that counts as zero: acceleration tolerance times the mass scale. */
MG_INTERNAL mg_real mg_force_tolerance(const mg_context *c);

/* Mark the closed support contacts of patches as active and write the accelerations of their rows; returns their
   number. */
MG_INTERNAL int mg_activate_supports(mg_context *c);

/* patch_hull.c */

/* Position of a support point in world axes. */
MG_INTERNAL void mg_support_world_point(const mg_context *c, int support, mg_real *world);

/* Sum of the forces or impulses on the supports of a slot, and their centre in world axes. */
MG_INTERNAL mg_real mg_support_resultant(const mg_context *c, int slot, const mg_real *amount, mg_real *centre);

/* Largest number of boundary arcs of a patch in the system. */
MG_INTERNAL int mg_max_patch_arcs(const mg_system *s);

/* True if o's face of the patch is a whole plane, without boundary. */
MG_INTERNAL int mg_is_whole_plane(const mg_context *c, int patch);

/* Pose of the hull of a patch in world axes: that of o's face, or of f's where o's is a whole plane, because the
   hull is then constant. */
MG_INTERNAL void mg_hull_pose(const mg_context *c, int patch, mg_real *out);

/* Pose of f's face in hull axes; the exact identity where the hull is in f's axes. */
MG_INTERNAL void mg_face_pose_in_hull(mg_context *c, int patch, mg_real *between);

/* List the arcs of two faces, as regions: range[0] is the first arc of o's, range[1] the one after its last, range[2]
   and range[3] the same of f's. */
MG_INTERNAL void mg_list_face_arcs(const mg_context *c, const int *range, mg_arc *arcs, mg_region_pair *regions);

/* These ranges of the faces of a patch. */
MG_INTERNAL void mg_patch_arc_ranges(const mg_context *c, int patch, int *range);

/* Overlay the two faces of a patch and compute the convex hull of what they share; returns the number of hull
   edges. */
MG_INTERNAL int mg_overlay_patch_regions(mg_context *c, int patch);

/* Distance in m by which a world point lies inside the hull of a patch, and the nearest boundary; -MG_MAX where
   the faces share nothing. Remembers the deepest point found in a hull that does not change. */
MG_INTERNAL mg_real mg_patch_hull_margin(mg_context *c, int patch, const mg_real *world, mg_nearest_boundary *nearest);

/* Lower bound in m of the distance by which a world point lies inside the hull, from the deepest point known;
   negative where it tells nothing. */
MG_INTERNAL mg_real mg_hull_margin_lower_bound(const mg_context *c, int patch, const mg_real *world);

/* patch_shares.c */

/* Most that a patch of several pairs has. */
typedef struct {
  int arcs;    /* of both faces */
  int shares;  /* of pairs */
  long hull;   /* memory of its hull, mg_real */
  long strips; /* of the boundary of the loaded part */
} mg_share_room;

MG_INTERNAL mg_share_room mg_find_share_room(const mg_system *s);

/* What mg_find_patch_shares found. */
enum {
  MG_SHARES_FIXED,  /* the weights do not change while the bodies and forces change a little, to first order */
  MG_SHARES_VARY,   /* they do */
  MG_SHARES_OVERLAP /* they do, and parts of several shares overlap, whose sum is then scaled to the resultant */
};

/* Force of each share of the patch in a slot, as c->patches.share.weight[3 share + support] times the forces on its
   supports, by the pressure of which these are the resultant. Returns MG_SHARES_FIXED .. */
MG_INTERNAL int mg_find_patch_shares(mg_context *c, int slot, const mg_real *force);

/* Force of one of these shares, N. */
MG_INTERNAL mg_real mg_share_force(const mg_context *c, int slot, int share, const mg_real *force);

/* sliding_loads.c */

#define MG_SLIDING_MAX 8 /* most zeros of switching functions on which loads slide at a time */

/* Search for the loads that keep switching functions at zero. */
typedef struct {
  int n;                                               /* switching functions that slide */
  int of[MG_SLIDING_MAX];                              /* these */
  int round;                                           /* rounds of Newton's method */
  int trial;                                           /* whose branch is shifted at present, or -1 */
  mg_real kept;                                        /* that branch before */
  mg_real residual[MG_SLIDING_MAX];                    /* rates that are to be zero, 1/s */
  mg_real derivative[MG_SLIDING_MAX * MG_SLIDING_MAX]; /* their derivatives by the branches, by columns */
} mg_slide;

/* True if loads slide on a zero of a switching function. */
MG_INTERNAL int mg_slides(const mg_context *c);

/* Begins the search for the branches at a state. */
MG_INTERNAL void mg_begin_slide(const mg_context *c, mg_slide *slide);

/* Notes the switching functions at the right-hand side evaluated with the present branches; returns 1 if it is to be
   evaluated again with others. */
MG_INTERNAL int mg_continue_slide(const mg_context *c, mg_slide *slide);

/* load_switch_events.c */

/* Event function of a switching function of a load, which falls through zero. */
MG_INTERNAL mg_real mg_switch_event_value(const mg_context *c, int which);

/* What is left of it before the event triggers; MG_MAX where there is none. */
MG_INTERNAL mg_real mg_switch_event_margin(const mg_context *c, int which);

/* True if a switching function is beyond zero and on its way back to the side of its branch, as where drift has been
   projected away after its event. */
MG_INTERNAL int mg_is_returning_switch(const mg_context *c, int which);

/* Notes by how much such functions are beyond zero at the start of a step. */
MG_INTERNAL void mg_note_returning_switches(const mg_context *c);

/* Marks all events of switching functions that have triggered; returns their number. */
MG_INTERNAL int mg_mark_switch_events(const mg_context *c);

/* True if an event of a switching function has triggered. */
MG_INTERNAL int mg_has_switch_event(const mg_context *c);

/* First switching function whose event is marked, or -1. */
MG_INTERNAL int mg_first_switch_event(const mg_context *c);

/* event_margin_storage.c */

/* Number of event margins of one sample: contacts, friction constraints and switching functions. */
MG_INTERNAL int mg_event_margin_count(const mg_system *s);

/* Margin after `which` (-1: the first) of contacts and friction constraints that take part; beyond the last their
   number. */
MG_INTERNAL int mg_next_event_margin(const mg_context *c, int which);

/* Event margins of one sample. */
MG_INTERNAL mg_event_margin *mg_event_margins_of_sample(const mg_context *c, int sample);

/* Event margins of a slot: force, centre of pressure inside the hull, friction. */
MG_INTERNAL mg_event_margin *mg_slot_event_margins(const mg_context *c, int slot);

/* islands.c */

/* Makes each body an island by itself. */
MG_INTERNAL void mg_part_bodies(mg_context *c);

/* Makes one island of those of two bodies, if forces move both; -1: no body. */
MG_INTERNAL void mg_join_bodies(mg_context *c, int o, int f);

/* A body of the island that a body is in, the same for all of it. */
MG_INTERNAL int mg_island_of_body(mg_context *c, int body);

/* Chains the n rows of c->lcp.rows by island: c->islands.head[root] is the first, c->islands.next[row] the one after,
   else -1. */
MG_INTERNAL void mg_chain_islands(mg_context *c, int n);

/* smooth_dynamics.c */

/* True if the prescribed path of a driven body is not finite at the present time. */
MG_INTERNAL int mg_has_nonfinite_driven_path(const mg_context *c);

/* Power in W that driven bodies and prescribed joint motions put into the moving bodies through contacts and
   joints; INFINITY where a prescribed path is not finite. */
MG_INTERNAL mg_real mg_prescribed_motion_power(const mg_context *c);

/* Evaluate x_dot = f(t, x) with the active set and the friction modes of the run; writes poses, rows, forces and
   accelerations of the context. */
MG_INTERNAL void mg_right_hand_side(mg_context *c, mg_real t, const mg_real *x, mg_real *x_dot);

/* True if the scene has a composed right-hand side, and the run is in its mode. That solves for the forces of a joint
   without pivots or refinement: where its rows were badly conditioned at the last right-hand side, the run is not. */
MG_INTERNAL int mg_is_in_mode_of_scene_rhs(const mg_context *c);

/* Number of the forces that the composed right-hand side gives. */
MG_INTERNAL int mg_scene_force_count(const mg_context *c);

/* Makes these forces those of the rows. */
MG_INTERNAL void mg_set_scene_forces(mg_context *c, const mg_real *force);

/* Evaluate x_dot = f(t, x) and the forces of the contacts at a stage of a step; by the composed right-hand side if
   `is_composed`, which leaves poses, rows and accelerations of the context as they were. */
MG_INTERNAL void mg_stage_right_hand_side(mg_context *c, int is_composed, mg_real t, const mg_real *x, mg_real *x_dot);

/* Lists the rows that hold in c->lcp.rows: active contacts, joints, sticking friction. Returns their number. */
MG_INTERNAL int mg_list_held_rows(mg_context *c);

/* Over the marked contacts, all joints and, if `sticks`, friction that sticks, A amount = -rate, of minimum norm where
   they are redundant; 0 elsewhere. Leaves the rows in c->lcp.rows and returns their number. */
MG_INTERNAL int mg_hold_rows(mg_context *c, const int *marked, int sticks, const mg_real *rate, mg_real *amount);

/* Evaluate the right-hand side and the gap velocities at the state of the run; writes the slope to the first row
   of the stage slopes, and the contact forces of the run. */
MG_INTERNAL void mg_evaluate_run_state(mg_context *c);

/* slip_rows.c */

/* Number of tangential rows of a contact; 0 for support contacts of patches and for other rows. */
MG_INTERNAL int mg_tangential_row_count(const mg_context *c, int row);

/* Lists the friction rows whose forces slip makes a multiple of the amount of a normal row or of a support, and minus
   these multiples. Returns their number. */
MG_INTERNAL int mg_list_slip_rows(const mg_context *c, int row, int *list, mg_real *ratio);

/* True if a listed row carries the friction of slip, so that the matrix is not symmetric. */
MG_INTERNAL int mg_has_slip_coupling(const mg_context *c, const int *list, int n);

/* Subtract the friction of slipping contacts and patches from the columns of their normal rows, so that one normal
   force carries both; the matrix is then not symmetric. */
MG_INTERNAL void mg_couple_slip_to_normal_columns(mg_context *c, const int *list, int n);

/* row_refinement.c */

/* True if rows whose scaled matrix has this least pivot need no refinement. */
MG_INTERNAL int mg_are_rows_well_conditioned(mg_real least_pivot);

/* Corrects the amounts of the n rows of c->islands.rows, which J M^-1 J^T amount = -rate gave, to rounding if the least
   pivot of the scaled matrix is small; notes how uncertain rounding leaves them. `slips`: slip was coupled to the
   normal rows. `rank`: of the rows as they were solved; amounts of rows that depend on each other are left as they
   are. Needs M^-1 J^T of the rows. */
MG_INTERNAL void mg_refine_rows(mg_context *c, int n, int slips, int rank, const mg_real *rate, mg_real pivot,
                                mg_real *amount);

/* joint_elimination.c */

/* Entry of c->lcp.mask of a row that is held: of joints, whose dependence joint_rank_tolerance decides, 1; of others,
   which depend where rounding leaves nothing else of them, MG_ACTIVE_ABOVE_ROUNDING. */
MG_INTERNAL int mg_held_row_mask(const mg_context *c, int row);

/* Append the supports of all flat patches, the rows of all joints, and those of springs while they act through them, to
   a list of n rows; returns its length. */
MG_INTERNAL int mg_append_bilateral_rows(const mg_context *c, int *list, int n);

/* Solve 0 <= z, 0 <= A z + value, complementary, over the n listed contacts with supports and joints held. Starts
   from the given active set, leaves that of the solution, appends supports and joints to the list; returns the
   solver's outcome. */
MG_INTERNAL int mg_solve_contact_lcp(mg_context *c, int n, const mg_real *value, mg_lcp_report *report);

/* chosen_solver.c */

/* True if a problem is solved by the solver of the settings; its relaxation never is. */
MG_INTERNAL int mg_has_outer_solver(const mg_context *c, const mg_friction_problem *p);

/* mg_friction, or the solver of the settings in its place. */
MG_INTERNAL int mg_solve_friction_problem(mg_context *c, const mg_friction_problem *p, mg_real *z, int *marks,
                                          mg_friction_report *report);

/* mg_solve_contact_lcp, or the solver of the settings in its place where that finds a solution. */
MG_INTERNAL int mg_solve_force_lcp(mg_context *c, int n, const mg_real *value, mg_lcp_report *report);

/* joint_rank.c */

/* Cholesky's factor of J M^-1 J^T over the joints, row by row in their order. A row of which the rows before it leave
   less than `singular` is passed over. Writes into c->joints.independence how much of its own each row has, 0..1, and
   the independent rows of each joint into `rank` unless it is 0. Returns the rank. */
MG_INTERNAL int mg_rank_joints(mg_context *c, int *rank);

/* Number of joint rows that depend on those before them. Rows of armature, which yield, do not. */
MG_INTERNAL int mg_count_dependent_joint_rows(mg_context *c);

/* Updates rank, margin and dead centres of the joints. Needs the rows at run->x. */
MG_INTERNAL void mg_monitor_joint_rank(mg_context *c);

/* bilateral_elimination.c */

/* Solve the friction problem; where patches slip, eliminate the bilateral rows first, because the friction solver
   eliminates symmetric rows only. Needs the listed rows, those of contacts first. */
MG_INTERNAL int mg_solve_friction_with_bilaterals(mg_context *c, const mg_friction_problem *p, mg_real *z,
                                                  mg_friction_report *report);

/* How many contacts of a problem stick whose slip bilateral rows hold in one direction in which friction need not carry
   anything, in the solution z. Needs the marks of the solution. */
MG_INTERNAL int mg_count_held_slip(mg_context *c, const mg_friction_problem *p, const mg_real *z);

/* unsymmetric_rows.c */

/* Solves A z = -b over listed rows, of least norm in the scale of the rows, by a rank-revealing QR factorisation in
   that scale; A has columns `stride` apart. Its memory is the first n (n + 4) of c->lcp.work. Returns the least pivot,
   0 where the rows depend on each other. */
MG_INTERNAL mg_real mg_solve_least_norm_rows(mg_context *c, const int *list, int n, const mg_real *A, int stride,
                                             const mg_real *b, mg_real *z);

/* Rank of the assembled unsymmetric matrix over listed rows. */
MG_INTERNAL int mg_unsymmetric_rank(mg_context *c, const int *list, int n);

/* Keeps the assembled matrix of n rows, which is symmetric until slip is coupled to normal forces. */
MG_INTERNAL void mg_keep_symmetric_rows(mg_context *c, int n);

/* Solve A z = -b over listed rows, of least norm in the scale of the rows where A is singular. Needs the symmetric
   matrix that mg_keep_symmetric_rows has kept in c->lcp.work. Returns the least pivot of A in that scale, 0 where A is
   singular. */
MG_INTERNAL mg_real mg_solve_unsymmetric_rows(mg_context *c, const int *list, int n, mg_real *z);

/* motion_uniqueness_monitor.c */

/* Note the first time at which friction forces are not unique and another motion is found, or could not be sought, from
   many starts where modes are new and from one of these at the end of a step. Needs rows and forces at the run's state
   where friction is redundant. */
MG_INTERNAL void mg_monitor_redundant_friction(mg_context *c, int is_new);

/* Note the first time at which a load is at a jump from which it leads away (c->switches.repels), and the first load
   that shares what it holds (c->switches.shares). */
MG_INTERNAL void mg_monitor_loads_at_jumps(const mg_context *c);

/* contact_point_friction.c */

/* Contact that a friction constraint belongs to. */
MG_INTERNAL int mg_contact_of_friction(const mg_context *c, int constraint);

/* Number of rows of a friction constraint: 1 for spin, 2 for slip and rolling. */
MG_INTERNAL int mg_friction_row_count(const mg_context *c, int constraint);

/* Append the rows of the friction of a contact that sticks to a list of n rows, none of one without force; returns its
   length. */
MG_INTERNAL int mg_append_sticking_rows_of_contact(const mg_context *c, int contact, int *list, int n);

/* Append the rows of sticking friction, of contacts and of patches, to a list of n rows; returns its length. */
MG_INTERNAL int mg_append_sticking_rows(const mg_context *c, int *list, int n);

/* Characteristic slip velocity of a friction constraint: m/s; rad/s for spin and rolling. */
MG_INTERNAL mg_real mg_slip_velocity_scale(const mg_context *c, int constraint);

/* Slip velocity below which a friction constraint counts as sticking. */
MG_INTERNAL mg_real mg_slip_velocity_tolerance(const mg_context *c, int constraint);

/* Slip components s of a friction constraint, and as value s . e along its stored slip direction e. */
MG_INTERNAL mg_real mg_slip_along_direction(const mg_context *c, int contact, int constraint, mg_real *slip);

/* Set the ratio of friction force to normal force, mu^2 s / |mu s|, along the slip s; s is reversed where it
   points against its stored direction, so that the force stays smooth through zero slip, and is that direction
   where rounding would turn it. */
MG_INTERNAL void mg_set_slip_force_ratio(mg_context *c, int contact, int constraint);

/* Set the force ratios of all friction rows, 0 where nothing slips, and M^-1 J^T of the rows that slip. */
MG_INTERNAL void mg_set_slip_force_ratios(mg_context *c);

/* Solve the forces of one island of n assembled rows; where they are not unique, those nearest to the reference
   forces. */
MG_INTERNAL void mg_solve_island_with_friction(mg_context *c, int n, const mg_real *rate, mg_real *amount);

/* Compute the friction forces of slipping contacts and patches from their normal forces and add them to the
   accelerations. */
MG_INTERNAL void mg_apply_slip_forces(mg_context *c);

/* Power in W that friction puts into the moving bodies; residual slip of sticking friction does no work. */
MG_INTERNAL mg_real mg_friction_power(const mg_context *c);

/* Direction at an angle from the stored slip direction, in the components of its rows. */
MG_INTERNAL void mg_slip_direction_at_angle(const mg_context *c, int contact, int constraint, mg_real angle,
                                            mg_real *along);

/* patch_end_conditions.c */

/* Cause for which a patch ends with the given amounts on its supports, or 0, and the distance of the centre of
   pressure inside the hull. */
MG_INTERNAL int mg_find_patch_end_cause(mg_context *c, int slot, const mg_real *amount, mg_real floor, mg_real *margin);

/* Event of the patch in a slot at the last right-hand side, or 0; stores the margins before its events. */
MG_INTERNAL int mg_find_slot_event(mg_context *c, int slot);

/* Mark the slots whose patch events have triggered at the last right-hand side; returns their number. */
MG_INTERNAL int mg_mark_patch_events(mg_context *c);

/* True if an event of a patch has triggered at the last right-hand side. */
MG_INTERNAL int mg_has_patch_event(mg_context *c);

/* Event function of a patch, for the given cause. */
MG_INTERNAL mg_real mg_patch_event_value(mg_context *c, int support, int cause);

/* patch_friction.c */

/* True if the patch has a kinetic friction coefficient above zero. */
MG_INTERNAL int mg_has_patch_friction(const mg_context *c, int patch);

/* True if the slot holds an active patch with friction. */
MG_INTERNAL int mg_is_slot_frictional(const mg_context *c, int slot);

/* First friction row of the patch in a slot: slip along t1, along t2, then spin. */
MG_INTERNAL int mg_first_patch_friction_row(const mg_context *c, int slot);

/* Distance in m of the three support points from their centre; scales spin to a velocity. */
MG_INTERNAL mg_real mg_support_radius(const mg_context *c, int slot);

/* Fill the frame of a patch: hull pose, tangents and support points in hull axes, and the sign of N. */
MG_INTERNAL void mg_set_patch_frame(const mg_context *c, int slot, mg_patch_frame *at);

/* Place of the middle of the supports of a slot, from the first, in the axes of f. Slip has its direction there: that
   of a point farther out turns with the body. */
MG_INTERNAL void mg_middle_of_supports(const mg_context *c, int slot, mg_real *local);

/* From velocities of the three friction rows of a patch, or their derivatives, to the slip in the middle of the
   supports along t1 and t2, and the spin times the support radius. */
MG_INTERNAL void mg_patch_slip_in_middle(const mg_context *c, int slot, const mg_real *rate, mg_real *out);

/* Stored slip direction of a patch, in components along t1, t2 and spin times support radius. */
MG_INTERNAL void mg_patch_slip_direction(const mg_context *c, int slot, mg_real *e);

/* Slip and spin of a patch along its stored slip direction; rate: [per row] velocities, or their derivatives. */
MG_INTERNAL mg_real mg_patch_slip_along_direction(const mg_context *c, int slot, const mg_real *rate);

/* True if slip of a patch in the middle of its supports is too small to tell its direction, so that friction is
   computed for the stored one. Slip that stops may keep a 1024th of slip_speed across (mg_patch_slip_step_limit), which
   near zero would be all of it. */
MG_INTERNAL int mg_is_patch_slip_small(const mg_context *c, int slot, const mg_real *in_middle);

/* Store the direction of slip in the middle of the supports along t1, t2, and spin times the support radius. */
MG_INTERNAL void mg_set_patch_slip_direction(mg_context *c, int slot, const mg_real *slip);

/* Two unit vectors that complete the unit vector e to an orthonormal basis. */
MG_INTERNAL void mg_complete_orthonormal_basis(const mg_real *e, mg_real across[2][3]);

/* That direction and two directions across it. */
MG_INTERNAL void mg_patch_slip_basis(const mg_context *c, int slot, mg_real e[3][3]);

/* Notes where the searches for the pressures of patches start at the state that is accepted next: at the centres of the
   forces of the run now. */
MG_INTERNAL void mg_note_pressure_starts(mg_context *c);

/* Starts the searches for the pressures of patches where it was noted, so that the forces found next depend on the run
   alone. */
MG_INTERNAL void mg_start_patch_pressures(mg_context *c);

/* Compute the pressure in a slot for a unit resultant at its centre of pressure; over the whole face while that
   centre is not known. */
MG_INTERNAL void mg_update_patch_pressure(mg_context *c, int slot);

/* Friction of a patch that slips as slip->slip says. Leaves its pressure in c->patches.pressure. */
MG_INTERNAL void mg_find_patch_friction(mg_context *c, int slot, mg_patch_slip *slip);

/* Friction of a slipping patch. Leaves its pressure in c->patches.pressure. Needs the velocities of the rows. */
MG_INTERNAL void mg_find_patch_slip(mg_context *c, int slot, mg_patch_slip *slip);

/* Set the friction force ratios of all slots whose patches slip. Needs the velocities of the rows. */
MG_INTERNAL void mg_set_patch_force_ratios(mg_context *c);

/* After the forces: recompute the force ratios of patches whose pressure has changed; returns 1 while forces must
   be solved again. */
MG_INTERNAL int mg_has_changed_patch_pressures(mg_context *c);

/* False if the forces that were found last hold for other pressures between slipping faces than they cause, because
   Newton's method for these was given up. */
MG_INTERNAL int mg_are_patch_pressures_found(const mg_context *c);

/* mg_list_slip_rows for a support of a patch; 0 for other rows. */
MG_INTERNAL int mg_list_patch_slip_rows(const mg_context *c, int row, int *list, mg_real *ratio);

/* Compute the friction of slipping patches from the forces on their supports and add it to the accelerations. */
MG_INTERNAL void mg_apply_patch_slip_forces(mg_context *c);

/* Append the friction rows of sticking patches to a list of n rows; returns its length. */
MG_INTERNAL int mg_append_sticking_patch_rows(const mg_context *c, int *list, int n);

/* friction_cones.c */

/* Decide for every friction constraint whether its force follows from its slip or is bounded by the static cone. */
MG_INTERNAL void mg_set_friction_bound_kinds(mg_context *c);

/* Index of a friction kind (slide, spin, roll) in the cone of its contact. */
MG_INTERNAL int mg_cone_index_of_kind(int friction_kind);

/* Write the coefficients of one friction constraint, times `part`, into the cone of its contact. */
MG_INTERNAL void mg_set_cone_coefficients(const mg_context *c, int constraint, const mg_real *mu, mg_real part,
                                          mg_real *cone);

/* Fill the friction cone of one contact with its coefficients times `part`; a sticking group that has just
   reached its bound gets slightly less. */
MG_INTERNAL void mg_set_friction_cone(const mg_context *c, int contact, mg_real part, mg_real *cone);

/* Append the rows of a contact to the row list, as contact k of the friction problem; returns the new length. */
MG_INTERNAL int mg_append_friction_contact(mg_context *c, int contact, int k, int size);

/* frictionless_active_set.c */

/* Choose the active set among the closed contacts that `skip` does not mark, from the complementarity problem of
   accelerations; returns MG_DONE or the outcome that ends the run. */
MG_INTERNAL int mg_solve_active_set(mg_context *c, const int *skip);

/* friction_events.c */

/* Append the events of slip that starts, stops or reverses at single contacts. */
MG_INTERNAL void mg_report_friction_events(mg_context *c, mg_events *events);

/* Event function of a friction constraint, which falls through zero: force margin while it sticks, slip along its
   direction while it slips. */
MG_INTERNAL mg_real mg_friction_event_value(const mg_context *c, int contact, int constraint);

/* Margin before the event of a friction constraint; MG_MAX where it has none. Slip that has reached slip_speed ends
   below it; slip that has not yet ends where it reverses twice as fast, since a reversal may leave slip_speed of it. */
MG_INTERNAL mg_real mg_friction_event_margin(const mg_context *c, int contact, int constraint);

/* Mark the friction constraints whose event has triggered; returns their number. Needs the right-hand side and the gap
   velocities. */
MG_INTERNAL int mg_mark_friction_events(mg_context *c);

/* True if the event of any friction constraint has triggered; sets no marks. */
MG_INTERNAL int mg_has_any_friction_event(const mg_context *c);

/* First friction constraint whose event has triggered, or -1. */
MG_INTERNAL int mg_first_friction_event(const mg_context *c);

/* friction_modes.c */

/* Gives the friction constraints of n contacts that slip their kinetic coefficients; returns how many bounds that
   changes. */
MG_INTERNAL int mg_use_kinetic_bounds(mg_context *c, int n, const int *contacts);

/* Solve Coulomb's law for accelerations: which closed contacts carry force, and which friction sticks or slips.
   Needs J and the twists at the run's state. */
MG_INTERNAL int mg_solve_friction_modes(mg_context *c, const int *skip);

/* At the start of a step, set slip directions and friction modes and remember the modes. Needs the rows at the
   run's state. */
MG_INTERNAL void mg_begin_step_friction(mg_context *c);

/* patch_friction_modes.c */

/* Friction margin N (1 - used part of the limit surface) of a sticking patch, and the twist of the first support
   and about N with which slip would start. */
MG_INTERNAL mg_real mg_patch_friction_margin(mg_context *c, int slot, mg_real *twist);

/* Event function of a patch with friction: friction margin while it sticks, slip along its direction while it
   slips. */
MG_INTERNAL mg_real mg_patch_friction_event_value(mg_context *c, int slot, int cause);

/* Friction event of a slot that has triggered: bound exceeded, slip ended, or 0; stores the margin before it.
   Slip that has reached slip_speed ends below it; slip that has not yet ends where it reverses twice as fast. */
MG_INTERNAL int mg_find_patch_friction_event(mg_context *c, int slot);

/* At the start of a step, set slip directions and modes of all patches and remember the modes. */
MG_INTERNAL void mg_begin_step_patch_friction(mg_context *c);

/* Longest step, s, towards the end of slip whose direction turns. The ratio of velocity and spin tends to 0/0 there,
   and changes by the logarithm of the time that is left, half of which a step may take. A direction that does not turn
   does not limit the step, unless its derivatives are followed: the present acceleration leaves hardly any slip across
   it. */
MG_INTERNAL mg_real mg_patch_slip_step_limit(const mg_context *c);

/* Reset the friction modes of all patches. */
MG_INTERNAL void mg_reset_patch_friction(mg_context *c);

/* Solve the modes of contacts and friction, and release patches that exceed their friction bound, until none
   does. */
MG_INTERNAL int mg_solve_patch_friction_modes(mg_context *c, const int *skip);

/* Append the events of patch slip that starts, stops or reverses. */
MG_INTERNAL void mg_report_patch_friction_events(mg_context *c, mg_events *events);

/* drift_projection.c */

/* Largest magnitude of a row value over closed contacts, joints and sticking friction. */
MG_INTERNAL mg_real mg_largest_held_violation(const mg_context *c, const mg_real *value);

/* Compute the correction M^-1 J^T z of all bodies with A z = -value over the marked contacts and all joints.
   Returns the number of those rows, which it lists; their z are left as impulses. */
MG_INTERNAL int mg_solve_row_correction(mg_context *c, const int *marked, const mg_real *value);

/* The same by the impulses of the n listed rows (mg_hold_rows). Returns n. */
MG_INTERNAL int mg_set_body_corrections(mg_context *c, int n);

/* Rotate a quaternion by a small rotation vector in body axes, to first order. */
MG_INTERNAL void mg_rotate_quaternion(mg_real *e, const mg_real *angle);

/* Add the corrections to positions and orientations of the run's state and normalise. Returns 0, and changes nothing,
   where they move the mass of a body farther, in the root mean square, than correction_ratio times the violation that
   they remove, m, and contact_gap. */
MG_INTERNAL int mg_apply_pose_correction(mg_context *c, mg_real violation);

/* Add the corrections to the velocities of the run's state. */
MG_INTERNAL void mg_apply_velocity_correction(mg_context *c);

/* Project positions and velocities back onto the constraints where they have drifted beyond tolerance. Needs the
   rows at the run's state and updates them; returns 0 if an extremum was lost. */
MG_INTERNAL int mg_project_drift(mg_context *c);

/* Project the given start onto zero gaps and joint rows until the drift bound holds, in at most five corrections;
   returns 0 if an extremum was lost. */
MG_INTERNAL int mg_project_initial_pose(mg_context *c);

/* Record the joint errors of the given start and project it onto the joints; returns 0 where the error is beyond
   start_joint. Needs the rows at the run's state. */
MG_INTERNAL int mg_project_initial_joints(mg_context *c);

/* event_margin_samples.c */

/* True if anything that takes part has event functions: a contact, a switched load, or a patch. */
static inline int mg_has_event_functions(const mg_context *c) {
  return c->listed.n_contact > 0 || c->system->n_switch > 0 || c->system->n_patch_slot > 0;
}

/* Store the present event margins as a sample of the step; those of slots are stored already. Needs the
   right-hand side and the gap velocities. */
MG_INTERNAL void mg_sample_event_margins(mg_context *c, int sample);

/* Sample the event margins at the start of a step. Needs the forces there. */
MG_INTERNAL void mg_sample_margins_at_start(mg_context *c);

/* Sample the event margins at a stage, unless an event has been seen. */
MG_INTERNAL void mg_sample_margins_at_stage(mg_context *c, int stage);

/* Lower bound of an event margin between the inner two of four samples, by the lines through neighbouring samples
   of a convex function, and its place; 0 or more where nothing is below zero. A margin known only between bounds
   is taken at its lower bound and its neighbours at their upper bounds, unless all are uncertain. */
MG_INTERNAL mg_real mg_interior_margin_bound(const mg_margin_sample *p, mg_real *theta);

/* Collect four samples about one part of the step. */
MG_INTERNAL void mg_collect_margin_samples(const mg_context *c, int which, int end, int n, mg_real part,
                                           mg_margin_sample *p);

/* True if an event margin varies so little over the samples that it cannot be below zero between them. */
MG_INTERNAL int mg_is_margin_nearly_constant(const mg_context *c, int which);

/* evaluation_work.c */

/* Work of the equations of all contacts, and of loads that switch as those of one. */
MG_INTERNAL mg_real mg_work_of_equations(const mg_context *c);

/* Counts evaluations of the right-hand side and the work of their equations. */
MG_INTERNAL void mg_count_evaluations(mg_context *c, int count);

/* Counts the work of finding the pressure of a planar contact. */
MG_INTERNAL void mg_count_pressure(mg_context *c);

/* Counts the work of a solution for n forces. */
MG_INTERNAL void mg_count_factorisation(mg_context *c, int n);

/* Counts the work of a solution for n forces by Coulomb's law. */
MG_INTERNAL void mg_count_friction_solve(mg_context *c, int n, const mg_friction_report *report);

/* How many factorisations for n forces a choice of modes may take before it costs too much; at least 1, and 0 where
   there is no bound. */
MG_INTERNAL int mg_affordable_factorisations(const mg_context *c, int n);

/* True while modes are chosen in a step that takes more work than events may; the choice is then given up. */
MG_INTERNAL int mg_is_mode_choice_too_costly(const mg_context *c);

/* diagnostics.c */

/* Kinetic and potential energy of the bodies that forces move at run->x, J; *kinetic receives the kinetic part. */
MG_INTERNAL mg_real mg_energy(mg_context *c, mg_real *kinetic);

/* Updates the statistics of the run. Needs the rows and forces at run->x. */
MG_INTERNAL void mg_update_diagnostics(mg_context *c);

/* Ends the run with the outcome noted with a penetration, if one noted in this step is deeper than penetration_limit
   and than the pair moves within the time `unresolved` (s); else returns MG_DONE. */
MG_INTERNAL int mg_check_penetration(mg_context *c, mg_real unresolved);

/* Ends the run with MG_NOT_FINITE if the gap of a contact or its rows are not finite; else returns MG_DONE. */
MG_INTERNAL int mg_check_contact_rows(mg_context *c);

/* Ends the run with MG_MARGIN if a closed contact is singular; else returns MG_DONE. */
MG_INTERNAL int mg_check_margins(mg_context *c, mg_events *events);

#endif
