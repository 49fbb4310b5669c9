/* All local minima of the distance of a pair of shapes: the minima of every feature pair that satisfy its conditions.
   Writes c->search; at the start also feature pairs and eta of the contacts. */
#include "closest/closest.h"
#include "base/base.h"
#include "model/model.h"

MG_INTERNAL int mg_use_spare_contact(mg_context *c, int feature_pair) {
  mg_place_on_feature_pair(c, c->system->n_contact, feature_pair);
  return c->system->n_contact;
}

MG_INTERNAL void mg_reverse_normal(const mg_context *c, int feature_pair, mg_real *eta) {
  if (mg_parametrisation(c, feature_pair, 0) == MG_SIGN) eta[0] = -eta[0];
  else eta[2] = -eta[2], eta[3] = -eta[3];
}

/* Two curves by themselves have no outside: True if N disagrees with the normal given for the pair, or, if none is
   given, if the second curve is not on the positive side. */
static int mg_is_on_wrong_side(const mg_context *c, int feature_pair) {
  const mg_real *given_normal = c->system->pair_normal + 3 * c->system->feature_pair_owner[feature_pair];
  const mg_real along = mg_dot3(given_normal, c->search.placement + 5);
  return along != 0 ? along < 0 : c->search.placement[0] < 0;
}

/* True if two curves touch and no normal is given. */
static int mg_is_side_undecided(const mg_context *c, int feature_pair) {
  const mg_real *given_normal = c->system->pair_normal + 3 * c->system->feature_pair_owner[feature_pair];
  return mg_dot3(given_normal, given_normal) == 0 &&
         fabs(c->search.placement[0]) <= c->settings->start_gap * c->system->length;
}

MG_INTERNAL void mg_record_minimum(const mg_context *c, mg_minimum *found) {
  const int turned = mg_feature_body(c, found->feature_pair, 0) > mg_feature_body(c, found->feature_pair, 1);
  found->d = c->search.placement[0];
  for (int k = 0; k < 3; k++) {
    found->point[k] = c->search.placement[(turned ? 11 : 8) + k];
    found->normal[k] = turned ? -c->search.placement[5 + k] : c->search.placement[5 + k];
  }
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
  const int spare = mg_use_spare_contact(c, feature_pair), has_no_outside = mg_has_no_outside(c, feature_pair);
  int which;
  mg_real next[6];
  mg_place_contact(c, spare, eta, next);
  if (mg_has_normal_sign(c, feature_pair)) {
    const int is_wrong_side =
        has_no_outside ? mg_is_on_wrong_side(c, feature_pair)
                       : mg_most_violated_condition(c, feature_pair, eta, &which) < -c->settings->feature_border;
    if (is_wrong_side) mg_reverse_normal(c, feature_pair, eta), mg_place_contact(c, spare, eta, next);
  }
  found->undecided = mg_has_normal_sign(c, feature_pair) && has_no_outside && mg_is_side_undecided(c, feature_pair);
  if (!(mg_placement_margin(c, spare) > c->settings->search_margin)) return 0;
  if (mg_most_violated_condition(c, feature_pair, eta, &which) < -c->settings->feature_border) return 0;
  if (mg_least_feature_pair_condition(c, feature_pair, eta, 1, &which) < -c->settings->appear_tilt_sine) return 0;
  found->feature_pair = feature_pair, found->margin = mg_placement_margin(c, spare);
  mg_record_minimum(c, found);
  if (found->d < -c->settings->start_gap * c->system->length && mg_is_between_far_sides(c, feature_pair)) return 0;
  for (int k = 0; k < 6; k++) found->eta[k] = eta[k];
  return fabs(found->d) <= MG_MAX;
}

MG_INTERNAL void mg_report_unfollowed_minimum(const mg_context *c, const mg_minimum *found) {
  if (found->d > mg_search_reach(c, c->system->feature_pair_owner[found->feature_pair])) return;
  if (c->run->unfollowed_minima++) return;
  c->run->unfollowed_t = c->run->t;
  c->run->unfollowed_pair = c->system->feature_pair_owner[found->feature_pair];
}

MG_INTERNAL void mg_note_penetration(mg_context *c, int contact, int feature_pair, mg_real depth) {
  if (mg_is_feature_pair_of_tilted_faces(c, feature_pair)) depth -= 2 * c->settings->flat_angle * c->system->length;
  if (depth > c->search.penetration) c->search.penetration = depth, c->search.penetration_contact = contact;
  if (!(depth > c->run->penetration_max)) return;
  c->run->penetration_max = depth, c->run->penetration_t = c->run->t, c->run->penetration_contact = contact;
}

/* Counts a search that was given up in the report of the run, but where flat faces may lie on each other, which patches
   treat. */
static void mg_report_incomplete_search(const mg_context *c, int feature_pair) {
  for (int patch = 0; patch < c->system->n_patch; patch++)
    if (mg_is_feature_pair_in_patch(c, patch, feature_pair)) return;
  if (c->run->incomplete_searches++) return;
  c->run->incomplete_t = c->run->t;
  c->run->incomplete_pair = c->system->feature_pair_owner[feature_pair];
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

MG_INTERNAL mg_real mg_separating_plane_gap(mg_context *c, int pair) {
  const mg_system *s = c->system;
  mg_real eta[6] = {0}, next[6], separation = -MG_MAX;
  int groups = 0;
  for (int feature_pair = s->pair_feature_pair[pair]; feature_pair < s->pair_feature_pair[pair + 1]; feature_pair++) {
    const int group = s->feature_pair_group[feature_pair];
    if (group < 0 || group >= MG_SAMPLES) continue;
    while (groups <= group) c->search.face_gap[groups++] = MG_MAX;
    mg_place_contact(c, mg_use_spare_contact(c, feature_pair), eta, next);
    if (c->search.placement[0] < c->search.face_gap[group]) c->search.face_gap[group] = c->search.placement[0];
  }
  for (int k = 0; k < groups; k++)
    if (c->search.face_gap[k] < MG_MAX && c->search.face_gap[k] > separation) separation = c->search.face_gap[k];
  return separation;
}

/* The fate of a minimum that a contact has left in this step: if it stays, it may be accepted again: a closed curve
   returns at its other end, and an impact may reverse the motion. */
static int mg_fate_of_abandoned_minimum(mg_context *c, const mg_minimum *found) {
  for (int k = 0; k < c->search.abandoned.count; k++) {
    const mg_minimum *left = c->search.abandoned.list + k;
    if (left->feature_pair == found->feature_pair && mg_is_same_minimum(c, left, found))
      return mg_fate_of_minimum(c, found);
  }
  return MG_MINIMUM_STAYS;
}

MG_INTERNAL void mg_note_open_gap(mg_context *c, mg_real gap) {
  if (gap < c->search.open_gap) c->search.open_gap = gap;
}

MG_INTERNAL void mg_keep_minimum_at(mg_context *c, int feature_pair, mg_real *eta, mg_real least, mg_minima *kept) {
  mg_minimum found;
  if (!mg_accept_minimum(c, feature_pair, eta, &found) || found.d < least) return;
  const int fate = mg_fate_of_abandoned_minimum(c, &found);
  if (fate == MG_MINIMUM_STAYS) mg_insert_minimum(c, kept, &found);
  if (fate == MG_MINIMUM_LOST) mg_note_open_gap(c, found.d);
}

MG_INTERNAL mg_search_limits mg_appearance_limits(const mg_context *c, int pair) {
  const mg_search_limits limits = {mg_search_reach(c, pair), c->settings->appear_depth * mg_pair_length(c, pair),
                                   MG_EFFORT, MG_MAX};
  return limits;
}

MG_INTERNAL void mg_search_feature_pair(mg_context *c, int feature_pair, const mg_search_limits *limits, mg_real least,
                                        mg_minima *kept) {
  const mg_contact_kind *kind = c->kernels->contact_kinds + c->system->feature_pair_kind[feature_pair];
  const int turn = mg_parametrisation(c, feature_pair, 0) == MG_TURN;
  if (!kind->is_convex && kind->n_eta > 0 && mg_has_centre_curves(c, feature_pair)) {
    mg_search_centre_curves(c, feature_pair, limits, least, kept);
    return;
  }
  if (!kind->is_convex && kind->n_eta > 0 && !turn && mg_parametrisation(c, feature_pair, 0) != MG_SIGN) {
    if (!mg_search_critical_points(c, feature_pair, limits, least, kept)) mg_report_incomplete_search(c, feature_pair);
    return;
  }
  mg_real eta[6] = {turn ? 0 : 1, 0, 0, 0, 0, 0};
  if (mg_converge_from_any_start(c, feature_pair, eta) >= 0) mg_keep_minimum_at(c, feature_pair, eta, least, kept);
}

/* True if the gap is not below -start_gap. */
static int mg_is_start_gap_allowed(const mg_context *c, mg_real d) {
  return d >= -c->settings->start_gap * c->system->length;
}

MG_INTERNAL long mg_search_nearest(mg_context *c, int first, int end, mg_real least, long effort, mg_minima *found) {
  const int pair = c->system->feature_pair_owner[first];
  const mg_real near = mg_search_reach(c, pair), length = mg_pair_length(c, pair);
  const long before = c->run->incomplete_searches;
  long incomplete = 0;
  mg_search_limits limits = {near, near, effort, near};
  for (;;) {
    for (int each = first; each < end; each++) mg_search_feature_pair(c, each, &limits, least, found);
    if (limits.gap <= near) incomplete = c->run->incomplete_searches - before;
    const mg_real nearest = mg_min(found->count ? fabs(found->list[0].d) : MG_MAX, c->search.open_gap);
    if (nearest <= limits.gap || !(limits.gap < MG_MAX)) return incomplete;
    limits.gap = limits.depth = limits.gap < 1000 * length ? mg_max(8 * limits.gap, length / 8) : MG_MAX;
  }
}

/* Outcome of a start without closest points; if the search was given up, the shapes conform. */
static int mg_refuse_start(const mg_context *c) {
  if (!c->run->incomplete_searches) return MG_NO_EXTREMUM;
  c->run->margin_min = 0;
  return MG_MARGIN;
}

/* Searches feature pairs at the start as mg_search_nearest does. A run follows what is within search_gap: that farther
   closest points may have been missed is reported only if there are none. */
static void mg_search_at_start(mg_context *c, int first, int end, mg_real least, mg_minima *found) {
  const long before = c->run->incomplete_searches,
             incomplete = mg_search_nearest(c, first, end, least, MG_EFFORT, found);
  if (found->count) c->run->incomplete_searches = before + incomplete;
}

/* Start of a pair whose contacts have feature pairs of their own. Returns an outcome. */
static int mg_start_own_feature_pairs(mg_context *c, int pair) {
  const mg_system *s = c->system;
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++) {
    const int feature_pair = s->contact_feature_pair[i];
    mg_minima found = {0};
    mg_search_at_start(c, feature_pair, feature_pair + 1, -MG_MAX, &found);
    c->run->failed_contact = i;
    if (!found.count && mg_is_unconditional_feature_pair(c, feature_pair)) return mg_refuse_start(c);
    if (found.count && found.list[0].undecided) return MG_NO_OUTSIDE;
    mg_set_feature_pair(c, i, found.count ? feature_pair : -1, found.list[0].eta);
  }
  return MG_DONE;
}

/* Start of a pair whose contacts share its feature pairs: the nearest minimum is followed, others only within
   search_gap. None is needed where closest points form a curve, whose gap is known. Returns an outcome. */
static int mg_start_shared_feature_pairs(mg_context *c, int pair) {
  const mg_system *s = c->system;
  const int first = mg_pair_first_contact(c, pair), end = mg_pair_first_contact(c, pair + 1);
  const mg_real least = mg_separating_plane_gap(c, pair) - c->settings->start_gap * s->length;
  mg_minima found = {0};
  mg_search_at_start(c, s->pair_feature_pair[pair], s->pair_feature_pair[pair + 1], least, &found);
  c->run->failed_contact = first;
  const int feature_pair = s->pair_feature_pair[pair];
  const int is_gap_known = c->search.open_gap < MG_MAX && mg_is_start_gap_allowed(c, c->search.open_gap);
  if (!found.count && !is_gap_known && mg_is_unconditional_feature_pair(c, feature_pair) &&
      s->pair_feature_pair[pair + 1] - feature_pair == 1)
    return mg_refuse_start(c);
  int k = 0;
  for (int i = first; i < end; i++) {
    while (k > 0 && k < found.count && !mg_is_start_gap_allowed(c, found.list[k].d)) k++;
    const int fits = k < found.count && (k == 0 || found.list[k].d <= mg_search_reach(c, pair));
    if (fits && found.list[k].undecided) return MG_NO_OUTSIDE;
    mg_set_feature_pair(c, i, fits ? found.list[k].feature_pair : -1, found.list[fits ? k : 0].eta);
    k++;
  }
  for (; k < found.count; k++) {
    c->run->unfollowed_gap[pair] = mg_min(c->run->unfollowed_gap[pair], mg_max(found.list[k].d, (mg_real)0));
    if (fabs(found.list[k].d) <= c->settings->start_gap * s->length) mg_report_unfollowed_minimum(c, found.list + k);
  }
  return MG_DONE;
}

MG_INTERNAL int mg_search_start_pairs(mg_context *c) {
  for (int pair = 0; pair < c->system->n_pair; pair++) c->run->unfollowed_gap[pair] = MG_MAX;
  for (int i = 0; i < c->layout.support_begin; i++) mg_set_feature_pair(c, i, -1, 0);
  for (int pair = mg_next_pair(c, -1); pair < c->system->n_pair; pair = mg_next_pair(c, pair)) {
    c->search.open_gap = MG_MAX;
    const int outcome = mg_has_own_feature_pairs(c, pair) ? mg_start_own_feature_pairs(c, pair)
                                                          : mg_start_shared_feature_pairs(c, pair);
    if (outcome) return outcome;
    c->run->unfollowed_gap[pair] = mg_min(c->run->unfollowed_gap[pair], mg_max(c->search.open_gap, (mg_real)0));
    c->run->moved_since_search[pair] = c->search.open_gap < MG_MAX ? MG_SEARCH_DUE : 0;
  }
  return MG_DONE;
}
