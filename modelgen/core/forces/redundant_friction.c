/* Motion while friction forces are not unique: whether Coulomb's law leaves one motion only. Reads modes, rows and
   forces of the run at its state; writes its statistics. */
#include "forces/forces.h"
#include "model/model.h"
#include "solve/friction/solvers.h"

/* True if the active contact sticks with one coefficient of friction, static and kinetic, in all directions. */
static int mg_sticks_isotropically(const mg_context *c, int contact) {
  const int g = c->system->contact_friction[contact];
  const mg_real *s = c->system->friction_static + 2 * g, *d = c->system->friction_kinetic + 2 * g;
  return c->run->active[contact] && c->kernels->contact_kinds[c->contacts.kind[contact]].rows == 3 &&
         c->system->contact_friction[contact + 1] == g + 1 && c->run->friction_mode[g] == MG_STICKING && s[0] == d[0] &&
         s[1] == d[0] && d[1] == d[0];
}

/* Lists the rows of the closed contacts if all stick, without joints; *count: their number. Returns the number of rows,
   0 if some contact does not stick. */
static int mg_list_sticking_contacts(mg_context *c, int *count) {
  int n = 0;
  *count = 0;
  if (c->system->n_joint_row) return 0;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) {
    if (!c->run->closed[i]) continue;
    if (mg_is_support_contact(c, i) || !mg_sticks_isotropically(c, i)) return 0;
    c->friction.bound[c->system->contact_friction[i]] = MG_BOUND_KINETIC;
    n = mg_append_friction_contact(c, i, *count, n);
    mg_set_cone_coefficients(c, c->system->contact_friction[i], c->system->friction_kinetic, 1,
                             c->friction.cone + MG_CONE * (*count)++);
  }
  return n;
}

/* True if the present motion is proved to be the only one. */
static int mg_is_motion_unique(mg_context *c) {
  int count;
  const int n = mg_list_sticking_contacts(c, &count);
  const mg_friction_problem p = {
      n,        count,    MG_COULOMB, 0, c->friction.cone_first, c->friction.cone_rows, c->friction.cone,
      c->lcp.A, c->lcp.b, 0,          0};
  if (n == 0) return 0;
  mg_assemble_delassus(c, c->lcp.rows, n);
  for (int r = 0; r < n; r++) c->lcp.z[r] = c->solution.force[c->lcp.rows[r]], c->lcp.b[r] = 0;
  for (int j = 0; j < n; j++)
    for (int r = 0; r < n; r++) c->lcp.b[r] -= p.A[r + n * j] * c->lcp.z[j];
  return mg_is_sticking_motion_unique(&p, c->lcp.z);
}

MG_INTERNAL void mg_monitor_redundant_friction(mg_context *c) {
  if (!c->run->friction_redundant || c->run->indeterminate || mg_is_motion_unique(c)) return;
  c->run->indeterminate = 1, c->run->indeterminate_t = c->run->t;
}
