/* Right-hand side of the equations of motion within one contact mode: the active contacts keep the second
   derivative of their gap at zero, the joints that of their rows, equation (2.6) of Anitescu, Cremer and Potra
   (1995). Reads the state, the active set and the friction modes of the run. Writes poses, rows, forces and
   accelerations of the context, and counts the evaluations. It does not change modes. */
#include "forces/forces.h"
#include "base/base.h"
#include "solve/lcp/lcp_solvers.h"
#include "model/model.h"

/* Forces of the n rows of c->islands.rows, of which the matrix is assembled. */
static void mg_solve_island(mg_context *c, int n, const mg_real *rate, mg_real *amount) {
  const int has_slip = c->friction.couples_normal && c->friction.slips,
            has_reference = c->friction.couples_normal && c->run->forces_redundant;
  mg_count_factorisation(c, n);
  for (int r = 0; r < n; r++)
    c->lcp.b[r] = rate[c->islands.rows[r]], c->lcp.mask[r] = mg_held_row_mask(c, c->islands.rows[r]);
  if (has_slip || has_reference) {
    mg_solve_island_with_friction(c, n, rate, amount);
    return;
  }
  mg_real pivot;
  const int rank = mg_active_above(n, c->lcp.A, c->lcp.b, c->lcp.mask,
                                   c->system->n_joint_row ? c->settings->joint_rank_tolerance : 0, c->lcp.z,
                                   c->lcp.work, c->lcp.iwork, &pivot);
  c->lcp.least_pivot = mg_min(c->lcp.least_pivot, rank == n ? pivot : 0);
  for (int r = 0; r < n; r++) amount[c->islands.rows[r]] = c->lcp.z[r];
  mg_refine_rows(c, n, 0, rank, rate, pivot, amount);
}

static void mg_hold_island(mg_context *c, int first, const mg_real *rate, mg_real *amount) {
  int n = 0;
  for (int i = first; i >= 0; i = c->islands.next[i]) c->islands.rows[n++] = i;
  if (!c->lcp.keeps_matrix) mg_assemble_delassus(c, c->islands.rows, n);
  mg_solve_island(c, n, rate, amount);
}

/* The same for the n rows of c->lcp.rows, which act on one pair of bodies. */
static void mg_hold_pair(mg_context *c, int n, const mg_real *rate, mg_real *amount) {
  for (int r = 0; r < n; r++) c->islands.rows[r] = c->lcp.rows[r];
  if (!c->lcp.keeps_matrix) mg_assemble_delassus_of_pair(c, c->islands.rows, n);
  mg_solve_island(c, n, rate, amount);
}

/* Lists the marked contacts and joints, and where friction `sticks` its rows, in c->lcp.rows, and sets all amounts to
   zero. Returns the number of rows. */
static int mg_list_marked_rows(mg_context *c, const int *marked, int sticks, mg_real *amount) {
  int n = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) {
    amount[i] = 0;
    if (marked[i]) c->lcp.rows[n++] = i;
  }
  n = mg_append_joint_rows(c, c->lcp.rows, n);
  for (int i = mg_next_row(c, c->layout.friction_row_begin - 1); i < c->layout.friction_row_end; i = mg_next_row(c, i))
    amount[i] = 0;
  return sticks && c->system->n_friction ? mg_append_sticking_rows(c, c->lcp.rows, n) : n;
}

MG_INTERNAL int mg_list_held_rows(mg_context *c) {
  int n = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->run->active[i]) c->lcp.rows[n++] = i;
  n = mg_append_joint_rows(c, c->lcp.rows, n);
  return c->system->n_friction ? mg_append_sticking_rows(c, c->lcp.rows, n) : n;
}

/* Solves for the amounts of the n rows of c->lcp.rows. */
static void mg_solve_listed_rows(mg_context *c, int n, const mg_real *rate, mg_real *amount) {
  if (n == 1 && !c->friction.couples_normal) {
    const mg_real weight = mg_update_inverse_mass_row(c, c->lcp.rows[0]) + mg_row_yield(c, c->lcp.rows[0]);
    amount[c->lcp.rows[0]] = weight > 0 ? -rate[c->lcp.rows[0]] / weight : 0;
  } else if (n > 0 && mg_are_rows_of_one_pair(c, c->lcp.rows, n)) mg_hold_pair(c, n, rate, amount);
  else if (n > 0) {
    mg_chain_islands(c, n);
    for (int b = 0; b < c->system->n_body; b++)
      if (c->islands.head[b] >= 0) mg_hold_island(c, c->islands.head[b], rate, amount);
  }
}

/* Solve the forces of the active contacts, joints and sticking friction, (J M^-1 J^T) f = -(J a + Gamma2), and
   add M^-1 J^T f to the unconstrained accelerations in c->bodies.acceleration. */
static void mg_solve_contact_forces(mg_context *c) {
  c->friction.couples_normal = c->system->n_friction > 0;
  if (c->friction.couples_normal) mg_set_slip_force_ratios(c);
  c->patches.pressure_rounds = c->lcp.n_assembled = 0, c->lcp.rounding = 0, c->lcp.least_pivot = 1;
  const int n = mg_list_marked_rows(c, c->run->active, 1, c->solution.force);
  for (int r = 0; r < n; r++) c->rows.row_rate[c->lcp.rows[r]] = mg_row_acceleration(c, c->lcp.rows[r]);
  mg_solve_listed_rows(c, n, c->rows.row_rate, c->solution.force);
  while (c->friction.couples_normal && !mg_is_mode_choice_too_costly(c) && mg_has_changed_patch_pressures(c))
    mg_solve_listed_rows(c, n, c->rows.row_rate, c->solution.force);
  for (int r = 0; r < n; r++)
    mg_add_row_response(c, c->lcp.rows[r], c->solution.force[c->lcp.rows[r]], c->bodies.acceleration);
  if (c->friction.couples_normal) mg_apply_slip_forces(c);
  c->friction.couples_normal = 0, c->solution.least_pivot = c->lcp.least_pivot;
  mg_report_force_rounding(c->run, c->lcp.rounding);
}

/* True if pose, twist and acceleration of the body are finite. */
static int mg_is_body_state_finite(const mg_context *c, int body) {
  return mg_all_finite(12, c->bodies.pose + 12 * body) && mg_all_finite(6, c->bodies.twist + 6 * body) &&
         mg_all_finite(6, c->bodies.acceleration + 6 * body);
}

MG_INTERNAL int mg_has_nonfinite_driven_path(const mg_context *c) {
  for (int b = 0; b < c->system->n_body && c->layout.n_driven; b++)
    if (mg_is_driven_body(c->system, b) && !mg_is_body_state_finite(c, b)) return 1;
  return 0;
}

MG_INTERNAL mg_real mg_prescribed_motion_power(const mg_context *c) {
  mg_real power = 0;
  if (mg_has_nonfinite_driven_path(c)) return INFINITY;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->run->active[i]) power -= c->solution.force[i] * mg_prescribed_gap_rate(c, i);
  for (int i = c->layout.joint_row_begin; i < c->layout.joint_row_end; i++)
    power -= c->solution.force[i] * mg_prescribed_gap_rate(c, i);
  return power;
}

/* The right-hand side on the present branches of the loads. */
static void mg_right_hand_side_on_branches(mg_context *c, mg_real t, const mg_real *x, mg_real *x_dot) {
  const mg_system *s = c->system;
  mg_update_poses(c, t, x);
  mg_free_accelerations(c, t, x, x_dot);
  mg_update_contact_rows(c, x);
  if (s->n_joint) mg_update_joint_rows(c, t);
  mg_solve_contact_forces(c);
  for (int b = 0; b < s->n_body; b++)
    mg_copy_velocity(c, b, c->bodies.acceleration + 6 * b, x_dot + s->n_q + s->body_u[b]);
  for (int i = mg_next_row(c, -1); i < s->n_contact; i = mg_next_row(c, i))
    for (int k = s->contact_eta[i]; k < s->contact_eta[i] + mg_eta_capacity(c, i); k++)
      x_dot[s->n_q + s->n_u + k] = c->rows.eta_dot[k];
  if (c->layout.n_driven || c->layout.has_prescribed_joint)
    x_dot[c->layout.work_state] += mg_prescribed_motion_power(c);
  if (s->n_friction) x_dot[c->layout.work_state] += mg_friction_power(c);
  mg_count_evaluations(c, 1);
}

MG_INTERNAL void mg_right_hand_side(mg_context *c, mg_real t, const mg_real *x, mg_real *x_dot) {
  mg_slide slide;
  c->step.is_end_evaluated = 0;
  mg_begin_slide(c, &slide);
  do {
    mg_right_hand_side_on_branches(c, t, x, x_dot);
    MG_NOTE(c, MG_VALID_FORCES, t, x), MG_NOTE_WITH(c, MG_VALID_SOLUTION, MG_VALID_TWISTS);
    if (x_dot == c->step.slopes) MG_NOTE_WITH(c, MG_VALID_SLOPE, MG_VALID_FORCES);
    if (c->system->n_switch) mg_update_switches(c, t);
  } while (mg_continue_slide(c, &slide));
}

/* True if all friction of a contact sticks. */
static int mg_sticks(const mg_context *c, int contact) {
  for (int g = c->system->contact_friction[contact]; g < c->system->contact_friction[contact + 1]; g++)
    if (c->run->friction_mode[g] != MG_STICKING) return 0;
  return 1;
}

MG_INTERNAL int mg_is_in_mode_of_scene_rhs(const mg_context *c) {
  const mg_system *s = c->system;
  if (!c->kernels->scene_rhs || !c->settings->use_gamma || c->listed.has_candidates) return 0;
  if (s->n_friction && c->run->forces_redundant) return 0;
  if (s->n_joint && !mg_are_rows_well_conditioned(c->solution.least_pivot)) return 0;
  for (int pair = 0; pair < s->n_pair; pair++)
    for (int i = s->pair_contact[pair]; i < s->pair_contact[pair + 1]; i++) {
      const int is_first = i == s->pair_contact[pair];
      if (c->run->active[i] != is_first || (c->run->feature_pair[i] >= 0) != is_first || c->run->rolling_start[i])
        return 0;
      if (is_first && !mg_sticks(c, i)) return 0;
    }
  return 1;
}

MG_INTERNAL int mg_scene_force_count(const mg_context *c) {
  const mg_system *s = c->system;
  int count = s->n_pair + s->n_joint_row;
  for (int pair = 0; pair < s->n_pair && s->n_friction; pair++)
    for (int g = s->contact_friction[s->pair_contact[pair]]; g < s->contact_friction[s->pair_contact[pair] + 1]; g++)
      count += mg_friction_row_count(c, g);
  return count;
}

MG_INTERNAL void mg_set_scene_forces(mg_context *c, const mg_real *force) {
  const mg_system *s = c->system;
  for (int pair = 0; pair < s->n_pair; pair++) c->solution.force[s->pair_contact[pair]] = *force++;
  for (int pair = 0; pair < s->n_pair && s->n_friction; pair++) {
    const int i = s->pair_contact[pair];
    for (int g = s->contact_friction[i]; g < s->contact_friction[i + 1]; g++) {
      mg_real *own = c->solution.force + mg_first_friction_row(c, i, g);
      for (int k = mg_friction_row_count(c, g); k > 0; k--) *own++ = *force++;
    }
  }
  mg_copy_reals(c->solution.force + c->layout.joint_row_begin, force, s->n_joint_row);
}

MG_INTERNAL void mg_stage_right_hand_side(mg_context *c, int is_composed, mg_real t, const mg_real *x, mg_real *x_dot) {
  const mg_system *s = c->system;
  const mg_real *eta = x + s->n_q + s->n_u;
  if (!is_composed) {
    mg_right_hand_side(c, t, x, x_dot);
    return;
  }
  c->kernels->scene_rhs(0, &t, x, x + s->n_q, eta, s->gravity, s->parameters, x_dot, x_dot + s->n_q,
                        x_dot + s->n_q + s->n_u, c->rows.row_rate);
  c->step.is_end_evaluated = 0;
  x_dot[c->layout.work_state] = 0;
  if (mg_has_event_functions(c) || c->step.follower) mg_set_scene_forces(c, c->rows.row_rate);
  mg_count_evaluations(c, 1);
}

MG_INTERNAL int mg_hold_rows(mg_context *c, const int *marked, int sticks, const mg_real *rate, mg_real *amount) {
  const int n = mg_list_marked_rows(c, marked, sticks, amount);
  mg_solve_listed_rows(c, n, rate, amount);
  return n;
}

MG_INTERNAL void mg_evaluate_run_state(mg_context *c) {
  mg_start_patch_pressures(c);
  mg_right_hand_side(c, c->run->t, c->run->x, c->step.slopes);
  mg_update_gap_rates(c);
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    c->run->force[i] = c->solution.force[i];
}
