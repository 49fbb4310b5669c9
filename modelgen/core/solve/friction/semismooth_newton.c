/* Semismooth Newton method on the natural map of the contacts that carry force (Alart and Curnier, Comput. Methods
   Appl. Mech. Eng. 92 (1991), 353-375); the forces of the others are set to zero. The matrix is that of S +
   tikhonov I, which keeps forces that rank deficiency leaves free near where they are; the residual is that of S.
   A step that the nonmonotone line search rejects is replaced by a step of regularised least squares, on a graph by one
   with a larger shift in place of tikhonov, which is then lowered again.

   phi is smooth as long as no contact changes its mode: begins or ends to press, to stick. Where S is singular there
   may be no solution in the present modes, and least squares end at forces that no step in them improves. The step of S
   + tikhonov I is then along forces that leave v as it is, in the sense in which they would lower phi; the iteration
   goes on from where the first contact changes its mode along it. */
#include "solve/friction/friction_solvers.h"
#include "base/base.h"

#define MG_GRAPH_SHIFT_FIRST ((mg_real)sqrt(sqrt(MG_EPS))) /* of S: what a sticking contact on a graph yields */
#define MG_GRAPH_SHIFT_MIN ((mg_real)sqrt(MG_EPS))
#define MG_GRAPH_SHIFT_MAX 100
#define MG_GRAPH_SHIFT_CHANGE 4 /* after a step, and after one that is rejected */

enum {
  MG_LINE_SEARCH_HALVINGS = 10, /* most halvings of a step */
  MG_GRAPH_HALVINGS = 2,        /* the same on a graph */
  MG_LINE_SEARCH_MEMORY = 4,    /* merits of which the largest must be undercut */
  MG_NEWTON_PATIENCE = 8,       /* most steps in a row that do not halve the least merit */
  MG_GRAPH_PATIENCE = 20,       /* the same on a graph, where a step costs less */
  MG_STEPS_OF_CHANGE = 4        /* steps to a change of a mode */
};

typedef struct {
  mg_scaled_friction *s;
  int k, augmented;          /* rows in play; the radius of slip is y_n - slack instead of y_n */
  int *index, *swap, *place; /* rows in play; pivots; per row its place among them or -1 */
  mg_real *J, *normal;       /* k by k; J'J + damping */
  mg_real *phi, *right, *step, *image, *y, *v;
  mg_real gy[MG_ROWS * MG_ROWS], gv[MG_ROWS * MG_ROWS]; /* of one contact, row by row */
  mg_real before[MG_LINE_SEARCH_MEMORY];
  int has_changed; /* the step led to a change of a mode */
  mg_real shift;   /* of S, of a problem on a graph */
} mg_semismooth;

/* Steps that are left, and their progress. */
typedef struct {
  int left, slow;          /* steps; in a row without progress */
  int changes;             /* changes of modes for which more steps are granted */
  mg_real halved, changed; /* merits: the least of those that halved it; at the last change */
} mg_newton_steps;

/* Divides the memory. */
static void mg_semismooth_open(mg_semismooth *n, mg_scaled_friction *s) {
  const int m = s->graph.J ? 0 : s->m, rows = mg_friction_rows(s);
  mg_real **vectors[] = {&n->phi, &n->right, &n->step, &n->image, &n->y, &n->v};
  n->s = s;
  n->J = s->work;
  n->normal = n->J + m * m;
  for (int i = 0; i < 6; ++i) *vectors[i] = n->normal + m * m + i * rows;
  n->index = s->iwork;
  n->swap = n->index + m;
  n->place = n->swap + m;
}

/* phi of one part of a contact with force, and its rows of the derivatives gy and gv. */
static void mg_semismooth_part(mg_semismooth *n, int contact, int part, mg_real radius) {
  const mg_scaled_friction *s = n->s;
  const int k = s->part_dim[part], row = s->part_row[part], at = row - s->normal[contact];
  const mg_real rho = s->rho[part], root = (mg_real)sqrt(rho);
  mg_real q[2] = {0, 0}, size, ratio;
  for (int i = 0; i < k; ++i) q[i] = s->y[row + i] - s->v[row + i] / rho;
  size = mg_friction_norm(k, q);
  if (size <= radius) {
    for (int i = 0; i < k; ++i) {
      n->phi[row + i] = s->v[row + i] / root;
      n->gv[(at + i) * MG_ROWS + at + i] = 1 / root;
    }
    return;
  }
  ratio = radius / size;
  for (int i = 0; i < k; ++i) {
    mg_real *gy = n->gy + (at + i) * MG_ROWS, *gv = n->gv + (at + i) * MG_ROWS;
    n->phi[row + i] = root * (s->y[row + i] - ratio * q[i]);
    for (int j = 0; j < k; ++j) {
      const mg_real across = ratio * ((mg_real)(i == j) - q[i] * q[j] / (size * size));
      gy[at + j] = root * ((mg_real)(i == j) - across);
      gv[at + j] = across / root;
    }
    if (radius > 0) gy[0] = -root * q[i] / size;
    for (int j = 0; n->augmented && j < MG_ROWS; ++j) gv[j] += root * q[i] / size * n->gv[j];
  }
}

/* phi of a contact; gy and gv if it carries force (returns 1). Row 0 of gv is the derivative of the slack. */
static int mg_semismooth_contact(mg_semismooth *n, int contact) {
  const mg_scaled_friction *s = n->s;
  const int from = s->normal[contact], to = mg_friction_row_end(s, contact);
  const mg_real slack = mg_friction_slack(s, contact), force = s->y[from];
  if (!(force - slack > 0)) {
    n->phi[from] = s->y[from];
    for (int p = s->part[contact]; p < s->part[contact + 1]; ++p)
      for (int i = s->part_row[p]; i < s->part_row[p] + s->part_dim[p]; ++i)
        n->phi[i] = s->y[i] * (mg_real)sqrt(s->rho[p]);
    return 0;
  }
  for (int i = 0; i < (to - from) * MG_ROWS; ++i) n->gy[i] = n->gv[i] = 0;
  n->phi[from] = slack;
  n->gv[0] = 1;
  for (int p = s->part[contact]; s->theta > 0 && p < s->part[contact + 1]; ++p) {
    const mg_real *v = s->v + s->part_row[p], size = mg_friction_norm(s->part_dim[p], v);
    for (int i = 0; i < s->part_dim[p]; ++i) n->gv[s->part_row[p] - from + i] = size > 0 ? -s->theta * v[i] / size : 0;
  }
  for (int p = s->part[contact]; p < s->part[contact + 1]; ++p)
    mg_semismooth_part(n, contact, p, n->augmented ? force - slack : force > 0 ? force : 0);
  return 1;
}

/* Sum of the squares of phi. */
static mg_real mg_semismooth_merit(mg_semismooth *n) {
  mg_real sum = 0;
  for (int c = 0; c < n->s->n; ++c) mg_semismooth_contact(n, c);
  for (int i = n->s->m; i < mg_friction_rows(n->s); ++i) n->phi[i] = n->s->v[i];
  for (int i = 0; i < mg_friction_rows(n->s); ++i) sum += n->phi[i] * n->phi[i];
  return sum;
}

/* Rows of J of a contact, and on the right-hand side the effect of the forces that are set to zero. */
static void mg_semismooth_rows(mg_semismooth *n, int contact, mg_real shift) {
  const mg_scaled_friction *s = n->s;
  const int m = s->m, from = s->normal[contact], width = mg_friction_row_end(s, contact) - from;
  for (int i = 0; i < width; ++i) {
    const mg_real *gv = n->gv + i * MG_ROWS, *gy = n->gy + i * MG_ROWS;
    const int row = n->place[from + i];
    n->right[row] = -n->phi[from + i];
    for (int j = 0; j < m; ++j) {
      const mg_real *column = s->S + from + j * m;
      mg_real sum = 0;
      for (int l = 0; l < width; ++l) sum += gv[l] * column[l];
      if (n->place[j] >= 0) n->J[row + n->place[j] * n->k] = sum;
      else n->right[row] += sum * s->y[j];
    }
    for (int l = 0; l < width; ++l) n->J[row + (row - i + l) * n->k] += gy[l] + shift * gv[l];
  }
}

/* Chooses the rows of the contacts with force, and assembles J and the right-hand side. */
static void mg_semismooth_assemble(mg_semismooth *n, mg_real shift) {
  const mg_scaled_friction *s = n->s;
  n->k = 0;
  for (int c = 0; c < s->n; ++c) {
    const int presses = mg_semismooth_contact(n, c);
    for (int i = s->normal[c]; i < mg_friction_row_end(s, c); ++i) {
      n->place[i] = presses ? n->k : -1;
      if (presses) n->index[n->k++] = i;
    }
  }
  for (int c = 0; c < s->n; ++c)
    if (mg_semismooth_contact(n, c)) mg_semismooth_rows(n, c, shift);
}

/* Step of all rows, and its image S step, from that of the chosen rows. */
static void mg_semismooth_expand_step(mg_semismooth *n, const mg_real *x) {
  const mg_scaled_friction *s = n->s;
  const int m = s->m;
  for (int i = 0; i < m; ++i) {
    n->step[i] = n->place[i] >= 0 ? x[n->place[i]] : -s->y[i];
    n->image[i] = 0;
  }
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < m; ++i) n->image[i] += s->S[i + j * m] * n->step[j];
}

/* Regularised least squares: (J'J + damping I) x = J' right. */
static void mg_semismooth_damped_step(mg_semismooth *n, mg_real damping, mg_real *x) {
  const int k = n->k;
  for (int j = 0; j < k; ++j) {
    x[j] = 0;
    for (int r = 0; r < k; ++r) x[j] += n->J[r + j * k] * n->right[r];
    for (int i = j; i < k; ++i) {
      mg_real sum = i == j ? damping : 0;
      for (int r = 0; r < k; ++r) sum += n->J[r + i * k] * n->J[r + j * k];
      n->normal[i + j * k] = sum;
    }
  }
  mg_cholesky(k, n->normal);
  mg_cholesky_solve(k, n->normal, x);
}

/* J x = right; returns 0 if J is singular. */
static int mg_semismooth_lu_step(mg_semismooth *n, mg_real *x) {
  const int k = n->k;
  for (int i = 0; i < k * k; ++i) n->normal[i] = n->J[i];
  if (!(mg_lu(k, n->normal, n->swap) > 0)) return 0;
  for (int i = 0; i < k; ++i) x[i] = n->right[i];
  mg_lu_solve(k, n->normal, n->swap, x);
  return 1;
}

/* Shortens the step until the merit falls below the largest of the last few. Returns 0 if it does not. */
static int mg_semismooth_line_search(mg_semismooth *n, int iteration, int halvings) {
  mg_scaled_friction *s = n->s;
  const int rows = mg_friction_rows(n->s);
  mg_real worst = 0, length = 1;
  for (int i = 0; i < MG_LINE_SEARCH_MEMORY && i <= iteration; ++i) worst = n->before[i] > worst ? n->before[i] : worst;
  for (int i = 0; i < rows; ++i) n->y[i] = s->y[i], n->v[i] = s->v[i];
  for (int half = 0; half < halvings; ++half, length /= 2) {
    mg_real merit;
    for (int i = 0; i < rows; ++i) {
      s->y[i] = n->y[i] + length * n->step[i];
      s->v[i] = n->v[i] + length * n->image[i];
    }
    merit = mg_semismooth_merit(n);
    if (merit <= (1 - (mg_real)1e-4 * length) * worst) {
      n->before[(iteration + 1) % MG_LINE_SEARCH_MEMORY] = merit;
      return 1;
    }
  }
  for (int i = 0; i < rows; ++i) s->y[i] = n->y[i], s->v[i] = n->v[i];
  return 0;
}

/* True if no step in the present modes lowers the merit by much: J' right is small. */
static int mg_semismooth_is_stationary(const mg_semismooth *n) {
  const mg_real small = (mg_real)1e-2 * mg_max_abs(n->k, n->right);
  for (int j = 0; j < n->k; ++j) {
    mg_real slope = 0;
    for (int r = 0; r < n->k; ++r) slope += n->J[r + j * n->k] * n->right[r];
    if (fabs(slope) > small) return 0;
  }
  return 1;
}

/* Least positive root of a + 2 b x + c x^2; MG_MAX if there is none. */
static mg_real mg_least_positive_root(mg_real a, mg_real b, mg_real c) {
  const mg_real square = b * b - a * c;
  if (!(square > 0)) return MG_MAX;
  const mg_real sum = -b - (b > 0 ? (mg_real)sqrt(square) : -(mg_real)sqrt(square));
  const mg_real roots[2] = {a / sum, sum / c};
  mg_real least = MG_MAX;
  for (int i = 0; i < 2; ++i)
    if (roots[i] > 0 && roots[i] < least) least = roots[i];
  return least;
}

/* Part of the step after which a part of a contact begins to slip or to stick, by Coulomb's law. */
static mg_real mg_semismooth_part_change(const mg_semismooth *n, int part, mg_real radius, mg_real radius_step) {
  const mg_scaled_friction *s = n->s;
  mg_real a = -radius * radius, b = -radius * radius_step, c = -radius_step * radius_step;
  for (int i = s->part_row[part]; i < s->part_row[part] + s->part_dim[part]; ++i) {
    const mg_real q = s->y[i] - s->v[i] / s->rho[part], step = n->step[i] - n->image[i] / s->rho[part];
    a += q * q, b += q * step, c += step * step;
  }
  return mg_least_positive_root(a, b, c);
}

/* Part of the step after which the first contact changes its mode, by Coulomb's law. */
static mg_real mg_semismooth_first_change(const mg_semismooth *n) {
  const mg_scaled_friction *s = n->s;
  mg_real first = MG_MAX;
  for (int c = 0; c < s->n; ++c) {
    const int row = s->normal[c];
    const mg_real press = s->y[row] - s->v[row], press_step = n->step[row] - n->image[row];
    const mg_real radius = n->augmented ? press : s->y[row], radius_step = n->augmented ? press_step : n->step[row];
    if (-press / press_step > 0) first = mg_min(first, -press / press_step);
    for (int p = s->part[c]; p < s->part[c + 1] && press > 0; ++p)
      first = mg_min(first, mg_semismooth_part_change(n, p, radius, radius_step));
  }
  return first;
}

/* Goes along the step to just beyond the first change of a mode. Returns 0 if the step is shorter. */
static int mg_semismooth_change_mode(mg_semismooth *n, int iteration) {
  mg_scaled_friction *s = n->s;
  const mg_real length = s->theta > 0 ? MG_MAX : (1 + (mg_real)1e-6) * mg_semismooth_first_change(n);
  if (!(length < 1)) return 0;
  for (int i = 0; i < s->m; ++i) s->y[i] += length * n->step[i], s->v[i] += length * n->image[i];
  n->before[(iteration + 1) % MG_LINE_SEARCH_MEMORY] = mg_semismooth_merit(n);
  return n->has_changed = 1;
}

/* One step of a problem on a graph, of which little is known where contacts change their modes: it is short where the
   steps before were rejected (Levenberg, Quart. Appl. Math. 2 (1944), 164-168). Returns 0 if all are rejected. */
static int mg_semismooth_graph_step(mg_semismooth *n, int iteration) {
  mg_scaled_friction *s = n->s;
  for (; s->graph.has_system && n->shift < MG_GRAPH_SHIFT_MAX && !mg_friction_is_stopped(s);
       n->shift *= MG_GRAPH_SHIFT_CHANGE) {
    int is_regular = 1;
    mg_graph_begin_step(s, n->shift);
    for (int c = 0; c < s->n; ++c) {
      const int presses = mg_semismooth_contact(n, c);
      is_regular &= mg_graph_add_contact(s, c, presses, n->shift, n->gy, n->gv, n->phi + s->normal[c]);
    }
    if (!is_regular || !mg_graph_factor_step(s) || !mg_graph_solve_step(s, n->step, n->image) ||
        !mg_semismooth_line_search(n, iteration, MG_GRAPH_HALVINGS))
      continue;
    n->shift = mg_max(n->shift / MG_GRAPH_SHIFT_CHANGE, MG_GRAPH_SHIFT_MIN);
    return 1;
  }
  return 0;
}

/* One step; returns 0 if all are rejected. */
static int mg_semismooth_step(mg_semismooth *n, int iteration) {
  mg_real *x = n->y;
  if (n->s->graph.J) return mg_semismooth_graph_step(n, iteration);
  mg_semismooth_assemble(n, MG_LCP_TIKHONOV);
  if (mg_semismooth_lu_step(n, x)) {
    mg_semismooth_expand_step(n, x);
    if (mg_semismooth_line_search(n, iteration, MG_LINE_SEARCH_HALVINGS)) return 1;
    if (mg_semismooth_is_stationary(n) && mg_semismooth_change_mode(n, iteration)) return 1;
    mg_semismooth_assemble(n, MG_LCP_TIKHONOV);
  }
  for (mg_real damping = (mg_real)1e-6; damping < 10 && !mg_friction_is_stopped(n->s); damping *= 100) {
    mg_semismooth_damped_step(n, damping, x);
    mg_semismooth_expand_step(n, x);
    if (mg_semismooth_line_search(n, iteration, 3)) return 1;
    mg_semismooth_assemble(n, MG_LCP_TIKHONOV);
  }
  return 0;
}

/* Counts a step from a merit: steps->slow is the number of steps in a row that have not halved the least merit. The way
   to a change of a mode does not count if it begins at a lesser merit than that to the change before. */
static void mg_count_newton_step(mg_newton_steps *steps, mg_real merit, int changed) {
  const int is_progress = merit < steps->halved / 2,
            is_change = changed && steps->changes > 0 && merit < (mg_real)0.999 * steps->changed;
  steps->slow = is_progress || is_change ? 0 : steps->slow + 1;
  if (is_progress) steps->halved = merit;
  if (is_change) steps->left += MG_STEPS_OF_CHANGE, --steps->changes;
  if (changed) steps->changed = merit;
  --steps->left;
}

MG_INTERNAL int mg_friction_newton(mg_scaled_friction *s, int limit, int augmented) {
  mg_semismooth n = {0};
  mg_newton_steps steps = {limit, 0, s->n, MG_MAX, MG_MAX};
  const int patience = s->graph.J ? MG_GRAPH_PATIENCE : MG_NEWTON_PATIENCE;
  mg_semismooth_open(&n, s);
  n.augmented = augmented, n.shift = MG_GRAPH_SHIFT_FIRST;
  mg_friction_update_motion(s);
  n.before[0] = mg_semismooth_merit(&n);
  for (int iteration = 0;
       !mg_friction_is_stopped(s) && steps.left > 0 && steps.slow <= (mg_friction_is_accepted(s) ? 0 : patience);
       ++iteration) {
    const mg_real merit = n.before[iteration % MG_LINE_SEARCH_MEMORY];
    n.has_changed = 0;
    const int is_taken = mg_semismooth_step(&n, iteration);
    ++s->newton;
    if (!is_taken) return mg_friction_update_best(s);
    mg_count_newton_step(&steps, merit, n.has_changed);
    if (iteration % MG_LINE_SEARCH_MEMORY == MG_LINE_SEARCH_MEMORY - 1) mg_friction_update_motion(s);
    if (mg_friction_update_best(s)) {
      mg_friction_update_motion(s);
      return mg_friction_update_best(s);
    }
  }
  return mg_friction_update_best(s);
}
