/* What the sensors of a scene show at the state of a run (mg_sense). Writes nothing of the run but its forces. */
#include "run/run.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/integrate.h"
#include "timestep/timestep.h"

/* Least gap and sum of the normal forces of each pair of shapes, its resting faces included. */
static void mg_sum_pairs(mg_context *c) {
  const mg_system *s = c->system;
  mg_real centre[3];
  for (int pair = 0; pair < s->n_pair; pair++) c->sensors.pair[2 * pair] = MG_MAX, c->sensors.pair[2 * pair + 1] = 0;
  for (int pair = mg_next_pair(c, -1); pair < s->n_pair; pair = mg_next_pair(c, pair)) {
    mg_real *shown = c->sensors.pair + 2 * pair;
    for (int i = s->pair_contact[pair]; i < s->pair_contact[pair + 1]; i++) {
      if (!mg_is_on_feature_pair(c, i)) continue;
      shown[0] = fmin(shown[0], c->rows.d[i]), shown[1] += c->run->force[i];
    }
  }
  for (int slot = 0; slot < s->n_patch_slot; slot++) {
    if (mg_patch_of_slot(c, slot) < 0) continue;
    mg_real *shown = c->sensors.pair + 2 * s->patch_pair[mg_patch_of_slot(c, slot)];
    shown[0] = fmin(shown[0], c->rows.d[mg_first_support(c, slot)]);
    shown[1] += mg_support_resultant(c, slot, c->run->force, centre);
  }
  for (int pair = 0; pair < s->n_pair; pair++)
    if (c->sensors.pair[2 * pair] == MG_MAX) c->sensors.pair[2 * pair] = (mg_real)NAN;
}

MG_API void mg_sense(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real *sensors, mg_real *work,
                     int *iwork) {
  mg_context c;
  mg_run copy = *run;
  mg_open_context(&c, system, settings, &copy, work, iwork);
  const int located = !mg_is_time_stepping(&c);
  if (!c.kernels->sensors_need_forces) mg_update_poses(&c, run->t, run->x);
  else if (located) mg_evaluate_run_state(&c);
  else mg_update_rows_at(&c, run->t, run->x);
  if (c.kernels->sensors_need_forces) mg_sum_pairs(&c);
  for (int j = 0; j < system->n_joint && c.kernels->sensors_need_forces; j++) {
    if (located) mg_joint_wrench(&c, j, c.sensors.joint + 6 * j);
    else
      for (int k = 0; k < 6; k++) c.sensors.joint[6 * j + k] = (mg_real)NAN;
  }
  c.kernels->sense(0, &run->t, c.bodies.pose, c.bodies.twist, c.sensors.pair, c.sensors.joint,
                   system->parameters + system->sensor_parameters, run->applied_input, sensors);
}

MG_API void mg_sense_many(int n, const mg_system *const *systems, const mg_settings *settings, mg_run *runs,
                          mg_real *sensors, mg_real *work, int *iwork) {
  for (int i = 0; i < n; i++)
    mg_sense(systems[i], settings, runs + i, sensors + (long)i * systems[i]->kernels->n_sensor, work, iwork);
}
