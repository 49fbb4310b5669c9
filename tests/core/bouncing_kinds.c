/* The smallest set of kinds, written by hand: a point mass above the plane z = 0. Lets the core be tested alone. */
#include "modelgen.h"

static const mg_body_kind body_kinds[] = {{MG_FIXED, 0, 0, 12}, {MG_POINT, 3, 3, 1}};
static const mg_contact_kind contact_kinds[] = {{0, 3, 0, 1, MG_NONE, MG_NONE, 0, 1}};
static const mg_joint_kind joint_kinds[] = {{0, 0, 0, 0, 0}};
static const mg_load_kind load_kinds[] = {{0, 0, 0, 0, 0}};
static const mg_shape_kind shape_kinds[] = {{2, 0, 0, 0, 0}, {2, 0, 0, 0, 0}};

static void body_pose(int kind, const mg_real *q, mg_real *pose) { (void)kind, (void)q, (void)pose; }

static void body_motion(int kind, const mg_real *q, const mg_real *u, const mg_real *wrench,
                           const mg_real *gravity, const mg_real *parameters, mg_real *qdot, mg_real *udot) {
  (void)kind, (void)q, (void)wrench, (void)parameters;
  for (int i = 0; i < 3; i++) qdot[i] = u[i], udot[i] = gravity[i];
}

static void body_energy(int kind, const mg_real *q, const mg_real *u, const mg_real *gravity,
                           const mg_real *parameters, mg_real *kinetic, mg_real *potential, mg_real *momentum,
                           mg_real *spin) {
  (void)kind, (void)momentum, (void)spin;
  *kinetic = *potential = 0;
  for (int i = 0; i < 3; i++) *kinetic += parameters[0] * u[i] * u[i] / 2, *potential -= parameters[0] * gravity[i] * q[i];
}

static void body_path(int kind, const mg_real *t, const mg_real *parameters, const mg_real *inputs, mg_real *pose,
                         mg_real *twist, mg_real *accel) {
  (void)kind, (void)t, (void)parameters, (void)inputs, (void)pose, (void)twist, (void)accel;
}

static void load_wrench(int kind, const mg_real *t, const mg_real *pose_a, const mg_real *twist_a,
                           const mg_real *pose_b, const mg_real *twist_b, const mg_real *parameters,
                           const mg_real *inputs, mg_real *wrench_a, mg_real *wrench_b) {
  (void)kind, (void)inputs, (void)t, (void)pose_a, (void)twist_a, (void)pose_b, (void)twist_b, (void)parameters, (void)wrench_a,
      (void)wrench_b;
}

static void load_deflection(int kind, const mg_real *pose_a, const mg_real *pose_b, const mg_real *parameters,
                               mg_real *deflection, mg_real *J) {
  (void)kind, (void)pose_a, (void)pose_b, (void)parameters, (void)deflection, (void)J;
}

static void joint_rows(int kind, const mg_real *t, const mg_real *pose_a, const mg_real *twist_a,
                          const mg_real *pose_b, const mg_real *twist_b, const mg_real *parameters,
                          const mg_real *inputs, mg_real *value, mg_real *J, mg_real *gamma, mg_real *bias) {
  (void)kind, (void)inputs, (void)t, (void)pose_a, (void)twist_a, (void)pose_b, (void)twist_b, (void)parameters, (void)value,
      (void)J, (void)gamma, (void)bias;
}

static void joint_coordinates(int kind, const mg_real *pose_a, const mg_real *pose_b, const mg_real *parameters,
                                 mg_real *coordinate) {
  (void)kind, (void)pose_a, (void)pose_b, (void)parameters, (void)coordinate;
}

static void shape_point(int kind, const mg_real *uv, const mg_real *parameters, mg_real *point,
                           mg_real *direction) {
  (void)kind, (void)uv, (void)parameters, (void)point, (void)direction;
}

static void contact_rates(int kind, const mg_real *pose_o, const mg_real *twist_o, const mg_real *pose_f,
                             const mg_real *twist_f, const mg_real *eta, const mg_real *parameters, mg_real *d,
                             mg_real *J_o, mg_real *J_f, mg_real *gamma, mg_real *eta_dot, mg_real *normal,
                             mg_real *tangents) {
  (void)kind, (void)pose_o, (void)twist_o, (void)twist_f, (void)eta, (void)J_o, (void)eta_dot, (void)tangents;
  *d = pose_f[2] - parameters[0], *gamma = 0;
  J_f[0] = J_f[1] = normal[0] = normal[1] = 0, J_f[2] = normal[2] = 1;
}

static void contact_place(int kind, const mg_real *pose_o, const mg_real *pose_f, const mg_real *eta,
                             const mg_real *parameters, mg_real *eta_next, mg_real *d, mg_real *residual,
                             mg_real *margin, mg_real *normal, mg_real *point_o, mg_real *point_f) {
  (void)kind, (void)pose_o, (void)eta, (void)eta_next;
  *d = pose_f[2] - parameters[0];
  residual[0] = residual[1] = normal[0] = normal[1] = 0, margin[0] = normal[2] = 1, margin[1] = 1 / parameters[0];
  for (int i = 0; i < 3; i++) point_o[i] = point_f[i] = pose_f[i];
}

static void contact_aim(int kind, const mg_real *pose_o, const mg_real *pose_f, const mg_real *eta,
                           const mg_real *parameters, mg_real *normal, mg_real *rounding) {
  (void)kind, (void)pose_o, (void)pose_f, (void)eta, (void)parameters, (void)normal;
  *rounding = 0;
}

static void contact_seek(int kind, const mg_real *pose_o, const mg_real *pose_f, const mg_real *normal,
                            const mg_real *parameters, mg_real *d, mg_real *slope, mg_real *bend, mg_real *tangents,
                            mg_real *eta) {
  (void)kind, (void)pose_o, (void)pose_f, (void)normal, (void)parameters, (void)d, (void)slope, (void)bend,
      (void)tangents, (void)eta;
}

static const mg_kernels table = {
    .abi = MG_ABI, .real_size = sizeof(mg_real), .hash = "by hand",
    .body_kinds = body_kinds,
    .contact_kinds = contact_kinds,
    .joint_kinds = joint_kinds,
    .load_kinds = load_kinds,
    .shape_kinds = shape_kinds,
    .body_pose = body_pose,
    .body_motion = body_motion,
    .body_energy = body_energy,
    .body_path = body_path,
    .load_wrench = load_wrench,
    .load_deflection = load_deflection,
    .joint_rows = joint_rows,
    .joint_coordinates = joint_coordinates,
    .shape_point = shape_point,
    .contact_rates = contact_rates,
    .contact_place = contact_place,
    .contact_aim = contact_aim,
    .contact_seek = contact_seek,
};
