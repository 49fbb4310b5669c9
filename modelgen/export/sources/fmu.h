/* A run behind the interface of FMI: variables by number, times, saved states. */
#ifndef FMU_H
#define FMU_H

#include <stddef.h>

#include "fmu_model.h"
#include "scene.h"

/* One instance. */
typedef struct {
  scene_instance scene;
  int is_settled;  /* 1: the start is settled for the present inputs */
  int is_stepping; /* 1: initialisation is over */
  int outcome;     /* MG_DONE as long as the run goes on */
  int may_return_early;
  void *environment; /* of the importer, for messages */
  char name[128];
} fmu;

/* A saved state. */
typedef struct {
  int is_settled, is_stepping, outcome;
  unsigned char bytes[SCENE_SAVE_SIZE];
} fmu_state;

/* Puts an instance at its start at time t, s. */
void fmu_reset(fmu *instance, double t);

/* Moves the start of an instance to time t, s; inputs keep their values. */
void fmu_start_at(fmu *instance, double t);

/* Settles the start for the present inputs, if that is due. 1: done; 0: the start is refused. */
int fmu_settle(fmu *instance);

/* Read and write variables by number; 0: there is no such number, it cannot be set, or the value is refused. */
int fmu_get(fmu *instance, const unsigned *numbers, size_t n, double *values);
int fmu_set(fmu *instance, const unsigned *numbers, size_t n, const double *values);

/* Advances by `step` from time t. 1: it got there; 0: it did not, see `outcome` and scene.run.t. *is_early: an event
   came first, and the instance may return early. */
int fmu_advance(fmu *instance, double t, double step, int *is_early);

void fmu_save(const fmu *instance, fmu_state *state);
int fmu_load(fmu *instance, const fmu_state *state);

/* Why a run ended or was refused, in words. */
const char *fmu_reason(int outcome);

#endif
