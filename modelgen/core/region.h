/* Planar regions, their intersection and its convex hull. Two regions lie in one plane: A on body o (without arcs:
   the whole plane) and B on body f, whose face looks against o's. Everything is in the axes of o's face.
   `mg_set_regions` divides the arcs, once for all; `mg_lay` finds what bounds A cap B for one pose of f's face, and
   its hull; `mg_hull_margin` tells, as often as wanted, how deep a point is inside the hull. Where A is the whole
   plane the hull moves with f: lay once with an identity pose, and ask in the axes of f's face. */
#ifndef MG_REGION_H
#define MG_REGION_H

#include <stddef.h>

#include "kernels.h"
#include "modelgen.h"

typedef struct { /* a piece of a region's boundary; arcs of one loop are consecutive and run end to start; a number
                    of loops left out begins a part of the region that may overlap those before */
  int shape, loop;
  const mg_real *parameters, *place; /* of the curve; p and R (12) in the axes of its face */
  mg_real t0, t1;
} mg_arc;

typedef struct {
  const mg_kernels *kernels;
  int n_arc, n_o;     /* the first n_o arcs bound A, the others B */
  const mg_arc *arc;
  mg_real shared;     /* m: points of the two boundaries nearer than this are one */
} mg_regions;

/* Ends of arcs are on the other boundary, and o's parts within f's, up to MG_SHARES times `shared`; f's within o's up to
   half of it: where f's part is left out for o's, o's has been cut at its ends and is kept. */
#define MG_SHARES 16
#define MG_SHORT 1024 /* sides of a hull up to so many times `shared` have no direction that can be relied on */

typedef struct { /* an arc placed in the plane, or a part of it; turn: sum of its end tangents' sines to the chord */
  int track;
  mg_real a, b, P[2], Q[2], S[2], E[2], turn;
} mg_span;

typedef struct {
  const mg_kernels *kernels;
  int shape, side, straight, span, n_span, next; /* next: the arc that goes on in its loop */
  int right; /* the region lies on its right */
  const mg_real *parameters;
  mg_real t0, t1, at[2], axis[6];
} mg_track;

typedef struct { /* where an arc of A meets one of B */
  int track[2];
  mg_real t[2], point[2];
} mg_cut;

typedef struct { /* a part of a boundary that bounds A cap B, or (thin) is all of it there; cut: what ends it, or -1 */
  int track, thin, cut[2];
  mg_real t[2];
} mg_piece;

typedef struct { /* a point of a piece; next: the one after it on a curve, or -1, which is reached at t_end */
  int track, cut, next, twin;
  mg_real t, t_end, point[2], tangent[2];
} mg_spot;

typedef struct { /* a side of the hull from spot u to spot v: straight, or along the curve, forward or back */
  int u, v, way;
  mg_real normal[2], length, sag;
} mg_edge;

typedef struct {
  const mg_regions *regions;
  mg_track *track;
  mg_span *span;
  mg_cut *cut;
  mg_piece *piece;
  mg_spot *spot;
  mg_edge *edge;
  int *order;
  int n_span, n_cut, n_piece, n_spot, n_edge;
  int span_room, cut_room, piece_room, spot_room;
  int overflow; /* more crossings than there was room for */
  int mirrored; /* f's face looks against o's, in whose axes it lies */
  mg_real size; /* m, of what is kept */
} mg_hull;

typedef struct { /* an extreme point: of which boundary (0: o, 1: f), arc and parameter; crossing_arc: of the other
                    boundary where it passes there, or -1 */
  int side, arc, crossing_arc;
  mg_real t, crossing_t, point[2];
} mg_support;

typedef struct { /* where the hull is nearest to x: n = 1 a vertex or a point of a curve, n = 2 a straight side
                    between two; normal: outward, unit */
  int n;
  mg_real margin, normal[2];
  mg_support at[2];
} mg_brink;

/* lay.c: the memory that a hull needs, in mg_real; it and `regions` with its arcs must outlive the hull. `pose` (12):
   of f's face in the axes of o's, flattened. Returns the number of the hull's sides: 0 where A cap B is empty, 1 for
   a point, 2 for a segment. */
MG_INTERNAL long mg_hull_room(int n_arc, int n_o);
MG_INTERNAL void mg_set_regions(mg_hull *h, const mg_regions *regions, mg_real *memory);
MG_INTERNAL int mg_lay(mg_hull *h, const mg_real *pose);
MG_INTERNAL long mg_reals(long n, size_t size);
MG_INTERNAL void *mg_part_of_memory(mg_real **memory, long n, size_t size);

/* margin.c: signed distance of x to the hull's boundary, m, > 0 inside; -MG_MAX for an empty hull. */
MG_INTERNAL mg_real mg_hull_margin(const mg_hull *h, const mg_real *x, mg_brink *brink);
MG_INTERNAL void mg_support_at(const mg_hull *h, int spot, mg_support *at);

/* tracks.c */
enum { MG_LEVEL, MG_FOOT, MG_BEND }; /* zeros sought along an arc: v.c'; (c - v).c'; the curvature */
MG_INTERNAL void mg_divide_tracks(mg_hull *h);
MG_INTERNAL void mg_place_tracks(mg_hull *h, const mg_real *pose);
MG_INTERNAL void mg_on(const mg_track *k, mg_real t, mg_real *point, mg_real *tangent);
MG_INTERNAL void mg_span_between(const mg_hull *h, int track, mg_real a, mg_real b, mg_span *span);
MG_INTERNAL mg_real mg_zero_along(const mg_track *k, int sought, const mg_real *v, mg_real a, mg_real b);
MG_INTERNAL mg_real mg_dot2(const mg_real *a, const mg_real *b);
MG_INTERNAL mg_real mg_cross2(const mg_real *a, const mg_real *b);
MG_INTERNAL mg_real mg_apart2(const mg_real *a, const mg_real *b);

/* crossings.c, inside.c, outline.c, hull.c */
MG_INTERNAL void mg_find_cuts(mg_hull *h);
MG_INTERNAL int mg_is_inside(const mg_hull *h, int side, const mg_real *p);
MG_INTERNAL void mg_make_hull(mg_hull *h);
MG_INTERNAL void mg_outline_pieces(const mg_hull *h, int fine, mg_outline *out);
MG_INTERNAL void mg_outline_hull(const mg_hull *h, int fine, mg_outline *out);

#endif
