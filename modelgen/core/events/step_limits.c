/* Gaps that close and open again within one step: the step is kept from jumping over a body, and the lowest gap is
   looked at. */
#include "events/events.h"
#include "forces/forces.h"

/* The longest step after which no open gap, accelerating as now, is deeper below zero than the characteristic
   length. */
MG_INTERNAL mg_real mg_penetration_step_limit(const mg_context *c) {
  const mg_system *s = c->system;
  mg_real reach = MG_MAX;
  for (int i = 0; i < c->support_begin; i++) {
    const mg_real way = c->d[i] + s->length;
    if (c->run->closed[i] || way <= 0) continue;
    const mg_real speed = -c->d_dot[i], away = mg_gap_acceleration(c, i), pull = away < 0 ? -away : 0;
    const mg_real mean = (speed + sqrt(speed * speed + 2 * pull * way)) / 2;
    if (mean * reach > way) reach = way / mean;
  }
  return reach;
}

/* Notes the open gaps and their rates where a part of a step begins. */
MG_INTERNAL void mg_note_gaps(mg_context *c) {
  for (int i = 0; i < c->support_begin; i++)
    c->events.gap_before[2 * i] = c->d[i], c->events.gap_before[2 * i + 1] = c->d_dot[i];
}

/* Whether an open gap may have been closed since it was noted, h ago: MG_GAP_MAY_CLOSE where it shrank then and grows
   now, MG_GAP_OSCILLATES where it does both or neither, and the cubic through both ends is not far from turning twice.
   A tangent reaches zero. */
static int mg_may_dip(const mg_context *c, int contact, mg_real h) {
  const mg_real before = c->events.gap_before[2 * contact], first = c->events.gap_before[2 * contact + 1] * h;
  const mg_real now = c->d[contact], last = c->d_dot[contact] * h,
                rest = c->settings->rest_speed * c->system->length / c->system->time * h;
  if (c->run->closed[contact] || !((first < -rest && before <= -first) || (last > rest && now <= last))) return 0;
  const int falls = first < -rest, rises = last > 0;
  if (falls && rises) return MG_GAP_MAY_CLOSE;
  const mg_real thrice = 3 * (now - before), ends = first + last;
  return (rises && thrice < ends) || (falls && thrice > ends) ? MG_GAP_OSCILLATES : 0;
}

/* Marks the gaps that may have been closed since they were noted, h ago; returns the larger of what they do. */
MG_INTERNAL int mg_mark_gap_dips(mg_context *c, mg_real h) {
  int most = 0;
  for (int i = 0; i < c->support_begin; i++) {
    c->events.gap_dips[i] = mg_may_dip(c, i, h);
    if (c->events.gap_dips[i] > most) most = c->events.gap_dips[i];
  }
  return most;
}
