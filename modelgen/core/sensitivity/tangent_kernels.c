/* Calls of the generated derivatives: arguments and their derivatives along one direction are packed into vectors
   (MG_TASK_POSE .. of kernels.h). Reads the state evaluated last and s->at; writes s->y_dot. */
#include <string.h>

#include "sensitivity/sensitivity.h"
#include "base/base.h"
#include "model/model.h"

#ifdef MG_DEBUG
MG_INTERNAL mg_digest mg_tangent_digest(const mg_context *c, const mg_sensitivity *s, int with, int direction,
                                        int row) {
  const int along[3] = {direction, direction != MG_ANY_DIRECTION && s->is_time, row};
  return mg_digest_ints(c->valid.of[with], along, 3) | 1;
}

MG_INTERNAL mg_digest mg_event_digest(const mg_context *c, int kind, int contact, const mg_real *x) {
  const int event[2] = {kind, contact};
  return mg_digest_reals(mg_digest_ints(MG_DIGEST_START, event, 2), x, c->system->n_q + c->system->n_u) | 1;
}
#endif

MG_INTERNAL mg_real *mg_pack(mg_real *to, int n, const mg_real *from) {
  if (from) memcpy(to, from, (size_t)n * sizeof(mg_real));
  else mg_zero_reals(to, n);
  return to + n;
}

/* Row of a direction in one of its arrays, or null. */
static const mg_real *mg_row_of_direction(const mg_sensitivity *s, const mg_real *array, long n, int direction) {
  return array && !s->is_time ? array + n * direction : 0;
}

MG_INTERNAL mg_real mg_number_dot(const mg_sensitivity *s, const mg_real *array, long n, int direction, int i) {
  const mg_real *row = mg_row_of_direction(s, array, n, direction);
  return row ? row[i] : 0;
}

MG_INTERNAL mg_real mg_event_time_dot(const mg_sensitivity *s, int direction) {
  return -s->event_rate[direction] / s->event_rate[s->directions->n];
}

/* Derivative along a direction of the time at which the state is looked at. */
static mg_real mg_time_dot(const mg_sensitivity *s, int direction) {
  return s->is_at_event ? mg_event_time_dot(s, direction) : s->is_time;
}

/* Largest of n changes relative to their numbers, those that are zero left out. */
static mg_real mg_largest_relative_change(int n, const mg_real *change, const mg_real *number) {
  mg_real most = 0;
  for (int i = 0; change && i < n; i++)
    if (number[i] != 0) most = mg_max(most, fabs(change[i] / number[i]));
  return most;
}

MG_INTERNAL mg_real mg_direction_size(const mg_context *c, const mg_sensitivity *s, int direction) {
  const mg_system *system = c->system;
  const mg_directions *d = s->directions;
  const int states = c->layout.n_states, moving = system->n_q + system->n_u, n_friction = 2 * system->n_friction;
  const struct {
    int n, stride;
    const mg_real *change, *number;
  } tables[] = {{moving, states, d->start, c->step.scale},
                {system->n_parameters, system->n_parameters, d->parameters, system->parameters},
                {system->n_contact, system->n_contact, d->restitution, system->restitution},
                {n_friction, n_friction, d->friction_static, system->friction_static},
                {n_friction, n_friction, d->friction_kinetic, system->friction_kinetic},
                {2 * system->n_patch, 2 * system->n_patch, d->patch_friction, system->patch_friction},
                {3, 3, d->gravity, system->gravity},
                {3 * system->n_input, 3 * system->n_input, d->input, c->run->input}};
  mg_real most = 0;
  for (int k = 0; k < (int)(sizeof(tables) / sizeof(tables[0])); k++)
    most = mg_max(most, mg_largest_relative_change(
                            tables[k].n, mg_row_of_direction(s, tables[k].change, tables[k].stride, direction),
                            tables[k].number));
  return most;
}

/* Derivatives of the parameters from an offset on, or null. */
static const mg_real *mg_parameters_dot(const mg_context *c, const mg_sensitivity *s, int direction, int offset) {
  const mg_real *row = mg_row_of_direction(s, s->directions->parameters, c->system->n_parameters, direction);
  return row ? row + offset : 0;
}

static const mg_real *mg_inputs_dot(const mg_context *c, const mg_sensitivity *s, int direction) {
  return mg_row_of_direction(s, s->directions->input, 3L * c->system->n_input, direction);
}

MG_INTERNAL mg_real mg_differentiated_branch(const mg_context *c, int which) {
  return c->run->branch[which] != 0 ? c->run->branch[which] : -1;
}

MG_INTERNAL void mg_pack_branches(const mg_context *c, mg_sensitivity *s, int load) {
  mg_real *w = s->weights;
  for (int k = mg_switch_begin(c->system, load); k < mg_switch_end(c->system, load); k++)
    *w++ = mg_differentiated_branch(c, k);
  mg_pack(w, 4, c->bodies.quaternion + 4 * c->system->load_a[load]);
}

MG_INTERNAL const mg_real *mg_differentiated_switch(mg_context *c, const mg_sensitivity *s, mg_real t, int load,
                                                    int which, const mg_real **by_input) {
  const int first = mg_switch_begin(c->system, load), end = mg_switch_end(c->system, load);
  for (int k = first; k < end; k++)
    s->weights[k - first] = c->run->branch[k], mg_set_branch(c, k, mg_differentiated_branch(c, k));
  const mg_real *gradient = mg_switch_gradient(c, t, load, which, by_input);
  for (int k = first; k < end; k++) mg_set_branch(c, k, s->weights[k - first]);
  return gradient;
}

static void mg_add_products(int n, const mg_real *a, const mg_real *b, mg_real *sum, mg_real *size) {
  for (int k = 0; k < n; k++) *sum += a[k] * b[k], *size += fabs(a[k] * b[k]);
}

MG_INTERNAL mg_real mg_switch_tangent(mg_context *c, const mg_sensitivity *s, int direction, mg_real t, int which,
                                      mg_real *terms) {
  MG_NEEDS_TANGENT(c, s, MG_VALID_BODY_TANGENTS, MG_VALID_TWISTS, direction, MG_NO_ROW);
  const mg_system *system = c->system;
  const int load = mg_load_of_switch(system, which), n = c->kernels->load_kinds[system->load_kind[load]].n_parameters,
            bodies[2] = {system->load_a[load], system->load_b[load]};
  const mg_real *by_input, *g = mg_differentiated_switch(c, s, t, load, which, &by_input),
                           *numbers = mg_parameters_dot(c, s, direction, system->load_parameters[load]),
                           *inputs = mg_inputs_dot(c, s, direction);
  const mg_real by_time = g[0] * mg_time_dot(s, direction);
  mg_real sum = by_time, size = fabs(by_time);
  for (int side = 0; side < 2; side++) {
    const int body = bodies[side];
    if (body < 0) continue;
    mg_add_products(12, g + 1 + 18 * side, s->at.pose + 12 * body, &sum, &size);
    mg_add_products(6, g + 13 + 18 * side, s->at.twist + 6 * body, &sum, &size);
  }
  if (numbers) mg_add_products(n, g + MG_SWITCH_COLUMNS, numbers, &sum, &size);
  if (inputs) mg_add_products(3 * system->n_input, by_input, inputs, &sum, &size);
  if (terms) *terms = size;
  return sum;
}

static void mg_call_tangent(const mg_context *c, mg_sensitivity *s, int task, int kind) {
  MG_FORGET_TANGENT(s, MG_VALID_SENSOR_ARGUMENTS);
  c->kernels->derivatives->tangent(task, kind, s->weights, s->x, s->x_dot, s->y_dot);
}

/* Packs the pose and twist of a body. */
static void mg_pack_body(const mg_context *c, mg_sensitivity *s, int body, mg_real **x, mg_real **x_dot) {
  memcpy(*x, c->bodies.pose + 12 * body, 12 * sizeof(mg_real));
  memcpy(*x_dot, s->at.pose + 12 * body, 12 * sizeof(mg_real));
  memcpy(*x + 12, c->bodies.twist + 6 * body, 6 * sizeof(mg_real));
  memcpy(*x_dot + 12, s->at.twist + 6 * body, 6 * sizeof(mg_real));
  *x += 18, *x_dot += 18;
}

/* Packs n parameters, of a contact of a support point without the derivative of the point, which is fixed in its body.
 */
static void mg_pack_contact_parameters(mg_context *c, mg_sensitivity *s, int direction, int contact, mg_real *x,
                                       mg_real *x_dot) {
  const int n = c->kernels->contact_kinds[c->contacts.kind[contact]].n_parameters,
            given = contact >= c->layout.support_begin ? n - 3 : n;
  mg_pack(x, n, mg_contact_parameters(c, contact));
  x_dot = mg_pack(x_dot, given, mg_parameters_dot(c, s, direction, c->contacts.parameters[contact]));
  mg_pack(x_dot, n - given, 0);
}

MG_INTERNAL void mg_contact_tangent(mg_context *c, mg_sensitivity *s, int direction, int contact, const mg_real *eta,
                                    const mg_real *eta_dot, const mg_real *force, const mg_real *acceleration) {
  const int kind = c->contacts.kind[contact], n_eta = c->kernels->contact_kinds[kind].n_eta;
  mg_real *x = s->x, *x_dot = s->x_dot;
  mg_real *w = mg_pack(s->weights, MG_ROWS_OF_ONE, force);
  w = mg_pack(w, 6, acceleration ? acceleration + 6 * c->contacts.o[contact] : 0);
  mg_pack(w, 6, acceleration ? acceleration + 6 * c->contacts.f[contact] : 0);
  mg_pack_body(c, s, c->contacts.o[contact], &x, &x_dot);
  mg_pack_body(c, s, c->contacts.f[contact], &x, &x_dot);
  x = mg_pack(x, n_eta, eta), x_dot = mg_pack(x_dot, n_eta, eta_dot);
  mg_pack_contact_parameters(c, s, direction, contact, x, x_dot);
  mg_call_tangent(c, s, MG_TASK_CONTACT, kind);
}

MG_INTERNAL void mg_placement_tangent(mg_context *c, mg_sensitivity *s, int direction, int contact,
                                      const mg_real *eta) {
  const int kind = c->contacts.kind[contact], n_eta = c->kernels->contact_kinds[kind].n_eta;
  mg_real *x = s->x, *x_dot = s->x_dot;
  for (int side = 0; side < 2; side++) {
    const int body = side ? c->contacts.f[contact] : c->contacts.o[contact];
    x = mg_pack(x, 12, c->bodies.pose + 12 * body), x_dot = mg_pack(x_dot, 12, s->at.pose + 12 * body);
  }
  x = mg_pack(x, n_eta, eta), x_dot = mg_pack(x_dot, n_eta, 0);
  mg_pack_contact_parameters(c, s, direction, contact, x, x_dot);
  mg_call_tangent(c, s, MG_TASK_PLACEMENT, kind);
}

MG_INTERNAL void mg_joint_tangent(const mg_context *c, mg_sensitivity *s, int direction, int joint, mg_real t,
                                  const mg_real *force, const mg_real *acceleration) {
  const mg_system *system = c->system;
  const int kind = system->joint_kind[joint], a = system->joint_a[joint], b = system->joint_b[joint],
            n = c->kernels->joint_kinds[kind].n_parameters, rows = c->kernels->joint_kinds[kind].n_rows;
  mg_real *x = s->x, *x_dot = s->x_dot;
  mg_real *w = mg_pack(mg_pack(s->weights, rows, force), MG_ROWS_OF_ONE - rows, 0);
  w = mg_pack(w, 6, acceleration ? acceleration + 6 * a : 0), mg_pack(w, 6, acceleration ? acceleration + 6 * b : 0);
  *x++ = t, *x_dot++ = mg_time_dot(s, direction);
  mg_pack_body(c, s, a, &x, &x_dot), mg_pack_body(c, s, b, &x, &x_dot);
  x = mg_pack(x, n, system->parameters + system->joint_parameters[joint]);
  x_dot = mg_pack(x_dot, n, mg_parameters_dot(c, s, direction, system->joint_parameters[joint]));
  mg_pack(x, 3 * system->n_input, c->run->input), mg_pack(x_dot, 3 * system->n_input, mg_inputs_dot(c, s, direction));
  mg_call_tangent(c, s, MG_TASK_JOINT, kind);
}

MG_INTERNAL void mg_motion_tangent(const mg_context *c, mg_sensitivity *s, int direction, int body, const mg_real *q,
                                   const mg_real *u, const mg_real *wrench, const mg_real *gravity, const mg_real *dq,
                                   const mg_real *du, const mg_real *dwrench) {
  const int kind = mg_body_kind_of(c, body), n_q = c->kernels->body_kinds[kind].n_q,
            n_u = c->kernels->body_kinds[kind].n_u, n = c->kernels->body_kinds[kind].n_parameters,
            offset = c->system->body_parameters[body];
  const mg_real *gravity_dot = gravity ? mg_row_of_direction(s, s->directions->gravity, 3, direction) : 0;
  mg_real *x = s->x, *x_dot = s->x_dot;
  x = mg_pack(mg_pack(x, n_q, q), 7 - n_q, 0), x_dot = mg_pack(mg_pack(x_dot, n_q, dq), 7 - n_q, 0);
  x = mg_pack(mg_pack(x, n_u, u), 6 - n_u, 0), x_dot = mg_pack(mg_pack(x_dot, n_u, du), 6 - n_u, 0);
  x = mg_pack(x, 6, wrench), x_dot = mg_pack(x_dot, 6, dwrench);
  x = mg_pack(x, 3, gravity), x_dot = mg_pack(x_dot, 3, gravity_dot);
  mg_pack(x, n, c->system->parameters + offset), mg_pack(x_dot, n, mg_parameters_dot(c, s, direction, offset));
  mg_call_tangent(c, s, MG_TASK_MOTION, kind);
}

MG_INTERNAL void mg_load_tangent(const mg_context *c, mg_sensitivity *s, int direction, int load, mg_real t) {
  const mg_system *system = c->system;
  const int kind = system->load_kind[load], a = system->load_a[load],
            b = system->load_b[load] < 0 ? a : system->load_b[load], n = c->kernels->load_kinds[kind].n_parameters,
            offset = system->load_parameters[load];
  mg_real *x = s->x, *x_dot = s->x_dot;
  *x++ = t, *x_dot++ = mg_time_dot(s, direction);
  mg_pack_branches(c, s, load);
  mg_pack_body(c, s, a, &x, &x_dot), mg_pack_body(c, s, b, &x, &x_dot);
  x = mg_pack(x, n, system->parameters + offset), x_dot = mg_pack(x_dot, n, mg_parameters_dot(c, s, direction, offset));
  mg_pack(x, 3 * system->n_input, c->run->input), mg_pack(x_dot, 3 * system->n_input, mg_inputs_dot(c, s, direction));
  mg_call_tangent(c, s, MG_TASK_LOAD, kind);
}

/* Derivative of pose, twist and acceleration of a driven body. */
static void mg_path_tangent(const mg_context *c, mg_sensitivity *s, int direction, int body, mg_real t) {
  const int offset = c->system->body_parameters[body];
  mg_real *x = s->x, *x_dot = s->x_dot;
  *x++ = t, *x_dot++ = mg_time_dot(s, direction);
  x = mg_pack(x, 12, c->system->parameters + offset),
  x_dot = mg_pack(x_dot, 12, mg_parameters_dot(c, s, direction, offset));
  mg_pack(x, 3 * c->system->n_input, c->run->input);
  mg_pack(x_dot, 3 * c->system->n_input, mg_inputs_dot(c, s, direction));
  mg_call_tangent(c, s, MG_TASK_PATH, mg_body_kind_of(c, body));
  mg_pack(s->at.pose + 12 * body, 12, s->y_dot), mg_pack(s->at.twist + 6 * body, 6, s->y_dot + 12);
  mg_pack(s->at.acceleration + 6 * body, 6, s->y_dot + 18);
}

MG_INTERNAL void mg_place_bodies_tangent(const mg_context *c, mg_sensitivity *s, int direction, mg_real t,
                                         const mg_real *x, const mg_real *dx) {
  const mg_system *system = c->system;
  MG_FORGET_TANGENT(s, MG_VALID_TANGENTS);
  mg_zero_reals(s->at.pose, 24L * system->n_body);
  for (int b = 0; b < system->n_body; b++) {
    const int motion = c->bodies.motion[b], kind = mg_body_kind_of(c, b), n_u = c->kernels->body_kinds[kind].n_u;
    const mg_real *dq = dx + system->body_q[b], *du = dx + system->n_q + system->body_u[b];
    if (motion == MG_FIXED)
      mg_pack(s->at.pose + 12 * b, 12, mg_parameters_dot(c, s, direction, system->body_parameters[b]));
    else if (motion == MG_DRIVEN) mg_path_tangent(c, s, direction, b, t);
    else mg_pack(s->at.twist + 6 * b, n_u, du);
    if (motion == MG_POINT) mg_pack(s->at.pose + 12 * b, 3, dq);
    if (motion == MG_FREE)
      c->kernels->derivatives->tangent(MG_TASK_POSE, kind, s->weights, x + system->body_q[b], dq, s->at.pose + 12 * b);
  }
  MG_NOTE_TANGENT(c, s, MG_VALID_BODY_TANGENTS, MG_VALID_TWISTS, direction, MG_NO_ROW);
}

MG_INTERNAL void mg_scene_tangent(const mg_context *c, mg_sensitivity *s, int direction, const mg_real *x,
                                  const mg_real *dx, mg_real *slope) {
  const mg_system *system = c->system;
  const mg_real *gravity_dot = mg_row_of_direction(s, s->directions->gravity, 3, direction),
                *parameters_dot = mg_parameters_dot(c, s, direction, 0);
  if (!gravity_dot || !parameters_dot) mg_zero_reals(s->x_dot, 3L + system->n_parameters);
  c->kernels->derivatives->scene_tangent(x, system->gravity, system->parameters, dx,
                                         gravity_dot ? gravity_dot : s->x_dot,
                                         parameters_dot ? parameters_dot : s->x_dot, slope);
  slope[c->layout.work_state] = 0;
}

MG_INTERNAL void mg_sensors_tangent(const mg_context *c, mg_sensitivity *s, int direction, mg_real t) {
  MG_NEEDS_TANGENT(c, s, MG_VALID_SENSED, MG_VALID_FORCES, direction, MG_NO_ROW);
  const mg_system *system = c->system;
  const int bodies = system->n_body, n = system->n_parameters - system->sensor_parameters,
            of_forces = c->kernels->sensors_need_forces; /* else these are not read */
  mg_real *x = s->x, *x_dot = s->x_dot;
  *x++ = t, *x_dot++ = mg_time_dot(s, direction);
  x = mg_pack(x, 12 * bodies, c->bodies.pose), x_dot = mg_pack(x_dot, 12 * bodies, s->at.pose);
  x = mg_pack(x, 6 * bodies, c->bodies.twist), x_dot = mg_pack(x_dot, 6 * bodies, s->at.twist);
  x = mg_pack(x, 6 * bodies, c->sensors.acceleration), x_dot = mg_pack(x_dot, 6 * bodies, s->at.acceleration);
  x = mg_pack(x, 2 * system->n_pair, of_forces ? c->sensors.pair : 0),
  x_dot = mg_pack(x_dot, 2 * system->n_pair, s->pair);
  x = mg_pack(x, 6 * system->n_joint, of_forces ? c->sensors.joint : 0),
  x_dot = mg_pack(x_dot, 6 * system->n_joint, s->joint);
  x = mg_pack(x, 3, system->gravity);
  x_dot = mg_pack(x_dot, 3, mg_row_of_direction(s, s->directions->gravity, 3, direction));
  x = mg_pack(x, n, system->parameters + system->sensor_parameters);
  x_dot = mg_pack(x_dot, n, mg_parameters_dot(c, s, direction, system->sensor_parameters));
  mg_pack(x, 3 * system->n_input, c->run->applied_input);
  mg_pack(x_dot, 3 * system->n_input, mg_inputs_dot(c, s, direction));
  mg_call_tangent(c, s, MG_TASK_SENSORS, 0);
  MG_NOTE_TANGENT(c, s, MG_VALID_SENSOR_ARGUMENTS, MG_VALID_FORCES, MG_ANY_DIRECTION, MG_NO_ROW);
}
