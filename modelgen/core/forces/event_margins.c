/* What is left before forces turn to pulling, grips break, slip comes to rest, faces turn over: where it falls and
   grows again within a step, it is looked at where it is least, so that a grip that breaks and holds again is not
   passed over.

   A function that bends upwards lies, between two samples, above the meeting point of the lines through each of them
   and its outer neighbour. Where that is below zero, the function is taken there, and so on. */
#include "forces/forces.h"
#include "base/base.h"

static const mg_real mg_strained_at[MG_MARGIN_SAMPLES] = {
    /* times of a step, in parts of it: its start, those of its stages, its end */
    0, (mg_real)0.1184, (mg_real)0.25, (mg_real)0.3333, (mg_real)0.6, (mg_real)0.8571, 1};

static const int mg_strain_of[12] = {0, -1, -1, 1, -1, 3, 2, -1, -1, 4, 5, -1}; /* sample at a stage */

MG_INTERNAL int mg_count_margins(const mg_system *s) { return s->n_contact + s->n_grip; }

MG_INTERNAL long mg_margin_memory(const mg_system *s) {
  return mg_count_reals((MG_MARGIN_SAMPLES + 1L) * mg_count_margins(s), sizeof(mg_event_margin));
}

MG_INTERNAL mg_event_margin *mg_margins_at(const mg_context *c, int sample) {
  return c->events.margins + (long)sample * mg_count_margins(c->system);
}

/* Takes what is left now for a sample of the step. Of slots it has been noted. Needs mg_rhs and mg_gap_rates. */
MG_INTERNAL void mg_sample_margins(mg_context *c, int sample) {
  const mg_system *s = c->system;
  const mg_event_margin *now = mg_margins_at(c, MG_MARGIN_SAMPLES);
  mg_event_margin *taken = mg_margins_at(c, sample), *grips = taken + s->n_contact;
  for (int i = 0; i < c->support_begin; i++) {
    taken[i].lower = c->run->closed[i] && c->run->active[i] ? c->force[i] + mg_rest_acceleration(c) * s->mass : MG_MAX;
    taken[i].upper = taken[i].lower;
    for (int g = s->contact_grip[i]; g < s->contact_grip[i + 1]; g++)
      grips[g].lower = grips[g].upper = mg_friction_event_margin(c, i, g);
  }
  for (int pad = c->support_begin; pad < s->n_contact; pad++) taken[pad] = now[pad];
}

/* The same at the start of a step; needs the forces there. */
MG_INTERNAL void mg_begin_margins(mg_context *c) {
  for (int slot = 0; slot < c->system->n_slot; slot++) mg_slot_end_cause(c, slot);
  mg_sample_margins(c, 0);
}

/* At a stage of the step, at each of which mg_watch_stage notes the slots; of no use where an event has been seen. */
MG_INTERNAL void mg_sample_stage_margins(mg_context *c, int stage) {
  if (mg_strain_of[stage] > 0 && !c->step.sign_changed) mg_sample_margins(c, mg_strain_of[stage]);
}

static mg_real mg_slope_between(const mg_margin_sample *a, mg_real from, const mg_margin_sample *b, mg_real to) {
  return (to - from) / (b->theta - a->theta);
}

/* A lower bound between the inner two of four samples, and where it is; 0 or more: nothing is below zero. What is known
   between bounds only is taken as low as it may be, its neighbours as high, unless all are. */
MG_INTERNAL mg_real mg_lower_bound_between(const mg_margin_sample *p, mg_real *theta) {
  const mg_real b = p[1].left.lower, d = p[2].left.lower, width = p[2].theta - p[1].theta;
  const int before = p[0].theta >= 0, after = p[3].theta <= 1;
  if (b >= MG_MAX || d >= MG_MAX) return 0;
  int rough = 1;
  for (int k = !before; k < 3 + after; k++) rough &= p[k].left.lower < p[k].left.upper;
  const mg_real falls = before ? mg_slope_between(p, rough ? p->left.lower : p->left.upper, p + 1, b) : -MG_MAX;
  const mg_real grows = after ? mg_slope_between(p + 2, d, p + 3, rough ? p[3].left.lower : p[3].left.upper) : MG_MAX;
  if (falls >= 0 || grows <= 0) return 0;
  mg_real part = before ? after ? (d - b - grows * width) / (falls - grows) : width : 0;
  if (part < 0 || !(part <= width)) part = part < 0 ? width / 4 : 3 * width / 4;
  const mg_real left = before ? b + falls * part : -MG_MAX, right = after ? d - grows * (width - part) : -MG_MAX;
  const mg_real edge = width / 16;
  *theta = p[1].theta + (part < edge ? edge : part > width - edge ? width - edge : part);
  return left > right ? left : right;
}

/* Four samples about the part of the step that ends with the given one of n, of which the last are kept; `part`: their
   spacing if it is even, else 0. */
MG_INTERNAL void mg_four_margin_samples(const mg_context *c, int which, int end, int n, mg_real part,
                                        mg_margin_sample *p) {
  for (int k = 0; k < 4; k++) {
    const int sample = end - 2 + k;
    p[k].theta = sample < 0 ? -1 : sample >= n ? 2 : part > 0 ? sample * part : mg_strained_at[sample];
    if (sample >= 0 && sample < n) p[k].left = mg_margins_at(c, sample % MG_MARGIN_SAMPLES)[which];
  }
}

/* What is left varies so little between the samples of the step that nothing is below zero: bounds between them are
   lower than the least by no more than all it varies. */
MG_INTERNAL int mg_is_margin_steady(const mg_context *c, int which) {
  mg_real low = MG_MAX, high = -MG_MAX;
  for (int sample = 0; sample < MG_MARGIN_SAMPLES; sample++) {
    const mg_event_margin *left = mg_margins_at(c, sample) + which;
    if (left->lower < low) low = left->lower;
    if (left->upper > high) high = left->upper;
  }
  return low >= high - low;
}
