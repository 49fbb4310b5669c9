/* Features that lie at a constant distance from a straight line, a circle or a point, their spine: cylinders and
   lines (about a line), tori and circles (about a circle), spheres (about a point). */
#include "closest/closest.h"
#include "base/base.h"
#include "model/model.h"

/* Spine of the feature of a side: MG_SPINE_LINE .., or 0. */
static int mg_spine_kind(const mg_context *c, int feature_pair, int side) {
  return mg_shape_kind_of(c, feature_pair, side)->spine;
}

MG_INTERNAL int mg_lie_about_spines(const mg_context *c, int feature_pair) {
  return mg_has_features(c, feature_pair) && mg_spine_kind(c, feature_pair, 0) && mg_spine_kind(c, feature_pair, 1);
}

MG_INTERNAL int mg_has_spines(const mg_context *c, int feature_pair) {
  if (mg_parametrisation(c, feature_pair, 1) == MG_NONE) return 0; /* as of two straight lines */
  return mg_lie_about_spines(c, feature_pair) &&
         !(mg_spine_kind(c, feature_pair, 0) == MG_SPINE_POINT && mg_spine_kind(c, feature_pair, 1) == MG_SPINE_POINT);
}

MG_INTERNAL int mg_is_about_spine(const mg_context *c, int feature_pair, int side) {
  const mg_shape_kind *kind = mg_shape_kind_of(c, feature_pair, side);
  return kind->spine && kind->spine != MG_SPINE_POINT && kind->dimension == 2;
}

MG_INTERNAL void mg_read_spine(const mg_context *c, int feature_pair, int side, mg_spine *at) {
  const mg_system *s = c->system;
  const int shape = s->feature_shape[2 * feature_pair + side];
  const mg_real *parameters = s->parameters + s->feature_parameters[2 * feature_pair + side];
  const mg_real outer[2] = {0, 0}, inner[2] = {0, MG_PI};
  mg_real x[3], n[3], across[3], unused[3];
  at->kind = c->kernels->shape_kinds[shape].spine, at->radius = at->tube = 0;
  at->coordinate = at->kind == MG_SPINE_LINE && c->kernels->shape_kinds[shape].dimension == 2;
  c->kernels->shape_point(shape, outer, parameters, x, n);
  if (c->kernels->shape_kinds[shape].dimension == 2) {
    mg_normalise3(n);
    if (at->kind == MG_SPINE_CIRCLE) {
      c->kernels->shape_point(shape, inner, parameters, across, unused);
      at->radius = (x[0] + across[0]) / 2;
    }
    at->tube = (x[0] - at->radius) * n[0];
  } else if (at->kind == MG_SPINE_CIRCLE) at->radius = x[0];
}

MG_INTERNAL void mg_foot_on_spine(const mg_spine *curve, const mg_real *x, mg_real *foot) {
  const mg_real across = sqrt(x[0] * x[0] + x[1] * x[1]);
  for (int k = 0; k < 2; k++)
    foot[k] = curve->kind == MG_SPINE_LINE || !(across > 0) ? 0 : curve->radius / across * x[k];
  foot[2] = curve->kind == MG_SPINE_LINE ? x[2] : 0;
}

MG_INTERNAL void mg_critical_point_on_spine(const mg_spine *curve, const mg_real *x, const mg_real *near,
                                            mg_real *point) {
  mg_foot_on_spine(curve, x, point);
  if (curve->kind == MG_SPINE_CIRCLE && mg_dot3(point, near) < 0)
    for (int k = 0; k < 3; k++) point[k] = -point[k];
}

MG_INTERNAL void mg_sample_about_spine(const mg_context *c, int feature_pair, int side, const mg_spine *curve,
                                       const mg_real *local, mg_sample *sample) {
  const mg_real *x = local, azimuth = mg_atan2(x[1], x[0]);
  const int is_curve = mg_feature_dimension(c, feature_pair, side) == 1;
  for (int k = 0; k < 3; k++) sample->local[k] = x[k], sample->direction[k] = 0;
  if (curve->kind == MG_SPINE_LINE) sample->uv[0] = is_curve ? x[2] : azimuth, sample->uv[1] = x[2];
  else
    sample->uv[0] = azimuth,
    sample->uv[1] = is_curve ? 0 : mg_atan2(x[2], sqrt(x[0] * x[0] + x[1] * x[1]) - curve->radius);
}
