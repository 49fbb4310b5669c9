/* Natural logarithm, inverse hyperbolic sine and powers.

   x = 2^k z with z from 0.6875 to 1.375, and z = c (1 + r) with c of a table (P. T. P. Tang, 1990). z - c is exact. */
#include "elementary/elementary.h"

#if !defined(MG_REAL_FLOAT) && !defined(MG_REAL_LONG)

#include "elementary/exponential.h"

#define MG_CUBIC_ASINH 0x1p-20
#define MG_STRAIGHT_ASINH 0x1p31 /* from here on asinh x = log 2x */
#define MG_NEAR_ONE 0.0625
#define MG_SMALLEST_NORMAL 0x1p-1022
#define MG_LARGE_POWER 0x1p65              /* powers of this have the limit of an infinite one */
#define MG_ALL_INTEGERS 0x1p53             /* from here on every double is an integer, and even */
#define MG_LOG_START 0x3fe6000000000000ULL /* bits of 0.6875 */

/* x = 2^k z for a normal positive x. `entry` is the row of the table: c, 1/c as a sum of two, log c as a sum of two. */
static double mg_reduced(double x, int *k, const double **entry) {
  const mg_bits bits = mg_bits_of(x), above = bits - MG_LOG_START + MG_SIGN_BIT;
  *k = (int)(above >> 52) - 2048;
  *entry = mg_log_table[(above >> 45) & 127];
  return mg_from_bits(bits - ((above - MG_SIGN_BIT) & 0xfffULL << 52));
}

double mg_log(double x) {
  int shift = 0, k;
  if (!(x >= MG_SMALLEST_NORMAL)) {
    if (x == 0) return -INFINITY;
    if (!(x > 0)) return x < 0 ? NAN : x;
    x *= 0x1p54, shift = 54;
  }
  if (!(x < INFINITY)) return x;
  if (fabs(x - 1) < MG_NEAR_ONE) {
    const double f = x - 1, square = f * f, *c = mg_log_near_one;
    const mg_pair half = mg_pair_product(f, -0.5 * f), sum = mg_pair_ordered_sum(f, half.hi);
    const double high = c[6] + f * (c[7] + f * (c[8] + f * (c[9] + f * c[10])));
    const double series = c[0] + f * (c[1] + f * (c[2] + f * (c[3] + f * (c[4] + f * (c[5] + f * high)))));
    return sum.hi + (sum.lo + (half.lo + f * square * series));
  }
  const double *entry, z = mg_reduced(x, &k, &entry), r = (z - entry[0]) * entry[1], *c = mg_log_series;
  const mg_pair sum = mg_pair_ordered_sum((k - shift) * MG_LN2_HIGH + entry[3], r);
  const double square = r * r, small = (k - shift) * MG_LN2_LOW + entry[4];
  const double high = c[2] + r * (c[3] + r * (c[4] + r * c[5]));
  return sum.hi + (sum.lo + (small + (r * square * (c[0] + r * (c[1] + r * high)) - 0.5 * square)));
}

/* log x of a positive, finite x, to about 2^-68. */
static mg_pair mg_log_pair(double x) {
  int shift = 0, k;
  if (x < MG_SMALLEST_NORMAL) x *= 0x1p54, shift = 54;
  const double *entry, z = mg_reduced(x, &k, &entry), away = z - entry[0], *c = mg_log_series;
  mg_pair r = mg_pair_product(away, entry[1]);
  r.lo += away * entry[2];
  const mg_pair half = mg_pair_product(r.hi, -0.5 * r.hi);
  const mg_pair first = mg_pair_ordered_sum((k - shift) * MG_LN2_HIGH + entry[3], r.hi);
  const mg_pair second = mg_pair_ordered_sum(first.hi, half.hi);
  const double small = (k - shift) * MG_LN2_LOW + entry[4] + r.lo - r.hi * r.lo, square = r.hi * r.hi;
  const double high = c[2] + r.hi * (c[3] + r.hi * (c[4] + r.hi * (c[5] + r.hi * c[6])));
  const double series = r.hi * square * (c[0] + r.hi * (c[1] + r.hi * high));
  return mg_pair_ordered_sum(second.hi, (first.lo + second.lo) + (half.lo + small + series));
}

double mg_asinh(double x) {
  const double size = fabs(x);
  if (x == 0 || !(size < INFINITY)) return x;
  if (size < MG_CUBIC_ASINH) return x - x * x * x / 6;
  mg_pair value;
  if (size < MG_STRAIGHT_ASINH) { /* log(|x| + root(x^2 + 1)) */
    const mg_pair square = mg_pair_product(size, size);
    const mg_pair one_more = mg_pair_sum(square.hi, 1);
    const double root = sqrt(one_more.hi);
    const mg_pair back = mg_pair_product(root, root);
    const double lacking = ((one_more.hi - back.hi) - back.lo) + (one_more.lo + square.lo);
    const mg_pair whole = mg_pair_sum(root, size);
    value = mg_log_pair(whole.hi);
    value.lo += (whole.lo + lacking / (2 * root)) / whole.hi;
  } else {
    const mg_pair log = mg_log_pair(size);
    value = mg_pair_ordered_sum(log.hi, MG_LN2_HIGH), value.lo += log.lo + MG_LN2_LOW;
  }
  return x < 0 ? -(value.hi + value.lo) : value.hi + value.lo;
}

/* 0 where y is no integer, 1 where it is odd, 2 where it is even. */
static int mg_parity(double y) {
  if (fabs(y) >= MG_ALL_INTEGERS) return 2;
  if (floor(y) != y) return 0;
  return floor(y / 2) * 2 == y ? 2 : 1;
}

/* x^y where x is zero, infinite or not a number, or y is infinite or not a number, or very large. */
static double mg_special_power(double x, double y) {
  const double size = fabs(x);
  if (x == 1 || y == 0) return 1;
  if (x != x || y != y) return x + y;
  if (fabs(y) >= MG_LARGE_POWER) return size == 1 ? 1 : (size > 1) == (y > 0) ? INFINITY : 0;
  const double value = (size > 0) == (y > 0) ? INFINITY : 0;
  return mg_parity(y) == 1 && mg_bits_of(x) & MG_SIGN_BIT ? -value : value;
}

double mg_pow(double x, double y) {
  if (!(x > 0 && x < INFINITY && fabs(y) < MG_LARGE_POWER)) {
    if (!(x < 0 && x > -INFINITY && fabs(y) < MG_LARGE_POWER)) return mg_special_power(x, y);
    const int parity = mg_parity(y);
    if (!parity) return NAN;
    return parity == 1 ? -mg_pow(-x, y) : mg_pow(-x, y);
  }
  const mg_pair log = mg_log_pair(x);
  if (fabs(y * log.hi) > MG_EXP_SATURATED) return y * log.hi > 0 ? INFINITY : 0;
  const mg_pair power = mg_pair_product(y, log.hi);
  int exponent;
  const mg_pair value = mg_exp_parts(power.hi, power.lo + y * log.lo, &exponent);
  return mg_scaled(value.hi + value.lo, exponent);
}

#endif
