/* Loads that jump where the motion takes them, such as sign(x): a changed run meets the jump at another time, of which
   the derivatives do not know. A jump at a given time is the same in every changed run. Reads the state at the end of a
   step and s->load, the loads at its start. */
#include "sensitivity/sensitivity.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"

#define MG_JUMP_BISECTIONS 16 /* of the way along which a jump is sought */

/* Wrench of a load alone on its two bodies. */
static void mg_wrench_of_load(const mg_context *c, mg_real t, int load, mg_real *wrench) {
  mg_zero_reals(wrench, 12);
  mg_load_wrench(c, t, load, wrench);
}

MG_INTERNAL void mg_note_loads(const mg_context *c, mg_sensitivity *s, mg_real t) {
  for (int i = 0; i < c->system->n_load; i++) mg_wrench_of_load(c, t, i, s->load + 12 * i);
}

/* Largest difference of two wrenches on two bodies, N; the second may be null for zero. */
static mg_real mg_wrench_difference(const mg_context *c, const mg_real *one, const mg_real *other) {
  mg_real most = 0;
  for (int k = 0; k < 12; k++)
    most = mg_max(most, fabs(one[k] - (other ? other[k] : 0)) / (k % 6 < 3 ? 1 : c->system->length));
  return most;
}

/* Wrench of a load where its bodies have gone on by `part` of the rates in s->at, at the same time. */
static void mg_moved_load(mg_context *c, const mg_sensitivity *s, mg_real t, int load, mg_real part, mg_real *wrench) {
  const int bodies[2] = {c->system->load_a[load], c->system->load_b[load]};
  mg_real kept[36];
  for (int side = 0; side < 2; side++) {
    if (bodies[side] < 0 || !mg_is_moved_by_forces(c, bodies[side])) continue;
    mg_real *pose = c->bodies.pose + 12 * bodies[side], *twist = c->bodies.twist + 6 * bodies[side];
    mg_pack(mg_pack(kept + 18 * side, 12, pose), 6, twist);
    for (int k = 0; k < 12; k++) pose[k] += part * s->at.pose[12 * bodies[side] + k];
    for (int k = 0; k < 6; k++) twist[k] += part * s->at.twist[6 * bodies[side] + k];
  }
  mg_wrench_of_load(c, t, load, wrench);
  for (int side = 0; side < 2; side++)
    if (bodies[side] >= 0 && mg_is_moved_by_forces(c, bodies[side]))
      mg_pack(c->bodies.pose + 12 * bodies[side], 12, kept + 18 * side),
          mg_pack(c->bodies.twist + 6 * bodies[side], 6, kept + 18 * side + 12);
}

/* True if a load changes by half of `change` at one place of the way from -span to span, and by half of what it changes
   along the way. */
static int mg_jumps_on_its_way(mg_context *c, const mg_sensitivity *s, mg_real t, int load, mg_real span,
                               mg_real change) {
  mg_real from = -span, to = span, before[12], middle[12], after[12];
  mg_moved_load(c, s, t, load, from, before), mg_moved_load(c, s, t, load, to, after);
  const mg_real least = mg_max(change, mg_wrench_difference(c, before, after)) / 2;
  for (int k = 0; k < MG_JUMP_BISECTIONS && mg_wrench_difference(c, before, after) > least; k++) {
    const mg_real at = (from + to) / 2;
    mg_moved_load(c, s, t, load, at, middle);
    const int is_first = mg_wrench_difference(c, before, middle) > mg_wrench_difference(c, middle, after);
    if (is_first) to = at, mg_copy_reals(after, middle, 12);
    else from = at, mg_copy_reals(before, middle, 12);
  }
  return mg_wrench_difference(c, before, after) > least;
}

MG_INTERNAL int mg_has_load_jump_along(mg_context *c, const mg_sensitivity *s, mg_real t) {
  const mg_real length = c->system->length, time = c->system->time;
  mg_real most = 0, wrench[12];
  for (int b = 0; b < c->system->n_body; b++) {
    const mg_real *pose = s->at.pose + 12 * b, *twist = s->at.twist + 6 * b;
    most = mg_max(mg_max(most, mg_max_abs(3, pose) / length), mg_max_abs(9, pose + 3));
    most = mg_max(mg_max(most, mg_max_abs(3, twist) * time / length), mg_max_abs(3, twist + 3) * time);
  }
  for (int i = 0; i < c->system->n_load && most > 0; i++) {
    mg_wrench_of_load(c, t, i, wrench);
    const mg_real size = mg_wrench_difference(c, wrench, 0);
    if (size > 0 &&
        mg_jumps_on_its_way(c, s, t, i, c->settings->derivative_reach / most, c->settings->derivative_jump_part * size))
      return 1;
  }
  return 0;
}

MG_INTERNAL int mg_has_load_jump(mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x, const mg_real *slope,
                                 mg_real h) {
  mg_real wrench[12];
  int has_rates = 0;
  if (mg_slides(c)) return 1;
  for (int i = 0; i < c->system->n_load; i++) {
    mg_wrench_of_load(c, t, i, wrench);
    const mg_real *before = s->load + 12 * i, change = mg_wrench_difference(c, wrench, before),
                  size = mg_max(mg_wrench_difference(c, wrench, 0), mg_wrench_difference(c, before, 0));
    if (!(change * c->system->time > c->settings->load_jump_rate * h * size)) continue;
    if (!has_rates) {
      s->is_time = has_rates = 1;
      mg_place_bodies_tangent(c, s, 0, t, x, slope);
      s->is_time = 0;
    }
    if (mg_jumps_on_its_way(c, s, t, i, mg_max(4 * h, c->settings->load_jump_span * c->system->time), change)) return 1;
  }
  return 0;
}
