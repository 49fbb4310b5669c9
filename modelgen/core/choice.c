/* Which closed contacts carry force, which of their grips hold and which slip: Coulomb's law for accelerations. A slip
   that is under way tells its force by itself; the others are bounded by static friction, or kinetic once they slip. */
#include "core.h"

enum { MG_KNOWN = 0, MG_STATIC = 1, MG_KINETIC = 2 }; /* what bounds a grip: its slip, or a cone */

/* A grip whose slip is dying is stuck until the forces say otherwise; one without a past is told by its slip. */
static void mg_sort_out(mg_context *c, int contact, int grip) {
  int *mode = c->run->grip + grip;
  if (!c->run->closed[contact]) *mode = MG_LOOSE;
  else if (*mode == MG_LOOSE && mg_aim(c, contact, grip)) *mode = MG_SLIPPING;
  else if (*mode >= MG_STARTING && c->slipped[grip]) {
    const int turned = mg_aim(c, contact, grip); /* it has only left its course */
    *mode = turned ? MG_SLIPPING : MG_STUCK, c->slipped[grip] = !turned && c->slipped[grip];
  }
}

/* Takes the slip of stuck grips away, as an impulse would. */
static void mg_arrest(mg_context *c) {
  mg_real worst = 0;
  const int n = mg_list_stuck(c, c->list, 0);
  for (int r = 0; r < n; r++)
    if (fabs(c->d_dot[c->list[r]]) > worst) worst = fabs(c->d_dot[c->list[r]]);
  if (!(worst > c->set->drift * c->sys->length / c->sys->time)) return;
  mg_correction(c, c->run->closed, c->d_dot);
  mg_push(c);
  mg_refresh(c);
}

static void mg_bound_all(mg_context *c) {
  for (int i = 0; i < c->sys->n_contact; i++)
    for (int g = c->sys->contact_grip[i]; g < c->sys->contact_grip[i + 1]; g++) {
      int *mode = c->run->grip + g;
      if (c->run->closed[i] && *mode == MG_LOOSE) *mode = MG_STUCK;
      c->bound_of[g] = *mode >= MG_STARTING ? MG_KNOWN : MG_STATIC;
    }
}

/* The bounds of one contact of the problem, times `part`. A stuck grip that has reached its own is tried with less. */
static void mg_put_cone(mg_context *c, int contact, mg_real part, mg_real *cone) {
  for (int k = 0; k < MG_CONE; k++) cone[k] = 0;
  for (int g = c->sys->contact_grip[contact]; g < c->sys->contact_grip[contact + 1]; g++) {
    const int aspect = c->sys->grip_aspect[g], at = aspect == MG_SLIP ? 0 : 1 + aspect;
    const mg_real *mu = (c->bound_of[g] == MG_STATIC ? c->sys->grip_static : c->sys->grip_kinetic) + 2 * g;
    const mg_real less = c->slipped[g] ? part * (1 - c->set->cone) : part;
    if (c->bound_of[g] == MG_KNOWN) continue;
    cone[at] = less * mu[0];
    if (aspect == MG_SLIP) cone[1] = less * mu[1];
  }
}

static int mg_is_open_question(const mg_context *c, int contact) {
  for (int g = c->sys->contact_grip[contact]; g < c->sys->contact_grip[contact + 1]; g++)
    if (c->bound_of[g] != MG_KNOWN) return 1;
  return 0;
}

/* Appends the rows of a contact to c->list of `size`, as contact k of the problem; returns the new size. */
static int mg_put_contact(mg_context *c, int contact, int k, int size) {
  c->cone_contact[k] = contact, c->cone_first[k] = size;
  c->cone_rows[k] = mg_is_open_question(c, contact) ? mg_contact_kinds[c->kind[contact]].rows : 1;
  c->list[size++] = contact;
  for (int r = 1; r < c->cone_rows[k]; r++) c->list[size++] = c->below + c->sys->contact_below[contact] + r - 1;
  return size;
}

/* The leans of slips under way, of contacts that carry no force as yet. */
static void mg_lean_known(mg_context *c, int contact) {
  for (int g = c->sys->contact_grip[contact]; g < c->sys->contact_grip[contact + 1]; g++) {
    if (c->bound_of[g] != MG_KNOWN) continue;
    mg_lean_of(c, contact, g);
    for (int k = 0; k < mg_grip_rows(c, g); k++) mg_weigh(c, mg_grip_row(c, contact, g) + k);
  }
}

/* The matrix and the accelerations of the closed contacts that are not skipped and of the joints. */
static mg_friction_problem mg_pose_problem(mg_context *c, const int *skip) {
  mg_friction_problem p = {0, 0, MG_COULOMB, 1, c->cone_first, c->cone_rows, c->cone, c->A, c->b};
  for (int i = 0; i < c->sys->n_contact; i++)
    if (c->run->closed[i] && !skip[i]) p.n = mg_put_contact(c, i, p.n_contact++, p.n);
  p.n = mg_list_joints(c, c->list, p.n);
  mg_assemble(c, c->list, p.n);
  for (int k = 0; k < p.n_contact; k++) mg_lean_known(c, c->cone_contact[k]);
  mg_lean_columns(c, c->list, p.n);
  for (int r = 0; r < p.n; r++) c->b[r] = mg_separation(c, c->list[r]);
  return p;
}

static int mg_try_cones(mg_context *c, const mg_friction_problem *p, mg_real part, mg_real *z,
                        mg_friction_report *report) {
  c->run->lcp_solves++;
  for (int k = 0; k < p->n_contact; k++) mg_put_cone(c, c->cone_contact[k], part, c->cone + MG_CONE * k);
  for (int r = 0; r < p->n; r++) z[r] = 0;
  return mg_friction(p, z, c->marks, report, c->coulomb, c->coulomb_i) == MG_FRICTION_SOLVED;
}

/* Whether a grip of contact k of the problem is found to slip. */
static int mg_gives_way(const mg_context *c, int k, int grip) {
  return c->bound_of[grip] != MG_KNOWN && (c->marks[k] & (MG_SLIPS << c->sys->grip_aspect[grip]));
}

/* Those that slip get their kinetic bounds; returns how many bounds that changes. */
static int mg_give_way(mg_context *c, int n_contact) {
  int count = 0;
  for (int k = 0; k < n_contact; k++) {
    const int i = c->cone_contact[k];
    for (int g = c->sys->contact_grip[i]; g < c->sys->contact_grip[i + 1]; g++) {
      const mg_real *s = c->sys->grip_static + 2 * g, *d = c->sys->grip_kinetic + 2 * g;
      if (!mg_gives_way(c, k, g) || c->bound_of[g] == MG_KINETIC) continue;
      c->bound_of[g] = MG_KINETIC;
      count += s[0] != d[0] || s[1] != d[1];
    }
  }
  return count;
}

static int mg_any_gives_way(const mg_context *c, int n_contact) {
  for (int k = 0; k < n_contact; k++)
    for (int g = c->sys->contact_grip[c->cone_contact[k]]; g < c->sys->contact_grip[c->cone_contact[k] + 1]; g++)
      if (mg_gives_way(c, k, g)) return 1;
  return 0;
}

/* Where forces are not unique and all grips hold, forces well within their bounds are taken if there are any. */
static void mg_center(mg_context *c, const mg_friction_problem *p, mg_friction_report *report) {
  static const mg_real parts[] = {(mg_real)0.5, (mg_real)0.8, (mg_real)0.95, (mg_real)0.99, (mg_real)0.999};
  if (report->rank >= report->active || mg_any_gives_way(c, p->n_contact)) return;
  for (int k = 0; k < 5; k++)
    if (mg_try_cones(c, p, parts[k], c->z, report) && !mg_any_gives_way(c, p->n_contact)) return;
  mg_try_cones(c, p, 1, c->z, report);
}

static void mg_set_course(mg_context *c, int contact, int grip, const mg_real *force) {
  const mg_real *mu = c->sys->grip_kinetic + 2 * grip, *t = c->tangents + 6 * contact;
  const mg_real a = -force[0] / (mu[0] * mu[0]), b = mg_grip_rows(c, grip) == 2 ? -force[1] / (mu[1] * mu[1]) : 0;
  const mg_real size = sqrt(a * a + b * b);
  mg_real *course = c->run->course + 3 * grip;
  for (int k = 0; k < 3; k++) course[k] = (a * t[k] + b * t[3 + k]) / size;
  if (c->sys->grip_aspect[grip] == MG_SPIN) course[0] = a > 0 ? 1 : -1;
}

static void mg_take_modes(mg_context *c, const mg_friction_problem *p) {
  for (int k = 0; k < p->n_contact; k++) {
    const int i = c->cone_contact[k];
    c->run->active[i] = (c->marks[k] & MG_PRESSES) != 0;
    for (int g = c->sys->contact_grip[i]; g < c->sys->contact_grip[i + 1]; g++) {
      if (!c->run->active[i]) c->run->grip[g] = MG_LOOSE;
      else if (mg_gives_way(c, k, g)) {
        mg_set_course(c, i, g, c->z + c->cone_first[k] + 1 + c->sys->grip_row[g]);
        c->run->grip[g] = MG_STARTING;
      }
    }
  }
}

static void mg_take_shares(mg_context *c, const mg_friction_problem *p, const mg_friction_report *report) {
  const int m = c->sys->n_contact, redundant = report->active - report->rank;
  c->run->shared = redundant > 0;
  if (redundant > c->run->redundant_max) c->run->redundant_max = redundant;
  if (report->residual > c->run->lcp_residual_max) c->run->lcp_residual_max = report->residual;
  for (int i = 0; i < m + c->sys->n_below; i++) c->run->share[i] = 0;
  for (int r = 0; r < p->n; r++) {
    const int row = c->list[r];
    if (row < m) c->run->share[row] = c->z[r];
    else if (row >= c->below) c->run->share[m + row - c->below] = c->z[r];
  }
}

/* Solves for the modes of the closed contacts that are not skipped. Needs the rows at run->x. */
static int mg_choose_grips(mg_context *c, const int *skip) {
  mg_friction_report report = {0};
  for (int i = 0; i < c->sys->n_contact; i++)
    for (int g = c->sys->contact_grip[i]; g < c->sys->contact_grip[i + 1]; g++) mg_sort_out(c, i, g);
  mg_arrest(c);
  mg_bound_all(c);
  for (int i = 0; i < c->sys->n_contact; i++) c->run->active[i] = 0;
  mg_refresh(c);
  mg_friction_problem p = mg_pose_problem(c, skip);
  if (p.n_contact == 0) return MG_DONE;
  do
    if (!mg_try_cones(c, &p, 1, c->z, &report)) return MG_NO_FRICTION;
  while (mg_give_way(c, p.n_contact));
  mg_center(c, &p, &report);
  mg_take_modes(c, &p);
  mg_take_shares(c, &p, &report);
  mg_refresh(c);
  mg_arrest(c);
  return MG_DONE;
}

/* Tells of slip that begins, dies, or dies and begins anew. */
static void mg_report_grips(mg_context *c, mg_events *events) {
  for (int i = 0; i < c->sys->n_contact; i++)
    for (int g = c->sys->contact_grip[i]; g < c->sys->contact_grip[i + 1]; g++) {
      const int before = c->before[g], now = c->run->grip[g];
      const int first = MG_EVENT_SLIP + MG_EVENTS_A_GRIP * c->sys->grip_aspect[g];
      if (before == MG_STUCK && now >= MG_STARTING) mg_emit(c, events, c->run->t, first, i, 0);
      if (before >= MG_STARTING && now == MG_STUCK) mg_emit(c, events, c->run->t, first + 1, i, 0);
      if (before >= MG_STARTING && now == MG_STARTING && c->slipped[g]) mg_emit(c, events, c->run->t, first + 2, i, 0);
    }
}
