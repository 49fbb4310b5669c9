/* Two contacts that stick although their six rows have rank 5, as where a body is held against another at two points:
   forces are then not unique. Proves that every solution of Coulomb's law has the accelerations of the given one.

   Another solution z2, w2 has other modes. N2 and w2 follow from the modes and, where a contact slips, from the unit
   direction t of its slip, f2 = -mu N2 t, w2_t = s t. Each set of modes is excluded by a contradiction:
   - Contacts that open: a normal row without force would accelerate inwards, or a force would pull.
   - nu' w2 = 0 for the null vector nu of A. So where one slips and the other sticks, nu_t' t = 0 leaves two directions,
     and a linear system for each.
   - Where both slip, nu_1't_1 s_1 + nu_2't_2 s_2 = 0, and 0 <= (z2 - z)'A (z2 - z) = -sum s (mu N2 + f't) for any
   forces f of the given motion. All pairs of directions are covered by cells in which the signs of these terms are
   bounded. */
#include "solve/friction/solvers.h"
#include "base/base.h"
#include "elementary/elementary.h"

enum { MG_PAIR_ROWS = 6, MG_PAIR_HALVINGS = 8 /* of the cells of directions, at most */ };

#define MG_PAIR_MARGIN (mg_real)(16 * sqrt(MG_EPS))  /* what a sign must exceed, in the scaled problem */
#define MG_PAIR_CLEAR (mg_real) sqrt(MG_PAIR_MARGIN) /* what pivots must exceed that decide the null vector */

/* The problem in scaled rows: S z + b = w, A_nn = 1, largest |b| 1. */
typedef struct {
  mg_real S[MG_PAIR_ROWS * MG_PAIR_ROWS], b[MG_PAIR_ROWS], z[MG_PAIR_ROWS];
  mg_real null[MG_PAIR_ROWS]; /* null vector of S */
  mg_real mu[2];
} mg_sticking_pair;

/* All values from at - by to at + by. */
typedef struct {
  mg_real at, by;
} mg_range;

static mg_range mg_range_sum(mg_real a, mg_range x, mg_real b, mg_range y) {
  const mg_range sum = {a * x.at + b * y.at, (mg_real)(fabs(a) * x.by + fabs(b) * y.by)};
  return sum;
}

static mg_range mg_range_product(mg_range x, mg_range y) {
  const mg_range product = {x.at * y.at, (mg_real)(fabs(x.at) * y.by + fabs(y.at) * x.by + x.by * y.by)};
  return product;
}

static mg_range mg_range_magnitude(mg_range x) {
  x.at = (mg_real)fabs(x.at);
  return x;
}

static int mg_is_positive(mg_range x) { return x.at - x.by > MG_PAIR_MARGIN; }

static int mg_is_negative(mg_range x) { return x.at + x.by < -MG_PAIR_MARGIN; }

/* Rows of the problem at the same scale for the three rows of a contact. Returns 0 if it is none of two contacts that
   stick, with a symmetric matrix. */
static int mg_scale_pair(const mg_friction_problem *p, const mg_real *z, mg_sticking_pair *s) {
  mg_real scale[MG_PAIR_ROWS], size = 0;
  if (p->n != MG_PAIR_ROWS || p->n_contact != 2 || p->law != MG_COULOMB) return 0;
  for (int k = 0; k < 2; ++k) {
    const mg_real *cone = p->cone + MG_CONE * k, entry = p->A[3 * k * (MG_PAIR_ROWS + 1)];
    if (p->first[k] != 3 * k || p->rows[k] != 3 || !(cone[0] > 0) || cone[0] != cone[1] || !(entry > 0)) return 0;
    s->mu[k] = cone[0];
    for (int i = 3 * k; i < 3 * k + 3; ++i) scale[i] = 1 / (mg_real)sqrt(entry);
  }
  for (int i = 0; i < MG_PAIR_ROWS; ++i) size = mg_max(size, (mg_real)fabs(p->b[i]) * scale[i]);
  if (!(size > 0) || !(size <= MG_MAX)) return 0;
  for (int i = 0; i < MG_PAIR_ROWS; ++i) s->b[i] = p->b[i] * scale[i] / size, s->z[i] = z[i] / scale[i] / size;
  for (int j = 0; j < MG_PAIR_ROWS; ++j)
    for (int i = 0; i < MG_PAIR_ROWS; ++i) {
      s->S[i + j * MG_PAIR_ROWS] = p->A[i + j * MG_PAIR_ROWS] * scale[i] * scale[j];
      if (!(fabs(p->A[i + j * MG_PAIR_ROWS] - p->A[j + i * MG_PAIR_ROWS]) * scale[i] * scale[j] <= MG_PAIR_MARGIN))
        return 0;
    }
  for (int i = 0; i < MG_PAIR_ROWS; ++i) {
    mg_real w = s->b[i];
    for (int j = 0; j < MG_PAIR_ROWS; ++j) w += s->S[i + j * MG_PAIR_ROWS] * s->z[j];
    if (!(fabs(w) <= MG_PAIR_MARGIN)) return 0;
  }
  return 1;
}

/* Null vector of S, of largest entry 1; returns 0 unless the rank is clearly 5. */
static int mg_find_pair_null_vector(mg_sticking_pair *s) {
  const int n = MG_PAIR_ROWS, last = n - 1;
  mg_real L[MG_PAIR_ROWS * MG_PAIR_ROWS], x[MG_PAIR_ROWS], largest;
  int order[MG_PAIR_ROWS];
  for (int i = 0; i < n * n; ++i) L[i] = s->S[i];
  if (mg_cholesky_pivoted(n, L, order, MG_PAIR_CLEAR) != last) return 0;
  x[last] = 1;
  for (int j = last - 1; j >= 0; --j) {
    x[j] = 0;
    for (int i = j + 1; i < n; ++i) x[j] -= L[i + j * n] * x[i];
    x[j] /= L[j + j * n];
  }
  largest = mg_max_abs(n, x);
  for (int i = 0; i < n; ++i) s->null[order[i]] = x[i] / largest;
  for (int i = 0; i < n; ++i) {
    mg_real image = 0;
    for (int j = 0; j < n; ++j) image += s->S[i + j * n] * s->null[j];
    if (!(fabs(image) <= MG_LCP_RANK(n) * mg_max_abs(n * n, s->S))) return 0;
  }
  return 1;
}

/* True if no solution has a contact without force. */
static int mg_is_opening_excluded(const mg_sticking_pair *s) {
  if (!(s->b[0] < -MG_PAIR_MARGIN) && !(s->b[3] < -MG_PAIR_MARGIN)) return 0;
  for (int k = 0; k < 2; ++k) {
    const int pressed = 3 * k, open = 3 - pressed;
    const mg_real *column = s->S + pressed * MG_PAIR_ROWS, *own = column + pressed, *other = column + open, *b = s->b;
    const mg_real cross[2] = {s->S[open + (pressed + 1) * MG_PAIR_ROWS], s->S[open + (pressed + 2) * MG_PAIR_ROWS]};
    const mg_real turned[2] = {b[open] * own[1] - b[pressed] * cross[0], b[open] * own[2] - b[pressed] * cross[1]};
    if (!(own[0] - s->mu[k] * mg_friction_norm(2, own + 1) > MG_PAIR_MARGIN)) return 0;
    if (b[pressed] > MG_PAIR_MARGIN) continue;
    if (!(b[open] * own[0] - b[pressed] * other[0] + s->mu[k] * mg_friction_norm(2, turned) < -MG_PAIR_MARGIN))
      return 0;
  }
  return 1;
}

/* True if no solution has contact k slipping along t while the other sticks. */
static int mg_is_single_slip_excluded(const mg_sticking_pair *s, int k, const mg_real *t) {
  const int slips = 3 * k, sticks = 3 - slips, row[4] = {slips, sticks, sticks + 1, sticks + 2};
  mg_real U[16], columns[4 * MG_PAIR_ROWS], x[4], along = 0, margin;
  int swap[4];
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < MG_PAIR_ROWS; ++i) {
      columns[i + j * MG_PAIR_ROWS] = s->S[i + row[j] * MG_PAIR_ROWS];
      for (int q = 0; q < 2 && j == 0; ++q) columns[i] -= s->mu[k] * s->S[i + (slips + 1 + q) * MG_PAIR_ROWS] * t[q];
    }
  for (int i = 0; i < 4; ++i) {
    x[i] = -s->b[row[i]];
    for (int j = 0; j < 4; ++j) U[i + 4 * j] = columns[row[i] + j * MG_PAIR_ROWS];
  }
  if (!(mg_lu(4, U, swap) > MG_PAIR_MARGIN)) return 0;
  mg_lu_solve(4, U, swap, x);
  for (int q = 0; q < 2; ++q) {
    mg_real w = s->b[slips + 1 + q];
    for (int j = 0; j < 4; ++j) w += columns[slips + 1 + q + j * MG_PAIR_ROWS] * x[j];
    along += w * t[q];
  }
  margin = s->mu[1 - k] * x[1] - mg_friction_norm(2, x + 2);
  return x[0] < -MG_PAIR_MARGIN || along < -MG_PAIR_MARGIN || margin < -MG_PAIR_MARGIN;
}

/* True if no solution has one contact slipping while the other sticks. */
static int mg_are_single_slips_excluded(const mg_sticking_pair *s) {
  for (int k = 0; k < 2; ++k) {
    const mg_real *null = s->null + 3 * k + 1, size = mg_friction_norm(2, null);
    if (!(size > MG_PAIR_CLEAR)) return 0;
    const mg_real t[2] = {-null[1] / size, null[0] / size}, back[2] = {-t[0], -t[1]};
    if (!mg_is_single_slip_excluded(s, k, t) || !mg_is_single_slip_excluded(s, k, back)) return 0;
  }
  return 1;
}

/* constant + factor (x, y)'t over the directions t of an angle within `half` of that of t. */
static mg_range mg_linear_form(mg_real constant, mg_real factor, mg_real x, mg_real y, const mg_real *t, mg_real half) {
  const mg_real form[2] = {factor * x, factor * y};
  const mg_range value = {constant + form[0] * t[0] + form[1] * t[1], mg_friction_norm(2, form) * half};
  return value;
}

/* True if no solution has both contacts slipping in directions within `half` of these angles. */
static int mg_is_cell_excluded(const mg_sticking_pair *s, const mg_real *angle, mg_real half) {
  const mg_real *b = s->b, *S = s->S;
  mg_range B[2][2], tied[2], force[2], number[2], excess[2], det;
  for (int k = 0; k < 2; ++k) {
    const mg_real t[2] = {mg_cos(angle[k]), mg_sin(angle[k])};
    const int first = 3 * k, x = (first + 1) * MG_PAIR_ROWS, y = (first + 2) * MG_PAIR_ROWS;
    tied[k] = mg_linear_form(0, 1, s->null[first + 1], s->null[first + 2], t, half);
    force[k] = mg_linear_form(0, 1, s->z[first + 1], s->z[first + 2], t, half);
    for (int i = 0; i < 2; ++i)
      B[i][k] = mg_linear_form(S[3 * i + first * MG_PAIR_ROWS], -s->mu[k], S[3 * i + x], S[3 * i + y], t, half);
  }
  if (mg_is_positive(mg_range_product(tied[0], tied[1]))) return 1;
  det = mg_range_sum(1, mg_range_product(B[0][0], B[1][1]), -1, mg_range_product(B[0][1], B[1][0]));
  number[0] = mg_range_sum(-b[0], B[1][1], b[3], B[0][1]);
  number[1] = mg_range_sum(-b[3], B[0][0], b[0], B[1][0]);
  if (mg_is_positive(det) && (mg_is_negative(number[0]) || mg_is_negative(number[1]))) return 1;
  if (!mg_is_positive(number[0]) && !mg_is_positive(number[1])) return 0;
  if (mg_is_negative(det)) return 1;
  for (int k = 0; k < 2; ++k) excess[k] = mg_range_sum(s->mu[k], number[k], 1, mg_range_product(force[k], det));
  if (mg_is_positive(excess[0]) && mg_is_positive(excess[1])) return 1;
  return mg_is_positive(mg_range_sum(1, mg_range_product(mg_range_magnitude(tied[1]), excess[0]), 1,
                                     mg_range_product(mg_range_magnitude(tied[0]), excess[1])));
}

/* True if no solution has both contacts slipping in directions of the cell. */
static int mg_are_double_slips_excluded(const mg_sticking_pair *s, const mg_real *angle, mg_real half, int halvings) {
  if (mg_is_cell_excluded(s, angle, half)) return 1;
  for (int part = 0; part < 4 && halvings; ++part) {
    const mg_real centre[2] = {angle[0] + (part & 1 ? half : -half) / 2, angle[1] + (part & 2 ? half : -half) / 2};
    if (!mg_are_double_slips_excluded(s, centre, half / 2, halvings - 1)) return 0;
  }
  return halvings > 0;
}

MG_API int mg_is_sticking_pair_unique(const mg_friction_problem *problem, const mg_real *z) {
  const mg_real middle[2] = {0, 0}, half_turn = (mg_real)3.15;
  mg_sticking_pair s;
  return mg_scale_pair(problem, z, &s) && mg_find_pair_null_vector(&s) && mg_is_opening_excluded(&s) &&
         mg_are_single_slips_excluded(&s) && mg_are_double_slips_excluded(&s, middle, half_turn, MG_PAIR_HALVINGS);
}
