/* Keeping eta on the extremum: Newton's step for one contact, and for all. */
#include "core.h"

/* Layout of c->place: d, residual (2), margin (2), normal (3), point_o (3), point_f (3). */
MG_INTERNAL int mg_place(mg_context *c, int contact, const mg_real *eta, mg_real *eta_next) {
  const int kind = c->kind[contact];
  mg_real *p = c->place;
  c->kernels->contact_place(kind, c->pose + 12 * c->o[contact], c->pose + 12 * c->f[contact], eta,
                   mg_parameters_of(c, contact), eta_next, p, p + 1, p + 3, p + 5, p + 8, p + 11);
  return c->kernels->contact_kinds[kind].n_eta;
}

MG_INTERNAL mg_real mg_margin_of(const mg_context *c) {
  const mg_real flat = c->place[4] * c->sys->length;
  return c->place[3] < flat ? c->place[3] : flat;
}

/* One Newton step for every contact at the poses of x, but for those that are flat yet, whose points rounding would move;
   writes d and the margin. Returns 0 if not finite. */
MG_INTERNAL int mg_place_all(mg_context *c, mg_real t, mg_real *x) {
  const mg_system *s = c->sys;
  mg_poses(c, t, x);
  for (int i = 0; i < s->n_contact; i++) {
    mg_real *eta = mg_eta_of(c, x, i), *next = c->place + 32;
    if (!mg_present(c, i)) continue;
    const int n = mg_place(c, i, eta, next), flat = mg_is_flat_yet(c, i);
    c->d[i] = c->place[0];
    c->run->margin[i] = mg_margin_of(c);
    for (int k = 0; k < n && !flat; k++) {
      if (!(fabs(next[k]) <= MG_MAX)) return 0;
      if (c->set->newton) eta[k] = next[k];
    }
  }
  return 1;
}

static int mg_settled(const mg_context *c) {
  return c->place[1] <= c->set->residual * c->sys->length && c->place[2] <= c->set->residual;
}

MG_INTERNAL int mg_settle_in(mg_context *c, int contact, mg_real *eta) {
  mg_real *next = c->place + 32;
  for (int step = 0; step < 50; step++) {
    const int n = mg_place(c, contact, eta, next);
    if (mg_settled(c)) return step;
    for (int k = 0; k < n; k++) {
      if (!(fabs(next[k]) <= MG_MAX)) return -1;
      eta[k] = next[k];
    }
  }
  return -1;
}

MG_API int mg_settle(const mg_system *system, const mg_settings *settings, const mg_run *run, int contact, mg_real *eta,
                     mg_real *d, mg_real *residual, mg_real *margin, mg_real *normal, mg_real *point_o,
                     mg_real *point_f, mg_real *work, int *iwork) {
  mg_context c;
  mg_run copy = *run;
  mg_open(&c, system, settings, &copy, work, iwork);
  mg_poses(&c, run->t, run->x);
  const int steps = mg_settle_in(&c, contact, eta);
  *d = c.place[0], residual[0] = c.place[1], residual[1] = c.place[2], margin[0] = c.place[3], margin[1] = c.place[4];
  for (int k = 0; k < 3; k++)
    normal[k] = c.place[5 + k], point_o[k] = c.place[8 + k], point_f[k] = c.place[11 + k];
  return steps;
}

MG_API void mg_pose_all(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real *pose, mg_real *work,
                        int *iwork) {
  mg_context c;
  mg_open(&c, system, settings, run, work, iwork);
  mg_poses(&c, run->t, run->x);
  for (int i = 0; i < 12 * system->n_body; i++) pose[i] = c.pose[i];
}
