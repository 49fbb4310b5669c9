/* Public queries of solids, without a run: how high points are over one (mg_solid_heights), and whether two have a
   point in common (mg_solids_overlap). */
#include "run/run.h"
#include "solid/solid.h"

MG_API void mg_solid_heights(const mg_system *system, int solid, const mg_real *pose, int how, int n,
                             const mg_real *points, mg_real *heights) {
  for (int k = 0; k < n; k++) heights[k] = mg_height_over_solid(system, solid, pose, points + 3 * k, how);
}

MG_API int mg_solids_overlap(const mg_system *system, const int *solid, const mg_real *pose, const mg_real *ball,
                             mg_real deep, mg_real *slack) {
  const mg_both_solids both = {system, {solid[0], solid[1]}, {pose, pose + 12}};
  mg_common_point found;
  const int is_found = mg_find_common_point(&both, ball, ball[3], deep, deep / sqrt((mg_real)3), &found);
  *slack = is_found ? 0 : found.slack;
  return is_found;
}
