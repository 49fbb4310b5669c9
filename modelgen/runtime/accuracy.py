"""Every tolerance, order and solver choice of a run, in one record.

All tolerances are dimensionless: lengths are measured against the model's characteristic length L, times
against its characteristic time T.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import sqrt
from types import MappingProxyType
from typing import Any, Literal, get_args

from modelgen.errors import SimulationError
from modelgen.runtime.arguments import check_name, check_step, is_number

Method = Literal["dop853", "rk4", "time-stepping"]
Scheme = Literal["stewart-trinkle", "anitescu-potra", "moreau"]
Solver = Literal["coulomb", "relaxation"]
Impacts = Literal["simultaneous", "sequential"]

# What a real type resolves, in multiples of its epsilon: no run takes a finer tolerance. Only `float` is so
# coarse that this raises tolerances of `fast`, `balanced` or `tight`.
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

SLOWEST = 1e-7  # L/T: of bounces at the tightest tolerances; slower ones are lost in rounding
FINER = 10.0  # by which the tolerances of a companion run are finer
SLOWER = 1000.0  # by which its bounds of rest are slower: what hops and stops depends on them irregularly
COARSER = 1.5  # by which its tolerance is coarser where the real type resolves no finer one
TENTH = 10.0**-0.125  # of a step whose error, of order 8, is to be a tenth

SHARED = 32  # boundaries of two planar regions within so many epsilons of their size are one

CHOICES = ("impacts", "newton", "project", "use_gamma")  # that a scene's [run] may make by itself


@dataclass(frozen=True, slots=True)
class Accuracy:
    """What a run may get wrong, and how it works. Make one with `fast`, `balanced`, `tight` or `of`.

    Attributes:
        name: what the record is called in results.
        tolerance: local error of an adaptive step, root mean square over the states, each against its scale.
        method: "dop853" (adaptive, order 8), "rk4" (fixed step, order 4) or "time-stepping" (order 1).
        step: s; the fixed step. Adaptive runs choose their own first step when it is None.
        scheme, solver: of time-stepping, and its law of friction; see `time_stepping`.
        theta: of the scheme "moreau": the part of a step after the positions at which contacts are taken.
        loose: impulses of a step of time-stepping that are found to this residual only will do.
        fallback: an event-driven run that cannot go on does so by time-stepping for a while, and says so.
        crawl: an adaptive run cannot go on that gets on by less than crawl T in many tries, a third refused.
        fallback_step: steps of fallback_step T are taken then.
        impacts: "simultaneous": several blows are one problem; "sequential": one by one, the fastest first.
        newton: corrections of the contact parameters: 0 none (the differential equations of the paper alone),
            1 once per accepted step, 2 at every stage as well.
        project: remove drift off d = 0 and its rate every so many steps; 0 never.
        use_gamma: False drops the velocity term Gamma2, as engines that omit it do.
        planar: a face on another rests as one planar contact; False: on vertices or points of a rim.
        gap, start_gap: |d| <= gap L counts as touching; at t = 0 start_gap L, deeper penetration is refused.
        start_joint: joints that fit at t = 0 to start_joint L are brought together, others refused.
        drift: d beyond drift L, or its rate beyond drift L/T, is projected away.
        rest_speed: an approach above rest_speed L/T counts, above 5/4 of it bounces; no rebound is slower.
        slip_speed: slip below slip_speed L/T sticks if the forces let it; spin, rolling below slip_speed/T.
        cone: a contact whose friction has reached its bound is tried with this part less of it.
        rest_acceleration: separation below rest_acceleration L/T^2 does not open a contact.
        event: an event is located to event T.
        residual: the extremality residual reached at the start, against L and 1.
        step_min: a step below step_min T ends the run.
        margin_warn, margin_refuse: a closed contact with less margin is warned of, or ends the run.
        arrest: slip is stopped only where that takes less energy than a speed of arrest slip_speed L/T has.
        leap: a step is shortened if a loaded contact parts at its end by leap tolerance (its speed, L/T).
        leave: a gap held without force leaves its rest within a step beyond leave times rest_acceleration.
        polish: further steps correct an event beyond this part of the step only while they converge fast.
        dependent: a contact with less than this of its own in J M^-1 J^T is held by the others.
        singular: a row of a joint with less than this of its own is left to the others, as at a dead centre.
        depth: a contact that appears in a run may be below zero by depth L.
        scan: parts of a step in which the first event is sought.
        margin_appear: a contact appears in a run only with more margin than this.
        lean: a vertex or edge over a face is taken up while its own edges and faces lean out less (a sine).
        lcp_iterations: bound on the active-set changes of one complementarity problem.
        events_at_once: transitions at one time before the run gives up.
        lost: a search for the closest points keeps a start only if its margin exceeds this.
        apart: closest points nearer to each other than apart L are one.
        reach: contacts that appear in a run are followed from gaps below reach L.
        search: a pair that can touch more than once is searched anew when it has moved by search L.
        flat: a rim within this angle (rad) of lying on a plane stands on three points of it.
        imaginary_edge: rad; if positive, a face turns over a smooth rim on a tangent fixed in the body
            until it leans so far (section 5.3), instead of rolling on the rim at once.
        shared: boundaries of two faces nearer to each other than shared L are one.
        border: a contact leaves its feature beyond border, in rad, or in L.
        look: what loads, given motions and driven bodies do within look T may pass unseen.
        stride: no step is longer than this part of the longest in which nothing can pass unseen.
        predictable: where the estimated error exceeds predictable L, or rad, nothing is predicted.
    """

    name: str = "balanced"
    tolerance: float = 2e-11
    method: Method = "dop853"
    step: float | None = None
    scheme: Scheme = "stewart-trinkle"
    solver: Solver = "coulomb"
    stepping_theta: float = 0.5
    stepping_residual: float = 1e-2
    fallback: bool = True
    fallback_step: float = 1e-4
    fallback_progress: float = 1e-2
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
    appear_margin: float = 1e-4
    appear_tilt_sine: float = 0.5
    slip_stop_speed_ratio: float = 100.0
    separation_speed_factor: float = 1e3
    rest_loss_factor: float = 100.0
    event_correction_step: float = 1e-3
    contact_rank_tolerance: float = 2e-10
    joint_rank_tolerance: float = 1e-8
    appear_depth: float = 0.02
    event_scan_parts: int = 16
    lcp_iterations: int = 200
    events_at_once_max: int = 100
    search_margin: float = 1e-9
    search_merge_distance: float = 1e-6
    search_gap: float = 0.2
    search_movement: float = 0.05
    flat_angle: float = 2e-5
    imaginary_edge: float = 0.0
    boundary_coincidence: float = 1e-13
    feature_border: float = 1e-9
    time_resolution: float = 0.05
    step_fraction: float = 1.0
    prediction_error_max: float = 1e-2

    def __post_init__(self) -> None:
        check_name("method", self.method, get_args(Method))
        if self.step is not None:
            check_step(self.step)

    @classmethod
    def fast(cls) -> Accuracy:
        """For looking at a scene: error below 3e-4 of the length in nine of ten shipped scenes, half 1e-5."""
        return cls(
            name="fast",
            tolerance=1e-6,
            drift_tolerance=1e-12,
            rest_speed=1e-5,
            slip_speed=1e-5,
            rest_acceleration=1e-7,
            event_tolerance=1e-9,
        )

    @classmethod
    def balanced(cls) -> Accuracy:
        """The default: error below 1e-7 in nine of ten shipped scenes, half 3e-10."""
        return cls()

    @classmethod
    def tight(cls) -> Accuracy:
        """Close to the rounding of double precision: below 1e-9 in nine of ten shipped scenes, half 2e-12."""
        return cls(name="tight", tolerance=1e-13, rest_speed=SLOWEST)

    @classmethod
    def finest(cls) -> Accuracy:
        """Close to the rounding of long double, thresholds of rest and slip included: for references."""
        return cls(
            name="finest",
            tolerance=1e-17,
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
        """The balanced record with a tolerance of the user's own, within 1e-18 .. 1e-2; the speeds at which
        bounces end and slip begins go with it."""
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
        """The record that a run's accuracy or tolerance names, as they stand in a manifest."""
        tolerance = run.get("tolerance")
        base = cls.named(run["accuracy"]) if tolerance is None else cls.of(tolerance)
        return replace(base, imaginary_edge=run["imaginary_edge"])

    @classmethod
    def taken(cls, value: object) -> Accuracy:
        """The record that a caller gave, as such or by its name."""
        if isinstance(value, Accuracy):
            return value
        if isinstance(value, str):
            return cls.named(value)
        allowed = "an Accuracy, or one of fast, balanced, tight"
        raise SimulationError("accuracy", repr(value), allowed, "write Accuracy.of(...) for a tolerance")

    def choosing(self, run: Mapping[str, Any]) -> Accuracy:
        """The same record with a run's own newton, project and use_gamma, and their names behind its own."""
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
        """The same record with time-stepping: one problem of impulses a step, no events located.

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
        """A record whose run errs by much less, or otherwise, where the real type resolves `epsilon`.

        What decides when a contact rests, sticks or opens is finer too, though not so fine that rounding
        decides it, and drift is removed at every step, so that their part in the error shows.
        """
        least = RESOLVED["tolerance"] * epsilon
        tolerance = max(self.tolerance, least)
        keys = (
            *("rest_acceleration", "event_tolerance", "contact_gap", "friction_bound_margin"),
            *("feature_border", "time_resolution"),
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
            step_fraction=self.step_fraction * TENTH,
            project=1,
            flat_angle=max(self.flat_angle / 2, RESOLVED["flat_angle"] * epsilon),
            **finer,
        )
