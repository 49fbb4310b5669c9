/* Impacts that would press a flat face outside its curved hull: the face is struck at points of the hull edge.
   Newton's law holds at every point of the edge, but only two or three points carry an impulse; they are found by
   an exchange method (Remez) that moves a support to the point where the law is violated most. Writes supports
   and modes of the slots. */
#include "patch/patch.h"
#include "base/base.h"
#include "region/region.h"
#include "model/model.h"
#include "forces/forces.h"

/* Affine field of the relative normal velocity of two faces in hull axes: value at the origin and its two slopes. */
static void mg_normal_velocity_field(const mg_context *c, int patch, const mg_real *per_body, mg_real *field) {
  mg_real hull[12], o[12], world_point[3];
  mg_hull_pose(c, patch, hull);
  mg_face_pose(c, patch, 0, o);
  for (int k = 0; k < 3; k++) {
    for (int i = 0; i < 3; i++) world_point[i] = hull[i] + (k ? hull[3 * k + i] : 0);
    field[k] = mg_point_speed_along_normal(c, per_body, mg_patch_body(c, patch, 1), world_point, o + 9) -
               mg_point_speed_along_normal(c, per_body, mg_patch_body(c, patch, 0), world_point, o + 9);
  }
  field[1] -= field[0], field[2] -= field[0];
}

/* Value of an affine field at a point. */
static mg_real mg_field_value_at(const mg_real *field, const mg_real *point) {
  return field[0] + mg_dot2(field + 1, point);
}

/* True if the hull has a curved edge. */
static int mg_has_curved_hull_edge(const mg_hull *h) {
  for (int i = 0; i < h->n_edge; i++)
    if (h->edges[i].direction) return 1;
  return 0;
}

/* Least value of a field over the hull of a patch, and the extreme point there. */
static mg_real mg_least_field_over_hull(mg_context *c, int patch, const mg_real *field, mg_support_point *at) {
  mg_real least = MG_MAX;
  mg_overlay_patch_regions(c, patch);
  const mg_hull *h = &c->patches.hull;
  for (int i = 0; i < h->n_edge; i++) {
    const mg_hull_edge *e = h->edges + i;
    const mg_real here = mg_field_value_at(field, h->vertices[e->from_vertex].point);
    if (here < least) least = here, mg_read_support_point(h, e->from_vertex, at);
    if (!e->direction) continue;
    const mg_hull_vertex *a = h->vertices + (e->direction > 0 ? e->from_vertex : e->to_vertex),
                         *b = h->vertices + a->next;
    if (!(mg_dot2(field + 1, a->tangent) < 0 && mg_dot2(field + 1, b->tangent) > 0)) continue;
    mg_real p[2], T[2];
    const mg_real t = mg_zero_on_arc(h->arcs + a->arc, MG_ZERO_SUPPORT, field + 1, a->t, a->t_end);
    mg_arc_point(h->arcs + a->arc, t, p, T);
    if (!(mg_field_value_at(field, p) < least)) continue;
    least = mg_field_value_at(field, p);
    const mg_support_point found = {h->arcs[a->arc].side, a->arc, -1, t, 0, {p[0], p[1]}};
    *at = found;
  }
  return least;
}

/* Put a free support of the slot at a hull point; returns 0 where all three are in use. */
static int mg_place_support_on_edge(mg_context *c, int slot, const mg_support_point *at) {
  const int first = mg_first_support(c, slot), patch = mg_patch_of_slot(c, slot);
  mg_real hull[12], world[3];
  int support = first;
  while (support < first + 3 && c->run->closed[support]) support++;
  if (support == first + 3) return 0;
  mg_hull_pose(c, patch, hull);
  mg_hull_point_to_world(hull, at, world);
  mg_world_to_local_point(c->bodies.pose + 12 * c->contacts.f[support], world, c->run->point + 3 * support);
  mg_set_closed(c, support, 1);
  return 1;
}

MG_INTERNAL int mg_move_patch_to_edge(mg_context *c, int slot) {
  const int support = mg_first_support(c, slot), patch = mg_patch_of_slot(c, slot);
  mg_real before[3];
  mg_support_point at;
  if (c->system->n_friction || mg_is_edge_pivot(c, slot) || mg_is_patch_rolling_start(c, patch)) return 0;
  if (mg_overlay_patch_regions(c, patch) < 3 || !mg_has_curved_hull_edge(&c->patches.hull)) return 0;
  mg_normal_velocity_field(c, patch, c->bodies.twist, before);
  const mg_real fastest = mg_least_field_over_hull(c, patch, before, &at) * c->system->time / c->system->length;
  if (c->patches.trial[slot] && fastest < -c->settings->rest_speed && fastest * fastest < c->settings->flat_angle)
    return 0;
  for (int k = 0; k < 3; k++) mg_set_closed(c, support + k, 0);
  c->patches.trial[slot] = c->patches.trial[slot] ? MG_TRIAL_ON_EDGE : MG_TRIAL_TORN_OFF;
  mg_place_support_on_edge(c, slot, &at);
  mg_evaluate_run_state(c);
  return 1;
}

/* Compute the velocity changes of all bodies by the listed impulses. */
static void mg_apply_impulse_velocity_change(mg_context *c, int size) {
  for (int i = 0; i < 6 * c->system->n_body; i++) c->bodies.wrench[i] = 0;
  for (int r = 0; r < size; r++) mg_add_row_response(c, c->lcp.rows[r], c->lcp.z[r], c->bodies.wrench);
}

/* Largest violation of Newton's restitution law along the hull edge, and its point. */
static mg_real mg_worst_restitution_violation(mg_context *c, int slot, mg_support_point *at) {
  const int patch = mg_patch_of_slot(c, slot);
  const mg_real e = c->system->restitution[mg_first_support(c, slot)],
                rest = c->settings->rest_speed * c->system->length / c->system->time;
  mg_real before[3], after[3], rebound[3];
  mg_support_point other;
  mg_normal_velocity_field(c, patch, c->bodies.twist, before);
  mg_normal_velocity_field(c, patch, c->bodies.wrench, after);
  for (int k = 0; k < 3; k++) after[k] += before[k], rebound[k] = after[k] + e * before[k];
  const mg_real least = mg_least_field_over_hull(c, patch, after, at),
                rebound_least = mg_least_field_over_hull(c, patch, rebound, &other);
  if (!(rebound_least < least) || !(-e * mg_field_value_at(before, other.point) > rest)) return least;
  *at = other;
  return rebound_least;
}

MG_INTERNAL int mg_exchange_edge_supports(mg_context *c, int n) {
  const mg_real missed = -c->settings->feature_border * c->system->length / c->system->time;
  int count = 0;
  mg_apply_impulse_velocity_change(c, mg_append_bilateral_rows(c, c->lcp.rows, n));
  for (int r = 0; r < n; r++)
    if (mg_is_support_on_edge(c, c->lcp.rows[r]) && !(c->lcp.z[r] > 0)) c->run->closed[c->lcp.rows[r]] = 0;
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    mg_support_point at;
    if (c->patches.trial[slot] >= MG_TRIAL_ON_EDGE && mg_worst_restitution_violation(c, slot, &at) < missed)
      count += mg_place_support_on_edge(c, slot, &at);
  }
  if (count) mg_evaluate_run_state(c);
  return count;
}

MG_INTERNAL int mg_append_edge_supports(const mg_context *c, int *list, int n) {
  for (int i = c->layout.support_begin; i < c->system->n_contact; i++)
    if (c->run->closed[i] && mg_is_support_on_edge(c, i)) list[n++] = i;
  return n;
}

/* After the impact, find where the face stays in contact: returns 1 for a point, 2 for a side, 0 where it
   separates or stays flat. */
static int mg_find_lasting_edge_contact(mg_context *c, int patch, mg_nearest_boundary *nearest) {
  const mg_real rest = c->settings->rest_speed * c->system->length / c->system->time;
  mg_real field[3];
  mg_normal_velocity_field(c, patch, c->bodies.twist, field);
  const mg_real least = mg_least_field_over_hull(c, patch, field, nearest->at),
                slope_norm = sqrt(mg_dot2(field + 1, field + 1));
  if (least > rest || !(slope_norm * c->system->length > rest)) return nearest->n = 0;
  nearest->margin = 0, nearest->normal[0] = -field[1] / slope_norm, nearest->normal[1] = -field[2] / slope_norm;
  for (int i = 0; i < c->patches.hull.n_edge; i++) {
    const mg_hull_edge *e = c->patches.hull.edges + i;
    const mg_real u = mg_field_value_at(field, c->patches.hull.vertices[e->from_vertex].point),
                  v = mg_field_value_at(field, c->patches.hull.vertices[e->to_vertex].point);
    if (e->direction || u > rest || v > rest || e->length <= MG_SHORT_SIDE * c->patches.hull.regions->coincidence)
      continue;
    mg_read_support_point(&c->patches.hull, e->from_vertex, nearest->at),
        mg_read_support_point(&c->patches.hull, e->to_vertex, nearest->at + 1);
    return nearest->n = 2;
  }
  return nearest->n = 1;
}

/* Open, without an event, the covered contacts that separate: they were struck with their face. */
static void mg_open_covered_contacts(mg_context *c, int slot) {
  const int patch = mg_patch_of_slot(c, slot);
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (c->run->closed[i] && mg_is_feature_pair_in_patch(c, patch, c->run->feature_pair[i]) &&
        mg_row_times(c, i, c->bodies.twist) > 0)
      mg_set_closed(c, i, 0), c->events.triggered[i] = 0;
}

MG_INTERNAL void mg_finish_edge_impacts(mg_context *c, mg_events *events) {
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    const int support = mg_first_support(c, slot), patch = mg_patch_of_slot(c, slot),
              was_resting = c->patches.trial[slot] == MG_TRIAL_TORN_OFF;
    mg_nearest_boundary nearest;
    mg_real speed = 0;
    int struck = was_resting;
    if (c->patches.trial[slot] < MG_TRIAL_ON_EDGE) continue;
    for (int k = 0; k < 3; k++) {
      if (c->run->closed[support + k] && -c->rows.d_dot[support + k] > speed) speed = -c->rows.d_dot[support + k];
      struck |= c->run->closed[support + k];
    }
    if (!struck) continue;
    mg_open_covered_contacts(c, slot);
    mg_request_pair_searches(c, patch);
    const int stays = mg_find_lasting_edge_contact(c, patch, &nearest);
    if (was_resting)
      mg_apply_contact_transition(c, events, support, stays ? MG_PATCH_TURNS_OVER_EDGE : MG_LIFTS_OFF, c->run->t, 0);
    else mg_apply_contact_transition(c, events, support, stays ? MG_TOUCHES_DOWN : MG_IMPACT_REBOUND, c->run->t, speed);
    if (!stays) continue;
    mg_release_covered_contacts(c);
    c->patches.trial[slot] = 0;
    mg_tip_patch_at(c, slot, &nearest);
  }
}

MG_INTERNAL int mg_is_approaching_beyond_drift(const mg_context *c, int contact) {
  return c->rows.d_dot[contact] < -c->settings->drift_tolerance * c->system->length / c->system->time;
}

MG_INTERNAL mg_real mg_point_speed_along_normal(const mg_context *c, const mg_real *twists, int body, const mg_real *at,
                                                const mg_real *N) {
  const mg_real *pose = c->bodies.pose + 12 * body, *twist = twists + 6 * body;
  mg_real spin[3], arm[3];
  mg_to_world(pose, twist + 3, 0, spin);
  for (int k = 0; k < 3; k++) arm[k] = at[k] - pose[k];
  const mg_real v[3] = {twist[0] + spin[1] * arm[2] - spin[2] * arm[1], twist[1] + spin[2] * arm[0] - spin[0] * arm[2],
                        twist[2] + spin[0] * arm[1] - spin[1] * arm[0]};
  return mg_dot3(v, N);
}
