/* Runs an exported scene on scratch memory of which only the first int is set, and writes all that a run has, so that
   a checker of memory sees what depends on memory that nobody has set. */
#include <stdio.h>
#include <stdlib.h>

#include "scene.h"

enum { PARTS = 4, STEPS = 12 };
static scene_instance scene;
static mg_real pose[12 * SCENE_N_BODY + 1], sensors[SCENE_N_SENSOR + 1];

int main(void) {
  mg_record none = {0};
  mg_real *work = malloc((size_t)SCENE_WORK * sizeof *work);
  int *iwork = malloc((size_t)SCENE_IWORK * sizeof *iwork), code;
  unsigned char *bytes = malloc((size_t)SCENE_SAVE_SIZE);
  unsigned long sum = 0;
  if (!work || !iwork || !bytes) return 2;
  iwork[0] = 0;
  scene_init(&scene);
  code = mg_begin(scene.system, &scene_settings, &scene.run, &scene.events, work, iwork);
  for (int part = 1; part <= PARTS && code <= MG_LIST_FULL; part++) {
    scene.events.count = 0;
    code = mg_advance(scene.system, &scene_settings, &scene.run, SCENE_UNTIL, STEPS, &none, &scene.events, work, iwork);
    mg_sense(scene.system, &scene_settings, &scene.run, sensors, work, iwork);
    mg_pose_all(scene.system, &scene_settings, &scene.run, pose, work, iwork);
    scene_save(&scene, bytes);
    if (scene_load(&scene, bytes, mg_save_size(&scene_system)) != MG_LOADED) return 3;
    for (long k = 0; k < mg_save_size(&scene_system); k++) sum = sum * 31 + bytes[k];
  }
  printf("code %d t %.9g steps %ld sum %lx\n", code, (double)scene.run.t, scene.run.steps, sum);
  for (int k = 0; k < 12 * SCENE_N_BODY; k++) printf("%.17g ", (double)pose[k]);
  for (int k = 0; k < SCENE_N_SENSOR; k++) printf("%.17g ", (double)sensors[k]);
  printf("\n");
  free(work), free(iwork), free(bytes);
  return 0;
}
