"""Description of a scene for every simulator: bodies at the start, and loads as numbers."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from modelgen.benchmark.sampled_motion import Array
from modelgen.geometry.expression_translation import lower
from modelgen.scene.contact_groups import listed
from modelgen.scene.expression import Expression
from modelgen.scene.quaternions import Quaternion, product, rows_of
from modelgen.scene.scene_types import Scene, Shape, SpringLoad

if TYPE_CHECKING:
    from modelgen.benchmark.setting_evaluation import Bench


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A body as it starts; its frame lies in the centre of mass, with the axes as written."""

    name: str
    fixed: bool
    mass: float  # kg; 0 if fixed
    inertia: Array  # (3, 3) kg m^2
    centre: Array  # (3,) m: of mass, body axes as written
    p: Array  # (3,) m
    quaternion: Array  # (4,) (w, x, y, z)
    v: Array  # (3,) m/s
    w: Array  # (3,) rad/s, world
    shapes: tuple[Shape, ...]

    @property
    def turned(self) -> Array:
        """(3, 3): body axes to world, at the start."""
        return rotation(self.quaternion)

    def at(self, shape: Shape) -> Array:
        """(3,) m: where a shape's frame lies, from the centre of mass."""
        return np.array(shape.pose.position) - self.centre

    def placed(self, shape: Shape) -> tuple[Array, Quaternion]:
        """Position (3,) m and quaternion of a shape's frame: in its body's; of a fixed one in the world."""
        if not self.fixed:
            return self.at(shape), shape.pose.quaternion
        w, x, y, z = (float(part) for part in self.quaternion)
        return self.p + self.turned @ self.at(shape), product((w, x, y, z), shape.pose.quaternion)


@dataclass(frozen=True, slots=True)
class Setup:
    """A scene with the span that is measured."""

    scene: Scene
    solids: tuple[Solid, ...]  # all bodies, in the scene's order
    until: float  # s
    samples: int
    length: float  # m, characteristic
    time: float  # s

    @classmethod
    def of(cls, bench: Bench) -> Setup:
        path, subject = bench.reference.path, bench.subject
        start = tuple(values[0].astype(float) for values in (path.p, path.quaternion, path.v, path.w))
        return cls.started(
            subject.scene, bench.plain.manifest.instance, start, subject.until, subject.samples
        )

    @classmethod
    def started(
        cls, scene: Scene, instance: Mapping[str, Any], start: Sequence[Array], until: float, samples: int
    ) -> Setup:
        """`start`: p, quaternion, v, w of all bodies, (nb, 3 or 4)."""
        solids = tuple(
            _solid(body.shapes, entry, [values[k] for values in start])
            for k, (body, entry) in enumerate(zip(scene.bodies, instance["bodies"], strict=True))
        )
        scales = instance["scales"]
        return cls(listed(scene), solids, until, samples, scales["length"], scales["time"])

    @property
    def moving(self) -> tuple[Solid, ...]:
        return tuple(solid for solid in self.solids if not solid.fixed)

    @property
    def times(self) -> Array:
        """(samples + 1,) s."""
        return np.linspace(0.0, self.until, self.samples + 1)

    def middles(self, per_sample: int) -> Array:
        """(samples per_sample,) s: the middles of as many steps an output interval."""
        steps = per_sample * self.samples
        return (np.arange(steps) + 0.5) * self.until / steps

    def per_sample(self, step: float) -> int:
        """Number of steps of about the given size in an output interval."""
        return max(1, round(self.until / self.samples / step))

    def solid(self, name: str) -> Solid:
        return next(solid for solid in self.solids if solid.name == name)

    def shape(self, partner: tuple[str, str]) -> Shape:
        """The shape that a contact names as (body, shape)."""
        return shape_of(self.scene, partner)


def _solid(shapes: tuple[Shape, ...], entry: Mapping[str, Any], start: list[Array]) -> Solid:
    fixed = entry["motion"] not in ("point", "free")
    mass, inertia = (0.0, np.zeros((3, 3))) if fixed else _mass(entry["mass_inverse"])
    p, quaternion, v, w = start
    if entry["motion"] == "point":
        quaternion, w = np.array([1.0, 0.0, 0.0, 0.0]), np.zeros(3)
    return Solid(
        entry["name"], fixed, mass, inertia, np.array(entry["centre_of_mass"]), p, quaternion, v, w, shapes
    )


def _mass(inverse: Sequence[float]) -> tuple[float, Array]:
    """Mass, kg, and inertia (3, 3), kg m^2; of a body that does not turn, some."""
    mass, turning = 1 / inverse[0], np.reshape(inverse[1:], (3, 3))
    if not turning.any():
        return mass, mass * np.eye(3)
    return mass, np.asarray(np.linalg.inv((turning + turning.T) / 2))


def shape_of(scene: Scene, partner: tuple[str, str]) -> Shape:
    """The shape that a contact names as (body, shape)."""
    (body,) = (each for each in scene.bodies if each.name == partner[0])
    return next(shape for shape in body.shapes if shape.name == partner[1])


def numbers(shape: Shape) -> dict[str, float]:
    """The parameters of a shape by name."""
    return dict(shape.parameters)


def rotation(quaternion: Array) -> Array:
    """(3, 3) of a unit quaternion (w, x, y, z)."""
    w, x, y, z = (float(part) for part in quaternion)
    return np.array(rows_of((w, x, y, z)))


def unused_name(name: str, taken: Container[str]) -> str:
    """The name, with underlines behind it where it is taken."""
    while name in taken:
        name += "_"
    return name


def driven(scene: Scene) -> list[str]:
    """Sentences on the bodies that are driven: no simulator here is told of their paths."""
    return [f"body {body.name!r} is driven along a path" for body in scene.bodies if body.motion == "driven"]


def unsteady(scene: Scene) -> list[str]:
    """Sentences on the loads that depend on more than the time."""
    names = set().union(
        *(part.names for load in scene.loads if not isinstance(load, SpringLoad) for part in load.components)
    )
    return ["a load depends on the state of its body"] if names - {"t"} else []


def tabulated(components: Sequence[Expression], times: Array) -> Array:
    """(n, 3): the values of three expressions of t at n times."""
    t = ca.SX.sym("t")
    values = ca.vertcat(*(lower(component, {"t": t}) for component in components))
    table = ca.Function("table", [t], [values]).map(len(times))(times[None, :])
    return np.array(table, dtype=float).reshape(3, len(times)).T
