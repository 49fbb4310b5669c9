/* Event location: when the first event function triggers within a step. The step is scanned on the interpolant, the
   bracket bisected and the time refined on steps of their own. Reads the interpolant; writes event marks and the end of
   the step, but no mode. */
#include "events/events.h"
#include "model/model.h"
#include "closest/closest.h"
#include "forces/forces.h"
#include "integrate/integrate.h"

#define MG_EVENT_CORRECTIONS 8 /* most corrections of the time of an event */

#define MG_EVENT_COARSE_PART                                                              \
  1e-6 /* part of the step to which a single event is bracketed before its zero is sought \
        */

/* An event: its function and the rate of this where it was seen; the time in the step to try first. */ typedef struct {
  int contact, cause;
  mg_real value, slope, start;
} mg_located_event;

/* First contact whose event has triggered, or -1. */
static int mg_first_triggered_contact(const mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->events.triggered[i]) return i;
  return -1;
}

/* Number of the first triggered event, or -1: contacts first, then friction constraints, switching functions. */
static int mg_first_triggered_event(const mg_context *c) {
  const int first = mg_first_triggered_contact(c),
            constraint = first < 0 && c->system->n_friction ? mg_first_friction_event(c) : -1,
            of_load = first < 0 && constraint < 0 ? mg_first_switch_event(c) : -1;
  if (of_load >= 0) return c->system->n_contact + c->system->n_friction + of_load;
  return constraint < 0 ? first : c->system->n_contact + constraint;
}

/* True if the event number is that of a contact, not of a friction constraint or a switching function. */
static int mg_is_contact_event(const mg_context *c, int event) { return event < c->system->n_contact; }

/* True if the event number is that of a switching function of a load. */
static int mg_is_load_event(const mg_context *c, int event) {
  return event >= c->system->n_contact + c->system->n_friction;
}

/* Condition that the contact passes when it leaves its feature pair, with eta of the state x corrected to the extremum.
 */
static mg_real mg_feature_pair_exit_value(mg_context *c, int contact, const mg_real *x) {
  mg_real next[6], beyond[6];
  mg_place_contact(c, contact, x + (mg_contact_eta(c, c->run->x, contact) - c->run->x), next);
  mg_place_contact(c, contact, next, beyond);
  return mg_feature_pair_condition(c, c->run->feature_pair[contact], c->events.broken_condition[contact], next);
}

/* Event function at the state x; `cause` as marked where the contact leaves its feature pair or a patch ends, else 0.
 */
static mg_real mg_event_value(mg_context *c, int contact, int cause, const mg_real *x) {
  const int constraint = contact - c->system->n_contact;
  if (mg_is_load_event(c, contact)) return mg_switch_event_value(c, constraint - c->system->n_friction);
  if (constraint >= 0) return mg_friction_event_value(c, mg_contact_of_friction(c, constraint), constraint);
  if (mg_is_support_contact(c, contact)) return mg_patch_event_value(c, contact, cause);
  if (cause) return mg_feature_pair_exit_value(c, contact, x);
  return c->run->closed[contact] ? c->solution.force[contact] : c->rows.d[contact];
}

/* Describe the first triggered event at theta: its event function and rate; returns 0 if none has triggered.
   Needs the state there, and leaves another. */
static int mg_describe_first_event(mg_context *c, mg_real h, mg_real theta, mg_located_event *event) {
  MG_NEEDS_AT(c, MG_VALID_FORCES, c->step.stage);
  const int contact = mg_first_triggered_event(c), is_of_contact = mg_is_contact_event(c, contact);
  if (contact < 0) return 0;
  const int way = is_of_contact ? c->events.broken_condition[contact] : 0,
            cause =
                is_of_contact && c->events.triggered[contact] >= MG_LEAVES_FEATURE ? c->events.triggered[contact] : 0;
  event->contact = contact, event->cause = cause, event->slope = 0;
  if (is_of_contact && mg_is_closed_without_force(c, contact) && !cause) return 1;
  event->value = mg_event_value(c, contact, cause, c->step.stage),
  event->slope = is_of_contact ? c->rows.d_dot[contact] : 0;
  if (is_of_contact && !c->run->closed[contact] && !cause) return 1;
  const mg_real step = theta > (mg_real)0.01 ? (mg_real)0.01 : theta / 2;
  mg_mark_triggered_events_at(c, h, theta - step);
  if (is_of_contact) c->events.broken_condition[contact] = way;
  event->slope = (event->value - mg_event_value(c, contact, cause, c->step.stage)) / (step * h);
  return 1;
}

/* Compute the end of a shorter step h: on the collocation polynomial, or by a new explicit step. */
static void mg_recompute_step_end(mg_context *c, mg_real h, mg_real tried, int collocated) {
  c->step.sign_changed = 1;
  if (collocated) mg_interpolate(c, c->run->x, h / tried, c->step.end);
  else mg_take_step(c, c->run->t, c->run->x, h);
  mg_finish_step(c, c->run->t, h);
}

/* Refine the time of an event by secant corrections on steps of their own; returns the step. The zero is taken
   from before where rounding hides it, because a bounce must lose energy; that of a switching function is corrected
   once more, because its side decides. Where corrections do not shrink, as at a jump of the loads, the time found on
   the interpolant is kept. */
static mg_real mg_refine_event_time(mg_context *c, mg_located_event event, mg_real tried, int collocated) {
  const mg_real time_tolerance = c->settings->event_tolerance * c->system->time,
                correction_limit = tried * c->settings->event_correction_step,
                noise = tried * (mg_real)MG_EVENT_COARSE_PART;
  mg_real h = event.start, total_correction = 0, first_correction = MG_MAX, correction = MG_MAX, previous_value = 0;
  for (int round = 1;; round++) {
    mg_recompute_step_end(c, h, tried, collocated);
    const mg_real value = mg_event_value(c, event.contact, event.cause, c->step.end),
                  previous_correction = fabs(correction);
    if (round > 1 && fabs(value) < fabs(previous_value) / 2) event.slope = (value - previous_value) / correction;
    correction = event.slope != 0 ? -value / event.slope : 0, previous_value = value, total_correction += correction;
    if (round == 1) first_correction = fabs(correction);
    else if (fabs(correction) > (fabs(total_correction) > correction_limit ? previous_correction / 4
                                 : first_correction > noise                ? first_correction
                                                                           : noise))
      break;
    const int is_last = fabs(correction) <= time_tolerance || round == MG_EVENT_CORRECTIONS;
    if (is_last && !mg_is_load_event(c, event.contact)) return h;
    if (h + correction <= 0 || h + correction > tried) return h;
    const int stalled = round > 2 && fabs(correction) > previous_correction / 2;
    if (stalled && correction > 0) return h;
    h += correction;
    if (!is_last && !stalled &&
        (round == 1 || fabs(correction) * (fabs(correction) / previous_correction) > time_tolerance))
      continue;
    mg_recompute_step_end(c, h, tried, collocated);
    return h;
  }
  mg_recompute_step_end(c, event.start, tried, collocated);
  return event.start;
}

/* True if the event only requests a search: an open contact passes a watched border. */
static int mg_is_search_only_event(const mg_context *c, const mg_located_event *event) {
  return event->cause == MG_PASSES_BORDER && !c->run->closed[event->contact];
}

/* Repeat the step up to the event; returns its length. */
static mg_real mg_step_to_event(mg_context *c, const mg_located_event *event, mg_real tried) {
  const int collocated = mg_is_collocated(c);
  const int search_only = mg_is_search_only_event(c, event);
  const mg_real h = search_only ? event->start : mg_refine_event_time(c, *event, tried, collocated);
  if (search_only) mg_recompute_step_end(c, h, tried, collocated);
  if (collocated) mg_restrict_step(c, c->run->x, h / tried);
  return h;
}

/* Time within a part of the step at which a gap that shrinks and grows again is low enough for an event, as a
   share of the step; 0 if it nowhere is. */
static mg_real mg_find_gap_minimum_event(mg_context *c, int contact, mg_real h, mg_real low, mg_real high) {
  mg_real least = MG_MAX, at = 1;
  for (int j = 0; j < 50; j++) {
    const mg_real middle = (low + high) / 2;
    mg_mark_triggered_events_at(c, h, middle);
    if (c->events.triggered[contact]) return middle;
    if (c->rows.d[contact] < least) least = c->rows.d[contact], at = middle;
    if (c->rows.d[contact] > fabs(c->rows.d_dot[contact]) * (high - low) * h) break;
    if (c->rows.d_dot[contact] < 0) low = middle;
    else high = middle;
  }
  if (c->step.follower && least <= c->settings->start_gap * c->system->length)
    c->step.follower->grazed = contact, c->step.follower->grazed_part = at;
  return 0;
}

/* First event of all gaps marked with a minimum within a part of the step, as a share of the step; 0 if there is
   none. */
static mg_real mg_first_gap_minimum_event(mg_context *c, mg_real h, mg_real low, mg_real high) {
  mg_real earliest = 0;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    const mg_real candidate =
        c->events.gap_dips[i] ? mg_find_gap_minimum_event(c, i, h, low, earliest > 0 ? earliest : high) : 0;
    if (candidate > 0) earliest = candidate;
  }
  return earliest;
}

/* Scan the step in equal parts for the first that contains an event; returns its end as a share of the step and
   its start in *low, 0 if there is none. Needs gaps and event margins stored at the start of the step. */
static mg_real mg_scan_step_for_events(mg_context *c, mg_real h, mg_real *low) {
  MG_NEEDS_AT_RUN(c, MG_VALID_KEPT_GAPS), MG_NEEDS_AT_RUN(c, MG_VALID_MARGINS);
  const mg_real part = (mg_real)1 / c->settings->event_scan_parts;
  for (int j = 1; j <= c->settings->event_scan_parts; j++) {
    const mg_real at = (mg_real)j / c->settings->event_scan_parts;
    const int triggered = mg_mark_triggered_events_at(c, h, at), dips = mg_mark_gap_minima(c, part * h);
    mg_store_gaps(c);
    mg_sample_event_margins(c, j % MG_MARGIN_SAMPLES);
    const mg_real hidden_event = j > 1 ? mg_first_hidden_event(c, h, j - 1, j + 1, part, low) : 0;
    if (hidden_event > 0) return hidden_event;
    *low = at - part;
    const mg_real dip = dips ? mg_first_gap_minimum_event(c, h, *low, at) : 0;
    if (dip > 0) return dip;
    if (triggered) return at;
  }
  return mg_first_hidden_event(c, h, c->settings->event_scan_parts, c->settings->event_scan_parts + 1, part, low);
}

/* Bisect the bracket of an event to `width`; returns how many events have triggered at its end. Forces found by
   iteration may differ when evaluated again near a zero; then the bracket is widened again until the event has
   triggered. */
static int mg_bisect_event_bracket(mg_context *c, mg_real h, mg_real *low, mg_real *high, mg_real width) {
  const mg_real bracket_end = *high;
  for (int j = 0; j < 60 && *high - *low > width; j++) {
    const mg_real middle = (*low + *high) / 2;
    if (mg_mark_triggered_events_at(c, h, middle)) *high = middle;
    else *low = middle;
  }
  int count = mg_mark_triggered_events_at(c, h, *high);
  for (mg_real extension = *high - *low; !count && *high < bracket_end; extension *= 2) {
    *low = *high, *high = mg_min(*high + extension, bracket_end);
    count = mg_mark_triggered_events_at(c, h, *high);
  }
  return count;
}

/* Mark the events at theta again; if none triggers this time, restore the mark of the event that did. */
static void mg_restore_event_mark(mg_context *c, mg_real h, mg_real theta, const mg_located_event *event) {
  if (mg_mark_triggered_events_at(c, h, theta)) return;
  if (mg_is_load_event(c, event->contact))
    c->switches.triggered[event->contact - c->system->n_contact - c->system->n_friction] = 1;
  else if (mg_is_contact_event(c, event->contact))
    c->events.triggered[event->contact] = event->cause ? event->cause : 1;
}

/* True if a single event function is nearly linear in the bracket, so that no further bisection is needed; sets
   the time to start from. */
static int mg_is_event_nearly_linear(mg_context *c, mg_located_event *event, int count, mg_real h, mg_real low,
                                     mg_real high) {
  const mg_real correction = event->slope != 0 ? event->value / event->slope : MG_MAX;
  event->start = high * h;
  if (count > 1 ||
      !(correction >= 0 && correction <= 4 * (mg_real)MG_EVENT_COARSE_PART * h && correction < event->start))
    return 0;
  const int is_of_contact = mg_is_contact_event(c, event->contact),
            way = is_of_contact ? c->events.broken_condition[event->contact] : 0;
  mg_mark_triggered_events_at(c, h, low);
  if (is_of_contact) c->events.broken_condition[event->contact] = way;
  const mg_real before = mg_event_value(c, event->contact, event->cause, c->step.stage);
  const mg_real slope_ratio = (event->value - before) / ((high - low) * h * event->slope);
  if (!(slope_ratio > (mg_real)0.75 && slope_ratio < (mg_real)1.5)) return 0;
  event->start -= correction;
  return 1;
}

MG_INTERNAL int mg_bracket_first_event(mg_context *c, mg_real h, int passed, mg_real *low, mg_real *high) {
  MG_NEEDS(c, MG_VALID_GAP_MINIMA, c->run->t + h, c->step.end);
  MG_NEEDS_DIGEST(c, MG_VALID_INTERPOLANT, mg_step_digest(c, c->run->t, c->run->x, h));
  *low = 0;
  *high = passed ? mg_scan_step_for_events(c, h, low) : mg_first_gap_minimum_event(c, h, 0, 1);
  return *high > 0;
}

MG_INTERNAL mg_real mg_share_before_event(mg_context *c, mg_real h, mg_real low, mg_real high) {
  const mg_real resolution = c->settings->event_tolerance * c->system->time / h;
  while (low < high / 2) {
    const mg_real middle = (low + high) / 2;
    if (!mg_mark_triggered_events_at(c, h, middle)) low = middle;
    else if (middle > resolution) high = middle;
    else return 0;
  }
  return mg_min(low, c->settings->step_fraction * high);
}

MG_INTERNAL mg_real mg_locate_bracketed_event(mg_context *c, mg_real h, mg_real low, mg_real high) {
  const mg_real width = c->settings->event_tolerance * c->system->time / h,
                coarse_width = (mg_real)MG_EVENT_COARSE_PART;
  mg_located_event event, finer;
  const int count = mg_bisect_event_bracket(c, h, &low, &high, width > coarse_width ? width : coarse_width);
  if (!mg_describe_first_event(c, h, high, &event)) return 0;
  if (mg_is_search_only_event(c, &event) || !mg_is_event_nearly_linear(c, &event, count, h, low, high)) {
    mg_bisect_event_bracket(c, h, &low, &high, width);
    if (mg_describe_first_event(c, h, high, &finer)) event = finer;
    event.start = high * h;
  }
  mg_restore_event_mark(c, h, high, &event);
  return mg_step_to_event(c, &event, h);
}
