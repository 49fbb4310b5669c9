/* Whether patches with friction stick or slip, and which way slip begins. */
#include "forces/forces.h"
#include "base/base.h"
#include "region/region.h"
#include "model/model.h"

#define MG_DIRECTION_STEPS 40

#define MG_RELEASES 8

static mg_real mg_rub_rest(const mg_context *c) {
  return c->settings->slip_speed * c->system->length / c->system->time;
}

/* The mean distance of the pressure at hand from its centre: what it rubs in a turn about that. */
static void mg_note_spread(mg_context *c, int slot) {
  const mg_pressure *p = &c->patches.pressure;
  const mg_real turn[3] = {0, 0, 1};
  mg_patch_friction *r = c->patches.friction + slot;
  mg_real G[3][3];
  mg_friction_matrix(p, turn, G);
  r->mean_distance = G[2][0] * p->coefficients[0] + G[2][1] * p->coefficients[1] + G[2][2] * p->coefficients[2];
  for (int k = 0; k < 2; k++) r->mean_point[k] = p->centre[k];
}

/* What is left at least of the bound of a stuck patch, told without its limit surface, and the force on it; negative
   where the surface has to tell. By the triangle inequality a twist rubs N |v| at least, and N (|w| spread - |v|), so
   that force and torque about the centre hold where |F| + 2 |T| / spread <= mu N; near the centre that the spread is
   of, half of it is left. */
static mg_real mg_left_easily(const mg_context *c, int slot, mg_real *N) {
  const mg_patch_friction *r = c->patches.friction + slot;
  const mg_real *force = c->force + mg_patch_friction_row(c, slot);
  mg_patch_frame at;
  mg_real world[3], x[3], F[2];
  *N = mg_pressure_resultant(c, slot, c->force, world);
  if (!(r->mean_distance > 0 && *N > 0)) return -1;
  mg_patch_axes(c, slot, &at);
  mg_to_local(at.pose, world, x);
  if (!(8 * mg_distance2(x, r->mean_point) <= r->mean_distance)) return -1;
  for (int k = 0; k < 2; k++) F[k] = force[0] * at.t[0][k] + force[1] * at.t[1][k];
  const mg_real arm[2] = {x[0] - at.pad[0][0], x[1] - at.pad[0][1]}, torque = at.sign * force[2] - mg_cross2(arm, F);
  return *N - (sqrt(mg_dot2(F, F)) + 4 * fabs(torque) / r->mean_distance) /
                  c->system->patch_friction[2 * mg_slot_patch(c, slot)];
}

/* N (1 - what it needs of its bound): what is left of the bound of a stuck patch; the twist against which it rubs, of
   the first pad's point and about N, along which slip would begin. */
static mg_real mg_rub_left(mg_context *c, int slot, mg_real *twist) {
  const mg_real mu = c->system->patch_friction[2 * mg_slot_patch(c, slot)];
  const mg_real *force = c->force + mg_patch_friction_row(c, slot);
  mg_patch_friction *r = c->patches.friction + slot;
  mg_patch_frame at;
  mg_real world[3], local[3], worst[3];
  const mg_real N = mg_pressure_resultant(c, slot, c->force, world);
  twist[0] = twist[1] = twist[2] = 0;
  if (!(N > 0)) return N;
  mg_patch_axes(c, slot, &at);
  mg_to_local(at.pose, world, local);
  r->centre[0] = local[0], r->centre[1] = local[1], r->centre_known = 1;
  mg_patch_pressure(c, slot);
  mg_note_spread(c, slot);
  const mg_real arm[2] = {r->centre[0] - at.pad[0][0], r->centre[1] - at.pad[0][1]};
  mg_real wrench[3];
  for (int k = 0; k < 2; k++) wrench[k] = force[0] * at.t[0][k] + force[1] * at.t[1][k];
  wrench[2] = at.sign * force[2] - mg_cross2(arm, wrench);
  const mg_real radius = c->patches.pressure.reach,
                share = mg_limit_surface_ratio(&c->patches.pressure, wrench, radius, worst) / (mu * N);
  const mg_real turn = worst[2] / radius, v[2] = {worst[0] + turn * arm[1], worst[1] - turn * arm[0]};
  twist[0] = -mg_dot2(at.t[0], v), twist[1] = -mg_dot2(at.t[1], v), twist[2] = -at.sign * turn;
  return N * (1 - share);
}

/* The function whose zero is the event of a patch with friction. */
MG_INTERNAL mg_real mg_patch_friction_value(mg_context *c, int slot, int cause) {
  mg_real twist[3];
  return cause == MG_FRICTION_EXCEEDED ? mg_rub_left(c, slot, twist) : mg_patch_slip_speed(c, slot);
}

/* MG_FRICTION_EXCEEDED, MG_SLIP_ENDS, or 0. Slip that has reached slip_speed is over below it; one that has not, once
 * it goes back as fast. */
MG_INTERNAL int mg_is_patch_friction_triggered(mg_context *c, int slot) {
  const int mode = c->run->patch_mode[slot], cause = mode == MG_STICKING ? MG_FRICTION_EXCEEDED : MG_SLIP_ENDS;
  mg_event_margin *left = mg_note_slot_margin(c, slot) + 2;
  if (!mg_is_frictional_slot(c, slot) || mode == MG_FRICTION_OFF) return 0;
  mg_real N = 0;
  const mg_real easily = mode == MG_STICKING ? mg_left_easily(c, slot, &N) : -1, slack = mg_patch_force_scale(c);
  if (easily >= 0) {
    left->lower = easily + slack, left->upper = N + slack;
    return 0;
  }
  const mg_real least = mode == MG_STICKING ? -slack : mode == MG_SLIPPING ? mg_rub_rest(c) : -mg_rub_rest(c);
  const mg_real value = mg_patch_friction_value(c, slot, cause) - least;
  if (mode == MG_STICKING && c->patches.friction[slot].force_outside) return 0; /* at the edge of its hull it tips */
  left->lower = left->upper = value;
  return value < 0 ? cause : 0;
}

/* Notes which way a patch slips. Returns 0 where it hardly does. */
static int mg_aim_rub(mg_context *c, int slot) {
  const mg_real *slip = c->d_dot + mg_patch_friction_row(c, slot), turn = slip[2] * mg_patch_radius(c, slot);
  if (!(sqrt(slip[0] * slip[0] + slip[1] * slip[1] + turn * turn) > 2 * mg_rub_rest(c))) return 0;
  mg_set_patch_slip_direction(c, slot, slip);
  return 1;
}

/* At the start of a step. */
MG_INTERNAL void mg_set_patch_slip_directions(mg_context *c) {
  for (int slot = 0; slot < c->system->n_slot; slot++) {
    int *mode = c->run->patch_mode + slot;
    if (mg_is_frictional_slot(c, slot) && *mode >= MG_SLIP_STARTING && mg_aim_rub(c, slot)) *mode = MG_SLIPPING;
    c->patches.friction[slot].mode_before = *mode;
  }
}

MG_INTERNAL void mg_clear_patch_friction(mg_context *c) {
  for (int slot = 0; slot < c->system->n_slot; slot++)
    c->run->patch_mode[slot] = MG_FRICTION_OFF, c->patches.friction[slot].triggered = 0;
}

/* The acceleration of slip, with spin in units of 1/radius. */
static void mg_rub_rate(const mg_context *c, int slot, mg_real *rate) {
  const int row = mg_patch_friction_row(c, slot);
  for (int k = 0; k < MG_PATCH_ROWS; k++) rate[k] = mg_gap_acceleration(c, row + k);
  rate[2] *= mg_patch_radius(c, slot);
}

/* The time in which slip, as it is going, is over; 0 if it is already. */
static mg_real mg_rub_ends_in(const mg_context *c, int slot) {
  const mg_real *course = c->run->patch_slip_direction + 4 * slot, *t = c->tangents + 6 * mg_slot_support(c, slot);
  mg_real rate[3];
  mg_rub_rate(c, slot, rate);
  const mg_real along = mg_patch_slip_speed(c, slot);
  const mg_real braking = -(rate[0] * mg_dot3(t, course) + rate[1] * mg_dot3(t + 3, course) + rate[2] * course[3]);
  return along > 0 && braking > 0 ? along / braking : 0;
}

/* Patches are told by their slip; those that hardly slip are stuck until the forces say otherwise. */
static void mg_sort_rubs(mg_context *c) {
  for (int slot = 0; slot < c->system->n_slot; slot++) {
    int *mode = c->run->patch_mode + slot;
    mg_patch_friction *r = c->patches.friction + slot;
    const int patch = mg_slot_patch(c, slot);
    r->mean_distance = 0;
    if (patch < 0 || !mg_has_patch_friction(c, patch)) continue;
    const int slips = *mode != MG_STICKING && mg_aim_rub(c, slot);
    r->slip_stopped = *mode >= MG_SLIP_ONSET && r->triggered && !slips;
    if (r->slip_stopped) r->slip_time_left = mg_rub_ends_in(c, slot);
    *mode = slips ? MG_SLIPPING : MG_STICKING;
  }
}

/* A course e, in the coordinates of mg_rub_rate, and the acceleration of slip under friction along it. */
static void mg_try_way(mg_context *c, int slot, const mg_real *e, mg_real *rate) {
  const mg_real twist[3] = {e[0], e[1], e[2] / mg_patch_radius(c, slot)};
  mg_set_patch_slip_direction(c, slot, twist);
  mg_update_rows_and_forces(c);
  mg_rub_rate(c, slot, rate);
}

static mg_real mg_dot_across(const mg_real *e, const mg_real *rate, mg_real across[2][3], mg_real *miss) {
  mg_orthogonal_pair(e, across);
  for (int j = 0; j < 2; j++) miss[j] = mg_dot3(across[j], rate);
  return sqrt(miss[0] * miss[0] + miss[1] * miss[1]);
}

/* Newton's step across a course, by differences, of half a radian at most; 0 where there is none. */
static int mg_way_step(mg_context *c, int slot, const mg_real *e, mg_real across[2][3], const mg_real *miss,
                       mg_real *step) {
  const mg_real turned = (mg_real)1 / 4096;
  mg_real A[4], rate[3], tried[3];
  for (int j = 0; j < 2; j++) {
    for (int i = 0; i < 2; i++) A[i + 2 * j] = 0;
    for (int sign = -1; sign <= 1; sign += 2) {
      for (int k = 0; k < 3; k++) tried[k] = e[k] + sign * turned * across[j][k];
      mg_try_way(c, slot, tried, rate);
      const mg_real forward = mg_dot3(e, rate);
      for (int i = 0; i < 2; i++) {
        const mg_real off = mg_dot3(across[i], rate) - (i == j ? sign * turned * forward : 0);
        A[i + 2 * j] += sign * off / (2 * turned);
      }
    }
  }
  const mg_real whole = A[0] * A[3] - A[1] * A[2];
  if (whole == 0) return 0;
  step[0] = -(A[3] * miss[0] - A[2] * miss[1]) / whole, step[1] = -(A[0] * miss[1] - A[1] * miss[0]) / whole;
  const mg_real size = sqrt(mg_dot2(step, step));
  for (int k = 0; k < 2 && size > (mg_real)0.5; k++) step[k] /= 2 * size;
  return 1;
}

/* Slip begins along its own acceleration: its course, from a guess e. */
static void mg_find_way(mg_context *c, int slot, mg_real *e) {
  mg_real rate[3], across[2][3], miss[2], step[2];
  mg_try_way(c, slot, e, rate);
  mg_real off = mg_dot_across(e, rate, across, miss);
  for (int i = 0; i < MG_DIRECTION_STEPS; i++) {
    const mg_real size = sqrt(mg_dot3(rate, rate));
    if (size <= mg_rest_acceleration(c) || off <= 64 * MG_EPS * size || !mg_way_step(c, slot, e, across, miss, step))
      break;
    mg_real next[3], part = 1, found = MG_MAX, across_next[2][3];
    for (; part > (mg_real)1 / 1024; part /= 2) {
      for (int k = 0; k < 3; k++) next[k] = e[k] + part * (step[0] * across[0][k] + step[1] * across[1][k]);
      const mg_real length = sqrt(mg_dot3(next, next));
      for (int k = 0; k < 3; k++) next[k] /= length;
      mg_try_way(c, slot, next, rate);
      found = mg_dot_across(next, rate, across_next, miss);
      if (found < off) break;
    }
    if (!(found < off)) break;
    for (int k = 0; k < 3; k++) e[k] = next[k], across[0][k] = across_next[0][k], across[1][k] = across_next[1][k];
    off = found;
  }
  mg_try_way(c, slot, e, rate);
}

/* Lets slip begin where a stuck patch is beyond its bound, or has just reached it; returns how many do. */
static int mg_release_rubs(mg_context *c) {
  int count = 0;
  for (int slot = 0; slot < c->system->n_slot; slot++) {
    mg_patch_friction *r = c->patches.friction + slot;
    mg_real twist[3];
    if (!mg_is_frictional_slot(c, slot) || c->run->patch_mode[slot] != MG_STICKING) continue;
    const int patch = mg_slot_patch(c, slot), reached = r->triggered && r->mode_before == MG_STICKING;
    const mg_real left = mg_rub_left(c, slot, twist), *mu = c->system->patch_friction + 2 * patch;
    if (!reached && left >= -mg_patch_force_scale(c)) continue;
    mg_real e[3] = {twist[0], twist[1], twist[2] * mg_patch_radius(c, slot)};
    mg_set_patch_slip_direction(c, slot, twist);
    const int gently = reached && mu[0] == mu[1];
    c->run->patch_mode[slot] = gently ? MG_SLIP_ONSET : MG_SLIP_STARTING, r->triggered = 0;
    if (!gently) mg_find_way(c, slot, e);
    count++;
  }
  return count;
}

/* As mg_solve_friction_modes, with the modes of patches. */
MG_INTERNAL int mg_solve_patch_modes(mg_context *c, const int *skip) {
  mg_sort_rubs(c);
  int outcome = mg_solve_friction_modes(c, skip);
  for (int round = 0; round < MG_RELEASES && !outcome && mg_release_rubs(c); round++)
    outcome = mg_solve_friction_modes(c, skip);
  for (int slot = 0; slot < c->system->n_slot; slot++) c->patches.friction[slot].triggered = 0;
  return outcome;
}

/* Tells of slip that begins, dies, or dies and begins anew. */
MG_INTERNAL void mg_report_patch_friction(mg_context *c, mg_events *events) {
  for (int slot = 0; slot < c->system->n_slot; slot++) {
    const int before = c->patches.friction[slot].mode_before, now = c->run->patch_mode[slot],
              pad = mg_slot_support(c, slot);
    const mg_real over = c->run->t + c->patches.friction[slot].slip_time_left;
    if (mg_is_frictional_slot(c, slot)) {
      if (before == MG_STICKING && now >= MG_SLIP_ONSET) mg_report_event(c, events, c->run->t, MG_EVENT_SLIP, pad, 0);
      if (before >= MG_SLIP_ONSET && now == MG_STICKING) mg_report_event(c, events, over, MG_EVENT_STICK, pad, 0);
      if (c->patches.friction[slot].slip_stopped && now == MG_SLIP_STARTING)
        mg_report_event(c, events, over, MG_EVENT_REVERSAL, pad, 0);
    }
    c->patches.friction[slot].slip_time_left = 0, c->patches.friction[slot].mode_before = now,
    c->patches.friction[slot].slip_stopped = 0;
  }
}
