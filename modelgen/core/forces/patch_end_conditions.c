/* Whether a planar contact goes on (section 5 of Anitescu, Cremer and Potra, 1995): a face that rests on another is
   held by three bilateral supports. The patch ends, and the face tips (patch/tipping.c) or lifts off, where the centre
   of pressure leaves the convex hull of the common area, or where the force between the faces vanishes. Reads the
   forces; writes the event margins of the slots. */
#include "forces/forces.h"
#include "region/region.h"
#include "model/model.h"

MG_INTERNAL int mg_find_patch_end_cause(mg_context *c, int slot, const mg_real *amount, mg_real floor,
                                        mg_real *margin) {
  mg_real centre[3];
  mg_nearest_boundary nearest;
  const mg_real N = mg_support_resultant(c, slot, amount, centre);
  *margin = -MG_MAX;
  if (!(N > floor)) return MG_FACES_SEPARATE;
  if (mg_is_edge_pivot(c, slot)) return mg_find_pivot_end_cause(c, slot, amount, floor);
  *margin = mg_patch_hull_margin(c, mg_patch_of_slot(c, slot), centre, &nearest);
  return *margin < -c->settings->feature_border * c->system->length ? MG_PRESSURE_AT_EDGE : 0;
}

MG_INTERNAL int mg_find_slot_event(mg_context *c, int slot) {
  const int patch = mg_patch_of_slot(c, slot);
  const mg_real floor = -mg_force_tolerance(c), border = c->settings->feature_border * c->system->length;
  mg_event_margin *margins = mg_slot_event_margins(c, slot);
  mg_real margin, centre[3];
  for (int k = 0; k < 3; k++) margins[k].lower = margins[k].upper = MG_MAX;
  if (patch < 0) return 0;
  const mg_real N = mg_support_resultant(c, slot, c->solution.force, centre);
  const mg_real known_margin =
      !mg_is_edge_pivot(c, slot) && N > floor ? mg_hull_margin_lower_bound(c, patch, centre) : -1;
  const int cause = known_margin > 0 ? 0 : mg_find_patch_end_cause(c, slot, c->solution.force, floor, &margin);
  margins[0].lower = margins[0].upper = N - floor;
  if (known_margin > 0)
    margins[1].lower = known_margin + border, margins[1].upper = 2 * c->patches.deepest - known_margin + border;
  else if (!mg_is_edge_pivot(c, slot)) margins[1].lower = margins[1].upper = margin + border;
  return cause ? cause : mg_find_patch_friction_event(c, slot);
}

MG_INTERNAL int mg_mark_patch_events(mg_context *c) {
  int count = 0;
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    const int support = mg_first_support(c, slot);
    for (int k = 0; k < 3; k++) c->events.triggered[support + k] = 0;
    c->events.triggered[support] = mg_find_slot_event(c, slot);
    count += c->events.triggered[support] != 0;
  }
  return count;
}

MG_INTERNAL int mg_has_patch_event(mg_context *c) {
  for (int slot = 0; slot < c->system->n_patch_slot; slot++)
    if (mg_find_slot_event(c, slot)) return 1;
  return 0;
}

MG_INTERNAL mg_real mg_patch_event_value(mg_context *c, int support, int cause) {
  mg_real centre[3];
  mg_nearest_boundary nearest;
  const int slot = (support - c->layout.support_begin) / 3;
  const mg_real N = mg_support_resultant(c, slot, c->solution.force, centre);
  if (cause >= MG_FRICTION_EXCEEDED) return mg_patch_friction_event_value(c, slot, cause);
  if (cause >= MG_ROLLS_ONTO_RIM) return mg_pivot_event_value(c, slot, cause);
  return cause == MG_FACES_SEPARATE ? N : mg_patch_hull_margin(c, mg_patch_of_slot(c, slot), centre, &nearest);
}
