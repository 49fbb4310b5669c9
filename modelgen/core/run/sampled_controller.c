/* A run under a controller that is called at sampled instants (mg_advance_controlled). Writes the inputs of the run. */
#include "run/run.h"

/* Setting of an input after a command. Returns 0 if the command is not finite. */
static int mg_set_command(const mg_system *s, mg_run *run, int input, mg_real command) {
  mg_real *setting = run->input + 3 * input;
  const mg_real least = s->input_range[2 * input], largest = s->input_range[2 * input + 1];
  if (!(fabs(command) <= MG_MAX)) return 0;
  if (s->input_is_linear[input]) {
    if (command == setting[1]) return 1;
    setting[0] += setting[1] * (run->t - setting[2]), setting[1] = command, setting[2] = run->t;
  } else setting[0] = mg_min(mg_max(command, least), largest);
  return 1;
}

/* Shows the sensors to the controller and sets the inputs by its commands. Returns an outcome. */
static int mg_call_controller(const mg_system *s, const mg_settings *settings, mg_run *run, mg_controller *controller,
                              mg_real *work, int *iwork) {
  if (s->kernels->n_sensor) mg_sense(s, settings, run, controller->sensors, work, iwork);
  for (int i = 0; i < s->n_input; i++) controller->command[i] = run->input[3 * i + (s->input_is_linear[i] ? 1 : 0)];
  controller->call(controller->data, run->t, controller->sensors, controller->command);
  controller->calls++;
  for (int i = 0; i < s->n_input; i++)
    if (!mg_set_command(s, run, i, controller->command[i])) return MG_NOT_FINITE;
  return MG_DONE;
}

MG_API int mg_advance_controlled(const mg_system *system, const mg_settings *settings, mg_run *run,
                                 mg_controller *controller, mg_real t_stop, long max_steps, mg_record *record,
                                 mg_events *events, mg_real *work, int *iwork) {
  while (run->t < t_stop) {
    if (run->t >= controller->start + controller->period * (mg_real)controller->calls) {
      const int refused = mg_call_controller(system, settings, run, controller, work, iwork);
      if (refused) return refused;
    }
    const mg_real next = controller->start + controller->period * (mg_real)controller->calls;
    const int code =
        mg_advance(system, settings, run, next < t_stop ? next : t_stop, max_steps, record, events, work, iwork);
    if (code) return code;
  }
  return MG_DONE;
}
