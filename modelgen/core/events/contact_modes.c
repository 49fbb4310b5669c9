/* Contact modes: which closed contacts carry force, from the linear complementarity problem of accelerations
   (2.6), (2.7): 0 <= force, 0 <= gap acceleration, complementary; and which of them open. Writes the closed and active
   sets of the run and the event list. */
#include "events/events.h"
#include "solve/lcp/lcp_solvers.h"
#include "model/model.h"
#include "forces/forces.h"
#include "patch/patch.h"

/* True if the rows of the active contacts, joints and sticking friction already hold this contact's gap: what its
   row keeps of its own entry of J M^-1 J^T is below the tolerance. */
static int mg_is_contact_redundant(mg_context *c, int contact) {
  int n = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->run->active[i]) c->lcp.rows[n++] = i;
  n = mg_append_joint_rows(c, c->lcp.rows, n);
  if (c->system->n_friction) n = mg_append_sticking_rows(c, c->lcp.rows, n);
  c->lcp.rows[n++] = contact;
  mg_assemble_delassus(c, c->lcp.rows, n);
  const mg_real *column = c->lcp.A + (long)n * (n - 1);
  mg_real own = column[n - 1];
  for (int r = 0; r < n; r++)
    c->lcp.b[r] = column[r], c->lcp.mask[r] = r < n - 1 ? mg_held_row_mask(c, c->lcp.rows[r]) : 0;
  mg_real pivot;
  mg_active_above(n, c->lcp.A, c->lcp.b, c->lcp.mask, c->system->n_joint_row ? c->settings->joint_rank_tolerance : 0,
                  c->lcp.z, c->lcp.work, c->lcp.iwork, &pivot);
  for (int r = 0; r < n - 1; r++) own += column[r] * c->lcp.z[r];
  return own <= c->settings->contact_rank_tolerance * column[n - 1];
}

/* Deactivate redundant contacts whose least-norm force is tensile, the most tensile first, until none is left. */
static void mg_drop_tensile_contacts(mg_context *c) {
  for (;;) {
    const mg_real slack = mg_acceleration_tolerance(c) * c->system->mass;
    int worst = -1;
    for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
      if (c->run->active[i] && c->solution.force[i] < -slack &&
          (worst < 0 || c->solution.force[i] < c->solution.force[worst]))
        worst = i;
    if (worst < 0) return;
    mg_set_active(c, worst, 0);
    if (!mg_is_contact_redundant(c, worst)) {
      mg_set_active(c, worst, 1);
      return;
    }
    mg_evaluate_run_state(c);
  }
}

/* True if a closed contact without force opens: its gap accelerates, or its force has just reached zero and no
   other row holds the gap. */
static int mg_is_contact_opening(mg_context *c, int contact) {
  if (!c->run->closed[contact] || c->run->active[contact]) return 0;
  if (mg_row_acceleration(c, contact) > mg_acceleration_tolerance(c)) return 1;
  return c->events.triggered[contact] && !mg_is_contact_redundant(c, contact);
}

/* The modes of the contacts under loads on their present branches. */
static int mg_solve_modes_on_branches(mg_context *c, mg_events *events) {
  const int m = c->system->n_contact;
  int held = 0;
  mg_begin_flat_patches(c, events, c->settings->start_gap * c->system->length);
  int outcome = mg_solve_active_set(c, c->events.triggered);
  if (outcome) return outcome;
  for (int i = 0; i < m; i++)
    if (c->events.triggered[i] && c->run->closed[i]) held += mg_row_acceleration(c, i) < -mg_acceleration_tolerance(c);
  if (held) {
    mg_clear_triggered_events(c);
    outcome = mg_solve_active_set(c, c->events.triggered);
    if (outcome) return outcome;
  }
  if (!c->system->n_friction) mg_drop_tensile_contacts(c);
  for (int i = 0; i < m; i++)
    if (mg_is_contact_opening(c, i)) mg_apply_contact_transition(c, events, i, MG_LIFTS_OFF, c->run->t, 0);
  if (c->system->n_friction) mg_report_friction_events(c, events), mg_report_patch_friction_events(c, events);
  return MG_DONE;
}

MG_INTERNAL int mg_solve_contact_modes(mg_context *c, mg_events *events) {
  c->switches.is_unresolved = 0, c->step.mode_choices++;
  mg_settle_load_branches(c, events);
  int outcome = mg_solve_modes_on_branches(c, events);
  if (!outcome && mg_settle_load_branches(c, events)) outcome = mg_solve_modes_on_branches(c, events);
  mg_monitor_loads_at_jumps(c);
  return outcome || !c->switches.is_unresolved ? outcome : MG_TOO_MANY_EVENTS;
}

MG_INTERNAL int mg_is_active_set_outdated(mg_context *c) {
  MG_NEEDS_AT_RUN(c, MG_VALID_ROWS), MG_NEEDS_AT_RUN(c, MG_VALID_FORCES);
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->run->closed[i] && !c->run->active[i] && fabs(mg_row_acceleration(c, i)) > mg_acceleration_tolerance(c))
      return 1;
  return 0;
}
