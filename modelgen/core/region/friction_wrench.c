/* Coulomb friction integrated over the loaded region (region/region.h), by integrals along its boundary. About the
   instantaneous centre of rotation the direction of slip depends on the polar angle alone, so that the integral
   along each ray is a polynomial; the remaining integral along the boundary has a closed form on straight strips,
   and is smooth on curves except near the centre, towards which these are subdivided. Where the centre is far away,
   the direction is smooth over the region, and Gauss quadrature on rays from a point of the region converges fast. */
#include "region/region.h"
#include "base/base.h"

#define MG_FAR_ROTATION_CENTRE                                                          \
  3 /* distance of the rotation centre over the reach of the pressure: from here on far \
     */

#define MG_NEARLY_TRANSLATION 40 /* the same: from here on few nodes are enough */

/* Integrals over the loaded region about the rotation centre, from which a point is at d. */
typedef struct {
  mg_real centre[2]; /* rotation centre, axes of the hull, m */
  mg_real e[2];      /* of e = d / |d| */
  mg_real ed[3];     /* of e d: xx, xy, yy */
  mg_real r;         /* of |d| */
  mg_real rd[2];     /* of |d| d */
} mg_rotation_integrals;

/* Adds an element of the boundary at d from the rotation centre, with weight d x dx. */
static void mg_add_boundary_element(mg_rotation_integrals *g, mg_real weight, const mg_real *d) {
  const mg_real r = sqrt(mg_dot2(d, d));
  if (!(r > 0)) return;
  const mg_real x = d[0] / r, y = d[1] / r;
  g->e[0] += weight * x / 2, g->e[1] += weight * y / 2;
  g->ed[0] += weight * x * d[0] / 3, g->ed[1] += weight * x * d[1] / 3, g->ed[2] += weight * y * d[1] / 3;
  g->r += weight * r / 3, g->rd[0] += weight * r * d[0] / 4, g->rd[1] += weight * r * d[1] / 4;
}

/* Adds the straight piece of boundary from P to Q, in closed form. */
static void mg_add_straight_boundary(mg_rotation_integrals *g, const mg_real *P, const mg_real *Q) {
  const mg_real length = mg_distance2(P, Q), p[2] = {P[0] - g->centre[0], P[1] - g->centre[1]};
  if (!(length > 0)) return;
  const mg_real t[2] = {(Q[0] - P[0]) / length, (Q[1] - P[1]) / length}, h = mg_cross2(p, t);
  if (h == 0) return;
  const mg_real a = mg_dot2(p, t), b = a + length, f[2] = {h * t[1], -h * t[0]};
  const mg_real ra = sqrt(a * a + h * h), rb = sqrt(b * b + h * h);
  const mg_real k0 = mg_asinh(b / fabs(h)) - mg_asinh(a / fabs(h)), k1 = (b + a) * length / (rb + ra);
  const mg_real k2 = (b * rb - a * ra - h * h * k0) / 2, r0 = (b * rb - a * ra + h * h * k0) / 2;
  const mg_real r1 = (rb * rb * rb - ra * ra * ra) / 3;
  for (int i = 0; i < 2; i++) g->e[i] += h / 2 * (f[i] * k0 + t[i] * k1), g->rd[i] += h / 4 * (f[i] * r0 + t[i] * r1);
  g->ed[0] += h / 3 * (f[0] * f[0] * k0 + 2 * f[0] * t[0] * k1 + t[0] * t[0] * k2);
  g->ed[1] += h / 3 * (f[0] * f[1] * k0 + (f[0] * t[1] + f[1] * t[0]) * k1 + t[0] * t[1] * k2);
  g->ed[2] += h / 3 * (f[1] * f[1] * k0 + 2 * f[1] * t[1] * k1 + t[1] * t[1] * k2);
  g->r += h / 3 * r0;
}

/* Adds a curved piece of boundary, in halves while it is long compared with its distance from the rotation centre. */
static void mg_add_curved_boundary(mg_rotation_integrals *g, const mg_placed_arc *k, mg_real t0, mg_real t1,
                                   const mg_real *P, const mg_real *Q, mg_real least) {
  const mg_real t = (t0 + t1) / 2, length = mg_distance2(P, Q);
  mg_real x[2], T[2];
  mg_arc_point(k, t, x, T);
  const mg_real near =
      mg_min(mg_min(mg_distance2(P, g->centre), mg_distance2(Q, g->centre)), mg_distance2(x, g->centre));
  if (2 * length > near && length > least) {
    mg_add_curved_boundary(g, k, t0, t, P, x, least), mg_add_curved_boundary(g, k, t, t1, x, Q, least);
    return;
  }
  for (int j = 0; j < MG_NODES; j++) {
    mg_arc_point(k, t0 + mg_node[j] * (t1 - t0), x, T);
    const mg_real d[2] = {x[0] - g->centre[0], x[1] - g->centre[1]};
    mg_add_boundary_element(g, mg_node_weight[j] * (t1 - t0) * mg_cross2(d, T), d);
  }
}

/* Integrals about the rotation centre; the line where the pressure vanishes is part of the boundary. */
static void mg_integrate_about_rotation_centre(const mg_winkler_pressure_field *p, mg_rotation_integrals *g) {
  for (long i = 0; i < p->n; i++) {
    const mg_boundary_strip *s = p->strips + i;
    if (s->straight) mg_add_straight_boundary(g, s->begin, s->end);
    else mg_add_curved_boundary(g, p->hull->arcs + s->arc, s->t[0], s->t[1], s->begin, s->end, sqrt(MG_EPS) * p->reach);
    if (s->ends[0]) mg_add_straight_boundary(g, p->zero_line_point, s->begin);
    if (s->ends[1]) mg_add_straight_boundary(g, s->end, p->zero_line_point);
  }
}

/* Friction matrix G about the centre of pressure from integrals about the rotation centre, which is q from it. */
static void mg_shift_to_pressure_centre(const mg_rotation_integrals *g, const mg_real *q, int sign, mg_real G[3][3]) {
  const mg_real ed[2][2] = {{g->ed[0], g->ed[1]}, {g->ed[1], g->ed[2]}};
  for (int j = 0; j < 3; j++) {
    const mg_real by = j ? q[j - 1] : 1;
    const mg_real x = (j ? ed[0][j - 1] : 0) + by * g->e[0], y = (j ? ed[1][j - 1] : 0) + by * g->e[1];
    G[0][j] = -sign * y, G[1][j] = sign * x;
    G[2][j] = sign * ((j ? g->rd[j - 1] : 0) + by * g->r) + q[0] * G[1][j] - q[1] * G[0][j];
  }
}

/* Adds the friction of a point at d from the centre of pressure. */
static void mg_add_point_friction(const mg_real *twist, mg_real weight, const mg_real *d, mg_real G[3][3]) {
  const mg_real v[2] = {twist[0] - twist[2] * d[1], twist[1] + twist[2] * d[0]}, size = sqrt(mg_dot2(v, v));
  if (!(size > 0)) return;
  const mg_real by[3] = {weight, weight * d[0], weight * d[1]}, u[2] = {v[0] / size, v[1] / size},
                arm = mg_cross2(d, u);
  for (int j = 0; j < 3; j++) G[0][j] += u[0] * by[j], G[1][j] += u[1] * by[j], G[2][j] += arm * by[j];
}

/* Adds the triangle between the reference point and an element of the boundary at x, of weight (x - reference) x
   dx, by n nodes along the ray. */
static void mg_add_ray_friction(const mg_winkler_pressure_field *p, const mg_real *twist, int n, mg_real weight,
                                const mg_real *x, mg_real G[3][3]) {
  static const mg_real few[2][MG_FEW_NODES] = {
      {(mg_real)0.0694318442029737123880268, (mg_real)0.330009478207571867598667, (mg_real)0.669990521792428132401333,
       (mg_real)0.930568155797026287611973},
      {(mg_real)0.173927422568726928686532, (mg_real)0.326072577431273071313468, (mg_real)0.326072577431273071313468,
       (mg_real)0.173927422568726928686532}};
  const mg_real *node = n == MG_FEW_NODES ? few[0] : mg_node, *part = n == MG_FEW_NODES ? few[1] : mg_node_weight;
  for (int j = 0; j < n; j++) {
    mg_real d[2];
    for (int k = 0; k < 2; k++) d[k] = p->zero_line_point[k] - p->centre[k] + node[j] * (x[k] - p->zero_line_point[k]);
    mg_add_point_friction(twist, part[j] * node[j] * weight, d, G);
  }
}

/* Friction matrix for a far rotation centre, by n nodes along each ray. */
static void mg_integrate_far_rotation(const mg_winkler_pressure_field *p, const mg_real *twist, int n,
                                      mg_real G[3][3]) {
  for (long i = 0; i < p->n; i++) {
    const mg_boundary_strip *s = p->strips + i;
    for (int j = 0; j < MG_NODES; j++) {
      mg_real x[2], T[2] = {s->end[0] - s->begin[0], s->end[1] - s->begin[1]};
      if (s->straight)
        for (int k = 0; k < 2; k++) x[k] = s->begin[k] + mg_node[j] * T[k];
      else mg_arc_point(p->hull->arcs + s->arc, s->t[0] + mg_node[j] * (s->t[1] - s->t[0]), x, T);
      const mg_real arm[2] = {x[0] - p->zero_line_point[0], x[1] - p->zero_line_point[1]},
                    whole = s->straight ? 1 : s->t[1] - s->t[0];
      mg_add_ray_friction(p, twist, n, mg_node_weight[j] * whole * mg_cross2(arm, T), x, G);
    }
  }
}

MG_INTERNAL void mg_friction_matrix(const mg_winkler_pressure_field *p, const mg_real *twist, mg_real G[3][3]) {
  const mg_real away = sqrt(mg_dot2(twist, twist)), turn = fabs(twist[2]) * p->reach;
  for (int i = 0; i < 9; i++) G[i / 3][i % 3] = 0;
  if (away >= MG_FAR_ROTATION_CENTRE * turn) {
    mg_integrate_far_rotation(p, twist, away < MG_NEARLY_TRANSLATION * turn ? MG_NODES : MG_FEW_NODES, G);
    return;
  }
  const mg_real q[2] = {-twist[1] / twist[2], twist[0] / twist[2]};
  mg_rotation_integrals integrals = {{p->centre[0] + q[0], p->centre[1] + q[1]}, {0, 0}, {0, 0, 0}, 0, {0, 0}};
  mg_integrate_about_rotation_centre(p, &integrals);
  mg_shift_to_pressure_centre(&integrals, q, twist[2] > 0 ? 1 : -1, G);
}
