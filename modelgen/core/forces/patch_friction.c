/* Friction of patches: a stuck one holds the slip of its first pad's point and its spin like a joint; one that slips
   adds to the forces on its pads what Coulomb's law at every point makes of the pressure that they tell (rubbing.h). */
#include "forces/forces.h"
#include "base/base.h"
#include "region/region.h"
#include "model/model.h"

#define MG_PRESSURE_ROUNDS 40

MG_INTERNAL int mg_has_patch_friction(const mg_context *c, int patch) {
  return c->system->patch_friction[2 * patch + 1] > 0;
}

/* The slot holds a patch with friction. */
MG_INTERNAL int mg_is_frictional_slot(const mg_context *c, int slot) {
  const int patch = mg_slot_patch(c, slot);
  return patch >= 0 && mg_has_patch_friction(c, patch) && c->run->active[mg_slot_support(c, slot)];
}

MG_INTERNAL int mg_patch_friction_row(const mg_context *c, int slot) {
  return c->friction_row_begin + c->system->contact_below[mg_slot_support(c, slot)];
}

/* The slot of a row that is a pad's of a patch that slips, or -1. */
MG_INTERNAL int mg_slipping_slot_of_row(const mg_context *c, int row) {
  const int slot = row >= c->support_begin && row < c->system->n_contact ? (row - c->support_begin) / 3 : -1;
  return slot >= 0 && c->patches.friction[slot].slips ? slot : -1;
}

/* The distance of the pads from the middle of the face. */
MG_INTERNAL mg_real mg_patch_radius(const mg_context *c, int slot) {
  const mg_real *a = c->run->point + 3 * mg_slot_support(c, slot), *b = a + 3;
  const mg_real arm[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  return sqrt(mg_dot3(arm, arm) / 3);
}

MG_INTERNAL void mg_patch_axes(const mg_context *c, int slot, mg_patch_frame *at) {
  const int pad = mg_slot_support(c, slot);
  mg_real world[3], local[3];
  mg_hull_pose(c, mg_slot_patch(c, slot), at->pose);
  at->sign = mg_dot3(at->pose + 9, c->normal + 3 * pad) > 0 ? 1 : -1;
  for (int i = 0; i < 3; i++) {
    mg_support_in_hull(c, pad + i, world);
    mg_to_local(at->pose, world, local);
    at->pad[i][0] = local[0], at->pad[i][1] = local[1];
    for (int k = 0; k < 2 && i < 2; k++) at->t[i][k] = mg_dot3(at->pose + 3 + 3 * k, c->tangents + 6 * pad + 3 * i);
  }
}

/* Slip and spin along the course of a patch. */
MG_INTERNAL mg_real mg_patch_slip_speed(const mg_context *c, int slot) {
  const mg_real *course = c->run->patch_slip_direction + 4 * slot, *t = c->tangents + 6 * mg_slot_support(c, slot);
  const mg_real *slip = c->d_dot + mg_patch_friction_row(c, slot);
  return slip[0] * mg_dot3(t, course) + slip[1] * mg_dot3(t + 3, course) +
         slip[2] * mg_patch_radius(c, slot) * course[3];
}

/* The course along a twist: of the first pad's point along t1, t2, and spin about N. */
MG_INTERNAL void mg_set_patch_slip_direction(mg_context *c, int slot, const mg_real *twist) {
  const mg_real *t = c->tangents + 6 * mg_slot_support(c, slot), turn = twist[2] * mg_patch_radius(c, slot);
  const mg_real size = sqrt(twist[0] * twist[0] + twist[1] * twist[1] + turn * turn);
  mg_real *course = c->run->patch_slip_direction + 4 * slot;
  for (int k = 0; k < 3; k++) course[k] = (twist[0] * t[k] + twist[1] * t[3 + k]) / size;
  course[3] = turn / size;
}

/* Two directions across a unit vector. */
MG_INTERNAL void mg_orthogonal_pair(const mg_real *e, mg_real across[2][3]) {
  const int least = fabs(e[0]) < fabs(e[1]) ? (fabs(e[0]) < fabs(e[2]) ? 0 : 2) : fabs(e[1]) < fabs(e[2]) ? 1 : 2;
  for (int k = 0; k < 3; k++) across[0][k] = (k == least) - e[least] * e[k];
  const mg_real size = sqrt(mg_dot3(across[0], across[0]));
  for (int k = 0; k < 3; k++) across[0][k] /= size;
  mg_cross(e, across[0], across[1]);
}

/* The course and two directions across it: along t1, t2, and spin in units of 1/radius. */
MG_INTERNAL void mg_patch_slip_basis(const mg_context *c, int slot, mg_real e[3][3]) {
  const mg_real *course = c->run->patch_slip_direction + 4 * slot, *t = c->tangents + 6 * mg_slot_support(c, slot);
  e[0][0] = mg_dot3(t, course), e[0][1] = mg_dot3(t + 3, course), e[0][2] = course[3];
  mg_orthogonal_pair(e[0], e + 1);
}

/* The twist that tells friction: the slip, taken round where it points against its course; the course, where there is
   so little of it that rounding would turn it; as steered, where it begins. */
static void mg_rub_twist(const mg_context *c, int slot, mg_real *twist) {
  const mg_real *slip = c->d_dot + mg_patch_friction_row(c, slot), *steer = c->patches.friction[slot].slip_direction;
  const mg_real radius = mg_patch_radius(c, slot), turn = slip[2] * radius;
  const mg_real size = sqrt(slip[0] * slip[0] + slip[1] * slip[1] + turn * turn);
  const int small = size <= 2 * c->settings->slip_speed * c->system->length / c->system->time;
  const mg_real sign = !small && mg_patch_slip_speed(c, slot) < 0 ? -1 : 1;
  const int steered = c->friction.follows_angle && c->run->patch_mode[slot] == MG_SLIP_ONSET;
  mg_real e[3][3];
  for (int k = 0; k < 3; k++) twist[k] = sign * slip[k];
  if (!small && !steered) return;
  mg_patch_slip_basis(c, slot, e);
  for (int k = 0; k < 3; k++) twist[k] = e[0][k] + (steered ? steer[0] * e[1][k] + steer[1] * e[2][k] : 0);
  twist[2] /= radius;
}

/* The pressure in a slot, of a resultant of 1 at its centre; of all of the face while that is not known. */
MG_INTERNAL void mg_patch_pressure(mg_context *c, int slot) {
  mg_patch_friction *r = c->patches.friction + slot;
  mg_pressure *p = &c->patches.pressure;
  mg_patch_frame at;
  mg_overlay_patch(c, mg_slot_patch(c, slot));
  mg_open_pressure(p, &c->patches.hull, c->patches.strip_capacity, c->patches.strips);
  r->force_outside = r->centre_known && mg_move_inside_hull(&c->patches.hull, r->centre);
  if (!r->centre_known || !mg_winkler_pressure(p, 1, r->centre)) {
    mg_patch_axes(c, slot, &at);
    for (int k = 0; k < 2; k++) r->centre[k] = (at.pad[0][k] + at.pad[1][k] + at.pad[2][k]) / 3;
    mg_uniform_pressure(p, r->centre);
    r->force_outside = 0;
  }
  r->partly_unloaded = p->partly_unloaded, r->extent = p->reach;
}

/* How the friction of a slot goes with the forces on its pads. */
static void mg_lean_rub(mg_context *c, int slot) {
  const int patch = mg_slot_patch(c, slot), row = mg_patch_friction_row(c, slot);
  const mg_real mu = c->system->patch_friction[2 * patch + 1];
  mg_patch_friction *r = c->patches.friction + slot;
  mg_patch_frame at;
  mg_real own[3], twist[3], G[3][3], level[3];
  mg_patch_pressure(c, slot);
  mg_patch_axes(c, slot, &at);
  const mg_pressure *p = &c->patches.pressure;
  const mg_real arm[2] = {p->centre[0] - at.pad[0][0], p->centre[1] - at.pad[0][1]};
  mg_rub_twist(c, slot, own);
  twist[2] = at.sign * own[2];
  twist[0] = own[0] * at.t[0][0] + own[1] * at.t[1][0] - twist[2] * arm[1];
  twist[1] = own[0] * at.t[0][1] + own[1] * at.t[1][1] + twist[2] * arm[0];
  mg_friction_matrix(p, twist, G);
  for (int i = 0; i < 3; i++) {
    const mg_real moment[3] = {1, at.pad[i][0] - p->centre[0], at.pad[i][1] - p->centre[1]};
    mg_real force[3];
    if (r->force_outside || !mg_solve_moments(p, moment, level))
      for (int k = 0; k < 3; k++) level[k] = p->coefficients[k];
    for (int k = 0; k < 3; k++) force[k] = mu * (G[k][0] * level[0] + G[k][1] * level[1] + G[k][2] * level[2]);
    r->force_ratio[0][i] = at.t[0][0] * force[0] + at.t[0][1] * force[1];
    r->force_ratio[1][i] = at.t[1][0] * force[0] + at.t[1][1] * force[1];
    r->force_ratio[2][i] = at.sign * (force[2] + mg_cross2(arm, force));
  }
  for (int k = 0; k < MG_PATCH_ROWS; k++) mg_inverse_mass_row(c, row + k);
}

/* The leans of all slots; needs the rates of the rows. */
MG_INTERNAL void mg_begin_patch_friction(mg_context *c) {
  for (int slot = 0; slot < c->system->n_slot; slot++) {
    mg_patch_friction *r = c->patches.friction + slot;
    r->slips = mg_is_frictional_slot(c, slot) && c->run->patch_mode[slot] >= MG_SLIP_ONSET;
    if (!r->slips) continue;
    mg_lean_rub(c, slot);
    for (int k = 0; k < MG_PATCH_ROWS; k++)
      c->friction.force_ratio[mg_patch_friction_row(c, slot) - c->friction_row_begin + k] = 1;
  }
}

/* The lean is for this centre of pressure: both leave nothing of the face alone, or they are the same. Takes the
 * centre. */
static int mg_rub_is_settled(mg_context *c, int slot, const mg_real *centre) {
  mg_patch_friction *r = c->patches.friction + slot;
  const mg_real made[2] = {r->centre[0], r->centre[1]};
  const int was_cut = r->partly_unloaded || r->force_outside;
  r->centre[0] = centre[0], r->centre[1] = centre[1], r->centre_known = 1;
  if (!was_cut) {
    mg_patch_pressure(c, slot);
    return !r->partly_unloaded && !r->force_outside;
  }
  mg_move_inside_hull(&c->patches.hull, r->centre);
  return mg_distance2(r->centre, made) <= sqrt(MG_EPS) * r->extent;
}

/* After forces: 1 where leans were for another pressure, and have been made anew for this one. */
MG_INTERNAL int mg_is_pressure_changing(mg_context *c) {
  int count = 0;
  for (int slot = 0; slot < c->system->n_slot; slot++) {
    mg_real world[3], pose[12], centre[3];
    if (!c->patches.friction[slot].slips || !(mg_pressure_resultant(c, slot, c->force, world) > 0)) continue;
    mg_hull_pose(c, mg_slot_patch(c, slot), pose);
    mg_to_local(pose, world, centre);
    if (mg_rub_is_settled(c, slot, centre)) continue;
    mg_lean_rub(c, slot);
    count++;
  }
  return count > 0 && ++c->patches.pressure_rounds < MG_PRESSURE_ROUNDS;
}

/* Takes the leans of patches into the columns of pads among the n assembled in c->lcp.A. */
MG_INTERNAL void mg_couple_supports(mg_context *c, const int *list, int n) {
  for (int j = 0; j < n; j++) {
    const int slot = mg_slipping_slot_of_row(c, list[j]), pad = (list[j] - c->support_begin) % 3;
    for (int k = 0; k < MG_PATCH_ROWS && slot >= 0; k++)
      for (int r = 0; r < n; r++)
        c->lcp.A[r + n * j] -= c->patches.friction[slot].force_ratio[k][pad] *
                               mg_delassus_entry(c, list[r], mg_patch_friction_row(c, slot) + k);
  }
}

/* The friction of patches that slip, from the forces on their pads, into c->force and c->accel. */
MG_INTERNAL void mg_add_patch_friction(mg_context *c) {
  for (int slot = 0; slot < c->system->n_slot; slot++) {
    const mg_patch_friction *r = c->patches.friction + slot;
    const mg_real *N = c->force + mg_slot_support(c, slot);
    for (int k = 0; k < MG_PATCH_ROWS && r->slips; k++) {
      const int row = mg_patch_friction_row(c, slot) + k;
      c->force[row] = -(r->force_ratio[k][0] * N[0] + r->force_ratio[k][1] * N[1] + r->force_ratio[k][2] * N[2]);
      mg_add_row_response(c, row, c->force[row], c->accel);
    }
  }
}

/* Appends the rows of stuck patches to a list of n; returns its length. */
MG_INTERNAL int mg_append_sticking_patches(const mg_context *c, int *list, int n) {
  for (int slot = 0; slot < c->system->n_slot; slot++)
    for (int k = 0; k < MG_PATCH_ROWS && mg_is_frictional_slot(c, slot) && c->run->patch_mode[slot] == MG_STICKING; k++)
      list[n++] = mg_patch_friction_row(c, slot) + k;
  return n;
}
