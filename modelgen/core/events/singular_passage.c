/* Over a place where a closed contact's curvature vanishes, or where two closed points of a pair become one. The
   velocity of the contact point is infinite there, and so may be the force, but their integrals are not: the velocities
   change by impulses P along the rows of the contacts, which change with the contact point as it passes,

       u_1 = u_0 + tau (a_0 + a_1)/2 + M^-1 (J_0 + J_1)^T P/2,   J_1 u_1 = 0,   q_1 = q_0 + tau q_dot((u_0 + u_1)/2),

   with the accelerations a that all else makes. J is linear in the point, so that the error is of the third order in
   the way that it goes, however fast; what it does to the energy stays in the ledger. */
#include "events/events.h"
#include "base/base.h"
#include "model/model.h"
#include "closest/closest.h"
#include "forces/forces.h"
#include "integrate/integrate.h"
#include "features/features.h"

enum { MG_PASSAGES_MAX = 400, MG_PASSAGE_ROUNDS = 6, MG_PASSAGE_STEP_CUT = 4 };

static const mg_real mg_vault_longest = (mg_real)1e-4; /* times the characteristic time */

/* Lists the rows that are held: contacts that carry force, joints, stuck grips. */
static int mg_list_held(mg_context *c) {
  int n = 0;
  for (int i = 0; i < c->system->n_contact; i++)
    if (c->run->active[i]) c->lcp.rows[n++] = i;
  n = mg_append_joint_rows(c, c->lcp.rows, n);
  return c->system->n_grip ? mg_append_sticking_rows(c, c->lcp.rows, n) : n;
}

/* per_body += M^-1 J^T amount of a row and of the friction that slips with it, from columns or as they are. */
static void mg_add_column(const mg_context *c, int row, const mg_real *column, mg_real amount, mg_real *per_body) {
  for (int k = 0; k < 12; k++) {
    const int body = k < 6 ? c->o[row] : c->f[row];
    if (mg_moves(c, body)) per_body[6 * body + k % 6] += column[k] * amount;
  }
}

static void mg_column(const mg_context *c, int row, mg_real *column) {
  for (int k = 0; k < 12; k++) column[k] = c->MJ[12 * row + k];
  if (!c->system->n_grip || row >= c->support_begin) return;
  const int first = c->friction_row_begin + c->system->contact_below[row];
  for (int i = first; i < first + c->kernels->contact_kinds[c->kind[row]].rows - 1; i++)
    for (int k = 0; k < 12; k++) column[k] -= c->friction.force_ratio[i - c->friction_row_begin] * c->MJ[12 * i + k];
}

/* Power of the loads alone. */
static mg_real mg_load_power(const mg_context *c, const mg_real *slope) {
  mg_real power = slope[c->work_state];
  if (c->n_driven || c->has_prescribed_joint) power -= mg_driven_power(c);
  return c->system->n_grip ? power - mg_slipping_power(c) : power;
}

/* At run->x, whose rows are fresh: what the way over begins with. */
static void mg_look_back(mg_context *c) {
  mg_singular_passage *v = &c->events.passage;
  const int n = mg_list_held(c);
  for (int k = 0; k < 6 * c->system->n_body; k++) v->free_twist[k] = c->accel[k];
  for (int r = 0; r < n; r++) {
    const int row = c->lcp.rows[r];
    mg_column(c, row, v->column + 12 * row);
    mg_add_column(c, row, v->column + 12 * row, -c->force[row], v->free_twist);
  }
  for (int i = 0; i < c->friction_row_end; i++) v->rate[i] = c->d_dot[i];
  v->power = mg_load_power(c, c->step.slopes);
  for (int i = 0; i < c->system->n_contact; i++) {
    if (!c->run->closed[i]) continue;
    mg_place_contact(c, i, mg_contact_eta(c, c->run->x, i), c->search.placement + 32);
    for (int k = 0; k < 3; k++) v->point[3 * i + k] = c->search.placement[11 + k];
  }
}

/* Takes eta to the minimum of the contact's link that continues it, placed; returns 0 where there is none at zero gap.
 */
static int mg_find_landing(mg_context *c, int contact, mg_real *eta) {
  const mg_real touching = c->settings->gap * c->system->length;
  const int n = c->n_eta[contact], link = c->run->link[contact];
  mg_real next[6], to[6] = {0};
  mg_minimum found;
  mg_minima kept = {0};
  for (int k = 0; k < n; k++) to[k] = eta[k];
  if (!n) {
    mg_place_contact(c, contact, to, next);
    return mg_placement_margin(c) > c->settings->lost && fabs(c->search.placement[0]) <= touching;
  }
  if (mg_newton_on_link(c, contact, to) >= 0 && mg_accept_minimum(c, link, to, &found))
    mg_insert_minimum(c, &kept, &found);
  if (!kept.count || fabs(kept.list[0].d) > touching)
    mg_search_near_bifurcation(c, contact, eta, c->settings->margin_refuse, &kept);
  if (!kept.count || fabs(kept.list[0].d) > touching) mg_search_link(c, link, MG_COARSE, 1, -MG_MAX, &kept);
  if (!kept.count || fabs(kept.list[0].d) > touching) return 0;
  for (int k = 0; k < n; k++) eta[k] = kept.list[0].eta[k];
  mg_place_contact(c, contact, eta, next);
  return 1;
}

static mg_real mg_far(const mg_real *a, const mg_real *b) {
  const mg_real way[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return sqrt(mg_dot3(way, way));
}

/* Points of a pair that become one do so between them; one that falls to another's place has missed its own. */
static int mg_has_missed(const mg_context *c, int contact) {
  const mg_singular_passage *v = &c->events.passage;
  const mg_real *from = v->point + 3 * contact, *to = v->landing_point + 3 * contact;
  const mg_real one = c->settings->apart * c->system->length;
  for (int i = mg_pair_first_contact(c, c->system->contact_pair[contact]); i < contact; i++) {
    if (!c->run->closed[i] || mg_far(v->landing_point + 3 * i, to) > one) continue;
    const mg_real *other = v->point + 3 * i, apart = (mg_real)0.75 * mg_far(other, from);
    if (apart > one && (mg_far(from, to) > apart || mg_far(other, to) > apart)) return 1;
  }
  return 0;
}

/* The closed contacts of the state x at its poses; returns how far their points have gone, MG_MAX where one has none.
 */
static mg_real mg_land(mg_context *c, mg_real t, mg_real *x) {
  mg_real farthest = 0;
  mg_update_poses(c, t, x);
  c->events.passage.margin = MG_MAX;
  for (int i = 0; i < c->support_begin; i++) {
    if (!c->run->closed[i]) continue;
    if (!mg_find_landing(c, i, mg_contact_eta(c, x, i))) return MG_MAX;
    for (int k = 0; k < 3; k++) c->events.passage.landing_point[3 * i + k] = c->search.placement[11 + k];
    if (!(mg_placement_margin(c) >= c->events.passage.margin)) c->events.passage.margin = mg_placement_margin(c);
    if (mg_has_missed(c, i)) return MG_MAX;
    const mg_real way = mg_far(c->events.passage.landing_point + 3 * i, c->events.passage.point + 3 * i);
    if (!(way <= farthest)) farthest = way;
  }
  return farthest;
}

/* The velocities of x from the impulses so far; `turned`: what the change of the rows makes of them. Needs the rows at
 * x. */
static void mg_vault_speeds(mg_context *c, mg_real tau, mg_real *x, mg_real *turned) {
  const mg_system *s = c->system;
  mg_singular_passage *v = &c->events.passage;
  const int n = mg_list_held(c);
  mg_real column[12], *change = c->wrench;
  for (int k = 0; k < 6 * s->n_body; k++)
    change[k] = 0, v->impulse_work[k] = tau * (v->free_twist[k] + c->accel[k]) / 2;
  for (int r = 0; r < n; r++) {
    const int row = c->lcp.rows[r];
    mg_column(c, row, column);
    mg_add_column(c, row, column, -tau * c->force[row] / 2, v->impulse_work);
    for (int k = 0; k < 12; k++) column[k] = (column[k] - v->column[12 * row + k]) / 2;
    mg_add_column(c, row, column, v->impulse[row], change);
    mg_add_column(c, row, v->column + 12 * row, v->impulse[row], v->impulse_work);
  }
  *turned = 0;
  for (int b = 0; b < s->n_body; b++)
    for (int k = 0; k < c->kernels->body_kinds[mg_kind_of(c, b)].n_u; k++) {
      const int at = s->n_q + s->body_u[b] + k;
      const mg_real size = fabs(change[6 * b + k]) * (k < 3 ? s->time / s->length : s->time);
      if (!(size <= *turned)) *turned = size;
      x[at] = c->run->x[at] + v->impulse_work[6 * b + k] + change[6 * b + k];
      change[6 * b + k] = 0;
    }
}

/* What of the rows' rates is left at x is taken into the impulses. */
static void mg_vault_impulses(mg_context *c) {
  const int shared = c->run->forces_redundant;
  c->friction.couples_normal = c->system->n_grip > 0, c->run->forces_redundant = 0;
  const int n = mg_hold_rows(c, c->run->active, c->d_dot, c->impulse);
  for (int r = 0; r < n; r++) c->events.passage.impulse[c->lcp.rows[r]] += c->impulse[c->lcp.rows[r]];
  c->friction.couples_normal = 0, c->run->forces_redundant = shared;
}

/* q of x from the mean of the velocities at both ends. */
static void mg_move_on(mg_context *c, mg_real tau, mg_real *x) {
  const mg_system *s = c->system;
  mg_real *slope = c->step.slopes + c->n_states, *mean = c->step.stage;
  for (int k = 0; k < c->n_states; k++) mean[k] = c->run->x[k];
  for (int k = s->n_q; k < s->n_q + s->n_u; k++) mean[k] = (c->run->x[k] + x[k]) / 2;
  mg_update_poses(c, c->run->t, mean);
  mg_free_accelerations(c, c->run->t, mean, slope);
  for (int k = 0; k < s->n_q; k++) x[k] = c->run->x[k] + tau * slope[k];
  mg_normalise_quaternions(c, x);
}

/* Work of the loads, of slip, and of what bodies do whose motion is given. */
static mg_real mg_work_over(const mg_context *c, mg_real tau, mg_real power) {
  const mg_singular_passage *v = &c->events.passage;
  mg_real work = tau * (v->power + power) / 2;
  for (int i = 0; i < c->joint_row_end; i++) {
    work -= v->impulse[i] * mg_prescribed_gap_rate(c, i);
    if (!c->system->n_grip || i >= c->support_begin || !c->run->active[i]) continue;
    const int first = c->friction_row_begin + c->system->contact_below[i];
    for (int k = first; k < first + c->kernels->contact_kinds[c->kind[i]].rows - 1; k++)
      work -= c->friction.force_ratio[k - c->friction_row_begin] * v->impulse[i] * (v->rate[k] + c->d_dot[k]) / 2;
  }
  return work;
}

/* From run->x to c->step.end in the time tau; returns what that may err, against the scales. */
static mg_real mg_vault_over(mg_context *c, mg_real tau) {
  const mg_system *s = c->system;
  const mg_real t = c->run->t + tau, part = tau / s->time;
  mg_real *x = c->step.end, way = 0, turned = 0;
  for (int k = 0; k < c->n_states; k++) x[k] = c->run->x[k];
  for (int i = 0; i < c->friction_row_end; i++) c->events.passage.impulse[i] = 0;
  for (int round = 0; round < MG_PASSAGE_ROUNDS; round++) {
    mg_move_on(c, tau, x);
    way = mg_land(c, t, x);
    if (!(way < MG_MAX)) return MG_MAX;
    mg_rhs(c, t, x, c->step.slopes + c->n_states);
    mg_gap_rates(c);
    mg_vault_impulses(c);
    mg_vault_speeds(c, tau, x, &turned);
  }
  x[c->work_state] = c->run->x[c->work_state] + mg_work_over(c, tau, mg_load_power(c, c->step.slopes + c->n_states));
  return mg_all_finite(c->n_states, x) ? turned * way / s->length / 6 + part * part * part / 12 : MG_MAX;
}

/* The longest way over that errs no more than the tolerance asked, to c->step.end; 0 if there is none. */
static mg_real mg_choose_vault(mg_context *c) {
  const mg_real least = c->settings->event * c->system->time;
  mg_look_back(c);
  for (mg_real tau = mg_vault_longest * c->system->time; tau >= least; tau /= MG_PASSAGE_STEP_CUT) {
    if (c->run->t + tau <= c->step.stop_time && mg_vault_over(c, tau) <= c->settings->tolerance) return tau;
    mg_update_poses(c, c->run->t, c->run->x);
  }
  return 0;
}

static int mg_stand_at(mg_context *c, mg_real t, const mg_real *x) {
  for (int k = 0; k < c->n_states; k++) c->run->x[k] = x[k];
  c->run->t = t;
  const int sound = mg_place_all_contacts(c, t, c->run->x);
  mg_update_rows_and_forces(c);
  return sound;
}

/* Samples due on the way over: bodies where they were, forces and points as they are after it. */
static void mg_record_vault(mg_context *c, mg_record *record) {
  while (mg_is_sample_due(record, c->run->t)) {
    const mg_real back = record->t[record->count] - c->run->t;
    for (int k = 0; k < c->n_states; k++) c->step.stage[k] = c->run->x[k];
    for (int k = 0; k < c->system->n_q; k++) c->step.stage[k] += back * c->step.slopes[k];
    mg_normalise_quaternions(c, c->step.stage);
    mg_update_poses(c, c->run->t + back, c->step.stage);
    mg_record_row(c, record, c->step.stage);
    mg_update_rows_and_forces(c);
  }
}

static int mg_may_vault(const mg_context *c) {
  for (int i = 0; i < c->system->n_contact; i++)
    if (c->run->fresh[i]) return 0;
  return c->settings->method == MG_DOP853 && c->settings->project && c->settings->use_gamma && c->settings->newton;
}

/* From run->x over what makes a closed contact singular; returns 0, and leaves all as it was, where there is no way. */
static int mg_vault_on(mg_context *c, mg_record *record) {
  mg_run *run = c->run;
  const mg_real t = run->t;
  mg_real tau = 0;
  int over = 0;
  for (int k = 0; k < c->n_states; k++) c->step.settled[k] = run->x[k];
  for (int k = 0; k < MG_PASSAGES_MAX && !over; k++) {
    tau = mg_choose_vault(c);
    if (!(tau > 0) || !mg_stand_at(c, run->t + tau, c->step.end) || !mg_project_drift(c)) break;
    over = c->events.passage.margin >= 2 * c->settings->margin_refuse;
    mg_record_vault(c, record);
  }
  if (!over) mg_stand_at(c, t, c->step.settled);
  else if (run->h < tau) run->h = tau;
  return over;
}

/* Over the places where closed contacts have become singular, as far as there is a way. */
MG_INTERNAL int mg_pass_singularities(mg_context *c, mg_record *record, mg_events *events) {
  int singular = 0;
  while (singular < c->system->n_contact && !mg_is_singular(c, singular)) singular++;
  if (singular == c->system->n_contact || !mg_may_vault(c)) return MG_DONE;
  mg_clear_triggered(c);
  if (mg_vault_on(c, record)) {
    mg_merge_contacts(c, events);
    if (mg_is_on_link(c, singular)) mg_split_contact(c, events, singular);
  } else if (!mg_is_replaced_by_others(c, events, singular)) return MG_DONE;
  if (!c->run->singular_passages++) c->run->passage_contact = singular;
  mg_update_rows_and_forces(c);
  return mg_change_mode(c, events);
}
