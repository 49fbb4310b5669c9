/* Rows that share moving bodies form islands; the amounts that hold them are found island by island. */
#include "core.h"

static int mg_root(int *parent, int body) {
  while (parent[body] != body) body = parent[body] = parent[parent[body]];
  return body;
}

static int mg_moving_side(const mg_context *c, int contact) {
  const int o = c->o[contact];
  return mg_moves(c, o) ? o : c->f[contact];
}

/* Chains the n rows of c->list by island: c->head[root] is the first, c->next[row] the one after, else -1. */
static void mg_chain(mg_context *c, int n) {
  const mg_system *s = c->sys;
  for (int b = 0; b < s->n_body; b++) c->parent[b] = b, c->head[b] = -1;
  for (int r = 0; r < n; r++) {
    const int o = c->o[c->list[r]], f = c->f[c->list[r]];
    if (mg_moves(c, o) && mg_moves(c, f)) c->parent[mg_root(c->parent, o)] = mg_root(c->parent, f);
  }
  for (int r = n - 1; r >= 0; r--) {
    const int root = mg_root(c->parent, mg_moving_side(c, c->list[r]));
    c->next[c->list[r]] = c->head[root];
    c->head[root] = c->list[r];
  }
}

static void mg_hold_island(mg_context *c, int first, const mg_real *rate, mg_real *amount) {
  int n = 0;
  for (int i = first; i >= 0; i = c->next[i]) c->island[n++] = i;
  mg_assemble(c, c->island, n);
  for (int r = 0; r < n; r++) c->b[r] = rate[c->island[r]], c->mask[r] = 1;
  if (c->leaning) {
    mg_hold_leaning(c, n, amount);
    return;
  }
  mg_active_above(n, c->A, c->b, c->mask, c->sys->n_row ? c->set->singular : 0, c->z, c->lcp, c->lcp_i);
  for (int r = 0; r < n; r++) amount[c->island[r]] = c->z[r];
}

/* Over the marked contacts and all joints A amount = -rate, of minimum norm where they are redundant; 0 elsewhere.
   Leaves the rows in c->list and returns their number. */
MG_INTERNAL int mg_hold(mg_context *c, const int *marked, const mg_real *rate, mg_real *amount) {
  int n = 0;
  for (int i = 0; i < c->sys->n_contact; i++) {
    amount[i] = 0;
    if (marked[i]) c->list[n++] = i;
  }
  n = mg_list_joints(c, c->list, n);
  for (int i = c->below; i < c->n_all; i++) amount[i] = 0;
  if (c->sys->n_grip) n = mg_list_stuck(c, c->list, n);
  if (n == 1 && !c->leaning) {
    const mg_real weight = mg_weigh(c, c->list[0]);
    amount[c->list[0]] = weight > 0 ? -rate[c->list[0]] / weight : 0;
  } else if (n > 0) {
    mg_chain(c, n);
    for (int b = 0; b < c->sys->n_body; b++)
      if (c->head[b] >= 0) mg_hold_island(c, c->head[b], rate, amount);
  }
  return n;
}
