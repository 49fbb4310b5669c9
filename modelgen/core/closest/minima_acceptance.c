/* The minima that a search finds: which satisfy the conditions of their feature pair, which are the same, which are
   kept, and what the run is told of the others. Writes c->search and the statistics of the run. */
#include "closest/closest.h"
#include "base/base.h"
#include "model/model.h"

MG_INTERNAL void mg_reverse_normal(const mg_context *c, int feature_pair, mg_real *eta) {
  if (mg_parametrisation(c, feature_pair, 0) == MG_SIGN) eta[0] = -eta[0];
  else eta[2] = -eta[2], eta[3] = -eta[3];
}

/* True if conditions tell nothing of the placement of a feature pair, because it has no normal, as between spheres
   about one point. Needs that placement evaluated last. */
static int mg_has_no_normal(const mg_context *c, int feature_pair) {
  MG_NEEDS_PLACED_PAIR(c, feature_pair);
  return !mg_is_unconditional_feature_pair(c, feature_pair) && !mg_all_finite(3, c->search.placement + 5);
}

/* Two curves by themselves have no outside: True if N disagrees with the normal given for the pair, or, if none is
   given, if the second curve is not on the positive side. Needs their placement evaluated last. */
static int mg_is_on_wrong_side(const mg_context *c, int feature_pair) {
  MG_NEEDS_PLACED_PAIR(c, feature_pair);
  const mg_real *given_normal = c->system->pair_normal + 3 * c->system->feature_pair_owner[feature_pair];
  const mg_real along = mg_dot3(given_normal, c->search.placement + 5);
  return along != 0 ? along < 0 : c->search.placement[0] < 0;
}

MG_INTERNAL int mg_has_no_sides(const mg_context *c, int feature_pair) {
  const mg_real *given_normal = c->system->pair_normal + 3 * c->system->feature_pair_owner[feature_pair];
  return mg_has_normal_sign(c, feature_pair) && mg_has_no_outside(c, feature_pair) &&
         mg_dot3(given_normal, given_normal) == 0;
}

MG_INTERNAL void mg_record_minimum(const mg_context *c, mg_minimum *found) {
  MG_NEEDS_PLACED_PAIR(c, found->feature_pair);
  const int turned = mg_feature_body(c, found->feature_pair, 0) > mg_feature_body(c, found->feature_pair, 1);
  found->d = c->search.placement[0];
  for (int k = 0; k < 3; k++) {
    found->point[k] = c->search.placement[(turned ? 11 : 8) + k];
    found->normal[k] = turned ? -c->search.placement[5 + k] : c->search.placement[5 + k];
  }
}

MG_INTERNAL void mg_see_from_shared_body(const mg_context *c, int feature_pair, mg_minimum *found) {
  const int own[2] = {mg_feature_body(c, found->feature_pair, 0), mg_feature_body(c, found->feature_pair, 1)},
            other[2] = {mg_feature_body(c, feature_pair, 0), mg_feature_body(c, feature_pair, 1)};
  const int shared = own[0] == other[0] || own[0] == other[1] ? own[0] : own[1];
  const int is_first = shared <= mg_min(own[0], own[1]), is_first_there = shared <= mg_min(other[0], other[1]);
  if (is_first == is_first_there) return;
  for (int k = 0; k < 3; k++) found->point[k] += found->d * found->normal[k], found->normal[k] = -found->normal[k];
}

MG_INTERNAL int mg_is_same_minimum(const mg_context *c, const mg_minimum *a, const mg_minimum *b) {
  mg_real apart = 0, turned = 0, opposite = 0;
  for (int k = 0; k < 3; k++) {
    const mg_real between = a->point[k] - b->point[k], across = a->d * a->normal[k] - b->d * b->normal[k];
    apart += between * between, opposite += (between + across) * (between + across);
    turned += (a->normal[k] - b->normal[k]) * (a->normal[k] - b->normal[k]);
  }
  const mg_real near =
      c->settings->search_merge_distance * mg_pair_length(c, c->system->feature_pair_owner[a->feature_pair]);
  const int sided = !(a->feature_pair == b->feature_pair && mg_has_normal_sign(c, a->feature_pair) &&
                      mg_has_no_outside(c, a->feature_pair));
  if (!sided) return sqrt(apart) < near && sqrt(opposite) < near;
  apart += (a->d - b->d) * (a->d - b->d);
  return sqrt(apart) < near && sqrt(turned) < c->settings->search_merge_distance;
}

MG_INTERNAL int mg_accept_minimum(mg_context *c, int feature_pair, mg_real *eta, mg_minimum *found) {
  const int probe = mg_use_probe_contact(c, feature_pair), has_no_outside = mg_has_no_outside(c, feature_pair);
  int which;
  mg_real next[6];
  mg_place_contact(c, probe, eta, next);
  if (mg_has_normal_sign(c, feature_pair)) {
    const int is_wrong_side =
        has_no_outside ? mg_is_on_wrong_side(c, feature_pair)
                       : mg_most_violated_condition(c, feature_pair, eta, &which) < -c->settings->feature_border;
    if (is_wrong_side) mg_reverse_normal(c, feature_pair, eta), mg_place_contact(c, probe, eta, next);
  }
  found->undecided =
      mg_has_no_sides(c, feature_pair) && fabs(c->search.placement[0]) <= c->settings->start_gap * c->system->length;
  if (!(mg_placement_uniqueness(c, probe) > mg_least_margin(c, feature_pair))) return 0;
  if (mg_has_no_normal(c, feature_pair)) return 0;
  if (mg_most_violated_condition(c, feature_pair, eta, &which) < -c->settings->feature_border) return 0;
  if (mg_is_tilted_beyond_watched(c, feature_pair, eta)) return 0;
  found->feature_pair = feature_pair, found->margin = mg_placement_uniqueness(c, probe);
  mg_record_minimum(c, found);
  if (mg_is_between_far_sides(c, feature_pair)) return 0;
  for (int k = 0; k < 6; k++) found->eta[k] = eta[k];
  return fabs(found->d) <= MG_MAX;
}

MG_INTERNAL void mg_report_unfollowed_minimum(const mg_context *c, const mg_minimum *found) {
  if (found->d > mg_search_reach(c, c->system->feature_pair_owner[found->feature_pair])) return;
  mg_report_unfollowed_pair(c->run,
                            mg_told_pair(c->system, c->run, c->system->feature_pair_owner[found->feature_pair]));
}

MG_INTERNAL void mg_note_penetration(mg_context *c, int contact, int feature_pair, mg_real depth, int outcome) {
  if (mg_is_feature_pair_of_tilted_faces(c, feature_pair) || mg_is_handed_over_early(c, feature_pair))
    depth -= 2 * c->settings->flat_angle * c->system->length;
  if (depth > c->search.penetration)
    c->search.penetration = depth, c->search.penetration_contact = contact, c->search.penetration_outcome = outcome;
  mg_report_penetration(c->run, mg_told_contact(c->system, c->run, contact), depth);
}

MG_INTERNAL void mg_insert_minimum(const mg_context *c, mg_minima *kept, const mg_minimum *found) {
  for (int i = 0; i < kept->count; i++)
    if (mg_is_same_minimum(c, kept->list + i, found)) return;
  if (kept->count == MG_MINIMA) {
    const mg_minimum *last = kept->list + MG_MINIMA - 1;
    mg_report_unfollowed_minimum(c, fabs(last->d) > fabs(found->d) ? last : found);
  }
  int at = kept->count < MG_MINIMA ? kept->count++ : MG_MINIMA;
  for (; at > 0 && fabs(kept->list[at - 1].d) > fabs(found->d); at--)
    if (at < MG_MINIMA) kept->list[at] = kept->list[at - 1];
  if (at < MG_MINIMA) kept->list[at] = *found;
}

/* The fate of a minimum that a contact has left in this step: if it stays, it may be accepted again: a closed curve
   returns at its other end, and an impact may reverse the motion. */
static int mg_fate_of_abandoned_minimum(mg_context *c, const mg_minimum *found) {
  for (int k = 0; k < c->search.n_abandoned; k++) {
    const mg_minimum *left = c->search.abandoned + k;
    if (left->feature_pair == found->feature_pair && mg_is_same_minimum(c, left, found))
      return mg_fate_of_minimum(c, found);
  }
  return MG_MINIMUM_STAYS;
}

MG_INTERNAL void mg_forget_noted_gaps(mg_context *c) {
  c->search.open_gap = c->search.singular_gap = MG_MAX, c->search.overlap.d = -MG_MAX;
}

MG_INTERNAL void mg_note_open_gap(mg_context *c, mg_real gap) {
  if (gap < c->search.open_gap) c->search.open_gap = gap;
}

MG_INTERNAL void mg_note_singular_gap(mg_context *c, int feature_pair, mg_real gap) {
  mg_note_open_gap(c, gap);
  if (gap < c->search.singular_gap && mg_is_unconditional_feature_pair(c, feature_pair)) c->search.singular_gap = gap;
}

MG_INTERNAL void mg_note_singular_point(mg_context *c, int feature_pair, const mg_real *eta) {
  MG_NEEDS_PLACEMENT(c, feature_pair, eta);
  const mg_real d = c->search.placement[0];
  int which;
  if (fabs(mg_placement_uniqueness(c, c->system->n_contact)) > c->settings->search_margin) return;
  if (mg_has_no_normal(c, feature_pair)) return;
  const mg_real least = d < 0 ? -c->settings->feature_border : -c->settings->search_movement;
  if (mg_most_violated_condition(c, feature_pair, eta, &which) < least) return;
  if (mg_is_between_far_sides(c, feature_pair)) return;
  mg_note_singular_gap(c, feature_pair, d);
  if (!(d < 0) || !(d > c->search.overlap.d)) return;
  c->search.overlap.feature_pair = feature_pair, c->search.overlap.d = d;
  for (int k = 0; k < 6; k++) c->search.overlap.eta[k] = eta[k];
}

MG_INTERNAL void mg_keep_minimum_at(mg_context *c, int feature_pair, mg_real *eta, mg_real least, mg_minima *kept) {
  mg_minimum found;
  if (!mg_accept_minimum(c, feature_pair, eta, &found) || found.d < least) return;
  const int fate = mg_fate_of_abandoned_minimum(c, &found);
  if (fate == MG_MINIMUM_STAYS) mg_insert_minimum(c, kept, &found);
  else mg_note_open_gap(c, found.d);
}
