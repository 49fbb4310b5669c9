/* Events of switching functions of loads: one passes zero, leaves zero, or the load that keeps it at zero reaches that
   of a branch. Reads c->switches and the branches of the run; writes event marks. */
#include "forces/forces.h"
#include "model/model.h"

MG_INTERNAL mg_real mg_switch_event_value(const mg_context *c, int which) {
  const int mode = c->run->switch_mode[which];
  if (mode == MG_BRANCH_SLIDES) return 1 - fabs(c->run->branch[which]);
  return mode == MG_BRANCH_ZERO ? c->switches.noise[which] - fabs(c->switches.value[which])
                                : mode * c->switches.value[which];
}

MG_INTERNAL mg_real mg_switch_event_margin(const mg_context *c, int which) {
  const int mode = c->run->switch_mode[which];
  if (!mg_has_branches(c) || c->run->switch_leader[which]) return MG_MAX;
  const mg_real slack = mode == MG_BRANCH_SLIDES ? c->settings->event_tolerance
                        : mode == MG_BRANCH_ZERO ? 0
                                                 : c->switches.noise[which] + c->switches.slack[which];
  return mg_min(mg_switch_event_value(c, which) + slack, MG_MAX);
}

MG_INTERNAL int mg_is_returning_switch(const mg_context *c, int which) {
  const int mode = c->run->switch_mode[which];
  return (mode == MG_BRANCH_POSITIVE || mode == MG_BRANCH_NEGATIVE) && mode * c->switches.value[which] < 0 &&
         mode * c->switches.rate[which] > 0;
}

MG_INTERNAL void mg_note_returning_switches(const mg_context *c) {
  for (int k = 0; k < c->system->n_switch; k++)
    c->switches.slack[k] = mg_is_returning_switch(c, k) ? 2 * fabs(c->switches.value[k]) : 0;
}

MG_INTERNAL int mg_mark_switch_events(const mg_context *c) {
  int count = 0;
  for (int k = 0; k < c->system->n_switch; k++) count += c->switches.triggered[k] = mg_switch_event_margin(c, k) < 0;
  return count;
}

MG_INTERNAL int mg_has_switch_event(const mg_context *c) {
  for (int k = 0; k < c->system->n_switch; k++)
    if (mg_switch_event_margin(c, k) < 0) return 1;
  return 0;
}

MG_INTERNAL int mg_first_switch_event(const mg_context *c) {
  for (int k = 0; k < c->system->n_switch; k++)
    if (c->switches.triggered[k]) return k;
  return -1;
}
