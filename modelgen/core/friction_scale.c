/* From the problem to its scaled form without bilateral rows, and back. */
#include "friction_scaled.h"

static mg_real mg_friction_entry(const mg_frictional *s, int i, int j) { return s->given->A[i + j * s->given->n]; }

static mg_real mg_friction_diagonal(const mg_frictional *s, int i)
{
  return mg_diagonal_scale((mg_real)fabs(mg_friction_entry(s, i, i)));
}

/* x becomes (L L')^-1 x on the pivoted rows. */
static void mg_friction_back(const mg_frictional *s, mg_real *x)
{
  const int k = s->n_bilateral, r = s->rank;
  for (int j = 0; j < r; ++j) {
    x[j] /= s->L[j + j * k];
    for (int i = j + 1; i < r; ++i) x[i] -= s->L[i + j * k] * x[j];
  }
  for (int j = r - 1; j >= 0; --j) {
    for (int i = j + 1; i < r; ++i) x[j] -= s->L[i + j * k] * x[i];
    x[j] /= s->L[j + j * k];
  }
}

/* Of dependent bilateral rows those pivoted first stand for all. */
static void mg_friction_factor(mg_frictional *s)
{
  const int k = s->n_bilateral;
  for (int i = 0; i < k; ++i) s->e_b[i] = 1 / mg_friction_diagonal(s, s->bilateral[i]);
  for (int j = 0; j < k; ++j)
    for (int i = 0; i < k; ++i)
      s->L[i + j * k] = mg_friction_entry(s, s->bilateral[i], s->bilateral[j]) * s->e_b[i] * s->e_b[j];
  s->rank = mg_cholesky_pivoted(k, s->L, s->order, MG_LCP_RANK(k));
}

/* What is left of row and column i is rounding: the bilateral rows hold it. */
static void mg_friction_clear(mg_frictional *s, int i)
{
  for (int j = 0; j < s->m; ++j) s->S[i + j * s->m] = s->S[j + i * s->m] = 0;
}

/* S and c less what the bilateral rows take: S_cc - S_cb S_bb^-1 S_bc. */
static void mg_friction_eliminate(mg_frictional *s)
{
  const int m = s->m;
  mg_real *before = s->y;
  for (int i = 0; i < m; ++i) before[i] = (mg_real)fabs(s->S[i + i * m]);
  mg_friction_factor(s);
  for (int j = 0; j <= m; ++j) {
    mg_real *x = s->X + j * s->n_bilateral, *target = j < m ? s->S + j * m : s->c;
    for (int i = 0; i < s->rank; ++i) {
      const int b = s->order[i], row = s->bilateral[b];
      x[i] = s->e_b[b] * (j < m ? mg_friction_entry(s, row, s->row[j]) * s->e[j] : s->given->b[row]);
    }
    mg_friction_back(s, x);
    for (int k = 0; k < s->rank; ++k) {
      const int b = s->order[k];
      for (int i = 0; i < m; ++i)
        target[i] -= s->e[i] * mg_friction_entry(s, s->row[i], s->bilateral[b]) * s->e_b[b] * x[k];
    }
  }
  for (int i = 0; i < m; ++i)
    if (fabs(s->S[i + i * m]) <= MG_LCP_RANK(s->given->n) * before[i]) mg_friction_clear(s, i);
}

static void mg_friction_means(mg_frictional *s)
{
  for (int p = 0; p < s->n_part; ++p) {
    mg_real sum = 0;
    for (int i = s->part_row[p]; i < s->part_row[p] + s->part_dim[p]; ++i) sum += (mg_real)fabs(s->S[i + i * s->m]);
    s->rho[p] = sum > 0 ? sum / (mg_real)s->part_dim[p] : (mg_real)1;
  }
}

/* The largest motion without contact forces, in the units of the certificate. */
static mg_real mg_friction_size(const mg_frictional *s)
{
  mg_real largest = 0;
  for (int c = 0; c < s->n; ++c)
    if (fabs(s->c[s->normal[c]]) > largest) largest = (mg_real)fabs(s->c[s->normal[c]]);
  for (int p = 0; p < s->n_part; ++p) {
    mg_real size = mg_friction_norm(s->part_dim[p], s->c + s->part_row[p]) / (mg_real)sqrt(s->rho[p]);
    if (size > largest) largest = size;
  }
  return largest;
}

/* Brings S_nn to 1: before the bilateral rows are eliminated, and after. */
static void mg_friction_normalise(mg_frictional *s)
{
  const int m = s->m;
  mg_real *factor = s->y;
  for (int c = 0; c < s->n; ++c) {
    const int normal = s->normal[c], end = mg_friction_end_of(s, c);
    const mg_real size = (mg_real)fabs(s->S[normal + normal * m]);
    for (int i = normal; i < end; ++i) factor[i] = size > MG_LCP_RANK(m) ? 1 / (mg_real)sqrt(size) : (mg_real)1;
  }
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < m; ++i) s->S[i + j * m] *= factor[i] * factor[j];
  for (int i = 0; i < m; ++i) {
    s->c[i] *= factor[i];
    s->e[i] *= factor[i];
  }
}

/* Returns 0 when the scaled data leave the range of the reals. */
MG_INTERNAL int mg_friction_scale(mg_frictional *s)
{
  const int m = s->m;
  for (int c = 0; c < s->n; ++c) {
    const mg_real e = 1 / mg_friction_diagonal(s, s->row[s->normal[c]]);
    const int end = mg_friction_end_of(s, c);
    for (int i = s->normal[c]; i < end; ++i) s->e[i] *= e;
  }
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < m; ++i) s->S[i + j * m] = mg_friction_entry(s, s->row[i], s->row[j]) * s->e[i] * s->e[j];
  for (int i = 0; i < m; ++i) s->c[i] = s->given->b[s->row[i]] * s->e[i];
  if (s->n_bilateral > 0) {
    mg_friction_eliminate(s);
    mg_friction_normalise(s);
  }
  mg_friction_means(s);
  s->scale = mg_friction_size(s);
  if (!mg_all_finite(m * m, s->S) || !mg_all_finite(m, s->c)) return 0;
  if (!(s->scale > 0)) s->scale = 1;
  for (int i = 0; i < m; ++i) s->c[i] /= s->scale;
  return 1;
}

MG_INTERNAL void mg_friction_take(mg_frictional *s, const mg_real *z)
{
  for (int i = 0; i < s->m; ++i) s->y[i] = z[s->row[i]] / s->e[i] / s->scale;
}

/* z of the whole problem; the bilateral forces are of minimum norm. */
MG_INTERNAL void mg_friction_give(const mg_frictional *s, const mg_real *y, mg_real *z)
{
  const mg_friction_problem *p = s->given;
  const int k = s->n_bilateral;
  mg_real *B = s->work, *r = B + k * k, *x = r + k, *rest = x + k;
  for (int i = 0; i < p->n; ++i) z[i] = 0;
  for (int i = 0; i < s->m; ++i) z[s->row[i]] = y[i] * s->e[i] * s->scale;
  for (int i = 0; i < k; ++i) {
    const int row = s->bilateral[i];
    r[i] = p->b[row];
    for (int j = 0; j < s->m; ++j) r[i] += mg_friction_entry(s, row, s->row[j]) * z[s->row[j]];
    r[i] *= s->e_b[i];
    for (int j = 0; j < k; ++j) B[i + j * k] = mg_friction_entry(s, row, s->bilateral[j]) * s->e_b[i] * s->e_b[j];
  }
  if (k > 0) mg_minimum_norm(k, B, r, MG_LCP_RANK(k), x, rest, s->iwork);
  for (int i = 0; i < k; ++i) z[s->bilateral[i]] = x[i] * s->e_b[i];
}
