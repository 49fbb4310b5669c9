/* Steps of slip that is so slow that friction turns it much faster than the motion changes: by Radau collocation,
   with the slip directions at the stages as unknowns. For given directions the right-hand side is smooth and
   converges by substitution; that the slip lies along its direction is a well-conditioned linear system of seven
   rows a friction constraint. A patch has two unknowns, the components of its direction across the stored one.

   Slip that starts at the friction bound with equal static and kinetic coefficients is such: at the time tau it is
   of the order of tau^2, and friction draws it towards one direction at a rate of the order of 1/tau^2; the
   equations are irregular singular at tau = 0, and one solution is smooth there.

   Slip that goes on slowly, as where a coin that runs down creeps, is stiff: friction turns it at the rate mu N G /
   speed, G being its response to a unit of force, while its speed hardly changes. An explicit step is limited to a
   few times the inverse of that rate. */
#include "integrate/integrate.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

enum {
  MG_SLIP_START_ROUNDS = 2,    /* substitutions with constant directions before the directions are sought */
  MG_SLIP_STIFFNESS_ROUND = 2, /* round in which the derivatives by the angles are taken anew */
  MG_SLIP_ROUNDS = 40,         /* most rounds */
  MG_SLIP_TRIAL_ROUNDS = 8,    /* rounds after which convergence that is too slow is given up */
  MG_STIFF_FAILURES = 3        /* collocations of stiff slip that may fail before an explicit step is taken */
};

#define MG_UNKNOWNS (MG_SLIP_UNKNOWNS * MG_RADAU_STAGES) /* most unknowns of all stages */

/* Unknown directions of the slip that starts: one of a friction constraint, two of a patch. */
typedef struct {
  int count;                                         /* unknowns */
  int constraint[MG_SLIP_UNKNOWNS];                  /* friction constraint, or -1: of a patch */
  int contact[MG_SLIP_UNKNOWNS];                     /* its contact; of a patch its first support point */
  int axis[MG_SLIP_UNKNOWNS];                        /* of a patch: axis across the stored direction, 1 or 2 */
  mg_real angle[MG_RADAU_STAGES][MG_SLIP_UNKNOWNS];  /* angle from the stored direction, rad; of a patch its
                                                              tangent along the axis */
  mg_real along[MG_RADAU_STAGES][MG_SLIP_UNKNOWNS];  /* slip along the direction */
  mg_real across[MG_RADAU_STAGES][MG_SLIP_UNKNOWNS]; /* slip across it */
  mg_real stiffness[MG_RADAU_STAGES][MG_SLIP_UNKNOWNS][MG_SLIP_UNKNOWNS]; /* derivative of the acceleration
                                                               across of the first by the angle of the second */
} mg_slip_onset;

#define MG_EXPLICIT_TURN (mg_real)4 /* rate times step up to which steps are explicit; DOP853 is stable up to 6 */

#define MG_STEADY_SLIP ((mg_real)1 / 32) /* acceleration of steady slip over that by friction, most */

/* Acceleration of slip along a tangent direction by a unit of force along it: of bodies that nothing holds. */
static mg_real mg_free_slip_response(const mg_context *c, int row, const mg_real *direction) {
  mg_real response = 0;
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) response += direction[i] * direction[j] * mg_delassus_entry(c, row + i, row + j);
  return response;
}

/* The same of bodies that joints, active contacts and sticking friction hold; zero where these hold the slip in that
   direction, as across the plane of a planar linkage. */
static mg_real mg_held_slip_response(mg_context *c, int row, const mg_real *direction) {
  int *rows = c->islands.rows, held = 0;
  mg_chain_islands(c, mg_list_held_rows(c));
  const int island = mg_island_of_body(c, mg_moving_body(c, row));
  for (int i = c->islands.head[island]; i >= 0; i = c->islands.next[i]) rows[held++] = i;
  const int n = held + 2;
  rows[held] = row, rows[held + 1] = row + 1;
  mg_assemble_delassus(c, rows, n);
  const mg_real *x = c->lcp.A + (long)n * held, *y = x + n;
  for (int r = 0; r < n; r++)
    c->lcp.b[r] = direction[0] * x[r] + direction[1] * y[r],
    c->lcp.mask[r] = r < held ? mg_held_row_mask(c, rows[r]) : 0;
  mg_real pivot;
  mg_active_above(n, c->lcp.A, c->lcp.b, c->lcp.mask, c->system->n_joint_row ? c->settings->joint_rank_tolerance : 0,
                  c->lcp.z, c->lcp.work, c->lcp.iwork, &pivot);
  const mg_real own = direction[0] * c->lcp.b[held] + direction[1] * c->lcp.b[held + 1];
  mg_real response = own;
  for (int r = 0; r < held; r++) response += c->lcp.b[r] * c->lcp.z[r];
  return response > c->settings->contact_rank_tolerance * own ? response : 0;
}

/* True if the slip of a friction constraint is steady and friction turns it more than an explicit step h can follow.
   What holds the bodies only slows the turning. Needs rows and forces at the run's state. */
static int mg_is_slip_stiff(mg_context *c, int contact, int constraint, mg_real h) {
  MG_NEEDS_AT_RUN(c, MG_VALID_ROWS), MG_NEEDS_AT_RUN(c, MG_VALID_FORCES);
  const mg_real *mu = c->system->friction_kinetic + 2 * constraint;
  if (!c->run->active[contact] || c->run->friction_mode[constraint] < MG_SLIP_STARTING ||
      mg_friction_row_count(c, constraint) != 2)
    return 0;
  mg_real slip[2];
  const int row = mg_first_friction_row(c, contact, constraint);
  mg_slip_along_direction(c, contact, constraint, slip);
  const mg_real speed = sqrt(slip[0] * slip[0] + slip[1] * slip[1]), across[2] = {-slip[1] / speed, slip[0] / speed};
  const mg_real bound = (mu[0] < mu[1] ? mu[0] : mu[1]) * c->solution.force[contact],
                change_x = mg_row_acceleration(c, row), change_y = mg_row_acceleration(c, row + 1),
                change = sqrt(change_x * change_x + change_y * change_y);
  const mg_real free_pull = bound * mg_free_slip_response(c, row, across);
  if (!(h * free_pull > MG_EXPLICIT_TURN * speed && change < MG_STEADY_SLIP * free_pull)) return 0;
  const mg_real pull = bound * mg_held_slip_response(c, row, across);
  return h * pull > MG_EXPLICIT_TURN * speed && change < MG_STEADY_SLIP * pull;
}

MG_INTERNAL void mg_mark_stiff_slip(mg_context *c, mg_real h) {
  MG_NEEDS_AT_RUN(c, MG_VALID_ROWS), MG_NEEDS_AT_RUN(c, MG_VALID_FORCES);
  int count = 0;
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++)
      count += c->friction.is_stiff[g] = count < MG_SLIP_UNKNOWNS && mg_is_slip_stiff(c, i, g, h);
  c->step.stiff_failures = 0;
}

MG_INTERNAL int mg_has_stiff_slip(const mg_context *c) {
  for (int g = mg_next_constraint(c, -1); g < c->system->n_friction; g = mg_next_constraint(c, g))
    if (c->friction.is_stiff[g]) return 1;
  return 0;
}

MG_INTERNAL void mg_forget_stiff_slip(mg_context *c) {
  for (int g = mg_next_constraint(c, -1); g < c->system->n_friction; g = mg_next_constraint(c, g))
    c->friction.is_stiff[g] = 0;
}

MG_INTERNAL int mg_has_slip_onset(const mg_context *c) {
  for (int g = mg_next_constraint(c, -1); g < c->system->n_friction; g = mg_next_constraint(c, g))
    if (c->run->friction_mode[g] == MG_SLIP_ONSET) return 1;
  for (int slot = 0; slot < c->system->n_patch_slot && c->system->n_friction; slot++)
    if (c->run->patch_mode[slot] == MG_SLIP_ONSET) return 1;
  return 0;
}

MG_INTERNAL void mg_finish_slip_onsets(mg_context *c) {
  for (int g = mg_next_constraint(c, -1); g < c->system->n_friction; g = mg_next_constraint(c, g))
    if (c->run->friction_mode[g] == MG_SLIP_ONSET) mg_set_friction_mode(c, g, MG_SLIP_STARTING);
  for (int slot = 0; slot < c->system->n_patch_slot && c->system->n_friction; slot++)
    if (c->run->patch_mode[slot] == MG_SLIP_ONSET) mg_set_patch_mode(c, slot, MG_SLIP_STARTING);
}

/* List the unknown directions of all slip onsets; returns 0 where there are none or too many. */
static int mg_list_slip_onsets(const mg_context *c, mg_slip_onset *o) {
  o->count = 0;
  for (int g = mg_next_constraint(c, -1); g < c->system->n_friction; g = mg_next_constraint(c, g)) {
    if (c->run->friction_mode[g] != MG_SLIP_ONSET && !c->friction.is_stiff[g]) continue;
    if (o->count == MG_SLIP_UNKNOWNS) return 0;
    o->contact[o->count] = mg_contact_of_friction(c, g), o->constraint[o->count++] = g;
  }
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    if (c->run->patch_mode[slot] != MG_SLIP_ONSET) continue;
    if (o->count + 2 > MG_SLIP_UNKNOWNS) return 0;
    for (int axis = 1; axis <= 2; axis++)
      o->contact[o->count] = mg_first_support(c, slot), o->axis[o->count] = axis, o->constraint[o->count++] = -1;
  }
  for (int stage = 0; stage < MG_RADAU_STAGES; stage++)
    for (int k = 0; k < o->count; k++) o->angle[stage][k] = 0;
  return o->count > 0;
}

/* Evaluate the right-hand side at a stage with friction along the given directions. */
static void mg_slope_with_slip_directions(mg_context *c, const mg_slip_onset *o, mg_real t, const mg_real *x,
                                          const mg_real *angle, mg_real *slope) {
  for (int k = 0; k < o->count; k++)
    if (o->constraint[k] >= 0) c->friction.slip_angle[o->constraint[k]] = angle[k];
    else c->patches.friction[(o->contact[k] - c->layout.support_begin) / 3].slip_direction[o->axis[k] - 1] = angle[k];
  c->friction.follows_angle = 1;
  mg_right_hand_side(c, t, x, slope);
  c->friction.follows_angle = 0;
}

/* Components of slip, or of its acceleration, along and across the direction of an unknown. */
static void mg_resolve_slip_components(const mg_context *c, const mg_slip_onset *o, int k, mg_real angle,
                                       int accelerations, mg_real *along, mg_real *across) {
  const int slot = (o->contact[k] - c->layout.support_begin) / 3, is_patch = o->constraint[k] < 0;
  const int row =
      is_patch ? mg_first_patch_friction_row(c, slot) : mg_first_friction_row(c, o->contact[k], o->constraint[k]);
  mg_real e[3][3], value[3];
  for (int i = 0; i < 2 + is_patch; i++)
    value[i] = accelerations ? mg_row_acceleration(c, row + i) : c->rows.d_dot[row + i];
  if (is_patch) {
    mg_real slip[3];
    mg_patch_slip_in_middle(c, slot, value, slip);
    mg_patch_slip_basis(c, slot, e);
    *along = mg_dot3(slip, e[0]), *across = mg_dot3(slip, e[o->axis[k]]) - angle * *along;
    return;
  }
  mg_slip_direction_at_angle(c, o->contact[k], o->constraint[k], angle, e[0]);
  *along = value[0] * e[0][0] + value[1] * e[0][1], *across = value[1] * e[0][0] - value[0] * e[0][1];
}

/* Characteristic slip velocity of an unknown. */
static mg_real mg_slip_onset_velocity_scale(const mg_context *c, const mg_slip_onset *o, int k) {
  return o->constraint[k] < 0 ? c->system->length / c->system->time : mg_slip_velocity_scale(c, o->constraint[k]);
}

/* Derivatives of the accelerations at a stage by the angle of an unknown. */
static mg_real *mg_angle_slope(const mg_context *c, int stage, int unknown) {
  return c->step.angle_slopes + (long)(MG_SLIP_UNKNOWNS * stage + unknown) * c->system->n_u;
}

/* Differences of the accelerations at a stage, and of those across slip, by the angles, from its slope. Needs rows and
   accelerations at the stage. */
static void mg_differentiate_by_slip_angles(mg_context *c, mg_slip_onset *o, int stage, mg_real t) {
  MG_NEEDS(c, MG_VALID_ROWS, t, mg_stage_state(c, stage)), MG_NEEDS(c, MG_VALID_FREE, t, mg_stage_state(c, stage));
  const mg_real turned = (mg_real)1 / 4096;
  const mg_real *slope = mg_stage_slope(c, stage) + c->system->n_q;
  mg_real *rate = c->step.slopes + (1 + 2 * MG_RADAU_STAGES) * c->layout.n_states, *angle = o->angle[stage], along,
          across[MG_SLIP_UNKNOWNS], turned_across;
  for (int k = 0; k < o->count; k++) mg_resolve_slip_components(c, o, k, angle[k], 1, &along, across + k);
  for (int j = 0; j < o->count; j++) {
    const mg_real kept = angle[j];
    angle[j] = kept + turned;
    mg_slope_with_slip_directions(c, o, t, mg_stage_state(c, stage), angle, rate);
    angle[j] = kept;
    for (int i = 0; i < c->system->n_u; i++)
      mg_angle_slope(c, stage, j)[i] = (rate[c->system->n_q + i] - slope[i]) / turned;
    for (int k = 0; k < o->count; k++) {
      mg_resolve_slip_components(c, o, k, angle[k], 1, &along, &turned_across);
      o->stiffness[stage][k][j] = (turned_across - across[k]) / turned;
    }
  }
}

/* Evaluate slopes and slip at all stages, and where asked the derivatives by the angles; returns 0 where a slope is not
   finite. */
static int mg_evaluate_slip_stages(mg_context *c, mg_slip_onset *o, mg_real t, mg_real h, int differentiate) {
  c->step.sign_changed = 0;
  for (int stage = 0; stage < MG_RADAU_STAGES; stage++) {
    const mg_real time = t + mg_stage_time(stage) * h;
    mg_slope_with_slip_directions(c, o, time, mg_stage_state(c, stage), o->angle[stage], mg_stage_slope(c, stage));
    mg_watch_event_signs(c);
    for (int k = 0; k < o->count; k++)
      mg_resolve_slip_components(c, o, k, o->angle[stage][k], 0, &o->along[stage][k], &o->across[stage][k]);
    if (!mg_are_states_finite(c, mg_stage_slope(c, stage))) return 0;
    if (differentiate) mg_differentiate_by_slip_angles(c, o, stage, time);
  }
  return 1;
}

/* Integrate velocities from their slopes, then poses from the new velocities, then the other states, at all stages;
   returns the relative change. */
static mg_real mg_integrate_slip_stages(mg_context *c, mg_real t, const mg_real *x, mg_real h) {
  const int n_q = c->system->n_q, first = n_q + c->system->n_u;
  mg_real *rate = c->step.slopes + (1 + 2 * MG_RADAU_STAGES) * c->layout.n_states;
  mg_real change[3];
  change[0] = mg_integrate_stages(c, x, h, n_q, first);
  for (int stage = 0; stage < MG_RADAU_STAGES; stage++) {
    const mg_real time = t + mg_stage_time(stage) * h;
    mg_update_poses(c, time, mg_stage_state(c, stage));
    mg_free_accelerations(c, time, mg_stage_state(c, stage), rate);
    for (int i = 0; i < n_q; i++) mg_stage_slope(c, stage)[i] = rate[i];
  }
  change[1] = mg_integrate_stages(c, x, h, 0, n_q);
  change[2] = mg_integrate_stages(c, x, h, first, c->layout.n_states);
  for (int k = 1; k < 3; k++)
    if (!(change[k] <= change[0])) change[0] = change[k];
  return change[0];
}

/* Newton step for the angles, with which the slopes change; returns its relative effect on the velocities. */
static mg_real mg_newton_slip_angle_step(mg_context *c, mg_slip_onset *o, mg_real h) {
  const int m = o->count, n = m * MG_RADAU_STAGES;
  mg_real A[MG_UNKNOWNS * MG_UNKNOWNS], b[MG_UNKNOWNS], y[MG_UNKNOWNS], scratch[MG_UNKNOWNS], most = 0;
  int order[MG_UNKNOWNS];
  for (int i = 0; i < n; i++) {
    b[i] = -o->across[i / m][i % m];
    for (int j = 0; j < n; j++)
      A[i + n * j] = h * mg_collocation_weight(i / m, j / m) * o->stiffness[j / m][i % m][j % m];
    A[i + n * i] -= o->along[i / m][i % m];
  }
  if (mg_factor_pivoted_qr(n, A, b, order, 0) < n) return MG_MAX;
  mg_solve_least_norm_qr(n, n, A, b, y, scratch);
  for (int i = 0; i < n; i++) {
    const int stage = order[i] / m, k = order[i] % m;
    const mg_real effect = fabs(y[i] * o->stiffness[stage][k][k]) * h / mg_slip_onset_velocity_scale(c, o, k);
    o->angle[stage][k] += y[i];
    for (int row = 0; row < c->system->n_u; row++)
      mg_stage_slope(c, stage)[c->system->n_q + row] += y[i] * mg_angle_slope(c, stage, k)[row];
    if (!(effect <= most)) most = effect;
  }
  return most;
}

/* Set the stages of a step h to motion with the slope at its start, refined by substitution for constant directions;
   returns 0 where it fails. */
static int mg_start_slip_stages(mg_context *c, mg_slip_onset *o, mg_real t, const mg_real *x, mg_real h) {
  for (int stage = 0; stage < MG_RADAU_STAGES; stage++)
    for (int range = 0; range < c->listed.n_range; range++)
      for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++)
        mg_stage_state(c, stage)[i] = x[i] + mg_stage_time(stage) * h * c->step.slopes[i];
  for (int round = 0; round < MG_SLIP_START_ROUNDS; round++)
    if (!mg_evaluate_slip_stages(c, o, t, h, 0) || !(mg_integrate_slip_stages(c, t, x, h) <= MG_MAX)) return 0;
  return 1;
}

/* Set the stages of a step to the motion of the first half of it, continued. */
static void mg_continue_slip_stages(mg_context *c, mg_slip_onset *o, const mg_real *x) {
  mg_make_collocation_interpolant(c, x);
  mg_restrict_stages(c, x, 2);
  for (int k = 0; k < o->count; k++) {
    mg_real angle[MG_RADAU_STAGES];
    for (int stage = 0; stage < MG_RADAU_STAGES; stage++) angle[stage] = o->angle[stage][k];
    mg_resample_stages(angle, 2);
    for (int stage = 0; stage < MG_RADAU_STAGES; stage++) o->angle[stage][k] = angle[stage];
  }
}

/* Iterate the stages of a step h to convergence, with new derivatives by the angles in the rounds 0 and `again`;
   returns 0 where it fails. */
static int mg_solve_slip_stages(mg_context *c, mg_slip_onset *o, mg_real t, const mg_real *x, mg_real h, int again) {
  const mg_real goal = c->settings->tolerance / 100, noise = 4096 * MG_EPS;
  mg_real previous_change = MG_MAX;
  for (int round = 0; round < MG_SLIP_ROUNDS; round++) {
    if (!mg_evaluate_slip_stages(c, o, t, h, round == 0 || round == again)) return 0;
    const mg_real angle_effect = mg_newton_slip_angle_step(c, o, h);
    const mg_real change = mg_integrate_slip_stages(c, t, x, h),
                  last_change = angle_effect > change ? angle_effect : change;
    if (!(angle_effect <= MG_MAX) || !(change <= MG_MAX)) return 0;
    if (last_change <= goal || (round > 3 && last_change >= previous_change / 2 && last_change <= noise)) return 1;
    if (round >= MG_SLIP_TRIAL_ROUNDS &&
        last_change * mg_pow(last_change / previous_change, MG_SLIP_ROUNDS - round) > noise)
      return 0;
    previous_change = last_change;
  }
  return 0;
}

/* True if slip points along its direction at every stage, or, where stiff slip stops within the step h, is slow beside
   what friction across it does in the step: directions are smooth then until the event and past it. Sets the longest
   explicit step that can follow. */
static int mg_is_slip_established(mg_context *c, const mg_slip_onset *o, mg_real h) {
  c->step.slip_limit = MG_MAX;
  for (int k = 0; k < o->count; k++) {
    const int is_stiff = o->constraint[k] >= 0 && c->friction.is_stiff[o->constraint[k]];
    for (int stage = 0; stage < MG_RADAU_STAGES; stage++)
      if (!(o->along[stage][k] > 0) &&
          !(is_stiff && -MG_EXPLICIT_TURN * o->along[stage][k] < h * fabs(o->stiffness[stage][k][k])))
        return 0;
    if (o->constraint[k] >= 0) continue;
    const mg_real step_limit = 2 * o->along[MG_RADAU_STAGES - 1][k] / fabs(o->stiffness[MG_RADAU_STAGES - 1][k][k]);
    if (step_limit < c->step.slip_limit) c->step.slip_limit = step_limit;
  }
  return 1;
}

MG_INTERNAL mg_real mg_take_slip_onset_step(mg_context *c, mg_real t, const mg_real *x, mg_real h) {
  mg_slip_onset onset;
  mg_copy_states(c, x, c->step.end);
  if (!mg_list_slip_onsets(c, &onset) || !mg_start_slip_stages(c, &onset, t, x, h / 2) ||
      !mg_solve_slip_stages(c, &onset, t, x, h / 2, MG_SLIP_STIFFNESS_ROUND))
    return MG_MAX;
  mg_copy_states(c, mg_stage_state(c, MG_RADAU_STAGES - 1), c->step.settled);
  mg_continue_slip_stages(c, &onset, x);
  if (!mg_solve_slip_stages(c, &onset, t, x, h, 0) || !mg_is_slip_established(c, &onset, h)) return MG_MAX;
  mg_make_collocation_interpolant(c, x);
  return c->settings->method == MG_RK4 ? 0 : mg_half_step_difference(c, x, c->step.settled);
}

MG_INTERNAL mg_real mg_take_stiff_slip_step(mg_context *c, mg_real t, const mg_real *x, mg_real h) {
  const mg_real error = mg_take_slip_onset_step(c, t, x, h);
  if (!(error <= MG_MAX / 2) && ++c->step.stiff_failures == MG_STIFF_FAILURES) mg_forget_stiff_slip(c);
  return error;
}
