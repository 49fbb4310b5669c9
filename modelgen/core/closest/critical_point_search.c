/* Critical points of the distance of a feature pair: the trees of cells of both features are walked together; pairs of
   cells that cannot hold one are dropped, pairs that hold at most one start Newton's method, all others are divided.
   Where cells can be divided no further, or too many are open, the search is incomplete, and says so. A plane, a
   sphere and a vertex need no cells; a torus and a cylinder are seen as their spines. Writes c->search. */
#include "closest/closest.h"
#include "base/base.h"
#include "model/model.h"

#define MG_FLAT_CELLS 8   /* cells across flat features that are parallel, whose closest points form a region */
#define MG_OPEN_CELLS 256 /* cells of search_gap over this show how far critical points are that were not found */

/* A search of one feature pair. Side `first` has cells; views are in the axes of its shape. */
typedef struct {
  mg_context *c;
  int feature_pair;
  int first;                         /* side whose cells are A: 0 or 1 */
  int has_cells;                     /* 1: the other side has cells too */
  mg_search_limits limits;           /* gaps of interest */
  mg_real smallest;                  /* m: cells with smaller radii are not divided */
  mg_real rotation[9];               /* from the axes of the other shape to those of the first */
  mg_real origin[3];                 /* origin of the other shape, axes of the first, m */
  mg_cell_view other;                /* the other side, if it has no cells */
  int curves;                        /* bit 0: the first feature is seen as a curve, bit 1: the other */
  int is_centred[2];                 /* 1: the first, the other feature is seen as its spine */
  mg_spine centre[2];                /* that curve; tube is 0 where there is none */
  mg_feature_limits allowed[2];      /* coordinates of the first and of the other side */
  int n_known;                       /* critical points known; the one found last is behind them */
  mg_real known[MG_CRITICAL + 1][6]; /* their points on the first and the other feature, axes of the first shape, m */
  mg_real known_uv[MG_CRITICAL + 1][4];  /* their coordinates on both; MG_MAX where eta does not hold them */
  mg_real known_out[MG_CRITICAL + 1][3]; /* exterior normal of the first feature there, against that of the other */
  int seen[2];                           /* cells of both features looked at last; -1: none */
  mg_cell_view view[2];                  /* their views */
  int is_beyond[2];                      /* 1: they lie where no contact is allowed */
  mg_real best_merit; /* m: distance of the middles of the likeliest pair of cells, and mismatch of directions */
  int best[2];        /* its cells */
  mg_real least;      /* m: minima with smaller gaps are dropped */
  mg_minima *kept;
} mg_critical_search;

/* Sets the view of a side without cells: a plane, a sphere as its centre, or a vertex. */
static void mg_set_closed_view(mg_critical_search *s) {
  mg_context *c = s->c;
  const int side = 1 - s->first;
  const mg_shape_kind *kind = mg_shape_kind_of(c, s->feature_pair, side);
  const mg_real zero[2] = {0, 0};
  mg_sample base;
  mg_sample_at(c, s->feature_pair, side, zero, &base);
  mg_cell_view *view = &s->other;
  view->cell = 0, view->rotation = 0, view->radius = view->spread = view->tube = view->rest = 0;
  for (int k = 0; k < 3; k++) view->slope[0][k] = view->slope[1][k] = 0;
  view->kind = kind->nearest_point == MG_NEAREST_PLANE ? MG_VIEW_PLANE : MG_VIEW_POINT;
  mg_real shape_axes[9];
  mg_shape_rotation(c, s->feature_pair, s->first, shape_axes);
  mg_rotate_back(shape_axes, base.direction, view->direction);
  mg_point_in_shape_axes(c, s->feature_pair, s->first, base.point, view->centre);
  if (kind->nearest_point != MG_NEAREST_SPHERE) return;
  const mg_real span[3] = {view->centre[0] - s->origin[0], view->centre[1] - s->origin[1],
                           view->centre[2] - s->origin[2]};
  const mg_real radius = sqrt(mg_dot3(span, span));
  view->tube = mg_dot3(span, view->direction) < 0 ? -radius : radius;
  for (int k = 0; k < 3; k++) view->centre[k] = s->origin[k];
}

/* A point in the axes of the first shape, from those of the other; a vector, without `origin`. */
static void mg_turn_to_first_axes(const mg_critical_search *s, const mg_real *x, const mg_real *origin, mg_real *out) {
  const mg_real *R = s->rotation, y[3] = {x[0], x[1], x[2]};
  for (int k = 0; k < 3; k++) out[k] = (origin ? origin[k] : 0) + R[k] * y[0] + R[3 + k] * y[1] + R[6 + k] * y[2];
}

/* A cell of the first (0) or the other feature (1) as a view in the axes of the first shape. */
static void mg_view_cell(const mg_critical_search *s, int which, int cell, mg_cell_view *view) {
  if (which && !s->has_cells) {
    *view = s->other;
    return;
  }
  const mg_cell *at = s->c->search.cells + cell;
  view->kind = s->curves & (1 << which) ? MG_VIEW_CURVE : MG_VIEW_SURFACE, view->cell = at;
  view->rotation = which ? s->rotation : 0;
  view->radius = at->radius, view->spread = at->spread, view->tube = s->centre[which].tube, view->rest = at->rest;
  if (which) {
    mg_turn_to_first_axes(s, at->centre, s->origin, view->centre);
    mg_turn_to_first_axes(s, at->direction, 0, view->direction);
    for (int a = 0; a < 2; a++) mg_turn_to_first_axes(s, at->slope[a], 0, view->slope[a]);
    return;
  }
  for (int k = 0; k < 3; k++) {
    view->centre[k] = at->centre[k], view->direction[k] = at->direction[k];
    view->slope[0][k] = at->slope[0][k], view->slope[1][k] = at->slope[1][k];
  }
}

/* Squared distance of two points. */
static mg_real mg_square_distance(const mg_real *a, const mg_real *b) {
  const mg_real span[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  return mg_dot3(span, span);
}

/* True if a cell contains coordinates. Where a feature covers a place twice, its coordinates tell which. Coordinates
   far beyond the domain, as after a whole turn, tell nothing. */
static int mg_contains_coordinates(const mg_critical_search *s, int side, const mg_cell *cell, const mg_real *uv) {
  const mg_real *domain = mg_feature_numbers(s->c, s->feature_pair, side) + MG_FEATURE_DOMAIN;
  for (int k = 0; k < 2; k++) {
    const mg_real low = domain[2 * k], high = domain[2 * k + 1], far = high / 4 - low / 4;
    const mg_real *ends = cell->box + 2 * k, slack = (ends[1] - ends[0]) / 4, at = mg_min(mg_max(uv[k], low), high);
    if (uv[k] >= MG_MAX || fabs(uv[k] - at) > far) continue;
    if (at < ends[0] - slack || at > ends[1] + slack) return 0;
  }
  return 1;
}

/* True if the critical point `i` lies in both cells. Beyond its domain a chart may cover the same points from the other
   side. */
static int mg_is_critical_point_within(const mg_critical_search *s, int i, const mg_cell_view *a,
                                       const mg_cell_view *b) {
  if (a->kind == MG_VIEW_SURFACE && a->spread <= 1 && mg_dot3(s->known_out[i], a->direction) < 0) return 0;
  if (b->kind == MG_VIEW_SURFACE && b->spread <= 1 && mg_dot3(s->known_out[i], b->direction) > 0) return 0;
  if (mg_square_distance(s->known[i], a->centre) > a->radius * a->radius ||
      !mg_contains_coordinates(s, s->first, a->cell, s->known_uv[i]))
    return 0;
  return !s->has_cells || (mg_square_distance(s->known[i] + 3, b->centre) <= b->radius * b->radius &&
                           mg_contains_coordinates(s, 1 - s->first, b->cell, s->known_uv[i] + 2));
}

/* True if a known critical point lies in both cells. */
static int mg_is_critical_point_known(const mg_critical_search *s, const mg_cell_view *a, const mg_cell_view *b) {
  for (int i = 0; i < s->n_known; i++)
    if (mg_is_critical_point_within(s, i, a, b)) return 1;
  return 0;
}

/* Coordinates of a side in eta, where it has the entries from `at` on; MG_MAX where eta does not hold them. Returns the
   entries after its own. */
static const mg_real *mg_coordinates_in_eta(const mg_context *c, int feature_pair, int side, const mg_real *at,
                                            mg_real *uv) {
  const int parametrisation = mg_parametrisation(c, feature_pair, side),
            is_curve = parametrisation == MG_CURVE || parametrisation == MG_SIGNED_CURVE;
  const int n = parametrisation == MG_CHART ? 2 : is_curve;
  for (int k = 0; k < 2; k++) uv[k] = k < n ? at[k] : MG_MAX;
  return at + mg_parametrisation_size[parametrisation];
}

/* A world point on the first (0) or the other feature (1), or what stands for it on the spine, axes of the first
   shape. */
static void mg_point_of_view(const mg_critical_search *s, int which, const mg_real *world, mg_real *x) {
  if (!s->is_centred[which]) {
    mg_point_in_shape_axes(s->c, s->feature_pair, s->first, world, x);
    return;
  }
  mg_real local[3];
  mg_point_in_shape_axes(s->c, s->feature_pair, which ? 1 - s->first : s->first, world, local);
  mg_foot_on_spine(s->centre + which, local, x);
  if (which) mg_turn_to_first_axes(s, x, s->origin, x);
}

/* Keeps the points of the placement at eta as known; returns their number. One for which there is no room is found
   again in each cell about it, at the cost of effort. Needs that placement evaluated last. */
static int mg_add_known_point(mg_critical_search *s, const mg_real *eta) {
  MG_NEEDS_PLACEMENT(s->c, s->feature_pair, eta);
  const mg_real *placed = s->c->search.placement, *at = eta;
  const int number = s->n_known;
  for (int side = 0; side < 2; side++)
    at = mg_coordinates_in_eta(s->c, s->feature_pair, side, at, s->known_uv[number] + (side == s->first ? 0 : 2));
  mg_point_of_view(s, 0, placed + (s->first ? 11 : 8), s->known[number]);
  mg_point_of_view(s, 1, placed + (s->first ? 8 : 11), s->known[number] + 3);
  mg_real axes[9];
  mg_shape_rotation(s->c, s->feature_pair, s->first, axes);
  mg_rotate_back(axes, placed + 5, s->known_out[number]);
  for (int k = 0; k < 3 && s->first; k++) s->known_out[number][k] = -s->known_out[number][k];
  if (number < MG_CRITICAL) s->n_known++;
  return number;
}

/* Sample of a side in the middle of a cell; of a side without cells the point nearest to that of the first. */
static void mg_sample_cell(const mg_critical_search *s, int side, int cell, const mg_sample *nearby, mg_sample *at) {
  mg_context *c = s->c;
  if (side == s->first || s->has_cells) {
    const mg_real *box = c->search.cells[cell].box;
    const mg_real uv[2] = {box[0] + (box[1] - box[0]) / 2, box[2] + (box[3] - box[2]) / 2};
    mg_sample_at(c, s->feature_pair, side, uv, at);
    return;
  }
  mg_point_in_shape_axes(c, s->feature_pair, side, nearby->point, at->local);
  if (s->other.kind == MG_VIEW_PLANE) {
    at->local[2] = 0;
    return;
  }
  const mg_real size = sqrt(mg_dot3(at->local, at->local));
  for (int k = 0; k < 3 && size > 0; k++) at->local[k] *= fabs(s->other.tube) / size;
}

/* The same of a feature (0 the first, 1 the other) seen as its spine in the view `at`: the point of it towards
   the other view, or away from it in a hollow. */
static void mg_sample_about_centre(const mg_critical_search *s, int which, const mg_cell_view *at,
                                   const mg_cell_view *other, mg_sample *sample) {
  mg_context *c = s->c;
  const int side = which ? 1 - s->first : s->first, along = s->centre[which].coordinate;
  const mg_real *box = at->cell->box, sign = at->tube < 0 || other->tube < 0 ? -1 : 1;
  mg_real on_curve[3] = {at->centre[0], at->centre[1], at->centre[2]}, towards[3], x[3], in_body[3];
  if (other->kind == MG_VIEW_POINT) mg_critical_point_on_spine(s->centre + which, other->centre, at->centre, on_curve);
  for (int k = 0; k < 3; k++)
    towards[k] = other->kind == MG_VIEW_SURFACE || other->kind == MG_VIEW_PLANE
                     ? -other->direction[k]
                     : sign * (other->centre[k] - on_curve[k]);
  mg_normalise3(towards);
  for (int k = 0; k < 3; k++) x[k] = on_curve[k] + at->tube * towards[k] - (which ? s->origin[k] : 0);
  if (which) mg_rotate_back(s->rotation, x, x);
  mg_sample_about_spine(c, s->feature_pair, side, s->centre + which, x, sample);
  if (other->kind != MG_VIEW_POINT) sample->uv[along] = box[2 * along] + (box[2 * along + 1] - box[2 * along]) / 2;
  mg_to_world(mg_feature_numbers(c, s->feature_pair, side) + MG_FEATURE_PLACEMENT, x, 1, in_body);
  mg_to_world(c->bodies.pose + 12 * mg_feature_body(c, s->feature_pair, side), in_body, 1, sample->point);
}

/* Leaves gaps out of the limits that are larger than those of interest beside the nearest minimum kept. */
static void mg_leave_out_farther_gaps(mg_critical_search *s) {
  if (!s->kept->count) return;
  const mg_real most = mg_max(s->limits.all_within, fabs(s->kept->list[0].d));
  s->limits.gap = mg_min(s->limits.gap, most), s->limits.depth = mg_min(s->limits.depth, most);
}

/* Newton's method from eta. Of a surface of revolution two steps more: where a ball is almost on the axis, points on
   both sides of the closest one already satisfy the equations within the goal. Returns 0 if it does not converge. */
static int mg_converge_search(const mg_critical_search *s, mg_real *eta) {
  mg_context *c = s->c;
  mg_real next[6];
  if (mg_converge_from_any_start(c, s->feature_pair, eta) < 0) return 0;
  if (!mg_is_revolved(c, s->feature_pair, 0) && !mg_is_revolved(c, s->feature_pair, 1)) return 1;
  const int probe = c->system->n_contact, n = c->kernels->contact_kinds[c->contacts.kind[probe]].n_eta;
  for (int step = 0; step < 2; step++) {
    mg_place_contact(c, probe, eta, next);
    for (int k = 0; k < n; k++) eta[k] = next[k];
  }
  mg_place_contact(c, probe, eta, next);
  return 1;
}

enum { MG_NOT_CONVERGED = 0, MG_CONVERGED_ELSEWHERE = 1, MG_CONVERGED_WITHIN = 2 };

/* Converges from the middles of two cells and keeps what it finds, also where that lies elsewhere:
   MG_NOT_CONVERGED .. . */
static int mg_converge_from_cells(mg_critical_search *s, int a, int b) {
  mg_context *c = s->c;
  mg_sample at[2];
  mg_real eta[6] = {0};
  mg_cell_view A, B;
  mg_view_cell(s, 0, a, &A), mg_view_cell(s, 1, b, &B);
  if (s->is_centred[0]) mg_sample_about_centre(s, 0, &A, &B, at + s->first);
  else mg_sample_cell(s, s->first, a, 0, at + s->first);
  if (s->is_centred[1]) mg_sample_about_centre(s, 1, &B, &A, at + 1 - s->first);
  else mg_sample_cell(s, 1 - s->first, b, at + s->first, at + 1 - s->first);
  mg_start_eta(c, s->feature_pair, at, at + 1, eta);
  if (!mg_converge_search(s, eta)) return MG_NOT_CONVERGED;
  mg_note_singular_point(c, s->feature_pair, eta);
  const int found = mg_add_known_point(s, eta), is_within = mg_is_critical_point_within(s, found, &A, &B);
  mg_keep_minimum_at(c, s->feature_pair, eta, s->least, s->kept);
  mg_leave_out_farther_gaps(s);
  return is_within ? MG_CONVERGED_WITHIN : MG_CONVERGED_ELSEWHERE;
}

/* The points of contacts that are on the feature pair already. */
static void mg_add_followed_points(mg_critical_search *s) {
  mg_context *c = s->c;
  const int pair = c->system->feature_pair_owner[s->feature_pair];
  mg_real next[6];
  for (int k = mg_pair_first_contact(c, pair); k < mg_pair_first_contact(c, pair + 1); k++) {
    if (!mg_is_on_feature_pair(c, k) || c->run->feature_pair[k] != s->feature_pair) continue;
    mg_place_contact(c, k, mg_contact_eta(c, c->run->x, k), next);
    if (mg_is_placement_critical(c, k)) mg_add_known_point(s, mg_contact_eta(c, c->run->x, k));
  }
}

/* True if the first of two cells is to be divided: it contributes more to what keeps the pair open. */
static int mg_is_first_wider(const mg_critical_search *s, const mg_cell_view *a, const mg_cell_view *b) {
  if (!s->has_cells) return 1;
  if (!(a->radius < MG_MAX / 4) || !(b->radius < MG_MAX / 4)) return a->radius >= b->radius;
  if (a->radius > 4 * b->radius || b->radius > 4 * a->radius) return a->radius > b->radius;
  const mg_real size = a->radius + b->radius, spread = a->spread + b->spread;
  return (a->radius - b->radius) / (size > 0 ? size : 1) + (a->spread - b->spread) / (spread > 0 ? spread : 1) >= 0;
}

/* Squared distance of the middles of two cells. */
static mg_real mg_middles_apart(const mg_critical_search *s, int a, int b) {
  const mg_cell *cells = s->c->search.cells;
  mg_real other[3];
  if (s->has_cells) mg_turn_to_first_axes(s, cells[b].centre, s->origin, other);
  return mg_square_distance(cells[a].centre, s->has_cells ? other : s->other.centre);
}

/* Divides one of two cells and puts both pairs on the list, the nearer one at the end, which is looked at first.
   Returns the length of the list; unchanged if there is no room. */
static int mg_divide_pair(mg_critical_search *s, int a, int b, int is_first_wider, int count) {
  mg_context *c = s->c;
  const int side = is_first_wider ? s->first : 1 - s->first;
  const int half = mg_divide_cell(c, s->feature_pair, side, is_first_wider ? a : b);
  if (!half || count + 2 > MG_CELL_PAIRS) return count;
  int *pair = c->search.cell_pairs + 2 * count;
  for (int k = 0; k < 2; k++)
    pair[2 * k] = is_first_wider ? half + k : a, pair[2 * k + 1] = is_first_wider ? b : half + k;
  if (s->limits.all_within < MG_MAX && mg_middles_apart(s, pair[0], pair[1]) < mg_middles_apart(s, pair[2], pair[3]))
    for (int k = 0; k < 2; k++) {
      const int kept = pair[k];
      pair[k] = pair[2 + k], pair[2 + k] = kept;
    }
  return count + 2;
}

/* Remembers the pair of cells that is the likeliest to hold closest points: the start of Newton's method if the search
   has to be given up. */
static void mg_remember_likeliest(mg_critical_search *s, int a, int b, const mg_cell_view *A, const mg_cell_view *B) {
  const mg_real cosine = mg_dot3(A->direction, B->direction), distance = sqrt(mg_square_distance(A->centre, B->centre));
  const int surfaces = (A->kind == MG_VIEW_SURFACE) + (B->kind == MG_VIEW_SURFACE);
  const mg_real mismatch = B->kind == MG_VIEW_POINT ? 0 : surfaces == 2 ? 1 + cosine : surfaces == 1 ? fabs(cosine) : 0;
  const mg_real merit = distance + s->c->system->length * mismatch;
  if (merit < s->best_merit) s->best_merit = merit, s->best[0] = a, s->best[1] = b;
}

/* Lower bound of the distance of points of two cells. */
static mg_real mg_least_distance(const mg_cell_view *a, const mg_cell_view *b) {
  const mg_real span[3] = {b->centre[0] - a->centre[0], b->centre[1] - a->centre[1], b->centre[2] - a->centre[2]};
  const mg_real both = a->radius + b->radius, distance = sqrt(mg_dot3(span, span));
  const mg_real tube = a->tube + b->tube;
  if (b->kind == MG_VIEW_PLANE) return -mg_dot3(b->direction, span) - tube - both;
  return (a->tube < 0 || b->tube < 0 ? -tube - distance : distance - tube) - both;
}

/* Lower bound of the distance of points of two cells along a unit vector; both are bounded, neither is a hollow. */
static mg_real mg_least_distance_along(const mg_cell_view *a, const mg_cell_view *b, const mg_real *w) {
  const mg_real v[3] = {b->centre[0] - a->centre[0], b->centre[1] - a->centre[1], b->centre[2] - a->centre[2]};
  return fabs(mg_dot3(v, w)) - mg_extent_along(a, w) - mg_extent_along(b, w) - a->tube - b->tube;
}

/* The better one of such bounds. */
static mg_real mg_best_least_distance(const mg_cell_view *a, const mg_cell_view *b) {
  mg_real least = mg_least_distance(a, b);
  mg_real v[3] = {b->centre[0] - a->centre[0], b->centre[1] - a->centre[1], b->centre[2] - a->centre[2]};
  if (least > 0 || b->kind == MG_VIEW_PLANE || a->tube < 0 || b->tube < 0 || !(a->radius + b->radius < MG_MAX / 4))
    return least;
  if (mg_normalise3(v)) least = mg_max(least, mg_least_distance_along(a, b, v));
  if (a->kind == MG_VIEW_SURFACE) least = mg_max(least, mg_least_distance_along(a, b, a->direction));
  if (b->kind == MG_VIEW_SURFACE) least = mg_max(least, mg_least_distance_along(a, b, b->direction));
  return least;
}

/* Looks at a cell of the first (0) or the other feature (1). */
static void mg_look_at_cell(mg_critical_search *s, int which, int cell) {
  if (s->seen[which] == cell) return;
  s->seen[which] = cell;
  s->is_beyond[which] = (!which || s->has_cells) && mg_is_cell_beyond(s->c, cell, s->allowed + which);
  mg_view_cell(s, which, cell, s->view + which);
}

/* Looks at a pair of cells. */
static void mg_look_at_pair(mg_critical_search *s, int a, int b) {
  s->c->run->search_effort++;
  mg_look_at_cell(s, 0, a), mg_look_at_cell(s, 1, b);
}

/* True if two cells are small enough for their bends to tell something. */
static int mg_are_bends_of_use(const mg_cell_view *a, const mg_cell_view *b) {
  return a->radius + b->radius < MG_MAX / 4 && a->spread + b->spread <= 1;
}

/* Whether the cells looked at last can hold critical points, by their bends. */
static int mg_judge_bends(mg_critical_search *s, int a, int b) {
  mg_bound_bends(s->c, s->feature_pair, s->first, a);
  if (s->has_cells) mg_bound_bends(s->c, s->feature_pair, 1 - s->first, b);
  return mg_judge_cells(s->view, s->view + 1, &s->limits);
}

/* Whether two cells can hold critical points. */
static int mg_judge_pair(mg_critical_search *s, int a, int b) {
  const mg_cell_view *A = s->view, *B = s->view + 1;
  mg_look_at_pair(s, a, b);
  if (s->is_beyond[0] || s->is_beyond[1] || mg_are_cells_apart(A, B, &s->limits)) return MG_CELLS_APART;
  return mg_are_bends_of_use(A, B) ? mg_judge_bends(s, a, b) : MG_CELLS_OPEN;
}

/* Treats one pair of cells; returns the length of the list of open pairs. */
static int mg_treat_cells(mg_critical_search *s, int a, int b, int count, int *is_complete) {
  const mg_cell_view *A = s->view, *B = s->view + 1;
  const int verdict = mg_judge_pair(s, a, b);
  if (verdict == MG_CELLS_APART) return count;
  mg_remember_likeliest(s, a, b, A, B);
  const int is_small = A->radius + B->radius <= s->smallest;
  if (verdict == MG_CELLS_SINGLE && mg_is_critical_point_known(s, A, B)) return count;
  if (verdict == MG_CELLS_REGULAR || is_small) {
    if (mg_is_critical_point_known(s, A, B)) return count;
    if (mg_converge_from_cells(s, a, b) >= (is_small ? MG_CONVERGED_ELSEWHERE : MG_CONVERGED_WITHIN)) return count;
    if (is_small) {
      const mg_real gap = mg_best_least_distance(A, B);
      if (gap >= -s->smallest) mg_note_open_gap(s->c, gap);
      return count;
    }
  }
  const int longer = mg_divide_pair(s, a, b, mg_is_first_wider(s, A, B), count);
  if (longer == count) {
    *is_complete = 0;
    if (!mg_is_critical_point_known(s, A, B)) mg_converge_from_cells(s, a, b);
  }
  return longer;
}

/* True if a condition on the tilt against the plane fails, so that no point of the feature is a contact. */
static int mg_is_flat_against_plane(mg_critical_search *s) {
  mg_context *c = s->c;
  const mg_system *system = c->system;
  const int probe = mg_use_probe_contact(c, s->feature_pair);
  int is_placed = 0;
  for (int k = system->feature_pair_condition[s->feature_pair]; k < system->feature_pair_condition[s->feature_pair + 1];
       k++) {
    if (system->condition_kind[k] != MG_CONDITION_TILT || system->condition_feature_pair[k] == MG_BEYOND_WATCHED)
      continue;
    const mg_real *window = mg_feature_numbers(c, s->feature_pair, s->first) + MG_FEATURE_DOMAIN;
    mg_real eta[6] = {window[0], window[2], 0, 0, 0, 0}, next[6];
    if (!is_placed++) mg_place_contact(c, probe, eta, next);
    if (mg_feature_pair_condition(c, s->feature_pair, k, eta) < -c->settings->feature_border) return 1;
  }
  return 0;
}

/* First cells of both sides. Where little room is left for others, all are forgotten before. Returns 0 if there is no
   room. */
static int mg_plant_roots(mg_critical_search *s, int *root) {
  mg_context *c = s->c;
  if (*c->search.n_cells > c->system->n_cell / 4 * 3) mg_forget_cells(c);
  s->seen[0] = s->seen[1] = -1;
  root[0] = mg_root_cell(c, s->feature_pair, s->first, s->is_centred[0]);
  root[1] = s->has_cells ? mg_root_cell(c, s->feature_pair, 1 - s->first, s->is_centred[1]) : 0;
  return root[0] && (root[1] || !s->has_cells);
}

/* True if two features, one of them a surface, lie in planes across axes of their shapes that are parallel: then no
   critical point is isolated. */
static int mg_are_parallel_and_flat(const mg_critical_search *s, const int *root) {
  const mg_cell *a = s->c->search.cells + root[0], *b = s->c->search.cells + root[1];
  if (!s->has_cells || s->is_centred[0] || s->is_centred[1] || s->curves == 3) return 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      const mg_real cosine = s->rotation[3 * j + i], border = s->c->settings->feature_border;
      if (a->extent[i] == 0 && b->extent[j] == 0 && 1 - cosine * cosine <= border * border + 16 * MG_EPS) return 1;
    }
  return 0;
}

/* Lower bound of the gap at critical points that the search has not found, from cells no smaller than `size`; -MG_MAX
   if it cannot be given. */
static mg_real mg_bound_gap_by_cells(mg_critical_search *s, const int *root, mg_real size) {
  mg_context *c = s->c;
  const mg_cell_view *A = s->view, *B = s->view + 1;
  mg_real least = MG_MAX;
  int count = 1;
  c->search.cell_pairs[0] = root[0], c->search.cell_pairs[1] = root[1];
  for (long looked = 0; count > 0; looked++) {
    const int *pair = c->search.cell_pairs + 2 * --count, a = pair[0], b = pair[1];
    if (looked >= s->limits.effort || mg_is_search_stopped(c)) return -MG_MAX;
    const int verdict = mg_judge_pair(s, a, b);
    if (verdict == MG_CELLS_APART || (verdict != MG_CELLS_OPEN && mg_is_critical_point_known(s, A, B))) continue;
    if (A->radius + B->radius <= size) {
      least = mg_min(least, mg_least_distance(A, B));
      continue;
    }
    const int longer = mg_divide_pair(s, a, b, mg_is_first_wider(s, A, B), count);
    if (longer == count) return -MG_MAX;
    count = longer;
  }
  return least;
}

/* The same from cells that are divided until they are small beside the gap, or as small as they may be. */
static mg_real mg_bound_open_gap(mg_critical_search *s, const int *root) {
  const mg_real reach = mg_search_reach(s->c, s->c->system->feature_pair_owner[s->feature_pair]);
  mg_real least = -MG_MAX, last = 0;
  for (mg_real size = reach; size * MG_OPEN_CELLS >= reach && least < 8 * size && last > -MG_MAX; size /= 4)
    last = mg_bound_gap_by_cells(s, root, size), least = mg_max(least, last);
  return least;
}

/* Prepares the search of a feature pair. */
static mg_critical_search mg_begin_critical_search(mg_context *c, int feature_pair, const mg_search_limits *limits,
                                                   mg_real least, mg_minima *kept) {
  mg_critical_search s = {
      .c = c, .feature_pair = feature_pair, .limits = *limits, .least = least, .kept = kept, .best_merit = MG_MAX};
  s.first = mg_has_nearest_point(c, feature_pair, 0);
  s.has_cells = !mg_has_nearest_point(c, feature_pair, 1 - s.first);
  mg_limit_feature(c, feature_pair, s.first, s.allowed);
  mg_limit_feature(c, feature_pair, 1 - s.first, s.allowed + 1);
  for (int which = 0; which < 2; which++) mg_limit_to_meridian(c, feature_pair, s.allowed + which);
  s.smallest = c->settings->search_merge_distance * mg_pair_length(c, c->system->feature_pair_owner[feature_pair]) / 4;
  for (int which = 0; which < 2; which++) {
    const int side = which ? 1 - s.first : s.first;
    s.is_centred[which] = (!which || s.has_cells) && mg_is_about_spine(c, feature_pair, side);
    if (s.is_centred[which]) mg_read_spine(c, feature_pair, side, s.centre + which);
    s.curves |= (s.is_centred[which] || mg_feature_dimension(c, feature_pair, side) == 1) << which;
  }
  mg_real own[9], others[9];
  mg_shape_rotation(c, feature_pair, s.first, own), mg_shape_rotation(c, feature_pair, 1 - s.first, others);
  for (int k = 0; k < 3; k++) mg_rotate_back(own, others + 3 * k, s.rotation + 3 * k);
  const mg_real *pose = c->bodies.pose + 12 * mg_feature_body(c, feature_pair, 1 - s.first);
  mg_real origin[3];
  mg_to_world(pose, mg_feature_numbers(c, feature_pair, 1 - s.first) + MG_FEATURE_PLACEMENT, 1, origin);
  mg_point_in_shape_axes(c, feature_pair, s.first, origin, s.origin);
  if (!s.has_cells) mg_set_closed_view(&s);
  return s;
}

MG_INTERNAL int mg_search_critical_points(mg_context *c, int feature_pair, const mg_search_limits *limits,
                                          mg_real least, mg_minima *kept) {
  mg_critical_search s = mg_begin_critical_search(c, feature_pair, limits, least, kept);
  int is_complete = 1, count = 1, root[2];
  if (s.other.kind == MG_VIEW_PLANE && !s.has_cells && mg_is_flat_against_plane(&s)) return 1;
  if (!mg_plant_roots(&s, root)) return 0;
  if (mg_are_parallel_and_flat(&s, root))
    s.smallest = mg_min(c->search.cells[root[0]].radius, c->search.cells[root[1]].radius) / MG_FLAT_CELLS;
  mg_add_followed_points(&s);
  mg_leave_out_farther_gaps(&s);
  c->search.cell_pairs[0] = root[0], c->search.cell_pairs[1] = root[1];
  for (long looked = 0; count > 0; looked++) {
    const int *pair = c->search.cell_pairs + 2 * --count;
    if (mg_is_search_stopped(c)) return 0;
    if (looked < s.limits.effort) count = mg_treat_cells(&s, pair[0], pair[1], count, &is_complete);
    else is_complete = 0, mg_converge_from_cells(&s, pair[0], pair[1]);
  }
  if (is_complete) return 1;
  if (s.best[0]) mg_converge_from_cells(&s, s.best[0], s.best[1]);
  const mg_real open_gap = mg_plant_roots(&s, root) ? mg_bound_open_gap(&s, root) : -MG_MAX;
  if (!(open_gap > 0)) return 0;
  mg_note_open_gap(c, open_gap);
  return 1;
}

MG_INTERNAL mg_real mg_bound_distance(mg_context *c, int feature_pair, mg_real small) {
  const mg_search_limits limits = {MG_MAX, MG_MAX, MG_LEAST_EFFORT, 0};
  mg_critical_search s = mg_begin_critical_search(c, feature_pair, &limits, 0, 0);
  mg_real least = MG_MAX;
  int count = 1, root[2];
  for (int which = 0; which < 2; which++)
    for (int k = 0; k < 3; k++) s.allowed[which].meridian[k] = 0;
  if (!mg_plant_roots(&s, root)) return 0;
  c->search.cell_pairs[0] = root[0], c->search.cell_pairs[1] = root[1];
  for (long looked = 0; count > 0; looked++) {
    const int *pair = c->search.cell_pairs + 2 * --count, a = pair[0], b = pair[1];
    mg_look_at_pair(&s, a, b);
    if (s.is_beyond[0] || s.is_beyond[1]) continue;
    const mg_real size = s.view[0].radius + s.view[1].radius, distance = mg_best_least_distance(s.view, s.view + 1);
    if (distance >= least) continue;
    const int is_fine = size <= mg_max(distance / 2, small) || looked >= s.limits.effort || mg_is_search_stopped(c),
              longer = is_fine ? count : mg_divide_pair(&s, a, b, mg_is_first_wider(&s, s.view, s.view + 1), count);
    if (longer == count) least = distance;
    count = longer;
  }
  return mg_max(least, (mg_real)0);
}

/* True if no points of the cells looked at last touch, but those of a minimum that is known: about it, where there is
   no other critical point, the gap grows. */
static int mg_do_cells_not_touch(mg_critical_search *s, int a, int b) {
  const mg_cell_view *A = s->view, *B = s->view + 1;
  if (s->is_beyond[0] || s->is_beyond[1] || mg_best_least_distance(A, B) > 0) return 1;
  if (!mg_are_bends_of_use(A, B) || !mg_is_critical_point_known(s, A, B)) return 0;
  const int verdict = mg_judge_bends(s, a, b);
  return verdict == MG_CELLS_SINGLE || verdict == MG_CELLS_REGULAR;
}

MG_INTERNAL int mg_are_features_apart(mg_context *c, int feature_pair, const mg_minima *found) {
  const mg_real reach = c->settings->start_gap * c->system->length;
  const mg_search_limits limits = {mg_max(found->list[0].d, reach), reach, MG_EFFORT, 0};
  mg_critical_search s = mg_begin_critical_search(c, feature_pair, &limits, 0, 0);
  mg_real next[6];
  int count = 1, root[2];
  if (s.centre[0].tube < 0 || s.centre[1].tube < 0 || !mg_plant_roots(&s, root)) return 0;
  for (int k = 0; k < found->count; k++) {
    if (found->list[k].feature_pair != feature_pair) continue;
    mg_place_contact(c, mg_use_probe_contact(c, feature_pair), found->list[k].eta, next);
    mg_add_known_point(&s, found->list[k].eta);
  }
  c->search.cell_pairs[0] = root[0], c->search.cell_pairs[1] = root[1];
  for (long looked = 0; count > 0; looked++) {
    const int *pair = c->search.cell_pairs + 2 * --count, a = pair[0], b = pair[1];
    if (looked >= s.limits.effort || mg_is_search_stopped(c)) return 0;
    mg_look_at_pair(&s, a, b);
    if (mg_do_cells_not_touch(&s, a, b)) continue;
    if (s.view[0].radius + s.view[1].radius <= s.smallest) return 0;
    const int longer = mg_divide_pair(&s, a, b, mg_is_first_wider(&s, s.view, s.view + 1), count);
    if (longer == count) return 0;
    count = longer;
  }
  return 1;
}
