/* The cost of events: how much computing it takes to locate the events of a run and to change its modes there, against
   what time-stepping over the same time would cost. Where contacts close and open, or stick and slip, without
   end, as in a heap that settles, the run goes on by time-stepping.

   Work is counted in evaluations of one contact. Promise: between any two times of event-driven integration, the work
   of steps in which contacts change their mode is at most chatter_work, plus MG_WORK_RATIO times that of time-stepping
   over the time between, plus that of one step. Writes run->event_work. */
#include "timestep/timestep.h"
#include "model/model.h"
#include "forces/forces.h"

enum {
  MG_WORK_RATIO = 4,             /* events may cost so many times as much as time-stepping */
  MG_EVALUATIONS_OF_STEP = 5,    /* right-hand sides that cost as much as a step of time-stepping */
  MG_EVALUATIONS_OF_EVENT = 40,  /* right-hand sides of a step that ends in an event, as a rule */
  MG_EVALUATIONS_OF_PATCH = 15,  /* equations of one contact that cost as much as the pressure of a planar contact */
  MG_CELLS_PER_EVALUATION = 4,   /* pairs of cells of a search that cost as much as one contact's equations */
  MG_PIVOTS_PER_EVALUATION = 300 /* cubes of the number of forces that cost as much as one contact's equations */
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

/* Work of one right-hand side: the equations of all contacts, loads that switch as those of one, the pressures of
   planar contacts, and the factorisation for the forces of those that carry some, with their friction rows. */
static mg_real mg_work_of_evaluation(const mg_context *c) {
  mg_real n = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    n += c->run->active[i] ? 1 + mg_tangential_row_count(c, i) : 0;
  int patches = 0;
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) patches += mg_patch_of_slot(c, slot) >= 0;
  return c->listed.n_contact + (c->system->n_switch > 0) + MG_EVALUATIONS_OF_PATCH * patches +
         n * n * n / MG_PIVOTS_PER_EVALUATION;
}

MG_INTERNAL int mg_has_costly_events(mg_context *c, const mg_events *events, int first, long evaluations, long cells) {
  mg_run *run = c->run;
  if (!mg_count_transitions(events, first)) return 0;
  const mg_real each = mg_work_of_evaluation(c),
                steps = (run->t - run->event_work_t) / (c->settings->chatter_step * c->system->time);
  run->event_work = mg_max(run->event_work - MG_WORK_RATIO * MG_EVALUATIONS_OF_STEP * steps * each, 0);
  run->event_work += evaluations * each + cells / (mg_real)MG_CELLS_PER_EVALUATION, run->event_work_t = run->t;
  return c->settings->fallback && run->event_work > c->settings->chatter_work;
}

MG_INTERNAL int mg_would_chatter(const mg_context *c, long transitions, long n) {
  int closed = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) closed += c->run->closed[i] != 0;
  return closed > c->settings->chatter_closed ||
         transitions * MG_EVALUATIONS_OF_EVENT > n * MG_WORK_RATIO * MG_EVALUATIONS_OF_STEP;
}
