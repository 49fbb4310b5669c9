/* Feature pairs: their features, their coordinates eta, and the conditions under which a contact stays on them,
   inequalities in the contact point, the normal and eta (MG_CONDITION_QUADRIC ..). */
#include "model/model.h"
#include "base/base.h"

MG_INTERNAL int mg_is_unconditional_feature_pair(const mg_context *c, int feature_pair) {
  return c->system->feature_pair_condition[feature_pair] == c->system->feature_pair_condition[feature_pair + 1];
}

MG_INTERNAL void mg_eta_scale(const mg_context *c, int feature_pair, mg_real length, mg_real *scale) {
  for (int side = 0; side < 2; side++) {
    const int parametrisation = mg_parametrisation(c, feature_pair, side), n = mg_parametrisation_size[parametrisation];
    const int coordinate_count =
        parametrisation == MG_CHART ? 2 : parametrisation == MG_CURVE || parametrisation == MG_SIGNED_CURVE;
    for (int k = 0; k < n; k++)
      *scale++ = k < coordinate_count          ? mg_feature_numbers(c, feature_pair, side)[MG_FEATURE_UV_SCALE + k]
                 : parametrisation == MG_LOCAL ? length
                                               : 1;
  }
}

MG_INTERNAL const mg_real *mg_feature_numbers(const mg_context *c, int feature_pair, int side) {
  MG_REQUIRE(feature_pair >= 0 && feature_pair < c->system->n_feature_pair && mg_has_features(c, feature_pair));
  return c->system->numbers + c->system->feature_numbers[2 * feature_pair + side];
}

MG_INTERNAL int mg_has_features(const mg_context *c, int feature_pair) {
  MG_REQUIRE(feature_pair >= 0 && feature_pair < c->system->n_feature_pair);
  return c->system->feature_shape[2 * feature_pair] >= 0;
}

MG_INTERNAL const mg_shape_kind *mg_shape_kind_of(const mg_context *c, int feature_pair, int side) {
  MG_REQUIRE(feature_pair >= 0 && feature_pair < c->system->n_feature_pair && mg_has_features(c, feature_pair));
  return c->kernels->shape_kinds + c->system->feature_shape[2 * feature_pair + side];
}

MG_INTERNAL int mg_feature_body(const mg_context *c, int feature_pair, int side) {
  MG_REQUIRE(feature_pair >= 0 && feature_pair < c->system->n_feature_pair);
  const mg_system *s = c->system;
  return mg_body_in_pair(c, s->feature_pair_owner[feature_pair],
                         side ? s->feature_pair_f[feature_pair] : s->feature_pair_o[feature_pair]);
}

MG_INTERNAL int mg_parametrisation(const mg_context *c, int feature_pair, int side) {
  MG_REQUIRE(feature_pair >= 0 && feature_pair < c->system->n_feature_pair);
  const mg_contact_kind *kind = c->kernels->contact_kinds + c->system->feature_pair_kind[feature_pair];
  return side ? kind->parametrisation_f : kind->parametrisation_o;
}

/* Transforms a direction from world axes to the axes of a feature's shape. */
static void mg_direction_in_shape_axes(const mg_context *c, int feature_pair, int side, const mg_real *world,
                                       mg_real *local) {
  mg_rotate_back(c->bodies.pose + 12 * mg_feature_body(c, feature_pair, side) + 3, world, local);
  mg_rotate_back(mg_feature_numbers(c, feature_pair, side) + MG_FEATURE_PLACEMENT + 3, local, local);
}

MG_INTERNAL void mg_point_in_shape_axes(const mg_context *c, int feature_pair, int side, const mg_real *world,
                                        mg_real *local) {
  const mg_real *pose = c->bodies.pose + 12 * mg_feature_body(c, feature_pair, side),
                *place = mg_feature_numbers(c, feature_pair, side) + MG_FEATURE_PLACEMENT;
  mg_real arm[3];
  for (int k = 0; k < 3; k++) arm[k] = world[k] - pose[k];
  mg_rotate_back(pose + 3, arm, arm);
  for (int k = 0; k < 3; k++) arm[k] -= place[k];
  mg_rotate_back(place + 3, arm, local);
}

/* Parameter of a curve at one of its points, if eta does not hold it: of a straight one how far the point is along it,
   by the rate at which its points move with the parameter, of a circle or ellipse the angle. */
static mg_real mg_curve_parameter_at(const mg_context *c, int feature_pair, int side, const mg_real *point) {
  const mg_real turns[2][2] = {{0, 0}, {2 * mg_atan((mg_real)1), 0}};
  const int shape = c->system->feature_shape[2 * feature_pair + side];
  const mg_real *parameters = c->system->parameters + c->system->feature_parameters[2 * feature_pair + side];
  mg_real x[3], y[3], T[3];
  c->kernels->shape_point(shape, turns[0], parameters, x, T);
  if (!(x[0] > 0)) return mg_dot3(T, point) / mg_dot3(T, T);
  c->kernels->shape_point(shape, turns[1], parameters, y, T);
  return mg_atan2(point[1] / y[1], point[0] / x[0]);
}

/* True if eta holds coordinates of the feature. */
static int mg_has_coordinates_in_eta(const mg_context *c, int feature_pair, int side) {
  const int parametrisation = mg_parametrisation(c, feature_pair, side);
  return parametrisation == MG_CHART || parametrisation == MG_CURVE || parametrisation == MG_SIGNED_CURVE;
}

/* Chart coordinates of a contact point on a feature. Where eta does not hold them, they are the first coordinates of
   the point, as for planes, or the parameter of the curve. */
static void mg_feature_coordinates(const mg_context *c, int feature_pair, int side, const mg_real *eta,
                                   const mg_real *point, mg_real *uv) {
  const mg_real *own = eta + (side ? mg_parametrisation_size[mg_parametrisation(c, feature_pair, 0)] : 0);
  uv[0] = mg_has_coordinates_in_eta(c, feature_pair, side) ? own[0]
          : mg_shape_kind_of(c, feature_pair, side)->dimension == 1
              ? mg_curve_parameter_at(c, feature_pair, side, point)
              : point[0];
  uv[1] = mg_parametrisation(c, feature_pair, side) == MG_CHART ? own[1] : point[1];
}

MG_INTERNAL const mg_real *mg_bounding_quadric(const mg_context *c, int side, int k) {
  const mg_system *s = c->system;
  return s->condition_feature[k] == side && s->condition_kind[k] == MG_CONDITION_QUADRIC &&
                 s->condition_feature_pair[k] != MG_BEYOND_WATCHED
             ? s->numbers + s->condition_numbers[k]
             : 0;
}

MG_INTERNAL mg_real mg_quadric_condition(const mg_real *a, const mg_real *x) {
  return a[0] + mg_dot3(a + 1, x) + a[4] * x[0] * x[0] + a[5] * x[1] * x[1] + a[6] * x[2] * x[2] + a[7] * x[0] * x[1] +
         a[8] * x[0] * x[2] + a[9] * x[1] * x[2];
}

/* The vector of an MG_CONDITION_WING, along a face at a point of its edge with coordinates uv. */
static void mg_wing(const mg_context *c, int feature_pair, int side, const mg_real *a, const mg_real *uv,
                    mg_real *wing) {
  const mg_system *s = c->system;
  mg_real point[3], T[3];
  c->kernels->shape_point(s->feature_shape[2 * feature_pair + side], uv,
                          s->parameters + s->feature_parameters[2 * feature_pair + side], point, T);
  const mg_real size = sqrt(mg_dot3(T, T));
  wing[0] = a[0] * T[1] / size, wing[1] = -a[0] * T[0] / size, wing[2] = a[1];
}

MG_INTERNAL mg_real mg_sine_between(const mg_real *a, const mg_real *b) {
  const mg_real cross[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  return sqrt(mg_dot3(cross, cross));
}

MG_INTERNAL int mg_is_within_border(const mg_context *c, int feature_pair, int side, const mg_real *x, mg_real slack) {
  const mg_system *s = c->system;
  for (int k = s->feature_pair_condition[feature_pair]; k < s->feature_pair_condition[feature_pair + 1]; k++) {
    const mg_real *quadric = mg_bounding_quadric(c, side, k);
    if (quadric && mg_quadric_condition(quadric, x) < -slack) return 0;
  }
  return 1;
}

/* True if a side of a feature pair is a sphere. */
static int mg_is_ball(const mg_context *c, int feature_pair, int side) {
  return mg_shape_kind_of(c, feature_pair, side)->nearest_point == MG_NEAREST_SPHERE;
}

/* How far the other feature is from coaxial with an axis in the axes of the body of a side: the distance of its origin
   over the characteristic length; of all but spheres at least the sine of the angle between the axes. */
static mg_real mg_off_axis(const mg_context *c, int feature_pair, int side, const mg_real *axis) {
  const mg_real *pose = c->bodies.pose + 12 * mg_feature_body(c, feature_pair, side),
                *other = c->bodies.pose + 12 * mg_feature_body(c, feature_pair, 1 - side),
                *place = mg_feature_numbers(c, feature_pair, 1 - side) + MG_FEATURE_PLACEMENT;
  mg_real arm[3], off[3];
  mg_to_world(other, place, 1, arm);
  for (int k = 0; k < 3; k++) arm[k] -= pose[k];
  mg_rotate_back(pose + 3, arm, arm);
  for (int k = 0; k < 3; k++) arm[k] -= axis[k];
  mg_cross_product(axis + 3, arm, off);
  const mg_real distance = sqrt(mg_dot3(off, off)) / c->system->length;
  if (mg_is_ball(c, feature_pair, 1 - side)) return distance;
  mg_to_world(other, place + 9, 0, arm), mg_rotate_back(pose + 3, arm, arm);
  return mg_max(distance, mg_sine_between(axis + 3, arm));
}

/* Value of an MG_CONDITION_COAXIAL of a side. */
static mg_real mg_coaxial_condition(const mg_context *c, int feature_pair, int side, const mg_real *a) {
  const mg_real limit = mg_is_ball(c, feature_pair, 1 - side) ? c->settings->search_margin : c->settings->flat_angle;
  return a[6] * (1 - mg_off_axis(c, feature_pair, side, a) / limit);
}

/* The number of the MG_CONDITION_COAXIAL of a feature pair, or -1. */
static int mg_coaxial_condition_of(const mg_context *c, int feature_pair) {
  const int end = c->system->feature_pair_condition[feature_pair + 1];
  for (int k = c->system->feature_pair_condition[feature_pair]; k < end; k++)
    if (c->system->condition_kind[k] == MG_CONDITION_COAXIAL) return k;
  return -1;
}

MG_INTERNAL int mg_is_almost_coaxial(const mg_context *c, int feature_pair) {
  const int k = mg_coaxial_condition_of(c, feature_pair);
  return k >= 0 && mg_off_axis(c, feature_pair, c->system->condition_feature[k],
                               c->system->numbers + c->system->condition_numbers[k]) < c->settings->margin_warn;
}

MG_INTERNAL int mg_is_handed_over_early(const mg_context *c, int feature_pair) {
  return mg_is_almost_coaxial(c, feature_pair) && !mg_is_ball(c, feature_pair, 0) && !mg_is_ball(c, feature_pair, 1);
}

MG_INTERNAL int mg_is_revolved(const mg_context *c, int feature_pair, int side) {
  const int k = mg_coaxial_condition_of(c, feature_pair);
  return k >= 0 && c->system->condition_feature[k] == side && mg_is_ball(c, feature_pair, 1 - side) &&
         c->system->numbers[c->system->condition_numbers[k] + 6] < 0;
}

MG_INTERNAL int mg_is_part_of_circle(const mg_context *c, int feature_pair) {
  const int k = mg_coaxial_condition_of(c, feature_pair);
  return k >= 0 && c->system->numbers[c->system->condition_numbers[k] + 6] > 0;
}

MG_INTERNAL mg_real mg_least_margin(const mg_context *c, int feature_pair) {
  return mg_is_almost_coaxial(c, feature_pair) ? 0 : c->settings->search_margin;
}

MG_INTERNAL int mg_is_replaced_coaxially(const mg_context *c, int feature_pair) {
  const int k = mg_coaxial_condition_of(c, feature_pair);
  return k >= 0 &&
         mg_coaxial_condition(c, feature_pair, c->system->condition_feature[k],
                              c->system->numbers + c->system->condition_numbers[k]) < -c->settings->feature_border;
}

/* Tilt of N, of an MG_CONDITION_TILT. */
static mg_real mg_tilt(const mg_real *a, const mg_real *N) {
  const mg_real sine = mg_sine_between(a, N);
  return a[4] > 0 && mg_dot3(a, N) < 0 ? 2 - sine : sine;
}

/* Contact point, normal out of the feature, and coordinates on one side of a feature pair, in the axes of its shape. */
typedef struct {
  int side;
  mg_real x[3], N[3], uv[2];
} mg_feature_view;

static void mg_view_feature(const mg_context *c, int feature_pair, int side, const mg_real *eta,
                            mg_feature_view *view) {
  view->side = side;
  mg_point_in_shape_axes(c, feature_pair, side, c->search.placement + (side ? 11 : 8), view->x);
  mg_direction_in_shape_axes(c, feature_pair, side, c->search.placement + 5, view->N);
  for (int i = 0; i < 3 && side; i++) view->N[i] = -view->N[i];
  mg_feature_coordinates(c, feature_pair, side, eta, view->x, view->uv);
}

/* Value of condition k at eta. The view is that of the condition before, or has no side: -1. */
static mg_real mg_condition_value(const mg_context *c, int feature_pair, int k, const mg_real *eta,
                                  mg_feature_view *view) {
  const mg_system *s = c->system;
  const mg_real *a = s->numbers + s->condition_numbers[k];
  const int side = s->condition_feature[k];
  mg_real wing[3];
  if (view->side != side) mg_view_feature(c, feature_pair, side, eta, view);
  switch (s->condition_kind[k]) {
    case MG_CONDITION_QUADRIC:
      return mg_quadric_condition(a, view->x) / s->length;
    case MG_CONDITION_PARAMETER:
      return a[1] * (view->uv[(int)a[0]] - a[2]) /
             mg_feature_numbers(c, feature_pair, side)[MG_FEATURE_UV_SCALE + (int)a[0]];
    case MG_CONDITION_DISC:
      return a[0] - (view->uv[0] * view->uv[0] + view->uv[1] * view->uv[1]) / a[0];
    case MG_CONDITION_WING:
      mg_wing(c, feature_pair, side, a, view->uv, wing);
      return -mg_dot3(wing, view->N);
    case MG_CONDITION_TILT:
      return a[3] * (mg_tilt(a, view->N) - c->settings->flat_angle);
    case MG_CONDITION_COAXIAL:
      return mg_coaxial_condition(c, feature_pair, side, a);
    case MG_CONDITION_TIP:
      return mg_dot3(a, view->N) - a[3];
    default:
      return -mg_dot3(a, view->N);
  }
}

MG_INTERNAL mg_real mg_feature_pair_condition(const mg_context *c, int feature_pair, int k, const mg_real *eta) {
  MG_NEEDS_PLACEMENT(c, feature_pair, eta);
  mg_feature_view view = {.side = -1};
  return mg_condition_value(c, feature_pair, k, eta, &view);
}

MG_INTERNAL int mg_leads_to_other_pair(const mg_context *c, int feature_pair, int condition) {
  const int to = c->system->condition_feature_pair[condition];
  return to >= 0 && c->system->feature_pair_owner[to] != c->system->feature_pair_owner[feature_pair];
}

/* True if a condition is one of those: MG_LEAVING .. . */
static int mg_is_condition_of(const mg_context *c, int condition, int those) {
  const int is_watched = c->system->condition_feature_pair[condition] == MG_BEYOND_WATCHED,
            ends_line = c->system->condition_is_line_end[condition];
  switch (those) {
    case MG_LEAVING:
      return !is_watched;
    case MG_LEAVING_ASIDE:
      return !is_watched && !ends_line;
    case MG_WATCHED:
      return is_watched;
    default:
      return is_watched || ends_line;
  }
}

MG_INTERNAL mg_real mg_least_feature_pair_condition(const mg_context *c, int feature_pair, const mg_real *eta,
                                                    int those, int *which) {
  MG_NEEDS_PLACEMENT(c, feature_pair, eta);
  mg_feature_view view = {.side = -1};
  mg_real least = MG_MAX;
  *which = -1;
  for (int k = c->system->feature_pair_condition[feature_pair]; k < c->system->feature_pair_condition[feature_pair + 1];
       k++) {
    if (!mg_is_condition_of(c, k, those)) continue;
    const int is_held = c->system->condition_is_line_end[k] && mg_is_time_stepping(c);
    const mg_real slack = is_held ? c->settings->parallel_angle : 0,
                  value = mg_condition_value(c, feature_pair, k, eta, &view) + slack;
    if (value < least) least = value, *which = k;
  }
  return least;
}

/* True if a condition bounds the normals at an edge or a vertex. */
static int mg_bounds_normal_cone(const mg_context *c, int condition) {
  const int kind = c->system->condition_kind[condition];
  return kind == MG_CONDITION_WING || kind == MG_CONDITION_DIRECTION || kind == MG_CONDITION_TIP;
}

/* True if a contact may be held a little beyond a condition of its feature pair, at the end of that line; -1: of any.
 */
static int mg_is_end_of_line(const mg_context *c, int condition, int line) {
  return c->system->condition_is_line_end[condition] &&
         (line < 0 || c->system->condition_feature_pair[condition] == line);
}

MG_INTERNAL int mg_ends_line(const mg_context *c, int feature_pair, int line) {
  for (int k = c->system->feature_pair_condition[feature_pair]; k < c->system->feature_pair_condition[feature_pair + 1];
       k++)
    if (mg_is_end_of_line(c, k, line)) return 1;
  return 0;
}

MG_INTERNAL mg_real mg_least_line_end_condition(const mg_context *c, int feature_pair, int line, const mg_real *eta) {
  MG_NEEDS_PLACEMENT(c, feature_pair, eta);
  mg_feature_view view = {.side = -1};
  mg_real least = MG_MAX;
  for (int k = c->system->feature_pair_condition[feature_pair]; k < c->system->feature_pair_condition[feature_pair + 1];
       k++)
    if (mg_is_end_of_line(c, k, line)) least = mg_min(least, mg_condition_value(c, feature_pair, k, eta, &view));
  return least;
}

MG_INTERNAL mg_real mg_most_violated_condition(const mg_context *c, int feature_pair, const mg_real *eta, int *which) {
  return mg_least_feature_pair_condition(c, feature_pair, eta, MG_LEAVING, which);
}

MG_INTERNAL int mg_is_tilted_beyond_watched(const mg_context *c, int feature_pair, const mg_real *eta) {
  MG_NEEDS_PLACEMENT(c, feature_pair, eta);
  int which;
  return mg_least_feature_pair_condition(c, feature_pair, eta, MG_WATCHED, &which) < -c->settings->appear_tilt_sine;
}

MG_INTERNAL int mg_has_normal_sign(const mg_context *c, int feature_pair) {
  return mg_parametrisation(c, feature_pair, 0) == MG_SIGN || mg_parametrisation(c, feature_pair, 1) == MG_SIGNED_CURVE;
}

MG_INTERNAL int mg_has_no_outside(const mg_context *c, int feature_pair) {
  const mg_system *s = c->system;
  for (int k = s->feature_pair_condition[feature_pair]; k < s->feature_pair_condition[feature_pair + 1]; k++)
    if (mg_bounds_normal_cone(c, k)) return 0;
  return 1;
}
