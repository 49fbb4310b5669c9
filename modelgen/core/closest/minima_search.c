/* All local minima of the distance of a pair of shapes: the minima of every feature pair that satisfy its conditions.
   Writes c->search; at the start also feature pairs and eta of the contacts. */
#include "closest/closest.h"
#include "model/model.h"
#include "solid/solid.h"

#define MG_SEARCHES_IN_DEPTH 8 /* searches while a pair moves by appear_depth, at most */

/* Counts a search that was given up in the report of the run, but where flat faces may lie on each other, which patches
   treat. Returns 1 if it was counted. */
static int mg_report_incomplete_search(mg_context *c, int feature_pair) {
  for (int patch = mg_next_patch(c, -1); patch < c->system->n_patch; patch = mg_next_patch(c, patch))
    if (mg_is_feature_pair_in_patch(c, patch, feature_pair)) return 0;
  c->search.incomplete++;
  mg_report_incomplete_pair(c->run, mg_told_pair(c->system, c->run, c->system->feature_pair_owner[feature_pair]));
  return 1;
}

MG_INTERNAL void mg_report_lost_points(mg_context *c, int pair) {
  const int feature_pair = c->system->pair_feature_pair[pair];
  if (mg_is_pair_followed_from_anywhere(c, pair) && mg_is_unconditional_feature_pair(c, feature_pair) &&
      !mg_is_on_feature_pair(c, mg_pair_first_contact(c, pair)))
    mg_report_incomplete_search(c, feature_pair);
}

MG_INTERNAL mg_real mg_separating_plane_gap(mg_context *c, int pair) {
  const mg_system *s = c->system;
  mg_real eta[6] = {0}, next[6], separation = -MG_MAX;
  int groups = 0;
  for (int feature_pair = s->pair_feature_pair[pair]; feature_pair < s->pair_feature_pair[pair + 1]; feature_pair++) {
    const int group = s->feature_pair_group[feature_pair];
    if (group < 0) continue;
    while (groups <= group) c->search.face_gap[groups++] = MG_MAX;
    mg_place_contact(c, mg_use_probe_contact(c, feature_pair), eta, next);
    if (c->search.placement[0] < c->search.face_gap[group]) c->search.face_gap[group] = c->search.placement[0];
  }
  for (int k = 0; k < groups; k++)
    if (c->search.face_gap[k] < MG_MAX && c->search.face_gap[k] > separation) separation = c->search.face_gap[k];
  return separation;
}

MG_INTERNAL void mg_note_unfollowed_gap(mg_context *c, int pair, mg_real d) {
  c->run->unfollowed_gap[pair] = mg_min(c->run->unfollowed_gap[pair], mg_max(d, (mg_real)0));
}

MG_INTERNAL mg_real mg_least_movement(const mg_context *c, int pair) {
  return c->settings->appear_depth / MG_SEARCHES_IN_DEPTH * mg_pair_size(c, pair);
}

MG_INTERNAL void mg_note_missed_gap(mg_context *c, int pair, long before) {
  if (c->search.incomplete > before) mg_note_open_gap(c, 2 * mg_least_movement(c, pair));
}

/* Most pairs of cells that a search of a pair looks at during a run: what searches that were given up have looked at is
   withheld until as many have been looked at by others. */
static long mg_search_effort(const mg_context *c, int pair) {
  return (long)mg_max(MG_EFFORT - c->run->withheld_effort[pair], (mg_real)MG_LEAST_EFFORT);
}

MG_INTERNAL mg_search_limits mg_appearance_limits(const mg_context *c, int pair) {
  const mg_search_limits limits = {mg_search_reach(c, pair), c->settings->appear_depth * mg_pair_length(c, pair),
                                   mg_search_effort(c, pair), MG_MAX};
  return limits;
}

/* True if the minima of a feature pair have to be searched: it is not convex, and has unknowns. */
static int mg_is_searched(const mg_context *c, int feature_pair) {
  const mg_contact_kind *kind = c->kernels->contact_kinds + c->system->feature_pair_kind[feature_pair];
  return !kind->is_convex && kind->n_eta > 0;
}

/* True if they are searched by trees of cells. */
static int mg_is_searched_by_cells(const mg_context *c, int feature_pair) {
  const int parametrisation = mg_parametrisation(c, feature_pair, 0);
  return mg_is_searched(c, feature_pair) && !mg_has_spines(c, feature_pair) && parametrisation != MG_TURN &&
         parametrisation != MG_SIGN;
}

/* True if the contacts of a feature pair end at the end of a curve or of a chart, where no other one of the same shapes
   follows. */
static int mg_ends_openly(const mg_context *c, int feature_pair) {
  const mg_system *s = c->system;
  for (int k = s->feature_pair_condition[feature_pair]; k < s->feature_pair_condition[feature_pair + 1]; k++)
    if (s->condition_kind[k] == MG_CONDITION_PARAMETER &&
        (s->condition_feature_pair[k] == MG_BEYOND_ENDS || mg_leads_to_other_pair(c, feature_pair, k)))
      return 1;
  return 0;
}

/* True if a contact of a pair follows closest points within reach. */
static int mg_is_pair_followed_within_reach(const mg_context *c, int pair) {
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++)
    if (mg_is_on_feature_pair(c, i) && c->rows.d[i] <= mg_search_reach(c, pair)) return 1;
  return 0;
}

MG_INTERNAL mg_real mg_bound_gap_not_found(mg_context *c, int pair, mg_real least, const mg_minima *found) {
  const mg_system *s = c->system;
  const mg_real small = 2 * mg_least_movement(c, pair);
  mg_real bound = MG_MAX;
  if (found->count) return MG_MAX;
  if (least > -MG_MAX / 2) return mg_max(least + c->settings->start_gap * s->length, (mg_real)0);
  if (mg_is_pair_followed_within_reach(c, pair)) return MG_MAX;
  for (int each = s->pair_feature_pair[pair]; each < s->pair_feature_pair[pair + 1] && bound > small; each++)
    if (mg_is_searched_by_cells(c, each) && mg_ends_openly(c, each) && !mg_is_out_of_reach(c, each))
      bound = mg_min(bound, mg_max(mg_bound_distance(c, each, small), small));
  return bound;
}

MG_INTERNAL int mg_find_minima_of_feature_pair(mg_context *c, int feature_pair, const mg_search_limits *limits,
                                               mg_real least, mg_minima *kept) {
  const mg_contact_kind *kind = c->kernels->contact_kinds + c->system->feature_pair_kind[feature_pair];
  const int turn = mg_parametrisation(c, feature_pair, 0) == MG_TURN;
  if (mg_is_replaced_coaxially(c, feature_pair)) return 1;
  if (mg_is_searched(c, feature_pair) && mg_has_spines(c, feature_pair)) {
    mg_search_spines(c, feature_pair, limits, least, kept);
    return 1;
  }
  if (mg_is_searched_by_cells(c, feature_pair)) return mg_search_critical_points(c, feature_pair, limits, least, kept);
  mg_real eta[6] = {turn ? 0 : 1, 0, 0, 0, 0, 0};
  if (mg_converge_from_any_start(c, feature_pair, eta) < 0) return 1;
  if (kind->n_eta == 0 && c->search.placement[0] >= -limits->depth) mg_note_singular_point(c, feature_pair, eta);
  mg_keep_minimum_at(c, feature_pair, eta, least, kept);
  return 1;
}

MG_INTERNAL void mg_search_feature_pair(mg_context *c, int feature_pair, const mg_search_limits *limits, mg_real least,
                                        mg_minima *kept) {
  mg_real *withheld = c->run->withheld_effort + c->system->feature_pair_owner[feature_pair];
  const long before = c->run->search_effort;
  if (mg_is_search_stopped(c)) return;
  const int is_complete = mg_find_minima_of_feature_pair(c, feature_pair, limits, least, kept);
  if (mg_is_search_stopped(c)) return;
  const mg_real looked = (mg_real)(c->run->search_effort - before);
  if (is_complete) *withheld = mg_max(*withheld - looked, (mg_real)0);
  else if (mg_report_incomplete_search(c, feature_pair)) *withheld = mg_min(*withheld + looked, (mg_real)MG_EFFORT);
}

/* True if the gap is not below -start_gap. */
static int mg_is_start_gap_allowed(const mg_context *c, mg_real d) {
  return d >= -c->settings->start_gap * c->system->length;
}

MG_INTERNAL long mg_search_nearest(mg_context *c, int first, int end, mg_real least, long effort, mg_minima *found) {
  const int pair = c->system->feature_pair_owner[first];
  const mg_real near = mg_search_reach(c, pair), length = mg_pair_length(c, pair);
  const long before = c->search.incomplete;
  long incomplete = 0;
  mg_search_limits limits = {near, near, effort, near};
  for (;;) {
    for (int each = first; each < end; each++) mg_search_feature_pair(c, each, &limits, least, found);
    if (limits.gap <= near) incomplete = c->search.incomplete - before;
    const mg_real nearest = mg_min(found->count ? fabs(found->list[0].d) : MG_MAX, c->search.open_gap);
    if (nearest <= limits.gap || !(limits.gap < MG_MAX) || mg_is_search_stopped(c)) return incomplete;
    limits.gap = limits.depth = limits.gap < 1000 * length ? mg_max(8 * limits.gap, length / 8) : MG_MAX;
    if (limits.effort > mg_search_effort(c, pair)) limits.effort = mg_search_effort(c, pair);
  }
}

/* True if closest points that are not isolated touch. */
static int mg_is_singular_contact(const mg_context *c) {
  return fabs(c->search.singular_gap) <= c->settings->start_gap * c->system->length;
}

/* Puts a contact on the closest points that are not isolated, if they penetrate and are nearer than the minima found.
   Returns 1 if they are. */
static int mg_follow_overlap(mg_context *c, int contact, const mg_minima *found) {
  const mg_minimum *overlap = &c->search.overlap;
  if (!(overlap->d > -MG_MAX) || mg_is_start_gap_allowed(c, overlap->d)) return 0;
  if (found->count && fabs(found->list[0].d) <= -overlap->d) return 0;
  mg_set_feature_pair(c, contact, overlap->feature_pair, overlap->eta);
  return 1;
}

/* Outcome of a start without closest points; if they are not isolated, or the search was given up, the shapes conform.
 */
static int mg_refuse_start(const mg_context *c) {
  if (!c->search.incomplete && !mg_is_singular_contact(c)) return MG_NO_EXTREMUM;
  mg_report_margin(c->run, 0);
  return MG_MARGIN;
}

/* Takes back that searches were given up, but for the first `left` of this call. */
static void mg_forget_incomplete_searches(mg_context *c, long left) {
  mg_withdraw_incomplete_searches(c->run, c->search.incomplete - left);
  c->search.incomplete = left;
}

/* Searches feature pairs at the start as mg_search_nearest does. A run follows what is within search_gap: that farther
   closest points may have been missed is reported only if there are none. Returns 0 if some may have been missed. */
static int mg_search_at_start(mg_context *c, int first, int end, mg_real least, mg_minima *found) {
  const long before = c->search.incomplete, incomplete = mg_search_nearest(c, first, end, least, MG_EFFORT, found);
  const int is_complete = c->search.incomplete == before;
  if (found->count) mg_forget_incomplete_searches(c, before + incomplete);
  c->run->withheld_effort[c->system->feature_pair_owner[first]] = 0;
  return is_complete;
}

/* True if closest points form a curve or a surface, and the pair neither touches nor penetrates there. */
static int mg_is_open_gap_allowed(const mg_context *c) {
  return c->search.open_gap < MG_MAX && mg_is_start_gap_allowed(c, c->search.open_gap) && !mg_is_singular_contact(c);
}

/* Negative gaps at which two features may overlap, however deep. Of two curves the sign of the gap is not known
   beforehand. */
static mg_search_limits mg_overlap_limits(const mg_context *c, int feature_pair) {
  const int pair = c->system->feature_pair_owner[feature_pair];
  const mg_real radius_o = mg_pair_ball(c, pair, 0)[3], radius_f = mg_pair_ball(c, pair, 1)[3];
  const int are_curves = mg_feature_dimension(c, feature_pair, 0) < 2 && mg_feature_dimension(c, feature_pair, 1) < 2;
  mg_search_limits limits = {0, MG_MAX, MG_EFFORT, MG_MAX};
  if (radius_o >= 0 && radius_f >= 0) limits.depth = radius_o + radius_f;
  if (are_curves) limits.gap = limits.depth;
  return limits;
}

/* True if the surfaces of both bodies of a pair are all searched against each other by cells, and do not touch but at
   the minima found by a complete search. */
static int mg_are_surfaces_apart(mg_context *c, int first, int end, const mg_minima *found) {
  const int body = mg_feature_body(c, first, 0);
  int surfaces[2] = {0, 0}, searched = 0;
  for (int each = first; each < end; each++) {
    const int dimension[2] = {mg_feature_dimension(c, each, 0), mg_feature_dimension(c, each, 1)};
    for (int side = 0; side < 2; side++)
      if (dimension[side] == 2 && c->system->feature_is_listed[2 * each + side])
        surfaces[mg_feature_body(c, each, side) != body]++;
    if (dimension[0] < 2 || dimension[1] < 2) continue;
    searched++;
    if (!mg_is_searched_by_cells(c, each) || mg_is_replaced_coaxially(c, each) ||
        !mg_are_features_apart(c, each, found))
      return 0;
  }
  return searched > 0 && searched == surfaces[0] * surfaces[1];
}

/* The contact of a pair that can be on a feature pair: its own, or else the given one. */
static int mg_contact_for(const mg_context *c, int contact, int feature_pair) {
  const int *own = c->system->contact_feature_pair, pair = c->system->contact_pair[contact];
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++)
    if (own[i] == feature_pair) return i;
  return contact;
}

/* Puts a contact on the nearest one of minima that penetrates. Returns 1 if there is one. */
static int mg_follow_penetration(mg_context *c, int contact, const mg_minima *found) {
  for (int k = 0; k < found->count; k++) {
    const mg_minimum *at = found->list + k;
    if (mg_is_start_gap_allowed(c, at->d)) continue;
    const int on = mg_contact_for(c, contact, at->feature_pair);
    mg_report_failed_contact(c->run, on);
    mg_set_feature_pair(c, on, at->feature_pair, at->eta);
    return 1;
  }
  return 0;
}

/* Puts a contact on closest points that penetrate, however deep, of feature pairs from `first` to `end`. Returns 1 if
   there are some. */
static int mg_follow_deep_penetration(mg_context *c, int contact, int first, int end, mg_real least) {
  const mg_real open_gap = c->search.open_gap, singular_gap = c->search.singular_gap;
  for (int each = first; each < end; each++) {
    const mg_search_limits limits = mg_overlap_limits(c, each);
    mg_minima found = {0};
    if (mg_has_no_sides(c, each)) continue;
    mg_find_minima_of_feature_pair(c, each, &limits, least, &found);
    if (mg_follow_penetration(c, contact, &found)) return 1;
  }
  c->search.open_gap = open_gap, c->search.singular_gap = singular_gap;
  return mg_follow_overlap(c, contact, &(mg_minima){0});
}

/* True if closest points are within those conditions, too, beyond which a contact would stay. */
static int mg_is_within_all_conditions(mg_context *c, const mg_minimum *at) {
  const int probe_contact = mg_use_probe_contact(c, at->feature_pair);
  mg_real next[6];
  int which;
  mg_place_contact(c, probe_contact, at->eta, next);
  return mg_least_feature_pair_condition(c, at->feature_pair, at->eta, MG_SEARCHED_BEYOND, &which) >=
         -c->settings->feature_border * mg_min(c->system->length, (mg_real)1);
}

/* True if closest points that do not penetrate part the bodies of a pair: those of two convex bodies by the planes
   across their normal. All that there are do where one body is around a convex room, in which the farthest point of the
   other would penetrate most, or is a ball whose centre is not in the other. */
static int mg_do_closest_points_part(mg_context *c, int pair, int are_all, const mg_minima *nearest) {
  const mg_system *s = c->system;
  const int first = s->pair_feature_pair[pair], solid[2] = {mg_solid_of_pair(c, pair, 0), mg_solid_of_pair(c, pair, 1)};
  if (!nearest->count) return 0;
  if (s->pair_feature_pair[pair + 1] == first + 1 && c->kernels->contact_kinds[s->feature_pair_kind[first]].is_convex)
    return 1;
  if (solid[0] >= 0 && solid[1] >= 0 && mg_is_solid_convex(s, solid[0]) && mg_is_solid_convex(s, solid[1]))
    for (int k = 0; k < nearest->count; k++)
      if (mg_is_within_all_conditions(c, nearest->list + k)) return 1;
  for (int side = 0; side < 2 && are_all; side++) {
    if (solid[side] < 0) continue;
    if (mg_is_outside_convex(s, solid[side])) return 1;
    if (!mg_is_solid_ball(s, solid[side]) || !mg_has_material(c, pair, 1 - side)) continue;
    mg_real centre[3];
    mg_to_world(c->bodies.pose + 12 * s->solid_body[solid[side]], s->numbers + s->solid_numbers[solid[side]], 1,
                centre);
    if (mg_height_over_material(c, pair, 1 - side, centre, MG_FIRST_ORDER) > 0) return 1;
  }
  return 0;
}

/* Puts a contact on closest points that penetrate. Returns 1 if there are some among those found. */
static int mg_follow_found(mg_context *c, int contact, const mg_minima *found) {
  return mg_follow_overlap(c, contact, found) ||
         (!(mg_pair_clearance(c, c->system->contact_pair[contact]) > 0) && mg_follow_penetration(c, contact, found));
}

/* Outcome of a start where the bodies of a pair overlap, or MG_DONE, of which closest points that do not penetrate were
   found, all of them or not. Where the material of both is known, deep ones are looked for only to say how deep the
   overlap is; a contact is put on them. */
static int mg_judge_overlap(mg_context *c, int contact, mg_real least, int are_all, const mg_minima *nearest) {
  const int pair = c->system->contact_pair[contact], first = c->system->pair_feature_pair[pair],
            end = c->system->pair_feature_pair[pair + 1];
  if (mg_pair_clearance(c, pair) > 0) return MG_DONE;
  if (least > -2 * c->settings->start_gap * c->system->length || /* a face has all of the other body in front of it */
      mg_do_closest_points_part(c, pair, are_all, nearest))
    return MG_DONE;
  const int is_seen = mg_is_overlap_seen(c, pair);
  if (!is_seen && are_all &&
      (mg_are_materials_known(c, pair) || (nearest->count && mg_are_surfaces_apart(c, first, end, nearest))))
    return MG_DONE;
  if (mg_follow_deep_penetration(c, contact, first, end, least)) return MG_PENETRATION;
  return is_seen ? MG_BODY_WITHIN : MG_DONE;
}

/* Start of a pair whose contacts have feature pairs of their own. Returns an outcome. */
static int mg_start_own_feature_pairs(mg_context *c, int pair) {
  const mg_system *s = c->system;
  const int end = mg_pair_first_contact(c, pair + 1);
  int are_all = 1;
  mg_minima all = {0};
  for (int i = mg_pair_first_contact(c, pair); i < end; i++) {
    const int feature_pair = s->contact_feature_pair[i];
    mg_minima found = {0};
    are_all &= mg_search_at_start(c, feature_pair, feature_pair + 1, -MG_MAX, &found);
    mg_report_failed_contact(c->run, i);
    if (mg_follow_found(c, i, &found)) return MG_PENETRATION;
    for (int k = 0; k < found.count && all.count < MG_MINIMA; k++) all.list[all.count++] = found.list[k];
    const int is_missing =
        !found.count && !mg_is_open_gap_allowed(c) && mg_is_unconditional_feature_pair(c, feature_pair);
    const int is_undecided = found.count && found.list[0].undecided;
    if (i + 1 == end || is_missing || is_undecided) {
      const int outcome = mg_judge_overlap(c, i, -MG_MAX, are_all && i + 1 == end, &all);
      if (outcome) return outcome;
    }
    if (is_missing) return mg_refuse_start(c);
    if (is_undecided) return MG_NO_OUTSIDE;
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
  const int feature_pair = s->pair_feature_pair[pair],
            is_complete = mg_search_at_start(c, feature_pair, s->pair_feature_pair[pair + 1], least, &found);
  mg_report_failed_contact(c->run, first);
  if (mg_follow_found(c, first, &found)) return MG_PENETRATION;
  const int outcome = mg_judge_overlap(c, first, least, is_complete, &found);
  if (outcome) return outcome;
  if (!found.count && !mg_is_open_gap_allowed(c) && mg_is_unconditional_feature_pair(c, feature_pair) &&
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
    mg_note_unfollowed_gap(c, pair, found.list[k].d);
    if (fabs(found.list[k].d) <= c->settings->start_gap * s->length) mg_report_unfollowed_minimum(c, found.list + k);
  }
  mg_note_unfollowed_gap(c, pair, mg_bound_gap_not_found(c, pair, least, &found));
  return MG_DONE;
}

/* Puts the contacts of a pair on its closest points. Returns an outcome. */
static int mg_start_pair(mg_context *c, int pair) {
  mg_forget_noted_gaps(c);
  return mg_has_own_feature_pairs(c, pair) ? mg_start_own_feature_pairs(c, pair)
                                           : mg_start_shared_feature_pairs(c, pair);
}

MG_INTERNAL int mg_follow_closest_points(mg_context *c, int pair) {
  MG_NEEDS_ANY(c, MG_VALID_POSES);
  const int outcome = mg_start_pair(c, pair), contact = mg_pair_first_contact(c, pair);
  int count = 0;
  mg_report_failed_contact(c->run, -1);
  for (int i = contact; i < mg_pair_first_contact(c, pair + 1); i++) {
    if (!mg_is_on_feature_pair(c, i)) continue;
    if (outcome || mg_newton_on_feature_pair(c, i, mg_contact_eta(c, c->run->x, i)) < 0)
      mg_set_feature_pair(c, i, -1, 0);
    else count++;
  }
  return count;
}

/* Puts each limit on its feature pair, where its gap is a function of the poses. Returns an outcome. */
static int mg_start_limits(mg_context *c) {
  for (int i = c->layout.limit_begin; i < c->layout.support_begin; i++) {
    const int feature_pair = c->system->contact_feature_pair[i];
    mg_real eta[MG_MAX_ETA] = {0};
    mg_report_failed_contact(c->run, i);
    if (mg_converge_from_any_start(c, feature_pair, eta) < 0) return MG_NO_EXTREMUM;
    mg_set_feature_pair(c, i, feature_pair, eta);
  }
  return MG_DONE;
}

/* Searches all pairs that take part. Returns an outcome. */
static int mg_search_listed_pairs(mg_context *c) {
  for (int pair = 0; pair < c->system->n_pair; pair++)
    c->run->unfollowed_gap[pair] = MG_MAX, c->run->withheld_effort[pair] = 0;
  for (int i = 0; i < c->layout.support_begin; i++) mg_set_feature_pair(c, i, -1, 0);
  for (int pair = mg_next_pair(c, -1); pair < c->system->n_pair; pair = mg_next_pair(c, pair)) {
    const long incomplete = c->search.incomplete;
    const int outcome = mg_start_pair(c, pair);
    if (mg_is_search_stopped(c)) return MG_CONTINUE;
    if (outcome) return outcome;
    mg_note_missed_gap(c, pair, incomplete);
    mg_note_unfollowed_gap(c, pair, c->search.open_gap);
    c->run->moved_since_search[pair] = c->run->watched_movement[pair] = 0;
    c->run->is_search_due[pair] = c->search.open_gap < MG_MAX;
  }
  return mg_start_limits(c);
}

MG_INTERNAL int mg_search_start_pairs(mg_context *c) {
  c->listed.is_starting = 1; /* one list after all searches in place of one a contact */
  const int outcome = mg_search_listed_pairs(c);
  c->listed.is_starting = 0;
  mg_list_states(c);
  return outcome;
}
