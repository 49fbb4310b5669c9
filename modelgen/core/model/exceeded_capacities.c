/* Capacities that a run exceeds: what was left out is counted by kind, so that the run can tell and is not trusted.
   Writes run->exceeded and run->exceeded_t. */
#include "model/model.h"

MG_INTERNAL void mg_note_exceeded(const mg_context *c, int capacity) {
  if (!c->run->exceeded[capacity]++) c->run->exceeded_t[capacity] = c->run->t;
}

MG_INTERNAL int mg_is_room_for_closed(const mg_context *c, int n) {
  if (n <= c->system->closed_capacity) return 1;
  mg_note_exceeded(c, MG_CAPACITY_CLOSED);
  return 0;
}
