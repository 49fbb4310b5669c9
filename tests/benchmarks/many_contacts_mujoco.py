"""Scenes of many contacts with friction by time-stepping, beside MuJoCo at its defaults.

Run with `python -m tests.benchmarks.many_contacts_mujoco [SCENE ..]`, as in `heap:sphere:20 stack:10
dominoes:10`; needs the extra `peers`. modelgen runs at `fast` with steps of 5 ms, MuJoCo with 2 ms, each in
CPU time of one thread, in turn, the shorter of two. Penetration is what each program tells of its own
contacts.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import numpy as np

from modelgen import build, derive, emit, require, simulate
from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError
from modelgen.scene import python_scenes as make
from tests.benchmarks.many_contacts import SPACING

SCENES = (
    *(f"stack:{n}" for n in (5, 10)),
    *("dominoes:10", "heap:sphere:20", "heap:ellipsoid:20", "heap:capsule:20"),
    *(f"heap:sphere:{n}" for n in (50, 100, 200)),
)
FRICTION, DENSITY = 0.5, 1000.0
STEP, PEER_STEP, UNTIL = 0.005, 0.002, 2.0  # s
SHAPES = {
    "sphere": make.sphere(0.05),
    "ellipsoid": make.ellipsoid(0.06, 0.05, 0.04),
    "capsule": make.capsule(0.03, 0.06),
    "box": make.box(0.07, 0.07, 0.07),
}
SIZES = {"sphere": "0.05", "ellipsoid": "0.06 0.05 0.04", "capsule": "0.03 0.03", "box": "0.035 0.035 0.035"}
TITLES = (
    "scene",
    "contacts",
    "CPU s per s",
    "MuJoCo",
    "ratio",
    "penetration (m)",
    "MuJoCo",
    "complementarity",
)


@dataclass(frozen=True, slots=True)
class Body:
    """One body as both programs take it: a shape here, kind and sizes of a geom there."""

    shape: Any
    geom: tuple[str, str]
    position: tuple[float, ...]
    rpy: tuple[float, ...] = (0.0, 0.0, 0.0)
    velocity: tuple[float, ...] = (0.0, 0.0, 0.0)
    fixed: bool = False


def plane(*position: float, rpy: tuple[float, ...] = (0.0, 0.0, 0.0)) -> Body:
    return Body(make.plane(), ("plane", "5 5 1"), position, rpy, fixed=True)


def box(x: float, y: float, z: float, *position: float) -> Body:
    return Body(make.box(x, y, z), ("box", f"{x / 2} {y / 2} {z / 2}"), position)


def stack(boxes: int) -> Iterator[Body]:
    """Cubes of 0.1 m at rest on each other."""
    for i in range(boxes):
        yield box(0.1, 0.1, 0.1, 0.0, 0.0, 0.05 + 0.1 * i)


def dominoes(count: int) -> Iterator[Body]:
    """A ball runs into a row of dominoes."""
    for i in range(count):
        yield box(0.02, 0.1, 0.2, 0.1 * i, 0.0, 0.1)
    yield Body(make.sphere(0.03), ("sphere", "0.03"), (-0.2, 0.0, 0.17), velocity=(2.0, 0.0, 0.0))


def heap(kind: str, count: int) -> Iterator[Body]:
    """Bodies of one kind that fall between four walls."""
    random = np.random.default_rng(0)
    side = max(2, round((count / 2) ** (1 / 3)))
    half, turn = side * SPACING / 2 + 0.01, float(np.pi / 2)
    yield plane(-half, 0, 0, rpy=(0.0, turn, 0.0))
    yield plane(half, 0, 0, rpy=(0.0, -turn, 0.0))
    yield plane(0, -half, 0, rpy=(-turn, 0.0, 0.0))
    yield plane(0, half, 0, rpy=(turn, 0.0, 0.0))
    for i in range(count):
        layer, place = divmod(i, side * side)
        x, y = (
            SPACING * (n - (side - 1) / 2) + float(random.uniform(-0.004, 0.004))
            for n in (place % side, place // side)
        )
        rpy = (0.0, 0.0, 0.0) if kind == "sphere" else tuple(random.uniform(-0.6, 0.6, 3).tolist())
        yield Body(SHAPES[kind], (kind, SIZES[kind]), (x, y, 0.08 + SPACING * layer), rpy)


def bodies_of(spec: str) -> list[Body]:
    kind, *rest = spec.split(":")
    made = {"stack": stack, "dominoes": dominoes}
    several = heap(rest[0], int(rest[1])) if kind == "heap" else made[kind](int(rest[0]))
    return [plane(0.0, 0.0, 0.0), *several]


def library_of(bodies: list[Body], folder: str) -> Library:
    written = [
        make.fixed(f"b{i}", body.shape, position=body.position, rpy=body.rpy)
        if body.fixed
        else make.dynamic(
            f"b{i}", body.shape, density=DENSITY, position=body.position, rpy=body.rpy, velocity=body.velocity
        )
        for i, body in enumerate(bodies)
    ]
    scene = make.scene("many", written, contacts={"between": "all", "friction": FRICTION})
    return build(emit(derive(require(scene))), folder=folder)


def mjcf(bodies: list[Body]) -> str:
    def words(values: tuple[float, ...]) -> str:
        return " ".join(map(repr, map(float, values)))

    text = ""
    for body in bodies:
        kind, size = body.geom
        geom = f'<geom type="{kind}" size="{size}" density="{DENSITY}" friction="{FRICTION} 0 0"/>'
        free = "" if body.fixed else "<freejoint/>"
        text += f'<body pos="{words(body.position)}" euler="{words(body.rpy)}">{free}{geom}</body>'
    return f"""<mujoco><compiler angle="radian" eulerseq="XYZ"/><option timestep="{PEER_STEP}"/>
    <size memory="1G"/><worldbody>{text}</worldbody></mujoco>"""


def peer_run(text: str, bodies: list[Body]) -> tuple[float, float]:
    """CPU s per s, and the deepest contact, m."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    moving = [body for body in bodies if not body.fixed]
    data.qvel.reshape(-1, 6)[:, :3] = [body.velocity for body in moving]
    deepest, begun = 0.0, process_time()
    for _ in range(round(UNTIL / PEER_STEP)):
        mujoco.mj_step(model, data)
        if data.ncon:
            deepest = min(deepest, float(data.contact.dist.min()))
    return (process_time() - begun) / UNTIL, -deepest


def row(spec: str) -> str:
    bodies = bodies_of(spec)
    text, spent, theirs = mjcf(bodies), float("inf"), (float("inf"), 0.0)
    with TemporaryDirectory() as folder:
        library = library_of(bodies, folder)
        for _ in range(2):
            begun = process_time()
            path = simulate(
                library, until=UNTIL, accuracy="fast", method="time-stepping", step=STEP, samples=20,
                estimate=False,
            )  # fmt: skip
            spent = min(spent, (process_time() - begun) / UNTIL)
            theirs = min(theirs, peer_run(text, bodies))
    contacts = float((np.nan_to_num(path.force) > 0).sum(axis=1).mean())
    cells = (
        *(spec, f"{contacts:.0f}", f"{spent:.3f}", f"{theirs[0]:.3f}", f"{spent / theirs[0]:.1f}"),
        *(f"{path.penetration_max:.1e}", f"{theirs[1]:.1e}", f"{path.complementarity_max:.1e}"),
    )
    end = "" if path.outcome.name == "DONE" else f" ended at {path.t_end:.3g} s: {path.outcome.value}"
    return f"| {' | '.join(cells)} |{end}"


def main() -> None:
    print(f"| {' | '.join(TITLES)} |\n|{' --- |' * len(TITLES)}")
    for spec in sys.argv[1:] or SCENES:
        try:
            print(row(spec), flush=True)
        except ModelgenError as refused:
            print(f"| {spec} | {refused}", flush=True)


if __name__ == "__main__":
    main()
