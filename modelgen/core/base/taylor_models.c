/* Taylor models of second order. A function of one variable is replaced by its Taylor polynomial at the middle, with a
   bound of its third derivative for the rest; where it is not smooth over the range, by its range. Rounding counts as
   rest. A piecewise cubic is replaced by the quadratic function through its values at the ends and in the middle, with
   the largest difference over the pieces that the box meets for the rest. */
#include "base/base.h"

#define MG_SPLINE_BLOCKS 8 /* into which the pieces that a range meets are divided at least, for its bounds */

static const mg_taylor_model mg_no_bound = {0, {0, 0}, {0, 0, 0}, MG_MAX};

/* Bounds of the linear and of the quadratic part. */
static inline mg_real mg_slope_size(const mg_taylor_model *a) { return fabs(a->slope[0]) + fabs(a->slope[1]); }

static inline mg_real mg_bend_size(const mg_taylor_model *a) {
  return fabs(a->bend[0]) + fabs(a->bend[1]) + fabs(a->bend[2]);
}

MG_INTERNAL mg_real mg_taylor_change(const mg_taylor_model *a) {
  return a->rest < MG_MAX / 8 ? mg_slope_size(a) + mg_bend_size(a) + a->rest : MG_MAX;
}

/* A model with its rounding error added, of numbers of a size; without bounds if they are not finite. */
static inline mg_taylor_model mg_rounded_from(mg_taylor_model a, mg_real size) {
  a.rest += 4 * MG_EPS * size;
  return size < MG_MAX / 8 ? a : mg_no_bound;
}

static inline mg_taylor_model mg_rounded(mg_taylor_model a) {
  return mg_rounded_from(a, fabs(a.middle) + mg_slope_size(&a) + mg_bend_size(&a) + a.rest);
}

/* A number between low and high of which nothing else is known. */
static mg_taylor_model mg_taylor_range(mg_real middle, mg_real low, mg_real high) {
  const mg_taylor_model range = {middle, {0, 0}, {0, 0, 0}, mg_max(high - middle, middle - low)};
  return range.rest >= 0 ? mg_rounded(range) : mg_no_bound;
}

/* x a + y b, exactly but for rounding. */
static inline mg_taylor_model mg_taylor_sum(mg_real x, const mg_taylor_model *a, mg_real y, const mg_taylor_model *b) {
  mg_taylor_model sum;
  sum.middle = x * a->middle + y * b->middle;
  for (int k = 0; k < 2; k++) sum.slope[k] = x * a->slope[k] + y * b->slope[k];
  for (int k = 0; k < 3; k++) sum.bend[k] = x * a->bend[k] + y * b->bend[k];
  sum.rest = fabs(x) * a->rest + fabs(y) * b->rest;
  return mg_rounded(sum);
}

static mg_taylor_model mg_taylor_product(const mg_taylor_model *a, const mg_taylor_model *b) {
  const mg_real slope_a = mg_slope_size(a), slope_b = mg_slope_size(b), rest_a = mg_bend_size(a) + a->rest,
                rest_b = mg_bend_size(b) + b->rest, m = a->middle, n = b->middle;
  const mg_real size_a = fabs(m) + slope_a + rest_a, size_b = fabs(n) + slope_b + rest_b;
  if (size_a == 0 || size_b == 0) return mg_taylor_range(0, 0, 0);
  if (!(a->rest < MG_MAX / 8) || !(b->rest < MG_MAX / 8)) return mg_no_bound;
  mg_taylor_model product = {m * n,
                             {m * b->slope[0] + n * a->slope[0], m * b->slope[1] + n * a->slope[1]},
                             {m * b->bend[0] + n * a->bend[0] + a->slope[0] * b->slope[0],
                              m * b->bend[1] + n * a->bend[1] + a->slope[0] * b->slope[1] + a->slope[1] * b->slope[0],
                              m * b->bend[2] + n * a->bend[2] + a->slope[1] * b->slope[1]},
                             fabs(m) * b->rest + fabs(n) * a->rest + slope_a * rest_b + rest_a * (slope_b + rest_b)};
  return mg_rounded_from(product, size_a * size_b);
}

/* A function with its value and derivatives at the middle and a bound of its third derivative over the range. */
static mg_taylor_model mg_taylor_of(const mg_taylor_model *a, mg_real value, mg_real first, mg_real second,
                                    mg_real third) {
  const mg_real change = mg_taylor_change(a), slope = mg_slope_size(a), rest = mg_bend_size(a) + a->rest,
                half = second / 2;
  if (!(fabs(third) < MG_MAX) || !(fabs(second) < MG_MAX) || !(fabs(first) < MG_MAX) || change >= MG_MAX)
    return mg_no_bound;
  mg_taylor_model out;
  out.middle = value;
  for (int k = 0; k < 2; k++) out.slope[k] = first * a->slope[k];
  for (int k = 0; k < 3; k++) out.bend[k] = first * a->bend[k];
  out.bend[0] += half * a->slope[0] * a->slope[0], out.bend[2] += half * a->slope[1] * a->slope[1];
  out.bend[1] += second * a->slope[0] * a->slope[1];
  out.rest = fabs(first) * a->rest + fabs(half) * (2 * slope * rest + rest * rest) +
             fabs(third) * change * change * change / 6;
  return mg_rounded(out);
}

static mg_taylor_model mg_taylor_inverse(const mg_taylor_model *a) {
  const mg_real least = fabs(a->middle) - mg_taylor_change(a), x = a->middle;
  if (!(least > 0)) return mg_no_bound;
  return mg_taylor_of(a, 1 / x, -1 / (x * x), 2 / (x * x * x), 6 / (least * least * least * least));
}

static mg_taylor_model mg_taylor_sqrt(const mg_taylor_model *a) {
  const mg_real change = mg_taylor_change(a), least = a->middle - change;
  if (least > 0) {
    const mg_real root = sqrt(a->middle);
    return mg_taylor_of(a, root, 1 / (2 * root), -1 / (4 * a->middle * root), 3 / (8 * least * least * sqrt(least)));
  }
  return a->middle + change >= 0 ? mg_taylor_range(sqrt(mg_max(a->middle, (mg_real)0)), 0, sqrt(a->middle + change))
                                 : mg_no_bound;
}

/* x^n for a whole number n. */
static mg_taylor_model mg_taylor_integer_power(const mg_taylor_model *x, mg_real n) {
  const mg_real change = mg_taylor_change(x), least = fabs(x->middle) - change, most = fabs(x->middle) + change;
  if (n == 0) return mg_taylor_range(1, 1, 1);
  if (n < 0 && !(least > 0)) return mg_no_bound;
  const mg_real m = x->middle, second = n == 1 ? 0 : n * (n - 1) * mg_pow(m, n - 2);
  const mg_real third = n == 1 || n == 2 ? 0 : n * (n - 1) * (n - 2) * mg_pow(n < 3 ? least : most, n - 3);
  return mg_taylor_of(x, mg_pow(m, n), n * mg_pow(m, n - 1), second, third);
}

/* x^y; a base below zero is cut off, because no point of a shape lies there. */
static mg_taylor_model mg_taylor_power(const mg_taylor_model *x, const mg_taylor_model *y) {
  const mg_real change = mg_taylor_change(x), low = mg_max(x->middle - change, (mg_real)0), high = x->middle + change,
                n = y->middle, of_y = mg_taylor_change(y);
  if (of_y == 0 && floor(n) == n && fabs(n) < 1000) return mg_taylor_integer_power(x, n);
  if (!(high >= 0) || !(of_y <= 1e-6) || !(change < MG_MAX)) return mg_no_bound;
  const mg_real middle = mg_max(x->middle, (mg_real)0), at_low = mg_pow(low, n), at_high = mg_pow(high, n);
  const mg_real third = fabs(n * (n - 1) * (n - 2)) * mg_max(mg_pow(low, n - 3), mg_pow(high, n - 3));
  mg_taylor_model power =
      low > 0 || (n >= 3 && x->middle >= 0)
          ? mg_taylor_of(x, mg_pow(middle, n), n * mg_pow(middle, n - 1), n * (n - 1) * mg_pow(middle, n - 2), third)
          : mg_no_bound;
  if (power.rest >= MG_MAX / 8)
    power = mg_taylor_range(mg_pow(middle, n), mg_min(at_low, at_high), mg_max(at_low, at_high));
  if (of_y > 0)
    power.rest += of_y * 2 * mg_max(at_low, at_high) * (fabs(low > 0 ? mg_log(low) : 0) + fabs(mg_log(high)) + 1);
  return mg_rounded(power);
}

static mg_taylor_model mg_taylor_sine(const mg_taylor_model *a, mg_real phase) {
  const mg_real change = mg_taylor_change(a);
  if (!(change < 2)) return mg_taylor_range(change < MG_MAX ? mg_sin(a->middle + phase) : 0, -1, 1);
  const mg_real x = a->middle + phase, value = mg_sin(x);
  mg_taylor_model sine = mg_taylor_of(a, value, mg_cos(x), -value, 1);
  sine.rest += 2 * MG_EPS * fabs(x);
  return sine;
}

static mg_taylor_model mg_taylor_tan(const mg_taylor_model *a) {
  const mg_real change = mg_taylor_change(a), turns = a->middle / MG_PI,
                to_pole = ((mg_real)0.5 - fabs(turns - floor(turns + (mg_real)0.5))) * MG_PI;
  if (!(change < to_pole)) return mg_no_bound;
  const mg_real value = mg_tan(a->middle), most = mg_tan(MG_PI / 2 - (to_pole - change));
  return mg_taylor_of(a, value, 1 + value * value, 2 * value * (1 + value * value),
                      2 * (1 + most * most) * (1 + 3 * most * most));
}

/* asin, or acos with sign -1. */
static mg_taylor_model mg_taylor_arc(const mg_taylor_model *a, mg_real sign) {
  const mg_real most = fabs(a->middle) + mg_taylor_change(a), room = 1 - most * most,
                value = sign > 0 ? mg_asin(mg_min(mg_max(a->middle, (mg_real)-1), (mg_real)1))
                                 : mg_acos(mg_min(mg_max(a->middle, (mg_real)-1), (mg_real)1));
  if (!(room > 0)) return sign > 0 ? mg_taylor_range(value, -MG_PI / 2, MG_PI / 2) : mg_taylor_range(value, 0, MG_PI);
  const mg_real here = 1 - a->middle * a->middle;
  return mg_taylor_of(a, value, sign / sqrt(here), sign * a->middle / (here * sqrt(here)),
                      (1 + 2 * most * most) / (room * room * sqrt(room)));
}

static mg_taylor_model mg_taylor_atan2(const mg_taylor_model *y, const mg_taylor_model *x) {
  const mg_real of_x = mg_taylor_change(x), of_y = mg_taylor_change(y);
  const mg_real near_x = mg_max(fabs(x->middle) - of_x, (mg_real)0),
                near_y = mg_max(fabs(y->middle) - of_y, (mg_real)0);
  const mg_real least = near_x * near_x + near_y * near_y, square = x->middle * x->middle + y->middle * y->middle;
  if (!(least > 0) || (near_y == 0 && x->middle < 0))
    return of_x < MG_MAX && of_y < MG_MAX ? mg_taylor_range(mg_atan2(y->middle, x->middle), -MG_PI, MG_PI)
                                          : mg_no_bound;
  const mg_real by_y = x->middle / square, by_x = -y->middle / square;
  mg_taylor_model angle = mg_taylor_sum(by_y, y, by_x, x);
  angle.middle = mg_atan2(y->middle, x->middle), angle.rest += (of_x * of_x + of_y * of_y) / (2 * least);
  return mg_rounded(angle);
}

/* sinh, cosh or tanh. */
static mg_taylor_model mg_taylor_hyperbolic(int operation, const mg_taylor_model *a) {
  const mg_real most = fabs(a->middle) + mg_taylor_change(a), s = mg_sinh(a->middle), c = mg_cosh(a->middle);
  if (operation == MG_OP_SINH) return mg_taylor_of(a, s, c, s, mg_cosh(most));
  if (operation == MG_OP_COSH) return mg_taylor_of(a, c, s, c, mg_sinh(most));
  return mg_taylor_of(a, s / c, 1 / (c * c), -2 * s / (c * c * c), 2);
}

/* Notes the place of a kink, where a difference is zero, if a coordinate alone tells it; kink[k]: of those along the
   coordinate k the nearest to the middle. */
static void mg_note_kink(const mg_taylor_model *difference, mg_real *kink) {
  for (int k = 0; k < 2; k++)
    if (difference->slope[1 - k] == 0 && mg_bend_size(difference) == 0 &&
        fabs(difference->middle) < fabs(difference->slope[k] * kink[k]))
      kink[k] = -difference->middle / difference->slope[k];
}

/* min (sign 1) or max (sign -1). Where either can be the one, min is a - max(x, 0) with x = a - b; over the range of x
   from `low` to `high`, max(x, 0) is `share` x + `half` to +-`half`. */
static mg_taylor_model mg_taylor_least(const mg_taylor_model *a, const mg_taylor_model *b, mg_real sign,
                                       mg_real *kink) {
  const mg_taylor_model difference = mg_taylor_sum(1, a, -1, b);
  const mg_real change = mg_taylor_change(&difference), middle = sign * difference.middle;
  if (middle + change <= 0) return *a;
  if (middle - change >= 0) return *b;
  if (!(change < MG_MAX)) return mg_no_bound;
  mg_note_kink(&difference, kink);
  const mg_real low = middle - change, high = middle + change, share = high / (2 * change), half = -share * low / 2;
  mg_taylor_model least = mg_taylor_sum(1 - share, a, share, b);
  least.middle = middle < 0 ? a->middle : b->middle;
  least.rest += half + fabs(share * middle + half - mg_max(middle, (mg_real)0));
  return mg_rounded(least);
}

static mg_taylor_model mg_taylor_absolute(const mg_taylor_model *a, mg_real *kink) {
  if (fabs(a->middle) >= mg_taylor_change(a)) return mg_taylor_of(a, fabs(a->middle), a->middle < 0 ? -1 : 1, 0, 0);
  const mg_taylor_model negative = mg_taylor_sum(-1, a, 0, a);
  return mg_taylor_least(a, &negative, -1, kink);
}

/* The truth value of a condition: at the middle, and whether it is the same over the box. */
static mg_taylor_model mg_truth(int at_middle, int is_decided) {
  const mg_taylor_model truth = {(mg_real)at_middle, {0, 0}, {0, 0, 0}, is_decided ? 0 : 1};
  return truth;
}

static mg_taylor_model mg_taylor_comparison(int operation, const mg_taylor_model *a, const mg_taylor_model *b) {
  const mg_taylor_model difference = mg_taylor_sum(1, a, -1, b);
  const mg_real x = difference.middle, change = mg_taylor_change(&difference);
  const int is_decided = fabs(x) > change || (x == 0 && change == 0);
  switch (operation) {
    case MG_OP_LESS:
      return mg_truth(x < 0, is_decided);
    case MG_OP_LESS_EQUAL:
      return mg_truth(x <= 0, is_decided);
    case MG_OP_EQUAL:
      return mg_truth(x == 0, is_decided);
    default:
      return mg_truth(x != 0, is_decided);
  }
}

static mg_taylor_model mg_taylor_if_else_zero(const mg_taylor_model *condition, const mg_taylor_model *b) {
  if (condition->rest == 0) return condition->middle != 0 ? *b : mg_taylor_range(0, 0, 0);
  const mg_real change = mg_taylor_change(b);
  if (!(change < MG_MAX)) return mg_no_bound;
  return mg_taylor_range(condition->middle != 0 ? b->middle : 0, mg_min(b->middle - change, (mg_real)0),
                         mg_max(b->middle + change, (mg_real)0));
}

static mg_taylor_model mg_taylor_operation(int operation, const mg_taylor_model *a, const mg_taylor_model *b,
                                           mg_real *kink) {
  const mg_real change = mg_taylor_change(a);
  mg_taylor_model inverse;
  switch (operation) {
    case MG_OP_COPY:
      return *a;
    case MG_OP_ADD:
      return mg_taylor_sum(1, a, 1, b);
    case MG_OP_SUBTRACT:
      return mg_taylor_sum(1, a, -1, b);
    case MG_OP_MULTIPLY:
      return mg_taylor_product(a, b);
    case MG_OP_DIVIDE:
      inverse = mg_taylor_inverse(b);
      return mg_taylor_product(a, &inverse);
    case MG_OP_NEGATE:
      return mg_taylor_sum(-1, a, 0, a);
    case MG_OP_SQUARE:
      return mg_taylor_of(a, a->middle * a->middle, 2 * a->middle, 2, 0);
    case MG_OP_TWICE:
      return mg_taylor_sum(2, a, 0, a);
    case MG_OP_INVERT:
      return mg_taylor_inverse(a);
    case MG_OP_SQRT:
      return mg_taylor_sqrt(a);
    case MG_OP_POWER:
      return mg_taylor_power(a, b);
    case MG_OP_EXP:
      return mg_taylor_of(a, mg_exp(a->middle), mg_exp(a->middle), mg_exp(a->middle), mg_exp(a->middle + change));
    case MG_OP_LOG:
      if (!(a->middle > change)) return mg_no_bound;
      return mg_taylor_of(a, mg_log(a->middle), 1 / a->middle, -1 / (a->middle * a->middle),
                          2 / mg_pow(a->middle - change, (mg_real)3));
    case MG_OP_SIN:
      return mg_taylor_sine(a, 0);
    case MG_OP_COS:
      return mg_taylor_sine(a, MG_PI / 2);
    case MG_OP_TAN:
      return mg_taylor_tan(a);
    case MG_OP_ASIN:
      return mg_taylor_arc(a, 1);
    case MG_OP_ACOS:
      return mg_taylor_arc(a, -1);
    case MG_OP_ATAN:
      return mg_taylor_of(a, mg_atan(a->middle), 1 / (1 + a->middle * a->middle),
                          -2 * a->middle / mg_pow(1 + a->middle * a->middle, (mg_real)2), 2);
    case MG_OP_ATAN2:
      return mg_taylor_atan2(a, b);
    case MG_OP_SINH:
    case MG_OP_COSH:
    case MG_OP_TANH:
      return mg_taylor_hyperbolic(operation, a);
    case MG_OP_FABS:
      return mg_taylor_absolute(a, kink);
    case MG_OP_SIGN:
      if (fabs(a->middle) > change)
        return mg_taylor_range(a->middle < 0 ? -1 : 1, a->middle < 0 ? -1 : 1, a->middle < 0 ? -1 : 1);
      return mg_taylor_range(a->middle < 0 ? -1 : a->middle > 0 ? 1 : 0, -1, 1);
    case MG_OP_FMIN:
      return mg_taylor_least(a, b, 1, kink);
    case MG_OP_FMAX:
      return mg_taylor_least(a, b, -1, kink);
    case MG_OP_NOT:
      return mg_truth(a->middle == 0, a->rest == 0);
    case MG_OP_AND:
      return mg_truth(a->middle != 0 && b->middle != 0, a->rest == 0 && b->rest == 0);
    case MG_OP_OR:
      return mg_truth(a->middle != 0 || b->middle != 0, a->rest == 0 && b->rest == 0);
    case MG_OP_IF_ELSE_ZERO:
      return mg_taylor_if_else_zero(a, b);
    case MG_OP_SHARE:
      if (a->rest + b->rest >= 1) return mg_taylor_range(a->middle / b->middle, 0, 1);
      return mg_taylor_range(a->middle / b->middle, a->middle / b->middle, a->middle / b->middle);
    default:
      return mg_taylor_comparison(operation, a, b);
  }
}

/* Coefficients of piece i of a spline, by the distance from its knot. */
static void mg_spline_piece(const mg_bounds_spline *spline, const mg_real *coefficients, int i, mg_real *a) {
  const mg_real *c = coefficients + i;
  const int n = spline->pieces;
  a[0] = c[0], a[1] = c[n], a[2] = c[2 * n], a[3] = c[3 * n];
  for (int order = 0; order < spline->order; order++) a[0] = a[1], a[1] = 2 * a[2], a[2] = 3 * a[3], a[3] = 0;
}

/* Number of the piece of a spline in which x is. */
static int mg_piece_at(const mg_bounds_spline *spline, const mg_real *knots, mg_real x) {
  int low = 0, high = spline->pieces;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    if (x < knots[middle]) high = middle;
    else low = middle;
  }
  return low;
}

static mg_real mg_cubic_at(const mg_real *a, mg_real s) { return a[0] + (a[1] + (a[2] + a[3] * s) * s) * s; }

/* Largest |b0 + b1 t + b2 t^2 + b3 t^3| for -1 <= t <= 1. */
static mg_real mg_largest_of_cubic(const mg_real *b) {
  mg_real largest = mg_max(fabs(mg_cubic_at(b, -1)), fabs(mg_cubic_at(b, 1)));
  const mg_real discriminant = b[2] * b[2] - 3 * b[1] * b[3];
  if (!(discriminant > 0)) return largest;
  const mg_real root = b[2] < 0 ? sqrt(discriminant) - b[2] : -b[2] - sqrt(discriminant); /* not small by cancelling */
  if (fabs(root) < fabs(3 * b[3])) largest = mg_max(largest, fabs(mg_cubic_at(b, root / (3 * b[3]))));
  if (fabs(b[1]) < fabs(root)) largest = mg_max(largest, fabs(mg_cubic_at(b, b[1] / root)));
  return largest;
}

/* What is compared with a spline over a range: value + slope r + bend r^2, with r from -1 to 1 for the distance of the
   coordinate from `middle` over `half`. */
typedef struct {
  mg_real middle, half, value, slope, bend;
} mg_quadratic;

static mg_real mg_quadratic_at(const mg_quadratic *q, mg_real r) { return q->value + (q->slope + q->bend * r) * r; }

/* Largest difference of piece i from a quadratic function between two places; *size is that of the numbers. */
static mg_real mg_piece_difference(const mg_bounds_spline *spline, const mg_real *coefficients, mg_real knot, int i,
                                   mg_real from, mg_real to, const mg_quadratic *q, mg_real *size) {
  const mg_real width = (to - from) / 2, at = from + width, s = at - knot, reach = fabs(s) + width;
  const mg_real place = q->half > 0 ? (at - q->middle) / q->half : 0, part = q->half > 0 ? width / q->half : 0;
  mg_real a[4];
  mg_spline_piece(spline, coefficients, i, a);
  const mg_real steepness = a[1] + (2 * a[2] + 3 * a[3] * s) * s;
  const mg_real b[4] = {mg_cubic_at(a, s) - mg_quadratic_at(q, place),
                        steepness * width - (q->slope + 2 * q->bend * place) * part,
                        (a[2] + 3 * a[3] * s) * width * width - q->bend * part * part, a[3] * width * width * width};
  *size = mg_max(*size, fabs(a[0]) + (fabs(a[1]) + (fabs(a[2]) + fabs(a[3]) * reach) * reach) * reach +
                            fabs(steepness) * (fabs(q->middle) + q->half));
  return mg_largest_of_cubic(b);
}

/* The same of the block of 2^level pieces from piece i on, which is not the last one: by its chord. */
static mg_real mg_block_difference(const mg_bounds_spline *spline, const mg_real *coefficients, const mg_real *knots,
                                   int i, int level, const mg_quadratic *q, mg_real *size) {
  const int end = i + (1 << level), n = spline->pieces;
  const mg_real *off = coefficients + 4 * n;
  for (int order = 0; order < spline->order; order++)
    for (int k = 1; n >> k; k++) off += n >> k;
  for (int k = 1; k < level; k++) off += n >> k;
  mg_real a[4], b[4];
  mg_spline_piece(spline, coefficients, i, a), mg_spline_piece(spline, coefficients, end, b);
  const mg_real from = (knots[i] - q->middle) / q->half, to = (knots[end] - q->middle) / q->half, width = to - from;
  const mg_real steepness = fabs(b[0] - a[0]) / (knots[end] - knots[i]);
  *size = mg_max(*size, fabs(a[0]) + fabs(b[0]) + steepness * (fabs(q->middle) + q->half));
  return mg_max(fabs(a[0] - mg_quadratic_at(q, from)), fabs(b[0] - mg_quadratic_at(q, to))) +
         fabs(q->bend) * width * width / 4 + off[i >> level];
}

/* The knot within a range nearest to its middle, which is in the piece `between`, as a kink; kink as in
   mg_bound_over_box. */
static void mg_note_knot(const mg_real *knots, int first, int between, int last, mg_real middle, mg_real half,
                         mg_real *kink) {
  for (int i = between; i <= between + 1; i++)
    if (i > first && i <= last && fabs(knots[i] - middle) < fabs(half * *kink)) *kink = (knots[i] - middle) / half;
}

/* A spline over the range of its coordinate, by blocks of its pieces that are narrow beside the range. The kernels add
   up the pieces, which differs by the rounding of as many terms. */
static mg_taylor_model mg_taylor_spline(const mg_bounds_spline *spline, const mg_real *numbers, const mg_real *box,
                                        mg_real *kink) {
  const mg_real *knots = numbers + spline->knots, *coefficients = numbers + spline->coefficients;
  const mg_real low = box[2 * spline->coordinate], high = box[2 * spline->coordinate + 1], half = (high - low) / 2,
                middle = low + half;
  const int first = mg_piece_at(spline, knots, low), last = mg_piece_at(spline, knots, high),
            between = mg_piece_at(spline, knots, middle);
  mg_real a[4], ends[2], rest = 0, size = 0;
  if (!(half < MG_MAX / 8)) return mg_no_bound;
  mg_spline_piece(spline, coefficients, first, a), ends[0] = mg_cubic_at(a, low - knots[first]);
  mg_spline_piece(spline, coefficients, last, a), ends[1] = mg_cubic_at(a, high - knots[last]);
  mg_spline_piece(spline, coefficients, between, a);
  const mg_real value = mg_cubic_at(a, middle - knots[between]), slope = (ends[1] - ends[0]) / 2,
                bend = (ends[1] + ends[0]) / 2 - value;
  const mg_quadratic q = {middle, half, value, slope, bend};
  for (int i = first, level = 0; i <= last; i += 1 << level) {
    for (level = 0; i > first && (i >> level) % 2 == 0 && i + (2 << level) <= last &&
                    (2 << level) * MG_SPLINE_BLOCKS <= last - first;)
      level++;
    const mg_real off = level ? mg_block_difference(spline, coefficients, knots, i, level, &q, &size)
                              : mg_piece_difference(spline, coefficients, knots[i], i, i > first ? knots[i] : low,
                                                    i < last ? knots[i + 1] : high, &q, &size);
    if (!(off < MG_MAX / 8)) return mg_no_bound;
    rest = mg_max(rest, off);
  }
  mg_taylor_model out = {value, {0, 0}, {0, 0, 0}, rest + 8 * (mg_real)spline->pieces * MG_EPS * size};
  out.slope[spline->coordinate] = slope, out.bend[2 * spline->coordinate] = bend;
  mg_note_knot(knots, first, between, last, middle, half, kink + spline->coordinate);
  return mg_rounded(out);
}

MG_INTERNAL void mg_bound_over_box(const mg_bounds_program *program, const mg_real *box, const mg_real *parameters,
                                   int wanted, mg_taylor_model *memory, mg_taylor_model *out, mg_real *kink) {
  kink[0] = kink[1] = 1;
  for (int k = 0, missing = wanted; k < program->n_instruction && missing > 0; k++) {
    const mg_instruction *at = program->instructions + k;
    if (at->operation == MG_OP_OUTPUT) out[at->result] = memory[at->a], missing -= at->result < wanted;
    else if (at->operation == MG_OP_INPUT && at->a == 0) {
      const mg_real low = box[2 * at->b], half = (box[2 * at->b + 1] - low) / 2;
      const mg_taylor_model coordinate = {low + half, {at->b == 0 ? half : 0, at->b == 1 ? half : 0}, {0, 0, 0}, 0};
      memory[at->result] = mg_rounded(coordinate);
    } else if (at->operation == MG_OP_SPLINE) {
      const mg_bounds_spline *spline = program->splines + at->a;
      memory[at->result] = mg_taylor_spline(spline, spline->is_constant ? program->constants : parameters, box, kink);
    } else if (at->operation == MG_OP_INPUT || at->operation == MG_OP_CONSTANT) {
      const mg_taylor_model number = {
          at->operation == MG_OP_INPUT ? parameters[at->b] : program->constants[at->a], {0, 0}, {0, 0, 0}, 0};
      memory[at->result] = number;
    } else memory[at->result] = mg_taylor_operation(at->operation, memory + at->a, memory + at->b, kink);
  }
}
