/* Contacts on the move: from link to link where a condition ends, onto a link where one appears. */
/* Touching contacts that come to the end of an edge: there a vertex is on an edge or on another vertex, and no normal
   is told. What follows is told a moment later. */
#include "features/features.h"
#include "base/base.h"
#include "model/model.h"
#include "closest/closest.h"

#define MG_FEATURE_CHANGES_MAX 8 /* links passed in one walk: around a vertex, several */

/* The coordinates of a shape nearest to a point in its axes. */
static void mg_nearest(mg_context *c, int link, int side, const mg_real *local, mg_real *uv) {
  mg_real window[4];
  mg_sample_window(c, link, side, mg_search_radius(c, link), window);
  for (int level = 0; level < 4; level++) {
    const int n = mg_sample_side(c, link, side, window, 9, c->search.samples);
    mg_real least = MG_MAX;
    for (int i = 0; i < n; i++) {
      const mg_real *x = c->search.samples[i].local, span[3] = {x[0] - local[0], x[1] - local[1], x[2] - local[2]};
      const mg_real distance = mg_dot3(span, span);
      if (distance < least) least = distance, uv[0] = c->search.samples[i].uv[0], uv[1] = c->search.samples[i].uv[1];
    }
    mg_shrink_window(window, uv);
  }
}

/* eta of a link from points of the world near its own. */
static void mg_eta_near(mg_context *c, int link, const mg_real *point_o, const mg_real *point_f, mg_real *eta) {
  mg_sample at[2];
  for (int side = 0; side < 2; side++) {
    const int carrier = mg_parametrisation(c, link, side);
    mg_point_in_shape_axes(c, link, side, side ? point_f : point_o, at[side].local);
    if (carrier == MG_CHART || carrier == MG_CURVE || carrier == MG_SIGNED_CURVE)
      mg_nearest(c, link, side, at[side].local, at[side].uv);
  }
  mg_start_eta(c, link, at, at + 1, eta);
}

/* From one link to another with the points and the normal kept as near as can be. Returns the worst condition
   there, -MG_MAX where no extremum is found. */
static mg_real mg_step_over(mg_context *c, int from, int to, const mg_real *at, mg_real *eta, int *which) {
  const int turned = mg_side_body(c, from, 0) != mg_side_body(c, to, 0), spare = mg_use_spare_contact(c, to);
  mg_real next[6];
  *which = -1;
  mg_eta_near(c, to, at + (turned ? 11 : 8), at + (turned ? 8 : 11), eta);
  if (mg_newton_on_link(c, spare, eta) < 0 || !(mg_placement_margin(c) > c->settings->lost)) return -MG_MAX;
  if (mg_has_signs(c, to) && (mg_dot3(c->search.placement + 5, at + 5) < 0) != turned)
    mg_reverse_normal(c, to, eta), mg_place_contact(c, spare, eta, next);
  return mg_most_violated_condition(c, to, eta, which);
}

/* True if a contact of the pair other than this one is there already, or will be once its eta has settled. */
MG_INTERNAL int mg_is_already_contact(mg_context *c, int pair, int contact, const mg_minimum *found) {
  mg_real eta[6];
  mg_minimum other;
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++) {
    if (i == contact || !mg_is_on_link(c, i)) continue;
    for (int k = 0; k < c->n_eta[i]; k++) eta[k] = mg_contact_eta(c, c->run->x, i)[k];
    mg_newton_on_link(c, i, eta);
    other.link = c->run->link[i];
    mg_record_minimum(c, &other);
    if (mg_is_same_minimum(c, &other, found)) return 1;
  }
  return 0;
}

/* The contacts of the pair that are there keep steps short enough for those that are not: each link has its own, and
   one ends where the next begins. */
static int mg_is_led(const mg_context *c, int pair) {
  return mg_has_own_links(c, pair) && c->system->pair_search[pair] != MG_SEARCH_AHEAD;
}

/* It only keeps steps short enough for what it is to touch later. */
static int mg_only_leads(const mg_context *c, int link, mg_real d) {
  return d > c->settings->reach * c->system->length && mg_is_led(c, c->system->link_pair[link]) &&
         !mg_is_flat_link(c, link);
}

/* Its coming and going is not told. */
static int mg_is_untold(const mg_context *c, int link, mg_real d) {
  return mg_is_flat_link(c, link) || mg_only_leads(c, link, d);
}

MG_INTERNAL void mg_leave_link(mg_context *c, mg_events *events, int contact) {
  const mg_real none[6] = {0};
  mg_real next[6];
  if (c->search.abandoned.count < MG_MINIMA) {
    mg_minimum *left = c->search.abandoned.list + c->search.abandoned.count++;
    mg_place_contact(c, contact, mg_contact_eta(c, c->run->x, contact), next);
    left->link = c->run->link[contact];
    mg_record_minimum(c, left);
  }
  const int untold = mg_is_untold(c, c->run->link[contact], c->d[contact]);
  mg_set_link(c, contact, -1, none);
  c->run->moved[c->system->contact_pair[contact]] = MG_MAX / 2; /* is searched at once */
  if (!untold) mg_apply_transition(c, events, contact, MG_CONTACT_VANISHES, c->run->t, 0);
}

static int mg_is_pointed(const mg_context *c, int link) {
  return mg_side_dimension(c, link, 0) + mg_side_dimension(c, link, 1) < 2;
}

/* Around a vertex that is on an edge: the link with the least gap of those whose conditions will hold in a moment, or
   -1. `at` is where the contact is. */
static int mg_link_around(mg_context *c, int from, int corner, const mg_real *at) {
  mg_real least = c->settings->apart * c->system->length, eta[6];
  int best = -1, which;
  mg_extrapolate_poses(c);
  for (int k = c->system->link_condition[corner]; k < c->system->link_condition[corner + 1]; k++) {
    const int to = c->system->condition_next[k];
    if (to < 0 || to == from || mg_is_pointed(c, to) || mg_is_covered(c, to)) continue;
    if (mg_step_over(c, from, to, at, eta, &which) < -c->settings->border || !(fabs(c->search.placement[0]) < least))
      continue;
    least = fabs(c->search.placement[0]), best = to;
  }
  mg_update_poses(c, c->run->t, c->run->x);
  return best;
}

/* From a link over a corner, where they touch, to another; returns 0 where there is none. */
static int mg_pass_corner(mg_context *c, int from, int corner, const mg_real *at, mg_minimum *found) {
  int which;
  const int to = mg_link_around(c, from, corner, at);
  if (to < 0 || mg_step_over(c, from, to, at, found->eta, &which) == -MG_MAX) return 0;
  found->link = to;
  mg_record_minimum(c, found);
  return 1;
}

/* Needs the poses at run->x and c->events.broken_condition of the contact; hops until the conditions of a link hold. */
static void mg_walk(mg_context *c, mg_events *events, int contact) {
  mg_real eta[6] = {0}, at[14], best = -MG_MAX;
  mg_minimum found = {0};
  int link = c->run->link[contact], way = c->events.broken_condition[contact];
  mg_place_contact(c, contact, mg_contact_eta(c, c->run->x, contact), eta);
  for (int k = 0; k < 14; k++) at[k] = c->search.placement[k];
  found.link = -1;
  for (int hop = 0; hop < MG_FEATURE_CHANGES_MAX && way >= 0; hop++) {
    const int to = c->system->condition_next[way];
    if (to < 0 || mg_is_covered(c, to)) break;
    if (mg_is_pointed(c, to) && fabs(at[0]) < c->settings->apart * c->system->length &&
        mg_pass_corner(c, link, to, at, &found)) {
      best = 0;
      break;
    }
    const mg_real worst = mg_step_over(c, link, to, at, eta, &way);
    if (worst == -MG_MAX) break;
    if (worst > best && to != c->run->link[contact]) {
      best = worst, found.link = to;
      mg_record_minimum(c, &found);
      for (int k = 0; k < 6; k++) found.eta[k] = eta[k];
    }
    if (worst >= -c->settings->border) break;
    for (int k = 0; k < 14; k++) at[k] = c->search.placement[k];
    link = to;
  }
  const int nowhere = found.link < 0 || best < -100 * c->settings->border;
  if (nowhere || mg_is_already_contact(c, c->system->contact_pair[contact], contact, &found)) {
    mg_leave_link(c, events, contact);
    return;
  }
  mg_set_link(c, contact, found.link, found.eta);
  mg_apply_transition(c, events, contact, MG_FEATURE_CHANGES, c->run->t, 0);
}

/* Walks for all contacts marked MG_LEAVES_FEATURE in c->events.triggered, and sees to the marks MG_PASSES_BORDER.
 * Returns how many changed. */
MG_INTERNAL int mg_change_features(mg_context *c, mg_events *events) {
  int count = 0;
  for (int i = 0; i < c->system->n_contact; i++) {
    const int cause = c->events.triggered[i];
    if (cause != MG_LEAVES_FEATURE && cause != MG_PASSES_BORDER) continue;
    c->events.triggered[i] = 0;
    if (cause == MG_LEAVES_FEATURE) mg_walk(c, events, i);
    else
      c->events.within_border[i] = MG_PASSES_BORDER,
      c->run->moved[c->system->contact_pair[i]] = MG_MAX / 2; /* is searched at once */
    count += cause == MG_LEAVES_FEATURE;
  }
  return count;
}

/* ---- contacts that end and appear ---- */
/* Far points of a rim that is no longer flat are not followed. */
static void mg_leave_far(mg_context *c) {
  const mg_real none[6] = {0};
  mg_real next[6];
  int which;
  for (int i = 0; i < c->support_begin; i++) {
    if (!mg_is_on_link(c, i) || c->run->closed[i] || !mg_is_distant_flat_link(c, i)) continue;
    mg_place_contact(c, i, mg_contact_eta(c, c->run->x, i), next);
    if (mg_most_violated_condition(c, c->run->link[i], none, &which) >= -c->settings->border) continue;
    mg_set_link(c, i, -1, none);
    c->run->moved[c->system->contact_pair[i]] = MG_MAX / 2; /* is searched at once */
  }
}

/* A contact of the pair that is free for what was found: its own, an empty one, or the open one farthest off. */
MG_INTERNAL int mg_free_contact_for(const mg_context *c, int pair, const mg_minimum *found) {
  int slot = -1;
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++) {
    if (c->system->contact_link[i] == found->link) return mg_is_on_link(c, i) ? -1 : i;
    if (c->system->contact_link[i] >= 0 || c->run->closed[i] || c->d[i] <= found->d) continue;
    if (slot < 0 || c->d[i] > c->d[slot]) slot = i;
  }
  return slot;
}

/* What a search during a run takes up: within reach unless it is to keep steps short, not below the depth, not about to
   end. */
MG_INTERNAL int mg_is_within_search(const mg_context *c, const mg_minimum *found) {
  const mg_real length = c->system->length;
  const int own = mg_has_own_links(c, c->system->link_pair[found->link]);
  const int far = found->d > c->settings->reach * length && !mg_only_leads(c, found->link, found->d);
  if (found->undecided || far || found->d < -c->settings->depth * length) return 0;
  const int flat = mg_is_tilted_link(c, found->link); /* its margin is small near flat, not near a fold */
  return found->margin >= (own || flat ? c->settings->margin_refuse : c->settings->margin_appear);
}

/* The link has a contact of its own, which is on it. */
static int mg_is_taken(const mg_context *c, int pair, int link) {
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++)
    if (c->system->contact_link[i] == link) return mg_is_on_link(c, i);
  return 0;
}

/* Its point of one of the bodies touches the other already: that it is below another face there is no matter. */
static int mg_touches_there(mg_context *c, const mg_minimum *found) {
  const mg_real near = c->settings->apart * c->system->length;
  const int pair = c->system->link_pair[found->link];
  mg_real eta[6];
  mg_minimum other;
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++) {
    if (!c->run->closed[i]) continue;
    mg_place_contact(c, i, mg_contact_eta(c, c->run->x, i), eta);
    other.link = c->run->link[i];
    mg_record_minimum(c, &other);
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

/* What was found touches there already, and as itself is below zero, or ends in a moment. */
static int mg_is_idle(mg_context *c, const mg_minimum *found) {
  if (found->d > c->settings->start_gap * c->system->length || !mg_touches_there(c, found)) return 0;
  return found->d < -c->settings->start_gap * c->system->length || mg_is_about_to_leave_link(c, found);
}

MG_INTERNAL int mg_search_pair(mg_context *c, mg_events *events, int pair) {
  const mg_system *s = c->system;
  if (mg_pair_clearance(c, pair) > c->settings->reach * s->length) return 0;
  const mg_real least = mg_separating_plane_gap(c, pair) - c->settings->start_gap * s->length;
  mg_minima found;
  int count = found.count = 0;
  for (int link = s->pair_link[pair]; link < s->pair_link[pair + 1]; link++)
    if (!mg_is_taken(c, pair, link) && !mg_is_covered(c, link) && !mg_is_out_of_reach(c, link))
      mg_search_link(c, link, MG_COARSE, 1, least, &found);
  for (int k = 0; k < found.count; k++) {
    const mg_minimum *each = found.list + k;
    if (!mg_is_within_search(c, each) || mg_is_idle(c, each)) continue;
    const int slot = mg_is_already_contact(c, pair, -1, each) ? -1 : mg_free_contact_for(c, pair, each);
    if (slot < 0) continue;
    mg_set_link(c, slot, each->link, each->eta);
    c->d[slot] = each->d;
    if (!mg_is_untold(c, each->link, each->d)) mg_apply_transition(c, events, slot, MG_CONTACT_APPEARS, c->run->t, 0);
    count++;
  }
  return count;
}

/* No contact of the pair is on a link: nothing else keeps steps from passing through. */
static int mg_is_unwatched(const mg_context *c, int pair) {
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++)
    if (mg_is_on_link(c, i)) return 0;
  return !mg_has_held_patch(c, pair);
}

/* What the last search of a pair has seen all of, less what the pair has moved since. */
static mg_real mg_still_seen(const mg_context *c, int pair) {
  const mg_real length = c->system->length, most = c->settings->search * length, moved = c->run->moved[pair];
  return c->settings->reach * length - (moved < most ? moved : most);
}

/* The longest step in which no pair moves past what its next search can still see; where each link has a contact of
   its own and one ends where the next begins, those that are there do for the others. */
MG_INTERNAL mg_real mg_search_step_limit(const mg_context *c) {
  const mg_system *s = c->system;
  mg_real sight = MG_MAX;
  for (int pair = 0; pair < s->n_pair; pair++) {
    if (s->pair_search[pair] == MG_SEARCH_NEVER) continue;
    const int unwatched = mg_is_unwatched(c, pair);
    if (!unwatched && mg_is_led(c, pair)) continue;
    const mg_real way = mg_still_seen(c, pair) / (unwatched ? 2 : 1) + mg_pair_clearance(c, pair);
    const mg_motion_bound motion = mg_pair_motion(c, pair);
    const mg_real speed = motion.speed, pull = unwatched ? motion.acceleration : 0;
    const mg_real mean = (speed + sqrt(speed * speed + 2 * pull * way)) / 2;
    if (mean * sight > way) sight = way / mean;
  }
  return sight;
}

/* After an accepted step of length h: leaves contacts that end, looks for such as appear. Returns how many. */
MG_INTERNAL int mg_search_moved_pairs(mg_context *c, mg_events *events, mg_real h) {
  const mg_system *s = c->system;
  int count = mg_leave_bifurcations(c, events);
  mg_leave_far(c);
  for (int pair = 0; pair < s->n_pair; pair++) {
    if (s->pair_search[pair] == MG_SEARCH_NEVER) continue;
    c->run->moved[pair] += h * mg_pair_motion(c, pair).speed;
    if (s->pair_search[pair] == MG_SEARCH_MOVED && c->run->moved[pair] < c->settings->search * s->length) continue;
    c->run->moved[pair] = mg_is_pair_unfolding(c, pair) ? MG_MAX / 2 : 0;
    count += mg_search_pair(c, events, pair);
  }
  return count;
}
