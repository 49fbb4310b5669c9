/* Closest points of two features: search from samples, Newton's method, certificates. May use: base, model. */
#ifndef MG_CLOSEST_H
#define MG_CLOSEST_H

#include "model/context.h"

/* convex_separation.c */
MG_INTERNAL int mg_maximise_separation(const mg_shape_pair *p, mg_real floor, int keep, mg_separation_view *v);

/* damped_newton.c */
MG_INTERNAL void mg_place_pair(const mg_shape_pair *p, const mg_real *eta, mg_real *next, mg_real *placed);
MG_INTERNAL int mg_is_residual_small(const mg_shape_pair *p, const mg_newton_goal *goal, const mg_real *placed);
MG_INTERNAL int mg_damped_newton(const mg_shape_pair *p, const mg_newton_goal *goal, mg_real *eta, mg_real *placed);
MG_INTERNAL int mg_is_minimum(const mg_real *placed);
MG_INTERNAL int mg_converge_from_any_start(mg_context *c, int feature_pair, mg_real *eta);

/* sampling.c */
MG_INTERNAL int mg_feature_dimension(const mg_context *c, int feature_pair, int side);
MG_INTERNAL void mg_sample_at(mg_context *c, int feature_pair, int side, const mg_real *uv, mg_sample *at);
MG_INTERNAL void mg_sample_window(mg_context *c, int feature_pair, int side, mg_real reach, mg_real *window);
MG_INTERNAL int mg_sample_feature(mg_context *c, int feature_pair, int side, const mg_real *window, int n,
                                  mg_sample *out);
MG_INTERNAL void mg_shrink_window(mg_real *window, const mg_real *centre);
MG_INTERNAL mg_real mg_search_radius(mg_context *c, int feature_pair);

/* start_selection.c */
MG_INTERNAL void mg_start_eta(const mg_context *c, int feature_pair, const mg_sample *o, const mg_sample *f,
                              mg_real *eta);
MG_INTERNAL void mg_find_newton_starts(mg_context *c, int feature_pair, int n, int zooms, mg_newton_starts *kept);

/* minima_search.c */
MG_INTERNAL int mg_use_spare_contact(mg_context *c, int feature_pair);
MG_INTERNAL void mg_reverse_normal(const mg_context *c, int feature_pair, mg_real *eta);
MG_INTERNAL void mg_record_minimum(const mg_context *c, mg_minimum *found);
MG_INTERNAL int mg_is_same_minimum(const mg_context *c, const mg_minimum *a, const mg_minimum *b);
MG_INTERNAL int mg_accept_minimum(mg_context *c, int feature_pair, mg_real *eta, mg_minimum *found);
MG_INTERNAL void mg_insert_minimum(const mg_context *c, mg_minima *kept, const mg_minimum *found);
MG_INTERNAL mg_real mg_separating_plane_gap(mg_context *c, int pair);
MG_INTERNAL void mg_search_feature_pair(mg_context *c, int feature_pair, int n, int zooms, mg_real least,
                                        mg_minima *kept);
MG_INTERNAL int mg_search_start_pairs(mg_context *c);

/* closest_batch.c */
MG_INTERNAL int mg_closest_convex(const mg_shape_pair *p, const mg_newton_goal *goal, int is_warm_start, mg_real *eta,
                                  mg_real *placed);

/* singularities.c */
MG_INTERNAL void mg_extrapolate_poses(mg_context *c);
MG_INTERNAL int mg_is_minimum_leaving_feature_pair(mg_context *c, const mg_minimum *found);
MG_INTERNAL int mg_is_curved_edge_crossing(const mg_context *c, int feature_pair);
MG_INTERNAL mg_real mg_fold_margin_limit(const mg_context *c, int contact);
MG_INTERNAL int mg_is_contact_singular(const mg_context *c, int contact);

#endif
