/* Contact points of one pair that merge, split or replace each other. Writes feature pairs, closed set and event list
   of the run. */
#include "features/features.h"
#include "model/model.h"
#include "closest/closest.h"

MG_INTERNAL void mg_search_near_contact_point(mg_context *c, int contact, const mg_real *eta, mg_real margin,
                                              mg_minima *kept) {
  const int feature_pair = c->run->feature_pair[contact], n = c->contacts.n_eta[contact];
  mg_real scale[6], to[6];
  mg_minimum found;
  mg_eta_scale(c, feature_pair, c->contacts.length[contact], scale);
  for (int j = 0; j < 4 * n; j++) {
    for (int k = 0; k < n; k++) to[k] = eta[k];
    to[j / 4] += (j % 2 ? 1 : -1) * (j % 4 < 2 ? 2 : 8) * sqrt(margin) * scale[j / 4];
    if (mg_newton_on_feature_pair(c, contact, to) >= 0 && mg_accept_minimum(c, feature_pair, to, &found))
      mg_insert_minimum(c, kept, &found);
  }
}

MG_INTERNAL void mg_merge_contacts(mg_context *c, mg_events *events) {
  mg_minimum found;
  mg_real next[6];
  for (int closed = 0; closed < 2; closed++)
    for (int i = c->layout.support_begin - 1; i >= 0; i--) {
      if (!mg_is_on_feature_pair(c, i) || c->run->closed[i] != closed) continue;
      const int pair = c->system->contact_pair[i];
      if (closed) c->run->is_search_due[pair] = 1;
      mg_place_contact(c, i, mg_contact_eta(c, c->run->x, i), next);
      found.feature_pair = c->run->feature_pair[i];
      mg_record_minimum(c, &found);
      if (mg_is_minimum_tracked(c, pair, i, &found)) mg_release_contact(c, events, i);
    }
}

MG_INTERNAL void mg_split_contact(mg_context *c, mg_events *events, int contact) {
  const int pair = c->system->contact_pair[contact];
  const mg_real touching = c->settings->contact_gap * c->system->length;
  mg_minima found = {0};
  if (!c->contacts.n_eta[contact] || c->system->pair_search[pair] == MG_SEARCH_NEVER) return;
  mg_search_near_contact_point(c, contact, mg_contact_eta(c, c->run->x, contact), c->events.passage.margin, &found);
  for (int k = 0; k < found.count; k++) {
    const mg_minimum *each = found.list + k;
    if (each->undecided || fabs(each->d) > touching || mg_is_minimum_tracked(c, pair, -1, each)) continue;
    const int slot = mg_find_contact_for_minimum(c, pair, each);
    if (slot < 0) continue;
    mg_set_feature_pair(c, slot, each->feature_pair, each->eta);
    c->rows.d[slot] = each->d, c->run->margin[slot] = each->margin, c->events.triggered[slot] = 1;
    mg_apply_contact_transition(c, events, slot, MG_CONTACT_APPEARS, c->run->t, 0);
  }
}

MG_INTERNAL int mg_replace_singular_contact(mg_context *c, mg_events *events, int contact) {
  const int pair = c->system->contact_pair[contact];
  if (c->system->pair_search[pair] == MG_SEARCH_NEVER) return 0;
  mg_search_pair_contacts(c, events, pair, 0);
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++) {
    if (i == contact || !mg_is_on_feature_pair(c, i) || mg_is_contact_singular(c, i)) continue;
    if (c->rows.d[i] > c->settings->contact_gap * c->system->length) continue;
    mg_release_contact(c, events, contact);
    return 1;
  }
  return 0;
}
