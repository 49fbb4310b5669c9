/* closest/singularities */
#include "closest/closest.h"
#include "model/model.h"

/* The bodies as they will be in a moment, by the slope in K[0]; the state is in c->step.stage. */
MG_INTERNAL void mg_extrapolate_poses(mg_context *c) {
  const mg_real moment = sqrt(c->settings->event) * c->system->time;
  for (int i = 0; i < c->n_states; i++) c->step.stage[i] = c->run->x[i] + moment * c->step.slopes[i];
  mg_update_poses(c, c->run->t + moment, c->step.stage);
}

/* In a moment the conditions of what was found hold no longer. */
MG_INTERNAL int mg_is_about_to_leave_link(mg_context *c, const mg_minimum *found) {
  mg_real eta[6], next[6];
  int which;
  const int spare = mg_use_spare_contact(c, found->link);
  for (int k = 0; k < 6; k++) eta[k] = found->eta[k];
  mg_place_contact(c, spare, eta, next);
  const mg_real now = mg_most_violated_condition(c, found->link, eta, &which);
  mg_extrapolate_poses(c);
  const mg_real then =
      mg_newton_on_link(c, spare, eta) < 0 ? -MG_MAX : mg_most_violated_condition(c, found->link, eta, &which);
  mg_update_poses(c, c->run->t, c->run->x);
  return then < 0 && then < now;
}

static int mg_is_bent(const mg_context *c, int link, int side) {
  const int carrier = mg_parametrisation(c, link, side);
  return carrier == MG_CURVE || carrier == MG_SIGNED_CURVE;
}

/* Edges of solids that cross, not both straight. */
MG_INTERNAL int mg_is_curved_crossing(const mg_context *c, int link) {
  if (mg_side_dimension(c, link, 0) != 1 || mg_side_dimension(c, link, 1) != 1 || mg_has_no_outside(c, link)) return 0;
  return mg_is_bent(c, link, 0) || mg_is_bent(c, link, 1);
}

/* The margin at which a contact ends: of a closed crossing it is of the size of what is left of the chord, squared. */
MG_INTERNAL mg_real mg_end_margin(const mg_context *c, int contact) {
  const int crossing = c->run->closed[contact] && mg_is_curved_crossing(c, c->run->link[contact]);
  return crossing ? c->settings->lost : c->settings->margin_refuse;
}

/* A closed contact too near to where its extremum is lost, unless it has just come from there. */
MG_INTERNAL int mg_is_singular(const mg_context *c, int contact) {
  const mg_real margin = c->run->margin[contact];
  if (!c->run->closed[contact] || c->run->fresh[contact] || margin >= c->settings->margin_refuse) return 0;
  return !(margin >= mg_end_margin(c, contact));
}
