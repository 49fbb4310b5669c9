"""Rings that fall on a wire and hang from it: no body leaps, and corrections of positions make no energy.

Run with `python -m tests.benchmarks.rings_on_wires [--count 500] [--accuracies fast,balanced,tight]
[--groups 40] [--fmus 3]`. A torus hangs about a circular wire that is tilted, or falls onto it, with random
sizes, poses, velocities, friction and restitution. Two contact points merge again and again, and the run
falls back on time-stepping there. Between two samples the centre of a ring moves no farther than its kinetic
energy and gravity allow. Told are the largest way over that bound, and the largest energy of corrections over
the largest kinetic energy. In groups, `--groups` scenes have 8 lanes each, with other velocities; FMUs are
made of scenes that fall back.
"""

from __future__ import annotations

import argparse
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from modelgen import derive, emit, require, simulate, start_many
from modelgen.codegen.library import Library
from modelgen.errors import SimulationError
from modelgen.export.export_formats import Choices, export
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.read import read_text
from tests.running import compiled

GRAVITY, UNTIL, SAMPLES = 9.81, 1.2, 400  # m/s^2, s
LANES = 8


@dataclass(frozen=True)
class Ring:
    """A scene, and what its judge needs."""

    text: str
    mass: float
    inertia: float  # kg m^2, the largest

    def library(self) -> Library:
        return compiled(emit(derive(require(read_text(self.text, "ring_on_wire.toml")))))

    def leap(self, t: np.ndarray, p: np.ndarray, v: np.ndarray, w: np.ndarray) -> float:
        """The largest way of the centre from one sample to the next, p (n, 3), over what the kinetic energy
        at the first of them and gravity allow."""
        if len(t) < 2:
            return 0.0
        kinetic = self.mass / 2 * (v**2).sum(1) + self.inertia / 2 * (w**2).sum(1)
        duration = np.diff(t)
        fastest = np.sqrt(2 * kinetic[:-1] / self.mass) + GRAVITY * duration
        return float((np.linalg.norm(np.diff(p, axis=0), axis=1) / (fastest * duration)).max())


def _row(values: Sequence[float] | np.ndarray) -> list[float]:
    return [float(each) for each in values]


def ring_on_wire(seed: int) -> Ring:
    """A random ring on a random wire."""
    rng = np.random.default_rng([49, seed])
    wire = rng.uniform(0.3, 1.0)
    major = wire * rng.uniform(0.1, 0.4)
    minor = major * rng.uniform(0.1, 0.4)
    tilt = Rotation.from_euler("x", rng.uniform(0.0, np.pi / 2))
    mass = rng.uniform(1.0, 4.0)
    across, along = major**2 / 2 + 5 * minor**2 / 8, major**2 + 3 * minor**2 / 4
    phi = rng.uniform(0.0, 2 * np.pi)
    at = tilt.apply([wire * np.cos(phi), wire * np.sin(phi), 0.0])
    if rng.random() < 0.5:  # the wire goes through it
        tangent = tilt.apply([-np.sin(phi), np.cos(phi), 0.0])
        side = np.cross(tangent, rng.normal(size=3))
        side /= np.linalg.norm(side)
        position = at + side * major * rng.uniform(0.0, 0.5)
        axes = Rotation.from_matrix(np.c_[side, np.cross(tangent, side), tangent])
        rotation = axes * Rotation.from_rotvec(0.2 * rng.normal(size=3))
    else:
        position = at + np.array([0.0, 0.0, (major + minor) * rng.uniform(1.05, 2.0)])
        rotation = Rotation.random(random_state=int(rng.integers(2**31)))
    text = f"""gravity = [0.0, 0.0, {-GRAVITY}]
[run]
until = {UNTIL}
samples = {SAMPLES}
[[body]]
name = "wire"
motion = "fixed"
shape = {{ kind = "circle", radius = {wire} }}
rotation = {[_row(each) for each in tilt.as_matrix()]}
[[body]]
name = "ring"
shape = {{ kind = "torus", major = {major}, minor = {minor} }}
mass = {mass}
inertia = {_row([mass * across, mass * across, mass * along])}
position = {_row(position)}
rotation = {[_row(each) for each in rotation.as_matrix()]}
velocity = {_row(0.3 * rng.normal(size=3))}
angular_velocity = {_row(2.0 * rng.normal(size=3))}
[[contact]]
between = ["ring", "wire"]
friction = {rng.uniform(0.0, 0.8)}
restitution = {rng.uniform(0.0, 0.5)}
"""
    return Ring(text, mass, mass * max(across, along))


def run(ring: Ring, accuracy: str) -> Trajectory | None:
    """Its run; None where the ring starts inside the wire."""
    try:
        return simulate(ring.library(), accuracy=accuracy, estimate=False)
    except SimulationError:
        return None


def runs(count: int, accuracy: str) -> Iterator[tuple[Ring, Trajectory]]:
    """The first `count` rings that start outside of the wire, and their runs."""
    seed = found = 0
    while found < count:
        ring, seed = ring_on_wire(seed), seed + 1
        path = run(ring, accuracy)
        if path is not None:
            found += 1
            yield ring, path


def leap_of(ring: Ring, path: Trajectory) -> float:
    """`Ring.leap` of a run."""
    k = path.body_names.index("ring")
    return ring.leap(path.t, path.p[:, k], path.v[:, k], path.w[:, k])


def falls_back(path: Trajectory) -> bool:
    return any(event.kind == "fallback-start" for event in path.events)


def lanes_of(ring: Ring, seed: int, accuracy: str = "balanced") -> Iterator[float]:
    """`Ring.leap` of each lane of a group with other velocities."""
    library = ring.library()
    rng, instance = np.random.default_rng([50, seed]), library.manifest.instance
    u = np.tile(np.array(instance["initial_u"], dtype=float), (LANES, 1))
    u[1:] += rng.normal(size=(LANES - 1, 6)) * np.repeat([0.3, 2.0], 3)
    many = start_many(library, LANES, u=u, accuracy=accuracy)
    n_q, x, t = instance["n_q"], [many.state.copy()], [many.t]
    for _ in range(SAMPLES):
        many.step(UNTIL / SAMPLES)
        x.append(many.state.copy())
        t.append(many.t)
    states, times = np.array(x), np.array(t)
    for lane in range(LANES):
        going = np.r_[True, np.diff(times[:, lane]) > 0]
        state = states[going, lane]
        yield ring.leap(
            times[going, lane], state[:, :3], state[:, n_q : n_q + 3], state[:, n_q + 3 : n_q + 6]
        )


def fmu_leap(ring: Ring, version: int, folder: Path) -> float:
    """`Ring.leap` of a scene as an FMU."""
    from tests.export.test_fmu import Slave

    derivation = derive(require(read_text(ring.text, "ring_on_wire.toml")))
    export(derivation, "fmu", folder, folder / ".library", Choices(figures=False, states=True))
    slave = Slave(str(folder / f"ring_on_wire.fmi{version}.fmu"), folder / "unpacked")
    axes = [f"ring.{what}_{axis}" for what in ("position", "velocity", "angular_velocity") for axis in "xyz"]
    told = [slave.get(*axes)]
    for k in range(SAMPLES):
        slave.step(k * UNTIL / SAMPLES, UNTIL / SAMPLES)
        told.append(slave.get(*axes))
    p, v, w = np.split(np.array(told), 3, axis=1)
    return ring.leap(np.arange(SAMPLES + 1) * UNTIL / SAMPLES, p, v, w)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--accuracies", default="fast,balanced,tight")
    parser.add_argument("--groups", type=int, default=40)
    parser.add_argument("--fmus", type=int, default=3)
    given = parser.parse_args()
    fallen: list[Ring] = []
    for accuracy in given.accuracies.split(","):
        ends: Counter[str] = Counter()
        leap = energy = 0.0
        for ring, path in runs(given.count, accuracy):
            ends[path.outcome.name.lower()] += 1
            ends["with fallbacks"] += falls_back(path)
            fallen += [ring] if falls_back(path) and accuracy == "balanced" else []
            leap, energy = max(leap, leap_of(ring, path)), max(energy, path.correction_energy)
        print(f"{accuracy}: {dict(ends)}; way over bound {leap:.4f}, energy of corrections {energy:.1e}")
    if given.groups:
        leap = max(each for ring, _ in runs(given.groups, "balanced") for each in lanes_of(ring, 1))
        print(f"{given.groups} groups of {LANES} lanes: way over bound {leap:.4f}")
    for ring in fallen[: given.fmus]:
        with tempfile.TemporaryDirectory() as folder:
            leaps = [fmu_leap(ring, version, Path(folder)) for version in (2, 3)]
        print(f"FMUs of a ring that falls back: way over bound {leaps[0]:.4f} and {leaps[1]:.4f}")


if __name__ == "__main__":
    main()
