/* What a run tells of itself: counts, largest values and first places. This file alone writes the report, but for the
   restart from a checkpoint; no body moves by it. */
#include "model/model.h"

MG_INTERNAL void mg_reset_report(mg_run *run) {
  static const mg_run_report fresh = {0};
  mg_run_report *report = &run->report;
  *report = fresh;
  report->penetration_t = run->t;
  report->margin_min = report->joint_margin_min = MG_MAX;
  report->failed_contact = report->failed_joint = report->joint_margin = report->dead_centre = -1;
  report->rank_min = -1;
  report->impact_gain_contact = report->chain_impact_contact = report->painleve_contact = -1;
  report->passage_contact = report->penetration_contact = report->flush_contact = -1;
  report->unfollowed_pair = report->incomplete_pair = -1;
  report->spin_body = report->spring_rate_load = report->overlapping_patch = -1;
  report->indeterminate_contact = report->indeterminate_switch = report->shared_switch = report->exceeded_pool = -1;
}

/* Raises a maximum. */
static void mg_raise(mg_real *largest, mg_real value) {
  if (value > *largest) *largest = value;
}

MG_INTERNAL void mg_report_start_energy(mg_run *run, mg_real energy) { run->report.energy_0 = energy; }

MG_INTERNAL void mg_report_energy(mg_run *run, mg_real energy, mg_real kinetic, mg_real work) {
  mg_raise(&run->report.energy_error_max, fabs(energy - run->report.energy_0 - work - run->report.correction_work));
  mg_raise(&run->report.kinetic_max, kinetic);
}

MG_INTERNAL void mg_report_correction(mg_run *run, mg_real change) {
  run->report.correction_work += change, run->report.correction_energy += fabs(change);
}

MG_INTERNAL void mg_report_impact_gain(mg_run *run, int contact, mg_real t, mg_real gain) {
  if (!(gain > run->report.impact_gain_max)) return;
  run->report.impact_gain_max = gain, run->report.impact_gain_t = t, run->report.impact_gain_contact = contact;
}

MG_INTERNAL void mg_report_chain_impact(mg_run *run, int contact) {
  if (run->report.chain_impact_contact >= 0) return;
  run->report.chain_impact_contact = contact, run->report.chain_impact_t = run->t;
}

MG_INTERNAL void mg_report_gap(mg_run *run, mg_real gap) { mg_raise(&run->report.gap_max, fabs(gap)); }

MG_INTERNAL void mg_report_complementarity(mg_run *run, mg_real gap, mg_real force) {
  mg_raise(&run->report.complementarity_max, fabs(gap < force ? gap : force));
}

MG_INTERNAL void mg_report_margin(mg_run *run, mg_real margin) {
  if (!(margin >= run->report.margin_min)) run->report.margin_min = margin;
}

MG_INTERNAL void mg_report_penetration(mg_run *run, int contact, mg_real depth) {
  if (!(depth > run->report.penetration_max)) return;
  run->report.penetration_max = depth, run->report.penetration_t = run->t, run->report.penetration_contact = contact;
}

MG_INTERNAL void mg_report_failed_contact(mg_run *run, int contact) { run->report.failed_contact = contact; }

MG_INTERNAL void mg_report_qp_solve(mg_run *run) { run->report.qp_solves++; }

MG_INTERNAL void mg_report_friction_solve(mg_run *run, int law) {
  (law == MG_RELAXED ? run->report.relaxed_solves++ : run->report.friction_solves++);
}

MG_INTERNAL void mg_report_outer_solve(mg_run *run) { run->report.outer_solves++; }

MG_INTERNAL void mg_report_residual(mg_run *run, mg_real residual) {
  mg_raise(&run->report.lcp_residual_max, residual);
}

MG_INTERNAL void mg_report_redundancy(mg_run *run, int redundant) {
  if (redundant > run->report.redundant_max) run->report.redundant_max = redundant;
}

MG_INTERNAL void mg_report_loose_solution(mg_run *run) { run->report.loose_solutions++; }

MG_INTERNAL void mg_report_relaxed_solution(mg_run *run) { run->report.relaxed_solutions++; }

MG_INTERNAL void mg_report_force_rounding(mg_run *run, mg_real rounding) {
  run->report.force_rounding = mg_max(run->report.force_rounding, rounding);
}

MG_INTERNAL void mg_report_passage(mg_run *run, int contact) {
  if (!run->report.singular_passages++) run->report.passage_contact = contact;
}

MG_INTERNAL void mg_report_slip_stop(mg_run *run) { run->report.slip_stops++; }

MG_INTERNAL void mg_report_unfollowed_pair(mg_run *run, int pair) {
  if (run->report.unfollowed_minima++) return;
  run->report.unfollowed_t = run->t, run->report.unfollowed_pair = pair;
}

MG_INTERNAL void mg_report_incomplete_pair(mg_run *run, int pair) {
  if (run->report.incomplete_searches++) return;
  run->report.incomplete_t = run->t, run->report.incomplete_pair = pair;
}

MG_INTERNAL void mg_withdraw_incomplete_searches(mg_run *run, long count) { run->report.incomplete_searches -= count; }

MG_INTERNAL void mg_report_exceeded(mg_run *run, int capacity) {
  if (!run->report.exceeded[capacity]++) run->report.exceeded_t[capacity] = run->t;
}

MG_INTERNAL void mg_report_too_many_near(mg_run *run, int pool) {
  mg_report_exceeded(run, MG_CAPACITY_NEAR);
  if (run->report.exceeded_pool < 0) run->report.exceeded_pool = pool;
}

MG_INTERNAL int mg_are_too_many_near(const mg_run *run) { return run->report.exceeded[MG_CAPACITY_NEAR] > 0; }

MG_INTERNAL void mg_report_start_of_joints(mg_run *run, int joint, mg_real error) {
  run->report.failed_joint = joint, run->report.joint_error_max = error;
}

MG_INTERNAL void mg_report_start_speed_of_joints(mg_run *run, int joint, mg_real speed) {
  run->report.failed_joint = joint, run->report.joint_speed = speed;
}

MG_INTERNAL void mg_report_joints(mg_run *run, mg_real error, int rank) {
  mg_run_report *report = &run->report;
  mg_raise(&report->joint_error_max, error);
  if (report->rank_min < 0 || rank < report->rank_min) report->rank_min = rank;
  if (rank > report->rank_max) report->rank_max = rank;
}

MG_INTERNAL void mg_report_dead_centre(mg_run *run, int joint) {
  if (!run->report.dead_centres++) run->report.dead_centre_t = run->t, run->report.dead_centre = joint;
}

MG_INTERNAL void mg_report_joint_margin(mg_run *run, int joint, mg_real margin) {
  if (!(margin < run->report.joint_margin_min)) return;
  run->report.joint_margin_min = margin, run->report.joint_margin = joint, run->report.joint_margin_t = run->t;
}

MG_INTERNAL void mg_report_fallback(mg_run *run, int outcome) {
  mg_run_report *report = &run->report;
  if (outcome == MG_CHATTER) {
    if (!report->chatters++) report->chatter_first = run->t;
    return;
  }
  if (!report->fallbacks++) report->fallback_first = run->t, report->fallback_cause = outcome;
  report->jams += outcome == MG_NO_FRICTION || outcome == MG_COMPLEMENTARITY;
}

MG_INTERNAL void mg_report_fallback_time(mg_run *run, mg_real h) {
  *(run->present_cause == MG_CHATTER ? &run->report.chatter_time : &run->report.fallback_time) += h;
}

MG_INTERNAL void mg_report_spin(mg_run *run, int body, mg_real square) {
  if (!(square > run->report.spin_max * run->report.spin_max)) return;
  run->report.spin_max = sqrt(square), run->report.spin_body = body;
}

MG_INTERNAL void mg_report_spring_rate(mg_run *run, int load, mg_real rate) {
  if (!(rate > run->report.spring_rate_max)) return;
  run->report.spring_rate_max = rate, run->report.spring_rate_load = load;
}

MG_INTERNAL void mg_report_indeterminate(mg_run *run, int load_switch) {
  if (run->report.indeterminate) return;
  run->report.indeterminate = 1, run->report.indeterminate_t = run->t, run->report.indeterminate_switch = load_switch;
}

MG_INTERNAL void mg_report_other_motion(mg_run *run, int contact, mg_real part) {
  if (run->report.indeterminate) return;
  mg_report_indeterminate(run, -1);
  run->report.indeterminate_contact = contact, run->report.indeterminate_part = part;
}

MG_INTERNAL void mg_report_painleve_paradox(mg_run *run, int contact) {
  if (run->report.painleve_contact >= 0) return;
  run->report.painleve_contact = contact, run->report.painleve_t = run->t;
  mg_report_indeterminate(run, -1);
}

MG_INTERNAL void mg_report_shared_switch(mg_run *run, int load_switch) {
  if (run->report.shared_switch < 0) run->report.shared_switch = load_switch;
}

MG_INTERNAL void mg_report_flush_blow(mg_run *run, int contact) {
  run->report.flush_contact = contact, run->report.flush_t = run->t;
}

MG_INTERNAL void mg_report_overlapping_patch(mg_run *run, int patch) { run->report.overlapping_patch = patch; }
