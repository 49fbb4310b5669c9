/* The scaled form of a friction problem: rows that may carry force, bilateral rows eliminated by the Schur
   complement S_cc - S_cb S_bb^-1 S_bc, S_nn = 1; and the way back to the given problem. */
#include "solve/friction/friction_solvers.h"
#include "base/base.h"
#include "solve/lcp/lcp_solvers.h"

/* Memory: matrices, vectors and integer vectors of the size of the problem. */
enum { MG_FRICTION_SQUARES = 9, MG_FRICTION_VECTORS = 48, MG_FRICTION_INTS = 14 };

MG_API long long mg_friction_work_size(int n, int n_contact) {
  return (long long)MG_FRICTION_SQUARES * n * n + MG_FRICTION_VECTORS * (n + 1LL) + 3LL * n_contact +
         mg_lcp_work_size(n);
}

MG_API long long mg_friction_iwork_size(int n, int n_contact) {
  return MG_FRICTION_INTS * (1LL + n + n_contact) + mg_lcp_iwork_size(n);
}

/* Divides the memory. */
static void mg_friction_partition(mg_scaled_friction *s, mg_real *work, int *iwork) {
  const int n = s->given->n, k = s->given->n_contact, square = n * n;
  mg_real **vectors[] = {&s->e, &s->c, &s->y, &s->v, &s->best, &s->e_b};
  int **ints[] = {&s->row, &s->bilateral, &s->order};
  s->S = work;
  s->L = s->S + square;
  s->X = s->L + square;
  work = s->X + square + n;
  for (int i = 0; i < 6; ++i, work += n) *vectors[i] = work;
  s->rho = work;
  s->spare = work + 3 * k;
  s->work = s->spare + 5 * n;
  for (int i = 0; i < 3; ++i, iwork += n) *ints[i] = iwork;
  s->normal = iwork;
  s->part = s->normal + k;
  s->part_row = s->part + k + 1;
  s->part_dim = s->part_row + 3 * k;
  s->part_mark = s->part_dim + 3 * k;
  s->iwork = s->part_mark + 3 * k;
}

MG_INTERNAL int mg_friction_row_end(const mg_scaled_friction *s, int contact) {
  return contact + 1 < s->n ? s->normal[contact + 1] : s->m;
}

/* Adds the disc of the given rows that have a positive coefficient; e holds the coefficients until
   mg_friction_scale. */
static void mg_friction_add_part(mg_scaled_friction *s, int row, int count, const mg_real *mu, int mark) {
  const int part = s->n_part;
  s->part_row[part] = s->m;
  s->part_mark[part] = mark;
  for (int i = 0; i < count; ++i)
    if (mu[i] > 0) {
      s->row[s->m] = row + i;
      s->e[s->m++] = mu[i];
    }
  s->part_dim[part] = s->m - s->part_row[part];
  s->n_part += s->part_dim[part] > 0;
}

/* Adds the rows and parts of a contact. */
static void mg_friction_add_contact(mg_scaled_friction *s, int contact) {
  const int row = s->given->first[contact], rows = s->given->rows[contact];
  const mg_real *cone = s->given->cone + MG_CONE * contact, rolling[2] = {cone[3], cone[3]};
  s->normal[contact] = s->m;
  s->row[s->m] = row;
  s->e[s->m++] = 1;
  if (rows >= 3) mg_friction_add_part(s, row + 1, 2, cone, MG_MARK_SLIP);
  if (rows >= 6) mg_friction_add_part(s, row + 3, 1, cone + 2, MG_MARK_SPIN);
  if (rows >= 6) mg_friction_add_part(s, row + 4, 2, rolling, MG_MARK_ROLL);
  s->part[contact + 1] = s->n_part;
}

MG_INTERNAL void mg_friction_open(mg_scaled_friction *s, const mg_friction_problem *problem) {
  s->given = problem;
  s->n = problem->n_contact;
  s->m = s->n_part = s->n_bilateral = s->n_free = s->rank = s->sweeps = s->newton = 0;
  s->theta = problem->law == MG_RELAXED;
  s->residual = MG_MAX;
  s->S = s->graph.J = 0;
}

MG_INTERNAL int mg_friction_choose_rows(mg_scaled_friction *s, int *owned) {
  const mg_friction_problem *problem = s->given;
  const int n = problem->n;
  if (!mg_all_finite(n, problem->b)) return 0;
  for (int i = 0; i < n; ++i) owned[i] = 0;
  s->part[0] = 0;
  for (int c = 0; c < s->n; ++c) {
    const int rows = problem->rows[c], used = rows >= 6 ? 4 : rows >= 3 ? 2 : 0;
    for (int i = 0; i < used; ++i)
      if (!(problem->cone[MG_CONE * c + i] >= 0 && problem->cone[MG_CONE * c + i] <= MG_MAX)) return 0;
    for (int i = 0; i < rows; ++i) owned[problem->first[c] + i] = 1;
    mg_friction_add_contact(s, c);
  }
  for (int i = 0; i < n; ++i)
    if (!owned[i]) s->bilateral[s->n_bilateral++] = i;
  return 1;
}

MG_INTERNAL int mg_friction_layout(mg_scaled_friction *s, const mg_friction_problem *problem, mg_real *work,
                                   int *iwork) {
  const int n = problem->n;
  mg_friction_open(s, problem);
  mg_friction_partition(s, work, iwork);
  return mg_all_finite(n * n, problem->A) &&
         mg_friction_choose_rows(s, iwork + MG_FRICTION_INTS * (n + problem->n_contact) - n);
}

/* Entry of A. */
static mg_real mg_friction_entry(const mg_scaled_friction *s, int i, int j) { return s->given->A[i + j * s->given->n]; }

/* sqrt|A_ii|, or 1 where it is 0. */
static mg_real mg_friction_diagonal(const mg_scaled_friction *s, int i) {
  return mg_diagonal_scale((mg_real)fabs(mg_friction_entry(s, i, i)));
}

/* Replaces x by (L L')^-1 x on the pivoted bilateral rows. */
static void mg_friction_solve_bilateral(const mg_scaled_friction *s, mg_real *x) {
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

/* Pivoted Cholesky factor of the bilateral rows; of dependent rows those pivoted first represent all. */
static void mg_friction_factor_bilateral(mg_scaled_friction *s) {
  const int k = s->n_bilateral;
  for (int i = 0; i < k; ++i) s->e_b[i] = 1 / mg_friction_diagonal(s, s->bilateral[i]);
  for (int j = 0; j < k; ++j)
    for (int i = 0; i < k; ++i)
      s->L[i + j * k] = mg_friction_entry(s, s->bilateral[i], s->bilateral[j]) * s->e_b[i] * s->e_b[j];
  s->rank = mg_cholesky_pivoted(k, s->L, s->order, MG_LCP_RANK(k), 0);
}

/* Clears row and column i, of which only rounding is left because bilateral rows determine them. */
static void mg_friction_clear_row(mg_scaled_friction *s, int i) {
  for (int j = 0; j < s->m; ++j) s->S[i + j * s->m] = s->S[j + i * s->m] = 0;
}

/* Eliminates the bilateral rows from S and c. */
static void mg_friction_eliminate(mg_scaled_friction *s) {
  const int m = s->m;
  mg_real *before = s->y;
  for (int i = 0; i < m; ++i) before[i] = (mg_real)fabs(s->S[i + i * m]);
  mg_friction_factor_bilateral(s);
  for (int j = 0; j <= m; ++j) {
    mg_real *x = s->X + j * s->n_bilateral, *target = j < m ? s->S + j * m : s->c;
    for (int i = 0; i < s->rank; ++i) {
      const int b = s->order[i], row = s->bilateral[b];
      x[i] = s->e_b[b] * (j < m ? mg_friction_entry(s, row, s->row[j]) * s->e[j] : s->given->b[row]);
    }
    mg_friction_solve_bilateral(s, x);
    for (int k = 0; k < s->rank; ++k) {
      const int b = s->order[k];
      for (int i = 0; i < m; ++i)
        target[i] -= s->e[i] * mg_friction_entry(s, s->row[i], s->bilateral[b]) * s->e_b[b] * x[k];
    }
  }
  for (int i = 0; i < m; ++i)
    if (fabs(s->S[i + i * m]) <= MG_LCP_RANK(s->given->n) * before[i]) mg_friction_clear_row(s, i);
}

/* Means of S_tt of all parts. */
static void mg_friction_set_rho(mg_scaled_friction *s) {
  for (int p = 0; p < s->n_part; ++p) {
    mg_real sum = 0;
    for (int i = s->part_row[p]; i < s->part_row[p] + s->part_dim[p]; ++i) sum += (mg_real)fabs(s->S[i + i * s->m]);
    s->rho[p] = sum > 0 ? sum / (mg_real)s->part_dim[p] : (mg_real)1;
  }
}

/* Largest motion without contact forces, in the units of the residual. */
MG_INTERNAL mg_real mg_friction_size(const mg_scaled_friction *s) {
  mg_real largest = 0;
  for (int c = 0; c < s->n; ++c)
    if (fabs(s->c[s->normal[c]]) > largest) largest = (mg_real)fabs(s->c[s->normal[c]]);
  for (int p = 0; p < s->n_part; ++p) {
    mg_real size = mg_friction_norm(s->part_dim[p], s->c + s->part_row[p]) / (mg_real)sqrt(s->rho[p]);
    if (size > largest) largest = size;
  }
  return largest;
}

/* Scales S_nn to 1 after bilateral rows have been eliminated. */
static void mg_friction_normalise(mg_scaled_friction *s) {
  const int m = s->m;
  mg_real *factor = s->y;
  for (int c = 0; c < s->n; ++c) {
    const int normal = s->normal[c], end = mg_friction_row_end(s, c);
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

MG_INTERNAL int mg_friction_scale(mg_scaled_friction *s) {
  const int m = s->m;
  for (int c = 0; c < s->n; ++c) {
    const mg_real e = 1 / mg_friction_diagonal(s, s->row[s->normal[c]]);
    const int end = mg_friction_row_end(s, c);
    for (int i = s->normal[c]; i < end; ++i) s->e[i] *= e;
  }
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < m; ++i) s->S[i + j * m] = mg_friction_entry(s, s->row[i], s->row[j]) * s->e[i] * s->e[j];
  for (int i = 0; i < m; ++i) s->c[i] = s->given->b[s->row[i]] * s->e[i];
  if (s->n_bilateral > 0) {
    mg_friction_eliminate(s);
    mg_friction_normalise(s);
  }
  mg_friction_set_rho(s);
  s->scale = mg_friction_size(s);
  if (!mg_all_finite(m * m, s->S) || !mg_all_finite(m, s->c)) return 0;
  if (!(s->scale > 0)) s->scale = 1;
  for (int i = 0; i < m; ++i) s->c[i] /= s->scale;
  return 1;
}

MG_INTERNAL void mg_friction_scale_guess(mg_scaled_friction *s, const mg_real *z) {
  for (int i = 0; i < mg_friction_rows(s); ++i) s->y[i] = z[s->row[i]] / s->e[i] / s->scale;
}

MG_INTERNAL void mg_friction_unscale(const mg_scaled_friction *s, const mg_real *y, mg_real *z) {
  const mg_friction_problem *p = s->given;
  const int k = s->n_bilateral;
  mg_real *B = s->work, *r = B + k * k, *x = r + k, *rest = x + k, pivot;
  for (int i = 0; i < p->n; ++i) z[i] = 0;
  for (int i = 0; i < s->m; ++i) z[s->row[i]] = y[i] * s->e[i] * s->scale;
  for (int i = 0; i < k; ++i) {
    const int row = s->bilateral[i];
    r[i] = p->b[row];
    for (int j = 0; j < s->m; ++j) r[i] += mg_friction_entry(s, row, s->row[j]) * z[s->row[j]];
    r[i] *= s->e_b[i];
    for (int j = 0; j < k; ++j) B[i + j * k] = mg_friction_entry(s, row, s->bilateral[j]) * s->e_b[i] * s->e_b[j];
  }
  if (k > 0) mg_minimum_norm(k, B, r, MG_LCP_RANK(k), x, rest, s->iwork, &pivot);
  for (int i = 0; i < k; ++i) z[s->bilateral[i]] = x[i] * s->e_b[i];
}
