/* Motion of the bodies: poses and twists at a state, loads, and accelerations without constraint forces (the free
   part of equation (2.6) of Anitescu, Cremer and Potra, 1995). Writes c->bodies, and for the loads
   c->bodies.wrench. */
#include "model/model.h"

MG_INTERNAL int mg_body_kind_of(const mg_context *c, int body) {
  MG_REQUIRE(body >= 0 && body < c->system->n_body);
  return c->system->body_kind[body];
}

MG_INTERNAL int mg_is_moved_by_forces(const mg_context *c, int body) {
  MG_REQUIRE(body >= 0 && body < c->system->n_body);
  return c->bodies.motion[body] >= MG_POINT;
}

MG_INTERNAL void mg_copy_velocity(const mg_context *c, int body, const mg_real *from, mg_real *to) {
  const int motion = c->bodies.motion[body];
  if (motion < MG_POINT) return;
  to[0] = from[0], to[1] = from[1], to[2] = from[2];
  if (motion == MG_FREE) to[3] = from[3], to[4] = from[4], to[5] = from[5];
}

MG_INTERNAL void mg_place_body(const mg_context *c, mg_real t, const mg_real *x, int body, mg_real *pose,
                               mg_real *twist, mg_real *accel) {
  const mg_system *s = c->system;
  const int kind = mg_body_kind_of(c, body), motion = c->bodies.motion[body];
  const mg_real *q = x + s->body_q[body], *u = x + s->n_q + s->body_u[body];
  const int n_u = motion < MG_POINT ? 0 : c->kernels->body_kinds[kind].n_u;
  for (int i = 0; i < n_u; i++) twist[i] = u[i];
  if (motion == MG_DRIVEN)
    c->kernels->body_path(kind, &t, s->parameters + s->body_parameters[body], c->run->input, pose, twist, accel);
  if (motion == MG_FREE) c->kernels->body_pose(kind, q, pose);
  if (motion == MG_POINT)
    for (int i = 0; i < 3; i++) pose[i] = q[i];
}

MG_INTERNAL void mg_update_poses(mg_context *c, mg_real t, const mg_real *x) {
  const mg_system *s = c->system;
  for (int b = 0; b < s->n_body; b++) {
    if (c->bodies.motion[b] == MG_FIXED) continue;
    mg_place_body(c, t, x, b, c->bodies.pose + 12 * b, c->bodies.twist + 6 * b, c->bodies.acceleration + 6 * b);
    if (c->bodies.motion[b] == MG_FREE && s->n_switch)
      mg_copy_reals(c->bodies.quaternion + 4 * b, x + s->body_q[b] + 3, 4);
  }
  MG_NOTE_TIME(c, t), MG_NOTE(c, MG_VALID_POSES, t, x), MG_NOTE(c, MG_VALID_TWISTS, t, x);
}

MG_INTERNAL void mg_written_load_wrench(const mg_context *c, mg_real t, int load, mg_real *wrench) {
  const mg_system *s = c->system;
  const int a = s->load_a[load], b = s->load_b[load] < 0 ? a : s->load_b[load];
  c->kernels->load_wrench(s->load_kind[load], &t, c->bodies.pose + 12 * a, c->bodies.twist + 6 * a,
                          c->bodies.pose + 12 * b, c->bodies.twist + 6 * b, s->parameters + s->load_parameters[load],
                          c->run->input, wrench, wrench + 6);
}

MG_INTERNAL void mg_load_wrench(const mg_context *c, mg_real t, int load, mg_real *wrench) {
  const int first = mg_switch_begin(c->system, load);
  if (!mg_has_branches(c) || first == mg_switch_end(c->system, load)) {
    mg_written_load_wrench(c, t, load, wrench);
    return;
  }
  mg_zero_reals(wrench, 12);
  mg_add_branch_wrench(c, t, load, first, 1, wrench);
}

/* Adds the wrenches of a load to those of its bodies, and its power to *power. */
static void mg_add_load(mg_context *c, mg_real t, int load, mg_real *power) {
  const mg_system *s = c->system;
  const int a = s->load_a[load], b = s->load_b[load];
  mg_real wrench[12] = {0};
  mg_load_wrench(c, t, load, wrench);
  for (int side = 0; side < 2; side++) {
    const int body = side ? b : a;
    if (body < 0 || !mg_is_moved_by_forces(c, body)) continue;
    for (int i = 0; i < c->kernels->body_kinds[mg_body_kind_of(c, body)].n_u; i++) {
      c->bodies.wrench[6 * body + i] += wrench[6 * side + i];
      *power += wrench[6 * side + i] * c->bodies.twist[6 * body + i];
    }
  }
}

MG_INTERNAL void mg_free_accelerations(mg_context *c, mg_real t, const mg_real *x, mg_real *x_dot) {
  const mg_system *s = c->system;
  mg_real power = 0;
  MG_NEEDS(c, MG_VALID_POSES, t, x), MG_NEEDS(c, MG_VALID_TWISTS, t, x);
  if (s->n_load) {
    for (int i = 0; i < 6 * s->n_body; i++) c->bodies.wrench[i] = 0;
    for (int i = 0; i < s->n_load; i++)
      if (!(c->springs.are_rows && mg_is_spring(s, i))) mg_add_load(c, t, i, &power);
  }
  for (int b = 0; b < s->n_body; b++)
    if (mg_is_moved_by_forces(c, b))
      c->kernels->body_motion(mg_body_kind_of(c, b), x + s->body_q[b], x + s->n_q + s->body_u[b],
                              c->bodies.wrench + 6 * b, s->gravity, s->parameters + s->body_parameters[b],
                              x_dot + s->body_q[b], c->bodies.acceleration + 6 * b);
  x_dot[c->layout.work_state] = power;
  MG_NOTE_WITH(c, MG_VALID_FREE, MG_VALID_TWISTS);
  if (x_dot == c->step.slopes) MG_FORGET(c, MG_VALID_SLOPE);
}

MG_INTERNAL void mg_normalise_quaternions(const mg_context *c, mg_real *x) {
  for (int b = 0; b < c->system->n_body; b++) {
    if (c->bodies.motion[b] != MG_FREE) continue;
    mg_real *e = x + c->system->body_q[b] + 3;
    const mg_real inverse = 1 / sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3]);
    for (int i = 0; i < 4; i++) e[i] *= inverse;
  }
}

MG_INTERNAL int mg_moving_body(const mg_context *c, int contact) {
  const int o = c->contacts.o[contact];
  return mg_is_moved_by_forces(c, o) ? o : c->contacts.f[contact];
}

MG_INTERNAL int mg_is_time_stepping(const mg_context *c) {
  return c->settings->method == MG_TIME_STEPPING || c->run->fallback_left > 0;
}

MG_INTERNAL int mg_has_branches(const mg_context *c) {
  return c->system->n_switch && !c->switches.is_literal && !mg_is_time_stepping(c);
}

MG_INTERNAL int mg_is_free_body(const mg_context *c, int body) { return c->bodies.motion[body] == MG_FREE; }

MG_INTERNAL int mg_is_driven_body(const mg_system *s, int body) {
  return s->kernels->body_kinds[s->body_kind[body]].motion == MG_DRIVEN;
}

MG_INTERNAL int mg_is_spring(const mg_system *s, int load) {
  return s->kernels->load_kinds[s->load_kind[load]].is_spring;
}
