/* Whether a critical pair of points with a negative distance is a penetration, or belongs to sides of the bodies that
   face away from each other, as the outer sides of two links of a chain: then the segment from one point to the other
   leaves the body in which it begins before it enters that in which it ends. Reads c->bodies; divides cells. */
#include "closest/closest.h"
#include "base/base.h"
#include "model/model.h"

#define MG_SEGMENT_START ((mg_real)0.05) /* part of a segment at its start in which it is not tested against cells */
#define MG_SEGMENT_CELLS 64              /* cells smaller than the segment by this factor are not divided */
#define MG_SEGMENT_STACK 128             /* cells still to be treated */

/* A segment in the axes of a shape: a point and the vector to its end, m; it leaves nothing within `least` of the
   point, m. */
typedef struct {
  mg_real start[3], along[3], least;
} mg_segment;

/* Point of a segment. */
static void mg_point_of_segment(const mg_segment *segment, mg_real part, mg_real *x) {
  for (int k = 0; k < 3; k++) x[k] = segment->start[k] + part * segment->along[k];
}

/* The part of a segment at which it leaves a plane or a sphere, where the exterior normal is given; 1 if it does not.
 */
static mg_real mg_left_at(const mg_context *c, int feature_pair, int side, const mg_segment *segment, mg_real part,
                          const mg_real *normal) {
  mg_real x[3];
  if (!(part < 1) || !(part * sqrt(mg_dot3(segment->along, segment->along)) > segment->least) ||
      !(mg_dot3(normal, segment->along) > 0))
    return 1;
  mg_point_of_segment(segment, part, x);
  return mg_is_within_border(c, feature_pair, side, x) ? mg_max(part, (mg_real)0) : 1;
}

/* The part of a segment at which it leaves a plane or a sphere, or 1. */
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
  const mg_real a = mg_dot3(along, along), b = mg_dot3(start, along), e = mg_dot3(start, start) - mg_dot3(x, x),
                root = b * b - a * e, outward = mg_dot3(x, normal) < 0 ? -1 : 1;
  if (!(root > 0) || !(a > 0)) return 1;
  const mg_real part = (outward * sqrt(root) - b) / a;
  mg_point_of_segment(segment, part, normal);
  for (int k = 0; k < 3; k++) normal[k] *= outward;
  return mg_left_at(c, feature_pair, side, segment, part, normal);
}

/* The part of a segment before which it does not leave a cell, or 1: it leaves where the cell is near and its normal
   points forwards. */
static mg_real mg_part_before_cell(const mg_cell *cell, const mg_segment *segment, mg_real length) {
  const mg_real span[3] = {cell->centre[0] - segment->start[0], cell->centre[1] - segment->start[1],
                           cell->centre[2] - segment->start[2]};
  const mg_real nearest = mg_dot3(span, segment->along) / (length * length),
                part = mg_min(mg_max(nearest, MG_SEGMENT_START), (mg_real)1);
  mg_real apart[3];
  for (int k = 0; k < 3; k++) apart[k] = span[k] - part * segment->along[k];
  if (mg_dot3(apart, apart) > cell->radius * cell->radius ||
      !(mg_dot3(cell->direction, segment->along) + cell->spread * length > 0))
    return 1;
  return mg_min(mg_max(nearest - cell->radius / length, MG_SEGMENT_START), (mg_real)1);
}

/* The part of a segment at which it leaves a surface with cells, or 1; 0 where the search before has left no room to
   tell. */
static mg_real mg_part_in_cells(mg_context *c, int feature_pair, int side, const mg_segment *segment, mg_real length) {
  int stack[MG_SEGMENT_STACK], count = 0;
  mg_real first = 1;
  mg_feature_limits limits;
  mg_limit_feature(c, feature_pair, side, &limits);
  stack[count] = mg_root_cell(c, feature_pair, side, 0);
  count += stack[0] != 0;
  while (count > 0) {
    const int at = stack[--count];
    const mg_cell *cell = c->search.cells + at;
    const mg_real part = mg_is_cell_beyond(c, at, &limits) ? 1 : mg_part_before_cell(cell, segment, length);
    if (!(part < first)) continue;
    if (cell->radius * MG_SEGMENT_CELLS <= length) {
      if (mg_is_within_border(c, feature_pair, side, cell->centre)) first = part;
      continue;
    }
    const int half = count + 2 <= MG_SEGMENT_STACK ? mg_divide_cell(c, feature_pair, side, at) : 0;
    if (!half) return 0;
    stack[count++] = half, stack[count++] = half + 1;
  }
  return first;
}

/* The part of the segment between two points, given in world axes, at which it leaves a surface, or 1. */
static mg_real mg_part_in_feature(mg_context *c, int feature_pair, int side, const mg_real *start, const mg_real *end,
                                  mg_real least) {
  mg_segment segment = {.least = least};
  mg_real last[3];
  mg_point_in_shape_axes(c, feature_pair, side, start, segment.start);
  mg_point_in_shape_axes(c, feature_pair, side, end, last);
  for (int k = 0; k < 3; k++) segment.along[k] = last[k] - segment.start[k];
  const mg_real length = sqrt(mg_dot3(segment.along, segment.along));
  if (mg_has_nearest_point(c, feature_pair, side)) return mg_part_in_closed_feature(c, feature_pair, side, &segment);
  return c->system->feature_tree[2 * feature_pair + side] >= 0
             ? mg_part_in_cells(c, feature_pair, side, &segment, length)
             : 1;
}

/* True if a feature of one side of a feature pair is a surface. */
static int mg_is_surface(const mg_context *c, int feature_pair, int side) {
  return mg_feature_dimension(c, feature_pair, side) == 2;
}

/* The part of the segment from the point of one side of a feature pair to that of the other at which it leaves the
   body of that side, or 1. From an edge or a vertex it leaves no surface at once, unless the normal is outside of the
   normal cone: then the body reaches farther beside it. A body without surfaces it leaves at once. */
static mg_real mg_part_in_body(mg_context *c, int feature_pair, int side, const mg_real *eta) {
  if (!mg_is_in_normal_cone(c, feature_pair, side, eta)) return 0;
  const mg_system *s = c->system;
  const int pair = s->feature_pair_owner[feature_pair], body = mg_feature_body(c, feature_pair, side);
  const mg_real *start = c->search.placement + (side ? 11 : 8), *last = c->search.placement + (side ? 8 : 11),
                one = c->settings->search_merge_distance * mg_pair_length(c, pair),
                least = mg_is_surface(c, feature_pair, side) ? -one : one;
  mg_real part = MG_MAX;
  for (int each = s->pair_feature_pair[pair]; each < s->pair_feature_pair[pair + 1]; each++) {
    const int own = mg_feature_body(c, each, 1) == body;
    if (mg_is_surface(c, each, own)) part = mg_min(part, mg_part_in_feature(c, each, own, start, last, least));
  }
  return part < MG_MAX ? part : 0;
}

/* True if a body of a pair has surfaces; joint limits and curves have none. */
static int mg_has_surfaces(const mg_context *c, int pair) {
  for (int each = c->system->pair_feature_pair[pair]; each < c->system->pair_feature_pair[pair + 1]; each++)
    if (mg_is_surface(c, each, 0) || mg_is_surface(c, each, 1)) return 1;
  return 0;
}

MG_INTERNAL int mg_is_between_far_sides(mg_context *c, int feature_pair, const mg_real *eta) {
  if (!mg_has_surfaces(c, c->system->feature_pair_owner[feature_pair])) return 0;
  const mg_real length = fabs(c->search.placement[0]), first = mg_part_in_body(c, feature_pair, 0, eta);
  if (!(first < 1)) return 0;
  const mg_real second = mg_part_in_body(c, feature_pair, 1, eta);
  return second < 1 && (first + second - 1) * length <= c->settings->start_gap * c->system->length;
}
