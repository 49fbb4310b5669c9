/* FMI 3.0 for co-simulation (Functional Mock-up Interface 3.0.1, sections 2.2 and 4.2): its declarations, as far as
   they are needed, and its functions. Variables are of type Float64 only. */
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "fmu.h"

#if defined(_WIN32)
#define FMI3_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI3_EXPORT __attribute__((visibility("default")))
#else
#define FMI3_EXPORT
#endif

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef void (*fmi3LogMessageCallback)(void *environment, fmi3Status status, const char *category, const char *message);
typedef const char *fmi3_text;

/* An instance with the importer's function for messages. */
typedef struct {
  fmu run;
  fmi3LogMessageCallback logger;
} fmi3_instance;

static fmi3Status fmi3_say(fmi3_instance *c, fmi3Status status, const char *message) {
  if (c && c->logger) c->logger(c->run.environment, status, "error", message);
  return status;
}

FMI3_EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

FMI3_EXPORT fmi3Status fmi3SetDebugLogging(void *c, bool on, size_t n, const fmi3_text *categories) {
  (void)c, (void)on, (void)n, (void)categories;
  return fmi3OK;
}

FMI3_EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible,
                                              bool on, bool event_mode, bool may_return_early,
                                              const uint32_t *intermediate, size_t n_intermediate, void *environment,
                                              fmi3LogMessageCallback logger, void *update) {
  (void)resources, (void)visible, (void)on, (void)event_mode, (void)intermediate, (void)n_intermediate;
  (void)update;
  if (!token || strcmp(token, FMU_TOKEN)) {
    if (logger) logger(environment, fmi3Error, "error", "another instantiation token");
    return 0;
  }
  fmi3_instance *c = calloc(1, sizeof *c);
  if (!c) return 0;
  c->logger = logger, c->run.environment = environment;
  c->run.may_return_early = may_return_early;
  if (name) strncpy(c->run.name, name, sizeof c->run.name - 1);
  fmu_reset(&c->run, 0);
  return c;
}

FMI3_EXPORT void fmi3FreeInstance(void *c) { free(c); }

FMI3_EXPORT fmi3Status fmi3EnterInitializationMode(void *component, bool has_tolerance, double tolerance, double start,
                                                   bool has_stop, double stop) {
  fmi3_instance *c = component;
  (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
  fmu_start_at(&c->run, start);
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3ExitInitializationMode(void *component) {
  fmi3_instance *c = component;
  if (!fmu_settle(&c->run)) return fmi3_say(c, fmi3Error, fmu_reason(c->run.outcome));
  c->run.is_stepping = 1;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3Terminate(void *component) {
  fmi3_instance *c = component;
  const int doubts = scene_doubts(&c->run.scene, c->run.outcome);
  for (int doubt = 1; doubt <= doubts; doubt *= 2)
    if (doubts & doubt) fmi3_say(c, fmi3Warning, mg_doubt_text(doubt));
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3Reset(void *component) {
  fmi3_instance *c = component;
  fmu_reset(&c->run, 0);
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3GetFloat64(void *component, const uint32_t *numbers, size_t n, double *values,
                                      size_t n_values) {
  fmi3_instance *c = component;
  if (n == n_values && fmu_get(&c->run, numbers, n, values)) return fmi3OK;
  return fmi3_say(c, fmi3Error, c->run.outcome ? fmu_reason(c->run.outcome) : "no such variable");
}

FMI3_EXPORT fmi3Status fmi3SetFloat64(void *component, const uint32_t *numbers, size_t n, const double *values,
                                      size_t n_values) {
  fmi3_instance *c = component;
  if (n == n_values && fmu_set(&c->run, numbers, n, values)) return fmi3OK;
  return fmi3_say(c, fmi3Error, "no input has this number, or the value is outside of its range");
}

FMI3_EXPORT fmi3Status fmi3GetFMUState(void *component, void **state) {
  fmi3_instance *c = component;
  if (!*state) *state = calloc(1, sizeof(fmu_state));
  if (!*state) return fmi3_say(c, fmi3Error, "there is no memory for a state");
  fmu_save(&c->run, *state);
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SetFMUState(void *component, void *state) {
  fmi3_instance *c = component;
  if (state && fmu_load(&c->run, state)) return fmi3OK;
  return fmi3_say(c, fmi3Error, "no state of this FMU");
}

FMI3_EXPORT fmi3Status fmi3FreeFMUState(void *c, void **state) {
  (void)c;
  if (state) free(*state), *state = 0;
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SerializedFMUStateSize(void *c, void *state, size_t *size) {
  (void)c, (void)state;
  *size = sizeof(fmu_state);
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SerializeFMUState(void *c, void *state, uint8_t *bytes, size_t size) {
  if (!state || size < sizeof(fmu_state)) return fmi3_say(c, fmi3Error, "too little room for a state");
  memcpy(bytes, state, sizeof(fmu_state));
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3DeserializeFMUState(void *c, const uint8_t *bytes, size_t size, void **state) {
  if (size != sizeof(fmu_state)) return fmi3_say(c, fmi3Error, "no state of this FMU");
  if (!*state) *state = calloc(1, sizeof(fmu_state));
  if (!*state) return fmi3_say(c, fmi3Error, "there is no memory for a state");
  memcpy(*state, bytes, size);
  return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3DoStep(void *component, double t, double step, bool no_way_back, bool *is_event,
                                  bool *is_over, bool *is_early, double *reached) {
  fmi3_instance *c = component;
  int early = 0;
  (void)no_way_back;
  *is_event = *is_over = *is_early = false;
  const int was_over = c->run.outcome != MG_DONE, done = !was_over && fmu_advance(&c->run, t, step, &early);
  *reached = (double)c->run.scene.run.t;
  *is_early = early;
  *is_over = !done;
  if (done) return fmi3OK;
  return fmi3_say(c, was_over ? fmi3Error : fmi3Discard, fmu_reason(c->run.outcome));
}

/* Variables of other types: there are none. */
static fmi3Status fmi3_none(void *c, size_t n) {
  return n ? fmi3_say(c, fmi3Error, "all variables are of type Float64") : fmi3OK;
}

#define FMI3_OTHER(type, value)                                                                                     \
  FMI3_EXPORT fmi3Status fmi3Get##type(void *c, const uint32_t *numbers, size_t n, value *values, size_t m) {       \
    (void)numbers, (void)values, (void)m;                                                                           \
    return fmi3_none(c, n);                                                                                         \
  }                                                                                                                 \
  FMI3_EXPORT fmi3Status fmi3Set##type(void *c, const uint32_t *numbers, size_t n, const value *values, size_t m) { \
    (void)numbers, (void)values, (void)m;                                                                           \
    return fmi3_none(c, n);                                                                                         \
  }

FMI3_OTHER(Float32, float)
FMI3_OTHER(Int8, int8_t)
FMI3_OTHER(UInt8, uint8_t)
FMI3_OTHER(Int16, int16_t)
FMI3_OTHER(UInt16, uint16_t)
FMI3_OTHER(Int32, int32_t)
FMI3_OTHER(UInt32, uint32_t)
FMI3_OTHER(Int64, int64_t)
FMI3_OTHER(UInt64, uint64_t)
FMI3_OTHER(Boolean, bool)
FMI3_OTHER(String, fmi3_text)

/* What this FMU does not offer; its description says so. */
#define FMI3_LACKING(name, parameters, ...)                 \
  FMI3_EXPORT fmi3Status name parameters {                  \
    __VA_ARGS__;                                            \
    return fmi3_say(c, fmi3Error, #name " is not offered"); \
  }

FMI3_EXPORT void *fmi3InstantiateModelExchange(const char *name, const char *token, const char *resources, bool visible,
                                               bool on, void *environment, fmi3LogMessageCallback logger) {
  (void)name, (void)token, (void)resources, (void)visible, (void)on, (void)environment, (void)logger;
  return 0;
}

FMI3_EXPORT void *fmi3InstantiateScheduledExecution(const char *name, const char *token, const char *resources,
                                                    bool visible, bool on, void *environment,
                                                    fmi3LogMessageCallback logger, void *clock, void *lock,
                                                    void *unlock) {
  (void)name, (void)token, (void)resources, (void)visible, (void)on, (void)environment, (void)logger;
  (void)clock, (void)lock, (void)unlock;
  return 0;
}

FMI3_LACKING(fmi3EnterEventMode, (void *c), (void)0)
FMI3_LACKING(fmi3EnterConfigurationMode, (void *c), (void)0)
FMI3_LACKING(fmi3ExitConfigurationMode, (void *c), (void)0)
FMI3_LACKING(fmi3EvaluateDiscreteStates, (void *c), (void)0)
FMI3_LACKING(fmi3EnterContinuousTimeMode, (void *c), (void)0)
FMI3_LACKING(fmi3EnterStepMode, (void *c), (void)0)
FMI3_LACKING(fmi3GetBinary,
             (void *c, const uint32_t *numbers, size_t n, size_t *sizes, const uint8_t **values, size_t m),
             (void)numbers, (void)n, (void)sizes, (void)values, (void)m)
FMI3_LACKING(fmi3SetBinary,
             (void *c, const uint32_t *numbers, size_t n, const size_t *sizes, const uint8_t *const *values, size_t m),
             (void)numbers, (void)n, (void)sizes, (void)values, (void)m)
FMI3_LACKING(fmi3GetClock, (void *c, const uint32_t *numbers, size_t n, bool *values), (void)numbers, (void)n,
             (void)values)
FMI3_LACKING(fmi3SetClock, (void *c, const uint32_t *numbers, size_t n, const bool *values), (void)numbers, (void)n,
             (void)values)
FMI3_LACKING(fmi3GetNumberOfVariableDependencies, (void *c, uint32_t number, size_t *n), (void)number, (void)n)
FMI3_LACKING(fmi3GetVariableDependencies,
             (void *c, uint32_t number, size_t *indices, uint32_t *independents, size_t *independent_indices,
              int *kinds, size_t n),
             (void)number, (void)indices, (void)independents, (void)independent_indices, (void)kinds, (void)n)
FMI3_LACKING(fmi3GetDirectionalDerivative,
             (void *c, const uint32_t *unknowns, size_t n, const uint32_t *knowns, size_t m, const double *seed,
              size_t n_seed, double *result, size_t n_result),
             (void)unknowns, (void)n, (void)knowns, (void)m, (void)seed, (void)n_seed, (void)result, (void)n_result)
FMI3_LACKING(fmi3GetAdjointDerivative,
             (void *c, const uint32_t *unknowns, size_t n, const uint32_t *knowns, size_t m, const double *seed,
              size_t n_seed, double *result, size_t n_result),
             (void)unknowns, (void)n, (void)knowns, (void)m, (void)seed, (void)n_seed, (void)result, (void)n_result)
FMI3_LACKING(fmi3GetIntervalDecimal, (void *c, const uint32_t *numbers, size_t n, double *intervals, int *qualifiers),
             (void)numbers, (void)n, (void)intervals, (void)qualifiers)
FMI3_LACKING(fmi3GetIntervalFraction,
             (void *c, const uint32_t *numbers, size_t n, uint64_t *counters, uint64_t *resolutions, int *qualifiers),
             (void)numbers, (void)n, (void)counters, (void)resolutions, (void)qualifiers)
FMI3_LACKING(fmi3GetShiftDecimal, (void *c, const uint32_t *numbers, size_t n, double *shifts), (void)numbers, (void)n,
             (void)shifts)
FMI3_LACKING(fmi3GetShiftFraction,
             (void *c, const uint32_t *numbers, size_t n, uint64_t *counters, uint64_t *resolutions), (void)numbers,
             (void)n, (void)counters, (void)resolutions)
FMI3_LACKING(fmi3SetIntervalDecimal, (void *c, const uint32_t *numbers, size_t n, const double *intervals),
             (void)numbers, (void)n, (void)intervals)
FMI3_LACKING(fmi3SetIntervalFraction,
             (void *c, const uint32_t *numbers, size_t n, const uint64_t *counters, const uint64_t *resolutions),
             (void)numbers, (void)n, (void)counters, (void)resolutions)
FMI3_LACKING(fmi3SetShiftDecimal, (void *c, const uint32_t *numbers, size_t n, const double *shifts), (void)numbers,
             (void)n, (void)shifts)
FMI3_LACKING(fmi3SetShiftFraction,
             (void *c, const uint32_t *numbers, size_t n, const uint64_t *counters, const uint64_t *resolutions),
             (void)numbers, (void)n, (void)counters, (void)resolutions)
FMI3_LACKING(fmi3UpdateDiscreteStates,
             (void *c, bool *again, bool *is_over, bool *nominals, bool *values, bool *has_next, double *next),
             (void)again, (void)is_over, (void)nominals, (void)values, (void)has_next, (void)next)
FMI3_LACKING(fmi3CompletedIntegratorStep, (void *c, bool no_way_back, bool *is_event, bool *is_over), (void)no_way_back,
             (void)is_event, (void)is_over)
FMI3_LACKING(fmi3SetTime, (void *c, double t), (void)t)
FMI3_LACKING(fmi3SetContinuousStates, (void *c, const double *states, size_t n), (void)states, (void)n)
FMI3_LACKING(fmi3GetContinuousStateDerivatives, (void *c, double *derivatives, size_t n), (void)derivatives, (void)n)
FMI3_LACKING(fmi3GetEventIndicators, (void *c, double *indicators, size_t n), (void)indicators, (void)n)
FMI3_LACKING(fmi3GetContinuousStates, (void *c, double *states, size_t n), (void)states, (void)n)
FMI3_LACKING(fmi3GetNominalsOfContinuousStates, (void *c, double *nominals, size_t n), (void)nominals, (void)n)
FMI3_LACKING(fmi3GetNumberOfEventIndicators, (void *c, size_t *n), (void)n)
FMI3_LACKING(fmi3GetNumberOfContinuousStates, (void *c, size_t *n), (void)n)
FMI3_LACKING(fmi3GetOutputDerivatives,
             (void *c, const uint32_t *numbers, size_t n, const int32_t *orders, double *values, size_t m),
             (void)numbers, (void)n, (void)orders, (void)values, (void)m)
FMI3_LACKING(fmi3ActivateModelPartition, (void *c, uint32_t clock, double t), (void)clock, (void)t)
