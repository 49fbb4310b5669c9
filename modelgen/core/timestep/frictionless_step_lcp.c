/* The complementarity problem of many contacts without joints, springs and friction: by conjugate gradients on the rows
   and bodies, whose cost grows with the number of contacts, not with its cube. Writes the complementarity workspace. */
#include "timestep/timestep.h"
#include "base/base.h"
#include "solve/lcp/lcp_solvers.h"
#include "model/model.h"
#include "forces/forces.h"

#define MG_USEFUL ((mg_real)0.5) /* residual of a correction that leaves less than it found */

enum {
  MG_MANY_CONTACTS = 40,  /* from here on conjugate gradients cost less than a factorisation, */
  MG_SOME_CONTACTS = 8,   /* and from here on where a tolerance is given */
  MG_MANY_ITERATIONS = 20 /* bound of the iterations, times the bound of those of mg_qp */
};

/* Copies the rows of c->lcp.rows to the memory of the dense matrix, which is larger. */
static mg_row_matrix mg_gather_rows(mg_context *c, int n) {
  mg_real *J = c->lcp.A, *MJ = c->lcp.A + 12L * n;
  int *o = c->lcp.iwork, *f = o + n;
  for (int r = 0; r < n; r++) {
    const int row = c->lcp.rows[r];
    mg_update_inverse_mass_row(c, row);
    o[r] = mg_is_moved_by_forces(c, c->contacts.o[row]) ? c->contacts.o[row] : -1;
    f[r] = mg_is_moved_by_forces(c, c->contacts.f[row]) ? c->contacts.f[row] : -1;
    for (int k = 0; k < 12; k++) J[12 * r + k] = c->rows.J[12 * row + k], MJ[12 * r + k] = c->rows.MJ[12 * row + k];
  }
  const mg_row_matrix matrix = {n, c->system->n_body, o, f, J, MJ};
  return matrix;
}

/* True if the problem has many contacts and nothing else. */
static int mg_has_many_contacts_alone(const mg_context *c, int n, mg_real tolerance) {
  return n >= (tolerance > 0 ? MG_SOME_CONTACTS : MG_MANY_CONTACTS) && mg_append_bilateral_rows(c, c->lcp.rows, n) == n;
}

MG_INTERNAL int mg_solve_step_lcp(mg_context *c, int n, const mg_real *value, const mg_real *guess, mg_real tolerance,
                                  mg_lcp_report *report) {
  if (mg_has_many_contacts_alone(c, n, tolerance)) {
    const mg_row_matrix matrix = mg_gather_rows(c, n);
    for (int r = 0; r < n; r++) c->lcp.b[r] = value[c->lcp.rows[r]], c->lcp.z[r] = guess ? guess[c->lcp.rows[r]] : 0;
    mg_report_qp_solve(c->run);
    mg_large_qp_solve(&matrix, c->lcp.b, tolerance, MG_MANY_ITERATIONS * c->settings->lcp_iterations, c->lcp.z, report,
                      c->lcp.work);
    if (report->outcome == MG_LCP_SOLVED || (tolerance > 0 && report->residual < MG_USEFUL)) return MG_LCP_SOLVED;
  }
  return mg_solve_contact_lcp(c, n, value, report);
}
