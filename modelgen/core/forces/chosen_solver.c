/* Problems for forces and impulses, solved by the solver of the settings if there is one, else by the core. Writes the
   complementarity workspace and the statistics of the run. */
#include "forces/forces.h"
#include "solve/friction/friction_solvers.h"
#include "solve/lcp/lcp_solvers.h"
#include "model/model.h"

MG_INTERNAL int mg_has_outer_solver(const mg_context *c, const mg_friction_problem *p) {
  return c->settings->outer_solver && p->law == MG_COULOMB;
}

/* Solves a problem by the solver of the settings. Returns the outcome of mg_friction. */
static int mg_solve_outside(mg_context *c, const mg_friction_problem *p, mg_real *z, int *marks,
                            mg_friction_report *report) {
  const mg_outer_solver *outer = c->settings->outer_solver;
  const mg_friction_report none = {MG_FRICTION_NOT_FOUND, 0, 0, 1, 0, 0, MG_UNDECIDED, MG_MAX};
  *report = none;
  mg_report_outer_solve(c->run);
  return report->outcome = outer->solve(outer->of, p, z, marks, report);
}

MG_INTERNAL int mg_solve_friction_problem(mg_context *c, const mg_friction_problem *p, mg_real *z, int *marks,
                                          mg_friction_report *report) {
  if (mg_has_outer_solver(c, p)) return mg_solve_outside(c, p, z, marks, report);
  mg_report_friction_solve(c->run, p->law);
  return mg_friction(p, z, marks, report, c->friction.work, c->friction.iwork);
}

MG_INTERNAL int mg_solve_force_lcp(mg_context *c, int n, const mg_real *value, mg_lcp_report *report) {
  if (!c->settings->outer_solver) return mg_solve_contact_lcp(c, n, value, report);
  const int size = mg_append_bilateral_rows(c, c->lcp.rows, n);
  int *first = c->lcp.iwork, *rows = first + n, *marks = rows + n;
  mg_friction_report found;
  mg_assemble_delassus(c, c->lcp.rows, size);
  for (int r = 0; r < size; r++) c->lcp.b[r] = value[c->lcp.rows[r]], c->lcp.z[r] = 0;
  for (int k = 0; k < n; k++) first[k] = k, rows[k] = 1;
  for (int k = 0; k < MG_CONE * n; k++) c->lcp.work[k] = 0;
  const mg_friction_problem p = {size, n, MG_COULOMB,   1, first, rows, c->lcp.work, c->lcp.A, c->lcp.b,
                                 0,    0, c->run->stop, 0, 0,     0};
  const int outcome = mg_solve_outside(c, &p, c->lcp.z, marks, &found);
  if (outcome == MG_FRICTION_NOT_FOUND) return mg_solve_contact_lcp(c, n, value, report);
  for (int k = 0; k < n; k++) c->lcp.mask[k] = (marks[k] & MG_MARK_FORCE) != 0;
  report->outcome = outcome == MG_FRICTION_SOLVED       ? MG_LCP_SOLVED
                    : outcome == MG_FRICTION_INFEASIBLE ? MG_LCP_INFEASIBLE
                                                        : MG_LCP_NOT_FINITE;
  report->iterations = found.newton, report->rank = found.rank, report->residual = found.residual;
  return report->outcome;
}
