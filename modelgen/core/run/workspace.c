/* The context of one call: sizes of the scratch memory, and its division into the arrays of mg_context.
   mg_work_size and mg_iwork_size must count what mg_set_arrays and mg_set_friction_arrays take. */
#include "run/run.h"
#include "base/base.h"
#include "solve/lcp/lcp_solvers.h"
#include "solve/friction/friction_solvers.h"
#include "region/region.h"
#include "model/model.h"
#include "closest/closest.h"
#include "forces/forces.h"
#include "integrate/integrate.h"

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

/* Memory of proofs of unique motion, in mg_real: of scenes in which several contacts may be closed. */
static long mg_motion_memory_size(const mg_system *s) { return s->closed_capacity > 1 ? mg_motion_work_size() : 0; }

/* Memory of the friction constraints, in mg_real. */
static long mg_friction_memory_size(const mg_system *s) {
  if (!s->n_friction) return 0;
  const long k = s->n_patch_slot ? mg_held_row_capacity(s) : 0;
  return (long)MG_RADAU_STAGES * MG_SLIP_UNKNOWNS * s->n_u + k * k + 2 * k +
         mg_count_reals(s->n_patch_slot, sizeof(mg_patch_friction)) +
         mg_count_reals(mg_strip_capacity_max(s), sizeof(mg_boundary_strip)) + s->n_friction_row + 2L * s->n_friction +
         MG_CONE * (long)s->closed_capacity + 6L * s->n_contact + 78 + mg_motion_memory_size(s) +
         mg_friction_work_size((int)mg_held_row_capacity(s), s->closed_capacity);
}

/* Memory of the friction constraints, in int. */
static long mg_friction_int_memory_size(const mg_system *s) {
  if (!s->n_friction) return 0;
  return 5L * s->n_friction + 4L * s->closed_capacity +
         mg_friction_iwork_size((int)mg_held_row_capacity(s), s->closed_capacity);
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
  for (int k = 0; s->n_cell_tree && k < 2 * s->n_feature_pair; k++) {
    const int size = s->kernels->shape_bounds[s->feature_shape[k]].n_memory;
    if (s->feature_tree[k] >= 0 && size > most) most = size;
  }
  return most;
}

/* Memory of searches for closest points, in mg_real. */
static long mg_search_memory_size(const mg_system *s) {
  return mg_count_reals(MG_SAMPLES, sizeof(mg_sample)) + mg_count_reals(s->n_cell, sizeof(mg_cell)) +
         mg_count_reals(mg_bounds_memory_max(s), sizeof(mg_taylor_model)) + mg_count_reals(1, sizeof(mg_digest)) +
         MG_SAMPLES + s->n_pair + mg_count_reals(2L * s->n_cell_tree, sizeof(mg_real));
}

/* The same, in int. */
static long mg_search_int_memory_size(const mg_system *s) {
  return 1 + (s->n_cell_tree ? 2L * s->n_cell_tree + 2L * MG_CELL_PAIRS : 0);
}

/* Memory of the lists of what takes part, in int. */
static long mg_listing_int_memory_size(const mg_system *s) {
  return mg_row_count(s) + 1L + s->n_friction + 1L + 4L * s->n_pair + 1L + 2L * s->n_contact + 6L + mg_grid_size(s);
}

MG_API long mg_work_size(const mg_system *s) {
  const long b = s->n_body, m = s->n_contact, r = mg_row_count(s), k = mg_held_row_capacity(s), n = s->closed_capacity,
             x = mg_state_count(s);
  return mg_count_reals(s->n_ball, sizeof(mg_grid_ball)) + 54 * b + 45 * r + mg_spring_count(s) + 9 * m + 1 +
         s->n_joint_row + 4 * m + s->n_eta + k * k + 3 * k + n * n + n + mg_lcp_work_size((int)k) +
         mg_count_reals(mg_max_patch_arcs(s), sizeof(mg_arc)) + mg_hull_memory_max(s) + (MG_STAGES + 12) * x + 32 +
         2 * s->n_eta + mg_search_memory_size(s) + mg_event_margin_size(s) + m * mg_rolling_start_size() +
         (MG_SWITCH_COLUMNS + 7L) * s->n_switch + mg_switch_gradient_size(s) + 3L * s->n_input * s->n_switch +
         mg_friction_memory_size(s) + mg_time_sample_size(s) + 2L * s->n_pair + 6L * s->n_joint;
}

MG_API long mg_iwork_size(const mg_system *s) {
  const long m = s->n_contact, r = mg_row_count(s), k = mg_held_row_capacity(s);
  return 7 * m + 3L * s->n_switch + 2L * s->n_patch_slot + 10 * r + 2L * mg_spring_count(s) + 4 +
         mg_search_int_memory_size(s) + 2 * k + mg_lcp_iwork_size((int)k) + 4L * s->n_body + 1 +
         mg_friction_int_memory_size(s) + mg_listing_int_memory_size(s);
}

MG_API mg_digest mg_shapes_digest(const mg_system *system) { return mg_digest_searched_shapes(system); }

MG_API int mg_abi(void) { return MG_ABI; }

MG_API int mg_real_size(void) { return (int)sizeof(mg_real); }

/* Body on which a row acts on one side, or -1: one that forces do not move, or that was counted on the other side. */
static int mg_incident_body(const mg_context *c, int row, int side) {
  const int o = c->contacts.o[row], f = c->contacts.f[row], body = side ? f : o;
  return row == c->system->n_contact || !mg_is_moved_by_forces(c, body) || (side && f == o) ? -1 : body;
}

/* Lists the rows that act on each body that forces move, sorted by body. */
static void mg_set_incidence(mg_context *c) {
  const int n_body = c->system->n_body, n_row = c->layout.spring_row_end;
  int *begin = c->islands.incident_begin, body;
  for (int b = 0; b <= n_body; b++) begin[b] = 0;
  for (int k = 0; k < 2 * n_row; k++)
    if ((body = mg_incident_body(c, k / 2, k % 2)) >= 0) begin[body]++;
  for (int b = 0; b < n_body; b++) begin[b + 1] += begin[b];
  for (int k = 2 * n_row - 1; k >= 0; k--)
    if ((body = mg_incident_body(c, k / 2, k % 2)) >= 0) c->islands.incident[--begin[body]] = k / 2;
}

/* Divides the memory of the friction constraints. */
static void mg_set_friction_arrays(mg_context *c, mg_real *work, int *iwork) {
  const mg_system *s = c->system;
  const long n = mg_held_row_capacity(s), k = s->closed_capacity;
  c->patches.friction = mg_take_memory(&work, s->n_patch_slot, sizeof(mg_patch_friction));
  c->patches.strip_capacity = mg_strip_capacity_max(s),
  c->patches.strips = mg_take_memory(&work, c->patches.strip_capacity, sizeof(mg_boundary_strip));
  for (int i = 0; i < s->n_patch_slot; i++)
    c->patches.friction[i].slips = c->patches.friction[i].centre_known = c->patches.friction[i].triggered =
        c->patches.friction[i].slip_stopped = c->patches.friction[i].mode_before = 0,
    c->patches.friction[i].mean_distance = 0;
  c->patches.reduced_problem = mg_take_reals(&work, s->n_patch_slot ? n * n + 2 * n : 0);
  c->friction.force_ratio = mg_take_reals(&work, s->n_friction_row),
  c->friction.slip_time_left = mg_take_reals(&work, s->n_friction);
  c->friction.slip_angle = mg_take_reals(&work, s->n_friction);
  c->step.angle_slopes = mg_take_reals(&work, (long)MG_RADAU_STAGES * MG_SLIP_UNKNOWNS * s->n_u);
  mg_zero_reals(c->friction.slip_time_left, s->n_friction);
  c->friction.cone = mg_take_reals(&work, MG_CONE * k), c->rows.tangents = mg_take_reals(&work, 6L * s->n_contact);
  c->rows.kernel_rows = mg_take_reals(&work, 78),
  c->friction.motion_work = mg_take_reals(&work, mg_motion_memory_size(s)),
  c->friction.work = mg_take_reals(&work, mg_friction_work_size((int)n, (int)k));
  if (mg_motion_memory_size(s)) mg_forget_motion_proof(c->friction.motion_work);
  c->friction.triggered = mg_take_ints(&iwork, s->n_friction),
  c->friction.mode_before = mg_take_ints(&iwork, s->n_friction);
  c->friction.bound = mg_take_ints(&iwork, s->n_friction), c->friction.cone_contact = mg_take_ints(&iwork, k);
  c->friction.is_yielding = mg_take_ints(&iwork, s->n_friction);
  c->friction.is_stiff = mg_take_ints(&iwork, s->n_friction);
  c->friction.cone_first = mg_take_ints(&iwork, k), c->friction.cone_rows = mg_take_ints(&iwork, k),
  c->friction.marks = mg_take_ints(&iwork, k);
  c->friction.iwork = mg_take_ints(&iwork, mg_friction_iwork_size((int)n, (int)k));
  for (int g = 0; g < s->n_friction; g++) c->friction.is_stiff[g] = 0;
}

/* Divides the memory of the lists of what takes part. */
static void mg_set_listing_arrays(mg_context *c, mg_real **work, int **iwork) {
  const mg_system *s = c->system;
  mg_listing *l = &c->listed;
  l->balls = mg_take_memory(work, s->n_ball, sizeof(mg_grid_ball));
  l->row = mg_take_ints(iwork, c->layout.spring_row_end + 1L), l->constraint = mg_take_ints(iwork, s->n_friction + 1L);
  l->pair = mg_take_ints(iwork, s->n_pair + 1L), l->range = mg_take_ints(iwork, 2L * s->n_contact + 6);
  l->always = mg_take_ints(iwork, s->n_pair), l->listed = mg_take_ints(iwork, s->n_pair);
  l->found = mg_take_ints(iwork, s->n_pair), l->grid = mg_take_ints(iwork, mg_grid_size(s));
}

/* Takes the memory of the cells, at the same place for all systems that may keep each other's cells. */
static void mg_set_cell_arrays(mg_context *c, mg_real **work, int **iwork) {
  const mg_system *s = c->system;
  c->search.cells_digest = mg_take_memory(work, 1, sizeof(mg_digest));
  c->search.cells = mg_take_memory(work, s->n_cell, sizeof(mg_cell));
  c->search.tree_bound = mg_take_memory(work, 2L * s->n_cell_tree, sizeof(mg_real)); /* pointers follow */
  c->search.n_cells = mg_take_ints(iwork, 1);
  c->search.tree_root = mg_take_ints(iwork, 2L * s->n_cell_tree);
}

/* Divides the memory. */
static void mg_set_arrays(mg_context *c, mg_real *work, int *iwork) {
  const mg_system *s = c->system;
  const long b = s->n_body, m = s->n_contact, r = c->layout.spring_row_end, n = mg_held_row_capacity(s),
             k = s->closed_capacity, x = c->layout.n_states;
  mg_set_cell_arrays(c, &work, &iwork);
  c->patches.arcs = mg_take_memory(&work, mg_max_patch_arcs(s), sizeof(mg_arc)),
  c->patches.hull_memory = mg_take_reals(&work, mg_hull_memory_max(s)); /* pointers first */
  mg_set_listing_arrays(c, &work, &iwork);
  c->contacts.length = mg_take_reals(&work, m + 1);
  c->bodies.pose = mg_take_reals(&work, 12 * b), c->bodies.twist = mg_take_reals(&work, 6 * b);
  c->bodies.acceleration = mg_take_reals(&work, 6 * b), c->bodies.wrench = mg_take_reals(&work, 6 * b);
  c->rows.J = mg_take_reals(&work, 12 * r), c->rows.MJ = mg_take_reals(&work, 12 * r);
  c->rows.d = mg_take_reals(&work, r), c->rows.gamma = mg_take_reals(&work, r), c->rows.d_dot = mg_take_reals(&work, r),
  c->rows.time_rate = mg_take_reals(&work, r);
  c->rows.normal = mg_take_reals(&work, 3 * m), c->solution.force = mg_take_reals(&work, r),
  c->rows.eta_dot = mg_take_reals(&work, s->n_eta + m);
  c->lcp.A = mg_take_reals(&work, n * n), c->lcp.b = mg_take_reals(&work, n), c->lcp.z = mg_take_reals(&work, n);
  c->lcp.work = mg_take_reals(&work, mg_lcp_work_size((int)n));
  c->lcp.reduced_A = mg_take_reals(&work, k * k), c->lcp.reduced_b = mg_take_reals(&work, k),
  c->lcp.reduced_z = mg_take_reals(&work, n);
  c->step.slopes = mg_take_reals(&work, MG_STAGES * x), c->step.end = mg_take_reals(&work, x),
  c->step.stage = mg_take_reals(&work, x);
  c->step.load_wrench = mg_take_reals(&work, 6 * b);
  c->step.settled = mg_take_reals(&work, x), c->step.scale = mg_take_reals(&work, x);
  c->step.interpolant = mg_take_reals(&work, 8 * x), c->search.placement = mg_take_reals(&work, 32 + 2 * s->n_eta);
  c->rows.row_rate = mg_take_reals(&work, r), c->solution.impulse = mg_take_reals(&work, r);
  c->joints.independence = mg_take_reals(&work, s->n_joint_row), c->events.gap_before = mg_take_reals(&work, 2 * m);
  c->search.samples = mg_take_memory(&work, MG_SAMPLES, sizeof(mg_sample)),
  c->search.bounds_memory = mg_take_memory(&work, mg_bounds_memory_max(s), sizeof(mg_taylor_model));
  c->search.face_gap = mg_take_reals(&work, MG_SAMPLES), c->search.searched_gap = mg_take_reals(&work, s->n_pair),
  c->search.cell_pairs = mg_take_ints(&iwork, s->n_cell_tree ? 2L * MG_CELL_PAIRS : 0);
  c->step.rolling_starts = (mg_rolling_start *)(void *)mg_take_reals(&work, m * mg_rolling_start_size());
  c->bodies.motion = mg_take_ints(&iwork, b);
  c->events.broken_condition = mg_take_ints(&iwork, m), c->events.within_border = mg_take_ints(&iwork, m);
  c->contacts.n_eta = mg_take_ints(&iwork, m);
  c->contacts.kind = mg_take_ints(&iwork, r), c->contacts.parameters = mg_take_ints(&iwork, m + 1);
  c->contacts.o = mg_take_ints(&iwork, r), c->contacts.f = mg_take_ints(&iwork, r);
  c->lcp.rows = mg_take_ints(&iwork, r), c->lcp.mask = mg_take_ints(&iwork, r),
  c->lcp.joint_mask = mg_take_ints(&iwork, n);
  c->springs.impulse = mg_take_reals(&work, mg_spring_count(s)),
  c->springs.load = mg_take_ints(&iwork, mg_spring_count(s)),
  c->springs.sharing = mg_take_ints(&iwork, mg_spring_count(s));
  c->events.triggered = mg_take_ints(&iwork, m);
  c->events.margins =
      mg_take_memory(&work, (MG_MARGIN_SAMPLES + 1L) * mg_event_margin_count(s), sizeof(mg_event_margin));
  c->events.gap_dips = mg_take_ints(&iwork, m), c->patches.is_covered = mg_take_ints(&iwork, m),
  c->events.is_near = mg_take_ints(&iwork, m);
  c->patches.trial = mg_take_ints(&iwork, s->n_patch_slot), c->patches.barred = mg_take_ints(&iwork, s->n_patch_slot);
  c->lcp.iwork = mg_take_ints(&iwork, mg_lcp_iwork_size((int)n));
  c->lcp.column = mg_take_ints(&iwork, r), c->islands.next = mg_take_ints(&iwork, r),
  c->islands.rows = mg_take_ints(&iwork, n);
  c->islands.parent = mg_take_ints(&iwork, b), c->islands.head = mg_take_ints(&iwork, b);
  c->islands.incident_begin = mg_take_ints(&iwork, b + 1), c->islands.incident = mg_take_ints(&iwork, 2 * r);
  c->events.passage.column = mg_take_reals(&work, 12 * r), c->events.passage.rate = mg_take_reals(&work, r),
  c->events.passage.impulse = mg_take_reals(&work, r);
  c->events.passage.point = mg_take_reals(&work, 3 * m), c->events.passage.landing_point = mg_take_reals(&work, 3 * m);
  c->events.passage.free_twist = mg_take_reals(&work, 6 * b),
  c->events.passage.impulse_work = mg_take_reals(&work, 6 * b);
  c->layout.n_timed = mg_time_function_count(s), c->step.time_samples = mg_take_reals(&work, mg_time_sample_size(s));
  c->sensors.acceleration = mg_take_reals(&work, 6 * b);
  c->sensors.pair = mg_take_reals(&work, 2L * s->n_pair), c->sensors.joint = mg_take_reals(&work, 6L * s->n_joint);
  c->switches.value = mg_take_reals(&work, s->n_switch), c->switches.rate = mg_take_reals(&work, s->n_switch),
  c->switches.size = mg_take_reals(&work, s->n_switch), c->switches.slack = mg_take_reals(&work, s->n_switch);
  c->switches.noise = mg_take_reals(&work, s->n_switch), c->switches.second = mg_take_reals(&work, 2L * s->n_switch);
  c->switches.slope = mg_take_reals(&work, (long)MG_SWITCH_COLUMNS * s->n_switch),
  c->switches.gradient = mg_take_reals(&work, mg_switch_gradient_size(s)),
  c->switches.input_gradient = mg_take_reals(&work, 3L * s->n_input * s->n_switch);
  c->switches.triggered = mg_take_ints(&iwork, s->n_switch), c->switches.is_at_zero = mg_take_ints(&iwork, s->n_switch),
  c->switches.mode_before = mg_take_ints(&iwork, s->n_switch);
  c->rows.tangents = c->rows.kernel_rows = 0;
  if (s->n_friction) mg_set_friction_arrays(c, work, iwork);
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

MG_INTERNAL void mg_open_context(mg_context *c, const mg_system *system, const mg_settings *settings, mg_run *run,
                                 mg_real *work, int *iwork) {
  c->system = system, c->kernels = system->kernels, c->settings = settings, c->run = run;
  c->layout.n_states = (int)mg_state_count(system), c->layout.work_state = c->layout.n_states - 1,
  c->step.sign_changed = c->events.passage.is_paused = 0, c->patches.hull_patch = -1, c->step.follower = 0,
  c->lcp.keeps_matrix = c->lcp.n_assembled = 0;
  c->layout.support_begin = system->n_contact - 3 * system->n_patch_slot,
  c->layout.support_feature_pair_begin = system->n_feature_pair - 3 * system->n_patch;
  c->layout.joint_row_begin = system->n_contact + 1, c->layout.spring_row_end = (int)mg_row_count(system);
  c->layout.friction_row_begin = c->layout.joint_row_end = c->layout.joint_row_begin + system->n_joint_row,
  c->layout.spring_row_begin = c->layout.friction_row_end = c->layout.friction_row_begin + system->n_friction_row,
  c->friction.slips = c->friction.couples_normal = c->friction.follows_angle = c->switches.is_literal =
      c->switches.is_unresolved = 0;
  mg_set_arrays(c, work, iwork);
  for (int b = 0; b < system->n_body; b++) c->bodies.motion[b] = c->kernels->body_kinds[system->body_kind[b]].motion;
  for (int i = 0; i < c->layout.n_states; i++) c->step.scale[i] = system->scale[i];
  mg_zero_reals(c->bodies.pose, 30L * system->n_body);
  mg_zero_reals(c->rows.J, 24L * c->layout.spring_row_end); /* J and MJ: the columns a kind lacks stay zero */
  mg_zero_reals(c->solution.force, c->layout.spring_row_end);
  mg_zero_reals(c->rows.time_rate, c->layout.friction_row_end);
  mg_zero_reals(c->rows.d + c->layout.friction_row_begin, system->n_friction_row);
  c->layout.n_live_states = c->layout.n_states - system->n_eta, c->search.abandoned.count = 0,
  c->search.penetration = 0;
  c->layout.n_state_loads = mg_state_load_count(system, 0),
  c->layout.n_steady_loads = c->layout.n_state_loads - mg_state_load_count(system, 1);
  for (int i = 0; i < system->n_contact; i++)
    c->lcp.column[i] = -1, c->contacts.n_eta[i] = c->events.within_border[i] = 0, mg_load_feature_pair(c, i);
  for (int slot = 0; slot < system->n_patch_slot; slot++) c->patches.barred[slot] = -1, c->patches.trial[slot] = 0;
  for (int pair = 0; pair < system->n_pair; pair++) c->search.searched_gap[pair] = -1;
  for (int k = 0; k < system->n_switch; k++) c->switches.triggered[k] = 0, c->switches.slack[k] = 0;
  mg_init_listing(c);
  mg_keep_cells_of_same_shapes(c);
  mg_init_joint_rows(c);
  mg_init_spring_rows(c);
  mg_set_incidence(c);
  mg_set_constant_poses(c);
}
