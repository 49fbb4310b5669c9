/* What the sensors of a scene show at an evaluated state. Reads poses, twists, accelerations and forces; writes
 * c->sensors. */
#include "integrate/integrate.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

#define MG_WELD_ROWS 6 /* of a joint that leaves no coordinate */

/* Least gap and sum of the normal forces of each pair of shapes, its resting faces included. */
static void mg_sum_pairs(mg_context *c, const mg_real *eta, const mg_real *force) {
  const mg_system *s = c->system;
  mg_real centre[3];
  for (int pair = 0; pair < s->n_pair; pair++) c->sensors.pair[2 * pair] = MG_MAX, c->sensors.pair[2 * pair + 1] = 0;
  for (int pair = mg_next_pair(c, -1); pair < s->n_pair; pair = mg_next_pair(c, pair)) {
    mg_real *shown = c->sensors.pair + 2 * pair;
    for (int i = s->pair_contact[pair]; i < s->pair_contact[pair + 1]; i++) {
      if (!mg_is_on_feature_pair(c, i)) continue;
      mg_place_contact(c, i, eta + s->contact_eta[i], c->search.placement + 32);
      shown[0] = mg_min(shown[0], c->search.placement[0]), shown[1] += force[i];
    }
  }
  for (int slot = 0; slot < s->n_patch_slot; slot++) {
    const int patch = mg_patch_of_slot(c, slot), first = patch < 0 ? 0 : s->patch_share[patch],
              n = patch < 0 ? 0 : s->patch_share[patch + 1] - first;
    if (patch < 0) continue;
    if (n) mg_find_patch_shares(c, slot, force);
    for (int k = 0; k < (n ? n : 1); k++) {
      mg_real *shown = c->sensors.pair + 2 * (n ? s->share_pair[first + k] : s->patch_pair[patch]);
      shown[0] = mg_min(shown[0], c->rows.d[mg_first_support(c, slot)]);
      shown[1] += n ? mg_share_force(c, slot, k, force) : mg_support_resultant(c, slot, force, centre);
    }
  }
  for (int pair = 0; pair < s->n_pair; pair++)
    if (c->sensors.pair[2 * pair] == MG_MAX) c->sensors.pair[2 * pair] = (mg_real)NAN;
}

/* True if a body that forces move has a part of a face that rests and counts as of another body, to which welds hold
   it. */
static int mg_is_face_across_welds(const mg_context *c) {
  const mg_system *s = c->system;
  for (int slot = 0; slot < s->n_patch_slot; slot++) {
    const int patch = mg_patch_of_slot(c, slot);
    if (patch < 0) continue;
    const int o = mg_patch_body(c, patch, 0), f = mg_patch_body(c, patch, 1);
    for (int k = s->patch_share[patch]; k < s->patch_share[patch + 1]; k++)
      for (int side = 0; side < 2; side++) {
        const int body = mg_feature_body(c, s->pair_feature_pair[s->share_pair[k]], side);
        if (body != o && body != f && (mg_is_moved_by_forces(c, body) || mg_is_moved_by_forces(c, side ? f : o)))
          return 1;
      }
  }
  return 0;
}

MG_INTERNAL void mg_joint_wrench(const mg_context *c, int joint, mg_real *wrench) {
  const mg_system *s = c->system;
  const int first = c->layout.joint_row_begin + s->joint_row[joint], n = mg_held_joint_rows(c, joint);
  for (int j = 0; j < 6; j++) wrench[j] = n == MG_WELD_ROWS && mg_is_face_across_welds(c) ? (mg_real)NAN : 0;
  for (int i = first; i < first + n; i++)
    for (int j = 0; j < 6; j++) wrench[j] += c->solution.force[i] * c->rows.J[12 * i + 6 + j];
}

MG_INTERNAL void mg_read_sensors(mg_context *c, mg_real t, const mg_real *eta, const mg_real *force, int solved,
                                 mg_real *sensors) {
  MG_NEEDS_ANY(c, MG_VALID_POSES);
  const mg_system *s = c->system;
  MG_NOTE_WITH(c, MG_VALID_SENSORS, MG_VALID_TWISTS);
  if (!c->kernels->n_sensor) return;
  if (c->kernels->sensors_need_forces) {
    mg_sum_pairs(c, eta, force);
    for (int j = 0; j < s->n_joint; j++) {
      mg_real *wrench = c->sensors.joint + 6 * j;
      if (solved) mg_joint_wrench(c, j, wrench);
      else
        for (int k = 0; k < 6; k++) wrench[k] = (mg_real)NAN;
    }
  }
  if (mg_is_time_stepping(c))
    for (int k = 0; k < 6 * s->n_body; k++) c->sensors.acceleration[k] = (mg_real)NAN;
  else mg_copy_reals(c->sensors.acceleration, c->bodies.acceleration, 6 * s->n_body);
  c->kernels->sense(0, &t, c->bodies.pose, c->bodies.twist, c->sensors.acceleration, c->sensors.pair, c->sensors.joint,
                    s->gravity, s->parameters + s->sensor_parameters, c->run->applied_input, sensors);
}
