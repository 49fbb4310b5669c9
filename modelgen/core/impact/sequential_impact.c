/* Blows in turn: of the contacts that approach, the fastest is struck, alone, until none does any more. */
#include "impact/impact.h"
#include "solve/lcp/solvers.h"
#include "model/model.h"

enum { MG_BLOWS = 1000 };

/* Whether contacts are struck one after another: where that is asked for, or one follows a law for a single contact. */
MG_INTERNAL int mg_is_sequential_impact(const mg_context *c) {
  int singly = c->settings->sequential;
  for (int i = 0; i < c->support_begin; i++) singly |= c->run->closed[i] && c->system->impact_law[i] != MG_NEWTON;
  return singly;
}

static int mg_fastest(const mg_context *c) {
  const mg_real touching = c->settings->gap * c->system->length;
  int fastest = -1;
  for (int i = 0; i < c->support_begin; i++) {
    if (!mg_is_on_link(c, i) || !(c->run->closed[i] || fabs(c->d[i]) <= touching) || !mg_is_bouncing_approach(c, i))
      continue;
    if (fastest < 0 || c->d_dot[i] < c->d_dot[fastest]) fastest = i;
  }
  return fastest;
}

/* The rows of the contact that slip, then those of the joints, assembled; returns how many, of the contact in *own. */
static int mg_list_blow(mg_context *c, int contact, int *own, mg_impact_path *b) {
  int n = 0;
  c->lcp.rows[n++] = contact, b->mu[0] = b->mu[1] = 0;
  for (int g = c->system->contact_grip[contact]; g < c->system->contact_grip[contact + 1] && c->system->n_grip; g++) {
    if (c->system->grip_aspect[g] != MG_SLIP) continue;
    for (int k = 0; k < 2; k++)
      c->lcp.rows[n++] = mg_grip_row(c, contact, g) + k, b->mu[k] = c->system->grip_kinetic[2 * g + k];
  }
  *own = n;
  n = mg_append_joint_rows(c, c->lcp.rows, n);
  mg_assemble_delassus(c, c->lcp.rows, n);
  return n;
}

/* What the joints answer to the impulses in c->lcp.z of the first `own` rows, into c->lcp.z of theirs. */
static void mg_answer(mg_context *c, int n, int own) {
  for (int r = 0; r < n; r++) {
    c->lcp.b[r] = 0, c->lcp.mask[r] = r >= own;
    for (int j = 0; j < own; j++) c->lcp.b[r] += c->lcp.A[r + (long)n * j] * c->lcp.z[j];
  }
  mg_real *answer = c->row_rate;
  mg_active_above(n, c->lcp.A, c->lcp.b, c->lcp.mask, c->settings->singular, answer, c->lcp.work, c->lcp.iwork);
  for (int r = own; r < n; r++) c->lcp.z[r] = answer[r];
}

/* G with the joints held. */
static void mg_reduce_blow(mg_context *c, int n, int own, mg_impact_path *b) {
  for (int k = 0; k < 9; k++) b->G[k] = k % 4 == 0;
  for (int j = 0; j < own; j++) {
    for (int r = 0; r < own; r++) c->lcp.z[r] = r == j;
    if (n > own) mg_answer(c, n, own);
    for (int r = 0; r < own; r++) {
      b->G[3 * r + j] = c->lcp.A[r + (long)n * j];
      for (int k = own; k < n; k++) b->G[3 * r + j] += c->lcp.A[r + (long)n * k] * c->lcp.z[k];
    }
  }
}

/* Turns t1, t2 to where the blow yields most and least, and takes out what joints lock: whatever acts along it, nothing
   slips. `free`: G_tt's trace without the joints. Returns the angle. */
static mg_real mg_lock(const mg_context *c, mg_real free, mg_impact_path *b) {
  mg_real *G = b->G;
  const mg_real angle = atan2(2 * G[5], G[4] - G[8]) / 2, x = cos(angle), y = sin(angle);
  const mg_real most = x * x * G[4] + y * y * G[8] + 2 * x * y * G[5], least = G[4] + G[8] - most,
                locked = c->settings->singular * free;
  if (least > locked) return 0;
  const mg_real along = most > locked ? x * b->velocity[1] + y * b->velocity[2] : 0,
                normal = most > locked ? x * G[1] + y * G[2] : 0;
  const mg_real mu = sqrt(b->mu[0] * b->mu[0] * x * x + b->mu[1] * b->mu[1] * y * y);
  G[1] = G[3] = normal, G[2] = G[6] = G[5] = G[7] = 0, G[4] = G[8] = most > locked ? most : free;
  b->velocity[1] = along, b->velocity[2] = 0, b->mu[0] = b->mu[1] = mu;
  return angle;
}

/* What befalls a contact that was struck with the rate `before`. */
static void mg_tell_blow(mg_context *c, mg_events *events, int contact, mg_real before, mg_real over) {
  const mg_real rest = c->settings->rest_speed * c->system->length / c->system->time;
  if (c->d_dot[contact] > rest) {
    mg_apply_transition(c, events, contact, MG_IMPACT_REBOUND, c->run->t, -before);
  } else if (c->events.triggered[contact] || !c->run->closed[contact]) {
    mg_apply_transition(c, events, contact, MG_TOUCHES_DOWN, over, -before);
    c->events.triggered[contact] = 0;
  }
}

/* Strikes one contact. Returns 0 where its law has no end. */
static int mg_frictional_impact(mg_context *c, mg_events *events, int contact) {
  const mg_real before = c->d_dot[contact], e = mg_restitution_of(c, contact);
  mg_impact_path b;
  int own;
  const int n = mg_list_blow(c, contact, &own, &b);
  const mg_real over = c->run->t + (e > 0 ? 0 : mg_remaining_bounce_time(c, contact));
  const mg_real free = own > 1 ? c->lcp.A[1 + (long)n] + c->lcp.A[2 + 2 * (long)n] : 0;
  mg_reduce_blow(c, n, own, &b);
  for (int k = 0; k < 3; k++) b.velocity[k] = k < own ? c->d_dot[c->lcp.rows[k]] : 0;
  const mg_real angle = own > 1 && n > own ? mg_lock(c, free, &b) : 0;
  if (!mg_integrate_impulse(&b, c->system->impact_law[contact], e)) return 0;
  mg_rotate_pair(cos(angle), -sin(angle), b.velocity + 3, b.velocity + 4);
  for (int k = 0; k < own; k++) c->lcp.z[k] = k ? b.velocity[2 + k] : b.impulse;
  if (n > own) mg_answer(c, n, own);
  if (own > 1) c->friction.cone_contact[0] = contact, c->friction.cone_rows[0] = own, mg_note_energy_gain(c, own);
  mg_apply_impulses(c, n);
  mg_update_poses(c, c->run->t, c->run->x);
  mg_gap_rates(c);
  mg_tell_blow(c, events, contact, before, over);
  return 1;
}

/* Contacts part that blows elsewhere have pushed off; those that had only just met, without a word. */
static void mg_part_after_blows(mg_context *c, mg_events *events) {
  const mg_real rest = c->settings->rest_speed * c->system->length / c->system->time;
  for (int i = 0; i < c->support_begin; i++) {
    if (!c->run->closed[i] || !(c->d_dot[i] > rest)) continue;
    mg_apply_transition(c, events, i, c->events.triggered[i] ? MG_IMPACT_AVOIDED : MG_PUSHED_OPEN, c->run->t, 0);
    c->events.triggered[i] = 0;
  }
}

/* Leaves approaches that are too slow to rebound. Returns 0 where a blow has no end. */
MG_INTERNAL int mg_sequential_impact(mg_context *c, mg_events *events) {
  for (int turn = 0; turn < MG_BLOWS; turn++) {
    const int contact = mg_fastest(c);
    if (contact < 0) {
      mg_part_after_blows(c, events);
      return 1;
    }
    if (!mg_frictional_impact(c, events, contact)) return 0;
  }
  return 1;
}
