/* The scene as the solver sees it at one state: bodies, feature pairs, rows of contacts and joints, planar contacts,
   and what becomes of a contact at an event. May use: base, region. */
#ifndef MG_MODEL_H
#define MG_MODEL_H

#include "model/context.h"

static const int mg_carried[] = {0, 3, 2, 1, 3, 1, 1}; /* entries of eta by carrier */

enum {
  MG_IMPACT_INELASTIC,
  MG_IMPACT_AVOIDED,
  MG_TOUCHES_DOWN,
  MG_IMPACT_REBOUND,
  MG_PUSHED_OPEN,
  MG_LIFTS_OFF,
  MG_CONTACT_APPEARS,
  MG_FEATURE_CHANGES,
  MG_CONTACT_VANISHES,
  MG_ENDS_RUN,
  MG_PATCH_BEGINS,
  MG_PATCH_TURNS_OVER_EDGE
};

enum {
  MG_TRIAL_ON_EDGE = 2,
  MG_TRIAL_TORN_OFF = 3
}; /* marks in c->patches.trial: the slot's support points stand on points of the edge; and had rested flat */

/* bodies.c */
MG_INTERNAL int mg_body_kind_of(const mg_context *c, int body);
MG_INTERNAL int mg_is_moved_by_forces(const mg_context *c, int body);
MG_INTERNAL void mg_copy_velocity(const mg_context *c, int body, const mg_real *from, mg_real *to);
MG_INTERNAL void mg_update_poses(mg_context *c, mg_real t, const mg_real *x);
MG_INTERNAL void mg_load_wrench(const mg_context *c, mg_real t, int load, mg_real *wrench);
MG_INTERNAL void mg_free_accelerations(mg_context *c, mg_real t, const mg_real *x, mg_real *x_dot);
MG_INTERNAL void mg_normalise_quaternions(const mg_context *c, mg_real *x);
MG_INTERNAL int mg_moving_body(const mg_context *c, int contact);
MG_INTERNAL int mg_is_free_body(const mg_context *c, int body);
MG_INTERNAL int mg_is_driven_body(const mg_system *s, int body);

/* feature_pairs.c */
MG_INTERNAL int mg_is_on_feature_pair(const mg_context *c, int contact);
MG_INTERNAL mg_real *mg_contact_eta(const mg_context *c, mg_real *x, int contact);
MG_INTERNAL const mg_real *mg_contact_parameters(mg_context *c, int contact);
MG_INTERNAL void mg_place_on_feature_pair(mg_context *c, int contact, int feature_pair);
MG_INTERNAL int mg_is_unconditional_feature_pair(const mg_context *c, int feature_pair);
MG_INTERNAL int mg_pair_first_contact(const mg_context *c, int pair);
MG_INTERNAL int mg_has_own_feature_pairs(const mg_context *c, int pair);
MG_INTERNAL void mg_eta_scale(const mg_context *c, int feature_pair, mg_real *scale);
MG_INTERNAL void mg_load_feature_pair(mg_context *c, int contact);
MG_INTERNAL void mg_set_feature_pair(mg_context *c, int contact, int feature_pair, const mg_real *eta);
MG_INTERNAL const mg_real *mg_feature_numbers(const mg_context *c, int feature_pair, int side);
MG_INTERNAL int mg_feature_body(const mg_context *c, int feature_pair, int side);
MG_INTERNAL int mg_parametrisation(const mg_context *c, int feature_pair, int side);
MG_INTERNAL void mg_point_in_shape_axes(const mg_context *c, int feature_pair, int side, const mg_real *world,
                                        mg_real *local);
MG_INTERNAL mg_real mg_sine_between(const mg_real *a, const mg_real *b);
MG_INTERNAL mg_real mg_feature_pair_condition(const mg_context *c, int feature_pair, int k, const mg_real *eta);
MG_INTERNAL mg_real mg_least_feature_pair_condition(const mg_context *c, int feature_pair, const mg_real *eta,
                                                    int watched, int *which);
MG_INTERNAL mg_real mg_most_violated_condition(const mg_context *c, int feature_pair, const mg_real *eta, int *which);
MG_INTERNAL int mg_has_normal_sign(const mg_context *c, int feature_pair);
MG_INTERNAL int mg_has_no_outside(const mg_context *c, int feature_pair);

/* contact_rows.c */
MG_INTERNAL void mg_update_contact_rows(mg_context *c, const mg_real *x);
MG_INTERNAL mg_real mg_row_times(const mg_context *c, int contact, const mg_real *per_body);
MG_INTERNAL mg_real mg_update_inverse_mass_row(mg_context *c, int contact);
MG_INTERNAL void mg_add_row_response(mg_context *c, int contact, mg_real amount, mg_real *per_body);
MG_INTERNAL void mg_assemble_delassus(mg_context *c, const int *list, int n);
MG_INTERNAL mg_real mg_prescribed_gap_rate(const mg_context *c, int contact);
MG_INTERNAL void mg_update_gap_rates(mg_context *c);
MG_INTERNAL int mg_first_friction_row(const mg_context *c, int contact, int constraint);
MG_INTERNAL void mg_reset_friction_rows(mg_context *c, int contact);
MG_INTERNAL void mg_rotate_pair(mg_real cosine, mg_real sine, mg_real *a, mg_real *b);
MG_INTERNAL void mg_update_slip_velocities(mg_context *c);

/* joint_rows.c */
MG_INTERNAL void mg_init_joint_rows(mg_context *c);
MG_INTERNAL void mg_update_joint_rows(mg_context *c, mg_real t);
MG_INTERNAL int mg_append_joint_rows(const mg_context *c, int *list, int n);
MG_INTERNAL int mg_row_joint(const mg_context *c, int row);
MG_INTERNAL int mg_worst_joint(const mg_context *c, const mg_real *value, mg_real *size);

/* contact_points.c */
MG_INTERNAL int mg_place_contact(mg_context *c, int contact, const mg_real *eta, mg_real *eta_next);
MG_INTERNAL mg_real mg_placement_margin(const mg_context *c);
MG_INTERNAL int mg_place_all_contacts(mg_context *c, mg_real t, mg_real *x);
MG_INTERNAL int mg_newton_on_feature_pair(mg_context *c, int contact, mg_real *eta);
MG_INTERNAL int mg_is_tilt_below_flat_limit(const mg_context *c, int contact);

/* bounding_balls.c */
MG_INTERNAL int mg_is_out_of_reach(const mg_context *c, int feature_pair);
MG_INTERNAL mg_real mg_pair_clearance(const mg_context *c, int pair);
MG_INTERNAL mg_motion_bound mg_pair_motion_bound(const mg_context *c, int pair);

/* planar_contacts.c */
MG_INTERNAL int mg_is_support_contact(const mg_context *c, int contact);
MG_INTERNAL int mg_first_support(const mg_context *c, int slot);
MG_INTERNAL int mg_patch_of_slot(const mg_context *c, int slot);
MG_INTERNAL int mg_slot_of_patch(const mg_context *c, int patch);
MG_INTERNAL int mg_find_free_slot(const mg_context *c, int patch);
MG_INTERNAL int mg_is_feature_pair_in_patch(const mg_context *c, int patch, int feature_pair);
MG_INTERNAL int mg_find_flat_patch_of_contact(const mg_context *c, int contact, mg_real lean);
MG_INTERNAL int mg_is_feature_pair_of_flat_faces(const mg_context *c, int feature_pair);
MG_INTERNAL int mg_is_feature_pair_of_tilted_faces(const mg_context *c, int feature_pair);
MG_INTERNAL int mg_is_distant_flat_feature_pair(const mg_context *c, int contact);
MG_INTERNAL int mg_is_patch_rolling_start(const mg_context *c, int patch);
MG_INTERNAL int mg_has_opening_patch(const mg_context *c, int pair);
MG_INTERNAL mg_real mg_patch_opening_step_limit(const mg_context *c);
MG_INTERNAL int mg_has_patch_just_opened(const mg_context *c, int contact);
MG_INTERNAL int mg_is_feature_pair_covered(const mg_context *c, int feature_pair);
MG_INTERNAL int mg_is_patch_of_pair(const mg_context *c, int patch, int pair);
MG_INTERNAL int mg_has_held_patch(const mg_context *c, int pair);
MG_INTERNAL void mg_request_pair_searches(mg_context *c, int patch);
MG_INTERNAL int mg_patch_body(const mg_context *c, int patch, int side);
MG_INTERNAL const mg_real *mg_support_point_of_feature_pair(const mg_context *c, int feature_pair);
MG_INTERNAL void mg_attach_patch(mg_context *c, int slot, int patch);
MG_INTERNAL void mg_release_patch(mg_context *c, int slot);
MG_INTERNAL void mg_face_pose(const mg_context *c, int patch, int side, mg_real *out);
MG_INTERNAL int mg_is_support_on_edge(const mg_context *c, int contact);
MG_INTERNAL int mg_is_edge_pivot(const mg_context *c, int slot);
MG_INTERNAL int mg_is_hull_side_pivot(const mg_context *c, int slot);
MG_INTERNAL int mg_find_pivot_end_cause(const mg_context *c, int slot, const mg_real *amount, mg_real floor);
MG_INTERNAL mg_real mg_pivot_event_value(const mg_context *c, int slot, int cause);

/* transitions.c */
MG_INTERNAL void mg_append_event(const mg_context *c, mg_events *events, mg_real t, int kind, int contact,
                                 mg_real speed);
MG_INTERNAL void mg_apply_contact_transition(mg_context *c, mg_events *events, int contact, int cause, mg_real t,
                                             mg_real speed);
MG_INTERNAL void mg_clear_triggered_events(mg_context *c);
MG_INTERNAL void mg_advance_time(mg_run *run, mg_real h);

#endif
