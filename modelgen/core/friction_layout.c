/* Which rows carry force, and where everything lies in the scratch. */
#include "friction_scaled.h"

enum { MG_FRICTION_SQUARES = 9, MG_FRICTION_VECTORS = 48, MG_FRICTION_INTS = 14 };

MG_API int mg_friction_work_size(int n, int n_contact)
{
  return MG_FRICTION_SQUARES * n * n + MG_FRICTION_VECTORS * (n + 1) + 3 * n_contact + mg_lcp_work_size(n);
}

MG_API int mg_friction_iwork_size(int n, int n_contact)
{
  return MG_FRICTION_INTS * (n + n_contact + 1) + mg_lcp_iwork_size(n);
}

static void mg_friction_partition(mg_frictional *s, mg_real *work, int *iwork)
{
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

MG_INTERNAL int mg_friction_end_of(const mg_frictional *s, int contact)
{
  return contact + 1 < s->n ? s->normal[contact + 1] : s->m;
}

/* A disc over the rows row.. of the problem with a positive coefficient; e holds the coefficients for now. */
static void mg_friction_add_part(mg_frictional *s, int row, int count, const mg_real *mu, int mark)
{
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

static void mg_friction_add_contact(mg_frictional *s, int contact)
{
  const int row = s->given->first[contact], rows = s->given->rows[contact];
  const mg_real *cone = s->given->cone + MG_CONE * contact, rolling[2] = {cone[3], cone[3]};
  s->normal[contact] = s->m;
  s->row[s->m] = row;
  s->e[s->m++] = 1;
  if (rows >= 3) mg_friction_add_part(s, row + 1, 2, cone, MG_SLIPS);
  if (rows >= 6) mg_friction_add_part(s, row + 3, 1, cone + 2, MG_SPINS);
  if (rows >= 6) mg_friction_add_part(s, row + 4, 2, rolling, MG_ROLLS);
  s->part[contact + 1] = s->n_part;
}

/* Returns 0 if the data are not finite, or a coefficient is negative. */
MG_INTERNAL int mg_friction_layout(mg_frictional *s, const mg_friction_problem *problem, mg_real *work, int *iwork)
{
  const int n = problem->n;
  int *owned = iwork + MG_FRICTION_INTS * (n + problem->n_contact) - n;
  s->given = problem;
  s->n = problem->n_contact;
  s->m = s->n_part = s->n_bilateral = s->rank = s->sweeps = s->newton = 0;
  s->theta = problem->law == MG_RELAXED;
  s->residual = MG_MAX;
  mg_friction_partition(s, work, iwork);
  if (!mg_all_finite(n * n, problem->A) || !mg_all_finite(n, problem->b)) return 0;
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
