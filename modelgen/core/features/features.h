/* Contacts that change their features: active pair, bifurcations of the closest points, contacts that merge.
   May use: the rooms below (integrate, forces, closest, model, base). */
#ifndef MG_FEATURES_H
#define MG_FEATURES_H

#include "model/context.h"

/* feature_changes.c */

/* True if another contact of the pair is at this minimum, or converges to it. */
MG_INTERNAL int mg_is_minimum_tracked(mg_context *c, int pair, int contact, const mg_minimum *found);

/* True if a contact of an event-driven run is held at the end of a line along which the straight features of the
   feature pair `line` touch: they are so nearly parallel that their own equations are singular, or have closest points
   only beyond the ends. Needs its placement. */
MG_INTERNAL int mg_is_at_end_of_line(mg_context *c, int contact, int line);

/* Take a contact off its feature pair, remember its point for the search, and report that it vanishes. */
MG_INTERNAL void mg_release_contact(mg_context *c, mg_events *events, int contact);

/* Change the feature of all contacts marked to leave theirs, and request a search for those that pass a border;
   returns how many changed. */
MG_INTERNAL int mg_change_marked_features(mg_context *c, mg_events *events);

/* Contact of the pair to use for a minimum: its own, an empty one or the open one farthest away; -1 if there is
   none. */
MG_INTERNAL int mg_find_contact_for_minimum(const mg_context *c, int pair, const mg_minimum *found);

/* True if a minimum found during a run counts: within reach unless it limits the step, not below -depth, not about to
   end. */
MG_INTERNAL int mg_is_minimum_accepted(const mg_context *c, const mg_minimum *found, mg_real depth);

/* Searches the feature pairs of a pair, which has moved since its last search, for new contacts and reports them;
   returns how many were found. Notes penetrations. */
MG_INTERNAL int mg_search_pair_contacts(mg_context *c, mg_events *events, int pair, mg_real moved);

/* True if the step of length h, whose end is in c->step.settled and in the poses, leads to a penetration that no
   contact follows and that is not there at its start: closest points have appeared within the step. */
MG_INTERNAL int mg_has_new_penetration(mg_context *c, mg_real h);

/* Lets contacts follow the closest points that mg_has_new_penetration found to touch at the end of the step of length
   h, so that they take part in an impact there. Returns how many do. */
MG_INTERNAL int mg_follow_touching_minima(mg_context *c, mg_events *events, mg_real h);

/* True if the contact ends at a fold: its minimum has met a saddle. */
MG_INTERNAL int mg_is_contact_at_fold(const mg_context *c, int contact);

/* Requests a search of each pair that has moved since its last one and penetrates where no contact follows. Needs the
   poses at the run's state. Returns their number. */
MG_INTERNAL int mg_request_penetration_searches(mg_context *c);

/* Longest step in s in which no pair moves beyond what its next search finds. */
MG_INTERNAL mg_real mg_search_step_limit(const mg_context *c);

/* After an accepted step of length h, release contacts that end and search the pairs for new ones; returns how
   many changed. is_repeated: 1 where that was done after the same step, and bodies were moved since to correct
   penetration; what is left of it may be as deep as the step was long. */
MG_INTERNAL int mg_search_all_pairs(mg_context *c, mg_events *events, mg_real h, int is_repeated);

/* near_pairs.c */

/* Begins with the near pairs at the poses; all contacts are on no feature pair. */
MG_INTERNAL void mg_begin_near_pairs(mg_context *c);

/* Looks for near pairs anew if the centre of a ball could leave its margin in a step of h: pairs that are far apart are
   left out, and those that come near are listed in c->listed.found and followed. `change` [6 per body]: what impulses
   add to the twists, or 0. If the step is not given, mg_near_pair_step_limit bounds it. Returns 1 if any do. Needs
   poses, twists and accelerations. */
MG_INTERNAL int mg_choose_near_pairs(mg_context *c, mg_real h, const mg_real *change, int is_step_given);

/* Longest step in s in which no centre of a ball leaves its margin, by velocities and accelerations. */
MG_INTERNAL mg_real mg_near_pair_step_limit(const mg_context *c);

/* Makes the next mg_choose_near_pairs look anew. */
MG_INTERNAL void mg_forget_margins(mg_context *c);

/* contact_merge_and_split.c */

/* Search minima too near to eta for a sampled search: Newton's method from both sides, at distances of the order
   of the square root of the margin. */
MG_INTERNAL void mg_search_near_contact_point(mg_context *c, int contact, const mg_real *eta, mg_real margin,
                                              mg_minima *kept);

/* Merge contacts of a pair whose points have become one; the result is closed if one of them is. */
MG_INTERNAL void mg_merge_contacts(mg_context *c, mg_events *events);

/* Add contacts where one point of a pair has become several that all touch, and mark them as just closed. */
MG_INTERNAL void mg_split_contact(mg_context *c, mg_events *events, int contact);

/* Release a singular contact where other points of its pair touch or penetrate; returns 1 if it was released. */
MG_INTERNAL int mg_replace_singular_contact(mg_context *c, mg_events *events, int contact);

#endif
