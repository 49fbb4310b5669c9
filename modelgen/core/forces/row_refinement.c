/* Forces of badly conditioned rows, such as those of heavy bodies that stand on light ones, to rounding. The matrix
   A = J M^-1 J^T squares the condition of G = M^-1/2 J^T, and its entries, sums over light and heavy bodies, have lost
   what the heavy ones contribute. So G is factored instead, G = Q R by the modified method of Gram and Schmidt, and
   R^T R x = -r is corrected by residuals that pass through the bodies (corrected seminormal equations; A. Bjorck,
   Numerical Methods for Least Squares Problems, 1996, section 2.4.3): rounding there is that of the loads on each body,
   which forces answer to without amplification. Works on the rows of c->islands.rows, whose M^-1 J^T is known; writes
   the amounts, and how uncertain rounding leaves them, c->lcp.rounding. */
#include "forces/forces.h"
#include "base/base.h"
#include "model/model.h"

#define MG_BADLY_CONDITIONED 1e-3 /* least pivot of the scaled matrix below which rows are refined */

enum { MG_REFINEMENTS = 8 }; /* most corrections */

#define MG_ROUNDING_FACTOR 4 /* times the error that rounding makes with its signs arranged in one way */

/* Factored rows. */
typedef struct {
  int n, n_body;    /* rows; bodies that forces move */
  int *body;        /* [n_body] these */
  int *local[2];    /* [n] number among them of o and f of each row, or -1 */
  int *begin, *end; /* [n] range of the entries of each column of Q that may not be zero */
  mg_real *G, *R;   /* [6 n_body n] G, then Q; [n n] */
  mg_real *d;       /* [n] norm of each column of G */
  mg_real *x;       /* [n] right-hand side, then solution */
  mg_real *wrench;  /* [6 n_body] sum over the rows */
} mg_row_factors;

/* Number of a body among those of the rows; -1 if forces do not move it. */
static int mg_local_body(const mg_context *c, mg_row_factors *s, int body) {
  if (!mg_is_moved_by_forces(c, body)) return -1;
  for (int k = s->n_body - 1; k >= 0; k--)
    if (s->body[k] == body) return k;
  s->body[s->n_body] = body;
  return s->n_body++;
}

/* Divides the memory, that of the solvers. Returns 0 if there is too little, as where a row acts on two bodies of its
   own. */
static int mg_open_row_factors(mg_context *c, int n, mg_row_factors *s) {
  s->n = n, s->n_body = 0;
  s->local[0] = c->lcp.iwork, s->local[1] = s->local[0] + n, s->begin = s->local[1] + n, s->end = s->begin + n,
  s->body = s->end + n;
  for (int r = 0; r < n; r++) {
    s->local[0][r] = mg_local_body(c, s, c->contacts.o[c->islands.rows[r]]);
    s->local[1][r] = mg_local_body(c, s, c->contacts.f[c->islands.rows[r]]);
  }
  s->G = c->lcp.work, s->R = s->G + 6L * s->n_body * n, s->d = s->R + (long)n * n, s->x = s->d + n,
  s->wrench = s->x + n;
  return s->n_body <= n + 1;
}

/* U (xx, yx, zx, yy, zy, zz) with W = U^T U for a symmetric W = (w_k) in columns, upper triangle by columns. */
static void mg_square_root_three(const mg_real *w, mg_real *U) {
  U[0] = sqrt(w[0]), U[1] = w[3] / U[0], U[2] = w[6] / U[0];
  U[3] = sqrt(w[4] - U[1] * U[1]), U[4] = (w[7] - U[1] * U[2]) / U[3];
  U[5] = sqrt(w[8] - U[2] * U[2] - U[4] * U[4]);
}

/* Column of G of a row, with the masses of the bodies or, `unweighted`, with one mass for all. */
static void mg_set_weighted_column(const mg_context *c, const mg_row_factors *s, int r, int unweighted) {
  mg_real *column = s->G + 6L * s->n_body * r;
  for (int k = 0; k < 6 * s->n_body; k++) column[k] = 0;
  s->begin[r] = 6 * s->n_body, s->end[r] = 0;
  for (int side = 0; side < 2; side++) {
    const int body = s->local[side][r];
    if (body < 0) continue;
    const mg_real *J = c->rows.J + 12 * c->islands.rows[r] + 6 * side,
                  *w = c->system->mass_inverse + 10 * s->body[body];
    mg_real *out = column + 6 * body, U[6] = {0};
    if (6 * body < s->begin[r]) s->begin[r] = 6 * body;
    if (6 * body + 6 > s->end[r]) s->end[r] = 6 * body + 6;
    for (int k = 0; k < 3; k++) out[k] += (unweighted ? 1 : sqrt(w[0])) * J[k];
    for (int k = 3; k < 6 && unweighted; k++) out[k] += J[k] / c->system->length;
    if (!(w[1] > 0) || unweighted) continue;
    mg_square_root_three(w + 1, U);
    out[3] += U[0] * J[3] + U[1] * J[4] + U[2] * J[5], out[4] += U[3] * J[4] + U[4] * J[5], out[5] += U[5] * J[5];
  }
}

/* Norm of column r; divides the column by it. */
static mg_real mg_normalise_column(const mg_row_factors *s, int r) {
  mg_real *own = s->G + 6L * s->n_body * r, sum = 0;
  for (int k = s->begin[r]; k < s->end[r]; k++) sum += own[k] * own[k];
  for (int k = s->begin[r]; k < s->end[r] && sum > 0; k++) own[k] /= sqrt(sum);
  return sqrt(sum);
}

/* Takes the part along column j of Q out of column r and returns its size. */
static mg_real mg_take_out_column(const mg_row_factors *s, int j, int r) {
  const mg_real *q = s->G + 6L * s->n_body * j;
  mg_real *own = s->G + 6L * s->n_body * r, along = 0;
  const int begin = s->begin[j] > s->begin[r] ? s->begin[j] : s->begin[r],
            end = s->end[j] < s->end[r] ? s->end[j] : s->end[r];
  for (int k = begin; k < end; k++) along += q[k] * own[k];
  if (along == 0) return 0;
  for (int k = s->begin[j]; k < s->end[j]; k++) own[k] -= along * q[k];
  if (s->begin[j] < s->begin[r]) s->begin[r] = s->begin[j];
  if (s->end[j] > s->end[r]) s->end[r] = s->end[j];
  return along;
}

/* Factors the rows. Returns 0 if less than `floor` of one is independent of those before it. */
static int mg_factor_weighted_rows(const mg_context *c, mg_row_factors *s, int unweighted, mg_real floor) {
  for (int r = 0; r < s->n; r++) {
    mg_real *R = s->R + (long)s->n * r;
    mg_set_weighted_column(c, s, r, unweighted);
    s->d[r] = mg_normalise_column(s, r);
    for (int j = 0; j < r; j++) R[j] = mg_take_out_column(s, j, r);
    R[r] = mg_normalise_column(s, r);
    if (!(s->d[r] > 0) || !(R[r] > floor)) return 0;
  }
  return 1;
}

/* x = -(R^T R)^-1 x in the scale of d. */
static void mg_solve_factored_rows(const mg_row_factors *s) {
  const int n = s->n;
  for (int r = 0; r < n; r++) {
    s->x[r] /= -s->d[r];
    for (int j = 0; j < r; j++) s->x[r] -= s->R[j + (long)n * r] * s->x[j];
    s->x[r] /= s->R[r + (long)n * r];
  }
  for (int r = n - 1; r >= 0; r--) {
    s->x[r] /= s->R[r + (long)n * r];
    for (int j = 0; j < r; j++) s->x[j] -= s->R[j + (long)n * r] * s->x[r];
  }
  for (int r = 0; r < n; r++) s->x[r] /= s->d[r];
}

/* x = rate + J (M^-1 J^T amount), through the bodies. */
static void mg_set_row_residuals(const mg_context *c, const mg_row_factors *s, const mg_real *rate,
                                 const mg_real *amount) {
  const int *rows = c->islands.rows;
  mg_zero_reals(s->wrench, 6L * s->n_body);
  for (int r = 0; r < s->n; r++)
    for (int side = 0; side < 2; side++)
      if (s->local[side][r] >= 0)
        mg_add_multiple6(amount[rows[r]], c->rows.MJ + 12 * rows[r] + 6 * side, s->wrench + 6 * s->local[side][r]);
  for (int r = 0; r < s->n; r++) {
    s->x[r] = rate[rows[r]];
    for (int side = 0; side < 2; side++)
      if (s->local[side][r] >= 0)
        s->x[r] += mg_dot6(c->rows.J + 12 * rows[r] + 6 * side, s->wrench + 6 * s->local[side][r]);
  }
}

/* x = what rounding may change in the rates: a unit in the last place of the acceleration that each force gives each
   body, in alternating directions, and of those of the loads. */
static void mg_set_row_rounding(const mg_context *c, const mg_row_factors *s, const mg_real *amount) {
  const int *rows = c->islands.rows;
  mg_zero_reals(s->wrench, 6L * s->n_body);
  for (int r = 0; r < s->n; r++)
    for (int side = 0; side < 2; side++)
      for (int k = 0, b = s->local[side][r]; k < 6 && b >= 0; k++)
        s->wrench[6 * b + k] +=
            (b % 2 ? -MG_EPS : MG_EPS) * fabs(amount[rows[r]] * c->rows.MJ[12 * rows[r] + 6 * side + k]);
  for (int r = 0; r < s->n; r++) {
    mg_real own = fabs(c->rows.gamma[rows[r]]), through = 0;
    for (int side = 0; side < 2; side++)
      for (int k = 0, b = s->local[side][r]; k < 6 && b >= 0; k++) {
        const mg_real J = c->rows.J[12 * rows[r] + 6 * side + k];
        own += fabs(J * c->bodies.acceleration[6 * s->body[b] + k]), through += J * s->wrench[6 * b + k];
      }
    s->x[r] = through + (r % 2 ? -MG_EPS : MG_EPS) * own;
  }
}

/* Largest entry of x, and of the amounts. */
static mg_real mg_largest_amount(const mg_context *c, const mg_row_factors *s, const mg_real *amount) {
  mg_real most = 0;
  for (int r = 0; r < s->n; r++) most = mg_max(most, fabs(amount ? amount[c->islands.rows[r]] : s->x[r]));
  return most;
}

/* Root of the sum of squares of x, or of the amounts, over the contacts among the rows. */
static mg_real mg_contact_norm(const mg_context *c, const mg_row_factors *s, const mg_real *amount) {
  mg_real sum = 0;
  for (int r = 0; r < s->n; r++) {
    const mg_real value = amount ? amount[c->islands.rows[r]] : s->x[r];
    sum += c->islands.rows[r] < c->system->n_contact ? value * value : 0;
  }
  return sqrt(sum);
}

/* True if the rows are independent whatever the masses are, so that masses alone make them badly conditioned. */
static int mg_are_rows_independent(const mg_context *c, mg_row_factors *s) {
  return mg_factor_weighted_rows(c, s, 1, sqrt(MG_LCP_RANK(s->n)));
}

/* True if a row yields: G does not hold what it adds to the diagonal of A. */
static int mg_does_row_yield(const mg_context *c, int n) {
  for (int r = 0; r < n; r++)
    if (mg_row_yield(c, c->islands.rows[r]) > 0) return 1;
  return 0;
}

MG_INTERNAL void mg_refine_rows(mg_context *c, int n, int rank, const mg_real *rate, mg_real pivot, mg_real *amount) {
  mg_row_factors s;
  const int *rows = c->islands.rows;
  mg_real change = 0, last = MG_MAX;
  if (rank == n && (pivot > (mg_real)MG_BADLY_CONDITIONED || mg_does_row_yield(c, n))) {
    c->lcp.rounding = mg_max(c->lcp.rounding, MG_ROUNDING_FACTOR * (mg_real)n * (mg_real)n * MG_EPS / pivot);
    return;
  }
  if (rank < n && (c->system->n_joint_row || mg_does_row_yield(c, n))) return;
  if (!mg_open_row_factors(c, n, &s) || (rank < n && !mg_are_rows_independent(c, &s)) ||
      !mg_factor_weighted_rows(c, &s, 0, MG_LCP_RANK(n)))
    return;
  for (int r = 0; r < n; r++) amount[rows[r]] = 0;
  for (int pass = 0; pass < MG_REFINEMENTS; pass++, last = change) {
    mg_set_row_residuals(c, &s, rate, amount);
    mg_solve_factored_rows(&s);
    change = mg_largest_amount(c, &s, 0);
    for (int r = 0; r < n; r++) amount[rows[r]] += s.x[r];
    if (change > last / 2 || change <= MG_EPS * mg_largest_amount(c, &s, amount)) break;
  }
  const mg_real left = mg_contact_norm(c, &s, 0), size = mg_contact_norm(c, &s, amount);
  mg_set_row_rounding(c, &s, amount);
  mg_solve_factored_rows(&s);
  if (size > 0)
    c->lcp.rounding = mg_max(c->lcp.rounding, MG_ROUNDING_FACTOR * (left + mg_contact_norm(c, &s, 0)) / size);
}
