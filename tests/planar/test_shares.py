"""The force on each pair of a planar contact of several: statics with a pressure max(0, a + b.x)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import acos, pi

import numpy as np
import pytest

from modelgen import derive, emit, require, sensitivity, simulate
from modelgen.errors import SceneError
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Scene
from tests.planar.scenes import TIGHT, G, table
from tests.running import compiled, library_of

Moments = Callable[[np.ndarray], np.ndarray]  # of 1, x, y, xx, xy, yy over the loaded part of a foot
NODES, WEIGHTS = np.polynomial.legendre.leggauss(60)


def of_disc(x: float, y: float, radius: float) -> Moments:
    """In axes along and across the slope of the pressure, by quadrature over the angle, exact to rounding."""

    def moments(p: np.ndarray) -> np.ndarray:
        slope = float(np.hypot(p[1], p[2]))
        at = p[0] + p[1] * x + p[2] * y
        depth = np.clip(at / slope / radius, -1, 1) if slope else 1.0  # of the line p = 0 behind the centre
        angle = (pi - acos(depth)) / 2 * (NODES + 1)
        weight = (pi - acos(depth)) / 2 * WEIGHTS
        # u runs from the far side, u = r cos(angle), down to the line; chord 2 r sin(angle)
        u, area = radius * np.cos(angle), 2 * radius**2 * np.sin(angle) ** 2 * weight
        v2 = (radius * np.sin(angle)) ** 2 / 3
        e = np.array([p[1], p[2]]) / slope if slope else np.array([1.0, 0.0])
        m0, m1, m2, c2 = area.sum(), (area * u).sum(), (area * u * u).sum(), (area * v2).sum()
        first = m0 * np.array([x, y]) + m1 * e
        across = np.array([-e[1], e[0]])
        centre = np.array([x, y])
        second = (
            m0 * np.outer(centre, centre) + m1 * (np.outer(centre, e) + np.outer(e, centre))
            + m2 * np.outer(e, e) + c2 * np.outer(across, across)
        )  # fmt: skip
        return np.array([m0, *first, second[0, 0], second[0, 1], second[1, 1]])

    return moments


def of_polygon(corners: Sequence[Sequence[float]]) -> Moments:
    """Counterclockwise corners; clipped by the line p = 0, by triangles."""

    def moments(p: np.ndarray) -> np.ndarray:
        kept: list[np.ndarray] = []
        points = [np.array(corner, dtype=float) for corner in corners]
        for a, b in zip(points, [*points[1:], points[0]], strict=True):
            pa, pb = (p[0] + p[1:] @ each for each in (a, b))
            kept += [a] if pa > 0 else []
            kept += [a + pa / (pa - pb) * (b - a)] if pa * pb < 0 else []
        found = np.zeros(6)
        for a, b in pairwise(kept[1:]):
            o = kept[0]
            area = ((a - o)[0] * (b - o)[1] - (a - o)[1] * (b - o)[0]) / 2
            for x, y in ((o + a) / 2, (a + b) / 2, (b + o) / 2):  # exact for squares
                found += area / 3 * np.array([1, x, y, x * x, x * y, y * y])
        return found

    return moments


def shares(feet: Sequence[Moments], force: float, centre: Sequence[float]) -> np.ndarray:
    """The forces on the feet of a pressure with this resultant and centre: Newton's method for the minimum of
    the integral of max(0, a + b.x)^2 / 2 less the work of the load, which is convex in (a, b)."""
    wanted = force * np.array([1.0, *centre])

    def matrix(p: np.ndarray, of: Sequence[Moments] = feet) -> np.ndarray:
        m = sum(foot(p) for foot in of)
        return np.array([[m[0], m[1], m[2]], [m[1], m[3], m[4]], [m[2], m[4], m[5]]])

    def merit(p: np.ndarray) -> float:
        return float(p @ matrix(p) @ p / 2 - wanted @ p)

    p = np.linalg.solve(matrix(np.array([1.0, 0.0, 0.0])), wanted)
    for _ in range(100):
        step, part = np.linalg.solve(matrix(p), wanted) - p, 1.0
        while merit(p + part * step) > merit(p) and part > 1e-6:
            part /= 2
        p = p + part * step
    assert np.abs(matrix(p) @ p - wanted).max() < 1e-11 * force
    return np.array([(matrix(p, [foot]) @ p)[0] for foot in feet])


@dataclass(frozen=True)
class Standing:
    """A body on several feet or supports, its weight and a force at a point."""

    bodies: tuple[Body, ...]
    feet: tuple[Moments, ...]  # about the centre of mass of the body
    pairs: tuple[tuple[str, str], ...]
    body: str
    mass: float
    least: float  # extent of the feet over which the load is spread


def places(rng: np.random.Generator, n: int) -> np.ndarray:
    """Points round about a circle, so that no three are on a line."""
    angles = 2 * pi * (np.arange(n) + rng.uniform(-0.12, 0.12, n)) / n
    return (rng.uniform(0.2, 0.35, n) * np.array([np.cos(angles), np.sin(angles)])).T


def stool(rng: np.random.Generator) -> Standing:
    """Three to six round legs of random radii on a plane."""
    n = int(rng.integers(3, 7))
    at, radii = places(rng, n), rng.uniform(0.01, 0.06, n)
    legs = [
        make.cylinder(r, 0.4, name=f"leg{k}", position=[x, y, 0])
        for k, ((x, y), r) in enumerate(zip(at.tolist(), radii.tolist(), strict=True))
    ]
    mass = float(rng.uniform(1, 5))
    body = make.dynamic("stool", *legs, mass=mass, inertia=[0.1, 0.1, 0.1], position=[0, 0, 0.2])
    feet = tuple(of_disc(x, y, r) for (x, y), r in zip(at.tolist(), radii.tolist(), strict=True))
    pairs = tuple(("table/plane", f"stool/leg{k}") for k in range(n))
    return Standing((table(), body), feet, pairs, "stool", mass, 0.045 if n == 3 else 0.1)


def slab_on_feet(rng: np.random.Generator) -> Standing:
    """Three to six rectangular feet of random sizes, on a fixed box."""
    n = int(rng.integers(3, 7))
    at, sizes = places(rng, n), rng.uniform(0.02, 0.12, (n, 2))
    legs = [
        make.box(float(a), float(b), 0.4, name=f"leg{k}", position=[x, y, 0])
        for k, ((x, y), (a, b)) in enumerate(zip(at.tolist(), sizes.tolist(), strict=True))
    ]
    mass = float(rng.uniform(1, 5))
    ground = make.fixed("table", make.box(2, 2, 0.1, position=[0, 0, -0.05]))
    body = make.dynamic("stool", *legs, mass=mass, inertia=[0.1, 0.1, 0.1], position=[0, 0, 0.2])
    feet = tuple(of_rectangle(x, y, *size) for (x, y), size in zip(at.tolist(), sizes.tolist(), strict=True))
    pairs = tuple(("table/box", f"stool/leg{k}") for k in range(n))
    return Standing((ground, body), feet, pairs, "stool", mass, 0.045 if n == 3 else 0.1)


def plank(rng: np.random.Generator) -> Standing:
    """A plank on two or three fixed blocks, which it covers in part."""
    n = int(rng.integers(2, 4))
    width, mass = float(rng.uniform(0.1, 0.2)), float(rng.uniform(1, 5))
    at = np.linspace(-0.4, 0.4, n) + rng.uniform(-0.05, 0.05, n)
    sizes, shift = rng.uniform(0.04, 0.1, n), rng.uniform(-0.05, 0.05, n)
    blocks = [
        make.fixed(f"block{k}", make.box(float(a), 0.3, 0.1), position=[float(x), float(y), -0.05])
        for k, (x, y, a) in enumerate(zip(at, 0.15 - width / 2 + shift, sizes, strict=True))
    ]
    body = make.dynamic(
        "plank", make.box(1.2, width, 0.04), mass=mass, inertia=[0.01, 0.2, 0.2], position=[0, 0, 0.02]
    )
    feet = []
    for x, y, a in zip(at.tolist(), (0.15 - width / 2 + shift).tolist(), sizes.tolist(), strict=True):
        low, high = max(y - 0.15, -width / 2), min(y + 0.15, width / 2)
        feet.append(of_rectangle(x, (low + high) / 2, a, high - low))
    return Standing(
        (*blocks, body), tuple(feet), tuple((f"block{k}", "plank") for k in range(n)), "plank", mass, 0.02
    )


def of_rectangle(x: float, y: float, a: float, b: float) -> Moments:
    return of_polygon([(x + s * a / 2, y + t * b / 2) for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))])


KINDS = (stool, slab_on_feet, plank)


@pytest.mark.cases(6)
@pytest.mark.parametrize("seed", range(100))
def test_the_share_of_each_pair_is_its_part_of_the_affine_pressure(seed: int) -> None:
    rng = np.random.default_rng(seed)
    standing = KINDS[seed % 3](rng)
    push = float(rng.uniform(0, 3) * standing.mass * G)
    point = rng.uniform(-1, 1, 2) * standing.least * (1 if seed % 3 < 2 else np.array([10.0, 1.0]))
    friction = 0.5 * (seed % 2)
    scene = make.scene(
        "standing", list(standing.bodies),
        contact=[{"between": list(pair), "friction": friction} for pair in standing.pairs],
        force=[{"body": standing.body, "force": ["0", "0", repr(-push)], "point": [*point.tolist(), 0.0]}],
        sensor=[
            *({"name": f"n{k}", "of": "-".join(pair) + ".force"} for k, pair in enumerate(standing.pairs)),
            {"name": "all", "of": "table-stool.force" if seed % 3 < 2 else "block0-plank.force"},
        ],
    )  # fmt: skip
    path = simulate(library_of(scene), until=0.01, samples=2, accuracy=TIGHT, estimate=False)
    whole = standing.mass * G + push
    right = shares(standing.feet, whole, push / whole * point)
    shown = path.sensors[-1, :-1]
    assert shown == pytest.approx(right, abs=1e-9 * whole)
    assert path.sensors[-1, -1] == pytest.approx(whole if seed % 3 < 2 else right[0], rel=1e-9)
    (patch,) = path.summary()["patches"].values()
    assert list(patch["shares"].values()) == pytest.approx(right, abs=1e-9 * whole)
    assert not path.warnings


def crossed(*sensors: str) -> Scene:
    """A body whose two boxes overlap, on the floor."""
    boxes = [make.box(1, 0.1, 0.1, name="along"), make.box(0.1, 0.5, 0.1, name="across")]
    body = make.dynamic("cross", *boxes, mass=3.0, inertia=[0.1, 0.1, 0.1], position=[0, 0, 0.05])
    return make.scene(
        "cross", [table(), body],
        contact=[{"between": ["table/plane", f"cross/{shape.name}"]} for shape in boxes],
        sensor=[{"name": f"s{k}", "of": of} for k, of in enumerate(sensors)],
    )  # fmt: skip


def test_shares_of_faces_that_overlap_are_not_unique_and_keep_their_sum() -> None:
    scene = crossed("cross-table.force", *(f"cross/{s}-table/plane.force" for s in ("along", "across")))
    path = simulate(library_of(scene), until=0.1, samples=2, accuracy=TIGHT)
    whole, along, across = path.sensors[-1]
    assert whole == pytest.approx(3.0 * G, rel=1e-12)
    assert along == pytest.approx(whole / (1 + 0.5), rel=1e-12)  # areas 1 to 0.5
    assert across == pytest.approx(whole - along, rel=1e-12)
    (warning,) = path.warnings
    assert "planar contact table-cross:bottom" in warning


def test_shares_sum_to_the_resultant_while_the_centre_of_pressure_moves_to_the_border() -> None:
    rng = np.random.default_rng(7)
    standing = stool(rng)
    scene = make.scene(
        "stool", list(standing.bodies), contact=[{"between": list(pair)} for pair in standing.pairs],
        force=[{"body": "stool", "force": ["60*t", "0", "0"], "point": [0, 0, 0.1]}],
        sensor=[{"name": f"n{k}", "of": "-".join(pair) + ".force"} for k, pair in enumerate(standing.pairs)],
    )  # fmt: skip
    path = simulate(library_of(scene), until=3.0, samples=60, accuracy=TIGHT, estimate=False)
    rests = path.patch[:, 0] >= 0
    assert 10 < rests.sum() < 60
    force, shown = path.patch_force[rests, 0], path.sensors[rests]
    assert shown.sum(axis=1) == pytest.approx(force, rel=1e-9)
    assert shown.min() > -1e-12 * force.max()
    assert np.abs(np.diff(shown, axis=0)).max() < 0.2 * force.max()  # no share jumps


@pytest.mark.parametrize("of", ["stool-table.force", "table/plane-stool/leg1.force"])
def test_a_share_is_differentiated_by_the_load(of: str) -> None:
    standing = stool(np.random.default_rng(3))
    scene = make.scene(
        "stool", list(standing.bodies), contact=[{"between": list(pair)} for pair in standing.pairs],
        input=[{"name": "push", "default": 5.0}], sensor=[{"name": "n", "of": of}],
        force=[{"body": "stool", "force": ["0", "0", "-push"], "point": [0.02, 0.01, 0]}],
    )  # fmt: skip
    library = compiled(emit(derive(require(scene)), derivatives=True))
    found = sensitivity(library, [0.1], by=["push"])
    whole = standing.mass * G
    slope = [shares(standing.feet, whole + p, p / (whole + p) * np.array([0.02, 0.01])) for p in (4.0, 6.0)]
    right = 1.0 if of.startswith("stool") else (slope[1] - slope[0])[1] / 2  # it is affine in the load
    assert float(found.jacobian[0, 0, 0]) == pytest.approx(right, rel=1e-9)


def test_a_pair_of_bodies_without_contact_is_refused() -> None:
    with pytest.raises(SceneError, match="no body, joint or pair named 'cross-floor'"):
        crossed("cross-floor.force")
