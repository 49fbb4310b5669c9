"""The glass after its base has left the table: the hand-over to the rim beside the paper's imaginary edge.

    python -m tests.benchmarks.glass

For a load in one plane, for a torque about the axis that turns the glass while it tips, and for the shipped
scene, where it spins before: the error of the centre of mass over the rolling phase against the reference of
tests/oracles/glass_reference.py, and that of the energy ledger. The imaginary edge (section 5.3) is fixed in
the glass; where that turns it away from the load, the glass stands flat again before it leans enough.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import hypot

import numpy as np

from modelgen import Accuracy, simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.oracles.glass_reference import G, Glass, harmonics, motion
from tests.running import library_of

MASS, RADIUS, HEIGHT, ABOVE, INERTIA = 0.3, 0.04, 0.05, 0.03, (3.7e-4, 3.7e-4, 2.4e-4)
PUSH = 2.0  # N/s along x
ROLLING, SKIPPED = 0.15, 0.004  # s after the tip, of which the first are left to the series of the reference
SAMPLES = 400
EDGES = (0.003, 0.01, 0.03)  # rad


@dataclass(frozen=True)
class Load:
    """Torques: `tip` N m/s about x, `turn` N m about z, `late` N m/s about z from the tip on."""

    tip: float = 0.0
    turn: float = 0.0
    late: float = 0.0

    @property
    def edge(self) -> float:
        """s; when the pressure reaches the edge."""
        return MASS * G * RADIUS / hypot(ABOVE * PUSH, self.tip)


LOADS: Mapping[str, Load] = {
    "one plane": Load(),
    "torque about the axis": Load(late=0.01),
    "the shipped scene": Load(tip=0.01, turn=0.0005),
}


def scene_of(load: Load) -> Scene:
    spun = f"{load.turn!r} + {load.late!r}*max(t - {load.edge!r}, 0)"
    body = make.dynamic(
        "glass", make.cylinder(RADIUS, 2 * HEIGHT), mass=MASS, inertia=list(INERTIA), position=[0, 0, HEIGHT]
    )
    return make.scene(
        "glass", [make.fixed("table", make.plane()), body], contact=[{"between": ["glass", "table"]}],
        force=[{"body": "glass", "force": [f"{PUSH}*t", "0", "0"], "point": [0, 0, ABOVE]}],
        torque=[{"body": "glass", "torque": [f"{load.tip!r}*t", "0", spun]}],
    )  # fmt: skip


def reference(load: Load, t: np.ndarray) -> np.ndarray:
    """Positions (n, 3) of the centre of mass at times after the tip."""
    edge = load.edge
    torque = ((load.tip * edge, load.tip), (0.0,), (load.turn, load.late))
    velocity, spin = (PUSH * edge**2 / (2 * MASS), 0.0), load.turn / INERTIA[2] * edge
    glass = Glass(
        harmonics(RADIUS), MASS, INERTIA, HEIGHT, ABOVE, ((PUSH * edge, PUSH), (0.0,)), torque, velocity, spin
    )
    at_tip = np.array([PUSH * edge**3 / (6 * MASS), 0.0, 0.0])
    places: np.ndarray = motion(glass, t - edge, SKIPPED).p + at_tip
    return places


def settings() -> Iterator[tuple[str, Accuracy]]:
    yield "hand-over, tight", Accuracy.tight()
    yield "hand-over, balanced", Accuracy.balanced()
    for lean in EDGES:
        yield f"imaginary edge {lean:g}", replace(Accuracy.tight(), imaginary_edge=lean)


@dataclass(frozen=True)
class Row:
    """What one run gets wrong over the rolling phase; `flat`: times at which the glass stood flat again."""

    position: float  # m
    ledger: float  # of the largest kinetic energy
    flat: int


def measured(load: Load, accuracy: Accuracy) -> Row:
    until = load.edge + ROLLING
    path = simulate(
        library_of(scene_of(load)), until=until, samples=SAMPLES, accuracy=accuracy, estimate=False
    )
    return Row(error(load, path), path.energy_drift, sum(e.kind == "face-contact" for e in path.events) - 1)


def error(load: Load, path: Trajectory) -> float:
    rolling = path.t > load.edge + SKIPPED
    t = path.t[rolling].astype(float)
    return float(np.abs(path.p[rolling, 1] - reference(load, t)).max())


def main() -> None:
    print("| load | how | position error (m) | energy drift | flat again |")
    print("| --- | --- | --- | --- | --- |")
    for name, load in LOADS.items():
        for how, accuracy in settings():
            row = measured(load, accuracy)
            print(f"| {name} | {how} | {row.position:.1e} | {row.ledger:.1e} | {row.flat} |", flush=True)


if __name__ == "__main__":
    main()
