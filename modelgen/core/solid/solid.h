/* The material of shapes: how deep a point is in it. May use: base, model. */
#ifndef MG_SOLID_H
#define MG_SOLID_H

#include "model/model.h"

/* depth.c */

/* Signed height of a point, world axes, over a solid of a body at a pose, m: negative in it, with a sign that is exact
   to rounding. To first order it is the distance from the surface (MG_FIRST_ORDER); or its slope is 1 at most, so that
   no point nearer to x than its size is on the other side (MG_LIPSCHITZ). It ends at the cavities of its body. */
MG_INTERNAL mg_real mg_height_over_solid(const mg_system *s, int solid, const mg_real *pose, const mg_real *x, int how);

/* True if the material of the shape of one side of a pair is known: that it has none, too. */
MG_INTERNAL int mg_is_material_known(const mg_context *c, int pair, int side);

/* True if the shape of one side of a pair, whose material is known, has some: curves and discs have none. */
MG_INTERNAL int mg_has_material(const mg_context *c, int pair, int side);

/* The same height over the material of the shape of one side of a pair. Needs the poses. */
MG_INTERNAL mg_real mg_height_over_material(const mg_context *c, int pair, int side, const mg_real *x, int how);

#endif
