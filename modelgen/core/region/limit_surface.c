/* The coefficient of friction that holds a given wrench, which is how far it is from the limit surface: the minimum of
   the frictional power over all twists on which the wrench has the same power, a smooth convex function of two
   unknowns, by the BFGS method (Nocedal and Wright, Numerical Optimization, 2006, chapter 6). */
#include "region/region.h"

#define MG_TWIST_STEPS 80 /* most steps of the BFGS method */

/* Twists on which a force has power 1: from + y0 across0 + y1 across1, with torques divided, angular velocities
   multiplied by the radius. */
typedef struct {
  const mg_winkler_pressure_field *press; /* pressure */
  mg_real radius;                         /* radius, m */
  mg_real from[3];                        /* twist of least size */
  mg_real across[2][3];                   /* directions of the plane, unit length */
} mg_search_plane;

/* Twist at y on the search plane. */
static void mg_twist_on_plane(const mg_search_plane *s, const mg_real *y, mg_real *twist) {
  for (int k = 0; k < 3; k++) twist[k] = s->from[k] + y[0] * s->across[0][k] + y[1] * s->across[1][k];
}

/* Frictional power of the twist at y, and its slope by y. */
static mg_real mg_friction_power_at(const mg_search_plane *s, const mg_real *y, mg_real *slope) {
  mg_real twist[3], force[3], G[3][3], power = 0;
  mg_twist_on_plane(s, y, twist);
  twist[2] /= s->radius;
  mg_friction_matrix(s->press, twist, G);
  const mg_real *coefficients = s->press->coefficients;
  for (int k = 0; k < 3; k++) {
    force[k] = G[k][0] * coefficients[0] + G[k][1] * coefficients[1] + G[k][2] * coefficients[2];
    power += force[k] * twist[k];
  }
  force[2] /= s->radius;
  for (int j = 0; j < 2; j++) {
    slope[j] = 0;
    for (int k = 0; k < 3; k++) slope[j] += force[k] * s->across[j][k];
  }
  return power;
}

/* Sets the plane of twists on which a force of size 1 has power 1. */
static void mg_set_search_plane(mg_search_plane *s, const mg_real *force) {
  int least = 0;
  mg_real size = 0;
  for (int k = 1; k < 3; k++)
    if (fabs(force[k]) < fabs(force[least])) least = k;
  for (int k = 0; k < 3; k++) {
    s->from[k] = force[k], s->across[0][k] = (k == least) - force[least] * force[k];
    size += s->across[0][k] * s->across[0][k];
  }
  for (int k = 0; k < 3; k++) s->across[0][k] /= sqrt(size);
  for (int k = 0; k < 3; k++) {
    const int a = (k + 1) % 3, b = (k + 2) % 3;
    s->across[1][k] = force[a] * s->across[0][b] - force[b] * s->across[0][a];
  }
}

/* Shortens the step until the power falls sufficiently (Armijo); moves y, and writes the slope there. Returns the
   power. */
static mg_real mg_armijo_step(const mg_search_plane *s, mg_real power, const mg_real *slope, mg_real *y, mg_real *step,
                              mg_real *slope_next) {
  mg_real next[2], found = power;
  const mg_real fall = slope[0] * step[0] + slope[1] * step[1];
  for (mg_real part = 1; part > sqrt(MG_EPS); part /= 2) {
    for (int k = 0; k < 2; k++) next[k] = y[k] + part * step[k];
    found = mg_friction_power_at(s, next, slope_next);
    if (found > power + part * fall / 10000 + 4 * MG_EPS * power) continue;
    for (int k = 0; k < 2; k++) step[k] *= part, y[k] = next[k];
    return found;
  }
  step[0] = step[1] = 0;
  return power;
}

/* BFGS update of the inverse Hessian H (xx, xy, yy) by a step and the change of the slope. */
static void mg_bfgs_update(mg_real *H, const mg_real *step, const mg_real *grown) {
  const mg_real curve = step[0] * grown[0] + step[1] * grown[1];
  if (!(curve > 0)) return;
  const mg_real Hg[2] = {H[0] * grown[0] + H[1] * grown[1], H[1] * grown[0] + H[2] * grown[1]};
  const mg_real more = (1 + (grown[0] * Hg[0] + grown[1] * Hg[1]) / curve) / curve;
  H[0] += more * step[0] * step[0] - 2 * Hg[0] * step[0] / curve;
  H[1] += more * step[0] * step[1] - (Hg[0] * step[1] + Hg[1] * step[0]) / curve;
  H[2] += more * step[1] * step[1] - 2 * Hg[1] * step[1] / curve;
}

MG_INTERNAL mg_real mg_limit_surface_ratio(const mg_winkler_pressure_field *p, const mg_real *wrench, mg_real radius,
                                           mg_real *twist) {
  const mg_real force[3] = {wrench[0], wrench[1], wrench[2] / radius};
  const mg_real size = sqrt(force[0] * force[0] + force[1] * force[1] + force[2] * force[2]);
  mg_search_plane s = {p, radius, {0, 0, 0}, {{0, 0, 0}, {0, 0, 0}}};
  mg_real y[2] = {0, 0}, slope[2], next[2];
  twist[0] = 1, twist[1] = twist[2] = 0;
  if (!(size > 0)) return 0;
  const mg_real unit[3] = {force[0] / size, force[1] / size, force[2] / size};
  mg_set_search_plane(&s, unit);
  mg_real power = mg_friction_power_at(&s, y, slope), H[3] = {1 / power, 0, 1 / power};
  for (int i = 0; i < MG_TWIST_STEPS && fabs(slope[0]) + fabs(slope[1]) > 64 * MG_EPS * power; i++) {
    mg_real step[2] = {-H[0] * slope[0] - H[1] * slope[1], -H[1] * slope[0] - H[2] * slope[1]};
    power = mg_armijo_step(&s, power, slope, y, step, next);
    if (step[0] == 0 && step[1] == 0) break;
    const mg_real grown[2] = {next[0] - slope[0], next[1] - slope[1]};
    mg_bfgs_update(H, step, grown);
    slope[0] = next[0], slope[1] = next[1];
  }
  mg_twist_on_plane(&s, y, twist);
  const mg_real length = sqrt(twist[0] * twist[0] + twist[1] * twist[1] + twist[2] * twist[2]);
  for (int k = 0; k < 3; k++) twist[k] /= length;
  return size / power;
}
