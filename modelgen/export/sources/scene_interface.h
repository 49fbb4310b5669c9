typedef struct {
  const mg_system *system; /* &scene_system, or another one of the same sizes, set between scene_init and scene_begin */
  mg_run run;       /* run.t, s; run.x, the state; what the run reports */
  mg_events events; /* of the last call of scene_advance_part */
@ARRAYS@
  mg_real work[SCENE_WORK];
  int iwork[SCENE_IWORK];
} scene_instance;

extern const mg_system scene_system;
extern const mg_settings scene_settings;

/* Names, with one entry to spare. scene_body_moves: 1 of bodies that forces or a path move. */
extern const char *const scene_body_names[SCENE_N_BODY + 1];
extern const char *const scene_contact_names[SCENE_N_CONTACT + 1];
extern const char *const scene_input_names[SCENE_N_INPUT + 1];
extern const char *const scene_sensor_names[SCENE_N_SENSOR + 1];
extern const int scene_body_moves[SCENE_N_BODY + 1];
extern const mg_real scene_input_defaults[SCENE_N_INPUT + 1];
extern const int scene_input_is_linear[SCENE_N_INPUT + 1];

/* Puts an instance at the start of the scene, with its inputs at their defaults. */
void scene_init(scene_instance *scene);

/* Settles the start. MG_DONE, or why it is refused. */
int scene_begin(scene_instance *scene);

/* Advances to t_stop, s. MG_DONE, or what ended the run. */
int scene_advance(scene_instance *scene, mg_real t_stop);

/* The same for at most max_steps steps, with samples in `record`, which may be 0. Returns MG_CONTINUE or MG_LIST_FULL
   as well: then call it again. The events of the call are in scene->events. */
int scene_advance_part(scene_instance *scene, mg_real t_stop, long max_steps, mg_record *record);

/* 1 if an input takes a value, or one that is linear a rate: both finite, and a value within the range of its input. */
int scene_takes_input(int input, mg_real value);

/* Sets an input from the present time on. One that is linear is set before scene_begin only. */
void scene_set_input(scene_instance *scene, int input, mg_real value);

/* Sets the rate of an input that is linear, 1/s, from the present time on. */
void scene_set_rate(scene_instance *scene, int input, mg_real rate);

/* Writes what the sensors show, [SCENE_N_SENSOR]. */
void scene_sense(scene_instance *scene, mg_real *sensors);

/* Writes position and rotation matrix, by columns, of each body, [12 SCENE_N_BODY]. */
void scene_poses(scene_instance *scene, mg_real *pose);

/* The reasons not to trust a run that has come to `code`, as scene_begin or an advance returned it: MG_DOUBT_ENDED ..
   as bits, 0: none that its own figures show. mg_doubt_text has words for each. */
int scene_doubts(const scene_instance *scene, int code);

/* Saves the state into SCENE_SAVE_SIZE bytes. */
void scene_save(const scene_instance *scene, unsigned char *bytes);

/* Loads `length` bytes, mg_save_size(&scene_system), that scene_save wrote, into an instance after scene_init.
   MG_LOADED, or what differs. */
int scene_load(scene_instance *scene, const unsigned char *bytes, long length);

#endif
