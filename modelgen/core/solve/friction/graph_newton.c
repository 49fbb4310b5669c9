/* Newton steps of a friction problem on a graph, by the motion of the bodies. The condition of a contact gives the
   change of its force as push - stiffness J du; these forces make the change du of the motion, which leaves a system of
   the blocks of bodies. Sticking contacts and bilateral rows are stiff as 1 / shift; that keeps forces which rank
   deficiency leaves free near where they are, as Tikhonov's term does in the matrix of the rows. */
#include "solve/friction/friction_solvers.h"
#include "base/base.h"

MG_INTERNAL void mg_graph_begin_step(mg_scaled_friction *s, mg_real shift) {
  mg_scaled_graph *g = &s->graph;
  mg_block_clear(&g->system);
  for (int i = 0; i < 6 * g->n_body; ++i) g->step[i] = 0;
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
  const int from = s->normal[contact], width = mg_friction_row_end(s, contact) - from;
  mg_real *stiffness = g->stiffness + (long)MG_BLOCK_SIZE * contact, A[MG_BLOCK_SIZE];
  int swap[MG_ROWS];
  for (int i = 0; i < MG_BLOCK_SIZE; ++i) stiffness[i] = 0;
  for (int i = 0; i < width; ++i) g->push[from + i] = -s->y[from + i];
  if (!presses) return 1;
  for (int j = 0; j < width; ++j)
    for (int i = 0; i < width; ++i) {
      A[i + width * j] = gy[MG_ROWS * i + j] + shift * gv[MG_ROWS * i + j];
      stiffness[i + MG_ROWS * j] = gv[MG_ROWS * i + j];
    }
  if (!(mg_lu(width, A, swap) > 0)) return 0;
  for (int i = 0; i < width; ++i) g->push[from + i] = -phi[i];
  mg_lu_solve(width, A, swap, g->push + from);
  for (int j = 0; j < width; ++j) mg_lu_solve(width, A, swap, stiffness + MG_ROWS * j);
  return 1;
}

/* block += a b' */
static inline void mg_add_outer_product(const mg_real *a, const mg_real *b, mg_real *block) {
  const mg_real a0 = a[0], a1 = a[1], a2 = a[2], a3 = a[3], a4 = a[4], a5 = a[5];
  for (int k = 0; k < 6; ++k) {
    mg_real *c = block + 6 * k;
    const mg_real factor = b[k];
    c[0] += a0 * factor, c[1] += a1 * factor, c[2] += a2 * factor;
    c[3] += a3 * factor, c[4] += a4 * factor, c[5] += a5 * factor;
  }
}

/* Adds what rows from .. from + width, of one contact or a free one, do to the motion: M^-1 J' (push - K J du), K by
   columns of `stride`. */
static void mg_graph_add_rows(mg_scaled_graph *g, int from, int width, const mg_real *K, int stride) {
  const int *body = g->body + 2 * from;
  for (int a = 0; a < 2; ++a) {
    if (body[a] < 0) continue;
    mg_real carried[MG_ROWS * MG_ROWS]; /* M^-1 J' K of body a, by columns of six */
    for (int j = 0; j < width; ++j) {
      mg_add_multiple6(g->push[from + j], g->MJ + 12L * (from + j) + 6 * a, g->step + 6L * body[a]);
      for (int i = 0; i < 6; ++i) carried[6 * j + i] = 0;
      for (int r = 0; r < width; ++r)
        mg_add_multiple6(K[r + stride * j], g->MJ + 12L * (from + r) + 6 * a, carried + 6 * j);
    }
    for (int b = 0; b < 2; ++b) {
      if (body[b] < 0) continue;
      mg_real *block = mg_block_at(&g->system, body[a], body[b]);
      for (int j = 0; j < width; ++j) mg_add_outer_product(carried + 6 * j, g->J + 12L * (from + j) + 6 * b, block);
    }
  }
}

/* The change of the motion that the system gives is not accurate enough along stiff contacts to follow v by: that of
   the forces is taken in its place. */
MG_INTERNAL int mg_graph_solve_step(mg_scaled_friction *s, mg_real *step, mg_real *image) {
  mg_scaled_graph *g = &s->graph;
  const int rows = mg_friction_rows(s);
  for (int c = 0; c < s->n; ++c)
    mg_graph_add_rows(g, s->normal[c], mg_friction_row_end(s, c) - s->normal[c], g->stiffness + (long)MG_BLOCK_SIZE * c,
                      MG_ROWS);
  for (int k = 0; k < s->n_free; ++k)
    mg_graph_add_rows(g, s->m + k, 1, g->stiffness + (long)MG_BLOCK_SIZE * s->n + k, 1);
  if (!mg_block_factor(&g->system)) return 0;
  mg_block_solve(&g->system, g->step);
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
  mg_graph_set_motion(s, step, g->step);
  for (int i = 0; i < rows; ++i) image[i] = mg_graph_row_times(g, i, g->step, 0) + g->yield[i] * step[i];
  return mg_all_finite(rows, step) && mg_all_finite(rows, image);
}
