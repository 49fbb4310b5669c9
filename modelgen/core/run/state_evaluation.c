/* Public queries of a state, without a run: right-hand side, poses, closest points of one contact, ranks of
   joints. */
#include "run/run.h"
#include "model/model.h"
#include "forces/forces.h"

MG_API int mg_settle(const mg_system *system, const mg_settings *settings, const mg_run *run, int contact, mg_real *eta,
                     mg_real *d, mg_real *residual, mg_real *margin, mg_real *normal, mg_real *point_o,
                     mg_real *point_f, mg_real *work, int *iwork) {
  mg_context c;
  mg_run copy = *run;
  mg_open_context(&c, system, settings, &copy, work, iwork);
  mg_update_poses(&c, run->t, run->x);
  const int steps = mg_newton_on_feature_pair(&c, contact, eta);
  *d = c.search.placement[0], residual[0] = c.search.placement[1], residual[1] = c.search.placement[2],
  margin[0] = c.search.placement[3], margin[1] = c.search.placement[4];
  for (int k = 0; k < 3; k++)
    normal[k] = c.search.placement[5 + k], point_o[k] = c.search.placement[8 + k],
    point_f[k] = c.search.placement[11 + k];
  return steps;
}

MG_API void mg_pose_all(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real *pose, mg_real *work,
                        int *iwork) {
  mg_context c;
  mg_open_context(&c, system, settings, run, work, iwork);
  mg_update_poses(&c, run->t, run->x);
  for (int i = 0; i < 12 * system->n_body; i++) pose[i] = c.bodies.pose[i];
}

MG_API void mg_evaluate(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real t, const mg_real *x,
                        mg_real *x_dot, mg_real *work, int *iwork) {
  mg_context c;
  mg_open_context(&c, system, settings, run, work, iwork);
  c.switches.is_literal = !mg_slides(&c);
  mg_right_hand_side(&c, t, x, x_dot);
  for (int i = 0; i < system->n_contact; i++) run->force[i] = c.solution.force[i];
}

MG_API void mg_joint_ranks(const mg_system *system, const mg_settings *settings, mg_run *run, int *rank, mg_real *work,
                           int *iwork) {
  mg_context c;
  mg_open_context(&c, system, settings, run, work, iwork);
  mg_update_poses(&c, run->t, run->x);
  mg_update_joint_rows(&c, run->t);
  for (int j = 0; j < system->n_joint; j++) rank[j] = 0;
  mg_rank_joints(&c, rank);
}
