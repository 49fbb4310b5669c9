/* Cotangents of a run (mg_go_back): the steps of a tape in reverse order. Each step is taken again, from the copy of
   the run before it. Writes the mg_adjoint. */
#include "run/run.h"
#include "base/base.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/integrate.h"
#include "sensitivity/sensitivity.h"

static void mg_open_adjoint(const mg_context *c, mg_sensitivity *s, const mg_directions *none, mg_tangent *nothing,
                            mg_adjoint *adjoint) {
  s->directions = none, s->tangent = nothing, s->adjoint = adjoint;
  mg_open_sensitivity(c, s, 0, adjoint->work, adjoint->iwork);
}

/* Over one step. `bytes`: the run before it; those after it follow. */
static void mg_go_back_over_step(const mg_system *system, const mg_settings *settings, mg_run *run, mg_sensitivity *s,
                                 const unsigned char *bytes, const mg_real *slopes, const int *known, mg_real *work,
                                 int *iwork) {
  mg_context c;
  s->n_crossing = *known++;
  for (int k = 0; k < s->n_crossing; k++, known += MG_NUMBERS_OF_CROSSING)
    s->crossings[k] = (mg_crossing){known[0], known[1], known[2], known[3], known[4], known[5]};
  const unsigned char *after = bytes + mg_save_size(system);
  mg_restore_run(system, run, after);
  const mg_real t = run->t, roundoff = run->t_roundoff;
  mg_restore_run(system, run, bytes);
  const mg_real h = t - run->t + (roundoff - run->t_roundoff), end = run->t + h; /* of the step that is taken again */
  mg_open_context(&c, system, settings, run, work, iwork);
  mg_restore_step(&c, s, h, slopes);
  mg_mark_held_contacts(&c, s, 0);
  if (!s->n_crossing) mg_project_adjoint(&c, s, end, c.step.end, s->adjoint->x);
  else {
    mg_real weight[MG_CROSSINGS];
    mg_find_event_islands(&c, s);
    for (int k = 0; k < s->n_crossing; k++) mg_choose_crossing(s, k), mg_differentiate_event(&c, s, &s->crossing, end);
    mg_copy_states(&c, c.step.end, s->before);
    for (int i = 0; i < system->n_contact; i++) s->closed_before[i] = run->closed[i];
    mg_restore_run(system, run, after);
    mg_open_context(&c, system, settings, run, work, iwork);
    mg_after_event_adjoint(&c, s, s->adjoint->x);
    for (int k = s->n_crossing - 1; k >= 0; k--) {
      mg_choose_crossing(s, k);
      MG_NOTE_EVENT(&c, s, s->crossing.kind, s->crossing.contact, s->before);
      weight[k] = mg_event_adjoint(&c, s, &s->crossing, s->event_rate[0], s->adjoint->x);
    }
    mg_restore_run(system, run, bytes);
    mg_open_context(&c, system, settings, run, work, iwork);
    mg_restore_step(&c, s, h, slopes);
    for (int k = 0; k < s->n_crossing; k++) {
      mg_choose_crossing(s, k);
      if (weight[k] != 0) mg_event_function_adjoint(&c, s, &s->crossing, end, weight[k], s->adjoint->x);
    }
  }
  mg_step_adjoint(&c, s, h, s->adjoint->x);
}

/* Sets all cotangents to NaN. */
static void mg_lose_cotangents(const mg_context *c, mg_adjoint *adjoint) {
  const mg_system *s = c->system;
  const struct {
    mg_real *to;
    long n;
  } all[] = {{adjoint->x, c->layout.n_states},
             {adjoint->parameters, s->n_parameters},
             {adjoint->gravity, 3},
             {adjoint->restitution, s->n_contact},
             {adjoint->friction_static, 2L * s->n_friction},
             {adjoint->friction_kinetic, 2L * s->n_friction},
             {adjoint->patch_friction, 2L * s->n_patch},
             {adjoint->input, 3L * s->n_input}};
  for (int k = 0; k < (int)(sizeof(all) / sizeof(all[0])); k++)
    for (long i = 0; i < all[k].n; i++) all[k].to[i] = (mg_real)NAN;
}

MG_API void mg_go_back(const mg_system *system, const mg_settings *settings, mg_run *run, const mg_tape *tape,
                       long from, long to, mg_adjoint *adjoint, mg_real *work, int *iwork) {
  mg_context c;
  mg_sensitivity s;
  const mg_directions none = {0};
  mg_tangent nothing = {0};
  mg_open_context(&c, system, settings, run, work, iwork);
  mg_open_adjoint(&c, &s, &none, &nothing, adjoint);
  if (tape->lost) mg_lose_cotangents(&c, adjoint);
  for (long k = from - 1; k >= to && !tape->lost && !mg_is_stopped(&c); k--)
    mg_go_back_over_step(system, settings, run, &s, tape->bytes + k * mg_save_size(system),
                         tape->slopes + k * MG_SLOPES_KEPT * c.layout.n_states, tape->crossing + MG_TAPE_CROSSING * k,
                         work, iwork);
  if (mg_is_stopped(&c)) mg_lose_cotangents(&c, adjoint);
  mg_restore_run(system, run, tape->bytes + to * mg_save_size(system));
}

MG_API void mg_go_back_to_start(const mg_system *system, const mg_settings *settings, mg_run *run, mg_adjoint *adjoint,
                                mg_real *work, int *iwork) {
  mg_context c;
  mg_sensitivity s;
  const mg_directions none = {0};
  mg_tangent nothing = {0};
  mg_open_context(&c, system, settings, run, work, iwork);
  mg_open_adjoint(&c, &s, &none, &nothing, adjoint);
  if (isnan(adjoint->x[0])) return; /* they are lost */
  mg_evaluate_run_state(&c);
  mg_start_adjoint(&c, &s, adjoint->given, adjoint->x);
  mg_normalise_tangent(&c, run->x, adjoint->x);
}

/* From the cotangents of gap and force of each pair and of the wrench of each joint to those of rows and joints. */
static void mg_sensed_forces_adjoint(mg_context *c, mg_sensitivity *s) {
  const mg_system *system = c->system;
  for (int p = mg_next_pair(c, -1); p < system->n_pair; p = mg_next_pair(c, p)) {
    int nearest = -1;
    for (int i = system->pair_contact[p]; i < system->pair_contact[p + 1]; i++) {
      if (!mg_is_on_feature_pair(c, i)) continue;
      if (nearest < 0 || c->rows.d[i] < c->rows.d[nearest]) nearest = i;
      if (c->run->active[i]) s->at.force[i] += s->pair[2 * p + 1];
    }
    if (nearest >= 0) s->at.value[nearest] += s->pair[2 * p];
  }
  for (int slot = 0; slot < system->n_patch_slot; slot++) {
    const int patch = mg_patch_of_slot(c, slot), support = mg_first_support(c, slot);
    if (patch < 0) continue;
    const int first = system->patch_share[patch], end = system->patch_share[patch + 1];
    if (first == end)
      for (int i = support; i < support + 3; i++) s->at.force[i] += s->pair[2 * system->patch_pair[patch] + 1];
    const int is_fixed = first < end && mg_find_patch_shares(c, slot, c->solution.force) == MG_SHARES_FIXED;
    for (int k = first; k < end; k++) {
      const mg_real bar = s->pair[2 * system->share_pair[k] + 1], *weight = c->patches.share.weight + 3 * (k - first);
      for (int i = 0; i < 3 && bar != 0; i++) s->at.force[support + i] += is_fixed ? weight[i] * bar : (mg_real)NAN;
    }
  }
  for (int j = 0; j < system->n_joint; j++) {
    const int rows = mg_held_joint_rows(c, j), first = c->layout.joint_row_begin + system->joint_row[j];
    mg_real force[MG_ROWS_OF_ONE] = {0};
    if (!rows) continue;
    mg_copy_reals(force, c->solution.force + first, rows);
    mg_zero_reals(s->y_dot, MG_Y_VALUE + MG_ROWS_OF_ONE);
    for (int k = 0; k < 6; k++) {
      s->y_dot[MG_Y_SECOND + k] = s->joint[6 * j + k];
      for (int r = first; r < first + rows; r++) s->at.force[r] += c->rows.J[12 * r + 6 + k] * s->joint[6 * j + k];
    }
    mg_joint_adjoint(c, s, j, c->run->t, force, 0);
  }
}

MG_API void mg_sense_adjoint(const mg_system *system, const mg_settings *settings, mg_run *run,
                             const mg_real *sensors_bar, mg_adjoint *adjoint, mg_real *work, int *iwork) {
  mg_context c;
  mg_sensitivity s;
  const mg_directions none = {0};
  mg_tangent nothing = {0};
  mg_run copy = *run;
  mg_open_context(&c, system, settings, &copy, work, iwork);
  mg_open_adjoint(&c, &s, &none, &nothing, adjoint);
  mg_evaluate_run_state(&c);
  mg_gather_wrenches(&c, &s, run->t);
  mg_read_sensors(&c, run->t, run->x + system->n_q + system->n_u, run->force, 1, s.y_dot);
  mg_clear_cotangents(&c, &s);
  mg_sensors_adjoint(&c, &s, run->t, sensors_bar);
  mg_sensed_forces_adjoint(&c, &s);
  mg_zero_reals(s.stage, c.layout.n_states);
  mg_rhs_adjoint(&c, &s, run->t, run->x, s.stage, adjoint->x);
}
