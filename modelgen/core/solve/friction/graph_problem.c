/* Friction problems on a graph: bodies are its nodes, contacts and bilateral rows its edges. Each row is kept as two
   blocks of six, and forces act on each other through the motion of the bodies, so that memory and the cost of a sweep
   grow with the number of contacts and not with its square. Bilateral rows are not eliminated; they are solved in turn
   as contacts are. */
#include "solve/friction/friction_solvers.h"
#include "base/base.h"
#include "solve/lcp/lcp_solvers.h"

enum {
  MG_GRAPH_VECTORS = 20, /* vectors of the length of the rows */
  MG_GRAPH_PAIRS = 8     /* room for pairs of bodies that act on each other, per contact and body */
};

/* Pairs of bodies for which there is room. */
static long long mg_graph_pair_capacity(int n_contact, int n_body) {
  return MG_GRAPH_PAIRS * ((long long)n_contact + n_body);
}

/* Bodies on which n rows may act. */
static long long mg_graph_body_capacity(int n, int n_body) { return n_body < 2LL * n ? n_body : 2LL * n; }

MG_API long long mg_friction_graph_work_size(int n, int n_contact, int n_body) {
  const long long bodies = mg_graph_body_capacity(n, n_body);
  return (25LL + MG_GRAPH_VECTORS) * n + (2LL * MG_BLOCK_SIZE + 3) * n_contact + (12LL + MG_BLOCK_SIZE) * bodies +
         2LL * MG_BLOCK_SIZE * mg_graph_pair_capacity(n_contact, (int)bodies);
}

MG_API long long mg_friction_graph_iwork_size(int n, int n_contact, int n_body) {
  const long long bodies = mg_graph_body_capacity(n, n_body);
  return 5LL * n + 12LL * (n_contact + 1LL) + n_body + (5LL + mg_block_words((int)bodies)) * (bodies + 1LL) +
         mg_graph_pair_capacity(n_contact, (int)bodies);
}

/* Divides the memory. */
static void mg_graph_partition(mg_scaled_friction *s, int n_body, mg_real *work, int *iwork) {
  const long n = s->given->n, k = s->given->n_contact, bodies = (long)mg_graph_body_capacity((int)n, n_body),
             pairs = (long)mg_graph_pair_capacity((int)k, (int)bodies);
  mg_scaled_graph *g = &s->graph;
  mg_block_system *b = &g->system;
  mg_real **vectors[] = {&s->e, &s->c, &s->y, &s->v, &s->best, &g->yield, &g->push, &s->spare};
  int **lists[] = {&b->degree, &b->order, &b->rank};
  g->J = work, g->MJ = g->J + 12 * n, g->block = g->MJ + 12 * n, g->stiffness = g->block + MG_BLOCK_SIZE * k;
  s->rho = g->stiffness + MG_BLOCK_SIZE * k + n, work = s->rho + 3 * k;
  for (int i = 0; i < 8; ++i, work += n) *vectors[i] = work;
  work += n, s->work = work, work += 11 * n;
  g->motion = work, g->step = g->motion + 6 * bodies, b->diagonal = g->step + 6 * bodies;
  b->lower = b->diagonal + MG_BLOCK_SIZE * bodies, b->upper = b->lower + MG_BLOCK_SIZE * pairs;
  s->row = iwork, s->bilateral = s->row + n, g->body = s->bilateral + n, s->iwork = g->body + 2 * n;
  s->normal = s->iwork + n, s->part = s->normal + k, s->part_row = s->part + k + 1;
  s->part_dim = s->part_row + 3 * k, s->part_mark = s->part_dim + 3 * k, iwork = s->part_mark + 3 * k;
  for (int i = 0; i < 3; ++i, iwork += bodies) *lists[i] = iwork;
  g->number = iwork, iwork += n_body;
  b->first = iwork, b->node = b->first + bodies + 1;
  b->adjacency = b->node + pairs, b->capacity = (int)pairs;
}

/* Number of a body of the given problem among those that its rows act on, or -1. */
static int mg_graph_number_body(mg_scaled_graph *g, int body) {
  if (body < 0) return -1;
  if (g->number[body] < 0) g->number[body] = g->n_body++;
  return g->number[body];
}

/* Numbers the bodies of the rows, and finds which act on each other. */
static void mg_graph_connect(mg_scaled_friction *s, const mg_friction_graph *given) {
  mg_scaled_graph *g = &s->graph;
  g->n_body = 0;
  for (int b = 0; b < given->n_body; ++b) g->number[b] = -1;
  for (int i = 0; i < 2 * mg_friction_rows(s); ++i)
    g->body[i] = mg_graph_number_body(g, given->body[2 * s->row[i / 2] + i % 2]);
  mg_block_open(&g->system, g->n_body);
  for (int i = 0; i < mg_friction_rows(s); ++i)
    if (g->body[2 * i] >= 0 && g->body[2 * i + 1] >= 0)
      mg_block_connect(&g->system, g->body[2 * i], g->body[2 * i + 1]);
  g->has_system = mg_block_analyse(&g->system);
}

/* Sets the scaled row i of row r of the problem; its scale is e[i]. */
static void mg_graph_set_row(mg_scaled_friction *s, const mg_friction_graph *given, int i, int r) {
  mg_scaled_graph *g = &s->graph;
  for (int side = 0; side < 2; ++side) {
    const int body = given->body[2 * r + side];
    const mg_real *J = given->J + 12L * given->place[r] + 6 * side, *MJ = given->MJ + 12L * given->place[r] + 6 * side;
    for (int k = 0; k < 6; ++k) {
      g->J[12L * i + 6 * side + k] = body < 0 ? 0 : s->e[i] * J[k];
      g->MJ[12L * i + 6 * side + k] = body < 0 ? 0 : s->e[i] * MJ[k];
    }
  }
  g->yield[i] = s->e[i] * s->e[i] * given->yield[r];
  s->c[i] = s->e[i] * s->given->b[r];
}

/* 1 / sqrt(A_rr) of a row of the problem, or 1 where that is 0. */
static mg_real mg_graph_row_scale(const mg_friction_graph *given, int r) {
  const mg_real *J = given->J + 12L * given->place[r], *MJ = given->MJ + 12L * given->place[r];
  mg_real diagonal = given->yield[r];
  for (int side = 0; side < 2; ++side)
    if (given->body[2 * r + side] >= 0) diagonal += mg_dot6(J + 6 * side, MJ + 6 * side);
  return 1 / mg_diagonal_scale((mg_real)fabs(diagonal));
}

/* Sets the rows of a contact, its block and the means of its parts. */
static void mg_graph_set_contact(mg_scaled_friction *s, const mg_friction_graph *given, int contact) {
  mg_scaled_graph *g = &s->graph;
  const int from = s->normal[contact], to = mg_friction_row_end(s, contact);
  const mg_real e = mg_graph_row_scale(given, s->row[from]);
  mg_real *block = g->block + (long)MG_BLOCK_SIZE * contact;
  for (int i = from; i < to; ++i) {
    s->e[i] *= e;
    mg_graph_set_row(s, given, i, s->row[i]);
  }
  for (int i = from; i < to; ++i)
    for (int j = from; j < to; ++j) block[i - from + MG_ROWS * (j - from)] = mg_graph_entry(g, i, j);
  for (int p = s->part[contact]; p < s->part[contact + 1]; ++p) {
    mg_real sum = 0;
    for (int i = s->part_row[p]; i < s->part_row[p] + s->part_dim[p]; ++i) sum += mg_graph_entry(g, i, i);
    s->rho[p] = sum > 0 ? sum / (mg_real)s->part_dim[p] : (mg_real)1;
  }
}

/* Sets up the scaled problem. Returns 0 if the data are not finite. */
static int mg_graph_scale(mg_scaled_friction *s, const mg_friction_graph *given) {
  for (int c = 0; c < s->n; ++c) mg_graph_set_contact(s, given, c);
  for (int k = 0; k < s->n_bilateral; ++k) {
    const int i = s->m + k, r = s->bilateral[k];
    s->row[i] = r, s->e[i] = mg_graph_row_scale(given, r);
    mg_graph_set_row(s, given, i, r);
  }
  s->n_free = s->n_bilateral;
  const int rows = mg_friction_rows(s);
  if (!mg_all_finite(12 * rows, s->graph.J) || !mg_all_finite(12 * rows, s->graph.MJ)) return 0;
  s->scale = mg_max(mg_friction_size(s), mg_max_abs(s->n_free, s->c + s->m));
  if (!(s->scale > 0)) s->scale = 1;
  if (!(s->scale <= MG_MAX) || !mg_all_finite(rows, s->c)) return 0;
  for (int i = 0; i < rows; ++i) s->c[i] /= s->scale, s->best[i] = 0;
  return 1;
}

MG_INTERNAL int mg_graph_set_up(mg_scaled_friction *s, const mg_friction_problem *problem,
                                const mg_friction_graph *graph, mg_real *work, int *iwork) {
  mg_friction_open(s, problem);
  mg_graph_partition(s, graph->n_body, work, iwork);
  if (!mg_friction_choose_rows(s, s->iwork) || !mg_graph_scale(s, graph)) return 0;
  mg_graph_connect(s, graph);
  return 1;
}
