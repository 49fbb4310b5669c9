/* Planar contacts that begin, end, or turn about an edge. May use: features and the rooms below it. */
#ifndef MG_PATCH_H
#define MG_PATCH_H

#include "model/context.h"
#include "region/region.h"

/* covered_contacts.c */

/* Search the feature pairs that a patch covered and open a contact at each minimum found; `flat`: also on feature pairs
   for faces that lie flat. */
MG_INTERNAL void mg_search_covered_feature_pairs(mg_context *c, int patch, int flat, mg_minima *found);

/* Restore the contacts that a patch covered; with friction its faces count as flat still, so that contacts stand
   on points of them. */
MG_INTERNAL void mg_restore_covered_contacts(mg_context *c, int patch, mg_minima *found);

/* Contact, among those that the patch covers, at a world point, or -1. */
MG_INTERNAL int mg_find_contact_at_point(mg_context *c, int patch, const mg_real *world);

/* Close all contacts on feature pairs that the patch covers. */
MG_INTERNAL void mg_close_covered_contacts(mg_context *c, int patch);

/* Mark the contacts on feature pairs that a held patch covers. */
MG_INTERNAL void mg_mark_covered_contacts(mg_context *c);

/* Take the contacts that held patches cover off their feature pairs. */
MG_INTERNAL void mg_release_covered_contacts(mg_context *c);

/* tipping.c */

/* World position of an extreme point of the hull. */
MG_INTERNAL void mg_hull_point_to_world(const mg_real *o, const mg_support_point *at, mg_real *world);

/* True if the boundary that the centre of pressure has reached is curved and has not started to roll. */
MG_INTERNAL int mg_is_tipping_on_curve(mg_context *c, int slot);

/* Tip a patch over a point or a side of its hull: the patch ends and contacts or an edge begin there. */
MG_INTERNAL void mg_tip_patch_at(mg_context *c, int slot, const mg_nearest_boundary *nearest);

/* Tip a patch over the boundary point nearest to its centre of pressure. */
MG_INTERNAL void mg_tip_patch(mg_context *c, int slot);

/* hull_edge_impact.c */

/* Move the supports of a slot to the edge of its curved hull, the first where the face approaches fastest;
   returns 0 where the hull is polygonal, the face already rolls, or the approach is too slow to tilt it. */
MG_INTERNAL int mg_move_patch_to_edge(mg_context *c, int slot);

/* One step of the exchange: free the supports that do not push and put one at the worst violation; returns how
   many moved. */
MG_INTERNAL int mg_exchange_edge_supports(mg_context *c, int n);

/* Append the supports on hull edges to a list of unilateral rows; returns its length. */
MG_INTERNAL int mg_append_edge_supports(const mg_context *c, int *list, int n);

/* Finish the impacts on hull edges: the faces separate, or tip over the edge where they stay. */
MG_INTERNAL void mg_finish_edge_impacts(mg_context *c, mg_events *events);

/* True if the gap closes faster than the drift tolerance; also an approach too slow to bounce is stopped. */
MG_INTERNAL int mg_is_approaching_beyond_drift(const mg_context *c, int contact);

/* Velocity along N of a body's material point at a world point. */
MG_INTERNAL mg_real mg_point_speed_along_normal(const mg_context *c, const mg_real *twists, int body, const mg_real *at,
                                                const mg_real *N);

/* flush_blow.c */

/* Note the first contact that closes although rounding alone decides whether its bodies meet: in the plane of a face of
   each. Needs the rows at the run's state. */
MG_INTERNAL void mg_note_flush_blow(mg_context *c, int contact);

/* patch_begin.c */

/* True if the contact lies in a patch whose faces lie on each other. */
MG_INTERNAL int mg_is_contact_of_flat_patch(mg_context *c, int contact);

/* Hold every free patch that lies flat, on trial; returns their number. */
MG_INTERNAL int mg_hold_flat_patches_on_trial(mg_context *c, mg_real touching, int moving);

/* Release all patches held on trial. */
MG_INTERNAL void mg_release_trial_patches(mg_context *c);

/* Release the trial patches that the amounts on their supports would end; with impulses, move their supports to
   the edge of a curved hull instead. Returns how many were rejected. */
MG_INTERNAL int mg_reject_trial_patches(mg_context *c, const mg_real *amount, mg_real floor, int impulses);

/* Begin the patches that lie flat and that the contact forces press together within their hulls; the contacts
   they cover are released. */
MG_INTERNAL void mg_begin_flat_patches(mg_context *c, mg_events *events, mg_real touching);

/* patch_end.c */

/* End the patches that the impulses would pull apart or press outside their hulls; the contacts they cover are
   struck instead. Returns their number. */
MG_INTERNAL int mg_end_patches_by_impulse(mg_context *c, const mg_real *impulse, mg_real floor);

/* Replace patches with friction by single contacts where another contact is struck; returns their number. */
MG_INTERNAL int mg_replace_struck_patches(mg_context *c);

/* End the patches whose events are marked, and report them; returns their number. */
MG_INTERNAL int mg_end_patches(mg_context *c, mg_events *events);

/* edge_pivot.c */

/* Hold the tangent of a smooth rim at a world point, the imaginary edge of section 5.3. */
MG_INTERNAL void mg_hold_tangent_edge(mg_context *c, int slot, const mg_real *world, const mg_real *outward);

/* Hold a straight side of the hull. */
MG_INTERNAL void mg_hold_hull_side(mg_context *c, int slot, mg_real ends[2][3], const mg_real *outward);

/* End the held edge: the contacts at its ends, or at its middle, take over. */
MG_INTERNAL void mg_end_edge_pivot(mg_context *c, int slot, mg_events *events);

#endif
