/* Whether the caller asks that the present call end (run->stop), from another thread or a signal handler. Writes
   nothing. */
#include "model/model.h"

MG_INTERNAL int mg_is_stopped(const mg_context *c) { return c->run->stop && *(const volatile int *)c->run->stop; }
