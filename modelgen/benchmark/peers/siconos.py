"""The same scene in Siconos (Debian: python3-siconos), in steps of Moreau and Jean.

Its own collision by Bullet knows no smooth convex shape but spheres, and loses those that rest, so that
closest points of spheres, ellipsoids and circles over planes are given to it as relations.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from modelgen.benchmark.knobs import Knob, Settings
from modelgen.benchmark.peers.external_program import answer, output_of, python_with
from modelgen.benchmark.peers.mjcf import motors
from modelgen.benchmark.peers.peer import PATIENCE, Peer, Run, missing
from modelgen.benchmark.peers.scene_description import (
    Setup,
    Solid,
    driven,
    numbers,
    rotation,
    tabulated,
    unsteady,
)
from modelgen.benchmark.sampled_motion import Array
from modelgen.scene.scene_types import ContactPair, ForceLoad, Scene, SpringLoad

KNOBS: tuple[Knob, ...] = (
    Knob(
        "theta",
        "of the step: 1/2 is of order 2 where nothing strikes",
        lambda f: (0.5, 1.0),
        lambda f, s: True,
    ),
    Knob("timestep", "s", lambda f: [5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4], lambda f, s: True, ladder=True),
    Knob("tolerance", "of its solver", lambda f: (1e-10, 1e-6), lambda f, s: f.contacts),
)
SHAPES: Mapping[str, Callable[[dict[str, float]], list[float]]] = {  # semi-axes
    "sphere": lambda n: [n["radius"]] * 3,
    "ellipsoid": lambda n: [n["a"], n["b"], n["c"]],
    "circle": lambda n: [n["radius"], n["radius"], 0.0],
}
PROGRAM = Path(__file__).parent / "programs" / "siconos_run.py"


@dataclass(frozen=True, slots=True)
class SiconosScene:
    """A scene as Siconos has it."""

    setup: Setup
    cannot: list[str]
    differs: list[str]
    version: str
    python: str
    knobs: tuple[Knob, ...] = field(default=KNOBS)

    @classmethod
    def of(cls, setup: Setup) -> SiconosScene:
        python = _python()
        version = output_of(["dpkg-query", "-W", "-f", "${Version}", "python3-siconos"]) or "unknown"
        differs = [
            "contacts are impulses of a step; their points are given to it",
            "loads are held over each step",
        ]
        return cls(setup, unlike(setup.scene), differs, version, python)

    def prepare(self, settings: Settings) -> Run:
        told = json.dumps(self._told(settings))
        patience = PATIENCE * self.setup.until
        return lambda: answer([self.python, str(PROGRAM)], told, patience, self.setup.samples)

    def _told(self, settings: Settings) -> dict[str, Any]:
        setup = self.setup
        per_sample = setup.per_sample(float(settings["timestep"]))
        return {
            "until": setup.until,
            "samples": setup.samples,
            "per_sample": per_sample,
            "step": setup.until / setup.samples / per_sample,
            "patience": PATIENCE * setup.until,
            "theta": settings["theta"],
            "tolerance": settings.get("tolerance", 1e-10),
            "gravity": list(setup.scene.gravity),
            "bodies": [_body(solid) for solid in setup.moving],
            "contacts": [_contact(setup, pair) for pair in setup.scene.contacts],
            "loads": _loads(setup, per_sample),
        }


def unlike(scene: Scene) -> list[str]:
    """Sentences: what of a scene Siconos has no like of, or this export does not write."""
    found = driven(scene) + unsteady(scene)
    for k, pair in enumerate(scene.contacts):
        if not _stands(scene, pair):
            found.append(f"contact {k} is not of a sphere, an ellipsoid or a circle on a fixed plane")
        if pair.friction and pair.friction.kinetic[0] != pair.friction.kinetic[1]:
            found.append(f"contact {k} has friction that depends on the direction")
        if pair.rolling_resistance or pair.spinning_resistance:
            found.append(f"contact {k} resists rolling or spinning")
    found += [f"joint {joint.name!r} is not exported" for joint in scene.joints]
    return found + (
        ["springs are not exported"] if any(isinstance(x, SpringLoad) for x in scene.loads) else []
    )


def _stands(scene: Scene, pair: ContactPair) -> tuple[tuple[str, str], tuple[str, str]] | None:
    """The partners (convex shape, fixed plane) of a pair that is one of such."""
    shapes = {(body.name, shape.name): shape for body in scene.bodies for shape in body.shapes}
    fixed = {body.name for body in scene.bodies if body.motion == "fixed"}
    for upper, plane in (pair.between, pair.between[::-1]):
        flat = shapes[plane].kind == "plane" and not shapes[plane].cavity and plane[0] in fixed
        if flat and shapes[upper].kind in SHAPES and not shapes[upper].cavity:
            return upper, plane
    return None


def _body(solid: Solid) -> dict[str, Any]:
    return {
        "pose": [*solid.p, *solid.quaternion],
        "twist": [*solid.v, *(solid.turned.T @ solid.w)],
        "mass": solid.mass,
        "inertia": solid.inertia.tolist(),
    }


def _contact(setup: Setup, pair: ContactPair) -> dict[str, Any]:
    partners = _stands(setup.scene, pair)
    assert partners is not None
    (upper, plane), (solid, ground) = map(setup.shape, partners), (setup.solid(p[0]) for p in partners)
    return {
        "body": setup.moving.index(solid),
        "semi_axes": SHAPES[upper.kind](numbers(upper)),
        "at": solid.at(upper).tolist(),
        "quaternion": list(upper.pose.quaternion),
        "origin": (ground.p + ground.turned @ ground.at(plane)).tolist(),
        "normal": (ground.turned @ rotation(np.array(plane.pose.quaternion)))[:, 2].tolist(),
        "restitution": pair.restitution.value,
        "slide": pair.friction.kinetic[0] if pair.friction else 0.0,
    }


def _loads(setup: Setup, per_sample: int) -> list[dict[str, Any]]:
    middles = setup.middles(per_sample)
    names = [solid.name for solid in setup.moving]
    return [
        {
            "body": names.index(load.body),
            "table": tabulated(load.components, middles).tolist(),
            "is_force": isinstance(load, ForceLoad),
            "arm": _arm(setup, load),
            "turns": load.frame == "body",
        }
        for load in motors(setup.scene)
        if load.body in names
    ]


def _arm(setup: Setup, load: Any) -> list[float]:
    point: Array = np.array(getattr(load, "point", (0.0, 0.0, 0.0)))
    return [float(value) for value in point - setup.solid(load.body).centre]


def _python() -> str:
    found = python_with("siconos.kernel")
    if found is None:
        raise missing("siconos", "install Debian's python3-siconos, or name nothing of it")
    return found


SICONOS = Peer("siconos", KNOBS, SiconosScene.of, _python)
