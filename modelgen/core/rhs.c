/* The smooth right-hand side within one mode: the active contacts hold their gap's acceleration at zero, the joints
   that of their rows (2.6). */
#include "core.h"

/* Forces on the active contacts: A force = -(J a + Gamma2), the unconstrained accelerations a in c->accel. */
static void mg_forces(mg_context *c) {
  for (int i = 0; i < c->sys->n_contact; i++)
    if (c->run->active[i]) c->rate[i] = mg_separation(c, i);
  for (int i = c->bilateral; i < c->n_all; i++) c->rate[i] = mg_separation(c, i);
  c->leaning = c->sys->n_grip > 0;
  if (c->leaning) mg_lean_all(c);
  c->rub_rounds = 0;
  int n = mg_hold(c, c->run->active, c->rate, c->force);
  while (c->leaning && mg_rubs_unsettled(c)) n = mg_hold(c, c->run->active, c->rate, c->force);
  for (int r = 0; r < n; r++) mg_add(c, c->list[r], c->force[c->list[r]], c->accel);
  if (c->leaning) mg_add_slipping(c);
  c->leaning = 0;
}

static int mg_is_somewhere(const mg_context *c, int body) {
  return mg_finite(c->pose + 12 * body, 12) && mg_finite(c->twist + 6 * body, 6) && mg_finite(c->accel + 6 * body, 6);
}

/* Whether a driven body is nowhere. */
MG_INTERNAL int mg_a_path_ends(const mg_context *c) {
  for (int b = 0; b < c->sys->n_body && c->driven; b++)
    if (mg_is_driven(c->sys, b) && !mg_is_somewhere(c, b)) return 1;
  return 0;
}

/* Power that driven bodies and given motions put into the moving bodies through contacts and joints; without bounds where a path
   is not finite, though nothing may touch it. */
MG_INTERNAL mg_real mg_driven_power(const mg_context *c) {
  mg_real power = 0;
  if (mg_a_path_ends(c)) return INFINITY;
  for (int i = 0; i < c->sys->n_contact; i++)
    if (c->run->active[i]) power -= c->force[i] * mg_driven_rate(c, i);
  for (int i = c->bilateral; i < c->n_rows; i++) power -= c->force[i] * mg_driven_rate(c, i);
  return power;
}

MG_INTERNAL void mg_rhs(mg_context *c, mg_real t, const mg_real *x, mg_real *x_dot) {
  const mg_system *s = c->sys;
  mg_poses(c, t, x);
  mg_accelerations(c, t, x, x_dot);
  mg_rates(c, x);
  mg_joint_rates(c, t);
  mg_forces(c);
  for (int b = 0; b < s->n_body; b++) mg_copy_u(c, b, c->accel + 6 * b, x_dot + s->n_q + s->body_u[b]);
  for (int k = 0; k < s->n_eta; k++) x_dot[s->n_q + s->n_u + k] = c->eta_dot[k];
  if (c->driven || c->prescribed) x_dot[c->work_index] += mg_driven_power(c);
  if (s->n_grip) x_dot[c->work_index] += mg_slipping_power(c);
  c->run->rhs_evals++;
}

/* d_ddot of one row under the accelerations last computed. */
MG_INTERNAL mg_real mg_separation(const mg_context *c, int contact) { return mg_row(c, contact, c->accel) + c->gamma[contact]; }

MG_API void mg_evaluate(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real t,
                        const mg_real *x, mg_real *x_dot, mg_real *work, int *iwork) {
  mg_context c;
  mg_open(&c, system, settings, run, work, iwork);
  mg_rhs(&c, t, x, x_dot);
  for (int i = 0; i < system->n_contact; i++) run->force[i] = c.force[i];
}
