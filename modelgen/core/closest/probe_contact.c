/* The probe contact, on which closest points of any feature pair are sought without a contact of the run. Writes its
   entries of c->contacts and c->search.placement. */
#include "closest/closest.h"
#include "model/model.h"

MG_INTERNAL int mg_use_probe_contact(mg_context *c, int feature_pair) {
  mg_place_on_feature_pair(c, c->system->n_contact, feature_pair);
  return c->system->n_contact;
}

/* Limits of the change of each entry of eta in one step. */
static void mg_eta_step_limit(const mg_context *c, int feature_pair, mg_real *reach) {
  mg_eta_scale(c, feature_pair, mg_pair_length(c, c->system->feature_pair_owner[feature_pair]), reach);
  for (int side = 0; side < 2; side++) {
    const int parametrisation = mg_parametrisation(c, feature_pair, side), n = mg_parametrisation_size[parametrisation];
    const int signs = parametrisation == MG_SIGN ? 1 : parametrisation == MG_SIGNED_CURVE ? 2 : 0;
    for (int k = 0; k < n; k++, reach++)
      *reach = k >= n - signs ? MG_MAX
                              : *reach *
                                    (parametrisation == MG_LOCAL  ? 2
                                     : parametrisation == MG_TURN ? 16
                                                                  : 1) /
                                    4;
  }
}

/* Shapes and poses of a contact. */
static mg_shape_pair mg_shape_pair_of(const mg_context *c, int contact) {
  const mg_shape_pair shape_pair = {c->kernels, c->contacts.kind[contact], c->bodies.pose + 12 * c->contacts.o[contact],
                                    c->bodies.pose + 12 * c->contacts.f[contact],
                                    c->system->parameters + c->contacts.parameters[contact]};
  return shape_pair;
}

MG_INTERNAL int mg_converge_from_any_start(mg_context *c, int feature_pair, mg_real *eta) {
  const int probe = mg_use_probe_contact(c, feature_pair);
  const mg_shape_pair p = mg_shape_pair_of(c, probe);
  mg_real reach[MG_MAX_ETA];
  int steps;
  const mg_newton_goal goal = {c->contacts.length[probe], c->settings->extremality_residual, reach};
  mg_eta_step_limit(c, feature_pair, reach);
  if (p.kernels->contact_kinds[p.kind].is_convex)
    steps = mg_closest_convex(&p, &goal, 0, eta, c->search.placement) == MG_CLOSEST_NOT_FOUND ? -1 : 0;
  else steps = mg_damped_newton(&p, &goal, eta, c->search.placement);
  MG_NOTE_PLACEMENT(c, probe, eta);
  return steps;
}
