/* One run of the scene for a page in a browser, which calls these functions as a module of WebAssembly. */
#include "scene.c"
#include "record.h"

#define PAGE(name) __attribute__((export_name(#name))) name

static scene_instance scene;

#include "numbers.h"

/* Puts the run at the start of the scene, without samples. Numbers of the scene may be set after it. */
void PAGE(page_init)(void) {
  scene_init(&scene);
  scene.system = &page_system;
  record.count = 0;
}

/* Settles the start. 0, or why it is refused. */
int PAGE(page_begin)(void) { return scene_begin(&scene); }

/* Goes on to `until`, s, for at most max_steps steps, with samples. MG_CONTINUE, MG_LIST_FULL, or how it ended. The
   events are those of the call. */
int PAGE(page_advance)(double until, long max_steps) { return scene_advance_part(&scene, until, max_steps, &record); }

double PAGE(page_time)(void) { return scene.run.t; }
int PAGE(page_samples)(void) { return record.count; }
int PAGE(page_events)(void) { return scene.events.count; }
int PAGE(page_failed_contact)(void) { return scene.run.report.failed_contact; }
/* The reasons not to trust the run that has come to `code`, as bits, and one of them in words. */
int PAGE(page_doubts)(int code) { return scene_doubts(&scene, code); }
const char *PAGE(page_doubt_text)(int doubt) { return mg_doubt_text(doubt); }
void PAGE(page_set_input)(int input, double value) { scene_set_input(&scene, input, value); }
void PAGE(page_set_rate)(int input, double rate) { scene_set_rate(&scene, input, rate); }

/* The value of an input at present. */
double PAGE(page_input)(int input) {
  const double *setting = scene.run.input + 3 * input;
  return setting[0] + (scene_input_is_linear[input] ? setting[1] * (scene.run.t - setting[2]) : 0);
}

/* Arrays, by their number: samples (record.h), events (time, kind, contact, speed, feature pair), numbers of the scene
   that follow from its parameters (numbers.h). */
const void *PAGE(page_column)(int column) { return column_place[column]; }

void *PAGE(page_number)(int array) { return number_place[array]; }

const void *PAGE(page_event)(int field) {
  const void *const places[] = {scene.events.t, scene.events.kind, scene.events.contact, scene.events.speed,
                                scene.events.feature_pair};
  return places[field];
}
