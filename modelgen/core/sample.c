/* Both sides of a link sampled over their domains. */
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
    const mg_real *at = mg_side(c, link, side), *middle = at + MG_CENTRE;
    const mg_real arm = sqrt(mg_dot3(at, at)) + sqrt(mg_dot3(middle, middle));
    if (at[MG_BOUND] < MG_MAX / 2 && at[MG_BOUND] + arm > size) size = at[MG_BOUND] + arm;
  }
  return 2 * (distance + size);
}
