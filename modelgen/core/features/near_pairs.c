/* Pairs of shapes are left out while they are far apart. The broad phase finds the pairs that are near, with a margin
   for each ball around a shape by which its centre may move before it is to look again; no pair that is left out can
   meet as long as no centre has moved farther. A pair that comes near is followed from its closest points, or searched
   at the end of the step. Writes the pairs, feature pairs and margins of the run. */
#include "features/features.h"
#include "base/base.h"
#include "model/model.h"
#include "closest/closest.h"

enum {
  MG_FLOOR_PARTS = 8,  /* least margin: this part of search_gap */
  MG_NEAR_STEPS = 8,   /* steps at the present velocities for which margins suffice, */
  MG_MARGIN_RADII = 1, /* but for movements of more than so many radii */
  MG_MARGIN_CUTS = 5   /* how often margins are cut where slots are too few */
};

/* How far the centre of a ball can move in a step h: by the velocity of its body at both ends of the step, of which
   `change` [6 per body] is what impulses add (0: none), and its acceleration. */
static mg_real mg_ball_reach(const mg_context *c, int ball, mg_real h, const mg_real *change) {
  const int body = c->system->ball_body[ball];
  const mg_real *centre = c->system->ball + 4 * ball, *v = c->bodies.twist + 6 * body,
                *a = c->bodies.acceleration + 6 * body;
  mg_real end[6], start_turn[3], end_turn[3], at_start[3], at_end[3];
  if (c->bodies.motion[body] == MG_FIXED) return 0;
  for (int k = 0; k < 6; k++) end[k] = v[k] + h * a[k] + (change ? change[6 * body + k] : 0);
  mg_cross_product(v + 3, centre, start_turn), mg_cross_product(end + 3, centre, end_turn);
  mg_to_world(c->bodies.pose + 12 * body, start_turn, 0, at_start);
  mg_to_world(c->bodies.pose + 12 * body, end_turn, 0, at_end);
  for (int k = 0; k < 3; k++) at_start[k] += v[k], at_end[k] += end[k];
  return h * sqrt(mg_max(mg_dot3(at_start, at_start), mg_dot3(at_end, at_end)));
}

/* Bound of the motion of the centre of a ball: its speed, and the size of its acceleration. */
static mg_motion_bound mg_ball_motion_bound(const mg_context *c, int ball) {
  const int body = c->system->ball_body[ball];
  const mg_real *centre = c->system->ball + 4 * ball, *twist = c->bodies.twist + 6 * body,
                *rate = c->bodies.acceleration + 6 * body;
  const mg_real arm = sqrt(mg_dot3(centre, centre)), spin = sqrt(mg_dot3(twist + 3, twist + 3));
  const mg_motion_bound motion = {sqrt(mg_dot3(twist, twist)) + arm * spin,
                                  sqrt(mg_dot3(rate, rate)) + arm * (sqrt(mg_dot3(rate + 3, rate + 3)) + spin * spin)};
  return motion;
}

MG_INTERNAL void mg_forget_margins(mg_context *c) {
  for (int b = 0; b < c->system->n_ball; b++) c->run->ball_at[4 * b + 3] = -1;
}

/* True if a ball could leave its margin in a step h. */
static int mg_could_leave_margins(const mg_context *c, mg_real h, const mg_real *change) {
  for (int b = 0; b < c->system->n_ball; b++)
    if (c->system->ball[4 * b + 3] >= 0 &&
        !(mg_ball_movement(c, b) + mg_ball_reach(c, b, h, change) <= c->run->ball_at[4 * b + 3]))
      return 1;
  return 0;
}

/* Sets the margins to a part of what some steps of h could need, but not much more than a body's own size, so that few
   pairs are near; where the step is given, to no less than what one needs. */
static void mg_set_margins(mg_context *c, mg_real h, const mg_real *change, int is_step_given, mg_real part) {
  const mg_real least = c->settings->search_gap * c->system->length / MG_FLOOR_PARTS;
  for (int b = 0; b < c->system->n_ball; b++) {
    const mg_real reach = mg_ball_reach(c, b, h, change),
                  most = mg_max(MG_MARGIN_RADII * c->system->ball[4 * b + 3], c->system->length);
    mg_ball_centre(c, b, c->run->ball_at + 4 * b);
    c->run->ball_at[4 * b + 3] = mg_max(part * mg_min(MG_NEAR_STEPS * reach, most), is_step_given ? reach : 0) + least;
  }
}

/* Clears the contacts of a pair: they are on no feature pair, without events and without force. */
static void mg_clear_pair(mg_context *c, int pair) {
  const mg_system *s = c->system;
  for (int i = s->pair_contact[pair]; i < s->pair_contact[pair + 1]; i++) {
    mg_set_feature_pair(c, i, -1, 0);
    c->events.triggered[i] = c->events.within_border[i] = c->events.gap_dips[i] = c->events.is_near[i] =
        c->patches.is_covered[i] = 0;
    c->run->force[i] = c->solution.force[i] = c->solution.impulse[i] = 0;
    for (int g = s->contact_friction[i]; g < s->contact_friction[i + 1]; g++)
      mg_set_friction_mode(c, g, MG_FRICTION_OFF),
          c->friction.mode_before[g] = MG_FRICTION_OFF,
          c->friction.triggered[g] = c->friction.is_yielding[g] = c->friction.is_stiff[g] = 0,
          c->friction.slip_time_left[g] = 0;
    for (int k = s->contact_friction_row[i]; k < s->contact_friction_row[i + 1]; k++)
      c->solution.force[c->layout.friction_row_begin + k] = 0;
  }
}

/* Places the contacts of a pair. Needs the poses. */
static void mg_place_entered_pair(mg_context *c, int pair) {
  MG_NEEDS_ANY(c, MG_VALID_POSES);
  for (int i = c->system->pair_contact[pair]; i < c->system->pair_contact[pair + 1]; i++) {
    if (!mg_is_on_feature_pair(c, i)) continue;
    mg_place_contact(c, i, mg_contact_eta(c, c->run->x, i), c->search.placement + 32);
    c->rows.d[i] = c->search.placement[0], c->run->margin[i] = mg_placement_uniqueness(c, i);
  }
}

/* Begins to follow a pair: from its closest points, or by a search at the end of the step. Needs the poses. Scratch of
   its contacts may be of another run. */
static void mg_enter_pair(mg_context *c, int pair) {
  MG_NEEDS_ANY(c, MG_VALID_POSES);
  mg_clear_pair(c, pair);
  if (!mg_is_pair_followed_from_anywhere(c, pair)) {
    c->run->is_search_due[pair] = 1, c->run->unfollowed_gap[pair] = MG_MAX;
    c->run->moved_since_search[pair] = c->run->watched_movement[pair] = 0;
    if (c->system->pair_search[pair] == MG_SEARCH_NEVER && mg_follow_closest_points(c, pair))
      mg_place_entered_pair(c, pair);
    return;
  }
  for (int i = c->system->pair_contact[pair]; i < c->system->pair_contact[pair + 1]; i++) {
    mg_real eta[MG_MAX_ETA] = {0};
    if (mg_converge_from_any_start(c, c->system->contact_feature_pair[i], eta) < 0) continue;
    mg_set_feature_pair(c, i, c->system->contact_feature_pair[i], eta);
  }
  mg_place_entered_pair(c, pair);
}

/* Loads the bodies of the support points of slots that no patch holds. */
static void mg_load_supports_of_slots(mg_context *c) {
  for (int i = c->layout.support_begin; i < c->system->n_contact; i++)
    if (mg_is_slot(c->system, c->system->contact_pair[i]) && !mg_is_on_feature_pair(c, i)) mg_load_feature_pair(c, i);
}

/* Lists the pairs that are never left out and those found, both ascending; those found that were left out are kept in
   c->listed.found. Returns their number. */
static int mg_merge_found_pairs(mg_context *c) {
  mg_listing *l = &c->listed;
  int always = 0, entered = 0;
  l->n_listed = 0;
  for (int k = 0; k < l->n_found; k++) {
    const int pair = l->found[k];
    while (always < l->n_always && l->always[always] < pair) l->listed[l->n_listed++] = l->always[always++];
    l->listed[l->n_listed++] = pair;
    if (c->run->is_far[pair]) l->found[entered++] = pair;
  }
  while (always < l->n_always) l->listed[l->n_listed++] = l->always[always++];
  return entered;
}

/* Leaves out the pairs that are in the present list and not in the new one. Returns their number. */
static int mg_leave_far_pairs(mg_context *c) {
  const mg_listing *l = &c->listed;
  int k = 0, count = 0;
  for (int pair = mg_next_pair(c, -1); pair < c->system->n_pair; pair = mg_next_pair(c, pair)) {
    while (k < l->n_listed && l->listed[k] < pair) k++;
    if (k == l->n_listed || l->listed[k] != pair) c->run->is_far[pair] = 1, mg_clear_pair(c, pair), count++;
  }
  return count;
}

/* Finds the near pairs, with smaller margins where a pool has too few slots for them. The run tells if it still has. */
static void mg_find_pairs_within_slots(mg_context *c, mg_real h, const mg_real *change, int is_step_given) {
  mg_real part = 1;
  for (int k = 0; k < MG_MARGIN_CUTS; k++, part /= 4) {
    mg_set_margins(c, h, change, is_step_given, part);
    mg_find_near_pairs(c);
    if (c->listed.slots.exceeded < 0) return;
  }
  mg_report_too_many_near(c->run, c->listed.slots.exceeded);
}

/* Looks for near pairs anew, with margins for some steps of h. Returns how many pairs come near or are left out. */
static int mg_update_near_pairs(mg_context *c, mg_real h, const mg_real *change, int is_step_given) {
  mg_find_pairs_within_slots(c, h, change, is_step_given);
  c->listed.n_found = mg_merge_found_pairs(c);
  const int left = mg_leave_far_pairs(c);
  for (int k = 0; k < c->listed.n_found; k++) c->run->is_far[c->listed.found[k]] = 0;
  mg_list_pairs(c);
  for (int k = 0; k < c->listed.n_found; k++) mg_enter_pair(c, c->listed.found[k]);
  if (c->system->n_pool && c->listed.n_found) mg_load_supports_of_slots(c), mg_forget_incidence(c);
  return left + c->listed.n_found;
}

MG_INTERNAL void mg_begin_near_pairs(mg_context *c) {
  for (int pair = 0; pair < c->system->n_pair; pair++) c->run->is_far[pair] = 0;
  mg_empty_slots(c);
  mg_init_listing(c);
  if (!c->listed.has_candidates) return;
  for (int i = 0; i < c->layout.support_begin; i++) mg_set_feature_pair(c, i, -1, 0);
  mg_update_near_pairs(c, 0, 0, 0);
}

MG_INTERNAL int mg_choose_near_pairs(mg_context *c, mg_real h, const mg_real *change, int is_step_given) {
  MG_NEEDS_ANY(c, MG_VALID_TWISTS), MG_NEEDS_ANY(c, MG_VALID_FREE);
  c->listed.n_found = 0;
  if (!c->listed.has_candidates || !mg_could_leave_margins(c, h, change)) return 0;
  return mg_update_near_pairs(c, h, change, is_step_given) > 0;
}

MG_INTERNAL mg_real mg_near_pair_step_limit(const mg_context *c) {
  mg_real longest_step = MG_MAX;
  for (int b = 0; b < c->system->n_ball && c->listed.has_candidates; b++) {
    if (c->system->ball[4 * b + 3] < 0 || c->bodies.motion[c->system->ball_body[b]] == MG_FIXED) continue;
    const mg_real left = c->run->ball_at[4 * b + 3] - mg_ball_movement(c, b);
    const mg_motion_bound motion = mg_ball_motion_bound(c, b);
    const mg_real mean = (motion.speed + sqrt(motion.speed * motion.speed + 4 * motion.acceleration * left)) / 2;
    if (mean * longest_step > left) longest_step = left / mean;
  }
  return longest_step;
}
