"""A scene in other units of length, mass and time: the same physics, other numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from modelgen.errors import SceneError
from modelgen.scene.expression import Expression, Name, Number
from modelgen.scene.expression_algebra import expression_of, over, substitute, times
from modelgen.scene.free_form_values import ControlPolygon, HeightField, Net, Polyline, Spline
from modelgen.scene.joint_format import ARMATURE
from modelgen.scene.outline_piece_kinds import Outline
from modelgen.scene.scene_types import (
    Body,
    ContactPair,
    ForceLoad,
    Joint,
    Load,
    Matrix,
    Pose,
    RunSettings,
    Scene,
    Shape,
    SpringLoad,
    TorqueLoad,
    Vector,
)

PURE = {"half_angle", "p", "q"}  # parameters of the catalogue that are no lengths
FREE = ("chart", "curve", "revolution", "extrusion")  # whose named parameters mean what their formulas say
TURNING = ("revolute", "universal", "spherical")  # joints whose coordinates are angles
MEASURED = ("screw", "distance")  # joints whose numbers are lengths
LENGTHS = ("displacement", "x", "y")  # rates of joints that are velocities

Three = tuple[Expression, Expression, Expression]
Ends = tuple[float | None, float | None]


@dataclass(frozen=True, slots=True)
class Units:
    """Sizes of one old unit of length, mass and time in new units."""

    length: float = 1.0
    mass: float = 1.0
    time: float = 1.0

    @property
    def speed(self) -> float:
        return self.length / self.time

    @property
    def force(self) -> float:
        return self.mass * self.speed / self.time

    @property
    def energy(self) -> float:
        return self.force * self.length

    def of_names(self) -> Mapping[str, float]:
        """Unit exponents of the names that loads and paths may use."""
        names = {"t": self.time, **dict.fromkeys("xyz", self.length)}
        return (
            names
            | dict.fromkeys(("vx", "vy", "vz"), self.speed)
            | dict.fromkeys(("wx", "wy", "wz"), 1 / self.time)
        )


def in_units(scene: Scene, units: Units) -> Scene:
    """The scene with every number in other units; what it names keeps its name.

    Charts and curves of the user's own keep their coordinates. Raises SceneError for a solid of the user's
    own, whose conditions have no units.
    """
    return replace(
        scene,
        bodies=tuple(_body(body, units) for body in scene.bodies),
        contacts=tuple(_contact(pair, units) for pair in scene.contacts),
        loads=tuple(_load(load, units) for load in scene.loads),
        joints=tuple(_joint(joint, units) for joint in scene.joints),
        gravity=_times(scene.gravity, units.speed / units.time),
        run=_run(scene.run, units),
        nominal=scene.nominal and in_units(scene.nominal, units),
    )


def _times(vector: Vector, factor: float) -> Vector:
    return (factor * vector[0], factor * vector[1], factor * vector[2])


def _three(parts: Three, units: Units, factor: float) -> Three:
    return (
        _formula(parts[0], units, factor),
        _formula(parts[1], units, factor),
        _formula(parts[2], units, factor),
    )


def _pose(pose: Pose, units: Units) -> Pose:
    return replace(pose, position=_times(pose.position, units.length))


def _run(run: RunSettings, units: Units) -> RunSettings:
    step = None if run.step is None else run.step * units.time
    return replace(run, until=run.until * units.time, step=step)


def _body(body: Body, units: Units) -> Body:
    path = body.path
    if path is not None:
        path = replace(
            path,
            position=_three(path.position, units, units.length),
            rotation_vector=_three(path.rotation_vector, units, 1.0),
        )
    return replace(
        body,
        shapes=tuple(_shape(shape, units) for shape in body.shapes),
        mass=None if body.mass is None else body.mass * units.mass,
        density=None if body.density is None else body.density * units.mass / units.length**3,
        inertia=None if body.inertia is None else _inertia(body.inertia, units),
        center_of_mass=_times(body.center_of_mass, units.length),
        pose=_pose(body.pose, units),
        velocity=_times(body.velocity, units.speed),
        angular_velocity=_times(body.angular_velocity, 1 / units.time),
        path=path,
    )


def _inertia(inertia: Matrix, units: Units) -> Matrix:
    factor = units.mass * units.length**2
    return (_times(inertia[0], factor), _times(inertia[1], factor), _times(inertia[2], factor))


def _shape(shape: Shape, units: Units) -> Shape:
    if shape.solid is not None:
        raise SceneError(
            f"shape {shape.name}", "a solid of the user's own", "shapes of the catalogue", "leave it out"
        )
    return replace(
        shape,
        parameters=tuple(
            (name, value * (1.0 if _is_pure(shape, name) else units.length))
            for name, value in shape.parameters
        ),
        pose=_pose(shape.pose, units),
        chart=_stretched(shape.chart, units),
        curve=_stretched(shape.curve, units),
        profile=_stretched(shape.profile, units),
        spline=None if shape.spline is None else _spline(shape.spline, units.length),
        outline=_outline(shape.outline, units.length),
    )


def _is_pure(shape: Shape, name: str) -> bool:
    return name in PURE or (shape.kind in FREE and name != "length")


def _stretched(form: Any, units: Units) -> Any:
    """A chart, curve or profile of the user's own."""
    if form is None:
        return None
    factor = Units(units.length)
    return replace(form, components=tuple(_formula(each, factor, units.length) for each in form.components))


def _spline(spline: Spline, factor: float) -> Spline:
    match spline:
        case Net(points=net):
            return replace(spline, points=tuple(tuple(_times(p, factor) for p in row) for row in net))
        case HeightField(x=x, y=y, heights=heights):
            rows = tuple(tuple(z * factor for z in row) for row in heights)
            return HeightField(tuple(v * factor for v in x), tuple(v * factor for v in y), rows)
        case ControlPolygon(points=points):
            return replace(spline, points=tuple(_times(p, factor) for p in points))
        case Polyline(points=points, radius=radius):
            return replace(spline, points=tuple(_times(p, factor) for p in points), radius=radius * factor)


def _outline(outline: Outline | None, factor: float) -> Outline | None:
    if outline is None:
        return None
    return tuple(replace(side, piece=side.piece.scaled(factor)) for side in outline)


def _contact(pair: ContactPair, units: Units) -> ContactPair:
    return replace(
        pair,
        rolling_resistance=pair.rolling_resistance * units.length,
        spinning_resistance=pair.spinning_resistance * units.length,
    )


def _load(load: Load, units: Units) -> Load:
    match load:
        case ForceLoad(components=parts):
            return replace(
                load,
                components=_three(parts, units, units.force),
                point=_times(load.point, units.length),
            )
        case TorqueLoad(components=parts):
            return replace(load, components=_three(parts, units, units.energy))
        case SpringLoad(anchors=anchors):
            return replace(
                load,
                anchors=(_times(anchors[0], units.length), _times(anchors[1], units.length)),
                stiffness=load.stiffness * units.force / units.length,
                damping=load.damping * units.force / units.speed,
                rest_length=load.rest_length * units.length,
            )


def _joint(joint: Joint, units: Units) -> Joint:
    along = 1.0 if joint.kind in TURNING else units.length
    stiff = units.energy / along**2
    inertia = tuple(
        value * units.mass * (1.0 if name in LENGTHS else units.length**2)
        for name, value in zip(ARMATURE.get(joint.kind, ()), joint.armature, strict=False)
    )
    return replace(
        joint,
        frames=(_pose(joint.frames[0], units), _pose(joint.frames[1], units)),
        numbers=tuple(n * units.length for n in joint.numbers) if joint.kind in MEASURED else joint.numbers,
        limits=_ends(joint.limits, along),
        limits_y=_ends(joint.limits_y, along),
        stiffness=joint.stiffness * stiff,
        damping=joint.damping * stiff * units.time,
        rest=joint.rest * along,
        motion=None if joint.motion is None else _formula(joint.motion, units, along),
        armature=inertia,
    )


def _ends(limits: Ends, factor: float) -> Ends:
    low, high = limits
    return None if low is None else low * factor, None if high is None else high * factor


def _formula(formula: Expression, units: Units, factor: float) -> Expression:
    """The formula of quantities in new units; `factor` is that of its value."""
    changed = {name: over(Name(name), Number(f)) for name, f in units.of_names().items() if f != 1.0}
    tree = substitute(formula.tree, changed)
    return expression_of(tree if factor == 1.0 else times(Number(factor), tree))
