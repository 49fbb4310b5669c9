/* Public queries of all minima of the distance of a pair of bodies at given poses, without a run (mg_find_minima). */
#include "run/run.h"
#include "model/model.h"
#include "closest/closest.h"

/* Searches the feature pairs at the poses set. Returns 1 if minima may have been dropped for lack of room. */
static int mg_search_query(mg_context *c, const mg_minima_queries *q, mg_minima *found) {
  const int pair = c->system->feature_pair_owner[q->first], is_whole = c->system->pair_feature_pair[pair] == q->first &&
                                                                       c->system->pair_feature_pair[pair + 1] == q->end;
  const mg_real least =
      is_whole ? mg_separating_plane_gap(c, pair) - c->settings->start_gap * c->system->length : -MG_MAX;
  const mg_search_limits limits = {q->gap, q->depth, q->effort, MG_MAX};
  if (q->is_nearest) {
    mg_search_nearest(c, q->first, q->end, least, q->effort, found);
    return 0;
  }
  for (int each = q->first; each < q->end; each++) mg_search_feature_pair(c, each, &limits, least, found);
  const int is_full = found->count == MG_MINIMA;
  int kept = 0;
  for (int k = 0; k < found->count; k++)
    if (found->list[k].d >= -q->depth && found->list[k].d <= q->gap) found->list[kept++] = found->list[k];
  found->count = kept;
  return is_full;
}

/* Writes one minimum to row `row` of the results, seen from body_o. */
static void mg_write_minimum(mg_context *c, const mg_minima_queries *q, const mg_minimum *at, long row) {
  mg_real next[6];
  mg_place_contact(c, mg_use_probe_contact(c, at->feature_pair), at->eta, next);
  const mg_real *placed = c->search.placement;
  const int turned = mg_feature_body(c, at->feature_pair, 0) != q->body_o;
  const int n_eta = c->kernels->contact_kinds[c->system->feature_pair_kind[at->feature_pair]].n_eta;
  q->feature_pair[row] = at->feature_pair, q->d[row] = at->d;
  q->margin[2 * row] = placed[3], q->margin[2 * row + 1] = placed[4];
  for (int k = 0; k < 3; k++) {
    q->normal[3 * row + k] = turned ? -placed[5 + k] : placed[5 + k];
    q->point_o[3 * row + k] = placed[(turned ? 11 : 8) + k];
    q->point_f[3 * row + k] = placed[(turned ? 8 : 11) + k];
  }
  for (int k = 0; k < 6; k++) q->eta[6 * row + k] = k < n_eta ? at->eta[k] : 0;
}

/* True if the nearest points of the bodies are on the feature pairs: no pair is made of two vertices, or of a vertex
   and an edge. */
static int mg_has_all_features(const mg_context *c, const mg_minima_queries *q) {
  int least[2] = {2, 2};
  for (int each = q->first; each < q->end; each++)
    for (int side = 0; side < 2; side++) {
      const int is_other = mg_feature_body(c, each, side) != q->body_o, dimension = mg_feature_dimension(c, each, side);
      if (dimension < least[is_other]) least[is_other] = dimension;
    }
  return q->end == q->first + 1 || least[0] + least[1] > 1;
}

MG_API void mg_find_minima(const mg_system *system, const mg_settings *settings, mg_run *run,
                           const mg_minima_queries *queries, mg_real *work, int *iwork) {
  mg_context c;
  const mg_minima_queries *q = queries;
  mg_open_context(&c, system, settings, run, work, iwork);
  mg_update_poses(&c, run->t, run->x);
  const int pair = system->feature_pair_owner[q->first];
  for (long i = 0; i < q->n; i++) {
    mg_minima found = {0};
    q->count[i] = q->is_complete[i] = 0;
    if (mg_is_search_stopped(&c)) continue;
    for (int k = 0; k < 12; k++) {
      c.bodies.pose[12 * q->body_o + k] = q->pose_o[12 * i + k];
      c.bodies.pose[12 * q->body_f + k] = q->pose_f[12 * i + k];
    }
    c.search.incomplete = 0, run->withheld_effort[pair] = 0;
    mg_forget_noted_gaps(&c);
    const int is_full = mg_search_query(&c, q, &found);
    const mg_real within = !q->is_nearest ? q->gap : found.count ? fabs(found.list[0].d) : MG_MAX;
    q->count[i] = found.count;
    q->is_complete[i] = !c.search.incomplete && (c.search.open_gap >= MG_MAX || c.search.open_gap > within) &&
                        (q->is_nearest ? mg_has_all_features(&c, q) : !is_full);
    for (int k = 0; k < found.count; k++) mg_write_minimum(&c, q, found.list + k, i * MG_MINIMA + k);
  }
}
