/* Dormand and Prince's method of order 8(5,3) with dense output of order 7 (Hairer, Norsett and Wanner, Solving
   Ordinary Differential Equations I, second edition, section II.10). Reads c->step.slopes row 0, the slope at the
   start; writes slopes, c->step.end and c->step.interpolant. */
#include "integrate/integrate.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/dop853_coefficients.h"

/* out = x + h sum a_k K_k over the entries of one row of the tableau; four states at a time, with sums in
   registers. */
static void mg_dop853_combine_range(const mg_context *c, int range, int row, const mg_real *x, mg_real h,
                                    mg_real *out) {
  const int n = c->layout.n_states, first = mg_dop_row[row], end = mg_dop_row[row + 1];
  const int last = mg_range_end(c, range);
  int i = mg_range_begin(c, range);
  for (; i + 4 <= last; i += 4) {
    mg_real sum[4] = {0, 0, 0, 0};
    for (int k = first; k < end; k++) {
      const mg_real weight = mg_dop_value[k], *slope = c->step.slopes + mg_dop_column[k] * n + i;
      sum[0] += weight * slope[0], sum[1] += weight * slope[1];
      sum[2] += weight * slope[2], sum[3] += weight * slope[3];
    }
    for (int j = 0; j < 4; j++) out[i + j] = x[i + j] + h * sum[j];
  }
  for (; i < last; i++) {
    mg_real sum = 0;
    for (int k = first; k < end; k++) sum += mg_dop_value[k] * c->step.slopes[mg_dop_column[k] * n + i];
    out[i] = x[i] + h * sum;
  }
}

/* The same over all states that take part. */
static void mg_dop853_combine(const mg_context *c, int row, const mg_real *x, mg_real h, mg_real *out) {
  for (int range = 0; range < c->listed.n_range; range++) mg_dop853_combine_range(c, range, row, x, h, out);
}

/* Evaluates the right-hand side of a stage. */
static void mg_dop853_stage(mg_context *c, int is_composed, int stage, mg_real t, const mg_real *x, mg_real h) {
  const mg_real time = t + mg_dop_time[stage] * h;
  mg_dop853_combine(c, stage, x, h, c->step.stage);
  if (c->settings->newton > 1) mg_place_all_contacts(c, time, c->step.stage);
  mg_stage_right_hand_side(c, is_composed, time, c->step.stage, c->step.slopes + stage * c->layout.n_states);
}

MG_INTERNAL mg_real mg_dop853_error(const mg_context *c, const mg_real *x, const mg_real *end, const mg_real *slopes,
                                    long stride, mg_real least, mg_real h) {
  mg_real fifth = 0, third = 0;
  for (int range = 0; range < c->listed.n_range; range++)
    for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++) {
      mg_real e5 = 0, e3 = (end[i] - x[i]) / h;
      for (int j = 0; j < 12; j++) {
        const mg_real slope = slopes[j * stride + i];
        e5 += mg_dop_fifth[j] * slope, e3 -= mg_dop_third[j] * slope;
      }
      const mg_real size = mg_max(fabs(x[i]), least * c->step.scale[i]);
      const mg_real weight = 1 / (c->settings->tolerance * size);
      fifth += e5 * weight * e5 * weight, third += e3 * weight * e3 * weight;
    }
  if (fifth == 0) return 0;
  return fabs(h) * fifth / sqrt((fifth + third / 100) * c->layout.n_live_states);
}

MG_INTERNAL mg_real mg_dop853(mg_context *c, mg_real t, const mg_real *x, mg_real h) {
  const int is_composed = mg_is_in_mode_of_scene_rhs(c);
  mg_follower *follower = c->step.follower && c->step.follower->is_open ? c->step.follower : 0;
  if (follower) follower->stage(c, follower->of, is_composed, 0, t, h);
  for (int stage = 1; stage < 12; stage++) {
    mg_dop853_stage(c, is_composed, stage, t, x, h);
    if (stage > 2) mg_watch_event_signs(c), mg_sample_margins_at_stage(c, stage);
    if (follower) follower->stage(c, follower->of, is_composed, stage, t + mg_dop_time[stage] * h, h);
  }
  mg_dop853_combine(c, 12, x, h, c->step.end);
  if (follower) follower->stage(c, follower->of, is_composed, 12, t + h, h), follower->h = h;
  const mg_real error = mg_dop853_error(c, x, c->step.end, c->step.slopes, c->layout.n_states, 1, h);
  return follower ? mg_max(error, follower->error(c, follower->of, h)) : error;
}

MG_INTERNAL void mg_dop853_dense(mg_context *c, mg_real t, const mg_real *x, mg_real h) {
  const int n = c->layout.n_states, is_composed = mg_is_in_mode_of_scene_rhs(c);
  for (int stage = 13; stage < 16; stage++) mg_dop853_stage(c, is_composed, stage, t, x, h);
  for (int range = 0; range < c->listed.n_range; range++)
    for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++) {
      const mg_real delta = c->step.end[i] - x[i], first = c->step.slopes[i], last = c->step.slopes[12 * n + i];
      c->step.interpolant[i] = delta;
      c->step.interpolant[n + i] = h * first - delta;
      c->step.interpolant[2 * n + i] = 2 * delta - h * (first + last);
      for (int row = 0; row < 4; row++) {
        mg_real sum = 0;
        for (int j = 0; j < 16; j++) sum += mg_dop_dense[row][j] * c->step.slopes[j * n + i];
        c->step.interpolant[(3 + row) * n + i] = h * sum;
      }
    }
}
