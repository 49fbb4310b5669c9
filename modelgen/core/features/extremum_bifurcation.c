/* Contacts that end where their extremum does: a minimum of the distance meets a saddle; or two crossings of the edges
   of two solids run together, as where the edge of a table leaves a round face that slides off it. */
#include "features/features.h"
#include "model/model.h"
#include "closest/closest.h"

static int mg_folds(const mg_context *c, int contact) {
  if (!mg_is_on_link(c, contact) || c->run->margin[contact] >= mg_end_margin(c, contact)) return 0;
  if (c->system->pair_search[c->system->contact_pair[contact]] == MG_SEARCH_NEVER) return 0;
  return !c->run->closed[contact] || mg_is_curved_crossing(c, c->run->link[contact]);
}

/* Leaves the contacts that end; their pairs are searched at once. Returns how many. */
MG_INTERNAL int mg_leave_bifurcations(mg_context *c, mg_events *events) {
  int count = 0;
  for (int i = 0; i < c->support_begin; i++) {
    if (!mg_folds(c, i)) continue;
    mg_leave_link(c, events, i);
    count++;
  }
  return count;
}
