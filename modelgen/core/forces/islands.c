/* Islands: sets of rows that share no body moved by forces, whose forces do not depend on each other. Writes
   c->islands. */
#include "forces/forces.h"
#include "model/model.h"

static int mg_root(int *parent, int body) {
  while (parent[body] != body) body = parent[body] = parent[parent[body]];
  return body;
}

MG_INTERNAL void mg_part_bodies(mg_context *c) {
  for (int b = 0; b < c->system->n_body; b++) c->islands.parent[b] = b;
}

MG_INTERNAL void mg_join_bodies(mg_context *c, int o, int f) {
  if (o >= 0 && f >= 0 && mg_is_moved_by_forces(c, o) && mg_is_moved_by_forces(c, f))
    c->islands.parent[mg_root(c->islands.parent, o)] = mg_root(c->islands.parent, f);
}

MG_INTERNAL int mg_island_of_body(mg_context *c, int body) { return mg_root(c->islands.parent, body); }

MG_INTERNAL void mg_chain_islands(mg_context *c, int n) {
  const mg_system *s = c->system;
  mg_part_bodies(c);
  for (int b = 0; b < s->n_body; b++) c->islands.head[b] = -1;
  for (int r = 0; r < n; r++) mg_join_bodies(c, c->contacts.o[c->lcp.rows[r]], c->contacts.f[c->lcp.rows[r]]);
  for (int r = n - 1; r >= 0; r--) {
    const int root = mg_island_of_body(c, mg_moving_body(c, c->lcp.rows[r]));
    c->islands.next[c->lcp.rows[r]] = c->islands.head[root];
    c->islands.head[root] = c->lcp.rows[r];
  }
}
