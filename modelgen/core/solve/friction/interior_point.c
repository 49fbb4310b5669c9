/* The convex program min y'S y/2 + (c + shift)'y over the cones by an interior-point method with Nesterov and
   Todd's scaling and Mehrotra's corrector (Vandenberghe, The CVXOPT linear and quadratic cone program solvers,
   2010). It gives starting points where the Newton method fails; its accuracy is moderate. On a graph also Coulomb's
   law itself, which is the program whose shift is the slip |u_t| of its own duals u: the shift follows them in each
   step, with its derivative. */
#include "solve/friction/friction_solvers.h"
#include "base/base.h"

enum {
  MG_INTERIOR_STEPS = 60,      /* most steps */
  MG_INTERIOR_REFINEMENTS = 1, /* of a direction on a graph */
  MG_LORENTZ_SIZE = 3          /* most components of a cone */
};

#define MG_INTERIOR_YIELD ((mg_real)sqrt(MG_EPS)) /* what is added to the diagonal of S on a graph */

/* A second-order cone |f| <= N and its scaling W = W(w, eta). */ typedef struct {
  int k, row;
  mg_real x[MG_LORENTZ_SIZE], w[MG_LORENTZ_SIZE], eta;
} mg_lorentz;

typedef struct {
  mg_scaled_friction *s;
  const mg_real *shift; /* [n] what is added to v_n; null: the slip sum |v_t| */
  int *swap;
  mg_real *K;                   /* [m m] S + sum of W^-2; on a graph null */
  mg_real *dy, *residual;       /* [m + n_free] */
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

/* Derivative of the slip that is added to v_n by the rows v of a contact; u: its duals. */
static void mg_interior_slip_slope(const mg_interior *n, int contact, const mg_real *u, mg_real *slope) {
  const mg_scaled_friction *s = n->s;
  for (int i = 0; i < MG_ROWS; ++i) slope[i] = 0;
  for (int p = s->part[contact]; p < s->part[contact + 1] && !n->shift; ++p, u += MG_LORENTZ_SIZE) {
    const mg_real size = mg_friction_norm(s->part_dim[p], u + 1);
    for (int i = 0; i < s->part_dim[p] && size > 0; ++i)
      slope[s->part_row[p] - s->normal[contact] + i] = u[1 + i] / size;
  }
}

/* residual = sum of the duals u over the cones - v - shift; gap = mean of x.u. */
static void mg_interior_measure(mg_interior *n) {
  mg_scaled_friction *s = n->s;
  const mg_real *u = n->u;
  int count = 0;
  mg_lorentz q;
  mg_friction_update_motion(s);
  n->gap = 0;
  for (int i = 0; i < mg_friction_rows(s); ++i) n->residual[i] = -s->v[i];
  for (int c = 0; c < s->n; ++c) {
    mg_real slope[MG_ROWS];
    const int from = s->normal[c];
    mg_interior_slip_slope(n, c, u, slope);
    n->residual[from] -= n->shift ? n->shift[c] : 0;
    for (int i = from + 1; i < mg_friction_row_end(s, c); ++i) n->residual[from] -= slope[i - from] * s->v[i];
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
static int mg_interior_factor_matrix(mg_interior *n) {
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

/* Stiffness of a contact on a graph, the inverse of the sum of the W^-2 of its cones and of MG_INTERIOR_YIELD, whose
   rows along the tangents are eliminated in closed form: entries of W^-2 differ by far more than rounding bears where a
   force is near the boundary of its cone. `arm`: how forces along the tangents follow the normal force. Returns the
   number of cones. */
static int mg_interior_set_stiffness(const mg_scaled_friction *s, int contact, const mg_real *u, mg_real *K) {
  const int from = s->normal[contact], cones = mg_interior_cones(s, contact);
  mg_real arm[MG_ROWS] = {1}, compliance = MG_INTERIOR_YIELD;
  mg_lorentz q;
  for (int i = 0; i < MG_BLOCK_SIZE; ++i) K[i] = 0;
  for (int cone = 0; cone < cones; ++cone, u += MG_LORENTZ_SIZE) {
    mg_lorentz_set(s, contact, cone, u, &q);
    const mg_real size = q.eta * q.eta, yield = MG_INTERIOR_YIELD * size, square = mg_lorentz_tail(q.k, q.w, q.w),
                  along = 1 + 2 * square + (q.k ? yield : 0), across = 1 + yield;
    compliance += (1 + (q.k ? yield * (1 + 2 * square) : 0)) / (size * along);
    for (int i = 0; i < q.k; ++i) {
      arm[q.row - from + i] = 2 * q.w[0] * q.w[i + 1] / along;
      for (int j = 0; j < q.k; ++j)
        K[q.row - from + i + MG_ROWS * (q.row - from + j)] =
            size / across * ((mg_real)(i == j) - 2 * q.w[i + 1] * q.w[j + 1] / along);
    }
  }
  for (int i = 0; i < mg_friction_row_end(s, contact) - from; ++i)
    for (int j = 0; j < mg_friction_row_end(s, contact) - from; ++j) K[i + MG_ROWS * j] += arm[i] * arm[j] / compliance;
  return cones;
}

/* Factors S + sum of W^-2. Returns 0 if it is singular. */
static int mg_interior_factor(mg_interior *n) {
  mg_scaled_friction *s = n->s;
  const mg_real *u = n->u;
  if (n->K) return mg_interior_factor_matrix(n);
  mg_graph_begin_step(s, MG_INTERIOR_YIELD);
  for (int c = 0; c < s->n; ++c) {
    mg_real *K = s->graph.stiffness + (long)MG_BLOCK_SIZE * c, slope[MG_ROWS];
    mg_interior_slip_slope(n, c, u, slope);
    u += MG_LORENTZ_SIZE * mg_interior_set_stiffness(s, c, u, K);
    for (int j = 1; j < MG_ROWS; ++j)
      for (int i = 0; i < MG_ROWS; ++i) K[i + MG_ROWS * j] += K[i] * slope[j];
  }
  return mg_graph_factor_step(s);
}

/* Replaces dy by the solution of (S + sum of W^-2) x = dy. Returns 0 if it is not finite. */
static int mg_interior_solve(mg_interior *n) {
  mg_scaled_friction *s = n->s;
  if (n->K) {
    mg_lu_solve(s->m, n->K, n->swap, n->dy);
    return 1;
  }
  const mg_real *u = n->u;
  for (int c = 0; c < s->n; ++c) {
    mg_real slope[MG_ROWS];
    const int from = s->normal[c];
    mg_interior_slip_slope(n, c, u, slope);
    for (int i = from + 1; i < mg_friction_row_end(s, c); ++i) n->dy[from] -= slope[i - from] * n->dy[i];
    u += MG_LORENTZ_SIZE * mg_interior_cones(s, c);
  }
  mg_graph_set_push(s, n->dy);
  int is_finite = mg_graph_solve_step(s, n->dy, s->v);
  for (int i = 0; i < MG_INTERIOR_REFINEMENTS && is_finite; ++i) is_finite = mg_graph_refine_step(s, n->dy, s->v);
  return is_finite;
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

/* Replaces du, the complementarity of one cone, by complementarity - W^-2 dx. */
static void mg_interior_dual_step(const mg_lorentz *q, const mg_real *dx, mg_real *du) {
  mg_real scaled[MG_LORENTZ_SIZE], image[MG_LORENTZ_SIZE];
  mg_lorentz_scale(q, -1, dx, scaled);
  mg_lorentz_scale(q, -1, scaled, image);
  for (int i = 0; i <= q->k; ++i) du[i] -= image[i];
}

/* On a graph, makes du of a contact, [MG_LORENTZ_SIZE cones], what the change of v asks for, because W^-2 dx is not
   accurate enough: the residual is then that of rounding. */
static void mg_interior_balance(const mg_interior *n, int contact, const mg_real *u, mg_real *du) {
  const mg_scaled_friction *s = n->s;
  const int cones = mg_interior_cones(s, contact), normal = s->normal[contact];
  mg_real slope[MG_ROWS], rest = s->v[normal] - n->residual[normal];
  mg_interior_slip_slope(n, contact, u, slope);
  for (int i = normal + 1; i < mg_friction_row_end(s, contact); ++i) rest += slope[i - normal] * s->v[i];
  for (int cone = 0; cone < cones; ++cone) rest -= du[MG_LORENTZ_SIZE * cone];
  for (int cone = 0; cone < cones; ++cone) {
    const int part = s->part[contact] + cone;
    du[MG_LORENTZ_SIZE * cone] += rest / (mg_real)cones;
    for (int i = 0; part < s->part[contact + 1] && i < s->part_dim[part]; ++i)
      du[MG_LORENTZ_SIZE * cone + 1 + i] = s->v[s->part_row[part] + i] - n->residual[s->part_row[part] + i];
  }
}

/* Directions dy, du towards the central path, and the longest step along them. n->correction enters if
   `corrected`, and is set for the corrector. */
static mg_real mg_interior_direction(mg_interior *n, mg_real centre, int corrected) {
  const mg_scaled_friction *s = n->s;
  mg_real reach = MG_MAX;
  mg_lorentz q;
  for (int i = 0; i < mg_friction_rows(s); ++i) n->dy[i] = n->residual[i];
  for (int c = 0, at = 0; c < s->n; ++c)
    for (int cone = 0; cone < mg_interior_cones(s, c); ++cone, at += MG_LORENTZ_SIZE) {
      mg_lorentz_set(s, c, cone, n->u + at, &q);
      for (int i = 0; !corrected && i < MG_LORENTZ_SIZE; ++i) n->correction[at + i] = 0;
      mg_interior_complementarity_step(&q, centre, n->correction + at, n->du + at);
      n->dy[s->normal[c]] += n->du[at];
      for (int i = 0; i < q.k; ++i) n->dy[q.row + i] += n->du[at + 1 + i];
    }
  if (!mg_interior_solve(n)) return 0;
  for (int c = 0, at = 0; c < s->n; ++c) {
    const int first = at;
    for (int cone = 0; cone < mg_interior_cones(s, c); ++cone, at += MG_LORENTZ_SIZE) {
      mg_real dx[MG_LORENTZ_SIZE];
      mg_lorentz_set(s, c, cone, n->u + at, &q);
      mg_lorentz_read(s, c, cone, n->dy, &q, dx);
      mg_interior_dual_step(&q, dx, n->du + at);
    }
    if (!n->K) mg_interior_balance(n, c, n->u + first, n->du + first);
  }
  for (int c = 0, at = 0; c < s->n; ++c)
    for (int cone = 0; cone < mg_interior_cones(s, c); ++cone, at += MG_LORENTZ_SIZE) {
      mg_real dx[MG_LORENTZ_SIZE], x[MG_LORENTZ_SIZE], a[MG_LORENTZ_SIZE], b[MG_LORENTZ_SIZE], step;
      mg_lorentz_set(s, c, cone, n->u + at, &q);
      mg_lorentz_read(s, c, cone, n->dy, &q, dx);
      for (int i = 0; i <= q.k; ++i) x[i] = q.x[i];
      mg_lorentz_scale(&q, -1, dx, a);
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
  const int m = s->m, rows = mg_friction_rows(s);
  n->s = s;
  n->shift = shift;
  n->swap = s->iwork;
  n->K = s->graph.J ? 0 : s->work;
  n->dy = n->K ? n->K + m * m : s->work;
  n->residual = n->dy + rows;
  n->u = n->residual + rows;
  n->du = n->u + MG_LORENTZ_SIZE * m;
  n->correction = n->du + MG_LORENTZ_SIZE * m;
  for (int i = 0; i < rows; ++i) s->y[i] = 0;
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
    for (int i = 0; i < mg_friction_rows(s); ++i) s->y[i] += reach * n.dy[i];
    for (int i = 0; i < MG_LORENTZ_SIZE * s->m; ++i) n.u[i] += reach * n.du[i];
  }
}
