/* The context of one call, and the division of its scratch memory into the arrays of mg_context. The same function
   divides the memory and counts it. */
#include <string.h>

#include "run/run.h"
#include "base/base.h"
#include "solve/lcp/lcp_solvers.h"
#include "solve/friction/friction_solvers.h"
#include "region/region.h"
#include "model/model.h"
#include "closest/closest.h"
#include "forces/forces.h"
#include "integrate/integrate.h"

/* What is left of the scratch memory of the caller. Null pointers: what would be reserved is counted. */
typedef struct {
  mg_real *reals;
  int *ints;
  long long n_reals, n_ints;
} mg_memory;

/* Reserves n mg_real; returns where they begin, 0 where memory is only counted. */
static mg_real *mg_reserve_reals(mg_memory *memory, long long n) {
  if (memory->reals) return mg_take_reals(&memory->reals, n);
  memory->n_reals += n;
  return 0;
}

/* The same of n int. */
static int *mg_reserve_ints(mg_memory *memory, long long n) {
  if (memory->ints) return mg_take_ints(&memory->ints, n);
  memory->n_ints += n;
  return 0;
}

/* The same of n items of `size` bytes, aligned for all types of the core. */
static void *mg_reserve_items(mg_memory *memory, long n, size_t size) {
  mg_real *at = mg_reserve_reals(memory, mg_count_reals(n, size));
  return at ? mg_take_memory(&at, n, size) : 0;
}

/* Length of the state x. */
static long mg_state_count(const mg_system *s) { return (long)s->n_q + s->n_u + s->n_eta + 1; }

/* Rows of all constraints: contacts, the probe, joint rows, friction rows, springs. */
static long mg_row_count(const mg_system *s) {
  return (long)s->n_contact + 1 + s->n_joint_row + s->n_friction_row + mg_spring_count(s);
}

/* Most rows that one problem may have. */
static long mg_held_row_capacity(const mg_system *s) {
  const long below = MG_FRICTION_ROWS_MAX * (long)s->closed_capacity;
  return (long)s->closed_capacity + s->n_joint_row + (below < s->n_friction_row ? below : s->n_friction_row) +
         mg_spring_count(s);
}

/* Largest strip capacity of a patch. */
static long mg_strip_capacity_max(const mg_system *s) {
  long most = 0;
  for (int p = 0; p < s->n_patch; p++) {
    const long capacity = mg_strip_capacity(s->patch_arc[p + 1] - s->patch_arc[p], s->patch_arc_f[p] - s->patch_arc[p]);
    if (capacity > most) most = capacity;
  }
  return most;
}

/* Size of an mg_rolling_start, in mg_real. */
static long mg_rolling_start_size(void) { return (long)(sizeof(mg_rolling_start) / sizeof(mg_real)); }

/* Largest memory of the hull of a patch, in mg_real. */
static long mg_hull_memory_max(const mg_system *s) {
  long most = 0;
  for (int p = 0; p < s->n_patch; p++) {
    const long size = mg_hull_memory_size(s->patch_arc[p + 1] - s->patch_arc[p], s->patch_arc_f[p] - s->patch_arc[p]);
    if (size > most) most = size;
  }
  return most;
}

/* Most Taylor models that the bounds of a shape need as memory. */
static long mg_bounds_memory_max(const mg_system *s) {
  int most = 0;
  for (int tree = 0; tree < s->n_cell_tree; tree++) {
    const int size = s->kernels->shape_bounds[s->tree_shape[tree]].n_memory;
    if (size > most) most = size;
  }
  return most;
}

MG_API mg_digest mg_shapes_digest(const mg_system *system) { return mg_digest_searched_shapes(system); }

MG_API int mg_abi(void) { return MG_ABI; }

MG_API int mg_real_size(void) { return (int)sizeof(mg_real); }

/* Divides the memory of the solvers of friction problems, which use the same one after another. */
static void mg_set_friction_solver_arrays(mg_context *c, mg_memory *memory) {
  const mg_system *s = c->system;
  const int n = (int)mg_held_row_capacity(s), k = s->closed_capacity;
  const long long reals[] = {mg_friction_work_size(n, k), mg_friction_graph_work_size(n, k, s->n_body)},
                  ints[] = {mg_friction_iwork_size(n, k), mg_friction_graph_iwork_size(n, k, s->n_body)};
  c->friction.work = mg_reserve_reals(memory, reals[1] > reals[0] ? reals[1] : reals[0]);
  c->friction.iwork = mg_reserve_ints(memory, ints[1] > ints[0] ? ints[1] : ints[0]);
  c->friction.row_yield = mg_reserve_reals(memory, n), c->friction.row_body = mg_reserve_ints(memory, 2 * n);
}

/* Divides the memory of the friction constraints. */
static void mg_set_friction_arrays(mg_context *c, mg_memory *memory) {
  const mg_system *s = c->system;
  const long long n = mg_held_row_capacity(s), k = s->closed_capacity;
  c->patches.friction = mg_reserve_items(memory, s->n_patch_slot, sizeof(mg_patch_friction));
  c->patches.strip_capacity = mg_strip_capacity_max(s),
  c->patches.strips = mg_reserve_items(memory, c->patches.strip_capacity, sizeof(mg_boundary_strip));
  c->patches.reduced_problem = mg_reserve_reals(memory, s->n_patch_slot ? n * n + 2 * n : 0);
  c->friction.force_ratio = mg_reserve_reals(memory, s->n_friction_row),
  c->friction.slip_time_left = mg_reserve_reals(memory, s->n_friction);
  c->friction.slip_angle = mg_reserve_reals(memory, s->n_friction);
  c->step.angle_slopes = mg_reserve_reals(memory, (long)MG_RADAU_STAGES * MG_SLIP_UNKNOWNS * s->n_u);
  c->friction.cone = mg_reserve_reals(memory, MG_CONE * k), c->friction.share = mg_reserve_reals(memory, k);
  c->rows.tangents = mg_reserve_reals(memory, 6L * s->n_contact);
  c->rows.kernel_rows = mg_reserve_reals(memory, 78);
  mg_set_friction_solver_arrays(c, memory);
  c->friction.triggered = mg_reserve_ints(memory, s->n_friction),
  c->friction.mode_before = mg_reserve_ints(memory, s->n_friction);
  c->friction.bound = mg_reserve_ints(memory, s->n_friction), c->friction.cone_contact = mg_reserve_ints(memory, k);
  c->friction.is_yielding = mg_reserve_ints(memory, s->n_friction);
  c->friction.is_stiff = mg_reserve_ints(memory, s->n_friction);
  c->friction.cone_first = mg_reserve_ints(memory, k), c->friction.cone_rows = mg_reserve_ints(memory, k),
  c->friction.marks = mg_reserve_ints(memory, k);
}

/* Divides the memory of the lists of what takes part. */
static void mg_set_listing_arrays(mg_context *c, mg_memory *memory) {
  const mg_system *s = c->system;
  mg_listing *l = &c->listed;
  l->balls = mg_reserve_items(memory, s->n_ball, sizeof(mg_grid_ball));
  l->row = mg_reserve_ints(memory, mg_row_count(s) + 1L), l->constraint = mg_reserve_ints(memory, s->n_friction + 1L);
  l->pair = mg_reserve_ints(memory, s->n_pair + 1L), l->range = mg_reserve_ints(memory, 2L * s->n_contact + 6);
  l->over_plane = mg_reserve_ints(memory, s->n_pair), l->patch = mg_reserve_ints(memory, s->n_patch + 1L);
  l->always = mg_reserve_ints(memory, s->n_pair), l->listed = mg_reserve_ints(memory, s->n_pair);
  l->found = mg_reserve_ints(memory, s->n_pair), l->grid = mg_reserve_ints(memory, mg_grid_size(s));
  l->slots.of_ball = mg_reserve_ints(memory, s->n_pool ? s->n_ball : 0),
  l->slots.next = mg_reserve_ints(memory, mg_slot_count(s)), l->slots.next_free = mg_reserve_ints(memory, s->n_pool);
}

/* Takes the memory of the cells, at the same place for all systems that may keep each other's cells. */
static void mg_set_cell_arrays(mg_context *c, mg_memory *memory) {
  const mg_system *s = c->system;
  c->search.cells_digest = mg_reserve_items(memory, 1, sizeof(mg_digest));
  c->search.cells = mg_reserve_items(memory, s->n_cell, sizeof(mg_cell));
  c->search.tree_bound = mg_reserve_items(memory, 2L * s->n_cell_tree, sizeof(mg_real)); /* pointers follow */
  c->search.n_cells = mg_reserve_ints(memory, 1);
  c->search.tree_root = mg_reserve_ints(memory, 2L * s->n_cell_tree);
}

/* The same of the shares of pairs in patches of several. */
static void mg_set_share_arrays(mg_context *c, mg_memory *memory) {
  mg_share_workspace *w = &c->patches.share;
  const mg_share_room room = mg_find_share_room(c->system);
  w->arcs = mg_reserve_items(memory, room.arcs, sizeof(mg_arc));
  w->hull_memory = mg_reserve_reals(memory, room.hull); /* pointers first */
  w->strips = mg_reserve_items(memory, room.strips, sizeof(mg_boundary_strip)), w->strip_capacity = room.strips;
  w->weight = mg_reserve_reals(memory, 3L * room.shares);
}

/* The same of the switching functions of loads. */
static void mg_set_switch_arrays(mg_context *c, mg_memory *memory) {
  const long n = c->system->n_switch;
  c->switches.value = mg_reserve_reals(memory, n), c->switches.rate = mg_reserve_reals(memory, n);
  c->switches.size = mg_reserve_reals(memory, n), c->switches.slack = mg_reserve_reals(memory, n);
  c->switches.noise = mg_reserve_reals(memory, n), c->switches.second = mg_reserve_reals(memory, 2 * n);
  c->switches.slope = mg_reserve_reals(memory, MG_SWITCH_COLUMNS * n);
  c->switches.gradient = mg_reserve_reals(memory, mg_switch_gradient_size(c->system));
  c->switches.input_gradient = mg_reserve_reals(memory, 3L * c->system->n_input * n);
  c->switches.triggered = mg_reserve_ints(memory, n), c->switches.is_at_zero = mg_reserve_ints(memory, n);
  c->switches.mode_before = mg_reserve_ints(memory, n), c->switches.repels = mg_reserve_ints(memory, n);
  c->switches.shares = mg_reserve_ints(memory, n);
}

/* First of the pairs of limits, which have no shapes. */
static int mg_first_limit_pair(const mg_system *s) {
  int pair = s->n_pair;
  while (pair > 0 && s->feature_shape[2 * s->pair_feature_pair[pair - 1]] < 0) pair--;
  return pair;
}

/* Divides the memory. */
static void mg_set_arrays(mg_context *c, mg_memory *memory) {
  const mg_system *s = c->system;
  const long long b = s->n_body, m = s->n_contact, r = mg_row_count(s), n = mg_held_row_capacity(s),
                  k = s->closed_capacity, x = mg_state_count(s);
  mg_set_cell_arrays(c, memory);
  c->patches.arcs = mg_reserve_items(memory, mg_max_patch_arcs(s), sizeof(mg_arc)),
  c->patches.hull_memory = mg_reserve_reals(memory, mg_hull_memory_max(s)); /* pointers first */
  mg_set_share_arrays(c, memory);
  mg_set_listing_arrays(c, memory);
  c->contacts.length = mg_reserve_reals(memory, m + 1);
  c->bodies.quaternion = mg_reserve_reals(memory, 4 * b);
  c->bodies.pose = mg_reserve_reals(memory, 12 * b), c->bodies.twist = mg_reserve_reals(memory, 6 * b);
  c->bodies.acceleration = mg_reserve_reals(memory, 6 * b), c->bodies.wrench = mg_reserve_reals(memory, 6 * b);
  c->rows.J = mg_reserve_reals(memory, 12 * r), c->rows.MJ = mg_reserve_reals(memory, 12 * r);
  c->rows.d = mg_reserve_reals(memory, r), c->rows.gamma = mg_reserve_reals(memory, r),
  c->rows.d_dot = mg_reserve_reals(memory, r), c->rows.time_rate = mg_reserve_reals(memory, r);
  c->rows.normal = mg_reserve_reals(memory, 3 * m), c->solution.force = mg_reserve_reals(memory, r),
  c->rows.eta_dot = mg_reserve_reals(memory, s->n_eta + m);
  c->lcp.A = mg_reserve_reals(memory, n * n), c->lcp.b = mg_reserve_reals(memory, n),
  c->lcp.z = mg_reserve_reals(memory, n);
  const long long dense = mg_lcp_work_size((int)n), large = mg_large_qp_work_size((int)n, s->n_body);
  c->lcp.work = mg_reserve_reals(memory, dense > large ? dense : large);
  c->lcp.reduced_A = mg_reserve_reals(memory, k * k), c->lcp.reduced_b = mg_reserve_reals(memory, k),
  c->lcp.reduced_z = mg_reserve_reals(memory, n);
  c->step.slopes = mg_reserve_reals(memory, MG_STAGES * x), c->step.end = mg_reserve_reals(memory, x),
  c->step.stage = mg_reserve_reals(memory, x), c->step.end_gap = mg_reserve_reals(memory, m);
  c->step.load_wrench = mg_reserve_reals(memory, 6 * b), c->step.pose = mg_reserve_reals(memory, 12 * b),
  c->step.start_pose = mg_reserve_reals(memory, 12 * b), c->step.pressing = mg_reserve_reals(memory, 6 * m);
  c->step.pressing_on = mg_reserve_ints(memory, m);
  c->step.settled = mg_reserve_reals(memory, x), c->step.scale = mg_reserve_reals(memory, x);
  c->step.interpolant = mg_reserve_reals(memory, 8 * x),
  c->search.placement = mg_reserve_reals(memory, 32 + 2 * s->n_eta);
  c->rows.row_rate = mg_reserve_reals(memory, r), c->solution.impulse = mg_reserve_reals(memory, r);
  c->joints.independence = mg_reserve_reals(memory, s->n_joint_row),
  c->events.gap_before = mg_reserve_reals(memory, 2 * m);
  c->search.samples = mg_reserve_items(memory, MG_SAMPLES, sizeof(mg_sample)),
  c->search.abandoned = mg_reserve_items(memory, mg_abandoned_capacity(s), sizeof(mg_minimum)),
  c->search.views = mg_reserve_items(memory, MG_FEATURE_VIEWS, sizeof(mg_feature_in_world)),
  c->search.bounds_memory = mg_reserve_items(memory, mg_bounds_memory_max(s), sizeof(mg_taylor_model));
  c->search.face_gap = mg_reserve_reals(memory, s->n_face_group);
  c->search.searched_gap = mg_reserve_reals(memory, s->n_pair),
  c->search.cell_pairs = mg_reserve_ints(memory, s->n_cell_tree ? 2L * MG_CELL_PAIRS : 0);
  c->step.rolling_starts = (mg_rolling_start *)(void *)mg_reserve_reals(memory, m * mg_rolling_start_size());
  c->bodies.motion = mg_reserve_ints(memory, b);
  c->events.broken_condition = mg_reserve_ints(memory, m), c->events.within_border = mg_reserve_ints(memory, m);
  c->contacts.n_eta = mg_reserve_ints(memory, m);
  c->contacts.kind = mg_reserve_ints(memory, r), c->contacts.parameters = mg_reserve_ints(memory, m + 1);
  c->contacts.o = mg_reserve_ints(memory, r), c->contacts.f = mg_reserve_ints(memory, r),
  c->contacts.is_inertial = mg_reserve_ints(memory, r);
  c->lcp.rows = mg_reserve_ints(memory, r), c->lcp.mask = mg_reserve_ints(memory, r),
  c->lcp.joint_mask = mg_reserve_ints(memory, n);
  c->springs.impulse = mg_reserve_reals(memory, mg_spring_count(s)),
  c->springs.load = mg_reserve_ints(memory, mg_spring_count(s)),
  c->springs.sharing = mg_reserve_ints(memory, mg_spring_count(s));
  c->events.triggered = mg_reserve_ints(memory, m);
  c->events.margins =
      mg_reserve_items(memory, (MG_MARGIN_SAMPLES + 1L) * mg_event_margin_count(s), sizeof(mg_event_margin));
  c->events.gap_dips = mg_reserve_ints(memory, m), c->patches.is_covered = mg_reserve_ints(memory, m),
  c->events.is_near = mg_reserve_ints(memory, m);
  c->patches.trial = mg_reserve_ints(memory, s->n_patch_slot),
  c->patches.barred = mg_reserve_ints(memory, s->n_patch_slot);
  c->lcp.iwork = mg_reserve_ints(memory, mg_lcp_iwork_size((int)n));
  c->lcp.column = mg_reserve_ints(memory, r), c->islands.next = mg_reserve_ints(memory, r),
  c->islands.rows = mg_reserve_ints(memory, n);
  c->islands.parent = mg_reserve_ints(memory, b), c->islands.head = mg_reserve_ints(memory, b);
  c->islands.incident_begin = mg_reserve_ints(memory, b + 1), c->islands.incident = mg_reserve_ints(memory, 2 * r);
  c->events.passage.column = mg_reserve_reals(memory, 12 * r), c->events.passage.rate = mg_reserve_reals(memory, r),
  c->events.passage.impulse = mg_reserve_reals(memory, r);
  c->events.passage.point = mg_reserve_reals(memory, 3 * m),
  c->events.passage.landing_point = mg_reserve_reals(memory, 3 * m);
  c->events.passage.free_twist = mg_reserve_reals(memory, 6 * b),
  c->events.passage.impulse_work = mg_reserve_reals(memory, 6 * b);
  c->step.time_samples = mg_reserve_reals(memory, mg_time_sample_size(c));
  c->sensors.acceleration = mg_reserve_reals(memory, 6 * b);
  c->sensors.pair = mg_reserve_reals(memory, 2L * s->n_pair),
  c->sensors.joint = mg_reserve_reals(memory, 6L * s->n_joint);
  mg_set_switch_arrays(c, memory);
  c->rows.tangents = c->rows.kernel_rows = 0;
  if (s->n_friction) mg_set_friction_arrays(c, memory);
}

/* Memory that mg_set_arrays reserves. */
static mg_memory mg_count_memory(const mg_system *s) {
  mg_context c = {.system = s, .layout.n_timed = mg_time_function_count(s)};
  mg_memory memory = {0};
  mg_set_arrays(&c, &memory);
  return memory;
}

MG_API long long mg_work_size(const mg_system *s) {
  return mg_held_row_capacity(s) > MG_ROW_MAX ? -1 : mg_count_memory(s).n_reals;
}

MG_API long long mg_iwork_size(const mg_system *s) {
  return mg_held_row_capacity(s) > MG_ROW_MAX ? -1 : mg_count_memory(s).n_ints;
}

/* Sets the memory of the friction constraints to a start without any slip. */
static void mg_init_friction(mg_context *c) {
  const mg_system *s = c->system;
  for (int i = 0; i < s->n_patch_slot; i++)
    c->patches.friction[i].slips = c->patches.friction[i].centre_known = c->patches.friction[i].triggered =
        c->patches.friction[i].slip_stopped = c->patches.friction[i].mode_before = 0,
    c->patches.friction[i].mean_distance = 0;
  mg_zero_reals(c->friction.slip_time_left, s->n_friction);
  for (int g = 0; g < s->n_friction; g++) c->friction.is_stiff[g] = 0;
}

/* Writes the poses that never change: of fixed bodies, and the rotation of point masses. */
static void mg_set_constant_poses(mg_context *c) {
  const mg_system *s = c->system;
  c->layout.n_driven = c->layout.n_moving = 0;
  for (int b = 0; b < s->n_body; b++) {
    const int motion = c->bodies.motion[b];
    mg_real *pose = c->bodies.pose + 12 * b;
    c->layout.n_driven += motion == MG_DRIVEN, c->layout.n_moving += motion >= MG_POINT;
    if (motion == MG_FIXED)
      for (int i = 0; i < 12; i++) pose[i] = s->parameters[s->body_parameters[b] + i];
    if (motion == MG_POINT) pose[3] = pose[7] = pose[11] = 1;
  }
}

#ifdef MG_DEBUG
/* Byte with which scratch memory is filled before use, by MG_DEBUG; that of 1 makes reals NaN and ints -1. */
static const unsigned char mg_fill[] = {0, 0xff, 0x7f, 0xaa, 0x3f, 0};

/* Fills the memory that no call leaves to the next one: all but the cells, which come first. */
static void mg_fill_scratch(mg_context *c, const mg_system *s, mg_real *work, int *iwork) {
  mg_context cells = {.system = s};
  mg_memory kept = {0};
  const mg_memory all = mg_count_memory(s);
  mg_set_cell_arrays(&cells, &kept);
  memset(c, mg_fill[MG_DEBUG], sizeof *c);
  memset(work + kept.n_reals, mg_fill[MG_DEBUG], (size_t)(all.n_reals - kept.n_reals) * sizeof *work);
  memset(iwork + kept.n_ints, mg_fill[MG_DEBUG], (size_t)(all.n_ints - kept.n_ints) * sizeof *iwork);
  memset(&c->valid, 0, sizeof c->valid);
  mg_require_tables(s);
}
#else
#define mg_fill_scratch(c, s, work, iwork) ((void)0)
#endif

/* Zeroes the rows of J or MJ that are of no contact; of all rows the columns that a kind lacks stay zero. */
static void mg_zero_other_rows(const mg_context *c, mg_real *rows) {
  const int first = c->system->n_contact, spring = c->layout.spring_row_begin;
  mg_zero_reals(rows + 12L * first, 12L * (c->layout.friction_row_begin - first));
  mg_zero_reals(rows + 12L * spring, 12L * (c->layout.spring_row_end - spring));
}

MG_INTERNAL void mg_open_context(mg_context *c, const mg_system *system, const mg_settings *settings, mg_run *run,
                                 mg_real *work, int *iwork) {
  mg_fill_scratch(c, system, work, iwork);
  c->system = system, c->kernels = system->kernels, c->settings = settings, c->run = run;
  c->layout.n_states = (int)mg_state_count(system), c->layout.work_state = c->layout.n_states - 1,
  c->step.sign_changed = c->step.is_end_evaluated = c->events.passage.is_paused = 0, c->patches.hull_patch = -1,
  c->step.follower = 0, c->lcp.keeps_matrix = c->lcp.n_assembled = c->lcp.is_of_joints = 0, c->solution.least_pivot = 0;
  c->search.view_round = 0, c->step.work = 0, c->step.mode_choices = c->step.chooses_modes = 0;
  c->layout.limit_pair_begin = mg_first_limit_pair(system);
  c->layout.limit_begin = system->pair_contact[c->layout.limit_pair_begin];
  c->layout.support_begin = system->n_contact - 3 * system->n_patch_slot,
  c->layout.support_feature_pair_begin = system->n_feature_pair - 3 * system->n_patch;
  c->layout.joint_row_begin = system->n_contact + 1, c->layout.spring_row_end = (int)mg_row_count(system);
  c->layout.friction_row_begin = c->layout.joint_row_end = c->layout.joint_row_begin + system->n_joint_row,
  c->layout.spring_row_begin = c->layout.friction_row_end = c->layout.friction_row_begin + system->n_friction_row,
  c->friction.slips = c->friction.couples_normal = c->friction.follows_angle = c->switches.is_literal =
      c->switches.is_unresolved = 0;
  c->layout.n_timed = mg_time_function_count(system);
  mg_memory memory = {work, iwork, 0, 0};
  mg_set_arrays(c, &memory);
  if (system->n_friction) mg_init_friction(c);
  for (int k = 0; k < system->n_switch; k++) c->switches.triggered[k] = 0, c->switches.slack[k] = 0;
  for (int b = 0; b < system->n_body; b++) c->bodies.motion[b] = c->kernels->body_kinds[system->body_kind[b]].motion;
  mg_copy_reals(c->step.scale, system->scale, c->layout.n_states);
  mg_zero_reals(c->bodies.pose, 30L * system->n_body);
  mg_zero_other_rows(c, c->rows.J), mg_zero_other_rows(c, c->rows.MJ);
  mg_zero_reals(c->solution.force, c->layout.spring_row_end);
  mg_zero_reals(c->rows.time_rate, c->layout.friction_row_end);
  mg_zero_reals(c->rows.d + c->layout.friction_row_begin, system->n_friction_row);
  c->layout.n_live_states = c->layout.n_states - system->n_eta, c->search.n_abandoned = 0, c->search.penetration = 0,
  c->search.incomplete = 0, c->search.is_stoppable = 1;
  c->layout.n_state_loads = mg_state_load_count(system, 0),
  c->layout.n_steady_loads = c->layout.n_state_loads - mg_state_load_count(system, 1);
  for (int i = 0; i < c->layout.spring_row_end; i++) c->lcp.column[i] = -1;
  mg_zero_reals(c->step.stage + system->n_q + system->n_u, system->n_eta); /* which is recorded whole */
  mg_open_contacts(c);
  for (int slot = 0; slot < system->n_patch_slot; slot++) c->patches.barred[slot] = -1, c->patches.trial[slot] = 0;
  for (int pair = 0; pair < system->n_pair; pair++) c->search.searched_gap[pair] = -1;
  mg_forget_incidence(c);
  mg_init_listing(c);
  mg_keep_cells_of_same_shapes(c);
  mg_init_joint_rows(c);
  mg_init_spring_rows(c);
  mg_set_constant_poses(c);
}
