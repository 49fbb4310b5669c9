"""Faults of one line that the tests must see: what each is about, where its text stands, which tests look."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Fault:
    """`old`, a regular expression, stands once in all of modelgen; `new` takes its place (as in re.sub)."""

    subject: str
    what: str
    old: str
    new: str
    tests: tuple[str, ...]  # arguments of pytest


COEFFICIENTS = ("tests/core/test_coefficients.py",)
ONE_CONTACT = ("tests/core/test_one_contact.py",)
STEPPING = ("tests/oracles/friction/test_time_stepping.py",)
SPRINGS = ("tests/oracles/test_stepping_springs.py",)
RUBBING = ("tests/core/test_rubbing_laws.py",)
BLOWS = ("tests/oracles/friction/test_blow_laws.py", "tests/oracles/friction/test_impact.py")
CLOSEST = ("tests/oracles/test_closest_features.py", "tests/laws/test_distance_minima.py")
JOINTS = ("tests/joints",)
DERIVATIVES = ("tests/sensitivity/test_closed_forms.py", "tests/sensitivity/test_symplectic.py")

FAULTS = (
    Fault(
        "contact forms",
        "a term of Gamma2 of a curve on a surface has the wrong sign",
        r"at\.system\.e, turn\) - dot\(turn_f, slip_f\)",
        "at.system.e, turn) + dot(turn_f, slip_f)",
        ("tests/curves",),
    ),
    Fault(
        "contact forms",
        "the distance counts with the wrong sign in the rates of Theorem 4.1",
        r"K_t \+ at\.d \* ca\.mtimes\(K_f, K_t\)",
        "K_t - at.d * ca.mtimes(K_f, K_t)",
        ("tests/laws",),
    ),
    Fault(
        "contact forms",
        "the centripetal acceleration of o has the sign of the print",
        r" - cross\(w_o, cross\(w_o, at\.r_o\) \+ slide_o\)",
        " + cross(w_o, cross(w_o, at.r_o) + slide_o)",
        ("tests/laws",),
    ),
    Fault(
        "contact forms",
        "the lever of f is that of o",
        r"(ca\.mtimes\(pair\.f\.rotation\.T, cross\()at\.r_f, N",
        r"\1at.r_o, N",
        ("tests/laws",),
    ),
    Fault(
        "contact forms",
        "Newton's step for two curves has the wrong sign of a curvature",
        r"size_o - dot\(at\.bend_o, between\)",
        "size_o + dot(at.bend_o, between)",
        ("tests/curves",),
    ),
    Fault(
        "joints",
        "Gamma1 is off by 1e-6",
        r"gamma=curved \+",
        "gamma=0.999999 * curved +",
        JOINTS,
    ),
    Fault(
        "joints",
        "one turn of a mesh counts twice",
        r"numbers\[1\] \* turns\[1\]",
        "2 * numbers[1] * turns[1]",
        JOINTS,
    ),
    Fault(
        "joints",
        "a damper pushes the other way",
        r"spring\) - damping \* rate",
        "spring) + damping * rate",
        (*JOINTS, "tests/oracles/test_loads.py"),
    ),
    Fault(
        "projection",
        "a turn of a quaternion has one wrong sign",
        r"q3 \+ q0 \* z \+ q1 \* y - q2 \* x",
        "q3 + q0 * z - q1 * y - q2 * x",
        ("tests/core/test_small_rotations.py",),
    ),
    Fault(
        "projection",
        "velocities are not brought onto their constraints",
        r"(\(c, c->rows\.d_dot\)) > drift / c->system->time\)",
        r"\1 > 1e9 * drift / c->system->time)",
        ("tests/joints/test_starts.py",),
    ),
    Fault(
        "integrator coefficients",
        "a coefficient of the interpolant of DOP853 is off by 2e-9",
        "0.24228349177525818288430175319e",
        "0.24228349225982516639e",
        COEFFICIENTS,
    ),
    Fault(
        "integrator coefficients",
        "a coefficient of the interpolant of Radau's collocation is off by 2e-9",
        "54.37443689412861451458371L",
        "54.37443700287748841058371L",
        COEFFICIENTS,
    ),
    Fault(
        "integrator coefficients",
        "the cubic between two steps of RK4 is off by 2e-9",
        r"2 \* delta - h \* \(first \+ last\)(?=;\s*for \(int row = 3)",
        "(2 + (mg_real)4e-9) * delta - h * (first + last)",
        ("tests/oracles/test_dense_output.py",),
    ),
    Fault(
        "integrator coefficients",
        "a stage of DOP853 is off by 2e-9",
        "6.43392746015763530355970484046e-1L",
        "6.43392747302549022355970484046e-1L",
        COEFFICIENTS,
    ),
    Fault(
        "integrator coefficients",
        "the estimate of order 5 is off by 2e-9",
        "0.1312004499419488073250102996e-1L",
        "0.1312004502043497072250102996e-1L",
        COEFFICIENTS,
    ),
    Fault(
        "friction of one contact",
        "the normal force couples to the tangential one with the wrong sign",
        r"held \? 0 : -s->S\[",
        "held ? 0 : s->S[",
        ONE_CONTACT,
    ),
    Fault(
        "friction of one contact",
        "the slip that the normal force makes has the wrong sign",
        r"\+= (s->S\[row \+ i \+ from \* m\] \* d->base)",
        r"-= \1",
        ONE_CONTACT,
    ),
    Fault(
        "time-stepping",
        "velocities of the middle of a step are not advanced",
        r"h / 2, h / 2, c->",
        "h / 2, 0, c->",
        STEPPING,
    ),
    Fault(
        "time-stepping",
        "loads of the middle of a step are those of its start",
        r"(\w+)\(c, t \+ h / 2, c->step\.stage, c->step\.slopes",
        r"\1(c, t, c->step.stage, c->step.slopes",
        STEPPING,
    ),
    Fault(
        "time-stepping",
        "springs do not yield by their own impulse",
        r"A\[r \+ n \* r\] \+= 1",
        "A[r + n * r] += 0",
        SPRINGS,
    ),
    Fault(
        "time-stepping",
        "stiff dampers follow the midpoint rule",
        r"theta = \(3 \+ z\) / \(6 \+ z\);",
        "theta = (3 + 0 * z) / 6;",
        SPRINGS,
    ),
    Fault(
        "limit surface",
        "the search along it ends early",
        r"> 64 \* MG_EPS \* power",
        "> (mg_real)1e-3 * power",
        RUBBING,
    ),
    Fault(
        "limit surface",
        "the twist that limits a force is taken as the force",
        r"(twist\[k\]) /= length",
        r"\1 = unit[k] + 0 * length",
        RUBBING,
    ),
    Fault(
        "impacts",
        "Newton's restitution is off by 1e-6",
        r"c->rows\.d_dot\[i\] \* \(1 \+ (\w+\(c, i\))\)",
        r"c->rows.d_dot[i] * (1 + (mg_real)0.999999 * \1)",
        ("tests/oracles/test_impacts.py", "tests/oracles/test_closed_forms.py"),
    ),
    Fault(
        "impacts",
        "Poisson's restitution of a frictional blow is squared",
        r"b->impulse - \(1 \+ e\) \* compression_end->impulse",
        "b->impulse - (1 + e * e) * compression_end->impulse",
        BLOWS,
    ),
    Fault(
        "search",
        "cells whose normals may be opposed are dropped, the others kept",
        r"surfaces == 2 \? mg_sum_size\(a->direction, b->direction\) > spread",
        "surfaces == 2 ? mg_sum_size(a->direction, b->direction) < spread",
        CLOSEST,
    ),
    Fault(
        "search",
        "the rest of a Taylor polynomial is left out of its bound",
        r"fabs\(third\) \* change \* change \* change / 6",
        "0 * fabs(third) * change",
        ("tests/core/test_taylor_models.py",),
    ),
    Fault(
        "derivatives of runs",
        "saltation is left out: the change of an event's time moves nothing",
        r"dx\[i\] \+= sign \* slope\[i\] \* mg_event_time_dot",
        "dx[i] += 0 * sign * slope[i] * mg_event_time_dot",
        DERIVATIVES,
    ),
    Fault(
        "derivatives of runs",
        "the derivative of the normal at a blow is left out",
        r"mg_blow_rates_tangent\(c, s, direction, dx, 1, b->rate_after_dot\)",
        "mg_blow_rates_tangent(c, s, direction, dx, 0, b->rate_after_dot)",
        DERIVATIVES,
    ),
    Fault(
        "derivatives of runs",
        "the projector of velocities is left out",
        r"mg_add_correction\(c, x, 1, dx\);",
        "mg_add_correction(c, x, 1, s->stage);",
        DERIVATIVES,
    ),
    Fault(
        "derivatives of runs",
        "an impact at the start is not differentiated",
        r"mg_start_blow_tangent\(c, s, given, MG_CONTACTS_STRIKE\)",
        "0 * mg_start_blow_tangent(c, s, given, MG_JOINTS_HOLD)",
        DERIVATIVES,
    ),
    Fault(
        "derivatives of runs",
        "the gap of an event is not that of the direction",
        r"crossing->kind == MG_CROSSES_GAP\) s->event_rate\[j\] = s->at\.value\[contact\]",
        "crossing->kind == MG_CROSSES_GAP) s->event_rate[j] = (mg_real)0.999999 * s->at.value[contact] + "
        "(j == n ? (mg_real)1e-6 * s->at.value[contact] : 0)",
        DERIVATIVES,
    ),
)
