/* Tilt of two bodies whose faces lay flat: the part across the present normal N of what was N, in the axes of f,
   while they were flat, and its azimuth. Writes the rolling-start workspace and the state that it is given. */
#include "integrate/integrate.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

/* Rotate a direction from world axes to the axes of a pose. */
static void mg_world_to_local_direction(const mg_real *pose, const mg_real *world, mg_real *local) {
  for (int k = 0; k < 3; k++) local[k] = mg_dot3(pose + 3 + 3 * k, world);
}

MG_INTERNAL int mg_is_tilt_lost_in_rounding(const mg_context *c, mg_real tilt) {
  return tilt < c->settings->flat_angle * c->settings->flat_angle;
}

/* Normal N in the axes of o and of f while the faces lay flat: the face normals of the patch, or the present N of
   a rim without one. Needs the placement there. */
static void mg_find_flat_normals(const mg_context *c, int contact, mg_rolling_start *start) {
  MG_NEEDS_PLACED(c, contact);
  mg_real least = MG_MAX, face[2][12];
  mg_world_to_local_direction(c->bodies.pose + 12 * c->contacts.o[contact], c->search.placement + 5, start->normal);
  mg_world_to_local_direction(c->bodies.pose + 12 * c->contacts.f[contact], c->search.placement + 5, start->axis);
  for (int patch = mg_next_patch(c, -1); patch < c->system->n_patch; patch = mg_next_patch(c, patch)) {
    if (!mg_is_feature_pair_in_patch(c, patch, c->run->feature_pair[contact])) continue;
    const int swapped = mg_patch_body(c, patch, 0) != c->contacts.o[contact];
    for (int side = 0; side < 2; side++) mg_face_pose(c, patch, side != swapped, face[side]);
    const mg_real sine = mg_sine_between(face[0] + 9, face[1] + 9);
    if (mg_dot3(face[0] + 9, face[1] + 9) > 0 || sine >= least) continue;
    least = sine;
    mg_world_to_local_direction(c->bodies.pose + 12 * c->contacts.o[contact], face[0] + 9, start->normal);
    mg_world_to_local_direction(c->bodies.pose + 12 * c->contacts.f[contact], face[1] + 9, start->axis);
    for (int k = 0; k < 3; k++) start->axis[k] *= -1;
  }
}

MG_INTERNAL int mg_initialise_rolling_starts(mg_context *c, mg_real t, mg_real *x, mg_real h) {
  mg_update_poses(c, t, x);
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) {
    if (c->run->rolling_start[i] != MG_START_FLAT) continue;
    if (!mg_is_free_body(c, c->contacts.f[i]) && !mg_is_free_body(c, c->contacts.o[i])) return 0;
    mg_rolling_start *start = c->step.rolling_starts + i;
    mg_place_contact(c, i, mg_contact_eta(c, x, i), c->search.placement + 32);
    mg_find_flat_normals(c, i, start);
    mg_world_to_local_direction(c->bodies.pose + 12 * c->contacts.o[i], c->run->tilt_direction + 3 * i, start->outward);
    const mg_contact_tilt at = mg_tilt_at_azimuth(c, i, 0);
    const mg_real present_tilt = mg_dot3(at.along, at.tilt);
    mg_world_to_local_direction(c->bodies.pose + 12 * c->contacts.o[i], at.tilt, start->tilt_start);
    for (int k = 0; k < 3 && mg_is_tilt_lost_in_rounding(c, present_tilt); k++)
      start->tilt_start[k] = (present_tilt > 0 ? present_tilt : 0) * start->outward[k];
    for (int stage = 0; stage < MG_RADAU_STAGES; stage++)
      start->azimuth[stage] = 0,
      start->tilt[stage] = (present_tilt > 0 ? present_tilt : 0) + sqrt(MG_EPS) * h / c->system->time;
  }
  return 1;
}

MG_INTERNAL mg_contact_tilt mg_tilt_at_azimuth(const mg_context *c, int contact, mg_real azimuth) {
  const mg_rolling_start *start = c->step.rolling_starts + contact;
  const mg_real *o = c->bodies.pose + 12 * c->contacts.o[contact], *f = c->bodies.pose + 12 * c->contacts.f[contact];
  mg_contact_tilt at;
  mg_real out[3], lateral[3], axis[3];
  mg_to_world(o, start->normal, 0, at.normal), mg_to_world(o, start->outward, 0, out),
      mg_to_world(f, start->axis, 0, axis);
  mg_cross_product(at.normal, out, lateral);
  const mg_real height = mg_dot3(axis, at.normal), cosine = mg_cos(azimuth), sine = mg_sin(azimuth);
  for (int k = 0; k < 3; k++) {
    at.along[k] = cosine * out[k] + sine * lateral[k];
    at.across[k] = cosine * lateral[k] - sine * out[k];
    at.tilt[k] = axis[k] - height * at.normal[k];
  }
  return at;
}

/* Angular velocity of f relative to o, world axes. */
static void mg_relative_angular_velocity(const mg_context *c, int contact, mg_real *out) {
  mg_real o[3], f[3];
  mg_to_world(c->bodies.pose + 12 * c->contacts.o[contact], c->bodies.twist + 6 * c->contacts.o[contact] + 3, 0, o);
  mg_to_world(c->bodies.pose + 12 * c->contacts.f[contact], c->bodies.twist + 6 * c->contacts.f[contact] + 3, 0, f);
  for (int k = 0; k < 3; k++) out[k] = f[k] - o[k];
}

MG_INTERNAL void mg_note_tilt_rate(mg_context *c, int contact, int stage) {
  mg_rolling_start *start = c->step.rolling_starts + contact;
  mg_real turning[3], axis[3], rate[3];
  mg_relative_angular_velocity(c, contact, turning);
  mg_to_world(c->bodies.pose + 12 * c->contacts.f[contact], start->axis, 0, axis);
  mg_cross_product(turning, axis, rate);
  mg_world_to_local_direction(c->bodies.pose + 12 * c->contacts.o[contact], rate, start->tilt_rate[stage]);
}

MG_INTERNAL void mg_tilt_of_stage(const mg_context *c, int contact, int stage, mg_real h, mg_real *tilt) {
  const mg_rolling_start *start = c->step.rolling_starts + contact;
  mg_real local[3] = {start->tilt_start[0], start->tilt_start[1], start->tilt_start[2]};
  for (int j = 0; j < MG_RADAU_STAGES; j++) {
    const mg_real weight = h * mg_collocation_weight(stage, j);
    for (int k = 0; k < 3; k++) local[k] += weight * start->tilt_rate[j][k];
  }
  mg_to_world(c->bodies.pose + 12 * c->contacts.o[contact], local, 0, tilt);
}

MG_INTERNAL void mg_rotate_to_tilt(const mg_context *c, int contact, const mg_contact_tilt *at, mg_real tilt,
                                   mg_real *x) {
  const int turns_f = mg_is_free_body(c, c->contacts.f[contact]),
            body = turns_f ? c->contacts.f[contact] : c->contacts.o[contact];
  mg_real change[3], turn[3], angle[3];
  for (int k = 0; k < 3; k++) change[k] = (turns_f ? 1 : -1) * (tilt * at->along[k] - at->tilt[k]);
  mg_cross_product(at->normal, change, turn);
  mg_world_to_local_direction(c->bodies.pose + 12 * body, turn, angle);
  mg_rotate_quaternion(x + c->system->body_q[body] + 3, angle);
}

MG_INTERNAL mg_real mg_relative_tilt_error(const mg_contact_tilt *at, mg_real tilt) {
  mg_real sum = 0;
  for (int k = 0; k < 3; k++) sum += (at->tilt[k] - tilt * at->along[k]) * (at->tilt[k] - tilt * at->along[k]);
  return sqrt(sum) / tilt;
}

MG_INTERNAL void mg_set_azimuth_rate(const mg_context *c, int contact, const mg_contact_tilt *at, mg_real tilt,
                                     mg_real rate, mg_real *x) {
  const int turns_f = mg_is_free_body(c, c->contacts.f[contact]),
            body = turns_f ? c->contacts.f[contact] : c->contacts.o[contact];
  mg_real along[3], turning[3];
  mg_relative_angular_velocity(c, contact, turning);
  const mg_real spin = mg_dot3(turning, at->normal), now = mg_dot3(turning, at->along);
  const mg_real change = (turns_f ? 1 : -1) * (tilt * (spin - rate) - now);
  mg_real *w = x + c->system->n_q + c->system->body_u[body] + 3;
  mg_world_to_local_direction(c->bodies.pose + 12 * body, at->along, along);
  for (int k = 0; k < 3; k++) w[k] += change * along[k];
}

MG_INTERNAL mg_real mg_relative_angular_acceleration(const mg_context *c, int contact, const mg_real *slope,
                                                     const mg_real *direction) {
  mg_real sum = 0, turn[3];
  for (int side = 0; side < 2; side++) {
    const int body = side ? c->contacts.f[contact] : c->contacts.o[contact];
    if (!mg_is_free_body(c, body)) continue;
    mg_to_world(c->bodies.pose + 12 * body, slope + c->system->n_q + c->system->body_u[body] + 3, 0, turn);
    sum += (side ? 1 : -1) * mg_dot3(turn, direction);
  }
  return sum;
}

MG_INTERNAL int mg_find_rolling_point(mg_context *c, mg_real t, int contact, const mg_contact_tilt *at, mg_real *x) {
  MG_NEEDS_ANY(c, MG_VALID_POSES);
  const int body = mg_is_free_body(c, c->contacts.f[contact]) ? c->contacts.f[contact] : c->contacts.o[contact];
  mg_real kept[4], *turn = x + c->system->body_q[body] + 3;
  for (int k = 0; k < 4; k++) kept[k] = turn[k];
  mg_rotate_to_tilt(c, contact, at, sqrt(c->settings->flat_angle), x);
  mg_normalise_quaternions(c, x);
  mg_update_poses(c, t, x);
  const int found = mg_converge_contact_point(c, contact, mg_contact_eta(c, x, contact));
  mg_place_contact(c, contact, mg_contact_eta(c, x, contact), c->search.placement + 32);
  mg_world_to_local_point(c->bodies.pose + 12 * c->contacts.f[contact], c->search.placement + 11,
                          c->run->point + 3 * contact);
  for (int k = 0; k < 4; k++) turn[k] = kept[k];
  mg_update_poses(c, t, x);
  return found;
}

MG_INTERNAL int mg_converge_contact_point(mg_context *c, int contact, mg_real *eta) {
  if (!c->contacts.n_eta[contact]) return 1;
  if (mg_newton_on_feature_pair(c, contact, eta) < 0) return 0;
  for (int extra = 0; extra < 2; extra++) {
    mg_place_contact(c, contact, eta, c->search.placement + 32);
    for (int k = 0; k < c->contacts.n_eta[contact]; k++) eta[k] = c->search.placement[32 + k];
  }
  return mg_all_finite(c->contacts.n_eta[contact], eta);
}
