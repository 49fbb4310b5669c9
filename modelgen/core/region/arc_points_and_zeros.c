/* Points and tangents of a placed arc of a boundary, and zeros of functions along it: of curvature, of the support in a
   direction, of the distance to a point. */
#include "region/region.h"
#include "base/base.h"

MG_INTERNAL void mg_arc_point(const mg_placed_arc *k, mg_real t, mg_real *point, mg_real *tangent) {
  const mg_real uv[2] = {t, 0};
  const mg_real *a = k->axis;
  mg_real x[3], d[3];
  k->kernels->shape_point(k->shape, uv, k->parameters, x, d);
  point[0] = k->at[0] + (a[0] * x[0] + a[2] * x[1] + a[4] * x[2]);
  point[1] = k->at[1] + (a[1] * x[0] + a[3] * x[1] + a[5] * x[2]);
  tangent[0] = a[0] * d[0] + a[2] * d[1] + a[4] * d[2];
  tangent[1] = a[1] * d[0] + a[3] * d[1] + a[5] * d[2];
}

MG_INTERNAL mg_real mg_zero_function(const mg_placed_arc *k, int sought, const mg_real *v, mg_real t) {
  mg_real x[2], T[2], E[2];
  if (sought == MG_ZERO_CURVATURE) {
    const mg_real step = (k->t1 - k->t0) / 4096;
    mg_arc_point(k, mg_max(t - step, k->t0), x, T), mg_arc_point(k, mg_min(t + step, k->t1), x, E);
    return mg_cross2(T, E);
  }
  mg_arc_point(k, t, x, T);
  const mg_real arm[2] = {x[0] - v[0], x[1] - v[1]};
  return sought == MG_ZERO_SUPPORT ? mg_dot2(v, T) : mg_dot2(arm, T);
}

MG_INTERNAL mg_real mg_zero_on_arc(const mg_placed_arc *k, int sought, const mg_real *v, mg_real a, mg_real b) {
  mg_real fa = mg_zero_function(k, sought, v, a), fb = mg_zero_function(k, sought, v, b), t = b;
  if (sought == MG_ZERO_NEAREST && !(fa < 0 && fb > 0)) return fa + fb > 0 ? a : b;
  if (fa == 0 || fb == 0 || (fa > 0) == (fb > 0)) return fabs(fa) < fabs(fb) ? a : b;
  const mg_real least = MG_EPS * (fabs(a) + fabs(b));
  for (int i = 1; i < 100 && fabs(b - a) > least; i++) {
    const int halve = i % 8 == 0;
    t = halve ? (a + b) / 2 : b - fb * (b - a) / (fb - fa);
    if (!halve && fabs(t - b) <= least / 2) return t;
    const mg_real f = mg_zero_function(k, sought, v, t);
    if (f == 0) return t;
    if (f * fb < 0) {
      a = b, fa = fb;
    } else {
      const mg_real kept = 1 - f / fb;
      fa *= kept > 0 ? kept : (mg_real)0.5;
    }
    b = t, fb = f;
  }
  return t;
}
