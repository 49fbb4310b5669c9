/* Contacts that start to roll from flat, and their return to ordinary contacts when the tilt is large enough. Writes
   run->rolling_start, tilt_direction, contact points and the next step length of the run, and c->step.

   First step of a contact that starts from flat: a face leaves a plane and its body rolls on one point of its rim.
   At the time tau the tilt is of the order of A tau^3. A tilt across its azimuth moves the contact point by a factor
   1/(A tau^3), so that the equations are irregular singular at tau = 0. One solution is smooth there; the others
   oscillate about it with unbounded velocity. Radau collocation selects the smooth one. Unknowns are the states and
   the azimuths at the stages: for given azimuths the right-hand side is evaluated with bodies rotated to that tilt
   and azimuth rate, which is smooth and converges by substitution; the condition that the bodies do tilt in that
   direction is a well-conditioned linear system of seven rows per contact, h^2 A^2 k - tilt, with the matrix A of
   the collocation and the stiffness k, solved by Newton's method.

   To start a contact: put it on its feature pair, with eta (if it has any) at the point where the centre of pressure
   leaves the hull; mark it closed, active and MG_START_FLAT; write the outward direction along the plane (world
   axes, unit vector) into run->tilt_direction; let run->h be no shorter than the characteristic time. The row of
   such a contact has no meaning until its first step, so that no complementarity problem may contain it. When the
   tilt exceeds rounding the mark becomes MG_START_SETTLING, and the contact has no bounds on its margin until the
   margin exceeds them. */
#include "integrate/integrate.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

#define MG_COARSE_TOLERANCE 0.05 /* relative change of the stages below which the tilt is no longer held */

#define MG_NEWTON_DIVERGED 100 /* relative change of the stages above which the iteration has diverged */

/* Flags of the evaluation of the stages. */
enum {
  MG_TILT_HELD = 1,     /* with the tilt of the iteration before */
  MG_WITH_STIFFNESS = 2 /* the stiffness is found too */
};

MG_INTERNAL int mg_has_rolling_start(const mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->run->rolling_start[i] == MG_START_FLAT) return 1;
  return 0;
}

/* True if the conditions of the contact's feature pair hold and its margin is above the warning level, so that the
   start of rolling is over. */
static int mg_is_rolling_start_over(mg_context *c, int contact) {
  const mg_real *eta = mg_contact_eta(c, c->run->x, contact);
  int which;
  mg_place_contact(c, contact, eta, c->search.placement + 32);
  return c->run->margin[contact] >= c->settings->margin_warn &&
         mg_most_violated_condition(c, c->run->feature_pair[contact], eta, &which) >= 0;
}

/* Update the outward direction and the contact point of a contact that still starts from flat. */
static void mg_continue_rolling_start(mg_context *c, int contact) {
  const mg_contact_tilt at =
      mg_tilt_at_azimuth(c, contact, c->step.rolling_starts[contact].azimuth[MG_RADAU_STAGES - 1]);
  for (int k = 0; k < 3; k++) c->run->tilt_direction[3 * contact + k] = at.along[k];
  mg_find_rolling_point(c, c->run->t, contact, &at, c->run->x);
}

/* Longest explicit step in s after the start of rolling: the time scale of oscillation about the smooth solution. */
static mg_real mg_rolling_step_limit(const mg_context *c, int contact) {
  const mg_rolling_start *start = c->step.rolling_starts + contact;
  const mg_contact_tilt at = mg_tilt_at_azimuth(c, contact, start->azimuth[MG_RADAU_STAGES - 1]);
  return sqrt(mg_dot3(at.along, at.tilt) / fabs(start->stiffness[MG_RADAU_STAGES - 1]));
}

MG_INTERNAL void mg_update_rolling_starts(mg_context *c) {
  int any_start = 0;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    any_start |= c->run->rolling_start[i];
  if (any_start) mg_update_poses(c, c->run->t, c->run->x);
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    const int starts = c->run->rolling_start[i] == MG_START_FLAT;
    if (!c->run->rolling_start[i]) continue;
    if (mg_is_tilt_below_flat_limit(c, i)) {
      mg_continue_rolling_start(c, i);
      continue;
    }
    const mg_real step_limit = starts ? mg_rolling_step_limit(c, i) : MG_MAX;
    mg_set_rolling_start(c, i, mg_is_rolling_start_over(c, i) ? MG_START_NONE : MG_START_SETTLING);
    if (starts && c->settings->method == MG_RK4) c->run->h = c->settings->step;
    else if (step_limit < c->run->h) c->run->h = step_limit;
  }
}

/* Copy the state of a stage, with normalised quaternions, to the stage workspace. */
static void mg_load_stage_state(mg_context *c, int stage) {
  mg_copy_states(c, mg_stage_state(c, stage), c->step.stage);
  mg_normalise_quaternions(c, c->step.stage);
}

/* Rotate the bodies of starting contacts at a stage to tilt along their azimuths plus `turned`; `held`: by the
   tilt of the last iteration. Returns 0 where a tilt is not positive. */
static int mg_tilt_stage_bodies(mg_context *c, mg_real t, int stage, mg_real h, int tilt_held,
                                mg_real azimuth_increment) {
  const mg_real noise = stage < MG_RADAU_STAGES - 1 ? 8 * MG_EPS * h / c->system->time : 0;
  for (int iteration = 0; iteration < 2; iteration++) {
    mg_update_poses(c, t, c->step.stage);
    for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) {
      if (c->run->rolling_start[i] != MG_START_FLAT) continue;
      mg_rolling_start *start = c->step.rolling_starts + i;
      const mg_contact_tilt at = mg_tilt_at_azimuth(c, i, start->azimuth[stage] + azimuth_increment);
      mg_real tilt[3];
      if (!iteration && !tilt_held) {
        mg_tilt_of_stage(c, i, stage, h, tilt);
        start->tilt[stage] = mg_dot3(at.along, tilt) + noise;
      }
      if (!(start->tilt[stage] > 0)) return 0;
      mg_rotate_to_tilt(c, i, &at, start->tilt[stage], c->step.stage);
    }
    mg_normalise_quaternions(c, c->step.stage);
  }
  mg_update_poses(c, t, c->step.stage);
  return 1;
}

/* Evaluate the right-hand side at a stage with bodies tilted along their azimuths; returns 0 where a contact
   point is not found. */
static int mg_tilted_stage_slope(mg_context *c, mg_real t, int stage, mg_real h, int tilt_held,
                                 mg_real azimuth_increment, mg_real *slope) {
  mg_real *x = c->step.stage;
  mg_load_stage_state(c, stage);
  if (!mg_tilt_stage_bodies(c, t, stage, h, tilt_held, azimuth_increment)) return 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) {
    if (c->run->rolling_start[i] != MG_START_FLAT) continue;
    mg_rolling_start *start = c->step.rolling_starts + i;
    const mg_contact_tilt at = mg_tilt_at_azimuth(c, i, start->azimuth[stage] + azimuth_increment);
    const int tilt_lost = mg_is_tilt_lost_in_rounding(c, start->tilt[stage]);
    start->azimuth_noise[stage] =
        tilt_lost ? MG_EPS / sqrt(c->settings->flat_angle) : mg_relative_tilt_error(&at, start->tilt[stage]);
    mg_set_azimuth_rate(c, i, &at, start->tilt[stage], mg_derivative(start->azimuth, stage) / h, x);
    if (!(tilt_lost ? mg_find_rolling_point(c, t, i, &at, x)
                    : mg_converge_contact_point(c, i, mg_contact_eta(c, x, i))))
      return 0;
  }
  if (c->settings->newton > 1 && !mg_place_all_contacts(c, t, x)) return 0;
  mg_right_hand_side(c, t, x, slope);
  return 1;
}

/* Store the tilt rates of all starting contacts at one stage. */
static void mg_note_stage_tilt_rates(mg_context *c, mg_real t, int stage) {
  mg_load_stage_state(c, stage);
  mg_update_poses(c, t, c->step.stage);
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (c->run->rolling_start[i] == MG_START_FLAT) mg_note_tilt_rate(c, i, stage);
}

/* Store the tilt rates of all starting contacts at all stages. */
static void mg_note_all_tilt_rates(mg_context *c, mg_real t, mg_real h) {
  for (int stage = 0; stage < MG_RADAU_STAGES; stage++)
    mg_note_stage_tilt_rates(c, t + mg_stage_time(stage) * h, stage);
}

/* Integrate the poses of all stages from their velocities, and store the tilt rates; returns the relative change. */
static mg_real mg_integrate_stage_poses(mg_context *c, mg_real t, const mg_real *x, mg_real h) {
  mg_real *rate = c->step.slopes + (1 + 2 * MG_RADAU_STAGES) * c->layout.n_states;
  for (int stage = 0; stage < MG_RADAU_STAGES; stage++) {
    const mg_real time = t + mg_stage_time(stage) * h;
    mg_note_stage_tilt_rates(c, time, stage);
    mg_free_accelerations(c, time, c->step.stage, rate);
    for (int i = 0; i < c->system->n_q; i++) mg_stage_slope(c, stage)[i] = rate[i];
  }
  return mg_integrate_stages(c, x, h, 0, c->system->n_q);
}

/* Derivative by the azimuth of the tilt acceleration across it, at a stage, by a difference quotient. */
static int mg_find_azimuth_stiffness(mg_context *c, mg_real t, int stage, mg_real h) {
  const mg_real azimuth_increment = (mg_real)1 / 1024;
  mg_real *slope = c->step.slopes + (1 + 2 * MG_RADAU_STAGES) * c->layout.n_states;
  for (int perturbed = 0; perturbed < 2; perturbed++) {
    if (perturbed && !mg_tilted_stage_slope(c, t, stage, h, 1, azimuth_increment, slope)) return 0;
    for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
      if (c->run->rolling_start[i] != MG_START_FLAT) continue;
      mg_rolling_start *start = c->step.rolling_starts + i;
      const mg_contact_tilt at = mg_tilt_at_azimuth(c, i, start->azimuth[stage]);
      const mg_real across =
          -mg_relative_angular_acceleration(c, i, perturbed ? slope : mg_stage_slope(c, stage), at.along) /
          azimuth_increment;
      start->stiffness[stage] = perturbed ? start->stiffness[stage] + across : -across;
    }
  }
  return 1;
}

/* Evaluate the slope at a stage and store the eta of starting contacts, which is solved for, not integrated. */
static int mg_evaluate_rolling_stage(mg_context *c, mg_real t, int stage, mg_real h, int evaluation_flags) {
  const int first = c->system->n_q + c->system->n_u;
  if (!mg_tilted_stage_slope(c, t, stage, h, evaluation_flags & MG_TILT_HELD, 0, mg_stage_slope(c, stage))) return 0;
  mg_watch_event_signs(c);
  for (int i = first; i < c->layout.work_state; i++) mg_stage_state(c, stage)[i] = c->step.stage[i];
  return !(evaluation_flags & MG_WITH_STIFFNESS) || mg_find_azimuth_stiffness(c, t, stage, h);
}

/* One substitution: slopes at all stages, then velocities, then poses; returns 0 where it fails, and the relative
   change. */
static int mg_iterate_rolling_stages(mg_context *c, mg_real t, mg_real *x, mg_real h, int evaluation_flags,
                                     mg_real *change) {
  const mg_system *s = c->system;
  const int first = s->n_q + s->n_u;
  c->step.sign_changed = 0;
  for (int stage = 0; stage < MG_RADAU_STAGES; stage++)
    if (!mg_evaluate_rolling_stage(c, t + mg_stage_time(stage) * h, stage, h, evaluation_flags)) return 0;
  *change = mg_integrate_stages(c, x, h, s->n_q, first);
  const mg_real pose_change = mg_integrate_stage_poses(c, t, x, h);
  if (!(pose_change <= *change)) *change = pose_change;
  for (int i = mg_next_row(c, -1); i < s->n_contact; i = mg_next_row(c, i)) {
    if (c->run->rolling_start[i] == MG_START_FLAT) continue;
    const int from = first + s->contact_eta[i];
    const mg_real more = mg_integrate_stages(c, x, h, from, from + c->contacts.n_eta[i]);
    if (!(more <= *change)) *change = more;
  }
  mg_integrate_stages(c, x, h, c->layout.work_state, c->layout.n_states);
  return *change <= MG_MAX;
}

/* Newton step for the azimuths of one contact; returns its relative effect on the velocities. */
static mg_real mg_newton_azimuth_step(mg_context *c, mg_real t, mg_real h, int contact) {
  mg_rolling_start *start = c->step.rolling_starts + contact;
  mg_real matrix[MG_RADAU_STAGES][MG_RADAU_STAGES], change[MG_RADAU_STAGES], tilt[3], most = 0;
  for (int row = 0; row < MG_RADAU_STAGES; row++) {
    mg_load_stage_state(c, row);
    mg_update_poses(c, t + mg_stage_time(row) * h, c->step.stage);
    mg_tilt_of_stage(c, contact, row, h, tilt);
    change[row] = -mg_dot3(mg_tilt_at_azimuth(c, contact, start->azimuth[row]).across, tilt);
    for (int k = 0; k < MG_RADAU_STAGES; k++)
      matrix[row][k] = h * h * mg_double_integral_weight(row, k) * start->stiffness[k];
    matrix[row][row] -= start->tilt[row];
  }
  if (!mg_gauss_eliminate(matrix, change)) return MG_MAX;
  for (int stage = 0; stage < MG_RADAU_STAGES; stage++) {
    const mg_real effect = fabs(change[stage] * start->stiffness[stage]) * h * c->system->time;
    start->azimuth[stage] += change[stage];
    if (!(effect <= most)) most = effect;
  }
  return most;
}

/* Newton step for all azimuths and one substitution; returns the largest relative change, NAN where it fails. */
static mg_real mg_iterate_azimuths_and_stages(mg_context *c, mg_real t, mg_real *x, mg_real h, int evaluation_flags) {
  mg_real azimuth_effect = 0, change = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) {
    const mg_real effect = c->run->rolling_start[i] == MG_START_FLAT ? mg_newton_azimuth_step(c, t, h, i) : 0;
    if (!(effect <= azimuth_effect)) azimuth_effect = effect;
  }
  if (!mg_iterate_rolling_stages(c, t, x, h, evaluation_flags, &change)) return (mg_real)NAN;
  return azimuth_effect <= change ? change : azimuth_effect;
}

/* Initialise the stages: all bodies move on uniformly and tilt a little along the outward direction. */
static int mg_guess_rolling_stages(mg_context *c, mg_real t, mg_real *x, mg_real h) {
  const int n_q = c->system->n_q;
  mg_real change;
  if (!mg_initialise_rolling_starts(c, t, x, h)) return 0;
  for (int stage = 0; stage < MG_RADAU_STAGES; stage++)
    for (int range = 0; range < c->listed.n_range; range++)
      for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++)
        mg_stage_state(c, stage)[i] = x[i] + (i < n_q ? mg_stage_time(stage) * h * c->step.slopes[i] : 0);
  mg_note_all_tilt_rates(c, t, h);
  return mg_iterate_rolling_stages(c, t, x, h, MG_TILT_HELD, &change) &&
         mg_iterate_rolling_stages(c, t, x, h, MG_TILT_HELD | MG_WITH_STIFFNESS, &change);
}

/* Relative change of the velocities that rounding of the poses causes by turning the tilt. */
static mg_real mg_rolling_velocity_noise(const mg_context *c, mg_real h) {
  mg_real most = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) {
    if (c->run->rolling_start[i] != MG_START_FLAT) continue;
    for (int stage = 0; stage < MG_RADAU_STAGES; stage++) {
      const mg_real effect = 8 * c->step.rolling_starts[i].azimuth_noise[stage] *
                             fabs(c->step.rolling_starts[i].stiffness[stage]) * h * c->system->time;
      if (!(effect <= most)) most = effect;
    }
  }
  return most;
}

/* Initialise the stages from the polynomial of a longer step, of which this step is a share. */
static int mg_reuse_longer_step_stages(mg_context *c, mg_real t, mg_real *x, mg_real h, mg_real share) {
  mg_real change;
  mg_restrict_stages(c, x, share);
  mg_note_all_tilt_rates(c, t, h);
  return mg_iterate_rolling_stages(c, t, x, h, 0, &change);
}

/* Iterate the stages of a step h to convergence, first with the tilt held; returns the relative change left,
   which rounding may bound, or NAN. */
static mg_real mg_solve_rolling_stages(mg_context *c, mg_real t, mg_real *x, mg_real h, int hold_tilt_first) {
  const mg_real goal = c->settings->tolerance / 100;
  mg_real previous_change = MG_MAX, last_change = hold_tilt_first ? previous_change : 0;
  for (int round = 0; round < 12 && last_change > (mg_real)MG_COARSE_TOLERANCE; round++)
    if (!((last_change = mg_iterate_azimuths_and_stages(c, t, x, h, MG_TILT_HELD)) <= MG_NEWTON_DIVERGED))
      return (mg_real)NAN;
  for (int round = 0; round < 40 && last_change <= MG_MAX; round++) {
    last_change = mg_iterate_azimuths_and_stages(c, t, x, h, 0);
    const mg_real remaining_change =
        round && last_change < previous_change / 4 ? last_change * (last_change / previous_change) : last_change;
    if ((round || !hold_tilt_first) && remaining_change <= goal) return remaining_change;
    const mg_real noise = last_change > previous_change ? last_change : previous_change;
    if (round > 4 && last_change > previous_change / 4 && noise <= mg_rolling_velocity_noise(c, h)) return noise;
    previous_change = last_change;
  }
  return (mg_real)NAN;
}

/* Solve the stages of the full step, from a longer step tried before or from a guess; returns the relative change
   left or NAN. */
static mg_real mg_solve_full_rolling_step(mg_context *c, mg_real t, mg_real *x, mg_real h) {
  if (c->step.rolling_step > h && mg_reuse_longer_step_stages(c, t, x, h, h / c->step.rolling_step)) {
    const mg_real most = mg_solve_rolling_stages(c, t, x, h, 0);
    if (most <= MG_MAX) return most;
  }
  return mg_guess_rolling_stages(c, t, x, h) ? mg_solve_rolling_stages(c, t, x, h, 1) : (mg_real)NAN;
}

/* Save the azimuths and stiffnesses of the full step, or restore them. */
static void mg_save_or_restore_azimuths(mg_context *c, int restore) {
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    for (int k = 0; k < MG_RADAU_STAGES && c->run->rolling_start[i] == MG_START_FLAT; k++) {
      mg_rolling_start *start = c->step.rolling_starts + i;
      mg_real *saved = start->whole_step[k];
      if (restore) start->azimuth[k] = saved[0], start->stiffness[k] = saved[1];
      else saved[0] = start->azimuth[k], saved[1] = start->stiffness[k];
    }
}

MG_INTERNAL mg_real mg_take_rolling_start_step(mg_context *c, mg_real t, mg_real *x, mg_real h) {
  mg_copy_states(c, x, c->step.end);
  const mg_real full_change = mg_solve_full_rolling_step(c, t, x, h);
  c->step.rolling_step = full_change <= MG_MAX ? h : 0;
  if (!(full_change <= MG_MAX)) return MG_MAX;
  mg_make_collocation_interpolant(c, x);
  if (c->settings->method == MG_RK4) return 0;
  mg_save_or_restore_azimuths(c, 0);
  const int reused = mg_reuse_longer_step_stages(c, t, x, h / 2, (mg_real)1 / 2);
  const mg_real half_change = reused ? mg_solve_rolling_stages(c, t, x, h / 2, 0) : (mg_real)NAN;
  mg_save_or_restore_azimuths(c, 1);
  if (!(half_change <= MG_MAX)) return MG_MAX;
  const mg_real half_difference = mg_half_step_difference(c, x, mg_stage_state(c, MG_RADAU_STAGES - 1));
  const mg_real start_error = mg_rolling_start_load_error(c, t, x, h / 2),
                noise = (half_change > full_change ? half_change : full_change) / c->settings->tolerance;
  const mg_real error = (half_difference > start_error ? half_difference : start_error) - noise;
  return error > 0 ? error : 0;
}
