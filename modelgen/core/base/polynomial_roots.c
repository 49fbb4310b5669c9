/* Real roots of a polynomial on an interval from its Bernstein coefficients. The polynomial lies within their range,
   and has at most as many roots as they have changes of sign (Descartes' rule of signs in Bernstein form; Lane and
   Riesenfeld 1981): intervals are halved by de Casteljau's algorithm until the coefficients have no change of sign, or
   one. */
#include "base/base.h"

#define MG_BERNSTEIN_OPEN 60  /* pieces still to be treated: more than make one as narrow as rounding */
#define MG_BERNSTEIN_STEPS 80 /* of Newton's method with halving, for one root */

/* What the coefficients on an interval tell. */
enum { MG_PIECE_WITHOUT_ROOT, MG_PIECE_WITH_ONE_ROOT, MG_PIECE_OF_ZERO, MG_PIECE_OPEN };

/* A polynomial of degree MG_BERNSTEIN_DEGREE at most over an interval. Loops over its coefficients have a fixed length;
   those beyond its degree are zero. */
typedef struct {
  mg_real low, high;
  mg_real b[MG_BERNSTEIN_DEGREE + 1];
} mg_bernstein_piece;

MG_INTERNAL void mg_add_homogeneous_product(int m, const mg_real *a, int n, const mg_real *b, mg_real factor,
                                            mg_real *sum) {
  for (int i = 0; i <= m; i++)
    for (int j = 0; j <= n; j++) sum[i + j] += factor * a[i] * b[j];
}

/* The two halves of a piece. */
static void mg_halve_piece(int n, const mg_bernstein_piece *whole, mg_bernstein_piece *first,
                           mg_bernstein_piece *second) {
  mg_real row[MG_BERNSTEIN_DEGREE + 1];
  const mg_real low = whole->low, high = whole->high, middle = low + (high - low) / 2;
  for (int k = 0; k <= MG_BERNSTEIN_DEGREE; k++) row[k] = whole->b[k], first->b[k] = second->b[k] = 0;
  first->b[0] = row[0], second->b[n] = row[n];
  for (int k = 1; k <= n; k++) {
    for (int i = 0; i < MG_BERNSTEIN_DEGREE; i++) row[i] = (row[i] + row[i + 1]) / 2;
    first->b[k] = row[0], second->b[n - k] = row[n - k];
  }
  first->low = low, first->high = second->low = middle, second->high = high;
}

/* MG_PIECE_WITHOUT_ROOT .. ; coefficients up to `noise` have no sign. */
static int mg_judge_piece(int n, const mg_bernstein_piece *piece, mg_real noise) {
  mg_real least = piece->b[0], most = piece->b[0];
  int changes = 0, has_zero = 0;
  for (int k = 1; k <= n; k++)
    least = piece->b[k] < least ? piece->b[k] : least, most = piece->b[k] > most ? piece->b[k] : most;
  if (least > noise || most < -noise) return MG_PIECE_WITHOUT_ROOT;
  if (most <= noise && least >= -noise) return MG_PIECE_OF_ZERO;
  for (int k = 0; k <= n; k++) has_zero |= fabs(piece->b[k]) <= noise;
  for (int k = 1; k <= n; k++) changes += (piece->b[k] < 0) != (piece->b[k - 1] < 0);
  return has_zero || changes > 1 ? MG_PIECE_OPEN : MG_PIECE_WITH_ONE_ROOT;
}

/* Value and slope of a piece at t, from 0 to 1. */
static mg_real mg_piece_value(int n, const mg_bernstein_piece *piece, mg_real t, mg_real *slope) {
  mg_real row[MG_BERNSTEIN_DEGREE + 1];
  for (int k = 0; k <= MG_BERNSTEIN_DEGREE; k++) row[k] = piece->b[k];
  for (int k = n; k > 1; k--)
    for (int i = 0; i < MG_BERNSTEIN_DEGREE; i++) row[i] += t * (row[i + 1] - row[i]);
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
  const mg_root_interval *last = root + count - 1;
  if (count && (count == MG_BERNSTEIN_ROOTS || (last->low < last->high && last->high == low))) count--;
  else root[count].low = low;
  root[count].high = high;
  return count + 1;
}

MG_INTERNAL int mg_homogeneous_roots(int n, const mg_real *coefficients, mg_real noise, mg_root_interval *root) {
  mg_bernstein_piece open[MG_BERNSTEIN_OPEN];
  const mg_real narrow = sqrt(MG_EPS);
  mg_real choose = 1;
  int n_open = 1, count = 0;
  open[0].low = -1, open[0].high = 1;
  for (int k = 0; k <= n; k++) {
    open[0].b[k] = coefficients[k] / choose;
    choose = choose * (mg_real)(n - k) / (mg_real)(k + 1);
  }
  for (int k = n + 1; k <= MG_BERNSTEIN_DEGREE; k++) open[0].b[k] = 0;
  while (n_open > 0) {
    const mg_bernstein_piece piece = open[--n_open];
    const int verdict = mg_judge_piece(n, &piece, noise);
    if (verdict == MG_PIECE_WITHOUT_ROOT) continue;
    if (verdict == MG_PIECE_WITH_ONE_ROOT && count < MG_BERNSTEIN_ROOTS)
      root[count].low = root[count].high = mg_root_of_piece(n, &piece), count++;
    else if (verdict != MG_PIECE_OPEN || piece.high - piece.low <= narrow || n_open + 2 > MG_BERNSTEIN_OPEN)
      count = mg_append_zero_interval(piece.low, piece.high, root, count);
    else mg_halve_piece(n, &piece, open + n_open + 1, open + n_open), n_open += 2;
  }
  return count;
}
