/* Contacts that start from flat, and how they grow out of it. */
#include "core.h"

MG_INTERNAL int mg_starts_rolling(const mg_context *c) {
  for (int i = 0; i < c->sys->n_contact; i++)
    if (c->run->fresh[i] == MG_FRESH) return 1;
  return 0;
}

/* The conditions of its link hold, and its margin is nothing to warn of. */
static int mg_is_grown_up(mg_context *c, int contact) {
  const mg_real *eta = mg_eta_of(c, c->run->x, contact);
  int which;
  mg_place(c, contact, eta, c->place + 32);
  return c->run->margin[contact] >= c->set->margin_warn &&
         mg_worst_condition(c, c->run->link[contact], eta, &which) >= 0;
}

/* Brings eta of a contact to the extremum at the present poses, as near as rounding lets it. */
MG_INTERNAL int mg_settle_fully(mg_context *c, int contact, mg_real *eta) {
  if (!c->n_eta[contact]) return 1;
  if (mg_settle_in(c, contact, eta) < 0) return 0;
  for (int extra = 0; extra < 2; extra++) {
    mg_place(c, contact, eta, c->place + 32);
    for (int k = 0; k < c->n_eta[contact]; k++) eta[k] = c->place[32 + k];
  }
  return mg_finite(eta, c->n_eta[contact]);
}

/* A fresh contact whose lean is not clear of rounding. */
MG_INTERNAL int mg_is_flat_yet(const mg_context *c, int contact) {
  return c->run->fresh[contact] == MG_FRESH && mg_patch_flat_on(c, contact, c->set->flat) >= 0;
}

/* Notes of such a contact the way it leans by now, and its point. */
static void mg_starts_on(mg_context *c, int contact) {
  const mg_lean at = mg_lean_at(c, contact, c->onset[contact].azimuth[MG_RADAU - 1]);
  for (int k = 0; k < 3; k++) c->run->outward[3 * contact + k] = at.along[k];
  mg_point_leaning(c, c->run->t, contact, &at, c->run->x);
}

/* What the explicit method can follow: the swing about the smooth solution. */
static mg_real mg_pace_of(const mg_context *c, int contact) {
  const mg_onset *onset = c->onset + contact;
  const mg_lean at = mg_lean_at(c, contact, onset->azimuth[MG_RADAU - 1]);
  return sqrt(mg_dot3(at.along, at.lean) / fabs(onset->stiffness[MG_RADAU - 1]));
}

/* After a step. */
MG_INTERNAL void mg_grow_up(mg_context *c) {
  int grow = 0;
  for (int i = 0; i < c->first_pad; i++) grow |= c->run->fresh[i];
  if (grow) mg_poses(c, c->run->t, c->run->x);
  for (int i = 0; i < c->first_pad; i++) {
    const int starts = c->run->fresh[i] == MG_FRESH;
    if (!c->run->fresh[i]) continue;
    if (mg_is_flat_yet(c, i)) {
      mg_starts_on(c, i);
      continue;
    }
    const mg_real pace = starts ? mg_pace_of(c, i) : MG_MAX;
    c->run->fresh[i] = mg_is_grown_up(c, i) ? MG_STEADY : MG_YOUNG;
    if (starts && c->set->method == MG_RK4) c->run->h = c->set->step;
    else if (pace < c->run->h) c->run->h = pace;
  }
}
