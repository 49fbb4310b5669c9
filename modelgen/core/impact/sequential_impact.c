/* Sequential impacts: of the contacts that approach, the fastest has an impact alone, until none approaches fast
   enough. Restitution follows Newton, Poisson or Stronge. Writes the velocities of the run's state, the closed set and
   events. */
#include "impact/impact.h"
#include "solve/lcp/lcp_solvers.h"
#include "model/model.h"

enum { MG_SINGLE_IMPACTS_MAX = 1000 }; /* most impacts at one time */

MG_INTERNAL int mg_is_impact_sequential(const mg_context *c) {
  int singly = c->settings->sequential;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    singly |= c->run->closed[i] && c->system->impact_law[i] != MG_NEWTON;
  return singly;
}

/* Closed or touching contact that approaches fastest, or -1. */
static int mg_fastest_approaching_contact(const mg_context *c) {
  const mg_real touching = c->settings->contact_gap * c->system->length;
  int fastest = -1;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    if (!mg_is_on_feature_pair(c, i) || !(c->run->closed[i] || fabs(c->rows.d[i]) <= touching) ||
        !mg_is_approaching(c, i))
      continue;
    if (fastest < 0 || c->rows.d_dot[i] < c->rows.d_dot[fastest]) fastest = i;
  }
  return fastest;
}

/* List and assemble the slip rows of the struck contact and the joint rows; returns their number. */
static int mg_assemble_single_impact(mg_context *c, int contact, int *contact_rows, mg_impact_path *b) {
  int n = 0;
  c->lcp.rows[n++] = contact, b->mu[0] = b->mu[1] = 0;
  for (int g = c->system->contact_friction[contact];
       g < c->system->contact_friction[contact + 1] && c->system->n_friction; g++) {
    if (c->system->friction_kind[g] != MG_FRICTION_SLIP) continue;
    for (int k = 0; k < 2; k++)
      c->lcp.rows[n++] = mg_first_friction_row(c, contact, g) + k, b->mu[k] = c->system->friction_kinetic[2 * g + k];
  }
  *contact_rows = n;
  n = mg_append_joint_rows(c, c->lcp.rows, n);
  mg_assemble_delassus(c, c->lcp.rows, n);
  return n;
}

/* Solve the joint impulses that balance the given impulses of the contact. */
static void mg_solve_joint_reactions(mg_context *c, int n, int contact_rows) {
  for (int r = 0; r < n; r++) {
    c->lcp.b[r] = 0, c->lcp.mask[r] = r >= contact_rows;
    for (int j = 0; j < contact_rows; j++) c->lcp.b[r] += c->lcp.A[r + (long)n * j] * c->lcp.z[j];
  }
  mg_real *reactions = c->rows.row_rate;
  mg_real pivot;
  mg_active_above(n, c->lcp.A, c->lcp.b, c->lcp.mask, c->settings->joint_rank_tolerance, reactions, c->lcp.work,
                  c->lcp.iwork, &pivot);
  for (int r = contact_rows; r < n; r++) c->lcp.z[r] = reactions[r];
}

/* Compute G = J M^-1 J^T of the struck contact with the joints held. */
static void mg_reduce_impact_matrix(mg_context *c, int n, int contact_rows, mg_impact_path *b) {
  for (int k = 0; k < 9; k++) b->G[k] = k % 4 == 0;
  for (int j = 0; j < contact_rows; j++) {
    for (int r = 0; r < contact_rows; r++) c->lcp.z[r] = r == j;
    if (n > contact_rows) mg_solve_joint_reactions(c, n, contact_rows);
    for (int r = 0; r < contact_rows; r++) {
      b->G[3 * r + j] = c->lcp.A[r + (long)n * j];
      for (int k = contact_rows; k < n; k++) b->G[3 * r + j] += c->lcp.A[r + (long)n * k] * c->lcp.z[k];
    }
  }
}

/* Rotate t1, t2 to the principal axes of the tangential compliance and remove directions that the joints lock;
   returns the angle. */
static mg_real mg_remove_locked_tangent(const mg_context *c, mg_real free_trace, mg_impact_path *b) {
  mg_real *G = b->G;
  const mg_real angle = mg_atan2(2 * G[5], G[4] - G[8]) / 2, x = mg_cos(angle), y = mg_sin(angle);
  const mg_real largest = x * x * G[4] + y * y * G[8] + 2 * x * y * G[5], smallest = G[4] + G[8] - largest,
                lock_limit = c->settings->joint_rank_tolerance * free_trace;
  if (smallest > lock_limit) return 0;
  const mg_real along = largest > lock_limit ? x * b->velocity[1] + y * b->velocity[2] : 0,
                normal = largest > lock_limit ? x * G[1] + y * G[2] : 0;
  const mg_real mu = sqrt(b->mu[0] * b->mu[0] * x * x + b->mu[1] * b->mu[1] * y * y);
  G[1] = G[3] = normal, G[2] = G[6] = G[5] = G[7] = 0, G[4] = G[8] = largest > lock_limit ? largest : free_trace;
  b->velocity[1] = along, b->velocity[2] = 0, b->mu[0] = b->mu[1] = mu;
  return angle;
}

/* Apply and report the transition of a contact that was struck with the velocity `before`. */
static void mg_report_single_impact(mg_context *c, mg_events *events, int contact, mg_real before,
                                    mg_real closing_time) {
  const mg_real rest = c->settings->rest_speed * c->system->length / c->system->time;
  if (c->rows.d_dot[contact] > rest) {
    mg_apply_contact_transition(c, events, contact, MG_IMPACT_REBOUND, c->run->t, -before);
  } else if (c->events.triggered[contact] || !c->run->closed[contact]) {
    mg_apply_contact_transition(c, events, contact, MG_TOUCHES_DOWN, closing_time, -before);
    c->events.triggered[contact] = 0;
  }
}

/* Resolve the impact of one contact; returns 0 where its law has no end. */
static int mg_resolve_single_impact(mg_context *c, mg_events *events, int contact) {
  const mg_real before = c->rows.d_dot[contact], e = mg_effective_restitution(c, contact);
  mg_impact_path b;
  int contact_rows;
  const int n = mg_assemble_single_impact(c, contact, &contact_rows, &b);
  const mg_real closing_time = c->run->t + (e > 0 ? 0 : mg_remaining_bounce_time(c, contact));
  const mg_real free_trace = contact_rows > 1 ? c->lcp.A[1 + (long)n] + c->lcp.A[2 + 2 * (long)n] : 0;
  mg_reduce_impact_matrix(c, n, contact_rows, &b);
  for (int k = 0; k < 3; k++) b.velocity[k] = k < contact_rows ? c->rows.d_dot[c->lcp.rows[k]] : 0;
  const mg_real angle = contact_rows > 1 && n > contact_rows ? mg_remove_locked_tangent(c, free_trace, &b) : 0;
  if (!mg_integrate_impact_path(&b, c->system->impact_law[contact], e)) return 0;
  mg_rotate_pair(mg_cos(angle), -mg_sin(angle), b.velocity + 3, b.velocity + 4);
  for (int k = 0; k < contact_rows; k++) c->lcp.z[k] = k ? b.velocity[2 + k] : b.impulse;
  if (n > contact_rows) mg_solve_joint_reactions(c, n, contact_rows);
  MG_NOTE_DIGEST(c, MG_VALID_IMPULSES, mg_impulse_digest(c, contact_rows));
  if (contact_rows > 1)
    c->friction.cone_contact[0] = contact, c->friction.cone_rows[0] = contact_rows,
    mg_note_impact_energy_gain(c, contact_rows);
  mg_apply_impulses(c, n);
  mg_update_poses(c, c->run->t, c->run->x);
  mg_update_gap_rates(c);
  mg_report_single_impact(c, events, contact, before, closing_time);
  return 1;
}

/* Open the contacts that impacts elsewhere have pushed apart; those that had just closed are not reported. */
static void mg_open_pushed_contacts(mg_context *c, mg_events *events) {
  const mg_real rest = c->settings->rest_speed * c->system->length / c->system->time;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    if (!c->run->closed[i] || !(c->rows.d_dot[i] > rest)) continue;
    mg_apply_contact_transition(c, events, i, c->events.triggered[i] ? MG_IMPACT_AVOIDED : MG_PUSHED_OPEN, c->run->t,
                                0);
    c->events.triggered[i] = 0;
  }
}

MG_INTERNAL int mg_resolve_impacts_in_sequence(mg_context *c, mg_events *events) {
  for (int turn = 0; turn < MG_SINGLE_IMPACTS_MAX; turn++) {
    const int contact = mg_fastest_approaching_contact(c);
    if (contact < 0) {
      mg_open_pushed_contacts(c, events);
      return 1;
    }
    if (!mg_resolve_single_impact(c, events, contact)) return 0;
  }
  return 1;
}
