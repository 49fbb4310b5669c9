"""The same scene in Simbody (Debian: libsimbody-dev, and a C++ compiler), whose contacts are Hertz's."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np

from modelgen.benchmark.knobs import Knob, Settings
from modelgen.benchmark.peers.external_program import answer, compiled, output_of
from modelgen.benchmark.peers.peer import PATIENCE, Peer, Run, missing
from modelgen.benchmark.peers.scene_description import Setup, Solid, driven, numbers
from modelgen.errors import with_article
from modelgen.scene.scene_types import Scene, Shape

KNOBS: tuple[Knob, ...] = (
    Knob("integrator", "of order 4 with error control", lambda f: ("RungeKuttaMerson",), lambda f, s: True),
    Knob("accuracy", "of a step", lambda f: [10.0**-k for k in range(2, 11)], lambda f, s: True, ladder=True),
    Knob(
        "sink",
        "depth under the weight over the length",
        lambda f: (1e-5, 1e-3, 1e-7, 1e-8),
        lambda f, s: f.contacts,
    ),
    Knob("creep", "speed of friction's transition over L/T", lambda f: (1e-3, 1e-5), lambda f, s: f.contacts),
)
KINDS: Mapping[str, tuple[int, Callable[[dict[str, float]], tuple[float, float, float]]]] = {
    "plane": (0, lambda n: (0.0, 0.0, 0.0)),
    "sphere": (1, lambda n: (n["radius"],) * 3),
    "ellipsoid": (2, lambda n: (n["a"], n["b"], n["c"])),
}
SOURCE = Path(__file__).parent / "programs" / "simbody_run.cpp"
FLAGS = ("-I/usr/include/simbody", "-lSimTKsimbody", "-lSimTKmath", "-lSimTKcommon")


@dataclass(frozen=True, slots=True)
class SimbodyScene:
    """A scene as Simbody has it."""

    setup: Setup
    cannot: list[str]
    differs: list[str]
    version: str
    program: str
    knobs: tuple[Knob, ...] = field(default=KNOBS)

    @classmethod
    def of(cls, setup: Setup) -> SimbodyScene:
        program = _program()
        version = output_of(["dpkg-query", "-W", "-f", "${Version}", "libsimbody-dev"]) or "unknown"
        differs = ["its contacts give way: a penetration carries the force, and friction creeps"]
        return cls(setup, unlike(setup.scene), differs, version, program)

    def prepare(self, settings: Settings) -> Run:
        told = "\n".join(repr(float(value)) for value in self._told(settings))
        patience = PATIENCE * self.setup.until
        return lambda: answer([self.program], told, patience, self.setup.samples)

    def _told(self, settings: Settings) -> Iterable[float]:
        setup = self.setup
        weight = max(solid.mass for solid in setup.moving) / setup.time**2
        modulus = weight / setup.length / float(settings.get("sink", 1.0)) ** 1.5
        creep = float(settings.get("creep", 1e-3)) * setup.length / setup.time
        yield from setup.scene.gravity
        yield from (setup.until, setup.samples, PATIENCE * setup.until, float(settings["accuracy"]))
        yield from (modulus, creep)
        yield from self._surfaces([solid for solid in setup.solids if solid.fixed])
        yield len(setup.moving)
        for solid in setup.moving:
            moments = solid.inertia
            yield from (solid.mass, *np.diag(moments), moments[0, 1], moments[0, 2], moments[1, 2])
            yield from (*solid.p, *solid.quaternion, *solid.v, *solid.w)
            yield from self._surfaces([solid])

    def _surfaces(self, solids: list[Solid]) -> Iterable[float]:
        """Those that touch something, in the axes of their body; of fixed bodies, in the world's."""
        found = [
            (solid, shape)
            for solid in solids
            for shape in solid.shapes
            if self._slide(solid, shape) is not None
        ]
        yield len(found)
        for solid, shape in found:
            kind, axes = KINDS[shape.kind]
            p, quaternion = solid.placed(shape)
            yield from (kind, *axes(numbers(shape)), *p, *quaternion, self._slide(solid, shape) or 0.0)

    def _slide(self, solid: Solid, shape: Shape) -> float | None:
        """Friction of a shape; None where it touches nothing."""
        pairs = [pair for pair in self.setup.scene.contacts if (solid.name, shape.name) in pair.between]
        found = [pair.friction.kinetic[0] if pair.friction else 0.0 for pair in pairs]
        return found[0] if found else None


def unlike(scene: Scene) -> list[str]:
    """Sentences: what of a scene Simbody has no like of, or this export does not write."""
    found = driven(scene)
    shapes = {(body.name, shape.name): shape for body in scene.bodies for shape in body.shapes}
    fixed = {body.name for body in scene.bodies if body.motion == "fixed"}
    touching = {partner for pair in scene.contacts for partner in pair.between}
    listed = {frozenset(partner[0] for partner in pair.between) for pair in scene.contacts}
    for partner in sorted(touching):
        shape, where = shapes[partner], f"shape {'/'.join(partner)}"
        if shape.cavity:
            found.append(f"{where} is a cavity")
        elif shape.kind not in KINDS:
            found.append(f"{where} is {with_article(shape.kind)}")
        elif shape.kind == "plane" and partner[0] not in fixed:
            found.append(f"{where} is a plane that moves")
    bodies = sorted({partner[0] for partner in touching} - fixed)
    apart = [(a, b) for i, a in enumerate(bodies) for b in bodies[:i] if frozenset((a, b)) not in listed]
    found += [f"bodies {a!r} and {b!r} would touch, which the scene does not list" for a, b in apart]
    for k, pair in enumerate(scene.contacts):
        if pair.restitution.value or pair.rolling_resistance or pair.spinning_resistance:
            found.append(f"contact {k} has a restitution, or resists rolling or spinning")
        if pair.friction and pair.friction.kinetic[0] != pair.friction.kinetic[1]:
            found.append(f"contact {k} has friction that depends on the direction")
    found += [f"joint {joint.name!r} is not exported" for joint in scene.joints]
    return found + (["loads are not exported"] if scene.loads else [])


@cache
def _program() -> str:
    """The program, compiled once a session of Python."""
    found = compiled(SOURCE, FLAGS, Path(tempfile.mkdtemp(prefix="simbody-")))
    if found is None:
        raise missing("simbody", "install Debian's libsimbody-dev and a C++ compiler")
    return str(found)


SIMBODY = Peer("simbody", KNOBS, SimbodyScene.of, _program)
