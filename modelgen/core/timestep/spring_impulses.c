/* Springs and dampers in a step of time-stepping. With the deflection s_k at its start and J in its middle, the impulse
   of a spring is linear in the velocities u at the end of the step:

     p = -h k (s_k + (h / 2) (phi J u + (1 - phi) J u_k)) - h c (theta J u + (1 - theta) J u_k) = p_0 - g J u,
     theta = (3 + z) / (6 + z),  z = h c a,  phi = (2 + y) / (4 + y),  y = h^2 k a m,  a = J M^-1 J^T,

   m the number of springs on that of its bodies which has more. This is of order 2, because theta and phi are 1/2 +
   O(h). A damper alone on its bodies multiplies its rate by (6 - 2 z) / (6 + 4 z + z^2), the Pade approximation (1, 2)
   of exp(-z), which vanishes for stiff dampers.

   It is stable for any k and c. Let E = sum (h^2 k / 2) (1 - phi) J^T J, F the same with phi, and D, G = sum h c (1 -
   theta) J^T J, sum h c theta J^T J. Where positions follow u, a mode x with factor l per step satisfies the quadratic
   equation with the coefficients x'(M + F + G) x, -x'(2 M + G - D - F - 3 E) x, x'(M - D - E) x. Its roots have |l| <=
   1 if D <= G and E <= M + (G - D) / 2: the first holds as theta >= 1/2, the second as E <= M, because x'E x <= max
   over the springs of y (1 - phi) / 2 < 1 for x'M x = 1 (Cauchy's inequality on the m springs of a body). Where they
   follow (u + u_k) / 2 the conditions are weaker, and without dampers the energy is kept.

   The matrix M + sum g J^T J of the step is symmetric and positive definite. It is not formed: with rows sqrt(g) J,

     sqrt(g) J u + p / sqrt(g) - p_0 / sqrt(g) = 0,

   springs are bilateral constraints of the impulse problem, with 1 added to their diagonal of J M^-1 J^T. Forces across
   J as it turns, the tension over the length of a spring, are not part of the matrix. Writes c->rows and c->springs. */
#include "timestep/timestep.h"
#include "model/model.h"

/* Stiffness and damping of the spring of a row. */
static const mg_real *mg_spring_coefficients(const mg_context *c, int row) {
  const mg_system *s = c->system;
  const int load = c->springs.load[row - c->layout.spring_row_begin];
  return s->parameters + s->load_parameters[load] + c->kernels->load_kinds[s->load_kind[load]].n_parameters - 3;
}

/* Bound r of the rates of a spring alone on its two bodies, 1/s. Writes M^-1 J^T of its row. */
static mg_real mg_spring_rate(mg_context *c, int row) {
  const mg_real *numbers = mg_spring_coefficients(c, row), mobility = mg_update_inverse_mass_row(c, row);
  return numbers[1] * mobility + sqrt(numbers[0] * mobility);
}

MG_INTERNAL void mg_predict_springs(mg_context *c, mg_real h) {
  MG_NEEDS_ANY(c, MG_VALID_TWISTS);
  for (int i = c->layout.spring_row_begin; i < c->layout.spring_row_end; i++) {
    const mg_real *numbers = mg_spring_coefficients(c, i);
    c->rows.d[i] = mg_update_spring_row(c, i);
    const mg_real push = -numbers[0] * c->rows.d[i] - numbers[1] * mg_row_times(c, i, c->bodies.twist);
    mg_add_row_response(c, i, push / (1 + h * mg_spring_rate(c, i)), c->bodies.acceleration);
  }
}

MG_INTERNAL void mg_update_spring_rows(mg_context *c) {
  MG_NEEDS_ANY(c, MG_VALID_POSES);
  for (int i = c->layout.spring_row_begin; i < c->layout.spring_row_end; i++) mg_update_spring_row(c, i);
}

MG_INTERNAL void mg_set_spring_impulses(mg_context *c, mg_real h) {
  MG_NEEDS_ANY(c, MG_VALID_TWISTS);
  for (int i = c->layout.spring_row_begin; i < c->layout.spring_row_end; i++) {
    const mg_real *numbers = mg_spring_coefficients(c, i), mobility = mg_update_inverse_mass_row(c, i);
    const mg_real z = h * numbers[1] * mobility, theta = (3 + z) / (6 + z);
    const mg_real y = h * h * numbers[0] * mobility * c->springs.sharing[i - c->layout.spring_row_begin],
                  phi = (2 + y) / (4 + y);
    const mg_real half = h * h * numbers[0] / 2, gain = half * phi + h * numbers[1] * theta, root = sqrt(gain);
    const mg_real start_rate = mg_row_times(c, i, c->bodies.twist);
    const mg_real fixed =
        -h * numbers[0] * c->rows.d[i] - (half * (1 - phi) + h * numbers[1] * (1 - theta)) * start_rate;
    mg_report_spring_rate(c->run, c->springs.load[i - c->layout.spring_row_begin], mg_spring_rate(c, i));
    for (int k = 0; k < 12; k++) c->rows.J[12 * i + k] *= root;
    c->rows.d_dot[i] = root * start_rate;
    c->springs.impulse[i - c->layout.spring_row_begin] = gain > 0 ? fixed / root : 0;
  }
}

/* Mean over the step of the part of a row's rate that bodies moved by forces cause. */
static mg_real mg_mean_moving_rate(const mg_context *c, int row, mg_real h) {
  mg_real rate = 0;
  for (int side = 0; side < 2; side++) {
    const int body = side ? c->contacts.f[row] : c->contacts.o[row];
    for (int k = 0; k < 6 && mg_is_moved_by_forces(c, body); k++) {
      const mg_real change = h * c->bodies.acceleration[6 * body + k] + c->bodies.wrench[6 * body + k];
      rate += c->rows.J[12 * row + 6 * side + k] * (c->bodies.twist[6 * body + k] + change / 2);
    }
  }
  return rate;
}

MG_INTERNAL mg_real mg_spring_work(const mg_context *c, mg_real h) {
  mg_real work = 0;
  for (int i = c->layout.spring_row_begin; i < c->layout.spring_row_end; i++)
    work += c->solution.force[i] * mg_mean_moving_rate(c, i, h);
  return work;
}
