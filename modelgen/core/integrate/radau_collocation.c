/* Collocation at the seven Radau points (Radau IIA, Hairer and Wanner, Solving Ordinary Differential Equations II,
   section IV.5) over one step: the state is a polynomial of degree 7 whose slope at the stages is the right-hand
   side. States and slopes of the stages are in c->step.slopes, from its second row on. Writes c->step. */
#include "integrate/integrate.h"
#include "model/model.h"
#include "integrate/radau_coefficients.h"

MG_INTERNAL mg_real *mg_stage_state(const mg_context *c, int stage) {
  return c->step.slopes + (1 + stage) * c->layout.n_states;
}

MG_INTERNAL mg_real *mg_stage_slope(const mg_context *c, int stage) {
  return c->step.slopes + (1 + MG_RADAU_STAGES + stage) * c->layout.n_states;
}

MG_INTERNAL mg_real mg_stage_time(int stage) { return mg_radau_time[stage]; }

MG_INTERNAL mg_real mg_collocation_weight(int row, int column) { return mg_radau_weight[row][column]; }

MG_INTERNAL mg_real mg_double_integral_weight(int row, int column) {
  mg_real sum = 0;
  for (int k = 0; k < MG_RADAU_STAGES; k++) sum += mg_radau_weight[row][k] * mg_radau_weight[k][column];
  return sum;
}

MG_INTERNAL mg_real mg_derivative(const mg_real *value, int stage) {
  mg_real sum = 0;
  for (int k = 0; k < MG_RADAU_STAGES; k++) sum += mg_radau_slope[stage][k] * (value[k] - value[stage]);
  return sum;
}

/* Lagrange polynomials of the stages at theta. */
static void mg_lagrange(mg_real theta, mg_real *value) {
  const mg_real *time = mg_radau_time;
  for (int k = 0; k < MG_RADAU_STAGES; k++) {
    mg_real above = 1, below = 1;
    for (int j = 0; j < MG_RADAU_STAGES; j++)
      if (j != k) above *= theta - time[j], below *= time[k] - time[j];
    value[k] = above / below;
  }
}

MG_INTERNAL void mg_resample_stages(mg_real *value, mg_real share) {
  mg_real old[MG_RADAU_STAGES], part[MG_RADAU_STAGES];
  for (int k = 0; k < MG_RADAU_STAGES; k++) old[k] = value[k], value[k] = 0;
  for (int stage = 0; stage < MG_RADAU_STAGES; stage++) {
    mg_lagrange(share * mg_radau_time[stage], part);
    for (int k = 0; k < MG_RADAU_STAGES; k++) value[stage] += part[k] * old[k];
  }
}

/* mg_integrate_stages over states that all take part. */
static mg_real mg_integrate_range(mg_context *c, const mg_real *x, mg_real h, int from, int to) {
  const int n = c->layout.n_states;
  mg_real *state = mg_stage_state(c, 0), *slope = mg_stage_slope(c, 0), most = 0;
  for (int i = from; i < to; i++) {
    const mg_real size = fabs(x[i]) > c->step.scale[i] ? fabs(x[i]) : c->step.scale[i];
    mg_real slopes[MG_RADAU_STAGES], all = 0;
    for (int k = 0; k < MG_RADAU_STAGES; k++) slopes[k] = h * slope[k * n + i];
    for (int stage = 0; stage < MG_RADAU_STAGES; stage++) {
      mg_real next = x[i];
      for (int k = 0; k < MG_RADAU_STAGES; k++) next += mg_radau_weight[stage][k] * slopes[k];
      const mg_real change = fabs(next - state[stage * n + i]);
      if (!(change <= all)) all = change;
      state[stage * n + i] = next;
    }
    if (!(all / size <= most)) most = all / size;
  }
  return most;
}

MG_INTERNAL mg_real mg_integrate_stages(mg_context *c, const mg_real *x, mg_real h, int from, int to) {
  mg_real most = 0;
  for (int range = 0; range < c->listed.n_range; range++) {
    const int begin = mg_range_begin(c, range), end = mg_range_end(c, range);
    const mg_real change = mg_integrate_range(c, x, h, begin > from ? begin : from, end < to ? end : to);
    if (!(change <= most)) most = change;
  }
  return most;
}

MG_INTERNAL mg_real mg_rolling_start_load_error(mg_context *c, mg_real t, const mg_real *x, mg_real h) {
  const mg_system *s = c->system;
  mg_real *slope = c->step.slopes + (1 + 2 * MG_RADAU_STAGES) * c->layout.n_states,
          *miss = c->step.slopes + (2 + 2 * MG_RADAU_STAGES) * c->layout.n_states;
  mg_real share[MG_RADAU_STAGES], sum = 0;
  mg_lagrange(0, share);
  for (int range = 0; range < c->listed.n_range; range++)
    for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++) miss[i] = 0;
  for (int stage = -1; stage < MG_RADAU_STAGES; stage++) {
    const mg_real *state = stage < 0 ? x : mg_stage_state(c, stage),
                  time = stage < 0 ? t : t + mg_stage_time(stage) * h;
    mg_update_poses(c, time, state);
    mg_free_accelerations(c, time, state, slope);
    for (int b = 0; b < s->n_body; b++)
      mg_copy_velocity(c, b, c->bodies.acceleration + 6 * b, slope + s->n_q + s->body_u[b]);
    for (int i = s->n_q; i < s->n_q + s->n_u; i++) miss[i] += slope[i] * (stage < 0 ? -1 : share[stage]);
  }
  for (int i = s->n_q; i < s->n_q + s->n_u; i++) {
    const mg_real size = fabs(x[i]) > c->step.scale[i] ? fabs(x[i]) : c->step.scale[i];
    const mg_real error = mg_stage_time(0) * h * miss[i] / (c->settings->tolerance * size);
    sum += error * error;
  }
  return sqrt(sum / c->layout.n_live_states);
}

MG_INTERNAL void mg_make_collocation_interpolant(mg_context *c, const mg_real *x) {
  const int n = c->layout.n_states;
  for (int range = 0; range < c->listed.n_range; range++)
    for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++) {
      c->step.end[i] = mg_stage_state(c, MG_RADAU_STAGES - 1)[i];
      for (int row = 0; row < MG_RADAU_STAGES; row++) {
        mg_real sum = 0;
        for (int k = 0; k < MG_RADAU_STAGES; k++) sum += mg_radau_dense[row][k] * (mg_stage_state(c, k)[i] - x[i]);
        c->step.interpolant[row * n + i] = sum;
      }
    }
}

MG_INTERNAL void mg_restrict_stages(mg_context *c, const mg_real *x, mg_real share) {
  for (int stage = 0; stage < MG_RADAU_STAGES; stage++)
    mg_interpolate(c, x, share * mg_stage_time(stage), mg_stage_state(c, stage));
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->run->rolling_start[i] == MG_START_FLAT)
      mg_resample_stages(c->step.rolling_starts[i].azimuth, share),
          mg_resample_stages(c->step.rolling_starts[i].stiffness, share);
}

MG_INTERNAL void mg_restrict_step(mg_context *c, const mg_real *x, mg_real share) {
  mg_restrict_stages(c, x, share);
  mg_make_collocation_interpolant(c, x);
}

MG_INTERNAL int mg_gauss_eliminate(mg_real A[MG_RADAU_STAGES][MG_RADAU_STAGES], mg_real *b) {
  const int n = MG_RADAU_STAGES;
  for (int k = 0; k < n; k++) {
    int pivot = k;
    for (int i = k + 1; i < n; i++)
      if (fabs(A[i][k]) > fabs(A[pivot][k])) pivot = i;
    if (!(fabs(A[pivot][k]) > 0)) return 0;
    for (int j = 0; j <= n; j++) {
      mg_real *one = j < n ? &A[k][j] : b + k, *other = j < n ? &A[pivot][j] : b + pivot;
      const mg_real value = *one;
      *one = *other, *other = value;
    }
    for (int i = k + 1; i < n; i++) {
      const mg_real factor = A[i][k] / A[k][k];
      for (int j = k; j < n; j++) A[i][j] -= factor * A[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (int k = n - 1; k >= 0; k--) {
    for (int j = k + 1; j < n; j++) b[k] -= A[k][j] * b[j];
    b[k] /= A[k][k];
  }
  return 1;
}

/* True if the state is eta of a starting contact, which is solved for, not integrated. */
static int mg_is_eta_of_rolling_start(const mg_context *c, int state) {
  const int first = c->system->n_q + c->system->n_u;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    const int from = first + c->system->contact_eta[i];
    if (c->run->rolling_start[i] == MG_START_FLAT && state >= from && state < from + c->contacts.n_eta[i]) return 1;
  }
  return 0;
}

MG_INTERNAL mg_real mg_half_step_difference(mg_context *c, const mg_real *x, const mg_real *half) {
  mg_real sum = 0;
  mg_interpolate(c, x, (mg_real)1 / 2, c->step.stage);
  for (int range = 0; range < c->listed.n_range; range++)
    for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++) {
      if (mg_is_eta_of_rolling_start(c, i)) continue;
      const mg_real size = fabs(x[i]) > c->step.scale[i] ? fabs(x[i]) : c->step.scale[i];
      const mg_real error = (c->step.stage[i] - half[i]) / (c->settings->tolerance * size);
      sum += error * error;
    }
  return sqrt(sum / c->layout.n_live_states);
}
