/* Inverse sine, cosine and tangent.

   All follow from the angle of a vector. Its slope q = y/x, or x/y where that is below 1, is near a multiple c = k/32,
   and atan q = atan c + atan t with t = (y - c x)/(x + c y). The angle is computed as a pair. */
#include "elementary/elementary.h"

#if !defined(MG_REAL_FLOAT) && !defined(MG_REAL_LONG)

#include "elementary/elementary_constants.h"
#include "elementary/double_double.h"

#define MG_SLOPES 32
#define MG_FLAT 62        /* binary digits: an angle whose slope is smaller is its slope */
#define MG_LINEAR 0x1p-27 /* below this inverse sine and tangent are the argument to the last bit */

/* The angle of (x, y), both not negative, from 0 to pi/2. Neither is so large or small that
   products are not exact. */
static mg_pair mg_angle(mg_pair y, mg_pair x) {
  const int is_steep = y.hi > x.hi;
  const mg_pair opposite = is_steep ? x : y, adjacent = is_steep ? y : x;
  const int k = (int)(opposite.hi / adjacent.hi * MG_SLOPES + 0.5);
  const double slope = (double)k / MG_SLOPES, *c = mg_atan_series, *angle = mg_atan_table[k];
  const mg_pair off = mg_pair_product(slope, adjacent.hi);
  mg_pair along = mg_pair_ordered_sum(adjacent.hi, slope * opposite.hi);
  along.lo += adjacent.lo;
  mg_pair above = mg_pair_sum(opposite.hi, -off.hi);
  above.lo += (opposite.lo - off.lo) - slope * adjacent.lo;
  const mg_pair t = mg_pair_quotient(above, along);
  const double z = t.hi * t.hi, rest = t.hi * z * (c[0] + z * (c[1] + z * (c[2] + z * c[3])));
  mg_pair value = mg_pair_ordered_sum(angle[0], t.hi);
  value.lo += angle[1] + (t.lo + rest);
  if (is_steep) {
    const mg_pair turned = mg_pair_ordered_sum(MG_HALF_PI_HIGH, -value.hi);
    value.hi = turned.hi, value.lo = turned.lo + (MG_HALF_PI_LOW - value.lo);
  }
  return mg_pair_ordered_sum(value.hi, value.lo);
}

/* pi - angle. */
static double mg_supplement(mg_pair angle) {
  const mg_pair turned = mg_pair_ordered_sum(2 * MG_HALF_PI_HIGH, -angle.hi);
  return turned.hi + (turned.lo + (2 * MG_HALF_PI_LOW - angle.lo));
}

/* The root of (1 - x)(1 + x) as a pair, for |x| < 1. */
static mg_pair mg_other_side(double x) {
  const mg_pair less = mg_pair_ordered_sum(1, -fabs(x)), more = mg_pair_ordered_sum(1, fabs(x));
  mg_pair square = mg_pair_product(less.hi, more.hi);
  square.lo += less.hi * more.lo + less.lo * more.hi;
  const double root = sqrt(square.hi);
  if (root == 0) return square;
  const mg_pair back = mg_pair_product(root, root);
  return mg_pair_ordered_sum(root, (((square.hi - back.hi) - back.lo) + square.lo) / (2 * root));
}

/* The angle of (x, y), both not negative, finite or not. */
static mg_pair mg_first_quadrant(double y, double x) {
  mg_pair angle = {0, 0}, high = {y, 0}, wide = {x, 0};
  if (y >= INFINITY && x >= INFINITY) high.hi = wide.hi = 1;
  const int apart = (int)(mg_bits_of(high.hi) >> 52) - (int)(mg_bits_of(wide.hi) >> 52);
  if (high.hi == 0) return angle;
  if (apart < -MG_FLAT) {
    angle.hi = y / x;
    return angle;
  }
  if (apart > MG_FLAT) {
    angle.hi = MG_HALF_PI_HIGH, angle.lo = MG_HALF_PI_LOW;
    return angle;
  }
  const double larger = y > x ? y : x, scale = larger > 0x1p500 ? 0x1p-600 : larger < 0x1p-500 ? 0x1p600 : 1;
  if (larger < INFINITY) high.hi *= scale, wide.hi *= scale;
  return mg_angle(high, wide);
}

double mg_atan2(double y, double x) {
  if (x != x || y != y) return x + y;
  const mg_pair angle = mg_first_quadrant(fabs(y), fabs(x));
  const double value = mg_bits_of(x) & MG_SIGN_BIT ? mg_supplement(angle) : angle.hi;
  return mg_bits_of(y) & MG_SIGN_BIT ? -value : value;
}

double mg_atan(double x) {
  if (x != x || fabs(x) < MG_LINEAR) return x;
  const double value = mg_first_quadrant(fabs(x), 1).hi;
  return x < 0 ? -value : value;
}

double mg_asin(double x) {
  const mg_pair size = {fabs(x), 0};
  if (x != x || size.hi < MG_LINEAR) return x;
  if (size.hi > 1) return NAN;
  const double value = mg_angle(size, mg_other_side(x)).hi;
  return x < 0 ? -value : value;
}

double mg_acos(double x) {
  const mg_pair size = {fabs(x), 0};
  if (!(size.hi <= 1)) return x != x ? x : NAN;
  const mg_pair angle = mg_angle(mg_other_side(x), size);
  return x < 0 ? mg_supplement(angle) : angle.hi;
}

#endif
