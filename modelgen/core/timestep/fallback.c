/* Fallback of an event-driven run on time-stepping for a while: where events accumulate at one time or cost too much,
   where steps become too small to advance, where a contact is found too late or is too near to a singularity, or where
   no accelerations are admissible, as in Painleve's paradox, but impulses are. Writes run->fallback_left and what
   belongs to it, modes, patches and events of the run. */
#include "timestep/timestep.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/integrate.h"
#include "features/features.h"
#include "patch/patch.h"
#include "impact/impact.h"
#include "events/events.h"

enum {
  MG_FALLBACK_STEPS = 8,      /* steps of a fallback */
  MG_FALLBACK_DOUBLINGS = 12, /* most doublings of that number */
  MG_FOLLOWING_STEPS = 2,     /* steps that follow a penetration and remove it */
  MG_STALLED_TRIES = 250,     /* tries after which a run that hardly moves is stalled */
  MG_PROGRESS_TRIES = 2000    /* tries after which progress is checked */
};

MG_INTERNAL mg_real mg_next_step(const mg_context *c) {
  if (c->settings->method == MG_TIME_STEPPING) return c->settings->step;
  return c->run->fallback_left > 0 ? c->run->fallback_step : c->run->h;
}

MG_INTERNAL int mg_is_fallback_outcome(int outcome) {
  return outcome == MG_TOO_MANY_EVENTS || outcome == MG_COMPLEMENTARITY || outcome == MG_NO_FRICTION ||
         outcome == MG_STEP_TOO_SMALL || outcome == MG_CHATTER || outcome == MG_PENETRATED || outcome == MG_MARGIN;
}

/* True if time-stepping may pass what ends the run by this outcome: not closest points that are not isolated, which no
   contact can follow, nor those of a pair whose searches are given up. */
static int mg_can_fallback_pass(const mg_context *c, int outcome) {
  const int contact = c->run->report.failed_contact;
  if (!mg_is_fallback_outcome(outcome)) return 0;
  if (outcome != MG_MARGIN && outcome != MG_PENETRATED) return 1;
  if (contact < 0 || c->run->withheld_effort[c->system->contact_pair[contact]] > 0) return 0;
  return outcome == MG_PENETRATED || mg_is_on_feature_pair(c, contact);
}

/* True if a closed contact has friction. */
static int mg_has_sticking_friction(const mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact && c->system->n_friction; i = mg_next_row(c, i))
    if (c->run->closed[i] && c->system->contact_friction[i + 1] > c->system->contact_friction[i]) return 1;
  return 0;
}

MG_INTERNAL int mg_is_progress_too_slow(mg_context *c) {
  mg_run *run = c->run;
  const long tries = run->steps + run->rejected - run->progress_tries, refused = run->rejected - run->progress_rejected;
  const mg_real way = run->t - run->progress_t, least = c->settings->fallback_progress * c->system->time;
  const int is_stalled = tries >= MG_STALLED_TRIES && 10000 * way < least;
  if (tries < MG_PROGRESS_TRIES && !is_stalled) return 0;
  const int is_too_slow = way < least && (is_stalled || 3 * refused > tries || 100 * way < least ||
                                          (10 * way < least && mg_has_sticking_friction(c)));
  run->progress_tries += tries, run->progress_rejected = run->rejected, run->progress_t = run->t;
  return is_too_slow;
}

/* First closed contact, or 0. */
static int mg_first_closed_contact(const mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->run->closed[i]) return i;
  return 0;
}

/* Releases all patches, which time-stepping does not know, and restores the contacts that they covered. Needs the
   poses at run->x. */
static void mg_release_patches(mg_context *c) {
  MG_NEEDS_AT_RUN(c, MG_VALID_POSES);
  mg_minima found;
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    const int patch = mg_patch_of_slot(c, slot);
    if (patch < 0) continue;
    mg_release_patch(c, slot);
    mg_restore_covered_contacts(c, patch, &found);
  }
}

/* Steps of a fallback by this outcome: one characteristic time in place of costly events, and the doublings. */
static long mg_fallback_steps(const mg_context *c, int outcome) {
  const long least = outcome == MG_CHATTER ? (long)ceil(1 / c->settings->chatter_step) : MG_FALLBACK_STEPS;
  return least << c->run->fallback_doublings;
}

/* Span after a fallback, s, within which another one by this outcome follows soon. */
static mg_real mg_fallback_recovery(const mg_context *c, int outcome) {
  const mg_settings *s = c->settings;
  return outcome == MG_CHATTER ? c->system->time
                               : (MG_FALLBACK_STEPS * s->fallback_step + s->fallback_progress) * c->system->time;
}

/* True if a fallback has ended so short a time ago that another one by this outcome is due to the same place. */
static int mg_follows_fallback(const mg_context *c, int outcome) {
  const mg_run *run = c->run;
  return run->present_cause && run->t - run->fallback_end <= mg_fallback_recovery(c, outcome);
}

MG_INTERNAL int mg_outcome_after_fallback(const mg_context *c, int outcome) {
  const int is_found_late = outcome == MG_PENETRATED && c->run->present_cause == MG_MARGIN;
  return is_found_late && mg_follows_fallback(c, outcome) ? MG_MARGIN : outcome;
}

MG_INTERNAL int mg_start_fallback(mg_context *c, int outcome, mg_events *events) {
  mg_run *run = c->run;
  const int again = run->present_cause == outcome && mg_follows_fallback(c, outcome);
  if (!c->settings->fallback || mg_is_time_stepping(c) || !mg_can_fallback_pass(c, outcome) || mg_is_stopped(c))
    return 0;
  if (again && outcome == MG_MARGIN) return 0; /* it is no passing neighbourhood of a singularity */
  mg_report_failed_contact(run, -1);
  run->fallback_doublings = again ? run->fallback_doublings + (run->fallback_doublings < MG_FALLBACK_DOUBLINGS) : 0;
  run->fallback_step =
      (outcome == MG_CHATTER ? c->settings->chatter_step : c->settings->fallback_step) * c->system->time;
  run->fallback_left = (mg_real)mg_fallback_steps(c, outcome) * run->fallback_step;
  run->fallback_transitions = 0, run->friction_redundant = 0;
  run->present_cause = outcome, run->event_work_t = run->t;
  mg_report_fallback(run, outcome);
  mg_append_event(c, events, run->t, MG_EVENT_FALLBACK_START, mg_first_closed_contact(c), 0);
  mg_update_poses(c, run->t, run->x);
  mg_release_patches(c);
  mg_recall_time_step(c);
  return 1;
}

/* Projects the closed contacts to d = 0 and d_dot = 0; the change of the kinetic energy counts as work, as that of an
   impact. Returns an outcome. */
static int mg_resume_event_driven(mg_context *c) {
  mg_run *run = c->run;
  mg_real before, after;
  mg_energy(c, &before);
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    mg_set_active(c, i, 0), c->events.triggered[i] = 0;
  for (int g = mg_next_constraint(c, -1); g < c->system->n_friction; g = mg_next_constraint(c, g))
    mg_set_friction_mode(c, g, MG_FRICTION_OFF), c->friction.mode_before[g] = MG_FRICTION_OFF,
                                                 c->friction.triggered[g] = 0, c->friction.slip_time_left[g] = 0;
  mg_evaluate_run_state(c);
  mg_open_separating(c);
  if (!mg_has_closed_contact_capacity(c)) return MG_TOO_MANY_CLOSED;
  if (c->settings->project && !mg_project_drift(c)) return MG_NOT_FINITE;
  mg_energy(c, &after);
  run->x[c->layout.work_state] += after - before;
  return MG_DONE;
}

/* Prolongs a fallback at whose end bodies penetrate where no contact follows, or events would again cost too much;
   returns whether it does. */
static int mg_prolong_fallback(mg_context *c) {
  mg_run *run = c->run;
  if (mg_request_penetration_searches(c)) {
    run->fallback_left = MG_FOLLOWING_STEPS * run->fallback_step;
    return 1;
  }
  if (run->present_cause != MG_CHATTER) return 0;
  const long steps = mg_fallback_steps(c, MG_CHATTER);
  if (!mg_would_chatter(c, run->fallback_transitions, steps)) return 0;
  run->fallback_left = (mg_real)steps * run->fallback_step, run->fallback_transitions = 0;
  return 1;
}

MG_INTERNAL int mg_count_fallback_step(mg_context *c, mg_events *events, int first_event, mg_real h) {
  mg_run *run = c->run;
  if (c->settings->method == MG_TIME_STEPPING) return MG_DONE;
  run->fallback_transitions += mg_count_transitions(events, first_event);
  run->fallback_left -= h;
  if (run->fallback_left > run->fallback_step / 2 || mg_prolong_fallback(c)) return MG_DONE;
  run->fallback_left = 0;
  run->fallback_end = run->t, run->events_at_t = 0, run->h = mg_first_step(c);
  if (run->present_cause == MG_CHATTER) mg_grant_event_work(c);
  run->event_work_t = run->t;
  int outcome = mg_resume_event_driven(c);
  if (!outcome) outcome = mg_resolve_impacts(c, events);
  if (!outcome) outcome = mg_solve_contact_modes(c, events);
  if (!outcome && c->settings->project && !mg_project_drift(c)) outcome = MG_NOT_FINITE;
  if (!outcome) mg_append_event(c, events, run->t, MG_EVENT_FALLBACK_END, mg_first_closed_contact(c), 0);
  return outcome;
}
