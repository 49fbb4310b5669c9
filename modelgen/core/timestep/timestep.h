/* Time-stepping schemes for velocities and impulses, and their use where events cannot be located.
   May use: events and the rooms below it. */
#ifndef MG_TIMESTEP_H
#define MG_TIMESTEP_H

#include "model/context.h"

/* velocity_rows.c */
MG_INTERNAL void mg_update_rows_at(mg_context *c, mg_real t, const mg_real *x);
MG_INTERNAL mg_real mg_scheme_theta(const mg_context *c);
MG_INTERNAL void mg_set_step_geometry(mg_context *c, mg_real h);
MG_INTERNAL mg_real mg_free_end_rate(const mg_context *c, int row, mg_real h);
MG_INTERNAL mg_real mg_resting_gap_rate_bound(const mg_context *c, int contact, mg_real h);
MG_INTERNAL int mg_is_rebounding(const mg_context *c, int contact, mg_real h);
MG_INTERNAL mg_real mg_scheme_gap_rate(const mg_context *c, int contact, mg_real h);

/* impulse_problem.c */
MG_INTERNAL int mg_step_impulses(mg_context *c, mg_real h);

/* position_update.c */
MG_INTERNAL void mg_apply_step_impulses(mg_context *c, mg_real h);
MG_INTERNAL void mg_integrate_positions(mg_context *c, mg_real h);
MG_INTERNAL int mg_converge_all_contacts(mg_context *c, mg_events *events);
MG_INTERNAL int mg_post_stabilise(mg_context *c, mg_events *events);

/* modes.c */
MG_INTERNAL void mg_report_step_modes(mg_context *c, mg_events *events, mg_real h);

/* step.c */
MG_INTERNAL int mg_time_step(mg_context *c, mg_real h, mg_record *record, mg_events *events);
MG_INTERNAL void mg_record_next_forces(mg_context *c, const mg_record *record);

/* fallback.c */
MG_INTERNAL int mg_is_time_stepping(const mg_context *c);
MG_INTERNAL mg_real mg_next_step(const mg_context *c);
MG_INTERNAL int mg_is_fallback_outcome(int outcome);
MG_INTERNAL int mg_is_progress_too_slow(mg_context *c);
MG_INTERNAL int mg_start_fallback(mg_context *c, int outcome, mg_events *events);
MG_INTERNAL int mg_count_fallback_step(mg_context *c, mg_events *events);

#endif
