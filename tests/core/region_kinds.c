/* A set of kinds of plane curves, written by hand: lets regions be tested without the rest of the core. */
#include "modelgen.h"

enum { EDGE, CIRCLE, ELLIPSE, WAVE, CUBIC };
static const mg_shape_kind shape_kinds[] = {
    {1, 0, 0, 0, 0}, {1, 0, 0, 0, 0}, {1, 0, 0, 0, 0}, {1, 0, 1, 0, 0}, {1, 0, 1, 0, 0}};

static void shape_point(int kind, const mg_real *uv, const mg_real *parameters, mg_real *point, mg_real *direction) {
  const mg_real t = uv[0], *p = parameters;
  point[2] = direction[2] = 0;
  if (kind == EDGE) {
    point[0] = t, point[1] = 0, direction[0] = 1, direction[1] = 0;
  } else if (kind == WAVE) { /* r = p0 + p1 cos(p2 t) */
    const mg_real r = p[0] + p[1] * cos(p[2] * t), slope = -p[1] * p[2] * sin(p[2] * t);
    point[0] = r * cos(t), point[1] = r * sin(t);
    direction[0] = slope * cos(t) - r * sin(t), direction[1] = slope * sin(t) + r * cos(t);
  } else if (kind == CUBIC) { /* y = p0 + p1 t + p2 t^2 + p3 t^3 */
    point[0] = t, point[1] = p[0] + t * (p[1] + t * (p[2] + t * p[3]));
    direction[0] = 1, direction[1] = p[1] + t * (2 * p[2] + 3 * t * p[3]);
  } else {
    const mg_real b = kind == CIRCLE ? p[0] : p[1];
    point[0] = p[0] * cos(t), point[1] = b * sin(t), direction[0] = -p[0] * sin(t), direction[1] = b * cos(t);
  }
}

static const mg_kernels table = {
    .abi = MG_ABI, .real_size = sizeof(mg_real), .shape_kinds = shape_kinds, .shape_point = shape_point};

MG_API const mg_kernels *mg_kernel_table(void) { return &table; }
