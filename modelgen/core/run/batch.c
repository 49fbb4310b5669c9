/* Many runs of one system, one after the other, on the same scratch memory (mg_batch). */
#include "run/run.h"

MG_API void mg_batch(const mg_system *system, const mg_settings *settings, int n, mg_run *runs, mg_real t_stop,
                     int *outcome, mg_events *events, mg_real *work, int *iwork) {
  mg_record record = {0};
  for (int i = 0; i < n; i++) {
    events->count = 0;
    outcome[i] = mg_begin(system, settings, runs + i, events, work, iwork);
    while (!outcome[i] && runs[i].t < t_stop) {
      events->count = 0;
      outcome[i] = mg_advance(system, settings, runs + i, t_stop, 1000000, &record, events, work, iwork);
      if (outcome[i] == MG_CONTINUE || outcome[i] == MG_LIST_FULL) outcome[i] = MG_DONE;
    }
  }
}
