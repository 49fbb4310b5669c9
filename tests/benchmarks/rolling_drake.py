"""The rolling ellipsoid in Drake."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from time import process_time
from typing import Any

import numpy as np

from tests.benchmarks.tracks import AXES, INERTIA, MASS, TIMES, Track, start


def run(dt: float, approximation: str) -> Track:
    """dt 0: continuous, compliant points, Drake's default Runge-Kutta 3 with error control."""
    from pydrake.all import DiagramBuilder, Simulator

    builder = DiagramBuilder()
    plant, egg = _plant(builder, dt, approximation)
    diagram = builder.Build()
    simulator = Simulator(diagram)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    begin = start()
    plant.SetPositions(context, [*begin.quaternion, *begin.p])
    plant.SetVelocities(context, [*begin.w, *begin.v])
    simulator.Initialize()
    samples, spent = [_sample(plant, egg, context)], 0.0
    for t in TIMES[1:]:
        begun = process_time()
        simulator.AdvanceTo(float(t))
        spent += process_time() - begun
        samples.append(_sample(plant, egg, context))
    p, R, v, w = (np.array(values) for values in zip(*samples, strict=True))
    return Track(p, R, v, w, spent / TIMES[-1] * 1e6)


def _plant(builder: Any, dt: float, approximation: str) -> tuple[Any, Any]:
    from pydrake.all import (
        AddContactMaterial,
        AddMultibodyPlant,
        CoulombFriction,
        Ellipsoid,
        HalfSpace,
        MultibodyPlantConfig,
        ProximityProperties,
        RigidTransform,
        SpatialInertia,
        UnitInertia,
    )  # fmt: skip

    config = MultibodyPlantConfig(time_step=dt, contact_model="point")
    if dt:
        config.discrete_contact_approximation = approximation
    plant, _ = AddMultibodyPlant(config, builder)
    moments = UnitInertia(*(INERTIA / MASS))
    egg = plant.AddRigidBody("egg", SpatialInertia(MASS, np.zeros(3), moments))
    friction = CoulombFriction(1.0, 1.0)
    for body, solid in ((egg, Ellipsoid(*AXES)), (plant.world_body(), HalfSpace())):
        properties = ProximityProperties()
        AddContactMaterial(dissipation=0.0, friction=friction, properties=properties)
        plant.RegisterCollisionGeometry(body, RigidTransform(), solid, "solid", properties)
    plant.Finalize()
    return plant, egg


def _sample(plant: Any, egg: Any, context: Any) -> tuple[Any, Any, Any, Any]:
    pose = plant.EvalBodyPoseInWorld(context, egg)
    speed = plant.EvalBodySpatialVelocityInWorld(context, egg)
    turned = pose.rotation().matrix().copy()
    return pose.translation().copy(), turned, speed.translational(), speed.rotational()


def runs() -> Iterator[tuple[str, Callable[[], Track]]]:
    yield "Drake default, dt 1 ms", lambda: run(1e-3, "lagged")
    for dt in (1e-3, 1e-4, 2e-5):
        yield f"Drake SAP, dt {dt * 1e3:g} ms", partial(run, dt, "sap")
    yield "Drake continuous", lambda: run(0.0, "sap")
