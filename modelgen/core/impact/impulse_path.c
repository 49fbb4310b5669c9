/* Impact at one contact as a path in the normal impulse: velocities are integrated through compression and
   restitution with Coulomb's law at every point of the path (Routh, Dynamics of a System of Rigid Bodies, 1877;
   Keller, J. Appl. Mech. 53 (1986), 1-4; Stronge, Impact Mechanics, 2000). Pure: writes only the impact path that
   it is given. */
#include "impact/impact.h"
#include "integrate/integrate.h"
#include "integrate/dop853_coefficients.h"

enum {
  MG_IMPACT_STEPS = 100000, /* most steps of a path */
  MG_IMPACT_PARTS = 4,      /* parts of a step in which an event is sought */
  MG_IMPACT_HALVINGS = 80   /* most halvings in the location of an event */
};

#define MG_IMPACT_STEP_ERROR (4 * MG_EPS) /* error of a step over the initial speed */

#define MG_IMPACT_STRAIGHT_ANGLE (16 * MG_EPS) /* angle by which slip turns that counts as rounding, rad */

/* Change of one contact velocity per unit of normal impulse, with tangential impulses in the given ratio. */
static mg_real mg_velocity_change_per_impulse(const mg_impact_path *b, int row, const mg_real *force_ratio) {
  return b->G[3 * row] + b->G[3 * row + 1] * force_ratio[0] + b->G[3 * row + 2] * force_ratio[1];
}

/* Solve (G_tt + push / mu^2) r = -G_tn for the tangential impulse ratio r; returns |r / mu|. */
static mg_real mg_solve_sticking_force_ratio(const mg_impact_path *b, mg_real multiplier, mg_real *force_ratio) {
  const mg_real a = b->G[4] + multiplier / (b->mu[0] * b->mu[0]), d = b->G[8] + multiplier / (b->mu[1] * b->mu[1]),
                o = b->G[5];
  const mg_real det = a * d - o * o;
  force_ratio[0] = (o * b->G[6] - d * b->G[3]) / det, force_ratio[1] = (o * b->G[3] - a * b->G[6]) / det;
  return sqrt(force_ratio[0] * force_ratio[0] / (b->mu[0] * b->mu[0]) +
              force_ratio[1] * force_ratio[1] / (b->mu[1] * b->mu[1]));
}

/* Set the impulse ratio after slip has ended: the one that keeps it at zero, or, beyond the cone, the one on the
   cone that most opposes the slip that starts again. */
static void mg_end_impact_slip(mg_impact_path *b) {
  mg_real low = 0, high = (b->G[4] + b->G[8]) * (b->mu[0] * b->mu[0] + b->mu[1] * b->mu[1]);
  b->slip_ended = 1, b->velocity[1] = b->velocity[2] = 0;
  if (mg_solve_sticking_force_ratio(b, 0, b->force_ratio) <= 1) return;
  while (mg_solve_sticking_force_ratio(b, high, b->force_ratio) > 1) high *= 2;
  for (int j = 0; j < MG_IMPACT_HALVINGS; j++) {
    const mg_real middle = (low + high) / 2;
    if (mg_solve_sticking_force_ratio(b, middle, b->force_ratio) > 1) low = middle;
    else high = middle;
  }
}

/* Ratio of tangential to normal impulse at the given velocities. */
static void mg_impact_force_ratio(const mg_impact_path *b, const mg_real *u, mg_real *share) {
  const mg_real x = b->mu[0] * u[1], y = b->mu[1] * u[2], size = sqrt(x * x + y * y);
  const int is_constant = b->slip_ended || b->keeps_direction || !(size > 0);
  share[0] = is_constant ? b->force_ratio[0] : -b->mu[0] * x / size;
  share[1] = is_constant ? b->force_ratio[1] : -b->mu[1] * y / size;
}

/* Derivatives by the normal impulse of the velocities, the tangential impulses and the work of the normal
   impulse. */
static void mg_impact_path_slope(const mg_impact_path *b, const mg_real *y, mg_real *slope) {
  mg_real force_ratio[2];
  mg_impact_force_ratio(b, y, force_ratio);
  for (int k = 0; k < 3; k++) slope[k] = mg_velocity_change_per_impulse(b, k, force_ratio);
  slope[3] = force_ratio[0], slope[4] = force_ratio[1], slope[5] = y[0];
}

/* Error of a step relative to its tolerance, by the two embedded estimates of Dormand and Prince's method as
   blended by Hairer. */
static mg_real mg_impact_step_error(const mg_impact_path *b, mg_real dp, mg_real (*slope)[6], const mg_real *y) {
  const mg_real impulse = b->initial_speed / b->G[0];
  const mg_real size[6] = {b->initial_speed, b->initial_speed, b->initial_speed,
                           impulse,          impulse,          impulse * b->initial_speed};
  mg_real fifth = 0, third = 0;
  for (int k = 0; k < 6; k++) {
    mg_real e5 = 0, e3 = (y[k] - b->velocity[k]) / dp;
    for (int j = 0; j < MG_DOP_FIFTH; j++) e5 += mg_dop_fifth[j] * slope[mg_dop_fifth_column[j]][k];
    for (int j = 0; j < MG_DOP_THIRD; j++) e3 += mg_dop_third[j] * slope[mg_dop_third_column[j]][k];
    const mg_real weight = 1 / (MG_IMPACT_STEP_ERROR * size[k]);
    fifth += e5 * weight * e5 * weight, third += e3 * weight * e3 * weight;
  }
  return fifth > 0 ? dp * fifth / sqrt(6 * (fifth + third / 100)) : fifth;
}

/* One step of Dormand and Prince's method of order 8 in the normal impulse; returns the error relative to its
   tolerance. */
static mg_real mg_impact_step_dop853(const mg_impact_path *b, mg_real dp, mg_real *y) {
  mg_real slope[12][6];
  for (int stage = 0; stage <= 12; stage++) {
    for (int k = 0; k < 6; k++) {
      mg_real sum = 0;
      for (int j = mg_dop_row[stage]; j < mg_dop_row[stage + 1]; j++)
        sum += mg_dop_value[j] * slope[mg_dop_column[j]][k];
      y[k] = b->velocity[k] + dp * sum;
    }
    if (stage < 12) mg_impact_path_slope(b, y, slope[stage]);
  }
  return mg_impact_step_error(b, dp, slope, y);
}

/* Advance the impact by the normal impulse dp: exactly where the slip direction is constant, else by one
   Runge-Kutta step; returns the error relative to its tolerance. */
static mg_real mg_advance_impact_path(const mg_impact_path *b, mg_real dp, mg_impact_path *to) {
  mg_real slope[6], y[6], error = 0;
  if (b->slip_ended || b->keeps_direction) {
    mg_impact_path_slope(b, b->velocity, slope);
    for (int k = 0; k < 6; k++) y[k] = b->velocity[k] + dp * slope[k];
    y[5] += dp * dp * slope[0] / 2;
  } else error = mg_impact_step_dop853(b, dp, y);
  *to = *b;
  for (int k = 0; k < 6; k++) to->velocity[k] = y[k];
  to->impulse += dp;
  return error;
}

/* Normal impulse over which the present kind of slip lasts: up to its end where the direction is constant, else a
   part of that. */
static mg_real mg_impact_step_limit(mg_impact_path *b, int *slip_ends) {
  mg_real slope[6];
  *slip_ends = b->keeps_direction = 0;
  if (b->slip_ended) return MG_MAX;
  mg_impact_path_slope(b, b->velocity, slope);
  const mg_real x = b->mu[0] * b->velocity[1], y = b->mu[1] * b->velocity[2], dx = b->mu[0] * slope[1],
                dy = b->mu[1] * slope[2];
  const mg_real slip = sqrt(x * x + y * y), rate = sqrt(dx * dx + dy * dy);
  if (fabs(x * dy - y * dx) > MG_IMPACT_STRAIGHT_ANGLE * slip * rate) return slip / rate / MG_IMPACT_PARTS;
  mg_impact_force_ratio(b, b->velocity, b->force_ratio);
  b->keeps_direction = 1, *slip_ends = x * dx + y * dy < 0;
  return *slip_ends ? slip / rate : MG_MAX;
}

/* Event function of the end of compression or restitution; negative until the end of the phase. */
static mg_real mg_impact_phase_value(const mg_impact_path *b, const mg_real *start, int law, mg_real e,
                                     const mg_impact_path *compression_end) {
  if (!compression_end) return b->velocity[0];
  if (law == MG_POISSON) return b->impulse - (1 + e) * compression_end->impulse;
  if (law == MG_STRONGE) return b->velocity[5] - (1 - e * e) * compression_end->velocity[5];
  return b->velocity[0] + e * start[0];
}

/* Integrate one phase of the impact; `turn` is the state at the end of compression, null during compression.
   Returns 0 where the phase does not end. */
static int mg_integrate_impact_phase(mg_impact_path *b, const mg_real *start, int law, mg_real e,
                                     const mg_impact_path *compression_end) {
  const mg_real first = -start[0] / b->G[0];
  mg_real guess = first;
  for (int step = 0; step < MG_IMPACT_STEPS; step++) {
    int slip_ends;
    mg_impact_path next;
    const mg_real step_limit = mg_impact_step_limit(b, &slip_ends), dp = step_limit < guess ? step_limit : guess;
    const mg_real error = mg_advance_impact_path(b, dp, &next);
    guess = dp * mg_step_growth(error, 4);
    if (!(error <= 1)) continue;
    if (mg_impact_phase_value(&next, start, law, e, compression_end) >= 0) {
      mg_real low = 0, high = dp;
      for (int j = 0; j < MG_IMPACT_HALVINGS; j++) {
        mg_advance_impact_path(b, (low + high) / 2, &next);
        if (mg_impact_phase_value(&next, start, law, e, compression_end) >= 0) high = (low + high) / 2;
        else low = (low + high) / 2;
      }
      mg_advance_impact_path(b, high, b);
      return 1;
    }
    *b = next;
    const mg_real slip = sqrt(b->velocity[1] * b->velocity[1] + b->velocity[2] * b->velocity[2]);
    if (b->slip_ended || !((slip_ends && dp == step_limit) || slip <= MG_EPS * b->initial_speed)) continue;
    mg_end_impact_slip(b);
    guess = first;
  }
  return 0;
}

MG_INTERNAL int mg_integrate_impact_path(mg_impact_path *b, int law, mg_real e) {
  const mg_real start[3] = {b->velocity[0], b->velocity[1], b->velocity[2]};
  b->initial_speed = sqrt(start[0] * start[0] + start[1] * start[1] + start[2] * start[2]);
  b->impulse = b->velocity[3] = b->velocity[4] = b->velocity[5] = 0, b->slip_ended = b->keeps_direction = 0,
  b->force_ratio[0] = b->force_ratio[1] = 0;
  if (!(b->mu[0] > 0)) b->slip_ended = 1;
  else if (sqrt(start[1] * start[1] + start[2] * start[2]) <= MG_EPS * b->initial_speed) mg_end_impact_slip(b);
  if (!mg_integrate_impact_phase(b, start, law, e, 0)) return 0;
  const mg_impact_path compression_end = *b;
  return e > 0 ? mg_integrate_impact_phase(b, start, law, e, &compression_end) : 1;
}
