/* Feature changes of contacts: from feature pair to adjacent feature pair where a condition is broken, also to one of
   another pair of shapes, release where none continues, and new contacts where a search finds them. Writes feature
   pairs, eta and search requests of the run, and the event list.

   Feature changes at vertices: a touching contact reaches the end of an edge, where a vertex is on an edge or a
   vertex and no normal is defined. The feature pair that follows is the one whose conditions hold a short time later.
   Writes no mode of the run; it restores the poses that it extrapolates. */
#include "features/features.h"
#include "base/base.h"
#include "model/model.h"
#include "closest/closest.h"

#define MG_FEATURE_CHANGES_MAX 8 /* most feature pairs passed at one time, as around a vertex */

/* Coordinates of a shape nearest to a point in its axes, by refined sampling. */
static void mg_nearest_shape_coordinates(mg_context *c, int feature_pair, int side, const mg_real *local, mg_real *uv) {
  mg_real window[4];
  mg_sample_window(c, feature_pair, side, mg_search_radius(c, feature_pair, side), window);
  for (int level = 0; level < 4; level++) {
    const int n = mg_sample_feature(c, feature_pair, side, window, 9, c->search.samples);
    mg_real least = MG_MAX;
    for (int i = 0; i < n; i++) {
      const mg_real *x = c->search.samples[i].local, span[3] = {x[0] - local[0], x[1] - local[1], x[2] - local[2]};
      const mg_real distance = mg_dot3(span, span);
      if (distance < least) least = distance, uv[0] = c->search.samples[i].uv[0], uv[1] = c->search.samples[i].uv[1];
    }
    mg_shrink_window(window, uv);
  }
}

/* Eta of a feature pair from world points of both bodies near its own. */
static void mg_eta_from_points(mg_context *c, int feature_pair, const mg_real *point_o, const mg_real *point_f,
                               mg_real *eta) {
  mg_sample at[2];
  for (int side = 0; side < 2; side++) {
    const int parametrisation = mg_parametrisation(c, feature_pair, side);
    mg_point_in_shape_axes(c, feature_pair, side, side ? point_f : point_o, at[side].local);
    if (parametrisation == MG_CHART || parametrisation == MG_CURVE || parametrisation == MG_SIGNED_CURVE)
      mg_nearest_shape_coordinates(c, feature_pair, side, at[side].local, at[side].uv);
  }
  mg_start_eta(c, feature_pair, at, at + 1, eta);
}

/* Transfer a contact point from one feature pair to another, with points and normal kept as near as possible; returns
   the worst condition there, -MG_MAX where no extremum is found. */
static mg_real mg_transfer_to_feature_pair(mg_context *c, int from, int to, const mg_real *at, mg_real *eta,
                                           int *which) {
  const int sides_swapped = mg_feature_body(c, from, 0) == mg_feature_body(c, to, 1) ||
                            mg_feature_body(c, from, 1) == mg_feature_body(c, to, 0),
            probe_contact = mg_use_probe_contact(c, to);
  mg_real next[6];
  *which = -1;
  mg_eta_from_points(c, to, at + (sides_swapped ? 11 : 8), at + (sides_swapped ? 8 : 11), eta);
  if (mg_newton_on_feature_pair(c, probe_contact, eta) < 0 ||
      !(mg_placement_uniqueness(c, probe_contact) > c->settings->search_margin))
    return -MG_MAX;
  if (mg_has_normal_sign(c, to) && (mg_dot3(c->search.placement + 5, at + 5) < 0) != sides_swapped)
    mg_reverse_normal(c, to, eta), mg_place_contact(c, probe_contact, eta, next);
  return mg_is_tilted_beyond_watched(c, to, eta) ? -MG_MAX : mg_most_violated_condition(c, to, eta, which);
}

MG_INTERNAL int mg_is_at_end_of_line(mg_context *c, int contact, int line) {
  const int feature_pair = c->run->feature_pair[contact];
  mg_real at[14], eta[6];
  int which;
  MG_NEEDS_PLACED(c, contact);
  if (line < 0 || mg_is_time_stepping(c) || !mg_ends_line(c, feature_pair, line)) return 0;
  for (int k = 0; k < 14; k++) at[k] = c->search.placement[k];
  MG_KEEP_PLACEMENT(c);
  const mg_real worst = mg_transfer_to_feature_pair(c, feature_pair, line, at, eta, &which);
  for (int k = 0; k < 14; k++) c->search.placement[k] = at[k];
  MG_RESTORE_PLACEMENT(c);
  return worst < -c->settings->feature_border;
}

/* A contact of a pair, other than `contact`, that is at a minimum of this or another pair, or converges to it; -1 if
   there is none. */
static int mg_find_contact_at_minimum(mg_context *c, int pair, int contact, const mg_minimum *found) {
  mg_real eta[6];
  mg_minimum other;
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++) {
    if (i == contact || !mg_is_on_feature_pair(c, i)) continue;
    for (int k = 0; k < c->contacts.n_eta[i]; k++) eta[k] = mg_contact_eta(c, c->run->x, i)[k];
    mg_newton_on_feature_pair(c, i, eta);
    other.feature_pair = c->run->feature_pair[i];
    mg_record_minimum(c, &other);
    mg_see_from_shared_body(c, found->feature_pair, &other);
    if (mg_is_same_minimum(c, &other, found)) return i;
  }
  return -1;
}

/* True if contacts go over from a feature pair to another pair of shapes. */
static int mg_leads_to_pair(const mg_context *c, int feature_pair, int pair) {
  const mg_system *s = c->system;
  for (int k = s->feature_pair_condition[feature_pair]; k < s->feature_pair_condition[feature_pair + 1]; k++)
    if (mg_leads_to_other_pair(c, feature_pair, k) && s->feature_pair_owner[s->condition_feature_pair[k]] == pair)
      return 1;
  return 0;
}

MG_INTERNAL int mg_is_minimum_tracked(mg_context *c, int pair, int contact, const mg_minimum *found) {
  const mg_system *s = c->system;
  if (mg_find_contact_at_minimum(c, pair, contact, found) >= 0) return 1;
  for (int k = s->feature_pair_condition[found->feature_pair]; k < s->feature_pair_condition[found->feature_pair + 1];
       k++) {
    if (!mg_leads_to_other_pair(c, found->feature_pair, k)) continue;
    const int beyond = s->feature_pair_owner[s->condition_feature_pair[k]],
              i = c->run->is_far[beyond] ? -1 : mg_find_contact_at_minimum(c, beyond, contact, found);
    if (i >= 0 && mg_leads_to_pair(c, c->run->feature_pair[i], pair)) return 1;
  }
  return 0;
}

/* True if the present contacts of the pair limit the step enough for the others: each feature pair has its own contact,
   and one ends where the next begins. */
static int mg_has_guiding_contacts(const mg_context *c, int pair) {
  return mg_has_own_feature_pairs(c, pair) && c->system->pair_search[pair] != MG_SEARCH_AHEAD;
}

/* True if a contact on this feature pair at this gap only limits the step for what is touched later. */
static int mg_is_guiding_contact_only(const mg_context *c, int feature_pair, mg_real d) {
  const int pair = c->system->feature_pair_owner[feature_pair];
  return d > mg_search_reach(c, pair) && mg_has_guiding_contacts(c, pair) &&
         !mg_is_feature_pair_of_flat_faces(c, feature_pair);
}

/* True if contacts on this feature pair begin and end without an event. */
static int mg_is_feature_pair_unreported(const mg_context *c, int feature_pair, mg_real d) {
  return mg_is_feature_pair_of_flat_faces(c, feature_pair) || mg_is_guiding_contact_only(c, feature_pair, d);
}

/* Takes a contact off its feature pair and remembers its point for the search. */
static void mg_leave_feature_pair(mg_context *c, int contact) {
  const mg_real none[6] = {0};
  mg_real next[6];
  if (c->search.n_abandoned < mg_abandoned_capacity(c->system)) {
    mg_minimum *left = c->search.abandoned + c->search.n_abandoned++;
    mg_place_contact(c, contact, mg_contact_eta(c, c->run->x, contact), next);
    left->feature_pair = c->run->feature_pair[contact];
    mg_record_minimum(c, left);
  } else mg_report_exceeded(c->run, MG_CAPACITY_LEFT);
  mg_set_feature_pair(c, contact, -1, none);
  c->run->is_search_due[c->system->contact_pair[contact]] = 1;
}

MG_INTERNAL void mg_release_contact(mg_context *c, mg_events *events, int contact) {
  const int unreported = mg_is_feature_pair_unreported(c, c->run->feature_pair[contact], c->rows.d[contact]);
  mg_leave_feature_pair(c, contact);
  if (!unreported) mg_apply_contact_transition(c, events, contact, MG_CONTACT_VANISHES, c->run->t, 0);
}

/* True if the feature pair is of a vertex on an edge or on a vertex, where no normal is defined. */
static int mg_is_vertex_feature_pair(const mg_context *c, int feature_pair) {
  return mg_feature_dimension(c, feature_pair, 0) + mg_feature_dimension(c, feature_pair, 1) < 2;
}

/* Link around a vertex with the least gap of those whose conditions will hold after a short time, or -1. */
static int mg_find_feature_pair_around_vertex(mg_context *c, int from, int corner, const mg_real *at) {
  mg_real least = c->settings->search_merge_distance * c->system->length, eta[6];
  int best = -1, which;
  mg_extrapolate_poses(c);
  for (int k = c->system->feature_pair_condition[corner]; k < c->system->feature_pair_condition[corner + 1]; k++) {
    const int to = c->system->condition_feature_pair[k];
    if (to < 0 || to == from || mg_is_vertex_feature_pair(c, to) || mg_is_feature_pair_covered(c, to)) continue;
    if (mg_transfer_to_feature_pair(c, from, to, at, eta, &which) < -c->settings->feature_border ||
        !(fabs(c->search.placement[0]) < least))
      continue;
    least = fabs(c->search.placement[0]), best = to;
  }
  mg_update_poses(c, c->run->t, c->run->x);
  return best;
}

/* Transfer a touching contact over a vertex to another feature pair; returns 0 where there is none. */
static int mg_transfer_over_vertex(mg_context *c, int from, int corner, const mg_real *at, mg_minimum *found) {
  int which;
  const int to = mg_find_feature_pair_around_vertex(c, from, corner, at);
  if (to < 0 || mg_transfer_to_feature_pair(c, from, to, at, found->eta, &which) == -MG_MAX) return 0;
  found->feature_pair = to;
  mg_record_minimum(c, found);
  return 1;
}

/* True if a minimum belongs to sides of the bodies that face away from each other. */
static int mg_is_minimum_on_far_sides(mg_context *c, const mg_minimum *found) {
  mg_real next[6];
  mg_place_contact(c, mg_use_probe_contact(c, found->feature_pair), found->eta, next);
  return mg_is_between_far_sides(c, found->feature_pair);
}

/* Puts a contact of a pair that is at no closest points, or at those farthest away, at the minimum found; returns it,
   or -1 if there is none. */
static int mg_put_contact_at_minimum(mg_context *c, int pair, const mg_minimum *found) {
  const int next = mg_find_contact_for_minimum(c, pair, found);
  if (next < 0) return -1;
  if (mg_is_on_feature_pair(c, next)) mg_note_unfollowed_gap(c, pair, c->rows.d[next]); /* what it followed so far */
  mg_set_feature_pair(c, next, found->feature_pair, found->eta);
  c->rows.d[next] = found->d;
  return next;
}

/* Hands a contact over to one of another pair of shapes, at the minimum found, where the surfaces of two shapes that
   are fixed to each other join smoothly: it stays closed, with its force and its modes of friction. */
static void mg_hand_over_contact(mg_context *c, mg_events *events, int contact, int pair, const mg_minimum *found) {
  const int count = events->count, is_far = c->run->is_far[pair];
  int next = is_far ? -1 : mg_find_contact_at_minimum(c, pair, contact, found);
  if (next < 0 && !is_far) next = mg_put_contact_at_minimum(c, pair, found);
  if (next < 0) {
    mg_release_contact(c, events, contact);
    return;
  }
  if (c->run->closed[contact] && !c->run->closed[next]) mg_take_over_modes(c, contact, next);
  mg_apply_contact_transition(c, events, contact, MG_FEATURE_CHANGES, c->run->t, 0);
  if (events->count > count) events->feature_pair[count] = found->feature_pair;
  mg_leave_feature_pair(c, contact);
}

/* Move a contact whose feature pair condition is broken to the adjacent feature pair whose conditions hold, or release
   it. Needs the poses at the run's state. */
static void mg_change_contact_feature(mg_context *c, mg_events *events, int contact) {
  MG_NEEDS_AT_RUN(c, MG_VALID_POSES);
  mg_real eta[6] = {0}, at[14], best = -MG_MAX;
  mg_minimum found = {0};
  int feature_pair = c->run->feature_pair[contact], condition = c->events.broken_condition[contact];
  mg_place_contact(c, contact, mg_contact_eta(c, c->run->x, contact), eta);
  for (int k = 0; k < 14; k++) at[k] = c->search.placement[k];
  found.feature_pair = -1;
  for (int hop = 0; hop < MG_FEATURE_CHANGES_MAX && condition >= 0; hop++) {
    const int to = c->system->condition_feature_pair[condition];
    if (to < 0 || mg_is_feature_pair_covered(c, to)) break;
    if (mg_is_vertex_feature_pair(c, to) && fabs(at[0]) < c->settings->search_merge_distance * c->system->length &&
        mg_transfer_over_vertex(c, feature_pair, to, at, &found)) {
      best = 0;
      break;
    }
    const mg_real worst = mg_transfer_to_feature_pair(c, feature_pair, to, at, eta, &condition);
    if (worst == -MG_MAX) break;
    if (worst > best && (hop == 0 || to != c->run->feature_pair[contact])) {
      best = worst, found.feature_pair = to;
      mg_record_minimum(c, &found);
      for (int k = 0; k < 6; k++) found.eta[k] = eta[k];
    }
    if (worst >= -c->settings->feature_border) break;
    for (int k = 0; k < 14; k++) at[k] = c->search.placement[k];
    feature_pair = to;
  }
  const int not_found = found.feature_pair < 0 || best < -100 * c->settings->feature_border;
  if (not_found || mg_is_minimum_on_far_sides(c, &found)) {
    mg_release_contact(c, events, contact);
    return;
  }
  const int pair = c->system->feature_pair_owner[found.feature_pair];
  if (pair != c->system->contact_pair[contact]) {
    mg_hand_over_contact(c, events, contact, pair, &found);
    return;
  }
  if (mg_is_minimum_tracked(c, pair, contact, &found)) {
    mg_release_contact(c, events, contact);
    return;
  }
  const int is_round = found.feature_pair == c->run->feature_pair[contact]; /* a turn on along a closed feature */
  mg_set_feature_pair(c, contact, found.feature_pair, found.eta);
  c->rows.d[contact] = found.d;
  if (!is_round) mg_apply_contact_transition(c, events, contact, MG_FEATURE_CHANGES, c->run->t, 0);
}

MG_INTERNAL int mg_change_marked_features(mg_context *c, mg_events *events) {
  int count = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) {
    const int cause = c->events.triggered[i];
    if (cause != MG_LEAVES_FEATURE && cause != MG_PASSES_BORDER) continue;
    c->events.triggered[i] = 0;
    if (cause == MG_LEAVES_FEATURE) mg_change_contact_feature(c, events, i);
    else c->events.within_border[i] = MG_PASSES_BORDER, c->run->is_search_due[c->system->contact_pair[i]] = 1;
    count += cause == MG_LEAVES_FEATURE;
  }
  return count;
}

/* ---- contacts that end and appear ---- */
/* Release distant contacts on feature pairs for flat faces whose faces are no longer flat. */
static void mg_release_distant_rim_points(mg_context *c) {
  const mg_real none[6] = {0};
  mg_real next[6];
  int which;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    if (!mg_is_on_feature_pair(c, i) || c->run->closed[i] || !mg_is_distant_flat_feature_pair(c, i)) continue;
    mg_place_contact(c, i, mg_contact_eta(c, c->run->x, i), next);
    if (mg_most_violated_condition(c, c->run->feature_pair[i], none, &which) >= -c->settings->feature_border) continue;
    mg_set_feature_pair(c, i, -1, none);
    c->run->is_search_due[c->system->contact_pair[i]] = 1;
  }
}

MG_INTERNAL int mg_find_contact_for_minimum(const mg_context *c, int pair, const mg_minimum *found) {
  int slot = -1;
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++) {
    if (c->system->contact_feature_pair[i] == found->feature_pair) return mg_is_on_feature_pair(c, i) ? -1 : i;
    if (c->system->contact_feature_pair[i] >= 0 || c->run->closed[i] || c->rows.d[i] <= found->d) continue;
    if (slot < 0 || c->rows.d[i] > c->rows.d[slot]) slot = i;
  }
  return slot;
}

/* True if no contact of the pair will follow the minimum later: its own contact is in use, or all are closed. */
static int mg_is_without_contact(const mg_context *c, int pair) {
  if (mg_has_own_feature_pairs(c, pair)) return 1;
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++)
    if (!c->run->closed[i]) return 0;
  return 1;
}

/* True if a minimum found during a run is within reach unless it limits the step, and not below -depth. */
static int mg_is_minimum_within_reach(const mg_context *c, const mg_minimum *found, mg_real depth) {
  const int is_distant = found->d > mg_search_reach(c, c->system->feature_pair_owner[found->feature_pair]) &&
                         !mg_is_guiding_contact_only(c, found->feature_pair, found->d);
  return !found->undecided && !is_distant && found->d >= -depth;
}

MG_INTERNAL int mg_is_minimum_accepted(const mg_context *c, const mg_minimum *found, mg_real depth) {
  if (!mg_is_minimum_within_reach(c, found, depth)) return 0;
  const int own = mg_has_own_feature_pairs(c, c->system->feature_pair_owner[found->feature_pair]);
  const int flat =
      mg_is_feature_pair_of_tilted_faces(c, found->feature_pair); /* its margin is small near flat, not near a fold */
  if (mg_is_followed_to_singularity(c, found->feature_pair, found->d))
    return found->margin >= mg_least_margin(c, found->feature_pair);
  return found->margin >= (own || flat ? c->settings->margin_refuse : c->settings->appear_margin);
}

/* True if the feature pair has a contact of its own that is on it. */
static int mg_is_feature_pair_in_use(const mg_context *c, int pair, int feature_pair) {
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++)
    if (c->system->contact_feature_pair[i] == feature_pair) return mg_is_on_feature_pair(c, i);
  return 0;
}

/* True if a point of the minimum coincides with that of a contact that is closed, or penetrates less: a point in a
   corner is as deep as it is below the nearest of the faces. */
static int mg_is_minimum_touched(mg_context *c, const mg_minimum *found) {
  const mg_real near = c->settings->search_merge_distance * c->system->length,
                touching = c->settings->start_gap * c->system->length;
  const int pair = c->system->feature_pair_owner[found->feature_pair];
  mg_real eta[6];
  mg_minimum other;
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++) {
    if (!mg_is_on_feature_pair(c, i)) continue;
    mg_place_contact(c, i, mg_contact_eta(c, c->run->x, i), eta);
    other.feature_pair = c->run->feature_pair[i];
    mg_record_minimum(c, &other);
    if (!c->run->closed[i] && (other.d > touching || fabs(other.d) > fabs(found->d) / 2)) continue;
    mg_real first = 0, second = 0;
    for (int k = 0; k < 3; k++) {
      const mg_real apart = found->point[k] - other.point[k],
                    across = found->d * found->normal[k] - other.d * other.normal[k];
      first += apart * apart, second += (apart + across) * (apart + across);
    }
    if (first < near * near || second < near * near) return 1;
  }
  return 0;
}

/* True if the minimum touches at a point of a closed contact and itself penetrates or is about to end. */
static int mg_is_minimum_ignored(mg_context *c, const mg_minimum *found) {
  if (found->d > c->settings->start_gap * c->system->length || !mg_is_minimum_touched(c, found)) return 0;
  return found->d < -c->settings->start_gap * c->system->length || mg_fate_of_minimum(c, found) != MG_MINIMUM_STAYS;
}

/* True if the feature pair is of straight features that touch along a line, and are nowhere nearer than at an end of it
   at which a contact is. */
static int mg_is_line_held_at_end(mg_context *c, int pair, int feature_pair) {
  mg_real next[6];
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++) {
    const int held = c->run->feature_pair[i];
    if (held < 0 || !mg_ends_line(c, held, feature_pair)) continue;
    const mg_real *eta = mg_contact_eta(c, c->run->x, i);
    mg_place_contact(c, i, eta, next);
    if (mg_least_line_end_condition(c, held, feature_pair, eta) >= -c->settings->feature_border ||
        mg_is_at_end_of_line(c, i, feature_pair))
      return 1;
  }
  return 0;
}

/* Adds the minima of the feature pairs of a pair that are within reach and neither in use nor covered to those kept. */
static void mg_search_free_feature_pairs(mg_context *c, int pair, const mg_search_limits *limits, mg_real least,
                                         mg_minima *kept) {
  const mg_system *s = c->system;
  if (least > limits->gap) return;
  const long incomplete = c->search.incomplete;
  const int may_be_covered = mg_may_feature_pairs_be_covered(c, pair);
  mg_begin_feature_views(c, pair);
  for (int feature_pair = s->pair_feature_pair[pair]; feature_pair < s->pair_feature_pair[pair + 1]; feature_pair++)
    if (mg_may_hold_closest_points(c, feature_pair, least, limits->gap) &&
        !mg_is_feature_pair_in_use(c, pair, feature_pair) &&
        !(may_be_covered && mg_is_feature_pair_covered(c, feature_pair)) &&
        !mg_is_line_held_at_end(c, pair, feature_pair))
      mg_search_feature_pair(c, feature_pair, limits, least, kept);
  mg_note_missed_gap(c, pair, incomplete);
}

/* Gaps of interest for a pair that has moved since its last search: a penetration since then is no deeper than that,
   and than a half of the smaller ball around the shapes, so that sides that face away from each other are none. */
static mg_search_limits mg_penetration_limits(const mg_context *c, int pair, mg_real moved) {
  const mg_real radius_o = mg_pair_ball(c, pair, 0)[3], radius_f = mg_pair_ball(c, pair, 1)[3];
  mg_search_limits limits = mg_appearance_limits(c, pair);
  if (radius_o >= 0) moved = mg_min(moved, radius_o / 2);
  if (radius_f >= 0) moved = mg_min(moved, radius_f / 2);
  limits.depth = mg_max(limits.depth, moved);
  return limits;
}

/* Movement of a pair, m, after which a search finds closest points that it did not tell apart before. */
static mg_real mg_resolved_movement(const mg_context *c, int pair) {
  return c->settings->search_merge_distance * mg_pair_length(c, pair);
}

/* Whether a contact follows a minimum. */
enum { MG_NOT_FOLLOWED = 0, MG_FOLLOWED_BEFORE = 1, MG_FOLLOWED_NOW = 2 };

/* Lets a contact follow a minimum of a pair: MG_NOT_FOLLOWED .. . */
static int mg_follow_minimum(mg_context *c, mg_events *events, int pair, const mg_minimum *each, mg_real seen_depth,
                             mg_real appearing_depth) {
  if (mg_is_minimum_tracked(c, pair, -1, each)) return MG_FOLLOWED_BEFORE;
  if (!mg_is_minimum_accepted(c, each, seen_depth)) {
    mg_note_unfollowed_gap(c, pair, each->d);
    if (each->d / 2 < mg_least_movement(c, pair) && !(c->run->withheld_effort[pair] > 0))
      c->run->is_search_due[pair] = 1;
    return MG_NOT_FOLLOWED;
  }
  if (each->d < -appearing_depth) return MG_NOT_FOLLOWED;
  const int slot = mg_find_contact_for_minimum(c, pair, each);
  if (slot < 0) {
    if (mg_is_without_contact(c, pair)) mg_report_unfollowed_minimum(c, each);
    mg_note_unfollowed_gap(c, pair, each->d);
    return MG_NOT_FOLLOWED;
  }
  if (mg_is_on_feature_pair(c, slot)) mg_note_unfollowed_gap(c, pair, c->rows.d[slot]); /* what it followed so far */
  mg_set_feature_pair(c, slot, each->feature_pair, each->eta);
  c->rows.d[slot] = each->d;
  if (!mg_is_feature_pair_unreported(c, each->feature_pair, each->d))
    mg_apply_contact_transition(c, events, slot, MG_CONTACT_APPEARS, c->run->t, 0);
  return MG_FOLLOWED_NOW;
}

/* Penetration of minima is noted where it stays: in time-stepping that of contacts is removed first. There a contact
   may appear as deep as the pair has moved since its last search: no step is refused for it. */
MG_INTERNAL int mg_search_pair_contacts(mg_context *c, mg_events *events, int pair, mg_real moved) {
  const mg_system *s = c->system;
  if (mg_pair_clearance(c, pair) > mg_search_reach(c, pair)) return 0;
  const mg_real least = mg_separating_plane_gap(c, pair) - c->settings->start_gap * s->length;
  const mg_search_limits seen = mg_penetration_limits(c, pair, moved);
  const mg_real appearing = mg_is_time_stepping(c) ? seen.depth : mg_appearance_limits(c, pair).depth;
  mg_search_limits limits = seen;
  mg_minima found;
  if (mg_has_own_feature_pairs(c, pair)) limits.gap = limits.depth = MG_MAX;
  int count = found.count = 0;
  mg_forget_noted_gaps(c);
  mg_search_free_feature_pairs(c, pair, &limits, least, &found);
  if (mg_is_search_stopped(c)) { /* the next step searches again */
    c->run->is_search_due[pair] = 1, c->run->moved_since_search[pair] = moved;
    return 0;
  }
  c->run->unfollowed_gap[pair] = mg_max(c->search.open_gap, (mg_real)0);
  mg_note_unfollowed_gap(c, pair, mg_bound_gap_not_found(c, pair, least, &found));
  for (int k = 0; k < found.count; k++) {
    const mg_minimum *each = found.list + k;
    if (mg_is_minimum_ignored(c, each)) continue;
    if (!mg_is_minimum_within_reach(c, each, seen.depth)) continue;
    const int followed = mg_follow_minimum(c, events, pair, each, seen.depth, appearing);
    count += followed == MG_FOLLOWED_NOW;
    if (!followed || !mg_is_time_stepping(c))
      mg_note_penetration(c, mg_pair_first_contact(c, pair), each->feature_pair, -each->d, MG_PENETRATED);
  }
  if (c->search.singular_gap < 0)
    mg_note_penetration(c, mg_pair_first_contact(c, pair), s->pair_feature_pair[pair], -c->search.singular_gap,
                        MG_MARGIN);
  if (!found.count && c->search.open_gap == MG_MAX) mg_report_lost_points(c, pair);
  return count;
}

/* The only feature pair of a pair that no other one replaces, or -1. */
static int mg_only_feature_pair(const mg_context *c, int pair) {
  int only = -1;
  for (int k = c->system->pair_feature_pair[pair]; k < c->system->pair_feature_pair[pair + 1]; k++) {
    if (mg_is_replaced_coaxially(c, k)) continue;
    if (only >= 0) return -1;
    only = k;
  }
  return only;
}

/* True if a contact of the pair is at the only minimum of its only feature pair with a gap up to `gap`. */
static int mg_is_only_minimum_followed(const mg_context *c, int pair, mg_real gap) {
  const int feature_pair = mg_only_feature_pair(c, pair);
  if (feature_pair < 0) return 0;
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++)
    if (c->run->feature_pair[i] == feature_pair && fabs(c->rows.d[i]) <= gap &&
        c->run->margin[i] > c->settings->search_margin)
      return mg_has_one_minimum(c, feature_pair, gap);
  return 0;
}

/* What a search of a pair finds that no contact follows. */
enum { MG_ALL_FOLLOWED = 0, MG_NEW_MINIMUM = 1, MG_NEW_TOUCH = 2, MG_NEW_PENETRATION = 3 };

/* Marks in c->search.searched_gap. */
enum { MG_NOT_SEARCHED = -1, MG_TOUCH_FOUND = -2 };

/* What a minimum that no contact follows is: MG_NEW_MINIMUM .. . One touches that may do so within the resolution of
   event times. Curves without sides whose gap is less than `crossed`, m, may have passed each other. */
static int mg_kind_of_unfollowed_minimum(const mg_context *c, const mg_minimum *found, mg_real depth, mg_real crossed) {
  const mg_system *s = c->system;
  if (mg_has_no_sides(c, found->feature_pair) && found->d < crossed && mg_is_minimum_accepted(c, found, depth))
    return MG_NEW_PENETRATION;
  const mg_real moment = c->settings->event_tolerance * s->time,
                touching = c->settings->contact_gap * s->length +
                           moment * mg_pair_speed_bound(c, s->feature_pair_owner[found->feature_pair]);
  if (!(found->d <= touching) || !mg_is_minimum_accepted(c, found, depth)) return MG_NEW_MINIMUM;
  return found->d < -c->settings->start_gap * s->length ? MG_NEW_PENETRATION : MG_NEW_TOUCH;
}

/* Searches a pair, which has moved since its last search, at the present poses for minima that no contact follows:
   MG_ALL_FOLLOWED .. . In the last step it may have moved by `crossed`, m. `gap`: the least of what else may be near,
   m. */
static int mg_find_unfollowed_minimum(mg_context *c, int pair, mg_real moved, mg_real crossed, mg_real *gap) {
  const mg_system *s = c->system;
  const mg_search_limits limits = mg_penetration_limits(c, pair, moved);
  const mg_real touching = c->settings->start_gap * s->length, least = mg_separating_plane_gap(c, pair) - touching;
  mg_minima found;
  mg_forget_noted_gaps(c);
  *gap = MG_MAX;
  if (mg_is_only_minimum_followed(c, pair, limits.gap)) return MG_ALL_FOLLOWED;
  found.count = 0;
  mg_search_free_feature_pairs(c, pair, &limits, least, &found);
  int kind = c->search.singular_gap < -touching ? MG_NEW_PENETRATION
             : c->search.singular_gap < MG_MAX  ? MG_NEW_MINIMUM
                                                : MG_ALL_FOLLOWED;
  for (int k = 0; k < found.count && kind < MG_NEW_PENETRATION; k++) {
    const mg_minimum *each = found.list + k;
    if (!mg_is_minimum_within_reach(c, each, limits.depth) || mg_is_minimum_tracked(c, pair, -1, each) ||
        mg_is_minimum_ignored(c, each))
      continue;
    const int found_kind = mg_kind_of_unfollowed_minimum(c, each, limits.depth, crossed);
    if (found_kind > kind) kind = found_kind;
  }
  if (kind == MG_ALL_FOLLOWED)
    *gap = mg_min(mg_max(c->search.open_gap, (mg_real)0), mg_bound_gap_not_found(c, pair, least, &found));
  return kind;
}

/* True if no contact or held patch of the pair limits the step. */
static int mg_is_pair_without_contacts(const mg_context *c, int pair) {
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++)
    if (mg_is_on_feature_pair(c, i)) return 0;
  return !mg_has_held_patch(c, pair);
}

/* True if the pair is not searched as long as it has a contact, and has one; or not as long as one of its contacts is
   closed, unless a search is due, as where that is held at the end of a line. */
static int mg_is_search_needless(const mg_context *c, int pair) {
  const int search = c->system->pair_search[pair];
  if (search != MG_SEARCH_APART) return search == MG_SEARCH_NEVER && !mg_is_pair_without_contacts(c, pair);
  if (c->run->is_search_due[pair]) return 0;
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++)
    if (c->run->closed[i]) return 1;
  return 0;
}

/* Least margin of the closed contacts of a pair, 1 at most. */
static mg_real mg_least_closed_margin(const mg_context *c, int pair) {
  mg_real least = 1;
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++)
    if (c->run->closed[i] && c->run->margin[i] < least) least = mg_max(c->run->margin[i], (mg_real)0);
  return least;
}

/* Movement of a pair, m, after which it is searched again: at most half the gap of closest points that no contact
   follows, so that they are seen before they touch. Beside a closed contact the gap is less by the factor of its
   margin, and so is the gap of closest points that become a minimum there. It is at least what a search resolves. */
static mg_real mg_movement_until_search(const mg_context *c, int pair) {
  const mg_real most = c->settings->search_movement * mg_least_closed_margin(c, pair) * mg_pair_size(c, pair);
  return mg_max(mg_min(most, c->run->unfollowed_gap[pair] / 2), mg_resolved_movement(c, pair));
}

/* Movement of a pair, m, after which its search is repeated where contacts can begin beside those that it has: half the
   least gap, within which nothing can touch, or what is no movement to rounding. A search that was given up is repeated
   after no less than what a search resolves: at nearly the same poses it is given up again. */
static mg_real mg_movement_until_something_touches(const mg_context *c, int pair) {
  mg_real gap = c->run->unfollowed_gap[pair];
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++)
    if (mg_is_on_feature_pair(c, i)) gap = mg_min(gap, mg_max(c->rows.d[i], (mg_real)0));
  const mg_real resolved =
      c->run->withheld_effort[pair] > 0 ? mg_resolved_movement(c, pair) : c->settings->contact_gap * c->system->length;
  return mg_min(mg_max(gap / 2, resolved), mg_movement_until_search(c, pair));
}

/* True if a pair that has moved so far since its last search is to be searched. */
static int mg_is_search_due(const mg_context *c, int pair, mg_real moved) {
  const int search = c->system->pair_search[pair];
  if (mg_is_search_needless(c, pair)) return 0;
  if (c->run->is_search_due[pair] || c->run->watched_movement[pair] > 0) return 1;
  if (search == MG_SEARCH_MOVED || search == MG_SEARCH_APART) return moved >= mg_movement_until_search(c, pair);
  return moved >= mg_movement_until_something_touches(c, pair);
}

MG_INTERNAL int mg_is_contact_at_fold(const mg_context *c, int contact) {
  if (!mg_is_on_feature_pair(c, contact)) return 0;
  if (c->system->pair_search[c->system->contact_pair[contact]] == MG_SEARCH_NEVER) return 0;
  if (c->run->margin[contact] >= mg_fold_margin_limit(c, contact)) return 0;
  return !c->run->closed[contact] || mg_is_time_stepping(c) ||
         mg_is_curved_edge_crossing(c, c->run->feature_pair[contact]);
}

/* True if a contact of the pair ends at a fold. `gap`: the least gap of those at the start of the step, m. */
static int mg_is_pair_at_fold(const mg_context *c, int pair, mg_real *gap) {
  int is_folded = 0;
  *gap = MG_MAX;
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++)
    if (mg_is_contact_at_fold(c, i)) is_folded = 1, *gap = mg_min(*gap, fabs(c->events.gap_before[2 * i]));
  return is_folded;
}

MG_INTERNAL int mg_has_new_penetration(mg_context *c, mg_real h) {
  const mg_system *s = c->system;
  mg_real *const start = c->run->x;
  for (int pair = mg_next_pair(c, -1); pair < s->n_pair; pair = mg_next_pair(c, pair))
    c->search.searched_gap[pair] = MG_NOT_SEARCHED;
  for (int pair = mg_next_pair(c, -1); pair < s->n_pair; pair = mg_next_pair(c, pair)) {
    const mg_real crossed = mg_pair_step_movement(c, pair, h), moved = c->run->moved_since_search[pair] + crossed;
    const int guided = mg_has_own_feature_pairs(c, pair) && s->pair_search[pair] != MG_SEARCH_NEVER &&
                       !mg_has_no_sides(c, s->pair_feature_pair[pair]);
    mg_real gap, searched_gap;
    const int is_folded = mg_is_pair_at_fold(c, pair, &gap), is_due = mg_is_search_due(c, pair, moved) || is_folded;
    if (guided || !is_due || mg_pair_clearance(c, pair) > 0) continue;
    if (is_folded && crossed > mg_max(gap, mg_least_movement(c, pair))) return 1;
    c->run->x = c->step.settled;
    const int found = mg_find_unfollowed_minimum(c, pair, moved, crossed, &searched_gap);
    c->run->x = start;
    if (found == MG_ALL_FOLLOWED) c->search.searched_gap[pair] = searched_gap;
    if (found == MG_NEW_TOUCH) c->search.searched_gap[pair] = MG_TOUCH_FOUND;
    if (found != MG_NEW_PENETRATION) continue;
    mg_update_poses(c, c->run->t, start);
    const int was_there = mg_find_unfollowed_minimum(c, pair, moved, crossed, &gap) == MG_NEW_PENETRATION;
    mg_update_poses(c, c->run->t + h, c->step.settled);
    if (was_there) continue;
    c->run->watched_movement[pair] = mg_max(c->run->watched_movement[pair], crossed);
    return 1;
  }
  return 0;
}

/* True if a gap closes. */
static int mg_is_any_gap_closing(const mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (c->events.triggered[i] == 1 && !c->run->closed[i]) return 1;
  return 0;
}

/* True if a contact of the pair is about to change its feature. */
static int mg_is_pair_changing_features(const mg_context *c, int pair) {
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++)
    if (c->events.triggered[i] >= MG_LEAVES_FEATURE) return 1;
  return 0;
}

MG_INTERNAL int mg_follow_touching_minima(mg_context *c, mg_events *events, mg_real h) {
  int count = 0;
  if (!mg_is_any_gap_closing(c)) return 0;
  for (int pair = mg_next_pair(c, -1); pair < c->system->n_pair; pair = mg_next_pair(c, pair))
    if (c->search.searched_gap[pair] == MG_TOUCH_FOUND && !mg_is_pair_changing_features(c, pair))
      count +=
          mg_search_pair_contacts(c, events, pair, c->run->moved_since_search[pair] + h * mg_pair_speed_bound(c, pair));
  return count;
}

MG_INTERNAL int mg_request_penetration_searches(mg_context *c) {
  MG_NEEDS_AT_RUN(c, MG_VALID_POSES);
  int count = 0;
  for (int pair = mg_next_pair(c, -1); pair < c->system->n_pair; pair = mg_next_pair(c, pair)) {
    const mg_real moved = c->run->moved_since_search[pair];
    mg_real gap;
    if (!(moved > 0) || mg_is_search_needless(c, pair) || mg_pair_clearance(c, pair) > 0) continue;
    if (mg_find_unfollowed_minimum(c, pair, moved, 0, &gap) != MG_NEW_PENETRATION) continue;
    c->run->is_search_due[pair] = 1, count++;
  }
  return count;
}

/* Gap in m up to which the last search of a pair is still valid after its movement since. It allows the least movement:
   steps do not vanish where a margin does. A gap that no contact follows says when to search again, and bounds the
   range where an event must not be passed; in time-stepping the search at the end of the step sees what has touched, as
   deep as the pair has moved. */
static mg_real mg_remaining_search_range(const mg_context *c, int pair) {
  const mg_real most = mg_max(mg_movement_until_search(c, pair), mg_least_movement(c, pair)),
                moved = c->run->moved_since_search[pair], reach = mg_search_reach(c, pair);
  const int is_gap_unfollowed = c->run->unfollowed_gap[pair] < reach && !mg_is_time_stepping(c);
  const mg_real range = is_gap_unfollowed ? mg_min(reach, 2 * most) : reach;
  return range - (moved < most && !c->run->is_search_due[pair] ? moved : most);
}

/* Time in which a motion within bounds covers a way, at least. */
static mg_real mg_time_to_cover(const mg_motion_bound *motion, mg_real way) {
  const mg_real mean = (motion->speed + sqrt(motion->speed * motion->speed + 2 * motion->acceleration * way)) / 2;
  return mean > 0 ? way / mean : MG_MAX;
}

MG_INTERNAL mg_real mg_search_step_limit(const mg_context *c) {
  const mg_system *s = c->system;
  mg_real longest_step = MG_MAX;
  for (int pair = mg_next_pair(c, -1); pair < s->n_pair; pair = mg_next_pair(c, pair)) {
    if (mg_is_search_needless(c, pair)) continue;
    const int unwatched = mg_is_pair_without_contacts(c, pair);
    if (!unwatched && mg_has_guiding_contacts(c, pair)) continue;
    const int speeds_up = unwatched || c->run->unfollowed_gap[pair] < MG_MAX;
    const mg_motion_bound motion = mg_pair_motion_bound(c, pair, speeds_up);
    const mg_real range = mg_max(mg_remaining_search_range(c, pair), (mg_real)0) / (unwatched ? 2 : 1);
    if (!(mg_time_to_cover(&motion, range) < longest_step)) continue;
    longest_step = mg_min(longest_step, mg_time_to_cover(&motion, mg_max(range, mg_pair_clearance(c, pair))));
  }
  return longest_step;
}

/* Release the contacts that end at a fold: a minimum of the distance meets a saddle, or two crossings of edges of
   solids merge, as where the edge of a table leaves a round face that slides off it. Returns their number. */
static int mg_release_folded_contacts(mg_context *c, mg_events *events) {
  int count = 0;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    if (!mg_is_contact_at_fold(c, i)) continue;
    mg_release_contact(c, events, i);
    count++;
  }
  return count;
}

MG_INTERNAL int mg_search_all_pairs(mg_context *c, mg_events *events, mg_real h, int is_repeated) {
  const mg_system *s = c->system;
  int count = mg_release_folded_contacts(c, events);
  mg_release_distant_rim_points(c);
  for (int pair = mg_next_pair(c, -1); pair < s->n_pair; pair = mg_next_pair(c, pair)) {
    if (s->pair_search[pair] == MG_SEARCH_NEVER && mg_is_search_needless(c, pair)) continue;
    const mg_real step = mg_pair_step_movement(c, pair, h);
    if (!is_repeated) c->run->moved_since_search[pair] += step;
    if (!mg_is_search_due(c, pair, c->run->moved_since_search[pair])) continue;
    const mg_real moved = c->run->moved_since_search[pair] + (is_repeated ? step : 0);
    const int is_done = c->search.searched_gap[pair] >= 0 && !c->run->is_search_due[pair];
    if (is_done) c->run->unfollowed_gap[pair] = c->search.searched_gap[pair];
    c->search.searched_gap[pair] = MG_NOT_SEARCHED;
    c->run->moved_since_search[pair] = 0, c->run->is_search_due[pair] = mg_has_opening_patch(c, pair);
    const int found = is_done ? 0 : mg_search_pair_contacts(c, events, pair, moved);
    c->run->watched_movement[pair] = found ? 0 : mg_max(c->run->watched_movement[pair] - step, (mg_real)0);
    count += found;
  }
  return count;
}
