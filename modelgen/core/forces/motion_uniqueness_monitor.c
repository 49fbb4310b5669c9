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
    const int k = *count, g = c->system->contact_friction[i];
    if (k == MG_MOTION_CONTACTS || mg_is_support_contact(c, i) || !mg_has_one_coefficient(c, i) ||
        !mg_set_slip_under_way(c, i, slip->slides + k, slip->ratio + 2 * k))
      return 0;
    c->friction.bound[g] = MG_BOUND_KINETIC;
    n = mg_append_friction_contact(c, i, k, n);
    mg_set_cone_coefficients(c, g, c->system->friction_kinetic, 1, c->friction.cone + MG_CONE * k);
    ++*count;
  }
  return n;
}

/* True if the present motion of the bodies of an island is proved to be the only one. */
static int mg_is_island_motion_unique(mg_context *c, int first) {
  mg_slip_under_way slip;
  int count;
  const int n = mg_list_island_contacts(c, first, &slip, &count);
  const mg_friction_problem p = {
      n,        count, MG_COULOMB, 0, c->friction.cone_first, c->friction.cone_rows, c->friction.cone, c->lcp.A,
      c->lcp.b, 0,     0,          0};
  if (n == 0) return 0;
  mg_assemble_delassus(c, c->lcp.rows, n);
  for (int r = 0; r < n; r++) {
    c->lcp.z[r] = c->run->active[c->friction.cone_contact[r / 3]] ? c->solution.force[c->lcp.rows[r]] : 0;
    c->lcp.b[r] = mg_row_acceleration(c, c->lcp.rows[r]);
  }
  for (int j = 0; j < n; j++)
    for (int r = 0; r < n; r++) c->lcp.b[r] -= p.A[r + n * j] * c->lcp.z[j];
  return mg_is_motion_unique(&p, c->lcp.z, slip.slides, slip.ratio, c->friction.motion_work);
}

/* The same of all bodies. An island of one contact has unique forces. */
static int mg_is_present_motion_unique(mg_context *c) {
  int n = 0;
  if (c->system->n_joint_row) return 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->run->closed[i]) c->lcp.rows[n++] = i;
  mg_chain_islands(c, n);
  for (int b = 0; b < c->system->n_body; b++)
    if (c->islands.head[b] >= 0 && c->islands.next[c->islands.head[b]] >= 0 &&
        !mg_is_island_motion_unique(c, c->islands.head[b]))
      return 0;
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
