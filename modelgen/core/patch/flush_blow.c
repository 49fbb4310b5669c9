/* Blows within the plane of two faces. Where a face of each body lies in one plane, opposite to each other, and neither
   of the features that meet reaches beyond its own face, the bodies have no height in common: whether one strikes the
   other is decided by rounding, as at the seam of two plates of equal height. A wall that stands on the plate reaches
   beyond it, and is struck. Writes the flush blow that the run reports. */
#include "patch/patch.h"
#include "closest/closest.h"
#include "model/model.h"

#define MG_FLUSH_SAMPLES 3 /* a feature is sampled at so many times so many points */

/* Height of a point above a face, along its outward normal. */
static mg_real mg_height_above(const mg_real *face, const mg_real *point) {
  const mg_real arm[3] = {point[0] - face[0], point[1] - face[1], point[2] - face[2]};
  return mg_dot3(arm, face + 9);
}

/* True if a condition of the feature pair bounds a face, whose domain is unbounded. */
static int mg_is_bounded_by_conditions(const mg_context *c, int feature_pair, int side) {
  const int end = c->system->feature_pair_condition[feature_pair + 1];
  for (int k = c->system->feature_pair_condition[feature_pair]; k < end; k++)
    if (mg_bounding_quadric(c, side, k)) return 1;
  return 0;
}

/* True if a feature of a contact at `point` reaches farther beyond the plane of a face of its body than `height`. */
static int mg_does_feature_reach_beyond(mg_context *c, int feature_pair, int side, const mg_real *face,
                                        const mg_real *point, mg_real height) {
  mg_sample at[MG_FLUSH_SAMPLES * MG_FLUSH_SAMPLES];
  mg_real window[4], above[3], local[3];
  if (mg_is_bounded_by_conditions(c, feature_pair, side)) {
    for (int k = 0; k < 3; k++) above[k] = point[k] + 2 * height * face[9 + k];
    mg_point_in_shape_axes(c, feature_pair, side, above, local);
    return mg_is_within_border(c, feature_pair, side, local, 0);
  }
  mg_sample_window(c, feature_pair, side, mg_search_radius(c, feature_pair, side), window);
  const int n = mg_sample_feature(c, feature_pair, side, window, MG_FLUSH_SAMPLES, at);
  for (int k = 0; k < n; k++)
    if (mg_height_above(face, at[k].point) > height) return 1;
  return 0;
}

/* True if the contact placed last lies in the plane of the faces of a patch of its pair, which is across its normal,
   and neither of its features reaches beyond that plane. */
static int mg_is_flush_with(mg_context *c, int patch, int feature_pair) {
  const mg_real *placed = c->search.placement, height = c->settings->flush_height * c->system->length;
  mg_real face[2][12];
  for (int side = 0; side < 2; side++) mg_face_pose(c, patch, side, face[side]);
  if (!(mg_dot3(face[0] + 9, face[1] + 9) < 0 && mg_sine_between(face[0] + 9, face[1] + 9) < c->settings->flat_angle))
    return 0;
  if (fabs(mg_dot3(face[0] + 9, placed + 5)) > 0.5) return 0;
  /* a face that is joined of several fixed bodies counts as of the first of them: so either body tells the sides */
  const int swapped = mg_feature_body(c, feature_pair, 0) == mg_patch_body(c, patch, 1) ||
                      mg_feature_body(c, feature_pair, 1) == mg_patch_body(c, patch, 0);
  for (int side = 0; side < 2; side++) {
    const mg_real *own = face[side ^ swapped], *point = placed + (side ? 11 : 8);
    if (fabs(mg_height_above(own, point)) > height ||
        mg_does_feature_reach_beyond(c, feature_pair, side, own, point, height))
      return 0;
  }
  return 1;
}

MG_INTERNAL void mg_note_flush_blow(mg_context *c, int contact) {
  MG_NEEDS_AT_RUN(c, MG_VALID_ROWS);
  const int pair = c->system->contact_pair[contact], feature_pair = c->run->feature_pair[contact];
  mg_real next[6];
  if (!c->system->n_patch || c->run->report.flush_contact >= 0 || feature_pair < 0 ||
      !mg_is_approaching_beyond_drift(c, contact))
    return;
  mg_place_contact(c, contact, mg_contact_eta(c, c->run->x, contact), next);
  for (int patch = mg_next_patch(c, -1); patch < c->system->n_patch; patch = mg_next_patch(c, patch)) {
    if (!mg_is_patch_of_pair(c, patch, pair) || !mg_is_flush_with(c, patch, feature_pair)) continue;
    mg_report_flush_blow(c->run, mg_told_contact(c->system, c->run, contact));
    return;
  }
}
