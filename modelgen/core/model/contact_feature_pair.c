/* The feature pair that each contact is on: its kind, parameters and bodies (c->contacts), its eta, and rows that start
   anew when it changes. Writes feature pairs and eta of the run. */
#include "model/model.h"

MG_INTERNAL int mg_is_support_contact(const mg_context *c, int contact) {
  return contact >= c->layout.support_begin && contact < c->system->n_contact;
}

MG_INTERNAL int mg_is_on_feature_pair(const mg_context *c, int contact) { return c->run->feature_pair[contact] >= 0; }

MG_INTERNAL int mg_eta_capacity(const mg_context *c, int contact) {
  const mg_system *s = c->system;
  return (contact + 1 < s->n_contact ? s->contact_eta[contact + 1] : s->n_eta) - s->contact_eta[contact];
}

MG_INTERNAL mg_real *mg_contact_eta(const mg_context *c, mg_real *x, int contact) {
  MG_REQUIRE(contact >= 0 && contact < c->system->n_contact);
  return x + c->system->n_q + c->system->n_u + c->system->contact_eta[contact];
}

MG_INTERNAL const mg_real *mg_contact_parameters(mg_context *c, int contact) {
  const mg_real *held = c->system->parameters + c->contacts.parameters[contact];
  if (!mg_is_support_contact(c, contact)) return held;
  const int n = c->kernels->contact_kinds[c->contacts.kind[contact]].n_parameters;
  for (int k = 0; k < n - 3; k++) c->contacts.point_parameters[k] = held[k];
  for (int k = 0; k < 3; k++) c->contacts.point_parameters[n - 3 + k] = c->run->point[3 * contact + k];
  return c->contacts.point_parameters;
}

MG_INTERNAL void mg_place_on_feature_pair(mg_context *c, int contact, int feature_pair) {
  MG_REQUIRE(contact >= 0 && contact <= c->system->n_contact && feature_pair >= 0 &&
             feature_pair < c->system->n_feature_pair);
  const mg_system *s = c->system;
  c->contacts.kind[contact] = s->feature_pair_kind[feature_pair],
  c->contacts.parameters[contact] = s->feature_pair_parameters[feature_pair];
  c->contacts.length[contact] = mg_pair_length(c, s->feature_pair_owner[feature_pair]);
  c->contacts.o[contact] = mg_feature_body(c, feature_pair, 0),
  c->contacts.f[contact] = mg_feature_body(c, feature_pair, 1);
}

/* Feature pair that a contact is on; without one the first of its pair. */
static int mg_held_or_first_feature_pair(const mg_context *c, int contact) {
  const int held = c->run->feature_pair[contact];
  return held < 0 ? c->system->pair_feature_pair[c->system->contact_pair[contact]] : held;
}

MG_INTERNAL int mg_pair_first_contact(const mg_context *c, int pair) {
  MG_REQUIRE(pair >= 0 && pair <= c->system->n_pair);
  return c->system->pair_contact[pair];
}

MG_INTERNAL int mg_has_own_feature_pairs(const mg_context *c, int pair) {
  return c->system->contact_feature_pair[mg_pair_first_contact(c, pair)] >= 0;
}

/* Sets the bodies of the rows of a contact to those of a feature pair. */
static void mg_set_row_bodies(mg_context *c, int contact, int feature_pair) {
  const mg_system *s = c->system;
  const int o = mg_feature_body(c, feature_pair, 0), f = mg_feature_body(c, feature_pair, 1);
  c->contacts.o[contact] = o, c->contacts.f[contact] = f;
  for (int i = s->contact_friction_row[contact]; s->n_friction && i < s->contact_friction_row[contact + 1]; i++)
    c->contacts.o[c->layout.friction_row_begin + i] = o, c->contacts.f[c->layout.friction_row_begin + i] = f;
}

static void mg_reset_friction_rows(mg_context *c, int contact) {
  const int *row_range = c->system->contact_friction_row + contact, first = c->layout.friction_row_begin + row_range[0];
  for (int i = 0; i < row_range[1] - row_range[0]; i++) {
    c->lcp.column[first + i] = -1;
    for (int k = 0; k < 12; k++) c->rows.J[12 * (first + i) + k] = c->rows.MJ[12 * (first + i) + k] = 0;
    c->rows.gamma[first + i] = c->rows.d_dot[first + i] = c->solution.force[first + i] = 0;
  }
}

MG_INTERNAL void mg_load_feature_pair(mg_context *c, int contact) {
  const mg_system *s = c->system;
  const int held = c->run->feature_pair[contact], feature_pair = mg_held_or_first_feature_pair(c, contact);
  mg_place_on_feature_pair(c, contact, feature_pair);
  mg_set_row_bodies(c, contact, feature_pair);
  c->layout.n_live_states -= c->contacts.n_eta[contact];
  c->contacts.n_eta[contact] = held < 0 ? 0 : c->kernels->contact_kinds[c->contacts.kind[contact]].n_eta;
  c->layout.n_live_states += c->contacts.n_eta[contact];
  if (c->contacts.n_eta[contact]) mg_eta_scale(c, feature_pair, s->length, mg_contact_eta(c, c->step.scale, contact));
  for (int k = 0; k < 12; k++) c->rows.J[12 * contact + k] = c->rows.MJ[12 * contact + k] = 0;
  for (int k = 0; k < mg_eta_capacity(c, contact); k++) c->rows.eta_dot[s->contact_eta[contact] + k] = 0;
  for (int k = c->contacts.n_eta[contact]; k < mg_eta_capacity(c, contact); k++)
    mg_contact_eta(c, c->step.stage, contact)[k] = 0; /* which is recorded whole */
  c->rows.gamma[contact] = c->rows.d_dot[contact] = c->solution.force[contact] = 0;
  if (s->n_friction) mg_reset_friction_rows(c, contact);
  if (held < 0) c->rows.d[contact] = MG_MAX, c->run->margin[contact] = 1;
}

MG_INTERNAL void mg_open_contacts(mg_context *c) {
  for (int i = 0; i < c->system->n_contact; i++) {
    c->contacts.n_eta[i] = c->events.within_border[i] = 0;
    if (i < c->layout.limit_begin && c->run->is_far[c->system->contact_pair[i]])
      mg_set_row_bodies(c, i, mg_held_or_first_feature_pair(c, i));
    else mg_load_feature_pair(c, i);
  }
}

MG_INTERNAL void mg_set_feature_pair(mg_context *c, int contact, int feature_pair, const mg_real *eta) {
  MG_REQUIRE(contact >= 0 && contact < c->system->n_contact && feature_pair >= -1 &&
             feature_pair < c->system->n_feature_pair);
  mg_real *kept = mg_contact_eta(c, c->run->x, contact);
  const int before = c->contacts.n_eta[contact];
  c->run->feature_pair[contact] = feature_pair;
  mg_load_feature_pair(c, contact);
  if (c->contacts.n_eta[contact] != before && !c->listed.is_starting) mg_list_states(c);
  for (int k = 0; k < mg_eta_capacity(c, contact); k++) kept[k] = k < c->contacts.n_eta[contact] ? eta[k] : 0;
  if (feature_pair < 0) mg_set_closed(c, contact, 0), mg_set_rolling_start(c, contact, MG_START_NONE);
}
