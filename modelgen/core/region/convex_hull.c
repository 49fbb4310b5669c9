/* Convex hull of the overlap of two regions, with straight and curved edges: first of points on its boundary, by
   Andrew's monotone chain (Inf. Proc. Letters 9, 1979); then points are added where a curve lies outside a
   straight edge, until none does, and the ends of straight edges are moved to their points of tangency. Writes
   vertices and edges of the hull. */
#include "region/region.h"
#include "base/base.h"

#define MG_HULL_PASSES 60 /* most passes in which points of curves are added */

/* Adds a point of an arc at parameter t; returns its number, or -1 if there is no room. */
static int mg_add_vertex(mg_hull *h, int arc, int crossing, mg_real t) {
  if (h->n_vertex == h->vertex_capacity) {
    h->overflow = 1;
    return -1;
  }
  mg_hull_vertex *s = h->vertices + h->n_vertex;
  s->arc = arc, s->intersection = crossing, s->t = s->t_end = t, s->next = -1, s->twin = h->n_vertex;
  mg_arc_point(h->arcs + arc, t, s->point, s->tangent);
  return h->n_vertex++;
}

/* Adds the ends of a piece and, of a curve, the ends of its spans. */
static void mg_add_piece_vertices(mg_hull *h, const mg_boundary_piece *piece) {
  const mg_placed_arc *k = h->arcs + piece->arc;
  int last = mg_add_vertex(h, piece->arc, piece->intersection[0], piece->t[0]);
  for (int i = k->span; i < k->span + k->n_span && last >= 0; i++) {
    const mg_real t = i + 1 < k->span + k->n_span ? mg_min(h->spans[i].t_end, piece->t[1]) : piece->t[1];
    if (t <= piece->t[0] || h->spans[i].t_begin >= piece->t[1]) continue;
    const int end = t == piece->t[1], vertex = mg_add_vertex(h, piece->arc, end ? piece->intersection[1] : -1, t);
    if (!k->straight) h->vertices[last].next = vertex, h->vertices[last].t_end = t;
    last = vertex;
  }
}

/* Adds the points of all pieces and all intersections. */
static void mg_add_all_vertices(mg_hull *h) {
  h->n_vertex = 0;
  for (int i = 0; i < h->n_piece; i++) mg_add_piece_vertices(h, h->pieces + i);
  for (int i = 0; i < h->n_intersection; i++) {
    const mg_intersection *crossing = h->intersections + i;
    const int vertex = mg_add_vertex(h, crossing->arc[1], i, crossing->t[1]);
    if (vertex >= 0)
      h->vertices[vertex].point[0] = crossing->point[0], h->vertices[vertex].point[1] = crossing->point[1];
  }
}

/* True if vertex a comes before vertex b in the order from left to right. */
static int mg_is_left_of(const mg_hull *h, int a, int b) {
  const mg_real *p = h->vertices[a].point, *q = h->vertices[b].point;
  return p[0] < q[0] || (p[0] == q[0] && p[1] < q[1]);
}

/* Sorts n vertices from left to right (Shell's sort). */
static void mg_sort_vertices(mg_hull *h, int n) {
  int gap = 1;
  while (gap < n / 3) gap = 3 * gap + 1;
  for (; gap; gap /= 3)
    for (int i = gap; i < n; i++) {
      const int moved = h->order[i];
      int j = i;
      for (; j >= gap && mg_is_left_of(h, moved, h->order[j - gap]); j -= gap) h->order[j] = h->order[j - gap];
      h->order[j] = moved;
    }
}

/* Removes vertices that coincide with one further left from the order, and links them as its twins. Returns the
   number of vertices left. */
static int mg_merge_coincident_vertices(mg_hull *h, int n) {
  const mg_real near = 2 * MG_COINCIDENCE_FACTOR * h->regions->coincidence;
  int kept = 0;
  for (int i = 0; i < n; i++) {
    const int vertex = h->order[i];
    int same = -1;
    for (int j = kept - 1; j >= 0 && same < 0; j--) {
      const mg_hull_vertex *other = h->vertices + h->order[j];
      if (h->vertices[vertex].point[0] - other->point[0] > near) break;
      if (mg_distance2(other->point, h->vertices[vertex].point) <= near) same = h->order[j];
    }
    if (same < 0) {
      h->order[kept++] = vertex;
      continue;
    }
    const int next = h->vertices[same].twin;
    h->vertices[same].twin = h->vertices[vertex].twin, h->vertices[vertex].twin = next;
  }
  return kept;
}

/* True if the path p, q, r does not turn left at q. */
static int mg_turns_right(const mg_hull *h, int p, int q, int r) {
  const mg_real *a = h->vertices[p].point, *b = h->vertices[q].point, *c = h->vertices[r].point;
  const mg_real part[2] = {b[0] - a[0], b[1] - a[1]}, whole[2] = {c[0] - a[0], c[1] - a[1]};
  return mg_cross2(part, whole) <= 0;
}

/* True if q is a point of a straight edge from p to r. */
static int mg_is_collinear(const mg_hull *h, int p, int q, int r) {
  const mg_real *a = h->vertices[p].point, *b = h->vertices[q].point, *c = h->vertices[r].point;
  const mg_real part[2] = {b[0] - a[0], b[1] - a[1]}, rest[2] = {c[0] - b[0], c[1] - b[1]};
  const mg_real whole[2] = {c[0] - a[0], c[1] - a[1]}, length = sqrt(mg_dot2(whole, whole));
  if (!h->arcs[h->vertices[q].arc].straight || mg_dot2(part, rest) <= 0) return 0;
  return mg_cross2(part, whole) <= h->regions->coincidence * length;
}

/* Corners of the convex hull of n sorted vertices, counterclockwise (Andrew's monotone chain); returns their
   number. */
static int mg_hull_chain(const mg_hull *h, int n, int *corner) {
  int count = 0;
  for (int way = 0; way < 2; way++) {
    const int floor = way ? count + 1 : 2;
    for (int i = way; i < n; i++) {
      const int vertex = h->order[way ? n - 1 - i : i];
      while (count >= floor && mg_turns_right(h, corner[count - 2], corner[count - 1], vertex)) count--;
      corner[count++] = vertex;
    }
  }
  return count > 1 ? count - 1 : count;
}

/* Removes corners inside straight edges; returns the number left. */
static int mg_drop_collinear(const mg_hull *h, int count, int *corner) {
  int i = 0;
  while (i < count && count > 2) {
    if (!mg_is_collinear(h, corner[(i + count - 1) % count], corner[i], corner[(i + 1) % count])) {
      i++;
      continue;
    }
    count--;
    for (int j = i; j < count; j++) corner[j] = corner[j + 1];
  }
  return count;
}

/* Finds twins of two corners that one span of a curve joins, and returns 1 if it leads from u to v, -1 if from v
   to u, else 0. */
static int mg_curve_direction_between(const mg_hull *h, int *u, int *v) {
  int a = *u;
  do {
    int b = *v;
    do {
      const int way = (h->vertices[a].next == b) - (h->vertices[b].next == a);
      if (way) {
        *u = a, *v = b;
        return way;
      }
      b = h->vertices[b].twin;
    } while (b != *v);
    a = h->vertices[a].twin;
  } while (a != *u);
  return 0;
}

/* Sets the edge from corner u to corner v. */
static void mg_make_edge(const mg_hull *h, mg_hull_edge *e, int u, int v) {
  e->from_vertex = u, e->to_vertex = v;
  e->direction = mg_curve_direction_between(h, &e->from_vertex, &e->to_vertex);
  const mg_hull_vertex *a = h->vertices + e->from_vertex, *b = h->vertices + e->to_vertex;
  const mg_real chord[2] = {b->point[0] - a->point[0], b->point[1] - a->point[1]};
  e->length = sqrt(mg_dot2(chord, chord));
  e->normal[0] = e->length > 0 ? chord[1] / e->length : 0, e->normal[1] = e->length > 0 ? -chord[0] / e->length : 0;
  const mg_real rise = e->direction * mg_dot2(e->normal, a->tangent),
                fall = e->direction * mg_dot2(e->normal, b->tangent);
  if (!(rise > 0 && fall < 0)) e->direction = 0;
  e->height = e->direction ? e->length * rise / sqrt(mg_dot2(a->tangent, a->tangent)) : 0;
}

/* Makes the hull of the present vertices. */
static void mg_make_edges(mg_hull *h) {
  for (int i = 0; i < h->n_vertex; i++) h->order[i] = h->vertices[i].twin = i;
  mg_sort_vertices(h, h->n_vertex);
  const int n = mg_merge_coincident_vertices(h, h->n_vertex);
  int *corner = h->order + h->vertex_capacity;
  const int count = mg_drop_collinear(h, mg_hull_chain(h, n, corner), corner);
  for (int i = 0; i < count; i++) mg_make_edge(h, h->edges + i, corner[i], corner[(i + 1) % count]);
  h->n_edge = count;
}

/* Parameter at which the span from a vertex to the next is farthest along n; returns 0 if that is at an end. */
static int mg_find_extreme_point(const mg_hull *h, int vertex, const mg_real *n, mg_real *t) {
  const mg_hull_vertex *s = h->vertices + vertex, *to = h->vertices + s->next;
  if (!(mg_dot2(n, s->tangent) > 0 && mg_dot2(n, to->tangent) < 0)) return 0;
  *t = mg_zero_on_arc(h->arcs + s->arc, MG_ZERO_SUPPORT, n, s->t, s->t_end);
  return *t != s->t && *t != s->t_end;
}

/* Adds the point of a curve that is farthest outside a straight edge; returns whether there is one. */
static int mg_split_at_farthest_point(mg_hull *h, const mg_hull_edge *e, int n) {
  const mg_real *n_ = e->normal, floor = mg_dot2(n_, h->vertices[e->from_vertex].point);
  mg_real best = 2 * MG_EPS * h->size, best_t = 0;
  int from = -1;
  for (int i = 0; i < n; i++) {
    mg_real t, p[2], T[2];
    if (h->vertices[i].next < 0 || !mg_find_extreme_point(h, i, n_, &t)) continue;
    mg_arc_point(h->arcs + h->vertices[i].arc, t, p, T);
    if (mg_dot2(n_, p) - floor > best) best = mg_dot2(n_, p) - floor, best_t = t, from = i;
  }
  if (from < 0) return 0;
  const int added = mg_add_vertex(h, h->vertices[from].arc, -1, best_t);
  if (added < 0) return 0;
  h->vertices[added].next = h->vertices[from].next, h->vertices[added].t_end = h->vertices[from].t_end;
  h->vertices[from].next = added, h->vertices[from].t_end = best_t;
  return 1;
}

/* Moves the end of a straight edge that lies inside a curve to the point of tangency. */
static void mg_move_to_tangency(mg_hull *h, int vertex, const mg_real *n) {
  mg_hull_vertex *s = h->vertices + vertex;
  int before = -1;
  for (int i = 0; i < h->n_vertex && before < 0; i++)
    if (h->vertices[i].next == vertex) before = i;
  if (before < 0 || s->next < 0) return;
  mg_real t;
  if (!mg_find_extreme_point(h, before, n, &t) && !mg_find_extreme_point(h, vertex, n, &t)) return;
  s->t = h->vertices[before].t_end = t;
  mg_arc_point(h->arcs + s->arc, t, s->point, s->tangent);
}

/* Moves the ends of all straight edges to their points of tangency. */
static void mg_move_all_to_tangency(mg_hull *h) {
  for (int i = 0; i < h->n_edge; i++) {
    mg_hull_edge *e = h->edges + i;
    if (e->direction || e->length <= MG_SHORT_SIDE * h->regions->coincidence) continue;
    mg_move_to_tangency(h, e->from_vertex, e->normal), mg_move_to_tangency(h, e->to_vertex, e->normal);
  }
  for (int i = 0; i < h->n_edge; i++) mg_make_edge(h, h->edges + i, h->edges[i].from_vertex, h->edges[i].to_vertex);
}

MG_INTERNAL void mg_make_hull(mg_hull *h) {
  mg_add_all_vertices(h);
  mg_make_edges(h);
  for (int pass = 0; pass < MG_HULL_PASSES; pass++) {
    const int n = h->n_vertex;
    int added_count = 0;
    for (int i = 0; i < h->n_edge; i++)
      if (!h->edges[i].direction && h->edges[i].length > 0)
        added_count += mg_split_at_farthest_point(h, h->edges + i, h->n_vertex);
    if (!added_count || h->n_vertex == n) break;
    mg_make_edges(h);
  }
  mg_move_all_to_tangency(h);
}
