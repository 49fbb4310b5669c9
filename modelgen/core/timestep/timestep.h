/* Time-stepping schemes for velocities and impulses, and their use where events cannot be located.
   May use: events and the rooms below it. */
#ifndef MG_TIMESTEP_H
#define MG_TIMESTEP_H

#include "model/context.h"

/* velocity_rows.c */

/* Rows, gaps and their rates; no forces. */
MG_INTERNAL void mg_update_rows_at(mg_context *c, mg_real t, const mg_real *x);
MG_INTERNAL mg_real mg_scheme_theta(const mg_context *c);

/* Leaves in c->bodies.acceleration the accelerations without contacts, in K[1] the power of the loads, both of the
   middle of the step, and in c->step.settled the positions at which the rows are taken; makes the rows. */
MG_INTERNAL void mg_set_step_geometry(mg_context *c, mg_real h);

/* The rate of a row at the end of the step without contacts. Rows of joints follow their turning. */
MG_INTERNAL mg_real mg_free_end_rate(const mg_context *c, int row, mg_real h);

/* What a step may make of the rate of a gap that rests. */
MG_INTERNAL mg_real mg_resting_gap_rate_bound(const mg_context *c, int contact, mg_real h);

/* The approach is one that Newton's law sends back. */
MG_INTERNAL int mg_is_rebounding(const mg_context *c, int contact, mg_real h);

/* Newton's law; else Stewart and Trinkle let a gap close within the step, the others stop every approach. */
MG_INTERNAL mg_real mg_scheme_gap_rate(const mg_context *c, int contact, mg_real h);

/* impulse_problem.c */

/* Needs the geometry of the step. Leaves impulses in c->solution.force, the changes of velocity that they make in
 * c->bodies.wrench. */
MG_INTERNAL int mg_step_impulses(mg_context *c, mg_real h);

/* position_update.c */

/* The velocities at the end of the step, into run->x, with the work of loads and impulses. */
MG_INTERNAL void mg_apply_step_impulses(mg_context *c, mg_real h);

/* The positions at the end of the step, from where its rows were taken, with the velocities in run->x; into run->x. */
MG_INTERNAL void mg_integrate_positions(mg_context *c, mg_real h);

/* Puts all contacts on their extrema at run->x; those that have none there are left. Returns how many. */
MG_INTERNAL int mg_converge_all_contacts(mg_context *c, mg_events *events);

/* Post-stabilisation (Anitescu and Hart, Int. J. Numer. Methods Eng. 60 (2004), 2335-2371): positions alone change;
   what that does to the energy is booked as work. Leaves the rows fresh. */
MG_INTERNAL int mg_post_stabilise(mg_context *c, mg_events *events);

/* modes.c */

/* Needs the impulses of the step in c->solution.force, not yet made forces. */
MG_INTERNAL void mg_report_step_modes(mg_context *c, mg_events *events, mg_real h);

/* step.c */

/* One step of h, or of less where a pair could move past what the next search sees. */
MG_INTERNAL int mg_time_step(mg_context *c, mg_real h, mg_record *record, mg_events *events);

/* The forces of the step to come, where a sample is due at its start. */
MG_INTERNAL void mg_record_next_forces(mg_context *c, const mg_record *record);

/* fallback.c */
MG_INTERNAL int mg_is_time_stepping(const mg_context *c);

/* The length of the next step: given, that of a fall, or the integrator's. */
MG_INTERNAL mg_real mg_next_step(const mg_context *c);
MG_INTERNAL int mg_is_fallback_outcome(int outcome);

/* Whether of the last MG_PROGRESS_TRIES steps that were tried a third was refused and the others hardly got on; or, as
   where slip begins or ends too slowly to be told, all hardly move; or, whatever holds them, less still. */
MG_INTERNAL int mg_is_progress_too_slow(mg_context *c);

/* Whether the run goes on by time-stepping after this outcome of an event-driven step; each fall that follows at once
   on another lasts twice as long. */
MG_INTERNAL int mg_start_fallback(mg_context *c, int outcome, mg_events *events);

/* Counts a step of a fall; after the last one events are told again. */
MG_INTERNAL int mg_count_fallback_step(mg_context *c, mg_events *events);

#endif
