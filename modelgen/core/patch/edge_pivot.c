/* Edges that a face turns on: a slot's first two pads hold the edge, and the third tells on which side of flat the body
   leans. A straight side of the hull that ends on curves stays on the plane, both ends pressing, until the body leans
   enough for the equations of the curves. The imaginary edge (section 5.3), a tangent of a smooth rim that is fixed in
   the body, is held both ways in place of the rim itself. */
#include "patch/patch.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

/* Moves the pads of a slot onto an edge between two points of the world; needs the patch still held. */
static void mg_hold_edge(mg_context *c, int slot, mg_real ends[2][3], const mg_real *outward) {
  const int pad = mg_slot_support(c, slot);
  const mg_real *pose = c->pose + 12 * c->f[pad];
  mg_real back[3];
  for (int end = 0; end < 2; end++) mg_to_local(pose, ends[end], c->run->point + 3 * (pad + end));
  for (int k = 0; k < 3; k++) back[k] = (ends[0][k] + ends[1][k] - c->system->length * outward[k]) / 2;
  mg_to_local(pose, back, c->run->point + 3 * (pad + 2));
  c->run->closed[pad + 2] = c->run->active[pad + 2] = 0;
}

/* The imaginary edge: along the tangent of the rim at a point of the world. */
MG_INTERNAL void mg_hold_imaginary_edge(mg_context *c, int slot, const mg_real *world, const mg_real *outward) {
  const mg_real half = c->system->length / 2;
  mg_real o[12], along[3], ends[2][3];
  mg_face_pose(c, mg_slot_patch(c, slot), 0, o);
  mg_cross(o + 9, outward, along);
  for (int end = 0; end < 2; end++)
    for (int k = 0; k < 3; k++) ends[end][k] = world[k] + (end ? half : -half) * along[k];
  mg_hold_edge(c, slot, ends, outward);
}

/* A side of the hull. */
MG_INTERNAL void mg_hold_straight_edge(mg_context *c, int slot, mg_real ends[2][3], const mg_real *outward) {
  mg_hold_edge(c, slot, ends, outward);
  c->run->fresh[mg_slot_support(c, slot)] = MG_ON_STRAIGHT_EDGE;
}

/* What touches at a point of the world takes over from the edge. */
static void mg_take_over(mg_context *c, int patch, const mg_real *world, mg_events *events) {
  const int contact = mg_covered_contact_at(c, patch, world);
  if (contact < 0) return;
  mg_close_contact(c, contact);
  c->run->fresh[contact] = MG_START_SETTLING;
  mg_apply_transition(c, events, contact, MG_FEATURE_CHANGES, c->run->t, 0);
}

MG_INTERNAL void mg_leave_edge(mg_context *c, int slot, mg_events *events) {
  const int pad = mg_slot_support(c, slot), patch = mg_slot_patch(c, slot), hinged = mg_is_on_straight_edge(c, slot);
  mg_minima found;
  mg_real ends[2][3], middle[3];
  for (int end = 0; end < 2; end++) mg_support_in_hull(c, pad + end, ends[end]);
  for (int k = 0; k < 3; k++) middle[k] = (ends[0][k] + ends[1][k]) / 2;
  mg_release_patch(c, slot);
  mg_uncover_links_of(c, patch, &found);
  for (int end = 0; end < 1 + hinged; end++) mg_take_over(c, patch, hinged ? ends[end] : middle, events);
}
