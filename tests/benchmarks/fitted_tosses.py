"""Friction and restitution from measured tosses of a cube, and how well they predict other tosses.

    python -m tests.benchmarks.fitted_tosses [all]

fits five of the ten tosses and prints for all ten the mean distance of the centre over the frames and the
mean angle of rotation. Coefficients:

- published: as published;
- free: fitted with a start of each toss that is fitted too;
- given: fitted with starts that were fitted to the frames before the first blow alone;
- sought: those of a grid whose runs from such starts miss least, on the average over the tosses and over the
  neighbours in the grid. Before, the scale of the measured lengths is fitted to the flights, which fall more
  slowly than gravity lets them, as the cube at rest is lower than half of its size.

Starts of the runs that are compared:

- frames: from the first two frames (as `tests.benchmarks.tosses`);
- flight: fitted to the frames before the first blow: all that follows is predicted;
- whole: fitted to the whole toss.

The rows of the tosses that were not fitted are those that count. `all` fits the other five too, and all ten.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from modelgen import derive, emit, fit, require, start_many
from modelgen.codegen.library import Library
from modelgen.identification.fit import Fit, Residuals
from modelgen.scene.read import read_text
from tests.oracles.friction.cube_toss import (
    HALF_WIDTH,
    INERTIA,
    MASS,
    MU,
    NUMBERS,
    RESTITUTION,
    Array,
    Toss,
    corners,
    toss,
)
from tests.running import compiled

FITTED = NUMBERS[::2]
NOISE = {"cube.position": 2e-3, "cube.orientation": 0.03}  # m, rad: the weights of the deviations
MOST = 25  # residuals of a minimisation
TOUCHES = 0.004  # m, height of the lowest corner up to which a measured cube may touch the table
STARTS = ("cube.position", "cube.orientation", "cube.velocity", "cube.angular_velocity")
FRICTIONS, RESTITUTIONS = np.arange(0.08, 0.31, 0.02), np.arange(0.0, 0.51, 0.05)  # the grid
SIZE = ", ".join([f'"{2 * HALF_WIDTH}*scale"'] * 3)
MOMENTS = ", ".join([f'"{INERTIA}*scale*scale"'] * 3)
SCENE = f"""
gravity = [0.0, 0.0, "-9.81*scale"]

[[parameter]]
name = "scale"  # of measured lengths over true ones
value = 1.0
minimum = 0.8
maximum = 1.2

[[parameter]]
name = "friction"
value = {MU}
minimum = 0.02
maximum = 1.0

[[parameter]]
name = "restitution"
value = {RESTITUTION}
minimum = 0.0
maximum = 0.9

[[body]]
name = "table"
motion = "fixed"
shape = {{ kind = "plane" }}

[[body]]
name = "cube"
shape = {{ kind = "box", size = [{SIZE}] }}
mass = {MASS}
inertia = [{MOMENTS}]
position = [0.0, 0.0, 0.3]
rpy = [0.3, 0.2, 0.1]

[[contact]]
between = ["cube", "table"]
friction = "friction"
restitution = "restitution"
"""


def recording(measured: Toss, frames: int | None = None) -> dict[str, Array]:
    """The columns of a toss, or of its first frames."""
    quaternions = np.roll(measured.rotation.as_quat(), 1, axis=1)
    return {
        "t": measured.t[:frames],
        "cube.position": measured.p[:frames],
        "cube.orientation": quaternions[:frames],
    }


def flight(number: int) -> dict[str, Array]:
    """The columns of the frames before the first blow."""
    measured = toss(number)
    low = corners(measured.p, measured.rotation)[:, :, 2].min(axis=1)
    return recording(measured, int(np.argmax(low < TOUCHES)))


def errors_of(left: Residuals) -> tuple[float, float]:
    """Means over the frames of the distance of the centre, mm, and of the angle of rotation, degrees."""
    distance = np.linalg.norm(left.deviations[:, :3], axis=1)
    half = np.linalg.norm(left.deviations[:, 3:], axis=1) / 2
    return 1e3 * float(distance.mean()), float(np.degrees(2 * np.arcsin(np.minimum(half, 1))).mean())


def predicted(
    library: Library, measured: Toss, coefficients: dict[str, float], start: dict[str, Array]
) -> tuple[float, float]:
    """The errors of a run from a start."""
    many = start_many(library, 1, parameters=coefficients, q=start["q"], u=start["u"])
    rows = [many.state[0, :7].copy()]
    for step in np.diff(measured.t):
        many.step(float(step))
        rows.append(many.state[0, :7].copy())
    states = np.array(rows)
    turned = (measured.rotation.inv() * Rotation.from_quat(np.roll(states[:, 3:], -1, axis=1))).magnitude()
    distance = np.linalg.norm(states[:, :3] - measured.p, axis=1)
    return 1e3 * float(distance.mean()), float(np.degrees(turned.mean()))


def start_of_frames(measured: Toss) -> dict[str, Array]:
    spin = measured.rotation[0].inv().apply(measured.w)
    return {
        "q": np.concatenate([measured.p[0], measured.quaternion])[None],
        "u": np.concatenate([measured.v, spin])[None],
    }


def start_of_fit(found: Fit) -> dict[str, Array]:
    start = found.starts[0]
    position, orientation, velocity, spin = (np.array(start[name]) for name in STARTS)
    return {"q": np.concatenate([position, orientation])[None], "u": np.concatenate([velocity, spin])[None]}


def scaled(library: Library, numbers: Sequence[int]) -> tuple[dict[str, float], dict[int, dict[str, Array]]]:
    """The scale that the flights of these tosses show, and with it the start of each toss."""
    found = fit(library, [flight(number) for number in numbers], by=["scale", *STARTS], noise=NOISE)
    scale = {"scale": found["scale"]}
    fitted = {
        number: fit(library, flight(number), by=STARTS, noise=NOISE, parameters=scale) for number in NUMBERS
    }
    return scale, {number: start_of_fit(each) for number, each in fitted.items()}


def sought(library: Library, numbers: Sequence[int]) -> tuple[dict[str, float], dict[int, dict[str, Array]]]:
    """Coefficients with which runs miss these tosses least, and the starts of all."""
    scale, starts = scaled(library, numbers)
    missed = np.zeros((len(FRICTIONS), len(RESTITUTIONS)))
    for place in np.ndindex(missed.shape):
        at = _coefficients(place) | scale
        missed[place] = np.mean(
            [predicted(library, toss(number), at, starts[number])[0] for number in numbers]
        )
    best = min(np.ndindex(missed.shape), key=lambda place: _around(missed, place))
    return _coefficients(best) | scale, starts


def _coefficients(place: tuple[int, ...]) -> dict[str, float]:
    return {"friction": float(FRICTIONS[place[0]]), "restitution": float(RESTITUTIONS[place[1]])}


def _around(missed: Array, place: tuple[int, ...]) -> float:
    """Mean of an entry and its neighbours."""
    return float(missed[tuple(slice(max(k - 1, 0), k + 2) for k in place)].mean())


def study(library: Library, numbers: Sequence[int]) -> None:
    flights = {number: fit(library, flight(number), by=STARTS, noise=NOISE) for number in NUMBERS}
    began = time.perf_counter()
    tosses = [recording(toss(number)) for number in numbers]
    free = fit(library, tosses, by=["friction", "restitution", *STARTS], noise=NOISE, evaluations=MOST)
    took = time.perf_counter() - began
    given = fit(
        library,
        [recording(toss(number)) | {"start": flights[number].starts[0]} for number in numbers],
        by=["friction", "restitution"],
        noise=NOISE,
        starts=5,
    )
    print(f"fitted to tosses {', '.join(map(str, numbers))}: {took:.0f} s, {free.simulated} runs")
    for word, found in (("free", free), ("given", given)):
        for name in ("friction", "restitution"):
            low, high = found.interval(name)
            print(f"  {word}: {name} {found[name]:.4f}, 95 % from {low:.4f} to {high:.4f}")
        for note in found.notes:
            print(f"  {word}: {note}", flush=True)
    published = {"friction": MU, "restitution": RESTITUTION}
    best, starts = sought(library, numbers)
    print("  sought: " + ", ".join(f"{name} {value:.4f}" for name, value in best.items()))
    table = {}
    for number in NUMBERS:
        measured, start = toss(number), start_of_fit(flights[number])
        inside = number in numbers
        left = [
            whole(library, measured, published),
            free.residuals[numbers.index(number)] if inside else whole(library, measured, free.parameters),
        ]
        table[number] = [
            predicted(library, measured, published, start_of_frames(measured)),
            predicted(library, measured, published, start),
            predicted(library, measured, free.parameters, start),
            predicted(library, measured, given.parameters, start),
            predicted(library, measured, best, starts[number]),
            *map(errors_of, left),
        ]
    print_table(table, numbers)


def whole(library: Library, measured: Toss, coefficients: dict[str, float]) -> Residuals:
    """What is left of a toss with its start fitted to all of it."""
    columns = recording(measured)
    found = fit(library, columns, by=STARTS, parameters=coefficients, noise=NOISE, evaluations=MOST)
    return found.residuals[0]


def print_table(table: dict[int, list[tuple[float, float]]], numbers: Sequence[int]) -> None:
    heads = (
        *("published, frames", "published, flight", "free, flight", "given, flight", "sought, flight"),
        *("published, whole", "free, whole"),
    )
    print(f"  {'':10}" + "".join(f"{head:>22}" for head in heads))
    for number, row in table.items():
        mark = "*" if number in numbers else " "
        print(f"  {number:>8} {mark}" + "".join(f"{mm:13.1f} mm {deg:4.1f}°" for mm, deg in row))
    for word, wanted in (("fitted *", True), ("held out", False), ("all", None)):
        rows = [row for number, row in table.items() if wanted is None or (number in numbers) is wanted]
        if rows:
            for kind, of in (("mean", np.mean), ("median", np.median)):
                means = of(np.array(rows), axis=0)
                print(f"  {word:>8} {kind:6}" + "".join(f"{mm:10.1f} mm {deg:5.1f}°" for mm, deg in means))


def main() -> None:
    library = compiled(emit(derive(require(read_text(SCENE, "toss.toml"))), derivatives=True))
    study(library, FITTED)
    if sys.argv[1:] == ["all"]:
        study(library, NUMBERS[1::2])
        study(library, NUMBERS)


if __name__ == "__main__":
    main()
