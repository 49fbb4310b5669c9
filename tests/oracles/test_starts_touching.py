"""A start at which bodies touch along faces, lines or at points is not refused, whatever their shapes."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.spatial.transform import Rotation

from modelgen import simulate
from modelgen.errors import SimulationError
from modelgen.runtime.trajectory import Outcome
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.oracles.outlines import OUTLINES
from tests.running import library_of

Array = np.ndarray
GAPS = (0.0, 1e-12, -1e-12, 1e-10, -3e-11, 1e-9, 1e-8, 1e-6, 1e-3)  # m; start_gap is 1e-10 m or more
LENGTH = 0.02  # of extrusions, m
STANDING, LYING = Rotation.identity(), Rotation.from_euler("x", pi / 2)
WAVES = ("0.02*cos(t)*(1 + 0.25*cos(2*t))", "0.014*sin(t)*(1 + 0.25*cos(2*t))")


def wave_height(angle: float) -> float:
    """Least height of the outline WAVES turned by an angle about its middle, m."""

    def height(t: float) -> float:
        y = 0.014 * np.sin(t) * (1 + 0.25 * np.cos(2 * t))
        return float(np.sin(angle) * 0.02 * np.cos(t) * (1 + 0.25 * np.cos(2 * t)) + np.cos(angle) * y)

    coarse = np.linspace(0, 2 * pi, 400)
    near = coarse[np.argmin([height(t) for t in coarse])]
    found = minimize_scalar(
        height, bounds=(near - 0.02, near + 0.02), method="bounded", options={"xatol": 1e-12}
    )
    return float(found.fun)


def prism(outline: Array) -> tuple[Shape, Array]:
    """An extrusion and its corners."""
    corners = [np.column_stack([outline, np.full(len(outline), z)]) for z in (-LENGTH / 2, LENGTH / 2)]
    return make.extrusion(LENGTH, points=outline.tolist()), np.vstack(corners)


def cuboid(*sides: float) -> tuple[Shape, Array]:
    corners = np.stack(np.meshgrid(*[(-side / 2, side / 2) for side in sides]), axis=-1).reshape(-1, 3)
    return make.box(*sides), corners


TETRAHEDRON = np.array([[0.02, 0, 0], [-0.01, 0.017, 0], [-0.01, -0.017, 0], [0, 0, 0.02]])
POLYHEDRA = {
    "box": cuboid(0.02, 0.03, 0.01),
    "tetrahedron": (make.polyhedron(TETRAHEDRON.tolist()), TETRAHEDRON),
    **{name: prism(OUTLINES[name]) for name in ("hook", "star", "wedge", "saw")},
}


def curved(name: str, size: float) -> tuple[Shape, float, float]:
    """A shape, and its height over its lowest point: with its axis upright, and level."""
    r = size
    return {
        "cylinder": (make.cylinder(r, 3 * r), 1.5 * r, r),
        "tube": (make.tube(1.2 * r, 0.8 * r, 3 * r), 1.5 * r, 1.2 * r),
        "capsule": (make.capsule(r, 3 * r), 2.5 * r, r),
        "torus": (make.torus(1.5 * r, 0.4 * r), 0.4 * r, 1.9 * r),
        "half torus": (make.half_torus(1.5 * r, 0.4 * r), 0.4 * r, 0.4 * r),
        "dome": (make.dome(r, r), 0.0, r),
        "frustum": (make.frustum(r, 0.7 * r, 2 * r), r, r),
        "tip": (make.frustum(r, 0.05 * r, 2 * r), r, r),
        "ellipsoid": (make.ellipsoid(r, 0.8 * r, 0.6 * r), 0.6 * r, 0.8 * r),
    }[name]


CURVED = (
    "cylinder", "tube", "capsule", "torus", "half torus", "dome", "frustum", "tip", "ellipsoid",
)  # fmt: skip
LOWER = {  # with the height of its level top
    "hook": (prism(OUTLINES["hook"])[0], LENGTH / 2),
    "saw": (prism(OUTLINES["saw"])[0], LENGTH / 2),
    "tube": (make.tube(0.04, 0.015, 0.03), 0.015),
    "waves": (make.extrusion(LENGTH, x=WAVES[0], y=WAVES[1], domain=(0.0, 2 * pi)), LENGTH / 2),
}


def spun(rng: np.random.Generator) -> Rotation:
    return Rotation.from_euler("z", float(rng.choice([0.0, pi / 2, rng.uniform(0, 2 * pi)])))


def resting(rng: np.random.Generator, name: str, size: float) -> tuple[Shape, Rotation, float]:
    """A curved shape with its axis upright or level, a rotation, and the height over its lowest point."""
    spin, stands = spun(rng), bool(rng.integers(2))
    shape, *heights = curved(name, size)
    return shape, spin * (STANDING if stands or name == "half torus" else LYING), heights[not stands]


def world_axes(rng: np.random.Generator, seed: int) -> Rotation:
    return Rotation.create_group("O")[int(rng.integers(24))] if seed % 2 else Rotation.random(rng=rng)


def placed(rng: np.random.Generator, name: str) -> tuple[Shape, Rotation, float]:
    """A shape, a rotation, and the height of its origin over its lowest point."""
    if name in CURVED:
        return resting(rng, name, 0.01)
    spin = spun(rng)
    if name in POLYHEDRA:
        shape, corners = POLYHEDRA[name]
        turn = spin * Rotation.create_group("O")[int(rng.integers(24))]
        if rng.random() < 0.25:
            turn = Rotation.random(rng=rng)
        return shape, turn, -float(np.min(turn.apply(corners)[:, 2]))
    shape = LOWER["waves"][0]
    if rng.integers(2):
        return shape, spin, LENGTH / 2
    angle = float(rng.choice([0.0, rng.uniform(0, 2 * pi)]))
    return shape, spin * LYING * Rotation.from_euler("z", angle), -wave_height(angle)


def pose(turn: Rotation, position: Array) -> dict[str, object]:
    return {"position": position.tolist(), "quaternion": np.roll(turn.as_quat(), 1).tolist()}


def assert_starts(
    shapes: tuple[Shape, Shape], poses: tuple[dict[str, object], ...], is_lower_fixed: bool
) -> None:
    bodies = [
        make.fixed(name, shape, **at)
        if is_fixed
        else make.dynamic(name, shape, mass=0.1, inertia=[1e-3] * 3, **at)
        for name, shape, at, is_fixed in zip(
            ("lower", "upper"), shapes, poses, (is_lower_fixed, not is_lower_fixed), strict=True
        )
    ]
    scene = make.scene("touch", bodies, contact=[{"between": ["upper", "lower"], "friction": 0.0}])
    path = simulate(library_of(scene), until=1e-9, samples=1, estimate=False)
    assert path.outcome is Outcome.DONE


@pytest.mark.cases(6)
@pytest.mark.parametrize("depth", [1e-9, 2e-9, 5e-9, 2e-8, 1e-6])  # m; start_gap is 6e-10 m or less
@pytest.mark.parametrize("above", [*POLYHEDRA, *CURVED, "waves"])
def test_a_body_sunk_into_a_level_top_is_refused(above: str, depth: float) -> None:
    """On a face, an edge, a vertex, a line or a point, however little deeper than what touches."""
    rng = np.random.default_rng([len(above), int(1e9 * depth)])
    upper, turn, height = placed(rng, above)
    axes = world_axes(rng, int(rng.integers(2)))
    at = np.array([*rng.uniform(-0.02, 0.02, 2), 0.02 + height - depth])
    poses = pose(axes, np.zeros(3)), pose(axes * turn, axes.apply(at))
    with pytest.raises(SimulationError, match="interpenetrate at the start by"):
        assert_starts((make.box(0.2, 0.2, 0.04), upper), poses, True)


@pytest.mark.cases(8)
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("above", [*POLYHEDRA, *CURVED, "waves"])
@pytest.mark.parametrize("below", LOWER)
def test_a_body_on_a_level_top_is_not_refused(below: str, above: str, seed: int) -> None:
    """On a face, an edge, a vertex, a line or a point; in any axes, whichever body is the fixed one."""
    rng = np.random.default_rng([seed, len(above), len(below)])
    lower, top = LOWER[below]
    upper, turn, height = placed(rng, above)
    axes = world_axes(rng, seed)
    at = np.array([*rng.uniform(-0.02, 0.02, 2), top + height + float(rng.choice(GAPS))])
    poses = pose(axes, np.zeros(3)), pose(axes * turn, axes.apply(at))
    assert_starts((lower, upper), poses, bool(rng.integers(2)))


@pytest.mark.cases(3)
@pytest.mark.parametrize("seed", range(60))
def test_a_corner_on_a_corner_is_not_refused(seed: int) -> None:
    """Two vertices are nearest, which no contact follows: at a gap no closest points are found."""
    rng = np.random.default_rng(seed)
    (lower, below), (upper, above) = (POLYHEDRA[str(name)] for name in rng.choice(list(POLYHEDRA), 2))
    turns = Rotation.random(2, rng=rng)
    ends = turns[0].apply(below), turns[1].apply(above)
    top, bottom = ends[0][ends[0][:, 2].argmax()], ends[1][ends[1][:, 2].argmin()]
    at = top - bottom + [0.0, 0.0, float(rng.choice([*GAPS, 0.01]))]
    assert_starts((lower, upper), (pose(turns[0], np.zeros(3)), pose(turns[1], at)), bool(rng.integers(2)))


FACES = {  # of the hook: a point in the middle, and the normal
    "outer side": ([-0.015, 0.0, 0.0], [-1.0, 0.0, 0.0]),
    "bottom": ([0.0, -0.015, 0.0], [0.0, -1.0, 0.0]),
    "floor of the notch": ([0.0, -0.005, 0.0], [0.0, 1.0, 0.0]),
    "wall of the notch": ([0.015, 0.01, 0.0], [-1.0, 0.0, 0.0]),
    "end": ([0.02, 0.0, 0.01], [0.0, 0.0, 1.0]),
}


@pytest.mark.cases(6)
@pytest.mark.parametrize("size", [3e-3, 1e-3, 3e-4, 1e-4, 3e-5])
@pytest.mark.parametrize("name", CURVED)
@pytest.mark.parametrize("face", FACES)
def test_a_small_body_on_a_face_is_not_refused(face: str, name: str, size: float) -> None:
    """However small it is beside what lies behind the face."""
    rng = np.random.default_rng([len(face), len(name), int(1e6 * size)])
    point, normal = map(np.array, FACES[face])
    upright = Rotation.align_vectors([normal], [[0.0, 0.0, 1.0]])[0]
    shape, turn, height = resting(rng, name, size)
    gap = size * float(rng.choice([*GAPS[:6], 0.1]))
    poses = pose(STANDING, np.zeros(3)), pose(upright * turn, point + normal * (height + gap))
    assert_starts((LOWER["hook"][0], shape), poses, bool(rng.integers(2)))


def outermost_sides(outline: Array) -> list[tuple[Array, Array]]:
    """Sides with all of the outline to their left."""
    sides = zip(outline, np.roll(outline, -1, axis=0), strict=True)
    return [(p, q) for p, q in sides if ((outline - p) @ [p[1] - q[1], q[0] - p[0]] >= -1e-12).all()]


SIDED = [name for name, outline in OUTLINES.items() if outermost_sides(outline)]


@pytest.mark.cases(5)
@pytest.mark.parametrize("seed", range(60))
def test_extrusions_side_by_side_are_not_refused(seed: int) -> None:
    """Level with each other or not, side against side."""
    rng = np.random.default_rng(seed)
    outlines = [OUTLINES[str(name)] for name in rng.choice(SIDED, 2)]
    shapes = [prism(outline)[0] for outline in outlines]
    (p, q), (r, s) = (sides[int(rng.integers(len(sides)))] for sides in map(outermost_sides, outlines))
    along, back = (q - p) / np.linalg.norm(q - p), (r - s) / np.linalg.norm(r - s)
    rotation = Rotation.from_euler("z", float(np.arctan2(*along[::-1]) - np.arctan2(*back[::-1])))
    turn = rotation.as_matrix()[:2, :2]
    outward = np.array([along[1], -along[0]])
    part, own = rng.uniform(0, 1), float(rng.choice([0.0, 0.5, 1.0, rng.uniform(0, 1)]))
    at = p + part * (q - p) - turn @ (r + own * (s - r)) + float(rng.choice(GAPS)) * outward
    shift = float(rng.choice([0.0, rng.uniform(-0.9, 0.9) * LENGTH]))
    axes = world_axes(rng, seed)
    poses = pose(axes, np.zeros(3)), pose(axes * rotation, axes.apply([*at, shift]))
    assert_starts((shapes[0], shapes[1]), poses, bool(rng.integers(2)))


SLOT = np.array([[-3, -1], [3, -1], [3, 2], [1, 2], [1, 0], [-1, 0], [-1, 2], [-3, 2]]) / 100
FITS = {  # a box in or at the slot: its sides along x and y, and its middle, m
    "fills the slot": ((0.02, 0.01), (0.0, 0.005)),
    "on one wall of the slot": ((0.01, 0.01), (-0.005, 0.01)),
    "in the corner of the slot": ((0.01, 0.01), (0.005, 0.005)),
    "above the slot": ((0.04, 0.01), (0.0, 0.025)),
    "beside the slot": ((0.01, 0.04), (0.035, 0.0)),
}


@pytest.mark.cases(3)
@pytest.mark.parametrize("length", [0.01, LENGTH, 0.04])
@pytest.mark.parametrize("shift", [0.0, 0.004])
@pytest.mark.parametrize("name", FITS)
def test_a_box_that_fits_a_slot_is_not_refused(name: str, length: float, shift: float) -> None:
    sides, middle = FITS[name]
    poses = pose(STANDING, np.zeros(3)), pose(STANDING, np.array([*middle, shift]))
    assert_starts((prism(SLOT)[0], make.box(*sides, length)), poses, True)


@pytest.mark.cases(1)
@pytest.mark.parametrize("number", range(24))
@pytest.mark.parametrize("gap", [0.0, 1e-12, -1e-12, 1e-10, -1e-10])
def test_a_box_on_a_box_is_not_refused(number: int, gap: float) -> None:
    turn = Rotation.from_euler("z", 0.3) * Rotation.create_group("O")[number]
    shape, corners = POLYHEDRA["box"]
    height = -float(np.min(turn.apply(corners)[:, 2]))
    poses = pose(STANDING, np.zeros(3)), pose(turn, np.array([0.001, 0.002, 0.02 + height + gap]))
    assert_starts((make.box(0.05, 0.05, 0.04), shape), poses, True)
