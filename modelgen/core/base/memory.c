/* base/memory */
#include "base/base.h"

MG_INTERNAL long mg_reals(long n, size_t size) {
  const size_t unit = sizeof(mg_real) > sizeof(void *) ? sizeof(mg_real) : sizeof(void *);
  return (long)(((size_t)n * size + unit - 1) / unit * (unit / sizeof(mg_real)));
}

MG_INTERNAL void *mg_part_of_memory(mg_real **memory, long n, size_t size) {
  void *at = *memory;
  *memory += mg_reals(n, size);
  return at;
}

MG_INTERNAL mg_real *mg_take(mg_real **next, long n) {
  mg_real *block = *next;
  *next += n;
  return block;
}

MG_INTERNAL int *mg_take_int(int **next, long n) {
  int *block = *next;
  *next += n;
  return block;
}

MG_INTERNAL void mg_zero(mg_real *a, long n) {
  for (long i = 0; i < n; i++) a[i] = 0;
}
