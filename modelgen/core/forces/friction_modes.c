/* Which closed contacts carry force, which of their grips hold and which slip: Coulomb's law for accelerations. A slip
   that is under way tells its force by itself; the others are bounded by static friction, or kinetic once they slip. */
/* Events of grips: a stuck one reaches its bound, a slipping one comes to rest. */
#include "forces/forces.h"
#include "base/base.h"
#include "solve/friction/solvers.h"
#include "model/model.h"

/* The time in which slip, as it is going, is over; 0 if it is already. */
static mg_real mg_slip_left(const mg_context *c, int contact, int grip) {
  const mg_real *course = c->run->slip_direction + 3 * grip, *t = c->tangents + 6 * contact;
  const int row = mg_grip_row(c, contact, grip), spins = c->system->grip_aspect[grip] == MG_SPIN;
  mg_real slip[2], braking = -mg_gap_acceleration(c, row) * (spins ? course[0] : mg_dot3(t, course));
  if (!spins) braking -= mg_gap_acceleration(c, row + 1) * mg_dot3(t + 3, course);
  const mg_real along = mg_speed_along_slip(c, contact, grip, slip);
  return along > 0 && braking > 0 ? along / braking : 0;
}

static mg_real mg_slip_size(const mg_context *c, int contact, int grip) {
  mg_real slip[2];
  mg_speed_along_slip(c, contact, grip, slip);
  return sqrt(slip[0] * slip[0] + slip[1] * slip[1]);
}

/* The course of a grip along its slip, in world axes. */
static void mg_set_on_course(mg_context *c, int contact, int grip) {
  const mg_real *t = c->tangents + 6 * contact, size = mg_slip_size(c, contact, grip);
  mg_real slip[2], *course = c->run->slip_direction + 3 * grip;
  mg_speed_along_slip(c, contact, grip, slip);
  for (int k = 0; k < 3; k++) course[k] = (slip[0] * t[k] + slip[1] * t[3 + k]) / size;
  if (c->system->grip_aspect[grip] == MG_SPIN) course[0] = slip[0] > 0 ? 1 : -1;
}

/* Notes where a grip slips. Returns 0 where it hardly does. */
static int mg_aim(mg_context *c, int contact, int grip) {
  if (!(mg_slip_size(c, contact, grip) > 2 * mg_stick_speed(c, grip))) return 0;
  mg_set_on_course(c, contact, grip);
  return 1;
}

/* A grip is told by its slip; one that hardly slips is stuck until the forces say otherwise, for slip that dies or
   begins at one contact dies or begins at others of the body as well. */
static void mg_sort_out(mg_context *c, int contact, int grip) {
  int *mode = c->run->grip + grip;
  if (!c->run->closed[contact]) *mode = MG_FRICTION_OFF;
  else if (*mode == MG_FRICTION_OFF && mg_aim(c, contact, grip)) *mode = MG_SLIPPING;
  else if (*mode >= MG_SLIP_ONSET) {
    const int slips = mg_aim(c, contact, grip); /* if its event has fired, it has only left its course */
    if (c->friction.triggered[grip] && !slips) c->friction.slip_time_left[grip] = mg_slip_left(c, contact, grip);
    *mode = slips ? MG_SLIPPING : MG_STICKING, c->friction.triggered[grip] &= !slips;
  }
}

/* The kinetic energy that the correction of the first n rows of c->lcp.rows takes. */
static mg_real mg_energy_taken(const mg_context *c, int n) {
  mg_real sum = 0;
  for (int r = 0; r < n; r++) sum -= c->impulse[c->lcp.rows[r]] * c->d_dot[c->lcp.rows[r]] / 2;
  return sum;
}

/* The stuck grip that slips most, against what counts as slip, goes on slipping; returns 0 if there is none. */
static int mg_release_fastest(mg_context *c) {
  mg_real most = 0;
  int contact = -1, fastest = -1;
  for (int i = 0; i < c->system->n_contact; i++)
    for (int g = c->system->contact_grip[i]; g < c->system->contact_grip[i + 1]; g++) {
      if (!c->run->active[i] || c->run->grip[g] != MG_STICKING) continue;
      const mg_real size = mg_slip_size(c, i, g) / mg_stick_speed(c, g);
      if (size > most) most = size, contact = i, fastest = g;
    }
  if (fastest < 0) return 0;
  mg_set_on_course(c, contact, fastest);
  c->run->grip[fastest] = MG_SLIP_STARTING;
  return 1;
}

/* Takes the slip of stuck grips away, as an impulse would. Where that would take far more energy than so little slip
   has, as at two points that nearly are one, a grip slips on. */
static void mg_arrest(mg_context *c) {
  const mg_real fast = c->settings->arrest * c->settings->slip_speed * c->system->length / c->system->time;
  do {
    mg_real worst = 0;
    const int n = mg_append_sticking_rows(c, c->lcp.rows, 0);
    for (int r = 0; r < n; r++)
      if (fabs(c->d_dot[c->lcp.rows[r]]) > worst) worst = fabs(c->d_dot[c->lcp.rows[r]]);
    if (!(worst > c->settings->drift * c->system->length / c->system->time)) return;
  } while (mg_energy_taken(c, mg_projection_step(c, c->run->closed, c->d_dot)) > c->system->mass * fast * fast / 2 &&
           mg_release_fastest(c));
  mg_correct_velocities(c);
  mg_update_rows_and_forces(c);
}

/* The rows and accelerations without contact forces. */
static void mg_let_go(mg_context *c) {
  for (int i = 0; i < c->system->n_contact; i++) c->run->active[i] = 0;
  mg_update_rows_and_forces(c);
}

/* The leans of slips under way, of contacts that carry no force as yet. */
static void mg_lean_known(mg_context *c, int contact) {
  for (int g = c->system->contact_grip[contact]; g < c->system->contact_grip[contact + 1]; g++) {
    if (c->friction.bound[g] != MG_BOUND_SLIP) continue;
    mg_update_force_ratio(c, contact, g);
    for (int k = 0; k < mg_grip_rows(c, g); k++) mg_inverse_mass_row(c, mg_grip_row(c, contact, g) + k);
  }
}

/* The matrix and the accelerations of the closed contacts that are not skipped, of pads and of joints. */
static mg_friction_problem mg_pose_problem(mg_context *c, const int *skip) {
  mg_friction_problem p = {
      0, 0, MG_COULOMB, 1, c->friction.cone_first, c->friction.cone_rows, c->friction.cone, c->lcp.A, c->lcp.b, 0, 0};
  for (int i = 0; i < c->support_begin; i++)
    if (c->run->closed[i] && !skip[i]) p.n = mg_append_contact_rows(c, i, p.n_contact++, p.n);
  mg_activate_supports(c);
  p.n = mg_append_sticking_patches(c, c->lcp.rows, mg_append_bilateral_rows(c, c->lcp.rows, p.n));
  mg_assemble_delassus(c, c->lcp.rows, p.n);
  for (int k = 0; k < p.n_contact; k++) mg_lean_known(c, c->friction.cone_contact[k]);
  mg_begin_patch_friction(c);
  mg_couple_columns(c, c->lcp.rows, p.n);
  for (int r = 0; r < p.n; r++) c->lcp.b[r] = mg_gap_acceleration(c, c->lcp.rows[r]);
  return p;
}

/* Notes a contact that slips on under its forces, and parts without: by itself it would do either (Painleve). */
static void mg_note_paradox(mg_context *c, const mg_friction_problem *p) {
  for (int k = 0; k < p->n_contact && c->run->paradox_contact < 0; k++) {
    const int first = p->first[k], contact = c->friction.cone_contact[k];
    if (p->A[first * (p->n + 1)] < 0 && p->b[first] > mg_rest_acceleration(c))
      c->run->paradox_contact = contact, c->run->paradox_t = c->run->t;
  }
}

static int mg_try_cones(mg_context *c, const mg_friction_problem *p, mg_real part, mg_real *z,
                        mg_friction_report *report) {
  c->run->lcp_solves++;
  for (int k = 0; k < p->n_contact; k++)
    mg_write_cone(c, c->friction.cone_contact[k], part, c->friction.cone + MG_CONE * k);
  for (int r = 0; r < p->n; r++) z[r] = 0;
  return mg_friction_with_bilateral(c, p, z, report) == MG_FRICTION_SOLVED;
}

/* How fast a row gets away under the forces z. */
static mg_real mg_way_of(const mg_friction_problem *p, const mg_real *z, int row) {
  mg_real sum = p->b[row];
  for (int j = 0; j < p->n; j++) sum += p->A[row + p->n * j] * z[j];
  return sum;
}

/* What counts as moving off among accelerations that are known to the solver's residual. */
static mg_real mg_certain(const mg_context *c, const mg_friction_problem *p) {
  mg_real size = 0;
  for (int r = 0; r < p->n; r++)
    if (fabs(p->b[r]) > size) size = fabs(p->b[r]);
  return 10 * c->settings->cone * size;
}

/* A grip of contact k of the problem is on its bound and moves off, against what its force at the bound does to it. */
static int mg_gives_way(const mg_context *c, const mg_friction_problem *p, int k, int grip) {
  const int first = p->first[k], row = first + 1 + c->system->grip_row[grip], aspect = c->system->grip_aspect[grip];
  const mg_real *cone = p->cone + MG_CONE * k + mg_cone_index(aspect), N = c->lcp.z[first];
  mg_real way = 0, own = 0, size = 0;
  if (!(c->friction.marks[k] & MG_PRESSES)) return 0;
  for (int j = 0; j < mg_grip_rows(c, grip); j++) {
    const mg_real mu = cone[aspect == MG_SLIP ? j : 0], part = c->lcp.z[row + j] / mu;
    way += fabs(mg_way_of(p, c->lcp.z, row + j)), own += fabs(p->A[(row + j) * (p->n + 1)]) * mu * N,
        size += part * part;
  }
  return way > c->settings->cone / 10 * own && sqrt(size) > (1 - c->settings->polish) * N;
}

/* Marks the grips found to slip; returns their number. */
static int mg_mark_giving(mg_context *c, const mg_friction_problem *p) {
  int count = 0;
  for (int k = 0; k < p->n_contact; k++) {
    const int i = c->friction.cone_contact[k];
    for (int g = c->system->contact_grip[i]; g < c->system->contact_grip[i + 1]; g++)
      count += c->friction.is_yielding[g] = c->friction.bound[g] != MG_BOUND_SLIP && mg_gives_way(c, p, k, g);
  }
  return count;
}

/* Those that slip get their kinetic bounds; returns how many bounds that changes. */
MG_INTERNAL int mg_apply_kinetic_bounds(mg_context *c) {
  int count = 0;
  for (int g = 0; g < c->system->n_grip; g++) {
    const mg_real *s = c->system->grip_static + 2 * g, *d = c->system->grip_kinetic + 2 * g;
    if (!c->friction.is_yielding[g] || c->friction.bound[g] == MG_BOUND_KINETIC) continue;
    c->friction.bound[g] = MG_BOUND_KINETIC;
    count += s[0] != d[0] || s[1] != d[1];
  }
  return count;
}

static void mg_set_course(mg_context *c, int contact, int grip, const mg_real *force) {
  const mg_real *mu = c->system->grip_kinetic + 2 * grip, *t = c->tangents + 6 * contact;
  const mg_real a = -force[0] / (mu[0] * mu[0]), b = mg_grip_rows(c, grip) == 2 ? -force[1] / (mu[1] * mu[1]) : 0;
  const mg_real size = sqrt(a * a + b * b);
  mg_real *course = c->run->slip_direction + 3 * grip;
  for (int k = 0; k < 3; k++) course[k] = (a * t[k] + b * t[3 + k]) / size;
  if (c->system->grip_aspect[grip] == MG_SPIN) course[0] = a > 0 ? 1 : -1;
}

/* Slip begins where the force has reached its bound, which stays as it is: there may be no acceleration at first. */
static int mg_begins_gently(const mg_context *c, int grip) {
  const mg_real *s = c->system->grip_static + 2 * grip, *d = c->system->grip_kinetic + 2 * grip;
  return c->friction.mode_before[grip] == MG_STICKING && s[0] == d[0] && s[1] == d[1] && mg_grip_rows(c, grip) == 2;
}

static void mg_take_modes(mg_context *c, const mg_friction_problem *p) {
  for (int k = 0; k < p->n_contact; k++) {
    const int i = c->friction.cone_contact[k];
    c->run->active[i] = (c->friction.marks[k] & MG_PRESSES) != 0;
    for (int g = c->system->contact_grip[i]; g < c->system->contact_grip[i + 1]; g++) {
      if (!c->friction.is_yielding[g]) continue;
      mg_set_course(c, i, g, c->lcp.z + c->friction.cone_first[k] + 1 + c->system->grip_row[g]);
      c->run->grip[g] = mg_begins_gently(c, g) ? MG_SLIP_ONSET : MG_SLIP_STARTING;
    }
  }
}

/* The solution is added to what the joints hold by themselves. */
static void mg_take_shares(mg_context *c, const mg_friction_problem *p) {
  for (int i = 0; i < c->friction_row_end; i++) c->run->reference_force[i] = 0;
  for (int r = 0; r < p->n; r++) c->run->reference_force[c->lcp.rows[r]] = c->force[c->lcp.rows[r]] + c->lcp.z[r];
  c->run->forces_redundant = 1;
}

static int mg_is_admissible(const mg_context *c) {
  for (int i = 0; i < c->support_begin; i++) {
    if (!c->run->active[i]) continue;
    if (!(c->force[i] > 0)) return 0;
    for (int g = c->system->contact_grip[i]; g < c->system->contact_grip[i + 1]; g++)
      if (c->run->grip[g] == MG_STICKING && !(mg_friction_event_value(c, i, g) > c->settings->cone * c->force[i]))
        return 0;
  }
  return 1;
}

/* Tries forces of least norm on all contacts that do not move off; where these are not admissible, the contacts are
   left as they were. */
static int mg_spread(mg_context *c, const mg_friction_problem *p) {
  for (int k = 0; k < p->n_contact; k++)
    if (mg_way_of(p, c->lcp.z, c->friction.cone_first[k]) < mg_certain(c, p))
      c->run->active[c->friction.cone_contact[k]] = 1;
  c->run->forces_redundant = 0;
  mg_update_rows_and_forces(c);
  if (mg_is_admissible(c)) return 1;
  for (int k = 0; k < p->n_contact; k++)
    c->run->active[c->friction.cone_contact[k]] = (c->friction.marks[k] & MG_PRESSES) != 0;
  c->run->forces_redundant = 1;
  return 0;
}

/* Forces that hold all grips and are well within their bounds, if there are any. */
static void mg_relieve(mg_context *c, const int *skip) {
  mg_friction_report report;
  const mg_friction_problem p = mg_pose_problem(c, skip);
  for (mg_real less = (mg_real)0.5; less > c->settings->cone; less /= 4) {
    if (!mg_try_cones(c, &p, 1 - less, c->lcp.z, &report) || mg_mark_giving(c, &p)) continue;
    mg_take_modes(c, &p);
    mg_take_shares(c, &p);
    return;
  }
  for (int k = 0; k < p.n_contact; k++) c->run->active[c->friction.cone_contact[k]] = 1;
}

/* Which of the forces that make the same motion are meant. Needs the problem as it was solved. */
static void mg_settle_shares(mg_context *c, const int *skip, const mg_friction_problem *p, int giving) {
  mg_take_shares(c, p);
  if (mg_spread(c, p) || giving) return;
  mg_let_go(c);
  mg_relieve(c, skip);
}

/* `idle`: rows of the joints that follow from others of theirs; they leave the contacts' forces as they are. */
static void mg_note_report(mg_context *c, const mg_friction_report *report, int idle) {
  const int redundant = report->active - report->rank - idle;
  if (redundant > c->run->redundant_max) c->run->redundant_max = redundant;
  if (report->residual > c->run->lcp_residual_max) c->run->lcp_residual_max = report->residual;
}

/* Solves for the modes of the closed contacts that are not skipped. Needs the rows at run->x. */
MG_INTERNAL int mg_solve_friction_modes(mg_context *c, const int *skip) {
  mg_friction_report report = {0};
  int giving, redundant, idle = 0;
  for (int i = 0; i < c->system->n_contact; i++)
    for (int g = c->system->contact_grip[i]; g < c->system->contact_grip[i + 1]; g++)
      mg_sort_out(c, i, g), c->friction.is_yielding[g] = 0;
  mg_arrest(c);
  mg_update_friction_bounds(c);
  mg_let_go(c);
  if (c->system->n_row) idle = c->system->n_row - mg_rank_joints(c, 0);
  const mg_friction_problem p = mg_pose_problem(c, skip);
  if (p.n_contact == 0) {
    mg_update_rows_and_forces(c);
    return MG_DONE;
  }
  redundant = mg_asymmetric_rank(c, c->lcp.rows, p.n) < p.n - idle;
  do {
    if (!mg_try_cones(c, &p, redundant ? 1 - c->settings->cone : 1, c->lcp.z, &report)) return MG_NO_FRICTION;
    giving = mg_mark_giving(c, &p);
  } while (mg_apply_kinetic_bounds(c));
  mg_note_report(c, &report, idle);
  mg_note_paradox(c, &p);
  mg_take_modes(c, &p);
  c->run->forces_redundant = 0;
  if (redundant) mg_settle_shares(c, skip, &p, giving);
  for (int i = 0; i < c->system->n_contact; i++)
    for (int g = c->system->contact_grip[i]; !c->run->active[i] && g < c->system->contact_grip[i + 1]; g++)
      c->run->grip[g] = MG_FRICTION_OFF;
  mg_update_rows_and_forces(c);
  mg_arrest(c);
  return MG_DONE;
}

/* Tells of slip that begins, dies, or dies and begins anew. */
MG_INTERNAL void mg_report_friction_events(mg_context *c, mg_events *events) {
  for (int i = 0; i < c->system->n_contact; i++)
    for (int g = c->system->contact_grip[i]; g < c->system->contact_grip[i + 1]; g++) {
      const int before = c->friction.mode_before[g], now = c->run->grip[g];
      const int first = MG_EVENT_SLIP + MG_EVENTS_A_GRIP * c->system->grip_aspect[g];
      if (before == MG_STICKING && now >= MG_SLIP_ONSET) mg_report_event(c, events, c->run->t, first, i, 0);
      if (before >= MG_SLIP_ONSET && now == MG_STICKING)
        mg_report_event(c, events, c->run->t + c->friction.slip_time_left[g], first + 1, i, 0);
      if (before >= MG_SLIP_ONSET && now >= MG_SLIP_ONSET && now != MG_SLIPPING && c->friction.triggered[g])
        mg_report_event(c, events, c->run->t + c->friction.slip_time_left[g], first + 2, i, 0);
      c->friction.slip_time_left[g] = 0;
    }
}

/* N - |f / mu|, N: what is left of the bound of a stuck grip. */
static mg_real mg_grip_left(const mg_context *c, int contact, int grip) {
  const int row = mg_grip_row(c, contact, grip);
  const mg_real *mu = c->system->grip_static + 2 * grip;
  const mg_real a = c->force[row] / mu[0], b = mg_grip_rows(c, grip) == 2 ? c->force[row + 1] / mu[1] : 0;
  return c->force[contact] - sqrt(a * a + b * b);
}

/* The event function of a grip, which falls through zero: force left, or slip left along the course. */
MG_INTERNAL mg_real mg_friction_event_value(const mg_context *c, int contact, int grip) {
  mg_real slip[2];
  return c->run->grip[grip] == MG_STICKING ? mg_grip_left(c, contact, grip)
                                           : mg_speed_along_slip(c, contact, grip, slip);
}

/* What is left before the event of a grip; MG_MAX where it has none. Slip that has reached slip_speed is over below it;
   one that has not, once it goes back as fast. */
MG_INTERNAL mg_real mg_friction_event_margin(const mg_context *c, int contact, int grip) {
  const int mode = c->run->grip[grip];
  if (!c->run->active[contact] || mode == MG_FRICTION_OFF) return MG_MAX;
  const mg_real rest = mg_stick_speed(c, grip), slack = mg_rest_acceleration(c) * c->system->mass;
  const mg_real least = mode == MG_STICKING ? -slack : mode == MG_SLIPPING ? rest : -rest;
  return mg_friction_event_value(c, contact, grip) - least;
}

static int mg_has_fired(const mg_context *c, int contact, int grip) {
  return mg_friction_event_margin(c, contact, grip) < 0;
}

/* Marks in c->friction.triggered the grips whose event has fired; returns their number. Needs mg_rhs and mg_gap_rates.
 */
MG_INTERNAL int mg_trigger_friction(mg_context *c) {
  int count = 0;
  for (int i = 0; i < c->system->n_contact; i++)
    for (int g = c->system->contact_grip[i]; g < c->system->contact_grip[i + 1]; g++)
      count += c->friction.triggered[g] = mg_has_fired(c, i, g);
  return count;
}

/* As mg_trigger_friction at a stage, without marks. */
MG_INTERNAL int mg_is_friction_event_near(const mg_context *c) {
  for (int i = 0; i < c->system->n_contact; i++)
    for (int g = c->system->contact_grip[i]; g < c->system->contact_grip[i + 1]; g++)
      if (mg_has_fired(c, i, g)) return 1;
  return 0;
}

MG_INTERNAL int mg_first_triggered_grip(const mg_context *c) {
  for (int g = 0; g < c->system->n_grip; g++)
    if (c->friction.triggered[g]) return g;
  return -1;
}

/* At the start of a step: the courses that tell its forces, the modes that its events are told by. Needs the rows at
   run->x. */
MG_INTERNAL void mg_set_slip_directions(mg_context *c) {
  for (int i = 0; i < c->system->n_contact; i++)
    for (int g = c->system->contact_grip[i]; g < c->system->contact_grip[i + 1]; g++)
      if (c->run->active[i] && c->run->grip[g] >= MG_SLIP_STARTING && mg_aim(c, i, g)) c->run->grip[g] = MG_SLIPPING;
  for (int g = 0; g < c->system->n_grip; g++) c->friction.mode_before[g] = c->run->grip[g];
}
