/* The cost of events: how much computing it takes to locate the events of a run and to change its modes there, against
   what time-stepping over the same time would cost. Where contacts close and open, or stick and slip, without
   end, as in a heap that settles, the run goes on by time-stepping.

   Promise: between any two times of event-driven integration, the work of steps in which modes are chosen, or that are
   rejected, is at most chatter_work, plus MG_WORK_RATIO times that of time-stepping over the time between, plus that of
   one step; after a return from time-stepping, part 1 / MG_RETURN_SHARE of the work of its steps takes the place of
   chatter_work. Writes run->event_work. */
#include "timestep/timestep.h"
#include "model/model.h"
#include "forces/forces.h"

enum {
  MG_WORK_RATIO = 4,            /* events may cost so many times as much as time-stepping */
  MG_EVALUATIONS_OF_STEP = 5,   /* right-hand sides that cost as much as a step of time-stepping */
  MG_EVALUATIONS_OF_FORCE = 2,  /* equations of one contact that cost as much as a force of a step */
  MG_RETURN_SHARE = 3,          /* events after a return may cost this part of the steps before it */
  MG_EVALUATIONS_OF_EVENT = 40, /* right-hand sides of a step that ends in an event, as a rule */
  MG_CELLS_PER_EVALUATION = 4   /* pairs of cells of a search that cost as much as one contact's equations */
};

MG_INTERNAL void mg_reset_event_work(mg_run *run) {
  run->event_work = 0, run->event_work_t = run->t;
  run->fallback_transitions = 0, run->present_cause = MG_DONE;
}

MG_INTERNAL int mg_count_transitions(const mg_events *events, int first) {
  int count = 0;
  for (int i = first; i < events->count; i++) {
    const int kind = events->kind[i];
    count += kind == MG_EVENT_IMPACT || kind == MG_EVENT_TOUCH_DOWN || kind == MG_EVENT_LIFT_OFF ||
             kind == MG_EVENT_LOAD_SWITCH || (kind >= MG_EVENT_SLIP_START && kind < MG_EVENT_FALLBACK_START);
  }
  return count;
}

/* Work of time-stepping over a span of time in steps of this length, whose forces are found contact by contact. */
static mg_real mg_work_of_steps(const mg_context *c, mg_real span, mg_real step) {
  mg_real each = mg_work_of_equations(c);
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    each += c->run->active[i] ? MG_EVALUATIONS_OF_FORCE * (1 + mg_tangential_row_count(c, i)) : 0;
  return span / step * MG_EVALUATIONS_OF_STEP * each;
}

MG_INTERNAL void mg_credit_event_work(mg_context *c) {
  mg_run *run = c->run;
  const mg_real steps = mg_work_of_steps(c, run->t - run->event_work_t, c->settings->chatter_step * c->system->time);
  run->event_work = mg_max(run->event_work - MG_WORK_RATIO * steps, 0), run->event_work_t = run->t;
}

MG_INTERNAL int mg_has_costly_events(mg_context *c, long rejected, long cells) {
  if (!c->step.mode_choices && !rejected) return 0;
  c->run->event_work += c->step.work + cells / (mg_real)MG_CELLS_PER_EVALUATION;
  return c->settings->fallback && c->run->event_work > c->settings->chatter_work;
}

MG_INTERNAL void mg_grant_event_work(mg_context *c) {
  mg_run *run = c->run;
  const mg_real steps = mg_work_of_steps(c, run->t - run->event_work_t, run->fallback_step);
  run->event_work = mg_max(c->settings->chatter_work - steps / MG_RETURN_SHARE, 0);
}

MG_INTERNAL int mg_would_chatter(const mg_context *c, long transitions, long n) {
  int closed = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) closed += c->run->closed[i] != 0;
  return closed > c->settings->chatter_closed ||
         transitions * MG_EVALUATIONS_OF_EVENT > n * MG_WORK_RATIO * MG_EVALUATIONS_OF_STEP;
}
