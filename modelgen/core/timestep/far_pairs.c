/* Pairs of convex shapes that are too far apart to meet within a step are left out of time-stepping in scenes of many
   pairs: their contacts are on no feature pair until the bodies come near. Balls around the centres of mass bound the
   distances, and the velocities at both ends of a step what it can close. Writes the feature pairs of the run. */
#include "timestep/timestep.h"
#include "base/base.h"
#include "model/model.h"
#include "closest/closest.h"

enum {
  MG_FEW_PAIRS = 400, /* a scene with no more pairs follows all of them */
  MG_NEAR_STEPS = 8   /* steps at the present velocities within which near bodies could meet */
};

/* True if the contact of the pair may be left out: the closest points of its shapes are unique, and are found from any
   start. */
static int mg_is_pair_omissible(const mg_context *c, int pair) {
  const mg_system *s = c->system;
  const int first = s->pair_feature_pair[pair];
  if (s->pair_search[pair] != MG_SEARCH_NEVER || s->pair_feature_pair[pair + 1] != first + 1) return 0;
  if (s->contact_feature_pair[s->pair_contact[pair]] != first) return 0;
  const mg_contact_kind *kind = c->kernels->contact_kinds + s->feature_pair_kind[first];
  return (kind->is_convex || kind->n_eta == 0) && mg_has_pair_extents(c, pair);
}

/* Follows the closest points of an omissible pair. Needs the poses. */
static void mg_follow_pair(mg_context *c, int pair) {
  const int feature_pair = c->system->pair_feature_pair[pair], contact = c->system->pair_contact[pair];
  mg_real eta[MG_MAX_ETA] = {0};
  if (mg_converge_from_any_start(c, feature_pair, eta) < 0) return;
  mg_set_feature_pair(c, contact, feature_pair, eta);
  mg_place_contact(c, contact, eta, c->search.placement + 32);
  c->rows.d[contact] = c->search.placement[0], c->run->margin[contact] = mg_placement_margin(c, contact);
}

/* Writes how far each body can move in n steps, by its velocities at both ends of the step. */
static void mg_set_body_reaches(mg_context *c, mg_real h, int n) {
  for (int b = 0; b < c->system->n_body; b++) {
    const mg_real *v = c->bodies.twist + 6 * b, *a = c->bodies.acceleration + 6 * b, *change = c->bodies.wrench + 6 * b;
    const mg_real end[3] = {v[0] + h * a[0] + change[0], v[1] + h * a[1] + change[1], v[2] + h * a[2] + change[2]};
    c->search.body_reach[b] = (mg_real)n * h * sqrt(fmax(mg_dot3(v, v), mg_dot3(end, end)));
  }
}

/* True if the bodies of a pair are nearer than `times` the distance that they can move. */
static int mg_is_pair_within_reach(const mg_context *c, int pair, mg_real times) {
  const int first = c->system->pair_feature_pair[pair];
  const mg_real reach =
      c->search.body_reach[c->system->feature_pair_o[first]] + c->search.body_reach[c->system->feature_pair_f[first]];
  return mg_are_extents_within(c, pair, times * reach + c->settings->start_gap * c->system->length);
}

MG_INTERNAL void mg_choose_followed_pairs(mg_context *c, mg_real h) {
  const mg_system *s = c->system;
  const mg_real none[MG_MAX_ETA] = {0};
  if (s->n_pair <= MG_FEW_PAIRS) return;
  for (int k = 0; k < 6 * s->n_body; k++) c->bodies.wrench[k] = 0;
  mg_set_body_reaches(c, h, MG_NEAR_STEPS);
  for (int pair = 0; pair < s->n_pair; pair++) {
    const int contact = s->pair_contact[pair], is_followed = c->run->feature_pair[contact] >= 0;
    if (c->run->closed[contact] || !mg_is_pair_omissible(c, pair)) continue;
    if (is_followed && !mg_is_pair_within_reach(c, pair, 2)) mg_set_feature_pair(c, contact, -1, none);
    if (!is_followed && mg_is_pair_within_reach(c, pair, 1)) mg_follow_pair(c, pair);
  }
}

MG_INTERNAL void mg_follow_meeting_pairs(mg_context *c, mg_real h) {
  const mg_system *s = c->system;
  int count = 0;
  if (s->n_pair <= MG_FEW_PAIRS) return;
  mg_set_body_reaches(c, h, 1);
  for (int pair = 0; pair < s->n_pair; pair++) {
    const int contact = s->pair_contact[pair];
    if (c->run->feature_pair[contact] >= 0 || !mg_is_pair_omissible(c, pair) || !mg_is_pair_within_reach(c, pair, 1))
      continue;
    mg_follow_pair(c, pair);
    const mg_real *eta = mg_contact_eta(c, c->run->x, contact);
    mg_real *settled = mg_contact_eta(c, c->step.settled, contact);
    for (int k = 0; k < c->contacts.n_eta[contact]; k++) settled[k] = eta[k];
    count++;
  }
  if (!count) return;
  mg_update_contact_rows(c, c->step.settled);
  mg_update_gap_rates(c);
}

MG_INTERNAL void mg_follow_all_pairs(mg_context *c) {
  for (int pair = 0; pair < c->system->n_pair && c->system->n_pair > MG_FEW_PAIRS; pair++)
    if (c->run->feature_pair[c->system->pair_contact[pair]] < 0 && mg_is_pair_omissible(c, pair))
      mg_follow_pair(c, pair);
}
