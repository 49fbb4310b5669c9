/* The convex quadratic program of mg_qp for many rows that each act on two bodies, min y'S y/2 + c'y with y >= 0, where
   S = D^-1 J M^-1 J^T D^-1 is never formed: its product with a vector passes through the bodies.

   Modified proportioning with reduced gradient projections (Dostal and Schoeberl, Comput. Optim. Appl. 30 (2005),
   23-43): conjugate gradients on the unknowns that are not zero, a projected step of fixed length where these would
   become negative, and a step along the gradient of the zero unknowns where that gradient is the larger one. Started
   from a guess, as from the impulses of the step before. The result is certified as that of mg_qp. */
#include "solve/lcp/lcp_solvers.h"
#include "base/base.h"

enum {
  MG_NORM_STEPS = 4,    /* steps of power iteration for the norm of S: half of it is near enough */
  MG_CERTIFY_EVERY = 10 /* iterations between two looks at the residual */
};

typedef struct {
  const mg_row_matrix *A;
  mg_real scale;         /* max_i |b_i| / d_i, by which c is divided */
  mg_real length;        /* length of the projected step, below 2 / |S| */
  mg_real tolerance;     /* of the residual of the scaled problem, beyond that of mg_qp */
  mg_real *d, *c;        /* [n] diagonal of D, and c */
  mg_real *y, *gradient; /* [n] S y + c */
  mg_real *direction;    /* [n] */
  mg_real *image;        /* [n] S direction */
  mg_real *per_body;     /* [6 n_body] */
#ifdef MG_DEBUG
  mg_digest imaged; /* digest of the direction of which the image is */
#endif
} mg_large_qp;

/* In a debug core: notes, and requires, that the image is that of the direction. */
#ifdef MG_DEBUG
#define MG_DIRECTION_DIGEST(s) mg_digest_reals(MG_DIGEST_START, (s)->direction, (s)->A->n)
#define MG_NOTE_IMAGE(s) ((s)->imaged = MG_DIRECTION_DIGEST(s))
#define MG_NEEDS_IMAGE(s) MG_REQUIRE((s)->imaged == MG_DIRECTION_DIGEST(s))
#else
#define MG_NOTE_IMAGE(s) ((void)0)
#define MG_NEEDS_IMAGE(s) ((void)0)
#endif

/* image = S x. */
static void mg_large_product(const mg_large_qp *s, const mg_real *x, mg_real *image) {
  const mg_row_matrix *A = s->A;
  for (int k = 0; k < 6 * A->n_body; k++) s->per_body[k] = 0;
  for (int i = 0; i < A->n; i++) {
    const mg_real amount = x[i] / s->d[i];
    if (A->o[i] >= 0) mg_add_multiple6(amount, A->MJ + 12 * i, s->per_body + 6 * A->o[i]);
    if (A->f[i] >= 0) mg_add_multiple6(amount, A->MJ + 12 * i + 6, s->per_body + 6 * A->f[i]);
  }
  for (int i = 0; i < A->n; i++) {
    mg_real sum = 0;
    if (A->o[i] >= 0) sum = mg_dot6(A->J + 12 * i, s->per_body + 6 * A->o[i]);
    if (A->f[i] >= 0) sum += mg_dot6(A->J + 12 * i + 6, s->per_body + 6 * A->f[i]);
    image[i] = sum / s->d[i];
  }
}

static mg_real mg_large_dot(int n, const mg_real *a, const mg_real *b) {
  mg_real sum = 0;
  for (int i = 0; i < n; i++) sum += a[i] * b[i];
  return sum;
}

/* Diagonal of D from that of A. */
static void mg_large_diagonal(mg_large_qp *s) {
  const mg_row_matrix *A = s->A;
  for (int i = 0; i < A->n; i++) {
    mg_real own = 0;
    if (A->o[i] >= 0) own = mg_dot6(A->J + 12 * i, A->MJ + 12 * i);
    if (A->f[i] >= 0) own += mg_dot6(A->J + 12 * i + 6, A->MJ + 12 * i + 6);
    s->d[i] = mg_diagonal_scale(own);
  }
}

/* Length of the projected step: 1 over the norm of S, estimated from below by power iteration and raised by a tenth. */
static mg_real mg_large_step_length(const mg_large_qp *s) {
  const int n = s->A->n;
  mg_real norm = 1;
  for (int i = 0; i < n; i++) s->direction[i] = 1 + (mg_real)0.1 * (mg_real)(i % 7);
  for (int step = 0; step < MG_NORM_STEPS; step++) {
    mg_large_product(s, s->direction, s->image);
    const mg_real before = sqrt(mg_large_dot(n, s->direction, s->direction)),
                  after = sqrt(mg_large_dot(n, s->image, s->image));
    if (!(after > 0)) return 1;
    norm = after / before;
    for (int i = 0; i < n; i++) s->direction[i] = s->image[i] / after;
  }
  return 1 / ((mg_real)1.1 * norm);
}

/* Gradient, free of rounding that has accumulated. */
static void mg_large_gradient(mg_large_qp *s) {
  mg_large_product(s, s->y, s->gradient);
  for (int i = 0; i < s->A->n; i++) s->gradient[i] += s->c[i];
}

/* The direction of steepest descent of the unknowns that are not zero. */
static void mg_large_restart(mg_large_qp *s) {
  for (int i = 0; i < s->A->n; i++) s->direction[i] = s->y[i] > 0 ? s->gradient[i] : 0;
}

/* True if the gradient of the zero unknowns, which become positive, is larger than the reduced one of the others. */
static int mg_is_chopped_gradient_larger(const mg_large_qp *s) {
  mg_real chopped = 0, reduced = 0;
  for (int i = 0; i < s->A->n; i++) {
    const mg_real g = s->gradient[i];
    if (s->y[i] > 0) reduced += mg_min(s->y[i] / s->length, g) * g;
    else if (g < 0) chopped += g * g;
  }
  return chopped > reduced;
}

/* y -= step * direction, and the gradient with it. Needs the image. */
static void mg_large_move(mg_large_qp *s, mg_real step) {
  MG_NEEDS_IMAGE(s);
  for (int i = 0; i < s->A->n; i++)
    s->y[i] = mg_max(s->y[i] - step * s->direction[i], (mg_real)0), s->gradient[i] -= step * s->image[i];
}

/* Step along the gradient of the zero unknowns. */
static void mg_large_release(mg_large_qp *s) {
  const int n = s->A->n;
  for (int i = 0; i < n; i++) s->direction[i] = s->y[i] > 0 ? 0 : mg_min(s->gradient[i], (mg_real)0);
  mg_large_product(s, s->direction, s->image);
  MG_NOTE_IMAGE(s);
  const mg_real bend = mg_large_dot(n, s->direction, s->image);
  mg_large_move(s, bend > 0 ? mg_large_dot(n, s->gradient, s->direction) / bend : s->length);
  mg_large_restart(s);
}

/* Step of conjugate gradients, or to the first unknown that becomes zero and a projected step from there. */
static void mg_large_descend(mg_large_qp *s) {
  const int n = s->A->n;
  mg_real longest = MG_MAX;
  mg_large_product(s, s->direction, s->image);
  MG_NOTE_IMAGE(s);
  const mg_real bend = mg_large_dot(n, s->direction, s->image), slope = mg_large_dot(n, s->gradient, s->direction);
  const mg_real step = bend > 0 ? slope / bend : MG_MAX;
  for (int i = 0; i < n; i++)
    if (s->direction[i] > 0) longest = mg_min(longest, s->y[i] / s->direction[i]);
  if (step <= longest && step < MG_MAX) {
    mg_large_move(s, step);
    mg_real turned = 0;
    for (int i = 0; i < n; i++) turned += s->y[i] > 0 ? s->gradient[i] * s->image[i] : 0;
    for (int i = 0; i < n; i++) s->direction[i] = (s->y[i] > 0 ? s->gradient[i] : 0) - turned / bend * s->direction[i];
    return;
  }
  if (longest < MG_MAX) mg_large_move(s, longest);
  for (int i = 0; i < n; i++)
    if (s->y[i] > 0) s->y[i] = mg_max(s->y[i] - s->length * s->gradient[i], (mg_real)0);
  mg_large_gradient(s);
  mg_large_restart(s);
}

/* Residual of the scaled problem; true if it is within the tolerance. */
static int mg_is_large_qp_solved(mg_large_qp *s, mg_lcp_report *report) {
  mg_real worst = 0, growth = 0;
  for (int i = 0; i < s->A->n; i++) {
    const mg_real r = fabs(mg_min(s->y[i], s->gradient[i]));
    if (!(r <= MG_MAX)) worst = MG_MAX;
    worst = mg_max(worst, r), growth = mg_max(growth, s->y[i]);
  }
  report->residual = worst;
  return worst <= mg_max(mg_lcp_tolerance(s->A->n, growth), s->tolerance);
}

/* Iterates from y; returns the outcome. */
static int mg_large_iterate(mg_large_qp *s, int limit, mg_lcp_report *report) {
  mg_large_gradient(s);
  mg_large_restart(s);
  for (report->iterations = 0; report->iterations < limit; report->iterations++) {
    if (report->iterations % MG_CERTIFY_EVERY == 0 && mg_is_large_qp_solved(s, report)) {
      mg_large_gradient(s);
      if (mg_is_large_qp_solved(s, report)) return MG_LCP_SOLVED;
      mg_large_restart(s);
    }
    if (mg_is_chopped_gradient_larger(s)) mg_large_release(s);
    else mg_large_descend(s);
  }
  return MG_LCP_ITERATIONS;
}

MG_API long mg_large_qp_work_size(int n, int n_body) { return 6L * n + 6L * n_body; }

MG_API int mg_large_qp_solve(const mg_row_matrix *A, const mg_real *b, mg_real tolerance, int max_iterations,
                             mg_real *z, mg_lcp_report *report, mg_real *work) {
  const int n = A->n;
  mg_large_qp s = {.A = A,
                   .length = 1,
                   .tolerance = tolerance,
                   .d = work,
                   .c = work + n,
                   .y = work + 2 * n,
                   .gradient = work + 3 * n,
                   .direction = work + 4 * n,
                   .image = work + 5 * n,
                   .per_body = work + 6 * n};
  mg_large_diagonal(&s);
  for (int i = 0; i < n; i++) s.c[i] = b[i] / s.d[i];
  s.scale = mg_max_abs(n, s.c), report->iterations = report->rank = 0, report->residual = MG_MAX;
  if (!mg_all_finite(n, s.c) || !mg_all_finite(n, s.d)) return report->outcome = MG_LCP_NOT_FINITE;
  for (int i = 0; i < n && s.scale > 0; i++) s.c[i] /= s.scale;
  for (int i = 0; i < n; i++) s.y[i] = s.scale > 0 && z[i] > 0 ? z[i] * s.d[i] / s.scale : 0;
  s.length = mg_large_step_length(&s);
  report->outcome = mg_large_iterate(&s, max_iterations, report), report->rank = n;
  for (int i = 0; i < n; i++) z[i] = s.y[i] / s.d[i] * s.scale;
  return report->outcome;
}
