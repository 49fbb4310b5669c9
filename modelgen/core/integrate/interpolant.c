/* States on the interpolant of a step, of whatever method (Hairer, Norsett and Wanner, Solving Ordinary Differential
   Equations I, 1993, section II.6). Reads c->step. */
#include "integrate/integrate.h"
#include "model/model.h"

MG_INTERNAL void mg_interpolate(const mg_context *c, const mg_real *x, mg_real theta, mg_real *out) {
  const int n = c->layout.n_states;
  for (int range = 0; range < c->listed.n_range; range++)
    for (int i = mg_range_begin(c, range); i < mg_range_end(c, range); i++) {
      mg_real y = 0;
      for (int row = 6; row >= 0; row--) y = (y + c->step.interpolant[row * n + i]) * (row % 2 ? 1 - theta : theta);
      out[i] = x[i] + y;
    }
}
