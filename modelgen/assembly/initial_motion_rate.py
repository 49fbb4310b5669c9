"""Rate at which a scene without gravity that starts at rest is set in motion."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import hypot, sqrt

import numpy as np

from modelgen.assembly.masses import Mass
from modelgen.errors import ExpressionError
from modelgen.scene.expression import Expression, evaluate
from modelgen.scene.scene_types import Body, ForceLoad, Joint, Load, Scene, SpringLoad, TorqueLoad

SHORT = 1e-6  # of the span of the run, over which the speed of a path is taken


def initial_motion_rate(scene: Scene, moving: Sequence[tuple[Body, Mass]], length: float) -> float:
    """The largest rate (1/s) that loads, springs or paths give to bodies of this length (m) at t = 0; 0 if
    none."""
    masses = {body.name: (body, mass) for body, mass in moving}
    squares = [
        *(square for load in scene.loads for square in _of_load(load, masses, length)),
        *(square for joint in scene.joints for square in _of_joint(joint, masses, length)),
    ]
    paths = [body.path.position for body in scene.bodies if body.path is not None]
    turns = [body.path.rotation_vector for body in scene.bodies if body.path is not None]
    motions = [(joint.motion,) for joint in scene.joints if joint.motion is not None]
    span = SHORT * scene.run.until
    speeds = [*(_speed(each, span) / length for each in paths), *(_speed(each, span) for each in turns)]
    speeds += [_speed(each, span) for each in motions]
    return max([*speeds, *(sqrt(square) for square in squares)], default=0.0)


Masses = Mapping[str, tuple[Body, Mass]]


def _of_load(load: Load, masses: Masses, length: float) -> Iterator[float]:
    """Square of the rate of a load: acceleration over length, or stiffness over mass, 1/s^2."""
    if isinstance(load, SpringLoad):
        yield from (load.stiffness / masses[name][1].mass for name in load.between if name in masses)
    elif load.body in masses:
        body, mass = masses[load.body]
        size = hypot(*(_value(component, body) for component in load.components))
        if isinstance(load, ForceLoad):
            yield size / mass.mass / length
        elif isinstance(load, TorqueLoad):
            yield size / _moment(mass, length)


def _of_joint(joint: Joint, masses: Masses, length: float) -> Iterator[float]:
    if joint.is_sprung:
        turns = joint.kind in ("revolute", "universal")
        for name in joint.between:
            if name in masses:
                mass = masses[name][1]
                yield joint.stiffness / (_moment(mass, length) if turns else mass.mass)


def _moment(mass: Mass, length: float) -> float:
    """A moment of inertia, kg m^2; of a body without one, that of its mass at the length."""
    return mass.mass * length**2 if mass.inertia is None else float(np.trace(mass.inertia)) / 3


def _value(component: Expression, body: Body) -> float:
    """Value of a function at the start; 0 if it has none there."""
    names = (*"xyz", "vx", "vy", "vz", "wx", "wy", "wz", "qw", "qx", "qy", "qz")
    state = (*body.pose.position, *body.velocity, *body.angular_velocity, *body.pose.quaternion)
    try:
        return evaluate(component, {"t": 0.0, **dict(zip(names, state, strict=True))})
    except ExpressionError:
        return 0.0


def _speed(components: Sequence[Expression], span: float) -> float:
    """Speed of a path at its start; 0 if it has none there."""
    try:
        ends = [[evaluate(each, {"t": t}) for each in components] for t in (0.0, span)]
    except ExpressionError:
        return 0.0
    return hypot(*(b - a for a, b in zip(*ends, strict=True))) / span
