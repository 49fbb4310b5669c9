/* Handlers of the runs of a scene for XLA's foreign function interface (jax.ffi), on the CPU.

   Arguments of all: q [lanes, n_q] and u [lanes, n_u] at the start; inputs [lanes, n, n_input], the row of an interval
   holding the value of each input in it, of one that is linear its rate; t [lanes, n], ascending, the ends of the
   intervals, s. Leading axes are lanes, each a run of its own. A run with a value beyond the range of its input, or with
   a value or rate that is not finite, is not begun; its outcome is INPUT_REFUSED.

   Derivatives go backwards over the steps of the run (mg_go_back). Memory is taken at each call. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene.h"
#include "scene_directions.h"
#include "xla/ffi/api/c_api.h"

#define N_SETTING (3 * SCENE_N_INPUT)
#define FIRST_TAPE 256L /* steps */
#define STEPS 1000000L  /* of one call of the core */

enum { OUT_OF_MEMORY = -1, INPUT_REFUSED = -2 }; /* beside the outcomes of the core; load.py knows the second */

typedef struct {
  const double *q, *u, *inputs, *t;
  long n; /* intervals */
} given_run;

/* A run that is differentiated. */
typedef struct {
  scene_instance scene;
  mg_directions directions;
  mg_tangent tangent;
  mg_tape tape;
  mg_adjoint adjoint;
  mg_real start[SCENE_N_STATE], dx[SCENE_N_STATE];
  long *marks;       /* [n] steps up to the end of each interval */
  mg_real *settings; /* [n N_SETTING] of the inputs in each interval */
  void *memory[16];
  int n_memory;
} taped_run;

static int n_q(void) { return scene_system.n_q; }
static int n_u(void) { return scene_system.n_u; }

static int has_allowed_inputs(const given_run *given) {
  for (long k = 0; k < given->n; k++)
    for (int i = 0; i < SCENE_N_INPUT; i++)
      if (!scene_takes_input(i, given->inputs[k * SCENE_N_INPUT + i])) return 0;
  return 1;
}

static void set_inputs(scene_instance *scene, const given_run *given, long k) {
  for (int i = 0; i < SCENE_N_INPUT; i++) {
    const double value = given->inputs[k * SCENE_N_INPUT + i];
    if (scene_input_is_linear[i]) scene_set_rate(scene, i, value);
    else scene_set_input(scene, i, value);
  }
}

static void place(scene_instance *scene, const given_run *given) {
  scene_init(scene);
  memcpy(scene->run.x, given->q, (size_t)n_q() * sizeof(double));
  memcpy(scene->run.x + n_q(), given->u, (size_t)n_u() * sizeof(double));
  if (given->n) set_inputs(scene, given, 0);
}

static void fill(double *values, long n) {
  for (long i = 0; i < n; i++) values[i] = NAN;
}

/* Runs; writes sensors [n n_sensor] and states [n (n_q + n_u)] at the ends of the intervals, NaN from where it ends.
   Returns its outcome. */
static int run_lane(scene_instance *scene, const given_run *given, double *sensors, double *states) {
  const long n_state = n_q() + n_u();
  place(scene, given);
  int code = has_allowed_inputs(given) ? scene_begin(scene) : INPUT_REFUSED;
  for (long k = 0; k < given->n; k++) {
    if (k && !code) set_inputs(scene, given, k);
    if (!code) code = scene_advance(scene, given->t[k]);
    if (code) {
      fill(sensors + k * SCENE_N_SENSOR, SCENE_N_SENSOR), fill(states + k * n_state, n_state);
      continue;
    }
    if (SCENE_N_SENSOR) scene_sense(scene, sensors + k * SCENE_N_SENSOR);
    memcpy(states + k * n_state, scene->run.x, (size_t)n_state * sizeof(double));
  }
  return code;
}

static void *room(taped_run *run, long n, size_t size) {
  void *found = calloc((size_t)(n > 0 ? n : 1), size);
  if (found) run->memory[run->n_memory++] = found;
  return found;
}

static int grow(mg_tape *tape) {
  const long capacity = tape->capacity ? 2 * tape->capacity : FIRST_TAPE;
  const size_t saved = (size_t)mg_save_size(&scene_system);
  unsigned char *bytes = realloc(tape->bytes, (size_t)(capacity + 1) * saved);
  if (bytes) tape->bytes = bytes;
  mg_real *slopes = realloc(tape->slopes, (size_t)capacity * 12 * SCENE_N_STATE * sizeof(mg_real));
  if (slopes) tape->slopes = slopes;
  int *crossing = realloc(tape->crossing, (size_t)capacity * MG_TAPE_CROSSING * sizeof(int));
  if (crossing) tape->crossing = crossing;
  if (!bytes || !slopes || !crossing) return 0;
  tape->capacity = capacity;
  return 1;
}

/* Memory of a run of n intervals; 0 where there is none. */
static int open_tape(taped_run *run, long n) {
  const mg_system *system = &scene_system;
  mg_adjoint *bar = &run->adjoint;
  mg_tangent *tangent = &run->tangent;
  const long size = mg_sensitivity_size(system, 1), int_size = mg_sensitivity_int_size(system);
  if (!(run->marks = room(run, n, sizeof(long)))) return 0;
  if (!(run->settings = room(run, n * N_SETTING, sizeof(mg_real)))) return 0;
  if (!(tangent->work = room(run, size, sizeof(mg_real)))) return 0;
  if (!(tangent->iwork = room(run, int_size + 1, sizeof(int)))) return 0;
  if (!(bar->x = room(run, SCENE_N_STATE, sizeof(mg_real)))) return 0;
  if (!(bar->parameters = room(run, system->n_parameters, sizeof(mg_real)))) return 0;
  if (!(bar->gravity = room(run, 3, sizeof(mg_real)))) return 0;
  if (!(bar->restitution = room(run, system->n_contact, sizeof(mg_real)))) return 0;
  if (!(bar->friction_static = room(run, 2L * system->n_friction, sizeof(mg_real)))) return 0;
  if (!(bar->friction_kinetic = room(run, 2L * system->n_friction, sizeof(mg_real)))) return 0;
  if (!(bar->patch_friction = room(run, 2L * system->n_patch, sizeof(mg_real)))) return 0;
  if (!(bar->input = room(run, N_SETTING, sizeof(mg_real)))) return 0;
  bar->work = tangent->work, bar->iwork = tangent->iwork, bar->given = run->start;
  run->directions.n = 1;
  run->directions.start = scene_direction_start, run->directions.input = scene_direction_input;
  run->directions.given = run->start;
  tangent->x = run->dx, tangent->tape = &run->tape, tangent->reason_contact = -1;
  return grow(&run->tape);
}

static void close_run(taped_run *run) {
  for (int i = 0; i < run->n_memory; i++) free(run->memory[i]);
  free(run->tape.bytes), free(run->tape.slopes), free(run->tape.crossing), free(run);
}

/* A run of n intervals; 0 where there is no memory. */
static taped_run *open_run(long n) {
  taped_run *run = calloc(1, sizeof *run);
  if (!run || open_tape(run, n)) return run;
  close_run(run);
  return 0;
}

/* Runs and keeps what is needed to go back. Returns its outcome, or OUT_OF_MEMORY. */
static int run_with_tape(taped_run *run, const given_run *given) {
  scene_instance *scene = &run->scene;
  mg_run *state = &scene->run;
  mg_record record = {0};
  if (!has_allowed_inputs(given)) return INPUT_REFUSED;
  place(scene, given);
  memcpy(run->start, state->x, sizeof run->start);
  int code = scene_begin(scene);
  if (code) return code;
  code = mg_begin_tangent(scene->system, &scene_settings, state, &run->directions, &run->tangent, scene->work,
                          scene->iwork);
  for (long k = 0; k < given->n && !code; k++) {
    if (k) set_inputs(scene, given, k);
    if (N_SETTING) memcpy(run->settings + k * N_SETTING, state->input, N_SETTING * sizeof(mg_real));
    do {
      scene->events.count = 0;
      code = mg_advance_tangent(scene->system, &scene_settings, state, &run->directions, &run->tangent, given->t[k],
                                STEPS, &record, &scene->events, scene->work, scene->iwork);
      if (code == MG_LIST_FULL && run->tape.count >= run->tape.capacity && !grow(&run->tape)) return OUT_OF_MEMORY;
    } while (code == MG_CONTINUE || code == MG_LIST_FULL);
    run->marks[k] = run->tape.count;
  }
  return code;
}

/* Adds the cotangents of what is shown at the end of an interval. */
static void add_shown(taped_run *run, long k, const double *sensors_bar, const double *states_bar) {
  scene_instance *scene = &run->scene;
  const long n_state = n_q() + n_u();
  int is_sensed = 0;
  for (long i = 0; i < n_state; i++) run->adjoint.x[i] += states_bar[k * n_state + i];
  for (int i = 0; i < SCENE_N_SENSOR; i++) is_sensed |= sensors_bar[k * SCENE_N_SENSOR + i] != 0;
  if (!is_sensed) return;
  if (N_SETTING) memcpy(scene->run.input, run->settings + k * N_SETTING, N_SETTING * sizeof(mg_real));
  mg_sense_adjoint(scene->system, &scene_settings, &scene->run, sensors_bar + k * SCENE_N_SENSOR, &run->adjoint,
                   scene->work, scene->iwork);
}

/* From the cotangents of the settings of interval k those of its inputs, and of the values of linear inputs before. */
static void take_inputs(taped_run *run, const given_run *given, long k, mg_real *later, double *inputs_bar) {
  const double span = given->t[k] - (k ? given->t[k - 1] : 0.0);
  for (int i = 0; i < SCENE_N_INPUT; i++) {
    mg_real *setting = run->adjoint.input + 3 * i;
    if (scene_input_is_linear[i])
      inputs_bar[k * SCENE_N_INPUT + i] = setting[1] + span * later[i], later[i] += setting[0];
    else inputs_bar[k * SCENE_N_INPUT + i] = setting[0];
    setting[0] = setting[1] = setting[2] = 0;
  }
}

/* Cotangents of start and inputs of one run. Returns its outcome, or OUT_OF_MEMORY; cotangents of a run that ends early
   are NaN. */
static int gradient_lane(taped_run *run, const given_run *given, const double *sensors_bar, const double *states_bar,
                         double *q_bar, double *u_bar, double *inputs_bar) {
  scene_instance *scene = &run->scene;
  mg_real later[SCENE_N_INPUT + 1] = {0};
  const int code = run_with_tape(run, given);
  if (code) {
    fill(q_bar, n_q()), fill(u_bar, n_u()), fill(inputs_bar, given->n * SCENE_N_INPUT);
    return code;
  }
  long end = given->n ? run->marks[given->n - 1] : 0;
  for (long k = given->n - 1; k >= 0; k--) {
    const long before = k ? run->marks[k - 1] : 0;
    if (k == given->n - 1)
      mg_go_back(scene->system, &scene_settings, &scene->run, &run->tape, end, end, &run->adjoint, scene->work,
                 scene->iwork);
    add_shown(run, k, sensors_bar, states_bar);
    mg_go_back(scene->system, &scene_settings, &scene->run, &run->tape, end, before, &run->adjoint, scene->work,
               scene->iwork);
    if (!k) mg_go_back_to_start(scene->system, &scene_settings, &scene->run, &run->adjoint, scene->work, scene->iwork);
    take_inputs(run, given, k, later, inputs_bar);
    end = before;
  }
  memcpy(q_bar, run->adjoint.x, (size_t)n_q() * sizeof(double));
  memcpy(u_bar, run->adjoint.x + n_q(), (size_t)n_u() * sizeof(double));
  return code;
}

/* ---- the interface ---- */

static XLA_FFI_Error *refused(XLA_FFI_CallFrame *frame, const char *message, XLA_FFI_Error_Code code) {
  XLA_FFI_Error_Create_Args args = {XLA_FFI_Error_Create_Args_STRUCT_SIZE, 0, message, code};
  return frame->api->XLA_FFI_Error_Create(&args);
}

/* 1 if the caller asks with which version of the interface this was compiled. */
static int tells_version(XLA_FFI_CallFrame *frame) {
  for (XLA_FFI_Extension_Base *each = frame->extension_start; each; each = each->next)
    if (each->type == XLA_FFI_Extension_Metadata) {
      XLA_FFI_Metadata *metadata = ((XLA_FFI_Metadata_Extension *)(void *)each)->metadata;
      metadata->api_version.major_version = XLA_FFI_API_MAJOR;
      metadata->api_version.minor_version = XLA_FFI_API_MINOR;
      return 1;
    }
  return 0;
}

static double *argument(XLA_FFI_CallFrame *frame, int i) { return ((XLA_FFI_Buffer *)frame->args.args[i])->data; }
static void *result(XLA_FFI_CallFrame *frame, int i) { return ((XLA_FFI_Buffer *)frame->rets.rets[i])->data; }

static long numbers(const XLA_FFI_Buffer *buffer) {
  long n = 1;
  for (int64_t i = 0; i < buffer->rank; i++) n *= (long)buffer->dims[i];
  return n;
}

/* Lanes and intervals of a call; 0 where the arguments are of another form. */
static long lanes_of(XLA_FFI_CallFrame *frame, int arguments, int results, long *n) {
  if (frame->args.size != arguments || frame->rets.size != results) return 0;
  const XLA_FFI_Buffer *u = frame->args.args[1], *t = frame->args.args[3];
  for (int i = 0; i < arguments; i++)
    if (((XLA_FFI_Buffer *)frame->args.args[i])->dtype != XLA_FFI_DataType_F64) return 0;
  if (!t->rank || !u->rank || u->dims[u->rank - 1] != n_u()) return 0;
  long lanes = 1;
  for (int64_t i = 0; i + 1 < u->rank; i++) lanes *= (long)u->dims[i];
  *n = (long)t->dims[t->rank - 1];
  const long each[] = {n_q(), n_u(), *n * SCENE_N_INPUT, *n};
  for (int i = 0; i < 4; i++)
    if (numbers(frame->args.args[i]) != lanes * each[i]) return 0;
  return lanes;
}

static given_run given_of(XLA_FFI_CallFrame *frame, long lane, long n) {
  const given_run given = {argument(frame, 0) + lane * n_q(), argument(frame, 1) + lane * n_u(),
                           argument(frame, 2) + lane * n * SCENE_N_INPUT, argument(frame, 3) + lane * n, n};
  return given;
}

#define ILL_FORMED refused(frame, "arguments of another form than scene_jax needs", XLA_FFI_Error_Code_INVALID_ARGUMENT)
#define NO_MEMORY refused(frame, "no memory for a run", XLA_FFI_Error_Code_RESOURCE_EXHAUSTED)

/* -> sensors [lanes, n, n_sensor], states [lanes, n, n_q + n_u], outcome [lanes]. */
MG_API XLA_FFI_Error *scene_jax_run(XLA_FFI_CallFrame *frame) {
  long n = 0;
  if (tells_version(frame)) return 0;
  const long lanes = lanes_of(frame, 4, 3, &n);
  if (!lanes) return ILL_FORMED;
  scene_instance *scene = malloc(sizeof *scene);
  if (!scene) return NO_MEMORY;
  for (long lane = 0; lane < lanes; lane++) {
    const given_run given = given_of(frame, lane, n);
    ((int32_t *)result(frame, 2))[lane] =
        run_lane(scene, &given, (double *)result(frame, 0) + lane * n * SCENE_N_SENSOR,
                 (double *)result(frame, 1) + lane * n * (n_q() + n_u()));
  }
  free(scene);
  return 0;
}

/* Arguments: those of all, then cotangents of sensors and states. -> cotangents of q, u, inputs. */
MG_API XLA_FFI_Error *scene_jax_gradient(XLA_FFI_CallFrame *frame) {
  long n = 0;
  if (tells_version(frame)) return 0;
  const long lanes = lanes_of(frame, 6, 3, &n);
  if (!lanes) return ILL_FORMED;
  for (long lane = 0; lane < lanes; lane++) {
    const given_run given = given_of(frame, lane, n);
    taped_run *run = open_run(n);
    if (!run) return NO_MEMORY;
    const int code =
        gradient_lane(run, &given, argument(frame, 4) + lane * n * SCENE_N_SENSOR,
                      argument(frame, 5) + lane * n * (n_q() + n_u()), (double *)result(frame, 0) + lane * n_q(),
                      (double *)result(frame, 1) + lane * n_u(), (double *)result(frame, 2) + lane * n * SCENE_N_INPUT);
    close_run(run);
    if (code == OUT_OF_MEMORY) return NO_MEMORY;
  }
  return 0;
}

/* -> verdict [lanes, 3]: outcome of the run, MG_VERDICT_DIFFERENTIABLE .., and reason; and its time [lanes], s. A run that
   ends early is undecided: its gradient is NaN. */
MG_API XLA_FFI_Error *scene_jax_verdict(XLA_FFI_CallFrame *frame) {
  long n = 0;
  if (tells_version(frame)) return 0;
  const long lanes = lanes_of(frame, 4, 2, &n);
  if (!lanes) return ILL_FORMED;
  for (long lane = 0; lane < lanes; lane++) {
    const given_run given = given_of(frame, lane, n);
    int32_t *told = (int32_t *)result(frame, 0) + 3 * lane;
    taped_run *run = open_run(n);
    if (!run) return NO_MEMORY;
    const int code = run_with_tape(run, &given);
    told[0] = code, told[1] = code ? MG_VERDICT_UNDECIDED : run->tangent.verdict, told[2] = run->tangent.reason;
    ((double *)result(frame, 1))[lane] = run->tangent.reason_t;
    close_run(run);
    if (code == OUT_OF_MEMORY) return NO_MEMORY;
  }
  return 0;
}
