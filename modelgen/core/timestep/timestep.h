/* Time-stepping schemes for velocities and impulses, and their use where events cannot be located.
   May use: events and the rooms below it. */
#ifndef MG_TIMESTEP_H
#define MG_TIMESTEP_H

#include "model/context.h"

/* step_setup.c */

/* Updates poses, rows, gaps and their rates at (t, x), without forces. */
MG_INTERNAL void mg_update_rows_at(mg_context *c, mg_real t, const mg_real *x);

/* Makes the rows those at run->x, and the forces those of the time step that ended there, as it left them. */
MG_INTERNAL void mg_recall_time_step(mg_context *c);

/* Part of the step that follows the positions of the rows. */
MG_INTERNAL mg_real mg_scheme_theta(const mg_context *c);

/* Prepares a step h: leaves in c->bodies.acceleration the accelerations without contacts, in c->step.load_wrench the
   wrenches of the loads, in row 1 of c->step.slopes their power, all in the middle of the step; in c->step.settled the
   positions at which rows are taken; and the rows. Needs the rows of contacts and joints, and their rates, at the state
   of the run. */
MG_INTERNAL void mg_set_step_geometry(mg_context *c, mg_real h);

/* Rate of a row at the start of the step. Joint rows follow their rotation between the rows and the start. */
MG_INTERNAL mg_real mg_start_rate(const mg_context *c, int row, mg_real h);

/* Rate of a row at the end of the step without contact impulses. Joint rows follow their rotation. */
MG_INTERNAL mg_real mg_free_end_rate(const mg_context *c, int row, mg_real h);

/* Bound of the gap rate that a step may cause at a contact at rest. */
MG_INTERNAL mg_real mg_resting_gap_rate_bound(const mg_context *c, int contact, mg_real h);

/* True if the contact approaches so fast that Newton's law applies. */
MG_INTERNAL int mg_is_rebounding(const mg_context *c, int contact, mg_real h);

/* Least gap rate at the end of the step: by Newton's law if the contact rebounds; else Stewart and Trinkle's scheme
   permits the gap to close within the step; the others permit no approach, and keep closed contacts closed while
   their rows turn. */
MG_INTERNAL mg_real mg_scheme_gap_rate(const mg_context *c, int contact, mg_real h);

/* Rate of the row of a spring at the end of the step without impulses, less what its own impulse makes of it without
   that rate. */
MG_INTERNAL mg_real mg_free_spring_rate(const mg_context *c, int row, mg_real h);

/* spring_impulses.c */

/* Adds the accelerations by the springs at the present poses to c->bodies.acceleration, of stiff ones a part, and
   stores their deflections. Needs the twists. */
MG_INTERNAL void mg_predict_springs(mg_context *c, mg_real h);

/* Writes J of the springs. Needs the poses. */
MG_INTERNAL void mg_update_spring_rows(mg_context *c);

/* Scales the rows of the springs for a step h, and writes their rates and impulses at its start. Needs J, the twists at
   the start of the step, and the deflections there. */
MG_INTERNAL void mg_set_spring_impulses(mg_context *c, mg_real h);

/* Work of the impulses of the springs on the bodies that forces move. */
MG_INTERNAL mg_real mg_spring_work(const mg_context *c, mg_real h);

/* impulse_problem.c */

/* Finds the impulses of a step h: leaves them in c->solution.force, and the changes of the twists in
   c->bodies.wrench. Needs the geometry of the step. Returns an outcome. */
MG_INTERNAL int mg_step_impulses(mg_context *c, mg_real h);

/* frictionless_step_lcp.c */

/* Solves the complementarity problem of mg_solve_contact_lcp for the n contacts of c->lcp.rows; guess [per row]:
   amounts near the solution, or 0; with many contacts to a residual of `tolerance`, over the largest value. Returns its
   outcome. */
MG_INTERNAL int mg_solve_step_lcp(mg_context *c, int n, const mg_real *value, const mg_real *guess, mg_real tolerance,
                                  mg_lcp_report *report);

/* step_completion.c */

/* Writes the velocities at the end of the step, and the work of loads and impulses, into run->x. */
MG_INTERNAL void mg_apply_step_impulses(mg_context *c, mg_real h);

/* Writes the positions at the end of the step into run->x: from where the rows were taken, with the velocities at
   the end, or with the mean velocities of the step. Needs the state at its start in c->step.end. */
MG_INTERNAL void mg_integrate_positions(mg_context *c, mg_real h);

/* Converges eta of all contacts at run->x, and marks those that are off their feature pairs; contacts without closest
   points, or whose points are no minimum any more, are released. Needs gaps and poses from which run->x is reached. */
MG_INTERNAL void mg_converge_all_contacts(mg_context *c, mg_events *events);

/* Corrects positions while penetration exceeds contact_gap; the change of the energy counts as that of a correction,
   not as work, which the impulses have done. Needs the poses and gaps at run->x. Returns the number of corrections. */
MG_INTERNAL int mg_post_stabilise(mg_context *c, mg_events *events);

/* step_events.c */

/* Sets modes and appends events. Needs the impulses of the step in c->solution.force. */
MG_INTERNAL void mg_report_step_modes(mg_context *c, mg_events *events, mg_real h);

/* kept_impulses.c */

/* Notes which contacts press, where and with which force. Needs poses. */
MG_INTERNAL void mg_note_pressing_contacts(mg_context *c);

/* Gives the forces of noted contacts that are no longer on their feature pairs to contacts beside them. Needs the rows
   of contacts at the state of the run. */
MG_INTERNAL void mg_hand_on_forces(mg_context *c);

/* time_step.c */

/* Takes one step of h, or shorter where a pair could move past what the next search finds. Returns an outcome. */
MG_INTERNAL int mg_time_step(mg_context *c, mg_real h, mg_record *record, mg_events *events);

/* Computes the forces of the next step if a sample is due at its start. */
MG_INTERNAL void mg_record_next_forces(mg_context *c, const mg_record *record);

/* fallback.c */

/* Length of the next step, s: the given one, that of a fallback, or the integrator's. */
MG_INTERNAL mg_real mg_next_step(const mg_context *c);

/* True for outcomes that a fallback can avoid. */
MG_INTERNAL int mg_is_fallback_outcome(int outcome);

/* True if the last MG_PROGRESS_TRIES tries advanced t by less than fallback_progress * time and a third of them
   was rejected, by a tenth of that and a closed contact has friction, or by a hundredth of that. */
MG_INTERNAL int mg_is_progress_too_slow(mg_context *c);

/* Starts a fallback after an outcome that it can avoid; returns whether it does. A fallback that follows soon on
   another lasts twice as long. */
MG_INTERNAL int mg_start_fallback(mg_context *c, int outcome, mg_events *events);

/* The outcome by which a run ends or falls back: a penetration soon after a fallback from a singular contact is that
   contact's, which is singular still. */
MG_INTERNAL int mg_outcome_after_fallback(const mg_context *c, int outcome);

/* Counts a step of length h of a fallback, whose events are those from first_event on; at the end of the fallback the
   run is event-driven again, unless many events are still to come. Returns an outcome. */
MG_INTERNAL int mg_count_fallback_step(mg_context *c, mg_events *events, int first_event, mg_real h);

/* event_cost.c */

/* Begins to count the work of events. */
MG_INTERNAL void mg_reset_event_work(mg_run *run);

/* How often contacts change their mode in the events from `first` on: close, open, slip or stick, or loads switch. */
MG_INTERNAL int mg_count_transitions(const mg_events *events, int first);

/* Takes what events may cost in the time that has passed off their work. */
MG_INTERNAL void mg_credit_event_work(mg_context *c);

/* Counts the work of an event-driven step in which modes were chosen or steps rejected, and that of the pairs of cells
   looked at in its searches. True if the run is to go on by time-stepping. */
MG_INTERNAL int mg_has_costly_events(mg_context *c, long rejected, long cells);

/* Sets what events may cost after a return from time-stepping that took the place of costly ones. */
MG_INTERNAL void mg_grant_event_work(mg_context *c);

/* True if to locate so many transitions as n steps of time-stepping have shown would cost much more than these. */
MG_INTERNAL int mg_would_chatter(const mg_context *c, long transitions, long n);

#endif
