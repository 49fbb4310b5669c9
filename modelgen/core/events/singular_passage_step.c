/* Singular passage: the curvature of a closed contact vanishes, or two closed points of a pair merge. The
   velocity of the contact point is infinite there, and the force may be, but their integrals are finite:
   velocities change by impulses P along rows that change with the contact point,  u_1 = u_0 + tau (a_0 + a_1)/2 +
   M^-1 (J_0 + J_1)^T P/2,   J_1 u_1 = 0,   q_1 = q_0 + tau q_dot((u_0 + u_1)/2),  with the accelerations a of all
   other forces. J is linear in the point, so the error is of third order in its travel. Writes the state of the
   run, its contacts and the event list; energy errors stay in the diagnostics. */
#include "events/events.h"
#include "base/base.h"
#include "model/model.h"
#include "closest/closest.h"
#include "forces/forces.h"
#include "integrate/integrate.h"
#include "features/features.h"

enum {
  MG_PASSAGES_MAX = 400,  /* most passages in succession */
  MG_PASSAGE_ROUNDS = 6,  /* iterations of one passage */
  MG_PASSAGE_STEP_CUT = 4 /* factor by which a passage that fails is shortened */
};

/* Add a column M^-1 J^T, times an amount, to the values of the two bodies of a row. */
static void mg_add_body_impulse(const mg_context *c, int row, const mg_real *column, mg_real amount,
                                mg_real *per_body) {
  for (int k = 0; k < 12; k++) {
    const int body = k < 6 ? c->contacts.o[row] : c->contacts.f[row];
    if (mg_is_moved_by_forces(c, body)) per_body[6 * body + k % 6] += column[k] * amount;
  }
}

/* Column M^-1 J^T of a row with the friction of its slip. */
static void mg_impulse_column(const mg_context *c, int row, mg_real *column) {
  for (int k = 0; k < 12; k++) column[k] = c->rows.MJ[12 * row + k];
  if (!c->system->n_friction || row >= c->layout.support_begin) return;
  const int first = c->layout.friction_row_begin + c->system->contact_friction_row[row];
  for (int i = first; i < first + c->kernels->contact_kinds[c->contacts.kind[row]].rows - 1; i++)
    for (int k = 0; k < 12; k++)
      column[k] -= c->friction.force_ratio[i - c->layout.friction_row_begin] * c->rows.MJ[12 * i + k];
}

/* Power in W of the loads alone. */
static mg_real mg_load_power(const mg_context *c, const mg_real *slope) {
  mg_real power = slope[c->layout.work_state];
  if (c->layout.n_driven || c->layout.has_prescribed_joint) power -= mg_prescribed_motion_power(c);
  return c->system->n_friction ? power - mg_friction_power(c) : power;
}

/* Store what the passage starts from: columns, row velocities, accelerations without these forces, points, load
   power. Needs the rows at the run's state. */
static void mg_store_passage_start(mg_context *c) {
  MG_NEEDS_AT_RUN(c, MG_VALID_ROWS);
  mg_singular_passage *v = &c->events.passage;
  const int n = mg_list_held_rows(c);
  for (int k = 0; k < 6 * c->system->n_body; k++) v->free_twist[k] = c->bodies.acceleration[k];
  for (int r = 0; r < n; r++) {
    const int row = c->lcp.rows[r];
    mg_impulse_column(c, row, v->column + 12 * row);
    mg_add_body_impulse(c, row, v->column + 12 * row, -c->solution.force[row], v->free_twist);
  }
  for (int i = mg_next_row(c, -1); i < c->layout.friction_row_end; i = mg_next_row(c, i))
    v->rate[i] = c->contacts.is_inertial[i] ? mg_row_times(c, i, c->bodies.twist) : c->rows.d_dot[i];
  v->power = mg_load_power(c, c->step.slopes);
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) {
    if (!c->run->closed[i]) continue;
    mg_place_contact(c, i, mg_contact_eta(c, c->run->x, i), c->search.placement + 32);
    for (int k = 0; k < 3; k++) v->point[3 * i + k] = c->search.placement[11 + k];
  }
}

/* Move eta to the minimum that continues the contact after the passage; returns 0 where none is found at zero gap.
   Others may be left unseen; where searches of the pair have been given up, those that are not near. */
static int mg_find_point_after_passage(mg_context *c, int contact, mg_real *eta) {
  const mg_real touching = c->settings->contact_gap * c->system->length;
  const int n = c->contacts.n_eta[contact], feature_pair = c->run->feature_pair[contact];
  mg_real next[6], trial_eta[6] = {0};
  mg_minimum found;
  mg_minima kept = {0};
  const mg_search_limits limits = {touching, touching, MG_LEAST_EFFORT, MG_MAX};
  for (int k = 0; k < n; k++) trial_eta[k] = eta[k];
  if (!n) {
    mg_place_contact(c, contact, trial_eta, next);
    return mg_placement_uniqueness(c, contact) > c->settings->search_margin && fabs(c->search.placement[0]) <= touching;
  }
  if (mg_newton_on_feature_pair(c, contact, trial_eta) >= 0 && mg_accept_minimum(c, feature_pair, trial_eta, &found))
    mg_insert_minimum(c, &kept, &found);
  if (!kept.count || fabs(kept.list[0].d) > touching)
    mg_search_near_contact_point(c, contact, eta, c->settings->margin_refuse, &kept);
  const int is_searched = !(c->run->withheld_effort[c->system->contact_pair[contact]] > 0);
  if (is_searched && (!kept.count || fabs(kept.list[0].d) > touching))
    mg_find_minima_of_feature_pair(c, feature_pair, &limits, -MG_MAX, &kept);
  if (!kept.count || fabs(kept.list[0].d) > touching) return 0;
  for (int k = 0; k < n; k++) eta[k] = kept.list[0].eta[k];
  mg_place_contact(c, contact, eta, next);
  return 1;
}

/* Distance of two points. */
static mg_real mg_point_distance(const mg_real *a, const mg_real *b) {
  const mg_real way[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return sqrt(mg_dot3(way, way));
}

/* True if the point of this contact has moved to the place of another contact's instead of both meeting between
   them. */
static int mg_has_swapped_contact_points(const mg_context *c, int contact) {
  const mg_singular_passage *v = &c->events.passage;
  const mg_real *from = v->point + 3 * contact, *to = v->landing_point + 3 * contact;
  const mg_real one = c->settings->search_merge_distance * c->contacts.length[contact];
  for (int i = mg_pair_first_contact(c, c->system->contact_pair[contact]); i < contact; i++) {
    if (!c->run->closed[i] || mg_point_distance(v->landing_point + 3 * i, to) > one) continue;
    const mg_real *other = v->point + 3 * i, apart = (mg_real)0.75 * mg_point_distance(other, from);
    if (apart > one && (mg_point_distance(from, to) > apart || mg_point_distance(other, to) > apart)) return 1;
  }
  return 0;
}

/* Find the contact points of all closed contacts at the state x; returns the largest distance that they move,
   MG_MAX where one is not found. */
static mg_real mg_place_points_after_passage(mg_context *c, mg_real t, mg_real *x) {
  mg_real farthest = 0;
  mg_update_poses(c, t, x);
  c->events.passage.margin = MG_MAX;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    if (!c->run->closed[i]) continue;
    if (!mg_find_point_after_passage(c, i, mg_contact_eta(c, x, i))) return MG_MAX;
    for (int k = 0; k < 3; k++) c->events.passage.landing_point[3 * i + k] = c->search.placement[11 + k];
    const mg_real margin = mg_contact_margin(c, i);
    if (!(margin >= c->events.passage.margin)) c->events.passage.margin = margin;
    if (mg_has_swapped_contact_points(c, i)) return MG_MAX;
    const mg_real distance =
        mg_point_distance(c->events.passage.landing_point + 3 * i, c->events.passage.point + 3 * i);
    if (!(distance <= farthest)) farthest = distance;
  }
  return farthest;
}

/* Set the velocities of x from loads and impulses, and return the part that the change of the rows contributes.
   Needs the rows at x. */
static void mg_set_passage_velocities(mg_context *c, mg_real tau, mg_real *x, mg_real *row_change) {
  MG_NEEDS_AT(c, MG_VALID_ROWS, x);
  const mg_system *s = c->system;
  mg_singular_passage *v = &c->events.passage;
  const int n = mg_list_held_rows(c);
  mg_real column[12], *change = c->bodies.wrench;
  for (int k = 0; k < 6 * s->n_body; k++)
    change[k] = 0, v->impulse_work[k] = tau * (v->free_twist[k] + c->bodies.acceleration[k]) / 2;
  for (int r = 0; r < n; r++) {
    const int row = c->lcp.rows[r];
    mg_impulse_column(c, row, column);
    mg_add_body_impulse(c, row, column, -tau * c->solution.force[row] / 2, v->impulse_work);
    for (int k = 0; k < 12; k++) column[k] = (column[k] - v->column[12 * row + k]) / 2;
    mg_add_body_impulse(c, row, column, v->impulse[row], change);
    mg_add_body_impulse(c, row, v->column + 12 * row, v->impulse[row], v->impulse_work);
  }
  *row_change = 0;
  for (int b = 0; b < s->n_body; b++)
    for (int k = 0; k < c->kernels->body_kinds[mg_body_kind_of(c, b)].n_u; k++) {
      const int at = s->n_q + s->body_u[b] + k;
      const mg_real size = fabs(change[6 * b + k]) * (k < 3 ? s->time / s->length : s->time);
      if (!(size <= *row_change)) *row_change = size;
      x[at] = c->run->x[at] + v->impulse_work[6 * b + k] + change[6 * b + k];
      change[6 * b + k] = 0;
    }
}

/* Sets the rates that are left of the rows of armature: J (u+ - u-) and the impulse so far. */
static void mg_set_passage_armature_rates(mg_context *c) {
  for (int i = c->layout.joint_row_begin; i < c->layout.joint_row_end; i++)
    if (c->contacts.is_inertial[i])
      c->rows.d_dot[i] = mg_row_times(c, i, c->bodies.twist) - c->events.passage.rate[i] + c->events.passage.impulse[i];
}

/* Correct the impulses by those that remove the remaining row velocities at x. */
static void mg_update_passage_impulses(mg_context *c) {
  mg_set_passage_armature_rates(c);
  const int shared = c->run->forces_redundant;
  c->friction.couples_normal = c->system->n_friction > 0, c->run->forces_redundant = 0;
  const int n = mg_hold_rows(c, c->run->active, 1, c->rows.d_dot, c->solution.impulse);
  for (int r = 0; r < n; r++) c->events.passage.impulse[c->lcp.rows[r]] += c->solution.impulse[c->lcp.rows[r]];
  c->friction.couples_normal = 0, c->run->forces_redundant = shared;
}

/* Set the positions of x from the mean of the velocities at both ends. */
static void mg_move_by_mean_velocity(mg_context *c, mg_real tau, mg_real *x) {
  const mg_system *s = c->system;
  mg_real *slope = c->step.slopes + c->layout.n_states, *mean = c->step.stage;
  mg_copy_states(c, c->run->x, mean);
  for (int k = s->n_q; k < s->n_q + s->n_u; k++) mean[k] = (c->run->x[k] + x[k]) / 2;
  mg_update_poses(c, c->run->t, mean);
  mg_free_accelerations(c, c->run->t, mean, slope);
  for (int k = 0; k < s->n_q; k++) x[k] = c->run->x[k] + tau * slope[k];
  mg_normalise_quaternions(c, x);
}

/* Work in J of loads, slip and prescribed motions over the passage. */
static mg_real mg_passage_work(const mg_context *c, mg_real tau, mg_real power) {
  const mg_singular_passage *v = &c->events.passage;
  mg_real work = tau * (v->power + power) / 2;
  for (int i = mg_next_row(c, -1); i < c->layout.joint_row_end; i = mg_next_row(c, i)) {
    work -= v->impulse[i] * mg_prescribed_gap_rate(c, i);
    if (!c->system->n_friction || i >= c->layout.support_begin || !c->run->active[i]) continue;
    const int first = c->layout.friction_row_begin + c->system->contact_friction_row[i];
    for (int k = first; k < first + c->kernels->contact_kinds[c->contacts.kind[i]].rows - 1; k++)
      work -= c->friction.force_ratio[k - c->layout.friction_row_begin] * v->impulse[i] *
              (v->rate[k] + c->rows.d_dot[k]) / 2;
  }
  return work;
}

/* Take one implicit step of length tau across the singular place; returns the estimated relative error. */
static mg_real mg_try_passage_step(mg_context *c, mg_real tau) {
  const mg_system *s = c->system;
  const mg_real t = c->run->t + tau, part = tau / s->time;
  mg_real *x = c->step.end, distance = 0, row_change = 0;
  mg_copy_states(c, c->run->x, x);
  for (int i = mg_next_row(c, -1); i < c->layout.friction_row_end; i = mg_next_row(c, i))
    c->events.passage.impulse[i] = 0;
  for (int round = 0; round < MG_PASSAGE_ROUNDS; round++) {
    mg_move_by_mean_velocity(c, tau, x);
    distance = mg_place_points_after_passage(c, t, x);
    if (!(distance < MG_MAX)) return MG_MAX;
    mg_right_hand_side(c, t, x, c->step.slopes + c->layout.n_states);
    mg_update_gap_rates(c);
    mg_update_passage_impulses(c);
    mg_set_passage_velocities(c, tau, x, &row_change);
  }
  x[c->layout.work_state] =
      c->run->x[c->layout.work_state] + mg_passage_work(c, tau, mg_load_power(c, c->step.slopes + c->layout.n_states));
  return mg_are_states_finite(c, x) ? row_change * distance / s->length / 6 + part * part * part / 12 : MG_MAX;
}

/* Take the longest passage step up to stop_time whose estimated error is within the tolerance; returns its length in
   s, 0 if there is none. */
static mg_real mg_choose_passage_step(mg_context *c) {
  const mg_real least = c->settings->event_tolerance * c->system->time, left = c->step.stop_time - c->run->t;
  mg_store_passage_start(c);
  for (mg_real tau = mg_min(c->settings->passage_time_max * c->system->time, left); tau >= least;
       tau /= MG_PASSAGE_STEP_CUT) {
    if (mg_try_passage_step(c, tau) <= c->settings->tolerance) return tau;
    mg_update_poses(c, c->run->t, c->run->x);
  }
  return 0;
}

/* True if stop_time is reached within the resolution of time. */
static int mg_is_stop_reached(const mg_context *c) {
  return c->step.stop_time - c->run->t < c->settings->event_tolerance * c->system->time;
}

/* Set time and state of the run and evaluate them; returns 0 if an extremum is lost. */
static int mg_set_run_state(mg_context *c, mg_real t, const mg_real *x) {
  mg_copy_states(c, x, c->run->x);
  c->run->t = t;
  const int is_valid = mg_place_all_contacts(c, t, c->run->x);
  mg_evaluate_run_state(c);
  return is_valid;
}

/* Record the samples due during the passage: bodies extrapolated back, forces and points as after it. */
static void mg_record_passage(mg_context *c, mg_record *record) {
  while (mg_is_sample_due(record, c->run->t)) {
    const mg_real back = record->t[record->count] - c->run->t;
    mg_copy_states(c, c->run->x, c->step.stage);
    for (int k = 0; k < c->system->n_q; k++) c->step.stage[k] += back * c->step.slopes[k];
    mg_normalise_quaternions(c, c->step.stage);
    mg_update_poses(c, c->run->t + back, c->step.stage);
    mg_record_sample(c, record, c->step.stage);
    mg_evaluate_run_state(c);
  }
}

/* True if method and settings allow a singular passage and no contact starts from flat. */
static int mg_is_passage_allowed(const mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->run->rolling_start[i]) return 0;
  return c->settings->method == MG_DOP853 && c->settings->project && c->settings->use_gamma && c->settings->newton;
}

/* Integrate across the singular place of a closed contact until its margin is well regular, or up to stop_time, where
   the passage pauses while the contact is singular; returns 0, with the state restored, where that fails. */
static int mg_cross_singular_place(mg_context *c, mg_record *record) {
  mg_run *run = c->run;
  const mg_real t = run->t;
  mg_real tau = 0;
  int crossed = 0;
  c->events.passage.is_paused = mg_is_stop_reached(c);
  mg_copy_states(c, run->x, c->step.settled);
  for (int k = 0; k < MG_PASSAGES_MAX && !crossed && !c->events.passage.is_paused; k++) {
    tau = mg_choose_passage_step(c);
    if (!(tau > 0) || !mg_set_run_state(c, run->t + tau, c->step.end) || !mg_project_drift(c)) break;
    const int is_stopped = mg_is_stop_reached(c);
    crossed = c->events.passage.margin >= 2 * c->settings->margin_refuse ||
              (is_stopped && c->events.passage.margin >= c->settings->margin_refuse);
    mg_record_passage(c, record);
    c->events.passage.is_paused = !crossed && is_stopped;
  }
  if (c->events.passage.is_paused) {
    run->t = c->step.stop_time, run->t_roundoff = 0, run->is_passage_due = 1;
    return 1;
  }
  if (!crossed) mg_set_run_state(c, t, c->step.settled);
  else if (run->h < tau) run->h = tau;
  return crossed;
}

MG_INTERNAL int mg_cross_singular_contacts(mg_context *c, mg_record *record, mg_events *events) {
  int singular = 0;
  while (singular < c->system->n_contact && !mg_is_contact_singular(c, singular)) singular++;
  if (singular == c->system->n_contact || !mg_is_passage_allowed(c)) return MG_DONE;
  mg_clear_triggered_events(c);
  if (mg_cross_singular_place(c, record)) {
    if (c->events.passage.is_paused) return MG_DONE;
    mg_merge_contacts(c, events);
    if (mg_is_on_feature_pair(c, singular)) mg_split_contact(c, events, singular);
  } else if (!mg_replace_singular_contact(c, events, singular)) return MG_DONE;
  mg_report_passage(c->run, mg_told_contact(c->system, c->run, singular));
  mg_evaluate_run_state(c);
  return mg_change_mode(c, events);
}
