/* What the files of the core share: the scratch of one call and the functions each file offers the others. */
#ifndef MG_CORE_H
#define MG_CORE_H

#include "kinds.h"
#include "modelgen.h"

#define MG_STAGES 17 /* rows of K: 16 of DOP853, one spare for the right-hand side at events */

typedef struct {
  const mg_system *sys;
  const mg_settings *set;
  mg_run *run;
  int n_x, work_index;                      /* length of x; index of the work state */
  mg_real *pose, *twist, *accel, *wrench;   /* per body 12, 6, 6, 6; accel without, then with contact forces */
  mg_real *J, *MJ;                          /* per contact 12: o then f; J and M^-1 J^T */
  mg_real *d, *gamma, *d_dot, *normal;      /* per contact 1, 1, 1, 3 */
  mg_real *force, *rate, *amount, *eta_dot; /* per contact 1, 1, 1; n_eta */
  mg_real *A, *b, *z, *lcp;                 /* complementarity problem and its scratch */
  mg_real *K, *x_next, *x_stage, *settled;  /* stages; states; the end of a step with eta corrected */
  mg_real *dense;                           /* interpolant, 8 rows */
  mg_real *place;                           /* scratch of the place kernel */
  int *list, *mask, *fired, *lcp_i;
  int *falling;                             /* per contact: its open gap shrinks at the start of a step, grows at its end */
  int *column;                              /* per contact: its place in A while assembled, else -1 */
  int *parent, *head, *next, *island;       /* islands: per body, body, contact; closed contacts of one */
  int *first, *incident;                    /* contacts at each moving body: incident[first[b]] .. */
  int driven, moving;                       /* numbers of driven bodies, of bodies that forces move */
  int suspect;                              /* an event function changed sign at a stage */
} mg_context;

/* context.c */
static void mg_open(mg_context *c, const mg_system *sys, const mg_settings *set, mg_run *run, mg_real *work, int *iwork);
static void mg_set_fixed(mg_context *c);

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
static void mg_mark_falling(mg_context *c);
static int mg_dips(mg_context *c, mg_real h);

/* events.c, modes.c, impact.c, project.c, ledger.c, record.c */
static int mg_fired(mg_context *c);
static mg_real mg_locate(mg_context *c, mg_real h, int passed);
static void mg_emit(mg_events *events, mg_real t, int kind, int contact, mg_real speed);
static mg_real mg_slack(const mg_context *c);
static int mg_approaching(const mg_context *c, int contact);
static mg_real mg_bounces_left(mg_context *c, int contact);
static int mg_impact(mg_context *c, mg_events *events);
static int mg_solve_modes(mg_context *c, mg_events *events);
static int mg_has_room(const mg_context *c);
static int mg_transition(mg_context *c, mg_events *events);
static int mg_unsettled(mg_context *c);
static void mg_refresh(mg_context *c);
static int mg_project(mg_context *c);
static int mg_project_start(mg_context *c);
static mg_real mg_energy(mg_context *c, mg_real *kinetic);
static void mg_ledger(mg_context *c);
static void mg_record_until(mg_context *c, mg_record *record, mg_real h);
static void mg_record_now(mg_context *c, mg_record *record);

#endif
