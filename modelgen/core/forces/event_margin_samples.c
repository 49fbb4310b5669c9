/* Event functions that fall below zero and rise again within one step: the margins before events are sampled at
   the stages, and a lower bound between samples decides where to look. A convex function lies, between two
   samples, above the intersection of the lines through each of them and its outer neighbour; where that bound is
   negative the function is evaluated there, and so on. Writes samples of event margins and event marks. */
#include "forces/forces.h"
#include "model/model.h"

static const mg_real mg_margin_time[MG_MARGIN_SAMPLES] = {
    /* times of a step, in parts of it: its start, those of its stages, its end */
    0, (mg_real)0.1184, (mg_real)0.25, (mg_real)0.3333, (mg_real)0.6, (mg_real)0.8571, 1};

static const int mg_margin_sample_of_stage[12] = {0, -1, -1, 1, -1, 3, 2, -1, -1, 4, 5, -1}; /* sample at a stage */

MG_INTERNAL void mg_sample_event_margins(mg_context *c, int sample) {
  MG_NEEDS_ANY(c, MG_VALID_FORCES);
  const mg_system *s = c->system;
  const mg_event_margin *now = mg_event_margins_of_sample(c, MG_MARGIN_SAMPLES);
  mg_event_margin *taken = mg_event_margins_of_sample(c, sample), *constraints = taken + s->n_contact;
  const mg_real slack = mg_force_tolerance(c);
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    taken[i].lower = c->run->closed[i] && c->run->active[i] ? c->solution.force[i] + slack : MG_MAX;
    taken[i].upper = taken[i].lower;
    for (int g = s->contact_friction[i]; g < s->contact_friction[i + 1]; g++)
      constraints[g].lower = constraints[g].upper = mg_friction_event_margin(c, i, g);
  }
  for (int k = 0; k < s->n_switch; k++)
    constraints[s->n_friction + k].lower = constraints[s->n_friction + k].upper = mg_switch_event_margin(c, k);
  for (int support = c->layout.support_begin; support < s->n_contact; support++) taken[support] = now[support];
}

/* Forgets the margins of patches from which bounds of those near them follow: they hold within one step. */
static void mg_forget_patch_margins(mg_context *c) {
  c->patches.deepest = 0;
  for (int slot = 0; slot < c->system->n_patch_slot && c->system->n_friction; slot++)
    c->patches.friction[slot].mean_distance = 0;
}

MG_INTERNAL void mg_sample_margins_at_start(mg_context *c) {
  MG_NEEDS_AT_RUN(c, MG_VALID_FORCES), MG_NEEDS_WITH(c, MG_VALID_RATES, MG_VALID_TWISTS);
  mg_forget_patch_margins(c);
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) mg_find_slot_event(c, slot);
  mg_note_returning_switches(c);
  mg_sample_event_margins(c, 0);
  MG_NOTE_WITH(c, MG_VALID_MARGINS, MG_VALID_TWISTS);
}

MG_INTERNAL void mg_sample_margins_at_stage(mg_context *c, int stage) {
  if (mg_margin_sample_of_stage[stage] > 0 && !c->step.sign_changed)
    mg_sample_event_margins(c, mg_margin_sample_of_stage[stage]);
}

/* Slope of the line through two samples. */
static mg_real mg_margin_slope(const mg_margin_sample *a, mg_real from, const mg_margin_sample *b, mg_real to) {
  return (to - from) / (b->theta - a->theta);
}

MG_INTERNAL mg_real mg_interior_margin_bound(const mg_margin_sample *p, mg_real *theta) {
  const mg_real left_margin = p[1].left.lower, right_margin = p[2].left.lower, width = p[2].theta - p[1].theta;
  const int before = p[0].theta >= 0, after = p[3].theta <= 1;
  if (left_margin >= MG_MAX || right_margin >= MG_MAX) return 0;
  int all_uncertain = 1;
  for (int k = !before; k < 3 + after; k++) all_uncertain &= p[k].left.lower < p[k].left.upper;
  const mg_real left_slope =
      before ? mg_margin_slope(p, all_uncertain ? p->left.lower : p->left.upper, p + 1, left_margin) : -MG_MAX;
  const mg_real right_slope =
      after ? mg_margin_slope(p + 2, right_margin, p + 3, all_uncertain ? p[3].left.lower : p[3].left.upper) : MG_MAX;
  if (left_slope >= 0 || right_slope <= 0) return 0;
  mg_real part =
      before ? after ? (right_margin - left_margin - right_slope * width) / (left_slope - right_slope) : width : 0;
  if (part < 0 || !(part <= width)) part = part < 0 ? width / 4 : 3 * width / 4;
  const mg_real left = before ? left_margin + left_slope * part : -MG_MAX,
                right = after ? right_margin - right_slope * (width - part) : -MG_MAX;
  const mg_real least_distance = width / 16;
  *theta = p[1].theta + (part < least_distance           ? least_distance
                         : part > width - least_distance ? width - least_distance
                                                         : part);
  return left > right ? left : right;
}

MG_INTERNAL void mg_collect_margin_samples(const mg_context *c, int which, int end, int n, mg_real part,
                                           mg_margin_sample *p) {
  for (int k = 0; k < 4; k++) {
    const int sample = end - 2 + k;
    p[k].theta = sample < 0 ? -1 : sample >= n ? 2 : part > 0 ? sample * part : mg_margin_time[sample];
    if (sample >= 0 && sample < n) p[k].left = mg_event_margins_of_sample(c, sample % MG_MARGIN_SAMPLES)[which];
  }
}

MG_INTERNAL int mg_is_margin_nearly_constant(const mg_context *c, int which) {
  mg_real low = MG_MAX, high = -MG_MAX;
  for (int sample = 0; sample < MG_MARGIN_SAMPLES; sample++) {
    const mg_event_margin *left = mg_event_margins_of_sample(c, sample) + which;
    if (left->lower < low) low = left->lower;
    if (left->upper > high) high = left->upper;
  }
  return low >= high - low;
}
