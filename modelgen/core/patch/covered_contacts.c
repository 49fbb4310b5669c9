/* The contacts on feature pairs that a patch covers: released when it begins, restored and closed when it ends. Writes
   feature pairs and modes of contacts. */
#include "patch/patch.h"
#include "base/base.h"
#include "model/model.h"
#include "closest/closest.h"
#include "forces/forces.h"
#include "features/features.h"

MG_INTERNAL void mg_search_covered_feature_pairs(mg_context *c, int patch, int flat, mg_minima *found) {
  const mg_system *s = c->system;
  found->count = 0, c->search.is_stoppable = 0; /* contacts are released and restored by what it finds */
  for (int k = s->patch_covered[patch]; k < s->patch_covered[patch + 1]; k++) {
    const int feature_pair = s->covered_feature_pair[k];
    const mg_search_limits limits = mg_appearance_limits(c, s->feature_pair_owner[feature_pair]);
    if (flat || !mg_is_feature_pair_of_flat_faces(c, feature_pair))
      mg_search_feature_pair(c, feature_pair, &limits, -c->settings->start_gap * s->length, found);
  }
  c->search.is_stoppable = 1;
  for (int k = 0; k < found->count; k++) {
    const mg_minimum *each = found->list + k;
    const int pair = s->feature_pair_owner[each->feature_pair];
    if (!mg_is_minimum_accepted(c, each, mg_appearance_limits(c, pair).depth)) continue;
    const int slot = mg_is_minimum_tracked(c, pair, -1, each) ? -1 : mg_find_contact_for_minimum(c, pair, each);
    if (slot < 0) continue;
    mg_set_feature_pair(c, slot, each->feature_pair, each->eta);
    c->rows.d[slot] = each->d;
  }
}

MG_INTERNAL void mg_restore_covered_contacts(mg_context *c, int patch, mg_minima *found) {
  mg_search_covered_feature_pairs(c, patch, mg_has_patch_friction(c, patch), found);
}

MG_INTERNAL int mg_find_contact_at_point(mg_context *c, int patch, const mg_real *world) {
  mg_real least = c->settings->search_merge_distance * c->system->length, next[6];
  int nearest = -1;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    if (!mg_is_on_feature_pair(c, i) || !mg_is_patch_of_pair(c, patch, c->system->contact_pair[i])) continue;
    mg_place_contact(c, i, mg_contact_eta(c, c->run->x, i), next);
    const mg_real arm[3] = {c->search.placement[11] - world[0], c->search.placement[12] - world[1],
                            c->search.placement[13] - world[2]};
    const mg_real away = sqrt(mg_dot3(arm, arm));
    if (away < least) least = away, nearest = i;
  }
  return nearest;
}

MG_INTERNAL void mg_close_covered_contacts(mg_context *c, int patch) {
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (mg_is_on_feature_pair(c, i) && mg_is_feature_pair_in_patch(c, patch, c->run->feature_pair[i]))
      mg_close_contact(c, i);
}

MG_INTERNAL void mg_mark_covered_contacts(mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    c->patches.is_covered[i] = i < c->layout.support_begin && mg_is_on_feature_pair(c, i) &&
                               mg_is_feature_pair_covered(c, c->run->feature_pair[i]);
}

MG_INTERNAL void mg_release_covered_contacts(mg_context *c) {
  const mg_real none[6] = {0};
  mg_mark_covered_contacts(c);
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (c->patches.is_covered[i]) mg_set_feature_pair(c, i, -1, none), c->events.triggered[i] = 0;
}
