/* How far points are above the material of shapes, by formulas, or by samples of their surfaces. A solid is where all
   of its terms are negative, less the cavities of its body; a cavity has its material on the other side. Reads
   c->bodies. */
#include "solid/solid.h"
#include "base/base.h"

/* Distance of a point from the axis z. */
static mg_real mg_from_axis(const mg_real *x) { return mg_hypot(x[0], x[1]); }

/* Height over an ellipsoid with semi-axes a. */
static mg_real mg_over_ellipsoid(const mg_real *a, const mg_real *x, int how) {
  const mg_real y[3] = {x[0] / a[0], x[1] / a[1], x[2] / a[2]}, z[3] = {y[0] / a[0], y[1] / a[1], y[2] / a[2]},
                level = sqrt(mg_dot3(y, y)), slope = sqrt(mg_dot3(z, z)), least = mg_min(mg_min(a[0], a[1]), a[2]);
  return how == MG_LIPSCHITZ || !(slope > 0) ? (level - 1) * least : (level - 1) * level / slope;
}

/* Height over a superellipsoid ((|x/a|^p + |y/b|^p)^(q/p) + |z/c|^q = 1); numbers: a, b, c, p, q. */
static mg_real mg_over_superellipsoid(const mg_real *n, const mg_real *x, int how) {
  const mg_real least = mg_min(mg_min(n[0], n[1]), n[2]), p = n[3], q = n[4];
  mg_real y[3], largest = 0;
  for (int k = 0; k < 3; k++) y[k] = fabs(x[k]) / n[k], largest = mg_max(largest, y[k]);
  if (!(largest > 0)) return -least;
  for (int k = 0; k < 3; k++) y[k] /= largest;
  const mg_real flat = mg_pow(y[0], p) + mg_pow(y[1], p), sum = mg_pow(flat, q / p) + mg_pow(y[2], q),
                gauge = mg_pow(sum, 1 / q);
  if (how == MG_LIPSCHITZ) return (largest * gauge - 1) * least;
  const mg_real across = flat > 0 ? mg_pow(flat, q / p - 1) : 0;
  const mg_real gradient[3] = {across * mg_pow(y[0], p - 1) / n[0], across * mg_pow(y[1], p - 1) / n[1],
                               mg_pow(y[2], q - 1) / n[2]};
  return (largest * gauge - 1) / (sqrt(mg_dot3(gradient, gradient)) * gauge / sum);
}

/* Height over a paraboloid z = (x^2 / p + y^2 / q) / 2, whose material is below it; numbers: p, q. */
static mg_real mg_over_paraboloid(const mg_real *n, const mg_real *x, int how) {
  const mg_real u = x[0] / n[0], v = x[1] / n[1], above = x[2] - (u * x[0] + v * x[1]) / 2;
  return (how == MG_LIPSCHITZ ? (mg_real)0.5 : 1) * above / sqrt(1 + u * u + v * v);
}

/* Signed distance from a polygon in x, y, corners counterclockwise; numbers: x0, y0, x1, .. */
static mg_real mg_over_polygon(const mg_real *corner, int count, const mg_real *x) {
  mg_real least = MG_MAX;
  int is_inside = 0;
  for (int k = 0; k < count; k++) {
    const mg_real *from = corner + 2 * k, *to = corner + 2 * ((k + 1) % count);
    const mg_real side[2] = {to[0] - from[0], to[1] - from[1]}, arm[2] = {x[0] - from[0], x[1] - from[1]},
                  square = side[0] * side[0] + side[1] * side[1],
                  part = mg_max(mg_min((side[0] * arm[0] + side[1] * arm[1]) / square, (mg_real)1), (mg_real)0);
    least = mg_min(least, mg_hypot(arm[0] - part * side[0], arm[1] - part * side[1]));
    if ((arm[1] >= 0) != (arm[1] >= side[1]) && (side[0] * arm[1] - side[1] * arm[0] > 0) == (side[1] > 0))
      is_inside = !is_inside;
  }
  return is_inside ? -least : least;
}

/* Height over the material behind samples of a surface; numbers: as MG_TERM_SAMPLES has them. */
static mg_real mg_over_samples(const mg_real *n, int size, const mg_real *x) {
  mg_real least = MG_MAX, side = 0;
  for (int k = 1; k + 6 <= size; k += 6) {
    const mg_real arm[3] = {x[0] - n[k], x[1] - n[k + 1], x[2] - n[k + 2]}, square = mg_dot3(arm, arm);
    if (square < least) least = square, side = mg_dot3(arm, n + k + 3);
  }
  return (side < 0 ? -sqrt(least) : sqrt(least)) + n[0];
}

/* Height over one term at a point in the axes of the shape. */
static mg_real mg_over_term(const mg_system *s, int term, const mg_real *x, int how) {
  const mg_real *n = s->numbers + s->term_numbers[term];
  switch (s->term_kind[term]) {
    case MG_TERM_PLANE:
      return mg_dot3(n, x) - n[3];
    case MG_TERM_TURNED:
      return n[0] * mg_from_axis(x) + n[1] * x[2] - n[2];
    case MG_TERM_RING:
      return mg_hypot(mg_from_axis(x) - n[0], x[2] - n[2]) - n[1];
    case MG_TERM_CAPSULE:
      return mg_hypot(mg_from_axis(x), mg_max(fabs(x[2]) - n[1], (mg_real)0)) - n[0];
    case MG_TERM_ELLIPSOID:
      return mg_over_ellipsoid(n, x, how);
    case MG_TERM_SUPERELLIPSOID:
      return mg_over_superellipsoid(n, x, how);
    case MG_TERM_PARABOLOID:
      return mg_over_paraboloid(n, x, how);
    default:
      return mg_over_polygon(n, s->term_size[term] / 2, x);
  }
}

/* Height over the terms of a solid at a point in the axes of its body. */
static mg_real mg_over_terms(const mg_system *s, int solid, const mg_real *in_body, int how) {
  mg_real x[3], height = -MG_MAX;
  mg_world_to_local_point(s->numbers + s->solid_numbers[solid], in_body, x);
  const int first = s->solid_term[solid];
  if (s->term_kind[first] == MG_TERM_SAMPLES) /* the only one; its normals tell a cavity */
    return mg_over_samples(s->numbers + s->term_numbers[first], s->term_size[first], x);
  for (int term = s->solid_term[solid]; term < s->solid_term[solid + 1]; term++)
    height = mg_max(height, mg_over_term(s, term, x, how));
  return s->solid_is_cavity[solid] ? -height : height;
}

MG_INTERNAL mg_real mg_height_over_solid(const mg_system *s, int solid, const mg_real *pose, const mg_real *x,
                                         int how) {
  const int body = s->solid_body[solid];
  mg_real in_body[3];
  mg_world_to_local_point(pose, x, in_body);
  mg_real height = mg_over_terms(s, solid, in_body, how);
  for (int step = -1; step < 2; step += 2) /* solids of a body follow one another */
    for (int each = solid + step; each >= 0 && each < s->n_solid && s->solid_body[each] == body; each += step)
      if (s->solid_is_cavity[each]) height = mg_max(height, mg_over_terms(s, each, in_body, how));
  return height;
}

/* True if no cavity but a solid itself bounds its material. */
static int mg_has_no_other_cavity(const mg_system *s, int solid) {
  const int body = s->solid_body[solid];
  for (int step = -1; step < 2; step += 2) /* solids of a body follow one another */
    for (int each = solid + step; each >= 0 && each < s->n_solid && s->solid_body[each] == body; each += step)
      if (s->solid_is_cavity[each]) return 0;
  return 1;
}

/* True if the points at which a term is negative are convex. */
static int mg_is_term_convex(const mg_system *s, int term) {
  const mg_real *n = s->numbers + s->term_numbers[term];
  const int count = s->term_size[term] / 2;
  switch (s->term_kind[term]) {
    case MG_TERM_PLANE:
    case MG_TERM_CAPSULE:
    case MG_TERM_ELLIPSOID:
      return 1;
    case MG_TERM_TURNED:
      return n[0] >= 0;
    case MG_TERM_RING:
      return n[0] == 0;
    case MG_TERM_SUPERELLIPSOID:
      return n[3] >= 1 && n[4] >= 1;
    case MG_TERM_POLYGON:
      for (int k = 0; k < count; k++) {
        const mg_real *a = n + 2 * k, *b = n + 2 * ((k + 1) % count), *d = n + 2 * ((k + 2) % count);
        if ((b[0] - a[0]) * (d[1] - b[1]) - (b[1] - a[1]) * (d[0] - b[0]) < 0) return 0;
      }
      return 1;
    default:
      return 0;
  }
}

/* True if the points at which all terms of a solid are negative are convex. */
static int mg_are_terms_convex(const mg_system *s, int solid) {
  for (int term = s->solid_term[solid]; term < s->solid_term[solid + 1]; term++)
    if (!mg_is_term_convex(s, term)) return 0;
  return 1;
}

MG_INTERNAL int mg_is_solid_convex(const mg_system *s, int solid) {
  return !s->solid_is_cavity[solid] && mg_are_terms_convex(s, solid) && mg_has_no_other_cavity(s, solid);
}

MG_INTERNAL int mg_is_outside_convex(const mg_system *s, int solid) {
  const int term = s->solid_term[solid], kind = s->term_kind[term];
  const int is_outside = kind == MG_TERM_PLANE || kind == MG_TERM_PARABOLOID ||
                         (kind == MG_TERM_TURNED && s->numbers[s->term_numbers[term]] <= 0);
  return (s->solid_is_cavity[solid] ? mg_are_terms_convex(s, solid)
                                    : is_outside && s->solid_term[solid + 1] == term + 1) &&
         mg_has_no_other_cavity(s, solid);
}

MG_INTERNAL int mg_is_solid_ball(const mg_system *s, int solid) {
  const int term = s->solid_term[solid];
  return !s->solid_is_cavity[solid] && s->solid_term[solid + 1] == term + 1 && s->term_kind[term] == MG_TERM_RING &&
         s->numbers[s->term_numbers[term]] == 0 && mg_has_no_other_cavity(s, solid);
}

MG_INTERNAL int mg_is_material_known(const mg_context *c, int pair, int side) {
  return mg_solid_of_pair(c, pair, side) != MG_UNKNOWN_MATERIAL;
}

MG_INTERNAL int mg_has_material(const mg_context *c, int pair, int side) {
  return mg_solid_of_pair(c, pair, side) >= 0;
}

MG_INTERNAL mg_real mg_height_over_material(const mg_context *c, int pair, int side, const mg_real *x, int how) {
  MG_REQUIRE(mg_has_material(c, pair, side));
  MG_NEEDS_ANY(c, MG_VALID_POSES);
  const int solid = mg_solid_of_pair(c, pair, side);
  return mg_height_over_solid(c->system, solid, c->bodies.pose + 12 * c->system->solid_body[solid], x, how);
}
