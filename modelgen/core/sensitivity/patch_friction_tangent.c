/* Derivatives of the friction of a slipping patch, of the bound of a sticking one, and of its slip. The face of o is a
   whole plane and the pressure nowhere zero: then a unit force on each support has a pressure of its own, whose
   friction depends on the slip alone, in axes of the hull, which are fixed in f. The derivative of the friction matrix
   by the twist is taken by differences of order 6. Reads the state evaluated last and s->at. */
#include "sensitivity/sensitivity.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

#define MG_DIFFERENCES 3 /* central differences of a derivative of order 6, steps 1, 2, 3 */

static const mg_real mg_difference_weight[] = {(mg_real)3 / 4, (mg_real)-3 / 20, (mg_real)1 / 60};

#define MG_HARDLY_TURNS \
  ((mg_real)1 / 40) /* spin, of slip: up to it friction is smooth in the twist on the length of slip */

/* Step of these differences, relative to the twist: the best one of a smooth function, and a shorter one where friction
   depends on the place of the rotation centre. */
static mg_real mg_difference_step(mg_real slip, mg_real turn) {
  return mg_pow(MG_EPS, turn <= MG_HARDLY_TURNS * slip ? (mg_real)1 / 7 : (mg_real)0.18);
}

MG_INTERNAL int mg_slot_of_support(const mg_context *c, int contact) {
  return contact >= c->layout.support_begin ? (contact - c->layout.support_begin) / 3 : -1;
}

/* True if a patch slips without spin, but for rounding. Needs the velocities of the rows. */
static int mg_is_patch_translated(const mg_context *c, int slot) {
  MG_NEEDS_WITH(c, MG_VALID_SLIP, MG_VALID_TWISTS);
  const mg_real *slip = c->rows.d_dot + mg_first_patch_friction_row(c, slot);
  return fabs(slip[2]) * mg_support_radius(c, slot) <= MG_ROUNDED_TANGENT * sqrt(mg_dot2(slip, slip));
}

MG_INTERNAL int mg_is_patch_slip_known(const mg_context *c, int slot) {
  MG_NEEDS_WITH(c, MG_VALID_SLIP, MG_VALID_TWISTS);
  const mg_patch_friction *r = c->patches.friction + slot;
  if (!mg_is_whole_plane(c, mg_patch_of_slot(c, slot)) || r->place) return 0;
  return (!r->partly_unloaded || mg_is_patch_translated(c, slot)) && c->run->patch_mode[slot] != MG_SLIP_ONSET;
}

MG_INTERNAL void mg_friction_matrix_dot(const mg_winkler_pressure_field *p, const mg_real *twist,
                                        const mg_real *twist_dot, mg_real G_dot[3][3]) {
  const mg_real slip = sqrt(mg_dot2(twist, twist)), turn = fabs(twist[2]) * p->reach,
                change = sqrt(mg_dot2(twist_dot, twist_dot)) + fabs(twist_dot[2]) * p->reach;
  mg_zero_reals(G_dot[0], 9);
  if (!(change > 0)) return;
  const mg_real part = mg_difference_step(slip, turn) * (slip + turn) / change;
  for (int step = 1; step <= MG_DIFFERENCES; step++)
    for (int side = -1; side <= 1; side += 2) {
      mg_real moved[3], G[3][3];
      for (int k = 0; k < 3; k++) moved[k] = twist[k] + side * step * part * twist_dot[k];
      mg_friction_matrix(p, moved, G);
      for (int k = 0; k < 9; k++) G_dot[k / 3][k % 3] += side * mg_difference_weight[step - 1] / part * G[k / 3][k % 3];
    }
}

MG_INTERNAL void mg_hull_axes_in_f(const mg_context *c, int slot, const mg_patch_frame *at, mg_real local[2][3]) {
  const int f = mg_patch_body(c, mg_patch_of_slot(c, slot), 1);
  for (int k = 0; k < 2; k++) mg_rotate_back(c->bodies.pose + 12 * f + 3, at->pose + 3 + 3 * k, local[k]);
}

/* Derivatives of t1 and t2 in the axes of the hull. */
static void mg_patch_frame_tangent(const mg_context *c, const mg_sensitivity *s, int slot, const mg_patch_frame *at,
                                   mg_real t_dot[2][2]) {
  const mg_real *tangents_dot = s->at.tangents + 6 * slot;
  const int support = mg_first_support(c, slot), f = mg_patch_body(c, mg_patch_of_slot(c, slot), 1);
  mg_real local[2][3], axis_dot[3];
  mg_hull_axes_in_f(c, slot, at, local);
  for (int k = 0; k < 2; k++) {
    mg_to_world(s->at.pose + 12 * f, local[k], 0, axis_dot);
    for (int i = 0; i < 2; i++)
      t_dot[i][k] = mg_dot3(axis_dot, c->rows.tangents + 6 * support + 3 * i) +
                    mg_dot3(at->pose + 3 + 3 * k, tangents_dot + 3 * i);
  }
}

/* Derivative of the slip of the first support of a patch whose direction is stored, and is that in their middle. */
static void mg_stored_slip_tangent(const mg_context *c, const mg_sensitivity *s, int slot, const mg_real *slip,
                                   mg_real *slip_dot) {
  const int support = mg_first_support(c, slot), f = c->contacts.f[support];
  const mg_real *along = c->run->patch_slip_direction + 4 * slot, *t = c->rows.tangents + 6 * support,
                *t_dot = s->at.tangents + 6 * slot;
  mg_real local[3], arm[3], arm_dot[3];
  mg_middle_of_supports(c, slot, local);
  mg_to_world(c->bodies.pose + 12 * f, local, 0, arm);
  mg_to_world(s->at.pose + 12 * f, local, 0, arm_dot);
  slip_dot[0] = mg_dot3(along, t_dot) + slip[2] * (mg_dot3(arm_dot, t + 3) + mg_dot3(arm, t_dot + 3));
  slip_dot[1] = mg_dot3(along, t_dot + 3) - slip[2] * (mg_dot3(arm_dot, t) + mg_dot3(arm, t_dot));
  slip_dot[2] = 0;
}

MG_INTERNAL void mg_patch_slip_tangent(mg_context *c, mg_sensitivity *s, int direction, int slot) {
  MG_NEEDS_TANGENT(c, s, MG_VALID_ROW_TANGENTS, MG_VALID_TWISTS, direction, mg_first_support(c, slot));
  const int patch = mg_patch_of_slot(c, slot), row = mg_first_patch_friction_row(c, slot),
            support = mg_first_support(c, slot);
  const mg_real mu = c->system->patch_friction[2 * patch + 1],
                mu_dot =
                    mg_number_dot(s, s->directions->patch_friction, 2L * c->system->n_patch, direction, 2 * patch + 1);
  mg_patch_slip p;
  mg_real t_dot[2][2], slip_dot[3], twist_dot[3], G_dot[3][3], *sum = s->at.ratio + row - c->layout.friction_row_begin;
  mg_find_patch_slip(c, slot, &p);
  mg_patch_frame_tangent(c, s, slot, &p.at, t_dot);
  if (p.turned)
    for (int k = 0; k < 3; k++) slip_dot[k] = p.turned * s->at.rate[row + k];
  else mg_stored_slip_tangent(c, s, slot, p.slip, slip_dot);
  twist_dot[2] = p.at.sign * slip_dot[2];
  for (int k = 0; k < 2; k++) {
    twist_dot[k] = (k ? p.offset[0] : -p.offset[1]) * twist_dot[2];
    for (int i = 0; i < 2; i++) twist_dot[k] += slip_dot[i] * p.at.t[i][k] + p.slip[i] * t_dot[i][k];
  }
  mg_friction_matrix_dot(&c->patches.pressure, p.twist, twist_dot, G_dot);
  for (int k = 0; k < MG_PATCH_ROWS; k++) sum[k] = 0;
  for (int i = 0; i < 3; i++) {
    const mg_real N = c->solution.force[support + i], *level = p.level[i], *force = p.force[i];
    mg_real dot[3];
    for (int k = 0; k < 3; k++)
      dot[k] = mu_dot / mu * force[k] + mu * (G_dot[k][0] * level[0] + G_dot[k][1] * level[1] + G_dot[k][2] * level[2]);
    for (int k = 0; k < 2; k++) sum[k] += N * (mg_dot2(t_dot[k], force) + mg_dot2(p.at.t[k], dot));
    sum[2] += N * p.at.sign * (dot[2] + mg_cross2(p.offset, dot));
  }
}

/* The bound is the least, over the twists t that slip may start with, of what friction may dissipate less what it does:
   its derivatives are those with the least t held. */
MG_INTERNAL void mg_patch_bound_gradient(mg_context *c, int slot, mg_real *by_force, mg_real *by_mu) {
  const mg_real *N = c->solution.force + mg_first_support(c, slot),
                *mu = c->system->patch_friction + 2 * mg_patch_of_slot(c, slot), sum = N[0] + N[1] + N[2];
  mg_patch_slip p;
  mg_real twist[3], dissipates[3], most = 0;
  mg_patch_friction_margin(c, slot, twist);
  for (int k = 0; k < 3; k++) p.slip[k] = twist[k];
  mg_find_patch_friction(c, slot, &p);
  for (int i = 0; i < 3; i++) {
    dissipates[i] = p.at.sign * (p.force[i][2] + mg_cross2(p.offset, p.force[i])) * twist[2];
    for (int k = 0; k < 2; k++) dissipates[i] += mg_dot2(p.at.t[k], p.force[i]) * twist[k];
    dissipates[i] /= mu[1], most += N[i] * dissipates[i];
  }
  for (int i = 0; i < 3; i++) by_force[i] = sum * dissipates[i] / most;
  for (int k = 0; k < 3; k++) by_force[3 + k] = sum * twist[k] / (mu[0] * most);
  *by_mu = sum / mu[0];
}

MG_INTERNAL mg_real mg_patch_bound_tangent(mg_context *c, const mg_sensitivity *s, int direction, int slot) {
  const int support = mg_first_support(c, slot), row = mg_first_patch_friction_row(c, slot),
            patch = mg_patch_of_slot(c, slot);
  const mg_real mu_dot = mg_number_dot(s, s->directions->patch_friction, 2L * c->system->n_patch, direction, 2 * patch);
  mg_patch_frame at;
  mg_real dot[6], t_dot[2][2], by_force[6], by_mu;
  mg_set_patch_frame(c, slot, &at);
  mg_patch_frame_tangent(c, s, slot, &at, t_dot);
  for (int k = 0; k < 3; k++) dot[k] = s->at.force[support + k], dot[3 + k] = s->at.force[row + k];
  for (int k = 0; k < 2; k++) /* t1 and t2 turn in the hull */
    for (int l = 0; l < 2; l++)
      for (int i = 0; i < 2; i++) dot[3 + k] += at.t[k][l] * t_dot[i][l] * c->solution.force[row + i];
  mg_patch_bound_gradient(c, slot, by_force, &by_mu);
  mg_real change = by_mu * mu_dot;
  for (int k = 0; k < 6; k++) change += by_force[k] * dot[k];
  return change;
}
