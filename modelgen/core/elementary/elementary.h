/* Elementary functions that give the same bits on every machine with IEEE arithmetic in double precision: they use
   sums, products, quotients and square roots of doubles, and integers, and nothing of the C library that may round
   otherwise elsewhere. Each result is within one unit in the last place of the exact one. Special values are those of
   C99, annex F. Of float and long double the functions are those of the C library.
   May use: nothing of the core. */
#ifndef MG_ELEMENTARY_H
#define MG_ELEMENTARY_H

#include <math.h>

#if defined(MG_REAL_FLOAT) || defined(MG_REAL_LONG)
#include <tgmath.h>
#define mg_sin(x) sin(x)
#define mg_cos(x) cos(x)
#define mg_tan(x) tan(x)
#define mg_asin(x) asin(x)
#define mg_acos(x) acos(x)
#define mg_atan(x) atan(x)
#define mg_atan2(y, x) atan2(y, x)
#define mg_sinh(x) sinh(x)
#define mg_cosh(x) cosh(x)
#define mg_tanh(x) tanh(x)
#define mg_asinh(x) asinh(x)
#define mg_exp(x) exp(x)
#define mg_log(x) log(x)
#define mg_pow(x, y) pow(x, y)
#define mg_hypot(x, y) hypot(x, y)
#else

/* trigonometric.c */
double mg_sin(double x);
double mg_cos(double x);
double mg_tan(double x);

/* inverse_trigonometric.c */
double mg_asin(double x);
double mg_acos(double x);
double mg_atan(double x);
double mg_atan2(double y, double x);

/* exponential.c */
double mg_exp(double x);
double mg_sinh(double x);
double mg_cosh(double x);
double mg_tanh(double x);

/* logarithm_and_power.c */
double mg_log(double x);
double mg_asinh(double x);
double mg_pow(double x, double y);

/* hypotenuse.c */
double mg_hypot(double x, double y);

#endif
#endif
