/* Where to start the search of closest points: both sides of a link sampled, the likeliest pairs of samples. */
#include "core.h"

static int mg_dimension(const mg_context *c, int link, int side) {
  return mg_shape_kinds[c->sys->side_shape[2 * link + side]].dimension;
}

static void mg_out(const mg_real *pose, const mg_real *x, int is_point, mg_real *out) {
  for (int k = 0; k < 3; k++)
    out[k] = is_point * pose[k] + pose[3 + k] * x[0] + pose[6 + k] * x[1] + pose[9 + k] * x[2];
}

/* The sample at uv; a direction of length 0 where the shape has none there. */
static void mg_sample_at(mg_context *c, int link, int side, const mg_real *uv, mg_sample *at) {
  const mg_system *s = c->sys;
  const mg_real *place = mg_side(c, link, side) + MG_PLACEMENT;
  const mg_real *pose = c->pose + 12 * mg_side_body(c, link, side);
  mg_real direction[3] = {0, 0, 0}, x[3];
  mg_shape_point(s->side_shape[2 * link + side], uv, s->parameters + s->side_parameters[2 * link + side], at->local,
                 direction);
  const mg_real size = sqrt(mg_dot3(direction, direction));
  for (int k = 0; k < 3; k++) direction[k] = size > 0 && size < MG_MAX ? direction[k] / size : 0;
  mg_out(place, at->local, 1, x), mg_out(pose, x, 1, at->point);
  mg_out(place, direction, 0, x), mg_out(pose, x, 0, at->direction);
  at->uv[0] = uv[0], at->uv[1] = uv[1];
}

/* The parameter at which a curve without ends is farther than `reach` on both sides. */
static mg_real mg_far_along(mg_context *c, int link, int side, mg_real reach) {
  const mg_system *s = c->sys;
  const mg_real *parameters = s->parameters + s->side_parameters[2 * link + side], zero[2] = {0, 0};
  mg_real x[3], T[3];
  mg_shape_point(s->side_shape[2 * link + side], zero, parameters, x, T);
  mg_real far = reach / sqrt(mg_dot3(T, T));
  for (int doubling = 0; doubling < 30; doubling++, far *= 2) {
    const mg_real ends[2][2] = {{-far, 0}, {far, 0}};
    int outside = 0;
    for (int end = 0; end < 2; end++) {
      mg_shape_point(s->side_shape[2 * link + side], ends[end], parameters, x, T);
      outside += mg_dot3(x, x) >= reach * reach;
    }
    if (outside == 2) break;
  }
  return far;
}

/* The bounds (u0, u1, v0, v1) to sample a side within; where it has none, cut at `reach`. */
static void mg_window(mg_context *c, int link, int side, mg_real reach, mg_real *window) {
  const mg_real *domain = mg_side(c, link, side) + MG_DOMAIN;
  for (int k = 0; k < 4; k++) window[k] = domain[k];
  const int endless = fabs(domain[0]) >= MG_MAX / 2 || fabs(domain[1]) >= MG_MAX / 2;
  const mg_real far = endless && mg_dimension(c, link, side) == 1 ? mg_far_along(c, link, side, reach) : reach;
  for (int k = 0; k < 4; k++)
    if (fabs(domain[k]) >= MG_MAX / 2) window[k] = k % 2 ? far : -far;
}

/* A grid of n by n samples over the window, as many along a curve, one of a point. */
static int mg_sample_side(mg_context *c, int link, int side, const mg_real *window, int n, mg_sample *out) {
  const int dimension = mg_dimension(c, link, side), along = dimension == 2 ? n : dimension ? n * n : 1;
  const int across = dimension == 2 ? n : 1;
  int count = 0;
  for (int i = 0; i < along; i++)
    for (int j = 0; j < across; j++) {
      const mg_real p = along > 1 ? (mg_real)i / (along - 1) : 0, q = across > 1 ? (mg_real)j / (across - 1) : 0;
      const mg_real uv[2] = {window[0] + p * (window[1] - window[0]), window[2] + q * (window[3] - window[2])};
      mg_sample_at(c, link, side, uv, out + count++);
    }
  return count;
}

/* |P_f - P_o| + size (how far the directions are from opposed normals, or from tangent and normal at right
   angles). */
static mg_real mg_merit(const mg_sample *o, const mg_sample *f, int curves, mg_real size) {
  const mg_real span[3] = {f->point[0] - o->point[0], f->point[1] - o->point[1], f->point[2] - o->point[2]};
  const mg_real cosine = mg_dot3(o->direction, f->direction);
  const mg_real tilt = curves == 0 ? 1 + cosine : curves == 1 ? fabs(cosine) : 0;
  return sqrt(mg_dot3(span, span)) + size * tilt;
}

/* For each sample of o the best of f: its merit and index. */
static void mg_match(mg_context *c, int n_o, int n_f, int curves, mg_real size) {
  for (int i = 0; i < n_o; i++) {
    c->merit[i] = MG_MAX, c->mate[i] = 0;
    for (int j = 0; j < n_f; j++) {
      const mg_real merit = mg_merit(c->sample + i, c->sample + MG_SAMPLES + j, curves, size);
      if (merit < c->merit[i]) c->merit[i] = merit, c->mate[i] = j;
    }
  }
}

/* True if no neighbour of sample i on the grid of o has a smaller merit. */
static int mg_is_lowest(const mg_context *c, int i, int n_o, int across) {
  const int row = i / across, column = i % across, rows = n_o / across;
  for (int a = -1; a <= 1; a++)
    for (int b = -1; b <= 1; b++) {
      const int p = row + a, q = column + b;
      if (p < 0 || q < 0 || p >= rows || q >= across) continue;
      if (c->merit[p * across + q] < c->merit[i]) return 0;
    }
  return 1;
}

static void mg_start_eta(const mg_context *c, int link, const mg_sample *o, const mg_sample *f, mg_real *eta) {
  for (int side = 0; side < 2; side++) {
    const mg_sample *at = side ? f : o;
    switch (mg_carrier(c, link, side)) {
      case MG_LOCAL: for (int k = 0; k < 3; k++) *eta++ = at->local[k]; break;
      case MG_CHART: *eta++ = at->uv[0], *eta++ = at->uv[1]; break;
      case MG_CURVE: *eta++ = at->uv[0]; break;
      case MG_SIGNED_CURVE: *eta++ = at->uv[0], *eta++ = 1, *eta++ = 1; break;
      case MG_SIGN: *eta++ = 1; break;
      default: break;
    }
  }
}

static mg_real mg_extent_of(const mg_context *c, int from, int n) {
  mg_real low[3], high[3], extent = 0;
  for (int k = 0; k < 3; k++) low[k] = MG_MAX, high[k] = -MG_MAX;
  for (int i = from; i < from + n; i++)
    for (int k = 0; k < 3; k++) {
      const mg_real x = c->sample[i].point[k];
      if (x < low[k]) low[k] = x;
      if (x > high[k]) high[k] = x;
    }
  for (int k = 0; k < 3; k++)
    if (high[k] - low[k] > extent) extent = high[k] - low[k];
  return extent;
}

static void mg_zoom(mg_real *window, const mg_real *centre) {
  for (int k = 0; k < 2; k++) {
    const mg_real half = (window[2 * k + 1] - window[2 * k]) / 10;
    window[2 * k] = centre[k] - half, window[2 * k + 1] = centre[k] + half;
  }
}

static mg_real mg_reach_of(mg_context *c, int link) {
  const mg_real *o = c->pose + 12 * mg_side_body(c, link, 0), *f = c->pose + 12 * mg_side_body(c, link, 1);
  const mg_real apart[3] = {f[0] - o[0], f[1] - o[1], f[2] - o[2]}, distance = sqrt(mg_dot3(apart, apart));
  mg_real size = distance / 1000;
  for (int side = 0; side < 2; side++) {
    const mg_real *at = mg_side(c, link, side), arm = sqrt(mg_dot3(at, at));
    if (at[MG_BOUND] < MG_MAX / 2 && at[MG_BOUND] + arm > size) size = at[MG_BOUND] + arm;
  }
  return 2 * (distance + size);
}

/* Inserts into the MG_STARTS starts kept in order of merit. */
static void mg_keep_start(mg_starts *kept, mg_real merit, const mg_real *eta) {
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

/* Likely starts on a link from n by n samples a side, `zooms` times again around the best. */
static void mg_find_starts(mg_context *c, int link, int n, int zooms, mg_starts *kept) {
  mg_real window[2][4], eta[6] = {0};
  const int curves = (mg_dimension(c, link, 0) < 2) + (mg_dimension(c, link, 1) < 2);
  const int across = mg_dimension(c, link, 0) == 2 ? n : 1;
  kept->count = 0;
  for (int side = 0; side < 2; side++) mg_window(c, link, side, mg_reach_of(c, link), window[side]);
  for (int level = 0; level <= zooms; level++) {
    const int n_o = mg_sample_side(c, link, 0, window[0], n, c->sample);
    const int n_f = mg_sample_side(c, link, 1, window[1], n, c->sample + MG_SAMPLES);
    const mg_real size_o = mg_extent_of(c, 0, n_o), size_f = mg_extent_of(c, MG_SAMPLES, n_f);
    int best = 0;
    mg_match(c, n_o, n_f, curves, size_o < size_f && size_o > 0 ? size_o : size_f > 0 ? size_f : size_o);
    for (int i = 0; i < n_o; i++) {
      if (c->merit[i] < c->merit[best]) best = i;
      if (!mg_is_lowest(c, i, n_o, across)) continue;
      mg_start_eta(c, link, c->sample + i, c->sample + MG_SAMPLES + c->mate[i], eta);
      mg_keep_start(kept, c->merit[i], eta);
    }
    mg_zoom(window[0], c->sample[best].uv), mg_zoom(window[1], c->sample[MG_SAMPLES + c->mate[best]].uv);
  }
}
