/* Planar regions, the overlap of two of them, its convex hull, and friction between two faces that rest on each other.

   Regions. A region is bounded by arcs: pieces of straight lines and curves, in loops. Two regions lie in one plane: A
   on body o (without arcs: the whole plane) and B on body f, whose face is opposite to o's. All coordinates are those
   of o's face. mg_set_regions divides the arcs into spans, once for a pair of regions; mg_overlay_regions finds the
   boundary of the overlap A cap B for one pose of f's face, and its convex hull; mg_hull_margin then gives the signed
   distance of a point from the boundary of the hull. Where A is the whole plane, the hull moves with f: it is made once
   with an identity pose, and points are given in the axes of f's face.

   Pressure. The pressure between the faces is that of a Winkler foundation that does not pull: p = max(0, a + b.x). It
   is the only one of this form with a given resultant and centre, and of all pressures with these the one of least
   integral of p^2. It is affine while the centre lies in the kern of the region; as the centre approaches the boundary
   of the hull, the loaded part shrinks to the points about which the face tips. (Winkler, Die Lehre von der
   Elasticitaet und Festigkeit, 1867; Johnson, Contact Mechanics, 1985, section 4.3.)

   Friction. Coulomb's law holds at every point. Under a twist (v, w) of f relative to o, given at the centre of
   pressure, the velocity at a point d off the centre is v + w k x d, with direction u = (v + w k x d) / |v + w k x d|;
   then
     F = -mu * integral p u dA,   torque = -mu * integral p d x u dA,   power = -mu * integral p |v + w k x d| dA.
   Forces and torques that a sticking face can carry lie within those of all twists, the limit surface; force and torque
   are the gradient of the power by the twist (Goyal, Ruina and Papadopoulos, Wear 143 (1991), 307-330 and 331-352). For
   a uniform disc: Farkas, Bartels, Unger and Wolf, Phys. Rev. Lett. 90 (2003), 248302.

   May use: base, and the kernels of shapes. */
#ifndef MG_REGION_H
#define MG_REGION_H

#include "base/base.h"
#include "modelgen.h"

#include <stddef.h>

/* A piece of the boundary of a region. Arcs of one loop are consecutive, each begins where the one before it ends. A
   gap in the numbers of the loops begins a part of the region that may overlap the parts before it. */
typedef struct {
  int shape;                 /* shape kind of its curve */
  int loop;                  /* number of its loop */
  const mg_real *parameters; /* parameters of its curve */
  const mg_real *place;      /* [12] origin and rotation matrix by columns of its curve in the axes of the face */
  mg_real t0, t1;            /* curve parameters of begin and end */
} mg_arc;

/* Two regions. */
typedef struct {
  const mg_kernels *kernels; /* kernels of the library */
  int n_arc;                 /* arcs of both regions */
  int n_o;                   /* the first n_o arcs bound A, the others B */
  const mg_arc *arc;         /* [n_arc] arcs */
  mg_real coincidence;       /* points of the two boundaries nearer than this coincide, m */
} mg_region_pair;

/* Points of o's boundary within MG_COINCIDENCE_FACTOR * coincidence of f's are on it; points of f's boundary within
   half of that of o's. So where both boundaries coincide, o's is cut at the ends of f's and is kept, and f's is left
   out. */
#define MG_COINCIDENCE_FACTOR 16

#define MG_SHORT_SIDE 1024 /* sides of a hull up to MG_SHORT_SIDE * coincidence have no reliable direction */

/* A span: a part of a placed arc that turns little. */
typedef struct {
  int arc;                                  /* its arc */
  mg_real t_begin, t_end;                   /* curve parameters of begin and end */
  mg_real begin[2], end[2];                 /* begin and end, m */
  mg_real begin_tangent[2], end_tangent[2]; /* unit tangents there */
  mg_real turn;                             /* sum of the sines of the end tangents to the chord; 0: straight */
} mg_arc_span;

/* An arc placed in the plane. */
typedef struct {
  const mg_kernels *kernels; /* kernels of the library */
  int shape;                 /* shape kind of its curve */
  int side;                  /* region that it bounds: 0 A, 1 B */
  int straight;              /* 1: a straight line */
  int span, n_span;          /* first span and number of spans */
  int next;                  /* next arc of its loop */
  int right;                 /* 1: the region lies on its right */
  const mg_real *parameters; /* parameters of its curve */
  mg_real t0, t1;            /* curve parameters of begin and end */
  mg_real at[2], axis[6];    /* origin and axes of the curve, projected to the plane: point = at + axis x */
} mg_placed_arc;

/* A point where an arc of A meets an arc of B. */
typedef struct {
  int arc[2];       /* arcs of A and of B */
  mg_real t[2];     /* their curve parameters */
  mg_real point[2]; /* the point, m */
} mg_intersection;

/* A part of an arc that bounds the overlap of the regions. */
typedef struct {
  int arc;             /* its arc */
  int is_thin;         /* 1: the overlap has no width there */
  int intersection[2]; /* intersections at its ends, or -1 */
  mg_real t[2];        /* curve parameters of its ends */
} mg_boundary_piece;

/* A point of a piece that may be a vertex of the hull. */
typedef struct {
  int arc;            /* its arc */
  int intersection;   /* intersection at the point, or -1 */
  int next;           /* next point on the same curve, at the parameter t_end, or -1 */
  int twin;           /* next point that coincides with it, in a ring; itself if there is none */
  mg_real t, t_end;   /* curve parameters of the point and of the next */
  mg_real point[2];   /* the point, m */
  mg_real tangent[2]; /* tangent of the curve there */
} mg_hull_vertex;

/* An edge of the hull. */
typedef struct {
  int from_vertex, to_vertex; /* its ends, counterclockwise */
  int direction;              /* 0: straight; 1, -1: along the curve from the first to the second, or against it */
  mg_real normal[2];          /* outward unit normal of its chord */
  mg_real length;             /* length of its chord, m */
  mg_real height;             /* bound of the distance of the curve from its chord, m */
} mg_hull_edge;

/* The overlap of two regions and its convex hull. */
typedef struct {
  const mg_region_pair *regions;  /* the regions */
  mg_placed_arc *arcs;            /* arcs in the plane */
  mg_arc_span *spans;             /* spans of all arcs */
  mg_intersection *intersections; /* intersections of the boundaries */
  mg_boundary_piece *pieces;      /* boundary of the overlap */
  mg_hull_vertex *vertices;       /* points of the pieces */
  mg_hull_edge *edges;            /* edges of the hull, counterclockwise */
  int *order;                     /* points in order from left to right, then corners of the hull */
  int n_span, n_intersection, n_piece, n_vertex, n_edge;                     /* numbers in use */
  int span_capacity, intersection_capacity, piece_capacity, vertex_capacity; /* numbers for which there is room */
  int overflow; /* 1: there was no room for all intersections, pieces or points */
  int mirrored; /* 1: the pose of f's face mirrors its axes, because f's face is opposite to o's */
  mg_real size; /* bound of the coordinates of all arcs, m */
} mg_hull;

/* A point of the boundary of the hull. */
typedef struct {
  int side;           /* region whose boundary it is on: 0 A, 1 B */
  int arc;            /* its arc */
  int crossing_arc;   /* arc of the other region through the point, or -1 */
  mg_real t;          /* curve parameter on its arc */
  mg_real crossing_t; /* curve parameter on the other arc */
  mg_real point[2];   /* the point, m */
} mg_support_point;

/* The place of a hull's boundary that is nearest to a point. */
typedef struct {
  int n;                  /* 0: there is no hull; 1: a vertex or a point of a curve; 2: a straight edge */
  mg_real margin;         /* distance, m, positive inside the hull */
  mg_real normal[2];      /* outward unit normal there */
  mg_support_point at[2]; /* the point, or both ends of the edge */
} mg_nearest_boundary;

/* Functions of which mg_zero_on_arc finds a zero, at a point c of a curve with tangent c'. */
enum {
  MG_ZERO_SUPPORT,  /* v.c': c is extreme in the direction v */
  MG_ZERO_NEAREST,  /* (c - v).c': c is the point nearest to v */
  MG_ZERO_CURVATURE /* curvature: c is an inflection */
};

/* A part of the boundary of the loaded region, traversed with the region on the left. */
typedef struct {
  int arc;                  /* its arc */
  int straight;             /* 1: a straight line */
  int ends[2];              /* 1: the pressure vanishes at this end, inside the overlap */
  mg_real t[2];             /* curve parameters of its ends */
  mg_real begin[2], end[2]; /* its ends, m */
} mg_boundary_strip;

/* Pressure between two faces. */
typedef struct {
  const mg_hull *hull;        /* overlap of the faces */
  int partly_unloaded;        /* 1: the pressure vanishes in a part of the overlap */
  int overflow;               /* 1: there was no room for all strips */
  long n, capacity;           /* strips, and room for strips */
  mg_boundary_strip *strips;  /* boundary of the loaded region */
  mg_real centre[2];          /* point to which coefficients and moments refer, m */
  mg_real coefficients[3];    /* p = coefficients[0] + (coefficients[1], coefficients[2]).(x - centre), Pa and Pa/m */
  mg_real zero_line_point[2]; /* point nearest to the centre on the line where the pressure vanishes; else the centre */
  mg_real moments[6];         /* integrals of 1, x, y, xx, xy, yy over the loaded region, about the centre */
  mg_real reach;              /* bound of the distance of the loaded region from the centre, m */
} mg_winkler_pressure_field;

/* Numbers of nodes of Gauss-Legendre quadrature. */
enum {
  MG_NODES = 10,   /* in general */
  MG_FEW_NODES = 4 /* for a nearly constant integrand */
};

/* Nodes and weights of Gauss-Legendre quadrature on 0..1. */
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

/* arc_points_and_zeros.c */

/* Point and tangent (of any length) of an arc at parameter t. */
MG_INTERNAL void mg_arc_point(const mg_placed_arc *k, mg_real t, mg_real *point, mg_real *tangent);

/* Value at t of the function of which a zero is sought. */
MG_INTERNAL mg_real mg_zero_function(const mg_placed_arc *k, int sought, const mg_real *v, mg_real t);

/* Zero of a function between a and b, or the end that is nearer to one; for MG_ZERO_NEAREST only a minimum of the
   distance. Safeguarded secant method (Anderson and Bjorck, BIT 13, 1973). */
MG_INTERNAL mg_real mg_zero_on_arc(const mg_placed_arc *k, int sought, const mg_real *v, mg_real a, mg_real b);

/* arc_placement_and_division.c */

/* Sets the span of an arc from parameter a to b. */
MG_INTERNAL void mg_make_span(const mg_hull *h, int arc, mg_real a, mg_real b, mg_arc_span *span);

/* Places all arcs in the axes of their own faces and divides them into spans. */
MG_INTERNAL void mg_divide_arcs(mg_hull *h);

/* Places the arcs of B for a pose of f's face in the axes of o's. */
MG_INTERNAL void mg_place_arcs(mg_hull *h, const mg_real *pose);

/* intersections.c */

/* Finds all intersections of the two boundaries. */
MG_INTERNAL void mg_find_intersections(mg_hull *h);

/* point_in_region.c */

/* Range of the arcs of the part of a region that an arc belongs to. */
MG_INTERNAL void mg_find_part_of_arc(const mg_hull *h, int arc, int *first, int *end);

/* Location of p with respect to the part of a region with these arcs: 0 outside, 1 inside, 2 on the boundary. */
MG_INTERNAL int mg_locate_in_part(const mg_hull *h, int first, int end, const mg_real *p);

/* Location of p with respect to the region of o (side 0) or f (1): 0 outside, 1 inside, 2 on the boundary. */
MG_INTERNAL int mg_locate_point(const mg_hull *h, int side, const mg_real *p);

/* overlay.c */

/* Memory of a hull, in mg_real. */
MG_INTERNAL long mg_hull_memory_size(int n_arc, int n_o);

/* Most strips of the boundary of the loaded region. */
MG_INTERNAL long mg_strip_capacity(int n_arc, int n_o);

/* Prepares a hull for two regions, in memory of mg_hull_memory_size. */
MG_INTERNAL void mg_set_regions(mg_hull *h, const mg_region_pair *regions, mg_real *memory);

/* Overlays the regions for a pose of f's face in the axes of o's and makes the hull. Returns the number of its
   edges: 0 where the overlap is empty, 1 for a point. */
MG_INTERNAL int mg_overlay_regions(mg_hull *h, const mg_real *pose);

/* convex_hull.c */

/* Makes the convex hull of the pieces. */
MG_INTERNAL void mg_make_hull(mg_hull *h);

/* hull_distance.c */

/* Describes a vertex as a point of the boundary, by an intersection if one of its twins is one. */
MG_INTERNAL void mg_read_support_point(const mg_hull *h, int vertex, mg_support_point *at);

/* Signed distance of x from the boundary of the hull, m, positive inside, and the nearest place; -MG_MAX if there
   is no hull. */
MG_INTERNAL mg_real mg_hull_margin(const mg_hull *h, const mg_real *x, mg_nearest_boundary *nearest);

/* boundary_polylines.c */

/* Outline of the overlap; `fine` points to a curved span. */
MG_INTERNAL void mg_outline_pieces(const mg_hull *h, int fine, mg_outline *out);

/* Outline of the hull; `fine` points to a curved span. */
MG_INTERNAL void mg_outline_hull(const mg_hull *h, int fine, mg_outline *out);

/* winkler_pressure.c */

/* Prepares a pressure field over a hull. */
MG_INTERNAL void mg_open_pressure(mg_winkler_pressure_field *p, const mg_hull *h, long capacity,
                                  mg_boundary_strip *strips);

/* Coefficients of the affine pressure that has the given moments 1, x, y about the centre on the present loaded
   region. Returns 0 if it has no area. */
MG_INTERNAL int mg_solve_moments(const mg_winkler_pressure_field *p, const mg_real *moment, mg_real *coefficients);

/* Sets a uniform pressure on the whole overlap, with moments about a point. */
MG_INTERNAL void mg_uniform_pressure(mg_winkler_pressure_field *p, const mg_real *about);

/* Where a point is by its distance from the boundary of a hull. */
enum {
  MG_INSIDE_HULL,       /* inside, far enough for a pressure to be found */
  MG_AT_STRAIGHT_EDGES, /* nearer to straight edges, or outside them */
  MG_AT_CURVE           /* nearer to a curved edge, or outside it */
};

/* Moves a point that is not inside the hull, or too near to its boundary for a pressure to be found, to the least
   distance inside. The place is continuous in the point. Returns where the point was. */
MG_INTERNAL int mg_move_inside_hull(const mg_hull *h, mg_real *x);

/* Moves a point that is farther outside the hull than the least distance to there. Returns whether it had to be moved.
 */
MG_INTERNAL int mg_move_near_hull(const mg_hull *h, mg_real *x);

/* Finds the pressure with a resultant force, N, and a centre inside the hull. Returns 0 if it fails. */
MG_INTERNAL int mg_winkler_pressure(mg_winkler_pressure_field *p, mg_real force, const mg_real *centre);

/* Takes the same pressure over another overlap in the same axes: its loaded part and moments about the same centre. */
MG_INTERNAL void mg_restrict_pressure(mg_winkler_pressure_field *p, const mg_hull *h);

/* friction_wrench.c */

/* Friction matrix G of a twist: force and torque about the centre of pressure are -G a for the coefficients a of
   the pressure and mu = 1. */
MG_INTERNAL void mg_friction_matrix(const mg_winkler_pressure_field *p, const mg_real *twist, mg_real G[3][3]);

/* limit_surface.c */

/* Least coefficient of friction for which friction holds the wrench (force, torque about the centre of pressure).
   `twist` receives the twist that limits it, of unit length with the angular velocity times the radius. */
MG_INTERNAL mg_real mg_limit_surface_ratio(const mg_winkler_pressure_field *p, const mg_real *wrench, mg_real radius,
                                           mg_real *twist);

#endif
