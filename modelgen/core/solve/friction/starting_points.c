/* Starting points for friction problems: fixed points of the convex program and continuation from regularised problems
   where direct attempts fail, and forces scattered over the cones from which other solutions may be found. */
#include "solve/friction/friction_solvers.h"
#include "solve/lcp/lcp_solvers.h"

enum {
  MG_FIXED_POINT_STEPS = 12,      /* steps of the fixed-point iteration */
  MG_FIXED_POINT_FAST_STEPS = 8,  /* of these, steps with little damping */
  MG_FIXED_POINT_GRAPH_STEPS = 4, /* of these, steps on a graph */
  MG_PATH_STEPS = 60,             /* most steps of a continuation */
  MG_PATH_NEWTON = 12,            /* Newton steps of one step */
  MG_PATH_SWEEPS = 200            /* sweeps at the start of a continuation */
};

#define MG_PATH_STEP_MIN ((mg_real)1e-4) /* shortest step of a continuation, of 0..1 */

#define MG_PATH_REGULARISATION_MIN (MG_EPS * 1000) /* S + delta I: delta falls from 1 to this, then to 0 */

#define MG_PATH_DUALITY_GAP (MG_EPS * 1000) /* complementarity that the interior-point method aims at */

/* A continuation from a regularised problem, S + delta W and c - delta W anchor, to the given one, delta = 0. */
typedef struct {
  mg_scaled_friction *s; /* the problem */
  mg_real *diagonal;     /* [m] diagonal of S */
  mg_real *weight;       /* [m] diagonal of W */
  mg_real *anchor;       /* [m] solution that the regularisation favours */
  mg_real *c;            /* [m] c of the given problem */
  mg_real *last;         /* [m] last solution */
} mg_path;

/* Number i of a fixed sequence in 0..1, so that results are reproducible. */
static mg_real mg_path_pseudorandom(int i) {
  const mg_real x = (mg_real)(i + 1) * (mg_real)0.6180339887498949;
  return x - (mg_real)(int)x;
}

/* y = from. */
static void mg_path_set_candidate(mg_scaled_friction *s, const mg_real *from) {
  for (int i = 0; i < mg_friction_rows(s); ++i) s->y[i] = from[i];
}

/* Newton steps of both kinds from the point `from`; returns whether that gave a solution. */
static int mg_path_newton(mg_scaled_friction *s, const mg_real *from, int limit) {
  for (int augmented = 0; augmented <= 1; ++augmented) {
    mg_path_set_candidate(s, from);
    if (mg_friction_newton(s, limit, augmented) || mg_friction_is_accepted(s)) return 1;
  }
  return 0;
}

/* Coulomb's law is the convex program with w_n shifted by |mu w_t|, if that equals the |mu w_t| of its solution: a
   fixed point, iterated with damping from shifts that are all `from`, or scattered (Acary, Cadoux, Lemarechal and
   Malick, ZAMM 91 (2011), 155-175). Returns whether a solution was found. */
static int mg_friction_fixed_point(mg_scaled_friction *s, mg_real from, int scatter) {
  const int relaxed = s->given->law == MG_RELAXED;
  mg_real *shift = s->spare, *start = shift + s->m;
  for (int c = 0; c < s->n; ++c)
    shift[c] = relaxed ? 0 : scatter ? 4 * from * mg_path_pseudorandom(c + 5 * scatter) : from;
  for (int k = 0; k < (relaxed ? 1 : s->graph.J ? MG_FIXED_POINT_GRAPH_STEPS : MG_FIXED_POINT_STEPS); ++k) {
    const int is_law = s->graph.J && k == 0 && from > 0 && !scatter && !relaxed;
    const mg_real blend = is_law ? 1 : k < MG_FIXED_POINT_FAST_STEPS ? (mg_real)0.7 : (mg_real)0.3;
    mg_friction_interior(s, is_law ? 0 : shift, MG_PATH_DUALITY_GAP);
    mg_friction_update_motion(s);
    for (int i = 0; i < mg_friction_rows(s); ++i) start[i] = s->y[i];
    for (int c = 0; c < s->n; ++c) shift[c] += blend * (mg_friction_slip(s, c) - shift[c]);
    if (mg_path_newton(s, start, 2 * MG_PATH_NEWTON)) return 1;
    mg_path_set_candidate(s, start);
    if (relaxed) continue;
    if (mg_friction_sweep(s, MG_PATH_NEWTON) || mg_friction_newton(s, 2 * MG_PATH_NEWTON, 1)) return 1;
    if (mg_friction_is_accepted(s)) return 1;
  }
  return 0;
}

/* Saves the problem and chooses path number `which`. */
static void mg_path_open(mg_path *p, mg_scaled_friction *s, int which) {
  const int m = s->m;
  p->s = s;
  p->last = s->spare;
  p->diagonal = p->last + m;
  p->weight = p->diagonal + m;
  p->anchor = p->weight + m;
  p->c = p->anchor + m;
  for (int i = 0; i < m; ++i) {
    p->diagonal[i] = s->S[i + i * m];
    p->c[i] = s->c[i];
    p->weight[i] = which > 0 ? (mg_real)0.1 + 3 * mg_path_pseudorandom(i + 7 * which) : (mg_real)1;
    p->anchor[i] = s->y[i] = 0;
  }
  for (int c = 0; c < s->n && which > 0; ++c) p->anchor[s->normal[c]] = 2 * mg_path_pseudorandom(c + 11 * which);
}

/* Sets the problem at `along` of the path, 0..1; at 1 it is the given one. */
static void mg_path_set_problem(mg_path *p, mg_real along) {
  mg_scaled_friction *s = p->s;
  const mg_real delta = along >= 1 ? 0 : (mg_real)mg_pow(MG_PATH_REGULARISATION_MIN, along);
  s->residual = MG_MAX;
  for (int i = 0; i < s->m; ++i) {
    s->S[i + i * s->m] = p->diagonal[i] + delta * p->weight[i];
    s->c[i] = p->c[i] - delta * p->weight[i] * p->anchor[i];
  }
}

/* Solves the problem at `along` from the last solution. Returns whether that succeeded. */
static int mg_path_advance(mg_path *p, mg_real along) {
  mg_path_set_problem(p, along);
  if (!mg_path_newton(p->s, p->last, MG_PATH_NEWTON)) return 0;
  for (int i = 0; i < p->s->m; ++i) p->last[i] = p->s->best[i];
  return 1;
}

/* Continuation from S + delta I, delta = 1 (which = 0), or from another definite matrix and offset, to S. Returns
   whether a solution was found. */
static int mg_friction_regularisation_path(mg_scaled_friction *s, int which) {
  mg_path p;
  mg_real along = 0, step = (mg_real)0.1;
  mg_path_open(&p, s, which);
  mg_path_set_problem(&p, 0);
  if (!mg_friction_sweep(s, MG_PATH_SWEEPS)) mg_friction_newton(s, MG_PATH_SWEEPS, 0);
  for (int i = 0; i < s->m; ++i) p.last[i] = s->best[i];
  for (int tries = 0; tries < MG_PATH_STEPS && along < 1 && step > MG_PATH_STEP_MIN; ++tries) {
    const mg_real next = along + step < 1 ? along + step : 1;
    const int advanced = mg_path_advance(&p, next);
    if (advanced) along = next;
    step = advanced ? 2 * step : step / 3;
  }
  mg_path_set_problem(&p, 1);
  mg_path_set_candidate(s, p.last);
  mg_friction_update_motion(s);
  return mg_friction_update_best(s) || mg_path_newton(s, p.last, 2 * MG_PATH_NEWTON);
}

MG_INTERNAL int mg_friction_try_start(mg_scaled_friction *s, int which) {
  if (which < 2) return mg_friction_fixed_point(s, (mg_real)(1 - which), 0);
  if (which % 2 || s->graph.J) return mg_friction_fixed_point(s, 1, which);
  return mg_friction_regularisation_path(s, which / 2 - 1);
}

MG_API void mg_scatter_friction_start(const mg_friction_problem *p, int which, mg_real *z) {
  const mg_real sizes[MG_SCATTERED_STARTS] = {0, 1, 10, 1, 30, 3, 100, (mg_real)0.3};
  mg_real present = 0;
  for (int r = 0; r < p->n; r++) {
    present = mg_max(present, fabs(z[r]) * mg_diagonal_scale(p->A[r + (long)p->n * r]));
    z[r] = 0;
  }
  for (int k = 0; k < p->n_contact; k++) {
    const int first = p->first[k], seed = 3 * (p->n_contact * which + k);
    const mg_real *cone = p->cone + MG_CONE * k, entry = p->A[first + (long)p->n * first];
    const mg_real part = which % 3 ? mg_path_pseudorandom(seed + 1) : 0;
    const mg_real angle = 2 * MG_PI * mg_path_pseudorandom(seed + 2);
    if (!(entry > 0)) continue;
    z[first] = sizes[which % MG_SCATTERED_STARTS] * present * mg_path_pseudorandom(seed) / mg_diagonal_scale(entry);
    if (p->rows[k] < 3) continue;
    z[first + 1] = cone[0] * part * z[first] * mg_cos(angle);
    z[first + 2] = cone[1] * part * z[first] * mg_sin(angle);
  }
}
