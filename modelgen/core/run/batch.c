/* Many runs: one after the other to their ends (mg_batch), and lanes that are begun and advanced on the scratch memory
   of the caller's thread (mg_begin_many, mg_advance_many). */
#include "run/run.h"
#include "base/base.h"

enum {
  MG_STEPS_OF_CALL = 1000000, /* steps between two looks at the list of events */
  MG_FIRST_FAILURE = 10,      /* outcomes from here on end a run */
  MG_LANE_PARTS = 16          /* a thread takes one lane and this part of those that are left */
};

MG_API void mg_batch(const mg_system *system, const mg_settings *settings, int n, mg_run *runs, mg_real t_stop,
                     int *outcome, mg_events *events, mg_real *work, int *iwork) {
  mg_record record = {0};
  for (int i = 0; i < n; i++) {
    events->count = 0;
    outcome[i] = mg_begin(system, settings, runs + i, events, work, iwork);
    while (!outcome[i] && runs[i].t < t_stop) {
      events->count = 0;
      outcome[i] = mg_advance(system, settings, runs + i, t_stop, MG_STEPS_OF_CALL, &record, events, work, iwork);
      if (outcome[i] == MG_LIST_FULL || (outcome[i] == MG_CONTINUE && !mg_is_raised(runs[i].stop)))
        outcome[i] = MG_DONE;
    }
  }
}

MG_INTERNAL int mg_take_lanes(int n, int *taken, int *end) {
#if defined(__GNUC__)
  int first = __atomic_load_n(taken, __ATOMIC_RELAXED);
  do {
    if (first >= n) return 0;
    *end = first + 1 + (n - first) / MG_LANE_PARTS;
  } while (!__atomic_compare_exchange_n(taken, &first, *end, 0, __ATOMIC_RELAXED, __ATOMIC_RELAXED));
  return *end - first;
#else /* one thread at a time */
  const int count = n - *taken;
  if (count <= 0) return 0;
  *end = *taken = n;
  return count;
#endif
}

MG_API void mg_begin_many(int n, int *taken, const mg_system *const *systems, const mg_settings *const *settings,
                          mg_run *runs, int *outcome, mg_events *events, mg_real *work, int *iwork) {
  for (int count, end; (count = mg_take_lanes(n, taken, &end));)
    for (int i = end - count; i < end; i++)
      outcome[i] = mg_begin(systems[i], settings[i], runs + i, events + i, work, iwork);
}

/* Advances a lane that has not failed; returns its outcome, MG_CONTINUE where it was asked to stop. */
static int mg_advance_lane(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real t_stop,
                           mg_events *events, mg_real *work, int *iwork) {
  mg_record record = {0};
  int outcome = run->t < t_stop ? MG_CONTINUE : MG_DONE;
  while (outcome == MG_CONTINUE) {
    outcome = mg_advance(system, settings, run, t_stop, MG_STEPS_OF_CALL, &record, events, work, iwork);
    if (mg_is_raised(run->stop)) break;
  }
  return outcome;
}

MG_API void mg_advance_many(int n, int *taken, const mg_system *const *systems, const mg_settings *const *settings,
                            mg_run *runs, const mg_real *t_stop, int *outcome, mg_events *events, mg_real *work,
                            int *iwork) {
  for (int count, end; (count = mg_take_lanes(n, taken, &end));)
    for (int i = end - count; i < end; i++)
      if (outcome[i] < MG_FIRST_FAILURE)
        outcome[i] = mg_advance_lane(systems[i], settings[i], runs + i, t_stop[i], events + i, work, iwork);
}
