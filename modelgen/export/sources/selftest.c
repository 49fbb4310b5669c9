/* Runs the scene as modelgen did where this folder was written, and compares the states. Goes on from a saved state
   and compares that as well. Exit code 0: passed. With the argument `print`, prints the states with 17 digits. */
#include <stdio.h>
#include <string.h>

#include "scene.h"
#include "vectors.h"

static scene_instance scene, other;
static unsigned char bytes[SCENE_SAVE_SIZE], bytes_of_other[SCENE_SAVE_SIZE];
static int different; /* numbers that are not those of the vectors to the last bit */
static double worst;  /* largest difference over its tolerance */

static void compare(mg_real found, mg_real expected, mg_real tolerance) {
  if (tolerance >= MG_MAX || found == expected) return;
  const double difference = fabs((double)found - (double)expected);
  different++;
  if (!(difference <= worst * (double)tolerance)) worst = difference / (double)tolerance;
}

/* One body at one time: position, rotation matrix by columns, velocity, angular velocity in body axes. */
static void compare_body(int k, int body, int moving) {
  const mg_real *pose = record.pose + 12 * (SCENE_N_BODY * k + body);
  const mg_real *twist = record.twist + 6 * (SCENE_N_BODY * k + body);
  const mg_real *expected = vector_state + 18 * (VECTOR_BODIES * k + moving), *tolerance = vector_tolerance + 4 * k;
  for (int i = 0; i < 12; i++) compare(pose[i], expected[i], i < 3 ? tolerance[0] : tolerance[1]);
  for (int i = 0; i < 6; i++) compare(twist[i], expected[12 + i], i < 3 ? tolerance[2] : tolerance[3]);
}

static void print_body(int k, int body) {
  for (int i = 0; i < 12; i++) printf(" %.17g", (double)record.pose[12 * (SCENE_N_BODY * k + body) + i]);
  for (int i = 0; i < 6; i++) printf(" %.17g", (double)record.twist[6 * (SCENE_N_BODY * k + body) + i]);
}

static int run_to_the_end(scene_instance *s, mg_record *samples) {
  int code;
  do code = scene_advance_part(s, VECTOR_UNTIL, 1000, samples);
  while (code == MG_CONTINUE || code == MG_LIST_FULL);
  return code;
}

/* Whether a run that was saved on its way, loaded and continued ends as one that just went on. */
static int saved_state_goes_on(void) {
  const mg_real half = (mg_real)0.5 * VECTOR_UNTIL;
  scene_init(&scene), scene_init(&other);
  if (scene_begin(&scene) || scene_advance(&scene, half)) return 1; /* nothing to compare */
  scene_save(&scene, bytes);
  if (scene_load(&other, bytes, mg_save_size(&scene_system))) return 0;
  const int code = run_to_the_end(&scene, 0);
  if (run_to_the_end(&other, 0) != code) return 0;
  scene_save(&scene, bytes), scene_save(&other, bytes_of_other);
  return !memcmp(bytes, bytes_of_other, (size_t)mg_save_size(&scene_system));
}

int main(int n, char **words) {
  if (mg_work_size(&scene_system) > SCENE_WORK || mg_iwork_size(&scene_system) > SCENE_IWORK ||
      mg_save_size(&scene_system) > SCENE_SAVE_SIZE) {
    fprintf(stderr, "scene.h does not fit the core\n");
    return 2;
  }
  scene_init(&scene);
  int code = scene_begin(&scene);
  if (code == MG_DONE) code = run_to_the_end(&scene, &record);
  const int is_printed = n > 1 && !strcmp(words[1], "print");
  for (int k = 0; k < record.count; k++) {
    if (is_printed) printf("%.17g", (double)record.t[k]);
    for (int body = 0, moving = 0; body < SCENE_N_BODY; body++) {
      if (!scene_body_moves[body]) continue;
      if (is_printed) print_body(k, body);
      compare_body(k, body, moving++);
    }
    if (is_printed) printf("\n");
  }
  const int is_whole = code == VECTOR_CODE && record.count == VECTORS;
  const int goes_on = saved_state_goes_on();
  const int passed = is_whole && goes_on && worst <= 1;
  fprintf(stderr, "%s: %d of %d vectors, ", SCENE_NAME, record.count, VECTORS);
  if (different) fprintf(stderr, "largest difference over tolerance %.3g, ", worst);
  if (!different) fprintf(stderr, "equal to the last bit, ");
  fprintf(stderr, "%s; %s\n", goes_on ? "saved state goes on alike" : "saved state goes on otherwise",
          passed ? "passed" : "FAILED");
  if (!is_whole) fprintf(stderr, "ended with code %d of modelgen.h; %d was expected\n", code, VECTOR_CODE);
  return !passed;
}
