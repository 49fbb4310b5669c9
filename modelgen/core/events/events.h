/* Events of a step: how far it may go, where an event function is zero, what changes there.
   May use: impact and the rooms below it. */
#ifndef MG_EVENTS_H
#define MG_EVENTS_H

#include "model/context.h"

enum { MG_GAP_MAY_CLOSE = 1, MG_GAP_OSCILLATES = 2 };

/* step_limits.c */
MG_INTERNAL mg_real mg_reach(const mg_context *c);
MG_INTERNAL void mg_note_gaps(mg_context *c);
MG_INTERNAL int mg_mark_dips(mg_context *c, mg_real h);

/* event_location.c */
MG_INTERNAL int mg_leaves(mg_context *c, int contact, mg_real *x);
MG_INTERNAL void mg_mark_upright(mg_context *c);
MG_INTERNAL int mg_fired(mg_context *c, mg_real *x);
MG_INTERNAL int mg_fired_at(mg_context *c, mg_real h, mg_real theta);
MG_INTERNAL mg_real mg_locate(mg_context *c, mg_real h, int passed);

/* interior_minima.c */
MG_INTERNAL int mg_may_strain(mg_context *c);
MG_INTERNAL mg_real mg_first_strain(mg_context *c, mg_real h, int end, int n, mg_real part, mg_real *low);

/* mode_changes.c */
MG_INTERNAL int mg_solve_modes(mg_context *c, mg_events *events);
MG_INTERNAL int mg_unsettled(mg_context *c);
MG_INTERNAL int mg_has_room(const mg_context *c);
MG_INTERNAL void mg_open_far(mg_context *c, mg_events *events);
MG_INTERNAL void mg_open_leaving(mg_context *c);
MG_INTERNAL int mg_change_mode(mg_context *c, mg_events *events);

/* velocity_jump.c */
MG_INTERNAL mg_real mg_at_once(const mg_context *c);
MG_INTERNAL int mg_find_jerk(const mg_context *c, mg_real h, mg_real *before, mg_real *after);
MG_INTERNAL int mg_take_jerk(mg_context *c, mg_real after, mg_events *events);

/* singular_passage.c */
MG_INTERNAL int mg_vault_all(mg_context *c, mg_record *record, mg_events *events);

#endif
