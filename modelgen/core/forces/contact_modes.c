/* forces/contact_modes */
#include "forces/forces.h"
#include "solve/lcp/solvers.h"

MG_INTERNAL mg_real mg_slack(const mg_context *c) {
  return c->set->rest_acceleration * c->sys->length / (c->sys->time * c->sys->time);
}

/* The pads of patches that are held carry force; the rates of their rows under the accelerations last computed. */
MG_INTERNAL int mg_activate_pads(mg_context *c) {
  int count = 0;
  for (int i = c->first_pad; i < c->sys->n_contact; i++) {
    if (!c->run->closed[i]) continue;
    c->run->active[i] = 1, c->rate[i] = mg_separation(c, i);
    count++;
  }
  return count;
}

/* Solves for the active set among the closed contacts that are not skipped. */
MG_INTERNAL int mg_choose_active(mg_context *c, const int *skip) {
  const int m = c->sys->n_contact;
  if (c->sys->n_grip) return mg_choose_rubs(c, skip);
  mg_lcp_report report;
  int n = 0, carrying = 0;
  for (int i = 0; i < m; i++) c->run->active[i] = 0;
  mg_refresh(c);
  for (int i = 0; i < c->first_pad; i++)
    if (c->run->closed[i] && !skip[i]) c->list[n++] = i;
  const int pads = mg_activate_pads(c);
  if (n == 0) {
    if (pads) mg_refresh(c);
    return MG_DONE;
  }
  for (int i = c->bilateral; i < c->n_rows; i++) c->rate[i] = mg_separation(c, i);
  for (int r = 0; r < n; r++) c->rate[c->list[r]] = mg_separation(c, c->list[r]), c->mask[r] = 1;
  if (mg_complement(c, n, c->rate, &report) != MG_LCP_SOLVED) return MG_COMPLEMENTARITY;
  if (report.residual > c->run->lcp_residual_max) c->run->lcp_residual_max = report.residual;
  for (int r = 0; r < n; r++) c->run->active[c->list[r]] = c->mask[r] != 0, carrying += c->mask[r] != 0;
  if (carrying - report.rank > c->run->redundant_max) c->run->redundant_max = carrying - report.rank;
  mg_refresh(c);
  return MG_DONE;
}
