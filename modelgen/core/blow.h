/* A blow at one contact, and blows in turn. */
#ifndef MG_BLOW_H
#define MG_BLOW_H

#include "core.h"

typedef struct {
  mg_real G[9];     /* J M^-1 J^T of N, t1, t2, joints held, row after row */
  mg_real mu[2];    /* along t1 and t2; zeros: no friction */
  mg_real u[6];     /* rates along N, t1, t2; impulses along t1, t2; work of the normal impulse */
  mg_real p;        /* the normal impulse so far */
  mg_real share[2]; /* tangential over normal impulse, once slip has ended or kept its direction */
  mg_real swift;    /* the speed that it began with */
  int straight;     /* slip keeps its direction, until it ends */
  int ended;        /* slip has ended, or begun anew in a direction that it keeps */
} mg_blow;

/* blow.c */
MG_INTERNAL int mg_blow_by(mg_blow *b, int law, mg_real e);

#endif
