/* The solver of friction problems: Gauss-Seidel sweeps and semismooth Newton steps in turn; where these fail,
   other starting points; then the certificate. */
#include "solve/friction/friction_solvers.h"
#include "base/base.h"

enum {
  MG_FRICTION_ROUNDS = 4,          /* rounds of sweeps and Newton steps */
  MG_FRICTION_SWEEPS = 6,          /* sweeps of the first round */
  MG_FRICTION_SWEEP_GROWTH = 4,    /* factor of the sweeps of the next round */
  MG_FRICTION_NEWTON_STEPS = 40,   /* most Newton steps of a round */
  MG_FRICTION_REFINEMENT_STEPS = 3 /* most Newton steps from a solution */
};

/* Sweeps, then Newton steps; where these fail, more sweeps from where the first ended. A problem that names what it
   accepts is given Newton steps again only where the sweeps between have halved the residual, because sweeps cost far
   less; on a graph they do not, and go on from the best candidate, until a round does not halve a residual that is near
   that. Returns whether a solution was found. */
static int mg_friction_sweep_and_newton(mg_scaled_friction *s, int rounds) {
  const int m = mg_friction_rows(s);
  mg_real *swept = s->spare, before = MG_MAX;
  for (int round = 0, sweeps = MG_FRICTION_SWEEPS; round < rounds; ++round, sweeps *= MG_FRICTION_SWEEP_GROWTH) {
    if (mg_friction_sweep(s, sweeps)) return 1;
    if (s->given->accepted > 0 && s->residual > before / 2 && !s->graph.J) continue;
    if (s->graph.J && s->residual > before / 2 && s->residual <= s->given->near) return 0;
    before = s->residual;
    for (int i = 0; i < m; ++i) swept[i] = s->y[i];
    for (int augmented = 1; augmented >= 0; --augmented) {
      if (mg_friction_newton(s, MG_FRICTION_NEWTON_STEPS, augmented) || mg_friction_is_accepted(s)) return 1;
      for (int i = 0; i < m; ++i) s->y[i] = s->graph.J ? s->best[i] : swept[i];
    }
  }
  return mg_friction_is_accepted(s);
}

/* Tries the guess z, and Newton steps from it. Returns whether a solution was found; else y is the guess. */
static int mg_friction_warm_start(mg_scaled_friction *s, const mg_real *z) {
  const int guessed = mg_max_abs(s->given->n, z) > 0;
  mg_friction_scale_guess(s, z);
  mg_friction_update_motion(s);
  if (mg_friction_update_best(s)) return 1;
  if (guessed && (mg_friction_newton(s, MG_FRICTION_SWEEPS, 1) || mg_friction_is_accepted(s))) return 1;
  mg_friction_scale_guess(s, z);
  return 0;
}

/* |v_t| of a part in the units of the residual. */
static mg_real mg_friction_part_speed(const mg_scaled_friction *s, int part) {
  return mg_friction_norm(s->part_dim[part], s->v + s->part_row[part]) / (mg_real)sqrt(s->rho[part]);
}

/* Marks MG_MARK_FORCE .. of a contact at y, v. */
static int mg_friction_contact_marks(const mg_scaled_friction *s, int contact) {
  const mg_real radius = s->y[s->normal[contact]];
  int mark = MG_MARK_FORCE;
  if (!(radius - mg_friction_slack(s, contact) > 0)) return 0;
  for (int p = s->part[contact]; p < s->part[contact + 1]; ++p) {
    const int row = s->part_row[p];
    mg_real q[2] = {0, 0};
    for (int i = 0; i < s->part_dim[p]; ++i) q[i] = s->y[row + i] - s->v[row + i] / s->rho[p];
    if (mg_friction_norm(s->part_dim[p], q) > radius && mg_friction_part_speed(s, p) > MG_LCP_CAP)
      mark |= s->part_mark[p];
  }
  return mark;
}

/* Marks of all contacts of the candidate, whose motion is in v. */
static void mg_friction_mark_contacts(const mg_scaled_friction *s, int *marks) {
  for (int c = 0; c < s->n; ++c) marks[c] = mg_friction_contact_marks(s, c);
}

/* Returns the best candidate in the units of the problem, with marks and residual. Returns whether it is a
   solution. */
static int mg_friction_certify_best(mg_scaled_friction *s, mg_real *z, int *marks, mg_friction_report *report) {
  mg_real growth;
  for (int i = 0; i < s->m; ++i) s->y[i] = s->best[i];
  mg_friction_update_motion(s);
  mg_friction_mark_contacts(s, marks);
  mg_friction_unscale(s, s->best, z);
  report->residual = mg_friction_certify(s->given, z, &growth);
  report->outcome = report->residual <= mg_max(s->given->accepted, mg_friction_cap(growth)) ? MG_FRICTION_SOLVED
                                                                                            : MG_FRICTION_NOT_FOUND;
  return report->outcome == MG_FRICTION_SOLVED;
}

/* Newton steps from a solution as long as they reduce the residual, because the tolerance is a thousand roundings. */
static void mg_friction_refine(mg_scaled_friction *s) {
  const int m = s->m;
  mg_real *before = s->spare;
  for (int step = 0; step < MG_FRICTION_REFINEMENT_STEPS && !(s->given->accepted > 0); ++step) {
    const mg_real residual = s->residual, tolerance = mg_friction_tolerance(s, s->best);
    if (!(residual > tolerance / 1000 && residual <= tolerance)) return;
    for (int i = 0; i < m; ++i) before[i] = s->y[i] = s->best[i];
    mg_friction_newton(s, 1, 1);
    for (int i = 0; i < m; ++i) s->y[i] = s->best[i];
    mg_friction_update_motion(s);
    s->residual = mg_friction_error(s);
    if (s->residual < residual) continue;
    for (int i = 0; i < m; ++i) s->best[i] = before[i];
    s->residual = residual;
    return;
  }
}

/* Seeks a solution from the guess z: Newton steps, then sweeps and Newton steps in turn. `best` is the best candidate.
 */
static void mg_friction_find(mg_scaled_friction *s, const mg_real *z) {
  if (!mg_friction_warm_start(s, z)) mg_friction_sweep_and_newton(s, MG_FRICTION_ROUNDS);
}

/* Begins the answer to a problem: nothing is known yet, and a guess that is not finite is none. */
static void mg_friction_begin(const mg_friction_problem *problem, mg_real *z, int *marks, mg_friction_report *report) {
  const mg_friction_report none = {MG_FRICTION_NOT_FINITE, 0, 0, 0, 0, 0, MG_UNDECIDED, MG_MAX};
  *report = none;
  for (int c = 0; c < problem->n_contact; ++c) marks[c] = 0;
  if (!mg_all_finite(problem->n, z))
    for (int i = 0; i < problem->n; ++i) z[i] = 0;
}

/* Solves the scaled problem; z is the guess on entry. */
static void mg_friction_solve(mg_scaled_friction *s, mg_real *z, int *marks, mg_friction_report *report) {
  report->starts = 1;
  mg_friction_find(s, z);
  mg_friction_refine(s);
  if (mg_friction_certify_best(s, z, marks, report) || mg_friction_is_stopped(s)) return;
  if (mg_friction_is_infeasible(s)) {
    report->outcome = MG_FRICTION_INFEASIBLE;
    return;
  }
  for (int path = 0; path < MG_FRICTION_STARTS && report->starts != s->given->max_starts && !mg_friction_is_stopped(s);
       ++path) {
    ++report->starts;
    mg_friction_try_start(s, path);
    mg_friction_refine(s);
    if (mg_friction_certify_best(s, z, marks, report)) return;
  }
}

MG_API int mg_friction(const mg_friction_problem *problem, mg_real *z, int *marks, mg_friction_report *report,
                       mg_real *work, int *iwork) {
  mg_scaled_friction s;
  mg_friction_begin(problem, z, marks, report);
  if (!mg_friction_layout(&s, problem, work, iwork) || !mg_friction_scale(&s)) return report->outcome;
  mg_friction_solve(&s, z, marks, report);
  report->sweeps = s.sweeps;
  report->newton = s.newton;
  if (problem->wants_rank && report->outcome == MG_FRICTION_SOLVED) {
    const int strict = mg_friction_least_norm(&s, marks, report);
    mg_friction_certify_best(&s, z, marks, report);
    mg_friction_report_uniqueness(&s, strict, report);
  }
  return report->outcome;
}

/* Returns the best candidate of a problem on a graph in the units of the problem, with marks and residual. Returns
   whether it is a solution. */
static int mg_graph_answer(mg_scaled_friction *s, mg_real *z, int *marks, mg_friction_report *report) {
  for (int i = 0; i < mg_friction_rows(s); ++i) s->y[i] = s->best[i];
  mg_friction_update_motion(s);
  mg_friction_mark_contacts(s, marks);
  for (int i = 0; i < s->given->n; ++i) z[i] = 0;
  for (int i = 0; i < mg_friction_rows(s); ++i) z[s->row[i]] = s->y[i] * s->e[i] * s->scale;
  report->residual = s->residual = mg_friction_error(s);
  report->outcome = mg_friction_is_accepted(s) || s->residual <= mg_friction_tolerance(s, s->y) ? MG_FRICTION_SOLVED
                                                                                                : MG_FRICTION_NOT_FOUND;
  return report->outcome == MG_FRICTION_SOLVED;
}

MG_API int mg_friction_on_graph(const mg_friction_problem *problem, const mg_friction_graph *graph, mg_real *z,
                                int *marks, mg_friction_report *report, mg_real *work, int *iwork) {
  mg_scaled_friction s;
  mg_friction_begin(problem, z, marks, report);
  if (!mg_graph_set_up(&s, problem, graph, work, iwork)) return report->outcome;
  report->starts = 1;
  mg_friction_find(&s, z);
  while (!mg_graph_answer(&s, z, marks, report) && s.graph.has_system && report->starts <= MG_FRICTION_STARTS &&
         report->starts != problem->max_starts && !mg_friction_is_stopped(&s))
    mg_friction_try_start(&s, report->starts++ - 1);
  report->sweeps = s.sweeps, report->newton = s.newton;
  return report->outcome;
}
