/* Regions from outside the core: the outline of their intersection, its hull, and margins of points. */
#include "modelgen.h"
#include "region.h"

MG_API long mg_region_size(int n_arc, int n_o) { return mg_hull_room(n_arc, n_o) + mg_reals(n_arc, sizeof(mg_arc)); }

static void mg_put_support(const mg_support *from, int *identity, mg_real *where) {
  identity[0] = from->side, identity[1] = from->arc, identity[2] = from->crossing_arc;
  where[0] = from->t, where[1] = from->crossing_t, where[2] = from->point[0], where[3] = from->point[1];
}

static void mg_put_margin(const mg_hull *h, const mg_region_query *q, int i) {
  mg_brink brink = {0};
  q->margin[i] = mg_hull_margin(h, q->x + 2 * i, &brink);
  q->supports[i] = brink.n;
  for (int k = 0; k < 2; k++) q->normal[2 * i + k] = brink.normal[k];
  for (int k = 0; k < brink.n; k++) mg_put_support(brink.at + k, q->identity + 6 * i + 3 * k, q->where + 8 * i + 4 * k);
}

MG_API int mg_region(const mg_region_query *q, mg_real *work) {
  mg_arc *arc = mg_part_of_memory(&work, q->n_arc, sizeof(mg_arc));
  for (int i = 0; i < q->n_arc; i++) {
    const mg_real *numbers = q->numbers + 14 * i;
    const mg_arc given = {q->shape[i], q->loop[i], q->parameters + q->first[i], numbers, numbers[12], numbers[13]};
    arc[i] = given;
  }
  const mg_regions regions = {q->n_arc, q->n_o, arc, q->shared};
  mg_hull h;
  mg_set_regions(&h, &regions, work);
  const int sides = mg_lay(&h, q->pose);
  for (int i = 0; i < q->n_point; i++) mg_put_margin(&h, q, i);
  mg_outline_pieces(&h, q->fine, q->outline);
  mg_outline_hull(&h, q->fine, q->hull);
  return h.overflow ? -1 : sides;
}
