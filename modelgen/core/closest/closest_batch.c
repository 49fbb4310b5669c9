/* Closest points of one pair of shapes at given poses: of convex shapes by the separation function, of others by
   Newton's method. Public queries of many pairs of poses (mg_closest). */
#include "closest/closest.h"
#include "model/model.h"
#include "base/base.h"

/* Normal to start from: that which continues eta, else the direction between the bodies. Returns 1 in the first
   case. */
static int mg_start_normal(const mg_shape_pair *p, const mg_real *eta, int is_warm_start, mg_real *normal,
                           mg_real *rounding) {
  p->kernels->contact_aim(p->kind, p->pose_o, p->pose_f, eta, p->parameters, normal, rounding);
  if (is_warm_start && mg_normalise3(normal)) return 1;
  for (int k = 0; k < 3; k++) normal[k] = p->pose_f[k] - p->pose_o[k];
  if (!mg_normalise3(normal)) normal[0] = normal[1] = 0, normal[2] = 1;
  return 0;
}

MG_INTERNAL int mg_closest_convex(const mg_shape_pair *p, const mg_newton_goal *goal, int is_warm_start, mg_real *eta,
                                  mg_real *placed) {
  mg_real rounding, next[MG_MAX_ETA];
  mg_separation_view v;
  const int known = mg_start_normal(p, eta, is_warm_start, v.normal, &rounding);
  const int found = mg_maximise_separation(p, -rounding - goal->tolerance * goal->length, known, &v);
  for (int k = 0; k < 6; k++) eta[k] = v.eta[k];
  mg_place_pair(p, eta, next, placed);
  if (found && mg_is_residual_small(p->pose_o, p->pose_f, goal->tolerance, goal->length, placed)) {
    placed[0] = v.d;
    for (int k = 0; k < 3; k++) placed[5 + k] = v.normal[k];
    return v.d > -rounding ? MG_CLOSEST_GLOBAL : MG_CLOSEST_LOCAL;
  }
  if (mg_damped_newton(p, goal, eta, placed) < 0) return MG_CLOSEST_NOT_FOUND;
  if (placed[0] > -rounding) return MG_CLOSEST_GLOBAL;
  if (!(fabs(placed[0] - v.d) <= goal->length / 1000)) return MG_CLOSEST_NOT_FOUND; /* another extremum */
  return mg_is_minimum(placed) ? MG_CLOSEST_LOCAL : MG_CLOSEST_STATIONARY;
}

/* Closest points of any contact kind; returns MG_CLOSEST_NOT_FOUND .. */
static int mg_closest_pair(const mg_shape_pair *p, const mg_newton_goal *goal, int is_warm_start, mg_real *eta,
                           mg_real *placed) {
  if (p->kernels->contact_kinds[p->kind].is_convex) return mg_closest_convex(p, goal, is_warm_start, eta, placed);
  if (mg_damped_newton(p, goal, eta, placed) < 0) return MG_CLOSEST_NOT_FOUND;
  if (p->kernels->contact_kinds[p->kind].n_eta == 0) return MG_CLOSEST_GLOBAL;
  return mg_is_minimum(placed) ? MG_CLOSEST_LOCAL : MG_CLOSEST_STATIONARY;
}

MG_API void mg_closest(const mg_closest_queries *q) {
  const mg_newton_goal goal = {q->length, q->residual, q->step_limit};
  for (long i = 0; i < q->n; i++) {
    const mg_shape_pair p = {q->kernels, q->kind, q->pose_o + 12 * i, q->pose_f + 12 * i,
                             q->parameters + q->stride * i};
    mg_real placed[14];
    q->outcome[i] =
        mg_closest_pair(&p, &goal, q->is_warm_start, q->eta + q->kernels->contact_kinds[q->kind].n_eta * i, placed);
    q->d[i] = placed[0], q->margin[2 * i] = placed[3], q->margin[2 * i + 1] = placed[4];
    for (int k = 0; k < 3; k++) {
      q->normal[3 * i + k] = placed[5 + k];
      q->point_o[3 * i + k] = placed[8 + k], q->point_f[3 * i + k] = placed[11 + k];
    }
  }
}
