/* Friction problems with slipping patches: the friction of a patch makes the columns of its supports unsymmetric,
   so the bilateral rows (supports, joints) are eliminated here; the friction solver eliminates symmetric rows only.
   Reads the assembled problem; writes its solution. */
#include "forces/forces.h"
#include "base/base.h"
#include "model/model.h"
#include "solve/friction/friction_solvers.h"

/* True if a patch with friction slips. */
static int mg_has_slipping_patch(const mg_context *c) {
  for (int slot = 0; slot < c->system->n_patch_slot; slot++)
    if (c->patches.friction[slot].slips) return 1;
  return 0;
}

/* Solve A_bb x = -y of least norm over the bilateral rows, those from m on. */
static void mg_solve_bilateral_forces(mg_context *c, const mg_friction_problem *p, int m, const mg_real *y,
                                      mg_real *x) {
  mg_solve_least_norm_rows(c, c->lcp.rows + m, p->n - m, p->A + m + p->n * m, p->n, y, x);
}

/* True if bilateral rows hold the slip of the contact k of a problem along one of its tangents, and forces of least
   norm have no friction along it: the block of its rows, less what bilateral rows do and with the gap closed, is
   singular in that direction, not in its normal row, and the bilateral forces that friction there might replace are
   zero. */
static int mg_is_slip_held(mg_context *c, const mg_friction_problem *p, int m, int k, const mg_real *z) {
  const int first = p->first[k], n = p->n, bilateral = n - m;
  const mg_real part = c->settings->contact_rank_tolerance;
  mg_real S[9], *x = c->lcp.work + bilateral * (bilateral + 4); /* behind the scratch of the bilateral forces */
  for (int j = 0; j < 3; j++, x += bilateral) {
    mg_solve_bilateral_forces(c, p, m, p->A + (long)n * (first + j) + m, x);
    for (int i = 0; i < 3; i++) {
      S[i + 3 * j] = p->A[first + i + (long)n * (first + j)];
      for (int r = 0; r < bilateral; r++) S[i + 3 * j] += p->A[first + i + (long)n * (m + r)] * x[r];
    }
  }
  if (!(S[0] > part * p->A[first + (long)n * first])) return 0;
  const mg_real xx = S[4] - S[1] * S[3] / S[0], yy = S[8] - S[2] * S[6] / S[0],
                xy = (S[5] - S[2] * S[3] / S[0] + S[7] - S[1] * S[6] / S[0]) / 2,
                size = p->A[first + 1 + (long)n * (first + 1)] + p->A[first + 2 + (long)n * (first + 2)],
                least = (xx + yy) / 2 - mg_hypot((xx - yy) / 2, xy);
  if (!(least <= part * size)) return 0;
  const mg_real angle = mg_atan2(2 * xy, xx - yy) / 2; /* of the direction that is free; across it slip is held */
  const mg_real across[2] = {-mg_sin(angle), mg_cos(angle)}, *second = x - bilateral, *one = second - bilateral;
  mg_real replaced = 0;
  for (int r = 0; r < bilateral; r++)
    replaced += (across[0] * one[r] + across[1] * second[r]) * (c->solution.force[c->lcp.rows[m + r]] + z[m + r]);
  return fabs(across[0] * z[first + 1] + across[1] * z[first + 2]) + fabs(replaced) <=
         c->settings->friction_bound_margin * fabs(z[first]);
}

MG_INTERNAL int mg_count_held_slip(mg_context *c, const mg_friction_problem *p, const mg_real *z) {
  MG_NEEDS_DIGEST(c, MG_VALID_MARKS, mg_solution_digest(c, p, z));
  int m = 0, count = 0;
  for (int k = 0; k < p->n_contact; k++) m += p->rows[k];
  for (int k = 0; m < p->n && k < p->n_contact; k++) {
    const int g = c->system->contact_friction[c->friction.cone_contact[k]];
    const int sticks = p->rows[k] >= 3 && c->system->friction_kind[g] == MG_FRICTION_SLIP &&
                       c->friction.bound[g] != MG_BOUND_SLIP && (c->friction.marks[k] & MG_MARK_FORCE) &&
                       !(c->friction.marks[k] & MG_MARK_SLIP);
    count += sticks && mg_is_slip_held(c, p, m, k, z);
  }
  return count;
}

/* Eliminates the rows from m on of n listed rows of the assembled matrix A [n n] from a column of n accelerations: the
   first m of them, with forces on the others that keep theirs. Writes out [m], and x [n - m], those forces. */
static void mg_eliminate_bilateral_rows(mg_context *c, int m, int n, const mg_real *A, const mg_real *column,
                                        mg_real *x, mg_real *out) {
  mg_solve_least_norm_rows(c, c->lcp.rows + m, n - m, A + m + (long)n * m, n, column + m, x);
  for (int i = 0; i < m; i++) {
    out[i] = column[i];
    for (int r = 0; r < n - m; r++) out[i] += A[i + (long)n * (m + r)] * x[r];
  }
}

MG_INTERNAL int mg_solve_friction_with_bilaterals(mg_context *c, const mg_friction_problem *p, mg_real *z,
                                                  mg_friction_report *report) {
  MG_REQUIRE(mg_are_contact_rows_first(c, p));
  int m = 0;
  for (int k = 0; k < p->n_contact; k++) m += p->rows[k];
  if (!mg_has_slipping_patch(c) || m == p->n)
    return mg_friction(p, z, c->friction.marks, report, c->friction.work, c->friction.iwork);
  const int k = p->n - m;
  mg_real *A = c->patches.reduced_problem, *b = A + m * m, *x = b + m;
  for (int j = 0; j <= m; j++)
    mg_eliminate_bilateral_rows(c, m, p->n, p->A, j < m ? p->A + p->n * j : p->b, x, j < m ? A + m * j : b);
  mg_friction_problem own = *p;
  own.n = m, own.A = A, own.b = b;
  const int outcome = mg_friction(&own, z, c->friction.marks, report, c->friction.work, c->friction.iwork);
  for (int r = 0; r < k; r++) {
    b[r] = p->b[m + r];
    for (int j = 0; j < m; j++) b[r] += p->A[m + r + p->n * j] * z[j];
  }
  mg_solve_bilateral_forces(c, p, m, b, z + m);
  return outcome;
}
