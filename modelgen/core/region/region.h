/* Planar regions, their intersection and its convex hull. Two regions lie in one plane: A on body o (without arcs:
   the whole plane) and B on body f, whose face looks against o's. Everything is in the axes of o's face.
   `mg_set_regions` divides the arcs, once for all; `mg_overlay_regions` finds what bounds A cap B for one pose of f's
face, and its hull; `mg_hull_margin` tells, as often as wanted, how deep a point is inside the hull. Where A is the
whole plane the hull moves with f: lay once with an identity pose, and ask in the axes of f's face.

Friction between two faces that lie on each other: the pressure between them, what Coulomb's law at every point sums up
   to, and how much of it a force needs that holds. Everything is in the axes of a hull (region.h), which must be laid.

   The pressure is that of Winkler's foundation that does not pull: p = max(0, a + b.x), the only one of this form with
a given resultant and centre, and of all pressures that have them the one with the least integral of p^2. It is affine
   while the centre lies in the kern of the region, and crowds into what the face turns on as the centre nears the edge
of the hull. (Winkler, Die Lehre von der Elasticitaet und Festigkeit, 1867; Johnson, Contact Mechanics, 1985,
section 4.3.)

   A twist (v, w) of f past o rubs with u = (v + w k x d) / |v + w k x d| at a point d off the centre of pressure:
     F = -mu * integral p u dA,   torque = -mu * integral p d x u dA,   power = -mu * integral p |v + w k x d| dA.
   All forces and torques that hold lie within those of all twists, the limit surface; the force is the gradient of the
   power (Goyal, Ruina, Papadopoulos, Wear 143 (1991), 307-330 and 331-352). For a uniform disc: Farkas, Bartels, Unger,
Wolf, Phys. Rev. Lett. 90 (2003), 248302. May use: base, and the shapes of kernels.h. */
#ifndef MG_REGION_H
#define MG_REGION_H

#include "base/base.h"
#include "modelgen.h"

#include <stddef.h>

typedef struct { /* a piece of a region's boundary; arcs of one loop are consecutive and run end to start; a number
                    of loops left out begins a part of the region that may overlap those before */
  int shape, loop;
  const mg_real *parameters, *place; /* of the curve; p and R (12) in the axes of its face */
  mg_real t0, t1;
} mg_arc;

typedef struct {
  const mg_kernels *kernels;
  int n_arc, n_o; /* the first n_o arcs bound A, the others B */
  const mg_arc *arc;
  mg_real coincidence; /* m: points of the two boundaries nearer than this are one */
} mg_region_pair;

/* Ends of arcs are on the other boundary, and o's parts within f's, up to MG_COINCIDENCE_FACTOR times `shared`; f's
   within o's up to half of it: where f's part is left out for o's, o's has been cut at its ends and is kept. */
#define MG_COINCIDENCE_FACTOR 16

#define MG_SHORT_SIDE 1024 /* sides of a hull up to so many times `shared` have no direction that can be relied on */

typedef struct { /* an arc placed in the plane, or a part of it; turn: sum of its end tangents' sines to the chord */
  int arc;
  mg_real t_begin, t_end, begin[2], end[2], begin_tangent[2], end_tangent[2], turn;
} mg_arc_span;

typedef struct {
  const mg_kernels *kernels;
  int shape, side, straight, span, n_span, next; /* next: the arc that goes on in its loop */
  int right;                                     /* the region lies on its right */
  const mg_real *parameters;
  mg_real t0, t1, at[2], axis[6];
} mg_placed_arc;

typedef struct { /* where an arc of A meets one of B */
  int arc[2];
  mg_real t[2], point[2];
} mg_intersection;

typedef struct { /* a part of a boundary that bounds A cap B, or (thin) is all of it there; cut: what ends it, or -1 */
  int arc, is_thin, intersection[2];
  mg_real t[2];
} mg_boundary_piece;

typedef struct { /* a point of a piece; next: the one after it on a curve, or -1, which is reached at t_end */
  int arc, intersection, next, twin;
  mg_real t, t_end, point[2], tangent[2];
} mg_hull_vertex;

typedef struct { /* a side of the hull from spot u to spot v: straight, or along the curve, forward or back */
  int from_vertex, to_vertex, direction;
  mg_real normal[2], length, height;
} mg_hull_edge;

typedef struct {
  const mg_region_pair *regions;
  mg_placed_arc *arcs;
  mg_arc_span *spans;
  mg_intersection *intersections;
  mg_boundary_piece *pieces;
  mg_hull_vertex *vertices;
  mg_hull_edge *edges;
  int *order;
  int n_span, n_intersection, n_piece, n_vertex, n_edge;
  int span_capacity, intersection_capacity, piece_capacity, vertex_capacity;
  int overflow; /* more crossings than there was room for */
  int mirrored; /* f's face looks against o's, in whose axes it lies */
  mg_real size; /* m, of what is kept */
} mg_hull;

typedef struct { /* an extreme point: of which boundary (0: o, 1: f), arc and parameter; crossing_arc: of the other
                    boundary where it passes there, or -1 */
  int side, arc, crossing_arc;
  mg_real t, crossing_t, point[2];
} mg_support_point;

typedef struct { /* where the hull is nearest to x: n = 1 a vertex or a point of a curve, n = 2 a straight side
                    between two; normal: outward, unit */
  int n;
  mg_real margin, normal[2];
  mg_support_point at[2];
} mg_nearest_boundary;

enum {
  MG_ZERO_SUPPORT,
  MG_ZERO_FOOT,
  MG_ZERO_CURVATURE
}; /* zeros sought along an arc: v.c'; (c - v).c'; the curvature */

typedef struct {              /* a part of the boundary of what is pressed, run through with that on the left */
  int arc, straight, ends[2]; /* ends: the pressure vanishes there, within the region */
  mg_real t[2], begin[2], end[2];
} mg_boundary_strip;

typedef struct {
  const mg_hull *hull;
  int partly_unloaded; /* the pressure vanishes on a line across the region */
  long n, capacity;    /* strips */
  mg_boundary_strip *strips;
  mg_real centre[2], coefficients[3]; /* p = level[0] + (level[1], level[2]).(x - centre) */
  mg_real line_foot[2];               /* of the centre on that line; else the centre */
  mg_real moments[6];                 /* of what is pressed, about the centre: 1, x, y, xx, xy, yy */
  mg_real reach;                      /* m: no point of it is farther from the centre */
} mg_winkler_pressure_field;

enum { MG_NODES = 10, MG_FEW_NODES = 4 };

/* Gauss and Legendre's nodes and weights on 0..1. */
static const mg_real mg_node[MG_NODES] = {(mg_real)0.013046735741414139961018, (mg_real)0.0674683166555077446339517,
                                          (mg_real)0.160295215850487796882836, (mg_real)0.283302302935376404600367,
                                          (mg_real)0.425562830509184394557587, (mg_real)0.574437169490815605442413,
                                          (mg_real)0.716697697064623595399633, (mg_real)0.839704784149512203117164,
                                          (mg_real)0.932531683344492255366048, (mg_real)0.986953264258585860038982};

static const mg_real mg_node_weight[MG_NODES] = {
    (mg_real)0.0333356721543440687967844, (mg_real)0.0747256745752902965728882, (mg_real)0.109543181257991021997767,
    (mg_real)0.134633359654998177545613,  (mg_real)0.147762112357376435086946,  (mg_real)0.147762112357376435086946,
    (mg_real)0.134633359654998177545613,  (mg_real)0.109543181257991021997767,  (mg_real)0.0747256745752902965728882,
    (mg_real)0.0333356721543440687967844};

/* placed_arcs.c */
MG_INTERNAL void mg_arc_point(const mg_placed_arc *k, mg_real t, mg_real *point, mg_real *tangent);
MG_INTERNAL void mg_make_span(const mg_hull *h, int track, mg_real a, mg_real b, mg_arc_span *span);
MG_INTERNAL mg_real mg_zero_on_arc(const mg_placed_arc *k, int sought, const mg_real *v, mg_real a, mg_real b);
MG_INTERNAL void mg_divide_arcs(mg_hull *h);
MG_INTERNAL void mg_place_arcs(mg_hull *h, const mg_real *pose);

/* intersections.c */
MG_INTERNAL void mg_find_intersections(mg_hull *h);

/* point_in_region.c */
MG_INTERNAL int mg_locate_point(const mg_hull *h, int side, const mg_real *p);

/* overlay.c */
MG_INTERNAL long mg_hull_memory_size(int n_arc, int n_o);
MG_INTERNAL long mg_strip_capacity(int n_arc, int n_o);
MG_INTERNAL void mg_set_regions(mg_hull *h, const mg_region_pair *regions, mg_real *memory);
MG_INTERNAL int mg_overlay_regions(mg_hull *h, const mg_real *pose);

/* convex_hull.c */
MG_INTERNAL void mg_make_hull(mg_hull *h);

/* hull_distance.c */
MG_INTERNAL void mg_read_support_point(const mg_hull *h, int spot, mg_support_point *at);
MG_INTERNAL mg_real mg_hull_margin(const mg_hull *h, const mg_real *x, mg_nearest_boundary *brink);

/* outline.c */
MG_INTERNAL void mg_outline_pieces(const mg_hull *h, int fine, mg_outline *out);
MG_INTERNAL void mg_outline_hull(const mg_hull *h, int fine, mg_outline *out);

/* winkler_pressure.c */
MG_INTERNAL void mg_open_pressure(mg_winkler_pressure_field *p, const mg_hull *h, long room, mg_boundary_strip *strips);
MG_INTERNAL int mg_solve_moments(const mg_winkler_pressure_field *p, const mg_real *moment, mg_real *level);
MG_INTERNAL void mg_uniform_pressure(mg_winkler_pressure_field *p, const mg_real *about);
MG_INTERNAL int mg_move_inside_hull(const mg_hull *h, mg_real *x);
MG_INTERNAL int mg_winkler_pressure(mg_winkler_pressure_field *p, mg_real force, const mg_real *centre);

/* friction_wrench.c */
MG_INTERNAL void mg_friction_matrix(const mg_winkler_pressure_field *p, const mg_real *twist, mg_real G[3][3]);
MG_INTERNAL mg_real mg_limit_surface_ratio(const mg_winkler_pressure_field *p, const mg_real *wrench, mg_real radius,
                                           mg_real *twist);

#endif
