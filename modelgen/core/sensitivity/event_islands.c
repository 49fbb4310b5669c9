/* The events of one instant by islands: bodies that rows, closed or touching contacts and loads connect there. Where
   events happen in several islands at one time, a change of the start moves the time of each by itself. Writes
   s->island and s->crossings. */
#include "sensitivity/sensitivity.h"
#include "model/model.h"
#include "forces/forces.h"

static const mg_crossing mg_no_crossing = {MG_CROSSES_NOTHING, -1, -1, 0, MG_NO_REASON, -1};

MG_INTERNAL void mg_forget_crossings(mg_sensitivity *s) { s->crossing = mg_no_crossing, s->n_crossing = 0; }

MG_INTERNAL void mg_find_event_islands(mg_context *c, mg_sensitivity *s) {
  MG_NEEDS_ANY(c, MG_VALID_ROWS);
  const mg_system *system = c->system;
  const mg_real touching = mg_max(c->settings->contact_gap, c->settings->tolerance) * system->length;
  mg_part_bodies(c);
  for (int i = mg_next_row(c, -1); i < system->n_contact; i = mg_next_row(c, i))
    if (c->run->closed[i] || (mg_is_on_feature_pair(c, i) && fabs(c->rows.d[i]) <= touching))
      mg_join_bodies(c, c->contacts.o[i], c->contacts.f[i]);
  for (int j = 0; j < system->n_joint; j++) mg_join_bodies(c, system->joint_a[j], system->joint_b[j]);
  for (int l = 0; l < system->n_load; l++) mg_join_bodies(c, system->load_a[l], system->load_b[l]);
  for (int b = 0; b < system->n_body; b++) s->island[b] = mg_island_of_body(c, b);
}

/* Friction constraint of an event of slip, or -1. */
static int mg_constraint_of_event(const mg_context *c, int contact, int kind) {
  const int friction_kind = (kind - MG_EVENT_SLIP_START) / MG_EVENTS_PER_FRICTION;
  for (int g = c->system->contact_friction[contact]; g < c->system->contact_friction[contact + 1]; g++)
    if (c->system->friction_kind[g] == friction_kind) return g;
  return -1;
}

/* Event function of an event of the list, MG_CROSSES_NOTHING for one that follows from others. c is that of the run
   before it. */
static int mg_crossed_function(const mg_context *c, int kind, int contact) {
  if (kind == MG_EVENT_IMPACT || kind == MG_EVENT_TOUCH_DOWN)
    return c->run->closed[contact] ? MG_CROSSES_NOTHING : MG_CROSSES_GAP;
  if (kind == MG_EVENT_LIFT_OFF || kind == MG_EVENT_TIPPING) return MG_CROSSES_FORCE;
  if (kind == MG_EVENT_FEATURE_CHANGE || kind == MG_EVENT_VANISH) return MG_CROSSES_BORDER;
  if (kind == MG_EVENT_LOAD_SWITCH) return MG_CROSSES_SWITCH;
  if (kind < MG_EVENT_SLIP_START || kind >= MG_EVENT_FALLBACK_START) return MG_CROSSES_NOTHING;
  const int slot = mg_slot_of_support(c, contact);
  if (slot >= 0 ? !mg_is_whole_plane(c, mg_patch_of_slot(c, slot)) : mg_constraint_of_event(c, contact, kind) < 0)
    return MG_CROSSES_NOTHING;
  return (kind - MG_EVENT_SLIP_START) % MG_EVENTS_PER_FRICTION ? MG_CROSSES_SLIP : MG_CROSSES_BOUND;
}

/* True if no other contact has struck the bodies of a contact since it did: its bounces form one geometric series,
   whose sum has derivatives however early it is cut off. */
static int mg_bounces_alone(const mg_context *c, int contact) {
  const int bodies[2] = {c->contacts.o[contact], c->contacts.f[contact]};
  for (int side = 0; side < 2; side++)
    if (mg_is_moved_by_forces(c, bodies[side]) && c->run->struck_by[bodies[side]] != contact) return 0;
  return 1;
}

/* Why an event of the list makes derivatives uncertain, or 0. */
static int mg_uncertain_event(const mg_context *c, int kind, int contact) {
  if (kind == MG_EVENT_FALLBACK_START || kind == MG_EVENT_FALLBACK_END) return MG_BY_TIME_STEPPING;
  if (kind == MG_EVENT_FACE_CONTACT) return MG_BY_FACES;
  if (kind == MG_EVENT_TOUCH_DOWN && c->system->restitution[contact] > 0 && !mg_bounces_alone(c, contact))
    return MG_BY_REST_SPEED;
  return MG_NO_REASON;
}

/* Island of the contact, or of the load with the switching function, of an event. */
static int mg_island_of_event(const mg_context *c, const mg_sensitivity *s, int kind, int contact) {
  const mg_system *system = c->system;
  if (kind != MG_EVENT_LOAD_SWITCH) return s->island[mg_moving_body(c, contact)];
  const int load = mg_load_of_switch(system, contact), a = system->load_a[load], b = system->load_b[load];
  return s->island[mg_is_moved_by_forces(c, a) || b < 0 ? a : b];
}

/* The crossing of an island, a new one if it has none, or null where there are too many. */
static mg_crossing *mg_crossing_of_island(mg_sensitivity *s, int island) {
  for (int k = 0; k < s->n_crossing; k++)
    if (s->crossings[k].island == island) return s->crossings + k;
  if (s->n_crossing >= MG_CROSSINGS) return 0;
  mg_crossing *added = s->crossings + s->n_crossing++;
  *added = mg_no_crossing, added->island = island;
  return added;
}

static int mg_is_blow(int kind) { return kind == MG_EVENT_IMPACT || kind == MG_EVENT_TOUCH_DOWN; }

/* Adds an event to those of its island: what jumps most is its event function. */
static void mg_add_event(const mg_context *c, mg_crossing *found, int kind, int contact) {
  static const int order[] = {0, 6, 4, 3, 2, 1, 5}; /* by MG_CROSSES_.. */
  const int function = mg_crossed_function(c, kind, contact),
            constraint = kind >= MG_EVENT_SLIP_START && kind < MG_EVENT_FALLBACK_START
                             ? mg_constraint_of_event(c, contact, kind)
                             : -1;
  found->blow |= mg_is_blow(kind);
  if (function == found->kind && function != MG_CROSSES_NOTHING && function != MG_CROSSES_BORDER &&
      (contact != found->contact || constraint != found->constraint) && !found->reason)
    found->reason = MG_BY_SEVERAL_EVENTS;
  if (order[function] <= order[found->kind]) return;
  found->kind = function, found->contact = contact, found->constraint = constraint;
}

/* True if an event has no event function and makes no blow: it follows from others. */
static int mg_follows_from_others(const mg_context *c, int kind, int contact) {
  return !mg_is_blow(kind) && mg_crossed_function(c, kind, contact) == MG_CROSSES_NOTHING;
}

MG_INTERNAL void mg_find_crossings(mg_context *c, mg_sensitivity *s, const mg_events *events, int first) {
  s->n_crossing = 0;
  for (int follows = 1; follows >= 0; follows--) /* what is uncertain by itself is told before what comes at one time */
    for (int k = first; k < events->count; k++) {
      const int kind = events->kind[k], contact = events->contact[k];
      if (mg_follows_from_others(c, kind, contact) != follows) continue;
      mg_crossing *found = mg_crossing_of_island(s, mg_island_of_event(c, s, kind, contact));
      if (!found) {
        s->crossings->reason = MG_BY_SEVERAL_EVENTS;
        s->is_lost |= mg_is_blow(kind);
        continue;
      }
      if (!found->reason) found->reason = mg_uncertain_event(c, kind, contact);
      if (!follows) mg_add_event(c, found, kind, contact);
    }
}

MG_INTERNAL void mg_choose_crossing(mg_sensitivity *s, int k) {
  s->crossing = s->crossings[k];
  s->event_rate = s->event_rates + (long)k * (s->directions->n + 1);
}

MG_INTERNAL int mg_is_in_crossing(const mg_sensitivity *s, int body) {
  return s->crossing.island < 0 || s->island[body] == s->crossing.island;
}

MG_INTERNAL int mg_is_row_in_crossing(const mg_context *c, const mg_sensitivity *s, int row) {
  return mg_is_in_crossing(s, mg_moving_body(c, row));
}
