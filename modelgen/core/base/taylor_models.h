/* Taylor models of second order (Makino and Berz, 2003): bounds of a function over a box of two coordinates. Each
   number is a quadratic function of the place in the box and a bound of the rest, which is of third order in the size
   of the box. A function is a program, a list of instructions over a memory of Taylor models. */
#ifndef MG_TAYLOR_MODELS_H
#define MG_TAYLOR_MODELS_H

#include "base/real.h"

/* Operations of a program. */
enum {
  MG_OP_CONSTANT,
  MG_OP_INPUT,
  MG_OP_OUTPUT,
  MG_OP_COPY,
  MG_OP_ADD,
  MG_OP_SUBTRACT,
  MG_OP_MULTIPLY,
  MG_OP_DIVIDE,
  MG_OP_NEGATE,
  MG_OP_SQUARE,
  MG_OP_TWICE,
  MG_OP_INVERT,
  MG_OP_SQRT,
  MG_OP_POWER,
  MG_OP_EXP,
  MG_OP_LOG,
  MG_OP_SIN,
  MG_OP_COS,
  MG_OP_TAN,
  MG_OP_ASIN,
  MG_OP_ACOS,
  MG_OP_ATAN,
  MG_OP_ATAN2,
  MG_OP_SINH,
  MG_OP_COSH,
  MG_OP_TANH,
  MG_OP_FABS,
  MG_OP_SIGN,
  MG_OP_FMIN,
  MG_OP_FMAX,
  MG_OP_LESS,
  MG_OP_LESS_EQUAL,
  MG_OP_EQUAL,
  MG_OP_NOT_EQUAL,
  MG_OP_NOT,
  MG_OP_AND,
  MG_OP_OR,
  MG_OP_IF_ELSE_ZERO,
  MG_OP_SHARE,
  MG_OP_SPLINE
};

/* One instruction: `result` and the operands a, b are places in the memory. Of CONSTANT, a is the number of the
   constant; of INPUT, a is 0 for a coordinate and 1 for a parameter, b its number; of OUTPUT, `result` is the number
   of the output; of SPLINE, a is the number of the spline. SHARE is a condition over a number of conditions that hold,
   one of which it is: at most 1. */
typedef struct {
  unsigned short operation, result, a, b;
} mg_instruction;

/* A derivative of a piecewise cubic of a coordinate with continuous second derivatives. Between the knots i and i + 1,
   with s the distance from the knot i, the cubic is c0[i] + c1[i] s + c2[i] s^2 + c3[i] s^3; the first and the last
   piece go on beyond the ends. */
typedef struct {
  int coordinate;   /* 0 or 1 */
  int order;        /* of the derivative, 0 to 2 */
  int pieces;       /* pieces */
  int is_constant;  /* 1: the places are those of constants, 0: of parameters */
  int knots;        /* place of the first one of pieces + 1 */
  int coefficients; /* place of c0[pieces], c1[pieces], c2[pieces], c3[pieces], and bounds of how far the cubic,
                       its slope and its second derivative are from their chords over blocks of pieces: of each the
                       pieces/2 blocks of 2, then the pieces/4 of 4, ... */
} mg_bounds_spline;

/* A function of coordinates and parameters. */
typedef struct {
  int n_instruction;                  /* instructions; 0: there is no function */
  int n_memory;                       /* Taylor models of memory */
  int n_parameters;                   /* parameters */
  const mg_instruction *instructions; /* [n_instruction] */
  const mg_real *constants;           /* constants */
  const mg_bounds_spline *splines;    /* splines; 0: there are none */
} mg_bounds_program;

/* middle + slope[0] r + slope[1] s + bend[0] r^2 + bend[1] r s + bend[2] s^2 + e, for the place -1 <= r, s <= 1 in the
   box, with |e| <= rest. rest = MG_MAX: no bound is known. */
typedef struct {
  mg_real middle, slope[2], bend[3], rest;
} mg_taylor_model;

#endif
