/* Whether the motion is unique: other motions that Coulomb's law allows where forces are not unique, and loads that
   jump away from zeros at which they are. Reads modes, rows and forces of the run at its state, which reports what is
   found. */
#include "forces/forces.h"
#include "model/model.h"
#include "solve/friction/friction_solvers.h"

/* True if the direction of friction of a closed contact is known: its slip is under way. */
static int mg_is_slip_under_way(const mg_context *c, int contact, int constraint) {
  mg_real slip[2];
  if (c->run->friction_mode[constraint] != MG_FRICTION_OFF) return c->run->friction_mode[constraint] >= MG_SLIP_ONSET;
  mg_slip_along_direction(c, contact, constraint, slip);
  return sqrt(mg_dot2(slip, slip)) > 2 * mg_slip_velocity_tolerance(c, constraint);
}

/* Sets what bounds the friction of a contact in other motions. One that carries no force would have that of its slip.
 */
static void mg_bound_friction_of_contact(mg_context *c, int contact) {
  for (int g = c->system->contact_friction[contact]; g < c->system->contact_friction[contact + 1]; g++) {
    c->friction.bound[g] = mg_is_slip_under_way(c, contact, g) ? MG_BOUND_SLIP : MG_BOUND_STATIC;
    if (c->friction.bound[g] == MG_BOUND_SLIP && !c->run->active[contact]) mg_set_slip_force_ratio(c, contact, g);
  }
}

/* Takes friction again from the contacts of a problem that carry no force. */
static void mg_clear_ratios_of_open_contacts(mg_context *c, const mg_friction_problem *p) {
  for (int k = 0; k < p->n_contact; k++) {
    const int i = c->friction.cone_contact[k];
    for (int r = 0; r < mg_tangential_row_count(c, i) && !c->run->active[i]; r++)
      c->friction.force_ratio[c->system->contact_friction_row[i] + r] = 0;
  }
}

/* True if a row is of a joint or a spring, which hold or act in any motion. */
static int mg_is_held_row(const mg_context *c, int row) {
  return (row >= c->layout.joint_row_begin && row < c->layout.joint_row_end) || row >= c->layout.spring_row_begin;
}

/* Appends the rows of joints and springs of an island to a list of n rows; returns its length. */
static int mg_append_held_rows_of_island(mg_context *c, int first, int n) {
  for (int i = first; i >= 0; i = c->islands.next[i])
    if (mg_is_held_row(c, i)) c->lcp.rows[n++] = i;
  return n;
}

/* Appends the rows of the friction of an island that sticks to a list of n rows; returns its length. */
static int mg_append_sticking_rows_of_island(mg_context *c, int first, int n) {
  for (int i = first; i >= 0; i = c->islands.next[i])
    if (i < c->system->n_contact) n = mg_append_sticking_rows_of_contact(c, i, c->lcp.rows, n);
    else if (!mg_is_held_row(c, i)) c->lcp.rows[n++] = i; /* of a patch */
  return n;
}

/* Appends the gaps of an island that carry force to a list of n rows; returns its length. */
static int mg_append_loaded_gaps_of_island(mg_context *c, int first, int n) {
  for (int i = first; i >= 0; i = c->islands.next[i])
    if (i < c->system->n_contact && c->run->active[i]) c->lcp.rows[n++] = i;
  return n;
}

/* Rank of the first n listed rows. */
static int mg_rank_of_listed_rows(mg_context *c, int n) {
  mg_assemble_delassus(c, c->lcp.rows, n);
  for (int r = 0; r < n; r++) c->lcp.b[r] = 0;
  return mg_unsymmetric_rank(c, c->lcp.rows, n);
}

/* True if the normal forces of an island are unique while its contacts keep their modes: its gaps depend neither on
   each other nor on joints, springs and sticking friction. Friction forces may then share what they hold, each below
   bounds that are known. */
static int mg_are_normal_forces_unique(mg_context *c, int first) {
  const int m = mg_append_sticking_rows_of_island(c, first, mg_append_held_rows_of_island(c, first, 0)),
            rank = mg_rank_of_listed_rows(c, m), n = mg_append_loaded_gaps_of_island(c, first, m);
  return mg_rank_of_listed_rows(c, n) == rank + n - m;
}

/* Present force of a listed row; 0 where the column of a normal force has it with that of slip. */
static mg_real mg_present_force(const mg_context *c, int r) {
  const int row = c->lcp.rows[r], friction = row - c->layout.friction_row_begin;
  const int is_slip =
      row >= c->layout.friction_row_begin && row < c->layout.friction_row_end && c->friction.force_ratio[friction] != 0;
  return is_slip ? 0 : c->solution.force[row];
}

/* True if part of an island is a patch or its supports, the friction of which is no cone. */
static int mg_has_island_patch(const mg_context *c, int first) {
  for (int i = first; i >= 0; i = c->islands.next[i])
    if (i < c->system->n_contact ? mg_is_support_contact(c, i) : !mg_is_held_row(c, i)) return 1;
  return 0;
}

/* The friction problem of an island, of which the present forces are one solution. */
static mg_friction_problem mg_problem_of_island(mg_context *c, int first) {
  mg_friction_problem p = {
      0,        0,        MG_COULOMB, 0, c->friction.cone_first, c->friction.cone_rows,        c->friction.cone,
      c->lcp.A, c->lcp.b, 1,          0, c->run->stop,           c->settings->sweep_from_last, 0,
      0};
  for (int i = first; i >= 0; i = c->islands.next[i]) {
    if (i >= c->system->n_contact) continue;
    mg_bound_friction_of_contact(c, i);
    mg_set_friction_cone(c, i, 1, c->friction.cone + MG_CONE * p.n_contact);
    p.n = mg_append_friction_contact(c, i, p.n_contact++, p.n);
  }
  p.n = mg_append_held_rows_of_island(c, first, p.n);
  mg_assemble_delassus(c, c->lcp.rows, p.n);
  for (int k = 0; k < p.n_contact; k++)
    for (int r = 0; r < mg_tangential_row_count(c, c->friction.cone_contact[k]); r++)
      mg_update_inverse_mass_row(
          c, c->layout.friction_row_begin + c->system->contact_friction_row[c->friction.cone_contact[k]] + r);
  mg_couple_slip_to_normal_columns(c, c->lcp.rows, p.n);
  for (int r = 0; r < p.n; r++) {
    c->lcp.b[r] = mg_is_held_row(c, c->lcp.rows[r]) ? 0 : mg_row_acceleration(c, c->lcp.rows[r]);
    for (int j = 0; j < p.n; j++) c->lcp.b[r] -= c->lcp.A[r + (long)p.n * j] * mg_present_force(c, j);
  }
  return p;
}

/* Sets c->bodies.wrench to the change of the accelerations of bodies from the present forces to z, or clears it. */
static void mg_change_accelerations(mg_context *c, const mg_friction_problem *p, const mg_real *z) {
  int slip[MG_FRICTION_ROWS_MAX];
  mg_real ratio[MG_FRICTION_ROWS_MAX];
  for (int i = 0; i < 6 * c->system->n_body; i++) c->bodies.wrench[i] = 0;
  for (int j = 0; z && j < p->n; j++) {
    const mg_real change = z[j] - mg_present_force(c, j);
    const int n = mg_list_slip_rows(c, c->lcp.rows[j], slip, ratio);
    mg_add_row_response(c, c->lcp.rows[j], change, c->bodies.wrench);
    for (int k = 0; k < n; k++) mg_add_row_response(c, slip[k], -change * ratio[k], c->bodies.wrench);
  }
}

/* Reports another motion if the bodies of an island move otherwise under the forces z; returns whether they do. */
static int mg_report_motion_of_forces(mg_context *c, const mg_friction_problem *p, const mg_real *z) {
  mg_real load = 0, most = 0;
  int contact = -1;
  for (int r = 0; r < p->n; r++) load = mg_max(load, fabs(p->b[r]) / mg_diagonal_scale(p->A[r + (long)p->n * r]));
  mg_change_accelerations(c, p, z);
  for (int k = 0; k < p->n_contact; k++) {
    const int i = c->friction.cone_contact[k];
    for (int r = 0; r <= mg_tangential_row_count(c, i); r++) {
      const int row = r ? c->layout.friction_row_begin + c->system->contact_friction_row[i] + r - 1 : i;
      const mg_real change =
          fabs(mg_row_times(c, row, c->bodies.wrench)) / mg_diagonal_scale(mg_delassus_entry(c, row, row));
      if (change > most) most = change, contact = i;
    }
  }
  mg_change_accelerations(c, p, 0);
  if (!(most > mg_max(c->settings->other_motion, (mg_real)sqrt(MG_EPS)) * load)) return 0;
  mg_report_other_motion(c->run, mg_told_contact(c->system, c->run, contact), most / load);
  return 1;
}

/* Seeks another motion of an island under Coulomb's law, from `count` starts, and reports it, or that it cannot be
   sought. */
static void mg_seek_other_motion_of_island(mg_context *c, int first, int start, int count) {
  if (mg_has_island_patch(c, first)) {
    mg_report_indeterminate(c->run, -1);
    return;
  }
  const mg_friction_problem p = mg_problem_of_island(c, first);
  for (int k = start; k < start + count; k++) {
    mg_friction_report report;
    for (int r = 0; r < p.n; r++) c->lcp.z[r] = mg_present_force(c, r);
    mg_scatter_friction_start(&p, k, c->lcp.z);
    if (mg_friction(&p, c->lcp.z, c->lcp.mask, &report, c->friction.work, c->friction.iwork) == MG_FRICTION_SOLVED &&
        mg_report_motion_of_forces(c, &p, c->lcp.z))
      break;
  }
  mg_clear_ratios_of_open_contacts(c, &p);
}

MG_INTERNAL void mg_monitor_redundant_friction(mg_context *c, int is_new) {
  if (!c->run->friction_redundant || c->run->report.indeterminate) return;
  MG_NEEDS_AT_RUN(c, MG_VALID_ROWS), MG_NEEDS_AT_RUN(c, MG_VALID_FORCES);
  int n = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->run->closed[i]) c->lcp.rows[n++] = i;
  n = mg_append_sticking_patch_rows(c, c->lcp.rows,
                                    mg_append_spring_rows(c, c->lcp.rows, mg_append_joint_rows(c, c->lcp.rows, n)));
  mg_chain_islands(c, n);
  for (int b = 0; b < c->system->n_body; b++) {
    const int first = c->islands.head[b];
    if (first < 0 || mg_are_normal_forces_unique(c, first)) continue;
    if (is_new) mg_seek_other_motion_of_island(c, first, 0, MG_SCATTERED_STARTS);
    else mg_seek_other_motion_of_island(c, first, (int)(c->run->steps % MG_SCATTERED_STARTS), 1);
  }
}

MG_INTERNAL void mg_monitor_loads_at_jumps(const mg_context *c) {
  if (!mg_has_branches(c)) return;
  for (int k = 0; k < c->system->n_switch; k++) {
    if (c->switches.repels[k]) mg_report_indeterminate(c->run, k);
    if (c->switches.shares[k]) mg_report_shared_switch(c->run, k);
  }
}
