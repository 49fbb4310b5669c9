/* Where a segment leaves the surfaces of a body, and so whether a point is in it: of shapes whose material no terms
   describe. Reads c->bodies; divides cells. */
#include "closest/closest.h"
#include "base/base.h"
#include "model/model.h"

#define MG_SEGMENT_SPREAD ((mg_real)0.25) /* of the normals of such a cell, at most */
#define MG_SEGMENT_NEWTON 12              /* steps to where a segment crosses a cell */
#define MG_SEGMENT_BORDER ((mg_real)1e-6) /* of a cell, within which it is crossed, too */
#define MG_SEGMENT_CELLS 64               /* cells smaller than the segment by this factor are not divided */
#define MG_SEGMENT_STACK 128              /* cells still to be treated */
#define MG_SEGMENT_STEPS 1024             /* steps along a segment, at most, from one side of a surface to the other */
#define MG_SEGMENT_BISECTIONS 60

/* A segment in the axes of a shape: a point and the vector to its end, m. It leaves nothing within `least` of the
   point, m; one that begins on a surface has -`least` of it in place of that. What it leaves within `slack` of a
   border, m, it leaves. What part of its length is in that body is no longer than `size`, m. */
typedef struct {
  mg_real start[3], along[3], length, size, least, slack;
} mg_segment;

/* True if a surface has cells. */
static int mg_has_cells(const mg_context *c, int feature_pair, int side) {
  return c->system->n_cell_tree > 0 && c->system->feature_tree[2 * feature_pair + side] >= 0;
}

/* Point of a segment. */
static void mg_point_of_segment(const mg_segment *segment, mg_real part, mg_real *x) {
  for (int k = 0; k < 3; k++) x[k] = segment->start[k] + part * segment->along[k];
}

/* The part of a segment at which it leaves a plane or a sphere, where the exterior normal is given; 1 if it does not.
 */
static mg_real mg_left_at(const mg_context *c, int feature_pair, int side, const mg_segment *segment, mg_real part,
                          const mg_real *normal) {
  mg_real x[3];
  if (!(part < 1) || !(part * segment->length > segment->least) || !(mg_dot3(normal, segment->along) > 0)) return 1;
  mg_point_of_segment(segment, part, x);
  return mg_is_within_border(c, feature_pair, side, x, segment->slack) ? mg_max(part, (mg_real)0) : 1;
}

/* The part of a segment at which its distance from the origin passes a radius, m, to more if `outward` is 1 and to less
   if it is -1; 1 if it does not. */
static mg_real mg_part_at_radius(const mg_segment *segment, mg_real radius, mg_real outward) {
  const mg_real *start = segment->start, *along = segment->along;
  const mg_real a = mg_dot3(along, along), b = mg_dot3(start, along), e = mg_dot3(start, start) - radius * radius,
                root = b * b - a * e;
  return root > 0 && a > 0 ? (outward * sqrt(root) - b) / a : 1;
}

/* The part of a segment at which it leaves a plane or a sphere, or 1. Where it begins on a sphere and goes along it, it
   leaves the sphere above the height that rounding may show. */
static mg_real mg_part_in_closed_feature(mg_context *c, int feature_pair, int side, const mg_segment *segment) {
  const mg_system *s = c->system;
  const int kind = s->feature_shape[2 * feature_pair + side];
  const mg_real zero[2] = {0, 0}, *start = segment->start, *along = segment->along;
  mg_real x[3], normal[3];
  c->kernels->shape_point(kind, zero, s->parameters + s->feature_parameters[2 * feature_pair + side], x, normal);
  if (c->kernels->shape_kinds[kind].nearest_point == MG_NEAREST_PLANE) {
    const mg_real span[3] = {x[0] - start[0], x[1] - start[1], x[2] - start[2]}, rate = mg_dot3(normal, along);
    return rate > 0 ? mg_left_at(c, feature_pair, side, segment, mg_dot3(normal, span) / rate, normal) : 1;
  }
  const mg_real outward = mg_dot3(x, normal) < 0 ? -1 : 1, radius = sqrt(mg_dot3(x, x)),
                rounding = mg_max(-segment->least, (mg_real)0);
  mg_real part = mg_part_at_radius(segment, radius, outward);
  if (fabs(sqrt(mg_dot3(start, start)) - radius) <= rounding &&
      (part == 1 || part * segment->length <= sqrt(2 * radius * rounding)))
    part = mg_part_at_radius(segment, radius + outward * rounding, outward);
  if (part == 1) return 1;
  mg_point_of_segment(segment, part, normal);
  for (int k = 0; k < 3; k++) normal[k] *= outward;
  return mg_left_at(c, feature_pair, side, segment, part, normal);
}

/* Distance of a point of a segment from a surface at a constant distance from its spine, m; negative in the body. */
static mg_real mg_height_over_spine(const mg_spine *spine, const mg_segment *segment, mg_real part) {
  mg_real x[3];
  mg_point_of_segment(segment, part, x);
  const mg_real across = mg_hypot(x[0], x[1]),
                distance = spine->kind == MG_SPINE_LINE ? across : mg_hypot(across - spine->radius, x[2]);
  return spine->tube > 0 ? distance - spine->tube : -spine->tube - distance;
}

/* The part at which a segment rises above a height over such a surface, between one below and one above. */
static mg_real mg_part_at_height(const mg_spine *spine, const mg_segment *segment, mg_real height, mg_real below,
                                 mg_real above) {
  for (int k = 0; k < MG_SEGMENT_BISECTIONS; k++) {
    const mg_real middle = below + (above - below) / 2;
    if (mg_height_over_spine(spine, segment, middle) > height) above = middle;
    else below = middle;
  }
  return below;
}

/* The part at which a segment leaves such a surface, or 1. Where it begins on the surface and goes along it, it leaves
   the surface above the height that rounding may show. */
static mg_real mg_part_about_spine(const mg_context *c, int feature_pair, int side, const mg_segment *segment) {
  const mg_real rounding = mg_max(-segment->least, (mg_real)0), length = segment->length;
  mg_spine spine;
  mg_real below = -1, part = 0;
  mg_read_spine(c, feature_pair, side, &spine);
  mg_real least = fabs(mg_height_over_spine(&spine, segment, 0)) <= rounding ? rounding : 0;
  for (;;) {
    const mg_real height = mg_height_over_spine(&spine, segment, part);
    if (height > least && below >= 0) {
      mg_real x[3];
      const mg_real at = mg_part_at_height(&spine, segment, least, below, part);
      mg_point_of_segment(segment, at, x);
      if (at * length > segment->least && mg_is_within_border(c, feature_pair, side, x, segment->slack)) return at;
    }
    below = height > least ? -1 : part;
    if (height < -least) least = 0;
    if (!(part < 1)) return 1;
    part = mg_min(part + mg_max(fabs(height), segment->size / MG_SEGMENT_STEPS) / length, (mg_real)1);
  }
}

/* Where a segment is nearest to the middle of a cell, as a part of it that may be less than 0 or more than 1. */
static mg_real mg_part_nearest_to_cell(const mg_cell *cell, const mg_segment *segment) {
  const mg_real span[3] = {cell->centre[0] - segment->start[0], cell->centre[1] - segment->start[1],
                           cell->centre[2] - segment->start[2]};
  return mg_dot3(span, segment->along) / (segment->length * segment->length);
}

/* The part of a segment before which it does not leave a cell, or 1: it leaves where the cell is near and its normal
   points forwards. */
static mg_real mg_part_before_cell(const mg_cell *cell, const mg_segment *segment) {
  const mg_real length = segment->length, nearest = mg_part_nearest_to_cell(cell, segment),
                radius = cell->radius + segment->slack, part = mg_min(mg_max(nearest, (mg_real)0), (mg_real)1);
  mg_real apart[3];
  for (int k = 0; k < 3; k++) apart[k] = cell->centre[k] - segment->start[k] - part * segment->along[k];
  if (mg_dot3(apart, apart) > radius * radius ||
      !(mg_dot3(cell->direction, segment->along) + cell->spread * length > 0))
    return 1;
  return mg_min(mg_max(nearest - radius / length, (mg_real)0), (mg_real)1);
}

/* True if a cell is small enough beside a segment for Newton's method to find where the segment crosses it. */
static int mg_is_cell_small_enough(const mg_cell *cell, const mg_segment *segment, mg_real smallest) {
  return cell->radius <= smallest ||
         (cell->radius * MG_SEGMENT_CELLS <= segment->size && cell->spread <= MG_SEGMENT_SPREAD);
}

/* The part of a segment at which it crosses a small cell from behind, by Newton's method with the slopes at its middle;
   1 if it does not. */
static mg_real mg_part_through_cell(mg_context *c, int feature_pair, int side, const mg_cell *cell,
                                    const mg_segment *segment) {
  const mg_system *s = c->system;
  const mg_real *a = cell->slope[0], *b = cell->slope[1], *along = segment->along;
  mg_real part = mg_part_nearest_to_cell(cell, segment), place[2] = {0, 0}, x[3], normal[3], off[3], across[3], w[3];
  mg_cross_product(a, b, across);
  const mg_real root = mg_dot3(across, along),
                middle[2] = {cell->box[0] / 2 + cell->box[1] / 2, cell->box[2] / 2 + cell->box[3] / 2};
  if (!(fabs(root) > MG_EPS * cell->radius * cell->radius * segment->length)) return 1;
  for (int step = 0; step <= MG_SEGMENT_NEWTON; step++) {
    const mg_real uv[2] = {middle[0] + place[0] * (cell->box[1] - middle[0]),
                           middle[1] + place[1] * (cell->box[3] - middle[1])};
    c->kernels->shape_point(s->feature_shape[2 * feature_pair + side], uv,
                            s->parameters + s->feature_parameters[2 * feature_pair + side], x, normal);
    for (int k = 0; k < 3; k++) off[k] = segment->start[k] + part * along[k] - x[k];
    if (step == MG_SEGMENT_NEWTON) break;
    mg_cross_product(b, along, w), place[0] += mg_dot3(off, w) / root;
    mg_cross_product(along, a, w), place[1] += mg_dot3(off, w) / root;
    part -= mg_dot3(off, across) / root;
    if (!(fabs(place[0]) <= 2) || !(fabs(place[1]) <= 2)) return 1;
  }
  return sqrt(mg_dot3(off, off)) <= segment->slack && fabs(place[0]) <= 1 + MG_SEGMENT_BORDER &&
                 fabs(place[1]) <= 1 + MG_SEGMENT_BORDER && mg_dot3(normal, along) > 0
             ? part
             : 1;
}

/* The part of a segment at which it leaves a surface with cells, or 1; 0 where the search before has left no room to
   tell. */
static mg_real mg_part_in_cells(mg_context *c, int feature_pair, int side, const mg_segment *segment) {
  const mg_real smallest =
      c->settings->search_merge_distance * mg_pair_length(c, c->system->feature_pair_owner[feature_pair]);
  int stack[MG_SEGMENT_STACK], count = 0;
  mg_real first = 1, near[3];
  mg_feature_limits limits;
  mg_limit_feature(c, feature_pair, side, &limits);
  stack[count++] = mg_root_cell(c, feature_pair, side, 0);
  if (!stack[0]) return 0;
  while (count > 0) {
    const int at = stack[--count];
    const mg_cell *cell = c->search.cells + at;
    const mg_real part = mg_is_cell_beyond(c, at, &limits) ? 1 : mg_part_before_cell(cell, segment);
    if (!(part < first)) continue;
    if (mg_is_cell_small_enough(cell, segment, smallest)) {
      const mg_real left = mg_part_through_cell(c, feature_pair, side, cell, segment);
      mg_point_of_segment(segment, left, near);
      if (left < first && left * segment->length > segment->least &&
          mg_is_within_border(c, feature_pair, side, near, segment->slack))
        first = mg_max(left, (mg_real)0);
      continue;
    }
    const int half = count + 2 <= MG_SEGMENT_STACK ? mg_divide_cell(c, feature_pair, side, at) : 0;
    if (!half) {
      mg_report_exceeded(c->run, MG_CAPACITY_SEGMENT);
      return 0;
    }
    stack[count++] = half, stack[count++] = half + 1;
  }
  return first;
}

/* Diameter of the ball around a body of a pair, m; MG_MAX if it has none. */
static mg_real mg_body_size(const mg_context *c, int pair, int body) {
  const mg_system *s = c->system;
  for (int side = 0; side < 2; side++) {
    const int ball = mg_ball_of_pair(c, pair, side);
    if (ball >= 0 && s->ball_body[ball] == body && s->ball[4 * ball + 3] >= 0) return 2 * s->ball[4 * ball + 3];
  }
  return MG_MAX;
}

/* The segment between two points, given in world axes, in the axes of the shape of a feature. */
static mg_segment mg_segment_in_shape_axes(const mg_context *c, int feature_pair, int side, const mg_real *start,
                                           const mg_real *end, mg_real least) {
  mg_segment segment = {.least = least};
  mg_real last[3];
  mg_point_in_shape_axes(c, feature_pair, side, start, segment.start);
  mg_point_in_shape_axes(c, feature_pair, side, end, last);
  for (int k = 0; k < 3; k++) segment.along[k] = last[k] - segment.start[k];
  segment.length = sqrt(mg_dot3(segment.along, segment.along));
  segment.size =
      mg_min(mg_body_size(c, c->system->feature_pair_owner[feature_pair], mg_feature_body(c, feature_pair, side)),
             segment.length);
  segment.slack = c->settings->start_gap * c->system->length;
  return segment;
}

/* The part at which a segment leaves a surface, or 1. */
static mg_real mg_part_in_feature(mg_context *c, int feature_pair, int side, const mg_segment *segment) {
  if (mg_has_nearest_point(c, feature_pair, side)) return mg_part_in_closed_feature(c, feature_pair, side, segment);
  if (mg_is_about_spine(c, feature_pair, side)) return mg_part_about_spine(c, feature_pair, side, segment);
  return mg_has_cells(c, feature_pair, side) ? mg_part_in_cells(c, feature_pair, side, segment) : 1;
}

/* True if a feature of one side of a feature pair is a surface. */
static int mg_is_surface(const mg_context *c, int feature_pair, int side) {
  return mg_feature_dimension(c, feature_pair, side) == 2;
}

MG_INTERNAL mg_real mg_part_in_surfaces(mg_context *c, int feature_pair, int side, const mg_real *start,
                                        const mg_real *end, mg_real least) {
  const mg_system *s = c->system;
  const int pair = s->feature_pair_owner[feature_pair], body = mg_feature_body(c, feature_pair, side);
  mg_real part = MG_MAX;
  for (int each = s->pair_feature_pair[pair]; each < s->pair_feature_pair[pair + 1]; each++) {
    const int own = mg_feature_body(c, each, 1) == body;
    if (!mg_is_surface(c, each, own) || !s->feature_is_listed[2 * each + own]) continue;
    const mg_segment segment = mg_segment_in_shape_axes(c, each, own, start, end, least);
    part = mg_min(part, mg_part_in_feature(c, each, own, &segment));
  }
  return part;
}

/* True if what a way of vector `along` from a point meets first of the body of one side of a feature pair, farther off
   than what touches, it leaves. */
static int mg_does_way_leave_first(mg_context *c, int feature_pair, int side, const mg_real *point,
                                   const mg_real *along) {
  const mg_real least = c->settings->overlap_clear_gaps * c->settings->start_gap * c->system->length;
  mg_real end[3];
  for (int k = 0; k < 3; k++) end[k] = point[k] + along[k];
  const mg_real part = mg_part_in_surfaces(c, feature_pair, side, point, end, least);
  if (!(part < 1)) return 0;
  for (int k = 0; k < 3; k++) end[k] = point[k] + part * along[k];
  return !(mg_part_in_surfaces(c, feature_pair, side, end, point, 0) < 1);
}

MG_INTERNAL int mg_is_in_body(mg_context *c, int feature_pair, int side, const mg_real *point) {
  static const mg_real direction[3] = {(mg_real)0.48, (mg_real)0.6, (mg_real)0.64};
  const int pair = c->system->feature_pair_owner[feature_pair];
  const mg_real size = mg_has_pair_extents(c, pair) ? 2 * (mg_pair_ball(c, pair, 0)[3] + mg_pair_ball(c, pair, 1)[3])
                                                    : 4 * mg_search_radius(c, feature_pair, side);
  mg_real along[3], back[3];
  mg_to_world(c->bodies.pose + 12 * mg_feature_body(c, feature_pair, side), direction, 0, along);
  for (int k = 0; k < 3; k++) along[k] *= size, back[k] = -along[k];
  return mg_does_way_leave_first(c, feature_pair, side, point, along) &&
         mg_does_way_leave_first(c, feature_pair, side, point, back);
}

/* True if it can be told of all surfaces of a pair where a segment leaves them: planes, spheres, those about spines,
   and those with cells, which convex shapes have none of. */
static int mg_are_crossings_known(const mg_context *c, int pair) {
  const mg_system *s = c->system;
  for (int each = s->pair_feature_pair[pair]; each < s->pair_feature_pair[pair + 1]; each++)
    for (int side = 0; side < 2; side++)
      if (mg_is_surface(c, each, side) && s->feature_is_listed[2 * each + side] &&
          !mg_has_nearest_point(c, each, side) && !mg_is_about_spine(c, each, side) && !mg_has_cells(c, each, side))
        return 0;
  return 1;
}

MG_INTERNAL int mg_is_body_within(mg_context *c, int pair, int side) {
  const mg_system *s = c->system;
  const int first = s->pair_feature_pair[pair], body = mg_feature_body(c, first, side);
  int points = 0;
  if (!mg_are_crossings_known(c, pair)) return 0;
  for (int each = first; each < s->pair_feature_pair[pair + 1]; each++) {
    const int own = mg_feature_body(c, each, 1) == body;
    mg_real window[4];
    mg_sample at;
    if (!s->feature_is_listed[2 * each + own]) continue;
    if (mg_is_surface(c, each, own) && !mg_is_unconditional_feature_pair(c, each)) continue;
    mg_sample_window(c, each, own, mg_search_radius(c, each, own), window);
    const mg_real middle[2] = {window[0] + (window[1] - window[0]) / 2, window[2] + (window[3] - window[2]) / 2};
    mg_sample_at(c, each, own, middle, &at);
    if (!mg_is_in_body(c, first, 1 - side, at.point)) return 0;
    points++;
  }
  return points > 0;
}

MG_INTERNAL int mg_has_surfaces(const mg_context *c, int pair) {
  for (int each = c->system->pair_feature_pair[pair]; each < c->system->pair_feature_pair[pair + 1]; each++)
    if (mg_is_surface(c, each, 0) || mg_is_surface(c, each, 1)) return 1;
  return 0;
}

/* True if a segment from a point of a surface of the body of one side to beyond another point does not leave it. */
static int mg_is_segment_in_body(mg_context *c, int feature_pair, int side, const mg_real *start,
                                 const mg_real *point) {
  const mg_real touching = c->settings->start_gap * c->system->length,
                span[3] = {point[0] - start[0], point[1] - start[1], point[2] - start[2]},
                beyond = 2 * touching / sqrt(mg_dot3(span, span));
  mg_real end[3];
  for (int k = 0; k < 3; k++) end[k] = point[k] + beyond * span[k];
  const mg_real part = mg_part_in_surfaces(c, feature_pair, side, start, end, -touching);
  return part >= 1 && part < MG_MAX;
}

MG_INTERNAL int mg_side_of_pair(const mg_context *c, int feature_pair, int side) {
  const int first = c->system->pair_feature_pair[c->system->feature_pair_owner[feature_pair]];
  return mg_feature_body(c, feature_pair, side) != mg_feature_body(c, first, 0);
}

/* True if a point is in the ball around the shape of one side of a feature pair, or that has none: material is nowhere
   else, and behind an open surface it is not looked for any deeper. */
static int mg_is_in_ball_of_shape(const mg_context *c, int feature_pair, int side, const mg_real *point) {
  const int pair = c->system->feature_pair_owner[feature_pair], body = mg_feature_body(c, feature_pair, side);
  const mg_real *ball = mg_pair_ball(c, pair, mg_side_of_pair(c, feature_pair, side));
  mg_real arm[3];
  if (ball[3] < 0) return 1;
  mg_to_world(c->bodies.pose + 12 * body, ball, 1, arm);
  for (int k = 0; k < 3; k++) arm[k] -= point[k];
  return mg_dot3(arm, arm) <= ball[3] * ball[3];
}

/* True if a surface of the body of one side is within what touches of a point: a short segment along some axis of the
   body crosses it. */
static int mg_is_on_surface(mg_context *c, int feature_pair, int side, const mg_real *point) {
  const mg_real *axes = c->bodies.pose + 12 * mg_feature_body(c, feature_pair, side) + 3,
                reach = 2 * c->settings->start_gap * c->system->length;
  for (int way = 0; way < 6; way++) {
    mg_real start[3], end[3];
    for (int k = 0; k < 3; k++) {
      const mg_real off = (way % 2 ? -reach : reach) * axes[3 * (way / 2) + k];
      start[k] = point[k] - off, end[k] = point[k] + off;
    }
    if (mg_part_in_surfaces(c, feature_pair, side, start, end, 0) < 1) return 1;
  }
  return 0;
}

MG_INTERNAL int mg_is_point_in_body(mg_context *c, int feature_pair, int side) {
  MG_NEEDS_PLACED_PAIR(c, feature_pair);
  const mg_real *start = c->search.placement + (side ? 11 : 8), *point = c->search.placement + (side ? 8 : 11);
  if (!mg_is_in_ball_of_shape(c, feature_pair, side, point)) return 0;
  if (!mg_is_surface(c, feature_pair, side)) return mg_is_in_body(c, feature_pair, side, point);
  return mg_is_segment_in_body(c, feature_pair, side, start, point) && !mg_is_on_surface(c, feature_pair, side, point);
}
