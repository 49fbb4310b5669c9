/* Points along the boundary of an overlap and along its hull, loop after loop. */
#include "region/region.h"
#include "base/base.h"

/* Adds a point; points beyond the capacity are counted only. */
static void mg_add_outline_point(mg_outline *out, const mg_real *p) {
  if (out->count < out->capacity) {
    out->point[2 * out->count] = p[0], out->point[2 * out->count + 1] = p[1];
    out->loop[out->count] = out->n_loop;
  }
  out->count++;
}

/* Points of an arc from t0 towards t1, n to a curve; the end belongs to what follows. */
static void mg_trace_curve(const mg_hull *h, int arc, mg_real t0, mg_real t1, int fine, mg_outline *out) {
  const mg_placed_arc *k = h->arcs + arc;
  const int n = k->straight ? 1 : fine;
  for (int i = 0; i < n; i++) {
    mg_real p[2], T[2];
    mg_arc_point(k, t0 + i * (t1 - t0) / n, p, T);
    mg_add_outline_point(out, p);
  }
}

/* Points of a piece, forwards or backwards. */
static void mg_trace_piece(const mg_hull *h, const mg_boundary_piece *piece, int back, int fine, mg_outline *out) {
  const mg_placed_arc *k = h->arcs + piece->arc;
  for (int i = 0; i < k->n_span; i++) {
    const mg_arc_span *s = h->spans + k->span + (back ? k->n_span - 1 - i : i);
    const mg_real a = mg_max(s->t_begin, piece->t[0]), b = mg_min(s->t_end, piece->t[1]);
    if (a < b) mg_trace_curve(h, piece->arc, back ? b : a, back ? a : b, fine, out);
  }
}

/* Piece not yet traced that begins or ends nearest to p, within `reach`, or -1; *back: it ends there. */
static int mg_next_piece(const mg_hull *h, const mg_real *p, mg_real reach, int *back) {
  int next = -1;
  for (int i = 0; i < h->n_piece; i++)
    for (int end = 0; end < 2 && !h->order[i]; end++) {
      mg_real q[2], T[2];
      mg_arc_point(h->arcs + h->pieces[i].arc, h->pieces[i].t[end], q, T);
      if (!(mg_distance2(p, q) <= reach)) continue;
      reach = mg_distance2(p, q), next = i, *back = end;
    }
  return next;
}

MG_INTERNAL void mg_outline_pieces(const mg_hull *h, int fine, mg_outline *out) {
  out->count = out->n_loop = 0;
  for (int i = 0; i < h->n_piece; i++) h->order[i] = h->pieces[i].is_thin;
  for (int first = 0; first < h->n_piece; first++) {
    if (h->order[first]) continue;
    mg_real p[2], T[2];
    for (int piece = first, back = 0; piece >= 0; piece = mg_next_piece(h, p, 64 * h->regions->coincidence, &back)) {
      h->order[piece] = 1;
      mg_trace_piece(h, h->pieces + piece, back, fine, out);
      mg_arc_point(h->arcs + h->pieces[piece].arc, h->pieces[piece].t[!back], p, T);
    }
    out->n_loop++;
  }
}

MG_INTERNAL void mg_outline_hull(const mg_hull *h, int fine, mg_outline *out) {
  out->count = out->n_loop = 0;
  for (int i = 0; i < h->n_edge; i++) {
    const mg_hull_edge *e = h->edges + i;
    const mg_hull_vertex *a = h->vertices + (e->direction < 0 ? e->to_vertex : e->from_vertex);
    if (e->direction > 0) mg_trace_curve(h, a->arc, a->t, a->t_end, fine, out);
    else if (e->direction < 0) mg_trace_curve(h, a->arc, a->t_end, a->t, fine, out);
    else mg_add_outline_point(out, h->vertices[e->from_vertex].point);
  }
  out->n_loop = h->n_edge > 0;
}
