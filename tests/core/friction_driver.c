/* The friction solver on problems of all kinds, for the sanitizers; status 1 if an answer called solved is none. */
#include <stdio.h>
#include <stdlib.h>

enum { DRIVER_CONTACTS = 3, DRIVER_MAX = 6 * DRIVER_CONTACTS + 3 };

static unsigned driver_state = 1;

static mg_real driver_random(void)
{
  driver_state = driver_state * 1664525u + 1013904223u;
  return (mg_real)(driver_state >> 8) / (mg_real)(1u << 23) - 1;
}

static void driver_matrix(int n, int rank, mg_real *A, mg_real *b)
{
  mg_real J[DRIVER_MAX * DRIVER_MAX];
  for (int i = 0; i < n * rank; ++i) J[i] = driver_random();
  for (int i = 0; i < n; ++i) {
    b[i] = driver_random();
    for (int j = 0; j < n; ++j) {
      A[i + j * n] = 0;
      for (int k = 0; k < rank; ++k) A[i + j * n] += J[i + k * n] * J[j + k * n];
    }
  }
}

/* `extra` rows of no contact lie before the contacts. */
static int driver_solve(int contacts, int rows, int extra, int rank, int law)
{
  const int n = rows * contacts + extra;
  mg_real A[DRIVER_MAX * DRIVER_MAX], b[DRIVER_MAX], z[DRIVER_MAX] = {0}, cone[MG_CONE * DRIVER_CONTACTS];
  int first[DRIVER_CONTACTS], each[DRIVER_CONTACTS], marks[DRIVER_CONTACTS];
  mg_real *work = malloc(sizeof(mg_real) * (size_t)mg_friction_work_size(n, contacts));
  int *iwork = malloc(sizeof(int) * (size_t)mg_friction_iwork_size(n, contacts));
  mg_friction_problem problem = {n, contacts, law, 1, first, each, cone, A, b, law, 0, 0};
  mg_friction_report report;
  driver_matrix(n, rank, A, b);
  for (int c = 0; c < contacts; ++c) {
    first[c] = extra + rows * c;
    each[c] = rows;
    for (int i = 0; i < MG_CONE; ++i) cone[MG_CONE * c + i] = driver_random() + (mg_real)0.8;
    for (int i = 0; i < MG_CONE; ++i) cone[MG_CONE * c + i] *= cone[MG_CONE * c + i] > 0;
  }
  mg_friction(&problem, z, marks, &report, work, iwork);
  free(work);
  free(iwork);
  return report.outcome == MG_FRICTION_SOLVED && !(mg_friction_residual(&problem, z) <= MG_LCP_CAP);
}

int main(void)
{
  const int rows[] = {1, 3, 6};
  int wrong = 0;
  for (int contacts = 0; contacts <= DRIVER_CONTACTS; ++contacts)
    for (int kind = 0; kind < 3; ++kind)
      for (int extra = 0; extra <= 3; extra += 3)
        for (int law = 0; law <= 1; ++law)
          for (int rank = 1; rank <= rows[kind] * contacts + extra; rank += 5)
            wrong += driver_solve(contacts, rows[kind], extra, rank, law);
  printf("%d wrong\n", wrong);
  return wrong != 0;
}
