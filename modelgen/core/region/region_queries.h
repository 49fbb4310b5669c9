/* Queries of two planar regions without a run: their overlap, its convex hull, and friction between them. Terms and
   sources are those of region/region.h. The caller owns all arrays; `work` is scratch. */
#ifndef MG_PLANAR_QUERIES_H
#define MG_PLANAR_QUERIES_H

/* A list of points, loop after loop. */
typedef struct {
  int capacity;   /* points for which the arrays have room */
  int count;      /* points found, also beyond capacity */
  int n_loop;     /* loops found */
  mg_real *point; /* [2 capacity] points, m */
  int *loop;      /* [capacity] loop of each point */
} mg_outline;

/* Two planar regions in one plane, A on the face of o and B on the face of f, and points to be located. */
typedef struct {
  const mg_kernels *kernels; /* kernels of the generated library */
  int n_arc;                 /* arcs of both regions */
  int n_o;                   /* the first n_o arcs bound A, the others B; 0: A is the whole plane */
  int points_per_turn;       /* points of an outline on a part of a curve that turns by less than 0.3 rad */
  int n_point;               /* points to be located */
  const int *shape;          /* [n_arc] shape kind of the curve */
  const int *loop;           /* [n_arc] number of its loop */
  const int *first;          /* [n_arc] offset into parameters of the curve */
  const mg_real *parameters; /* parameters of the curves */
  const mg_real *numbers;    /* [14 n_arc] placement of the curve in the axes of its face (12), first and last curve
                                parameter */
  const mg_real *pose;       /* [12] pose of f's face in the axes of o's face */
  mg_real coincidence;       /* points of the two boundaries nearer than this coincide, m */
  const mg_real *points;     /* [2 n_point] points to be located, axes of o's face, m */
  mg_real *margin; /* [n_point] result: distance from the boundary of the hull of A cap B, m, positive inside */
  mg_real *normal; /* [2 n_point] result: outward unit normal of the hull at its nearest point */
  int *supports;   /* [n_point] result: 1 the nearest place is a point, 2 a straight edge, 0 there is no hull */
  int *identity;   /* [6 n_point] result, for each of two supports: region (0 A, 1 B), arc, arc of the other
                      region through it or -1 */
  mg_real *support_position;  /* [8 n_point] result, for each of two supports: curve parameters on both arcs, point */
  mg_outline *outline, *hull; /* result: outline of A cap B and of its hull */
} mg_region_query;

/* Friction between the regions of a query, for n loads, twists and wrenches. */
typedef struct {
  const mg_region_query *regions; /* the regions */
  int n;                          /* cases */
  const mg_real *load;            /* [3 n] resultant normal force, N, and its centre, axes of o's face, m */
  const mg_real *twist;           /* [3 n] motion of f relative to o: velocity of the centre, m/s, and angular velocity
                                     about the outward normal of o, rad/s */
  const mg_real *wrench;          /* [3 n] force through the centre, N, and torque, N m, that friction is to hold */
  int *found;                     /* [n] result: 1 if the centre is inside the hull and the pressure was found */
  mg_real *pressure;              /* [3 n] result: pressure at the centre, Pa, and its gradient, Pa/m; 0 where this is
                                     negative */
  mg_real *friction;              /* [3 n] result: friction force, N, and torque about the centre, N m, on f for a
                                     coefficient of 1 */
  mg_real *friction_needed;       /* [n] result: least coefficient of friction that holds the wrench */
  mg_real *limiting_twist;        /* [3 n] result: twist for which the power of the wrench over that of friction is
                                     largest; unit length with the angular velocity times the reach of the pressure */
} mg_patch_friction_query;

/* Length of `work` for mg_region, in mg_real. */
MG_API long mg_region_size(int n_arc, int n_o);

/* Finds the overlap of two regions and its hull, and locates the points. Returns the number of edges of the hull: 0
   where the overlap is empty, 1 for a point; -1 if there was no room for all intersections. */
MG_API int mg_region(const mg_region_query *query, mg_real *work);

/* Length of `work` for mg_region_friction, in mg_real. */
MG_API long mg_region_friction_size(int n_arc, int n_o);

/* Finds pressure and friction of each case; NAN where there are none. Of the query of the regions only the input fields
   are used. Returns what mg_region returns. */
MG_API int mg_region_friction(const mg_patch_friction_query *query, mg_real *work);

#endif
