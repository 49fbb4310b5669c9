/* What the files of the core share: the scratch of one call and the functions each file offers the others. */
#ifndef MG_CORE_H
#define MG_CORE_H

#include "friction.h"
#include "kinds.h"
#include "lcp_scaled.h"
#include "modelgen.h"
#include "region.h"

#define MG_GRID 17      /* samples along each side of a chart at the start */
#define MG_COARSE 9     /* and during a run */
#define MG_SAMPLES 289  /* MG_GRID squared */
#define MG_STARTS 8     /* of Newton's method on one link */
#define MG_FOUNDS 24    /* closest points of one pair */
#define MG_WALKS 3      /* mark in c->fired: the contact leaves its link */
#define MG_TIPS 4       /* mark in c->fired: it stays, but passes a border beyond which others may begin */

#define MG_TURNS 5      /* mark in c->fired of a slot's first pad: the centre of pressure leaves the hull */
#define MG_PARTS 6      /* the same: no force is left between the faces */
#define MG_ROLLS_OFF 7  /* the same: an imaginary edge gives way to the rim */
#define MG_SETTLES 8    /* the same: or to the face, which is flat again */
#define MG_YIELDS 9     /* the same: a side of the hull that is held no longer presses at one of its ends */

#define MG_NUMBERS 32 /* more than the parameters of a point on a plane */
#define MG_RADAU 7   /* stages of collocation */
#define MG_ETA 8     /* more than the entries of any contact's eta */
#define MG_STAGES 17 /* rows of K: 16 of DOP853, one spare for the right-hand side at events */

typedef struct { /* a point of a shape: its chart coordinates, in the shape's axes, in the world */
  mg_real uv[2], local[3], point[3], direction[3];
} mg_sample;

typedef struct { /* where Newton's method starts on one link, the likeliest first */
  int count;
  mg_real merit[MG_STARTS], eta[MG_STARTS][6];
} mg_starts;

typedef struct { /* an extremum; undecided: which side of two curves is outside cannot be told */
  int link, undecided;
  mg_real d, margin, point[3], normal[3], eta[6];
} mg_found;

typedef struct {
  int count;
  mg_found list[MG_FOUNDS];
} mg_founds;

typedef struct { /* how the bodies of a fresh contact lean on each other during its first step */
  mg_real normal[3], outward[3], axis[3];                        /* N and the way out in o's axes; N in f's axes */
  mg_real azimuth[MG_RADAU], tilt[MG_RADAU], stiffness[MG_RADAU]; /* at the stages: rad from the way out; rad; 1/s^2 */
  mg_real blur[MG_RADAU];                                         /* what rounding of the poses makes of the azimuth, rad */
} mg_onset;

typedef struct { /* a contact's lean: the part across N of what was N when f lay flat, and the frame of an azimuth */
  mg_real normal[3], along[3], across[3], lean[3];
} mg_lean;

typedef struct {
  const mg_system *sys;
  const mg_settings *set;
  mg_run *run;
  int below, n_all;                         /* rows below the normal ones: from `below` to n_all, behind all others */
  int first_pad, first_pad_link;            /* contacts and links from there on are of patches */
  int n_x, work_index;                      /* length of x; index of the work state */
  mg_real *pose, *twist, *accel, *wrench;   /* per body 12, 6, 6, 6; accel without, then with contact forces */
  int bilateral, n_rows;                    /* rows: contacts, a spare, then those of the joints from `bilateral` on */
  mg_real *J, *MJ;                          /* per row 12: o then f; J and M^-1 J^T */
  mg_real *d, *gamma, *d_dot;               /* per row */
  mg_real *part, *most;                     /* per row of a joint: its own part, 0..1; per joint: their product at most */
  mg_real *MJ_before;                       /* per row of a joint 12: M^-1 J^T after the step before */
  mg_real *bias;                            /* per row: what time alone makes of d_dot */
  mg_real *normal, *tangents;               /* per contact 3; 6 */
  mg_real *block;                           /* rows of one contact as its kernel gives them: 6, 6 and 1 a row */
  mg_real *lean, *steer;                    /* per row below: force over -N of slip; per grip: angle of slip from its course */
  int leaning, steering;                    /* forces are sought: rows of slipping grips go with N; along steer */
  mg_real *force, *rate, *amount, *eta_dot; /* per row 1, 1, 1; n_eta */
  mg_real *A, *b, *z, *lcp;                 /* complementarity problem and its scratch */
  mg_real *S, *s, *y;                       /* the same with the joints eliminated */
  mg_real *K, *x_next, *x_stage, *settled;  /* stages; states; the end of a step with eta corrected */
  mg_real *dense;                           /* interpolant, 8 rows */
  mg_real *place;                           /* scratch of the place kernel */
  mg_real numbers[MG_NUMBERS];              /* parameters of a pad's contact */
  int *list, *mask, *fired, *near, *lcp_i; /* near: per contact, it takes part in a step of time-stepping */
  int *bound;                               /* mask of the rows of joints among those assembled */
  int *kept, *free;                         /* per row of a joint: independent after the step before; at any step */
  int *slipped, *before, *bound_of, *gives; /* per grip: its event has fired; its mode before; what bounds it; it slips */
  mg_real *over, *cone, *coulomb;           /* per grip: s, slip that was stopped had left; MG_CONE a contact; scratch */
  int *cone_contact, *cone_first, *cone_rows, *marks, *coulomb_i; /* per contact of the problem; scratch */
  int *kind, *o, *f, *n_eta, *parameters;   /* per contact: of its link; n_eta 0 on no link */
  int *upright;                             /* per contact: it had passed no watched border at the start of the step */
  int *way;                                 /* per contact: the condition that leads it off its link */
  int *falling;                             /* per contact: its open gap shrinks at the start of a step, grows at its end */
  int *column;                              /* per row: its place in A while assembled, else -1 */
  int *parent, *head, *next, *island;       /* islands: per body, body, row; held rows of one */
  int *first, *incident;                    /* rows at each moving body: incident[first[b]] .. */
  int *hidden;                              /* per contact: covered by a patch that is held */
  int *trying, *barred;                     /* per slot: held on trial; a patch not to be held again now, or -1 */
  int n_live;                               /* states without those of contacts on no link */
  mg_sample *sample;                        /* of both sides of a link: 2 MG_SAMPLES */
  mg_real *merit;                           /* of the samples of o with their best mate */
  int *mate;
  mg_starts starts;
  mg_founds left;                           /* what contacts left in this step, not to be found again */
  int driven, moving;                       /* numbers of driven bodies, of bodies that forces move */
  int prescribed;                           /* a joint's motion is given */
  mg_arc *arc;                              /* the boundaries of a patch */
  mg_regions regions;
  mg_real *lay;                             /* memory of the hull */
  mg_hull hull;
  int laid;                                 /* the patch whose hull that is, or -1 */
  mg_onset *onset;                          /* per contact */
  mg_real pace;                             /* what an explicit step after collocation can follow, s */
  int begins;                               /* the rows are those at run->x */
  int suspect;                              /* an event function changed sign at a stage */
} mg_context;

typedef struct { /* two shapes of a contact kind, where they are */
  int kind;
  const mg_real *pose_o, *pose_f, *parameters;
} mg_couple;

typedef struct { /* what Newton's method is asked for */
  mg_real length, small; /* a residual below (small * length, small) */
  const mg_real *reach;  /* how far each entry of eta may go in one step */
} mg_goal;

typedef struct { /* their separation function along a normal */
  mg_real normal[3], d, slope[2], bend[3], tangents[6], eta[6];
} mg_view;

/* context.c */
static void mg_open(mg_context *c, const mg_system *sys, const mg_settings *set, mg_run *run, mg_real *work, int *iwork);
static void mg_set_fixed(mg_context *c);

/* links.c */
static int mg_present(const mg_context *c, int contact);
static void mg_stand(mg_context *c, int contact, int link);
static int mg_is_endless(const mg_context *c, int link);
static int mg_first_contact(const mg_context *c, int pair);
static int mg_has_own_links(const mg_context *c, int pair);
static mg_real *mg_eta_of(const mg_context *c, mg_real *x, int contact);
static const mg_real *mg_parameters_of(mg_context *c, int contact);
static void mg_take_link(mg_context *c, int contact);
static void mg_set_link(mg_context *c, int contact, int link, const mg_real *eta);

/* conditions.c */
static const mg_real *mg_side(const mg_context *c, int link, int side);
static int mg_side_body(const mg_context *c, int link, int side);
static int mg_carrier(const mg_context *c, int link, int side);
static void mg_unturn(const mg_real *R, const mg_real *x, mg_real *out);
static void mg_point_in(const mg_context *c, int link, int side, const mg_real *world, mg_real *local);
static inline mg_real mg_dot3(const mg_real *a, const mg_real *b);
static mg_real mg_sine(const mg_real *a, const mg_real *b);
static mg_real mg_condition(const mg_context *c, int link, int k, const mg_real *eta);
static mg_real mg_least_condition(const mg_context *c, int link, const mg_real *eta, int watched, int *which);
static mg_real mg_worst_condition(const mg_context *c, int link, const mg_real *eta, int *which);

/* sample.c */
static void mg_out(const mg_real *pose, const mg_real *x, int is_point, mg_real *out);
static mg_real mg_reach_of(mg_context *c, int link);
static void mg_window(mg_context *c, int link, int side, mg_real reach, mg_real *window);
static int mg_dimension(const mg_context *c, int link, int side);
static void mg_sample_at(mg_context *c, int link, int side, const mg_real *uv, mg_sample *at);
static int mg_sample_side(mg_context *c, int link, int side, const mg_real *window, int n, mg_sample *out);
static void mg_zoom(mg_real *window, const mg_real *centre);

/* starts.c */
static void mg_start_eta(const mg_context *c, int link, const mg_sample *o, const mg_sample *f, mg_real *eta);
static void mg_find_starts(mg_context *c, int link, int n, int zooms, mg_starts *kept);

/* search.c, walk.c */
static int mg_probe(mg_context *c, int link);
static int mg_has_signs(const mg_context *c, int link);
static int mg_is_bare(const mg_context *c, int link);
static void mg_turn_round(const mg_context *c, int link, mg_real *eta);
static void mg_note_place(const mg_context *c, mg_found *found);
static int mg_same_contact(const mg_context *c, const mg_found *a, const mg_found *b);
static mg_real mg_parting(mg_context *c, int pair);
static void mg_search_link(mg_context *c, int link, int n, int zooms, mg_real least, mg_founds *kept);
static mg_real mg_clearance(const mg_context *c, int link);
static int mg_is_far(const mg_context *c, int link);
static int mg_is_followed(mg_context *c, int pair, int contact, const mg_found *found);
static int mg_slot_for(const mg_context *c, int pair, const mg_found *found);
static int mg_is_taken_up(const mg_context *c, const mg_found *found);
static int mg_start_pairs(mg_context *c);
static int mg_walk_all(mg_context *c, mg_events *events);
static int mg_search_all(mg_context *c, mg_events *events, mg_real h);

static void mg_leave(mg_context *c, mg_events *events, int contact);
static mg_real mg_step_over(mg_context *c, int from, int to, const mg_real *at, mg_real *eta, int *which);

/* bodies.c */
static inline int mg_moves(const mg_context *c, int body);
static inline int mg_kind_of(const mg_context *c, int body);
static void mg_copy_u(const mg_context *c, int body, const mg_real *from, mg_real *to);
static void mg_poses(mg_context *c, mg_real t, const mg_real *x);
static void mg_accelerations(mg_context *c, mg_real t, const mg_real *x, mg_real *x_dot);
static void mg_normalise(const mg_context *c, mg_real *x);

/* contacts.c */
static void mg_rates(mg_context *c, const mg_real *x);
static void mg_gap_rates(mg_context *c);
static mg_real mg_driven_rate(const mg_context *c, int contact);
static mg_real mg_row(const mg_context *c, int contact, const mg_real *per_body);
static mg_real mg_weigh(mg_context *c, int contact);
static void mg_add(mg_context *c, int contact, mg_real amount, mg_real *per_body);
static void mg_assemble(mg_context *c, const int *list, int n);

/* islands.c */
static int mg_hold(mg_context *c, const int *marked, const mg_real *rate, mg_real *amount);

/* joints.c, ranks.c, reduce.c */
static void mg_open_joints(mg_context *c);
static void mg_joint_rates(mg_context *c, mg_real t);
static int mg_joint_of(const mg_context *c, int row);
static int mg_worst_joint(const mg_context *c, const mg_real *value, mg_real *size);
static int mg_list_joints(const mg_context *c, int *list, int n);
static void mg_watch_joints(mg_context *c);
static int mg_list_bilateral(const mg_context *c, int *list, int n);
static int mg_complement(mg_context *c, int n, const mg_real *value, mg_lcp_report *report);

/* rhs.c */
static void mg_rhs(mg_context *c, mg_real t, const mg_real *x, mg_real *x_dot);
static mg_real mg_separation(const mg_context *c, int contact);

/* lone.c */
static void mg_slope(mg_context *c, mg_real t, const mg_real *x, mg_real *x_dot);

/* place.c */
static int mg_place(mg_context *c, int contact, const mg_real *eta, mg_real *eta_next);
static int mg_settle_in(mg_context *c, int contact, mg_real *eta);
static mg_real mg_margin_of(const mg_context *c);
static int mg_place_all(mg_context *c, mg_real t, mg_real *x);

/* seek.c, closest.c, safeguard.c */
static int mg_unit(mg_real *n);
static int mg_seek(const mg_couple *p, mg_real floor, int keep, mg_view *v);
static void mg_put(const mg_couple *p, const mg_real *eta, mg_real *next, mg_real *placed);
static int mg_is_small(const mg_couple *p, const mg_goal *goal, const mg_real *placed);
static int mg_newton_safely(const mg_couple *p, const mg_goal *goal, mg_real *eta, mg_real *placed);
static int mg_is_minimum(const mg_real *placed);
static int mg_closest_convex(const mg_couple *p, const mg_goal *goal, int warm, mg_real *eta, mg_real *placed);
static int mg_settle_safely(mg_context *c, int contact, mg_real *eta);

/* advance.c */
static int mg_finite(const mg_real *x, int n);

/* rk4.c, dop853.c, step.c */
static void mg_rk4(mg_context *c, mg_real t, const mg_real *x, mg_real h);
static mg_real mg_dop853(mg_context *c, mg_real t, const mg_real *x, mg_real h);
static void mg_dop853_dense(mg_context *c, mg_real t, const mg_real *x, mg_real h);
static void mg_watch(mg_context *c);
static mg_real mg_try_step(mg_context *c, mg_real t, const mg_real *x, mg_real h);
static void mg_finish_step(mg_context *c, mg_real t, mg_real h);
static void mg_make_dense(mg_context *c, mg_real t, const mg_real *x, mg_real h);
static void mg_interpolate(const mg_context *c, const mg_real *x, mg_real theta, mg_real *out);

/* reach.c */
static mg_real mg_reach(const mg_context *c);
static mg_real mg_sight(const mg_context *c);
static void mg_mark_falling(mg_context *c);
static void mg_mark_upright(mg_context *c);
static int mg_dips(mg_context *c, mg_real h);

/* transitions.c: what may befall a contact */
enum { MG_STRIKES, MG_IS_CAUGHT, MG_REBOUNDS, MG_IS_PUSHED_OFF, MG_LIFTS, MG_APPEARS, MG_WALKS_ON, MG_VANISHES,
       MG_ENDS_RUN, MG_RESTS, MG_TURNS_OVER };
static void mg_befalls(mg_context *c, mg_events *events, int contact, int cause, mg_real t, mg_real speed);

/* events.c, modes.c, impact.c, project.c, ledger.c, record.c */
static int mg_fired(mg_context *c, mg_real *x);
static mg_real mg_locate(mg_context *c, mg_real h, int passed);
static mg_real mg_slack(const mg_context *c);
static int mg_approaching(const mg_context *c, int contact);
static mg_real mg_bounces_left(mg_context *c, int contact);
static int mg_impact(mg_context *c, mg_events *events);
static int mg_takes_turns(const mg_context *c);
static int mg_strike_in_turn(mg_context *c, mg_events *events);
static int mg_choose_active(mg_context *c, const int *skip);
static int mg_solve_modes(mg_context *c, mg_events *events);
static int mg_has_room(const mg_context *c);
static int mg_transition(mg_context *c, mg_events *events);
static int mg_unsettled(mg_context *c);
static void mg_refresh(mg_context *c);
static mg_real mg_largest(const mg_context *c, const mg_real *value);
static void mg_turn(mg_real *e, const mg_real *angle);
static int mg_project(mg_context *c);
static int mg_project_start(mg_context *c);
static int mg_start_joints(mg_context *c);
static mg_real mg_energy(mg_context *c, mg_real *kinetic);
static void mg_ledger(mg_context *c);
static void mg_record_until(mg_context *c, mg_record *record, mg_real h);
static void mg_record_now(mg_context *c, mg_record *record);

#include "planar.h"
#include "grips.h"

#endif
