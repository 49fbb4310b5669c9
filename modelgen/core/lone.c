/* The commonest scene, one free body in one active contact with a body at rest: the right-hand side with every
   intermediate value in registers. Same kernels, same formulas as rhs.c. */
#include "core.h"

#ifndef MG_LONE
#define MG_LONE 1
#endif

#if defined(__GNUC__)
#define MG_FLATTEN __attribute__((flatten))
#else
#define MG_FLATTEN
#endif

/* The index of the body if the scene is of this kind now, else -1. */
static int mg_lone(const mg_context *c) {
  const mg_system *s = c->sys;
  if (!MG_LONE || s->n_contact != 1 || s->n_row || s->n_load || c->moving != 1 || c->driven || !c->run->active[0]) return -1;
  const int body = c->f[0];
  return mg_body_kinds[mg_kind_of(c, body)].motion == MG_FREE ? body : -1;
}

MG_FLATTEN static void mg_rhs_lone(mg_context *c, int body, const mg_real *x, mg_real *x_dot) {
  const mg_system *s = c->sys;
  const mg_real *q = x + s->body_q[body], *u = x + s->n_q + s->body_u[body], *eta = x + s->n_q + s->n_u;
  const mg_real *mass_inverse = s->mass_inverse + 10 * body, *parameters = s->parameters;
  const int kind = mg_kind_of(c, body);
  mg_real pose[12] = {0}, accel[6] = {0}, J[6] = {0}, none[6], MJ[6], d = 0, gamma = 0, normal[3];
  mg_body_pose(kind, q, pose);
  mg_body_motion(kind, q, u, c->wrench, s->gravity, parameters + s->body_parameters[body], x_dot + s->body_q[body],
                 accel);
  mg_contact_rates(c->kind[0], c->pose + 12 * c->o[0], c->twist + 6 * c->o[0], pose, u, eta,
                   parameters + c->parameters[0], &d, none, J, &gamma, x_dot + s->n_q + s->n_u, normal, 0);
  if (!c->set->use_gamma) gamma = 0;
  mg_weigh_side(mass_inverse, J, MJ);
  const mg_real force = -(mg_dot6(J, accel) + gamma) / mg_dot6(J, MJ);
  mg_real *u_dot = x_dot + s->n_q + s->body_u[body];
  for (int k = 0; k < 6; k++) u_dot[k] = accel[k] + MJ[k] * force;
  for (int k = c->n_eta[0]; k < s->n_eta; k++) x_dot[s->n_q + s->n_u + k] = 0;
  x_dot[c->work_index] = 0;
  c->d[0] = d, c->force[0] = force;
  c->run->rhs_evals++;
}

/* The slope at a stage: forces, gaps and x_dot; only mg_rhs leaves the rows of the contacts behind. */
static void mg_slope(mg_context *c, mg_real t, const mg_real *x, mg_real *x_dot) {
  const int body = mg_lone(c);
  if (body < 0) mg_rhs(c, t, x, x_dot);
  else mg_rhs_lone(c, body, x, x_dot);
}
