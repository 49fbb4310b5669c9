/* Places on two lines or circles at which their distance is stationary:
     two lines: one common normal;
     line and circle: the derivative of the squared distance of the circle's points from the line is a trigonometric
     polynomial of degree 2 in the circle's angle; it has at most four roots;
     two circles: of a point x(s) of the first circle at the height z above the plane of the second, at the distance
     rho from its axis, the nearest and the farthest point of the second have the squared distance
       z^2 + (rho -+ R)^2.
     With a = (x - C).x' and b = rho rho', C the centre and R the radius of the second, its derivative is zero where
       a rho = +- R b,    thus    a^2 rho^2 - R^2 b^2 = 0,
     a trigonometric polynomial of degree 4 in s with at most eight roots.
   The roots are those of polynomials in the tangent of half the angle, on two halves of a turn. Where circles are
   symmetric, two roots coincide that belong to the nearest and to the farthest point: such places are searched from
   all points that solve one of the two equations. */
#include "closest/closest.h"
#include "base/base.h"
#include "model/model.h"

#define MG_FIRST_ANGLE ((mg_real)0.7) /* so that roots of symmetric places do not lie at the ends of intervals */
#define MG_POLISHING_STEPS 8
#define MG_SAME_PLACE (64 * MG_EPS) /* rad */

/* b = p cos a + q sin a + m, times 1 + x^2, in Bernstein form of degree 2 in x = tan(a/2). */
static void mg_angle_bernstein(mg_real p, mg_real q, mg_real m, mg_real *b) {
  b[0] = 2 * (m - q), b[1] = 2 * p, b[2] = 2 * (m + q);
}

/* Axes in the plane of a circle, turned about its third axis, and times its radius. */
static void mg_turned_radii(const mg_centred_feature *circle, mg_real angle, mg_real *u, mg_real *v) {
  const mg_real r = circle->curve.radius, p = r * cos(angle), q = r * sin(angle);
  for (int k = 0; k < 3; k++) {
    u[k] = p * circle->axes[k] + q * circle->axes[3 + k];
    v[k] = p * circle->axes[3 + k] - q * circle->axes[k];
  }
}

/* Adds the angles of the roots of a polynomial in x = tan((angle - first)/2). Returns the number of roots. */
static int mg_add_angles(int n, const mg_real *polynomial, mg_real noise, mg_real first, mg_root_interval *angle) {
  const int count = mg_bernstein_roots(n, polynomial, noise, angle);
  for (int k = 0; k < count; k++) {
    const int is_simple = angle[k].low == angle[k].high;
    angle[k].low = first + 2 * atan(angle[k].low);
    angle[k].high = is_simple ? angle[k].low : first + 2 * atan(angle[k].high);
  }
  return count;
}

MG_INTERNAL void mg_centre_point(const mg_centred_feature *at, mg_real where, mg_real *x) {
  for (int k = 0; k < 3; k++)
    x[k] = at->centre[k] + (at->curve.kind == MG_CENTRE_LINE
                                ? where * at->axes[6 + k]
                                : at->curve.radius * (cos(where) * at->axes[k] + sin(where) * at->axes[3 + k]));
}

/* Tangent of a centre curve. */
static void mg_centre_tangent(const mg_centred_feature *at, mg_real where, mg_real *tangent) {
  for (int k = 0; k < 3; k++)
    tangent[k] =
        at->curve.kind == MG_CENTRE_LINE ? at->axes[6 + k] : cos(where) * at->axes[3 + k] - sin(where) * at->axes[k];
}

MG_INTERNAL int mg_centre_normal(const mg_centred_feature *of, const mg_real *where, mg_real *normal) {
  mg_real x[3], tangent[2][3];
  mg_centre_point(of, where[0], x), mg_centre_point(of + 1, where[1], normal);
  for (int k = 0; k < 3; k++) normal[k] -= x[k];
  if (mg_normalise3(normal)) return 1;
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

/* Places of a circle and a line. Returns their number; 0 if the distance is constant. */
static int mg_circle_and_line(const mg_centred_feature *of, int circle, mg_stationary_place *place) {
  const mg_centred_feature *line = of + 1 - circle;
  const mg_real cosine[3] = {0, 2, 0}, sine[3] = {-2, 0, 2}, one[3] = {2, 0, 2};
  mg_real span[3], middle[3], u[3], v[3], x[3];
  int count = 0;
  for (int k = 0; k < 3; k++) span[k] = of[circle].centre[k] - line->centre[k];
  mg_across_line(line, span, middle);
  for (int half = 0; half < 2; half++) {
    mg_root_interval angle[MG_BERNSTEIN_ROOTS];
    mg_real polynomial[5] = {0};
    const mg_real first = MG_FIRST_ANGLE + (mg_real)half * MG_PI;
    mg_turned_radii(of + circle, first, u, v), mg_across_line(line, u, u), mg_across_line(line, v, v);
    const mg_real p = mg_dot3(middle, v), q = -mg_dot3(middle, u), r = mg_dot3(u, v),
                  s = (mg_dot3(v, v) - mg_dot3(u, u)) / 2, size = fabs(p) + fabs(q) + fabs(r) + fabs(s);
    if (!(size > 64 * MG_EPS * (mg_dot3(u, u) + mg_dot3(v, v) + mg_dot3(middle, middle)))) return 0;
    mg_add_bernstein_product(2, cosine, 2, one, p, polynomial),
        mg_add_bernstein_product(2, sine, 2, one, q, polynomial);
    mg_add_bernstein_product(2, cosine, 2, cosine, r, polynomial);
    mg_add_bernstein_product(2, sine, 2, sine, -r, polynomial);
    mg_add_bernstein_product(2, sine, 2, cosine, 2 * s, polynomial);
    const int roots = mg_add_angles(4, polynomial, 16 * MG_EPS * size, first, angle);
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
    const mg_real p = of[side].curve.radius * cos(where[side]), q = of[side].curve.radius * sin(where[side]);
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

/* How far the gradient of the distance is from zero at a place, as a part of the size of the circles. */
static mg_real mg_gradient_at(const mg_centred_feature *of, const mg_real *where) {
  const mg_circle_derivatives d = mg_differentiate_distance(of, where);
  return fabs(d.slope[0]) / of[0].curve.radius + fabs(d.slope[1]) / of[1].curve.radius;
}

/* Angles of the second circle at which one of the two equations holds at an angle of the first: its points nearest to
   and farthest from that of the first, and those towards which the first circle is normal. Returns their number. */
static int mg_angles_of_second(const mg_centred_feature *of, mg_real angle, mg_real *other) {
  const mg_real *u = of[1].axes, *v = of[1].axes + 3, p = of[0].curve.radius * cos(angle),
                q = of[0].curve.radius * sin(angle);
  mg_real span[3], along[3];
  for (int k = 0; k < 3; k++) {
    span[k] = of[0].centre[k] - of[1].centre[k] + p * of[0].axes[k] + q * of[0].axes[3 + k];
    along[k] = p * of[0].axes[3 + k] - q * of[0].axes[k];
  }
  other[0] = atan2(mg_dot3(span, v), mg_dot3(span, u)), other[1] = other[0] + MG_PI;
  const mg_real a = of[1].curve.radius * mg_dot3(along, u), b = of[1].curve.radius * mg_dot3(along, v),
                size = sqrt(a * a + b * b), m = mg_dot3(along, span);
  if (!(fabs(m) <= size) || !(size > 0)) return 2;
  const mg_real middle = atan2(b, a), half = acos(m / size);
  other[2] = middle + half, other[3] = middle - half;
  return 4;
}

/* True if a place is on the list. */
static int mg_is_place_listed(const mg_real *where, const mg_stationary_place *list, int count) {
  for (int k = 0; k < count; k++)
    if (fabs(sin((where[0] - list[k].where[0]) / 2)) <= MG_SAME_PLACE &&
        fabs(sin((where[1] - list[k].where[1]) / 2)) <= MG_SAME_PLACE)
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

/* Adds the place at a simple root: of the angles of the second circle that which solves both equations best. */
static int mg_add_simple_place(const mg_centred_feature *of, mg_real angle, mg_stationary_place *list, int count) {
  mg_real other[4], least = MG_MAX, best[2] = {angle, 0};
  const int n = mg_angles_of_second(of, angle, other);
  for (int k = 0; k < n; k++) {
    const mg_real at[2] = {angle, other[k]}, gradient = mg_gradient_at(of, at);
    if (gradient < least) least = gradient, best[1] = other[k];
  }
  return mg_add_place(of, best, list, count);
}

/* Adds the places in an interval of roots that almost coincide. */
static int mg_add_close_places(const mg_centred_feature *of, const mg_root_interval *angle, mg_stationary_place *list,
                               int count) {
  mg_real other[4];
  const mg_real scale = of[0].curve.radius + of[1].curve.radius + sqrt(mg_dot3(of[0].centre, of[0].centre)) +
                        sqrt(mg_dot3(of[1].centre, of[1].centre));
  for (int part = 0; part < 3; part++) {
    const mg_real start = angle->low + (mg_real)part / 2 * (angle->high - angle->low);
    const int n = mg_angles_of_second(of, start, other);
    for (int k = 0; k < n; k++) {
      mg_real at[2] = {start, other[k]};
      mg_polish_place(of, at);
      if (mg_gradient_at(of, at) <= sqrt(MG_EPS) * scale) count = mg_add_place(of, at, list, count);
    }
  }
  return count;
}

/* The polynomial whose roots are the stationary places of two circles on half a turn about the angle `first` of the
   first one. Returns the size of its rounding errors. */
static mg_real mg_circles_polynomial(const mg_centred_feature *of, mg_real first, mg_real *polynomial) {
  const mg_real *u2 = of[1].axes, *v2 = of[1].axes + 3, *n = of[1].axes + 6, R = of[1].curve.radius;
  const mg_real c[3] = {of[1].centre[0] - of[0].centre[0], of[1].centre[1] - of[0].centre[1],
                        of[1].centre[2] - of[0].centre[2]};
  const mg_real one[3] = {2, 0, 2};
  mg_real u[3], v[3], a[3], x[3], y[3], z[3], rise[3], square[5] = {0}, b[5] = {0}, a2[5] = {0};
  mg_turned_radii(of, first, u, v);
  mg_angle_bernstein(-mg_dot3(v, c), mg_dot3(u, c), 0, a);
  mg_angle_bernstein(mg_dot3(u, u2), mg_dot3(v, u2), -mg_dot3(c, u2), x);
  mg_angle_bernstein(mg_dot3(u, v2), mg_dot3(v, v2), -mg_dot3(c, v2), y);
  mg_angle_bernstein(mg_dot3(u, n), mg_dot3(v, n), -mg_dot3(c, n), z);
  mg_angle_bernstein(mg_dot3(v, n), -mg_dot3(u, n), 0, rise);
  mg_add_bernstein_product(2, x, 2, x, 1, square), mg_add_bernstein_product(2, y, 2, y, 1, square);
  mg_add_bernstein_product(2, a, 2, one, 1, b), mg_add_bernstein_product(2, z, 2, rise, -1, b);
  mg_add_bernstein_product(2, a, 2, a, 1, a2);
  for (int k = 0; k <= MG_BERNSTEIN_DEGREE; k++) polynomial[k] = 0;
  mg_add_bernstein_product(4, a2, 4, square, 1, polynomial), mg_add_bernstein_product(4, b, 4, b, -R * R, polynomial);
  const mg_real large_a = mg_max_abs(3, a), large_x = mg_max_abs(3, x), large_y = mg_max_abs(3, y),
                large_b = 2 * large_a + mg_max_abs(3, z) * mg_max_abs(3, rise);
  return 32 * MG_EPS * (large_a * large_a * (large_x * large_x + large_y * large_y) + R * R * large_b * large_b);
}

/* Places of two circles, by the angle of the first one. Returns their number. `widest`: the widest interval of roots
   that almost coincide, rad. */
static int mg_places_by_first(const mg_centred_feature *of, mg_stationary_place *place, mg_real *widest) {
  mg_real polynomial[MG_BERNSTEIN_DEGREE + 1];
  mg_root_interval angle[MG_BERNSTEIN_ROOTS];
  int count = 0;
  *widest = 0;
  for (int half = 0; half < 2; half++) {
    const mg_real first = MG_FIRST_ANGLE + (mg_real)half * MG_PI, noise = mg_circles_polynomial(of, first, polynomial);
    const int roots = mg_add_angles(MG_BERNSTEIN_DEGREE, polynomial, noise, first, angle);
    for (int k = 0; k < roots; k++) {
      *widest = fmax(*widest, angle[k].high - angle[k].low);
      count = angle[k].low == angle[k].high ? mg_add_simple_place(of, angle[k].low, place, count)
                                            : mg_add_close_places(of, angle + k, place, count);
    }
  }
  return count;
}

/* Places of two circles. More than two roots that almost coincide belong to a part of the second circle that is
   about equally far from a point of the first, or to a curve of stationary places: then the angle of the second circle
   tells them apart. Returns the number of places. */
static int mg_circle_and_circle(const mg_centred_feature *of, mg_stationary_place *place) {
  const mg_centred_feature swapped[2] = {of[1], of[0]};
  mg_stationary_place more[MG_STATIONARY];
  mg_real widest, unused;
  int count = mg_places_by_first(of, place, &widest);
  if (!(widest > sqrt(sqrt(MG_EPS)))) return count;
  const int n = mg_places_by_first(swapped, more, &unused);
  for (int k = 0; k < n; k++) {
    const mg_real where[2] = {more[k].where[1], more[k].where[0]};
    count = mg_add_place(of, where, place, count);
  }
  return count;
}

MG_INTERNAL int mg_stationary_places(const mg_centred_feature *of, mg_stationary_place *place) {
  mg_real *where = place[0].where;
  place[0].regularity = 1;
  const int circle = of[0].curve.kind == MG_CENTRE_CIRCLE ? 0 : 1;
  const int count = of[circle].curve.kind == MG_CENTRE_LINE       ? mg_lines_nearest(of, of + 1, where)
                    : of[1 - circle].curve.kind == MG_CENTRE_LINE ? mg_circle_and_line(of, circle, place)
                                                                  : mg_circle_and_circle(of, place);
  if (count) return count;
  mg_real x[3];
  where[circle] = 0, mg_centre_point(of + circle, 0, x);
  if (of[1 - circle].curve.kind == MG_CENTRE_LINE) where[1 - circle] = mg_foot_on_line(of + 1 - circle, x);
  else {
    mg_real other[4];
    mg_angles_of_second(of, 0, other), where[1] = other[0];
  }
  return 0;
}
