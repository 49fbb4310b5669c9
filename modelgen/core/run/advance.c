/* The loop of a run (mg_advance): take a step, search it for events, accept the state, project drift, change
   modes, update diagnostics. Writes the state of the run, samples and events. */
#include "run/run.h"
#include "base/base.h"
#include "model/model.h"
#include "closest/closest.h"
#include "forces/forces.h"
#include "integrate/integrate.h"
#include "features/features.h"
#include "events/events.h"
#include "timestep/timestep.h"

/* Tries steps from *h down until one is accurate enough; *h then is its length, and run->h the next to try.
   Returns an outcome. */
static int mg_take_accurate_step(mg_context *c, mg_real *h) {
  mg_run *run = c->run;
  const mg_real growth = c->settings->step_fraction < 1 ? MG_COMPANION_STEP_GROWTH : MG_STEP_GROWTH;
  mg_real most = growth;
  c->step.rolling_step = 0;
  for (;;) {
    const mg_real error = mg_try_step(c, run->t, run->x, *h);
    const int finite = mg_are_states_finite(c, c->step.end) && error <= MG_MAX;
    if (finite && error <= 1) {
      c->step.error = error;
      const mg_real next = *h * mg_step_growth(error, most);
      if (c->settings->method == MG_RK4) return MG_DONE;
      if (mg_has_slip_onset(c)) run->h = next < c->step.slip_limit ? next : c->step.slip_limit;
      else if (next > run->h || *h >= run->h || most < growth) run->h = next;
      return MG_DONE;
    }
    run->rejected++;
    if (c->settings->method == MG_RK4) return MG_NOT_FINITE;
    most = 1;
    *h *= finite ? mg_step_growth(error, most) : MG_NONFINITE_STEP_CUT;
    run->h = *h;
    if (*h < c->settings->step_min * c->system->time) return finite ? MG_STEP_TOO_SMALL : MG_NOT_FINITE;
  }
}

/* Makes c->step.settled the state of the run. */
static void mg_accept_state(mg_context *c, mg_real h) {
  mg_note_pressure_starts(c);
  mg_copy_states(c, c->step.settled, c->run->x);
  mg_advance_time(c->run, h);
  c->run->steps++;
  mg_update_rolling_starts(c);
  mg_finish_slip_onsets(c), mg_forget_stiff_slip(c);
}

/* Evaluates the right-hand side at the new state, and projects drift if it is due. An evaluation at an event is part of
   the cost of that. Returns an outcome. */
static int mg_control_drift(mg_context *c, int event) {
  if (!mg_are_states_finite(c, c->run->x)) return MG_NOT_FINITE;
  if (event) mg_evaluate_run_state(c);
  else mg_evaluate_accepted_state(c);
  if (c->step.follower) c->step.follower->settle(c, c->step.follower->of);
  if (!c->settings->project || ++c->run->since_projection < c->settings->project) return MG_DONE;
  c->run->since_projection = 0;
  return mg_project_drift(c) ? MG_DONE : MG_NOT_FINITE;
}

/* Largest error of a step, over the size of the states, that may be common to run and companion: those of 256 steps
   are no larger than the roundings of these. */
#define MG_COMMON_ERROR (MG_EPS / 16)

/* True if the first share of the step h just tried is one that a companion (step_fraction < 1) must not take, because
   it may have it in common with its run, whose error it so would not show: it begins at an event, and a step from one
   event to the next is the same at any tolerance. Not so a step that another event ends at once, nor one of DOP853,
   whose error is of order 8, where that is below rounding. */
static int mg_is_common_step(const mg_context *c, mg_real h, mg_real share) {
  if (!(c->settings->step_fraction < 1) || c->run->t != c->run->t_event) return 0;
  if (share * h <= c->settings->event_tolerance * c->system->time) return 0;
  if (c->settings->method != MG_DOP853 || mg_is_collocated(c)) return 1;
  const mg_real square = share * share, fourth = square * square;
  return fourth * fourth * c->step.error * c->settings->tolerance > MG_COMMON_ERROR;
}

/* True if slip is collocated in this step, so that its length depends on the tolerance unless an event ends it. */
static int mg_has_collocated_slip(const mg_context *c) { return mg_is_collocated(c) && !mg_has_rolling_start(c); }

/* Replaces the step h by its first part, of the length `part`, s. Returns an outcome. */
static int mg_take_step_part(mg_context *c, mg_real *h, mg_real part) {
  const mg_real share = part / *h;
  *h = part;
  int outcome = MG_DONE;
  if (mg_has_rolling_start(c)) mg_restrict_step(c, c->run->x, share);
  else {
    mg_evaluate_run_state(c);
    outcome = mg_take_accurate_step(c, h);
  }
  if (!outcome) mg_finish_step(c, c->run->t, *h);
  return outcome;
}

/* Longest step in which no contact can pass unseen, s. */
static mg_real mg_longest_step(const mg_context *c) {
  const mg_real reach = mg_penetration_step_limit(c),
                search_limit = mg_has_rolling_start(c) ? MG_MAX : mg_search_step_limit(c),
                opening_limit = mg_patch_opening_step_limit(c),
                slip_limit = c->system->n_friction ? mg_patch_slip_step_limit(c) : MG_MAX;
  const mg_real seen = mg_min(mg_min(search_limit, reach), mg_near_pair_step_limit(c));
  return c->settings->step_fraction * mg_min(mg_min(seen, opening_limit), slip_limit);
}

/* Length of the step to the first event within the step h just tried, or 0; leaves the interpolant where there may
   be one. Where run and companion have that step in common, *in_part is 1, and the length that of a step which ends
   before the event. */
static mg_real mg_first_event_in_step(mg_context *c, mg_real h, int *in_part) {
  mg_real low, high;
  const int dips = mg_mark_gap_minima(c, h), triggered = mg_mark_triggered_events(c, c->step.end),
            hidden = !triggered && !c->step.sign_changed && mg_has_possible_hidden_event(c);
  const int passed = triggered || c->step.sign_changed || hidden || dips == MG_GAP_OSCILLATES;
  *in_part = 0;
  if (!passed && !dips) return 0;
  mg_make_interpolant(c, c->run->t, c->run->x, h);
  if (!mg_bracket_first_event(c, h, passed, &low, &high)) return 0;
  const mg_real before = mg_is_common_step(c, h, high) ? mg_share_before_event(c, h, low, high) : 0;
  *in_part = before > 0;
  return *in_part ? h * before : mg_locate_bracketed_event(c, h, low, high);
}

/* Ends a collocated step that is longer than `end`; returns whether it was. */
static int mg_shorten_collocated_step(mg_context *c, mg_real *h, mg_real end) {
  if (*h <= end) return 0;
  mg_restrict_step(c, c->run->x, end / *h);
  *h = end;
  return 1;
}

/* Accepts the step h, and what happens at its end. Returns an outcome. */
static int mg_finish_accepted_step(mg_context *c, mg_real h, int event, mg_record *record, mg_events *events) {
  mg_record_until(c, record, h, event);
  mg_accept_state(c, h);
  int outcome = mg_control_drift(c, event);
  if (outcome) return outcome;
  if (event && mg_follow_touching_minima(c, events, h)) mg_evaluate_run_state(c);
  if (event) outcome = mg_change_mode(c, events);
  else if (mg_is_active_set_outdated(c)) {
    mg_clear_triggered_events(c);
    outcome = mg_solve_contact_modes(c, events);
  }
  if (!outcome && mg_search_all_pairs(c, events, h, 0)) mg_evaluate_run_state(c);
  mg_update_diagnostics(c);
  if (!outcome) outcome = mg_cross_singular_contacts(c, record, events);
  if (!outcome && !c->events.passage.is_paused) outcome = mg_check_margins(c, events);
  if (!outcome) outcome = mg_check_penetration(c, 0);
  if (!outcome) outcome = mg_check_contact_rows(c);
  return !outcome && mg_is_progress_too_slow(c) ? MG_STEP_TOO_SMALL : outcome;
}

/* One accepted step of at most h, ended by the first event within it; or none, and a smaller run->h to try. A
   first step from flat is tried at the full length of run->h, because rounding spoils a short one, and is cut on
   its interpolant. Returns an outcome. */
static int mg_event_driven_step(mg_context *c, mg_real h, mg_record *record, mg_events *events) {
  mg_run *run = c->run;
  const mg_real end = h;
  if (mg_choose_near_pairs(c, h, 0, c->settings->method == MG_RK4)) mg_evaluate_run_state(c);
  if (mg_are_too_many_near(run)) return MG_TOO_MANY_NEAR;
  const mg_real longest = mg_longest_step(c);
  if (mg_has_rolling_start(c)) h = run->h;
  if (c->settings->method == MG_DOP853) h = mg_time_function_step_limit(c, h > longest ? longest : h);
  mg_real before, after;
  const int has_jump = mg_find_velocity_jump(c, h, &before, &after);
  if (has_jump && before - run->t <= c->settings->event_tolerance * c->system->time)
    return mg_cross_velocity_jump(c, after, events);
  if (has_jump) h = before - run->t;
  c->search.n_abandoned = 0;
  MG_NEEDS_AT_RUN(c, MG_VALID_POSES);
  mg_copy_reals(c->step.start_pose, c->bodies.pose, 12 * c->system->n_body);
  mg_store_gaps(c);
  mg_mark_contacts_within_border(c);
  if (c->system->n_friction) mg_begin_step_friction(c), mg_begin_step_patch_friction(c);
  if (c->settings->method == MG_DOP853) mg_mark_stiff_slip(c, h);
  mg_sample_margins_at_start(c);
  int outcome = mg_take_accurate_step(c, &h);
  if (outcome) return outcome;
  mg_finish_step(c, run->t, h);
  if (c->step.beyond_margin || mg_has_moved_beyond_margins(c)) mg_forget_margins(c), c->step.beyond_margin = 1;
  if (c->step.beyond_margin || mg_has_unresolved_state_load(c, h)) return mg_reject_step(c, h);
  int in_part;
  mg_real shorter = mg_first_event_in_step(c, h, &in_part);
  if (!(shorter > 0) && mg_has_missed_event(c, h)) return mg_reject_step(c, h);
  if (!(shorter > 0) && !mg_has_collocated_slip(c) && mg_is_common_step(c, h, 1))
    in_part = 1, shorter = c->settings->step_fraction * mg_min(h, end);
  int event = shorter > 0 && !in_part;
  if (event) h = shorter;
  else if (in_part) outcome = mg_take_step_part(c, &h, shorter);
  if (outcome) return outcome;
  event &= !mg_shorten_collocated_step(c, &h, end);
  if (mg_has_contact_point_leapt(c, h) || !mg_place_step_end(c, h)) return mg_reject_step(c, h);
  if (h > c->settings->event_tolerance * c->system->time && mg_has_new_penetration(c, h)) return mg_reject_step(c, h);
  if (mg_is_stopped(c)) return MG_CONTINUE; /* its searches may have no result */
  return mg_finish_accepted_step(c, h, event, record, events);
}

/* One step of the method, or of time-stepping during a fallback. Returns an outcome. */
static int mg_advance_step(mg_context *c, mg_real h, mg_record *record, mg_events *events) {
  const int first_event = events->count;
  const long rejected = c->run->rejected, cells = c->run->search_effort;
  const mg_real t = c->run->t;
  int outcome;
  c->step.work = 0, c->step.mode_choices = 0;
  if (mg_is_time_stepping(c)) {
    outcome = mg_time_step(c, h, record, events);
    if (!outcome) outcome = mg_count_fallback_step(c, events, first_event, c->run->t - t);
  } else {
    mg_credit_event_work(c);
    outcome = mg_cross_infinite_load(c, mg_event_driven_step(c, h, record, events), events);
    if (!outcome && mg_has_costly_events(c, c->run->rejected - rejected, c->run->search_effort - cells))
      outcome = MG_CHATTER;
  }
  if (outcome && mg_is_stopped(c)) return outcome;
  outcome = mg_outcome_after_fallback(c, mg_explain_failed_outcome(c, outcome));
  return mg_start_fallback(c, outcome, events) ? MG_DONE : outcome;
}

/* True if the list has room for the events of a step. */
static int mg_has_event_room(const mg_context *c, const mg_events *events) {
  return events->count + 4 * c->system->n_contact + 2 * c->system->n_switch + 2 <= events->capacity;
}

/* True if a step of length h ends at t_stop, which is `left` away: it reaches it, or leaves less than the resolution of
   time. */
static int mg_ends_at_stop(const mg_context *c, mg_real h, mg_real left) {
  const mg_real resolution = c->settings->event_tolerance * c->system->time;
  return h >= left - resolution - 8 * MG_EPS * (left + fabs(c->step.stop_time));
}

/* Evaluates the state at which a call begins; it was counted when it was accepted. */
static void mg_evaluate_known_state(mg_context *c) {
  const long evaluations = c->run->rhs_evals;
  mg_evaluate_run_state(c);
  c->run->rhs_evals = evaluations;
}

MG_INTERNAL int mg_advance_followed(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real t_stop,
                                    long max_steps, mg_record *record, mg_events *events, mg_follower *follower,
                                    mg_real *work, int *iwork) {
  mg_context c;
  mg_open_context(&c, system, settings, run, work, iwork);
  c.step.stop_time = t_stop, c.step.follower = follower;
  if (mg_is_time_stepping(&c)) mg_recall_time_step(&c);
  else if (mg_has_new_inputs(&c)) mg_update_poses(&c, run->t, run->x); /* evaluated where they take effect */
  else mg_evaluate_known_state(&c);
  if (!mg_has_event_room(&c, events)) return MG_LIST_FULL;
  const int refused = mg_apply_inputs(&c, events);
  if (refused) return refused;
  if (!(run->h > 0)) run->h = mg_first_step(&c);
  const int is_sampled = mg_is_sample_due(record, run->t);
  mg_record_next_forces(&c, record);
  mg_record_now(&c, record);
  if (is_sampled && mg_is_time_stepping(&c)) mg_recall_time_step(&c);
  for (long step = 0; run->t < t_stop; step++) {
    if (step >= max_steps || mg_is_stopped(&c)) return MG_CONTINUE;
    if (run->steps_max > 0 && run->steps + run->rejected > run->steps_max) return MG_TOO_COSTLY;
    if (!mg_has_event_room(&c, events)) return MG_LIST_FULL;
    if (follower) follower->begin(&c, follower->of);
    const int is_passage_due = run->is_passage_due && !mg_is_time_stepping(&c);
    run->is_passage_due = 0;
    if (is_passage_due) {
      const int resumed = mg_cross_singular_contacts(&c, record, events);
      if (resumed || run->t >= t_stop) return resumed;
    }
    const mg_real left = t_stop - run->t - run->t_roundoff;
    const mg_real h = mg_next_step(&c);
    const int last = mg_ends_at_stop(&c, h, left);
    const int outcome = mg_advance_step(&c, last ? left : h, record, events);
    if (outcome) return mg_is_stopped(&c) ? MG_CONTINUE : outcome;
    const int reached = last && t_stop - run->t - run->t_roundoff <= 8 * MG_EPS * left;
    run->progress_tries += reached && left < h; /* a step that t_stop has cut does not count as slow progress */
    if (reached) run->t = t_stop, run->t_roundoff = 0;
    mg_record_now(&c, record);
    if (follower && !follower->end(&c, follower->of)) return run->t < t_stop ? MG_CONTINUE : MG_DONE;
  }
  return MG_DONE;
}

MG_API int mg_advance(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real t_stop, long max_steps,
                      mg_record *record, mg_events *events, mg_real *work, int *iwork) {
  return mg_advance_followed(system, settings, run, t_stop, max_steps, record, events, 0, work, iwork);
}
