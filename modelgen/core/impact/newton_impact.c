/* Impacts: Newton's restitution at every closed contact at once, frictionless, as a complementarity problem of
   velocities: 0 <= P, 0 <= d_dot_after + e d_dot_before, complementary. */
#include "impact/impact.h"
#include "solve/lcp/solvers.h"
#include "model/model.h"
#include "forces/forces.h"
#include "patch/patch.h"

MG_INTERNAL int mg_is_bouncing_approach(const mg_context *c, int contact) {
  return c->d_dot[contact] < -c->settings->rest_speed * c->system->length / c->system->time;
}

/* Newton's law for an approach that bounces. A rebound too slow to leave is none at all. Nor is that of an approach
   which only just counts: an open gap that begins to be pressed closes as soon as it does, and at restitution 1 would
   for ever. */
MG_INTERNAL mg_real mg_restitution_of(const mg_context *c, int contact) {
  const mg_real e = c->system->restitution[contact], approach = -c->d_dot[contact];
  const mg_real least = c->settings->rest_speed * c->system->length / c->system->time;
  return e * approach > least && 4 * approach > 5 * least && !mg_has_unfolded(c, contact) ? e : 0;
}

static int mg_list_closed(mg_context *c) {
  int n = 0;
  for (int i = 0; i < c->support_begin; i++)
    if (c->run->closed[i] && !c->patches.is_covered[i]) c->lcp.rows[n++] = i;
  return mg_append_edge_supports(c, c->lcp.rows, n);
}

/* Adds the impulses to u, and their work on the bodies that they move to the ledger. */
MG_INTERNAL void mg_apply_impulses(mg_context *c, int n) {
  const mg_system *s = c->system;
  for (int i = 0; i < 6 * s->n_body; i++) c->wrench[i] = 0;
  for (int r = 0; r < n; r++) mg_add_row_response(c, c->lcp.rows[r], c->lcp.z[r], c->wrench);
  for (int r = 0; r < n; r++) {
    const int i = c->lcp.rows[r];
    const mg_real before = c->d_dot[i], after = before + mg_row_times(c, i, c->wrench);
    c->run->x[c->work_state] += c->lcp.z[r] * ((before + after) / 2 - mg_prescribed_gap_rate(c, i));
  }
  for (int b = 0; b < s->n_body; b++)
    for (int k = 0; k < c->kernels->body_kinds[mg_kind_of(c, b)].n_u; k++)
      c->run->x[s->n_q + s->body_u[b] + k] += c->wrench[6 * b + k];
  for (int i = 0; i < 6 * s->n_body; i++) c->wrench[i] = 0;
}

/* A contact caught at a small approach speed would have bounced on in ever shorter flights; they sum to this time.
   Where hardly anything presses it, it does not bounce. */
MG_INTERNAL mg_real mg_remaining_bounce_time(mg_context *c, int contact) {
  const mg_real e = c->system->restitution[contact], pull = -mg_gap_acceleration(c, contact),
                most = c->settings->look * c->system->time;
  const mg_real flights = -2 * e * c->d_dot[contact];
  return e < 1 && flights > 0 && pull > mg_rest_acceleration(c) && flights < most * pull * (1 - e)
             ? flights / (pull * (1 - e))
             : 0;
}

/* Opens the contacts that rebound, and reports every contact that was struck. */
static void mg_after_impact(mg_context *c, mg_events *events) {
  const mg_real rest = c->settings->rest_speed * c->system->length / c->system->time;
  for (int i = 0; i < c->support_begin; i++) {
    const int bounces = c->run->closed[i] && mg_row_times(c, i, c->twist) > rest;
    if (bounces && mg_is_bouncing_approach(c, i))
      mg_apply_transition(c, events, i, MG_IMPACT_REBOUND, c->run->t, -c->d_dot[i]);
    else if (bounces) mg_apply_transition(c, events, i, MG_PUSHED_OPEN, c->run->t, 0);
  }
}

/* The pads of a face that comes down flat rebound together. */
MG_INTERNAL void mg_set_support_rebound(mg_context *c) {
  for (int i = c->support_begin; i < c->joint_row_end; i++) c->row_rate[i] = c->d_dot[i];
  for (int slot = 0; slot < c->system->n_slot; slot++) {
    const int pad = mg_slot_support(c, slot);
    mg_real e = 0;
    for (int k = 0; k < 3 && c->patches.trial[slot] == 1; k++)
      e = mg_restitution_of(c, pad + k) > e ? mg_restitution_of(c, pad + k) : e;
    for (int k = 0; k < 3; k++) c->row_rate[pad + k] *= 1 + e;
  }
}

/* The impulses on closed contacts that are not hidden, and on pads and joints, into c->lcp.z in the order of
   c->lcp.rows, and of each contact into c->impulse. Returns how many of the list can only push, -1 without a solution.
 */
static int mg_find_impulses(mg_context *c) {
  if (c->system->n_grip) return mg_find_impulses_with_friction(c);
  const int n = mg_list_closed(c);
  mg_lcp_report report;
  mg_set_support_rebound(c);
  for (int r = 0; r < n; r++) {
    const int i = c->lcp.rows[r];
    c->row_rate[i] = c->d_dot[i] * (1 + mg_restitution_of(c, i)), c->lcp.mask[r] = 1;
  }
  if (mg_solve_complementarity(c, n, c->row_rate, &report) != MG_LCP_SOLVED) return -1;
  for (int i = c->support_begin; i < c->system->n_contact; i++) c->impulse[i] = 0;
  const int size = mg_append_bilateral_rows(c, c->lcp.rows, n);
  for (int r = 0; r < size; r++)
    if (mg_is_support_point(c, c->lcp.rows[r])) c->impulse[c->lcp.rows[r]] = c->lcp.z[r];
  return n;
}

/* A closed contact approaches, or a held patch is torn. */
static int mg_is_struck(const mg_context *c) {
  const mg_real drift = c->settings->drift * c->system->length / c->system->time;
  for (int i = 0; i < c->support_begin; i++)
    if (c->run->closed[i] && mg_is_approaching_beyond_drift(c, i)) return 1;
  for (int i = c->support_begin; i < c->system->n_contact; i++)
    if (c->run->closed[i] && fabs(c->d_dot[i]) > drift) return 1;
  return 0;
}

/* Notes a contact at rest, of one that restores, that a blow elsewhere has pressed: at once with it, or after it, the
   bodies part otherwise. The first n of c->lcp.rows are rows of contacts. */
static void mg_note_chain(mg_context *c, int n) {
  int chain = -1, struck = 0;
  for (int r = 0; r < n; r++) {
    const int i = c->lcp.rows[r];
    if (i >= c->support_begin || !(c->lcp.z[r] > 0) || !(c->system->restitution[i] > 0)) continue;
    if (mg_is_bouncing_approach(c, i)) struck = 1;
    else chain = i;
  }
  if (struck && chain >= 0 && c->run->chain_contact < 0) c->run->chain_contact = chain, c->run->chain_t = c->run->t;
}

/* Faces that come down flat are struck as one, if the impulse presses them together within their hull; else, and where
   an impulse tears a patch off, what they cover is struck singly. Needs the rows at run->x. */
MG_INTERNAL int mg_impact(mg_context *c, mg_events *events) {
  const mg_real floor = c->settings->rest_speed * c->system->mass * c->system->length / c->system->time;
  int n;
  for (int i = 0; i < c->system->n_contact; i++) c->patches.is_covered[i] = 0;
  if (mg_replace_by_points(c)) mg_update_rows_and_forces(c);
  if (mg_is_sequential_impact(c) && !mg_sequential_impact(c, events)) return MG_COMPLEMENTARITY;
  if (mg_hold_flat_patches(c, c->settings->start_gap * c->system->length, 1)) mg_update_rows_and_forces(c);
  if (!mg_is_struck(c)) {
    mg_release_trials(c);
    return MG_DONE;
  }
  do {
    mg_mark_covered(c);
    n = mg_find_impulses(c);
    if (n < 0) return MG_COMPLEMENTARITY;
  } while (mg_reject_trials(c, c->impulse, floor, 1) || mg_end_pulled_patches(c, c->impulse, floor) ||
           mg_exchange_edge_supports(c, n));
  mg_note_chain(c, n);
  if (c->system->n_grip) mg_note_energy_gain(c, n);
  mg_apply_impulses(c, mg_append_bilateral_rows(c, c->lcp.rows, n));
  mg_update_poses(c, c->run->t, c->run->x);
  if (c->system->n_grip) mg_clear_slip(c);
  mg_settle_edge_supports(c, events);
  mg_after_impact(c, events);
  mg_release_trials(c);
  return MG_DONE;
}
