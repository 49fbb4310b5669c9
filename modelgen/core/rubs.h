/* What the files on patches with friction offer the others. */
#ifndef MG_RUBS_H
#define MG_RUBS_H

#include "core.h"

enum { MG_RUB_ROWS = 3 }; /* below the first pad's normal row: slip of its point along t1, t2, spin about N */

struct mg_rub_state { /* a patch with friction in a slot */
  int leans;                 /* it slips */
  int known, cut, clipped;   /* of the pressure: `centre` is known; it leaves part of the face alone; the force is beyond it */
  mg_real centre[2], extent; /* of pressure, axes of the hull; m, of what is pressed about it */
  mg_real spread, spread_at[2]; /* m, mean distance of the pressure from that centre, its own; 0: not known */
  mg_real lean[MG_RUB_ROWS][3]; /* force along a row by that on a pad, with the sign changed */
  int fired, before, stopped; /* its event has fired; its mode before; slip has died */
  mg_real over;              /* s, slip that was stopped had left */
  mg_real steer[2];          /* while slip begins: its direction is the course and so much of each across it */
};

typedef struct { /* rows and axes of a hull: t1, t2 and the pads in it, N along its z or against */
  mg_real pose[12], t[2][2], pad[3][2], sign;
} mg_rub_frame;

/* rubs.c */
MG_INTERNAL int mg_has_rubbing(const mg_context *c, int patch);
MG_INTERNAL int mg_rubs(const mg_context *c, int slot);
MG_INTERNAL int mg_rub_row(const mg_context *c, int slot);
MG_INTERNAL int mg_rub_leans(const mg_context *c, int row);
MG_INTERNAL mg_real mg_rub_radius(const mg_context *c, int slot);
MG_INTERNAL void mg_rub_axes(const mg_context *c, int slot, mg_rub_frame *at);
MG_INTERNAL mg_real mg_rub_along(const mg_context *c, int slot);
MG_INTERNAL void mg_across(const mg_real *e, mg_real across[2][3]);
MG_INTERNAL void mg_rub_basis(const mg_context *c, int slot, mg_real e[3][3]);
MG_INTERNAL void mg_set_rub_course(mg_context *c, int slot, const mg_real *twist);
MG_INTERNAL void mg_begin_rubs(mg_context *c);
MG_INTERNAL void mg_press_rub(mg_context *c, int slot);
MG_INTERNAL int mg_rubs_unsettled(mg_context *c);
MG_INTERNAL void mg_lean_pads(mg_context *c, const int *list, int n);
MG_INTERNAL void mg_add_rubs(mg_context *c);
MG_INTERNAL int mg_list_stuck_rubs(const mg_context *c, int *list, int n);

/* eliminate.c */
MG_INTERNAL int mg_friction_held(mg_context *c, const mg_friction_problem *p, mg_real *z, mg_friction_report *report);

/* rub_modes.c */
MG_INTERNAL mg_real mg_rub_left(mg_context *c, int slot, mg_real *twist);
MG_INTERNAL mg_real mg_rub_value(mg_context *c, int slot, int cause);
MG_INTERNAL int mg_rub_fires(mg_context *c, int slot);
MG_INTERNAL void mg_aim_rubs(mg_context *c);
MG_INTERNAL void mg_forget_rubs(mg_context *c);
MG_INTERNAL int mg_choose_rubs(mg_context *c, const int *skip);
MG_INTERNAL void mg_report_rubs(mg_context *c, mg_events *events);

#endif
