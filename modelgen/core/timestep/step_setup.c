/* Start of a step of time-stepping: the rows at the positions of the scheme, the velocities at its end without
   contacts, and the least gap rate that the scheme demands there. Writes c->rows, c->bodies, c->step and, of
   the step before, c->solution.force. */
#include "timestep/timestep.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

MG_INTERNAL void mg_update_rows_at(mg_context *c, mg_real t, const mg_real *x) {
  mg_update_poses(c, t, x);
  mg_update_contact_rows(c, x);
  mg_update_joint_rows(c, t);
  mg_update_gap_rates(c);
}

MG_INTERNAL void mg_recall_time_step(mg_context *c) {
  mg_update_rows_at(c, c->run->t, c->run->x);
  for (int i = mg_next_row(c, -1); i < c->layout.friction_row_end; i = mg_next_row(c, i))
    c->solution.force[i] = c->run->reference_force[i];
}

MG_INTERNAL mg_real mg_scheme_theta(const mg_context *c) {
  return c->settings->stepping_scheme == MG_MOREAU ? c->settings->stepping_theta : 1;
}

/* to = x with positions advanced over `time` and velocities over `change` by the present slope and accelerations. */
static void mg_extrapolate_state(const mg_context *c, mg_real time, mg_real change, mg_real *to) {
  const mg_system *s = c->system;
  mg_copy_states(c, c->run->x, to);
  for (int i = 0; i < s->n_q; i++) to[i] += time * c->step.slopes[i];
  for (int b = 0; b < s->n_body; b++)
    for (int k = 0; k < c->kernels->body_kinds[mg_body_kind_of(c, b)].n_u && mg_is_moved_by_forces(c, b); k++)
      to[s->n_q + s->body_u[b] + k] += change * c->bodies.acceleration[6 * b + k];
  mg_normalise_quaternions(c, to);
}

/* Accelerations by the loads but for springs, which are rows of the impulse problem. */
static void mg_accelerate_without_springs(mg_context *c, mg_real t, const mg_real *x, mg_real *slopes) {
  c->springs.are_rows = 1;
  mg_free_accelerations(c, t, x, slopes);
  c->springs.are_rows = 0;
}

/* Adds the accelerations by the forces of the joints to c->bodies.acceleration, and stores these forces in
   c->solution.impulse. */
static void mg_add_joint_accelerations(mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) mg_set_active(c, i, 0);
  for (int i = c->layout.joint_row_begin; i < c->layout.joint_row_end; i++)
    c->rows.row_rate[i] = mg_row_acceleration(c, i);
  const int n = mg_hold_rows(c, c->run->active, 1, c->rows.row_rate, c->solution.impulse);
  for (int r = 0; r < n; r++)
    mg_add_row_response(c, c->lcp.rows[r], c->solution.impulse[c->lcp.rows[r]], c->bodies.acceleration);
}

MG_INTERNAL void mg_set_step_geometry(mg_context *c, mg_real h) {
  const mg_system *s = c->system;
  const mg_real t = c->run->t, ahead = (1 - mg_scheme_theta(c)) * h;
  MG_NEEDS_AT_RUN(c, MG_VALID_ROWS), MG_NEEDS_AT_RUN(c, MG_VALID_JOINT_ROWS), MG_NEEDS_AT_RUN(c, MG_VALID_RATES);
  mg_copy_reals(c->step.start_pose, c->bodies.pose, 12 * s->n_body);
  mg_accelerate_without_springs(c, t, c->run->x, c->step.slopes);
  mg_predict_springs(c, h);
  mg_add_joint_accelerations(c); /* without them a light link is anywhere in the middle of the step */
  mg_extrapolate_state(c, ahead, 0, c->step.settled);
  for (int i = mg_next_row(c, -1); i < s->n_contact; i = mg_next_row(c, i))
    for (int k = 0; k < c->contacts.n_eta[i]; k++)
      mg_contact_eta(c, c->step.settled, i)[k] += ahead * c->rows.eta_dot[s->contact_eta[i] + k];
  mg_extrapolate_state(c, h / 2, h / 2, c->step.stage);
  mg_update_poses(c, t + h / 2, c->step.stage);
  mg_accelerate_without_springs(c, t + h / 2, c->step.stage, c->step.slopes + c->layout.n_states);
  for (int k = 0; k < 6 * s->n_body && s->n_load; k++) c->step.load_wrench[k] = c->bodies.wrench[k];
  mg_update_spring_rows(c);
  if (ahead > 0) {
    mg_place_all_contacts(c, t + ahead, c->step.settled);
    mg_update_rows_at(c, t + ahead, c->step.settled);
  } else {
    mg_update_poses(c, t, c->step.settled);
    MG_NOTE_WITH(c, MG_VALID_GAPS, MG_VALID_POSES); /* those at run->x, but for the rounding of quaternions */
  }
  mg_set_spring_impulses(c, h);
  mg_add_joint_accelerations(c);
  MG_NOTE_DIGEST(c, MG_VALID_STEP_GEOMETRY, mg_step_digest(c, t, c->run->x, h));
}

/* True for rows of joints, whose turning is taken into account. */
static int mg_is_joint_row(const mg_context *c, int row) {
  return row >= c->layout.joint_row_begin && row < c->layout.friction_row_begin;
}

MG_INTERNAL mg_real mg_start_rate(const mg_context *c, int row, mg_real h) {
  const mg_real rate = c->rows.d_dot[row];
  return mg_is_joint_row(c, row) ? rate - (1 - mg_scheme_theta(c)) * h * c->rows.gamma[row] : rate;
}

MG_INTERNAL mg_real mg_free_end_rate(const mg_context *c, int row, mg_real h) {
  if (c->contacts.is_inertial[row]) return 0; /* the accelerations are under its force */
  const mg_real rate = c->rows.d_dot[row] + h * mg_row_times(c, row, c->bodies.acceleration);
  return mg_is_joint_row(c, row) ? rate + mg_scheme_theta(c) * h * c->rows.gamma[row] : rate;
}

MG_INTERNAL mg_real mg_resting_gap_rate_bound(const mg_context *c, int contact, mg_real h) {
  const mg_real rest = c->settings->rest_speed * c->system->length / c->system->time;
  return rest + 2 * h * (fabs(mg_row_times(c, contact, c->bodies.acceleration)) + fabs(c->rows.gamma[contact]));
}

MG_INTERNAL int mg_is_rebounding(const mg_context *c, int contact, mg_real h) {
  return c->system->restitution[contact] > 0 && c->rows.d_dot[contact] < -mg_resting_gap_rate_bound(c, contact, h);
}

/* Rate at the end of the step with which a closed contact is closed there, on a row that turns; the gap of the row may
   be due to that turning. */
static mg_real mg_closed_gap_rate(const mg_context *c, int contact, mg_real h) {
  const mg_real left = mg_scheme_theta(c) * h, ahead = h - left, gamma = c->rows.gamma[contact];
  const mg_real open = c->rows.d[contact] - ahead * ahead * gamma / 2;
  return -h * gamma / 2 - (open > 0 ? open / left : 0);
}

MG_INTERNAL mg_real mg_scheme_gap_rate(const mg_context *c, int contact, mg_real h) {
  if (mg_is_rebounding(c, contact, h)) return -c->system->restitution[contact] * c->rows.d_dot[contact];
  if (c->settings->stepping_scheme == MG_STEWART_TRINKLE) return c->rows.d[contact] <= 0 ? 0 : -c->rows.d[contact] / h;
  return c->run->closed[contact] ? mg_closed_gap_rate(c, contact, h) : 0;
}

MG_INTERNAL mg_real mg_free_spring_rate(const mg_context *c, int row, mg_real h) {
  return mg_free_end_rate(c, row, h) - c->springs.impulse[row - c->layout.spring_row_begin];
}
