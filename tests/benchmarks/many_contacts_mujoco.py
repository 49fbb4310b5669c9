"""Scenes of many contacts with friction by time-stepping, beside MuJoCo at its defaults.

Run with `python -m tests.benchmarks.many_contacts_mujoco [SCENE ..]`, as in `heap:sphere:20 stack:10
dominoes:10`; needs the extra `peers`. modelgen runs at `coarse`, and at `fast` in steps of 5 ms, MuJoCo in
steps of 2 ms, each in CPU time of one thread, in turn, the shorter of two. Penetration is what each program
tells of its own contacts.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np

from modelgen import build, derive, emit, require, simulate
from modelgen.benchmark.peers.mjcf import geom_size, words
from modelgen.errors import ModelgenError
from modelgen.runtime.settings import Stepping
from modelgen.scene.scene_types import Scene
from tests.benchmarks.many_contacts import SCENES as MADE
from tests.benchmarks.many_contacts import STONES, heap

SCENES = (
    *(f"stack:{n}" for n in (5, 10, 20)),
    *("pyramid:5", "dominoes:10", "dominoes:50"),
    *(f"heap:{kind}:20" for kind in STONES),
    *(f"heap:sphere:{n}" for n in (50, 100)),
)
FRICTION = 0.5
PEER_STEP, UNTIL = 0.002, 2.0  # s
CHOICES: tuple[tuple[str, Stepping], ...] = (
    ("coarse", {}),
    ("fast", {"method": "time-stepping", "step": 0.005}),
)
TITLES = (
    "scene",
    "accuracy",
    "contacts",
    "CPU s per s",
    "MuJoCo",
    "ratio",
    "penetration (m)",
    "MuJoCo",
    "complementarity",
)


def scene_of(spec: str) -> Scene:
    kind, *rest = spec.split(":")
    return heap(int(rest[1]), kind=rest[0]) if kind == "heap" else MADE[kind](int(rest[0]))


def mjcf(scene: Scene) -> str:
    """The same bodies for MuJoCo, with its own contacts between all of them."""
    text = ""
    for body in scene.bodies:
        (shape,), pose = body.shapes, body.pose
        size = words((5, 5, 1) if shape.kind == "plane" else geom_size(shape))
        free = "<freejoint/>" if body.motion == "dynamic" else ""
        touch = f'density="{body.density or 0}" friction="{FRICTION} 0 0"'
        geom = f'<geom type="{shape.kind}" size="{size}" {touch}/>'
        text += f'<body pos="{words(pose.position)}" quat="{words(pose.quaternion)}">{free}{geom}</body>'
    return f"""<mujoco><option timestep="{PEER_STEP}"/><size memory="1G"/>
    <worldbody>{text}</worldbody></mujoco>"""


def peer_run(scene: Scene) -> tuple[float, float]:
    """CPU s per s, and the deepest contact, m."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(mjcf(scene))
    data = mujoco.MjData(model)
    data.qvel.reshape(-1, 6)[:, :3] = [body.velocity for body in scene.bodies if body.motion == "dynamic"]
    deepest, begun = 0.0, process_time()
    for _ in range(round(UNTIL / PEER_STEP)):
        mujoco.mj_step(model, data)
        if data.ncon:
            deepest = min(deepest, float(data.contact.dist.min()))
    return (process_time() - begun) / UNTIL, -deepest


def rows(spec: str) -> Iterator[str]:
    """A row of the table for each of CHOICES."""
    scene = scene_of(spec)
    with TemporaryDirectory() as folder:
        library = build(emit(derive(require(scene))), folder=folder)
        for accuracy, stepping in CHOICES:
            spent, theirs = float("inf"), (float("inf"), 0.0)
            for _ in range(2):
                begun = process_time()
                path = simulate(
                    library, until=UNTIL, accuracy=accuracy, samples=20, estimate=False, **stepping
                )
                spent = min(spent, (process_time() - begun) / UNTIL)
                theirs = min(theirs, peer_run(scene))
            contacts = float((np.nan_to_num(path.force) > 0).sum(axis=1).mean())
            cells = (
                *(spec, accuracy, f"{contacts:.0f}", f"{spent:.3f}", f"{theirs[0]:.3f}"),
                f"{spent / theirs[0]:.1f}",
                *(f"{path.penetration_max:.1e}", f"{theirs[1]:.1e}", f"{path.complementarity_max:.1e}"),
            )
            end = "" if path.outcome.succeeded else f" ended at {path.t_end:.3g} s: {path.outcome.value}"
            yield f"| {' | '.join(cells)} |{end}"


def main() -> None:
    print(f"| {' | '.join(TITLES)} |\n|{' --- |' * len(TITLES)}")
    for spec in sys.argv[1:] or SCENES:
        try:
            for row in rows(spec):
                print(row, flush=True)
        except ModelgenError as refused:
            print(f"| {spec} | {refused}", flush=True)


if __name__ == "__main__":
    main()
