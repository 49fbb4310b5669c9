/* Events whose function is negative only between two samples of a step: lower bounds from four samples decide where
   the step is searched on its interpolant. Reads the margins that forces/event_margin_samples.c sampled. */
#include "events/events.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/integrate.h"

enum { MG_MARGIN_LOOKS = 20 }; /* most evaluations in a part of a step in which a margin may be negative */

MG_INTERNAL int mg_has_possible_hidden_event(mg_context *c) {
  MG_NEEDS_ANY(c, MG_VALID_FORCES), MG_NEEDS_WITH(c, MG_VALID_RATES, MG_VALID_TWISTS);
  mg_margin_sample p[4];
  mg_real theta;
  if (c->settings->method != MG_DOP853 || !mg_has_event_functions(c)) return 0;
  if (mg_is_collocated(c)) return c->system->n_friction > 0; /* none of its stages was taken */
  mg_sample_event_margins(c, MG_MARGIN_SAMPLES - 1);
  for (int which = mg_next_event_margin(c, -1); which < mg_event_margin_count(c->system);
       which = mg_next_event_margin(c, which)) {
    const int parts = mg_is_margin_nearly_constant(c, which) ? 0 : MG_MARGIN_SAMPLES - 1;
    for (int end = 1; end <= parts; end++) {
      mg_collect_margin_samples(c, which, end, MG_MARGIN_SAMPLES, 0, p);
      if (mg_interior_margin_bound(p, &theta) < 0) return 1;
    }
  }
  return 0;
}

/* Search one event margin for a hidden event between the inner two of four samples; returns the share of the step
   at which an event has triggered, 0 where none has. */
static mg_real mg_find_hidden_event(mg_context *c, int which, mg_real h, mg_margin_sample *p, mg_real *low) {
  mg_real theta;
  mg_margin_sample half[2][4];
  for (int look = 0; look < MG_MARGIN_LOOKS && mg_interior_margin_bound(p, &theta) < 0; look++) {
    *low = p[1].theta;
    if (mg_mark_triggered_events_at(c, h, theta)) return theta;
    mg_sample_event_margins(c, MG_MARGIN_SAMPLES);
    const mg_margin_sample middle = {theta, mg_event_margins_of_sample(c, MG_MARGIN_SAMPLES)[which]};
    const mg_margin_sample five[5] = {p[0], p[1], middle, p[2], p[3]};
    for (int k = 0; k < 4; k++) half[0][k] = five[k], half[1][k] = five[k + 1];
    mg_real unused;
    const int second = mg_interior_margin_bound(half[1], &unused) < mg_interior_margin_bound(half[0], &unused);
    for (int k = 0; k < 4; k++) p[k] = half[second][k];
  }
  return 0;
}

MG_INTERNAL mg_real mg_first_hidden_event(mg_context *c, mg_real h, int end, int n, mg_real part, mg_real *low) {
  mg_margin_sample p[4];
  mg_real first = 0, from = 0;
  for (int which = mg_next_event_margin(c, -1); which < mg_event_margin_count(c->system);
       which = mg_next_event_margin(c, which)) {
    if (mg_event_margins_of_sample(c, end % MG_MARGIN_SAMPLES)[which].lower >= MG_MAX) continue;
    mg_collect_margin_samples(c, which, end, n, part, p);
    const mg_real theta = mg_find_hidden_event(c, which, h, p, &from);
    if (theta > 0 && (first == 0 || theta < first)) first = theta, *low = from;
  }
  return first;
}
