/* The active set of closed contacts without friction: which of them carry force, by a complementarity problem in the
   gap accelerations. Writes run->active, forces and slopes. */
#include "forces/forces.h"
#include "model/model.h"
#include "solve/lcp/lcp_solvers.h"

/* Whether all of the first n rows of c->lcp.rows may be active: none pulls. Where masses differ so much that the
   complementarity problem is solved to fewer digits than its certificate asks for, its matrix is not the way to tell.
 */
static int mg_may_all_be_active(mg_context *c, int n) {
  for (int r = 0; r < n; r++) c->run->active[c->lcp.rows[r]] = 1;
  mg_evaluate_run_state(c);
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (c->run->active[i] && !(c->solution.force[i] > 0)) return 0;
  return 1;
}

MG_INTERNAL int mg_solve_active_set(mg_context *c, const int *skip) {
  const int m = c->system->n_contact;
  if (c->system->n_friction) return mg_solve_patch_friction_modes(c, skip);
  mg_lcp_report report;
  int n = 0, carrying = 0;
  for (int i = 0; i < m; i++) mg_set_active(c, i, 0);
  mg_evaluate_run_state(c);
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (c->run->closed[i] && !skip[i]) c->lcp.rows[n++] = i;
  const int supports = mg_activate_supports(c);
  if (n == 0) {
    if (supports) mg_evaluate_run_state(c);
    return MG_DONE;
  }
  for (int i = c->layout.joint_row_begin; i < c->layout.joint_row_end; i++)
    c->rows.row_rate[i] = mg_row_imbalance(c, i);
  for (int r = 0; r < n; r++)
    c->rows.row_rate[c->lcp.rows[r]] = mg_row_acceleration(c, c->lcp.rows[r]), c->lcp.mask[r] = 1;
  if (mg_solve_force_lcp(c, n, c->rows.row_rate, &report) != MG_LCP_SOLVED)
    return mg_may_all_be_active(c, n) ? MG_DONE : MG_COMPLEMENTARITY;
  mg_report_residual(c->run, report.residual);
  for (int r = 0; r < n; r++) c->run->active[c->lcp.rows[r]] = c->lcp.mask[r] != 0, carrying += c->lcp.mask[r] != 0;
  mg_report_redundancy(c->run, carrying - report.rank);
  mg_evaluate_run_state(c);
  return MG_DONE;
}
