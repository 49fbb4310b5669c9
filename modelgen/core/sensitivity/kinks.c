/* Kinks: states at which accelerations or forces depend on the numbers of the scene in one way on one side, and in
   another way on the other side. A closed contact that carries no load is pressed or let go; friction that is exactly
   at its bound holds or slips; a load such as max(0, x) is on one branch or the other. Where the motion stays on a kink
   for the time of a step, a derivative exists on each side alone. A kink that the motion passes at once changes nothing
   of first order, unless something jumps there. Reads a state that is evaluated and its derivatives; writes only which
   contact is in doubt. */
#include "sensitivity/sensitivity.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/integrate.h"

#define MG_KINK_NOISE 4 /* times the tolerances of accelerations and forces of a run: what counts as zero */

enum { MG_CARRIES_NOTHING = 1, MG_IS_LET_BEAR = 2 }; /* of a contact in s->on_kink: active, and not so */

/* True if a closed contact neither carries a force nor is let go. */
static int mg_is_unloaded(const mg_context *c, int contact) {
  if (!c->run->closed[contact] || c->run->rolling_start[contact]) return 0;
  if (c->run->active[contact]) return fabs(c->solution.force[contact]) <= MG_KINK_NOISE * mg_force_tolerance(c);
  return fabs(mg_row_acceleration(c, contact)) <= MG_KINK_NOISE * mg_acceleration_tolerance(c);
}

/* True if a friction constraint is at its bound and rests: it holds as much as it can, or is about to slip. */
static int mg_is_at_bound(const mg_context *c, int contact, int constraint) {
  const int mode = c->run->friction_mode[constraint], row = mg_first_friction_row(c, contact, constraint);
  const mg_real noise = MG_KINK_NOISE * mg_force_tolerance(c);
  if (!c->run->active[contact] || mode == MG_FRICTION_OFF) return 0;
  if (mode == MG_STICKING)
    return mg_friction_event_value(c, contact, constraint) <=
           noise + 2 * c->settings->friction_bound_margin * fabs(c->solution.force[contact]);
  for (int k = 0; k < mg_friction_row_count(c, constraint); k++)
    if (fabs(c->rows.d_dot[row + k]) > mg_slip_velocity_tolerance(c, constraint) ||
        fabs(mg_row_acceleration(c, row + k)) > MG_KINK_NOISE * mg_acceleration_tolerance(c))
      return 0;
  return 1;
}

/* True if the forces of a face that rests are at a bound: none, centre of pressure on the edge, friction used up. After
   a step its margins are known. */
static int mg_is_face_at_bound(mg_context *c, int slot, int when) {
  const mg_event_margin *margins = mg_slot_event_margins(c, slot);
  const mg_real noise = (1 + MG_KINK_NOISE) * mg_force_tolerance(c);
  mg_real centre[3];
  if (mg_patch_of_slot(c, slot) < 0) return 0;
  const mg_real N = mg_support_resultant(c, slot, c->solution.force, centre);
  if (when == MG_AT_SAMPLE || fabs(N) <= noise) return fabs(N) <= noise;
  if (margins[1].upper <= 3 * c->settings->feature_border * c->system->length) return 1;
  return c->run->patch_mode[slot] == MG_STICKING &&
         margins[2].upper <= noise + 2 * c->settings->friction_bound_margin * N;
}

/* True if the load of a switching function is not continuous over its zero. */
static int mg_jumps_over_switch(mg_context *c, mg_real t, int which) {
  const int load = mg_load_of_switch(c->system, which), first = mg_switch_begin(c->system, load);
  const mg_real branch = c->run->branch[which];
  mg_real wrench[2][12] = {{0}}, change = 0, size = 0;
  for (int side = 0; side < 2; side++)
    c->run->branch[which] = side ? -1 : 1, mg_add_branch_wrench(c, t, load, first, 1, wrench[side]);
  c->run->branch[which] = branch;
  for (int k = 0; k < 12; k++)
    change = mg_max(change, fabs(wrench[0][k] - wrench[1][k])),
    size = mg_max(size, fabs(wrench[0][k]) + fabs(wrench[1][k]));
  return change > sqrt(c->settings->event_tolerance) * size;
}

/* True if a switching function of a load is zero: and stays so, or, at the start, the load jumps there. */
static int mg_is_switch_on_kink(mg_context *c, mg_real t, int which, int when) {
  const mg_switch_workspace *w = &c->switches;
  if (c->run->switch_leader[which] || fabs(w->value[which]) > w->noise[which]) return 0;
  const int stays = fabs(w->rate[which]) * c->system->time <= sqrt(c->settings->event_tolerance) * w->size[which];
  return when == MG_AT_SAMPLE || (when == MG_AFTER_STEP ? stays : mg_jumps_over_switch(c, t, which));
}

/* Marks in s->on_kink contacts, friction constraints and faces that are on a kink; returns whether there are any, or a
   switching function is. */
static int mg_mark_kinks(mg_context *c, mg_sensitivity *s, mg_real t, int when) {
  const mg_system *system = c->system;
  int any = 0, *friction = s->on_kink + system->n_contact, *face = friction + system->n_friction;
  for (int i = 0; i < system->n_contact + system->n_friction + system->n_patch_slot; i++) s->on_kink[i] = 0;
  for (int i = mg_next_row(c, -1); when != MG_AT_START && i < c->layout.support_begin; i = mg_next_row(c, i)) {
    if (mg_is_unloaded(c, i)) any = 1, s->on_kink[i] = c->run->active[i] ? MG_CARRIES_NOTHING : MG_IS_LET_BEAR;
    for (int g = system->contact_friction[i]; system->n_friction && g < system->contact_friction[i + 1]; g++)
      any |= friction[g] = mg_is_at_bound(c, i, g);
  }
  for (int slot = 0; when != MG_AT_START && slot < system->n_patch_slot; slot++)
    any |= face[slot] = mg_is_face_at_bound(c, slot, when);
  for (int k = 0; k < system->n_switch && mg_has_branches(c); k++) any |= mg_is_switch_on_kink(c, t, k, when);
  return any;
}

/* True if the derivatives of the forces on the supports of a face do more than grow all of them by the same part. */
static int mg_does_pressure_move(const mg_context *c, const mg_sensitivity *s, int slot, mg_real least) {
  const int first = mg_first_support(c, slot);
  const mg_real *N = c->solution.force + first, *dot = s->at.force + first, sum = N[0] + N[1] + N[2],
                sum_dot = dot[0] + dot[1] + dot[2];
  for (int k = 0; k < 3; k++)
    if (fabs(sum != 0 ? dot[k] - N[k] / sum * sum_dot : dot[k]) > least) return 1;
  return fabs(sum) <= MG_KINK_NOISE * mg_force_tolerance(c) && fabs(sum_dot) > least;
}

/* Why the direction that mg_rhs_tangent has treated leaves a kink, or 0. */
static int mg_leaves_kink(mg_context *c, mg_sensitivity *s, int direction, mg_real t, int when) {
  const mg_system *system = c->system;
  const mg_real part = MG_ROUNDED_TANGENT * s->size[direction],
                least = part * system->mass * system->length / (system->time * system->time);
  const int *friction = s->on_kink + system->n_contact, *face = friction + system->n_friction;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    s->doubtful = i;
    if (s->on_kink[i] && fabs(s->at.force[i]) > least) return MG_BY_UNLOADED;
    for (int g = system->contact_friction[i]; system->n_friction && g < system->contact_friction[i + 1]; g++) {
      const int row = mg_first_friction_row(c, i, g), is_held = c->run->friction_mode[g] == MG_STICKING;
      if (!friction[g]) continue;
      if (fabs(is_held ? mg_bound_tangent(c, s, direction, i, g) : s->at.force[i]) > least) return MG_BY_BOUND;
      for (int k = 0; !is_held && k < mg_friction_row_count(c, g); k++)
        if (fabs(s->at.rate[row + k]) > part * system->length / system->time) return MG_BY_BOUND;
    }
  }
  for (int slot = 0; slot < system->n_patch_slot; slot++) {
    if (!face[slot]) continue;
    s->doubtful = mg_first_support(c, slot);
    if (mg_does_pressure_move(c, s, slot, least)) return MG_BY_BOUND;
    if (mg_is_slot_frictional(c, slot) && mg_is_whole_plane(c, mg_patch_of_slot(c, slot)) &&
        fabs(mg_patch_bound_tangent(c, s, direction, slot)) > least)
      return MG_BY_BOUND;
  }
  s->doubtful = -1;
  for (int k = 0; k < system->n_switch && mg_has_branches(c); k++)
    if (mg_is_switch_on_kink(c, t, k, when) &&
        fabs(mg_switch_tangent(c, s, direction, t, k)) > part * c->switches.size[k])
      return MG_BY_LOAD_KINK;
  return when == MG_AT_START && mg_has_load_jump_along(c, s, t) ? MG_BY_LOAD_KINK : MG_NO_REASON;
}

MG_INTERNAL int mg_find_kink(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x, int when, int direction) {
  int reason = MG_NO_REASON;
  if (!mg_mark_kinks(c, s, t, when) && (when != MG_AT_START || !c->system->n_load)) return MG_NO_REASON;
  MG_NEEDS(c, MG_VALID_FORCES, t, x);
  for (int i = 0; i < c->system->n_contact; i++)
    if (s->on_kink[i] == MG_IS_LET_BEAR) c->run->active[i] = 1;
  MG_NOTE(c, MG_VALID_FORCES, t, x); /* contacts that are let bear carry nothing yet */
  mg_gather_wrenches(c, s, t);
  for (int j = 0; j < s->directions->n && !reason; j++) {
    if (direction >= 0 && j != direction) continue;
    mg_rhs_tangent(c, s, j, t, x, s->tangent->x + (long)j * c->layout.n_states, s->stage);
    reason = mg_leaves_kink(c, s, j, t, when);
  }
  for (int i = 0; i < c->system->n_contact; i++)
    if (s->on_kink[i] == MG_IS_LET_BEAR) c->run->active[i] = 0;
  MG_NOTE(c, MG_VALID_FORCES, t, x), MG_NOTE_WITH(c, MG_VALID_WRENCHES, MG_VALID_FORCES);
  return reason;
}

MG_INTERNAL int mg_does_contact_move(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x, int contact) {
  const mg_real part = sqrt(c->settings->event_tolerance);
  for (int j = 0; j < s->directions->n; j++) {
    mg_rhs_tangent(c, s, j, t, x, s->tangent->x + (long)j * c->layout.n_states, s->stage);
    const mg_real rounding = MG_ROUNDED_TANGENT * s->size[j] * c->system->length;
    if (fabs(s->at.value[contact]) > part * mg_gap_tangent_size(c, s, contact) + rounding ||
        fabs(s->at.rate[contact]) > part * mg_rate_tangent_size(c, s, contact) + rounding / c->system->time)
      return 1;
  }
  return 0;
}

MG_INTERNAL int mg_find_touching_contact(mg_context *c, mg_sensitivity *s) {
  const mg_real touching = c->settings->contact_gap * c->system->length,
                slow = c->settings->rest_speed * c->system->length / c->system->time;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    if (c->run->closed[i] || !mg_is_on_feature_pair(c, i)) continue;
    if (!(fabs(c->rows.d[i]) <= touching && fabs(c->rows.d_dot[i]) <= slow)) continue;
    if (mg_does_contact_move(c, s, c->run->t, c->run->x, i)) return i;
  }
  return -1;
}
