/* What of the scene takes part at present: the contacts of all pairs of shapes that are not far apart, with their rows,
   friction constraints, and the eta of those on a feature pair. Loops over contacts, rows, constraints, pairs and
   states visit these alone, so that a step costs nothing for pairs that cannot meet. Writes c->listed. */
#include "model/model.h"

enum { MG_LEFT_BY_BODY = 8 }; /* closest points that the contacts of a body leave in a step, as a rule at most */

MG_INTERNAL void mg_copy_states(const mg_context *c, const mg_real *from, mg_real *to) {
  for (int range = 0; range < c->listed.n_range; range++)
    mg_copy_reals(to + mg_range_begin(c, range), from + mg_range_begin(c, range),
                  mg_range_end(c, range) - mg_range_begin(c, range));
}

MG_INTERNAL int mg_are_states_finite(const mg_context *c, const mg_real *x) {
  for (int range = 0; range < c->listed.n_range; range++)
    if (!mg_all_finite(mg_range_end(c, range) - mg_range_begin(c, range), x + mg_range_begin(c, range))) return 0;
  return 1;
}

/* Appends states to the ranges. */
static void mg_append_range(mg_listing *l, int begin, int end) {
  if (begin == end) return;
  if (l->n_range && l->range[2 * l->n_range - 1] == begin) {
    l->range[2 * l->n_range - 1] = end;
    return;
  }
  l->range[2 * l->n_range] = begin, l->range[2 * l->n_range + 1] = end;
  l->n_range++;
}

/* Last members of the lists while they are made; the probe contact stands between contacts and other rows. */
typedef struct {
  int contact, friction_row, constraint;
} mg_list_ends;

MG_INTERNAL void mg_list_states(mg_context *c) {
  const mg_system *s = c->system;
  mg_listing *l = &c->listed;
  l->n_range = 0;
  mg_append_range(l, 0, s->n_q + s->n_u);
  for (int i = mg_next_row(c, -1); i < s->n_contact; i = mg_next_row(c, i)) {
    const int eta = s->n_q + s->n_u + s->contact_eta[i];
    mg_append_range(l, eta, eta + c->contacts.n_eta[i]);
  }
  mg_append_range(l, c->layout.work_state, c->layout.n_states);
}

/* Appends a contact with its friction rows and constraints. */
static void mg_append_contact(mg_context *c, int contact, mg_list_ends *last) {
  const mg_system *s = c->system;
  mg_listing *l = &c->listed;
  l->row[last->contact + 1] = contact, last->contact = contact, l->n_contact++;
  for (int k = s->contact_friction_row[contact]; k < s->contact_friction_row[contact + 1]; k++)
    l->row[last->friction_row + 1] = c->layout.friction_row_begin + k,
                                last->friction_row = c->layout.friction_row_begin + k;
  for (int g = s->contact_friction[contact]; g < s->contact_friction[contact + 1]; g++)
    l->constraint[last->constraint + 1] = g, last->constraint = g;
}

/* Lists the patches of pairs that are not slots, and of slots that take part. */
static void mg_list_patches(mg_context *c) {
  const mg_system *s = c->system;
  int last = -1;
  for (int patch = 0; patch < s->n_patch; patch++)
    if (!mg_is_slot(s, s->patch_pair[patch]) || !c->run->is_far[s->patch_pair[patch]])
      c->listed.patch[last + 1] = patch, last = patch;
  c->listed.patch[last + 1] = s->n_patch;
}

MG_INTERNAL void mg_list_pairs(mg_context *c) {
  const mg_system *s = c->system;
  mg_listing *l = &c->listed;
  mg_list_ends last = {-1, c->layout.friction_row_begin - 1, -1};
  int pair = -1;
  l->n_contact = 0;
  for (int k = 0; k < l->n_listed; k++) {
    l->pair[pair + 1] = l->listed[k], pair = l->listed[k];
    for (int i = s->pair_contact[pair]; i < s->pair_contact[pair + 1]; i++) mg_append_contact(c, i, &last);
  }
  l->pair[pair + 1] = s->n_pair;
  for (int i = c->layout.limit_begin; i < s->n_contact; i++) mg_append_contact(c, i, &last);
  l->row[last.contact + 1] = s->n_contact;
  for (int i = s->n_contact; i < c->layout.friction_row_begin - 1; i++) l->row[i + 1] = i + 1;
  l->row[last.friction_row + 1] = c->layout.spring_row_begin;
  for (int i = c->layout.spring_row_begin; i < c->layout.spring_row_end; i++) l->row[i + 1] = i + 1;
  l->constraint[last.constraint + 1] = s->n_friction;
  mg_list_patches(c);
  mg_list_states(c);
}

/* True if one shape of a pair is a plane that does not move, and the other one is bounded. */
static int mg_is_pair_over_fixed_plane(const mg_context *c, int pair) {
  const mg_system *s = c->system;
  const int first = s->pair_feature_pair[pair], side = mg_unbounded_side(c, pair);
  if (mg_pair_ball(c, pair, side)[3] >= 0 || mg_pair_ball(c, pair, 1 - side)[3] < 0) return 0;
  const int body = mg_feature_body(c, first, side), numbers = s->feature_numbers[2 * first + side];
  if (c->bodies.motion[body] != MG_FIXED) return 0;
  for (int each = first; each < s->pair_feature_pair[pair + 1]; each++) {
    const int plane = mg_feature_body(c, each, 1) == body;
    if (mg_shape_kind_of(c, each, plane)->nearest_point != MG_NEAREST_PLANE ||
        s->feature_numbers[2 * each + plane] != numbers)
      return 0;
  }
  return 1;
}

MG_INTERNAL int mg_may_be_far(const mg_context *c, int pair) {
  if (mg_is_slot(c->system, pair)) return 1;
  return c->system->pair_is_candidate[pair] && (mg_has_pair_extents(c, pair) || mg_is_pair_over_fixed_plane(c, pair)) &&
         (c->system->pair_search[pair] != MG_SEARCH_NEVER || mg_is_pair_followed_from_anywhere(c, pair));
}

MG_INTERNAL int mg_is_pair_followed_from_anywhere(const mg_context *c, int pair) {
  const mg_system *s = c->system;
  const int count = s->pair_contact[pair + 1] - s->pair_contact[pair];
  if (s->pair_search[pair] != MG_SEARCH_NEVER || count != s->pair_feature_pair[pair + 1] - s->pair_feature_pair[pair])
    return 0;
  for (int i = s->pair_contact[pair]; i < s->pair_contact[pair + 1]; i++) {
    const int own = s->contact_feature_pair[i];
    if (own < 0 || (count > 1 && !mg_is_unconditional_feature_pair(c, own))) return 0;
    const mg_contact_kind *kind = c->kernels->contact_kinds + s->feature_pair_kind[own];
    if (!kind->is_convex && kind->n_eta > 0) return 0;
  }
  return 1;
}

MG_INTERNAL int mg_abandoned_capacity(const mg_system *s) { return MG_MINIMA + MG_LEFT_BY_BODY * s->n_body; }

MG_INTERNAL void mg_init_listing(mg_context *c) {
  mg_listing *l = &c->listed;
  l->n_always = l->n_listed = l->n_over_plane = l->is_starting = 0;
  for (int pair = 0; pair < c->layout.limit_pair_begin; pair++) {
    if (!mg_may_be_far(c, pair)) l->always[l->n_always++] = pair;
    else if (!mg_has_pair_extents(c, pair)) l->over_plane[l->n_over_plane++] = pair;
    if (!c->run->is_far[pair]) l->listed[l->n_listed++] = pair;
  }
  l->has_candidates = l->n_always < c->layout.limit_pair_begin;
  mg_list_pairs(c);
}
