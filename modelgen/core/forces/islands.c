/* Islands: sets of rows that share no body moved by forces, whose forces do not depend on each other. Writes
   c->islands. */
#include "forces/forces.h"
#include "model/model.h"

static int mg_root(int *parent, int body) {
  while (parent[body] != body) body = parent[body] = parent[parent[body]];
  return body;
}

MG_INTERNAL void mg_chain_islands(mg_context *c, int n) {
  const mg_system *s = c->system;
  for (int b = 0; b < s->n_body; b++) c->islands.parent[b] = b, c->islands.head[b] = -1;
  for (int r = 0; r < n; r++) {
    const int o = c->contacts.o[c->lcp.rows[r]], f = c->contacts.f[c->lcp.rows[r]];
    if (mg_is_moved_by_forces(c, o) && mg_is_moved_by_forces(c, f))
      c->islands.parent[mg_root(c->islands.parent, o)] = mg_root(c->islands.parent, f);
  }
  for (int r = n - 1; r >= 0; r--) {
    const int root = mg_root(c->islands.parent, mg_moving_body(c, c->lcp.rows[r]));
    c->islands.next[c->lcp.rows[r]] = c->islands.head[root];
    c->islands.head[root] = c->lcp.rows[r];
  }
}
