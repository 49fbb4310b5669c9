/* Places on two lines or circles at which their distance is stationary:
     two lines: one common normal;
     point and line: the foot on the line;
     point and circle: its points in the plane through the axis and the point, on both sides of the axis;
     line and circle: the derivative of the squared distance of the circle's points from the line is a trigonometric
     polynomial of degree 2 in the circle's angle; it has at most four roots;
     two circles: of a point x(s) of the first circle at the height z above the plane of the second, at the distance
     rho from its axis, the nearest and the farthest point of the second have the squared distance
       z^2 + (rho -+ R)^2.
     With a = (x - C).x' and b = rho rho', C the centre and R the radius of the second, its derivative is zero where
       a rho = +- R b,    thus    a^2 rho^2 - R^2 b^2 = 0,
     a trigonometric polynomial of degree 4 in s with at most eight roots.
   The roots are those of polynomials in the tangent of half the angle, on arcs of half a turn at most. Where circles
   are symmetric, two roots coincide that belong to the nearest and to the farthest point: such places are searched from
   all points that solve one of the two equations. */
#include "closest/closest.h"
#include "base/base.h"
#include "model/model.h"

#define MG_FIRST_ANGLE ((mg_real)0.7) /* so that roots of symmetric places do not lie at the ends of intervals */
#define MG_POLISHING_STEPS 8
#define MG_ARCS 16                  /* of a circle, which are left out where they are far from the other one */
#define MG_SAME_PLACE (64 * MG_EPS) /* rad */

/* An arc of a circle, up to half a turn: its middle, rad, with cosine and sine, and the tangent of a quarter of its
   angle. */
typedef struct {
  mg_real middle, cosine, sine, tangent;
} mg_arc_of_circle;

/* The arc of `parts` parts of a turn that ends after `end` parts. */
static mg_arc_of_circle mg_arc_of_parts(int end, int parts) {
  const mg_real part = 2 * MG_PI / MG_ARCS, middle = MG_FIRST_ANGLE + ((mg_real)end - (mg_real)parts / 2) * part;
  const mg_arc_of_circle arc = {middle, mg_cos(middle), mg_sin(middle), mg_tan((mg_real)parts * part / 4)};
  return arc;
}

/* (p cos a + q sin a + m) (1 + x^2) with x = mg_tan(a/2) = T (2 t - 1), by the coefficients of (1 - t)^(2 - k) t^k. */
static void mg_turning(mg_real p, mg_real q, mg_real m, mg_real T, mg_real *b) {
  const mg_real constant = p + m, linear = 2 * q * T, square = (m - p) * T * T;
  b[0] = constant - linear + square, b[1] = 2 * (constant - square), b[2] = constant + linear + square;
}

/* Axes in the plane of a circle, turned about its third axis, and times its radius. */
static void mg_turned_radii(const mg_centred_feature *circle, mg_real angle, mg_real *u, mg_real *v) {
  const mg_real r = circle->curve.radius, p = r * mg_cos(angle), q = r * mg_sin(angle);
  for (int k = 0; k < 3; k++) {
    u[k] = p * circle->axes[k] + q * circle->axes[3 + k];
    v[k] = p * circle->axes[3 + k] - q * circle->axes[k];
  }
}

/* Angles of the roots of a polynomial in the parameter of an arc. Returns their number. */
static int mg_root_angles(int n, const mg_real *polynomial, mg_real noise, const mg_arc_of_circle *arc,
                          mg_root_interval *angle) {
  const int count = mg_homogeneous_roots(n, polynomial, noise, angle);
  for (int k = 0; k < count; k++) {
    const int is_simple = angle[k].low == angle[k].high;
    angle[k].low = arc->middle + 2 * mg_atan(arc->tangent * angle[k].low);
    angle[k].high = is_simple ? angle[k].low : arc->middle + 2 * mg_atan(arc->tangent * angle[k].high);
  }
  return count;
}

MG_INTERNAL void mg_centre_point(const mg_centred_feature *at, mg_real where, mg_real *x) {
  const mg_real p = at->curve.radius * mg_cos(where), q = at->curve.radius * mg_sin(where);
  for (int k = 0; k < 3; k++)
    x[k] = at->centre[k] + (at->curve.kind == MG_SPINE_LINE     ? where * at->axes[6 + k]
                            : at->curve.kind == MG_SPINE_CIRCLE ? p * at->axes[k] + q * at->axes[3 + k]
                                                                : 0);
}

/* Tangent of a spine. */
static void mg_centre_tangent(const mg_centred_feature *at, mg_real where, mg_real *tangent) {
  for (int k = 0; k < 3; k++)
    tangent[k] = at->curve.kind == MG_SPINE_LINE ? at->axes[6 + k]
                                                 : mg_cos(where) * at->axes[3 + k] - mg_sin(where) * at->axes[k];
}

MG_INTERNAL int mg_normal_to_both(const mg_centred_feature *of, const mg_real *where, mg_real *normal) {
  mg_real tangent[2][3];
  if (of[0].curve.kind == MG_SPINE_POINT || of[1].curve.kind == MG_SPINE_POINT) return 0;
  for (int side = 0; side < 2; side++) mg_centre_tangent(of + side, where[side], tangent[side]);
  mg_cross_product(tangent[0], tangent[1], normal);
  return mg_normalise3(normal);
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

/* Places of a point and a line or circle. Returns their number; 0 if the distance is constant. */
static int mg_point_and_curve(const mg_centred_feature *of, int point, mg_stationary_place *place) {
  const mg_centred_feature *curve = of + 1 - point;
  const mg_real *x = of[point].centre,
                span[3] = {x[0] - curve->centre[0], x[1] - curve->centre[1], x[2] - curve->centre[2]};
  const mg_real across[2] = {mg_dot3(span, curve->axes), mg_dot3(span, curve->axes + 3)};
  const int count = curve->curve.kind == MG_SPINE_LINE ? 1 : 2;
  if (!(fabs(across[0]) + fabs(across[1]) > 64 * MG_EPS * (sqrt(mg_dot3(x, x)) + curve->curve.radius))) return 0;
  for (int k = 0; k < count; k++) {
    place[k].where[point] = 0, place[k].regularity = 1;
    place[k].where[1 - point] = count == 1 ? mg_foot_on_line(curve, x) : mg_atan2(across[1], across[0]) + k * MG_PI;
  }
  return count;
}

/* Places of a circle and a line. Returns their number; 0 if the distance is constant. */
static int mg_circle_and_line(const mg_centred_feature *of, int circle, mg_stationary_place *place) {
  const mg_centred_feature *line = of + 1 - circle;
  mg_real cosine[3], sine[3], one[3], span[3], middle[3], u[3], v[3], x[3];
  int count = 0;
  mg_turning(1, 0, 0, 1, cosine), mg_turning(0, 1, 0, 1, sine), mg_turning(0, 0, 1, 1, one);
  for (int k = 0; k < 3; k++) span[k] = of[circle].centre[k] - line->centre[k];
  mg_across_line(line, span, middle);
  for (int half = 0; half < 2; half++) {
    const mg_arc_of_circle arc = mg_arc_of_parts((half + 1) * MG_ARCS / 2, MG_ARCS / 2);
    mg_root_interval angle[MG_BERNSTEIN_ROOTS];
    mg_real polynomial[5] = {0};
    mg_turned_radii(of + circle, arc.middle, u, v), mg_across_line(line, u, u), mg_across_line(line, v, v);
    const mg_real p = mg_dot3(middle, v), q = -mg_dot3(middle, u), r = mg_dot3(u, v),
                  s = (mg_dot3(v, v) - mg_dot3(u, u)) / 2, size = fabs(p) + fabs(q) + fabs(r) + fabs(s);
    if (!(size > 64 * MG_EPS * (mg_dot3(u, u) + mg_dot3(v, v) + mg_dot3(middle, middle)))) return 0;
    mg_add_homogeneous_product(2, cosine, 2, one, p, polynomial);
    mg_add_homogeneous_product(2, sine, 2, one, q, polynomial);
    mg_add_homogeneous_product(2, cosine, 2, cosine, r, polynomial);
    mg_add_homogeneous_product(2, sine, 2, sine, -r, polynomial);
    mg_add_homogeneous_product(2, sine, 2, cosine, 2 * s, polynomial);
    const int roots = mg_root_angles(4, polynomial, 16 * MG_EPS * size, &arc, angle);
    for (int k = 0; k < roots && count < MG_STATIONARY; k++, count++) {
      place[count].where[circle] = angle[k].low + (angle[k].high - angle[k].low) / 2, place[count].regularity = 1;
      mg_centre_point(of + circle, place[count].where[circle], x);
      place[count].where[1 - circle] = mg_foot_on_line(line, x);
    }
  }
  return count;
}

/* Derivatives of half the squared distance of points of two circles by their angles. */
typedef struct {
  mg_real slope[2];   /* m^2 */
  mg_real bend[2][2]; /* m^2 */
} mg_circle_derivatives;

static mg_circle_derivatives mg_differentiate_distance(const mg_centred_feature *of, const mg_real *where) {
  mg_real x[2][3], along[2][3], span[3];
  mg_circle_derivatives d;
  for (int side = 0; side < 2; side++) {
    const mg_real p = of[side].curve.radius * mg_cos(where[side]), q = of[side].curve.radius * mg_sin(where[side]);
    for (int k = 0; k < 3; k++) {
      x[side][k] = p * of[side].axes[k] + q * of[side].axes[3 + k];
      along[side][k] = p * of[side].axes[3 + k] - q * of[side].axes[k];
    }
  }
  for (int k = 0; k < 3; k++) span[k] = of[1].centre[k] + x[1][k] - of[0].centre[k] - x[0][k];
  d.slope[0] = -mg_dot3(along[0], span), d.slope[1] = mg_dot3(along[1], span);
  d.bend[0][0] = mg_dot3(along[0], along[0]) + mg_dot3(x[0], span);
  d.bend[1][1] = mg_dot3(along[1], along[1]) - mg_dot3(x[1], span);
  d.bend[0][1] = d.bend[1][0] = -mg_dot3(along[0], along[1]);
  return d;
}

/* Newton's method from a place that is stationary to about the root of the rounding unit. */
static void mg_polish_place(const mg_centred_feature *of, mg_real *where) {
  for (int step = 0; step < MG_POLISHING_STEPS; step++) {
    const mg_circle_derivatives d = mg_differentiate_distance(of, where);
    const mg_real determinant = d.bend[0][0] * d.bend[1][1] - d.bend[0][1] * d.bend[1][0];
    const mg_real change[2] = {(d.bend[0][1] * d.slope[1] - d.bend[1][1] * d.slope[0]) / determinant,
                               (d.bend[1][0] * d.slope[0] - d.bend[0][0] * d.slope[1]) / determinant};
    const mg_real size = fabs(change[0]) + fabs(change[1]);
    if (!(size < (mg_real)0.1)) return;
    where[0] += change[0], where[1] += change[1];
    if (size <= MG_SAME_PLACE) return;
  }
}

/* How far the gradient of the distance is from zero at a place, m. */
static mg_real mg_gradient_at(const mg_centred_feature *of, const mg_real *where) {
  const mg_circle_derivatives d = mg_differentiate_distance(of, where);
  return fabs(d.slope[0]) / of[0].curve.radius + fabs(d.slope[1]) / of[1].curve.radius;
}

/* A point of the first circle as seen from the second: its place across the axis of that, and how half the squared
   distance from a point of that at an angle t changes along the first circle: m - a cos(t) - b sin(t). */
typedef struct {
  mg_real x, y, rho, a, b, m;
} mg_point_of_first;

static mg_point_of_first mg_see_from_second(const mg_centred_feature *of, mg_real angle) {
  const mg_real *u = of[1].axes, *v = of[1].axes + 3, R = of[1].curve.radius, p = of[0].curve.radius * mg_cos(angle),
                q = of[0].curve.radius * mg_sin(angle);
  mg_real span[3], along[3];
  for (int k = 0; k < 3; k++) {
    span[k] = of[0].centre[k] - of[1].centre[k] + p * of[0].axes[k] + q * of[0].axes[3 + k];
    along[k] = p * of[0].axes[3 + k] - q * of[0].axes[k];
  }
  mg_point_of_first at = {.x = mg_dot3(span, u), .y = mg_dot3(span, v), .m = mg_dot3(along, span)};
  at.rho = sqrt(at.x * at.x + at.y * at.y), at.a = R * mg_dot3(along, u), at.b = R * mg_dot3(along, v);
  return at;
}

/* Angles of the second circle towards which the first circle is normal at a point of it. Returns their number. */
static int mg_angles_normal_to_first(const mg_point_of_first *at, mg_real *angle) {
  const mg_real size = sqrt(at->a * at->a + at->b * at->b);
  if (!(fabs(at->m) <= size) || !(size > 0)) return 0;
  const mg_real middle = mg_atan2(at->b, at->a), half = mg_acos(at->m / size);
  angle[0] = middle + half, angle[1] = middle - half;
  return 2;
}

/* True if a place is on the list. */
static int mg_is_place_listed(const mg_real *where, const mg_stationary_place *list, int count) {
  for (int k = 0; k < count; k++)
    if (fabs(mg_sin((where[0] - list[k].where[0]) / 2)) <= MG_SAME_PLACE &&
        fabs(mg_sin((where[1] - list[k].where[1]) / 2)) <= MG_SAME_PLACE)
      return 1;
  return 0;
}

/* Adds a stationary place if the gap can be a minimum there: the distance is a minimum; or, in a hollow, one over the
   points of the hollow's circle, of which that of the other circle's points is a maximum. At most eight places are
   apart from each other; where there are more, the distance is constant along a curve, and any of them stands for all.
   Returns the length of the list. */
static int mg_add_place(const mg_centred_feature *of, const mg_real *where, mg_stationary_place *list, int count) {
  const mg_circle_derivatives d = mg_differentiate_distance(of, where);
  const mg_real r[2] = {of[0].curve.radius, of[1].curve.radius};
  const mg_real first = d.bend[0][0] / (r[0] * r[0]), second = d.bend[1][1] / (r[1] * r[1]),
                mixed = d.bend[0][1] / (r[0] * r[1]), size = fabs(first) + fabs(second) + fabs(mixed),
                slack = sqrt(MG_EPS) * size, determinant = first * second - mixed * mixed;
  const int in_first = of[0].curve.tube < 0, is_hollow = in_first || of[1].curve.tube < 0;
  const int can_be_minimum = is_hollow ? (in_first ? first : second) >= -slack && determinant <= slack * size
                                       : first >= -slack && second >= -slack && determinant >= -slack * size;
  if (!can_be_minimum || count == MG_STATIONARY || mg_is_place_listed(where, list, count)) return count;
  list[count].where[0] = where[0], list[count].where[1] = where[1];
  list[count].regularity = fabs(determinant) / (size * size);
  return count + 1;
}

/* Adds the places at a simple root: towards the nearest or the farthest point of the second circle, to whichever the
   first circle is normal; from near the axis of the second, both angles to which it is normal. */
static int mg_add_simple_place(const mg_centred_feature *of, mg_real angle, mg_stationary_place *place, int count) {
  const mg_point_of_first at = mg_see_from_second(of, angle);
  mg_real where[2] = {angle, 0}, other[2];
  if (!(at.rho > sqrt(sqrt(MG_EPS)) * of[1].curve.radius)) {
    const int n = mg_angles_normal_to_first(&at, other);
    for (int k = 0; k < n; k++) where[1] = other[k], count = mg_add_place(of, where, place, count);
    if (n) return count;
  }
  const mg_real turn = (at.a * at.x + at.b * at.y) / at.rho;
  const int is_far = fabs(at.m + turn) < fabs(at.m - turn);
  if (is_far && of[0].curve.tube >= 0 && of[1].curve.tube >= 0) return count;
  where[1] = mg_atan2(at.y, at.x) + (is_far ? MG_PI : 0);
  return mg_add_place(of, where, place, count);
}

/* Adds the places in an interval of roots that almost coincide. */
static int mg_add_close_places(const mg_centred_feature *of, const mg_root_interval *angle, mg_stationary_place *place,
                               int count) {
  const mg_real scale = of[0].curve.radius + of[1].curve.radius + sqrt(mg_dot3(of[0].centre, of[0].centre)) +
                        sqrt(mg_dot3(of[1].centre, of[1].centre));
  for (int part = 0; part < 3; part++) {
    const mg_real start = angle->low + (mg_real)part / 2 * (angle->high - angle->low);
    const mg_point_of_first at = mg_see_from_second(of, start);
    mg_real other[4] = {mg_atan2(at.y, at.x), 0, 0, 0};
    other[1] = other[0] + MG_PI;
    const int n = 2 + mg_angles_normal_to_first(&at, other + 2);
    for (int k = 0; k < n; k++) {
      mg_real where[2] = {start, other[k]};
      mg_polish_place(of, where);
      if (mg_gradient_at(of, where) <= sqrt(MG_EPS) * scale) count = mg_add_place(of, where, place, count);
    }
  }
  return count;
}

/* Part of the points of a circle along an axis, from a point. */
static mg_sinusoid mg_along_circle(const mg_centred_feature *circle, const mg_real *axis, const mg_real *from) {
  const mg_sinusoid out = {circle->curve.radius * mg_dot3(circle->axes, axis),
                           circle->curve.radius * mg_dot3(circle->axes + 3, axis), -mg_dot3(from, axis)};
  return out;
}

MG_INTERNAL mg_first_circle mg_view_first_circle(const mg_centred_feature *of) {
  const mg_real centre[3] = {of[1].centre[0] - of[0].centre[0], of[1].centre[1] - of[0].centre[1],
                             of[1].centre[2] - of[0].centre[2]};
  const mg_first_circle first = {mg_along_circle(of, of[1].axes, centre), mg_along_circle(of, of[1].axes + 3, centre),
                                 mg_along_circle(of, of[1].axes + 6, centre), mg_along_circle(of, centre, centre)};
  return first;
}

/* A sinusoid, or its derivative, on an arc, times 1 + x^2 as in mg_turning. */
static void mg_sinusoid_on_arc(const mg_sinusoid *f, const mg_arc_of_circle *arc, int derivative, mg_real *b) {
  const mg_real p = f->p * arc->cosine + f->q * arc->sine, q = f->q * arc->cosine - f->p * arc->sine;
  if (derivative) mg_turning(q, -p, 0, arc->tangent, b);
  else mg_turning(p, q, f->m, arc->tangent, b);
}

/* The polynomial whose roots are the stationary places of two circles on an arc of the first one. Returns the size of
   its rounding errors. */
static mg_real mg_circles_polynomial(const mg_first_circle *first, mg_real R, const mg_arc_of_circle *arc,
                                     mg_real *polynomial) {
  mg_real a[3], x[3], y[3], z[3], rise[3], one[3], square[5] = {0}, b[5] = {0}, a2[5] = {0};
  mg_turning(0, 0, 1, arc->tangent, one);
  mg_sinusoid_on_arc(&first->x, arc, 0, x), mg_sinusoid_on_arc(&first->y, arc, 0, y);
  mg_sinusoid_on_arc(&first->z, arc, 0, z), mg_sinusoid_on_arc(&first->z, arc, 1, rise);
  mg_sinusoid_on_arc(&first->towards, arc, 1, a);
  for (int k = 0; k < 3; k++) a[k] = -a[k];
  mg_add_homogeneous_product(2, x, 2, x, 1, square), mg_add_homogeneous_product(2, y, 2, y, 1, square);
  mg_add_homogeneous_product(2, a, 2, one, 1, b), mg_add_homogeneous_product(2, z, 2, rise, -1, b);
  mg_add_homogeneous_product(2, a, 2, a, 1, a2);
  for (int k = 0; k <= MG_BERNSTEIN_DEGREE; k++) polynomial[k] = 0;
  mg_add_homogeneous_product(4, a2, 4, square, 1, polynomial);
  mg_add_homogeneous_product(4, b, 4, b, -R * R, polynomial);
  const mg_real large_a = mg_max_abs(3, a), large_x = mg_max_abs(3, x), large_y = mg_max_abs(3, y),
                large_b = 2 * large_a + mg_max_abs(3, z) * mg_max_abs(3, rise);
  return 32 * MG_EPS * (large_a * large_a * (large_x * large_x + large_y * large_y) + R * R * large_b * large_b);
}

/* True if the distance of a point of the first circle from the second, of radius R, is `reach` at most. */
static int mg_is_near_second(const mg_first_circle *first, mg_real R, mg_real cosine, mg_real sine, mg_real reach) {
  const mg_real x = first->x.p * cosine + first->x.q * sine + first->x.m,
                y = first->y.p * cosine + first->y.q * sine + first->y.m,
                z = first->z.p * cosine + first->z.q * sine + first->z.m, across = sqrt(x * x + y * y) - R;
  return z * z + across * across <= reach * reach;
}

/* Arcs of the first circle that contain all its points whose distance from the second one is `reach` at most. Returns
   their number. */
static int mg_near_arcs(const mg_centred_feature *of, const mg_first_circle *first, mg_real reach,
                        mg_arc_of_circle *arc) {
  const mg_real half = MG_PI / MG_ARCS, slack = reach + of[0].curve.radius * half,
                turn[2] = {mg_cos(2 * half), mg_sin(2 * half)};
  mg_real cosine = mg_cos(MG_FIRST_ANGLE + half), sine = mg_sin(MG_FIRST_ANGLE + half);
  const int is_bounded = slack < MG_MAX / 4;
  int count = 0, parts = 0;
  for (int k = 0; k <= MG_ARCS; k++) {
    const int is_near =
        k < MG_ARCS && (!is_bounded || mg_is_near_second(first, of[1].curve.radius, cosine, sine, slack));
    if (parts && (!is_near || parts == MG_ARCS / 2)) arc[count++] = mg_arc_of_parts(k, parts), parts = 0;
    parts += is_near;
    const mg_real before = cosine;
    cosine = before * turn[0] - sine * turn[1], sine = sine * turn[0] + before * turn[1];
  }
  return count;
}

/* Places of two circles whose distance is `reach` at most, by the angle of the first one. Returns their number.
   `widest`: the widest interval of roots that almost coincide, rad. */
static int mg_places_by_first(const mg_centred_feature *of, mg_real reach, mg_stationary_place *place,
                              mg_real *widest) {
  mg_real polynomial[MG_BERNSTEIN_DEGREE + 1];
  mg_root_interval angle[MG_BERNSTEIN_ROOTS];
  mg_arc_of_circle arc[MG_ARCS];
  const mg_first_circle first = mg_view_first_circle(of);
  const int arcs = mg_near_arcs(of, &first, reach, arc);
  int count = 0;
  *widest = 0;
  for (int i = 0; i < arcs; i++) {
    const mg_real noise = mg_circles_polynomial(&first, of[1].curve.radius, arc + i, polynomial);
    const int roots = mg_root_angles(MG_BERNSTEIN_DEGREE, polynomial, noise, arc + i, angle);
    for (int k = 0; k < roots; k++) {
      *widest = fmax(*widest, angle[k].high - angle[k].low);
      count = angle[k].low == angle[k].high ? mg_add_simple_place(of, angle[k].low, place, count)
                                            : mg_add_close_places(of, angle + k, place, count);
    }
  }
  return count;
}

/* Places of two circles at which the gap is within a bound. More than two roots that almost coincide belong to a part
   of the second circle that is about equally far from a point of the first, or to a curve of stationary places: then
   the angle of the second circle tells them apart. Returns the number of places. */
static int mg_circle_and_circle(const mg_centred_feature *of, mg_real gap, mg_stationary_place *place) {
  const mg_centred_feature swapped[2] = {of[1], of[0]};
  const int is_hollow = of[0].curve.tube < 0 || of[1].curve.tube < 0;
  const mg_real reach = is_hollow ? MG_MAX : gap + of[0].curve.tube + of[1].curve.tube;
  mg_stationary_place more[MG_STATIONARY];
  mg_real widest, unused;
  int count = mg_places_by_first(of, reach, place, &widest);
  if (!(widest > sqrt(sqrt(MG_EPS)))) return count;
  const int n = mg_places_by_first(swapped, reach, more, &unused);
  for (int k = 0; k < n; k++) {
    const mg_real where[2] = {more[k].where[1], more[k].where[0]};
    count = mg_add_place(of, where, place, count);
  }
  return count;
}

MG_INTERNAL int mg_stationary_places(const mg_centred_feature *of, mg_real gap, mg_stationary_place *place) {
  const int circle = of[0].curve.kind == MG_SPINE_CIRCLE ? 0 : 1;
  const mg_centred_feature *other = of + 1 - circle;
  place[0].regularity = 1;
  for (int side = 0; side < 2; side++)
    if (of[side].curve.kind == MG_SPINE_POINT) return mg_point_and_curve(of, side, place);
  if (of[circle].curve.kind == MG_SPINE_LINE) return mg_lines_nearest(of, of + 1, place[0].where);
  return other->curve.kind == MG_SPINE_LINE ? mg_circle_and_line(of, circle, place)
                                            : mg_circle_and_circle(of, gap, place);
}

MG_INTERNAL mg_real mg_constant_distance(const mg_centred_feature *of) {
  const int line = of[0].curve.kind == MG_SPINE_LINE ? 0 : 1;
  mg_real x[3], foot[3];
  mg_centre_point(of + 1 - line, 0, x);
  mg_centre_point(of + line, of[line].curve.kind == MG_SPINE_LINE ? mg_foot_on_line(of + line, x) : 0, foot);
  const mg_real span[3] = {foot[0] - x[0], foot[1] - x[1], foot[2] - x[2]};
  return sqrt(mg_dot3(span, span));
}
