/* Planar contact (section 5): a face that rests on another is held by three pads, both ways. Where the centre of
   pressure leaves the hull of what both faces cover, or the force between them is used up, the patch ends. */
#include "core.h"

static int mg_is_pad(const mg_context *c, int contact) {
  return contact >= c->first_pad && contact < c->sys->n_contact;
}

static int mg_pad_of(const mg_context *c, int slot) { return c->first_pad + 3 * slot; }

/* The patch that a slot holds, or -1. */
static int mg_patch_in(const mg_context *c, int slot) {
  const int link = c->run->link[mg_pad_of(c, slot)];
  return link < 0 ? -1 : (link - c->first_pad_link) / 3;
}

/* The slot that holds a patch, or -1. */
static int mg_slot_of(const mg_context *c, int patch) {
  for (int slot = c->sys->patch_slots[2 * patch]; slot < c->sys->patch_slots[2 * patch + 1]; slot++)
    if (mg_patch_in(c, slot) == patch) return slot;
  return -1;
}

static int mg_free_slot(const mg_context *c, int patch) {
  for (int slot = c->sys->patch_slots[2 * patch]; slot < c->sys->patch_slots[2 * patch + 1]; slot++)
    if (mg_patch_in(c, slot) < 0) return slot;
  return -1;
}

static int mg_patch_covers(const mg_context *c, int patch, int link) {
  for (int k = c->sys->patch_cover[patch]; k < c->sys->patch_cover[patch + 1]; k++)
    if (c->sys->covered[k] == link) return 1;
  return 0;
}

/* The patch that a contact's link lies in with its faces against each other, or -1. */
static int mg_patch_flat_on(const mg_context *c, int contact) {
  const int link = c->run->link[contact];
  mg_real o[12], f[12];
  for (int patch = 0; patch < c->sys->n_patch; patch++) {
    if (c->sys->patch_pair[patch] != c->sys->link_pair[link] || !mg_patch_covers(c, patch, link)) continue;
    mg_face_pose(c, patch, 0, o);
    mg_face_pose(c, patch, 1, f);
    if (mg_dot3(o + 9, f + 9) < 0 && mg_sine(o + 9, f + 9) < c->set->flat) return patch;
  }
  return -1;
}

/* The link is there only while faces lie flat on each other. */
static int mg_is_for_flat(const mg_context *c, int link) {
  const mg_system *s = c->sys;
  for (int k = s->link_condition[link]; k < s->link_condition[link + 1]; k++)
    if (s->condition_kind[k] == MG_TILT && s->numbers[s->condition_numbers[k] + 3] < 0) return 1;
  return 0;
}

/* Of a link for faces that lie flat, on which nothing touches soon: where its condition ends is no event. */
static int mg_is_flat_far(const mg_context *c, int contact) {
  return c->d[contact] > c->set->reach * c->sys->length && mg_is_for_flat(c, c->run->link[contact]);
}

/* A rim of the pair has just begun to roll. */
static int mg_pair_starts(const mg_context *c, int pair) {
  for (int i = mg_first_contact(c, pair); i < mg_first_contact(c, pair + 1); i++)
    if (c->run->fresh[i]) return 1;
  return 0;
}

/* True if the link lies in a patch that is held, or in one that just turns over a rim. */
static int mg_is_covered(const mg_context *c, int link) {
  if (c->sys->n_slot && mg_pair_starts(c, c->sys->link_pair[link]) && mg_is_for_flat(c, link)) return 1;
  for (int slot = 0; slot < c->sys->n_slot; slot++) {
    const int patch = mg_patch_in(c, slot);
    if (patch >= 0 && c->sys->patch_pair[patch] == c->sys->link_pair[link] && mg_patch_covers(c, patch, link)) return 1;
  }
  return 0;
}

/* A pair with a patch that is held. */
static int mg_pair_rests(const mg_context *c, int pair) {
  for (int slot = 0; slot < c->sys->n_slot; slot++) {
    const int patch = mg_patch_in(c, slot);
    if (patch >= 0 && c->sys->patch_pair[patch] == pair) return 1;
  }
  return 0;
}

/* The bodies of a patch: 0 for o, 1 for f. */
static int mg_patch_body(const mg_context *c, int patch, int side) {
  const int link = c->first_pad_link + 3 * patch;
  return side ? c->sys->link_f[link] : c->sys->link_o[link];
}

/* A face's axes in the world: origin and R, 12 numbers. */
static void mg_face_pose(const mg_context *c, int patch, int side, mg_real *out) {
  const mg_real *place = c->sys->numbers + c->sys->patch_numbers[patch] + 12 * side;
  const mg_real *pose = c->pose + 12 * mg_patch_body(c, patch, side);
  mg_out(pose, place, 1, out);
  for (int k = 0; k < 3; k++) mg_out(pose, place + 3 + 3 * k, 0, out + 3 + 3 * k);
}

/* Where a pad is in the world. */
static void mg_pad_point(const mg_context *c, int pad, mg_real *world) {
  mg_out(c->pose + 12 * c->f[pad], c->run->point + 3 * pad, 1, world);
}

/* A point of the world in the axes of a pose. */
static void mg_into(const mg_real *pose, const mg_real *world, mg_real *local) {
  const mg_real arm[3] = {world[0] - pose[0], world[1] - pose[1], world[2] - pose[2]};
  mg_unturn(pose + 3, arm, local);
}

/* The resultant of the amounts on a slot's pads, and their centre in the world. */
static mg_real mg_resultant(const mg_context *c, int slot, const mg_real *amount, mg_real *centre) {
  const int pad = mg_pad_of(c, slot);
  mg_real sum = 0, point[3];
  for (int k = 0; k < 3; k++) sum += amount[pad + k], centre[k] = 0;
  for (int i = 0; i < 3; i++) {
    mg_pad_point(c, pad + i, point);
    for (int k = 0; k < 3; k++) centre[k] += amount[pad + i] / sum * point[k];
  }
  return sum;
}

/* The most arcs that bound the regions of a patch. */
static int mg_most_arcs(const mg_system *s) {
  int most = 0;
  for (int patch = 0; patch < s->n_patch; patch++)
    if (s->patch_arc[patch + 1] - s->patch_arc[patch] > most) most = s->patch_arc[patch + 1] - s->patch_arc[patch];
  return most;
}

static int mg_is_whole(const mg_context *c, int patch) { return c->sys->patch_arc[patch] == c->sys->patch_arc_f[patch]; }

/* The axes of a patch's hull in the world: of o's face; of f's where o's is a whole plane, so that the hull stays. */
static void mg_hull_pose(const mg_context *c, int patch, mg_real *out) { mg_face_pose(c, patch, mg_is_whole(c, patch), out); }

/* The pose of f's face in the axes of the hull. */
static void mg_place_between(mg_context *c, int patch, mg_real *between) {
  mg_real hull[12], f[12];
  mg_hull_pose(c, patch, hull);
  mg_face_pose(c, patch, 1, f);
  mg_into(hull, f, between);
  for (int k = 0; k < 3; k++) mg_unturn(hull + 3, f + 3 + 3 * k, between + 3 + 3 * k);
}

static void mg_set_patch(mg_context *c, int patch) {
  const mg_system *s = c->sys;
  const int first = s->patch_arc[patch], n = s->patch_arc[patch + 1] - first;
  for (int i = 0; i < n; i++) {
    const mg_real *numbers = s->numbers + s->arc_numbers[first + i];
    const mg_arc arc = {s->arc_shape[first + i], s->arc_loop[first + i], s->parameters + s->arc_parameters[first + i],
                        numbers, numbers[12], numbers[13]};
    c->arc[i] = arc;
  }
  const mg_regions regions = {n, s->patch_arc_f[patch] - first, c->arc, c->set->shared * s->length};
  c->regions = regions, c->laid = patch;
  mg_set_regions(&c->hull, &c->regions, c->lay);
}

/* Lays the faces of a patch on each other; returns the number of sides of their hull. */
static int mg_lay_patch(mg_context *c, int patch) {
  const int known = c->laid == patch;
  mg_real between[12];
  if (known && mg_is_whole(c, patch)) return c->hull.n_edge;
  if (!known) mg_set_patch(c, patch);
  mg_place_between(c, patch, between);
  return mg_lay(&c->hull, between);
}

/* How far inside the hull a point of the world lies; -MG_MAX where the faces have nothing in common. */
static mg_real mg_patch_margin(mg_context *c, int patch, const mg_real *world, mg_brink *brink) {
  mg_real hull[12], x[3];
  mg_hull_pose(c, patch, hull);
  mg_into(hull, world, x);
  mg_lay_patch(c, patch);
  return mg_hull_margin(&c->hull, x, brink);
}

static mg_real mg_weight_scale(const mg_context *c) { return mg_slack(c) * c->sys->mass; }

/* The cause for which a slot's patch ends with these amounts on its pads, or 0; how far it is from there. */
static int mg_ends_with(mg_context *c, int slot, const mg_real *amount, mg_real floor, mg_real *margin) {
  mg_real centre[3];
  mg_brink brink;
  const mg_real N = mg_resultant(c, slot, amount, centre);
  *margin = -MG_MAX;
  if (!(N > floor)) return MG_PARTS;
  *margin = mg_patch_margin(c, mg_patch_in(c, slot), centre, &brink);
  return *margin < -c->set->border * c->sys->length ? MG_TURNS : 0;
}

/* The cause for which the patch in a slot ends at the state of the last right-hand side, or 0. */
static int mg_slot_ends(mg_context *c, int slot) {
  mg_real margin;
  return mg_patch_in(c, slot) < 0 ? 0 : mg_ends_with(c, slot, c->force, -mg_weight_scale(c), &margin);
}

/* Marks the slots whose patches end at the state of the last right-hand side; returns how many. */
static int mg_patches_fired(mg_context *c) {
  int count = 0;
  for (int slot = 0; slot < c->sys->n_slot; slot++) {
    const int pad = mg_pad_of(c, slot);
    for (int k = 0; k < 3; k++) c->fired[pad + k] = 0;
    c->fired[pad] = mg_slot_ends(c, slot);
    count += c->fired[pad] != 0;
  }
  return count;
}

static int mg_any_patch_ends(mg_context *c) {
  for (int slot = 0; slot < c->sys->n_slot; slot++)
    if (mg_slot_ends(c, slot)) return 1;
  return 0;
}

/* The function whose zero ends a patch. */
static mg_real mg_patch_value(mg_context *c, int pad, int cause) {
  mg_real centre[3];
  mg_brink brink;
  const int slot = (pad - c->first_pad) / 3;
  const mg_real N = mg_resultant(c, slot, c->force, centre);
  return cause == MG_PARTS ? N : mg_patch_margin(c, mg_patch_in(c, slot), centre, &brink);
}

static void mg_pad_on(mg_context *c, int pad, int link) {
  const mg_system *s = c->sys;
  const mg_contact_kind *kind = mg_contact_kinds + s->link_kind[link];
  const mg_real *last = s->parameters + s->link_parameters[link] + kind->n_parameters - 3;
  mg_set_link(c, pad, link, 0);
  for (int k = 0; k < 3; k++) c->run->point[3 * pad + k] = last[k];
  c->run->closed[pad] = c->run->active[pad] = 1;
}

static void mg_hold_patch(mg_context *c, int slot, int patch) {
  for (int k = 0; k < 3; k++) mg_pad_on(c, mg_pad_of(c, slot) + k, c->first_pad_link + 3 * patch + k);
}

static void mg_drop_patch(mg_context *c, int slot) {
  for (int k = 0; k < 3; k++) mg_set_link(c, mg_pad_of(c, slot) + k, -1, 0);
}

/* Velocity along N of a body's material point at a place of the world. */
static mg_real mg_speed_along(const mg_context *c, int body, const mg_real *at, const mg_real *N) {
  const mg_real *pose = c->pose + 12 * body, *twist = c->twist + 6 * body;
  mg_real spin[3], arm[3];
  mg_out(pose, twist + 3, 0, spin);
  for (int k = 0; k < 3; k++) arm[k] = at[k] - pose[k];
  const mg_real v[3] = {twist[0] + spin[1] * arm[2] - spin[2] * arm[1], twist[1] + spin[2] * arm[0] - spin[0] * arm[2],
                        twist[2] + spin[0] * arm[1] - spin[1] * arm[0]};
  return mg_dot3(v, N);
}

/* The faces of a patch lie on each other: gaps within `touching`, at rest unless `moving`, something in common. */
static int mg_lies_flat(mg_context *c, int patch, mg_real touching, int moving) {
  const mg_system *s = c->sys;
  const mg_real rest = c->set->rest_speed * s->length / s->time;
  mg_real o[12], f[12], at[3], x[3];
  mg_face_pose(c, patch, 0, o);
  mg_face_pose(c, patch, 1, f);
  if (!(mg_dot3(o + 9, f + 9) < 0)) return 0;
  for (int k = 0; k < 3; k++) {
    const int link = c->first_pad_link + 3 * patch + k, body = s->link_f[link];
    const mg_real *pad = s->parameters + s->link_parameters[link] + mg_contact_kinds[s->link_kind[link]].n_parameters - 3;
    mg_out(c->pose + 12 * body, pad, 1, at);
    mg_into(o, at, x);
    if (fabs(x[2]) > touching) return 0;
    const mg_real speed = mg_speed_along(c, body, at, o + 9) - mg_speed_along(c, s->link_o[link], at, o + 9);
    if (!moving && fabs(speed) > rest) return 0;
  }
  return mg_lay_patch(c, patch) > 2;
}

/* The contact is of a patch whose faces lie on each other. */
static int mg_is_flat_on(mg_context *c, int contact) {
  const mg_system *s = c->sys;
  for (int patch = 0; patch < s->n_patch; patch++)
    if (s->patch_pair[patch] == s->contact_pair[contact] && mg_patch_covers(c, patch, c->run->link[contact]) &&
        mg_lies_flat(c, patch, c->set->start_gap * s->length, 1))
      return 1;
  return 0;
}

/* Contacts that a held patch covers are hidden. */
static void mg_hide_covered(mg_context *c) {
  for (int i = 0; i < c->sys->n_contact; i++)
    c->hidden[i] = i < c->first_pad && mg_present(c, i) && mg_is_covered(c, c->run->link[i]);
}

/* Holds every patch that lies flat and is not held; marks their slots in c->trying. Returns how many. */
static int mg_try_flat(mg_context *c, mg_real touching, int moving) {
  int count = 0;
  for (int slot = 0; slot < c->sys->n_slot; slot++) c->trying[slot] = 0;
  for (int patch = 0; patch < c->sys->n_patch && c->set->planar; patch++) {
    if (mg_slot_of(c, patch) >= 0) continue;
    const int slot = mg_free_slot(c, patch);
    if (slot < 0 || c->barred[slot] == patch || !mg_lies_flat(c, patch, touching, moving)) continue;
    mg_hold_patch(c, slot, patch);
    c->trying[slot] = 1;
    count++;
  }
  return count;
}

/* Lets go of the slots held on trial. */
static void mg_drop_tried(mg_context *c) {
  for (int slot = 0; slot < c->sys->n_slot; slot++)
    if (c->trying[slot]) c->trying[slot] = 0, mg_drop_patch(c, slot);
}

/* Lets go of the slots held on trial that the amounts on their pads would end; returns how many. */
static int mg_reject(mg_context *c, const mg_real *amount, mg_real floor) {
  int count = 0;
  mg_real margin;
  for (int slot = 0; slot < c->sys->n_slot; slot++) {
    if (!c->trying[slot]) continue;
    if (!mg_ends_with(c, slot, amount, floor, &margin) && margin > 0) continue;
    c->trying[slot] = 0;
    mg_drop_patch(c, slot);
    count++;
  }
  return count;
}

/* Patches that lie flat rest, if the forces press them together within their hulls; what they cover gives way. */
static int mg_rest_patches(mg_context *c, mg_events *events, mg_real touching) {
  const mg_real none[6] = {0};
  if (!mg_try_flat(c, touching, 0)) return MG_DONE;
  do {
    mg_hide_covered(c);
    const int outcome = mg_choose_active(c, c->hidden);
    if (outcome) return outcome;
  } while (mg_reject(c, c->force, mg_weight_scale(c)));
  mg_hide_covered(c);
  for (int i = 0; i < c->first_pad; i++)
    if (c->hidden[i]) mg_set_link(c, i, -1, none), c->fired[i] = 0;
  for (int slot = 0; slot < c->sys->n_slot; slot++)
    if (c->trying[slot]) mg_befalls(c, events, mg_pad_of(c, slot), MG_RESTS, c->run->t, 0);
  return MG_DONE;
}
