/* Impacts with friction: Newton's restitution and Coulomb's law for impulses, at every closed contact at once (Moreau;
   Glocker and Pfeiffer, Nonlinear Dynamics 7 (1995), 471-497, with Newton's law in place of Poisson's). */
#include "impact/impact.h"
#include "solve/friction/solvers.h"
#include "model/model.h"
#include "forces/forces.h"

static void mg_put_kinetic(mg_context *c, int contact, mg_real *cone) {
  for (int k = 0; k < MG_CONE; k++) cone[k] = 0;
  for (int g = c->system->contact_grip[contact]; g < c->system->contact_grip[contact + 1]; g++) {
    mg_write_bound(c, g, c->system->grip_kinetic, 1, cone);
    c->friction.bound[g] = MG_BOUND_KINETIC;
  }
}

/* Of all closed contacts that are not hidden, of pads and of joints, with the velocities after the impact as what the
   impulses must make right. */
static mg_friction_problem mg_pose_impact(mg_context *c) {
  mg_friction_problem p = {
      0, 0, MG_COULOMB, 0, c->friction.cone_first, c->friction.cone_rows, c->friction.cone, c->lcp.A, c->lcp.b, 0, 0};
  for (int i = 0; i < c->support_begin; i++) {
    if (!c->run->closed[i] || c->patches.is_covered[i]) continue;
    mg_put_kinetic(c, i, c->friction.cone + MG_CONE * p.n_contact);
    p.n = mg_append_contact_rows(c, i, p.n_contact++, p.n);
  }
  p.n = mg_append_bilateral_rows(c, c->lcp.rows, p.n);
  mg_assemble_delassus(c, c->lcp.rows, p.n);
  mg_set_support_rebound(c);
  for (int r = 0; r < p.n; r++) {
    const int row = c->lcp.rows[r];
    c->lcp.b[r] = row < c->support_begin        ? c->d_dot[row] * (1 + mg_restitution_of(c, row))
                  : row < c->friction_row_begin ? c->row_rate[row]
                                                : c->d_dot[row];
    c->lcp.z[r] = 0;
  }
  return p;
}

/* As mg_find_impulses: into c->lcp.z in the order of c->lcp.rows, and of each pad into c->impulse. Returns how many of
   the list are rows of contacts, -1 without a solution. */
MG_INTERNAL int mg_find_impulses_with_friction(mg_context *c) {
  mg_friction_report report;
  const mg_friction_problem p = mg_pose_impact(c);
  int n = 0;
  c->run->lcp_solves++;
  if (mg_friction(&p, c->lcp.z, c->friction.marks, &report, c->friction.work, c->friction.iwork)) return -1;
  for (int k = 0; k < p.n_contact; k++) n += c->friction.cone_rows[k];
  for (int i = c->support_begin; i < c->system->n_contact; i++) c->impulse[i] = 0;
  for (int r = n; r < p.n; r++) c->impulse[c->lcp.rows[r]] = c->lcp.z[r];
  return n;
}

/* Newton's law with friction may make energy: notes the contact that makes most. The first n rows of c->lcp.rows are
   those of contacts, c->lcp.z their impulses; needs d_dot before the impact. */
MG_INTERNAL void mg_note_energy_gain(mg_context *c, int n) {
  for (int i = 0; i < 6 * c->system->n_body; i++) c->wrench[i] = 0;
  const int size = mg_append_bilateral_rows(c, c->lcp.rows, n);
  for (int r = 0; r < size; r++) mg_add_row_response(c, c->lcp.rows[r], c->lcp.z[r], c->wrench);
  for (int k = 0, r = 0; r < n; k++) {
    mg_real gain = 0;
    for (const int end = r + c->friction.cone_rows[k]; r < end; r++)
      gain += c->lcp.z[r] * (c->d_dot[c->lcp.rows[r]] + mg_row_times(c, c->lcp.rows[r], c->wrench) / 2);
    if (!(gain > c->run->gain_max)) continue;
    c->run->gain_max = gain, c->run->gain_t = c->run->t, c->run->gain_contact = c->friction.cone_contact[k];
  }
}

/* After an impact grips are told by their slip anew. */
MG_INTERNAL void mg_clear_slip(mg_context *c) {
  for (int g = 0; g < c->system->n_grip; g++) c->run->grip[g] = MG_FRICTION_OFF, c->friction.triggered[g] = 0;
  mg_clear_patch_friction(c);
  mg_slip_rates(c);
}
