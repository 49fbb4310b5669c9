/* Sine, cosine and tangent.

   x is reduced to r = x - n pi/2 with |r| <= pi/4 by parts of pi/2 (W. J. Cody, W. Waite, 1980), of which four are
   needed where much cancels, or, if x is large, by the digits of 2/pi that matter (M. Payne, R. Hanek, 1983).
   Polynomials give sine and cosine of r as pairs. */
#include "elementary/elementary.h"

#if !defined(MG_REAL_FLOAT) && !defined(MG_REAL_LONG)

#include "elementary/elementary_constants.h"
#include "elementary/double_double.h"

#define MG_QUARTER_PI 0x1.921fb54442d18p-1
#define MG_ROUNDING_SHIFT 0x1.8p52
#define MG_REDUCED_IN_PARTS 1e5 /* up to here n is so small that its products with the parts of pi/2 are exact */
#define MG_LITTLE_LEFT 0x1p-10  /* below this much cancels */
#define MG_LINEAR 0x1p-27       /* below this a sine is its argument to the last bit */

enum { MG_WINDOW = 7, MG_PRODUCT = MG_WINDOW + 2 }; /* words of 32 bits */

/* 64 bits of a number, from `place` on. */
static mg_bits mg_bits_from(const unsigned *words, int place) {
  const int word = place / 32, shift = place % 32;
  mg_bits found = words[word] | (mg_bits)words[word + 1] << 32;
  if (!shift) return found;
  found >>= shift;
  return found | (mg_bits)words[word + 2] << (64 - shift);
}

/* A fraction f = high 2^-64 + low 2^-128 as a pair, times pi/2. */
static mg_pair mg_angle_of_fraction(mg_bits high, mg_bits low) {
  int shift = 0;
  for (; shift < 64 && !(high & MG_SIGN_BIT); shift++) high = high << 1 | low >> 63, low <<= 1;
  const double top = (double)(high >> 11), rest = (double)((high & 0x7ff) << 42 | low >> 22);
  const double hi = top * mg_power_of_two(-53 - shift), lo = rest * mg_power_of_two(-106 - shift);
  const mg_pair angle = mg_pair_product(hi, MG_HALF_PI_HIGH);
  return mg_pair_ordered_sum(angle.hi, angle.lo + (hi * MG_HALF_PI_LOW + lo * MG_HALF_PI_HIGH));
}

/* The remainder of a positive x by the digits of 2/pi that matter. Returns n mod 4. */
static int mg_reduce_by_digits(double x, mg_pair *left) {
  const mg_bits bits = mg_bits_of(x), mantissa = (bits & ((1ULL << 52) - 1)) | 1ULL << 52;
  const int exponent = (int)(bits >> 52) - MG_EXPONENT_BIAS - 52;
  const int first = exponent > 2 ? (exponent - 2) / 32 : 0; /* words before it give multiples of 4 */
  const int point = 32 * (first + MG_WINDOW) - exponent;    /* bits of the product behind the point */
  const mg_bits factor[2] = {mantissa & 0xffffffffU, mantissa >> 32};
  unsigned product[MG_PRODUCT + 3] = {0};
  for (int k = 0; k < 2; k++) {
    mg_bits carry = 0;
    for (int i = 0; i < MG_WINDOW; i++) {
      carry += factor[k] * mg_two_over_pi[first + MG_WINDOW - 1 - i] + product[k + i];
      product[k + i] = (unsigned)(carry & 0xffffffffU);
      carry >>= 32;
    }
    product[k + MG_WINDOW] = (unsigned)carry;
  }
  const int quarters = (int)(mg_bits_from(product, point) & 3);
  mg_bits high = mg_bits_from(product, point - 64), low = mg_bits_from(product, point - 128);
  const int is_above = high >> 63 != 0;
  if (is_above) low = ~low, high = ~high; /* 1 - f, less 2^-128 */
  *left = mg_angle_of_fraction(high, low);
  if (is_above) left->hi = -left->hi, left->lo = -left->lo;
  return (quarters + is_above) & 3;
}

/* x - n pi/2 as a pair, of finite x where much cancels, or x is large. Returns n mod 4. */
static int mg_reduce_further(double x, mg_pair *left) {
  if (fabs(x) <= MG_REDUCED_IN_PARTS) {
    const double n = (x * MG_PER_HALF_PI + MG_ROUNDING_SHIFT) - MG_ROUNDING_SHIFT;
    const mg_pair first = mg_pair_sum(x - n * MG_HALF_PI_1, -n * MG_HALF_PI_2);
    const mg_pair second = mg_pair_sum(first.hi, -n * MG_HALF_PI_3);
    *left = mg_pair_ordered_sum(second.hi, first.lo + second.lo - n * MG_HALF_PI_4);
    return (int)n & 3;
  }
  const int quarters = mg_reduce_by_digits(fabs(x), left);
  if (x > 0) return quarters;
  left->hi = -left->hi, left->lo = -left->lo;
  return -quarters & 3;
}

/* x - n pi/2 as a pair of at most about pi/4, for finite x with |x| > pi/4. Returns n mod 4. */
static inline int mg_reduce(double x, mg_pair *left) {
  const double n = (x * MG_PER_HALF_PI + MG_ROUNDING_SHIFT) - MG_ROUNDING_SHIFT;
  const double much = x - n * MG_HALF_PI_1, second = n * MG_HALF_PI_2, hi = much - second;
  if (!(fabs(x) <= MG_REDUCED_IN_PARTS && fabs(hi) >= MG_LITTLE_LEFT)) return mg_reduce_further(x, left);
  *left = mg_pair_ordered_sum(hi, ((much - hi) - second) - n * MG_HALF_PI_3);
  return (int)n & 3;
}

/* sin(hi + lo) - hi. */
static inline double mg_sine_rest(mg_pair r) {
  const double *c = mg_sin_series, z = r.hi * r.hi;
  const double series = c[0] + z * (c[1] + z * (c[2] + z * (c[3] + z * (c[4] + z * (c[5] + z * c[6])))));
  return r.lo * (1 - z / 2) + r.hi * z * series;
}

/* cos(hi + lo) less 1 - square/2, where `square` is hi^2 rounded, and lacks `lacking`. */
static inline double mg_cosine_rest(mg_pair r, double square, double lacking) {
  const double *c = mg_cos_series, z = square;
  const double series = c[0] + z * (c[1] + z * (c[2] + z * (c[3] + z * (c[4] + z * c[5]))));
  return z * z * series - (r.hi * r.lo + lacking / 2);
}

static inline double mg_sine(mg_pair r) { return r.hi + mg_sine_rest(r); }

static inline double mg_cosine(mg_pair r) {
  const double square = r.hi * r.hi, most = 1 - square / 2;
  return most + (((1 - most) - square / 2) + mg_cosine_rest(r, square, 0));
}

/* The sine of x + shift pi/2. */
static inline double mg_shifted_sine(double x, int shift) {
  mg_pair r;
  if (!(fabs(x) < INFINITY)) return x - x;
  const int quarters = mg_reduce(x, &r) + shift;
  const double value = quarters & 1 ? mg_cosine(r) : mg_sine(r);
  return quarters & 2 ? -value : value;
}

double mg_sin(double x) {
  const mg_pair whole = {x, 0};
  if (fabs(x) > MG_QUARTER_PI) return mg_shifted_sine(x, 0);
  return fabs(x) < MG_LINEAR ? x : mg_sine(whole);
}

double mg_cos(double x) {
  const mg_pair whole = {x, 0};
  return fabs(x) > MG_QUARTER_PI ? mg_shifted_sine(x, 1) : mg_cosine(whole);
}

double mg_tan(double x) {
  mg_pair r = {x, 0};
  int quarters = 0;
  if (fabs(x) < MG_LINEAR) return x;
  if (!(fabs(x) < INFINITY)) return x - x;
  if (fabs(x) > MG_QUARTER_PI) quarters = mg_reduce(x, &r);
  const mg_pair square = mg_pair_product(r.hi, r.hi), sine = mg_pair_ordered_sum(r.hi, mg_sine_rest(r));
  const mg_pair most = mg_pair_ordered_sum(1, -square.hi / 2);
  const mg_pair cosine = mg_pair_ordered_sum(most.hi, most.lo + mg_cosine_rest(r, square.hi, square.lo));
  const mg_pair value = quarters & 1 ? mg_pair_quotient(cosine, sine) : mg_pair_quotient(sine, cosine);
  return quarters & 1 ? -value.hi : value.hi;
}

#endif
