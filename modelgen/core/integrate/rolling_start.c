/* Contacts that start from flat, and how they grow out of it. */
/* The first step of a contact that starts from flat: a face leaves a plane, and its body goes on on one point of its
   rim.

   While the rim is flat no point of it is lowest. At the time tau after, the body leans by A tau^3 or so towards its
   azimuth, and a lean across that azimuth turns the contact point by 1/(A tau^3) times as much: the equations are
   irregular singular at tau = 0. Of all their solutions one is smooth there; the others swing about it with an
   unbounded speed. Collocation at Radau's points keeps to the smooth one. Its unknowns are taken to be the states and
   the azimuths at the stages: given the azimuths, the right-hand side is evaluated on bodies turned to lean that way,
   and to go on leaning that way, which is smooth and converges by substitution; and that the bodies do lean that way is
   a well-conditioned linear system of seven rows a contact, h^2 A^2 k - tilt.

   How to start a contact: with the faces flat on each other and without a rate of leaving, put it on its link with eta
   (if it has any) at the point where the pressure leaves, mark it closed, active and MG_START_FLAT, write the way out
   of the hull there, along the plane (world, unit), into run->outward, and let run->h be no shorter than the scene's
   own time: the step is tried from there down. The row of a fresh contact means nothing until its first step, which
   mg_try_step takes: no complementarity problem may contain it. Once the lean is clear of rounding it is
   MG_START_SETTLING, excused from the bounds on margins until its margin is above them; till then it is MG_START_FLAT,
   and the next step is of this kind too. */
#include "integrate/integrate.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

/* changes of the stages, against their scale: below the one the lean is held no longer, above the other it never is
 * found */
#define MG_COARSE_TOLERANCE 0.05

#define MG_NEWTON_DIVERGED 100

enum { MG_HELD = 1, MG_STIFF = 2 }; /* how stages are looked at: with the lean as before; for the stiffness as well */

MG_INTERNAL int mg_starts_rolling(const mg_context *c) {
  for (int i = 0; i < c->system->n_contact; i++)
    if (c->run->fresh[i] == MG_START_FLAT) return 1;
  return 0;
}

/* The conditions of its link hold, and its margin is nothing to warn of. */
static int mg_is_grown_up(mg_context *c, int contact) {
  const mg_real *eta = mg_contact_eta(c, c->run->x, contact);
  int which;
  mg_place_contact(c, contact, eta, c->search.placement + 32);
  return c->run->margin[contact] >= c->settings->margin_warn &&
         mg_most_violated_condition(c, c->run->link[contact], eta, &which) >= 0;
}

/* Brings eta of a contact to the extremum at the present poses, as near as rounding lets it. */
MG_INTERNAL int mg_settle_fully(mg_context *c, int contact, mg_real *eta) {
  if (!c->n_eta[contact]) return 1;
  if (mg_newton_on_link(c, contact, eta) < 0) return 0;
  for (int extra = 0; extra < 2; extra++) {
    mg_place_contact(c, contact, eta, c->search.placement + 32);
    for (int k = 0; k < c->n_eta[contact]; k++) eta[k] = c->search.placement[32 + k];
  }
  return mg_all_finite(c->n_eta[contact], eta);
}

/* Notes of such a contact the way it leans by now, and its point. */
static void mg_starts_on(mg_context *c, int contact) {
  const mg_contact_tilt at = mg_tilt_at(c, contact, c->step.rolling_starts[contact].azimuth[MG_RADAU_STAGES - 1]);
  for (int k = 0; k < 3; k++) c->run->outward[3 * contact + k] = at.along[k];
  mg_tilted_contact_point(c, c->run->t, contact, &at, c->run->x);
}

/* What the explicit method can follow: the swing about the smooth solution. */
static mg_real mg_pace_of(const mg_context *c, int contact) {
  const mg_rolling_start *onset = c->step.rolling_starts + contact;
  const mg_contact_tilt at = mg_tilt_at(c, contact, onset->azimuth[MG_RADAU_STAGES - 1]);
  return sqrt(mg_dot3(at.along, at.tilt) / fabs(onset->stiffness[MG_RADAU_STAGES - 1]));
}

/* After a step. */
MG_INTERNAL void mg_end_rolling_start(mg_context *c) {
  int grow = 0;
  for (int i = 0; i < c->support_begin; i++) grow |= c->run->fresh[i];
  if (grow) mg_update_poses(c, c->run->t, c->run->x);
  for (int i = 0; i < c->support_begin; i++) {
    const int starts = c->run->fresh[i] == MG_START_FLAT;
    if (!c->run->fresh[i]) continue;
    if (mg_is_tilt_below_rounding(c, i)) {
      mg_starts_on(c, i);
      continue;
    }
    const mg_real pace = starts ? mg_pace_of(c, i) : MG_MAX;
    c->run->fresh[i] = mg_is_grown_up(c, i) ? MG_START_NONE : MG_START_SETTLING;
    if (starts && c->settings->method == MG_RK4) c->run->h = c->settings->step;
    else if (pace < c->run->h) c->run->h = pace;
  }
}

/* The state at a stage, with quaternions of unit length, to c->step.stage. */
static void mg_take_stage(mg_context *c, int stage) {
  for (int i = 0; i < c->n_states; i++) c->step.stage[i] = mg_stage_state(c, stage)[i];
  mg_normalise_quaternions(c, c->step.stage);
}

/* Turns the fresh contacts of c->step.stage to lean along their azimuths at a stage plus `turned`; as far as they do,
   or, if `held`, as before. Returns 0 where one does not lean that way. */
static int mg_lean_stage(mg_context *c, mg_real t, int stage, mg_real h, int held, mg_real turned) {
  const mg_real noise = stage < MG_RADAU_STAGES - 1 ? 8 * MG_EPS * h / c->system->time : 0;
  for (int twice = 0; twice < 2; twice++) {
    mg_update_poses(c, t, c->step.stage);
    for (int i = 0; i < c->system->n_contact; i++) {
      if (c->run->fresh[i] != MG_START_FLAT) continue;
      mg_rolling_start *onset = c->step.rolling_starts + i;
      const mg_contact_tilt at = mg_tilt_at(c, i, onset->azimuth[stage] + turned);
      mg_real lean[3];
      if (!twice && !held) {
        mg_stage_tilt(c, i, stage, h, lean);
        onset->tilt[stage] = mg_dot3(at.along, lean) + noise;
      }
      if (!(onset->tilt[stage] > 0)) return 0;
      mg_apply_tilt(c, i, &at, onset->tilt[stage], c->step.stage);
    }
    mg_normalise_quaternions(c, c->step.stage);
  }
  mg_update_poses(c, t, c->step.stage);
  return 1;
}

/* The slope at a stage with its fresh contacts leaning so, and turning as their azimuths do from stage to stage. */
static int mg_slope_leaning(mg_context *c, mg_real t, int stage, mg_real h, int held, mg_real turned, mg_real *slope) {
  mg_real *x = c->step.stage;
  mg_take_stage(c, stage);
  if (!mg_lean_stage(c, t, stage, h, held, turned)) return 0;
  for (int i = 0; i < c->system->n_contact; i++) {
    if (c->run->fresh[i] != MG_START_FLAT) continue;
    mg_rolling_start *onset = c->step.rolling_starts + i;
    const mg_contact_tilt at = mg_tilt_at(c, i, onset->azimuth[stage] + turned);
    const int flat = mg_is_tilt_lost(c, onset->tilt[stage]);
    onset->azimuth_noise[stage] = flat ? MG_EPS / sqrt(c->settings->flat) : mg_tilt_defect(&at, onset->tilt[stage]);
    mg_tilt_rate_at(c, i, &at, onset->tilt[stage], mg_derivative(onset->azimuth, stage) / h, x);
    if (!(flat ? mg_tilted_contact_point(c, t, i, &at, x) : mg_settle_fully(c, i, mg_contact_eta(c, x, i)))) return 0;
  }
  if (c->settings->newton > 1 && !mg_place_all_contacts(c, t, x)) return 0;
  mg_rhs(c, t, x, slope);
  return 1;
}

/* Of the lean of fresh contacts at the state of a stage. */
static void mg_note_rates(mg_context *c, mg_real t, int stage) {
  mg_take_stage(c, stage);
  mg_update_poses(c, t, c->step.stage);
  for (int i = 0; i < c->support_begin; i++)
    if (c->run->fresh[i] == MG_START_FLAT) mg_note_tilt_rate(c, i, stage);
}

static void mg_note_all_rates(mg_context *c, mg_real t, mg_real h) {
  for (int stage = 0; stage < MG_RADAU_STAGES; stage++) mg_note_rates(c, t + mg_stage_time(stage) * h, stage);
}

/* The poses by the velocities of the stages, and the rates of the leans. Returns by how much they changed. */
static mg_real mg_follow(mg_context *c, mg_real t, const mg_real *x, mg_real h) {
  mg_real *rate = c->step.slopes + (1 + 2 * MG_RADAU_STAGES) * c->n_states;
  for (int stage = 0; stage < MG_RADAU_STAGES; stage++) {
    const mg_real time = t + mg_stage_time(stage) * h;
    mg_note_rates(c, time, stage);
    mg_free_accelerations(c, time, c->step.stage, rate);
    for (int i = 0; i < c->system->n_q; i++) mg_stage_slope(c, stage)[i] = rate[i];
  }
  return mg_integrate_stages(c, x, h, 0, c->system->n_q);
}

/* d(acceleration of the lean across its azimuth) / d(azimuth) at a stage, by a difference from the slope just found. */
static int mg_find_stiffness(mg_context *c, mg_real t, int stage, mg_real h) {
  const mg_real turned = (mg_real)1 / 1024;
  mg_real *slope = c->step.slopes + (1 + 2 * MG_RADAU_STAGES) * c->n_states;
  for (int twice = 0; twice < 2; twice++) {
    if (twice && !mg_slope_leaning(c, t, stage, h, 1, turned, slope)) return 0;
    for (int i = 0; i < c->support_begin; i++) {
      if (c->run->fresh[i] != MG_START_FLAT) continue;
      mg_rolling_start *onset = c->step.rolling_starts + i;
      const mg_contact_tilt at = mg_tilt_at(c, i, onset->azimuth[stage]);
      const mg_real across = -mg_relative_spin_accel(c, i, twice ? slope : mg_stage_slope(c, stage), at.along) / turned;
      onset->stiffness[stage] = twice ? onset->stiffness[stage] + across : -across;
    }
  }
  return 1;
}

/* The slope at a stage, and eta of fresh contacts, which is settled, not integrated. */
static int mg_look_at_stage(mg_context *c, mg_real t, int stage, mg_real h, int how) {
  const int first = c->system->n_q + c->system->n_u;
  if (!mg_slope_leaning(c, t, stage, h, how & MG_HELD, 0, mg_stage_slope(c, stage))) return 0;
  mg_watch_stage(c);
  for (int i = first; i < c->work_state; i++) mg_stage_state(c, stage)[i] = c->step.stage[i];
  return !(how & MG_STIFF) || mg_find_stiffness(c, t, stage, h);
}

/* Once round: the slopes at the stages, the velocities by them, and the poses by these. */
static int mg_sweep(mg_context *c, mg_real t, mg_real *x, mg_real h, int how, mg_real *change) {
  const mg_system *s = c->system;
  const int first = s->n_q + s->n_u;
  c->step.sign_changed = 0;
  for (int stage = 0; stage < MG_RADAU_STAGES; stage++)
    if (!mg_look_at_stage(c, t + mg_stage_time(stage) * h, stage, h, how)) return 0;
  *change = mg_integrate_stages(c, x, h, s->n_q, first);
  const mg_real moved = mg_follow(c, t, x, h);
  if (!(moved <= *change)) *change = moved;
  for (int i = 0; i < s->n_contact; i++) {
    if (c->run->fresh[i] == MG_START_FLAT) continue;
    const int from = first + s->contact_eta[i];
    const mg_real more = mg_integrate_stages(c, x, h, from, from + c->n_eta[i]);
    if (!(more <= *change)) *change = more;
  }
  mg_integrate_stages(c, x, h, c->work_state, c->n_states);
  return *change <= MG_MAX;
}

/* Newton's step for the azimuths of one contact; returns what it changes of the velocities, against their scale. */
static mg_real mg_steer(mg_context *c, mg_real t, mg_real h, int contact) {
  mg_rolling_start *onset = c->step.rolling_starts + contact;
  mg_real matrix[MG_RADAU_STAGES][MG_RADAU_STAGES], change[MG_RADAU_STAGES], lean[3], most = 0;
  for (int row = 0; row < MG_RADAU_STAGES; row++) {
    mg_take_stage(c, row);
    mg_update_poses(c, t + mg_stage_time(row) * h, c->step.stage);
    mg_stage_tilt(c, contact, row, h, lean);
    change[row] = -mg_dot3(mg_tilt_at(c, contact, onset->azimuth[row]).across, lean);
    for (int k = 0; k < MG_RADAU_STAGES; k++)
      matrix[row][k] = h * h * mg_double_integral_weight(row, k) * onset->stiffness[k];
    matrix[row][row] -= onset->tilt[row];
  }
  if (!mg_gauss_eliminate(matrix, change)) return MG_MAX;
  for (int stage = 0; stage < MG_RADAU_STAGES; stage++) {
    const mg_real effect = fabs(change[stage] * onset->stiffness[stage]) * h * c->system->time;
    onset->azimuth[stage] += change[stage];
    if (!(effect <= most)) most = effect;
  }
  return most;
}

/* Newton's step for the azimuths, and a substitution. Returns the largest change of it, and of the velocities by the
   azimuths; NAN where it fails. */
static mg_real mg_round(mg_context *c, mg_real t, mg_real *x, mg_real h, int how) {
  mg_real most = 0, change = 0;
  for (int i = 0; i < c->system->n_contact; i++) {
    const mg_real effect = c->run->fresh[i] == MG_START_FLAT ? mg_steer(c, t, h, i) : 0;
    if (!(effect <= most)) most = effect;
  }
  if (!mg_sweep(c, t, x, h, how, &change)) return (mg_real)NAN;
  return most <= change ? change : most;
}

/* All bodies go on as they move, and lean a little along the way out. */
static int mg_guess_stages(mg_context *c, mg_real t, mg_real *x, mg_real h) {
  const int n_q = c->system->n_q;
  mg_real change;
  if (!mg_init_rolling_starts(c, t, x, h)) return 0;
  for (int stage = 0; stage < MG_RADAU_STAGES; stage++)
    for (int i = 0; i < c->n_states; i++)
      mg_stage_state(c, stage)[i] = x[i] + (i < n_q ? mg_stage_time(stage) * h * c->step.slopes[i] : 0);
  mg_note_all_rates(c, t, h);
  return mg_sweep(c, t, x, h, MG_HELD, &change) && mg_sweep(c, t, x, h, MG_HELD | MG_STIFF, &change);
}

/* What rounding of the poses does to the velocities by turning the lean, against their scale. */
static mg_real mg_rounding(const mg_context *c, mg_real h) {
  mg_real most = 0;
  for (int i = 0; i < c->system->n_contact; i++) {
    if (c->run->fresh[i] != MG_START_FLAT) continue;
    for (int stage = 0; stage < MG_RADAU_STAGES; stage++) {
      const mg_real effect = 8 * c->step.rolling_starts[i].azimuth_noise[stage] *
                             fabs(c->step.rolling_starts[i].stiffness[stage]) * h * c->system->time;
      if (!(effect <= most)) most = effect;
    }
  }
  return most;
}

/* The stages on the polynomial of a longer step, found before, of which the step is a share. */
static int mg_reuse_stages(mg_context *c, mg_real t, mg_real *x, mg_real h, mg_real share) {
  mg_real change;
  mg_restrict_stages(c, x, share);
  mg_note_all_rates(c, t, h);
  return mg_sweep(c, t, x, h, 0, &change);
}

/* The stages of a step h from a guess, first with the lean held, roughly, then with it followed, until what a next
   round would change is little. Returns to what part of their scale they are found, which rounding may bound, or NAN.
 */
static mg_real mg_solve_stages(mg_context *c, mg_real t, mg_real *x, mg_real h, int held) {
  const mg_real goal = c->settings->tolerance / 100;
  mg_real before = MG_MAX, most = held ? before : 0;
  for (int round = 0; round < 12 && most > (mg_real)MG_COARSE_TOLERANCE; round++)
    if (!((most = mg_round(c, t, x, h, MG_HELD)) <= MG_NEWTON_DIVERGED)) return (mg_real)NAN;
  for (int round = 0; round < 40 && most <= MG_MAX; round++) {
    most = mg_round(c, t, x, h, 0);
    const mg_real left = round && most < before / 4 ? most * (most / before) : most;
    if ((round || !held) && left <= goal) return left;
    const mg_real noise = most > before ? most : before;
    if (round > 4 && most > before / 4 && noise <= mg_rounding(c, h)) return noise;
    before = most;
  }
  return (mg_real)NAN;
}

/* Of eta of a fresh contact, which is settled and not integrated: near flat, rounding moves its point far along a
 * curve. */
static int mg_is_of_onset(const mg_context *c, int state) {
  const int first = c->system->n_q + c->system->n_u;
  for (int i = 0; i < c->support_begin; i++) {
    const int from = first + c->system->contact_eta[i];
    if (c->run->fresh[i] == MG_START_FLAT && state >= from && state < from + c->n_eta[i]) return 1;
  }
  return 0;
}

/* The difference of the interpolant half way from the end of a step half as long, root mean square against the
   tolerance. */
MG_INTERNAL mg_real mg_differs_at_half_step(mg_context *c, const mg_real *x, const mg_real *half) {
  mg_real sum = 0;
  mg_interpolate(c, x, (mg_real)1 / 2, c->step.stage);
  for (int i = 0; i < c->n_states; i++) {
    if (mg_is_of_onset(c, i)) continue;
    const mg_real size = fabs(x[i]) > c->step.scale[i] ? fabs(x[i]) : c->step.scale[i];
    const mg_real error = (c->step.stage[i] - half[i]) / (c->settings->tolerance * size);
    sum += error * error;
  }
  return sqrt(sum / c->n_live_states);
}

/* The whole step, from the polynomial of a longer one that was tried before, or from a guess. */
static mg_real mg_solve_whole(mg_context *c, mg_real t, mg_real *x, mg_real h) {
  if (c->step.rolling_step > h && mg_reuse_stages(c, t, x, h, h / c->step.rolling_step)) {
    const mg_real most = mg_solve_stages(c, t, x, h, 0);
    if (most <= MG_MAX) return most;
  }
  return mg_guess_stages(c, t, x, h) ? mg_solve_stages(c, t, x, h, 1) : (mg_real)NAN;
}

/* Notes the azimuths of the whole step and how stiff they are, or takes them back. */
static void mg_keep_azimuths(mg_context *c, int back) {
  for (int i = 0; i < c->support_begin; i++)
    for (int k = 0; k < MG_RADAU_STAGES && c->run->fresh[i] == MG_START_FLAT; k++) {
      mg_rolling_start *onset = c->step.rolling_starts + i;
      mg_real *whole = onset->whole_step[k];
      if (back) onset->azimuth[k] = whole[0], onset->stiffness[k] = whole[1];
      else whole[0] = onset->azimuth[k], whole[1] = onset->stiffness[k];
    }
}

/* From K[0], of which only the rates of q count, to c->step.end and the interpolant. Returns the error relative to the
   tolerance, as far as it is more than rounding; MG_MAX where there is no solution. */
MG_INTERNAL mg_real mg_start_rolling(mg_context *c, mg_real t, mg_real *x, mg_real h) {
  for (int i = 0; i < c->n_states; i++) c->step.end[i] = x[i];
  const mg_real whole = mg_solve_whole(c, t, x, h);
  c->step.rolling_step = whole <= MG_MAX ? h : 0;
  if (!(whole <= MG_MAX)) return MG_MAX;
  mg_collocated(c, x);
  if (c->settings->method == MG_RK4) return 0;
  mg_keep_azimuths(c, 0);
  const int reused = mg_reuse_stages(c, t, x, h / 2, (mg_real)1 / 2);
  const mg_real half = reused ? mg_solve_stages(c, t, x, h / 2, 0) : (mg_real)NAN;
  mg_keep_azimuths(c, 1);
  if (!(half <= MG_MAX)) return MG_MAX;
  const mg_real differs = mg_differs_at_half_step(c, x, mg_stage_state(c, MG_RADAU_STAGES - 1));
  const mg_real missed = mg_misses_start_of_rolling(c, t, x, h / 2),
                noise = (half > whole ? half : whole) / c->settings->tolerance;
  const mg_real error = (differs > missed ? differs : missed) - noise;
  return error > 0 ? error : 0;
}
