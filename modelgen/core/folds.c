/* Contacts that end where their extremum does: a minimum of the distance meets a saddle; or two crossings of the edges
   of two solids run together, as where the edge of a table leaves a round face that slides off it. */
#include "core.h"

static int mg_is_bent(const mg_context *c, int link, int side) {
  const int carrier = mg_carrier(c, link, side);
  return carrier == MG_CURVE || carrier == MG_SIGNED_CURVE;
}

/* Edges of solids that cross, not both straight. */
MG_INTERNAL int mg_crosses(const mg_context *c, int link) {
  if (mg_dimension(c, link, 0) != 1 || mg_dimension(c, link, 1) != 1 || mg_is_bare(c, link)) return 0;
  return mg_is_bent(c, link, 0) || mg_is_bent(c, link, 1);
}

/* The margin at which a contact ends: of a closed crossing it is of the size of what is left of the chord, squared. */
static mg_real mg_fold_of(const mg_context *c, int contact) {
  const int crossing = c->run->closed[contact] && mg_crosses(c, c->run->link[contact]);
  return crossing ? c->set->lost : c->set->margin_refuse;
}

/* A closed contact too near to where its extremum is lost, unless it has just come from there. */
MG_INTERNAL int mg_is_singular(const mg_context *c, int contact) {
  const mg_real margin = c->run->margin[contact];
  if (!c->run->closed[contact] || c->run->fresh[contact] || margin >= c->set->margin_refuse) return 0;
  return !(margin >= mg_fold_of(c, contact));
}

static int mg_folds(const mg_context *c, int contact) {
  if (!mg_present(c, contact) || c->run->margin[contact] >= mg_fold_of(c, contact)) return 0;
  if (c->sys->pair_search[c->sys->contact_pair[contact]] == MG_SEARCH_NEVER) return 0;
  return !c->run->closed[contact] || mg_crosses(c, c->run->link[contact]);
}

/* Leaves the contacts that end; their pairs are searched at once. Returns how many. */
MG_INTERNAL int mg_leave_folds(mg_context *c, mg_events *events) {
  int count = 0;
  for (int i = 0; i < c->first_pad; i++) {
    if (!mg_folds(c, i)) continue;
    mg_leave(c, events, i);
    count++;
  }
  return count;
}
