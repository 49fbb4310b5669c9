/* Contacts that change their features: active pair, bifurcations of the closest points, contacts that merge.
   May use: the rooms below (integrate, forces, closest, model, base). */
#ifndef MG_FEATURES_H
#define MG_FEATURES_H

#include "model/context.h"

/* feature_walk.c */
MG_INTERNAL int mg_is_minimum_tracked(mg_context *c, int pair, int contact, const mg_minimum *found);
MG_INTERNAL void mg_release_contact(mg_context *c, mg_events *events, int contact);
MG_INTERNAL int mg_change_marked_features(mg_context *c, mg_events *events);
MG_INTERNAL int mg_find_contact_for_minimum(const mg_context *c, int pair, const mg_minimum *found);
MG_INTERNAL int mg_is_minimum_accepted(const mg_context *c, const mg_minimum *found);
MG_INTERNAL int mg_search_pair_contacts(mg_context *c, mg_events *events, int pair);
MG_INTERNAL mg_real mg_search_step_limit(const mg_context *c);
MG_INTERNAL int mg_search_all_pairs(mg_context *c, mg_events *events, mg_real h);

/* extremum_bifurcation.c */
MG_INTERNAL int mg_release_folded_contacts(mg_context *c, mg_events *events);

/* contact_merging.c */
MG_INTERNAL void mg_search_near_contact_point(mg_context *c, int contact, const mg_real *eta, mg_real margin,
                                              mg_minima *kept);
MG_INTERNAL void mg_merge_contacts(mg_context *c, mg_events *events);
MG_INTERNAL void mg_split_contact(mg_context *c, mg_events *events, int contact);
MG_INTERNAL int mg_replace_singular_contact(mg_context *c, mg_events *events, int contact);

#endif
