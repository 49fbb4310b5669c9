/* Trees of cells of features: boxes of chart coordinates with bounds of points, normals or tangents, and curvature,
   by Taylor models; or with those of the spine of a torus or cylinder, in closed form. Cells are divided when a
   search asks for it, and are kept for the searches that follow, in the axes of the shape. Writes c->search. */
#include "closest/closest.h"
#include "base/base.h"
#include "model/model.h"

#define MG_NEAR_MIDDLE ((mg_real)0.5) /* place of a kink at which a cell is divided rather than in the middle */
#define MG_DIRECTION_BOUNDS 6         /* bounds of a feature: points and directions */
#define MG_CURVE_BOUNDS 9             /* of a curve with bends */
#define MG_SURFACE_BOUNDS 12          /* of a surface with bends */
#define MG_WIDE_SPREAD ((mg_real)1)   /* directions in a cell that is divided when its tree begins */
#define MG_WIDE_REST ((mg_real)0.5)   /* part of the radius that is not linear, in such a cell */
#define MG_WIDE_LEVELS 6              /* times that it is divided */

/* Norm of n numbers, `otherwise` where it is not finite. */
static mg_real mg_norm_or(int n, const mg_real *x, mg_real otherwise) {
  mg_real sum = 0;
  for (int k = 0; k < n; k++) sum += x[k] * x[k];
  return sum < MG_MAX ? sqrt(sum) : otherwise;
}

/* The same of a symmetric matrix given by its entries xx, yy, zz, xy, xz, yz. */
static mg_real mg_symmetric_norm(const mg_real *a) {
  mg_real sum = 0;
  for (int k = 0; k < 6; k++) sum += (k < 3 ? 1 : 2) * a[k] * a[k];
  return sum < MG_MAX ? sqrt(sum) : MG_MAX;
}

/* The first bounds of a feature over a box, as many as wanted. */
static void mg_bound_feature(mg_context *c, int feature_pair, int side, const mg_real *box, int wanted,
                             mg_taylor_model *out, mg_real *kink) {
  const mg_system *s = c->system;
  mg_bound_over_box(c->kernels->shape_bounds + s->feature_shape[2 * feature_pair + side], box,
                    s->parameters + s->feature_parameters[2 * feature_pair + side], wanted, c->search.bounds_memory,
                    out, kink);
}

/* True if three models have bounds. */
static int mg_has_bounds(const mg_taylor_model *x) {
  return x[0].rest < MG_MAX / 8 && x[1].rest < MG_MAX / 8 && x[2].rest < MG_MAX / 8;
}

/* Adds to `along` how much a vector changes with each coordinate over a cell, over `unit`. What is not linear counts
   for both coordinates by the given parts. */
static void mg_add_change(const mg_taylor_model *x, mg_real unit, const mg_real *part, mg_real *along) {
  mg_real square[2] = {0, 0}, rest = 0;
  for (int k = 0; k < 3; k++) {
    for (int a = 0; a < 2; a++) square[a] += x[k].slope[a] * x[k].slope[a];
    rest = mg_max(rest, x[k].rest);
  }
  for (int a = 0; a < 2; a++) along[a] += (rest < MG_MAX / 8 ? sqrt(square[a]) + rest * part[a] : part[a]) / unit;
}

/* True if a cell of a surface is wider along v, by its normals, and by its points against four characteristic
   lengths. At a pole, where the normals may have no bounds, the points alone tell that all u are near each other. */
static int mg_is_second_wider(const mg_context *c, int feature_pair, int side, const mg_real *box,
                              const mg_taylor_model *out) {
  const mg_real *scale = mg_feature_numbers(c, feature_pair, side) + MG_FEATURE_UV_SCALE;
  const mg_real along_u = (box[1] - box[0]) / scale[0], along_v = (box[3] - box[2]) / scale[1];
  const mg_real part[2] = {along_u / (along_u + along_v), along_v / (along_u + along_v)};
  mg_real along[2] = {0, 0};
  mg_add_change(out, 4 * c->system->length, part, along);
  if (mg_has_bounds(out + 3) || !mg_has_bounds(out)) mg_add_change(out + 3, 1, part, along);
  return along[1] > along[0];
}

/* Bounds of the points and directions in a cell, from its box. */
static void mg_bound_cell(mg_context *c, int feature_pair, int side, mg_cell *cell) {
  const int is_curve = mg_feature_dimension(c, feature_pair, side) == 1;
  mg_taylor_model out[MG_SURFACE_BOUNDS];
  mg_real change[3], rest[3], kink[2];
  mg_bound_feature(c, feature_pair, side, cell->box, MG_DIRECTION_BOUNDS, out, kink);
  for (int k = 0; k < 3; k++) {
    const mg_taylor_model *x = out + k;
    cell->centre[k] = x->middle, cell->direction[k] = out[3 + k].middle;
    cell->extent[k] = mg_taylor_change(x), change[k] = mg_taylor_change(out + 3 + k);
    cell->slope[0][k] = x->slope[0], cell->slope[1][k] = x->slope[1];
    rest[k] = fabs(x->bend[0]) + fabs(x->bend[1]) + fabs(x->bend[2]) + x->rest;
  }
  cell->radius = mg_norm_or(3, cell->extent, MG_MAX), cell->spread = mg_min(mg_norm_or(3, change, 2), (mg_real)2);
  cell->rest = mg_norm_or(3, rest, MG_MAX);
  if (is_curve) cell->radius /= mg_max(1 - cell->spread * cell->spread / 2, 1 / MG_MAX);
  if (!(cell->radius <= MG_MAX)) cell->radius = MG_MAX;
  if (!(cell->rest <= MG_MAX)) cell->rest = MG_MAX;
  cell->direction_to_divide = !is_curve && mg_is_second_wider(c, feature_pair, side, cell->box, out);
  const mg_real kink_at = kink[cell->direction_to_divide];
  cell->place_to_divide = fabs(kink_at) <= MG_NEAR_MIDDLE ? kink_at : 0;
}

MG_INTERNAL void mg_bound_bends(mg_context *c, int feature_pair, int side, int number) {
  const int is_curve = mg_feature_dimension(c, feature_pair, side) == 1;
  mg_cell *cell = c->search.cells + number;
  mg_taylor_model out[MG_SURFACE_BOUNDS] = {{0}};
  mg_real kink[2];
  if (cell->has_bends) return;
  cell->has_bends = 1;
  mg_bound_feature(c, feature_pair, side, cell->box, is_curve ? MG_CURVE_BOUNDS : MG_SURFACE_BOUNDS, out, kink);
  for (int k = 0; k < 6; k++) cell->bend[k] = out[6 + k].middle, cell->bend_change[k] = mg_taylor_change(out + 6 + k);
  cell->bend_size = is_curve ? mg_norm_or(3, cell->bend, MG_MAX) : mg_symmetric_norm(cell->bend);
  cell->bend_error = is_curve ? mg_norm_or(3, cell->bend_change, MG_MAX) : mg_symmetric_norm(cell->bend_change);
}

/* The same of the spine of a feature. Over an angle of 2 `half` of a circle, vectors that turn with it change by
   the chord of `half`, and points leave the tangent by half the curvature times the square of the arc; `radius` bounds
   the arc. */
static void mg_bound_spine_cell(mg_context *c, int feature_pair, int side, mg_cell *cell) {
  mg_spine curve;
  mg_read_spine(c, feature_pair, side, &curve);
  const mg_real *ends = cell->box + 2 * curve.coordinate, half = (ends[1] - ends[0]) / 2, middle = ends[0] + half;
  const mg_real turn = curve.kind == MG_SPINE_CIRCLE ? mg_min(half, MG_PI) : 0, chord = 2 * mg_sin(turn / 2);
  const mg_real e[2] = {mg_cos(middle), mg_sin(middle)};
  for (int k = 0; k < 3; k++) cell->centre[k] = cell->slope[0][k] = cell->slope[1][k] = cell->direction[k] = 0;
  for (int k = 0; k < 6; k++) cell->bend[k] = cell->bend_change[k] = 0;
  if (curve.kind == MG_SPINE_LINE) {
    cell->centre[2] = middle, cell->slope[0][2] = half, cell->direction[2] = 1;
    cell->radius = half, cell->rest = 0;
  } else {
    cell->direction[0] = -e[1], cell->direction[1] = e[0];
    cell->radius = curve.radius * turn, cell->rest = cell->radius * turn / 2;
    for (int k = 0; k < 2; k++) {
      cell->centre[k] = curve.radius * e[k], cell->slope[0][k] = cell->radius * cell->direction[k];
      cell->bend[k] = -e[k] / curve.radius, cell->bend_change[k] = chord / curve.radius;
    }
  }
  for (int k = 0; k < 3; k++) cell->extent[k] = cell->radius;
  cell->spread = chord;
  cell->bend_size = mg_norm_or(3, cell->bend, MG_MAX), cell->bend_error = mg_norm_or(3, cell->bend_change, MG_MAX);
  cell->direction_to_divide = curve.coordinate, cell->place_to_divide = 0;
}

/* A new cell, of the spine if `is_of_spine`; 0 if there is no room. */
static int mg_new_cell(mg_context *c, int feature_pair, int side, int is_of_spine, const mg_real *box) {
  if (*c->search.n_cells >= c->system->n_cell) return 0;
  mg_cell *cell = c->search.cells + *c->search.n_cells;
  for (int k = 0; k < 4; k++) cell->box[k] = box[k];
  cell->halves = 0, cell->is_of_spine = cell->has_bends = is_of_spine;
  if (is_of_spine) mg_bound_spine_cell(c, feature_pair, side, cell);
  else mg_bound_cell(c, feature_pair, side, cell);
  return (*c->search.n_cells)++;
}

MG_INTERNAL void mg_forget_cells(mg_context *c) {
  *c->search.n_cells = 1;
  for (int tree = 0; tree < 2 * c->system->n_cell_tree; tree++) c->search.tree_root[tree] = 0;
}

MG_INTERNAL mg_digest mg_digest_searched_shapes(const mg_system *s) {
  mg_digest digest = mg_digest_text(MG_DIGEST_START, s->kernels->hash);
  const int sizes[2] = {s->n_cell_tree, s->n_cell};
  digest = mg_digest_reals(mg_digest_ints(digest, sizes, 2), &s->length, 1);
  for (int k = 0, tree = 0; k < 2 * s->n_feature_pair && tree < s->n_cell_tree; k++) {
    if (s->feature_tree[k] != tree) continue;
    const int kind = s->feature_shape[k];
    const mg_real *numbers = s->numbers + s->feature_numbers[k];
    digest = mg_digest_reals(mg_digest_ints(digest, &kind, 1), s->parameters + s->feature_parameters[k],
                             s->kernels->shape_bounds[kind].n_parameters);
    digest = mg_digest_reals(digest, numbers + MG_FEATURE_DOMAIN, 4);
    digest = mg_digest_reals(digest, numbers + MG_FEATURE_UV_SCALE, 2);
    tree++;
  }
  return digest;
}

MG_INTERNAL void mg_keep_cells_of_same_shapes(mg_context *c) {
  const mg_system *s = c->system;
  mg_digest digest = MG_DIGEST_START;
  if (s->n_cell_tree) digest = s->shapes_digest ? s->shapes_digest : mg_digest_searched_shapes(s);
  if (*c->search.n_cells < 1 || *c->search.cells_digest != digest) mg_forget_cells(c);
  *c->search.cells_digest = digest;
}

/* Bound of |x - middle| over what half cells bound: points or directions from a middle of their own. */
static mg_real mg_bound_from(const mg_real *middle, const mg_real *own_middle, mg_real own_bound) {
  const mg_real span[3] = {own_middle[0] - middle[0], own_middle[1] - middle[1], own_middle[2] - middle[2]};
  return sqrt(mg_dot3(span, span)) + own_bound;
}

/* Bound of the distance of a half's points from the linear part of the whole cell. */
static mg_real mg_rest_from(const mg_cell *whole, const mg_cell *half, int is_upper) {
  const int a = whole->direction_to_divide;
  const mg_real end = is_upper ? 1 : -1, place = (whole->place_to_divide + end) / 2,
                width = (1 - end * whole->place_to_divide) / 2;
  mg_real middle[3], along[3], across[3];
  for (int k = 0; k < 3; k++) {
    middle[k] = half->centre[k] - whole->centre[k] - place * whole->slope[a][k];
    along[k] = half->slope[a][k] - width * whole->slope[a][k],
    across[k] = half->slope[1 - a][k] - whole->slope[1 - a][k];
  }
  return sqrt(mg_dot3(middle, middle)) + sqrt(mg_dot3(along, along)) + sqrt(mg_dot3(across, across)) + half->rest;
}

/* Replaces the bounds of points and directions of a divided cell by those of its halves where they are narrower. A
   curve's radius is one of its arc. */
static void mg_narrow_by_halves(mg_cell *whole, const mg_cell *half, int is_curve) {
  mg_real arc = 2 * mg_max(half[0].radius, half[1].radius), reach = 0, spread = 0, rest = 0, extent[3] = {0, 0, 0};
  if (whole->place_to_divide != 0) arc = 2 * (half[0].radius + half[1].radius);
  for (int k = 0; k < 2; k++) {
    reach = mg_max(reach, mg_bound_from(whole->centre, half[k].centre, half[k].radius));
    spread = mg_max(spread, mg_bound_from(whole->direction, half[k].direction, half[k].spread));
    rest = mg_max(rest, mg_rest_from(whole, half + k, k));
    for (int i = 0; i < 3; i++)
      extent[i] = mg_max(extent[i], fabs(half[k].centre[i] - whole->centre[i]) + half[k].extent[i]);
  }
  whole->radius = mg_min(whole->radius, is_curve ? arc : reach), whole->spread = mg_min(whole->spread, spread);
  whole->rest = mg_min(whole->rest, rest);
  for (int i = 0; i < 3; i++) whole->extent[i] = mg_min(whole->extent[i], extent[i]);
}

MG_INTERNAL int mg_divide_cell(mg_context *c, int feature_pair, int side, int cell) {
  if (c->search.cells[cell].halves) return c->search.cells[cell].halves;
  if (*c->search.n_cells + 2 > c->system->n_cell) return 0;
  const int along = c->search.cells[cell].direction_to_divide, is_of_spine = c->search.cells[cell].is_of_spine;
  mg_real box[4];
  for (int k = 0; k < 4; k++) box[k] = c->search.cells[cell].box[k];
  const mg_real low = box[2 * along], high = box[2 * along + 1], half = (high - low) / 2,
                middle = low + half + half * c->search.cells[cell].place_to_divide;
  box[2 * along + 1] = middle;
  const int first = mg_new_cell(c, feature_pair, side, is_of_spine, box);
  box[2 * along] = middle, box[2 * along + 1] = high;
  mg_new_cell(c, feature_pair, side, is_of_spine, box);
  return c->search.cells[cell].halves = first;
}

/* Divides a cell over which directions differ much, and its halves, and narrows its bounds by theirs: over wide boxes
   Taylor models bound poorly. What a cell bounds depends on its box alone, not on the searches before. */
static void mg_divide_wide_cell(mg_context *c, int feature_pair, int side, int cell, int levels) {
  const mg_cell *at = c->search.cells + cell;
  if (levels == 0 || (at->spread <= MG_WIDE_SPREAD && at->rest <= MG_WIDE_REST * at->radius)) return;
  const int half = mg_divide_cell(c, feature_pair, side, cell);
  if (!half) return;
  for (int k = 0; k < 2; k++) mg_divide_wide_cell(c, feature_pair, side, half + k, levels - 1);
  mg_narrow_by_halves(c->search.cells + cell, c->search.cells + half, mg_feature_dimension(c, feature_pair, side) == 1);
}

MG_INTERNAL int mg_root_cell(mg_context *c, int feature_pair, int side, int is_of_spine) {
  const mg_real *domain = mg_feature_numbers(c, feature_pair, side) + MG_FEATURE_DOMAIN;
  const int tree = c->system->feature_tree[2 * feature_pair + side], root = 2 * tree + is_of_spine;
  mg_real window[4], bound = 0;
  mg_sample_window(c, feature_pair, side, mg_search_radius(c, feature_pair, side), window);
  for (int k = 0; k < 4; k++)
    if (fabs(domain[k]) >= MG_MAX / 2) bound = mg_max(bound, fabs(window[k]));
  if (!(bound <= c->run->search_bound[tree])) c->run->search_bound[tree] = 2 * bound;
  bound = c->run->search_bound[tree];
  if (c->search.tree_root[root] && c->search.tree_bound[root] == bound) return c->search.tree_root[root];
  for (int k = 0; k < 4; k++)
    if (fabs(domain[k]) >= MG_MAX / 2) window[k] = k % 2 ? bound : -bound;
  c->search.tree_bound[root] = bound;
  const int first = c->search.tree_root[root] = mg_new_cell(c, feature_pair, side, is_of_spine, window);
  if (first && !is_of_spine) mg_divide_wide_cell(c, feature_pair, side, first, MG_WIDE_LEVELS);
  return first;
}

MG_INTERNAL void mg_limit_feature(const mg_context *c, int feature_pair, int side, mg_feature_limits *limits) {
  const mg_system *s = c->system;
  const mg_real slack = 8 * c->settings->feature_border,
                *scale = mg_feature_numbers(c, feature_pair, side) + MG_FEATURE_UV_SCALE;
  limits->feature_pair = feature_pair, limits->side = side;
  limits->meridian[0] = limits->meridian[1] = limits->meridian[2] = limits->off_plane = 0;
  limits->box[0] = limits->box[2] = -MG_MAX, limits->box[1] = limits->box[3] = limits->disc = MG_MAX;
  for (int k = s->feature_pair_condition[feature_pair]; k < s->feature_pair_condition[feature_pair + 1]; k++) {
    const mg_real *a = s->numbers + s->condition_numbers[k];
    if (s->condition_feature[k] != side || s->condition_feature_pair[k] == MG_BEYOND_WATCHED) continue;
    if (s->condition_kind[k] == MG_CONDITION_DISC) limits->disc = mg_min(limits->disc, a[0] * (1 + slack));
    if (s->condition_kind[k] != MG_CONDITION_PARAMETER) continue;
    mg_real *ends = limits->box + 2 * (int)a[0];
    if (a[1] > 0) ends[0] = mg_max(ends[0], a[2] - slack * scale[(int)a[0]] / a[1]);
    if (a[1] < 0) ends[1] = mg_min(ends[1], a[2] - slack * scale[(int)a[0]] / a[1]);
  }
}

MG_INTERNAL void mg_limit_to_meridian(const mg_context *c, int feature_pair, mg_feature_limits *limits) {
  const int side = limits->side;
  const mg_real *pose = c->bodies.pose + 12 * mg_feature_body(c, feature_pair, 1 - side);
  mg_real centre[3], x[3];
  if (!mg_is_revolved(c, feature_pair, side)) return;
  mg_to_world(pose, mg_feature_numbers(c, feature_pair, 1 - side) + MG_FEATURE_PLACEMENT, 1, centre);
  mg_point_in_shape_axes(c, feature_pair, side, centre, x);
  const mg_real off_axis = mg_hypot(x[0], x[1]);
  if (!(off_axis > 0)) return;
  limits->meridian[0] = -x[1] / off_axis, limits->meridian[1] = x[0] / off_axis;
  limits->off_plane = 64 * MG_EPS * (sqrt(mg_dot3(centre, centre)) + sqrt(mg_dot3(x, x))) / off_axis;
}

/* Upper bound of a quadric over the ball around a cell. */
static mg_real mg_quadric_over_cell(const mg_real *a, const mg_cell *cell) {
  const mg_real *x = cell->centre, r = cell->radius;
  const mg_real slope[3] = {a[1] + 2 * a[4] * x[0] + a[7] * x[1] + a[8] * x[2],
                            a[2] + 2 * a[5] * x[1] + a[7] * x[0] + a[9] * x[2],
                            a[3] + 2 * a[6] * x[2] + a[8] * x[0] + a[9] * x[1]};
  const mg_real bend = fabs(a[4]) + fabs(a[5]) + fabs(a[6]) + (fabs(a[7]) + fabs(a[8]) + fabs(a[9])) / 2;
  return mg_quadric_condition(a, x) + (sqrt(mg_dot3(slope, slope)) + bend * r) * r;
}

/* True if a quadric of the limits excludes all points of a cell of a feature itself. */
static int mg_is_cell_outside_quadrics(const mg_context *c, const mg_cell *cell, const mg_feature_limits *limits) {
  const mg_system *s = c->system;
  const mg_real slack = 8 * c->settings->feature_border * s->length;
  if (cell->is_of_spine || !(cell->radius < MG_MAX)) return 0;
  for (int k = s->feature_pair_condition[limits->feature_pair]; k < s->feature_pair_condition[limits->feature_pair + 1];
       k++) {
    const mg_real *quadric = mg_bounding_quadric(c, limits->side, k);
    if (quadric && mg_quadric_over_cell(quadric, cell) < -slack) return 1;
  }
  return 0;
}

/* True if all of a cell is off the plane of the critical points. */
static int mg_is_cell_off_meridian(const mg_cell *cell, const mg_feature_limits *limits) {
  const mg_real slack = limits->off_plane * sqrt(mg_dot3(cell->centre, cell->centre));
  return fabs(mg_dot3(limits->meridian, cell->centre)) > cell->radius + slack;
}

MG_INTERNAL int mg_is_cell_beyond(const mg_context *c, int cell, const mg_feature_limits *limits) {
  const mg_real *box = c->search.cells[cell].box, *inside = limits->box;
  if (mg_is_cell_off_meridian(c->search.cells + cell, limits)) return 1;
  if (box[1] < inside[0] || box[0] > inside[1] || box[3] < inside[2] || box[2] > inside[3]) return 1;
  if (mg_is_cell_outside_quadrics(c, c->search.cells + cell, limits)) return 1;
  if (!(limits->disc < MG_MAX)) return 0;
  const mg_real u = mg_max(mg_max(box[0], -box[1]), (mg_real)0), v = mg_max(mg_max(box[2], -box[3]), (mg_real)0);
  return u * u + v * v > limits->disc * limits->disc;
}
