/* A face tips over the boundary of its hull: the patch ends, and the contacts or the edge on which the face tips begin.
   Whether it tips is decided in forces/patch_end_conditions.c. Writes feature pairs and modes of contacts, the start of
   rolling and the next step length of the run. */
#include "patch/patch.h"
#include "base/base.h"
#include "region/region.h"
#include "model/model.h"
#include "closest/closest.h"
#include "forces/forces.h"
#include "features/features.h"

/* True if the feature pair joins a plane and a curve that passes the world point at parameter t; then eta of the
   feature pair there. */
static int mg_is_rim_feature_pair_at_point(mg_context *c, int feature_pair, mg_real t, const mg_real *world,
                                           mg_real *eta) {
  const mg_system *s = c->system;
  const mg_real uv[2] = {t, 0};
  mg_sample sample[2];
  for (int side = 0; side < 2; side++) {
    if (mg_shape_kind_of(c, feature_pair, side)->dimension != 1) continue;
    mg_sample_at(c, feature_pair, side, uv, sample + side);
    const mg_real *x = sample[side].point, arm[3] = {x[0] - world[0], x[1] - world[1], x[2] - world[2]};
    if (mg_shape_kind_of(c, feature_pair, !side)->nearest_point != MG_NEAREST_PLANE) return 0;
    if (mg_dot3(arm, arm) >
        c->settings->search_merge_distance * s->length * c->settings->search_merge_distance * s->length)
      return 0;
    mg_point_in_shape_axes(c, feature_pair, !side, world, sample[!side].local);
    for (int k = 0; k < 2; k++) sample[!side].uv[k] = sample[!side].local[k];
    mg_start_eta(c, feature_pair, sample, sample + 1, eta);
    return 1;
  }
  return 0;
}

/* First step in s to try from flat: not so short that rounding hides the tilt, not so long that it is refused. */
static mg_real mg_rolling_start_step(const mg_context *c) {
  const mg_real time = c->system->time, least = time / 4,
                accurate_step = 12 * time * mg_pow(c->settings->tolerance, (mg_real)1 / 8);
  mg_real h = accurate_step < time ? accurate_step : time;
  if (c->run->h < h) h = c->run->h;
  return h > least ? h : least;
}

/* Start the contact of a curved boundary over which the face tips, at the world point, where its own equations
   are singular. */
static void mg_start_rim_contact(mg_context *c, int patch, const mg_support_point *at, const mg_real *world,
                                 const mg_real *outward) {
  const mg_system *s = c->system;
  mg_minimum found = {0};
  int contact = -1;
  for (int k = s->patch_covered[patch]; k < s->patch_covered[patch + 1] && contact < 0; k++) {
    found.feature_pair = s->covered_feature_pair[k];
    const int same_direction = mg_is_rim_feature_pair_at_point(c, found.feature_pair, at->t, world, found.eta);
    if (!same_direction && !mg_is_rim_feature_pair_at_point(c, found.feature_pair, -at->t, world, found.eta))
      continue; /* or the other way round */
    contact = mg_find_contact_for_minimum(c, s->feature_pair_owner[found.feature_pair], &found);
  }
  if (contact < 0) return;
  mg_set_feature_pair(c, contact, found.feature_pair, found.eta);
  const mg_real *pose = c->bodies.pose + 12 * c->contacts.f[contact];
  mg_world_to_local_point(pose, world, c->run->point + 3 * contact);
  for (int k = 0; k < 3; k++) c->run->tilt_direction[3 * contact + k] = outward[k];
  mg_set_rolling_start(c, contact, MG_START_FLAT);
  c->run->h = mg_rolling_start_step(c);
  mg_close_contact(c, contact);
}

/* True if one arc is the whole boundary loop. */
static int mg_is_closed_loop(const mg_context *c, int arc) {
  const mg_system *s = c->system;
  const mg_real *ends = s->numbers + s->arc_numbers[arc] + 12;
  mg_real point[2][3] = {{0}}, tangent[3], arm[3];
  for (int end = 0; end < 2; end++) {
    const mg_real uv[2] = {ends[end], 0};
    c->kernels->shape_point(s->arc_shape[arc], uv, s->parameters + s->arc_parameters[arc], point[end], tangent);
  }
  for (int k = 0; k < 3; k++) arm[k] = point[1][k] - point[0][k];
  return sqrt(mg_dot3(arm, arm)) < c->settings->search_merge_distance * s->length;
}

/* True for an extreme point inside a curve, not at its end or at a crossing. */
static int mg_is_smooth_boundary_point(const mg_context *c, int patch, const mg_support_point *at) {
  const mg_system *s = c->system;
  const int arc = s->patch_arc[patch] + at->arc;
  const mg_real *ends = s->numbers + s->arc_numbers[arc] + 12;
  const mg_real near = c->settings->search_merge_distance * fabs(ends[1] - ends[0]);
  const int alone = mg_is_closed_loop(c, arc);
  return at->crossing_arc < 0 && (alone || (fabs(at->t - ends[0]) > near && fabs(at->t - ends[1]) > near));
}

MG_INTERNAL void mg_hull_point_to_world(const mg_real *o, const mg_support_point *at, mg_real *world) {
  const mg_real local[3] = {at->point[0], at->point[1], 0};
  mg_to_world(o, local, 1, world);
}

/* True if the extreme point lies on a curve of f, where the contact has no equations while the faces are flat. */
static int mg_is_curved_boundary_point(const mg_context *c, const mg_support_point *at) {
  return at->crossing_arc < 0 && at->side == 1 && !c->patches.hull.arcs[at->arc].straight;
}

/* Hold a straight edge in place of the patch where the face tips about one; returns 0 where it does not. */
static int mg_hold_pivot_edge(mg_context *c, int slot, const mg_nearest_boundary *nearest, mg_real world[2][3],
                              const mg_real *outward) {
  const int patch = mg_patch_of_slot(c, slot);
  if (nearest->n == 2) {
    if (!mg_is_curved_boundary_point(c, nearest->at) && !mg_is_curved_boundary_point(c, nearest->at + 1)) return 0;
    mg_hold_hull_side(c, slot, world, outward);
    return 1;
  }
  if (!(c->settings->imaginary_edge > 0) || !mg_is_smooth_boundary_point(c, patch, nearest->at)) return 0;
  mg_hold_tangent_edge(c, slot, world[0], outward);
  return 1;
}

MG_INTERNAL int mg_is_tipping_on_curve(mg_context *c, int slot) {
  mg_real centre[3];
  mg_nearest_boundary nearest;
  mg_support_resultant(c, slot, c->solution.force, centre);
  mg_patch_hull_margin(c, mg_patch_of_slot(c, slot), centre, &nearest);
  int curved = 0;
  for (int k = 0; k < nearest.n; k++) curved |= mg_is_curved_boundary_point(c, nearest.at + k);
  return curved && !mg_is_patch_rolling_start(c, mg_patch_of_slot(c, slot));
}

MG_INTERNAL void mg_tip_patch_at(mg_context *c, int slot, const mg_nearest_boundary *nearest) {
  const int patch = mg_patch_of_slot(c, slot);
  mg_real o[12], outward[3], world[2][3];
  mg_minima found;
  mg_hull_pose(c, patch, o);
  const mg_real hull_normal[3] = {nearest->normal[0], nearest->normal[1], 0};
  mg_to_world(o, hull_normal, 0, outward);
  for (int k = 0; k < nearest->n; k++) mg_hull_point_to_world(o, nearest->at + k, world[k]);
  const int has_friction = mg_has_patch_friction(c, patch);
  if (!has_friction && mg_hold_pivot_edge(c, slot, nearest, world, outward)) return;
  const int on_points =
      has_friction && nearest->n == 2 &&
      (mg_is_curved_boundary_point(c, nearest->at) || mg_is_curved_boundary_point(c, nearest->at + 1));
  mg_release_patch(c, slot);
  mg_search_covered_feature_pairs(c, patch, has_friction && (on_points || !mg_is_curved_boundary_point(c, nearest->at)),
                                  &found);
  if (on_points) {
    mg_close_covered_contacts(c, patch);
    return;
  }
  for (int k = 0; k < nearest->n; k++) {
    const int smooth = mg_is_smooth_boundary_point(c, patch, nearest->at + k);
    const int contact = smooth ? -1 : mg_find_contact_at_point(c, patch, world[k]);
    if (contact >= 0) mg_close_contact(c, contact);
    else mg_start_rim_contact(c, patch, nearest->at + k, world[k], outward);
  }
}

MG_INTERNAL void mg_tip_patch(mg_context *c, int slot) {
  mg_real centre[3];
  mg_nearest_boundary nearest;
  mg_support_resultant(c, slot, c->solution.force, centre);
  mg_patch_hull_margin(c, mg_patch_of_slot(c, slot), centre, &nearest);
  mg_tip_patch_at(c, slot, &nearest);
}
