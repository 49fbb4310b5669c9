/* Classical Runge-Kutta method of order 4 with a fixed step. Reads and writes c->step. */
#include "integrate/integrate.h"
#include "model/model.h"
#include "forces/forces.h"

MG_INTERNAL void mg_rk4(mg_context *c, mg_real t, const mg_real *x, mg_real h) {
  static const mg_real node[3] = {(mg_real)0.5, (mg_real)0.5, 1};
  const int n = c->layout.n_states;
  mg_real *K = c->step.slopes;
  for (int stage = 0; stage < 3; stage++) {
    const mg_real step = node[stage] * h, *k = K + stage * n;
    for (int range = 0; range < c->listed.n_range; range++)
      for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++) c->step.stage[i] = x[i] + step * k[i];
    if (c->settings->newton > 1) mg_place_all_contacts(c, t + step, c->step.stage);
    mg_right_hand_side(c, t + step, c->step.stage, K + (stage + 1) * n);
    mg_watch_event_signs(c);
  }
  const mg_real sixth = h / 6;
  for (int range = 0; range < c->listed.n_range; range++)
    for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++)
      c->step.end[i] = x[i] + sixth * (K[i] + 2 * (K[n + i] + K[2 * n + i]) + K[3 * n + i]);
}
