/* Broad phase: the pairs of shapes whose bounding balls, each enlarged by how far it may move, overlap, and those of a
   plane that does not move, which each ball is tested against. Balls lie in a
   hierarchical grid: a ball is in one cell, as wide as its diameter or more, of the level of its size, and meets balls
   of its level or a coarser one in the 27 cells around it alone (Ericson, Real-Time Collision Detection, 2005, section
   7.2). The work grows with the number of balls and of overlaps. Reads c->bodies; writes c->listed. */
#include "model/model.h"
#include "base/base.h"

enum {
  MG_GRID_LEVELS = 60, /* levels of cells, each twice as wide as the one before */
  MG_GRID_BITS = 50    /* bits of a coordinate of a cell */
};

MG_INTERNAL void mg_ball_centre(const mg_context *c, int ball, mg_real *centre) {
  mg_to_world(c->bodies.pose + 12 * c->system->ball_body[ball], c->system->ball + 4 * ball, 1, centre);
}

MG_INTERNAL mg_real mg_ball_movement(const mg_context *c, int ball) {
  const mg_real *before = c->run->ball_at + 4 * ball;
  mg_real centre[3];
  mg_ball_centre(c, ball, centre);
  const mg_real span[3] = {centre[0] - before[0], centre[1] - before[1], centre[2] - before[2]};
  return sqrt(mg_dot3(span, span));
}

MG_INTERNAL int mg_has_moved_beyond_margins(const mg_context *c) {
  for (int b = 0; b < c->system->n_ball && c->listed.has_candidates; b++)
    if (c->system->ball[4 * b + 3] >= 0 && !(mg_ball_movement(c, b) <= c->run->ball_at[4 * b + 3])) return 1;
  return 0;
}

/* Exponent of the least power of two that is not below a positive number. */
static int mg_exponent(mg_real value) {
  int exponent;
  return value > 0 && value <= MG_MAX ? (frexp((double)value, &exponent), exponent) : -1000;
}

/* Radius of a ball with its margin and a half of the reach of searches, which is that of a pair of two such balls; < 0:
   unbounded. */
static mg_real mg_enlarged_radius(const mg_context *c, int ball) {
  const mg_real radius = c->system->ball[4 * ball + 3];
  return radius < 0
             ? -1
             : radius + c->settings->search_gap * mg_max(radius, c->system->length) / 2 + c->run->ball_at[4 * ball + 3];
}

/* Places all balls with a margin of the run; returns the lowest level, and in *levels a bit for each level in use. */
static int mg_place_balls(mg_context *c, unsigned long long *levels) {
  const mg_system *s = c->system;
  int highest = -1000, farthest = -1000, lowest = 1000;
  for (int b = 0; b < s->n_ball; b++) {
    mg_grid_ball *ball = c->listed.balls + b;
    mg_ball_centre(c, b, ball->centre);
    ball->radius = mg_enlarged_radius(c, b);
    if (ball->radius < 0) continue;
    ball->level = mg_exponent(2 * ball->radius);
    if (ball->level > highest) highest = ball->level;
    if (ball->level < lowest) lowest = ball->level;
    for (int k = 0; k < 3; k++)
      if (mg_exponent(fabs(ball->centre[k])) > farthest) farthest = mg_exponent(fabs(ball->centre[k]));
  }
  if (lowest < highest - MG_GRID_LEVELS) lowest = highest - MG_GRID_LEVELS;
  if (lowest < farthest - MG_GRID_BITS) lowest = farthest - MG_GRID_BITS;
  *levels = 0;
  for (int b = 0; b < s->n_ball; b++) {
    mg_grid_ball *ball = c->listed.balls + b;
    if (ball->radius < 0) continue;
    ball->level = ball->level > lowest ? ball->level - lowest : 0;
    *levels |= 1ull << ball->level;
  }
  return lowest;
}

/* Cell of a level that holds a point. */
static void mg_cell_of(const mg_real *point, int exponent, long long *cell) {
  for (int k = 0; k < 3; k++) cell[k] = (long long)floor(ldexp((double)point[k], -exponent));
}

static unsigned mg_hash_cell(const mg_context *c, const long long *cell, int level) {
  unsigned long long mixed = (unsigned long long)cell[0] * 0x9E3779B97F4A7C15ull;
  mixed = (mixed ^ (mixed >> 29) ^ (unsigned long long)cell[1]) * 0xBF58476D1CE4E5B9ull;
  mixed = (mixed ^ (mixed >> 32) ^ (unsigned long long)cell[2]) * 0x94D049BB133111EBull;
  mixed = (mixed ^ (mixed >> 29) ^ (unsigned long long)level) * 0x9E3779B97F4A7C15ull;
  return (unsigned)(mixed >> 40) & (unsigned)(mg_grid_size(c->system) - 1);
}

MG_INTERNAL int mg_grid_size(const mg_system *s) {
  int size = 1;
  while (size < 2 * s->n_ball) size *= 2;
  return size;
}

/* Puts the balls into the grid. */
static void mg_fill_grid(mg_context *c, int lowest) {
  for (int k = 0; k < mg_grid_size(c->system); k++) c->listed.grid[k] = -1;
  for (int b = 0; b < c->system->n_ball; b++) {
    mg_grid_ball *ball = c->listed.balls + b;
    if (ball->radius < 0) continue;
    mg_cell_of(ball->centre, lowest + ball->level, ball->cell);
    int *head = c->listed.grid + mg_hash_cell(c, ball->cell, ball->level);
    ball->next = *head, *head = b;
  }
}

/* Appends the pairs of shapes of two balls to those found. */
static void mg_note_meeting_balls(mg_context *c, int a, int b) {
  const mg_system *s = c->system;
  const int small = a < b ? a : b, large = a < b ? b : a;
  int low = s->ball_partner_begin[small], high = s->ball_partner_begin[small + 1];
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (s->ball_partner[middle] < large) low = middle + 1;
    else high = middle;
  }
  const int first = low, end = s->ball_partner_begin[small + 1];
  for (; low < end && s->ball_partner[low] == large; low++)
    if (s->ball_pair[low] >= 0 && mg_may_be_far(c, s->ball_pair[low]))
      c->listed.found[c->listed.n_found++] = s->ball_pair[low];
  const int slot = low > first ? -1 : mg_slot_for_balls(c, small, large);
  if (slot >= 0) c->listed.found[c->listed.n_found++] = slot;
}

/* Finds the balls of one cell that overlap a ball; of its own level those with a larger number. */
static void mg_search_cell(mg_context *c, int b, const long long *cell, int level) {
  const mg_grid_ball *ball = c->listed.balls + b;
  for (int k = c->listed.grid[mg_hash_cell(c, cell, level)]; k >= 0; k = c->listed.balls[k].next) {
    const mg_grid_ball *other = c->listed.balls + k;
    if (other->level != level || (level == ball->level && k <= b)) continue;
    if (other->cell[0] != cell[0] || other->cell[1] != cell[1] || other->cell[2] != cell[2]) continue;
    const mg_real span[3] = {other->centre[0] - ball->centre[0], other->centre[1] - ball->centre[1],
                             other->centre[2] - ball->centre[2]};
    const mg_real reach = ball->radius + other->radius;
    if (mg_dot3(span, span) <= reach * reach) mg_note_meeting_balls(c, b, k);
  }
}

/* Finds the balls of one level that overlap a ball. */
static void mg_search_level(mg_context *c, int b, int level, int lowest) {
  long long middle[3], cell[3];
  mg_cell_of(c->listed.balls[b].centre, lowest + level, middle);
  for (int k = 0; k < 27; k++) {
    cell[0] = middle[0] + k % 3 - 1, cell[1] = middle[1] + k / 3 % 3 - 1, cell[2] = middle[2] + k / 9 - 1;
    mg_search_cell(c, b, cell, level);
  }
}

/* True if a ball with its margin comes within reach of a plane. */
static int mg_is_ball_near_plane(const mg_context *c, int pair) {
  const mg_system *s = c->system;
  const int first = s->pair_feature_pair[pair], side = mg_unbounded_side(c, pair),
            ball = mg_ball_of_pair(c, pair, 1 - side);
  const mg_real *pose = c->bodies.pose + 12 * mg_feature_body(c, first, side),
                *place = mg_feature_numbers(c, first, side) + MG_FEATURE_PLACEMENT;
  mg_real centre[3], foot[3], normal[3];
  mg_ball_centre(c, ball, centre);
  mg_to_world(pose, place, 1, foot), mg_to_world(pose, place + 9, 0, normal);
  const mg_real span[3] = {centre[0] - foot[0], centre[1] - foot[1], centre[2] - foot[2]};
  const mg_real height = (mg_real)mg_shape_kind_of(c, first, side)->flat * mg_dot3(span, normal);
  return height <= s->ball[4 * ball + 3] + c->run->ball_at[4 * ball + 3] + mg_search_reach(c, pair);
}

MG_INTERNAL void mg_find_near_pairs(mg_context *c) {
  MG_NEEDS_ANY(c, MG_VALID_POSES);
  unsigned long long levels;
  const int lowest = mg_place_balls(c, &levels);
  mg_fill_grid(c, lowest), mg_open_slots(c);
  c->listed.n_found = 0;
  for (int b = 0; b < c->system->n_ball; b++)
    for (int level = c->listed.balls[b].level; c->listed.balls[b].radius >= 0 && levels >> level; level++)
      if (levels >> level & 1) mg_search_level(c, b, level, lowest);
  for (int k = 0; k < c->listed.n_over_plane; k++)
    if (mg_is_ball_near_plane(c, c->listed.over_plane[k]))
      c->listed.found[c->listed.n_found++] = c->listed.over_plane[k];
  mg_sort_ints(c->listed.n_found, c->listed.found);
}
