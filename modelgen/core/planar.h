/* What the files on faces that rest on each other, and on rims that begin to roll, offer the others. */
#ifndef MG_PLANAR_H
#define MG_PLANAR_H

#include "core.h"

/* patches.c, pressure.c, rest.c, handover.c */
MG_INTERNAL int mg_is_pad(const mg_context *c, int contact);
MG_INTERNAL int mg_pad_of(const mg_context *c, int slot);
MG_INTERNAL int mg_patch_in(const mg_context *c, int slot);
MG_INTERNAL int mg_patch_body(const mg_context *c, int patch, int side);
MG_INTERNAL int mg_is_covered(const mg_context *c, int link);
MG_INTERNAL int mg_patch_flat_on(const mg_context *c, int contact, mg_real lean);
MG_INTERNAL int mg_is_flat_on(mg_context *c, int contact);
MG_INTERNAL int mg_is_flat_yet(const mg_context *c, int contact);
MG_INTERNAL int mg_is_flat_far(const mg_context *c, int contact);
MG_INTERNAL void mg_hull_pose(const mg_context *c, int patch, mg_real *out);
MG_INTERNAL int mg_is_for_flat(const mg_context *c, int link);
MG_INTERNAL int mg_pair_unfolds(const mg_context *c, int pair);
MG_INTERNAL mg_real mg_unfolding(const mg_context *c);
MG_INTERNAL int mg_has_unfolded(const mg_context *c, int contact);
MG_INTERNAL int mg_is_for_leaning(const mg_context *c, int link);
MG_INTERNAL int mg_patch_starts(const mg_context *c, int patch);
MG_INTERNAL int mg_patch_concerns(const mg_context *c, int patch, int pair);
MG_INTERNAL void mg_search_around(mg_context *c, int patch);
MG_INTERNAL const mg_real *mg_point_of_link(const mg_context *c, int link);
MG_INTERNAL int mg_pair_rests(const mg_context *c, int pair);
MG_INTERNAL void mg_face_pose(const mg_context *c, int patch, int side, mg_real *out);
MG_INTERNAL void mg_into(const mg_real *pose, const mg_real *world, mg_real *local);
MG_INTERNAL mg_real mg_resultant(const mg_context *c, int slot, const mg_real *amount, mg_real *centre);
MG_INTERNAL int mg_most_arcs(const mg_system *s);
MG_INTERNAL mg_real mg_patch_margin(mg_context *c, int patch, const mg_real *world, mg_brink *brink);
MG_INTERNAL int mg_patches_fired(mg_context *c);
MG_INTERNAL mg_strain *mg_strain_of_slot(const mg_context *c, int slot);
MG_INTERNAL int mg_slot_ends(mg_context *c, int slot);
MG_INTERNAL int mg_any_patch_ends(mg_context *c);
MG_INTERNAL mg_real mg_patch_value(mg_context *c, int pad, int cause);
MG_INTERNAL void mg_drop_patch(mg_context *c, int slot);
MG_INTERNAL void mg_hide_covered(mg_context *c);
MG_INTERNAL int mg_try_flat(mg_context *c, mg_real touching, int moving);
MG_INTERNAL int mg_ends_with(mg_context *c, int slot, const mg_real *amount, mg_real floor, mg_real *margin);
MG_INTERNAL void mg_drop_tried(mg_context *c);
MG_INTERNAL int mg_reject(mg_context *c, const mg_real *amount, mg_real floor, int impulses);
MG_INTERNAL int mg_stand_on_points(mg_context *c);
MG_INTERNAL int mg_patch_covers(const mg_context *c, int patch, int link);
MG_INTERNAL int mg_tear_off(mg_context *c, const mg_real *impulse, mg_real floor);
MG_INTERNAL void mg_rest_patches(mg_context *c, mg_events *events, mg_real touching);
MG_INTERNAL void mg_uncover(mg_context *c, int patch, mg_founds *found);
MG_INTERNAL int mg_end_patches(mg_context *c, mg_events *events);
MG_INTERNAL void mg_turn_over(mg_context *c, int slot);
MG_INTERNAL void mg_at_brink(const mg_real *o, const mg_support *at, mg_real *world);
MG_INTERNAL void mg_turn_at(mg_context *c, int slot, const mg_brink *brink);
MG_INTERNAL void mg_give_way(mg_context *c);
MG_INTERNAL mg_real mg_speed_along(const mg_context *c, const mg_real *twists, int body, const mg_real *at, const mg_real *N);
MG_INTERNAL int mg_turns_on_curve(mg_context *c, int slot);
MG_INTERNAL int mg_pivots(const mg_context *c, int slot);
MG_INTERNAL mg_real mg_lean_of(const mg_context *c, int slot);
MG_INTERNAL int mg_edge_ends(const mg_context *c, int slot, const mg_real *amount, mg_real floor);
MG_INTERNAL mg_real mg_edge_value(const mg_context *c, int slot, int cause);
MG_INTERNAL void mg_hold_tangent(mg_context *c, int slot, const mg_real *world, const mg_real *outward);
MG_INTERNAL void mg_hold_side(mg_context *c, int slot, mg_real ends[2][3], const mg_real *outward);
MG_INTERNAL void mg_leave_edge(mg_context *c, int slot, mg_events *events);
MG_INTERNAL int mg_contact_at(mg_context *c, int patch, const mg_real *world);
MG_INTERNAL void mg_close(mg_context *c, int contact);
MG_INTERNAL void mg_pad_point(const mg_context *c, int pad, mg_real *world);
MG_INTERNAL int mg_slot_of(const mg_context *c, int patch);
MG_INTERNAL int mg_free_slot(const mg_context *c, int patch);
MG_INTERNAL void mg_hold_patch(mg_context *c, int slot, int patch);
MG_INTERNAL int mg_lay_patch(mg_context *c, int patch);
MG_INTERNAL mg_real mg_weight_scale(const mg_context *c);

/* edge_blow.c */
MG_INTERNAL int mg_is_edged(const mg_context *c, int contact);
MG_INTERNAL int mg_go_to_edge(mg_context *c, int slot);
MG_INTERNAL int mg_list_edged(const mg_context *c, int *list, int n);
MG_INTERNAL int mg_exchange(mg_context *c, int n);
MG_INTERNAL void mg_leave_edges(mg_context *c, mg_events *events);

/* collocate.c, onset.c, start_rolling.c */
MG_INTERNAL mg_real *mg_stage_state(const mg_context *c, int stage);
MG_INTERNAL mg_real *mg_stage_slope(const mg_context *c, int stage);
MG_INTERNAL mg_real mg_stage_time(int stage);
MG_INTERNAL mg_real mg_stage_weight(int row, int column);
MG_INTERNAL int mg_settle_fully(mg_context *c, int contact, mg_real *eta);
MG_INTERNAL mg_real mg_collect(mg_context *c, const mg_real *x, mg_real h, int from, int to);
MG_INTERNAL void mg_collocated(mg_context *c, const mg_real *x);
MG_INTERNAL mg_real mg_misses_start(mg_context *c, mg_real t, const mg_real *x, mg_real h);
MG_INTERNAL void mg_share_stages(mg_context *c, const mg_real *x, mg_real share);
MG_INTERNAL void mg_end_earlier(mg_context *c, const mg_real *x, mg_real share);
MG_INTERNAL mg_real mg_derivative(const mg_real *value, int stage);
MG_INTERNAL int mg_eliminate(mg_real A[MG_RADAU][MG_RADAU], mg_real *b);
MG_INTERNAL mg_real mg_twice(int row, int column);
MG_INTERNAL int mg_starts_rolling(const mg_context *c);
MG_INTERNAL mg_real mg_start_rolling(mg_context *c, mg_real t, mg_real *x, mg_real h);
MG_INTERNAL void mg_grow_up(mg_context *c);

/* corners.c, folds.c */
MG_INTERNAL int mg_is_pointed(const mg_context *c, int link);
MG_INTERNAL void mg_look_ahead(mg_context *c);
MG_INTERNAL int mg_goes_off(mg_context *c, const mg_found *found);
MG_INTERNAL int mg_touches_there(mg_context *c, const mg_found *found);
MG_INTERNAL int mg_pass_corner(mg_context *c, int from, int corner, const mg_real *at, mg_found *found);
MG_INTERNAL int mg_crosses(const mg_context *c, int link);
MG_INTERNAL int mg_is_singular(const mg_context *c, int contact);
MG_INTERNAL int mg_leave_folds(mg_context *c, mg_events *events);

/* lean.c */
MG_INTERNAL void mg_cross(const mg_real *a, const mg_real *b, mg_real *out);
MG_INTERNAL int mg_open_onsets(mg_context *c, mg_real t, mg_real *x, mg_real h);
MG_INTERNAL mg_lean mg_lean_at(const mg_context *c, int contact, mg_real azimuth);
MG_INTERNAL void mg_lean_to(const mg_context *c, int contact, const mg_lean *at, mg_real tilt, mg_real *x);
MG_INTERNAL void mg_lean_at_rate(const mg_context *c, int contact, const mg_lean *at, mg_real tilt, mg_real rate, mg_real *x);
MG_INTERNAL int mg_is_lost(const mg_context *c, mg_real tilt);
MG_INTERNAL void mg_lean_of_stage(const mg_context *c, int contact, int stage, mg_real h, mg_real *lean);
MG_INTERNAL void mg_note_rate(mg_context *c, int contact, int stage);
MG_INTERNAL int mg_point_leaning(mg_context *c, mg_real t, int contact, const mg_lean *at, mg_real *x);
MG_INTERNAL mg_real mg_misses(const mg_lean *at, mg_real tilt);
MG_INTERNAL mg_real mg_spin_up(const mg_context *c, int contact, const mg_real *slope, const mg_real *direction);

#endif
