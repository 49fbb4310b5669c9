/* How far apart shapes are at least, by balls around them. */
#include "core.h"

/* Between two balls, their centres in the axes of their bodies. */
static mg_real mg_between_balls(const mg_context *c, int o, const mg_real *centre_o, mg_real radius_o, int f,
                                const mg_real *centre_f, mg_real radius_f) {
  mg_real a[3], b[3];
  mg_out(c->pose + 12 * o, centre_o, 1, a);
  mg_out(c->pose + 12 * f, centre_f, 1, b);
  const mg_real span[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  return sqrt(mg_dot3(span, span)) - radius_o - radius_f;
}

/* Between the shapes of a link; 0 where one has no bound. */
static mg_real mg_clearance(const mg_context *c, int link) {
  const mg_real *o = mg_side(c, link, 0), *f = mg_side(c, link, 1);
  mg_real centre_o[3], centre_f[3];
  if (o[MG_BOUND] >= MG_MAX / 2 || f[MG_BOUND] >= MG_MAX / 2) return 0;
  mg_out(o + MG_PLACEMENT, o + MG_CENTRE, 1, centre_o);
  mg_out(f + MG_PLACEMENT, f + MG_CENTRE, 1, centre_f);
  return mg_between_balls(c, mg_side_body(c, link, 0), centre_o, o[MG_BOUND], mg_side_body(c, link, 1), centre_f, f[MG_BOUND]);
}

static int mg_is_far(const mg_context *c, int link) {
  return mg_clearance(c, link) > c->set->reach * c->sys->length;
}

/* Between the whole shapes of a pair; the faces of a box have no bound each, the box has. */
static mg_real mg_pair_clearance(const mg_context *c, int pair) {
  const mg_real *ball = c->sys->pair_ball + 8 * pair;
  const int first = c->sys->pair_link[pair];
  mg_real clear = MG_MAX, whole = 0;
  if (ball[3] >= 0 && ball[7] >= 0)
    whole = mg_between_balls(c, mg_side_body(c, first, 0), ball, ball[3], mg_side_body(c, first, 1), ball + 4, ball[7]);
  for (int link = first; link < c->sys->pair_link[pair + 1]; link++) clear = fmin(clear, mg_clearance(c, link));
  return fmax(fmax(clear, whole), 0);
}
