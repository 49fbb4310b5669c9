/* Transitions: which contacts stay closed and which of them carry force, decided by the complementarity problem
   of accelerations (2.6), (2.7): 0 <= force, 0 <= d_ddot, complementary. */
#include "events/events.h"
#include "solve/lcp/solvers.h"
#include "model/model.h"
#include "closest/closest.h"
#include "forces/forces.h"
#include "features/features.h"
#include "patch/patch.h"
#include "impact/impact.h"

#define MG_JUST_CLOSED 2 /* mark in c->events.triggered: the contact has just closed */

/* True if the active contacts and the joints hold this one's gap as well, so that it rests without force. */
static int mg_held_by_others(mg_context *c, int contact) {
  int n = 0;
  for (int i = 0; i < c->system->n_contact; i++)
    if (c->run->active[i]) c->lcp.rows[n++] = i;
  n = mg_append_joint_rows(c, c->lcp.rows, n);
  if (c->system->n_grip) n = mg_append_sticking_rows(c, c->lcp.rows, n);
  c->lcp.rows[n++] = contact;
  mg_assemble_delassus(c, c->lcp.rows, n);
  const mg_real *column = c->lcp.A + (long)n * (n - 1);
  mg_real own = column[n - 1];
  for (int r = 0; r < n; r++) c->lcp.b[r] = column[r], c->lcp.mask[r] = r < n - 1;
  mg_active_above(n, c->lcp.A, c->lcp.b, c->lcp.mask, c->system->n_row ? c->settings->singular : 0, c->lcp.z,
                  c->lcp.work, c->lcp.iwork);
  for (int r = 0; r < n - 1; r++) own += column[r] * c->lcp.z[r];
  return own <= c->settings->dependent * column[n - 1];
}

/* Forces of least norm may pull where they are not unique: there the contact that pulls most carries none. */
static void mg_drop_pulling(mg_context *c) {
  for (;;) {
    const mg_real slack = mg_rest_acceleration(c) * c->system->mass;
    int worst = -1;
    for (int i = 0; i < c->support_begin; i++)
      if (c->run->active[i] && c->force[i] < -slack && (worst < 0 || c->force[i] < c->force[worst])) worst = i;
    if (worst < 0) return;
    c->run->active[worst] = 0;
    if (!mg_held_by_others(c, worst)) {
      c->run->active[worst] = 1;
      return;
    }
    mg_update_rows_and_forces(c);
  }
}

/* A closed contact without active force opens: at once where its gap accelerates, and at a force that has
   just reached zero, after which its gap will. */
static int mg_opens(mg_context *c, int contact) {
  if (!c->run->closed[contact] || c->run->active[contact]) return 0;
  if (mg_gap_acceleration(c, contact) > mg_rest_acceleration(c)) return 1;
  return c->events.triggered[contact] && !mg_held_by_others(c, contact);
}

/* Contacts marked in c->events.triggered are tried open first: their force has just reached zero. */
MG_INTERNAL int mg_solve_modes(mg_context *c, mg_events *events) {
  const int m = c->system->n_contact;
  int held = 0;
  mg_begin_patches(c, events, c->settings->start_gap * c->system->length);
  int outcome = mg_solve_active_set(c, c->events.triggered);
  if (outcome) return outcome;
  for (int i = 0; i < m; i++)
    if (c->events.triggered[i] && c->run->closed[i]) held += mg_gap_acceleration(c, i) < -mg_rest_acceleration(c);
  if (held) {
    mg_clear_triggered(c);
    outcome = mg_solve_active_set(c, c->events.triggered);
    if (outcome) return outcome;
  }
  if (!c->system->n_grip) mg_drop_pulling(c);
  for (int i = 0; i < m; i++)
    if (mg_opens(c, i)) mg_apply_transition(c, events, i, MG_LIFTS_OFF, c->run->t, 0);
  if (c->system->n_grip) mg_report_friction_events(c, events), mg_report_patch_friction(c, events);
  return MG_DONE;
}

/* A closed contact without force whose gap no longer stays at rest: the active set must be chosen anew. */
MG_INTERNAL int mg_is_active_set_stale(mg_context *c) {
  for (int i = 0; i < c->system->n_contact; i++)
    if (c->run->closed[i] && !c->run->active[i] && fabs(mg_gap_acceleration(c, i)) > mg_rest_acceleration(c)) return 1;
  return 0;
}

static int mg_too_many(mg_context *c) {
  mg_run *run = c->run;
  if (run->t - run->t_event > c->settings->event * c->system->time) run->events_at_t = 0;
  run->t_event = run->t;
  return ++run->events_at_t > c->settings->events_at_once;
}

/* False when more contacts are closed than the caller gave room for. */
MG_INTERNAL int mg_has_capacity(const mg_context *c) {
  int n = 0;
  for (int i = 0; i < c->system->n_contact; i++) n += c->run->closed[i] != 0;
  return n <= c->system->n_closed;
}

/* A closed contact that has walked to where its gap is wide, or widens. */
MG_INTERNAL void mg_open_distant(mg_context *c, mg_events *events) {
  const mg_real far = c->settings->start_gap * c->system->length,
                rest = c->settings->rest_speed * c->system->length / c->system->time;
  for (int i = 0; i < c->support_begin; i++)
    if (c->run->closed[i] && (c->d[i] > far || c->d_dot[i] > rest))
      mg_apply_transition(c, events, i, MG_LIFTS_OFF, c->run->t, 0);
}

/* The contact is about to pass a border of its link, before it is any deeper than what counts as touching: there it
   does not strike. Which border is in c->events.broken_condition. Needs the slope in K[0]. */
static int mg_is_passing(mg_context *c, int contact) {
  const int link = c->run->link[contact];
  const mg_real soon = sqrt(sqrt(c->settings->event)) * c->system->time,
                moment = sqrt(c->settings->event) * c->system->time;
  const mg_real deep = c->settings->start_gap * c->system->length;
  mg_real *x = c->step.stage, next[6];
  if (mg_is_unconditional_link(c, link)) return 0;
  mg_place_contact(c, contact, mg_contact_eta(c, c->run->x, contact), next);
  const mg_real now =
      mg_most_violated_condition(c, link, mg_contact_eta(c, c->run->x, contact), c->events.broken_condition + contact);
  mg_extrapolate_poses(c);
  mg_place_contact(c, contact, mg_contact_eta(c, x, contact), next);
  const mg_real then =
      mg_most_violated_condition(c, link, mg_contact_eta(c, x, contact), c->events.broken_condition + contact);
  mg_update_poses(c, c->run->t, c->run->x);
  if (now <= c->settings->apart) return then < -c->settings->border;
  const mg_real left = then < now ? moment * now / (now - then) : MG_MAX;
  return left < soon && left * fabs(c->d_dot[contact]) < deep;
}

/* A contact that seemed to leave its link, by what the step erred in eta or pose, but on its extremum is well within
   it, stays. */
static void mg_let_stay(mg_context *c) {
  mg_real eta[6];
  int which;
  for (int i = 0; i < c->support_begin; i++) {
    if (c->events.triggered[i] != MG_LEAVES_FEATURE) continue;
    for (int k = 0; k < c->n_eta[i]; k++) eta[k] = mg_contact_eta(c, c->run->x, i)[k];
    if (mg_newton_on_link(c, i, eta) >= 0 &&
        mg_most_violated_condition(c, c->run->link[i], eta, &which) > c->settings->border)
      c->events.triggered[i] = 0;
  }
}

/* An open contact whose gap has closed, or is closed and goes on closing. */
static int mg_is_about_to_strike(const mg_context *c, int contact) {
  if (c->run->closed[contact]) return 0;
  return c->events.triggered[contact] ||
         (fabs(c->d[contact]) <= c->settings->gap * c->system->length && mg_is_bouncing_approach(c, contact));
}

/* Open contacts whose gaps have closed where they leave their links walk. */
static void mg_let_pass(mg_context *c) {
  for (int i = 0; i < c->support_begin; i++)
    if (c->events.triggered[i] <= 1 && mg_is_on_link(c, i) && mg_is_about_to_strike(c, i) && mg_is_passing(c, i))
      c->events.triggered[i] = MG_LEAVES_FEATURE;
}

/* At run->x with its rows fresh: contacts in c->events.triggered close (gaps) or open (forces). */
static int mg_transition(mg_context *c, mg_events *events) {
  if (mg_too_many(c)) return MG_TOO_MANY_EVENTS;
  if (mg_end_patches(c, events)) mg_update_rows_and_forces(c);
  mg_let_stay(c);
  mg_let_pass(c);
  if (mg_change_features(c, events)) {
    mg_update_rows_and_forces(c);
    mg_open_distant(c, events);
  }
  for (int i = 0; i < c->support_begin; i++)
    if (mg_is_about_to_strike(c, i)) {
      mg_apply_transition(c, events, i, MG_IMPACT_INELASTIC, c->run->t, 0);
      c->events.triggered[i] = MG_JUST_CLOSED;
    }
  if (!mg_has_capacity(c)) return MG_TOO_MANY_CLOSED;
  const int outcome = mg_impact(c, events);
  if (outcome) return outcome;
  for (int i = 0; i < c->system->n_contact; i++) {
    if (c->events.triggered[i] != MG_JUST_CLOSED) continue;
    c->events.triggered[i] = 0;
    if (c->run->closed[i])
      mg_apply_transition(c, events, i, MG_TOUCHES_DOWN, c->run->t + mg_remaining_bounce_time(c, i),
                          fmax(0, -c->d_dot[i]));
  }
  const int settled = mg_solve_modes(c, events);
  for (int slot = 0; slot < c->system->n_slot; slot++) c->patches.barred[slot] = -1;
  return settled;
}

/* Contacts at zero gap that already separate are open. */
MG_INTERNAL void mg_open_separating(mg_context *c) {
  for (int i = 0; i < c->system->n_contact; i++)
    if (c->run->closed[i] && c->d_dot[i] > c->settings->rest_speed * c->system->length / c->system->time)
      c->run->closed[i] = 0;
}

/* What an event left on the contacts that stay closed, too slow to open them, is removed at once. A contact that
   appeared below zero is lifted; what that does to the energy is booked as work. */
MG_INTERNAL int mg_change_mode(mg_context *c, mg_events *events) {
  const int outcome = mg_transition(c, events);
  if (outcome || !c->settings->project) return outcome;
  const int lifts = mg_largest_drift(c, c->d) > c->settings->border * c->system->length;
  mg_real kinetic;
  const mg_real before = lifts ? mg_energy(c, &kinetic) : 0;
  if (!mg_project_drift(c)) return MG_NOT_FINITE;
  if (lifts) c->run->x[c->work_state] += mg_energy(c, &kinetic) - before;
  return MG_DONE;
}
