/* FMI 2.0 for co-simulation (Functional Mock-up Interface 2.0.4, sections 2.1 and 4.2): its declarations, as far as
   they are needed, and its functions. Variables are real numbers only. */
#include <stdlib.h>
#include <string.h>

#include "fmu.h"

#if defined(_WIN32)
#define FMI2_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI2_EXPORT __attribute__((visibility("default")))
#else
#define FMI2_EXPORT
#endif

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;
typedef void (*fmi2CallbackLogger)(void *environment, const char *name, fmi2Status status, const char *category,
                                   const char *message, ...);

typedef struct {
  fmi2CallbackLogger logger;
  void *(*allocateMemory)(size_t n, size_t size);
  void (*freeMemory)(void *memory);
  void (*stepFinished)(void *environment, fmi2Status status);
  void *componentEnvironment;
} fmi2CallbackFunctions;

/* An instance with the importer's logger. */
typedef struct {
  fmu run;
  fmi2CallbackLogger logger;
} fmi2_instance;

static fmi2Status fmi2_say(fmi2_instance *c, fmi2Status status, const char *message) {
  if (c->logger) c->logger(c->run.environment, c->run.name, status, "error", "%s", message);
  return status;
}

FMI2_EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }

FMI2_EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

FMI2_EXPORT fmi2Status fmi2SetDebugLogging(void *c, int on, size_t n, const char *const *categories) {
  (void)c, (void)on, (void)n, (void)categories;
  return fmi2OK;
}

FMI2_EXPORT void *fmi2Instantiate(const char *name, fmi2Type type, const char *guid, const char *resources,
                                  const fmi2CallbackFunctions *functions, int visible, int on) {
  (void)resources, (void)visible, (void)on;
  const fmi2CallbackLogger logger = functions ? functions->logger : 0;
  void *environment = functions ? functions->componentEnvironment : 0;
  if (type != fmi2CoSimulation || !guid || strcmp(guid, FMU_TOKEN)) {
    if (logger) logger(environment, name, fmi2Error, "error", "%s", "another kind of simulation, or another guid");
    return 0;
  }
  fmi2_instance *c = calloc(1, sizeof *c);
  if (!c) return 0;
  c->logger = logger, c->run.environment = environment;
  if (name) strncpy(c->run.name, name, sizeof c->run.name - 1);
  fmu_reset(&c->run, 0);
  return c;
}

FMI2_EXPORT void fmi2FreeInstance(void *c) { free(c); }

FMI2_EXPORT fmi2Status fmi2SetupExperiment(void *component, int has_tolerance, double tolerance, double start,
                                           int has_stop, double stop) {
  fmi2_instance *c = component;
  (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
  fmu_start_at(&c->run, start);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2EnterInitializationMode(void *c) {
  (void)c;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2ExitInitializationMode(void *component) {
  fmi2_instance *c = component;
  if (!fmu_settle(&c->run)) return fmi2_say(c, fmi2Error, fmu_reason(c->run.outcome));
  c->run.is_stepping = 1;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2Terminate(void *component) {
  fmi2_instance *c = component;
  const int doubts = scene_doubts(&c->run.scene, c->run.outcome);
  for (int doubt = 1; doubt <= doubts; doubt *= 2)
    if (doubts & doubt) fmi2_say(c, fmi2Warning, mg_doubt_text(doubt));
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2Reset(void *component) {
  fmi2_instance *c = component;
  fmu_reset(&c->run, 0);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetReal(void *component, const unsigned *numbers, size_t n, double *values) {
  fmi2_instance *c = component;
  if (fmu_get(&c->run, numbers, n, values)) return fmi2OK;
  return fmi2_say(c, fmi2Error, c->run.outcome ? fmu_reason(c->run.outcome) : "no such variable");
}

FMI2_EXPORT fmi2Status fmi2SetReal(void *component, const unsigned *numbers, size_t n, const double *values) {
  fmi2_instance *c = component;
  if (fmu_set(&c->run, numbers, n, values)) return fmi2OK;
  return fmi2_say(c, fmi2Error, "no input has this number, or the value is outside of its range");
}

/* There are no variables of other types. */
static fmi2Status fmi2_none(void *c, size_t n) {
  return n ? fmi2_say(c, fmi2Error, "all variables are real numbers") : fmi2OK;
}

#define FMI2_OTHER(type, value)                                                                           \
  FMI2_EXPORT fmi2Status fmi2Get##type(void *c, const unsigned *numbers, size_t n, value *values) {       \
    (void)numbers, (void)values;                                                                          \
    return fmi2_none(c, n);                                                                               \
  }                                                                                                       \
  FMI2_EXPORT fmi2Status fmi2Set##type(void *c, const unsigned *numbers, size_t n, const value *values) { \
    (void)numbers, (void)values;                                                                          \
    return fmi2_none(c, n);                                                                               \
  }

typedef const char *fmi2_text;
FMI2_OTHER(Integer, int)
FMI2_OTHER(Boolean, int)
FMI2_OTHER(String, fmi2_text)

FMI2_EXPORT fmi2Status fmi2GetFMUstate(void *component, void **state) {
  fmi2_instance *c = component;
  if (!*state) *state = calloc(1, sizeof(fmu_state));
  if (!*state) return fmi2_say(c, fmi2Error, "there is no memory for a state");
  fmu_save(&c->run, *state);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetFMUstate(void *component, void *state) {
  fmi2_instance *c = component;
  if (state && fmu_load(&c->run, state)) return fmi2OK;
  return fmi2_say(c, fmi2Error, "no state of this FMU");
}

FMI2_EXPORT fmi2Status fmi2FreeFMUstate(void *c, void **state) {
  (void)c;
  if (state) free(*state), *state = 0;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SerializedFMUstateSize(void *c, void *state, size_t *size) {
  (void)c, (void)state;
  *size = sizeof(fmu_state);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SerializeFMUstate(void *c, void *state, char *bytes, size_t size) {
  if (!state || size < sizeof(fmu_state)) return fmi2_say(c, fmi2Error, "too little room for a state");
  memcpy(bytes, state, sizeof(fmu_state));
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2DeSerializeFMUstate(void *c, const char *bytes, size_t size, void **state) {
  if (size != sizeof(fmu_state)) return fmi2_say(c, fmi2Error, "no state of this FMU");
  if (!*state) *state = calloc(1, sizeof(fmu_state));
  if (!*state) return fmi2_say(c, fmi2Error, "there is no memory for a state");
  memcpy(*state, bytes, size);
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetDirectionalDerivative(void *c, const unsigned *unknown, size_t n_unknown,
                                                    const unsigned *known, size_t n_known, const double *change,
                                                    double *result) {
  (void)unknown, (void)n_unknown, (void)known, (void)n_known, (void)change, (void)result;
  return fmi2_say(c, fmi2Error, "there are no directional derivatives");
}

FMI2_EXPORT fmi2Status fmi2SetRealInputDerivatives(void *c, const unsigned *numbers, size_t n, const int *order,
                                                   const double *values) {
  (void)numbers, (void)n, (void)order, (void)values;
  return fmi2_say(c, fmi2Error, "inputs have no derivatives");
}

FMI2_EXPORT fmi2Status fmi2GetRealOutputDerivatives(void *c, const unsigned *numbers, size_t n, const int *order,
                                                    double *values) {
  (void)numbers, (void)n, (void)order, (void)values;
  return fmi2_say(c, fmi2Error, "outputs have no derivatives");
}

FMI2_EXPORT fmi2Status fmi2DoStep(void *component, double t, double step, int no_way_back) {
  fmi2_instance *c = component;
  int is_early;
  (void)no_way_back;
  if (c->run.outcome) return fmi2_say(c, fmi2Error, fmu_reason(c->run.outcome));
  if (fmu_advance(&c->run, t, step, &is_early)) return fmi2OK;
  return fmi2_say(c, fmi2Discard, fmu_reason(c->run.outcome));
}

FMI2_EXPORT fmi2Status fmi2CancelStep(void *c) { return fmi2_say(c, fmi2Error, "steps are not asynchronous"); }

FMI2_EXPORT fmi2Status fmi2GetStatus(void *c, fmi2StatusKind kind, fmi2Status *value) {
  (void)c, (void)kind, (void)value;
  return fmi2Discard;
}

FMI2_EXPORT fmi2Status fmi2GetRealStatus(void *component, fmi2StatusKind kind, double *value) {
  fmi2_instance *c = component;
  if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
  *value = (double)c->run.scene.run.t;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetIntegerStatus(void *c, fmi2StatusKind kind, int *value) {
  (void)c, (void)kind, (void)value;
  return fmi2Discard;
}

FMI2_EXPORT fmi2Status fmi2GetBooleanStatus(void *component, fmi2StatusKind kind, int *value) {
  fmi2_instance *c = component;
  if (kind != fmi2Terminated) return fmi2Discard;
  *value = c->run.outcome != MG_DONE;
  return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetStringStatus(void *c, fmi2StatusKind kind, const char **value) {
  (void)c, (void)kind, (void)value;
  return fmi2Discard;
}
