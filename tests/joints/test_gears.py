"""A gear couples two turns: where the other joints keep a body from turning about its axis, it is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from modelgen import require
from modelgen.errors import SceneError
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene

TURNING = ("revolute", "cylindrical", "planar", "spherical", "none")
HOLDING = ("prismatic", "weld", "revolute across", "prismatic on a slide")


def geared(held: str, seed: int) -> Scene:
    """A wheel on an axle, and a body held in some way, with a gear between them; axes at random."""
    random = np.random.default_rng(seed)
    turn = {"axis": list(random.normal(size=3)), "angle": float(random.uniform(0.1, 3.0))}
    places = [list(random.uniform(-1, 1, 3)) for _ in range(3)]
    names = ("wheel", "other", "slide")
    own = {"mass": 1.0, "inertia": [0.1, 0.2, 0.3]}
    bodies = [make.dynamic(name, position=place, **own) for name, place in zip(names, places, strict=True)]
    frame: dict[str, Any] = {"rpy": ["pi/2", 0.0, 0.0]} if held == "revolute across" else {"axis_angle": turn}
    axle = {"name": "axle", "kind": "revolute", "between": ["world", "wheel"], "position": places[0]}
    other = {"name": "held", "between": ["world", "other"], "position": places[1]}
    joints: list[dict[str, Any]] = [axle | frame]
    if held == "prismatic on a slide":
        rail = {"kind": "prismatic", "between": ["world", "slide"], "position": places[2]}
        joints.append(rail | {"rpy": [0.3, 0.1, 0.2]})
        joints.append(other | frame | {"kind": "prismatic", "between": ["slide", "other"]})
    elif held == "revolute across":
        joints.append(other | {"kind": "revolute"})
    elif held != "none":
        joints.append(other | frame | {"kind": held})
    joints.append({"name": "mesh", "kind": "gear", "between": ["wheel", "other"], "teeth": [17, 40], **frame})
    return make.scene("geared", bodies, joint=joints)


@pytest.mark.parametrize("held", TURNING)
@pytest.mark.parametrize("seed", range(3))
def test_a_body_that_can_turn_takes_a_gear(held: str, seed: int) -> None:
    assert require(geared(held, seed)).joints[-1].name == "mesh"


@pytest.mark.parametrize("held", HOLDING)
@pytest.mark.parametrize("seed", range(3))
def test_a_body_that_cannot_turn_about_the_axis_is_refused(held: str, seed: int) -> None:
    with pytest.raises(SceneError, match="'other' cannot turn about the z axis of the gear"):
        require(geared(held, seed))
