/* Blows that would press a flat face outside its hull, where the hull is curved: the face is struck at points of its
   edge. Newton's law holds for every point of the edge, but two or three alone are struck. They are sought by exchange
   (Remez): the pads of the slot stand, pushing, on points of the edge; where the others leave one that approaches, a
   pad moves there. */
#include "patch/patch.h"
#include "base/base.h"
#include "region/region.h"
#include "model/model.h"
#include "forces/forces.h"

/* Of velocities, 6 numbers a body: that of f's face along N against o's at the origin of the hull, and its slopes
 * there. */
static void mg_field(const mg_context *c, int patch, const mg_real *per_body, mg_real *field) {
  mg_real hull[12], o[12], at[3];
  mg_hull_pose(c, patch, hull);
  mg_face_pose(c, patch, 0, o);
  for (int k = 0; k < 3; k++) {
    for (int i = 0; i < 3; i++) at[i] = hull[i] + (k ? hull[3 * k + i] : 0);
    field[k] = mg_speed_along(c, per_body, mg_patch_body(c, patch, 1), at, o + 9) -
               mg_speed_along(c, per_body, mg_patch_body(c, patch, 0), at, o + 9);
  }
  field[1] -= field[0], field[2] -= field[0];
}

static mg_real mg_in_field(const mg_real *field, const mg_real *point) { return field[0] + mg_dot2(field + 1, point); }

static int mg_has_curve(const mg_hull *h) {
  for (int i = 0; i < h->n_edge; i++)
    if (h->edges[i].direction) return 1;
  return 0;
}

/* The least of a field over the hull of a patch, and the extreme point where it is. */
static mg_real mg_lowest(mg_context *c, int patch, const mg_real *field, mg_support_point *at) {
  mg_real least = MG_MAX;
  mg_overlay_patch(c, patch);
  const mg_hull *h = &c->patches.hull;
  for (int i = 0; i < h->n_edge; i++) {
    const mg_hull_edge *e = h->edges + i;
    const mg_real here = mg_in_field(field, h->vertices[e->u].point);
    if (here < least) least = here, mg_read_support_point(h, e->u, at);
    if (!e->direction) continue;
    const mg_hull_vertex *a = h->vertices + (e->direction > 0 ? e->u : e->v), *b = h->vertices + a->next;
    if (!(mg_dot2(field + 1, a->tangent) < 0 && mg_dot2(field + 1, b->tangent) > 0)) continue;
    mg_real p[2], T[2];
    const mg_real t = mg_zero_on_arc(h->arcs + a->track, MG_ZERO_SUPPORT, field + 1, a->t, a->t_end);
    mg_arc_point(h->arcs + a->track, t, p, T);
    if (!(mg_in_field(field, p) < least)) continue;
    least = mg_in_field(field, p);
    const mg_support_point found = {h->arcs[a->track].side, a->track, -1, t, 0, {p[0], p[1]}};
    *at = found;
  }
  return least;
}

/* A pad that does not push takes a place on the edge; returns 0 where all push. */
static int mg_stand_on_edge(mg_context *c, int slot, const mg_support_point *at) {
  const int first = mg_slot_support(c, slot), patch = mg_slot_patch(c, slot);
  mg_real hull[12], world[3];
  int pad = first;
  while (pad < first + 3 && c->run->closed[pad]) pad++;
  if (pad == first + 3) return 0;
  mg_hull_pose(c, patch, hull);
  mg_hull_point_in_world(hull, at, world);
  mg_to_local(c->pose + 12 * c->f[pad], world, c->run->point + 3 * pad);
  c->run->closed[pad] = 1;
  return 1;
}

/* Puts the slot's pads on the edge, one where the face approaches fastest. Returns 0 where the hull has no curve, the
   face rolls on it already, or it approaches so slowly that it would be flat again before it leans by as much as stands
   on three points. */
MG_INTERNAL int mg_move_supports_to_edge(mg_context *c, int slot) {
  const int pad = mg_slot_support(c, slot), patch = mg_slot_patch(c, slot);
  mg_real before[3];
  mg_support_point at;
  if (c->system->n_grip || mg_is_turning_on_edge(c, slot) || mg_is_patch_starting_to_roll(c, patch)) return 0;
  if (mg_overlay_patch(c, patch) < 3 || !mg_has_curve(&c->patches.hull)) return 0;
  mg_field(c, patch, c->twist, before);
  const mg_real fastest = mg_lowest(c, patch, before, &at) * c->system->time / c->system->length;
  if (c->patches.trial[slot] && fastest < -c->settings->rest_speed && fastest * fastest < c->settings->flat) return 0;
  for (int k = 0; k < 3; k++) c->run->closed[pad + k] = c->run->active[pad + k] = 0;
  c->patches.trial[slot] = c->patches.trial[slot] ? MG_TRIAL_ON_EDGE : MG_TRIAL_TORN_OFF;
  mg_stand_on_edge(c, slot, &at);
  mg_update_rows_and_forces(c);
  return 1;
}

/* What the impulses in c->lcp.z of the rows in c->lcp.rows change of the velocities, into c->wrench. */
static void mg_change_by(mg_context *c, int size) {
  for (int i = 0; i < 6 * c->system->n_body; i++) c->wrench[i] = 0;
  for (int r = 0; r < size; r++) mg_add_row_response(c, c->lcp.rows[r], c->lcp.z[r], c->wrench);
}

/* The point of the edge at which Newton's law is missed most, and by how much. The law: what approached rebounds,
   nothing approaches. */
static mg_real mg_most_missed(mg_context *c, int slot, mg_support_point *at) {
  const int patch = mg_slot_patch(c, slot);
  const mg_real e = c->system->restitution[mg_slot_support(c, slot)],
                rest = c->settings->rest_speed * c->system->length / c->system->time;
  mg_real before[3], after[3], rebound[3];
  mg_support_point other;
  mg_field(c, patch, c->twist, before);
  mg_field(c, patch, c->wrench, after);
  for (int k = 0; k < 3; k++) after[k] += before[k], rebound[k] = after[k] + e * before[k];
  const mg_real least = mg_lowest(c, patch, after, at), bounced = mg_lowest(c, patch, rebound, &other);
  if (!(bounced < least) || !(-e * mg_in_field(before, other.point) > rest)) return least;
  *at = other;
  return bounced;
}

/* After the impulses in c->lcp.z, of which the first n of c->lcp.rows are rows that push: pads that do not push are
   free, and one of each slot on an edge moves to where the law is missed. Returns how many did. */
MG_INTERNAL int mg_exchange_edge_supports(mg_context *c, int n) {
  const mg_real missed = -c->settings->border * c->system->length / c->system->time;
  int count = 0;
  mg_change_by(c, mg_append_bilateral_rows(c, c->lcp.rows, n));
  for (int r = 0; r < n; r++)
    if (mg_is_on_edge_trial(c, c->lcp.rows[r]) && !(c->lcp.z[r] > 0)) c->run->closed[c->lcp.rows[r]] = 0;
  for (int slot = 0; slot < c->system->n_slot; slot++) {
    mg_support_point at;
    if (c->patches.trial[slot] >= MG_TRIAL_ON_EDGE && mg_most_missed(c, slot, &at) < missed)
      count += mg_stand_on_edge(c, slot, &at);
  }
  if (count) mg_update_rows_and_forces(c);
  return count;
}

/* Rows of pads on edges, appended to a list of rows that push. */
MG_INTERNAL int mg_append_edge_supports(const mg_context *c, int *list, int n) {
  for (int i = c->support_begin; i < c->system->n_contact; i++)
    if (c->run->closed[i] && mg_is_on_edge_trial(c, i)) list[n++] = i;
  return n;
}

/* After the blow, at the velocities it left: where the face stays, at a point or both ends of a side, and turns;
   returns at how many points, 0 where it parts or stays flat. */
static int mg_stays_at(mg_context *c, int patch, mg_nearest_boundary *brink) {
  const mg_real rest = c->settings->rest_speed * c->system->length / c->system->time;
  mg_real field[3];
  mg_field(c, patch, c->twist, field);
  const mg_real least = mg_lowest(c, patch, field, brink->at), steep = sqrt(mg_dot2(field + 1, field + 1));
  if (least > rest || !(steep * c->system->length > rest)) return brink->n = 0;
  brink->margin = 0, brink->normal[0] = -field[1] / steep, brink->normal[1] = -field[2] / steep;
  for (int i = 0; i < c->patches.hull.n_edge; i++) {
    const mg_hull_edge *e = c->patches.hull.edges + i;
    const mg_real u = mg_in_field(field, c->patches.hull.vertices[e->u].point),
                  v = mg_in_field(field, c->patches.hull.vertices[e->v].point);
    if (e->direction || u > rest || v > rest || e->length <= MG_SHORT_SIDE * c->patches.hull.regions->shared) continue;
    mg_read_support_point(&c->patches.hull, e->u, brink->at),
        mg_read_support_point(&c->patches.hull, e->v, brink->at + 1);
    return brink->n = 2;
  }
  return brink->n = 1;
}

/* What a face covers that is struck at its edge has been struck with it, and is not told of by itself. */
static void mg_open_quietly(mg_context *c, int slot) {
  const int patch = mg_slot_patch(c, slot);
  for (int i = 0; i < c->support_begin; i++)
    if (c->run->closed[i] && mg_patch_covers(c, patch, c->run->link[i]) && mg_row_times(c, i, c->twist) > 0)
      c->run->closed[i] = c->run->active[i] = c->events.triggered[i] = 0;
}

/* Lets the struck faces part, or go on from where they stay on their edges. */
MG_INTERNAL void mg_settle_edge_supports(mg_context *c, mg_events *events) {
  for (int slot = 0; slot < c->system->n_slot; slot++) {
    const int pad = mg_slot_support(c, slot), patch = mg_slot_patch(c, slot),
              torn = c->patches.trial[slot] == MG_TRIAL_TORN_OFF;
    mg_nearest_boundary brink;
    mg_real speed = 0;
    int struck = torn;
    if (c->patches.trial[slot] < MG_TRIAL_ON_EDGE) continue;
    for (int k = 0; k < 3; k++) {
      if (c->run->closed[pad + k] && -c->d_dot[pad + k] > speed) speed = -c->d_dot[pad + k];
      struck |= c->run->closed[pad + k];
    }
    if (!struck) continue;
    mg_open_quietly(c, slot);
    mg_request_patch_search(c, patch);
    const int stays = mg_stays_at(c, patch, &brink);
    if (torn) mg_apply_transition(c, events, pad, stays ? MG_PATCH_TURNS_OVER_EDGE : MG_LIFTS_OFF, c->run->t, 0);
    else mg_apply_transition(c, events, pad, stays ? MG_TOUCHES_DOWN : MG_IMPACT_REBOUND, c->run->t, speed);
    if (!stays) continue;
    mg_open_covered(c);
    c->patches.trial[slot] = 0;
    mg_turn_on_boundary(c, slot, &brink);
  }
}

/* Any approach beyond drift: also one too slow to bounce is stopped here, not left to penetrate. */
MG_INTERNAL int mg_is_approaching_beyond_drift(const mg_context *c, int contact) {
  return c->d_dot[contact] < -c->settings->drift * c->system->length / c->system->time;
}
