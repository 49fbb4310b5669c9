/* The right-hand side of one free body that touches one fixed body in one point, without slip or without friction,
   written for that alone around the generated kernels, and its RK4 step: the yardstick of the core's assembly and
   solution. BODY_KIND, CONTACT_KIND, ROWS (3: sticking, 1: without friction), N_ETA (of that contact) and BODY_IS_O are given when it is
   compiled, in the folder of a scene. Its mass is 1/m and the diagonal of 1/I. */
#include "model.c"

typedef struct {
  const mg_real *place, *gravity, *body, *contact, *mass_inverse; /* pose of the fixed body, and parameters */
} scene;

enum { STATES = 13 + N_ETA };

static void slope(const scene *S, const mg_real *x, mg_real *x_dot) {
  static const mg_real rest[6] = {0};
  const mg_real *w = S->mass_inverse;
  mg_real pose[12], a[6], d, J[18] = {0}, none[18], gamma[3], normal[3], tangents[6], MJ[18], A[6], b[3], f[3];
  body_pose(BODY_KIND, x, pose);
  body_motion(BODY_KIND, x, x + 7, 0, S->gravity, S->body, x_dot, a);
  if (BODY_IS_O)
    contact_rates(CONTACT_KIND, pose, x + 7, S->place, rest, x + 13, S->contact, &d, J, none, gamma, x_dot + 13, normal,
                  tangents);
  else
    contact_rates(CONTACT_KIND, S->place, rest, pose, x + 7, x + 13, S->contact, &d, none, J, gamma, x_dot + 13, normal,
                  tangents);
  for (int r = 0; r < ROWS; r++) {
    for (int k = 0; k < 3; k++) MJ[6 * r + k] = w[0] * J[6 * r + k];
    for (int k = 3; k < 6; k++) MJ[6 * r + k] = w[k - 2] * J[6 * r + k];
    b[r] = gamma[r];
    for (int k = 0; k < 6; k++) b[r] += J[6 * r + k] * a[k];
  }
  for (int r = 0, at = 0; r < ROWS; r++)
    for (int c = 0; c <= r; c++, at++) {
      A[at] = 0;
      for (int k = 0; k < 6; k++) A[at] += J[6 * r + k] * MJ[6 * c + k];
    }
#if ROWS == 1
  f[0] = -b[0] / A[0];
#else
  /* L D L^T, the entries of A by rows of its lower triangle */
  const mg_real d0 = 1 / A[0], l10 = A[1] * d0, l20 = A[3] * d0, d1 = 1 / (A[2] - l10 * A[1]), s21 = A[4] - l20 * A[1],
                l21 = s21 * d1, d2 = 1 / (A[5] - l20 * A[3] - l21 * s21);
  const mg_real y1 = b[1] - l10 * b[0], y2 = b[2] - l20 * b[0] - l21 * y1;
  f[2] = -y2 * d2, f[1] = -y1 * d1 - l21 * f[2], f[0] = -b[0] * d0 - l10 * f[1] - l20 * f[2];
#endif
  for (int k = 0; k < 6; k++) {
    x_dot[7 + k] = a[k];
    for (int r = 0; r < ROWS; r++) x_dot[7 + k] += MJ[6 * r + k] * f[r];
  }
}

MG_API void prototype_steps(const scene *S, mg_real *x, mg_real h, long n) {
  mg_real k1[STATES], k2[STATES], k3[STATES], k4[STATES], y[STATES];
  for (long step = 0; step < n; step++) {
    slope(S, x, k1);
    for (int i = 0; i < STATES; i++) y[i] = x[i] + h / 2 * k1[i];
    slope(S, y, k2);
    for (int i = 0; i < STATES; i++) y[i] = x[i] + h / 2 * k2[i];
    slope(S, y, k3);
    for (int i = 0; i < STATES; i++) y[i] = x[i] + h * k3[i];
    slope(S, y, k4);
    for (int i = 0; i < STATES; i++) x[i] += h / 6 * (k1[i] + 2 * (k2[i] + k3[i]) + k4[i]);
  }
}
