/* The functions that each file of the core offers the others. */
#ifndef MG_FUNCTIONS_H
#define MG_FUNCTIONS_H

/* context.c */
MG_INTERNAL void mg_open(mg_context *c, const mg_system *sys, const mg_settings *set, mg_run *run, mg_real *work, int *iwork);
MG_INTERNAL void mg_set_fixed(mg_context *c);

static const int mg_carried[] = {0, 3, 2, 1, 3, 1, 1}; /* entries of eta by carrier */

/* links.c */
MG_INTERNAL int mg_present(const mg_context *c, int contact);
MG_INTERNAL void mg_stand(mg_context *c, int contact, int link);
MG_INTERNAL void mg_eta_scale(const mg_context *c, int link, mg_real *scale);
MG_INTERNAL int mg_is_endless(const mg_context *c, int link);
MG_INTERNAL int mg_first_contact(const mg_context *c, int pair);
MG_INTERNAL int mg_has_own_links(const mg_context *c, int pair);
MG_INTERNAL mg_real *mg_eta_of(const mg_context *c, mg_real *x, int contact);
MG_INTERNAL const mg_real *mg_parameters_of(mg_context *c, int contact);
MG_INTERNAL void mg_take_link(mg_context *c, int contact);
MG_INTERNAL void mg_set_link(mg_context *c, int contact, int link, const mg_real *eta);

/* conditions.c */
MG_INTERNAL const mg_real *mg_side(const mg_context *c, int link, int side);
MG_INTERNAL int mg_side_body(const mg_context *c, int link, int side);
MG_INTERNAL int mg_carrier(const mg_context *c, int link, int side);
MG_INTERNAL void mg_unturn(const mg_real *R, const mg_real *x, mg_real *out);
MG_INTERNAL void mg_point_in(const mg_context *c, int link, int side, const mg_real *world, mg_real *local);
MG_INTERNAL mg_real mg_dot3(const mg_real *a, const mg_real *b);
MG_INTERNAL mg_real mg_sine(const mg_real *a, const mg_real *b);
MG_INTERNAL mg_real mg_condition(const mg_context *c, int link, int k, const mg_real *eta);
MG_INTERNAL mg_real mg_least_condition(const mg_context *c, int link, const mg_real *eta, int watched, int *which);
MG_INTERNAL mg_real mg_worst_condition(const mg_context *c, int link, const mg_real *eta, int *which);

/* sample.c */
MG_INTERNAL void mg_out(const mg_real *pose, const mg_real *x, int is_point, mg_real *out);
MG_INTERNAL mg_real mg_reach_of(mg_context *c, int link);
MG_INTERNAL void mg_window(mg_context *c, int link, int side, mg_real reach, mg_real *window);
MG_INTERNAL int mg_dimension(const mg_context *c, int link, int side);
MG_INTERNAL void mg_sample_at(mg_context *c, int link, int side, const mg_real *uv, mg_sample *at);
MG_INTERNAL int mg_sample_side(mg_context *c, int link, int side, const mg_real *window, int n, mg_sample *out);
MG_INTERNAL void mg_zoom(mg_real *window, const mg_real *centre);

/* starts.c */
MG_INTERNAL void mg_start_eta(const mg_context *c, int link, const mg_sample *o, const mg_sample *f, mg_real *eta);
MG_INTERNAL void mg_find_starts(mg_context *c, int link, int n, int zooms, mg_starts *kept);

/* clearance.c */
MG_INTERNAL mg_real mg_pair_clearance(const mg_context *c, int pair);
MG_INTERNAL mg_motion mg_pair_motion(const mg_context *c, int pair);
MG_INTERNAL int mg_is_far(const mg_context *c, int link);

/* search.c, walk.c */
MG_INTERNAL int mg_probe(mg_context *c, int link);
MG_INTERNAL int mg_has_signs(const mg_context *c, int link);
MG_INTERNAL int mg_is_bare(const mg_context *c, int link);
MG_INTERNAL void mg_turn_round(const mg_context *c, int link, mg_real *eta);
MG_INTERNAL void mg_note_place(const mg_context *c, mg_found *found);
MG_INTERNAL int mg_same_contact(const mg_context *c, const mg_found *a, const mg_found *b);
MG_INTERNAL mg_real mg_parting(mg_context *c, int pair);
MG_INTERNAL int mg_judge(mg_context *c, int link, mg_real *eta, mg_found *found);
MG_INTERNAL void mg_keep(const mg_context *c, mg_founds *kept, const mg_found *found);
MG_INTERNAL void mg_search_link(mg_context *c, int link, int n, int zooms, mg_real least, mg_founds *kept);
MG_INTERNAL int mg_is_followed(mg_context *c, int pair, int contact, const mg_found *found);
MG_INTERNAL int mg_slot_for(const mg_context *c, int pair, const mg_found *found);
MG_INTERNAL int mg_is_taken_up(const mg_context *c, const mg_found *found);
MG_INTERNAL int mg_start_pairs(mg_context *c);
MG_INTERNAL int mg_walk_all(mg_context *c, mg_events *events);
MG_INTERNAL int mg_search_pair(mg_context *c, mg_events *events, int pair);
MG_INTERNAL int mg_search_all(mg_context *c, mg_events *events, mg_real h);

MG_INTERNAL void mg_leave(mg_context *c, mg_events *events, int contact);
MG_INTERNAL mg_real mg_step_over(mg_context *c, int from, int to, const mg_real *at, mg_real *eta, int *which);

/* bodies.c */
MG_INTERNAL int mg_moves(const mg_context *c, int body);
MG_INTERNAL int mg_kind_of(const mg_context *c, int body);
MG_INTERNAL void mg_wrench(const mg_context *c, mg_real t, int load, mg_real *wrench);
MG_INTERNAL void mg_copy_u(const mg_context *c, int body, const mg_real *from, mg_real *to);
MG_INTERNAL void mg_poses(mg_context *c, mg_real t, const mg_real *x);
MG_INTERNAL void mg_accelerations(mg_context *c, mg_real t, const mg_real *x, mg_real *x_dot);
MG_INTERNAL void mg_normalise(const mg_context *c, mg_real *x);

/* contacts.c */
MG_INTERNAL void mg_rates(mg_context *c, const mg_real *x);
MG_INTERNAL void mg_gap_rates(mg_context *c);
MG_INTERNAL mg_real mg_driven_rate(const mg_context *c, int contact);
MG_INTERNAL mg_real mg_row(const mg_context *c, int contact, const mg_real *per_body);
MG_INTERNAL mg_real mg_weigh(mg_context *c, int contact);
MG_INTERNAL void mg_add(mg_context *c, int contact, mg_real amount, mg_real *per_body);
MG_INTERNAL void mg_assemble(mg_context *c, const int *list, int n);

/* islands.c */
MG_INTERNAL int mg_hold(mg_context *c, const int *marked, const mg_real *rate, mg_real *amount);

/* joints.c, ranks.c, reduce.c */
MG_INTERNAL void mg_open_joints(mg_context *c);
MG_INTERNAL void mg_joint_rates(mg_context *c, mg_real t);
MG_INTERNAL int mg_joint_of(const mg_context *c, int row);
MG_INTERNAL int mg_worst_joint(const mg_context *c, const mg_real *value, mg_real *size);
MG_INTERNAL int mg_list_joints(const mg_context *c, int *list, int n);
MG_INTERNAL int mg_rank_joints(mg_context *c, int *rank);
MG_INTERNAL void mg_watch_joints(mg_context *c);
MG_INTERNAL int mg_list_bilateral(const mg_context *c, int *list, int n);
MG_INTERNAL int mg_complement(mg_context *c, int n, const mg_real *value, mg_lcp_report *report);

/* rhs.c */
MG_INTERNAL int mg_a_path_ends(const mg_context *c);
MG_INTERNAL void mg_rhs(mg_context *c, mg_real t, const mg_real *x, mg_real *x_dot);
MG_INTERNAL mg_real mg_separation(const mg_context *c, int contact);

/* place.c */
MG_INTERNAL int mg_place(mg_context *c, int contact, const mg_real *eta, mg_real *eta_next);
MG_INTERNAL int mg_settle_in(mg_context *c, int contact, mg_real *eta);
MG_INTERNAL mg_real mg_margin_of(const mg_context *c);
MG_INTERNAL int mg_place_all(mg_context *c, mg_real t, mg_real *x);

/* seek.c, closest.c, safeguard.c */
MG_INTERNAL int mg_unit(mg_real *n);
MG_INTERNAL int mg_seek(const mg_couple *p, mg_real floor, int keep, mg_view *v);
MG_INTERNAL void mg_put(const mg_couple *p, const mg_real *eta, mg_real *next, mg_real *placed);
MG_INTERNAL int mg_is_small(const mg_couple *p, const mg_goal *goal, const mg_real *placed);
MG_INTERNAL int mg_newton_safely(const mg_couple *p, const mg_goal *goal, mg_real *eta, mg_real *placed);
MG_INTERNAL int mg_is_minimum(const mg_real *placed);
MG_INTERNAL int mg_closest_convex(const mg_couple *p, const mg_goal *goal, int warm, mg_real *eta, mg_real *placed);
MG_INTERNAL void mg_eta_reach(const mg_context *c, int link, mg_real *reach);
MG_INTERNAL int mg_settle_safely(mg_context *c, int link, mg_real *eta);

/* advance.c */
MG_INTERNAL mg_real mg_growth(mg_real error, mg_real most);
MG_INTERNAL void mg_pass_time(mg_run *run, mg_real h);
MG_INTERNAL int mg_finite(const mg_real *x, int n);

/* unbounded.c, and timestep_fallback.c for it */
MG_INTERNAL int mg_verdict(mg_context *c, int outcome);
MG_INTERNAL int mg_is_closed_to_events(int outcome);

/* instants.c */
MG_INTERNAL int mg_is_driven(const mg_system *s, int body);
MG_INTERNAL int mg_count_timed(const mg_system *s);
MG_INTERNAL int mg_count_felt(const mg_system *s, int timed);
MG_INTERNAL long mg_instant_size(const mg_system *s);
MG_INTERNAL mg_real mg_seen_in_time(mg_context *c, mg_real h);
MG_INTERNAL int mg_hides_on_way(mg_context *c, mg_real h);

/* modes.c, advance.c, instants.c, for jerks.c */
MG_INTERNAL void mg_open_far(mg_context *c, mg_events *events);
MG_INTERNAL int mg_change_mode(mg_context *c, mg_events *events);
MG_INTERNAL int mg_is_driven(const mg_system *s, int body);

/* jerks.c */
MG_INTERNAL mg_real mg_at_once(const mg_context *c);
MG_INTERNAL int mg_find_jerk(const mg_context *c, mg_real h, mg_real *before, mg_real *after);
MG_INTERNAL int mg_take_jerk(mg_context *c, mg_real after, mg_events *events);

/* vault.c */
MG_INTERNAL int mg_vault_all(mg_context *c, mg_record *record, mg_events *events);

/* rk4.c, dop853.c, step.c */
MG_INTERNAL void mg_rk4(mg_context *c, mg_real t, const mg_real *x, mg_real h);
MG_INTERNAL mg_real mg_dop853(mg_context *c, mg_real t, const mg_real *x, mg_real h);
MG_INTERNAL void mg_dop853_dense(mg_context *c, mg_real t, const mg_real *x, mg_real h);
MG_INTERNAL void mg_watch(mg_context *c);
MG_INTERNAL int mg_is_collocated(const mg_context *c);
MG_INTERNAL int mg_fired_at(mg_context *c, mg_real h, mg_real theta);
MG_INTERNAL mg_real mg_try_step(mg_context *c, mg_real t, const mg_real *x, mg_real h);
MG_INTERNAL mg_real mg_take_step(mg_context *c, mg_real t, const mg_real *x, mg_real h);
MG_INTERNAL void mg_finish_step(mg_context *c, mg_real t, mg_real h);
MG_INTERNAL void mg_make_cubic(mg_context *c, const mg_real *x, mg_real h);
MG_INTERNAL void mg_make_dense(mg_context *c, mg_real t, const mg_real *x, mg_real h);
MG_INTERNAL void mg_interpolate(const mg_context *c, const mg_real *x, mg_real theta, mg_real *out);

/* reach.c */
MG_INTERNAL mg_real mg_reach(const mg_context *c);
MG_INTERNAL mg_real mg_sight(const mg_context *c);
MG_INTERNAL void mg_note_gaps(mg_context *c);
MG_INTERNAL void mg_mark_upright(mg_context *c);
enum { MG_DIPS = 1, MG_WAVES = 2 };
MG_INTERNAL int mg_mark_dips(mg_context *c, mg_real h);

/* strain.c */
enum { MG_STRAINS = 7 }; /* samples of a step */
MG_INTERNAL int mg_count_strains(const mg_system *s);
MG_INTERNAL long mg_strain_size(const mg_system *s);
MG_INTERNAL mg_strain *mg_strain_at(const mg_context *c, int sample);
MG_INTERNAL void mg_take_strain(mg_context *c, int sample);
MG_INTERNAL void mg_begin_strain(mg_context *c);
MG_INTERNAL void mg_strain_stage(mg_context *c, int stage);
MG_INTERNAL int mg_may_strain(mg_context *c);
MG_INTERNAL mg_real mg_first_strain(mg_context *c, mg_real h, int end, int n, mg_real part, mg_real *low);

/* transitions.c: what may befall a contact */
enum { MG_STRIKES, MG_MISSES, MG_IS_CAUGHT, MG_REBOUNDS, MG_IS_PUSHED_OFF, MG_LIFTS, MG_APPEARS, MG_WALKS_ON, MG_VANISHES,
       MG_ENDS_RUN, MG_RESTS, MG_TURNS_OVER };
MG_INTERNAL void mg_befalls(mg_context *c, mg_events *events, int contact, int cause, mg_real t, mg_real speed);

/* events.c, modes.c, impact.c, project.c, ledger.c, record.c */
MG_INTERNAL void mg_forget_events(mg_context *c);
MG_INTERNAL int mg_fired(mg_context *c, mg_real *x);
MG_INTERNAL mg_real mg_locate(mg_context *c, mg_real h, int passed);
MG_INTERNAL mg_real mg_slack(const mg_context *c);
MG_INTERNAL int mg_approaching(const mg_context *c, int contact);
MG_INTERNAL mg_real mg_bounces_left(mg_context *c, int contact);
MG_INTERNAL int mg_impact(mg_context *c, mg_events *events);
MG_INTERNAL int mg_takes_turns(const mg_context *c);
MG_INTERNAL int mg_strike_in_turn(mg_context *c, mg_events *events);
MG_INTERNAL int mg_choose_active(mg_context *c, const int *skip);
MG_INTERNAL int mg_solve_modes(mg_context *c, mg_events *events);
MG_INTERNAL int mg_has_room(const mg_context *c);
MG_INTERNAL int mg_transition(mg_context *c, mg_events *events);
MG_INTERNAL int mg_unsettled(mg_context *c);
MG_INTERNAL void mg_refresh(mg_context *c);
MG_INTERNAL mg_real mg_largest(const mg_context *c, const mg_real *value);
MG_INTERNAL void mg_turn(mg_real *e, const mg_real *angle);
MG_INTERNAL int mg_project(mg_context *c);
MG_INTERNAL int mg_project_start(mg_context *c);
MG_INTERNAL int mg_start_joints(mg_context *c);
MG_INTERNAL mg_real mg_energy(mg_context *c, mg_real *kinetic);
MG_INTERNAL void mg_ledger(mg_context *c);
MG_INTERNAL void mg_record_until(mg_context *c, mg_record *record, mg_real h);
MG_INTERNAL void mg_record_now(mg_context *c, mg_record *record);

/* shared by files besides those above */
MG_INTERNAL void mg_apply_impulses(mg_context *c, int n);
MG_INTERNAL int mg_check_margins(mg_context *c, mg_events *events);
MG_INTERNAL mg_real mg_dot6(const mg_real *a, const mg_real *b);
MG_INTERNAL mg_real mg_driven_power(const mg_context *c);
MG_INTERNAL int mg_due(const mg_record *record, mg_real t);
MG_INTERNAL mg_real mg_first_step(const mg_context *c);
MG_INTERNAL int mg_gives_way_to_others(mg_context *c, mg_events *events, int contact);
MG_INTERNAL int mg_leaves(mg_context *c, int contact, mg_real *x);
MG_INTERNAL int mg_loosen_giving(mg_context *c);
MG_INTERNAL void mg_merge(mg_context *c, mg_events *events);
MG_INTERNAL void mg_record_row(mg_context *c, mg_record *record, mg_real *x);
MG_INTERNAL int mg_rows_below(const mg_context *c, int row);
MG_INTERNAL void mg_search_beside(mg_context *c, int contact, const mg_real *eta, mg_real margin, mg_founds *kept);
MG_INTERNAL mg_real mg_slip_scale(const mg_context *c, int grip);
MG_INTERNAL void mg_touch_at_all(mg_context *c, mg_events *events, int contact);
MG_INTERNAL void mg_turn_pair(mg_real cosine, mg_real sine, mg_real *a, mg_real *b);

#endif
