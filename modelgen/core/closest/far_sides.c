/* Whether a critical pair of points with a negative distance is a penetration, or belongs to sides of the bodies that
   face away from each other, as the outer sides of two links of a chain: then the segment from one point to the other
   leaves the body in which it begins before it enters that in which it ends, or runs along surfaces that touch. And
   whether bodies overlap of which no closest points tell. Reads c->bodies; divides cells. */
#include "closest/closest.h"
#include "base/base.h"
#include "model/model.h"

#define MG_SEGMENT_START ((mg_real)0.05) /* part of a segment about whose start the surface is on which it begins */
#define MG_SEGMENT_CELLS 64              /* cells smaller than the segment by this factor are not divided */
#define MG_SEGMENT_STACK 128             /* cells still to be treated */
#define MG_SEGMENT_STEPS 1024            /* steps along a segment, at most, from one side of a surface to the other */
#define MG_SEGMENT_BISECTIONS 60
#define MG_SEGMENT_BEFORE (1 - (mg_real)1 / 64) /* part of the way to where a segment leaves a body, just before */
#define MG_TOUCH_ANGLE ((mg_real)8) /* normals over sqrt(start_gap): of radii from 1/16 of the system's length */
#define MG_LINE_CHORDS 16           /* parts of a line on a feature, which are followed as if they were straight */
#define MG_SURFACE_LINES 8          /* lines of each coordinate that are followed on a surface */
#define MG_CLEAR_GAPS 16            /* start_gap from a point on a body, within which that may touch another */
#define MG_OUTWARD ((mg_real)0.2)   /* least cosine to the normal where it starts of a segment that leaves at once */

/* A segment in the axes of a shape: a point and the vector to its end, m; it leaves nothing within `least` of the
   point, m, and what it leaves within `slack` of a border, m, it leaves. It may begin on the body that it leaves. What
   part of its length is in that body is no longer than `size`, m. */
typedef struct {
  mg_real start[3], along[3], length, size, least, slack;
  int begins_on_body;
} mg_segment;

/* True if a surface has cells. */
static int mg_has_cells(const mg_context *c, int feature_pair, int side) {
  return c->system->n_cell_tree > 0 && c->system->feature_tree[2 * feature_pair + side] >= 0;
}

/* True if a feature is a plane. */
static int mg_is_plane(const mg_context *c, int feature_pair, int side) {
  return c->kernels->shape_kinds[c->system->feature_shape[2 * feature_pair + side]].nearest_point == MG_NEAREST_PLANE;
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

/* True if a segment lies in a plane. */
static int mg_is_in_plane(const mg_segment *segment, const mg_real *point, const mg_real *normal) {
  const mg_real span[3] = {segment->start[0] - point[0], segment->start[1] - point[1], segment->start[2] - point[2]};
  return fabs(mg_dot3(normal, span)) <= segment->slack && fabs(mg_dot3(normal, segment->along)) <= segment->slack;
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
    if (segment->begins_on_body && mg_is_in_plane(segment, x, normal)) { /* the body may have no thickness there */
      const mg_real part = mg_part_within_border(c, feature_pair, side, start, along, segment->slack);
      return part * segment->length <= segment->size ? part : 1;
    }
    const mg_real span[3] = {x[0] - start[0], x[1] - start[1], x[2] - start[2]}, rate = mg_dot3(normal, along);
    return rate > 0 ? mg_left_at(c, feature_pair, side, segment, mg_dot3(normal, span) / rate, normal) : 1;
  }
  const mg_real outward = mg_dot3(x, normal) < 0 ? -1 : 1, radius = sqrt(mg_dot3(x, x)),
                rounding = fabs(segment->least);
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
  const mg_real rounding = fabs(segment->least), length = segment->length;
  mg_spine spine;
  mg_real below = -1, part = 0;
  mg_read_spine(c, feature_pair, side, &spine);
  mg_real least = fabs(mg_height_over_spine(&spine, segment, 0)) <= rounding ? rounding : 0;
  for (;;) {
    const mg_real height = mg_height_over_spine(&spine, segment, part);
    if (height > (part < 1 ? least : rounding) && below >= 0) {
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

/* Near its start, where the surface on which it begins is, a segment leaves only what all normals of a cell show. */
static int mg_is_left_near_start(const mg_cell *cell, const mg_segment *segment) {
  const mg_real length = segment->length;
  return mg_dot3(cell->direction, segment->along) - cell->spread * length > MG_OUTWARD * length;
}

/* The part from which on a segment is away from its start. */
static mg_real mg_part_away(const mg_segment *segment) { return MG_SEGMENT_START * segment->size / segment->length; }

/* The part before which a segment does not leave a cell of which nothing more is to be known, given a lower bound. */
static mg_real mg_part_before_small_cell(const mg_cell *cell, const mg_segment *segment, mg_real part) {
  const mg_real away = mg_part_away(segment);
  if (part >= away || mg_is_left_near_start(cell, segment)) return part;
  return mg_part_nearest_to_cell(cell, segment) + cell->radius / segment->length > away ? away : 1;
}

/* True if a cell is not divided for a segment, given the part before which that does not leave it: it is small beside
   the segment and, near its start, tells whether it is left there, or is as small as `smallest`, m. The body may be
   thinner there than what is near the start. */
static int mg_is_cell_small_enough(const mg_cell *cell, const mg_segment *segment, mg_real part, mg_real smallest) {
  if (!(cell->radius * MG_SEGMENT_CELLS <= segment->size)) return 0;
  return part >= mg_part_away(segment) || mg_is_left_near_start(cell, segment) || cell->radius <= smallest;
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
    if (mg_is_cell_small_enough(cell, segment, part, smallest)) {
      mg_point_of_segment(segment, mg_part_nearest_to_cell(cell, segment), near);
      if (mg_is_within_border(c, feature_pair, side, near, segment->slack))
        first = mg_min(first, mg_part_before_small_cell(cell, segment, part));
      continue;
    }
    const int half = count + 2 <= MG_SEGMENT_STACK ? mg_divide_cell(c, feature_pair, side, at) : 0;
    if (!half) {
      mg_note_exceeded(c, MG_CAPACITY_SEGMENT);
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
    const int ball = s->pair_balls[2 * pair + side];
    if (ball >= 0 && s->ball_body[ball] == body && s->ball[4 * ball + 3] >= 0) return 2 * s->ball[4 * ball + 3];
  }
  return MG_MAX;
}

/* The segment between two points, given in world axes, in the axes of the shape of a feature. */
static mg_segment mg_segment_in_shape_axes(const mg_context *c, int feature_pair, int side, const mg_real *start,
                                           const mg_real *end, mg_real least, int begins_on_body, int is_sharp) {
  mg_segment segment = {.least = least, .begins_on_body = begins_on_body};
  mg_real last[3];
  mg_point_in_shape_axes(c, feature_pair, side, start, segment.start);
  mg_point_in_shape_axes(c, feature_pair, side, end, last);
  for (int k = 0; k < 3; k++) segment.along[k] = last[k] - segment.start[k];
  segment.length = sqrt(mg_dot3(segment.along, segment.along));
  segment.size =
      mg_min(mg_body_size(c, c->system->feature_pair_owner[feature_pair], mg_feature_body(c, feature_pair, side)),
             segment.length);
  segment.slack = is_sharp ? c->settings->start_gap * c->system->length : segment.size / MG_SEGMENT_STEPS;
  return segment;
}

/* The part at which a segment leaves a surface, or 1. */
static mg_real mg_part_in_feature(mg_context *c, int feature_pair, int side, const mg_segment *segment) {
  if (mg_has_nearest_point(c, feature_pair, side)) return mg_part_in_closed_feature(c, feature_pair, side, segment);
  if (mg_is_about_spine(c, feature_pair, side)) return mg_part_about_spine(c, feature_pair, side, segment);
  return mg_has_cells(c, feature_pair, side) ? mg_part_in_cells(c, feature_pair, side, segment) : 1;
}

/* Normal of a plane or a sphere at a point x within `slack` of it. Returns 0 if x is not there. */
static int mg_normal_of_closed_feature(const mg_context *c, int feature_pair, int side, const mg_real *x, mg_real slack,
                                       mg_real *normal) {
  const mg_system *s = c->system;
  const int kind = s->feature_shape[2 * feature_pair + side];
  const mg_real zero[2] = {0, 0};
  mg_real point[3];
  c->kernels->shape_point(kind, zero, s->parameters + s->feature_parameters[2 * feature_pair + side], point, normal);
  if (c->kernels->shape_kinds[kind].nearest_point == MG_NEAREST_PLANE)
    return fabs(mg_dot3(normal, x) - mg_dot3(normal, point)) <= slack;
  const mg_real distance = sqrt(mg_dot3(x, x)), radius = sqrt(mg_dot3(point, point)),
                outward = mg_dot3(point, normal) < 0 ? -1 : 1;
  for (int k = 0; k < 3; k++) normal[k] = outward / distance * x[k];
  return fabs(distance - radius) <= slack;
}

/* Normal of a surface about a spine at a point x within `slack` of it. Returns 0 if x is not there. */
static int mg_normal_about_spine(const mg_context *c, int feature_pair, int side, const mg_real *x, mg_real slack,
                                 mg_real *normal) {
  mg_spine spine;
  mg_real foot[3];
  mg_read_spine(c, feature_pair, side, &spine);
  mg_foot_on_spine(&spine, x, foot);
  for (int k = 0; k < 3; k++) normal[k] = spine.tube < 0 ? foot[k] - x[k] : x[k] - foot[k];
  return fabs(sqrt(mg_dot3(normal, normal)) - fabs(spine.tube)) <= slack && mg_normalise3(normal);
}

/* Normal of a surface at a point x within `slack` of it, m, in the axes of its shape. Returns 0 if x is not there. */
static int mg_normal_at(mg_context *c, int feature_pair, int side, const mg_real *x, mg_real slack, mg_real *normal) {
  mg_real point[3];
  if (!mg_is_within_border(c, feature_pair, side, x, slack)) return 0;
  if (mg_has_nearest_point(c, feature_pair, side))
    return mg_normal_of_closed_feature(c, feature_pair, side, x, slack, normal);
  if (mg_is_about_spine(c, feature_pair, side)) return mg_normal_about_spine(c, feature_pair, side, x, slack, normal);
  const mg_real size =
      mg_body_size(c, c->system->feature_pair_owner[feature_pair], mg_feature_body(c, feature_pair, side));
  if (!mg_has_cells(c, feature_pair, side) ||
      !mg_point_near(c, feature_pair, side, x, mg_min(size, c->system->length) / MG_SEGMENT_CELLS, point, normal))
    return 0;
  for (int k = 0; k < 3; k++) point[k] -= x[k];
  return mg_dot3(point, point) <= slack * slack;
}

/* True if a segment begins on a surface and goes out of it there, not along it. On a plane both are known to rounding:
   a thin sheet is left at its edge by all ways but those along it. */
static int mg_begins_outward(mg_context *c, int feature_pair, int side, const mg_segment *segment) {
  const int is_plane = mg_is_plane(c, feature_pair, side);
  const mg_real slack = is_plane ? fabs(segment->least) : segment->slack,
                least = is_plane ? c->settings->feature_border : MG_OUTWARD;
  mg_real normal[3];
  return mg_normal_at(c, feature_pair, side, segment->start, slack, normal) &&
         mg_dot3(normal, segment->along) > least * segment->length;
}

/* True if a feature of one side of a feature pair is a surface. */
static int mg_is_surface(const mg_context *c, int feature_pair, int side) {
  return mg_feature_dimension(c, feature_pair, side) == 2;
}

/* The part of the segment between two points at which it leaves the body of one side of a feature pair, or 1; MG_MAX
   if the body has no surfaces. It leaves none within `least` of its start, m. If it begins on the body, it leaves that
   at once where it begins outward. If `is_sharp`, it passes edges no farther off than what touches may overlap. */
static mg_real mg_part_in_surfaces(mg_context *c, int feature_pair, int side, const mg_real *start, const mg_real *end,
                                   mg_real least, int begins_on_body, int is_sharp) {
  const mg_system *s = c->system;
  const int pair = s->feature_pair_owner[feature_pair], body = mg_feature_body(c, feature_pair, side);
  mg_real part = MG_MAX;
  for (int each = s->pair_feature_pair[pair]; each < s->pair_feature_pair[pair + 1]; each++) {
    const int own = mg_feature_body(c, each, 1) == body;
    if (!mg_is_surface(c, each, own) || !s->feature_is_listed[2 * each + own]) continue;
    const mg_segment segment = mg_segment_in_shape_axes(c, each, own, start, end, least, begins_on_body, is_sharp);
    if (begins_on_body && mg_begins_outward(c, each, own, &segment)) return 0;
    part = mg_min(part, mg_part_in_feature(c, each, own, &segment));
  }
  return part;
}

/* Least distance from its start at which a segment leaves a body, m: from a surface at once, from an edge or a vertex
   behind what rounding of its place may show. */
static mg_real mg_least_part(const mg_context *c, int feature_pair, int side) {
  const mg_real rounding =
      c->settings->search_merge_distance * mg_pair_length(c, c->system->feature_pair_owner[feature_pair]);
  return mg_is_surface(c, feature_pair, side) ? -rounding : rounding;
}

/* The part of the segment from the point of one side of a feature pair to that of the other at which it leaves the
   body of that side, or 1. A body without surfaces it leaves at once, and any if the normal is outside of the normal
   cone of an edge or a vertex: then the body reaches farther beside it. */
static mg_real mg_part_in_body(mg_context *c, int feature_pair, int side, const mg_real *eta) {
  if (!mg_is_in_normal_cone(c, feature_pair, side, eta)) return 0;
  const mg_real *start = c->search.placement + (side ? 11 : 8), *end = c->search.placement + (side ? 8 : 11),
                part =
                    mg_part_in_surfaces(c, feature_pair, side, start, end, mg_least_part(c, feature_pair, side), 1, 0);
  return part < MG_MAX ? part : 0;
}

/* Exterior normals of surfaces through a point. */
typedef struct {
  int count;
  mg_real *list; /* [3 count] */
} mg_normals;

/* Adds the exterior normals, in world axes, of the surfaces of the body of one side that a point is on. */
static void mg_add_normals(mg_context *c, int feature_pair, int side, const mg_real *point, mg_normals *normals) {
  const mg_system *s = c->system;
  const int pair = s->feature_pair_owner[feature_pair], body = mg_feature_body(c, feature_pair, side);
  const mg_real slack = 2 * c->settings->start_gap * s->length;
  mg_real x[3], normal[3], in_body[3];
  for (int each = s->pair_feature_pair[pair]; each < s->pair_feature_pair[pair + 1]; each++) {
    const int own = mg_feature_body(c, each, 1) == body;
    if (!mg_is_surface(c, each, own) || !s->feature_is_listed[2 * each + own]) continue;
    mg_point_in_shape_axes(c, each, own, point, x);
    if (!mg_normal_at(c, each, own, x, slack, normal)) continue;
    mg_to_world(mg_feature_numbers(c, each, own) + MG_FEATURE_PLACEMENT, normal, 0, in_body);
    mg_to_world(c->bodies.pose + 12 * body, in_body, 0, normals->list + 3 * normals->count++);
  }
}

/* True if a vector points against all normals, by more than an angle. */
static int mg_is_against(const mg_normals *normals, mg_real *w, mg_real angle) {
  if (!mg_normalise3(w)) return 0;
  for (int k = 0; k < normals->count; k++)
    if (!(mg_dot3(w, normals->list + 3 * k) < -angle)) return 0;
  return 1;
}

/* True if some vector points against all normals, by more than an angle. The one that does so most is against the
   middle of one, of two or of three of them. */
static int mg_is_some_way_inward(const mg_normals *normals, mg_real angle) {
  for (int a = 0; a < normals->count; a++)
    for (int b = a; b < normals->count; b++) {
      const mg_real *A = normals->list + 3 * a, *B = normals->list + 3 * b;
      mg_real w[3] = {-A[0] - B[0], -A[1] - B[1], -A[2] - B[2]};
      if (mg_is_against(normals, w, angle)) return 1;
      for (int k = b + 1; k < normals->count && a < b; k++) {
        const mg_real *C = normals->list + 3 * k, side[3] = {B[0] - A[0], B[1] - A[1], B[2] - A[2]},
                      other[3] = {C[0] - A[0], C[1] - A[1], C[2] - A[2]};
        mg_cross_product(side, other, w);
        const mg_real sign = mg_dot3(w, A) > 0 ? -1 : 1;
        for (int i = 0; i < 3; i++) w[i] *= sign;
        if (mg_is_against(normals, w, angle)) return 1;
      }
    }
  return normals->count == 0;
}

/* True if the bodies of a feature pair touch at a point that is in both of them, at the given part of a segment: no way
   from there is into both, past all of their surfaces there. */
static int mg_touch_at(mg_context *c, int feature_pair, const mg_real *start, const mg_real *end, mg_real part) {
  mg_real point[3];
  mg_normals normals = {0, c->search.normals};
  for (int k = 0; k < 3; k++) point[k] = start[k] + part * (end[k] - start[k]);
  for (int side = 0; side < 2; side++) mg_add_normals(c, feature_pair, side, point, &normals);
  return !mg_is_some_way_inward(&normals, MG_TOUCH_ANGLE * sqrt(c->settings->start_gap));
}

/* True if what a way of vector `along` from a point meets first of the body of one side of a feature pair, farther off
   than what touches, it leaves. */
static int mg_does_way_leave_first(mg_context *c, int feature_pair, int side, const mg_real *point,
                                   const mg_real *along) {
  const mg_real least = MG_CLEAR_GAPS * c->settings->start_gap * c->system->length;
  mg_real end[3];
  for (int k = 0; k < 3; k++) end[k] = point[k] + along[k];
  const mg_real part = mg_part_in_surfaces(c, feature_pair, side, point, end, least, 0, 1);
  if (!(part < 1)) return 0;
  for (int k = 0; k < 3; k++) end[k] = point[k] + (1 - MG_SEGMENT_START) * part * along[k];
  return !(mg_part_in_surfaces(c, feature_pair, side, end, point, 0, 0, 1) < 1);
}

/* True if a point is in the body of one side of a feature pair, by what ways to both sides from it meet first. */
static int mg_is_in_body(mg_context *c, int feature_pair, int side, const mg_real *point) {
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

/* True if a segment comes out of the body of one side of a feature pair, in which it is for longer than what touches
   may overlap, and which it does not only touch there. */
static int mg_comes_out(mg_context *c, int feature_pair, int side, const mg_real *start, const mg_real *end) {
  const mg_real touching = c->settings->start_gap * c->system->length;
  const mg_real along[3] = {end[0] - start[0], end[1] - start[1], end[2] - start[2]},
                length = sqrt(mg_dot3(along, along)),
                left = mg_part_in_surfaces(c, feature_pair, side, start, end, 0, 0, 1);
  mg_real at[3];
  if (!(left < 1) || !(left * length > MG_CLEAR_GAPS * touching)) return 0;
  const mg_real before = left - 2 * touching / length;
  for (int k = 0; k < 3; k++) at[k] = start[k] + before * along[k];
  const mg_real within = before * mg_min(mg_part_in_surfaces(c, feature_pair, side, at, start, 0, 0, 1), (mg_real)1);
  if (!(within * length > MG_CLEAR_GAPS * touching)) return 0;
  const mg_real part = left - within * (1 - MG_SEGMENT_BEFORE);
  for (int k = 0; k < 3; k++) at[k] = start[k] + part * along[k];
  if (mg_has_pair_extents(c, c->system->feature_pair_owner[feature_pair]) && !mg_is_in_body(c, feature_pair, side, at))
    return 0;
  return !mg_touch_at(c, feature_pair, start, end, part);
}

/* True if a way from the edge or vertex of one side into its body, no longer than it takes to reach the plane through
   the point of the other side or the size of its body, leaves the other body before it leaves its own. A body without
   surfaces it leaves at once. */
static int mg_is_other_body_within(mg_context *c, int feature_pair, int side, const mg_real *eta) {
  mg_real inward[3], start[3], end[3];
  const int pair = c->system->feature_pair_owner[feature_pair];
  const mg_real *point = c->search.placement + (side ? 11 : 8), *N = c->search.placement + 5;
  mg_inward_direction(c, feature_pair, side, eta, inward);
  const mg_real length = mg_min(fabs(c->search.placement[0]) / fabs(mg_dot3(inward, N)),
                                mg_body_size(c, pair, mg_feature_body(c, feature_pair, side)));
  if (!(length < MG_MAX)) return 0;
  for (int k = 0; k < 3; k++) end[k] = point[k] + length * inward[k];
  const mg_real part =
      mg_part_in_surfaces(c, feature_pair, side, point, end, mg_least_part(c, feature_pair, side), 0, 0);
  if (!(part > MG_SEGMENT_START) || !(part < MG_MAX)) return 0;
  for (int k = 0; k < 3; k++) {
    start[k] = point[k] + mg_min(part, (mg_real)1) * length * inward[k];
    end[k] = point[k] + MG_SEGMENT_START * length * inward[k];
  }
  return mg_comes_out(c, feature_pair, 1 - side, start, end);
}

/* True if a line of constant coordinates on the feature of one side of a feature pair, from one pair of coordinates to
   another, comes out of the body of the other side. */
static int mg_does_line_come_out(mg_context *c, int feature_pair, int side, const mg_real *from, const mg_real *to) {
  const mg_real slack = c->settings->start_gap * c->system->length;
  mg_sample at[2];
  int is_allowed[2] = {0, 0};
  for (int k = 0; k <= MG_LINE_CHORDS; k++) {
    const mg_real part = (mg_real)k / MG_LINE_CHORDS,
                  uv[2] = {from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1])};
    mg_sample_at(c, feature_pair, side, uv, at + k % 2);
    is_allowed[k % 2] = mg_is_within_border(c, feature_pair, side, at[k % 2].local, slack);
    if (is_allowed[0] && is_allowed[1] &&
        (mg_comes_out(c, feature_pair, 1 - side, at[0].point, at[1].point) ||
         mg_comes_out(c, feature_pair, 1 - side, at[1].point, at[0].point)))
      return 1;
  }
  return 0;
}

/* Least and greatest coordinates u, v of the feature of one side, by its domain and the conditions of a feature pair.
   Returns 0 where one has no bound. */
static int mg_bound_coordinates(const mg_context *c, int feature_pair, int side, mg_real *low, mg_real *high) {
  const mg_real *domain = mg_feature_numbers(c, feature_pair, side) + MG_FEATURE_DOMAIN;
  mg_feature_limits limits;
  mg_limit_feature(c, feature_pair, side, &limits);
  for (int k = 0; k < mg_feature_dimension(c, feature_pair, side); k++) {
    low[k] = mg_max(domain[2 * k], limits.box[2 * k]), high[k] = mg_min(domain[2 * k + 1], limits.box[2 * k + 1]);
    if (!(high[k] - low[k] < MG_MAX / 2)) return 0;
  }
  return 1;
}

/* True if the curve of one side of a feature pair comes out of the body of the other side anywhere between its ends;
   true too where it has none, unless it is straight: of a straight one the part near the other body is followed. A
   vertex does not. */
static int mg_does_curve_come_out(mg_context *c, int feature_pair, int side) {
  mg_real low[4] = {0}, high[2] = {0, 0};
  if (mg_feature_dimension(c, feature_pair, side) == 0) return 0;
  if (!mg_bound_coordinates(c, feature_pair, side, low, high)) {
    if (mg_shape_kind_of(c, feature_pair, side)->spine != MG_SPINE_LINE) return 1;
    mg_sample_window(c, feature_pair, side, mg_search_radius(c, feature_pair, side), low);
    high[0] = low[1], low[1] = 0;
  }
  return mg_does_line_come_out(c, feature_pair, side, low, high);
}

MG_INTERNAL int mg_are_far_sides_known(const mg_context *c, int pair) {
  const mg_system *s = c->system;
  for (int each = s->pair_feature_pair[pair]; each < s->pair_feature_pair[pair + 1]; each++)
    for (int side = 0; side < 2; side++)
      if (mg_is_surface(c, each, side) && s->feature_is_listed[2 * each + side] &&
          !mg_has_nearest_point(c, each, side) && !mg_is_about_spine(c, each, side) && !mg_has_cells(c, each, side))
        return 0;
  return 1;
}

/* A point of the body of one side of a pair, of a vertex, an edge or a surface without borders. Returns 0 if it has
   none of these. */
static int mg_point_of_body(mg_context *c, int pair, int side, mg_sample *at) {
  const mg_system *s = c->system;
  const int body = mg_feature_body(c, s->pair_feature_pair[pair], side);
  for (int each = s->pair_feature_pair[pair]; each < s->pair_feature_pair[pair + 1]; each++) {
    const int own = mg_feature_body(c, each, 1) == body;
    if (!s->feature_is_listed[2 * each + own]) continue;
    if (mg_is_surface(c, each, own) && !mg_is_unconditional_feature_pair(c, each)) continue;
    mg_real window[4];
    mg_sample_window(c, each, own, mg_search_radius(c, each, own), window);
    const mg_real middle[2] = {window[0] + (window[1] - window[0]) / 2, window[2] + (window[3] - window[2]) / 2};
    mg_sample_at(c, each, own, middle, at);
    return 1;
  }
  return 0;
}

/* True if a line on the feature of one side of a feature pair comes out of the body of the other side. */
static int mg_does_feature_come_out(mg_context *c, int feature_pair, int side) {
  mg_real low[2] = {0, 0}, high[2] = {0, 0};
  const int dimension = mg_feature_dimension(c, feature_pair, side);
  if (dimension == 0 || !mg_bound_coordinates(c, feature_pair, side, low, high)) return 0;
  if (dimension == 1) return mg_does_line_come_out(c, feature_pair, side, low, high);
  for (int along = 0; along < 2; along++)
    for (int line = 0; line < MG_SURFACE_LINES; line++) {
      const mg_real across = low[1 - along] + (high[1 - along] - low[1 - along]) * line / MG_SURFACE_LINES;
      mg_real from[2], to[2];
      from[along] = low[along], to[along] = high[along], from[1 - along] = to[1 - along] = across;
      if (mg_does_line_come_out(c, feature_pair, side, from, to)) return 1;
    }
  return 0;
}

/* True if a segment passes through the ball around the body of one side of a pair, or that has none. */
static int mg_does_segment_pass_ball(const mg_context *c, int pair, int side, const mg_real *start,
                                     const mg_real *end) {
  const mg_real *ball = mg_pair_ball(c, pair, side);
  mg_real centre[3], along[3], arm[3];
  if (ball[3] < 0) return 1;
  mg_to_world(c->bodies.pose + 12 * mg_feature_body(c, c->system->pair_feature_pair[pair], side), ball, 1, centre);
  for (int k = 0; k < 3; k++) along[k] = end[k] - start[k], arm[k] = centre[k] - start[k];
  const mg_real square = mg_dot3(along, along),
                part = square > 0 ? mg_min(mg_max(mg_dot3(arm, along) / square, (mg_real)0), (mg_real)1) : 0;
  for (int k = 0; k < 3; k++) arm[k] -= part * along[k];
  return mg_dot3(arm, arm) <= ball[3] * ball[3];
}

/* True if a segment crosses a surface of the body of one side of a feature pair, away from the borders of the surface
   and from its own ends: from well before the surface to well behind it, beside what touching bodies may overlap and
   by what mg_bound_coordinates lengthens an edge. */
static int mg_does_segment_cross(mg_context *c, int feature_pair, int side, const mg_real *start, const mg_real *end) {
  const mg_system *s = c->system;
  const int pair = s->feature_pair_owner[feature_pair], body = mg_feature_body(c, feature_pair, side);
  const mg_real touching = c->settings->start_gap * s->length, clear = MG_CLEAR_GAPS * touching;
  mg_real point[3], x[3], normal[3];
  for (int each = s->pair_feature_pair[pair]; each < s->pair_feature_pair[pair + 1]; each++) {
    const int own = mg_feature_body(c, each, 1) == body;
    if (!mg_is_surface(c, each, own) || !s->feature_is_listed[2 * each + own]) continue;
    const mg_segment segment = mg_segment_in_shape_axes(c, each, own, start, end, 0, 0, 1);
    const mg_real part = mg_part_in_feature(c, each, own, &segment);
    if (!(part > 0 && part < 1)) continue;
    for (int k = 0; k < 3; k++) point[k] = start[k] + part * (end[k] - start[k]);
    mg_point_in_shape_axes(c, each, own, point, x);
    if (!mg_normal_at(c, each, own, x, 2 * touching, normal) || !mg_is_within_border(c, each, own, x, -clear)) continue;
    const mg_real rise = mg_dot3(normal, segment.along);
    if (rise > MG_TOUCH_ANGLE * sqrt(c->settings->start_gap) * segment.length && mg_min(part, 1 - part) * rise > clear)
      return 1;
  }
  return 0;
}

/* True if the line of constant coordinates on a feature from one pair of coordinates to another, at which the feature
   is at the points given, is straight. */
static int mg_is_line_straight(mg_context *c, int feature_pair, int side, const mg_real *from, const mg_real *to,
                               const mg_real *first, const mg_real *last) {
  static const mg_real parts[2] = {(mg_real)0.37, (mg_real)0.71};
  const mg_real along[3] = {last[0] - first[0], last[1] - first[1], last[2] - first[2]},
                length = sqrt(mg_dot3(along, along));
  for (int inner = 0; inner < 2; inner++) {
    const mg_real uv[2] = {from[0] + parts[inner] * (to[0] - from[0]), from[1] + parts[inner] * (to[1] - from[1])};
    mg_sample at;
    mg_real off[3], arm[3];
    mg_sample_at(c, feature_pair, side, uv, &at);
    for (int k = 0; k < 3; k++) arm[k] = at.point[k] - first[k];
    mg_cross_product(along, arm, off);
    if (!(sqrt(mg_dot3(off, off)) <= c->settings->start_gap * c->system->length * length)) return 0;
  }
  return length > 0;
}

/* True if such a line is straight and crosses a surface of the other body where it is on the feature. */
static int mg_does_straight_line_cross(mg_context *c, int feature_pair, int side, const mg_real *from,
                                       const mg_real *to) {
  const int pair = c->system->feature_pair_owner[feature_pair],
            other =
                mg_feature_body(c, feature_pair, 1 - side) != mg_feature_body(c, c->system->pair_feature_pair[pair], 0);
  mg_sample at, last;
  mg_sample_at(c, feature_pair, side, from, &at);
  mg_sample_at(c, feature_pair, side, to, &last);
  if (!mg_does_segment_pass_ball(c, pair, other, at.point, last.point) ||
      !mg_is_line_straight(c, feature_pair, side, from, to, at.point, last.point))
    return 0;
  for (int k = 0; k < MG_LINE_CHORDS; k++) {
    const mg_real part = (mg_real)k / MG_LINE_CHORDS,
                  uv[2] = {from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1])};
    mg_sample_at(c, feature_pair, side, uv, &at);
    if (!mg_is_within_border(c, feature_pair, side, at.local, 0)) continue;
    mg_real along[3], end[3];
    for (int i = 0; i < 3; i++) along[i] = last.local[i] - at.local[i];
    const mg_real within = mg_min(mg_part_within_border(c, feature_pair, side, at.local, along, 0), (mg_real)1);
    for (int i = 0; i < 3; i++) end[i] = at.point[i] + within * (last.point[i] - at.point[i]);
    if (mg_does_segment_cross(c, feature_pair, 1 - side, at.point, end) ||
        mg_does_segment_cross(c, feature_pair, 1 - side, end, at.point))
      return 1;
    k += (int)(within * (MG_LINE_CHORDS - k));
  }
  return 0;
}

/* True if a straight line on the feature of one side of a feature pair crosses a surface of the other body. */
static int mg_does_feature_cross(mg_context *c, int feature_pair, int side) {
  const int dimension = mg_feature_dimension(c, feature_pair, side);
  mg_real low[2] = {0, 0}, high[2] = {0, 0}, window[4];
  if (dimension == 0) return 0;
  if (!mg_bound_coordinates(c, feature_pair, side, low, high)) {
    mg_sample_window(c, feature_pair, side, mg_search_radius(c, feature_pair, side), window);
    low[0] = window[0], high[0] = window[1];
    if (dimension == 2) low[1] = window[2], high[1] = window[3];
  }
  if (dimension == 1) return mg_does_straight_line_cross(c, feature_pair, side, low, high);
  for (int along = 0; along < 2; along++)
    for (int line = 0; line < MG_SURFACE_LINES; line++) {
      mg_real from[2], to[2];
      from[along] = low[along], to[along] = high[along];
      from[1 - along] = to[1 - along] = low[1 - along] + (high[1 - along] - low[1 - along]) * line / MG_SURFACE_LINES;
      if (mg_does_straight_line_cross(c, feature_pair, side, from, to)) return 1;
    }
  return 0;
}

MG_INTERNAL int mg_do_lines_cross(mg_context *c, int pair) {
  const mg_system *s = c->system;
  for (int each = s->pair_feature_pair[pair]; each < s->pair_feature_pair[pair + 1]; each++)
    for (int side = 0; side < 2; side++)
      if (s->feature_is_listed[2 * each + side] && mg_does_feature_cross(c, each, side)) return 1;
  return 0;
}

MG_INTERNAL int mg_do_bodies_overlap(mg_context *c, int pair) {
  const mg_system *s = c->system;
  mg_sample inner;
  for (int side = 0; side < 2; side++)
    if (mg_point_of_body(c, pair, 1 - side, &inner) && mg_is_in_body(c, s->pair_feature_pair[pair], side, inner.point))
      return 1;
  if (!mg_has_pair_extents(c, pair)) return 0;
  for (int each = s->pair_feature_pair[pair]; each < s->pair_feature_pair[pair + 1]; each++)
    for (int side = 0; side < 2; side++)
      if (s->feature_is_listed[2 * each + side] && mg_does_feature_come_out(c, each, side)) return 1;
  return 0;
}

MG_INTERNAL int mg_are_outside_each_other(mg_context *c, const mg_minimum *found) {
  mg_real next[6], point[2][3], before[3];
  if (found->d <= c->settings->start_gap * c->system->length) return 1;
  mg_place_contact(c, mg_use_probe_contact(c, found->feature_pair), found->eta, next);
  for (int k = 0; k < 3; k++) point[0][k] = c->search.placement[8 + k], point[1][k] = c->search.placement[11 + k];
  for (int side = 0; side < 2; side++) {
    const mg_real *start = point[1 - side], *end = point[side];
    for (int k = 0; k < 3; k++) before[k] = start[k] - 2 * MG_SEGMENT_START * (end[k] - start[k]);
    if (mg_part_in_surfaces(c, found->feature_pair, side, before, end, 0, 0, 0) < 1) return 0;
  }
  return 1;
}

/* True if a body of a pair has surfaces; joint limits and curves have none. */
static int mg_has_surfaces(const mg_context *c, int pair) {
  for (int each = c->system->pair_feature_pair[pair]; each < c->system->pair_feature_pair[pair + 1]; each++)
    if (mg_is_surface(c, each, 0) || mg_is_surface(c, each, 1)) return 1;
  return 0;
}

/* True if the bodies of a feature pair touch at the given part of the way between the points of the placement, which
   are so far apart that no point is near the surfaces of both. */
static int mg_touch_between(mg_context *c, int feature_pair, mg_real part) {
  const mg_real *point = c->search.placement + 8;
  return fabs(c->search.placement[0]) > MG_CLEAR_GAPS * c->settings->start_gap * c->system->length &&
         mg_touch_at(c, feature_pair, point, point + 3, part);
}

MG_INTERNAL int mg_is_between_far_sides(mg_context *c, int feature_pair, const mg_real *eta) {
  const mg_real length = fabs(c->search.placement[0]), touching = c->settings->start_gap * c->system->length;
  if (!(c->search.placement[0] < -touching)) return 0;
  if (!mg_has_surfaces(c, c->system->feature_pair_owner[feature_pair])) return 0;
  const int leaves[2] = {mg_leaves_body_at_once(c, feature_pair, 0, eta),
                         mg_leaves_body_at_once(c, feature_pair, 1, eta)};
  if (leaves[0] && leaves[1])
    return !mg_does_curve_come_out(c, feature_pair, 0) && !mg_does_curve_come_out(c, feature_pair, 1);
  mg_real part[2];
  for (int side = 0; side < 2; side++)
    part[side] = leaves[side] ? 0 : mg_min(mg_part_in_body(c, feature_pair, side, eta), (mg_real)1);
  if (leaves[0] || leaves[1]) {
    const int is_reached = part[1 - leaves[1]] == 1;
    return !(is_reached && !mg_touch_between(c, feature_pair, leaves[1])) &&
           !mg_is_other_body_within(c, feature_pair, leaves[1], eta);
  }
  const mg_real both = part[0] + part[1] - 1;
  if (part[0] < 1 && part[1] < 1 && both * length <= touching) return 1;
  for (int k = 0; k < 3; k++)
    if (mg_touch_between(c, feature_pair, 1 - part[1] + both * k / 2)) return 1;
  return 0;
}
