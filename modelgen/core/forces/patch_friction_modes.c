/* Friction modes of patches: whether they stick or slip, by the limit surface (Goyal, Ruina and Papadopoulos,
   Wear 143 (1991), 307-352), and the direction in which slip starts, along its own acceleration. Writes the patch
   modes and slip directions of the run and the patch friction workspace. */
#include "forces/forces.h"
#include "base/base.h"
#include "region/region.h"
#include "model/model.h"

#define MG_DIRECTION_STEPS 40 /* most steps in search of the direction of slip */

#define MG_SLIP_KEPT_PART 1024 /* slip_speed over what is left of slip across its direction if that does not turn */

#define MG_RELEASE_ROUNDS 8 /* most rounds in which sticking patches that yield are released */

/* Slip velocity in m/s below which a patch counts as sticking. */
static mg_real mg_patch_slip_tolerance(const mg_context *c) {
  return c->settings->slip_speed * c->system->length / c->system->time;
}

/* Store the mean distance of the present pressure from its centre, which bounds its friction torque, and that
   centre. */
static void mg_note_pressure_mean_distance(mg_context *c, int slot) {
  const mg_winkler_pressure_field *p = &c->patches.pressure;
  const mg_real turn[3] = {0, 0, 1};
  mg_patch_friction *r = c->patches.friction + slot;
  mg_real G[3][3];
  mg_friction_matrix(p, turn, G);
  r->mean_distance = G[2][0] * p->coefficients[0] + G[2][1] * p->coefficients[1] + G[2][2] * p->coefficients[2];
  for (int k = 0; k < 2; k++) r->mean_point[k] = p->centre[k];
}

/* Lower bound of the friction margin of a sticking patch that does not need the limit surface, and the normal
   force N; negative where the limit surface must be evaluated. By the triangle inequality a twist (v, w)
   dissipates at least N |v| and at least N (|w| r - |v|), r the mean distance of the pressure from its centre.
   Force F and torque T about the centre therefore stick where |F| + 2 |T| / r <= mu N. Near the centre for which
   r was computed, r/2 is used. */
static mg_real mg_friction_margin_lower_bound(const mg_context *c, int slot, mg_real *N) {
  const mg_patch_friction *r = c->patches.friction + slot;
  const mg_real *force = c->solution.force + mg_first_patch_friction_row(c, slot);
  mg_patch_frame at;
  mg_real world[3], x[3], F[2];
  *N = mg_support_resultant(c, slot, c->solution.force, world);
  if (!(r->mean_distance > 0 && *N > 0)) return -1;
  mg_set_patch_frame(c, slot, &at);
  mg_world_to_local_point(at.pose, world, x);
  if (!(8 * mg_distance2(x, r->mean_point) <= r->mean_distance)) return -1;
  for (int k = 0; k < 2; k++) F[k] = force[0] * at.t[0][k] + force[1] * at.t[1][k];
  const mg_real arm[2] = {x[0] - at.support[0][0], x[1] - at.support[0][1]},
                torque = at.sign * force[2] - mg_cross2(arm, F);
  return *N - (sqrt(mg_dot2(F, F)) + 4 * fabs(torque) / r->mean_distance) /
                  c->system->patch_friction[2 * mg_patch_of_slot(c, slot)];
}

MG_INTERNAL mg_real mg_patch_friction_margin(mg_context *c, int slot, mg_real *twist) {
  const mg_real mu = c->system->patch_friction[2 * mg_patch_of_slot(c, slot)];
  const mg_real *force = c->solution.force + mg_first_patch_friction_row(c, slot);
  mg_patch_friction *r = c->patches.friction + slot;
  mg_patch_frame at;
  mg_real world[3], local[3], dissipating_twist[3];
  const mg_real N = mg_support_resultant(c, slot, c->solution.force, world);
  twist[0] = twist[1] = twist[2] = 0;
  if (!(N > 0)) return N;
  mg_set_patch_frame(c, slot, &at);
  mg_world_to_local_point(at.pose, world, local);
  r->centre[0] = local[0], r->centre[1] = local[1], r->centre_known = MG_CENTRE_KNOWN;
  mg_update_patch_pressure(c, slot);
  mg_note_pressure_mean_distance(c, slot);
  const mg_real *centre = c->patches.pressure.centre,
                arm[2] = {centre[0] - at.support[0][0], centre[1] - at.support[0][1]};
  mg_real wrench[3];
  for (int k = 0; k < 2; k++) wrench[k] = force[0] * at.t[0][k] + force[1] * at.t[1][k];
  wrench[2] = at.sign * force[2] - mg_cross2(arm, wrench);
  const mg_real radius = c->patches.pressure.reach,
                used_part = mg_limit_surface_ratio(&c->patches.pressure, wrench, radius, dissipating_twist) / (mu * N);
  const mg_real turn = dissipating_twist[2] / radius,
                v[2] = {dissipating_twist[0] + turn * arm[1], dissipating_twist[1] - turn * arm[0]};
  twist[0] = -mg_dot2(at.t[0], v), twist[1] = -mg_dot2(at.t[1], v), twist[2] = -at.sign * turn;
  return N * (1 - used_part);
}

MG_INTERNAL mg_real mg_patch_friction_event_value(mg_context *c, int slot, int cause) {
  mg_real twist[3];
  return cause == MG_FRICTION_EXCEEDED ? mg_patch_friction_margin(c, slot, twist)
                                       : mg_patch_slip_along_direction(c, slot, c->rows.d_dot);
}

MG_INTERNAL int mg_find_patch_friction_event(mg_context *c, int slot) {
  const int mode = c->run->patch_mode[slot], cause = mode == MG_STICKING ? MG_FRICTION_EXCEEDED : MG_SLIP_ENDS;
  mg_event_margin *margin = mg_slot_event_margins(c, slot) + 2;
  if (!mg_is_slot_frictional(c, slot) || mode == MG_FRICTION_OFF) return 0;
  mg_real N = 0;
  const mg_real lower_bound = mode == MG_STICKING ? mg_friction_margin_lower_bound(c, slot, &N) : -1,
                slack = mg_force_tolerance(c);
  if (lower_bound >= 0) {
    margin->lower = lower_bound + slack, margin->upper = N + slack;
    return 0;
  }
  const mg_real threshold = mode == MG_STICKING   ? -slack
                            : mode == MG_SLIPPING ? mg_patch_slip_tolerance(c)
                                                  : -2 * mg_patch_slip_tolerance(c);
  const mg_real value = mg_patch_friction_event_value(c, slot, cause) - threshold;
  if (mode == MG_STICKING && c->patches.friction[slot].place) return 0; /* at the edge of its hull it tips */
  margin->lower = margin->upper = value;
  return value < 0 ? cause : 0;
}

/* Set the slip direction of a patch from its slip; returns 0 where the slip is too small. */
static int mg_update_patch_slip_direction(mg_context *c, int slot) {
  mg_real slip[3];
  mg_patch_slip_in_middle(c, slot, c->rows.d_dot + mg_first_patch_friction_row(c, slot), slip);
  if (!(sqrt(mg_dot3(slip, slip)) > 2 * mg_patch_slip_tolerance(c))) return 0;
  mg_set_patch_slip_direction(c, slot, slip);
  return 1;
}

MG_INTERNAL void mg_begin_step_patch_friction(mg_context *c) {
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    if (mg_is_slot_frictional(c, slot) && c->run->patch_mode[slot] >= MG_SLIP_STARTING &&
        mg_update_patch_slip_direction(c, slot))
      mg_set_patch_mode(c, slot, MG_SLIPPING);
    c->patches.friction[slot].mode_before = c->run->patch_mode[slot];
  }
}

MG_INTERNAL void mg_reset_patch_friction(mg_context *c) {
  for (int slot = 0; slot < c->system->n_patch_slot; slot++)
    mg_set_patch_mode(c, slot, MG_FRICTION_OFF), c->patches.friction[slot].triggered = 0;
}

/* Acceleration of slip in the middle of the supports, but for its centripetal part. */
static void mg_patch_slip_acceleration(const mg_context *c, int slot, mg_real *rate) {
  const int row = mg_first_patch_friction_row(c, slot);
  mg_real of_rows[MG_PATCH_ROWS];
  for (int k = 0; k < MG_PATCH_ROWS; k++) of_rows[k] = mg_row_acceleration(c, row + k);
  mg_patch_slip_in_middle(c, slot, of_rows, rate);
}

/* Direction of slip for which the friction of a patch is computed: its own, which may turn until slip ends, or the
   stored one where the slip is too small to tell. */
static void mg_patch_friction_direction(const mg_context *c, int slot, mg_real *e) {
  mg_real slip[3];
  mg_patch_slip_in_middle(c, slot, c->rows.d_dot + mg_first_patch_friction_row(c, slot), slip);
  if (mg_is_patch_slip_small(c, slot, slip)) mg_patch_slip_direction(c, slot, e);
  else {
    const mg_real size = sqrt(mg_dot3(slip, slip));
    for (int k = 0; k < 3; k++) e[k] = slip[k] / size;
  }
}

/* Time in s until the slip of a patch along the direction e stops at its present deceleration; 0 if it does not, or
   has. Then `left` is the slip that the present acceleration leaves. */
static mg_real mg_patch_slip_stop_time(const mg_context *c, int slot, const mg_real *e, mg_real *left) {
  const int support = mg_first_support(c, slot);
  const mg_real *d_dot = c->rows.d_dot + mg_first_patch_friction_row(c, slot), *t = c->rows.tangents + 6 * support;
  mg_real slip[3], rate[3], local[3], arm[3];
  mg_patch_slip_in_middle(c, slot, d_dot, slip);
  mg_patch_slip_acceleration(c, slot, rate);
  mg_middle_of_supports(c, slot, local);
  mg_to_world(c->bodies.pose + 12 * c->contacts.f[support], local, 0, arm);
  for (int k = 0; k < 2; k++) rate[k] -= d_dot[2] * d_dot[2] * mg_dot3(arm, t + 3 * k);
  const mg_real along = mg_dot3(slip, e), braking = -mg_dot3(rate, e),
                time = along > 0 && braking > 0 ? along / braking : 0;
  for (int k = 0; k < 3; k++) slip[k] += time * rate[k];
  *left = sqrt(mg_dot3(slip, slip));
  return time;
}

MG_INTERNAL mg_real mg_patch_slip_step_limit(const mg_context *c) {
  mg_real limit = MG_MAX, left, e[3];
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    const int mode = c->run->patch_mode[slot];
    if (!mg_is_slot_frictional(c, slot) || mode < MG_SLIP_STARTING) continue;
    if (mode == MG_SLIP_STARTING &&
        !(mg_patch_slip_along_direction(c, slot, c->rows.d_dot) > 2 * mg_patch_slip_tolerance(c)))
      continue;
    mg_patch_friction_direction(c, slot, e);
    const mg_real time = mg_patch_slip_stop_time(c, slot, e, &left);
    const int turns = c->step.follower || left > mg_patch_slip_tolerance(c) / MG_SLIP_KEPT_PART;
    if (time > 0 && turns) limit = mg_min(limit, time / 2);
  }
  return limit;
}

/* Set the modes of all patches from their slip before the mode problem is solved; one that hardly slips is taken
   as sticking. */
static void mg_initialise_patch_modes(mg_context *c) {
  mg_real left, e[3];
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    const int mode = c->run->patch_mode[slot];
    mg_patch_friction *r = c->patches.friction + slot;
    const int patch = mg_patch_of_slot(c, slot);
    r->mean_distance = 0;
    if (patch < 0 || !mg_has_patch_friction(c, patch)) continue;
    const int slips = mode != MG_STICKING && mg_update_patch_slip_direction(c, slot);
    r->slip_stopped = mode >= MG_SLIP_ONSET && r->triggered && !slips;
    if (r->slip_stopped) {
      mg_patch_friction_direction(c, slot, e);
      r->slip_time_left = mg_patch_slip_stop_time(c, slot, e, &left);
      mg_patch_slip_direction(c, slot, e);
      r->reversal_time_left = mg_patch_slip_stop_time(c, slot, e, &left);
    }
    mg_set_patch_mode(c, slot, slips ? MG_SLIPPING : MG_STICKING);
  }
}

/* Set the slip direction e of a patch and compute the slip acceleration under the friction along it. */
static void mg_evaluate_slip_direction(mg_context *c, int slot, const mg_real *e, mg_real *rate) {
  mg_set_patch_slip_direction(c, slot, e);
  mg_evaluate_run_state(c);
  mg_patch_slip_acceleration(c, slot, rate);
}

/* Components of an acceleration across the direction e; returns their norm. */
static mg_real mg_residual_across_direction(const mg_real *e, const mg_real *rate, mg_real across[2][3],
                                            mg_real *residual) {
  mg_complete_orthonormal_basis(e, across);
  for (int j = 0; j < 2; j++) residual[j] = mg_dot3(across[j], rate);
  return sqrt(residual[0] * residual[0] + residual[1] * residual[1]);
}

/* Newton step for the slip direction across e, by central differences, limited to half a radian; returns 0 where
   the matrix is singular, or the choice of modes takes too much work. */
static int mg_slip_direction_newton_step(mg_context *c, int slot, const mg_real *e, mg_real across[2][3],
                                         const mg_real *miss, mg_real *step) {
  const mg_real increment = (mg_real)1 / 4096;
  mg_real A[4], rate[3], tried[3];
  for (int j = 0; j < 2; j++) {
    for (int i = 0; i < 2; i++) A[i + 2 * j] = 0;
    for (int sign = -1; sign <= 1; sign += 2) {
      if (mg_is_mode_choice_too_costly(c)) return 0;
      for (int k = 0; k < 3; k++) tried[k] = e[k] + sign * increment * across[j][k];
      mg_evaluate_slip_direction(c, slot, tried, rate);
      const mg_real forward = mg_dot3(e, rate);
      for (int i = 0; i < 2; i++) {
        const mg_real deviation = mg_dot3(across[i], rate) - (i == j ? sign * increment * forward : 0);
        A[i + 2 * j] += sign * deviation / (2 * increment);
      }
    }
  }
  const mg_real determinant = A[0] * A[3] - A[1] * A[2];
  if (determinant == 0) return 0;
  step[0] = -(A[3] * miss[0] - A[2] * miss[1]) / determinant,
  step[1] = -(A[0] * miss[1] - A[1] * miss[0]) / determinant;
  const mg_real size = sqrt(mg_dot2(step, step));
  for (int k = 0; k < 2 && size > (mg_real)0.5; k++) step[k] /= 2 * size;
  return 1;
}

/* Find the slip direction along which the acceleration of slip points, by damped Newton iteration from a guess e,
   unless the choice of modes takes too much work. */
static void mg_find_slip_direction(mg_context *c, int slot, mg_real *e) {
  mg_real rate[3], across[2][3], miss[2], step[2];
  mg_evaluate_slip_direction(c, slot, e, rate);
  mg_real residual_norm = mg_residual_across_direction(e, rate, across, miss);
  for (int i = 0; i < MG_DIRECTION_STEPS; i++) {
    const mg_real size = sqrt(mg_dot3(rate, rate));
    if (size <= mg_acceleration_tolerance(c) || residual_norm <= 64 * MG_EPS * size ||
        !mg_slip_direction_newton_step(c, slot, e, across, miss, step))
      break;
    mg_real next[3], damping = 1, next_norm = MG_MAX, across_next[2][3];
    for (; damping > (mg_real)1 / 1024 && !mg_is_mode_choice_too_costly(c); damping /= 2) {
      for (int k = 0; k < 3; k++) next[k] = e[k] + damping * (step[0] * across[0][k] + step[1] * across[1][k]);
      const mg_real length = sqrt(mg_dot3(next, next));
      for (int k = 0; k < 3; k++) next[k] /= length;
      mg_evaluate_slip_direction(c, slot, next, rate);
      next_norm = mg_residual_across_direction(next, rate, across_next, miss);
      if (next_norm < residual_norm) break;
    }
    if (!(next_norm < residual_norm)) break;
    for (int k = 0; k < 3; k++) e[k] = next[k], across[0][k] = across_next[0][k], across[1][k] = across_next[1][k];
    residual_norm = next_norm;
  }
  mg_evaluate_slip_direction(c, slot, e, rate);
}

/* Let the sticking patches slip whose friction exceeds, or has just reached, its bound, and those that joints or
   driven bodies make slip; returns their number. */
static int mg_release_yielding_patches(mg_context *c) {
  int count = 0;
  for (int slot = 0; slot < c->system->n_patch_slot && !mg_is_mode_choice_too_costly(c); slot++) {
    mg_patch_friction *r = c->patches.friction + slot;
    mg_real twist[3], e[3];
    if (!mg_is_slot_frictional(c, slot) || c->run->patch_mode[slot] != MG_STICKING) continue;
    const int patch = mg_patch_of_slot(c, slot), bound_reached = r->triggered && r->mode_before == MG_STICKING;
    const mg_real margin = mg_patch_friction_margin(c, slot, twist), *mu = c->system->patch_friction + 2 * patch;
    mg_patch_slip_acceleration(c, slot, e);
    const int is_held = sqrt(mg_dot3(e, e)) <= mg_acceleration_tolerance(c);
    if (is_held && !bound_reached && margin >= -mg_force_tolerance(c)) continue;
    if (is_held) mg_patch_slip_in_middle(c, slot, twist, e);
    if (!(mg_dot3(e, e) > 0)) continue; /* a face without load, at rest, is at its bound and does not slip */
    mg_set_patch_slip_direction(c, slot, e);
    const int is_continuous = bound_reached && mu[0] == mu[1];
    mg_set_patch_mode(c, slot, is_continuous ? MG_SLIP_ONSET : MG_SLIP_STARTING), r->triggered = 0;
    if (!is_continuous) mg_find_slip_direction(c, slot, e);
    count++;
  }
  return count;
}

MG_INTERNAL int mg_solve_patch_friction_modes(mg_context *c, const int *skip) {
  c->step.chooses_modes = 1;
  mg_initialise_patch_modes(c);
  int outcome = mg_solve_friction_modes(c, skip);
  for (int round = 0;
       round < MG_RELEASE_ROUNDS && !outcome && mg_release_yielding_patches(c) && !mg_is_mode_choice_too_costly(c);
       round++)
    outcome = mg_solve_friction_modes(c, skip);
  if (!outcome && mg_is_mode_choice_too_costly(c)) outcome = MG_CHATTER;
  c->step.chooses_modes = 0;
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) c->patches.friction[slot].triggered = 0;
  return outcome;
}

MG_INTERNAL void mg_report_patch_friction_events(mg_context *c, mg_events *events) {
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    const int before = c->patches.friction[slot].mode_before, now = c->run->patch_mode[slot],
              support = mg_first_support(c, slot);
    const mg_real over = c->run->t + c->patches.friction[slot].slip_time_left;
    if (mg_is_slot_frictional(c, slot)) {
      if (before == MG_STICKING && now >= MG_SLIP_ONSET)
        mg_append_event(c, events, c->run->t, MG_EVENT_SLIP_START, support, 0);
      if (before >= MG_SLIP_ONSET && now == MG_STICKING)
        mg_append_event(c, events, over, MG_EVENT_SLIP_STOP, support, 0);
      if (c->patches.friction[slot].slip_stopped && now == MG_SLIP_STARTING)
        mg_append_event(c, events, c->run->t + c->patches.friction[slot].reversal_time_left, MG_EVENT_SLIP_REVERSAL,
                        support, 0);
    }
    c->patches.friction[slot].slip_time_left = 0, c->patches.friction[slot].mode_before = now,
    c->patches.friction[slot].slip_stopped = 0;
  }
}
