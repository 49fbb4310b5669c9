/* Contact dynamics of smooth bodies: the part that runs.

   A program fills an mg_system (the bodies, contacts and loads of one scene, as tables over the kinds that this
   library was generated with), an mg_settings, an mg_run (the state), gives scratch memory, and calls mg_begin
   once and mg_advance until it answers MG_DONE. Nothing here allocates, prints or keeps static state.

   Units are SI. Vectors are in world axes except angular velocities and torques, which are in body axes.
   The state is x = [q of all bodies, u of all bodies, eta of all contacts, work]. */
#ifndef MODELGEN_H
#define MODELGEN_H

#include "lcp.h"
#include "real.h"

#define MG_ABI 1

typedef struct {
  int n_body, n_contact, n_load;
  int n_q, n_u, n_eta;
  int n_closed; /* room for so many closed contacts at a time; memory grows with its square */
  const int *body_kind, *body_q, *body_u, *body_parameters; /* kind; offsets into q, u, parameters */
  const int *contact_kind, *contact_o, *contact_f, *contact_eta, *contact_parameters;
  const int *load_kind, *load_a, *load_b, *load_parameters; /* load_b: -1 for a load on one body */
  const mg_real *mass_inverse; /* 10 a body: 1/m and the inverse inertia, column-major, body axes */
  const mg_real *restitution;  /* one a contact, 0..1 */
  const mg_real *parameters;
  const mg_real *scale;        /* one a state: the size against which its error is measured */
  mg_real gravity[3];
  mg_real length, mass, time;  /* characteristic scales; tolerances below are relative to them */
} mg_system;

enum { MG_RK4 = 0, MG_DOP853 = 1 };

typedef struct {
  int method;             /* MG_RK4 or MG_DOP853 */
  int use_gamma;          /* 0 drops Gamma2: what engines that omit it integrate */
  int newton;             /* corrections of eta: 0 none, 1 once an accepted step, 2 also at every stage */
  int project;            /* 0 lets d and d_dot drift; n > 0 removes the drift every n accepted steps */
  mg_real step;           /* s: RK4's step; DOP853's first step (0: chosen) */
  mg_real tolerance;      /* DOP853: local error / scale, root mean square */
  mg_real gap;            /* |d| <= gap * length counts as touching */
  mg_real start_gap;      /* the same for the given start; deeper penetration is refused */
  mg_real drift;          /* d beyond drift * length (d_dot: / time) is projected away */
  mg_real rest_speed;     /* approach below rest_speed * length / time is caught without bounce */
  mg_real rest_acceleration; /* separation below rest_acceleration * length / time^2 does not open a contact */
  mg_real event;          /* an event is located to event * time */
  mg_real residual;       /* extremality residual (length, 1) to which eta is brought at the start */
  mg_real step_min;       /* a step below step_min * time ends the run */
  mg_real margin_refuse;  /* a closed contact whose margin falls below it ends the run */
  int lcp_iterations;     /* bound on the active-set changes of one complementarity problem */
  int events_at_once;     /* transitions within one event tolerance of time before the run gives up */
} mg_settings;

enum { MG_DONE = 0, MG_CONTINUE = 1, MG_FULL = 2,      /* t_stop reached; step limit; record or event list full */
       MG_PENETRATION = 10, MG_NO_EXTREMUM = 11,       /* the start is refused */
       MG_MARGIN = 20, MG_STEP_TOO_SMALL = 21, MG_NOT_FINITE = 22, MG_COMPLEMENTARITY = 23, MG_TOO_MANY_EVENTS = 24,
       MG_TOO_MANY_CLOSED = 25 };

enum { MG_EVENT_IMPACT = 0, MG_EVENT_TOUCH_DOWN = 1, MG_EVENT_LIFT_OFF = 2, MG_EVENT_MARGIN = 3 };

typedef struct {
  mg_real t, h;           /* time and the next step to try, s */
  mg_real *x;             /* n_q + n_u + n_eta + 1 */
  int *closed;            /* per contact: its gap is held at zero */
  int *active;            /* per contact: closed and carrying force */
  mg_real *force;         /* per contact, N, at t */
  mg_real *margin;        /* per contact, at t */
  long steps, rejected, rhs_evals, lcp_solves, since_projection, events_at_t;
  long redundant_max;     /* most active contacts beyond the rank of their rows: forces then are of minimum norm */
  mg_real t_event;        /* time of the last transition */
  mg_real energy_0, energy_error_max, kinetic_max; /* J; error = |E - E_0 - work| */
  mg_real gap_max, complementarity_max, margin_min, lcp_residual_max;
  int failed_contact;     /* the contact an outcome speaks of, or -1 */
} mg_run;

typedef struct {          /* caller's arrays for the samples; t is given, count advances */
  int capacity, count;
  const mg_real *t;
  mg_real *pose, *twist;  /* 12 and 6 a body */
  mg_real *eta, *force, *gap, *normal, *point_o, *point_f; /* n_eta; per contact 1, 1, 3, 3, 3 */
  mg_real *energy, *work;
} mg_record;

typedef struct {
  int capacity, count;
  mg_real *t;
  int *kind, *contact;
  mg_real *speed;         /* approach speed of an impact or touch-down, m/s, else 0 */
} mg_events;

MG_API int mg_abi(void);
MG_API const char *mg_hash(void);
MG_API int mg_real_size(void);
MG_API long mg_work_size(const mg_system *system);   /* in mg_real */
MG_API long mg_iwork_size(const mg_system *system);  /* in int */

/* Brings eta to the extremum, decides which contacts are closed, takes first impacts. */
MG_API int mg_begin(const mg_system *system, const mg_settings *settings, mg_run *run, mg_events *events,
                    mg_real *work, int *iwork);

/* Runs to t_stop or for max_steps accepted steps. MG_FULL: empty the lists and call again. */
MG_API int mg_advance(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real t_stop,
                      long max_steps, mg_record *record, mg_events *events, mg_real *work, int *iwork);

/* n independent runs from their own starts to t_stop; outcome (n) holds their codes. `events` is scratch. */
MG_API void mg_batch(const mg_system *system, const mg_settings *settings, int n, mg_run *runs, mg_real t_stop,
                     int *outcome, mg_events *events, mg_real *work, int *iwork);

/* n steps of RK4 without event search, projection or ledger: the smooth part alone. */
MG_API void mg_smooth(const mg_system *system, const mg_settings *settings, mg_run *run, long n, mg_real *work,
                      int *iwork);

/* The right-hand side at (t, x) with the run's active set; x_dot has the length of x. */
MG_API void mg_evaluate(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real t,
                        const mg_real *x, mg_real *x_dot, mg_real *work, int *iwork);

/* The poses of all bodies at the run's state, 12 a body. */
MG_API void mg_pose_all(const mg_system *system, const mg_settings *settings, mg_run *run, mg_real *pose, mg_real *work,
                        int *iwork);

/* Newton from the given eta of one contact until its residual is below settings->residual or 50 steps are
   taken. Returns the number of steps, or -1. d, margin, normal, points as the place kernel gives them. */
MG_API int mg_settle(const mg_system *system, const mg_settings *settings, const mg_run *run, int contact, mg_real *eta,
                     mg_real *d, mg_real *residual, mg_real *margin, mg_real *normal, mg_real *point_o,
                     mg_real *point_f, mg_real *work, int *iwork);

#endif
