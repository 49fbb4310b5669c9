/* How much computing forces and steps take, in evaluations of the equations of one contact. Writes c->step.work. */
#include "forces/forces.h"
#include "model/model.h"

enum {
  MG_EVALUATIONS_OF_PATCH = 60,   /* equations of one contact that cost as much as a pressure of a planar contact */
  MG_PIVOTS_PER_EVALUATION = 300, /* cubes of the number of forces that cost as much as one contact's equations */
  MG_FACTORISATIONS_MAX = 1 << 20 /* more are no bound */
};

MG_INTERNAL mg_real mg_work_of_equations(const mg_context *c) {
  return c->listed.n_contact + (c->system->n_switch > 0);
}

MG_INTERNAL void mg_count_evaluations(mg_context *c, int count) {
  c->run->rhs_evals += count, c->step.work += count * mg_work_of_equations(c);
}

MG_INTERNAL void mg_count_pressure(mg_context *c) { c->step.work += MG_EVALUATIONS_OF_PATCH; }

static mg_real mg_work_of_factorisation(int n) { return (mg_real)n * n * n / MG_PIVOTS_PER_EVALUATION; }

MG_INTERNAL void mg_count_factorisation(mg_context *c, int n) { c->step.work += mg_work_of_factorisation(n); }

MG_INTERNAL void mg_count_friction_solve(mg_context *c, int n, const mg_friction_report *report) {
  c->step.work += (1 + report->newton) * mg_work_of_factorisation(n);
}

MG_INTERNAL int mg_affordable_factorisations(const mg_context *c, int n) {
  if (!c->settings->fallback || !c->step.chooses_modes || mg_is_time_stepping(c)) return 0;
  const mg_real left = (c->settings->chatter_work - c->run->event_work - c->step.work) / mg_work_of_factorisation(n);
  return (int)mg_max(1, mg_min(left, MG_FACTORISATIONS_MAX));
}

MG_INTERNAL int mg_is_mode_choice_too_costly(const mg_context *c) {
  return c->settings->fallback && !mg_is_time_stepping(c) && c->step.chooses_modes &&
         c->run->event_work + c->step.work > c->settings->chatter_work;
}
