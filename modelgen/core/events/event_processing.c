/* The order in which the events of one time are processed: patches end, contacts change their features, gaps close,
   impacts, contact modes. Writes the closed set of the run, its state through impacts, and the event list. */
#include "events/events.h"
#include "model/model.h"
#include "closest/closest.h"
#include "forces/forces.h"
#include "features/features.h"
#include "patch/patch.h"
#include "impact/impact.h"

#define MG_JUST_CLOSED 2 /* mark in c->events.triggered: the contact has just closed */

/* Count the events within one event tolerance of time; true if there are more than allowed. */
static int mg_has_too_many_events(mg_context *c) {
  mg_run *run = c->run;
  if (run->t - run->t_event > c->settings->event_tolerance * c->system->time) run->events_at_t = 0;
  run->t_event = run->t;
  return ++run->events_at_t > c->settings->events_at_once_max;
}

MG_INTERNAL int mg_has_closed_contact_capacity(const mg_context *c) {
  int n = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) n += c->run->closed[i] != 0;
  return mg_is_room_for_closed(c, n);
}

MG_INTERNAL void mg_open_separated_contacts(mg_context *c, mg_events *events) {
  const mg_real far = c->settings->start_gap * c->system->length,
                rest = c->settings->rest_speed * c->system->length / c->system->time;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (c->run->closed[i] && (c->rows.d[i] > far || c->rows.d_dot[i] > rest))
      mg_apply_contact_transition(c, events, i, MG_LIFTS_OFF, c->run->t, 0);
}

/* True if the contact will pass a border of its feature pair before its gap is deeper than start_gap, so that it does
   not strike there; writes the condition of that border. Needs the slope at the run's state. */
static int mg_is_about_to_leave_feature_pair(mg_context *c, int contact) {
  MG_NEEDS_AT_RUN(c, MG_VALID_SLOPE);
  const int feature_pair = c->run->feature_pair[contact];
  const mg_real soon = sqrt(sqrt(c->settings->event_tolerance)) * c->system->time,
                moment = sqrt(c->settings->event_tolerance) * c->system->time;
  const mg_real deep = c->settings->start_gap * c->system->length;
  mg_real *x = c->step.stage, next[6];
  if (mg_is_unconditional_feature_pair(c, feature_pair)) return 0;
  mg_place_contact(c, contact, mg_contact_eta(c, c->run->x, contact), next);
  const mg_real now = mg_most_violated_condition(c, feature_pair, mg_contact_eta(c, c->run->x, contact),
                                                 c->events.broken_condition + contact);
  mg_extrapolate_poses(c);
  mg_place_contact(c, contact, mg_contact_eta(c, x, contact), next);
  const mg_real then =
      mg_most_violated_condition(c, feature_pair, mg_contact_eta(c, x, contact), c->events.broken_condition + contact);
  mg_update_poses(c, c->run->t, c->run->x);
  if (now <= c->settings->search_merge_distance) return then < -c->settings->feature_border;
  const mg_real left = then < now ? moment * now / (now - then) : MG_MAX;
  return left < soon && left * fabs(c->rows.d_dot[contact]) < deep;
}

/* Clear the mark of contacts that seemed to leave their feature pair only by the integration error of eta or pose: on
   the extremum they are well within it. */
static void mg_cancel_spurious_feature_pair_exits(mg_context *c) {
  mg_real eta[6];
  int which;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    if (c->events.triggered[i] != MG_LEAVES_FEATURE) continue;
    for (int k = 0; k < c->contacts.n_eta[i]; k++) eta[k] = mg_contact_eta(c, c->run->x, i)[k];
    if (mg_newton_on_feature_pair(c, i, eta) >= 0 &&
        mg_most_violated_condition(c, c->run->feature_pair[i], eta, &which) > c->settings->feature_border)
      c->events.triggered[i] = 0;
  }
}

/* True for an open contact whose gap has just closed, or is within tolerance and approaching. */
static int mg_is_gap_closing(const mg_context *c, int contact) {
  if (c->run->closed[contact]) return 0;
  return c->events.triggered[contact] ||
         (fabs(c->rows.d[contact]) <= c->settings->contact_gap * c->system->length && mg_is_approaching(c, contact));
}

/* True for an open contact that touches, within the resolution of event times, and does not separate, of a circle of
   which another contact has just closed. */
static int mg_is_circle_closing(const mg_context *c, int contact) {
  const int pair = c->system->contact_pair[contact], feature_pair = c->run->feature_pair[contact];
  if (c->run->closed[contact] || feature_pair < 0 || !mg_is_part_of_circle(c, feature_pair)) return 0;
  const mg_real moment = c->settings->event_tolerance * c->system->time, approach = -c->rows.d_dot[contact];
  if (approach < 0 || fabs(c->rows.d[contact]) > c->settings->contact_gap * c->system->length + moment * approach)
    return 0;
  for (int i = mg_pair_first_contact(c, pair); i < mg_pair_first_contact(c, pair + 1); i++)
    if (c->events.triggered[i] == MG_JUST_CLOSED && mg_is_part_of_circle(c, c->run->feature_pair[i])) return 1;
  return 0;
}

/* The first closed contact of the circle that a closed contact is a part of; of no circle: itself. */
static int mg_first_of_circle(const mg_context *c, int contact) {
  if (!mg_is_part_of_circle(c, c->run->feature_pair[contact])) return contact;
  int i = mg_pair_first_contact(c, c->system->contact_pair[contact]);
  while (!c->run->closed[i] || !mg_is_part_of_circle(c, c->run->feature_pair[i])) i++;
  return i;
}

/* Close an open contact. */
static void mg_close_gap(mg_context *c, mg_events *events, int contact) {
  mg_note_flush_blow(c, contact);
  mg_apply_contact_transition(c, events, contact, MG_IMPACT_INELASTIC, c->run->t, 0);
  c->events.triggered[contact] = MG_JUST_CLOSED;
}

/* True if another feature pair lies behind the border that a contact is about to pass. */
static int mg_has_feature_pair_behind(const mg_context *c, int contact) {
  return c->system->condition_feature_pair[c->events.broken_condition[contact]] >= 0;
}

/* Mark open contacts whose gap closes while they leave their feature pair: they change feature instead of striking. At
   a concave edge no feature pair follows, and they strike. */
static void mg_mark_exits_before_impact(mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (c->events.triggered[i] <= 1 && mg_is_on_feature_pair(c, i) && mg_is_gap_closing(c, i) &&
        mg_is_about_to_leave_feature_pair(c, i) && mg_has_feature_pair_behind(c, i))
      c->events.triggered[i] = MG_LEAVES_FEATURE;
}

/* Process all triggered events at the run's state: end patches, change features, close gaps, resolve impacts and
   choose new contact modes. Needs the rows at the run's state. */
static int mg_process_contact_events(mg_context *c, mg_events *events) {
  MG_NEEDS_AT_RUN(c, MG_VALID_ROWS);
  if (mg_has_too_many_events(c)) return MG_TOO_MANY_EVENTS;
  if (mg_end_patches(c, events)) mg_evaluate_run_state(c);
  mg_cancel_spurious_feature_pair_exits(c);
  mg_mark_exits_before_impact(c);
  if (mg_change_marked_features(c, events)) {
    mg_evaluate_run_state(c);
    mg_open_separated_contacts(c, events);
  }
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (mg_is_gap_closing(c, i)) mg_close_gap(c, events, i);
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (mg_is_circle_closing(c, i)) mg_close_gap(c, events, i);
  if (!mg_has_closed_contact_capacity(c)) return MG_TOO_MANY_CLOSED;
  const int outcome = mg_resolve_impacts(c, events);
  if (outcome) return outcome;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) {
    if (c->events.triggered[i] != MG_JUST_CLOSED) continue;
    c->events.triggered[i] = 0;
    if (c->run->closed[i])
      mg_apply_contact_transition(c, events, i, MG_TOUCHES_DOWN,
                                  c->run->t + mg_remaining_bounce_time(c, mg_first_of_circle(c, i)),
                                  mg_max(0, -c->rows.d_dot[i]));
  }
  const int settled = mg_solve_contact_modes(c, events);
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) c->patches.barred[slot] = -1;
  return settled;
}

MG_INTERNAL void mg_open_separating(mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->run->closed[i] && c->rows.d_dot[i] > c->settings->rest_speed * c->system->length / c->system->time)
      mg_set_closed(c, i, 0);
}

MG_INTERNAL int mg_change_mode(mg_context *c, mg_events *events) {
  const int outcome = mg_process_contact_events(c, events);
  if (outcome || !c->settings->project) return outcome;
  const int lifts = mg_largest_held_violation(c, c->rows.d) > c->settings->feature_border * c->system->length;
  mg_real kinetic;
  const mg_real before = lifts ? mg_energy(c, &kinetic) : 0;
  if (!mg_project_drift(c)) return MG_NOT_FINITE;
  if (lifts) c->run->x[c->layout.work_state] += mg_energy(c, &kinetic) - before;
  return MG_DONE;
}
