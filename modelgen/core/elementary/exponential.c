/* Exponential function and hyperbolic functions. */
#include "elementary/elementary.h"

#if !defined(MG_REAL_FLOAT) && !defined(MG_REAL_LONG)

#include "elementary/exponential.h"

#define MG_SMALL_SINH 0.36
#define MG_SMALL_TANH 0.26
#define MG_ONE_EXPONENTIAL 40.0 /* from here on e^-x is nothing beside e^x */
#define MG_TANH_IS_ONE 20.0

double mg_exp(double x) {
  if (!(fabs(x) <= MG_EXP_SATURATED)) return x < 0 ? 0 : x * INFINITY;
  int exponent;
  const mg_pair value = mg_exp_parts(x, 0, &exponent);
  return mg_scaled(value.hi + value.lo, exponent);
}

/* (e^x + sign e^-x)/2, of x from MG_SMALL_SINH on where sign is -1. */
static double mg_half_sum(double x, int sign) {
  int exponent, other;
  const mg_pair rising = mg_exp_parts(x, 0, &exponent);
  if (x >= MG_ONE_EXPONENTIAL) return mg_scaled(rising.hi + rising.lo, exponent - 1);
  const mg_pair falling = mg_exp_parts(-x, 0, &other);
  const double up = mg_power_of_two(exponent - 1), down = sign * mg_power_of_two(other - 1);
  const mg_pair sum = mg_pair_ordered_sum(up * rising.hi, down * falling.hi);
  return sum.hi + (sum.lo + (up * rising.lo + down * falling.lo));
}

double mg_sinh(double x) {
  const double size = fabs(x);
  if (!(size <= MG_EXP_SATURATED)) return x * INFINITY;
  if (size < MG_SMALL_SINH) {
    const double z = x * x, *c = mg_sinh_series;
    return x + x * z * (c[0] + z * (c[1] + z * (c[2] + z * (c[3] + z * (c[4] + z * c[5])))));
  }
  const double value = mg_half_sum(size, -1);
  return x < 0 ? -value : value;
}

double mg_cosh(double x) {
  const double size = fabs(x);
  if (!(size <= MG_EXP_SATURATED)) return size * INFINITY;
  return mg_half_sum(size, 1);
}

double mg_tanh(double x) {
  const double size = fabs(x);
  if (x == 0) return x;
  if (size < MG_SMALL_TANH) {
    const double z = x * x, *c = mg_tanh_series;
    const double high = c[4] + z * (c[5] + z * (c[6] + z * (c[7] + z * c[8])));
    return x + x * z * (c[0] + z * (c[1] + z * (c[2] + z * (c[3] + z * high))));
  }
  if (!(size < MG_TANH_IS_ONE)) return x > 0 ? 1 : x < 0 ? -1 : x;
  int exponent; /* tanh x = (e^2x - 1)/(e^2x + 1) */
  const mg_pair square = mg_exp_parts(2 * size, 0, &exponent);
  const double scale = mg_power_of_two(exponent);
  mg_pair above = mg_pair_ordered_sum(scale * square.hi, -1), below = mg_pair_ordered_sum(scale * square.hi, 1);
  above = mg_pair_sum(above.hi, above.lo + scale * square.lo);
  below = mg_pair_ordered_sum(below.hi, below.lo + scale * square.lo);
  const double value = mg_pair_quotient(above, below).hi;
  return x < 0 ? -value : value;
}

#endif
