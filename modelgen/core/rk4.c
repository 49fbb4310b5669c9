/* Runge and Kutta's method of order 4 with a fixed step. */
#include "core.h"

/* K[0] holds the slope at (t, x); writes c->x_next. */
MG_INTERNAL void mg_rk4(mg_context *c, mg_real t, const mg_real *x, mg_real h) {
  static const mg_real node[3] = {(mg_real)0.5, (mg_real)0.5, 1};
  const int n = c->n_x;
  mg_real *K = c->K;
  for (int stage = 0; stage < 3; stage++) {
    const mg_real step = node[stage] * h, *k = K + stage * n;
    for (int i = 0; i < n; i++) c->x_stage[i] = x[i] + step * k[i];
    if (c->set->newton > 1) mg_place_all(c, t + step, c->x_stage);
    mg_rhs(c, t + step, c->x_stage, K + (stage + 1) * n);
    mg_watch(c);
  }
  const mg_real sixth = h / 6;
  for (int i = 0; i < n; i++)
    c->x_next[i] = x[i] + sixth * (K[i] + 2 * (K[n + i] + K[2 * n + i]) + K[3 * n + i]);
}

MG_API void mg_smooth(const mg_system *system, const mg_settings *settings, mg_run *run, long n, mg_real *work,
                      int *iwork) {
  mg_context c;
  mg_open(&c, system, settings, run, work, iwork);
  for (long step = 0; step < n; step++) {
    mg_rhs(&c, run->t, run->x, c.K);
    mg_rk4(&c, run->t, run->x, settings->step);
    for (int i = 0; i < c.n_x; i++) run->x[i] = c.x_next[i];
    mg_pass_time(run, settings->step);
  }
  run->steps += n;
}
