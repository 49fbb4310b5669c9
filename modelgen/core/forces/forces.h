/* Forces and accelerations at one state: the active set of normal forces, friction and its modes, planar contacts with
   pressure, elimination of joints, projection of drift. May use: base, solve, region, model, closest. */
#ifndef MG_FORCES_H
#define MG_FORCES_H

#include "model/context.h"
#include "region/region.h"
#include "solve/friction/solvers.h"
#include "solve/lcp/solvers.h"

enum { MG_MARGIN_SAMPLES = 7 }; /* samples of a step */

enum {
  MG_BOUND_SLIP = 0,
  MG_BOUND_STATIC = 1,
  MG_BOUND_KINETIC = 2
}; /* what bounds a friction constraint: its slip, or a cone */

enum {
  MG_PATCH_ROWS = 3
}; /* below the first support point's normal row: slip of its point along t1, t2, spin about N */

struct mg_patch_friction { /* a patch with friction in a slot */
  int slips;               /* it slips */
  int centre_known, partly_unloaded,
      force_outside; /* of the pressure: `centre` is known; it leaves part of the face alone; the force is beyond it */
  mg_real centre[2], extent;             /* of pressure, axes of the hull; m, of what is pressed about it */
  mg_real mean_distance, mean_point[2];  /* m, mean distance of the pressure from that centre, its own; 0: not known */
  mg_real force_ratio[MG_PATCH_ROWS][3]; /* force along a row by that on a support point, with the sign changed */
  int triggered, mode_before, slip_stopped; /* its event has fired; its mode before; slip has died */
  mg_real slip_time_left;                   /* s, slip that was stopped had left */
  mg_real slip_direction[2]; /* while slip begins: its direction is the course and so much of each across it */
};

typedef struct { /* rows and axes of a hull: t1, t2 and the support points in it, N along its z or against */
  mg_real pose[12], t[2][2], support[3][2], sign;
} mg_patch_frame;

typedef struct {
  mg_real theta;
  mg_event_margin left;
} mg_margin_sample; /* theta < 0 or > 1: no sample */

/* smooth_dynamics.c */
MG_INTERNAL int mg_has_nonfinite_driven_path(const mg_context *c);
MG_INTERNAL mg_real mg_prescribed_motion_power(const mg_context *c);
MG_INTERNAL void mg_right_hand_side(mg_context *c, mg_real t, const mg_real *x, mg_real *x_dot);
MG_INTERNAL mg_real mg_row_acceleration(const mg_context *c, int contact);
MG_INTERNAL int mg_hold_rows(mg_context *c, const int *marked, const mg_real *rate, mg_real *amount);
MG_INTERNAL void mg_evaluate_run_state(mg_context *c);

/* joint_elimination.c */
MG_INTERNAL int mg_append_bilateral_rows(const mg_context *c, int *list, int n);
MG_INTERNAL int mg_solve_contact_lcp(mg_context *c, int n, const mg_real *value, mg_lcp_report *report);
MG_INTERNAL int mg_rank_joints(mg_context *c, int *rank);
MG_INTERNAL void mg_monitor_joint_rank(mg_context *c);

/* patch_elimination.c */
MG_INTERNAL int mg_solve_friction_with_bilaterals(mg_context *c, const mg_friction_problem *p, mg_real *z,
                                                  mg_friction_report *report);
MG_INTERNAL int mg_factor_pivoted_qr(int n, mg_real *A, mg_real *y, int *order, mg_real floor);
MG_INTERNAL void mg_solve_least_norm_qr(int n, int rank, mg_real *R, const mg_real *y, mg_real *z, mg_real *beta);
MG_INTERNAL int mg_unsymmetric_rank(mg_context *c, const int *list, int n);
MG_INTERNAL void mg_solve_unsymmetric_rows(mg_context *c, const int *list, int n, mg_real *z);

/* sliding_friction.c */
MG_INTERNAL int mg_contact_of_friction(const mg_context *c, int constraint);
MG_INTERNAL int mg_friction_row_count(const mg_context *c, int constraint);
MG_INTERNAL int mg_append_sticking_rows(const mg_context *c, int *list, int n);
MG_INTERNAL mg_real mg_slip_velocity_scale(const mg_context *c, int constraint);
MG_INTERNAL mg_real mg_slip_velocity_tolerance(const mg_context *c, int constraint);
MG_INTERNAL mg_real mg_slip_along_direction(const mg_context *c, int contact, int constraint, mg_real *slip);
MG_INTERNAL void mg_set_slip_force_ratio(mg_context *c, int contact, int constraint);
MG_INTERNAL void mg_set_slip_force_ratios(mg_context *c);
MG_INTERNAL mg_real mg_delassus_entry(const mg_context *c, int row, int column);
MG_INTERNAL int mg_tangential_row_count(const mg_context *c, int row);
MG_INTERNAL void mg_couple_slip_to_normal_columns(mg_context *c, const int *list, int n);
MG_INTERNAL void mg_solve_island_with_friction(mg_context *c, int n, mg_real *amount);
MG_INTERNAL void mg_apply_slip_forces(mg_context *c);
MG_INTERNAL mg_real mg_friction_power(const mg_context *c);
MG_INTERNAL void mg_slip_direction_at_angle(const mg_context *c, int contact, int constraint, mg_real angle,
                                            mg_real *along);

/* patch_pressure.c */
MG_INTERNAL void mg_support_world_point(const mg_context *c, int support, mg_real *world);
MG_INTERNAL mg_real mg_support_resultant(const mg_context *c, int slot, const mg_real *amount, mg_real *centre);
MG_INTERNAL int mg_max_patch_arcs(const mg_system *s);
MG_INTERNAL void mg_hull_pose(const mg_context *c, int patch, mg_real *out);
MG_INTERNAL int mg_overlay_patch_regions(mg_context *c, int patch);
MG_INTERNAL mg_real mg_patch_hull_margin(mg_context *c, int patch, const mg_real *world, mg_nearest_boundary *nearest);
MG_INTERNAL mg_real mg_force_tolerance(const mg_context *c);
MG_INTERNAL int mg_find_patch_end_cause(mg_context *c, int slot, const mg_real *amount, mg_real floor, mg_real *margin);
MG_INTERNAL mg_event_margin *mg_slot_event_margins(const mg_context *c, int slot);
MG_INTERNAL int mg_find_slot_event(mg_context *c, int slot);
MG_INTERNAL int mg_mark_patch_events(mg_context *c);
MG_INTERNAL int mg_has_patch_event(mg_context *c);
MG_INTERNAL mg_real mg_patch_event_value(mg_context *c, int support, int cause);

/* patch_friction.c */
MG_INTERNAL int mg_has_patch_friction(const mg_context *c, int patch);
MG_INTERNAL int mg_is_slot_frictional(const mg_context *c, int slot);
MG_INTERNAL int mg_first_patch_friction_row(const mg_context *c, int slot);
MG_INTERNAL int mg_slipping_slot_of_row(const mg_context *c, int row);
MG_INTERNAL mg_real mg_support_radius(const mg_context *c, int slot);
MG_INTERNAL void mg_set_patch_frame(const mg_context *c, int slot, mg_patch_frame *at);
MG_INTERNAL mg_real mg_patch_slip_along_direction(const mg_context *c, int slot);
MG_INTERNAL void mg_set_patch_slip_direction(mg_context *c, int slot, const mg_real *twist);
MG_INTERNAL void mg_complete_orthonormal_basis(const mg_real *e, mg_real across[2][3]);
MG_INTERNAL void mg_patch_slip_basis(const mg_context *c, int slot, mg_real e[3][3]);
MG_INTERNAL void mg_update_patch_pressure(mg_context *c, int slot);
MG_INTERNAL void mg_set_patch_force_ratios(mg_context *c);
MG_INTERNAL int mg_has_changed_patch_pressures(mg_context *c);
MG_INTERNAL void mg_couple_slip_to_support_columns(mg_context *c, const int *list, int n);
MG_INTERNAL void mg_apply_patch_slip_forces(mg_context *c);
MG_INTERNAL int mg_append_sticking_patch_rows(const mg_context *c, int *list, int n);

/* friction_cones.c */
MG_INTERNAL void mg_set_friction_bound_kinds(mg_context *c);
MG_INTERNAL int mg_cone_index_of_kind(int friction_kind);
MG_INTERNAL void mg_set_cone_coefficients(const mg_context *c, int constraint, const mg_real *mu, mg_real part,
                                          mg_real *cone);
MG_INTERNAL void mg_set_friction_cone(const mg_context *c, int contact, mg_real part, mg_real *cone);
MG_INTERNAL int mg_append_friction_contact(mg_context *c, int contact, int k, int size);

/* contact_modes.c */
MG_INTERNAL mg_real mg_acceleration_tolerance(const mg_context *c);
MG_INTERNAL int mg_activate_supports(mg_context *c);
MG_INTERNAL int mg_solve_active_set(mg_context *c, const int *skip);

/* friction_modes.c */
MG_INTERNAL int mg_use_kinetic_bounds(mg_context *c);
MG_INTERNAL int mg_solve_friction_modes(mg_context *c, const int *skip);
MG_INTERNAL void mg_report_friction_events(mg_context *c, mg_events *events);
MG_INTERNAL mg_real mg_friction_event_value(const mg_context *c, int contact, int constraint);
MG_INTERNAL mg_real mg_friction_event_margin(const mg_context *c, int contact, int constraint);
MG_INTERNAL int mg_mark_friction_events(mg_context *c);
MG_INTERNAL int mg_has_any_friction_event(const mg_context *c);
MG_INTERNAL int mg_first_friction_event(const mg_context *c);
MG_INTERNAL void mg_begin_step_friction(mg_context *c);

/* patch_friction_modes.c */
MG_INTERNAL mg_real mg_patch_friction_event_value(mg_context *c, int slot, int cause);
MG_INTERNAL int mg_find_patch_friction_event(mg_context *c, int slot);
MG_INTERNAL void mg_begin_step_patch_friction(mg_context *c);
MG_INTERNAL void mg_reset_patch_friction(mg_context *c);
MG_INTERNAL int mg_solve_patch_friction_modes(mg_context *c, const int *skip);
MG_INTERNAL void mg_report_patch_friction_events(mg_context *c, mg_events *events);

/* drift_projection.c */
MG_INTERNAL mg_real mg_largest_held_violation(const mg_context *c, const mg_real *value);
MG_INTERNAL int mg_solve_row_correction(mg_context *c, const int *marked, const mg_real *value);
MG_INTERNAL void mg_rotate_quaternion(mg_real *e, const mg_real *angle);
MG_INTERNAL void mg_apply_pose_correction(mg_context *c);
MG_INTERNAL void mg_apply_velocity_correction(mg_context *c);
MG_INTERNAL int mg_project_drift(mg_context *c);
MG_INTERNAL int mg_project_initial_pose(mg_context *c);
MG_INTERNAL int mg_project_initial_joints(mg_context *c);

/* event_margins.c */
MG_INTERNAL int mg_event_margin_count(const mg_system *s);
MG_INTERNAL long mg_event_margin_size(const mg_system *s);
MG_INTERNAL mg_event_margin *mg_event_margins_of_sample(const mg_context *c, int sample);
MG_INTERNAL void mg_sample_event_margins(mg_context *c, int sample);
MG_INTERNAL void mg_sample_margins_at_start(mg_context *c);
MG_INTERNAL void mg_sample_margins_at_stage(mg_context *c, int stage);
MG_INTERNAL mg_real mg_interior_margin_bound(const mg_margin_sample *p, mg_real *theta);
MG_INTERNAL void mg_collect_margin_samples(const mg_context *c, int which, int end, int n, mg_real part,
                                           mg_margin_sample *p);
MG_INTERNAL int mg_is_margin_nearly_constant(const mg_context *c, int which);

/* diagnostics.c */
MG_INTERNAL mg_real mg_energy(mg_context *c, mg_real *kinetic);
MG_INTERNAL void mg_update_diagnostics(mg_context *c);
MG_INTERNAL int mg_check_margins(mg_context *c, mg_events *events);

#endif
