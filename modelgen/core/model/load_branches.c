/* Loads that jump or have kinks: each is smooth on its branches, of which its switching functions decide. Reads the
   branches of the run and the state evaluated last. Writes c->switches. */
#include "model/model.h"
#include "base/base.h"

MG_INTERNAL int mg_switch_begin(const mg_system *s, int load) { return s->n_switch ? s->load_switch[load] : 0; }

MG_INTERNAL int mg_switch_end(const mg_system *s, int load) { return s->n_switch ? s->load_switch[load + 1] : 0; }

MG_INTERNAL long mg_switch_gradient_size(const mg_system *s) {
  long most = 0;
  for (int i = 0; i < s->n_load; i++) {
    const long columns = (long)MG_SWITCH_COLUMNS + s->kernels->load_kinds[s->load_kind[i]].n_parameters,
               size = columns * (mg_switch_end(s, i) - mg_switch_begin(s, i));
    if (size > most) most = size;
  }
  return most;
}

MG_INTERNAL void mg_add_branch_wrench(const mg_context *c, mg_real t, int load, int from, mg_real weight,
                                      mg_real *wrench) {
  const mg_system *s = c->system;
  const int a = s->load_a[load], b = s->load_b[load] < 0 ? a : s->load_b[load];
  const mg_real *branch = c->run->branch;
  mg_real part[12] = {0};
  for (int k = from; k < mg_switch_end(s, load); k++) {
    if (c->run->switch_mode[k] != MG_BRANCH_SLIDES) continue;
    const mg_real between = branch[k];
    mg_set_branch(c, k, 1), mg_add_branch_wrench(c, t, load, k + 1, weight * (1 + between) / 2, wrench);
    mg_set_branch(c, k, -1), mg_add_branch_wrench(c, t, load, k + 1, weight * (1 - between) / 2, wrench);
    mg_set_branch(c, k, between);
    return;
  }
  c->kernels->load_branch(s->load_kind[load], &t, c->bodies.pose + 12 * a, c->bodies.twist + 6 * a,
                          c->bodies.pose + 12 * b, c->bodies.twist + 6 * b, s->parameters + s->load_parameters[load],
                          c->run->input, branch + mg_switch_begin(s, load), c->bodies.quaternion + 4 * a, part,
                          part + 6);
  for (int i = 0; i < 12; i++) wrench[i] += weight * part[i];
}

/* Evaluates the switching functions of a load with their gradients, row after row of `columns`. */
static void mg_evaluate_switches(mg_context *c, mg_real t, int load) {
  const mg_system *s = c->system;
  const int a = s->load_a[load], b = s->load_b[load] < 0 ? a : s->load_b[load], first = mg_switch_begin(s, load);
  mg_zero_reals(c->switches.input_gradient, 3L * s->n_input * (mg_switch_end(s, load) - first));
  c->kernels->load_switches(s->load_kind[load], &t, c->bodies.pose + 12 * a, c->bodies.twist + 6 * a,
                            c->bodies.pose + 12 * b, c->bodies.twist + 6 * b, s->parameters + s->load_parameters[load],
                            c->run->input, c->run->branch + first, c->bodies.quaternion + 4 * a,
                            c->switches.value + first, c->switches.gradient, c->switches.input_gradient,
                            c->switches.second + 2L * first);
}

/* Adds to rate, second rate and size of a switching function what the motion of a body contributes. */
static void mg_add_motion_to_switch(const mg_context *c, int body, const mg_real *gradient, mg_real *rate,
                                    mg_real *second, mg_real *size) {
  const mg_real *pose = c->bodies.pose + 12 * body, *twist = c->bodies.twist + 6 * body,
                *acceleration = c->bodies.acceleration + 6 * body, *spin = twist + 3, length = c->system->length,
                time = c->system->time;
  const int is_fixed = c->bodies.motion[body] == MG_FIXED;
  for (int i = 0; i < 3; i++) {
    *size += fabs(gradient[i]) * (fabs(pose[i]) + length) + fabs(gradient[12 + i]) * (fabs(twist[i]) + length / time) +
             fabs(gradient[15 + i]) * (fabs(spin[i]) + 1 / time);
    if (is_fixed) continue;
    *rate += gradient[i] * twist[i] + gradient[12 + i] * acceleration[i] + gradient[15 + i] * acceleration[3 + i];
    *second += gradient[i] * acceleration[i];
  }
  for (int i = 0; i < 3; i++) {
    const mg_real *x = pose + 3 + i, *g = gradient + 3 + i; /* row i of the rotation matrix */
    for (int k = 0; k < 3; k++) {
      const int next = (k + 1) % 3, last = (k + 2) % 3;
      *size += fabs(g[3 * k]);
      if (is_fixed) continue;
      *rate += g[3 * k] * (x[3 * next] * spin[last] - x[3 * last] * spin[next]);
      *second += g[3 * k] * (x[3 * next] * acceleration[3 + last] - x[3 * last] * acceleration[3 + next]);
    }
  }
}

MG_INTERNAL const mg_real *mg_switch_gradient(mg_context *c, mg_real t, int load, int which,
                                              const mg_real **input_gradient) {
  MG_NEEDS_ANY(c, MG_VALID_TWISTS);
  const int row = which - mg_switch_begin(c->system, load);
  mg_evaluate_switches(c, t, load);
  *input_gradient = c->switches.input_gradient + 3L * c->system->n_input * row;
  return c->switches.gradient +
         (long)row * (MG_SWITCH_COLUMNS + c->kernels->load_kinds[c->system->load_kind[load]].n_parameters);
}

MG_INTERNAL int mg_load_of_switch(const mg_system *s, int which) {
  int load = 0;
  while (s->load_switch[load + 1] <= which) load++;
  return load;
}

MG_INTERNAL void mg_update_switches(mg_context *c, mg_real t) {
  MG_NEEDS_TIME(c, t), MG_NEEDS_ANY(c, MG_VALID_FREE);
  const mg_system *s = c->system;
  for (int load = 0; load < s->n_load; load++) {
    const int first = mg_switch_begin(s, load), end = mg_switch_end(s, load), a = s->load_a[load], b = s->load_b[load],
              n = c->kernels->load_kinds[s->load_kind[load]].n_parameters;
    if (first == end) continue;
    mg_evaluate_switches(c, t, load);
    for (int k = first; k < end; k++) {
      const mg_real *g = c->switches.gradient + (long)(k - first) * (MG_SWITCH_COLUMNS + n),
                    *by_input = c->switches.input_gradient + 3L * s->n_input * (k - first);
      mg_real rate = g[0], size = fabs(g[0]) * (fabs(t) + s->time), *second = c->switches.second + 2L * k;
      mg_add_motion_to_switch(c, a, g + 1, &rate, second + 1, &size);
      if (b >= 0) mg_add_motion_to_switch(c, b, g + 19, &rate, second + 1, &size);
      for (int i = 0; i < n; i++) size += fabs(g[MG_SWITCH_COLUMNS + i] * s->parameters[s->load_parameters[load] + i]);
      for (int i = 0; i < 3 * s->n_input; i++) size += fabs(by_input[i] * c->run->input[i]);
      mg_copy_reals(c->switches.slope + (long)MG_SWITCH_COLUMNS * k, g, MG_SWITCH_COLUMNS);
      c->switches.rate[k] = rate, c->switches.size[k] = size;
      c->switches.noise[k] =
          MG_SWITCH_ROUNDING * MG_EPS * size + 4 * c->settings->event_tolerance * s->time * fabs(rate);
    }
  }
}
