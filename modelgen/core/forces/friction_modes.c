/* Friction modes: which closed contacts carry force and which of their friction constraints stick or slip, by
   Coulomb's law for accelerations. Slip that is under way determines its force; the other groups are bounded by
   the static cone, or by the kinetic cone once they slip. Redundant forces are selected by least norm. Writes the
   active set, the friction modes, slip directions and reference forces of the run, slip directions and modes also at
   the start of a step; removes residual slip of sticking rows from its velocities. */
#include "forces/forces.h"
#include "base/base.h"
#include "solve/friction/friction_solvers.h"
#include "model/model.h"

/* Time in s until slip stops at its present deceleration; 0 if it has stopped. */
static mg_real mg_slip_stop_time(const mg_context *c, int contact, int constraint) {
  const mg_real *direction = c->run->slip_direction + 3 * constraint, *t = c->rows.tangents + 6 * contact;
  const int row = mg_first_friction_row(c, contact, constraint),
            spins = c->system->friction_kind[constraint] == MG_FRICTION_SPIN;
  mg_real slip[2], braking = -mg_row_acceleration(c, row) * (spins ? direction[0] : mg_dot3(t, direction));
  if (!spins) braking -= mg_row_acceleration(c, row + 1) * mg_dot3(t + 3, direction);
  const mg_real along = mg_slip_along_direction(c, contact, constraint, slip);
  return along > 0 && braking > 0 ? along / braking : 0;
}

/* Magnitude of the slip of a friction constraint. */
static mg_real mg_slip_magnitude(const mg_context *c, int contact, int constraint) {
  mg_real slip[2];
  mg_slip_along_direction(c, contact, constraint, slip);
  return sqrt(slip[0] * slip[0] + slip[1] * slip[1]);
}

/* Set the slip direction of a friction constraint along its slip, world axes. */
static void mg_set_slip_direction(mg_context *c, int contact, int constraint) {
  const mg_real *t = c->rows.tangents + 6 * contact, size = mg_slip_magnitude(c, contact, constraint);
  mg_real slip[2], *direction = c->run->slip_direction + 3 * constraint;
  mg_slip_along_direction(c, contact, constraint, slip);
  for (int k = 0; k < 3; k++) direction[k] = (slip[0] * t[k] + slip[1] * t[3 + k]) / size;
  if (c->system->friction_kind[constraint] == MG_FRICTION_SPIN) direction[0] = slip[0] > 0 ? 1 : -1;
}

/* Set the slip direction of a friction constraint; returns 0 where it hardly slips. */
static int mg_update_slip_direction(mg_context *c, int contact, int constraint) {
  if (!(mg_slip_magnitude(c, contact, constraint) > 2 * mg_slip_velocity_tolerance(c, constraint))) return 0;
  mg_set_slip_direction(c, contact, constraint);
  return 1;
}

/* Set the friction mode of a friction constraint from its slip velocity before the mode problem is solved: one that
   hardly slips is taken as sticking, because slip that starts or ends at one contact may start or end at others of the
   same body. */
static void mg_initialise_friction_mode(mg_context *c, int contact, int constraint) {
  const int mode = c->run->friction_mode[constraint];
  if (!c->run->closed[contact]) mg_set_friction_mode(c, constraint, MG_FRICTION_OFF);
  else if (mode == MG_FRICTION_OFF && mg_update_slip_direction(c, contact, constraint))
    mg_set_friction_mode(c, constraint, MG_SLIPPING);
  else if (mode >= MG_SLIP_ONSET) {
    const int slips = mg_update_slip_direction(
        c, contact, constraint); /* if its event has triggered, only its direction has changed */
    if (c->friction.triggered[constraint] && !slips)
      c->friction.slip_time_left[constraint] = mg_slip_stop_time(c, contact, constraint);
    mg_set_friction_mode(c, constraint, slips ? MG_SLIPPING : MG_STICKING), c->friction.triggered[constraint] &= !slips;
  }
}

/* Kinetic energy in J that the velocity correction of the first n listed rows removes. */
static mg_real mg_correction_energy_loss(const mg_context *c, int n) {
  mg_real sum = 0;
  for (int r = 0; r < n; r++) sum -= c->solution.impulse[c->lcp.rows[r]] * c->rows.d_dot[c->lcp.rows[r]] / 2;
  return sum;
}

/* Let the sticking friction constraint with the largest slip, relative to its tolerance, go on slipping; returns 0 if
   none sticks. */
static int mg_release_fastest_sticking(mg_context *c) {
  mg_real most = 0;
  int contact = -1, fastest = -1;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++) {
      if (!c->run->active[i] || c->run->friction_mode[g] != MG_STICKING) continue;
      const mg_real size = mg_slip_magnitude(c, i, g) / mg_slip_velocity_tolerance(c, g);
      if (size > most) most = size, contact = i, fastest = g;
    }
  if (fastest < 0) return 0;
  mg_set_slip_direction(c, contact, fastest);
  mg_set_friction_mode(c, fastest, MG_SLIP_STARTING);
  return 1;
}

/* Remove the residual slip of sticking rows by an impulse; where that would remove much more energy than so slow
   a slip has, let the fastest slip on. */
static void mg_remove_sticking_slip(mg_context *c) {
  const mg_real fast =
      c->settings->slip_stop_speed_ratio * c->settings->slip_speed * c->system->length / c->system->time;
  do {
    mg_real worst = 0;
    const int n = mg_append_sticking_rows(c, c->lcp.rows, 0);
    for (int r = 0; r < n; r++)
      if (fabs(c->rows.d_dot[c->lcp.rows[r]]) > worst) worst = fabs(c->rows.d_dot[c->lcp.rows[r]]);
    if (!(worst > c->settings->drift_tolerance * c->system->length / c->system->time)) return;
  } while (mg_correction_energy_loss(c, mg_solve_row_correction(c, c->run->closed, c->rows.d_dot)) >
               c->system->mass * fast * fast / 2 &&
           mg_release_fastest_sticking(c));
  mg_apply_velocity_correction(c);
  mg_evaluate_run_state(c);
}

/* Deactivate all contacts and evaluate rows and accelerations without contact forces. */
static void mg_deactivate_all_contacts(mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) mg_set_active(c, i, 0);
  mg_evaluate_run_state(c);
}

/* Set the friction force ratios of slip that is under way at one contact that carries no force yet, and M^-1 J^T
   of its rows. */
static void mg_set_contact_force_ratios(mg_context *c, int contact) {
  for (int g = c->system->contact_friction[contact]; g < c->system->contact_friction[contact + 1]; g++) {
    if (c->friction.bound[g] != MG_BOUND_SLIP) continue;
    mg_set_slip_force_ratio(c, contact, g);
    for (int k = 0; k < mg_friction_row_count(c, g); k++)
      mg_update_inverse_mass_row(c, mg_first_friction_row(c, contact, g) + k);
  }
}

/* Assemble matrix and right-hand side of the friction problem of accelerations: closed contacts that `skip` does
   not mark, then supports, joints and sticking patches. */
static mg_friction_problem mg_assemble_friction_problem(mg_context *c, const int *skip) {
  mg_friction_problem p = {
      0,        0,        MG_COULOMB, 1, c->friction.cone_first, c->friction.cone_rows,        c->friction.cone,
      c->lcp.A, c->lcp.b, 0,          0, c->run->stop,           c->settings->sweep_from_last, 0,
      0};
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    if (c->run->closed[i] && !skip[i]) p.n = mg_append_friction_contact(c, i, p.n_contact++, p.n);
  mg_activate_supports(c);
  p.n = mg_append_sticking_patch_rows(c, c->lcp.rows, mg_append_bilateral_rows(c, c->lcp.rows, p.n));
  mg_assemble_delassus(c, c->lcp.rows, p.n);
  for (int k = 0; k < p.n_contact; k++) mg_set_contact_force_ratios(c, c->friction.cone_contact[k]);
  mg_set_patch_force_ratios(c);
  mg_couple_slip_to_normal_columns(c, c->lcp.rows, p.n);
  for (int r = 0; r < p.n; r++) c->lcp.b[r] = mg_row_imbalance(c, c->lcp.rows[r]);
  return p;
}

/* Record the first contact whose sliding friction makes the problem indeterminate (Painleve): its own matrix
   entry is negative while its gap accelerates apart without force. */
static void mg_note_painleve_paradox(mg_context *c, const mg_friction_problem *p) {
  for (int k = 0; k < p->n_contact; k++) {
    const int first = p->first[k];
    if (p->A[first * (p->n + 1)] < 0 && p->b[first] > mg_acceleration_tolerance(c)) {
      mg_report_painleve_paradox(c->run, mg_told_contact(c->system, c->run, c->friction.cone_contact[k]));
      return;
    }
  }
}

/* Solve the friction problem with all friction coefficients multiplied by `part`; returns 1 if it was solved. */
static int mg_solve_with_friction_cones(mg_context *c, const mg_friction_problem *p, mg_real part, mg_real *z,
                                        mg_friction_report *report) {
  mg_friction_problem bounded = *p;
  bounded.newton_max = mg_affordable_factorisations(c, p->n);
  mg_report_friction_solve(c->run, MG_COULOMB);
  for (int k = 0; k < p->n_contact; k++)
    mg_set_friction_cone(c, c->friction.cone_contact[k], part, c->friction.cone + MG_CONE * k);
  for (int r = 0; r < p->n; r++) z[r] = 0;
  const int outcome = mg_solve_friction_with_bilaterals(c, &bounded, z, report);
  mg_count_friction_solve(c, p->n, report);
  MG_NOTE_DIGEST(c, MG_VALID_MARKS, mg_solution_digest(c, p, z));
  return outcome == MG_FRICTION_SOLVED;
}

/* Acceleration of one row under the forces z: (A z + b)_row. */
static mg_real mg_resulting_row_acceleration(const mg_friction_problem *p, const mg_real *z, int row) {
  mg_real sum = p->b[row];
  for (int j = 0; j < p->n; j++) sum += p->A[row + p->n * j] * z[j];
  return sum;
}

/* Acceleration below which a row counts as at rest, given the residual of the friction solver. */
static mg_real mg_acceleration_noise_bound(const mg_context *c, const mg_friction_problem *p) {
  mg_real size = 0;
  for (int r = 0; r < p->n; r++)
    if (fabs(p->b[r]) > size) size = fabs(p->b[r]);
  return 10 * c->settings->friction_bound_margin * size;
}

/* True if the friction force of a friction constraint of contact k is on its bound and its rows accelerate, so that it
   slips. */
static int mg_is_at_friction_bound(const mg_context *c, const mg_friction_problem *p, int k, int constraint) {
  const int first = p->first[k], row = first + 1 + c->system->friction_row[constraint],
            friction_kind = c->system->friction_kind[constraint];
  const mg_real *cone = p->cone + MG_CONE * k + mg_cone_index_of_kind(friction_kind), N = c->lcp.z[first];
  mg_real row_motion = 0, bound_effect = 0, scaled_square = 0;
  if (!(c->friction.marks[k] & MG_MARK_FORCE)) return 0;
  for (int j = 0; j < mg_friction_row_count(c, constraint); j++) {
    const mg_real mu = cone[friction_kind == MG_FRICTION_SLIP ? j : 0], scaled_force = c->lcp.z[row + j] / mu;
    row_motion += fabs(mg_resulting_row_acceleration(p, c->lcp.z, row + j)),
        bound_effect += fabs(p->A[(row + j) * (p->n + 1)]) * mu * N, scaled_square += scaled_force * scaled_force;
  }
  return row_motion > c->settings->friction_bound_margin / 10 * bound_effect &&
         sqrt(scaled_square) > (1 - c->settings->event_correction_step) * N;
}

/* Mark the friction constraints that the solution lets slip; returns their number. */
static int mg_mark_yielding_friction(mg_context *c, const mg_friction_problem *p) {
  int count = 0;
  for (int k = 0; k < p->n_contact; k++) {
    const int i = c->friction.cone_contact[k];
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++)
      count += c->friction.is_yielding[g] =
          c->friction.bound[g] != MG_BOUND_SLIP && mg_is_at_friction_bound(c, p, k, g);
  }
  return count;
}

MG_INTERNAL int mg_use_kinetic_bounds(mg_context *c, int n, const int *contacts) {
  int count = 0;
  for (int k = 0; k < n; k++)
    for (int g = c->system->contact_friction[contacts[k]]; g < c->system->contact_friction[contacts[k] + 1]; g++) {
      const mg_real *s = c->system->friction_static + 2 * g, *d = c->system->friction_kinetic + 2 * g;
      if (!c->friction.is_yielding[g] || c->friction.bound[g] == MG_BOUND_KINETIC) continue;
      c->friction.bound[g] = MG_BOUND_KINETIC;
      count += s[0] != d[0] || s[1] != d[1];
    }
  return count;
}

/* Set the direction in which slip starts: against the friction force, by the associated flow rule of its elliptic
   cone. */
static void mg_set_slip_direction_from_force(mg_context *c, int contact, int constraint, const mg_real *force) {
  const mg_real *mu = c->system->friction_kinetic + 2 * constraint, *t = c->rows.tangents + 6 * contact;
  const mg_real a = -force[0] / (mu[0] * mu[0]),
                b = mg_friction_row_count(c, constraint) == 2 ? -force[1] / (mu[1] * mu[1]) : 0;
  const mg_real size = sqrt(a * a + b * b);
  mg_real *direction = c->run->slip_direction + 3 * constraint;
  for (int k = 0; k < 3; k++) direction[k] = (a * t[k] + b * t[3 + k]) / size;
  if (c->system->friction_kind[constraint] == MG_FRICTION_SPIN) direction[0] = a > 0 ? 1 : -1;
}

/* True if slip starts without a jump of the force: the group was sticking, and its static and kinetic
   coefficients are equal. */
static int mg_is_continuous_slip_onset(const mg_context *c, int constraint) {
  const mg_real *s = c->system->friction_static + 2 * constraint, *d = c->system->friction_kinetic + 2 * constraint;
  return c->friction.mode_before[constraint] == MG_STICKING && s[0] == d[0] && s[1] == d[1] &&
         mg_friction_row_count(c, constraint) == 2;
}

/* Store the active contacts and the friction modes of the solved problem in the run. */
static void mg_store_friction_modes(mg_context *c, const mg_friction_problem *p) {
  for (int k = 0; k < p->n_contact; k++) {
    const int i = c->friction.cone_contact[k];
    mg_set_active(c, i, (c->friction.marks[k] & MG_MARK_FORCE) != 0);
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++) {
      if (!c->friction.is_yielding[g]) continue;
      mg_set_slip_direction_from_force(c, i, g, c->lcp.z + c->friction.cone_first[k] + 1 + c->system->friction_row[g]);
      mg_set_friction_mode(c, g, mg_is_continuous_slip_onset(c, g) ? MG_SLIP_ONSET : MG_SLIP_STARTING);
    }
  }
}

/* Store the solution, added to the forces that the joints carry without contacts, as the reference forces that
   select one of many redundant solutions. */
static void mg_store_reference_forces(mg_context *c, const mg_friction_problem *p) {
  for (int i = mg_next_row(c, -1); i < c->layout.friction_row_end; i = mg_next_row(c, i))
    c->run->reference_force[i] = 0;
  for (int r = 0; r < p->n; r++)
    c->run->reference_force[c->lcp.rows[r]] = c->solution.force[c->lcp.rows[r]] + c->lcp.z[r];
  c->run->forces_redundant = 1;
}

/* True if all active contacts are compressed and all sticking friction is within its bounds. */
static int mg_has_admissible_forces(const mg_context *c) {
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    if (!c->run->active[i]) continue;
    if (!(c->solution.force[i] > 0)) return 0;
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++)
      if (c->run->friction_mode[g] == MG_STICKING &&
          !(mg_friction_event_value(c, i, g) > c->settings->friction_bound_margin * c->solution.force[i]))
        return 0;
  }
  return 1;
}

/* Try forces of least norm on all contacts that do not accelerate apart; where these are not admissible, restore
   the active contacts and return 0. */
static int mg_try_least_norm_forces(mg_context *c, const mg_friction_problem *p) {
  for (int k = 0; k < p->n_contact; k++)
    if (mg_resulting_row_acceleration(p, c->lcp.z, c->friction.cone_first[k]) < mg_acceleration_noise_bound(c, p))
      c->run->active[c->friction.cone_contact[k]] = 1;
  c->run->forces_redundant = 0;
  mg_evaluate_run_state(c);
  if (mg_has_admissible_forces(c)) return 1;
  for (int k = 0; k < p->n_contact; k++)
    c->run->active[c->friction.cone_contact[k]] = (c->friction.marks[k] & MG_MARK_FORCE) != 0;
  c->run->forces_redundant = 1;
  return 0;
}

/* Search forces that keep all friction sticking well within its bounds, by solving with smaller coefficients;
   keeps all contacts active where there are none. */
static void mg_try_reduced_friction_bounds(mg_context *c, const int *skip) {
  mg_friction_report report;
  const mg_friction_problem p = mg_assemble_friction_problem(c, skip);
  for (mg_real bound_reduction = (mg_real)0.5; bound_reduction > c->settings->friction_bound_margin;
       bound_reduction /= 4) {
    if (!mg_solve_with_friction_cones(c, &p, 1 - bound_reduction, c->lcp.z, &report) ||
        mg_mark_yielding_friction(c, &p))
      continue;
    mg_store_friction_modes(c, &p);
    mg_store_reference_forces(c, &p);
    return;
  }
  for (int k = 0; k < p.n_contact; k++) c->run->active[c->friction.cone_contact[k]] = 1;
}

/* Select one of the force solutions that produce the same motion. Needs the friction problem as it was solved. */
static void mg_resolve_redundant_forces(mg_context *c, const int *skip, const mg_friction_problem *p,
                                        int yielding_count) {
  MG_NEEDS_DIGEST(c, MG_VALID_MARKS, mg_solution_digest(c, p, c->lcp.z));
  mg_store_reference_forces(c, p);
  if (mg_try_least_norm_forces(c, p) || yielding_count) return;
  mg_deactivate_all_contacts(c);
  mg_try_reduced_friction_bounds(c, skip);
}

/* Record redundancy and residual of the friction solution in the statistics of the run. A direction of slip that joints
   hold, as across the plane of a planar body, needs no friction and counts for none. */
static void mg_record_friction_report(mg_context *c, const mg_friction_problem *p, const mg_friction_report *report,
                                      int dependent_joint_rows) {
  int redundant = report->active - report->rank - dependent_joint_rows;
  if (redundant > 0) redundant -= mg_count_held_slip(c, p, c->lcp.z);
  c->run->friction_redundant = redundant > 0;
  mg_report_redundancy(c->run, redundant);
  mg_report_residual(c->run, report->residual);
}

MG_INTERNAL int mg_solve_friction_modes(mg_context *c, const int *skip) {
  MG_NEEDS_AT_RUN(c, MG_VALID_TWISTS);
  mg_friction_report report = {0};
  int yielding_count, redundant, dependent_joint_rows = 0;
  mg_update_gap_rates(c); /* an impact may have changed the twists */
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++)
      mg_initialise_friction_mode(c, i, g), c->friction.is_yielding[g] = 0;
  mg_remove_sticking_slip(c);
  mg_set_friction_bound_kinds(c);
  mg_deactivate_all_contacts(c);
  c->run->friction_redundant = 0;
  if (c->system->n_joint_row) dependent_joint_rows = mg_count_dependent_joint_rows(c);
  const mg_friction_problem p = mg_assemble_friction_problem(c, skip);
  if (p.n_contact == 0) {
    mg_evaluate_run_state(c);
    return MG_DONE;
  }
  redundant = mg_unsymmetric_rank(c, c->lcp.rows, p.n) < p.n - dependent_joint_rows;
  do {
    if (!mg_solve_with_friction_cones(c, &p, redundant ? 1 - c->settings->friction_bound_margin : 1, c->lcp.z, &report))
      return mg_is_mode_choice_too_costly(c) ? MG_CHATTER : MG_NO_FRICTION;
    yielding_count = mg_mark_yielding_friction(c, &p);
  } while (mg_use_kinetic_bounds(c, p.n_contact, c->friction.cone_contact));
  mg_record_friction_report(c, &p, &report, dependent_joint_rows);
  mg_note_painleve_paradox(c, &p);
  mg_store_friction_modes(c, &p);
  c->run->forces_redundant = 0;
  if (redundant) mg_resolve_redundant_forces(c, skip, &p, yielding_count);
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    for (int g = c->system->contact_friction[i]; !c->run->active[i] && g < c->system->contact_friction[i + 1]; g++)
      mg_set_friction_mode(c, g, MG_FRICTION_OFF);
  mg_evaluate_run_state(c);
  mg_remove_sticking_slip(c);
  mg_monitor_redundant_friction(c, 1);
  return MG_DONE;
}

/* Sets the direction of slip that is too slow to determine its friction by itself, at the start of a step; returns 0
   where the slip is within rounding, or is still what is left of that before a reversal. */
static int mg_update_slow_slip_direction(mg_context *c, int contact, int constraint) {
  const mg_real rounding = MG_SLIP_ROUNDING * MG_EPS * mg_slip_velocity_scale(c, constraint);
  mg_real slip[2];
  if (!(mg_slip_along_direction(c, contact, constraint, slip) > rounding)) return 0;
  mg_set_slip_direction(c, contact, constraint);
  return 1;
}

MG_INTERNAL void mg_begin_step_friction(mg_context *c) {
  MG_NEEDS_AT_RUN(c, MG_VALID_ROWS);
  int turned = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++) {
      if (!c->run->active[i] || c->run->friction_mode[g] < MG_SLIP_STARTING) continue;
      if (mg_update_slip_direction(c, i, g)) mg_set_friction_mode(c, g, MG_SLIPPING);
      else turned |= mg_update_slow_slip_direction(c, i, g);
    }
  if (turned) mg_evaluate_run_state(c);
  for (int g = mg_next_constraint(c, -1); g < c->system->n_friction; g = mg_next_constraint(c, g))
    c->friction.mode_before[g] = c->run->friction_mode[g];
}
