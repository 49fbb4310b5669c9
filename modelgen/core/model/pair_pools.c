/* Pools of slots, which pairs of equal shapes of equal bodies take while they are near: what entries, rows and memory a
   scene needs follows from the pairs that are near, not from all pairs. Says which pair a slot stands for and gives
   slots to pairs that come near. Writes slot_balls of the run. */
#include "model/model.h"
#include "base/base.h"

/* First slot of the pools; that after the last is the first pair of limits. */
static int mg_first_slot(const mg_system *s) { return s->pool_slot[0]; }

MG_INTERNAL int mg_slot_count(const mg_system *s) { return s->n_pool ? s->pool_slot[s->n_pool] - mg_first_slot(s) : 0; }

MG_INTERNAL int mg_is_slot(const mg_system *s, int pair) {
  return s->n_pool && pair >= mg_first_slot(s) && pair < s->pool_slot[s->n_pool];
}

/* The pool of a slot. */
static int mg_pool_of_slot(const mg_system *s, int slot) {
  int low = 0, high = s->n_pool - 1;
  MG_REQUIRE(mg_is_slot(s, slot));
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (s->pool_slot[middle + 1] <= slot) low = middle + 1;
    else high = middle;
  }
  return low;
}

/* Number of the ball of a side of a pair, or -1. */
static int mg_ball_in_pair(const mg_system *s, const mg_run *run, int pair, int side) {
  if (!mg_is_slot(s, pair)) return s->pair_balls[2 * pair + side];
  const int held = run->slot_balls[2 * (pair - mg_first_slot(s)) + side];
  return held ? held - 1 : s->pair_balls[2 * pair + side];
}

MG_INTERNAL int mg_ball_of_pair(const mg_context *c, int pair, int side) {
  MG_REQUIRE(pair >= 0 && pair < c->system->n_pair && (side == 0 || side == 1));
  return mg_ball_in_pair(c->system, c->run, pair, side);
}

MG_INTERNAL int mg_body_in_pair(const mg_context *c, int pair, int named) {
  const mg_system *s = c->system;
  if (!mg_is_slot(s, pair)) return named;
  return s->ball_body[mg_ball_in_pair(s, c->run, pair, s->ball_body[s->pair_balls[2 * pair]] != named)];
}

MG_INTERNAL int mg_solid_of_pair(const mg_context *c, int pair, int side) {
  const int ball = mg_ball_of_pair(c, pair, side);
  return ball < 0 ? MG_NO_MATERIAL : c->system->ball_solid[ball];
}

MG_INTERNAL int mg_told_pair(const mg_system *s, const mg_run *run, int pair) {
  if (!mg_is_slot(s, pair)) return pair;
  const int pool = mg_pool_of_slot(s, pair);
  const int o = s->ball_rank[mg_ball_in_pair(s, run, pair, 0)], f = s->ball_rank[mg_ball_in_pair(s, run, pair, 1)];
  return s->pool_told_pair[pool] + o * s->pool_width[pool] + f;
}

MG_API int mg_told_contact(const mg_system *s, const mg_run *run, int contact) {
  if (contact < 0 || contact >= s->n_contact || !mg_is_slot(s, s->contact_pair[contact])) return contact;
  const int slot = s->contact_pair[contact], pair = mg_told_pair(s, run, slot), first = s->pair_contact[slot];
  const int within = contact < s->pair_contact[slot + 1] ? contact - first : s->slot_contact_max;
  return s->n_contact + (pair - s->n_pair) * (s->slot_contact_max + 1) + within;
}

MG_INTERNAL void mg_empty_slots(mg_context *c) {
  const mg_system *s = c->system;
  for (int k = 0; k < mg_slot_count(s); k++)
    c->run->slot_balls[2 * k] = c->run->slot_balls[2 * k + 1] = 0, c->run->is_far[mg_first_slot(s) + k] = 1;
}

MG_INTERNAL void mg_open_slots(mg_context *c) {
  const mg_system *s = c->system;
  mg_slot_listing *l = &c->listed.slots;
  l->exceeded = -1;
  for (int b = 0; b < s->n_ball && s->n_pool; b++) l->of_ball[b] = -1;
  for (int pool = 0; pool < s->n_pool; pool++) l->next_free[pool] = s->pool_slot[pool];
  for (int k = mg_slot_count(s) - 1; k >= 0; k--) {
    if (c->run->is_far[mg_first_slot(s) + k]) continue;
    int *head = l->of_ball + c->run->slot_balls[2 * k] - 1;
    l->next[k] = *head, *head = k;
  }
}

/* The slot of a pair of balls, or -1. */
static int mg_slot_of_balls(const mg_context *c, int o, int f) {
  const mg_slot_listing *l = &c->listed.slots;
  for (int k = l->of_ball[o]; k >= 0; k = l->next[k])
    if (c->run->slot_balls[2 * k + 1] == f + 1) return mg_first_slot(c->system) + k;
  return -1;
}

/* Takes the next free slot of a pool; -1 if there is none. */
static int mg_take_slot(mg_context *c, int pool) {
  const mg_system *s = c->system;
  int *next = c->listed.slots.next_free + pool;
  while (*next < s->pool_slot[pool + 1] && !c->run->is_far[*next]) ++*next;
  if (*next < s->pool_slot[pool + 1]) return (*next)++;
  if (c->listed.slots.exceeded < 0) c->listed.slots.exceeded = pool;
  return -1;
}

MG_INTERNAL int mg_slot_for_balls(mg_context *c, int small, int large) {
  const mg_system *s = c->system;
  MG_REQUIRE(small < large);
  if (!s->n_pool || s->ball_class[small] < 0 || s->ball_class[large] < 0) return -1;
  if (s->ball_body[small] == s->ball_body[large]) return -1;
  const int pool = s->class_pool[s->ball_class[small] * s->n_ball_class + s->ball_class[large]];
  if (pool < 0) return -1;
  const int is_turned = s->ball_class[s->pair_balls[2 * s->pool_pattern[pool]]] != s->ball_class[small];
  const int o = is_turned ? large : small, f = is_turned ? small : large, held = mg_slot_of_balls(c, o, f);
  if (held >= 0) return held;
  const int slot = mg_take_slot(c, pool);
  if (slot < 0) return -1;
  int *balls = c->run->slot_balls + 2 * (slot - mg_first_slot(s));
  balls[0] = o + 1, balls[1] = f + 1;
  for (int i = s->pair_contact[slot]; i < s->pair_contact[slot + 1]; i++)
    c->run->after_t[i] = -1, c->run->reference_force[i] = 0, c->step.pressing_on[i] = -1;
  c->run->unfollowed_gap[slot] = MG_MAX, c->run->withheld_effort[slot] = 0;
  return slot;
}
