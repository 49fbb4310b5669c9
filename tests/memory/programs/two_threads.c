/* Lanes of an exported scene on two threads that share them; one lane is asked to stop while it runs. */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

#include "scene.h"

enum { LANES = 6, CALLS = 3, THREADS = 2 };
static scene_instance lane[LANES];
static mg_run runs[LANES];
static mg_events events[LANES];
static const mg_system *systems[LANES];
static const mg_settings *settings[LANES];
static int outcome[LANES], taken, stop, call;
static mg_real t_stop[LANES], sensors[LANES * (SCENE_N_SENSOR + 1)];

static void *begin(void *scratch) {
  const scene_instance *s = scratch;
  mg_begin_many(LANES, &taken, systems, settings, runs, outcome, events, (mg_real *)s->work, (int *)s->iwork);
  return 0;
}

static void *advance(void *scratch) {
  const scene_instance *s = scratch;
  mg_advance_many(LANES, &taken, systems, settings, runs, t_stop, outcome, events, (mg_real *)s->work,
                  (int *)s->iwork);
  return 0;
}

static void *sense(void *scratch) {
  const scene_instance *s = scratch;
  mg_sense_many(LANES, &taken, systems, settings, runs, sensors, (mg_real *)s->work, (int *)s->iwork);
  return 0;
}

/* Makes a call in all threads; with `stopped`, asks a lane to stop meanwhile. */
static void share(void *(*work)(void *), int stopped) {
  pthread_t thread[THREADS];
  taken = 0;
  for (int k = 0; k < THREADS; k++) pthread_create(thread + k, 0, work, lane + k);
  if (stopped) __atomic_store_n(&stop, 1, __ATOMIC_RELAXED);
  for (int k = 0; k < THREADS; k++) pthread_join(thread[k], 0);
}

int main(void) {
  for (int k = 0; k < LANES; k++) {
    scene_init(lane + k);
    runs[k] = lane[k].run, events[k] = lane[k].events, systems[k] = lane[k].system, settings[k] = &scene_settings;
    runs[k].t = (mg_real)1e-3 * k;
  }
  runs[LANES - 1].stop = &stop;
  share(begin, 0);
  for (call = 1; call <= CALLS; call++) {
    for (int k = 0; k < LANES; k++)
      events[k].count = 0, t_stop[k] = (mg_real)call / CALLS * (SCENE_UNTIL < (mg_real)0.2 ? SCENE_UNTIL : (mg_real)0.2);
    share(advance, call == CALLS);
    share(sense, 0);
  }
  for (int k = 0; k < LANES; k++) printf("%d at %.6g; ", outcome[k], (double)runs[k].t);
  printf("\n");
  return 0;
}
