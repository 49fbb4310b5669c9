/* Derivatives of what the sensors show at one state, and whether they hold there: not where a sensor is on a kink or at
   a jump, as abs(x) at zero, the nearest of two gaps that are equal, or an angle of half a turn; nor where it shows
   forces that are not unique, of which any share may be taken. Reads the state and its derivatives; writes s->y_dot and
   s->reasons. */
#include "sensitivity/sensitivity.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/integrate.h"

/* Gap of each pair where its contacts have gone on by `part` of their derivatives: the least of them. */
static void mg_move_gaps(const mg_context *c, const mg_sensitivity *s, mg_real part, mg_real *pair) {
  const mg_system *system = c->system;
  for (int p = mg_next_pair(c, -1); p < system->n_pair; p = mg_next_pair(c, p)) {
    mg_real least = MG_MAX;
    for (int i = system->pair_contact[p]; i < system->pair_contact[p + 1]; i++)
      if (mg_is_on_feature_pair(c, i)) least = mg_min(least, c->rows.d[i] + part * s->at.value[i]);
    if (least < MG_MAX) pair[2 * p] = least;
  }
}

/* Adds forces on the rows to the normal force of each pair and to the wrench of each joint; NaN where the shares of the
   pairs of one face are not unique, or `moves` with their places. */
static void mg_add_sensed_forces(mg_context *c, mg_sensitivity *s, const mg_real *force, int moves) {
  const mg_system *system = c->system;
  for (int p = mg_next_pair(c, -1); p < system->n_pair; p = mg_next_pair(c, p))
    for (int i = system->pair_contact[p]; i < system->pair_contact[p + 1]; i++)
      if (mg_is_on_feature_pair(c, i) && c->run->active[i]) s->pair[2 * p + 1] += force[i];
  for (int slot = 0; slot < system->n_patch_slot; slot++) {
    const int patch = mg_patch_of_slot(c, slot), support = mg_first_support(c, slot);
    if (patch < 0) continue;
    const int first = system->patch_share[patch], end = system->patch_share[patch + 1],
              is_known =
                  first == end || (!moves && mg_find_patch_shares(c, slot, c->solution.force) == MG_SHARES_FIXED);
    for (int i = support; i < support + 3 && first == end; i++) s->pair[2 * system->patch_pair[patch] + 1] += force[i];
    for (int k = first; k < end; k++)
      s->pair[2 * system->share_pair[k] + 1] += is_known ? mg_share_force(c, slot, k - first, force) : (mg_real)NAN;
  }
  for (int j = 0; j < system->n_joint; j++) {
    const int first = c->layout.joint_row_begin + system->joint_row[j];
    for (int r = first; r < first + mg_held_joint_rows(c, j); r++)
      for (int k = 0; k < 6; k++) s->joint[6 * j + k] += c->rows.J[12 * r + 6 + k] * force[r];
  }
}

/* Derivatives of the gap and normal force of each pair and of the wrench of each joint, along the direction that
   mg_rhs_tangent has treated, in s->pair and s->joint. */
static void mg_sensed_forces_tangent(mg_context *c, mg_sensitivity *s, int direction) {
  const mg_system *system = c->system;
  mg_real *pair = s->pair, *joint = s->joint;
  mg_zero_reals(pair, 2L * system->n_pair), mg_zero_reals(joint, 6L * system->n_joint);
  for (int p = mg_next_pair(c, -1); p < system->n_pair; p = mg_next_pair(c, p)) {
    mg_real least = MG_MAX;
    for (int i = system->pair_contact[p]; i < system->pair_contact[p + 1]; i++)
      if (mg_is_on_feature_pair(c, i) && c->rows.d[i] < least) least = c->rows.d[i], pair[2 * p] = s->at.value[i];
  }
  for (int j = 0; j < system->n_joint; j++) {
    const int rows = mg_held_joint_rows(c, j), first = c->layout.joint_row_begin + system->joint_row[j];
    mg_real force[MG_ROWS_OF_ONE] = {0};
    if (!rows) continue;
    mg_copy_reals(force, c->solution.force + first, rows);
    mg_joint_tangent(c, s, direction, j, c->run->t, force, 0);
    for (int k = 0; k < 6; k++) joint[6 * j + k] = s->y_dot[MG_Y_SECOND + k];
  }
  mg_add_sensed_forces(c, s, s->at.force, s->directions->moves_borders && s->directions->moves_borders[direction]);
}

/* A group of the packed arguments of the sensors: so many numbers, and the scale of those that are zero; 0: none. */
typedef struct {
  int n;
  mg_real scale;
} mg_packed_group;

#define MG_SENSOR_GROUPS 10

static void mg_list_packed_groups(const mg_context *c, mg_packed_group *group) {
  const mg_system *s = c->system;
  const mg_real force = s->mass * s->length / (s->time * s->time);
  const mg_packed_group all[MG_SENSOR_GROUPS] = {{1, s->time},
                                                 {12 * s->n_body, mg_max(s->length, 1)},
                                                 {6 * s->n_body, mg_max(s->length, 1) / s->time},
                                                 {6 * s->n_body, mg_max(s->length, 1) / (s->time * s->time)},
                                                 {2 * s->n_pair, mg_max(s->length, force)},
                                                 {6 * s->n_joint, force * mg_max(s->length, 1)},
                                                 {3, s->length / (s->time * s->time)},
                                                 {s->n_parameters - s->sensor_parameters, 0},
                                                 {3 * s->n_input, 1},
                                                 {0, 0}};
  for (int k = 0; k < MG_SENSOR_GROUPS; k++) group[k] = all[k];
}

/* Largest change of the packed arguments along a direction, by their sizes and scales; *largest: of the arguments but
   for parameters and inputs. */
static mg_real mg_packed_change(const mg_context *c, const mg_sensitivity *s, mg_real *largest) {
  mg_packed_group group[MG_SENSOR_GROUPS];
  mg_real most = 0;
  *largest = 0;
  mg_list_packed_groups(c, group);
  for (int k = 0, i = 0; k < MG_SENSOR_GROUPS; k++)
    for (const int end = i + group[k].n; i < end; i++) {
      const mg_real size = mg_max(fabs(s->x[i]), group[k].scale);
      if (size > 0) most = mg_max(most, fabs(s->x_dot[i]) / size);
      if (k < 7) *largest = mg_max(*largest, fabs(s->x[i]));
    }
  return most;
}

/* What the sensors show where their packed arguments have gone on by `part` of their derivatives. */
static void mg_show_moved_sensors(const mg_context *c, const mg_sensitivity *s, mg_real part, mg_real *shown) {
  mg_packed_group group[MG_SENSOR_GROUPS];
  const mg_real *argument[MG_SENSOR_GROUPS];
  mg_list_packed_groups(c, group);
  for (int k = 0, i = 0; k < MG_SENSOR_GROUPS; k++) {
    argument[k] = s->moved + i;
    for (const int end = i + group[k].n; i < end; i++) s->moved[i] = s->x[i] + part * s->x_dot[i];
    if (k == 4 && c->kernels->sensors_need_forces) mg_move_gaps(c, s, part, s->moved + i - group[k].n);
  }
  c->kernels->sense(0, argument[0], argument[1], argument[2], argument[3], argument[4], argument[5], argument[6],
                    argument[7], argument[8], shown);
}

#define MG_PROBE_PART ((mg_real)1e-5) /* of the sizes of what sensors depend on: how far a kink is sought */
#define MG_PROBE_SHORTER 16           /* times shorter: whether it is a kink, or a bend */
#define MG_PROBE_KINK ((mg_real)1e-4) /* of a slope: least difference of both sides that is a kink */

/* True if what sensor k shows, s->shown, has another slope on each side of the state, or another than its derivative,
   by as much on a shorter way. size: of what it may be the difference of. */
static int mg_is_sensor_on_kink(const mg_sensitivity *s, int n, int k, mg_real longest, mg_real size) {
  mg_real off[2][2]; /* differences of both sides, and of their mean from the derivative */
  int is_kink[2] = {1, 1};
  for (int shorter = 0; shorter < 2; shorter++) {
    const mg_real part = longest / (shorter ? MG_PROBE_SHORTER : 1), now = s->shown[k],
                  before = s->shown[(1 + 2 * shorter) * n + k], after = s->shown[(2 + 2 * shorter) * n + k],
                  left = (now - before) / part, right = (after - now) / part,
                  slope = fabs(left) + fabs(right) + fabs(s->y_dot[k]),
                  least = MG_PROBE_KINK * slope + 64 * MG_EPS * (size + fabs(now) + fabs(after) + fabs(before)) / part;
    off[shorter][0] = fabs(right - left), off[shorter][1] = fabs((left + right) / 2 - s->y_dot[k]);
    for (int i = 0; i < 2; i++) is_kink[i] &= off[shorter][i] > least && (!shorter || off[1][i] > off[0][i] / 4);
  }
  return is_kink[0] || is_kink[1];
}

/* Marks the sensors that are on a kink. Needs their packed arguments and the derivatives of these. */
static void mg_mark_kinks_of_sensors(const mg_context *c, mg_sensitivity *s) {
  const int n = c->kernels->n_sensor;
  mg_real largest;
  const mg_real most = mg_packed_change(c, s, &largest), longest = MG_PROBE_PART / most;
  if (!(most > 0)) return;
  mg_show_moved_sensors(c, s, 0, s->shown);
  for (int i = 1; i < 5; i++)
    mg_show_moved_sensors(c, s, (i % 2 ? -longest : longest) / (i > 2 ? MG_PROBE_SHORTER : 1), s->shown + i * n);
  for (int k = 0; k < n; k++)
    if (!s->reasons[k] && mg_is_sensor_on_kink(s, n, k, longest, largest)) s->reasons[k] = MG_BY_SENSOR_KINK;
}

/* Marks the sensors whose derivatives change where those of accelerations and forces are left out. */
static void mg_mark_sensors_of_forces(mg_context *c, mg_sensitivity *s, int direction, int reason) {
  const int n = c->kernels->n_sensor;
  mg_real *with = s->shown;
  for (int k = 0; k < n; k++) with[k] = s->y_dot[k];
  mg_zero_reals(s->pair, 2L * c->system->n_pair), mg_zero_reals(s->joint, 6L * c->system->n_joint);
  mg_zero_reals(s->at.acceleration, 6L * c->system->n_body);
  mg_sensors_tangent(c, s, direction, c->run->t);
  for (int k = 0; k < n; k++) {
    if (fabs(with[k] - s->y_dot[k]) > sqrt(MG_EPS) * fabs(with[k])) s->reasons[k] = reason;
    s->y_dot[k] = with[k];
  }
}

MG_INTERNAL void mg_find_sensors_tangent(mg_context *c, mg_sensitivity *s, int direction) {
  const mg_real *dx = s->tangent->x + (long)direction * c->layout.n_states;
  const int reason = mg_find_kink(c, s, c->run->t, c->run->x, MG_AT_SAMPLE, direction);
  if (reason) mg_gather_wrenches(c, s, c->run->t);
  mg_rhs_tangent(c, s, direction, c->run->t, c->run->x, dx, s->stage);
  mg_sensed_forces_tangent(c, s, direction);
  mg_sensors_tangent(c, s, direction, c->run->t);
  for (int k = 0; k < c->kernels->n_sensor; k++)
    if (isnan(s->y_dot[k]) && !s->reasons[k]) s->reasons[k] = MG_BY_FORCES;
  mg_mark_kinks_of_sensors(c, s);
  if (reason) mg_mark_sensors_of_forces(c, s, direction, reason);
}

/* What sensors show of forces on the rows, beside what they show of none. */
static void mg_show_forces(mg_context *c, mg_sensitivity *s, const mg_real *force, mg_real *shown) {
  const int n = c->kernels->n_sensor;
  mg_zero_reals(s->pair, 2L * c->system->n_pair), mg_zero_reals(s->joint, 6L * c->system->n_joint);
  mg_sensors_tangent(c, s, 0, c->run->t);
  for (int k = 0; k < n; k++) shown[k] = -s->y_dot[k];
  mg_add_sensed_forces(c, s, force, 0);
  mg_sensors_tangent(c, s, 0, c->run->t);
  for (int k = 0; k < n; k++) shown[k] += s->y_dot[k];
}

MG_INTERNAL void mg_doubt_redundant_forces(mg_context *c, mg_sensitivity *s) {
  const int n = c->kernels->n_sensor;
  mg_real *redundant = s->shown, *all = redundant + n;
  if (!n || !c->kernels->sensors_need_forces || !mg_find_redundant_forces(c, s)) return;
  mg_zero_reals(s->at.pose, 18L * c->system->n_body), mg_zero_reals(s->at.acceleration, 6L * c->system->n_body);
  s->is_time = 1;
  mg_show_forces(c, s, s->at.force, redundant), mg_show_forces(c, s, s->at.value, all);
  s->is_time = 0;
  for (int k = 0; k < n; k++)
    if (fabs(redundant[k]) > sqrt(MG_EPS) * fabs(all[k])) s->reasons[k] = MG_BY_FORCES;
}
