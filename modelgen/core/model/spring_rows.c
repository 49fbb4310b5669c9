/* Rows of springs and dampers, one each: the rate of the deflection is J u. Time-stepping treats them as constraints
   that yield (timestep/spring_impulses.c); elsewhere springs are loads. Writes c->rows. */
#include "model/model.h"

MG_INTERNAL int mg_spring_count(const mg_system *s) {
  int count = 0;
  for (int i = 0; i < s->n_load; i++) count += mg_is_spring(s, i);
  return count;
}

/* Writes how many springs act on that body of a spring on which more of them act. */
static void mg_count_sharing_springs(mg_context *c) {
  int *count = c->islands.head, begin = c->layout.spring_row_begin;
  for (int b = 0; b < c->system->n_body; b++) count[b] = 0;
  for (int i = begin; i < c->layout.spring_row_end; i++)
    count[c->contacts.o[i]] += mg_is_moved_by_forces(c, c->contacts.o[i]),
        count[c->contacts.f[i]] += mg_is_moved_by_forces(c, c->contacts.f[i]);
  for (int i = begin; i < c->layout.spring_row_end; i++) {
    const int on_o = count[c->contacts.o[i]], on_f = count[c->contacts.f[i]];
    c->springs.sharing[i - begin] = on_o > on_f ? on_o : on_f;
  }
}

MG_INTERNAL void mg_init_spring_rows(mg_context *c) {
  const mg_system *s = c->system;
  int row = c->layout.spring_row_begin;
  c->springs.are_rows = 0;
  for (int i = 0; i < s->n_load; i++) {
    if (!mg_is_spring(s, i)) continue;
    c->springs.load[row - c->layout.spring_row_begin] = i;
    c->contacts.kind[row] = 0, c->contacts.o[row] = s->load_a[i], c->contacts.f[row] = s->load_b[i];
    row++;
  }
  mg_count_sharing_springs(c);
}

MG_INTERNAL mg_real mg_update_spring_row(mg_context *c, int row) {
  MG_NEEDS_ANY(c, MG_VALID_POSES);
  const mg_system *s = c->system;
  const int load = c->springs.load[row - c->layout.spring_row_begin];
  mg_real deflection;
  c->kernels->load_deflection(s->load_kind[load], c->bodies.pose + 12 * s->load_a[load],
                              c->bodies.pose + 12 * s->load_b[load], s->parameters + s->load_parameters[load],
                              &deflection, c->rows.J + 12 * row);
  return deflection;
}

MG_INTERNAL int mg_append_spring_rows(const mg_context *c, int *list, int n) {
  for (int i = c->layout.spring_row_begin; i < c->layout.spring_row_end && c->springs.are_rows; i++) list[n++] = i;
  return n;
}
