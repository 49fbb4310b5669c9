/* The public functions: memory, start, advance, batches, queries. May use: every room but sensitivity. */
#ifndef MG_RUN_H
#define MG_RUN_H

#include "model/context.h"

/* workspace.c */

/* Sets up a context for a call on the caller's memory, with the contacts on the feature pairs of the run. No state
   is evaluated. */
MG_INTERNAL void mg_open_context(mg_context *c, const mg_system *system, const mg_settings *settings, mg_run *run,
                                 mg_real *work, int *iwork);

/* checkpoint.c */

/* Copies the state of a run to at most mg_save_size bytes, and back. */
MG_INTERNAL void mg_store_run(const mg_system *system, const mg_run *run, unsigned char *bytes);
MG_INTERNAL void mg_restore_run(const mg_system *system, mg_run *run, const unsigned char *bytes);

/* step_end_checks.c */

/* Places the contacts at the end of the step h, in c->step.settled. Returns 0 if a closed contact is singular or
   lost there and a shorter step may come nearer. */
MG_INTERNAL int mg_place_step_end(mg_context *c, mg_real h);

/* True if the gap rate of a loaded contact at the end of the step exceeds the error that a step may have: its
   contact point has moved too far, as on a rim that passes flat. Needs the rates at the end. */
MG_INTERNAL int mg_has_contact_point_leapt(const mg_context *c, mg_real h);

/* True if a stage saw an event that is over before it could be located, because of a function of time. */
MG_INTERNAL int mg_has_missed_event(const mg_context *c, mg_real h);

/* Rejects the step; the next is half as long. Returns MG_DONE. */
MG_INTERNAL int mg_reject_step(mg_context *c, mg_real h);

/* advance.c */

/* mg_advance, its steps followed, or 0. */
MG_INTERNAL int mg_advance_followed(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real t_stop,
                                    long max_steps, mg_record *record, mg_events *events, mg_follower *follower,
                                    mg_real *work, int *iwork);

/* input_changes.c */

/* Notes that the inputs of the run have taken effect. */
MG_INTERNAL void mg_accept_inputs(const mg_context *c);

/* True if the caller has changed an input. */
MG_INTERNAL int mg_has_new_inputs(const mg_context *c);

/* Lets inputs that the caller has changed take effect at the run's time. Needs the poses. Returns an outcome. */
MG_INTERNAL int mg_apply_inputs(mg_context *c, mg_events *events);

/* nonfinite_time_functions.c */

/* Largest value of a function of time at t, MG_MAX if one is not finite; loads, bodies and joints are numbered in
   this order. Of loads at the present poses. */
MG_INTERNAL mg_real mg_time_function_magnitude(const mg_context *c, int function, mg_real t);

/* True if a function of time grows towards the time t, on a side of it. */
MG_INTERNAL int mg_has_peak_at(const mg_context *c, int function, mg_real t);

/* True if a function of time grows towards the time t, between step_min^(1/4) T and step_min T away, faster than the
   power -2/3 of the time left. At a jump, a short pulse or a root it does not. */
MG_INTERNAL int mg_has_pole_at(const mg_context *c, int function, mg_real t);

/* Outcome of a run that cannot go on: MG_NOT_FINITE if a function of time is unbounded, or the rows of a contact are
   not finite, else the given one. */
MG_INTERNAL int mg_explain_failed_outcome(mg_context *c, int outcome);

/* infinite_load_crossing.c */

/* Outcome of a step that failed: MG_DONE if a function of time that is infinite but integrable at an instant near the
   present time was the cause, and the run has crossed that instant; else the given one. */
MG_INTERNAL int mg_cross_infinite_load(mg_context *c, int outcome, mg_events *events);

/* batch.c */

/* Takes some of n lanes for one of the threads that share `taken`: fewer as fewer are left. Returns their number, 0 if
   none are left, and in *end the lane after the last. */
MG_INTERNAL int mg_take_lanes(int n, int *taken, int *end);

#endif
