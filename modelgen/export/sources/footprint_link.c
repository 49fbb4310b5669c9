#include "scene.h"

static scene_instance scene;
static mg_real sensors[SCENE_N_SENSOR + 1];

int main(void) {
  scene_init(&scene);
  if (scene_begin(&scene) || scene_advance(&scene, SCENE_UNTIL)) return 1;
  scene_sense(&scene, sensors);
  return sensors[0] > 0;
}
