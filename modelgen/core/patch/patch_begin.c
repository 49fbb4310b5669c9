/* How faces come to rest on each other: those that lie flat are held on trial, and let go where that would end them. */
#include "patch/patch.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

/* Velocity along N of a body's material point at a place of the world. */
MG_INTERNAL mg_real mg_speed_along(const mg_context *c, const mg_real *twists, int body, const mg_real *at,
                                   const mg_real *N) {
  const mg_real *pose = c->pose + 12 * body, *twist = twists + 6 * body;
  mg_real spin[3], arm[3];
  mg_to_world(pose, twist + 3, 0, spin);
  for (int k = 0; k < 3; k++) arm[k] = at[k] - pose[k];
  const mg_real v[3] = {twist[0] + spin[1] * arm[2] - spin[2] * arm[1], twist[1] + spin[2] * arm[0] - spin[0] * arm[2],
                        twist[2] + spin[0] * arm[1] - spin[1] * arm[0]};
  return mg_dot3(v, N);
}

/* The faces of a patch lie on each other: gaps within `touching`, at rest unless `moving`, something in common. */
static int mg_lies_flat(mg_context *c, int patch, mg_real touching, int moving) {
  const mg_system *s = c->system;
  const mg_real rest = c->settings->rest_speed * s->length / s->time;
  mg_real o[12], f[12], at[3], x[3];
  mg_face_pose(c, patch, 0, o);
  mg_face_pose(c, patch, 1, f);
  if (!(mg_dot3(o + 9, f + 9) < 0)) return 0;
  for (int k = 0; k < 3; k++) {
    const int link = c->support_link_begin + 3 * patch + k, body = s->link_f[link];
    mg_to_world(c->pose + 12 * body, mg_link_support_point(c, link), 1, at);
    mg_to_local(o, at, x);
    if (fabs(x[2]) > touching) return 0;
    const mg_real speed =
        mg_speed_along(c, c->twist, body, at, o + 9) - mg_speed_along(c, c->twist, s->link_o[link], at, o + 9);
    if (!moving && fabs(speed) > rest) return 0;
  }
  return mg_overlay_patch(c, patch) > 2;
}

/* The contact is of a patch whose faces lie on each other. */
MG_INTERNAL int mg_is_of_flat_patch(mg_context *c, int contact) {
  const int patch = mg_flat_patch_of_contact(c, contact, c->settings->flat);
  return patch >= 0 && mg_lies_flat(c, patch, c->settings->start_gap * c->system->length, 1);
}

/* Contacts that a held patch covers are hidden. */
MG_INTERNAL void mg_mark_covered(mg_context *c) {
  for (int i = 0; i < c->system->n_contact; i++)
    c->patches.is_covered[i] = i < c->support_begin && mg_is_on_link(c, i) && mg_is_covered(c, c->run->link[i]);
}

/* Holds every patch that lies flat and is not held; marks their slots in c->patches.trial. Returns how many. */
MG_INTERNAL int mg_hold_flat_patches(mg_context *c, mg_real touching, int moving) {
  int count = 0;
  for (int slot = 0; slot < c->system->n_slot; slot++) c->patches.trial[slot] = 0;
  for (int patch = 0; patch < c->system->n_patch && c->settings->planar; patch++) {
    if (mg_patch_slot(c, patch) >= 0) continue;
    const int slot = mg_free_slot(c, patch);
    if (slot < 0 || c->patches.barred[slot] == patch || (moving && mg_has_patch_friction(c, patch)) ||
        !mg_lies_flat(c, patch, touching, moving))
      continue;
    mg_hold_patch(c, slot, patch);
    c->patches.trial[slot] = 1;
    count++;
  }
  return count;
}

/* Lets go of the slots held on trial. */
MG_INTERNAL void mg_release_trials(mg_context *c) {
  for (int slot = 0; slot < c->system->n_slot; slot++)
    if (c->patches.trial[slot]) c->patches.trial[slot] = 0, mg_release_patch(c, slot);
}

/* Lets go of the slots held on trial that the amounts on their pads would end; of impulses, they go to the edges of
   hulls that are curved. Returns how many. */
MG_INTERNAL int mg_reject_trials(mg_context *c, const mg_real *amount, mg_real floor, int impulses) {
  int count = 0;
  mg_real margin;
  for (int slot = 0; slot < c->system->n_slot; slot++) {
    if (c->patches.trial[slot] != 1) continue;
    if (!mg_is_patch_ending(c, slot, amount, floor, &margin) && margin > c->settings->border * c->system->length)
      continue;
    count++;
    if (impulses && mg_move_supports_to_edge(c, slot)) continue;
    c->patches.trial[slot] = 0;
    mg_release_patch(c, slot);
  }
  return count;
}

/* What the patches that are held cover gives way to them. */
MG_INTERNAL void mg_open_covered(mg_context *c) {
  const mg_real none[6] = {0};
  mg_mark_covered(c);
  for (int i = 0; i < c->support_begin; i++)
    if (c->patches.is_covered[i]) mg_set_link(c, i, -1, none), c->events.triggered[i] = 0;
}

/* The slot held on trial if no other patch is held, or -1. */
static int mg_alone_on_trial(const mg_context *c) {
  int alone = -1;
  for (int slot = 0; slot < c->system->n_slot; slot++) {
    if (mg_slot_patch(c, slot) < 0) continue;
    if (alone >= 0) return -1;
    alone = slot;
  }
  return alone >= 0 && c->patches.trial[alone] ? alone : -1;
}

/* A face that lies flat, but is pressed outside its hull by the forces, turns over at once where the hull is curved;
   what a polygon turns on is closed already. */
static int mg_turns_at_once(mg_context *c, mg_events *events) {
  const int slot = mg_alone_on_trial(c), pad = slot < 0 ? 0 : mg_slot_support(c, slot);
  mg_real margin;
  if (slot < 0) return 0;
  const int cause = mg_is_patch_ending(c, slot, c->force, mg_patch_force_scale(c), &margin);
  if (mg_has_patch_friction(c, mg_slot_patch(c, slot))) return 0;
  if (cause == MG_FACES_SEPARATE || margin > c->settings->border * c->system->length || !mg_turns_on_curve(c, slot))
    return 0;
  mg_open_covered(c);
  c->patches.trial[slot] = 0, c->patches.barred[slot] = mg_slot_patch(c, slot);
  mg_apply_transition(c, events, pad, MG_PATCH_BEGINS, c->run->t, 0);
  mg_apply_transition(c, events, pad, MG_PATCH_TURNS_OVER_EDGE, c->run->t, 0);
  mg_turn_over_edge(c, slot);
  mg_update_rows_and_forces(c);
  return 1;
}

/* Patches that lie flat rest, if there are forces that press them together within their hulls; what they cover gives
 * way. */
MG_INTERNAL void mg_begin_patches(mg_context *c, mg_events *events, mg_real touching) {
  if (!mg_hold_flat_patches(c, touching, 0)) return;
  if (c->system->n_grip) mg_update_rows_and_forces(c);
  do {
    mg_mark_covered(c);
    if (mg_solve_active_set(c, c->patches.is_covered)) {
      mg_release_trials(c);
      return;
    }
    if (mg_turns_at_once(c, events)) return;
  } while (mg_reject_trials(c, c->force, mg_patch_force_scale(c), 0));
  mg_open_covered(c);
  for (int slot = 0; slot < c->system->n_slot; slot++)
    if (c->patches.trial[slot]) mg_apply_transition(c, events, mg_slot_support(c, slot), MG_PATCH_BEGINS, c->run->t, 0);
}
