/* Parts of the caller's scratch memory, and an int of the caller that another thread may set. */
#include "base/base.h"

/* Bytes at whose multiples structures of the core begin. Where an mg_real is shorter, memory of them may begin between
   two such places. */
static size_t mg_alignment(void) {
  const size_t least = sizeof(mg_digest) > sizeof(void *) ? sizeof(mg_digest) : sizeof(void *);
  return sizeof(mg_real) > least ? sizeof(mg_real) : least;
}

MG_INTERNAL long mg_count_reals(long n, size_t size) {
  const size_t unit = mg_alignment(), reals = unit / sizeof(mg_real);
  return (long)(((size_t)n * size + unit - 1) / unit * reals + reals - 1);
}

MG_INTERNAL void *mg_take_memory(mg_real **memory, long n, size_t size) {
  const size_t unit = mg_alignment(), beyond = sizeof(mg_real) < unit ? (size_t)*memory % unit : 0;
  void *at = (unsigned char *)*memory + (beyond ? unit - beyond : 0);
  *memory += mg_count_reals(n, size);
  return at;
}

MG_INTERNAL mg_real *mg_take_reals(mg_real **next, long long n) {
  mg_real *block = *next;
  *next += n;
  return block;
}

MG_INTERNAL int *mg_take_ints(int **next, long long n) {
  int *block = *next;
  *next += n;
  return block;
}

MG_INTERNAL void mg_zero_reals(mg_real *a, long n) {
  for (long i = 0; i < n; i++) a[i] = 0;
}

MG_INTERNAL int mg_is_raised(const int *flag) {
#if defined(__GNUC__)
  return flag && __atomic_load_n(flag, __ATOMIC_RELAXED);
#else
  return flag && *(const volatile int *)flag;
#endif
}
