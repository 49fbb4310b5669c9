/* Real roots of a polynomial on [-1, 1] from its Bernstein coefficients. The polynomial lies within their range, and
   has at most as many roots as they have changes of sign (Descartes' rule of signs in Bernstein form; Lane and
   Riesenfeld 1981): intervals are halved by de Casteljau's algorithm until the coefficients have no change of sign, or
   one. */
#include "base/base.h"

#define MG_BERNSTEIN_HALVINGS 60 /* more than make an interval as narrow as rounding */
#define MG_BERNSTEIN_STEPS 80    /* of Newton's method with halving, for one root */

/* What the coefficients on an interval tell. */
enum { MG_PIECE_WITHOUT_ROOT, MG_PIECE_WITH_ONE_ROOT, MG_PIECE_OF_ZERO, MG_PIECE_OPEN };

/* A polynomial over an interval. */
typedef struct {
  mg_real low, high;
  mg_real b[MG_BERNSTEIN_DEGREE + 1];
} mg_bernstein_piece;

MG_INTERNAL void mg_add_bernstein_product(int m, const mg_real *a, int n, const mg_real *b, mg_real factor,
                                          mg_real *sum) {
  static const mg_real choose[][MG_BERNSTEIN_DEGREE + 1] = {{1},
                                                            {1, 1},
                                                            {1, 2, 1},
                                                            {1, 3, 3, 1},
                                                            {1, 4, 6, 4, 1},
                                                            {1, 5, 10, 10, 5, 1},
                                                            {1, 6, 15, 20, 15, 6, 1},
                                                            {1, 7, 21, 35, 35, 21, 7, 1},
                                                            {1, 8, 28, 56, 70, 56, 28, 8, 1}};
  for (int i = 0; i <= m; i++)
    for (int j = 0; j <= n; j++)
      sum[i + j] += factor * choose[m][i] * choose[n][j] / choose[m + n][i + j] * a[i] * b[j];
}

/* The two halves of a piece. */
static void mg_halve_piece(int n, const mg_bernstein_piece *whole, mg_bernstein_piece *first,
                           mg_bernstein_piece *second) {
  mg_real row[MG_BERNSTEIN_DEGREE + 1];
  const mg_real low = whole->low, high = whole->high, middle = low + (high - low) / 2;
  for (int k = 0; k <= n; k++) row[k] = whole->b[k];
  for (int k = 0; k <= n; k++) {
    first->b[k] = row[0], second->b[n - k] = row[n - k];
    for (int i = 0; i < n - k; i++) row[i] = (row[i] + row[i + 1]) / 2;
  }
  first->low = low, first->high = second->low = middle, second->high = high;
}

/* MG_PIECE_WITHOUT_ROOT .. ; coefficients up to `noise` have no sign. */
static int mg_judge_piece(int n, const mg_bernstein_piece *piece, mg_real noise) {
  int zeros = 0, changes = 0;
  for (int k = 0; k <= n; k++) {
    zeros += !(fabs(piece->b[k]) > noise);
    changes += k > 0 && (piece->b[k] < 0) != (piece->b[k - 1] < 0);
  }
  if (zeros == n + 1) return MG_PIECE_OF_ZERO;
  if (zeros || changes > 1) return MG_PIECE_OPEN;
  return changes ? MG_PIECE_WITH_ONE_ROOT : MG_PIECE_WITHOUT_ROOT;
}

/* Value and slope of a piece at t, from 0 to 1. */
static mg_real mg_piece_value(int n, const mg_bernstein_piece *piece, mg_real t, mg_real *slope) {
  mg_real row[MG_BERNSTEIN_DEGREE + 1];
  for (int k = 0; k <= n; k++) row[k] = piece->b[k];
  for (int k = n; k > 1; k--)
    for (int i = 0; i < k; i++) row[i] += t * (row[i + 1] - row[i]);
  *slope = (mg_real)n * (row[1] - row[0]);
  return row[0] + t * (row[1] - row[0]);
}

/* The root of a piece that has one. */
static mg_real mg_root_of_piece(int n, const mg_bernstein_piece *piece) {
  const int rises = piece->b[0] < 0;
  mg_real low = 0, high = 1, t = piece->b[0] / (piece->b[0] - piece->b[n]), slope;
  for (int step = 0; step < MG_BERNSTEIN_STEPS; step++) {
    const mg_real value = mg_piece_value(n, piece, t, &slope), before = t;
    if ((value < 0) == rises) low = t;
    else high = t;
    t -= value / slope;
    if (!(t > low && t < high)) t = low + (high - low) / 2;
    if (fabs(t - before) <= sqrt(MG_EPS)) break;
  }
  return piece->low + t * (piece->high - piece->low);
}

/* Appends an interval in which the polynomial is zero to rounding, to the one before it if that ends where it begins,
   or if there is no room. */
static int mg_append_zero_interval(mg_real low, mg_real high, mg_root_interval *root, int count) {
  if (count &&
      (count == MG_BERNSTEIN_ROOTS || (root[count - 1].low < root[count - 1].high && root[count - 1].high == low)))
    count--;
  else root[count].low = low;
  root[count].high = high;
  return count + 1;
}

MG_INTERNAL int mg_bernstein_roots(int n, const mg_real *coefficients, mg_real noise, mg_root_interval *root) {
  mg_bernstein_piece open[MG_BERNSTEIN_HALVINGS];
  const mg_real narrow = sqrt(MG_EPS);
  int n_open = 1, count = 0;
  open[0].low = -1, open[0].high = 1;
  for (int k = 0; k <= n; k++) open[0].b[k] = coefficients[k];
  while (n_open > 0) {
    const mg_bernstein_piece piece = open[--n_open];
    const int verdict = mg_judge_piece(n, &piece, noise);
    if (verdict == MG_PIECE_WITHOUT_ROOT) continue;
    if (verdict == MG_PIECE_WITH_ONE_ROOT && count < MG_BERNSTEIN_ROOTS)
      root[count].low = root[count].high = mg_root_of_piece(n, &piece), count++;
    else if (verdict != MG_PIECE_OPEN || piece.high - piece.low <= narrow || n_open + 2 > MG_BERNSTEIN_HALVINGS)
      count = mg_append_zero_interval(piece.low, piece.high, root, count);
    else mg_halve_piece(n, &piece, open + n_open + 1, open + n_open), n_open += 2;
  }
  return count;
}
