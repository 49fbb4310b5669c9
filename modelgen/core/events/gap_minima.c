/* Gaps that close and open again within one step: the step is limited so that it cannot pass through a body, and
   gaps whose minimum lies inside the step are marked. Reads gaps, gap velocities and accelerations; writes only
   those marks. */
#include "events/events.h"
#include "model/model.h"
#include "forces/forces.h"

MG_INTERNAL mg_real mg_penetration_step_limit(const mg_context *c) {
  const mg_system *s = c->system;
  mg_real longest_step = MG_MAX;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    const mg_real travel = c->rows.d[i] + s->length;
    if (c->run->closed[i] || travel <= 0) continue;
    const mg_real speed = -c->rows.d_dot[i], gap_acceleration = mg_row_acceleration(c, i),
                  closing_acceleration = gap_acceleration < 0 ? -gap_acceleration : 0;
    const mg_real mean = (speed + sqrt(speed * speed + 2 * closing_acceleration * travel)) / 2;
    if (mean * longest_step > travel) longest_step = travel / mean;
  }
  return longest_step;
}

MG_INTERNAL void mg_store_gaps(mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    c->events.gap_before[2 * i] = c->rows.d[i], c->events.gap_before[2 * i + 1] = c->rows.d_dot[i];
  MG_NOTE_WITH(c, MG_VALID_KEPT_GAPS, MG_VALID_RATES);
}

/* Whether an open gap may have closed within the last h: once between shrinking and growing, or repeatedly where
   its cubic nearly turns twice; 0 if not. */
static int mg_classify_gap_minimum(const mg_context *c, int contact, mg_real h) {
  const mg_real before = c->events.gap_before[2 * contact], start_change = c->events.gap_before[2 * contact + 1] * h;
  const mg_real now = c->rows.d[contact], end_change = c->rows.d_dot[contact] * h,
                rest = c->settings->rest_speed * c->system->length / c->system->time * h;
  if (c->run->closed[contact] ||
      !((start_change < -rest && before <= -start_change) || (end_change > rest && now <= end_change)))
    return 0;
  const int falls = start_change < -rest, rises = end_change > 0;
  if (falls && rises) return MG_GAP_MAY_CLOSE;
  const mg_real triple_change = 3 * (now - before), slope_sum = start_change + end_change;
  return (rises && triple_change < slope_sum) || (falls && triple_change > slope_sum) ? MG_GAP_OSCILLATES : 0;
}

MG_INTERNAL int mg_mark_gap_minima(mg_context *c, mg_real h) {
  int most = 0;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    c->events.gap_dips[i] = mg_classify_gap_minimum(c, i, h);
    if (c->events.gap_dips[i] > most) most = c->events.gap_dips[i];
  }
  MG_NOTE_WITH(c, MG_VALID_GAP_MINIMA, MG_VALID_RATES);
  return most;
}
