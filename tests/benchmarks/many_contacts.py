"""What scenes of many contacts cost by time-stepping.

`python -m tests.benchmarks.many_contacts count` prints instructions of whole runs under callgrind (stacks of
boxes, heaps of spheres with friction), those of set-up taken off. `... sizes [N ...]` runs heaps of N spheres
for one step. Ctrl-C in them: `tests.benchmarks.interruptions`.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from modelgen import Accuracy, build, derive, emit, require, simulate
from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.benchmarks.counting import callgrind, countable

SPACING = 0.13  # m, of the spheres of a heap at the start
DOMINO = (0.02, 0.1, 0.2)  # m
CARD, CARD_MASS = (0.094, 0.064, 0.0007), 1.84e-4  # m, kg
STONES = {
    "sphere": make.sphere(0.05),
    "ellipsoid": make.ellipsoid(0.06, 0.05, 0.04),
    "capsule": make.capsule(0.03, 0.06),
    "box": make.box(0.07, 0.07, 0.07),
}
COUNTED = (("stack", 5, 0.002, 0.05), ("stack", 10, 0.002, 0.02), ("heap", 20, 0.005, 0.4))


def stack(boxes: int) -> Scene:
    """Cubes of 0.1 m at rest on each other."""
    edge = 0.1
    cubes = [
        make.dynamic(
            f"b{i}", make.box(edge, edge, edge), density=1000.0, position=[0.0, 0.0, edge / 2 + i * edge]
        )
        for i in range(boxes)
    ]
    bodies = [make.fixed("floor", make.plane()), *cubes]
    return make.scene(f"stack_{boxes}", bodies, contacts={"between": "all", "friction": 0.5})


def dominoes(count: int, off: np.ndarray | None = None) -> Scene:
    """A ball runs into a row of dominoes; off: (count, 2), by how much each stands aside, m, and is turned,
    rad."""
    row = [
        make.dynamic(
            f"d{i}", make.box(*DOMINO), density=1000.0, position=[0.1 * i, aside, 0.1], rpy=[0.0, 0.0, turn]
        )
        for i, (aside, turn) in enumerate((np.zeros((count, 2)) if off is None else off).tolist())
    ]
    ball = make.dynamic(
        "ball", make.sphere(0.03), density=1000.0, position=[-0.2, 0.0, 0.17], velocity=[2.0, 0.0, 0.0]
    )
    bodies = [make.fixed("floor", make.plane()), *row, ball]
    return make.scene(f"dominoes_{count}", bodies, contacts={"between": "all", "friction": 0.5})


def pyramid(base: int) -> Scene:
    """Cubes of 0.1 m in a pyramid on `base` of them, into which a ball is shot."""
    edge = 0.1
    places = [
        [edge * (i + layer / 2), 0.0, edge * (layer + 0.5)]
        for layer in range(base)
        for i in range(base - layer)
    ]
    cubes = [
        make.dynamic(f"b{k}", make.box(edge, edge, edge), density=1000.0, position=place)
        for k, place in enumerate(places)
    ]
    ball = make.dynamic(
        "ball", make.sphere(0.06), density=3000.0, position=[-0.4, 0.0, 0.2], velocity=[4.0, 0.0, 0.0]
    )
    bodies = [make.fixed("floor", make.plane()), *cubes, ball]
    return make.scene(f"pyramid_{base}", bodies, contacts={"between": "all", "friction": 0.5})


def heap(stones: int, seed: int = 0, kind: str = "sphere") -> Scene:
    """Bodies of one of STONES, turned unless they are spheres, that fall between four walls."""
    rng = np.random.default_rng(seed)
    side = max(2, round((stones / 2) ** (1 / 3)))
    half, turn = side * SPACING / 2 + 0.01, float(np.pi / 2)
    walls = (
        *([-half, 0.0, 0.0], [0.0, turn, 0.0]),
        *([half, 0.0, 0.0], [0.0, -turn, 0.0]),
        *([0.0, -half, 0.0], [-turn, 0.0, 0.0]),
        *([0.0, half, 0.0], [turn, 0.0, 0.0]),
    )
    bodies = [make.fixed("floor", make.plane())]
    bodies += [
        make.fixed(f"w{k}", make.plane(), position=walls[2 * k], rpy=walls[2 * k + 1]) for k in range(4)
    ]
    for i in range(stones):
        layer, place = divmod(i, side * side)
        at = [
            SPACING * (n - (side - 1) / 2) + float(rng.uniform(-0.004, 0.004))
            for n in (place % side, place // side)
        ]
        rpy = [0.0, 0.0, 0.0] if kind == "sphere" else rng.uniform(-0.6, 0.6, 3).tolist()
        at.append(0.08 + SPACING * layer)
        bodies.append(make.dynamic(f"s{i}", STONES[kind], density=1000.0, position=at, rpy=rpy))
    return make.scene(f"heap_{stones}", bodies, contacts={"between": "all", "friction": 0.5})


def cards(count: int) -> Scene:
    """A spread deck of cards that falls onto a rod, as MuJoCo's `cards` has it, with rigid cards."""
    turned = np.pi / 2
    rod = make.fixed(
        "rod", make.capsule(0.03, 0.2), position=[0.1, 0.0, -0.3], rpy=[turned, 0.0, 0.0]
    )  # fmt: skip
    bodies = [make.fixed("floor", make.plane(), position=[0.0, 0.0, -1.0]), rod]
    for k in range(count):
        tilt = -100.0 - 3.0 * k  # degrees
        half = float(np.radians(tilt) / 2)
        bodies.append(
            make.dynamic(
                f"c{k}", make.box(*CARD), density=CARD_MASS / float(np.prod(CARD)),
                position=[0.005 * k, -6.5e-6 * (tilt + 177.0) ** 2, -0.005 * k],
                quaternion=[0.0, 0.0, float(np.cos(half)), float(np.sin(half))],
            )
        )  # fmt: skip
    return make.scene(f"cards_{count}", bodies, contacts={"between": "all", "friction": 0.1})


SCENES: dict[str, Callable[[int], Scene]] = {
    "stack": stack, "pyramid": pyramid, "dominoes": dominoes, "heap": heap, "cards": cards
}  # fmt: skip


def built(kind: str, bodies: int, folder: str) -> Library:
    return build(emit(derive(require(SCENES[kind](bodies)))), folder=folder)


def run(folder: Path, step: float, until: float) -> None:
    """A run by time-stepping, without its estimate; `until` 0: its set-up alone."""
    library = Library.load(folder)
    path = simulate(
        library, until=until or 1e-9, accuracy=Accuracy.fast(), method="time-stepping", step=step,
        samples=1, estimate=False,
    )  # fmt: skip
    print(
        f"{path.outcome.value} t={path.t_end:.4g} steps={path.steps} penetration={path.penetration_max:.2g} "
        f"residual={path.complementarity_max:.2g}"
    )


def count() -> None:
    print("| scene | steps of | until | instructions |\n|---|---|---|---|")
    for kind, bodies, step, until in COUNTED:
        with TemporaryDirectory() as folder, TemporaryDirectory() as target:
            countable(built(kind, bodies, folder), Path(target))
            module = "tests.benchmarks.many_contacts"
            whole, empty = (callgrind(module, "run", target, step, end) for end in (until, 0.0))
        print(f"| {kind} of {bodies} | {step} s | {until} s | {whole - empty:.4g} |", flush=True)


def sizes(numbers: list[int]) -> None:
    for spheres in numbers:
        with TemporaryDirectory() as folder:
            try:
                built("heap", spheres, folder)
                run(Path(folder), 0.005, 0.005)
            except ModelgenError as refused:
                print(f"{spheres} spheres: refused: {refused}")


def main() -> None:
    what, *rest = sys.argv[1:] or ["count"]
    if what == "run":
        run(Path(rest[0]), float(rest[1]), float(rest[2]))
    elif what == "sizes":
        sizes([int(text) for text in rest] or [200, 300, 500])
    else:
        count()


if __name__ == "__main__":
    main()
