/* Impacts: simultaneous and sequential, without and with friction. May use: patch and the rooms below it. */
#ifndef MG_IMPACT_H
#define MG_IMPACT_H

#include "model/context.h"

/* Impact at one contact as a path in its normal impulse. */
typedef struct {
  mg_real G[9];           /* J M^-1 J^T of N, t1, t2 with the joints held, by rows */
  mg_real mu[2];          /* coefficients of friction along t1 and t2; zeros: no friction */
  mg_real velocity[6];    /* velocities along N, t1, t2; impulses along t1, t2; work of the normal impulse */
  mg_real impulse;        /* normal impulse so far, N s */
  mg_real force_ratio[2]; /* tangential over normal impulse, after slip has ended or while it keeps its direction */
  mg_real initial_speed;  /* speed at the start */
  int keeps_direction;    /* 1: slip keeps its direction until it ends */
  int slip_ended;         /* 1: slip has ended, or has begun again in a direction that it keeps */
} mg_impact_path;

/* impulse_path.c */

/* Integrate the whole impact, compression and restitution, from the given velocities; returns 0 where it does not
   end. */
MG_INTERNAL int mg_integrate_impact_path(mg_impact_path *b, int law, mg_real e);

/* approach_and_restitution.c */

/* True if the gap closes faster than rest_speed, so that the contact may bounce. */
MG_INTERNAL int mg_is_approaching(const mg_context *c, int contact);

/* Restitution coefficient that applies at this approach velocity; 0 where the rebound, or the approach, is too
   slow to count. Without the margin of 5/4 on the approach a gap that is just being pressed closed would rebound
   for ever at restitution 1. */
MG_INTERNAL mg_real mg_effective_restitution(const mg_context *c, int contact);

/* Total time in s of the ever shorter flights that a contact closed at small approach velocity would still have
   made; 0 where hardly anything presses it. */
MG_INTERNAL mg_real mg_remaining_bounce_time(mg_context *c, int contact);

/* Set the velocities that the impulses must cancel on supports and joints; the supports of a face that lands flat
   rebound with one coefficient. Needs the rates at the run's state. */
MG_INTERNAL void mg_set_support_impact_rates(mg_context *c);

/* applied_impulses.c */

/* Add the impulses of the first n listed rows to the velocities of the run's state, and the work they do on the
   moving bodies to its work. Needs the rates before the impact. */
MG_INTERNAL void mg_apply_impulses(mg_context *c, int n);

/* Record an impact that gains kinetic energy, and the contact that gains most. Needs the impulses of the first n
   listed rows and the velocities before the impact. */
MG_INTERNAL void mg_note_impact_energy_gain(mg_context *c, int n);

/* Reset all friction modes after an impact, so that the slip velocities decide them again. */
MG_INTERNAL void mg_reset_friction_modes(mg_context *c);

/* simultaneous_impact.c */

/* Resolve the impacts at the run's state. Faces that land flat are struck as one if the impulse presses them
   together within their hull; otherwise the contacts they cover are struck singly. Needs the rows at the run's
   state. */
MG_INTERNAL int mg_resolve_impacts(mg_context *c, mg_events *events);

/* frictional_impact.c */

/* Solve the impulses with Newton's restitution and Coulomb's law. Returns how many listed rows belong to
   contacts, -1 without a solution. */
MG_INTERNAL int mg_solve_frictional_impulses(mg_context *c);

/* sequential_impact.c */

/* True if contacts are struck one after another: by setting, or because one follows a single-contact law
   (Poisson, Stronge). */
MG_INTERNAL int mg_is_impact_sequential(const mg_context *c);

/* Strike the fastest approaching contact until none approaches fast enough to rebound; returns 0 where an impact
   has no end. */
MG_INTERNAL int mg_resolve_impacts_in_sequence(mg_context *c, mg_events *events);

#endif
