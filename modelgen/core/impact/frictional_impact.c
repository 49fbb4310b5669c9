/* Impacts with friction: Newton's restitution and Coulomb's law for impulses at all closed contacts at once
   (Moreau; Glocker and Pfeiffer, Nonlinear Dynamics 7 (1995), 471-497, with Newton's law in place of Poisson's).
   Writes the impulses. */
#include "impact/impact.h"
#include "solve/friction/friction_solvers.h"
#include "model/model.h"
#include "forces/forces.h"

/* Fill the friction cone of a contact with its kinetic coefficients. */
static void mg_set_kinetic_cone(mg_context *c, int contact, mg_real *cone) {
  for (int k = 0; k < MG_CONE; k++) cone[k] = 0;
  for (int g = c->system->contact_friction[contact]; g < c->system->contact_friction[contact + 1]; g++) {
    mg_set_cone_coefficients(c, g, c->system->friction_kinetic, 1, cone);
    c->friction.bound[g] = MG_BOUND_KINETIC;
  }
}

/* Assemble the friction problem of impulses: closed contacts that no patch covers, supports and joints, with the
   required change of velocity as right-hand side. */
static mg_friction_problem mg_assemble_impact_problem(mg_context *c) {
  mg_friction_problem p = {
      0,        0,        MG_COULOMB, 0, c->friction.cone_first, c->friction.cone_rows,       c->friction.cone,
      c->lcp.A, c->lcp.b, 0,          0, c->run->stop,           c->settings->sweep_from_last};
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    if (!c->run->closed[i] || c->patches.is_covered[i]) continue;
    mg_set_kinetic_cone(c, i, c->friction.cone + MG_CONE * p.n_contact);
    p.n = mg_append_friction_contact(c, i, p.n_contact++, p.n);
  }
  p.n = mg_append_bilateral_rows(c, c->lcp.rows, p.n);
  mg_assemble_delassus(c, c->lcp.rows, p.n);
  mg_set_support_impact_rates(c);
  for (int r = 0; r < p.n; r++) {
    const int row = c->lcp.rows[r];
    c->lcp.b[r] = row < c->layout.support_begin        ? c->rows.d_dot[row] * (1 + mg_effective_restitution(c, row))
                  : row < c->layout.friction_row_begin ? c->rows.row_rate[row]
                                                       : c->rows.d_dot[row];
    c->lcp.z[r] = 0;
  }
  return p;
}

MG_INTERNAL int mg_solve_frictional_impulses(mg_context *c) {
  mg_friction_report report;
  const mg_friction_problem p = mg_assemble_impact_problem(c);
  int n = 0;
  mg_report_solve(c->run);
  if (mg_friction(&p, c->lcp.z, c->friction.marks, &report, c->friction.work, c->friction.iwork)) return -1;
  for (int k = 0; k < p.n_contact; k++) n += c->friction.cone_rows[k];
  for (int i = c->layout.support_begin; i < c->system->n_contact; i++) c->solution.impulse[i] = 0;
  for (int r = n; r < p.n; r++) c->solution.impulse[c->lcp.rows[r]] = c->lcp.z[r];
  MG_NOTE_DIGEST(c, MG_VALID_IMPULSES, mg_impulse_digest(c, n));
  return n;
}
