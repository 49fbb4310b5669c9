"""Numbers for the inputs of a formula: a random extremal configuration of the scene's own shapes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from modelgen.derivation import Derivation, Formula
from modelgen.errors import ModelgenError
from modelgen.model import Model
from modelgen.verification.bodies import GRAVITY, states
from modelgen.verification.contact_sides import feature_of
from modelgen.verification.contacts import moving_inputs, sample
from modelgen.verification.sensors import sensor_inputs
from modelgen.verification.sympy_evaluation import value_of
from modelgen.verification.sympy_translation import Line, component
from modelgen.verification.verify import (
    OF_BODIES,
    OF_CONTACTS,
    OF_SEARCH,
    OF_SHAPES,
    drawn_joints,
    is_of_joint,
    lengths_of,
    partnership_of,
)

Numbers = Mapping[str, Sequence[float]]


def inputs_at(
    formula: Formula, derivation: Derivation, seed: int, given: Mapping[str, Any]
) -> dict[str, list[float]]:
    """The value of each input; `given` numbers by input, or by formula and input, take the place of random
    ones.

    Raises ModelgenError where what is given is no list of numbers of the input's size.
    """
    random = np.random.default_rng(seed)
    known = _random(formula, derivation, seed, random)
    own = own_inputs(formula, given)
    function, found = formula.function, {}
    for k, name in enumerate(function.name_in()):
        size = function.numel_in(k)
        values = np.asarray(known.get(name, random.normal(size=size)), dtype=float).ravel()
        found[name] = _read(own[name], name, size) if name in own and size else values[:size].tolist()
    return found


def own_inputs(formula: Formula, given: Mapping[str, Any]) -> Mapping[str, Any]:
    """The inputs of a formula among those given, by input, or by formula and input."""
    own: Mapping[str, Any] = given.get(formula.name, given)
    return own


def _read(value: Any, name: str, size: int) -> list[float]:
    values = value if isinstance(value, list) else [value]
    numbers = [float(x) for x in values if isinstance(x, int | float) and not isinstance(x, bool)]
    if len(values) != size or len(numbers) != size or not np.isfinite(numbers).all():
        raise ModelgenError(f"--at: {name}", f"{str(value)[:60]}", f"a list of {size} numbers", "")
    return numbers


def _random(
    formula: Formula, derivation: Derivation, seed: int, random: np.random.Generator
) -> dict[str, Any]:
    model, role = derivation.model, formula.role
    if is_of_joint(formula, model):
        return _of_joint(formula, model, seed)
    if role in OF_CONTACTS or role in OF_SEARCH:
        drawn = sample(partnership_of(model, formula.kind), 1, seed)
        if not drawn.n:
            return {}
        names = ("pose_o", "twist_o", "pose_f", "twist_f", "eta", "parameters")
        return {**dict(zip(names, moving_inputs(drawn), strict=True)), "normal": drawn.truth.normal}
    if role in OF_SHAPES:
        feature = feature_of(model.shape_kinds[formula.kind], 1.0)
        alpha = [random.uniform(*ends) for ends in feature.ranges]
        return {"uv": alpha, "s": alpha, "parameters": lengths_of(model, formula.kind)}
    if role in OF_BODIES:
        kind = model.body_kinds[formula.kind]
        entry = next(body for body in model.bodies if body.kind == formula.kind)
        gravity = model.scene.gravity if any(model.scene.gravity) else GRAVITY
        known: dict[str, Any] = {"gravity": gravity}
        if kind.motion in ("free", "point"):
            q, u, _ = states(kind, 1, random)
            known |= {"q": q, "u": u}
        return known | {"t": [0.3], "parameters": entry.parameters}
    from modelgen.verification.right_hand_side import random_state

    if role == "rhs":
        of_state = ("t", "q", "u", "eta", "gravity", "parameters", "inputs")
        return dict(zip(of_state, random_state(model, random), strict=False))
    if role == "sensors":
        return sensor_inputs(model, random)
    load = next(load for load in model.loads if load.kind == formula.kind)
    pose = np.concatenate([random.normal(size=3), np.eye(3).ravel()])
    return {
        "t": [0.3],
        "pose_a": pose,
        "pose_b": pose + 0.1 * random.normal(size=12),
        "parameters": load.parameters,
    }


def _of_joint(formula: Formula, model: Model, seed: int) -> dict[str, Any]:
    """Two bodies put together as the joint wants, moving at random."""
    (at,) = drawn_joints(formula, model, 1, seed)
    pose_a, twist_a, _, twist_b = at.moving
    known: dict[str, Any] = {"t": [at.t], "parameters": at.parameters, "eta": at.coordinates}
    for a, b in (("a", "b"), ("o", "f")):
        known |= {f"pose_{a}": pose_a, f"twist_{a}": twist_a, f"pose_{b}": at.together, f"twist_{b}": twist_b}
    return known


def substituted(lines: Sequence[Line], inputs: Numbers, names: Mapping[str, Sequence[str]]) -> list[float]:
    """The value of each line of a definition, in order."""
    known = {
        component(name, k, len(values), names): value
        for name, values in inputs.items()
        for k, value in enumerate(values)
    }
    found = []
    for line in lines:
        known[line.target] = value_of(line.value, known)
        found.append(known[line.target])
    return found
