/* Complementarity problem of a step of time-stepping: impulses that make the velocities at its end admissible,
   without friction (a convex program) or with Coulomb's law. Reads the geometry of the step (step_setup.c);
   writes c->solution.force, c->bodies.wrench, modes and statistics of the run. */
#include "timestep/timestep.h"
#include "solve/lcp/lcp_solvers.h"
#include "solve/friction/friction_solvers.h"
#include "model/model.h"
#include "forces/forces.h"
#include "features/features.h"

enum {
  MG_NOT_NEAR = 0,         /* mark in c->events.is_near: the contact does not take part */
  MG_NEAR = 1,             /* the contact takes part */
  MG_NEAR_SET_ROUNDS = 20, /* most rounds in which contacts are added */
  MG_MATRIX_ISLAND = 60,   /* most rows of an island whose matrix is solved where its graph is not enough */
  MG_GRAPH_STARTS = 3,     /* most starting points of an island on its graph */
  MG_JOINED_ISLAND = 150,  /* most rows of an island with joints or springs whose matrix is solved at once */
  MG_NEAR_TOLERANCE = 100, /* times stepping_tolerance: up to there a residual that falls slowly is let be */
  MG_TOUCH_STEP_PARTS = 16 /* a contact that touches within this part of a step touches at its start */
};

/* Rate at which the relaxed friction law keeps the gap opening, sum of |mu w_t|, at the end of the step. */
static mg_real mg_relaxed_opening_rate(const mg_context *c, int contact, mg_real h) {
  mg_real sum = 0;
  for (int g = c->system->contact_friction[contact];
       g < c->system->contact_friction[contact + 1] && c->settings->stepping_friction_law == MG_RELAXED; g++)
    for (int k = 0; k < mg_friction_row_count(c, g); k++) {
      const int row = mg_first_friction_row(c, contact, g) + k;
      const mg_real slip = c->system->friction_kinetic[2 * g + k] *
                           (mg_free_end_rate(c, row, h) + mg_row_times(c, row, c->bodies.wrench));
      sum += fabs(slip);
    }
  return sum;
}

/* Gap rate at the end of the step under the impulses found so far. */
static mg_real mg_end_gap_rate(const mg_context *c, int contact, mg_real h) {
  return mg_free_end_rate(c, contact, h) + mg_row_times(c, contact, c->bodies.wrench) -
         mg_relaxed_opening_rate(c, contact, h);
}

/* True if a contact takes part in the problem: its gap would close within the step under the impulses found so far; in
   schemes that act on touching contacts only, within its first MG_TOUCH_STEP_PARTS-th part, or it is closed. */
static int mg_closes_within_step(const mg_context *c, int contact, mg_real h) {
  if (!mg_is_on_feature_pair(c, contact)) return 0;
  const mg_real rate = mg_end_gap_rate(c, contact, h);
  const mg_real gap = c->rows.d[contact] > 0 ? c->rows.d[contact] : 0,
                touching = c->settings->start_gap * c->system->length;
  const int soon = c->settings->stepping_scheme == MG_STEWART_TRINKLE ? 1 : MG_TOUCH_STEP_PARTS;
  return gap + h * rate / soon <= c->settings->contact_gap * c->system->length ||
         (soon > 1 && (gap <= touching || c->run->closed[contact]));
}

/* Lists the contacts that take part; returns their number. */
static int mg_list_near_contacts(mg_context *c) {
  int n = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->events.is_near[i]) c->lcp.rows[n++] = i;
  return n;
}

/* Impulses without friction, a convex quadratic program; *size receives the number of rows. `per_force` is as for an
   island. Returns an outcome. */
static int mg_solve_frictionless_step(mg_context *c, mg_real h, mg_real per_force, int *size) {
  mg_lcp_report report;
  const int n = mg_list_near_contacts(c);
  *size = n + c->system->n_joint_row + c->layout.spring_row_end - c->layout.spring_row_begin;
  if (!mg_is_room_for_closed(c, n)) return MG_TOO_MANY_CLOSED;
  for (int r = 0; r < n; r++) {
    const int i = c->lcp.rows[r];
    c->rows.row_rate[i] = mg_free_end_rate(c, i, h) - mg_scheme_gap_rate(c, i, h), c->lcp.mask[r] = 1;
  }
  for (int i = c->layout.joint_row_begin; i < c->layout.joint_row_end; i++)
    c->rows.row_rate[i] = mg_free_end_rate(c, i, h);
  for (int i = c->layout.spring_row_begin; i < c->layout.spring_row_end; i++)
    c->rows.row_rate[i] = mg_free_spring_rate(c, i, h);
  if (*size == 0) return MG_DONE;
  for (int r = 0; r < n; r++) c->solution.impulse[c->lcp.rows[r]] = per_force * c->solution.force[c->lcp.rows[r]];
  const int outcome = c->settings->outer_solver
                          ? mg_solve_force_lcp(c, n, c->rows.row_rate, &report)
                          : mg_solve_step_lcp(c, n, c->rows.row_rate, c->solution.impulse, 0, &report);
  if (outcome == MG_LCP_SOLVED) mg_report_residual(c->run, report.residual);
  return outcome == MG_LCP_SOLVED ? MG_DONE : MG_COMPLEMENTARITY;
}

/* A friction constraint that stuck in the step before is bounded by static friction, others by kinetic; none is marked
   as slipping. */
static void mg_set_step_bound_kinds(mg_context *c) {
  for (int g = mg_next_constraint(c, -1); g < c->system->n_friction; g = mg_next_constraint(c, g))
    c->friction.triggered[g] = c->friction.is_yielding[g] = 0,
    c->friction.bound[g] = c->run->friction_mode[g] >= MG_SLIP_ONSET ? MG_BOUND_KINETIC : MG_BOUND_STATIC;
  MG_NOTE_WITH(c, MG_VALID_YIELDING, MG_VALID_STEP_GEOMETRY);
}

/* An island of the step's friction problem: its first row in c->lcp.rows, b and z, its first contact in
   c->friction.cone_contact, cone_first, cone_rows, cone and marks, and the problem of its rows. */
typedef struct {
  int row, contact;
  mg_friction_problem problem;
} mg_step_island;

/* Sets up the problem of the island whose chain begins with `first`, behind the rows and contacts of the islands before
   it. `per_force`: time of the impulses from which they are sought, per force kept of the step before, s. */
static void mg_list_island(mg_context *c, mg_real h, mg_real per_force, int first, mg_step_island *island) {
  const int row = island->row, contact = island->contact;
  int n = row, k = contact;
  for (int i = first; i >= 0; i = c->islands.next[i])
    if (i < c->system->n_contact) n = mg_append_friction_contact(c, i, k++, n);
  for (int i = first; i >= 0; i = c->islands.next[i])
    if (i >= c->system->n_contact) c->lcp.rows[n++] = i;
  for (int each = contact; each < k; each++) c->friction.cone_first[each] -= row;
  for (int r = row; r < n; r++) {
    const int i = c->lcp.rows[r];
    c->lcp.b[r] = i >= c->layout.spring_row_begin ? mg_free_spring_rate(c, i, h) : mg_free_end_rate(c, i, h);
    if (i < c->system->n_contact) c->lcp.b[r] -= mg_scheme_gap_rate(c, i, h);
    const int is_kept =
        i < c->system->n_contact || (i >= c->layout.friction_row_begin && i < c->layout.spring_row_begin);
    c->lcp.z[r] = is_kept ? c->solution.force[i] * per_force : 0;
  }
  const mg_friction_problem problem = {
      n - row,
      k - contact,
      c->settings->stepping_friction_law,
      0,
      c->friction.cone_first + contact,
      c->friction.cone_rows + contact,
      c->friction.cone + MG_CONE * contact,
      c->lcp.A,
      c->lcp.b + row,
      1,
      c->settings->stepping_tolerance,
      c->run->stop,
      c->settings->sweep_from_last,
      mg_min(MG_NEAR_TOLERANCE * c->settings->stepping_tolerance, c->settings->stepping_residual),
      0};
  island->problem = problem;
}

/* Gives kinetic friction to the constraints of an island bounded by static friction that slip; returns how many there
   are. */
static int mg_release_slipping_constraints(mg_context *c, const mg_step_island *island) {
  for (int k = island->contact; k < island->contact + island->problem.n_contact; k++) {
    const int i = c->friction.cone_contact[k];
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++)
      c->friction.is_yielding[g] = (c->friction.marks[k] & (MG_MARK_SLIP << c->system->friction_kind[g])) != 0;
  }
  MG_NOTE_WITH(c, MG_VALID_YIELDING, MG_VALID_STEP_GEOMETRY);
  return mg_use_kinetic_bounds(c, island->problem.n_contact, c->friction.cone_contact + island->contact);
}

/* Impulses of an island by its graph, from `starts` starting points at most. Returns the outcome of mg_friction. */
static int mg_solve_island_graph(mg_context *c, const mg_step_island *island, int starts, mg_friction_report *report) {
  mg_friction_problem problem = island->problem;
  const int n = island->problem.n, *row = c->lcp.rows + island->row;
  for (int r = 0; r < n; r++) {
    const int bodies[2] = {c->contacts.o[row[r]], c->contacts.f[row[r]]};
    mg_update_inverse_mass_row(c, row[r]);
    c->friction.row_yield[r] = mg_row_yield(c, row[r]);
    for (int side = 0; side < 2; side++)
      c->friction.row_body[2 * r + side] = mg_is_moved_by_forces(c, bodies[side]) ? bodies[side] : -1;
  }
  mg_report_friction_solve(c->run, island->problem.law);
  const mg_friction_graph graph = {c->system->n_body, row,        c->friction.row_body,
                                   c->rows.J,         c->rows.MJ, c->friction.row_yield};
  problem.max_starts = starts;
  return mg_friction_on_graph(&problem, &graph, c->lcp.z + island->row, c->friction.marks + island->contact, report,
                              c->friction.work, c->friction.iwork);
}

/* Impulses of an island by its matrix. Returns the outcome of mg_friction. */
static int mg_solve_island_matrix(mg_context *c, const mg_step_island *island, mg_friction_report *report) {
  mg_assemble_delassus(c, c->lcp.rows + island->row, island->problem.n);
  return mg_solve_friction_problem(c, &island->problem, c->lcp.z + island->row, c->friction.marks + island->contact,
                                   report);
}

/* True if an island is solved on its graph first: sweeps and Newton steps there hold joints only as well as contacts.
 */
static int mg_is_island_large(const mg_step_island *island) {
  const mg_friction_problem *p = &island->problem;
  int rows = 0;
  for (int k = 0; k < p->n_contact; k++) rows += p->rows[k];
  return p->n > (rows < p->n ? MG_JOINED_ISLAND : MG_SMALL_PROBLEM);
}

/* Solves the problem of an island: a large one by its graph, where that fails and in place of it one that is not too
   large by its matrix, and where that fails too by its graph from other starting points. A residual up to
   stepping_residual counts as solved, loosely above stepping_tolerance. Returns the outcome of mg_friction. */
static int mg_try_friction_law(mg_context *c, const mg_step_island *island, mg_friction_report *report) {
  const int has_graph = !mg_has_outer_solver(c, &island->problem), is_large = has_graph && mg_is_island_large(island),
            has_matrix = !is_large || island->problem.n <= MG_MATRIX_ISLAND;
  int outcome = MG_FRICTION_NOT_FOUND;
  if (is_large) outcome = mg_solve_island_graph(c, island, has_matrix ? 1 : MG_GRAPH_STARTS, report);
  if (outcome == MG_FRICTION_NOT_FOUND && has_matrix && !mg_is_stopped(c))
    outcome = mg_solve_island_matrix(c, island, report);
  if (outcome == MG_FRICTION_NOT_FOUND && has_matrix && has_graph && !mg_is_stopped(c))
    outcome = mg_solve_island_graph(c, island, MG_GRAPH_STARTS, report);
  if (outcome != MG_FRICTION_NOT_FOUND || !(report->residual <= c->settings->stepping_residual)) return outcome;
  c->friction.is_loose = 1;
  return MG_FRICTION_SOLVED;
}

/* Solves the problem of an island by Coulomb's law, or by its relaxation if that is chosen or no solution of the law is
   found. Returns an outcome. */
static int mg_solve_friction_law(mg_context *c, mg_step_island *island) {
  mg_friction_problem *p = &island->problem;
  mg_friction_report report;
  for (int k = island->contact; k < island->contact + p->n_contact; k++)
    mg_set_friction_cone(c, c->friction.cone_contact[k], 1, c->friction.cone + MG_CONE * k);
  int outcome = mg_try_friction_law(c, island, &report);
  if (outcome == MG_FRICTION_NOT_FOUND && p->law == MG_COULOMB && !mg_is_stopped(c)) {
    p->law = MG_RELAXED;
    c->friction.is_relaxed = 1;
    for (int r = 0; r < p->n; r++) c->lcp.z[island->row + r] = 0;
    outcome = mg_try_friction_law(c, island, &report);
  }
  if (outcome == MG_FRICTION_INFEASIBLE) return MG_COMPLEMENTARITY;
  if (outcome) return MG_NO_FRICTION;
  mg_report_residual(c->run, report.residual);
  return MG_DONE;
}

/* Impulses with friction, island by island; *size receives the number of rows. Returns an outcome. */
static int mg_solve_friction_step(mg_context *c, mg_real h, mg_real per_force, int *size) {
  mg_step_island island = {0};
  int outcome = MG_DONE;
  const int n = mg_list_near_contacts(c);
  if (!mg_is_room_for_closed(c, n)) return MG_TOO_MANY_CLOSED;
  mg_set_step_bound_kinds(c);
  mg_chain_islands(c, mg_append_spring_rows(c, c->lcp.rows, mg_append_joint_rows(c, c->lcp.rows, n)));
  for (int b = 0; b < c->system->n_body && !outcome; b++) {
    if (c->islands.head[b] < 0) continue;
    mg_list_island(c, h, per_force, c->islands.head[b], &island);
    do outcome = mg_solve_friction_law(c, &island);
    while (!outcome && mg_release_slipping_constraints(c, &island));
    island.row += island.problem.n, island.contact += island.problem.n_contact;
  }
  *size = island.row;
  return outcome;
}

/* Writes the impulses of the rows to c->solution.force and the changes of the twists to c->bodies.wrench. */
static void mg_set_step_impulses(mg_context *c, int n, mg_real h) {
  for (int i = mg_next_row(c, -1); i < c->layout.spring_row_end; i = mg_next_row(c, i))
    c->solution.force[i] =
        i >= c->layout.joint_row_begin && i < c->layout.friction_row_begin ? h * c->solution.impulse[i] : 0;
  for (int i = 0; i < 6 * c->system->n_body; i++) c->bodies.wrench[i] = 0;
  for (int r = 0; r < n; r++) {
    c->solution.force[c->lcp.rows[r]] += c->lcp.z[r];
    mg_add_row_response(c, c->lcp.rows[r], c->lcp.z[r], c->bodies.wrench);
  }
}

/* Adds contacts that impulses at others make close within the step; returns their number. */
static int mg_add_closing_contacts(mg_context *c, mg_real h) {
  int count = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) {
    if (c->events.is_near[i] || !mg_closes_within_step(c, i, h)) continue;
    c->events.is_near[i] = MG_NEAR, count++;
  }
  return count;
}

/* Follows the pairs left out whose shapes could meet within the step, by the impulses found so far. */
static void mg_follow_meeting_pairs(mg_context *c, mg_real h) {
  const mg_system *s = c->system;
  if (!mg_choose_near_pairs(c, h, c->bodies.wrench, 1) || !c->listed.n_found) return;
  for (int k = 0; k < c->listed.n_found; k++)
    for (int i = s->pair_contact[c->listed.found[k]]; i < s->pair_contact[c->listed.found[k] + 1]; i++) {
      const mg_real *eta = mg_contact_eta(c, c->run->x, i);
      mg_real *settled = mg_contact_eta(c, c->step.settled, i);
      for (int j = 0; j < c->contacts.n_eta[i]; j++) settled[j] = eta[j];
    }
  mg_update_contact_rows(c, c->step.settled);
  mg_update_gap_rates(c);
}

/* True if a contact takes part from the first round on: its gap would close, or it carried force in the step before and
   so probably does again, which saves rounds and changes nothing where the scheme looks at the gap. */
static int mg_takes_part_from_start(const mg_context *c, int contact, mg_real h) {
  return mg_closes_within_step(c, contact, h) ||
         (c->settings->stepping_scheme == MG_STEWART_TRINKLE && mg_is_on_feature_pair(c, contact) &&
          c->solution.force[contact] > 0 && !mg_is_rebounding(c, contact, h));
}

/* Finds the impulses, and adds contacts that they make close, until there are none. Returns an outcome. */
static int mg_solve_step(mg_context *c, mg_real h) {
  for (int i = 0; i < 6 * c->system->n_body; i++) c->bodies.wrench[i] = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    c->events.is_near[i] = mg_takes_part_from_start(c, i, h) ? MG_NEAR : MG_NOT_NEAR;
  for (int round = 0; round < MG_NEAR_SET_ROUNDS; round++) {
    int n = 0;
    const mg_real per_force = round ? 1 : h; /* later rounds begin with impulses in place of forces */
    const int outcome = c->system->n_friction ? mg_solve_friction_step(c, h, per_force, &n)
                                              : mg_solve_frictionless_step(c, h, per_force, &n);
    if (outcome) return outcome;
    mg_set_step_impulses(c, n, h);
    mg_follow_meeting_pairs(c, h);
    if (!mg_add_closing_contacts(c, h)) break;
  }
  MG_NOTE_WITH(c, MG_VALID_STEP_IMPULSES, MG_VALID_STEP_GEOMETRY);
  return MG_DONE;
}

MG_INTERNAL int mg_step_impulses(mg_context *c, mg_real h) {
  MG_NEEDS_DIGEST(c, MG_VALID_STEP_GEOMETRY, mg_step_digest(c, c->run->t, c->run->x, h));
  c->springs.are_rows = 1, c->friction.is_loose = c->friction.is_relaxed = 0;
  const int outcome = mg_solve_step(c, h);
  c->springs.are_rows = 0;
  return outcome;
}
