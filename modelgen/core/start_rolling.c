/* The first step of a contact that starts from flat: a face leaves a plane, and its body goes on on one point of its rim.

   While the rim is flat no point of it is lowest. At the time tau after, the body leans by A tau^3 or so towards its
   azimuth, and a lean across that azimuth turns the contact point by 1/(A tau^3) times as much: the equations are
   irregular singular at tau = 0. Of all their solutions one is smooth there, with the azimuth's limit given by where the
   pressure left the face; the others swing about it with an unbounded speed. Collocation at Radau's points keeps to the
   smooth one. Its unknowns are taken to be the states and the azimuths at the stages: given the azimuths, the right-hand
   side is evaluated on bodies turned to lean that way, which is as smooth as any and converges by substitution; and
   that the bodies do lean that way is one well-conditioned linear system a contact, h^2 A^2 k - tilt, of seven rows.

   How to start a contact so: at the time it starts, with all bodies flat on each other and at rest in that respect, put
   the contact on its link with eta (if it has any) at the point where the pressure leaves, mark it closed, active and
   MG_FRESH in run->fresh, and write into run->outward (world, unit) the way out of the hull there, along the plane. The
   next step is this one; then the contact is MG_YOUNG, excused from the bound on margins until its margin is above it. */
#include "core.h"

/* How far a guess is trusted: neither how much the bodies lean, nor how fast across their azimuth; not the latter; both */
enum { MG_WAY_KNOWN, MG_LEAN_KNOWN, MG_RATE_KNOWN };

static int mg_starts_rolling(const mg_context *c) {
  for (int i = 0; i < c->sys->n_contact; i++)
    if (c->run->fresh[i] == MG_FRESH) return 1;
  return 0;
}

/* The conditions of its link hold, and its margin is large enough. */
static int mg_is_grown_up(mg_context *c, int contact) {
  const mg_real *eta = mg_eta_of(c, c->run->x, contact);
  int which;
  mg_place(c, contact, eta, c->place + 32);
  return c->run->margin[contact] >= c->set->margin_refuse &&
         mg_worst_condition(c, c->run->link[contact], eta, &which) >= 0;
}

/* After a step, with the poses at its end. */
static void mg_grow_up(mg_context *c) {
  for (int i = 0; i < c->sys->n_contact; i++) {
    if (!c->run->fresh[i]) continue;
    c->run->fresh[i] = mg_is_grown_up(c, i) ? MG_STEADY : MG_YOUNG;
  }
}

/* A closed contact too near to where its extremum is lost, unless it has just come from there. */
static int mg_is_singular(const mg_context *c, int contact) {
  return c->run->closed[contact] && !c->run->fresh[contact] && !(c->run->margin[contact] >= c->set->margin_refuse);
}

static int mg_is_free(const mg_context *c, int body) { return mg_body_kinds[mg_kind_of(c, body)].motion == MG_FREE; }

/* A direction of the world in the axes of a pose. */
static void mg_turn_in(const mg_real *pose, const mg_real *world, mg_real *local) {
  for (int k = 0; k < 3; k++) local[k] = mg_dot3(pose + 3 + 3 * k, world);
}

static void mg_cross(const mg_real *a, const mg_real *b, mg_real *out) {
  out[0] = a[1] * b[2] - a[2] * b[1], out[1] = a[2] * b[0] - a[0] * b[2], out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Notes at the flat start what leans against what. Returns 0 where no body could. */
static int mg_open_onsets(mg_context *c, mg_real t, mg_real *x, mg_real h) {
  mg_poses(c, t, x);
  for (int i = 0; i < c->sys->n_contact; i++) {
    if (c->run->fresh[i] != MG_FRESH) continue;
    if (!mg_is_free(c, c->f[i]) && !mg_is_free(c, c->o[i])) return 0;
    mg_onset *onset = c->onset + i;
    const mg_real *o = c->pose + 12 * c->o[i], *f = c->pose + 12 * c->f[i], *normal = c->place + 5;
    mg_place(c, i, mg_eta_of(c, x, i), c->place + 32);
    mg_turn_in(o, normal, onset->normal), mg_turn_in(f, normal, onset->axis);
    mg_turn_in(o, c->run->outward + 3 * i, onset->outward);
    for (int stage = 0; stage < MG_RADAU; stage++)
      onset->azimuth[stage] = 0, onset->tilt[stage] = sqrt(MG_EPS) * h / c->sys->time;
  }
  return 1;
}

/* At the present poses. */
static mg_lean mg_lean_at(const mg_context *c, int contact, mg_real azimuth) {
  const mg_onset *onset = c->onset + contact;
  const mg_real *o = c->pose + 12 * c->o[contact], *f = c->pose + 12 * c->f[contact];
  mg_lean at;
  mg_real out[3], aside[3], axis[3];
  mg_out(o, onset->normal, 0, at.normal), mg_out(o, onset->outward, 0, out), mg_out(f, onset->axis, 0, axis);
  mg_cross(at.normal, out, aside);
  const mg_real height = mg_dot3(axis, at.normal);
  for (int k = 0; k < 3; k++) {
    at.along[k] = cos(azimuth) * out[k] + sin(azimuth) * aside[k];
    at.across[k] = cos(azimuth) * aside[k] - sin(azimuth) * out[k];
    at.lean[k] = axis[k] - height * at.normal[k];
  }
  return at;
}

/* The angular velocity of f against o about a direction of the world. */
static mg_real mg_turning(const mg_context *c, int contact, const mg_real *direction) {
  mg_real o[3], f[3];
  mg_out(c->pose + 12 * c->o[contact], c->twist + 6 * c->o[contact] + 3, 0, o);
  mg_out(c->pose + 12 * c->f[contact], c->twist + 6 * c->f[contact] + 3, 0, f);
  return mg_dot3(f, direction) - mg_dot3(o, direction);
}

/* Turns the bodies of a contact in x until they lean by `tilt` along the azimuth of `at`. */
static void mg_lean_to(const mg_context *c, int contact, const mg_lean *at, mg_real tilt, mg_real *x) {
  const int turns_f = mg_is_free(c, c->f[contact]), body = turns_f ? c->f[contact] : c->o[contact];
  mg_real change[3], turn[3], angle[3];
  for (int k = 0; k < 3; k++) change[k] = (turns_f ? 1 : -1) * (tilt * at->along[k] - at->lean[k]);
  mg_cross(at->normal, change, turn);
  mg_turn_in(c->pose + 12 * body, turn, angle);
  mg_turn(x + c->sys->body_q[body] + 3, angle);
}

/* Takes the rate at which the bodies of a contact lean across their azimuth out of x. */
static void mg_steady(const mg_context *c, int contact, const mg_lean *at, mg_real *x) {
  const int turns_f = mg_is_free(c, c->f[contact]), body = turns_f ? c->f[contact] : c->o[contact];
  const mg_real rate = mg_turning(c, contact, at->along);
  mg_real angle[3];
  mg_turn_in(c->pose + 12 * body, at->along, angle);
  for (int k = 0; k < 3; k++) x[c->sys->n_q + c->sys->body_u[body] + 3 + k] -= (turns_f ? rate : -rate) * angle[k];
}

/* Brings eta of a contact to the extremum at the present poses, as near as rounding lets it. */
static int mg_settle_fully(mg_context *c, int contact, mg_real *eta) {
  if (!c->n_eta[contact]) return 1;
  if (mg_settle_in(c, contact, eta) < 0) return 0;
  for (int extra = 0; extra < 2; extra++) {
    mg_place(c, contact, eta, c->place + 32);
    for (int k = 0; k < c->n_eta[contact]; k++) eta[k] = c->place[32 + k];
  }
  return mg_finite(eta, c->n_eta[contact]);
}

/* The rates of q in a slope, of the velocities that the stage really has. */
static void mg_follow(mg_context *c, mg_real t, int stage, mg_real *slope) {
  mg_real *x = c->x_stage, *real = c->K + (2 + 2 * MG_RADAU) * c->n_x;
  const int n_q = c->sys->n_q;
  for (int i = n_q; i < n_q + c->sys->n_u; i++) x[i] = mg_stage_state(c, stage)[i];
  mg_poses(c, t, x);
  mg_accelerations(c, t, x, real);
  for (int i = 0; i < n_q; i++) slope[i] = real[i];
}

/* The slope at a stage with its fresh contacts leaning along their azimuths plus `turned`. Returns 0 where one does not
   lean that way. */
static int mg_slope_leaning(mg_context *c, mg_real t, int stage, int known, mg_real turned, mg_real *slope) {
  mg_real *x = c->x_stage;
  for (int i = 0; i < c->n_x; i++) x[i] = mg_stage_state(c, stage)[i];
  mg_poses(c, t, x);
  for (int i = 0; i < c->sys->n_contact; i++) {
    if (c->run->fresh[i] != MG_FRESH) continue;
    mg_onset *onset = c->onset + i;
    const mg_lean at = mg_lean_at(c, i, onset->azimuth[stage] + turned);
    if (!turned && known >= MG_LEAN_KNOWN) onset->tilt[stage] = mg_dot3(at.along, at.lean);
    if (!(onset->tilt[stage] > 0)) return 0;
    mg_lean_to(c, i, &at, onset->tilt[stage], x);
    if (known < MG_RATE_KNOWN) mg_steady(c, i, &at, x);
  }
  mg_poses(c, t, x);
  for (int i = 0; i < c->sys->n_contact; i++)
    if (c->run->fresh[i] == MG_FRESH && !mg_settle_fully(c, i, mg_eta_of(c, x, i))) return 0;
  if (c->set->newton > 1 && !mg_place_all(c, t, x)) return 0;
  mg_slope(c, t, x, slope);
  if (known < MG_RATE_KNOWN) mg_follow(c, t, stage, slope);
  return 1;
}

/* Once round: the slopes at the stages, then the states by them. eta of fresh contacts is settled, not integrated. */
static int mg_sweep(mg_context *c, mg_real t, mg_real *x, mg_real h, int known, mg_real *change) {
  const mg_system *s = c->sys;
  const int first = s->n_q + s->n_u;
  c->suspect = 0;
  for (int stage = 0; stage < MG_RADAU; stage++) {
    if (!mg_slope_leaning(c, t + mg_stage_time(stage) * h, stage, known, 0, mg_stage_slope(c, stage))) return 0;
    mg_watch(c);
    for (int i = first; i < c->work_index; i++) mg_stage_state(c, stage)[i] = c->x_stage[i];
  }
  *change = mg_collect(c, x, h, 0, first);
  for (int i = 0; i < s->n_contact; i++) {
    if (c->run->fresh[i] == MG_FRESH) continue;
    const int from = first + s->contact_eta[i];
    const mg_real more = mg_collect(c, x, h, from, from + c->n_eta[i]);
    if (!(more <= *change)) *change = more;
  }
  mg_collect(c, x, h, c->work_index, c->n_x);
  return *change <= MG_MAX;
}

/* The angular acceleration of f against o about a direction of the world. */
static mg_real mg_spin_up(const mg_context *c, int contact, const mg_real *slope, const mg_real *direction) {
  mg_real sum = 0, turn[3];
  for (int side = 0; side < 2; side++) {
    const int body = side ? c->f[contact] : c->o[contact];
    if (!mg_is_free(c, body)) continue;
    mg_out(c->pose + 12 * body, slope + c->sys->n_q + c->sys->body_u[body] + 3, 0, turn);
    sum += (side ? 1 : -1) * mg_dot3(turn, direction);
  }
  return sum;
}

/* d(acceleration of the lean across its azimuth) / d(azimuth) at the stages, by a difference. */
static int mg_find_stiffness(mg_context *c, mg_real t, mg_real h) {
  const mg_real turned = (mg_real)1 / 1024;
  mg_real *slope = c->K + (1 + 2 * MG_RADAU) * c->n_x;
  for (int stage = 0; stage < MG_RADAU; stage++)
    for (int sign = -1; sign <= 1; sign += 2) {
      if (!mg_slope_leaning(c, t + mg_stage_time(stage) * h, stage, MG_LEAN_KNOWN, sign * turned, slope)) return 0;
      for (int i = 0; i < c->sys->n_contact; i++) {
        if (c->run->fresh[i] != MG_FRESH) continue;
        mg_onset *onset = c->onset + i;
        const mg_lean at = mg_lean_at(c, i, onset->azimuth[stage]);
        const mg_real across = -mg_spin_up(c, i, slope, at.along) / (2 * turned);
        onset->stiffness[stage] = sign < 0 ? -across : onset->stiffness[stage] + across;
      }
    }
  return 1;
}

/* Newton's step for the azimuths of one contact; returns what it changes of the velocities, against their scale. */
static mg_real mg_steer(mg_context *c, mg_real t, mg_real h, int contact) {
  mg_onset *onset = c->onset + contact;
  mg_real matrix[MG_RADAU][MG_RADAU], change[MG_RADAU], most = 0;
  for (int row = 0; row < MG_RADAU; row++) {
    mg_poses(c, t + mg_stage_time(row) * h, mg_stage_state(c, row));
    const mg_lean at = mg_lean_at(c, contact, onset->azimuth[row]);
    change[row] = -mg_dot3(at.across, at.lean);
    for (int k = 0; k < MG_RADAU; k++) matrix[row][k] = h * h * mg_twice(row, k) * onset->stiffness[k];
    matrix[row][row] -= onset->tilt[row];
  }
  if (!mg_eliminate(matrix, change)) return MG_MAX;
  for (int stage = 0; stage < MG_RADAU; stage++) {
    const mg_real effect = fabs(change[stage] * onset->stiffness[stage]) * h * c->sys->time;
    onset->azimuth[stage] += change[stage];
    if (!(effect <= most)) most = effect;
  }
  return most;
}

/* Newton's step for the azimuths, and two substitutions, after which the poses have followed. Returns the largest change
   of the second, and of the velocities by the azimuths; NAN where it fails. */
static mg_real mg_round(mg_context *c, mg_real t, mg_real *x, mg_real h, int known) {
  mg_real most = 0, change = 0;
  for (int i = 0; i < c->sys->n_contact; i++) {
    const mg_real effect = c->run->fresh[i] == MG_FRESH ? mg_steer(c, t, h, i) : 0;
    if (!(effect <= most)) most = effect;
  }
  for (int twice = 0; twice < 2; twice++)
    if (!mg_sweep(c, t, x, h, known, &change)) return (mg_real)NAN;
  return most <= change ? change : most;
}

/* All bodies go on as they move, and lean a little along the way out. */
static int mg_guess_stages(mg_context *c, mg_real t, mg_real *x, mg_real h) {
  const int n_q = c->sys->n_q;
  mg_real change;
  if (!mg_open_onsets(c, t, x, h)) return 0;
  for (int stage = 0; stage < MG_RADAU; stage++)
    for (int i = 0; i < c->n_x; i++)
      mg_stage_state(c, stage)[i] = x[i] + (i < n_q ? mg_stage_time(stage) * h * c->K[i] : 0);
  for (int round = 0; round < 4; round++)
    if (!mg_sweep(c, t, x, h, round < 2 ? MG_WAY_KNOWN : MG_LEAN_KNOWN, &change)) return 0;
  if (!mg_find_stiffness(c, t, h)) return 0;
  for (int round = 0; round < 3; round++)
    if (!(mg_round(c, t, x, h, MG_LEAN_KNOWN) <= MG_MAX)) return 0;
  return 1;
}

/* The stages of a step h. */
static int mg_solve_stages(mg_context *c, mg_real t, mg_real *x, mg_real h) {
  const mg_real goal = c->set->tolerance / 100;
  mg_real before = MG_MAX;
  if (!mg_guess_stages(c, t, x, h)) return 0;
  for (int round = 0; round < 40; round++) {
    const mg_real most = mg_round(c, t, x, h, MG_RATE_KNOWN);
    if (most <= goal) return 1;
    if (round > 5 && !(most < before)) return most <= c->set->tolerance;
    before = most;
  }
  return 0;
}

/* What the explicit method can follow afterwards: the swing about the smooth solution. */
static mg_real mg_pace_after(const mg_context *c) {
  mg_real pace = MG_MAX;
  for (int i = 0; i < c->sys->n_contact; i++) {
    if (c->run->fresh[i] != MG_FRESH) continue;
    const mg_real each = sqrt(c->onset[i].tilt[MG_RADAU - 1] / fabs(c->onset[i].stiffness[MG_RADAU - 1]));
    if (each < pace) pace = each;
  }
  return pace;
}

/* From K[0], of which only the rates of q count, to c->x_next and the interpolant. Returns the error relative to the
   tolerance, half way, against a step half as long; MG_MAX where there is no solution. */
static mg_real mg_start_rolling(mg_context *c, mg_real t, const mg_real *start, mg_real h) {
  const int n = c->n_x;
  mg_real *x = c->run->x, sum = 0;
  for (int i = 0; i < n; i++) c->x_next[i] = start[i];
  if (!mg_solve_stages(c, t, x, h / 2)) return MG_MAX;
  for (int i = 0; i < n; i++) c->settled[i] = mg_stage_state(c, MG_RADAU - 1)[i];
  if (!mg_solve_stages(c, t, x, h)) return MG_MAX;
  mg_collocated(c, x);
  mg_interpolate(c, x, (mg_real)1 / 2, c->x_stage);
  for (int i = 0; i < n; i++) {
    const mg_real size = fabs(x[i]) > c->sys->scale[i] ? fabs(x[i]) : c->sys->scale[i];
    const mg_real error = (c->x_stage[i] - c->settled[i]) / (c->set->tolerance * size);
    sum += error * error;
  }
  c->pace = mg_pace_after(c);
  return c->set->method == MG_RK4 ? 0 : sqrt(sum / c->n_live);
}
