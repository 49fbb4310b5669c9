/* Unevaluated sums of two doubles (T. J. Dekker, 1971), and doubles as bits. */
#ifndef MG_PAIRS_H
#define MG_PAIRS_H

#include <math.h>
#include <string.h>

/* hi + lo, with |lo| <= ulp(hi)/2. */
typedef struct {
  double hi, lo;
} mg_pair;

typedef unsigned long long mg_bits;

#define MG_SPLITTER 134217729.0 /* 2^27 + 1 */
#define MG_EXPONENT_BIAS 1023
#define MG_SIGN_BIT (1ULL << 63)

static inline mg_bits mg_bits_of(double x) {
  mg_bits bits;
  memcpy(&bits, &x, sizeof bits);
  return bits;
}

static inline double mg_from_bits(mg_bits bits) {
  double x;
  memcpy(&x, &bits, sizeof x);
  return x;
}

/* 2^k, -1022 <= k <= 1023. */
static inline double mg_power_of_two(int k) { return mg_from_bits((mg_bits)(k + MG_EXPONENT_BIAS) << 52); }

/* a + b, exactly. */
static inline mg_pair mg_pair_sum(double a, double b) {
  const double sum = a + b, part = sum - a;
  const mg_pair exact = {sum, (a - (sum - part)) + (b - part)};
  return exact;
}

/* The same where a is zero or |a| >= |b|. */
static inline mg_pair mg_pair_ordered_sum(double a, double b) {
  const double sum = a + b;
  const mg_pair exact = {sum, b - (sum - a)};
  return exact;
}

/* a b, exactly, if neither is beyond 2^996 nor the product below 2^-968. */
static inline mg_pair mg_pair_product(double a, double b) {
  const double wide_a = MG_SPLITTER * a, a1 = wide_a - (wide_a - a), a2 = a - a1;
  const double wide_b = MG_SPLITTER * b, b1 = wide_b - (wide_b - b), b2 = b - b1;
  const double product = a * b;
  const mg_pair exact = {product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2};
  return exact;
}

/* a/b, of pairs, to about 2^-100. */
static inline mg_pair mg_pair_quotient(mg_pair a, mg_pair b) {
  const double quotient = a.hi / b.hi;
  const mg_pair back = mg_pair_product(quotient, b.hi);
  return mg_pair_ordered_sum(quotient, (((a.hi - back.hi) - back.lo) + a.lo - quotient * b.lo) / b.hi);
}

#endif
