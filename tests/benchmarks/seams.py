"""Bodies that slide, roll and spin over the seams of fixed shapes that join flush: they form one ground.

    python -m tests.benchmarks.seams [--count 1000] [--part 1/2] [--only SLIDER] [--member K]

Two boxes, also welded to each other, two polyhedra, an extrusion beside a box, a plug in a plane, or two
shapes of one body have their tops at one height as people write it (0.3 and 0.1 + 0.2), or apart by 1e-16 to
1e-3 m by decades. The ground is a floor, wall or ceiling, turned at random with gravity. Without friction a
body keeps its velocity (closed form) to 1e-9 of it, and to 1e-6 by time-stepping. With friction its run
agrees with one on a single ground within the stated errors of both. A step that is higher than
`Accuracy.flush_height` is struck. Told for each slider: right, doubted, wrong and trusted.
"""

from __future__ import annotations

import argparse
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from modelgen import Accuracy, ModelgenError, derive, emit, require, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene, Shape
from tests.running import compiled

G, KEPT = 9.81, 1e-9
HEIGHTS = ((0.3, 0.1 + 0.2), (0.0, 0.0), (0.7, 0.1 * 7), (1.1, 1.0 + 0.1), (-0.6, -0.2 * 3))  # m
OFFSETS = (
    0.0,
    *(sign * 10.0**-k for k in range(9, 17) for sign in (1, -1)),
    *(10.0**-k for k in range(3, 9)),
)
STEP, KEPT_BY_STEPS = 1e-3, 1e-6  # s; part of the velocity

# kind: shapes of the slider, height of its origin above the ground
SLIDERS: Mapping[str, tuple[tuple[Shape, ...], float]] = {
    "box": ((make.box(0.3, 0.2, 0.1),), 0.05),
    "puck": ((make.cylinder(0.15, 0.1),), 0.05),
    "tube": ((make.tube(0.15, 0.1, 0.1),), 0.05),
    "frustum": ((make.frustum(0.2, 0.1, 0.1),), 0.05),
    "dome": ((make.dome(0.15, 0.1),), 0.0),
    "prism": ((make.extrusion(length=0.1, points=[[-0.1, -0.1], [0.15, -0.05], [0.0, 0.12]]),), 0.05),
    "polyhedron": (
        (make.polyhedron([[-0.1, -0.1, 0], [0.2, -0.1, 0], [0.1, 0.15, 0], [-0.1, 0.1, 0], [0, 0, 0.2]]),),
        0.0,
    ),
    "stool": (
        tuple(
            make.box(0.05, 0.05, 0.1, name=f"leg{k}", position=[x, y, 0.0])
            for k, (x, y) in enumerate(((0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1)))
        ),
        0.05,
    ),
    "ball": ((make.sphere(0.1),), 0.1),
    "ellipsoid": ((make.ellipsoid(0.2, 0.2, 0.1),), 0.1),
    "capsule": ((make.capsule(0.1, 0.3, rpy=[np.pi / 2, 0.0, 0.0]),), 0.1),
    "roller": ((make.cylinder(0.1, 0.3, rpy=[np.pi / 2, 0.0, 0.0]),), 0.1),
    "torus": ((make.torus(0.15, 0.05),), 0.05),
}  # fmt: skip
ROUND = ("ball", "ellipsoid", "capsule", "roller", "torus")  # a low step slows them by little
GROUNDS = ("boxes", "one body", "polyhedra", "extrusion", "welded", "plug", "round plug")


@dataclass(frozen=True)
class Member:
    """A slider on a ground, and what is known of its motion."""

    slider: str
    ground: str
    offset: float  # m, of the second shape
    friction: float
    speed: float
    turn: float  # rad/s about the normal
    yaw: float
    width: float  # m, of the second shape
    heights: tuple[float, float]
    rotation: Rotation  # of the whole scene
    until: float

    def scene(self, seamless: bool = False) -> Scene:
        level, other = self.heights[0], self.heights[1] + self.offset
        shapes, above = SLIDERS[self.slider]
        turned = self.rotation
        moving = {
            "position": row(turned.apply([-0.4, 0.0, level + above])),
            "quaternion": quaternion_row(turned * Rotation.from_rotvec([0, 0, self.yaw])),
            "velocity": row(turned.apply([self.speed, 0.0, 0.0])),
            "angular_velocity": row(turned.apply([0.0, 0.0, self.turn])),
            "mass": 1.0,
            "inertia": [0.01, 0.01, 0.01],
        }
        slider = make.dynamic("slider", *shapes, **moving)
        at = {"quaternion": quaternion_row(turned)}
        fixed = self._seamless(level, at) if seamless else self._seamed(level, other, at)
        contacts = [
            {"between": [f"slider/{a.name}" if len(shapes) > 1 else "slider", b], "restitution": 0.3}
            | ({"friction": self.friction} if self.friction else {})
            for a in shapes
            for b in fixed[1]
        ]
        is_welded = self.ground == "welded" and not seamless
        welds = [{"kind": "weld", "between": ["left", "right"]}] if is_welded else []
        down = row(turned.apply([0, 0, -G]))
        return make.scene("seam", [*fixed[0], slider], gravity=down, contact=contacts, joint=welds)

    def _seamless(self, level: float, at: Mapping[str, Any]) -> tuple[list[Any], list[str]]:
        """A plane in place of the plugged one; one prism in place of two solids."""
        if self.ground.endswith("plug"):
            where = row(self.rotation.apply([0.0, 0.0, level]))
            return [make.fixed("ground", make.plane(), position=where, **at)], ["ground"]
        w = self.width / 2
        points = [[-2, -1], [0, -1], [0, -w], [2, -w], [2, w], [0, w], [0, 1], [-2, 1]]
        if w == 1.0:
            points = [[-2, -1], [2, -1], [2, 1], [-2, 1]]
        where = row(self.rotation.apply([0.0, 0.0, level - 0.5]))
        return [make.fixed("ground", make.extrusion(length=1.0, points=points), position=where, **at)], [
            "ground"
        ]

    def _seamed(self, level: float, other: float, at: Mapping[str, Any]) -> tuple[list[Any], list[str]]:
        def placed(name: str, shape: Shape, where: Sequence[float]) -> Any:
            return make.fixed(name, shape, position=row(self.rotation.apply(where)), **at)

        w = self.width
        if self.ground == "boxes":
            return [
                placed("left", make.box(2.0, 2.0, 2.0), [-1.0, 0.0, level - 1.0]),
                placed("right", make.box(2.0, w, 2.0), [1.0, 0.0, other - 1.0]),
            ], ["left", "right"]
        if self.ground == "welded":
            where = {"position": row(self.rotation.apply([1.0, 0.0, other - 1.0])), **at}
            right = make.dynamic("right", make.box(2.0, w, 2.0), density=100.0, **where)
            return [placed("left", make.box(2.0, 2.0, 2.0), [-1.0, 0.0, level - 1.0]), right], [
                "left",
                "right",
            ]
        if self.ground == "one body":
            shapes = (
                make.box(2.0, 2.0, 2.0, name="left", position=[-1.0, 0.0, level - 1.0]),
                make.box(2.0, w, 1.0, name="right", position=[1.0, 0.0, other - 0.5]),
            )
            return [make.fixed("ground", *shapes, **at)], ["ground/left", "ground/right"]
        if self.ground == "polyhedra":
            return [
                placed(
                    "left", make.polyhedron(_corners(-2.0, 0.0, 1.0, level - 1.0, level)), [0.0, 0.0, 0.0]
                ),
                placed(
                    "right", make.polyhedron(_corners(0.0, 2.0, w / 2, other - 0.5, other)), [0.0, 0.0, 0.0]
                ),
            ], ["left", "right"]
        if self.ground == "extrusion":
            points = [[0.0, -w / 2], [2.0, -w / 2], [2.0, w / 2], [0.0, w / 2]]
            return [
                placed("left", make.box(2.0, 2.0, 2.0), [-1.0, 0.0, level - 1.0]),
                placed("right", make.extrusion(length=0.5, points=points), [0.0, 0.0, other - 0.25]),
            ], ["left", "right"]
        plug = make.box(0.3, w, 0.5) if self.ground == "plug" else make.cylinder(min(w, 0.5) / 2, 0.5)
        return [
            placed("floor", make.plane(), [0.0, 0.0, level]), placed("plug", plug, [0.2, 0.0, other - 0.25])
        ], ["floor", "plug"]  # fmt: skip


def _corners(x0: float, x1: float, y: float, z0: float, z1: float) -> list[list[float]]:
    return [[x, s * y, z] for x in (x0, x1) for s in (-1, 1) for z in (z0, z1)]


def row(values: Any) -> list[float]:
    """Numbers as a scene takes them."""
    return [float(each) for each in np.asarray(values, dtype=float)]


def quaternion_row(rotation: Rotation) -> list[float]:
    """w, x, y, z."""
    return row(np.roll(rotation.as_quat(), 1))


def drawn(seed: int, sliders: Sequence[str]) -> Member:
    """The member of that number."""
    random = np.random.default_rng([41, seed])
    slider = sliders[seed % len(sliders)]
    grounds = GROUNDS[:5] if slider == "torus" else GROUNDS  # a whole plane does not hold a torus
    ground = grounds[int(random.integers(len(grounds)))]
    friction = float(random.choice([0.0, 0.0, 10 ** random.uniform(-2, -0.3)]))
    speed = float(random.uniform(1.0, 3.0))
    rolls = slider in ("capsule", "roller")
    turn = 0.0 if rolls or random.integers(2) else float(random.uniform(-3, 3))
    # a round body without friction: also spinning about the normal; those that lie: along x, nearly
    yaw = float(random.uniform(-0.5, 0.5) if rolls else random.uniform(-np.pi, np.pi))
    width = 2.0 if random.integers(2) else float(random.uniform(0.05, 1.0))
    rotation = Rotation.identity() if random.integers(2) else Rotation.random(random_state=seed)
    heights = HEIGHTS[int(random.integers(len(HEIGHTS)))]
    offset = float(random.choice(OFFSETS)) if random.integers(2) else 0.0
    if width < 2.0 and slider != "ball" and not ground.endswith("plug"):
        width = 2.0 if slider in ("capsule", "roller", "ellipsoid", "torus", "stool") else width
    return Member(slider, ground, offset, friction, speed, turn, yaw, width, heights, rotation, 0.55 / speed)


def judged(member: Member) -> tuple[str, str]:
    """(verdict, why)."""
    try:
        library = compiled(emit(derive(require(member.scene()))))
        path = _run(library, member.until)
        wrong = _fault(member, library, path)
    except ModelgenError as error:
        return "refused", str(error)[:160]
    told = "" if path.is_trusted else f"{path.outcome} {path.doubts[:2]}"
    if not wrong:
        return ("right" if path.is_trusted else "right, doubted"), told
    return ("WRONG" if path.is_trusted else "wrong, doubted"), f"{wrong}; {told}"


def _run(library: Library, until: float) -> Trajectory:
    return simulate(library, until=until, samples=8, accuracy=Accuracy.balanced())


def _fault(member: Member, library: Library, path: Trajectory) -> str:
    if member.offset > Accuracy().flush_height * library.manifest.instance["scales"]["length"]:
        is_struck = any(event.kind == "impact" for event in path.events)
        return "" if is_struck or member.friction else "the step was not struck"
    if member.friction:
        alone = _run(compiled(emit(derive(require(member.scene(seamless=True))))), member.until)
        if not len(alone.t) or not len(path.t):
            return "no run"
        apart = np.linalg.norm(alone.p[-1, -1] - path.p[-1, -1])
        allowed = 2 * (_stated(alone) + _stated(path)) + 1e-9
        return f"apart {apart:.1e} of {allowed:.1e}" if not apart <= allowed else ""
    stepped = Accuracy.balanced().time_stepping(STEP)
    by_steps = simulate(library, until=member.until, samples=8, accuracy=stepped, estimate=False)
    return _loss(member, path, KEPT) or _loss(member, by_steps, KEPT_BY_STEPS)


def _loss(member: Member, path: Trajectory, kept: float) -> str:
    """What a body without friction lost of its velocity and spin; empty if no more than it may."""
    if not len(path.t):
        return "no run"
    v0 = member.rotation.apply([member.speed, 0.0, 0.0])
    w0 = member.rotation.apply([0.0, 0.0, member.turn])
    lost = np.abs(path.v[:, -1] - v0).max() / member.speed
    spun = np.abs(path.w[:, -1] - w0).max() / max(1.0, abs(member.turn))
    if path.t[-1] < member.until * (1 - 1e-9):
        return f"ended at {path.t[-1]:.3g} of {member.until:.3g}"
    return "" if max(lost, spun) <= kept else f"velocity {lost:.1e}, spin {spun:.1e}, of {kept:g}"


def _stated(path: Trajectory) -> float:
    return float(path.position_error[-1])


def members_asked_for(text: str | None, count: int, kinds: Iterable[str]) -> tuple[Sequence[int], list[str]]:
    """The numbers of members and the kinds that the command line of a study asks for; `text` describes it."""
    parser = argparse.ArgumentParser(description=text, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--count", type=int, default=count)
    parser.add_argument("--part", default="1/1")
    parser.add_argument("--only", nargs="*", default=list(kinds))
    parser.add_argument("--member", type=int)
    chosen = parser.parse_args()
    part, parts = map(int, chosen.part.split("/"))
    seeds = range(part - 1, chosen.count, parts) if chosen.member is None else [chosen.member]
    return seeds, chosen.only


def main() -> None:
    seeds, only = members_asked_for(__doc__, 1000, SLIDERS)
    table: defaultdict[str, Counter[str]] = defaultdict(Counter)
    for seed in seeds:
        member = drawn(seed, only)
        verdict, why = judged(member)
        table[member.slider][verdict] += 1
        if verdict != "right":
            print(
                seed,
                verdict,
                member.slider,
                member.ground,
                f"{member.offset:g} mu {member.friction:.2g}",
                why,
                flush=True,
            )
    for name, counts in table.items():
        print(f"{name:12}", dict(counts))


if __name__ == "__main__":
    main()
