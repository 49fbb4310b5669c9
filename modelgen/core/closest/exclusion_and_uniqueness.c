/* Whether two cells of features can hold a pair of closest points, and whether more than one.

   A pair of points is critical if their distance is stationary: the line between them is normal to both features. With
   cell A at a, cell B at b (middles), v = b - a, n the exterior normal and W its derivative (dn = W dx), t the tangent
   and k the curvature vector, to first order in the displacements y from the middles:
     two surfaces: n_A + n_B = 0, b - a = d n_A      ->  (W_A + W_B + d W_B W_A) y_A = W_B v - n_B, along the surface A
     surface, point: b - a = d n_A                    ->  (1 + d W_A) y_A = v, along the surface A
     surface, curve: n_A . t_B = 0, b - a = d n_A     ->  (n_A.k_B + w.W_A (1 + d W_A)^-1 w) s_B = ..., w = t_B along A
     two curves: v . t_A = v . t_B = 0                ->  two equations in s_A, s_B
   A surface at a constant distance, its tube, from a curve or a point is critical where that is: views show the curve
   or the point, and d is then the gap and the tube. Where all lies outside, its gap is least where the distance is;
   inside a hollow, the gap is least across the curve only if the distance is greatest. The cells bound how far each
   equation is from its linear part. Axes of A's shape. */
#include "closest/closest.h"
#include "base/base.h"

/* The linear equations K y + r = 0 in n = 1 or 2 unknowns with |y| <= range and |u.K y| <= reach for each
   direction u, and what bounds the rest: `error` of the
   equations, `slope_error` of K. u: of two equations, the directions in which K is largest and smallest. */
typedef struct {
  int n;
  mg_real K[4], r[2];
  mg_real range, reach[2], error[2], slope_error;
  mg_real u[4], size[2];
} mg_linear_part;

/* Eigenvalues, larger first, and eigenvectors of a symmetric matrix [a b; b d]. */
static void mg_symmetric_eigenvalues(mg_real a, mg_real b, mg_real d, mg_real *value, mg_real *vector) {
  const mg_real half = (a - d) / 2, root = sqrt(half * half + b * b);
  value[0] = (a + d) / 2 + root, value[1] = (a + d) / 2 - root;
  mg_real x = half < 0 ? b : half + root, y = half < 0 ? root - half : b;
  const mg_real size = sqrt(x * x + y * y);
  if (size > 0) x /= size, y /= size;
  else x = 1, y = 0;
  vector[0] = x, vector[1] = y, vector[2] = -y, vector[3] = x;
}

MG_INTERNAL mg_real mg_extent_along(const mg_cell_view *view, const mg_real *w) {
  return fabs(mg_dot3(view->slope[0], w)) + fabs(mg_dot3(view->slope[1], w)) + view->rest * sqrt(mg_dot3(w, w));
}

/* Sets u and the sizes of K along it: of two equations the singular vectors and values of K. */
static void mg_find_directions(mg_linear_part *at) {
  const mg_real *K = at->K; /* by columns; K K' has the squares of the singular values */
  mg_symmetric_eigenvalues(K[0] * K[0] + K[2] * K[2], K[0] * K[1] + K[2] * K[3], K[1] * K[1] + K[3] * K[3], at->size,
                           at->u);
  for (int i = 0; i < 2; i++)
    at->size[i] = sqrt(mg_max(at->size[i], (mg_real)0)), at->reach[i] = at->size[i] * at->range;
}

/* Length of two numbers. */
static mg_real mg_length2(mg_real x, mg_real y) { return sqrt(x * x + y * y); }

/* Verdict on the equations: regular only if their solution is known to a fourth of the range, so that neighbouring
   cells are not taken to hold it too. If they are regular, *y is their solution, and *y_error bounds how far that of
   the exact equations is from it. */
static int mg_solve_linear_part(const mg_linear_part *at, mg_real *y, mg_real *y_error) {
  const mg_real *K = at->K, *r = at->r;
  if (at->n == 1) {
    if (fabs(r[0]) > fabs(K[0]) * at->range + at->error[0]) return MG_CELLS_APART;
    if (!(fabs(K[0]) > at->slope_error)) return MG_CELLS_OPEN;
    y[0] = -r[0] / K[0], *y_error = at->error[0] / fabs(K[0]);
    if (fabs(y[0]) > at->range + *y_error) return MG_CELLS_APART;
    return *y_error <= at->range / 4 ? MG_CELLS_REGULAR : MG_CELLS_SINGLE;
  }
  for (int i = 0; i < 2; i++)
    if (fabs(at->u[2 * i] * r[0] + at->u[2 * i + 1] * r[1]) > at->reach[i] + at->error[i]) return MG_CELLS_APART;
  const mg_real determinant = K[0] * K[3] - K[1] * K[2];
  if (!(fabs(determinant) > at->slope_error * at->size[0])) return MG_CELLS_OPEN;
  y[0] = (K[2] * r[1] - K[3] * r[0]) / determinant, y[1] = (K[1] * r[0] - K[0] * r[1]) / determinant;
  *y_error = mg_length2(at->error[0] / at->size[0], at->error[1] * at->size[0] / fabs(determinant));
  if (mg_length2(y[0], y[1]) > at->range + *y_error) return MG_CELLS_APART;
  return *y_error <= at->range / 4 ? MG_CELLS_REGULAR : MG_CELLS_SINGLE;
}

/* Sets reach[i] for displacements y in a surface cell, in the tangents t1, t2. */
static void mg_set_reach(mg_linear_part *at, int i, const mg_cell_view *view, const mg_real *t1, const mg_real *t2) {
  const mg_real *u = at->u + 2 * i, *K = at->K;
  const mg_real first = K[0] * u[0] + K[1] * u[1], second = K[2] * u[0] + K[3] * u[1];
  const mg_real w[3] = {first * t1[0] + second * t2[0], first * t1[1] + second * t2[1], first * t1[2] + second * t2[2]};
  at->reach[i] = mg_min(at->reach[i], mg_extent_along(view, w));
}

/* Smallest eigenvalue of a symmetric 2 by 2 matrix. */
static mg_real mg_smallest_eigenvalue(const mg_real *a) {
  const mg_real half = (a[0] - a[3]) / 2, off = (a[1] + a[2]) / 2;
  return (a[0] + a[3]) / 2 - sqrt(half * half + off * off);
}

/* The verdict alone. */
static int mg_judge_linear_part(const mg_linear_part *at) {
  mg_real y[2], y_error;
  return mg_solve_linear_part(at, y, &y_error);
}

/* out = W x for a symmetric matrix given by its entries xx, yy, zz, xy, xz, yz. */
static void mg_symmetric_times(const mg_real *W, const mg_real *x, mg_real *out) {
  out[0] = W[0] * x[0] + W[3] * x[1] + W[4] * x[2];
  out[1] = W[3] * x[0] + W[1] * x[1] + W[5] * x[2];
  out[2] = W[4] * x[0] + W[5] * x[1] + W[2] * x[2];
}

/* Two tangents of unit length to a plane with unit normal n. */
static void mg_plane_tangents(const mg_real *n, mg_real *t1, mg_real *t2) {
  const int least = fabs(n[0]) <= fabs(n[1]) && fabs(n[0]) <= fabs(n[2]) ? 0 : fabs(n[1]) <= fabs(n[2]) ? 1 : 2;
  mg_real axis[3] = {0, 0, 0};
  axis[least] = 1;
  mg_cross_product(n, axis, t1);
  mg_normalise3(t1);
  mg_cross_product(n, t1, t2);
}

/* T' W T of the bend of a surface cell in the axes of its view, for two tangents. */
static void mg_bend_along(const mg_cell_view *view, const mg_real *t1, const mg_real *t2, mg_real *out) {
  mg_real a[3], b[3], Wa[3], Wb[3];
  for (int k = 0; k < 3; k++) a[k] = t1[k], b[k] = t2[k];
  if (view->rotation) mg_rotate_back(view->rotation, a, a), mg_rotate_back(view->rotation, b, b);
  mg_symmetric_times(view->cell->bend, a, Wa), mg_symmetric_times(view->cell->bend, b, Wb);
  out[0] = mg_dot3(a, Wa), out[1] = out[2] = mg_dot3(a, Wb), out[3] = mg_dot3(b, Wb);
}

/* Curvature vector of a curve cell in the axes of its view. */
static void mg_curvature_vector(const mg_cell_view *view, mg_real *out) {
  if (view->rotation) {
    const mg_real *R = view->rotation, *k = view->cell->bend;
    for (int i = 0; i < 3; i++) out[i] = R[i] * k[0] + R[3 + i] * k[1] + R[6 + i] * k[2];
  } else
    for (int i = 0; i < 3; i++) out[i] = view->cell->bend[i];
}

/* Bound of the change over a curve cell of the component of its curvature vector along x, |x| given. */
static mg_real mg_curvature_change_along(const mg_cell_view *view, const mg_real *x) {
  mg_real a[3] = {x[0], x[1], x[2]};
  if (view->rotation) mg_rotate_back(view->rotation, a, a);
  return fabs(a[0]) * view->cell->bend_change[0] + fabs(a[1]) * view->cell->bend_change[1] +
         fabs(a[2]) * view->cell->bend_change[2];
}

/* Of a surface cell, for a vector x: W x in the axes of the view, and a bound of |x.(W' - W) y| for W' anywhere in the
   cell and y from its middle to any of its points. */
static mg_real mg_bend_error_along(const mg_cell_view *view, const mg_real *x, mg_real *bend) {
  const mg_real *dW = view->cell->bend_change;
  mg_real a[3] = {x[0], x[1], x[2]}, W[3], change[3];
  if (view->rotation) mg_rotate_back(view->rotation, a, a);
  mg_symmetric_times(view->cell->bend, a, W);
  for (int i = 0; i < 3; i++) a[i] = fabs(a[i]);
  mg_symmetric_times(dW, a, change);
  for (int i = 0; i < 3; i++) {
    const mg_real *R = view->rotation;
    bend[i] = R ? R[i] * W[0] + R[3 + i] * W[1] + R[6 + i] * W[2] : W[i];
  }
  return mg_dot3(change, view->cell->extent);
}

/* a b for 2 by 2 matrices by columns. */
static void mg_product2(const mg_real *a, const mg_real *b, mg_real *out) {
  out[0] = a[0] * b[0] + a[2] * b[1], out[1] = a[1] * b[0] + a[3] * b[1];
  out[2] = a[0] * b[2] + a[2] * b[3], out[3] = a[1] * b[2] + a[3] * b[3];
}

static mg_real mg_sum_size(const mg_real *a, const mg_real *b) {
  const mg_real sum[3] = {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
  return sqrt(mg_dot3(sum, sum));
}

/* True if one of the features is a hollow about the curve or point that its view shows. */
static int mg_is_hollow(const mg_cell_view *a, const mg_cell_view *b) { return a->tube < 0 || b->tube < 0; }

/* Limits of the distance along the normal of a surface, of what the other view shows: the gap and the other's tube. */
static mg_search_limits mg_limits_along_normal(const mg_cell_view *a, const mg_cell_view *b,
                                               const mg_search_limits *limits) {
  mg_search_limits moved = *limits;
  moved.gap += a->tube + b->tube, moved.depth -= a->tube + b->tube;
  return moved;
}

/* Distance d of critical points along the normal N of A: d N.n = n.(b - a), where N.n is 1 - |N - n|^2/2. Sets the
   middle of its range within the limits, and half the width. Returns 0 if it has none. */
static int mg_gap_estimate(const mg_cell_view *a, const mg_cell_view *b, const mg_real *v,
                           const mg_search_limits *limits, mg_real *d, mg_real *error) {
  const mg_real along = mg_dot3(a->direction, v),
                across =
                    mg_min(mg_extent_along(a, a->direction) + mg_extent_along(b, a->direction), a->radius + b->radius),
                cosine = 1 - a->spread * a->spread / 2;
  mg_real low = along - across, high = along + across;
  if (low < 0) low /= cosine;
  if (high > 0) high /= cosine;
  low = mg_max(low, -limits->depth), high = mg_min(high, limits->gap);
  if (low > high) return 0;
  *d = low + (high - low) / 2, *error = (high - low) / 2;
  return 1;
}

/* True if the gap of two surfaces has no minimum where they are parallel at a distance d: the surface parallel to A
   through b is not less curved than B. K = W_A + W_B (1 + d W_A) is known to `error`. */
static int mg_is_saddle(const mg_real *WA, const mg_real *WB, mg_real d, mg_real error) {
  const mg_real N[4] = {1 + d * WA[0], d * WA[1], d * WA[2], 1 + d * WA[3]}, least = mg_smallest_eigenvalue(N);
  if (!(least > (mg_real)0.01)) return 0;
  const mg_real determinant = N[0] * N[3] - N[1] * N[2];
  const mg_real inverse[4] = {N[3] / determinant, -N[1] / determinant, -N[2] / determinant, N[0] / determinant};
  mg_real parallel[4];
  mg_product2(WA, inverse, parallel);
  for (int k = 0; k < 4; k++) parallel[k] += WB[k];
  return mg_smallest_eigenvalue(parallel) < -2 * error / least;
}

static int mg_judge_surfaces(const mg_cell_view *a, const mg_cell_view *b, const mg_real *v,
                             const mg_search_limits *limits) {
  const mg_cell *A = a->cell, *B = b->cell;
  mg_real t1[3], t2[3], WA[4], WB[4], WBWA[4], d, gap_error;
  if (!mg_gap_estimate(a, b, v, limits, &d, &gap_error)) return MG_CELLS_APART;
  const mg_real widest = fabs(d) + gap_error, tilt = mg_sum_size(a->direction, b->direction);
  mg_plane_tangents(a->direction, t1, t2);
  mg_bend_along(a, t1, t2, WA), mg_bend_along(b, t1, t2, WB), mg_product2(WB, WA, WBWA);
  const mg_real across[2] = {mg_dot3(t1, v), mg_dot3(t2, v)}, stretch = 1 + widest * (A->bend_size + A->bend_error);
  mg_linear_part at = {2, {0}, {0}, a->radius, {0}, {0}, 0, {0}, {0}};
  for (int k = 0; k < 4; k++) at.K[k] = WA[k] + WB[k] + d * WBWA[k];
  at.r[0] = mg_dot3(t1, b->direction) - WB[0] * across[0] - WB[2] * across[1];
  at.r[1] = mg_dot3(t2, b->direction) - WB[1] * across[0] - WB[3] * across[1];
  mg_find_directions(&at);
  for (int i = 0; i < 2; i++) {
    mg_real x[3], W[3];
    for (int k = 0; k < 3; k++) x[k] = at.u[2 * i] * t1[k] + at.u[2 * i + 1] * t2[k];
    const mg_real of_bends = mg_bend_error_along(a, x, W) + mg_bend_error_along(b, x, W);
    const mg_real lag = (A->bend_error * widest + A->bend_size * gap_error) * sqrt(mg_dot3(W, W)) * a->radius;
    at.error[i] = of_bends + lag + fabs(mg_dot3(W, a->direction)) * mg_extent_along(b, a->direction);
    mg_set_reach(&at, i, a, t1, t2);
  }
  const mg_real of_a = A->bend_error * (1 + B->bend_size * widest) + B->bend_size * A->bend_size * gap_error;
  const mg_real of_b = B->bend_error + B->bend_size * tilt;
  at.slope_error = (of_a + of_b * stretch + B->bend_size * a->spread * (a->spread + b->spread) * (1 + stretch)) * 5 / 4;
  if (mg_is_saddle(WA, WB, d, at.slope_error)) return MG_CELLS_APART;
  mg_real y[2], y_error;
  const int verdict = mg_solve_linear_part(&at, y, &y_error);
  if (verdict != MG_CELLS_REGULAR && verdict != MG_CELLS_SINGLE) return verdict;
  const mg_real moved[2] = {y[0] + d * (WA[0] * y[0] + WA[2] * y[1]) - across[0],
                            y[1] + d * (WA[1] * y[0] + WA[3] * y[1]) - across[1]};
  const mg_real slack = stretch * y_error + (A->bend_error * widest + A->bend_size * gap_error) * a->radius;
  return mg_length2(moved[0], moved[1]) > b->radius + slack ? MG_CELLS_APART : verdict;
}

static int mg_judge_surface_plane(const mg_cell_view *surface, const mg_cell_view *plane) {
  const mg_cell *S = surface->cell;
  mg_real t1[3], t2[3];
  mg_linear_part at = {2, {0}, {0}, surface->radius, {0}, {0}, 0, {0}, {0}};
  mg_plane_tangents(plane->direction, t1, t2);
  mg_bend_along(surface, t1, t2, at.K);
  at.r[0] = mg_dot3(t1, surface->direction), at.r[1] = mg_dot3(t2, surface->direction);
  const mg_real error = S->bend_error + S->bend_size * mg_sum_size(surface->direction, plane->direction);
  mg_find_directions(&at);
  for (int i = 0; i < 2; i++) {
    mg_real x[3], W[3];
    for (int k = 0; k < 3; k++) x[k] = at.u[2 * i] * t1[k] + at.u[2 * i + 1] * t2[k];
    at.error[i] = mg_bend_error_along(surface, x, W) +
                  fabs(mg_dot3(W, plane->direction)) * mg_extent_along(surface, plane->direction);
    mg_set_reach(&at, i, surface, t1, t2);
  }
  at.slope_error = error * 5 / 4;
  if (mg_smallest_eigenvalue(at.K) < -at.slope_error) return MG_CELLS_APART;
  return mg_judge_linear_part(&at);
}

static int mg_judge_surface_point(const mg_cell_view *a, const mg_cell_view *b, const mg_real *v,
                                  const mg_search_limits *limits) {
  const mg_cell *A = a->cell;
  mg_real t1[3], t2[3], d, gap_error;
  if (!mg_gap_estimate(a, b, v, limits, &d, &gap_error)) return MG_CELLS_APART;
  mg_linear_part at = {2, {0}, {0}, a->radius, {0}, {0}, 0, {0}, {0}};
  mg_plane_tangents(a->direction, t1, t2);
  mg_bend_along(a, t1, t2, at.K);
  for (int k = 0; k < 4; k++) at.K[k] = (k % 3 == 0) + d * at.K[k];
  at.r[0] = -mg_dot3(t1, v), at.r[1] = -mg_dot3(t2, v);
  const mg_real error = (fabs(d) + gap_error) * A->bend_error + gap_error * A->bend_size;
  mg_find_directions(&at);
  for (int i = 0; i < 2; i++) mg_set_reach(&at, i, a, t1, t2);
  at.error[0] = at.error[1] = error * a->radius, at.slope_error = (error + a->spread * a->spread) * 5 / 4;
  const mg_real outward = b->tube < 0 ? -1 : 1;
  const mg_real hessian[4] = {outward * at.K[0], outward * at.K[1], outward * at.K[2], outward * at.K[3]};
  if (mg_smallest_eigenvalue(hessian) < -at.slope_error) return MG_CELLS_APART;
  return mg_judge_linear_part(&at);
}

/* True if the gap between a surface and a tube about a curve cannot be least across the curve, along e: outside the
   tube the curve, at the distance d, has to be short of the focal point of the surface, in a hollow beyond it.
   w: tangent of the curve and W: bend of the surface, in its tangents. */
static int mg_is_focal_side_wrong(const mg_cell_view *a, const mg_cell_view *b, const mg_real *w, const mg_real *W,
                                  mg_real d, mg_real gap_error) {
  const mg_real size = mg_length2(w[0], w[1]), turned = a->spread + b->spread, widest = fabs(d) + gap_error;
  if (!(size > (mg_real)0.5) || (b->tube > 0 ? d - gap_error : -d - gap_error) <= 0) return 0;
  const mg_real e[2] = {-w[1] / size, w[0] / size};
  const mg_real along = e[0] * (W[0] * e[0] + W[2] * e[1]) + e[1] * (W[1] * e[0] + W[3] * e[1]);
  const mg_real error = widest * a->cell->bend_error + gap_error * a->cell->bend_size +
                        widest * a->cell->bend_size * 4 * turned * (1 + turned);
  return b->tube > 0 ? 1 + d * along < -error : 1 + d * along > error;
}

static int mg_judge_surface_curve(const mg_cell_view *a, const mg_cell_view *b, const mg_real *v,
                                  const mg_search_limits *limits) {
  const mg_cell *A = a->cell, *B = b->cell;
  mg_real t1[3], t2[3], W[4], curvature[3], d, gap_error;
  if (!mg_gap_estimate(a, b, v, limits, &d, &gap_error)) return MG_CELLS_APART;
  const mg_real widest = fabs(d) + gap_error;
  mg_plane_tangents(a->direction, t1, t2);
  mg_bend_along(a, t1, t2, W), mg_curvature_vector(b, curvature);
  const mg_real N[4] = {1 + d * W[0], d * W[1], d * W[2], 1 + d * W[3]}, determinant = N[0] * N[3] - N[1] * N[2];
  const mg_real inverse[4] = {N[3] / determinant, -N[1] / determinant, -N[2] / determinant, N[0] / determinant};
  mg_real size = 0, WN[4];
  for (int k = 0; k < 4; k++) size += inverse[k] * inverse[k];
  size = sqrt(size);
  mg_product2(W, inverse, WN);
  const mg_real w[2] = {mg_dot3(t1, b->direction), mg_dot3(t2, b->direction)},
                across[2] = {mg_dot3(t1, v), mg_dot3(t2, v)};
  mg_real along[2];
  for (int k = 0; k < 2; k++) along[k] = w[0] * WN[2 * k] + w[1] * WN[2 * k + 1];
  mg_linear_part at = {1, {0}, {0}, b->radius, {0}, {0}, 0, {0}, {0}};
  at.K[0] = mg_dot3(a->direction, curvature) + along[0] * w[0] + along[1] * w[1];
  at.r[0] = mg_dot3(a->direction, b->direction) + along[0] * across[0] + along[1] * across[1];
  const mg_real lag = widest * A->bend_error + gap_error * A->bend_size; /* of (1 + d W) y_A */
  const mg_real bend_a = A->bend_size + A->bend_error, bend_b = B->bend_size + B->bend_error;
  const mg_real moved_a = (1 + a->spread) / mg_max(1 / size - lag, (mg_real)0); /* |y_A| by s_B */
  const mg_real turned_b = mg_curvature_change_along(b, a->direction);
  at.error[0] = A->bend_error * a->radius + turned_b * b->radius +
                A->bend_size * size * (lag * a->radius + b->spread * b->radius) +
                bend_a * a->radius * bend_b * b->radius;
  at.slope_error = (A->bend_error * moved_a + turned_b + A->bend_size * size * (lag * moved_a + b->spread) +
                    a->spread * bend_b + bend_a * moved_a * b->spread) *
                   5 / 4;
  if (b->tube >= 0 && mg_smallest_eigenvalue(N) > (mg_real)0.01 && at.K[0] < -at.slope_error) return MG_CELLS_APART;
  if (b->tube != 0 && mg_is_focal_side_wrong(a, b, w, W, d, gap_error)) return MG_CELLS_APART;
  mg_real s, s_error;
  const int verdict = mg_solve_linear_part(&at, &s, &s_error);
  if (verdict != MG_CELLS_REGULAR && verdict != MG_CELLS_SINGLE) return verdict;
  const mg_real right[2] = {w[0] * s + across[0], w[1] * s + across[1]};
  const mg_real y[2] = {inverse[0] * right[0] + inverse[2] * right[1], inverse[1] * right[0] + inverse[3] * right[1]};
  const mg_real slack = size * (s_error + lag * a->radius + b->spread * b->radius);
  return mg_length2(y[0], y[1]) > a->radius + slack ? MG_CELLS_APART : verdict;
}

static int mg_judge_curve_plane(const mg_cell_view *curve, const mg_cell_view *plane) {
  mg_real curvature[3];
  mg_linear_part at = {1, {0}, {0}, curve->radius, {0}, {0}, 0, {0}, {0}};
  mg_curvature_vector(curve, curvature);
  at.K[0] = mg_dot3(plane->direction, curvature), at.r[0] = mg_dot3(plane->direction, curve->direction);
  at.slope_error = mg_curvature_change_along(curve, plane->direction), at.error[0] = at.slope_error * curve->radius;
  if (curve->tube < 0 || at.K[0] < -at.slope_error) return MG_CELLS_APART;
  return mg_judge_linear_part(&at);
}

static int mg_judge_curve_point(const mg_cell_view *a, const mg_cell_view *b, const mg_real *v) {
  mg_real curvature[3];
  mg_linear_part at = {1, {0}, {0}, a->radius, {0}, {0}, 0, {0}, {0}};
  mg_curvature_vector(a, curvature);
  at.K[0] = mg_dot3(v, curvature) - 1, at.r[0] = mg_dot3(v, a->direction);
  const mg_real error =
      mg_curvature_change_along(a, v) + a->spread + a->radius * (a->cell->bend_size + a->cell->bend_error);
  at.error[0] = error * a->radius, at.slope_error = error * 5 / 4;
  if ((b->tube < 0 ? -1 : 1) * at.K[0] > at.slope_error) return MG_CELLS_APART;
  return mg_judge_linear_part(&at);
}

static int mg_judge_curves(const mg_cell_view *a, const mg_cell_view *b, const mg_real *v) {
  mg_real curvature_a[3], curvature_b[3];
  const mg_real both = a->radius + b->radius, cosine = mg_dot3(a->direction, b->direction);
  mg_linear_part at = {2, {0}, {0}, sqrt(a->radius * a->radius + b->radius * b->radius), {0}, {0}, 0, {0}, {0}};
  mg_curvature_vector(a, curvature_a), mg_curvature_vector(b, curvature_b);
  at.K[0] = mg_dot3(v, curvature_a) - 1, at.K[2] = cosine, at.r[0] = mg_dot3(v, a->direction);
  at.K[1] = -cosine, at.K[3] = mg_dot3(v, curvature_b) + 1, at.r[1] = mg_dot3(v, b->direction);
  const mg_real of_a = mg_curvature_change_along(a, v) + a->spread + both * (a->cell->bend_size + a->cell->bend_error),
                of_b = mg_curvature_change_along(b, v) + b->spread + both * (b->cell->bend_size + b->cell->bend_error);
  const mg_real first = of_a * a->radius + b->spread * b->radius, second = of_b * b->radius + a->spread * a->radius;
  mg_find_directions(&at);
  at.error[0] = at.error[1] = sqrt(first * first + second * second);
  at.slope_error = (of_a + of_b + a->spread + b->spread) * 5 / 4;
  const mg_real saddle = (mg_is_hollow(a, b) ? -1 : 1) * (at.K[0] * at.K[3] - at.K[1] * at.K[2]);
  if (saddle > at.slope_error * at.size[0]) return MG_CELLS_APART;
  if (!mg_is_hollow(a, b) && (at.K[0] > at.slope_error || at.K[3] < -at.slope_error)) return MG_CELLS_APART;
  mg_real s[2], s_error;
  const int verdict = mg_solve_linear_part(&at, s, &s_error);
  if (verdict != MG_CELLS_REGULAR && verdict != MG_CELLS_SINGLE) return verdict;
  return fabs(s[0]) > a->radius + s_error || fabs(s[1]) > b->radius + s_error ? MG_CELLS_APART : verdict;
}

/* True if the line between points of two cells, of the length `longest` at most, cannot be normal to the surface of the
   first, seen along the tangents in which the first extends. */
static int mg_is_beside(const mg_cell_view *surface, const mg_cell_view *other, const mg_real *v, mg_real longest) {
  for (int a = 0; a < 2; a++) {
    mg_real w[3];
    const mg_real along = mg_dot3(surface->slope[a], surface->direction);
    for (int k = 0; k < 3; k++) w[k] = surface->slope[a][k] - along * surface->direction[k];
    if (!mg_normalise3(w)) continue;
    const mg_real both = mg_extent_along(surface, w) + mg_extent_along(other, w);
    if (fabs(mg_dot3(v, w)) > both + surface->spread * longest) return 1;
  }
  return 0;
}

/* True if points of two cells are farther than `reach` from each other. |v| given. */
static int mg_are_cells_distant(const mg_cell_view *a, const mg_cell_view *b, const mg_real *v, mg_real distance,
                                mg_real reach) {
  if (distance - a->radius - b->radius > reach) return 1;
  return distance > reach && distance * (distance - reach) > mg_extent_along(a, v) + mg_extent_along(b, v);
}

/* True if the gap along the normal of a surface is beyond the limits. */
static int mg_is_gap_beyond(const mg_cell_view *surface, const mg_cell_view *other, const mg_real *v,
                            const mg_search_limits *limits) {
  mg_real d, error;
  if (surface->kind != MG_VIEW_SURFACE || surface->spread > 1) return 0;
  return !mg_gap_estimate(surface, other, v, limits, &d, &error);
}

/* True if the gap of a curve and a plane, a curve, or a point is beyond the limits; or of a surface and a plane or a
   point. */
static int mg_is_view_distant(const mg_cell_view *a, const mg_cell_view *b, const mg_real *v, mg_real distance,
                              const mg_search_limits *limits) {
  const mg_real both = a->radius + b->radius, near = distance - both, far = distance + both, tube = a->tube + b->tube;
  if (b->kind == MG_VIEW_PLANE) {
    const mg_real height = -mg_dot3(b->direction, v) - tube, extent = mg_extent_along(a, b->direction);
    return height - extent > limits->gap || height + extent < -limits->depth;
  }
  return mg_is_hollow(a, b) ? -tube - far > limits->gap || -tube - near < -limits->depth
                            : near - tube > limits->gap || far - tube < -limits->depth;
}

/* True if the directions of the cells differ too much for a critical pair: two surfaces face each other, a curve is
   along a surface. */
static int mg_are_directions_apart(const mg_cell_view *a, const mg_cell_view *b) {
  const mg_real spread = a->spread + b->spread;
  const int surfaces = (a->kind == MG_VIEW_SURFACE) + (b->kind == MG_VIEW_SURFACE || b->kind == MG_VIEW_PLANE);
  if (b->kind == MG_VIEW_POINT || surfaces == 0) return 0;
  return surfaces == 2 ? mg_sum_size(a->direction, b->direction) > spread
                       : fabs(mg_dot3(a->direction, b->direction)) > spread;
}

/* True if the directions or the distance of the cells rule out a critical pair within the limits. The line between
   critical points is no longer than the limits allow. */
MG_INTERNAL int mg_are_cells_apart(const mg_cell_view *a, const mg_cell_view *b, const mg_search_limits *limits) {
  const mg_real v[3] = {b->centre[0] - a->centre[0], b->centre[1] - a->centre[1], b->centre[2] - a->centre[2]};
  const mg_real back[3] = {-v[0], -v[1], -v[2]}, distance = sqrt(mg_dot3(v, v)), both = a->radius + b->radius;
  const mg_search_limits moved = mg_limits_along_normal(a, b, limits);
  mg_real longest = distance + both;
  if (!(both < MG_MAX / 4)) return 0;
  if (mg_are_directions_apart(a, b)) return 1;
  const int is_surface = a->kind == MG_VIEW_SURFACE || b->kind == MG_VIEW_SURFACE;
  if (b->cell) {
    const mg_real reach = mg_max(is_surface || !mg_is_hollow(a, b) ? moved.gap : limits->depth - a->tube - b->tube,
                                 is_surface ? moved.depth : 0);
    if (mg_are_cells_distant(a, b, v, distance, reach)) return 1;
    longest = mg_min(longest, reach);
  }
  if ((!b->cell || !is_surface) && mg_is_view_distant(a, b, v, distance, limits)) return 1;
  if (b->kind == MG_VIEW_PLANE) return 0;
  for (int side = 0; side < 2; side++) {
    const mg_cell_view *at = side ? b : a;
    if (at->kind == MG_VIEW_POINT) continue;
    const mg_real along = fabs(mg_dot3(v, at->direction)), slack = both + at->spread * longest;
    if (at->kind == MG_VIEW_CURVE ? along > slack
                                  : sqrt(mg_max(distance * distance - along * along, (mg_real)0)) > slack)
      return 1;
    if (at->kind == MG_VIEW_SURFACE && at->spread < 1 && mg_is_beside(at, side ? a : b, v, longest)) return 1;
  }
  return b->cell && (mg_is_gap_beyond(a, b, v, &moved) || mg_is_gap_beyond(b, a, back, &moved));
}

MG_INTERNAL int mg_judge_cells(const mg_cell_view *a, const mg_cell_view *b, const mg_search_limits *limits) {
  const mg_real v[3] = {b->centre[0] - a->centre[0], b->centre[1] - a->centre[1], b->centre[2] - a->centre[2]};
  const mg_real back[3] = {-v[0], -v[1], -v[2]};
  const mg_search_limits moved = mg_limits_along_normal(a, b, limits);
  const int curve = a->kind == MG_VIEW_CURVE;
  switch (b->kind) {
    case MG_VIEW_PLANE:
      return curve ? mg_judge_curve_plane(a, b) : mg_judge_surface_plane(a, b);
    case MG_VIEW_POINT:
      return curve ? mg_judge_curve_point(a, b, v) : mg_judge_surface_point(a, b, v, &moved);
    case MG_VIEW_CURVE:
      return curve ? mg_judge_curves(a, b, v) : mg_judge_surface_curve(a, b, v, &moved);
    default:
      break;
  }
  return curve ? mg_judge_surface_curve(b, a, back, &moved) : mg_judge_surfaces(a, b, v, &moved);
}
