/* The types of numbers of the core, and the linkage of its functions.

   mg_real is double; -DMG_REAL_FLOAT or -DMG_REAL_LONG select float or long double. MG_EPS is its rounding unit, MG_MAX
   its largest finite value, which also stands for "no bound". */
#ifndef MG_REAL_H
#define MG_REAL_H

#include <float.h>
#include <math.h>

#include "elementary/elementary.h"

#if defined(MG_REAL_LONG)
typedef long double mg_real;
#define MG_EPS LDBL_EPSILON
#define MG_MAX LDBL_MAX
#include <tgmath.h>
#elif defined(MG_REAL_FLOAT)
typedef float mg_real;
#define MG_EPS FLT_EPSILON
#define MG_MAX FLT_MAX
#include <tgmath.h>
#else
typedef double mg_real;
#define MG_EPS DBL_EPSILON
#define MG_MAX DBL_MAX
#endif

/* The smaller and the larger of two numbers; the other one where one is not a number. */
static inline mg_real mg_min(mg_real a, mg_real b) { return a < b || b != b ? a : b; }
static inline mg_real mg_max(mg_real a, mg_real b) { return a > b || b != b ? a : b; }

/* A digest of numbers; C99 demands 64 bits of it. */
typedef unsigned long long mg_digest;

#define MG_PI ((mg_real)3.14159265358979323846264338327950288L)

/* Linkage of the functions that files of the core share. The core is compiled as one unit, where they are static;
   -DMG_INTERNAL= compiles each file by itself. */
#ifndef MG_INTERNAL
#define MG_INTERNAL static
#endif

#if defined(_WIN32)
#define MG_API __declspec(dllexport)
#elif defined(__GNUC__)
#define MG_API __attribute__((visibility("default")))
#else
#define MG_API
#endif

#endif
