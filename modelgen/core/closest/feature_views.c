/* Feature pairs that cannot hold closest points within reach, without a search: their features are too far apart, or
   they are planes, straight edges and vertices, whose normal follows from the poses alone, and that breaks a condition
   of the feature pair. Features are seen in world axes; each view serves all feature pairs of its pair. */
#include "closest/closest.h"
#include "base/base.h"
#include "model/model.h"

MG_INTERNAL void mg_begin_feature_views(mg_context *c, int pair) {
  for (int k = 0; k < MG_FEATURE_VIEWS && !c->search.view_round; k++) c->search.views[k].round = 0;
  c->search.view_round++, c->search.viewed_pair = pair;
}

/* True if the ball around a feature is within reach of that around the other shape of its pair, or one has none. */
static int mg_is_feature_near(const mg_context *c, int feature_pair, int side, const mg_feature_in_world *view) {
  const int pair = c->system->feature_pair_owner[feature_pair];
  const mg_real *ball = mg_pair_ball(c, pair, mg_side_of_pair(c, feature_pair, 1 - side));
  if (ball[3] < 0 || view->radius >= MG_MAX / 2) return 1;
  return mg_distance_from(c, mg_feature_body(c, feature_pair, 1 - side), ball, view->centre) - ball[3] - view->radius <=
         mg_search_reach(c, pair);
}

/* Reads a feature of a pair at the present poses. The ball around a vertex is itself. */
static void mg_read_feature(const mg_context *c, int feature_pair, int side, mg_feature_in_world *view) {
  const mg_shape_kind *kind = mg_shape_kind_of(c, feature_pair, side);
  const int body = mg_feature_body(c, feature_pair, side);
  const mg_real *pose = c->bodies.pose + 12 * body, *at = mg_feature_numbers(c, feature_pair, side),
                *place = at + MG_FEATURE_PLACEMENT;
  mg_real local[3];
  view->round = c->search.view_round, view->numbers = c->system->feature_numbers[2 * feature_pair + side];
  view->body = body;
  view->shape = c->system->feature_shape[2 * feature_pair + side];
  view->dimension = kind->dimension, view->radius = at[MG_FEATURE_BALL_RADIUS];
  view->flat = kind->dimension || view->radius == 0 ? kind->flat : 0;
  mg_to_world(place, at + MG_FEATURE_BALL_CENTRE, 1, local), mg_to_world(pose, local, 1, view->centre);
  view->is_near = mg_is_feature_near(c, feature_pair, side, view);
  if (!view->is_near || !view->flat) return;
  mg_shape_rotation(c, feature_pair, side, view->rotation);
  if (kind->dimension) mg_to_world(pose, place, 1, view->point);
  else mg_copy_reals(view->point, view->centre, 3);
}

/* The view of a feature: a feature pair has the numbers of its features, which others of the same pair share. */
static const mg_feature_in_world *mg_view_of_feature(mg_context *c, int feature_pair, int side) {
  const int numbers = c->system->feature_numbers[2 * feature_pair + side],
            body = mg_feature_body(c, feature_pair, side),
            half = MG_FEATURE_VIEWS / 2 * mg_side_of_pair(c, feature_pair, side),
            place = half + numbers / MG_FEATURE_SIZE % (MG_FEATURE_VIEWS / 2);
  mg_feature_in_world *view = c->search.views + place;
  if (view->round != c->search.view_round || view->numbers != numbers || view->body != body ||
      view->shape != c->system->feature_shape[2 * feature_pair + side])
    mg_read_feature(c, feature_pair, side, view);
  return view;
}

/* True if the balls around two features are farther apart than the reach of their pair. */
static int mg_are_out_of_reach(const mg_context *c, int pair, const mg_feature_in_world *o,
                               const mg_feature_in_world *f) {
  if (!o->is_near || !f->is_near) return 1;
  if (o->radius >= MG_MAX / 2 || f->radius >= MG_MAX / 2) return 0;
  const mg_real reach = mg_search_reach(c, pair) + o->radius + f->radius,
                span[3] = {f->centre[0] - o->centre[0], f->centre[1] - o->centre[1], f->centre[2] - o->centre[2]};
  return mg_dot3(span, span) > reach * reach;
}

/* Normal out of the first of two flat features towards the second, of unit length, of two edges one of both, and the
   gap along it. */
typedef struct {
  mg_real N[3], d;
} mg_normal_gap;

/* What is known of the normal of two flat features. */
enum {
  MG_NORMAL_UNKNOWN = 0, /* it is not known to rounding */
  MG_NORMAL_KNOWN = 1,
  MG_NORMAL_NONE = 2 /* parallel edges: no closest points of theirs are isolated */
};

/* Finds the normal and the gap of two flat features. Returns MG_NORMAL_UNKNOWN .. . */
static int mg_find_normal(const mg_context *c, const mg_feature_in_world *o, const mg_feature_in_world *f,
                          mg_normal_gap *at) {
  const mg_real least = c->settings->search_merge_distance,
                span[3] = {f->point[0] - o->point[0], f->point[1] - o->point[1], f->point[2] - o->point[2]};
  mg_real size = 1;
  if (o->dimension == 2 || f->dimension == 2) {
    for (int k = 0; k < 3; k++)
      at->N[k] = o->dimension == 2 ? (mg_real)o->flat * o->rotation[6 + k] : -(mg_real)f->flat * f->rotation[6 + k];
    if (o->dimension && f->dimension) return MG_NORMAL_UNKNOWN;
  } else if (o->dimension && f->dimension) {
    mg_cross_product(o->rotation, f->rotation, at->N);
    size = sqrt(mg_dot3(at->N, at->N));
    if (size <= c->settings->search_margin) return MG_NORMAL_NONE;
    if (!(size > least)) return MG_NORMAL_UNKNOWN;
  } else {
    const mg_real *tangent = o->dimension ? o->rotation : f->rotation,
                  along = o->dimension || f->dimension ? mg_dot3(span, tangent) : 0;
    for (int k = 0; k < 3; k++) at->N[k] = span[k] - along * tangent[k];
    size = sqrt(mg_dot3(at->N, at->N));
    if (!(size > least * (c->system->length + fabs(along)))) return MG_NORMAL_UNKNOWN;
  }
  for (int k = 0; k < 3; k++) at->N[k] /= size;
  at->d = mg_dot3(at->N, span);
  return MG_NORMAL_KNOWN;
}

/* Value of a condition on the normal of an edge or a vertex, N out of it in the axes of its shape; MG_MAX of others. */
static mg_real mg_normal_condition(const mg_system *s, int condition, const mg_real *N) {
  const mg_real *a = s->numbers + s->condition_numbers[condition];
  if (s->condition_kind[condition] == MG_CONDITION_DIRECTION) return -mg_dot3(a, N);
  return s->condition_kind[condition] == MG_CONDITION_WING ? a[0] * N[1] - a[1] * N[2] : MG_MAX;
}

/* True if two flat features have no normal, or the gap along it is below `least` or above `most`, or it breaks a
   condition of the feature pair by more than rounding, and than time-stepping holds contacts beyond one; of two edges
   both normals. */
static int mg_is_normal_excluded(const mg_context *c, int feature_pair, const mg_feature_in_world *o,
                                 const mg_feature_in_world *f, mg_real least, mg_real most) {
  const mg_system *s = c->system;
  const mg_real slack = c->settings->feature_border + c->settings->parallel_angle;
  mg_normal_gap at;
  mg_real N[3];
  const int known = mg_find_normal(c, o, f, &at);
  if (known != MG_NORMAL_KNOWN) return known == MG_NORMAL_NONE;
  const int has_sign = o->dimension == 1 && f->dimension == 1;
  int side = -1, is_out[2] = {at.d < least || at.d > most, !has_sign || -at.d < least || -at.d > most};
  for (int k = s->feature_pair_condition[feature_pair];
       k < s->feature_pair_condition[feature_pair + 1] && !(is_out[0] && is_out[1]); k++) {
    if (side != s->condition_feature[k]) {
      side = s->condition_feature[k], mg_rotate_back((side ? f : o)->rotation, at.N, N);
      for (int i = 0; i < 3 && side; i++) N[i] = -N[i];
    }
    const mg_real value = mg_normal_condition(s, k, N),
                  allowed =
                      slack + (s->condition_feature_pair[k] == MG_BEYOND_WATCHED ? c->settings->appear_tilt_sine : 0);
    if (value < -allowed) is_out[0] = 1;
    if (value > allowed && value < MG_MAX) is_out[1] = 1;
  }
  return is_out[0] && is_out[1];
}

MG_INTERNAL int mg_may_hold_closest_points(mg_context *c, int feature_pair, mg_real least, mg_real most) {
  MG_NEEDS_ANY(c, MG_VALID_POSES);
  MG_REQUIRE(c->search.viewed_pair == c->system->feature_pair_owner[feature_pair]);
  const mg_feature_in_world *o = mg_view_of_feature(c, feature_pair, 0), *f = mg_view_of_feature(c, feature_pair, 1);
  if (mg_are_out_of_reach(c, c->system->feature_pair_owner[feature_pair], o, f)) return 0;
  return !o->flat || !f->flat || !mg_is_normal_excluded(c, feature_pair, o, f, least, most);
}
