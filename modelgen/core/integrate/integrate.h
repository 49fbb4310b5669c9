/* One step of an integrator, its interpolant and samples: RK4, DOP853, Radau IIA for starts of rolling and slip.
   May use: base, solve, model, closest, forces. */
#ifndef MG_INTEGRATE_H
#define MG_INTEGRATE_H

#include "model/context.h"

/* rk4.c */
MG_INTERNAL void mg_rk4(mg_context *c, mg_real t, const mg_real *x, mg_real h);

/* dop853.c */
MG_INTERNAL mg_real mg_dop853(mg_context *c, mg_real t, const mg_real *x, mg_real h);
MG_INTERNAL void mg_dop853_dense(mg_context *c, mg_real t, const mg_real *x, mg_real h);

/* radau_collocation.c */
MG_INTERNAL mg_real *mg_stage_state(const mg_context *c, int stage);
MG_INTERNAL mg_real *mg_stage_slope(const mg_context *c, int stage);
MG_INTERNAL mg_real mg_stage_time(int stage);
MG_INTERNAL mg_real mg_collocation_weight(int row, int column);
MG_INTERNAL mg_real mg_double_integral_weight(int row, int column);
MG_INTERNAL mg_real mg_derivative(const mg_real *value, int stage);
MG_INTERNAL mg_real mg_integrate_stages(mg_context *c, const mg_real *x, mg_real h, int from, int to);
MG_INTERNAL mg_real mg_rolling_start_load_error(mg_context *c, mg_real t, const mg_real *x, mg_real h);
MG_INTERNAL void mg_make_collocation_interpolant(mg_context *c, const mg_real *x);
MG_INTERNAL void mg_restrict_stages(mg_context *c, const mg_real *x, mg_real share);
MG_INTERNAL void mg_restrict_step(mg_context *c, const mg_real *x, mg_real share);
MG_INTERNAL int mg_gauss_eliminate(mg_real A[MG_RADAU_STAGES][MG_RADAU_STAGES], mg_real *b);

/* tilt_kinematics.c */
MG_INTERNAL int mg_is_tilt_lost_in_rounding(const mg_context *c, mg_real tilt);
MG_INTERNAL int mg_initialise_rolling_starts(mg_context *c, mg_real t, mg_real *x, mg_real h);
MG_INTERNAL mg_contact_tilt mg_tilt_at_azimuth(const mg_context *c, int contact, mg_real azimuth);
MG_INTERNAL void mg_note_tilt_rate(mg_context *c, int contact, int stage);
MG_INTERNAL void mg_tilt_of_stage(const mg_context *c, int contact, int stage, mg_real h, mg_real *lean);
MG_INTERNAL void mg_rotate_to_tilt(const mg_context *c, int contact, const mg_contact_tilt *at, mg_real tilt,
                                   mg_real *x);
MG_INTERNAL mg_real mg_relative_tilt_error(const mg_contact_tilt *at, mg_real tilt);
MG_INTERNAL void mg_set_azimuth_rate(const mg_context *c, int contact, const mg_contact_tilt *at, mg_real tilt,
                                     mg_real rate, mg_real *x);
MG_INTERNAL mg_real mg_relative_angular_acceleration(const mg_context *c, int contact, const mg_real *slope,
                                                     const mg_real *direction);
MG_INTERNAL int mg_find_rolling_point(mg_context *c, mg_real t, int contact, const mg_contact_tilt *at, mg_real *x);

/* rolling_start.c */
MG_INTERNAL int mg_has_rolling_start(const mg_context *c);
MG_INTERNAL int mg_converge_contact_point(mg_context *c, int contact, mg_real *eta);
MG_INTERNAL void mg_update_rolling_starts(mg_context *c);
MG_INTERNAL mg_real mg_half_step_difference(mg_context *c, const mg_real *x, const mg_real *half);
MG_INTERNAL mg_real mg_take_rolling_start_step(mg_context *c, mg_real t, mg_real *x, mg_real h);

/* slip_start.c */
MG_INTERNAL int mg_has_slip_onset(const mg_context *c);
MG_INTERNAL void mg_finish_slip_onsets(mg_context *c);
MG_INTERNAL mg_real mg_take_slip_onset_step(mg_context *c, mg_real t, const mg_real *x, mg_real h);

/* step.c */
MG_INTERNAL int mg_is_collocated(const mg_context *c);
MG_INTERNAL mg_real mg_take_step(mg_context *c, mg_real t, const mg_real *x, mg_real h);
MG_INTERNAL mg_real mg_try_step(mg_context *c, mg_real t, const mg_real *x, mg_real h);
MG_INTERNAL void mg_finish_step(mg_context *c, mg_real t, mg_real h);
MG_INTERNAL void mg_make_cubic_interpolant(mg_context *c, const mg_real *x, mg_real h);
MG_INTERNAL void mg_make_interpolant(mg_context *c, mg_real t, const mg_real *x, mg_real h);
MG_INTERNAL void mg_interpolate(const mg_context *c, const mg_real *x, mg_real theta, mg_real *out);
MG_INTERNAL void mg_watch_event_signs(mg_context *c);
MG_INTERNAL mg_real mg_step_growth(mg_real error, mg_real most);
MG_INTERNAL mg_real mg_first_step(const mg_context *c);

/* samples.c */
MG_INTERNAL void mg_record_sample(mg_context *c, mg_record *record, mg_real *x);
MG_INTERNAL int mg_is_sample_due(const mg_record *record, mg_real t);
MG_INTERNAL void mg_record_until(mg_context *c, mg_record *record, mg_real h);
MG_INTERNAL void mg_record_now(mg_context *c, mg_record *record);

/* time_dependence.c */
MG_INTERNAL int mg_time_function_count(const mg_system *s);
MG_INTERNAL int mg_state_load_count(const mg_system *s, int timed);
MG_INTERNAL long mg_time_sample_size(const mg_system *s);
MG_INTERNAL mg_real mg_time_function_step_limit(mg_context *c, mg_real h);
MG_INTERNAL int mg_has_unresolved_state_load(mg_context *c, mg_real h);

#endif
