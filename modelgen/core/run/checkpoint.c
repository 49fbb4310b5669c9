/* Checkpoints: the state of a run as bytes (mg_save, mg_load). A header says of what it is the state; then follow the
   numbers and arrays of the mg_run in the order of its declaration. They are copied as they are, so that bytes are
   understood by the library that wrote them. Writes the run, or nothing. */
#include <stddef.h>
#include <string.h>

#include "run/run.h"
#include "base/base.h"
#include "model/model.h"

/* Header of a checkpoint. */
typedef struct {
  mg_digest magic;    /* MG_MAGIC */
  mg_digest abi;      /* MG_ABI */
  mg_digest real;     /* sizeof(mg_real) */
  mg_digest library;  /* digest of the content hash of the library */
  mg_digest sizes;    /* digest of the sizes of the system */
  mg_digest tables;   /* digest of the index tables and numbers of the system */
  mg_digest settings; /* digest of the settings */
  mg_digest length;   /* bytes, header included */
  mg_digest content;  /* digest of the bytes after the header */
} mg_checkpoint_header;

#define MG_MAGIC 0x746b7063676d0a1aULL /* says what it is, and in which order the bytes of a word are */

/* Bytes that are counted, written or read one part after the other. */
typedef struct {
  long length;               /* bytes so far */
  unsigned char *written;    /* where to write, or 0 */
  const unsigned char *read; /* where to read, or 0 */
} mg_stream;

/* Moves n bytes at `data` to the stream, or from it. */
static void mg_move(mg_stream *s, void *data, size_t n) {
  if (!n) return;
  if (s->written) memcpy(s->written + s->length, data, n);
  if (s->read) memcpy(data, s->read + s->length, n);
  s->length += (long)n;
}

static void mg_move_reals(mg_stream *s, mg_real *values, long n) { mg_move(s, values, (size_t)n * sizeof(mg_real)); }

static void mg_move_ints(mg_stream *s, int *values, long n) { mg_move(s, values, (size_t)n * sizeof(int)); }

/* Moves the whole state of a run. */
static void mg_move_run(mg_stream *stream, const mg_system *s, mg_run *run) {
  mg_move_reals(stream, &run->t, 1);
  mg_move_reals(stream, &run->h, 1);
  mg_move_reals(stream, run->x, (long)s->n_q + s->n_u + s->n_eta + 1);
  mg_move_ints(stream, run->feature_pair, s->n_contact);
  mg_move_reals(stream, run->point, 3L * s->n_contact);
  mg_move_reals(stream, run->moved_since_search, s->n_pair);
  mg_move_ints(stream, run->is_search_due, s->n_pair);
  mg_move_reals(stream, run->watched_movement, s->n_pair);
  mg_move_reals(stream, run->unfollowed_gap, s->n_pair);
  mg_move_reals(stream, run->withheld_effort, s->n_pair);
  mg_move_ints(stream, run->is_far, s->n_pair);
  mg_move_ints(stream, run->slot_balls, 2L * mg_slot_count(s));
  mg_move_reals(stream, run->ball_at, 4L * s->n_ball);
  mg_move_ints(stream, run->closed, s->n_contact);
  mg_move_ints(stream, run->active, s->n_contact);
  mg_move_ints(stream, run->friction_mode, s->n_friction);
  mg_move_reals(stream, run->slip_direction, 3L * s->n_friction);
  mg_move_ints(stream, run->patch_mode, s->n_patch_slot);
  mg_move_reals(stream, run->patch_slip_direction, 4L * s->n_patch_slot);
  mg_move_reals(stream, run->patch_support_share, 3L * s->n_patch_slot);
  mg_move_reals(stream, run->reference_force, s->n_contact + 1L + s->n_joint_row + s->n_friction_row);
  mg_move_reals(stream, run->force, s->n_contact);
  mg_move_reals(stream, run->margin, s->n_contact);
  mg_move_ints(stream, run->rolling_start, s->n_contact);
  mg_move_reals(stream, run->after_t, s->n_contact);
  mg_move_ints(stream, run->struck_by, s->n_body);
  mg_move_reals(stream, run->tilt_direction, 3L * s->n_contact);
  mg_move_reals(stream, run->search_bound, s->n_cell_tree);
  mg_move_reals(stream, run->joint_independence_max, s->n_joint);
  mg_move_reals(stream, run->joint_row_before, 12L * s->n_joint_row);
  mg_move_ints(stream, run->joint_row_independent, s->n_joint_row);
  mg_move_ints(stream, run->joint_row_ever_independent, s->n_joint_row);
  mg_move_reals(stream, run->input, 3L * s->n_input);
  mg_move_reals(stream, run->applied_input, 3L * s->n_input);
  mg_move_reals(stream, run->branch, s->n_switch);
  mg_move_ints(stream, run->switch_mode, s->n_switch);
  mg_move_ints(stream, run->switch_leader, s->n_switch);
  const size_t from = offsetof(mg_run, steps);
  mg_move(stream, (unsigned char *)run + from, sizeof(mg_run) - from);
}

/* Digest of the sizes of a system. */
static mg_digest mg_digest_sizes(const mg_system *s) {
  const int sizes[] = {
      s->n_body,     s->n_contact,   s->n_load,   s->n_pair,         s->n_feature_pair, s->n_q,
      s->n_u,        s->n_eta,       s->n_joint,  s->n_joint_row,    s->n_patch,        s->n_patch_slot,
      s->n_friction, s->n_cell_tree, s->n_cell,   s->n_friction_row, s->n_numbers,      s->n_parameters,
      s->n_input,    s->n_ball,      s->n_switch, s->n_pool};
  return mg_digest_ints(MG_DIGEST_START, sizes, (long)(sizeof sizes / sizeof *sizes));
}

/* An index table and its length. */
typedef struct {
  const int *table;
  long n;
} mg_index_table;

/* Digest of index tables. */
static mg_digest mg_digest_index_tables(mg_digest digest, const mg_index_table *tables, int n) {
  for (int k = 0; k < n; k++)
    if (tables[k].n) digest = mg_digest_ints(digest, tables[k].table, tables[k].n);
  return digest;
}

/* Digest of the tables of bodies, loads and joints. */
static mg_digest mg_digest_bodies(mg_digest digest, const mg_system *s) {
  const int b = s->n_body, l = s->n_load, j = s->n_joint;
  const mg_index_table tables[] = {{s->body_kind, b},        {s->body_q, b},          {s->body_u, b},
                                   {s->body_parameters, b},  {s->load_kind, l},       {s->load_a, l},
                                   {s->load_b, l},           {s->load_parameters, l}, {s->load_switch, l ? l + 1 : 0},
                                   {s->joint_kind, j},       {s->joint_a, j},         {s->joint_b, j},
                                   {s->joint_parameters, j}, {s->joint_row, j}};
  digest = mg_digest_index_tables(digest, tables, (int)(sizeof tables / sizeof *tables));
  return mg_digest_reals(digest, s->mass_inverse, 10L * b);
}

/* Digest of the tables of contacts and feature pairs. */
static mg_digest mg_digest_contacts(mg_digest digest, const mg_system *s) {
  const int c = s->n_contact, p = s->n_pair, e = s->n_feature_pair, all = e ? s->feature_pair_condition[e] : 0;
  const int balls = s->n_ball, partners = balls ? s->ball_partner_begin[balls] : 0;
  const mg_index_table tables[] = {{s->contact_pair, c},
                                   {s->contact_eta, c},
                                   {s->contact_feature_pair, c},
                                   {s->pair_contact, p ? p + 1 : 0},
                                   {s->pair_feature_pair, p ? p + 1 : 0},
                                   {s->pair_search, p},
                                   {s->pair_is_candidate, p},
                                   {s->pair_balls, 2L * p},
                                   {s->ball_body, balls},
                                   {s->ball_partner_begin, balls ? balls + 1 : 0},
                                   {s->ball_partner, partners},
                                   {s->ball_pair, partners},
                                   {s->pool_slot, s->n_pool ? s->n_pool + 1 : 0},
                                   {s->pool_pattern, s->n_pool},
                                   {s->ball_class, s->n_pool ? balls : 0},
                                   {s->class_pool, (long)s->n_ball_class * s->n_ball_class},
                                   {s->feature_pair_kind, e},
                                   {s->feature_pair_o, e},
                                   {s->feature_pair_f, e},
                                   {s->feature_pair_parameters, e},
                                   {s->feature_pair_owner, e},
                                   {s->feature_pair_group, e},
                                   {s->feature_pair_condition, e ? e + 1 : 0},
                                   {s->feature_shape, 2L * e},
                                   {s->feature_parameters, 2L * e},
                                   {s->feature_numbers, 2L * e},
                                   {s->feature_tree, s->n_cell_tree ? 2L * e : 0},
                                   {s->tree_shape, s->n_cell_tree},
                                   {s->feature_is_listed, 2L * e},
                                   {s->condition_kind, all},
                                   {s->condition_feature, all},
                                   {s->condition_feature_pair, all},
                                   {s->condition_numbers, all},
                                   {s->condition_is_line_end, all},
                                   {s->impact_law, c}};
  digest = mg_digest_index_tables(digest, tables, (int)(sizeof tables / sizeof *tables));
  digest = mg_digest_reals(digest, s->restitution, c);
  digest = mg_digest_reals(digest, s->pair_normal, 3L * p);
  return mg_digest_reals(digest, s->ball, 4L * balls);
}

/* Digest of the tables of friction and patches. */
static mg_digest mg_digest_friction(mg_digest digest, const mg_system *s) {
  const int p = s->n_patch, g = s->n_friction, all = p ? s->patch_covered[p] : 0, arcs = p ? s->patch_arc[p] : 0,
            shares = p ? s->patch_share[p] : 0;
  const mg_index_table tables[] = {{s->patch_pair, p},
                                   {s->patch_slots, 2L * p},
                                   {s->patch_arc, p ? p + 1 : 0},
                                   {s->patch_arc_f, p},
                                   {s->patch_numbers, p},
                                   {s->patch_covered, p ? p + 1 : 0},
                                   {s->covered_feature_pair, all},
                                   {s->patch_share, p ? p + 1 : 0},
                                   {s->share_pair, shares},
                                   {s->share_arc, 4L * shares},
                                   {s->arc_shape, arcs},
                                   {s->arc_parameters, arcs},
                                   {s->arc_numbers, arcs},
                                   {s->arc_loop, arcs},
                                   {s->contact_friction_row, g ? s->n_contact + 1 : 0},
                                   {s->contact_friction, g ? s->n_contact + 1 : 0},
                                   {s->friction_kind, g},
                                   {s->friction_row, g},
                                   {s->friction_body, g}};
  digest = mg_digest_index_tables(digest, tables, (int)(sizeof tables / sizeof *tables));
  digest = mg_digest_reals(digest, s->friction_static, 2L * g);
  digest = mg_digest_reals(digest, s->friction_kinetic, 2L * g);
  digest = mg_digest_reals(digest, s->friction_direction, 3L * g);
  return mg_digest_reals(digest, s->patch_friction, 2L * p);
}

/* Digest of all tables of a system. */
static mg_digest mg_digest_tables(const mg_system *s) {
  const mg_real scales[3] = {s->length, s->mass, s->time};
  mg_digest digest = mg_digest_friction(mg_digest_contacts(mg_digest_bodies(MG_DIGEST_START, s), s), s);
  digest = mg_digest_reals(digest, s->parameters, s->n_parameters);
  digest = mg_digest_reals(digest, s->numbers, s->n_numbers);
  digest = mg_digest_reals(digest, s->scale, (long)s->n_q + s->n_u + s->n_eta + 1);
  return mg_digest_reals(mg_digest_reals(digest, s->gravity, 3), scales, 3);
}

/* Fields first .. last of the settings, which follow each other and have one type. */
#define MG_SETTINGS_RANGE(type, first, last)                                                    \
  (const type *)(const void *)((const unsigned char *)settings + offsetof(mg_settings, first)), \
      (long)((offsetof(mg_settings, last) - offsetof(mg_settings, first)) / sizeof(type) + 1)

/* Digest of the settings. */
static mg_digest mg_digest_settings(const mg_settings *settings) {
  mg_digest digest = mg_digest_ints(MG_DIGEST_START, MG_SETTINGS_RANGE(int, method, planar_contacts));
  digest = mg_digest_reals(digest, MG_SETTINGS_RANGE(mg_real, step, step_fraction));
  digest = mg_digest_ints(digest, MG_SETTINGS_RANGE(int, lcp_iterations, chatter_closed));
  return settings->outer_solver ? mg_digest_ints(digest, &settings->outer_solver->number, 1) : digest;
}

/* Header of a checkpoint of a run, without the digest of its content. */
static mg_checkpoint_header mg_header_of(const mg_system *system, const mg_settings *settings) {
  const mg_checkpoint_header header = {MG_MAGIC,
                                       MG_ABI,
                                       sizeof(mg_real),
                                       mg_digest_text(MG_DIGEST_START, system->kernels->hash),
                                       mg_digest_sizes(system),
                                       mg_digest_tables(system),
                                       mg_digest_settings(settings),
                                       (mg_digest)mg_save_size(system),
                                       0};
  return header;
}

/* First thing in which a header differs from what is expected, or MG_LOADED. */
static int mg_compare_headers(const mg_checkpoint_header *found, const mg_checkpoint_header *expected) {
  if (found->abi != expected->abi) return MG_LOAD_OTHER_ABI;
  if (found->real != expected->real) return MG_LOAD_OTHER_REAL;
  if (found->library != expected->library) return MG_LOAD_OTHER_LIBRARY;
  if (found->sizes != expected->sizes) return MG_LOAD_OTHER_SIZES;
  if (found->tables != expected->tables) return MG_LOAD_OTHER_TABLES;
  if (found->settings != expected->settings) return MG_LOAD_OTHER_SETTINGS;
  return found->length == expected->length ? MG_LOADED : MG_LOAD_DAMAGED;
}

MG_INTERNAL void mg_store_run(const mg_system *system, const mg_run *run, unsigned char *bytes) {
  mg_stream written = {0, bytes, 0};
  mg_run state = *run;
  mg_move_run(&written, system, &state);
}

MG_INTERNAL void mg_restore_run(const mg_system *system, mg_run *run, const unsigned char *bytes) {
  mg_stream read = {0, 0, bytes};
  mg_move_run(&read, system, run);
}

MG_API long mg_save_size(const mg_system *system) {
  mg_run none = {0}; /* whose arrays are not touched while bytes are counted */
  mg_stream counted = {(long)sizeof(mg_checkpoint_header), 0, 0};
  mg_move_run(&counted, system, &none);
  return counted.length;
}

MG_API void mg_save(const mg_system *system, const mg_settings *settings, const mg_run *run, unsigned char *bytes) {
  const long start = (long)sizeof(mg_checkpoint_header);
  mg_checkpoint_header header = mg_header_of(system, settings);
  mg_store_run(system, run, bytes + start);
  header.content = mg_digest_bytes(MG_DIGEST_START, bytes + start, mg_save_size(system) - start);
  memcpy(bytes, &header, sizeof header);
}

MG_API int mg_load(const mg_system *system, const mg_settings *settings, mg_run *run, const unsigned char *bytes,
                   long length) {
  const long start = (long)sizeof(mg_checkpoint_header);
  const mg_checkpoint_header expected = mg_header_of(system, settings);
  mg_checkpoint_header found = {0};
  if (length >= start) memcpy(&found, bytes, sizeof found);
  if (found.magic != MG_MAGIC) return MG_LOAD_NO_CHECKPOINT;
  const int difference = mg_compare_headers(&found, &expected);
  if (difference) return difference;
  if ((mg_digest)length != found.length) return MG_LOAD_DAMAGED;
  if (found.content != mg_digest_bytes(MG_DIGEST_START, bytes + start, length - start)) return MG_LOAD_DAMAGED;
  mg_restore_run(system, run, bytes + start);
  return MG_LOADED;
}
