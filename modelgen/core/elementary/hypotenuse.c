/* The length of a vector in the plane. */
#include "elementary/elementary.h"

#if !defined(MG_REAL_FLOAT) && !defined(MG_REAL_LONG)

#include "elementary/double_double.h"

#define MG_NEGLIGIBLE 0x1p-54 /* of the longer side: the shorter changes nothing */

double mg_hypot(double x, double y) {
  const double a = fabs(x), b = fabs(y), longer = a > b ? a : b, shorter = a > b ? b : a;
  if (a >= INFINITY || b >= INFINITY) return INFINITY;
  if (!(shorter > MG_NEGLIGIBLE * longer)) return a + b;
  const double scale = longer > 0x1p500 ? 0x1p-600 : longer < 0x1p-400 ? 0x1p600 : 1;
  const mg_pair one = mg_pair_product(scale * longer, scale * longer);
  const mg_pair other = mg_pair_product(scale * shorter, scale * shorter), sum = mg_pair_ordered_sum(one.hi, other.hi);
  const double root = sqrt(sum.hi);
  const mg_pair back = mg_pair_product(root, root);
  const double rest = ((sum.hi - back.hi) - back.lo) + (sum.lo + (one.lo + other.lo));
  return (root + rest / (2 * root)) / scale;
}

#endif
