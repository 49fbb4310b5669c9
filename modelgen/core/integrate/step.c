/* One step of the chosen method and its interpolant. Writes c->step. */
#include "integrate/integrate.h"
#include "model/model.h"
#include "forces/forces.h"

/* Row of c->step.slopes that holds the slope at the end of the step. */
static int mg_end_slope_row(const mg_context *c) { return c->settings->method == MG_RK4 ? 4 : 12; }

MG_INTERNAL int mg_is_collocated(const mg_context *c) {
  return mg_has_rolling_start(c) || mg_has_slip_onset(c) || mg_has_stiff_slip(c);
}

MG_INTERNAL mg_real mg_take_step(mg_context *c, mg_real t, const mg_real *x, mg_real h) {
  MG_NEEDS(c, MG_VALID_SLOPE, t, x);
  if (c->step.follower) c->step.follower->h = 0;
  if (mg_has_rolling_start(c)) return mg_take_rolling_start_step(c, t, c->run->x, h);
  if (c->system->n_friction && mg_has_slip_onset(c)) {
    const mg_real error = mg_take_slip_onset_step(c, t, x, h), least = c->system->time * sqrt(c->settings->tolerance);
    if (error <= MG_MAX / 2 || (c->settings->method == MG_DOP853 && h > least)) return error;
    mg_finish_slip_onsets(c);
  }
  if (c->system->n_friction && mg_has_stiff_slip(c)) return mg_take_stiff_slip_step(c, t, x, h);
  if (c->settings->method == MG_DOP853) return mg_dop853(c, t, x, h);
  mg_rk4(c, t, x, h);
  return 0;
}

MG_INTERNAL mg_real mg_try_step(mg_context *c, mg_real t, const mg_real *x, mg_real h) {
  c->step.sign_changed = c->step.beyond_margin = 0;
  if (c->step.follower) c->step.follower->is_open = 1;
  const mg_real error = mg_take_step(c, t, x, h);
  if (c->step.follower) c->step.follower->is_open = 0;
  return error;
}

MG_INTERNAL void mg_finish_step(mg_context *c, mg_real t, mg_real h) {
  mg_normalise_quaternions(c, c->step.end);
  mg_right_hand_side(c, t + h, c->step.end, c->step.slopes + mg_end_slope_row(c) * c->layout.n_states);
  mg_update_gap_rates(c);
  MG_NOTE(c, MG_VALID_END_SLOPE, t + h, c->step.end);
  c->step.end_time = t + h;
  c->step.is_end_evaluated = !mg_is_collocated(c) && !c->system->n_switch && !c->system->n_patch_slot;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) c->step.end_gap[i] = c->rows.d[i];
}

/* True if the state of the run is that at the end of the step, at which the context is evaluated. */
static int mg_is_run_at_evaluated_end(const mg_context *c) {
  if (!c->step.is_end_evaluated || c->run->t != c->step.end_time) return 0;
  for (int range = 0; range < c->listed.n_range; range++)
    for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++)
      if (c->run->x[i] != c->step.end[i]) return 0;
  return 1;
}

MG_INTERNAL void mg_evaluate_accepted_state(mg_context *c) {
  if (!mg_is_run_at_evaluated_end(c)) {
    mg_evaluate_run_state(c);
    return;
  }
  MG_NEEDS_AT_RUN(c, MG_VALID_FORCES), MG_NEEDS_AT_RUN(c, MG_VALID_RATES), MG_NEEDS_AT_RUN(c, MG_VALID_TWISTS);
  mg_copy_states(c, c->step.slopes + mg_end_slope_row(c) * c->layout.n_states, c->step.slopes);
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    c->rows.d[i] = c->step.end_gap[i], c->run->force[i] = c->solution.force[i];
  MG_NOTE_WITH(c, MG_VALID_SLOPE, MG_VALID_FORCES);
}

MG_INTERNAL void mg_make_cubic_interpolant(mg_context *c, const mg_real *x, mg_real h) {
  const int n = c->layout.n_states, end = mg_end_slope_row(c);
  if (mg_is_collocated(c)) return; /* which has made an interpolant */
  for (int range = 0; range < c->listed.n_range; range++)
    for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++) {
      const mg_real delta = c->step.end[i] - x[i], first = c->step.slopes[i], last = c->step.slopes[end * n + i];
      c->step.interpolant[i] = delta, c->step.interpolant[n + i] = h * first - delta,
      c->step.interpolant[2 * n + i] = 2 * delta - h * (first + last);
      for (int row = 3; row < 7; row++) c->step.interpolant[row * n + i] = 0;
    }
}

MG_INTERNAL void mg_make_interpolant(mg_context *c, mg_real t, const mg_real *x, mg_real h) {
  c->step.is_end_evaluated = 0; /* it is there to look at other states */
  if (c->settings->method != MG_DOP853) mg_make_cubic_interpolant(c, x, h);
  else if (!mg_is_collocated(c)) mg_dop853_dense(c, t, x, h);
  MG_NOTE_DIGEST(c, MG_VALID_INTERPOLANT, mg_step_digest(c, t, x, h));
}

/* True if safety * error^(-1/8) is above `most` by far, which so needs no power. */
static int mg_is_growth_limited(mg_real error, mg_real safety, mg_real most) {
  const mg_real ratio = most / safety, square = ratio * ratio, fourth = square * square;
  return 2 * error * fourth * fourth < 1;
}

MG_INTERNAL mg_real mg_step_growth(mg_real error, mg_real most) {
  const mg_real safety = (mg_real)0.8;
  if (mg_is_growth_limited(error, safety, most)) return most;
  const mg_real factor = safety * mg_pow(error, -(mg_real)1 / 8);
  return factor > most ? most : factor < (mg_real)0.2 ? (mg_real)0.2 : factor;
}

MG_INTERNAL mg_real mg_first_step(const mg_context *c) {
  if (c->settings->step > 0) return c->settings->step;
  return c->system->time * mg_pow(c->settings->tolerance, (mg_real)1 / 8) / 4;
}
