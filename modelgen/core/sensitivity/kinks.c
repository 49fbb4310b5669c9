/* Kinks: states at which accelerations or forces depend on the numbers of the scene in one way on one side, and in
   another way on the other side. A closed contact that carries no load is pressed or let go; friction that is exactly
   at its bound holds or slips; a load such as max(0, x) is on one branch or the other. Where the motion stays on a kink
   for the time of a step, a derivative exists on each side alone: that of the branch on which the run is holds for
   changes that keep it. The margin of the branch (force, bound, gap, switching function) is zero in the run; the sign
   of its derivative tells which changes these are. A kink that the motion passes at once changes nothing of first
   order, unless something jumps there. Reads a state that is evaluated and its derivatives; writes only which contact
   is in doubt, and the sides. */
#include "sensitivity/sensitivity.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/integrate.h"

#define MG_KINK_NOISE 4 /* times the tolerances of accelerations and forces of a run: what counts as zero */

enum { MG_PRESSURE_AT_BOUND = 1, MG_FRICTION_AT_BOUND = 2 }; /* of a face in s->on_kink, as bits */

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

/* Which forces of a face that rests are at a bound: none at all, or their centre on the edge; friction used up. After a
   step its margins are known. */
static int mg_face_bounds(mg_context *c, int slot, int when) {
  const mg_event_margin *margins = mg_slot_event_margins(c, slot);
  const mg_real noise = (1 + MG_KINK_NOISE) * mg_force_tolerance(c);
  mg_real centre[3];
  if (mg_patch_of_slot(c, slot) < 0) return 0;
  const mg_real N = mg_support_resultant(c, slot, c->solution.force, centre);
  if (fabs(N) <= noise) return MG_PRESSURE_AT_BOUND | MG_FRICTION_AT_BOUND;
  if (when == MG_AT_SAMPLE) return 0;
  const int at_edge = margins[1].upper <= 3 * c->settings->feature_border * c->system->length,
            at_friction = c->run->patch_mode[slot] == MG_STICKING &&
                          margins[2].upper <= noise + 2 * c->settings->friction_bound_margin * N;
  return (at_edge ? MG_PRESSURE_AT_BOUND : 0) | (at_friction ? MG_FRICTION_AT_BOUND : 0);
}

/* True if the load of a switching function is not continuous over its zero. */
static int mg_jumps_over_switch(mg_context *c, mg_real t, int which) {
  const int load = mg_load_of_switch(c->system, which), first = mg_switch_begin(c->system, load);
  const mg_real branch = c->run->branch[which];
  mg_real wrench[2][12] = {{0}}, change = 0, size = 0;
  for (int side = 0; side < 2; side++)
    mg_set_branch(c, which, side ? -1 : 1), mg_add_branch_wrench(c, t, load, first, 1, wrench[side]);
  mg_set_branch(c, which, branch);
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

MG_INTERNAL int mg_mark_kinks(mg_context *c, mg_sensitivity *s, mg_real t, int when) {
  MG_NEEDS_TIME(c, t), MG_NEEDS_WITH(c, MG_VALID_SOLUTION, MG_VALID_TWISTS);
  const mg_system *system = c->system;
  int any = 0, *friction = s->on_kink + system->n_contact, *face = friction + system->n_friction;
  for (int i = 0; i < system->n_contact + system->n_friction + system->n_patch_slot; i++) s->on_kink[i] = 0;
  for (int i = mg_next_row(c, -1); when != MG_AT_START && i < c->layout.support_begin; i = mg_next_row(c, i)) {
    any |= s->on_kink[i] = mg_is_unloaded(c, i);
    for (int g = system->contact_friction[i]; system->n_friction && g < system->contact_friction[i + 1]; g++)
      any |= friction[g] = mg_is_at_bound(c, i, g);
  }
  for (int slot = 0; when != MG_AT_START && slot < system->n_patch_slot; slot++)
    any |= face[slot] = mg_face_bounds(c, slot, when);
  for (int k = 0; k < system->n_switch && mg_has_branches(c); k++) any |= mg_is_switch_on_kink(c, t, k, when);
  return any || (when == MG_AT_START && system->n_load);
}

MG_INTERNAL int mg_common_sides(int one, int other) {
  return (one & other & MG_SIDES) | ((one | other) & MG_SIDE_UNKNOWN);
}

/* The branch of the run holds for the changes in `sides` at most, for a reason that is noted if it is the first. */
static void mg_keep_sides(mg_sensitivity *s, int sides, int contact, int reason, int *first) {
  s->sides = mg_common_sides(s->sides, sides);
  if (sides != MG_SIDES && !*first) *first = reason, s->doubtful = contact;
}

/* Changes that make a margin of zero grow, by its derivative; both where that is rounding. */
static int mg_growing_sides(mg_real margin_dot, mg_real least) {
  if (fabs(margin_dot) <= least) return MG_SIDES;
  return margin_dot > 0 ? MG_SIDE_LARGER : margin_dot < 0 ? MG_SIDE_SMALLER : MG_SIDE_UNKNOWN; /* NaN */
}

/* Derivative of the acceleration of the gap of a contact without force. */
static mg_real mg_free_gap_acceleration(mg_context *c, mg_sensitivity *s, int direction, int contact,
                                        const mg_real *x) {
  const mg_real none[MG_ROWS_OF_ONE] = {0}, *dx = s->tangent->x + (long)direction * c->layout.n_states;
  const int eta = c->system->n_q + c->system->n_u + c->system->contact_eta[contact];
  mg_contact_tangent(c, s, direction, contact, x + eta, dx + eta, none, c->bodies.acceleration);
  return s->y_dot[MG_Y_ACCEL] + mg_row_times(c, contact, s->at.acceleration);
}

/* 1, -1 or 0: gap, else gap velocity of a contact grows, falls or hardly changes along the direction that
   mg_rhs_tangent has treated; the gap at the time `before` before. */
static int mg_opening(mg_context *c, mg_sensitivity *s, int direction, int contact, const mg_real *x, mg_real before) {
  const mg_real part = sqrt(c->settings->event_tolerance),
                rounding = MG_ROUNDED_TANGENT * s->size[direction] * c->system->length, rate = s->at.rate[contact],
                bend = before > 0 ? mg_free_gap_acceleration(c, s, direction, contact, x) : 0,
                gap = s->at.value[contact] - before * (rate - before * bend / 2);
  if (fabs(gap) > part * mg_gap_tangent_size(c, s, contact) + rounding) return gap > 0 ? 1 : -1;
  if (fabs(rate) > part * mg_rate_tangent_size(c, s, contact) + rounding / c->system->time) return rate > 0 ? 1 : -1;
  return 0;
}

/* Changes that keep a closed contact that carries no load as it is: pressed, or let go. */
static int mg_sides_of_unloaded(mg_context *c, mg_sensitivity *s, int direction, int contact, const mg_real *x,
                                mg_real least) {
  if (c->run->active[contact]) return mg_growing_sides(s->at.force[contact], least);
  const int opens = mg_opening(c, s, direction, contact, x, 0);
  if (opens) return opens > 0 ? MG_SIDE_LARGER : MG_SIDE_SMALLER;
  return mg_growing_sides(mg_free_gap_acceleration(c, s, direction, contact, x), least / c->system->mass);
}

/* Changes that keep friction that holds within its bound; of a contact without load, within the cone of what it is
   loaded with. */
static int mg_sides_of_held(const mg_context *c, const mg_sensitivity *s, int direction, int contact, int constraint,
                            mg_real least) {
  const int row = mg_first_friction_row(c, contact, constraint);
  const mg_real *mu = c->system->friction_static + 2 * constraint, N_dot = s->at.force[contact];
  mg_real used = 0;
  if (!s->on_kink[contact]) return mg_growing_sides(mg_bound_tangent(c, s, direction, contact, constraint), least);
  for (int k = 0; k < mg_friction_row_count(c, constraint); k++)
    used += s->at.force[row + k] * s->at.force[row + k] / (mu[k] * mu[k]);
  used = sqrt(used);
  if (fabs(N_dot) <= least && used <= least) return MG_SIDES;
  return (N_dot >= used ? MG_SIDE_LARGER : 0) | (-N_dot >= used ? MG_SIDE_SMALLER : 0);
}

/* True if slip that rests at its bound has other forces or rates along the direction. */
static int mg_does_slip_change(const mg_context *c, const mg_sensitivity *s, int direction, int contact, int constraint,
                               mg_real least) {
  const int row = mg_first_friction_row(c, contact, constraint);
  const mg_real slow = MG_ROUNDED_TANGENT * s->size[direction] * c->system->length / c->system->time;
  int changes = fabs(s->at.force[contact]) > least;
  for (int k = 0; k < mg_friction_row_count(c, constraint); k++) changes |= fabs(s->at.rate[row + k]) > slow;
  return changes;
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

/* Margin within the hull of the centre of the forces on the supports of a face, changed by `part` of their derivatives;
   negative where they do not press. */
static mg_real mg_moved_pressure_margin(mg_context *c, const mg_sensitivity *s, int slot, int is_loaded, mg_real part) {
  const int first = mg_first_support(c, slot);
  mg_real *force = c->solution.force + first, kept[3], centre[3], margin = -1;
  mg_nearest_boundary nearest;
  mg_copy_reals(kept, force, 3);
  for (int k = 0; k < 3; k++) force[k] = (is_loaded ? kept[k] : 0) + part * s->at.force[first + k];
  if (mg_support_resultant(c, slot, c->solution.force, centre) > 0)
    margin = mg_patch_hull_margin(c, mg_patch_of_slot(c, slot), centre, &nearest);
  mg_copy_reals(force, kept, 3);
  return margin;
}

/* Changes that keep the centre of the forces on a face within its hull. */
static int mg_sides_of_pressure(mg_context *c, mg_sensitivity *s, int slot, mg_real least) {
  const mg_real *N = c->solution.force + mg_first_support(c, slot), *dot = s->at.force + mg_first_support(c, slot),
                sum = N[0] + N[1] + N[2];
  const int is_loaded = fabs(sum) > (1 + MG_KINK_NOISE) * mg_force_tolerance(c);
  if (!mg_does_pressure_move(c, s, slot, least)) return MG_SIDES;
  if (c->run->patch_mode[slot] != MG_STICKING && !mg_is_whole_plane(c, mg_patch_of_slot(c, slot)))
    return MG_SIDE_UNKNOWN; /* the hull moves as well */
  const mg_real part = is_loaded ? c->settings->face_force_part * sum / mg_max_abs(3, dot) : 1,
                now = is_loaded ? mg_moved_pressure_margin(c, s, slot, 1, 0) : 0,
                kept = now - c->settings->face_centre_part * c->settings->face_force_part * c->system->length;
  return (mg_moved_pressure_margin(c, s, slot, is_loaded, part) >= kept ? MG_SIDE_LARGER : 0) |
         (mg_moved_pressure_margin(c, s, slot, is_loaded, -part) >= kept ? MG_SIDE_SMALLER : 0);
}

/* Changes that keep the friction of a face that holds within its bound. */
static int mg_sides_of_face_friction(mg_context *c, mg_sensitivity *s, int direction, int slot, mg_real least) {
  if (!mg_is_slot_frictional(c, slot) || c->run->patch_mode[slot] != MG_STICKING) return MG_SIDES;
  if (s->on_kink[c->system->n_contact + c->system->n_friction + slot] & MG_PRESSURE_AT_BOUND) {
    const int row = mg_first_patch_friction_row(c, slot);
    return mg_max_abs(MG_PATCH_ROWS, s->at.force + row) <= least ? MG_SIDES : MG_SIDE_UNKNOWN;
  }
  if (!mg_is_whole_plane(c, mg_patch_of_slot(c, slot))) return MG_SIDE_UNKNOWN;
  return mg_growing_sides(mg_patch_bound_tangent(c, s, direction, slot), least);
}

static void mg_leave_kinks_of_faces(mg_context *c, mg_sensitivity *s, int direction, mg_real least, int *first) {
  const int *face = s->on_kink + c->system->n_contact + c->system->n_friction;
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    const int support = mg_first_support(c, slot),
              sides[2] = {face[slot] & MG_PRESSURE_AT_BOUND ? mg_sides_of_pressure(c, s, slot, least) : MG_SIDES,
                          face[slot] & MG_FRICTION_AT_BOUND ? mg_sides_of_face_friction(c, s, direction, slot, least)
                                                            : MG_SIDES};
    for (int k = 0; k < 2; k++) mg_keep_sides(s, sides[k], support, MG_BY_BOUND, first);
  }
}

/* Up to what size the derivative of a force is rounding. */
static mg_real mg_force_tangent_rounding(const mg_context *c, const mg_sensitivity *s, int direction) {
  const mg_system *system = c->system;
  mg_real most = s->size[direction] * system->mass * system->length / (system->time * system->time);
  for (int b = 0; b < system->n_body; b++) {
    const mg_real *wrench_dot = s->at.wrench + 6 * b;
    most = mg_max(most, mg_max(mg_max_abs(3, wrench_dot), mg_max_abs(3, wrench_dot + 3) / system->length));
  }
  return MG_ROUNDED_TANGENT * most;
}

/* Changes that keep the branch of a load whose switching function is zero. */
static int mg_sides_of_switch(mg_context *c, mg_sensitivity *s, int direction, mg_real t, int which) {
  mg_real terms;
  const mg_real change = mg_switch_tangent(c, s, direction, t, which, &terms),
                branch = mg_differentiated_branch(c, which);
  const int sides = mg_growing_sides(branch > 0 ? change : -change,
                                     MG_ROUNDED_TANGENT * mg_max(s->size[direction] * c->switches.size[which], terms));
  const int is_known = fabs(branch) == 1 && (c->run->branch[which] != 0 || !mg_jumps_over_switch(c, t, which));
  return is_known || sides == MG_SIDES ? sides : MG_SIDE_UNKNOWN;
}

MG_INTERNAL int mg_leave_kinks(mg_context *c, mg_sensitivity *s, int direction, mg_real t, const mg_real *x, int when) {
  MG_NEEDS(c, MG_VALID_FORCES, t, x), MG_NEEDS_WITH(c, MG_VALID_WRENCHES, MG_VALID_FORCES);
  const mg_system *system = c->system;
  const int *friction = s->on_kink + system->n_contact;
  int first = MG_NO_REASON;
  s->sides = MG_SIDES, s->doubtful = -1;
  mg_rhs_tangent(c, s, direction, t, x, s->tangent->x + (long)direction * c->layout.n_states, s->stage);
  const mg_real least = mg_force_tangent_rounding(c, s, direction);
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    if (s->on_kink[i]) mg_keep_sides(s, mg_sides_of_unloaded(c, s, direction, i, x, least), i, MG_BY_UNLOADED, &first);
    for (int g = system->contact_friction[i]; system->n_friction && g < system->contact_friction[i + 1]; g++) {
      if (!friction[g]) continue;
      if (c->run->friction_mode[g] == MG_STICKING)
        mg_keep_sides(s, mg_sides_of_held(c, s, direction, i, g, least), i, MG_BY_BOUND, &first);
      else if (mg_does_slip_change(c, s, direction, i, g, least))
        mg_keep_sides(s, MG_SIDE_UNKNOWN, i, MG_BY_BOUND, &first);
    }
  }
  mg_leave_kinks_of_faces(c, s, direction, least, &first);
  for (int k = 0; k < system->n_switch && mg_has_branches(c); k++)
    if (mg_is_switch_on_kink(c, t, k, when))
      mg_keep_sides(s, mg_sides_of_switch(c, s, direction, t, k), -1, MG_BY_LOAD_KINK, &first);
  if (when == MG_AT_START && !first && mg_has_load_jump_along(c, s, t))
    mg_keep_sides(s, MG_SIDE_UNKNOWN, -1, MG_BY_LOAD_KINK, &first);
  return first;
}

MG_INTERNAL int mg_opening_of(mg_context *c, mg_sensitivity *s, int direction, mg_real t, const mg_real *x, int contact,
                              mg_real before) {
  MG_NEEDS(c, MG_VALID_FORCES, t, x), MG_NEEDS_WITH(c, MG_VALID_WRENCHES, MG_VALID_FORCES);
  mg_rhs_tangent(c, s, direction, t, x, s->tangent->x + (long)direction * c->layout.n_states, s->stage);
  return mg_opening(c, s, direction, contact, x, before);
}
