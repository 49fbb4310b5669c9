"""The same scene in Drake (extra `drake`): compliant points in discrete steps, or continuous."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from importlib.metadata import version
from itertools import combinations
from typing import Any

import numpy as np

from modelgen.benchmark.knobs import Knob, Settings
from modelgen.benchmark.peers.peer import Peer, PeerError, Run, missing, sampled
from modelgen.benchmark.peers.scene_description import Setup, Solid, driven, numbers
from modelgen.benchmark.sampled_motion import Array
from modelgen.errors import with_article
from modelgen.scene.scene_types import Scene, Shape

KNOBS: tuple[Knob, ...] = (
    Knob(
        "scheme",
        "discrete, or with error control",
        lambda f: ("sap", "lagged", "continuous"),
        lambda f, s: True,
    ),
    Knob(
        "timestep",
        "s",
        lambda f: [2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5],
        lambda f, s: s["scheme"] != "continuous",
        ladder=True,
    ),
    Knob(
        "accuracy",
        "of the Runge-Kutta method of order 3",
        lambda f: [10.0**-k for k in range(2, 9)],
        lambda f, s: s["scheme"] == "continuous",
        ladder=True,
    ),
    Knob(
        "sink",
        "depth under the weight over the length",
        lambda f: (1e-5, 1e-3, 1e-7),
        lambda f, s: f.contacts,
    ),
)
THIN = 1e-6  # half the thickness of a circle's cylinder over its radius
SHAPES: Mapping[str, Callable[[Any, dict[str, float]], Any]] = {
    "plane": lambda drake, n: drake.HalfSpace(),
    "sphere": lambda drake, n: drake.Sphere(n["radius"]),
    "ellipsoid": lambda drake, n: drake.Ellipsoid(n["a"], n["b"], n["c"]),
    "cylinder": lambda drake, n: drake.Cylinder(n["radius"], n["length"]),
    "circle": lambda drake, n: drake.Cylinder(n["radius"], 2 * THIN * n["radius"]),
    "capsule": lambda drake, n: drake.Capsule(n["radius"], n["length"]),
    "box": lambda drake, n: drake.Box(*n.values()),
}


@dataclass(frozen=True, slots=True)
class DrakeScene:
    """A scene as Drake has it."""

    setup: Setup
    cannot: list[str]
    differs: list[str]
    version: str
    knobs: tuple[Knob, ...] = field(default=KNOBS)

    @classmethod
    def of(cls, setup: Setup) -> DrakeScene:
        _module()
        differs = ["its contacts give way: a penetration carries the force, and friction creeps"]
        return cls(setup, unlike(setup.scene), differs, version("drake"))

    def prepare(self, settings: Settings) -> Run:
        return lambda: self._run(settings)

    def _run(self, settings: Settings) -> tuple[Array, float]:
        drake = _module()
        builder = drake.DiagramBuilder()
        plant, bodies = self._plant(builder, settings)
        simulator = drake.Simulator(builder.Build())
        if settings["scheme"] == "continuous":
            drake.ResetIntegratorFromFlags(simulator, "runge_kutta3", 1e-3)
            simulator.get_mutable_integrator().set_target_accuracy(float(settings["accuracy"]))
        context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
        for solid in self.setup.moving:
            place = _transform(drake, solid.p, solid.quaternion)
            plant.SetFloatingBaseBodyPoseInWorldFrame(context, bodies[solid.name], place)
            speed = drake.SpatialVelocity(solid.w, solid.v)
            plant.SetFreeBodySpatialVelocity(context, bodies[solid.name], speed)
        moving = [bodies[solid.name] for solid in self.setup.moving]
        try:
            simulator.Initialize()
            return sampled(
                self.setup,
                lambda sample, t: simulator.AdvanceTo(t),
                lambda: np.array([_sample(plant, body, context) for body in moving]),
            )
        except RuntimeError as refused:
            raise PeerError(str(refused).splitlines()[0]) from None

    def _plant(self, builder: Any, settings: Settings) -> tuple[Any, dict[str, Any]]:
        """The plant, and its bodies by name."""
        drake, setup = _module(), self.setup
        dt = float(settings.get("timestep", 0.0))
        config = drake.MultibodyPlantConfig(time_step=dt, contact_model="point")
        if dt:
            config.discrete_contact_approximation = settings["scheme"]
        plant, graph = drake.AddMultibodyPlant(config, builder)
        plant.mutable_gravity_field().set_gravity_vector(setup.scene.gravity)
        bodies = {solid.name: _body(drake, plant, solid) for solid in setup.solids}
        weight = max(solid.mass for solid in setup.moving)
        stiffness = weight / setup.time**2 / float(settings.get("sink", 1.0))
        geometries = {}
        for pair in setup.scene.contacts:
            slide = pair.friction.kinetic[0] if pair.friction else 0.0
            for partner in pair.between:
                if partner not in geometries:
                    found = self._geometry(plant, partner, bodies[partner[0]], stiffness, slide)
                    geometries[partner] = found
        plant.Finalize()
        _filter(drake, graph, geometries, [pair.between for pair in setup.scene.contacts])
        return plant, bodies

    def _geometry(
        self, plant: Any, partner: tuple[str, str], body: Any, stiffness: float, slide: float
    ) -> Any:
        drake, solid, shape = _module(), self.setup.solid(partner[0]), self.setup.shape(partner)
        properties = drake.ProximityProperties()
        drake.AddContactMaterial(
            dissipation=0.0,
            point_stiffness=2 * stiffness,  # two in series
            friction=drake.CoulombFriction(slide, slide),
            properties=properties,
        )
        place = _transform(drake, solid.at(shape), shape.pose.quaternion)
        if solid.fixed:
            place = _transform(drake, solid.p, solid.quaternion) @ place
        made = SHAPES[shape.kind](drake, numbers(shape))
        return plant.RegisterCollisionGeometry(body, place, made, "/".join(partner), properties)


def unlike(scene: Scene) -> list[str]:
    """Sentences: what of a scene Drake has no like of, or this export does not write."""
    found = driven(scene)
    fixed = {body.name for body in scene.bodies if body.motion == "fixed"}
    shapes = {(body.name, shape.name): shape for body in scene.bodies for shape in body.shapes}
    for partner in dict.fromkeys(partner for pair in scene.contacts for partner in pair.between):
        found += _refused(partner, shapes[partner], partner[0] in fixed)
        coefficients = {
            pair.friction and pair.friction.kinetic for pair in scene.contacts if partner in pair.between
        }
        if len(coefficients) > 1:
            found.append(f"shape {'/'.join(partner)} has a friction of its own in each contact")
    for k, pair in enumerate(scene.contacts):
        if pair.friction and pair.friction.kinetic[0] != pair.friction.kinetic[1]:
            found.append(f"contact {k} has friction that depends on the direction")
        if pair.restitution.value:
            found.append(f"contact {k} has a restitution")
        if pair.rolling_resistance or pair.spinning_resistance:
            found.append(f"contact {k} resists rolling or spinning")
    found += [f"joint {joint.name!r} is not exported" for joint in scene.joints]
    return [*found, *(["loads are not exported"] if scene.loads else [])]


def _refused(partner: tuple[str, str], shape: Shape, fixed: bool) -> list[str]:
    where = f"shape {'/'.join(partner)}"
    if shape.cavity:
        return [f"{where} is a cavity"]
    if shape.kind not in SHAPES or (shape.kind == "cylinder" and "length" not in numbers(shape)):
        return [f"{where} is {with_article(shape.kind)}"]
    return [f"{where} is a plane that moves"] if shape.kind == "plane" and not fixed else []


def _body(drake: Any, plant: Any, solid: Solid) -> Any:
    if solid.fixed:
        return plant.world_body()
    moments = solid.inertia / solid.mass
    products = (moments[0, 1], moments[0, 2], moments[1, 2])
    unit = drake.UnitInertia(*np.diag(moments), *products)
    return plant.AddRigidBody(solid.name, drake.SpatialInertia(solid.mass, np.zeros(3), unit))


def _transform(drake: Any, p: Any, quaternion: Any) -> Any:
    unit = np.array(quaternion) / np.linalg.norm(quaternion)
    return drake.RigidTransform(drake.Quaternion(unit), np.array(p, dtype=float))


def _filter(drake: Any, graph: Any, geometries: dict[Any, Any], pairs: list[Any]) -> None:
    """The listed pairs alone touch."""
    manager = graph.collision_filter_manager()
    for a, b in combinations(geometries, 2):
        if a[0] != b[0] and (a, b) not in pairs and (b, a) not in pairs:
            sets = (drake.GeometrySet(geometries[a]), drake.GeometrySet(geometries[b]))
            manager.Apply(drake.CollisionFilterDeclaration().ExcludeBetween(*sets))


def _sample(plant: Any, body: Any, context: Any) -> Array:
    pose = plant.EvalBodyPoseInWorld(context, body)
    speed = plant.EvalBodySpatialVelocityInWorld(context, body)
    return np.array([*pose.translation(), *pose.rotation().ToQuaternion().wxyz(), *speed.translational()])


def _module() -> Any:
    try:
        return import_module("pydrake.all")
    except ImportError:
        raise missing("drake", "drake") from None


DRAKE = Peer("drake", KNOBS, DrakeScene.of, _module)
