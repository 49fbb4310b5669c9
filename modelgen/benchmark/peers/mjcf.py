"""A scene as MuJoCo's XML, and what of it MuJoCo has no like of."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import cos, log, pi, sin, sqrt

import numpy as np

from modelgen.benchmark.knobs import Settings
from modelgen.benchmark.peers.scene_description import (
    Setup,
    Solid,
    driven,
    numbers,
    shape_of,
    unsteady,
    unused_name,
)
from modelgen.errors import with_article
from modelgen.scene.scene_types import ContactPair, ForceLoad, Scene, Shape, SpringLoad, TorqueLoad

PRIMITIVES: Mapping[str, tuple[tuple[str, ...], float]] = {  # parameters, and what of the last MuJoCo takes
    "sphere": (("radius",), 1.0),
    "ellipsoid": (("a", "b", "c"), 1.0),
    "capsule": (("radius", "length"), 0.5),
    "cylinder": (("radius", "length"), 0.5),
    "box": (("x", "y", "z"), 0.5),
}
FLAT = ("plane", "box")  # a circle's rim on these is that of a thin cylinder
FACED = ("plane", "box", "cylinder")  # with flat faces
THIN = 1e-6  # half the thickness of that cylinder, over its radius
HARD = "0.9999 0.9999 0.001 0.5 2"  # solimp of a contact that hardly gives
BLOWS = "a blow is that of a spring and damper: its restitution is up to 0.15 off"
FACES = "friction of a face acts at a few points of its rim"
AXES = np.eye(3)
WORLD = "world"  # a body that MuJoCo has of its own


@dataclass(frozen=True, slots=True)
class Mjcf:
    """The text for some settings of the knobs; `dt` is the step, s."""

    setup: Setup
    settings: Settings
    dt: float

    def text(self) -> str:
        scene = self.setup.scene
        rings = {
            partner
            for pair in scene.contacts
            if is_ringed(self.setup.scene, pair)
            for partner in pair.between
        }
        bodies = "".join(self._body(solid, rings) for solid in self.setup.solids)
        pairs = "".join(self._pair(pair) for pair in scene.contacts if not is_ringed(self.setup.scene, pair))
        meshes = "".join(_meshes(self.setup.solids))
        return (
            f"<mujoco>{self._option()}<asset>{meshes}</asset><worldbody>{bodies}"
            f'<site name="{WORLD}"/></worldbody><contact>{pairs}</contact>'
            f"<tendon>{''.join(_springs(scene))}</tendon>"
            f"<actuator>{''.join(_motors(scene))}</actuator></mujoco>"
        )

    def _option(self) -> str:
        chosen = self.settings
        native = "enable" if chosen.get("collider", "native") == "native" else "disable"
        return (
            f'<option integrator="{chosen["integrator"]}" timestep="{self.dt!r}" '
            f'gravity="{words(self.setup.scene.gravity)}" cone="{chosen.get("cone", "elliptic")}" '
            f'impratio="{chosen.get("impratio", 1.0)}" noslip_iterations="{chosen.get("noslip", 0)}" '
            f'tolerance="{chosen.get("solver", 1e-8)}" iterations="200" '
            f'ccd_tolerance="{chosen.get("ccd", 1e-6)}" ccd_iterations="200">'
            f'<flag nativeccd="{native}"/></option>'
        )

    def _body(self, solid: Solid, rings: set[tuple[str, str]]) -> str:
        """One body, its frame at the centre of mass, as it starts."""
        geoms = "".join(
            "".join(self._ring(solid, shape))
            if (solid.name, shape.name) in rings
            else _geom(self.setup, solid, shape)
            for shape in solid.shapes
        )
        sites = "".join(_sites(self.setup.scene, solid))
        name = body_name(self.setup.scene, solid.name)
        pose = f'name="{name}" pos="{words(solid.p)}" quat="{words(solid.quaternion)}"'
        if solid.fixed:
            return f"<body {pose}>{geoms}{sites}</body>"
        inertia = [*np.diag(solid.inertia), solid.inertia[0, 1], solid.inertia[0, 2], solid.inertia[1, 2]]
        inertial = f'<inertial pos="0 0 0" mass="{solid.mass!r}" fullinertia="{words(inertia)}"/>'
        return f"<body {pose}><freejoint/>{inertial}{geoms}{sites}</body>"

    def _ring(self, solid: Solid, shape: Shape) -> Iterator[str]:
        """A circle as capsules around it, beside the circle so that the tubes touch where the circles do."""
        pair = next(p for p in self.setup.scene.contacts if (solid.name, shape.name) in p.between)
        tube = float(self.settings["tube"]) * self.setup.length
        number, bit = int(self.settings["segments"]), 1 << self.setup.scene.contacts.index(pair)
        first = pair.between[0] == (solid.name, shape.name)
        radius = numbers(shape)["radius"] + (tube if _is_linked(self.setup, pair) else -tube)
        turns = [2 * pi * k / number for k in range(number + 1)]
        points = [(radius * cos(turn), radius * sin(turn), 0.0) for turn in turns]
        frame = f'pos="{words(solid.at(shape))}" quat="{words(shape.pose.quaternion)}"'
        sides = f'contype="{bit if first else 0}" conaffinity="{0 if first else bit}"'
        yield f"<frame {frame}>"
        for a, b in pairwise(points):
            yield (
                f'<geom type="capsule" fromto="{words([*a, *b])}" size="{tube!r}" {sides} '
                f"{self._touch(pair)}/>"
            )
        yield "</frame>"

    def _pair(self, pair: ContactPair) -> str:
        (a, b), touch = pair.between, self._touch(pair)
        return f'<pair geom1="{a[0]}/{a[1]}" geom2="{b[0]}/{b[1]}" {touch}/>'

    def _touch(self, pair: ContactPair) -> str:
        """How a contact gives: dimension, friction, and the time constant and damping of its spring."""
        slide = pair.friction.kinetic[0] if pair.friction else 0.0
        own = [slide, slide, pair.spinning_resistance, pair.rolling_resistance, pair.rolling_resistance]
        dimension = 6 if own[3] else 4 if own[2] else 3 if own[0] else 1
        if is_ringed(self.setup.scene, pair):
            own = own[1:4]
        friction = f'condim="{dimension}"' + (f' friction="{words(own)}"' if own[0] else "")
        damping = _damping(pair.restitution.value)
        if self.settings.get("contact", "tied") == "tied":
            return f'{friction} solref="{2 * self.dt / damping!r} {damping!r}" solimp="{HARD}"'
        return f'{friction} solref="0.02 {damping!r}"'


def unlike(scene: Scene) -> list[str]:
    """Sentences: what of a scene MuJoCo has no like of, or this export does not write."""
    found = driven(scene) + unsteady(scene)
    fixed = {body.name for body in scene.bodies if body.motion == "fixed"}
    shapes = {(body.name, shape.name): shape for body in scene.bodies for shape in body.shapes}
    touching = dict.fromkeys(partner for pair in scene.contacts for partner in pair.between)
    for partner in touching:
        others = [shapes[p] for pair in scene.contacts if partner in pair.between for p in pair.between]
        where = f"shape {partner[0]}/{partner[1]}"
        found += _refused(where, shapes[partner], partner[0] in fixed, others)
    for k, pair in enumerate(scene.contacts):
        if pair.friction and pair.friction.kinetic[0] != pair.friction.kinetic[1]:
            found.append(f"contact {k} has friction that depends on the direction")
    return found + [f"joint {joint.name!r} is not exported" for joint in scene.joints]


def different(scene: Scene) -> list[str]:
    """Phrases: what MuJoCo represents otherwise."""
    found = ["its contacts give way: a penetration carries the force"] if scene.contacts else []
    if any(is_ringed(scene, pair) for pair in scene.contacts):
        found.append("circles are chains of capsules")
    if any(shape.kind == "circle" for _, shape in _touching(scene)) and not len(found) > 1:
        found.append("circles are rims of thin cylinders")
    if any(pair.friction for pair in scene.contacts):
        found.append("what sticks creeps; static friction is kinetic friction")
    if scene.contacts:
        found.append(BLOWS)
    if any(pair.friction and _has_faces(scene, pair) for pair in scene.contacts):
        found.append(FACES)
    if _motors(scene):
        found.append("loads are held over each step")
    names = [(body.name, body_name(scene, body.name)) for body in scene.bodies]
    found += [f"body {name} is called {other}" for name, other in names if name != other]
    return found


def body_name(scene: Scene, name: str) -> str:
    """The name of a body in the file: its own, unless it is that of MuJoCo's world."""
    return unused_name(WORLD, {body.name for body in scene.bodies}) if name == WORLD else name


def is_ringed(scene: Scene, pair: ContactPair) -> bool:
    """Whether a pair of shapes has a circle that no flat face meets."""
    kinds = {shape_of(scene, partner).kind for partner in pair.between}
    return "circle" in kinds and not kinds & set(FLAT)


def _has_faces(scene: Scene, pair: ContactPair) -> bool:
    """Whether both shapes of a pair have flat faces."""
    shapes = [shape_of(scene, partner) for partner in pair.between]
    return all(shape.kind in FACED or bool(_corners(shape)) for shape in shapes)


def motors(scene: Scene) -> list[ForceLoad | TorqueLoad]:
    """The loads that MuJoCo has as motors, three each, in this order."""
    return [load for load in scene.loads if not isinstance(load, SpringLoad)]


def _touching(scene: Scene) -> list[tuple[tuple[str, str], Shape]]:
    return [(partner, shape_of(scene, partner)) for pair in scene.contacts for partner in pair.between]


def _is_linked(setup: Setup, pair: ContactPair) -> bool:
    """Whether two circles touch inside each other, as links of a chain do, by the normal of the pair."""
    a, b = (setup.solid(partner[0]) for partner in pair.between)
    return pair.normal is not None and float(np.dot(pair.normal, b.p - a.p)) < 0


def _damping(restitution: float) -> float:
    """The damping ratio of a spring that returns this part of the speed of approach."""
    if restitution == 0:
        return 1.0
    fall = -log(min(restitution, 0.9999))
    return fall / sqrt(pi * pi + fall * fall)


def _refused(where: str, shape: Shape, fixed: bool, others: list[Shape]) -> list[str]:
    if shape.cavity:
        return [f"{where} is a cavity"]
    if shape.kind == "plane":
        return [] if fixed else [f"{where} is a plane that moves"]
    if shape.kind == "circle" and all(other.kind in (*FLAT, "circle") for other in others):
        return []
    if shape.solid and shape.solid.convex and _corners(shape):
        return []
    if shape.kind not in PRIMITIVES or len(shape.parameters) < len(PRIMITIVES[shape.kind][0]):
        return [f"{where} is {with_article(shape.kind)}"]
    return []


def _corners(shape: Shape) -> list[tuple[float, ...]]:
    """The vertices of a polyhedron; empty where a face or an edge is curved."""
    features = shape.solid.features if shape.solid else ()
    kinds = {0: "point", 1: "line", 2: "plane"}
    straight = all(each.shape.kind in (kinds[each.dimension], "segment") for each in features)
    points = [each.shape for each in features if each.dimension == 0]
    return [_vertex(point) for point in points] if straight else []


def _vertex(point: Shape) -> tuple[float, ...]:
    at = [*numbers(point).values()] or [0.0] * 3
    return tuple(np.add(point.pose.position, at).tolist())


def _meshes(solids: Iterable[Solid]) -> Iterator[str]:
    for solid in solids:
        for shape in solid.shapes:
            corners = _corners(shape)
            if corners and shape.kind not in PRIMITIVES:
                points = words(value for corner in corners for value in corner)
                yield f'<mesh name="{solid.name}/{shape.name}" vertex="{points}"/>'


def _geom(setup: Setup, solid: Solid, shape: Shape) -> str:
    where = f"{solid.name}/{shape.name}"
    if not any(partner == (solid.name, shape.name) for partner, _ in _touching(setup.scene)):
        return ""
    placed = f'name="{where}" pos="{words(solid.at(shape))}" quat="{words(shape.pose.quaternion)}"'
    silent = 'contype="0" conaffinity="0"'  # the listed pairs alone touch
    if shape.kind == "plane":
        return f'<geom type="plane" size="0 0 1" {placed} {silent}/>'
    if shape.kind == "circle":
        radius = numbers(shape)["radius"]
        return f'<geom type="cylinder" size="{words([radius, THIN * radius])}" {placed} {silent}/>'
    if shape.kind in PRIMITIVES:
        return f'<geom type="{shape.kind}" size="{words(geom_size(shape))}" {placed} {silent}/>'
    return f'<geom type="mesh" mesh="{where}" {placed} {silent}/>'


def geom_size(shape: Shape) -> list[float]:
    names, share = PRIMITIVES[shape.kind]
    values = [*numbers(shape).values()][: len(names)]
    return [share * v for v in values] if shape.kind == "box" else [*values[:-1], share * values[-1]]


def _sites(scene: Scene, solid: Solid) -> Iterator[str]:
    """Where loads act on a body."""
    for k, load in enumerate(scene.loads):
        ends = zip(load.between, load.anchors, strict=True) if isinstance(load, SpringLoad) else [
            (load.body, load.point if isinstance(load, ForceLoad) else solid.centre)
        ]  # fmt: skip
        for end, (body, point) in enumerate(ends):
            if body == solid.name:
                yield f'<site name="{k}/{end}" pos="{words(np.array(point) - solid.centre)}"/>'


def _springs(scene: Scene) -> Iterator[str]:
    for k, load in enumerate(scene.loads):
        if isinstance(load, SpringLoad):
            yield (
                f'<spatial stiffness="{load.stiffness!r}" damping="{load.damping!r}" '
                f'springlength="{load.rest_length!r}"><site site="{k}/0"/><site site="{k}/1"/></spatial>'
            )


def _motors(scene: Scene) -> list[str]:
    """Three motors a load, along the axes of the world or of the body."""
    found = []
    for k, load in enumerate(scene.loads):
        if isinstance(load, SpringLoad):
            continue
        axes = f' refsite="{WORLD}"' if load.frame == "world" else ""
        for axis in AXES:
            zero = np.zeros(3)
            gear = words([*axis, *zero] if isinstance(load, ForceLoad) else [*zero, *axis])
            found.append(f'<motor site="{k}/0"{axes} gear="{gear}"/>')
    return found


def words(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)
