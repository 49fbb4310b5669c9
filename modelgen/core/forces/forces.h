/* Forces and accelerations at one state: the active set of normal forces, friction and its modes, planar contacts with
   pressure, elimination of joints, projection of drift. May use: base, solve, region, model, closest. */
#ifndef MG_FORCES_H
#define MG_FORCES_H

#include "model/context.h"
#include "region/region.h"
#include "solve/friction/solvers.h"
#include "solve/lcp/solvers.h"

enum { MG_MARGIN_SAMPLES = 7 }; /* samples of a step */

enum { MG_BOUND_SLIP = 0, MG_BOUND_STATIC = 1, MG_BOUND_KINETIC = 2 }; /* what bounds a grip: its slip, or a cone */

enum { MG_PATCH_ROWS = 3 }; /* below the first pad's normal row: slip of its point along t1, t2, spin about N */

struct mg_patch_friction { /* a patch with friction in a slot */
  int slips;               /* it slips */
  int centre_known, partly_unloaded,
      force_outside; /* of the pressure: `centre` is known; it leaves part of the face alone; the force is beyond it */
  mg_real centre[2], extent;             /* of pressure, axes of the hull; m, of what is pressed about it */
  mg_real mean_distance, mean_point[2];  /* m, mean distance of the pressure from that centre, its own; 0: not known */
  mg_real force_ratio[MG_PATCH_ROWS][3]; /* force along a row by that on a pad, with the sign changed */
  int triggered, mode_before, slip_stopped; /* its event has fired; its mode before; slip has died */
  mg_real slip_time_left;                   /* s, slip that was stopped had left */
  mg_real slip_direction[2]; /* while slip begins: its direction is the course and so much of each across it */
};

typedef struct { /* rows and axes of a hull: t1, t2 and the pads in it, N along its z or against */
  mg_real pose[12], t[2][2], pad[3][2], sign;
} mg_patch_frame;

typedef struct {
  mg_real theta;
  mg_event_margin left;
} mg_margin_sample; /* theta < 0 or > 1: no sample */

/* smooth_dynamics.c */
MG_INTERNAL int mg_has_nonfinite_path(const mg_context *c);
MG_INTERNAL mg_real mg_driven_power(const mg_context *c);
MG_INTERNAL void mg_rhs(mg_context *c, mg_real t, const mg_real *x, mg_real *x_dot);
MG_INTERNAL mg_real mg_gap_acceleration(const mg_context *c, int contact);
MG_INTERNAL int mg_hold_rows(mg_context *c, const int *marked, const mg_real *rate, mg_real *amount);
MG_INTERNAL void mg_update_rows_and_forces(mg_context *c);

/* joint_elimination.c */
MG_INTERNAL int mg_append_bilateral_rows(const mg_context *c, int *list, int n);
MG_INTERNAL int mg_solve_complementarity(mg_context *c, int n, const mg_real *value, mg_lcp_report *report);
MG_INTERNAL int mg_rank_joints(mg_context *c, int *rank);
MG_INTERNAL void mg_monitor_joint_rank(mg_context *c);

/* patch_elimination.c */
MG_INTERNAL int mg_friction_with_bilateral(mg_context *c, const mg_friction_problem *p, mg_real *z,
                                           mg_friction_report *report);
MG_INTERNAL int mg_qr_pivoted(int n, mg_real *A, mg_real *y, int *order, mg_real floor);
MG_INTERNAL void mg_qr_least_norm(int n, int rank, mg_real *R, const mg_real *y, mg_real *z, mg_real *beta);
MG_INTERNAL int mg_asymmetric_rank(mg_context *c, const int *list, int n);
MG_INTERNAL void mg_asymmetric_solve(mg_context *c, const int *list, int n, mg_real *z);

/* sliding_friction.c */
MG_INTERNAL int mg_grip_contact(const mg_context *c, int grip);
MG_INTERNAL int mg_grip_rows(const mg_context *c, int grip);
MG_INTERNAL int mg_append_sticking_rows(const mg_context *c, int *list, int n);
MG_INTERNAL mg_real mg_slip_scale(const mg_context *c, int grip);
MG_INTERNAL mg_real mg_stick_speed(const mg_context *c, int grip);
MG_INTERNAL mg_real mg_speed_along_slip(const mg_context *c, int contact, int grip, mg_real *slip);
MG_INTERNAL void mg_update_force_ratio(mg_context *c, int contact, int grip);
MG_INTERNAL void mg_update_force_ratios(mg_context *c);
MG_INTERNAL mg_real mg_delassus_entry(const mg_context *c, int row, int column);
MG_INTERNAL int mg_friction_row_count(const mg_context *c, int row);
MG_INTERNAL void mg_couple_columns(mg_context *c, const int *list, int n);
MG_INTERNAL void mg_hold_coupled_rows(mg_context *c, int n, mg_real *amount);
MG_INTERNAL void mg_add_slip_forces(mg_context *c);
MG_INTERNAL mg_real mg_slipping_power(const mg_context *c);
MG_INTERNAL void mg_rotated_slip_direction(const mg_context *c, int contact, int grip, mg_real angle, mg_real *along);

/* patch_pressure.c */
MG_INTERNAL void mg_support_in_hull(const mg_context *c, int pad, mg_real *world);
MG_INTERNAL mg_real mg_pressure_resultant(const mg_context *c, int slot, const mg_real *amount, mg_real *centre);
MG_INTERNAL int mg_max_patch_arcs(const mg_system *s);
MG_INTERNAL void mg_hull_pose(const mg_context *c, int patch, mg_real *out);
MG_INTERNAL int mg_overlay_patch(mg_context *c, int patch);
MG_INTERNAL mg_real mg_patch_margin(mg_context *c, int patch, const mg_real *world, mg_nearest_boundary *brink);
MG_INTERNAL mg_real mg_patch_force_scale(const mg_context *c);
MG_INTERNAL int mg_is_patch_ending(mg_context *c, int slot, const mg_real *amount, mg_real floor, mg_real *margin);
MG_INTERNAL mg_event_margin *mg_note_slot_margin(const mg_context *c, int slot);
MG_INTERNAL int mg_slot_end_cause(mg_context *c, int slot);
MG_INTERNAL int mg_trigger_patches(mg_context *c);
MG_INTERNAL int mg_any_patch_ends(mg_context *c);
MG_INTERNAL mg_real mg_patch_event_value(mg_context *c, int pad, int cause);

/* patch_friction.c */
MG_INTERNAL int mg_has_patch_friction(const mg_context *c, int patch);
MG_INTERNAL int mg_is_frictional_slot(const mg_context *c, int slot);
MG_INTERNAL int mg_patch_friction_row(const mg_context *c, int slot);
MG_INTERNAL int mg_slipping_slot_of_row(const mg_context *c, int row);
MG_INTERNAL mg_real mg_patch_radius(const mg_context *c, int slot);
MG_INTERNAL void mg_patch_axes(const mg_context *c, int slot, mg_patch_frame *at);
MG_INTERNAL mg_real mg_patch_slip_speed(const mg_context *c, int slot);
MG_INTERNAL void mg_set_patch_slip_direction(mg_context *c, int slot, const mg_real *twist);
MG_INTERNAL void mg_orthogonal_pair(const mg_real *e, mg_real across[2][3]);
MG_INTERNAL void mg_patch_slip_basis(const mg_context *c, int slot, mg_real e[3][3]);
MG_INTERNAL void mg_patch_pressure(mg_context *c, int slot);
MG_INTERNAL void mg_begin_patch_friction(mg_context *c);
MG_INTERNAL int mg_is_pressure_changing(mg_context *c);
MG_INTERNAL void mg_couple_supports(mg_context *c, const int *list, int n);
MG_INTERNAL void mg_add_patch_friction(mg_context *c);
MG_INTERNAL int mg_append_sticking_patches(const mg_context *c, int *list, int n);

/* friction_cones.c */
MG_INTERNAL void mg_update_friction_bounds(mg_context *c);
MG_INTERNAL int mg_cone_index(int aspect);
MG_INTERNAL void mg_write_bound(const mg_context *c, int grip, const mg_real *mu, mg_real part, mg_real *cone);
MG_INTERNAL void mg_write_cone(const mg_context *c, int contact, mg_real part, mg_real *cone);
MG_INTERNAL int mg_append_contact_rows(mg_context *c, int contact, int k, int size);

/* contact_modes.c */
MG_INTERNAL mg_real mg_rest_acceleration(const mg_context *c);
MG_INTERNAL int mg_activate_supports(mg_context *c);
MG_INTERNAL int mg_solve_active_set(mg_context *c, const int *skip);

/* friction_modes.c */
MG_INTERNAL int mg_apply_kinetic_bounds(mg_context *c);
MG_INTERNAL int mg_solve_friction_modes(mg_context *c, const int *skip);
MG_INTERNAL void mg_report_friction_events(mg_context *c, mg_events *events);
MG_INTERNAL mg_real mg_friction_event_value(const mg_context *c, int contact, int grip);
MG_INTERNAL mg_real mg_friction_event_margin(const mg_context *c, int contact, int grip);
MG_INTERNAL int mg_trigger_friction(mg_context *c);
MG_INTERNAL int mg_is_friction_event_near(const mg_context *c);
MG_INTERNAL int mg_first_triggered_grip(const mg_context *c);
MG_INTERNAL void mg_set_slip_directions(mg_context *c);

/* patch_friction_modes.c */
MG_INTERNAL mg_real mg_patch_friction_value(mg_context *c, int slot, int cause);
MG_INTERNAL int mg_is_patch_friction_triggered(mg_context *c, int slot);
MG_INTERNAL void mg_set_patch_slip_directions(mg_context *c);
MG_INTERNAL void mg_clear_patch_friction(mg_context *c);
MG_INTERNAL int mg_solve_patch_modes(mg_context *c, const int *skip);
MG_INTERNAL void mg_report_patch_friction(mg_context *c, mg_events *events);

/* drift_projection.c */
MG_INTERNAL mg_real mg_largest_drift(const mg_context *c, const mg_real *value);
MG_INTERNAL int mg_projection_step(mg_context *c, const int *marked, const mg_real *value);
MG_INTERNAL void mg_rotate_quaternion(mg_real *e, const mg_real *angle);
MG_INTERNAL void mg_correct_positions(mg_context *c);
MG_INTERNAL void mg_correct_velocities(mg_context *c);
MG_INTERNAL int mg_project_drift(mg_context *c);
MG_INTERNAL int mg_project_start(mg_context *c);
MG_INTERNAL int mg_project_start_joints(mg_context *c);

/* event_margins.c */
MG_INTERNAL int mg_count_margins(const mg_system *s);
MG_INTERNAL long mg_margin_memory(const mg_system *s);
MG_INTERNAL mg_event_margin *mg_margins_at(const mg_context *c, int sample);
MG_INTERNAL void mg_sample_margins(mg_context *c, int sample);
MG_INTERNAL void mg_begin_margins(mg_context *c);
MG_INTERNAL void mg_sample_stage_margins(mg_context *c, int stage);
MG_INTERNAL mg_real mg_lower_bound_between(const mg_margin_sample *p, mg_real *theta);
MG_INTERNAL void mg_four_margin_samples(const mg_context *c, int which, int end, int n, mg_real part,
                                        mg_margin_sample *p);
MG_INTERNAL int mg_is_margin_steady(const mg_context *c, int which);

/* diagnostics.c */
MG_INTERNAL mg_real mg_energy(mg_context *c, mg_real *kinetic);
MG_INTERNAL void mg_update_diagnostics(mg_context *c);
MG_INTERNAL int mg_check_margins(mg_context *c, mg_events *events);

#endif
