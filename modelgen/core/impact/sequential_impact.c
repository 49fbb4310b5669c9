/* Blows in turn: of the contacts that approach, the fastest is struck, alone, until none does any more. */
#include "impact/impact.h"
#include "solve/lcp/solvers.h"
#include "model/model.h"

enum { MG_BLOWS = 1000 };

/* Whether contacts are struck one after another: where that is asked for, or one follows a law for a single contact. */
MG_INTERNAL int mg_takes_turns(const mg_context *c) {
  int singly = c->set->sequential;
  for (int i = 0; i < c->first_pad; i++) singly |= c->run->closed[i] && c->sys->impact_law[i] != MG_NEWTON;
  return singly;
}

static int mg_fastest(const mg_context *c) {
  const mg_real touching = c->set->gap * c->sys->length;
  int fastest = -1;
  for (int i = 0; i < c->first_pad; i++) {
    if (!mg_present(c, i) || !(c->run->closed[i] || fabs(c->d[i]) <= touching) || !mg_approaching(c, i)) continue;
    if (fastest < 0 || c->d_dot[i] < c->d_dot[fastest]) fastest = i;
  }
  return fastest;
}

/* The rows of the contact that slip, then those of the joints, assembled; returns how many, of the contact in *own. */
static int mg_list_blow(mg_context *c, int contact, int *own, mg_blow *b) {
  int n = 0;
  c->list[n++] = contact, b->mu[0] = b->mu[1] = 0;
  for (int g = c->sys->contact_grip[contact]; g < c->sys->contact_grip[contact + 1] && c->sys->n_grip; g++) {
    if (c->sys->grip_aspect[g] != MG_SLIP) continue;
    for (int k = 0; k < 2; k++) c->list[n++] = mg_grip_row(c, contact, g) + k, b->mu[k] = c->sys->grip_kinetic[2 * g + k];
  }
  *own = n;
  n = mg_list_joints(c, c->list, n);
  mg_assemble(c, c->list, n);
  return n;
}

/* What the joints answer to the impulses in c->z of the first `own` rows, into c->z of theirs. */
static void mg_answer(mg_context *c, int n, int own) {
  for (int r = 0; r < n; r++) {
    c->b[r] = 0, c->mask[r] = r >= own;
    for (int j = 0; j < own; j++) c->b[r] += c->A[r + (long)n * j] * c->z[j];
  }
  mg_real *answer = c->rate;
  mg_active_above(n, c->A, c->b, c->mask, c->set->singular, answer, c->lcp, c->lcp_i);
  for (int r = own; r < n; r++) c->z[r] = answer[r];
}

/* G with the joints held. */
static void mg_reduce_blow(mg_context *c, int n, int own, mg_blow *b) {
  for (int k = 0; k < 9; k++) b->G[k] = k % 4 == 0;
  for (int j = 0; j < own; j++) {
    for (int r = 0; r < own; r++) c->z[r] = r == j;
    if (n > own) mg_answer(c, n, own);
    for (int r = 0; r < own; r++) {
      b->G[3 * r + j] = c->A[r + (long)n * j];
      for (int k = own; k < n; k++) b->G[3 * r + j] += c->A[r + (long)n * k] * c->z[k];
    }
  }
}

/* Turns t1, t2 to where the blow yields most and least, and takes out what joints lock: whatever acts along it, nothing slips.
   `free`: G_tt's trace without the joints. Returns the angle. */
static mg_real mg_lock(const mg_context *c, mg_real free, mg_blow *b) {
  mg_real *G = b->G;
  const mg_real angle = atan2(2 * G[5], G[4] - G[8]) / 2, x = cos(angle), y = sin(angle);
  const mg_real most = x * x * G[4] + y * y * G[8] + 2 * x * y * G[5], least = G[4] + G[8] - most, locked = c->set->singular * free;
  if (least > locked) return 0;
  const mg_real along = most > locked ? x * b->u[1] + y * b->u[2] : 0, normal = most > locked ? x * G[1] + y * G[2] : 0;
  const mg_real mu = sqrt(b->mu[0] * b->mu[0] * x * x + b->mu[1] * b->mu[1] * y * y);
  G[1] = G[3] = normal, G[2] = G[6] = G[5] = G[7] = 0, G[4] = G[8] = most > locked ? most : free;
  b->u[1] = along, b->u[2] = 0, b->mu[0] = b->mu[1] = mu;
  return angle;
}

/* What befalls a contact that was struck with the rate `before`. */
static void mg_tell_blow(mg_context *c, mg_events *events, int contact, mg_real before, mg_real over) {
  const mg_real rest = c->set->rest_speed * c->sys->length / c->sys->time;
  if (c->d_dot[contact] > rest) {
    mg_befalls(c, events, contact, MG_REBOUNDS, c->run->t, -before);
  } else if (c->fired[contact] || !c->run->closed[contact]) {
    mg_befalls(c, events, contact, MG_IS_CAUGHT, over, -before);
    c->fired[contact] = 0;
  }
}

/* Strikes one contact. Returns 0 where its law has no end. */
static int mg_strike(mg_context *c, mg_events *events, int contact) {
  const mg_real before = c->d_dot[contact], e = mg_rebound(c, contact);
  mg_blow b;
  int own;
  const int n = mg_list_blow(c, contact, &own, &b);
  const mg_real over = c->run->t + (e > 0 ? 0 : mg_bounces_left(c, contact));
  const mg_real free = own > 1 ? c->A[1 + (long)n] + c->A[2 + 2 * (long)n] : 0;
  mg_reduce_blow(c, n, own, &b);
  for (int k = 0; k < 3; k++) b.u[k] = k < own ? c->d_dot[c->list[k]] : 0;
  const mg_real angle = own > 1 && n > own ? mg_lock(c, free, &b) : 0;
  if (!mg_blow_by(&b, c->sys->impact_law[contact], e)) return 0;
  mg_turn_pair(cos(angle), -sin(angle), b.u + 3, b.u + 4);
  for (int k = 0; k < own; k++) c->z[k] = k ? b.u[2 + k] : b.p;
  if (n > own) mg_answer(c, n, own);
  if (own > 1) c->cone_contact[0] = contact, c->cone_rows[0] = own, mg_note_gain(c, own);
  mg_apply_impulses(c, n);
  mg_poses(c, c->run->t, c->run->x);
  mg_gap_rates(c);
  mg_tell_blow(c, events, contact, before, over);
  return 1;
}

/* Contacts part that blows elsewhere have pushed off; those that had only just met, without a word. */
static void mg_part_after_blows(mg_context *c, mg_events *events) {
  const mg_real rest = c->set->rest_speed * c->sys->length / c->sys->time;
  for (int i = 0; i < c->first_pad; i++) {
    if (!c->run->closed[i] || !(c->d_dot[i] > rest)) continue;
    mg_befalls(c, events, i, c->fired[i] ? MG_MISSES : MG_IS_PUSHED_OFF, c->run->t, 0);
    c->fired[i] = 0;
  }
}

/* Leaves approaches that are too slow to rebound. Returns 0 where a blow has no end. */
MG_INTERNAL int mg_strike_in_turn(mg_context *c, mg_events *events) {
  for (int turn = 0; turn < MG_BLOWS; turn++) {
    const int contact = mg_fastest(c);
    if (contact < 0) {
      mg_part_after_blows(c, events);
      return 1;
    }
    if (!mg_strike(c, events, contact)) return 0;
  }
  return 1;
}
