/* One step of an integrator, its interpolant, samples of a run: RK4, DOP853, and Radau IIA for the start of rolling and
   of slip. May use: base, solve, region, model, closest, forces. */
#ifndef MG_INTEGRATE_H
#define MG_INTEGRATE_H

#include "model/context.h"

/* interpolant.c */

/* State at t + theta h on the interpolant. */
MG_INTERNAL void mg_interpolate(const mg_context *c, const mg_real *x, mg_real theta, mg_real *out);

/* stage_event_signs.c */

/* Sets c->step.sign_changed if an event function is negative at the present right-hand side, so that the step is
   searched for events. */
MG_INTERNAL void mg_watch_event_signs(mg_context *c);

/* rk4.c */

/* Takes a step h from (t, x) to c->step.end. Needs the slope at (t, x) in row 0 of c->step.slopes. */
MG_INTERNAL void mg_rk4(mg_context *c, mg_real t, const mg_real *x, mg_real h);

/* The same to `end`, which may be x, by the composed right-hand side of the scene, in whose mode the run must be;
   slope: that at (t, x), or 0. */
MG_INTERNAL void mg_scene_rk4(mg_context *c, mg_real t, const mg_real *x, mg_real h, const mg_real *slope,
                              mg_real *end);

/* dop853.c */

/* An explicit Runge-Kutta method: stage i adds value[k] * slope[column[k]], row[i] <= k < row[i + 1]; the last row
   gives the end. */
typedef struct {
  int stages;
  const int *row, *column;
  const mg_real *value, *time;
} mg_explicit_method;

/* out = x + h sum of value * slopes for one row, of the states from ranges[2 k] to ranges[2 k + 1]; slopes of stages
   are `stride` apart. */
MG_INTERNAL void mg_combine_ranges(const mg_explicit_method *m, int row, const mg_real *slopes, long stride,
                                   int n_range, const int *ranges, const mg_real *x, mg_real h, mg_real *restrict out);

/* Takes a step h from (t, x) to c->step.end. Needs the slope at (t, x) in row 0 of c->step.slopes. Returns the
   error relative to the tolerance. */
MG_INTERNAL mg_real mg_dop853(mg_context *c, mg_real t, const mg_real *x, mg_real h);

/* Error of a step h from x to `end` with the slopes of its stages, `stride` apart: Hairer's combination of the errors
   of order 5 and 3, root mean square over the states, relative to the tolerance of their sizes, which are at least
   `least` of their scales. */
MG_INTERNAL mg_real mg_dop853_error(const mg_context *c, const mg_real *x, const mg_real *end, const mg_real *slopes,
                                    long stride, mg_real least, mg_real h);

/* Makes the interpolant of the step. Needs the slope at its end in row 12 of c->step.slopes. */
MG_INTERNAL void mg_dop853_dense(mg_context *c, mg_real t, const mg_real *x, mg_real h);

/* radau_collocation.c */

/* State at a stage. */
MG_INTERNAL mg_real *mg_stage_state(const mg_context *c, int stage);

/* Slope at a stage. */
MG_INTERNAL mg_real *mg_stage_slope(const mg_context *c, int stage);

/* Time of a stage in the step, 0..1. */
MG_INTERNAL mg_real mg_stage_time(int stage);

/* Integral of the Lagrange polynomial of stage `column` up to stage `row`. */
MG_INTERNAL mg_real mg_collocation_weight(int row, int column);

/* Weight of an acceleration at stage `column` in the displacement at stage `row`: the product of the collocation
   matrix with itself. */
MG_INTERNAL mg_real mg_double_integral_weight(int row, int column);

/* Derivative by theta at a stage of the polynomial of degree 6 through values at all stages. */
MG_INTERNAL mg_real mg_derivative(const mg_real *value, int stage);

/* Integrates states from .. to - 1 at all stages from their slopes. Returns the largest relative change. */
MG_INTERNAL mg_real mg_integrate_stages(mg_context *c, const mg_real *x, mg_real h, int from, int to);

/* Error by loads that change before the first stage, where no stage sees them: velocity lost there if the loads
   differ as much as, at the start, they differ from the polynomial through them at the stages; root mean square
   relative to the tolerance. */
MG_INTERNAL mg_real mg_rolling_start_load_error(mg_context *c, mg_real t, const mg_real *x, mg_real h);

/* Writes the end of the step and the interpolant, the polynomial through x and the stages. */
MG_INTERNAL void mg_make_collocation_interpolant(mg_context *c, const mg_real *x);

/* Replaces values at the stages by those of the polynomial of degree 6 through them at the stages of a step `share`
   times as long. */
MG_INTERNAL void mg_resample_stages(mg_real *value, mg_real share);

/* Moves stages, azimuths and stiffnesses to the stages of a step `share` times as long, on its interpolant. */
MG_INTERNAL void mg_restrict_stages(mg_context *c, const mg_real *x, mg_real share);

/* Ends the collocated step at a share of it. */
MG_INTERNAL void mg_restrict_step(mg_context *c, const mg_real *x, mg_real share);

/* Replaces b by the solution of A z = b, by Gaussian elimination with row exchanges. Returns 0 if A is singular. */
MG_INTERNAL int mg_gauss_eliminate(mg_real A[MG_RADAU_STAGES][MG_RADAU_STAGES], mg_real *b);

/* Difference of the interpolant at half the step from the end of a step half as long, root mean square relative
   to the tolerance. */
MG_INTERNAL mg_real mg_half_step_difference(mg_context *c, const mg_real *x, const mg_real *half);

/* tilt_kinematics.c */

/* True if the tilt is so small that rounding of the poses hides its direction. */
MG_INTERNAL int mg_is_tilt_lost_in_rounding(const mg_context *c, mg_real tilt);

/* Initialise the tilt state of all contacts that start from flat; returns 0 where neither body is free. */
MG_INTERNAL int mg_initialise_rolling_starts(mg_context *c, mg_real t, mg_real *x, mg_real h);

/* Tilt of a contact and its frame at an azimuth, at the present poses. */
MG_INTERNAL mg_contact_tilt mg_tilt_at_azimuth(const mg_context *c, int contact, mg_real azimuth);

/* Store the rate of the tilt at a stage, from the present poses and velocities. */
MG_INTERNAL void mg_note_tilt_rate(mg_context *c, int contact, int stage);

/* Tilt at a stage of a step h, integrated from its rates because the poses round it away. */
MG_INTERNAL void mg_tilt_of_stage(const mg_context *c, int contact, int stage, mg_real h, mg_real *tilt);

/* Rotate a body of the contact in x so that it tilts by `tilt` along the azimuth of `at`. */
MG_INTERNAL void mg_rotate_to_tilt(const mg_context *c, int contact, const mg_contact_tilt *at, mg_real tilt,
                                   mg_real *x);

/* Deviation of the tilt from `tilt` along the azimuth, relative to it. */
MG_INTERNAL mg_real mg_relative_tilt_error(const mg_contact_tilt *at, mg_real tilt);

/* Change the angular velocity of a body in x so that the azimuth of its tilt has the given rate; the tilt of a
   body that spins about N turns with it. */
MG_INTERNAL void mg_set_azimuth_rate(const mg_context *c, int contact, const mg_contact_tilt *at, mg_real tilt,
                                     mg_real rate, mg_real *x);

/* Angular acceleration of f relative to o about a world direction. */
MG_INTERNAL mg_real mg_relative_angular_acceleration(const mg_context *c, int contact, const mg_real *slope,
                                                     const mg_real *direction);

/* Find the point of f on which it rolls while rounding hides its tilt, by tilting it more; returns 0 where it
   fails. Needs the poses of x; leaves eta there. */
MG_INTERNAL int mg_find_rolling_point(mg_context *c, mg_real t, int contact, const mg_contact_tilt *at, mg_real *x);

/* Bring eta of a contact to the extremum at the present poses, up to rounding; returns 0 if it fails. */
MG_INTERNAL int mg_converge_contact_point(mg_context *c, int contact, mg_real *eta);

/* rim_rolling_start.c */

/* True if a contact starts to roll from flat. */
MG_INTERNAL int mg_has_rolling_start(const mg_context *c);

/* After a step, advance the state of contacts that start from flat: starting, settling, over; limits the next
   step. */
MG_INTERNAL void mg_update_rolling_starts(mg_context *c);

/* Take one collocation step from flat; writes its end and the interpolant. Returns the error relative to the
   tolerance, MG_MAX where there is no solution. */
MG_INTERNAL mg_real mg_take_rolling_start_step(mg_context *c, mg_real t, mg_real *x, mg_real h);

/* stiff_slip_step.c */

/* True if slip starts at a friction bound in the next step. */
MG_INTERNAL int mg_has_slip_onset(const mg_context *c);

/* Continue every slip onset as ordinary slip. */
MG_INTERNAL void mg_finish_slip_onsets(mg_context *c);

/* Mark slow slip that friction turns faster than an explicit step of length h can follow. Needs rows and forces at the
   run's state. */
MG_INTERNAL void mg_mark_stiff_slip(mg_context *c, mg_real h);

/* True if slip is marked as stiff. */
MG_INTERNAL int mg_has_stiff_slip(const mg_context *c);

/* Remove the marks of stiff slip. */
MG_INTERNAL void mg_forget_stiff_slip(mg_context *c);

/* Take one collocation step of stiff slip; removes its marks where several such steps have failed. Returns the error
   relative to the tolerance, MG_MAX where there is no solution. */
MG_INTERNAL mg_real mg_take_stiff_slip_step(mg_context *c, mg_real t, const mg_real *x, mg_real h);

/* Take one collocation step of slip that starts or is stiff; writes its end and the interpolant. Returns the error
   relative to the tolerance, MG_MAX where there is no solution. */
MG_INTERNAL mg_real mg_take_slip_onset_step(mg_context *c, mg_real t, const mg_real *x, mg_real h);

/* step.c */

/* True if steps from this state are by collocation, whatever the method. */
MG_INTERNAL int mg_is_collocated(const mg_context *c);

/* Takes a step h from (t, x) to c->step.end. Needs the slope at (t, x) in row 0 of c->step.slopes. Returns the
   error relative to the tolerance (0 for RK4). */
MG_INTERNAL mg_real mg_take_step(mg_context *c, mg_real t, const mg_real *x, mg_real h);

/* The same, noting in c->step.sign_changed whether an event function changes sign at a stage. */
MG_INTERNAL mg_real mg_try_step(mg_context *c, mg_real t, const mg_real *x, mg_real h);

/* Evaluates slope, forces and gap rates at the end of the step, after normalising quaternions. */
MG_INTERNAL void mg_finish_step(mg_context *c, mg_real t, mg_real h);

/* mg_evaluate_run_state at a state that has just been accepted; where that is the end of the step to the last bit, by
   what mg_finish_step has evaluated there. */
MG_INTERNAL void mg_evaluate_accepted_state(mg_context *c);

/* Makes the cubic Hermite interpolant of the step; a collocated step has an interpolant already. */
MG_INTERNAL void mg_make_cubic_interpolant(mg_context *c, const mg_real *x, mg_real h);

/* Makes the interpolant of the method. */
MG_INTERNAL void mg_make_interpolant(mg_context *c, mg_real t, const mg_real *x, mg_real h);

/* Factor of the next step for an error of order 8 relative to the tolerance, 0.2 .. most. */
MG_INTERNAL mg_real mg_step_growth(mg_real error, mg_real most);

/* Length of the first step, s. */
MG_INTERNAL mg_real mg_first_step(const mg_context *c);

/* sensor_readings.c */

/* Writes the wrench of a joint on its second body, from the forces on its rows, into wrench [6]; NaN of a weld while a
   face rests that reaches over bodies welded to each other, whose parts of its pressure are not told apart. */
MG_INTERNAL void mg_joint_wrench(const mg_context *c, int joint, mg_real *wrench);

/* Writes what the sensors show at time t, with the contact parameters eta and the forces of the contacts, into sensors
   [n_sensor]. `solved`: the forces of the joints are those of this state; else they are shown as NaN. Needs the poses,
   and the rows where sensors show resting faces or joints. */
MG_INTERNAL void mg_read_sensors(mg_context *c, mg_real t, const mg_real *eta, const mg_real *force, int solved,
                                 mg_real *sensors);

/* run_samples.c */

/* Vector in world axes of values on the friction rows of a contact: along t1, t2, or (about) about N, t1, t2. */
MG_INTERNAL void mg_friction_rows_vector(const mg_context *c, int contact, const mg_real *value, int about,
                                         mg_real *out);

/* Appends the sample of the state x. Needs poses, rows and forces at x. */
MG_INTERNAL void mg_record_sample(mg_context *c, mg_record *record, mg_real *x);

/* True if the next sample is due at t or before. */
MG_INTERNAL int mg_is_sample_due(const mg_record *record, mg_real t);

/* Appends the samples within the step h from run->x to c->step.end; not one at its very end if an event is there, after
   which it is taken. */
MG_INTERNAL void mg_record_until(mg_context *c, mg_record *record, mg_real h, int is_event);

/* Appends the samples that are due at run->t. Needs the rows at run->x if there are any; the end of a run may have moved
   run->t by its rounding since. */
MG_INTERNAL void mg_record_now(mg_context *c, mg_record *record);

/* time_function_sampling.c */

/* Number of functions of time, components of loads that depend on the state included. */
MG_INTERNAL int mg_time_function_count(const mg_system *s);

/* Number of loads that depend on the state; `timed`: of those that depend on time as well. */
MG_INTERNAL int mg_state_load_count(const mg_system *s, int timed);

/* Memory of the samples, in mg_real. */
MG_INTERNAL long mg_time_sample_size(const mg_context *c);

/* Halves the step h until its stages resolve the functions of time, but not below time_resolution * time. Needs
   the poses at the run's state. */
MG_INTERNAL mg_real mg_time_function_step_limit(mg_context *c, mg_real h);

/* True if a load that depends on the state rises and falls between the stages of the step just tried. Both
   interpolants are used: the cubic one knows only the ends, the better one may show what the stages have missed.
   Leaves the end of the step as it was. */
MG_INTERNAL int mg_has_unresolved_state_load(mg_context *c, mg_real h);

#endif
