/* Derivatives of what the sensors show at one state, and for which changes they hold: where a sensor is on a kink or at
   a jump, as abs(x) at zero, the nearest of two gaps that are equal, or an angle of half a turn, for those to one side
   alone; where it shows forces that are not unique, of which any share may be taken, for none. Reads the state and its
   derivatives; writes s->y_dot, s->reasons and s->sensor_sides. */
#include "sensitivity/sensitivity.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/integrate.h"

/* Gap of each pair where its contacts have gone on by `part` of their derivatives, the least of them, and its
   derivative; of both 2 numbers per pair, the gap first. */
static void mg_move_gaps(const mg_context *c, const mg_sensitivity *s, mg_real part, mg_real *pair, mg_real *pair_dot) {
  const mg_system *system = c->system;
  for (int p = mg_next_pair(c, -1); p < system->n_pair; p = mg_next_pair(c, p)) {
    mg_real least = MG_MAX;
    for (int i = system->pair_contact[p]; i < system->pair_contact[p + 1]; i++) {
      const mg_real gap = c->rows.d[i] + part * s->at.value[i];
      if (mg_is_on_feature_pair(c, i) && gap < least) least = gap, pair_dot[2 * p] = s->at.value[i];
    }
    if (least < MG_MAX && pair) pair[2 * p] = least;
  }
}

/* Sets the derivatives of the gap and normal force of each pair and of the wrench of each joint to zero. */
static void mg_sense_no_forces(const mg_context *c, mg_sensitivity *s) {
  mg_zero_reals(s->pair, 2L * c->system->n_pair), mg_zero_reals(s->joint, 6L * c->system->n_joint);
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
  MG_NEEDS_TANGENT(c, s, MG_VALID_TANGENTS, MG_VALID_FORCES, MG_ANY_DIRECTION, MG_NO_ROW);
  const mg_system *system = c->system;
  mg_sense_no_forces(c, s);
  mg_move_gaps(c, s, 0, 0, s->pair);
  for (int j = 0; j < system->n_joint; j++) {
    const int rows = mg_held_joint_rows(c, j), first = c->layout.joint_row_begin + system->joint_row[j];
    mg_real force[MG_ROWS_OF_ONE] = {0};
    if (!rows) continue;
    mg_copy_reals(force, c->solution.force + first, rows);
    mg_joint_tangent(c, s, direction, j, c->run->t, force, 0);
    for (int k = 0; k < 6; k++) s->joint[6 * j + k] = s->y_dot[MG_Y_SECOND + k];
  }
  mg_add_sensed_forces(c, s, s->at.force, s->directions->moves_borders && s->directions->moves_borders[direction]);
  MG_NOTE_TANGENT(c, s, MG_VALID_SENSED, MG_VALID_FORCES, direction, MG_NO_ROW);
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
      if (k < 7 && !isnan(s->x[i])) *largest = mg_max(*largest, fabs(s->x[i]));
    }
  return most;
}

/* What the sensors show where their packed arguments have gone on by `part` of their derivatives, and their derivatives
   there. */
static void mg_show_moved_sensors(const mg_context *c, mg_sensitivity *s, mg_real part, mg_real *shown,
                                  mg_real *slope) {
  mg_packed_group group[MG_SENSOR_GROUPS];
  const mg_real *argument[MG_SENSOR_GROUPS];
  mg_list_packed_groups(c, group);
  for (int k = 0, i = 0; k < MG_SENSOR_GROUPS; k++) {
    argument[k] = s->moved + i;
    for (const int end = i + group[k].n; i < end; i++) s->moved[i] = s->x[i] + part * s->x_dot[i];
    if (k == 4 && c->kernels->sensors_need_forces)
      mg_move_gaps(c, s, part, s->moved + i - group[k].n, s->x_dot + i - group[k].n);
  }
  c->kernels->sense(0, argument[0], argument[1], argument[2], argument[3], argument[4], argument[5], argument[6],
                    argument[7], argument[8], shown);
  c->kernels->derivatives->tangent(MG_TASK_SENSORS, 0, s->weights, s->moved, s->x_dot, slope);
}

#define MG_PROBE_SHORTER 16 /* times shorter: whether it is a kink, or a bend */

/* What one sensor shows at five places along a direction, and its derivatives there: here, and a way before and after,
   longer and shorter. */
typedef struct {
  mg_real shown[5], slope[5];
  mg_real way[2]; /* of the derivatives of the arguments */
  mg_real size;   /* of what it may be the difference of */
} mg_probe;

enum { MG_PROBE_BEFORE = 1, MG_PROBE_AFTER = 2 }; /* places, 0 being here; the shorter way: 2 more */

/* What rounding makes of a difference over a way. */
static mg_real mg_probe_rounding(const mg_probe *p, int shorter) {
  const mg_real *shown = p->shown + 2 * shorter;
  return 64 * MG_EPS * (p->size + fabs(p->shown[0]) + fabs(shown[1]) + fabs(shown[2])) / p->way[shorter];
}

/* True if a sensor has another slope on each side of the state, or another than its derivative y_dot, by as much on a
   shorter way. */
static int mg_is_sensor_on_kink(const mg_context *c, const mg_probe *p, mg_real y_dot) {
  mg_real off[2][2]; /* differences of both sides, and of their mean from the derivative */
  int is_kink[2] = {1, 1};
  for (int shorter = 0; shorter < 2; shorter++) {
    const mg_real now = p->shown[0], before = (p->shown + 2 * shorter)[MG_PROBE_BEFORE],
                  after = (p->shown + 2 * shorter)[MG_PROBE_AFTER], left = (now - before) / p->way[shorter],
                  right = (after - now) / p->way[shorter], slope = fabs(left) + fabs(right) + fabs(y_dot),
                  least = c->settings->sensor_kink_part * slope + mg_probe_rounding(p, shorter);
    off[shorter][0] = fabs(right - left), off[shorter][1] = fabs((left + right) / 2 - y_dot);
    for (int i = 0; i < 2; i++) is_kink[i] &= off[shorter][i] > least && (!shorter || off[1][i] > off[0][i] / 4);
  }
  return is_kink[0] || is_kink[1];
}

/* Size of the slopes of a sensor beside a kink. */
static mg_real mg_probe_slope(const mg_probe *p) {
  return fabs(p->slope[MG_PROBE_BEFORE + 2]) + fabs(p->slope[MG_PROBE_AFTER + 2]);
}

enum { MG_SLOPE_NOT_FOUND = 0, MG_SLOPE_FOUND = 1, MG_JUMPS_THERE = 2 }; /* to a side of a kink */

/* The derivative of a sensor on a side, MG_PROBE_BEFORE or MG_PROBE_AFTER, as the limit of those on the way. */
static int mg_find_slope_of_side(const mg_context *c, const mg_probe *p, int side, mg_real *limit) {
  const mg_real slope = p->slope[side + 2], change = p->shown[side + 2] - p->shown[0],
                rate = (side == MG_PROBE_AFTER ? change : -change) / p->way[1],
                least = c->settings->sensor_kink_part * mg_probe_slope(p), rounding = mg_probe_rounding(p, 1);
  *limit = slope + (slope - p->slope[side]) / (MG_PROBE_SHORTER - 1);
  if (fabs(rate - slope) <= least + rounding)
    return fabs(*limit - slope) <= least ? MG_SLOPE_FOUND : MG_SLOPE_NOT_FOUND;
  const int stays = fabs(change) > fabs(p->shown[side] - p->shown[0]) / 2;
  return stays && fabs(change) > rounding * p->way[1] ? MG_JUMPS_THERE : MG_SLOPE_NOT_FOUND;
}

/* For which changes the derivative of a sensor on a kink holds. One that is that of neither side, as that of abs(x), is
   replaced by that for larger changes, or if it jumps there by the other. */
static int mg_sides_of_sensor(const mg_context *c, const mg_probe *p, mg_real *y_dot) {
  static const int place[2] = {MG_PROBE_AFTER, MG_PROBE_BEFORE}, bit[2] = {MG_SIDE_LARGER, MG_SIDE_SMALLER};
  mg_real limit[2];
  int found[2], sides = 0;
  for (int i = 0; i < 2; i++) {
    found[i] = mg_find_slope_of_side(c, p, place[i], limit + i);
    if (found[i] == MG_SLOPE_FOUND && fabs(limit[i] - *y_dot) <= c->settings->sensor_slope_part * mg_probe_slope(p))
      sides |= bit[i];
  }
  if (sides == MG_SIDES) return MG_SIDE_UNKNOWN; /* both are its derivative, and yet it is on a kink */
  for (int i = 0; i < 2 && !sides; i++)
    if (found[i] == MG_SLOPE_FOUND) *y_dot = limit[i], sides = bit[i];
  return sides || (found[0] == MG_JUMPS_THERE && found[1] == MG_JUMPS_THERE) ? sides : MG_SIDE_UNKNOWN;
}

/* Notes for which changes along the direction what a sensor shows has this derivative. */
static void mg_keep_sensor_sides(mg_sensitivity *s, int sensor, int sides, int reason) {
  s->sensor_sides[sensor] = mg_common_sides(s->sensor_sides[sensor], sides);
  if (!s->reasons[sensor]) s->reasons[sensor] = reason;
}

/* Finds the sensors that are on a kink. Needs their packed arguments and the derivatives of these. */
static void mg_find_kinks_of_sensors(const mg_context *c, mg_sensitivity *s) {
  MG_NEEDS_TANGENT(c, s, MG_VALID_SENSOR_ARGUMENTS, MG_VALID_FORCES, MG_ANY_DIRECTION, MG_NO_ROW);
  const int n = c->kernels->n_sensor;
  mg_real largest, *slope = s->shown + 5L * n;
  const mg_real most = mg_packed_change(c, s, &largest), longest = c->settings->sensor_kink_reach / most;
  if (!(most > 0)) return;
  for (int i = 0; i < 5; i++)
    mg_show_moved_sensors(c, s, i ? (i % 2 ? -longest : longest) / (i > 2 ? MG_PROBE_SHORTER : 1) : 0,
                          s->shown + (long)i * n, slope + (long)i * n);
  for (int k = 0; k < n; k++) {
    mg_probe p = {{0}, {0}, {longest, longest / MG_PROBE_SHORTER}, largest};
    for (int i = 0; i < 5; i++) p.shown[i] = s->shown[i * n + k], p.slope[i] = slope[i * n + k];
    if (s->sensor_sides[k] != MG_SIDES || !mg_is_sensor_on_kink(c, &p, s->y_dot[k])) continue;
    mg_keep_sensor_sides(s, k, mg_sides_of_sensor(c, &p, s->y_dot + k), MG_BY_SENSOR_KINK);
  }
}

/* Notes for which changes the run keeps the branch of its forces, of sensors whose derivatives change where those of
   accelerations and forces are left out. */
static void mg_find_sides_of_force_sensors(mg_context *c, mg_sensitivity *s, int direction, int sides, int reason) {
  const int n = c->kernels->n_sensor;
  mg_real *with = s->shown;
  for (int k = 0; k < n; k++) with[k] = s->y_dot[k];
  mg_sense_no_forces(c, s);
  MG_NOTE_TANGENT(c, s, MG_VALID_SENSED, MG_VALID_FORCES, direction, MG_NO_ROW);
  mg_zero_reals(s->at.acceleration, 6L * c->system->n_body);
  mg_sensors_tangent(c, s, direction, c->run->t);
  for (int k = 0; k < n; k++) {
    if (fabs(with[k] - s->y_dot[k]) > sqrt(MG_EPS) * fabs(with[k])) mg_keep_sensor_sides(s, k, sides, reason);
    s->y_dot[k] = with[k];
  }
}

MG_INTERNAL void mg_find_sensors_tangent(mg_context *c, mg_sensitivity *s, int direction) {
  MG_NEEDS_AT_RUN(c, MG_VALID_FORCES), MG_NEEDS_WITH(c, MG_VALID_WRENCHES, MG_VALID_FORCES);
  MG_NEEDS_WITH(c, MG_VALID_SENSORS, MG_VALID_TWISTS);
  const mg_real t = c->run->t, *x = c->run->x, *dx = s->tangent->x + (long)direction * c->layout.n_states;
  const int reason = mg_mark_kinks(c, s, t, MG_AT_SAMPLE) ? mg_leave_kinks(c, s, direction, t, x, MG_AT_SAMPLE) : 0,
            sides = s->sides;
  mg_rhs_tangent(c, s, direction, t, x, dx, s->stage);
  mg_sensed_forces_tangent(c, s, direction);
  mg_sensors_tangent(c, s, direction, t);
  for (int k = 0; k < c->kernels->n_sensor; k++) {
    s->sensor_sides[k] = MG_SIDES;
    if (s->reasons[k] == MG_BY_FORCES || isnan(s->y_dot[k])) mg_keep_sensor_sides(s, k, MG_SIDE_UNKNOWN, MG_BY_FORCES);
  }
  mg_find_kinks_of_sensors(c, s);
  if (reason) mg_find_sides_of_force_sensors(c, s, direction, sides, reason);
}

/* What sensors show of forces on the rows, beside what they show of none. */
static void mg_show_forces(mg_context *c, mg_sensitivity *s, const mg_real *force, mg_real *shown) {
  const int n = c->kernels->n_sensor;
  mg_sense_no_forces(c, s);
  MG_NOTE_TANGENT(c, s, MG_VALID_SENSED, MG_VALID_FORCES, 0, MG_NO_ROW);
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
