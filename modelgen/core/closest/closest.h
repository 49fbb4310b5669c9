/* Closest points of two features: search from samples, Newton's method, certificates. May use: base, model. */
#ifndef MG_CLOSEST_H
#define MG_CLOSEST_H

#include "model/context.h"

/* convex_separation.c */

/* Climbs from v->normal, and where that ends below `floor`, from other sides too. v then is the first maximum
   above it; else the highest one, or the first if `keep`. Returns 0 where rounding left it blunt. */
MG_INTERNAL int mg_maximise_separation(const mg_shape_pair *p, mg_real floor, int keep, mg_separation_view *v);

/* damped_newton.c */
MG_INTERNAL void mg_place_pair(const mg_shape_pair *p, const mg_real *eta, mg_real *next, mg_real *placed);

/* The residual is as small as is asked for, or as rounding of the positions lets it be. */
MG_INTERNAL int mg_is_residual_small(const mg_shape_pair *p, const mg_newton_goal *goal, const mg_real *placed);

/* From eta until the residual is small. Returns the number of steps, or -1; `placed` holds what the place kernel
   gives at eta, in the order of place.c. */
MG_INTERNAL int mg_damped_newton(const mg_shape_pair *p, const mg_newton_goal *goal, mg_real *eta, mg_real *placed);

/* The distance is least there, not only stationary: the sign of the margin. */
MG_INTERNAL int mg_is_minimum(const mg_real *placed);

/* As mg_newton_on_feature_pair, from anywhere; convex shapes from nothing. c->search.placement says whether it is a
 * minimum. */
MG_INTERNAL int mg_converge_from_any_start(mg_context *c, int feature_pair, mg_real *eta);

/* sampling.c */
MG_INTERNAL int mg_feature_dimension(const mg_context *c, int feature_pair, int side);
MG_INTERNAL void mg_sample_at(mg_context *c, int feature_pair, int side, const mg_real *uv, mg_sample *at);

/* The bounds (u0, u1, v0, v1) to sample a side within; where it has none, cut at `reach`. */
MG_INTERNAL void mg_sample_window(mg_context *c, int feature_pair, int side, mg_real reach, mg_real *window);

/* A grid of n by n samples over the window, as many along a curve, one of a point. */
MG_INTERNAL int mg_sample_feature(mg_context *c, int feature_pair, int side, const mg_real *window, int n,
                                  mg_sample *out);
MG_INTERNAL void mg_shrink_window(mg_real *window, const mg_real *centre);
MG_INTERNAL mg_real mg_search_radius(mg_context *c, int feature_pair);

/* start_selection.c */
MG_INTERNAL void mg_start_eta(const mg_context *c, int feature_pair, const mg_sample *o, const mg_sample *f,
                              mg_real *eta);

/* Likely starts on a feature pair from n by n samples a side, `zooms` times again around the best. */
MG_INTERNAL void mg_find_newton_starts(mg_context *c, int feature_pair, int n, int zooms, mg_newton_starts *kept);

/* minima_search.c */

/* Puts the spare contact, behind the last one, on a feature pair. */
MG_INTERNAL int mg_use_spare_contact(mg_context *c, int feature_pair);

/* Turns the normal of two curves round. */
MG_INTERNAL void mg_reverse_normal(const mg_context *c, int feature_pair, mg_real *eta);

/* The normal and the point of the first body as placed last, on the side of a body that does not depend on which of
   the two the feature pair takes first. */
MG_INTERNAL void mg_record_minimum(const mg_context *c, mg_minimum *found);

/* The same point and the same normal: one contact, be it on two feature pairs where charts overlap. Two curves without
   an outside have one contact at a point, whichever way its normal is turned. */
MG_INTERNAL int mg_is_same_minimum(const mg_context *c, const mg_minimum *a, const mg_minimum *b);

/* Fills in what was found at eta, which is on the extremum; returns 0 where it is none of the feature pair's own. */
MG_INTERNAL int mg_accept_minimum(mg_context *c, int feature_pair, mg_real *eta, mg_minimum *found);

/* Keeps the found in order of |d|, each once. */
MG_INTERNAL void mg_insert_minimum(const mg_context *c, mg_minima *kept, const mg_minimum *found);

/* Two convex solids are apart by no less than any plane of theirs parts them: the largest over their flat faces of
   the least gap to the other; -MG_MAX where no face is known. An extremum below it is none. */
MG_INTERNAL mg_real mg_separating_plane_gap(mg_context *c, int pair);

/* Adds to what is kept the extrema of a feature pair that are above `least`. */
MG_INTERNAL void mg_search_feature_pair(mg_context *c, int feature_pair, int n, int zooms, mg_real least,
                                        mg_minima *kept);
MG_INTERNAL int mg_search_start_pairs(mg_context *c);

/* closest_batch.c */

/* Convex shapes: the separation function; the extremality system after it where the maximum is not sharp. */
MG_INTERNAL int mg_closest_convex(const mg_shape_pair *p, const mg_newton_goal *goal, int is_warm_start, mg_real *eta,
                                  mg_real *placed);

/* singularities.c */

/* Extrapolate the state by a short time with the slope at the run's state and set the poses there. */
MG_INTERNAL void mg_extrapolate_poses(mg_context *c);

/* True if the conditions of the minimum's feature pair will be broken a short time later. */
MG_INTERNAL int mg_is_minimum_leaving_feature_pair(mg_context *c, const mg_minimum *found);

/* True if the feature pair is a crossing of two edges of solids that are not both straight. */
MG_INTERNAL int mg_is_curved_edge_crossing(const mg_context *c, int feature_pair);

/* Margin at which a contact ends at a fold. */
MG_INTERNAL mg_real mg_fold_margin_limit(const mg_context *c, int contact);

/* True if a closed contact is too near to where its extremum is lost, unless it starts from there. */
MG_INTERNAL int mg_is_contact_singular(const mg_context *c, int contact);

#endif
