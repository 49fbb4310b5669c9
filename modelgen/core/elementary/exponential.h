/* Powers of e as pairs. */
#ifndef MG_EXPONENTIAL_H
#define MG_EXPONENTIAL_H

#include "elementary/elementary_constants.h"
#include "elementary/double_double.h"

#define MG_EXP_SATURATED 800.0 /* beyond this, e^x and e^x/2 are infinite, and e^-x is zero */

/* e^(hi + lo) = 2^exponent (value.hi + value.lo) for |hi| <= 800, with 1 <= value.hi < 2 and |value.lo| < 0.006, to
   about 2^-61: hi = k ln 2/128 + r, where 2^(k mod 128 / 128) is in a table (P. T. P. Tang, 1989). */
static inline mg_pair mg_exp_parts(double hi, double lo, int *exponent) {
  const double steps = (hi * MG_STEPS_PER_LN2 + 0x1.8p52) - 0x1.8p52, *c = mg_exp_series;
  const double r = ((hi - steps * MG_STEP_LN2_HIGH) - steps * MG_STEP_LN2_LOW) + lo, square = r * r;
  const int k = (int)steps, part = (k + (1 << 20)) & 127;
  const double *power = mg_exp_table[part];
  const double rest = power[1] + (r + square * ((c[0] + r * c[1]) + square * (c[2] + r * c[3])));
  const mg_pair value = {power[0], power[0] * rest};
  *exponent = (k - part) / 128;
  return value;
}

/* 2^k x for 1/4 < |x| < 4 and |k| < 2000, rounded once below the smallest normal number. */
static inline double mg_scaled(double x, int k) {
  if (k > -1020 && k < 1020) return x * mg_power_of_two(k);
  return k > 0 ? x * mg_power_of_two(k - 1000) * 0x1p1000 : x * mg_power_of_two(k + 1000) * 0x1p-1000;
}

#endif
