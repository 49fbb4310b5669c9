/* Friction of patches: a sticking patch holds the slip of its first support and its spin like a joint; a slipping
   one adds the friction that Coulomb's law at every point gives for the pressure between the faces (Winkler
   foundation, see friction_wrench). Friction shifts the pressure, and pressure determines the friction: at a given
   twist friction is linear in the pressure on a given loaded region, so that forces and pressure are solved for
   together, and the region is corrected by Newton's method, whose matrix is exact because the pressure vanishes where
   the region ends. Writes force ratios, forces and accelerations; does not change modes. */
#include "forces/forces.h"
#include "base/base.h"
#include "region/region.h"
#include "model/model.h"

#define MG_PRESSURE_ROUNDS 60 /* most steps of Newton's method for pressure and forces from one start */

#define MG_PRESSURE_STARTS 3 /* the centres found last, those noted by the run, the middles of the supports */

#define MG_PRESSURE_STEP_MIN ((mg_real)1 / 16) /* least part of a step that does not bring the pressure nearer */

MG_INTERNAL int mg_has_patch_friction(const mg_context *c, int patch) {
  return c->system->patch_friction[2 * patch + 1] > 0;
}

MG_INTERNAL int mg_is_slot_frictional(const mg_context *c, int slot) {
  const int patch = mg_patch_of_slot(c, slot);
  return patch >= 0 && mg_has_patch_friction(c, patch) && c->run->active[mg_first_support(c, slot)];
}

MG_INTERNAL int mg_first_patch_friction_row(const mg_context *c, int slot) {
  return c->layout.friction_row_begin + c->system->contact_friction_row[mg_first_support(c, slot)];
}

/* Slot of a row that is a support of a slipping patch, or -1. */
static int mg_slipping_slot_of_row(const mg_context *c, int row) {
  const int slot =
      row >= c->layout.support_begin && row < c->system->n_contact ? (row - c->layout.support_begin) / 3 : -1;
  return slot >= 0 && c->patches.friction[slot].slips ? slot : -1;
}

MG_INTERNAL mg_real mg_support_radius(const mg_context *c, int slot) {
  const mg_real *a = c->run->point + 3 * mg_first_support(c, slot), *b = a + 3;
  const mg_real arm[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  return sqrt(mg_dot3(arm, arm) / 3);
}

MG_INTERNAL void mg_set_patch_frame(const mg_context *c, int slot, mg_patch_frame *at) {
  const int support = mg_first_support(c, slot);
  mg_real world[3], local[3];
  mg_hull_pose(c, mg_patch_of_slot(c, slot), at->pose);
  at->sign = mg_dot3(at->pose + 9, c->rows.normal + 3 * support) > 0 ? 1 : -1;
  for (int i = 0; i < 3; i++) {
    mg_support_world_point(c, support + i, world);
    mg_world_to_local_point(at->pose, world, local);
    at->support[i][0] = local[0], at->support[i][1] = local[1];
    for (int k = 0; k < 2 && i < 2; k++)
      at->t[i][k] = mg_dot3(at->pose + 3 + 3 * k, c->rows.tangents + 6 * support + 3 * i);
  }
}

MG_INTERNAL void mg_middle_of_supports(const mg_context *c, int slot, mg_real *local) {
  const mg_real *p = c->run->point + 3 * mg_first_support(c, slot);
  for (int k = 0; k < 3; k++) local[k] = (p[k] + p[3 + k] + p[6 + k]) / 3 - p[k];
}

/* Velocities along t1 and t2 in the middle of the supports, less those of the first, for a unit spin. */
static void mg_middle_levers(const mg_context *c, int slot, mg_real *lever) {
  const int support = mg_first_support(c, slot);
  const mg_real *t = c->rows.tangents + 6 * support;
  mg_real local[3], arm[3];
  mg_middle_of_supports(c, slot, local);
  mg_to_world(c->bodies.pose + 12 * c->contacts.f[support], local, 0, arm);
  lever[0] = -mg_dot3(arm, t + 3), lever[1] = mg_dot3(arm, t);
}

MG_INTERNAL void mg_patch_slip_in_middle(const mg_context *c, int slot, const mg_real *rate, mg_real *out) {
  mg_real lever[2];
  mg_middle_levers(c, slot, lever);
  for (int k = 0; k < 2; k++) out[k] = rate[k] + rate[2] * lever[k];
  out[2] = rate[2] * mg_support_radius(c, slot);
}

/* The inverse. */
static void mg_patch_slip_of_first_support(const mg_context *c, int slot, const mg_real *in_middle, mg_real *slip) {
  mg_real lever[2];
  mg_middle_levers(c, slot, lever);
  slip[2] = in_middle[2] / mg_support_radius(c, slot);
  for (int k = 0; k < 2; k++) slip[k] = in_middle[k] - slip[2] * lever[k];
}

MG_INTERNAL void mg_patch_slip_direction(const mg_context *c, int slot, mg_real *e) {
  const mg_real *direction = c->run->patch_slip_direction + 4 * slot,
                *t = c->rows.tangents + 6 * mg_first_support(c, slot);
  e[0] = mg_dot3(t, direction), e[1] = mg_dot3(t + 3, direction), e[2] = direction[3];
}

MG_INTERNAL mg_real mg_patch_slip_along_direction(const mg_context *c, int slot, const mg_real *rate) {
  mg_real e[3], slip[3];
  mg_patch_slip_direction(c, slot, e);
  mg_patch_slip_in_middle(c, slot, rate + mg_first_patch_friction_row(c, slot), slip);
  return mg_dot3(slip, e);
}

MG_INTERNAL void mg_set_patch_slip_direction(mg_context *c, int slot, const mg_real *slip) {
  const mg_real *t = c->rows.tangents + 6 * mg_first_support(c, slot), size = sqrt(mg_dot3(slip, slip));
  mg_real *direction = c->run->patch_slip_direction + 4 * slot;
  for (int k = 0; k < 3; k++) direction[k] = (slip[0] * t[k] + slip[1] * t[3 + k]) / size;
  direction[3] = slip[2] / size;
}

MG_INTERNAL void mg_complete_orthonormal_basis(const mg_real *e, mg_real across[2][3]) {
  const int least = fabs(e[0]) < fabs(e[1]) ? (fabs(e[0]) < fabs(e[2]) ? 0 : 2) : fabs(e[1]) < fabs(e[2]) ? 1 : 2;
  for (int k = 0; k < 3; k++) across[0][k] = (k == least) - e[least] * e[k];
  const mg_real size = sqrt(mg_dot3(across[0], across[0]));
  for (int k = 0; k < 3; k++) across[0][k] /= size;
  mg_cross_product(e, across[0], across[1]);
}

MG_INTERNAL void mg_patch_slip_basis(const mg_context *c, int slot, mg_real e[3][3]) {
  mg_patch_slip_direction(c, slot, e[0]);
  mg_complete_orthonormal_basis(e[0], e + 1);
}

MG_INTERNAL int mg_is_patch_slip_small(const mg_context *c, int slot, const mg_real *in_middle) {
  const mg_real least = (c->run->patch_mode[slot] == MG_SLIPPING ? (mg_real)0.5 : 2) * c->settings->slip_speed;
  return sqrt(mg_dot3(in_middle, in_middle)) <= least * c->system->length / c->system->time;
}

/* Slip from which the friction of a patch is computed: its own, reversed where it points against the stored direction;
   that direction where the slip is too small to tell one; the direction that is being solved for where slip starts.
   Returns 1, -1 and 0 in turn. */
static int mg_patch_slip_twist(const mg_context *c, int slot, mg_real *twist) {
  const mg_real *slip = c->rows.d_dot + mg_first_patch_friction_row(c, slot),
                *steer = c->patches.friction[slot].slip_direction;
  const int is_solved_for = c->friction.follows_angle && c->run->patch_mode[slot] == MG_SLIP_ONSET;
  mg_real e[3][3], in_middle[3];
  mg_patch_slip_basis(c, slot, e);
  mg_patch_slip_in_middle(c, slot, slip, in_middle);
  if (!is_solved_for && !mg_is_patch_slip_small(c, slot, in_middle)) {
    const int sign = mg_dot3(in_middle, e[0]) < 0 ? -1 : 1;
    for (int k = 0; k < 3; k++) twist[k] = sign * slip[k];
    return sign;
  }
  for (int k = 0; k < 3; k++) in_middle[k] = e[0][k] + (is_solved_for ? steer[0] * e[1][k] + steer[1] * e[2][k] : 0);
  mg_patch_slip_of_first_support(c, slot, in_middle, twist);
  return 0;
}

MG_INTERNAL void mg_note_pressure_starts(mg_context *c) {
  for (int slot = 0; slot < c->system->n_patch_slot && c->system->n_friction; slot++) {
    const mg_real *force = c->run->force + mg_first_support(c, slot), sum = force[0] + force[1] + force[2];
    for (int i = 0; i < 3; i++) c->run->patch_support_share[3 * slot + i] = sum > 0 ? force[i] / sum : 0;
  }
}

MG_INTERNAL void mg_start_patch_pressures(mg_context *c) {
  for (int slot = 0; slot < c->system->n_patch_slot && c->system->n_friction; slot++)
    c->patches.friction[slot].centre_known = MG_CENTRE_NOTED;
}

/* Places the centre of pressure where it was noted, or in the middle of the supports. */
static void mg_place_starting_centre(mg_context *c, int slot) {
  mg_patch_friction *r = c->patches.friction + slot;
  const mg_real *share = c->run->patch_support_share + 3 * slot;
  mg_patch_frame at;
  mg_set_patch_frame(c, slot, &at);
  if (share[0] == 0 && share[1] == 0 && share[2] == 0) r->centre_known = MG_CENTRE_UNKNOWN;
  for (int k = 0; k < 2; k++) {
    r->centre[k] = 0;
    for (int i = 0; i < 3; i++)
      r->centre[k] += (r->centre_known == MG_CENTRE_NOTED ? share[i] : (mg_real)1 / 3) * at.support[i][k];
  }
}

MG_INTERNAL void mg_update_patch_pressure(mg_context *c, int slot) {
  mg_patch_friction *r = c->patches.friction + slot;
  mg_winkler_pressure_field *p = &c->patches.pressure;
  mg_count_pressure(c);
  mg_overlay_patch_regions(c, mg_patch_of_slot(c, slot));
  mg_open_pressure(p, &c->patches.hull, c->patches.strip_capacity, c->patches.strips);
  if (r->centre_known != MG_CENTRE_KNOWN) mg_place_starting_centre(c, slot);
  mg_real inside[2] = {r->centre[0], r->centre[1]};
  r->place = r->centre_known ? mg_move_inside_hull(&c->patches.hull, inside) : MG_INSIDE_HULL;
  const int found = r->centre_known && mg_winkler_pressure(p, 1, inside), failed = r->centre_known && !found;
  if (!found) {
    r->centre_known = MG_CENTRE_UNKNOWN;
    mg_place_starting_centre(c, slot);
    mg_uniform_pressure(p, r->centre);
    r->place = MG_INSIDE_HULL;
  }
  if (p->overflow) mg_report_exceeded(c->run, MG_CAPACITY_REGION);
  r->partly_unloaded = p->partly_unloaded || failed, r->extent = p->reach;
}

/* Moves a centre of pressure near the boundary of a hull, or outside it, to the one for which its friction is found. At
   a curved edge that is where the pressure is found, because the loaded region shrinks to a point whose slip may come
   to rest; behind straight edges friction goes on linearly from there to as far outside. Returns whether it was moved.
 */
static int mg_move_to_friction_centre(const mg_hull *h, int place, mg_real *x) {
  return place == MG_AT_CURVE ? mg_move_inside_hull(h, x) != MG_INSIDE_HULL
                              : place == MG_AT_STRAIGHT_EDGES && mg_move_near_hull(h, x);
}

/* The centre for which friction is found, and its derivatives by the centre x. */
static void mg_friction_centre(const mg_hull *h, int place, const mg_real *x, mg_real step, mg_real *centre,
                               mg_real by[2][2]) {
  for (int k = 0; k < 2; k++) centre[k] = x[k], by[k][k] = 1, by[k][1 - k] = 0;
  if (!mg_move_to_friction_centre(h, place, centre)) return;
  for (int k = 0; k < 2; k++) {
    mg_real ahead[2] = {x[0], x[1]}, behind[2] = {x[0], x[1]};
    ahead[k] += step, behind[k] -= step;
    mg_move_to_friction_centre(h, place, ahead), mg_move_to_friction_centre(h, place, behind);
    for (int i = 0; i < 2; i++) by[i][k] = (ahead[i] - behind[i]) / (2 * step);
  }
}

MG_INTERNAL void mg_find_patch_friction(mg_context *c, int slot, mg_patch_slip *slip) {
  const mg_real mu = c->system->patch_friction[2 * mg_patch_of_slot(c, slot) + 1];
  const mg_winkler_pressure_field *p = &c->patches.pressure;
  const mg_patch_friction *r = c->patches.friction + slot;
  mg_patch_frame *at = &slip->at;
  mg_real G[3][3], centre[2], by[2][2];
  mg_update_patch_pressure(c, slot);
  mg_friction_centre(&c->patches.hull, r->place, r->centre, p->reach / 1024, centre, by);
  mg_set_patch_frame(c, slot, at);
  for (int k = 0; k < 2; k++) slip->offset[k] = p->centre[k] - at->support[0][k];
  slip->twist[2] = at->sign * slip->slip[2];
  slip->twist[0] = slip->slip[0] * at->t[0][0] + slip->slip[1] * at->t[1][0] - slip->twist[2] * slip->offset[1];
  slip->twist[1] = slip->slip[0] * at->t[0][1] + slip->slip[1] * at->t[1][1] + slip->twist[2] * slip->offset[0];
  mg_friction_matrix(p, slip->twist, G);
  for (int i = 0; i < 3; i++) {
    const mg_real arm[2] = {at->support[i][0] - r->centre[0], at->support[i][1] - r->centre[1]};
    mg_real moment[3] = {1, 0, 0}, *level = slip->level[i];
    for (int k = 0; k < 2; k++) moment[1 + k] = centre[k] - p->centre[k] + mg_dot2(by[k], arm);
    if (!mg_solve_moments(p, moment, level))
      for (int k = 0; k < 3; k++) level[k] = p->coefficients[k];
    for (int k = 0; k < 3; k++) slip->force[i][k] = mu * (G[k][0] * level[0] + G[k][1] * level[1] + G[k][2] * level[2]);
  }
}

MG_INTERNAL void mg_find_patch_slip(mg_context *c, int slot, mg_patch_slip *slip) {
  MG_NEEDS_WITH(c, MG_VALID_SLIP, MG_VALID_TWISTS);
  slip->turned = mg_patch_slip_twist(c, slot, slip->slip);
  mg_find_patch_friction(c, slot, slip);
}

/* Set the ratios of the friction of a slipping patch, along its three rows, to the force on each support. */
static void mg_set_patch_force_ratio(mg_context *c, int slot) {
  const int row = mg_first_patch_friction_row(c, slot);
  mg_patch_friction *r = c->patches.friction + slot;
  mg_patch_slip slip;
  mg_find_patch_slip(c, slot, &slip);
  for (int i = 0; i < 3; i++) {
    const mg_real *force = slip.force[i];
    for (int k = 0; k < 2; k++) r->force_ratio[k][i] = slip.at.t[k][0] * force[0] + slip.at.t[k][1] * force[1];
    r->force_ratio[2][i] = slip.at.sign * (force[2] + mg_cross2(slip.offset, force));
  }
  for (int k = 0; k < MG_PATCH_ROWS; k++) mg_update_inverse_mass_row(c, row + k);
}

MG_INTERNAL void mg_set_patch_force_ratios(mg_context *c) {
  MG_NEEDS_WITH(c, MG_VALID_SLIP, MG_VALID_TWISTS);
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    mg_patch_friction *r = c->patches.friction + slot;
    r->slips = mg_is_slot_frictional(c, slot) && c->run->patch_mode[slot] >= MG_SLIP_ONSET;
    if (!r->slips) continue;
    mg_set_patch_force_ratio(c, slot);
    for (int k = 0; k < MG_PATCH_ROWS; k++)
      c->friction.force_ratio[mg_first_patch_friction_row(c, slot) - c->layout.friction_row_begin + k] = 1;
  }
}

/* Part of the step of Newton's method from the centre of pressure inside the hull that leaves a part of the margin
   there, because friction varies the more the smaller the loaded region is. */
static mg_real mg_inner_part_of_step(mg_context *c, int slot, const mg_real *step) {
  mg_nearest_boundary nearest;
  const mg_real *from = c->patches.friction[slot].centre;
  mg_overlay_patch_regions(c, mg_patch_of_slot(c, slot));
  const mg_real least = mg_hull_margin(&c->patches.hull, from, &nearest) / 4;
  for (mg_real part = 1; part > sqrt(MG_EPS); part /= 2) {
    const mg_real next[2] = {from[0] + part * step[0], from[1] + part * step[1]};
    if (mg_hull_margin(&c->patches.hull, next, &nearest) >= least) return part;
  }
  return sqrt(MG_EPS);
}

/* Takes a step of Newton's method from the centre of pressure for which the force ratios hold, of which the whole leads
   to the centre of the forces found with them; half of the step before if this one is hardly shorter. Returns whether
   the ratios hold for the new centre: neither pressure lifts off part of the face, or the centres agree. Steps that get
   no shorter once they are small beside the hull are rounding, which a small loaded region amplifies. */
static int mg_step_to_centre(mg_context *c, int slot, const mg_real *centre) {
  mg_patch_friction *r = c->patches.friction + slot;
  const int was_cut = r->partly_unloaded || r->place;
  const mg_real step[2] = {centre[0] - r->centre[0], centre[1] - r->centre[1]}, size = sqrt(mg_dot2(step, step));
  const int stalls = c->patches.pressure_rounds % MG_PRESSURE_ROUNDS > 0 &&
                     size > (1 - r->part / 4) * sqrt(mg_dot2(r->step, r->step)),
            agrees = size <= sqrt(MG_EPS) * (stalls ? c->patches.hull.size : r->extent);
  if (stalls && !agrees && r->part > MG_PRESSURE_STEP_MIN) {
    r->part /= 2;
    for (int k = 0; k < 2; k++) r->centre[k] -= r->part * r->step[k];
    return 0;
  }
  r->part = r->place || agrees ? 1 : mg_inner_part_of_step(c, slot, step);
  for (int k = 0; k < 2; k++) r->step[k] = step[k], r->centre[k] += r->part * step[k];
  r->centre_known = MG_CENTRE_KNOWN;
  if (was_cut || r->part < 1) return agrees;
  mg_update_patch_pressure(c, slot);
  return !r->partly_unloaded && !r->place;
}

MG_INTERNAL int mg_has_changed_patch_pressures(mg_context *c) {
  int count = 0;
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    mg_real world[3], pose[12], centre[3];
    if (!c->patches.friction[slot].slips || !(mg_support_resultant(c, slot, c->solution.force, world) > 0)) continue;
    mg_hull_pose(c, mg_patch_of_slot(c, slot), pose);
    mg_world_to_local_point(pose, world, centre);
    if (mg_step_to_centre(c, slot, centre)) continue;
    mg_set_patch_force_ratio(c, slot);
    count++;
  }
  if (count == 0) return 0;
  if (++c->patches.pressure_rounds % MG_PRESSURE_ROUNDS > 0) return 1;
  const int is_start_left = mg_are_patch_pressures_found(c);
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    mg_patch_friction *r = c->patches.friction + slot;
    if (!r->slips) continue;
    r->centre_known =
        is_start_left && c->patches.pressure_rounds > MG_PRESSURE_ROUNDS ? MG_CENTRE_UNKNOWN : MG_CENTRE_NOTED;
    if (is_start_left) mg_set_patch_force_ratio(c, slot);
  }
  return is_start_left;
}

MG_INTERNAL int mg_are_patch_pressures_found(const mg_context *c) {
  return c->patches.pressure_rounds < MG_PRESSURE_STARTS * MG_PRESSURE_ROUNDS;
}

MG_INTERNAL int mg_list_patch_slip_rows(const mg_context *c, int row, int *list, mg_real *ratio) {
  const int slot = mg_slipping_slot_of_row(c, row), support = (row - c->layout.support_begin) % 3;
  for (int k = 0; k < MG_PATCH_ROWS && slot >= 0; k++) {
    list[k] = mg_first_patch_friction_row(c, slot) + k;
    ratio[k] = c->patches.friction[slot].force_ratio[k][support];
  }
  return slot >= 0 ? MG_PATCH_ROWS : 0;
}

MG_INTERNAL void mg_apply_patch_slip_forces(mg_context *c) {
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    const mg_patch_friction *r = c->patches.friction + slot;
    const mg_real *N = c->solution.force + mg_first_support(c, slot);
    for (int k = 0; k < MG_PATCH_ROWS && r->slips; k++) {
      const int row = mg_first_patch_friction_row(c, slot) + k;
      c->solution.force[row] =
          -(r->force_ratio[k][0] * N[0] + r->force_ratio[k][1] * N[1] + r->force_ratio[k][2] * N[2]);
      mg_add_row_response(c, row, c->solution.force[row], c->bodies.acceleration);
    }
  }
}

MG_INTERNAL int mg_append_sticking_patch_rows(const mg_context *c, int *list, int n) {
  for (int slot = 0; slot < c->system->n_patch_slot; slot++)
    for (int k = 0; k < MG_PATCH_ROWS && mg_is_slot_frictional(c, slot) && c->run->patch_mode[slot] == MG_STICKING; k++)
      list[n++] = mg_first_patch_friction_row(c, slot) + k;
  return n;
}
