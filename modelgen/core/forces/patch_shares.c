/* Shares of the pairs in a planar contact of several: the feet of a stool, a plank on two blocks. The forces on the
   supports are those of the whole contact. The pressure that the run assumes between the faces (region/region.h) says
   how much of it acts where the two faces of each pair overlap. Its coefficients are linear in the forces on the
   supports as long as the loaded part stays, and where it grows the pressure vanishes: so a share is a sum of weights
   times forces, to first order too. Writes c->patches.share. */
#include "forces/forces.h"
#include "base/base.h"
#include "model/model.h"
#include "region/region.h"

MG_INTERNAL mg_share_room mg_find_share_room(const mg_system *s) {
  mg_share_room most = {0};
  for (int patch = 0; patch < s->n_patch; patch++) {
    const int n = s->patch_arc[patch + 1] - s->patch_arc[patch], n_o = s->patch_arc_f[patch] - s->patch_arc[patch],
              shares = s->patch_share[patch + 1] - s->patch_share[patch];
    const mg_share_room room = {n, shares, mg_hull_memory_size(n, n_o), mg_strip_capacity(n, n_o)};
    if (!shares) continue;
    if (room.arcs > most.arcs) most.arcs = room.arcs;
    if (room.shares > most.shares) most.shares = room.shares;
    if (room.hull > most.hull) most.hull = room.hull;
    if (room.strips > most.strips) most.strips = room.strips;
  }
  return most;
}

/* Overlap of two faces, given by their arcs, in the axes of the hull of a patch. */
static void mg_overlay_share(mg_context *c, int patch, const int *range) {
  mg_share_workspace *w = &c->patches.share;
  mg_real between[12];
  mg_list_face_arcs(c, range, w->arcs, &w->regions);
  mg_set_regions(&w->hull, &w->regions, w->hull_memory);
  mg_face_pose_in_hull(c, patch, between);
  mg_overlay_regions(&w->hull, between);
}

/* Pressure over the whole patch, uniform where the supports do not push, and its coefficients level[i] for a unit force
   on support i. Returns 1 if its centre had to be moved inside the hull, or it is uniform. */
static int mg_find_shared_pressure(mg_context *c, int slot, const mg_real *force, mg_real level[3][3]) {
  const int patch = mg_patch_of_slot(c, slot), support = mg_first_support(c, slot);
  mg_share_workspace *w = &c->patches.share;
  mg_real pose[12], world[3], centre[3], point[3][3];
  int range[4], is_moved = 1;
  mg_patch_arc_ranges(c, patch, range);
  mg_overlay_share(c, patch, range);
  mg_hull_pose(c, patch, pose);
  for (int i = 0; i < 3; i++) {
    mg_support_world_point(c, support + i, world);
    mg_world_to_local_point(pose, world, point[i]);
  }
  mg_open_pressure(&w->pressure, &w->hull, w->strip_capacity, w->strips);
  const mg_real sum = mg_support_resultant(c, slot, force, world);
  mg_world_to_local_point(pose, world, centre);
  if (sum > 0) is_moved = mg_move_inside_hull(&w->hull, centre);
  if (!(sum > 0) || !mg_winkler_pressure(&w->pressure, 1, centre)) {
    for (int k = 0; k < 2; k++) centre[k] = (point[0][k] + point[1][k] + point[2][k]) / 3;
    mg_uniform_pressure(&w->pressure, centre);
    w->pressure.coefficients[0] = 1 / w->pressure.moments[0], is_moved = 1;
  }
  mg_restrict_pressure(&w->pressure, &w->hull);
  for (int i = 0; i < 3; i++) {
    const mg_real moment[3] = {1, point[i][0] - w->pressure.centre[0], point[i][1] - w->pressure.centre[1]};
    if (is_moved || !mg_solve_moments(&w->pressure, moment, level[i]))
      mg_copy_reals(level[i], w->pressure.coefficients, 3), is_moved = 1;
  }
  return is_moved;
}

MG_INTERNAL mg_real mg_share_force(const mg_context *c, int slot, int share, const mg_real *force) {
  return mg_dot3(c->patches.share.weight + 3 * share, force + mg_first_support(c, slot));
}

MG_INTERNAL int mg_find_patch_shares(mg_context *c, int slot, const mg_real *force) {
  const mg_system *s = c->system;
  const int patch = mg_patch_of_slot(c, slot), first = s->patch_share[patch], n = s->patch_share[patch + 1] - first;
  mg_share_workspace *w = &c->patches.share;
  mg_real level[3][3], centre[3], sum = 0;
  const int is_moved = mg_find_shared_pressure(c, slot, force, level);
  for (int k = 0; k < n; k++) {
    mg_overlay_share(c, patch, s->share_arc + 4 * (first + k));
    mg_restrict_pressure(&w->pressure, &w->hull);
    for (int i = 0; i < 3; i++) w->weight[3 * k + i] = mg_dot3(level[i], w->pressure.moments);
    sum += mg_share_force(c, slot, k, force);
  }
  const mg_real whole = mg_support_resultant(c, slot, force, centre);
  if (fabs(sum - whole) <= sqrt(MG_EPS) * fabs(whole))
    return is_moved || !mg_is_whole_plane(c, patch) ? MG_SHARES_VARY : MG_SHARES_FIXED;
  for (int k = 0; k < 3 * n; k++) w->weight[k] *= whole / sum;
  return MG_SHARES_OVERLAP;
}
