/* What bounds each grip of the closed contacts, as cones of the problem of friction. */
#include "forces/forces.h"
#include "solve/friction/solvers.h"

MG_INTERNAL void mg_update_friction_bounds(mg_context *c) {
  for (int i = 0; i < c->system->n_contact; i++)
    for (int g = c->system->contact_grip[i]; g < c->system->contact_grip[i + 1]; g++) {
      int *mode = c->run->grip + g;
      if (c->run->closed[i] && *mode == MG_FRICTION_OFF) *mode = MG_STICKING;
      c->friction.bound[g] = *mode >= MG_SLIP_ONSET ? MG_BOUND_SLIP : MG_BOUND_STATIC;
    }
}

/* Where the bound of an aspect stands in the cone of its contact. */
MG_INTERNAL int mg_cone_index(int aspect) { return aspect == MG_SLIP ? 0 : 1 + aspect; }

MG_INTERNAL void mg_write_bound(const mg_context *c, int grip, const mg_real *mu, mg_real part, mg_real *cone) {
  const int aspect = c->system->grip_aspect[grip];
  cone[mg_cone_index(aspect)] = part * mu[2 * grip];
  if (aspect == MG_SLIP) cone[1] = part * mu[2 * grip + 1];
}

/* The bounds of one contact of the problem, times `part`. A stuck grip that has reached its own is tried with less. */
MG_INTERNAL void mg_write_cone(const mg_context *c, int contact, mg_real part, mg_real *cone) {
  for (int k = 0; k < MG_CONE; k++) cone[k] = 0;
  for (int g = c->system->contact_grip[contact]; g < c->system->contact_grip[contact + 1]; g++) {
    const mg_real *mu = c->friction.bound[g] == MG_BOUND_STATIC ? c->system->grip_static : c->system->grip_kinetic;
    if (c->friction.bound[g] == MG_BOUND_SLIP) continue;
    mg_write_bound(c, g, mu, c->friction.triggered[g] ? part * (1 - c->settings->cone) : part, cone);
  }
}

static int mg_is_open_question(const mg_context *c, int contact) {
  for (int g = c->system->contact_grip[contact]; g < c->system->contact_grip[contact + 1]; g++)
    if (c->friction.bound[g] != MG_BOUND_SLIP) return 1;
  return 0;
}

/* Appends the rows of a contact to c->lcp.rows of `size`, as contact k of the problem; returns the new size. */
MG_INTERNAL int mg_append_contact_rows(mg_context *c, int contact, int k, int size) {
  c->friction.cone_contact[k] = contact, c->friction.cone_first[k] = size;
  c->friction.cone_rows[k] = mg_is_open_question(c, contact) ? c->kernels->contact_kinds[c->kind[contact]].rows : 1;
  c->lcp.rows[size++] = contact;
  for (int r = 1; r < c->friction.cone_rows[k]; r++)
    c->lcp.rows[size++] = c->friction_row_begin + c->system->contact_below[contact] + r - 1;
  return size;
}
