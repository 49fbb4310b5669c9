/* Hull margins of polygons and discs on a whole plane. */
#include "core.h"

static int mg_lay(mg_context *c, int patch) { return c->sys->patch_arc[patch + 1] - c->sys->patch_arc_f[patch]; }

static void mg_arc_point(mg_context *c, int patch, int arc, mg_real t, mg_real *out) {
  const mg_system *s = c->sys;
  const mg_real *at = s->numbers + s->arc_numbers[arc];
  mg_real o[12], f[12], uv[2] = {t, 0}, x[3], T[3], y[3];
  mg_shape_point(s->arc_shape[arc], uv, s->parameters + s->arc_parameters[arc], x, T);
  mg_face_pose(c, patch, 0, o);
  mg_face_pose(c, patch, 1, f);
  mg_out(at, x, 1, y);
  mg_out(f, y, 1, x);
  mg_into(o, x, out);
}

static mg_real mg_hull_margin(mg_context *c, int patch, const mg_real *x, mg_brink *brink) {
  const mg_system *s = c->sys;
  const int first = s->patch_arc_f[patch], end = s->patch_arc[patch + 1], n = end - first;
  const mg_real *at = s->numbers + s->arc_numbers[first];
  mg_real least = MG_MAX, p[3], q[3], m[3];
  if (n == 1) {
    mg_real a[3], centre[3];
    mg_arc_point(c, patch, first, 0, a);
    mg_arc_point(c, patch, first, (mg_real)3.14159265358979323846, centre);
    for (int k = 0; k < 2; k++) centre[k] = (a[k] + centre[k]) / 2;
    const mg_real r = hypot(a[0] - centre[0], a[1] - centre[1]), d[2] = {x[0] - centre[0], x[1] - centre[1]};
    const mg_real far = hypot(d[0], d[1]);
    brink->n = 1, brink->margin = r - far;
    for (int k = 0; k < 2; k++) brink->at[0].point[k] = centre[k] + r * d[k] / far, brink->normal[k] = d[k] / far;
    mg_real o[12], f[12], w[3], l[3], e[3] = {brink->at[0].point[0], brink->at[0].point[1], 0};
    mg_face_pose(c, patch, 0, o), mg_face_pose(c, patch, 1, f), mg_out(o, e, 1, w), mg_into(f, w, l), mg_into(at, l, e);
    brink->at[0].t = atan2(e[1], e[0]);
    brink->at[0].side = 1, brink->at[0].arc = first, brink->at[0].crossing_arc = -1;
    return r - far;
  }
  for (int i = first; i < end; i++)
    for (int j = first; j < end; j++) {
      if (i == j) continue;
      mg_arc_point(c, patch, i, s->numbers[s->arc_numbers[i] + 12], p);
      mg_arc_point(c, patch, j, s->numbers[s->arc_numbers[j] + 12], q);
      const mg_real along[2] = {q[0] - p[0], q[1] - p[1]}, size = hypot(along[0], along[1]);
      const mg_real normal[2] = {-along[1] / size, along[0] / size};
      int outside = 0;
      for (int k = first; k < end; k++) {
        mg_arc_point(c, patch, k, s->numbers[s->arc_numbers[k] + 12], m);
        outside += (m[0] - p[0]) * normal[0] + (m[1] - p[1]) * normal[1] < -1e-9 * size;
      }
      const mg_real margin = (x[0] - p[0]) * normal[0] + (x[1] - p[1]) * normal[1];
      if (outside || margin >= least) continue;
      least = margin, brink->n = 2, brink->margin = margin;
      for (int k = 0; k < 2; k++) brink->at[0].point[k] = p[k], brink->at[1].point[k] = q[k], brink->normal[k] = normal[k];
      brink->at[0].arc = i, brink->at[1].arc = j, brink->at[0].side = brink->at[1].side = 1;
      brink->at[0].crossing_arc = brink->at[1].crossing_arc = -1;
    }
  return least;
}
