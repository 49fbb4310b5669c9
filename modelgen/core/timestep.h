/* What the files of time-stepping share. */
#ifndef MG_TIMESTEP_H
#define MG_TIMESTEP_H

/* timestep_rows.c: the rows of a step and what its velocities would be without contacts */
static mg_real mg_theta(const mg_context *c);
static void mg_rows_at(mg_context *c, mg_real t, const mg_real *x);
static void mg_take_geometry(mg_context *c, mg_real h);
static mg_real mg_free_rate(const mg_context *c, int row, mg_real h);
static mg_real mg_slow(const mg_context *c, int contact, mg_real h);
static int mg_is_sent_back(const mg_context *c, int contact, mg_real h);
static mg_real mg_least_rate(const mg_context *c, int contact, mg_real h);

/* timestep_solve.c: the impulses of a step */
static int mg_step_impulses(mg_context *c, mg_real h);

/* timestep_move.c: what they do */
static void mg_book_impulses(mg_context *c, mg_real h);
static void mg_drift_on(mg_context *c, mg_real h);
static int mg_settle_eta(mg_context *c, mg_events *events);
static int mg_push_apart(mg_context *c, mg_events *events);

/* timestep_modes.c: what is told of them */
static void mg_tell_modes(mg_context *c, mg_events *events, mg_real h);

/* timestep.c, timestep_fallback.c */
static int mg_time_step(mg_context *c, mg_real h, mg_record *record, mg_events *events);
static void mg_preview(mg_context *c, const mg_record *record);
static int mg_steps_in_time(const mg_context *c);
static mg_real mg_next_step(const mg_context *c);
static int mg_crawls(mg_context *c);
static int mg_falls_back(mg_context *c, int outcome, mg_events *events);
static int mg_take_up(mg_context *c, mg_events *events);

/* what they take from begin.c, project.c, walk.c */
static void mg_leave(mg_context *c, mg_events *events, int contact);
static void mg_open_leaving(mg_context *c);
static void mg_move(mg_context *c);

#endif
