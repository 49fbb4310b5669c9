/* events/interior_minima */
#include "events/events.h"
#include "forces/forces.h"
#include "integrate/integrate.h"

enum { MG_MARGIN_LOOKS = 20 }; /* at a part of a step that seems to go below zero */

/* Whether something may be below zero between the samples of the step. Needs mg_rhs and mg_gap_rates at its end. */
MG_INTERNAL int mg_may_have_hidden_event(mg_context *c) {
  mg_margin_sample p[4];
  mg_real theta;
  if (c->settings->method != MG_DOP853) return 0;
  if (mg_is_collocated(c)) return c->system->n_grip > 0; /* none of its stages was taken */
  mg_sample_margins(c, MG_MARGIN_SAMPLES - 1);
  for (int which = 0; which < mg_count_margins(c->system); which++) {
    const int parts = mg_is_margin_steady(c, which) ? 0 : MG_MARGIN_SAMPLES - 1;
    for (int end = 1; end <= parts; end++) {
      mg_four_margin_samples(c, which, end, MG_MARGIN_SAMPLES, 0, p);
      if (mg_lower_bound_between(p, &theta) < 0) return 1;
    }
  }
  return 0;
}

/* Where within the inner part of four samples of the step h an event has fired; 0 where none has. */
static mg_real mg_seek_strain(mg_context *c, int which, mg_real h, mg_margin_sample *p, mg_real *low) {
  mg_real theta;
  mg_margin_sample half[2][4];
  for (int look = 0; look < MG_MARGIN_LOOKS && mg_lower_bound_between(p, &theta) < 0; look++) {
    *low = p[1].theta;
    if (mg_trigger_events_at(c, h, theta)) return theta;
    mg_sample_margins(c, MG_MARGIN_SAMPLES);
    const mg_margin_sample middle = {theta, mg_margins_at(c, MG_MARGIN_SAMPLES)[which]};
    const mg_margin_sample five[5] = {p[0], p[1], middle, p[2], p[3]};
    for (int k = 0; k < 4; k++) half[0][k] = five[k], half[1][k] = five[k + 1];
    mg_real unused;
    const int second = mg_lower_bound_between(half[1], &unused) < mg_lower_bound_between(half[0], &unused);
    for (int k = 0; k < 4; k++) p[k] = half[second][k];
  }
  return 0;
}

/* The first of all within the part of the step h that ends with the given one of n even samples, after *low; 0 where
   there is none. */
MG_INTERNAL mg_real mg_first_hidden_event(mg_context *c, mg_real h, int end, int n, mg_real part, mg_real *low) {
  mg_margin_sample p[4];
  mg_real first = 0, from = 0;
  for (int which = 0; which < mg_count_margins(c->system); which++) {
    if (mg_margins_at(c, end % MG_MARGIN_SAMPLES)[which].lower >= MG_MAX) continue;
    mg_four_margin_samples(c, which, end, n, part, p);
    const mg_real theta = mg_seek_strain(c, which, h, p, &from);
    if (theta > 0 && (first == 0 || theta < first)) first = theta, *low = from;
  }
  return first;
}
