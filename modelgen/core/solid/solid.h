/* The material of shapes: how deep a point is in it, and whether two have a point in common. May use: base, model. */
#ifndef MG_SOLID_H
#define MG_SOLID_H

#include "model/model.h"

/* depth.c */

/* Signed height of a point, world axes, over a solid of a body at a pose, m: negative in it, with a sign that is exact
   to rounding. To first order it is the distance from the surface (MG_FIRST_ORDER); or its slope is 1 at most, so that
   no point nearer to x than its size is on the other side (MG_LIPSCHITZ). It ends at the cavities of its body. */
MG_INTERNAL mg_real mg_height_over_solid(const mg_system *s, int solid, const mg_real *pose, const mg_real *x, int how);

/* True if a solid, less the cavities of its body, is convex; if the points that are not in it are; if it is a ball. */
MG_INTERNAL int mg_is_solid_convex(const mg_system *s, int solid);
MG_INTERNAL int mg_is_outside_convex(const mg_system *s, int solid);
MG_INTERNAL int mg_is_solid_ball(const mg_system *s, int solid);

/* True if the material of the shape of one side of a pair is known: that it has none, too. */
MG_INTERNAL int mg_is_material_known(const mg_context *c, int pair, int side);

/* True if the shape of one side of a pair, whose material is known, has some: curves and discs have none. */
MG_INTERNAL int mg_has_material(const mg_context *c, int pair, int side);

/* The same height over the material of the shape of one side of a pair. Needs the poses. */
MG_INTERNAL mg_real mg_height_over_material(const mg_context *c, int pair, int side, const mg_real *x, int how);

/* common_point.c */

/* Two solids at poses of their bodies; one whose number is negative has all points. */
typedef struct {
  const mg_system *system;
  int solid[2];
  const mg_real *pose[2];
} mg_both_solids;

/* What a search for a common point found. */
typedef struct {
  mg_real lowest[3]; /* the lowest of the points that were looked at, world axes, m */
  mg_real half;      /* half the side of the smallest cells, m */
  mg_real slack;     /* bound from below, m, of how far the solids can move in all before they have a common point */
  int is_undecided;  /* 1: there are cells left that may hold one */
} mg_common_point;

/* Height of a point over what two solids have in common, m. */
MG_INTERNAL mg_real mg_height_over_both(const mg_both_solids *both, const mg_real *x, int how);

/* Searches the cube around a ball, world axes, for a point deeper than `deep` in both solids, m, in cells down to half
   a side of `smallest`, m. Returns 1 if there is one; `found->lowest` is it then. */
MG_INTERNAL int mg_find_common_point(const mg_both_solids *both, const mg_real *centre, mg_real radius, mg_real deep,
                                     mg_real smallest, mg_common_point *found);

#endif
