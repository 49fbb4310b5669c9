/* RK4 steps of fixed length without events, as a public function. Writes time and state of the run. */
#include "run/run.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/integrate.h"

MG_API void mg_smooth(const mg_system *system, const mg_settings *settings, mg_run *run, long n, mg_real *work,
                      int *iwork) {
  mg_context c;
  mg_open_context(&c, system, settings, run, work, iwork);
  c.switches.is_literal = 1;
  const int is_composed = mg_is_in_mode_of_scene_rhs(&c);
  for (long step = 0; step < n; step++) {
    if (is_composed) mg_scene_rk4(&c, run->t, run->x, settings->step, 0, run->x);
    else {
      mg_right_hand_side(&c, run->t, run->x, c.step.slopes);
      mg_rk4(&c, run->t, run->x, settings->step);
      mg_copy_states(&c, c.step.end, run->x);
    }
    mg_advance_time(run, settings->step);
  }
  run->steps += n;
}
