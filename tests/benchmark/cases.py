"""Random runs over built scenes, each judged: what the run says of its error against what the error is.

A case draws masses, friction, restitution, gravity, initial velocities, span, tolerance or step, and how
closely contacts are followed. The truth is a run in long double, in another form of the contact equations
where the scene has one, its thresholds a thousand times finer.
"""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from modelgen import Accuracy, read, simulate
from modelgen.assembly import require
from modelgen.benchmark.reference_solution import PREDICTABLE, nudged
from modelgen.codegen.library import Library
from modelgen.contact.form_table import regular_forms
from modelgen.errors import SimulationError
from modelgen.runtime.error_estimate import ROUNDED
from modelgen.runtime.run_distance import angle_between, distance_between
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.scene_types import Scene
from tests.running import SCENES

TRUE = replace(Accuracy.finest(), tolerance=3e-15)
WIDE = 10.0  # an estimate is honest within this factor
SPAN = (0.1, 0.6)  # of the scene's own
SAMPLES = 40
Array = np.ndarray[Any, Any]


@dataclass(frozen=True, slots=True)
class Verdict:
    """One case: its error is the larger of position over the length and of rotation, up to where judged."""

    scene: str
    number: int
    status: str  # of the estimate; or refused, or early: the truth ended
    ratio: float = 1.0  # estimated over true error, both no less than rounding; the worst of the two kinds
    true: float = 0.0
    horizon: bool = False  # whether the estimate named one
    settings: str = ""

    @property
    def under(self) -> bool:
        return self.ratio < 1 / WIDE

    @property
    def over(self) -> bool:
        return self.ratio > WIDE


def true_form(scene: Scene) -> Scene:
    """The scene with its contacts in a second form, where they have one that gives other equations."""
    model = require(scene)
    forms = dict.fromkeys(form for kind in model.contact_kinds for form in regular_forms(kind.o, kind.f))
    for form in forms:
        other = replace(scene, run=replace(scene.run, form=form))
        if require(other).contact_kinds != model.contact_kinds:
            return other
    return scene


def scene_named(name: str) -> Scene:
    return read(SCENES / f"{name}.toml")


def judged(name: str, library: Library, truth: Library, seed: int, number: int) -> Verdict:
    """Case `number` of a scene: `library` as it is built unasked, `truth` in long double."""
    rng = np.random.default_rng([seed, number])
    accuracy, span = _accuracy(rng, library), rng.uniform(*SPAN)
    until = library.manifest.instance["run"]["until"] * span
    state = rng.bit_generator.state
    libraries = []
    for each in (library, truth):
        rng.bit_generator.state = state
        libraries.append(_varied(each, rng))
    try:
        path = simulate(libraries[0], until=until, samples=SAMPLES, accuracy=accuracy, estimate=True)
        real = simulate(libraries[1], until=until, samples=SAMPLES, accuracy=TRUE, estimate=False)
    except SimulationError:
        return Verdict(name, number, "refused", settings=accuracy.name)
    return _judge(Verdict(name, number, "", settings=accuracy.name), path, real, libraries[1], until)


def _judge(blank: Verdict, path: Trajectory, real: Trajectory, truth: Library, until: float) -> Verdict:
    estimate = path.estimate
    assert estimate is not None
    n = min(estimate.predicted, len(real.t))
    if len(path.t) > 1 and path.t[-1] not in real.t:
        n = min(n, len(path.t) - 1)
    verdict = _compared(blank, path, real, truth, n)
    if verdict.under or verdict.over:
        real = simulate(truth, until=until, samples=SAMPLES, accuracy=Accuracy.finest(), estimate=False)
        n = min(n, len(real.t), _predictable(real, truth, until))
        verdict = _compared(blank, path, real, truth, n)
    return verdict


def _compared(blank: Verdict, path: Trajectory, real: Trajectory, truth: Library, n: int) -> Verdict:
    """Estimate against truth over the first n samples."""
    instance, estimate = truth.manifest.instance, path.estimate
    assert estimate is not None
    bodies = list(enumerate(instance["bodies"]))
    moving = [k for k, body in bodies if body["motion"] in ("point", "free")]
    turning = [k for k, body in bodies if body["motion"] == "free"]
    length = instance["scales"]["length"]
    size = max(length, float(np.abs(path.p[:n, moving]).max(initial=0.0)))
    least = ROUNDED * float(np.finfo(path.p.dtype).eps)
    far = float(distance_between(path.p, real.p, moving)[:n].max(initial=0.0))
    turned = float(angle_between(path.quaternion[:n, turning], real.quaternion[:n, turning]).max(initial=0.0))
    ratios = [max(estimate.position[n - 1], least * size) / max(far, least * size)]
    if turning:
        ratios.append(max(estimate.rotation[n - 1], least) / max(turned, least))
    worst = max(ratios, key=lambda ratio: abs(np.log(ratio)) if np.isfinite(ratio) else np.inf)
    return replace(
        blank,
        status=estimate.status,
        ratio=float(worst),
        true=max(far / length, turned),
        horizon=estimate.horizon is not None,
    )


def _predictable(real: Trajectory, truth: Library, until: float) -> int:
    """How many samples there are before one rounding of gravity has grown to PREDICTABLE."""
    twin = simulate(nudged(truth), until=until, samples=SAMPLES, accuracy=Accuracy.finest(), estimate=False)
    instance = truth.manifest.instance
    moving = [k for k, body in enumerate(instance["bodies"]) if body["motion"] in ("point", "free")]
    apart = distance_between(real.p, twin.p, moving) / instance["scales"]["length"]
    turned = angle_between(real.quaternion[: len(apart), moving], twin.quaternion[: len(apart), moving])
    lost = np.flatnonzero(np.maximum(apart, turned) > PREDICTABLE)
    return max(int(lost[0]), 1) if lost.size else len(real.t)


def _accuracy(rng: np.random.Generator, library: Library) -> Accuracy:
    """A tolerance from 1e-13 to 1e-3, or a step; now and then other ways of following contacts."""
    tolerance = float(10 ** rng.uniform(-13, -3))
    accuracy = Accuracy.of(tolerance)
    if rng.random() < 0.15:
        scales = library.manifest.instance["scales"]
        accuracy = accuracy.fixed_step(float(scales["time"] * 10 ** rng.uniform(-3, -1.3)))
    name = accuracy.name
    if rng.random() < 0.3:
        newton = int(rng.integers(3))
        accuracy, name = replace(accuracy, newton=newton), f"{name}, newton {newton}"
    if rng.random() < 0.2:
        project = int(rng.choice([0, 10]))
        accuracy, name = replace(accuracy, project=project), f"{name}, project {project}"
    return replace(accuracy, name=name)


def _varied(library: Library, rng: np.random.Generator) -> Library:
    """The library with other masses, gravity, friction, restitution and velocities; one build serves all."""
    instance = deepcopy(library.manifest.instance)
    instance["gravity"] = (np.array(instance["gravity"]) * rng.uniform(0.7, 1.3)).tolist()
    u = np.array(instance["initial_u"], dtype=float)
    u *= rng.choice([-1.0, 1.0]) * rng.uniform(0.6, 1.2) * (1 + 0.1 * rng.uniform(-1, 1, u.shape))
    instance["initial_u"] = u.tolist()
    for body in instance["bodies"]:
        factor = rng.uniform(0.5, 2.0)
        if body["motion"] in ("point", "free") and body["parameters"]:
            body["parameters"] = [factor * value for value in body["parameters"]]
            body["mass_inverse"] = [value / factor for value in body["mass_inverse"]]
    for pair in instance["pairs"]:
        rough, bouncy = rng.uniform(0.8, 1.2), rng.uniform(0.7, 1.0)
        pair["restitution"] *= bouncy
        for constraint in pair.get("friction", ()):
            for key in ("static", "kinetic"):
                constraint[key] = [rough * value for value in constraint[key]]
    return Library(replace(library.manifest, instance=instance), library.record, library.path.parent)
