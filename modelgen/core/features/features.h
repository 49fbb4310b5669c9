/* Contacts that change their features: active pair, bifurcations of the closest points, contacts that merge.
   May use: the rooms below (integrate, forces, closest, model, base). */
#ifndef MG_FEATURES_H
#define MG_FEATURES_H

#include "model/context.h"

/* feature_walk.c */
MG_INTERNAL int mg_is_already_contact(mg_context *c, int pair, int contact, const mg_minimum *found);
MG_INTERNAL void mg_leave_link(mg_context *c, mg_events *events, int contact);
MG_INTERNAL int mg_change_features(mg_context *c, mg_events *events);
MG_INTERNAL int mg_free_contact_for(const mg_context *c, int pair, const mg_minimum *found);
MG_INTERNAL int mg_is_within_search(const mg_context *c, const mg_minimum *found);
MG_INTERNAL int mg_search_pair(mg_context *c, mg_events *events, int pair);
MG_INTERNAL mg_real mg_search_step_limit(const mg_context *c);
MG_INTERNAL int mg_search_moved_pairs(mg_context *c, mg_events *events, mg_real h);

/* extremum_bifurcation.c */
MG_INTERNAL int mg_leave_bifurcations(mg_context *c, mg_events *events);

/* contact_merging.c */
MG_INTERNAL void mg_search_near_bifurcation(mg_context *c, int contact, const mg_real *eta, mg_real margin,
                                            mg_minima *kept);
MG_INTERNAL void mg_merge_contacts(mg_context *c, mg_events *events);
MG_INTERNAL void mg_split_contact(mg_context *c, mg_events *events, int contact);
MG_INTERNAL int mg_is_replaced_by_others(mg_context *c, mg_events *events, int contact);

#endif
