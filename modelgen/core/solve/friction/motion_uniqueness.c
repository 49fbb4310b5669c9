/* Contacts of which some stick although their rows are dependent, as where a body is held against another at several
   points: forces are then not unique. Proves that every solution of Coulomb's law has the accelerations of the given
   one.

   With the scaled matrix S = L L', and w = S z + b of the given forces z, another solution has w2 = w + L d, d = L'(z2
   - z). In it each contact opens (z2 = 0, w2_n >= 0), sticks (w2 = 0), or slips along a unit vector t (w2_n = 0, f2 =
   -mu N2 t, w2_t = s t, s > 0); one whose slip is under way opens or slides on (w2_n = 0, f2 as N2). In the modes of
   the given solution d = 0, if the forces of contacts that slide are determined. In others, for directions t within
   arcs, a sum of forces L L'z2, the vector b and motions -w2 is zero. That is excluded by a vector y with
   - y'L = 0, and y'(-w2) > 0 for all motions: bodies cannot move so. Where w is not 0, y'w > 0; elsewhere w2 = 0 must
   mean d = 0, because L has full rank, or because the modes then are those of the given solution; or
   - y'x > 0 for each force, for b, and for each motion.
   y is sought as the nearest point to the origin of the convex hull of these vectors (Wolfe, Math. Program. 11 (1976),
   128-149). Arcs are halved until it is found. Contacts that stick in both solutions take part by their rows and cones,
   or else their rows restrict d, and their forces are any. */
#include "solve/friction/friction_solvers.h"
#include "base/base.h"

enum {
  MG_HELD_ROWS = 3 * MG_MOTION_CONTACTS,
  MG_HELD_CELLS = 4000, /* most combinations of modes and arcs that a proof looks at */
  MG_NEAREST_STEPS = 40 /* most steps of the search for a nearest point */
};

#define MG_HELD_MARGIN \
  (mg_real)(16 * sqrt(MG_EPS)) /* what y'x must exceed, |y| = 1; sine of half an arc that is not halved */
#define MG_HELD_CLEAR (mg_real) sqrt(MG_HELD_MARGIN) /* length that a vector must exceed to count for a rank */
#define MG_HELD_NOISE (mg_real) sqrt(MG_EPS)         /* length up to which it is zero */

typedef enum { MG_OPENS, MG_STICKS, MG_SLIPS, MG_SLIDES /* on, along a given direction */ } mg_contact_mode;

typedef mg_real mg_held_vector[MG_HELD_ROWS];

/* Unit vectors within an angle of t, of which cosine and sine are given. */
typedef struct {
  mg_real t[2], cosine, sine;
} mg_slip_arc;

/* Rows that exclude modes, if a vector y is found. */
typedef struct {
  int has_cones;                      /* 1: among them those of all contacts that stick, with their cones */
  int has_forces;                     /* 1: y'x > 0 for all terms; 0: y'L = 0, and forces do not count */
  int n_row, row[MG_HELD_ROWS];       /* rows of the problem */
  int first[MG_MOTION_CONTACTS];      /* place of the normal row of a contact among them, -1: none */
  int is_loaded;                      /* 1: the load is one of the terms */
  mg_held_vector load;                /* b; without forces, w of the given solution */
  mg_held_vector L[MG_HELD_ROWS];     /* of all rows of the problem, for the motions d that are left */
  int n_image;                        /* size of the image of the rows; with forces, 0 */
  mg_held_vector image[MG_HELD_ROWS]; /* its orthonormal basis */
} mg_held_rows;

typedef struct {
  int n, rank;                               /* contacts, columns of L */
  int cells;                                 /* combinations of modes and arcs so far */
  mg_real mu[MG_MOTION_CONTACTS];            /* coefficients of friction */
  mg_real ratio[MG_MOTION_CONTACTS][2];      /* f / N of a contact that slides */
  mg_held_vector L[MG_HELD_ROWS], F, w;      /* of the scaled problem; F = L'z */
  mg_contact_mode given[MG_MOTION_CONTACTS]; /* modes of the given solution */
  mg_contact_mode mode[MG_MOTION_CONTACTS];  /* modes of another solution */
  int n_view;                                /* number of `view` */
  mg_held_rows view[4];                      /* what may exclude the modes of the other solution */
} mg_held_contacts;

/* What the sum of vectors may hold: b, the force of a contact, or its motion. */
typedef enum { MG_HELD_LOAD, MG_HELD_FORCE, MG_HELD_MOTION } mg_held_kind;

typedef struct {
  mg_held_kind kind;
  int contact;
  mg_real t[2];  /* direction of slip; f / N of a force */
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

/* The term with the lowest y'x. */
static mg_held_term mg_lowest_term(const mg_held_contacts *s, const mg_held_rows *v, const mg_slip_arc *arc,
                                   const mg_real *y) {
  mg_held_term lowest = {MG_HELD_LOAD, 0, {0, 0}, v->is_loaded ? mg_held_product(v->n_row, y, v->load) : MG_MAX};
  mg_held_vector back = {0};
  for (int i = 0; i < v->n_row && v->has_forces; ++i) mg_add_multiple(s->rank, y[i], v->L[v->row[i]], back);
  for (int k = 0; k < s->n; ++k) {
    const mg_contact_mode mode = s->mode[k];
    if (v->first[k] < 0) continue;
    const mg_real *own = y + v->first[k];
    mg_real q[3], t[2] = {1, 0}, f[2] = {s->ratio[k][0], s->ratio[k][1]}, size;
    if (mode == MG_OPENS) mg_keep_lower(&lowest, MG_HELD_MOTION, k, 0, 0, -own[0]);
    if (mode == MG_SLIPS) {
      mg_nearest_of_arc(arc + k, own + 1, t);
      mg_keep_lower(&lowest, MG_HELD_MOTION, k, t[0], t[1], -mg_dot2(own + 1, t));
    }
    if (!v->has_forces || mode == MG_OPENS) continue;
    for (int i = 0; i < 3; ++i) q[i] = mg_held_product(s->rank, v->L[3 * k + i], back);
    size = mg_friction_norm(2, q + 1);
    if (mode == MG_SLIPS) mg_nearest_of_arc(arc + k, q + 1, t);
    else if (size > 0) t[0] = q[1] / size, t[1] = q[2] / size;
    if (mode != MG_SLIDES) f[0] = -s->mu[k] * t[0], f[1] = -s->mu[k] * t[1];
    mg_keep_lower(&lowest, MG_HELD_FORCE, k, f[0], f[1], q[0] + mg_dot2(q + 1, f));
  }
  return lowest;
}

/* The vector of a term, without its part in the image. */
static void mg_vector_of_term(const mg_held_contacts *s, const mg_held_rows *v, const mg_held_term *term, mg_real *x) {
  const int k = term->contact, first = v->first[k];
  mg_held_vector d = {0};
  for (int i = 0; i < v->n_row; ++i) x[i] = term->kind == MG_HELD_LOAD ? v->load[i] : 0;
  if (term->kind == MG_HELD_MOTION && s->mode[k] == MG_OPENS) x[first] = -1;
  if (term->kind == MG_HELD_MOTION && s->mode[k] == MG_SLIPS) x[first + 1] = -term->t[0], x[first + 2] = -term->t[1];
  if (term->kind == MG_HELD_FORCE) {
    mg_add_multiple(s->rank, 1, v->L[3 * k], d);
    for (int i = 0; i < 2; ++i) mg_add_multiple(s->rank, term->t[i], v->L[3 * k + 1 + i], d);
    for (int i = 0; i < v->n_row; ++i) x[i] = mg_held_product(s->rank, v->L[v->row[i]], d);
  }
  mg_remove_components(v->n_row, v->n_image, v->image, x);
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
static int mg_is_separated(const mg_held_contacts *s, const mg_held_rows *v, const mg_slip_arc *arc) {
  const int n = v->n_row;
  mg_held_vector vector[MG_HELD_ROWS + 1], y = {0};
  mg_real weight[MG_HELD_ROWS + 1];
  int count = 0;
  for (int step = 0; step < MG_NEAREST_STEPS; ++step) {
    const mg_held_term lowest = mg_lowest_term(s, v, arc, y);
    const mg_real length = (mg_real)sqrt(mg_held_product(n, y, y));
    if (count && !(length > MG_HELD_MARGIN)) return 0;
    if (count && lowest.value > MG_HELD_MARGIN * length) return 1;
    if (count && (lowest.value > length * length - MG_HELD_MARGIN * MG_HELD_MARGIN || count > n)) return 0;
    mg_vector_of_term(s, v, &lowest, vector[count]);
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
    if (mg_is_separated(s, s->view + i, arc)) return 1;
  return 0;
}

/* One of the parts of an arc: a third of all directions, or a half of others. */
static mg_slip_arc mg_part_of_arc(const mg_slip_arc *arc, int part) {
  const int is_all = arc->cosine < 0;
  const mg_real cosine = is_all ? (mg_real)0.5 : (mg_real)sqrt((1 + arc->cosine) / 2);
  const mg_real sine = is_all ? (mg_real)sqrt(0.75) : arc->sine / (2 * cosine),
                turn = is_all ? 2 * sine * cosine : sine;
  const mg_real along = is_all ? cosine * cosine - sine * sine : cosine, across = part ? turn : -turn;
  mg_slip_arc out = {{along * arc->t[0] - across * arc->t[1], along * arc->t[1] + across * arc->t[0]}, cosine, sine};
  if (part == 2) out.t[0] = arc->t[0], out.t[1] = arc->t[1];
  return out;
}

/* Excludes the modes for all slip directions of these arcs, in parts where that is needed. */
static int mg_are_arcs_excluded(mg_held_contacts *s, const mg_slip_arc *arc) {
  mg_slip_arc part[MG_MOTION_CONTACTS];
  int widest = -1;
  if (mg_is_cell_excluded(s, arc)) return 1;
  for (int k = 0; k < s->n; ++k) {
    part[k] = arc[k];
    if (s->mode[k] == MG_SLIPS && (widest < 0 || arc[k].cosine < arc[widest].cosine)) widest = k;
  }
  if (widest < 0 || (arc[widest].cosine > 0 && arc[widest].sine < MG_HELD_MARGIN) || ++s->cells > MG_HELD_CELLS)
    return 0;
  for (int k = 0; k < (arc[widest].cosine < 0 ? 3 : 2); ++k) {
    part[widest] = mg_part_of_arc(arc + widest, k);
    if (!mg_are_arcs_excluded(s, part)) return 0;
  }
  return 1;
}

/* Adds the rows of a contact. Those of one that sticks in both solutions may be left out to restrict the motions, those
   of one that opens in both need not count without forces. */
static void mg_add_rows_of_contact(const mg_held_contacts *s, int k, mg_held_rows *v) {
  const int rows = s->mode[k] == MG_SLIPS || s->mode[k] == MG_STICKS ? 3 : 1, stays = s->mode[k] == s->given[k];
  v->first[k] = v->n_row;
  if (stays && s->mode[k] == MG_STICKS && !v->has_cones) v->first[k] = -1;
  if (stays && s->mode[k] == MG_OPENS && !v->has_forces) v->first[k] = -1;
  for (int i = 0; i < rows && v->first[k] >= 0; ++i) v->row[v->n_row++] = 3 * k + i;
}

/* True if another solution in the present modes is one in the given modes where contacts that slip or open rest. */
static int mg_rests_in_given_modes(const mg_held_contacts *s) {
  for (int k = 0; k < s->n; ++k)
    if (s->mode[k] != s->given[k] && !(s->mode[k] == MG_SLIPS && s->given[k] == MG_STICKS) &&
        !(s->mode[k] == MG_OPENS && s->given[k] == MG_SLIDES))
      return 0;
  return 1;
}

/* L and F of the problem, restricted to motions at which the listed rows are zero. Returns the number of these motions,
   -1 where it is not clear. */
static int mg_restrict_motions(const mg_held_contacts *s, int n, const int *list, mg_held_vector *L, mg_real *F) {
  mg_held_vector vector[MG_HELD_ROWS], held[MG_HELD_ROWS];
  for (int i = 0; i < n; ++i) mg_copy_reals(vector[i], s->L[list[i]], s->rank);
  n = mg_find_basis(s->rank, n, vector, held);
  if (n < 0) return -1;
  for (int i = 0; i < 3 * s->n; ++i) {
    mg_copy_reals(L[i], s->L[i], s->rank);
    mg_remove_components(s->rank, n, (const mg_held_vector *)held, L[i]);
  }
  mg_copy_reals(F, s->F, s->rank);
  mg_remove_components(s->rank, n, (const mg_held_vector *)held, F);
  return s->rank - n;
}

/* Adds a view of the present modes if it may exclude them. Contacts that stick in both solutions take part by their
   cones, or restrict the motions. Returns the number of motions that are left, -1 where it is not clear. */
static int mg_add_held_rows(mg_held_contacts *s, int has_cones, int has_forces) {
  mg_held_rows *v = s->view + s->n_view;
  mg_held_vector vector[MG_HELD_ROWS], F;
  int held[MG_HELD_ROWS], n_held = 0, left, n_image;
  v->has_cones = has_cones, v->has_forces = v->is_loaded = has_forces, v->n_row = v->n_image = 0;
  for (int k = 0; k < s->n; ++k) {
    mg_add_rows_of_contact(s, k, v);
    for (int i = 0; i < 3 && v->first[k] < 0 && s->mode[k] == MG_STICKS; ++i) held[n_held++] = 3 * k + i;
  }
  left = mg_restrict_motions(s, n_held, held, v->L, F);
  if (left < 0) return left;
  for (int i = 0; i < v->n_row; ++i) {
    const int row = v->row[i];
    v->load[i] = s->w[row] - (has_forces ? mg_held_product(s->rank, v->L[row], F) : 0);
    v->is_loaded |= v->load[i] != 0;
    for (int j = 0; j < s->rank; ++j) vector[j][i] = v->L[row][j];
  }
  if (has_forces) {
    s->n_view++;
    return left;
  }
  n_image = mg_find_basis(v->n_row, s->rank, vector, v->image);
  v->n_image = n_image;
  s->n_view += n_image >= 0 && n_image < v->n_row && (n_image == left || v->is_loaded || mg_rests_in_given_modes(s));
  return left;
}

/* True if another solution in the modes of the given one has its accelerations: forces of contacts that slide do not
   change along the motions that those that stick leave. */
static int mg_are_given_modes_unique(const mg_held_contacts *s) {
  mg_held_vector L[MG_HELD_ROWS], F;
  mg_real U[MG_MOTION_CONTACTS * MG_MOTION_CONTACTS];
  int held[MG_HELD_ROWS], slides[MG_MOTION_CONTACTS], swap[MG_MOTION_CONTACTS], n_held = 0, n = 0;
  for (int k = 0; k < s->n; ++k) {
    if (s->given[k] == MG_SLIDES) slides[n++] = k;
    for (int i = 0; i < 3 && s->given[k] == MG_STICKS; ++i) held[n_held++] = 3 * k + i;
  }
  if (n == 0) return 1;
  if (mg_restrict_motions(s, n_held, held, L, F) < 0) return 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const mg_held_vector *own = (const mg_held_vector *)L + 3 * slides[j];
      U[i + j * n] = mg_held_product(s->rank, L[3 * slides[i]], own[0]);
      for (int q = 0; q < 2; ++q)
        U[i + j * n] += s->ratio[slides[j]][q] * mg_held_product(s->rank, L[3 * slides[i]], own[1 + q]);
    }
  return mg_lu(n, U, swap) > MG_HELD_CLEAR;
}

/* True if no motion keeps closed what is closed in the present and in the given modes. */
static int mg_is_no_motion_left(const mg_held_contacts *s) {
  mg_held_vector L[MG_HELD_ROWS], F;
  int held[MG_HELD_ROWS], n_held = 0;
  for (int k = 0; k < s->n; ++k) {
    const int rows = s->mode[k] == MG_OPENS || s->given[k] == MG_OPENS ? 0 : s->mode[k] == MG_STICKS ? 3 : 1;
    for (int i = 0; i < rows; ++i) held[n_held++] = 3 * k + i;
  }
  return mg_restrict_motions(s, n_held, held, L, F) == 0;
}

/* True if another solution in the present modes has the accelerations of the given one. */
static int mg_are_modes_excluded(mg_held_contacts *s) {
  const mg_slip_arc all = {{1, 0}, -1, 0}, arc[MG_MOTION_CONTACTS] = {all, all, all, all};
  int is_given = 1, any_held = 0;
  for (int k = 0; k < s->n; ++k)
    is_given &= s->mode[k] == s->given[k], any_held |= s->mode[k] == MG_STICKS && s->given[k] == MG_STICKS;
  if (is_given) return mg_are_given_modes_unique(s);
  if (mg_is_no_motion_left(s)) return 1;
  s->n_view = 0;
  for (int has_cones = !any_held; has_cones < 2; ++has_cones)
    for (int has_forces = 0; has_forces < 2; ++has_forces)
      if (mg_add_held_rows(s, has_cones, has_forces) == 0) return 1;
  return mg_are_arcs_excluded(s, arc);
}

/* Scales the matrix to A_nn = 1 and factorises it. Returns 0 if it is not symmetric, or of no clear rank. */
static int mg_factorise_held_matrix(const mg_friction_problem *p, const mg_real *scale, mg_held_contacts *s) {
  const int n = p->n;
  mg_real L[MG_HELD_ROWS * MG_HELD_ROWS], rest[MG_HELD_ROWS];
  int order[MG_HELD_ROWS];
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const mg_real odd = p->A[i + j * n] - p->A[j + i * n];
      L[i + j * n] = p->A[i + j * n] * scale[i] * scale[j];
      if (!(fabs(odd) * scale[i] * scale[j] <= MG_HELD_MARGIN)) return 0;
    }
  for (int i = 0; i < n; ++i) rest[i] = L[i * (n + 1)];
  s->rank = mg_cholesky_pivoted(n, L, order, MG_HELD_CLEAR);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < s->rank; ++j) {
      const mg_real entry = j > i ? 0 : L[i + j * n];
      s->L[order[i]][j] = entry, rest[order[i]] -= entry * entry;
    }
  for (int i = 0; i < n; ++i)
    if (!(fabs(rest[i]) <= MG_LCP_RANK(n) * mg_max(1, L[0] * L[0]))) return 0;
  return 1;
}

/* Sets modes and w of the given solution. Returns 0 if it does not obey its modes. */
static int mg_set_given_modes(const mg_friction_problem *p, const mg_real *scale, const mg_real *z, const int *slides,
                              mg_held_contacts *s) {
  mg_real size = 0;
  for (int i = 0; i < p->n; ++i) size = mg_max(size, (mg_real)fabs(p->b[i]) * scale[i]);
  if (!(size > 0) || !(size <= MG_MAX)) return 0;
  for (int j = 0; j < s->rank; ++j) s->F[j] = 0;
  for (int i = 0; i < p->n; ++i) {
    s->w[i] = p->b[i] * scale[i] / size;
    for (int j = 0; j < p->n; ++j) s->w[i] += p->A[i + j * p->n] * scale[i] * z[j] / size;
    mg_add_multiple(s->rank, z[i] / scale[i] / size, s->L[i], s->F);
  }
  for (int k = 0; k < s->n; ++k) {
    const int is_shut = z[3 * k] != 0, rows = is_shut && !slides[k] ? 3 : is_shut;
    s->given[k] = !is_shut ? MG_OPENS : slides[k] ? MG_SLIDES : MG_STICKS;
    for (int i = 3 * k; i < 3 * k + rows; ++i) {
      if (!(fabs(s->w[i]) <= MG_HELD_MARGIN)) return 0;
      s->w[i] = 0;
    }
  }
  return 1;
}

MG_API int mg_is_motion_unique(const mg_friction_problem *p, const mg_real *z, const int *slides,
                               const mg_real *ratio) {
  mg_held_contacts s;
  mg_real scale[MG_HELD_ROWS];
  int sets = 1;
  if (p->n_contact > MG_MOTION_CONTACTS || p->n != 3 * p->n_contact || p->n == 0 || p->law != MG_COULOMB) return 0;
  s.n = p->n_contact, s.cells = 0;
  for (int k = 0; k < s.n; ++k, sets *= 3) {
    const mg_real *cone = p->cone + MG_CONE * k, entry = p->A[3 * k * (p->n + 1)];
    if (p->first[k] != 3 * k || p->rows[k] != 3 || !(cone[0] > 0) || cone[0] != cone[1] || !(entry > 0)) return 0;
    s.mu[k] = cone[0], s.ratio[k][0] = ratio[2 * k], s.ratio[k][1] = ratio[2 * k + 1];
    for (int i = 3 * k; i < 3 * k + 3; ++i) scale[i] = 1 / (mg_real)sqrt(entry);
  }
  if (!mg_factorise_held_matrix(p, scale, &s) || !mg_set_given_modes(p, scale, z, slides, &s)) return 0;
  for (int set = 0; set < sets; ++set) {
    int code = set, is_twice = 0;
    for (int k = 0; k < s.n; ++k, code /= 3) {
      s.mode[k] = (mg_contact_mode)(code % 3);
      is_twice |= slides[k] && s.mode[k] == MG_SLIPS;
      if (slides[k] && s.mode[k] == MG_STICKS) s.mode[k] = MG_SLIDES;
    }
    if (!is_twice && !mg_are_modes_excluded(&s)) return 0;
  }
  return 1;
}
