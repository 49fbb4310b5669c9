/* The context of one call: the caller's structures and the scratch memory, by subject.

   Every public function makes an mg_context on its stack (run/workspace.c) and passes it down. Its arrays are parts of
   the caller's `work` and `iwork`. Scratch is valid within one call, except the cells of c->search, which last as long
   as the shapes are the same.

   Rows are the scalar equations of all constraints, in this order: the normal row of each contact, one of a probe
   contact (which tries feature pairs out), rows of joints, friction rows, springs. The number of a contact is the
   number of its normal row. [per row] and the like give the shapes of arrays; J has 12 columns, of body o, then of body
   f. */
#ifndef MG_CONTEXT_H
#define MG_CONTEXT_H

#include "base/base.h"
#include "solve/friction/friction.h"
#include "kernels.h"
#include "solve/lcp/lcp_solvers.h"
#include "modelgen.h"
#include "region/region.h"

#define MG_SAMPLES 289         /* most samples of a feature */
#define MG_FEATURE_VIEWS 128   /* features of a pair that are seen at a time; others take their places */
#define MG_CELL_PAIRS 512      /* room for pairs of cells that a search has still to treat */
#define MG_CRITICAL 64         /* most critical points that a search of a feature pair keeps in mind */
#define MG_POINT_PARAMETERS 32 /* room for the parameters of a contact of a point with a plane */
#define MG_RADAU_STAGES 7      /* stages of Radau collocation */
#define MG_SLIP_UNKNOWNS 4     /* most slip directions that collocation takes as unknowns */
#define MG_MAX_ETA 8           /* room for the eta of one contact */
#define MG_STAGES 17           /* rows of c->step.slopes: 16 of DOP853, one for the right-hand side at other states */

#define MG_SWITCH_COLUMNS 37 /* numbers by which a gradient of a switching function begins: t, poses and twists */

#define MG_NONFINITE_STEP_CUT ((mg_real)0.2)  /* factor of the step after one whose end is not finite */
#define MG_STEP_GROWTH ((mg_real)6)           /* most by which a step is longer than the one before it */
#define MG_COMPANION_STEP_GROWTH ((mg_real)2) /* the same in a companion run, which so takes the shorter steps */

/* Marks in c->events.triggered; 0: no event, 1: the gap closes, or the force becomes tensile, or a gap without force
   opens. Marks from MG_PRESSURE_AT_EDGE on are of the first support point of a slot. */
#define MG_LEAVES_FEATURE 3     /* the contact leaves its feature pair */
#define MG_PASSES_BORDER 4      /* the contact stays and passes a border beyond which others may begin */
#define MG_PRESSURE_AT_EDGE 5   /* the centre of pressure leaves the hull */
#define MG_FACES_SEPARATE 6     /* the resultant of the pressure becomes tensile */
#define MG_ROLLS_ONTO_RIM 7     /* the tilt about a held edge is large enough for contact on the rim */
#define MG_FLAT_AGAIN 8         /* the face that turned about a held edge is flat again */
#define MG_EDGE_UNLOADED 9      /* the force at one end of a held side of the hull becomes tensile */
#define MG_FRICTION_EXCEEDED 10 /* the friction force of a sticking patch reaches the limit surface */
#define MG_SLIP_ENDS 11         /* the slip of a patch ends */

typedef struct mg_patch_friction mg_patch_friction; /* friction of the patch in a slot (forces/forces.h) */
typedef struct mg_context mg_context;

/* What goes along with the steps of mg_advance, and with the stages of those of DOP853 that it tries. */
typedef struct {
  void *of;
  mg_real h;   /* length of the step whose stages in c->step.slopes are followed, s; 0: none */
  int is_open; /* 1: the step now taken is one that is tried, not one towards an event */
  int grazed;  /* contact whose gap had a minimum of hardly more than zero in the step, without an event; or -1 */
  mg_real grazed_part; /* of the step up to that minimum */
  /* After each stage, and with stage 12 at the end; stage 0 comes before the others and is not evaluated. */
  void (*stage)(mg_context *c, void *of, int is_composed, int stage, mg_real t, mg_real h);
  mg_real (*error)(mg_context *c, void *of, mg_real h); /* of what goes along, of what it may be; or 0 */
  void (*begin)(mg_context *c, void *of);               /* before a step */
  void (*settle)(mg_context *c, void *of); /* after the evaluation at the end of a step, before its projection */
  int (*end)(mg_context *c, void *of);     /* after a step; returns 0 where mg_advance is to return */
} mg_follower;

/* A sampled point of a feature. */
typedef struct {
  mg_real uv[2];        /* chart coordinates */
  mg_real local[3];     /* point in the axes of the shape, m */
  mg_real point[3];     /* point in world axes, m */
  mg_real direction[3]; /* exterior normal of a surface or unit tangent of a curve, world axes */
} mg_sample;

/* A cell of a feature: a box of its coordinates, with bounds of what lies in it. Those of bends are worked out when a
   search needs them. Axes of the shape. */
typedef struct {
  mg_real box[4];         /* least and greatest u, least and greatest v */
  mg_real centre[3];      /* point at the middle of the box, m */
  mg_real radius;         /* bound of the distance of points of the cell from the centre, m */
  mg_real slope[2][3];    /* the cell is centre + r slope[0] + s slope[1] + e, -1 <= r, s <= 1, */
  mg_real extent[3];      /* bound of |point - centre| along each axis, m */
  mg_real rest;           /* with |e| <= rest, m */
  mg_real direction[3];   /* normal of a surface or unit tangent of a curve at the middle */
  mg_real spread;         /* bound of |n - direction| over the cell; 2: no bound */
  mg_real bend[6];        /* at the middle: W of a surface (xx, yy, zz, xy, xz, yz), curvature vector of a curve, 1/m */
  mg_real bend_change[6]; /* bound of the change of each entry of bend over the cell, 1/m */
  mg_real bend_size;      /* norm of bend, 1/m */
  mg_real bend_error;     /* norm of bend_change, 1/m */
  int halves;             /* first of the two cells into which this one is divided; 0: not divided yet */
  mg_real place_to_divide; /* place at which it is divided, from -1 to 1 */
  int direction_to_divide; /* coordinate along which it is divided: 0 u, 1 v */
  int has_bends;           /* 1: bends are bounded */
  int is_of_spine;         /* 1: it bounds the spine of the feature at these coordinates */
} mg_cell;

/* Bounds of an event margin: of what is left before an event function is zero; MG_MAX: nothing is watched. */
typedef struct {
  mg_real lower; /* lower bound */
  mg_real upper; /* upper bound */
} mg_event_margin;

/* A minimum of the distance on a feature pair. */
typedef struct {
  int feature_pair;  /* feature pair */
  int undecided;     /* 1: two curves touch, and it is not known which side is outside */
  mg_real d;         /* gap, m */
  mg_real margin;    /* distance from a singularity, 1 */
  mg_real point[3];  /* contact point on the body with the smaller number, m */
  mg_real normal[3]; /* unit normal from that body to the other */
  mg_real eta[6];    /* eta */
} mg_minimum;

/* Minima of one pair, in order of |d|. */
typedef struct {
  int count;                  /* minima */
  mg_minimum list[MG_MINIMA]; /* the minima */
} mg_minima;

/* Bound of the motion of the points of one body in the axes of another. */
typedef struct {
  mg_real speed;        /* m/s */
  mg_real acceleration; /* m/s^2 */
} mg_motion_bound;

/* A contact that starts to roll from flat, during its first step. The tilt of the bodies is the part across N, in o's
   axes, of the vector that was N while f lay flat; its azimuth is its angle from the outward direction about N. */
typedef struct {
  mg_real normal[3];                      /* N while flat, axes of o */
  mg_real outward[3];                     /* outward direction, along the plane, axes of o */
  mg_real axis[3];                        /* N while flat, axes of f */
  mg_real azimuth[MG_RADAU_STAGES];       /* azimuth at the stages, rad */
  mg_real tilt[MG_RADAU_STAGES];          /* size of the tilt at the stages, rad */
  mg_real stiffness[MG_RADAU_STAGES];     /* derivative by the azimuth of the tilt acceleration across it, 1/s^2 */
  mg_real tilt_start[3];                  /* tilt at the start of the step, axes of o */
  mg_real tilt_rate[MG_RADAU_STAGES][3];  /* rate of the tilt at the stages, rad/s, axes of o */
  mg_real whole_step[MG_RADAU_STAGES][2]; /* azimuth and stiffness of the whole step, kept while half of it is tried */
  mg_real azimuth_noise[MG_RADAU_STAGES]; /* rounding error of the azimuth, rad */
} mg_rolling_start;

/* Tilt of a contact that starts from flat, world axes. */
typedef struct {
  mg_real normal[3]; /* N */
  mg_real along[3];  /* unit vector in the plane at an azimuth */
  mg_real across[3]; /* N x along */
  mg_real tilt[3];   /* tilt */
} mg_contact_tilt;

/* Passage of a singular contact by an impulse (events/singular_passage_step.c). */
typedef struct {
  mg_real *column;        /* [12 per row] M^-1 J^T, with the friction of slip, before the passage */
  mg_real *rate;          /* [per row] row velocity before */
  mg_real *impulse;       /* [per row] impulse of the passage */
  mg_real *point;         /* [3 per contact] contact point of f before, m */
  mg_real *landing_point; /* [3 per contact] contact point of f after, m */
  mg_real *free_twist;    /* [6 per body] acceleration without the forces of the rows before */
  mg_real *impulse_work;  /* [6 per body] change of the twist by loads and by the forces at both ends */
  mg_real power;          /* power of the loads before, W */
  mg_real margin;         /* least margin of a closed contact after */
  int is_paused;          /* 1: the run stops within the passage, which goes on in the next call of mg_advance */
} mg_singular_passage;

/* Complementarity problem over listed rows, and memory of its solvers. */
typedef struct {
  mg_real *A;          /* [n n] J M^-1 J^T of the listed rows, column-major */
  mg_real *b;          /* [n] right-hand side */
  mg_real *z;          /* [n] solution */
  mg_real *work;       /* [mg_lcp_work_size(n)] memory of the solvers */
  mg_real *reduced_A;  /* [k k] A after the elimination of bilateral rows */
  mg_real *reduced_b;  /* [k] b after the elimination of bilateral rows */
  mg_real *reduced_z;  /* [n] forces of the bilateral rows */
  int *rows;           /* [n] row of each unknown */
  int *mask;           /* [n] active set of the unknowns */
  int *iwork;          /* [mg_lcp_iwork_size(n)] memory of the solvers */
  int *joint_mask;     /* [n] bilateral rows; of joint rows alone: the independent ones */
  int *column;         /* [per row] its column in A, else -1 */
  mg_real rounding;    /* largest relative error that rounding may have made in the forces of the contacts sought */
  mg_real least_pivot; /* least pivot of the scaled matrices of islands since the last right-hand side began; 0: rows
                          are dependent */
  int n_assembled;     /* matrices assembled since the last right-hand side began */
  int keeps_matrix;    /* 1: A is that of all rows, which are not assembled again */
  int is_of_joints;    /* 1: A is that of the present joint rows alone, in their order */
} mg_lcp_workspace;

/* Islands: sets of rows that share moving bodies. */
typedef struct {
  int *parent;         /* [per body] union-find forest */
  int *head;           /* [per body] first row of the island of which the body is the root, or -1 */
  int *next;           /* [per row] next row of its island, or -1 */
  int *rows;           /* [n] rows of one island */
  int *incident_begin; /* [per body + 1] range of incident */
  int *incident;       /* rows that act on a body */
} mg_island_workspace;

/* Rank of the joint rows. */
typedef struct {
  mg_real *independence; /* [per joint row] part of its diagonal entry of J M^-1 J^T independent of rows before, 0..1 */
} mg_joint_workspace;

/* A ball around a shape in the grid of the broad phase. */
typedef struct {
  mg_real centre[3]; /* centre, world axes, m */
  mg_real radius;    /* radius with all margins, m; < 0: not in the grid */
  long long cell[3]; /* its cell, in widths of a cell of its level */
  int level;         /* its level: cells are 2^level as wide as those of level 0 */
  int next;          /* next ball with the same place in the grid, or -1 */
} mg_grid_ball;

/* The slots of the pools while near pairs are looked for. */
typedef struct {
  int *of_ball;   /* [per ball] first slot in use whose pair has it as o, counted from the first of all slots, or -1 */
  int *next;      /* [per slot] next such slot, or -1 */
  int *next_free; /* [per pool] slots before it are in use */
  int exceeded;   /* pool without a free slot for a pair, or -1 */
} mg_slot_listing;

/* What takes part at present. Entry 0 of a list of successors is the first member, entry k + 1 the one after k. */
typedef struct {
  int *row;            /* [1 per row + 1] contacts and rows */
  int *constraint;     /* [1 per friction constraint + 1] friction constraints */
  int *pair;           /* [1 per pair + 1] pairs of shapes; those of limits are none */
  int *patch;          /* [1 per patch + 1] patches but for those of slots that are left out */
  int *range;          /* [2 per contact + 6] first state and end of each range of states */
  int *always;         /* [per pair] pairs that are never left out, ascending */
  int *over_plane;     /* [per pair] pairs of a plane that does not move, which may be far */
  int *listed;         /* [per pair] pairs that take part, ascending */
  int *found;          /* [per pair] pairs that the broad phase found; then those of them that had been left out */
  int *grid;           /* [mg_grid_size] first ball of each place in the grid, or -1 */
  mg_grid_ball *balls; /* [system->n_ball] balls */
  mg_slot_listing slots;
  int is_starting; /* 1: ranges of states are not made anew when a contact changes its feature pair */
  int n_range, n_always, n_over_plane, n_listed, n_found;
  int n_contact;      /* contacts that take part */
  int has_candidates; /* 1: there are pairs that may be left out */
} mg_listing;

/* Springs and dampers as rows. */
typedef struct {
  int are_rows;     /* 1: they act through their rows, not as loads */
  mg_real *impulse; /* [per spring] part of its impulse that does not depend on the end of the step, over sqrt(g) */
  int *load;        /* [per spring] its load */
  int *sharing;     /* [per spring] number of springs on that of its bodies which has more */
} mg_spring_workspace;

/* Friction of single contacts. */
typedef struct {
  mg_real *force_ratio;     /* [per friction row] friction force of slip over minus the normal force */
  mg_real *slip_angle;      /* [per friction constraint] direction of slip, rad from run->slip_direction */
  int slips;                /* 1: slip may have a force at the state evaluated last; else all force ratios are zero */
  int couples_normal;       /* 1 while forces are sought: friction of slip is proportional to the normal force */
  int follows_angle;        /* 1 while forces are sought: slip has the direction of slip_angle */
  int *triggered;           /* [per friction constraint] 1: its event has triggered */
  int *mode_before;         /* [per friction constraint] its mode at the start of the step */
  int *bound;               /* [per friction constraint] what bounds its force: MG_BOUND_SLIP .. */
  int *is_yielding;         /* [per friction constraint] 1: its force exceeds the static bound */
  int *is_stiff;            /* [per friction constraint] 1: friction turns its slip much faster than the slip changes */
  mg_real *slip_time_left;  /* [per friction constraint] time that slip which was stopped would have lasted, s */
  mg_real *cone;            /* [MG_CONE per contact of the problem] coefficients */
  mg_real *work;            /* memory of the solver */
  int is_loose, is_relaxed; /* 1: impulses of the step were found to stepping_residual only; by the relaxed law */
  mg_real *row_yield;       /* [per row of the problem] what it yields, of a problem on a graph */
  int *row_body;            /* [2 per row of the problem] bodies on which it acts, or -1, of a problem on a graph */
  int *cone_contact;        /* [per contact of the problem] its contact */
  int *cone_first;          /* [per contact of the problem] its first unknown */
  int *cone_rows;           /* [per contact of the problem] its number of rows: 1, 3 or 6 */
  int *marks;               /* [per contact of the problem] MG_MARK_FORCE .. */
  int *iwork;               /* memory of the solver */
  mg_real *share;           /* [per contact of the problem] its normal impulse in the round before, N s */
} mg_friction_workspace;

/* Shares of the pairs in a patch of several. What holds the patch treated last stays as it is. */
typedef struct {
  mg_arc *arcs;                       /* arcs of both regions, of the patch or of a share */
  mg_region_pair regions;             /* both regions */
  mg_real *hull_memory;               /* memory of the hull */
  mg_hull hull;                       /* overlap of the regions */
  mg_winkler_pressure_field pressure; /* pressure between the faces */
  mg_boundary_strip *strips;          /* boundary of the loaded part of the overlap */
  long strip_capacity;                /* room for strips */
  mg_real *weight;                    /* [3 per share of the patch] part of the force on each support */
} mg_share_workspace;

/* Patches: regions, hull and pressure of the patch treated last, and one record per slot. */
typedef struct {
  mg_arc *arcs;                       /* arcs of both regions */
  mg_region_pair regions;             /* both regions */
  mg_real *hull_memory;               /* memory of the hull */
  mg_hull hull;                       /* overlap of the regions and its convex hull */
  int hull_patch;                     /* patch of regions and hull, or -1 */
  mg_real deepest;                    /* largest margin found so far in a hull that does not change, m */
  mg_real deepest_point[2];           /* point of that margin, axes of the hull, m */
  mg_patch_friction *friction;        /* [per slot] friction of its patch */
  mg_winkler_pressure_field pressure; /* pressure between the faces */
  mg_boundary_strip *strips;          /* boundary of the loaded part of the region */
  long strip_capacity;                /* room for strips */
  mg_real *reduced_problem;           /* friction problem without bilateral rows: matrix, right-hand side, solution */
  int pressure_rounds;                /* pressures tried for the forces that are sought */
  int *is_covered;                    /* [per contact] 1: covered by a patch that is held */
  int *trial;                         /* [per slot] 1: held on trial; MG_TRIAL_ON_EDGE, MG_TRIAL_TORN_OFF */
  int *barred;                        /* [per slot] patch that may not be held again at this time, or -1 */
  mg_share_workspace share;           /* shares of the pairs in a patch */
} mg_patch_workspace;

/* A feature at the present poses, in world axes. */
typedef struct {
  long round;        /* the view_round in which it was read; 0: in none */
  int numbers, body; /* which it is: system->feature_numbers, and its body */
  int dimension;
  int shape;           /* its kind */
  int flat;            /* that of its kind; 0 of a point that is not its own ball */
  int is_near;         /* 1: its ball is within reach of the ball around the other shape */
  mg_real radius;      /* of a ball that contains it, m; MG_MAX: none */
  mg_real centre[3];   /* of that ball, m */
  mg_real point[3];    /* of one that is flat and near: origin of its shape; a vertex itself, m */
  mg_real rotation[9]; /* of the same: axes of its shape, by columns */
} mg_feature_in_world;

/* Search for closest points. */
typedef struct {
  mg_sample *samples;             /* [MG_SAMPLES] samples of a feature */
  mg_real *face_gap;              /* [per face of a pair] least gap of a flat face of one solid to the features of
                                     another, m */
  mg_cell *cells;                 /* [system->n_cell] cells of all trees; cell 0 is not used */
  int *n_cells;                   /* [1] cells in use, cell 0 included */
  int *tree_root;                 /* [2 per cell tree] first cell of the feature, and of its spine, or 0 */
  mg_real *tree_bound;            /* [2 per cell tree] where a coordinate has no bound: that of these cells */
  mg_digest *cells_digest;        /* [1] digest of the shapes to which the cells belong */
  mg_taylor_model *bounds_memory; /* memory of bounds programs */
  mg_real *searched_gap; /* [per pair] open_gap of a search at the end of this step that found all minima followed, m;
                            -1: not searched; -2: it found minima that touch and that no contact followed */
  mg_feature_in_world *views; /* [MG_FEATURE_VIEWS] features of the pair that is searched, by their numbers */
  int viewed_pair;            /* that pair */
  long view_round;            /* number of the present search of a pair in this call */
  int *cell_pairs;            /* [2 MG_CELL_PAIRS] pairs of cells still to be treated */
  mg_real open_gap;           /* least gap noted in the present search by mg_note_open_gap, m; MG_MAX: none */
  mg_real singular_gap;       /* the same of closest points that are not isolated, which no contact can follow */
  mg_minimum overlap;    /* of closest points that are not isolated and penetrate, those noted in the present search
                            with the least depth; d = -MG_MAX: none */
  long incomplete;       /* searches of feature pairs given up since the context was opened */
  mg_minimum *abandoned; /* [mg_abandoned_capacity] minima that contacts have left in this step */
  int n_abandoned;
  int is_stoppable;        /* 1: a search may end without a result when the call is to stop */
  mg_real penetration;     /* deepest penetration noted in this step, m */
  int penetration_contact; /* its contact, or the first contact of its pair */
  int penetration_outcome; /* outcome of a run that ends by it */
  mg_real *placement; /* outputs of contact_place: d, residual (2), margin (2), N (3), points of o and f (3, 3); from
                         32 on eta_next */
} mg_search_workspace;

/* One step of an integrator. */
typedef struct {
  mg_real *start_pose;   /* [12 per body] poses at its start */
  mg_real *pressing;     /* [6 per contact] time-stepping: contact point and force, world axes, m and N, before contacts
                            change */
  int *pressing_on;      /* [per contact] feature pair on which it had that force; -1: it had none */
  mg_real *slopes;       /* [MG_STAGES n_states] right-hand sides of the stages; of collocation: slope at the
                            start, then states, then slopes of the stages */
  mg_real *stage;        /* [n_states] state at a stage or on the interpolant */
  mg_real *end;          /* [n_states] state at the end of the step */
  mg_real *end_gap;      /* [per contact] gap there, by its rows */
  mg_real *settled;      /* [n_states] state at the end with eta corrected; in time-stepping: state at which
                            rows are taken */
  mg_real *scale;        /* [n_states] size of each state, against which its error is measured */
  mg_real *interpolant;  /* [8 n_states] coefficients of the interpolant */
  mg_real *load_wrench;  /* [6 per body] time-stepping: wrenches of the loads in the middle of the step */
  mg_real *pose;         /* [12 per body] time-stepping: poses from which contact points are followed */
  mg_real *time_samples; /* samples of the functions of time in a step */
  mg_rolling_start *rolling_starts; /* [per contact] start of rolling */
  mg_real rolling_step;  /* length of a step from flat tried at this state, which the interpolant holds, s; 0:
                            none */
  mg_real *angle_slopes; /* [MG_RADAU_STAGES MG_SLIP_UNKNOWNS n_u] derivatives of the accelerations at the stages by the
                            angles of slip; none in a scene without friction */
  mg_real slip_limit;    /* longest explicit step after the start of slip, s */
  mg_real stop_time;     /* t_stop of mg_advance, s */
  mg_real end_time;      /* time of `end`, s */
  mg_real error;         /* error of the step tried last, over the tolerance */
  mg_real work;          /* what evaluations and forces have taken in this step, evaluations of one contact */
  int mode_choices;      /* how often the modes of the contacts were chosen in this step */
  int chooses_modes;     /* 1 while modes of contacts with friction are chosen */
  int is_end_evaluated; /* 1: rows, rates, forces and accelerations are those at `end` and the modes of the run, but for
                           the gaps, which end_gap keeps */
  int stiff_failures;   /* collocations of stiff slip that have failed at this state */
  int sign_changed;     /* 1: an event function had changed sign at a stage */
  int beyond_margin;    /* 1: a pair of shapes that is left out could have met at a stage */
  mg_follower *follower; /* or null */
} mg_step_workspace;

/* Events of one step. */
typedef struct {
  int *triggered;           /* [per contact] 0, 1 or a mark MG_LEAVES_FEATURE .. */
  int *within_border;       /* [per contact] 1: watched conditions held at the start; MG_PASSES_BORDER: on a border */
  int *broken_condition;    /* [per contact] condition that leads it off its feature pair */
  mg_real *gap_before;      /* [2 per contact] d and d_dot at the start of the step, or of the part looked at */
  int *gap_dips;            /* [per contact] MG_GAP_MAY_CLOSE or MG_GAP_OSCILLATES within that part, or 0 */
  mg_event_margin *margins; /* [per sample of the step, and the present state last] event margins: of each contact
                               (support points of a slot: force, centre of pressure, friction), of each friction
                               constraint */
  int *is_near;             /* [per contact] 1: takes part in a step of time-stepping */
  mg_singular_passage passage; /* singular passage */
} mg_event_workspace;

/* Switching functions of the loads at the right-hand side evaluated last. */
typedef struct {
  mg_real *value;          /* [n_switch] value */
  mg_real *rate;           /* [n_switch] its rate, 1/s */
  mg_real *second;         /* [2 n_switch] 1 for a function of t and poses alone, and its second rate, 1/s^2; else 0 */
  mg_real *size;           /* [n_switch] sum of the sizes of what it depends on, times its derivatives */
  mg_real *noise;          /* [n_switch] size up to which a value counts as zero */
  mg_real *slope;          /* [MG_SWITCH_COLUMNS n_switch] gradient by t, pose and twist of a and of b */
  mg_real *gradient;       /* [most of one load] gradients of those of one load, as its kernel writes them */
  mg_real *input_gradient; /* [3 n_input most of one load] the same by the inputs */
  mg_real *slack;    /* [n_switch] by how much it may be beyond zero in a step at whose start it was, on its way back */
  int *triggered;    /* [n_switch] 1: its event has triggered */
  int *is_at_zero;   /* [n_switch] 1: it is zero where branches are chosen */
  int *mode_before;  /* [n_switch] its mode before that */
  int *shares;       /* [n_switch] 1: contacts or joints hold it at zero, whatever load between both branches acts */
  int *repels;       /* [n_switch] 1: it is zero, and may leave it or not: the motion is not unique */
  int is_unresolved; /* 1: no branches were found on which the run can go on */
  int is_literal;    /* 1: loads are evaluated as they are written, without branches */
} mg_switch_workspace;

/* What sensors show the bodies, contacts and joints of. */
typedef struct {
  mg_real *acceleration; /* [6 n_body] rates of the twists; NaN in time-stepping, which has none */
  mg_real *pair;         /* [2 n_pair] least gap, m; sum of the normal forces, N */
  mg_real *joint;        /* [6 n_joint] wrench on the second body */
} mg_sensor_workspace;

/* Numbers of rows and states. */
typedef struct {
  int joint_row_begin;            /* first row of joints */
  int joint_row_end;              /* row after the last of joints */
  int friction_row_begin;         /* first friction row */
  int friction_row_end;           /* row after the last friction row */
  int spring_row_begin;           /* first row of springs */
  int spring_row_end;             /* row after the last of springs: number of all rows */
  int limit_pair_begin;           /* pairs from here on are those of limits, which have no shapes */
  int limit_begin;                /* contacts from here on are limits, then support points of patches */
  int support_begin;              /* contacts from here on are support points of patches */
  int support_feature_pair_begin; /* feature pairs from here on are those of support points */
  int n_states;                   /* length of x */
  int work_state;                 /* index of the work in x */
  int n_live_states;              /* length of x without the eta of contacts on no feature pair */
  int n_driven;                   /* bodies with prescribed motion */
  int n_moving;                   /* bodies that forces move */
  int has_prescribed_joint;       /* 1: a joint has a prescribed motion */
  int n_timed;                    /* functions of time */
  int n_state_loads;              /* loads that depend on the state */
  int n_steady_loads;             /* loads that depend on the state and not on time */
} mg_layout;

/* Bodies at the state evaluated last. */
typedef struct {
  int *motion;           /* [per body] MG_FIXED .. MG_FREE */
  mg_real *pose;         /* [12 per body] position of the centre of mass, m, and rotation matrix by columns */
  mg_real *twist;        /* [6 per body] velocity, world axes, m/s, and angular velocity, body axes, rad/s */
  mg_real *acceleration; /* [6 per body] rate of the twist; without contact forces until those are found */
  mg_real *quaternion;   /* [4 per body] of a free body, as its state has it; where loads have switching functions */
  mg_real *wrench;       /* [6 per body] force, world axes, N, and torque, body axes, N m; also changes of the twist */
} mg_body_workspace;

/* Rows of constraints at the state evaluated last. */
typedef struct {
  mg_real *J;           /* [12 per row] J */
  mg_real *MJ;          /* [12 per row] M^-1 J^T */
  mg_real *d;           /* [per row] gap or joint error, m or rad */
  mg_real *gamma;       /* [per row] velocity term of the second derivative of d: Gamma1, Gamma2 */
  mg_real *d_dot;       /* [per row] first derivative of d; of friction rows slip, spin, rolling velocity */
  mg_real *time_rate;   /* [per row] partial derivative of d by time */
  mg_real *row_rate;    /* [per row] second derivative of d, or the velocity sought in an impact or correction */
  mg_real *normal;      /* [3 per contact] N */
  mg_real *tangents;    /* [6 per contact] t1, t2 */
  mg_real *eta_dot;     /* [n_eta] rate of eta */
  mg_real *kernel_rows; /* rows of one contact as its kernel writes them: J_o and J_f (36 each), gamma (6) */
} mg_row_workspace;

/* Solution of the rows. */
typedef struct {
  mg_real *force;      /* [per row] N or N m */
  mg_real *impulse;    /* [per row] N s or N m s */
  mg_real least_pivot; /* c->lcp.least_pivot of the last right-hand side by the kernels of the kinds; 0: none yet */
} mg_row_solution;

#ifdef MG_DEBUG
/* Parts of the context whose states a debug core keeps: time, positions, velocities and modes at which they are valid.
 */
enum {
  MG_VALID_POSES,      /* poses, at t and positions */
  MG_VALID_TWISTS,     /* twists, at velocities as well */
  MG_VALID_FREE,       /* accelerations, without those by forces of constraints or with them */
  MG_VALID_JOINT_ROWS, /* rows of joints */
  MG_VALID_ROWS,       /* rows of contacts */
  MG_VALID_RATES,      /* d_dot */
  MG_VALID_SLIP,       /* d_dot of friction rows */
  MG_VALID_GAPS,       /* d of contacts, at the poses */
  MG_VALID_KEPT_GAPS,  /* c->events.gap_before */
  MG_VALID_GAP_MINIMA, /* c->events.gap_dips, at the end of the part looked at */
  MG_VALID_MARGINS,    /* the first sample of c->events.margins */
  MG_VALID_SENSORS,    /* c->sensors */
  MG_VALID_SOLUTION,   /* forces, at any modes */
  MG_VALID_FORCES,     /* forces, at the modes as well */
  MG_VALID_SLOPE,      /* row 0 of c->step.slopes */
  MG_VALID_END_SLOPE,  /* its row at the end of a step */
  MG_VALID_WRENCHES,   /* wrenches of loads and forces, of derivatives */
  /* From here on digests of something else than a state. */
  MG_VALID_PLACEMENT,     /* c->search.placement, at eta (mg_placement_digest) */
  MG_VALID_PLACED,        /* the same, at any eta */
  MG_VALID_INTERPOLANT,   /* c->step.interpolant (mg_step_digest) */
  MG_VALID_STEP_GEOMETRY, /* what mg_set_step_geometry leaves (mg_step_digest) */
  MG_VALID_STEP_IMPULSES, /* impulses of a step of time-stepping, in c->solution.force (mg_step_digest) */
  MG_VALID_YIELDING,      /* c->friction.is_yielding of that step */
  MG_VALID_MARKS,         /* c->friction.marks of a solution (mg_solution_digest) */
  MG_VALID_IMPULSES,      /* impulses of an impact, in c->lcp.z (mg_impulse_digest) */
  MG_VALID_SYMMETRIC,     /* the symmetric matrix in c->lcp.work (mg_kept_rows_digest) */
  MG_VALID_KINDS
};

/* The states at which they were evaluated: digests, 0: not at all. */
typedef struct {
  mg_real t; /* time of the poses */
  mg_digest of[MG_VALID_KINDS];
} mg_validity;
#endif

/* Kind and bodies of each contact, from its feature pair. */
typedef struct {
  int *kind;                                     /* [per row] contact kind */
  int *o, *f;                                    /* [per row] bodies o and f; of joint rows bodies a and b */
  int *is_inertial;                              /* [per row] 1: a row of armature (model/joint_rows.c) */
  int *n_eta;                                    /* [per contact] length of eta; 0 on no feature pair */
  int *parameters;                               /* [per contact] offset into parameters */
  mg_real *length;                               /* [per contact] length of its pair, m */
  mg_real point_parameters[MG_POINT_PARAMETERS]; /* parameters of the support point looked at last */
} mg_contact_view;

/* The context. The first four are the caller's. */
struct mg_context {
  const mg_system *system;
  const mg_kernels *kernels;
  const mg_settings *settings;
  mg_run *run;
  mg_layout layout;
  mg_listing listed;
  mg_body_workspace bodies;
  mg_row_workspace rows;
  mg_row_solution solution;
  mg_contact_view contacts;
  mg_lcp_workspace lcp;
  mg_island_workspace islands;
  mg_joint_workspace joints;
  mg_spring_workspace springs;
  mg_friction_workspace friction;
  mg_patch_workspace patches;
  mg_search_workspace search;
  mg_step_workspace step;
  mg_event_workspace events;
  mg_switch_workspace switches;
  mg_sensor_workspace sensors;
#ifdef MG_DEBUG
  mg_validity valid;
#endif
};

/* Two shapes of a contact kind at given poses. */
typedef struct {
  const mg_kernels *kernels;                   /* kernels of the library */
  int kind;                                    /* contact kind */
  const mg_real *pose_o, *pose_f, *parameters; /* poses of the bodies; parameters of the kind */
} mg_shape_pair;

/* Goal and limits of Newton's method on the extremality equations. */
typedef struct {
  mg_real length;            /* length to which tolerance refers, m */
  mg_real tolerance;         /* the residual is to be below tolerance * length (lengths), tolerance (angles) */
  const mg_real *step_limit; /* [n_eta] bound of the change of each entry of eta in one step; MG_MAX: a sign */
} mg_newton_goal;

/* Separation of two convex shapes along a normal, as contact_seek gives it. */
typedef struct {
  mg_real normal[3];   /* unit normal */
  mg_real d;           /* separation, m */
  mg_real slope[2];    /* its slope on the sphere of normals, m */
  mg_real hessian[3];  /* minus its second derivative: 11, 12, 22, m */
  mg_real tangents[6]; /* tangents of the sphere at the normal */
  mg_real eta[6];      /* support points of both shapes, in their axes, m */
} mg_separation_view;

#endif
