/* What can be asked of two planar regions without a run: their intersection, its hull, friction between them. */
#ifndef MG_PLANAR_QUERIES_H
#define MG_PLANAR_QUERIES_H

typedef struct { /* points in order, loop after loop; count goes on beyond capacity */
  int capacity, count, n_loop;
  mg_real *point; /* 2 each */
  int *loop;      /* 1 each */
} mg_outline;

typedef struct { /* two planar regions laid on each other: A on the face of o (n_o = 0: the whole plane), B */
  const mg_kernels *kernels;
  int n_arc, n_o;      /* the first n_o arcs bound A, the others B */
  int points_per_turn; /* points to a part of a curve that turns by less than 0.3 rad, in outlines */
  int n_point;
  const int *shape, *loop, *first; /* per arc: shape kind, loop, offset of its curve's parameters */
  const mg_real *parameters;
  const mg_real *numbers; /* 14 an arc: placement of the curve in the axes of its face (12), first and last parameter */
  const mg_real *pose;    /* 12, of f's face in the axes of o's */
  mg_real coincidence;    /* m: points of the two boundaries nearer than this are one */
  const mg_real *points;  /* 2 a point, in the axes of o's face */
  mg_real *margin;        /* 1 a point: signed distance to the boundary of the hull of A cap B, m, > 0 inside */
  mg_real *normal;        /* 2: outward, of the hull where it is nearest */
  int *supports;          /* 1: 1 the nearest is a point, 2 a straight side, 0 there is no hull */
  int *identity;          /* 2 x 3: per support its side (0: o, 1: f), arc, arc of the other side that passes or -1 */
  mg_real *support_position;  /* 2 x 4: per support t on each of those arcs, then the point */
  mg_outline *outline, *hull; /* of A cap B, of its hull */
} mg_region_query;

typedef struct { /* friction between two regions laid on each other (rubbing.h), for n loads and twists */
  const mg_region_query *regions;
  int n;
  const mg_real *load; /* 3 each: resultant force, N, and its centre, in the axes of o's face */
  const mg_real
      *twist; /* 3 each, of f past o there: velocity of the centre, m/s; spin about the outward normal, rad/s */
  const mg_real *wrench;    /* 3 each: a force, N, through the centre and a torque, N m, that friction is to hold */
  int *found;               /* 1: the centre is inside the hull and the pressure has been found */
  mg_real *pressure;        /* 3: at the centre, Pa, and its slope, Pa/m; where this says less than 0 it is 0 */
  mg_real *friction;        /* 3: force and torque about the centre, for a coefficient of 1 */
  mg_real *friction_needed; /* 1: the coefficient that it takes to hold the wrench */
  mg_real *limiting_twist;  /* 3: the twist (velocity of the centre, spin) against which the wrench does most work for
                         its friction, scaled to unit length with the spin times the reach of the pressure */
} mg_patch_friction_query;

/* The intersection of two regions and its hull. Returns the number of the hull's sides: 0 where it is empty, 1 for a
   point, or -1 if the boundaries cross more often than there is room for. `work` has mg_region_size mg_real. */
MG_API long mg_region_size(int n_arc, int n_o);
MG_API int mg_region(const mg_region_query *query, mg_real *work);

/* The same numbers and memory; returns the number of the hull's sides, or -1. */
MG_API long mg_region_friction_size(int n_arc, int n_o);
MG_API int mg_region_friction(const mg_patch_friction_query *query, mg_real *work);

#endif
