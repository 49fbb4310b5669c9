"""A body on four legs with sprung and damped hinges, which stands on its feet with friction."""

from __future__ import annotations

from math import cos, sin

from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.oracles.pieces import TABLE

THIGH, SHIN, FOOT = 0.2, 0.2, 0.02  # m: lengths, and radius of a foot
HALF = (0.25, 0.12)  # m: from the middle of the body to a hip
BEND = 0.6  # rad: of a hip forwards from the vertical; the knee bends back by twice that
MASSES = {"trunk": 8.0, "thigh": 0.8, "shin": 0.3}
STIFFNESS, DAMPING = 120.0, 4.0  # N m/rad and N m s/rad, of each hinge
LEGS = {"fl": (1, 1), "fr": (1, -1), "hl": (-1, 1), "hr": (-1, -1)}


def quadruped(push: str = "0.0", above: float = 0.0) -> Scene:
    """It starts `above` (m) the plane, with its springs at rest.

    Args:
        push: force on the trunk along x, and half of it along y, N, an expression of t.
        above: height of the feet over the plane, m.

    Hinges turn about the y axis. The z axis of a leg points up along it; contact i is that of leg i.
    """
    hip = FOOT + (THIGH + SHIN) * cos(BEND) + above
    bodies = [
        TABLE,
        make.dynamic("trunk", mass=MASSES["trunk"], inertia=[0.05, 0.2, 0.22], position=[0, 0, hip]),
    ]
    joints, contacts = [], []
    for name, (front, left) in LEGS.items():
        x, y = front * HALF[0], left * HALF[1]
        knee = (x - THIGH * sin(BEND), y, hip - THIGH * cos(BEND))
        bodies += [
            make.dynamic(
                f"thigh_{name}", mass=MASSES["thigh"], inertia=[3e-3, 3e-3, 4e-4],
                position=[(x + knee[0]) / 2, y, (hip + knee[2]) / 2], rpy=[0, BEND, 0],
            ),
            make.dynamic(
                f"shin_{name}", make.sphere(FOOT, position=[0, 0, -SHIN / 2]), mass=MASSES["shin"],
                inertia=[1e-3, 1e-3, 2e-4],
                position=[(x + knee[0]) / 2, y, knee[2] - (hip - knee[2]) / 2], rpy=[0, -BEND, 0],
            ),
        ]  # fmt: skip
        for kind, first, second, at in (
            ("hip", "trunk", "thigh_" + name, (x, y, hip)),
            ("knee", "thigh_" + name, "shin_" + name, knee),
        ):
            joints.append({
                "name": f"{kind}_{name}", "kind": "revolute", "between": [first, second],
                "position": list(at),
                "rpy": ["-pi/2", 0, 0], "stiffness": STIFFNESS, "damping": DAMPING,
            })  # fmt: skip
        contacts.append({"between": [f"shin_{name}", "table"], "friction": 0.7})
    force = [{"body": "trunk", "force": [push, f"0.5*({push})", "0.0"]}]
    return make.scene("quadruped", bodies, joint=joints, contact=contacts, force=force)
