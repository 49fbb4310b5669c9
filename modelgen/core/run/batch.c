/* Many runs: one after the other to their ends (mg_batch), and lanes that are begun and advanced on the scratch memory
   of the caller's thread (mg_begin_many, mg_advance_many). */
#include "run/run.h"

enum {
  MG_STEPS_OF_CALL = 1000000, /* steps between two looks at the list of events */
  MG_FIRST_FAILURE = 10       /* outcomes from here on end a run */
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
      if (outcome[i] == MG_CONTINUE || outcome[i] == MG_LIST_FULL) outcome[i] = MG_DONE;
    }
  }
}

MG_API void mg_begin_many(int n, const mg_system *const *systems, const mg_settings *settings, mg_run *runs,
                          int *outcome, mg_events *events, mg_real *work, int *iwork) {
  for (int i = 0; i < n; i++) outcome[i] = mg_begin(systems[i], settings, runs + i, events + i, work, iwork);
}

MG_API void mg_advance_many(int n, const mg_system *const *systems, const mg_settings *settings, mg_run *runs,
                            const mg_real *t_stop, int *outcome, mg_events *events, mg_real *work, int *iwork) {
  mg_record record = {0};
  for (int i = 0; i < n; i++) {
    if (outcome[i] >= MG_FIRST_FAILURE) continue;
    outcome[i] = runs[i].t < t_stop[i] ? MG_CONTINUE : MG_DONE;
    while (outcome[i] == MG_CONTINUE)
      outcome[i] =
          mg_advance(systems[i], settings, runs + i, t_stop[i], MG_STEPS_OF_CALL, &record, events + i, work, iwork);
  }
}
