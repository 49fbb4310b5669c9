/* Time-stepping schemes for velocities and impulses, and their use where events cannot be located.
   May use: events and the rooms below it. */
#ifndef MG_TIMESTEP_H
#define MG_TIMESTEP_H

#include "model/context.h"

/* velocity_rows.c */
MG_INTERNAL void mg_rows_at(mg_context *c, mg_real t, const mg_real *x);
MG_INTERNAL mg_real mg_theta(const mg_context *c);
MG_INTERNAL void mg_take_geometry(mg_context *c, mg_real h);
MG_INTERNAL mg_real mg_free_rate(const mg_context *c, int row, mg_real h);
MG_INTERNAL mg_real mg_slow(const mg_context *c, int contact, mg_real h);
MG_INTERNAL int mg_is_sent_back(const mg_context *c, int contact, mg_real h);
MG_INTERNAL mg_real mg_least_rate(const mg_context *c, int contact, mg_real h);

/* impulse_problem.c */
MG_INTERNAL int mg_step_impulses(mg_context *c, mg_real h);

/* position_update.c */
MG_INTERNAL void mg_book_impulses(mg_context *c, mg_real h);
MG_INTERNAL void mg_drift_on(mg_context *c, mg_real h);
MG_INTERNAL int mg_settle_eta(mg_context *c, mg_events *events);
MG_INTERNAL int mg_push_apart(mg_context *c, mg_events *events);

/* modes.c */
MG_INTERNAL void mg_tell_modes(mg_context *c, mg_events *events, mg_real h);

/* step.c */
MG_INTERNAL int mg_time_step(mg_context *c, mg_real h, mg_record *record, mg_events *events);
MG_INTERNAL void mg_preview(mg_context *c, const mg_record *record);

/* fallback.c */
MG_INTERNAL int mg_steps_in_time(const mg_context *c);
MG_INTERNAL mg_real mg_next_step(const mg_context *c);
MG_INTERNAL int mg_is_closed_to_events(int outcome);
MG_INTERNAL int mg_crawls(mg_context *c);
MG_INTERNAL int mg_falls_back(mg_context *c, int outcome, mg_events *events);
MG_INTERNAL int mg_take_up(mg_context *c, mg_events *events);

#endif
