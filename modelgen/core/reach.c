/* Gaps that close and open again within one step: the step is kept from jumping over a body, and the lowest gap is
   looked at. */
#include "core.h"

/* The longest step after which no open gap, accelerating as now, is deeper below zero than the characteristic
   length. */
static mg_real mg_reach(const mg_context *c) {
  const mg_system *s = c->sys;
  mg_real reach = MG_MAX;
  for (int i = 0; i < c->first_pad; i++) {
    const mg_real way = c->d[i] + s->length;
    if (c->run->closed[i] || way <= 0) continue;
    const mg_real speed = -c->d_dot[i], away = mg_separation(c, i), pull = away < 0 ? -away : 0;
    const mg_real mean = (speed + sqrt(speed * speed + 2 * pull * way)) / 2;
    if (mean * reach > way) reach = way / mean;
  }
  return reach;
}

static void mg_mark_falling(mg_context *c) {
  const mg_real rest = -c->set->rest_speed * c->sys->length / c->sys->time;
  for (int i = 0; i < c->sys->n_contact; i++) c->falling[i] = !c->run->closed[i] && !mg_is_pad(c, i) && c->d_dot[i] < rest;
}

/* Keeps the marks of the gaps that grow again at the end of the step h and may have been closed on the way. */
static int mg_dips(mg_context *c, mg_real h) {
  int count = 0;
  for (int i = 0; i < c->sys->n_contact; i++) {
    c->falling[i] = c->falling[i] && c->d_dot[i] > 0 && c->d[i] <= c->d_dot[i] * h;
    count += c->falling[i];
  }
  return count;
}
