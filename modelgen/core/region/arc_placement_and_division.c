/* Arcs placed in the plane and divided into spans that turn little. Writes arcs and spans of a hull. */
#include "region/region.h"
#include "base/base.h"

#define MG_SPAN_TURN 0.3 /* most turn of a span, rad */

#define MG_SPANS_MAX 512 /* most spans of an arc */

#define MG_INFLECTION_PARTS 8 /* parts of a span between which the sign of the curvature is compared */

/* Scales a tangent to unit length. */
static void mg_normalise2(mg_real *d) {
  const mg_real size = sqrt(mg_dot2(d, d));
  if (size > 0) d[0] /= size, d[1] /= size;
}

/* Turn of a span; large if its tangents point backwards. */
static void mg_set_span_turn(mg_arc_span *s) {
  mg_real chord[2] = {s->end[0] - s->begin[0], s->end[1] - s->begin[1]};
  mg_normalise2(chord);
  const int back = mg_dot2(chord, s->begin_tangent) < 0.5 || mg_dot2(chord, s->end_tangent) < 0.5;
  s->turn = back ? 4 : fabs(mg_cross2(chord, s->begin_tangent)) + fabs(mg_cross2(chord, s->end_tangent));
}

MG_INTERNAL void mg_make_span(const mg_hull *h, int arc, mg_real a, mg_real b, mg_arc_span *span) {
  span->arc = arc, span->t_begin = a, span->t_end = b;
  mg_arc_point(h->arcs + arc, a, span->begin, span->begin_tangent),
      mg_arc_point(h->arcs + arc, b, span->end, span->end_tangent);
  mg_normalise2(span->begin_tangent), mg_normalise2(span->end_tangent);
  mg_set_span_turn(span);
}

/* True if the arc is a straight line up to rounding. */
static int mg_is_straight(const mg_placed_arc *k) {
  static const mg_real parts[] = {0.23, 0.5, 0.81};
  mg_real P[2], Q[2], T[2], E[2];
  mg_arc_point(k, k->t0, P, T), mg_arc_point(k, k->t1, Q, E);
  mg_real chord[2] = {Q[0] - P[0], Q[1] - P[1]};
  const mg_real size = fabs(P[0]) + fabs(P[1]) + fabs(Q[0]) + fabs(Q[1]);
  mg_normalise2(chord), mg_normalise2(T), mg_normalise2(E);
  int straight = mg_dot2(chord, T) > 0.5 && mg_dot2(chord, E) > 0.5;
  for (int i = 0; i < 3 && straight; i++) {
    mg_real x[2], D[2];
    mg_arc_point(k, k->t0 + parts[i] * (k->t1 - k->t0), x, D);
    const mg_real arm[2] = {x[0] - P[0], x[1] - P[1]};
    mg_normalise2(D);
    straight = fabs(mg_cross2(chord, arm)) <= 4 * MG_EPS * size && fabs(mg_cross2(chord, D)) <= sqrt(MG_EPS);
  }
  return straight;
}

/* Ends a span at the first inflection in it. */
static void mg_end_at_inflection(const mg_hull *h, mg_arc_span *s) {
  const mg_placed_arc *k = h->arcs + s->arc;
  const mg_real part = (s->t_end - s->t_begin) / MG_INFLECTION_PARTS;
  mg_real before = mg_zero_function(k, MG_ZERO_CURVATURE, s->begin, s->t_begin);
  for (int i = 0; i < MG_INFLECTION_PARTS; i++) {
    const mg_real low = s->t_begin + i * part, high = low + part,
                  curvature = mg_zero_function(k, MG_ZERO_CURVATURE, s->begin, high);
    const int changed = (before > 0) != (curvature > 0);
    before = curvature;
    if (!changed) continue;
    const mg_real t = mg_zero_on_arc(k, MG_ZERO_CURVATURE, s->begin, low, high);
    if (!(t > s->t_begin + part / 64 && t < s->t_end - part / 64)) continue;
    mg_make_span(h, s->arc, s->t_begin, t, s);
    return;
  }
}

/* Divides an arc into at most `most` spans, as long as their turn permits. */
static void mg_divide_arc(mg_hull *h, int arc, int most) {
  mg_placed_arc *k = h->arcs + arc;
  const mg_real whole = k->t1 - k->t0;
  mg_real part = k->straight ? 1 : (mg_real)1 / 8, done = 0;
  k->span = h->n_span;
  while (done < 1) {
    const mg_real least = (1 - done) / (most - (h->n_span - k->span));
    if (part < least) part = least;
    const mg_real end = done + part > 1 - part / 2 ? 1 : done + part;
    mg_arc_span *s = h->spans + h->n_span;
    mg_make_span(h, arc, h->n_span > k->span ? s[-1].t_end : k->t0, end < 1 ? k->t0 + end * whole : k->t1, s);
    if (s->turn > MG_SPAN_TURN && part > (mg_real)1 / MG_SPANS_MAX && part / 2 > least) {
      part /= 2;
      continue;
    }
    if (!k->straight && k->kernels->shape_kinds[k->shape].may_inflect && 2 * least < part) mg_end_at_inflection(h, s);
    done = s->t_end < k->t1 ? (s->t_end - k->t0) / whole : 1, h->n_span++;
    if (s->turn < MG_SPAN_TURN / 3 && part < (mg_real)1 / 8) part *= 2;
    if (k->straight) s->turn = 0;
  }
  k->n_span = h->n_span - k->span;
}

/* Divides all arcs; curves share the capacity equally. */
static void mg_divide_all_arcs(mg_hull *h) {
  const int n = h->regions->n_arc;
  int straight = 0, curved = 0;
  for (int i = 0; i < n; i++) straight += h->arcs[i].straight, curved += !h->arcs[i].straight;
  h->n_span = 0;
  for (int i = 0; i < n; i++) {
    if (h->arcs[i].straight) mg_divide_arc(h, i, 1), straight--;
    else mg_divide_arc(h, i, (h->span_capacity - h->n_span - straight) / curved), curved--;
  }
}

/* Arc that follows arc i in its loop. */
static int mg_next_arc_of_loop(const mg_region_pair *r, int i) {
  const int loop = r->arc[i].loop;
  if (i + 1 < r->n_arc && i + 1 != r->n_o && r->arc[i + 1].loop == loop) return i + 1;
  while (i > 0 && i != r->n_o && r->arc[i - 1].loop == loop) i--;
  return i;
}

/* Places arc i: in the axes of its own face (pose 0), or in those of o's face. */
static void mg_place_arc(mg_hull *h, int i, const mg_real *pose) {
  const mg_real *place = h->regions->arc[i].place;
  mg_placed_arc *k = h->arcs + i;
  for (int row = 0; row < 2; row++) {
    const mg_real *g = pose ? pose + row : 0;
    k->at[row] = g ? g[0] + g[3] * place[0] + g[6] * place[1] + g[9] * place[2] : place[row];
    for (int j = 0; j < 3; j++) {
      const mg_real *column = place + 3 + 3 * j;
      k->axis[2 * j + row] = g ? g[3] * column[0] + g[6] * column[1] + g[9] * column[2] : column[row];
    }
  }
}

/* Makes the end of arc i equal to the beginning of the next. */
static void mg_close_loop(mg_hull *h, int i) {
  const mg_placed_arc *k = h->arcs + i;
  mg_arc_span *last = h->spans + k->span + k->n_span - 1;
  for (int j = 0; j < 2; j++) last->end[j] = h->spans[h->arcs[k->next].span].begin[j];
}

/* Largest coordinate sum of the points of an arc. */
static mg_real mg_arc_extent(const mg_hull *h, int i) {
  mg_real most = 0;
  for (int j = h->arcs[i].span; j < h->arcs[i].span + h->arcs[i].n_span; j++)
    most = mg_max(most, fabs(h->spans[j].begin[0]) + fabs(h->spans[j].begin[1]));
  return most;
}

/* True if a point of an arc is inside another part of its region. */
static int mg_is_inside_other_part(const mg_hull *h, int arc, const mg_real *x) {
  const mg_region_pair *r = h->regions;
  int own, first = h->arcs[arc].side ? r->n_o : 0, end = first;
  mg_find_part_of_arc(h, arc, &own, &end);
  for (const int last = h->arcs[arc].side ? r->n_arc : r->n_o; first < last; first = end) {
    mg_find_part_of_arc(h, first, &first, &end);
    if (first != own && mg_locate_in_part(h, first, end, x) == 1) return 1;
  }
  return 0;
}

/* True if the region that an arc bounds lies on its right; where two parts of it adjoin, its own part. */
static int mg_is_region_on_right(const mg_hull *h, int i) {
  const mg_placed_arc *k = h->arcs + i;
  int first, end;
  mg_real x[2], T[2];
  mg_find_part_of_arc(h, i, &first, &end);
  mg_arc_point(k, (k->t0 + k->t1) / 2, x, T);
  mg_normalise2(T);
  const mg_real step = 8 * MG_COINCIDENCE_FACTOR * h->regions->coincidence,
                right[2] = {x[0] + step * T[1], x[1] - step * T[0]};
  if (mg_is_inside_other_part(h, i, x)) return mg_locate_point(h, k->side, right) == 1;
  return mg_locate_in_part(h, first, end, right) == 1;
}

MG_INTERNAL void mg_divide_arcs(mg_hull *h) {
  const mg_region_pair *r = h->regions;
  for (int i = 0; i < r->n_arc; i++) {
    mg_placed_arc *k = h->arcs + i;
    k->kernels = r->kernels, k->shape = r->arc[i].shape, k->parameters = r->arc[i].parameters, k->t0 = r->arc[i].t0,
    k->t1 = r->arc[i].t1;
    k->side = i >= r->n_o, k->next = mg_next_arc_of_loop(r, i);
    mg_place_arc(h, i, 0);
    k->straight = mg_is_straight(k);
  }
  mg_divide_all_arcs(h);
  for (int i = 0; i < r->n_arc; i++) mg_close_loop(h, i);
  for (int i = 0; i < r->n_arc; i++) h->arcs[i].right = mg_is_region_on_right(h, i);
}

MG_INTERNAL void mg_place_arcs(mg_hull *h, const mg_real *pose) {
  const mg_region_pair *r = h->regions;
  h->mirrored = pose[3] * pose[7] - pose[4] * pose[6] < 0;
  for (int i = r->n_o; i < r->n_arc; i++) {
    const mg_placed_arc *k = h->arcs + i;
    mg_place_arc(h, i, pose);
    for (int j = k->span; j < k->span + k->n_span; j++) {
      mg_arc_span *s = h->spans + j;
      mg_make_span(h, i, s->t_begin, s->t_end, s);
      if (k->straight) s->turn = 0;
    }
  }
  h->size = 0;
  for (int i = 0; i < r->n_arc; i++) {
    mg_close_loop(h, i);
    h->size = mg_max(h->size, mg_arc_extent(h, i));
  }
}
