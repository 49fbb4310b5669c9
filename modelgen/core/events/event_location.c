/* Which event functions have fired at a state, and when the first of them fires within a step. */
#include "events/events.h"
#include "model/model.h"
#include "closest/closest.h"
#include "forces/forces.h"
#include "integrate/integrate.h"

#define MG_EVENT_CORRECTIONS 8 /* of the time of an event at most */

#define MG_EVENT_COARSE_PART 1e-6 /* of a step: an event alone is found so near before its zero is sought */

typedef struct { /* an event: its function and the rate of that where it was seen; the time of a step to try first */
  int contact, cause;
  mg_real value, slope, start;
} mg_crossing;

static mg_real mg_speed_scale(const mg_context *c) { return c->system->length / c->system->time; }

static int mg_held(const mg_context *c, int contact) { return c->run->closed[contact] && !c->run->active[contact]; }

/* Whether the contact leaves its link at the state x (MG_LEAVES_FEATURE), or passes a watched border
   (MG_PASSES_BORDER); which condition says so is in c->events.broken_condition. */
MG_INTERNAL int mg_leaves_link_at(mg_context *c, int contact, mg_real *x) {
  const int link = c->run->link[contact];
  if (link < 0 || c->run->fresh[contact] || mg_is_unconditional_link(c, link) || mg_is_distant_flat_link(c, contact))
    return 0;
  const mg_real *eta = mg_contact_eta(c, x, contact);
  mg_place_contact(c, contact, eta, c->search.placement + 32);
  if (mg_most_violated_condition(c, link, eta, c->events.broken_condition + contact) < -c->settings->border)
    return MG_LEAVES_FEATURE;
  const int touching = !c->run->closed[contact] && c->d[contact] < c->settings->start_gap * c->system->length;
  if (!c->events.within_border[contact] || touching) return 0;
  return mg_least_link_condition(c, link, eta, 1, c->events.broken_condition + contact) < -c->settings->border
             ? MG_PASSES_BORDER
             : 0;
}

/* The least of the watched conditions of a contact at a state, and which it is; needs the poses there. */
static mg_real mg_watched(mg_context *c, int contact, mg_real *x, int *which) {
  const mg_real *eta = mg_contact_eta(c, x, contact);
  mg_place_contact(c, contact, eta, c->search.placement + 32);
  return mg_least_link_condition(c, c->run->link[contact], eta, 1, which);
}

/* A contact on a watched border comes back from it in a moment. Needs the slope in K[0]. */
static int mg_comes_back(mg_context *c, int contact, mg_real now) {
  int which;
  mg_extrapolate_poses(c);
  const mg_real then = mg_watched(c, contact, c->step.stage, &which);
  mg_update_poses(c, c->run->t, c->run->x);
  return then > now;
}

/* Notes which contacts, closed or nearly, have not passed a watched border; beyond it other contacts may begin at any
   time. Needs the poses of run->x. */
MG_INTERNAL void mg_mark_within_borders(mg_context *c) {
  int which;
  for (int i = 0; i < c->system->n_contact; i++) {
    const int link = c->run->link[i], near = c->run->closed[i] || c->d[i] < c->settings->search * c->system->length;
    const int tipped = c->events.within_border[i] == MG_PASSES_BORDER;
    c->events.within_border[i] = 0;
    if (link < 0 || !near || mg_is_unconditional_link(c, link)) continue;
    const mg_real value = mg_watched(c, i, c->run->x, &which);
    if (which < 0) continue;
    const int there = tipped && (value < 0 || !c->run->closed[i]);
    c->events.within_border[i] = value >= -c->settings->border && (!there || mg_comes_back(c, i, value));
    if (!c->events.within_border[i])
      c->run->moved[c->system->contact_pair[i]] = MG_MAX / 2; /* searched at the end of the step */
  }
}

/* After mg_rhs and mg_gap_rates at x: a contact that leaves its link, an open gap that closes, an active force that
   turns to pulling, a gap held without force that accelerates. */
MG_INTERNAL int mg_trigger_events(mg_context *c, mg_real *x) {
  const mg_real deep = -c->settings->gap * c->system->length, rest = -c->settings->rest_speed * mg_speed_scale(c);
  int count = mg_trigger_patches(c);
  for (int i = 0; i < c->support_begin; i++) {
    if (mg_held(c, i))
      c->events.triggered[i] = fabs(mg_gap_acceleration(c, i)) > c->settings->leave * mg_rest_acceleration(c);
    else if (c->run->closed[i]) c->events.triggered[i] = c->force[i] < -mg_rest_acceleration(c) * c->system->mass;
    else c->events.triggered[i] = (c->d[i] < 0 && c->d_dot[i] < rest) || (c->d[i] < deep && c->d_dot[i] < 0);
    const int leaves = mg_leaves_link_at(c, i, x);
    if (leaves == MG_LEAVES_FEATURE || (leaves && (c->run->closed[i] || !c->events.triggered[i])))
      c->events.triggered[i] = leaves;
    count += c->events.triggered[i] != 0;
  }
  return c->system->n_grip ? count + mg_trigger_friction(c) : count;
}

MG_INTERNAL int mg_trigger_events_at(mg_context *c, mg_real h, mg_real theta) {
  mg_interpolate(c, c->run->x, theta, c->step.stage);
  mg_normalise_quaternions(c, c->step.stage);
  mg_rhs(c, c->run->t + theta * h, c->step.stage, c->step.slopes + 16 * c->n_states);
  mg_gap_rates(c);
  return mg_trigger_events(c, c->step.stage);
}

static int mg_first_fired(const mg_context *c) {
  for (int i = 0; i < c->system->n_contact; i++)
    if (c->events.triggered[i]) return i;
  return -1;
}

/* Events are told by contact; those of grips follow. */
static int mg_first_event(const mg_context *c) {
  const int first = mg_first_fired(c), grip = first < 0 && c->system->n_grip ? mg_first_triggered_grip(c) : -1;
  return grip < 0 ? first : c->system->n_contact + grip;
}

static int mg_is_grip(const mg_context *c, int event) { return event >= c->system->n_contact; }

/* The condition that a walking contact passed, with eta of the state x on the extremum. */
static mg_real mg_border_value(mg_context *c, int contact, const mg_real *x) {
  mg_real next[6], beyond[6];
  mg_place_contact(c, contact, x + (mg_contact_eta(c, c->run->x, contact) - c->run->x), next);
  mg_place_contact(c, contact, next, beyond);
  return mg_link_condition(c, c->run->link[contact], c->events.broken_condition[contact], next);
}

/* The function whose zero is the event; `cause` as in c->events.triggered where the contact leaves its link, or a patch
 * ends. */
static mg_real mg_event_value(mg_context *c, int contact, int cause, const mg_real *x) {
  const int grip = contact - c->system->n_contact;
  if (grip >= 0) return mg_friction_event_value(c, mg_grip_contact(c, grip), grip);
  if (mg_is_support_point(c, contact)) return mg_patch_event_value(c, contact, cause);
  if (cause) return mg_border_value(c, contact, x);
  return c->run->closed[contact] ? c->force[contact] : c->d[contact];
}

/* The first of what has fired at theta, its function there and the rate of that; 0 if nothing has. Needs the state
   there, and leaves another. */
static int mg_tell_event(mg_context *c, mg_real h, mg_real theta, mg_crossing *event) {
  const int contact = mg_first_event(c), grip = mg_is_grip(c, contact);
  if (contact < 0) return 0;
  const int way = grip ? 0 : c->events.broken_condition[contact],
            cause = !grip && c->events.triggered[contact] >= MG_LEAVES_FEATURE ? c->events.triggered[contact] : 0;
  event->contact = contact, event->cause = cause, event->slope = 0;
  if (!grip && mg_held(c, contact) && !cause) return 1;
  event->value = mg_event_value(c, contact, cause, c->step.stage), event->slope = grip ? 0 : c->d_dot[contact];
  if (!grip && !c->run->closed[contact] && !cause) return 1;
  const mg_real step = theta > (mg_real)0.01 ? (mg_real)0.01 : theta / 2;
  mg_trigger_events_at(c, h, theta - step);
  if (!grip) c->events.broken_condition[contact] = way;
  event->slope = (event->value - mg_event_value(c, contact, cause, c->step.stage)) / (step * h);
  return 1;
}

/* The state at the end of a step h within the one that was tried: by its polynomial, or by a step of its own. */
static void mg_go_to(mg_context *c, mg_real h, mg_real tried, int collocated) {
  c->step.sign_changed = 1;
  if (collocated) mg_interpolate(c, c->run->x, h / tried, c->step.end);
  else mg_take_step(c, c->run->t, c->run->x, h);
  mg_finish_step(c, c->run->t, h);
}

/* The event found on the interpolant, its time corrected by the slope of the event function, which is that of the last
   two steps once they differ. Where rounding hides the zero it is taken before it: bounces lose energy. Where
   corrections do not shrink, fast beyond what the interpolant may err, as at a jump of the loads, the event is where it
   was found. */
static mg_real mg_event_step(mg_context *c, mg_crossing event, mg_real tried, int collocated) {
  const mg_real close = c->settings->event * c->system->time, reach = tried * c->settings->polish,
                noise = tried * (mg_real)MG_EVENT_COARSE_PART;
  mg_real h = event.start, moved = 0, first = MG_MAX, change = MG_MAX, old = 0;
  for (int round = 1;; round++) {
    mg_go_to(c, h, tried, collocated);
    const mg_real value = mg_event_value(c, event.contact, event.cause, c->step.end), before = fabs(change);
    if (round > 1 && fabs(value) < fabs(old) / 2) event.slope = (value - old) / change;
    change = event.slope != 0 ? -value / event.slope : 0, old = value, moved += change;
    if (round == 1) first = fabs(change);
    else if (fabs(change) > (fabs(moved) > reach ? before / 4 : first > noise ? first : noise)) break;
    if (fabs(change) <= close || round == MG_EVENT_CORRECTIONS) return h;
    if (h + change <= 0 || h + change > tried) return h;
    const int hidden = round > 2 && fabs(change) > before / 2;
    if (hidden && change > 0) return h;
    h += change;
    if (!hidden && (round == 1 || fabs(change) * (fabs(change) / before) > close)) continue;
    mg_go_to(c, h, tried, collocated);
    return h;
  }
  mg_go_to(c, event.start, tried, collocated);
  return event.start;
}

/* An open contact passes a watched border: there its pair is searched, beyond it, and no more happens. */
static int mg_only_looks(const mg_context *c, const mg_crossing *event) {
  return event->cause == MG_PASSES_BORDER && !c->run->closed[event->contact];
}

/* Steps again to an event. */
static mg_real mg_polish(mg_context *c, const mg_crossing *event, mg_real tried) {
  const int collocated = mg_is_collocated(c);
  const int looks = mg_only_looks(c, event);
  const mg_real h = looks ? event->start : mg_event_step(c, *event, tried, collocated);
  if (looks) mg_go_to(c, h, tried, collocated);
  if (collocated) mg_restrict_step(c, c->run->x, h / tried);
  return h;
}

/* Where within a part of the step h a gap that shrinks and grows again is low enough for an event of its own; 0 when it
   nowhere is. */
static mg_real mg_dip(mg_context *c, int contact, mg_real h, mg_real low, mg_real high) {
  for (int j = 0; j < 50; j++) {
    const mg_real middle = (low + high) / 2;
    mg_trigger_events_at(c, h, middle);
    if (c->events.triggered[contact]) return middle;
    if (c->d[contact] > fabs(c->d_dot[contact]) * (high - low) * h) return 0;
    if (c->d_dot[contact] < 0) low = middle;
    else high = middle;
  }
  return 0;
}

/* The first of the marked dips within a part of the step h; 0 when there is none. */
static mg_real mg_first_dip(mg_context *c, mg_real h, mg_real low, mg_real high) {
  mg_real first = 0;
  for (int i = 0; i < c->support_begin; i++) {
    const mg_real dip = c->events.gap_dips[i] ? mg_dip(c, i, h, low, first > 0 ? first : high) : 0;
    if (dip > 0) first = dip;
  }
  return first;
}

/* The first of the parts of the step h at whose end an event has fired, or within which a gap dips, or what is left
   before an event: from *low to where that is, which is returned; 0 when there is none. Needs the gaps and what is left
   noted at the start of the step. */
static mg_real mg_scan(mg_context *c, mg_real h, mg_real *low) {
  const mg_real part = (mg_real)1 / c->settings->scan;
  for (int j = 1; j <= c->settings->scan; j++) {
    const mg_real at = (mg_real)j / c->settings->scan;
    const int fired = mg_trigger_events_at(c, h, at), dips = mg_mark_gap_dips(c, part * h);
    mg_note_gaps(c);
    mg_sample_margins(c, j % MG_MARGIN_SAMPLES);
    const mg_real strain = j > 1 ? mg_first_hidden_event(c, h, j - 1, j + 1, part, low) : 0;
    if (strain > 0) return strain;
    *low = at - part;
    const mg_real dip = dips ? mg_first_dip(c, h, *low, at) : 0;
    if (dip > 0) return dip;
    if (fired) return at;
  }
  return mg_first_hidden_event(c, h, c->settings->scan, c->settings->scan + 1, part, low);
}

/* Halves the part of the step h up to *high, where an event has fired, until it is no longer than `width`; returns how
   many have there. Forces that are found by iteration may tell otherwise when asked again near a zero: then, as far as
   they do not. */
static int mg_narrow(mg_context *c, mg_real h, mg_real *low, mg_real *high, mg_real width) {
  const mg_real last = *high;
  for (int j = 0; j < 60 && *high - *low > width; j++) {
    const mg_real middle = (*low + *high) / 2;
    if (mg_trigger_events_at(c, h, middle)) *high = middle;
    else *low = middle;
  }
  int count = mg_trigger_events_at(c, h, *high);
  for (mg_real back = *high - *low; !count && *high < last; back *= 2) {
    *low = *high, *high = fmin(*high + back, last);
    count = mg_trigger_events_at(c, h, *high);
  }
  return count;
}

/* What fires at theta, or, if nothing does when asked again, what did. */
static void mg_fire_again(mg_context *c, mg_real h, mg_real theta, const mg_crossing *event) {
  if (!mg_trigger_events_at(c, h, theta) && !mg_is_grip(c, event->contact))
    c->events.triggered[event->contact] = event->cause ? event->cause : 1;
}

/* An event alone, whose function is nearly straight from `low` to `high`: its zero needs no further halving. That of a
   bounce which is over within them is not. */
static int mg_is_plain(mg_context *c, mg_crossing *event, int count, mg_real h, mg_real low, mg_real high) {
  const mg_real back = event->slope != 0 ? event->value / event->slope : MG_MAX;
  event->start = high * h;
  if (count > 1 || !(back >= 0 && back <= 4 * (mg_real)MG_EVENT_COARSE_PART * h && back < event->start)) return 0;
  const int way = c->events.broken_condition[event->contact];
  mg_trigger_events_at(c, h, low);
  c->events.broken_condition[event->contact] = way;
  const mg_real before = mg_event_value(c, event->contact, event->cause, c->step.stage);
  const mg_real straight = (event->value - before) / ((high - low) * h * event->slope);
  if (!(straight > (mg_real)0.75 && straight < (mg_real)1.5)) return 0;
  event->start -= back;
  return 1;
}

/* The step to the first event within the step h just tried, its end state in c->step.end and its contacts in
   c->events.triggered; 0 when none fires. `passed`: one was seen at a stage or at the end, or a gap may turn more than
   once. Needs the interpolant, and the dips of the step marked. */
MG_INTERNAL mg_real mg_locate_event(mg_context *c, mg_real h, int passed) {
  mg_real low = 0, high = passed ? mg_scan(c, h, &low) : mg_first_dip(c, h, 0, 1);
  if (high == 0) return 0;
  const mg_real width = c->settings->event * c->system->time / h, nearly = (mg_real)MG_EVENT_COARSE_PART;
  mg_crossing event, finer;
  const int count = mg_narrow(c, h, &low, &high, width > nearly ? width : nearly);
  if (!mg_tell_event(c, h, high, &event)) return 0;
  if (mg_only_looks(c, &event) || !mg_is_plain(c, &event, count, h, low, high)) {
    mg_narrow(c, h, &low, &high, width);
    if (mg_tell_event(c, h, high, &finer)) event = finer;
    event.start = high * h;
  }
  mg_fire_again(c, h, high, &event);
  return mg_polish(c, &event, h);
}
