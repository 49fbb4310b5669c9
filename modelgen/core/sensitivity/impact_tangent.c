/* Derivative of a blow: the impulses L of the rows that take part satisfy
     M (u+ - u-) = J^T L,   J u+ + e J u- = 0   for rows that are struck, stick, or are held by joints,
     J u+ - J u- + L_k = 0                      for armature: struck with e = -1, and its diagonal yields,
     L_k + ratio_k(J u+) L_N = 0                for slip, with the force ratios of slip,
   and are differentiated with these equations. Which rows take part, and how, is read off the solved blow. Reads the
   run after it and s->before; writes velocities of the derivatives. */
#include "sensitivity/sensitivity.h"
#include "model/model.h"
#include "forces/forces.h"
#include "impact/impact.h"

/* True if a contact may have been struck: it is that of the event, was closed before, or is closed or touching now as
   far as the error of the step can tell; and it has not been found to carry no impulse (c->events.gap_dips). */
static int mg_may_be_struck(const mg_context *c, const mg_sensitivity *s, int contact) {
  const mg_real touching = mg_max(c->settings->contact_gap, c->settings->tolerance) * c->system->length;
  if (!mg_is_on_feature_pair(c, contact) || c->events.gap_dips[contact] || !mg_is_row_in_crossing(c, s, contact))
    return 0;
  return contact == s->crossing.contact || s->closed_before[contact] || c->run->closed[contact] ||
         fabs(c->rows.d[contact]) <= touching;
}

/* Lists the rows of contacts that may be struck, if any are, then joints; 0 where there are too many. */
static int mg_list_blow_rows(mg_context *c, mg_sensitivity *s, int of_contacts, mg_blow *b) {
  b->n = 0;
  for (int i = mg_next_row(c, -1); of_contacts && i < c->layout.support_begin; i = mg_next_row(c, i)) {
    if (!mg_may_be_struck(c, s, i)) continue;
    if (b->n >= MG_BLOW_ROWS - MG_ROWS_OF_ONE) return 0;
    const int normal = b->n;
    b->row[b->n] = i, b->normal[b->n] = normal, b->constraint[b->n++] = -1;
    for (int g = c->system->contact_friction[i]; c->system->n_friction && g < c->system->contact_friction[i + 1]; g++)
      for (int k = 0; k < mg_friction_row_count(c, g); k++)
        b->row[b->n] = mg_first_friction_row(c, i, g) + k, b->normal[b->n] = normal, b->constraint[b->n++] = g;
  }
  for (int i = c->layout.joint_row_begin; i < c->layout.joint_row_end; i++) {
    if (!mg_is_row_in_crossing(c, s, i)) continue;
    if (b->n >= MG_BLOW_ROWS) return 0;
    b->row[b->n] = i, b->normal[b->n] = -1, b->constraint[b->n++] = -1;
  }
  return 1;
}

/* Velocities of the listed rows before and after the blow, and which of their friction slips after it. Needs the twists
   before; `change` is that of the twists. */
static void mg_find_blow_rates(const mg_context *c, mg_blow *b, const mg_real *change) {
  MG_NEEDS_ANY(c, MG_VALID_TWISTS), MG_NEEDS_ANY(c, MG_VALID_ROWS);
  for (int r = 0; r < b->n; r++) {
    b->rate_before[r] = mg_row_times(c, b->row[r], c->bodies.twist);
    b->rate_after[r] = b->rate_before[r] + mg_row_times(c, b->row[r], change);
    b->role[r] = b->constraint[r] >= 0 && fabs(b->rate_after[r]) > 2 * mg_slip_velocity_tolerance(c, b->constraint[r])
                     ? MG_BLOW_SLIPS
                     : MG_BLOW_HELD;
  }
  for (int r = 0; r + 1 < b->n; r++) /* both rows of a constraint slip if one does */
    if (b->constraint[r] >= 0 && b->constraint[r] == b->constraint[r + 1] &&
        (b->role[r] == MG_BLOW_SLIPS || b->role[r + 1] == MG_BLOW_SLIPS))
      b->role[r] = b->role[r + 1] = MG_BLOW_SLIPS;
}

/* Keeps of the listed rows those that `keep` marks. */
static void mg_keep_blow_rows(mg_blow *b, const int *keep) {
  int place[MG_BLOW_ROWS], n = 0;
  for (int r = 0; r < b->n; r++) {
    place[r] = n;
    if (!keep[r]) continue;
    b->row[n] = b->row[r], b->constraint[n] = b->constraint[r], b->role[n] = b->role[r];
    b->rate_before[n] = b->rate_before[r], b->rate_after[n] = b->rate_after[r];
    b->normal[n] = b->normal[r] < 0 ? -1 : place[b->normal[r]];
    n++;
  }
  b->n = n;
}

/* Scaled matrix J M^-1 J^T of the listed rows; 0 where a row moves nothing. */
static int mg_scale_blow_matrix(mg_context *c, mg_blow *b) {
  const int n = b->n;
  mg_assemble_delassus(c, b->row, n);
  for (int r = 0; r < n; r++) {
    b->scale[r] = sqrt(c->lcp.A[r + (long)n * r]);
    if (!(b->scale[r] > 0)) return 0;
  }
  for (int r = 0; r < n; r++)
    for (int k = 0; k < n; k++) b->matrix[r + n * k] = c->lcp.A[r + (long)n * k] / (b->scale[r] * b->scale[k]);
  return 1;
}

MG_INTERNAL mg_real mg_blow_force_ratio(const mg_context *c, const mg_blow *b, int r, mg_real *by_rate,
                                        mg_real *by_mu) {
  const int g = b->constraint[r], first = r > 0 && b->constraint[r - 1] == g ? r - 1 : r, k = r - first,
            rows = mg_friction_row_count(c, g);
  const mg_real *mu = c->system->friction_kinetic + 2 * g;
  mg_real v[2] = {0, 0}, n = 0;
  for (int l = 0; l < rows; l++) v[l] = mu[l] * b->rate_after[first + l], n += v[l] * v[l];
  n = sqrt(n);
  for (int l = 0; l < 2; l++) {
    const mg_real projected = l < rows ? ((l == k) - v[k] * v[l] / (n * n)) / n : 0; /* d(v_k / n) / dv_l */
    by_rate[l] = mu[k] * projected * mu[l], by_mu[l] = l < rows ? mu[k] * projected * b->rate_after[first + l] : 0;
  }
  by_mu[k] += v[k] / n;
  return mu[k] * v[k] / n;
}

/* Order in which rows are taken as independent: normal rows, joints, friction that sticks. The impulses of slip follow
   from a law, whether or not its rows depend on others: -1. */
static int mg_blow_row_order(const mg_blow *b, int r) {
  if (b->role[r] == MG_BLOW_SLIPS) return -1;
  return b->normal[r] == r ? 0 : b->constraint[r] < 0 ? 1 : 2;
}

/* Drops held rows that depend on others: they hold because those do, and any part of the impulse may be theirs. 0 where
   a normal row depends on others. */
static int mg_drop_dependent_rows(mg_context *c, mg_blow *b) {
  int keep[MG_BLOW_ROWS], done[MG_BLOW_ROWS];
  const int n = b->n;
  if (!mg_scale_blow_matrix(c, b)) return 0;
  for (int r = 0; r < n; r++) keep[r] = done[r] = mg_blow_row_order(b, r) < 0;
  for (int order = 0; order < 3; order++)
    for (int r = 0; r < n; r++) {
      if (mg_blow_row_order(b, r) != order) continue;
      const mg_real pivot = b->matrix[r + n * r];
      keep[r] = pivot > sqrt(MG_EPS), done[r] = 1;
      if (!keep[r] && order == 0) return 0;
      for (int i = 0; i < n && keep[r]; i++)
        for (int k = 0; k < n && !done[i]; k++)
          if (!done[k]) b->matrix[i + n * k] -= b->matrix[i + n * r] * b->matrix[r + n * k] / pivot;
    }
  mg_keep_blow_rows(b, keep);
  return 1;
}

/* J (u+ - u-) of a row, less what it yields: what the impulses of the listed rows make of it. */
static mg_real mg_blow_rate_change(const mg_context *c, const mg_blow *b, int r) {
  return c->contacts.is_inertial[b->row[r]] ? 0 : b->rate_after[r] - b->rate_before[r];
}

/* Entry of J M^-1 J^T over two listed rows; of a normal row as second with the friction of slip that its impulse
   brings. */
static mg_real mg_blow_matrix_entry(const mg_context *c, const mg_blow *b, int r, int k) {
  mg_real by_rate[2], by_mu[2], entry = c->lcp.A[r + (long)b->n * k];
  for (int slip = k + 1; b->normal[k] == k && slip < b->n && b->normal[slip] == k; slip++)
    if (b->role[slip] == MG_BLOW_SLIPS)
      entry -= mg_blow_force_ratio(c, b, slip, by_rate, by_mu) * c->lcp.A[r + (long)b->n * slip];
  return entry;
}

/* Solves J M^-1 J^T L = J (u+ - u-) with the impulses of slip in the ratios of Coulomb's law at the velocities after
   the blow. Returns a reason, where L is not unique or slip does not follow that law, or 0. */
static int mg_solve_blow_impulses(mg_context *c, mg_blow *b) {
  mg_real by_rate[2], by_mu[2], largest = 0, residual = 0;
  int solved[MG_BLOW_ROWS], m = 0;
  mg_assemble_delassus(c, b->row, b->n);
  for (int r = 0; r < b->n; r++) {
    b->scale[r] = sqrt(c->lcp.A[r + (long)b->n * r]);
    if (b->role[r] != MG_BLOW_SLIPS) solved[m++] = r;
  }
  for (int i = 0; i < m; i++)
    for (int k = 0; k < m; k++)
      b->matrix[i + m * k] =
          mg_blow_matrix_entry(c, b, solved[i], solved[k]) / (b->scale[solved[i]] * b->scale[solved[k]]);
  if (!(mg_lu(m, b->matrix, b->pivots) > 0)) return MG_BY_REDUNDANT_ROWS;
  for (int i = 0; i < m; i++) b->change[i] = mg_blow_rate_change(c, b, solved[i]) / b->scale[solved[i]];
  mg_lu_solve(m, b->matrix, b->pivots, b->change);
  for (int i = 0; i < m; i++) b->impulse[solved[i]] = b->change[i] / b->scale[solved[i]];
  for (int r = 0; r < b->n; r++)
    if (b->role[r] == MG_BLOW_SLIPS)
      b->impulse[r] = -mg_blow_force_ratio(c, b, r, by_rate, by_mu) * b->impulse[b->normal[r]];
  for (int r = 0; r < b->n; r++) {
    mg_real change = 0;
    for (int k = 0; k < b->n; k++) change += c->lcp.A[r + (long)b->n * k] * b->impulse[k];
    residual = mg_max(residual, fabs(change - mg_blow_rate_change(c, b, r)) / b->scale[r]);
    largest = mg_max(largest, fabs(change) / b->scale[r]);
  }
  return residual > c->settings->derivative_impact_residual * largest ? MG_BY_IMPACT_LAW : MG_NO_REASON;
}

/* True if the impulses make the change of the velocities, but for the drift that is projected away with it. */
static int mg_explains_change(mg_context *c, mg_sensitivity *s, const mg_blow *b, const mg_real *change) {
  const mg_real part = 10 * sqrt(c->settings->tolerance);
  mg_zero_reals(s->at.acceleration, 6L * c->system->n_body);
  for (int r = 0; r < b->n; r++) mg_add_row_response(c, b->row[r], b->impulse[r], s->at.acceleration);
  for (int body = 0; body < c->system->n_body; body++)
    for (int k = 0; k < 6 && mg_is_moved_by_forces(c, body) && mg_is_in_crossing(s, body); k++) {
      const int i = 6 * body + k;
      const mg_real size = fabs(change[i]) + fabs(s->at.acceleration[i]),
                    least = c->system->length / c->system->time / (k < 3 ? 1 : c->system->length);
      if (fabs(change[i] - s->at.acceleration[i]) > part * (size + least)) return 0;
    }
  return 1;
}

/* Marks contacts without an impulse in c->events.gap_dips; returns whether there were any. */
static int mg_mark_unstruck_contacts(mg_context *c, const mg_blow *b) {
  int found = 0;
  mg_real largest = 0;
  for (int r = 0; r < b->n; r++)
    if (b->normal[r] == r) largest = mg_max(largest, b->impulse[r]);
  for (int r = 0; r < b->n; r++)
    if (b->normal[r] == r && !(b->impulse[r] > sqrt(c->settings->event_tolerance) * largest))
      c->events.gap_dips[b->row[r]] = 1, found = 1;
  return found;
}

/* True if slip along a path of impulses decides the blow of a listed contact. */
static int mg_follows_impulse_path(const mg_context *c, const mg_blow *b) {
  int by_path = c->settings->sequential, slips = 0;
  for (int r = 0; r < b->n; r++)
    by_path |= b->normal[r] == r && c->system->impact_law[b->row[r]] != MG_NEWTON, slips |= b->role[r] == MG_BLOW_SLIPS;
  return by_path && slips;
}

/* Finds how each normal row takes part. Returns a reason or 0. */
static int mg_classify_normal_rows(const mg_context *c, mg_blow *b) {
  for (int r = 0; r < b->n; r++) {
    const mg_real before = b->rate_before[r], after = b->rate_after[r];
    const mg_real noise = sqrt(c->settings->event_tolerance) * (fabs(before) + fabs(after)) +
                          c->settings->drift_tolerance * c->system->length / c->system->time;
    b->restitution[r] = 0;
    if (c->contacts.is_inertial[b->row[r]]) b->role[r] = MG_BLOW_STRUCK, b->restitution[r] = -1;
    if (b->normal[r] != r || fabs(after) <= noise) continue;
    const mg_real e = c->system->restitution[b->row[r]];
    if (fabs(after + e * before) > noise) return MG_BY_IMPACT_LAW;
    b->role[r] = MG_BLOW_STRUCK, b->restitution[r] = e;
  }
  return MG_NO_REASON;
}

/* Factorises the equations of the derivatives of the impulses; 0 where they are singular. */
static int mg_factor_blow(mg_context *c, mg_blow *b) {
  const int n = b->n;
  mg_real by_rate[2], by_mu[2];
  if (!mg_scale_blow_matrix(c, b)) return 0;
  for (int r = 0; r < n; r++) {
    if (b->role[r] != MG_BLOW_SLIPS) continue;
    const int normal = b->normal[r], first = r > 0 && b->constraint[r - 1] == b->constraint[r] ? r - 1 : r;
    const mg_real ratio = mg_blow_force_ratio(c, b, r, by_rate, by_mu);
    for (int k = 0; k < n; k++) {
      mg_real entry = (k == r) + (k == normal ? ratio : 0);
      for (int l = 0; l < mg_friction_row_count(c, b->constraint[r]); l++)
        entry += b->impulse[normal] * by_rate[l] * c->lcp.A[first + l + (long)n * k];
      b->matrix[r + n * k] = entry * b->scale[r] / b->scale[k];
    }
  }
  return mg_lu(n, b->matrix, b->pivots) > 0;
}

MG_INTERNAL int mg_has_closed_support(const mg_context *c, const mg_sensitivity *s) {
  for (int i = c->layout.support_begin; i < c->system->n_contact; i++)
    if ((c->run->closed[i] || s->closed_before[i]) && mg_is_row_in_crossing(c, s, i)) return 1;
  return 0;
}

MG_INTERNAL int mg_recover_impulses(mg_context *c, mg_sensitivity *s, int of_contacts) {
  mg_blow *b = s->blow;
  const int n_twist = 6 * c->system->n_body;
  if (of_contacts && mg_has_closed_support(c, s)) return MG_BY_FACES;
  mg_update_gap_rates(c);
  mg_real *change = s->at.twist;
  for (int i = 0; i < n_twist; i++) change[i] = c->bodies.twist[i];
  mg_update_poses(c, c->run->t, s->before);
  for (int i = 0; i < n_twist; i++) change[i] -= c->bodies.twist[i];
  for (int i = 0; i < c->system->n_contact; i++) c->events.gap_dips[i] = 0;
  int reason;
  do {
    if (!mg_list_blow_rows(c, s, of_contacts, b)) return MG_BY_REDUNDANT_ROWS;
    mg_find_blow_rates(c, b, change);
    reason = mg_drop_dependent_rows(c, b) ? mg_solve_blow_impulses(c, b) : MG_BY_REDUNDANT_ROWS;
  } while (!reason && mg_mark_unstruck_contacts(c, b));
  if (!reason && !mg_explains_change(c, s, b, change)) reason = MG_BY_JUMP;
  mg_update_poses(c, c->run->t, c->run->x);
  if (!reason) reason = mg_classify_normal_rows(c, b);
  if (reason) return reason;
  if (mg_follows_impulse_path(c, b)) return MG_BY_IMPACT_LAW;
  return mg_factor_blow(c, b) ? MG_NO_REASON : MG_BY_REDUNDANT_ROWS;
}

MG_INTERNAL void mg_impulses_of(const mg_blow *b, int first_row, int below, int rows, mg_real *impulse) {
  for (int k = 0; k < MG_ROWS_OF_ONE; k++) impulse[k] = 0;
  for (int r = 0; r < b->n; r++) {
    if (b->row[r] == first_row) impulse[0] = b->impulse[r];
    if (b->row[r] >= below && b->row[r] < below + rows - 1) impulse[b->row[r] - below + 1] = b->impulse[r];
  }
}

/* Derivatives of the rates of the rows of one contact with the twists of the context, of which those of the direction
   are s->at.twist; of a blow also of J^T L. */
static void mg_blow_contact_tangent(mg_context *c, mg_sensitivity *s, int direction, int contact, const mg_real *dx,
                                    mg_real *rate) {
  const mg_blow *b = s->blow;
  const int eta = c->system->n_q + c->system->n_u + c->system->contact_eta[contact],
            below =
                c->layout.friction_row_begin + (c->system->n_friction ? c->system->contact_friction_row[contact] : 0);
  mg_real impulse[MG_ROWS_OF_ONE];
  mg_impulses_of(b, contact, below, c->kernels->contact_kinds[c->contacts.kind[contact]].rows, impulse);
  mg_contact_tangent(c, s, direction, contact, c->run->x + eta, dx + eta, impulse, 0);
  for (int r = 0; r < b->n; r++) {
    if (b->row[r] == contact) rate[r] = s->y_dot[MG_Y_RATE];
    if (b->normal[r] >= 0 && b->row[b->normal[r]] == contact && b->normal[r] != r)
      rate[r] = s->y_dot[MG_Y_RATE + 1 + b->row[r] - below];
  }
}

static void mg_blow_joint_tangent(mg_context *c, mg_sensitivity *s, int direction, int joint, mg_real *rate) {
  const mg_blow *b = s->blow;
  const int first = c->layout.joint_row_begin + c->system->joint_row[joint],
            rows = c->kernels->joint_kinds[c->system->joint_kind[joint]].n_rows;
  mg_real impulse[MG_ROWS_OF_ONE];
  mg_impulses_of(b, first, first + 1, rows, impulse);
  mg_joint_tangent(c, s, direction, joint, c->run->t, impulse, 0);
  for (int r = 0; r < b->n; r++)
    if (b->row[r] >= first && b->row[r] < first + rows) rate[r] = s->y_dot[MG_Y_RATE + b->row[r] - first];
}

/* Adds to the wrenches of two bodies the derivative of J^T L. */
static void mg_add_blow_wrench(mg_sensitivity *s, int first, int second) {
  for (int k = 0; k < 6; k++)
    s->at.wrench[6 * first + k] += s->y_dot[MG_Y_FIRST + k], s->at.wrench[6 * second + k] += s->y_dot[MG_Y_SECOND + k];
}

/* Derivatives of the rates of all listed rows with the twists of the context; `adds_wrench`: and of J^T L. */
static void mg_blow_rates_tangent(mg_context *c, mg_sensitivity *s, int direction, const mg_real *dx, int adds_wrench,
                                  mg_real *rate) {
  const mg_blow *b = s->blow;
  for (int r = 0; r < b->n; r++) {
    if (b->normal[r] != r) continue;
    const int contact = b->row[r];
    mg_blow_contact_tangent(c, s, direction, contact, dx, rate);
    if (adds_wrench) mg_add_blow_wrench(s, c->contacts.o[contact], c->contacts.f[contact]);
  }
  for (int j = 0; j < c->system->n_joint; j++) {
    if (!c->kernels->joint_kinds[c->system->joint_kind[j]].n_rows) continue;
    mg_blow_joint_tangent(c, s, direction, j, rate);
    if (adds_wrench) mg_add_blow_wrench(s, c->system->joint_a[j], c->system->joint_b[j]);
  }
}

MG_INTERNAL void mg_gather_impulses(const mg_context *c, mg_sensitivity *s) {
  const mg_blow *b = s->blow;
  mg_zero_reals(s->wrench, 6L * c->system->n_body);
  for (int r = 0; r < b->n; r++)
    for (int k = 0; k < 6; k++)
      s->wrench[6 * c->contacts.o[b->row[r]] + k] += b->impulse[r] * c->rows.J[12 * b->row[r] + k],
          s->wrench[6 * c->contacts.f[b->row[r]] + k] += b->impulse[r] * c->rows.J[12 * b->row[r] + 6 + k];
}

/* Derivative of u+ at fixed L, into s->at.acceleration: du- + d(M^-1 J^T L). */
static void mg_blow_velocities_tangent(mg_context *c, mg_sensitivity *s, int direction, const mg_real *dx) {
  const mg_system *system = c->system;
  mg_gather_impulses(c, s);
  for (int body = 0; body < system->n_body; body++) {
    if (!mg_is_moved_by_forces(c, body)) continue;
    mg_motion_tangent(c, s, direction, body, c->run->x + system->body_q[body], 0, s->wrench + 6 * body, 0, 0, 0,
                      s->at.wrench + 6 * body);
    for (int k = 0; k < c->kernels->body_kinds[mg_body_kind_of(c, body)].n_u; k++)
      s->at.acceleration[6 * body + k] = dx[system->n_q + system->body_u[body] + k] + s->y_dot[7 + k];
  }
}

/* Right-hand sides of the derivatives of the impulses, in b->change. */
static void mg_set_blow_right_hand_sides(const mg_context *c, mg_sensitivity *s, int direction) {
  mg_blow *b = s->blow;
  mg_real by_rate[2], by_mu[2];
  for (int r = 0; r < b->n; r++) {
    const int g = b->constraint[r], first = r > 0 && g >= 0 && b->constraint[r - 1] == g ? r - 1 : r;
    if (b->role[r] == MG_BLOW_STRUCK)
      b->change[r] = -(b->rate_after_dot[r] + b->restitution[r] * b->rate_before_dot[r]) / b->scale[r];
    if (b->role[r] == MG_BLOW_STRUCK && b->normal[r] == r)
      b->change[r] -= mg_number_dot(s, s->directions->restitution, c->system->n_contact, direction, b->row[r]) *
                      b->rate_before[r] / b->scale[r];
    if (b->role[r] == MG_BLOW_HELD) b->change[r] = -b->rate_after_dot[r] / b->scale[r];
    if (b->role[r] != MG_BLOW_SLIPS) continue;
    mg_blow_force_ratio(c, b, r, by_rate, by_mu);
    b->change[r] = 0;
    for (int l = 0; l < mg_friction_row_count(c, g); l++)
      b->change[r] -= b->impulse[b->normal[r]] * b->scale[r] *
                      (by_rate[l] * b->rate_after_dot[first + l] +
                       by_mu[l] * mg_number_dot(s, s->directions->friction_kinetic, 2L * c->system->n_friction,
                                                direction, 2 * g + l));
  }
}

MG_INTERNAL void mg_blow_tangent(mg_context *c, mg_sensitivity *s, int direction, mg_real *dx) {
  const mg_system *system = c->system;
  mg_blow *b = s->blow;
  mg_zero_reals(s->at.wrench, 6L * system->n_body);
  mg_place_bodies_tangent(c, s, direction, c->run->t, c->run->x, dx);
  mg_update_poses(c, c->run->t, s->before);
  mg_blow_rates_tangent(c, s, direction, dx, 0, b->rate_before_dot);
  mg_update_poses(c, c->run->t, c->run->x);
  for (int body = 0; body < system->n_body; body++)
    if (mg_is_moved_by_forces(c, body)) mg_zero_reals(s->at.twist + 6 * body, 6);
  mg_blow_rates_tangent(c, s, direction, dx, 1, b->rate_after_dot);
  mg_blow_velocities_tangent(c, s, direction, dx);
  for (int r = 0; r < b->n; r++)
    for (int side = 0; side < 2; side++) {
      const int body = side ? c->contacts.f[b->row[r]] : c->contacts.o[b->row[r]];
      if (mg_is_moved_by_forces(c, body))
        b->rate_after_dot[r] += mg_dot6(c->rows.J + 12 * b->row[r] + 6 * side, s->at.acceleration + 6 * body);
    }
  mg_set_blow_right_hand_sides(c, s, direction);
  mg_lu_solve(b->n, b->matrix, b->pivots, b->change);
  for (int r = 0; r < b->n; r++) mg_add_row_response(c, b->row[r], b->change[r] / b->scale[r], s->at.acceleration);
  for (int body = 0; body < system->n_body; body++)
    if (mg_is_moved_by_forces(c, body))
      mg_copy_velocity(c, body, s->at.acceleration + 6 * body, dx + system->n_q + system->body_u[body]);
}
