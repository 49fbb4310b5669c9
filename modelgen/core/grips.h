/* What the files of friction and resistance share. */
#ifndef MG_GRIPS_H
#define MG_GRIPS_H

#define MG_BELOW 5 /* most rows of a contact below its normal one */
enum { MG_KNOWN = 0, MG_STATIC = 1, MG_KINETIC = 2 }; /* what bounds a grip: its slip, or a cone */

/* grips.c, slip.c, oblique.c */
MG_INTERNAL int mg_grip_row(const mg_context *c, int contact, int grip);
MG_INTERNAL int mg_grip_rows(const mg_context *c, int grip);
MG_INTERNAL int mg_contact_of(const mg_context *c, int grip);
MG_INTERNAL mg_real mg_slip_rest(const mg_context *c, int grip);
MG_INTERNAL mg_real mg_slip_along(const mg_context *c, int contact, int grip, mg_real *slip);
MG_INTERNAL void mg_take_rows(mg_context *c, int contact);
MG_INTERNAL void mg_scatter(mg_context *c, int contact);
MG_INTERNAL void mg_turn_to_axes(mg_context *c, int contact, int grip);
MG_INTERNAL void mg_slip_rates(mg_context *c);
MG_INTERNAL int mg_list_stuck(const mg_context *c, int *list, int n);
MG_INTERNAL mg_real mg_product(const mg_context *c, int row, int column);
MG_INTERNAL void mg_lean_all(mg_context *c);
MG_INTERNAL void mg_lean_columns(mg_context *c, const int *list, int n);
MG_INTERNAL void mg_hold_leaning(mg_context *c, int n, mg_real *amount);
MG_INTERNAL void mg_add_slipping(mg_context *c);
MG_INTERNAL mg_real mg_slipping_power(const mg_context *c);
MG_INTERNAL int mg_oblique_rank(mg_context *c, const int *list, int n);
MG_INTERNAL void mg_oblique_solve(mg_context *c, const int *list, int n, mg_real *z);

/* cones.c */
MG_INTERNAL void mg_bound_all(mg_context *c);
MG_INTERNAL int mg_cone_at(int aspect);
MG_INTERNAL void mg_put_bound(const mg_context *c, int grip, const mg_real *mu, mg_real part, mg_real *cone);
MG_INTERNAL void mg_put_cone(const mg_context *c, int contact, mg_real part, mg_real *cone);
MG_INTERNAL int mg_put_contact(mg_context *c, int contact, int k, int size);

/* fading.c, choice.c, strike.c: events of grips, their modes, impacts */
MG_INTERNAL mg_real mg_grip_strain(const mg_context *c, int contact, int grip);
MG_INTERNAL mg_real mg_grip_value(const mg_context *c, int contact, int grip);
MG_INTERNAL mg_real mg_slip_size(const mg_context *c, int contact, int grip);
MG_INTERNAL void mg_set_on_course(mg_context *c, int contact, int grip);
MG_INTERNAL int mg_aim(mg_context *c, int contact, int grip);
MG_INTERNAL void mg_slip_lean(mg_context *c, int contact, int grip);
MG_INTERNAL mg_real mg_stage_weight(int row, int column);
MG_INTERNAL int mg_grips_fired(mg_context *c);
MG_INTERNAL int mg_first_slipped(const mg_context *c);
MG_INTERNAL int mg_grips_suspect(const mg_context *c);
MG_INTERNAL void mg_aim_all(mg_context *c);
MG_INTERNAL int mg_starts_slipping(const mg_context *c);
MG_INTERNAL void mg_slip_on(mg_context *c);
MG_INTERNAL void mg_steered(const mg_context *c, int contact, int grip, mg_real angle, mg_real *along);
MG_INTERNAL mg_real mg_start_slipping(mg_context *c, mg_real t, const mg_real *x, mg_real h);
MG_INTERNAL int mg_triangle(int n, mg_real *A, mg_real *y, int *order, mg_real floor);
MG_INTERNAL void mg_solve_triangle(int n, int rank, mg_real *R, const mg_real *y, mg_real *z, mg_real *beta);
MG_INTERNAL int mg_choose_grips(mg_context *c, const int *skip);
MG_INTERNAL void mg_report_grips(mg_context *c, mg_events *events);
MG_INTERNAL int mg_find_impulses_with_friction(mg_context *c);
MG_INTERNAL void mg_note_gain(mg_context *c, int n);
MG_INTERNAL void mg_forget_slip(mg_context *c);

MG_INTERNAL int mg_activate_pads(mg_context *c);

/* what they take from impact.c, project.c, start_rolling.c, transitions.c */
MG_INTERNAL mg_real mg_rebound(const mg_context *c, int contact);
MG_INTERNAL int mg_nearing(const mg_context *c, int contact);
MG_INTERNAL void mg_rate_pads(mg_context *c);
MG_INTERNAL void mg_emit(const mg_context *c, mg_events *events, mg_real t, int kind, int contact, mg_real speed);
MG_INTERNAL int mg_correction(mg_context *c, const int *marked, const mg_real *value);
MG_INTERNAL void mg_push(mg_context *c);
MG_INTERNAL mg_real mg_differs_half_way(mg_context *c, const mg_real *x, const mg_real *half);

#include "timestep.h"

#endif
