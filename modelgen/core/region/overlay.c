/* Overlay of two regions: the parts of each boundary that lie in the other region. Also divides the memory that an
   overlay and its hull share. */
#include "region/region.h"
#include "base/base.h"

/* Capacities of a hull. */
typedef struct {
  long span, intersection, piece, vertex; /* numbers of each for which there is room */
} mg_hull_capacity;

/* Capacities for n_arc arcs, of which n_o are o's. */
static mg_hull_capacity mg_capacity_of(int n_arc, int n_o) {
  mg_hull_capacity r;
  r.span = 24L * n_arc + 512;
  r.intersection = 2L * n_o * (n_arc - n_o) + (n_o ? 4L * n_arc + 64 : 0);
  r.piece = n_arc + 2 * r.intersection;
  r.vertex = r.span + 2 * r.piece + r.intersection + 256;
  return r;
}

MG_INTERNAL long mg_hull_memory_size(int n_arc, int n_o) {
  const mg_hull_capacity r = mg_capacity_of(n_arc, n_o);
  return mg_count_reals(n_arc, sizeof(mg_placed_arc)) + mg_count_reals(r.span, sizeof(mg_arc_span)) +
         mg_count_reals(r.intersection, sizeof(mg_intersection)) + mg_count_reals(r.piece, sizeof(mg_boundary_piece)) +
         mg_count_reals(r.vertex, sizeof(mg_hull_vertex)) + mg_count_reals(r.vertex, sizeof(mg_hull_edge)) +
         mg_count_reals(2 * r.vertex, sizeof(int));
}

MG_INTERNAL long mg_strip_capacity(int n_arc, int n_o) {
  const mg_hull_capacity r = mg_capacity_of(n_arc, n_o);
  return 2 * (r.span + r.piece);
}

MG_INTERNAL void mg_set_regions(mg_hull *h, const mg_region_pair *regions, mg_real *memory) {
  const mg_hull_capacity r = mg_capacity_of(regions->n_arc, regions->n_o);
  h->regions = regions;
  h->arcs = mg_take_memory(&memory, regions->n_arc, sizeof(mg_placed_arc));
  h->spans = mg_take_memory(&memory, r.span, sizeof(mg_arc_span)), h->span_capacity = (int)r.span;
  h->intersections = mg_take_memory(&memory, r.intersection, sizeof(mg_intersection)),
  h->intersection_capacity = (int)r.intersection;
  h->pieces = mg_take_memory(&memory, r.piece, sizeof(mg_boundary_piece)), h->piece_capacity = (int)r.piece;
  h->vertices = mg_take_memory(&memory, r.vertex, sizeof(mg_hull_vertex)), h->vertex_capacity = (int)r.vertex;
  h->edges = mg_take_memory(&memory, r.vertex, sizeof(mg_hull_edge));
  h->order = mg_take_memory(&memory, 2 * r.vertex, sizeof(int));
  mg_divide_arcs(h);
}

/* Intersection of an arc that follows parameter t, after those already passed at t, or -1. */
static int mg_next_intersection(const mg_hull *h, int arc, mg_real t, int before) {
  const int side = h->arcs[arc].side;
  int next = -1;
  for (int i = 0; i < h->n_intersection; i++) {
    const mg_intersection *crossing = h->intersections + i;
    if (crossing->arc[side] != arc || crossing->t[side] < t || (crossing->t[side] == t && i <= before)) continue;
    if (next < 0 || crossing->t[side] < h->intersections[next].t[side]) next = i;
  }
  return next;
}

/* Whether a part of an arc is in the other region, by a point that is not on its boundary; 2: all points tried are
   on it. */
static int mg_is_part_inside(const mg_hull *h, int arc, mg_real t0, mg_real t1) {
  static const mg_real parts[] = {0.5, 0.23, 0.81};
  for (int i = 0; i < 3; i++) {
    mg_real p[2], T[2];
    mg_arc_point(h->arcs + arc, t0 + parts[i] * (t1 - t0), p, T);
    const int inside = mg_locate_point(h, !h->arcs[arc].side, p);
    if (inside < 2) return inside;
  }
  return 2;
}

/* True if the overlap has no width at a point where both boundaries coincide. */
static int mg_is_thin(const mg_hull *h, int arc, mg_real t) {
  mg_real p[2], T[2];
  mg_arc_point(h->arcs + arc, t, p, T);
  const mg_real step = 8 * MG_COINCIDENCE_FACTOR * h->regions->coincidence / sqrt(mg_dot2(T, T));
  const mg_real left[2] = {p[0] - step * T[1], p[1] + step * T[0]}, right[2] = {p[0] + step * T[1], p[1] - step * T[0]};
  return !(mg_locate_point(h, 0, left) && mg_locate_point(h, 1, left)) &&
         !(mg_locate_point(h, 0, right) && mg_locate_point(h, 1, right));
}

/* Adds the part from t0 to t1 if it lies in the other region; where both boundaries coincide, only o's. */
static void mg_add_piece(mg_hull *h, int arc, mg_real t0, mg_real t1, int intersection0, int intersection1) {
  const mg_placed_arc *k = h->arcs + arc;
  mg_real p[2], T[2];
  if (!(t1 > t0)) return;
  mg_arc_point(k, (t0 + t1) / 2, p, T);
  if (sqrt(mg_dot2(T, T)) * (t1 - t0) <= h->regions->coincidence) return;
  const int inside = mg_is_part_inside(h, arc, t0, t1);
  if (!inside || (inside == 2 && k->side)) return;
  if (h->n_piece == h->piece_capacity) {
    h->overflow = 1;
    return;
  }
  const mg_boundary_piece piece = {
      arc, inside == 2 && mg_is_thin(h, arc, (t0 + t1) / 2), {intersection0, intersection1}, {t0, t1}};
  h->pieces[h->n_piece++] = piece;
}

/* Finds all pieces of the boundary of the overlap. */
static void mg_find_pieces(mg_hull *h) {
  h->n_piece = 0;
  for (int i = 0; i < h->regions->n_arc; i++) {
    const mg_placed_arc *k = h->arcs + i;
    mg_real t = k->t0;
    int before = -1;
    for (;;) {
      const int next = mg_next_intersection(h, i, t, before);
      mg_add_piece(h, i, t, next < 0 ? k->t1 : h->intersections[next].t[k->side], before, next);
      if (next < 0) break;
      t = h->intersections[next].t[k->side], before = next;
    }
  }
}

MG_INTERNAL int mg_overlay_regions(mg_hull *h, const mg_real *pose) {
  mg_place_arcs(h, pose);
  mg_find_intersections(h);
  mg_find_pieces(h);
  mg_make_hull(h);
  return h->n_edge;
}
