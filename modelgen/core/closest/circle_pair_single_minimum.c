/* Whether the distance of two circles has one minimum at most within a bound, without finding it: a contact that is at
   a minimum there then is at the only one. Of a point of the first circle, at the height z above the plane of the
   second and the distance rho from its axis, F = (z^2 + (rho - R)^2) / 2 is half the squared distance from the second,
   of the radius R. With the point p, the unit vectors n away from the axis and t about it, and the centres c apart, F'
   = p.p' - R n.p',    F'' = c.p'' - R (n.p'' + (t.p')^2 / rho). No minimum lies on an arc of the first circle that is
   beyond the bound or on which F' has a sign, and one at most on neighbouring arcs with F'' > 0. What cannot be told of
   an arc is told of parts of it. */
#include "closest/closest.h"
#include "base/base.h"
#include "model/model.h"

#define MG_TURN_PARTS 256 /* smallest arcs of a turn */
#define MG_WIDEST_ARC 16  /* smallest arcs in the widest */
#define MG_ARC_LEVELS 3   /* widths of arcs, each a quarter of the one before it */

/* What is known of an arc. */
enum { MG_ARC_WITHOUT_MINIMUM, MG_ARC_CONVEX, MG_ARC_OPEN };

/* What an arc is judged by. */
typedef struct {
  mg_first_circle first;
  mg_real r, R;     /* radii of both circles, m */
  mg_real reach;    /* bound of the distance, m */
  mg_real centres;  /* distance of the centres, m */
  mg_real rounding; /* rounding error of F', F'' */
} mg_circle_pair;

/* Value of a sinusoid without its mean, at an angle with this cosine and sine. */
static inline mg_real mg_swing(const mg_sinusoid *f, mg_real cosine, mg_real sine) {
  return f->p * cosine + f->q * sine;
}

/* Judges the arc within `half` of an angle of the first circle: MG_ARC_WITHOUT_MINIMUM .. . */
static int mg_judge_circle_arc(const mg_circle_pair *of, mg_real cosine, mg_real sine, mg_real half) {
  const mg_first_circle *first = &of->first;
  const mg_real r = of->r, R = of->R, shift = r * half;
  const mg_real bx = -mg_swing(&first->x, cosine, sine), by = -mg_swing(&first->y, cosine, sine), x = first->x.m - bx,
                y = first->y.m - by, z = first->z.m + mg_swing(&first->z, cosine, sine), rho = sqrt(x * x + y * y),
                apart = of->reach + shift;
  if (z * z + (rho - R) * (rho - R) > apart * apart) return MG_ARC_WITHOUT_MINIMUM;
  if (!(rho > 2 * shift)) return MG_ARC_OPEN;
  const mg_real ax = mg_swing(&first->x, -sine, cosine), ay = mg_swing(&first->y, -sine, cosine), least = rho - shift,
                turn = r * (half + shift / least), about = fabs(x * ay - y * ax) / rho + turn,
                outward = (x * bx + y * by) / rho, pull = mg_swing(&first->towards, cosine, sine),
                swing = -mg_swing(&first->towards, -sine, cosine),
                change = (fabs(swing) + r * of->centres * half / 2) * half;
  const mg_real low = pull - change - R * (outward + turn + about * about / least),
                high = pull + change - R * (outward - turn), slope = swing - R * (x * ax + y * ay) / rho;
  if (fabs(slope) > half * mg_max(fabs(low), fabs(high)) + of->rounding) return MG_ARC_WITHOUT_MINIMUM;
  return low > of->rounding ? MG_ARC_CONVEX : MG_ARC_OPEN;
}

/* Turns a direction by the angle with this cosine and sine. */
static inline void mg_turn_direction(const mg_real *by, mg_real *cosine, mg_real *sine) {
  const mg_real before = *cosine;
  *cosine = before * by[0] - *sine * by[1], *sine = before * by[1] + *sine * by[0];
}

MG_INTERNAL int mg_have_circles_one_minimum(const mg_centred_feature *of, mg_real gap) {
  const mg_real r = of[0].curve.radius, R = of[1].curve.radius, part = MG_PI / MG_TURN_PARTS;
  mg_circle_pair pair = {mg_view_first_circle(of), r, R, gap + of[0].curve.tube + of[1].curve.tube, 0, 0};
  mg_real cosine = 1, sine = 0, turn[MG_ARC_LEVELS][2];
  int level = 0, size = MG_WIDEST_ARC, runs = 0, was_convex = 0, starts_convex = 0;
  pair.centres = sqrt(-pair.first.towards.m), pair.rounding = 64 * MG_EPS * r * (pair.centres + R);
  for (int k = 0, n = MG_WIDEST_ARC; k < MG_ARC_LEVELS; k++, n /= 4)
    turn[k][0] = mg_cos((mg_real)n * part), turn[k][1] = mg_sin((mg_real)n * part);
  for (int at = 0; at < MG_TURN_PARTS && runs <= 1 + starts_convex;) {
    mg_real middle[2] = {cosine, sine};
    mg_turn_direction(turn[level], middle, middle + 1);
    const int verdict = mg_judge_circle_arc(&pair, middle[0], middle[1], (mg_real)size * part);
    if (verdict == MG_ARC_OPEN) {
      if (++level == MG_ARC_LEVELS) return 0;
      size /= 4;
      continue;
    }
    const int is_convex = verdict == MG_ARC_CONVEX;
    if (at == 0) starts_convex = is_convex;
    runs += is_convex && !was_convex, was_convex = is_convex;
    mg_turn_direction(turn[level], middle, middle + 1), cosine = middle[0], sine = middle[1];
    at += size;
    while (level > 0 && at % (4 * size) == 0) level--, size *= 4;
  }
  return runs - (was_convex && starts_convex && runs > 1) <= 1;
}
