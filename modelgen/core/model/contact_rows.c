/* Rows of the contacts: J (Lemma 3.1, equation (3.3) of Anitescu, Cremer and Potra, 1995), Gamma2 (Corollary 3.2,
   (3.11) with corrected signs), tangents and friction rows; rates of all rows. Writes c->rows. */
#include "model/model.h"
#include "base/base.h"

/* Rotates t1, t2 and the rows along and about them to the principal axes of anisotropic friction; leaves them if that
   axis is along N. */
static void mg_align_tangents_to_friction(mg_context *c, int contact, int constraint) {
  const int row = mg_first_friction_row(c, contact, constraint),
            rolls = c->kernels->contact_kinds[c->contacts.kind[contact]].rows > 4;
  mg_real along[3], *t = c->rows.tangents + 6 * contact;
  mg_to_world(c->bodies.pose + 12 * c->system->friction_body[constraint],
              c->system->friction_direction + 3 * constraint, 0, along);
  const mg_real x = mg_dot3(t, along), y = mg_dot3(t + 3, along), size = sqrt(x * x + y * y);
  if (!(size > 0)) return;
  for (int k = 0; k < 3; k++) mg_rotate_pair(x / size, y / size, t + k, t + 3 + k);
  for (int i = row; i <= row + 3 * rolls; i += 3) {
    for (int k = 0; k < 12; k++)
      mg_rotate_pair(x / size, y / size, c->rows.J + 12 * i + k, c->rows.J + 12 * (i + 1) + k);
    mg_rotate_pair(x / size, y / size, c->rows.gamma + i, c->rows.gamma + i + 1);
  }
}

/* Copies rows of a point of the rim to a contact. The feature pair of the point may have o and f exchanged
   (`turned`): then N and t2 are reversed, and slip along t1 and rolling about t2 change sign. */
static void mg_set_rim_rows(mg_context *c, int contact, const mg_contact_kind *point, int turned,
                            const mg_real *block) {
  mg_real *normal = c->rows.normal + 3 * contact;
  for (int i = 0; i < c->kernels->contact_kinds[c->contacts.kind[contact]].rows; i++) {
    const int row = i ? c->layout.friction_row_begin + c->system->contact_friction_row[contact] + i - 1 : contact;
    const mg_real sign = turned && (i == 1 || i == 4) ? -1 : 1;
    mg_real *J = c->rows.J + 12 * row;
    for (int k = 0; k < 12; k++) J[k] = 0;
    for (int k = 0; k < point->n_o; k++) J[turned ? 6 + k : k] = sign * block[point->n_o * i + k];
    for (int k = 0; k < point->n_f; k++) J[turned ? k : 6 + k] = sign * block[36 + point->n_f * i + k];
    c->rows.gamma[row] = sign * block[72 + i];
  }
  for (int k = 0; k < 3 && turned; k++) normal[k] = -normal[k];
  for (int k = 3; k < 6 && turned && c->rows.tangents; k++) c->rows.tangents[6 * contact + k] *= -1;
  if (!c->rows.tangents) return;
  for (int g = c->system->contact_friction[contact]; g < c->system->contact_friction[contact + 1]; g++)
    if (c->system->friction_body[g] >= 0) mg_align_tangents_to_friction(c, contact, g);
}

/* Feature pair of a support point of the patch that has as many rows as the contact's feature pair, or -1. */
static int mg_rim_feature_pair(const mg_context *c, int patch, int contact_feature_pair) {
  const mg_system *s = c->system;
  for (int feature_pair = c->layout.support_feature_pair_begin + 3 * patch + 1;
       feature_pair >= c->layout.support_feature_pair_begin + 3 * patch; feature_pair--)
    if (c->kernels->contact_kinds[s->feature_pair_kind[feature_pair]].rows >=
        c->kernels->contact_kinds[s->feature_pair_kind[contact_feature_pair]].rows)
      return feature_pair;
  return -1;
}

/* True if the contact starts from flat and its tilt is still within rounding; then its rows are set to those of
   the point at which it begins to roll, because its own equations are singular. */
static int mg_set_rows_of_flat_start(mg_context *c, int contact) {
  const mg_system *s = c->system;
  const mg_real lost = c->settings->flat_angle * c->settings->flat_angle;
  const int patch =
      c->run->rolling_start[contact] == MG_START_FLAT ? mg_find_flat_patch_of_contact(c, contact, lost) : -1;
  const int feature_pair = patch < 0 ? -1 : mg_rim_feature_pair(c, patch, c->run->feature_pair[contact]);
  if (feature_pair < 0) return 0;
  const int kind = s->feature_pair_kind[feature_pair], n = c->kernels->contact_kinds[kind].n_parameters,
            o = mg_feature_body(c, feature_pair, 0), f = mg_feature_body(c, feature_pair, 1);
  mg_real none[1], world[3], block[78];
  for (int k = 0; k < n - 3; k++)
    c->contacts.point_parameters[k] = s->parameters[s->feature_pair_parameters[feature_pair] + k];
  mg_to_world(c->bodies.pose + 12 * c->contacts.f[contact], c->run->point + 3 * contact, 1, world);
  mg_world_to_local_point(c->bodies.pose + 12 * f, world, c->contacts.point_parameters + n - 3);
  c->kernels->contact_rates(kind, c->bodies.pose + 12 * o, c->bodies.twist + 6 * o, c->bodies.pose + 12 * f,
                            c->bodies.twist + 6 * f, 0, c->contacts.point_parameters, c->rows.d + contact, block,
                            block + 36, block + 72, none, c->rows.normal + 3 * contact,
                            c->rows.tangents ? c->rows.tangents + 6 * contact : 0);
  mg_set_rim_rows(c, contact, c->kernels->contact_kinds + kind, o != c->contacts.o[contact], block);
  return 1;
}

/* Copies the columns of one body: 6, 3 or 0. */
static inline void mg_copy_columns(int n, const mg_real *from, mg_real *to) {
  if (n == 6) to[0] = from[0], to[1] = from[1], to[2] = from[2], to[3] = from[3], to[4] = from[4], to[5] = from[5];
  else
    for (int k = 0; k < n; k++) to[k] = from[k];
}

/* Copies the rows that the kernel of a contact gave to the rows of all contacts. */
static void mg_scatter_contact_rows(mg_context *c, int contact) {
  const mg_contact_kind *kind = c->kernels->contact_kinds + c->contacts.kind[contact];
  const mg_real *from = c->rows.kernel_rows;
  const int n_o = kind->n_o, n_f = kind->n_f, use_gamma = c->settings->use_gamma,
            before = c->layout.friction_row_begin + c->system->contact_friction_row[contact] - 1;
  for (int i = 0; i < kind->rows; i++) {
    const int row = i ? before + i : contact;
    mg_real *J = c->rows.J + 12 * row;
    mg_copy_columns(n_o, from + n_o * i, J);
    mg_copy_columns(n_f, from + 36 + n_f * i, J + 6);
    c->rows.gamma[row] = use_gamma ? from[72 + i] : 0;
  }
  for (int g = c->system->contact_friction[contact]; g < c->system->contact_friction[contact + 1]; g++)
    if (c->system->friction_body[g] >= 0) mg_align_tangents_to_friction(c, contact, g);
}

MG_INTERNAL void mg_update_rows_of_contact(mg_context *c, int i, const mg_real *x) {
  MG_NEEDS_AT(c, MG_VALID_POSES, x), MG_NEEDS_AT(c, MG_VALID_TWISTS, x);
  const mg_system *s = c->system;
  const int kind = c->contacts.kind[i], o = c->contacts.o[i], f = c->contacts.f[i],
            below = c->kernels->contact_kinds[kind].rows > 1;
  if (c->run->rolling_start[i] && mg_set_rows_of_flat_start(c, i)) return;
  c->kernels->contact_rates(
      kind, c->bodies.pose + 12 * o, c->bodies.twist + 6 * o, c->bodies.pose + 12 * f, c->bodies.twist + 6 * f,
      x + s->n_q + s->n_u + s->contact_eta[i], mg_contact_parameters(c, i), c->rows.d + i,
      below ? c->rows.kernel_rows : c->rows.J + 12 * i, below ? c->rows.kernel_rows + 36 : c->rows.J + 12 * i + 6,
      below ? c->rows.kernel_rows + 72 : c->rows.gamma + i, c->rows.eta_dot + s->contact_eta[i], c->rows.normal + 3 * i,
      below ? c->rows.tangents + 6 * i : 0);
  if (below) mg_scatter_contact_rows(c, i);
  if (!c->settings->use_gamma) c->rows.gamma[i] = 0;
}

MG_INTERNAL void mg_update_contact_rows(mg_context *c, const mg_real *x) {
  MG_NEEDS_AT(c, MG_VALID_POSES, x);
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->run->feature_pair[i] >= 0) mg_update_rows_of_contact(c, i, x);
  MG_NOTE(c, MG_VALID_ROWS, c->valid.t, x), MG_NOTE_WITH(c, MG_VALID_GAPS, MG_VALID_POSES);
}

MG_INTERNAL mg_real mg_prescribed_gap_rate(const mg_context *c, int contact) {
  mg_real rate = c->rows.time_rate[contact];
  for (int side = 0; side < 2; side++) {
    const int body = side ? c->contacts.f[contact] : c->contacts.o[contact];
    if (c->bodies.motion[body] == MG_DRIVEN)
      rate += mg_dot6(c->rows.J + 12 * contact + 6 * side, c->bodies.twist + 6 * body);
  }
  return rate;
}

/* Writes d_dot of the rows of a joint. */
static void mg_update_joint_rates(mg_context *c, int joint) {
  const int a = c->system->joint_a[joint], b = c->system->joint_b[joint],
            begin = c->layout.joint_row_begin + c->system->joint_row[joint],
            end = begin + c->kernels->joint_kinds[c->system->joint_kind[joint]].n_rows;
  const mg_real *twist_a = c->bodies.motion[a] != MG_FIXED ? c->bodies.twist + 6 * a : 0,
                *twist_b = c->bodies.motion[b] != MG_FIXED ? c->bodies.twist + 6 * b : 0, *J = c->rows.J + 12 * begin;
  for (int i = begin; i < end; i++, J += 12) {
    mg_real rate = twist_a ? mg_dot6(J, twist_a) : 0;
    if (twist_b) rate += mg_dot6(J + 6, twist_b);
    c->rows.d_dot[i] = c->contacts.is_inertial[i] ? 0 : rate + c->rows.time_rate[i];
  }
}

MG_INTERNAL void mg_update_gap_rates(mg_context *c) {
  MG_NEEDS_ANY(c, MG_VALID_ROWS);
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    if (c->run->feature_pair[i] >= 0) c->rows.d_dot[i] = mg_row_times(c, i, c->bodies.twist);
  for (int j = 0; j < c->system->n_joint; j++) mg_update_joint_rates(c, j);
  mg_update_slip_velocities(c);
  MG_NOTE_WITH(c, MG_VALID_RATES, MG_VALID_TWISTS);
}

MG_INTERNAL int mg_first_friction_row(const mg_context *c, int contact, int constraint) {
  MG_REQUIRE(contact >= 0 && contact < c->system->n_contact && constraint >= 0 && constraint < c->system->n_friction);
  return c->layout.friction_row_begin + c->system->contact_friction_row[contact] + c->system->friction_row[constraint];
}

MG_INTERNAL void mg_rotate_pair(mg_real cosine, mg_real sine, mg_real *a, mg_real *b) {
  const mg_real x = *a, y = *b;
  *a = cosine * x + sine * y, *b = cosine * y - sine * x;
}

MG_INTERNAL void mg_update_slip_velocities(mg_context *c) {
  const int *rows = c->system->contact_friction_row;
  for (int i = mg_next_row(c, -1); i < c->system->n_contact; i = mg_next_row(c, i))
    for (int k = rows[i]; k < rows[i + 1] && c->run->feature_pair[i] >= 0; k++)
      c->rows.d_dot[c->layout.friction_row_begin + k] =
          mg_row_times(c, c->layout.friction_row_begin + k, c->bodies.twist);
  MG_NOTE_WITH(c, MG_VALID_SLIP, MG_VALID_TWISTS);
}
