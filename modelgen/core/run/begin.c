/* The start of a run (mg_begin): closest points, closed contacts, assembly of the joints, first impacts and
   contact modes. Writes the state, contacts and statistics of the run. */
#include "run/run.h"
#include "base/base.h"
#include "model/model.h"
#include "closest/closest.h"
#include "forces/forces.h"
#include "features/features.h"
#include "patch/patch.h"
#include "impact/impact.h"
#include "events/events.h"
#include "timestep/timestep.h"

/* Places all contacts at the start and decides which are closed. Returns an outcome. */
static int mg_place_start_contacts(mg_context *c) {
  const mg_system *s = c->system;
  const mg_real touching = c->settings->start_gap * s->length;
  for (int i = mg_next_row(c, -1); i < s->n_contact; i = mg_next_row(c, i)) {
    mg_report_failed_contact(c->run, i);
    mg_set_closed(c, i, 0), mg_set_rolling_start(c, i, MG_START_NONE), c->run->after_t[i] = -1;
    if (!mg_is_on_feature_pair(c, i)) continue;
    const int lost = mg_newton_on_feature_pair(c, i, mg_contact_eta(c, c->run->x, i)) < 0 ||
                     !(mg_placement_uniqueness(c, i) >= c->settings->margin_refuse);
    if (lost && mg_is_contact_of_flat_patch(c, i)) {
      mg_set_feature_pair(c, i, -1, 0);
      continue;
    }
    if (mg_newton_on_feature_pair(c, i, mg_contact_eta(c, c->run->x, i)) < 0) return MG_NO_EXTREMUM;
    if (c->search.placement[0] < -touching) return MG_PENETRATION;
    mg_set_closed(c, i, c->search.placement[0] <= touching);
    c->run->margin[i] = mg_placement_uniqueness(c, i);
    if (c->run->closed[i]) mg_report_margin(c->run, c->run->margin[i]);
    const mg_real least = mg_followed_margin_limit(c, c->run->feature_pair[i], c->search.placement[0]);
    if (c->run->closed[i] && !(c->run->margin[i] >= least)) return MG_MARGIN;
  }
  for (int b = 0; b < s->n_body; b++) c->run->struck_by[b] = -1;
  mg_report_failed_contact(c->run, -1);
  return mg_has_closed_contact_capacity(c) ? MG_DONE : MG_TOO_MANY_CLOSED;
}

/* Reports the contacts that approached and do not rebound after the first impacts. */
static void mg_report_touch_downs(mg_context *c, mg_events *events) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->run->closed[i] && mg_is_approaching(c, i))
      mg_apply_contact_transition(c, events, i, MG_TOUCHES_DOWN, c->run->t, -c->rows.d_dot[i]);
}

/* Resets the counts by which a run goes on, and what it tells. */
static void mg_reset_counts(mg_run *run) {
  run->steps_max = run->steps = run->rejected = run->rhs_evals = run->search_effort = 0;
  run->since_projection = run->events_at_t = run->tiny_bounces = 0;
  run->progress_tries = run->progress_rejected = 0, run->progress_t = run->t;
  run->fallback_end = run->fallback_left = 0, run->fallback_doublings = 0;
  mg_reset_event_work(run);
  run->forces_redundant = run->friction_redundant = 0, run->is_passage_due = 1;
  run->t_event = run->t, run->t_roundoff = 0;
  mg_reset_report(run);
}

/* Start of time-stepping, which needs no modes: its first step takes the first impacts. */
static int mg_begin_time_stepping(mg_context *c) {
  mg_update_rows_at(c, c->run->t, c->run->x);
  for (int i = mg_next_row(c, -1); i < c->layout.friction_row_end; i = mg_next_row(c, i))
    c->solution.force[i] = c->run->reference_force[i] = 0;
  mg_update_diagnostics(c);
  return MG_DONE;
}

/* Moves the start behind the kink of a prescribed path at this time, so that the velocity is that after it. */
static void mg_start_after_kink(mg_context *c) {
  mg_real before, after;
  if (!mg_find_velocity_jump(c, mg_velocity_jump_duration(c) / 4, &before, &after)) return;
  c->run->t = c->run->t_event = after;
}

/* Begins the run. Returns an outcome. */
static int mg_begin_run(mg_context *c, mg_events *events) {
  const mg_system *system = c->system;
  const mg_settings *settings = c->settings;
  mg_run *run = c->run;
  mg_real kinetic;
  mg_reset_counts(run);
  mg_accept_inputs(c);
  mg_start_after_kink(c);
  for (int i = 0; i < system->n_friction; i++)
    mg_set_friction_mode(c, i, MG_FRICTION_OFF), c->friction.triggered[i] = 0,
                                                 c->friction.mode_before[i] = MG_FRICTION_OFF;
  for (int k = 0; k < system->n_switch; k++)
    mg_set_branch(c, k, 0), mg_set_switch_mode(c, k, MG_BRANCH_ZERO), mg_set_switch_leader(c, k, 0);
  for (int i = 0; i < system->n_patch_slot; i++) mg_set_patch_mode(c, i, MG_FRICTION_OFF);
  for (int k = 0; k < 3 * system->n_patch_slot; k++) run->patch_support_share[k] = 0;
  mg_zero_reals(run->search_bound, system->n_cell_tree);
  run->x[c->layout.work_state] = 0;
  mg_normalise_quaternions(c, run->x);
  mg_update_poses(c, run->t, run->x);
  mg_begin_near_pairs(c);
  int outcome = mg_are_too_many_near(run) ? MG_TOO_MANY_NEAR : mg_search_start_pairs(c);
  if (!outcome) outcome = mg_place_start_contacts(c);
  if (outcome) return outcome;
  mg_evaluate_run_state(c);
  outcome = mg_check_contact_rows(c);
  if (outcome) return outcome;
  if (!mg_project_initial_joints(c)) return MG_JOINT_APART;
  mg_open_separating(c);
  if (settings->project && !mg_project_initial_pose(c)) return MG_NO_EXTREMUM;
  mg_report_start_energy(run, mg_energy(c, &kinetic));
  mg_clear_triggered_events(c);
  if (settings->method == MG_TIME_STEPPING) return mg_begin_time_stepping(c);
  mg_settle_load_branches(c, 0);
  outcome = mg_resolve_impacts(c, events);
  mg_report_touch_downs(c, events);
  if (!outcome) outcome = mg_solve_contact_modes(c, events);
  if (!outcome && settings->project && !mg_project_drift(c)) outcome = MG_NO_EXTREMUM;
  outcome = mg_explain_failed_outcome(c, outcome);
  if (mg_start_fallback(c, outcome, events)) return mg_begin_time_stepping(c);
  if (outcome) return outcome;
  if (!mg_place_all_contacts(c, run->t, run->x)) return MG_NO_EXTREMUM;
  mg_evaluate_run_state(c);
  mg_update_diagnostics(c);
  return MG_DONE;
}

MG_API int mg_begin(const mg_system *system, const mg_settings *settings, mg_run *run, mg_events *events, mg_real *work,
                    int *iwork) {
  mg_context c;
  mg_open_context(&c, system, settings, run, work, iwork);
  const int outcome = mg_begin_run(&c, events);
  return outcome && mg_is_stopped(&c) ? MG_CONTINUE : outcome;
}
