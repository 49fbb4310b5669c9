/* The public functions: memory, start, advance, batches, queries. May use: every room. */
#ifndef MG_RUN_H
#define MG_RUN_H

#include "model/context.h"

#define MG_FRICTION_ROWS_MAX 5 /* most friction rows of a contact */

/* workspace.c */

/* Sets up a context for a call on the caller's memory, with the contacts on the feature pairs of the run. No state
   is evaluated. */
MG_INTERNAL void mg_open_context(mg_context *c, const mg_system *system, const mg_settings *settings, mg_run *run,
                                 mg_real *work, int *iwork);

/* inputs.c */

#define MG_JOINT_ROWS_MAX 6 /* most rows of a joint */

/* Notes that the inputs of the run have taken effect. */
MG_INTERNAL void mg_accept_inputs(const mg_context *c);

/* Lets inputs that the caller has changed take effect at the run's time. Needs the poses. Returns an outcome. */
MG_INTERNAL int mg_apply_inputs(mg_context *c, mg_events *events);

/* nonfinite_inputs.c */

/* Outcome of a run that cannot go on: MG_NOT_FINITE if a function of time is unbounded, else the given one. */
MG_INTERNAL int mg_explain_failed_outcome(mg_context *c, int outcome);

#endif
