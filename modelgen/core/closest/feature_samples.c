/* Samples of a feature over a part of its domain. Writes c->search. */
#include "closest/closest.h"
#include "base/base.h"
#include "model/model.h"

#define MG_SAMPLE_SIZE 9 /* numbers of a sample: point in shape and body axes, direction in body axes */

MG_INTERNAL int mg_feature_dimension(const mg_context *c, int feature_pair, int side) {
  return mg_shape_kind_of(c, feature_pair, side)->dimension;
}

/* Sample of a feature at uv (MG_SAMPLE_SIZE numbers): point in the axes of the shape, point in the axes of the
   body, direction in the axes of the body, of length 0 where there is none. */
static void mg_sample_in_body(mg_context *c, int feature_pair, int side, const mg_real *uv, mg_real *in) {
  const mg_system *s = c->system;
  const mg_real *place = mg_feature_numbers(c, feature_pair, side) + MG_FEATURE_PLACEMENT;
  mg_real direction[3] = {0, 0, 0};
  c->kernels->shape_point(s->feature_shape[2 * feature_pair + side], uv,
                          s->parameters + s->feature_parameters[2 * feature_pair + side], in, direction);
  const mg_real size = sqrt(mg_dot3(direction, direction));
  for (int k = 0; k < 3; k++) direction[k] = size > 0 && size < MG_MAX ? direction[k] / size : 0;
  mg_to_world(place, in, 1, in + 3), mg_to_world(place, direction, 0, in + 6);
}

/* Transforms a stored sample to world axes. */
static void mg_sample_to_world(const mg_real *pose, const mg_real *uv, const mg_real *in, mg_sample *at) {
  for (int k = 0; k < 3; k++) at->local[k] = in[k];
  mg_to_world(pose, in + 3, 1, at->point), mg_to_world(pose, in + 6, 0, at->direction);
  at->uv[0] = uv[0], at->uv[1] = uv[1];
}

MG_INTERNAL void mg_sample_at(mg_context *c, int feature_pair, int side, const mg_real *uv, mg_sample *at) {
  mg_real in[MG_SAMPLE_SIZE];
  mg_sample_in_body(c, feature_pair, side, uv, in);
  mg_sample_to_world(c->bodies.pose + 12 * mg_feature_body(c, feature_pair, side), uv, in, at);
}

/* Parameter at which both ends of an unbounded curve are farther than `reach` from its origin. */
static mg_real mg_parameter_beyond(mg_context *c, int feature_pair, int side, mg_real reach) {
  const mg_system *s = c->system;
  const mg_real *parameters = s->parameters + s->feature_parameters[2 * feature_pair + side], zero[2] = {0, 0};
  mg_real x[3], T[3];
  c->kernels->shape_point(s->feature_shape[2 * feature_pair + side], zero, parameters, x, T);
  mg_real bound = reach / sqrt(mg_dot3(T, T));
  for (int doubling = 0; doubling < 30; doubling++, bound *= 2) {
    const mg_real ends[2][2] = {{-bound, 0}, {bound, 0}};
    int outside = 0;
    for (int end = 0; end < 2; end++) {
      c->kernels->shape_point(s->feature_shape[2 * feature_pair + side], ends[end], parameters, x, T);
      outside += mg_dot3(x, x) >= reach * reach;
    }
    if (outside == 2) break;
  }
  return bound;
}

MG_INTERNAL void mg_sample_window(mg_context *c, int feature_pair, int side, mg_real reach, mg_real *window) {
  const mg_real *domain = mg_feature_numbers(c, feature_pair, side) + MG_FEATURE_DOMAIN;
  for (int k = 0; k < 4; k++) window[k] = domain[k];
  const int endless = fabs(domain[0]) >= MG_MAX / 2 || fabs(domain[1]) >= MG_MAX / 2;
  const mg_real bound = endless && mg_feature_dimension(c, feature_pair, side) == 1
                            ? mg_parameter_beyond(c, feature_pair, side, reach)
                            : reach;
  for (int k = 0; k < 4; k++)
    if (fabs(domain[k]) >= MG_MAX / 2) window[k] = k % 2 ? bound : -bound;
}

MG_INTERNAL int mg_sample_feature(mg_context *c, int feature_pair, int side, const mg_real *window, int n,
                                  mg_sample *out) {
  const int dimension = mg_feature_dimension(c, feature_pair, side), along = dimension == 2 ? n : dimension ? n * n : 1;
  const int across = dimension == 2 ? n : 1;
  const mg_real *pose = c->bodies.pose + 12 * mg_feature_body(c, feature_pair, side);
  int count = 0;
  mg_real in[MG_SAMPLE_SIZE];
  for (int i = 0; i < along; i++)
    for (int j = 0; j < across; j++) {
      const mg_real p = along > 1 ? (mg_real)i / (mg_real)(along - 1) : 0,
                    q = across > 1 ? (mg_real)j / (mg_real)(across - 1) : 0;
      const mg_real uv[2] = {window[0] + p * (window[1] - window[0]), window[2] + q * (window[3] - window[2])};
      mg_sample_in_body(c, feature_pair, side, uv, in);
      mg_sample_to_world(pose, uv, in, out + count++);
    }
  return count;
}

MG_INTERNAL void mg_shrink_window(mg_real *window, const mg_real *centre) {
  for (int k = 0; k < 2; k++) {
    const mg_real half = (window[2 * k + 1] - window[2 * k]) / 10;
    window[2 * k] = centre[k] - half, window[2 * k + 1] = centre[k] + half;
  }
}

MG_INTERNAL mg_real mg_distance_from(const mg_context *c, int body, const mg_real *x, const mg_real *from) {
  mg_real at[3];
  mg_to_world(c->bodies.pose + 12 * body, x, 1, at);
  for (int k = 0; k < 3; k++) at[k] -= from[k];
  return sqrt(mg_dot3(at, at));
}

MG_INTERNAL mg_real mg_search_radius(mg_context *c, int feature_pair, int side) {
  const int pair = c->system->feature_pair_owner[feature_pair], first = c->system->pair_feature_pair[pair];
  mg_real origin[3], radius = MG_MAX;
  mg_to_world(c->bodies.pose + 12 * mg_feature_body(c, feature_pair, side), mg_feature_numbers(c, feature_pair, side),
              1, origin);
  for (int which = 0; which < 2; which++) {
    const mg_real *ball = mg_pair_ball(c, pair, which);
    if (ball[3] >= 0)
      radius = mg_min(radius, mg_distance_from(c, mg_feature_body(c, first, which), ball, origin) + ball[3]);
  }
  if (!(radius < MG_MAX))
    radius = mg_distance_from(c, mg_feature_body(c, feature_pair, 1 - side),
                              mg_feature_numbers(c, feature_pair, 1 - side), origin) +
             c->system->length;
  return 2 * radius;
}

MG_INTERNAL int mg_has_nearest_point(const mg_context *c, int feature_pair, int side) {
  const int parametrisation = mg_parametrisation(c, feature_pair, side);
  const mg_shape_kind *kind = mg_shape_kind_of(c, feature_pair, side);
  return kind->dimension == 0 || (kind->nearest_point && (parametrisation == MG_NONE || parametrisation == MG_LOCAL));
}

MG_INTERNAL void mg_start_eta(const mg_context *c, int feature_pair, const mg_sample *o, const mg_sample *f,
                              mg_real *eta) {
  for (int side = 0; side < 2; side++) {
    const mg_sample *at = side ? f : o;
    switch (mg_parametrisation(c, feature_pair, side)) {
      case MG_LOCAL:
        for (int k = 0; k < 3; k++) *eta++ = at->local[k];
        break;
      case MG_CHART:
        *eta++ = at->uv[0], *eta++ = at->uv[1];
        break;
      case MG_CURVE:
        *eta++ = at->uv[0];
        break;
      case MG_SIGNED_CURVE:
        *eta++ = at->uv[0], *eta++ = 1, *eta++ = 1;
        break;
      case MG_SIGN:
        *eta++ = 1;
        break;
      default:
        break;
    }
  }
}

MG_INTERNAL void mg_shape_rotation(const mg_context *c, int feature_pair, int side, mg_real *R) {
  const mg_real *place = mg_feature_numbers(c, feature_pair, side) + MG_FEATURE_PLACEMENT,
                *pose = c->bodies.pose + 12 * mg_feature_body(c, feature_pair, side);
  for (int k = 0; k < 3; k++) mg_to_world(pose, place + 3 + 3 * k, 0, R + 3 * k);
}
