/* Local error of derivatives in a step that is tried. The error of the run tells nothing of derivatives of the
   right-hand side that jump within the step, as at the kink of a load or at a knot of a surface: the run then takes
   shorter steps over such an instant. Reads the derivatives of the stages and of the end. */
#include "sensitivity/sensitivity.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/integrate.h"

/* Largest of the derivatives along a direction, by the scales of the states. */
static mg_real mg_tangent_size(const mg_context *c, const mg_real *dx) {
  mg_real most = 0;
  for (int i = 0; i < c->layout.n_states; i++) most = mg_max(most, fabs(dx[i]) / c->step.scale[i]);
  return most;
}

#define MG_HARDLY_FALLING_PART ((mg_real)0.125) /* up to it, the direction of slip has smooth derivatives in a step */

/* True if slip in a plane falls by more than that part in the step that is tried, or is reversed. Needs the rows
   at the last stage if anything has slipped at the start. */
static int mg_may_lose_slip(mg_context *c, const mg_sensitivity *s) {
  mg_real slip[2];
  if (!c->system->n_friction) return 0;
  MG_REQUIRE(!(mg_max_abs(c->system->n_friction + c->system->n_patch_slot, s->slip) > 0) ||
             MG_IS_AT(c, MG_VALID_ROWS, c->valid.t, c->step.stage));
  mg_update_gap_rates(c);
  for (int i = mg_next_row(c, -1); i < c->layout.support_begin; i = mg_next_row(c, i))
    for (int g = c->system->contact_friction[i]; g < c->system->contact_friction[i + 1]; g++)
      if (s->slip[g] > 0 && (mg_slip_along_direction(c, i, g, slip) < 0 ||
                             mg_slip_of(c, i, g) < (1 - MG_HARDLY_FALLING_PART) * s->slip[g]))
        return 1;
  for (int slot = 0; slot < c->system->n_patch_slot; slot++) {
    const mg_real before = s->slip[c->system->n_friction + slot];
    if (before > 0 && mg_patch_slip_along_direction(c, slot, c->rows.d_dot) < (1 - MG_HARDLY_FALLING_PART) * before)
      return 1;
  }
  return 0;
}

/* Error of the derivatives along a direction at the end of a step that is tried, of what it may be: of their size, or
   of their rounding where they are hardly larger. */
static mg_real mg_tangent_error(const mg_context *c, mg_sensitivity *s, int direction, mg_real h) {
  const int states = c->layout.n_states;
  const long stride = (long)s->directions->n * states;
  const mg_real *dx = s->tangent->x + (long)direction * states, *end = s->end + (long)direction * states,
                *slopes = s->slopes + (long)direction * states,
                part = c->settings->derivative_error_factor * c->settings->tolerance,
                rounding = 16 * MG_EPS * s->size[direction];
  const mg_real size = mg_max(mg_tangent_size(c, dx), mg_tangent_size(c, end)), least = mg_max(size, rounding / part);
  return least > 0 ? mg_dop853_error(c, dx, end, slopes, stride, least, h) / c->settings->derivative_error_factor : 0;
}

MG_INTERNAL mg_real mg_followed_error(mg_context *c, void *of, mg_real h) {
  mg_sensitivity *s = of;
  mg_followed_step *step = &s->step;
  mg_real most = 0;
  if (step->is_uncertain || h <= c->settings->derivative_step_min * c->system->time || mg_may_lose_slip(c, s)) return 0;
  for (int j = 0; j < s->directions->n; j++) most = mg_max(most, mg_tangent_error(c, s, j, h));
  if (c->run->t < step->refused_end) most /= c->settings->derivative_kink_part;
  if (!(most > 1)) return 0;
  step->refused_end = mg_max(step->refused_end, c->run->t + h);
  return most;
}
