/* Impacts with friction: Newton's restitution and Coulomb's law for impulses at all closed contacts at once
   (Moreau; Glocker and Pfeiffer, Nonlinear Dynamics 7 (1995), 471-497, with Newton's law in place of Poisson's).
   Writes the impulses. Where bodies alone do not decide how contacts share a blow, as the corners of a face, those are
   taken of contacts that are equally stiff: friction, and so the motion after the blow, depends on the shares. */
#include "impact/impact.h"
#include "base/base.h"
#include "solve/friction/friction_solvers.h"
#include "model/model.h"
#include "forces/forces.h"

#define MG_SHARE_YIELD ((mg_real)1e-3)  /* of contacts that share a blow, over the mean diagonal entry of the gaps */
#define MG_SHARE_SETTLED (512 * MG_EPS) /* change of the impulses of a round, relative, at which they are found */
#define MG_SHARE_ROUNDS 60

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
      0,        0,        MG_COULOMB, 0, c->friction.cone_first, c->friction.cone_rows,        c->friction.cone,
      c->lcp.A, c->lcp.b, 0,          0, c->run->stop,           c->settings->sweep_from_last, 0,
      0};
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

/* True if the gaps of a problem depend on each other, or on joints and supports. */
static int mg_are_gaps_dependent(mg_context *c, const mg_friction_problem *p) {
  int *list = c->islands.rows, *order = c->lcp.iwork, n = 0, m = 0;
  mg_real *L = c->lcp.work;
  for (int k = 0; k < p->n_contact; k++) list[n++] = p->first[k], m += p->rows[k];
  if (n < 2) return 0;
  for (int r = m; r < p->n; r++) list[n++] = r;
  for (int j = 0; j < n; j++)
    for (int i = 0; i < n; i++) {
      const mg_real size = p->A[list[i] * (long)(p->n + 1)] * p->A[list[j] * (long)(p->n + 1)];
      L[i + j * n] = size > 0 ? p->A[list[i] + (long)p->n * list[j]] / (mg_real)sqrt(size) : 0;
    }
  return mg_cholesky_pivoted(n, L, order, c->settings->contact_rank_tolerance, 0) < n;
}

/* Largest change of the normal impulses of a problem, over the largest of them; stores them. */
static mg_real mg_change_of_normal_impulses(const mg_friction_problem *p, const mg_real *z, mg_real *before) {
  mg_real change = 0, size = 0;
  for (int k = 0; k < p->n_contact; k++) {
    const mg_real now = z[p->first[k]];
    change = mg_max(change, (mg_real)fabs(now - before[k])), size = mg_max(size, (mg_real)fabs(now));
    before[k] = now;
  }
  return size > 0 ? change / size : 0;
}

/* Impulses of contacts that yield alike, as the yield goes to zero: a proximal point method from z = 0, whose problems
   have one solution each. Returns 0 if one is not solved. */
static int mg_share_impulses_evenly(mg_context *c, const mg_friction_problem *p, mg_friction_report *report) {
  mg_real *before = c->friction.share, yield = 0;
  int is_solved = 1;
  for (int k = 0; k < p->n_contact; k++)
    before[k] = 0, yield += MG_SHARE_YIELD * p->A[p->first[k] * (long)(p->n + 1)] / p->n_contact;
  for (int r = 0; r < p->n; r++) c->lcp.z[r] = 0;
  for (int k = 0; k < p->n_contact; k++) c->lcp.A[p->first[k] * (long)(p->n + 1)] += yield;
  for (int round = 0; round < MG_SHARE_ROUNDS && is_solved; round++) {
    for (int k = 0; k < p->n_contact; k++) c->lcp.b[p->first[k]] -= yield * before[k];
    is_solved = !mg_friction(p, c->lcp.z, c->friction.marks, report, c->friction.work, c->friction.iwork);
    for (int k = 0; k < p->n_contact; k++) c->lcp.b[p->first[k]] += yield * before[k];
    if (mg_change_of_normal_impulses(p, c->lcp.z, before) < MG_SHARE_SETTLED) break;
  }
  for (int k = 0; k < p->n_contact; k++) c->lcp.A[p->first[k] * (long)(p->n + 1)] -= yield;
  return is_solved;
}

/* Solves the problem for impulses into c->lcp.z. Returns 0 without a solution. */
static int mg_solve_impact_problem(mg_context *c, const mg_friction_problem *p) {
  mg_friction_report report;
  if (mg_are_gaps_dependent(c, p) && !mg_share_impulses_evenly(c, p, &report))
    for (int r = 0; r < p->n; r++) c->lcp.z[r] = 0;
  const int outcome = mg_friction(p, c->lcp.z, c->friction.marks, &report, c->friction.work, c->friction.iwork);
  mg_count_friction_solve(c, p->n, &report);
  return outcome == MG_FRICTION_SOLVED;
}

MG_INTERNAL int mg_solve_frictional_impulses(mg_context *c) {
  const mg_friction_problem p = mg_assemble_impact_problem(c);
  int n = 0;
  mg_report_friction_solve(c->run, MG_COULOMB);
  if (!mg_solve_impact_problem(c, &p)) return -1;
  for (int k = 0; k < p.n_contact; k++) n += c->friction.cone_rows[k];
  for (int i = c->layout.support_begin; i < c->system->n_contact; i++) c->solution.impulse[i] = 0;
  for (int r = n; r < p.n; r++) c->solution.impulse[c->lcp.rows[r]] = c->lcp.z[r];
  MG_NOTE_DIGEST(c, MG_VALID_IMPULSES, mg_impulse_digest(c, n));
  return n;
}
