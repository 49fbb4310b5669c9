/* What bounds each grip of the closed contacts, as cones of the problem of friction. */
#include "forces/forces.h"
#include "solve/friction/solvers.h"

MG_INTERNAL void mg_bound_all(mg_context *c) {
  for (int i = 0; i < c->sys->n_contact; i++)
    for (int g = c->sys->contact_grip[i]; g < c->sys->contact_grip[i + 1]; g++) {
      int *mode = c->run->grip + g;
      if (c->run->closed[i] && *mode == MG_LOOSE) *mode = MG_STUCK;
      c->bound_of[g] = *mode >= MG_ONSET ? MG_KNOWN : MG_STATIC;
    }
}

/* Where the bound of an aspect stands in the cone of its contact. */
MG_INTERNAL int mg_cone_at(int aspect) { return aspect == MG_SLIP ? 0 : 1 + aspect; }

MG_INTERNAL void mg_put_bound(const mg_context *c, int grip, const mg_real *mu, mg_real part, mg_real *cone) {
  const int aspect = c->sys->grip_aspect[grip];
  cone[mg_cone_at(aspect)] = part * mu[2 * grip];
  if (aspect == MG_SLIP) cone[1] = part * mu[2 * grip + 1];
}

/* The bounds of one contact of the problem, times `part`. A stuck grip that has reached its own is tried with less. */
MG_INTERNAL void mg_put_cone(const mg_context *c, int contact, mg_real part, mg_real *cone) {
  for (int k = 0; k < MG_CONE; k++) cone[k] = 0;
  for (int g = c->sys->contact_grip[contact]; g < c->sys->contact_grip[contact + 1]; g++) {
    const mg_real *mu = c->bound_of[g] == MG_STATIC ? c->sys->grip_static : c->sys->grip_kinetic;
    if (c->bound_of[g] == MG_KNOWN) continue;
    mg_put_bound(c, g, mu, c->slipped[g] ? part * (1 - c->set->cone) : part, cone);
  }
}

static int mg_is_open_question(const mg_context *c, int contact) {
  for (int g = c->sys->contact_grip[contact]; g < c->sys->contact_grip[contact + 1]; g++)
    if (c->bound_of[g] != MG_KNOWN) return 1;
  return 0;
}

/* Appends the rows of a contact to c->list of `size`, as contact k of the problem; returns the new size. */
MG_INTERNAL int mg_put_contact(mg_context *c, int contact, int k, int size) {
  c->cone_contact[k] = contact, c->cone_first[k] = size;
  c->cone_rows[k] = mg_is_open_question(c, contact) ? c->kernels->contact_kinds[c->kind[contact]].rows : 1;
  c->list[size++] = contact;
  for (int r = 1; r < c->cone_rows[k]; r++) c->list[size++] = c->below + c->sys->contact_below[contact] + r - 1;
  return size;
}
