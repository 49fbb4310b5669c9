/* The certificate, on the scaled form and on the problem as it was given. */
#include "friction_scaled.h"

MG_INTERNAL mg_real mg_friction_norm(int k, const mg_real *x)
{
  if (k == 1) return (mg_real)fabs(x[0]);
  return (mg_real)sqrt(x[0] * x[0] + x[1] * x[1]);
}

/* |f - P_radius(f - w / rho)| sqrt(rho) of a disc of k axes. */
static mg_real mg_friction_disc_error(int k, const mg_real *f, const mg_real *w, mg_real rho, mg_real radius)
{
  mg_real q[2] = {0, 0}, size, error[2] = {0, 0};
  for (int i = 0; i < k; ++i) q[i] = f[i] - w[i] / rho;
  size = mg_friction_norm(k, q);
  if (!(radius > 0)) radius = 0;
  for (int i = 0; i < k; ++i) error[i] = size > radius ? f[i] - q[i] * (radius / size) : w[i] / rho;
  return mg_friction_norm(k, error) * (mg_real)sqrt(rho);
}

MG_INTERNAL mg_real mg_friction_slack(const mg_frictional *s, int contact)
{
  mg_real slack = s->v[s->normal[contact]];
  for (int p = s->part[contact]; s->theta > 0 && p < s->part[contact + 1]; ++p)
    slack -= s->theta * mg_friction_norm(s->part_dim[p], s->v + s->part_row[p]);
  return slack;
}

/* Of y and v as they stand. */
MG_INTERNAL mg_real mg_friction_error(const mg_frictional *s)
{
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
  return worst;
}

/* v = S y + c */
MG_INTERNAL void mg_friction_motion(mg_frictional *s)
{
  for (int i = 0; i < s->m; ++i) s->v[i] = s->c[i];
  for (int j = 0; j < s->m; ++j) {
    const mg_real *column = s->S + j * s->m, value = s->y[j];
    for (int i = 0; i < s->m; ++i) s->v[i] += column[i] * value;
  }
}

/* What rounding lets the error of y be: that of S y grows with y. A quarter of the cap is kept for the way back. */
MG_INTERNAL mg_real mg_friction_tolerance(const mg_frictional *s, const mg_real *y)
{
  const mg_real tolerance = mg_lcp_tolerance(s->m, mg_max_abs(s->m, y));
  return tolerance < MG_LCP_CAP / 4 ? tolerance : MG_LCP_CAP / 4;
}

/* Keeps y as the best if it is; returns whether it is good enough. */
MG_INTERNAL int mg_friction_keep(mg_frictional *s)
{
  const mg_real error = mg_friction_error(s);
  if (error < s->residual) {
    s->residual = error;
    for (int i = 0; i < s->m; ++i) s->best[i] = s->y[i];
  }
  return s->residual <= mg_friction_tolerance(s, s->best);
}

typedef struct {
  mg_real error, size, force; /* largest of the certificate, of b, of z, all in its units */
} mg_friction_measure;

static mg_real mg_friction_row(const mg_friction_problem *p, const mg_real *z, int row)
{
  mg_real w = p->b[row];
  for (int j = 0; j < p->n; ++j) w += p->A[row + j * p->n] * z[j];
  return w;
}

static void mg_friction_note(mg_friction_measure *at, mg_real error, mg_real size, mg_real force)
{
  if (!(error <= at->error)) at->error = error;
  if (size > at->size) at->size = size;
  if (force > at->force) at->force = force;
}

/* One part of a contact; returns |mu w|, by which the relaxed law lowers w_n. */
static mg_real mg_friction_part(const mg_friction_problem *p, const mg_real *z, int row, int count, const mg_real *mu,
                                mg_real normal, mg_friction_measure *at)
{
  mg_real f[2] = {0, 0}, w[2] = {0, 0}, b[2] = {0, 0}, rho = 0, root;
  int k = 0;
  for (int i = 0; i < count; ++i) {
    if (!(mu[i] > 0)) {
      if (fabs(z[row + i]) > 0) at->error = MG_MAX;
      continue;
    }
    f[k] = z[row + i] / mu[i];
    w[k] = mu[i] * mg_friction_row(p, z, row + i);
    b[k] = mu[i] * p->b[row + i];
    rho += mu[i] * mu[i] * (mg_real)fabs(p->A[(row + i) * (p->n + 1)]);
    ++k;
  }
  if (k == 0) return 0;
  rho = rho > 0 ? rho / (mg_real)k : (mg_real)1;
  root = (mg_real)sqrt(rho);
  mg_friction_note(at, mg_friction_disc_error(k, f, w, rho, normal), mg_friction_norm(k, b) / root, normal * root);
  return mg_friction_norm(k, w);
}

static void mg_friction_one(const mg_friction_problem *p, const mg_real *z, int contact, mg_friction_measure *at)
{
  const int row = p->first[contact], rows = p->rows[contact];
  const mg_real *cone = p->cone + MG_CONE * contact, rolling[2] = {cone[3], cone[3]};
  const mg_real d = mg_diagonal_scale((mg_real)fabs(p->A[row * (p->n + 1)]));
  mg_real w = mg_friction_row(p, z, row), moves = 0, force = z[row] * d;
  if (rows >= 3) moves += mg_friction_part(p, z, row + 1, 2, cone, z[row], at);
  if (rows >= 6) moves += mg_friction_part(p, z, row + 3, 1, cone + 2, z[row], at);
  if (rows >= 6) moves += mg_friction_part(p, z, row + 4, 2, rolling, z[row], at);
  w = (p->law == MG_RELAXED ? w - moves : w) / d;
  mg_friction_note(at, (mg_real)fabs(force < w ? force : w), (mg_real)fabs(p->b[row]) / d, force);
}

static int mg_friction_is_bilateral(const mg_friction_problem *p, int row)
{
  for (int c = 0; c < p->n_contact; ++c)
    if (row >= p->first[c] && row < p->first[c] + p->rows[c]) return 0;
  return 1;
}

MG_INTERNAL mg_real mg_friction_certify(const mg_friction_problem *p, const mg_real *z, mg_real *growth)
{
  mg_friction_measure at = {0, 0, 0};
  for (int c = 0; c < p->n_contact; ++c) mg_friction_one(p, z, c, &at);
  for (int i = 0; i < p->n; ++i)
    if (mg_friction_is_bilateral(p, i)) {
      const mg_real d = mg_diagonal_scale((mg_real)fabs(p->A[i * (p->n + 1)]));
      mg_friction_note(&at, (mg_real)fabs(mg_friction_row(p, z, i)) / d, (mg_real)fabs(p->b[i]) / d, (mg_real)fabs(z[i]) * d);
    }
  *growth = at.size > 0 ? at.force / at.size : 0;
  if (!(at.error <= MG_MAX)) return MG_MAX;
  return at.size > 0 ? at.error / at.size : at.error;
}

MG_API mg_real mg_friction_residual(const mg_friction_problem *problem, const mg_real *z)
{
  mg_real growth;
  return mg_friction_certify(problem, z, &growth);
}
