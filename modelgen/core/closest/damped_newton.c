/* Damped Newton's method on the extremality equations of any contact kind (section 2 of Anitescu, Cremer and
   Potra, 1995), with bounded steps and step halving, for starts that are not near. Reads nothing of the run. */
#include "closest/closest.h"
#include "model/model.h"

MG_INTERNAL void mg_place_pair(const mg_shape_pair *p, const mg_real *eta, mg_real *next, mg_real *placed) {
  p->kernels->contact_place(p->kind, p->pose_o, p->pose_f, eta, p->parameters, next, placed, placed + 1, placed + 3,
                            placed + 5, placed + 8, placed + 11);
}

/* Residual as one dimensionless number. */
static mg_real mg_newton_merit(const mg_newton_goal *goal, const mg_real *placed) {
  return placed[1] / goal->length + placed[2];
}

/* Part of the step from eta to `next` that keeps each entry within its limit; 0 if the step is not finite. */
static mg_real mg_bounded_step_part(const mg_newton_goal *goal, const mg_real *eta, const mg_real *next, int n) {
  mg_real part = 1;
  for (int k = 0; k < n; k++) {
    const mg_real step = fabs(next[k] - eta[k]);
    if (!(step <= MG_MAX)) return 0;
    if (part * step > goal->step_limit[k]) part = goal->step_limit[k] / step;
  }
  return part;
}

/* Halves the step until the merit falls; returns 0 if it does not. Entries without limit are signs and are taken
   whole. */
static int mg_damped_step(const mg_shape_pair *p, const mg_newton_goal *goal, mg_real *eta, mg_real *next,
                          mg_real *placed) {
  const int n = p->kernels->contact_kinds[p->kind].n_eta;
  const mg_real before = mg_newton_merit(goal, placed);
  mg_real there[MG_MAX_ETA], after[MG_MAX_ETA] = {0}, part = mg_bounded_step_part(goal, eta, next, n);
  for (int halving = 0; halving < 12 && part > 0; halving++, part /= 2) {
    for (int k = 0; k < n; k++) there[k] = goal->step_limit[k] < MG_MAX ? eta[k] + part * (next[k] - eta[k]) : next[k];
    mg_place_pair(p, there, after, placed);
    if (!(mg_newton_merit(goal, placed) < (1 - part / 1000) * before)) continue;
    for (int k = 0; k < n; k++) eta[k] = there[k], next[k] = after[k];
    return 1;
  }
  return 0;
}

MG_INTERNAL int mg_damped_newton(const mg_shape_pair *p, const mg_newton_goal *goal, mg_real *eta, mg_real *placed) {
  mg_real next[MG_MAX_ETA] = {0};
  mg_place_pair(p, eta, next, placed);
  for (int step = 0; step < 100; step++) {
    if (mg_is_residual_small(p->pose_o, p->pose_f, goal->tolerance, goal->length, placed)) return step;
    if (!mg_damped_step(p, goal, eta, next, placed)) break;
  }
  mg_place_pair(p, eta, next, placed);
  return -1;
}

MG_INTERNAL int mg_is_minimum(const mg_real *placed) { return placed[3] > 0; }
