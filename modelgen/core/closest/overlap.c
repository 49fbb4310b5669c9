/* Whether bodies have material in common: at two of their points whose distance is negative, or anywhere. By how high
   points are above their material (solid); an overlap is told only by a point that is in both. Of shapes whose material
   no terms describe, by segment_crossings.c. Reads c->bodies; writes the placement of the probe contact. */
#include "closest/closest.h"
#include "base/base.h"
#include "model/model.h"
#include "solid/solid.h"

#define MG_CURVE_SAMPLES 64         /* of a curve, and of each coordinate of a surface without material */
#define MG_BLOCKS 8                 /* into which each coordinate of such a surface is divided first */
#define MG_BLOCK_REACH 2            /* how far a block reaches from its middle, over how far its corners are */
#define MG_END_PART ((mg_real)1e-7) /* of a curve, at its ends */
#define MG_CURVE_LOWEST 3           /* of them, about which the lowest place is refined */
#define MG_CHORD_HALVINGS 24        /* of the part of a curve that passes through a disc */
#define MG_GOLDEN ((mg_real)0.3819660112501051)
#define MG_GOLDEN_STEPS 40
#define MG_SMALLEST_CELL ((mg_real)1 / 64) /* of the radius of the ball that is searched */
#define MG_DESCENT_STEPS 60

/* Depth of a point in both bodies beyond which they overlap, m: where touching bodies overlap as far as they may, no
   point is deeper in both. */
static mg_real mg_common_depth(const mg_context *c) { return c->settings->start_gap * c->system->length / 2; }

/* The solids of the shapes of a pair; a shape without material has all points. */
static mg_both_solids mg_solids_of_pair(const mg_context *c, int pair) {
  mg_both_solids both = {c->system, {-1, -1}, {0, 0}};
  MG_NEEDS_ANY(c, MG_VALID_POSES);
  for (int side = 0; side < 2; side++) {
    if (!mg_has_material(c, pair, side)) continue;
    both.solid[side] = mg_solid_of_pair(c, pair, side);
    both.pose[side] = c->bodies.pose + 12 * c->system->solid_body[both.solid[side]];
  }
  return both;
}

/* A line on the feature of one side of a feature pair, from coordinates to coordinates, and the solids of its pair. */
typedef struct {
  mg_both_solids both;
  int feature_pair, side, samples;
  mg_real from[2], to[2];
} mg_line;

/* The point at a part of a line. */
static void mg_sample_on_line(mg_context *c, const mg_line *line, mg_real part, mg_sample *at) {
  mg_real uv[2];
  for (int k = 0; k < 2; k++) uv[k] = line->from[k] + part * (line->to[k] - line->from[k]);
  mg_sample_at(c, line->feature_pair, line->side, uv, at);
}

/* Height over both bodies at a part of a line; MG_MAX beyond the borders of its feature. */
static mg_real mg_height_on_line(mg_context *c, const mg_line *line, mg_real part) {
  mg_sample at;
  mg_sample_on_line(c, line, part, &at);
  if (!mg_is_within_border(c, line->feature_pair, line->side, at.local, 0)) return MG_MAX;
  return mg_height_over_both(&line->both, at.point, MG_FIRST_ORDER);
}

/* Lowest height on a line about a part of it, by golden sections. */
static mg_real mg_lowest_about(mg_context *c, const mg_line *line, mg_real low, mg_real high, mg_real enough) {
  mg_real a = low + MG_GOLDEN * (high - low), b = high - MG_GOLDEN * (high - low), at_a = mg_height_on_line(c, line, a),
          at_b = mg_height_on_line(c, line, b);
  for (int k = 0; k < MG_GOLDEN_STEPS && mg_min(at_a, at_b) >= enough; k++)
    if (at_a < at_b) {
      high = b, b = a, at_b = at_a;
      a = low + MG_GOLDEN * (high - low), at_a = mg_height_on_line(c, line, a);
    } else {
      low = a, a = b, at_a = at_b;
      b = high - MG_GOLDEN * (high - low), at_b = mg_height_on_line(c, line, b);
    }
  return mg_min(at_a, at_b);
}

/* True if a line may be in both bodies between two parts of it, in whose middle it is at a height: it comes as far as
   its ends are apart. */
static int mg_may_line_be_lower(mg_context *c, const mg_line *line, mg_real low, mg_real high, mg_real height) {
  mg_real apart[3];
  mg_sample from, to;
  mg_sample_on_line(c, line, low, &from);
  mg_sample_on_line(c, line, high, &to);
  for (int k = 0; k < 3; k++) apart[k] = to.point[k] - from.point[k];
  return height < sqrt(mg_dot3(apart, apart));
}

/* True if a point of a line is in both bodies. */
static int mg_is_line_in_both(mg_context *c, const mg_line *line) {
  const mg_real deep = -mg_common_depth(c);
  const int samples = line->samples;
  mg_real height[MG_CURVE_SAMPLES + 1];
  for (int k = 0; k <= samples; k++)
    if ((height[k] = mg_height_on_line(c, line, (mg_real)k / samples)) < deep) return 1;
  for (int tries = 0; tries < MG_CURVE_LOWEST; tries++) {
    int best = -1;
    for (int k = 0; k <= samples; k++)
      if (height[k] < MG_MAX && (best < 0 || height[k] < height[best])) best = k;
    if (best < 0) return 0;
    const mg_real low = (mg_real)(best > 0 ? best - 1 : 0) / samples,
                  high = (mg_real)(best < samples ? best + 1 : samples) / samples;
    if (!mg_may_line_be_lower(c, line, low, high, height[best])) return 0;
    if (mg_lowest_about(c, line, low, high, deep) < deep) return 1;
    for (int k = best > 0 ? best - 1 : 0; k <= best + 1 && k <= samples; k++) height[k] = MG_MAX;
  }
  return 0;
}

/* True if points lower and lower from a point on lead into both bodies. */
static int mg_does_descent_reach_both(const mg_context *c, const mg_both_solids *both, mg_real *x, mg_real step) {
  const mg_real deep = -mg_common_depth(c);
  mg_real height = mg_height_over_both(both, x, MG_FIRST_ORDER);
  for (int k = 0; k < MG_DESCENT_STEPS && height >= deep; k++) {
    int is_lower = 0;
    for (int way = 0; way < 6; way++) {
      mg_real y[3] = {x[0], x[1], x[2]};
      y[way / 2] += way % 2 ? -step : step;
      const mg_real at = mg_height_over_both(both, y, MG_FIRST_ORDER);
      if (!(at < height)) continue;
      height = at, is_lower = 1;
      for (int i = 0; i < 3; i++) x[i] = y[i];
    }
    if (!is_lower) step /= 2;
  }
  return height < deep;
}

/* True if a point in both bodies is found in a ball, world axes. */
static int mg_is_ball_in_both(const mg_context *c, int pair, const mg_real *centre, mg_real radius) {
  const mg_both_solids both = mg_solids_of_pair(c, pair);
  mg_common_point found;
  return mg_find_common_point(&both, centre, radius, mg_common_depth(c), MG_SMALLEST_CELL * radius, &found) ||
         (found.is_undecided && mg_does_descent_reach_both(c, &both, found.lowest, found.half));
}

/* The smaller of the balls around the shapes of a pair that have material, world axes. Returns 0 if none is bounded. */
static int mg_smaller_ball(const mg_context *c, int pair, mg_real *centre, mg_real *radius) {
  int smaller = -1;
  for (int side = 0; side < 2; side++)
    if (mg_pair_ball(c, pair, side)[3] >= 0 &&
        (smaller < 0 || mg_pair_ball(c, pair, side)[3] < mg_pair_ball(c, pair, smaller)[3]))
      smaller = side;
  if (smaller < 0) return 0;
  const int body = mg_feature_body(c, c->system->pair_feature_pair[pair], smaller);
  mg_to_world(c->bodies.pose + 12 * body, mg_pair_ball(c, pair, smaller), 1, centre);
  *radius = mg_pair_ball(c, pair, smaller)[3];
  return *radius > 0;
}

/* Bounds (u0, u1, v0, v1) within which a feature is looked at: those of its samples, cut by its conditions. */
static void mg_window_of_feature(mg_context *c, int feature_pair, int side, mg_real *window) {
  mg_feature_limits limits;
  mg_limit_feature(c, feature_pair, side, &limits);
  mg_sample_window(c, feature_pair, side, mg_search_radius(c, feature_pair, side), window);
  for (int k = 0; k < 4; k++) window[k] = k % 2 ? mg_min(window[k], limits.box[k]) : mg_max(window[k], limits.box[k]);
  for (int k = 0; k < 4; k += 2) { /* conditions hold a little beyond the ends */
    const mg_real less = MG_END_PART * (window[k + 1] - window[k]);
    window[k] += less, window[k + 1] -= less;
  }
}

/* True if the shape of one side of a pair may have material. */
static int mg_has_volume(const mg_context *c, int pair, int side) {
  return mg_has_material(c, pair, side) || !mg_is_material_known(c, pair, side);
}

/* True if a segment passes through the ball around the other shape of a feature pair, or that has none. */
static int mg_does_segment_pass_ball(const mg_context *c, int feature_pair, int side, const mg_real *start,
                                     const mg_real *end) {
  const int pair = c->system->feature_pair_owner[feature_pair], body = mg_feature_body(c, feature_pair, 1 - side);
  const mg_real *ball = mg_pair_ball(c, pair, mg_side_of_pair(c, feature_pair, 1 - side));
  mg_real centre[3], along[3], arm[3];
  if (ball[3] < 0) return 1;
  mg_to_world(c->bodies.pose + 12 * body, ball, 1, centre);
  for (int k = 0; k < 3; k++) along[k] = end[k] - start[k], arm[k] = centre[k] - start[k];
  const mg_real square = mg_dot3(along, along),
                part = square > 0 ? mg_min(mg_max(mg_dot3(arm, along) / square, (mg_real)0), (mg_real)1) : 0;
  for (int k = 0; k < 3; k++) arm[k] -= part * along[k];
  return mg_dot3(arm, arm) <= 4 * ball[3] * ball[3]; /* a curve is beside its chord */
}

/* True if a point in the plane of a disc, the other shape of a feature pair, is within its rim, by `clear`, m. */
static int mg_is_well_within_disc(const mg_context *c, int feature_pair, int side, const mg_real *point,
                                  mg_real clear) {
  const mg_system *s = c->system;
  const int pair = s->feature_pair_owner[feature_pair], body = mg_feature_body(c, feature_pair, 1 - side);
  mg_real x[3];
  for (int each = s->pair_feature_pair[pair]; each < s->pair_feature_pair[pair + 1]; each++) {
    const int own = mg_feature_body(c, each, 1) == body;
    if (mg_feature_dimension(c, each, own) < 2) continue;
    mg_point_in_shape_axes(c, each, own, point, x);
    if (!mg_is_within_border(c, each, own, x, -clear)) return 0;
  }
  return 1;
}

/* True if a segment passes through a disc, the other shape of a feature pair, farther from its ends and from the rim
   than `clear`, m. */
static int mg_does_segment_pass_disc(mg_context *c, int feature_pair, int side, const mg_sample *a, const mg_sample *b,
                                     mg_real clear) {
  for (int way = 0; way < 2; way++) {
    const mg_real *start = way ? b->point : a->point, *end = way ? a->point : b->point,
                  span[3] = {end[0] - start[0], end[1] - start[1], end[2] - start[2]},
                  part = mg_part_in_surfaces(c, feature_pair, 1 - side, start, end, clear),
                  x[3] = {start[0] + part * span[0], start[1] + part * span[1], start[2] + part * span[2]};
    if (part < 1 && (1 - part) * sqrt(mg_dot3(span, span)) > clear &&
        mg_is_well_within_disc(c, feature_pair, side, x, clear))
      return 1;
  }
  return 0;
}

/* The same of a part of a curve, whose point in the disc is looked for between the ends of the chord. */
static int mg_does_curve_part_pass_disc(mg_context *c, int feature_pair, int side, const mg_sample *from,
                                        const mg_sample *to, mg_real clear) {
  mg_sample a = *from, b = *to, middle;
  if (!mg_does_segment_pass_disc(c, feature_pair, side, &a, &b, clear)) return 0;
  for (int level = 0; level < MG_CHORD_HALVINGS; level++) {
    const mg_real uv[2] = {a.uv[0] + (b.uv[0] - a.uv[0]) / 2, a.uv[1]};
    mg_sample_at(c, feature_pair, side, uv, &middle);
    if (mg_does_segment_pass_disc(c, feature_pair, side, &a, &middle, 0)) b = middle;
    else if (mg_does_segment_pass_disc(c, feature_pair, side, &middle, &b, 0)) a = middle;
    else return 0;
  }
  return mg_is_well_within_disc(c, feature_pair, side, a.point, clear);
}

/* True if a part of a curve is in the other shape of its pair, by its point in the middle of where its chord is within,
   or passes through it if that is a disc, from `clear` before it to as far behind it, m. */
static int mg_is_curve_part_within(mg_context *c, int feature_pair, int side, const mg_sample *a, const mg_sample *b,
                                   mg_real clear) {
  const int pair = c->system->feature_pair_owner[feature_pair];
  mg_sample middle;
  if (!mg_does_segment_pass_ball(c, feature_pair, side, a->point, b->point)) return 0;
  if (!mg_has_volume(c, pair, mg_side_of_pair(c, feature_pair, 1 - side)))
    return mg_does_curve_part_pass_disc(c, feature_pair, side, a, b, clear);
  const mg_real left = mg_part_in_surfaces(c, feature_pair, 1 - side, a->point, b->point, 0),
                entered = 1 - mg_part_in_surfaces(c, feature_pair, 1 - side, b->point, a->point, 0);
  if (!(left < 1) && !(entered > 0)) return 0;
  const mg_real from = entered > 0 ? entered : 0, to = left < 1 ? left : 1;
  const mg_real uv[2] = {a->uv[0] + (from + to) / 2 * (b->uv[0] - a->uv[0]), a->uv[1]};
  mg_sample_at(c, feature_pair, side, uv, &middle);
  return from < to && mg_is_in_body(c, feature_pair, 1 - side, middle.point);
}

/* True if a curve is in the other shape of its pair, or passes through it if that is a disc, as far as `clear`, m. */
static int mg_does_curve_cross(mg_context *c, int feature_pair, int side, mg_real clear) {
  const int parts = mg_shape_kind_of(c, feature_pair, side)->spine == MG_SPINE_LINE ? 1 : MG_CURVE_SAMPLES;
  mg_real window[4];
  mg_sample at[2];
  mg_window_of_feature(c, feature_pair, side, window);
  for (int k = 0; k <= parts; k++) {
    const mg_real uv[2] = {window[0] + (window[1] - window[0]) * k / parts, window[2]};
    mg_sample_at(c, feature_pair, side, uv, at + k % 2);
    if (k && mg_is_curve_part_within(c, feature_pair, side, at + 1 - k % 2, at + k % 2, clear)) return 1;
  }
  return 0;
}

/* True if a block of a surface, by its coordinates (u0, u1, v0, v1), may reach into both bodies. */
static int mg_may_block_be_in_both(mg_context *c, const mg_both_solids *both, int feature_pair, int side,
                                   const mg_real *box) {
  const mg_real middle[2] = {(box[0] + box[1]) / 2, (box[2] + box[3]) / 2};
  mg_sample at, corner;
  mg_real reach = 0;
  mg_sample_at(c, feature_pair, side, middle, &at);
  for (int k = 0; k < 4; k++) {
    const mg_real uv[2] = {box[k % 2], box[2 + k / 2]};
    mg_real arm[3];
    mg_sample_at(c, feature_pair, side, uv, &corner);
    for (int i = 0; i < 3; i++) arm[i] = corner.point[i] - at.point[i];
    reach = mg_max(reach, mg_dot3(arm, arm));
  }
  return mg_height_over_both(both, at.point, MG_LIPSCHITZ) < MG_BLOCK_REACH * sqrt(reach);
}

/* True if a block of a surface has a point in both bodies: lines along u of it. */
static int mg_is_block_in_both(mg_context *c, const mg_both_solids *both, int feature_pair, int side,
                               const mg_real *box) {
  const int samples = MG_CURVE_SAMPLES / MG_BLOCKS;
  if (!mg_may_block_be_in_both(c, both, feature_pair, side, box)) return 0;
  for (int row = 0; row <= samples; row++) {
    const mg_real v = box[2] + (box[3] - box[2]) * row / samples;
    const mg_line line = {*both, feature_pair, side, samples, {box[0], v}, {box[1], v}};
    if (mg_is_line_in_both(c, &line)) return 1;
  }
  return 0;
}

/* True if a feature has a point in the material of the other shape of its pair. */
static int mg_is_feature_in_both(mg_context *c, int feature_pair, int side) {
  const mg_both_solids both = mg_solids_of_pair(c, c->system->feature_pair_owner[feature_pair]);
  mg_real window[4];
  mg_window_of_feature(c, feature_pair, side, window);
  if (mg_feature_dimension(c, feature_pair, side) < 2) {
    const mg_line line = {both, feature_pair, side, MG_CURVE_SAMPLES, {window[0], window[2]}, {window[1], window[2]}};
    return mg_is_line_in_both(c, &line);
  }
  const mg_real u = (window[1] - window[0]) / MG_BLOCKS, v = (window[3] - window[2]) / MG_BLOCKS;
  for (int k = 0; k < MG_BLOCKS * MG_BLOCKS; k++) {
    const int i = k % MG_BLOCKS, j = k / MG_BLOCKS;
    const mg_real box[4] = {window[0] + i * u, window[0] + (i + 1) * u, window[2] + j * v, window[2] + (j + 1) * v};
    if (mg_is_block_in_both(c, &both, feature_pair, side, box)) return 1;
  }
  return 0;
}

/* True if a feature of the shape of one side of a pair has a point in the material of the other. */
static int mg_is_shape_in_both(mg_context *c, int pair, int side) {
  const mg_system *s = c->system;
  const int body = mg_feature_body(c, s->pair_feature_pair[pair], side);
  for (int each = s->pair_feature_pair[pair]; each < s->pair_feature_pair[pair + 1]; each++) {
    const int own = mg_feature_body(c, each, 1) == body;
    if (s->feature_is_listed[2 * each + own] && mg_is_feature_in_both(c, each, own)) return 1;
  }
  return 0;
}

/* True if a curve of the shape of one side of a pair passes through a surface of the other. */
static int mg_do_curves_cross(mg_context *c, int pair, int side, mg_real clear) {
  const mg_system *s = c->system;
  const int body = mg_feature_body(c, s->pair_feature_pair[pair], side);
  for (int each = s->pair_feature_pair[pair]; each < s->pair_feature_pair[pair + 1]; each++) {
    const int own = mg_feature_body(c, each, 1) == body;
    if (s->feature_is_listed[2 * each + own] && mg_feature_dimension(c, each, own) == 1 &&
        mg_does_curve_cross(c, each, own, clear))
      return 1;
  }
  return 0;
}

/* True if shapes without material cross each other. */
static int mg_do_sheets_cross(mg_context *c, int pair, mg_real clear) {
  return mg_do_curves_cross(c, pair, 0, clear) || mg_do_curves_cross(c, pair, 1, clear);
}

MG_INTERNAL int mg_is_overlap_seen(mg_context *c, int pair) {
  const mg_real touching = c->settings->start_gap * c->system->length;
  mg_real centre[3], radius;
  if (mg_has_material(c, pair, 0) && mg_has_material(c, pair, 1))
    return mg_smaller_ball(c, pair, centre, &radius) && mg_is_ball_in_both(c, pair, centre, radius);
  if (!mg_has_volume(c, pair, 0) && !mg_has_volume(c, pair, 1)) return mg_do_sheets_cross(c, pair, touching);
  for (int side = 0; side < 2; side++)
    if (mg_has_material(c, pair, side)
            ? mg_is_shape_in_both(c, pair, 1 - side)
            : mg_has_volume(c, pair, side) &&
                  (mg_is_body_within(c, pair, 1 - side) || mg_do_curves_cross(c, pair, 1 - side, touching)))
      return 1;
  return 0;
}

MG_INTERNAL int mg_are_materials_known(const mg_context *c, int pair) {
  return mg_is_material_known(c, pair, 0) && mg_is_material_known(c, pair, 1);
}

/* True if the bodies of a pair overlap beside a point on one of them: the point that is nearer to the middle of that
   body's shape by a quarter of `depth` is in the material of both, at heights below `allowed`. */
static int mg_is_near_overlap(const mg_context *c, int pair, int side, const mg_real *point, mg_real depth,
                              mg_real allowed) {
  mg_real centre[3], moved[3];
  if (mg_pair_ball(c, pair, side)[3] < 0 || !mg_has_material(c, pair, side) || !mg_has_material(c, pair, 1 - side))
    return 0;
  mg_ball_centre(c, mg_ball_of_pair(c, pair, side), centre);
  const mg_real span[3] = {centre[0] - point[0], centre[1] - point[1], centre[2] - point[2]};
  const mg_real part = mg_min(depth / (4 * sqrt(mg_dot3(span, span))), (mg_real)1);
  for (int k = 0; k < 3; k++) moved[k] = point[k] + part * span[k];
  return mg_height_over_material(c, pair, side, moved, MG_FIRST_ORDER) < allowed &&
         mg_height_over_material(c, pair, 1 - side, moved, MG_FIRST_ORDER) < allowed;
}

/* True if the point of one side of the placement of a feature pair is in the material of the other, deeper than bodies
   may be that touch there, or at the border of it, where both overlap: a corner beside a flush side. Of points near
   each other, which are of far sides only of a body as thin, also if it is beside it by no more than rounding decides.
   Needs that placement evaluated last. */
static int mg_is_point_in_other(mg_context *c, int feature_pair, int side) {
  MG_NEEDS_PLACED_PAIR(c, feature_pair);
  const int pair = c->system->feature_pair_owner[feature_pair], other = mg_side_of_pair(c, feature_pair, 1 - side);
  const mg_real *point = c->search.placement + 8 + 3 * side, depth = -c->search.placement[0],
                touching = c->settings->start_gap * c->system->length,
                clear = c->settings->overlap_clear_gaps * c->settings->start_gap *
                        mg_min(c->system->length, mg_pair_size(c, pair)),
                allowed = mg_max(clear - c->settings->overlap_clear_part * depth, -touching);
  if (!mg_is_material_known(c, pair, other)) return allowed > 0 || mg_is_point_in_body(c, feature_pair, 1 - side);
  if (!mg_has_material(c, pair, other)) return 0;
  return mg_height_over_material(c, pair, other, point, MG_FIRST_ORDER) < allowed ||
         mg_is_near_overlap(c, pair, 1 - other, point, depth, mg_min(allowed, (mg_real)0));
}

MG_INTERNAL int mg_is_between_far_sides(mg_context *c, int feature_pair) {
  MG_NEEDS_PLACED_PAIR(c, feature_pair);
  const int pair = c->system->feature_pair_owner[feature_pair];
  const mg_real depth = -c->search.placement[0], touching = c->settings->start_gap * c->system->length;
  if (!(depth > touching) || !mg_has_surfaces(c, pair)) return 0;
  if (!mg_has_volume(c, pair, 0) && !mg_has_volume(c, pair, 1))
    return !mg_do_sheets_cross(c, pair, mg_max(touching, c->settings->overlap_clear_part * depth));
  return !mg_is_point_in_other(c, feature_pair, 0) && !mg_is_point_in_other(c, feature_pair, 1);
}
