"""A scene run by Siconos, in a Python that knows it: `python siconos_run.py < SCENE.json > TRACK.json`.

Reads bodies, contacts, loads and settings as JSON, and writes {rows, seconds}: position, quaternion and
velocity of each moving body at the samples, and CPU seconds.
"""

from __future__ import annotations

import json
import sys
import time
from typing import Any

import numpy as np
import siconos.kernel as kernel
import siconos.numerics as numerics


class Support(kernel.NewtonEuler3DR):  # type: ignore[misc]
    """The point of a sphere, an ellipsoid or a circle that is lowest over a fixed plane."""

    def __init__(self, told: dict[str, Any], body: Any) -> None:
        super().__init__()
        self.body = body
        self.axes, self.centre = np.array(told["semi_axes"]), np.array(told["at"])
        self.placed = rotation(told["quaternion"])
        self.origin, self.normal = np.array(told["origin"]), np.array(told["normal"])

    def computeh(self, t: float, q0: Any, y: Any) -> None:
        q = self.body.q()
        turned = rotation(q[3:]) @ self.placed
        down = self.axes * (turned.T @ -self.normal)
        lowest = turned @ (self.axes * down / np.linalg.norm(down))
        point = q[:3] + rotation(q[3:]) @ self.centre + lowest
        gap = float(self.normal @ (point - self.origin))
        self.pc1()[:], self.pc2()[:], self.nc()[:] = point, point - gap * self.normal, self.normal
        y[0] = gap


def body_of(told: dict[str, Any]) -> Any:
    return kernel.NewtonEulerDS(told["pose"], told["twist"], told["mass"], np.array(told["inertia"]))


def built(told: dict[str, Any]) -> tuple[Any, list[Any], Any]:
    """The simulation, its moving bodies, and what keeps it alive."""
    model = kernel.NonSmoothDynamicalSystem(0.0, told["until"])
    bodies = [body_of(each) for each in told["bodies"]]
    for body in bodies:
        model.insertDynamicalSystem(body)
    kept: list[Any] = [model]
    for each in told["contacts"]:
        law = kernel.NewtonImpactFrictionNSL(each["restitution"], 0.0, each["slide"], 3)
        relation = Support(each, bodies[each["body"]])
        contact = kernel.Interaction(law, relation)
        model.link(contact, bodies[each["body"]])
        kept += [law, relation, contact]
    solver = kernel.solver_options_create(numerics.SICONOS_FRICTION_3D_NSGS)
    solver.dparam[numerics.SICONOS_DPARAM_TOL] = told["tolerance"]
    solver.iparam[numerics.SICONOS_IPARAM_MAX_ITER] = 1000
    times = kernel.TimeDiscretisation(0.0, told["step"])
    integrator, problem = kernel.MoreauJeanOSI(told["theta"]), kernel.FrictionContact(3, solver)
    simulation = kernel.TimeStepping(model, times, integrator, problem)
    return simulation, bodies, [*kept, times, integrator, problem]


def rotation(quaternion: Any) -> Any:
    w, x, y, z = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def row(bodies: list[Any]) -> list[list[float]]:
    return [[*body.q(), *body.velocity()[:3]] for body in bodies]


class Loads:
    """Weight and loads of all bodies, held over each step; torques in body axes."""

    def __init__(self, told: dict[str, Any], bodies: list[Any]) -> None:
        self.bodies = bodies
        self.loads = [{**load, "table": np.array(load["table"])} for load in told["loads"]]
        self.weights = [each["mass"] * np.array(told["gravity"]) for each in told["bodies"]]

    def hold(self, step: int) -> None:
        for number, (body, weight) in enumerate(zip(self.bodies, self.weights, strict=True)):
            force, torque = weight.copy(), np.zeros(3)
            for load in self.loads:
                if load["body"] == number:
                    self.add(load, load["table"][step], force, torque)
            body.setFExtPtr(force)
            body.setMExtPtr(torque)

    def add(self, load: dict[str, Any], value: Any, force: Any, torque: Any) -> None:
        turned = rotation(self.bodies[load["body"]].q()[3:])
        world, local = (turned @ value, value) if load["turns"] else (value, turned.T @ value)
        if load["is_force"]:
            force += world
        torque += np.cross(load["arm"], local) if load["is_force"] else local


def main() -> None:
    told = json.load(sys.stdin)
    simulation, bodies, _kept = built(told)
    loads = Loads(told, bodies)
    rows, begun = [row(bodies)], time.process_time()
    for step in range(told["samples"] * told["per_sample"]):
        loads.hold(step)
        simulation.computeOneStep()
        simulation.nextStep()
        if (step + 1) % told["per_sample"] == 0:
            rows.append(row(bodies))
        if time.process_time() - begun > told["patience"]:
            break
    json.dump({"rows": rows, "seconds": time.process_time() - begun}, sys.stdout)


if __name__ == "__main__":
    main()
