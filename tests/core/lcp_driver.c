/* Every solver on problems of all kinds, for the sanitizers; status 1 if an answer called solved is none. */
#include <stdio.h>
#include <stdlib.h>

enum { DRIVER_MAX = 9 };

static unsigned driver_state = 1;

static mg_real driver_random(void)
{
  driver_state = driver_state * 1664525u + 1013904223u;
  return (mg_real)(driver_state >> 8) / (mg_real)(1u << 23) - 1;
}

static void driver_problem(int n, int rank, int skew, mg_real *A, mg_real *b)
{
  mg_real J[DRIVER_MAX * DRIVER_MAX];
  for (int i = 0; i < n * rank; ++i) J[i] = driver_random();
  for (int i = 0; i < n; ++i) {
    b[i] = driver_random();
    for (int j = 0; j < n; ++j) {
      A[i + j * n] = (mg_real)(skew * (i - j)) / 4;
      for (int k = 0; k < rank; ++k) A[i + j * n] += J[i + k * n] * J[j + k * n];
    }
  }
}

static int driver_wrong(int n, const mg_real *A, const mg_real *b, const mg_real *z, const mg_lcp_report *report)
{
  return report->outcome == MG_LCP_SOLVED && !(mg_lcp_residual(n, A, b, z) <= MG_LCP_CAP);
}

static int driver_solve(int n, const mg_real *A, const mg_real *b, mg_real *work, int *iwork)
{
  mg_real z[DRIVER_MAX];
  int active[DRIVER_MAX] = {0}, wrong = 0;
  mg_lcp_report report;
  mg_qp(n, A, b, 100, z, active, &report, work, iwork);
  wrong += driver_wrong(n, A, b, z, &report);
  mg_active_solve(n, A, b, active, z, work, iwork);
  mg_lemke(n, A, b, 500, z, &report, work, iwork);
  wrong += driver_wrong(n, A, b, z, &report);
  mg_enumerate(n, A, b, z, &report, work, iwork);
  return wrong + driver_wrong(n, A, b, z, &report);
}

int main(void)
{
  int wrong = 0;
  for (int n = 0; n <= DRIVER_MAX; ++n) {
    mg_real *work = malloc(sizeof(mg_real) * (size_t)mg_lcp_work_size(n));
    int *iwork = malloc(sizeof(int) * (size_t)mg_lcp_iwork_size(n));
    for (int rank = 0; rank <= n; ++rank)
      for (int skew = 0; skew <= 1; ++skew) {
        mg_real A[DRIVER_MAX * DRIVER_MAX], b[DRIVER_MAX];
        driver_problem(n, rank, skew, A, b);
        wrong += driver_solve(n, A, b, work, iwork);
      }
    free(work);
    free(iwork);
  }
  printf("%d wrong\n", wrong);
  return wrong != 0;
}
