/* The modes of a contact, on no link, open, closed, and what leads from one to the next. Which closed contacts carry
   force is decided by a complementarity problem (modes.c). */
#include "model/model.h"

enum { MG_STAYS = -1, MG_SILENT = -1 };

static const struct {
  int closed; /* after it: 1, 0, or as before */
  int event;  /* that is reported, if any */
} mg_transitions[] = {
    [MG_STRIKES] = {1, MG_SILENT},
    [MG_IS_CAUGHT] = {1, MG_EVENT_TOUCH_DOWN},
    [MG_REBOUNDS] = {0, MG_EVENT_IMPACT},
    [MG_MISSES] = {0, MG_SILENT},
    [MG_IS_PUSHED_OFF] = {0, MG_EVENT_LIFT_OFF},
    [MG_LIFTS] = {0, MG_EVENT_LIFT_OFF},
    [MG_APPEARS] = {0, MG_EVENT_APPEAR},
    [MG_WALKS_ON] = {MG_STAYS, MG_EVENT_WALK},
    [MG_VANISHES] = {0, MG_EVENT_VANISH},
    [MG_RESTS] = {MG_STAYS, MG_EVENT_FLAT},
    [MG_TURNS_OVER] = {MG_STAYS, MG_EVENT_TIP},
    [MG_ENDS_RUN] = {MG_STAYS, MG_EVENT_MARGIN},
};

MG_INTERNAL void mg_emit(const mg_context *c, mg_events *events, mg_real t, int kind, int contact, mg_real speed) {
  if (events->count >= events->capacity) return;
  const int k = events->count++;
  events->t[k] = t, events->kind[k] = kind, events->contact[k] = contact, events->speed[k] = speed;
  events->link[k] = c->run->link[contact];
}

MG_INTERNAL void mg_befalls(mg_context *c, mg_events *events, int contact, int cause, mg_real t, mg_real speed) {
  const int closed = mg_transitions[cause].closed, event = mg_transitions[cause].event;
  if (closed != MG_STAYS && closed != c->run->closed[contact])
    c->run->closed[contact] = closed, c->run->active[contact] = c->run->fresh[contact] = 0;
  if (event != MG_SILENT) mg_emit(c, events, t, event, contact, speed);
}

MG_INTERNAL void mg_forget_events(mg_context *c) {
  for (int i = 0; i < c->sys->n_contact; i++) c->fired[i] = 0;
}

/* Time passes; what rounding leaves out of its sum is kept: many short steps lose nothing. */
MG_INTERNAL void mg_pass_time(mg_run *run, mg_real h) {
  const mg_real t = run->t, step = h + run->t_rest;
  run->t = t + step;
  run->t_rest = step - (run->t - t);
}
