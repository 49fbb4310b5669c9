"""Scenes of many contacts and of robots, that every program runs: what moves, what drives it, how long."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from modelgen import import_scene
from modelgen.scene.scene_types import Scene
from tests.benchmarks.many_contacts import SCENES, STONES, heap

Array = Any  # numpy's
Places = dict[str, Array]  # by body, (n, 3) m: where it was over time
UNTIL = 2.0  # s
CARDS_UNTIL = 1.0
HELD = 0.02  # s, how long a control holds
ROBOTS = ("hopper", "ant", "humanoid")
SQUEEZE, LIFTED, LIFT_FROM, LIFT_FOR = 8.0, 0.2, 0.5, 1.0  # N, m, s, s
GRIPPER = """<mujoco model="gripper">
  <compiler autolimits="true"/>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 0.1" friction="0.8 0 0"/>
    <body name="hand" pos="0 0 0.12">
      <joint name="lift" type="slide" axis="0 0 1" armature="0.1" damping="40"/>
      <geom name="palm" type="box" size="0.08 0.02 0.01" contype="0" conaffinity="0"/>
      <body name="left" pos="-0.05 0 -0.05">
        <joint name="left_slide" type="slide" axis="1 0 0" damping="5"/>
        <geom name="left_pad" type="box" size="0.01 0.02 0.04" friction="0.8 0 0"/>
      </body>
      <body name="right" pos="0.05 0 -0.05">
        <joint name="right_slide" type="slide" axis="-1 0 0" damping="5"/>
        <geom name="right_pad" type="box" size="0.01 0.02 0.04" friction="0.8 0 0"/>
      </body>
    </body>
    <body name="block" pos="0 0 0.03">
      <freejoint/>
      <geom name="block" type="box" size="0.03 0.02 0.03" density="500" friction="0.8 0 0"/>
    </body>
  </worldbody>
  <actuator>
    <position name="height" joint="lift" kp="400" ctrlrange="-0.05 0.3"/>
    <motor name="left_force" joint="left_slide" ctrlrange="-20 20"/>
    <motor name="right_force" joint="right_slide" ctrlrange="-20 20"/>
  </actuator>
</mujoco>"""


@dataclass(frozen=True, eq=False)
class Task:
    """A scene for every program.

    Attributes:
        mjcf: text of the file of MuJoCo from which the scene was imported; None: of free bodies.
        controls: (n, inputs) each for HELD; None: nothing drives it.
        as_the_file_says: MuJoCo takes the integrator and solver of the file, in place of its defaults.
        drift: m, how far bodies went that should stay, given their places over time; None: all move.
    """

    title: str
    scene: Scene
    until: float = UNTIL
    mjcf: str | None = None
    controls: Array | None = None
    as_the_file_says: bool = False
    drift: Callable[[Array, Places], float] | None = None


def task_of(spec: str) -> Task:
    """As in stack:10, pyramid:5, dominoes:10, heap:sphere:20, cards:53, gripper, hopper, hopper:file."""
    kind, *rest = spec.split(":")
    if kind == "heap":
        return Task(f"heap of {rest[1]} {PLURALS[rest[0]]}", heap(int(rest[1]), kind=rest[0]))
    if kind == "gripper":
        return _gripper()
    if kind in ROBOTS:
        return _robot(kind, as_the_file_says=bool(rest))
    count = int(rest[0])
    scene = SCENES[kind](count)
    if kind == "stack":
        return Task(f"stack of {count} boxes", scene, drift=_gone)
    if kind == "cards":
        return Task(f"{count} cards", scene, until=CARDS_UNTIL)
    if kind == "pyramid":
        return Task(f"pyramid of {count * (count + 1) // 2} boxes, struck by a ball", scene)
    return Task(f"{count} dominoes, struck by a ball", scene)


PLURALS = {kind: f"{kind}es" if kind.endswith("x") else f"{kind}s" for kind in STONES}


def _gone(times: Array, places: Places) -> float:
    """The farthest that a body was from its start."""
    return float(max(np.linalg.norm(at - at[0], axis=1).max() for at in places.values()))


def _slid(times: Array, places: Places) -> float:
    """How far the block slid in the hand once it was held."""
    apart = (places["block"] - places["hand"])[times > LIFT_FROM - 5 * HELD]
    return float(np.linalg.norm(apart - apart[0], axis=1).max())


def imported(mjcf: str) -> Scene:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "model.xml"
        path.write_text(mjcf)
        return import_scene(path).scene


def _gripper() -> Task:
    times = HELD * np.arange(round(UNTIL / HELD))
    height = LIFTED * np.clip((times - LIFT_FROM) / LIFT_FOR, 0.0, 1.0)
    controls = np.column_stack([height, np.full_like(height, SQUEEZE), np.full_like(height, SQUEEZE)])
    return Task(
        "gripper lifts a block", imported(GRIPPER), mjcf=GRIPPER, controls=controls, drift=_slid
    )  # fmt: skip


def _robot(name: str, as_the_file_says: bool) -> Task:
    """A robot of Gymnasium with random controls within their ranges."""
    import mujoco

    package = find_spec("gymnasium")
    assert package is not None, "gymnasium is not installed"
    assert package.origin is not None
    text = (Path(package.origin).parent / "envs" / "mujoco" / "assets" / f"{name}.xml").read_text()
    ranges = mujoco.MjModel.from_xml_string(text).actuator_ctrlrange
    draw = partial(np.random.default_rng(0).uniform, ranges[:, 0], ranges[:, 1])
    controls = np.array([draw() for _ in range(round(UNTIL / HELD))])
    title = f"{name}, options of its file" if as_the_file_says else name
    return Task(title, imported(text), mjcf=text, controls=controls, as_the_file_says=as_the_file_says)
