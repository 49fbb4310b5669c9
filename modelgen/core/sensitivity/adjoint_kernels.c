/* Calls of the generated adjoints, as tangent_kernels.c calls the tangents: cotangents of results are packed into
   s->y_dot, those of arguments come back in s->x_dot and are added to s->at and to the numbers of the mg_adjoint. */
#include "sensitivity/sensitivity.h"
#include "base/base.h"
#include "model/model.h"

/* Adds n numbers to an array; returns the place after them in the source. */
static const mg_real *mg_add_part(mg_real *to, int n, const mg_real *from) {
  if (to)
    for (int k = 0; k < n; k++) to[k] += from[k];
  return from + n;
}

static void mg_call_adjoint(const mg_context *c, mg_sensitivity *s, int task, int kind) {
  c->kernels->derivatives->adjoint(task, kind, s->weights, s->x, s->y_dot, s->x_dot);
}

static mg_real *mg_pack_state(const mg_context *c, int body, mg_real *x) {
  x = mg_pack(x, 12, c->bodies.pose + 12 * body);
  return mg_pack(x, 6, c->bodies.twist + 6 * body);
}

static const mg_real *mg_add_to_body(mg_sensitivity *s, int body, const mg_real *x_bar) {
  x_bar = mg_add_part(s->at.pose + 12 * body, 12, x_bar);
  return mg_add_part(s->at.twist + 6 * body, 6, x_bar);
}

static void mg_pack_weights(mg_sensitivity *s, int rows, const mg_real *force, const mg_real *accel_first,
                            const mg_real *accel_second) {
  mg_real *w = mg_pack(mg_pack(s->weights, rows, force), MG_ROWS_OF_ONE - rows, 0);
  mg_pack(mg_pack(w, 6, accel_first), 6, accel_second);
}

/* Adds cotangents of the parameters of a contact; those of a support point end with the point, which is fixed. */
static void mg_add_contact_parameters(const mg_context *c, mg_sensitivity *s, int contact, const mg_real *x_bar) {
  const int n = c->kernels->contact_kinds[c->contacts.kind[contact]].n_parameters;
  mg_add_part(s->adjoint->parameters + c->contacts.parameters[contact], contact >= c->layout.support_begin ? n - 3 : n,
              x_bar);
}

MG_INTERNAL void mg_contact_adjoint(mg_context *c, mg_sensitivity *s, int contact, const mg_real *eta,
                                    const mg_real *force, const mg_real *acceleration, mg_real *eta_bar) {
  const int kind = c->contacts.kind[contact], n_eta = c->kernels->contact_kinds[kind].n_eta, o = c->contacts.o[contact],
            f = c->contacts.f[contact];
  mg_pack_weights(s, MG_ROWS_OF_ONE, force, acceleration ? acceleration + 6 * o : 0,
                  acceleration ? acceleration + 6 * f : 0);
  mg_real *x = mg_pack_state(c, f, mg_pack_state(c, o, s->x));
  x = mg_pack(x, n_eta, eta);
  mg_pack(x, c->kernels->contact_kinds[kind].n_parameters, mg_contact_parameters(c, contact));
  mg_call_adjoint(c, s, MG_TASK_CONTACT, kind);
  const mg_real *x_bar = mg_add_to_body(s, f, mg_add_to_body(s, o, s->x_dot));
  mg_add_contact_parameters(c, s, contact, mg_add_part(eta_bar, n_eta, x_bar));
}

MG_INTERNAL void mg_placement_adjoint(mg_context *c, mg_sensitivity *s, int contact, const mg_real *eta) {
  const int kind = c->contacts.kind[contact], n_eta = c->kernels->contact_kinds[kind].n_eta;
  mg_real *x = s->x;
  for (int side = 0; side < 2; side++)
    x = mg_pack(x, 12, c->bodies.pose + 12 * (side ? c->contacts.f[contact] : c->contacts.o[contact]));
  x = mg_pack(x, n_eta, eta);
  mg_pack(x, c->kernels->contact_kinds[kind].n_parameters, mg_contact_parameters(c, contact));
  mg_call_adjoint(c, s, MG_TASK_PLACEMENT, kind);
  const mg_real *x_bar = mg_add_part(s->at.pose + 12 * c->contacts.o[contact], 12, s->x_dot);
  x_bar = mg_add_part(s->at.pose + 12 * c->contacts.f[contact], 12, x_bar);
  mg_add_contact_parameters(c, s, contact, x_bar + n_eta);
}

MG_INTERNAL void mg_joint_adjoint(const mg_context *c, mg_sensitivity *s, int joint, mg_real t, const mg_real *force,
                                  const mg_real *acceleration) {
  const mg_system *system = c->system;
  const int kind = system->joint_kind[joint], a = system->joint_a[joint], b = system->joint_b[joint],
            n = c->kernels->joint_kinds[kind].n_parameters, rows = c->kernels->joint_kinds[kind].n_rows,
            offset = system->joint_parameters[joint];
  mg_pack_weights(s, rows, force, acceleration ? acceleration + 6 * a : 0, acceleration ? acceleration + 6 * b : 0);
  *s->x = t;
  mg_real *x = mg_pack_state(c, b, mg_pack_state(c, a, s->x + 1));
  mg_pack(mg_pack(x, n, system->parameters + offset), 3 * system->n_input, c->run->input);
  s->x_dot[0] = 0; /* of rows that neither time nor an input moves */
  for (int k = 0; k < 3 * system->n_input; k++) s->x_dot[37 + n + k] = 0;
  mg_call_adjoint(c, s, MG_TASK_JOINT, kind);
  s->t_bar += s->x_dot[0];
  const mg_real *x_bar = mg_add_to_body(s, b, mg_add_to_body(s, a, s->x_dot + 1));
  mg_add_part(s->adjoint->input, 3 * system->n_input, mg_add_part(s->adjoint->parameters + offset, n, x_bar));
}

MG_INTERNAL void mg_load_adjoint(const mg_context *c, mg_sensitivity *s, int load, mg_real t) {
  const mg_system *system = c->system;
  const int kind = system->load_kind[load], a = system->load_a[load],
            b = system->load_b[load] < 0 ? a : system->load_b[load], n = c->kernels->load_kinds[kind].n_parameters,
            offset = system->load_parameters[load];
  *s->x = t;
  mg_pack_branches(c, s, load);
  mg_real *x = mg_pack_state(c, b, mg_pack_state(c, a, s->x + 1));
  mg_pack(mg_pack(x, n, system->parameters + offset), 3 * system->n_input, c->run->input);
  for (int k = 0; k < 3 * system->n_input; k++) s->x_dot[37 + n + k] = 0;
  mg_call_adjoint(c, s, MG_TASK_LOAD, kind);
  const mg_real *x_bar = mg_add_to_body(s, b, mg_add_to_body(s, a, s->x_dot + 1));
  mg_add_part(s->adjoint->input, 3 * system->n_input, mg_add_part(s->adjoint->parameters + offset, n, x_bar));
}

MG_INTERNAL void mg_motion_adjoint(const mg_context *c, mg_sensitivity *s, int body, const mg_real *q, const mg_real *u,
                                   const mg_real *wrench, const mg_real *gravity, mg_real *q_bar, mg_real *u_bar,
                                   mg_real *wrench_bar) {
  const int kind = mg_body_kind_of(c, body), n_q = c->kernels->body_kinds[kind].n_q,
            n_u = c->kernels->body_kinds[kind].n_u, n = c->kernels->body_kinds[kind].n_parameters,
            offset = c->system->body_parameters[body];
  mg_real *x = mg_pack(mg_pack(s->x, n_q, q), 7 - n_q, 0);
  x = mg_pack(mg_pack(x, n_u, u), 6 - n_u, 0);
  x = mg_pack(mg_pack(x, 6, wrench), 3, gravity);
  mg_pack(x, n, c->system->parameters + offset);
  mg_call_adjoint(c, s, MG_TASK_MOTION, kind);
  mg_add_part(q_bar, n_q, s->x_dot), mg_add_part(u_bar, n_u, s->x_dot + 7), mg_add_part(wrench_bar, 6, s->x_dot + 13);
  if (gravity) mg_add_part(s->adjoint->gravity, 3, s->x_dot + 19);
  mg_add_part(s->adjoint->parameters + offset, n, s->x_dot + 22);
}

/* Adds the cotangents of pose, twist and acceleration of a driven body to those of its path. */
static void mg_path_adjoint(const mg_context *c, mg_sensitivity *s, int body, mg_real t) {
  const int offset = c->system->body_parameters[body], inputs = 3 * c->system->n_input;
  *s->x = t;
  mg_pack(mg_pack(s->x + 1, 12, c->system->parameters + offset), inputs, c->run->input);
  mg_real *y = mg_pack(s->y_dot, 12, s->at.pose + 12 * body);
  mg_pack(mg_pack(y, 6, s->at.twist + 6 * body), 6, s->at.acceleration + 6 * body);
  s->x_dot[0] = 0;
  for (int k = 0; k < inputs; k++) s->x_dot[13 + k] = 0;
  mg_call_adjoint(c, s, MG_TASK_PATH, mg_body_kind_of(c, body));
  s->t_bar += s->x_dot[0];
  mg_add_part(s->adjoint->input, inputs, mg_add_part(s->adjoint->parameters + offset, 12, s->x_dot + 1));
}

MG_INTERNAL void mg_place_bodies_adjoint(const mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *x,
                                         mg_real *x_bar) {
  const mg_system *system = c->system;
  for (int b = 0; b < system->n_body; b++) {
    const int motion = c->bodies.motion[b], n_u = c->kernels->body_kinds[mg_body_kind_of(c, b)].n_u;
    mg_real *q_bar = x_bar + system->body_q[b], *u_bar = x_bar + system->n_q + system->body_u[b];
    if (motion == MG_FIXED) mg_add_part(s->adjoint->parameters + system->body_parameters[b], 12, s->at.pose + 12 * b);
    else if (motion == MG_DRIVEN) mg_path_adjoint(c, s, b, t);
    else mg_add_part(u_bar, n_u, s->at.twist + 6 * b);
    if (motion == MG_POINT) mg_add_part(q_bar, 3, s->at.pose + 12 * b);
    if (motion == MG_FREE) {
      mg_pack(s->x, 7, x + system->body_q[b]), mg_pack(s->y_dot, 12, s->at.pose + 12 * b);
      mg_call_adjoint(c, s, MG_TASK_POSE, mg_body_kind_of(c, b));
      mg_add_part(q_bar, 7, s->x_dot);
    }
  }
}

MG_INTERNAL void mg_scene_adjoint(const mg_context *c, mg_sensitivity *s, const mg_real *x, const mg_real *slope_bar,
                                  mg_real *x_bar) {
  const int n = c->layout.work_state, parameters = c->system->n_parameters;
  mg_pack(mg_pack(mg_pack(s->x, n, x), 3, c->system->gravity), parameters, c->system->parameters);
  mg_zero_reals(s->x_dot, 3L + n + parameters); /* not all parameters need be arguments */
  c->kernels->derivatives->adjoint(MG_TASK_SCENE, 0, s->weights, s->x, slope_bar, s->x_dot);
  const mg_real *part = mg_add_part(s->adjoint->gravity, 3, mg_add_part(x_bar, n, s->x_dot));
  mg_add_part(s->adjoint->parameters, parameters, part);
}

MG_INTERNAL void mg_sensors_adjoint(const mg_context *c, mg_sensitivity *s, mg_real t, const mg_real *sensors_bar) {
  const mg_system *system = c->system;
  const int bodies = system->n_body, n = system->n_parameters - system->sensor_parameters, inputs = 3 * system->n_input,
            of_forces = c->kernels->sensors_need_forces;
  mg_real *x = s->x;
  *x++ = t;
  x = mg_pack(mg_pack(x, 12 * bodies, c->bodies.pose), 6 * bodies, c->bodies.twist);
  x = mg_pack(x, 6 * bodies, c->sensors.acceleration);
  x = mg_pack(x, 2 * system->n_pair, of_forces ? c->sensors.pair : 0);
  x = mg_pack(x, 6 * system->n_joint, of_forces ? c->sensors.joint : 0);
  x = mg_pack(x, 3, system->gravity);
  mg_pack(mg_pack(x, n, system->parameters + system->sensor_parameters), inputs, c->run->applied_input);
  mg_pack(s->y_dot, c->kernels->n_sensor, sensors_bar);
  mg_call_adjoint(c, s, MG_TASK_SENSORS, 0);
  const mg_real *x_bar = mg_add_part(s->at.pose, 12 * bodies, s->x_dot + 1);
  x_bar = mg_add_part(s->at.acceleration, 6 * bodies, mg_add_part(s->at.twist, 6 * bodies, x_bar));
  mg_pack(s->pair, 2 * system->n_pair, x_bar), x_bar += 2 * system->n_pair;
  mg_pack(s->joint, 6 * system->n_joint, x_bar), x_bar += 6 * system->n_joint;
  x_bar = mg_add_part(s->adjoint->gravity, 3, x_bar);
  x_bar = mg_add_part(s->adjoint->parameters + system->sensor_parameters, n, x_bar);
  mg_add_part(s->adjoint->input, inputs, x_bar);
}
