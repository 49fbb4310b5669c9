/* Critical points of the distance of features that lie at a constant distance from a straight line or a circle, in
   closed form: cylinders and lines (about a line), tori and circles (about a circle). The line through the closest
   points of two such features is normal to both centre curves, whatever the radii:
     two lines: one common normal;
     line and circle: the squared distance of the circle's points from the line is a trigonometric polynomial of degree
     2 in the circle's angle; its stationary points are at most four.
   Where the distance is the same at all points, as of coaxial features, no point is critical by itself; the gap there
   is noted instead (c->search.open_gap). World axes. */
#include "closest/closest.h"
#include "base/base.h"
#include "model/model.h"

#define MG_ANGLE_PARTS 32    /* parts of a turn in which roots are looked for */
#define MG_ANGLE_HALVINGS 60 /* bisections of a part */

/* The centre curve of a feature, with its place. */
typedef struct {
  mg_centre_curve curve;
  mg_real centre[3]; /* of the circle, or a point of the line, m */
  mg_real axes[9];   /* of the shape, by columns: the line is along the third, the circle in the plane of the others */
} mg_centred_feature;

/* p cos a + q sin a + r cos 2a + s sin 2a */
typedef struct {
  mg_real p, q, r, s;
} mg_angle_polynomial;

static mg_real mg_angle_value(const mg_angle_polynomial *g, mg_real a) {
  return g->p * mg_cos(a) + g->q * mg_sin(a) + g->r * mg_cos(2 * a) + g->s * mg_sin(2 * a);
}

MG_INTERNAL void mg_read_centre_curve(const mg_context *c, int feature_pair, int side, mg_centre_curve *at) {
  const mg_system *s = c->system;
  const int shape = s->feature_shape[2 * feature_pair + side];
  const mg_real *parameters = s->parameters + s->feature_parameters[2 * feature_pair + side];
  const mg_real outer[2] = {0, 0}, inner[2] = {0, MG_PI};
  mg_real x[3], n[3], across[3], unused[3];
  at->kind = c->kernels->shape_kinds[shape].centre_curve, at->radius = at->tube = 0;
  at->coordinate = at->kind == MG_CENTRE_LINE && c->kernels->shape_kinds[shape].dimension == 2;
  c->kernels->shape_point(shape, outer, parameters, x, n);
  if (c->kernels->shape_kinds[shape].dimension == 2) {
    mg_normalise3(n);
    if (at->kind == MG_CENTRE_CIRCLE) {
      c->kernels->shape_point(shape, inner, parameters, across, unused);
      at->radius = (x[0] + across[0]) / 2;
    }
    at->tube = (x[0] - at->radius) * n[0];
  } else if (at->kind == MG_CENTRE_CIRCLE) at->radius = x[0];
}

MG_INTERNAL int mg_is_about_centre_curve(const mg_context *c, int feature_pair, int side) {
  const mg_shape_kind *kind = c->kernels->shape_kinds + c->system->feature_shape[2 * feature_pair + side];
  return kind->centre_curve && kind->dimension == 2;
}

MG_INTERNAL void mg_foot_on_centre_curve(const mg_centre_curve *curve, const mg_real *x, mg_real *foot) {
  const mg_real across = sqrt(x[0] * x[0] + x[1] * x[1]);
  for (int k = 0; k < 2; k++)
    foot[k] = curve->kind == MG_CENTRE_LINE || !(across > 0) ? 0 : curve->radius / across * x[k];
  foot[2] = curve->kind == MG_CENTRE_LINE ? x[2] : 0;
}

MG_INTERNAL void mg_sample_about_centre_curve(const mg_context *c, int feature_pair, int side,
                                              const mg_centre_curve *curve, const mg_real *local, mg_sample *sample) {
  const mg_real *x = local, azimuth = mg_atan2(x[1], x[0]);
  const int is_curve = mg_feature_dimension(c, feature_pair, side) == 1;
  for (int k = 0; k < 3; k++) sample->local[k] = x[k], sample->direction[k] = 0;
  if (curve->kind == MG_CENTRE_LINE) sample->uv[0] = is_curve ? x[2] : azimuth, sample->uv[1] = x[2];
  else
    sample->uv[0] = azimuth,
    sample->uv[1] = is_curve ? 0 : mg_atan2(x[2], sqrt(x[0] * x[0] + x[1] * x[1]) - curve->radius);
}

/* Reads a feature that has a centre curve, and where that is. */
static void mg_read_centred_feature(const mg_context *c, int feature_pair, int side, mg_centred_feature *at) {
  const mg_real *pose = c->bodies.pose + 12 * mg_feature_body(c, feature_pair, side);
  mg_read_centre_curve(c, feature_pair, side, &at->curve);
  mg_to_world(pose, mg_feature_numbers(c, feature_pair, side) + MG_FEATURE_PLACEMENT, 1, at->centre);
  mg_shape_rotation(c, feature_pair, side, at->axes);
}

/* Point of a centre curve: at an angle of the circle, at a distance along the line. */
static void mg_centre_point(const mg_centred_feature *at, mg_real where, mg_real *x) {
  for (int k = 0; k < 3; k++)
    x[k] = at->centre[k] + (at->curve.kind == MG_CENTRE_LINE
                                ? where * at->axes[6 + k]
                                : at->curve.radius * (mg_cos(where) * at->axes[k] + mg_sin(where) * at->axes[3 + k]));
}

/* Distance along a line of the point nearest to x. */
static mg_real mg_foot_on_line(const mg_centred_feature *line, const mg_real *x) {
  const mg_real span[3] = {x[0] - line->centre[0], x[1] - line->centre[1], x[2] - line->centre[2]};
  return mg_dot3(span, line->axes + 6);
}

/* x less its part along the line. */
static void mg_across_line(const mg_centred_feature *line, const mg_real *x, mg_real *out) {
  const mg_real along = mg_dot3(x, line->axes + 6);
  for (int k = 0; k < 3; k++) out[k] = x[k] - along * line->axes[6 + k];
}

/* A root between two angles; `rises`: g is negative at the lower one, and not at the higher one; else the reverse. */
static mg_real mg_bisect_angle(const mg_angle_polynomial *g, mg_real low, mg_real high, int rises) {
  for (int k = 0; k < MG_ANGLE_HALVINGS; k++) {
    const mg_real middle = low + (high - low) / 2;
    if ((mg_angle_value(g, middle) < 0) == rises) low = middle;
    else high = middle;
  }
  return low;
}

/* Appends the root between two angles if g, given there, changes its sign. Returns the number of roots. */
static int mg_append_root(const mg_angle_polynomial *g, mg_real low, mg_real at_low, mg_real high, mg_real at_high,
                          mg_real *root, int count) {
  if (count < 4 && (at_low < 0) != (at_high < 0)) root[count++] = mg_bisect_angle(g, low, high, at_low < 0);
  return count;
}

/* Roots of g in one turn; between two of them lies an extremum. Returns their number, at most 4. Each boundary of two
   parts has one value, that of the first and the last angle too, so that a root there is counted once. */
static int mg_angle_roots(const mg_angle_polynomial *g, mg_real *root) {
  const mg_angle_polynomial slope = {g->q, -g->p, 2 * g->s, -2 * g->r};
  const mg_real first = mg_angle_value(g, 0), first_slope = mg_angle_value(&slope, 0);
  mg_real at_low = first, slope_at_low = first_slope, low = 0;
  int count = 0;
  for (int part = 1; part <= MG_ANGLE_PARTS; part++) {
    const mg_real high = 2 * MG_PI * (mg_real)part / MG_ANGLE_PARTS;
    const int is_last = part == MG_ANGLE_PARTS;
    const mg_real at_high = is_last ? first : mg_angle_value(g, high),
                  slope_at_high = is_last ? first_slope : mg_angle_value(&slope, high);
    mg_real extremum;
    if (mg_append_root(&slope, low, slope_at_low, high, slope_at_high, &extremum, 0)) {
      const mg_real at_extremum = mg_angle_value(g, extremum);
      count = mg_append_root(g, low, at_low, extremum, at_extremum, root, count);
      count = mg_append_root(g, extremum, at_extremum, high, at_high, root, count);
    } else count = mg_append_root(g, low, at_low, high, at_high, root, count);
    low = high, at_low = at_high, slope_at_low = slope_at_high;
  }
  return count;
}

/* Points on two lines with the common normal. Returns 0 if the lines are parallel. */
static int mg_lines_nearest(const mg_centred_feature *o, const mg_centred_feature *f, mg_real *where) {
  const mg_real span[3] = {f->centre[0] - o->centre[0], f->centre[1] - o->centre[1], f->centre[2] - o->centre[2]};
  const mg_real cosine = mg_dot3(o->axes + 6, f->axes + 6), a = mg_dot3(span, o->axes + 6),
                b = mg_dot3(span, f->axes + 6);
  mg_real sine[3];
  mg_cross_product(o->axes + 6, f->axes + 6, sine);
  const mg_real square = mg_dot3(sine, sine);
  if (!(square > 64 * MG_EPS * MG_EPS)) return 0;
  where[0] = (a - cosine * b) / square, where[1] = (cosine * a - b) / square;
  return 1;
}

/* Angles of a circle at which the distance from a line is stationary. Returns their number; 0 if it is constant. */
static int mg_circle_angles(const mg_centred_feature *circle, const mg_centred_feature *line, mg_real *angle) {
  mg_real span[3], middle[3], u[3], v[3];
  for (int k = 0; k < 3; k++) span[k] = circle->centre[k] - line->centre[k];
  mg_across_line(line, span, middle), mg_across_line(line, circle->axes, u), mg_across_line(line, circle->axes + 3, v);
  for (int k = 0; k < 3; k++) u[k] *= circle->curve.radius, v[k] *= circle->curve.radius;
  const mg_angle_polynomial g = {mg_dot3(middle, v), -mg_dot3(middle, u), mg_dot3(u, v),
                                 (mg_dot3(v, v) - mg_dot3(u, u)) / 2};
  const mg_real size = fabs(g.p) + fabs(g.q) + fabs(g.r) + fabs(g.s);
  if (!(size > 64 * MG_EPS * (mg_dot3(u, u) + mg_dot3(v, v) + mg_dot3(middle, middle)))) return 0;
  return mg_angle_roots(&g, angle);
}

/* The gap where points of the centre curves are `span` apart: the nearer sides face each other, and of a cavity the
   side towards which the other is off the centre. */
static mg_real mg_gap_at_centres(const mg_centred_feature *o, const mg_centred_feature *f, mg_real span) {
  return (o->curve.tube < 0 || f->curve.tube < 0 ? -span : span) - o->curve.tube - f->curve.tube;
}

/* Converges from the points that two points of the centre curves stand for. */
static void mg_converge_from_centres(mg_context *c, int feature_pair, const mg_centred_feature *of,
                                     const mg_real *where, const mg_search_limits *limits, mg_real least,
                                     mg_minima *kept) {
  mg_real at[2][3], normal[3], eta[6] = {0};
  mg_sample sample[2];
  for (int side = 0; side < 2; side++) mg_centre_point(of + side, where[side], at[side]);
  for (int k = 0; k < 3; k++) normal[k] = at[1][k] - at[0][k];
  const mg_real d = mg_gap_at_centres(of, of + 1, sqrt(mg_dot3(normal, normal)));
  if (!mg_normalise3(normal) || d > limits->gap || d < -limits->depth) return;
  const mg_real sign = of[0].curve.tube < 0 || of[1].curve.tube < 0 ? -1 : 1;
  for (int k = 0; k < 3; k++)
    at[0][k] += sign * of[0].curve.tube * normal[k], at[1][k] -= sign * of[1].curve.tube * normal[k];
  for (int side = 0; side < 2; side++) {
    mg_real local[3];
    mg_point_in_shape_axes(c, feature_pair, side, at[side], local);
    mg_sample_about_centre_curve(c, feature_pair, side, &of[side].curve, local, sample + side);
  }
  mg_start_eta(c, feature_pair, sample, sample + 1, eta);
  if (mg_converge_from_any_start(c, feature_pair, eta) >= 0) mg_keep_minimum_at(c, feature_pair, eta, least, kept);
}

MG_INTERNAL int mg_has_centre_curves(const mg_context *c, int feature_pair) {
  int kind[2];
  for (int side = 0; side < 2; side++)
    kind[side] = c->kernels->shape_kinds[c->system->feature_shape[2 * feature_pair + side]].centre_curve;
  return kind[0] && kind[1] && (kind[0] == MG_CENTRE_LINE || kind[1] == MG_CENTRE_LINE);
}

MG_INTERNAL void mg_search_centre_curves(mg_context *c, int feature_pair, const mg_search_limits *limits, mg_real least,
                                         mg_minima *kept) {
  mg_centred_feature of[2];
  mg_real angle[4], where[2], x[3], foot[3];
  for (int side = 0; side < 2; side++) mg_read_centred_feature(c, feature_pair, side, of + side);
  if (of[0].curve.kind == of[1].curve.kind) {
    if (mg_lines_nearest(of, of + 1, where)) {
      mg_converge_from_centres(c, feature_pair, of, where, limits, least, kept);
      return;
    }
    where[0] = 0, mg_centre_point(of, 0, x), where[1] = mg_foot_on_line(of + 1, x);
  } else {
    const int circle = of[0].curve.kind == MG_CENTRE_CIRCLE ? 0 : 1;
    const int count = mg_circle_angles(of + circle, of + 1 - circle, angle);
    for (int k = 0; k < count; k++) {
      where[circle] = angle[k], mg_centre_point(of + circle, angle[k], x);
      where[1 - circle] = mg_foot_on_line(of + 1 - circle, x);
      mg_converge_from_centres(c, feature_pair, of, where, limits, least, kept);
    }
    if (count) return;
    where[circle] = 0, mg_centre_point(of + circle, 0, x), where[1 - circle] = mg_foot_on_line(of + 1 - circle, x);
  }
  mg_centre_point(of, where[0], x), mg_centre_point(of + 1, where[1], foot);
  const mg_real span[3] = {foot[0] - x[0], foot[1] - x[1], foot[2] - x[2]};
  mg_note_open_gap(c, mg_gap_at_centres(of, of + 1, sqrt(mg_dot3(span, span))));
}
