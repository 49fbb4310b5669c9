/* Parts of the caller's scratch memory. */
#include "base/base.h"

MG_INTERNAL long mg_count_reals(long n, size_t size) {
  const size_t unit = sizeof(mg_real) > sizeof(void *) ? sizeof(mg_real) : sizeof(void *);
  return (long)(((size_t)n * size + unit - 1) / unit * (unit / sizeof(mg_real)));
}

MG_INTERNAL void *mg_take_memory(mg_real **memory, long n, size_t size) {
  void *at = *memory;
  *memory += mg_count_reals(n, size);
  return at;
}

MG_INTERNAL mg_real *mg_take_reals(mg_real **next, long n) {
  mg_real *block = *next;
  *next += n;
  return block;
}

MG_INTERNAL int *mg_take_ints(int **next, long n) {
  int *block = *next;
  *next += n;
  return block;
}

MG_INTERNAL void mg_zero_reals(mg_real *a, long n) {
  for (long i = 0; i < n; i++) a[i] = 0;
}
