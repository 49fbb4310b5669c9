/* Whether two solids have a point in common that is deep enough in both: a bounded search of the ball around one of
   them, by heights of slope 1 at most. A cell in whose middle the height is above what its half diagonal may lower has
   no such point, and its excess bounds how far the solids can move before it has one. Of the cells that are left the
   lowest MG_COMMON_CELLS are divided at a time. */
#include "solid/solid.h"
#include "base/base.h"

#define MG_FIRST_CELLS 4    /* along each side of the cube that is searched */
#define MG_COMMON_CELLS 128 /* most cells that are divided at a time */

/* Cells that may hold a common point: centres and heights, the lowest ones. */
typedef struct {
  int count;
  mg_real centre[3 * MG_COMMON_CELLS], height[MG_COMMON_CELLS];
} mg_common_cells;

MG_INTERNAL mg_real mg_height_over_both(const mg_both_solids *both, const mg_real *x, int how) {
  mg_real height = -MG_MAX;
  for (int side = 0; side < 2; side++)
    if (both->solid[side] >= 0)
      height = mg_max(height, mg_height_over_solid(both->system, both->solid[side], both->pose[side], x, how));
  return height;
}

/* Adds a cell; where there is no room, the highest one is left out. Returns 0 then. */
static int mg_add_common_cell(mg_common_cells *cells, const mg_real *centre, mg_real height) {
  const int is_full = cells->count == MG_COMMON_CELLS;
  int at = cells->count;
  if (is_full) {
    at = 0;
    for (int k = 1; k < MG_COMMON_CELLS; k++)
      if (cells->height[k] > cells->height[at]) at = k;
    if (!(height < cells->height[at])) return 0;
  } else cells->count++;
  for (int k = 0; k < 3; k++) cells->centre[3 * at + k] = centre[k];
  cells->height[at] = height;
  return !is_full;
}

MG_INTERNAL int mg_find_common_point(const mg_both_solids *both, const mg_real *centre, mg_real radius, mg_real deep,
                                     mg_real smallest, mg_common_point *found) {
  const mg_real root = sqrt((mg_real)3);
  mg_common_cells old, cells;
  mg_real lowest = MG_MAX;
  found->half = radius, found->is_undecided = 0;
  found->slack = mg_height_over_both(both, centre, MG_LIPSCHITZ) - radius + deep;
  if (found->slack >= 0) return 0;
  found->slack = MG_MAX, old.count = 0;
  mg_add_common_cell(&old, centre, 0);
  for (int parts = MG_FIRST_CELLS; old.count && found->half > smallest; parts = 2, old = cells) {
    const mg_real half = found->half /= parts;
    cells.count = 0;
    for (int each = 0; each < old.count; each++)
      for (int part = 0; part < parts * parts * parts; part++) {
        const int place[3] = {part % parts, part / parts % parts, part / (parts * parts)};
        mg_real x[3];
        for (int k = 0; k < 3; k++) x[k] = old.centre[3 * each + k] + half * (2 * place[k] + 1 - parts);
        const mg_real height = mg_height_over_both(both, x, MG_LIPSCHITZ), above = height - root * half + deep;
        if (height < lowest) lowest = height, mg_copy_reals(found->lowest, x, 3);
        if (height < -deep) return 1;
        if (!(above < 0)) found->slack = mg_min(found->slack, above);
        else if (!mg_add_common_cell(&cells, x, height)) found->slack = 0;
      }
  }
  found->is_undecided = old.count > 0;
  if (found->is_undecided) found->slack = 0;
  return 0;
}
