/* Which events have triggered at a state: gaps that close, forces that end, contacts that leave their feature pair, and
   the events of patches and friction. Writes c->events. */
#include "events/events.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/integrate.h"
#include "closest/closest.h"
#include "features/features.h"

/* Characteristic speed, length / time. */
static mg_real mg_speed_scale(const mg_context *c) { return c->system->length / c->system->time; }

MG_INTERNAL int mg_is_closed_without_force(const mg_context *c, int contact) {
  return c->run->closed[contact] && !c->run->active[contact];
}

MG_INTERNAL int mg_may_leave_feature_pair(const mg_context *c, int contact) {
  const int feature_pair = c->run->feature_pair[contact];
  return feature_pair >= 0 && !c->run->rolling_start[contact] && !mg_is_unconditional_feature_pair(c, feature_pair) &&
         !mg_is_distant_flat_feature_pair(c, contact);
}

MG_INTERNAL int mg_is_off_feature_pair(mg_context *c, int contact, const mg_real *eta) {
  MG_NEEDS_PLACEMENT(c, c->run->feature_pair[contact], eta);
  int *const condition = c->events.broken_condition + contact;
  const mg_real value = mg_most_violated_condition(c, c->run->feature_pair[contact], eta, condition);
  if (value >= -c->settings->feature_border) return 0;
  if (value < -c->settings->parallel_angle ||
      !mg_is_at_end_of_line(c, contact, c->system->condition_feature_pair[*condition]))
    return 1;
  return mg_least_feature_pair_condition(c, c->run->feature_pair[contact], eta, MG_LEAVING_ASIDE, condition) <
         -c->settings->feature_border;
}

/* MG_LEAVES_FEATURE if the contact leaves its feature pair at the state x, MG_PASSES_BORDER if it passes a watched
   border, else 0; stores the condition that is broken. */
static int mg_find_feature_pair_exit(mg_context *c, int contact, mg_real *x) {
  const int feature_pair = c->run->feature_pair[contact];
  if (!mg_may_leave_feature_pair(c, contact)) return 0;
  const mg_real *eta = mg_contact_eta(c, x, contact);
  mg_place_contact(c, contact, eta, c->search.placement + 32);
  if (mg_is_off_feature_pair(c, contact, eta)) return MG_LEAVES_FEATURE;
  const int is_touching = !c->run->closed[contact] && c->rows.d[contact] < c->settings->start_gap * c->system->length;
  if (!c->events.within_border[contact] || is_touching) return 0;
  return mg_least_feature_pair_condition(c, feature_pair, eta, MG_SEARCHED_BEYOND,
                                         c->events.broken_condition + contact) < -c->settings->feature_border
             ? MG_PASSES_BORDER
             : 0;
}

/* Least watched condition of a contact at a state, and its index. Needs the poses there. */
static mg_real mg_least_watched_condition(mg_context *c, int contact, mg_real *x, int *which) {
  MG_NEEDS_AT(c, MG_VALID_POSES, x);
  const mg_real *eta = mg_contact_eta(c, x, contact);
  mg_place_contact(c, contact, eta, c->search.placement + 32);
  return mg_least_feature_pair_condition(c, c->run->feature_pair[contact], eta, MG_SEARCHED_BEYOND, which);
}

/* True if a contact beyond a watched border moves back towards it. Needs the slope at the run's state. */
static int mg_is_returning_to_border(mg_context *c, int contact, mg_real now) {
  MG_NEEDS_AT_RUN(c, MG_VALID_SLOPE);
  int which;
  mg_extrapolate_poses(c);
  const mg_real then = mg_least_watched_condition(c, contact, c->step.stage, &which);
  mg_update_poses(c, c->run->t, c->run->x);
  return then > now;
}

MG_INTERNAL void mg_mark_contacts_within_border(mg_context *c) {
  MG_NEEDS_AT_RUN(c, MG_VALID_POSES);
  int which;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i)) {
    const int feature_pair = c->run->feature_pair[i],
              near = c->run->closed[i] || c->rows.d[i] < c->settings->search_movement * c->system->length;
    const int was_on_border = c->events.within_border[i] == MG_PASSES_BORDER;
    c->events.within_border[i] = 0;
    if (feature_pair < 0 || !near || mg_is_unconditional_feature_pair(c, feature_pair)) continue;
    const mg_real value = mg_least_watched_condition(c, i, c->run->x, &which);
    if (which < 0) continue;
    const int still_on_border = was_on_border && (value < 0 || !c->run->closed[i]);
    c->events.within_border[i] =
        value >= -c->settings->feature_border && (!still_on_border || mg_is_returning_to_border(c, i, value));
    if (!c->events.within_border[i]) c->run->is_search_due[c->system->contact_pair[i]] = 1;
  }
}

MG_INTERNAL int mg_mark_triggered_events(mg_context *c, mg_real *x) {
  MG_NEEDS_AT(c, MG_VALID_FORCES, x), MG_NEEDS_WITH(c, MG_VALID_RATES, MG_VALID_TWISTS);
  const mg_real deep = -c->settings->contact_gap * c->system->length,
                rest = -c->settings->rest_speed * mg_speed_scale(c);
  int count = mg_mark_patch_events(c) + mg_mark_switch_events(c);
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i)) {
    if (mg_is_closed_without_force(c, i))
      c->events.triggered[i] =
          fabs(mg_row_acceleration(c, i)) > c->settings->rest_loss_factor * mg_acceleration_tolerance(c);
    else if (c->run->closed[i])
      c->events.triggered[i] = c->solution.force[i] < -mg_acceleration_tolerance(c) * c->system->mass;
    else
      c->events.triggered[i] =
          (c->rows.d[i] < 0 && c->rows.d_dot[i] < rest) || (c->rows.d[i] < deep && c->rows.d_dot[i] < 0);
    const int leaves = mg_find_feature_pair_exit(c, i, x);
    if (leaves == MG_LEAVES_FEATURE || (leaves && (c->run->closed[i] || !c->events.triggered[i])))
      c->events.triggered[i] = leaves;
    count += c->events.triggered[i] != 0;
  }
  return c->system->n_friction ? count + mg_mark_friction_events(c) : count;
}

MG_INTERNAL int mg_mark_triggered_events_at(mg_context *c, mg_real h, mg_real theta) {
  mg_interpolate(c, c->run->x, theta, c->step.stage);
  mg_normalise_quaternions(c, c->step.stage);
  mg_right_hand_side(c, c->run->t + theta * h, c->step.stage, c->step.slopes + 16 * c->layout.n_states);
  mg_update_gap_rates(c);
  return mg_mark_triggered_events(c, c->step.stage);
}
