/* Events of grips: a stuck one reaches its bound, a slipping one comes to rest. */
#include "core.h"

/* N - |f / mu|, N: what is left of the bound of a stuck grip. */
static mg_real mg_grip_left(const mg_context *c, int contact, int grip) {
  const int row = mg_grip_row(c, contact, grip);
  const mg_real *mu = c->sys->grip_static + 2 * grip;
  const mg_real a = c->force[row] / mu[0], b = mg_grip_rows(c, grip) == 2 ? c->force[row + 1] / mu[1] : 0;
  return c->force[contact] - sqrt(a * a + b * b);
}

/* The event function of a grip, which falls through zero: force left, or slip left along the course. */
MG_INTERNAL mg_real mg_grip_value(const mg_context *c, int contact, int grip) {
  mg_real slip[2];
  return c->run->grip[grip] == MG_STUCK ? mg_grip_left(c, contact, grip) : mg_slip_along(c, contact, grip, slip);
}

/* What is left before the event of a grip; MG_MAX where it has none. Slip that has reached slip_speed is over below it; one that
   has not, once it goes back as fast. */
MG_INTERNAL mg_real mg_grip_strain(const mg_context *c, int contact, int grip) {
  const int mode = c->run->grip[grip];
  if (!c->run->active[contact] || mode == MG_LOOSE) return MG_MAX;
  const mg_real rest = mg_slip_rest(c, grip), slack = mg_slack(c) * c->sys->mass;
  const mg_real least = mode == MG_STUCK ? -slack : mode == MG_SLIPPING ? rest : -rest;
  return mg_grip_value(c, contact, grip) - least;
}

static int mg_has_fired(const mg_context *c, int contact, int grip) { return mg_grip_strain(c, contact, grip) < 0; }

/* Marks in c->slipped the grips whose event has fired; returns their number. Needs mg_rhs and mg_gap_rates. */
MG_INTERNAL int mg_grips_fired(mg_context *c) {
  int count = 0;
  for (int i = 0; i < c->sys->n_contact; i++)
    for (int g = c->sys->contact_grip[i]; g < c->sys->contact_grip[i + 1]; g++)
      count += c->slipped[g] = mg_has_fired(c, i, g);
  return count;
}

/* As mg_grips_fired at a stage, without marks. */
MG_INTERNAL int mg_grips_suspect(const mg_context *c) {
  for (int i = 0; i < c->sys->n_contact; i++)
    for (int g = c->sys->contact_grip[i]; g < c->sys->contact_grip[i + 1]; g++)
      if (mg_has_fired(c, i, g)) return 1;
  return 0;
}

MG_INTERNAL int mg_first_slipped(const mg_context *c) {
  for (int g = 0; g < c->sys->n_grip; g++)
    if (c->slipped[g]) return g;
  return -1;
}

MG_INTERNAL mg_real mg_slip_size(const mg_context *c, int contact, int grip) {
  mg_real slip[2];
  mg_slip_along(c, contact, grip, slip);
  return sqrt(slip[0] * slip[0] + slip[1] * slip[1]);
}

/* The course of a grip along its slip, in world axes. */
MG_INTERNAL void mg_set_on_course(mg_context *c, int contact, int grip) {
  const mg_real *t = c->tangents + 6 * contact, size = mg_slip_size(c, contact, grip);
  mg_real slip[2], *course = c->run->course + 3 * grip;
  mg_slip_along(c, contact, grip, slip);
  for (int k = 0; k < 3; k++) course[k] = (slip[0] * t[k] + slip[1] * t[3 + k]) / size;
  if (c->sys->grip_aspect[grip] == MG_SPIN) course[0] = slip[0] > 0 ? 1 : -1;
}

/* Notes where a grip slips. Returns 0 where it hardly does. */
MG_INTERNAL int mg_aim(mg_context *c, int contact, int grip) {
  if (!(mg_slip_size(c, contact, grip) > 2 * mg_slip_rest(c, grip))) return 0;
  mg_set_on_course(c, contact, grip);
  return 1;
}

/* At the start of a step: the courses that tell its forces, the modes that its events are told by. Needs the rows at
   run->x. */
MG_INTERNAL void mg_aim_all(mg_context *c) {
  for (int i = 0; i < c->sys->n_contact; i++)
    for (int g = c->sys->contact_grip[i]; g < c->sys->contact_grip[i + 1]; g++)
      if (c->run->active[i] && c->run->grip[g] >= MG_STARTING && mg_aim(c, i, g)) c->run->grip[g] = MG_SLIPPING;
  for (int g = 0; g < c->sys->n_grip; g++) c->before[g] = c->run->grip[g];
}
