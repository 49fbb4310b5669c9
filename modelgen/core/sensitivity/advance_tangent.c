/* Derivatives of a run (mg_begin_tangent, mg_advance_tangent): the run goes on step by step as without them; after each
   accepted step the derivatives are carried over it, from a copy of the run before. Writes the mg_tangent. */
#include <string.h>

#include "run/run.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/integrate.h"
#include "timestep/timestep.h"
#include "sensitivity/sensitivity.h"

/* Most numbers of a packed vector. */
static long mg_packed_size(const mg_system *s) {
  return 64L + s->n_eta + s->n_parameters + 3L * s->n_input + 24L * s->n_body + 2L * s->n_pair + 6L * s->n_joint +
         s->kernels->n_sensor;
}

/* Rows of all constraints but springs. */
static long mg_sensitivity_rows(const mg_system *s) { return s->n_contact + 1L + s->n_joint_row + s->n_friction_row; }

MG_API long mg_sensitivity_size(const mg_system *s, int n) {
  const long states = (long)s->n_q + s->n_u + s->n_eta + 1;
  return 2 * mg_count_reals(mg_save_size(s), 1) + mg_count_reals(1, sizeof(mg_blow)) + 36L * s->n_body +
         4 * mg_sensitivity_rows(s) + s->n_friction_row + (12L * (n ? n : 1) + 2 * n + 3) * states +
         3 * mg_packed_size(s) + 18 + s->n_switch + n + MG_CROSSINGS * (n + 1L) + s->n_friction + s->n_patch_slot +
         2L * s->n_pair + 6L * s->n_joint + 12L * s->n_load + 6L * s->n_patch_slot + mg_packed_size(s) +
         10L * s->kernels->n_sensor;
}

MG_API long mg_sensitivity_int_size(const mg_system *s) {
  return s->n_body + 3L * s->n_contact + 2L * ((long)s->n_friction + s->n_patch_slot) + 2L * s->kernels->n_sensor;
}

/* Ends the step that derivatives have been carried over: writes it to the tape, if there is one. */
static void mg_keep_step(const mg_system *system, mg_sensitivity *s) {
  mg_tape *tape = s->tangent->tape;
  mg_followed_step *step = &s->step;
  unsigned char *const stored = step->before;
  if (tape) {
    const long size = mg_save_size(system), k = tape->count++;
    int *at = tape->crossing + MG_TAPE_CROSSING * k;
    memcpy(tape->bytes + k * size, step->before, (size_t)size);
    memcpy(tape->bytes + (k + 1) * size, step->after, (size_t)size);
    *at++ = s->n_crossing;
    for (const mg_crossing *each = s->crossings; each < s->crossings + s->n_crossing; each++) {
      *at++ = each->kind, *at++ = each->contact, *at++ = each->constraint;
      *at++ = each->blow, *at++ = each->reason, *at++ = each->island;
    }
  }
  step->before = step->after, step->after = stored, step->is_stored = step->is_carried = 1;
}

/* Length of the step that the run has taken, s. */
static mg_real mg_length_of_step(const mg_run *run, const mg_followed_step *step) {
  return run->t - step->t + (run->t_roundoff - step->roundoff);
}

static void mg_begin_followed_step(mg_context *c, void *of) {
  mg_sensitivity *s = of;
  mg_followed_step *step = &s->step;
  const mg_run *run = c->run;
  if (!step->is_stored) mg_store_run(c->system, run, step->before);
  memcpy(s->start, s->tangent->x, (size_t)s->directions->n * (size_t)c->layout.n_states * sizeof(mg_real));
  mg_note_loads(c, s, run->t);
  s->follower.h = 0, s->follower.grazed = -1, s->follower.grazed_part = 1;
  step->is_stored = step->is_settled = step->is_carried = 0, step->begun++;
  step->n_event = step->events->count, step->n_record = step->record->count;
  step->n_differentiated = s->tangent->count;
  step->t = run->t, step->roundoff = run->t_roundoff, step->steps = run->steps;
  step->passages = run->report.singular_passages, step->fallbacks = run->report.fallbacks + run->report.chatters;
}

/* Notes a reason for a verdict; the first of the worst verdict stays. */
static void mg_note_verdict(mg_tangent *tangent, int verdict, int reason, mg_real t, int contact) {
  if (verdict <= tangent->verdict) return;
  tangent->verdict = verdict, tangent->reason = reason, tangent->reason_t = t, tangent->reason_contact = contact;
}

/* Notes a reason why no derivative is certain. */
static void mg_doubt_tangent(const mg_sensitivity *s, int reason, mg_real t, int contact) {
  if (!reason) return;
  mg_note_verdict(s->tangent, MG_VERDICT_UNDECIDED, reason, t, contact);
  for (int j = 0; j < s->directions->n && s->tangent->sides; j++) s->tangent->sides[j] |= MG_SIDE_UNKNOWN;
}

/* Notes a reason why the derivative along a direction holds for changes in `sides` alone. */
static void mg_keep_sides_of(const mg_sensitivity *s, int direction, int sides, int reason, mg_real t, int contact) {
  mg_tangent *tangent = s->tangent;
  int *kept = tangent->sides ? tangent->sides + direction : 0;
  if (!reason) return;
  if (kept) *kept = mg_common_sides(*kept, sides);
  const int holds = kept && *kept && *kept <= MG_SIDES;
  mg_note_verdict(tangent, holds ? MG_VERDICT_ONE_SIDED : MG_VERDICT_UNDECIDED, reason, t, contact);
}

/* True if the derivative along some direction may still hold for changes to some side. */
static int mg_holds_somewhere(const mg_sensitivity *s) {
  const mg_tangent *tangent = s->tangent;
  if (s->is_lost || tangent->is_lost) return 0;
  if (tangent->verdict != MG_VERDICT_UNDECIDED) return 1;
  for (int j = 0; j < s->directions->n && tangent->sides; j++)
    if (tangent->sides[j] && tangent->sides[j] <= MG_SIDES) return 1;
  return 0;
}

/* Notes for which changes the run keeps its branch where it is on a kink at (t, x), at which c is evaluated. */
static void mg_note_kinks(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x, int when) {
  if (!mg_mark_kinks(c, s, t, when)) return;
  mg_gather_wrenches(c, s, t);
  for (int j = 0; j < s->directions->n; j++) {
    const int reason = mg_leave_kinks(c, s, j, t, x, when);
    mg_keep_sides_of(s, j, s->sides, reason, t, s->doubtful);
  }
  s->doubtful = -1;
}

/* Notes for which changes a gap that has all but closed, at the time `before` before t, stays open. */
static void mg_note_graze(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x, int contact, mg_real before) {
  mg_gather_wrenches(c, s, t);
  for (int j = 0; j < s->directions->n; j++) {
    const int then = mg_opening_of(c, s, j, t, x, contact, before), now = mg_opening_of(c, s, j, t, x, contact, 0);
    const int sides = then * now < 0 ? MG_SIDE_UNKNOWN : then > 0 ? MG_SIDE_LARGER : MG_SIDE_SMALLER;
    if (then || now) mg_keep_sides_of(s, j, then ? sides : MG_SIDE_UNKNOWN, MG_BY_GRAZE, t, contact);
  }
}

/* Notes whether the run has stayed on a kink in a step to (t, x), at which c is evaluated, or a gap has all but closed.
 */
static void mg_doubt_step(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x) {
  const int grazed = s->follower.grazed;
  if (!mg_holds_somewhere(s)) return;
  mg_note_kinks(c, s, t, x, MG_AFTER_STEP);
  if (grazed >= 0 && mg_is_on_feature_pair(c, grazed))
    mg_note_graze(c, s, t, x, grazed, (t - s->step.t) * (1 - s->follower.grazed_part));
}

static void mg_settle_step(mg_context *c, void *of) {
  mg_sensitivity *s = of;
  s->step.is_settled = mg_settle_followed_step(c, s, mg_length_of_step(c->run, &s->step));
  if (s->step.is_settled) mg_doubt_step(c, s, c->run->t, c->run->x);
}

/* True if the run has neither moved on nor changed. */
static int mg_is_step_rejected(const mg_run *run, const mg_followed_step *step) {
  return run->steps == step->steps && run->t == step->t && step->events->count == step->n_event;
}

/* Returns 0 where derivatives are still to be carried over the step, or there is no room on the tape for another. */
static int mg_end_followed_step(mg_context *c, void *of) {
  mg_sensitivity *s = of;
  mg_followed_step *step = &s->step;
  const mg_run *run = c->run;
  if (mg_is_step_rejected(run, step)) return step->is_carried = 1;
  if (!step->is_settled || step->events->count != step->n_event || run->report.singular_passages != step->passages ||
      run->report.fallbacks + run->report.chatters != step->fallbacks)
    return 0;
  mg_forget_crossings(s);
  mg_store_run(c->system, run, step->after);
  mg_keep_step(c->system, s);
  return !s->tangent->tape || s->tangent->tape->count < s->tangent->tape->capacity;
}

MG_INTERNAL void mg_open_sensitivity(const mg_context *c, mg_sensitivity *s, int n, mg_real *work, int *iwork) {
  const mg_system *system = c->system;
  const long b = system->n_body, rows = mg_sensitivity_rows(system), states = c->layout.n_states;
  MG_FORGET_TANGENTS(s);
  mg_forget_crossings(s);
  s->is_time = s->is_at_event = s->is_singular = s->is_lost = 0, s->t_bar = 0, s->doubtful = -1;
  s->follower = (mg_follower){
      s, 0, 0, -1, 1, mg_follow_stage, mg_followed_error, mg_begin_followed_step, mg_settle_step, mg_end_followed_step};
  s->blow = mg_take_memory(&work, 1, sizeof(mg_blow));
  s->at.pose = mg_take_reals(&work, 12 * b), s->at.twist = mg_take_reals(&work, 6 * b);
  s->at.acceleration = mg_take_reals(&work, 6 * b), s->at.wrench = mg_take_reals(&work, 6 * b);
  s->at.value = mg_take_reals(&work, rows), s->at.rate = mg_take_reals(&work, rows);
  s->at.residual = mg_take_reals(&work, rows), s->at.force = mg_take_reals(&work, rows);
  s->at.ratio = mg_take_reals(&work, system->n_friction_row);
  s->at.tangents = mg_take_reals(&work, 6L * system->n_patch_slot);
  s->wrench = mg_take_reals(&work, 6 * b), s->slopes = mg_take_reals(&work, 12L * (n ? n : 1) * states);
  s->stage = mg_take_reals(&work, states), s->before = mg_take_reals(&work, states);
  s->slope_before = mg_take_reals(&work, states);
  s->x = mg_take_reals(&work, mg_packed_size(system)), s->x_dot = mg_take_reals(&work, mg_packed_size(system));
  s->y_dot = mg_take_reals(&work, mg_packed_size(system)), s->weights = mg_take_reals(&work, 18L + system->n_switch);
  s->end = mg_take_reals(&work, n * states), s->size = mg_take_reals(&work, n);
  s->event_rate = s->event_rates = mg_take_reals(&work, MG_CROSSINGS * (n + 1L));
  s->slip = mg_take_reals(&work, system->n_friction + system->n_patch_slot);
  s->pair = mg_take_reals(&work, 2L * system->n_pair), s->joint = mg_take_reals(&work, 6L * system->n_joint);
  s->load = mg_take_reals(&work, 12L * system->n_load);
  s->closed_before = mg_take_ints(&iwork, system->n_contact);
  s->slip_begins = mg_take_ints(&iwork, system->n_friction + system->n_patch_slot);
  s->on_kink = mg_take_ints(&iwork, system->n_contact + system->n_friction + system->n_patch_slot);
  s->reasons = mg_take_ints(&iwork, system->kernels->n_sensor);
  s->sensor_sides = mg_take_ints(&iwork, system->kernels->n_sensor);
  s->held = mg_take_ints(&iwork, system->n_contact);
  s->island = mg_take_ints(&iwork, system->n_body);
  s->moved = mg_take_reals(&work, mg_packed_size(system)),
  s->shown = mg_take_reals(&work, 10L * system->kernels->n_sensor);
}

/* Opens the memory of derivatives along directions; the bytes of the run before and after a step come first. */
static void mg_open_tangent(const mg_context *c, mg_sensitivity *s, const mg_directions *directions,
                            mg_tangent *tangent) {
  mg_real *work = tangent->work;
  memset(&s->step, 0, sizeof(s->step));
  s->step.before = mg_take_memory(&work, mg_save_size(c->system), 1);
  s->step.after = mg_take_memory(&work, mg_save_size(c->system), 1);
  s->directions = directions, s->tangent = tangent, s->adjoint = 0;
  s->start = mg_take_reals(&work, (long)directions->n * c->layout.n_states);
  mg_open_sensitivity(c, s, directions->n, work, tangent->iwork);
  for (int j = 0; j < directions->n; j++) s->size[j] = mg_direction_size(c, s, j);
}

static void mg_fill_reals(mg_real *to, long n, mg_real value) {
  for (long i = 0; i < n; i++) to[i] = value;
}

/* Derivatives that are lost are zeros while the run goes on, and NaN for the caller. */
static void mg_show_lost_tangents(const mg_directions *directions, mg_tangent *tangent, int n_states, int shown) {
  if (tangent->is_lost) mg_fill_reals(tangent->x, (long)directions->n * n_states, shown ? (mg_real)NAN : 0);
}

/* Gives the derivatives up from here on, where something is not differentiated. */
static void mg_lose_tangents(mg_sensitivity *s, int n_states) {
  mg_tangent *tangent = s->tangent;
  if (!s->is_lost || tangent->is_lost) return;
  tangent->is_lost = 1;
  if (tangent->tape) tangent->tape->lost = tangent->tape->count + 1;
  mg_show_lost_tangents(s->directions, tangent, n_states, 0);
}

/* Notes for which changes of a start the run keeps its branch: open contacts that touch, and loads at a jump. */
static void mg_doubt_start(mg_context *c, mg_sensitivity *s) {
  const mg_run *run = c->run;
  const mg_real touching = c->settings->contact_gap * c->system->length,
                slow = c->settings->rest_speed * c->system->length / c->system->time;
  mg_evaluate_run_state(c);
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (!run->closed[i] && mg_is_on_feature_pair(c, i) && fabs(c->rows.d[i]) <= touching &&
        fabs(c->rows.d_dot[i]) <= slow)
      mg_note_graze(c, s, run->t, run->x, i, 0);
  mg_note_kinks(c, s, run->t, run->x, MG_AT_START);
}

MG_API int mg_begin_tangent(const mg_system *system, const mg_settings *settings, mg_run *run,
                            const mg_directions *directions, mg_tangent *tangent, mg_real *work, int *iwork) {
  mg_context c;
  mg_sensitivity s;
  if (!system->kernels->derivatives) return MG_NOT_FINITE;
  mg_open_context(&c, system, settings, run, work, iwork);
  mg_open_tangent(&c, &s, directions, tangent);
  const int n = c.layout.n_states;
  for (int j = 0; j < directions->n; j++) {
    mg_real *dx = tangent->x + (long)j * n;
    for (int i = 0; i < n; i++)
      dx[i] = i < system->n_q + system->n_u && directions->start ? directions->start[(long)j * n + i] : 0;
    mg_normalise_tangent(&c, run->x, dx);
  }
  tangent->count = 0, tangent->verdict = MG_VERDICT_DIFFERENTIABLE, tangent->reason = MG_NO_REASON,
  tangent->reason_t = 0, tangent->reason_contact = -1, tangent->is_lost = 0;
  for (int j = 0; j < directions->n && tangent->sides; j++) tangent->sides[j] = MG_SIDES;
  if (tangent->tape) tangent->tape->lost = 0;
  mg_evaluate_run_state(&c);
  mg_doubt_tangent(&s, mg_start_tangent(&c, &s, directions->given), run->t, -1);
  if (mg_is_time_stepping(&c)) mg_doubt_tangent(&s, MG_BY_TIME_STEPPING, run->t, -1);
  else mg_doubt_start(&c, &s);
  mg_lose_tangents(&s, n);
  mg_show_lost_tangents(directions, tangent, n, 1);
  return MG_DONE;
}

/* Carries the derivatives over the events of the step, island by island; c is that of the run after them. Leaves the
   one that is not certain, or the first, in s->crossing. Returns a reason or 0. */
static int mg_cross_events(mg_context *c, mg_sensitivity *s) {
  int reason = MG_NO_REASON, doubted = 0, lost = s->is_lost;
  for (int k = 0; k < s->n_crossing; k++) {
    mg_choose_crossing(s, k);
    MG_NOTE_EVENT(c, s, s->crossing.kind, s->crossing.contact, s->before);
    s->is_lost = 0;
    const int found = mg_cross_event(c, s, &s->crossing);
    if (found && !reason) reason = found, doubted = k;
    lost |= s->is_lost;
  }
  s->is_lost = lost;
  mg_choose_crossing(s, doubted);
  return reason;
}

/* Carries the derivatives over the step that the run has taken, from its state before. Leaves the run as it is after
   the step. */
static int mg_carry_over_step(const mg_system *system, const mg_settings *settings, mg_run *run, mg_sensitivity *s,
                              mg_real *work, int *iwork) {
  const mg_followed_step *step = &s->step;
  mg_context c;
  const mg_real h = mg_length_of_step(run, step), end = step->t + h; /* where the step that is taken again ends */
  int reason = run->report.singular_passages != step->passages ? MG_BY_SINGULAR_CONTACT : MG_NO_REASON;
  const int falls_back = run->report.fallbacks + run->report.chatters != step->fallbacks;
  mg_restore_run(system, run, step->before);
  mg_open_context(&c, system, settings, run, work, iwork);
  s->is_lost = mg_is_time_stepping(&c) || falls_back;
  if (s->is_lost) reason = MG_BY_TIME_STEPPING;
  const int unsure = mg_step_tangent(&c, s, h);
  if (!reason) reason = unsure;
  mg_forget_crossings(s);
  if (step->events->count == step->n_event) { /* the modes are those of the step */
    mg_mark_held_contacts(&c, s, 0);
    mg_project_tangents(&c, s, end, c.step.end);
    if (!reason && !s->is_lost) mg_doubt_step(&c, s, end, c.step.end);
    return reason;
  }
  mg_find_event_islands(&c, s);
  mg_find_crossings(&c, s, step->events, step->n_event);
  for (int k = 0; k < s->n_crossing; k++) mg_choose_crossing(s, k), mg_differentiate_event(&c, s, &s->crossing, end);
  mg_copy_states(&c, c.step.end, s->before);
  for (int i = 0; i < system->n_contact; i++) s->closed_before[i] = run->closed[i];
  mg_restore_run(system, run, step->after);
  mg_open_context(&c, system, settings, run, work, iwork);
  const int of_event = mg_cross_events(&c, s);
  mg_mark_held_contacts(&c, s, 0);
  mg_project_tangents(&c, s, run->t, run->x);
  return reason ? reason : of_event;
}

/* True if positions or velocities differ by more than drift. */
static int mg_has_state_jump(const mg_context *c, const mg_real *before) {
  for (int i = 0; i < c->system->n_q + c->system->n_u; i++)
    if (fabs(c->run->x[i] - before[i]) > c->settings->drift_tolerance * c->step.scale[i]) return 1;
  return 0;
}

/* Approach to an instant at which slip dies: the derivative of its direction is the quotient of two numbers that both
   vanish there, so that steps towards it are halved again and again, until slip is as slow as its tolerance, at which
   it may stop: the last step, too, no more than halves it. */
typedef struct {
  mg_real end;   /* the instant, s */
  mg_real least; /* the last step, s */
} mg_approach;

#define MG_APPROACH_HALVINGS 30 /* at most */
#define MG_APPROACH_SLIP 2      /* least slip, of its tolerance, at the start of a step */

/* Where the next step is to end at the latest. */
static mg_real mg_approach_stop(const mg_approach *a, mg_real t, mg_real t_stop) {
  return a->end - t > a->least ? mg_min(t + (a->end - t) / 2, t_stop) : t_stop;
}

/* Begins the approach to a time; returns 0 if that was the last step of one, or is too short to halve. `slip`: now, of
   its tolerance, or 0. */
static int mg_begin_approach(mg_approach *a, mg_real t, mg_real end, mg_real slip) {
  const mg_real halved = slip > 0 ? MG_APPROACH_SLIP * (end - t) / slip : 0,
                least = mg_max(mg_max(halved, ldexp(end - t, -MG_APPROACH_HALVINGS)), 4 * MG_EPS * fabs(end));
  if (a->least > 0 && fabs(a->end - end) <= 2 * a->least) return 0;
  a->end = end, a->least = least;
  return end - t > least;
}

/* Takes back the step of the run and its derivatives. */
static void mg_take_back_step(const mg_context *c, mg_sensitivity *s, mg_record *record, mg_events *events) {
  const mg_followed_step *step = &s->step;
  mg_restore_run(c->system, c->run, step->before);
  memcpy(s->tangent->x, s->start, (size_t)s->directions->n * (size_t)c->layout.n_states * sizeof(mg_real));
  s->step.begun--, events->count = step->n_event, record->count = step->n_record,
                   s->tangent->count = step->n_differentiated;
}

MG_API int mg_advance_tangent(const mg_system *system, const mg_settings *settings, mg_run *run,
                              const mg_directions *directions, mg_tangent *tangent, mg_real t_stop, long max_steps,
                              mg_record *record, mg_events *events, mg_real *work, int *iwork) {
  mg_context c;
  mg_sensitivity s;
  if (!system->kernels->derivatives) return MG_NOT_FINITE;
  mg_open_context(&c, system, settings, run, work, iwork);
  mg_open_tangent(&c, &s, directions, tangent);
  s.step.events = events, s.step.record = record;
  mg_copy_states(&c, run->x, s.before);
  const int n_states = c.layout.n_states;
  const long n_dx = (long)directions->n * n_states;
  mg_show_lost_tangents(directions, tangent, n_states, 0);
  int outcome = mg_advance(system, settings, run, t_stop, 0, record, events, work, iwork); /* inputs take effect */
  mg_open_context(&c, system, settings, run, work, iwork);
  if (mg_has_state_jump(&c, s.before)) mg_doubt_tangent(&s, MG_BY_JUMP, run->t, -1);
  mg_approach approach = {0, 0};
  while (outcome == MG_CONTINUE) {
    mg_followed_step *step = &s.step;
    const mg_tape *tape = tangent->tape;
    if (step->begun >= max_steps || mg_is_stopped(&c)) break;
    if (tape && tape->count >= tape->capacity) {
      outcome = MG_LIST_FULL;
      break;
    }
    const mg_real stop = mg_approach_stop(&approach, run->t, t_stop);
    const long most = stop < t_stop ? 1 : max_steps - step->begun;
    step->is_carried = 1;
    outcome = mg_advance_followed(system, settings, run, stop, most, record, events, &s.follower, work, iwork);
    if (outcome == MG_DONE && stop < t_stop) outcome = MG_CONTINUE;
    if (step->is_carried || mg_is_step_rejected(run, step)) continue;
    if (step->is_settled) memcpy(tangent->x, s.start, (size_t)n_dx * sizeof(mg_real));
    mg_store_run(system, run, step->after);
    const mg_real end = run->t;
    s.slip_left = 0;
    const int reason = mg_carry_over_step(system, settings, run, &s, work, iwork),
              stops = s.slip_left > settings->derivative_error_factor * settings->tolerance,
              constraint = stops ? s.slip_left_constraint : s.slip_falls;
    if ((stops || s.slip_end > 0) && outcome <= MG_CONTINUE &&
        mg_begin_approach(&approach, step->t, stops ? end : s.slip_end, constraint < 0 ? 0 : s.slip[constraint])) {
      mg_take_back_step(&c, &s, record, events);
      outcome = MG_CONTINUE;
      continue;
    }
    const int of_event =
        s.crossing.kind == MG_CROSSES_NOTHING || s.crossing.kind == MG_CROSSES_SWITCH ? -1 : s.crossing.contact;
    mg_doubt_tangent(&s, reason, end, s.doubtful >= 0 ? s.doubtful : of_event);
    mg_restore_run(system, run, step->after);
    mg_lose_tangents(&s, n_states);
    mg_keep_step(system, &s);
  }
  mg_show_lost_tangents(directions, tangent, n_states, 1);
  return outcome;
}

MG_API void mg_sense_tangent(const mg_system *system, const mg_settings *settings, mg_run *run,
                             const mg_directions *directions, mg_tangent *tangent, mg_real *sensors, int *reasons,
                             int *sides, mg_real *work, int *iwork) {
  mg_context c;
  mg_sensitivity s;
  const int n_sensor = system->kernels->n_sensor;
  mg_run copy = *run;
  for (int k = 0; k < n_sensor; k++) reasons[k] = MG_NO_REASON;
  for (long i = 0; i < (long)directions->n * n_sensor && sides; i++) sides[i] = MG_SIDES;
  if (tangent->is_lost) {
    mg_fill_reals(sensors, (long)directions->n * n_sensor, (mg_real)NAN);
    return;
  }
  mg_open_context(&c, system, settings, &copy, work, iwork);
  mg_open_tangent(&c, &s, directions, tangent);
  mg_evaluate_run_state(&c);
  mg_gather_wrenches(&c, &s, run->t);
  mg_read_sensors(&c, run->t, run->x + system->n_q + system->n_u, run->force, 1, s.y_dot);
  for (int k = 0; k < n_sensor; k++) s.reasons[k] = MG_NO_REASON;
  mg_doubt_redundant_forces(&c, &s);
  for (int k = 0; k < n_sensor; k++) reasons[k] = s.reasons[k];
  for (int j = 0; j < directions->n; j++) {
    mg_find_sensors_tangent(&c, &s, j);
    for (int k = 0; k < n_sensor; k++) {
      sensors[(long)j * n_sensor + k] = s.y_dot[k];
      if (sides) sides[(long)j * n_sensor + k] = s.sensor_sides[k];
      if (!reasons[k]) reasons[k] = s.reasons[k];
    }
  }
}
