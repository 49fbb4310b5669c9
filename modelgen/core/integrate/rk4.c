/* Classical Runge-Kutta method of order 4 with a fixed step. Reads and writes c->step. */
#include "integrate/integrate.h"
#include "model/model.h"
#include "forces/forces.h"

/* Forces at the stages of mg_scene_rk4: rows of slopes that it does not need otherwise. */
static mg_real *mg_scene_step_forces(const mg_context *c) { return c->step.slopes + c->layout.n_states; }

MG_INTERNAL void mg_scene_rk4(mg_context *c, mg_real t, const mg_real *x, mg_real h, const mg_real *slope,
                              mg_real *end) {
  const mg_system *s = c->system;
  c->kernels->scene_step(&t, x, h, s->gravity, s->parameters, slope, mg_scene_step_forces(c), end);
  end[c->layout.work_state] = x[c->layout.work_state];
  mg_count_evaluations(c, slope ? 3 : 4);
}

/* Watches event functions at the last three stages of mg_scene_rk4. */
static void mg_watch_scene_stages(mg_context *c) {
  const mg_system *s = c->system;
  const int count = mg_scene_force_count(c);
  for (int stage = 1; stage < 4; stage++) {
    const mg_real *force = mg_scene_step_forces(c) + stage * count;
    for (int pair = 0; pair < s->n_pair; pair++)
      if (force[pair] < 0) c->step.sign_changed = 1;
    if (!s->n_friction) continue;
    mg_set_scene_forces(c, force);
    if (mg_has_any_friction_event(c)) c->step.sign_changed = 1;
  }
}

MG_INTERNAL void mg_rk4(mg_context *c, mg_real t, const mg_real *x, mg_real h) {
  MG_NEEDS(c, MG_VALID_SLOPE, t, x);
  static const mg_real node[3] = {(mg_real)0.5, (mg_real)0.5, 1};
  const int n = c->layout.n_states, is_composed = mg_is_in_mode_of_scene_rhs(c);
  mg_real *K = c->step.slopes;
  if (is_composed && c->settings->newton <= 1) {
    mg_scene_rk4(c, t, x, h, K, c->step.end);
    mg_watch_scene_stages(c);
    return;
  }
  for (int stage = 0; stage < 3; stage++) {
    const mg_real step = node[stage] * h, *k = K + stage * n;
    for (int range = 0; range < c->listed.n_range; range++)
      for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++) c->step.stage[i] = x[i] + step * k[i];
    if (c->settings->newton > 1) mg_place_all_contacts(c, t + step, c->step.stage);
    mg_stage_right_hand_side(c, is_composed, t + step, c->step.stage, K + (stage + 1) * n);
    mg_watch_event_signs(c);
  }
  const mg_real sixth = h / 6;
  for (int range = 0; range < c->listed.n_range; range++)
    for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++)
      c->step.end[i] = x[i] + sixth * (K[i] + 2 * (K[n + i] + K[2 * n + i]) + K[3 * n + i]);
}
