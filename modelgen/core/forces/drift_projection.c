/* Drift projection: deviations from zero gap, zero gap velocity and the joint rows are removed along M^-1 J^T,
   the least change in the kinetic metric. Writes positions, orientations and velocities of the run's state, and
   evaluates it again. A correction of positions that moves a body much farther than what it removes comes from rows
   that are almost dependent, or from a wrong closest point, and is not made. */
#include "forces/forces.h"
#include "model/model.h"

MG_INTERNAL mg_real mg_largest_held_violation(const mg_context *c, const mg_real *value) {
  mg_real largest = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->run->closed[i] && fabs(value[i]) > largest) largest = fabs(value[i]);
  for (int i = c->layout.joint_row_begin; i < c->layout.joint_row_end; i++)
    if (fabs(value[i]) > largest) largest = fabs(value[i]);
  const int n = c->system->n_friction ? mg_append_sticking_rows(c, c->lcp.rows, 0) : 0;
  for (int r = 0; r < n; r++)
    if (fabs(value[c->lcp.rows[r]]) > largest) largest = fabs(value[c->lcp.rows[r]]);
  return largest;
}

/* Set the corrections of all bodies to zero. */
static void mg_clear_body_corrections(mg_context *c) {
  for (int i = 0; i < 6 * c->system->n_body; i++) c->bodies.wrench[i] = 0;
}

/* Corrections of all bodies by the impulses of the n rows of c->lcp.rows. */
MG_INTERNAL int mg_set_body_corrections(mg_context *c, int n) {
  mg_clear_body_corrections(c);
  for (int r = 0; r < n; r++)
    mg_add_row_response(c, c->lcp.rows[r], c->solution.impulse[c->lcp.rows[r]], c->bodies.wrench);
  return n;
}

MG_INTERNAL int mg_solve_row_correction(mg_context *c, const int *marked, const mg_real *value) {
  return mg_set_body_corrections(c, mg_hold_rows(c, marked, 1, value, c->solution.impulse));
}

MG_INTERNAL void mg_rotate_quaternion(mg_real *e, const mg_real *angle) {
  const mg_real x = angle[0] / 2, y = angle[1] / 2, z = angle[2] / 2;
  const mg_real q0 = e[0], q1 = e[1], q2 = e[2], q3 = e[3];
  e[0] = q0 - q1 * x - q2 * y - q3 * z;
  e[1] = q1 + q0 * x + q2 * z - q3 * y;
  e[2] = q2 + q0 * y + q3 * x - q1 * z;
  e[3] = q3 + q0 * z + q1 * y - q2 * x;
}

/* Kinetic energy of a body at velocities u, J. */
static mg_real mg_kinetic_energy(const mg_context *c, int body, const mg_real *u) {
  const mg_system *s = c->system;
  mg_real moving, height, momentum[3], spin[3];
  c->kernels->body_energy(mg_body_kind_of(c, body), c->run->x + s->body_q[body], u, s->gravity,
                          s->parameters + s->body_parameters[body], &moving, &height, momentum, spin);
  return moving;
}

/* True if the corrections move no body farther than they may: the root mean square of the movement of its mass has the
   kinetic energy of the correction as a velocity, over that of unit velocity. */
static int mg_is_correction_bounded(const mg_context *c, mg_real violation) {
  const mg_real unit[6] = {1};
  const mg_real most = c->settings->correction_ratio * violation + c->settings->contact_gap * c->system->length;
  for (int b = 0; b < c->system->n_body; b++) {
    if (!mg_is_moved_by_forces(c, b)) continue;
    const mg_real moving = mg_kinetic_energy(c, b, c->bodies.wrench + 6 * b);
    if (!(sqrt(moving / mg_kinetic_energy(c, b, unit)) <= most)) return 0;
  }
  return 1;
}

MG_INTERNAL int mg_apply_pose_correction(mg_context *c, mg_real violation) {
  const mg_system *s = c->system;
  if (!mg_is_correction_bounded(c, violation)) {
    mg_clear_body_corrections(c);
    return 0;
  }
  for (int b = 0; b < s->n_body; b++) {
    if (!mg_is_moved_by_forces(c, b)) continue;
    mg_real *q = c->run->x + s->body_q[b], *change = c->bodies.wrench + 6 * b;
    for (int k = 0; k < 3; k++) q[k] += change[k];
    if (c->bodies.motion[b] == MG_FREE) mg_rotate_quaternion(q + 3, change + 3);
  }
  mg_normalise_quaternions(c, c->run->x);
  mg_clear_body_corrections(c);
  return 1;
}

MG_INTERNAL void mg_apply_velocity_correction(mg_context *c) {
  const mg_system *s = c->system;
  for (int b = 0; b < s->n_body; b++)
    for (int k = 0; k < c->kernels->body_kinds[mg_body_kind_of(c, b)].n_u; k++)
      c->run->x[s->n_q + s->body_u[b] + k] += c->bodies.wrench[6 * b + k];
  mg_clear_body_corrections(c);
}

MG_INTERNAL int mg_project_drift(mg_context *c) {
  MG_NEEDS_AT_RUN(c, MG_VALID_ROWS), MG_NEEDS_WITH(c, MG_VALID_RATES, MG_VALID_TWISTS);
  const mg_real drift = c->settings->drift_tolerance * c->system->length,
                violation = mg_largest_held_violation(c, c->rows.d);
  if (violation > drift) {
    mg_solve_row_correction(c, c->run->closed, c->rows.d);
    if (mg_apply_pose_correction(c, violation)) {
      if (!mg_place_all_contacts(c, c->run->t, c->run->x)) return 0;
      mg_evaluate_run_state(c);
    }
  }
  if (mg_largest_held_violation(c, c->rows.d_dot) > drift / c->system->time) {
    mg_solve_row_correction(c, c->run->closed, c->rows.d_dot);
    mg_apply_velocity_correction(c);
    mg_evaluate_run_state(c);
  }
  return 1;
}

MG_INTERNAL int mg_project_initial_pose(mg_context *c) {
  for (int round = 0; round < 5; round++) {
    const mg_real violation = mg_largest_held_violation(c, c->rows.d);
    if (violation <= c->settings->drift_tolerance * c->system->length) return 1;
    mg_solve_row_correction(c, c->run->closed, c->rows.d);
    if (!mg_apply_pose_correction(c, violation)) return 1;
    for (int extra = 0; extra < 3; extra++)
      if (!mg_place_all_contacts(c, c->run->t, c->run->x)) return 0;
    mg_evaluate_run_state(c);
  }
  return 1;
}

/* Remove velocities that the joints forbid, by an impulse of the joints alone. */
static void mg_project_joint_velocities(mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) c->events.gap_dips[i] = 0;
  mg_solve_row_correction(c, c->events.gap_dips, c->rows.d_dot);
  mg_apply_velocity_correction(c);
  mg_evaluate_run_state(c);
}

MG_INTERNAL int mg_project_initial_joints(mg_context *c) {
  MG_NEEDS_AT_RUN(c, MG_VALID_ROWS);
  mg_real error, speed;
  if (!c->system->n_joint_row) return 1;
  const int joint = mg_worst_joint(c, c->rows.d, &error);
  mg_report_start_of_joints(c->run, joint, error);
  if (!(error <= c->settings->start_joint_gap * c->system->length)) return 0;
  const int fastest = mg_worst_joint(c, c->rows.d_dot, &speed);
  mg_report_start_speed_of_joints(c->run, fastest, speed);
  mg_project_joint_velocities(c);
  if (!mg_project_initial_pose(c)) return 0;
  mg_project_joint_velocities(c);
  return 1;
}
