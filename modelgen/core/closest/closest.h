/* Closest points of two features or shapes: search from samples, Newton's method, separation of convex shapes, and
   singular contacts. May use: base, model. */
#ifndef MG_CLOSEST_H
#define MG_CLOSEST_H

#include "model/context.h"

#define MG_EFFORT 100000     /* most pairs of cells looked at in one search of a feature pair during a run, */
#define MG_LEAST_EFFORT 2000 /* and where searches of the pair have been given up before, at least */

/* What a search asks for, and where it is given up. */
typedef struct {
  mg_real gap, depth; /* -depth <= d <= gap, m */
  long effort;        /* most pairs of cells looked at for one feature pair */
  mg_real all_within; /* m: once a minimum is found, only gaps up to |d| of the nearest one, or up to this, count */
} mg_search_limits;

/* convex_closest_points.c */

/* Ascends from v->normal, and if that ends below `floor`, from other normals too. v then is the first maximum
   above floor; else the highest, or the first if `keep`. Returns 0 if rounding left it inexact. */
MG_INTERNAL int mg_maximise_separation(const mg_shape_pair *p, mg_real floor, int keep, mg_separation_view *v);

/* damped_newton.c */

/* Evaluates contact_place of a pair of shapes at eta; `placed` has the layout of c->search.placement. */
MG_INTERNAL void mg_place_pair(const mg_shape_pair *p, const mg_real *eta, mg_real *next, mg_real *placed);

/* Newton's method from eta until the residual is below the goal. Returns the number of steps, or -1; `placed`
   holds the placement at eta. */
MG_INTERNAL int mg_damped_newton(const mg_shape_pair *p, const mg_newton_goal *goal, mg_real *eta, mg_real *placed);

/* True if the distance is a minimum, and not only stationary: the margin is positive. */
MG_INTERNAL int mg_is_minimum(const mg_real *placed);

/* probe_contact.c */

/* Puts the probe contact, numbered n_contact, on a feature pair; returns its number. */
MG_INTERNAL int mg_use_probe_contact(mg_context *c, int feature_pair);

/* Finds closest points on a feature pair from any eta; of convex shapes without a start. Returns -1 if it fails.
   c->search.placement holds the placement. */
MG_INTERNAL int mg_converge_from_any_start(mg_context *c, int feature_pair, mg_real *eta);

/* feature_samples.c */

/* Dimension of a feature: 2 surface, 1 curve, 0 point. */
MG_INTERNAL int mg_feature_dimension(const mg_context *c, int feature_pair, int side);

/* Sample of a feature at uv at the present pose. */
MG_INTERNAL void mg_sample_at(mg_context *c, int feature_pair, int side, const mg_real *uv, mg_sample *at);

/* Bounds (u0, u1, v0, v1) within which a feature is sampled: its domain, cut at `reach` where it is unbounded. */
MG_INTERNAL void mg_sample_window(mg_context *c, int feature_pair, int side, mg_real reach, mg_real *window);

/* Samples a feature on a grid of n by n over the window (a curve at n^2 points, a point once). Returns the number
   of samples. */
MG_INTERNAL int mg_sample_feature(mg_context *c, int feature_pair, int side, const mg_real *window, int n,
                                  mg_sample *out);

/* Shrinks a window to a tenth about a centre. */
MG_INTERNAL void mg_shrink_window(mg_real *window, const mg_real *centre);

/* Distance from the origin of its shape, which may be far from its body, within which an unbounded feature is sampled,
   m: it contains all of the feature that is in the ball around its own body, or that is nearest to the ball around the
   other; where neither body is bounded, the origin of the other shape. */
MG_INTERNAL mg_real mg_search_radius(mg_context *c, int feature_pair, int side);

/* True if the nearest point of the feature to any point is known in closed form (plane, sphere, vertex). */
MG_INTERNAL int mg_has_nearest_point(const mg_context *c, int feature_pair, int side);

/* Eta for a sample of each feature. */
MG_INTERNAL void mg_start_eta(const mg_context *c, int feature_pair, const mg_sample *o, const mg_sample *f,
                              mg_real *eta);

/* Distance of a point in the axes of a body from a world point. */
MG_INTERNAL mg_real mg_distance_from(const mg_context *c, int body, const mg_real *x, const mg_real *from);

/* Rotation of a feature's shape in world axes, 9 numbers by columns. */
MG_INTERNAL void mg_shape_rotation(const mg_context *c, int feature_pair, int side, mg_real *R);

/* feature_views.c */

/* Forgets the views of features, which are of one pair at one set of poses. */
MG_INTERNAL void mg_begin_feature_views(mg_context *c, int pair);

/* True if a feature pair may hold isolated closest points with a gap from `least` to `most`, m: its features are within
   reach of each other, and the normal of planes, straight edges and vertices, which the poses give, breaks no
   condition. Needs mg_begin_feature_views. */
MG_INTERNAL int mg_may_hold_closest_points(mg_context *c, int feature_pair, mg_real least, mg_real most);

/* spine_features.c */

/* The line, circle or point at a constant distance from which a feature lies, in the axes of the shape: the third axis,
   about it, or the origin. */
typedef struct {
  int kind;       /* MG_SPINE_LINE .. */
  int coordinate; /* that of the feature which runs along the curve: 0 u, 1 v */
  mg_real radius; /* of the circle, m */
  mg_real tube;   /* distance of the feature, m; negative: a cavity, 0: the curve itself */
} mg_spine;

/* True if both features of a feature pair lie at constant distances from lines, circles or points. */
MG_INTERNAL int mg_lie_about_spines(const mg_context *c, int feature_pair);

/* True if the critical points of a feature pair follow from lines or circles, and points, in closed form. */
MG_INTERNAL int mg_has_spines(const mg_context *c, int feature_pair);

/* True if a feature is a surface that has a spine. */
MG_INTERNAL int mg_is_about_spine(const mg_context *c, int feature_pair, int side);

/* Reads the spine of a feature that has one. */
MG_INTERNAL void mg_read_spine(const mg_context *c, int feature_pair, int side, mg_spine *at);

/* Point of a spine nearest to x, axes of the shape. */
MG_INTERNAL void mg_foot_on_spine(const mg_spine *curve, const mg_real *x, mg_real *foot);

/* Of the critical points of the distance to x on a spine the one nearest to `near`, axes of the shape. */
MG_INTERNAL void mg_critical_point_on_spine(const mg_spine *curve, const mg_real *x, const mg_real *near,
                                            mg_real *point);

/* Sample of a feature that has a spine at a point of it in the axes of the shape; without the world point. */
MG_INTERNAL void mg_sample_about_spine(const mg_context *c, int feature_pair, int side, const mg_spine *curve,
                                       const mg_real *local, mg_sample *sample);

/* cells.c */

/* Forgets all cells. */
MG_INTERNAL void mg_forget_cells(mg_context *c);

/* Digest of all from which cells are made: the bounds of the shapes, their parameters, domains and scales. */
MG_INTERNAL mg_digest mg_digest_searched_shapes(const mg_system *s);

/* Forgets the cells in the scratch memory that were not made of the shapes of this system. */
MG_INTERNAL void mg_keep_cells_of_same_shapes(mg_context *c);

/* First cell of a feature, or of its spine: its domain, cut where it is unbounded so that it contains all that
   can be near the other feature. Returns 0 if there is no room. */
MG_INTERNAL int mg_root_cell(mg_context *c, int feature_pair, int side, int is_of_spine);

/* Bounds the bends of a cell, unless that is done. */
MG_INTERNAL void mg_bound_bends(mg_context *c, int feature_pair, int side, int number);

/* Number of the first of the two halves of a cell; 0 if there is no room. */
MG_INTERNAL int mg_divide_cell(mg_context *c, int feature_pair, int side, int cell);

/* Where the conditions of a feature pair allow contacts on one side: coordinates u, v in a box and in a disc about 0,
   and points within the quadrics; and where its critical points are. */
typedef struct {
  mg_real box[4];
  mg_real disc;
  mg_real meridian[3]; /* unit normal of the plane through the third axis in which they are; 0: it is not known */
  mg_real off_plane;   /* by how much of their distance from the origin they may be off it to rounding */
  int feature_pair, side;
} mg_feature_limits;

/* Limits of one side of a feature pair. */
MG_INTERNAL void mg_limit_feature(const mg_context *c, int feature_pair, int side, mg_feature_limits *limits);

/* Adds the plane through the axis of a surface of revolution and the centre of a ball: their closest points are in it,
   because all normals of the surface meet its axis. */
MG_INTERNAL void mg_limit_to_meridian(const mg_context *c, int feature_pair, mg_feature_limits *limits);

/* True if all of a cell lies beyond the limits. */
MG_INTERNAL int mg_is_cell_beyond(const mg_context *c, int cell, const mg_feature_limits *limits);

/* spine_search.c */

/* The spine of a feature, with its place. */
typedef struct {
  mg_spine curve;
  mg_real centre[3]; /* of the circle, or a point of the line, m */
  mg_real axes[9];   /* of the shape, by columns: the line is along the third, the circle in the plane of the others */
} mg_centred_feature;

/* True if the gap of a feature pair is known to have one minimum at most with a value up to `gap`. */
MG_INTERNAL int mg_has_one_minimum(const mg_context *c, int feature_pair, mg_real gap);

/* Adds the minima of such a feature pair with gaps within the limits and not below `least` to those kept. */
MG_INTERNAL void mg_search_spines(mg_context *c, int feature_pair, const mg_search_limits *limits, mg_real least,
                                  mg_minima *kept);

/* spine_stationary_points.c */

enum { MG_STATIONARY = 64 }; /* most places of two spines */

/* A place on both spines at which their distance is stationary. */
typedef struct {
  mg_real where[2];   /* angle of a circle, rad; distance along a line, m; of a point nothing */
  mg_real regularity; /* of two circles the determinant of the second derivatives of the squared distance, as a part of
                         their size: 0 where it is constant along a curve; else 1 */
} mg_stationary_place;

/* p cos(s) + q sin(s) + m */
typedef struct {
  mg_real p, q, m;
} mg_sinusoid;

/* Points of the first circle, by its angle: in the axes of the second, and how far towards the centre of the second,
   times the distance of that. */
typedef struct {
  mg_sinusoid x, y, z, towards;
} mg_first_circle;

/* Reads the first of two circles. */
MG_INTERNAL mg_first_circle mg_view_first_circle(const mg_centred_feature *of);

/* Point of a spine: at an angle of the circle, at a distance along the line. */
MG_INTERNAL void mg_centre_point(const mg_centred_feature *at, mg_real where, mg_real *x);

/* Unit vector normal to both spines at places on them. Returns 0 where their tangents are the same. */
MG_INTERNAL int mg_normal_to_both(const mg_centred_feature *of, const mg_real *where, mg_real *normal);

/* Stationary places of two spines; of two circles those with gaps up to `gap` at which it can be a minimum.
   Returns their number. It is 0 of a line or point and a curve whose distance is constant. `place` has room for
   MG_STATIONARY.
 */
MG_INTERNAL int mg_stationary_places(const mg_centred_feature *of, mg_real gap, mg_stationary_place *place);

/* Distance of a line or point from another spine where it is constant, m. */
MG_INTERNAL mg_real mg_constant_distance(const mg_centred_feature *of);

/* circle_pair_single_minimum.c */

/* True if the gap of two circles, or of features outside of them at constant distances, is known to have one minimum at
   most with a value up to `gap`. */
MG_INTERNAL int mg_have_circles_one_minimum(const mg_centred_feature *of, mg_real gap);

/* segment_crossings.c */

/* The side of its pair that the shape of one side of a feature pair is on. */
MG_INTERNAL int mg_side_of_pair(const mg_context *c, int feature_pair, int side);

/* True if the point of the other side of a feature pair is in the body of one side, and not only on it: a segment from
   a surface to it does not leave the body, or ways to both sides from it do. Needs the placement of this feature pair
   evaluated last. */
MG_INTERNAL int mg_is_point_in_body(mg_context *c, int feature_pair, int side);

/* True if a point is in the body of one side of a feature pair, and not only on it, by what ways to both sides from it
   meet first, farther off than what touches. */
MG_INTERNAL int mg_is_in_body(mg_context *c, int feature_pair, int side, const mg_real *point);

/* The part of the segment between two points at which it leaves the body of one side of a feature pair, or 1; MG_MAX
   if the body has no surfaces. It leaves none within `least` of its start, m. */
MG_INTERNAL mg_real mg_part_in_surfaces(mg_context *c, int feature_pair, int side, const mg_real *start,
                                        const mg_real *end, mg_real least);

/* True if a body of a pair has surfaces; joint limits and curves have none. */
MG_INTERNAL int mg_has_surfaces(const mg_context *c, int pair);

/* True if points of all vertices, edges and surfaces without borders of the body of one side of a pair are in that of
   the other, by what ways to both sides from them meet first. */
MG_INTERNAL int mg_is_body_within(mg_context *c, int pair, int side);

/* overlap.c */

/* True if the points of the placement of a feature pair, whose distance is negative, are on sides of the bodies that
   face away from each other: no penetration. Needs that placement evaluated last. */
MG_INTERNAL int mg_is_between_far_sides(mg_context *c, int feature_pair);

/* True if it is known of both shapes of a pair where their material is. */
MG_INTERNAL int mg_are_materials_known(const mg_context *c, int pair);

/* True if a point in both shapes of a pair is found, deeper than where touching bodies overlap as far as they may. */
MG_INTERNAL int mg_is_overlap_seen(mg_context *c, int pair);

/* exclusion_and_uniqueness.c */

/* What a pair of cells may hold. */
enum {
  MG_CELLS_APART = 0,   /* no minimum of the distance within the limits */
  MG_CELLS_REGULAR = 1, /* one at most, and about where */
  MG_CELLS_SINGLE = 3,  /* one at most */
  MG_CELLS_OPEN = 2     /* not known */
};

/* What a view shows. */
enum { MG_VIEW_SURFACE, MG_VIEW_CURVE, MG_VIEW_PLANE, MG_VIEW_POINT };

/* A cell, a plane, a vertex, a sphere as its centre, or a torus or cylinder as a cell of its spine, in the axes
   of one of the two shapes. */
typedef struct {
  int kind;                /* MG_VIEW_SURFACE .. */
  const mg_cell *cell;     /* the cell; 0: a plane or a point */
  const mg_real *rotation; /* from the axes of the cell, 9 numbers by columns; 0: they are the same */
  mg_real centre[3];       /* m */
  mg_real radius;          /* m */
  mg_real direction[3];    /* normal or tangent */
  mg_real spread;          /* bound of |n - direction| */
  mg_real slope[2][3];     /* as in mg_cell, m */
  mg_real rest;            /* as in mg_cell, m */
  mg_real tube;            /* distance of the surface from the point or curve shown, m; negative: a cavity */
} mg_cell_view;

/* Bound of |w . (x - centre)| over the points x of a view. */
MG_INTERNAL mg_real mg_extent_along(const mg_cell_view *view, const mg_real *w);

/* True if the points and directions of two cells rule out critical pairs of points within the limits. A plane or a
   point is b. */
MG_INTERNAL int mg_are_cells_apart(const mg_cell_view *a, const mg_cell_view *b, const mg_search_limits *limits);

/* Whether two cells can hold critical pairs of points: MG_CELLS_APART .., from the bends of both. */
MG_INTERNAL int mg_judge_cells(const mg_cell_view *a, const mg_cell_view *b, const mg_search_limits *limits);

/* critical_point_search.c */

/* Adds the minima of a feature pair with gaps within the limits and not below `least` to those kept. Returns 0 if
   there may be more; where these are farther than a positive gap, notes it and returns 1. */
MG_INTERNAL int mg_search_critical_points(mg_context *c, int feature_pair, const mg_search_limits *limits,
                                          mg_real least, mg_minima *kept);

/* Lower bound of the distance of all points of two features, critical or not, m: no less than about half of it where
   that is more than `small`. */
MG_INTERNAL mg_real mg_bound_distance(mg_context *c, int feature_pair, mg_real small);

/* True if no points of the features touch, but at `found`, the minima of a complete search without penetration. Returns
   0 too where that is not shown. */
MG_INTERNAL int mg_are_features_apart(mg_context *c, int feature_pair, const mg_minima *found);

/* minima_acceptance.c */

/* True if the gap of two curves is never negative: no body is beside them, and no normal is given. */
MG_INTERNAL int mg_has_no_sides(const mg_context *c, int feature_pair);

/* Reverses N of two curves, by the signs in eta. */
MG_INTERNAL void mg_reverse_normal(const mg_context *c, int feature_pair, mg_real *eta);

/* Copies distance, point and normal of the placement of the minimum's feature pair. Needs that evaluated last. Point
   and normal refer to the body with the smaller number, so that they do not depend on the order of the bodies in the
   feature pair. */
MG_INTERNAL void mg_record_minimum(const mg_context *c, mg_minimum *found);

/* Gives a minimum of one pair of shapes the point and the normal that it has for another pair, the one of a feature
   pair, which has a body in common with it. */
MG_INTERNAL void mg_see_from_shared_body(const mg_context *c, int feature_pair, mg_minimum *found);

/* True if two minima have the same point and normal, on whatever feature pairs (charts overlap). Two curves
   without an outside have one contact at two points, whatever the direction of N. */
MG_INTERNAL int mg_is_same_minimum(const mg_context *c, const mg_minimum *a, const mg_minimum *b);

/* Describes the minimum at eta, which solves the extremality equations. Returns 0 if it is singular or violates a
   condition of the feature pair. */
MG_INTERNAL int mg_accept_minimum(mg_context *c, int feature_pair, mg_real *eta, mg_minimum *found);

/* Counts a minimum that no contact can follow, if it is within search_gap, in the report of the run. */
MG_INTERNAL void mg_report_unfollowed_minimum(const mg_context *c, const mg_minimum *found);

/* Notes that a contact, or closest points of its pair, on a feature pair penetrate by `depth` at the state of the run,
   and the outcome of a run that ends by that.
   A rim that stands on three of its points because it is almost flat is lower elsewhere, which is no penetration. */
MG_INTERNAL void mg_note_penetration(mg_context *c, int contact, int feature_pair, mg_real depth, int outcome);

/* Inserts a minimum in order of |d|, unless it is known. Beyond MG_MINIMA the farthest is dropped and reported. */
MG_INTERNAL void mg_insert_minimum(const mg_context *c, mg_minima *kept, const mg_minimum *found);

/* Forgets the gaps noted in the search before. */
MG_INTERNAL void mg_forget_noted_gaps(mg_context *c);

/* Notes a gap in m above which the features may be at many places at once, none of which is a minimum by itself. */
MG_INTERNAL void mg_note_open_gap(mg_context *c, mg_real gap);

/* Notes a gap of closest points that are not isolated; as one that no contact can follow, if the feature pair ends at
   no border, beyond which edges and faces are followed. */
MG_INTERNAL void mg_note_singular_gap(mg_context *c, int feature_pair, mg_real gap);

/* Notes the gap of the critical point at eta, if to rounding it is one of a curve or a surface of them and not beyond
   the borders of its feature pair by more than a pair moves between searches. Needs the placement there evaluated last.
 */
MG_INTERNAL void mg_note_singular_point(mg_context *c, int feature_pair, const mg_real *eta);

/* Adds the critical point at eta to the minima kept, if it is one and not below `least`. */
MG_INTERNAL void mg_keep_minimum_at(mg_context *c, int feature_pair, mg_real *eta, mg_real least, mg_minima *kept);

/* minima_search.c */

/* Reports an incomplete search of a pair that always has closest points, of which none were found. */
MG_INTERNAL void mg_report_lost_points(mg_context *c, int pair);

/* Lower bound of the distance of two convex solids: the largest over their flat faces of the least gap to the
   features of the other; -MG_MAX if no faces are known. An extremum below it is not a minimum of the distance. */
MG_INTERNAL mg_real mg_separating_plane_gap(mg_context *c, int pair);

/* Notes that no contact follows a minimum of a pair with the gap d. */
MG_INTERNAL void mg_note_unfollowed_gap(mg_context *c, int pair, mg_real d);

/* Lower bound of the gap at closest points of a pair of which a search has found none, m; MG_MAX if it found some. Two
   vertices, or a point and a vertex, have no feature pair: planes part the bodies by mg_separating_plane_gap at least,
   which is `least` and start_gap. Nor have open ends of curves and open edges of charts, which may be the nearest where
   no contact is within reach. */
MG_INTERNAL mg_real mg_bound_gap_not_found(mg_context *c, int pair, mg_real least, const mg_minima *found);

/* Least movement of a pair between searches that are not due at every step, m. */
MG_INTERNAL mg_real mg_least_movement(const mg_context *c, int pair);

/* If a search of the pair has been given up since there were `before` of them, notes that closest points that it missed
   may be as near as twice the least movement. */
MG_INTERNAL void mg_note_missed_gap(mg_context *c, int pair, long before);

/* Gaps at which a contact of a pair may appear during a run. */
MG_INTERNAL mg_search_limits mg_appearance_limits(const mg_context *c, int pair);

/* Adds the minima of a feature pair with gaps within the limits and not below `least` to those kept. Returns 0 if the
   search had to be given up. */
MG_INTERNAL int mg_find_minima_of_feature_pair(mg_context *c, int feature_pair, const mg_search_limits *limits,
                                               mg_real least, mg_minima *kept);

/* The same for a run, which is uncertified if the search is given up; the effort of it is withheld from the next ones.
 */
MG_INTERNAL void mg_search_feature_pair(mg_context *c, int feature_pair, const mg_search_limits *limits, mg_real least,
                                        mg_minima *kept);

/* Adds the minima of some feature pairs of one pair of bodies, not below `least`, to those found: all within
   search_gap, and the nearest one. The gaps that count grow until one is found. `effort` as in mg_search_limits.
   Returns how many searches within search_gap were given up. */
MG_INTERNAL long mg_search_nearest(mg_context *c, int first, int end, mg_real least, long effort, mg_minima *found);

/* Puts the contacts of a pair on its closest points, wherever they are. Returns how many were found. Needs the poses.
 */
MG_INTERNAL int mg_follow_closest_points(mg_context *c, int pair);

/* Finds the minima of all pairs at the start and assigns the contacts to them; puts limits on their feature pairs.
   Returns an outcome. */
MG_INTERNAL int mg_search_start_pairs(mg_context *c);

/* closest_batch.c */

/* Closest points of two convex shapes: the maximum of the separation function, then Newton's method where this
   maximum is not sharp. warm: eta is near the solution. Returns MG_CLOSEST_NOT_FOUND .. ; eta and `placed` receive
   the result. */
MG_INTERNAL int mg_closest_convex(const mg_shape_pair *p, const mg_newton_goal *goal, int is_warm_start, mg_real *eta,
                                  mg_real *placed);

/* singularities.c */

/* Extrapolate the state by a short time with the slope at the run's state and set the poses there; returns their time.
 */
MG_INTERNAL mg_real mg_extrapolate_poses(mg_context *c);

/* What becomes of a minimum a short time later: it stays, the conditions of its feature pair are broken, or Newton's
   method does not find it. */
enum { MG_MINIMUM_STAYS = 0, MG_MINIMUM_LEAVES = 1, MG_MINIMUM_LOST = 2 };

/* The fate of a minimum: MG_MINIMUM_STAYS .. . */
MG_INTERNAL int mg_fate_of_minimum(mg_context *c, const mg_minimum *found);

/* True if the feature pair is a crossing of two edges of solids that are not both straight. */
MG_INTERNAL int mg_is_curved_edge_crossing(const mg_context *c, int feature_pair);

/* True if a contact with the gap d is followed as near to a singularity as it can be: between features about centre
   curves or points, where the margin is small for as long as they are almost coaxial or concentric. */
MG_INTERNAL int mg_is_followed_to_singularity(const mg_context *c, int feature_pair, mg_real d);

/* Least margin with which a contact with the gap d is followed. */
MG_INTERNAL mg_real mg_followed_margin_limit(const mg_context *c, int feature_pair, mg_real d);

/* Margin at which a contact ends at a fold: less where it is small for long, as at crossing edges and where features
   are almost coaxial. */
MG_INTERNAL mg_real mg_fold_margin_limit(const mg_context *c, int contact);

/* True if a closed contact is too near to where its extremum is lost, unless it starts from there. */
MG_INTERNAL int mg_is_contact_singular(const mg_context *c, int contact);

#endif
