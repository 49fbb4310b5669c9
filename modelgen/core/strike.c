/* Impacts with friction: Newton's restitution and Coulomb's law for impulses, at every closed contact at once (Moreau;
   Glocker and Pfeiffer, Nonlinear Dynamics 7 (1995), 471-497, with Newton's law in place of Poisson's). */
#include "core.h"

static void mg_put_kinetic(mg_context *c, int contact, mg_real *cone) {
  for (int k = 0; k < MG_CONE; k++) cone[k] = 0;
  for (int g = c->sys->contact_grip[contact]; g < c->sys->contact_grip[contact + 1]; g++) {
    const int aspect = c->sys->grip_aspect[g], at = aspect == MG_SLIP ? 0 : 1 + aspect;
    cone[at] = c->sys->grip_kinetic[2 * g];
    if (aspect == MG_SLIP) cone[1] = c->sys->grip_kinetic[2 * g + 1];
    c->bound_of[g] = MG_KINETIC;
  }
}

/* Of all closed contacts, with the velocities after the impact as what the impulses must make right. */
static mg_friction_problem mg_pose_impact(mg_context *c) {
  mg_friction_problem p = {0, 0, MG_COULOMB, 0, c->cone_first, c->cone_rows, c->cone, c->A, c->b, 0};
  for (int i = 0; i < c->sys->n_contact; i++) {
    if (!c->run->closed[i]) continue;
    mg_put_kinetic(c, i, c->cone + MG_CONE * p.n_contact);
    p.n = mg_put_contact(c, i, p.n_contact++, p.n);
  }
  p.n = mg_list_joints(c, c->list, p.n);
  mg_assemble(c, c->list, p.n);
  for (int r = 0; r < p.n; r++) {
    const int row = c->list[r];
    c->b[r] = c->d_dot[row] * (row < c->sys->n_contact ? 1 + mg_rebound(c, row) : 1), c->z[r] = 0;
  }
  return p;
}

/* Newton's law with friction may make energy: notes the contact that makes most. Needs d_dot before the impact. */
static void mg_note_gain(mg_context *c, const mg_friction_problem *p) {
  for (int k = 0; k < p->n_contact; k++) {
    mg_real gain = 0;
    for (int r = c->cone_first[k]; r < c->cone_first[k] + c->cone_rows[k]; r++) {
      const mg_real before = c->d_dot[c->list[r]];
      gain += c->z[r] * (before + mg_row(c, c->list[r], c->wrench) / 2);
    }
    if (!(gain > c->run->gain_max)) continue;
    c->run->gain_max = gain, c->run->gain_t = c->run->t, c->run->gain = c->cone_contact[k];
  }
}

static int mg_struck(mg_context *c) {
  for (int i = 0; i < c->sys->n_contact; i++)
    if (c->run->closed[i] && mg_nearing(c, i)) return 1;
  return 0;
}

/* Needs the rows at run->x. Does nothing unless a closed contact approaches. */
static int mg_impact_with_friction(mg_context *c, mg_events *events) {
  mg_friction_report report;
  if (!mg_struck(c)) return MG_DONE;
  const mg_friction_problem p = mg_pose_impact(c);
  c->run->lcp_solves++;
  if (mg_friction(&p, c->z, c->marks, &report, c->coulomb, c->coulomb_i)) return MG_COMPLEMENTARITY;
  for (int i = 0; i < 6 * c->sys->n_body; i++) c->wrench[i] = 0;
  for (int r = 0; r < p.n; r++) mg_add(c, c->list[r], c->z[r], c->wrench);
  mg_note_gain(c, &p);
  mg_apply_impulses(c, p.n);
  mg_poses(c, c->run->t, c->run->x);
  for (int k = 0; k < p.n_contact; k++) c->list[k] = c->cone_contact[k];
  mg_after_impact(c, events, p.n_contact);
  for (int g = 0; g < c->sys->n_grip; g++) c->run->grip[g] = MG_LOOSE, c->slipped[g] = 0;
  mg_slip_rates(c);
  return MG_DONE;
}
