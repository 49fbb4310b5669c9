/* Runs the scene with its inputs held at their defaults and prints what its sensors show; of a scene without sensors,
   the centres of mass of the bodies that move. Set the inputs where the comment says so. */
#include <stdio.h>

#include "scene.h"

static scene_instance scene;

static void print_heading(void) {
  printf("t");
  for (int k = 0; k < SCENE_N_SENSOR; k++) printf(" %s", scene_sensor_names[k]);
  for (int b = 0; SCENE_N_SENSOR == 0 && b < SCENE_N_BODY; b++)
    if (scene_body_moves[b]) printf(" %s.x %s.y %s.z", scene_body_names[b], scene_body_names[b], scene_body_names[b]);
  printf("\n");
}

static void print_state(void) {
  mg_real sensors[SCENE_N_SENSOR + 1], pose[12 * SCENE_N_BODY + 1];
  printf("%.9g", (double)scene.run.t);
  scene_sense(&scene, sensors);
  for (int k = 0; k < SCENE_N_SENSOR; k++) printf(" %.9g", (double)sensors[k]);
  scene_poses(&scene, pose);
  for (int b = 0; SCENE_N_SENSOR == 0 && b < SCENE_N_BODY; b++)
    for (int i = 0; scene_body_moves[b] && i < 3; i++) printf(" %.9g", (double)pose[12 * b + i]);
  printf("\n");
}

int main(void) {
  const mg_real period = SCENE_UNTIL / 100;
  scene_init(&scene);
  int code = scene_begin(&scene);
  print_heading();
  for (int step = 1; step <= 100 && code == MG_DONE; step++) {
    print_state();
    for (int k = 0; k < SCENE_N_INPUT; k++) /* the controller goes here */
      if (!scene_input_is_linear[k]) scene_set_input(&scene, k, scene_input_defaults[k]);
    code = scene_advance(&scene, step * period);
  }
  print_state();
  const int doubts = scene_doubts(&scene, code);
  for (int doubt = 1; doubt <= doubts; doubt *= 2)
    if (doubts & doubt) fprintf(stderr, "not trusted: %s\n", mg_doubt_text(doubt));
  if (code != MG_DONE) fprintf(stderr, "ended at t = %g s: code %d of modelgen.h\n", (double)scene.run.t, code);
  return code;
}
