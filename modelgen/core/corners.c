/* Touching contacts that come to the end of an edge: there a vertex is on an edge or on another vertex, and no normal is
   told. What follows is told a moment later. */
#include "core.h"

MG_INTERNAL int mg_is_pointed(const mg_context *c, int link) { return mg_dimension(c, link, 0) + mg_dimension(c, link, 1) < 2; }

/* The bodies as they will be in a moment, by the slope in K[0]; the state is in c->x_stage. */
MG_INTERNAL void mg_look_ahead(mg_context *c) {
  const mg_real moment = sqrt(c->set->event) * c->sys->time;
  for (int i = 0; i < c->n_x; i++) c->x_stage[i] = c->run->x[i] + moment * c->K[i];
  mg_poses(c, c->run->t + moment, c->x_stage);
}

/* In a moment the conditions of what was found hold no longer. */
MG_INTERNAL int mg_goes_off(mg_context *c, const mg_found *found) {
  mg_real eta[6], next[6];
  int which;
  const int spare = mg_probe(c, found->link);
  for (int k = 0; k < 6; k++) eta[k] = found->eta[k];
  mg_place(c, spare, eta, next);
  const mg_real now = mg_worst_condition(c, found->link, eta, &which);
  mg_look_ahead(c);
  const mg_real then = mg_settle_in(c, spare, eta) < 0 ? -MG_MAX : mg_worst_condition(c, found->link, eta, &which);
  mg_poses(c, c->run->t, c->run->x);
  return then < 0 && then < now;
}

/* Its point of one of the bodies touches the other already: that it is below another face there is no matter. */
MG_INTERNAL int mg_touches_there(mg_context *c, const mg_found *found) {
  const mg_real near = c->set->apart * c->sys->length;
  const int pair = c->sys->link_pair[found->link];
  mg_real eta[6];
  mg_found other;
  for (int i = mg_first_contact(c, pair); i < mg_first_contact(c, pair + 1); i++) {
    if (!c->run->closed[i]) continue;
    mg_place(c, i, mg_eta_of(c, c->run->x, i), eta);
    other.link = c->run->link[i];
    mg_note_place(c, &other);
    mg_real first = 0, second = 0;
    for (int k = 0; k < 3; k++) {
      const mg_real apart = found->point[k] - other.point[k], across = found->d * found->normal[k] - other.d * other.normal[k];
      first += apart * apart, second += (apart + across) * (apart + across);
    }
    if (first < near * near || second < near * near) return 1;
  }
  return 0;
}

/* Around a vertex that is on an edge: the link with the least gap of those whose conditions will hold in a moment, or -1.
   `at` is where the contact is. */
static int mg_link_around(mg_context *c, int from, int corner, const mg_real *at) {
  mg_real least = c->set->apart * c->sys->length, eta[6];
  int best = -1, which;
  mg_look_ahead(c);
  for (int k = c->sys->link_condition[corner]; k < c->sys->link_condition[corner + 1]; k++) {
    const int to = c->sys->condition_next[k];
    if (to < 0 || to == from || mg_is_pointed(c, to) || mg_is_covered(c, to)) continue;
    if (mg_step_over(c, from, to, at, eta, &which) < -c->set->border || !(fabs(c->place[0]) < least)) continue;
    least = fabs(c->place[0]), best = to;
  }
  mg_poses(c, c->run->t, c->run->x);
  return best;
}

/* From a link over a corner, where they touch, to another; returns 0 where there is none. */
MG_INTERNAL int mg_pass_corner(mg_context *c, int from, int corner, const mg_real *at, mg_found *found) {
  int which;
  const int to = mg_link_around(c, from, corner, at);
  if (to < 0 || mg_step_over(c, from, to, at, found->eta, &which) == -MG_MAX) return 0;
  found->link = to;
  mg_note_place(c, found);
  return 1;
}
