/* Accelerations J a + Gamma2 of rows, and below which size they count as zero. */
#include "forces/forces.h"
#include "model/model.h"

MG_INTERNAL mg_real mg_row_acceleration(const mg_context *c, int contact) {
  return mg_row_times(c, contact, c->bodies.acceleration) + c->rows.gamma[contact];
}

MG_INTERNAL mg_real mg_row_imbalance(const mg_context *c, int row) {
  return c->contacts.is_inertial[row] ? 0 : mg_row_acceleration(c, row);
}

MG_INTERNAL mg_real mg_acceleration_tolerance(const mg_context *c) {
  return c->settings->rest_acceleration * c->system->length / (c->system->time * c->system->time);
}

MG_INTERNAL mg_real mg_force_tolerance(const mg_context *c) { return mg_acceleration_tolerance(c) * c->system->mass; }

MG_INTERNAL int mg_activate_supports(mg_context *c) {
  int count = 0;
  for (int i = c->layout.support_begin; i < c->system->n_contact; i++) {
    if (!c->run->closed[i]) continue;
    mg_set_active(c, i, 1), c->rows.row_rate[i] = mg_row_acceleration(c, i);
    count++;
  }
  return count;
}
