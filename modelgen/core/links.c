/* Which link each contact is on, copied to where the loops over contacts look. */
#include "core.h"

MG_INTERNAL int mg_present(const mg_context *c, int contact) { return c->run->link[contact] >= 0; }

static int mg_eta_room(const mg_context *c, int contact) {
  const mg_system *s = c->sys;
  return (contact + 1 < s->n_contact ? s->contact_eta[contact + 1] : s->n_eta) - s->contact_eta[contact];
}

MG_INTERNAL mg_real *mg_eta_of(const mg_context *c, mg_real *x, int contact) {
  return x + c->sys->n_q + c->sys->n_u + c->sys->contact_eta[contact];
}

/* The parameters of a contact's kind; the point of a pad is the run's. */
MG_INTERNAL const mg_real *mg_parameters_of(mg_context *c, int contact) {
  const mg_real *held = c->sys->parameters + c->parameters[contact];
  if (!mg_is_pad(c, contact)) return held;
  const int n = c->kernels->contact_kinds[c->kind[contact]].n_parameters;
  for (int k = 0; k < n - 3; k++) c->numbers[k] = held[k];
  for (int k = 0; k < 3; k++) c->numbers[n - 3 + k] = c->run->point[3 * contact + k];
  return c->numbers;
}

/* Makes a contact, or the spare one behind the last, stand on a link. */
MG_INTERNAL void mg_stand(mg_context *c, int contact, int link) {
  const mg_system *s = c->sys;
  c->kind[contact] = s->link_kind[link], c->parameters[contact] = s->link_parameters[link];
  c->o[contact] = s->link_o[link], c->f[contact] = s->link_f[link];
}

/* No condition ends or watches a contact on the link. */
MG_INTERNAL int mg_is_endless(const mg_context *c, int link) {
  return c->sys->link_condition[link] == c->sys->link_condition[link + 1];
}

MG_INTERNAL int mg_first_contact(const mg_context *c, int pair) { return c->sys->pair_contact[pair]; }

/* Each contact of the pair has a link for good; else they share the pair's links. */
MG_INTERNAL int mg_has_own_links(const mg_context *c, int pair) {
  return c->sys->contact_link[mg_first_contact(c, pair)] >= 0;
}

/* What each entry of eta on a link is measured against. */
MG_INTERNAL void mg_eta_scale(const mg_context *c, int link, mg_real *scale) {
  for (int side = 0; side < 2; side++) {
    const int carrier = mg_carrier(c, link, side), n = mg_carried[carrier];
    const int charted = carrier == MG_CHART ? 2 : carrier == MG_CURVE || carrier == MG_SIGNED_CURVE;
    for (int k = 0; k < n; k++)
      *scale++ = k < charted ? mg_side(c, link, side)[MG_SPAN + k] : carrier == MG_LOCAL ? c->sys->length : 1;
  }
}

/* A contact on no link is infinitely far away, so that no loop over contacts needs to ask. */
MG_INTERNAL void mg_take_link(mg_context *c, int contact) {
  const mg_system *s = c->sys;
  const int held = c->run->link[contact], link = held < 0 ? s->pair_link[s->contact_pair[contact]] : held;
  mg_stand(c, contact, link);
  c->n_live -= c->n_eta[contact];
  c->n_eta[contact] = held < 0 ? 0 : c->kernels->contact_kinds[c->kind[contact]].n_eta;
  c->n_live += c->n_eta[contact];
  if (c->n_eta[contact]) mg_eta_scale(c, link, mg_eta_of(c, c->scale, contact));
  for (int k = 0; k < 12; k++) c->J[12 * contact + k] = c->MJ[12 * contact + k] = 0;
  for (int k = 0; k < mg_eta_room(c, contact); k++) c->eta_dot[s->contact_eta[contact] + k] = 0;
  c->gamma[contact] = c->d_dot[contact] = c->force[contact] = 0;
  if (s->n_grip) mg_take_rows(c, contact);
  if (held < 0) c->d[contact] = MG_MAX, c->run->margin[contact] = 1;
}

/* Puts the contact on a link with this eta, or on none (-1). */
MG_INTERNAL void mg_set_link(mg_context *c, int contact, int link, const mg_real *eta) {
  mg_real *kept = mg_eta_of(c, c->run->x, contact);
  c->run->link[contact] = link;
  mg_take_link(c, contact);
  for (int k = 0; k < mg_eta_room(c, contact); k++) kept[k] = k < c->n_eta[contact] ? eta[k] : 0;
  if (link < 0) c->run->closed[contact] = c->run->active[contact] = c->run->fresh[contact] = 0;
}
