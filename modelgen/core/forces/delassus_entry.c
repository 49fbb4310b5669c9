/* Entries of the Delassus matrix J M^-1 J^T: how forces on one row accelerate another. */
#include "forces/forces.h"
#include "model/model.h"

MG_INTERNAL mg_real mg_delassus_entry(const mg_context *c, int row, int column) {
  mg_real sum = 0;
  for (int side = 0; side < 2; side++)
    for (int other = 0; other < 2; other++) {
      const int body = side ? c->contacts.f[row] : c->contacts.o[row];
      if (body != (other ? c->contacts.f : c->contacts.o)[column] || !mg_is_moved_by_forces(c, body)) continue;
      sum += mg_dot6(c->rows.J + 12 * row + 6 * side, c->rows.MJ + 12 * column + 6 * other);
    }
  return sum;
}
