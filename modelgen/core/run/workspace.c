/* The scratch of one call, carved from the caller's memory. */
#include "run/run.h"
#include "base/base.h"
#include "solve/lcp/solvers.h"
#include "solve/friction/solvers.h"
#include "region/region.h"
#include "model/model.h"
#include "forces/forces.h"
#include "integrate/integrate.h"

static long mg_states(const mg_system *s) { return (long)s->n_q + s->n_u + s->n_eta + 1; }

/* Contacts, one to spare, rows of joints, rows below the normal ones. */
static long mg_rows_of(const mg_system *s) { return (long)s->n_contact + 1 + s->n_row + s->n_below; }

/* The most rows held at a time. */
static long mg_held_of(const mg_system *s) {
  const long below = MG_BELOW * (long)s->n_closed;
  return (long)s->n_closed + s->n_row + (below < s->n_below ? below : s->n_below);
}

/* The most strips of the boundary of a patch. */
static long mg_most_strips(const mg_system *s) {
  long most = 0;
  for (int p = 0; p < s->n_patch; p++) {
    const long room = mg_press_room(s->patch_arc[p + 1] - s->patch_arc[p], s->patch_arc_f[p] - s->patch_arc[p]);
    if (room > most) most = room;
  }
  return most;
}

/* What grips need: reals, ints. */
static long mg_grip_size(const mg_system *s) {
  if (!s->n_grip) return 0;
  const long k = s->n_slot ? mg_held_of(s) : 0;
  return k * k + 2 * k + mg_reals(s->n_slot, sizeof(mg_rub_state)) + mg_reals(mg_most_strips(s), sizeof(mg_strip)) + s->n_below + 2L * s->n_grip + MG_CONE * (long)s->n_closed + 6L * s->n_contact + 78 +
         mg_friction_work_size((int)mg_held_of(s), s->n_closed);
}

static long mg_grip_isize(const mg_system *s) {
  if (!s->n_grip) return 0;
  return 4L * s->n_grip + 4L * s->n_closed + mg_friction_iwork_size((int)mg_held_of(s), s->n_closed);
}

static long mg_onset_size(void) { return (long)(sizeof(mg_onset) / sizeof(mg_real)); }

/* The hull of any patch. */
static long mg_lay_size(const mg_system *s) {
  long most = 0;
  for (int p = 0; p < s->n_patch; p++) {
    const long room = mg_hull_room(s->patch_arc[p + 1] - s->patch_arc[p], s->patch_arc_f[p] - s->patch_arc[p]);
    if (room > most) most = room;
  }
  return most;
}

static long mg_sample_size(void) { return 2L * MG_SAMPLES * (long)(sizeof(mg_sample) / sizeof(mg_real)) + MG_SAMPLES; }

static long mg_table_size(const mg_system *s) { return s->n_table ? (long)MG_IN * s->table_first[s->n_table] : 0; }

MG_API long mg_work_size(const mg_system *s) {
  const long b = s->n_body, m = s->n_contact, r = mg_rows_of(s), k = mg_held_of(s), n = s->n_closed, x = mg_states(s);
  return 42 * b + 45 * r + 8 * m + 13L * s->n_row + s->n_joint + 4 * m + s->n_eta + k * k + 3 * k + n * n + n + mg_lcp_work_size((int)k) +
         mg_reals(mg_most_arcs(s), sizeof(mg_arc)) + mg_lay_size(s) + (MG_STAGES + 12) * x + 32 + 2 * s->n_eta + mg_sample_size() +
         mg_strain_size(s) + mg_table_size(s) + m * mg_onset_size() + mg_grip_size(s) + mg_instant_size(s);
}

MG_API long mg_iwork_size(const mg_system *s) {
  const long m = s->n_contact, r = mg_rows_of(s), k = mg_held_of(s);
  return 7 * m + 2L * s->n_slot + 10 * r + 2L * s->n_row + 4 + s->n_table + MG_SAMPLES + 2 * k + mg_lcp_iwork_size((int)k) + 3L * s->n_body + 1 +
         mg_grip_isize(s);
}

MG_API int mg_abi(void) { return MG_ABI; }

MG_API int mg_real_size(void) { return (int)sizeof(mg_real); }

static void mg_incidence(mg_context *c) {
  const mg_system *s = c->sys;
  int n = 0;
  for (int b = 0; b < s->n_body; b++) {
    c->first[b] = n;
    for (int i = 0; i < c->n_all && mg_moves(c, b); i++) {
      if (i == s->n_contact) continue;
      if (c->o[i] == b || c->f[i] == b) c->incident[n++] = i;
    }
  }
  c->first[s->n_body] = n;
}

static void mg_carve_grips(mg_context *c, mg_real *work, int *iwork) {
  const mg_system *s = c->sys;
  const long n = mg_held_of(s), k = s->n_closed;
  c->rub = mg_part_of_memory(&work, s->n_slot, sizeof(mg_rub_state));
  c->press_room = mg_most_strips(s), c->strips = mg_part_of_memory(&work, c->press_room, sizeof(mg_strip));
  for (int i = 0; i < s->n_slot; i++) c->rub[i].leans = c->rub[i].known = c->rub[i].fired = c->rub[i].stopped = c->rub[i].before = 0, c->rub[i].spread = 0;
  c->reduced = mg_take(&work, s->n_slot ? n * n + 2 * n : 0);
  c->lean = mg_take(&work, s->n_below), c->over = mg_take(&work, s->n_grip);
  c->steer = mg_take(&work, s->n_grip);
  mg_zero(c->over, s->n_grip);
  c->cone = mg_take(&work, MG_CONE * k), c->tangents = mg_take(&work, 6L * s->n_contact);
  c->block = mg_take(&work, 78), c->coulomb = mg_take(&work, mg_friction_work_size((int)n, (int)k));
  c->slipped = mg_take_int(&iwork, s->n_grip), c->before = mg_take_int(&iwork, s->n_grip);
  c->bound_of = mg_take_int(&iwork, s->n_grip), c->cone_contact = mg_take_int(&iwork, k);
  c->gives = mg_take_int(&iwork, s->n_grip);
  c->cone_first = mg_take_int(&iwork, k), c->cone_rows = mg_take_int(&iwork, k), c->marks = mg_take_int(&iwork, k);
  c->coulomb_i = mg_take_int(&iwork, mg_friction_iwork_size((int)n, (int)k));
}

static void mg_carve(mg_context *c, mg_real *work, int *iwork) {
  const mg_system *s = c->sys;
  const long b = s->n_body, m = s->n_contact, r = c->n_all, n = mg_held_of(s), k = s->n_closed, x = c->n_x;
  c->arc = mg_part_of_memory(&work, mg_most_arcs(s), sizeof(mg_arc)), c->lay = mg_take(&work, mg_lay_size(s)); /* pointers first */
  c->pose = mg_take(&work, 12 * b), c->twist = mg_take(&work, 6 * b);
  c->accel = mg_take(&work, 6 * b), c->wrench = mg_take(&work, 6 * b);
  c->J = mg_take(&work, 12 * r), c->MJ = mg_take(&work, 12 * r);
  c->d = mg_take(&work, r), c->gamma = mg_take(&work, r), c->d_dot = mg_take(&work, r), c->bias = mg_take(&work, r);
  c->normal = mg_take(&work, 3 * m), c->force = mg_take(&work, r), c->eta_dot = mg_take(&work, s->n_eta + m);
  c->A = mg_take(&work, n * n), c->b = mg_take(&work, n), c->z = mg_take(&work, n);
  c->lcp = mg_take(&work, mg_lcp_work_size((int)n));
  c->S = mg_take(&work, k * k), c->s = mg_take(&work, k), c->y = mg_take(&work, n);
  c->K = mg_take(&work, MG_STAGES * x), c->x_next = mg_take(&work, x), c->x_stage = mg_take(&work, x);
  c->settled = mg_take(&work, x), c->scale = mg_take(&work, x);
  c->dense = mg_take(&work, 8 * x), c->place = mg_take(&work, 32 + 2 * s->n_eta);
  c->rate = mg_take(&work, r), c->amount = mg_take(&work, r), c->MJ_before = mg_take(&work, 12L * s->n_row);
  c->part = mg_take(&work, s->n_row), c->most = mg_take(&work, s->n_joint), c->gap = mg_take(&work, 2 * m);
  c->sample = (mg_sample *)(void *)mg_take(&work, mg_sample_size() - MG_SAMPLES), c->merit = mg_take(&work, MG_SAMPLES);
  c->table = mg_take(&work, mg_table_size(s)), c->tabled = mg_take_int(&iwork, s->n_table);
  c->onset = (mg_onset *)(void *)mg_take(&work, m * mg_onset_size());
  c->mate = mg_take_int(&iwork, MG_SAMPLES), c->way = mg_take_int(&iwork, m), c->upright = mg_take_int(&iwork, m);
  c->n_eta = mg_take_int(&iwork, m);
  c->kind = mg_take_int(&iwork, r), c->parameters = mg_take_int(&iwork, m + 1);
  c->o = mg_take_int(&iwork, r), c->f = mg_take_int(&iwork, r);
  c->list = mg_take_int(&iwork, r), c->mask = mg_take_int(&iwork, r), c->bound = mg_take_int(&iwork, n);
  c->kept = mg_take_int(&iwork, s->n_row), c->free = mg_take_int(&iwork, s->n_row), c->fired = mg_take_int(&iwork, m);
  c->strain = mg_part_of_memory(&work, (MG_STRAINS + 1L) * mg_count_strains(s), sizeof(mg_strain));
  c->dips = mg_take_int(&iwork, m), c->hidden = mg_take_int(&iwork, m), c->near = mg_take_int(&iwork, m);
  c->trying = mg_take_int(&iwork, s->n_slot), c->barred = mg_take_int(&iwork, s->n_slot);
  c->lcp_i = mg_take_int(&iwork, mg_lcp_iwork_size((int)n));
  c->column = mg_take_int(&iwork, r), c->next = mg_take_int(&iwork, r), c->island = mg_take_int(&iwork, n);
  c->parent = mg_take_int(&iwork, b), c->head = mg_take_int(&iwork, b);
  c->first = mg_take_int(&iwork, b + 1), c->incident = mg_take_int(&iwork, 2 * r);
  c->vault.column = mg_take(&work, 12 * r), c->vault.rate = mg_take(&work, r), c->vault.impulse = mg_take(&work, r);
  c->vault.point = mg_take(&work, 3 * m), c->vault.landed = mg_take(&work, 3 * m);
  c->vault.free = mg_take(&work, 6 * b), c->vault.gained = mg_take(&work, 6 * b);
  c->n_timed = mg_count_timed(s), c->instant = mg_take(&work, mg_instant_size(s));
  c->tangents = c->block = 0;
  if (s->n_grip) mg_carve_grips(c, work, iwork);
}

/* Poses that never change are written once: fixed bodies whole, point bodies their identity rotation. */
static void mg_set_fixed(mg_context *c) {
  const mg_system *s = c->sys;
  c->driven = c->moving = 0;
  for (int b = 0; b < s->n_body; b++) {
    const int motion = c->kernels->body_kinds[mg_kind_of(c, b)].motion;
    mg_real *pose = c->pose + 12 * b;
    c->driven += motion == MG_DRIVEN, c->moving += motion >= MG_POINT;
    if (motion == MG_FIXED)
      for (int i = 0; i < 12; i++) pose[i] = s->parameters[s->body_parameters[b] + i];
    if (motion == MG_POINT) pose[3] = pose[7] = pose[11] = 1;
  }
}

MG_INTERNAL void mg_open(mg_context *c, const mg_system *sys, const mg_settings *set, mg_run *run, mg_real *work,
                    int *iwork) {
  c->sys = sys, c->kernels = sys->kernels, c->set = set, c->run = run;
  c->n_x = (int)mg_states(sys), c->work_index = c->n_x - 1, c->suspect = 0, c->laid = -1;
  c->first_pad = sys->n_contact - 3 * sys->n_slot, c->first_pad_link = sys->n_link - 3 * sys->n_patch;
  c->bilateral = sys->n_contact + 1, c->n_all = (int)mg_rows_of(sys);
  c->below = c->n_rows = c->bilateral + sys->n_row, c->leaning = c->steering = 0;
  mg_carve(c, work, iwork);
  for (int i = 0; i < c->n_x; i++) c->scale[i] = sys->scale[i];
  mg_zero(c->pose, 30L * sys->n_body);
  mg_zero(c->J, 24L * c->n_all); /* J and MJ: the columns a kind lacks stay zero */
  mg_zero(c->force, c->n_all);
  mg_zero(c->bias, c->n_all);
  mg_zero(c->d + c->below, sys->n_below);
  c->n_live = c->n_x - sys->n_eta, c->left.count = 0;
  c->n_felt = mg_count_felt(sys, 0), c->n_still = c->n_felt - mg_count_felt(sys, 1);
  for (int i = 0; i < sys->n_contact; i++) c->column[i] = -1, c->n_eta[i] = c->upright[i] = 0, mg_take_link(c, i);
  for (int slot = 0; slot < sys->n_slot; slot++) c->barred[slot] = -1, c->trying[slot] = 0;
  for (int table = 0; table < sys->n_table; table++) c->tabled[table] = 0;
  mg_open_joints(c);
  mg_incidence(c);
  mg_set_fixed(c);
}
