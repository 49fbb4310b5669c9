/* The modes of a run: which contacts are closed and which of these carry force, how friction and patches slip, on which
   branch loads are, how a contact starts to roll. This file alone writes them, but for the restart from a checkpoint.
 */
#include "model/model.h"

MG_INTERNAL void mg_set_active(const mg_context *c, int contact, int is_active) {
  MG_REQUIRE(contact >= 0 && contact < c->system->n_contact && (!is_active || c->run->closed[contact]));
  c->run->active[contact] = is_active;
}

MG_INTERNAL void mg_set_closed(const mg_context *c, int contact, int is_closed) {
  MG_REQUIRE(contact >= 0 && contact < c->system->n_contact);
  c->run->closed[contact] = is_closed;
  if (!is_closed) c->run->active[contact] = 0;
}

MG_INTERNAL void mg_close_contact(const mg_context *c, int contact) {
  mg_set_closed(c, contact, 1), mg_set_active(c, contact, 1);
}

MG_INTERNAL void mg_set_rolling_start(const mg_context *c, int contact, int start) {
  MG_REQUIRE(contact >= 0 && contact < c->system->n_contact && start >= MG_START_NONE && start <= MG_ON_STRAIGHT_EDGE);
  c->run->rolling_start[contact] = start;
}

MG_INTERNAL void mg_set_friction_mode(const mg_context *c, int constraint, int mode) {
  MG_REQUIRE(constraint >= 0 && constraint < c->system->n_friction && mode >= MG_FRICTION_OFF && mode <= MG_SLIPPING);
  c->run->friction_mode[constraint] = mode;
}

MG_INTERNAL void mg_take_over_modes(const mg_context *c, int from, int to) {
  const int *first = c->system->contact_friction,
            is_turned = c->contacts.o[from] == c->contacts.f[to] || c->contacts.f[from] == c->contacts.o[to];
  mg_set_closed(c, to, c->run->closed[from]), mg_set_active(c, to, c->run->active[from]);
  c->run->force[to] = c->run->force[from], c->run->reference_force[to] = c->run->reference_force[from];
  for (int g = first[from], h = first[to]; g < first[from + 1] && h < first[to + 1]; g++, h++) {
    const mg_real sign = is_turned && c->system->friction_kind[g] != MG_FRICTION_SPIN ? -1 : 1;
    mg_set_friction_mode(c, h, c->run->friction_mode[g]), mg_set_friction_mode(c, g, MG_FRICTION_OFF);
    c->friction.mode_before[h] = c->friction.mode_before[g], c->friction.mode_before[g] = MG_FRICTION_OFF;
    for (int k = 0; k < 3; k++) c->run->slip_direction[3 * h + k] = sign * c->run->slip_direction[3 * g + k];
  }
}

MG_INTERNAL void mg_set_patch_mode(const mg_context *c, int slot, int mode) {
  MG_REQUIRE(slot >= 0 && slot < c->system->n_patch_slot && mode >= MG_FRICTION_OFF && mode <= MG_SLIPPING);
  c->run->patch_mode[slot] = mode;
}

MG_INTERNAL void mg_set_branch(const mg_context *c, int which, mg_real branch) {
  MG_REQUIRE(which >= 0 && which < c->system->n_switch &&
             ((branch >= -1 && branch <= 1) || c->run->switch_mode[which] == MG_BRANCH_SLIDES));
  c->run->branch[which] = branch;
}

MG_INTERNAL void mg_set_switch_mode(const mg_context *c, int which, int mode) {
  MG_REQUIRE(which >= 0 && which < c->system->n_switch && mode >= MG_BRANCH_NEGATIVE && mode <= MG_BRANCH_SLIDES);
  c->run->switch_mode[which] = mode;
}

MG_INTERNAL void mg_set_switch_leader(const mg_context *c, int which, int leader) {
  MG_REQUIRE(which >= 0 && which < c->system->n_switch && leader >= -c->system->n_switch &&
             leader <= c->system->n_switch);
  c->run->switch_leader[which] = leader;
}
