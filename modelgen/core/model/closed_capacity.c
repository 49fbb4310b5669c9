/* Whether there is room for all contacts that are to be closed; the run tells if there is not. */
#include "model/model.h"

MG_INTERNAL int mg_is_room_for_closed(const mg_context *c, int n) {
  if (n <= c->system->closed_capacity) return 1;
  mg_report_exceeded(c->run, MG_CAPACITY_CLOSED);
  return 0;
}
