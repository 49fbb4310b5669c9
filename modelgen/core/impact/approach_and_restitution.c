/* Which contacts approach, the restitution that applies to them, and what the supports rebound with. */
#include "impact/impact.h"
#include "model/model.h"
#include "forces/forces.h"

MG_INTERNAL int mg_is_approaching(const mg_context *c, int contact) {
  return c->rows.d_dot[contact] < -c->settings->rest_speed * c->system->length / c->system->time;
}

/* Blows in a row after which slow bounces within rounding of positions end. A light body between its ground and a heavy
   one, whose weight it carries by bouncing, comes to such bounces just before it rests, and rounding would keep them
   up. */
#define MG_TINY_BOUNCES 32

MG_INTERNAL mg_real mg_effective_restitution(const mg_context *c, int contact) {
  const mg_real e = c->system->restitution[contact], approach = -c->rows.d_dot[contact];
  const mg_real least = c->settings->rest_speed * c->system->length / c->system->time;
  return e * approach > least && 4 * approach > 5 * least && !mg_has_patch_just_opened(c, contact) &&
                 !(c->run->tiny_bounces > MG_TINY_BOUNCES && mg_is_bounce_tiny(c, contact, approach))
             ? e
             : 0;
}

MG_INTERNAL mg_real mg_remaining_bounce_time(mg_context *c, int contact) {
  const mg_real e = c->system->restitution[contact], closing_acceleration = -mg_row_acceleration(c, contact),
                most = c->settings->time_resolution * c->system->time;
  const mg_real twice_speed_after = -2 * e * c->rows.d_dot[contact];
  return e < 1 && twice_speed_after > 0 && closing_acceleration > mg_acceleration_tolerance(c) &&
                 twice_speed_after < most * closing_acceleration * (1 - e)
             ? twice_speed_after / (closing_acceleration * (1 - e))
             : 0;
}

MG_INTERNAL void mg_set_support_impact_rates(mg_context *c) {
  MG_NEEDS_AT_RUN(c, MG_VALID_RATES);
  for (int i = c->layout.support_begin; i < c->layout.joint_row_end; i++) c->rows.row_rate[i] = c->rows.d_dot[i];
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    const int support = mg_first_support(c, slot);
    mg_real e = 0;
    for (int k = 0; k < 3 && c->patches.trial[slot] == 1; k++)
      e = mg_effective_restitution(c, support + k) > e ? mg_effective_restitution(c, support + k) : e;
    for (int k = 0; k < 3; k++) c->rows.row_rate[support + k] *= 1 + e;
  }
}
