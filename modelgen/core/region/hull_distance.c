/* Signed distance of a point from the boundary of a convex hull, and the nearest place of that boundary. */
#include "region/region.h"
#include "base/base.h"

/* The nearest point of the boundary of a hull found so far. */
typedef struct {
  mg_real distance; /* its distance, m */
  mg_real t;        /* its curve parameter, on a curved edge */
  int edge;         /* its edge */
  int vertex;       /* its vertex, or -1: it is inside the edge */
  int curve;        /* 1: it is inside a curved edge */
} mg_nearest_edge;

/* Nearest vertex. */
static void mg_try_vertices(const mg_hull *h, const mg_real *x, mg_nearest_edge *best) {
  mg_real least = MG_MAX;
  for (int i = 0; i < h->n_edge; i++) {
    const mg_real *p = h->vertices[h->edges[i].from_vertex].point, arm[2] = {p[0] - x[0], p[1] - x[1]},
                  square = mg_dot2(arm, arm);
    if (square < least) least = square, best->edge = i;
  }
  best->vertex = h->edges[best->edge].from_vertex, best->t = h->vertices[best->vertex].t, best->curve = 0,
  best->distance = sqrt(least);
}

/* Nearest point inside a curved edge, if it is nearer than the best. Returns 1 if x is outside the curve there. */
static int mg_try_curved_edge(const mg_hull *h, int edge, const mg_real *x, mg_nearest_edge *best) {
  const mg_hull_edge *e = h->edges + edge;
  const mg_hull_vertex *a = h->vertices + (e->direction > 0 ? e->from_vertex : e->to_vertex),
                       *b = h->vertices + a->next;
  const mg_real from[2] = {a->point[0] - x[0], a->point[1] - x[1]}, to[2] = {b->point[0] - x[0], b->point[1] - x[1]};
  if (!(mg_dot2(from, a->tangent) < 0 && mg_dot2(to, b->tangent) > 0)) return 0;
  mg_real p[2], T[2];
  const mg_real t = mg_zero_on_arc(h->arcs + a->arc, MG_ZERO_NEAREST, x, a->t, a->t_end);
  mg_arc_point(h->arcs + a->arc, t, p, T);
  const mg_real arm[2] = {x[0] - p[0], x[1] - p[1]}, distance = sqrt(mg_dot2(arm, arm));
  if (distance <= best->distance) {
    const mg_nearest_edge found = {distance, t, edge, -1, 1};
    *best = found;
  }
  return e->direction * mg_cross2(T, arm) < 0;
}

/* The same for a straight edge. */
static int mg_try_straight_edge(const mg_hull *h, int edge, const mg_real *x, mg_nearest_edge *best) {
  const mg_hull_edge *e = h->edges + edge;
  const mg_real *p = h->vertices[e->from_vertex].point, arm[2] = {x[0] - p[0], x[1] - p[1]};
  const mg_real along = mg_cross2(arm, e->normal) * -1, off = mg_dot2(arm, e->normal);
  if (along > 0 && along < e->length && fabs(off) < best->distance) {
    const mg_nearest_edge found = {fabs(off), 0, edge, -1, 0};
    *best = found;
  }
  const mg_real rounding = 4 * MG_EPS * h->size * ((fabs(arm[0]) + fabs(arm[1])) / e->length + 1);
  return e->length > MG_SHORT_SIDE * h->regions->coincidence && off > rounding;
}

/* True if x is outside the tangent at an end of a curved edge. */
static int mg_is_beyond_tangent(const mg_hull *h, const mg_hull_edge *e, int vertex, const mg_real *x) {
  const mg_hull_vertex *s = h->vertices + vertex;
  const mg_real arm[2] = {x[0] - s->point[0], x[1] - s->point[1]};
  return -e->direction * mg_cross2(s->tangent, arm) > 4 * MG_EPS * h->size * sqrt(mg_dot2(s->tangent, s->tangent));
}

/* Nearest point of the boundary of the hull to x. Returns whether x is outside. */
static int mg_find_nearest(const mg_hull *h, const mg_real *x, mg_nearest_edge *best) {
  const mg_real rounding = 4 * MG_EPS * h->size;
  int outside = h->n_edge < 2 || (h->n_edge == 2 && !h->edges[0].direction && !h->edges[1].direction);
  best->edge = 0;
  mg_try_vertices(h, x, best);
  for (int i = 0; i < h->n_edge; i++) {
    const mg_hull_edge *e = h->edges + i;
    const mg_real *p = h->vertices[e->from_vertex].point, arm[2] = {x[0] - p[0], x[1] - p[1]},
                  off = mg_dot2(arm, e->normal);
    const mg_real least = off > 0 ? off - e->height : -off;
    if (off < -rounding && least >= best->distance) continue;
    if (e->direction) {
      outside |= mg_is_beyond_tangent(h, e, e->from_vertex, x) || mg_is_beyond_tangent(h, e, e->to_vertex, x);
      if (least < best->distance) outside |= mg_try_curved_edge(h, i, x, best);
    } else outside |= mg_try_straight_edge(h, i, x, best);
  }
  return outside;
}

MG_INTERNAL void mg_read_support_point(const mg_hull *h, int vertex, mg_support_point *at) {
  int own = vertex;
  for (int i = h->vertices[vertex].twin; i != vertex && h->vertices[own].intersection < 0; i = h->vertices[i].twin)
    if (h->vertices[i].intersection >= 0) own = i;
  const mg_hull_vertex *s = h->vertices + own;
  const mg_intersection *crossing = s->intersection >= 0 ? h->intersections + s->intersection : 0;
  const int side = h->arcs[s->arc].side;
  at->side = side, at->arc = s->arc, at->t = s->t;
  at->crossing_arc = crossing ? crossing->arc[!side] : -1, at->crossing_t = crossing ? crossing->t[!side] : 0;
  at->point[0] = s->point[0], at->point[1] = s->point[1];
}

/* Outward unit normal of an edge; of a curved one perpendicular to the tangent T. */
static void mg_edge_normal(const mg_hull_edge *e, const mg_real *T, mg_real *normal) {
  const mg_real size = sqrt(mg_dot2(T, T));
  for (int k = 0; k < 2; k++) normal[k] = e->direction ? e->direction * (k ? -T[0] : T[1]) / size : e->normal[k];
}

/* True if a direction at a vertex lies clockwise (last edge) or counterclockwise (next edge) of the normal of that
   edge, which is then written. */
static int mg_is_past_edge_normal(const mg_hull *h, const mg_hull_edge *e, int vertex, int last, const mg_real *way,
                                  mg_real *normal) {
  if (!e->direction && !(e->length > MG_SHORT_SIDE * h->regions->coincidence)) return 0;
  mg_edge_normal(e, h->vertices[vertex].tangent, normal);
  return (last ? -1 : 1) * mg_cross2(normal, way) > 0;
}

/* Normal at a vertex: the direction between it and x, but within the normals of the two edges that meet there.
   Where these coincide, as where a closed curve begins, the normal is theirs. */
static void mg_vertex_normal(const mg_hull *h, const mg_nearest_edge *near, const mg_real *x,
                             mg_nearest_boundary *nearest) {
  const mg_hull_edge *next = h->edges + near->edge, *last = h->edges + (near->edge + h->n_edge - 1) % h->n_edge;
  const mg_real *p = nearest->at[0].point, sign = nearest->margin > 0 ? 1 : -1;
  const mg_real way[2] = {sign * (p[0] - x[0]) / near->distance, sign * (p[1] - x[1]) / near->distance};
  if (h->n_edge > 1 && (mg_is_past_edge_normal(h, last, last->to_vertex, 1, way, nearest->normal) ||
                        mg_is_past_edge_normal(h, next, next->from_vertex, 0, way, nearest->normal)))
    return;
  nearest->normal[0] = way[0], nearest->normal[1] = way[1];
}

/* Describes the nearest place: a straight edge by its two ends, else one point. */
static void mg_describe_nearest(const mg_hull *h, const mg_nearest_edge *near, const mg_real *x,
                                mg_nearest_boundary *nearest) {
  const mg_hull_edge *e = h->edges + near->edge;
  const mg_real *own = h->vertices[near->vertex >= 0 ? near->vertex : e->from_vertex].tangent;
  mg_real T[2] = {own[0], own[1]};
  nearest->n = 1;
  if (near->vertex >= 0) {
    mg_read_support_point(h, near->vertex, nearest->at);
  } else if (near->curve) {
    mg_support_point *at = nearest->at;
    mg_read_support_point(h, e->from_vertex, at);
    at->arc = h->vertices[e->from_vertex].arc, at->side = h->arcs[at->arc].side, at->t = near->t, at->crossing_arc = -1;
    mg_arc_point(h->arcs + at->arc, near->t, at->point, T);
  } else {
    nearest->n = 2;
    mg_read_support_point(h, e->from_vertex, nearest->at), mg_read_support_point(h, e->to_vertex, nearest->at + 1);
  }
  const int is_off = near->vertex >= 0 && near->distance > h->regions->coincidence;
  if (is_off) mg_vertex_normal(h, near, x, nearest);
  else mg_edge_normal(e, T, nearest->normal);
}

MG_INTERNAL mg_real mg_hull_margin(const mg_hull *h, const mg_real *x, mg_nearest_boundary *nearest) {
  mg_nearest_edge near = {MG_MAX, 0, 0, -1, 0};
  nearest->n = 0, nearest->margin = -MG_MAX;
  if (h->n_edge == 0) return nearest->margin;
  nearest->margin = mg_find_nearest(h, x, &near) ? -near.distance : near.distance;
  mg_describe_nearest(h, &near, x, nearest);
  return nearest->margin;
}
