/* The rows of contacts below their normal ones, and the grips that bound the forces along them: friction against slip,
   resistance against spinning and rolling. */
#include "core.h"

MG_INTERNAL int mg_contact_of(const mg_context *c, int grip) {
  int contact = 0;
  while (c->sys->contact_grip[contact + 1] <= grip) contact++;
  return contact;
}

/* The first row of a grip of a contact. */
MG_INTERNAL int mg_grip_row(const mg_context *c, int contact, int grip) {
  return c->below + c->sys->contact_below[contact] + c->sys->grip_row[grip];
}

MG_INTERNAL int mg_grip_rows(const mg_context *c, int grip) { return c->sys->grip_aspect[grip] == MG_SPIN ? 1 : 2; }

/* The rows below stand on the bodies of the contact's link. */
MG_INTERNAL void mg_take_rows(mg_context *c, int contact) {
  const int *room = c->sys->contact_below + contact, first = c->below + room[0];
  for (int i = 0; i < room[1] - room[0]; i++) {
    c->o[first + i] = c->o[contact], c->f[first + i] = c->f[contact], c->column[first + i] = -1;
    for (int k = 0; k < 12; k++) c->J[12 * (first + i) + k] = c->MJ[12 * (first + i) + k] = 0;
    c->gamma[first + i] = c->d_dot[first + i] = c->force[first + i] = 0;
  }
}

MG_INTERNAL void mg_turn_pair(mg_real cosine, mg_real sine, mg_real *a, mg_real *b) {
  const mg_real x = *a, y = *b;
  *a = cosine * x + sine * y, *b = cosine * y - sine * x;
}

/* Turns t1, t2 to the axes of a grip that is not alike in all directions. Where its direction is along N, they stay. */
MG_INTERNAL void mg_turn_to_axes(mg_context *c, int contact, int grip) {
  const int row = mg_grip_row(c, contact, grip);
  mg_real along[3], *t = c->tangents + 6 * contact;
  mg_out(c->pose + 12 * c->sys->grip_body[grip], c->sys->grip_direction + 3 * grip, 0, along);
  const mg_real x = mg_dot3(t, along), y = mg_dot3(t + 3, along), size = sqrt(x * x + y * y);
  if (!(size > 0)) return;
  for (int k = 0; k < 3; k++) mg_turn_pair(x / size, y / size, t + k, t + 3 + k);
  for (int k = 0; k < 12; k++) mg_turn_pair(x / size, y / size, c->J + 12 * row + k, c->J + 12 * (row + 1) + k);
  mg_turn_pair(x / size, y / size, c->gamma + row, c->gamma + row + 1);
}

/* Puts the rows of c->block where the loops over rows look. */
MG_INTERNAL void mg_scatter(mg_context *c, int contact) {
  const mg_contact_kind *kind = c->kernels->contact_kinds + c->kind[contact];
  for (int i = 0; i < kind->rows; i++) {
    const int row = i ? c->below + c->sys->contact_below[contact] + i - 1 : contact;
    for (int k = 0; k < kind->n_o; k++) c->J[12 * row + k] = c->block[kind->n_o * i + k];
    for (int k = 0; k < kind->n_f; k++) c->J[12 * row + 6 + k] = c->block[36 + kind->n_f * i + k];
    c->gamma[row] = c->set->use_gamma ? c->block[72 + i] : 0;
  }
  for (int g = c->sys->contact_grip[contact]; g < c->sys->contact_grip[contact + 1]; g++)
    if (c->sys->grip_body[g] >= 0) mg_turn_to_axes(c, contact, g);
}

/* Slip, spin and rolling of all contacts, into c->d_dot. */
MG_INTERNAL void mg_slip_rates(mg_context *c) {
  for (int i = c->below; i < c->n_all; i++) c->d_dot[i] = mg_row(c, i, c->twist);
}

/* Appends the rows of stuck grips to a list of n; returns its length. */
MG_INTERNAL int mg_list_stuck(const mg_context *c, int *list, int n) {
  for (int i = 0; i < c->sys->n_contact; i++)
    for (int g = c->sys->contact_grip[i]; g < c->sys->contact_grip[i + 1]; g++)
      for (int k = 0; k < mg_grip_rows(c, g) && c->run->active[i] && c->run->grip[g] == MG_STUCK; k++) list[n++] = mg_grip_row(c, i, g) + k;
  return mg_list_stuck_rubs(c, list, n);
}
