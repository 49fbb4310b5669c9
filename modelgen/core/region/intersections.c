/* Intersections of the boundaries of two regions: crossings of arcs, and ends of arcs that lie on an arc of the
   other region. Pairs of spans are subdivided until they are apart, cross once, or coincide. Writes the
   intersections. */
#include "region/region.h"
#include "base/base.h"

#define MG_PENDING_SPAN_PAIRS 128 /* most pairs of spans on the stack */

#define MG_NEARLY_PARALLEL 0.3 /* rad: spans whose directions differ by less are nearly parallel */

/* Pairs of spans that are still to be intersected. */
typedef struct {
  int count;                                  /* pairs */
  mg_arc_span pair[MG_PENDING_SPAN_PAIRS][2]; /* the pairs */
} mg_span_pair_stack;

/* Curve parameter t, or that of an end of the arc that coincides with the point. */
static mg_real mg_snap_to_arc_end(const mg_hull *h, int arc, const mg_real *point, mg_real t) {
  const mg_placed_arc *k = h->arcs + arc;
  const mg_arc_span *first = h->spans + k->span, *last = first + k->n_span - 1;
  const mg_real near = MG_COINCIDENCE_FACTOR * h->regions->coincidence, middle = (k->t0 + k->t1) / 2;
  if (t <= middle && mg_distance2(first->begin, point) <= near) return k->t0;
  if (t >= middle && mg_distance2(last->end, point) <= near) return k->t1;
  return t;
}

/* Adds an intersection unless it is known. */
static void mg_add_intersection(mg_hull *h, const int *arc, const mg_real *t, const mg_real *point) {
  mg_intersection crossing;
  for (int side = 0; side < 2; side++) {
    crossing.arc[side] = arc[side], crossing.point[side] = point[side];
    crossing.t[side] = mg_snap_to_arc_end(h, arc[side], point, t[side]);
  }
  for (int i = 0; i < h->n_intersection; i++) {
    const mg_intersection *other = h->intersections + i;
    const int same = other->arc[0] == arc[0] && other->arc[1] == arc[1];
    if (same && mg_distance2(other->point, point) <= 4 * h->regions->coincidence) return;
  }
  if (h->n_intersection == h->intersection_capacity) h->overflow = 1;
  else h->intersections[h->n_intersection++] = crossing;
}

/* Intersects an end of an arc with the spans of an arc of the other region. */
static void mg_intersect_arc_end(mg_hull *h, int ending, int last, int other) {
  const mg_placed_arc *e = h->arcs + ending, *k = h->arcs + other;
  const mg_arc_span *s = h->spans + e->span + (last ? e->n_span - 1 : 0);
  const mg_real *p = last ? s->end : s->begin, shared = MG_COINCIDENCE_FACTOR * h->regions->coincidence;
  for (int i = k->span; i < k->span + k->n_span; i++) {
    const mg_arc_span *span = h->spans + i;
    const mg_real chord[2] = {span->end[0] - span->begin[0], span->end[1] - span->begin[1]};
    const mg_real arm[2] = {p[0] - span->begin[0], p[1] - span->begin[1]}, length = sqrt(mg_dot2(chord, chord));
    const mg_real along = mg_dot2(arm, chord) / length, off = fabs(mg_cross2(chord, arm)) / length;
    if (along < -span->turn * length - shared || along > (1 + span->turn) * length + shared) continue;
    if (off > span->turn * length + shared) continue;
    const mg_real part = mg_min(mg_max(along / length, 0), 1);
    mg_real t[2], point[2], T[2];
    t[k->side] = k->straight ? span->t_begin + part * (span->t_end - span->t_begin)
                             : mg_zero_on_arc(k, MG_ZERO_NEAREST, p, span->t_begin, span->t_end);
    t[e->side] = last ? e->t1 : e->t0;
    mg_arc_point(k, t[k->side], point, T);
    if (mg_distance2(point, p) > shared) continue;
    const int arc[2] = {k->side ? ending : other, k->side ? other : ending};
    mg_add_intersection(h, arc, t, p);
  }
}

/* False if the curves of two spans are apart, by bounding boxes. */
static int mg_may_spans_meet(const mg_arc_span *x, const mg_arc_span *y, mg_real shared) {
  const mg_real slack =
      shared + (mg_distance2(x->begin, x->end) * x->turn + mg_distance2(y->begin, y->end) * y->turn) / 2;
  for (int k = 0; k < 2; k++) {
    if (mg_min(x->begin[k], x->end[k]) > mg_max(y->begin[k], y->end[k]) + slack) return 0;
    if (mg_min(y->begin[k], y->end[k]) > mg_max(x->begin[k], x->end[k]) + slack) return 0;
  }
  const mg_real d[2] = {x->end[0] - x->begin[0], x->end[1] - x->begin[1]}, length = sqrt(mg_dot2(d, d));
  const mg_real p[2] = {y->begin[0] - x->begin[0], y->begin[1] - x->begin[1]},
                q[2] = {y->end[0] - x->begin[0], y->end[1] - x->begin[1]};
  const mg_real a = mg_cross2(d, p), b = mg_cross2(d, q);
  return mg_min(a, b) <= slack * length && mg_max(a, b) >= -slack * length;
}

/* Intersection of two spans that are not parallel anywhere, and cross at most once, by Newton's method. */
static void mg_newton_intersection(mg_hull *h, const mg_arc_span *x, const mg_arc_span *y, const mg_real *start) {
  const mg_arc_span *s[2] = {x, y};
  const int arc[2] = {x->arc, y->arc};
  mg_real t[2] = {start[0], start[1]}, c[2][2], T[2][2], apart[2] = {0, 0}, last = MG_MAX;
  for (int i = 0; i < 50; i++) {
    for (int k = 0; k < 2; k++) mg_arc_point(h->arcs + arc[k], t[k], c[k], T[k]);
    for (int k = 0; k < 2; k++) apart[k] = c[1][k] - c[0][k];
    const mg_real det = mg_cross2(T[0], T[1]), size = mg_dot2(apart, apart);
    if (det == 0 || (size >= last && size <= h->regions->coincidence * h->regions->coincidence)) break;
    last = size;
    int still = 0;
    const mg_real step[2] = {mg_cross2(apart, T[1]) / det, mg_cross2(apart, T[0]) / det};
    for (int k = 0; k < 2; k++) {
      const mg_real half = (s[k]->t_end - s[k]->t_begin) / 2, low = mg_max(s[k]->t_begin - half, h->arcs[arc[k]].t0);
      const mg_real moved = mg_min(mg_max(t[k] + step[k], low), mg_min(s[k]->t_end + half, h->arcs[arc[k]].t1));
      still += moved == t[k], t[k] = moved;
    }
    if (still == 2) break;
  }
  for (int k = 0; k < 2; k++) {
    const mg_real slack = 4 * h->regions->coincidence / sqrt(mg_dot2(T[k], T[k]));
    if (t[k] < s[k]->t_begin - slack || t[k] > s[k]->t_end + slack) return;
  }
  const mg_real middle[2] = {(c[0][0] + c[1][0]) / 2, (c[0][1] + c[1][1]) / 2};
  if (mg_dot2(apart, apart) <= h->regions->coincidence * h->regions->coincidence)
    mg_add_intersection(h, arc, t, middle);
}

/* Distances of x from y at five points along which both run, with the curve parameters s, t there; returns 0 if
   they do not run alongside. */
static int mg_sample_gaps(const mg_hull *h, const mg_arc_span *x, const mg_arc_span *y, mg_real *s, mg_real *t,
                          mg_real *gap) {
  const mg_placed_arc *k = h->arcs + x->arc, *other = h->arcs + y->arc;
  const mg_real ends[2] = {mg_zero_on_arc(k, MG_ZERO_NEAREST, y->begin, x->t_begin, x->t_end),
                           mg_zero_on_arc(k, MG_ZERO_NEAREST, y->end, x->t_begin, x->t_end)};
  if (fabs(ends[1] - ends[0]) <= 64 * MG_EPS * (fabs(x->t_begin) + fabs(x->t_end))) return 0;
  for (int i = 0; i < 5; i++) {
    mg_real p[2], q[2], T[2];
    s[i] = ends[0] + i * (ends[1] - ends[0]) / 4;
    mg_arc_point(k, s[i], p, T);
    t[i] = mg_zero_on_arc(other, MG_ZERO_NEAREST, p, y->t_begin, y->t_end);
    mg_arc_point(other, t[i], q, T);
    const mg_real arm[2] = {p[0] - q[0], p[1] - q[1]};
    gap[i] = mg_cross2(T, arm) / sqrt(mg_dot2(T, T));
  }
  return 1;
}

/* Adds the end of a span as an intersection if the gap vanishes there. */
static void mg_add_closed_gap(mg_hull *h, const mg_arc_span *x, const mg_arc_span *y, mg_real s, mg_real t,
                              mg_real gap) {
  const int arc[2] = {x->arc, y->arc};
  const mg_real at[2] = {s, t};
  mg_real point[2], T[2];
  if (fabs(gap) > h->regions->coincidence) return;
  mg_arc_point(h->arcs + x->arc, s, point, T);
  mg_add_intersection(h, arc, at, point);
}

/* Intersects spans that run side by side. Returns 1 if the gap, nearly linear, shows that they are apart,
   coincide, or cross once; 0: they must be subdivided. */
static int mg_intersect_nearly_parallel(mg_hull *h, const mg_arc_span *x, const mg_arc_span *y) {
  mg_real s[5], t[5], gap[5], second_difference = 0, least = MG_MAX, most = 0, step = MG_MAX;
  if (!mg_sample_gaps(h, x, y, s, t, gap)) return 1;
  int change = -1, changes = 0;
  for (int i = 0; i < 5; i++) {
    least = mg_min(least, fabs(gap[i])), most = mg_max(most, fabs(gap[i]));
    if (i > 1) second_difference = mg_max(second_difference, fabs(gap[i] - 2 * gap[i - 1] + gap[i - 2]));
    if (i > 0) step = mg_min(step, fabs(gap[i] - gap[i - 1]));
    if (i > 0 && (gap[i] > 0) != (gap[i - 1] > 0)) change = i, changes++;
  }
  if (most <= h->regions->coincidence) return 1;
  mg_add_closed_gap(h, x, y, s[0], t[0], gap[0]), mg_add_closed_gap(h, x, y, s[4], t[4], gap[4]);
  if (!changes && least > second_difference) return 1;
  if (changes != 1 || step <= second_difference) return 0;
  const mg_real part = gap[change - 1] / (gap[change - 1] - gap[change]),
                start[2] = {s[change - 1] + part * (s[change] - s[change - 1]),
                            t[change - 1] + part * (t[change] - t[change - 1])};
  mg_newton_intersection(h, x, y, start);
  return 1;
}

/* Pushes a pair of spans. */
static void mg_push_spans(mg_span_pair_stack *stack, const mg_arc_span *x, const mg_arc_span *y) {
  stack->pair[stack->count][0] = *x, stack->pair[stack->count++][1] = *y;
}

/* Splits the longer of two spans and pushes both pairs. */
static void mg_split_longer_span(const mg_hull *h, mg_span_pair_stack *stack, const mg_arc_span *x,
                                 const mg_arc_span *y) {
  const int second = mg_distance2(y->begin, y->end) > mg_distance2(x->begin, x->end);
  const mg_arc_span *whole = second ? y : x;
  const mg_real middle = (whole->t_begin + whole->t_end) / 2, ends[3] = {whole->t_begin, middle, whole->t_end};
  for (int i = 0; i < 2; i++) {
    mg_arc_span half;
    mg_make_span(h, whole->arc, ends[i], ends[i + 1], &half);
    if (h->arcs[whole->arc].straight) half.turn = 0;
    mg_push_spans(stack, second ? x : &half, second ? &half : y);
  }
}

/* Finds all intersections of two spans. */
static void mg_intersect_spans(mg_hull *h, const mg_arc_span *first, const mg_arc_span *second) {
  mg_span_pair_stack stack;
  stack.count = 0;
  mg_push_spans(&stack, first, second);
  while (stack.count) {
    const mg_arc_span x = stack.pair[--stack.count][0], y = stack.pair[stack.count][1];
    const mg_real u[2] = {x.end[0] - x.begin[0], x.end[1] - x.begin[1]},
                  v[2] = {y.end[0] - y.begin[0], y.end[1] - y.begin[1]};
    const mg_real along = sqrt(mg_dot2(u, u)), across = sqrt(mg_dot2(v, v)), shared = h->regions->coincidence;
    if ((along <= shared && across <= shared) || !mg_may_spans_meet(&x, &y, shared)) continue;
    const mg_real sine = fabs(mg_cross2(u, v)) / (along * across);
    const mg_real middle[2] = {(x.t_begin + x.t_end) / 2, (y.t_begin + y.t_end) / 2};
    if (sine > 2 * (x.turn + y.turn)) mg_newton_intersection(h, &x, &y, middle);
    else if (sine + x.turn + y.turn < MG_NEARLY_PARALLEL && mg_intersect_nearly_parallel(h, &x, &y)) continue;
    else if (stack.count + 2 <= MG_PENDING_SPAN_PAIRS) mg_split_longer_span(h, &stack, &x, &y);
    else h->overflow = 1;
  }
}

/* Intersection of two straight spans. */
static void mg_intersect_lines(mg_hull *h, const mg_arc_span *x, const mg_arc_span *y) {
  const mg_real u[2] = {x->end[0] - x->begin[0], x->end[1] - x->begin[1]},
                v[2] = {y->end[0] - y->begin[0], y->end[1] - y->begin[1]};
  const mg_real w[2] = {y->begin[0] - x->begin[0], y->begin[1] - x->begin[1]}, det = mg_cross2(u, v);
  if (det == 0) return;
  const mg_real p = mg_cross2(w, v) / det, q = mg_cross2(w, u) / det;
  if (!(p >= 0 && p <= 1 && q >= 0 && q <= 1)) return;
  const int arc[2] = {x->arc, y->arc};
  const mg_real t[2] = {x->t_begin + p * (x->t_end - x->t_begin), y->t_begin + q * (y->t_end - y->t_begin)};
  const mg_real point[2] = {x->begin[0] + p * u[0], x->begin[1] + p * u[1]};
  mg_add_intersection(h, arc, t, point);
}

MG_INTERNAL void mg_find_intersections(mg_hull *h) {
  const int n = h->regions->n_arc, n_o = h->regions->n_o;
  h->n_intersection = 0, h->overflow = 0;
  for (int i = 0; i < n_o; i++)
    for (int j = n_o; j < n; j++) {
      const mg_placed_arc *o = h->arcs + i, *f = h->arcs + j;
      for (int last = 0; last < 2; last++) mg_intersect_arc_end(h, i, last, j), mg_intersect_arc_end(h, j, last, i);
      for (int a = o->span; a < o->span + o->n_span; a++)
        for (int b = f->span; b < f->span + f->n_span; b++) {
          if (!mg_may_spans_meet(h->spans + a, h->spans + b, h->regions->coincidence)) continue;
          if (o->straight && f->straight) mg_intersect_lines(h, h->spans + a, h->spans + b);
          else mg_intersect_spans(h, h->spans + a, h->spans + b);
        }
    }
}
