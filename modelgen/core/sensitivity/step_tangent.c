/* Derivatives over one accepted step: the stages of the method at the states that the step had, each with its
   derivative. Eta follows the poses by the derivative of Newton's step, which at a solution is that of the solution. */
#include <string.h>

#include "sensitivity/sensitivity.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/integrate.h"
#include "integrate/dop853_coefficients.h"

static const int mg_rk4_row[] = {0, 0, 1, 2, 3, 7}, mg_rk4_column[] = {0, 1, 2, 0, 1, 2, 3};
static const mg_real mg_rk4_value[] = {(mg_real)0.5,   (mg_real)0.5,  1, (mg_real)1 / 6, (mg_real)1 / 3,
                                       (mg_real)1 / 3, (mg_real)1 / 6},
                     mg_rk4_time[] = {0, (mg_real)0.5, (mg_real)0.5, 1};

MG_INTERNAL const mg_explicit_method *mg_explicit_method_of(const mg_settings *settings) {
  static const mg_explicit_method rk4 = {4, mg_rk4_row, mg_rk4_column, mg_rk4_value, mg_rk4_time},
                                  dop853 = {12, mg_dop_row, mg_dop_column, mg_dop_value, mg_dop_time};
  return settings->method == MG_RK4 ? &rk4 : &dop853;
}

MG_INTERNAL void mg_combine_stages(const mg_explicit_method *m, int row, int n, long stride, mg_real h,
                                   const mg_real *from, const mg_real *slopes, mg_real *out) {
  const int all[2] = {0, n};
  if (m->row[row + 1] == m->row[row]) mg_copy_reals(out, from, n); /* the first stage */
  else mg_combine_ranges(m, row, slopes, stride, 1, all, from, h, out);
}

MG_INTERNAL void mg_normalise_tangent(const mg_context *c, const mg_real *x, mg_real *dx) {
  for (int b = 0; b < c->system->n_body; b++) {
    if (c->bodies.motion[b] != MG_FREE) continue;
    const mg_real *e = x + c->system->body_q[b] + 3;
    mg_real *de = dx + c->system->body_q[b] + 3, square = 0, along = 0;
    for (int k = 0; k < 4; k++) square += e[k] * e[k], along += e[k] * de[k];
    for (int k = 0; k < 4; k++) de[k] = (de[k] - e[k] * along / square) / sqrt(square);
  }
}

MG_INTERNAL void mg_settle_eta_tangents(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x) {
  const mg_system *system = c->system;
  if (!c->settings->newton || !system->n_eta) return;
  for (int direction = 0; direction < s->directions->n; direction++) {
    mg_real *dx = s->tangent->x + (long)direction * c->layout.n_states;
    mg_place_bodies_tangent(c, s, direction, t, x, dx);
    for (int i = mg_next_row(c, -1); i < system->n_contact; i = mg_next_row(c, i)) {
      const int eta = system->n_q + system->n_u + system->contact_eta[i];
      if (!mg_is_on_feature_pair(c, i) || !c->contacts.n_eta[i]) continue;
      mg_placement_tangent(c, s, direction, i, x + eta);
      for (int k = 0; k < c->contacts.n_eta[i]; k++) dx[eta + k] = s->y_dot[1 + k];
    }
  }
}

/* True if a patch slips whose friction is not differentiated. */
static int mg_has_unknown_patch_slip(const mg_context *c) {
  for (int slot = 0; slot < c->system->n_patch_slot; slot++)
    if (c->run->patch_mode[slot] >= MG_SLIP_ONSET && !mg_is_patch_slip_known(c, slot)) return 1;
  return 0;
}

/* True if a constraint of an active contact has anisotropic friction. */
static int mg_has_anisotropic_friction(const mg_context *c, mg_sensitivity *s) {
  for (int i = mg_next_row(c, -1); c->system->n_friction && i < c->system->n_contact; i = mg_next_row(c, i))
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++)
      if (c->run->active[i] && c->system->friction_body[g] >= 0) {
        s->doubtful = i;
        return 1;
      }
  return 0;
}

/* The first contact that a face rests on, a support point. */
static int mg_first_closed_support(const mg_context *c) {
  for (int i = c->layout.support_begin; i < c->system->n_contact; i++)
    if (c->run->closed[i]) return i;
  return -1;
}

MG_INTERNAL int mg_rests_on_moving_points(const mg_context *c, const mg_sensitivity *s) {
  return mg_first_closed_support(c) >= 0 && mg_has_moving_border(s);
}

/* What of the modes of a step is not differentiated, or 0. */
static int mg_uncertain_modes(mg_context *c, mg_sensitivity *s) {
  s->doubtful = mg_first_closed_support(c);
  if (mg_rests_on_moving_points(c, s)) return MG_BY_BORDER;
  if (mg_has_rolling_start(c)) return MG_BY_ROLLING_START;
  if (mg_has_unknown_patch_slip(c)) return MG_BY_FACES;
  s->doubtful = -1;
  return mg_has_anisotropic_friction(c, s) ? MG_BY_ANISOTROPY : MG_NO_REASON;
}

/* What of a step is not differentiated as it was taken, or 0. */
static int mg_uncertain_step(mg_context *c, mg_sensitivity *s, mg_real h) {
  const int reason = mg_uncertain_modes(c, s);
  if (reason) return reason;
  if (c->settings->method == MG_DOP853 && c->system->n_friction) {
    mg_mark_stiff_slip(c, h);
    if (mg_has_stiff_slip(c)) return MG_BY_STIFF_SLIP;
  }
  return MG_NO_REASON;
}

MG_INTERNAL mg_real mg_slip_of(const mg_context *c, int contact, int constraint) {
  MG_NEEDS_WITH(c, MG_VALID_SLIP, MG_VALID_TWISTS);
  const mg_real *slip = c->rows.d_dot + mg_first_friction_row(c, contact, constraint);
  return sqrt(mg_dot2(slip, slip)) / mg_slip_velocity_tolerance(c, constraint);
}

#define MG_FALLING_PART ((mg_real)0.55) /* more than a step that halves it */

/* Notes slip that falls by more than this part in a step that does not end it: at its end, changes of its direction
   grow so fast that an explicit step of the derivatives is not stable. Needs the velocities of the rows there. */
static void mg_note_falling_slip(const mg_context *c, mg_sensitivity *s, mg_real h) {
  MG_NEEDS_WITH(c, MG_VALID_SLIP, MG_VALID_TWISTS);
  s->slip_end = 0, s->slip_falls = -1;
  for (int i = mg_next_row(c, -1); c->system->n_friction && i < c->layout.support_begin; i = mg_next_row(c, i))
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++) {
      const mg_real slip = s->slip[g] > 0 ? mg_slip_of(c, i, g) : 0, part = 1 - slip / mg_max(s->slip[g], 1);
      if (!(slip > 2) || part < MG_FALLING_PART) continue;
      s->slip_end = c->run->t + h / part, s->slip_falls = g;
    }
}

/* True if a friction constraint or patch slips, or begins to. */
static int mg_has_slip_mode(const mg_context *c) {
  for (int g = mg_next_constraint(c, -1); g < c->system->n_friction; g = mg_next_constraint(c, g))
    if (c->run->friction_mode[g] >= MG_SLIP_ONSET) return 1;
  for (int slot = 0; slot < c->system->n_patch_slot; slot++)
    if (c->run->patch_mode[slot] >= MG_SLIP_ONSET) return 1;
  return 0;
}

/* Marks the constraints whose slip begins in this step, and has no direction of its own yet. Needs the rows at the
   run's state where anything slips. Returns whether there are any. */
static int mg_mark_beginning_slip(mg_context *c, mg_sensitivity *s) {
  const int n = c->system->n_friction + c->system->n_patch_slot;
  int any = 0;
  for (int g = 0; g < n; g++) s->slip[g] = 0, s->slip_begins[g] = 0;
  if (!mg_has_slip_mode(c)) return 0;
  MG_NEEDS_AT_RUN(c, MG_VALID_ROWS);
  mg_update_gap_rates(c);
  for (int i = mg_next_row(c, -1); c->system->n_friction && i < c->layout.support_begin; i = mg_next_row(c, i))
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++) {
      const int mode = c->run->friction_mode[g];
      if (c->run->active[i] && mode == MG_SLIPPING && mg_friction_row_count(c, g) == 2)
        s->slip[g] = mg_slip_of(c, i, g);
      s->slip_begins[g] = c->run->active[i] && mg_friction_row_count(c, g) == 2 &&
                          (mode == MG_SLIP_ONSET || mode == MG_SLIP_STARTING) &&
                          !mg_is_turned_by_slip(c, g, c->rows.d_dot + mg_first_friction_row(c, i, g));
      any |= s->slip_begins[g];
    }
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    if (c->run->patch_mode[slot] == MG_SLIPPING)
      s->slip[c->system->n_friction + slot] = mg_patch_slip_along_direction(c, slot, c->rows.d_dot);
    any |= s->slip_begins[c->system->n_friction + slot] = c->run->patch_mode[slot] == MG_SLIP_STARTING;
  }
  return any;
}

/* True if slip that has begun in this step turns with a direction: then its first direction, a limit, has a derivative
   that the step does not have. Needs the derivatives of that direction at the end of the step;
   `least`: of rates that are not rounding. */
static int mg_turns_slip_onset(const mg_context *c, mg_sensitivity *s, mg_real least) {
  MG_NEEDS_AT(c, MG_VALID_FORCES, c->step.end), MG_NEEDS_WITH(c, MG_VALID_SLIP, MG_VALID_TWISTS);
  MG_NEEDS_TANGENT(c, s, MG_VALID_TANGENTS, MG_VALID_FORCES, MG_ANY_DIRECTION, MG_NO_ROW);
  for (int i = mg_next_row(c, -1); c->system->n_friction && i < c->layout.support_begin; i = mg_next_row(c, i))
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++) {
      const int row = mg_first_friction_row(c, i, g);
      if (!s->slip_begins[g]) continue;
      const mg_real *slip = c->rows.d_dot + row, *dot = s->at.rate + row;
      const mg_real across = fabs(slip[0] * dot[1] - slip[1] * dot[0]),
                    size = sqrt(mg_dot2(slip, slip) * mg_dot2(dot, dot));
      if (!(across > sqrt(MG_EPS) * size) || !(mg_dot2(dot, dot) > least * least)) continue;
      s->doubtful = i;
      return 1;
    }
  return 0;
}

/* The same of a patch: slip along t1 and t2, and spin as slip at the distance of its supports. */
static int mg_turns_patch_slip_onset(const mg_context *c, mg_sensitivity *s, mg_real least) {
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    if (!s->slip_begins[c->system->n_friction + slot]) continue;
    const int row = mg_first_patch_friction_row(c, slot);
    const mg_real radius = mg_support_radius(c, slot), *slip = c->rows.d_dot + row, *dot = s->at.rate + row;
    const mg_real v[3] = {slip[0], slip[1], radius * slip[2]}, v_dot[3] = {dot[0], dot[1], radius * dot[2]};
    mg_real across[3];
    mg_cross_product(v, v_dot, across);
    const mg_real change = mg_dot3(v_dot, v_dot);
    if (!(mg_dot3(across, across) > MG_EPS * mg_dot3(v, v) * change) || !(change > least * least)) continue;
    s->doubtful = mg_first_support(c, slot);
    return 1;
  }
  return 0;
}

/* Evaluates the state of the run, and lets slip begin as at the start of its step. */
static void mg_begin_step_again(mg_context *c) {
  mg_evaluate_run_state(c);
  if (c->system->n_friction) mg_begin_step_friction(c), mg_begin_step_patch_friction(c);
}

/* End of the step from the slopes of the stages. */
static void mg_end_step_again(mg_context *c, const mg_explicit_method *method, mg_real h) {
  mg_combine_stages(method, method->stages, c->layout.n_states, c->layout.n_states, h, c->run->x, c->step.slopes,
                    c->step.end);
}

/* Settles the end of the step, and evaluates its right-hand side. */
static void mg_settle_step_end(mg_context *c, mg_sensitivity *s, mg_real t) {
  mg_normalise_quaternions(c, c->step.end);
  mg_place_all_contacts(c, t, c->step.end);
  mg_settle_eta_tangents(c, s, t, c->step.end);
  mg_right_hand_side(c, t, c->step.end, s->slope_before);
  mg_update_gap_rates(c);
  mg_gather_wrenches(c, s, t);
}

MG_INTERNAL void mg_restore_step(mg_context *c, mg_sensitivity *s, mg_real h, const mg_real *slopes) {
  const mg_explicit_method *method = mg_explicit_method_of(c->settings);
  mg_begin_step_again(c);
  for (long i = 0; i < (long)method->stages * c->layout.n_states; i++) c->step.slopes[i] = slopes[i];
  mg_end_step_again(c, method, h);
  mg_settle_step_end(c, s, c->run->t + h);
}

/* Derivatives of the state of a stage, or of the end before its quaternions are normalised. */
static void mg_combine_tangents(const mg_context *c, const mg_sensitivity *s, const mg_explicit_method *method,
                                int stage, int direction, mg_real h, mg_real *out) {
  const long states = c->layout.n_states, n = s->directions->n;
  mg_combine_stages(method, stage, (int)states, n * states, h, s->tangent->x + direction * states,
                    s->slopes + direction * states, out);
}

/* Derivatives of the slope of the stage of which mg_stage_right_hand_side has been evaluated. */
static void mg_stage_tangent(mg_context *c, mg_sensitivity *s, const mg_explicit_method *method, int is_composed,
                             int stage, mg_real t, mg_real h) {
  const int n = s->directions->n, states = c->layout.n_states;
  if (!is_composed) mg_gather_wrenches(c, s, t);
  c->lcp.keeps_matrix = c->lcp.n_assembled == 1 && !c->friction.slips;
  for (int j = 0; j < n; j++) {
    mg_combine_tangents(c, s, method, stage, j, h, s->stage);
    mg_real *slope = s->slopes + ((long)stage * n + j) * states;
    if (is_composed) mg_scene_tangent(c, s, j, c->step.stage, s->stage, slope);
    else mg_slope_tangent(c, s, j, t, c->step.stage, s->stage, slope);
  }
  c->lcp.keeps_matrix = 0;
}

/* Derivatives of the end of the step from those of its stages; writes the slopes of these to the tape, if there is one.
 */
static void mg_end_stages(const mg_context *c, mg_sensitivity *s, const mg_explicit_method *method, mg_real h) {
  const mg_tape *tape = s->tangent->tape;
  const long n = MG_SLOPES_KEPT * (long)c->layout.n_states;
  for (int j = 0; j < s->directions->n; j++)
    mg_combine_tangents(c, s, method, method->stages, j, h, s->end + (long)j * c->layout.n_states);
  if (tape) memcpy(tape->slopes + n * tape->count, c->step.slopes, (size_t)n * sizeof(mg_real));
}

/* Evaluates the state of the run as the first stage of a step; leaves the count of evaluations. */
static void mg_evaluate_first_stage(mg_context *c, mg_real *slope) {
  const long evaluations = c->run->rhs_evals;
  mg_right_hand_side(c, c->run->t, c->run->x, slope);
  mg_update_gap_rates(c);
  c->run->rhs_evals = evaluations;
}

MG_INTERNAL void mg_follow_stage(mg_context *c, void *of, int is_composed, int stage, mg_real t, mg_real h) {
  mg_sensitivity *s = of;
  const mg_explicit_method *method = mg_explicit_method_of(c->settings);
  if (stage == method->stages) {
    mg_copy_states(c, c->step.end, s->before), mg_end_stages(c, s, method, h);
    return;
  }
  if (!stage) {
    mg_copy_states(c, c->run->x, c->step.stage);
    if (!is_composed) mg_evaluate_first_stage(c, s->slope_before);
    s->step.is_uncertain = mg_uncertain_modes(c, s) || mg_mark_beginning_slip(c, s);
  }
  mg_stage_tangent(c, s, method, is_composed, stage, t, h);
}

/* Takes the stages of a step again. */
static void mg_step_tangent_again(mg_context *c, mg_sensitivity *s, const mg_explicit_method *method, mg_real h) {
  const int states = c->layout.n_states, is_composed = mg_is_in_mode_of_scene_rhs(c);
  for (int stage = 0; stage < method->stages; stage++) {
    const mg_real t = c->run->t + method->time[stage] * h;
    mg_combine_stages(method, stage, states, states, h, c->run->x, c->step.slopes, c->step.stage);
    if (c->settings->newton > 1) mg_place_all_contacts(c, t, c->step.stage);
    mg_stage_right_hand_side(c, is_composed, t, c->step.stage, c->step.slopes + (long)stage * states);
    mg_stage_tangent(c, s, method, is_composed, stage, t, h);
  }
  mg_end_step_again(c, method, h);
  mg_end_stages(c, s, method, h);
}

/* True if the stages of the step of length h up to or from t have been followed. */
static int mg_is_followed(const mg_sensitivity *s, mg_real t, mg_real h) {
  return fabs(s->follower.h - h) <= 8 * MG_EPS * (fabs(t) + h);
}

/* Takes the derivatives at the end of the step, of which `end` has the quaternions before they are normalised. */
static void mg_take_end_tangents(const mg_context *c, mg_sensitivity *s, const mg_real *end) {
  const long states = c->layout.n_states, n = s->directions->n;
  memcpy(s->tangent->x, s->end, (size_t)(n * states) * sizeof(mg_real));
  for (int j = 0; j < n; j++) mg_normalise_tangent(c, end, s->tangent->x + j * states);
}

MG_INTERNAL int mg_settle_followed_step(mg_context *c, mg_sensitivity *s, mg_real h) {
  if (!mg_is_followed(s, c->run->t, h) || s->step.is_uncertain || mg_has_unknown_patch_slip(c)) return 0;
  mg_note_falling_slip(c, s, h);
  if (s->slip_end > 0) return 0;
  if (mg_has_load_jump(c, s, c->run->t, c->run->x, c->step.slopes, h)) return 0;
  mg_take_end_tangents(c, s, s->before);
  mg_settle_eta_tangents(c, s, c->run->t, c->run->x);
  mg_mark_held_contacts(c, s, 0);
  mg_project_tangents(c, s, c->run->t, c->run->x);
  return 1;
}

MG_INTERNAL int mg_step_tangent(mg_context *c, mg_sensitivity *s, mg_real h) {
  const mg_explicit_method *method = mg_explicit_method_of(c->settings);
  const int n = s->directions->n, states = c->layout.n_states;
  const mg_real t = c->run->t;
  const int is_followed = mg_is_followed(s, t, h);
  if (!is_followed || mg_has_slip_mode(c)) mg_begin_step_again(c);
  int reason = mg_uncertain_step(c, s, h);
  const int slip_begins = mg_mark_beginning_slip(c, s);
  if (is_followed) mg_copy_states(c, s->before, c->step.end);
  else mg_step_tangent_again(c, s, method, h);
  mg_take_end_tangents(c, s, c->step.end);
  mg_settle_step_end(c, s, t + h);
  mg_note_falling_slip(c, s, h);
  if (!reason && mg_has_load_jump(c, s, t + h, c->step.end, s->slope_before, h)) reason = MG_BY_LOAD;
  if (!reason && mg_has_unknown_patch_slip(c)) reason = MG_BY_FACES, s->doubtful = mg_first_closed_support(c);
  for (int j = 0; j < n && !reason && slip_begins; j++) {
    mg_rhs_tangent(c, s, j, t + h, c->step.end, s->tangent->x + (long)j * states, s->stage);
    const mg_real least = MG_ROUNDED_TANGENT * s->size[j] * c->system->length / c->system->time;
    if (mg_turns_slip_onset(c, s, least) || mg_turns_patch_slip_onset(c, s, least)) reason = MG_BY_SLIP_ONSET;
  }
  return reason;
}

MG_INTERNAL void mg_add_correction(const mg_context *c, const mg_real *x, int of_velocities, mg_real *dx) {
  const mg_system *system = c->system;
  for (int b = 0; b < system->n_body; b++) {
    if (!mg_is_moved_by_forces(c, b)) continue;
    const mg_real *change = c->bodies.wrench + 6 * b;
    const int q = system->body_q[b], u = system->n_q + system->body_u[b];
    mg_real turned[4];
    for (int k = 0; of_velocities && k < c->kernels->body_kinds[mg_body_kind_of(c, b)].n_u; k++) dx[u + k] += change[k];
    if (of_velocities) continue;
    for (int k = 0; k < 3; k++) dx[q + k] += change[k];
    if (c->bodies.motion[b] != MG_FREE) continue;
    for (int k = 0; k < 4; k++) turned[k] = x[q + 3 + k];
    mg_rotate_quaternion(turned, change + 3);
    for (int k = 0; k < 4; k++) dx[q + 3 + k] += turned[k] - x[q + 3 + k];
  }
}

/* True if a joint or a closed contact holds bodies. */
static int mg_has_held_bodies(const mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->run->closed[i]) return 1;
  return c->system->n_joint_row > 0;
}

MG_INTERNAL void mg_mark_held_contacts(const mg_context *c, mg_sensitivity *s, int is_start) {
  const mg_run *run = c->run;
  for (int i = 0; i < c->system->n_contact; i++)
    s->held[i] = run->closed[i] && (is_start || run->active[i] || run->rolling_start[i]);
}

MG_INTERNAL void mg_project_tangents(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x) {
  MG_NEEDS(c, MG_VALID_FORCES, t, x);
  if (!c->settings->project) return;
  const int n = mg_has_held_bodies(c) ? s->directions->n : 0;
  c->lcp.n_assembled = 0;
  for (int j = 0; j < n; j++) {
    mg_real *dx = s->tangent->x + (long)j * c->layout.n_states;
    mg_rows_tangent(c, s, j, t, x, dx, s->held, s->stage);
    mg_solve_row_correction(c, s->held, s->at.value);
    c->lcp.keeps_matrix = c->lcp.n_assembled == 1;
    mg_add_correction(c, x, 0, dx);
    mg_solve_row_correction(c, s->held, s->at.rate);
    mg_add_correction(c, x, 1, dx);
  }
  c->lcp.keeps_matrix = 0;
  mg_zero_reals(c->bodies.wrench, 6L * c->system->n_body);
  mg_settle_eta_tangents(c, s, t, x);
}

MG_INTERNAL int mg_has_moving_border(const mg_sensitivity *s) {
  for (int j = 0; j < s->directions->n; j++)
    if (s->directions->moves_borders && s->directions->moves_borders[j]) return 1;
  return 0;
}
