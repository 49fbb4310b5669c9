/* Critical points of the distance of features that lie at a constant distance from a straight line, a circle or a
   point, in closed form: a cylinder or a line (about a line), a torus or a circle (about a circle), a sphere. The line
   through the closest points of two such features is normal to both spines, whatever the radii, so that they
   follow from places on the spines at which their distance is stationary (spine_stationary_points.c).
   Where the distance is the same along a curve, as of coaxial features, no point is critical by itself; the gap there
   is noted instead (c->search.open_gap). World axes. */
#include "closest/closest.h"
#include "base/base.h"
#include "model/model.h"

/* Reads a feature that has a spine, and where that is. */
static void mg_read_centred_feature(const mg_context *c, int feature_pair, int side, mg_centred_feature *at) {
  const mg_real *pose = c->bodies.pose + 12 * mg_feature_body(c, feature_pair, side);
  mg_read_spine(c, feature_pair, side, &at->curve);
  mg_to_world(pose, mg_feature_numbers(c, feature_pair, side) + MG_FEATURE_PLACEMENT, 1, at->centre);
  mg_shape_rotation(c, feature_pair, side, at->axes);
}

/* The gap where points of the spines are `span` apart: the nearer sides face each other, and of a cavity the
   side towards which the other is off the centre. */
static mg_real mg_gap_at_spines(const mg_centred_feature *o, const mg_centred_feature *f, mg_real span) {
  return (o->curve.tube < 0 || f->curve.tube < 0 ? -span : span) - o->curve.tube - f->curve.tube;
}

/* Converges from the points that places on the spines stand for. Where that fails, or the critical point is one
   of a curve of them to rounding, its gap is noted. */
static void mg_converge_from_spines(mg_context *c, int feature_pair, const mg_centred_feature *of,
                                    const mg_stationary_place *place, const mg_search_limits *limits, mg_real least,
                                    mg_minima *kept) {
  const mg_real *where = place->where;
  mg_real at[2][3], normal[3], eta[6] = {0};
  mg_sample sample[2];
  for (int side = 0; side < 2; side++) mg_centre_point(of + side, where[side], at[side]);
  for (int k = 0; k < 3; k++) normal[k] = at[1][k] - at[0][k];
  const mg_real d = mg_gap_at_spines(of, of + 1, sqrt(mg_dot3(normal, normal)));
  if (d > limits->gap || d < -limits->depth) return;
  if (!mg_normalise3(normal) && !mg_normal_to_both(of, where, normal)) {
    mg_note_open_gap(c, d);
    return;
  }
  const mg_real sign = of[0].curve.tube < 0 || of[1].curve.tube < 0 ? -1 : 1;
  for (int k = 0; k < 3; k++)
    at[0][k] += sign * of[0].curve.tube * normal[k], at[1][k] -= sign * of[1].curve.tube * normal[k];
  for (int side = 0; side < 2; side++) {
    mg_real local[3];
    mg_point_in_shape_axes(c, feature_pair, side, at[side], local);
    mg_sample_about_spine(c, feature_pair, side, &of[side].curve, local, sample + side);
  }
  mg_start_eta(c, feature_pair, sample, sample + 1, eta);
  const int converged = mg_converge_from_any_start(c, feature_pair, eta) >= 0;
  const mg_real regularity = fmin(fabs(mg_placement_margin(c, c->system->n_contact)), place->regularity);
  if (!converged) mg_note_open_gap(c, d);
  else if (regularity <= mg_least_margin(c, feature_pair)) mg_note_singular_gap(c, feature_pair, d);
  if (converged) mg_keep_minimum_at(c, feature_pair, eta, least, kept);
}

MG_INTERNAL int mg_has_one_minimum(const mg_context *c, int feature_pair, mg_real gap) {
  mg_centred_feature of[2];
  if (!mg_has_spines(c, feature_pair)) return 0;
  for (int side = 0; side < 2; side++) {
    mg_read_centred_feature(c, feature_pair, side, of + side);
    if (of[side].curve.kind != MG_SPINE_CIRCLE || of[side].curve.tube < 0) return 0;
  }
  return mg_have_circles_one_minimum(of, gap);
}

MG_INTERNAL void mg_search_spines(mg_context *c, int feature_pair, const mg_search_limits *limits, mg_real least,
                                  mg_minima *kept) {
  mg_centred_feature of[2];
  mg_stationary_place place[MG_STATIONARY];
  for (int side = 0; side < 2; side++) mg_read_centred_feature(c, feature_pair, side, of + side);
  const int count = mg_stationary_places(of, limits->gap, place);
  if (count == MG_STATIONARY) mg_report_exceeded(c->run, MG_CAPACITY_STATIONARY);
  for (int k = 0; k < count; k++) mg_converge_from_spines(c, feature_pair, of, place + k, limits, least, kept);
  if (count || (of[0].curve.kind == MG_SPINE_CIRCLE && of[1].curve.kind == MG_SPINE_CIRCLE)) return;
  mg_note_singular_gap(c, feature_pair, mg_gap_at_spines(of, of + 1, mg_constant_distance(of)));
}
