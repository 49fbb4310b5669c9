/* Which link each contact is on, copied to where the loops over contacts look. */
/* How far a contact is from leaving its link: inequalities of its points, its normal and its eta. */
#include "model/model.h"
#include "base/base.h"

MG_INTERNAL int mg_is_on_link(const mg_context *c, int contact) { return c->run->link[contact] >= 0; }

static int mg_eta_room(const mg_context *c, int contact) {
  const mg_system *s = c->system;
  return (contact + 1 < s->n_contact ? s->contact_eta[contact + 1] : s->n_eta) - s->contact_eta[contact];
}

MG_INTERNAL mg_real *mg_contact_eta(const mg_context *c, mg_real *x, int contact) {
  return x + c->system->n_q + c->system->n_u + c->system->contact_eta[contact];
}

/* The parameters of a contact's kind; the point of a pad is the run's. */
MG_INTERNAL const mg_real *mg_contact_parameters(mg_context *c, int contact) {
  const mg_real *held = c->system->parameters + c->parameters[contact];
  if (!mg_is_support_contact(c, contact)) return held;
  const int n = c->kernels->contact_kinds[c->kind[contact]].n_parameters;
  for (int k = 0; k < n - 3; k++) c->point_parameters[k] = held[k];
  for (int k = 0; k < 3; k++) c->point_parameters[n - 3 + k] = c->run->point[3 * contact + k];
  return c->point_parameters;
}

/* Makes a contact, or the spare one behind the last, stand on a link. */
MG_INTERNAL void mg_place_on_link(mg_context *c, int contact, int link) {
  const mg_system *s = c->system;
  c->kind[contact] = s->link_kind[link], c->parameters[contact] = s->link_parameters[link];
  c->o[contact] = s->link_o[link], c->f[contact] = s->link_f[link];
}

/* No condition ends or watches a contact on the link. */
MG_INTERNAL int mg_is_unconditional_link(const mg_context *c, int link) {
  return c->system->link_condition[link] == c->system->link_condition[link + 1];
}

MG_INTERNAL int mg_pair_first_contact(const mg_context *c, int pair) { return c->system->pair_contact[pair]; }

/* Each contact of the pair has a link for good; else they share the pair's links. */
MG_INTERNAL int mg_has_own_links(const mg_context *c, int pair) {
  return c->system->contact_link[mg_pair_first_contact(c, pair)] >= 0;
}

/* What each entry of eta on a link is measured against. */
MG_INTERNAL void mg_eta_scale(const mg_context *c, int link, mg_real *scale) {
  for (int side = 0; side < 2; side++) {
    const int carrier = mg_parametrisation(c, link, side), n = mg_carried[carrier];
    const int charted = carrier == MG_CHART ? 2 : carrier == MG_CURVE || carrier == MG_SIGNED_CURVE;
    for (int k = 0; k < n; k++)
      *scale++ = k < charted           ? mg_side_numbers(c, link, side)[MG_SPAN + k]
                 : carrier == MG_LOCAL ? c->system->length
                                       : 1;
  }
}

/* A contact on no link is infinitely far away, so that no loop over contacts needs to ask. */
MG_INTERNAL void mg_read_link(mg_context *c, int contact) {
  const mg_system *s = c->system;
  const int held = c->run->link[contact], link = held < 0 ? s->pair_link[s->contact_pair[contact]] : held;
  mg_place_on_link(c, contact, link);
  c->n_live_states -= c->n_eta[contact];
  c->n_eta[contact] = held < 0 ? 0 : c->kernels->contact_kinds[c->kind[contact]].n_eta;
  c->n_live_states += c->n_eta[contact];
  if (c->n_eta[contact]) mg_eta_scale(c, link, mg_contact_eta(c, c->step.scale, contact));
  for (int k = 0; k < 12; k++) c->J[12 * contact + k] = c->MJ[12 * contact + k] = 0;
  for (int k = 0; k < mg_eta_room(c, contact); k++) c->eta_dot[s->contact_eta[contact] + k] = 0;
  c->gamma[contact] = c->d_dot[contact] = c->force[contact] = 0;
  if (s->n_grip) mg_reset_friction_rows(c, contact);
  if (held < 0) c->d[contact] = MG_MAX, c->run->margin[contact] = 1;
}

/* Puts the contact on a link with this eta, or on none (-1). */
MG_INTERNAL void mg_set_link(mg_context *c, int contact, int link, const mg_real *eta) {
  mg_real *kept = mg_contact_eta(c, c->run->x, contact);
  c->run->link[contact] = link;
  mg_read_link(c, contact);
  for (int k = 0; k < mg_eta_room(c, contact); k++) kept[k] = k < c->n_eta[contact] ? eta[k] : 0;
  if (link < 0) c->run->closed[contact] = c->run->active[contact] = c->run->fresh[contact] = 0;
}

MG_INTERNAL const mg_real *mg_side_numbers(const mg_context *c, int link, int side) {
  return c->system->numbers + c->system->side_numbers[2 * link + side];
}

MG_INTERNAL int mg_side_body(const mg_context *c, int link, int side) {
  return side ? c->system->link_f[link] : c->system->link_o[link];
}

MG_INTERNAL int mg_parametrisation(const mg_context *c, int link, int side) {
  const mg_contact_kind *kind = c->kernels->contact_kinds + c->system->link_kind[link];
  return side ? kind->carrier_f : kind->carrier_o;
}

static void mg_direction_in(const mg_context *c, int link, int side, const mg_real *world, mg_real *local) {
  mg_rotate_back(c->pose + 12 * mg_side_body(c, link, side) + 3, world, local);
  mg_rotate_back(mg_side_numbers(c, link, side) + MG_PLACEMENT + 3, local, local);
}

/* A point of the world in the axes of the shape on one side of a link. */
MG_INTERNAL void mg_point_in_shape_axes(const mg_context *c, int link, int side, const mg_real *world, mg_real *local) {
  const mg_real *pose = c->pose + 12 * mg_side_body(c, link, side),
                *place = mg_side_numbers(c, link, side) + MG_PLACEMENT;
  mg_real arm[3];
  for (int k = 0; k < 3; k++) arm[k] = world[k] - pose[k];
  mg_rotate_back(pose + 3, arm, arm);
  for (int k = 0; k < 3; k++) arm[k] -= place[k];
  mg_rotate_back(place + 3, arm, local);
}

/* The parameter of a curve at a point of it that eta does not tell: on a straight edge its first axis, on a circle or
   an ellipse the angle. */
static mg_real mg_parameter_at(const mg_context *c, int link, int side, const mg_real *point) {
  const mg_real turns[2][2] = {{0, 0}, {2 * atan((mg_real)1), 0}};
  const int shape = c->system->side_shape[2 * link + side];
  const mg_real *parameters = c->system->parameters + c->system->side_parameters[2 * link + side];
  mg_real x[3], y[3], T[3];
  c->kernels->shape_point(shape, turns[0], parameters, x, T);
  if (!(x[0] > 0)) return point[0];
  c->kernels->shape_point(shape, turns[1], parameters, y, T);
  return atan2(point[1] / y[1], point[0] / x[0]);
}

static int mg_is_charted(const mg_context *c, int link, int side) {
  const int carrier = mg_parametrisation(c, link, side);
  return carrier == MG_CHART || carrier == MG_CURVE || carrier == MG_SIGNED_CURVE;
}

/* The chart coordinates of one side; those of a plane or of a curve that eta does not tell are its first axes: an arc
   of a rounded corner needs no ends on a plane, for its circle lies within the corner. */
static void mg_coordinates(const mg_context *c, int link, int side, const mg_real *eta, const mg_real *point,
                           mg_real *uv) {
  const mg_real *own = eta + (side ? mg_carried[mg_parametrisation(c, link, 0)] : 0);
  uv[0] = mg_is_charted(c, link, side) ? own[0] : point[0];
  uv[1] = mg_parametrisation(c, link, side) == MG_CHART ? own[1] : point[1];
}

static mg_real mg_quadric(const mg_real *a, const mg_real *x) {
  return a[0] + mg_dot3(a + 1, x) + a[4] * x[0] * x[0] + a[5] * x[1] * x[1] + a[6] * x[2] * x[2] + a[7] * x[0] * x[1] +
         a[8] * x[0] * x[2] + a[9] * x[1] * x[2];
}

/* -N.w, w = a T x z + b z the direction from an edge into a face beside it, at a point of it with coordinates uv. */
static mg_real mg_wing(const mg_context *c, int link, int side, const mg_real *a, const mg_real *x, const mg_real *uv,
                       const mg_real *N) {
  const mg_system *s = c->system;
  const mg_real at[2] = {mg_is_charted(c, link, side) ? uv[0] : mg_parameter_at(c, link, side, x), uv[1]};
  mg_real point[3], T[3];
  c->kernels->shape_point(s->side_shape[2 * link + side], at, s->parameters + s->side_parameters[2 * link + side],
                          point, T);
  return -(a[0] * (T[1] * N[0] - T[0] * N[1]) / sqrt(mg_dot3(T, T)) + a[1] * N[2]);
}

MG_INTERNAL mg_real mg_sine_between(const mg_real *a, const mg_real *b) {
  const mg_real cross[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  return sqrt(mg_dot3(cross, cross));
}

MG_INTERNAL mg_real mg_link_condition(const mg_context *c, int link, int k, const mg_real *eta) {
  const mg_system *s = c->system;
  const mg_real *a = s->numbers + s->condition_numbers[k];
  const int side = s->condition_side[k];
  mg_real x[3], N[3], uv[2];
  mg_point_in_shape_axes(c, link, side, c->search.placement + (side ? 11 : 8), x);
  mg_direction_in(c, link, side, c->search.placement + 5, N);
  for (int i = 0; i < 3 && side; i++) N[i] = -N[i];
  mg_coordinates(c, link, side, eta, x, uv);
  switch (s->condition_kind[k]) {
    case MG_QUADRIC:
      return mg_quadric(a, x) / s->length;
    case MG_PARAMETER:
      return a[1] * (uv[(int)a[0]] - a[2]) / mg_side_numbers(c, link, side)[MG_SPAN + (int)a[0]];
    case MG_DISC:
      return a[0] - (uv[0] * uv[0] + uv[1] * uv[1]) / a[0];
    case MG_WING:
      return mg_wing(c, link, side, a, x, uv, N);
    case MG_TILT:
      return a[3] * (mg_sine_between(a, N) - c->settings->flat);
    default:
      return -mg_dot3(a, N);
  }
}

/* The least of the conditions of a link at eta, and which it is, among those that are watched only or among the
   others; needs mg_place_contact there. */
MG_INTERNAL mg_real mg_least_link_condition(const mg_context *c, int link, const mg_real *eta, int watched,
                                            int *which) {
  mg_real least = MG_MAX;
  *which = -1;
  for (int k = c->system->link_condition[link]; k < c->system->link_condition[link + 1]; k++) {
    if ((c->system->condition_next[k] == MG_WATCHED) != watched) continue;
    const mg_real value = mg_link_condition(c, link, k, eta);
    if (value < least) least = value, *which = k;
  }
  return least;
}

MG_INTERNAL mg_real mg_most_violated_condition(const mg_context *c, int link, const mg_real *eta, int *which) {
  return mg_least_link_condition(c, link, eta, 0, which);
}

MG_INTERNAL int mg_has_signs(const mg_context *c, int link) {
  return mg_parametrisation(c, link, 0) == MG_SIGN || mg_parametrisation(c, link, 1) == MG_SIGNED_CURVE;
}

/* No condition on the normal tells the outside. */
MG_INTERNAL int mg_has_no_outside(const mg_context *c, int link) {
  const mg_system *s = c->system;
  for (int k = s->link_condition[link]; k < s->link_condition[link + 1]; k++)
    if (s->condition_kind[k] == MG_WING || s->condition_kind[k] == MG_DIRECTION) return 0;
  return 1;
}
