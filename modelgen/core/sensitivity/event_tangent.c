/* Derivatives over an event (saltation): its time from its event function, the change of the state, and the part of the
   step that the change of time takes from one right-hand side and gives to the other. Where neither state nor
   right-hand side jump, nothing happens to the derivatives. Writes the derivatives of the state and of event times. */
#include "sensitivity/sensitivity.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

MG_INTERNAL mg_real mg_bound_tangent(const mg_context *c, const mg_sensitivity *s, int direction, int contact,
                                     int constraint) {
  const int row = mg_first_friction_row(c, contact, constraint), rows = mg_friction_row_count(c, constraint);
  const mg_real *mu = c->system->friction_static + 2 * constraint;
  mg_real size = 0, change = 0;
  for (int k = 0; k < rows; k++) {
    const mg_real part = c->solution.force[row + k] / mu[k],
                  mu_dot = mg_number_dot(s, s->directions->friction_static, 2L * c->system->n_friction, direction,
                                         2 * constraint + k);
    size += part * part, change += part * (s->at.force[row + k] - part * mu_dot) / mu[k];
  }
  return s->at.force[contact] - (size > 0 ? change / sqrt(size) : 0);
}

/* Derivative of the slip of a constraint along its direction. */
static mg_real mg_slip_tangent(const mg_context *c, const mg_sensitivity *s, int contact, int constraint) {
  const int row = mg_first_friction_row(c, contact, constraint);
  const mg_real *direction = c->run->slip_direction + 3 * constraint, *t = c->rows.tangents + 6 * contact;
  if (mg_friction_row_count(c, constraint) == 1) return s->at.rate[row] * direction[0];
  return s->at.rate[row] * mg_dot3(t, direction) + s->at.rate[row + 1] * mg_dot3(t + 3, direction);
}

/* Value of the most violated condition of a contact where the poses of o and f (24) and eta are moved by `part` of
   their derivatives. */
static mg_real mg_moved_condition(mg_context *c, int contact, const mg_real *eta, const mg_real *pose_dot,
                                  const mg_real *eta_dot, mg_real part) {
  const int o = c->contacts.o[contact], f = c->contacts.f[contact];
  mg_real at[MG_MAX_ETA], next[MG_MAX_ETA], kept[24];
  int which;
  for (int k = 0; k < 12; k++) {
    kept[k] = c->bodies.pose[12 * o + k], kept[12 + k] = c->bodies.pose[12 * f + k];
    c->bodies.pose[12 * o + k] += part * pose_dot[k];
    c->bodies.pose[12 * f + k] += part * pose_dot[12 + k];
  }
  for (int k = 0; k < c->contacts.n_eta[contact]; k++) at[k] = eta[k] + part * eta_dot[k];
  mg_place_contact(c, contact, at, next);
  const mg_real value = mg_most_violated_condition(c, c->run->feature_pair[contact], at, &which);
  for (int k = 0; k < 12; k++) c->bodies.pose[12 * o + k] = kept[k], c->bodies.pose[12 * f + k] = kept[12 + k];
  return value;
}

/* Derivative of the condition that a contact violates, by differences of order 4. */
static mg_real mg_condition_difference(mg_context *c, int contact, const mg_real *eta, const mg_real *pose_dot,
                                       const mg_real *eta_dot) {
  mg_real largest = mg_max(mg_max_abs(24, pose_dot), mg_max_abs(c->contacts.n_eta[contact], eta_dot)), value[2];
  if (!(largest > 0)) return 0;
  const mg_real part = mg_pow(MG_EPS, (mg_real)0.2) / largest;
  for (int k = 0; k < 2; k++)
    value[k] = mg_moved_condition(c, contact, eta, pose_dot, eta_dot, (k + 1) * part) -
               mg_moved_condition(c, contact, eta, pose_dot, eta_dot, -(k + 1) * part);
  return (8 * value[0] - value[1]) / (12 * part);
}

static mg_real mg_border_tangent(mg_context *c, const mg_sensitivity *s, int contact, const mg_real *eta,
                                 const mg_real *eta_dot) {
  mg_real pose_dot[24];
  for (int k = 0; k < 12; k++)
    pose_dot[k] = s->at.pose[12 * c->contacts.o[contact] + k],
    pose_dot[12 + k] = s->at.pose[12 * c->contacts.f[contact] + k];
  return mg_condition_difference(c, contact, eta, pose_dot, eta_dot);
}

MG_INTERNAL void mg_border_adjoint(mg_context *c, mg_sensitivity *s, int contact, const mg_real *eta, mg_real weight,
                                   mg_real *eta_bar) {
  for (int i = 0; i < 24 + c->contacts.n_eta[contact]; i++) {
    mg_real pose_dot[24] = {0}, eta_dot[MG_MAX_ETA] = {0};
    if (i < 24) pose_dot[i] = 1;
    else eta_dot[i - 24] = 1;
    const mg_real bar = weight * mg_condition_difference(c, contact, eta, pose_dot, eta_dot);
    if (i >= 24) eta_bar[i - 24] += bar;
    else s->at.pose[12 * (i < 12 ? c->contacts.o : c->contacts.f)[contact] + i % 12] += bar;
  }
}

MG_INTERNAL void mg_differentiate_event(mg_context *c, mg_sensitivity *s, mg_crossing *crossing, mg_real t) {
  MG_NEEDS(c, MG_VALID_FORCES, t, c->step.end), MG_NEEDS_WITH(c, MG_VALID_WRENCHES, MG_VALID_FORCES);
  const int n = s->directions->n, states = c->layout.n_states, contact = crossing->contact;
  for (int j = 0; j <= n; j++) {
    s->event_rate[j] = 0;
    if (crossing->kind == MG_CROSSES_NOTHING) continue;
    s->is_time = j == n;
    const mg_real *dx = s->is_time ? s->slope_before : s->tangent->x + (long)j * states;
    mg_rhs_tangent(c, s, j, t, c->step.end, dx, s->stage);
    if (crossing->kind == MG_CROSSES_SWITCH) {
      s->event_rate[j] = mg_switch_tangent(c, s, j, t, contact, 0);
      continue;
    }
    const int eta = c->system->n_q + c->system->n_u + c->system->contact_eta[contact];
    const int slot = mg_slot_of_support(c, contact);
    if (crossing->kind == MG_CROSSES_GAP) s->event_rate[j] = s->at.value[contact];
    else if (crossing->kind == MG_CROSSES_SLIP && slot >= 0)
      s->event_rate[j] = mg_patch_slip_along_direction(c, slot, s->at.rate);
    else if (crossing->kind == MG_CROSSES_BOUND && slot >= 0) s->event_rate[j] = mg_patch_bound_tangent(c, s, j, slot);
    else if (crossing->kind == MG_CROSSES_SLIP) s->event_rate[j] = mg_slip_tangent(c, s, contact, crossing->constraint);
    else if (crossing->kind == MG_CROSSES_BOUND)
      s->event_rate[j] = mg_bound_tangent(c, s, j, contact, crossing->constraint);
    else if (crossing->kind == MG_CROSSES_FORCE) s->event_rate[j] = s->at.force[contact];
    else if (mg_is_on_feature_pair(c, contact))
      s->event_rate[j] = mg_border_tangent(c, s, contact, c->step.end + eta, dx + eta);
  }
  s->is_time = 0;
  MG_NOTE_EVENT(c, s, crossing->kind, contact, c->step.end);
}

MG_INTERNAL int mg_has_slope_jump(const mg_context *c, const mg_sensitivity *s, const mg_real *after) {
  const mg_system *system = c->system;
  for (int b = 0; b < system->n_body; b++) {
    const int first = system->n_q + system->body_u[b];
    if (!mg_is_moved_by_forces(c, b) || !mg_is_in_crossing(s, b)) continue;
    for (int i = first; i < first + c->kernels->body_kinds[mg_body_kind_of(c, b)].n_u; i++) {
      const mg_real size = fabs(s->slope_before[i]) + fabs(after[i]) + c->step.scale[i] / system->time;
      if (fabs(after[i] - s->slope_before[i]) > sqrt(c->settings->event_tolerance) * size) return 1;
    }
  }
  return 0;
}

MG_INTERNAL int mg_is_graze(const mg_context *c, const mg_crossing *crossing, mg_real rate) {
  if (crossing->kind != MG_CROSSES_GAP) return rate == 0;
  const mg_real e = c->system->restitution[crossing->contact], /* the last bounce of many is as slow as that */
      least = c->settings->rest_speed * c->system->length / c->system->time;
  return fabs(rate) < (e > 0 ? mg_min(e, (mg_real)1) : 1) * least;
}

/* Adds `factor` times the coordinates q and u of the bodies of the crossing that is looked at. */
static void mg_add_in_crossing(const mg_context *c, const mg_sensitivity *s, mg_real factor, const mg_real *from,
                               mg_real *to) {
  const mg_system *system = c->system;
  for (int b = 0; b < system->n_body; b++) {
    if (!mg_is_moved_by_forces(c, b) || !mg_is_in_crossing(s, b)) continue;
    const mg_body_kind *kind = c->kernels->body_kinds + mg_body_kind_of(c, b);
    const int q = system->body_q[b], u = system->n_q + system->body_u[b];
    for (int i = q; i < q + kind->n_q; i++) to[i] += factor * from[i];
    for (int i = u; i < u + kind->n_u; i++) to[i] += factor * from[i];
  }
}

/* Shifts q and u of all directions by the times of the event, times `sign` slope. */
static void mg_shift_by_event_times(const mg_context *c, mg_sensitivity *s, const mg_real *slope, mg_real sign) {
  for (int j = 0; j < s->directions->n; j++)
    mg_add_in_crossing(c, s, sign * mg_event_time_dot(s, j), slope, s->tangent->x + (long)j * c->layout.n_states);
}

MG_INTERNAL mg_real mg_rate_tangent_size(const mg_context *c, const mg_sensitivity *s, int row) {
  mg_real sum = 0;
  for (int k = 0; k < 6; k++)
    sum += fabs(c->rows.J[12 * row + k] * s->at.twist[6 * c->contacts.o[row] + k]) +
           fabs(c->rows.J[12 * row + 6 + k] * s->at.twist[6 * c->contacts.f[row] + k]);
  return sum;
}

/* What is left across its direction of changes of slip that ends at the event, of their size: 0 if it ends as well in
   changed runs. */
static mg_real mg_slip_left_across(mg_context *c, mg_sensitivity *s, const mg_crossing *crossing) {
  const int slot = mg_slot_of_support(c, crossing->contact),
            row = slot >= 0 ? mg_first_patch_friction_row(c, slot)
                            : mg_first_friction_row(c, crossing->contact, crossing->constraint);
  const mg_real spin = slot >= 0 ? mg_support_radius(c, slot) : 0; /* of a patch counts as slip at this distance */
  mg_real most = 0;
  if (slot < 0 && mg_friction_row_count(c, crossing->constraint) < 2) return 0;
  for (int j = 0; j < s->directions->n; j++) {
    mg_rhs_tangent(c, s, j, c->run->t, c->run->x, s->tangent->x + (long)j * c->layout.n_states, s->stage);
    const mg_real turn = slot >= 0 ? spin * s->at.rate[row + 2] : 0,
                  left = sqrt(mg_dot2(s->at.rate + row, s->at.rate + row) + turn * turn),
                  size = mg_rate_tangent_size(c, s, row) + mg_rate_tangent_size(c, s, row + 1) +
                         (slot >= 0 ? spin * mg_rate_tangent_size(c, s, row + 2) : 0);
    if (left > 0) most = mg_max(most, left / (fabs(s->event_rate[j]) + size));
  }
  return most;
}

MG_INTERNAL mg_real mg_gap_tangent_size(const mg_context *c, const mg_sensitivity *s, int contact) {
  mg_real sum = 0;
  for (int side = 0; side < 2; side++) {
    const mg_real *dot = s->at.pose + 12 * (side ? c->contacts.f : c->contacts.o)[contact];
    sum += mg_max_abs(3, dot) + c->system->length * mg_max_abs(9, dot + 3);
  }
  return sum;
}

/* True if a gap that closes hardly at all is zero, and stays so, in every changed run as well, so that its event takes
   place in each of them at the same time: other rows hold it, as those of the tooth of a gear before. Needs the times
   of the event. */
static int mg_is_gap_held_already(mg_context *c, mg_sensitivity *s, int contact) {
  MG_NEEDS_EVENT(c, s, MG_CROSSES_GAP, contact, s->before);
  const mg_real part = sqrt(c->settings->event_tolerance);
  mg_gather_wrenches(c, s, c->run->t);
  for (int j = 0; j < s->directions->n; j++) {
    mg_rhs_tangent(c, s, j, c->run->t, c->run->x, s->tangent->x + (long)j * c->layout.n_states, s->stage);
    const mg_real rounding = MG_ROUNDED_TANGENT * s->size[j] * c->system->length;
    if (fabs(s->event_rate[j]) > part * mg_gap_tangent_size(c, s, contact) + rounding) return 0;
    if (fabs(s->at.rate[contact]) > part * mg_rate_tangent_size(c, s, contact) + rounding / c->system->time) return 0;
  }
  return 1;
}

/* Notes the derivatives of the time of an event. */
static void mg_note_event(const mg_context *c, mg_sensitivity *s, const mg_crossing *crossing) {
  mg_tangent *tangent = s->tangent;
  const int n = s->directions->n, k = tangent->count++;
  if (k >= tangent->capacity) return;
  tangent->event_t[k] = c->run->t,
  tangent->event_contact[k] = crossing->kind == MG_CROSSES_SWITCH ? -1 : crossing->contact;
  for (int j = 0; j < n; j++)
    tangent->event_t_dot[(long)k * n + j] = tangent->is_lost ? (mg_real)NAN : mg_event_time_dot(s, j);
}

MG_INTERNAL int mg_cross_event(mg_context *c, mg_sensitivity *s, const mg_crossing *crossing) {
  const int n = s->directions->n, knows_time = crossing->kind != MG_CROSSES_NOTHING && s->event_rate[n] != 0;
  mg_real *after = c->step.slopes;
  mg_evaluate_run_state(c);
  if (knows_time) mg_note_event(c, s, crossing);
  if (!crossing->blow && !mg_has_slope_jump(c, s, after)) {
    mg_settle_eta_tangents(c, s, c->run->t, c->run->x);
    return MG_NO_REASON;
  }
  s->is_lost = crossing->blow && !knows_time;
  if (!knows_time) return mg_has_closed_support(c, s) ? MG_BY_FACES : MG_BY_JUMP;
  if (mg_is_graze(c, crossing, s->event_rate[n])) {
    if (crossing->kind != MG_CROSSES_GAP || !mg_is_gap_held_already(c, s, crossing->contact)) return MG_BY_GRAZE;
    mg_settle_eta_tangents(c, s, c->run->t, c->run->x);
    return MG_NO_REASON;
  }
  int reason = crossing->reason;
  if (!reason && crossing->kind == MG_CROSSES_BORDER && mg_has_moving_border(s)) reason = MG_BY_BORDER;
  mg_shift_by_event_times(c, s, s->slope_before, 1);
  s->is_at_event = 1;
  mg_settle_eta_tangents(c, s, c->run->t, c->run->x);
  if (crossing->blow) {
    const int unsolved = mg_recover_impulses(c, s, 1);
    for (int j = 0; j < n && !unsolved; j++) mg_blow_tangent(c, s, j, s->tangent->x + (long)j * c->layout.n_states);
    if (!reason) reason = unsolved;
    s->is_lost = unsolved != 0;
    mg_evaluate_run_state(c);
  } else if (crossing->kind == MG_CROSSES_SLIP) {
    mg_gather_wrenches(c, s, c->run->t);
    const mg_real left = mg_slip_left_across(c, s, crossing);
    if (left > s->slip_left) s->slip_left = left, s->slip_left_constraint = crossing->constraint;
    if (left > sqrt(c->settings->slip_speed) && !reason) reason = MG_BY_SLIP_STOP;
  } else if (crossing->kind == MG_CROSSES_FORCE && !reason) reason = MG_BY_JUMP;
  s->is_at_event = 0;
  mg_shift_by_event_times(c, s, after, -1);
  mg_settle_eta_tangents(c, s, c->run->t, c->run->x);
  return reason;
}
