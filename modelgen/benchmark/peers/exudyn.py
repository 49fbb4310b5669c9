"""The same scene in Exudyn (extra `exudyn`): rims on planes, as joints; spheres by a penalty."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from importlib import import_module
from importlib.metadata import version
from typing import Any

import numpy as np

from modelgen.benchmark.knobs import Knob, Settings
from modelgen.benchmark.peers.peer import Peer, PeerError, Run, missing
from modelgen.benchmark.peers.scene_description import Setup, Solid, driven, numbers, rotation, unsteady
from modelgen.benchmark.sampled_motion import Array
from modelgen.scene.scene_types import ContactPair, Scene

KNOBS: tuple[Knob, ...] = (
    Knob("solver", "of order 2", lambda f: ("TrapezoidalIndex2", "GeneralizedAlpha"), lambda f, s: True),
    Knob(
        "timestep",
        "s",
        lambda f: [5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6],
        lambda f, s: True,
        ladder=True,
    ),
    Knob(
        "newton", "relative tolerance of Newton's method", lambda f: (1e-10, 1e-8, 1e-12), lambda f, s: True
    ),
    Knob("sink", "depth under the weight over the length", lambda f: (1e-6, 1e-4), lambda f, s: f.contacts),
)


@dataclass(frozen=True, slots=True)
class ExudynScene:
    """A scene as Exudyn has it."""

    setup: Setup
    cannot: list[str]
    differs: list[str]
    version: str
    knobs: tuple[Knob, ...] = field(default=KNOBS)

    @classmethod
    def of(cls, setup: Setup) -> ExudynScene:
        _module()
        rolls = any(_rim(setup.scene, pair) for pair in setup.scene.contacts)
        differs = [
            "a rim is held to its plane, and with friction to its place on it: it never lifts or slips"
        ]
        knobs = tuple(knob for knob in KNOBS if not (rolls and knob.name == "sink"))
        return cls(setup, unlike(setup.scene), differs if rolls else [], version("exudyn"), knobs)

    def prepare(self, settings: Settings) -> Run:
        return lambda: self._run(settings)

    def _run(self, settings: Settings) -> tuple[Array, float]:
        exu, setup = _module(), self.setup
        system = exu.SystemContainer().AddSystem()
        bodies = {solid.name: _body(system, solid, setup) for solid in setup.solids}
        for pair in setup.scene.contacts:
            _touch(system, setup, pair, bodies, settings)
        sensors = [_sensors(exu, system, bodies[solid.name]) for solid in setup.moving]
        system.Assemble()
        steps = setup.samples * setup.per_sample(float(settings["timestep"]))
        options = _options(exu, setup, steps, float(settings["newton"]))
        begun = time.process_time()
        try:
            system.SolveDynamic(options, solverType=getattr(exu.DynamicSolverType, str(settings["solver"])))
        except ValueError as refused:
            raise PeerError(str(refused).splitlines()[0]) from None
        spent = time.process_time() - begun
        return np.stack([_track(system, each, setup.samples) for each in sensors], axis=1), spent


def unlike(scene: Scene) -> list[str]:
    """Sentences: what of a scene Exudyn has no like of, or this export does not write."""
    found = driven(scene) + unsteady(scene)
    shapes = {(body.name, shape.name): shape for body in scene.bodies for shape in body.shapes}
    for k, pair in enumerate(scene.contacts):
        kinds = [shapes[partner].kind for partner in pair.between]
        if _rim(scene, pair):
            found += [f"contact {k} has a restitution"] if pair.restitution.value else []
            found += [f"contact {k} resists rolling"] if pair.rolling_resistance else []
        elif kinds != ["sphere", "sphere"]:
            found.append(
                f"contact {k} is of a {kinds[0]} with a {kinds[1]}: it has rims on planes and spheres"
            )
        elif pair.friction or pair.restitution.value:
            found.append(f"contact {k} has friction or a restitution")
    found += [f"joint {joint.name!r} is not exported" for joint in scene.joints]
    return found + (["loads are not exported"] if scene.loads else [])


def _rim(scene: Scene, pair: ContactPair) -> tuple[tuple[str, str], tuple[str, str]] | None:
    """The partners (circle, fixed plane) of a pair that is one of a circle and such a plane."""
    shapes = {(body.name, shape.name): shape.kind for body in scene.bodies for shape in body.shapes}
    fixed = {body.name for body in scene.bodies if body.motion == "fixed"}
    for circle, plane in (pair.between, pair.between[::-1]):
        if shapes[circle] == "circle" and shapes[plane] == "plane" and plane[0] in fixed:
            return circle, plane
    return None


def _body(system: Any, solid: Solid, setup: Setup) -> Any:
    turned = rotation(solid.quaternion)
    if solid.fixed:
        return system.CreateGround(referencePosition=solid.p, referenceRotationMatrix=turned)
    inertia = import_module("exudyn.utilities").RigidBodyInertia(mass=solid.mass, inertiaTensor=solid.inertia)
    return system.CreateRigidBody(
        inertia=inertia,
        referencePosition=solid.p,
        referenceRotationMatrix=turned,
        initialVelocity=solid.v,
        initialAngularVelocity=solid.w,
        gravity=list(setup.scene.gravity),
    )


def _touch(system: Any, setup: Setup, pair: ContactPair, bodies: dict[str, Any], settings: Settings) -> None:
    items = import_module("exudyn.itemInterface")
    rim = _rim(setup.scene, pair)
    places = rim or pair.between
    markers = [_marker(items, system, setup, partner, bodies) for partner in places]
    if rim is None:
        radii = [numbers(setup.shape(partner))["radius"] for partner in places]
        hollow = [setup.shape(partner).cavity for partner in places]
        if hollow[0]:
            markers, radii = markers[::-1], radii[::-1]
        weight = max(solid.mass for solid in setup.moving)
        node = system.AddNode(items.NodeGenericData(initialCoordinates=[0.0] * 4, numberOfDataCoordinates=4))
        contact = items.ObjectContactSphereSphere(
            markerNumbers=markers,
            nodeNumber=node,
            spheresRadii=radii,
            isHollowSphere1=any(hollow),
            contactStiffness=weight / setup.time**2 / float(settings["sink"]),
        )
        system.AddObject(contact)
        return
    circle, plane = (setup.shape(partner) for partner in rim)
    ground = setup.solid(rim[1][0])
    system.AddObject(
        items.ObjectJointRollingDisc(
            markerNumbers=markers[::-1],
            constrainedAxes=[1, 1, 1] if pair.friction else [0, 0, 1],
            discRadius=numbers(circle)["radius"],
            discAxis=rotation(np.array(circle.pose.quaternion))[:, 2],
            planeNormal=(rotation(ground.quaternion) @ rotation(np.array(plane.pose.quaternion)))[:, 2],
        )
    )


def _marker(items: Any, system: Any, setup: Setup, partner: tuple[str, str], bodies: dict[str, Any]) -> Any:
    place = setup.solid(partner[0]).at(setup.shape(partner))
    return system.AddMarker(items.MarkerBodyRigid(bodyNumber=bodies[partner[0]], localPosition=place))


def _sensors(exu: Any, system: Any, body: Any) -> list[Any]:
    items = import_module("exudyn.itemInterface")
    kinds = (
        exu.OutputVariableType.Position,
        exu.OutputVariableType.RotationMatrix,
        exu.OutputVariableType.Velocity,
    )
    return [
        system.AddSensor(
            items.SensorBody(bodyNumber=body, storeInternal=True, writeToFile=False, outputVariableType=kind)
        )
        for kind in kinds
    ]


def _options(exu: Any, setup: Setup, steps: int, newton: float) -> Any:
    options = exu.SimulationSettings()
    options.timeIntegration.endTime = setup.until
    options.timeIntegration.numberOfSteps = steps
    options.timeIntegration.verboseMode = 0
    options.timeIntegration.newton.relativeTolerance = newton
    options.timeIntegration.newton.useModifiedNewton = True
    options.solutionSettings.writeSolutionToFile = False
    options.solutionSettings.sensorsWritePeriod = setup.until / setup.samples
    return options


def _track(system: Any, sensors: list[Any], samples: int) -> Array:
    """(samples + 1, 10) of one body."""
    from scipy.spatial.transform import Rotation

    p, turned, v = (system.GetSensorStoredData(sensor)[:, 1:] for sensor in sensors)
    if len(p) != samples + 1:
        raise PeerError(f"it came to {len(p) - 1} of {samples} samples")
    xyzw = Rotation.from_matrix(turned.reshape(-1, 3, 3)).as_quat()
    return np.hstack([p, xyzw[:, [3, 0, 1, 2]], v])


def _module() -> Any:
    try:
        return import_module("exudyn")
    except ImportError:
        raise missing("exudyn", "exudyn") from None


EXUDYN = Peer("exudyn", KNOBS, ExudynScene.of, _module)
