/* Singular contacts: crossings of curved edges, the margin at which a contact ends, and minima that are about to leave
   their features. Reads the poses and margins of the run; `mg_extrapolate_poses` writes the poses of a moment ahead. */
#include "closest/closest.h"
#include "model/model.h"

/* Extrapolate the state by a short time with the slope at the run's state and set the poses there. */
MG_INTERNAL void mg_extrapolate_poses(mg_context *c) {
  const mg_real moment = sqrt(c->settings->event) * c->system->time;
  for (int i = 0; i < c->n_states; i++) c->step.stage[i] = c->run->x[i] + moment * c->step.slopes[i];
  mg_update_poses(c, c->run->t + moment, c->step.stage);
}

/* True if the conditions of the minimum's link will be broken a short time later. */
MG_INTERNAL int mg_is_minimum_leaving_link(mg_context *c, const mg_minimum *found) {
  mg_real eta[6], next[6];
  int which;
  const int probe_contact = mg_use_spare_contact(c, found->link);
  for (int k = 0; k < 6; k++) eta[k] = found->eta[k];
  mg_place_contact(c, probe_contact, eta, next);
  const mg_real now = mg_most_violated_condition(c, found->link, eta, &which);
  mg_extrapolate_poses(c);
  const mg_real then =
      mg_newton_on_link(c, probe_contact, eta) < 0 ? -MG_MAX : mg_most_violated_condition(c, found->link, eta, &which);
  mg_update_poses(c, c->run->t, c->run->x);
  return then < 0 && then < now;
}

/* True if the side of the link is parametrised as a curve. */
static int mg_is_side_a_curve(const mg_context *c, int link, int side) {
  const int carrier = mg_parametrisation(c, link, side);
  return carrier == MG_CURVE || carrier == MG_SIGNED_CURVE;
}

/* True if the link is a crossing of two edges of solids that are not both straight. */
MG_INTERNAL int mg_is_curved_edge_crossing(const mg_context *c, int link) {
  if (mg_side_dimension(c, link, 0) != 1 || mg_side_dimension(c, link, 1) != 1 || mg_has_no_outside(c, link)) return 0;
  return mg_is_side_a_curve(c, link, 0) || mg_is_side_a_curve(c, link, 1);
}

/* Margin at which a contact ends at a fold. */
MG_INTERNAL mg_real mg_fold_margin_limit(const mg_context *c, int contact) {
  const int crossing = c->run->closed[contact] && mg_is_curved_edge_crossing(c, c->run->link[contact]);
  return crossing ? c->settings->lost : c->settings->margin_refuse;
}

/* True if a closed contact is too near to where its extremum is lost, unless it starts from there. */
MG_INTERNAL int mg_is_contact_singular(const mg_context *c, int contact) {
  const mg_real margin = c->run->margin[contact];
  if (!c->run->closed[contact] || c->run->fresh[contact] || margin >= c->settings->margin_refuse) return 0;
  return !(margin >= mg_fold_margin_limit(c, contact));
}
