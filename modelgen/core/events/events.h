/* Events of a step: how far it may go, where an event function is zero, what changes there.
   May use: impact and the rooms below it. */
#ifndef MG_EVENTS_H
#define MG_EVENTS_H

#include "model/context.h"

/* Marks in c->events.gap_dips. */
enum {
  MG_GAP_MAY_CLOSE = 1, /* the gap has a minimum inside the step that may be negative */
  MG_GAP_OSCILLATES = 2 /* the gap has more than one extremum inside the step */
};

/* gap_minima.c */

/* Longest step in s after which no open gap, at its present acceleration, is deeper than the characteristic
   length. */
MG_INTERNAL mg_real mg_penetration_step_limit(const mg_context *c);

/* Store gaps and gap velocities at the start of a part of the step. */
MG_INTERNAL void mg_store_gaps(mg_context *c);

/* Mark the gaps that may have closed within the last h; returns the larger of their classes. */
MG_INTERNAL int mg_mark_gap_minima(mg_context *c, mg_real h);

/* triggered_events.c */

/* True if the contact is closed but carries no force. */
MG_INTERNAL int mg_is_closed_without_force(const mg_context *c, int contact);

/* True if there are conditions that may take the contact off its feature pair. */
MG_INTERNAL int mg_may_leave_feature_pair(const mg_context *c, int contact);

/* True if the contact is off its feature pair at eta; c->events.broken_condition says where. Needs mg_place_contact
   there. */
MG_INTERNAL int mg_is_off_feature_pair(mg_context *c, int contact, const mg_real *eta);

/* Mark the closed or nearly closed contacts that are within their watched borders; a contact beyond one has its
   pair searched. Needs the poses at the run's state. */
MG_INTERNAL void mg_mark_contacts_within_border(mg_context *c);

/* Mark all events that have triggered at the state x: feature pair exits, closing gaps, tensile forces, unforced gaps
   that accelerate, patches, friction; returns their number. Needs the right-hand side and gap velocities at x. */
MG_INTERNAL int mg_mark_triggered_events(mg_context *c, mg_real *x);

/* Evaluate the interpolant at theta and mark the events that have triggered there; returns their number. */
MG_INTERNAL int mg_mark_triggered_events_at(mg_context *c, mg_real h, mg_real theta);

/* event_location.c */

/* Shares *low and *high of the step h just tried between which the first event in it is; returns 0 if there is none.
   `passed`: one was seen at a stage or at the end, or a gap may turn more than once. Needs the interpolant and the
   marked gap minima. */
MG_INTERNAL int mg_bracket_first_event(mg_context *c, mg_real h, int passed, mg_real *low, mg_real *high);

/* Share of the step at which the event in that bracket has not triggered yet, at least half of that at which it has
   and step_fraction of it at most; 0 if there is none within the resolution of time. */
MG_INTERNAL mg_real mg_share_before_event(mg_context *c, mg_real h, mg_real low, mg_real high);

/* Locate the event in that bracket; returns the step to it with its end state and its marks, 0 if there is none. */
MG_INTERNAL mg_real mg_locate_bracketed_event(mg_context *c, mg_real h, mg_real low, mg_real high);

/* hidden_events.c */

/* True if an event margin may be below zero between the samples of the step. Needs the right-hand side and the
   gap velocities at its end. */
MG_INTERNAL int mg_has_possible_hidden_event(mg_context *c);

/* First hidden event of all event margins within one part of the step, as a share of the step; 0 where there is
   none. */
MG_INTERNAL mg_real mg_first_hidden_event(mg_context *c, mg_real h, int end, int n, mg_real part, mg_real *low);

/* contact_modes.c */

/* Choose which closed contacts carry force and which friction sticks, open the contacts that separate and report
   the events. Contacts whose event has triggered are tried open first. */
MG_INTERNAL int mg_solve_contact_modes(mg_context *c, mg_events *events);

/* True if a closed contact without force has a gap acceleration beyond the tolerance, so that the active set must
   be chosen again. Needs rows and forces at the run's state. */
MG_INTERNAL int mg_is_active_set_outdated(mg_context *c);

/* load_branch_changes.c */

/* Put the loads on their branches at the run's state and report those that change, unless the list is null; returns how
   many do. Leaves the right-hand side there. Sets c->switches.is_unresolved where no branches are found. */
MG_INTERNAL int mg_settle_load_branches(mg_context *c, mg_events *events);

/* event_processing.c */

/* False if more contacts are closed than the caller gave memory for. */
MG_INTERNAL int mg_has_closed_contact_capacity(const mg_context *c);

/* Open the closed contacts whose gap, after a change of feature, is wider than start_gap or widens faster than
   rest_speed. */
MG_INTERNAL void mg_open_separated_contacts(mg_context *c, mg_events *events);

/* Contacts at zero gap that already separate are open. */
MG_INTERNAL void mg_open_separating(mg_context *c);

/* What an event left on the contacts that stay closed, too slow to open them, is removed at once. A contact that
   appeared below zero is lifted; what that does to the energy is booked as work. */
MG_INTERNAL int mg_change_mode(mg_context *c, mg_events *events);

/* driven_velocity_jump.c */

/* Time in s that counts as one instant of a velocity jump. */
MG_INTERNAL mg_real mg_velocity_jump_duration(const mg_context *c);

/* Find the first velocity jump of all driven bodies within a step h. */
MG_INTERNAL int mg_find_velocity_jump(const mg_context *c, mg_real h, mg_real *before, mg_real *after);

/* Advance the run over a velocity jump and choose the contact modes after it. */
MG_INTERNAL int mg_cross_velocity_jump(mg_context *c, mg_real after, mg_events *events);

/* Strike or release the contacts with bodies whose prescribed velocity has jumped at the run's time, and choose the
   contact modes. Returns an outcome. */
MG_INTERNAL int mg_settle_velocity_jump(mg_context *c, mg_events *events);

/* singular_passage_step.c */

/* Cross the singular places of closed contacts, then merge or split contacts and choose the modes; returns
   MG_DONE or the outcome that ends the run. */
MG_INTERNAL int mg_cross_singular_contacts(mg_context *c, mg_record *record, mg_events *events);

#endif
