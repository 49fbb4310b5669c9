/* Forces of a step as the guess of the next one. A contact that goes over to other features loses those of its rows, as
   corners of boxes do that lie on each other and turn by rounding: what it pressed with goes to the contact of its pair
   that is nearest to it afterwards. Writes c->solution.force. */
#include "timestep/timestep.h"
#include "base/base.h"
#include "model/model.h"
#include "integrate/integrate.h"

/* True if a contact has rows of friction along its tangents. */
static int mg_has_tangent_rows(const mg_context *c, int contact) {
  return c->system->contact_friction_row[contact + 1] - c->system->contact_friction_row[contact] >= 2;
}

/* Force of a contact, world axes, from its rows. */
static void mg_contact_force_vector(const mg_context *c, int contact, mg_real *out) {
  mg_real friction[3] = {0};
  if (mg_has_tangent_rows(c, contact)) mg_friction_rows_vector(c, contact, c->solution.force, 0, friction);
  for (int k = 0; k < 3; k++) out[k] = c->solution.force[contact] * c->rows.normal[3 * contact + k] + friction[k];
}

/* Adds a force, world axes, to the rows of a contact, within what a contact may carry. */
static void mg_add_contact_force(mg_context *c, int contact, const mg_real *force) {
  const mg_real *t = c->rows.tangents + 6 * contact;
  c->solution.force[contact] += mg_max(mg_dot3(c->rows.normal + 3 * contact, force), (mg_real)0);
  if (!mg_has_tangent_rows(c, contact)) return;
  mg_real *friction = c->solution.force + c->layout.friction_row_begin + c->system->contact_friction_row[contact];
  friction[0] += mg_dot3(t, force), friction[1] += mg_dot3(t + 3, force);
}

MG_INTERNAL void mg_note_pressing_contacts(mg_context *c) {
  MG_NEEDS_ANY(c, MG_VALID_POSES);
  for (int i = mg_next_row(c, -1); i < c->layout.limit_begin; i = mg_next_row(c, i)) {
    mg_real *kept = c->step.pressing + 6 * i;
    c->step.pressing_on[i] = c->solution.force[i] > 0 ? c->run->feature_pair[i] : -1;
    if (c->step.pressing_on[i] < 0) continue;
    mg_place_contact(c, i, mg_contact_eta(c, c->step.settled, i), c->search.placement + 32);
    mg_copy_reals(kept, c->search.placement + 11, 3);
    mg_contact_force_vector(c, i, kept + 3);
  }
}

/* Gives the force of a contact that has changed to the nearest contact of its pair. */
static void mg_hand_on_force(mg_context *c, int pair, const mg_real *point, const mg_real *force) {
  const mg_system *s = c->system;
  mg_real least = MG_MAX;
  int nearest = -1;
  for (int j = s->pair_contact[pair]; j < s->pair_contact[pair + 1]; j++) {
    if (!mg_is_on_feature_pair(c, j) || c->run->feature_pair[j] == c->step.pressing_on[j]) continue;
    mg_place_contact(c, j, mg_contact_eta(c, c->run->x, j), c->search.placement + 32);
    const mg_real *at = c->search.placement + 11, way[3] = {at[0] - point[0], at[1] - point[1], at[2] - point[2]};
    const mg_real square = mg_dot3(way, way);
    if (square < least) least = square, nearest = j;
  }
  if (nearest >= 0) mg_add_contact_force(c, nearest, force);
}

MG_INTERNAL void mg_hand_on_forces(mg_context *c) {
  MG_NEEDS_AT_RUN(c, MG_VALID_ROWS);
  for (int i = mg_next_row(c, -1); i < c->layout.limit_begin; i = mg_next_row(c, i)) {
    const mg_real *kept = c->step.pressing + 6 * i;
    if (c->step.pressing_on[i] >= 0 && c->run->feature_pair[i] != c->step.pressing_on[i])
      mg_hand_on_force(c, c->system->contact_pair[i], kept, kept + 3);
  }
}
