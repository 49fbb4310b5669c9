/* Rows of the joints: values, J, Gamma1 (equation (2.3) of Anitescu, Cremer and Potra, 1995) and the rates of
   prescribed motions. Writes c->rows. */
#include "model/model.h"

MG_INTERNAL void mg_init_joint_rows(mg_context *c) {
  const mg_system *s = c->system;
  c->layout.has_prescribed_joint = 0;
  for (int i = c->layout.joint_row_begin - 1; i < c->layout.joint_row_end; i++)
    c->contacts.kind[i] = c->contacts.o[i] = c->contacts.f[i] = 0, c->lcp.column[i] = -1;
  for (int j = 0; j < s->n_joint; j++) {
    const mg_joint_kind *kind = c->kernels->joint_kinds + s->joint_kind[j];
    c->layout.has_prescribed_joint |= kind->prescribed;
    for (int i = 0; i < kind->n_rows; i++) {
      const int row = c->layout.joint_row_begin + s->joint_row[j] + i;
      c->contacts.o[row] = s->joint_a[j], c->contacts.f[row] = s->joint_b[j];
    }
  }
}

MG_INTERNAL void mg_update_joint_rows(mg_context *c, mg_real t) {
  const mg_system *s = c->system;
  for (int j = 0; j < s->n_joint; j++) {
    const int a = s->joint_a[j], b = s->joint_b[j], row = c->layout.joint_row_begin + s->joint_row[j];
    if (!c->kernels->joint_kinds[s->joint_kind[j]].n_rows) continue;
    c->kernels->joint_rows(s->joint_kind[j], &t, c->bodies.pose + 12 * a, c->bodies.twist + 6 * a,
                           c->bodies.pose + 12 * b, c->bodies.twist + 6 * b, s->parameters + s->joint_parameters[j],
                           c->run->input, c->rows.d + row, c->rows.J + 12 * row, c->rows.gamma + row,
                           c->rows.time_rate + row);
  }
}

MG_INTERNAL int mg_append_joint_rows(const mg_context *c, int *list, int n) {
  for (int i = c->layout.joint_row_begin; i < c->layout.joint_row_end; i++) list[n++] = i;
  return n;
}

MG_INTERNAL int mg_row_joint(const mg_context *c, int row) {
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
