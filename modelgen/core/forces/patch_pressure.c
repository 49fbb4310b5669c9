/* Planar contact (section 5): a face that rests on another is held by three pads, both ways. Where the centre of
   pressure leaves the hull of what both faces cover, or the force between them is used up, the patch ends. */
#include "forces/forces.h"
#include "base/base.h"
#include "region/region.h"
#include "model/model.h"

/* Where a pad is in the world. */
MG_INTERNAL void mg_support_in_hull(const mg_context *c, int pad, mg_real *world) {
  mg_to_world(c->pose + 12 * c->f[pad], c->run->point + 3 * pad, 1, world);
}

/* The resultant of the amounts on a slot's pads, and their centre in the world. */
MG_INTERNAL mg_real mg_pressure_resultant(const mg_context *c, int slot, const mg_real *amount, mg_real *centre) {
  const int pad = mg_slot_support(c, slot);
  mg_real sum = 0, point[3];
  for (int k = 0; k < 3; k++) sum += amount[pad + k], centre[k] = 0;
  for (int i = 0; i < 3; i++) {
    mg_support_in_hull(c, pad + i, point);
    for (int k = 0; k < 3; k++) centre[k] += amount[pad + i] / sum * point[k];
  }
  return sum;
}

/* The most arcs that bound the regions of a patch. */
MG_INTERNAL int mg_max_patch_arcs(const mg_system *s) {
  int most = 0;
  for (int patch = 0; patch < s->n_patch; patch++)
    if (s->patch_arc[patch + 1] - s->patch_arc[patch] > most) most = s->patch_arc[patch + 1] - s->patch_arc[patch];
  return most;
}

static int mg_is_whole(const mg_context *c, int patch) {
  return c->system->patch_arc[patch] == c->system->patch_arc_f[patch];
}

/* The axes of a patch's hull in the world: of o's face; of f's where o's is a whole plane, so that the hull stays. */
MG_INTERNAL void mg_hull_pose(const mg_context *c, int patch, mg_real *out) {
  mg_face_pose(c, patch, mg_is_whole(c, patch), out);
}

/* The pose of f's face in the axes of the hull; its own exactly, where the poses of a stage are not of unit length yet.
 */
static void mg_place_between(mg_context *c, int patch, mg_real *between) {
  mg_real hull[12], f[12];
  if (mg_is_whole(c, patch)) {
    for (int k = 0; k < 12; k++) between[k] = k == 3 || k == 7 || k == 11;
    return;
  }
  mg_hull_pose(c, patch, hull);
  mg_face_pose(c, patch, 1, f);
  mg_to_local(hull, f, between);
  for (int k = 0; k < 3; k++) mg_rotate_back(hull + 3, f + 3 + 3 * k, between + 3 + 3 * k);
}

static void mg_set_patch(mg_context *c, int patch) {
  const mg_system *s = c->system;
  const int first = s->patch_arc[patch], n = s->patch_arc[patch + 1] - first;
  for (int i = 0; i < n; i++) {
    const mg_real *numbers = s->numbers + s->arc_numbers[first + i];
    const mg_arc arc = {s->arc_shape[first + i],
                        s->arc_loop[first + i],
                        s->parameters + s->arc_parameters[first + i],
                        numbers,
                        numbers[12],
                        numbers[13]};
    c->patches.arcs[i] = arc;
  }
  const mg_regions regions = {s->kernels, n, s->patch_arc_f[patch] - first, c->patches.arcs,
                              c->settings->shared * s->length};
  c->patches.regions = regions, c->patches.hull_patch = patch, c->patches.deepest = 0;
  mg_set_regions(&c->patches.hull, &c->patches.regions, c->patches.hull_memory);
}

/* Lays the faces of a patch on each other; returns the number of sides of their hull. */
MG_INTERNAL int mg_overlay_patch(mg_context *c, int patch) {
  const int known = c->patches.hull_patch == patch;
  mg_real between[12];
  if (known && mg_is_whole(c, patch)) return c->patches.hull.n_edge;
  if (!known) mg_set_patch(c, patch);
  mg_place_between(c, patch, between);
  return mg_overlay_regions(&c->patches.hull, between);
}

/* How far inside the hull a point of the world lies; -MG_MAX where the faces have nothing in common. In a hull that
   stays, all points as near as that are inside too. */
MG_INTERNAL mg_real mg_patch_margin(mg_context *c, int patch, const mg_real *world, mg_nearest_boundary *brink) {
  mg_real hull[12], x[3];
  mg_hull_pose(c, patch, hull);
  mg_to_local(hull, world, x);
  mg_overlay_patch(c, patch);
  const mg_real margin = mg_hull_margin(&c->patches.hull, x, brink);
  if (mg_is_whole(c, patch) && margin > c->patches.deepest)
    c->patches.deepest = margin, c->patches.deepest_point[0] = x[0], c->patches.deepest_point[1] = x[1];
  return margin;
}

/* How far inside the hull a point of the world is known to lie at least, m; negative where it is not. */
static mg_real mg_sheltered_by(const mg_context *c, int patch, const mg_real *world) {
  mg_real hull[12], x[3];
  if (c->patches.hull_patch != patch || !(c->patches.deepest > 0)) return -1;
  mg_hull_pose(c, patch, hull);
  mg_to_local(hull, world, x);
  const mg_real dx = x[0] - c->patches.deepest_point[0], dy = x[1] - c->patches.deepest_point[1];
  return (mg_real)0.99 * c->patches.deepest - sqrt(dx * dx + dy * dy);
}

MG_INTERNAL mg_real mg_patch_force_scale(const mg_context *c) { return mg_rest_acceleration(c) * c->system->mass; }

/* The cause for which a slot's patch ends with these amounts on its pads, or 0; how far it is from there. */
MG_INTERNAL int mg_is_patch_ending(mg_context *c, int slot, const mg_real *amount, mg_real floor, mg_real *margin) {
  mg_real centre[3];
  mg_nearest_boundary brink;
  const mg_real N = mg_pressure_resultant(c, slot, amount, centre);
  *margin = -MG_MAX;
  if (!(N > floor)) return MG_FACES_SEPARATE;
  if (mg_is_turning_on_edge(c, slot)) return mg_edge_end_cause(c, slot, amount, floor);
  *margin = mg_patch_margin(c, mg_slot_patch(c, slot), centre, &brink);
  return *margin < -c->settings->border * c->system->length ? MG_PRESSURE_AT_EDGE : 0;
}

/* What is left before the events of a slot: its force, the margin of its centre of pressure, friction. */
MG_INTERNAL mg_event_margin *mg_note_slot_margin(const mg_context *c, int slot) {
  return mg_margins_at(c, MG_MARGIN_SAMPLES) + mg_slot_support(c, slot);
}

/* The cause for which the patch in a slot ends at the state of the last right-hand side, or 0; notes what is left
   before it does. */
MG_INTERNAL int mg_slot_end_cause(mg_context *c, int slot) {
  const int patch = mg_slot_patch(c, slot);
  const mg_real floor = -mg_patch_force_scale(c), border = c->settings->border * c->system->length;
  mg_event_margin *left = mg_note_slot_margin(c, slot);
  mg_real margin, centre[3];
  for (int k = 0; k < 3; k++) left[k].lower = left[k].upper = MG_MAX;
  if (patch < 0) return 0;
  const mg_real N = mg_pressure_resultant(c, slot, c->force, centre);
  const mg_real shelter = !mg_is_turning_on_edge(c, slot) && N > floor ? mg_sheltered_by(c, patch, centre) : -1;
  const int cause = shelter > 0 ? 0 : mg_is_patch_ending(c, slot, c->force, floor, &margin);
  left[0].lower = left[0].upper = N - floor;
  if (shelter > 0) left[1].lower = shelter + border, left[1].upper = 2 * c->patches.deepest - shelter + border;
  else if (!mg_is_turning_on_edge(c, slot)) left[1].lower = left[1].upper = margin + border;
  return cause ? cause : mg_is_patch_friction_triggered(c, slot);
}

/* Marks the slots whose patches end at the state of the last right-hand side; returns how many. */
MG_INTERNAL int mg_trigger_patches(mg_context *c) {
  int count = 0;
  for (int slot = 0; slot < c->system->n_slot; slot++) {
    const int pad = mg_slot_support(c, slot);
    for (int k = 0; k < 3; k++) c->events.triggered[pad + k] = 0;
    c->events.triggered[pad] = mg_slot_end_cause(c, slot);
    count += c->events.triggered[pad] != 0;
  }
  return count;
}

MG_INTERNAL int mg_any_patch_ends(mg_context *c) {
  for (int slot = 0; slot < c->system->n_slot; slot++)
    if (mg_slot_end_cause(c, slot)) return 1;
  return 0;
}

/* The function whose zero ends a patch. */
MG_INTERNAL mg_real mg_patch_event_value(mg_context *c, int pad, int cause) {
  mg_real centre[3];
  mg_nearest_boundary brink;
  const int slot = (pad - c->support_begin) / 3;
  const mg_real N = mg_pressure_resultant(c, slot, c->force, centre);
  if (cause >= MG_FRICTION_EXCEEDED) return mg_patch_friction_value(c, slot, cause);
  if (cause >= MG_ROLLS_ONTO_RIM) return mg_edge_event_value(c, slot, cause);
  return cause == MG_FACES_SEPARATE ? N : mg_patch_margin(c, mg_slot_patch(c, slot), centre, &brink);
}
