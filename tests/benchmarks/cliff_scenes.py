"""Scenes that once cost far more than their motion is worth, or ended without need."""

from __future__ import annotations

from math import cos, pi, radians, sin

from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene, Shape

TEETH, TIP, ROOT = 12, 0.05, 0.035  # of the escape wheel; m
HALF_SPAN = radians(37.5)  # of the pallets: two and a half teeth from one to the other
PIVOT = TIP / cos(HALF_SPAN)  # m, where the tangents of the wheel below the pallets meet
PALLET_TIP, PALLET_BASE, PALLET_WIDTH = 0.044, 0.066, 0.006  # m, from the axis of the wheel; half its width


def wheel_corners() -> list[tuple[float, float]]:
    """Corners of the escape wheel in its axes, m: tips and roots in turn."""
    polar = ((TIP if k % 2 == 0 else ROOT, pi * k / TEETH) for k in range(2 * TEETH))
    return [(r * cos(angle), r * sin(angle)) for r, angle in polar]


def pallet_corners(side: int) -> list[tuple[float, float]]:
    """Corners of a wedge that points to the axis of the wheel, in the axes of the anchor, m.

    Args:
        side: 1: the entry pallet, -1: the exit pallet.
    """
    angle = pi / 2 - side * HALF_SPAN
    corners = [(PALLET_TIP, 0.0), (PALLET_BASE, -PALLET_WIDTH), (PALLET_BASE, PALLET_WIDTH)]
    return [(r * cos(angle) - t * sin(angle), r * sin(angle) + t * cos(angle) - PIVOT) for r, t in corners]


def _pallet(name: str, side: int) -> Shape:
    return make.extrusion(0.02, points=[list(corner) for corner in pallet_corners(side)], name=name)


def escapement(lean: float, restitution: float, torque: float, friction: float = 0.0) -> Scene:
    """An escape wheel of pointed teeth that swings an anchor of two wedges, both on revolute joints.

    The pallets are longer than the wheel, so that a tooth strikes with two corners at once, one of which the
    joints make redundant.

    Args:
        lean: rad, of the anchor at the start.
        restitution: of the teeth.
        torque: N m, on the wheel.
        friction: of the teeth; 0: there is none.
    """
    axis = [0.0, 0.0, 1.0]
    wheel = make.dynamic(
        "wheel",
        make.extrusion(0.01, points=[list(corner) for corner in wheel_corners()]),
        mass=0.1,
        inertia=[6e-5, 6e-5, 1.2e-4],
        axis_angle={"axis": axis, "angle": -pi / TEETH / 2},
    )
    anchor = make.dynamic(
        "anchor",
        _pallet("entry", 1),
        _pallet("exit", -1),
        mass=0.05,
        inertia=[5e-5, 5e-5, 1e-4],
        position=[0.0, PIVOT, 0.0],
        axis_angle={"axis": axis, "angle": lean},
    )
    return make.scene(
        "escapement",
        [wheel, anchor],
        gravity=[0.0, 0.0, 0.0],
        contact=[
            {"between": ["wheel", f"anchor/{pallet}"], "restitution": restitution}
            | ({"friction": friction} if friction else {})
            for pallet in ("entry", "exit")
        ],
        joint=[
            {"kind": "revolute", "name": "arbor", "between": ["world", "wheel"]},
            {
                "kind": "revolute",
                "name": "pivot",
                "between": ["world", "anchor"],
                "position": [0.0, PIVOT, 0.0],
            },
        ],
        torque=[{"body": "wheel", "torque": [0.0, 0.0, torque]}],
    )


def links_and_dust(radius: float) -> Scene:
    """A ring that swings and spins in a fixed ring, both of some 0.6 m, and a ball far from them.

    Args:
        radius: m, of the ball; 0: there is none.
    """
    link = make.torus(0.5, 0.1)
    bodies = [
        make.fixed("table", make.plane()),
        make.fixed("hook", link, position=[0.0, 0.0, 2.0]),
        make.dynamic(
            "link",
            link,
            density=100.0,
            position=[0.5, 0.0, 1.8],
            axis_angle={"axis": [1.0, 0.0, 0.0], "angle": "pi/2"},
            velocity=[0.0, 0.3, 0.0],
            angular_velocity=[0.3, 0.1, 2.0],
        ),
    ]
    contact = [{"between": ["hook", "link"], "restitution": 0.5}]
    if radius:
        bodies.append(make.dynamic("dust", make.sphere(radius), density=1000.0, position=[5.0, 0.0, radius]))
        contact.append({"between": ["dust", "table"]})
    return make.scene("links", bodies, contact=contact)


def scattered_balls(count: int) -> Scene:
    """Balls that fly apart without gravity, all pairs of which may touch."""
    balls = [
        make.dynamic(
            f"ball{k}",
            make.sphere(0.01),
            density=1000.0,
            position=[0.05 * (k % 4), 0.05 * (k // 4 % 4), 0.05 * (k // 16)],
            velocity=[0.1 * sin(k), 0.1 * cos(2.0 * k), 0.1 * sin(3.0 * k)],
        )
        for k in range(count)
    ]
    return make.scene("scattered", balls, gravity=[0.0, 0.0, 0.0], contacts={"between": "all"})
