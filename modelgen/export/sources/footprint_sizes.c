#include <stdio.h>
#include "scene.h"

static scene_instance scene;
static mg_real x_dot[SCENE_N_STATE];

int main(int n, char **words) {
  (void)words;
  scene_init(&scene);
  const int code = scene_begin(&scene);
  printf("%lu %lu %lu\n", (unsigned long)sizeof scene, (unsigned long)sizeof scene.work,
         (unsigned long)sizeof scene.iwork);
  for (int k = 0; n > 1 && !code && k < EVALUATIONS; k++)
    mg_evaluate(&scene_system, &scene_settings, &scene.run, scene.run.t, scene.run.x, x_dot, scene.work, scene.iwork);
  return 0;
}
