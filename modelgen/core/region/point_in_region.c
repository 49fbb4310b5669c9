/* Location of a point: the parity of the chords to its right, corrected where the point lies between a chord and
   its curve. */
#include "region/region.h"
#include "base/base.h"

/* 1 if p is between the chord of a span and its curve, -1 if it is on the curve, else 0. */
static int mg_is_between_chord_and_curve(const mg_hull *h, const mg_arc_span *s, const mg_real *p, mg_real cross,
                                         mg_real shared) {
  const mg_placed_arc *k = h->arcs + s->arc;
  const mg_real chord[2] = {s->end[0] - s->begin[0], s->end[1] - s->begin[1]},
                arm[2] = {p[0] - s->begin[0], p[1] - s->begin[1]};
  const mg_real length = sqrt(mg_dot2(chord, chord));
  const mg_real along = mg_dot2(chord, arm) / length, off = cross / length;
  if (fabs(off) > length * s->turn + shared || along < -shared || along > length + shared) return 0;
  if (k->straight) return fabs(off) <= shared ? -1 : 0;
  mg_real nearest[2], T[2];
  mg_arc_point(k, mg_zero_on_arc(k, MG_ZERO_NEAREST, p, s->t_begin, s->t_end), nearest, T);
  if (mg_distance2(nearest, p) <= shared) return -1;
  if (along < 0 || along > length) return 0;
  const mg_real to[2] = {p[0] - nearest[0], p[1] - nearest[1]}, side = mg_cross2(T, to);
  return (side > 0) != (cross > 0);
}

/* True if arc i begins a part of the region that may overlap those before it. */
static int mg_begins_new_part(const mg_region_pair *r, int i) { return r->arc[i].loop > r->arc[i - 1].loop + 1; }

MG_INTERNAL void mg_find_part_of_arc(const mg_hull *h, int arc, int *first, int *end) {
  const mg_region_pair *r = h->regions;
  const int last = h->arcs[arc].side ? r->n_arc : r->n_o;
  *first = arc, *end = arc + 1;
  while (*first > (h->arcs[arc].side ? r->n_o : 0) && !mg_begins_new_part(r, *first)) --*first;
  while (*end < last && !mg_begins_new_part(r, *end)) ++*end;
}

MG_INTERNAL int mg_locate_in_part(const mg_hull *h, int first, int end, const mg_real *p) {
  const mg_real shared = h->regions->coincidence * MG_COINCIDENCE_FACTOR / (h->arcs[first].side ? 1 : 2);
  int inside = 0;
  for (int i = first; i < end; i++)
    for (int j = h->arcs[i].span; j < h->arcs[i].span + h->arcs[i].n_span; j++) {
      const mg_arc_span *s = h->spans + j;
      const mg_real chord[2] = {s->end[0] - s->begin[0], s->end[1] - s->begin[1]},
                    arm[2] = {p[0] - s->begin[0], p[1] - s->begin[1]};
      const mg_real cross = mg_cross2(chord, arm);
      const int between = mg_is_between_chord_and_curve(h, s, p, cross, shared);
      if (between < 0) return 2;
      const int up = s->end[1] > p[1], was_up = s->begin[1] > p[1];
      inside ^= between ^ (up != was_up && (cross > 0) == up);
    }
  return inside;
}

MG_INTERNAL int mg_locate_point(const mg_hull *h, int side, const mg_real *p) {
  const mg_region_pair *r = h->regions;
  int first = side ? r->n_o : 0, part_end = first, inside = first == (side ? r->n_arc : r->n_o);
  for (; first < (side ? r->n_arc : r->n_o); first = part_end) {
    mg_find_part_of_arc(h, first, &first, &part_end);
    const int found = mg_locate_in_part(h, first, part_end, p);
    if (found == 2) return 2;
    inside |= found;
  }
  return inside;
}
