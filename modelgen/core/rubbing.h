/* Friction between two faces that lie on each other: the pressure between them, what Coulomb's law at every point sums up
   to, and how much of it a force needs that holds. Everything is in the axes of a hull (region.h), which must be laid.

   The pressure is that of Winkler's foundation that does not pull: p = max(0, a + b.x), the only one of this form with a
   given resultant and centre, and of all pressures that have them the one with the least integral of p^2. It is affine
   while the centre lies in the kern of the region, and crowds into what the face turns on as the centre nears the edge of the
   hull. (Winkler, Die Lehre von der Elasticitaet und Festigkeit, 1867; Johnson, Contact Mechanics, 1985, section 4.3.)

   A twist (v, w) of f past o rubs with u = (v + w k x d) / |v + w k x d| at a point d off the centre of pressure:
     F = -mu * integral p u dA,   torque = -mu * integral p d x u dA,   power = -mu * integral p |v + w k x d| dA.
   All forces and torques that hold lie within those of all twists, the limit surface; the force is the gradient of the
   power (Goyal, Ruina, Papadopoulos, Wear 143 (1991), 307-330 and 331-352). For a uniform disc: Farkas, Bartels, Unger, Wolf,
   Phys. Rev. Lett. 90 (2003), 248302. */
#ifndef MG_RUBBING_H
#define MG_RUBBING_H

#include "region.h"

typedef struct { /* a part of the boundary of what is pressed, run through with that on the left */
  int track, straight, ends[2]; /* ends: the pressure vanishes there, within the region */
  mg_real t[2], P[2], Q[2];
} mg_strip;

typedef struct {
  const mg_hull *hull;
  int cut;                         /* the pressure vanishes on a line across the region */
  long n, room;                    /* strips */
  mg_strip *strip;
  mg_real centre[2], level[3];     /* p = level[0] + (level[1], level[2]).(x - centre) */
  mg_real foot[2];                 /* of the centre on that line; else the centre */
  mg_real moments[6];              /* of what is pressed, about the centre: 1, x, y, xx, xy, yy */
  mg_real extent;                  /* m: no point of it is farther from the centre */
} mg_press;

enum { MG_NODES = 10, MG_FEW = 4 };

/* Gauss and Legendre's nodes and weights on 0..1. */
static const mg_real mg_node[MG_NODES] = {
    (mg_real)0.013046735741414139961018, (mg_real)0.0674683166555077446339517, (mg_real)0.160295215850487796882836,
    (mg_real)0.283302302935376404600367, (mg_real)0.425562830509184394557587,  (mg_real)0.574437169490815605442413,
    (mg_real)0.716697697064623595399633, (mg_real)0.839704784149512203117164,  (mg_real)0.932531683344492255366048,
    (mg_real)0.986953264258585860038982};
static const mg_real mg_node_weight[MG_NODES] = {
    (mg_real)0.0333356721543440687967844, (mg_real)0.0747256745752902965728882, (mg_real)0.109543181257991021997767,
    (mg_real)0.134633359654998177545613,  (mg_real)0.147762112357376435086946,  (mg_real)0.147762112357376435086946,
    (mg_real)0.134633359654998177545613,  (mg_real)0.109543181257991021997767,  (mg_real)0.0747256745752902965728882,
    (mg_real)0.0333356721543440687967844};

/* lay.c: the most strips */
MG_INTERNAL long mg_press_room(int n_arc, int n_o);

/* pressing.c */
MG_INTERNAL void mg_open_press(mg_press *p, const mg_hull *h, long room, mg_strip *strips);
MG_INTERNAL int mg_press_at(mg_press *p, mg_real force, const mg_real *centre);
MG_INTERNAL void mg_press_whole(mg_press *p, const mg_real *about);
MG_INTERNAL int mg_solve_moments(const mg_press *p, const mg_real *moment, mg_real *level);
MG_INTERNAL int mg_inside_hull(const mg_hull *h, mg_real *x);

/* rubbing.c: G of force x, y and torque about the centre (rows) by the pressure's coefficients (columns); the friction of
   a twist (v of the centre, w) is -mu G level */
MG_INTERNAL void mg_rub(const mg_press *p, const mg_real *twist, mg_real G[3][3]);

/* limit_surface.c: the share that a force and torque about the centre take of what unit friction can hold, 1 at the
   most, and the twist, of unit length with w in units of 1/radius, that would rub most against it */
MG_INTERNAL mg_real mg_share_of_limit(const mg_press *p, const mg_real *wrench, mg_real radius, mg_real *twist);

#endif
