/* Forces of badly conditioned rows, such as those of heavy bodies that stand on light ones, to rounding. The matrix
   A = J M^-1 J^T squares the condition of G = M^-1/2 J^T, and its entries, sums over light and heavy bodies, have lost
   what the heavy ones contribute. So G is factored instead, G = Q R by the modified method of Gram and Schmidt, and
   R^T R x = -r is corrected by residuals that pass through the bodies (corrected seminormal equations; A. Bjorck,
   Numerical Methods for Least Squares Problems, 1996, section 2.4.3): rounding there is that of the loads on each body,
   which forces answer to without amplification. A row that yields, which adds 1 to its diagonal of A, has an entry 1
   of its own in G. Where slip makes friction a multiple of normal forces, A = J M^-1 B^T = G^T H with
   H = M^-1/2 B^T, and R^T W x = -r with W = Q^T H is solved, W by its LU factors. Works on the rows of c->islands.rows,
   whose M^-1 J^T is known, and those of their slip; writes the amounts, and how uncertain rounding leaves them,
   c->lcp.rounding. */
#include "forces/forces.h"
#include "base/base.h"
#include "model/model.h"
#include "solve/lcp/lcp_solvers.h"

#define MG_BADLY_CONDITIONED 1e-3 /* least pivot of the scaled matrix below which rows are refined */

enum { MG_REFINEMENTS = 8 }; /* most corrections */

#define MG_ROUNDING_FACTOR 4 /* times the error that rounding makes with its signs arranged in one way */

/* Factored rows. */
typedef struct {
  int n, n_body, size; /* rows; bodies that forces move; entries of a column of G: 6 n_body, then rows that yield */
  int slips;           /* 1: H differs from G */
  int *body;           /* [n_body] these */
  int *own;            /* [n] entry of its own of each row that yields, or -1 */
  int *begin, *end;    /* [n] range of the entries of each column of Q that may not be zero */
  int *swap;           /* [n] exchanges of rows in W */
  mg_real *G, *R, *W;  /* [size n] G, then Q; [n n]; [n n] if it slips */
  mg_real *d;          /* [n] norm of each column of G */
  mg_real *x;          /* [n] right-hand side, then solution */
  mg_real *column;     /* [size] a column of H; the sum of M^-1 B^T amount over the rows */
} mg_row_factors;

/* A row that a force acts along, times a factor. */
typedef struct {
  int row;
  mg_real factor;
} mg_force_part;

/* Number of a body among those of the rows; -1 if forces do not move it. */
static int mg_local_body(const mg_row_factors *s, int body) {
  for (int k = s->n_body - 1; k >= 0; k--)
    if (s->body[k] == body) return k;
  return -1;
}

/* Adds the bodies that row r acts on, and its own entry if it yields. */
static void mg_add_row(const mg_context *c, mg_row_factors *s, int r) {
  const int row = c->islands.rows[r];
  for (int side = 0; side < 2; side++) {
    const int body = side ? c->contacts.f[row] : c->contacts.o[row];
    if (mg_is_moved_by_forces(c, body) && mg_local_body(s, body) < 0) s->body[s->n_body++] = body;
  }
  s->own[r] = mg_row_yield(c, row) > 0 ? s->size++ : -1;
}

/* Divides the memory, that of the solvers. Returns 0 if there is too little, as where a row acts on two bodies of its
   own. */
static int mg_open_row_factors(mg_context *c, int n, int slips, mg_row_factors *s) {
  s->n = n, s->n_body = s->size = 0, s->slips = slips;
  s->own = c->lcp.iwork, s->begin = s->own + n, s->end = s->begin + n, s->swap = s->end + n, s->body = s->swap + n;
  for (int r = 0; r < n; r++) mg_add_row(c, s, r);
  for (int r = 0; r < n; r++) s->own[r] += s->own[r] >= 0 ? 6 * s->n_body : 0;
  s->size += 6 * s->n_body;
  s->G = c->lcp.work, s->R = s->G + (long)s->size * n, s->W = s->R + (long)n * n;
  s->d = s->W + (s->slips ? (long)n * n : 0), s->x = s->d + n, s->column = s->x + n;
  return (s->size + (s->slips ? 2LL : 1LL) * n) * n + 2LL * n + s->size <= mg_lcp_work_size(n);
}

/* Lists the rows that the force of row r acts along: its own, and those of its slip. Returns their number. */
static int mg_list_force_parts(const mg_context *c, const mg_row_factors *s, int r, mg_force_part *part) {
  int slip[MG_FRICTION_ROWS_MAX];
  mg_real ratio[MG_FRICTION_ROWS_MAX];
  const int n = s->slips ? mg_list_slip_rows(c, c->islands.rows[r], slip, ratio) : 0;
  part[0].row = c->islands.rows[r], part[0].factor = 1;
  for (int k = 0; k < n; k++) part[k + 1].row = slip[k], part[k + 1].factor = -ratio[k];
  return n + 1;
}

/* U (xx, yx, zx, yy, zy, zz) with W = U^T U for a symmetric W = (w_k) in columns, upper triangle by columns. */
static void mg_square_root_three(const mg_real *w, mg_real *U) {
  U[0] = sqrt(w[0]), U[1] = w[3] / U[0], U[2] = w[6] / U[0];
  U[3] = sqrt(w[4] - U[1] * U[1]), U[4] = (w[7] - U[1] * U[2]) / U[3];
  U[5] = sqrt(w[8] - U[2] * U[2] - U[4] * U[4]);
}

/* Adds M^-1/2 J^T of a row times a factor to a column, with the masses of the bodies or, `unweighted`, with one mass
   for all. Widens the range begin to end of entries that may not be zero. */
static void mg_add_weighted_row(const mg_context *c, const mg_row_factors *s, mg_force_part part, int unweighted,
                                mg_real *column, int *begin, int *end) {
  for (int side = 0; side < 2; side++) {
    const int body = mg_local_body(s, side ? c->contacts.f[part.row] : c->contacts.o[part.row]);
    if (body < 0) continue;
    const mg_real *J = c->rows.J + 12 * part.row + 6 * side, *w = c->system->mass_inverse + 10 * s->body[body];
    mg_real *out = column + 6 * body, U[6] = {0};
    if (6 * body < *begin) *begin = 6 * body;
    if (6 * body + 6 > *end) *end = 6 * body + 6;
    for (int k = 0; k < 3; k++) out[k] += part.factor * (unweighted ? 1 : sqrt(w[0])) * J[k];
    for (int k = 3; k < 6 && unweighted; k++) out[k] += part.factor * J[k] / c->system->length;
    if (!(w[1] > 0) || unweighted) continue;
    mg_square_root_three(w + 1, U);
    out[3] += part.factor * (U[0] * J[3] + U[1] * J[4] + U[2] * J[5]);
    out[4] += part.factor * (U[3] * J[4] + U[4] * J[5]), out[5] += part.factor * U[5] * J[5];
  }
}

/* Column of G of a row, or of H for `with_slip`; returns in begin and end where it may not be zero. */
static void mg_set_weighted_column(const mg_context *c, const mg_row_factors *s, int r, int unweighted, int with_slip,
                                   mg_real *column, int *begin, int *end) {
  mg_force_part part[MG_FRICTION_ROWS_MAX + 1];
  const int n = mg_list_force_parts(c, s, r, part);
  mg_zero_reals(column, s->size);
  *begin = s->size, *end = 0;
  for (int k = 0; k < (with_slip ? n : 1); k++) mg_add_weighted_row(c, s, part[k], unweighted, column, begin, end);
  if (s->own[r] < 0) return;
  column[s->own[r]] = 1, *end = s->own[r] + 1;
  if (s->own[r] < *begin) *begin = s->own[r];
}

/* Norm of column r; divides the column by it. */
static mg_real mg_normalise_column(const mg_row_factors *s, int r) {
  mg_real *own = s->G + (long)s->size * r, sum = 0;
  for (int k = s->begin[r]; k < s->end[r]; k++) sum += own[k] * own[k];
  for (int k = s->begin[r]; k < s->end[r] && sum > 0; k++) own[k] /= sqrt(sum);
  return sqrt(sum);
}

/* Takes the part along column j of Q out of column r and returns its size. */
static mg_real mg_take_out_column(const mg_row_factors *s, int j, int r) {
  const mg_real *q = s->G + (long)s->size * j;
  mg_real *own = s->G + (long)s->size * r, along = 0;
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
    mg_set_weighted_column(c, s, r, unweighted, 0, s->G + (long)s->size * r, s->begin + r, s->end + r);
    s->d[r] = mg_normalise_column(s, r);
    for (int j = 0; j < r; j++) R[j] = mg_take_out_column(s, j, r);
    R[r] = mg_normalise_column(s, r);
    if (!(s->d[r] > 0) || !(R[r] > floor)) return 0;
  }
  return 1;
}

/* Factors W = Q^T H in the scale of d. Returns 0 if it is singular. */
static int mg_factor_slip(const mg_context *c, const mg_row_factors *s) {
  for (int r = 0; r < s->n; r++) {
    int begin, end;
    mg_set_weighted_column(c, s, r, 0, 1, s->column, &begin, &end);
    for (int j = 0; j < s->n; j++) {
      const mg_real *q = s->G + (long)s->size * j;
      mg_real sum = 0;
      for (int k = begin > s->begin[j] ? begin : s->begin[j]; k < end && k < s->end[j]; k++) sum += q[k] * s->column[k];
      s->W[j + (long)s->n * r] = sum / s->d[r];
    }
  }
  return mg_lu(s->n, s->W, s->swap) > MG_LCP_RANK(s->n);
}

/* x = -(R^T R)^-1 x, or -(R^T W)^-1 x, in the scale of d. */
static void mg_solve_factored_rows(const mg_row_factors *s) {
  const int n = s->n;
  for (int r = 0; r < n; r++) {
    s->x[r] /= -s->d[r];
    for (int j = 0; j < r; j++) s->x[r] -= s->R[j + (long)n * r] * s->x[j];
    s->x[r] /= s->R[r + (long)n * r];
  }
  if (s->slips) mg_lu_solve(n, s->W, s->swap, s->x);
  for (int r = n - 1; r >= 0 && !s->slips; r--) {
    s->x[r] /= s->R[r + (long)n * r];
    for (int j = 0; j < r; j++) s->x[j] -= s->R[j + (long)n * r] * s->x[r];
  }
  for (int r = 0; r < n; r++) s->x[r] /= s->d[r];
}

/* Adds M^-1 B^T of row r times a factor for each side of a row to the sum over the bodies; with `rounding` a unit in the
   last place of its size instead, in alternating directions. */
static void mg_add_force(const mg_context *c, const mg_row_factors *s, int r, mg_real amount, int rounding) {
  mg_force_part part[MG_FRICTION_ROWS_MAX + 1];
  const int n = mg_list_force_parts(c, s, r, part);
  for (int i = 0; i < n; i++)
    for (int side = 0; side < 2; side++) {
      const int row = part[i].row, b = mg_local_body(s, side ? c->contacts.f[row] : c->contacts.o[row]);
      const mg_real *MJ = c->rows.MJ + 12 * row + 6 * side, factor = amount * part[i].factor;
      for (int k = 0; k < 6 && b >= 0; k++)
        s->column[6 * b + k] += rounding ? (b % 2 ? -MG_EPS : MG_EPS) * fabs(factor * MJ[k]) : factor * MJ[k];
    }
}

/* x = rate + A amount, through the bodies. */
static void mg_set_row_residuals(const mg_context *c, const mg_row_factors *s, const mg_real *rate,
                                 const mg_real *amount) {
  const int *rows = c->islands.rows;
  mg_zero_reals(s->column, s->size);
  for (int r = 0; r < s->n; r++) mg_add_force(c, s, r, amount[rows[r]], 0);
  for (int r = 0; r < s->n; r++) {
    s->x[r] = rate[rows[r]] + (s->own[r] >= 0 ? amount[rows[r]] : 0);
    for (int side = 0; side < 2; side++) {
      const int b = mg_local_body(s, side ? c->contacts.f[rows[r]] : c->contacts.o[rows[r]]);
      if (b >= 0) s->x[r] += mg_dot6(c->rows.J + 12 * rows[r] + 6 * side, s->column + 6 * b);
    }
  }
}

/* x = what rounding may change in the rates: a unit in the last place of the acceleration that each force gives each
   body, in alternating directions, and of those of the loads. */
static void mg_set_row_rounding(const mg_context *c, const mg_row_factors *s, const mg_real *amount) {
  const int *rows = c->islands.rows;
  mg_zero_reals(s->column, s->size);
  for (int r = 0; r < s->n; r++) mg_add_force(c, s, r, amount[rows[r]], 1);
  for (int r = 0; r < s->n; r++) {
    mg_real own = fabs(c->rows.gamma[rows[r]]) + (s->own[r] >= 0 ? fabs(amount[rows[r]]) : 0), through = 0;
    for (int side = 0; side < 2; side++) {
      const int b = mg_local_body(s, side ? c->contacts.f[rows[r]] : c->contacts.o[rows[r]]);
      for (int k = 0; k < 6 && b >= 0; k++) {
        const mg_real J = c->rows.J[12 * rows[r] + 6 * side + k];
        own += fabs(J * c->bodies.acceleration[6 * s->body[b] + k]), through += J * s->column[6 * b + k];
      }
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

MG_INTERNAL int mg_are_rows_well_conditioned(mg_real least_pivot) {
  return least_pivot > (mg_real)MG_BADLY_CONDITIONED;
}

MG_INTERNAL void mg_refine_rows(mg_context *c, int n, int slips, int rank, const mg_real *rate, mg_real pivot,
                                mg_real *amount) {
  MG_REQUIRE(mg_are_inverse_mass_rows_valid(c, c->islands.rows, n));
  mg_row_factors s;
  const int *rows = c->islands.rows;
  mg_real change = 0, last = MG_MAX;
  if (rank == n && mg_are_rows_well_conditioned(pivot)) {
    c->lcp.rounding = mg_max(c->lcp.rounding, MG_ROUNDING_FACTOR * (mg_real)n * (mg_real)n * MG_EPS / pivot);
    return;
  }
  if (rank < n && c->system->n_joint_row) return;
  if (!mg_open_row_factors(c, n, slips, &s) || (rank < n && !mg_are_rows_independent(c, &s)) ||
      !mg_factor_weighted_rows(c, &s, 0, MG_LCP_RANK(n)) || (s.slips && !mg_factor_slip(c, &s)))
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
