/* Starts of Newton's method on a feature pair: pairs of samples with small merit |P_f - P_o| + size * mismatch of
   the directions, at local minima over the grid of samples. Writes c->search. */
#include "closest/closest.h"
#include "base/base.h"
#include "model/model.h"

/* A plane or a sphere. */
typedef struct {
  mg_sample base;    /* its sample at (0, 0) */
  mg_real centre[3]; /* centre of a sphere, world axes, m */
  mg_real radius;    /* radius of a sphere, m; 0: a plane */
} mg_nearest_point_shape;

/* Deviation of two directions from opposite normals, or of a tangent and a normal from perpendicular; 0..2. */
static inline mg_real mg_direction_mismatch(const mg_sample *o, const mg_sample *f, int curves) {
  if (curves == 2) return 0;
  const mg_real cosine = mg_dot3(o->direction, f->direction);
  return curves == 0 ? 1 + cosine : fabs(cosine);
}

/* Distance of two samples. */
static inline mg_real mg_sample_distance(const mg_sample *a, const mg_sample *b) {
  const mg_real span[3] = {b->point[0] - a->point[0], b->point[1] - a->point[1], b->point[2] - a->point[2]};
  return sqrt(mg_dot3(span, span));
}

/* |P_f - P_o| + size * mismatch. */
static inline mg_real mg_sample_merit(const mg_sample *o, const mg_sample *f, int curves, mg_real size) {
  return mg_sample_distance(o, f) + size * mg_direction_mismatch(o, f, curves);
}

/* True if the nearest point of the feature to any point is known in closed form (plane, sphere), so that it needs
   no samples. */
static int mg_has_nearest_point(const mg_context *c, int feature_pair, int side) {
  const int parametrisation = mg_parametrisation(c, feature_pair, side);
  return c->kernels->shape_kinds[c->system->feature_shape[2 * feature_pair + side]].nearest_point &&
         (parametrisation == MG_NONE || parametrisation == MG_LOCAL);
}

/* Sets the plane or sphere of a feature at its present pose. */
static void mg_set_nearest_point_shape(mg_context *c, int feature_pair, int side, mg_nearest_point_shape *shape) {
  const mg_real zero[2] = {0, 0};
  mg_real arm[3], turned[3];
  mg_sample_at(c, feature_pair, side, zero, &shape->base);
  shape->radius = 0;
  if (c->kernels->shape_kinds[c->system->feature_shape[2 * feature_pair + side]].nearest_point == MG_NEAREST_PLANE)
    return;
  shape->radius = sqrt(mg_dot3(shape->base.local, shape->base.local));
  mg_to_world(mg_feature_numbers(c, feature_pair, side) + MG_FEATURE_PLACEMENT, shape->base.local, 0, arm);
  mg_to_world(c->bodies.pose + 12 * mg_feature_body(c, feature_pair, side), arm, 0, turned);
  for (int k = 0; k < 3; k++) shape->centre[k] = shape->base.point[k] - turned[k];
}

/* Point of a plane or sphere nearest to a point, without its coordinates in the axes of the shape. */
static void mg_find_nearest_point(const mg_nearest_point_shape *shape, const mg_real *point, mg_sample *nearest) {
  const mg_sample *base = &shape->base;
  mg_real span[3];
  *nearest = *base;
  if (shape->radius > 0) {
    for (int k = 0; k < 3; k++) span[k] = base->point[k] - shape->centre[k];
    const mg_real sign = mg_dot3(span, base->direction) < 0 ? -1 : 1;
    for (int k = 0; k < 3; k++) span[k] = point[k] - shape->centre[k];
    const mg_real distance = sqrt(mg_dot3(span, span));
    for (int k = 0; k < 3 && distance > 0; k++)
      nearest->direction[k] = sign * span[k] / distance,
      nearest->point[k] = shape->centre[k] + shape->radius * span[k] / distance;
  } else {
    for (int k = 0; k < 3; k++) span[k] = point[k] - base->point[k];
    const mg_real height = mg_dot3(span, base->direction);
    for (int k = 0; k < 3; k++) nearest->point[k] = point[k] - height * base->direction[k];
  }
}

/* Finds for each of n samples of the first feature the best of the samples of the other: merit and index. The
   partner of the sample before is tried first; samples are skipped that must be too far away, because neighbours
   are no farther apart than spacing_max. */
static void mg_match_nearest(mg_context *c, int n, int others, int curves, mg_real size) {
  const mg_sample *other = c->search.samples + MG_SAMPLES;
  mg_real spacing_max = 0;
  int partner = 0;
  for (int j = 1; j < others; j++) {
    const mg_real spacing = mg_sample_distance(other + j - 1, other + j);
    if (!(spacing <= spacing_max)) spacing_max = spacing;
  }
  for (int i = 0; i < n; i++) {
    const mg_sample *own = c->search.samples + i;
    mg_real best = mg_sample_merit(own, other + partner, curves, size);
    if (!(best <= MG_MAX)) best = MG_MAX;
    for (int j = 0; j < others; j++) {
      const mg_real apart = mg_sample_distance(own, other + j), passed = (apart - best) / spacing_max;
      if (passed >= others) break;
      if (passed >= 1) j += (int)passed - 1;
      if (passed >= 0) continue;
      const mg_real merit = apart + size * mg_direction_mismatch(own, other + j, curves);
      if (merit < best) best = merit, partner = j;
    }
    c->search.merit[i] = best, c->search.partner[i] = partner;
  }
}

/* The same if the nearest point of the other feature is known in closed form; size: extent of the samples. */
static void mg_match_nearest_points(mg_context *c, int feature_pair, int side, int n, int curves, mg_real size) {
  mg_nearest_point_shape shape;
  mg_set_nearest_point_shape(c, feature_pair, side, &shape);
  const mg_real width = 2 * shape.radius;
  if (width > 0 && (width < size || !(size > 0))) size = width;
  for (int i = 0; i < n; i++) {
    mg_find_nearest_point(&shape, c->search.samples[i].point, c->search.samples + MG_SAMPLES + i);
    c->search.partner[i] = i,
    c->search.merit[i] = mg_sample_merit(c->search.samples + i, c->search.samples + MG_SAMPLES + i, curves, size);
    if (!(c->search.merit[i] <= MG_MAX)) c->search.merit[i] = MG_MAX;
  }
}

/* True if no neighbour of sample i on the grid has a smaller merit. */
static int mg_is_local_minimum(const mg_context *c, int i, int n, int across) {
  const int row = i / across, column = i % across, rows = n / across;
  for (int a = -1; a <= 1; a++)
    for (int b = -1; b <= 1; b++) {
      const int p = row + a, q = column + b;
      if (p < 0 || q < 0 || p >= rows || q >= across) continue;
      if (c->search.merit[p * across + q] < c->search.merit[i]) return 0;
    }
  return 1;
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

/* Largest side of the box around n samples. */
static mg_real mg_sample_extent(const mg_context *c, int from, int n) {
  mg_real low[3], high[3], extent = 0;
  for (int k = 0; k < 3; k++) low[k] = MG_MAX, high[k] = -MG_MAX;
  for (int i = from; i < from + n; i++)
    for (int k = 0; k < 3; k++) {
      const mg_real x = c->search.samples[i].point[k];
      if (x < low[k]) low[k] = x;
      if (x > high[k]) high[k] = x;
    }
  for (int k = 0; k < 3; k++)
    if (high[k] - low[k] > extent) extent = high[k] - low[k];
  return extent;
}

/* Inserts a start in order of merit. */
static void mg_insert_start(mg_newton_starts *kept, mg_real merit, const mg_real *eta) {
  int at = kept->count < MG_STARTS ? kept->count++ : MG_STARTS;
  for (; at > 0 && kept->merit[at - 1] > merit; at--)
    if (at < MG_STARTS) {
      kept->merit[at] = kept->merit[at - 1];
      for (int k = 0; k < 6; k++) kept->eta[at][k] = kept->eta[at - 1][k];
    }
  if (at == MG_STARTS) return;
  kept->merit[at] = merit;
  for (int k = 0; k < 6; k++) kept->eta[at][k] = eta[k];
}

/* Samples both features within their windows and matches them. Returns the number of samples of the first feature,
   numbered `row`. */
static int mg_match_in_windows(mg_context *c, int feature_pair, int row, int has_nearest_point, int n,
                               mg_real window[2][4]) {
  const int curves = (mg_feature_dimension(c, feature_pair, 0) < 2) + (mg_feature_dimension(c, feature_pair, 1) < 2);
  const int rows = mg_sample_feature(c, feature_pair, row, window[row], n, c->search.samples);
  const mg_real own = mg_sample_extent(c, 0, rows);
  if (has_nearest_point) {
    mg_match_nearest_points(c, feature_pair, 1 - row, rows, curves, own);
    return rows;
  }
  const int others = mg_sample_feature(c, feature_pair, 1 - row, window[1 - row], n, c->search.samples + MG_SAMPLES);
  const mg_real size = mg_sample_extent(c, MG_SAMPLES, others);
  mg_match_nearest(c, rows, others, curves, own < size && own > 0 ? own : size > 0 ? size : own);
  return rows;
}

/* True if samples are as dense as after one refinement: along curves, or if the nearest point of the other feature
   is known. */
static int mg_are_samples_dense(const mg_context *c, int feature_pair, int has_nearest_point) {
  return has_nearest_point ||
         (mg_feature_dimension(c, feature_pair, 0) < 2 && mg_feature_dimension(c, feature_pair, 1) < 2);
}

/* True if a contact of the pair is on the feature pair already, with its points next to sample i and its partner. */
static int mg_is_known_start(mg_context *c, int feature_pair, int row, int i, int rows, int across) {
  const int pair = c->system->feature_pair_owner[feature_pair], beside = i + across < rows ? i + across : i - across;
  const mg_sample *own = c->search.samples + i, *partner = c->search.samples + MG_SAMPLES + c->search.partner[i];
  const mg_real near = beside >= 0 ? mg_sample_distance(own, c->search.samples + beside) : 0;
  mg_real next[6];
  for (int k = mg_pair_first_contact(c, pair); k < mg_pair_first_contact(c, pair + 1); k++) {
    if (!mg_is_on_feature_pair(c, k) || c->run->feature_pair[k] != feature_pair) continue;
    mg_place_contact(c, k, mg_contact_eta(c, c->run->x, k), next);
    const mg_real *points[2] = {c->search.placement + 8, c->search.placement + 11}, *p = points[row],
                  *q = points[1 - row];
    const mg_real a[3] = {own->point[0] - p[0], own->point[1] - p[1], own->point[2] - p[2]};
    const mg_real b[3] = {partner->point[0] - q[0], partner->point[1] - q[1], partner->point[2] - q[2]};
    if (mg_dot3(a, a) <= near * near && mg_dot3(b, b) <= 4 * near * near) return 1;
  }
  return 0;
}

MG_INTERNAL void mg_find_newton_starts(mg_context *c, int feature_pair, int n, int zooms, mg_newton_starts *kept) {
  const int row = mg_has_nearest_point(c, feature_pair, 0),
            has_nearest_point = row || mg_has_nearest_point(c, feature_pair, 1);
  const int across = mg_feature_dimension(c, feature_pair, row) != 2 ? 1 : has_nearest_point ? MG_GRID : n;
  mg_real window[2][4], eta[6] = {0};
  kept->count = 0;
  for (int side = 0; side < 2; side++)
    mg_sample_window(c, feature_pair, side, mg_search_radius(c, feature_pair), window[side]);
  for (int level = 0; level <= zooms; level++) {
    const int rows =
        mg_match_in_windows(c, feature_pair, row, has_nearest_point, has_nearest_point ? MG_GRID : n, window);
    int best = 0;
    for (int i = 0; i < rows; i++) {
      mg_sample *own = c->search.samples + i, *other = c->search.samples + MG_SAMPLES + c->search.partner[i];
      if (c->search.merit[i] < c->search.merit[best]) best = i;
      if (!mg_is_local_minimum(c, i, rows, across)) continue;
      if (has_nearest_point) mg_point_in_shape_axes(c, feature_pair, 1 - row, other->point, other->local);
      mg_start_eta(c, feature_pair, row ? other : own, row ? own : other, eta);
      mg_insert_start(kept, c->search.merit[i], eta);
    }
    if (mg_are_samples_dense(c, feature_pair, has_nearest_point) &&
        mg_is_known_start(c, feature_pair, row, best, rows, across))
      return;
    mg_shrink_window(window[row], c->search.samples[best].uv);
    mg_shrink_window(window[1 - row], c->search.samples[MG_SAMPLES + c->search.partner[best]].uv);
  }
}
