int scene_begin(scene_instance *scene) {
  scene->events.count = 0;
  return mg_begin(scene->system, &scene_settings, &scene->run, &scene->events, scene->work, scene->iwork);
}

int scene_advance(scene_instance *scene, mg_real t_stop) {
  int code;
  do code = scene_advance_part(scene, t_stop, 1000000, 0);
  while (code == MG_CONTINUE || code == MG_LIST_FULL);
  return code;
}

int scene_advance_part(scene_instance *scene, mg_real t_stop, long max_steps, mg_record *record) {
  mg_record none = {0};
  scene->events.count = 0;
  return mg_advance(scene->system, &scene_settings, &scene->run, t_stop, max_steps, record ? record : &none,
                    &scene->events, scene->work, scene->iwork);
}

int scene_takes_input(int input, mg_real value) {
  const mg_real *range = scene_system.input_range + 2 * input;
  if (!(-MG_MAX <= value && value <= MG_MAX)) return 0;
  return scene_input_is_linear[input] || (range[0] <= value && value <= range[1]);
}

void scene_set_input(scene_instance *scene, int input, mg_real value) {
  mg_real *setting = scene->run.input + 3 * input;
  setting[0] = value, setting[1] = 0, setting[2] = scene->run.t;
}

void scene_set_rate(scene_instance *scene, int input, mg_real rate) {
  mg_real *setting = scene->run.input + 3 * input;
  setting[0] += setting[1] * (scene->run.t - setting[2]);
  setting[1] = rate, setting[2] = scene->run.t;
}

void scene_sense(scene_instance *scene, mg_real *sensors) {
  mg_sense(scene->system, &scene_settings, &scene->run, sensors, scene->work, scene->iwork);
}

void scene_poses(scene_instance *scene, mg_real *pose) {
  mg_pose_all(scene->system, &scene_settings, &scene->run, pose, scene->work, scene->iwork);
}

int scene_doubts(const scene_instance *scene, int code) {
  return mg_doubts(scene->system, &scene_settings, &scene->run, code);
}

void scene_save(const scene_instance *scene, unsigned char *bytes) {
  mg_save(scene->system, &scene_settings, &scene->run, bytes);
}

int scene_load(scene_instance *scene, const unsigned char *bytes, long length) {
  scene->events.count = 0;
  return mg_load(scene->system, &scene_settings, &scene->run, bytes, length);
}
