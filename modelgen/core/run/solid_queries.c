/* Public queries of how high points are over solids, without a run (mg_solid_heights). */
#include "run/run.h"
#include "solid/solid.h"

MG_API void mg_solid_heights(const mg_system *system, int solid, const mg_real *pose, int how, int n,
                             const mg_real *points, mg_real *heights) {
  for (int k = 0; k < n; k++) heights[k] = mg_height_over_solid(system, solid, pose, points + 3 * k, how);
}
