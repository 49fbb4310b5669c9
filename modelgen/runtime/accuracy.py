"""The tolerances and solver choices of a run, in one record.

Tolerances are dimensionless: lengths are divided by the model's characteristic length L, times by its
characteristic time T. Those that few callers move are in a record of their own, `thresholds`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from math import sqrt
from types import MappingProxyType
from typing import Any, Literal, get_args

from modelgen.errors import SimulationError
from modelgen.runtime.arguments import check_fields, check_keywords, check_name, check_step, is_number
from modelgen.runtime.thresholds import Thresholds

Method = Literal["dop853", "rk4", "time-stepping"]
Scheme = Literal["stewart-trinkle", "anitescu-potra", "moreau"]
Solver = Literal["coulomb", "qp", "lcp", "mpcc", "polyhedral", "relaxation"]
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
    """All tolerances of a run and its choices of method: `coarse`, `fast`, `balanced`, `tight` or `of`.

    L, T and M are the characteristic length, time and mass of the model, which `check` prints. Tolerances are
    dimensionless unless a unit is given.

    Attributes:
        name: name of the record in results.
        tolerance: local error of an adaptive step: root mean square over the states, in their scales.
        method: "dop853" (adaptive, order 8), "rk4" (fixed step, order 4) or "time-stepping" (order 1).
        step: s; the fixed step. None: an adaptive run chooses its own first step; time-stepping takes steps
            of `stepping_step`.
        scheme: scheme of time-stepping; see `time_stepping`.
        solver: what solves for forces and impulses. "coulomb": the core, without friction by "qp", a convex
            program; "lcp": without friction by Lemke's method; "mpcc": by IPOPT; with friction, by
            time-stepping alone, also "polyhedral" and "relaxation"; see `time_stepping`.
        fallback: an event-driven run that cannot continue uses time-stepping for a while, and reports it.
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
        rest_speed: an approach faster than this times L/T is an impact; it rebounds if it is 5/4 as fast.
            A load whose jump leads back to a place holds there what passes it slower.
        slip_speed: slip slower than this times L/T (spinning and rolling: 1/T) stops if friction can hold it.
        imaginary_edge: rad; if positive, a face turns over a smooth rim about a tangent fixed in the body up
            to this angle (section 5.3), before it rolls on the rim.
        flush_height: shapes that are fixed together join where they are flush within this times L, by the
            value in the scene's [run]. A run is not trusted if a body struck another from the side at a point
            within this times L of the plane of a face of each.
        thresholds: all other numbers (`Thresholds`); `with_thresholds` changes some of them.
    """

    name: str = "balanced"
    tolerance: float = 2e-11
    method: Method = "dop853"
    step: float | None = None
    scheme: Scheme = "stewart-trinkle"
    solver: Solver = "coulomb"
    fallback: bool = True
    impacts: Impacts = "simultaneous"
    newton: Literal[0, 1, 2] = 1
    project: int = 1
    use_gamma: bool = True
    planar_contacts: bool = True
    contact_gap: float = 1e-10
    start_gap: float = 1e-8
    rest_speed: float = 1e-6
    slip_speed: float = 1e-7
    imaginary_edge: float = 0.0
    flush_height: float = 1e-8
    thresholds: Thresholds = field(default_factory=Thresholds)

    def __post_init__(self) -> None:
        check_fields(self, NAMES)

    @classmethod
    def coarse(cls) -> Accuracy:
        """Time-stepping in long steps, for many contacts: about a game engine's cost, and errors of first
        order in the step; bodies do not sink into each other."""
        return cls(
            name="coarse",
            tolerance=1e-4,
            method="time-stepping",
            rest_speed=1e-4,
            slip_speed=1e-4,
            thresholds=Thresholds(
                stepping_tolerance=1e-2,
                stepping_residual=0.2,
                feature_border=1e-6,
                drift_tolerance=1e-10,
                rest_acceleration=1e-6,
                event_tolerance=1e-8,
                gap_error_max=1e-4,
                energy_error_max=1e-1,
                complementarity_error_max=1e-1,
            ),
        )

    @classmethod
    def fast(cls) -> Accuracy:
        """Fast, for a first look: error below 3e-4 L in nine of ten shipped scenes, below 1e-5 L in half of
        them."""
        return cls(
            name="fast",
            tolerance=1e-6,
            rest_speed=1e-5,
            slip_speed=1e-5,
            thresholds=Thresholds(
                stepping_tolerance=1e-4,
                drift_tolerance=1e-12,
                rest_acceleration=1e-7,
                event_tolerance=1e-9,
                gap_error_max=1e-6,
                energy_error_max=1e-3,
                complementarity_error_max=1e-3,
            ),
        )

    @classmethod
    def balanced(cls) -> Accuracy:
        """The default: error below 1e-7 L in nine of ten shipped scenes, below 3e-10 L in half of them."""
        return cls()

    @classmethod
    def tight(cls) -> Accuracy:
        """Near rounding: error below 1e-9 L in nine of ten shipped scenes, below 2e-12 L in half of them."""
        return cls(
            name="tight",
            tolerance=1e-13,
            rest_speed=SLOWEST,
            slip_speed=1e-8,
            thresholds=Thresholds(stepping_tolerance=1e-9),
        )

    @classmethod
    def finest(cls) -> Accuracy:
        """Near the rounding of long double, with equally fine thresholds of rest and slip: for reference
        solutions."""
        return cls(
            name="finest",
            tolerance=1e-17,
            newton=2,
            rest_speed=1e-9,
            slip_speed=1e-10,
            thresholds=Thresholds(
                stepping_tolerance=1e-12,
                drift_tolerance=1e-18,
                rest_acceleration=1e-13,
                event_tolerance=1e-16,
                extremality_residual=1e-16,
                time_resolution=1e-3,
            ),
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
        """`coarse`, `fast`, `balanced` or `tight` by name."""
        records = {"coarse": cls.coarse, "fast": cls.fast, "balanced": cls.balanced, "tight": cls.tight}
        check_name("accuracy", name, records)
        return records[name]()

    @classmethod
    def of_run(cls, run: Mapping[str, Any]) -> Accuracy:
        """The record for the `accuracy` or `tolerance` of the [run] of a manifest."""
        if run["accuracy"] == "coarse" and run.get("tolerance") is not None:
            raise SimulationError(
                "tolerance",
                f"{run['tolerance']!r}",
                'none beside accuracy = "coarse", whose steps have one length',
                "give a step, or leave accuracy out",
            )
        return _of_run(run["accuracy"], run.get("tolerance"), run["imaginary_edge"], run["flush_height"])

    @classmethod
    def taken(cls, value: object) -> Accuracy:
        """The record for an argument `accuracy`: itself, or the one of that name."""
        if isinstance(value, Accuracy):
            return value
        if isinstance(value, str):
            return cls.named(value)
        allowed = "an Accuracy, or one of coarse, fast, balanced, tight"
        raise SimulationError("accuracy", repr(value), allowed, "write Accuracy.of(...) for a tolerance")

    def choosing(self, run: Mapping[str, Any]) -> Accuracy:
        """The same record with the keys of [run] that are in CHOICES; its name lists them."""
        own = {key: run[key] for key in CHOICES if run.get(key) is not None}
        name = ", ".join([self.name, *(f"{key} {value}" for key, value in own.items())])
        return replace(self, name=name, **own) if own else self

    def with_thresholds(self, **changes: float) -> Accuracy:
        """The same record with these of its `thresholds` changed: `with_thresholds(event_tolerance=1e-9)`."""
        check_keywords("with_thresholds", changes, Thresholds.__slots__)
        return replace(self, thresholds=replace(self.thresholds, **changes))  # type: ignore[arg-type]

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
                "polyhedral": cones with 8 sides, by Lemke's method (Stewart and Trinkle, 1996), friction to
                8 %. "mpcc": the exact law by IPOPT, to 1e-6. Without friction: "qp", "lcp", "mpcc".
        """
        check_step(step)
        check_name("scheme", scheme, get_args(Scheme))
        own = replace(self, name=f"{scheme} {step:g} s", solver="coulomb")
        return replace(own, method="time-stepping", step=step, scheme=scheme).solved_by(solver)

    def solved_by(self, solver: Solver) -> Accuracy:
        """The same record with another solver."""
        if solver == self.solver:
            return self
        check_name("solver", solver, get_args(Solver))
        plain = self.name.removesuffix(f", {self.solver}")
        return replace(self, name=plain if solver == "coulomb" else f"{plain}, {solver}", solver=solver)

    def companion(self, epsilon: float) -> Accuracy:
        """The record of the companion run, whose error is much smaller, or at least independent.

        What decides when a contact rests, sticks or opens is finer too, though not so fine that rounding
        decides it, and drift is removed at every step, so that their part in the error shows.
        """
        least = RESOLVED["tolerance"] * epsilon
        tolerance = max(self.tolerance, least)
        finer = {}
        for key in ("rest_speed", "slip_speed"):
            value = getattr(self, key)
            finer[key] = max(value / SLOWER, min(value / FINER, sqrt(epsilon)))
        return replace(
            self,
            name=f"{self.name}, companion",
            tolerance=tolerance / FINER if tolerance >= FINER * least else tolerance * COARSER,
            step=self.step and self.step * TENTH,
            project=1,
            contact_gap=self.contact_gap / FINER,
            thresholds=self._finer_thresholds(epsilon),
            **finer,
        )

    def _finer_thresholds(self, epsilon: float) -> Thresholds:
        own = self.thresholds
        finer = ("rest_acceleration", "event_tolerance", "friction_bound_margin", "feature_border")
        shorter = ("fallback_step", "chatter_step", "step_fraction")
        return replace(
            own,
            **{key: getattr(own, key) / FINER for key in (*finer, "time_resolution", "stepping_tolerance")},
            **{key: getattr(own, key) * TENTH for key in shorter},
            flat_angle=max(own.flat_angle / 2, RESOLVED["flat_angle"] * epsilon),
            sweep_from_last=1 - own.sweep_from_last,
        )


@lru_cache(maxsize=64)
def _of_run(name: str, tolerance: float | None, imaginary_edge: float, flush_height: float) -> Accuracy:
    base = Accuracy.named(name) if tolerance is None else Accuracy.of(tolerance)
    return replace(base, imaginary_edge=imaginary_edge, flush_height=flush_height)


NAMES = {"Method": Method, "Scheme": Scheme, "Solver": Solver, "Impacts": Impacts}  # types of fields
