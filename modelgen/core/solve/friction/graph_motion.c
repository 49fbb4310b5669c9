/* Motion of bodies and rows of a friction problem on a graph: what forces make of it, row by row. */
#include "solve/friction/friction_solvers.h"
#include "base/base.h"

MG_INTERNAL mg_real mg_graph_entry(const mg_scaled_graph *g, int i, int j) {
  return mg_dot6(g->J + 12L * i, g->MJ + 12L * j) + mg_dot6(g->J + 12L * i + 6, g->MJ + 12L * j + 6);
}

MG_INTERNAL void mg_graph_update_rows(mg_scaled_friction *s, int from, int to) {
  const mg_scaled_graph *g = &s->graph;
  for (int i = from; i < to; ++i) {
    const int o = g->body[2 * i], f = g->body[2 * i + 1];
    mg_real v = s->c[i] + g->yield[i] * s->y[i];
    if (o >= 0) v += mg_dot6(g->J + 12L * i, g->motion + 6L * o);
    if (f >= 0) v += mg_dot6(g->J + 12L * i + 6, g->motion + 6L * f);
    s->v[i] = v;
  }
}

MG_INTERNAL void mg_graph_add_force(mg_scaled_friction *s, int row, mg_real change) {
  const mg_scaled_graph *g = &s->graph;
  const int o = g->body[2 * row], f = g->body[2 * row + 1];
  if (o >= 0) mg_add_multiple6(change, g->MJ + 12L * row, g->motion + 6L * o);
  if (f >= 0) mg_add_multiple6(change, g->MJ + 12L * row + 6, g->motion + 6L * f);
}

MG_INTERNAL void mg_graph_update_motion(mg_scaled_friction *s) {
  const mg_scaled_graph *g = &s->graph;
  for (int i = 0; i < 6 * g->n_body; ++i) g->motion[i] = 0;
  for (int i = 0; i < s->m + s->n_free; ++i) mg_graph_add_force(s, i, s->y[i]);
}

MG_INTERNAL void mg_graph_sweep_free_rows(mg_scaled_friction *s, int backwards) {
  for (int k = 0; k < s->n_free; ++k) {
    const int i = s->m + (backwards ? s->n_free - 1 - k : k);
    const mg_real own = mg_graph_entry(&s->graph, i, i) + s->graph.yield[i];
    mg_graph_update_rows(s, i, i + 1);
    if (!(own > 0)) continue;
    mg_graph_add_force(s, i, -s->v[i] / own);
    s->y[i] -= s->v[i] / own;
  }
}
