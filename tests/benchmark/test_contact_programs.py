"""Tasks of many contacts begin alike in every program, and end where these say."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from tests.benchmarks.contact_programs import Bullet, Modelgen, Mujoco, NotInProgram, Run, library_of
from tests.benchmarks.contact_tasks import CARDS_UNTIL, ROBOTS, Task, task_of
from tests.benchmarks.many_contacts_peers import watched
from tests.benchmarks.penetration import Referee

pytestmark = pytest.mark.peers


def started(task: Task, folder: Path) -> Modelgen:
    return Modelgen(task, library_of(task, str(folder))[0], "coarse", {})


@pytest.mark.parametrize(
    "spec", ["stack:3", "heap:capsule:4", "heap:ellipsoid:3", "cards:3", "gripper", *ROBOTS]
)
def test_bodies_lie_alike_at_the_start(spec: str, tmp_path: Path) -> None:
    if spec in ROBOTS:
        pytest.importorskip("gymnasium")
    task = task_of(spec)
    ours = started(task, tmp_path).poses()
    others: list[Callable[[], Run]] = [lambda: Mujoco(task)]
    if find_spec("pybullet"):
        others.append(lambda: Bullet(task))
    for make in others:
        try:
            theirs = make().poses()
        except NotInProgram:
            continue
        for body, a, b, c, d in zip(task.scene.bodies, *ours, *theirs, strict=True):
            if body.shapes:
                assert np.allclose(a, c, rtol=0, atol=1e-7), body.name
                assert np.allclose(b, d, rtol=0, atol=1e-7), body.name
    assert Referee(task.scene).depth(*ours) < 1e-9


def test_a_stack_is_watched_to_its_end(tmp_path: Path) -> None:
    task = task_of("stack:2")
    library, _ = library_of(task, str(tmp_path))
    ours = watched(task, lambda: Modelgen(task, library, "coarse", {}))
    theirs = watched(task, lambda: Mujoco(task))
    assert not ours["failure"]
    assert ours["t"] == pytest.approx(task.until)
    assert theirs["t"] == pytest.approx(task.until)
    assert ours["deepest"] < 1e-9 < 1e-5 < theirs["deepest"] < 1e-3
    assert ours["drift"] < 1e-9 < 1e-5 < theirs["drift"] < 2e-3
    assert ours["contacts"] == theirs["contacts"] == 8
    assert task_of("cards:2").until == CARDS_UNTIL
