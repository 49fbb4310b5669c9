/* The convex hull of what the two faces of a patch share, and the centre of the pressure on it (section 5 of
   Anitescu, Cremer and Potra, 1995). Writes the hull workspace. */
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

MG_INTERNAL void mg_face_pose_in_hull(mg_context *c, int patch, mg_real *between) {
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

MG_INTERNAL void mg_list_face_arcs(const mg_context *c, const int *range, mg_arc *arcs, mg_region_pair *regions) {
  const mg_system *s = c->system;
  int n = 0;
  for (int side = 0; side < 2; side++)
    for (int i = range[2 * side]; i < range[2 * side + 1]; i++) {
      const mg_real *numbers = s->numbers + s->arc_numbers[i];
      const mg_arc arc = {s->arc_shape[i], s->arc_loop[i], s->parameters + s->arc_parameters[i],
                          numbers,         numbers[12],    numbers[13]};
      arcs[n++] = arc;
    }
  const mg_region_pair found = {s->kernels, n, range[1] - range[0], arcs,
                                c->settings->boundary_coincidence * s->length};
  *regions = found;
}

MG_INTERNAL void mg_patch_arc_ranges(const mg_context *c, int patch, int *range) {
  const mg_system *s = c->system;
  range[0] = s->patch_arc[patch], range[1] = range[2] = s->patch_arc_f[patch], range[3] = s->patch_arc[patch + 1];
}

/* Load the boundary arcs of both faces of a patch into the hull workspace. */
static void mg_load_patch_regions(mg_context *c, int patch) {
  int range[4];
  mg_patch_arc_ranges(c, patch, range);
  mg_list_face_arcs(c, range, c->patches.arcs, &c->patches.regions);
  c->patches.hull_patch = patch, c->patches.deepest = 0;
  mg_set_regions(&c->patches.hull, &c->patches.regions, c->patches.hull_memory);
}

MG_INTERNAL int mg_overlay_patch_regions(mg_context *c, int patch) {
  const int known = c->patches.hull_patch == patch;
  mg_real between[12];
  if (known && mg_is_whole_plane(c, patch)) return c->patches.hull.n_edge;
  if (!known) mg_load_patch_regions(c, patch);
  mg_face_pose_in_hull(c, patch, between);
  const int edges = mg_overlay_regions(&c->patches.hull, between);
  if (c->patches.hull.overflow) mg_report_exceeded(c->run, MG_CAPACITY_REGION);
  return edges;
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

MG_INTERNAL mg_real mg_hull_margin_lower_bound(const mg_context *c, int patch, const mg_real *world) {
  mg_real hull[12], x[3];
  if (c->patches.hull_patch != patch || !(c->patches.deepest > 0)) return -1;
  mg_hull_pose(c, patch, hull);
  mg_world_to_local_point(hull, world, x);
  const mg_real dx = x[0] - c->patches.deepest_point[0], dy = x[1] - c->patches.deepest_point[1];
  return (mg_real)0.99 * c->patches.deepest - sqrt(dx * dx + dy * dy);
}
