/* Friction cones of the closed contacts: what bounds each friction constraint of the friction problem, and its
   coefficients. Reads coefficients and modes; writes the cones, bound kinds and row lists of the friction
   workspace, and sets the mode of groups that had none. */
#include "forces/forces.h"
#include "model/model.h"
#include "solve/friction/friction_solvers.h"

MG_INTERNAL void mg_set_friction_bound_kinds(mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++) {
      if (c->run->closed[i] && c->run->friction_mode[g] == MG_FRICTION_OFF) mg_set_friction_mode(c, g, MG_STICKING);
      c->friction.bound[g] = c->run->friction_mode[g] >= MG_SLIP_ONSET ? MG_BOUND_SLIP : MG_BOUND_STATIC;
    }
}

MG_INTERNAL int mg_cone_index_of_kind(int friction_kind) {
  return friction_kind == MG_FRICTION_SLIP ? 0 : 1 + friction_kind;
}

MG_INTERNAL void mg_set_cone_coefficients(const mg_context *c, int constraint, const mg_real *mu, mg_real part,
                                          mg_real *cone) {
  const int friction_kind = c->system->friction_kind[constraint];
  cone[mg_cone_index_of_kind(friction_kind)] = part * mu[2 * constraint];
  if (friction_kind == MG_FRICTION_SLIP) cone[1] = part * mu[2 * constraint + 1];
}

MG_INTERNAL void mg_set_friction_cone(const mg_context *c, int contact, mg_real part, mg_real *cone) {
  for (int k = 0; k < MG_CONE; k++) cone[k] = 0;
  for (int g = c->system->contact_friction[contact]; g < c->system->contact_friction[contact + 1]; g++) {
    const mg_real *mu =
        c->friction.bound[g] == MG_BOUND_STATIC ? c->system->friction_static : c->system->friction_kinetic;
    if (c->friction.bound[g] == MG_BOUND_SLIP) continue;
    mg_set_cone_coefficients(c, g, mu,
                             c->friction.triggered[g] ? part * (1 - c->settings->friction_bound_margin) : part, cone);
  }
}

/* True if the friction force of the contact is an unknown of the problem: not all of its slip is under way. */
static int mg_has_unknown_friction(const mg_context *c, int contact) {
  for (int g = c->system->contact_friction[contact]; g < c->system->contact_friction[contact + 1]; g++)
    if (c->friction.bound[g] != MG_BOUND_SLIP) return 1;
  return 0;
}

MG_INTERNAL int mg_append_friction_contact(mg_context *c, int contact, int k, int size) {
  c->friction.cone_contact[k] = contact, c->friction.cone_first[k] = size;
  c->friction.cone_rows[k] =
      mg_has_unknown_friction(c, contact) ? c->kernels->contact_kinds[c->contacts.kind[contact]].rows : 1;
  c->lcp.rows[size++] = contact;
  for (int r = 1; r < c->friction.cone_rows[k]; r++)
    c->lcp.rows[size++] = c->layout.friction_row_begin + c->system->contact_friction_row[contact] + r - 1;
  return size;
}
