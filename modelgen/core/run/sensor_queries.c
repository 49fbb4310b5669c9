/* What the sensors of a scene show at the state of a run (mg_sense). Writes nothing of the run but its forces. */
#include "run/run.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/integrate.h"
#include "timestep/timestep.h"

MG_API void mg_sense(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real *sensors, mg_real *work,
                     int *iwork) {
  mg_context c;
  mg_run copy = *run;
  mg_open_context(&c, system, settings, &copy, work, iwork);
  const int solved = c.kernels->sensors_need_forces && !mg_is_time_stepping(&c);
  if (solved) mg_evaluate_run_state(&c);
  else mg_update_poses(&c, run->t, run->x);
  mg_read_sensors(&c, run->t, run->x + system->n_q + system->n_u, run->force, solved, sensors);
}

MG_API void mg_sense_many(int n, int *taken, const mg_system *const *systems, const mg_settings *const *settings,
                          mg_run *runs, mg_real *sensors, mg_real *work, int *iwork) {
  for (int count, end; (count = mg_take_lanes(n, taken, &end));)
    for (int i = end - count; i < end; i++)
      mg_sense(systems[i], settings[i], runs + i, sensors + (long)i * systems[i]->kernels->n_sensor, work, iwork);
}
