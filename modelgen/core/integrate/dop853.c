/* Dormand and Prince's method of order 8(5,3) with dense output of order 7 (Hairer, Norsett and Wanner, Solving
   Ordinary Differential Equations I, second edition, section II.10). Reads c->step.slopes row 0, the slope at the
   start; writes slopes, c->step.end and c->step.interpolant. */
#include "integrate/integrate.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/dop853_coefficients.h"

#define MG_BLOCK 8 /* states treated together, with their sums in registers */

/* Before a loop over a block, within one of which the compiler does not know how often it runs: without it some keep
   the sums of a block in memory. */
#if defined(__GNUC__) && !defined(__clang__)
#define MG_UNROLL_BLOCK _Pragma("GCC unroll 8")
#else
#define MG_UNROLL_BLOCK
#endif

/* A sum of slopes with weights. */
typedef struct {
  int count;
  const mg_real *weight;     /* [count] */
  const mg_real *slopes[12]; /* [count] slopes of all states at a stage */
} mg_weighted_slopes;

/* The sum of `count` terms of which entry k has the weight weight[k] and the slope at the stage column[k]; slopes of
   stages are `stride` apart. */
static inline void mg_weigh_slopes(const mg_real *slopes, long stride, int count, const mg_real *weight,
                                   const int *column, mg_weighted_slopes *of) {
  of->count = count, of->weight = weight;
  for (int k = 0; k < count; k++) of->slopes[k] = slopes + column[k] * stride;
}

/* Adds the weighted slopes of the states of a block from i on, one after the other. */
static inline void mg_add_slopes(const mg_weighted_slopes *of, int i, mg_real *sum) {
  for (int k = 0; k < of->count; k++)
    for (int j = 0; j < MG_BLOCK; j++) sum[j] += of->weight[k] * of->slopes[k][i + j];
}

/* The same of one slope or more, whose number the compiler does not know. */
static inline void mg_add_counted_slopes(const mg_weighted_slopes *of, int i, mg_real *sum) {
  int k = 0;
  do {
    const mg_real weight = of->weight[k], *slopes = of->slopes[k] + i;
    MG_UNROLL_BLOCK
    for (int j = 0; j < MG_BLOCK; j++) sum[j] += weight * slopes[j];
  } while (++k < of->count);
}

/* The same of one state. */
static inline mg_real mg_add_slopes_of_state(const mg_weighted_slopes *of, int i, mg_real sum) {
  for (int k = 0; k < of->count; k++) sum += of->weight[k] * of->slopes[k][i];
  return sum;
}

/* The last block of a range overlaps the one before it. */
MG_INTERNAL void mg_combine_ranges(const mg_explicit_method *m, int row, const mg_real *slopes, long stride,
                                   int n_range, const int *ranges, const mg_real *x, mg_real h, mg_real *restrict out) {
  const int first = m->row[row];
  MG_REQUIRE(m->row[row + 1] > first);
  mg_weighted_slopes of;
  mg_weigh_slopes(slopes, stride, m->row[row + 1] - first, m->value + first, m->column + first, &of);
  for (int range = 0; range < n_range; range++) {
    const int begin = ranges[2 * range], end = ranges[2 * range + 1], last = end - MG_BLOCK;
    for (int i = begin; i < end && last >= begin; i += MG_BLOCK) {
      const int at = i < last ? i : last;
      mg_real sum[MG_BLOCK] = {0};
      mg_add_counted_slopes(&of, at, sum);
      for (int j = 0; j < MG_BLOCK; j++) out[at + j] = x[at + j] + h * sum[j];
    }
    for (int i = begin; i < end && last < begin; i++) out[i] = x[i] + h * mg_add_slopes_of_state(&of, i, 0);
  }
}

static const mg_explicit_method mg_dop853_method = {12, mg_dop_row, mg_dop_column, mg_dop_value, mg_dop_time};

/* Stage or end of a step. */
static void mg_dop853_combine(const mg_context *c, int row, const mg_real *x, mg_real h, mg_real *restrict out) {
  mg_combine_ranges(&mg_dop853_method, row, c->step.slopes, c->layout.n_states, c->listed.n_range, c->listed.range, x,
                    h, out);
}

/* Evaluates the right-hand side of a stage. */
static void mg_dop853_stage(mg_context *c, int is_composed, int stage, mg_real t, const mg_real *x, mg_real h) {
  const mg_real time = t + mg_dop_time[stage] * h;
  mg_dop853_combine(c, stage, x, h, c->step.stage);
  if (c->settings->newton > 1) mg_place_all_contacts(c, time, c->step.stage);
  mg_stage_right_hand_side(c, is_composed, time, c->step.stage, c->step.slopes + stage * c->layout.n_states);
}

/* A step whose error is estimated. */
typedef struct {
  const mg_real *x, *end; /* its start and its end */
  mg_real h;              /* its length, s */
  mg_real least;          /* least size of a state, in its scale */
} mg_estimated_step;

/* Sums of squares of the errors of order 5 and 3, relative to the tolerance. */
typedef struct {
  mg_real fifth, third;
} mg_squared_errors;

/* Adds the errors of a state. */
static inline void mg_add_error(const mg_context *c, const mg_estimated_step *of, int i, mg_real e5, mg_real e3,
                                mg_squared_errors *error) {
  const mg_real size = mg_max(fabs(of->x[i]), of->least * c->step.scale[i]);
  const mg_real weight = 1 / (c->settings->tolerance * size);
  error->fifth += e5 * weight * e5 * weight, error->third += e3 * weight * e3 * weight;
}

/* Adds the errors of the states from `begin` to `end`. The last block overlaps the one before it, of whose states it
   adds none again. */
static void mg_add_errors_of_range(const mg_context *c, const mg_estimated_step *of, int begin, int end,
                                   const mg_weighted_slopes *fifth, const mg_weighted_slopes *third,
                                   mg_squared_errors *error) {
  const int last = end - MG_BLOCK;
  int i = begin;
  for (; i < end && last >= begin; i += MG_BLOCK) {
    const int at = i < last ? i : last;
    mg_real e5[MG_BLOCK] = {0}, e3[MG_BLOCK];
    for (int j = 0; j < MG_BLOCK; j++) e3[j] = (of->end[at + j] - of->x[at + j]) / of->h;
    mg_add_slopes(fifth, at, e5), mg_add_slopes(third, at, e3);
    for (int j = i - at; j < MG_BLOCK; j++) mg_add_error(c, of, at + j, e5[j], e3[j], error);
  }
  for (; i < end; i++)
    mg_add_error(c, of, i, mg_add_slopes_of_state(fifth, i, 0),
                 mg_add_slopes_of_state(third, i, (of->end[i] - of->x[i]) / of->h), error);
}

MG_INTERNAL mg_real mg_dop853_error(const mg_context *c, const mg_real *x, const mg_real *end, const mg_real *slopes,
                                    long stride, mg_real least, mg_real h) {
  const mg_estimated_step of = {x, end, h, least};
  mg_squared_errors error = {0, 0};
  mg_weighted_slopes fifth, third;
  mg_weigh_slopes(slopes, stride, MG_DOP_FIFTH, mg_dop_fifth, mg_dop_fifth_column, &fifth);
  mg_weigh_slopes(slopes, stride, MG_DOP_THIRD, mg_dop_third, mg_dop_third_column, &third);
  for (int range = 0; range < c->listed.n_range; range++)
    mg_add_errors_of_range(c, &of, mg_range_begin(c, range), mg_range_end(c, range), &fifth, &third, &error);
  if (error.fifth == 0) return 0;
  return fabs(h) * error.fifth / sqrt((error.fifth + error.third / 100) * c->layout.n_live_states);
}

MG_INTERNAL mg_real mg_dop853(mg_context *c, mg_real t, const mg_real *x, mg_real h) {
  MG_NEEDS(c, MG_VALID_SLOPE, t, x);
  const int is_composed = mg_is_in_mode_of_scene_rhs(c),
            is_watched = mg_has_event_functions(c) || c->listed.has_candidates;
  mg_follower *follower = c->step.follower && c->step.follower->is_open ? c->step.follower : 0;
  if (follower) follower->stage(c, follower->of, is_composed, 0, t, h);
  for (int stage = 1; stage < 12; stage++) {
    mg_dop853_stage(c, is_composed, stage, t, x, h);
    if (stage > 2 && is_watched) mg_watch_event_signs(c), mg_sample_margins_at_stage(c, stage);
    if (follower) follower->stage(c, follower->of, is_composed, stage, t + mg_dop_time[stage] * h, h);
  }
  mg_dop853_combine(c, 12, x, h, c->step.end);
  if (follower) follower->stage(c, follower->of, is_composed, 12, t + h, h), follower->h = h;
  const mg_real error = mg_dop853_error(c, x, c->step.end, c->step.slopes, c->layout.n_states, 1, h);
  return follower ? mg_max(error, follower->error(c, follower->of, h)) : error;
}

MG_INTERNAL void mg_dop853_dense(mg_context *c, mg_real t, const mg_real *x, mg_real h) {
  MG_NEEDS(c, MG_VALID_END_SLOPE, t + h, c->step.end);
  const int n = c->layout.n_states, is_composed = mg_is_in_mode_of_scene_rhs(c);
  for (int stage = 13; stage < 16; stage++) mg_dop853_stage(c, is_composed, stage, t, x, h);
  for (int range = 0; range < c->listed.n_range; range++)
    for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++) {
      const mg_real delta = c->step.end[i] - x[i], first = c->step.slopes[i], last = c->step.slopes[12 * n + i];
      c->step.interpolant[i] = delta;
      c->step.interpolant[n + i] = h * first - delta;
      c->step.interpolant[2 * n + i] = 2 * delta - h * (first + last);
      for (int row = 0; row < 4; row++) {
        mg_real sum = 0;
        for (int j = 0; j < 16; j++) sum += mg_dop_dense[row][j] * c->step.slopes[j * n + i];
        c->step.interpolant[(3 + row) * n + i] = h * sum;
      }
    }
}
