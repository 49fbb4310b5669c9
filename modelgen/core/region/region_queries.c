/* Public queries of regions without a run: overlap, hull, margins of points, and friction. */
#include "region/region.h"
#include "base/base.h"

MG_API long mg_region_size(int n_arc, int n_o) {
  return mg_hull_memory_size(n_arc, n_o) + mg_count_reals(n_arc, sizeof(mg_arc));
}

/* Copies a point of the boundary to the arrays of a query. */
static void mg_store_support(const mg_support_point *from, int *identity, mg_real *where) {
  identity[0] = from->side, identity[1] = from->arc, identity[2] = from->crossing_arc;
  where[0] = from->t, where[1] = from->crossing_t, where[2] = from->point[0], where[3] = from->point[1];
}

/* Margin of point i of a query. */
static void mg_store_margin(const mg_hull *h, const mg_region_query *q, int i) {
  mg_nearest_boundary nearest = {0};
  q->margin[i] = mg_hull_margin(h, q->points + 2 * i, &nearest);
  q->supports[i] = nearest.n;
  for (int k = 0; k < 2; k++) q->normal[2 * i + k] = nearest.normal[k];
  for (int k = 0; k < nearest.n; k++)
    mg_store_support(nearest.at + k, q->identity + 6 * i + 3 * k, q->support_position + 8 * i + 4 * k);
}

/* Overlays the regions of a query; returns the number of edges of the hull. *work then begins behind the memory
   used. */
static int mg_overlay_query(const mg_region_query *q, mg_region_pair *regions, mg_hull *h, mg_real **work) {
  mg_arc *arc = mg_take_memory(work, q->n_arc, sizeof(mg_arc));
  for (int i = 0; i < q->n_arc; i++) {
    const mg_real *numbers = q->numbers + 14 * i;
    const mg_arc given = {q->shape[i], q->loop[i], q->parameters + q->first[i], numbers, numbers[12], numbers[13]};
    arc[i] = given;
  }
  const mg_region_pair all = {q->kernels, q->n_arc, q->n_o, arc, q->coincidence};
  *regions = all;
  mg_set_regions(h, regions, *work);
  *work += mg_hull_memory_size(q->n_arc, q->n_o);
  return mg_overlay_regions(h, q->pose);
}

MG_API int mg_region(const mg_region_query *q, mg_real *work) {
  mg_region_pair regions;
  mg_hull h;
  const int sides = mg_overlay_query(q, &regions, &h, &work);
  for (int i = 0; i < q->n_point; i++) mg_store_margin(&h, q, i);
  mg_outline_pieces(&h, q->points_per_turn, q->outline);
  mg_outline_hull(&h, q->points_per_turn, q->hull);
  return h.overflow ? -1 : sides;
}

MG_API long mg_region_friction_size(int n_arc, int n_o) {
  return mg_region_size(n_arc, n_o) + mg_count_reals(mg_strip_capacity(n_arc, n_o), sizeof(mg_boundary_strip));
}

/* Pressure and friction of case i of a query. */
static void mg_store_patch_friction(const mg_patch_friction_query *q, mg_winkler_pressure_field *p, int i) {
  const mg_real *load = q->load + 3 * i, centre[2] = {load[1], load[2]};
  mg_real G[3][3], worst[3];
  mg_nearest_boundary nearest;
  q->found[i] = mg_hull_margin(p->hull, centre, &nearest) > 0 && mg_winkler_pressure(p, load[0], centre);
  for (int k = 0; k < 3; k++) q->pressure[3 * i + k] = q->friction[3 * i + k] = (mg_real)NAN;
  q->friction_needed[i] = (mg_real)NAN;
  for (int k = 0; k < 3; k++) q->limiting_twist[3 * i + k] = (mg_real)NAN;
  if (!q->found[i]) return;
  mg_friction_matrix(p, q->twist + 3 * i, G);
  for (int k = 0; k < 3; k++) {
    q->pressure[3 * i + k] = p->coefficients[k];
    q->friction[3 * i + k] =
        -(G[k][0] * p->coefficients[0] + G[k][1] * p->coefficients[1] + G[k][2] * p->coefficients[2]);
  }
  q->friction_needed[i] = mg_limit_surface_ratio(p, q->wrench + 3 * i, p->reach, worst);
  for (int k = 0; k < 3; k++) q->limiting_twist[3 * i + k] = k < 2 ? worst[k] : worst[k] / p->reach;
}

MG_API int mg_region_friction(const mg_patch_friction_query *q, mg_real *work) {
  const mg_region_query *r = q->regions;
  mg_region_pair regions;
  mg_hull h;
  mg_winkler_pressure_field pressure;
  const int sides = mg_overlay_query(r, &regions, &h, &work);
  mg_open_pressure(&pressure, &h, mg_strip_capacity(r->n_arc, r->n_o), (mg_boundary_strip *)(void *)work);
  for (int i = 0; i < q->n && sides > 2; i++) mg_store_patch_friction(q, &pressure, i);
  return h.overflow ? -1 : sides;
}
