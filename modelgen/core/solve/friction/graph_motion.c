/* Motion of bodies and rows of a friction problem on a graph: what forces make of it, row by row. */
#include "solve/friction/friction_solvers.h"
#include "base/base.h"

MG_INTERNAL int mg_friction_rows(const mg_scaled_friction *s) { return s->m + s->n_free; }

MG_INTERNAL mg_real mg_graph_entry(const mg_scaled_graph *g, int i, int j) {
  return mg_dot6(g->J + 12L * i, g->MJ + 12L * j) + mg_dot6(g->J + 12L * i + 6, g->MJ + 12L * j + 6);
}

MG_INTERNAL mg_real mg_graph_row_times(const mg_scaled_graph *g, int row, const mg_real *motion, mg_real start) {
  const int o = g->body[2 * row], f = g->body[2 * row + 1];
  if (o >= 0) start += mg_dot6(g->J + 12L * row, motion + 6L * o);
  if (f >= 0) start += mg_dot6(g->J + 12L * row + 6, motion + 6L * f);
  return start;
}

MG_INTERNAL void mg_graph_add_force(const mg_scaled_graph *g, int row, mg_real force, mg_real *motion) {
  const int o = g->body[2 * row], f = g->body[2 * row + 1];
  if (o >= 0) mg_add_multiple6(force, g->MJ + 12L * row, motion + 6L * o);
  if (f >= 0) mg_add_multiple6(force, g->MJ + 12L * row + 6, motion + 6L * f);
}

MG_INTERNAL void mg_graph_set_motion(const mg_scaled_friction *s, const mg_real *force, mg_real *motion) {
  for (int i = 0; i < 6 * s->graph.n_body; ++i) motion[i] = 0;
  for (int i = 0; i < mg_friction_rows(s); ++i) mg_graph_add_force(&s->graph, i, force[i], motion);
}

MG_INTERNAL void mg_graph_update_rows(mg_scaled_friction *s, int from, int to) {
  const mg_scaled_graph *g = &s->graph;
  for (int i = from; i < to; ++i) s->v[i] = mg_graph_row_times(g, i, g->motion, s->c[i] + g->yield[i] * s->y[i]);
}

MG_INTERNAL void mg_graph_sweep_free_rows(mg_scaled_friction *s, int backwards) {
  for (int k = 0; k < s->n_free; ++k) {
    const int i = s->m + (backwards ? s->n_free - 1 - k : k);
    const mg_real own = mg_graph_entry(&s->graph, i, i) + s->graph.yield[i];
    mg_graph_update_rows(s, i, i + 1);
    if (!(own > 0)) continue;
    mg_graph_add_force(&s->graph, i, -s->v[i] / own, s->graph.motion);
    s->y[i] -= s->v[i] / own;
  }
}
