/* Newton steps of a friction problem on a graph, by the motion of the bodies. The condition of a contact gives the
   change of its force as push - stiffness J du; these forces make the change du of the motion, which leaves a system of
   the blocks of bodies. Sticking contacts and bilateral rows are stiff as 1 / shift; that keeps forces which rank
   deficiency leaves free near where they are, as Tikhonov's term does in the matrix of the rows. */
#include "solve/friction/friction_solvers.h"
#include "base/base.h"

MG_INTERNAL void mg_graph_begin_step(mg_scaled_friction *s, mg_real shift) {
  mg_scaled_graph *g = &s->graph;
  for (int k = 0; k < s->n_free; ++k) {
    const int i = s->m + k;
    const mg_real own = g->yield[i] + shift;
    g->stiffness[(long)MG_BLOCK_SIZE * s->n + k] = 1 / own;
    g->push[i] = -s->v[i] / own;
  }
}

MG_INTERNAL int mg_graph_add_contact(mg_scaled_friction *s, int contact, int presses, mg_real shift, const mg_real *gy,
                                     const mg_real *gv, const mg_real *phi) {
  mg_scaled_graph *g = &s->graph;
  const int from = s->normal[contact], width = mg_friction_row_end(s, contact) - from, n = 2 * width + 1;
  mg_real *stiffness = g->stiffness + (long)MG_BLOCK_SIZE * contact, AB[2 * MG_BLOCK_SIZE + MG_ROWS];
  for (int i = 0; i < MG_BLOCK_SIZE; ++i) stiffness[i] = 0;
  for (int i = 0; i < width; ++i) g->push[from + i] = -s->y[from + i];
  if (!presses) return 1;
  for (int i = 0; i < width; ++i) {
    mg_real *row = AB + n * i;
    for (int j = 0; j < width; ++j) {
      row[j] = gy[MG_ROWS * i + j] + shift * gv[MG_ROWS * i + j];
      row[width + j] = gv[MG_ROWS * i + j];
    }
    row[2 * width] = -phi[i];
  }
  if (!mg_solve_columns(width, n, AB)) return 0;
  for (int i = 0; i < width; ++i) {
    for (int j = 0; j < width; ++j) stiffness[i + MG_ROWS * j] = AB[n * i + width + j];
    g->push[from + i] = AB[n * i + 2 * width];
  }
  return 1;
}

/* y += sum of x_j a_j over n vectors of six, a_j every `apart`, x_j every `every`; the sums stay in registers. */
static inline void mg_add_combination(int n, const mg_real *a, int apart, const mg_real *x, int every, mg_real *y) {
  mg_real y0 = y[0], y1 = y[1], y2 = y[2], y3 = y[3], y4 = y[4], y5 = y[5];
  for (int j = 0; j < n; ++j, a += apart, x += every) {
    y0 += a[0] * *x, y1 += a[1] * *x, y2 += a[2] * *x;
    y3 += a[3] * *x, y4 += a[4] * *x, y5 += a[5] * *x;
  }
  y[0] = y0, y[1] = y1, y[2] = y2, y[3] = y3, y[4] = y4, y[5] = y5;
}

MG_INTERNAL void mg_graph_set_push(mg_scaled_friction *s, const mg_real *right) {
  mg_scaled_graph *g = &s->graph;
  for (int c = 0; c < s->n; ++c) {
    const int from = s->normal[c], to = mg_friction_row_end(s, c);
    const mg_real *K = g->stiffness + (long)MG_BLOCK_SIZE * c;
    for (int i = from; i < to; ++i) {
      g->push[i] = 0;
      for (int j = from; j < to; ++j) g->push[i] += K[i - from + MG_ROWS * (j - from)] * right[j];
    }
  }
  for (int k = 0; k < s->n_free; ++k)
    g->push[s->m + k] = g->stiffness[(long)MG_BLOCK_SIZE * s->n + k] * right[s->m + k];
}

/* Adds what the push of rows from .. from + width, of one contact or a free one, does to the motion: M^-1 J' push. */
static void mg_graph_add_push(mg_scaled_graph *g, int from, int width) {
  for (int a = 0; a < 2; ++a)
    if (g->body[2 * from + a] >= 0)
      mg_add_combination(width, g->MJ + 12L * from + 6 * a, 12, g->push + from, 1,
                         g->step + 6L * g->body[2 * from + a]);
}

/* Adds the blocks of such rows, M^-1 J' K J; K by columns of `stride`, 0 for a contact that does not press. */
static void mg_graph_add_rows(mg_scaled_graph *g, int from, int width, const mg_real *K, int stride) {
  const int *body = g->body + 2 * from;
  for (int a = 0; a < 2 && K[0] != 0; ++a) {
    if (body[a] < 0) continue;
    const mg_real *MJ = g->MJ + 12L * from + 6 * a;
    mg_real carried[MG_ROWS * MG_ROWS] = {0}; /* M^-1 J' K of body a, by columns of six */
    for (int j = 0; j < width; ++j) mg_add_combination(width, MJ, 12, K + stride * j, 1, carried + 6 * j);
    for (int b = 0; b < 2; ++b) {
      if (body[b] < 0) continue;
      mg_real *block = mg_block_at(&g->system, body[a], body[b]);
      const mg_real *J = g->J + 12L * from + 6 * b;
      for (int k = 0; k < 6; ++k) mg_add_combination(width, carried, 6, J + k, 12, block + 6 * k);
    }
  }
}

MG_INTERNAL int mg_graph_factor_step(mg_scaled_friction *s) {
  mg_scaled_graph *g = &s->graph;
  mg_block_clear(&g->system);
  for (int c = 0; c < s->n; ++c)
    mg_graph_add_rows(g, s->normal[c], mg_friction_row_end(s, c) - s->normal[c], g->stiffness + (long)MG_BLOCK_SIZE * c,
                      MG_ROWS);
  for (int k = 0; k < s->n_free; ++k)
    mg_graph_add_rows(g, s->m + k, 1, g->stiffness + (long)MG_BLOCK_SIZE * s->n + k, 1);
  return mg_block_factor(&g->system);
}

/* Changes of y and v by the change g->step of the motion that the system gives. It is not accurate enough along stiff
   contacts to follow v by: that of the forces, g->motion, is taken in its place. Returns 0 if they are not finite. */
static int mg_graph_set_changes(mg_scaled_friction *s, mg_real *step, mg_real *image) {
  mg_scaled_graph *g = &s->graph;
  const int rows = mg_friction_rows(s);
  for (int i = 0; i < rows; ++i) image[i] = mg_graph_row_times(g, i, g->step, 0);
  for (int c = 0; c < s->n; ++c) {
    const int from = s->normal[c], to = mg_friction_row_end(s, c);
    const mg_real *K = g->stiffness + (long)MG_BLOCK_SIZE * c;
    for (int i = from; i < to; ++i) {
      step[i] = g->push[i];
      for (int j = from; j < to; ++j) step[i] -= K[i - from + MG_ROWS * (j - from)] * image[j];
    }
  }
  for (int k = 0; k < s->n_free; ++k)
    step[s->m + k] = g->push[s->m + k] - g->stiffness[(long)MG_BLOCK_SIZE * s->n + k] * image[s->m + k];
  mg_graph_set_motion(s, step, g->motion);
  for (int i = 0; i < rows; ++i) image[i] = mg_graph_row_times(g, i, g->motion, 0) + g->yield[i] * step[i];
  return mg_all_finite(rows, step) && mg_all_finite(rows, image);
}

MG_INTERNAL int mg_graph_solve_step(mg_scaled_friction *s, mg_real *step, mg_real *image) {
  mg_scaled_graph *g = &s->graph;
  for (int i = 0; i < 6 * g->n_body; ++i) g->step[i] = 0;
  for (int c = 0; c < s->n; ++c) mg_graph_add_push(g, s->normal[c], mg_friction_row_end(s, c) - s->normal[c]);
  for (int k = 0; k < s->n_free; ++k) mg_graph_add_push(g, s->m + k, 1);
  mg_block_solve(&g->system, g->step);
  return mg_graph_set_changes(s, step, image);
}

MG_INTERNAL int mg_graph_refine_step(mg_scaled_friction *s, mg_real *step, mg_real *image) {
  mg_scaled_graph *g = &s->graph;
  for (int i = 0; i < 6 * g->n_body; ++i) g->motion[i] -= g->step[i];
  mg_block_solve(&g->system, g->motion);
  for (int i = 0; i < 6 * g->n_body; ++i) g->step[i] += g->motion[i];
  return mg_graph_set_changes(s, step, image);
}
