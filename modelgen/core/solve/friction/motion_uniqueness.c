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
   or else their rows restrict d, and their forces are any. The y of the last proof are tried first. */
#include "solve/friction/friction_solvers.h"
#include "base/base.h"

enum {
  MG_HELD_ROWS = 3 * MG_MOTION_CONTACTS,
  MG_PROOF_CELLS = 64, /* most cells that a proof keeps */
  MG_CELL_DIVIDED = -1,
  MG_HELD_VIEWS = 4,
  MG_HELD_CELLS = 4000, /* most combinations of modes and arcs that a proof looks at */
  MG_NEAREST_STEPS = 40 /* most steps of the search for a nearest point */
};

#define MG_HELD_MARGIN \
  (mg_real)(16 * sqrt(MG_EPS)) /* what y'x must exceed, |y| = 1; sine of half an arc that is not halved */
#define MG_HELD_CLEAR (mg_real) sqrt(MG_HELD_MARGIN) /* length that a vector must exceed to count for a rank */
#define MG_HELD_NOISE (mg_real) sqrt(MG_EPS)         /* length up to which it is zero */

typedef enum { MG_OPENS, MG_STICKS, MG_SLIPS, MG_SLIDES /* on, along a given direction */ } mg_contact_mode;

typedef mg_real mg_held_vector[MG_HELD_ROWS];

/* Modes of contacts that have another motion, with slip directions within arcs: what excludes them. */
typedef struct {
  int set;          /* number of the modes */
  int view;         /* rows among which y is, or MG_CELL_DIVIDED: halves of the arcs come next */
  mg_held_vector y; /* excludes them */
} mg_separation;

/* A proof, or its start. */
typedef struct {
  int n; /* cells */
  mg_separation cell[MG_PROOF_CELLS];
} mg_motion_proof;

/* Unit vectors within an angle of t, of which cosine and sine are given. */
typedef struct {
  mg_real t[2], cosine, sine;
} mg_slip_arc;

/* The problem restricted to the motions at which contacts rest. */
typedef struct {
  int is_set;
  int left; /* number of these motions, -1: not clear */
  mg_held_vector L[MG_HELD_ROWS], F;
  mg_held_vector S[MG_HELD_ROWS]; /* L L' */
} mg_restricted_motions;

/* Rows that exclude modes, if a vector y is found. */
typedef struct {
  int set;                              /* number of the modes that the rest is for */
  int separates;                        /* 1: it may exclude them */
  int has_cones;                        /* 1: among them those of all contacts that stick, with their cones */
  int has_forces;                       /* 1: y'x > 0 for all terms; 0: y'L = 0, and forces do not count */
  int n_row, row[MG_HELD_ROWS];         /* rows of the problem */
  int first[MG_MOTION_CONTACTS];        /* place of the normal row of a contact among them, -1: none */
  int is_loaded;                        /* 1: the load is one of the terms */
  mg_held_vector load;                  /* b; without forces, w of the given solution */
  const mg_restricted_motions *motions; /* that are left */
  int n_image;                          /* size of the image of the rows; with forces, 0 */
  mg_held_vector image[MG_HELD_ROWS];   /* its orthonormal basis */
} mg_held_rows;

typedef struct {
  int n, rank;                                               /* contacts, columns of L */
  int cells;                                                 /* combinations of modes and arcs so far */
  mg_real mu[MG_MOTION_CONTACTS];                            /* coefficients of friction */
  mg_real ratio[MG_MOTION_CONTACTS][2];                      /* f / N of a contact that slides */
  mg_held_vector L[MG_HELD_ROWS], F, w;                      /* of the scaled problem; F = L'z */
  mg_contact_mode given[MG_MOTION_CONTACTS];                 /* modes of the given solution */
  mg_contact_mode mode[MG_MOTION_CONTACTS];                  /* modes of another solution */
  mg_restricted_motions restricted[1 << MG_MOTION_CONTACTS]; /* bit k: contact k rests */
  mg_held_rows view[MG_HELD_VIEWS];                          /* what may exclude the modes of the other solution */
  int set;                                                   /* their number */
  int newest;                                                /* of `kept`: the last proof */
  mg_motion_proof kept[2];
  const mg_motion_proof *last; /* the last proof */
  int at;                      /* its next cell */
  mg_motion_proof *proof;      /* this one */
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
    for (int i = 0; i < 3; ++i) {
      q[i] = 0;
      for (int j = 0; j < v->n_row; ++j) q[i] += v->motions->S[3 * k + i][v->row[j]] * y[j];
    }
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
  for (int i = 0; i < v->n_row; ++i) x[i] = term->kind == MG_HELD_LOAD ? v->load[i] : 0;
  if (term->kind == MG_HELD_MOTION && s->mode[k] == MG_OPENS) x[first] = -1;
  if (term->kind == MG_HELD_MOTION && s->mode[k] == MG_SLIPS) x[first + 1] = -term->t[0], x[first + 2] = -term->t[1];
  if (term->kind == MG_HELD_FORCE) {
    for (int i = 0; i < v->n_row; ++i) {
      const mg_real *S = v->motions->S[v->row[i]] + 3 * k;
      x[i] = S[0] + mg_dot2(S + 1, term->t);
    }
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

/* True if y excludes the modes, with slip directions of these arcs. */
static int mg_separates(const mg_held_contacts *s, const mg_held_rows *v, const mg_slip_arc *arc, mg_real *y) {
  mg_remove_components(v->n_row, v->n_image, v->image, y);
  return mg_lowest_term(s, v, arc, y).value > MG_HELD_MARGIN;
}

/* Finds a vector y, |y| = 1, that excludes the modes, with slip directions of these arcs. Returns 0 if none is found.
 */
static int mg_find_separation(const mg_held_contacts *s, const mg_held_rows *v, const mg_slip_arc *arc, mg_real *y) {
  const int n = v->n_row;
  mg_held_vector vector[MG_HELD_ROWS + 1];
  mg_real weight[MG_HELD_ROWS + 1];
  int count = 0;
  for (int i = 0; i < MG_HELD_ROWS; ++i) y[i] = 0;
  for (int step = 0; step < MG_NEAREST_STEPS; ++step) {
    const mg_held_term lowest = mg_lowest_term(s, v, arc, y);
    const mg_real length = (mg_real)sqrt(mg_held_product(n, y, y));
    if (count && !(length > MG_HELD_MARGIN)) return 0;
    if (count && lowest.value > MG_HELD_MARGIN * length) {
      for (int i = 0; i < n; ++i) y[i] /= length;
      return 1;
    }
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

/* The problem restricted to motions at which contacts rest, those of which the bit is set. */
static const mg_restricted_motions *mg_motions_at_rest(mg_held_contacts *s, int contacts) {
  mg_restricted_motions *motions = s->restricted + contacts;
  int row[MG_HELD_ROWS] = {0}, n = 0;
  if (motions->is_set) return motions;
  for (int i = 0; i < 3 * s->n; ++i)
    if (contacts >> i / 3 & 1) row[n++] = i;
  motions->is_set = 1, motions->left = mg_restrict_motions(s, n, row, motions->L, motions->F);
  for (int i = 0; i < 3 * s->n && motions->left >= 0; ++i)
    for (int j = 0; j <= i; ++j)
      motions->S[i][j] = motions->S[j][i] = mg_held_product(s->rank, motions->L[i], motions->L[j]);
  return motions;
}

/* Sets rows and motions of a view of the present modes, and whether it may exclude them. Contacts that stick in both
   solutions take part by their cones, or restrict the motions. */
static void mg_set_held_rows(mg_held_contacts *s, mg_held_rows *v) {
  mg_held_vector vector[MG_HELD_ROWS];
  int resting = 0;
  v->is_loaded = v->has_forces, v->n_row = v->n_image = v->separates = 0;
  for (int k = 0; k < s->n; ++k) {
    mg_add_rows_of_contact(s, k, v);
    resting |= (v->first[k] < 0 && s->mode[k] == MG_STICKS) << k;
  }
  v->motions = mg_motions_at_rest(s, resting);
  if (v->motions->left < 0) return;
  for (int i = 0; i < v->n_row; ++i) {
    const mg_real *L = v->motions->L[v->row[i]];
    v->load[i] = s->w[v->row[i]] - (v->has_forces ? mg_held_product(s->rank, L, v->motions->F) : 0);
    v->is_loaded |= v->load[i] != 0;
    for (int j = 0; j < s->rank; ++j) vector[j][i] = L[j];
  }
  if (!v->has_forces) v->n_image = mg_find_basis(v->n_row, s->rank, vector, v->image);
  v->separates = v->has_forces || (v->n_image >= 0 && v->n_image < v->n_row &&
                                   (v->n_image == v->motions->left || v->is_loaded || mg_rests_in_given_modes(s)));
}

/* A view of the present modes, set where it is first needed. */
static const mg_held_rows *mg_view_of_modes(mg_held_contacts *s, int view) {
  mg_held_rows *v = s->view + view;
  if (v->set == s->set) return v;
  v->set = s->set, v->has_cones = view / 2, v->has_forces = view % 2;
  mg_set_held_rows(s, v);
  return v;
}

/* The first view that counts: where no contact sticks in both solutions, they come in pairs that are equal. */
static int mg_first_view(const mg_held_contacts *s) {
  for (int k = 0; k < s->n; ++k)
    if (s->mode[k] == MG_STICKS && s->given[k] == MG_STICKS) return 0;
  return MG_HELD_VIEWS / 2;
}

/* Next cell of the last proof, if it is one of the present modes. */
static const mg_separation *mg_next_cell_of_last_proof(mg_held_contacts *s) {
  while (s->at < s->last->n && s->last->cell[s->at].set < s->set) ++s->at;
  return s->at < s->last->n && s->last->cell[s->at].set == s->set ? s->last->cell + s->at : 0;
}

/* True if the modes, with slip directions of these arcs, are excluded: by what excluded them in the last proof, or by
   what is found. */
static int mg_is_cell_excluded(mg_held_contacts *s, const mg_slip_arc *arc, const mg_separation *last,
                               mg_separation *found) {
  if (last) {
    const mg_held_rows *v = mg_view_of_modes(s, last->view);
    *found = *last;
    if (v->separates && mg_separates(s, v, arc, found->y)) return 1;
  }
  found->view = MG_CELL_DIVIDED;
  for (int k = 0; k < s->n; ++k)
    if (s->mode[k] == MG_SLIPS && !(arc[k].cosine > MG_HELD_CLEAR)) return 0;
  for (int i = mg_first_view(s); i < MG_HELD_VIEWS; ++i) {
    const mg_held_rows *v = mg_view_of_modes(s, i);
    if (!v->separates || !mg_find_separation(s, v, arc, found->y)) continue;
    found->view = i;
    return 1;
  }
  return 0;
}

/* Excludes the modes for all slip directions of these arcs, in parts where that is needed. is_known, 1: the last proof
   had this cell. */
static int mg_are_arcs_excluded(mg_held_contacts *s, const mg_slip_arc *arc, int is_known) {
  const mg_separation *last = is_known ? mg_next_cell_of_last_proof(s) : 0;
  mg_separation spare, *found = s->proof->n < MG_PROOF_CELLS ? s->proof->cell + s->proof->n++ : &spare;
  mg_slip_arc part[MG_MOTION_CONTACTS];
  int widest = -1;
  const int was_divided = last && last->view == MG_CELL_DIVIDED;
  if (last) ++s->at;
  found->set = s->set, found->view = MG_CELL_DIVIDED;
  if (!was_divided && mg_is_cell_excluded(s, arc, last, found)) return 1;
  for (int k = 0; k < s->n; ++k) {
    part[k] = arc[k];
    if (s->mode[k] == MG_SLIPS && (widest < 0 || arc[k].cosine < arc[widest].cosine)) widest = k;
  }
  if (widest < 0 || (arc[widest].cosine > 0 && arc[widest].sine < MG_HELD_MARGIN) || ++s->cells > MG_HELD_CELLS)
    return 0;
  for (int k = 0; k < (arc[widest].cosine < 0 ? 3 : 2); ++k) {
    part[widest] = mg_part_of_arc(arc + widest, k);
    if (!mg_are_arcs_excluded(s, part, was_divided)) return 0;
  }
  return 1;
}

/* True if another solution in the modes of the given one has its accelerations: forces of contacts that slide do not
   change along the motions that those that stick leave. */
static int mg_are_given_modes_unique(mg_held_contacts *s) {
  const mg_restricted_motions *motions;
  mg_real U[MG_MOTION_CONTACTS * MG_MOTION_CONTACTS];
  int slides[MG_MOTION_CONTACTS], swap[MG_MOTION_CONTACTS], resting = 0, n = 0;
  for (int k = 0; k < s->n; ++k) {
    if (s->given[k] == MG_SLIDES) slides[n++] = k;
    resting |= (s->given[k] == MG_STICKS) << k;
  }
  if (n == 0) return 1;
  motions = mg_motions_at_rest(s, resting);
  if (motions->left < 0) return 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const mg_real *S = motions->S[3 * slides[i]] + 3 * slides[j];
      U[i + j * n] = S[0] + mg_dot2(S + 1, s->ratio[slides[j]]);
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
  const int is_known = mg_next_cell_of_last_proof(s) != 0;
  int is_given = 1;
  for (int k = 0; k < s->n; ++k) is_given &= s->mode[k] == s->given[k];
  if (is_given) return mg_are_given_modes_unique(s);
  if (!is_known && mg_is_no_motion_left(s)) return 1;
  for (int i = mg_first_view(s); i < MG_HELD_VIEWS && !is_known; ++i)
    if (mg_view_of_modes(s, i)->motions->left == 0) return 1;
  return mg_are_arcs_excluded(s, arc, is_known);
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
  s->rank = mg_cholesky_pivoted(n, L, order, MG_HELD_CLEAR, 0);
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

MG_API int mg_motion_work_size(void) { return (int)mg_count_reals(1, sizeof(mg_held_contacts)); }

MG_API void mg_forget_motion_proof(mg_real *work) {
  mg_held_contacts *s = mg_take_memory(&work, 1, sizeof(mg_held_contacts));
  s->newest = s->kept[0].n = 0;
}

MG_API int mg_is_motion_unique(const mg_friction_problem *p, const mg_real *z, const int *slides, const mg_real *ratio,
                               mg_real *work) {
  mg_held_contacts *s = mg_take_memory(&work, 1, sizeof(mg_held_contacts));
  mg_real scale[MG_HELD_ROWS];
  int sets = 1;
  if (p->n_contact > MG_MOTION_CONTACTS || p->n != 3 * p->n_contact || p->n == 0 || p->law != MG_COULOMB) return 0;
  s->n = p->n_contact, s->cells = s->at = 0;
  s->last = s->kept + s->newest, s->proof = s->kept + 1 - s->newest, s->proof->n = 0;
  for (int i = 0; i < MG_HELD_VIEWS; ++i) s->view[i].set = -1;
  for (int i = 0; i < 1 << s->n; ++i) s->restricted[i].is_set = 0;
  for (int k = 0; k < s->n; ++k, sets *= 3) {
    const mg_real *cone = p->cone + MG_CONE * k, entry = p->A[3 * k * (p->n + 1)];
    if (p->first[k] != 3 * k || p->rows[k] != 3 || !(cone[0] > 0) || cone[0] != cone[1] || !(entry > 0)) return 0;
    s->mu[k] = cone[0], s->ratio[k][0] = ratio[2 * k], s->ratio[k][1] = ratio[2 * k + 1];
    for (int i = 3 * k; i < 3 * k + 3; ++i) scale[i] = 1 / (mg_real)sqrt(entry);
  }
  if (!mg_factorise_held_matrix(p, scale, s) || !mg_set_given_modes(p, scale, z, slides, s)) return 0;
  for (s->set = 0; s->set < sets; ++s->set) {
    int code = s->set, is_twice = 0;
    for (int k = 0; k < s->n; ++k, code /= 3) {
      s->mode[k] = (mg_contact_mode)(code % 3);
      is_twice |= slides[k] && s->mode[k] == MG_SLIPS;
      if (slides[k] && s->mode[k] == MG_STICKS) s->mode[k] = MG_SLIDES;
    }
    if (!is_twice && !mg_are_modes_excluded(s)) return 0;
  }
  s->newest = 1 - s->newest;
  return 1;
}
