/* Samples of a run at the times that the caller asked for. Reads the present poses, rows and forces, or those on
   the interpolant; writes mg_record. */
#include "integrate/integrate.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

/* Force, gap, normal and points of a contact. */
static void mg_record_contact(mg_context *c, mg_record *record, int row, int contact, const mg_real *eta) {
  const long k = (long)row * c->system->n_contact + contact;
  record->feature_pair[k] = c->run->feature_pair[contact];
  if (mg_is_on_feature_pair(c, contact)) mg_place_contact(c, contact, eta, c->search.placement + 32);
  else
    for (int j = 0; j < 14; j++) c->search.placement[j] = (mg_real)NAN;
  record->force[k] = c->solution.force[contact];
  record->gap[k] = c->search.placement[0];
  mg_copy_reals(record->normal + 3 * k, c->search.placement + 5, 3);
  mg_copy_reals(record->point_o + 3 * k, c->search.placement + 8, 3);
  mg_copy_reals(record->point_f + 3 * k, c->search.placement + 11, 3);
}

MG_INTERNAL void mg_friction_rows_vector(const mg_context *c, int contact, const mg_real *value, int about,
                                         mg_real *out) {
  const mg_real *t = c->rows.tangents + 6 * contact, *N = c->rows.normal + 3 * contact;
  const mg_real *rows = value + c->layout.friction_row_begin + c->system->contact_friction_row[contact];
  for (int k = 0; k < 3; k++)
    out[k] = about ? rows[2] * N[k] + rows[3] * t[k] + rows[4] * t[3 + k] : rows[0] * t[k] + rows[1] * t[3 + k];
}

/* Friction, torque and slip of a contact. */
static void mg_record_contact_friction(mg_context *c, mg_record *record, int row, int contact) {
  const long k = 3 * ((long)row * c->system->n_contact + contact);
  const int rows = mg_is_on_feature_pair(c, contact) ? c->kernels->contact_kinds[c->contacts.kind[contact]].rows : 1;
  for (int j = 0; j < 3; j++) record->friction[k + j] = record->torque[k + j] = record->slip[k + j] = 0;
  if (rows > 1) mg_friction_rows_vector(c, contact, c->solution.force, 0, record->friction + k);
  if (rows > 3) mg_friction_rows_vector(c, contact, c->solution.force, 1, record->torque + k);
  if (rows > 1 && c->run->closed[contact]) mg_friction_rows_vector(c, contact, c->rows.d_dot, 0, record->slip + k);
}

/* Wrench of a joint on its second body, and its coordinates. */
static void mg_record_joint(mg_context *c, mg_record *record, int row, int joint) {
  const mg_system *s = c->system;
  const long k = (long)row * s->n_joint + joint;
  const int kind = s->joint_kind[joint];
  mg_real *coordinate = record->coordinate + 3 * k;
  mg_joint_wrench(c, joint, record->joint_wrench + 6 * k);
  for (int j = 0; j < 3; j++) coordinate[j] = (mg_real)NAN;
  if (!c->kernels->joint_kinds[kind].n_coordinates) return;
  c->kernels->joint_coordinates(kind, c->bodies.pose + 12 * s->joint_a[joint], c->bodies.pose + 12 * s->joint_b[joint],
                                s->parameters + s->joint_parameters[joint], coordinate);
}

/* Friction of the patch in a slot at a world point, and the slip there (8 numbers). */
static void mg_record_patch_friction(const mg_context *c, int slot, const mg_real *at, mg_real *out) {
  const int support = mg_first_support(c, slot);
  const mg_real *t = c->rows.tangents + 6 * support, *N = c->rows.normal + 3 * support;
  mg_real point[3], turn[3], moment[3];
  for (int k = 0; k < 8; k++) out[k] = 0;
  if (mg_patch_of_slot(c, slot) < 0 || !mg_has_patch_friction(c, mg_patch_of_slot(c, slot))) return;
  const mg_real *force = c->solution.force + mg_first_patch_friction_row(c, slot),
                *slip = c->rows.d_dot + mg_first_patch_friction_row(c, slot);
  mg_support_world_point(c, support, point);
  for (int k = 0; k < 3; k++) {
    out[k] = force[0] * t[k] + force[1] * t[3 + k], out[4 + k] = slip[0] * t[k] + slip[1] * t[3 + k];
    turn[k] = slip[2] * N[k], point[k] = at[k] - point[k];
  }
  mg_cross_product(point, out, moment);
  out[3] = force[2] - mg_dot3(moment, N), out[7] = slip[2];
  mg_cross_product(turn, point, moment);
  for (int k = 0; k < 3; k++) out[4 + k] += moment[k];
}

/* Resultant and centre of the pressure of the patch in a slot, and its friction. */
static void mg_record_patch(mg_context *c, mg_record *record, int row, int slot) {
  const long k = (long)row * c->system->n_patch_slot + slot;
  mg_real *pressure = record->pressure + 4 * k;
  record->patch[k] = mg_patch_of_slot(c, slot);
  for (int j = 0; j < 4; j++) pressure[j] = j ? (mg_real)NAN : 0;
  if (record->patch[k] >= 0) pressure[0] = mg_support_resultant(c, slot, c->solution.force, pressure + 1);
  mg_record_patch_friction(c, slot, pressure + 1, record->patch_friction + 8 * k);
}

/* Shares of the pairs in the patches that rest. */
static void mg_record_shares(mg_context *c, mg_real *share) {
  const mg_system *s = c->system;
  if (!s->n_patch) return;
  mg_zero_reals(share, s->patch_share[s->n_patch]);
  for (int slot = 0; slot < s->n_patch_slot; slot++) {
    const int patch = mg_patch_of_slot(c, slot);
    if (patch < 0 || s->patch_share[patch] == s->patch_share[patch + 1]) continue;
    if (mg_find_patch_shares(c, slot, c->solution.force) == MG_SHARES_OVERLAP)
      mg_report_overlapping_patch(c->run, patch);
    for (int k = s->patch_share[patch]; k < s->patch_share[patch + 1]; k++)
      share[k] = mg_share_force(c, slot, k - s->patch_share[patch], c->solution.force);
  }
}

/* Energy of the state x. */
static mg_real mg_energy_at(mg_context *c, mg_real *x) {
  mg_real *kept = c->run->x, kinetic;
  c->run->x = x;
  const mg_real energy = mg_energy(c, &kinetic);
  c->run->x = kept;
  return energy;
}

MG_INTERNAL void mg_record_sample(mg_context *c, mg_record *record, mg_real *x) {
  MG_NEEDS_AT(c, MG_VALID_POSES, x), MG_NEEDS_AT(c, MG_VALID_ROWS, x);
  const mg_system *s = c->system;
  const long row = record->count++;
  const mg_real *eta = x + s->n_q + s->n_u;
  mg_copy_reals(record->pose + row * 12 * s->n_body, c->bodies.pose, 12 * s->n_body);
  mg_copy_reals(record->twist + row * 6 * s->n_body, c->bodies.twist, 6 * s->n_body);
  mg_copy_reals(record->eta + row * s->n_eta, eta, s->n_eta);
  for (int k = 0; k < 2 * mg_slot_count(s); k++)
    record->slot_balls[2 * row * mg_slot_count(s) + k] = c->run->slot_balls[k];
  for (int i = 0; i < s->n_contact; i++) mg_record_contact(c, record, (int)row, i, eta + s->contact_eta[i]);
  for (int i = 0; i < s->n_contact; i++) mg_record_contact_friction(c, record, (int)row, i);
  for (int i = 0; i < s->n_patch_slot; i++) mg_record_patch(c, record, (int)row, i);
  mg_record_shares(c, record->patch_share + (long)row * (s->n_patch ? s->patch_share[s->n_patch] : 0));
  for (int i = 0; i < s->n_joint; i++) mg_record_joint(c, record, (int)row, i);
  mg_read_sensors(c, record->t[row], eta, c->solution.force, 1, record->sensors + row * c->kernels->n_sensor);
  record->energy[row] = mg_energy_at(c, x);
  record->work[row] = x[c->layout.work_state];
  if (record->empty && record->count == record->capacity) record->empty(record);
}

MG_INTERNAL int mg_is_sample_due(const mg_record *record, mg_real t) {
  return record->count < record->capacity && record->t[record->count] <= t;
}

/* True if a sample is due before t, or at t unless an event is there. */
static int mg_is_sample_within(const mg_record *record, mg_real t, int is_event) {
  return mg_is_sample_due(record, t) && !(is_event && record->t[record->count] == t);
}

MG_INTERNAL void mg_record_until(mg_context *c, mg_record *record, mg_real h, int is_event) {
  const mg_real t = c->run->t;
  if (!mg_is_sample_within(record, t + h, is_event)) return;
  const mg_real work = c->step.work; /* samples are no work of the step */
  mg_finish_step(c, t, h);
  mg_make_interpolant(c, t, c->run->x, h);
  while (mg_is_sample_within(record, t + h, is_event)) {
    const mg_real theta = (record->t[record->count] - t) / h;
    mg_interpolate(c, c->run->x, theta, c->step.stage);
    mg_normalise_quaternions(c, c->step.stage);
    mg_right_hand_side(c, t + theta * h, c->step.stage, c->step.slopes + 16 * c->layout.n_states);
    mg_record_sample(c, record, c->step.stage);
  }
  c->step.work = work;
}

MG_INTERNAL void mg_record_now(mg_context *c, mg_record *record) {
  MG_REQUIRE(!mg_is_sample_due(record, c->run->t) || MG_IS_AT(c, MG_VALID_ROWS, c->valid.t, c->run->x));
  while (mg_is_sample_due(record, c->run->t)) mg_record_sample(c, record, c->run->x);
}
