"""The result of a run: samples, events, outcome, and the figures that tell how far to trust them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, Literal, get_args

import numpy as np

from modelgen.runtime.error_statement import Estimate

Array = np.ndarray[Any, Any]


class Outcome(Enum):
    """The outcome of a run; the value is the advice to the user."""

    DONE = "the run reached its end"
    INTERRUPTED = "what had been computed is kept; to get further, loosen the accuracy or be patient"
    MARGIN = (
        "a closed contact came too near a singularity of its closest points; look at the shapes there: "
        "curvatures that almost conform, or surfaces flat against each other, need another contact model"
    )
    STEP_TOO_SMALL = "the step became too small; loosen the tolerance or look for a discontinuous load"
    NOT_FINITE = (
        "a load, path or motion is not finite or has a pole, or a state became infinite; look at these "
        "and at shapes without curvature at the contact"
    )
    COMPLEMENTARITY = (
        "no set of contact forces keeps the bodies apart; look for driven bodies that squeeze others"
    )
    TOO_MANY_CLOSED = "more contacts closed at once than there is room for; leave out pairs that cannot touch"
    TOO_MANY_NEAR = (
        "more pairs of equal bodies are near each other than there is room for; raise near_per_body in "
        "[contacts]"
    )
    NO_FRICTION = (
        "no contact forces with this friction are found: bodies jam, or the friction is too large for finite "
        "forces (Painleve); lower the friction"
    )
    PENETRATED = (
        "bodies penetrate there: a contact was found too late or not at all; what was computed before is "
        "kept; try a tighter accuracy, more `points` in the [[contact]] of the pair, and report the scene"
    )
    TOO_COSTLY = (
        "it took many times as many steps as the run, and was stopped (Accuracy.thresholds.companion_cost)"
    )
    TOO_MANY_EVENTS = "contacts change without end at one time; raise rest_speed or lower the restitution"

    @property
    def succeeded(self) -> bool:
        return self is Outcome.DONE


OUTCOME_OF_CODE = {
    0: Outcome.DONE,
    20: Outcome.MARGIN,
    21: Outcome.STEP_TOO_SMALL,
    22: Outcome.NOT_FINITE,
    23: Outcome.COMPLEMENTARITY,
    24: Outcome.TOO_MANY_EVENTS,
    25: Outcome.TOO_MANY_CLOSED,
    26: Outcome.NO_FRICTION,
    27: Outcome.PENETRATED,
    29: Outcome.TOO_COSTLY,
    30: Outcome.TOO_MANY_NEAR,
}
EventKind = Literal[
    "impact",
    "touch-down",
    "lift-off",
    "near-singular",
    "feature-change",
    "appear",
    "vanish",
    "face-contact",
    "tipping",
    "slip-start",
    "slip-stop",
    "slip-reversal",
    "spin-start",
    "spin-stop",
    "spin-reversal",
    "roll-start",
    "roll-stop",
    "roll-reversal",
    "fallback-start",
    "fallback-end",
    "load-switch",
]
DOUBT_KINDS = (  # by the bits MG_DOUBT_ENDED ..
    *("ended", "gap", "penetration", "joint", "energy", "complementarity", "impact-gain", "no-gamma"),
    *("time-stepping", "slip-stop", "indeterminate", "flush", "unfollowed", "incomplete"),
    "stand-in",
    "capacity",
)


def doubt_kinds(bits: int) -> tuple[str, ...]:
    """The doubts of mg_doubts by name."""
    return tuple(kind for bit, kind in enumerate(DOUBT_KINDS) if bits >> bit & 1)


LOAD_SWITCH: EventKind = "load-switch"
EVENT_KINDS: tuple[EventKind, ...] = get_args(EventKind)  # by MG_EVENT_IMPACT ..
SEARCH_EVENTS: tuple[EventKind, ...] = ("appear", "vanish")  # at ends of steps
FALLBACK_EVENTS: tuple[EventKind, ...] = ("fallback-start", "fallback-end")


@dataclass(frozen=True, slots=True)
class Event:
    """A change of mode: `t` in s, `kind` of EVENT_KINDS, the contact's name, the approach speed in m/s.

    `contact` of a load that switches says which load: "force on ball". `after_t` of a blow, s: when the last
    blow came before which its contact did not approach, or that struck it too, so that it comes after that
    one; None of none.
    """

    t: float
    kind: EventKind
    contact: str
    features: str = ""  # that the contact is between after the event, where its shapes have several
    speed: float = 0.0
    after_t: float | None = None


@dataclass(frozen=True, slots=True)
class Passage:
    """Two shapes that passed through each other because no contact lists them."""

    between: tuple[str, str]  # as [[contact]] names them
    t: float  # s, when an overlap was first seen


@dataclass(frozen=True, slots=True, repr=False)
class Trajectory:
    """Samples at times t (n,), for nb bodies and nc contacts, in SI and world axes; the last is the state
    at `t_end`, at whatever time a run that ended early did.

    `modelgen.record_of(trajectory, library)` makes of it what `modelgen.save` and `modelgen.draw` take.

    `energy_drift` is max |E - E_0 - work - corrections| over the largest kinetic energy seen (over
    m L^2 / T^2 if nothing moved), and `correction_energy` the sum of the amounts by which corrections of
    positions after steps of time-stepping changed the energy, over the same; `complementarity_max` the
    largest |min(gap / L, force / (m L / T^2))|; `gap_max` the largest |d| of a closed contact at an accepted
    step, m; `margin_min` the smallest margin of one.
    """

    scene: str
    t: Array
    p: Array  # (n, nb, 3) m, centre of mass
    quaternion: Array  # (n, nb, 4), (w, x, y, z); NaN, as w, where `observe` left the turning out
    v: Array  # (n, nb, 3) m/s
    w: Array  # (n, nb, 3) rad/s
    eta: Array  # (n, n_eta) contact parameters
    force: Array  # (n, nc) N
    gap: Array  # (n, nc) m; NaN where the contact is on no feature pair
    feature_pair: Array  # (n, nc) index into `link_names`, -1 on no feature pair
    points_o: Array  # (n, nc, 3) m
    points_f: Array  # (n, nc, 3) m
    friction: Array  # (n, nc, 3) N, world, on the second body of the contact's kind
    contact_torque: Array  # (n, nc, 3) N m, world, on it: resistance against spinning and rolling
    slip: Array  # (n, nc, 3) m/s, world, of its material point past that of the first body; 0 where open
    normals: Array  # (n, nc, 3), from the first to the second body of the contact's kind
    patch: Array  # (n, n_slot) index into `patch_names` of a patch that rests, -1 none
    patch_force: Array  # (n, n_slot) N
    patch_point: Array  # (n, n_slot, 3) m, centre of pressure; NaN where none rests
    patch_friction: Array  # (n, n_slot, 3) N, world, on the second face
    patch_torque: Array  # (n, n_slot) N m, of friction on it about the normal through the centre of pressure
    patch_slip: Array  # (n, n_slot, 3) m/s, world, of the second face past the first there
    patch_spin: Array  # (n, n_slot) rad/s, about the normal from the first to the second
    patch_share: Array  # (n, number of `shares`) N, the force on one of several pairs that rest as one
    joint_force: Array  # (n, nj, 3) N, world, on its second body; without spring, damper, actuator, limits
    joint_torque: Array  # (n, nj, 3) N m, world, on it about the origin of the joint's frame in it
    sensors: Array  # (n, number of `sensor_names`) components of the sensors of the scene, SI
    coordinates: Array  # (n, number of `coordinate_names`) rad or m, whole turns counted
    energy: Array  # (n,) J, kinetic and of gravity; what springs store is in `work`
    work: Array  # (n,) J, of loads, driven bodies and impacts
    body_names: tuple[str, ...]
    contact_names: tuple[str, ...]  # those with shapes, then the limits of joints: "elbow:max"
    feature_pair_names: tuple[str, ...]  # of the features that can touch, "" where the shapes have one each
    patch_names: tuple[str, ...]  # of faces that may rest on each other: "glass-table:bottom"
    shares: tuple[tuple[int, str], ...]  # index into `patch_names`, and pair, of patches of several pairs
    joint_names: tuple[str, ...]
    coordinate_names: tuple[str, ...]  # "elbow.angle"
    sensor_names: tuple[str, ...]  # "lean", "tip_x"
    events: tuple[Event, ...]
    outcome: Outcome
    outcome_contact: str
    t_end: float
    steps: int
    rejected: int
    rhs_evals: int
    solver: str  # of complementarity problems for forces and impulses
    solves: dict[str, int]  # how many were solved, by solver; those without friction of the core are by "qp"
    solve_residual_max: float  # largest residual of one, of the largest velocity or acceleration in it
    wall_s: float
    energy_drift: float
    gap_max: float
    penetration_max: float  # m, deepest penetration of a pair with a contact, at an accepted step
    joint_error_max: float  # m, largest deviation from the joints' equations at an accepted step
    complementarity_max: float
    margin_min: float
    redundant_max: int  # most active contacts beyond the rank of their rows, of least weighted norm
    unfollowed_minima: (
        int  # how often a search found closest points within reach that no contact could follow
    )
    incomplete_searches: int  # searches of a pair of features given up before all closest points were found
    search_effort: int  # pairs of cells of surfaces and curves looked at in searches for closest points
    kinds: tuple[str, ...]
    instructions: dict[str, int]
    accuracy: str
    doubt_kinds: tuple[str, ...] = ()  # of DOUBT_KINDS: what its own figures speak against, by the core
    indeterminate_t: float | None = None  # s: first time at which friction or a load left the motion open
    indeterminate_load: str = ""  # that load, as events name it; "": friction forces
    indeterminate_contact: str = (
        ""  # where the other motion that friction allows differs most; "": none was found
    )
    indeterminate_part: float = 0.0  # change of the acceleration there, of the largest without forces
    paradox_contact: str = ""  # contact with several solutions of Coulomb's law there (Painleve), or ""
    impact_gain: float = 0.0  # J, most energy that an impact has added
    impact_gain_t: float = 0.0  # s, of `impact_gain`
    impact_gain_contact: str = ""  # that added most of it, "" where none did
    flush_t: float = 0.0  # s, of the first blow on an edge in the plane of a face
    flush_contact: str = ""  # its contact, "" where there was none
    energy_rounding: float = 0.0  # energy drift that rounding may explain
    correction_energy: float = 0.0  # sum of |changes of energy| by corrections of positions, as energy_drift
    unfollowed_pair: str = ""  # of the first of `unfollowed_minima`, "" where there was none
    unfollowed_t: float = 0.0  # s, when
    incomplete_pair: str = ""  # of the first of `incomplete_searches`, "" where there was none
    incomplete_t: float = 0.0  # s, when
    force_rounding: float = 0.0  # error of the forces of contacts that rounding may explain, relative
    penetration_t: float = 0.0  # s, of `penetration_max`
    penetration_pair: str = ""  # the pair that penetrates so deep, "" where none does
    undeclared: tuple[Passage, ...] = ()  # pairs that no contact lists and that overlapped, by time
    over_edges: tuple[Passage, ...] = ()  # shapes with open edges or ends, and those that one was in, by time
    warnings: tuple[str, ...] = ()
    jams: int = 0  # fallbacks on time-stepping because no accelerations were admissible
    fallback_time: float = 0.0  # s, duration of all fallbacks on time-stepping
    fallback_step: float = 0.0  # s, longest step of time-stepping by which an event-driven run went on; or 0
    estimate: Estimate | None = None  # of the run's own error; None where none was asked for
    outcome_function: str = ""  # "torque[0] on 'cart'", "path of 'table'": what is not finite
    doubts: tuple[str, ...] = ()  # reasons why it cannot be trusted, in words
    stopped: bool = False  # by Ctrl-C, maybe as it came to its end: then its outcome is DONE
    parameters: Mapping[str, float] = field(default_factory=dict)  # of the scene, the values of this run
    inputs: Mapping[str, float] = field(default_factory=dict)  # of the scene, the values of this run

    @property
    def position_error(self) -> Array:
        """(n,) m, the estimated error of a body's centre up to each sample; infinite where unknown."""
        return self._error("position")

    @property
    def rotation_error(self) -> Array:
        """(n,) rad, the estimated error of a body's rotation up to each sample; infinite where unknown."""
        return self._error("rotation")

    @property
    def velocity_error(self) -> Array:
        """(n,) m/s, the estimated error of the velocity of a body's centre up to each sample; infinite where
        unknown."""
        return self._error("velocity")

    @property
    def spin_error(self) -> Array:
        """(n,) rad/s, the estimated error of a body's angular velocity up to each sample; infinite where
        unknown."""
        return self._error("spin")

    def _error(self, kind: str) -> Array:
        if self.estimate is None:
            return np.full(len(self.t), np.inf)
        found: Array = getattr(self.estimate, kind)
        return found

    @property
    def is_trusted(self) -> bool:
        """Whether nothing speaks against the run: see `doubts`."""
        return not self.doubts

    @property
    def interrupted(self) -> bool:
        """Whether the run or its companion was interrupted by Ctrl-C."""
        companion = self.estimate is not None and self.estimate.interrupted
        return companion or self.stopped

    @property
    def reaches_its_end(self) -> bool:
        """Whether the last sample is the state at `t_end`; False where that state is not finite."""
        return len(self.t) > 0 and bool(self.t[-1] == self.t_end)

    def __repr__(self) -> str:
        """Scene, outcome and sizes, without arrays."""
        ending = f"{self.outcome.name.lower()} at t = {self.t_end:.6g} s"
        return f"<Trajectory {self.scene}: {ending}; samples: {len(self.t)}, events: {len(self.events)}>"

    def summary(self) -> dict[str, Any]:
        """The object that `simulate --json` prints, less the files written: plain JSON values."""
        last = len(self.t) - 1
        return {
            "scene": self.scene,
            "parameters": dict(self.parameters),
            "inputs": dict(self.inputs),
            "t_end": self.t_end,
            "outcome": self.outcome.name.lower(),
            "advice": self.outcome.value,
            "outcome_contact": self.outcome_contact,
            "outcome_function": self.outcome_function,
            "accuracy": self.accuracy,
            "warnings": list(self.warnings),
            "estimate": self.estimate and self.estimate.as_json(),
            "trusted": self.is_trusted,
            "doubts": list(self.doubts),
            "doubt_kinds": list(self.doubt_kinds),
            "steps": self.steps,
            "rejected": self.rejected,
            "rhs_evals": self.rhs_evals,
            "solver": self.solver,
            "solves": dict(self.solves),
            "solve_residual_max": self.solve_residual_max,
            "wall_s": self.wall_s,
            "energy_drift": self.energy_drift,
            "correction_energy": self.correction_energy,
            "gap_max": self.gap_max,
            "penetration_max": self.penetration_max,
            "penetration_t": self.penetration_t,
            "penetration_pair": self.penetration_pair,
            "joint_error_max": self.joint_error_max,
            "complementarity_max": self.complementarity_max,
            "margin_min": self.margin_min,
            "redundant_max": self.redundant_max,
            "indeterminate_t": self.indeterminate_t,
            "indeterminate_load": self.indeterminate_load,
            "indeterminate_contact": self.indeterminate_contact,
            "indeterminate_part": self.indeterminate_part,
            "unfollowed_minima": self.unfollowed_minima,
            "incomplete_searches": self.incomplete_searches,
            "search_effort": self.search_effort,
            "undeclared": [{"between": list(each.between), "t": each.t} for each in self.undeclared],
            "over_edges": [{"between": list(each.between), "t": each.t} for each in self.over_edges],
            "events": [
                {"t": e.t, "kind": e.kind, "contact": e.contact, "speed": e.speed, "features": e.features}
                for e in self.events
            ],
            "final": {
                name: {key: getattr(self, key)[last, i].tolist() for key in ("p", "quaternion", "v", "w")}
                for i, name in enumerate(self.body_names)
                if last >= 0
            },
            "contacts": self._contacts_at(last) if last >= 0 else {},
            "joints": self._joints_at(last) if last >= 0 else {},
            "patches": self._patches_at(last) if last >= 0 else {},
            "sensors": self._sensors_at(last) if last >= 0 else {},
            "kinds": list(self.kinds),
            "instructions": dict(self.instructions),
        }

    def _contacts_at(self, sample: int) -> dict[str, Any]:
        """The contacts that carry force at a sample."""
        return {
            name: {"force": force, "friction": self.friction[sample, i].tolist()}
            for i, (name, force) in enumerate(
                zip(self.contact_names, self.force[sample].tolist(), strict=True)
            )
            if force > 0
        }

    def _patches_at(self, sample: int) -> dict[str, Any]:
        return {
            self.patch_names[patch]: {
                "force": float(self.patch_force[sample, slot]),
                "centre_of_pressure": self.patch_point[sample, slot].tolist(),
                "friction": self.patch_friction[sample, slot].tolist(),
                "torque": float(self.patch_torque[sample, slot]),
                "slip": self.patch_slip[sample, slot].tolist(),
                "spin": float(self.patch_spin[sample, slot]),
                "shares": self._shares_at(sample, patch),
            }
            for slot, patch in enumerate(self.patch[sample].tolist())
            if patch >= 0
        }

    def _shares_at(self, sample: int, patch: int) -> dict[str, float]:
        """The parts of a patch's force on its pairs, by their names; empty for a patch of one pair."""
        shares = zip(self.shares, self.patch_share[sample].tolist(), strict=True)
        return {pair: force for (of, pair), force in shares if of == patch}

    def _joints_at(self, sample: int) -> dict[str, Any]:
        return {
            name: {
                "force": self.joint_force[sample, i].tolist(),
                "torque": self.joint_torque[sample, i].tolist(),
                "coordinates": self._coordinates_of(name, sample),
            }
            for i, name in enumerate(self.joint_names)
        }

    def _sensors_at(self, sample: int) -> dict[str, float | None]:
        values = (value if np.isfinite(value) else None for value in self.sensors[sample].tolist())
        return dict(zip(self.sensor_names, values, strict=True))

    def _coordinates_of(self, joint: str, sample: int) -> dict[str, float]:
        pairs = zip(self.coordinate_names, self.coordinates[sample].tolist(), strict=True)
        return {name.rsplit(".", 1)[1]: value for name, value in pairs if name.rsplit(".", 1)[0] == joint}
