/* Planar contacts (section 5 of Anitescu, Cremer and Potra, 1995): which patches are held, in which slots, which
   feature pairs they cover, and how far faces have opened. A slot holds a patch by three support points, by which
   J and Gamma2 of all points of the faces are determined (Lemma 5.1). Writes feature pairs, points and modes of
   support points, patch friction modes and search requests of the run. */
#include "model/model.h"
#include "base/base.h"

MG_INTERNAL int mg_first_support(const mg_context *c, int slot) { return c->layout.support_begin + 3 * slot; }

MG_INTERNAL int mg_patch_of_slot(const mg_context *c, int slot) {
  MG_REQUIRE(slot >= 0 && slot < c->system->n_patch_slot);
  const int feature_pair = c->run->feature_pair[mg_first_support(c, slot)];
  return feature_pair < 0 ? -1 : (feature_pair - c->layout.support_feature_pair_begin) / 3;
}

MG_INTERNAL int mg_slot_of_patch(const mg_context *c, int patch) {
  for (int slot = c->system->patch_slots[2 * patch]; slot < c->system->patch_slots[2 * patch + 1]; slot++)
    if (mg_patch_of_slot(c, slot) == patch) return slot;
  return -1;
}

MG_INTERNAL int mg_find_free_slot(const mg_context *c, int patch) {
  for (int slot = c->system->patch_slots[2 * patch]; slot < c->system->patch_slots[2 * patch + 1]; slot++)
    if (mg_patch_of_slot(c, slot) < 0) return slot;
  return -1;
}

MG_INTERNAL int mg_is_feature_pair_in_patch(const mg_context *c, int patch, int feature_pair) {
  for (int k = c->system->patch_covered[patch]; k < c->system->patch_covered[patch + 1]; k++)
    if (c->system->covered_feature_pair[k] == feature_pair) return 1;
  return 0;
}

MG_INTERNAL int mg_find_flat_patch_of_contact(const mg_context *c, int contact, mg_real tilt_tolerance) {
  const int feature_pair = c->run->feature_pair[contact];
  mg_real o[12], f[12];
  for (int patch = mg_next_patch(c, -1); patch < c->system->n_patch; patch = mg_next_patch(c, patch)) {
    if (!mg_is_feature_pair_in_patch(c, patch, feature_pair)) continue;
    mg_face_pose(c, patch, 0, o);
    mg_face_pose(c, patch, 1, f);
    if (mg_dot3(o + 9, f + 9) < 0 && mg_sine_between(o + 9, f + 9) < tilt_tolerance) return patch;
  }
  return -1;
}

/* 1 if the feature pair exists only while the faces are tilted, -1 only while they lie flat, 0 in both cases. */
static int mg_feature_pair_tilt_condition(const mg_context *c, int feature_pair) {
  const mg_system *s = c->system;
  for (int k = s->feature_pair_condition[feature_pair]; k < s->feature_pair_condition[feature_pair + 1]; k++)
    if (s->condition_kind[k] == MG_CONDITION_TILT) return s->numbers[s->condition_numbers[k] + 3] < 0 ? -1 : 1;
  return 0;
}

MG_INTERNAL int mg_is_feature_pair_of_flat_faces(const mg_context *c, int feature_pair) {
  return mg_feature_pair_tilt_condition(c, feature_pair) < 0;
}

MG_INTERNAL int mg_is_feature_pair_of_tilted_faces(const mg_context *c, int feature_pair) {
  return mg_feature_pair_tilt_condition(c, feature_pair) > 0;
}

MG_INTERNAL int mg_is_distant_flat_feature_pair(const mg_context *c, int contact) {
  return c->rows.d[contact] > mg_search_reach(c, c->system->contact_pair[contact]) &&
         mg_is_feature_pair_of_flat_faces(c, c->run->feature_pair[contact]);
}

MG_INTERNAL int mg_is_patch_rolling_start(const mg_context *c, int patch) {
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (c->run->rolling_start[i] && mg_is_feature_pair_in_patch(c, patch, c->run->feature_pair[i])) return 1;
  return 0;
}

/* True if the patch covers feature pairs that exist only while its faces are tilted, such as rims. */
static int mg_has_tilted_feature_pairs(const mg_context *c, int patch) {
  for (int k = c->system->patch_covered[patch]; k < c->system->patch_covered[patch + 1]; k++)
    if (mg_is_feature_pair_of_tilted_faces(c, c->system->covered_feature_pair[k])) return 1;
  return 0;
}

/* True if the faces of a patch lie on each other but no slot holds them, and their rim has no equations until they
   tilt more. */
static int mg_is_patch_opening(const mg_context *c, int patch) {
  mg_real o[12], f[12];
  if (mg_slot_of_patch(c, patch) >= 0 || mg_is_patch_rolling_start(c, patch)) return 0;
  mg_face_pose(c, patch, 0, o);
  mg_face_pose(c, patch, 1, f);
  if (!(mg_dot3(o + 9, f + 9) < 0 && mg_sine_between(o + 9, f + 9) < c->settings->flat_angle)) return 0;
  const mg_real arm[3] = {f[0] - o[0], f[1] - o[1], f[2] - o[2]};
  return fabs(mg_dot3(arm, o + 9)) < c->settings->flat_angle * c->system->length &&
         mg_has_tilted_feature_pairs(c, patch);
}

MG_INTERNAL int mg_has_opening_patch(const mg_context *c, int pair) {
  for (int patch = mg_next_patch(c, -1); patch < c->system->n_patch && c->system->may_patches_open;
       patch = mg_next_patch(c, patch))
    if (mg_is_patch_of_pair(c, patch, pair) && mg_is_patch_opening(c, patch)) return 1;
  return 0;
}

/* Angular velocity at which the faces of a patch tilt relative to each other, rad/s. */
static mg_real mg_patch_tilt_rate(const mg_context *c, int patch) {
  mg_real o[12], w[3] = {0}, angular_velocity[3];
  mg_face_pose(c, patch, 0, o);
  for (int side = 0; side < 2; side++) {
    const int body = mg_patch_body(c, patch, side);
    mg_to_world(c->bodies.pose + 12 * body, c->bodies.twist + 6 * body + 3, 0, angular_velocity);
    for (int k = 0; k < 3; k++) w[k] += side ? angular_velocity[k] : -angular_velocity[k];
  }
  const mg_real spin = mg_dot3(w, o + 9);
  return sqrt(mg_max(mg_dot3(w, w) - spin * spin, 0));
}

MG_INTERNAL mg_real mg_patch_opening_step_limit(const mg_context *c) {
  mg_real longest = MG_MAX;
  for (int patch = mg_next_patch(c, -1); patch < c->system->n_patch && c->system->may_patches_open;
       patch = mg_next_patch(c, patch))
    if (mg_is_patch_opening(c, patch))
      longest = mg_min(longest, 2 * c->settings->flat_angle / mg_patch_tilt_rate(c, patch));
  return longest;
}

MG_INTERNAL int mg_has_patch_just_opened(const mg_context *c, int contact) {
  const int feature_pair = c->run->feature_pair[contact];
  if (!c->system->n_patch || feature_pair < 0 || !mg_is_feature_pair_of_tilted_faces(c, feature_pair)) return 0;
  const int patch = mg_find_flat_patch_of_contact(c, contact, 4 * c->settings->flat_angle);
  if (patch < 0) return 0;
  mg_real o[12], f[12];
  mg_face_pose(c, patch, 0, o);
  mg_face_pose(c, patch, 1, f);
  const mg_real time_since_flat = mg_sine_between(o + 9, f + 9) / mg_patch_tilt_rate(c, patch),
                fall_length = -c->rows.d_dot[contact] * time_since_flat;
  return -4 * c->rows.d[contact] > fall_length && -4 * c->rows.d[contact] < 3 * fall_length;
}

/* True if a contact starts to roll from a patch. */
static int mg_has_patch_rolling_start(const mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (c->run->rolling_start[i]) return 1;
  return 0;
}

MG_INTERNAL int mg_is_feature_pair_covered(const mg_context *c, int feature_pair) {
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    const int patch = mg_patch_of_slot(c, slot);
    if (patch >= 0 && mg_is_feature_pair_in_patch(c, patch, feature_pair)) return 1;
  }
  if (!c->system->n_patch_slot || !mg_is_feature_pair_of_flat_faces(c, feature_pair) || !mg_has_patch_rolling_start(c))
    return 0;
  for (int patch = mg_next_patch(c, -1); patch < c->system->n_patch; patch = mg_next_patch(c, patch))
    if (mg_is_feature_pair_in_patch(c, patch, feature_pair) && mg_is_patch_rolling_start(c, patch)) return 1;
  return 0;
}

MG_INTERNAL int mg_is_patch_of_pair(const mg_context *c, int patch, int pair) {
  if (c->system->patch_pair[patch] == pair) return 1;
  for (int k = c->system->patch_covered[patch]; k < c->system->patch_covered[patch + 1]; k++)
    if (c->system->feature_pair_owner[c->system->covered_feature_pair[k]] == pair) return 1;
  return 0;
}

MG_INTERNAL int mg_has_held_patch(const mg_context *c, int pair) {
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    const int patch = mg_patch_of_slot(c, slot);
    if (patch >= 0 && mg_is_patch_of_pair(c, patch, pair)) return 1;
  }
  return 0;
}

MG_INTERNAL int mg_may_feature_pairs_be_covered(const mg_context *c, int pair) {
  return c->system->n_patch_slot && (mg_has_held_patch(c, pair) || mg_has_patch_rolling_start(c));
}

MG_INTERNAL void mg_request_pair_searches(mg_context *c, int patch) {
  for (int pair = mg_next_pair(c, -1); pair < c->system->n_pair; pair = mg_next_pair(c, pair))
    if (mg_is_patch_of_pair(c, patch, pair)) c->run->is_search_due[pair] = 1;
}

MG_INTERNAL int mg_patch_body(const mg_context *c, int patch, int side) {
  MG_REQUIRE(patch >= 0 && patch < c->system->n_patch);
  return mg_feature_body(c, c->layout.support_feature_pair_begin + 3 * patch, side);
}

MG_INTERNAL const mg_real *mg_support_point_of_feature_pair(const mg_context *c, int feature_pair) {
  const mg_system *s = c->system;
  return s->parameters + s->feature_pair_parameters[feature_pair] +
         c->kernels->contact_kinds[s->feature_pair_kind[feature_pair]].n_parameters - 3;
}

/* Puts a support point on its feature pair, closed and active. */
static void mg_place_support(mg_context *c, int support, int feature_pair) {
  mg_set_feature_pair(c, support, feature_pair, 0);
  for (int k = 0; k < 3; k++) c->run->point[3 * support + k] = mg_support_point_of_feature_pair(c, feature_pair)[k];
  mg_close_contact(c, support);
}

MG_INTERNAL void mg_attach_patch(mg_context *c, int slot, int patch) {
  mg_set_patch_mode(c, slot, MG_FRICTION_OFF);
  for (int k = 0; k < 3; k++)
    mg_place_support(c, mg_first_support(c, slot) + k, c->layout.support_feature_pair_begin + 3 * patch + k);
}

MG_INTERNAL void mg_release_patch(mg_context *c, int slot) {
  mg_set_patch_mode(c, slot, MG_FRICTION_OFF);
  for (int k = 0; k < 3; k++) mg_set_feature_pair(c, mg_first_support(c, slot) + k, -1, 0);
}

MG_INTERNAL void mg_face_pose(const mg_context *c, int patch, int side, mg_real *out) {
  MG_REQUIRE(patch >= 0 && patch < c->system->n_patch);
  const mg_real *place = c->system->numbers + c->system->patch_numbers[patch] + 12 * side;
  const mg_real *pose = c->bodies.pose + 12 * mg_patch_body(c, patch, side);
  mg_to_world(pose, place, 1, out);
  for (int k = 0; k < 3; k++) mg_to_world(pose, place + 3 + 3 * k, 0, out + 3 + 3 * k);
}

MG_INTERNAL int mg_is_support_on_edge(const mg_context *c, int contact) {
  return mg_is_support_contact(c, contact) &&
         c->patches.trial[(contact - c->layout.support_begin) / 3] >= MG_TRIAL_ON_EDGE;
}

MG_INTERNAL int mg_is_edge_pivot(const mg_context *c, int slot) {
  return mg_patch_of_slot(c, slot) >= 0 && !c->run->closed[mg_first_support(c, slot) + 2];
}

MG_INTERNAL int mg_is_hull_side_pivot(const mg_context *c, int slot) {
  return c->run->rolling_start[mg_first_support(c, slot)] == MG_ON_STRAIGHT_EDGE;
}

/* Tilt about the held edge, rad; negative where the face would penetrate. */
static mg_real mg_pivot_tilt(const mg_context *c, int slot) {
  return mg_asin(2 * c->rows.d[mg_first_support(c, slot) + 2] / c->system->length);
}

/* Tilt up to which the edge is held, rad. */
static mg_real mg_pivot_tilt_limit(const mg_context *c, int slot) {
  return mg_is_hull_side_pivot(c, slot) ? c->settings->margin_warn : c->settings->imaginary_edge;
}

/* Smaller of the forces or impulses at the two ends of the held edge. */
static mg_real mg_least_edge_end_force(const mg_context *c, int slot, const mg_real *amount) {
  const int support = mg_first_support(c, slot);
  return amount[support] < amount[support + 1] ? amount[support] : amount[support + 1];
}

MG_INTERNAL int mg_find_pivot_end_cause(const mg_context *c, int slot, const mg_real *amount, mg_real floor) {
  const mg_real tilt = mg_pivot_tilt(c, slot);
  if (mg_is_hull_side_pivot(c, slot) && mg_least_edge_end_force(c, slot, amount) < -fabs(floor))
    return MG_EDGE_UNLOADED;
  if (tilt > mg_pivot_tilt_limit(c, slot) + c->settings->feature_border) return MG_ROLLS_ONTO_RIM;
  return tilt < -c->settings->feature_border ? MG_FLAT_AGAIN : 0;
}

MG_INTERNAL mg_real mg_pivot_event_value(const mg_context *c, int slot, int cause) {
  if (cause == MG_EDGE_UNLOADED) return mg_least_edge_end_force(c, slot, c->solution.force);
  return cause == MG_ROLLS_ONTO_RIM ? mg_pivot_tilt_limit(c, slot) - mg_pivot_tilt(c, slot) : mg_pivot_tilt(c, slot);
}
