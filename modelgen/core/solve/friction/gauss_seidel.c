/* Projected block Gauss-Seidel over the contacts (Jourdan, Alart and Jean, Comput. Methods Appl. Mech. Eng. 155
   (1998), 31-47). The problem of one contact, with the others fixed, is solved exactly for N and slip, then for
   spin and rolling with N given. On a graph, where there are more sweeps than one, two passes over its rows take its
   place, and for the relaxed law a projected gradient step. */
#include "solve/friction/friction_solvers.h"
#include "base/base.h"

enum {
  MG_LOCAL_PASSES = 2,       /* over the rows of a contact in a sweep on a graph */
  MG_DISC_ROOT_STEPS = 40,   /* most steps of the root finder */
  MG_DISC_BRACKET_STEPS = 80 /* most steps in search of a bracket */
};

/* A disc of friction forces f: T f + c = -alpha f, |f| <= N = base + slope.f; alpha = 0: it sticks. */
typedef struct {
  int k;            /* components of f: 1 or 2 */
  mg_real T[4];     /* matrix, by columns */
  mg_real c[2];     /* motion without f */
  mg_real slope[2]; /* derivative of N by f */
  mg_real base;     /* N without f */
} mg_disc;

/* f = -(T + alpha I)^-1 c. Returns 0 if that is singular. */
static int mg_disc_force(const mg_disc *d, mg_real alpha, mg_real *f) {
  mg_real a = d->T[0] + alpha, b = d->T[3] + alpha, determinant;
  if (d->k == 1) {
    if (!(a > MG_LCP_RANK(1))) return 0;
    f[0] = -d->c[0] / a;
    return 1;
  }
  determinant = a * b - d->T[1] * d->T[2];
  if (!(a > 0 && b > 0 && determinant > MG_LCP_RANK(1) * a * b)) return 0;
  f[0] = (d->T[2] * d->c[1] - b * d->c[0]) / determinant;
  f[1] = (d->T[1] * d->c[0] - a * d->c[1]) / determinant;
  return 1;
}

/* N = base + slope.f. */
static mg_real mg_disc_radius(const mg_disc *d, const mg_real *f) {
  mg_real radius = d->base;
  for (int i = 0; i < d->k; ++i) radius += d->slope[i] * f[i];
  return radius;
}

/* N - |f| at alpha; -MG_MAX where the force is not defined. */
static mg_real mg_disc_slack(const mg_disc *d, mg_real alpha, mg_real *f) {
  if (!mg_disc_force(d, alpha, f)) return -MG_MAX;
  return mg_disc_radius(d, f) - mg_friction_norm(d->k, f);
}

/* Root of the slack in alpha between a negative and a positive end, by false position that is halved where it
   stalls. */
static void mg_disc_root(const mg_disc *d, mg_real low, mg_real slack_low, mg_real high, mg_real slack_high,
                         mg_real *f) {
  int side = 0;
  for (int i = 0; i < MG_DISC_ROOT_STEPS; ++i) {
    mg_real middle = (low + high) / 2, slack;
    if (slack_low > -1 / MG_EPS) middle = high - slack_high * (high - low) / (slack_high - slack_low);
    if (!(middle > low && middle < high)) middle = (low + high) / 2;
    slack = mg_disc_slack(d, middle, f);
    if (fabs(slack) <= 4 * MG_EPS * mg_friction_norm(d->k, f) || high - low <= 4 * MG_EPS * high) return;
    if (slack < 0) {
      low = middle, slack_low = slack;
      if (side == -1) slack_high /= 2;
      side = -1;
    } else {
      high = middle, slack_high = slack;
      if (side == 1) slack_low /= 2;
      side = 1;
    }
  }
}

/* Force of one disc: that of sticking if the cone contains it, else that of sliding. base > 0, so that a root
   exists. */
static void mg_disc_solve(const mg_disc *d, mg_real *f) {
  mg_real slack = mg_disc_slack(d, 0, f), low = 0, high, slack_high = 0;
  if (slack >= 0) return;
  high = (mg_real)fabs(d->T[0]) + (mg_real)fabs(d->T[3]);
  if (!(high > 0)) high = 1;
  for (int i = 0; i < MG_DISC_BRACKET_STEPS; ++i) {
    slack_high = mg_disc_slack(d, high, f);
    if (slack_high >= 0) break;
    low = high;
    slack = slack_high;
    high *= 4;
  }
  if (slack_high > 0) mg_disc_root(d, low, slack, high, slack_high, f);
}

/* v of a row if the forces of rows from..to were y: motion with the contact's own forces replaced. */
static mg_real mg_local_motion(const mg_scaled_friction *s, int row, int from, int to, const mg_real *y) {
  mg_real b = s->v[row];
  for (int j = from; j < to; ++j) b += s->S[row + j * s->m] * (y[j - from] - s->y[j]);
  return b;
}

/* Sets up the disc of a part of a contact whose rows are from..to, with N = y[0] given (held) or in balance. */
static void mg_set_disc(const mg_scaled_friction *s, int part, int from, int to, int held, mg_real *y, mg_disc *d) {
  const int m = s->m, row = s->part_row[part];
  const mg_real a = s->S[from + from * m];
  mg_real b;
  d->k = s->part_dim[part];
  d->T[3] = 0;
  for (int i = 0; i < d->k; ++i) y[row - from + i] = 0;
  if (!held) y[0] = 0;
  b = held ? 0 : mg_local_motion(s, from, from, to, y);
  d->base = held ? y[0] : -b / a;
  for (int i = 0; i < d->k; ++i) {
    d->c[i] = mg_local_motion(s, row + i, from, to, y);
    d->slope[i] = held ? 0 : -s->S[from + (row + i) * m] / a;
  }
  for (int i = 0; i < d->k; ++i) {
    if (!held) d->c[i] += s->S[row + i + from * m] * d->base;
    for (int j = 0; j < d->k; ++j) {
      d->T[i + 2 * j] = s->S[row + i + (row + j) * m];
      if (!held) d->T[i + 2 * j] += s->S[row + i + from * m] * d->slope[j];
    }
  }
  if (d->k == 1) d->T[3] = d->T[0];
}

/* Solves one contact with the others fixed. y: its rows, the solution on return. */
static void mg_solve_friction_contact(const mg_scaled_friction *s, int contact, mg_real *y) {
  const int from = s->normal[contact], to = mg_friction_row_end(s, contact);
  int part = s->part[contact];
  mg_disc d;
  mg_real b;
  y[0] = 0;
  for (int p = part; p < s->part[contact + 1] && s->part_mark[p] == MG_MARK_SLIP; ++p)
    for (int i = 0; i < s->part_dim[p]; ++i) y[s->part_row[p] - from + i] = 0;
  b = mg_local_motion(s, from, from, to, y);
  if (b >= 0 || !(s->S[from + from * s->m] > MG_LCP_RANK(s->m))) {
    for (int i = from; i < to; ++i) y[i - from] = 0;
    return;
  }
  y[0] = -b / s->S[from + from * s->m];
  if (part < s->part[contact + 1] && s->part_mark[part] == MG_MARK_SLIP) {
    mg_set_disc(s, part, from, to, 0, y, &d);
    mg_disc_solve(&d, y + s->part_row[part] - from);
    y[0] = mg_disc_radius(&d, y + s->part_row[part] - from);
    ++part;
  }
  for (; part < s->part[contact + 1]; ++part) {
    mg_set_disc(s, part, from, to, 1, y, &d);
    mg_disc_solve(&d, y + s->part_row[part] - from);
  }
}

/* Replaces the contact's rows y by the nearest point of the cone |f_p| <= N, for every part p. */
static void mg_project_on_cone(const mg_scaled_friction *s, int contact, mg_real *y) {
  const int from = s->normal[contact], first = s->part[contact], parts = s->part[contact + 1] - first;
  mg_real N = y[0], size[3];
  for (int p = 0; p < parts; ++p) size[p] = mg_friction_norm(s->part_dim[first + p], y + s->part_row[first + p] - from);
  for (int pass = 0; pass <= parts; ++pass) {
    mg_real sum = y[0];
    int count = 1;
    for (int p = 0; p < parts; ++p)
      if (size[p] > N) sum += size[p], ++count;
    N = sum / (mg_real)count;
  }
  y[0] = N > 0 ? N : 0;
  for (int p = 0; p < parts; ++p)
    for (int i = 0; i < s->part_dim[first + p] && size[p] > y[0]; ++i)
      y[s->part_row[first + p] - from + i] *= y[0] / size[p];
}

/* Entry of S on the diagonal. */
static mg_real mg_own_entry(const mg_scaled_friction *s, int row) {
  return s->graph.J ? mg_graph_entry(&s->graph, row, row) : s->S[row + row * s->m];
}

/* One projected gradient step of the convex program in the rows of a contact. */
static void mg_projected_gradient_step(const mg_scaled_friction *s, int contact, mg_real *y) {
  const int from = s->normal[contact], to = mg_friction_row_end(s, contact);
  mg_real trace = 0;
  for (int i = from; i < to; ++i) trace += mg_own_entry(s, i);
  for (int i = from; i < to && trace > 0; ++i) y[i - from] -= s->v[i] / trace;
  mg_project_on_cone(s, contact, y);
}

/* On a graph: v of a row if the forces of the contact were y. */
static mg_real mg_motion_on_graph(const mg_scaled_friction *s, int contact, int row, const mg_real *y) {
  const int from = s->normal[contact], to = mg_friction_row_end(s, contact);
  const mg_real *S = s->graph.block + (long)MG_BLOCK_SIZE * contact + row - from;
  mg_real b = s->v[row];
  for (int j = 0; j < to - from; ++j) b += S[MG_ROWS * j] * (y[j] - s->y[from + j]);
  return b;
}

/* On a graph: moves the forces of one contact towards the solution with the others fixed: the normal force, then the
   forces of each part by a projected gradient step, MG_LOCAL_PASSES times. Costs a fifth of the exact solution; where
   it moves nothing, the forces are that. */
static void mg_approach_friction_contact(const mg_scaled_friction *s, int contact, mg_real *y) {
  const int from = s->normal[contact], to = mg_friction_row_end(s, contact);
  const mg_real own = s->graph.block[(long)MG_BLOCK_SIZE * contact];
  for (int i = from; i < to && !(own > 0); ++i) y[i - from] = 0; /* no force moves it */
  if (!(own > 0)) return;
  for (int pass = 0; pass < MG_LOCAL_PASSES; ++pass) {
    y[0] = mg_max(y[0] - mg_motion_on_graph(s, contact, from, y) / own, (mg_real)0);
    for (int p = s->part[contact]; p < s->part[contact + 1]; ++p) {
      const int row = s->part_row[p], k = s->part_dim[p];
      mg_real q[2] = {0, 0};
      for (int i = 0; i < k; ++i) q[i] = y[row - from + i] - mg_motion_on_graph(s, contact, row + i, y) / s->rho[p];
      const mg_real size = mg_friction_norm(k, q), part = size > y[0] ? y[0] / size : 1;
      for (int i = 0; i < k; ++i) y[row - from + i] = part * q[i];
    }
  }
}

/* Replaces the forces of one contact and updates v, on a graph the motion of the bodies. */
static void mg_update_friction_contact(mg_scaled_friction *s, int contact) {
  const int m = s->m, from = s->normal[contact], to = mg_friction_row_end(s, contact);
  mg_real y[MG_ROWS];
  if (s->graph.J) mg_graph_update_rows(s, from, to);
  for (int j = from; j < to; ++j) y[j - from] = s->y[j];
  if (s->theta > 0) mg_projected_gradient_step(s, contact, y);
  else if (s->graph.J) mg_approach_friction_contact(s, contact, y);
  else mg_solve_friction_contact(s, contact, y);
  for (int j = from; j < to; ++j) {
    const mg_real step = y[j - from] - s->y[j];
    if (!(fabs(step) > 0)) continue;
    if (s->graph.J) mg_graph_add_force(&s->graph, j, step, s->graph.motion);
    else
      for (int i = 0; i < m; ++i) s->v[i] += s->S[i + j * m] * step;
    s->y[j] = y[j - from];
  }
}

/* Solves the contacts one after another, forwards or backwards, with the forces of the others as they are. */
static void mg_friction_sweep_once(mg_scaled_friction *s, int backwards) {
  if (backwards) mg_graph_sweep_free_rows(s, 1);
  for (int c = 0; c < s->n; ++c) mg_update_friction_contact(s, backwards ? s->n - 1 - c : c);
  if (!backwards) mg_graph_sweep_free_rows(s, 0);
  ++s->sweeps;
}

MG_INTERNAL int mg_friction_sweep(mg_scaled_friction *s, int sweeps) {
  mg_friction_update_motion(s);
  for (int sweep = 0; sweep < sweeps && !mg_friction_is_stopped(s); ++sweep) {
    mg_friction_sweep_once(s, (sweep + s->given->from_last) % 2);
    if (s->graph.J) mg_graph_update_rows(s, 0, mg_friction_rows(s));
    if (mg_friction_error(s) <= mg_max(mg_friction_tolerance(s, s->y), s->graph.J ? s->given->accepted : 0)) break;
  }
  mg_friction_update_motion(s);
  return mg_friction_update_best(s);
}
