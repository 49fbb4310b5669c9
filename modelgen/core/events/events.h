/* Events of a step: how far it may go, where an event function is zero, what changes there.
   May use: impact and the rooms below it. */
#ifndef MG_EVENTS_H
#define MG_EVENTS_H

#include "model/context.h"

enum { MG_GAP_MAY_CLOSE = 1, MG_GAP_OSCILLATES = 2 };

/* step_limits.c */
MG_INTERNAL mg_real mg_penetration_step_limit(const mg_context *c);
MG_INTERNAL void mg_store_gaps(mg_context *c);
MG_INTERNAL int mg_mark_gap_minima(mg_context *c, mg_real h);

/* event_location.c */
MG_INTERNAL int mg_find_feature_pair_exit(mg_context *c, int contact, mg_real *x);
MG_INTERNAL void mg_mark_contacts_within_border(mg_context *c);
MG_INTERNAL int mg_mark_triggered_events(mg_context *c, mg_real *x);
MG_INTERNAL int mg_mark_triggered_events_at(mg_context *c, mg_real h, mg_real theta);
MG_INTERNAL mg_real mg_locate_first_event(mg_context *c, mg_real h, int passed);

/* interior_minima.c */
MG_INTERNAL int mg_has_possible_hidden_event(mg_context *c);
MG_INTERNAL mg_real mg_first_hidden_event(mg_context *c, mg_real h, int end, int n, mg_real part, mg_real *low);

/* mode_changes.c */
MG_INTERNAL int mg_solve_contact_modes(mg_context *c, mg_events *events);
MG_INTERNAL int mg_is_active_set_outdated(mg_context *c);
MG_INTERNAL int mg_has_closed_contact_capacity(const mg_context *c);
MG_INTERNAL void mg_open_separated_contacts(mg_context *c, mg_events *events);
MG_INTERNAL void mg_open_separating(mg_context *c);
MG_INTERNAL int mg_change_mode(mg_context *c, mg_events *events);

/* velocity_jump.c */
MG_INTERNAL mg_real mg_velocity_jump_duration(const mg_context *c);
MG_INTERNAL int mg_find_velocity_jump(const mg_context *c, mg_real h, mg_real *before, mg_real *after);
MG_INTERNAL int mg_cross_velocity_jump(mg_context *c, mg_real after, mg_events *events);

/* singular_passage.c */
MG_INTERNAL int mg_cross_singular_contacts(mg_context *c, mg_record *record, mg_events *events);

#endif
