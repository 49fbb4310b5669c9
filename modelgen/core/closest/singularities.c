/* Singular contacts (sections 4.1.1, 4.2.2 and 4.3 of Anitescu, Cremer and Potra, 1995): crossings of curved
   edges, the margin at which a contact ends, and minima that are about to leave their feature pairs. Reads the
   poses and margins of the run; mg_extrapolate_poses writes poses a short time ahead. */
#include "closest/closest.h"
#include "model/model.h"

MG_INTERNAL mg_real mg_extrapolate_poses(mg_context *c) {
  const mg_real moment = sqrt(c->settings->event_tolerance) * c->system->time;
  for (int range = 0; range < c->listed.n_range; range++)
    for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++)
      c->step.stage[i] = c->run->x[i] + moment * c->step.slopes[i];
  mg_update_poses(c, c->run->t + moment, c->step.stage);
  return c->run->t + moment;
}

MG_INTERNAL int mg_fate_of_minimum(mg_context *c, const mg_minimum *found) {
  mg_real eta[6], next[6];
  int which;
  const int probe_contact = mg_use_probe_contact(c, found->feature_pair);
  for (int k = 0; k < 6; k++) eta[k] = found->eta[k];
  mg_place_contact(c, probe_contact, eta, next);
  const mg_real now = mg_most_violated_condition(c, found->feature_pair, eta, &which);
  mg_extrapolate_poses(c);
  const int is_lost = mg_newton_on_feature_pair(c, probe_contact, eta) < 0;
  const mg_real then = is_lost ? -MG_MAX : mg_most_violated_condition(c, found->feature_pair, eta, &which);
  mg_update_poses(c, c->run->t, c->run->x);
  return is_lost ? MG_MINIMUM_LOST : then < 0 && then < now ? MG_MINIMUM_LEAVES : MG_MINIMUM_STAYS;
}

/* True if the side of the feature pair is parametrised as a curve. */
static int mg_is_feature_a_curve(const mg_context *c, int feature_pair, int side) {
  const int parametrisation = mg_parametrisation(c, feature_pair, side);
  return parametrisation == MG_CURVE || parametrisation == MG_SIGNED_CURVE;
}

MG_INTERNAL int mg_is_curved_edge_crossing(const mg_context *c, int feature_pair) {
  if (!mg_is_feature_a_curve(c, feature_pair, 0) && !mg_is_feature_a_curve(c, feature_pair, 1)) return 0;
  return mg_feature_dimension(c, feature_pair, 0) == 1 && mg_feature_dimension(c, feature_pair, 1) == 1 &&
         !mg_has_no_outside(c, feature_pair);
}

MG_INTERNAL int mg_is_followed_to_singularity(const mg_context *c, int feature_pair, mg_real d) {
  const int pair = c->system->feature_pair_owner[feature_pair];
  if (!mg_lie_about_spines(c, feature_pair) && !mg_is_almost_coaxial(c, feature_pair)) return 0;
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++)
    if (c->run->closed[i]) return 1;
  return d < c->settings->margin_refuse * mg_pair_length(c, pair);
}

MG_INTERNAL mg_real mg_followed_margin_limit(const mg_context *c, int feature_pair, mg_real d) {
  return mg_is_followed_to_singularity(c, feature_pair, d) ? mg_least_margin(c, feature_pair)
                                                           : c->settings->margin_refuse;
}

MG_INTERNAL mg_real mg_fold_margin_limit(const mg_context *c, int contact) {
  const int feature_pair = c->run->feature_pair[contact], closed = c->run->closed[contact];
  return closed && mg_is_curved_edge_crossing(c, feature_pair)
             ? mg_least_margin(c, feature_pair)
             : mg_followed_margin_limit(c, feature_pair, c->rows.d[contact]);
}

MG_INTERNAL int mg_is_contact_singular(const mg_context *c, int contact) {
  const mg_real margin = c->run->margin[contact];
  if (!c->run->closed[contact] || c->run->rolling_start[contact] || margin >= c->settings->margin_refuse) return 0;
  return !(margin >= mg_fold_margin_limit(c, contact));
}
