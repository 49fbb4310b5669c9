/* Bounds of a function over boxes, for a caller in Python. */
MG_API void bound_over_box(const mg_instruction *instructions, int n, const mg_real *constants, const mg_real *box,
                           const mg_real *parameters, int wanted, mg_taylor_model *memory, int n_memory,
                           mg_taylor_model *out, mg_real *kink) {
  const mg_bounds_program program = {n, n_memory, 0, instructions, constants, 0};
  mg_bound_over_box(&program, box, parameters, wanted, memory, out, kink);
}

/* Bounds of a derivative of a spline with the given knots, and the coefficients behind them. */
MG_API void bound_spline(int coordinate, int order, int pieces, const mg_real *numbers, const mg_real *box,
                         mg_taylor_model *out, mg_real *kink) {
  const mg_instruction instructions[2] = {{MG_OP_SPLINE, 0, 0, 0}, {MG_OP_OUTPUT, 0, 0, 0}};
  const mg_bounds_spline spline = {coordinate, order, pieces, 0, 0, pieces + 1};
  const mg_bounds_program program = {2, 1, 0, instructions, numbers, &spline};
  mg_taylor_model memory[1];
  mg_bound_over_box(&program, box, numbers, 1, memory, out, kink);
}
