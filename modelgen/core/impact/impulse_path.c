/* One blow at one contact: its velocities followed as the normal impulse grows, through compression and restitution,
   with Coulomb's law at every moment of it (Routh, Dynamics of a System of Rigid Bodies, 1877; Keller, J. Appl. Mech.
   53 (1986), 1-4; Stronge, Impact Mechanics, 2000). */
#include "impact/impact.h"
#include "integrate/integrate.h"
#include "integrate/dop853_coefficients.h"

enum { MG_IMPACT_STEPS = 100000, MG_IMPACT_PARTS = 4, MG_IMPACT_HALVINGS = 80 };

#define MG_IMPACT_STEP_ERROR (4 * MG_EPS) /* of a step, of what the blow began with */

#define MG_IMPACT_STRAIGHT_ANGLE (16 * MG_EPS) /* rounding of the angle by which slip turns */

static mg_real mg_blow_row(const mg_impact_path *b, int row, const mg_real *share) {
  return b->G[3 * row] + b->G[3 * row + 1] * share[0] + b->G[3 * row + 2] * share[1];
}

/* (G_tt + push / mu^2) share = -G_tn; returns |share / mu|. */
static mg_real mg_blow_bound(const mg_impact_path *b, mg_real push, mg_real *share) {
  const mg_real a = b->G[4] + push / (b->mu[0] * b->mu[0]), d = b->G[8] + push / (b->mu[1] * b->mu[1]), o = b->G[5];
  const mg_real det = a * d - o * o;
  share[0] = (o * b->G[6] - d * b->G[3]) / det, share[1] = (o * b->G[3] - a * b->G[6]) / det;
  return sqrt(share[0] * share[0] / (b->mu[0] * b->mu[0]) + share[1] * share[1] / (b->mu[1] * b->mu[1]));
}

/* Once slip is over: the share of the normal impulse that holds it at zero; or, where that is beyond the cone, the one
   on the cone that most opposes the slip it lets begin, whose direction then stays. */
static void mg_blow_holds(mg_impact_path *b) {
  mg_real low = 0, high = (b->G[4] + b->G[8]) * (b->mu[0] * b->mu[0] + b->mu[1] * b->mu[1]);
  b->slip_ended = 1, b->velocity[1] = b->velocity[2] = 0;
  if (mg_blow_bound(b, 0, b->force_ratio) <= 1) return;
  while (mg_blow_bound(b, high, b->force_ratio) > 1) high *= 2;
  for (int j = 0; j < MG_IMPACT_HALVINGS; j++) {
    const mg_real middle = (low + high) / 2;
    if (mg_blow_bound(b, middle, b->force_ratio) > 1) low = middle;
    else high = middle;
  }
}

/* Tangential over normal impulse at the velocities u. */
static void mg_blow_share(const mg_impact_path *b, const mg_real *u, mg_real *share) {
  const mg_real x = b->mu[0] * u[1], y = b->mu[1] * u[2], size = sqrt(x * x + y * y);
  const int kept = b->slip_ended || b->keeps_direction || !(size > 0);
  share[0] = kept ? b->force_ratio[0] : -b->mu[0] * x / size;
  share[1] = kept ? b->force_ratio[1] : -b->mu[1] * y / size;
}

/* The change of u, the tangential impulses and the work of the normal one, per normal impulse. */
static void mg_blow_slope(const mg_impact_path *b, const mg_real *y, mg_real *slope) {
  mg_real share[2];
  mg_blow_share(b, y, share);
  for (int k = 0; k < 3; k++) slope[k] = mg_blow_row(b, k, share);
  slope[3] = share[0], slope[4] = share[1], slope[5] = y[0];
}

/* The error of a step relative to what it may be, of Dormand and Prince's two estimates as Hairer blends them. */
static mg_real mg_blow_error(const mg_impact_path *b, mg_real dp, mg_real (*slope)[6], const mg_real *y) {
  const mg_real impulse = b->initial_speed / b->G[0];
  const mg_real size[6] = {b->initial_speed, b->initial_speed, b->initial_speed,
                           impulse,          impulse,          impulse * b->initial_speed};
  mg_real fifth = 0, third = 0;
  for (int k = 0; k < 6; k++) {
    mg_real e5 = 0, e3 = (y[k] - b->velocity[k]) / dp;
    for (int j = 0; j < 12; j++) e5 += mg_dop_fifth[j] * slope[j][k], e3 -= mg_dop_third[j] * slope[j][k];
    const mg_real weight = 1 / (MG_IMPACT_STEP_ERROR * size[k]);
    fifth += e5 * weight * e5 * weight, third += e3 * weight * e3 * weight;
  }
  return fifth > 0 ? dp * fifth / sqrt(6 * (fifth + third / 100)) : fifth;
}

/* A step of Dormand and Prince's method of order 8. */
static mg_real mg_blow_turn(const mg_impact_path *b, mg_real dp, mg_real *y) {
  mg_real slope[12][6];
  for (int stage = 0; stage <= 12; stage++) {
    for (int k = 0; k < 6; k++) {
      mg_real sum = 0;
      for (int j = mg_dop_row[stage]; j < mg_dop_row[stage + 1]; j++)
        sum += mg_dop_value[j] * slope[mg_dop_column[j]][k];
      y[k] = b->velocity[k] + dp * sum;
    }
    if (stage < 12) mg_blow_slope(b, y, slope[stage]);
  }
  return mg_blow_error(b, dp, slope, y);
}

/* On by the normal impulse dp: exact where slip keeps its direction. Returns the error relative to what it may be. */
static mg_real mg_blow_go(const mg_impact_path *b, mg_real dp, mg_impact_path *to) {
  mg_real slope[6], y[6], error = 0;
  if (b->slip_ended || b->keeps_direction) {
    mg_blow_slope(b, b->velocity, slope);
    for (int k = 0; k < 6; k++) y[k] = b->velocity[k] + dp * slope[k];
    y[5] += dp * dp * slope[0] / 2;
  } else error = mg_blow_turn(b, dp, y);
  *to = *b;
  for (int k = 0; k < 6; k++) to->velocity[k] = y[k];
  to->impulse += dp;
  return error;
}

/* The impulse over which slip goes on as it does: to its end where it keeps its direction, else a part of what ends it.
 */
static mg_real mg_blow_stretch(mg_impact_path *b, int *dies) {
  mg_real slope[6];
  *dies = b->keeps_direction = 0;
  if (b->slip_ended) return MG_MAX;
  mg_blow_slope(b, b->velocity, slope);
  const mg_real x = b->mu[0] * b->velocity[1], y = b->mu[1] * b->velocity[2], dx = b->mu[0] * slope[1],
                dy = b->mu[1] * slope[2];
  const mg_real slip = sqrt(x * x + y * y), rate = sqrt(dx * dx + dy * dy);
  if (fabs(x * dy - y * dx) > MG_IMPACT_STRAIGHT_ANGLE * slip * rate) return slip / rate / MG_IMPACT_PARTS;
  mg_blow_share(b, b->velocity, b->force_ratio);
  b->keeps_direction = 1, *dies = x * dx + y * dy < 0;
  return *dies ? slip / rate : MG_MAX;
}

/* Negative until the end of the phase. */
static mg_real mg_blow_left(const mg_impact_path *b, const mg_real *start, int law, mg_real e,
                            const mg_impact_path *turn) {
  if (!turn) return b->velocity[0];
  if (law == MG_POISSON) return b->impulse - (1 + e) * turn->impulse;
  if (law == MG_STRONGE) return b->velocity[5] - (1 - e * e) * turn->velocity[5];
  return b->velocity[0] + e * start[0];
}

/* Through one phase; `turn`: where compression ended, none as yet in compression. Returns 0 where it does not end. */
static int mg_blow_phase(mg_impact_path *b, const mg_real *start, int law, mg_real e, const mg_impact_path *turn) {
  const mg_real first = -start[0] / b->G[0];
  mg_real guess = first;
  for (int step = 0; step < MG_IMPACT_STEPS; step++) {
    int dies;
    mg_impact_path to;
    const mg_real stretch = mg_blow_stretch(b, &dies), dp = stretch < guess ? stretch : guess;
    const mg_real error = mg_blow_go(b, dp, &to);
    guess = dp * mg_step_growth(error, 4);
    if (!(error <= 1)) continue;
    if (mg_blow_left(&to, start, law, e, turn) >= 0) {
      mg_real low = 0, high = dp;
      for (int j = 0; j < MG_IMPACT_HALVINGS; j++) {
        mg_blow_go(b, (low + high) / 2, &to);
        if (mg_blow_left(&to, start, law, e, turn) >= 0) high = (low + high) / 2;
        else low = (low + high) / 2;
      }
      mg_blow_go(b, high, b);
      return 1;
    }
    *b = to;
    const mg_real slip = sqrt(b->velocity[1] * b->velocity[1] + b->velocity[2] * b->velocity[2]);
    if (b->slip_ended || !((dies && dp == stretch) || slip <= MG_EPS * b->initial_speed)) continue;
    mg_blow_holds(b);
    guess = first;
  }
  return 0;
}

/* The whole blow from the velocities in b->u; its impulses are then b->p along N and u[3], u[4] along t1, t2. */
MG_INTERNAL int mg_integrate_impulse(mg_impact_path *b, int law, mg_real e) {
  const mg_real start[3] = {b->velocity[0], b->velocity[1], b->velocity[2]};
  b->initial_speed = sqrt(start[0] * start[0] + start[1] * start[1] + start[2] * start[2]);
  b->impulse = b->velocity[3] = b->velocity[4] = b->velocity[5] = 0, b->slip_ended = b->keeps_direction = 0,
  b->force_ratio[0] = b->force_ratio[1] = 0;
  if (!(b->mu[0] > 0)) b->slip_ended = 1;
  else if (sqrt(start[1] * start[1] + start[2] * start[2]) <= MG_EPS * b->initial_speed) mg_blow_holds(b);
  if (!mg_blow_phase(b, start, law, e, 0)) return 0;
  const mg_impact_path turn = *b;
  return e > 0 ? mg_blow_phase(b, start, law, e, &turn) : 1;
}
