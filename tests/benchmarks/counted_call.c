/* A call of a function of six addresses, such as mg_begin, whose instructions callgrind counts and dumps by themselves.
   Run under `valgrind --tool=callgrind --instr-atstart=no`. */
#include <valgrind/callgrind.h>

typedef int (*mg_function)(void *, void *, void *, void *, void *, void *);

int counted_call(mg_function call, void *a, void *b, void *c, void *d, void *e, void *f) {
  CALLGRIND_START_INSTRUMENTATION;
  CALLGRIND_ZERO_STATS;
  const int code = call(a, b, c, d, e, f);
  CALLGRIND_DUMP_STATS;
  CALLGRIND_STOP_INSTRUMENTATION;
  return code;
}
