/* Contact points: Newton's method for eta on the extremality equations (section 2 of the paper: the line between
   the points is normal to both surfaces), for one contact and for all. Writes c->search.placement, c->rows.d and
   the margins of the run. */
#include "model/model.h"

MG_INTERNAL int mg_place_contact(mg_context *c, int contact, const mg_real *eta, mg_real *eta_next) {
  const int kind = c->contacts.kind[contact];
  mg_real *p = c->search.placement;
  MG_NEEDS_ANY(c, MG_VALID_POSES), MG_NOTE_PLACEMENT(c, contact, eta);
  c->kernels->contact_place(kind, c->bodies.pose + 12 * c->contacts.o[contact],
                            c->bodies.pose + 12 * c->contacts.f[contact], eta, mg_contact_parameters(c, contact),
                            eta_next, p, p + 1, p + 3, p + 5, p + 8, p + 11);
  return c->kernels->contact_kinds[kind].n_eta;
}

MG_INTERNAL mg_real mg_placement_margin(const mg_context *c, int contact) {
  MG_NEEDS_PLACED(c, contact);
  const mg_real flat = c->search.placement[4] * c->contacts.length[contact];
  return c->search.placement[3] < flat ? c->search.placement[3] : flat;
}

MG_INTERNAL mg_real mg_placement_uniqueness(const mg_context *c, int contact) {
  MG_NEEDS_PLACED(c, contact);
  return c->kernels->contact_kinds[c->contacts.kind[contact]].n_eta ? mg_placement_margin(c, contact)
                                                                    : c->search.placement[3];
}

MG_INTERNAL mg_real mg_contact_margin(const mg_context *c, int contact) {
  MG_NEEDS_PLACED(c, contact);
  const mg_system *s = c->system;
  const int is_slow = fabs(c->rows.gamma[contact]) * s->time * s->time <= s->length;
  return is_slow ? mg_placement_uniqueness(c, contact) : mg_placement_margin(c, contact);
}

MG_INTERNAL int mg_place_all_contacts(mg_context *c, mg_real t, mg_real *x) {
  const mg_system *s = c->system;
  mg_update_poses(c, t, x);
  for (int i = mg_next_row(c, -1); i < s->n_contact; i = mg_next_row(c, i)) {
    mg_real *eta = mg_contact_eta(c, x, i), *next = c->search.placement + 32;
    if (!mg_is_on_feature_pair(c, i)) continue;
    const int n = mg_place_contact(c, i, eta, next), flat = mg_is_tilt_below_flat_limit(c, i);
    c->rows.d[i] = c->search.placement[0];
    c->run->margin[i] = mg_contact_margin(c, i);
    for (int k = 0; k < n && !flat; k++) {
      if (!(fabs(next[k]) <= MG_MAX)) return 0;
      if (c->settings->newton) eta[k] = next[k];
    }
  }
  MG_NOTE_WITH(c, MG_VALID_GAPS, MG_VALID_POSES);
  return 1;
}

MG_INTERNAL int mg_is_residual_small(const mg_real *pose_o, const mg_real *pose_f, mg_real tolerance, mg_real length,
                                     const mg_real *placed) {
  mg_real size = 0, reach = 0; /* m, of the positions, and of the points from there */
  for (int k = 0; k < 3; k++) {
    size += fabs(pose_o[k]) + fabs(pose_f[k]);
    reach += fabs(placed[8 + k] - pose_o[k]) + fabs(placed[11 + k] - pose_f[k]);
  }
  if (reach <= MG_MAX) size += reach; /* not so of concentric balls, which have no points */
  return placed[1] <= tolerance * length + 16 * MG_EPS * size && placed[2] <= tolerance;
}

MG_INTERNAL int mg_is_placement_critical(const mg_context *c, int contact) {
  MG_NEEDS_PLACED(c, contact);
  return mg_is_residual_small(c->bodies.pose + 12 * c->contacts.o[contact],
                              c->bodies.pose + 12 * c->contacts.f[contact], c->settings->extremality_residual,
                              c->contacts.length[contact], c->search.placement);
}

MG_INTERNAL int mg_newton_on_feature_pair(mg_context *c, int contact, mg_real *eta) {
  mg_real *next = c->search.placement + 32;
  for (int step = 0; step < 50; step++) {
    const int n = mg_place_contact(c, contact, eta, next);
    if (mg_is_placement_critical(c, contact)) return step;
    for (int k = 0; k < n; k++) {
      if (!(fabs(next[k]) <= MG_MAX)) return -1;
      eta[k] = next[k];
    }
  }
  return -1;
}

MG_INTERNAL int mg_is_tilt_below_flat_limit(const mg_context *c, int contact) {
  return c->run->rolling_start[contact] == MG_START_FLAT &&
         mg_find_flat_patch_of_contact(c, contact, c->settings->flat_angle) >= 0;
}
