/* Contacts that end at a fold of their extremum: a minimum of the distance meets a saddle, or two crossings of
   edges of solids merge, as where the edge of a table leaves a round face that slides off it. Reads margins;
   releases contacts. */
#include "features/features.h"
#include "model/model.h"
#include "closest/closest.h"

/* True if the contact ends at a fold: its minimum has met a saddle. */
static int mg_is_contact_at_fold(const mg_context *c, int contact) {
  if (!mg_is_on_feature_pair(c, contact) || c->run->margin[contact] >= mg_fold_margin_limit(c, contact)) return 0;
  if (c->system->pair_search[c->system->contact_pair[contact]] == MG_SEARCH_NEVER) return 0;
  return !c->run->closed[contact] || mg_is_curved_edge_crossing(c, c->run->feature_pair[contact]);
}

MG_INTERNAL int mg_release_folded_contacts(mg_context *c, mg_events *events) {
  int count = 0;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    if (!mg_is_contact_at_fold(c, i)) continue;
    mg_release_contact(c, events, i);
    count++;
  }
  return count;
}
