/* What a debug core (MG_DEBUG) asserts: digests of the states at which the parts of the context were evaluated, and the
   ranges of the tables of a system. Writes nothing but c->valid. */
#include "model/model.h"
#include "base/base.h"

#ifdef MG_DEBUG

/* The digest with a friction mode; slip that has just begun has the forces of slip. */
static mg_digest mg_digest_friction_mode(mg_digest digest, int mode) {
  const int law = mode > MG_SLIP_ONSET ? MG_SLIP_ONSET : mode;
  return mg_digest_ints(digest, &law, 1);
}

/* The digest with the modes on which forces depend. */
static mg_digest mg_digest_modes(const mg_context *c, mg_digest digest) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    digest = mg_digest_ints(mg_digest_ints(digest, c->run->active + i, 1), c->run->feature_pair + i, 1);
  for (int g = mg_next_constraint(c, -1); g < c->system->n_friction; g = mg_next_constraint(c, g))
    digest = mg_digest_friction_mode(digest, c->run->friction_mode[g]);
  for (int slot = 0; slot < c->system->n_patch_slot; slot++)
    digest = mg_digest_friction_mode(digest, c->run->patch_mode[slot]);
  return digest;
}

MG_INTERNAL mg_digest mg_state_digest(const mg_context *c, int what, mg_real t, const mg_real *x) {
  const mg_system *s = c->system;
  mg_digest digest = mg_digest_reals(mg_digest_reals(MG_DIGEST_START, &t, 1), x, s->n_q);
  if (what >= MG_VALID_TWISTS) digest = mg_digest_reals(digest, x + s->n_q, s->n_u);
  return (what >= MG_VALID_FORCES ? mg_digest_modes(c, digest) : digest) | 1;
}

MG_INTERNAL mg_digest mg_placement_digest(const mg_context *c, int kind, int o, int f, const mg_real *eta) {
  const int row[3] = {kind, o, f};
  mg_digest digest = mg_digest_ints(MG_DIGEST_START, row, 3);
  for (int side = 1; side < 3; side++) digest = mg_digest_reals(digest, c->bodies.pose + 12 * row[side], 12);
  return (eta ? mg_digest_reals(digest, eta, c->kernels->contact_kinds[kind].n_eta) : digest) | 1;
}

MG_INTERNAL mg_digest mg_step_digest(const mg_context *c, mg_real t, const mg_real *x, mg_real h) {
  return mg_digest_reals(mg_state_digest(c, MG_VALID_TWISTS, t, x), &h, 1) | 1;
}

MG_INTERNAL mg_digest mg_solution_digest(const mg_context *c, const mg_friction_problem *p, const mg_real *z) {
  const mg_digest rows = mg_digest_ints(MG_DIGEST_START, c->lcp.rows, p->n),
                  contacts = mg_digest_ints(rows, c->friction.cone_contact, p->n_contact);
  return mg_digest_reals(mg_digest_reals(mg_digest_reals(contacts, p->A, (long)p->n * p->n), p->b, p->n), z, p->n) | 1;
}

MG_INTERNAL mg_digest mg_impulse_digest(const mg_context *c, int n) {
  const mg_digest state = mg_state_digest(c, MG_VALID_TWISTS, c->run->t, c->run->x);
  return mg_digest_reals(mg_digest_ints(state, c->lcp.rows, n), c->lcp.z, n) | 1;
}

MG_INTERNAL mg_digest mg_kept_rows_digest(const mg_context *c, int n) {
  return mg_digest_reals(mg_digest_ints(MG_DIGEST_START, c->islands.rows, n), c->lcp.work, (long)n * n) | 1;
}

MG_INTERNAL int mg_are_inverse_mass_rows_valid(const mg_context *c, const int *list, int n) {
  for (int r = 0; r < n; r++)
    for (int side = 0; side < 2; side++) {
      const int body = side ? c->contacts.f[list[r]] : c->contacts.o[list[r]];
      const mg_real *J = c->rows.J + 12 * list[r] + 6 * side, *MJ = c->rows.MJ + 12 * list[r] + 6 * side,
                    *w = c->system->mass_inverse + 10 * body;
      for (int k = 0; k < 6 && mg_is_moved_by_forces(c, body); k++) {
        mg_real sum = k < 3 ? w[0] * J[k] : 0, size = fabs(sum);
        for (int j = 0; j < 3 && k >= 3; j++)
          sum += w[1 + k - 3 + 3 * j] * J[3 + j], size += fabs(w[1 + k - 3 + 3 * j] * J[3 + j]);
        if (fabs(MJ[k] - sum) > 8 * MG_EPS * size) return 0;
      }
    }
  return 1;
}

MG_INTERNAL int mg_is_matrix_of_rows(const mg_context *c, const int *list, int n) {
  if (!mg_are_inverse_mass_rows_valid(c, list, n)) return 0;
  for (int k = 0; k < n; k++)
    for (int r = k; r < n; r++) {
      const mg_real size = sqrt(mg_delassus_entry(c, list[r], list[r]) * mg_delassus_entry(c, list[k], list[k]));
      if (fabs(c->lcp.A[r + (long)n * k] - mg_delassus_entry(c, list[r], list[k])) > 32 * MG_EPS * size) return 0;
    }
  return 1;
}

MG_INTERNAL int mg_are_contact_rows_first(const mg_context *c, const mg_friction_problem *p) {
  int n = 0;
  for (int k = 0; k < p->n_contact; n += p->rows[k++])
    if (p->first[k] != n || c->lcp.rows[n] != c->friction.cone_contact[k]) return 0;
  for (int r = n; r < p->n; r++)
    if (c->lcp.rows[r] < c->layout.support_begin) return 0;
  return n <= p->n;
}

/* Requires n entries to be from `first` on and below `end`. */
static void mg_require_range(const int *entries, long n, int first, int end) {
  for (long i = 0; i < n; i++) MG_REQUIRE(first <= entries[i] && entries[i] < end);
}

/* Requires n + 1 entries of a range array to ascend from 0 to at most `end`. */
static void mg_require_ascent(const int *entries, int n, int end) {
  MG_REQUIRE(entries[0] >= 0 && entries[n] <= end);
  for (int i = 0; i < n; i++) MG_REQUIRE(entries[i] <= entries[i + 1]);
}

/* The tables of contacts, pairs of shapes and their balls. */
static void mg_require_pairs(const mg_system *s) {
  mg_require_range(s->contact_pair, s->n_contact, 0, s->n_pair);
  mg_require_range(s->contact_eta, s->n_contact, 0, s->n_eta + 1);
  mg_require_range(s->contact_feature_pair, s->n_contact, -1, s->n_feature_pair);
  mg_require_range(s->impact_law, s->n_contact, MG_NEWTON, MG_STRONGE + 1);
  mg_require_ascent(s->contact_friction_row, s->n_contact, s->n_friction_row);
  mg_require_ascent(s->contact_friction, s->n_contact, s->n_friction);
  mg_require_ascent(s->pair_contact, s->n_pair, s->n_contact);
  mg_require_ascent(s->pair_feature_pair, s->n_pair, s->n_feature_pair);
  mg_require_range(s->pair_search, s->n_pair, MG_SEARCH_NEVER, MG_SEARCH_APART + 1);
  mg_require_range(s->pair_balls, 2L * s->n_pair, -1, s->n_ball);
  mg_require_range(s->ball_body, s->n_ball, 0, s->n_body);
  if (s->n_pool) mg_require_ascent(s->pool_slot, s->n_pool, s->n_pair);
  mg_require_range(s->pool_pattern, s->n_pool, 0, s->n_pair);
  mg_require_range(s->ball_class, s->n_pool ? s->n_ball : 0, -1, s->n_ball_class);
  mg_require_range(s->class_pool, (long)s->n_ball_class * s->n_ball_class, -1, s->n_pool);
}

/* The tables of solids and their terms. */
static void mg_require_solids(const mg_system *s) {
  const int n = s->n_solid, terms = n ? s->solid_term[n] : 0;
  mg_require_range(s->ball_solid, s->n_ball, MG_UNKNOWN_MATERIAL, n);
  if (!n) return;
  mg_require_ascent(s->solid_term, n, terms);
  mg_require_range(s->solid_body, n, 0, s->n_body), mg_require_range(s->solid_numbers, n, 0, s->n_numbers - 11);
  mg_require_range(s->term_kind, terms, MG_TERM_PLANE, MG_TERM_POLYGON + 1);
  for (int k = 0; k < terms; k++)
    MG_REQUIRE(s->term_numbers[k] >= 0 && s->term_numbers[k] + s->term_size[k] <= s->n_numbers);
}

/* The tables of feature pairs and their conditions. */
static void mg_require_feature_pairs(const mg_system *s) {
  const int n = s->n_feature_pair, conditions = n ? s->feature_pair_condition[n] : 0;
  mg_require_range(s->feature_pair_o, n, 0, s->n_body), mg_require_range(s->feature_pair_f, n, 0, s->n_body);
  mg_require_range(s->feature_pair_owner, n, 0, s->n_pair);
  mg_require_range(s->feature_parameters, 2L * n, 0, s->n_parameters + 1);
  mg_require_range(s->feature_tree, 2L * n, -1, s->n_cell_tree);
  mg_require_range(s->feature_shape, 2L * n, -1, 1 << 30);
  if (n) mg_require_ascent(s->feature_pair_condition, n, conditions);
  for (int k = 0; k < n; k++) {
    const mg_contact_kind *kind = s->kernels->contact_kinds + s->feature_pair_kind[k];
    MG_REQUIRE(s->feature_pair_parameters[k] >= 0 &&
               s->feature_pair_parameters[k] + kind->n_parameters <= s->n_parameters);
    for (int side = 0; side < 2 && s->feature_shape[2 * k] >= 0; side++)
      MG_REQUIRE(s->feature_shape[2 * k + side] >= 0 && s->feature_numbers[2 * k + side] >= 0 &&
                 s->feature_numbers[2 * k + side] + MG_FEATURE_UV_SCALE + 2 <= s->n_numbers);
  }
  mg_require_range(s->condition_kind, conditions, MG_CONDITION_QUADRIC, MG_CONDITION_TIP + 1);
  mg_require_range(s->condition_feature, conditions, 0, 2);
  mg_require_range(s->condition_feature_pair, conditions, MG_BEYOND_WATCHED, n);
  mg_require_range(s->condition_numbers, conditions, 0, s->n_numbers);
}

/* The tables of patches and their boundaries. */
static void mg_require_patches(const mg_system *s) {
  const int n = s->n_patch, arcs = n ? s->patch_arc[n] : 0, covered = n ? s->patch_covered[n] : 0;
  if (!n) return;
  mg_require_range(s->patch_pair, n, 0, s->n_pair);
  mg_require_range(s->patch_slots, 2L * n, 0, s->n_patch_slot + 1);
  mg_require_ascent(s->patch_arc, n, arcs), mg_require_ascent(s->patch_covered, n, covered);
  mg_require_range(s->patch_arc_f, n, 0, arcs + 1);
  mg_require_range(s->patch_numbers, n, 0, s->n_numbers - 23);
  mg_require_range(s->covered_feature_pair, covered, 0, s->n_feature_pair);
  mg_require_range(s->arc_parameters, arcs, 0, s->n_parameters + 1);
  mg_require_range(s->arc_numbers, arcs, 0, s->n_numbers - 13);
}

MG_INTERNAL void mg_require_tables(const mg_system *s) {
  mg_require_range(s->body_q, s->n_body, 0, s->n_q + 1), mg_require_range(s->body_u, s->n_body, 0, s->n_u + 1);
  mg_require_range(s->body_parameters, s->n_body, 0, s->n_parameters + 1);
  mg_require_pairs(s), mg_require_solids(s), mg_require_feature_pairs(s), mg_require_patches(s);
  mg_require_range(s->load_a, s->n_load, 0, s->n_body), mg_require_range(s->load_b, s->n_load, -1, s->n_body);
  mg_require_ascent(s->load_switch, s->n_load, s->n_switch);
  for (int k = 0; k < s->n_load; k++)
    MG_REQUIRE(s->load_parameters[k] + s->kernels->load_kinds[s->load_kind[k]].n_parameters <= s->n_parameters);
  mg_require_range(s->joint_a, s->n_joint, 0, s->n_body), mg_require_range(s->joint_b, s->n_joint, 0, s->n_body);
  for (int k = 0; k < s->n_joint; k++) {
    const mg_joint_kind *kind = s->kernels->joint_kinds + s->joint_kind[k];
    MG_REQUIRE(s->joint_row[k] >= 0 && s->joint_row[k] + kind->n_rows <= s->n_joint_row);
    MG_REQUIRE(s->joint_parameters[k] + kind->n_parameters <= s->n_parameters);
  }
  mg_require_range(s->friction_kind, s->n_friction, MG_FRICTION_SLIP, MG_FRICTION_ROLL + 1);
  mg_require_range(s->friction_body, s->n_friction, -1, s->n_body);
}

#endif
