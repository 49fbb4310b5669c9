/* Runs the scene in a thread with a stack of so many bytes, and prints how many of them the thread itself, and
   the run beyond that, have written to; and the code with which the run ended. */
#define _GNU_SOURCE
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene.h"

static scene_instance scene;

static void *nothing(void *given) { return given; }

static void *run(void *given) {
  mg_real sensors[SCENE_N_SENSOR + 1], pose[12 * SCENE_N_BODY + 1];
  int *code = given;
  scene_init(&scene);
  *code = scene_begin(&scene);
  for (int step = 1; step <= 20 && *code == MG_DONE; step++) {
    *code = scene_advance(&scene, step * (SCENE_UNTIL / 20));
    scene_sense(&scene, sensors);
    scene_poses(&scene, pose);
  }
  return NULL;
}

static size_t written(void *(*function)(void *), size_t size, int *code) {
  unsigned char *stack = aligned_alloc(4096, size);
  pthread_attr_t attributes;
  pthread_t thread;
  size_t untouched = 0;
  if (!stack || pthread_attr_init(&attributes) || pthread_attr_setstack(&attributes, stack, size)) exit(3);
  memset(stack, 0xa5, size);
  if (pthread_create(&thread, &attributes, function, code) || pthread_join(thread, NULL)) exit(4);
  while (untouched < size && stack[untouched] == 0xa5) untouched++;
  free(stack);
  return size - untouched;
}

int main(int count, char **words) {
  int code = 0;
  const size_t size = count > 1 ? strtoul(words[1], NULL, 10) : 0;
  const size_t thread = written(nothing, size, &code), whole = written(run, size, &code);
  printf("%zu %zu %d\n", thread, whole - thread, code);
  return 0;
}
