/* What the files of the core share: the scratch of one call. */
#ifndef MG_CONTEXT_H
#define MG_CONTEXT_H

#include "solve/friction/friction.h"
#include "kernels.h"
#include "solve/lcp/solvers.h"
#include "modelgen.h"
#include "region/region.h"



#define MG_GRID 17      /* samples along each side of a chart at the start */
#define MG_COARSE 9     /* and during a run */
#define MG_SAMPLES 289  /* MG_GRID squared */
#define MG_IN 9          /* of a sample: in its shape's axes, in its body's, its direction there */
#define MG_STARTS 8     /* of Newton's method on one link */
#define MG_FOUNDS 24    /* closest points of one pair */
#define MG_WALKS 3      /* mark in c->fired: the contact leaves its link */
#define MG_TIPS 4       /* mark in c->fired: it stays, but passes a border beyond which others may begin */

#define MG_SHORTER ((mg_real)0.2) /* part of a step that is tried after one without a finite end */
#define MG_TURNS 5      /* mark in c->fired of a slot's first pad: the centre of pressure leaves the hull */
#define MG_PARTS 6      /* the same: no force is left between the faces */
#define MG_ROLLS_OFF 7  /* the same: an imaginary edge gives way to the rim */
#define MG_SETTLES 8    /* the same: or to the face, which is flat again */
#define MG_YIELDS 9     /* the same: a side of the hull that is held no longer presses at one of its ends */

#define MG_GIVES 10     /* the same: friction does not hold the faces any longer */
#define MG_CALMS 11     /* the same: slip between the faces dies */

#define MG_NUMBERS 32 /* more than the parameters of a point on a plane */
#define MG_RADAU 7   /* stages of collocation */
#define MG_ETA 8     /* more than the entries of any contact's eta */
#define MG_STAGES 17 /* rows of K: 16 of DOP853, one spare for the right-hand side at events */

typedef struct mg_rub_state mg_rub_state; /* of a slot (rubs.h) */

typedef struct { /* a point of a shape: its chart coordinates, in the shape's axes, in the world */
  mg_real uv[2], local[3], point[3], direction[3];
} mg_sample;

typedef struct { /* where Newton's method starts on one link, the likeliest first */
  int count;
  mg_real merit[MG_STARTS], eta[MG_STARTS][6];
} mg_starts;

typedef struct { mg_real least, most; } mg_strain; /* bounds of what is left before an event; MG_MAX: nothing is watched */

typedef struct { /* an extremum; undecided: which side of two curves is outside cannot be told */
  int link, undecided;
  mg_real d, margin, point[3], normal[3], eta[6];
} mg_found;

typedef struct {
  int count;
  mg_found list[MG_FOUNDS];
} mg_founds;

typedef struct { /* of points of one body that another sees: how fast they move at most, and how fast that may grow */
  mg_real speed, pull;
} mg_motion;

typedef struct { /* how the bodies of a fresh contact lean on each other during its first step */
  mg_real normal[3], outward[3], axis[3];                        /* N and the way out in o's axes; N in f's axes */
  mg_real azimuth[MG_RADAU], tilt[MG_RADAU], stiffness[MG_RADAU]; /* at the stages: rad from the way out; rad; 1/s^2 */
  mg_real start[3], rate[MG_RADAU][3];                            /* lean, in o's axes, and what it changes by at the stages, rad/s */
  mg_real whole[MG_RADAU][2];                                     /* azimuth, stiffness of the whole step, while half is tried */
  mg_real blur[MG_RADAU];                                         /* what rounding of the poses makes of the azimuth, rad */
} mg_onset;

typedef struct { /* a contact's lean: the part across N of what was N when f lay flat, and the frame of an azimuth */
  mg_real normal[3], along[3], across[3], lean[3];
} mg_lean;

typedef struct { /* over a singular place: as it was before, per row 12, 1, 1, per contact 3, 3, per body 6, 6; least margin after */
  mg_real *column, *rate, *impulse, *point, *landed, *free, *gained, power, margin;
} mg_vault;

typedef struct {
  const mg_system *sys;
  const mg_kernels *kernels;
  const mg_settings *set;
  mg_run *run;
  int below, n_all;                         /* rows below the normal ones: from `below` to n_all, behind all others */
  int first_pad, first_pad_link;            /* contacts and links from there on are of patches */
  int n_x, work_index;                      /* length of x; index of the work state */
  mg_real *pose, *twist, *accel, *wrench;   /* per body 12, 6, 6, 6; accel without, then with contact forces */
  int bilateral, n_rows;                    /* rows: contacts, a spare, then those of the joints from `bilateral` on */
  mg_real *J, *MJ;                          /* per row 12: o then f; J and M^-1 J^T */
  mg_real *d, *gamma, *d_dot;               /* per row */
  mg_real *part, *most;                     /* per row of a joint: its own part, 0..1; per joint: their product at most */
  mg_real *MJ_before;                       /* per row of a joint 12: M^-1 J^T after the step before */
  mg_real *bias;                            /* per row: what time alone makes of d_dot */
  mg_real *normal, *tangents;               /* per contact 3; 6 */
  mg_real *block;                           /* rows of one contact as its kernel gives them: 6, 6 and 1 a row */
  mg_real *lean, *steer;                    /* per row below: force over -N of slip; per grip: angle of slip from its course */
  int leaning, steering;                    /* forces are sought: rows of slipping grips go with N; along steer */
  mg_real *force, *rate, *amount, *eta_dot; /* per row 1, 1, 1; n_eta */
  mg_real *A, *b, *z, *lcp;                 /* complementarity problem and its scratch */
  mg_real *S, *s, *y;                       /* the same with the joints eliminated */
  mg_real *K, *x_next, *x_stage, *settled;  /* stages; states; the end of a step with eta corrected */
  mg_real *scale;                           /* one a state: what its error is measured against */
  mg_real *dense;                           /* interpolant, 8 rows */
  mg_real *place;                           /* scratch of the place kernel */
  mg_real numbers[MG_NUMBERS];              /* parameters of a pad's contact */
  int *list, *mask, *fired, *near, *lcp_i; /* near: per contact, it takes part in a step of time-stepping */
  int *bound;                               /* mask of the rows of joints among those assembled */
  int *kept, *free;                         /* per row of a joint: independent after the step before; at any step */
  int *slipped, *before, *bound_of, *gives; /* per grip: its event has fired; its mode before; what bounds it; it slips */
  mg_real *over, *cone, *coulomb;           /* per grip: s, slip that was stopped had left; MG_CONE a contact; scratch */
  int *cone_contact, *cone_first, *cone_rows, *marks, *coulomb_i; /* per contact of the problem; scratch */
  int *kind, *o, *f, *n_eta, *parameters;   /* per contact: of its link; n_eta 0 on no link */
  int *upright;                             /* per contact: it had passed no watched border at the start of the step; MG_TIPS: is on one */
  int *way;                                 /* per contact: the condition that leads it off its link */
  mg_real *gap;                             /* per contact 2: d and d_dot where a step, or a part of it, begins */
  mg_strain *strain;                        /* what is left before events, at samples of a step, then now: per contact 1, of a slot's pads
                                               force, margin of its centre, friction; per grip 1 */
  int *dips;                                /* per contact: its open gap may have been closed within that part */
  int *column;                              /* per row: its place in A while assembled, else -1 */
  int *parent, *head, *next, *island;       /* islands: per body, body, row; held rows of one */
  int *first, *incident;                    /* rows at each moving body: incident[first[b]] .. */
  int *hidden;                              /* per contact: covered by a patch that is held */
  int *trying, *barred;                     /* per slot: held on trial; a patch not to be held again now, or -1 */
  int n_live;                               /* states without those of contacts on no link */
  mg_sample *sample;                        /* of both sides of a link: 2 MG_SAMPLES */
  mg_real *merit;                           /* of the samples of o with their best mate */
  int *mate;
  mg_real *table;                           /* samples kept: MG_IN each */
  int *tabled;                              /* per table of samples: they have been taken */
  mg_starts starts;
  mg_founds left;                           /* what contacts left in this step, not to be found again */
  int driven, moving;                       /* numbers of driven bodies, of bodies that forces move */
  int prescribed;                           /* a joint's motion is given */
  int n_timed;                              /* functions of time: of driven bodies, given motions and loads */
  int n_felt, n_still;                      /* loads that are felt, whose functions count too; those of them that time leaves alone */
  mg_real *instant;                         /* what they do in a step */
  mg_arc *arc;                              /* the boundaries of a patch */
  mg_regions regions;
  mg_real *lay;                             /* memory of the hull */
  mg_hull hull;
  int laid;                                 /* the patch whose hull that is, or -1 */
  mg_real shelter, sheltered[2]; /* the most that a point was found inside the hull that is laid, m, and the point */
  mg_rub_state *rub;                        /* per slot, where there is friction */
  mg_press press;                           /* of the slot last looked at */
  mg_strip *strips;
  long press_room;
  mg_real *reduced;                         /* a problem of friction without what holds both ways */
  int rub_rounds;                           /* pressures tried for the forces that are sought */
  mg_onset *onset;                          /* per contact */
  mg_real tried;                            /* size of a step from flat, tried at this state, that `dense` follows; 0: none */
  mg_real pace;                             /* what an explicit step can follow after slip has begun, s */
  mg_vault vault;
  mg_real until;                            /* where mg_advance stops, s */
  int suspect;                              /* an event function changed sign at a stage */
} mg_context;

typedef struct { /* two shapes of a contact kind, where they are */
  const mg_kernels *kernels;
  int kind;
  const mg_real *pose_o, *pose_f, *parameters;
} mg_couple;

typedef struct { /* what Newton's method is asked for */
  mg_real length, small; /* a residual below (small * length, small) */
  const mg_real *reach;  /* how far each entry of eta may go in one step */
} mg_goal;

typedef struct { /* their separation function along a normal */
  mg_real normal[3], d, slope[2], bend[3], tangents[6], eta[6];
} mg_view;

#endif
