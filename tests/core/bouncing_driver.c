/* Drops a point mass from 1 m with restitution 0.7 and prints the times of its events, its end and its ledger. */
#include <stdio.h>

#define COUNT 200
#define SIDE (MG_FEATURE_BALL_CENTRE + 3)

int main(void) {
  const int body_kind[] = {0, 1}, zeros[] = {0, 0}, body_parameters[] = {0, 12}, f[] = {1}, link_parameters[] = {13};
  const int ends[] = {0, 1}, sides[] = {0, 1}, side_parameters[] = {13, 13}, side_numbers[] = {0, SIDE};
  const int no_grips[] = {0, 0}, law[] = {MG_NEWTON};
  const int search[] = {MG_SEARCH_NEVER}, groups[] = {-1};
  const mg_real parameters[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, (mg_real)0.1}, restitution[] = {(mg_real)0.7};
  const mg_real pair_normal[3] = {0}, ball[8] = {0, 0, 0, -1, 0, 0, 0, (mg_real)0.1};
  const int candidate[] = {0}, partners[] = {0, 0, 0};
  mg_real numbers[2 * SIDE] = {0}, moved[1], watched[1], unfollowed[1], withheld[1], outward[3], point[3];
  mg_real mass_inverse[20] = {0}, scale[7];
  mg_real x[7] = {0, 0, (mg_real)1.1L, 0, 0, 0, 0}, force[1], margin[1], t[COUNT], speed[COUNT], after[COUNT], blow[1], work[20000];
  mg_real ball_at[8] = {0};
  const int listed[2] = {1, 1};
  int is_far[1] = {0}, due[1] = {0}, closed[1], active[1], fresh[1], struck[2], on[] = {-1}, kind[COUNT], contact[COUNT], told[COUNT], feature_pair[COUNT], iwork[1000];
  static const int no_solids[] = {MG_UNKNOWN_MATERIAL, MG_UNKNOWN_MATERIAL};
  mass_inverse[10] = 1;
  for (int i = 0; i < 7; i++) scale[i] = (mg_real)0.1;
  for (int side = 0; side < 2; side++) {
    mg_real *of = numbers + side * SIDE;
    of[MG_FEATURE_PLACEMENT + 3] = of[MG_FEATURE_PLACEMENT + 7] = of[MG_FEATURE_PLACEMENT + 11] = 1;
    for (int k = 0; k < 4; k++) of[MG_FEATURE_DOMAIN + k] = k % 2 ? MG_MAX : -MG_MAX;
    of[MG_FEATURE_BALL_RADIUS] = MG_MAX;
  }
  mg_system system = {.kernels = &table, .n_body = 2, .n_contact = 1, .n_pair = 1, .n_feature_pair = 1, .n_q = 3, .n_u = 3, .closed_capacity = 1,
                      .body_kind = body_kind, .body_q = zeros, .body_u = zeros, .body_parameters = body_parameters,
                      .contact_pair = zeros, .contact_eta = zeros, .contact_feature_pair = zeros,
                      .pair_contact = ends, .pair_feature_pair = ends, .pair_search = search,
                      .pair_is_candidate = candidate, .ball_solid = no_solids, .pair_balls = ends, .n_ball = 2, .ball_body = ends, .ball_partner_begin = partners,
                      .feature_pair_kind = zeros, .feature_pair_o = zeros, .feature_pair_f = f, .feature_pair_parameters = link_parameters,
                      .feature_pair_owner = zeros, .feature_pair_group = groups, .feature_pair_condition = zeros,
                      .feature_shape = sides, .feature_parameters = side_parameters, .feature_numbers = side_numbers, .feature_is_listed = listed,
                      .contact_friction_row = no_grips, .contact_friction = no_grips, .impact_law = law,
                      .mass_inverse = mass_inverse, .restitution = restitution, .parameters = parameters,
                      .numbers = numbers, .pair_normal = pair_normal, .ball = ball, .scale = scale,
                      .gravity = {0, 0, (mg_real)-9.81L}, .length = (mg_real)0.1, .mass = 1, .time = (mg_real)0.1};
  mg_settings settings = {.method = MG_DOP853, .use_gamma = 1, .newton = 1, .project = 1, .tolerance = (mg_real)1e-10,
                          .contact_gap = (mg_real)1e-10, .start_gap = (mg_real)1e-8, .drift_tolerance = (mg_real)1e-15,
                          .rest_speed = (mg_real)1e-6, .slip_speed = (mg_real)1e-7, .friction_bound_margin = (mg_real)1e-9,
                          .rest_acceleration = (mg_real)1e-10, .event_tolerance = (mg_real)1e-13,
                          .extremality_residual = (mg_real)1e-13, .step_min = (mg_real)1e-13, .margin_refuse = (mg_real)1e-5,
                          .passage_time_max = (mg_real)1e-4, .overlap_clear_gaps = 16, .overlap_clear_part = (mg_real)1e-3,
                          .search_margin = (mg_real)1e-9, .search_merge_distance = (mg_real)1e-6, .search_gap = (mg_real)0.2,
                          .search_movement = (mg_real)0.05, .feature_border = (mg_real)1e-9, .time_resolution = (mg_real)0.02, .step_fraction = 1,
                          .rest_loss_factor = 100, .event_correction_step = (mg_real)1e-3, .contact_rank_tolerance = (mg_real)1e-10,
                          .appear_depth = (mg_real)0.02, .penetration_limit = (mg_real)1e-6, .event_scan_parts = 16,
                          .lcp_iterations = 100, .events_at_once_max = 100};
  mg_run run = {.x = x, .feature_pair = on, .moved_since_search = moved, .is_search_due = due, .watched_movement = watched, .unfollowed_gap = unfollowed, .withheld_effort = withheld, .is_far = is_far, .ball_at = ball_at, .closed = closed, .active = active, .force = force, .margin = margin,
                 .rolling_start = fresh, .point = point, .after_t = blow, .struck_by = struck, .tilt_direction = outward};
  mg_events events = {COUNT, 0, t, kind, contact, told, feature_pair, speed, after};
  mg_record record = {0};
  if (mg_work_size(&system) > 20000 || mg_iwork_size(&system) > 1000) return 1;
  if (mg_begin(&system, &settings, &run, &events, work, iwork)) return 2;
  if (mg_advance(&system, &settings, &run, 3, 10000, &record, &events, work, iwork)) return 3;
  for (int i = 0; i < events.count; i++) printf("%d %.17g\n", kind[i], (double)t[i]);
  printf("end %.17g %.17g %.17g %.17g\n", (double)run.t, (double)x[2], (double)force[0], (double)run.report.energy_error_max);
  return 0;
}
