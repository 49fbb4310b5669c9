/* Projected block Gauss-Seidel over the contacts. */
#include "friction_scaled.h"

enum { MG_ROWS_AT_MOST = 6 };

/* The point of the cone |f_p| <= N, every part p, that is nearest to the contact's rows y. */
static void mg_friction_project(const mg_frictional *s, int contact, mg_real *y)
{
  const int from = s->normal[contact], first = s->part[contact], parts = s->part[contact + 1] - first;
  mg_real N = y[0], size[3];
  for (int p = 0; p < parts; ++p)
    size[p] = mg_friction_norm(s->part_dim[first + p], y + s->part_row[first + p] - from);
  for (int pass = 0; pass <= parts; ++pass) {
    mg_real sum = y[0];
    int count = 1;
    for (int p = 0; p < parts; ++p)
      if (size[p] > N) sum += size[p], ++count;
    N = sum / (mg_real)count;
  }
  y[0] = N > 0 ? N : 0;
  for (int p = 0; p < parts; ++p)
    for (int i = 0; i < s->part_dim[first + p] && size[p] > y[0]; ++i)
      y[s->part_row[first + p] - from + i] *= y[0] / size[p];
}

/* A projected gradient step of one contact: the convex program's own sweep. */
static void mg_friction_descend(const mg_frictional *s, int contact, mg_real *y)
{
  const int from = s->normal[contact], to = mg_friction_end_of(s, contact);
  mg_real trace = 0;
  for (int i = from; i < to; ++i) trace += s->S[i + i * s->m];
  for (int i = from; i < to && trace > 0; ++i) y[i - from] -= s->v[i] / trace;
  mg_friction_project(s, contact, y);
}

static void mg_friction_change(mg_frictional *s, int contact)
{
  const int m = s->m, from = s->normal[contact], to = mg_friction_end_of(s, contact);
  mg_real y[MG_ROWS_AT_MOST];
  for (int j = from; j < to; ++j) y[j - from] = s->y[j];
  if (s->theta > 0) mg_friction_descend(s, contact, y);
  else mg_friction_contact(s, contact, y);
  for (int j = from; j < to; ++j) {
    const mg_real *column = s->S + j * m, step = y[j - from] - s->y[j];
    if (!(fabs(step) > 0)) continue;
    for (int i = 0; i < m; ++i) s->v[i] += column[i] * step;
    s->y[j] = y[j - from];
  }
}

/* Sweeps forth and back from y. Returns whether that is a solution. */
MG_INTERNAL int mg_friction_sweep(mg_frictional *s, int sweeps)
{
  mg_friction_motion(s);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (int c = 0; c < s->n; ++c) mg_friction_change(s, sweep % 2 ? s->n - 1 - c : c);
    ++s->sweeps;
    if (mg_friction_error(s) <= mg_friction_tolerance(s, s->y)) break;
  }
  mg_friction_motion(s);
  return mg_friction_keep(s);
}
