/* Loads that slide on a zero of their switching functions: between the loads of both branches is the one that keeps the
   function at zero (Filippov's convex combination). Its place between them follows from the right-hand side, which is
   linear in it, by Newton's method. Writes the branches of the run. */
#include "forces/forces.h"
#include "base/base.h"
#include "model/model.h"

enum { MG_SLIDE_ROUNDS = 4 }; /* most rounds of Newton's method */

/* Sets the branch of a switching function that slides, and of those that slide along with it. */
static void mg_set_sliding_branch(const mg_context *c, int which, mg_real branch) {
  mg_set_branch(c, which, branch);
  for (int k = 0; k < c->system->n_switch; k++)
    if (c->run->switch_leader[k] == which + 1 || c->run->switch_leader[k] == -which - 1)
      mg_set_branch(c, k, c->run->switch_leader[k] > 0 ? branch : -branch);
}

MG_INTERNAL int mg_slides(const mg_context *c) {
  for (int k = 0; k < c->system->n_switch; k++)
    if (c->run->switch_mode[k] == MG_BRANCH_SLIDES) return 1;
  return 0;
}

MG_INTERNAL void mg_begin_slide(const mg_context *c, mg_slide *slide) {
  slide->n = slide->round = 0, slide->trial = -1;
  if (!mg_has_branches(c)) return;
  for (int k = 0; k < c->system->n_switch && slide->n < MG_SLIDING_MAX; k++)
    if (c->run->switch_mode[k] == MG_BRANCH_SLIDES && !c->run->switch_leader[k]) slide->of[slide->n++] = k;
}

/* Rate by which a switching function that slides is to return to zero and does not, 1/s. Of a function of t and poses
   alone it follows from the second rate. */
static mg_real mg_slide_residual(const mg_context *c, int which) {
  const mg_real time = c->system->time, rate = c->switches.rate[which], value = c->switches.value[which];
  return c->switches.second[2 * which] > 0 ? time * c->switches.second[2 * which + 1] + 2 * rate + value / time
                                           : rate + value / time;
}

static void mg_shift_branch(const mg_context *c, mg_slide *slide) {
  const int which = slide->of[slide->trial];
  slide->kept = c->run->branch[which];
  mg_set_sliding_branch(c, which, slide->kept > 0 ? slide->kept - 1 : slide->kept + 1);
}

static void mg_note_shifted_branch(const mg_context *c, mg_slide *slide) {
  const int n = slide->n, which = slide->of[slide->trial];
  const mg_real shift = c->run->branch[which] - slide->kept;
  for (int k = 0; k < n; k++)
    slide->derivative[k + n * slide->trial] = (mg_slide_residual(c, slide->of[k]) - slide->residual[k]) / shift;
  mg_set_sliding_branch(c, which, slide->kept);
}

static void mg_correct_branches(const mg_context *c, mg_slide *slide) {
  const int n = slide->n;
  mg_real y[MG_SLIDING_MAX], scratch[MG_SLIDING_MAX];
  int order[MG_SLIDING_MAX];
  for (int k = 0; k < n; k++) slide->residual[k] = -slide->residual[k];
  const mg_real floor = c->settings->event_tolerance * mg_max_abs(n * n, slide->derivative);
  const int rank = mg_factor_pivoted_qr(n, slide->derivative, slide->residual, order, floor);
  mg_solve_least_norm_qr(n, rank, slide->derivative, slide->residual, y, scratch);
  for (int k = 0; k < n; k++) {
    const int which = slide->of[order[k]];
    mg_set_sliding_branch(c, which, c->run->branch[which] + y[k]);
  }
}

/* Notes the residuals on the present branches; returns 1 if they are zero within rounding. */
static int mg_note_slide_residuals(const mg_context *c, mg_slide *slide) {
  int are_zero = 1;
  for (int k = 0; k < slide->n; k++) {
    slide->residual[k] = mg_slide_residual(c, slide->of[k]);
    are_zero &= fabs(slide->residual[k]) <= c->switches.noise[slide->of[k]] / c->system->time;
  }
  return are_zero;
}

MG_INTERNAL int mg_continue_slide(const mg_context *c, mg_slide *slide) {
  if (!slide->n) return 0;
  if (slide->trial >= 0) mg_note_shifted_branch(c, slide);
  else if (slide->round == MG_SLIDE_ROUNDS || mg_note_slide_residuals(c, slide)) return 0;
  if (++slide->trial < slide->n) {
    mg_shift_branch(c, slide);
    return 1;
  }
  mg_correct_branches(c, slide);
  slide->trial = -1, slide->round++;
  return 1;
}
