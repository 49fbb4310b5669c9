/* Instants t0 at which a function of time is infinite but integrable, as a load 1/sqrt|t - t0|. No step by polynomials
   ends near one. On each side of it the right-hand side is fitted by A + B |t - t0|^-p at the state where the steps
   become too short, and integrated in closed form; the contact modes are chosen anew in between. The time crossed is
   so short that nothing else changes in it. Writes time, state, modes and events of the run. */
#include "run/run.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/integrate.h"
#include "events/events.h"

enum {
  MG_PEAK_DOUBLINGS = 16, /* of the distance, from a sixteenth of the last step, up to which a peak is sought */
  MG_PEAK_WIDTH = 64      /* least time crossed behind a peak, in step_min times the characteristic time */
};

#define MG_LEAST_POWER ((mg_real)1 / 16) /* power of the time left below which a function is taken as constant */
#define MG_MOST_POWER (mg_real)0.9       /* most power that two values near a peak may show */

/* A function of time and the instant at which it has its peak. */
typedef struct {
  int function;
  mg_real t;
} mg_peak;

/* Time of the largest value of a function between two times that enclose a single peak. */
static mg_real mg_narrow_peak(const mg_context *c, int function, mg_real low, mg_real high) {
  for (;;) {
    const mg_real first = low + (high - low) / 3, second = high - (high - low) / 3;
    if (!(first > low && second > first && high > second)) break;
    const mg_real a = mg_time_function_magnitude(c, function, first),
                  b = mg_time_function_magnitude(c, function, second);
    if (a >= MG_MAX) return first;
    *(a < b ? &low : &high) = a < b ? first : second;
  }
  return low + (high - low) / 2;
}

/* Finds the peak of a function of time nearest to the present time, by doubled distances from a sixteenth of the step
   that was too short; returns 0 if its value grows towards none. */
static int mg_find_peak(const mg_context *c, int function, mg_real step, mg_peak *peak) {
  const mg_real t = c->run->t, here = mg_time_function_magnitude(c, function, t);
  mg_real most = here, best = 0, distance = step / 16;
  for (int k = 0; k < MG_PEAK_DOUBLINGS; k++, distance *= 2)
    for (int sign = -1; sign <= 1; sign += 2) {
      const mg_real value = mg_time_function_magnitude(c, function, t + sign * distance);
      if (value > most) most = value, best = sign * distance;
    }
  peak->function = function;
  peak->t = best == 0 ? mg_narrow_peak(c, function, t - step / 16, t + step / 16)
                      : mg_narrow_peak(c, function, t + mg_min(best / 2, 2 * best), t + mg_max(best / 2, 2 * best));
  return !mg_has_pole_at(c, function, peak->t) && mg_has_peak_at(c, function, peak->t);
}

/* Adds the integral of the right-hand side from `near` to `far` away from a peak, on the side `sign` of it, to the
   state of the run. Returns 0 if a value is not finite. */
static int mg_add_side_of_peak(mg_context *c, const mg_peak *peak, int sign, mg_real near, mg_real far) {
  const int n = c->layout.n_states;
  const mg_real inner = mg_max(near, far / 4), outer_time = peak->t + sign * far, inner_time = peak->t + sign * inner;
  mg_real *at_far = c->step.slopes, *at_inner = c->step.slopes + n;
  if (!(far > near)) return 1;
  const mg_real growth = mg_log(mg_time_function_magnitude(c, peak->function, inner_time) /
                                mg_time_function_magnitude(c, peak->function, outer_time)) /
                         mg_log(far / inner);
  const mg_real p = growth > MG_LEAST_POWER ? mg_min(growth, MG_MOST_POWER) : 0;
  mg_right_hand_side(c, outer_time, c->run->x, at_far);
  mg_right_hand_side(c, inner_time, c->run->x, at_inner);
  if (!mg_are_states_finite(c, at_far) || !mg_are_states_finite(c, at_inner)) return 0;
  const mg_real fall = mg_pow(far, -p), rise = mg_pow(inner, -p) - fall,
                integral = (mg_pow(far, 1 - p) - (near > 0 ? mg_pow(near, 1 - p) : 0)) / (1 - p);
  for (int range = 0; range < c->listed.n_range; range++)
    for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++) {
      const mg_real singular = p > 0 ? (at_inner[i] - at_far[i]) / rise : 0;
      c->run->x[i] += (at_far[i] - singular * fall) * (far - near) + singular * integral;
    }
  mg_normalise_quaternions(c, c->run->x);
  return 1;
}

/* Crosses a peak. Returns an outcome. */
static int mg_cross_peak(mg_context *c, const mg_peak *peak, mg_events *events) {
  const mg_real before = peak->t - c->run->t, since = before < 0 ? -before : 0,
                width = MG_PEAK_WIDTH * c->settings->step_min * c->system->time,
                after = mg_max(before, since + mg_max(width, MG_PEAK_WIDTH * MG_EPS * fabs(peak->t)));
  if (before > 0 && !mg_add_side_of_peak(c, peak, -1, 0, before)) return MG_NOT_FINITE;
  const int outcome = mg_cross_velocity_jump(c, peak->t + after, events);
  if (outcome) return outcome;
  if (!mg_add_side_of_peak(c, peak, 1, since, after)) return MG_NOT_FINITE;
  mg_evaluate_run_state(c);
  c->run->h = after / 4;
  return MG_DONE;
}

MG_INTERNAL int mg_cross_infinite_load(mg_context *c, int outcome, mg_events *events) {
  const int functions = c->system->n_load + c->system->n_body + c->system->n_joint;
  if (outcome != MG_STEP_TOO_SMALL && outcome != MG_NOT_FINITE) return outcome;
  if (c->settings->method != MG_DOP853 || mg_has_rolling_start(c) || !mg_are_states_finite(c, c->run->x))
    return outcome;
  mg_update_poses(c, c->run->t, c->run->x);
  for (int i = 0; i < functions; i++) {
    mg_peak peak;
    if (mg_find_peak(c, i, c->run->h, &peak)) return mg_cross_peak(c, &peak, events);
  }
  return outcome;
}
