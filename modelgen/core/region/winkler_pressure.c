/* Winkler pressure between two faces from its resultant and its centre (region/region.h): Newton's method for the
   coefficients of p = max(0, a + b.x), which are the minimum of a convex function whose Hessian are the moments of
   the loaded region. Writes the pressure field. */
#include "region/region.h"
#include "base/base.h"

#define MG_PRESSURE_STEPS 60 /* most steps of Newton's method and of the continuation */

#define MG_INWARD_PASSES 4 /* most edges and corners from which a point is moved inwards in turn */

#define MG_NEWTON_PART_MIN 1e-6 /* least part of a Newton step */

#define MG_CONTINUATION_PART_MIN 1e-3 /* least part of the rest of the way that the continuation takes in one step */

MG_INTERNAL void mg_open_pressure(mg_winkler_pressure_field *p, const mg_hull *h, long capacity,
                                  mg_boundary_strip *strips) {
  p->hull = h, p->capacity = capacity, p->strips = strips, p->n = p->partly_unloaded = p->overflow = 0;
}

/* a + b.(x - centre). */
static mg_real mg_pressure_at(const mg_winkler_pressure_field *p, const mg_real *x) {
  return p->coefficients[0] + p->coefficients[1] * (x[0] - p->centre[0]) + p->coefficients[2] * (x[1] - p->centre[1]);
}

/* Adds a strip, or its reverse. */
static void mg_add_strip(mg_winkler_pressure_field *p, const mg_boundary_strip *strip, int back) {
  p->overflow |= p->n == p->capacity;
  if (p->n == p->capacity) return;
  mg_boundary_strip *s = p->strips + p->n++;
  *s = *strip;
  if (!back) return;
  for (int k = 0; k < 2; k++)
    s->t[k] = strip->t[!k], s->ends[k] = strip->ends[!k], s->begin[k] = strip->end[k], s->end[k] = strip->begin[k];
}

/* Adds the loaded part of a straight piece. */
static void mg_clip_straight(mg_winkler_pressure_field *p, mg_boundary_strip s, int back) {
  const mg_real a = mg_pressure_at(p, s.begin), b = mg_pressure_at(p, s.end);
  if (a <= 0 && b <= 0) {
    p->partly_unloaded = 1;
    return;
  }
  for (int end = 0; end < 2; end++) {
    if ((end ? b : a) >= 0) continue;
    const mg_real part = a / (a - b);
    mg_real *x = end ? s.end : s.begin;
    const mg_real at[2] = {s.begin[0] + part * (s.end[0] - s.begin[0]), s.begin[1] + part * (s.end[1] - s.begin[1])};
    x[0] = at[0], x[1] = at[1], s.ends[end] = p->partly_unloaded = 1;
  }
  mg_add_strip(p, &s, back);
}

/* Parameter of a curve between t0 and t1, where the pressure has opposite signs, at which it vanishes. */
static mg_real mg_find_zero_pressure(const mg_winkler_pressure_field *p, const mg_placed_arc *k, mg_real t0,
                                     mg_real t1) {
  mg_real x[2], T[2], low = t0, high = t1;
  mg_arc_point(k, t0, x, T);
  const int sign = mg_pressure_at(p, x) > 0;
  mg_real t = (t0 + t1) / 2;
  for (int i = 0; i < 100; i++) {
    mg_arc_point(k, t, x, T);
    const mg_real value = mg_pressure_at(p, x), slope = p->coefficients[1] * T[0] + p->coefficients[2] * T[1];
    if ((value > 0) == sign) low = t;
    else high = t;
    const mg_real step = slope != 0 ? -value / slope : 0, next = t + step;
    const int within = (next - low) * (next - high) < 0;
    if (within && fabs(step) <= 2 * MG_EPS * fabs(t)) return next;
    if (fabs(high - low) <= 2 * MG_EPS * (fabs(low) + fabs(high))) return t;
    t = within ? next : (low + high) / 2;
  }
  return t;
}

/* Adds the strip of a curve from t0 to t1. */
static void mg_add_curved_strip(mg_winkler_pressure_field *p, int arc, mg_real t0, mg_real t1, const int *ends,
                                int back) {
  mg_boundary_strip s = {arc, 0, {ends[0], ends[1]}, {t0, t1}, {0, 0}, {0, 0}};
  mg_real T[2];
  mg_arc_point(p->hull->arcs + arc, t0, s.begin, T), mg_arc_point(p->hull->arcs + arc, t1, s.end, T);
  mg_add_strip(p, &s, back);
}

/* Adds the loaded parts of a curved piece, two at most because it turns little. */
static void mg_clip_curve(mg_winkler_pressure_field *p, int arc, mg_real t0, mg_real t1, int back) {
  const mg_placed_arc *k = p->hull->arcs + arc;
  const mg_real along[2] = {p->coefficients[1], p->coefficients[2]};
  mg_real t[3] = {t0, t0, t1}, value[3], slope[3], T[2], x[2];
  for (int i = 0; i < 3; i += 2)
    mg_arc_point(k, t[i], x, T), value[i] = mg_pressure_at(p, x), slope[i] = mg_dot2(along, T);
  t[1] = slope[0] * slope[2] < 0 ? mg_zero_on_arc(k, MG_ZERO_SUPPORT, along, t0, t1) : t0;
  mg_arc_point(k, t[1], x, T), value[1] = mg_pressure_at(p, x);
  for (int half = t[1] == t0; half < 2; half++) {
    const int in = value[half] > 0, out = value[half + 1] > 0;
    if (!in || !out) p->partly_unloaded = 1;
    if (!in && !out) continue;
    const mg_real at = in == out ? 0 : mg_find_zero_pressure(p, k, t[half], t[half + 1]);
    const int ends[2] = {!in, !out};
    mg_add_curved_strip(p, arc, in ? t[half] : at, out ? t[half + 1] : at, ends, back);
  }
}

/* Strips of the boundary of the loaded region for the present coefficients. */
static void mg_find_loaded_boundary(mg_winkler_pressure_field *p) {
  const mg_hull *h = p->hull;
  p->n = p->partly_unloaded = 0;
  for (int i = 0; i < h->n_piece; i++) {
    const mg_boundary_piece *piece = h->pieces + i;
    const mg_placed_arc *k = h->arcs + piece->arc;
    const int back = k->right != (k->side && h->mirrored);
    if (piece->is_thin) continue;
    for (int j = k->span; j < k->span + k->n_span; j++) {
      const mg_arc_span *s = h->spans + j;
      const mg_real a = mg_max(s->t_begin, piece->t[0]), b = mg_min(s->t_end, piece->t[1]);
      if (!(a < b)) continue;
      if (!k->straight) {
        mg_clip_curve(p, piece->arc, a, b, back);
        continue;
      }
      mg_boundary_strip strip = {piece->arc, 1, {0, 0}, {a, b}, {0, 0}, {0, 0}};
      mg_real T[2];
      if (a == s->t_begin) strip.begin[0] = s->begin[0], strip.begin[1] = s->begin[1];
      else mg_arc_point(k, a, strip.begin, T);
      if (b == s->t_end) strip.end[0] = s->end[0], strip.end[1] = s->end[1];
      else mg_arc_point(k, b, strip.end, T);
      mg_clip_straight(p, strip, back);
    }
  }
}

/* Adds the moments of the triangle between the reference point and an element of the boundary at x, with weight x
   x dx. */
static void mg_add_moments(mg_winkler_pressure_field *p, mg_real weight, const mg_real *x) {
  const mg_real d[2] = {x[0] - p->zero_line_point[0], x[1] - p->zero_line_point[1]};
  mg_real *m = p->moments;
  m[0] += weight / 2, m[1] += weight * d[0] / 3, m[2] += weight * d[1] / 3;
  m[3] += weight * d[0] * d[0] / 4, m[4] += weight * d[0] * d[1] / 4, m[5] += weight * d[1] * d[1] / 4;
  p->reach = mg_max(p->reach, mg_distance2(x, p->centre));
}

/* Moments of the loaded region about a point of the line where the pressure vanishes, so that this line does not
   contribute, shifted to the centre. */
static void mg_compute_moments(mg_winkler_pressure_field *p) {
  const mg_real *o = p->zero_line_point,
                shift[2] = {p->zero_line_point[0] - p->centre[0], p->zero_line_point[1] - p->centre[1]};
  mg_real *m = p->moments;
  for (int k = 0; k < 6; k++) m[k] = 0;
  p->reach = 0;
  for (long i = 0; i < p->n; i++) {
    const mg_boundary_strip *s = p->strips + i;
    if (s->straight) {
      const mg_real P[2] = {s->begin[0] - o[0], s->begin[1] - o[1]}, Q[2] = {s->end[0] - o[0], s->end[1] - o[1]};
      const mg_real middle[2] = {(s->begin[0] + s->end[0]) / 2, (s->begin[1] + s->end[1]) / 2}, whole = mg_cross2(P, Q);
      mg_add_moments(p, whole / 6, s->begin), mg_add_moments(p, 4 * whole / 6, middle),
          mg_add_moments(p, whole / 6, s->end);
      continue;
    }
    for (int j = 0; j < MG_NODES; j++) {
      mg_real x[2], T[2];
      mg_arc_point(p->hull->arcs + s->arc, s->t[0] + mg_node[j] * (s->t[1] - s->t[0]), x, T);
      const mg_real d[2] = {x[0] - o[0], x[1] - o[1]};
      mg_add_moments(p, mg_node_weight[j] * (s->t[1] - s->t[0]) * mg_cross2(d, T), x);
    }
  }
  m[3] += shift[0] * (2 * m[1] + shift[0] * m[0]), m[5] += shift[1] * (2 * m[2] + shift[1] * m[0]);
  m[4] += shift[0] * m[2] + shift[1] * m[1] + shift[0] * shift[1] * m[0];
  m[1] += shift[0] * m[0], m[2] += shift[1] * m[0];
}

MG_INTERNAL int mg_solve_moments(const mg_winkler_pressure_field *p, const mg_real *moment, mg_real *coefficients) {
  const mg_real *m = p->moments, r = p->reach;
  const mg_real x = m[1] / m[0], y = m[2] / m[0], xx = m[3] - x * m[1], xy = m[4] - x * m[2], yy = m[5] - y * m[2];
  const mg_real free = yy - xy * xy / xx, bx = moment[1] - x * moment[0], by = moment[2] - y * moment[0];
  if (!(m[0] > 0) || !(xx > 0) || !(free > 0) || !(r > 0)) return 0;
  coefficients[2] = (by - xy / xx * bx) / free, coefficients[1] = (bx - xy * coefficients[2]) / xx;
  coefficients[0] = moment[0] / m[0] - x * coefficients[1] - y * coefficients[2];
  return 1;
}

MG_INTERNAL void mg_uniform_pressure(mg_winkler_pressure_field *p, const mg_real *about) {
  for (int k = 0; k < 2; k++) p->centre[k] = p->zero_line_point[k] = about[k];
  p->coefficients[0] = 1, p->coefficients[1] = p->coefficients[2] = 0;
  mg_find_loaded_boundary(p);
  mg_compute_moments(p);
}

/* Sets the coefficients, loaded region and moments. */
static void mg_set_coefficients(mg_winkler_pressure_field *p, const mg_real *coefficients) {
  for (int k = 0; k < 3; k++) p->coefficients[k] = coefficients[k];
  mg_find_loaded_boundary(p);
  const mg_real slope = coefficients[1] * coefficients[1] + coefficients[2] * coefficients[2];
  for (int k = 0; k < 2; k++)
    p->zero_line_point[k] = p->centre[k] - (p->partly_unloaded ? coefficients[0] * coefficients[1 + k] / slope : 0);
  mg_compute_moments(p);
}

/* Half the integral of p^2 less force times the coefficient a: the convex function that the coefficients minimise. */
static mg_real mg_pressure_merit(const mg_winkler_pressure_field *p, mg_real force) {
  const mg_real *m = p->moments, *l = p->coefficients;
  return (m[0] * l[0] * l[0] + m[3] * l[1] * l[1] + m[5] * l[2] * l[2]) / 2 + m[1] * l[0] * l[1] + m[2] * l[0] * l[2] +
         m[4] * l[1] * l[2] - force * l[0];
}

/* Mean of the vertices of a hull; returns their largest distance from it. */
static mg_real mg_hull_middle(const mg_hull *h, mg_real *middle) {
  mg_real reach = 0;
  middle[0] = middle[1] = 0;
  for (int i = 0; i < h->n_edge; i++)
    for (int k = 0; k < 2; k++) middle[k] += h->vertices[h->edges[i].from_vertex].point[k] / h->n_edge;
  for (int i = 0; i < h->n_edge; i++)
    reach = mg_max(reach, mg_distance2(h->vertices[h->edges[i].from_vertex].point, middle));
  return reach;
}

/* Part of the length of the loaded region that its depth is at least. Friction about a centre of rotation is a
   difference of integrals over triangles that are longer than the region is deep by its inverse, so that its rounding
   error is eps over the square of this: the accuracy to which pressure and friction are made to agree. */
static mg_real mg_least_depth(void) { return sqrt(sqrt(MG_EPS)); }

/* Least distance of the centre of pressure from a curved edge, whose radius is about the reach: the loaded region there
   is as long as the root of reach times depth, and friction amplifies errors as the loaded point comes to rest. */
static mg_real mg_least_curved_distance(mg_real reach) { return 16 * mg_least_depth() * mg_least_depth() * reach; }

/* How far a point is beyond a number of least distances inside the boundary of a hull, m, at the place where it is the
   most; and the outward unit normal there, with n = 2 of a straight edge and 1 of another place. Behind a straight edge
   the loaded region is as long as the edge. */
static mg_real mg_boundary_shortfall(const mg_hull *h, mg_real reach, const mg_real *x, int distances,
                                     mg_nearest_boundary *nearest) {
  mg_real shortfall = distances * mg_least_curved_distance(reach) - mg_hull_margin(h, x, nearest);
  for (int i = 0; i < h->n_edge; i++) {
    const mg_hull_edge *e = h->edges + i;
    const mg_real *p = h->vertices[e->from_vertex].point, arm[2] = {x[0] - p[0], x[1] - p[1]};
    const mg_real off = mg_dot2(arm, e->normal) + distances * mg_least_depth() * e->length;
    if (e->direction || !(off > shortfall)) continue;
    shortfall = off, nearest->n = 2;
    for (int k = 0; k < 2; k++) nearest->normal[k] = e->normal[k];
  }
  return shortfall;
}

/* Moves a point that is not a number of least distances inside a hull there. Returns where the point was. */
static int mg_move_inward(const mg_hull *h, mg_real reach, int distances, mg_real *x) {
  mg_nearest_boundary nearest;
  mg_real shortfall = mg_boundary_shortfall(h, reach, x, distances, &nearest);
  if (!(shortfall > 0)) return MG_INSIDE_HULL;
  int place = MG_AT_STRAIGHT_EDGES;
  for (int pass = 0; pass < MG_INWARD_PASSES && shortfall > 64 * MG_EPS * reach; pass++) {
    if (nearest.n == 1) place = MG_AT_CURVE;
    for (int k = 0; k < 2; k++) x[k] -= shortfall * nearest.normal[k];
    shortfall = mg_boundary_shortfall(h, reach, x, distances, &nearest);
  }
  return place;
}

MG_INTERNAL int mg_move_inside_hull(const mg_hull *h, mg_real *x) {
  mg_nearest_boundary nearest;
  mg_real middle[2];
  const mg_real reach = mg_hull_middle(h, middle);
  const int place = h->n_edge > 0 ? mg_move_inward(h, reach, 1, x) : MG_INSIDE_HULL;
  if (place != MG_INSIDE_HULL && mg_hull_margin(h, x, &nearest) < mg_least_curved_distance(reach) / 2)
    for (int k = 0; k < 2; k++) x[k] = nearest.at[0].point[k] + mg_least_depth() * (middle[k] - nearest.at[0].point[k]);
  return place;
}

MG_INTERNAL int mg_move_near_hull(const mg_hull *h, mg_real *x) {
  mg_real middle[2];
  const mg_real reach = mg_hull_middle(h, middle);
  return h->n_edge > 0 && mg_move_inward(h, reach, -1, x) != MG_INSIDE_HULL;
}

/* Pressure with a resultant and a centre from one near it, by Newton's method. Returns 0 if it fails. */
static int mg_newton_pressure(mg_winkler_pressure_field *p, mg_real force, const mg_real *centre,
                              const mg_real *start) {
  const mg_real moment[3] = {force, 0, 0};
  mg_real coefficients[3], from[3] = {0, 0, 0}, merit = MG_MAX, part = 1, last = MG_MAX;
  int near = 0;
  for (int k = 0; k < 2; k++) p->centre[k] = centre[k];
  for (int k = 0; k < 3; k++) coefficients[k] = start[k];
  for (int step = 0; step < MG_PRESSURE_STEPS; step++) {
    mg_real tried[3], change = 0;
    for (int k = 0; k < 3; k++) tried[k] = from[k] + part * (coefficients[k] - from[k]);
    mg_set_coefficients(p, tried);
    const mg_real now = p->coefficients[0] > 0 ? mg_pressure_merit(p, force) : MG_MAX;
    if (!near && !(now < merit + fabs(merit) * 8 * MG_EPS) && part > MG_NEWTON_PART_MIN) {
      part /= 2;
      continue;
    }
    if (!mg_solve_moments(p, moment, coefficients)) return 0;
    const mg_real r[3] = {1, p->reach, p->reach};
    for (int k = 0; k < 3; k++) from[k] = tried[k], change = mg_max(change, fabs(coefficients[k] - tried[k]) * r[k]);
    const mg_real noise = 65536 * MG_EPS * p->hull->size / p->reach; /* of a part so small */
    const int stalls = near && change > last / 4;                    /* Newton's method does so at rounding alone */
    if (!p->partly_unloaded || stalls || change <= mg_max(sqrt(MG_EPS), noise) * coefficients[0]) {
      for (int k = 0; k < 3; k++) p->coefficients[k] = coefficients[k];
      return 1;
    }
    merit = now, part = 1, last = change,
    near = change <= coefficients[0] / 16; /* there the merit is dominated by rounding */
  }
  return 0;
}

/* The same by continuation from the middle of the overlap, whose pressure is uniform, along a straight line to the
   centre. */
static int mg_continue_pressure(mg_winkler_pressure_field *p, mg_real force, const mg_real *centre) {
  mg_uniform_pressure(p, centre);
  const mg_real area = p->moments[0];
  const mg_real way[2] = {-p->moments[1] / area, -p->moments[2] / area};
  mg_real coefficients[3] = {force / area, 0, 0}, left = 1, part = (mg_real)0.5;
  for (int step = 0; step < MG_PRESSURE_STEPS; step++) {
    const mg_real next = left * (1 - part);
    mg_real at[2], start[3] = {coefficients[0], coefficients[1], coefficients[2]};
    for (int k = 0; k < 2; k++)
      at[k] = centre[k] - next * way[k], start[0] += coefficients[1 + k] * (left - next) * way[k];
    if (!mg_newton_pressure(p, force, at, start)) {
      if ((part /= 2) < MG_CONTINUATION_PART_MIN) return 0;
      continue;
    }
    if (next == 0) return 1;
    for (int k = 0; k < 3; k++) coefficients[k] = p->coefficients[k];
    left = next, part = 1;
  }
  return 0;
}

MG_INTERNAL int mg_winkler_pressure(mg_winkler_pressure_field *p, mg_real force, const mg_real *centre) {
  const mg_real moment[3] = {force, 0, 0};
  mg_real coefficients[3];
  mg_uniform_pressure(p, centre);
  if (!mg_solve_moments(p, moment, coefficients)) return 0;
  return mg_newton_pressure(p, force, centre, coefficients) || mg_continue_pressure(p, force, centre);
}

MG_INTERNAL void mg_restrict_pressure(mg_winkler_pressure_field *p, const mg_hull *h) {
  p->hull = h;
  mg_find_loaded_boundary(p);
  mg_compute_moments(p);
}
