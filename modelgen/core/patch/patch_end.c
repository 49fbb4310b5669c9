/* End of planar contact by events, by impulses that would pull the faces apart, or because another contact is struck.
   Writes feature pairs and modes of contacts and the event list. */
#include "patch/patch.h"
#include "model/model.h"
#include "forces/forces.h"
#include "features/features.h"

MG_INTERNAL int mg_end_patches_by_impulse(mg_context *c, const mg_real *impulse, mg_real floor) {
  mg_minima found;
  mg_real margin, centre[3];
  int count = 0;
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    const int patch = mg_patch_of_slot(c, slot);
    if (patch < 0 || c->patches.trial[slot] || fabs(mg_support_resultant(c, slot, impulse, centre)) <= floor) continue;
    if (!mg_find_patch_end_cause(c, slot, impulse, floor, &margin)) continue;
    count++;
    if (mg_move_patch_to_edge(c, slot)) continue;
    mg_release_patch(c, slot);
    mg_restore_covered_contacts(c, patch, &found);
    mg_close_covered_contacts(c, patch);
    mg_evaluate_run_state(c);
  }
  return count;
}

MG_INTERNAL int mg_replace_struck_patches(mg_context *c) {
  mg_minima found;
  int count = 0, struck = 0;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    struck |= c->run->closed[i] && mg_is_approaching_beyond_drift(c, i);
  for (int slot = 0; slot < c->system->n_patch_slot && struck; slot++) {
    const int patch = mg_patch_of_slot(c, slot);
    if (patch < 0 || !mg_has_patch_friction(c, patch)) continue;
    mg_release_patch(c, slot);
    mg_restore_covered_contacts(c, patch, &found);
    mg_close_covered_contacts(c, patch);
    count++;
  }
  return count;
}

MG_INTERNAL int mg_end_patches(mg_context *c, mg_events *events) {
  mg_minima found;
  int count = 0;
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    const int support = mg_first_support(c, slot), cause = c->events.triggered[support],
              patch = mg_patch_of_slot(c, slot);
    c->events.triggered[support] = 0;
    if (cause >= MG_FRICTION_EXCEEDED) c->patches.friction[slot].triggered = 1;
    if (!cause || patch < 0 || cause >= MG_FRICTION_EXCEEDED) continue;
    if (cause < MG_ROLLS_ONTO_RIM)
      mg_apply_contact_transition(c, events, support,
                                  cause == MG_PRESSURE_AT_EDGE ? MG_PATCH_TURNS_OVER_EDGE : MG_LIFTS_OFF, c->run->t, 0);
    c->patches.barred[slot] = cause == MG_FLAT_AGAIN ? -1 : patch;
    if (cause == MG_PRESSURE_AT_EDGE) mg_tip_patch(c, slot);
    else if (cause == MG_ROLLS_ONTO_RIM || cause == MG_EDGE_UNLOADED) mg_end_edge_pivot(c, slot, events);
    else mg_release_patch(c, slot), mg_restore_covered_contacts(c, patch, &found);
    mg_request_pair_searches(c, patch);
    count++;
  }
  return count;
}
