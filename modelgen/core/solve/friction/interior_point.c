/* The convex program min y'S y/2 + (c + shift)'y over the cones by an interior-point method with Nesterov and
   Todd's scaling and Mehrotra's corrector (Vandenberghe, The CVXOPT linear and quadratic cone program solvers,
   2010). It gives starting points where the Newton method fails; its accuracy is moderate. */
#include "solve/friction/friction_solvers.h"
#include "base/base.h"

enum {
  MG_INTERIOR_STEPS = 60, /* most steps */
  MG_LORENTZ_SIZE = 3     /* most components of a cone */
};

/* A second-order cone |f| <= N and its scaling W = W(w, eta). */ typedef struct {
  int k, row;
  mg_real x[MG_LORENTZ_SIZE], w[MG_LORENTZ_SIZE], eta;
} mg_lorentz;

typedef struct {
  mg_scaled_friction *s;
  const mg_real *shift; /* per contact */
  int *swap;
  mg_real *K, *dy, *residual;   /* m^2; m */
  mg_real *u, *du, *correction; /* MG_LORENTZ_SIZE a cone: dual, its step, product of the predictor's steps */
  mg_real gap;
} mg_interior;

/* Number of second-order cones of a contact: one for each part, at least one. */
static int mg_interior_cones(const mg_scaled_friction *s, int contact) {
  const int parts = s->part[contact + 1] - s->part[contact];
  return parts > 0 ? parts : 1;
}

/* Scalar product of the tangential components. */
static mg_real mg_lorentz_tail(int k, const mg_real *a, const mg_real *b) {
  mg_real sum = 0;
  for (int i = 1; i <= k; ++i) sum += a[i] * b[i];
  return sum;
}

/* sqrt(x_0^2 - |x_1|^2), at least a little above 0. */
static mg_real mg_lorentz_norm(int k, const mg_real *x) {
  const mg_real tail = (mg_real)sqrt(mg_lorentz_tail(k, x, x)), square = (x[0] - tail) * (x[0] + tail);
  return square > MG_EPS * MG_EPS * x[0] * x[0] ? (mg_real)sqrt(square) : MG_EPS * (mg_real)fabs(x[0]);
}

/* Reads the components x of a cone of a contact from y. */
static void mg_lorentz_read(const mg_scaled_friction *s, int contact, int cone, const mg_real *y, mg_lorentz *q,
                            mg_real *x) {
  const int part = s->part[contact] + cone;
  q->k = part < s->part[contact + 1] ? s->part_dim[part] : 0;
  q->row = q->k ? s->part_row[part] : 0;
  x[0] = y[s->normal[contact]];
  for (int i = 0; i < q->k; ++i) x[i + 1] = y[q->row + i];
}

/* Sets x of a cone of a contact and the Nesterov-Todd scaling point of x and its dual u. */
static void mg_lorentz_set(const mg_scaled_friction *s, int contact, int cone, const mg_real *u, mg_lorentz *q) {
  mg_real size_x, size_u, g = 1;
  mg_lorentz_read(s, contact, cone, s->y, q, q->x);
  size_x = mg_lorentz_norm(q->k, q->x);
  size_u = mg_lorentz_norm(q->k, u);
  g += (q->x[0] / size_x) * (u[0] / size_u) + mg_lorentz_tail(q->k, q->x, u) / (size_x * size_u);
  g = (mg_real)sqrt(2 * g);
  q->w[0] = (q->x[0] / size_x + u[0] / size_u) / g;
  for (int i = 1; i <= q->k; ++i) q->w[i] = (q->x[i] / size_x - u[i] / size_u) / g;
  q->eta = (mg_real)sqrt(size_x / size_u);
}

/* out = W a (sign 1) or W^-1 a (sign -1). */
static void mg_lorentz_scale(const mg_lorentz *q, int sign, const mg_real *a, mg_real *out) {
  const mg_real tail = mg_lorentz_tail(q->k, q->w, a), factor = sign > 0 ? q->eta : 1 / q->eta, head = a[0];
  const mg_real along = (mg_real)sign * head + tail / (1 + q->w[0]);
  out[0] = factor * (q->w[0] * head + (mg_real)sign * tail);
  for (int i = 1; i <= q->k; ++i) out[i] = factor * (a[i] + along * q->w[i]);
}

/* Longest step from x along d within the cone. */
static mg_real mg_lorentz_step_length(int k, const mg_real *x, const mg_real *d) {
  const mg_real size = mg_lorentz_norm(k, x);
  const mg_real t = (x[0] * d[0] - mg_lorentz_tail(k, x, d)) / (size * size);
  const mg_real along = (t + d[0] / size) / (x[0] / size + 1);
  mg_real sum = 0;
  for (int i = 1; i <= k; ++i) {
    const mg_real r = d[i] / size - along * x[i] / size;
    sum += r * r;
  }
  sum = (mg_real)sqrt(sum) - t;
  return sum > 0 ? 1 / sum : MG_MAX;
}

/* residual = sum of the duals u over the cones - v - shift; gap = mean of x.u. */
static void mg_interior_measure(mg_interior *n) {
  mg_scaled_friction *s = n->s;
  const mg_real *u = n->u;
  int count = 0;
  mg_lorentz q;
  mg_friction_update_motion(s);
  n->gap = 0;
  for (int i = 0; i < s->m; ++i) n->residual[i] = -s->v[i];
  for (int c = 0; c < s->n; ++c) {
    n->residual[s->normal[c]] -= n->shift[c];
    for (int cone = 0; cone < mg_interior_cones(s, c); ++cone, u += MG_LORENTZ_SIZE, ++count) {
      mg_lorentz_read(s, c, cone, s->y, &q, q.x);
      n->gap += q.x[0] * u[0] + mg_lorentz_tail(q.k, q.x, u);
      n->residual[s->normal[c]] += u[0];
      for (int i = 0; i < q.k; ++i) n->residual[q.row + i] += u[i + 1];
    }
  }
  n->gap /= (mg_real)(count > 0 ? count : 1);
}

/* K = S + sum of W^-2, with W^-2 = (2 (J w)(J w)' - J) / eta^2, J = diag(1, -1, ..). Returns 0 if it is singular. */
static int mg_interior_factor(mg_interior *n) {
  const mg_scaled_friction *s = n->s;
  const int m = s->m;
  const mg_real *u = n->u;
  mg_lorentz q;
  for (int i = 0; i < m * m; ++i) n->K[i] = s->S[i];
  for (int c = 0; c < s->n; ++c)
    for (int cone = 0; cone < mg_interior_cones(s, c); ++cone, u += MG_LORENTZ_SIZE) {
      mg_lorentz_set(s, c, cone, u, &q);
      for (int j = 0; j <= q.k; ++j)
        for (int i = 0; i <= q.k; ++i) {
          const int row = i ? q.row + i - 1 : s->normal[c], column = j ? q.row + j - 1 : s->normal[c];
          const mg_real sign = (i > 0) != (j > 0) ? (mg_real)-1 : (mg_real)1;
          const mg_real unit = i != j ? 0 : i ? (mg_real)1 : (mg_real)-1;
          n->K[row + column * m] += (2 * sign * q.w[i] * q.w[j] + unit) / (q.eta * q.eta);
        }
    }
  return mg_lu(m, n->K, n->swap) > 0;
}

/* out = W^-1 (lambda \ (centre e - lambda o lambda - correction)) of one cone, lambda = W^-1 x. */
static void mg_interior_complementarity_step(const mg_lorentz *q, mg_real centre, const mg_real *guess, mg_real *out) {
  mg_real lambda[MG_LORENTZ_SIZE], r[MG_LORENTZ_SIZE], p[MG_LORENTZ_SIZE], size;
  mg_lorentz_scale(q, -1, q->x, lambda);
  size = mg_lorentz_norm(q->k, lambda);
  r[0] = centre - lambda[0] * lambda[0] - mg_lorentz_tail(q->k, lambda, lambda) - guess[0];
  for (int i = 1; i <= q->k; ++i) r[i] = -2 * lambda[0] * lambda[i] - guess[i];
  p[0] = (lambda[0] * r[0] - mg_lorentz_tail(q->k, lambda, r)) / (size * size);
  for (int i = 1; i <= q->k; ++i) p[i] = (r[i] - p[0] * lambda[i]) / lambda[0];
  mg_lorentz_scale(q, -1, p, out);
}

/* du = complementarity - W^-2 dx of one cone; `scaled` receives W^-1 dx. */
static void mg_interior_dual_step(const mg_lorentz *q, const mg_real *complementarity, const mg_real *dx,
                                  mg_real *scaled, mg_real *du) {
  mg_lorentz_scale(q, -1, dx, scaled);
  mg_lorentz_scale(q, -1, scaled, du);
  for (int i = 0; i <= q->k; ++i) du[i] = complementarity[i] - du[i];
}

/* Directions dy, du towards the central path, and the longest step along them. n->correction enters if
   `corrected`, and is set for the corrector. */
static mg_real mg_interior_direction(mg_interior *n, mg_real centre, int corrected) {
  const mg_scaled_friction *s = n->s;
  mg_real reach = MG_MAX;
  mg_lorentz q;
  for (int i = 0; i < s->m; ++i) n->dy[i] = n->residual[i];
  for (int c = 0, at = 0; c < s->n; ++c)
    for (int cone = 0; cone < mg_interior_cones(s, c); ++cone, at += MG_LORENTZ_SIZE) {
      mg_lorentz_set(s, c, cone, n->u + at, &q);
      for (int i = 0; !corrected && i < MG_LORENTZ_SIZE; ++i) n->correction[at + i] = 0;
      mg_interior_complementarity_step(&q, centre, n->correction + at, n->du + at);
      n->dy[s->normal[c]] += n->du[at];
      for (int i = 0; i < q.k; ++i) n->dy[q.row + i] += n->du[at + 1 + i];
    }
  mg_lu_solve(s->m, n->K, n->swap, n->dy);
  for (int c = 0, at = 0; c < s->n; ++c)
    for (int cone = 0; cone < mg_interior_cones(s, c); ++cone, at += MG_LORENTZ_SIZE) {
      mg_real dx[MG_LORENTZ_SIZE], x[MG_LORENTZ_SIZE], a[MG_LORENTZ_SIZE], b[MG_LORENTZ_SIZE],
          complementarity[MG_LORENTZ_SIZE], step;
      mg_lorentz_set(s, c, cone, n->u + at, &q);
      mg_lorentz_read(s, c, cone, n->dy, &q, dx);
      for (int i = 0; i <= q.k; ++i) complementarity[i] = n->du[at + i], x[i] = q.x[i];
      mg_interior_dual_step(&q, complementarity, dx, a, n->du + at);
      mg_lorentz_scale(&q, 1, n->du + at, b);
      n->correction[at] = a[0] * b[0] + mg_lorentz_tail(q.k, a, b);
      for (int i = 1; i <= q.k; ++i) n->correction[at + i] = a[0] * b[i] + b[0] * a[i];
      step = mg_lorentz_step_length(q.k, x, dx);
      reach = step < reach ? step : reach;
      step = mg_lorentz_step_length(q.k, n->u + at, n->du + at);
      reach = step < reach ? step : reach;
    }
  return reach;
}

/* Divides the memory and starts at N = 1, f = 0. */
static void mg_interior_open(mg_interior *n, mg_scaled_friction *s, const mg_real *shift) {
  const int m = s->m;
  n->s = s;
  n->shift = shift;
  n->swap = s->iwork;
  n->K = s->work;
  n->dy = n->K + m * m;
  n->residual = n->dy + m;
  n->u = n->residual + m;
  n->du = n->u + MG_LORENTZ_SIZE * m;
  n->correction = n->du + MG_LORENTZ_SIZE * m;
  for (int i = 0; i < m; ++i) s->y[i] = 0;
  for (int i = 0; i < MG_LORENTZ_SIZE * m; ++i) n->u[i] = i % MG_LORENTZ_SIZE == 0;
  for (int c = 0; c < s->n; ++c) s->y[s->normal[c]] = 1;
}

MG_INTERNAL void mg_friction_interior(mg_scaled_friction *s, const mg_real *shift, mg_real gap) {
  mg_interior n;
  mg_interior_open(&n, s, shift);
  for (int step = 0; step < MG_INTERIOR_STEPS; ++step) {
    mg_real reach, rest;
    mg_interior_measure(&n);
    if (!(n.gap > gap && n.gap <= MG_MAX) || !mg_interior_factor(&n)) return;
    reach = mg_interior_direction(&n, 0, 0);
    rest = reach < 1 ? 1 - reach : 0;
    rest = rest * rest * rest > (mg_real)1e-4 ? rest * rest * rest : (mg_real)1e-4;
    reach = (mg_real)0.99 * mg_interior_direction(&n, rest * n.gap, 1);
    if (!(reach > MG_EPS)) return;
    if (reach > 1) reach = 1;
    for (int i = 0; i < s->m; ++i) s->y[i] += reach * n.dy[i];
    for (int i = 0; i < MG_LORENTZ_SIZE * s->m; ++i) n.u[i] += reach * n.du[i];
  }
}
