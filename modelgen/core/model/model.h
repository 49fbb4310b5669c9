/* The scene at one state: bodies, feature pairs, rows of contacts and joints, planar contacts, and the transitions of a
   contact at an event. Sides of a feature pair and of a patch are 0: o, 1: f. May use: base, region. */
#ifndef MG_MODEL_H
#define MG_MODEL_H

#include "model/context.h"

static const int mg_parametrisation_size[] = {0, 3, 2, 1, 3, 1, 1}; /* entries of eta, by MG_NONE .. MG_TURN */

/* Cause of a transition of a contact (contact_transitions.c gives the state after it and the event). */
enum {
  MG_IMPACT_INELASTIC,     /* an impact without rebound */
  MG_IMPACT_AVOIDED,       /* an approach that impacts at other contacts end */
  MG_TOUCHES_DOWN,         /* an impact after which the contact stays closed, reported */
  MG_IMPACT_REBOUND,       /* an impact with rebound */
  MG_PUSHED_OPEN,          /* an impact at another contact opens it */
  MG_LIFTS_OFF,            /* the force vanishes and the gap opens */
  MG_CONTACT_APPEARS,      /* a search has found new closest points */
  MG_FEATURE_CHANGES,      /* the contact changes to another feature pair */
  MG_CONTACT_VANISHES,     /* the closest points have ceased to exist */
  MG_NEARS_SINGULARITY,    /* the contact is too near to a singularity to be followed */
  MG_PATCH_BEGINS,         /* first support point: the patch rests */
  MG_PATCH_TURNS_OVER_EDGE /* first support point: the patch turns over an edge */
};

/* Marks in c->patches.trial beyond 1 (held on trial). */
enum {
  MG_TRIAL_ON_EDGE = 2, /* an impact has moved the support points to points of the edge of the hull */
  MG_TRIAL_TORN_OFF = 3 /* the same, of a patch that had rested */
};

/* preconditions.c */

/* In a debug core: notes that a part of the context (MG_VALID_POSES ..) has been evaluated at (t, x), or with another
   part; requires that it has been at (t, x), at the state of the run, with another part, or at all. The same of parts
   that are valid for something else, by its digest. */
#ifdef MG_DEBUG
MG_INTERNAL mg_digest mg_state_digest(const mg_context *c, int what, mg_real t, const mg_real *x);

/* Digest of a feature pair at the present poses, and at eta unless that is null. */
MG_INTERNAL mg_digest mg_placement_digest(const mg_context *c, int kind, int o, int f, const mg_real *eta);

/* Digest of a step of length h from (t, x). */
MG_INTERNAL mg_digest mg_step_digest(const mg_context *c, mg_real t, const mg_real *x, mg_real h);

/* Digest of a friction problem over the rows c->lcp.rows, and of its solution z. */
MG_INTERNAL mg_digest mg_solution_digest(const mg_context *c, const mg_friction_problem *p, const mg_real *z);

/* Digest of the impulses of the first n of c->lcp.rows, at the state of the run before the impact. */
MG_INTERNAL mg_digest mg_impulse_digest(const mg_context *c, int n);

/* Digest of n rows of c->islands.rows and of their matrix at the beginning of c->lcp.work. */
MG_INTERNAL mg_digest mg_kept_rows_digest(const mg_context *c, int n);

/* True if M^-1 J^T of n listed rows is that of their J. */
MG_INTERNAL int mg_are_inverse_mass_rows_valid(const mg_context *c, const int *list, int n);

/* True if c->lcp.A is the matrix of n listed rows, whose M^-1 J^T is known. */
MG_INTERNAL int mg_is_matrix_of_rows(const mg_context *c, const int *list, int n);

/* True if c->lcp.rows are the rows of a friction problem: of its contacts, one after the other, then bilateral ones. */
MG_INTERNAL int mg_are_contact_rows_first(const mg_context *c, const mg_friction_problem *p);

MG_INTERNAL void mg_require_tables(const mg_system *s);
#define MG_NOTE(c, what, time, x) ((c)->valid.of[what] = mg_state_digest(c, what, time, x))
#define MG_NOTE_TIME(c, time) ((c)->valid.t = (time))
#define MG_NOTE_WITH(c, what, other) ((c)->valid.of[what] = (c)->valid.of[other])
#define MG_NOTE_DIGEST(c, what, digest) ((c)->valid.of[what] = (digest))
#define MG_PLACEMENT_OF(c, contact, eta) \
  mg_placement_digest(c, (c)->contacts.kind[contact], (c)->contacts.o[contact], (c)->contacts.f[contact], eta)
#define MG_NOTE_PLACEMENT(c, contact, eta)                                  \
  (MG_NOTE_DIGEST(c, MG_VALID_PLACEMENT, MG_PLACEMENT_OF(c, contact, eta)), \
   MG_NOTE_DIGEST(c, MG_VALID_PLACED, MG_PLACEMENT_OF(c, contact, 0)))
#define MG_FORGET(c, what) ((c)->valid.of[what] = 0)
#define MG_KEEP_PLACEMENT(c) const mg_validity kept_placement = (c)->valid
#define MG_RESTORE_PLACEMENT(c)                                               \
  ((c)->valid.of[MG_VALID_PLACEMENT] = kept_placement.of[MG_VALID_PLACEMENT], \
   (c)->valid.of[MG_VALID_PLACED] = kept_placement.of[MG_VALID_PLACED])
#define MG_IS_AT(c, what, time, x) ((c)->valid.of[what] == mg_state_digest(c, what, time, x))
#define MG_NEEDS(c, what, time, x) MG_REQUIRE(MG_IS_AT(c, what, time, x))
#define MG_NEEDS_AT(c, what, x) MG_NEEDS(c, what, (c)->valid.t, x)
#define MG_NEEDS_AT_RUN(c, what) MG_NEEDS(c, what, (c)->run->t, (c)->run->x)
#define MG_NEEDS_WITH(c, what, other) MG_REQUIRE((c)->valid.of[what] == (c)->valid.of[other])
#define MG_NEEDS_ANY(c, what) MG_REQUIRE((c)->valid.of[what] != 0)
#define MG_NEEDS_TIME(c, time) MG_REQUIRE((c)->valid.t == (time))
#define MG_NEEDS_DIGEST(c, what, digest) MG_REQUIRE((c)->valid.of[what] == (digest))
#define MG_NEEDS_PLACED(c, contact) MG_NEEDS_DIGEST(c, MG_VALID_PLACED, MG_PLACEMENT_OF(c, contact, 0))
#define MG_NEEDS_PLACED_PAIR(c, feature_pair)                                                                       \
  MG_REQUIRE((c)->valid.of[MG_VALID_PLACED] == mg_placement_digest(c, (c)->system->feature_pair_kind[feature_pair], \
                                                                   mg_feature_body(c, feature_pair, 0),             \
                                                                   mg_feature_body(c, feature_pair, 1), 0))
#define MG_NEEDS_PLACEMENT(c, feature_pair, eta)                                                                       \
  MG_REQUIRE((c)->valid.of[MG_VALID_PLACEMENT] == mg_placement_digest(c, (c)->system->feature_pair_kind[feature_pair], \
                                                                      mg_feature_body(c, feature_pair, 0),             \
                                                                      mg_feature_body(c, feature_pair, 1), eta))
#else
#define MG_NOTE(c, what, time, x) ((void)0)
#define MG_NOTE_TIME(c, time) ((void)0)
#define MG_NOTE_WITH(c, what, other) ((void)0)
#define MG_NOTE_DIGEST(c, what, digest) ((void)0)
#define MG_NOTE_PLACEMENT(c, contact, eta) ((void)0)
#define MG_FORGET(c, what) ((void)0)
#define MG_KEEP_PLACEMENT(c) ((void)0)
#define MG_RESTORE_PLACEMENT(c) ((void)0)
#define MG_NEEDS(c, what, time, x) ((void)0)
#define MG_NEEDS_AT(c, what, x) ((void)0)
#define MG_NEEDS_AT_RUN(c, what) ((void)0)
#define MG_NEEDS_WITH(c, what, other) ((void)0)
#define MG_NEEDS_ANY(c, what) ((void)0)
#define MG_NEEDS_TIME(c, time) ((void)0)
#define MG_NEEDS_DIGEST(c, what, digest) ((void)0)
#define MG_NEEDS_PLACED(c, contact) ((void)0)
#define MG_NEEDS_PLACED_PAIR(c, feature_pair) ((void)0)
#define MG_NEEDS_PLACEMENT(c, feature_pair, eta) ((void)0)
#endif

/* stop_request.c */

/* True if the caller asks that the present call end soon. */
MG_INTERNAL int mg_is_stopped(const mg_context *c);

/* True if the search at hand is to end without a result: it is repeated before anything depends on it. */
MG_INTERNAL int mg_is_search_stopped(const mg_context *c);

/* closed_capacity.c */

/* True if n contacts may be closed at a time; else that is counted. */
MG_INTERNAL int mg_is_room_for_closed(const mg_context *c, int n);

/* run_report.c: the only door through which what a run tells (mg_run_report) is written. Each takes the run, for its
   time. */

/* Forget all, at the start. */
MG_INTERNAL void mg_reset_report(mg_run *run);

/* The energy at the start, J; energy, kinetic energy and work of loads and prescribed motions at a state; the change of
   the energy by a correction of positions; the energy that an impact at time t has added, most of it at a contact. */
MG_INTERNAL void mg_report_start_energy(mg_run *run, mg_real energy);
MG_INTERNAL void mg_report_energy(mg_run *run, mg_real energy, mg_real kinetic, mg_real work);
MG_INTERNAL void mg_report_correction(mg_run *run, mg_real change);
MG_INTERNAL void mg_report_impact_gain(mg_run *run, int contact, mg_real t, mg_real gain);

/* An impact that reached a contact at rest. */
MG_INTERNAL void mg_report_chain_impact(mg_run *run, int contact);

/* The gap of a closed contact, m; gap and force of a contact over their scales; the margin of a closed contact; a
   penetration, m, at a contact. */
MG_INTERNAL void mg_report_gap(mg_run *run, mg_real gap);
MG_INTERNAL void mg_report_complementarity(mg_run *run, mg_real gap, mg_real force);
MG_INTERNAL void mg_report_margin(mg_run *run, mg_real margin);
MG_INTERNAL void mg_report_penetration(mg_run *run, int contact, mg_real depth);

/* The contact that an outcome is about, or -1. */
MG_INTERNAL void mg_report_failed_contact(mg_run *run, int contact);

/* A problem that is solved, without friction, with a law of it, or by settings->outer_solver; the residual of one; the
   active contacts beyond the rank of their rows; a solution to stepping_residual only; one of the relaxation; the
   rounding of forces, relative. */
MG_INTERNAL void mg_report_qp_solve(mg_run *run);
MG_INTERNAL void mg_report_friction_solve(mg_run *run, int law);
MG_INTERNAL void mg_report_outer_solve(mg_run *run);
MG_INTERNAL void mg_report_residual(mg_run *run, mg_real residual);
MG_INTERNAL void mg_report_redundancy(mg_run *run, int redundant);
MG_INTERNAL void mg_report_loose_solution(mg_run *run);
MG_INTERNAL void mg_report_relaxed_solution(mg_run *run);
MG_INTERNAL void mg_report_force_rounding(mg_run *run, mg_real rounding);

/* A singular passage of a contact; an end of slip, spin or rolling. */
MG_INTERNAL void mg_report_passage(mg_run *run, int contact);
MG_INTERNAL void mg_report_slip_stop(mg_run *run);

/* Closest points of a pair that no contact can follow; a search of a pair that was given up; and that the last `count`
   of these searches do not count. */
MG_INTERNAL void mg_report_unfollowed_pair(mg_run *run, int pair);
MG_INTERNAL void mg_report_incomplete_pair(mg_run *run, int pair);
MG_INTERNAL void mg_withdraw_incomplete_searches(mg_run *run, long count);

/* That a capacity, MG_CAPACITY_CLOSED .., was exceeded and something left out. */
MG_INTERNAL void mg_report_exceeded(mg_run *run, int capacity);

/* A pool has too few slots for the pairs that are near; true if one has had. */
MG_INTERNAL void mg_report_too_many_near(mg_run *run, int pool);
MG_INTERNAL int mg_are_too_many_near(const mg_run *run);

/* The joint with the largest error at the start, m or rad, and with the largest velocity error, m/s or rad/s; the
   largest error of a joint row at a state and the rank of all; a dead centre, and the least independence of the rows of
   a joint over the largest that it had. */
MG_INTERNAL void mg_report_start_of_joints(mg_run *run, int joint, mg_real error);
MG_INTERNAL void mg_report_start_speed_of_joints(mg_run *run, int joint, mg_real speed);
MG_INTERNAL void mg_report_joints(mg_run *run, mg_real error, int rank);
MG_INTERNAL void mg_report_dead_centre(mg_run *run, int joint);
MG_INTERNAL void mg_report_joint_margin(mg_run *run, int joint, mg_real margin);

/* A fallback that avoids an outcome; a step h of the present one. */
MG_INTERNAL void mg_report_fallback(mg_run *run, int outcome);
MG_INTERNAL void mg_report_fallback_time(mg_run *run, mg_real h);

/* Time-stepping: the square of the angular speed of a body, rad^2/s^2; the rate of the spring of a load, 1/s. */
MG_INTERNAL void mg_report_spin(mg_run *run, int body, mg_real square);
MG_INTERNAL void mg_report_spring_rate(mg_run *run, int load, mg_real rate);

/* That the motion is one of several, or is not proved to be the only one; `load_switch`: the switching function of the
   load that leaves it open, or -1: friction forces. The first contact in Painleve's paradox. A load at a jump that
   contacts or joints hold too. */
MG_INTERNAL void mg_report_indeterminate(mg_run *run, int load_switch);

/* Another motion was found under forces that obey Coulomb's law: where it differs most, and by how much. */
MG_INTERNAL void mg_report_other_motion(mg_run *run, int contact, mg_real part);
MG_INTERNAL void mg_report_painleve_paradox(mg_run *run, int contact);
MG_INTERNAL void mg_report_shared_switch(mg_run *run, int load_switch);

/* A blow from the side within the plane of faces of both bodies; a patch whose shares overlap. */
MG_INTERNAL void mg_report_flush_blow(mg_run *run, int contact);
MG_INTERNAL void mg_report_overlapping_patch(mg_run *run, int patch);

/* modes.c */

/* Sets whether a closed contact carries force; whether a contact is closed, which it is without force at first, and
   what is open carries none; or that it is closed and carries force. */
MG_INTERNAL void mg_set_active(const mg_context *c, int contact, int is_active);
MG_INTERNAL void mg_set_closed(const mg_context *c, int contact, int is_closed);
MG_INTERNAL void mg_close_contact(const mg_context *c, int contact);

/* Gives a contact that goes on with the same force the modes of a closed contact, whose friction is switched off. Both
   have the same constraints of friction. */
MG_INTERNAL void mg_take_over_modes(const mg_context *c, int from, int to);

/* Set how a contact starts to roll (MG_START_NONE ..), and the modes of a friction constraint and of the friction of a
   slot (MG_FRICTION_OFF ..). */
MG_INTERNAL void mg_set_rolling_start(const mg_context *c, int contact, int start);
MG_INTERNAL void mg_set_friction_mode(const mg_context *c, int constraint, int mode);
MG_INTERNAL void mg_set_patch_mode(const mg_context *c, int slot, int mode);

/* Set the branch of the loads by a switching function, where that is (MG_BRANCH_NEGATIVE ..), and its leader. The
   branch of one that slides may pass the ends of -1..1 in a step, in which its event then is. */
MG_INTERNAL void mg_set_branch(const mg_context *c, int which, mg_real branch);
MG_INTERNAL void mg_set_switch_mode(const mg_context *c, int which, int mode);
MG_INTERNAL void mg_set_switch_leader(const mg_context *c, int which, int leader);

/* load_branches.c */

#define MG_SWITCH_ROUNDING 64 /* roundings of what a switching function depends on that count as zero */

/* First switching function of a load, and the one after its last. */
MG_INTERNAL int mg_switch_begin(const mg_system *s, int load);
MG_INTERNAL int mg_switch_end(const mg_system *s, int load);

/* Load of a switching function. */
MG_INTERNAL int mg_load_of_switch(const mg_system *s, int which);

/* Memory of the gradients of one load, in mg_real. */
MG_INTERNAL long mg_switch_gradient_size(const mg_system *s);

/* Adds `weight` times the wrenches (12) of a load with switching functions on the branches of the run; between branches
   where those from `from` on slide. */
MG_INTERNAL void mg_add_branch_wrench(const mg_context *c, mg_real t, int load, int from, mg_real weight,
                                      mg_real *wrench);

/* Gradient of a switching function of a load: by t, poses and twists (MG_SWITCH_COLUMNS) and parameters; and by the
   inputs. Needs poses and twists. */
MG_INTERNAL const mg_real *mg_switch_gradient(mg_context *c, mg_real t, int load, int which,
                                              const mg_real **input_gradient);

/* Evaluates all switching functions with their rates and second rates. Needs poses, twists and accelerations at t. */
MG_INTERNAL void mg_update_switches(mg_context *c, mg_real t);

/* bodies.c */

/* Body kind of a body. */
MG_INTERNAL int mg_body_kind_of(const mg_context *c, int body);

/* True if forces move the body (MG_POINT, MG_FREE). */
MG_INTERNAL int mg_is_moved_by_forces(const mg_context *c, int body);

/* Copies the velocity coordinates of a body: 6 of a free body, 3 of a point mass, none of the others. */
MG_INTERNAL void mg_copy_velocity(const mg_context *c, int body, const mg_real *from, mg_real *to);

/* Writes pose and twist of one body at time t and state x, of a driven body also its acceleration; those of a fixed
   body stay. */
MG_INTERNAL void mg_place_body(const mg_context *c, mg_real t, const mg_real *x, int body, mg_real *pose,
                               mg_real *twist, mg_real *accel);

/* Writes poses and twists of all bodies at time t and state x; of driven bodies also their accelerations. */
MG_INTERNAL void mg_update_poses(mg_context *c, mg_real t, const mg_real *x);

/* True if loads with switching functions are on their branches: not in time-stepping. */
MG_INTERNAL int mg_has_branches(const mg_context *c);

/* Wrenches (12) of a load on its two bodies at t, at the present poses and twists, as its expressions are written. */
MG_INTERNAL void mg_written_load_wrench(const mg_context *c, mg_real t, int load, mg_real *wrench);

/* The same on the branches of the run. */
MG_INTERNAL void mg_load_wrench(const mg_context *c, mg_real t, int load, mg_real *wrench);

/* Writes q_dot and the power of the loads into x_dot, and the accelerations without constraint forces into
   c->bodies.acceleration; without springs while they act through rows. Needs the poses at x. */
MG_INTERNAL void mg_free_accelerations(mg_context *c, mg_real t, const mg_real *x, mg_real *x_dot);

/* Scales all quaternions in x to unit length. */
MG_INTERNAL void mg_normalise_quaternions(const mg_context *c, mg_real *x);

/* Body of a contact that forces move; o if both do. */
MG_INTERNAL int mg_moving_body(const mg_context *c, int contact);

/* True if the body has six degrees of freedom. */
MG_INTERNAL int mg_is_free_body(const mg_context *c, int body);

/* True if the next step is one of time-stepping, which has no accelerations. */
MG_INTERNAL int mg_is_time_stepping(const mg_context *c);

/* True if the motion of the body is prescribed. */
MG_INTERNAL int mg_is_driven_body(const mg_system *s, int body);

/* True if the load is a spring with a damper. */
MG_INTERNAL int mg_is_spring(const mg_system *s, int load);

/* feature_pair_conditions.c */

/* True if the feature pair has no conditions. */
MG_INTERNAL int mg_is_unconditional_feature_pair(const mg_context *c, int feature_pair);

/* Scales of the entries of eta on a feature pair. */
MG_INTERNAL void mg_eta_scale(const mg_context *c, int feature_pair, mg_real length, mg_real *scale);

/* Numbers of a feature (side 0: o, 1: f) of a feature pair, see MG_FEATURE_PLACEMENT. */
MG_INTERNAL const mg_real *mg_feature_numbers(const mg_context *c, int feature_pair, int side);

/* True if a feature pair has features; those of limits and of support points have none. */
MG_INTERNAL int mg_has_features(const mg_context *c, int feature_pair);

/* Kind of the shape that carries a feature. */
MG_INTERNAL const mg_shape_kind *mg_shape_kind_of(const mg_context *c, int feature_pair, int side);

/* Body of a feature of a feature pair. */
MG_INTERNAL int mg_feature_body(const mg_context *c, int feature_pair, int side);

/* Parametrisation of a feature, MG_NONE .. */
MG_INTERNAL int mg_parametrisation(const mg_context *c, int feature_pair, int side);

/* Numbers of the condition k if it is an MG_CONDITION_QUADRIC that bounds the feature of a side, else 0. */
MG_INTERNAL const mg_real *mg_bounding_quadric(const mg_context *c, int side, int k);

/* Value of an MG_CONDITION_QUADRIC at a point in the axes of its shape, m. */
MG_INTERNAL mg_real mg_quadric_condition(const mg_real *a, const mg_real *x);

/* True if a point of the surface that carries a feature, in the axes of its shape, lies on the feature, or within
   `slack` of it, m, by those conditions that are functions of the point alone. */
MG_INTERNAL int mg_is_within_border(const mg_context *c, int feature_pair, int side, const mg_real *x, mg_real slack);

/* Transforms a point from world axes to the axes of a feature's shape. */
MG_INTERNAL void mg_point_in_shape_axes(const mg_context *c, int feature_pair, int side, const mg_real *world,
                                        mg_real *local);

/* Sine of the angle between two unit vectors. */
MG_INTERNAL mg_real mg_sine_between(const mg_real *a, const mg_real *b);

/* True if a feature of revolution and another one, or a part of it that replaces it while they are coaxial, are so
   nearly coaxial that the margin of their closest points may be small only because of that. */
MG_INTERNAL int mg_is_almost_coaxial(const mg_context *c, int feature_pair);

/* True if that holds and none of them is a ball: parts replace the feature where they are up to flat_angle from
 * coaxial.
 */
MG_INTERNAL int mg_is_handed_over_early(const mg_context *c, int feature_pair);

/* True if a side of a feature pair is a feature of revolution that parts of it replace while a ball is on its axis. */
MG_INTERNAL int mg_is_revolved(const mg_context *c, int feature_pair, int side);

/* True if a side of a feature pair is one of the parts that replace a feature of revolution while the other one is
   coaxial with it: together they are one contact along a circle. */
MG_INTERNAL int mg_is_part_of_circle(const mg_context *c, int feature_pair);

/* Margin that closest points of the feature pair need. */
MG_INTERNAL mg_real mg_least_margin(const mg_context *c, int feature_pair);

/* True if at the present poses parts of the feature replace it, or it replaces this part of it. */
MG_INTERNAL int mg_is_replaced_coaxially(const mg_context *c, int feature_pair);

/* Value of condition k at eta; it holds if >= 0. Needs mg_place_contact at eta. */
MG_INTERNAL mg_real mg_feature_pair_condition(const mg_context *c, int feature_pair, int k, const mg_real *eta);

/* Conditions of a feature pair. */
enum {
  MG_LEAVING = 0,        /* a contact leaves the feature pair beyond them */
  MG_LEAVING_ASIDE = 1,  /* those of them that end no line */
  MG_WATCHED = 2,        /* a contact stays on the feature pair beyond them */
  MG_SEARCHED_BEYOND = 3 /* these, and those that end a line; the pair is searched beyond them */
};

/* Least value at eta of those conditions of a feature pair, and its number in *which (-1: there are none);
   time-stepping adds parallel_angle to those that end a line. Needs mg_place_contact at eta. */
MG_INTERNAL mg_real mg_least_feature_pair_condition(const mg_context *c, int feature_pair, const mg_real *eta,
                                                    int those, int *which);

/* True if the feature pair beyond a condition is of another pair of shapes: their surfaces join smoothly there. */
MG_INTERNAL int mg_leads_to_other_pair(const mg_context *c, int feature_pair, int condition);

/* Least value of the conditions beyond which a contact leaves the feature pair. */
MG_INTERNAL mg_real mg_most_violated_condition(const mg_context *c, int feature_pair, const mg_real *eta, int *which);

/* True if an edge or a face beside a vertex or an edge points so far beyond the other feature that no contact begins
   there: a watched condition is below -appear_tilt_sine. Needs mg_place_contact at eta. */
MG_INTERNAL int mg_is_tilted_beyond_watched(const mg_context *c, int feature_pair, const mg_real *eta);

/* True if contacts on a feature pair may be held at the end of a line along which the straight features of the feature
   pair `line` touch (-1: of any). */
MG_INTERNAL int mg_ends_line(const mg_context *c, int feature_pair, int line);

/* Least value at eta of the conditions by which it ends that line: where it is negative, the straight features are
   nearer elsewhere on the line. MG_MAX without any. Needs mg_place_contact at eta. */
MG_INTERNAL mg_real mg_least_line_end_condition(const mg_context *c, int feature_pair, int line, const mg_real *eta);

/* True if eta holds signs that select the direction of N (two curves). */
MG_INTERNAL int mg_has_normal_sign(const mg_context *c, int feature_pair);

/* True if no condition on the normal determines which side of the curves is outside. */
MG_INTERNAL int mg_has_no_outside(const mg_context *c, int feature_pair);

/* contacts_of_near_pairs.c */

/* Contact or row after `row` (-1: the first) of those that take part; beyond contacts the probe, beyond rows the
   number of all. */
static inline int mg_next_row(const mg_context *c, int row) { return c->listed.row[row + 1]; }

/* The same for friction constraints; beyond the last their number. */
static inline int mg_next_constraint(const mg_context *c, int constraint) {
  return c->listed.constraint[constraint + 1];
}

/* The same for pairs of shapes; beyond the last the number of pairs. */
static inline int mg_next_pair(const mg_context *c, int pair) { return c->listed.pair[pair + 1]; }

/* The same for patches; beyond the last the number of patches. */
static inline int mg_next_patch(const mg_context *c, int patch) { return c->listed.patch[patch + 1]; }

/* First of a range of states that take part. */
static inline int mg_range_begin(const mg_context *c, int range) { return c->listed.range[2 * range]; }

/* End of a range of states that take part. */
static inline int mg_range_end(const mg_context *c, int range) { return c->listed.range[2 * range + 1]; }

/* Copies the states that take part; the two arrays do not overlap. */
MG_INTERNAL void mg_copy_states(const mg_context *c, const mg_real *from, mg_real *to);

/* True if all states that take part are finite. */
MG_INTERNAL int mg_are_states_finite(const mg_context *c, const mg_real *x);

/* Lists what belongs to the pairs of c->listed.listed, and what takes part always. */
MG_INTERNAL void mg_list_pairs(mg_context *c);

/* Lists the states of the bodies, of the listed contacts that are on a feature pair, and the work. */
MG_INTERNAL void mg_list_states(mg_context *c);

/* True if the pair may be left out while its shapes are far apart. */
MG_INTERNAL int mg_may_be_far(const mg_context *c, int pair);

/* True if each contact of the pair has a feature pair of its own, whose closest points are unique, never end, and are
   found from any start. */
MG_INTERNAL int mg_is_pair_followed_from_anywhere(const mg_context *c, int pair);

/* Most closest points that contacts may leave in one step. */
MG_INTERNAL int mg_abandoned_capacity(const mg_system *s);

/* Lists the pairs that the run has not left out. */
MG_INTERNAL void mg_init_listing(mg_context *c);

/* pair_pools.c */

/* Slots of all pools. */
MG_INTERNAL int mg_slot_count(const mg_system *s);

/* True if a pair is a slot of a pool. */
MG_INTERNAL int mg_is_slot(const mg_system *s, int pair);

/* Ball around the shape of a side (0: o, 1: f) of a pair; -1: none. */
MG_INTERNAL int mg_ball_of_pair(const mg_context *c, int pair, int side);

/* The body of a pair that its entries name so: another one in a slot. */
MG_INTERNAL int mg_body_in_pair(const mg_context *c, int pair, int named);

/* Solid of a side of a pair; MG_NO_MATERIAL, MG_UNKNOWN_MATERIAL. */
MG_INTERNAL int mg_solid_of_pair(const mg_context *c, int pair, int side);

/* The number by which results tell a pair: of a slot, that of the pair that it stands for. */
MG_INTERNAL int mg_told_pair(const mg_system *s, const mg_run *run, int pair);

/* Empties all slots. */
MG_INTERNAL void mg_empty_slots(mg_context *c);

/* Begins to look for near pairs: lists the slots in use. */
MG_INTERNAL void mg_open_slots(mg_context *c);

/* The slot of the pair of two balls, a free one if it has none; -1 if it is of no pool, or its pool has none left,
   which c->listed.slots.exceeded tells. Needs mg_open_slots. */
MG_INTERNAL int mg_slot_for_balls(mg_context *c, int small, int large);

/* broad_phase.c */

/* Centre of a ball, world axes. */
MG_INTERNAL void mg_ball_centre(const mg_context *c, int ball, mg_real *centre);

/* How far the centre of a ball has moved since the margins were set, m. */
MG_INTERNAL mg_real mg_ball_movement(const mg_context *c, int ball);

/* True if the centre of a ball has moved by more than its margin. */
MG_INTERNAL int mg_has_moved_beyond_margins(const mg_context *c);

/* Cells of the grid. */
MG_INTERNAL int mg_grid_size(const mg_system *s);

/* Writes the pairs that may be far and are near to c->listed.found, ascending: those whose balls, enlarged by their
   margins and a half of the reach of searches each, overlap, or that reach a plane. Needs the poses. */
MG_INTERNAL void mg_find_near_pairs(mg_context *c);

/* contact_rows.c */

/* Evaluates d, J, Gamma2, eta_dot, N and tangents of a contact on a feature pair at x. Needs the poses at x. */
MG_INTERNAL void mg_update_rows_of_contact(mg_context *c, int contact, const mg_real *x);

/* The same of all contacts. Needs the poses at x. */
MG_INTERNAL void mg_update_contact_rows(mg_context *c, const mg_real *x);

/* J of a row times velocities or accelerations, 6 per body. */
static inline mg_real mg_row_times(const mg_context *c, int contact, const mg_real *per_body) {
  MG_REQUIRE(contact >= 0 && contact < c->layout.spring_row_end);
  const mg_real *J = c->rows.J + 12 * contact;
  const int o = c->contacts.o[contact], f = c->contacts.f[contact];
  mg_real sum = 0;
  if (c->bodies.motion[o] != MG_FIXED) sum = mg_dot6(J, per_body + 6 * o);
  if (c->bodies.motion[f] != MG_FIXED) sum += mg_dot6(J + 6, per_body + 6 * f);
  return sum;
}

/* Part of d_dot that prescribed motions of bodies and joints cause. */
MG_INTERNAL mg_real mg_prescribed_gap_rate(const mg_context *c, int contact);

/* Writes d_dot of all rows at the present twists. */
MG_INTERNAL void mg_update_gap_rates(mg_context *c);

/* First row of a friction constraint of a contact. */
MG_INTERNAL int mg_first_friction_row(const mg_context *c, int contact, int constraint);

/* Rotates the components (a, b) of a vector by an angle given as cosine and sine. */
MG_INTERNAL void mg_rotate_pair(mg_real cosine, mg_real sine, mg_real *a, mg_real *b);

/* Writes slip, spin and rolling velocity of all friction rows. */
MG_INTERNAL void mg_update_slip_velocities(mg_context *c);

/* delassus_matrix.c */

/* Makes the rows that act on each body be listed anew, where they are next needed. */
MG_INTERNAL void mg_forget_incidence(mg_context *c);

/* Writes M^-1 J^T of a row, zero for bodies that forces do not move. Returns J M^-1 J^T. */
MG_INTERNAL mg_real mg_update_inverse_mass_row(mg_context *c, int contact);

/* per_body += M^-1 J^T amount. */
MG_INTERNAL void mg_add_row_response(mg_context *c, int contact, mg_real amount, mg_real *per_body);

/* True if n > 0 listed rows act on the same two bodies. */
MG_INTERNAL int mg_are_rows_of_one_pair(const mg_context *c, const int *list, int n);

/* c->lcp.A = J M^-1 J^T over n listed rows, with 1 added to the diagonal of springs; uses that rows without a common
   moving body have zero entries. */
MG_INTERNAL void mg_assemble_delassus(mg_context *c, const int *list, int n);

/* The same for rows that all act on one pair of bodies; exactly symmetric. */
MG_INTERNAL void mg_assemble_delassus_of_pair(mg_context *c, const int *list, int n);

/* The same for the joint rows, unless c->lcp.A is theirs already; lists them in c->lcp.rows. Returns their number. */
MG_INTERNAL int mg_assemble_joint_rows(mg_context *c);

/* Square of the change of a row since it was `before` [12], in the metric M^-1. */
MG_INTERNAL mg_real mg_square_of_row_change(const mg_context *c, int row, const mg_real *before);

/* Entry J_row M^-1 J_column^T of the Delassus matrix. */
MG_INTERNAL mg_real mg_delassus_entry(const mg_context *c, int row, int column);

/* joint_rows.c */

/* Number of the rows of a joint that it holds, which come before those of its armature. */
MG_INTERNAL int mg_held_joint_rows(const mg_context *c, int joint);

/* 1 for a row that yields, of armature or of a spring in a step of time-stepping: added to its diagonal of J M^-1 J^T;
   0 for the others. */
MG_INTERNAL mg_real mg_row_yield(const mg_context *c, int row);

/* Kinetic energy of the armature of all joints at time t and state x, J. Writes nothing. */
MG_INTERNAL mg_real mg_armature_energy(const mg_context *c, mg_real t, const mg_real *x);

/* Assigns bodies to the joint rows. */
MG_INTERNAL void mg_init_joint_rows(mg_context *c);

/* Evaluates the rows of all joints at t. Needs the poses and twists. */
MG_INTERNAL void mg_update_joint_rows(mg_context *c, mg_real t);

/* Appends all joint rows to a list of n rows; returns its length. */
MG_INTERNAL int mg_append_joint_rows(const mg_context *c, int *list, int n);

/* Joint of a joint row. */
MG_INTERNAL int mg_row_joint(const mg_context *c, int row);

/* Joint of the row with the largest |value|, and that size. */
MG_INTERNAL int mg_worst_joint(const mg_context *c, const mg_real *value, mg_real *size);

/* spring_rows.c */

/* Number of springs. */
MG_INTERNAL int mg_spring_count(const mg_system *s);

/* Assigns loads and bodies to the rows of springs. */
MG_INTERNAL void mg_init_spring_rows(mg_context *c);

/* Writes J of the row of a spring; returns its deflection. Needs the poses. */
MG_INTERNAL mg_real mg_update_spring_row(mg_context *c, int row);

/* Appends the rows of springs, while they act through them, to a list of n rows; returns its length. */
MG_INTERNAL int mg_append_spring_rows(const mg_context *c, int *list, int n);

/* contact_point_newton.c */

/* Evaluates contact_place for a contact at eta into c->search.placement; eta_next receives one Newton step.
   Returns the length of eta. */
MG_INTERNAL int mg_place_contact(mg_context *c, int contact, const mg_real *eta, mg_real *eta_next);

/* True if the residual of a placement is below a tolerance, of the length and in angles, or as small as rounding of the
   positions permits. */
MG_INTERNAL int mg_is_residual_small(const mg_real *pose_o, const mg_real *pose_f, mg_real tolerance, mg_real length,
                                     const mg_real *placed);

/* True if the placement of a contact solves the extremality equations. Needs that of this contact evaluated last. */
MG_INTERNAL int mg_is_placement_critical(const mg_context *c, int contact);

/* Margin of the placement of a contact, dimensionless. Needs that of this contact evaluated last. */
MG_INTERNAL mg_real mg_placement_margin(const mg_context *c, int contact);

/* How well the closest points of the placement of a contact are determined: its margin; where eta is empty, how far the
   points are from a curve of them, whatever the curvature. Needs the placement of this contact evaluated last. */
MG_INTERNAL mg_real mg_placement_uniqueness(const mg_context *c, int contact);

/* Margin of a contact. Needs its placement evaluated last. A point without curvature where eta is empty is singular
   only if the contact point moves over it: if Gamma2, as evaluated last, is above the characteristic acceleration. */
MG_INTERNAL mg_real mg_contact_margin(const mg_context *c, int contact);

/* Takes one Newton step of eta in x for every contact at time t, except for those that are still flat, whose
   points rounding would move; writes d and margins. Returns 0 if eta is not finite. */
MG_INTERNAL int mg_place_all_contacts(mg_context *c, mg_real t, mg_real *x);

/* Newton's method on eta of a contact at the present poses. Returns the number of steps, or -1 after 50. */
MG_INTERNAL int mg_newton_on_feature_pair(mg_context *c, int contact, mg_real *eta);

/* True for a contact that starts from flat and whose tilt is still below flat_angle. */
MG_INTERNAL int mg_is_tilt_below_flat_limit(const mg_context *c, int contact);

/* distance_and_motion_bounds.c */

/* Length to which the settings of searches for closest points of a pair refer, m: the smaller radius of the balls
   around its shapes, at least the characteristic length. */
MG_INTERNAL mg_real mg_pair_length(const mg_context *c, int pair);

/* Radius of the smaller ball around the shapes of a pair that is no point, mg_pair_length at most, m: once the pair has
   moved by a part of that, other points of it are closest. */
MG_INTERNAL mg_real mg_pair_size(const mg_context *c, int pair);

/* Gap in m up to which a search follows the closest points of a pair. */
MG_INTERNAL mg_real mg_search_reach(const mg_context *c, int pair);

/* True if the features of a pair are farther apart than a search follows. */
MG_INTERNAL int mg_is_out_of_reach(const mg_context *c, int feature_pair);

/* Lower bound of the distance of a pair of shapes, m: the larger of that of their own balls and the least of those
   of their features. */
MG_INTERNAL mg_real mg_pair_clearance(const mg_context *c, int pair);

/* Ball around the shape of o (side 0) or f of a pair: centre in the axes of its body, and radius, < 0: unbounded. */
MG_INTERNAL const mg_real *mg_pair_ball(const mg_context *c, int pair, int side);

/* The side of a pair whose shape has no ball; 1 if both have one. */
MG_INTERNAL int mg_unbounded_side(const mg_context *c, int pair);

/* True if both shapes of a pair are bounded. */
MG_INTERNAL int mg_has_pair_extents(const mg_context *c, int pair);

/* Bound of the motion of the shapes of a pair relative to each other, in the axes of the body that gives the
   smaller one; of unbounded shapes the parts within the characteristic length count. The acceleration is 0 where it is
   not asked for. */
MG_INTERNAL mg_motion_bound mg_pair_motion_bound(const mg_context *c, int pair, int with_acceleration);

/* Bound of the movement of the shapes of a pair relative to each other, m, from the poses `before` [12 per body] to the
   present ones; as above. */
MG_INTERNAL mg_real mg_pair_movement_bound(const mg_context *c, int pair, const mg_real *before);

/* The speed alone. */
MG_INTERNAL mg_real mg_pair_speed_bound(const mg_context *c, int pair);

/* Bound of the movement of a pair in a step h that ends at the present poses, m: by its speed there, and by how far it
   is from where it was at the start of the step. */
MG_INTERNAL mg_real mg_pair_step_movement(const mg_context *c, int pair, mg_real h);

/* contact_feature_pair.c */

/* True if the contact is a support point of a patch. */
MG_INTERNAL int mg_is_support_contact(const mg_context *c, int contact);

/* True if the contact is on a feature pair. */
MG_INTERNAL int mg_is_on_feature_pair(const mg_context *c, int contact);

/* Entries of eta for which a contact has room. */
MG_INTERNAL int mg_eta_capacity(const mg_context *c, int contact);

/* Eta of a contact in x. */
MG_INTERNAL mg_real *mg_contact_eta(const mg_context *c, mg_real *x, int contact);

/* Parameters of the contact kind of a contact; of a support point with the point that the run holds. */
MG_INTERNAL const mg_real *mg_contact_parameters(mg_context *c, int contact);

/* Sets kind, parameters and bodies of a contact (n_contact: the probe) to those of a feature pair. */
MG_INTERNAL void mg_place_on_feature_pair(mg_context *c, int contact, int feature_pair);

/* First contact of a pair of shapes. */
MG_INTERNAL int mg_pair_first_contact(const mg_context *c, int pair);

/* True if each contact of the pair has a feature pair of its own; else the contacts share all feature pairs of the
   pair. */
MG_INTERNAL int mg_has_own_feature_pairs(const mg_context *c, int pair);

/* Updates c->contacts, error scales and rows of a contact from run->feature_pair. A contact on no feature pair gets an
   infinite gap, so that no loop over contacts need ask. */
MG_INTERNAL void mg_load_feature_pair(mg_context *c, int contact);

/* The same of all contacts whose pairs take part; of the
   others, which are loaded as their pairs come near, the bodies of their rows. */
MG_INTERNAL void mg_open_contacts(mg_context *c);

/* Puts a contact on a feature pair with the given eta, or on none (-1). */
MG_INTERNAL void mg_set_feature_pair(mg_context *c, int contact, int feature_pair, const mg_real *eta);

/* planar_contacts.c */

/* First of the three support contacts of a slot. */
MG_INTERNAL int mg_first_support(const mg_context *c, int slot);

/* Patch that a slot holds, or -1. */
MG_INTERNAL int mg_patch_of_slot(const mg_context *c, int slot);

/* Slot that holds a patch, or -1. */
MG_INTERNAL int mg_slot_of_patch(const mg_context *c, int patch);

/* An empty slot for a patch, or -1. */
MG_INTERNAL int mg_find_free_slot(const mg_context *c, int patch);

/* True if the feature pair lies in the patch. */
MG_INTERNAL int mg_is_feature_pair_in_patch(const mg_context *c, int patch, int feature_pair);

/* Patch in which the contact's feature pair lies and whose faces are opposed within an angle, or -1. */
MG_INTERNAL int mg_find_flat_patch_of_contact(const mg_context *c, int contact, mg_real tilt_tolerance);

/* True if the feature pair exists only while the faces lie flat. */
MG_INTERNAL int mg_is_feature_pair_of_flat_faces(const mg_context *c, int feature_pair);

/* True if the feature pair exists only while the bodies are tilted. */
MG_INTERNAL int mg_is_feature_pair_of_tilted_faces(const mg_context *c, int feature_pair);

/* True if the contact's feature pair is for flat faces and its gap is out of reach, so that leaving it is no event. */
MG_INTERNAL int mg_is_distant_flat_feature_pair(const mg_context *c, int contact);

/* True if a rim of the patch has just started to roll. */
MG_INTERNAL int mg_is_patch_rolling_start(const mg_context *c, int patch);

/* True if a patch of the pair is opening from flat. */
MG_INTERNAL int mg_has_opening_patch(const mg_context *c, int pair);

/* Longest step in s after which the faces of opening patches tilt no more than a search finds at once. */
MG_INTERNAL mg_real mg_patch_opening_step_limit(const mg_context *c);

/* True if the contact is on a rim whose faces have just opened, and its gap and velocity are those of a fall from
   rest since then: it was pressed without having equations, and does not bounce. */
MG_INTERNAL int mg_has_patch_just_opened(const mg_context *c, int contact);

/* True if the feature pair lies in a patch that is held, or in one that starts to roll over a rim. */
MG_INTERNAL int mg_is_feature_pair_covered(const mg_context *c, int feature_pair);

/* True if feature pairs of a pair may be covered. */
MG_INTERNAL int mg_may_feature_pairs_be_covered(const mg_context *c, int pair);

/* True if faces of the pair's shapes may lie in the patch. */
MG_INTERNAL int mg_is_patch_of_pair(const mg_context *c, int patch, int pair);

/* True if a patch of the pair is held. */
MG_INTERNAL int mg_has_held_patch(const mg_context *c, int pair);

/* Request a search of all pairs of a patch at the end of the step. */
MG_INTERNAL void mg_request_pair_searches(mg_context *c, int patch);

/* Body of one side of a patch: 0 for o, 1 for f. */
MG_INTERNAL int mg_patch_body(const mg_context *c, int patch, int side);

/* Point of f, in its body's axes, of the feature pair of a support contact. */
MG_INTERNAL const mg_real *mg_support_point_of_feature_pair(const mg_context *c, int feature_pair);

/* Put a patch into a slot: its three support contacts are placed, closed and active. */
MG_INTERNAL void mg_attach_patch(mg_context *c, int slot, int patch);

/* Empty a slot: its support contacts leave their feature pairs. */
MG_INTERNAL void mg_release_patch(mg_context *c, int slot);

/* Pose of one face of a patch in world axes: origin and rotation, 12 numbers. */
MG_INTERNAL void mg_face_pose(const mg_context *c, int patch, int side, mg_real *out);

/* True if the contact is a support that an impact has moved to the edge of its hull. */
MG_INTERNAL int mg_is_support_on_edge(const mg_context *c, int contact);

/* True if the slot holds an edge in place of a patch. */
MG_INTERNAL int mg_is_edge_pivot(const mg_context *c, int slot);

/* True if the edge held is a straight side of the hull. */
MG_INTERNAL int mg_is_hull_side_pivot(const mg_context *c, int slot);

/* Cause for which the held edge ends, or 0: enough tilt, flat again, or one end unloaded. */
MG_INTERNAL int mg_find_pivot_end_cause(const mg_context *c, int slot, const mg_real *amount, mg_real floor);

/* Event function of a held edge, for the given cause. */
MG_INTERNAL mg_real mg_pivot_event_value(const mg_context *c, int slot, int cause);

/* contact_transitions.c */

/* True for a slow blow of a contact that has moved no farther, since it began to approach, than positions are rounded.
 */
MG_INTERNAL int mg_is_bounce_tiny(const mg_context *c, int contact, mg_real approach);

/* Appends an event to the list, if there is room. */
MG_INTERNAL void mg_append_event(const mg_context *c, mg_events *events, mg_real t, int kind, int contact,
                                 mg_real speed);

/* Applies a transition to a contact: sets it closed or open and appends its event. `cause`: MG_IMPACT_INELASTIC .. */
MG_INTERNAL void mg_apply_contact_transition(mg_context *c, mg_events *events, int contact, int cause, mg_real t,
                                             mg_real speed);

/* Clears the event marks of all contacts. */
MG_INTERNAL void mg_clear_triggered_events(mg_context *c);

/* Advances t by h with compensated summation (Kahan), so that many short steps lose nothing. */
MG_INTERNAL void mg_advance_time(mg_run *run, mg_real h);

#endif
