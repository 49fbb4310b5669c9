/* Begin of planar contact: faces that lie flat on each other are held on trial and released where the resulting
   forces or impulses would end the patch at once. Writes feature pairs and modes of support contacts, the trial marks
   and the event list. */
#include "patch/patch.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

#define MG_STANDING_CORNERS 3 /* closed corners of a face, on which it stands */
#define MG_SUPPORTS_PAST_CORNERS \
  4 /* times rest_speed: how fast the supports of a face move that stands on its corners */

/* True if the faces of a patch whose supports move at a normal velocity rest on each other: within rest_speed, or
   faster where the face stands on its corners, which stay closed up to that speed each, because supports may lie
   further out than they do. */
static int mg_is_patch_at_rest(const mg_context *c, int patch, mg_real fastest) {
  const mg_real rest = c->settings->rest_speed * c->system->length / c->system->time;
  int corners = 0;
  if (!(fastest > rest)) return 1;
  if (fastest > MG_SUPPORTS_PAST_CORNERS * rest) return 0;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin && corners < MG_STANDING_CORNERS; i = mg_next_row(c, i))
    corners += c->run->closed[i] && mg_find_flat_patch_of_contact(c, i, c->settings->flat_angle) == patch;
  return corners == MG_STANDING_CORNERS;
}

/* True if the faces of a patch lie on each other: gaps within `touching`, normal velocities of faces at rest unless
   `moving`, and a common area. */
static int mg_is_patch_flat(mg_context *c, int patch, mg_real touching, int moving) {
  mg_real o[12], f[12], at[3], x[3];
  mg_face_pose(c, patch, 0, o);
  mg_face_pose(c, patch, 1, f);
  if (!(mg_dot3(o + 9, f + 9) < 0)) return 0;
  mg_real fastest = 0;
  for (int k = 0; k < 3; k++) {
    const int feature_pair = c->layout.support_feature_pair_begin + 3 * patch + k,
              body = mg_feature_body(c, feature_pair, 1);
    mg_to_world(c->bodies.pose + 12 * body, mg_support_point_of_feature_pair(c, feature_pair), 1, at);
    mg_world_to_local_point(o, at, x);
    if (fabs(x[2]) > touching) return 0;
    const mg_real speed =
        mg_point_speed_along_normal(c, c->bodies.twist, body, at, o + 9) -
        mg_point_speed_along_normal(c, c->bodies.twist, mg_feature_body(c, feature_pair, 0), at, o + 9);
    fastest = mg_max(fastest, fabs(speed));
  }
  return (moving || mg_is_patch_at_rest(c, patch, fastest)) && mg_overlay_patch_regions(c, patch) > 2;
}

MG_INTERNAL int mg_is_contact_of_flat_patch(mg_context *c, int contact) {
  const int patch = mg_find_flat_patch_of_contact(c, contact, c->settings->flat_angle);
  return patch >= 0 && mg_is_patch_flat(c, patch, c->settings->start_gap * c->system->length, 1);
}

MG_INTERNAL int mg_hold_flat_patches_on_trial(mg_context *c, mg_real touching, int moving) {
  int count = 0;
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) c->patches.trial[slot] = 0;
  for (int patch = mg_next_patch(c, -1); patch < c->system->n_patch && c->settings->planar_contacts;
       patch = mg_next_patch(c, patch)) {
    if (mg_slot_of_patch(c, patch) >= 0) continue;
    const int slot = mg_find_free_slot(c, patch);
    if ((slot >= 0 && c->patches.barred[slot] == patch) || (moving && mg_has_patch_friction(c, patch)) ||
        !mg_is_patch_flat(c, patch, touching, moving))
      continue;
    if (slot < 0) {
      mg_report_exceeded(c->run, MG_CAPACITY_SLOT);
      continue;
    }
    mg_attach_patch(c, slot, patch);
    c->patches.trial[slot] = 1;
    count++;
  }
  return count;
}

MG_INTERNAL void mg_release_trial_patches(mg_context *c) {
  for (int slot = 0; slot < c->system->n_patch_slot; slot++)
    if (c->patches.trial[slot]) c->patches.trial[slot] = 0, mg_release_patch(c, slot);
}

MG_INTERNAL int mg_reject_trial_patches(mg_context *c, const mg_real *amount, mg_real floor, int impulses) {
  int count = 0;
  mg_real margin;
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    if (c->patches.trial[slot] != 1) continue;
    if (!mg_find_patch_end_cause(c, slot, amount, floor, &margin) &&
        margin > c->settings->feature_border * c->system->length)
      continue;
    count++;
    if (impulses && mg_move_patch_to_edge(c, slot)) continue;
    c->patches.trial[slot] = 0;
    mg_release_patch(c, slot);
  }
  return count;
}

/* Slot held on trial if no other slot holds a patch, else -1. */
static int mg_find_only_trial_slot(const mg_context *c) {
  int alone = -1;
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    if (mg_patch_of_slot(c, slot) < 0) continue;
    if (alone >= 0) return -1;
    alone = slot;
  }
  return alone >= 0 && c->patches.trial[alone] ? alone : -1;
}

/* Tip the only trial patch over its curved hull edge at once where the forces press outside the hull; returns 1
   if it did. Polygons need no such step: their vertices are closed contacts already. */
static int mg_tip_trial_patch(mg_context *c, mg_events *events) {
  const int slot = mg_find_only_trial_slot(c), support = slot < 0 ? 0 : mg_first_support(c, slot);
  mg_real margin;
  if (slot < 0) return 0;
  const int cause = mg_find_patch_end_cause(c, slot, c->solution.force, mg_force_tolerance(c), &margin);
  if (mg_has_patch_friction(c, mg_patch_of_slot(c, slot))) return 0;
  if (cause == MG_FACES_SEPARATE || margin > c->settings->feature_border * c->system->length ||
      !mg_is_tipping_on_curve(c, slot))
    return 0;
  mg_release_covered_contacts(c);
  c->patches.trial[slot] = 0, c->patches.barred[slot] = mg_patch_of_slot(c, slot);
  mg_apply_contact_transition(c, events, support, MG_PATCH_BEGINS, c->run->t, 0);
  mg_apply_contact_transition(c, events, support, MG_PATCH_TURNS_OVER_EDGE, c->run->t, 0);
  mg_tip_patch(c, slot);
  mg_evaluate_run_state(c);
  return 1;
}

MG_INTERNAL void mg_begin_flat_patches(mg_context *c, mg_events *events, mg_real touching) {
  if (!mg_hold_flat_patches_on_trial(c, touching, 0)) return;
  if (c->system->n_friction) mg_evaluate_run_state(c);
  do {
    mg_mark_covered_contacts(c);
    if (mg_solve_active_set(c, c->patches.is_covered)) {
      mg_release_trial_patches(c);
      return;
    }
    if (mg_tip_trial_patch(c, events)) return;
  } while (mg_reject_trial_patches(c, c->solution.force, mg_force_tolerance(c), 0));
  mg_release_covered_contacts(c);
  for (int slot = 0; slot < c->system->n_patch_slot; slot++)
    if (c->patches.trial[slot])
      mg_apply_contact_transition(c, events, mg_first_support(c, slot), MG_PATCH_BEGINS, c->run->t, 0);
}
