/* Impacts at all closed contacts at once. Without friction, Newton's restitution is a complementarity problem of
   velocities, 0 <= P, 0 <= v_after + e v_before, complementary. Faces that land flat are struck as one. Writes
   the velocities and the work of the run's state, the closed set and the event list. */
#include "impact/impact.h"
#include "solve/lcp/lcp_solvers.h"
#include "model/model.h"
#include "forces/forces.h"
#include "patch/patch.h"

/* List the closed contacts that no patch covers, then the supports on hull edges; returns their number. */
static int mg_list_impact_contacts(mg_context *c) {
  int n = 0;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (c->run->closed[i] && !c->patches.is_covered[i]) c->lcp.rows[n++] = i;
  return mg_append_edge_supports(c, c->lcp.rows, n);
}

/* Open the contacts that separate after the impact and report their events. */
static void mg_open_rebounding_contacts(mg_context *c, mg_events *events) {
  const mg_real rest = c->settings->rest_speed * c->system->length / c->system->time;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    const int separates = c->run->closed[i] && mg_row_times(c, i, c->bodies.twist) > rest;
    if (separates && mg_is_approaching(c, i))
      mg_apply_contact_transition(c, events, i, MG_IMPACT_REBOUND, c->run->t, -c->rows.d_dot[i]);
    else if (separates) mg_apply_contact_transition(c, events, i, MG_PUSHED_OPEN, c->run->t, 0);
  }
}

/* Solve the impulses on closed contacts, supports and joints by Newton's restitution law. Returns how many listed
   rows can only push, -1 without a solution. */
static int mg_solve_impulses(mg_context *c) {
  if (c->system->n_friction) return mg_solve_frictional_impulses(c);
  const int n = mg_list_impact_contacts(c);
  mg_lcp_report report;
  mg_set_support_impact_rates(c);
  for (int r = 0; r < n; r++) {
    const int i = c->lcp.rows[r];
    c->rows.row_rate[i] = c->rows.d_dot[i] * (1 + mg_effective_restitution(c, i)), c->lcp.mask[r] = 1;
  }
  if (mg_solve_force_lcp(c, n, c->rows.row_rate, &report) != MG_LCP_SOLVED) return -1;
  for (int i = c->layout.support_begin; i < c->system->n_contact; i++) c->solution.impulse[i] = 0;
  const int size = mg_append_bilateral_rows(c, c->lcp.rows, n);
  for (int r = 0; r < size; r++)
    if (mg_is_support_contact(c, c->lcp.rows[r])) c->solution.impulse[c->lcp.rows[r]] = c->lcp.z[r];
  return n;
}

/* True if a closed contact approaches, the supports of a held patch move, or the prescribed rate of a joint has
   jumped. */
static int mg_has_impact(const mg_context *c) {
  const mg_real drift = c->settings->drift_tolerance * c->system->length / c->system->time,
                rest = c->settings->rest_speed * c->system->length / c->system->time;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (c->run->closed[i] && mg_is_approaching_beyond_drift(c, i)) return 1;
  for (int i = c->layout.support_begin; i < c->system->n_contact; i++)
    if (c->run->closed[i] && fabs(c->rows.d_dot[i]) > drift) return 1;
  for (int i = c->layout.joint_row_begin; i < c->layout.joint_row_end && c->layout.has_prescribed_joint; i++)
    if (fabs(c->rows.d_dot[i]) > drift && fabs(c->rows.d_dot[i]) > rest) return 1;
  return 0;
}

/* Record a contact at rest, with restitution, that an impact elsewhere has pressed: simultaneous and sequential
   impacts differ there. */
static void mg_note_impact_chain(mg_context *c, int n) {
  int chain = -1, struck = 0;
  for (int r = 0; r < n; r++) {
    const int i = c->lcp.rows[r];
    if (i >= c->layout.support_begin || !(c->lcp.z[r] > 0) || !(c->system->restitution[i] > 0)) continue;
    if (mg_is_approaching(c, i)) struck = 1;
    else chain = i;
  }
  if (struck && chain >= 0) mg_report_chain_impact(c->run, mg_told_contact(c->system, c->run, chain));
}

MG_INTERNAL int mg_resolve_impacts(mg_context *c, mg_events *events) {
  MG_NEEDS_AT_RUN(c, MG_VALID_ROWS);
  const mg_real floor = c->settings->rest_speed * c->system->mass * c->system->length / c->system->time;
  int n;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) c->patches.is_covered[i] = 0;
  if (mg_replace_struck_patches(c)) mg_evaluate_run_state(c);
  if (mg_is_impact_sequential(c) && !mg_resolve_impacts_in_sequence(c, events)) return MG_COMPLEMENTARITY;
  if (mg_hold_flat_patches_on_trial(c, c->settings->start_gap * c->system->length, 1)) mg_evaluate_run_state(c);
  if (!mg_has_impact(c)) {
    mg_release_trial_patches(c);
    return MG_DONE;
  }
  do {
    mg_mark_covered_contacts(c);
    n = mg_solve_impulses(c);
    if (n < 0) return MG_COMPLEMENTARITY;
  } while (mg_reject_trial_patches(c, c->solution.impulse, floor, 1) ||
           mg_end_patches_by_impulse(c, c->solution.impulse, floor) || mg_exchange_edge_supports(c, n));
  mg_note_impact_chain(c, n);
  if (c->system->n_friction) mg_note_impact_energy_gain(c, n);
  mg_apply_impulses(c, mg_append_bilateral_rows(c, c->lcp.rows, n));
  mg_update_poses(c, c->run->t, c->run->x);
  if (c->system->n_friction) mg_reset_friction_modes(c);
  mg_finish_edge_impacts(c, events);
  mg_open_rebounding_contacts(c, events);
  mg_release_trial_patches(c);
  return MG_DONE;
}
