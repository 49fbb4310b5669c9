/* Forces that rank deficiency leaves free: of all forces with the same w those of least norm. */
#include "solve/friction/friction_solvers.h"
#include "base/base.h"

enum { MG_LEAST_NORM_HALVINGS = 8 }; /* most halvings of the step towards the least norm */

/* Adds the entry of row i, in units of N, to a direction; e_i / e_n is the coefficient of friction. */
static void mg_add_direction_entry(const mg_scaled_friction *s, int contact, int i, mg_real value, mg_real *column,
                                   mg_real *square) {
  const mg_real mu = s->e[i] / s->e[s->normal[contact]];
  column[i] = value;
  *square += value * mu * value * mu;
}

/* Scales a direction to unit length. */
static void mg_normalise_direction(int m, mg_real square, mg_real *column) {
  for (int i = 0; i < m; ++i) column[i] /= (mg_real)sqrt(square);
}

/* Columns of D: directions in which forces may change at the same w. The force of a part that slips is
   proportional to N, that of a part that sticks is free. Returns their number. */
static int mg_free_force_directions(const mg_scaled_friction *s, const int *marks, mg_real *D) {
  const int m = s->m;
  int k = 0;
  for (int c = 0; c < s->n; ++c) {
    const mg_real force = s->y[s->normal[c]];
    mg_real square = 0, *normal = D + k * m;
    if (!marks[c]) continue;
    for (int i = 0; i < m; ++i) normal[i] = 0;
    mg_add_direction_entry(s, c, s->normal[c], 1, normal, &square);
    ++k;
    for (int p = s->part[c]; p < s->part[c + 1]; ++p)
      for (int i = s->part_row[p]; i < s->part_row[p] + s->part_dim[p]; ++i) {
        mg_real alone = 0, *column = D + k * m;
        if (marks[c] & s->part_mark[p]) {
          mg_add_direction_entry(s, c, i, force > 0 ? s->y[i] / force : 0, normal, &square);
          continue;
        }
        for (int j = 0; j < m; ++j) column[j] = 0;
        mg_add_direction_entry(s, c, i, 1, column, &alone);
        mg_normalise_direction(m, alone, column);
        ++k;
      }
    mg_normalise_direction(m, square, normal);
  }
  return k;
}

/* True if no force is on the boundary of its cone, but for those of parts that slip. */
static int mg_is_strictly_inside_cones(const mg_scaled_friction *s, const int *marks) {
  const mg_real small = (mg_real)sqrt(MG_EPS);
  for (int c = 0; c < s->n; ++c) {
    const mg_real force = s->y[s->normal[c]];
    if (!marks[c]) continue;
    if (!(force > small)) return 0;
    for (int p = s->part[c]; p < s->part[c + 1]; ++p)
      if (!(marks[c] & s->part_mark[p]) &&
          !(mg_friction_norm(s->part_dim[p], s->y + s->part_row[p]) < force * (1 - small)))
        return 0;
  }
  return 1;
}

/* G = D'S D and g = D'(c - v), of size at least 3; rows beyond k are 0. */
static void mg_assemble_least_norm(const mg_scaled_friction *s, int k, int size, const mg_real *D, mg_real *G,
                                   mg_real *g, mg_real *image) {
  const int m = s->m;
  for (int i = 0; i < size * size; ++i) G[i] = 0;
  for (int j = 0; j < size; ++j) g[j] = 0;
  for (int j = 0; j < k; ++j) {
    for (int i = 0; i < m; ++i) image[i] = 0;
    for (int l = 0; l < m; ++l)
      for (int i = 0; i < m; ++i) image[i] += s->S[i + l * m] * D[l + j * m];
    for (int i = 0; i < k; ++i)
      for (int l = 0; l < m; ++l) G[i + j * size] += D[l + i * m] * image[l];
    for (int l = 0; l < m; ++l) g[j] += D[l + j * m] * (s->c[l] - s->v[l]);
  }
}

/* Moves best towards the forces of least norm as far as the cones permit. */
static void mg_move_to_least_norm(mg_scaled_friction *s, int k, const mg_real *D, const mg_real *a, mg_real *target) {
  const mg_real limit =
      s->residual > mg_friction_tolerance(s, s->best) ? s->residual : mg_friction_tolerance(s, s->best);
  mg_real part = 1;
  for (int i = 0; i < s->m; ++i) {
    target[i] = 0;
    for (int j = 0; j < k; ++j) target[i] += D[i + j * s->m] * a[j];
  }
  for (int half = 0; half < MG_LEAST_NORM_HALVINGS; ++half, part /= 2) {
    for (int i = 0; i < s->m; ++i) s->y[i] = s->best[i] + part * (target[i] - s->best[i]);
    mg_friction_update_motion(s);
    if (mg_friction_error(s) <= limit) {
      for (int i = 0; i < s->m; ++i) s->best[i] = s->y[i];
      return;
    }
  }
}

MG_INTERNAL int mg_friction_least_norm(mg_scaled_friction *s, const int *marks, mg_friction_report *report) {
  const int m = s->m, room = m + 3;
  mg_real *D = s->work, *G = D + m * m, *g = G + room * room, *image = g + room, *a = image + room, *rest = a + room;
  mg_real pivot;
  int k, strict, size;
  for (int i = 0; i < m; ++i) s->y[i] = s->best[i];
  mg_friction_update_motion(s);
  k = mg_free_force_directions(s, marks, D);
  strict = mg_is_strictly_inside_cones(s, marks);
  size = k < 3 ? 3 : k;
  mg_assemble_least_norm(s, k, size, D, G, g, image);
  report->rank = mg_minimum_norm(size, G, g, MG_LCP_RANK(size), a, rest, s->iwork, &pivot);
  if (report->rank < k) mg_move_to_least_norm(s, k, D, a, image);
  for (int i = 0; i < m; ++i) s->y[i] = s->best[i];
  strict |= mg_is_strictly_inside_cones(s, marks);
  report->active = k + s->n_bilateral;
  report->rank += s->rank;
  return strict;
}
