/* Closest points of two convex shapes by the maximum of their separation s(n) = min over f of n.x - max over o of
   n.x over the sphere of normals n, by Newton's method in a trust region (Nocedal and Wright, Numerical
   Optimization, 2006, algorithm 4.1). Where s is positive, its maximum is unique and is the distance. */
#include "closest/closest.h"
#include "base/base.h"

#define MG_ASCENT_EVALUATIONS 200 /* most evaluations of one ascent */

#define MG_ASCENT_RESTARTS 6 /* most ascents, each from another normal */

/* Separation, slope and second derivative at v->normal. */
static void mg_evaluate_separation(const mg_shape_pair *p, mg_separation_view *v) {
  p->kernels->contact_seek(p->kind, p->pose_o, p->pose_f, v->normal, p->parameters, &v->d, v->slope, v->hessian,
                           v->tangents, v->eta);
}

/* Normal after a step delta in the tangents of the sphere. */
static void mg_move_normal(const mg_separation_view *from, const mg_real *delta, mg_separation_view *to) {
  const mg_real *t = from->tangents;
  for (int k = 0; k < 3; k++) to->normal[k] = from->normal[k] + delta[0] * t[k] + delta[1] * t[3 + k];
  mg_normalise3(to->normal);
}

/* Newton step, if it leads to a maximum within the radius. Returns the predicted gain, or -1. */
static mg_real mg_newton_normal_step(const mg_separation_view *v, mg_real radius, mg_real *delta) {
  const mg_real a = v->hessian[0], b = v->hessian[1], c = v->hessian[2], g = v->slope[0], h = v->slope[1];
  const mg_real scale = 1 / (a * c - b * b);
  delta[0] = (c * g - b * h) * scale, delta[1] = (a * h - b * g) * scale;
  const int inside = delta[0] * delta[0] + delta[1] * delta[1] <= radius * radius;
  return inside && a > 0 && scale > 0 ? (delta[0] * g + delta[1] * h) / 2 : -1;
}

/* Step along the slope, for a second derivative that is not finite. Returns the predicted gain. */
static mg_real mg_steepest_ascent_step(const mg_separation_view *v, mg_real radius, mg_real *delta) {
  const mg_real g = v->slope[0], h = v->slope[1], slope_norm = sqrt(g * g + h * h);
  delta[0] = radius * g / slope_norm, delta[1] = radius * h / slope_norm;
  return radius * slope_norm / 2;
}

/* Best step along one principal axis of curvature w, no longer than the radius; uphill where w <= 0. */
static mg_real mg_axis_step(mg_real slope, mg_real w, mg_real radius) {
  if (fabs(slope) <= w * radius) return w > 0 ? slope / w : 0;
  return slope > 0 ? radius : -radius;
}

/* Best step of the quadratic model within the radius along each of its principal axes. Returns the predicted gain. */
static mg_real mg_principal_axes_step(const mg_separation_view *v, mg_real radius, mg_real *delta) {
  const mg_real a = v->hessian[0], b = v->hessian[1], c = v->hessian[2], half = (a - c) / 2, mean = (a + c) / 2;
  const mg_real root = mean < 0 ? -sqrt(half * half + b * b) : sqrt(half * half + b * b), large = mean + root;
  if (!(fabs(large) <= MG_MAX)) return mg_steepest_ascent_step(v, radius, delta);
  const mg_real small = fabs(large) > 0 ? (a * c - b * b) / large : 0;
  const int first = (half < 0) == (root < 0);
  mg_real x = first ? half + root : b, y = first ? b : root - half;
  const mg_real length = sqrt(x * x + y * y);
  x = length > 0 ? x / length : 1, y = length > 0 ? y / length : 0;
  const mg_real g = x * v->slope[0] + y * v->slope[1], h = x * v->slope[1] - y * v->slope[0];
  const mg_real s = mg_axis_step(g, large, radius), t = mg_axis_step(h, small, radius);
  delta[0] = x * s - y * t, delta[1] = y * s + x * t;
  return s * (g - large * s / 2) + t * (h - small * t / 2);
}

/* Rounding error of the separation: from the size of the numbers of which it is the difference. */
static mg_real mg_separation_noise(const mg_shape_pair *p, const mg_separation_view *v) {
  mg_real size = 0;
  for (int k = 0; k < 3; k++) size += fabs(p->pose_o[k]) + fabs(p->pose_f[k]) + fabs(v->eta[k]) + fabs(v->eta[3 + k]);
  return 4 * MG_EPS * size;
}

/* True if quadratic convergence makes the step after two of lengths `before` and `length` smaller than rounding. */
static int mg_is_last_step(mg_real before, mg_real length) {
  return length <= sqrt(MG_EPS) / 20 || length * length * length <= before * before * (MG_EPS / 16);
}

/* Ascends from v->normal until rounding stops it. Returns 1 if v then is a maximum. Gains below the rounding error
   of the separation cannot be observed: Newton steps are then accepted as long as each is much smaller than the
   one before. */
static int mg_ascend(const mg_shape_pair *p, mg_separation_view *v) {
  mg_separation_view other, *at = v, *next = &other;
  mg_real radius = (mg_real)0.5, last = MG_MAX, before = 0, noise, delta[2];
  int found = 0;
  mg_evaluate_separation(p, at);
  noise = mg_separation_noise(p, at);
  for (int evaluations = 1; evaluations < MG_ASCENT_EVALUATIONS && !found; evaluations++) {
    mg_real gain = mg_newton_normal_step(at, radius, delta);
    if (!(gain >= 0)) gain = mg_principal_axes_step(at, radius, delta);
    const mg_real length = sqrt(delta[0] * delta[0] + delta[1] * delta[1]);
    const int is_below_noise = gain <= noise;
    if (!(gain >= 0 && length <= 4)) break;
    if ((found = is_below_noise && gain > last / 4)) break;
    last = is_below_noise ? gain : MG_MAX;
    mg_move_normal(at, delta, next);
    mg_evaluate_separation(p, next);
    const mg_real ratio = is_below_noise ? 1 : (next->d - at->d) / gain;
    if (!(ratio >= (mg_real)0.25)) radius = length / 4;
    if (ratio > (mg_real)0.75 && radius < 1) radius *= 2;
    if (!(ratio > (mg_real)0.05)) continue;
    mg_separation_view *const swap = at;
    at = next, next = swap;
    found = mg_is_last_step(before, length), before = length;
  }
  if (at != v) *v = *at;
  return found;
}

/* Direction away from all n of `peaks`; returns 0 if none is found. The maximum of a concave function that is
   positive somewhere lies in the half space opposite to every point at which it is negative. */
static int mg_direction_away_from(const mg_real *peaks, int n, mg_real *direction) {
  for (int k = 0; k < 3; k++) direction[k] = 0;
  for (int turn = -n; turn < 100; turn++) {
    mg_real most = -(mg_real)0.01;
    int worst = turn < 0 ? -1 - turn : -1;
    for (int i = 0; i < n && turn >= 0; i++) {
      const mg_real *peak = peaks + 3 * i;
      const mg_real along = peak[0] * direction[0] + peak[1] * direction[1] + peak[2] * direction[2];
      if (along > most) most = along, worst = i;
    }
    if (worst < 0) return 1;
    for (int k = 0; k < 3; k++) direction[k] -= (turn < 0 ? 1 : most + (mg_real)0.1) * peaks[3 * worst + k];
    if (turn >= -1 && !mg_normalise3(direction)) return 0;
  }
  return 0;
}

MG_INTERNAL int mg_maximise_separation(const mg_shape_pair *p, mg_real floor, int keep, mg_separation_view *v) {
  mg_real peaks[3 * MG_ASCENT_RESTARTS];
  mg_separation_view best = *v;
  int is_converged = 0;
  for (int i = 0; i < MG_ASCENT_RESTARTS; i++) {
    const int found = mg_ascend(p, v);
    if (i == 0 || v->d > floor || (!keep && v->d > best.d)) best = *v, is_converged = found;
    if (best.d > floor) break;
    for (int k = 0; k < 3; k++) peaks[3 * i + k] = v->normal[k];
    if (!mg_direction_away_from(peaks, i + 1, v->normal)) break;
  }
  *v = best;
  return is_converged;
}
