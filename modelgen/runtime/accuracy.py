"""The tolerances and solver choices of a run, in one record.

Tolerances are dimensionless: lengths are divided by the model's characteristic length L, times by its
characteristic time T.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cache, lru_cache
from math import sqrt
from types import MappingProxyType
from typing import Any, Literal, get_args

from modelgen.errors import SimulationError
from modelgen.runtime.arguments import check_flag, check_name, check_step, is_number, shown

Method = Literal["dop853", "rk4", "time-stepping"]
Scheme = Literal["stewart-trinkle", "anitescu-potra", "moreau"]
Solver = Literal["coulomb", "relaxation"]
Impacts = Literal["simultaneous", "sequential"]

# Smallest useful tolerances of a real type, in multiples of its epsilon. Only in `float` are they larger than
# those of `fast`, `balanced` or `tight`.
RESOLVED: Mapping[str, int] = MappingProxyType(
    {
        **{
            "tolerance": 8,
            "contact_gap": 16,
            "start_gap": 64,
            "start_joint_gap": 64,
            "drift_tolerance": 4,
            "rest_speed": 16,
        },
        **{
            "slip_speed": 64,
            "friction_bound_margin": 64,
            "rest_acceleration": 64,
            "event_tolerance": 8,
            "extremality_residual": 64,
            "step_min": 8,
        },
        **{
            "joint_rank_tolerance": 4096,
            "search_margin": 8,
            "search_merge_distance": 4096,
            "feature_border": 512,
            "flat_angle": 2048,
            "boundary_coincidence": 256,
        },
        "contact_rank_tolerance": 4096,
    }
)

SLOWEST = 1e-7  # L/T: least `rest_speed`; slower bounces are lost in rounding
FINER = 10.0  # ratio of the tolerances of a run to those of its companion
SLOWER = 1000.0  # ratio of `rest_speed` and `slip_speed`, on which bouncing and sticking depend irregularly
COARSER = 1.5  # ratio of the companion's tolerance where the real type resolves no finer one
TENTH = 10.0**-0.125  # ratio of steps at which an error of order 8 is a tenth

# Derivatives of tables by a parameter, from differences whose steps are halved and extrapolated
RELATIVE_STEP = 1e-2  # longest step, of the numbers that move
TABLE_ERROR = 1e-9  # they hold if the last extrapolation changes them by no more than this times their size
TABLE_BEND = 1e-6  # of that size: difference of both sides that is a kink if it does not shrink with the step

RUN_DIFFERENCE = (
    1e-6  # a derivative agrees with a difference of runs up to this times its size, and its error
)

SHARED = 32  # epsilons of their size within which boundaries of two planar regions coincide

CHOICES = ("impacts", "newton", "project", "use_gamma")  # keys of a scene's [run] that override the record


@dataclass(frozen=True, slots=True)
class Accuracy:
    """All tolerances of a run and its choices of method. Make one with `fast`, `balanced`, `tight` or `of`.

    L, T and M are the characteristic length, time and mass of the model, which `check` prints. P is the
    length of a pair of shapes: the smaller radius of the balls around them, at least L. Tolerances are
    dimensionless unless a unit is given.

    Attributes:
        name: name of the record in results.
        tolerance: local error of an adaptive step: root mean square over the states, in their scales.
        method: "dop853" (adaptive, order 8), "rk4" (fixed step, order 4) or "time-stepping" (order 1).
        step: s; the fixed step. None: an adaptive run chooses its own first step.
        scheme: scheme of time-stepping; see `time_stepping`.
        solver: friction law of time-stepping; see `time_stepping`.
        stepping_theta: scheme "moreau": fraction of the step after which contacts are detected.
        stepping_tolerance: a solve for the impulses of a time step with friction ends at this residual once
            its iterations no longer halve it: of the largest velocity without contacts at the end of the
            step at most this part is wrong in the velocity of a contact. Solves that converge fast go on to
            rounding. 1e-4 in `fast`, 1e-6 in `balanced`, 1e-9 in `tight`.
        stepping_residual: residual at which impulses are accepted, and the run says so, where no solve
            reaches `stepping_tolerance`.
        fallback: an event-driven run that cannot continue uses time-stepping for a while, and reports it.
        fallback_progress: a run falls back if many tries, a third of them rejected, advance it by less than
            this times T.
        fallback_step: step of time-stepping during a fallback, in T.
        chatter_step: the same where events cost too much, in T.
        chatter_work: work of events, in evaluations of one contact, up to which a run stays event-driven
            though time-stepping costs several times less.
        chatter_closed: a run that left its events for time-stepping does not return while more contacts are
            closed.
        impacts: "simultaneous": impacts at the same time are one problem; "sequential": one by one, the
            fastest first.
        newton: Newton corrections of the contact parameters: 0 none (the differential equations of the paper
            alone), 1 once per accepted step, 2 at every stage as well.
        project: number of steps between projections of the drift; 0 never projects.
        use_gamma: False drops the velocity term Gamma2, as engines that omit it do.
        planar_contacts: a face that rests on another is one planar contact; False: it stands on vertices or
            on points of its rim.
        contact_gap: a contact with |d| up to this times L touches.
        start_gap: the same at t = 0; a deeper penetration is refused.
        start_joint_gap: joints that fit at t = 0 up to this times L are closed; others are refused.
        drift_tolerance: |d| above this times L, or |d_dot| above this times L/T, is projected away.
        rest_speed: an approach faster than this times L/T is an impact; it rebounds if it is 5/4 as fast.
            A load whose jump leads back to a place holds there what passes it slower.
        slip_speed: slip slower than this times L/T (spinning and rolling: 1/T) stops if friction can hold it.
        friction_bound_margin: fraction by which the friction bound of a contact that reached it is lowered.
        rest_acceleration: separation slower than this times L/T^2 does not open a contact.
        event_tolerance: events are located to this times T.
        extremality_residual: residual of the closest-point equations at the start, relative to L and 1.
        step_min: a run ends if its step falls below this times T.
        margin_warn: a closed contact whose margin falls below this is reported. Features of revolution
            closer to coaxial than this and this times L are followed at any margin.
        margin_refuse: a run ends if the margin of a closed contact falls below this.
        slip_stop_speed_ratio: slip stops at an event only if stopping costs less energy than slip at this
            times `slip_speed` has.
        separation_speed_factor: a step is shortened if a loaded contact separates at its end faster than this
            times `tolerance` times its speed or L/T.
        derivative_error_factor: in a run with derivatives, a step is refused where their error in it exceeds
            this times `tolerance`, relative to their size.
        derivative_kink_part: up to the end of a step that was refused so, that bound times this.
        derivative_step_min: steps up to this times T are never refused so.
        load_jump_rate: a load that changes in a step h by more than this times h/T of its size is searched
            for a jump where the motion takes it, past which derivatives are undecided.
        load_jump_span: it jumps if half of its change lies at one place of the motion within this times T.
        rest_loss_factor: a contact held without force opens within a step above this times
            `rest_acceleration`.
        event_correction_step: beyond this fraction of the step, an event is corrected only while the
            corrections converge fast.
        contact_rank_tolerance: a contact row with a smaller independent part of J M^-1 J^T is dependent.
        joint_rank_tolerance: the same of a joint row, as at a dead centre.
        penetration_limit: a run ends where bodies penetrate deeper than this times L; in time-stepping,
            deeper than that and than they move in two steps.
        correction_ratio: a correction of positions, after a step of time-stepping or of drift, moves no body
            farther than this times the penetration, gap or joint error that it removes, and `contact_gap` L:
            sqrt(dx^2 + da I da / m) <= correction_ratio d + contact_gap L, with the movement dx of the centre
            of mass, the turn da, inertia I and mass m. One contact alone moves no body farther than d. A
            longer correction is not made, and what remains is judged.
        appear_depth: deepest penetration, in P, of a contact that is found during a run.
        event_scan_parts: number of parts of a step that are searched for the first event.
        appear_margin: least margin of a contact that is found during a run.
        appear_tilt_sine: sine of the largest angle by which an adjacent edge or face may point beyond the
            face that a vertex or edge is found above.
        lcp_iterations: bound on the active-set changes of one complementarity problem.
        events_at_once_max: bound on the transitions at one time.
        search_margin: a search for closest points drops results with a smaller margin; a ball whose centre is
            within this times L of the axis of a ring touches three parts of it.
        search_merge_distance: closest points nearer to each other than this times P are one.
        search_gap: a search follows contacts with gaps up to this times P.
        search_movement: a pair that can touch more than once is searched again after moving by this times
            the smaller radius of the balls around its shapes, or times P if that is less or the ball is a
            point.
        flat_angle: rad; a rim closer to a plane than this angle stands on three of its points, and so does
            what is closer to coaxial with another body than this and this times L.
        parallel_angle: rad; straight sides and edges closer to parallel than this are held at both ends of
            their line of contact: in event-driven runs where they are too nearly parallel (search_margin) to
            be followed between its ends.
        imaginary_edge: rad; if positive, a face turns over a smooth rim about a tangent fixed in the body up
            to this angle (section 5.3), before it rolls on the rim.
        boundary_coincidence: boundaries of two faces nearer to each other than this times L coincide.
        feature_border: rad, or in L: a contact changes its feature this far beyond the border.
        time_resolution: changes of loads, given motions and paths within this times T may be missed.
        step_fraction: bound on the step, as a fraction of the longest step in which no event can be missed.
        flush_height: shapes that are fixed together join where they are flush within this times L, by the
            value in the scene's [run]. A run is not trusted if a body struck another from the side at a point
            within this times L of the plane of a face of each.
        companion_cost: the companion stops, and the run is not trusted, where its steps, with those that were
            rejected, exceed this times those of the run, and 100.
        prediction_error_max: rad, or in L: above this estimated error nothing is predicted.
        gap_error_max: a run is not trusted if the gap of a closed contact, or a penetration, exceeded this
            times L.
        energy_error_max: a run is not trusted if its energy drift and the energy of corrections of positions,
            added, exceed this, and what rounding explains: (steps + 1) eps (|E_0| + largest kinetic energy +
            M L^2/T^2). The same if an impact adds more energy than this times the largest kinetic energy, as
            Newton's restitution with friction may.
        complementarity_error_max: a run is not trusted if min(gap/L, force/(M L/T^2)) of a contact exceeds
            this in size: forces that pull, or that act across a gap.
        overlap_depth: two shapes that no contact lists have passed through each other where a point of both
            lies deeper in them than this times the radius of the smaller one's ball.
    """

    name: str = "balanced"
    tolerance: float = 2e-11
    method: Method = "dop853"
    step: float | None = None
    scheme: Scheme = "stewart-trinkle"
    solver: Solver = "coulomb"
    stepping_theta: float = 0.5
    stepping_tolerance: float = 1e-6
    stepping_residual: float = 1e-2
    fallback: bool = True
    fallback_step: float = 1e-4
    fallback_progress: float = 1e-2
    chatter_step: float = 1e-2
    chatter_work: float = 2e7
    chatter_closed: int = 100
    impacts: Impacts = "simultaneous"
    newton: Literal[0, 1, 2] = 1
    project: int = 1
    use_gamma: bool = True
    planar_contacts: bool = True
    contact_gap: float = 1e-10
    start_gap: float = 1e-8
    start_joint_gap: float = 1e-6
    drift_tolerance: float = 1e-15
    rest_speed: float = 1e-6
    slip_speed: float = 1e-7
    friction_bound_margin: float = 1e-9
    rest_acceleration: float = 1e-10
    event_tolerance: float = 1e-13
    extremality_residual: float = 1e-13
    step_min: float = 1e-13
    margin_warn: float = 1e-3
    margin_refuse: float = 1e-5
    appear_margin: float = 2e-5
    appear_tilt_sine: float = 0.5
    slip_stop_speed_ratio: float = 100.0
    separation_speed_factor: float = 1e3
    derivative_error_factor: float = 100.0
    derivative_kink_part: float = 1e-3
    derivative_step_min: float = 1e-9
    load_jump_rate: float = 50.0
    load_jump_span: float = 1e-6
    rest_loss_factor: float = 100.0
    event_correction_step: float = 1e-3
    contact_rank_tolerance: float = 2e-10
    joint_rank_tolerance: float = 1e-8
    penetration_limit: float = 1e-6
    correction_ratio: float = 100.0
    appear_depth: float = 0.02
    event_scan_parts: int = 16
    lcp_iterations: int = 200
    events_at_once_max: int = 100
    search_margin: float = 1e-9
    search_merge_distance: float = 1e-6
    search_gap: float = 0.2
    search_movement: float = 0.05
    flat_angle: float = 2e-5
    parallel_angle: float = 1e-3
    imaginary_edge: float = 0.0
    boundary_coincidence: float = 1e-13
    feature_border: float = 1e-9
    time_resolution: float = 0.05
    step_fraction: float = 1.0
    flush_height: float = 1e-8
    companion_cost: float = 10.0
    prediction_error_max: float = 1e-2
    gap_error_max: float = 1e-9
    energy_error_max: float = 1e-6
    complementarity_error_max: float = 1e-6
    overlap_depth: float = 1e-4

    def __post_init__(self) -> None:
        for name, kind in _types_of_fields():
            _check_type(name, getattr(self, name), kind)

    @classmethod
    def fast(cls) -> Accuracy:
        """Fast, for a first look: error below 3e-4 L in nine of ten shipped scenes, below 1e-5 L in half of
        them."""
        return cls(
            name="fast",
            tolerance=1e-6,
            stepping_tolerance=1e-4,
            drift_tolerance=1e-12,
            rest_speed=1e-5,
            slip_speed=1e-5,
            rest_acceleration=1e-7,
            event_tolerance=1e-9,
            gap_error_max=1e-6,
            energy_error_max=1e-3,
            complementarity_error_max=1e-3,
        )

    @classmethod
    def balanced(cls) -> Accuracy:
        """The default: error below 1e-7 L in nine of ten shipped scenes, below 3e-10 L in half of them."""
        return cls()

    @classmethod
    def tight(cls) -> Accuracy:
        """Near rounding: error below 1e-9 L in nine of ten shipped scenes, below 2e-12 L in half of them."""
        return cls(name="tight", tolerance=1e-13, stepping_tolerance=1e-9, rest_speed=SLOWEST)

    @classmethod
    def finest(cls) -> Accuracy:
        """Near the rounding of long double, with equally fine thresholds of rest and slip: for reference
        solutions."""
        return cls(
            name="finest",
            tolerance=1e-17,
            stepping_tolerance=1e-12,
            newton=2,
            drift_tolerance=1e-18,
            rest_speed=1e-9,
            slip_speed=1e-10,
            rest_acceleration=1e-13,
            event_tolerance=1e-16,
            extremality_residual=1e-16,
            time_resolution=1e-3,
        )

    @classmethod
    def of(cls, tolerance: float) -> Accuracy:
        """The balanced record with another tolerance, from 1e-18 to 1e-2; `rest_speed` and `slip_speed`
        follow it."""
        if not is_number(tolerance) or not 1e-18 <= tolerance <= 1e-2:
            raise SimulationError(
                "tolerance",
                f"{tolerance!r}",
                "a number from 1e-18 to 1e-2",
                "choose one within these bounds",
            )
        slip_speed = max(cls().slip_speed, 10 * tolerance)
        rest_speed = min(cls().rest_speed, max(SLOWEST, 1e5 * tolerance))
        return cls(
            name=f"tolerance {tolerance:g}", tolerance=tolerance, slip_speed=slip_speed, rest_speed=rest_speed
        )

    @classmethod
    def named(cls, name: str) -> Accuracy:
        """`fast`, `balanced` or `tight` by name."""
        records = {"fast": cls.fast, "balanced": cls.balanced, "tight": cls.tight}
        check_name("accuracy", name, records)
        return records[name]()

    @classmethod
    def of_run(cls, run: Mapping[str, Any]) -> Accuracy:
        """The record for the `accuracy` or `tolerance` of the [run] of a manifest."""
        return _of_run(run["accuracy"], run.get("tolerance"), run["imaginary_edge"], run["flush_height"])

    @classmethod
    def taken(cls, value: object) -> Accuracy:
        """The record for an argument `accuracy`: itself, or the one of that name."""
        if isinstance(value, Accuracy):
            return value
        if isinstance(value, str):
            return cls.named(value)
        allowed = "an Accuracy, or one of fast, balanced, tight"
        raise SimulationError("accuracy", repr(value), allowed, "write Accuracy.of(...) for a tolerance")

    def choosing(self, run: Mapping[str, Any]) -> Accuracy:
        """The same record with the keys of [run] that are in CHOICES; its name lists them."""
        own = {key: run[key] for key in CHOICES if run.get(key) is not None}
        name = ", ".join([self.name, *(f"{key} {value}" for key, value in own.items())])
        return replace(self, name=name, **own) if own else self

    def fixed_step(self, step: float) -> Accuracy:
        """The same record with RK4 at the given step, s."""
        check_step(step)
        return replace(self, name=f"rk4 {step:g} s", method="rk4", step=step)

    def time_stepping(
        self, step: float, scheme: Scheme = "stewart-trinkle", solver: Solver = "coulomb"
    ) -> Accuracy:
        """The same record with time-stepping: one problem of impulses per step; no events are located.

        Of order 1, for scenes with so many impacts that to locate each costs more than it tells. Penetration
        is pushed out after each step, positions alone (Anitescu and Hart, 2004). Impacts follow Newton's law.

        Args:
            step: s.
            scheme: "stewart-trinkle": a gap may close within a step, d + h d_dot >= 0 (Stewart and Trinkle,
                1996); "anitescu-potra": what touches stops approaching, d_dot >= 0 where d <= 0 (Anitescu and
                Potra, 1997), others penetrate for one step; "moreau": the same at positions half a step ahead
                (Moreau, 1988).
            solver: "coulomb": the exact law. "relaxation": its convex relaxation (Anitescu and Tasora, 2010),
                always solvable, in which a contact that slips at v parts at mu v, or stays at a gap of h mu v
                where "stewart-trinkle" lets the gap close. Slip that begins suddenly makes a body hop.
        """
        check_step(step)
        check_name("scheme", scheme, get_args(Scheme))
        check_name("solver", solver, get_args(Solver))
        name = f"{scheme} {step:g} s" + ("" if solver == "coulomb" else f", {solver}")
        return replace(self, name=name, method="time-stepping", step=step, scheme=scheme, solver=solver)

    def companion(self, epsilon: float) -> Accuracy:
        """The record of the companion run, whose error is much smaller, or at least independent.

        What decides when a contact rests, sticks or opens is finer too, though not so fine that rounding
        decides it, and drift is removed at every step, so that their part in the error shows.
        """
        least = RESOLVED["tolerance"] * epsilon
        tolerance = max(self.tolerance, least)
        keys = (
            *("rest_acceleration", "event_tolerance", "contact_gap", "friction_bound_margin"),
            *("feature_border", "time_resolution", "stepping_tolerance"),
        )
        finer = {key: getattr(self, key) / FINER for key in keys}
        for key in ("rest_speed", "slip_speed"):
            value = getattr(self, key)
            finer[key] = max(value / SLOWER, min(value / FINER, sqrt(epsilon)))
        return replace(
            self,
            name=f"{self.name}, companion",
            tolerance=tolerance / FINER if tolerance >= FINER * least else tolerance * COARSER,
            step=self.step and self.step * TENTH,
            fallback_step=self.fallback_step * TENTH,
            chatter_step=self.chatter_step * TENTH,
            step_fraction=self.step_fraction * TENTH,
            project=1,
            flat_angle=max(self.flat_angle / 2, RESOLVED["flat_angle"] * epsilon),
            **finer,
        )


@lru_cache(maxsize=64)
def _of_run(name: str, tolerance: float | None, imaginary_edge: float, flush_height: float) -> Accuracy:
    base = Accuracy.named(name) if tolerance is None else Accuracy.of(tolerance)
    return replace(base, imaginary_edge=imaginary_edge, flush_height=flush_height)


NAMES = {"Method": Method, "Scheme": Scheme, "Solver": Solver, "Impacts": Impacts}  # types of fields


@cache
def _types_of_fields() -> tuple[tuple[str, str], ...]:
    return tuple((each.name, str(each.type)) for each in fields(Accuracy))


def _check_type(name: str, value: Any, kind: str) -> None:
    """Raises SimulationError for a value of a field that is not of its type; numbers are 0 or more."""
    if kind in NAMES:
        check_name(name, value, get_args(NAMES[kind]))
    elif kind == "bool":
        check_flag(name, value)
    elif kind == "float | None":
        if value is not None:
            check_step(value, name)
    elif kind != "str" and not (is_number(value) and value >= 0):
        raise SimulationError(name, shown(value), "a number from 0 on", "change it, or leave it out")
