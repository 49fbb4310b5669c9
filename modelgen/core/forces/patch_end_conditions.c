/* Planar contact (section 5): a face that rests on another is held by three bilateral supports. The patch ends
   where the centre of pressure leaves the convex hull of the common area, or where the force between the faces
   vanishes. Reads the forces; writes the hull workspace and the event margins of the slots. */
#include "forces/forces.h"
#include "base/base.h"
#include "region/region.h"
#include "model/model.h"

MG_INTERNAL void mg_support_world_point(const mg_context *c, int support, mg_real *world) {
  mg_to_world(c->bodies.pose + 12 * c->contacts.f[support], c->run->point + 3 * support, 1, world);
}

MG_INTERNAL mg_real mg_support_resultant(const mg_context *c, int slot, const mg_real *amount, mg_real *centre) {
  const int support = mg_first_support(c, slot);
  mg_real sum = 0, point[3];
  for (int k = 0; k < 3; k++) sum += amount[support + k], centre[k] = 0;
  for (int i = 0; i < 3; i++) {
    mg_support_world_point(c, support + i, point);
    for (int k = 0; k < 3; k++) centre[k] += amount[support + i] / sum * point[k];
  }
  return sum;
}

MG_INTERNAL int mg_max_patch_arcs(const mg_system *s) {
  int most = 0;
  for (int patch = 0; patch < s->n_patch; patch++)
    if (s->patch_arc[patch + 1] - s->patch_arc[patch] > most) most = s->patch_arc[patch + 1] - s->patch_arc[patch];
  return most;
}

MG_INTERNAL int mg_is_whole_plane(const mg_context *c, int patch) {
  return c->system->patch_arc[patch] == c->system->patch_arc_f[patch];
}

MG_INTERNAL void mg_hull_pose(const mg_context *c, int patch, mg_real *out) {
  mg_face_pose(c, patch, mg_is_whole_plane(c, patch), out);
}

/* Pose of f's face in hull axes; the exact identity where the hull is in f's axes. */
static void mg_face_pose_in_hull(mg_context *c, int patch, mg_real *between) {
  mg_real hull[12], f[12];
  if (mg_is_whole_plane(c, patch)) {
    for (int k = 0; k < 12; k++) between[k] = k == 3 || k == 7 || k == 11;
    return;
  }
  mg_hull_pose(c, patch, hull);
  mg_face_pose(c, patch, 1, f);
  mg_world_to_local_point(hull, f, between);
  for (int k = 0; k < 3; k++) mg_rotate_back(hull + 3, f + 3 + 3 * k, between + 3 + 3 * k);
}

/* Load the boundary arcs of both faces of a patch into the hull workspace. */
static void mg_load_patch_regions(mg_context *c, int patch) {
  const mg_system *s = c->system;
  const int first = s->patch_arc[patch], n = s->patch_arc[patch + 1] - first;
  for (int i = 0; i < n; i++) {
    const mg_real *numbers = s->numbers + s->arc_numbers[first + i];
    const mg_arc arc = {s->arc_shape[first + i],
                        s->arc_loop[first + i],
                        s->parameters + s->arc_parameters[first + i],
                        numbers,
                        numbers[12],
                        numbers[13]};
    c->patches.arcs[i] = arc;
  }
  const mg_region_pair regions = {s->kernels, n, s->patch_arc_f[patch] - first, c->patches.arcs,
                                  c->settings->boundary_coincidence * s->length};
  c->patches.regions = regions, c->patches.hull_patch = patch, c->patches.deepest = 0;
  mg_set_regions(&c->patches.hull, &c->patches.regions, c->patches.hull_memory);
}

MG_INTERNAL int mg_overlay_patch_regions(mg_context *c, int patch) {
  const int known = c->patches.hull_patch == patch;
  mg_real between[12];
  if (known && mg_is_whole_plane(c, patch)) return c->patches.hull.n_edge;
  if (!known) mg_load_patch_regions(c, patch);
  mg_face_pose_in_hull(c, patch, between);
  return mg_overlay_regions(&c->patches.hull, between);
}

MG_INTERNAL mg_real mg_patch_hull_margin(mg_context *c, int patch, const mg_real *world, mg_nearest_boundary *nearest) {
  mg_real hull[12], x[3];
  mg_hull_pose(c, patch, hull);
  mg_world_to_local_point(hull, world, x);
  mg_overlay_patch_regions(c, patch);
  const mg_real margin = mg_hull_margin(&c->patches.hull, x, nearest);
  if (mg_is_whole_plane(c, patch) && margin > c->patches.deepest)
    c->patches.deepest = margin, c->patches.deepest_point[0] = x[0], c->patches.deepest_point[1] = x[1];
  return margin;
}

/* Lower bound in m of the distance by which a world point lies inside the hull, from the deepest point known;
   negative where it tells nothing. */
static mg_real mg_hull_margin_lower_bound(const mg_context *c, int patch, const mg_real *world) {
  mg_real hull[12], x[3];
  if (c->patches.hull_patch != patch || !(c->patches.deepest > 0)) return -1;
  mg_hull_pose(c, patch, hull);
  mg_world_to_local_point(hull, world, x);
  const mg_real dx = x[0] - c->patches.deepest_point[0], dy = x[1] - c->patches.deepest_point[1];
  return (mg_real)0.99 * c->patches.deepest - sqrt(dx * dx + dy * dy);
}

MG_INTERNAL mg_real mg_force_tolerance(const mg_context *c) { return mg_acceleration_tolerance(c) * c->system->mass; }

MG_INTERNAL int mg_find_patch_end_cause(mg_context *c, int slot, const mg_real *amount, mg_real floor,
                                        mg_real *margin) {
  mg_real centre[3];
  mg_nearest_boundary nearest;
  const mg_real N = mg_support_resultant(c, slot, amount, centre);
  *margin = -MG_MAX;
  if (!(N > floor)) return MG_FACES_SEPARATE;
  if (mg_is_edge_pivot(c, slot)) return mg_find_pivot_end_cause(c, slot, amount, floor);
  *margin = mg_patch_hull_margin(c, mg_patch_of_slot(c, slot), centre, &nearest);
  return *margin < -c->settings->feature_border * c->system->length ? MG_PRESSURE_AT_EDGE : 0;
}

MG_INTERNAL mg_event_margin *mg_slot_event_margins(const mg_context *c, int slot) {
  return mg_event_margins_of_sample(c, MG_MARGIN_SAMPLES) + mg_first_support(c, slot);
}

MG_INTERNAL int mg_find_slot_event(mg_context *c, int slot) {
  const int patch = mg_patch_of_slot(c, slot);
  const mg_real floor = -mg_force_tolerance(c), border = c->settings->feature_border * c->system->length;
  mg_event_margin *margins = mg_slot_event_margins(c, slot);
  mg_real margin, centre[3];
  for (int k = 0; k < 3; k++) margins[k].lower = margins[k].upper = MG_MAX;
  if (patch < 0) return 0;
  const mg_real N = mg_support_resultant(c, slot, c->solution.force, centre);
  const mg_real known_margin =
      !mg_is_edge_pivot(c, slot) && N > floor ? mg_hull_margin_lower_bound(c, patch, centre) : -1;
  const int cause = known_margin > 0 ? 0 : mg_find_patch_end_cause(c, slot, c->solution.force, floor, &margin);
  margins[0].lower = margins[0].upper = N - floor;
  if (known_margin > 0)
    margins[1].lower = known_margin + border, margins[1].upper = 2 * c->patches.deepest - known_margin + border;
  else if (!mg_is_edge_pivot(c, slot)) margins[1].lower = margins[1].upper = margin + border;
  return cause ? cause : mg_find_patch_friction_event(c, slot);
}

MG_INTERNAL int mg_mark_patch_events(mg_context *c) {
  int count = 0;
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    const int support = mg_first_support(c, slot);
    for (int k = 0; k < 3; k++) c->events.triggered[support + k] = 0;
    c->events.triggered[support] = mg_find_slot_event(c, slot);
    count += c->events.triggered[support] != 0;
  }
  return count;
}

MG_INTERNAL int mg_has_patch_event(mg_context *c) {
  for (int slot = 0; slot < c->system->n_patch_slot; slot++)
    if (mg_find_slot_event(c, slot)) return 1;
  return 0;
}

MG_INTERNAL mg_real mg_patch_event_value(mg_context *c, int support, int cause) {
  mg_real centre[3];
  mg_nearest_boundary nearest;
  const int slot = (support - c->layout.support_begin) / 3;
  const mg_real N = mg_support_resultant(c, slot, c->solution.force, centre);
  if (cause >= MG_FRICTION_EXCEEDED) return mg_patch_friction_event_value(c, slot, cause);
  if (cause >= MG_ROLLS_ONTO_RIM) return mg_pivot_event_value(c, slot, cause);
  return cause == MG_FACES_SEPARATE ? N : mg_patch_hull_margin(c, mg_patch_of_slot(c, slot), centre, &nearest);
}
