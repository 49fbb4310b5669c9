/* Derivatives over the corrections of mg_begin: the poses are put on gaps and joints, the joints take from the
   velocities what they forbid, the contacts that approach are struck. Both changes of velocities are blows. */
#include "sensitivity/sensitivity.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

/* Largest difference of the velocities of two states, by their scales. */
static mg_real mg_velocity_change(const mg_context *c, const mg_real *one, const mg_real *other) {
  const int first = c->system->n_q;
  mg_real most = 0;
  for (int i = first; i < first + c->system->n_u; i++) most = mg_max(most, fabs(one[i] - other[i]) / c->step.scale[i]);
  return most;
}

/* Gives the run the velocities of the start before the corrections. */
static void mg_take_back_velocities(mg_context *c, const mg_real *given) {
  const int first = c->system->n_q;
  for (int i = first; i < first + c->system->n_u; i++) c->run->x[i] = given[i];
  mg_evaluate_run_state(c);
}

/* Lets the joints alone correct the velocities of the run. */
static void mg_let_joints_hold(mg_context *c, mg_sensitivity *s) {
  for (int i = 0; i < c->system->n_contact; i++) s->closed_before[i] = 0;
  if (!c->system->n_joint_row) return;
  mg_set_body_corrections(c, mg_hold_rows(c, s->closed_before, 0, c->rows.d_dot, c->solution.impulse));
  mg_apply_velocity_correction(c);
  mg_evaluate_run_state(c);
}

/* Marks the contacts whose gaps hold the poses at the start: those that are closed or about to be struck. */
static void mg_mark_touching(const mg_context *c, mg_sensitivity *s) {
  const mg_real touching = c->settings->contact_gap * c->system->length;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    s->closed_before[i] =
        c->run->closed[i] || (mg_is_on_feature_pair(c, i) && fabs(c->rows.d[i]) <= touching && c->rows.d_dot[i] < 0);
}

MG_INTERNAL int mg_restore_start(mg_context *c, mg_sensitivity *s, const mg_real *given, int part) {
  mg_real *settled = s->stage;
  mg_copy_states(c, c->run->x, settled);
  if (given) mg_take_back_velocities(c, given);
  mg_copy_states(c, c->run->x, s->before);
  mg_let_joints_hold(c, s);
  mg_mark_touching(c, s);
  if (part != MG_JOINTS_HOLD) {
    mg_copy_states(c, c->run->x, s->before);
    mg_copy_states(c, settled, c->run->x);
    mg_evaluate_run_state(c);
  }
  if (part == MG_START_SETTLED || mg_velocity_change(c, s->before, c->run->x) <= c->settings->drift_tolerance) return 0;
  return !mg_recover_impulses(c, s, part == MG_CONTACTS_STRIKE) && s->blow->n > 0;
}

/* Carries the derivatives over one blow of the start. Returns a reason or 0. */
static int mg_start_blow_tangent(mg_context *c, mg_sensitivity *s, const mg_real *given, int part) {
  mg_real *settled = s->slope_before;
  mg_copy_states(c, c->run->x, settled);
  const int solved = mg_restore_start(c, s, given, part),
            changes = mg_velocity_change(c, s->before, c->run->x) > c->settings->derivative_start_change;
  for (int j = 0; j < s->directions->n && solved; j++)
    mg_blow_tangent(c, s, j, s->tangent->x + (long)j * c->layout.n_states);
  mg_copy_states(c, settled, c->run->x);
  mg_evaluate_run_state(c);
  s->is_lost |= changes && !solved;
  return changes && !solved ? MG_BY_START : MG_NO_REASON;
}

/* Removes from the derivatives of the poses what gaps and joints forbid. */
static void mg_project_gap_tangents(mg_context *c, mg_sensitivity *s, const int *marked) {
  const mg_real t = c->run->t, *x = c->run->x;
  mg_settle_eta_tangents(c, s, t, x);
  if (!c->settings->project) return;
  for (int j = 0; j < s->directions->n; j++) {
    mg_real *dx = s->tangent->x + (long)j * c->layout.n_states;
    mg_rows_tangent(c, s, j, t, x, dx, marked, s->stage);
    mg_set_body_corrections(c, mg_hold_rows(c, marked, 0, s->at.value, c->solution.impulse));
    mg_add_correction(c, x, 0, dx);
  }
  mg_zero_reals(c->bodies.wrench, 6L * c->system->n_body);
  mg_settle_eta_tangents(c, s, t, x);
}

/* True if a number of the scene opens or closes marked contacts at the start, or lets them move: their run starts in
   another way on each side. Needs the state of the run. */
static int mg_opens_start(mg_context *c, mg_sensitivity *s, const int *marked) {
  MG_NEEDS_AT_RUN(c, MG_VALID_ROWS);
  const int *permitted = s->directions->is_permitted;
  const mg_real part = sqrt(c->settings->event_tolerance);
  mg_settle_eta_tangents(c, s, c->run->t, c->run->x);
  for (int j = 0; j < s->directions->n; j++) {
    if (!permitted || permitted[j]) continue;
    mg_rows_tangent(c, s, j, c->run->t, c->run->x, s->tangent->x + (long)j * c->layout.n_states, marked, s->stage);
    const mg_real rounding = MG_ROUNDED_TANGENT * s->size[j] * c->system->length;
    for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) {
      s->doubtful = i;
      if (marked[i] && fabs(s->at.value[i]) > part * mg_gap_tangent_size(c, s, i) + rounding) return 1;
      if (c->run->closed[i] && marked[i] &&
          fabs(s->at.rate[i]) > part * mg_rate_tangent_size(c, s, i) + rounding / c->system->time)
        return 1;
    }
  }
  s->doubtful = -1;
  return 0;
}

MG_INTERNAL int mg_start_tangent(mg_context *c, mg_sensitivity *s, const mg_real *given) {
  mg_restore_start(c, s, given, MG_START_SETTLED);
  const int opens = mg_opens_start(c, s, s->closed_before);
  mg_project_gap_tangents(c, s, s->closed_before);
  const int of_joints = mg_start_blow_tangent(c, s, given, MG_JOINTS_HOLD),
            of_contacts = mg_start_blow_tangent(c, s, given, MG_CONTACTS_STRIKE),
            lets_go = mg_opens_start(c, s, c->run->closed);
  mg_mark_held_contacts(c, s, 1);
  mg_project_tangents(c, s, c->run->t, c->run->x);
  if (mg_rests_on_moving_points(c, s)) return MG_BY_BORDER;
  const int reason = of_joints ? of_joints : of_contacts;
  return !reason && (opens || lets_go) ? MG_BY_ONE_WAY : reason;
}
