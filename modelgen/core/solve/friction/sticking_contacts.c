/* Contacts that stick although their rows are dependent, as where a body is held against another at several points:
   forces are then not unique. Proves that every solution of Coulomb's law has the accelerations of the given one.

   With the scaled matrix S = L L', and z the given forces, of which w = 0, another solution has w = L d, d = L'z2 - F,
   F = L'z. In it each contact opens (z2 = 0, w_n >= 0), sticks (w = 0), or slips along a unit vector t (w_n = 0, f2 =
   -mu N2 t, w_t = s t, s > 0). In these modes, for directions t within arcs, a sum of forces L L'z2, the vector -L F
   and motions -w is zero. That is excluded by a vector y with
   - y'L = 0, and y'(-w) > 0 for all motions: bodies cannot move so; if L has full rank, so that w = 0 means d = 0; or
   - y'x > 0 for each force, for -L F, and for each motion.
   y is sought as the nearest point to the origin of the convex hull of these vectors (Wolfe, Math. Program. 11 (1976),
   128-149). Arcs are halved until it is found. Contacts that stick in the other solution take part by their rows and
   cones, or else their rows restrict d, and their forces are any. */
#include "solve/friction/solvers.h"
#include "base/base.h"

enum {
  MG_HELD_CONTACTS = 4,
  MG_HELD_ROWS = 3 * MG_HELD_CONTACTS,
  MG_HELD_CELLS = 4000, /* most combinations of modes and arcs that a proof looks at */
  MG_NEAREST_STEPS = 40 /* most steps of the search for a nearest point */
};

#define MG_HELD_MARGIN (mg_real)(16 * sqrt(MG_EPS))  /* what y'x must exceed, |y| = 1 */
#define MG_HELD_CLEAR (mg_real) sqrt(MG_HELD_MARGIN) /* length that a vector must exceed to count for a rank */
#define MG_HELD_NOISE (mg_real) sqrt(MG_EPS)         /* length up to which it is zero */
#define MG_HELD_NARROW (1 - MG_HELD_MARGIN)          /* cosine of half an arc that is not halved */

typedef enum { MG_OPENS, MG_STICKS, MG_SLIPS } mg_contact_mode;

typedef mg_real mg_held_vector[MG_HELD_ROWS];

/* Unit vectors within an angle of t, of which cosine and sine are given. */
typedef struct {
  mg_real t[2], cosine, sine;
} mg_slip_arc;

/* The rows that count in given modes. */
typedef struct {
  int has_cones;                      /* 1: among them those of contacts that stick, with their cones */
  int n_row, row[MG_HELD_ROWS];       /* rows of the problem */
  int first[MG_HELD_CONTACTS];        /* place of the normal row of a contact among them */
  int n_image;                        /* rank of the rows if they are dependent and determine d, otherwise 0 */
  mg_held_vector image[MG_HELD_ROWS]; /* orthonormal basis of their image */
  mg_held_vector L[MG_HELD_ROWS], F;  /* of all rows of the problem, for the motions d that are left */
} mg_held_rows;

typedef struct {
  int n, rank;                            /* contacts, columns of L */
  int cells;                              /* combinations of modes and arcs so far */
  mg_real mu[MG_HELD_CONTACTS];           /* coefficients of friction */
  mg_held_vector L[MG_HELD_ROWS], F;      /* of the scaled problem */
  mg_contact_mode mode[MG_HELD_CONTACTS]; /* modes of another solution */
  int n_view;                             /* ways in which its contacts that stick take part */
  mg_held_rows view[2];                   /* the rows for each of them */
} mg_held_contacts;

/* What the sum of vectors may hold: -L F, the force of a contact, or its motion. */
typedef enum { MG_HELD_LOAD, MG_HELD_FORCE, MG_HELD_MOTION } mg_held_kind;

typedef struct {
  mg_held_kind kind;
  int contact;
  mg_real t[2];  /* direction of slip; of a force that sticks: against its friction */
  mg_real value; /* y'x */
} mg_held_term;

static mg_real mg_held_product(int n, const mg_real *a, const mg_real *b) {
  mg_real sum = 0;
  for (int i = 0; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

/* Takes the components along orthonormal vectors from x. */
static void mg_remove_components(int n, int count, const mg_held_vector *q, mg_real *x) {
  for (int j = 0; j < count; ++j) mg_add_multiple(n, -mg_held_product(n, q[j], x), q[j], x);
}

/* Orthonormal basis q of the span of vectors, which are used up. Returns its size, -1 where the rank is not clear. */
static int mg_find_basis(int n, int count, mg_held_vector *vector, mg_held_vector *q) {
  for (int rank = 0;; ++rank) {
    mg_real longest = 0;
    int most = 0;
    for (int j = 0; j < count; ++j) {
      const mg_real length = (mg_real)sqrt(mg_held_product(n, vector[j], vector[j]));
      if (length > longest) longest = length, most = j;
    }
    if (!(longest > MG_HELD_NOISE)) return rank;
    if (!(longest > MG_HELD_CLEAR)) return -1;
    for (int i = 0; i < n; ++i) q[rank][i] = vector[most][i] / longest;
    for (int j = 0; j < count; ++j) mg_remove_components(n, 1, (const mg_held_vector *)q + rank, vector[j]);
  }
}

/* The unit vector of an arc that is nearest to the direction of x. */
static void mg_nearest_of_arc(const mg_slip_arc *arc, const mg_real *x, mg_real *t) {
  const mg_real along = mg_dot2(arc->t, x), across = mg_cross2(arc->t, x), size = mg_friction_norm(2, x);
  const mg_real sine = across < 0 ? -arc->sine : arc->sine;
  if (along * arc->sine > fabs(across) * arc->cosine && size > 0) {
    t[0] = x[0] / size, t[1] = x[1] / size;
    return;
  }
  t[0] = arc->cosine * arc->t[0] - sine * arc->t[1], t[1] = arc->cosine * arc->t[1] + sine * arc->t[0];
}

/* Keeps the term if it is lower. */
static void mg_keep_lower(mg_held_term *lowest, mg_held_kind kind, int contact, mg_real x, mg_real y, mg_real value) {
  const mg_held_term term = {kind, contact, {x, y}, value};
  if (value < lowest->value) *lowest = term;
}

/* The term with the lowest y'x; with `moves`, of motions alone. */
static mg_held_term mg_lowest_term(const mg_held_contacts *s, const mg_held_rows *v, const mg_slip_arc *arc, int moves,
                                   const mg_real *y) {
  mg_held_term lowest = {MG_HELD_LOAD, 0, {0, 0}, MG_MAX};
  mg_held_vector back = {0};
  for (int i = 0; i < v->n_row && !moves; ++i) mg_add_multiple(s->rank, y[i], v->L[v->row[i]], back);
  if (!moves) mg_keep_lower(&lowest, MG_HELD_LOAD, 0, 0, 0, -mg_held_product(s->rank, back, v->F));
  for (int k = 0; k < s->n; ++k) {
    const mg_real *own = y + v->first[k];
    mg_real q[3], t[2] = {1, 0}, size;
    if (s->mode[k] == MG_OPENS) mg_keep_lower(&lowest, MG_HELD_MOTION, k, 0, 0, -own[0]);
    if (s->mode[k] == MG_SLIPS) {
      mg_nearest_of_arc(arc + k, own + 1, t);
      mg_keep_lower(&lowest, MG_HELD_MOTION, k, t[0], t[1], -mg_dot2(own + 1, t));
    }
    if (moves || s->mode[k] == MG_OPENS || (s->mode[k] == MG_STICKS && !v->has_cones)) continue;
    for (int i = 0; i < 3; ++i) q[i] = mg_held_product(s->rank, v->L[3 * k + i], back);
    size = mg_friction_norm(2, q + 1);
    if (s->mode[k] == MG_SLIPS) mg_nearest_of_arc(arc + k, q + 1, t);
    else if (size > 0) t[0] = q[1] / size, t[1] = q[2] / size;
    mg_keep_lower(&lowest, MG_HELD_FORCE, k, t[0], t[1], q[0] - s->mu[k] * mg_dot2(q + 1, t));
  }
  return lowest;
}

/* The vector of a term; with `moves`, without its part in the image of the rows. */
static void mg_vector_of_term(const mg_held_contacts *s, const mg_held_rows *v, int moves, const mg_held_term *term,
                              mg_real *x) {
  const int k = term->contact;
  mg_held_vector d = {0};
  for (int i = 0; i < v->n_row; ++i) x[i] = 0;
  if (term->kind == MG_HELD_MOTION) {
    mg_real *own = x + v->first[k];
    if (s->mode[k] == MG_OPENS) own[0] = -1;
    else own[1] = -term->t[0], own[2] = -term->t[1];
    if (moves) mg_remove_components(v->n_row, v->n_image, v->image, x);
    return;
  }
  if (term->kind == MG_HELD_LOAD) mg_add_multiple(s->rank, -1, v->F, d);
  else {
    mg_add_multiple(s->rank, 1, v->L[3 * k], d);
    for (int i = 0; i < 2; ++i) mg_add_multiple(s->rank, -s->mu[k] * term->t[i], v->L[3 * k + 1 + i], d);
  }
  for (int i = 0; i < v->n_row; ++i) x[i] = mg_held_product(s->rank, v->L[v->row[i]], d);
}

/* Moves the weights of `count` vectors to their affine combination nearest to the origin, or towards it until the first
   weight is zero, and drops the vectors of weight zero. Returns how many are left. */
static int mg_move_weights(int n, int count, mg_held_vector *vector, mg_real *weight) {
  mg_real G[(MG_HELD_ROWS + 1) * (MG_HELD_ROWS + 1)], to[MG_HELD_ROWS + 1], sum = 0, part = 1;
  int left = 0;
  for (int j = 0; j < count; ++j) {
    to[j] = 1;
    for (int i = j; i < count; ++i) G[i + j * count] = 1 + mg_held_product(n, vector[i], vector[j]);
  }
  mg_cholesky(count, G);
  mg_cholesky_solve(count, G, to);
  for (int j = 0; j < count; ++j) sum += to[j];
  for (int j = 0; j < count; ++j) {
    to[j] /= sum;
    if (!(to[j] > MG_EPS)) part = mg_min(part, weight[j] / (weight[j] - to[j]));
  }
  for (int j = 0; j < count; ++j) {
    const mg_real moved = weight[j] + part * (to[j] - weight[j]);
    if (!(moved > MG_EPS)) continue;
    weight[left] = moved;
    for (int i = 0; i < n; ++i) vector[left][i] = vector[j][i];
    ++left;
  }
  return left;
}

/* True if one vector y excludes the modes, with slip directions of these arcs. */
static int mg_is_separated(const mg_held_contacts *s, const mg_held_rows *v, const mg_slip_arc *arc, int moves) {
  const int n = v->n_row;
  mg_held_vector vector[MG_HELD_ROWS + 1], y = {0};
  mg_real weight[MG_HELD_ROWS + 1];
  int count = 0;
  for (int step = 0; step < MG_NEAREST_STEPS; ++step) {
    const mg_held_term lowest = mg_lowest_term(s, v, arc, moves, y);
    const mg_real length = (mg_real)sqrt(mg_held_product(n, y, y));
    if (count && !(length > MG_HELD_MARGIN)) return 0;
    if (count && lowest.value > MG_HELD_MARGIN * length) return 1;
    if (count && (lowest.value > length * length - MG_HELD_MARGIN * MG_HELD_MARGIN || count > n)) return 0;
    mg_vector_of_term(s, v, moves, &lowest, vector[count]);
    weight[count] = count ? 0 : 1;
    for (int before = count++; before != count && count > 1;)
      before = count, count = mg_move_weights(n, count, vector, weight);
    for (int i = 0; i < n; ++i) y[i] = 0;
    for (int j = 0; j < count; ++j) mg_add_multiple(n, weight[j], vector[j], y);
  }
  return 0;
}

/* True if the modes, with slip directions of these arcs, are excluded. */
static int mg_is_cell_excluded(const mg_held_contacts *s, const mg_slip_arc *arc) {
  for (int k = 0; k < s->n; ++k)
    if (s->mode[k] == MG_SLIPS && !(arc[k].cosine > MG_HELD_CLEAR)) return 0;
  for (int i = 0; i < s->n_view; ++i)
    if ((s->view[i].n_image && mg_is_separated(s, s->view + i, arc, 1)) || mg_is_separated(s, s->view + i, arc, 0))
      return 1;
  return 0;
}

/* One half of an arc: the first for side -1, the second for side 1. */
static mg_slip_arc mg_half_arc(const mg_slip_arc *arc, int side) {
  const mg_real cosine = (mg_real)sqrt((1 + arc->cosine) / 2), sine = (mg_real)sqrt((1 - arc->cosine) / 2);
  const mg_slip_arc half = {
      {cosine * arc->t[0] - (mg_real)side * sine * arc->t[1], cosine * arc->t[1] + (mg_real)side * sine * arc->t[0]},
      cosine,
      sine};
  return half;
}

/* Excludes the modes for all slip directions of these arcs, in parts where that is needed. */
static int mg_are_arcs_excluded(mg_held_contacts *s, const mg_slip_arc *arc) {
  mg_slip_arc part[MG_HELD_CONTACTS];
  int widest = -1;
  if (mg_is_cell_excluded(s, arc)) return 1;
  for (int k = 0; k < s->n; ++k) {
    part[k] = arc[k];
    if (s->mode[k] == MG_SLIPS && (widest < 0 || arc[k].cosine < arc[widest].cosine)) widest = k;
  }
  if (widest < 0 || arc[widest].cosine > MG_HELD_NARROW || ++s->cells > MG_HELD_CELLS) return 0;
  for (int side = -1; side <= 1; side += 2) {
    part[widest] = mg_half_arc(arc + widest, side);
    if (!mg_are_arcs_excluded(s, part)) return 0;
  }
  return 1;
}

/* Lists the rows that count in the present modes. Contacts that stick take part by their cones, or else leave the
   motions d at which their rows are zero. Returns the number of these motions, -1 where it is not clear. */
static int mg_set_held_rows(const mg_held_contacts *s, int has_cones, mg_held_rows *v) {
  mg_held_vector vector[MG_HELD_ROWS], held[MG_HELD_ROWS];
  int n_held = 0, n_image;
  for (int i = 0; i < 3 * s->n; ++i)
    for (int j = 0; j < s->rank; ++j) v->L[i][j] = s->L[i][j];
  for (int j = 0; j < s->rank; ++j) v->F[j] = s->F[j];
  v->has_cones = has_cones, v->n_row = v->n_image = 0;
  for (int k = 0; k < s->n; ++k) {
    const int rows = s->mode[k] == MG_SLIPS ? 3 : s->mode[k] == MG_OPENS ? 1 : has_cones ? 3 : 0;
    v->first[k] = v->n_row;
    for (int i = 0; i < rows; ++i) v->row[v->n_row++] = 3 * k + i;
    for (int i = 0; i < 3 && !rows; ++i, ++n_held)
      for (int j = 0; j < s->rank; ++j) vector[n_held][j] = s->L[3 * k + i][j];
  }
  n_held = mg_find_basis(s->rank, n_held, vector, held);
  if (n_held < 0) return -1;
  for (int i = 0; i < 3 * s->n; ++i) mg_remove_components(s->rank, n_held, (const mg_held_vector *)held, v->L[i]);
  mg_remove_components(s->rank, n_held, (const mg_held_vector *)held, v->F);
  for (int j = 0; j < s->rank; ++j)
    for (int i = 0; i < v->n_row; ++i) vector[j][i] = v->L[v->row[i]][j];
  n_image = mg_find_basis(v->n_row, s->rank, vector, v->image);
  if (n_image == s->rank - n_held && n_image < v->n_row) v->n_image = n_image;
  return s->rank - n_held;
}

/* True if no other solution has the present modes. */
static int mg_are_modes_excluded(mg_held_contacts *s) {
  const mg_slip_arc all = {{1, 0}, -1, 0}, arc[MG_HELD_CONTACTS] = {all, all, all, all};
  int free_motions = -1;
  s->n_view = 0;
  for (int k = 0; k < s->n && free_motions < 0; ++k)
    if (s->mode[k] == MG_STICKS) free_motions = mg_set_held_rows(s, 0, s->view);
  if (free_motions == 0) return 1;
  s->n_view += free_motions > 0;
  mg_set_held_rows(s, 1, s->view + s->n_view++);
  return mg_are_arcs_excluded(s, arc);
}

/* The scaled problem: A_nn = 1, largest |b| 1, S = L L'. Returns 0 if it is none of contacts that all stick, with a
   symmetric matrix of clear rank. */
static int mg_scale_held_contacts(const mg_friction_problem *p, const mg_real *z, mg_held_contacts *s) {
  const int n = p->n;
  mg_real scale[MG_HELD_ROWS], L[MG_HELD_ROWS * MG_HELD_ROWS], rest[MG_HELD_ROWS], size = 0;
  int order[MG_HELD_ROWS];
  if (p->n_contact > MG_HELD_CONTACTS || n != 3 * p->n_contact || n == 0 || p->law != MG_COULOMB) return 0;
  s->n = p->n_contact, s->cells = 0;
  for (int k = 0; k < s->n; ++k) {
    const mg_real *cone = p->cone + MG_CONE * k, entry = p->A[3 * k * (n + 1)];
    if (p->first[k] != 3 * k || p->rows[k] != 3 || !(cone[0] > 0) || cone[0] != cone[1] || !(entry > 0)) return 0;
    s->mu[k] = cone[0];
    for (int i = 3 * k; i < 3 * k + 3; ++i) scale[i] = 1 / (mg_real)sqrt(entry);
  }
  for (int i = 0; i < n; ++i) size = mg_max(size, (mg_real)fabs(p->b[i]) * scale[i]);
  if (!(size > 0) || !(size <= MG_MAX)) return 0;
  for (int i = 0; i < n; ++i) {
    mg_real w = p->b[i];
    for (int j = 0; j < n; ++j) {
      const mg_real odd = p->A[i + j * n] - p->A[j + i * n];
      w += p->A[i + j * n] * z[j], L[i + j * n] = p->A[i + j * n] * scale[i] * scale[j];
      if (!(fabs(odd) * scale[i] * scale[j] <= MG_HELD_MARGIN)) return 0;
    }
    if (!(fabs(w) * scale[i] <= MG_HELD_MARGIN * size)) return 0;
    rest[i] = L[i * (n + 1)];
  }
  s->rank = mg_cholesky_pivoted(n, L, order, MG_HELD_CLEAR);
  for (int j = 0; j < s->rank; ++j) s->F[j] = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < s->rank; ++j) {
      const mg_real entry = j > i ? 0 : L[i + j * n];
      s->L[order[i]][j] = entry, rest[order[i]] -= entry * entry,
      s->F[j] += entry * z[order[i]] / scale[order[i]] / size;
    }
  for (int i = 0; i < n; ++i)
    if (!(fabs(rest[i]) <= MG_LCP_RANK(n) * mg_max(1, L[0] * L[0]))) return 0;
  return 1;
}

MG_API int mg_is_sticking_motion_unique(const mg_friction_problem *problem, const mg_real *z) {
  mg_held_contacts s;
  int sets = 1;
  if (!mg_scale_held_contacts(problem, z, &s)) return 0;
  for (int k = 0; k < s.n; ++k) sets *= 3;
  for (int set = 0; set < sets; ++set) {
    int moves = 0, code = set;
    for (int k = 0; k < s.n; ++k, code /= 3) s.mode[k] = (mg_contact_mode)(code % 3), moves |= s.mode[k] != MG_STICKS;
    if (moves && !mg_are_modes_excluded(&s)) return 0;
  }
  return 1;
}
