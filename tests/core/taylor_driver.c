/* Bounds of a function over boxes, for a caller in Python. */
MG_API void bound_over_box(const mg_instruction *instructions, int n, const mg_real *constants, const mg_real *box,
                           const mg_real *parameters, int wanted, mg_taylor_model *memory, int n_memory,
                           mg_taylor_model *out, mg_real *kink) {
  const mg_bounds_program program = {n, n_memory, 0, instructions, constants};
  mg_bound_over_box(&program, box, parameters, wanted, memory, out, kink);
}
