/* Planar contacts that begin, end, or turn about an edge. May use: features and the rooms below it. */
#ifndef MG_PATCH_H
#define MG_PATCH_H

#include "model/context.h"
#include "region/region.h"

/* face_edge_impact.c */
MG_INTERNAL int mg_move_patch_to_edge(mg_context *c, int slot);
MG_INTERNAL int mg_exchange_edge_supports(mg_context *c, int n);
MG_INTERNAL int mg_append_edge_supports(const mg_context *c, int *list, int n);
MG_INTERNAL void mg_finish_edge_impacts(mg_context *c, mg_events *events);
MG_INTERNAL int mg_is_approaching_beyond_drift(const mg_context *c, int contact);

/* patch_begin.c */
MG_INTERNAL mg_real mg_point_speed_along_normal(const mg_context *c, const mg_real *twists, int body, const mg_real *at,
                                                const mg_real *N);
MG_INTERNAL int mg_is_contact_of_flat_patch(mg_context *c, int contact);
MG_INTERNAL void mg_mark_covered_contacts(mg_context *c);
MG_INTERNAL int mg_hold_flat_patches_on_trial(mg_context *c, mg_real touching, int moving);
MG_INTERNAL void mg_release_trial_patches(mg_context *c);
MG_INTERNAL int mg_reject_trial_patches(mg_context *c, const mg_real *amount, mg_real floor, int impulses);
MG_INTERNAL void mg_release_covered_contacts(mg_context *c);
MG_INTERNAL void mg_begin_flat_patches(mg_context *c, mg_events *events, mg_real touching);

/* patch_end.c */
MG_INTERNAL void mg_restore_covered_contacts(mg_context *c, int patch, mg_minima *found);
MG_INTERNAL int mg_find_contact_at_point(mg_context *c, int patch, const mg_real *world);
MG_INTERNAL void mg_close_contact(mg_context *c, int contact);
MG_INTERNAL void mg_hull_point_to_world(const mg_real *o, const mg_support_point *at, mg_real *world);
MG_INTERNAL int mg_is_tipping_on_curve(mg_context *c, int slot);
MG_INTERNAL void mg_tip_patch_at(mg_context *c, int slot, const mg_nearest_boundary *nearest);
MG_INTERNAL void mg_tip_patch(mg_context *c, int slot);
MG_INTERNAL int mg_end_patches_by_impulse(mg_context *c, const mg_real *impulse, mg_real floor);
MG_INTERNAL int mg_replace_struck_patches(mg_context *c);
MG_INTERNAL int mg_end_patches(mg_context *c, mg_events *events);

/* edge_pivot.c */
MG_INTERNAL void mg_hold_tangent_edge(mg_context *c, int slot, const mg_real *world, const mg_real *outward);
MG_INTERNAL void mg_hold_hull_side(mg_context *c, int slot, mg_real ends[2][3], const mg_real *outward);
MG_INTERNAL void mg_end_edge_pivot(mg_context *c, int slot, mg_events *events);

#endif
