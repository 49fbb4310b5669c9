/* Planar contacts that begin, end, or turn about an edge. May use: features and the rooms below it. */
#ifndef MG_PATCH_H
#define MG_PATCH_H

#include "model/context.h"
#include "region/region.h"

/* face_edge_impact.c */
MG_INTERNAL int mg_go_to_edge(mg_context *c, int slot);
MG_INTERNAL int mg_exchange(mg_context *c, int n);
MG_INTERNAL int mg_list_edged(const mg_context *c, int *list, int n);
MG_INTERNAL void mg_leave_edges(mg_context *c, mg_events *events);
MG_INTERNAL int mg_nearing(const mg_context *c, int contact);

/* patch_begin.c */
MG_INTERNAL mg_real mg_speed_along(const mg_context *c, const mg_real *twists, int body, const mg_real *at,
                                   const mg_real *N);
MG_INTERNAL int mg_is_flat_on(mg_context *c, int contact);
MG_INTERNAL void mg_hide_covered(mg_context *c);
MG_INTERNAL int mg_try_flat(mg_context *c, mg_real touching, int moving);
MG_INTERNAL void mg_drop_tried(mg_context *c);
MG_INTERNAL int mg_reject(mg_context *c, const mg_real *amount, mg_real floor, int impulses);
MG_INTERNAL void mg_give_way(mg_context *c);
MG_INTERNAL void mg_rest_patches(mg_context *c, mg_events *events, mg_real touching);

/* patch_end.c */
MG_INTERNAL void mg_uncover(mg_context *c, int patch, mg_minima *found);
MG_INTERNAL int mg_contact_at(mg_context *c, int patch, const mg_real *world);
MG_INTERNAL void mg_close(mg_context *c, int contact);
MG_INTERNAL void mg_at_brink(const mg_real *o, const mg_support_point *at, mg_real *world);
MG_INTERNAL int mg_turns_on_curve(mg_context *c, int slot);
MG_INTERNAL void mg_turn_at(mg_context *c, int slot, const mg_nearest_boundary *brink);
MG_INTERNAL void mg_turn_over(mg_context *c, int slot);
MG_INTERNAL int mg_tear_off(mg_context *c, const mg_real *impulse, mg_real floor);
MG_INTERNAL int mg_stand_on_points(mg_context *c);
MG_INTERNAL int mg_end_patches(mg_context *c, mg_events *events);

/* edge_pivot.c */
MG_INTERNAL void mg_hold_tangent(mg_context *c, int slot, const mg_real *world, const mg_real *outward);
MG_INTERNAL void mg_hold_side(mg_context *c, int slot, mg_real ends[2][3], const mg_real *outward);
MG_INTERNAL void mg_leave_edge(mg_context *c, int slot, mg_events *events);

#endif
