/* Edges about which a face tips: the first two supports of a slot hold the edge, the third measures the tilt. A
   straight side of the hull that ends on curves is held until the tilt is large enough for the equations of the curves.
   The imaginary edge (section 5.3 of Anitescu, Cremer and Potra, 1995), a tangent of a smooth rim fixed in the body, is
   held bilaterally in place of the rim. Writes support points and modes of the slot. */
#include "patch/patch.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

/* Move the supports of a slot onto an edge between two world points. Needs the patch still held. */
static void mg_move_supports_to_edge(mg_context *c, int slot, mg_real ends[2][3], const mg_real *outward) {
  MG_REQUIRE(mg_patch_of_slot(c, slot) >= 0);
  const int support = mg_first_support(c, slot);
  const mg_real *pose = c->bodies.pose + 12 * c->contacts.f[support];
  mg_real inner_point[3];
  for (int end = 0; end < 2; end++) mg_world_to_local_point(pose, ends[end], c->run->point + 3 * (support + end));
  for (int k = 0; k < 3; k++) inner_point[k] = (ends[0][k] + ends[1][k] - c->system->length * outward[k]) / 2;
  mg_world_to_local_point(pose, inner_point, c->run->point + 3 * (support + 2));
  mg_set_closed(c, support + 2, 0);
}

MG_INTERNAL void mg_hold_tangent_edge(mg_context *c, int slot, const mg_real *world, const mg_real *outward) {
  const mg_real half = c->system->length / 2;
  mg_real o[12], along[3], ends[2][3];
  mg_face_pose(c, mg_patch_of_slot(c, slot), 0, o);
  mg_cross_product(o + 9, outward, along);
  for (int end = 0; end < 2; end++)
    for (int k = 0; k < 3; k++) ends[end][k] = world[k] + (end ? half : -half) * along[k];
  mg_move_supports_to_edge(c, slot, ends, outward);
}

MG_INTERNAL void mg_hold_hull_side(mg_context *c, int slot, mg_real ends[2][3], const mg_real *outward) {
  mg_move_supports_to_edge(c, slot, ends, outward);
  mg_set_rolling_start(c, mg_first_support(c, slot), MG_ON_STRAIGHT_EDGE);
}

/* Close the contact at a world point, which follows the edge. */
static void mg_start_contact_from_edge(mg_context *c, int patch, const mg_real *world, mg_events *events) {
  const int contact = mg_find_contact_at_point(c, patch, world);
  if (contact < 0) return;
  mg_close_contact(c, contact);
  mg_set_rolling_start(c, contact, MG_START_SETTLING);
  mg_apply_contact_transition(c, events, contact, MG_FEATURE_CHANGES, c->run->t, 0);
}

MG_INTERNAL void mg_end_edge_pivot(mg_context *c, int slot, mg_events *events) {
  const int support = mg_first_support(c, slot), patch = mg_patch_of_slot(c, slot),
            on_hull_side = mg_is_hull_side_pivot(c, slot);
  mg_minima found;
  mg_real ends[2][3], middle[3];
  for (int end = 0; end < 2; end++) mg_support_world_point(c, support + end, ends[end]);
  for (int k = 0; k < 3; k++) middle[k] = (ends[0][k] + ends[1][k]) / 2;
  mg_release_patch(c, slot);
  mg_restore_covered_contacts(c, patch, &found);
  for (int end = 0; end < 1 + on_hull_side; end++)
    mg_start_contact_from_edge(c, patch, on_hull_side ? ends[end] : middle, events);
}
