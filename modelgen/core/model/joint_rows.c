/* Rows of the joints: values, J, Gamma1 (equation (2.3) of Anitescu, Cremer and Potra, 1995) and the rates of
   prescribed motions. Writes c->rows.

   The armature I of a coordinate with the rate r = j u adds r I r / 2 to the kinetic energy, and so the force
   -I dr/dt along the row j to the bodies. With J = sqrt(I) j this is the row

     J du/dt + gamma + f = 0,   after an impulse   J (u+ - u-) + L = 0:

   a bilateral row like those that the joint holds, with 1 added to its diagonal of J M^-1 J^T, and with nothing to
   hold: its value and its rate count as zero. By Woodbury's formula the bodies move as under M + sum I j^T j. */
#include "model/model.h"

MG_INTERNAL int mg_held_joint_rows(const mg_context *c, int joint) {
  const mg_joint_kind *kind = c->kernels->joint_kinds + c->system->joint_kind[joint];
  return kind->n_rows - kind->n_inertial;
}

MG_INTERNAL mg_real mg_row_yield(const mg_context *c, int row) {
  return c->contacts.is_inertial[row] || (c->springs.are_rows && row >= c->layout.spring_row_begin);
}

MG_INTERNAL mg_real mg_armature_energy(const mg_context *c, mg_real t, const mg_real *x) {
  mg_real energy = 0;
  for (int j = 0; j < c->system->n_joint; j++) {
    const mg_joint_kind *kind = c->kernels->joint_kinds + c->system->joint_kind[j];
    const int side[2] = {c->system->joint_a[j], c->system->joint_b[j]};
    mg_real pose[24], twist[12], accel[12], value[MG_JOINT_ROWS_MAX], J[12 * MG_JOINT_ROWS_MAX],
        gamma[MG_JOINT_ROWS_MAX], bias[MG_JOINT_ROWS_MAX];
    if (!kind->n_inertial) continue;
    for (int k = 0; k < 2; k++) {
      mg_copy_reals(pose + 12 * k, c->bodies.pose + 12 * side[k], 12);
      mg_copy_reals(twist + 6 * k, c->bodies.twist + 6 * side[k], 6);
      mg_place_body(c, t, x, side[k], pose + 12 * k, twist + 6 * k, accel + 6 * k);
    }
    mg_zero_reals(J, 12 * MG_JOINT_ROWS_MAX);
    c->kernels->joint_rows(c->system->joint_kind[j], &t, pose, twist, pose + 12, twist + 6,
                           c->system->parameters + c->system->joint_parameters[j], c->run->input, value, J, gamma,
                           bias);
    for (int i = kind->n_rows - kind->n_inertial; i < kind->n_rows; i++) {
      const mg_real rate = mg_dot6(J + 12 * i, twist) + mg_dot6(J + 12 * i + 6, twist + 6);
      energy += rate * rate / 2;
    }
  }
  return energy;
}

MG_INTERNAL void mg_init_joint_rows(mg_context *c) {
  const mg_system *s = c->system;
  c->layout.has_prescribed_joint = 0;
  for (int i = 0; i < c->layout.spring_row_end; i++) c->contacts.is_inertial[i] = 0;
  for (int i = c->layout.joint_row_begin - 1; i < c->layout.joint_row_end; i++)
    c->contacts.kind[i] = c->contacts.o[i] = c->contacts.f[i] = 0;
  for (int j = 0; j < s->n_joint; j++) {
    const mg_joint_kind *kind = c->kernels->joint_kinds + s->joint_kind[j];
    c->layout.has_prescribed_joint |= kind->prescribed;
    for (int i = 0; i < kind->n_rows; i++) {
      const int row = c->layout.joint_row_begin + s->joint_row[j] + i;
      c->contacts.o[row] = s->joint_a[j], c->contacts.f[row] = s->joint_b[j];
      c->contacts.is_inertial[row] = i >= mg_held_joint_rows(c, j);
    }
  }
}

MG_INTERNAL void mg_update_joint_rows(mg_context *c, mg_real t) {
  const mg_system *s = c->system;
  MG_NEEDS_TIME(c, t), MG_NEEDS_ANY(c, MG_VALID_TWISTS);
  c->lcp.is_of_joints = 0;
  for (int j = 0; j < s->n_joint; j++) {
    const int a = s->joint_a[j], b = s->joint_b[j], row = c->layout.joint_row_begin + s->joint_row[j];
    if (!c->kernels->joint_kinds[s->joint_kind[j]].n_rows) continue;
    c->kernels->joint_rows(s->joint_kind[j], &t, c->bodies.pose + 12 * a, c->bodies.twist + 6 * a,
                           c->bodies.pose + 12 * b, c->bodies.twist + 6 * b, s->parameters + s->joint_parameters[j],
                           c->run->input, c->rows.d + row, c->rows.J + 12 * row, c->rows.gamma + row,
                           c->rows.time_rate + row);
  }
  MG_NOTE_WITH(c, MG_VALID_JOINT_ROWS, MG_VALID_TWISTS);
}

MG_INTERNAL int mg_append_joint_rows(const mg_context *c, int *list, int n) {
  for (int i = c->layout.joint_row_begin; i < c->layout.joint_row_end; i++) list[n++] = i;
  return n;
}

MG_INTERNAL int mg_row_joint(const mg_context *c, int row) {
  MG_REQUIRE(row >= c->layout.joint_row_begin && row < c->layout.joint_row_end);
  int joint = 0;
  while (joint + 1 < c->system->n_joint && c->system->joint_row[joint + 1] <= row - c->layout.joint_row_begin) joint++;
  return joint;
}

MG_INTERNAL int mg_worst_joint(const mg_context *c, const mg_real *value, mg_real *size) {
  int worst = c->layout.joint_row_begin;
  for (int i = c->layout.joint_row_begin; i < c->layout.joint_row_end; i++)
    if (!(fabs(value[i]) <= fabs(value[worst]))) worst = i;
  *size = fabs(value[worst]);
  return mg_row_joint(c, worst);
}
