/* Which patches are held, in which slots, and what they cover. */
#include "model/model.h"
#include "base/base.h"

MG_INTERNAL int mg_is_support_point(const mg_context *c, int contact) {
  return contact >= c->support_begin && contact < c->system->n_contact;
}

MG_INTERNAL int mg_slot_support(const mg_context *c, int slot) { return c->support_begin + 3 * slot; }

/* The patch that a slot holds, or -1. */
MG_INTERNAL int mg_slot_patch(const mg_context *c, int slot) {
  const int link = c->run->link[mg_slot_support(c, slot)];
  return link < 0 ? -1 : (link - c->support_link_begin) / 3;
}

/* The slot that holds a patch, or -1. */
MG_INTERNAL int mg_patch_slot(const mg_context *c, int patch) {
  for (int slot = c->system->patch_slots[2 * patch]; slot < c->system->patch_slots[2 * patch + 1]; slot++)
    if (mg_slot_patch(c, slot) == patch) return slot;
  return -1;
}

MG_INTERNAL int mg_free_slot(const mg_context *c, int patch) {
  for (int slot = c->system->patch_slots[2 * patch]; slot < c->system->patch_slots[2 * patch + 1]; slot++)
    if (mg_slot_patch(c, slot) < 0) return slot;
  return -1;
}

MG_INTERNAL int mg_patch_covers(const mg_context *c, int patch, int link) {
  for (int k = c->system->patch_cover[patch]; k < c->system->patch_cover[patch + 1]; k++)
    if (c->system->covered[k] == link) return 1;
  return 0;
}

/* The patch that a contact's link lies in with its faces against each other but for a lean of this size, or -1. */
MG_INTERNAL int mg_flat_patch_of_contact(const mg_context *c, int contact, mg_real lean) {
  const int link = c->run->link[contact];
  mg_real o[12], f[12];
  for (int patch = 0; patch < c->system->n_patch; patch++) {
    if (!mg_patch_covers(c, patch, link)) continue;
    mg_face_pose(c, patch, 0, o);
    mg_face_pose(c, patch, 1, f);
    if (mg_dot3(o + 9, f + 9) < 0 && mg_sine_between(o + 9, f + 9) < lean) return patch;
  }
  return -1;
}

/* 1: the link is there only while its bodies lean on each other, -1: only while they lie flat, 0: either way. */
static int mg_leaning_of(const mg_context *c, int link) {
  const mg_system *s = c->system;
  for (int k = s->link_condition[link]; k < s->link_condition[link + 1]; k++)
    if (s->condition_kind[k] == MG_TILT) return s->numbers[s->condition_numbers[k] + 3] < 0 ? -1 : 1;
  return 0;
}

MG_INTERNAL int mg_is_flat_link(const mg_context *c, int link) { return mg_leaning_of(c, link) < 0; }

MG_INTERNAL int mg_is_tilted_link(const mg_context *c, int link) { return mg_leaning_of(c, link) > 0; }

/* Of a link for faces that lie flat, on which nothing touches soon: where its condition ends is no event. */
MG_INTERNAL int mg_is_distant_flat_link(const mg_context *c, int contact) {
  return c->d[contact] > c->settings->reach * c->system->length && mg_is_flat_link(c, c->run->link[contact]);
}

/* A rim of the patch has just begun to roll. */
MG_INTERNAL int mg_is_patch_starting_to_roll(const mg_context *c, int patch) {
  for (int i = 0; i < c->support_begin; i++)
    if (c->run->fresh[i] && mg_patch_covers(c, patch, c->run->link[i])) return 1;
  return 0;
}

/* Something of what a patch covers can be followed only when its faces lean. */
static int mg_has_rim(const mg_context *c, int patch) {
  for (int k = c->system->patch_cover[patch]; k < c->system->patch_cover[patch + 1]; k++)
    if (mg_is_tilted_link(c, c->system->covered[k])) return 1;
  return 0;
}

/* The faces of a patch lie on each other but are not held, and what touches there cannot be followed yet. */
static int mg_is_unfolding(const mg_context *c, int patch) {
  mg_real o[12], f[12];
  if (mg_patch_slot(c, patch) >= 0 || mg_is_patch_starting_to_roll(c, patch)) return 0;
  mg_face_pose(c, patch, 0, o);
  mg_face_pose(c, patch, 1, f);
  if (!(mg_dot3(o + 9, f + 9) < 0 && mg_sine_between(o + 9, f + 9) < c->settings->flat)) return 0;
  const mg_real arm[3] = {f[0] - o[0], f[1] - o[1], f[2] - o[2]};
  return fabs(mg_dot3(arm, o + 9)) < c->settings->flat * c->system->length && mg_has_rim(c, patch);
}

MG_INTERNAL int mg_is_pair_unfolding(const mg_context *c, int pair) {
  for (int patch = 0; patch < c->system->n_patch; patch++)
    if (mg_patch_involves_pair(c, patch, pair) && mg_is_unfolding(c, patch)) return 1;
  return 0;
}

/* How fast the lean of the faces of a patch grows. */
static mg_real mg_leaning_rate(const mg_context *c, int patch) {
  mg_real o[12], w[3] = {0}, turning[3];
  mg_face_pose(c, patch, 0, o);
  for (int side = 0; side < 2; side++) {
    const int body = mg_patch_body(c, patch, side);
    mg_to_world(c->pose + 12 * body, c->twist + 6 * body + 3, 0, turning);
    for (int k = 0; k < 3; k++) w[k] += side ? turning[k] : -turning[k];
  }
  const mg_real about = mg_dot3(w, o + 9);
  return sqrt(fmax(mg_dot3(w, w) - about * about, 0));
}

/* The longest step after which faces that unfold lean no more than what is found at once. */
MG_INTERNAL mg_real mg_unfolding_step_limit(const mg_context *c) {
  mg_real longest = MG_MAX;
  for (int patch = 0; patch < c->system->n_patch; patch++)
    if (mg_is_unfolding(c, patch)) longest = fmin(longest, 2 * c->settings->flat / mg_leaning_rate(c, patch));
  return longest;
}

/* The contact is of a rim whose faces have just unfolded, and falls as from rest since then: it was pressed, but could
   not be followed yet. */
MG_INTERNAL int mg_has_unfolded(const mg_context *c, int contact) {
  const int link = c->run->link[contact];
  if (!c->system->n_patch || link < 0 || !mg_is_tilted_link(c, link)) return 0;
  const int patch = mg_flat_patch_of_contact(c, contact, 4 * c->settings->flat);
  if (patch < 0) return 0;
  mg_real o[12], f[12];
  mg_face_pose(c, patch, 0, o);
  mg_face_pose(c, patch, 1, f);
  const mg_real since = mg_sine_between(o + 9, f + 9) / mg_leaning_rate(c, patch), way = -c->d_dot[contact] * since;
  return -4 * c->d[contact] > way && -4 * c->d[contact] < 3 * way;
}

/* True if the link lies in a patch that is held, or in one that just turns over a rim. */
MG_INTERNAL int mg_is_covered(const mg_context *c, int link) {
  for (int slot = 0; slot < c->system->n_slot; slot++) {
    const int patch = mg_slot_patch(c, slot);
    if (patch >= 0 && mg_patch_covers(c, patch, link)) return 1;
  }
  if (!c->system->n_slot || !mg_is_flat_link(c, link)) return 0;
  for (int patch = 0; patch < c->system->n_patch; patch++)
    if (mg_patch_covers(c, patch, link) && mg_is_patch_starting_to_roll(c, patch)) return 1;
  return 0;
}

/* Faces of the pair's shapes may lie in the patch. */
MG_INTERNAL int mg_patch_involves_pair(const mg_context *c, int patch, int pair) {
  if (c->system->patch_pair[patch] == pair) return 1;
  for (int k = c->system->patch_cover[patch]; k < c->system->patch_cover[patch + 1]; k++)
    if (c->system->link_pair[c->system->covered[k]] == pair) return 1;
  return 0;
}

/* A pair with a patch that is held. */
MG_INTERNAL int mg_has_held_patch(const mg_context *c, int pair) {
  for (int slot = 0; slot < c->system->n_slot; slot++) {
    const int patch = mg_slot_patch(c, slot);
    if (patch >= 0 && mg_patch_involves_pair(c, patch, pair)) return 1;
  }
  return 0;
}

/* The pairs of a patch are searched at once. */
MG_INTERNAL void mg_request_patch_search(mg_context *c, int patch) {
  for (int pair = 0; pair < c->system->n_pair; pair++)
    if (mg_patch_involves_pair(c, patch, pair)) c->run->moved[pair] = MG_MAX / 2;
}

/* The bodies of a patch: 0 for o, 1 for f. */
MG_INTERNAL int mg_patch_body(const mg_context *c, int patch, int side) {
  const int link = c->support_link_begin + 3 * patch;
  return side ? c->system->link_f[link] : c->system->link_o[link];
}

/* The point of f that a pad's link is of, in the axes of its body. */
MG_INTERNAL const mg_real *mg_link_support_point(const mg_context *c, int link) {
  const mg_system *s = c->system;
  return s->parameters + s->link_parameters[link] + c->kernels->contact_kinds[s->link_kind[link]].n_parameters - 3;
}

static void mg_pad_on(mg_context *c, int pad, int link) {
  mg_set_link(c, pad, link, 0);
  for (int k = 0; k < 3; k++) c->run->point[3 * pad + k] = mg_link_support_point(c, link)[k];
  c->run->closed[pad] = c->run->active[pad] = 1;
}

MG_INTERNAL void mg_hold_patch(mg_context *c, int slot, int patch) {
  c->run->patch_mode[slot] = MG_FRICTION_OFF;
  for (int k = 0; k < 3; k++) mg_pad_on(c, mg_slot_support(c, slot) + k, c->support_link_begin + 3 * patch + k);
}

MG_INTERNAL void mg_release_patch(mg_context *c, int slot) {
  c->run->patch_mode[slot] = MG_FRICTION_OFF;
  for (int k = 0; k < 3; k++) mg_set_link(c, mg_slot_support(c, slot) + k, -1, 0);
}

/* A face's axes in the world: origin and R, 12 numbers. */
MG_INTERNAL void mg_face_pose(const mg_context *c, int patch, int side, mg_real *out) {
  const mg_real *place = c->system->numbers + c->system->patch_numbers[patch] + 12 * side;
  const mg_real *pose = c->pose + 12 * mg_patch_body(c, patch, side);
  mg_to_world(pose, place, 1, out);
  for (int k = 0; k < 3; k++) mg_to_world(pose, place + 3 + 3 * k, 0, out + 3 + 3 * k);
}

MG_INTERNAL int mg_is_on_edge_trial(const mg_context *c, int contact) {
  return mg_is_support_point(c, contact) && c->patches.trial[(contact - c->support_begin) / 3] >= MG_TRIAL_ON_EDGE;
}

/* The slot holds an edge in place of a patch. */
MG_INTERNAL int mg_is_turning_on_edge(const mg_context *c, int slot) {
  return mg_slot_patch(c, slot) >= 0 && !c->run->closed[mg_slot_support(c, slot) + 2];
}

MG_INTERNAL int mg_is_on_straight_edge(const mg_context *c, int slot) {
  return c->run->fresh[mg_slot_support(c, slot)] == MG_ON_STRAIGHT_EDGE;
}

/* The lean about the edge, rad; negative where the face would sink into the other. */
static mg_real mg_edge_tilt(const mg_context *c, int slot) {
  return asin(2 * c->d[mg_slot_support(c, slot) + 2] / c->system->length);
}

/* The lean up to which the edge is held. */
static mg_real mg_edge_tilt_limit(const mg_context *c, int slot) {
  return mg_is_on_straight_edge(c, slot) ? c->settings->margin_warn : c->settings->imaginary_edge;
}

static mg_real mg_least_end(const mg_context *c, int slot, const mg_real *amount) {
  const int pad = mg_slot_support(c, slot);
  return amount[pad] < amount[pad + 1] ? amount[pad] : amount[pad + 1];
}

/* The cause for which an edge is given up, or 0: the body leans enough, comes back flat, or lifts one end of it. */
MG_INTERNAL int mg_edge_end_cause(const mg_context *c, int slot, const mg_real *amount, mg_real floor) {
  const mg_real lean = mg_edge_tilt(c, slot);
  if (mg_is_on_straight_edge(c, slot) && mg_least_end(c, slot, amount) < -fabs(floor)) return MG_EDGE_UNLOADED;
  if (lean > mg_edge_tilt_limit(c, slot) + c->settings->border) return MG_ROLLS_ONTO_RIM;
  return lean < -c->settings->border ? MG_FLAT_AGAIN : 0;
}

/* The function whose zero ends an edge. */
MG_INTERNAL mg_real mg_edge_event_value(const mg_context *c, int slot, int cause) {
  if (cause == MG_EDGE_UNLOADED) return mg_least_end(c, slot, c->force);
  return cause == MG_ROLLS_ONTO_RIM ? mg_edge_tilt_limit(c, slot) - mg_edge_tilt(c, slot) : mg_edge_tilt(c, slot);
}
