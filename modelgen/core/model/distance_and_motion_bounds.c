/* Bounds from balls around the shapes: distances from below, and relative motion from above. Reads c->bodies. */
#include "model/model.h"
#include "base/base.h"

/* Distance of two balls with centres in the axes of their bodies. */
static mg_real mg_ball_distance(const mg_context *c, int o, const mg_real *centre_o, mg_real radius_o, int f,
                                const mg_real *centre_f, mg_real radius_f) {
  mg_real a[3], b[3];
  mg_to_world(c->bodies.pose + 12 * o, centre_o, 1, a);
  mg_to_world(c->bodies.pose + 12 * f, centre_f, 1, b);
  const mg_real span[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  return sqrt(mg_dot3(span, span)) - radius_o - radius_f;
}

/* Lower bound of the distance of the features of a pair; 0 if one is unbounded. */
static mg_real mg_feature_pair_clearance(const mg_context *c, int feature_pair) {
  const mg_real *o = mg_feature_numbers(c, feature_pair, 0), *f = mg_feature_numbers(c, feature_pair, 1);
  mg_real centre_o[3], centre_f[3];
  if (o[MG_FEATURE_BALL_RADIUS] >= MG_MAX / 2 || f[MG_FEATURE_BALL_RADIUS] >= MG_MAX / 2) return 0;
  mg_to_world(o + MG_FEATURE_PLACEMENT, o + MG_FEATURE_BALL_CENTRE, 1, centre_o);
  mg_to_world(f + MG_FEATURE_PLACEMENT, f + MG_FEATURE_BALL_CENTRE, 1, centre_f);
  return mg_ball_distance(c, mg_feature_body(c, feature_pair, 0), centre_o, o[MG_FEATURE_BALL_RADIUS],
                          mg_feature_body(c, feature_pair, 1), centre_f, f[MG_FEATURE_BALL_RADIUS]);
}

MG_INTERNAL const mg_real *mg_pair_ball(const mg_context *c, int pair, int side) {
  MG_REQUIRE(pair >= 0 && pair < c->system->n_pair);
  static const mg_real unbounded[4] = {0, 0, 0, -1};
  const int ball = mg_ball_of_pair(c, pair, side);
  return ball < 0 ? unbounded : c->system->ball + 4 * ball;
}

MG_INTERNAL int mg_unbounded_side(const mg_context *c, int pair) { return mg_pair_ball(c, pair, 0)[3] >= 0; }

MG_INTERNAL mg_real mg_pair_length(const mg_context *c, int pair) {
  const mg_real o = mg_pair_ball(c, pair, 0)[3], f = mg_pair_ball(c, pair, 1)[3];
  const mg_real smaller = o < 0 || (f >= 0 && f < o) ? f : o;
  return mg_max(smaller, c->system->length);
}

MG_INTERNAL mg_real mg_pair_size(const mg_context *c, int pair) {
  const mg_real o = mg_pair_ball(c, pair, 0)[3], f = mg_pair_ball(c, pair, 1)[3], length = mg_pair_length(c, pair);
  return mg_min(o > 0 ? mg_min(o, length) : length, f > 0 ? f : length);
}

MG_INTERNAL mg_real mg_search_reach(const mg_context *c, int pair) {
  return c->settings->search_gap * mg_pair_length(c, pair);
}

MG_INTERNAL int mg_is_out_of_reach(const mg_context *c, int feature_pair) {
  return mg_feature_pair_clearance(c, feature_pair) > mg_search_reach(c, c->system->feature_pair_owner[feature_pair]);
}

MG_INTERNAL mg_real mg_pair_clearance(const mg_context *c, int pair) {
  const mg_real *o = mg_pair_ball(c, pair, 0), *f = mg_pair_ball(c, pair, 1);
  const int first = c->system->pair_feature_pair[pair];
  mg_real clear = MG_MAX, whole = 0;
  if (mg_has_pair_extents(c, pair))
    whole = mg_ball_distance(c, mg_feature_body(c, first, 0), o, o[3], mg_feature_body(c, first, 1), f, f[3]);
  whole = mg_max(whole, (mg_real)0);
  for (int each = first; each < c->system->pair_feature_pair[pair + 1] && clear > whole; each++)
    clear = mg_min(clear, mg_feature_pair_clearance(c, each));
  return mg_max(clear, whole);
}

/* Largest distance of a shape of a pair from the centre of mass of its body (0: o, 1: f); < 0: unbounded. */
static mg_real mg_shape_extent(const mg_context *c, int pair, int body) {
  const mg_real *ball = mg_pair_ball(c, pair, body);
  return ball[3] < 0 ? -1 : sqrt(mg_dot3(ball, ball)) + ball[3];
}

MG_INTERNAL int mg_has_pair_extents(const mg_context *c, int pair) {
  return mg_pair_ball(c, pair, 0)[3] >= 0 && mg_pair_ball(c, pair, 1)[3] >= 0;
}

/* Motion of body `seen` in the axes of body `from`, in world axes. */
typedef struct {
  mg_real arm[3], change[3], frame_w[3]; /* place and velocity less those of `from`; turn of that */
  mg_real v[3], w[3];                    /* velocity and turn in its axes */
} mg_relative_velocity;

static void mg_find_relative_velocity(const mg_context *c, int seen, int from, mg_relative_velocity *of) {
  const mg_real *pose = c->bodies.pose + 12 * from, *end = c->bodies.pose + 12 * seen;
  const mg_real *a = c->bodies.twist + 6 * from, *b = c->bodies.twist + 6 * seen;
  mg_real frame_velocity[3];
  for (int k = 0; k < 3; k++) of->arm[k] = end[k] - pose[k], of->change[k] = b[k] - a[k];
  mg_to_world(pose, a + 3, 0, of->frame_w), mg_to_world(end, b + 3, 0, of->w);
  mg_cross_product(of->frame_w, of->arm, frame_velocity);
  for (int k = 0; k < 3; k++) of->v[k] = of->change[k] - frame_velocity[k], of->w[k] -= of->frame_w[k];
}

/* Bound of the speed of the points of body `seen`, within `extent` of its centre of mass, in the axes of body `from`.
 */
static mg_real mg_relative_speed_bound(const mg_relative_velocity *of, mg_real extent) {
  return sqrt(mg_dot3(of->v, of->v)) + extent * sqrt(mg_dot3(of->w, of->w));
}

/* The same of their acceleration. */
static mg_real mg_relative_acceleration_bound(const mg_context *c, int seen, int from, const mg_relative_velocity *of,
                                              mg_real extent) {
  const mg_real *da = c->bodies.acceleration + 6 * from, *db = c->bodies.acceleration + 6 * seen;
  mg_real dv[3], dw[3], frame_dw[3], frame_acceleration[3], coriolis[3];
  mg_to_world(c->bodies.pose + 12 * from, da + 3, 0, frame_dw);
  mg_to_world(c->bodies.pose + 12 * seen, db + 3, 0, dw);
  mg_cross_product(frame_dw, of->arm, frame_acceleration), mg_cross_product(of->frame_w, of->change, coriolis);
  for (int k = 0; k < 3; k++) dv[k] = db[k] - da[k] - (frame_acceleration[k] + coriolis[k]), dw[k] -= frame_dw[k];
  return sqrt(mg_dot3(dv, dv)) + extent * sqrt(mg_dot3(dw, dw));
}

MG_INTERNAL mg_motion_bound mg_pair_motion_bound(const mg_context *c, int pair, int with_acceleration) {
  const int first = c->system->pair_feature_pair[pair];
  mg_motion_bound least = {MG_MAX, 0};
  for (int side = 1; side >= 0; side--) {
    const int seen = mg_feature_body(c, first, side), from = mg_feature_body(c, first, 1 - side);
    const mg_real known = mg_shape_extent(c, pair, side), extent = known < 0 ? c->system->length : known;
    if (known < 0 && (side == 0 || mg_shape_extent(c, pair, 0) >= 0)) continue; /* the other body bounds it */
    mg_relative_velocity of;
    mg_find_relative_velocity(c, seen, from, &of);
    const mg_real speed = mg_relative_speed_bound(&of, extent);
    if (!(speed < least.speed)) continue;
    least.speed = speed;
    if (with_acceleration) least.acceleration = mg_relative_acceleration_bound(c, seen, from, &of, extent);
  }
  return least;
}

/* Square of the change of a vector in the axes of body `from` from earlier poses of all bodies to the present ones; the
   axes of the world serve where it does not turn. */
static mg_real mg_squared_change(const mg_context *c, int from, const mg_real *vector_before, const mg_real *vector_now,
                                 const mg_real *before) {
  const mg_real *seen[2] = {vector_before, vector_now};
  mg_real turned[2][3];
  if (c->bodies.motion[from] != MG_FIXED) {
    mg_rotate_back(before + 12 * from + 3, vector_before, turned[0]);
    mg_rotate_back(c->bodies.pose + 12 * from + 3, vector_now, turned[1]);
    seen[0] = turned[0], seen[1] = turned[1];
  }
  const mg_real change[3] = {seen[1][0] - seen[0][0], seen[1][1] - seen[0][1], seen[1][2] - seen[0][2]};
  return mg_dot3(change, change);
}

/* How far the centre of mass of body `seen` has come since then in the axes of body `from`. */
static mg_real mg_relative_way(const mg_context *c, int seen, int from, const mg_real *before) {
  const mg_real *poses[2] = {before, c->bodies.pose};
  mg_real arm[2][3];
  for (int k = 0; k < 2; k++)
    for (int i = 0; i < 3; i++) arm[k][i] = poses[k][12 * seen + i] - poses[k][12 * from + i];
  return sqrt(mg_squared_change(c, from, arm[0], arm[1], before));
}

/* Bound of the relative turn of two bodies since then, as the distance of the new from the old places of points at a
   distance of 1 from the axis: the Frobenius norm of the change of the rotation between them, over sqrt(2). */
static mg_real mg_relative_turn_bound(const mg_context *c, int a, int b, const mg_real *before) {
  const int from = c->bodies.motion[a] == MG_FIXED ? a : b, seen = from == a ? b : a;
  mg_real turn = 0;
  for (int column = 12 * seen + 3; column < 12 * seen + 12; column += 3)
    turn += mg_squared_change(c, from, before + column, c->bodies.pose + column, before);
  return sqrt(turn / 2);
}

MG_INTERNAL mg_real mg_pair_movement_bound(const mg_context *c, int pair, const mg_real *before) {
  const int first = c->system->pair_feature_pair[pair];
  const int body[2] = {mg_feature_body(c, first, 0), mg_feature_body(c, first, 1)};
  const mg_real extent[2] = {mg_shape_extent(c, pair, 0), mg_shape_extent(c, pair, 1)};
  const mg_real turn = mg_relative_turn_bound(c, body[0], body[1], before);
  if (extent[0] < 0 && extent[1] < 0) return mg_relative_way(c, body[1], body[0], before) + c->system->length * turn;
  mg_real least = MG_MAX;
  for (int side = 1; side >= 0; side--)
    if (extent[side] >= 0)
      least = mg_min(least, mg_relative_way(c, body[side], body[1 - side], before) + extent[side] * turn);
  return least;
}

MG_INTERNAL mg_real mg_pair_speed_bound(const mg_context *c, int pair) {
  return mg_pair_motion_bound(c, pair, 0).speed;
}

MG_INTERNAL mg_real mg_pair_step_movement(const mg_context *c, int pair, mg_real h) {
  return mg_max(h * mg_pair_speed_bound(c, pair), mg_pair_movement_bound(c, pair, c->step.start_pose));
}
