/* When direct attempts fail: the solution is followed from a problem that is easy to the one that was given. */
#include "friction_scaled.h"

enum { MG_PATH_STEPS = 200, MG_PATH_NEWTON = 12, MG_PATH_SWEEPS = 200 };

/* MG_PATH_LEAST  the shortest step along a path, 0..1.
   MG_PATH_SOFT   S + delta: delta goes from 1 to this, then to 0. */
#define MG_PATH_LEAST ((mg_real)1e-6)
#define MG_PATH_SOFT ((mg_real)MG_EPS * 1000)

typedef struct {
  mg_frictional *s;
  int relaxed;             /* the law changes from relaxed to Coulomb's; else the softness goes to 0 */
  mg_real *diagonal, *weight, *anchor, *c; /* of S; of the softness; where it pulls to; c of the problem */
  mg_real *last;
} mg_path;

/* A fixed sequence in 0..1, so that answers repeat. */
static mg_real mg_path_scatter(int i)
{
  const mg_real x = (mg_real)(i + 1) * (mg_real)0.6180339887498949;
  return x - (mg_real)(int)x;
}

static void mg_path_open(mg_path *p, mg_frictional *s, int which)
{
  const int m = s->m;
  p->s = s;
  p->relaxed = which == 0;
  p->last = s->spare;
  p->diagonal = p->last + m;
  p->weight = p->diagonal + m;
  p->anchor = p->weight + m;
  p->c = p->anchor + m;
  for (int i = 0; i < m; ++i) {
    p->diagonal[i] = s->S[i + i * m];
    p->c[i] = s->c[i];
    p->weight[i] = which > 1 ? (mg_real)0.1 + 3 * mg_path_scatter(i + 7 * which) : (mg_real)1;
    p->anchor[i] = s->y[i] = 0;
  }
  for (int c = 0; c < s->n && which > 1; ++c) p->anchor[s->normal[c]] = 2 * mg_path_scatter(c + 11 * which);
}

/* The problem at `along`, 0..1: at 1 the given one. */
static void mg_path_set(mg_path *p, mg_real along)
{
  mg_frictional *s = p->s;
  const mg_real delta = p->relaxed || along >= 1 ? 0 : (mg_real)pow(MG_PATH_SOFT, along);
  s->theta = p->relaxed ? 1 - along : (mg_real)(s->given->law == MG_RELAXED);
  s->residual = MG_MAX;
  for (int i = 0; i < s->m; ++i) {
    s->S[i + i * s->m] = p->diagonal[i] + delta * p->weight[i];
    s->c[i] = p->c[i] - delta * p->weight[i] * p->anchor[i];
  }
}

static int mg_path_correct(mg_path *p)
{
  mg_frictional *s = p->s;
  for (int augmented = 0; augmented <= 1; ++augmented) {
    for (int i = 0; i < s->m; ++i) s->y[i] = p->last[i];
    if (mg_friction_newton(s, MG_PATH_NEWTON, augmented)) break;
  }
  if (!(s->residual <= s->tolerance)) return 0;
  for (int i = 0; i < s->m; ++i) p->last[i] = s->best[i];
  return 1;
}

static void mg_path_begin(mg_path *p)
{
  mg_frictional *s = p->s;
  mg_path_set(p, 0);
  if (!mg_friction_sweep(s, MG_PATH_SWEEPS)) mg_friction_newton(s, MG_PATH_SWEEPS, 0);
  for (int i = 0; i < s->m; ++i) p->last[i] = s->best[i];
}

/* Path 0 begins at the relaxed law, 1 at S + I, others at other definite matrices and offsets. */
static void mg_friction_follow(mg_frictional *s, int which)
{
  mg_path p;
  mg_real along = 0, step = (mg_real)0.1;
  mg_path_open(&p, s, which);
  mg_path_begin(&p);
  for (int tries = 0; tries < MG_PATH_STEPS && along < 1 && step > MG_PATH_LEAST; ++tries) {
    mg_real next = along + step < 1 ? along + step : 1;
    mg_path_set(&p, next);
    if (mg_path_correct(&p)) {
      along = next;
      step *= 2;
    } else {
      step /= 3;
    }
  }
  mg_path_set(&p, 1);
  for (int i = 0; i < s->m; ++i) s->y[i] = p.last[i];
  mg_friction_motion(s);
  mg_friction_keep(s);
}
