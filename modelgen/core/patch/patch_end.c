/* How a patch ends: lifted as a whole, or turning over the edge of its hull, on contacts that begin there. */
#include "patch/patch.h"
#include "base/base.h"
#include "region/region.h"
#include "model/model.h"
#include "closest/closest.h"
#include "forces/forces.h"
#include "features/features.h"

/* Follows again what a patch covered: contacts that are found on its links stand open at their places; if `flat`, on
   links for faces that lie flat as well. */
static void mg_uncover_links(mg_context *c, int patch, int flat, mg_minima *found) {
  const mg_system *s = c->system;
  found->count = 0;
  for (int k = s->patch_cover[patch]; k < s->patch_cover[patch + 1]; k++)
    if (flat || !mg_is_flat_link(c, s->covered[k]))
      mg_search_link(c, s->covered[k], MG_COARSE, 1, -c->settings->start_gap * s->length, found);
  for (int k = 0; k < found->count; k++) {
    const mg_minimum *each = found->list + k;
    const int pair = s->link_pair[each->link];
    if (!mg_is_within_search(c, each)) continue;
    const int slot = mg_is_already_contact(c, pair, -1, each) ? -1 : mg_free_contact_for(c, pair, each);
    if (slot < 0) continue;
    mg_set_link(c, slot, each->link, each->eta);
    c->d[slot] = each->d;
  }
}

/* With friction the faces are taken to lie flat yet: then what has friction is on points of them. */
MG_INTERNAL void mg_uncover_links_of(mg_context *c, int patch, mg_minima *found) {
  mg_uncover_links(c, patch, mg_has_patch_friction(c, patch), found);
}

/* The contact of what a patch covers at a point of the world, or -1. */
MG_INTERNAL int mg_covered_contact_at(mg_context *c, int patch, const mg_real *world) {
  mg_real least = c->settings->apart * c->system->length, next[6];
  int nearest = -1;
  for (int i = 0; i < c->support_begin; i++) {
    if (!mg_is_on_link(c, i) || !mg_patch_involves_pair(c, patch, c->system->contact_pair[i])) continue;
    mg_place_contact(c, i, mg_contact_eta(c, c->run->x, i), next);
    const mg_real arm[3] = {c->search.placement[11] - world[0], c->search.placement[12] - world[1],
                            c->search.placement[13] - world[2]};
    const mg_real away = sqrt(mg_dot3(arm, arm));
    if (away < least) least = away, nearest = i;
  }
  return nearest;
}

MG_INTERNAL void mg_close_contact(mg_context *c, int contact) { c->run->closed[contact] = c->run->active[contact] = 1; }

/* Whether a link is of a curve that passes a point of the world at t, and a plane; then eta of it there. */
static int mg_is_rim(mg_context *c, int link, mg_real t, const mg_real *world, mg_real *eta) {
  const mg_system *s = c->system;
  const mg_real uv[2] = {t, 0};
  mg_sample sample[2];
  for (int side = 0; side < 2; side++) {
    if (c->kernels->shape_kinds[s->side_shape[2 * link + side]].dimension != 1) continue;
    mg_sample_at(c, link, side, uv, sample + side);
    const mg_real *x = sample[side].point, arm[3] = {x[0] - world[0], x[1] - world[1], x[2] - world[2]};
    if (c->kernels->shape_kinds[s->side_shape[2 * link + !side]].foot != MG_FLAT) return 0;
    if (mg_dot3(arm, arm) > c->settings->apart * s->length * c->settings->apart * s->length) return 0;
    mg_point_in_shape_axes(c, link, !side, world, sample[!side].local);
    for (int k = 0; k < 2; k++) sample[!side].uv[k] = sample[!side].local[k];
    mg_start_eta(c, link, sample, sample + 1, eta);
    return 1;
  }
  return 0;
}

/* The first step to try from flat. Much shorter ones would lose the lean in rounding; in longer ones it grows large, or
   they are as good as certain to be refused. */
static mg_real mg_first_lean(const mg_context *c) {
  const mg_real time = c->system->time, least = time / 4,
                fine = 12 * time * pow(c->settings->tolerance, (mg_real)1 / 8);
  mg_real h = fine < time ? fine : time;
  if (c->run->h < h) h = c->run->h;
  return h > least ? h : least;
}

/* The face turns over a curve of its boundary: the contact of the curve begins at the point, where its own equations
   are singular. */
static void mg_start_rim(mg_context *c, int patch, const mg_support_point *at, const mg_real *world,
                         const mg_real *outward) {
  const mg_system *s = c->system;
  mg_minimum found = {0};
  int contact = -1;
  for (int k = s->patch_cover[patch]; k < s->patch_cover[patch + 1] && contact < 0; k++) {
    found.link = s->covered[k];
    const int as_laid = mg_is_rim(c, found.link, at->t, world, found.eta);
    if (!as_laid && !mg_is_rim(c, found.link, -at->t, world, found.eta)) continue; /* or the other way round */
    contact = mg_free_contact_for(c, s->link_pair[found.link], &found);
  }
  if (contact < 0) return;
  mg_set_link(c, contact, found.link, found.eta);
  const mg_real *pose = c->pose + 12 * c->f[contact];
  mg_to_local(pose, world, c->run->point + 3 * contact);
  for (int k = 0; k < 3; k++) c->run->outward[3 * contact + k] = outward[k];
  c->run->fresh[contact] = MG_START_FLAT;
  c->run->h = mg_first_lean(c);
  mg_close_contact(c, contact);
}

/* One arc is the whole loop. */
static int mg_is_closed_loop(const mg_context *c, int arc) {
  const mg_system *s = c->system;
  const mg_real *ends = s->numbers + s->arc_numbers[arc] + 12;
  mg_real point[2][3] = {{0}}, tangent[3], arm[3];
  for (int end = 0; end < 2; end++) {
    const mg_real uv[2] = {ends[end], 0};
    c->kernels->shape_point(s->arc_shape[arc], uv, s->parameters + s->arc_parameters[arc], point[end], tangent);
  }
  for (int k = 0; k < 3; k++) arm[k] = point[1][k] - point[0][k];
  return sqrt(mg_dot3(arm, arm)) < c->settings->apart * s->length;
}

/* An extreme point within a curve, not where it ends or another crosses it. */
static int mg_is_smooth(const mg_context *c, int patch, const mg_support_point *at) {
  const mg_system *s = c->system;
  const int arc = s->patch_arc[patch] + at->arc;
  const mg_real *ends = s->numbers + s->arc_numbers[arc] + 12;
  const mg_real near = c->settings->apart * fabs(ends[1] - ends[0]);
  const int alone = mg_is_closed_loop(c, arc);
  return at->crossing_arc < 0 && (alone || (fabs(at->t - ends[0]) > near && fabs(at->t - ends[1]) > near));
}

/* An extreme point of the hull, whose axes are o, in the world. */
MG_INTERNAL void mg_hull_point_in_world(const mg_real *o, const mg_support_point *at, mg_real *world) {
  const mg_real local[3] = {at->point[0], at->point[1], 0};
  mg_to_world(o, local, 1, world);
}

/* Closes what touches of all that a patch covers. */
static void mg_close_covered(mg_context *c, int patch) {
  for (int i = 0; i < c->support_begin; i++)
    if (mg_is_on_link(c, i) && mg_patch_covers(c, patch, c->run->link[i])) mg_close_contact(c, i);
}

/* A point of f that lies on a curve, so that what touches there has no equations while the faces are flat. */
static int mg_is_curved(const mg_context *c, const mg_support_point *at) {
  return at->crossing_arc < 0 && at->side == 1 && !c->patches.hull.arcs[at->arc].straight;
}

/* Holds an edge in place of the patch, where the face is to turn on one. Returns 0 where it is not. */
static int mg_turn_on_edge(mg_context *c, int slot, const mg_nearest_boundary *brink, mg_real world[2][3],
                           const mg_real *outward) {
  const int patch = mg_slot_patch(c, slot);
  if (brink->n == 2) {
    if (!mg_is_curved(c, brink->at) && !mg_is_curved(c, brink->at + 1)) return 0;
    mg_hold_straight_edge(c, slot, world, outward);
    return 1;
  }
  if (!(c->settings->imaginary_edge > 0) || !mg_is_smooth(c, patch, brink->at)) return 0;
  mg_hold_imaginary_edge(c, slot, world[0], outward);
  return 1;
}

/* What a face would turn on is a curve, and it has not begun to. */
MG_INTERNAL int mg_turns_on_curve(mg_context *c, int slot) {
  mg_real centre[3];
  mg_nearest_boundary brink;
  mg_pressure_resultant(c, slot, c->force, centre);
  mg_patch_margin(c, mg_slot_patch(c, slot), centre, &brink);
  int curved = 0;
  for (int k = 0; k < brink.n; k++) curved |= mg_is_curved(c, brink.at + k);
  return curved && !mg_is_patch_starting_to_roll(c, mg_slot_patch(c, slot));
}

/* The face turns over a point of its hull's edge, or a side of it. */
MG_INTERNAL void mg_turn_on_boundary(mg_context *c, int slot, const mg_nearest_boundary *brink) {
  const int patch = mg_slot_patch(c, slot);
  mg_real o[12], outward[3], world[2][3];
  mg_minima found;
  mg_hull_pose(c, patch, o);
  const mg_real across[3] = {brink->normal[0], brink->normal[1], 0};
  mg_to_world(o, across, 0, outward);
  for (int k = 0; k < brink->n; k++) mg_hull_point_in_world(o, brink->at + k, world[k]);
  const int rubs = mg_has_patch_friction(c, patch);
  if (!rubs && mg_turn_on_edge(c, slot, brink, world, outward)) return;
  const int on_points = rubs && brink->n == 2 && (mg_is_curved(c, brink->at) || mg_is_curved(c, brink->at + 1));
  mg_release_patch(c, slot);
  mg_uncover_links(c, patch, rubs && (on_points || !mg_is_curved(c, brink->at)), &found);
  if (on_points) {
    mg_close_covered(c, patch);
    return;
  }
  for (int k = 0; k < brink->n; k++) {
    const int smooth = mg_is_smooth(c, patch, brink->at + k);
    const int contact = smooth ? -1 : mg_covered_contact_at(c, patch, world[k]);
    if (contact >= 0) mg_close_contact(c, contact);
    else mg_start_rim(c, patch, brink->at + k, world[k], outward);
  }
}

/* The face turns over where the forces press on the edge of its hull. */
MG_INTERNAL void mg_turn_over_edge(mg_context *c, int slot) {
  mg_real centre[3];
  mg_nearest_boundary brink;
  mg_pressure_resultant(c, slot, c->force, centre);
  mg_patch_margin(c, mg_slot_patch(c, slot), centre, &brink);
  mg_turn_on_boundary(c, slot, &brink);
}

/* Ends the patches that impulses would pull at, or press outside their hulls; what they cover is struck instead.
   Returns how many. */
MG_INTERNAL int mg_end_pulled_patches(mg_context *c, const mg_real *impulse, mg_real floor) {
  mg_minima found;
  mg_real margin, centre[3];
  int count = 0;
  for (int slot = 0; slot < c->system->n_slot; slot++) {
    const int patch = mg_slot_patch(c, slot);
    if (patch < 0 || c->patches.trial[slot] || fabs(mg_pressure_resultant(c, slot, impulse, centre)) <= floor) continue;
    if (!mg_is_patch_ending(c, slot, impulse, floor, &margin)) continue;
    count++;
    if (mg_move_supports_to_edge(c, slot)) continue;
    mg_release_patch(c, slot);
    mg_uncover_links_of(c, patch, &found);
    mg_close_covered(c, patch);
    mg_update_rows_and_forces(c);
  }
  return count;
}

/* Where something else strikes a body that rests on a face with friction, the face takes the blow at points of it;
   returns how many faces do. */
MG_INTERNAL int mg_replace_by_points(mg_context *c) {
  mg_minima found;
  int count = 0, struck = 0;
  for (int i = 0; i < c->support_begin; i++) struck |= c->run->closed[i] && mg_is_approaching_beyond_drift(c, i);
  for (int slot = 0; slot < c->system->n_slot && struck; slot++) {
    const int patch = mg_slot_patch(c, slot);
    if (patch < 0 || !mg_has_patch_friction(c, patch)) continue;
    mg_release_patch(c, slot);
    mg_uncover_links_of(c, patch, &found);
    mg_close_covered(c, patch);
    count++;
  }
  return count;
}

/* Ends the patches that are marked in c->events.triggered; returns how many. */
MG_INTERNAL int mg_end_patches(mg_context *c, mg_events *events) {
  mg_minima found;
  int count = 0;
  for (int slot = 0; slot < c->system->n_slot; slot++) {
    const int pad = mg_slot_support(c, slot), cause = c->events.triggered[pad], patch = mg_slot_patch(c, slot);
    c->events.triggered[pad] = 0;
    if (cause >= MG_FRICTION_EXCEEDED) c->patches.friction[slot].triggered = 1;
    if (!cause || patch < 0 || cause >= MG_FRICTION_EXCEEDED) continue;
    if (cause < MG_ROLLS_ONTO_RIM)
      mg_apply_transition(c, events, pad, cause == MG_PRESSURE_AT_EDGE ? MG_PATCH_TURNS_OVER_EDGE : MG_LIFTS_OFF,
                          c->run->t, 0);
    c->patches.barred[slot] = cause == MG_FLAT_AGAIN ? -1 : patch;
    if (cause == MG_PRESSURE_AT_EDGE) mg_turn_over_edge(c, slot);
    else if (cause == MG_ROLLS_ONTO_RIM || cause == MG_EDGE_UNLOADED) mg_leave_edge(c, slot, events);
    else mg_release_patch(c, slot), mg_uncover_links_of(c, patch, &found);
    mg_request_patch_search(c, patch);
    count++;
  }
  return count;
}
