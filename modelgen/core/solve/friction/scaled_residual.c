/* Residual of a friction problem in the scaled form: the natural map of Signorini's condition and Coulomb's law. */
#include "solve/friction/friction_solvers.h"
#include "base/base.h"
#include "solve/lcp/lcp_solvers.h"

MG_INTERNAL mg_real mg_friction_norm(int k, const mg_real *x) {
  if (k == 1) return (mg_real)fabs(x[0]);
  return (mg_real)sqrt(x[0] * x[0] + x[1] * x[1]);
}

MG_INTERNAL mg_real mg_friction_disc_error(int k, const mg_real *f, const mg_real *w, mg_real rho, mg_real radius) {
  mg_real q[2] = {0, 0}, size, error[2] = {0, 0};
  for (int i = 0; i < k; ++i) q[i] = f[i] - w[i] / rho;
  size = mg_friction_norm(k, q);
  if (!(radius > 0)) radius = 0;
  for (int i = 0; i < k; ++i) error[i] = size > radius ? f[i] - q[i] * (radius / size) : w[i] / rho;
  return mg_friction_norm(k, error) * (mg_real)sqrt(rho);
}

MG_INTERNAL mg_real mg_friction_slip(const mg_scaled_friction *s, int contact) {
  mg_real slip = 0;
  for (int p = s->part[contact]; p < s->part[contact + 1]; ++p)
    slip += mg_friction_norm(s->part_dim[p], s->v + s->part_row[p]);
  return slip;
}

MG_INTERNAL mg_real mg_friction_slack(const mg_scaled_friction *s, int contact) {
  mg_real slack = s->v[s->normal[contact]];
  for (int p = s->part[contact]; s->theta > 0 && p < s->part[contact + 1]; ++p)
    slack -= s->theta * mg_friction_norm(s->part_dim[p], s->v + s->part_row[p]);
  return slack;
}

MG_INTERNAL mg_real mg_friction_error(const mg_scaled_friction *s) {
  mg_real worst = 0;
  for (int c = 0; c < s->n; ++c) {
    const mg_real force = s->y[s->normal[c]], slack = mg_friction_slack(s, c);
    mg_real error = (mg_real)fabs(force < slack ? force : slack);
    if (!(error <= MG_MAX)) return MG_MAX;
    worst = error > worst ? error : worst;
    for (int p = s->part[c]; p < s->part[c + 1]; ++p) {
      const int i = s->part_row[p];
      error = mg_friction_disc_error(s->part_dim[p], s->y + i, s->v + i, s->rho[p], force);
      if (!(error <= MG_MAX)) return MG_MAX;
      worst = error > worst ? error : worst;
    }
  }
  for (int i = s->m; i < mg_friction_rows(s); ++i) {
    const mg_real error = (mg_real)fabs(s->v[i]);
    if (!(error <= MG_MAX)) return MG_MAX;
    worst = error > worst ? error : worst;
  }
  return worst;
}

MG_INTERNAL void mg_friction_update_motion(mg_scaled_friction *s) {
  if (s->graph.J) {
    mg_graph_set_motion(s, s->y, s->graph.motion);
    mg_graph_update_rows(s, 0, mg_friction_rows(s));
    return;
  }
  for (int i = 0; i < s->m; ++i) s->v[i] = s->c[i];
  for (int j = 0; j < s->m; ++j) {
    const mg_real *column = s->S + j * s->m, value = s->y[j];
    for (int i = 0; i < s->m; ++i) s->v[i] += column[i] * value;
  }
}

#define MG_LCP_ROUNDED (10000 * MG_LCP_CAP) /* above this, rounding leaves nothing of the motion to rely on */

MG_INTERNAL mg_real mg_friction_cap(mg_real growth) {
  return mg_max(MG_LCP_CAP, mg_min(4 * MG_EPS * growth, MG_LCP_ROUNDED));
}

MG_INTERNAL mg_real mg_friction_tolerance(const mg_scaled_friction *s, const mg_real *y) {
  const int rows = mg_friction_rows(s);
  const mg_real growth = mg_max_abs(rows, y), tolerance = mg_lcp_tolerance(rows, growth),
                cap = mg_friction_cap(growth) / 4;
  return tolerance < MG_LCP_CAP ? mg_min(tolerance, cap) : cap;
}

MG_INTERNAL int mg_friction_is_stopped(const mg_scaled_friction *s) {
  return mg_is_raised(s->given->stop) || (s->given->newton_max > 0 && s->newton >= s->given->newton_max);
}

MG_INTERNAL int mg_friction_is_accepted(const mg_scaled_friction *s) {
  const mg_real accepted = s->given->accepted;
  return accepted > 0 && s->residual <= mg_max(accepted, MG_LCP_CAP / 4);
}

MG_INTERNAL int mg_friction_update_best(mg_scaled_friction *s) {
  const mg_real error = mg_friction_error(s);
  if (error < s->residual) {
    s->residual = error;
    for (int i = 0; i < mg_friction_rows(s); ++i) s->best[i] = s->y[i];
  }
  return s->residual <= mg_friction_tolerance(s, s->best);
}
