/* Functions of time, in driven bodies, given motions and loads, are looked at between the samples that a step takes of
   them: no step is so long that one goes up and down, or down and up, unseen. Loads that a body feels where it is, or
   as it moves, are so along the step. */
#include "integrate/integrate.h"
#include "model/model.h"

enum { MG_SPANS_SEEN = 7, MG_MOST_SEEN = 4096 }; /* parts of a step; looks at most */

static const mg_real mg_sampled[MG_SPANS_SEEN + 1] = {
    /* times of a step, in parts of it, whose slopes count in its sum */
    0, (mg_real)0.25, (mg_real)0.3077, (mg_real)0.3333, (mg_real)0.6, (mg_real)0.6513, (mg_real)0.8571, 1};

#define MG_SAMPLE_SPACING (mg_real)0.2667 /* part between two of them */

enum { MG_FROM, MG_TO, MG_LOW, MG_HIGH, MG_OVER, MG_LEAST, MG_MOST, MG_WEIGHT, MG_OF_INSTANTS };

#define MG_EXTRAPOLATED_PART \
  (mg_real)0.1 /* of what a function does in a step, that it may do beyond the ends of a part of it */

static int mg_may_hide(const mg_system *s, int load) {
  const mg_load_kind *kind = s->kernels->load_kinds + s->load_kind[load];
  return kind->timed || kind->felt;
}

/* How many functions of time there are, and of what loads are felt by. */
MG_INTERNAL int mg_count_timed(const mg_system *s) {
  int count = 0;
  for (int b = 0; b < s->n_body; b++) count += 12 * mg_is_driven(s, b);
  for (int j = 0; j < s->n_joint; j++) {
    const mg_joint_kind *kind = s->kernels->joint_kinds + s->joint_kind[j];
    count += kind->prescribed * kind->n_rows;
  }
  for (int i = 0; i < s->n_load; i++) count += 12 * mg_may_hide(s, i);
  return count;
}

/* How many loads are felt; of these, if asked for, those alone that time changes too. */
MG_INTERNAL int mg_count_state_loads(const mg_system *s, int timed) {
  int count = 0;
  for (int i = 0; i < s->n_load; i++) {
    const mg_load_kind *kind = s->kernels->load_kinds + s->load_kind[i];
    count += kind->felt && (kind->timed || !timed);
  }
  return count;
}

MG_INTERNAL long mg_time_sample_memory(const mg_system *s) { return (long)MG_OF_INSTANTS * mg_count_timed(s); }

static mg_real *mg_instant(const mg_context *c, int which) { return c->step.time_samples + (long)which * c->n_timed; }

/* All of them at a time: poses of driven bodies, rows of given motions, loads; with what moves by forces where it is,
   or, within a step `way` that has its interpolant, on its way. Leaves bodies and those rows there. */
static void mg_look_at_time(mg_context *c, mg_real t, mg_real way, mg_real *value) {
  const mg_system *s = c->system;
  if (way > 0) {
    mg_interpolate(c, c->run->x, (t - c->run->t) / way, c->step.stage);
    mg_normalise_quaternions(c, c->step.stage);
    mg_update_poses(c, t, c->step.stage);
  }
  for (int b = 0; b < s->n_body; b++) {
    if (!mg_is_driven(s, b)) continue;
    mg_real *pose = c->pose + 12 * b;
    c->kernels->body_path(s->body_kind[b], &t, s->parameters + s->body_parameters[b], pose, c->twist + 6 * b,
                          c->accel + 6 * b);
    for (int k = 0; k < 12; k++) *value++ = pose[k];
  }
  if (c->has_prescribed_joint) mg_update_joint_rows(c, t);
  for (int j = 0; j < s->n_joint; j++) {
    const mg_joint_kind *kind = c->kernels->joint_kinds + s->joint_kind[j];
    for (int k = 0; k < kind->n_rows && kind->prescribed; k++)
      *value++ = c->d[c->joint_row_begin + s->joint_row[j] + k];
  }
  for (int i = 0; i < s->n_load; i++) {
    if (!mg_may_hide(s, i)) continue;
    for (int k = 0; k < 12; k++) value[k] = 0;
    mg_load_wrench(c, t, i, value);
    value += 12;
  }
}

/* What a force (0) or torque (1) on a body moves or turns it in a second squared, at most. */
static mg_real mg_yields(const mg_system *s, int body, int turns) {
  if (body < 0) return 0;
  const mg_real *inverse = s->mass_inverse + 10 * body;
  return turns ? inverse[1] + inverse[5] + inverse[9] : inverse[0];
}

/* What makes an error of one over a step h as large as is tolerated. */
static void mg_weigh_instants(const mg_context *c, mg_real h, mg_real *weight) {
  const mg_system *s = c->system;
  const mg_real way = 1 / (c->settings->tolerance * s->length), turn = 1 / c->settings->tolerance;
  for (int b = 0; b < s->n_body; b++)
    for (int k = 0; k < 12 && mg_is_driven(s, b); k++) *weight++ = k < 3 ? way : turn;
  for (int j = 0; j < s->n_joint; j++) {
    const mg_joint_kind *kind = c->kernels->joint_kinds + s->joint_kind[j];
    for (int k = 0; k < kind->n_rows && kind->prescribed; k++) *weight++ = way > turn ? way : turn;
  }
  for (int i = 0; i < s->n_load; i++)
    for (int k = 0; k < 12 && mg_may_hide(s, i); k++) {
      const int turns = k % 6 > 2;
      *weight++ = h * h * (turns ? turn : way) * mg_yields(s, k < 6 ? s->load_a[i] : s->load_b[i], turns);
    }
}

/* Looks at one part of a step, from t to t + h, with the values at t in MG_FROM, which become those at its end. */
static void mg_look_within(mg_context *c, mg_real t, mg_real h, mg_real way, int among) {
  mg_real *from = mg_instant(c, MG_FROM), *to = mg_instant(c, MG_TO), *low = mg_instant(c, MG_LOW);
  mg_real *high = mg_instant(c, MG_HIGH), *over = mg_instant(c, MG_OVER);
  for (int i = 0; i < c->n_timed; i++) low[i] = MG_MAX, high[i] = -MG_MAX;
  for (int k = 1; k <= among; k++) {
    mg_look_at_time(c, t + k * h / among, way, to);
    for (int i = 0; i < c->n_timed && k < among; i++) low[i] = fmin(low[i], to[i]), high[i] = fmax(high[i], to[i]);
  }
  for (int i = 0; i < c->n_timed; i++) {
    over[i] = fmax(over[i], fmax(high[i] - fmax(from[i], to[i]), fmin(from[i], to[i]) - low[i]));
    mg_instant(c, MG_LEAST)[i] = fmin(mg_instant(c, MG_LEAST)[i], to[i]);
    mg_instant(c, MG_MOST)[i] = fmax(mg_instant(c, MG_MOST)[i], to[i]);
    from[i] = to[i];
  }
}

/* Whether samples in a step h from now show all that functions of time do in it; `way` as for a look. */
static int mg_shows(mg_context *c, mg_real h, mg_real way) {
  const mg_real looks = h / (c->settings->look * c->system->time);
  if (looks > MG_MOST_SEEN) return 0;
  mg_real *over = mg_instant(c, MG_OVER), *least = mg_instant(c, MG_LEAST), *most = mg_instant(c, MG_MOST);
  mg_look_at_time(c, c->run->t, way, mg_instant(c, MG_FROM));
  for (int i = 0; i < c->n_timed; i++) over[i] = 0, least[i] = most[i] = mg_instant(c, MG_FROM)[i];
  for (int k = 0; k < MG_SPANS_SEEN; k++) {
    const mg_real part = mg_sampled[k + 1] - mg_sampled[k];
    mg_look_within(c, c->run->t + mg_sampled[k] * h, part * h, way, (int)(part * looks) + 1);
  }
  mg_weigh_instants(c, h, mg_instant(c, MG_WEIGHT));
  for (int i = 0; i < c->n_timed; i++) {
    const mg_real rounding = 64 * MG_EPS * fmax(fabs(least[i]), fabs(most[i]));
    const int hides = over[i] > MG_EXTRAPOLATED_PART * (most[i] - least[i]) && over[i] > rounding;
    if (hides && over[i] * mg_instant(c, MG_WEIGHT)[i] > 1) return 0;
  }
  return 1;
}

static mg_real mg_least_seen(const mg_context *c) { return c->settings->look * c->system->time / MG_SAMPLE_SPACING; }

/* The longest step, of h, half of it, and so on, in which functions of time are seen; nothing shorter than look * time
   is looked for. Needs the poses of run->x. */
MG_INTERNAL mg_real mg_time_step_limit(mg_context *c, mg_real h) {
  const mg_real least = mg_least_seen(c);
  if (c->n_timed <= 12 * c->n_steady_loads || h <= least) return h;
  while (h > least && !mg_shows(c, h, 0)) h /= 2;
  if (c->n_driven) mg_update_poses(c, c->run->t, c->run->x);
  if (c->has_prescribed_joint) mg_update_joint_rows(c, c->run->t);
  return h;
}

/* Whether a load that is felt goes up and down unseen within the step h just tried, whose end is left as it was. The
   cubic knows its ends alone: a better interpolant may have met what the step has not, but goes nearer to where the
   body turns back. */
MG_INTERNAL int mg_has_hidden_load(mg_context *c, mg_real h) {
  if (!c->n_state_loads || c->settings->method == MG_RK4 || h <= mg_least_seen(c)) return 0;
  mg_make_cubic(c, c->run->x, h);
  int shows = mg_shows(c, h, h);
  if (shows && !mg_is_collocated(c)) {
    mg_make_dense(c, c->run->t, c->run->x, h);
    shows = mg_shows(c, h, h);
  }
  mg_finish_step(c, c->run->t, h);
  return !shows;
}
