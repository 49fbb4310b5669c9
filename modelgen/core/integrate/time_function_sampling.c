/* Functions of time: prescribed paths, prescribed joint motions and loads are sampled between the stages of a
   step, so that none rises and falls unseen; loads that depend on the state are sampled along the interpolant.
   Limits the step. Writes c->step.time_samples; leaves driven bodies and prescribed rows at the time of the last
   sample. */
#include "integrate/integrate.h"
#include "model/model.h"

enum {
  MG_TIME_PARTS = 7,         /* parts of a step between stages that enter its sum */
  MG_TIME_SAMPLES_MAX = 4096 /* most samples of a step */
};

static const mg_real mg_sampled[MG_TIME_PARTS + 1] = {
    /* times of the stages that enter the sum, in parts of the step */
    0, (mg_real)0.25, (mg_real)0.3077, (mg_real)0.3333, (mg_real)0.6, (mg_real)0.6513, (mg_real)0.8571, 1};

#define MG_SAMPLE_SPACING (mg_real)0.2667 /* largest part */

/* Rows of c->step.time_samples, one value per function of time. */
enum {
  MG_TIME_FIRST,  /* value at the start of a part of the step */
  MG_TIME_LAST,   /* value at its end */
  MG_TIME_LOW,    /* least value inside it */
  MG_TIME_HIGH,   /* largest value inside it */
  MG_TIME_EXCESS, /* largest excess so far of values inside a part over the range of its ends */
  MG_TIME_LEAST,  /* least value at the ends of parts */
  MG_TIME_MOST,   /* largest value at the ends of parts */
  MG_TIME_WEIGHT, /* weight that turns an excess into a multiple of the tolerance */
  MG_TIME_ROWS    /* number of rows */
};

#define MG_EXTRAPOLATED_PART \
  (mg_real)0.1 /* part of its variation in a step by which a function may leave the range of the ends of a part */

/* True if the load depends on time or on the state. */
static int mg_is_load_variable(const mg_system *s, int load) {
  const mg_load_kind *kind = s->kernels->load_kinds + s->load_kind[load];
  return kind->depends_on_time || kind->depends_on_state;
}

MG_INTERNAL int mg_time_function_count(const mg_system *s) {
  int count = 0;
  for (int b = 0; b < s->n_body; b++) count += 12 * mg_is_driven_body(s, b);
  for (int j = 0; j < s->n_joint; j++) {
    const mg_joint_kind *kind = s->kernels->joint_kinds + s->joint_kind[j];
    count += kind->prescribed * kind->n_rows;
  }
  for (int i = 0; i < s->n_load; i++) count += 12 * mg_is_load_variable(s, i);
  return count;
}

MG_INTERNAL int mg_state_load_count(const mg_system *s, int timed) {
  int count = 0;
  for (int i = 0; i < s->n_load; i++) {
    const mg_load_kind *kind = s->kernels->load_kinds + s->load_kind[i];
    count += kind->depends_on_state && (kind->depends_on_time || !timed);
  }
  return count;
}

MG_INTERNAL long mg_time_sample_size(const mg_context *c) { return (long)MG_TIME_ROWS * c->layout.n_timed; }

/* Row of the samples: MG_TIME_FIRST .. */
static mg_real *mg_time_sample_row(const mg_context *c, int which) {
  return c->step.time_samples + (long)which * c->layout.n_timed;
}

/* Evaluates all functions of time at t, loads as they are written. Bodies that forces move keep their poses, or, for
   step_length > 0, follow the interpolant of a step of that length. */
static void mg_sample_time_functions(mg_context *c, mg_real t, mg_real step_length, mg_real *value) {
  const mg_system *s = c->system;
  if (step_length > 0) {
    mg_interpolate(c, c->run->x, (t - c->run->t) / step_length, c->step.stage);
    mg_normalise_quaternions(c, c->step.stage);
    mg_update_poses(c, t, c->step.stage);
  }
  for (int b = 0; b < s->n_body; b++) {
    if (!mg_is_driven_body(s, b)) continue;
    mg_real *pose = c->bodies.pose + 12 * b;
    c->kernels->body_path(s->body_kind[b], &t, s->parameters + s->body_parameters[b], c->run->input, pose,
                          c->bodies.twist + 6 * b, c->bodies.acceleration + 6 * b);
    for (int k = 0; k < 12; k++) *value++ = pose[k];
  }
  if (c->layout.has_prescribed_joint) MG_NOTE_TIME(c, t), mg_update_joint_rows(c, t);
  for (int j = 0; j < s->n_joint; j++) {
    const mg_joint_kind *kind = c->kernels->joint_kinds + s->joint_kind[j];
    for (int k = 0; k < kind->n_rows && kind->prescribed; k++)
      *value++ = c->rows.d[c->layout.joint_row_begin + s->joint_row[j] + k];
  }
  for (int i = 0; i < s->n_load; i++) {
    if (!mg_is_load_variable(s, i)) continue;
    for (int k = 0; k < 12; k++) value[k] = 0;
    mg_written_load_wrench(c, t, i, value);
    value += 12;
  }
}

/* Bound of the acceleration of a body per unit force or torque. */
static mg_real mg_acceleration_per_load(const mg_system *s, int body, int turns) {
  if (body < 0) return 0;
  const mg_real *inverse = s->mass_inverse + 10 * body;
  return turns ? inverse[1] + inverse[5] + inverse[9] : inverse[0];
}

/* Weights that turn a deviation of each function over a step h into a multiple of the tolerance. */
static void mg_set_time_function_weights(const mg_context *c, mg_real h, mg_real *weight) {
  const mg_system *s = c->system;
  const mg_real length_weight = 1 / (c->settings->tolerance * s->length), angle_weight = 1 / c->settings->tolerance;
  for (int b = 0; b < s->n_body; b++)
    for (int k = 0; k < 12 && mg_is_driven_body(s, b); k++) *weight++ = k < 3 ? length_weight : angle_weight;
  for (int j = 0; j < s->n_joint; j++) {
    const mg_joint_kind *kind = c->kernels->joint_kinds + s->joint_kind[j];
    for (int k = 0; k < kind->n_rows && kind->prescribed; k++)
      *weight++ = length_weight > angle_weight ? length_weight : angle_weight;
  }
  for (int i = 0; i < s->n_load; i++)
    for (int k = 0; k < 12 && mg_is_load_variable(s, i); k++) {
      const int turns = k % 6 > 2;
      *weight++ = h * h * (turns ? angle_weight : length_weight) *
                  mg_acceleration_per_load(s, k < 6 ? s->load_a[i] : s->load_b[i], turns);
    }
}

/* Sample one part of a step, from t to t + h, and update by how much each function leaves the range of its ends. */
static void mg_sample_step_part(mg_context *c, mg_real t, mg_real h, mg_real step_length, int sample_count) {
  mg_real *from = mg_time_sample_row(c, MG_TIME_FIRST), *to = mg_time_sample_row(c, MG_TIME_LAST),
          *low = mg_time_sample_row(c, MG_TIME_LOW);
  mg_real *high = mg_time_sample_row(c, MG_TIME_HIGH), *excess = mg_time_sample_row(c, MG_TIME_EXCESS);
  for (int i = 0; i < c->layout.n_timed; i++) low[i] = MG_MAX, high[i] = -MG_MAX;
  for (int k = 1; k <= sample_count; k++) {
    mg_sample_time_functions(c, t + k * h / sample_count, step_length, to);
    for (int i = 0; i < c->layout.n_timed && k < sample_count; i++)
      low[i] = mg_min(low[i], to[i]), high[i] = mg_max(high[i], to[i]);
  }
  for (int i = 0; i < c->layout.n_timed; i++) {
    excess[i] = mg_max(excess[i], mg_max(high[i] - mg_max(from[i], to[i]), mg_min(from[i], to[i]) - low[i]));
    mg_time_sample_row(c, MG_TIME_LEAST)[i] = mg_min(mg_time_sample_row(c, MG_TIME_LEAST)[i], to[i]);
    mg_time_sample_row(c, MG_TIME_MOST)[i] = mg_max(mg_time_sample_row(c, MG_TIME_MOST)[i], to[i]);
    from[i] = to[i];
  }
}

/* True if the stages of a step h show all that the functions of time do in it. */
static int mg_is_step_resolved_in_time(mg_context *c, mg_real h, mg_real step_length) {
  const mg_real sample_count = h / (c->settings->time_resolution * c->system->time);
  if (sample_count > MG_TIME_SAMPLES_MAX) return 0;
  mg_real *excess = mg_time_sample_row(c, MG_TIME_EXCESS), *least = mg_time_sample_row(c, MG_TIME_LEAST),
          *most = mg_time_sample_row(c, MG_TIME_MOST);
  mg_sample_time_functions(c, c->run->t, step_length, mg_time_sample_row(c, MG_TIME_FIRST));
  for (int i = 0; i < c->layout.n_timed; i++)
    excess[i] = 0, least[i] = most[i] = mg_time_sample_row(c, MG_TIME_FIRST)[i];
  for (int k = 0; k < MG_TIME_PARTS; k++) {
    const mg_real part = mg_sampled[k + 1] - mg_sampled[k];
    mg_sample_step_part(c, c->run->t + mg_sampled[k] * h, part * h, step_length, (int)(part * sample_count) + 1);
  }
  mg_set_time_function_weights(c, h, mg_time_sample_row(c, MG_TIME_WEIGHT));
  for (int i = 0; i < c->layout.n_timed; i++) {
    const mg_real rounding = 64 * MG_EPS * mg_max(fabs(least[i]), fabs(most[i]));
    const int is_unresolved = excess[i] > MG_EXTRAPOLATED_PART * (most[i] - least[i]) && excess[i] > rounding;
    if (is_unresolved && excess[i] * mg_time_sample_row(c, MG_TIME_WEIGHT)[i] > 1) return 0;
  }
  return 1;
}

/* Step below which functions of time are not checked, s. */
static mg_real mg_unchecked_step_length(const mg_context *c) {
  return c->settings->time_resolution * c->system->time / MG_SAMPLE_SPACING;
}

MG_INTERNAL mg_real mg_time_function_step_limit(mg_context *c, mg_real h) {
  MG_NEEDS_AT_RUN(c, MG_VALID_POSES);
  const mg_real least = mg_unchecked_step_length(c);
  if (c->layout.n_timed <= 12 * c->layout.n_steady_loads || h <= least) return h;
  while (h > least && !mg_is_step_resolved_in_time(c, h, 0)) h /= 2;
  if (c->layout.n_driven || c->layout.has_prescribed_joint) mg_update_poses(c, c->run->t, c->run->x);
  if (c->layout.has_prescribed_joint) mg_update_joint_rows(c, c->run->t);
  return h;
}

MG_INTERNAL int mg_has_unresolved_state_load(mg_context *c, mg_real h) {
  if (!c->layout.n_state_loads || c->settings->method == MG_RK4 || h <= mg_unchecked_step_length(c)) return 0;
  mg_make_cubic_interpolant(c, c->run->x, h);
  int is_resolved = mg_is_step_resolved_in_time(c, h, h);
  if (is_resolved && !mg_is_collocated(c)) {
    mg_make_interpolant(c, c->run->t, c->run->x, h);
    is_resolved = mg_is_step_resolved_in_time(c, h, h);
  }
  mg_finish_step(c, c->run->t, h);
  return !is_resolved;
}
