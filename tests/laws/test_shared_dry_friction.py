"""Loads at a jump, and contacts or joints, that hold one body together: a run says that how is not unique."""

from __future__ import annotations

from random import Random

import pytest

from modelgen import Accuracy, simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.read import read_text
from tests.running import library_of

UNTIL = 3.0
FREE = """
gravity = [0.0, 0.0, 0.0]
[[body]]
name = "m"
mass = {mass}
inertia = [0.01, 0.01, 0.01]
[[force]]
body = "m"
force = ["{force}", "0", "0"]
"""
BOX = """
[[body]]
name = "m"
mass = {mass}
inertia = [0.01, 0.01, 0.01]
position = [0, 0, 0.05]
shape = {{ kind = "box", size = [0.4, 0.4, 0.1] }}
[[body]]
name = "floor"
motion = "fixed"
shape = {{ kind = "plane" }}
[[contact]]
between = ["m", "floor"]
friction = {friction}
[[force]]
body = "m"
force = ["{force}", "0", "0"]
"""
FEET = [
    f'{{{{ name = "foot{k}", kind = "sphere", radius = 0.05, position = [{x}, {y}, 0] }}}}'
    for k, (x, y) in enumerate(((0.2, 0), (-0.1, 0.17), (-0.1, -0.17)))
]
TRIPOD = BOX.replace('{{ kind = "box", size = [0.4, 0.4, 0.1] }}', f"[{', '.join(FEET)}]").replace(
    '[[contact]]\nbetween = ["m", "floor"]\nfriction = {friction}\n',
    "".join(
        f'[[contact]]\nbetween = ["m/foot{k}", "floor"]\nfriction = {{friction}}\n' for k in range(len(FEET))
    ),
)
RAIL = """
gravity = [0.0, 0.0, 0.0]
[[body]]
name = "m"
mass = 1.0
inertia = [0.01, 0.01, 0.01]
[[joint]]
name = "rail"
kind = "prismatic"
between = ["world", "m"]
[[force]]
body = "m"
force = ["0", "-3*sign(vy)", "{force}"]
"""
SHARED = "forces are not unique: force on m rests at its jump"


def run(scene: str, accuracy: str, **numbers: object) -> Trajectory:
    library = library_of(read_text(scene.format(**numbers), "scene.toml"))
    return simulate(library, until=UNTIL, accuracy=getattr(Accuracy, accuracy)())


@pytest.mark.cases(4)
@pytest.mark.parametrize("seed", range(24))
def test_it_is_told_while_both_hold(seed: int) -> None:
    """At rest up to the time at which the friction of the contact is exceeded."""
    random = Random(seed)
    mass, friction, dry = random.uniform(0.5, 3), random.uniform(0.05, 0.5), random.uniform(0.2, 4)
    most = friction * mass * 9.81
    for scene in (BOX, TRIPOD):
        force = f"{most / UNTIL * 0.9!r}*t - {dry!r}*sign(vx)"
        path = run(scene, "balanced", mass=mass, friction=friction, force=force)
        assert any(SHARED in each for each in path.warnings)
        assert abs(path.p[-1, 0, 0]) < 1e-12
    alone = run(FREE, "balanced", mass=mass, force=f"-{dry!r}*sign(vx)")
    assert not any(SHARED in each for each in alone.warnings)


def test_a_load_that_a_joint_holds_too_is_told() -> None:
    path = run(RAIL, "balanced", force="1.0")
    assert not path.doubts
    assert any(SHARED in each for each in path.warnings)
    kink = run(RAIL.replace("sign(vy)", "abs(vy)"), "balanced", force="1.0")
    assert not any(SHARED in each for each in kink.warnings)
