/* Whether the motion is unique: what Coulomb's law leaves open while friction forces are not unique, and loads that
   jump away from zeros at which they are. Reads modes, rows and forces of the run at its state, which
   reports it. */
#include "forces/forces.h"
#include "model/model.h"
#include "solve/friction/friction_solvers.h"

/* Contacts of a friction problem whose slip is under way, and their friction in parts of N. */
typedef struct {
  int slides[MG_MOTION_CONTACTS];
  mg_real ratio[2 * MG_MOTION_CONTACTS];
} mg_slip_under_way;

/* True if the contact has one coefficient of friction, static and kinetic, in all directions. */
static int mg_has_one_coefficient(const mg_context *c, int contact) {
  const int g = c->system->contact_friction[contact];
  const mg_real *s = c->system->friction_static + 2 * g, *d = c->system->friction_kinetic + 2 * g;
  return c->kernels->contact_kinds[c->contacts.kind[contact]].rows == 3 &&
         c->system->contact_friction[contact + 1] == g + 1 && s[0] == d[0] && s[1] == d[0] && d[1] == d[0];
}

/* Sets whether the slip of a closed contact is under way, and its friction. Returns 0 where its slip starts. */
static int mg_set_slip_under_way(const mg_context *c, int contact, int *slides, mg_real *ratio) {
  const int g = c->system->contact_friction[contact], mode = c->run->friction_mode[g];
  mg_real slip[2], size;
  mg_slip_along_direction(c, contact, g, slip);
  size = (mg_real)sqrt(mg_dot2(slip, slip));
  *slides = mode == MG_SLIPPING || (mode == MG_FRICTION_OFF && size > 2 * mg_slip_velocity_tolerance(c, g));
  for (int k = 0; k < 2; k++) ratio[k] = *slides ? -c->system->friction_kinetic[2 * g] * slip[k] / size : 0;
  return *slides || mode == MG_FRICTION_OFF || mode == MG_STICKING;
}

/* Lists the rows of the contacts of an island. Returns their number; 0 if there are others than contacts with one
   coefficient of friction that stick, slide or open. */
static int mg_list_island_contacts(mg_context *c, int first, mg_slip_under_way *slip, int *count) {
  int n = 0;
  *count = 0;
  for (int i = first; i >= 0; i = c->islands.next[i]) {
    const int k = *count;
    if (i >= c->system->n_contact) continue;
    if (k == MG_MOTION_CONTACTS || mg_is_support_contact(c, i) || !mg_has_one_coefficient(c, i) ||
        !mg_set_slip_under_way(c, i, slip->slides + k, slip->ratio + 2 * k))
      return 0;
    const int g = c->system->contact_friction[i];
    c->friction.bound[g] = MG_BOUND_KINETIC;
    n = mg_append_friction_contact(c, i, k, n);
    mg_set_cone_coefficients(c, g, c->system->friction_kinetic, 1, c->friction.cone + MG_CONE * k);
    ++*count;
  }
  return n;
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

/* True if the present motion of the bodies of an island is proved to be the only one. */
static int mg_is_island_motion_unique(mg_context *c, int first) {
  mg_slip_under_way slip;
  mg_real S[9 * MG_MOTION_CONTACTS * MG_MOTION_CONTACTS];
  int count;
  const int n = mg_list_island_contacts(c, first, &slip, &count);
  const mg_friction_problem p = {
      n, count, MG_COULOMB, 0, c->friction.cone_first, c->friction.cone_rows, c->friction.cone, S, c->lcp.b,
      0, 0,     0,          0};
  if (n == 0) return 0;
  const int size = mg_append_held_rows_of_island(c, first, n);
  mg_assemble_delassus(c, c->lcp.rows, size);
  mg_real *x = c->lcp.work + (long)(size - n) * (size - n + 4); /* behind the scratch of the elimination */
  for (int j = 0; j < n; j++)
    mg_eliminate_bilateral_rows(c, n, size, c->lcp.A, c->lcp.A + (long)size * j, x, S + n * j);
  for (int r = 0; r < n; r++) {
    c->lcp.z[r] = c->run->active[c->friction.cone_contact[r / 3]] ? c->solution.force[c->lcp.rows[r]] : 0;
    c->lcp.b[r] = mg_row_acceleration(c, c->lcp.rows[r]);
  }
  for (int j = 0; j < n; j++)
    for (int r = 0; r < n; r++) c->lcp.b[r] -= S[r + n * j] * c->lcp.z[j];
  return mg_is_motion_unique(&p, c->lcp.z, slip.slides, slip.ratio, c->friction.motion_work);
}

/* The same of all bodies, but for islands whose normal forces are unique. */
static int mg_is_present_motion_unique(mg_context *c) {
  int n = 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->run->closed[i]) c->lcp.rows[n++] = i;
  n = mg_append_sticking_patch_rows(c, c->lcp.rows,
                                    mg_append_spring_rows(c, c->lcp.rows, mg_append_joint_rows(c, c->lcp.rows, n)));
  mg_chain_islands(c, n);
  for (int b = 0; b < c->system->n_body; b++) {
    const int first = c->islands.head[b];
    if (first >= 0 && !mg_are_normal_forces_unique(c, first) && !mg_is_island_motion_unique(c, first)) return 0;
  }
  return 1;
}

MG_INTERNAL void mg_monitor_redundant_friction(mg_context *c) {
  if (!c->run->friction_redundant || c->run->report.indeterminate) return;
  MG_NEEDS_AT_RUN(c, MG_VALID_ROWS), MG_NEEDS_AT_RUN(c, MG_VALID_FORCES);
  if (!mg_is_present_motion_unique(c)) mg_report_indeterminate(c->run, -1);
}

MG_INTERNAL void mg_monitor_loads_at_jumps(const mg_context *c) {
  if (!mg_has_branches(c)) return;
  for (int k = 0; k < c->system->n_switch; k++) {
    if (c->switches.repels[k]) mg_report_indeterminate(c->run, k);
    if (c->switches.shares[k]) mg_report_shared_switch(c->run, k);
  }
}
