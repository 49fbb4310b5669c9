/* Whether the caller asks that the present call end (run->stop), from another thread or a signal handler. Writes
   nothing. */
#include "model/model.h"
#include "base/base.h"

MG_INTERNAL int mg_is_stopped(const mg_context *c) { return mg_is_raised(c->run->stop); }

MG_INTERNAL int mg_is_search_stopped(const mg_context *c) { return c->search.is_stoppable && mg_is_stopped(c); }
