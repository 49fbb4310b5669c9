/* Vectors of two, three and six components, and transformations between axes. A pose is a position (3) and a
   rotation matrix by columns (9). */
#include "base/base.h"

MG_INTERNAL int mg_all_finite(int count, const mg_real *x) {
  mg_real sum = 0; /* of zeros, or NaN */
  for (int i = 0; i < count; ++i) sum += 0 * x[i];
  return sum == 0;
}

MG_INTERNAL mg_real mg_max_abs(int count, const mg_real *x) {
  mg_real largest = 0;
  for (int i = 0; i < count; ++i) largest = fabs(x[i]) > largest ? (mg_real)fabs(x[i]) : largest;
  return largest;
}

MG_INTERNAL mg_real mg_dot2(const mg_real *a, const mg_real *b) { return a[0] * b[0] + a[1] * b[1]; }

MG_INTERNAL mg_real mg_cross2(const mg_real *a, const mg_real *b) { return a[0] * b[1] - a[1] * b[0]; }

MG_INTERNAL mg_real mg_distance2(const mg_real *a, const mg_real *b) {
  const mg_real d[2] = {b[0] - a[0], b[1] - a[1]};
  return sqrt(mg_dot2(d, d));
}

MG_INTERNAL void mg_rotate_back(const mg_real *R, const mg_real *x, mg_real *out) {
  const mg_real a = x[0], b = x[1], d = x[2];
  for (int k = 0; k < 3; k++) out[k] = R[3 * k] * a + R[3 * k + 1] * b + R[3 * k + 2] * d;
}

MG_INTERNAL mg_real mg_dot3(const mg_real *a, const mg_real *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

MG_INTERNAL mg_real mg_dot6(const mg_real *a, const mg_real *b) {
  return ((a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])) + (a[4] * b[4] + a[5] * b[5]);
}

MG_INTERNAL int mg_normalise3(mg_real *n) {
  const mg_real length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), scale = 1 / length;
  for (int k = 0; k < 3; k++) n[k] *= scale;
  return length > 0 && length <= MG_MAX;
}

MG_INTERNAL void mg_to_world(const mg_real *pose, const mg_real *x, int is_point, mg_real *out) {
  for (int k = 0; k < 3; k++)
    out[k] = (mg_real)is_point * pose[k] + pose[3 + k] * x[0] + pose[6 + k] * x[1] + pose[9 + k] * x[2];
}

MG_INTERNAL void mg_world_to_local_point(const mg_real *pose, const mg_real *world, mg_real *local) {
  const mg_real arm[3] = {world[0] - pose[0], world[1] - pose[1], world[2] - pose[2]};
  mg_rotate_back(pose + 3, arm, local);
}

MG_INTERNAL void mg_cross_product(const mg_real *a, const mg_real *b, mg_real *out) {
  out[0] = a[1] * b[2] - a[2] * b[1], out[1] = a[2] * b[0] - a[0] * b[2], out[2] = a[0] * b[1] - a[1] * b[0];
}

MG_INTERNAL void mg_sort_ints(int count, int *list) {
  int gap = 1;
  while (gap < count / 3) gap = 3 * gap + 1;
  for (; gap > 0; gap /= 3)
    for (int i = gap; i < count; i++) {
      const int value = list[i];
      int k = i;
      for (; k >= gap && list[k - gap] > value; k -= gap) list[k] = list[k - gap];
      list[k] = value;
    }
}

MG_INTERNAL void mg_copy_reals(mg_real *restrict to, const mg_real *restrict from, int n) {
  for (int i = 0; i < n; i++) to[i] = from[i];
}
