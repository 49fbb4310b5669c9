/* End of a step of time-stepping: velocities, work, positions, contact points, and the correction of penetration
   (post-stabilisation: Anitescu and Hart, Int. J. Numer. Methods Eng. 60 (2004), 2335-2371). Writes the state and
   statistics of the run. */
#include "timestep/timestep.h"
#include "base/base.h"
#include "solve/lcp/lcp_solvers.h"
#include "model/model.h"
#include "closest/closest.h"
#include "forces/forces.h"
#include "features/features.h"
#include "events/events.h"

/* Rounds of the correction of penetration: a body that lies almost flat on a rim tips from one side of it to the other,
   and loses about two fifths of its penetration in a round. It ends where a number of rounds do not halve it. */
enum { MG_CORRECTIONS = 64, MG_SLOW_CORRECTIONS = 6 };

/* A correction solves its problem to a quarter of the penetration that is allowed, and at least to a hundredth of the
   present one. */
#define MG_CORRECTED_TO 4
#define MG_COARSEST_CORRECTION ((mg_real)0.01)

/* Work of the impulse of a row against the mean of its rates before and after, without the part that prescribed
   motions do. */
static mg_real mg_row_impulse_work(const mg_context *c, int row, mg_real h) {
  if (c->solution.force[row] == 0) return 0;
  const mg_real after = mg_free_end_rate(c, row, h) + mg_row_times(c, row, c->bodies.wrench),
                mean = c->contacts.is_inertial[row] ? 0 : (mg_start_rate(c, row, h) + after) / 2;
  return c->solution.force[row] * (mean - mg_prescribed_gap_rate(c, row));
}

/* Adds the work of all impulses; notes the impact that adds most energy, which Newton's law with friction permits. */
static void mg_add_impulse_work(mg_context *c, mg_real h) {
  mg_run *run = c->run;
  for (int i = mg_next_row(c, -1); i < c->layout.friction_row_end; i = mg_next_row(c, i))
    run->x[c->layout.work_state] += mg_row_impulse_work(c, i, h);
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) {
    if (!mg_is_rebounding(c, i, h)) continue;
    const int first =
        c->layout.friction_row_begin + (mg_tangential_row_count(c, i) ? c->system->contact_friction_row[i] : 0);
    mg_real gain = mg_row_impulse_work(c, i, h);
    for (int row = first; row < first + mg_tangential_row_count(c, i); row++) gain += mg_row_impulse_work(c, row, h);
    mg_report_impact_gain(run, mg_told_contact(c->system, run, i), run->t + h, gain);
  }
}

/* Work of the loads: the wrench of a body over the step, times the mean of its twists at both ends. */
static mg_real mg_load_work(const mg_context *c, mg_real h) {
  mg_real work = 0;
  for (int b = 0; b < c->system->n_body; b++)
    for (int k = 6 * b; k < 6 * b + 6 && mg_is_moved_by_forces(c, b); k++) {
      const mg_real change = h * c->bodies.acceleration[k] + c->bodies.wrench[k];
      work += h * c->step.load_wrench[k] * (c->bodies.twist[k] + change / 2);
    }
  return work;
}

MG_INTERNAL void mg_apply_step_impulses(mg_context *c, mg_real h) {
  const mg_system *s = c->system;
  mg_add_impulse_work(c, h);
  if (s->n_load) c->run->x[c->layout.work_state] += mg_load_work(c, h) + mg_spring_work(c, h);
  for (int b = 0; b < s->n_body; b++)
    for (int k = 0; k < c->kernels->body_kinds[mg_body_kind_of(c, b)].n_u && mg_is_moved_by_forces(c, b); k++)
      c->run->x[s->n_q + s->body_u[b] + k] += h * c->bodies.acceleration[6 * b + k] + c->bodies.wrench[6 * b + k];
  for (int i = 0; i < 6 * s->n_body; i++) c->bodies.wrench[i] = 0;
}

/* Marks in c->islands.head the bodies that a contact holds in this step, and those joined to one of them. Contacts that
   rebound hold none: their impact is anywhere in the step. */
static void mg_mark_held_bodies(mg_context *c, mg_real h) {
  const mg_system *s = c->system;
  int *is_held = c->islands.head, changed = 1;
  for (int b = 0; b < s->n_body; b++) is_held[b] = 0;
  for (int i = mg_next_row(c, -1); i < s->n_contact; i = mg_next_row(c, i))
    if (c->solution.force[i] > 0 && !mg_is_rebounding(c, i, h))
      is_held[c->contacts.o[i]] = is_held[c->contacts.f[i]] = 1;
  while (changed) {
    changed = 0;
    for (int j = 0; j < s->n_joint; j++) {
      const int a = s->joint_a[j], b = s->joint_b[j];
      if (is_held[a] == is_held[b] || !mg_is_moved_by_forces(c, a) || !mg_is_moved_by_forces(c, b)) continue;
      is_held[a] = is_held[b] = changed = 1;
    }
  }
}

/* Velocities of a body that move it over the rest of the step: those at the end of the step; in a scheme that takes
   the rows at the start, the mean of those at both ends where no contact holds the body, which is of order 2. `mean` is
   room for them. */
static const mg_real *mg_moving_velocities(const mg_context *c, int body, mg_real *mean) {
  const int first = c->system->n_q + c->system->body_u[body];
  const mg_real *start = c->step.end + first, *end = c->run->x + first;
  if (c->settings->stepping_scheme == MG_MOREAU || c->islands.head[body]) return end;
  for (int k = 0; k < c->kernels->body_kinds[mg_body_kind_of(c, body)].n_u; k++) mean[k] = (start[k] + end[k]) / 2;
  return mean;
}

MG_INTERNAL void mg_integrate_positions(mg_context *c, mg_real h) {
  MG_NEEDS_DIGEST(c, MG_VALID_STEP_GEOMETRY, mg_step_digest(c, c->run->t, c->step.end, h));
  const mg_system *s = c->system;
  const mg_real left = mg_scheme_theta(c) * h, none[6] = {0};
  mg_real mean[6], unused[6];
  if (c->settings->stepping_scheme != MG_MOREAU) mg_mark_held_bodies(c, h);
  for (int b = 0; b < s->n_body; b++) {
    if (!mg_is_moved_by_forces(c, b)) continue;
    mg_real *q = c->run->x + s->body_q[b], slope[7];
    const mg_real *from = c->step.settled + s->body_q[b];
    c->kernels->body_motion(mg_body_kind_of(c, b), from, mg_moving_velocities(c, b, mean), none, s->gravity,
                            s->parameters + s->body_parameters[b], slope, unused);
    for (int k = 0; k < c->kernels->body_kinds[mg_body_kind_of(c, b)].n_q; k++) q[k] = from[k] + left * slope[k];
  }
  for (int i = mg_next_row(c, -1); i < s->n_contact; i = mg_next_row(c, i))
    for (int k = 0; k < c->contacts.n_eta[i]; k++)
      mg_contact_eta(c, c->run->x, i)[k] =
          mg_contact_eta(c, c->step.settled, i)[k] + left * c->rows.eta_dot[s->contact_eta[i] + k];
  mg_normalise_quaternions(c, c->run->x);
}

/* Most change of the gap of a contact of a pair between the poses c->step.pose and the present ones: the gap of a
   critical point changes no faster than the shapes move, and a turn is longer than its chord. */
static mg_real mg_gap_change_bound(const mg_context *c, int pair) {
  return 2 * mg_pair_movement_bound(c, pair, c->step.pose) + c->settings->start_gap * c->system->length;
}

/* True if the contact placed last is at another critical point than that which had the gap `gap`: Newton's method leads
   there from near a fold. A gap that is no number is not one: it ends the run. */
static int mg_has_leapt(const mg_context *c, mg_real gap, mg_real change) {
  return fabs(c->search.placement[0] - gap) > change;
}

/* Converges eta of a contact, whose gap may change by `change`, from where the step has led it, else from where it
   began. Returns 0 if both fail, or lead to other critical points. */
static int mg_converge_contact(mg_context *c, int contact, mg_real change) {
  mg_real *eta = mg_contact_eta(c, c->run->x, contact), found[MG_MAX_ETA];
  const mg_real *before = mg_contact_eta(c, c->step.settled, contact);
  const mg_real gap = c->rows.d[contact];
  const int n = c->contacts.n_eta[contact];
  for (int k = 0; k < n; k++) found[k] = eta[k];
  int is_found = mg_newton_on_feature_pair(c, contact, found) >= 0 && !mg_has_leapt(c, gap, change);
  if (!is_found) {
    for (int k = 0; k < n; k++) found[k] = before[k];
    is_found =
        mg_converge_from_any_start(c, c->run->feature_pair[contact], found) >= 0 && !mg_has_leapt(c, gap, change);
  }
  for (int k = 0; k < n; k++) eta[k] = is_found ? found[k] : before[k];
  return is_found;
}

/* Marks a contact that is off its feature pair, and requests a search where it is held at the end of a line that may be
   nearer elsewhere. Needs its placement. */
static void mg_mark_feature_exit(mg_context *c, int contact) {
  const int feature_pair = c->run->feature_pair[contact];
  const mg_real *eta = mg_contact_eta(c, c->run->x, contact);
  MG_NEEDS_PLACEMENT(c, feature_pair, eta);
  if (!mg_may_leave_feature_pair(c, contact)) return;
  if (mg_is_off_feature_pair(c, contact, eta)) c->events.triggered[contact] = MG_LEAVES_FEATURE;
  else if (mg_least_line_end_condition(c, feature_pair, -1, eta) < -c->settings->feature_border)
    c->run->is_search_due[c->system->contact_pair[contact]] = 1;
}

/* True if the pose of a body is another than in c->step.pose. */
static int mg_has_body_moved(const mg_context *c, int body) {
  const mg_real *before = c->step.pose + 12 * body, *now = c->bodies.pose + 12 * body;
  for (int k = 0; k < 12; k++)
    if (before[k] != now[k]) return 1;
  return 0;
}

/* True if the bodies of a pair have moved since the poses c->step.pose. */
static int mg_has_pair_moved(const mg_context *c, int pair) {
  const int first = c->system->pair_feature_pair[pair];
  return mg_has_body_moved(c, mg_feature_body(c, first, 0)) || mg_has_body_moved(c, mg_feature_body(c, first, 1));
}

/* Converges eta of the contacts whose bodies have moved since the present poses, at which it is that of the state
   `before`, and stays so where they have not. */
static void mg_converge_moved_contacts(mg_context *c, mg_events *events, mg_real *before) {
  MG_NEEDS_WITH(c, MG_VALID_GAPS, MG_VALID_POSES);
  mg_copy_reals(c->step.pose, c->bodies.pose, 12 * c->system->n_body);
  mg_update_poses(c, c->run->t, c->run->x);
  mg_real change = 0;
  int is_moved = 0;
  for (int i = mg_next_row(c, -1), pair = -1; i < c->system->n_contact; i = mg_next_row(c, i)) {
    if (!mg_is_on_feature_pair(c, i)) continue;
    if (c->system->contact_pair[i] != pair) {
      pair = c->system->contact_pair[i], is_moved = mg_has_pair_moved(c, pair);
      if (is_moved) change = mg_gap_change_bound(c, pair);
    }
    if (!is_moved) {
      for (int k = 0; k < c->contacts.n_eta[i]; k++)
        mg_contact_eta(c, c->run->x, i)[k] = mg_contact_eta(c, before, i)[k];
      continue;
    }
    c->events.triggered[i] = 0;
    const int is_converged = mg_converge_contact(c, i, change);
    if (is_converged) c->rows.d[i] = c->search.placement[0], c->run->margin[i] = mg_contact_margin(c, i);
    if (is_converged && !mg_is_contact_at_fold(c, i)) mg_mark_feature_exit(c, i);
    else mg_release_contact(c, events, i);
  }
  MG_NOTE_WITH(c, MG_VALID_GAPS, MG_VALID_POSES);
}

MG_INTERNAL void mg_converge_all_contacts(mg_context *c, mg_events *events) {
  MG_NEEDS_WITH(c, MG_VALID_GAPS, MG_VALID_POSES);
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    c->events.triggered[i] = c->events.within_border[i] = 0;
  mg_converge_moved_contacts(c, events, c->step.settled);
}

/* Largest penetration or joint error. */
static mg_real mg_largest_violation(const mg_context *c) {
  mg_real worst = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (-c->rows.d[i] > worst) worst = -c->rows.d[i];
  for (int i = c->layout.joint_row_begin; i < c->layout.joint_row_end; i++)
    if (fabs(c->rows.d[i]) > worst) worst = fabs(c->rows.d[i]);
  return worst;
}

/* Adds the movement by a correction, from the poses c->step.pose, to that of the pairs since their last searches. */
static void mg_count_correction_as_movement(mg_context *c) {
  for (int pair = mg_next_pair(c, -1); pair < c->system->n_pair; pair = mg_next_pair(c, pair))
    c->run->moved_since_search[pair] += mg_pair_movement_bound(c, pair, c->step.pose);
}

/* Leaves of the n contacts in c->lcp.rows those that share their bodies, across other rows and joints, with one that
   penetrates too far, or with a joint that is too far off: a correction moves no others. Returns their number. */
static int mg_keep_violated_islands(mg_context *c, int n) {
  const mg_real allowed = c->settings->contact_gap * c->system->length;
  const int *rows = c->lcp.rows, all = mg_append_joint_rows(c, c->lcp.rows, n);
  int *is_violated = c->islands.head, kept = 0;
  mg_part_bodies(c);
  for (int b = 0; b < c->system->n_body; b++) is_violated[b] = 0;
  for (int r = 0; r < all; r++) mg_join_bodies(c, c->contacts.o[rows[r]], c->contacts.f[rows[r]]);
  for (int r = 0; r < all; r++) {
    const mg_real d = c->rows.d[rows[r]];
    if ((r < n ? -d : fabs(d)) > allowed) is_violated[mg_island_of_body(c, mg_moving_body(c, rows[r]))] = 1;
  }
  for (int r = 0; r < n; r++)
    if (is_violated[mg_island_of_body(c, mg_moving_body(c, rows[r]))]) c->lcp.rows[kept++] = rows[r];
  return kept;
}

/* Least movement in the metric of the kinetic energy that removes penetration and joint errors, to first order, and
   closes no gap of up to `reach`, by the rows of these contacts. It is found to what the first order is good for: the
   next correction removes the rest. Returns 0 if it fails, or would move a body too far. */
static int mg_correct_positions(mg_context *c, mg_real worst, mg_real reach) {
  mg_lcp_report report;
  int n = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (mg_is_on_feature_pair(c, i) && c->rows.d[i] <= reach) {
      if (n < c->system->closed_capacity) c->lcp.rows[n++] = i;
      else mg_report_exceeded(c->run, MG_CAPACITY_CLOSED);
    }
  n = mg_keep_violated_islands(c, n);
  for (int r = 0; r < n; r++) c->lcp.mask[r] = 1, mg_update_rows_of_contact(c, c->lcp.rows[r], c->run->x);
  const mg_real allowed = c->settings->contact_gap * c->system->length / MG_CORRECTED_TO,
                of_first_order = mg_max(allowed / worst, worst / c->system->length);
  if (mg_solve_step_lcp(c, n, c->rows.d, 0, mg_min(of_first_order, MG_COARSEST_CORRECTION), &report) != MG_LCP_SOLVED)
    return 0;
  for (int i = 0; i < 6 * c->system->n_body; i++) c->bodies.wrench[i] = 0;
  for (int r = 0; r < n + c->system->n_joint_row; r++)
    mg_add_row_response(c, c->lcp.rows[r], c->lcp.z[r], c->bodies.wrench);
  return mg_apply_pose_correction(c, worst);
}

MG_INTERNAL int mg_post_stabilise(mg_context *c, mg_events *events) {
  mg_real kinetic, before = 0, halved = MG_MAX, reach = 1;
  int moved = 0, slow_rounds = 0;
  MG_NEEDS_AT_RUN(c, MG_VALID_POSES);
  mg_update_joint_rows(c, c->run->t);
  for (int round = 0; round < MG_CORRECTIONS && slow_rounds < MG_SLOW_CORRECTIONS && c->settings->project; round++) {
    const mg_real worst = mg_largest_violation(c);
    if (!(worst > c->settings->contact_gap * c->system->length)) break;
    slow_rounds = worst < halved / 2 ? 0 : slow_rounds + 1;
    if (!slow_rounds) halved = worst;
    if (!moved) before = mg_energy(c, &kinetic);
    mg_copy_states(c, c->run->x, c->step.stage);
    if (!mg_correct_positions(c, worst, reach * worst)) break;
    moved++;
    mg_converge_moved_contacts(c, events, c->run->x);
    mg_update_joint_rows(c, c->run->t);
    mg_count_correction_as_movement(c);
    if (mg_largest_violation(c) < 2 * worst) continue;
    mg_copy_states(c, c->step.stage, c->run->x);
    mg_converge_moved_contacts(c, events, c->run->x);
    mg_update_joint_rows(c, c->run->t);
    if (reach > 1) break;
    reach = c->settings->correction_ratio; /* it has closed other gaps, as a stack that is lifted does */
  }
  const mg_real change = moved ? mg_energy(c, &kinetic) - before : 0;
  mg_report_correction(c->run, change);
  return moved;
}
