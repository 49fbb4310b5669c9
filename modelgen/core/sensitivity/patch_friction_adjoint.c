/* Adjoint of the derivatives of the friction of a patch (patch_friction_tangent.c), in reverse order. */
#include "sensitivity/sensitivity.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

/* From the cotangents of friction along the rows to those of the friction matrix, of mu, and of t1 and t2. */
static void mg_patch_force_adjoint(const mg_context *c, int slot, const mg_patch_slip *p, const mg_real *bar,
                                   mg_real mu, mg_real G_bar[3][3], mg_real *mu_bar, mg_real t_bar[2][2]) {
  const mg_real *N = c->solution.force + mg_first_support(c, slot);
  for (int i = 0; i < 3; i++) {
    const mg_real *force = p->force[i], turning = p->at.sign * N[i] * bar[2];
    mg_real force_bar[3] = {-p->offset[1] * turning, p->offset[0] * turning, turning};
    for (int k = 0; k < 2; k++)
      for (int l = 0; l < 2; l++)
        force_bar[l] += N[i] * bar[k] * p->at.t[k][l], t_bar[k][l] += N[i] * bar[k] * force[l];
    for (int k = 0; k < 3; k++) {
      *mu_bar += force_bar[k] * force[k] / mu;
      for (int l = 0; l < 3; l++) G_bar[k][l] += mu * force_bar[k] * p->level[i][l];
    }
  }
}

/* From the cotangents of t1 and t2 in the axes of the hull to those of the pose of f and of t1 and t2. */
static void mg_patch_frame_adjoint(const mg_context *c, mg_sensitivity *s, int slot, const mg_patch_frame *at,
                                   mg_real t_bar[2][2]) {
  mg_real *tangents_bar = s->at.tangents + 6 * slot;
  const int f = mg_patch_body(c, mg_patch_of_slot(c, slot), 1);
  const mg_real *tangents = c->rows.tangents + 6 * mg_first_support(c, slot);
  mg_real local[2][3];
  mg_hull_axes_in_f(c, slot, at, local);
  for (int k = 0; k < 2; k++)
    for (int i = 0; i < 2; i++)
      for (int r = 0; r < 3; r++) {
        tangents_bar[3 * i + r] += t_bar[i][k] * at->pose[3 + 3 * k + r];
        for (int column = 0; column < 3; column++)
          s->at.pose[12 * f + 3 + 3 * column + r] += t_bar[i][k] * tangents[3 * i + r] * local[k][column];
      }
}

/* From the cotangents of stored slip to those of the pose of f and of t1 and t2. */
static void mg_stored_slip_adjoint(const mg_context *c, mg_sensitivity *s, int slot, const mg_real *slip,
                                   const mg_real *bar) {
  const int support = mg_first_support(c, slot), f = c->contacts.f[support];
  const mg_real *along = c->run->patch_slip_direction + 4 * slot, *t = c->rows.tangents + 6 * support;
  mg_real *t_bar = s->at.tangents + 6 * slot, local[3], arm[3];
  mg_middle_of_supports(c, slot, local);
  mg_to_world(c->bodies.pose + 12 * f, local, 0, arm);
  for (int k = 0; k < 3; k++) {
    t_bar[k] += bar[0] * along[k] - bar[1] * slip[2] * arm[k];
    t_bar[3 + k] += bar[1] * along[k] + bar[0] * slip[2] * arm[k];
    const mg_real arm_bar = slip[2] * (bar[0] * t[3 + k] - bar[1] * t[k]);
    for (int column = 0; column < 3; column++) s->at.pose[12 * f + 3 + 3 * column + k] += arm_bar * local[column];
  }
}

MG_INTERNAL void mg_patch_slip_adjoint(mg_context *c, mg_sensitivity *s, int slot, const mg_real *bar) {
  const int patch = mg_patch_of_slot(c, slot), row = mg_first_patch_friction_row(c, slot);
  mg_patch_slip p;
  mg_real G_bar[3][3] = {{0}}, t_bar[2][2] = {{0}}, twist_bar[3] = {0, 0, 0}, slip_bar[3];
  mg_find_patch_slip(c, slot, &p);
  mg_patch_force_adjoint(c, slot, &p, bar, c->system->patch_friction[2 * patch + 1], G_bar,
                         s->adjoint->patch_friction + 2 * patch + 1, t_bar);
  for (int m = 0; m < 3; m++) {
    const mg_real unit[3] = {m == 0, m == 1, m == 2};
    mg_real G_dot[3][3];
    mg_friction_matrix_dot(&c->patches.pressure, p.twist, unit, G_dot);
    for (int k = 0; k < 9; k++) twist_bar[m] += G_bar[k / 3][k % 3] * G_dot[k / 3][k % 3];
  }
  slip_bar[2] = p.at.sign * (twist_bar[2] - p.offset[1] * twist_bar[0] + p.offset[0] * twist_bar[1]);
  for (int i = 0; i < 2; i++) {
    slip_bar[i] = mg_dot2(p.at.t[i], twist_bar);
    for (int k = 0; k < 2; k++) t_bar[i][k] += p.slip[i] * twist_bar[k];
  }
  for (int k = 0; k < 3 && p.turned; k++) s->at.rate[row + k] += p.turned * slip_bar[k];
  if (!p.turned) mg_stored_slip_adjoint(c, s, slot, p.slip, slip_bar);
  mg_patch_frame_adjoint(c, s, slot, &p.at, t_bar);
}

MG_INTERNAL void mg_patch_slip_rate_adjoint(const mg_context *c, mg_sensitivity *s, int slot, mg_real weight) {
  const int row = mg_first_patch_friction_row(c, slot);
  for (int m = 0; m < 3; m++) {
    const mg_real unit[3] = {m == 0, m == 1, m == 2};
    mg_real e[3], slip[3];
    mg_patch_slip_direction(c, slot, e);
    mg_patch_slip_in_middle(c, slot, unit, slip);
    s->at.rate[row + m] += weight * mg_dot3(slip, e);
  }
}

MG_INTERNAL void mg_patch_bound_adjoint(mg_context *c, mg_sensitivity *s, int slot, mg_real weight) {
  const int support = mg_first_support(c, slot), row = mg_first_patch_friction_row(c, slot);
  mg_patch_frame at;
  mg_real by_force[6], by_mu, t_bar[2][2] = {{0}};
  mg_set_patch_frame(c, slot, &at);
  mg_patch_bound_gradient(c, slot, by_force, &by_mu);
  for (int k = 0; k < 6; k++) s->at.force[k < 3 ? support + k : row + k - 3] += weight * by_force[k];
  for (int k = 0; k < 2; k++)
    for (int l = 0; l < 2; l++)
      for (int i = 0; i < 2; i++) t_bar[i][l] += weight * by_force[3 + k] * at.t[k][l] * c->solution.force[row + i];
  mg_patch_frame_adjoint(c, s, slot, &at, t_bar);
  s->adjoint->patch_friction[2 * mg_patch_of_slot(c, slot)] += weight * by_mu;
}
