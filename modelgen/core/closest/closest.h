/* Closest points of two features: search from samples, Newton's method, certificates. May use: base, model. */
#ifndef MG_CLOSEST_H
#define MG_CLOSEST_H

#include "model/context.h"

/* convex_separation.c */
MG_INTERNAL int mg_seek(const mg_shape_pair *p, mg_real floor, int keep, mg_separation_view *v);

/* damped_newton.c */
MG_INTERNAL void mg_put(const mg_shape_pair *p, const mg_real *eta, mg_real *next, mg_real *placed);
MG_INTERNAL int mg_is_small(const mg_shape_pair *p, const mg_newton_goal *goal, const mg_real *placed);
MG_INTERNAL int mg_newton_safely(const mg_shape_pair *p, const mg_newton_goal *goal, mg_real *eta, mg_real *placed);
MG_INTERNAL int mg_is_minimum(const mg_real *placed);
MG_INTERNAL int mg_settle_safely(mg_context *c, int link, mg_real *eta);

/* sampling.c */
MG_INTERNAL int mg_dimension(const mg_context *c, int link, int side);
MG_INTERNAL void mg_sample_at(mg_context *c, int link, int side, const mg_real *uv, mg_sample *at);
MG_INTERNAL void mg_window(mg_context *c, int link, int side, mg_real reach, mg_real *window);
MG_INTERNAL int mg_sample_side(mg_context *c, int link, int side, const mg_real *window, int n, mg_sample *out);
MG_INTERNAL void mg_zoom(mg_real *window, const mg_real *centre);
MG_INTERNAL mg_real mg_reach_of(mg_context *c, int link);

/* start_selection.c */
MG_INTERNAL void mg_start_eta(const mg_context *c, int link, const mg_sample *o, const mg_sample *f, mg_real *eta);
MG_INTERNAL void mg_find_starts(mg_context *c, int link, int n, int zooms, mg_newton_starts *kept);

/* minima_search.c */
MG_INTERNAL int mg_probe(mg_context *c, int link);
MG_INTERNAL void mg_turn_round(const mg_context *c, int link, mg_real *eta);
MG_INTERNAL void mg_note_place(const mg_context *c, mg_minimum *found);
MG_INTERNAL int mg_same_contact(const mg_context *c, const mg_minimum *a, const mg_minimum *b);
MG_INTERNAL int mg_judge(mg_context *c, int link, mg_real *eta, mg_minimum *found);
MG_INTERNAL void mg_keep(const mg_context *c, mg_minima *kept, const mg_minimum *found);
MG_INTERNAL mg_real mg_parting(mg_context *c, int pair);
MG_INTERNAL void mg_search_link(mg_context *c, int link, int n, int zooms, mg_real least, mg_minima *kept);
MG_INTERNAL int mg_start_pairs(mg_context *c);

/* closest_batch.c */
MG_INTERNAL int mg_closest_convex(const mg_shape_pair *p, const mg_newton_goal *goal, int warm, mg_real *eta, mg_real *placed);

/* singularities.c */
MG_INTERNAL void mg_look_ahead(mg_context *c);
MG_INTERNAL int mg_goes_off(mg_context *c, const mg_minimum *found);
MG_INTERNAL int mg_crosses(const mg_context *c, int link);
MG_INTERNAL mg_real mg_fold_of(const mg_context *c, int contact);
MG_INTERNAL int mg_is_singular(const mg_context *c, int contact);

#endif
