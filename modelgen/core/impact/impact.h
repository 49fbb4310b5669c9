/* Impacts: simultaneous and sequential, without and with friction. May use: patch and the rooms below it. */
#ifndef MG_IMPACT_H
#define MG_IMPACT_H

#include "model/context.h"

typedef struct {
  mg_real G[9];           /* J M^-1 J^T of N, t1, t2, joints held, row after row */
  mg_real mu[2];          /* along t1 and t2; zeros: no friction */
  mg_real velocity[6];    /* rates along N, t1, t2; impulses along t1, t2; work of the normal impulse */
  mg_real impulse;        /* the normal impulse so far */
  mg_real force_ratio[2]; /* tangential over normal impulse, once slip has ended or kept its direction */
  mg_real initial_speed;  /* the speed that it began with */
  int keeps_direction;    /* slip keeps its direction, until it ends */
  int slip_ended;         /* slip has ended, or begun anew in a direction that it keeps */
} mg_impact_path;

/* impulse_path.c */
MG_INTERNAL int mg_integrate_impact_path(mg_impact_path *b, int law, mg_real e);

/* newton_impact.c */
MG_INTERNAL int mg_is_approaching(const mg_context *c, int contact);
MG_INTERNAL mg_real mg_effective_restitution(const mg_context *c, int contact);
MG_INTERNAL void mg_apply_impulses(mg_context *c, int n);
MG_INTERNAL mg_real mg_remaining_bounce_time(mg_context *c, int contact);
MG_INTERNAL void mg_set_support_impact_rates(mg_context *c);
MG_INTERNAL int mg_resolve_impacts(mg_context *c, mg_events *events);

/* frictional_impact.c */
MG_INTERNAL int mg_solve_frictional_impulses(mg_context *c);
MG_INTERNAL void mg_note_impact_energy_gain(mg_context *c, int n);
MG_INTERNAL void mg_reset_friction_modes(mg_context *c);

/* sequential_impact.c */
MG_INTERNAL int mg_is_impact_sequential(const mg_context *c);
MG_INTERNAL int mg_resolve_impacts_in_sequence(mg_context *c, mg_events *events);

#endif
