/* Classical Runge-Kutta method of order 4 with a fixed step. Reads and writes c->step. */
#include "integrate/integrate.h"
#include "model/model.h"
#include "forces/forces.h"

/* out = x + step k over the states that take part; four at a time, with sums in registers. */
static void mg_rk4_stage(const mg_context *c, const mg_real *x, mg_real step, const mg_real *k, mg_real *out) {
  for (int range = 0; range < c->listed.n_range; range++) {
    const int last = mg_range_end(c, range);
    int i = mg_range_begin(c, range);
    for (; i + 4 <= last; i += 4) {
      const mg_real at[4] = {x[i] + step * k[i], x[i + 1] + step * k[i + 1], x[i + 2] + step * k[i + 2],
                             x[i + 3] + step * k[i + 3]};
      out[i] = at[0], out[i + 1] = at[1], out[i + 2] = at[2], out[i + 3] = at[3];
    }
    for (; i < last; i++) out[i] = x[i] + step * k[i];
  }
}

/* out = x + sixth (k1 + 2 (k2 + k3) + k4) of the slopes K, n numbers each. */
static void mg_rk4_end(const mg_context *c, const mg_real *x, mg_real sixth, const mg_real *K, int n, mg_real *out) {
  for (int range = 0; range < c->listed.n_range; range++) {
    const int last = mg_range_end(c, range);
    int i = mg_range_begin(c, range);
    for (; i + 4 <= last; i += 4) {
      const mg_real *a = K + i, *b = a + n, *d = b + n, *e = d + n;
      const mg_real at[4] = {
          x[i] + sixth * (a[0] + 2 * (b[0] + d[0]) + e[0]), x[i + 1] + sixth * (a[1] + 2 * (b[1] + d[1]) + e[1]),
          x[i + 2] + sixth * (a[2] + 2 * (b[2] + d[2]) + e[2]), x[i + 3] + sixth * (a[3] + 2 * (b[3] + d[3]) + e[3])};
      out[i] = at[0], out[i + 1] = at[1], out[i + 2] = at[2], out[i + 3] = at[3];
    }
    for (; i < last; i++) out[i] = x[i] + sixth * (K[i] + 2 * (K[n + i] + K[2 * n + i]) + K[3 * n + i]);
  }
}

MG_INTERNAL void mg_scene_rk4(mg_context *c, mg_real t, const mg_real *x, mg_real h, const mg_real *slope) {
  const mg_system *s = c->system;
  mg_real *force = c->step.slopes + c->layout.n_states; /* rows that the step does not need otherwise */
  c->kernels->scene_step(&t, x, h, s->gravity, s->parameters, slope, force, c->step.end);
  c->step.end[c->layout.work_state] = x[c->layout.work_state];
  for (int k = s->n_pair; k < 4 * s->n_pair; k++)
    if (force[k] < 0) c->step.sign_changed = 1;
  c->run->rhs_evals += slope ? 3 : 4;
}

MG_INTERNAL void mg_rk4(mg_context *c, mg_real t, const mg_real *x, mg_real h) {
  static const mg_real node[3] = {(mg_real)0.5, (mg_real)0.5, 1};
  const int n = c->layout.n_states, is_composed = mg_is_in_mode_of_scene_rhs(c);
  mg_real *K = c->step.slopes;
  if (is_composed && c->settings->newton <= 1) {
    mg_scene_rk4(c, t, x, h, K);
    return;
  }
  for (int stage = 0; stage < 3; stage++) {
    const mg_real step = node[stage] * h;
    mg_rk4_stage(c, x, step, K + stage * n, c->step.stage);
    if (c->settings->newton > 1) mg_place_all_contacts(c, t + step, c->step.stage);
    mg_stage_right_hand_side(c, is_composed, t + step, c->step.stage, K + (stage + 1) * n);
    mg_watch_event_signs(c);
  }
  mg_rk4_end(c, x, h / 6, K, n, c->step.end);
}
