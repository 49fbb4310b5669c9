/* Which branches the loads are on after state, modes or inputs have changed: by the signs of their switching functions,
   and where one is zero by the rates that it has on either branch (Filippov). Writes the branches of the run and the
   event list. */
#include "events/events.h"
#include "model/model.h"
#include "closest/closest.h"
#include "forces/forces.h"

enum { MG_BRANCH_ROUNDS = 6 }; /* most rounds in which branches are chosen one after another */

/* True if a switching function depends on the branch of another one of its load. */
static int mg_depends_on_branch(mg_context *c, int which, int other) {
  const int load = mg_load_of_switch(c->system, which);
  const mg_real *by_input, between = c->run->branch[other];
  mg_real up[MG_SWITCH_COLUMNS];
  int differs = 0;
  if (load != mg_load_of_switch(c->system, other)) return 0;
  mg_set_branch(c, other, 1);
  mg_copy_reals(up, mg_switch_gradient(c, c->run->t, load, which, &by_input), MG_SWITCH_COLUMNS);
  mg_set_branch(c, other, -1);
  const mg_real *down = mg_switch_gradient(c, c->run->t, load, which, &by_input);
  for (int k = 0; k < MG_SWITCH_COLUMNS; k++) differs |= up[k] != down[k];
  mg_set_branch(c, other, between);
  mg_switch_gradient(c, c->run->t, load, which, &by_input);
  return differs;
}

/* 1 or -1 if two switching functions that are zero have the same zeros: gradients by the same bodies along one line, in
   the same or the opposite direction, that do not depend on each other's branches; else 0. */
static int mg_same_surface(mg_context *c, int one, int other) {
  const mg_system *s = c->system;
  const int load = mg_load_of_switch(s, one), next = mg_load_of_switch(s, other);
  if (s->load_a[load] != s->load_a[next] || s->load_b[load] != s->load_b[next]) return 0;
  const mg_real *g = c->switches.slope + (long)MG_SWITCH_COLUMNS * one,
                *h = c->switches.slope + (long)MG_SWITCH_COLUMNS * other;
  mg_real gg = 0, gh = 0, rest = 0;
  for (int k = 0; k < MG_SWITCH_COLUMNS; k++) gg += g[k] * g[k], gh += g[k] * h[k];
  if (!(gg > 0) || gh == 0) return 0;
  for (int k = 0; k < MG_SWITCH_COLUMNS; k++) rest = mg_max(rest, fabs(h[k] - gh / gg * g[k]));
  if (rest > MG_SWITCH_ROUNDING * MG_EPS * fabs(gh) / sqrt(gg)) return 0;
  if (mg_depends_on_branch(c, one, other) || mg_depends_on_branch(c, other, one)) return 0;
  return gh > 0 ? 1 : -1;
}

/* True if a switching function is zero, or its event has triggered. */
static int mg_is_switch_at_zero(const mg_context *c, int which) {
  return c->switches.triggered[which] || c->run->switch_mode[which] == MG_BRANCH_SLIDES ||
         fabs(c->switches.value[which]) <= c->switches.noise[which];
}

/* Sets the mode of a switching function and of those at zero on the same surface. */
static void mg_set_surface_mode(mg_context *c, int which, int mode, mg_real branch) {
  for (int k = 0; k < c->system->n_switch; k++) {
    const int side = k == which ? 1 : c->switches.is_at_zero[k] ? mg_same_surface(c, which, k) : 0;
    if (!side) continue;
    mg_set_switch_mode(c, k, mode == MG_BRANCH_SLIDES ? mode : side * mode);
    mg_set_branch(c, k, side * branch);
    mg_set_switch_leader(c, k, k == which || mode != MG_BRANCH_SLIDES ? 0 : side * (which + 1));
  }
}

/* Puts all switching functions that are not zero on the branches of their signs. */
static int mg_set_branches_by_sign(mg_context *c) {
  int changed = 0;
  for (int k = 0; k < c->system->n_switch; k++) {
    const int side = c->switches.value[k] > 0 ? 1 : -1;
    if (c->switches.is_at_zero[k] || mg_is_switch_at_zero(c, k) || c->run->switch_mode[k] == side) continue;
    if (mg_is_returning_switch(c, k) && fabs(c->switches.value[k]) <= c->settings->tolerance * c->switches.size[k])
      continue;
    mg_set_switch_mode(c, k, side), mg_set_branch(c, k, side), mg_set_switch_leader(c, k, 0);
    mg_evaluate_run_state(c);
    changed = 1;
  }
  return changed;
}

/* Rates at which a switching function that is zero would leave it on a branch. */
typedef struct {
  int direction;   /* sign of the rate, or of that a moment later; 0: it stays zero */
  int determined;  /* 1: the branch decides of the rate, so that loads between the branches may keep it at zero */
  mg_real rate;    /* by which they would: first or second rate */
  int other_modes; /* digest of the modes of the other switching functions */
} mg_departure;

/* Digest of the modes of all switching functions but one and those on its surface. */
static int mg_other_modes(mg_context *c, int which) {
  int digest = 0;
  for (int k = 0; k < c->system->n_switch; k++)
    if (k != which && !(c->switches.is_at_zero[k] && mg_same_surface(c, which, k)))
      digest = 3 * digest % 1000003 + c->run->switch_mode[k] + 1;
  return digest;
}

/* Departure of a switching function on a branch, as which it is set. */
static mg_departure mg_departure_on_branch(mg_context *c, int which, int side) {
  const mg_real time = c->system->time;
  mg_set_surface_mode(c, which, side, side);
  mg_evaluate_run_state(c);
  mg_set_branches_by_sign(c); /* of functions that depend on this branch */
  const mg_real noise = c->switches.noise[which], *second = c->switches.second + 2 * which;
  mg_departure found = {0, 1, c->switches.rate[which], mg_other_modes(c, which)};
  if (second[0] > 0 && fabs(found.rate) <= c->settings->rest_speed * c->switches.size[which] / time)
    found.rate = second[1] * time;
  if (fabs(found.rate) > noise / time) {
    found.direction = found.rate > 0 ? 1 : -1;
    return found;
  }
  mg_update_switches(c, mg_extrapolate_poses(c));
  const mg_real later = c->switches.rate[which];
  mg_update_poses(c, c->run->t, c->run->x);
  found.direction = fabs(later) <= noise / time ? 0 : later > 0 ? 1 : -1, found.determined = 0;
  return found;
}

/* True if the load of a switching function that is zero is another one on its other branch. */
static int mg_is_jump(mg_context *c, int which) {
  const int load = mg_load_of_switch(c->system, which);
  const mg_real kept = c->run->branch[which];
  const int mode = c->run->switch_mode[which];
  mg_real up[12] = {0}, down[12] = {0}, apart = 0, size = 0;
  mg_set_switch_mode(c, which, MG_BRANCH_POSITIVE);
  mg_set_branch(c, which, 1), mg_load_wrench(c, c->run->t, load, up);
  mg_set_branch(c, which, -1), mg_load_wrench(c, c->run->t, load, down);
  mg_set_switch_mode(c, which, mode), mg_set_branch(c, which, kept);
  for (int i = 0; i < 12; i++) apart = mg_max(apart, fabs(up[i] - down[i])), size = mg_max(size, fabs(up[i]));
  return apart > c->settings->event_tolerance * size;
}

/* Number of switching functions that slide, each surface counted once. */
static int mg_slide_count(const mg_context *c) {
  int count = 0;
  for (int k = 0; k < c->system->n_switch; k++)
    count += c->run->switch_mode[k] == MG_BRANCH_SLIDES && !c->run->switch_leader[k];
  return count;
}

/* Chooses the branch at a zero; returns whether it is another one. Both branches may lead back to it, and yet no loads
   between them keep it there: then none is found. */
static int mg_choose_branch(mg_context *c, int which) {
  const int before = c->run->switch_mode[which];
  const mg_departure up = mg_departure_on_branch(c, which, 1), down = mg_departure_on_branch(c, which, -1);
  c->switches.shares[which] = !up.direction && !down.direction && mg_is_jump(c, which);
  const int leads_back = up.direction < 0 && down.direction > 0, sum = up.direction + down.direction;
  int mode = sum > 0 ? MG_BRANCH_POSITIVE : sum < 0 ? MG_BRANCH_NEGATIVE : MG_BRANCH_ZERO;
  if (leads_back && up.determined && down.determined) {
    mode = MG_BRANCH_SLIDES;
    if (up.other_modes != down.other_modes || mg_slide_count(c) == MG_SLIDING_MAX) c->switches.is_unresolved = 1;
  }
  c->switches.repels[which] = (up.direction > 0 && down.direction <= 0) || (up.direction == 0 && down.direction < 0);
  mg_set_surface_mode(c, which, mode, mode == MG_BRANCH_SLIDES ? (up.rate + down.rate) / (down.rate - up.rate) : mode);
  mg_evaluate_run_state(c);
  mg_set_branches_by_sign(c);
  return mode != before;
}

MG_INTERNAL int mg_settle_load_branches(mg_context *c, mg_events *events) {
  int changes = 0;
  if (!mg_has_branches(c)) return 0;
  mg_evaluate_run_state(c);
  for (int k = 0; k < c->system->n_switch; k++) c->switches.mode_before[k] = c->run->switch_mode[k];
  for (int round = 0, changed = 1; round < MG_BRANCH_ROUNDS && changed; round++) {
    for (int k = 0; k < c->system->n_switch; k++)
      c->switches.is_at_zero[k] = c->switches.repels[k] = c->switches.shares[k] = 0;
    changed = mg_set_branches_by_sign(c);
    for (int k = 0; k < c->system->n_switch; k++) c->switches.is_at_zero[k] = mg_is_switch_at_zero(c, k);
    for (int k = 0; k < c->system->n_switch; k++)
      if (c->switches.is_at_zero[k] && !c->run->switch_leader[k]) changed |= mg_choose_branch(c, k);
  }
  for (int k = 0; k < c->system->n_switch; k++) {
    c->switches.triggered[k] = 0;
    if (c->run->switch_mode[k] == c->switches.mode_before[k]) continue;
    changes++;
    if (events && c->switches.is_at_zero[k]) mg_append_event(c, events, c->run->t, MG_EVENT_LOAD_SWITCH, k, 0);
  }
  return changes;
}
