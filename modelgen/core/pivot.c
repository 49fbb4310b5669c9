/* The imaginary edge (section 5.3): where a face turns over a smooth rim, a tangent of the rim that is fixed in the body
   stays on the plane until the body leans enough for the equations of the rim; a slot's first two pads hold it, and the
   third tells on which side of flat the body leans. */
#include "core.h"

/* The slot holds an imaginary edge in place of a patch. */
static int mg_pivots(const mg_context *c, int slot) {
  return mg_patch_in(c, slot) >= 0 && !c->run->closed[mg_pad_of(c, slot) + 2];
}

/* The lean about the edge, rad; negative where the face would sink into the other. */
static mg_real mg_lean_of(const mg_context *c, int slot) {
  return asin(2 * c->d[mg_pad_of(c, slot) + 2] / c->sys->length);
}

/* The cause for which an edge is given up, or 0: the body leans enough, or comes back flat. */
static int mg_edge_ends(const mg_context *c, int slot) {
  const mg_real lean = mg_lean_of(c, slot);
  if (lean > c->set->imaginary_edge + c->set->border) return MG_ROLLS;
  return lean < -c->set->border ? MG_SETTLES : 0;
}

/* Moves the pads of a slot onto the tangent of the rim at a point of the world; needs the patch still held. */
static void mg_hold_edge(mg_context *c, int slot, const mg_real *world, const mg_real *outward) {
  const int pad = mg_pad_of(c, slot);
  const mg_real *pose = c->pose + 12 * c->f[pad];
  mg_real o[12], back[3];
  mg_face_pose(c, mg_patch_in(c, slot), 0, o);
  const mg_real *n = o + 9, half = c->sys->length / 2;
  const mg_real along[3] = {n[1] * outward[2] - n[2] * outward[1], n[2] * outward[0] - n[0] * outward[2],
                            n[0] * outward[1] - n[1] * outward[0]};
  for (int end = 0; end < 2; end++) {
    mg_real at[3];
    for (int k = 0; k < 3; k++) at[k] = world[k] + (end ? half : -half) * along[k];
    mg_into(pose, at, c->run->point + 3 * (pad + end));
  }
  for (int k = 0; k < 3; k++) back[k] = world[k] - half * outward[k];
  mg_into(pose, back, c->run->point + 3 * (pad + 2));
  c->run->closed[pad + 2] = c->run->active[pad + 2] = 0;
}

/* The rim takes over from the edge. */
static void mg_leave_edge(mg_context *c, int slot, mg_events *events) {
  const int pad = mg_pad_of(c, slot), patch = mg_patch_in(c, slot);
  mg_founds found;
  mg_real ends[2][3], middle[3];
  for (int end = 0; end < 2; end++) mg_pad_point(c, pad + end, ends[end]);
  for (int k = 0; k < 3; k++) middle[k] = (ends[0][k] + ends[1][k]) / 2;
  mg_drop_patch(c, slot);
  mg_uncover(c, patch, &found);
  const int contact = mg_contact_at(c, c->sys->patch_pair[patch], middle);
  if (contact < 0) return;
  mg_close(c, contact);
  mg_befalls(c, events, contact, MG_WALKS_ON, c->run->t, 0);
}
