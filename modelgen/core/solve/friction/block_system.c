/* Sparse linear systems whose unknowns are the motions of bodies, six each: a block of 6 by 6 for each body, and two
   for each pair of bodies that act on each other. The body with the fewest neighbours is eliminated first (minimum
   degree: Tinney and Walker, Proc. IEEE 55 (1967), 1801-1809), which keeps the fill small where the graph of contacts
   is sparse: none in a stack. Pivots are sought within the block of a body. */
#include "solve/friction/friction_solvers.h"
#include "base/base.h"

enum { MG_BITS = 31 }; /* of an int, of which the sign is left alone */

/* Row of the adjacency of a body. */
static int *mg_neighbours(const mg_block_system *b, int node) { return b->adjacency + (long)b->words * node; }

static int mg_is_neighbour(const mg_block_system *b, int node, int other) {
  return mg_neighbours(b, node)[other / MG_BITS] >> (other % MG_BITS) & 1;
}

static void mg_set_neighbour(const mg_block_system *b, int node, int other) {
  mg_neighbours(b, node)[other / MG_BITS] |= 1 << (other % MG_BITS);
}

MG_INTERNAL long long mg_block_words(int n) { return (n + MG_BITS - 1LL) / MG_BITS; }

MG_INTERNAL void mg_block_open(mg_block_system *b, int n) {
  b->n = n, b->words = (int)mg_block_words(n);
  for (long i = 0; i < (long)b->words * n; ++i) b->adjacency[i] = 0;
}

MG_INTERNAL void mg_block_connect(mg_block_system *b, int node, int other) {
  if (node == other) return;
  mg_set_neighbour(b, node, other);
  mg_set_neighbour(b, other, node);
}

/* Number of neighbours of a body that are not eliminated, whose ranks are negative. */
static int mg_block_degree(const mg_block_system *b, int node) {
  int count = 0;
  for (int word = 0; word < b->words; ++word)
    for (int bits = mg_neighbours(b, node)[word]; bits; bits &= bits - 1) ++count;
  return count;
}

/* Takes a body from the graph and lists its neighbours, which become neighbours of each other. Returns 0 if there is no
   room for its blocks. */
static int mg_block_eliminate(mg_block_system *b, int node, int rank) {
  int count = b->first[rank];
  b->order[rank] = node, b->rank[node] = rank;
  for (int other = 0; other < b->n; ++other) {
    if (!mg_is_neighbour(b, node, other)) continue;
    if (count == b->capacity) return 0;
    b->node[count++] = other;
    mg_neighbours(b, other)[node / MG_BITS] &= ~(1 << (node % MG_BITS));
  }
  b->first[rank + 1] = count;
  for (int k = b->first[rank]; k < count; ++k) {
    const int other = b->node[k];
    for (int word = 0; word < b->words; ++word) mg_neighbours(b, other)[word] |= mg_neighbours(b, node)[word];
    mg_neighbours(b, other)[other / MG_BITS] &= ~(1 << (other % MG_BITS));
    b->degree[other] = mg_block_degree(b, other);
  }
  return 1;
}

MG_INTERNAL int mg_block_analyse(mg_block_system *b) {
  b->first[0] = 0;
  for (int node = 0; node < b->n; ++node) b->rank[node] = -1, b->degree[node] = mg_block_degree(b, node);
  for (int rank = 0; rank < b->n; ++rank) {
    int next = -1;
    for (int node = 0; node < b->n; ++node)
      if (b->rank[node] < 0 && (next < 0 || b->degree[node] < b->degree[next])) next = node;
    if (!mg_block_eliminate(b, next, rank)) return 0;
  }
  return 1;
}

MG_INTERNAL void mg_block_clear(mg_block_system *b) {
  for (long i = 0; i < (long)MG_BLOCK_SIZE * b->n; ++i) b->diagonal[i] = 0;
  for (long i = 0; i < (long)MG_BLOCK_SIZE * b->first[b->n]; ++i) b->lower[i] = b->upper[i] = 0;
  for (int node = 0; node < b->n; ++node)
    for (int k = 0; k < 6; ++k) b->diagonal[MG_BLOCK_SIZE * node + 7 * k] = 1;
}

MG_INTERNAL mg_real *mg_block_at(mg_block_system *b, int row, int column) {
  if (row == column) return b->diagonal + (long)MG_BLOCK_SIZE * row;
  const int is_lower = b->rank[column] < b->rank[row], early = is_lower ? column : row, late = is_lower ? row : column;
  int low = b->first[b->rank[early]], high = b->first[b->rank[early] + 1] - 1;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (b->node[middle] < late) low = middle + 1;
    else high = middle;
  }
  MG_REQUIRE(b->node[low] == late);
  return (is_lower ? b->lower : b->upper) + (long)MG_BLOCK_SIZE * low;
}

/* Replaces a block by its inverse. Returns 0 if it is singular. */
static int mg_block_invert(mg_real *A) {
  mg_real AB[2 * MG_BLOCK_SIZE]; /* that of the transpose is the transpose of the inverse */
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) AB[12 * i + j] = A[6 * i + j], AB[12 * i + 6 + j] = i == j;
  if (!mg_solve_columns(6, 12, AB)) return 0;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) A[6 * i + j] = AB[12 * i + 6 + j];
  return 1;
}

/* y -= A x of a block; the sums stay in registers. */
static inline void mg_block_subtract_image(const mg_real *A, const mg_real *x, mg_real *y) {
  mg_real y0 = y[0], y1 = y[1], y2 = y[2], y3 = y[3], y4 = y[4], y5 = y[5];
  for (int k = 0; k < 6; ++k) {
    const mg_real *a = A + 6 * k, factor = x[k];
    y0 -= a[0] * factor, y1 -= a[1] * factor, y2 -= a[2] * factor;
    y3 -= a[3] * factor, y4 -= a[4] * factor, y5 -= a[5] * factor;
  }
  y[0] = y0, y[1] = y1, y[2] = y2, y[3] = y3, y[4] = y4, y[5] = y5;
}

/* C -= A B of blocks by columns. */
static void mg_block_subtract_product(const mg_real *A, const mg_real *B, mg_real *C) {
  for (int j = 0; j < 6; ++j) mg_block_subtract_image(A, B + 6 * j, C + 6 * j);
}

MG_INTERNAL int mg_block_factor(mg_block_system *b) {
  for (int rank = 0; rank < b->n; ++rank) {
    const int node = b->order[rank];
    mg_real *own = b->diagonal + (long)MG_BLOCK_SIZE * node;
    if (!mg_block_invert(own)) return 0;
    for (int k = b->first[rank]; k < b->first[rank + 1]; ++k) {
      mg_real *upper = b->upper + (long)MG_BLOCK_SIZE * k, product[MG_BLOCK_SIZE] = {0};
      mg_block_subtract_product(own, upper, product);
      for (int i = 0; i < MG_BLOCK_SIZE; ++i) upper[i] = -product[i];
    }
    for (int i = b->first[rank]; i < b->first[rank + 1]; ++i)
      for (int j = b->first[rank]; j < b->first[rank + 1]; ++j)
        mg_block_subtract_product(b->lower + (long)MG_BLOCK_SIZE * i, b->upper + (long)MG_BLOCK_SIZE * j,
                                  mg_block_at(b, b->node[i], b->node[j]));
  }
  return 1;
}

MG_INTERNAL void mg_block_solve(const mg_block_system *b, mg_real *x) {
  for (int rank = 0; rank < b->n; ++rank) {
    const int node = b->order[rank];
    mg_real product[6] = {0};
    mg_block_subtract_image(b->diagonal + (long)MG_BLOCK_SIZE * node, x + 6L * node, product);
    for (int i = 0; i < 6; ++i) x[6L * node + i] = -product[i];
    for (int k = b->first[rank]; k < b->first[rank + 1]; ++k)
      mg_block_subtract_image(b->lower + (long)MG_BLOCK_SIZE * k, x + 6L * node, x + 6L * b->node[k]);
  }
  for (int rank = b->n - 1; rank >= 0; --rank)
    for (int k = b->first[rank]; k < b->first[rank + 1]; ++k)
      mg_block_subtract_image(b->upper + (long)MG_BLOCK_SIZE * k, x + 6L * b->node[k], x + 6L * b->order[rank]);
}
